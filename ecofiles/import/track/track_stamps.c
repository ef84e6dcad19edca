/* Time stamps as clocks, receivers and converters leave them. The order of the file is trusted above its stamps, as recorders append;
 * only a file that is shorter when sorted by time, way by way, is taken to be unsorted. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define FAR_S (30 * 86400.0)             /* from the middle stamp: of another recording, or of a clock that was not set */
#define AHEAD 5u

struct stamps {
	struct eco_fix *fixes;
	uint32_t count;
	double *scratch;
	struct eco_track_report *report;
};

static uint32_t finite_stamps(const struct stamps *s)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->count; i++)
		if (!isnan(s->fixes[i].time_s))
			s->scratch[count++] = s->fixes[i].time_s;
	return count;
}

static void forget_bogus(struct stamps *s)
{
	uint32_t count = finite_stamps(s), far = 0;
	double middle = track_quantile(s->scratch, count, 0.5);
	for (uint32_t i = 0; i < count; i++)
		far += fabs(s->scratch[i] - middle) > FAR_S;
	/* many are no accident */
	if (count < 3 || far * 10 > count * (count < 20 ? 4 : 1))
		return;
	for (uint32_t i = 0; far && i < s->count; i++)
		if (fabs(s->fixes[i].time_s - middle) > FAR_S)
			s->fixes[i].time_s = NAN;
	s->report->stamps_bogus = far;
}

/* ---- Order ---- */

/* Steps forward and backward; the median of the forward ones, or 1. */
static double count_steps(struct stamps *s, uint32_t *forward, uint32_t *backward)
{
	double last = NAN;
	*forward = *backward = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double t = s->fixes[i].time_s;
		*backward += t < last;
		if (t > last)
			s->scratch[(*forward)++] = t - last;
		last = isnan(t) ? last : t;
	}
	return *forward ? track_quantile(s->scratch, *forward, 0.5) : 1;
}

static void reverse(struct stamps *s)
{
	for (struct eco_fix *a = s->fixes, *b = s->fixes + s->count - 1; a < b; a++, b--) {
		struct eco_fix swap = *a;
		*a = *b;
		*b = swap;
	}
	s->report->reversed = true;
}

static double way_m(const struct eco_fix *fixes, uint32_t count)
{
	double length = 0;
	for (uint32_t i = 1; i < count; i++)
		length += track_distance(&fixes[i - 1], &fixes[i]);
	return length;
}

/* Lines are in the order of the file. */
static int by_time(const void *a, const void *b)
{
	const struct eco_fix *x = a, *y = b;
	int order = (x->time_s > y->time_s) - (x->time_s < y->time_s);
	return order ? order : (x->line > y->line) - (x->line < y->line);
}

/* If the way by time is much shorter than by file. Stamps that are missing would have no place. */
static enum eco_code sort_if_shorter(struct stamps *s, uint32_t backward, struct eco_error *error)
{
	struct eco_fix *sorted = finite_stamps(s) == s->count ? malloc(s->count * sizeof *sorted) : s->fixes;
	if (!sorted)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", s->count);
	if (sorted == s->fixes)
		return ECO_OK;
	memcpy(sorted, s->fixes, s->count * sizeof *sorted);
	qsort(sorted, s->count, sizeof *sorted, by_time);
	if (way_m(sorted, s->count) < 0.7 * way_m(s->fixes, s->count)) {
		s->report->sorted = backward;
		memcpy(s->fixes, sorted, s->count * sizeof *sorted);
	}
	free(sorted);
	return ECO_OK;
}

/* Whether a stamp within the next few is not before `last_s`. */
static bool comes_back(const struct stamps *s, uint32_t i, double last_s)
{
	for (uint32_t k = i + 1, seen = 0; k < s->count && seen < AHEAD; k++) {
		if (s->fixes[k].time_s >= last_s)
			return true;
		seen += !isnan(s->fixes[k].time_s);
	}
	return false;
}

/* One that runs back is forgotten, and so is one that had run ahead; else the clock was set back, and goes on. */
static void repair_backward(struct stamps *s, double step_s)
{
	struct eco_fix *f = s->fixes;
	uint32_t last = s->count, before = s->count;         /* the last two good stamps; count: none */
	double offset_s = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		f[i].time_s += offset_s;
		if (isnan(f[i].time_s))
			continue;
		bool back = last < s->count && f[i].time_s < f[last].time_s;
		if (back && comes_back(s, i, f[last].time_s - offset_s)) {
			f[i].time_s = NAN;
			s->report->stamps_backward++;
			continue;
		}
		bool ahead = back && before < s->count && f[i].time_s >= f[before].time_s && f[last].time_s - f[before].time_s > 10 * step_s;
		if (ahead) {
			f[last].time_s = NAN;
			s->report->stamps_backward++;
		} else if (back) {
			double back_s = f[last].time_s - f[i].time_s + step_s;
			offset_s += back_s;
			f[i].time_s += back_s;
			s->report->clock_resets++;
		}
		before = ahead ? before : last;
		last = i;
	}
}

/* ---- Equal and missing ---- */

/* A clock of whole seconds and several fixes in each: evenly until the next, but after the last of them may come a pause. */
static void spread_equal(struct stamps *s, double step_s)
{
	struct eco_fix *f = s->fixes;
	for (uint32_t i = 0, end; i < s->count; i = end) {
		uint32_t next = i + 1, equal = 1;
		end = i + 1;
		for (; !isnan(f[i].time_s) && next < s->count && !(f[next].time_s > f[i].time_s); next++)
			if (!isnan(f[next].time_s)) {
				equal++;
				end = next + 1;
			}
		double room_s = fmin(next < s->count ? f[next].time_s - f[i].time_s : step_s, step_s * equal);
		for (uint32_t k = i + 1; k < end; k++)
			f[k].time_s = isnan(f[k].time_s) ? NAN : f[i].time_s + room_s * (k - i) / (end - i);
		s->report->stamps_equal += equal - 1;
	}
}

/* Between two stamps by distance; before the first and behind the last at the track's own speed. */
static void fill_missing(struct stamps *s, double step_s)
{
	struct eco_fix *f = s->fixes;
	uint32_t speeds = 0, next = 0;
	for (uint32_t i = 1; i < s->count; i++)
		if (f[i].time_s > f[i - 1].time_s && track_distance(&f[i - 1], &f[i]) > 0)
			s->scratch[speeds++] = track_distance(&f[i - 1], &f[i]) / (f[i].time_s - f[i - 1].time_s);
	double s_per_m = speeds ? 1 / track_quantile(s->scratch, speeds, 0.5) : 0;
	while (next + 1 < s->count && isnan(f[next].time_s))
		next++;
	for (uint32_t i = next; i-- > 0; )
		f[i].time_s = f[i + 1].time_s - (speeds ? fmin(track_distance(&f[i], &f[i + 1]) * s_per_m, 20 * step_s) : step_s);
	for (uint32_t last = next; last < s->count; last = next) {
		for (next = last + 1; next < s->count && isnan(f[next].time_s); )
			next++;
		double whole_m = next < s->count ? way_m(f + last, next - last + 1) : 0, gone_m = 0;
		for (uint32_t k = last + 1; k < next; k++) {
			double step_m = track_distance(&f[k - 1], &f[k]), guess_s = speeds ? fmin(step_m * s_per_m, 20 * step_s) : step_s;
			gone_m += step_m;
			f[k].time_s = next == s->count ? f[k - 1].time_s + guess_s : f[last].time_s + (f[next].time_s - f[last].time_s) *
				(whole_m > 0 ? gone_m / whole_m : (double)(k - last) / (next - last));
		}
	}
}

enum eco_code track_repair_stamps(struct eco_track *track, double pace_m_s, struct eco_track_report *report, struct eco_error *error)
{
	struct stamps s = { track->fixes, track->count, malloc((track->count + 1) * sizeof(double)), report };
	uint32_t forward, backward;
	enum eco_code code = ECO_OK;
	if (!s.scratch)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	report->stamps_missing = s.count - finite_stamps(&s);
	count_steps(&s, &forward, &backward);
	report->untimed = forward == 0 && backward == 0;
	for (uint32_t i = 0; report->untimed && i < s.count; i++)
		s.fixes[i].time_s = i ? s.fixes[i - 1].time_s + track_distance(&s.fixes[i - 1], &s.fixes[i]) / pace_m_s : 0;
	if (!report->untimed) {
		forget_bogus(&s);
		count_steps(&s, &forward, &backward);
		if (backward > 9 * forward)
			reverse(&s);
		else if (backward >= 3 && backward > (forward + backward) / 20)
			code = sort_if_shorter(&s, backward, error);
		double step_s = count_steps(&s, &forward, &backward);
		repair_backward(&s, step_s);
		spread_equal(&s, count_steps(&s, &forward, &backward));
		fill_missing(&s, step_s);
	}
	free(s.scratch);
	return code;
}
