/* What recorders get wrong, undone in an order in which each step can rely on those before: heights, stamps (track_stamps.c), repeated
 * positions, jumps and parts, long stands.
 *
 * A position may be repeated because the GPS is slower than the recording (motion then goes on from first to first), because it was
 * rounded (then the middle of the repeats is nearest to the truth) or because the camera stands (then it is kept at both ends). Positions,
 * heights and looks are told apart all the way: a fix loses only what it does not say. */
#include "ecofiles/import/track/track_read.h"

#include <stdlib.h>
#include <string.h>

#define WINDOW_S 1.0                     /* speeds are measured over */
#define STAND_S 1.5                      /* a repeat that lasts longer may be a stand */
#define ROUNDED_M 0.5                    /* positions in steps of more are rounded roughly */
#define AHEAD 10u                        /* fixes within which a track comes back from a jump */
#define GLIDE_S 20.0                     /* a leap that takes longer at the track's own speed ends a part */

/* ---- Heights ---- */

static enum eco_code choose_heights(struct eco_track *track, enum eco_track_height wanted, struct eco_track_report *report, struct eco_error *error)
{
	uint32_t absolute = 0, relative = 0;
	double first = 0;
	for (uint32_t i = track->count; i-- > 0; ) {
		absolute += !isnan(track->fixes[i].at[2]);
		relative += !isnan(track->fixes[i].above_m);
		first = isnan(track->fixes[i].at[2]) ? first : track->fixes[i].at[2];
	}
	if (wanted == ECO_HEIGHTS_ABSOLUTE && !absolute)
		return eco_fail(error, ECO_BAD_INPUT, "--height abs: the track has no heights above the sea%s", relative ? ", only above take-off (--height "
			"rel)" : "");
	if (wanted == ECO_HEIGHTS_RELATIVE && !relative && !absolute)
		return eco_fail(error, ECO_BAD_INPUT, "--height rel: the track has no heights");
	bool above = wanted != ECO_HEIGHTS_ABSOLUTE && relative > 0 && (relative >= track->count / 2 || !absolute);
	/* the ground, or take-off, is where it begins */
	double zero = !above && (wanted == ECO_HEIGHTS_RELATIVE || wanted == ECO_HEIGHTS_GROUND) ? first : 0;
	report->has_height = above || absolute;
	report->height = wanted == ECO_HEIGHTS_GROUND ? wanted : above || wanted == ECO_HEIGHTS_RELATIVE ? ECO_HEIGHTS_RELATIVE : ECO_HEIGHTS_ABSOLUTE;
	for (uint32_t i = 0; i < track->count; i++) {
		struct eco_fix *fix = &track->fixes[i];
		fix->at[2] = above ? fix->above_m : fix->at[2] - zero;
		report->heights_missing += report->has_height && isnan(fix->at[2]);
	}
	return ECO_OK;
}

/* ---- Distances and medians ---- */

double track_distance(const struct eco_fix *a, const struct eco_fix *b)
{
	double dz = b->at[2] - a->at[2], flat = hypot(b->at[0] - a->at[0], b->at[1] - a->at[1]);
	return isnan(dz) ? flat : hypot(flat, dz);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double track_quantile(double *values, uint32_t count, double share)
{
	if (count)
		qsort(values, count, sizeof *values, by_value);
	return count ? values[(uint32_t)(share * (count - 1))] : 0;
}

uint32_t track_speeds(const struct eco_track *track, bool flat, double *speeds)
{
	const struct eco_fix *f = track->fixes, *last = NULL;
	uint32_t count = 0, still = 0;
	double window_s = track->count ? fmin(WINDOW_S, (f[track->count - 1].time_s - f[0].time_s) / 8) : 0;
	for (uint32_t i = 0; i < track->count; i++) {
		if (isnan(f[i].at[0]) || (last && !(f[i].time_s - last->time_s >= window_s)))
			continue;
		double d = !last ? 0 : flat ? hypot(f[i].at[0] - last->at[0], f[i].at[1] - last->at[1]) : track_distance(last, &f[i]);
		if (d > 0)
			speeds[count++] = d / (f[i].time_s - last->time_s);
		last = &f[i];
	}
	/* a slow drift is no motion either */
	for (double high = track_quantile(speeds, count, 0.9); still < count && speeds[still] < 0.1 * high; )
		still++;
	memmove(speeds, speeds + still, (count - still) * sizeof *speeds);
	return count - still;
}

/* ---- Repeats ---- */

/* One past the run of fixes at one place, or height, that begins at `first`. */
static uint32_t run_end(const struct eco_track *track, uint32_t first, bool heights)
{
	const struct eco_fix *a = &track->fixes[first], *b = a + 1, *end = track->fixes + track->count;
	while (b < end && (heights ? b->at[2] == a->at[2] || (isnan(b->at[2]) && isnan(a->at[2])) : b->at[0] == a->at[0] && b->at[1] == a->at[1]))
		b++;
	return (uint32_t)(b - track->fixes);
}

/* The median time from run to run; the first is no whole one. */
static double median_run(const struct eco_track *track, bool heights, double *scratch)
{
	uint32_t runs = 0;
	for (uint32_t i = 0, end; i < track->count; i = end) {
		end = run_end(track, i, heights);
		if (end < track->count && i > 0)
			scratch[runs++] = track->fixes[end].time_s - track->fixes[i].time_s;
	}
	return track_quantile(scratch, runs, 0.5);
}

/* Which fixes of each run keep what they say: the first (or the middle, where it was rounded), and the last where the camera stands. After a
 * stand motion begins slowly; where it begins with a leap, the receiver had only lost its satellites. Returns the median time of a run. */
static double merge_runs(const struct eco_track *track, bool heights, double *scratch, uint8_t *keep)
{
	const struct eco_fix *f = track->fixes;
	uint32_t last = track->count - 1;
	double update_s = median_run(track, heights, scratch), still_m = heights ? track->still_z_m : track->still_m;
	double fast_m_s = fmax(2 * track_quantile(scratch, track_speeds(track, false, scratch), 0.9), 2 * track->still_m / fmax(update_s, 0.5));
	for (uint32_t i = 0, end; i < track->count; i = end) {
		end = run_end(track, i, heights);
		bool leaps = !heights && end <= last && track_distance(&f[end - 1], &f[end]) > fast_m_s * fmax(f[end].time_s - f[end - 1].time_s, 0.5);
		bool stands = f[end - 1].time_s - f[i].time_s > fmax(STAND_S, 4 * update_s) && !leaps, ends = i == 0 || end > last;
		memset(keep + i, 0, end - i);
		keep[still_m > ROUNDED_M && !stands && !ends ? i + (end - i) / 2 : i] = 1;
		keep[end - 1] |= stands || end > last;
	}
	return update_s;
}

/* A recording begins and ends between two positions of its receiver: its first is older than its first record, and its last holds until
 * the last record. Both ends are brought to their times along the neighbouring step. A run of its own length is whole: only repeats are. */
static void align_ends(struct eco_track *track, double *scratch)
{
	struct eco_fix *f = track->fixes, *end = &f[track->count - 1];
	uint32_t first = run_end(track, 0, false), before = 0, last = 0;
	for (uint32_t next = first; next < track->count; next = run_end(track, next, false)) {
		before = last;
		last = next;
	}
	if (first >= last)
		return;
	double update_s = median_run(track, false, scratch), head_s = f[first].time_s - f[0].time_s, tail_s = end->time_s - f[last].time_s;
	for (int axis = 0; axis < 2 && update_s > 0; axis++) {
		double step = f[last].at[axis] - f[last - 1].at[axis], back = (f[first].at[axis] - f[0].at[axis]) * (head_s / update_s);
		for (uint32_t i = 0; i < first && first > 1 && head_s < 0.9 * update_s; i++)
			f[i].at[axis] = f[first].at[axis] - back;
		if (before + 1 < last && tail_s > 0 && tail_s < 1.2 * update_s)
			end->at[axis] += step * tail_s / update_s;
	}
}

static enum eco_code merge_repeats(struct eco_track *track, struct eco_track_report *report, struct eco_error *error)
{
	double *scratch = malloc((track->count + 1) * sizeof *scratch);
	uint8_t *keep = malloc(2 * (size_t)track->count);
	uint32_t kept = 0, count = track->count;
	if (scratch && keep) {
		if (track->still_m <= ROUNDED_M)
			align_ends(track, scratch);
		report->update_s = merge_runs(track, false, scratch, keep);
		merge_runs(track, true, scratch, keep + count);
	}
	for (uint32_t i = 0; scratch && keep && i < count; i++) {
		struct eco_fix fix = track->fixes[i];
		report->repeated += !keep[i];
		if (!keep[i])
			fix.at[0] = fix.at[1] = NAN;
		if (!keep[count + i])
			fix.at[2] = NAN;
		if (keep[i] || !isnan(fix.at[2]) || !isnan(fix.yaw_deg) || !isnan(fix.pitch_deg) || !isnan(fix.fov_y_deg))
			track->fixes[kept++] = fix;
	}
	track->count = kept;
	free(scratch);
	free(keep);
	return kept ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", count);
}

/* ---- Jumps and parts, among the fixes that have a position ---- */

struct places {
	struct eco_fix **at; uint32_t count;
	double still_m, middle_m_s, high_m_s;        /* speeds: median, and what nine tenths are below */
	double limit_m_s, limit_m, most_m;           /* a jump is faster and farther; the farthest there was */
	bool untimed;
};
struct part { uint32_t places, number; double length_m; };

/* Metres a second from place i to k, or metres a step without times; rounding is taken off. */
static double speed(const struct places *p, uint32_t i, uint32_t k)
{
	double d = fmax(0, track_distance(p->at[i], p->at[k]) - 3 * p->still_m);
	return d / (p->untimed ? k - i : fmax(p->at[k]->time_s - p->at[i]->time_s, 1e-3));
}

static void find_limits(struct places *p, const struct eco_track *track, double *scratch)
{
	uint32_t moving = p->untimed ? 0 : track_speeds(track, false, scratch), steps = 0;
	for (uint32_t i = 1; p->untimed && i < p->count; i++)
		if ((scratch[moving] = speed(p, i - 1, i)) > 0)
			moving++;
	p->middle_m_s = track_quantile(scratch, moving, 0.5);
	p->high_m_s = track_quantile(scratch, moving, 0.9);
	/* what never moved gives no measure */
	p->limit_m_s = !(p->high_m_s > 0) ? INFINITY : p->untimed ? fmax(50 * p->middle_m_s, 10 * p->high_m_s) : fmax(4 * p->middle_m_s, 3 * p->high_m_s);
	for (uint32_t i = 1; i < p->count; i++)
		if ((scratch[steps] = hypot(p->at[i]->at[0] - p->at[i - 1]->at[0], p->at[i]->at[1] - p->at[i - 1]->at[1])) > 0)
			steps++;
	p->limit_m = fmax(8 * track_quantile(scratch, steps, 0.5), track->posed ? 0 : 8);
}

/* Where, within a few places from i on, the track is again where it can have come to from `last`; p->count: nowhere. */
static uint32_t comes_back(const struct places *p, uint32_t last, uint32_t i)
{
	for (uint32_t k = i + 1; k < p->count && k <= i + AHEAD; k++) {
		double seconds = p->untimed ? k - last : p->at[k]->time_s - p->at[last]->time_s;
		if (track_distance(p->at[last], p->at[k]) < fmax(1.5 * p->high_m_s * seconds, p->limit_m))
			return k;
	}
	return p->count;
}

/* Sets each place's segment to its part from 1, or 0 where it is a jump; returns the number of parts. A fast step is no jump where a ride
 * goes on, or was on, at a third of it; a leap that is short for the track's speed, as when a receiver corrects itself, gets time in glide_s. */
static uint32_t find_parts(struct places *p, bool posed, double *glide_s, struct eco_track_report *report)
{
	uint32_t parts = 1, last = 0, before = 0, segment = p->at[0]->segment;
	p->at[0]->segment = 1;
	glide_s[0] = 0;
	for (uint32_t i = 1; i < p->count; before = last, last = i++) {
		double leap_m = track_distance(p->at[last], p->at[i]), v = speed(p, last, i);
		bool far = v > p->limit_m_s && leap_m > p->limit_m, other;
		uint32_t back = far ? comes_back(p, last, i) : p->count;
		p->most_m = far ? fmax(p->most_m, leap_m) : p->most_m;
		for (; back < p->count && i < back; i++)
			p->at[i]->segment = glide_s[i] = 0;
		other = p->at[i]->segment != segment;
		bool rides = (i + 1 < p->count && speed(p, i, i + 1) > v / 3) || (before < last && speed(p, before, last) > v / 3);
		glide_s[i] = 0;
		if (far && back == p->count && (other || !rides)) {
			bool glides = !p->untimed && leap_m < fmax(GLIDE_S * p->middle_m_s, 3 * p->limit_m);
			glide_s[i] = glides ? fmax(0, leap_m / p->high_m_s - (p->at[i]->time_s - p->at[last]->time_s)) : 0;
			report->glides += glides;
			parts += !glides;
		} else if (back == p->count && other && p->untimed && leap_m > fmax(3 * p->limit_m, posed ? 0 : 100))
			parts++;
		segment = p->at[i]->segment;
		p->at[i]->segment = parts;
	}
	return parts;
}

/* Measures and numbers the parts: those of a place or two are jumps too, unless there is nothing else. */
static void number_parts(const struct places *p, struct part *parts, uint32_t count, struct eco_track_report *report)
{
	const struct eco_fix *last = NULL;
	uint32_t least = 1;
	for (uint32_t i = 0; i < p->count; i++) {
		struct part *part = &parts[p->at[i]->segment];
		if (!p->at[i]->segment)
			continue;
		part->length_m += last && last->segment == p->at[i]->segment ? track_distance(last, p->at[i]) : 0;
		least = ++part->places > 3 ? 3 : least;
		last = p->at[i];
	}
	for (uint32_t i = 1; i <= count; i++)
		parts[i].number = parts[i].places >= least ? ++report->parts : 0;
}

static enum eco_code choose_part(struct eco_track *track, struct part *parts, uint32_t count, uint32_t wanted, struct eco_track_report *report,
	struct eco_error *error)
{
	double longest = -1;
	if (wanted > report->parts)
		return eco_fail(error, ECO_NOT_FOUND, "--part %u: the track has %u part%s", wanted, report->parts, report->parts == 1 ? "" : "s");
	report->part = wanted;
	for (uint32_t i = 1; i <= count && !wanted; i++)
		if (parts[i].number && parts[i].length_m > longest) {
			longest = parts[i].length_m;
			report->part = parts[i].number;
		}
	for (uint32_t i = 1; i <= count && report->parts > 1; i++)
		if (parts[i].number && parts[i].number <= 8)
			eco_track_note(track, "part %u of %u: %u positions, %.0f m%s", parts[i].number, report->parts, parts[i].places, parts[i].length_m,
				parts[i].number != report->part ? "" : wanted ? ", taken" : ", taken as the longest (--part N for another)");
	return ECO_OK;
}

/* Only what was recorded in the chosen part stays: from its first place to its last and the repeats that follow it. */
static void keep_part(struct eco_track *track, const struct places *p, const struct part *parts, const double *glide_s, struct eco_track_report *report)
{
	uint32_t kept = 0, at = 0, last = 0;
	double shift_s = 0;
	bool begun = false;
	for (uint32_t i = 0; i < p->count; i++) {
		uint32_t number = parts[p->at[i]->segment].number;
		report->jumped += number == 0;
		report->other_parts += number && number != report->part;
		report->kept += number == report->part;
		last = number == report->part ? i : last;
	}
	struct eco_fix *end = last + 1 < p->count ? p->at[last + 1] : track->fixes + track->count;
	for (struct eco_fix *fix = track->fixes; fix < end; fix++) {
		bool place = at < p->count && p->at[at] == fix, other = place && parts[fix->segment].number != report->part;
		shift_s += place && begun ? glide_s[at] : 0;
		at += place;
		begun |= place && !other;
		if (!begun)
			continue;
		struct eco_fix copy = *fix;
		copy.time_s += shift_s;
		if (other)
			copy.at[0] = copy.at[1] = copy.at[2] = NAN;
		track->fixes[kept++] = copy;
	}
	track->count = kept;
}

static enum eco_code drop_jumps(struct eco_track *track, uint32_t wanted, struct eco_track_report *report, struct eco_error *error)
{
	struct places p = { .untimed = report->untimed, .still_m = track->still_m };
	double *scratch = malloc((track->count + 1) * sizeof *scratch);
	struct part *parts = calloc((size_t)track->count + 2, sizeof *parts);
	p.at = malloc(track->count * sizeof(struct eco_fix *));
	enum eco_code code = scratch && parts && p.at ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	for (uint32_t i = 0; !code && i < track->count; i++)
		if (!isnan(track->fixes[i].at[0]))
			p.at[p.count++] = &track->fixes[i];
	if (!code) {
		find_limits(&p, track, scratch);
		uint32_t count = find_parts(&p, track->posed, scratch, report);
		number_parts(&p, parts, count, report);
		code = choose_part(track, parts, count, wanted, report, error);
	}
	if (!code)
		keep_part(track, &p, parts, scratch, report);
	report->jump_m = p.most_m;
	report->jump_m_s = p.limit_m_s;
	free(scratch);
	free(parts);
	free(p.at);
	return code;
}

/* ---- Long stands ---- */

/* Times count from 0 and ascend. */
static void count_from_zero(struct eco_track *track)
{
	struct eco_fix *f = track->fixes;
	for (uint32_t i = track->count; i-- > 0; )
		f[i].time_s -= f[0].time_s;
	for (uint32_t i = 1; i < track->count; i++)
		f[i].time_s = f[i].time_s > f[i - 1].time_s ? f[i].time_s : f[i - 1].time_s + 1e-6;
}

/* What was looked at during a long stand is passed through faster. */
static enum eco_code shorten_pauses(struct eco_track *track, double pause_s, struct eco_track_report *report, struct eco_error *error)
{
	double *scratch = malloc((track->count + 1) * sizeof *scratch);
	struct eco_fix *f = track->fixes;
	uint32_t last = 0;
	if (!scratch)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	double slow_m_s = 0.05 * track_quantile(scratch, track_speeds(track, false, scratch), 0.5);
	free(scratch);
	for (uint32_t i = 1; i <= track->count; i++) {
		if (i < track->count && isnan(f[i].at[0]))
			continue;
		double from_s = f[last].time_s + report->paused_s, lasts_s = i < track->count ? f[i].time_s - from_s : 0;
		bool long_stand = lasts_s > pause_s && track_distance(&f[last], &f[i]) <= slow_m_s * lasts_s;
		for (uint32_t k = last + 1; k <= i && k < track->count; k++)
			f[k].time_s = f[last].time_s + (f[k].time_s - from_s) * (long_stand ? pause_s / lasts_s : 1);
		report->paused_s += long_stand ? lasts_s - pause_s : 0;
		report->pauses += long_stand;
		last = i;
	}
	return ECO_OK;
}

enum eco_code eco_track_clean(struct eco_track *track, const struct eco_cleaning *cleaning, struct eco_track_report *report, struct eco_error *error)
{
	*report = (struct eco_track_report){ .fixes = track->count };
	enum eco_code code = track->count ? choose_heights(track, cleaning->height, report, error) :
		eco_fail(error, ECO_BAD_INPUT, "the track has no fixes");
	if (!code)
		code = track_repair_stamps(track, cleaning->pace_m_s > 0 ? cleaning->pace_m_s : 10, report, error);
	if (!code)
		code = merge_repeats(track, report, error);
	if (!code)
		code = drop_jumps(track, cleaning->part, report, error);
	if (code)
		return code;
	count_from_zero(track);
	return shorten_pauses(track, cleaning->pause_s > 0 ? cleaning->pause_s : 60, report, error);
}
