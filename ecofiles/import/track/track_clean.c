/* Errors of recorders, undone in an order in which each step can rely on those before: time stamps, repeated
 * positions, jumps, gaps. Positions, heights and looks are told apart: a fix loses only what it does not say.
 *
 * The order of the file is trusted above its stamps, as recorders append; only a file most of whose steps run
 * back, or that runs back often, is sorted. A position may be repeated because the GPS is slower than the
 * recording (motion then goes on from first to first), because it was rounded (then the middle of the repeats
 * is nearest to the truth) or because the camera stands (then it is kept at both ends). */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/track/track_read.h"

#define NORTH_STEP_DEG 1e-3              /* to see where north is in a grid */
#define WINDOW_S 1.0                     /* speeds are measured over */
#define FAR_S (30 * 86400.0)             /* from the middle stamp: another recording, or a clock not set */
#define STAND_S 1.5                      /* a repeat that lasts longer may be a stand */
#define ROUNDED_M 0.5                    /* positions in steps of more are rounded roughly */
#define STAMPS_AHEAD 5u                  /* stamps that are asked whether one before them is right */
#define SLOW_MOST 20.0                   /* times slower than usual between stamps; else it stood */
#define AHEAD 10u                        /* positions within which a track comes back from a jump */
#define GLIDE_S 20.0                     /* a leap that takes longer at the track's own speed ends a part */
#define PAUSE_S 60.0                     /* a gap without motion is shortened to it */

/* ---- Places: degrees go to the scene's CRS, or to a plane of the track's own (azimuthal equidistant
 * about its middle), where it will be moved ---- */

/* The least difference of neighbours is the step of rounding; a degree of longitude is shorter. */
static void find_step(struct eco_track *track)
{
	const struct eco_fix *f = track->fixes;
	double least = track->degrees ? 1e-9 : 1e-6, step[2] = { INFINITY, INFINITY };
	for (uint32_t i = 1; i < track->count; i++)
		for (int k = 0; k < 2; k++) {
			double d = fabs(f[i].at[k] - f[i - 1].at[k]);
			step[k] = d > least ? fmin(d, step[k]) : step[k];
		}
	double finer = fmin(step[0] * (track->degrees ? cos(f[0].at[1] / TRACK_DEG) : 1), step[1]);
	track->still_m = isfinite(finer) ? finer * (track->degrees ? ECO_DEGREE_M : 1) : 0;
}

static bool convert(struct eco_crs *crs, double at[2])
{
	double xyz[3] = { at[0], at[1], 0 };
	const char *why;
	bool known;
	if (eco_crs_convert(crs, xyz, &known, &why, NULL) || !known)
		return false;
	memcpy(at, xyz, 2 * sizeof *at);
	return fabs(at[0]) < 1e9 && fabs(at[1]) < 1e9;
}

/* The bearing of true north in the grid is added to bearings. */
static bool convert_fix(struct eco_crs *crs, struct eco_fix *fix, bool degrees)
{
	double north[2] = { fix->at[0], fix->at[1] + NORTH_STEP_DEG };
	if (!convert(crs, fix->at))
		return false;
	if (degrees && !isnan(fix->yaw_deg) && convert(crs, north))
		fix->yaw_deg += TRACK_DEG * atan2(north[0] - fix->at[0], north[1] - fix->at[1]);
	return true;
}

static enum eco_code convert_all(struct eco_crs *crs, struct eco_track *track, const char *name,
	struct eco_error *error)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		track->fixes[kept] = track->fixes[i];
		kept += convert_fix(crs, &track->fixes[kept], track->degrees);
	}
	if (kept < track->count)
		eco_track_note(track, "%u fixes lie outside the area of use of the scene's CRS and are "
			"left out",
			track->count - kept);
	track->count = kept;
	return kept ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "no fix lies in the area of use of the CRS "
		"\"%.100s\"; "
		"--to 0,0,50 moves the track to the scene", name);
}

/* at[2] becomes the height that is asked for. */
static enum eco_code choose_heights(struct eco_track *track, int wanted, struct eco_error *error)
{
	struct eco_fix *f = track->fixes;
	uint32_t absolute = 0, relative = 0;
	double first = 0;
	for (uint32_t i = track->count; i-- > 0; ) {
		absolute += !isnan(f[i].at[2]);
		relative += !isnan(f[i].above_m);
		first = isnan(f[i].at[2]) ? first : f[i].at[2];
	}
	bool above = wanted != ECO_HEIGHTS_ABSOLUTE && relative
		&& (relative >= track->count / 2 || !absolute);
	if (wanted && !above && !absolute)
		return eco_fail(error, ECO_BAD_INPUT, "--height: the track has no heights of this kind%s",
			relative ? ", only above take-off" : "");
	track->has_height = above || absolute;
	track->height = above || wanted == ECO_HEIGHTS_RELATIVE ? ECO_HEIGHTS_RELATIVE : ECO_HEIGHTS_ABSOLUTE;
	/* take-off is where it begins */
	double zero = wanted == ECO_HEIGHTS_RELATIVE ? first : 0;
	for (uint32_t i = 0; i < track->count; i++)
		f[i].at[2] = above ? f[i].above_m : f[i].at[2] - zero;
	uint32_t known = above ? relative : absolute;
	if (track->has_height && known < track->count)
		eco_track_note(track, "%u fixes have no height: interpolated", track->count - known);
	return ECO_OK;
}

enum eco_code eco_track_place(struct eco_track *track, const struct eco_track_options *options,
	struct eco_error *error)
{
	char plane[200];
	bool own = track->degrees && (options->to_given || !options->crs);
	track->local = own && !options->to_given;
	struct eco_frame to = { .crs = own ? plane : options->crs };
	struct eco_crs_request request = { .path = "the track", .frame = &to, .note = eco_track_note,
		.ctx = track, .stated = track->degrees ? "EPSG:4326" : options->track_crs };
	struct eco_crs *crs = NULL;
	if (!track->degrees && options->track_crs && !options->crs)
		return eco_fail(error, ECO_BAD_INPUT, "--track-crs says that the track is in %.80s, but no "
			"CRS of the scene is known: add --scene SCENE.json, or --crs and --origin",
			options->track_crs);
	find_step(track);
	if (options->crs && !own)
		memcpy(to.origin, options->origin, sizeof to.origin);
	const double *middle = track->fixes[track->count / 2].at;
	snprintf(plane, sizeof plane, "+proj=aeqd +lat_0=%.9f +lon_0=%.9f +datum=WGS84 +units=m +type=crs",
		middle[1], middle[0]);
	enum eco_code code = request.stated ? eco_crs_open(&crs, &request, error) : ECO_OK;
	if (crs)
		code = convert_all(crs, track, to.crs, error);
	eco_crs_close(crs);
	for (uint32_t i = 0; !code && i < track->count; i++)
		track->fixes[i].at[2] -= to.origin[2];
	track->degrees &= code != ECO_OK;
	return code ? code : choose_heights(track, options->height, error);
}

/* ---- Distances and speeds ---- */

static double distance_of(const struct eco_fix *a, const struct eco_fix *b)
{
	double dz = b->at[2] - a->at[2], flat = hypot(b->at[0] - a->at[0], b->at[1] - a->at[1]);
	return isnan(dz) ? flat : hypot(flat, dz);
}

ECO_ORDER(by_value, double, [0])

double track_quantile(double *values, uint32_t count, double share)
{
	if (count)
		qsort(values, count, sizeof *values, by_value);
	return count ? values[(uint32_t)(share * (count - 1))] : 0;
}

uint32_t track_speeds(const struct eco_track *track, double *speeds)
{
	const struct eco_fix *f = track->fixes, *last = NULL;
	uint32_t count = 0, still = 0;
	double window_s = track->count ? fmin(WINDOW_S, (f[track->count - 1].time_s - f[0].time_s) / 8) : 0;
	for (uint32_t i = 0; i < track->count; i++) {
		double took_s = last ? f[i].time_s - last->time_s : window_s;
		if (isnan(f[i].at[0]) || isnan(f[i].time_s) || !(took_s >= window_s))
			continue;
		double d = last ? distance_of(last, &f[i]) : 0;
		if (d > 0)
			speeds[count++] = d / fmax(took_s, 1e-9);
		last = &f[i];
	}
	/* a slow drift is no motion either */
	for (double high = track_quantile(speeds, count, 0.9); still < count && speeds[still] < 0.1 * high; )
		still++;
	memmove(speeds, speeds + still, (count - still) * sizeof *speeds);
	return count - still;
}

struct clean {
	struct eco_fix *f; uint32_t count;           /* the track's */
	struct eco_track *track;
	struct eco_track_report *report;
	double *scratch;                             /* count + 1 */
	struct eco_fix **place; uint32_t places;     /* fixes that have a position */
	double middle_m_s, high_m_s;                 /* speeds: median, and what nine tenths are below */
	double limit_m_s, limit_m;                   /* a jump is faster and farther */
};

/* ---- Stamps ---- */

static void forget_bogus(struct clean *c)
{
	uint32_t count = 0, far = 0;
	for (uint32_t i = 0; i < c->count; i++)
		if (!isnan(c->f[i].time_s))
			c->scratch[count++] = c->f[i].time_s;
	double middle = track_quantile(c->scratch, count, 0.5);
	for (uint32_t i = 0; i < c->count; i++)
		far += fabs(c->f[i].time_s - middle) > FAR_S;
	/* many are no accident */
	for (uint32_t i = 0; 4 * far < count && i < c->count; i++)
		if (fabs(c->f[i].time_s - middle) > FAR_S) {
			c->f[i].time_s = NAN;
			c->report->stamps_wrong++;
		}
}

/* Steps forward and backward; the median of the forward ones, or 1. */
static double count_steps(struct clean *c, uint32_t *forward, uint32_t *backward)
{
	double last = NAN;
	*forward = *backward = 0;
	for (uint32_t i = 0; i < c->count; i++) {
		double t = c->f[i].time_s;
		*backward += t < last;
		if (t > last)
			c->scratch[(*forward)++] = t - last;
		last = isnan(t) ? last : t;
	}
	return *forward ? track_quantile(c->scratch, *forward, 0.5) : 1;
}

/* Stamps that are missing come first; lines are in the order of the file. */
static int by_time(const void *a, const void *b)
{
	const struct eco_fix *x = a, *y = b;
	double s = isnan(x->time_s) ? -INFINITY : x->time_s, t = isnan(y->time_s) ? -INFINITY : y->time_s;
	return s != t ? (s > t) - (s < t) : (x->line > y->line) - (x->line < y->line);
}

/* The next few stamps say which one is wrong where one runs back: it, or the one before. A stamp like the one
 * before is forgotten, too: clocks of whole seconds have several fixes in each. */
static void forget_unordered(struct clean *c)
{
	double last_s = -INFINITY;
	for (uint32_t i = 0; i < c->count; i++) {
		double t = c->f[i].time_s;
		uint32_t seen = 0, after_last = 0, after_this = 0;
		for (uint32_t k = i + 1; k < c->count && seen < STAMPS_AHEAD && !isnan(t); k++) {
			seen += !isnan(c->f[k].time_s);
			after_last += c->f[k].time_s >= last_s;
			after_this += c->f[k].time_s >= t;
		}
		bool ahead = 2 * after_last > seen && 2 * after_this < seen;
		if (!isnan(t) && t > last_s && !ahead) {
			last_s = t;
			continue;
		}
		c->report->stamps_equal += t == last_s;
		c->report->stamps_wrong += !isnan(t) && t != last_s;
		c->f[i].time_s = NAN;
	}
}

/* Seconds from the first fix to each, in scratch, at the speed of moving: a stand leaves no distance. */
static void guess_times(struct clean *c, double step_s)
{
	uint32_t speeds = track_speeds(c->track, c->scratch);
	double m_s = track_quantile(c->scratch, speeds, 0.5);
	c->scratch[0] = 0;
	for (uint32_t i = 1; i < c->count; i++) {
		double s = m_s > 0 ? distance_of(&c->f[i - 1], &c->f[i]) / m_s : step_s;
		c->scratch[i] = c->scratch[i - 1] + fmin(fmax(s, 0.01 * step_s), 20 * step_s);
	}
}

/* Between two stamps by distance, but not much slower than usual; else at the track's own speed. */
static void fill_missing(struct clean *c, double step_s)
{
	struct eco_fix *f = c->f;
	const double *guess = c->scratch;
	guess_times(c, step_s);
	for (uint32_t i = 0, end; i < c->count; i = end + 1) {
		for (end = i; end < c->count && isnan(f[end].time_s); )
			end++;
		uint32_t from = i ? i - 1 : end;
		double pace = !i || end == c->count ? 1
			: (f[end].time_s - f[from].time_s) / (guess[end] - guess[from]);
		for (uint32_t k = i; k < end; k++)
			f[k].time_s = f[from].time_s + (guess[k] - guess[from]) * fmin(pace, SLOW_MOST);
	}
}

/* Every fix gets a time, in file order not descending. Without any, a step is a second until retime. */
static void repair_stamps(struct clean *c)
{
	uint32_t forward, backward;
	for (uint32_t i = 0; i < c->count; i++)
		c->report->stamps_missing += isnan(c->f[i].time_s);
	forget_bogus(c);
	count_steps(c, &forward, &backward);
	c->report->untimed = forward + backward == 0;
	if (c->report->untimed) {
		for (uint32_t i = 0; i < c->count; i++)
			c->f[i].time_s = i;
		return;
	}
	c->report->sorted = backward > forward || (backward >= 3 && backward > forward / 20);
	if (c->report->sorted)
		qsort(c->f, c->count, sizeof *c->f, by_time);
	double step_s = count_steps(c, &forward, &backward);
	forget_unordered(c);
	fill_missing(c, step_s);
}

/* ---- Repeats ---- */

/* One past the run of fixes at one place that begins at `first`. */
static uint32_t run_end(const struct clean *c, uint32_t first)
{
	uint32_t end = first + 1;
	while (end < c->count && c->f[end].at[0] == c->f[first].at[0] && c->f[end].at[1] == c->f[first].at[1])
		end++;
	return end;
}

static void merge_repeats(struct clean *c)
{
	uint32_t runs = 0, kept = 0;
	for (uint32_t i = run_end(c, 0), end; i < c->count; i = end)
		if ((end = run_end(c, i)) < c->count)
			c->scratch[runs++] = c->f[end].time_s - c->f[i].time_s;
	double long_s = fmax(STAND_S, 4 * track_quantile(c->scratch, runs, 0.5));
	for (uint32_t i = 0, end; i < c->count; i = end) {
		end = run_end(c, i);
		bool stands = c->f[end - 1].time_s - c->f[i].time_s > long_s;
		bool rounded = c->track->still_m > ROUNDED_M && !stands;
		uint32_t first = rounded && i > 0 && end < c->count ? i + (end - i) / 2 : i;
		for (uint32_t k = i; k < end; k++) {
			struct eco_fix fix = c->f[k];
			bool keeps = k == first || (k == end - 1 && (stands || end == c->count));
			c->report->repeated += !keeps;
			for (int axis = 0; axis < 3 && !keeps; axis++)
				fix.at[axis] = NAN;
			if (keeps || !isnan(fix.yaw_deg) || !isnan(fix.pitch_deg) || !isnan(fix.fov_y_deg))
				c->f[kept++] = fix;
		}
	}
	c->count = c->track->count = kept;
}

/* ---- Jumps and gaps, among the fixes that have a position ---- */

static double distance(const struct clean *c, uint32_t a, uint32_t b)
{
	return distance_of(c->place[a], c->place[b]);
}

/* Metres a second from place a to b; rounding is taken off. */
static double speed(const struct clean *c, uint32_t a, uint32_t b)
{
	double took_s = fmax(c->place[b]->time_s - c->place[a]->time_s, 1e-3);
	return fmax(0, distance(c, a, b) - 3 * c->track->still_m) / took_s;
}

static bool is_far(const struct clean *c, uint32_t a, uint32_t b)
{
	return speed(c, a, b) > c->limit_m_s && distance(c, a, b) > c->limit_m;
}

static void find_limits(struct clean *c)
{
	uint32_t moving = track_speeds(c->track, c->scratch), steps = 0;
	c->middle_m_s = track_quantile(c->scratch, moving, 0.5);
	c->high_m_s = track_quantile(c->scratch, moving, 0.9);
	/* what never moved gives no measure; lines that were drawn have steps as they please */
	double times = c->report->untimed ? 10 : 1;
	c->limit_m_s = c->high_m_s > 0 ? times * fmax(4 * c->middle_m_s, 3 * c->high_m_s) : INFINITY;
	for (uint32_t i = 1; i < c->places; i++)
		if ((c->scratch[steps] = distance(c, i - 1, i)) > 0)
			steps++;
	c->limit_m = fmax(8 * track_quantile(c->scratch, steps, 0.5), 8);
}

/* Drops the places from which the track soon comes back to where it can have come from the last good one. */
static void drop_spikes(struct clean *c)
{
	uint32_t kept = 1;
	for (uint32_t i = 1; i < c->places; i++) {
		uint32_t last = kept - 1, back = i;
		bool far = is_far(c, last, i), comes = false;
		while (far && !comes && ++back < c->places && back <= i + AHEAD) {
			double way_m = 1.5 * c->high_m_s * (c->place[back]->time_s - c->place[last]->time_s);
			comes = distance(c, last, back) < fmax(way_m, c->limit_m);
		}
		for (; comes && i < back; i++)
			for (int k = 0; k < 3; k++)
				c->place[i]->at[k] = NAN;
		c->place[kept++] = c->place[i];
	}
	c->places = kept;
}

/* Whether the step to place i is a jump and no ride, which goes on, or was on, at a third of its speed. */
static bool leaps(const struct clean *c, uint32_t i)
{
	double third = speed(c, i - 1, i) / 3;
	return is_far(c, i - 1, i) && !(i + 1 < c->places && speed(c, i, i + 1) > third)
		&& !(i > 1 && speed(c, i - 2, i - 1) > third);
}

/* How long the step to place i takes: as recorded, but a leap as long as it would at the track's own speed,
 * and a gap without motion no longer than PAUSE_S. INFINITY: a leap that is too long to be glided over. */
static double takes_s(const struct clean *c, uint32_t i)
{
	double took_s = c->place[i]->time_s - c->place[i - 1]->time_s, d = distance(c, i - 1, i);
	bool leap = leaps(c, i);
	if (leap && d >= fmax(GLIDE_S * c->middle_m_s, 3 * c->limit_m))
		return INFINITY;
	if (c->report->untimed)
		return d / ECO_TRACK_PACE_M_S;
	if (leap)
		return fmax(took_s, d / c->high_m_s);
	return took_s > PAUSE_S && d <= 0.05 * c->middle_m_s * took_s ? PAUSE_S : took_s;
}

/* Finds the longest part: places from *first, before *end. Leaves in scratch how long each step takes. */
static void find_longest(struct clean *c, uint32_t *first, uint32_t *end)
{
	double length = 0, longest = -1;
	for (uint32_t i = 1, start = 0; i <= c->places; i++) {
		c->scratch[i] = i < c->places ? takes_s(c, i) : INFINITY;
		if (isfinite(c->scratch[i])) {
			length += distance(c, i - 1, i);
			continue;
		}
		/* what has a place or two is no part */
		c->report->parts += i - start > 2;
		if (length > longest) {
			*first = start;
			*end = i;
			longest = length;
		}
		start = i;
		length = 0;
	}
}

/* Times of a part count from 0 and ascend; looks between two places go along. Only the part is kept. */
static void retime(struct clean *c, uint32_t first, uint32_t end)
{
	struct eco_fix *begin = c->place[first], *stop = end < c->places ? c->place[end] : c->f + c->count;
	double now_s = 0;
	for (uint32_t i = first; i < end; i++) {
		bool more = i + 1 < end;
		const struct eco_fix *next = more ? c->place[i + 1] : stop;
		double from_s = c->place[i]->time_s, took_s = more ? next->time_s - from_s : 1;
		double step_s = more ? c->scratch[i + 1] : 1;
		c->report->retimed += step_s != took_s && !c->report->untimed;
		for (struct eco_fix *fix = c->place[i]; fix < next; fix++)
			fix->time_s = now_s + (fix->time_s - from_s) * (took_s > 0 ? step_s / took_s : 0);
		now_s += step_s;
	}
	for (struct eco_fix *fix = begin + 1; fix < stop; fix++)
		fix->time_s = fix->time_s > fix[-1].time_s ? fix->time_s : fix[-1].time_s + 1e-6;
	c->track->count = (uint32_t)(stop - begin);
	memmove(c->f, begin, c->track->count * sizeof *c->f);
	c->report->kept = end - first;
	c->report->jumped = c->report->fixes - c->report->repeated - c->report->kept;
}

static void drop_jumps(struct clean *c)
{
	uint32_t first = 0, end = 0;
	for (uint32_t i = 0; i < c->count; i++)
		if (!isnan(c->f[i].at[0]))
			c->place[c->places++] = &c->f[i];
	find_limits(c);
	drop_spikes(c);
	find_longest(c, &first, &end);
	retime(c, first, end);
}

void eco_track_clean(struct eco_track *track)
{
	struct clean c = { .f = track->fixes, .count = track->count, .track = track, .report = &track->report,
		.scratch = eco_alloc(track->count + 1u, sizeof(double)),
		.place = eco_alloc(track->count, sizeof(struct eco_fix *)) };
	track->report = (struct eco_track_report){ .fixes = track->count };
	repair_stamps(&c);
	merge_repeats(&c);
	drop_jumps(&c);
	free(c.scratch);
	free(c.place);
}
