/* The fewest keyframes whose spline keeps to a flight. Keyframes are put where the script that camera.c would
 * play leaves the flight most, one in each stretch that is not good enough, until all are (the idea of
 * Douglas and Peucker 1973, with the true spline in place of chords). An overshoot between keyframes is an
 * error like any other, and the bound that is stated has been measured at every sample. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/import/track/track.h"

#define ERROR_M 0.05
#define KEYS_MAX 8000u
#define AHEAD_M 10.0                     /* of the target; any number does, as splines are linear */
enum { LOOK = 3, UP = 6, FOV = 9 };      /* of a sample's numbers */

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
	double m = eco_distance(at, is), look_deg = eco_angle_deg(at + LOOK, is + LOOK);
	double deg = fmax(fmax(look_deg, eco_angle_deg(at + UP, is + UP)), fabs(at[FOV] - is[FOV]));
	/* looks that nearly cancel each other are no looks */
	deg = eco_distance(at + LOOK, (double[3]){ 0 }) < 0.1 ? 180 : deg;
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

static enum eco_code write_keys(struct eco_script *script, const struct fit *f, struct eco_error *error)
{
	FILE *out = open_memstream(&script->text, &script->size);
	/* a tenth of a millimetre, finer in scenes that are small */
	double fine = script->error_m > 0 && script->error_m < 1e-3 ? 1e6 : 1e4;
	if (!out)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
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
	return fclose(out) == 0 ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "out of memory");
}

enum eco_code eco_script_fit(struct eco_script *script, const struct eco_flight *flight,
	const struct eco_track_options *options, struct eco_error *error)
{
	uint32_t *owned = calloc(flight->count, sizeof *owned + sizeof(bool));
	double length_s = (flight->count - 1) * flight->step_s,
		fps = length_s > 0 ? ECO_SCRIPT_FRAMES / length_s : 30;
	*script = (struct eco_script){ .length_s = length_s };
	if (!owned)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u keyframes", flight->count);
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
		code = write_keys(script, &f, error);
	free(owned);
	return code;
}
