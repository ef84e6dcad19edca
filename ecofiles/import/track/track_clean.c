/* What recorders get wrong, undone in an order in which each step can rely on those before: heights, stamps (track_stamps.c), repeated
 * positions, jumps and parts, long stands.
 *
 * A position may be repeated because the GPS is slower than the recording (motion then goes on from first to first), because it was
 * rounded (then the middle of the repeats is nearest to the truth) or because the camera stands (then it is kept at both ends). Positions,
 * heights and looks are told apart all the way: a fix loses only what it does not say. */
#include "ecofiles/import/track/track_clean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define WINDOW_S 1.0                     /* speeds are measured over */
#define STAND_S 1.5                      /* a repeat that lasts longer may be a stand */
#define ROUNDED_M 0.5                    /* positions in steps of more are rounded roughly */
#define AHEAD 10u                        /* fixes within which a track comes back from a jump */
#define GLIDE_S 20.0                     /* a leap that takes longer at the track's own speed ends a part */
#define PACE_M_S 10.0
#define PAUSE_S 60.0

/* ---- Heights ---- */

static double height_of(const struct eco_fix *fix, enum eco_track_height height)
{
	return height == ECO_HEIGHTS_ABSOLUTE ? fix->at[2] : fix->above_m;
}

static enum eco_code choose_heights(struct eco_track *track, enum eco_track_height wanted, struct eco_track_report *report, struct eco_error *error)
{
	uint32_t absolute = 0, relative = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		absolute += !isnan(track->fixes[i].at[2]);
		relative += !isnan(track->fixes[i].above_m);
	}
	if (wanted == ECO_HEIGHTS_ABSOLUTE && !absolute)
		return eco_fail(error, ECO_BAD_INPUT, "--height abs: the track has no heights above the sea%s", relative ? ", only above take-off (--height "
			"rel)" : "");
	if (wanted == ECO_HEIGHTS_RELATIVE && !relative && !absolute)
		return eco_fail(error, ECO_BAD_INPUT, "--height rel: the track has no heights");
	bool above = wanted != ECO_HEIGHTS_ABSOLUTE && relative > 0 && (relative >= track->count / 2 || !absolute);
	double first = 0;
	for (uint32_t i = track->count; i-- > 0; )
		first = isnan(track->fixes[i].at[2]) ? first : track->fixes[i].at[2];
	for (uint32_t i = 0; i < track->count; i++) {
		struct eco_fix *fix = &track->fixes[i];
		fix->at[2] = height_of(fix, above ? ECO_HEIGHTS_RELATIVE : ECO_HEIGHTS_ABSOLUTE);
		/* the ground, or take-off, is where it begins */
		if (!above && (wanted == ECO_HEIGHTS_RELATIVE || wanted == ECO_HEIGHTS_GROUND))
			fix->at[2] -= first;
		report->heights_missing += isnan(fix->at[2]);
	}
	report->has_height = above || absolute;
	if (!report->has_height)
		report->heights_missing = 0;
	report->height = wanted == ECO_HEIGHTS_GROUND ? wanted : above || wanted == ECO_HEIGHTS_RELATIVE ? ECO_HEIGHTS_RELATIVE : ECO_HEIGHTS_ABSOLUTE;
	return ECO_OK;
}

/* ---- Distances and medians ---- */

double track_distance(const struct eco_fix *a, const struct eco_fix *b)
{
	double dz = b->at[2] - a->at[2], flat = hypot(b->at[0] - a->at[0], b->at[1] - a->at[1]);
	return isnan(dz) ? flat : hypot(flat, dz);
}

double track_quantile(double *values, uint32_t count, double share)
{
	if (!count)
		return 0;
	qsort(values, count, sizeof *values, track_by_value);
	return values[(uint32_t)(share * (count - 1))];
}

void track_speeds(const struct eco_track *track, bool flat, double *speeds, uint32_t *count)
{
	const struct eco_fix *f = track->fixes;
	uint32_t last = track->count, still = 0;
	double window_s = track->count ? fmin(WINDOW_S, (f[track->count - 1].time_s - f[0].time_s) / 8) : 0;
	*count = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		if (isnan(f[i].at[0]) || (last < track->count && !(f[i].time_s - f[last].time_s >= window_s)))
			continue;
		if (last < track->count) {
			double d = flat ? hypot(f[i].at[0] - f[last].at[0], f[i].at[1] - f[last].at[1]) : track_distance(&f[last], &f[i]);
			if (d > 0)
				speeds[(*count)++] = d / (f[i].time_s - f[last].time_s);
		}
		last = i;
	}
	/* a slow drift is no motion either */
	double high = track_quantile(speeds, *count, 0.9);
	while (still < *count && speeds[still] < 0.1 * high)
		still++;
	memmove(speeds, speeds + still, (*count - still) * sizeof *speeds);
	*count -= still;
}

static bool same_place(const struct eco_fix *a, const struct eco_fix *b)
{
	return a->at[0] == b->at[0] && a->at[1] == b->at[1];
}

/* ---- Repeats ---- */

/* One past the run of fixes at one place (axis pair 0: x, y) or height (1) that begins at `first`. */
static uint32_t run_end(const struct eco_track *track, uint32_t first, bool heights)
{
	const struct eco_fix *f = track->fixes;
	uint32_t end = first + 1;
	while (end < track->count && (heights ? f[end].at[2] == f[first].at[2] || (isnan(f[end].at[2]) && isnan(f[first].at[2])) :
		same_place(&f[first], &f[end])))
		end++;
	return end;
}

static double median_update(const struct eco_track *track, double *scratch, bool heights)
{
	uint32_t count = 0;
	for (uint32_t i = 0, end; i < track->count; i = end) {
		end = run_end(track, i, heights);
		if (end < track->count && i > 0)
			scratch[count++] = track->fixes[end].time_s - track->fixes[i].time_s;
	}
	return track_quantile(scratch, count, 0.5);
}

/* After a stand motion begins slowly; where it begins with a leap, the receiver had only lost its satellites. */
static bool leaps(const struct eco_track *track, uint32_t end, double fast_m_s)
{
	const struct eco_fix *f = track->fixes;
	return end < track->count && track_distance(&f[end - 1], &f[end]) > fast_m_s * fmax(f[end].time_s - f[end - 1].time_s, 0.5);
}

/* Which fixes of a run keep what they say: first (or the middle), and last where the camera stands. */
static void merge_runs(struct eco_track *track, double update_s, bool rough, bool heights, double fast_m_s, uint8_t *keep)
{
	for (uint32_t i = 0, end; i < track->count; i = end) {
		end = run_end(track, i, heights);
		double lasts_s = track->fixes[end - 1].time_s - track->fixes[i].time_s;
		bool stands = lasts_s > fmax(STAND_S, 4 * update_s) && !(!heights && leaps(track, end, fast_m_s));
		memset(keep + i, 0, end - i);
		if (stands || i == 0 || end == track->count) {
			keep[i] = 1;
			keep[end - 1] |= stands || end == track->count;
		} else
			keep[rough ? i + (end - i) / 2 : i] = 1;
	}
}

/* A recording begins and ends between two positions of its receiver: its first is older than its first record, and its last holds until
 * the last record. Both ends are brought to their times along the neighbouring step. */
static void align_ends(struct eco_track *track, double update_s)
{
	struct eco_fix *f = track->fixes;
	uint32_t first = run_end(track, 0, false), last = track->count - 1, before;
	while (last > 0 && same_place(&f[last - 1], &f[track->count - 1]))
		last--;
	for (before = last; before > 1 && same_place(&f[before - 2], &f[last - 1]); before--)
		;
	double head_s = first < track->count ? f[first].time_s - f[0].time_s : 0, tail_s = f[track->count - 1].time_s - f[last].time_s;
	if (!(update_s > 0) || first >= last)
		return;
	/* a run of its own length is whole: only repeats are cut short */
	for (int axis = 0; axis < 2; axis++) {
		double step = f[last].at[axis] - f[last - 1].at[axis];
		if (first > 1 && head_s < 0.9 * update_s)
			for (uint32_t i = 0; i < first; i++)
				f[i].at[axis] = f[first].at[axis] - (f[first].at[axis] - f[i].at[axis]) * (head_s / update_s);
		if (before < last && tail_s > 0 && tail_s < 1.2 * update_s)
			f[track->count - 1].at[axis] += step * tail_s / update_s;
	}
}

static enum eco_code merge_repeats(struct eco_track *track, struct eco_track_report *report, struct eco_error *error)
{
	double *scratch = malloc((track->count + 1) * sizeof *scratch);
	uint8_t *keep = malloc(2 * (size_t)track->count + 2), *keep_height = keep ? keep + track->count + 1 : NULL;
	if (!scratch || !keep) {
		free(scratch);
		free(keep);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	}
	report->update_s = median_update(track, scratch, false);
	double update_z_s = median_update(track, scratch, true), fast_m_s;
	uint32_t speeds;
	if (track->still_m <= ROUNDED_M)
		align_ends(track, report->update_s);
	track_speeds(track, false, scratch, &speeds);
	fast_m_s = fmax(2 * track_quantile(scratch, speeds, 0.9), 2 * track->still_m / fmax(report->update_s, 0.5));
	merge_runs(track, report->update_s, track->still_m > ROUNDED_M, false, fast_m_s, keep);
	merge_runs(track, update_z_s, track->still_z_m > ROUNDED_M, true, fast_m_s, keep_height);
	uint32_t kept = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		struct eco_fix fix = track->fixes[i];
		report->repeated += !keep[i];
		if (!keep[i])
			fix.at[0] = fix.at[1] = NAN;
		if (!keep_height[i])
			fix.at[2] = NAN;
		if (keep[i] || !isnan(fix.at[2]) || !isnan(fix.yaw_deg) || !isnan(fix.pitch_deg) || !isnan(fix.fov_y_deg))
			track->fixes[kept++] = fix;
	}
	track->count = kept;
	free(scratch);
	free(keep);
	return ECO_OK;
}

/* ---- Jumps and parts, among the fixes that have a position ---- */

struct places {
	const struct eco_track *track;
	uint32_t *index, *part, count;
	double *glide_s;                     /* to be added before a place */
	double middle_m_s, high_m_s;         /* speeds: median, and what nine tenths are below */
	double limit_m_s, limit_m, most_m;   /* a jump is faster and farther */
	bool untimed;
};

static const struct eco_fix *place_at(const struct places *p, uint32_t i) { return &p->track->fixes[p->index[i]]; }

static double flat_distance(const struct eco_fix *a, const struct eco_fix *b)
{
	return hypot(b->at[0] - a->at[0], b->at[1] - a->at[1]);
}

/* Metres a second from place i to k, or metres a step without times; rounding is taken off. */
static double speed(const struct places *p, uint32_t i, uint32_t k)
{
	const struct eco_fix *a = place_at(p, i), *b = place_at(p, k);
	double d = fmax(0, track_distance(a, b) - 3 * p->track->still_m);
	return d / (p->untimed ? k - i : fmax(b->time_s - a->time_s, 1e-3));
}

static bool is_far(const struct places *p, uint32_t i, uint32_t k)
{
	return speed(p, i, k) > p->limit_m_s && track_distance(place_at(p, i), place_at(p, k)) > p->limit_m;
}

static void find_limits(struct places *p, double *scratch)
{
	uint32_t moving = 0, steps = 0;
	if (p->untimed)
		for (uint32_t i = 1; i < p->count; i++) {
			double v = speed(p, i - 1, i);
			if (v > 0)
				scratch[moving++] = v;
		}
	else
		track_speeds(p->track, false, scratch, &moving);
	double middle = track_quantile(scratch, moving, 0.5), high = track_quantile(scratch, moving, 0.9);
	p->middle_m_s = middle;
	p->high_m_s = high;
	/* what never moved gives no measure */
	p->limit_m_s = !(high > 0) ? INFINITY : p->untimed ? fmax(50 * middle, 10 * high) : fmax(4 * middle, 3 * high);
	for (uint32_t i = 1; i < p->count; i++)
		if (!same_place(place_at(p, i - 1), place_at(p, i)))
			scratch[steps++] = flat_distance(place_at(p, i - 1), place_at(p, i));
	p->limit_m = 8 * track_quantile(scratch, steps, 0.5);
	if (!p->track->posed)
		p->limit_m = fmax(p->limit_m, 8);
}

/* Where, within a few places from i on, the track is again where it can have come to from `last`; p->count: nowhere. */
static uint32_t comes_back(const struct places *p, uint32_t last, uint32_t i)
{
	for (uint32_t k = i + 1; k < p->count && k <= i + AHEAD; k++) {
		double seconds = p->untimed ? k - last : place_at(p, k)->time_s - place_at(p, last)->time_s;
		if (track_distance(place_at(p, last), place_at(p, k)) < fmax(1.5 * p->high_m_s * seconds, p->limit_m))
			return k;
	}
	return p->count;
}

/* Whether the step to i is no jump for all its speed: a ride goes on being fast, or was fast before. */
static bool rides(const struct places *p, uint32_t before, uint32_t last, uint32_t i)
{
	double v = speed(p, last, i) / 3;
	return (i + 1 < p->count && speed(p, i, i + 1) > v) || (before < last && speed(p, before, last) > v);
}

/* Marks each place with its part from 1, or 0 where it is a jump. A leap that is short for the track's speed, as when a receiver corrects
 * itself, is no end: the camera glides over it at the track's own speed. Returns the number of parts. */
static uint32_t find_parts(struct places *p, struct eco_track_report *report)
{
	uint32_t parts = 1, last = 0, before = 0;
	if (!p->count)
		return 0;
	p->part[0] = 1;
	memset(p->glide_s, 0, p->count * sizeof *p->glide_s);
	for (uint32_t i = 1; i < p->count; i++) {
		bool other = place_at(p, last)->segment != place_at(p, i)->segment, far = is_far(p, last, i);
		double leap_m = track_distance(place_at(p, last), place_at(p, i));
		uint32_t back = far ? comes_back(p, last, i) : p->count;
		p->most_m = far ? fmax(p->most_m, leap_m) : p->most_m;
		for (; back < p->count && i < back; i++)
			p->part[i] = 0;
		if (far && back == p->count && (other || !rides(p, before, last, i))) {
			bool glides = !p->untimed && leap_m < fmax(GLIDE_S * p->middle_m_s, 3 * p->limit_m);
			if (glides)
				p->glide_s[i] = fmax(0, leap_m / p->high_m_s - (place_at(p, i)->time_s - place_at(p, last)->time_s));
			report->glides += glides;
			parts += !glides;
		} else if (other && p->untimed && leap_m > fmax(3 * p->limit_m, p->track->posed ? 0 : 100))
			parts++;
		p->part[i] = parts;
		before = last;
		last = i;
	}
	return parts;
}

struct part { uint32_t places; double length_m; };

static void measure_parts(struct places *p, struct part *parts)
{
	uint32_t last = ECO_TRACK_FIXES_MAX;
	for (uint32_t i = 0; i < p->count; i++) {
		if (!p->part[i])
			continue;
		struct part *part = &parts[p->part[i] - 1];
		if (last < p->count && p->part[last] == p->part[i])
			part->length_m += track_distance(place_at(p, last), place_at(p, i));
		part->places++;
		last = i;
	}
}

/* Parts of a place or two are jumps too, unless there is nothing else. Numbers the others anew, from 1. */
static uint32_t drop_small_parts(struct places *p, struct part *parts, uint32_t count, uint32_t *number)
{
	uint32_t left = 0, least = 1;
	for (uint32_t i = 0; i < count; i++)
		least = parts[i].places > 3 ? 3 : least;
	for (uint32_t i = 0; i < count; i++) {
		number[i] = parts[i].places >= least ? left + 1 : 0;
		if (number[i])
			parts[left++] = parts[i];
	}
	for (uint32_t i = 0; i < p->count; i++)
		p->part[i] = p->part[i] ? number[p->part[i] - 1] : 0;
	return left;
}

static enum eco_code choose_part(struct eco_track *track, const struct part *parts, uint32_t count, uint32_t wanted, uint32_t *chosen,
	struct eco_error *error)
{
	uint32_t best = 0;
	for (uint32_t i = 1; i < count; i++)
		best = parts[i].length_m > parts[best].length_m ? i : best;
	if (wanted > count)
		return eco_fail(error, ECO_NOT_FOUND, "--part %u: the track has %u part%s", wanted, count, count == 1 ? "" : "s");
	*chosen = wanted ? wanted : best + 1;
	for (uint32_t i = 0; count > 1 && i < count && i < 8; i++)
		eco_track_note(track, "part %u of %u: %u positions, %.0f m%s", i + 1, count, parts[i].places, parts[i].length_m,
			i + 1 != *chosen ? "" : wanted ? ", taken" : ", taken as the longest (--part N for another)");
	return ECO_OK;
}

/* Only what was recorded in the chosen part stays: from its first place to its last. */
static void keep_part(struct eco_track *track, const struct places *p, uint32_t chosen, struct eco_track_report *report)
{
	uint32_t first = ECO_TRACK_FIXES_MAX, end = 0, kept = 0, at = 0;
	double shift_s = 0;
	for (uint32_t i = 0; i < p->count; i++) {
		report->jumped += p->part[i] == 0;
		report->other_parts += p->part[i] != 0 && p->part[i] != chosen;
		if (p->part[i] == chosen) {
			first = first > p->index[i] ? p->index[i] : first;
			end = p->index[i] + 1;
			report->kept++;
		}
	}
	/* the repeats that follow the last place belong to it */
	while (end < track->count && isnan(track->fixes[end].at[0]))
		end++;
	for (uint32_t i = first; i < end; i++) {
		struct eco_fix fix = track->fixes[i];
		while (at < p->count && p->index[at] < i)
			at++;
		if (at < p->count && p->index[at] == i && p->part[at] != chosen)
			fix.at[0] = fix.at[1] = fix.at[2] = NAN;
		if (at < p->count && p->index[at] == i && at > 0 && i > first)
			shift_s += p->glide_s[at];
		fix.time_s += shift_s;
		track->fixes[kept++] = fix;
	}
	track->count = kept;
	report->jump_m = p->most_m;
	report->jump_m_s = p->limit_m_s;
}

static enum eco_code split_parts(struct eco_track *track, struct places *p, uint32_t wanted, struct eco_track_report *report,
	struct eco_error *error)
{
	uint32_t count = find_parts(p, report);
	struct part *parts = calloc(count, sizeof *parts);
	uint32_t *number = calloc(count, sizeof *number);
	enum eco_code code = parts && number ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u parts", count);
	if (!code) {
		measure_parts(p, parts);
		report->parts = drop_small_parts(p, parts, count, number);
		code = choose_part(track, parts, report->parts, wanted, &report->part, error);
	}
	if (!code)
		keep_part(track, p, report->part, report);
	free(parts);
	free(number);
	return code;
}

static enum eco_code drop_jumps(struct eco_track *track, const struct eco_cleaning *cleaning, struct eco_track_report *report,
	struct eco_error *error)
{
	struct places p = { .track = track, .untimed = report->untimed };
	double *scratch = malloc((track->count + 1) * sizeof *scratch);
	p.index = malloc(2 * ((size_t)track->count + 1) * sizeof *p.index);
	p.part = p.index ? p.index + track->count + 1 : NULL;
	enum eco_code code = scratch && p.index ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	for (uint32_t i = 0; !code && i < track->count; i++)
		if (!isnan(track->fixes[i].at[0]))
			p.index[p.count++] = i;
	if (!code) {
		find_limits(&p, scratch);
		p.glide_s = scratch;
		code = split_parts(track, &p, cleaning->part, report, error);
	}
	free(scratch);
	free(p.index);
	return code;
}

/* ---- Long stands ---- */

static enum eco_code shorten_pauses(struct eco_track *track, double pause_s, struct eco_track_report *report, struct eco_error *error)
{
	double *scratch = malloc((track->count + 1) * sizeof *scratch), shift_s = 0;
	uint32_t last = 0, speeds;
	if (!scratch)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	track_speeds(track, false, scratch, &speeds);
	double slow_m_s = 0.05 * track_quantile(scratch, speeds, 0.5);
	struct eco_fix *f = track->fixes;
	for (uint32_t i = 1; i < track->count; i++) {
		if (isnan(f[i].at[0]))
			continue;
		double from_s = f[last].time_s + shift_s, lasts_s = f[i].time_s - from_s;
		if (!(f[i].time_s > 0))
			lasts_s = 0;
		bool long_stand = lasts_s > pause_s && track_distance(&f[last], &f[i]) <= slow_m_s * lasts_s;
		/* what was looked at meanwhile is passed through faster */
		for (uint32_t k = last + 1; k <= i; k++)
			f[k].time_s = f[last].time_s + (f[k].time_s - from_s) * (long_stand ? pause_s / lasts_s : 1);
		if (long_stand) {
			shift_s += lasts_s - pause_s;
			report->pauses++;
		}
		last = i;
	}
	for (uint32_t k = last + 1; k < track->count; k++)
		f[k].time_s -= shift_s;
	report->paused_s = shift_s;
	free(scratch);
	return ECO_OK;
}

/* ---- All of it ---- */

static void count_from_zero(struct eco_track *track)
{
	for (uint32_t i = track->count; i-- > 0; )
		track->fixes[i].time_s -= track->fixes[0].time_s;
	for (uint32_t i = 1; i < track->count; i++)
		if (!(track->fixes[i].time_s > track->fixes[i - 1].time_s))
			track->fixes[i].time_s = track->fixes[i - 1].time_s + 1e-6;
}

enum eco_code eco_track_clean(struct eco_track *track, const struct eco_cleaning *cleaning, struct eco_track_report *report, struct eco_error *error)
{
	*report = (struct eco_track_report){ .fixes = track->count };
	if (!track->count)
		return eco_fail(error, ECO_BAD_INPUT, "the track has no fixes");
	enum eco_code code = choose_heights(track, cleaning->height, report, error);
	if (!code)
		code = track_repair_stamps(track, cleaning->pace_m_s > 0 ? cleaning->pace_m_s : PACE_M_S, report, error);
	if (!code)
		code = merge_repeats(track, report, error);
	if (!code)
		code = drop_jumps(track, cleaning, report, error);
	if (code)
		return code;
	count_from_zero(track);
	return shorten_pauses(track, cleaning->pause_s > 0 ? cleaning->pause_s : PAUSE_S, report, error);
}
