/* From fixes to even, smooth motion.
 *
 * Between fixes: piecewise cubics whose slopes are the weighted harmonic means of the neighbours' (Fritsch
 * and Butland 1984), which never leave the range of two fixes, so that uneven times and stands cause no
 * overshoot. Then a Gaussian filter, and what it took off is filtered and given back (Tukey's twicing), which
 * bends curves far less than the filter alone would.
 *
 * The filter spans a few steps of rounding (4 decimals of a degree are 11 m) at the track's speed, and much
 * of the time between fixes. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define SAMPLES_MAX 200000u
#define STEP_LEAST_S 0.004
#define SPAN 6.0                         /* of the filter, in standard deviations */
#define SIGMA_MAX 250.0                  /* in samples */
#define RADIUS_MAX 1504                  /* SPAN * SIGMA_MAX and more than one */
#define GPS_NOISE_M 2.0                  /* of fixes against each other */
#define SMOOTH_MOST_S 15.0
#define LOOK_S 1.0                       /* directions of motion are smoothed over at least this */
#define FOV_DEG 60.0
#define TURN_MOST_DEG 170.0              /* between two samples */
#define FLIGHT_PITCH_DEG (-15.0)

enum { EYE = 0, LOOK = 3, UP = 6, FOV = 9 };

struct work {
	struct eco_flight *flight;
	const struct eco_track *track;
	const struct eco_track_options *options;
	struct eco_sample *known;            /* what each fix says, NaN where it says nothing */
	double *time_s, *value; uint32_t count;      /* of one number, where it is known */
	double *column, *scratch;            /* one a sample */
	double *yaw;                         /* of the motion, one a sample */
	double speed_m_s, slow_m_s;          /* median while it moves; and what most of it is faster than */
};

/* ---- Between fixes ---- */

/* Takes number n wherever it is known: w->time_s, w->value. Returns the median step, 0 if there is none. */
static double collect(struct work *w, int n)
{
	w->count = 0;
	for (uint32_t i = 0; i < w->track->count; i++)
		/* rounded heights stay on a step; between steps they go on */
		if (!isnan(w->known[i].n[n])
				&& !(n == 2 && !w->track->posed && w->count
				&& w->known[i].n[n] == w->value[w->count - 1])) {
			w->time_s[w->count] = w->track->fixes[i].time_s;
			w->value[w->count++] = w->known[i].n[n];
		}
	for (uint32_t i = 1; i < w->count; i++)
		w->scratch[i - 1] = w->time_s[i] - w->time_s[i - 1];
	return track_quantile(w->scratch, w->count ? w->count - 1 : 0, 0.5);
}

static double slope(const struct work *w, uint32_t i, double chord)
{
	if (i == 0 || i + 1 >= w->count)
		return chord;
	double h0 = w->time_s[i] - w->time_s[i - 1], h1 = w->time_s[i + 1] - w->time_s[i];
	double a = (w->value[i] - w->value[i - 1]) / h0, b = (w->value[i + 1] - w->value[i]) / h1;
	return a * b <= 0 ? 0 : 3 * (h0 + h1) / ((2 * h1 + h0) / a + (h1 + 2 * h0) / b);
}

/* What was collected, at time_s, which does not descend from call to call: *at is where the last one was
 * found, 0 before. */
static double value_at(const struct work *w, double time_s, uint32_t *at)
{
	while (*at + 1 < w->count && w->time_s[*at + 1] <= time_s)
		++*at;
	if (*at + 1 >= w->count || time_s <= w->time_s[*at])
		return w->value[*at];
	double a = w->value[*at], b = w->value[*at + 1], h = w->time_s[*at + 1] - w->time_s[*at],
		t = (time_s - w->time_s[*at]) / h, r = 1 - t;
	return a + t * t * (3 - 2 * t) * (b - a)
		+ h * t * r * (r * slope(w, *at, (b - a) / h) - t * slope(w, *at + 1, (b - a) / h));
}

/* ---- Smoothing of evenly spaced values ---- */

/* Continued by point reflection beyond the ends, which so stay where they are. */
static double mirrored(const double *v, int64_t last, int64_t i)
{
	return i < 0 ? 2 * v[0] - v[-i] : i <= last ? v[i] : 2 * v[last] - v[2 * last - i];
}

/* A filter twice: 2 G - G * G, and G * G is a Gaussian again. */
static void smooth(const struct work *w, double *v, double sigma_s)
{
	int64_t last = (int64_t)w->flight->count - 1;
	double weight[RADIUS_MAX], sum = 0,
		sigma = fmin(sigma_s / w->flight->step_s, fmin(SIGMA_MAX, (double)last / SPAN));
	int64_t radius = (int64_t)floor(SPAN * sigma + 1e-9);
	if (!(sigma > 0.2))
		return;
	for (int64_t k = 0; k <= radius; k++) {
		double x = (double)k / sigma;
		weight[k] = 2 * exp(-x * x / 2) - sqrt(0.5) * exp(-x * x / 4);
		sum += weight[k] * (k ? 2 : 1);
	}
	for (int64_t i = 0; i <= last; i++) {
		double value = weight[0] * v[i];
		for (int64_t k = 1; k <= radius; k++)
			value += weight[k] * (mirrored(v, last, i - k) + mirrored(v, last, i + k));
		w->scratch[i] = value / sum;
	}
	memcpy(v, w->scratch, w->flight->count * sizeof *v);
}

/* Number n of all samples, of what was collected. */
static void sample(struct work *w, int n, double sigma_s)
{
	uint32_t at = 0;
	for (uint32_t i = 0; i < w->flight->count; i++)
		w->column[i] = value_at(w, i * w->flight->step_s, &at);
	smooth(w, w->column, sigma_s);
	for (uint32_t i = 0; i < w->flight->count; i++)
		w->flight->samples[i].n[n] = w->column[i];
}

/* ---- What the recording is like ---- */

static double default_smoothing(const struct work *w, double step_s)
{
	double v = w->slow_m_s, rounding_s = 1.5 * w->track->still_m / v;
	if (w->track->posed || !(v > 0))
		return 0;
	/* where each fix is off by a part of the way to the next, several are needed to know better */
	if (w->track->still_m > 0.1 * w->speed_m_s * step_s)
		rounding_s = fmax(rounding_s, fmin(4 * step_s, 1));
	return fmin(fmax(0.4 * step_s, fmax(rounding_s, fmin(GPS_NOISE_M / v, 2))), SMOOTH_MOST_S);
}

/* Fine enough for what is recorded and for the filter, coarse enough to be few. */
static void choose_samples(struct work *w, double place_s, uint32_t looks)
{
	double length = w->track->fixes[w->track->count - 1].time_s, step = place_s > 0 ? place_s / 4
		: length;
	step = looks ? fmin(step, length / looks) : step;
	step = fmax(fmax(step, w->flight->smooth_s / 20),
		fmax(w->track->posed ? STEP_LEAST_S : LOOK_S / 50, length / (SAMPLES_MAX - 1)));
	/* a script has no finer times */
	bool moves = length >= 1e-6 && step > 0;
	w->flight->count = moves ? (uint32_t)fmax(ceil(length / step - 1e-9), 1) + 1 : 1;
	w->flight->step_s = moves ? length / (w->flight->count - 1) : 1;
}

/* ---- Directions ---- */

static void axes_of(double yaw_deg, double pitch_deg, double roll_deg, struct eco_sample *s)
{
	double sy = sin(yaw_deg / TRACK_DEG), cy = cos(yaw_deg / TRACK_DEG), sp = sin(pitch_deg / TRACK_DEG),
		cp = cos(pitch_deg / TRACK_DEG), sr = sin(roll_deg / TRACK_DEG),
		cr = cos(roll_deg / TRACK_DEG);
	const double right[3] = { cy, -sy, 0 }, level[3] = { -sp * sy, -sp * cy, cp },
		look[3] = { cp * sy, cp * cy, sp };
	memcpy(s->look, look, sizeof look);
	for (int i = 0; i < 3; i++)
		s->up[i] = cr * level[i] + sr * right[i];
}

/* Yaw of the motion at each sample; where it stands, from before to after. */
static void follow_path(struct work *w)
{
	const struct eco_flight *f = w->flight;
	uint32_t n = f->count, last = n;
	double sigma_s = fmax(w->track->posed ? 0 : LOOK_S, f->smooth_s),
		*v[2] = { w->column, w->scratch + n };
	for (int axis = 0; axis < 2; axis++) {
		for (uint32_t i = 0; i < n; i++) {
			uint32_t a = i ? i - 1 : 0, b = i + 1 < n ? i + 1 : i;
			v[axis][i] = b > a
				? (f->samples[b].eye[axis] - f->samples[a].eye[axis]) / ((b - a) * f->step_s)
				: 0;
		}
		smooth(w, v[axis], sigma_s);
	}
	for (uint32_t i = 0; i < n; i++) {
		bool moves = hypot(v[0][i], v[1][i]) > 0.15 * w->speed_m_s;
		double before = last < n ? w->yaw[last] : 0, yaw = moves ? atan2(v[0][i], v[1][i]) * TRACK_DEG
			: before;
		yaw = last < n ? before + remainder(yaw - before, 360) : yaw;
		if (!moves && i + 1 < n)
			continue;
		for (uint32_t k = last < n ? last + 1 : 0; k <= i; k++)
			w->yaw[k] = last < n ? before + (yaw - before) * (k - last) / (i - last) : yaw;
		last = i;
	}
	smooth(w, w->yaw, sigma_s / 2);
}

/* Recorded looks, what they lack taken from the path and the options; without any, along the path. */
static void set_looks(struct work *w)
{
	struct eco_flight *f = w->flight;
	for (uint32_t i = 0; i < w->track->count; i++) {
		const struct eco_fix *fix = &w->track->fixes[i];
		double at = fmin(fmax(fix->time_s / f->step_s, 0), f->count - 1),
			pitch = isnan(w->options->pitch_deg) ? fix->pitch_deg : NAN;
		uint32_t k = (uint32_t)at, next = k + 1 < f->count ? k + 1 : k;
		double along = w->yaw[k] + (w->yaw[next] - w->yaw[k]) * (at - k);
		if (!isnan(fix->yaw_deg) || !isnan(fix->pitch_deg))
			axes_of(isnan(fix->yaw_deg) ? along : fix->yaw_deg, isnan(pitch) ? f->pitch_deg
				: pitch, isnan(fix->roll_deg) ? 0 : fix->roll_deg, &w->known[i]);
	}
	double step_s = collect(w, LOOK), sigma_s = w->track->posed && isnan(w->options->smooth_s) ? 0
		: fmin(f->smooth_s, fmax(0.6 * step_s, 0.1));
	for (int n = LOOK; w->count && n < FOV; n++) {
		collect(w, n);
		sample(w, n, sigma_s);
	}
	for (uint32_t i = 0; !w->count && i < f->count; i++)
		axes_of(w->yaw[i], f->pitch_deg, 0, &f->samples[i]);
}

static void set_unit(double v[3], const double otherwise[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int i = 0; i < 3; i++)
		v[i] = length > 1e-6 ? v[i] / length : otherwise[i];
}

/* Units at right angles again, after each number was interpolated by itself. A look that turns about from one
 * sample to the next would cancel halfway: it passes through a side. */
static void straighten(struct eco_sample *s, const struct eco_sample *before)
{
	const double *l = before->look, *u = before->up;
	set_unit(s->look, l);
	if (eco_angle_deg(s->look, l) > TURN_MOST_DEG)
		memcpy(s->look,
			(double[]){ l[1] * u[2] - l[2] * u[1], l[2] * u[0] - l[0] * u[2],
			l[0] * u[1] - l[1] * u[0] }, sizeof s->look);
	double dot = s->up[0] * s->look[0] + s->up[1] * s->look[1] + s->up[2] * s->look[2];
	for (int i = 0; i < 3; i++)
		s->up[i] -= dot * s->look[i];
	set_unit(s->up, u);
}

/* ---- All of it ---- */

static void make_samples(struct work *w)
{
	static const struct eco_sample first = { .look = { 0, 1, 0 }, .up = { 0, 0, 1 } };
	struct eco_flight *f = w->flight;
	for (int n = EYE; n < LOOK; n++) {
		double step_s = collect(w, n), sigma_s = f->smooth_s;
		/* rounded heights stay on a step for longer than positions */
		if (n == 2 && w->count > 2 && !w->track->posed && isnan(w->options->smooth_s))
			sigma_s = fmin(fmax(sigma_s, 0.6 * step_s), SMOOTH_MOST_S);
		if (w->count)
			sample(w, n, sigma_s);
	}
	follow_path(w);
	set_looks(w);
	collect(w, FOV);
	for (uint32_t i = 0, at = 0; i < f->count; i++) {
		f->samples[i].fov_y_deg = w->count ? value_at(w, i * f->step_s, &at)
			: isnan(w->options->fov_y_deg) ? FOV_DEG : w->options->fov_y_deg;
		straighten(&f->samples[i], i ? &f->samples[i - 1] : &first);
		f->length_m += i ? eco_distance(f->samples[i].eye, f->samples[i - 1].eye) : 0;
	}
	for (uint32_t i = 0; i < w->track->count; i++) {
		uint32_t k = (uint32_t)fmin(w->track->fixes[i].time_s / f->step_s + 0.5, f->count - 1);
		f->moved_m =
			fmax(f->moved_m,
			hypot(w->known[i].eye[0] - f->samples[k].eye[0],
			w->known[i].eye[1] - f->samples[k].eye[1]));
	}
}

/* Returns how many looks were recorded. */
static uint32_t learn(struct work *w)
{
	struct eco_flight *f = w->flight;
	bool pitch_given = !isnan(w->options->pitch_deg);
	uint32_t looks = 0;
	for (uint32_t i = 0; i < w->track->count; i++) {
		const struct eco_fix *fix = &w->track->fixes[i];
		for (int n = 0; n < ECO_SAMPLE_NUMBERS; n++)
			w->known[i].n[n] = n < LOOK ? fix->at[n] : NAN;
		w->known[i].fov_y_deg = isnan(w->options->fov_y_deg) ? fix->fov_y_deg : NAN;
		f->yaw_recorded |= !isnan(fix->yaw_deg);
		f->pitch_recorded |= !isnan(fix->pitch_deg) && !pitch_given;
		looks += !isnan(fix->yaw_deg) || !isnan(fix->pitch_deg);
	}
	uint32_t speeds = track_speeds(w->track, w->scratch);
	w->speed_m_s = track_quantile(w->scratch, speeds, 0.5);
	w->slow_m_s = track_quantile(w->scratch, speeds, 0.25);
	f->pitch_deg = pitch_given ? w->options->pitch_deg : w->track->format == ECO_TRACK_SRT
		? FLIGHT_PITCH_DEG : 0;
	return looks;
}

enum eco_code eco_flight_make(struct eco_flight *flight, const struct eco_track *track,
	const struct eco_track_options *options, struct eco_error *error)
{
	size_t fixes = track->count, most = SAMPLES_MAX;
	struct work w = { .flight = flight, .track = track, .options = options,
		.known = malloc((fixes + 1) * sizeof *w.known) };
	/* two of fixes; five of samples, of which three, or one of fixes, serve as scratch */
	double *rows = malloc((2 * fixes + 2 * most + (fixes > 3 * most ? fixes : 3 * most)) * sizeof *rows);
	*flight = (struct eco_flight){ .samples = calloc(most, sizeof *flight->samples) };
	enum eco_code code = w.known && rows && flight->samples ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for %zu fixes", fixes);
	if (!code) {
		w.time_s = rows;
		w.value = rows + fixes;
		w.column = w.value + fixes;
		w.yaw = w.column + most;
		w.scratch = w.yaw + most;
		memset(w.yaw, 0, most * sizeof *w.yaw);
		uint32_t looks = learn(&w);
		double step_s = collect(&w, EYE);
		flight->smooth_s = isnan(options->smooth_s) ? default_smoothing(&w, step_s)
			: options->smooth_s;
		choose_samples(&w, step_s, looks);
		code = w.count ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "the track has no position left");
	}
	if (!code)
		make_samples(&w);
	else
		eco_flight_free(flight);
	free(w.known);
	free(rows);
	return code;
}

void eco_flight_free(struct eco_flight *flight)
{
	free(flight->samples);
	*flight = (struct eco_flight){ 0 };
}
