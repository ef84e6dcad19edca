/* From fixes to even, smooth motion.
 *
 * Between fixes: piecewise cubics whose slopes are the weighted harmonic means of the neighbours' (Fritsch and Butland 1984), which never
 * leave the range of two fixes, so that uneven times and stands cause no overshoot. Then a Gaussian filter, twice (what the first took
 * off is filtered and given back: Tukey's twicing), which bends curves far less than one alone would. Ends are continued by point
 * reflection, so that the first and last positions stay.
 *
 * How much: positions are rounded (4 decimals of a degree are 11 m) and drawn out of noise; the filter must span a few steps of
 * rounding at the track's speed, and much of the time between fixes, so that no corner is left at one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_clean.h"

#define DEG 57.29577951308232
#define SAMPLES_MAX 200000u
#define STEP_LEAST_S 0.004
#define SPAN 4.0                         /* of the filter, in standard deviations */
#define GPS_NOISE_M 2.0                  /* of fixes against each other */
#define SMOOTH_MOST_S 15.0
#define LOOK_S 1.0                       /* directions of motion are smoothed over at least this */
#define FOV_DEG 60.0
#define FLIGHT_PITCH_DEG (-15.0)

/* Values over time; `wide` numbers each. */
struct series { double *time_s, *value; uint32_t count, wide; };

struct work {
	struct eco_flight *flight;
	const struct eco_track *track;
	const struct eco_smoothing *smoothing;
	struct series place, height, attitude, fov;          /* attitude: look, up */
	double *x[3], *yaw, *scratch;        /* per sample */
	bool follows;                        /* the path says where it looks, somewhere */
	double speed_m_s, slow_m_s;          /* median while it moves; and what most of it is faster than */
};

/* ---- Series ---- */

static enum eco_code series_open(struct series *s, uint32_t room, uint32_t wide, struct eco_error *error)
{
	s->time_s = malloc(((size_t)room + 1) * (wide + 1) * sizeof *s->time_s);
	s->value = s->time_s ? s->time_s + room + 1 : NULL;
	s->wide = wide;
	return s->time_s ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", room);
}

static void series_add(struct series *s, double time_s, const double *value)
{
	s->time_s[s->count] = time_s;
	memcpy(s->value + (size_t)s->wide * s->count++, value, s->wide * sizeof *value);
}

static double slope(const struct series *s, uint32_t i, uint32_t n)
{
	if (i == 0 || i + 1 >= s->count)
		return NAN;
	double h0 = s->time_s[i] - s->time_s[i - 1], h1 = s->time_s[i + 1] - s->time_s[i];
	double a = (s->value[(size_t)i * s->wide + n] - s->value[(size_t)(i - 1) * s->wide + n]) / h0;
	double b = (s->value[(size_t)(i + 1) * s->wide + n] - s->value[(size_t)i * s->wide + n]) / h1;
	return a * b <= 0 ? 0 : 3 * (h0 + h1) / ((2 * h1 + h0) / a + (h1 + 2 * h0) / b);
}

/* Number n at time_s, which does not descend from call to call: *at is where the last one was found, 0 before. */
static double series_at(const struct series *s, double time_s, uint32_t n, uint32_t *at)
{
	while (*at + 1 < s->count && s->time_s[*at + 1] <= time_s)
		++*at;
	double a = s->value[(size_t)*at * s->wide + n];
	if (*at + 1 >= s->count || time_s <= s->time_s[*at])
		return a;
	double h = s->time_s[*at + 1] - s->time_s[*at], t = (time_s - s->time_s[*at]) / h, r = 1 - t;
	double b = s->value[(size_t)(*at + 1) * s->wide + n], chord = (b - a) / h, m0 = slope(s, *at, n), m1 = slope(s, *at + 1, n);
	m0 = isnan(m0) ? chord : m0;
	m1 = isnan(m1) ? chord : m1;
	return a + t * t * (3 - 2 * t) * (b - a) + h * t * r * (r * m0 - t * m1);
}

/* ---- Smoothing of evenly spaced values ---- */

static double reflected(const double *v, uint32_t count, int64_t i)
{
	int64_t last = (int64_t)count - 1;
	if (last == 0)
		return v[0];
	if (i < 0)
		return 2 * v[0] - v[-i > last ? last : -i];
	if (i > last)
		return 2 * v[last] - v[2 * last - i < 0 ? 0 : 2 * last - i];
	return v[i];
}

static void gauss(const double *v, uint32_t count, double sigma, double *out)
{
	int64_t radius = (int64_t)ceil(SPAN * sigma);
	double weight[1024], sum = 0;
	if (radius > 1023)
		radius = 1023;
	for (int64_t k = 0; k <= radius; k++) {
		weight[k] = exp(-0.5 * (double)(k * k) / (sigma * sigma));
		sum += weight[k] * (k ? 2 : 1);
	}
	for (int64_t i = 0; i < count; i++) {
		double value = weight[0] * v[i];
		for (int64_t k = 1; k <= radius; k++)
			value += weight[k] * (i >= k && i + k < count ? v[i - k] + v[i + k] : reflected(v, count, i - k) + reflected(v, count, i + k));
		out[i] = value / sum;
	}
}

/* In place; scratch holds 2 count. */
static void smooth(double *v, uint32_t count, double sigma, double *scratch)
{
	double *once = scratch, *rest = scratch + count;
	if (!(sigma > 0.2) || count < 3)
		return;
	gauss(v, count, sigma, once);
	for (uint32_t i = 0; i < count; i++)
		v[i] -= once[i];
	gauss(v, count, sigma, rest);
	for (uint32_t i = 0; i < count; i++)
		v[i] = once[i] + rest[i];
}

/* ---- What the recording is like ---- */

static double median_step(const struct series *s, double *scratch)
{
	for (uint32_t i = 1; i < s->count; i++)
		scratch[i - 1] = s->time_s[i] - s->time_s[i - 1];
	return track_quantile(scratch, s->count ? s->count - 1 : 0, 0.5);
}

static double default_smoothing(const struct work *w, double step_s)
{
	double v = w->slow_m_s, rounding_s, noise_s;
	if (w->track->posed || !(v > 0))
		return 0;
	rounding_s = 1.5 * w->track->still_m / v;
	/* where each fix is off by a part of the way to the next, several are needed to know better */
	if (w->track->still_m > 0.1 * w->speed_m_s * step_s)
		rounding_s = fmax(rounding_s, fmin(4 * step_s, 1));
	noise_s = fmin(GPS_NOISE_M / v, 2);
	return fmin(fmax(0.4 * step_s, fmax(rounding_s, noise_s)), SMOOTH_MOST_S);
}

static double length_s(const struct eco_track *track)
{
	return track->count ? track->fixes[track->count - 1].time_s : 0;
}

/* Fine enough for what is recorded and for the filter, coarse enough to be few. */
static void choose_samples(struct work *w, double place_s, double attitude_s)
{
	double length = length_s(w->track), step = place_s > 0 ? place_s / 4 : length;
	if (attitude_s > 0)
		step = fmin(step, attitude_s);
	step = fmax(step, fmax(w->flight->smooth_s / 20, w->follows ? LOOK_S / 50 : STEP_LEAST_S));
	step = fmax(step, length / (SAMPLES_MAX - 1));
	if (!(length > 0) || !(step > 0)) {
		w->flight->step_s = 1;
		w->flight->count = 1;
		return;
	}
	double pieces = ceil(length / step - 1e-9);
	w->flight->count = (uint32_t)fmax(pieces, 1) + 1;
	w->flight->step_s = length / (w->flight->count - 1);
}

/* ---- Directions ---- */

static void axes_of(double yaw_deg, double pitch_deg, double roll_deg, double look[3], double up[3])
{
	double sy = sin(yaw_deg / DEG), cy = cos(yaw_deg / DEG), sp = sin(pitch_deg / DEG), cp = cos(pitch_deg / DEG), sr = sin(roll_deg / DEG),
		cr = cos(roll_deg / DEG);
	const double right[3] = { cy, -sy, 0 }, level[3] = { -sp * sy, -sp * cy, cp };
	look[0] = cp * sy;
	look[1] = cp * cy;
	look[2] = sp;
	for (int i = 0; i < 3; i++)
		up[i] = cr * level[i] + sr * right[i];
}

/* Yaw of the motion at each sample; where it stands, from before to after. */
static void follow_path(struct work *w)
{
	struct eco_flight *f = w->flight;
	uint32_t n = f->count, last = n;
	double sigma = fmax(w->track->posed ? 0 : LOOK_S, f->smooth_s) / f->step_s, *vx = w->scratch + 2 * (size_t)n, *vy = vx + n;
	for (uint32_t i = 0; i < n; i++) {
		uint32_t a = i ? i - 1 : 0, b = i + 1 < n ? i + 1 : i;
		vx[i] = b > a ? (w->x[0][b] - w->x[0][a]) / ((b - a) * f->step_s) : 0;
		vy[i] = b > a ? (w->x[1][b] - w->x[1][a]) / ((b - a) * f->step_s) : 0;
	}
	smooth(vx, n, fmin(sigma, 250), w->scratch);
	smooth(vy, n, fmin(sigma, 250), w->scratch);
	for (uint32_t i = 0; i < n; i++) {
		if (!(hypot(vx[i], vy[i]) > 0.15 * w->speed_m_s))
			continue;
		double yaw = atan2(vx[i], vy[i]) * DEG, before = last < n ? w->yaw[last] : yaw;
		yaw += 360 * floor((before - yaw) / 360 + 0.5);
		for (uint32_t k = last < n ? last + 1 : 0; k < i; k++)
			w->yaw[k] = last < n ? before + (yaw - before) * (k - last) / (i - last) : yaw;
		w->yaw[i] = yaw;
		last = i;
	}
	for (uint32_t k = last < n ? last + 1 : 0; k < n; k++)
		w->yaw[k] = last < n ? w->yaw[last] : 0;
	smooth(w->yaw, n, fmin(sigma / 2, 250), w->scratch);
}

static double yaw_at(const struct work *w, double time_s)
{
	double at = time_s / w->flight->step_s;
	uint32_t i = at > 0 ? (uint32_t)fmin(at, w->flight->count - 1) : 0, k = i + 1 < w->flight->count ? i + 1 : i;
	return w->yaw[i] + (w->yaw[k] - w->yaw[i]) * fmin(fmax(at - i, 0), 1);
}

static void set_unit(double v[3], const double otherwise[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int i = 0; i < 3; i++)
		v[i] = length > 1e-6 ? v[i] / length : otherwise[i];
}

/* Units at right angles again, after each number was interpolated by itself. */
static void straighten(struct eco_sample *s, const struct eco_sample *before)
{
	static const double north[3] = { 0, 1, 0 }, z[3] = { 0, 0, 1 };
	double dot = 0;
	set_unit(s->look, before ? before->look : north);
	for (int i = 0; i < 3; i++)
		dot += s->up[i] * s->look[i];
	for (int i = 0; i < 3; i++)
		s->up[i] -= dot * s->look[i];
	set_unit(s->up, before ? before->up : z);
}

/* Recorded looks, what they lack taken from the path and the options. */
static void add_attitudes(struct work *w)
{
	for (uint32_t i = 0; i < w->track->count; i++) {
		const struct eco_fix *fix = &w->track->fixes[i];
		double axes[6];
		if (isnan(fix->yaw_deg) && isnan(fix->pitch_deg))
			continue;
		bool own_pitch = !isnan(fix->pitch_deg) && !w->smoothing->pitch_given_wins;
		axes_of(isnan(fix->yaw_deg) ? yaw_at(w, fix->time_s) : fix->yaw_deg, own_pitch ? fix->pitch_deg : w->flight->pitch_deg,
			isnan(fix->roll_deg) ? 0 : fix->roll_deg, axes, axes + 3);
		series_add(&w->attitude, fix->time_s, axes);
	}
}

static void sample_attitudes(struct work *w, double sigma_s)
{
	struct eco_flight *f = w->flight;
	double *column = w->scratch + 2 * (size_t)f->count;
	for (uint32_t n = 0; n < 6; n++) {
		uint32_t at = 0;
		for (uint32_t i = 0; i < f->count; i++)
			column[i] = series_at(&w->attitude, i * f->step_s, n, &at);
		smooth(column, f->count, sigma_s / f->step_s, w->scratch);
		for (uint32_t i = 0; i < f->count; i++)
			(n < 3 ? f->samples[i].look : f->samples[i].up)[n % 3] = column[i];
	}
}

static void look_along_path(struct work *w)
{
	for (uint32_t i = 0; i < w->flight->count; i++)
		axes_of(w->yaw[i], w->flight->pitch_deg, 0, w->flight->samples[i].look, w->flight->samples[i].up);
}

/* ---- All of it ---- */

static enum eco_code collect(struct work *w, struct eco_error *error)
{
	const struct eco_track *t = w->track;
	enum eco_code code = series_open(&w->place, t->count, 2, error);
	if (!code)
		code = series_open(&w->height, t->count, 1, error);
	if (!code)
		code = series_open(&w->attitude, t->count, 6, error);
	if (!code)
		code = series_open(&w->fov, t->count, 1, error);
	for (uint32_t i = 0; !code && i < t->count; i++) {
		const struct eco_fix *fix = &t->fixes[i];
		if (!isnan(fix->at[0]))
			series_add(&w->place, fix->time_s, fix->at);
		if (!isnan(fix->at[2]))
			series_add(&w->height, fix->time_s, &fix->at[2]);
		if (!isnan(fix->fov_y_deg) && isnan(w->smoothing->fov_y_deg))
			series_add(&w->fov, fix->time_s, &fix->fov_y_deg);
		w->flight->yaw_recorded |= !isnan(fix->yaw_deg);
		w->flight->pitch_recorded |= !isnan(fix->pitch_deg) && !w->smoothing->pitch_given_wins;
	}
	if (!code && !w->place.count)
		code = eco_fail(error, ECO_BAD_INPUT, "the track has no position left");
	return code;
}

static void sample_places(struct work *w)
{
	struct eco_flight *f = w->flight;
	for (int axis = 0; axis < 3; axis++) {
		uint32_t at = 0;
		const struct series *s = axis < 2 ? &w->place : &w->height;
		for (uint32_t i = 0; i < f->count; i++)
			w->x[axis][i] = s->count ? series_at(s, i * f->step_s, axis < 2 ? (uint32_t)axis : 0, &at) : 0;
		/* rounded heights stay on a step for longer than positions */
		double sigma_s = f->smooth_s;
		if (axis == 2 && s->count > 2 && !w->track->posed && isnan(w->smoothing->smooth_s))
			sigma_s = fmin(fmax(sigma_s, 0.6 * median_step(s, w->scratch)), SMOOTH_MOST_S);
		smooth(w->x[axis], f->count, fmin(sigma_s / f->step_s, 250), w->scratch);
	}
}

static void finish(struct work *w)
{
	struct eco_flight *f = w->flight;
	uint32_t at = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i];
		for (int axis = 0; axis < 3; axis++)
			s->eye[axis] = w->x[axis][i];
		s->fov_y_deg = !isnan(w->smoothing->fov_y_deg) ? w->smoothing->fov_y_deg : w->fov.count ? series_at(&w->fov, i * f->step_s, 0, &at) : FOV_DEG;
		straighten(s, i ? s - 1 : NULL);
		if (i)
			f->length_m += sqrt(pow(s->eye[0] - s[-1].eye[0], 2) + pow(s->eye[1] - s[-1].eye[1], 2) + pow(s->eye[2] - s[-1].eye[2], 2));
	}
	for (uint32_t i = 0; i < w->place.count; i++) {
		const double *v = w->place.value + 2 * (size_t)i;
		uint32_t k = (uint32_t)fmin(w->place.time_s[i] / f->step_s + 0.5, f->count - 1);
		f->moved_m = fmax(f->moved_m, hypot(v[0] - f->samples[k].eye[0], v[1] - f->samples[k].eye[1]));
	}
}

static enum eco_code make_samples(struct work *w, struct eco_error *error)
{
	struct eco_flight *f = w->flight;
	size_t n = f->count;
	f->samples = calloc(n, sizeof *f->samples);
	double *rows = malloc(4 * n * sizeof *rows);
	/* the filter's two, two velocities or a column, and the medians of series */
	w->scratch = malloc((4 * n + w->track->count + 1) * sizeof *w->scratch);
	if (!f->samples || !rows || !w->scratch) {
		free(rows);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %zu samples", n);
	}
	for (int axis = 0; axis < 3; axis++)
		w->x[axis] = rows + n * (size_t)axis;
	w->yaw = rows + 3 * n;
	sample_places(w);
	if (w->follows)
		follow_path(w);
	add_attitudes(w);
	if (w->attitude.count) {
		double attitude_s = median_step(&w->attitude, w->scratch);
		bool as_they_are = w->track->posed && isnan(w->smoothing->smooth_s);
		sample_attitudes(w, as_they_are ? 0 : fmin(f->smooth_s, fmax(0.6 * attitude_s, 0.1)));
	} else
		look_along_path(w);
	finish(w);
	free(rows);
	return ECO_OK;
}

enum eco_code eco_flight_make(struct eco_flight *flight, const struct eco_track *track, const struct eco_smoothing *smoothing,
	struct eco_error *error)
{
	struct work w = { .flight = flight, .track = track, .smoothing = smoothing };
	uint32_t speeds;
	*flight = (struct eco_flight){ 0 };
	enum eco_code code = collect(&w, error);
	double *scratch = code ? NULL : malloc((track->count + 1) * sizeof *scratch), attitude_s = INFINITY, last_s = NAN;
	if (!code && !scratch)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	if (!code) {
		double step_s = median_step(&w.place, scratch);
		track_speeds(track, true, scratch, &speeds);
		w.speed_m_s = track_quantile(scratch, speeds, 0.5);
		w.slow_m_s = track_quantile(scratch, speeds, 0.25);
		flight->smooth_s = isnan(smoothing->smooth_s) ? default_smoothing(&w, step_s) : smoothing->smooth_s;
		flight->pitch_deg = !isnan(smoothing->pitch_deg) ? smoothing->pitch_deg : smoothing->flies ? FLIGHT_PITCH_DEG : 0;
		for (uint32_t i = 0; i < track->count; i++)
			if (!isnan(track->fixes[i].yaw_deg) || !isnan(track->fixes[i].pitch_deg)) {
				attitude_s = track->fixes[i].time_s - last_s < attitude_s ? track->fixes[i].time_s - last_s : attitude_s;
				last_s = track->fixes[i].time_s;
				w.follows |= isnan(track->fixes[i].yaw_deg);
			}
		w.follows |= isnan(last_s);
		choose_samples(&w, step_s, isfinite(attitude_s) ? attitude_s : 0);
		code = make_samples(&w, error);
	}
	free(scratch);
	free(w.scratch);
	free(w.place.time_s);
	free(w.height.time_s);
	free(w.attitude.time_s);
	free(w.fov.time_s);
	if (code)
		eco_flight_free(flight);
	return code;
}

void eco_flight_free(struct eco_flight *flight)
{
	free(flight->samples);
	*flight = (struct eco_flight){ 0 };
}
