/* From fixes to even, smooth motion. Between fixes: piecewise cubics whose slopes are the weighted harmonic
 * means of the neighbours' (Fritsch and Butland 1984), which never leave the range of two fixes, so that
 * uneven times and stands cause no overshoot. Then a Gaussian filter, and what it took off is filtered and
 * given back (Tukey's twicing), which bends curves far less. The filter spans a few steps of rounding (4
 * decimals of a degree are 11 m) at the track's speed, and much of the time between fixes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/track/track_read.h"

#define SAMPLES_MAX 200000u
#define SPAN 6.0                         /* of the filter, in standard deviations */
#define SIGMA_MAX 250.0                  /* in samples */
#define RADIUS_MAX 1504                  /* SPAN * SIGMA_MAX and more than one */
#define GPS_NOISE_M 2.0                  /* of fixes against each other */
#define SMOOTH_MOST_S 15.0
#define LOOK_S 1.0                       /* directions of motion are smoothed over at least this */
#define FOV_DEG 60.0
#define TURN_MOST_DEG 170.0              /* between two samples */
#define FLIGHT_PITCH_DEG (-15.0)

/* A sample's numbers while it is made: angles are where look will be, the way's direction where up is. */
enum { EYE = 0, YAW = 3, PITCH = 4, ROLL = 5, WAY = 6, FOV = 9 };

struct work {
	struct eco_flight *flight;
	const struct eco_track *track;
	const struct eco_track_options *options;
	double *time_s, *value; uint32_t count;      /* of one number, where it is known */
	double *scratch;                     /* one a sample, and one a fix */
	double speed_m_s, slow_m_s;          /* median while it moves; and what most of it is faster than */
};

/* ---- Directions ---- */

static double distance_of(const double a[3], const double b[3])
{
	return sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])
		+ (b[2] - a[2]) * (b[2] - a[2]));
}

double eco_angle_deg(const double a[3], const double b[3])
{
	double cross[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
	return atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]),
		a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * TRACK_DEG;
}

/* Units at right angles. */
static void axes(double yaw_deg, double pitch_deg, double roll_deg, double look[3], double up[3])
{
	double yaw = yaw_deg / TRACK_DEG, pitch = pitch_deg / TRACK_DEG, roll = roll_deg / TRACK_DEG;
	double sy = sin(yaw), cy = cos(yaw), sp = sin(pitch), cp = cos(pitch);
	const double ahead[3] = { cp * sy, cp * cy, sp }, right[3] = { cy, -sy, 0 };
	const double level[3] = { -sp * sy, -sp * cy, cp };
	for (int k = 0; k < 3; k++) {
		look[k] = ahead[k];
		up[k] = cos(roll) * level[k] + sin(roll) * right[k];
	}
}

/* ---- Between fixes ---- */

/* Takes number n of the fixes wherever it is known: w->time_s, w->value. Rounded heights stay on a step;
 * between steps they go on. Angles turn the short way. Returns the median step, 0 if there is none. */
static double collect(struct work *w, enum track_role n)
{
	w->count = 0;
	for (uint32_t i = 0; i < w->track->count; i++) {
		double value = w->track->fixes[i].n[n], last = w->count ? w->value[w->count - 1] : value;
		bool stays = n == TRACK_Z && w->count && value == last;
		if (isnan(value) || stays)
			continue;
		w->time_s[w->count] = w->track->fixes[i].time_s;
		bool turns = n >= TRACK_YAW && n <= TRACK_ROLL;
		w->value[w->count++] = turns ? last + remainder(value - last, 360) : value;
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

/* The collected number at time_s, which does not descend from call to call; *at is 0 before the first. */
static double value_at(const struct work *w, double time_s, uint32_t *at)
{
	while (*at + 1 < w->count && w->time_s[*at + 1] <= time_s)
		++*at;
	if (*at + 1 >= w->count || time_s <= w->time_s[*at])
		return w->value[*at];
	double a = w->value[*at], rise = w->value[*at + 1] - a, h = w->time_s[*at + 1] - w->time_s[*at];
	double t = (time_s - w->time_s[*at]) / h, r = 1 - t;
	return a + t * t * (3 - 2 * t) * rise
		+ h * t * r * (r * slope(w, *at, rise / h) - t * slope(w, *at + 1, rise / h));
}

/* ---- Smoothing of evenly spaced values ---- */

/* Continued by point reflection beyond the ends, which so stay where they are. */
static double mirrored(const double *v, int64_t last, int64_t i)
{
	return i < 0 ? 2 * v[0] - v[-i] : i <= last ? v[i] : 2 * v[last] - v[2 * last - i];
}

/* Filters number n of all samples twice: 2 G - G * G, and G * G is a Gaussian again. */
static void smooth(const struct work *w, int n, double sigma_s)
{
	struct eco_sample *s = w->flight->samples;
	double weight[RADIUS_MAX], sum = 0, *v = w->scratch;
	int64_t last = (int64_t)w->flight->count - 1;
	double sigma = fmin(sigma_s / w->flight->step_s, fmin(SIGMA_MAX, (double)last / SPAN));
	int64_t radius = (int64_t)floor(SPAN * sigma + 1e-9);
	if (!(sigma > 0.2))
		return;
	for (int64_t k = 0; k <= radius; k++) {
		double x = (double)k / sigma;
		weight[k] = 2 * exp(-x * x / 2) - sqrt(0.5) * exp(-x * x / 4);
		sum += weight[k] * (k ? 2 : 1);
	}
	for (int64_t i = 0; i <= last; i++)
		v[i] = s[i].n[n];
	for (int64_t i = 0; i <= last; i++) {
		double value = weight[0] * v[i];
		for (int64_t k = 1; k <= radius; k++)
			value += weight[k] * (mirrored(v, last, i - k) + mirrored(v, last, i + k));
		s[i].n[n] = value / sum;
	}
}

/* Number n of all samples, of what was collected. */
static void sample(struct work *w, int n, double sigma_s)
{
	uint32_t at = 0;
	for (uint32_t i = 0; i < w->flight->count; i++)
		w->flight->samples[i].n[n] = value_at(w, i * w->flight->step_s, &at);
	smooth(w, n, sigma_s);
}

static double choose_smoothing(const struct work *w, double step_s)
{
	double v = w->slow_m_s, rounding_s = 1.5 * w->track->still_m / v;
	if (!isnan(w->options->smooth_s))
		return w->options->smooth_s;
	if (!(v > 0))
		return 0;
	/* where each fix is off by a part of the way to the next, several are needed to know better */
	if (w->track->still_m > 0.1 * w->speed_m_s * step_s)
		rounding_s = fmax(rounding_s, fmin(4 * step_s, 1));
	return fmin(fmax(0.4 * step_s, fmax(rounding_s, fmin(GPS_NOISE_M / v, 2))), SMOOTH_MOST_S);
}

/* Fine enough for what is recorded and for the filter, coarse enough to be few; a script has no finer times
 * than microseconds. */
static void choose_samples(struct work *w, double step_s, uint32_t looks)
{
	double length = w->track->fixes[w->track->count - 1].time_s, step = step_s > 0 ? step_s / 4 : length;
	step = looks ? fmin(step, length / looks) : step;
	step = fmax(fmax(step, w->flight->smooth_s / 20), fmax(LOOK_S / 50, length / (SAMPLES_MAX - 1)));
	bool moves = length >= 1e-6 && step > 0;
	w->flight->count = moves ? (uint32_t)fmax(ceil(length / step - 1e-9), 1) + 1 : 1;
	w->flight->step_s = moves ? length / (w->flight->count - 1) : 1;
}

/* How fast it is, and which angles it has. Returns how many looks were recorded. */
static uint32_t learn(struct work *w)
{
	struct eco_flight *f = w->flight;
	bool pitch_given = !isnan(w->options->pitch_deg);
	uint32_t speeds = track_speeds(w->track, w->scratch);
	w->speed_m_s = track_quantile(w->scratch, speeds, 0.5);
	w->slow_m_s = track_quantile(w->scratch, speeds, 0.25);
	f->pitch_deg = pitch_given ? w->options->pitch_deg
		: w->track->format == ECO_TRACK_SRT ? FLIGHT_PITCH_DEG : 0;
	collect(w, TRACK_YAW);
	uint32_t yaws = w->count;
	collect(w, TRACK_PITCH);
	f->yaw_recorded = yaws > 0;
	f->pitch_recorded = w->count && !pitch_given;
	return yaws > w->count ? yaws : w->count;
}

/* Yaw of the motion at each sample; where it stands, from before to after. */
static void follow_path(struct work *w)
{
	const struct eco_flight *f = w->flight;
	struct eco_sample *s = f->samples;
	uint32_t n = f->count, last = ECO_NONE;
	double sigma_s = fmax(LOOK_S, f->smooth_s);
	for (int axis = 0; axis < 2; axis++) {
		for (uint32_t i = 0; i < n; i++) {
			uint32_t a = i ? i - 1 : 0, b = i + 1 < n ? i + 1 : i;
			double way = s[b].eye[axis] - s[a].eye[axis];
			s[i].n[WAY + axis] = b > a ? way / ((b - a) * f->step_s) : 0;
		}
		smooth(w, WAY + axis, sigma_s);
	}
	for (uint32_t i = 0; i < n; i++) {
		const double *way = s[i].n + WAY;
		if (!(hypot(way[0], way[1]) > 0.15 * w->speed_m_s))
			continue;
		double yaw = atan2(way[0], way[1]) * TRACK_DEG;
		double before = last == ECO_NONE ? yaw : s[last].n[YAW];
		double turn = remainder(yaw - before, 360);
		for (uint32_t k = last + 1; k <= i; k++)
			s[k].n[YAW] = last == ECO_NONE ? yaw : before + turn * (k - last) / (i - last);
		last = i;
	}
	for (uint32_t k = last + 1; k < n; k++)
		s[k].n[YAW] = last == ECO_NONE ? 0 : s[last].n[YAW];
	smooth(w, YAW, sigma_s / 2);
}

/* A look that turns about between two samples would cancel halfway in a script: it passes through a side. */
static void set_axes(struct eco_sample *s, const struct eco_sample *before)
{
	const double yaw_deg = s->n[YAW], pitch_deg = s->n[PITCH], roll_deg = s->n[ROLL];
	axes(yaw_deg, pitch_deg, roll_deg, s->look, s->up);
	if (before && eco_angle_deg(s->look, before->look) > TURN_MOST_DEG)
		axes(yaw_deg - 90, pitch_deg, roll_deg, s->look, s->up);
}

static void sample_eyes(struct work *w)
{
	struct eco_flight *f = w->flight;
	for (int k = 0; k < 3; k++) {
		double step_s = collect(w, TRACK_X + k), sigma_s = f->smooth_s;
		/* rounded heights stay on a step for longer than positions */
		if (k == 2 && w->count > 2 && isnan(w->options->smooth_s))
			sigma_s = fmin(fmax(sigma_s, 0.6 * step_s), SMOOTH_MOST_S);
		if (w->count)
			sample(w, EYE + k, sigma_s);
	}
	for (uint32_t i = 0; i < w->track->count; i++) {
		const struct eco_fix *fix = &w->track->fixes[i];
		uint32_t nearest = (uint32_t)fmin(fix->time_s / f->step_s + 0.5, f->count - 1);
		const double *eye = f->samples[nearest].eye;
		f->moved_m = fmax(f->moved_m, hypot(fix->at[0] - eye[0], fix->at[1] - eye[1]));
	}
}

/* Recorded angles and fields of view, else the defaults; yaw along the path is there already. */
static void sample_looks(struct work *w)
{
	struct eco_flight *f = w->flight;
	for (uint32_t i = 0; i < f->count; i++) {
		f->samples[i].n[PITCH] = f->pitch_deg;
		f->samples[i].fov_y_deg = isnan(w->options->fov_y_deg) ? FOV_DEG : w->options->fov_y_deg;
	}
	for (int k = 0; k < 3; k++) {
		double step_s = collect(w, TRACK_YAW + k);
		if (w->count && (k != 1 || f->pitch_recorded))
			sample(w, YAW + k, fmin(f->smooth_s, fmax(0.6 * step_s, 0.1)));
	}
	collect(w, TRACK_FOV);
	if (w->count && isnan(w->options->fov_y_deg))
		sample(w, FOV, 0);
}

static void make_samples(struct work *w)
{
	struct eco_flight *f = w->flight;
	sample_eyes(w);
	follow_path(w);
	sample_looks(w);
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i];
		set_axes(s, i ? s - 1 : NULL);
		f->length_m += i ? distance_of(s->eye, s[-1].eye) : 0;
	}
}

void eco_flight_make(struct eco_flight *flight, const struct eco_track *track,
	const struct eco_track_options *options)
{
	size_t fixes = track->count;
	struct work w = { .flight = flight, .track = track, .options = options,
		.time_s = eco_alloc(3 * fixes + SAMPLES_MAX, sizeof *w.time_s) };
	*flight = (struct eco_flight){ .samples = eco_alloc(SAMPLES_MAX, sizeof *flight->samples) };
	w.value = w.time_s + fixes;
	w.scratch = w.value + fixes;
	uint32_t looks = learn(&w);
	double step_s = collect(&w, TRACK_X);
	flight->smooth_s = choose_smoothing(&w, step_s);
	choose_samples(&w, step_s, looks);
	make_samples(&w);
	free(w.time_s);
}

/* ---- Where the scene is ---- */

void eco_flight_box(const struct eco_flight *f, double low[3], double high[3])
{
	memcpy(low, f->samples[0].eye, 3 * sizeof *low);
	memcpy(high, low, 3 * sizeof *high);
	for (uint32_t i = 0; i < 3 * f->count; i++) {
		low[i % 3] = fmin(low[i % 3], f->samples[i / 3].eye[i % 3]);
		high[i % 3] = fmax(high[i % 3], f->samples[i / 3].eye[i % 3]);
	}
}

void eco_flight_free(struct eco_flight *flight)
{
	free(flight->samples);
	*flight = (struct eco_flight){ 0 };
}

/* Turned about the first eye, which then goes to `to`. Heights that count from the ground stay. */
static void place(struct eco_flight *f, const struct eco_track *track, const struct eco_track_options *m)
{
	double first[3], to[3], ground = 0;
	double sine = sin(m->turn_deg / TRACK_DEG), cosine = cos(m->turn_deg / TRACK_DEG);
	bool relative = track->height == ECO_HEIGHTS_RELATIVE, goes = m->to_given || track->local;
	bool stays = (m->has_ground && !track->has_height) || (track->local && relative);
	for (int k = 0; k < 3; k++) {
		first[k] = f->samples[0].eye[k];
		to[k] = goes && !(k == 2 && stays) ? m->to[k] : first[k];
	}
	if (!m->to_given && relative && m->ground) {
		eco_ground_height(m->ground, first[0], first[1], &ground);
		to[2] += ground;
	}
	for (struct eco_sample *s = f->samples; s < f->samples + f->count; s++) {
		for (int k = 0; k < 3; k++)
			s->eye[k] -= first[k];
		for (double *v = s->n; v < s->n + 9; v += 3) {       /* eye, look, up */
			double x = v[0];
			v[0] = cosine * x - sine * v[1];
			v[1] = sine * x + cosine * v[1];
		}
		for (int k = 0; k < 3; k++)
			s->eye[k] += to[k];
	}
}

static void stand(struct eco_flight *f, const struct eco_track *track, const struct eco_track_options *m)
{
	double low[3], high[3];
	eco_flight_box(f, low, high);
	/* without a scene the ground is unknown: take it as z = 0, and keep the whole track above */
	double lift = track->local && !m->has_ground ? fmax(0, m->clearance_m - low[2]) : 0;
	for (uint32_t i = 0; i < f->count; i++) {
		double *eye = f->samples[i].eye, ground = 0;
		f->off_ground += m->ground && !eco_ground_height(m->ground, eye[0], eye[1], &ground);
		eye[2] += m->has_ground && !track->has_height ? ground : lift;
		double lacks = m->has_ground ? ground + m->clearance_m - eye[2] : 0;
		f->raised += lacks > 0;
		f->raised_m = fmax(f->raised_m, lacks);
		eye[2] += fmax(lacks, 0);
	}
}

/* At the point itself it looks on as before. */
static void look_at(struct eco_flight *f, const double at[3])
{
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i];
		const double x = at[0] - s->eye[0], y = at[1] - s->eye[1], z = at[2] - s->eye[2];
		axes(atan2(x, y) * TRACK_DEG, atan2(z, hypot(x, y)) * TRACK_DEG, 0, s->look, s->up);
		if (i && distance_of(s->eye, at) < 1e-6)
			memcpy(s->n + 3, s[-1].n + 3, 6 * sizeof *s->n);
	}
}

void eco_flight_move(struct eco_flight *flight, const struct eco_track *track,
	const struct eco_track_options *options)
{
	place(flight, track, options);
	stand(flight, track, options);
	if (options->look_at_given)
		look_at(flight, options->look_at);
	flight->step_s /= options->speed > 0 ? options->speed : 1;
}

/* ---- Scripts ----
 * The fewest keyframes whose spline keeps to a flight. Keyframes are put where the script that camera.c would
 * play leaves the flight most, one in each stretch that is not good enough, until all are (the idea of
 * Douglas and Peucker 1973, with the true spline in place of chords). An overshoot between keyframes is an
 * error like any other, and the bound that is stated has been measured at every sample. */

#define ERROR_M 0.05
#define KEYS_MAX 8000u
#define AHEAD_M 10.0                     /* of the target; any number does, as splines are linear */
enum { LOOK = 3, UP = 6 };               /* of a sample's numbers */

struct fit {
	const struct eco_flight *flight;
	uint32_t *key, count;                /* samples that are keyframes, ascending */
	bool *is_key;                        /* of each sample */
	double error_m, error_deg;           /* wanted */
	struct eco_script *script;           /* its errors are the worst so far */
};

static const double *numbers(const struct fit *f, uint32_t key) { return f->flight->samples[f->key[key]].n; }

/* How far the spline (of camera.c) within the stretch from keyframe i is from the flight at a sample, in
 * metres or degrees of look, roll and field of view, as a share of the error wanted. */
static double error_at(struct fit *f, uint32_t i, uint32_t sample)
{
	uint32_t before = i ? i - 1 : 0, after = i + 2 < f->count ? i + 2 : i + 1;
	const double *a = numbers(f, i), *b = numbers(f, i + 1), *is = f->flight->samples[sample].n;
	double h = f->key[i + 1] - f->key[i], s = (sample - f->key[i]) / h, r = 1 - s, at[ECO_SAMPLE_NUMBERS];
	double per_a = 1.0 / (f->key[i + 1] - f->key[before]), per_b = 1.0 / (f->key[after] - f->key[i]);
	for (int n = 0; n < ECO_SAMPLE_NUMBERS; n++) {
		double slope_a = (b[n] - numbers(f, before)[n]) * per_a;
		double slope_b = (numbers(f, after)[n] - a[n]) * per_b;
		at[n] = a[n] + s * s * (3 - 2 * s) * (b[n] - a[n]) + h * s * r * (r * slope_a - s * slope_b);
	}
	double m = distance_of(at, is), look_deg = eco_angle_deg(at + LOOK, is + LOOK);
	double deg = fmax(fmax(look_deg, eco_angle_deg(at + UP, is + UP)), fabs(at[FOV] - is[FOV]));
	/* looks that nearly cancel each other are no looks */
	deg = distance_of(at + LOOK, (double[3]){ 0 }) < 0.1 ? 180 : deg;
	f->script->error_m = fmax(f->script->error_m, m);
	f->script->error_deg = fmax(f->script->error_deg, deg);
	return fmax(m / f->error_m, deg / f->error_deg);
}

/* The sample that is worst in stretch i, and its error. */
static double worst_of(struct fit *f, uint32_t i, uint32_t *worst)
{
	double most = 0;
	for (uint32_t sample = f->key[i] + 1; sample < f->key[i + 1]; sample++) {
		double error = error_at(f, i, sample);
		*worst = error > most ? sample : *worst;
		most = fmax(most, error);
	}
	return most;
}

/* Adds a keyframe to each stretch that is off by more than `bound` times the error wanted. */
static bool refine(struct fit *f, double bound)
{
	uint32_t added = 0, worst = 0;
	f->script->error_m = f->script->error_deg = 0;
	f->count = 0;
	for (uint32_t sample = 0; sample < f->flight->count; sample++)
		if (f->is_key[sample])
			f->key[f->count++] = sample;
	for (uint32_t i = 0; i + 1 < f->count; i++)
		if (worst_of(f, i, &worst) > bound && f->count + added < KEYS_MAX) {
			f->is_key[worst] = true;
			added++;
		}
	return added > 0;
}

/* Coarse to fine, so that keyframes go where they are needed most. False: too few are left to turn about. */
static bool choose_keys(struct fit *f)
{
	double low[3], high[3], size = 0;
	eco_flight_box(f->flight, low, high);
	for (int k = 0; k < 3; k++)
		size = fmax(size, high[k] - low[k]);
	/* a small scene shows finer */
	f->error_m = size > 0 ? fmin(ERROR_M, size / 1000) : ERROR_M;
	f->error_deg = f->flight->yaw_recorded ? 0.5 : 1;
	f->is_key[0] = f->is_key[f->flight->count - 1] = true;
	for (double bound = 1024; bound >= 1; bound /= 4)
		while (refine(f, bound))
			;
	for (uint32_t i = 1; i < f->count; i++)
		if (eco_angle_deg(numbers(f, i - 1) + LOOK, numbers(f, i) + LOOK) > 175)
			return false;
	return true;
}

static void put_vector(FILE *out, const char *name, const double v[3], double parts)
{
	fprintf(out, ", \"%s\": [", name);
	for (int k = 0; k < 3; k++)
		fprintf(out, "%s%.15g", k ? ", " : "", round(v[k] * parts) / parts + 0);
	fputs("]", out);
}

static void write_keys(struct eco_script *script, const struct fit *f)
{
	FILE *out = open_memstream(&script->text, &script->size);
	/* a tenth of a millimetre, finer in scenes that are small */
	double fine = script->error_m > 0 && script->error_m < 1e-3 ? 1e6 : 1e4;
	if (!out)
		eco_end("no memory");
	fprintf(out, "{\"fps\": %.15g, \"keyframes\": [\n", round(script->fps * 1e4) / 1e4);
	for (uint32_t i = 0; i < f->count; i++) {
		const double *n = numbers(f, i);
		const double target[3] = { n[0] + AHEAD_M * n[LOOK], n[1] + AHEAD_M * n[LOOK + 1],
			n[2] + AHEAD_M * n[LOOK + 2] };
		fprintf(out, "  {\"time_s\": %.15g", round(f->key[i] * f->flight->step_s * 1e6) / 1e6);
		put_vector(out, "eye", n, fine);
		put_vector(out, "target", target, fine);
		put_vector(out, "up", n + UP, 1e5);
		fprintf(out, ", \"fov_y_deg\": %.15g}%s\n", round(n[FOV] * 1e3) / 1e3,
			i + 1 < f->count ? "," : "");
	}
	fputs("]}\n", out);
	if (fclose(out) != 0)
		eco_end("no memory");
}

enum eco_code eco_script_fit(struct eco_script *script, const struct eco_flight *flight,
	const struct eco_track_options *options, struct eco_error *error)
{
	uint32_t *owned = eco_alloc(flight->count, sizeof *owned + sizeof(bool));
	double length_s = (flight->count - 1) * flight->step_s,
		fps = length_s > 0 ? ECO_SCRIPT_FRAMES / length_s : 30;
	*script = (struct eco_script){ .length_s = length_s };
	struct fit f = { .flight = flight, .key = owned, .script = script,
		.is_key = (bool *)(owned + flight->count) };
	enum eco_code code = ECO_OK;
	if (!choose_keys(&f))
		code = eco_fail(error, ECO_TOO_LARGE, "the camera turns about too often for %u keyframes "
			"(--smooth S)", KEYS_MAX);
	script->fps = options->fps > 0 ? options->fps : fps >= 30 ? 30 : fps >= 1 ? floor(fps)
		: 1 / ceil(1 / fps);
	script->frames = (uint32_t)fmin(floor(length_s * script->fps + 1e-6) + 1, UINT32_MAX);
	script->keys = f.count;
	if (!code)
		write_keys(script, &f);
	free(owned);
	return code;
}
