/* The fewest keyframes whose spline keeps to a flight. Keyframes are put where the script that camera.c would play leaves the flight most,
 * one in each stretch that is not good enough, until all are (the idea of Douglas and Peucker 1973, with the true spline in place of
 * chords). So an overshoot between keyframes is an error like any other, and the bound that is stated has been measured at every
 * sample. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/import/track/track.h"

#define DEG 57.29577951308232
#define ERROR_M 0.05
#define AHEAD_M 10.0                     /* of the target; any number does, as splines are linear */
enum { EYE = 0, LOOK = 3, UP = 6, FOV = 9 };

struct fit {
	const struct eco_flight *flight;
	uint32_t *key, *next, count;         /* samples that are keyframes, ascending */
	double error_m, error_deg;           /* wanted */
	double worst_m, worst_deg;
};

/* ---- The spline, as in camera.c ---- */

static const double *numbers(const struct fit *f, uint32_t key) { return f->flight->samples[f->key[key]].n; }

/* Metres to the flight at a sample within the stretch from keyframe i, and degrees of look, roll and field of view. */
static void errors_at(const struct fit *f, uint32_t i, uint32_t sample, double *m, double *deg)
{
	uint32_t before = i ? i - 1 : 0, after = i + 2 < f->count ? i + 2 : i + 1;
	const double *a = numbers(f, i), *b = numbers(f, i + 1), *is = f->flight->samples[sample].n;
	double h = f->key[i + 1] - f->key[i], s = (sample - f->key[i]) / h, r = 1 - s, at[ECO_SAMPLE_NUMBERS];
	double per_a = 1.0 / (f->key[i + 1] - f->key[before]), per_b = 1.0 / (f->key[after] - f->key[i]);
	for (int n = 0; n < ECO_SAMPLE_NUMBERS; n++) {
		double slope_a = (b[n] - numbers(f, before)[n]) * per_a, slope_b = (numbers(f, after)[n] - a[n]) * per_b;
		at[n] = a[n] + s * s * (3 - 2 * s) * (b[n] - a[n]) + h * s * r * (r * slope_a - s * slope_b);
	}
	*m = eco_distance(at, is);
	*deg = fmax(fmax(eco_angle_deg(at + LOOK, is + LOOK), eco_angle_deg(at + UP, is + UP)), fabs(at[FOV] - is[FOV]));
	/* looks that nearly cancel each other are no looks */
	if (at[LOOK] * at[LOOK] + at[LOOK + 1] * at[LOOK + 1] + at[LOOK + 2] * at[LOOK + 2] < 0.01)
		*deg = 180;
}

/* The sample that is worst in stretch i, against what is wanted; its share of that. */
static double worst_of(struct fit *f, uint32_t i, uint32_t *worst)
{
	double most = 0;
	for (uint32_t sample = f->key[i] + 1; sample < f->key[i + 1]; sample++) {
		double m, deg;
		errors_at(f, i, sample, &m, &deg);
		f->worst_m = fmax(f->worst_m, m);
		f->worst_deg = fmax(f->worst_deg, deg);
		double share = fmax(m / f->error_m, deg / f->error_deg);
		*worst = share > most ? sample : *worst;
		most = fmax(most, share);
	}
	return most;
}

/* One more keyframe in each stretch that is off by more than `bound` times what is wanted. False when nothing was added. */
static bool refine(struct fit *f, double bound, uint32_t keys_max)
{
	uint32_t count = 0, *swap = f->key;
	f->worst_m = f->worst_deg = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		uint32_t worst = 0;
		f->next[count++] = f->key[i];
		if (i + 1 < f->count && worst_of(f, i, &worst) > bound && count + (f->count - i - 1) < keys_max)
			f->next[count++] = worst;
	}
	bool added = count > f->count;
	f->key = f->next;
	f->next = swap;
	f->count = count;
	return added;
}

static void choose_errors(struct fit *f, const struct eco_fitting *fitting)
{
	double low[3], high[3], size = 0;
	eco_flight_box(f->flight, low, high);
	for (int k = 0; k < 3; k++)
		size = fmax(size, high[k] - low[k]);
	/* a small scene shows finer */
	f->error_m = fitting->error_m > 0 ? fitting->error_m : size > 0 ? fmin(ERROR_M, size / 1000) : ERROR_M;
	f->error_deg = fitting->error_deg > 0 ? fitting->error_deg : f->flight->yaw_recorded ? 0.5 : 1;
}

/* ---- Script ---- */

static void take_keys(struct eco_script *script, const struct fit *f, double fps)
{
	static const double slower[] = { 25, 15, 10, 5, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01 };
	double length_s = (f->flight->count - 1) * f->flight->step_s;
	script->fps = fps > 0 ? fps : 30;
	for (size_t i = 0; fps <= 0 && i < sizeof slower / sizeof *slower && length_s * script->fps > ECO_SCRIPT_FRAMES; i++)
		script->fps = slower[i];
	script->frames = (uint32_t)fmin(floor(length_s * script->fps + 1e-6) + 1, UINT32_MAX);
	script->error_m = f->worst_m;
	script->error_deg = f->worst_deg;
	for (script->count = 0; script->count < f->count; script->count++) {
		const double *n = numbers(f, script->count);
		struct eco_key *key = &script->keys[script->count];
		*key = (struct eco_key){ .time_s = f->key[script->count] * f->flight->step_s, .fov_y_deg = n[FOV] };
		for (int k = 0; k < 3; k++) {
			key->eye[k] = n[EYE + k];
			key->target[k] = n[EYE + k] + AHEAD_M * n[LOOK + k];
			key->up[k] = n[UP + k];
		}
	}
}

enum eco_code eco_script_fit(struct eco_script *script, const struct eco_flight *flight, const struct eco_fitting *fitting, struct eco_error *error)
{
	struct fit f = { .flight = flight, .count = 1 };
	uint32_t keys_max = fitting->keys_max ? fitting->keys_max : 8000;
	*script = (struct eco_script){ 0 };
	keys_max = keys_max < 2 ? 2 : keys_max < flight->count ? keys_max : flight->count;
	uint32_t *owned = calloc(2 * ((size_t)keys_max + 2), sizeof *owned);
	script->keys = malloc(((size_t)keys_max + 2) * sizeof *script->keys);
	if (owned && script->keys) {
		f.key = owned;
		f.next = owned + keys_max + 2;
		choose_errors(&f, fitting);
		if (flight->count > 1)
			f.key[f.count++] = flight->count - 1;
		/* coarse to fine, so that few keyframes go where they are needed most */
		for (double bound = 1024; bound >= 1; bound /= 4)
			while (f.count > 1 && refine(&f, bound, keys_max))
				;
		take_keys(script, &f, fitting->fps);
	} else
		eco_script_free(script);
	free(owned);
	return script->keys ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u keyframes", keys_max);
}

static void put_vector(FILE *out, const char *name, const double v[3], double parts)
{
	fprintf(out, ", \"%s\": [%.15g, %.15g, %.15g]", name, round(v[0] * parts) / parts + 0, round(v[1] * parts) / parts + 0,
		round(v[2] * parts) / parts + 0);
}

/* Level cameras that do not look straight up or down have the up that a script has without one. */
static bool is_level(const struct eco_script *script)
{
	for (const struct eco_key *k = script->keys; k < script->keys + script->count; k++) {
		double look[3] = { (k->target[0] - k->eye[0]) / AHEAD_M, (k->target[1] - k->eye[1]) / AHEAD_M, (k->target[2] - k->eye[2]) / AHEAD_M };
		if (fabs(look[2]) > 0.9 || fabs(k->up[0] * look[1] - k->up[1] * look[0]) > 1e-3 || k->up[2] < 0)
			return false;
	}
	return true;
}

char *eco_script_text(const struct eco_script *script, size_t *size)
{
	char *text = NULL;
	FILE *out = open_memstream(&text, size);
	bool level = is_level(script);
	/* a tenth of a millimetre, finer in scenes that are small */
	double parts = script->error_m > 0 && script->error_m < 1e-3 ? 1e6 : 1e4;
	if (!out)
		return NULL;
	fprintf(out, "{\"fps\": %.15g, \"keyframes\": [\n", round(script->fps * 1e4) / 1e4);
	for (uint32_t i = 0; i < script->count; i++) {
		const struct eco_key *k = &script->keys[i];
		fprintf(out, "  {\"time_s\": %.15g", round(k->time_s * 1e6) / 1e6);
		put_vector(out, "eye", k->eye, parts);
		put_vector(out, "target", k->target, parts);
		if (!level)
			put_vector(out, "up", k->up, 1e5);
		fprintf(out, ", \"fov_y_deg\": %.15g}%s\n", round(k->fov_y_deg * 1e3) / 1e3, i + 1 < script->count ? "," : "");
	}
	fputs("]}\n", out);
	if (fclose(out) == 0)
		return text;
	free(text);
	return NULL;
}

void eco_script_free(struct eco_script *script)
{
	free(script->keys);
	*script = (struct eco_script){ 0 };
}
