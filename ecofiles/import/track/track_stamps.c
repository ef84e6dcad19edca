/* Time stamps as clocks, receivers and converters leave them. The order of the file is trusted above its stamps, as recorders append;
 * only a file that is shorter when sorted by time, way by way, is taken to be unsorted. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/import/track/track_clean.h"

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
	for (uint32_t i = 0, k = s->count - 1; i < k; i++, k--) {
		struct eco_fix swap = s->fixes[i];
		s->fixes[i] = s->fixes[k];
		s->fixes[k] = swap;
	}
	s->report->reversed = true;
}

static int by_time(const void *a, const void *b)
{
	const struct eco_fix *x = *(struct eco_fix *const *)a, *y = *(struct eco_fix *const *)b;
	int order = (x->time_s > y->time_s) - (x->time_s < y->time_s);
	return order ? order : (x > y) - (x < y);
}

/* If the way by time is much shorter than by file. Stamps that are missing would have no place. */
static enum eco_code sort_if_shorter(struct stamps *s, uint32_t backward, struct eco_error *error)
{
	const struct eco_fix **order = malloc(s->count * sizeof *order);
	struct eco_fix *sorted = malloc(s->count * sizeof *sorted);
	double before_m = 0, after_m = 0;
	bool whole = finite_stamps(s) == s->count, there = order && sorted;
	for (uint32_t i = 0; there && i < s->count; i++)
		order[i] = &s->fixes[i];
	if (there)
		qsort(order, s->count, sizeof *order, by_time);
	for (uint32_t i = 0; there && i < s->count; i++) {
		sorted[i] = *order[i];
		before_m += i ? track_distance(&s->fixes[i - 1], &s->fixes[i]) : 0;
		after_m += i ? track_distance(&sorted[i - 1], &sorted[i]) : 0;
	}
	if (whole && after_m < 0.7 * before_m) {
		s->report->sorted = backward;
		for (uint32_t i = 0; i < s->count; i++)
			s->fixes[i] = sorted[i];
	}
	free(order);
	free(sorted);
	return there ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", s->count);
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
	uint32_t steps = 0, first = 0, last;
	for (uint32_t i = 1; i < s->count; i++)
		if (f[i].time_s > f[i - 1].time_s && track_distance(&f[i - 1], &f[i]) > 0)
			s->scratch[steps++] = track_distance(&f[i - 1], &f[i]) / (f[i].time_s - f[i - 1].time_s);
	double m_s = track_quantile(s->scratch, steps, 0.5);
	while (first + 1 < s->count && isnan(f[first].time_s))
		first++;
	for (uint32_t i = first; i-- > 0; )
		f[i].time_s = f[i + 1].time_s - (m_s > 0 ? fmin(track_distance(&f[i], &f[i + 1]) / m_s, 20 * step_s) : step_s);
	for (last = first; last < s->count; last = first) {
		double whole_m = 0, gone_m = 0;
		for (first = last + 1; first < s->count && isnan(f[first].time_s); first++)
			whole_m += track_distance(&f[first - 1], &f[first]);
		whole_m += first < s->count ? track_distance(&f[first - 1], &f[first]) : 0;
		for (uint32_t k = last + 1; k < first; k++) {
			double step_m = track_distance(&f[k - 1], &f[k]);
			gone_m += step_m;
			double share = whole_m > 0 ? gone_m / whole_m : (double)(k - last) / (first - last);
			f[k].time_s = first < s->count ? f[last].time_s + share * (f[first].time_s - f[last].time_s) :
				f[k - 1].time_s + (m_s > 0 ? fmin(step_m / m_s, 20 * step_s) : step_s);
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
		double step_s = count_steps(&s, &forward, &backward);
		if (backward > 9 * forward)
			reverse(&s);
		else if (backward >= 3 && backward > (forward + backward) / 20)
			code = sort_if_shorter(&s, backward, error);
		step_s = count_steps(&s, &forward, &backward);
		repair_backward(&s, step_s);
		spread_equal(&s, count_steps(&s, &forward, &backward));
		fill_missing(&s, step_s);
	}
	free(s.scratch);
	return code;
}
