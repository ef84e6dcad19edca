/* Time stamps as clocks, receivers and converters leave them. The order of the file is trusted above its stamps, as recorders append;
 * only a file that is shorter when sorted by time, way by way, is taken to be unsorted. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_clean.h"

#define CLUSTER_S (30 * 86400.0)         /* recordings farther apart are not one */
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

/* ---- Years off ---- */

static void forget_bogus(struct stamps *s)
{
	uint32_t count = finite_stamps(s), low, high;
	track_quantile(s->scratch, count, 0.5);      /* sorts */
	if (count < 3)
		return;
	for (low = count / 2; low > 0 && s->scratch[low] - s->scratch[low - 1] < CLUSTER_S; )
		low--;
	for (high = count / 2; high + 1 < count && s->scratch[high + 1] - s->scratch[high] < CLUSTER_S; )
		high++;
	uint32_t outside = count - (high - low + 1);
	/* many are no accident */
	if (!outside || outside * 10 > count * (count < 20 ? 4 : 1))
		return;
	double from = s->scratch[low], to = s->scratch[high];
	for (uint32_t i = 0; i < s->count; i++)
		if (s->fixes[i].time_s < from || s->fixes[i].time_s > to) {
			s->fixes[i].time_s = NAN;
			s->report->stamps_bogus++;
		}
}

/* ---- Order ---- */

static void count_steps(const struct stamps *s, uint32_t *forward, uint32_t *backward)
{
	double last = NAN;
	*forward = *backward = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double t = s->fixes[i].time_s;
		*forward += t > last;
		*backward += t < last;
		last = isnan(t) ? last : t;
	}
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

static double way(const struct eco_fix *fixes, uint32_t count)
{
	double length = 0;
	for (uint32_t i = 1; i < count; i++)
		length += track_distance(&fixes[i - 1], &fixes[i]);
	return length;
}

struct ordered { struct eco_fix fix; uint32_t place; };

static int by_time(const void *a, const void *b)
{
	const struct ordered *x = a, *y = b;
	int order = (x->fix.time_s > y->fix.time_s) - (x->fix.time_s < y->fix.time_s);
	return order ? order : (x->place > y->place) - (x->place < y->place);
}

/* If the way by time is much shorter than by file. Stamps that are missing would have no place. */
static enum eco_code sort_if_shorter(struct stamps *s, uint64_t backward, struct eco_error *error)
{
	if (finite_stamps(s) < s->count)
		return ECO_OK;
	struct ordered *sorted = malloc(s->count * sizeof *sorted);
	if (!sorted)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", s->count);
	double before = way(s->fixes, s->count), after = 0;
	for (uint32_t i = 0; i < s->count; i++)
		sorted[i] = (struct ordered){ s->fixes[i], i };
	qsort(sorted, s->count, sizeof *sorted, by_time);
	for (uint32_t i = 1; i < s->count; i++)
		after += track_distance(&sorted[i - 1].fix, &sorted[i].fix);
	if (after < 0.7 * before) {
		for (uint32_t i = 0; i < s->count; i++)
			s->fixes[i] = sorted[i].fix;
		s->report->sorted = backward;
	}
	free(sorted);
	return ECO_OK;
}

static double median_step(struct stamps *s)
{
	uint32_t count = 0;
	double last = NAN;
	for (uint32_t i = 0; i < s->count; i++) {
		double t = s->fixes[i].time_s;
		if (t > last)
			s->scratch[count++] = t - last;
		last = isnan(t) ? last : t;
	}
	double step = track_quantile(s->scratch, count, 0.5);
	return step > 0 ? step : 1;
}

/* Whether a stamp within the next few is not before `last_s`. */
static bool comes_back(const struct stamps *s, uint32_t i, double last_s)
{
	for (uint32_t k = i + 1, seen = 0; k < s->count && seen < AHEAD; k++)
		if (!isnan(s->fixes[k].time_s)) {
			if (s->fixes[k].time_s >= last_s)
				return true;
			seen++;
		}
	return false;
}

static void repair_backward(struct stamps *s, double step_s)
{
	uint32_t last = s->count, before = s->count;         /* the last two good stamps; count: none */
	double offset_s = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		struct eco_fix *f = s->fixes;
		if (isnan(f[i].time_s))
			continue;
		f[i].time_s += offset_s;
		if (last < s->count && f[i].time_s < f[last].time_s) {
			double raw = f[last].time_s - offset_s;
			if (comes_back(s, i, raw)) {
				f[i].time_s = NAN;
				s->report->stamps_backward++;
				continue;
			}
			/* one stamp that had run ahead */
			if (before < s->count && f[i].time_s >= f[before].time_s && f[last].time_s - f[before].time_s > 10 * step_s) {
				f[last].time_s = NAN;
				s->report->stamps_backward++;
				last = i;
				continue;
			}
			double back_s = f[last].time_s - f[i].time_s + step_s;
			offset_s += back_s;
			f[i].time_s += back_s;
			s->report->clock_resets++;
		}
		before = last;
		last = i;
	}
}

/* ---- Equal and missing ---- */

/* A clock of whole seconds and several fixes in each: evenly until the next. */
static void spread_equal(struct stamps *s, double step_s)
{
	struct eco_fix *f = s->fixes;
	for (uint32_t i = 0; i < s->count; ) {
		uint32_t end = i + 1, next, equal = 1;
		if (isnan(f[i].time_s)) {
			i++;
			continue;
		}
		for (next = end; next < s->count && (isnan(f[next].time_s) || f[next].time_s == f[i].time_s); next++)
			if (!isnan(f[next].time_s)) {
				equal++;
				end = next + 1;
			}
		double start_s = f[i].time_s, room_s = next < s->count ? f[next].time_s - start_s : step_s;
		/* after the last of them may come a pause */
		room_s = fmin(room_s, step_s * fmax(1, equal));
		for (uint32_t k = i + 1; k < end; k++)
			if (!isnan(f[k].time_s)) {
				f[k].time_s = start_s + room_s * (k - i) / (end - i);
				s->report->stamps_equal++;
			}
		i = end;
	}
}

/* Seconds from fix a to fix b, neither with a good stamp, at the track's own speed. */
struct speed { double m_s, step_s; };

static double guess_s(const struct eco_fix *a, const struct eco_fix *b, struct speed speed)
{
	return speed.m_s > 0 ? fmin(track_distance(a, b) / speed.m_s, 20 * speed.step_s) : speed.step_s;
}

static struct speed own_speed(struct stamps *s, double step_s)
{
	const struct eco_fix *f = s->fixes;
	uint32_t count = 0;
	for (uint32_t i = 1; i < s->count; i++)
		if (f[i].time_s > f[i - 1].time_s && track_distance(&f[i - 1], &f[i]) > 0)
			s->scratch[count++] = track_distance(&f[i - 1], &f[i]) / (f[i].time_s - f[i - 1].time_s);
	return (struct speed){ track_quantile(s->scratch, count, 0.5), step_s };
}

/* Before the first stamp and behind the last by the track's own speed, between two by distance. */
static void fill_missing(struct stamps *s, double step_s)
{
	struct eco_fix *f = s->fixes;
	struct speed speed = own_speed(s, step_s);
	uint32_t last = s->count;
	for (uint32_t i = 0; i < s->count; i++) {
		if (isnan(f[i].time_s))
			continue;
		uint32_t from = last < s->count ? last : 0;
		double whole = way(f + from, i - from + 1), gone = 0;
		for (uint32_t k = from + 1; last < s->count && k < i; k++) {
			gone += track_distance(&f[k - 1], &f[k]);
			double share = whole > 0 ? gone / whole : (double)(k - from) / (i - from);
			f[k].time_s = f[from].time_s + share * (f[i].time_s - f[from].time_s);
		}
		for (uint32_t k = i; last == s->count && k-- > 0; )
			f[k].time_s = f[k + 1].time_s - guess_s(&f[k], &f[k + 1], speed);
		last = i;
	}
	for (uint32_t i = last + 1; i < s->count; i++)
		f[i].time_s = f[i - 1].time_s + guess_s(&f[i - 1], &f[i], speed);
}

static void set_pace(struct stamps *s, double pace_m_s)
{
	s->fixes[0].time_s = 0;
	for (uint32_t i = 1; i < s->count; i++)
		s->fixes[i].time_s = s->fixes[i - 1].time_s + track_distance(&s->fixes[i - 1], &s->fixes[i]) / pace_m_s;
	s->report->untimed = true;
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
	if (report->stamps_missing == s.count || (forward == 0 && backward == 0)) {
		set_pace(&s, pace_m_s);
		free(s.scratch);
		return ECO_OK;
	}
	forget_bogus(&s);
	count_steps(&s, &forward, &backward);
	if (backward > 9 * forward)
		reverse(&s);
	else if (backward >= 3 && backward > (forward + backward) / 20)
		code = sort_if_shorter(&s, backward, error);
	if (!code) {
		double step_s = median_step(&s);
		repair_backward(&s, step_s);
		spread_equal(&s, median_step(&s));
		fill_missing(&s, step_s);
	}
	free(s.scratch);
	return code;
}
