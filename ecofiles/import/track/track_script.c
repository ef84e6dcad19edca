/* The fewest keyframes whose spline keeps to a flight. Keyframes are put where the script that camera.c would play leaves the flight most,
 * one in each stretch that is not good enough, until all are (the idea of Douglas and Peucker 1973, with the true spline in place of
 * chords). So an overshoot between keyframes is an error like any other, and the bound that is stated has been measured at every
 * sample. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track.h"

#define DEG 57.29577951308232
#define KEYS 8000u
#define ERROR_M 0.05
#define ERROR_MOST_M 1.0
#define ERROR_DEG 0.5
#define AHEAD_M 10.0                     /* of the target; any number does, as splines are linear */
#define FPS 30.0

enum { EYE = 0, LOOK = 3, UP = 6, FOV = 9, NUMBERS = 10 };

struct fit {
	const struct eco_flight *flight;
	uint32_t *key, *next, count;         /* samples that are keyframes, ascending */
	double error_m, error_deg;           /* wanted */
	double worst_m, worst_deg;
};

/* ---- The spline, as in camera.c ---- */

static double number(const struct eco_sample *s, int n)
{
	return n < LOOK ? s->eye[n] : n < UP ? s->look[n - LOOK] : n < FOV ? s->up[n - UP] : s->fov_y_deg;
}

static double slope(const struct fit *f, uint32_t i, int n)
{
	uint32_t a = f->key[i ? i - 1 : 0], b = f->key[i + 1 < f->count ? i + 1 : i];
	return b > a ? (number(&f->flight->samples[b], n) - number(&f->flight->samples[a], n)) / (b - a) : 0;
}

struct stretch { uint32_t from, to; double a[NUMBERS], b[NUMBERS], slope_a[NUMBERS], slope_b[NUMBERS]; };

static struct stretch stretch_of(const struct fit *f, uint32_t i)
{
	struct stretch s = { .from = f->key[i], .to = f->key[i + 1] };
	for (int n = 0; n < NUMBERS; n++) {
		s.a[n] = number(&f->flight->samples[s.from], n);
		s.b[n] = number(&f->flight->samples[s.to], n);
		s.slope_a[n] = slope(f, i, n);
		s.slope_b[n] = slope(f, i + 1, n);
	}
	return s;
}

static void spline_at(const struct stretch *k, uint32_t sample, double out[NUMBERS])
{
	double h = k->to - k->from, s = (sample - k->from) / h, r = 1 - s;
	for (int n = 0; n < NUMBERS; n++)
		out[n] = k->a[n] + s * s * (3 - 2 * s) * (k->b[n] - k->a[n]) + h * s * r * (r * k->slope_a[n] - s * k->slope_b[n]);
}

static double angle(const double a[3], const double b[3])
{
	double cross[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
	return atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * DEG;
}

/* Metres, and degrees of look, roll and field of view. */
static void errors_at(const struct fit *f, const struct stretch *k, uint32_t sample, double *m, double *deg)
{
	const struct eco_sample *s = &f->flight->samples[sample];
	double at[NUMBERS];
	spline_at(k, sample, at);
	*m = sqrt(pow(at[0] - s->eye[0], 2) + pow(at[1] - s->eye[1], 2) + pow(at[2] - s->eye[2], 2));
	*deg = fmax(fmax(angle(at + LOOK, s->look), angle(at + UP, s->up)), fabs(at[FOV] - s->fov_y_deg));
	/* looks that nearly cancel each other are no looks */
	if (at[LOOK] * at[LOOK] + at[LOOK + 1] * at[LOOK + 1] + at[LOOK + 2] * at[LOOK + 2] < 0.01)
		*deg = 180;
}

/* The sample that is worst in stretch i, against what is wanted; its share of that. */
static double worst_of(struct fit *f, uint32_t i, uint32_t *worst)
{
	struct stretch k = stretch_of(f, i);
	double most = 0;
	for (uint32_t sample = k.from + 1; sample < k.to; sample++) {
		double m, deg;
		errors_at(f, &k, sample, &m, &deg);
		double share = fmax(m / f->error_m, deg / f->error_deg);
		f->worst_m = fmax(f->worst_m, m);
		f->worst_deg = fmax(f->worst_deg, deg);
		if (share > most) {
			most = share;
			*worst = sample;
		}
	}
	return most;
}

/* ---- Refinement ---- */

/* One more keyframe in each stretch that is off by more than `bound` times what is wanted. False when nothing was added. */
static bool refine(struct fit *f, double bound, uint32_t keys_max)
{
	uint32_t count = 0;
	f->worst_m = f->worst_deg = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		uint32_t worst = 0;
		f->next[count++] = f->key[i];
		if (i + 1 < f->count && worst_of(f, i, &worst) > bound && count + (f->count - i - 1) < keys_max)
			f->next[count++] = worst;
	}
	bool added = count > f->count;
	uint32_t *swap = f->key;
	f->key = f->next;
	f->next = swap;
	f->count = count;
	return added;
}

static void place_keys(struct fit *f, uint32_t keys_max)
{
	f->key[0] = 0;
	f->count = 1;
	if (f->flight->count < 2)
		return;
	f->key[f->count++] = f->flight->count - 1;
	/* coarse to fine, so that few keyframes go where they are needed most */
	for (double bound = 1024; bound >= 1; bound /= 4)
		while (refine(f, bound, keys_max))
			;
}

static void choose_errors(struct fit *f, const struct eco_fitting *fitting)
{
	const struct eco_sample *s = f->flight->samples;
	double low[3], high[3], size = 0;
	memcpy(low, s->eye, sizeof low);
	memcpy(high, s->eye, sizeof high);
	for (uint32_t i = 0; i < f->flight->count; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], s[i].eye[k]);
			high[k] = fmax(high[k], s[i].eye[k]);
		}
	for (int k = 0; k < 3; k++)
		size = fmax(size, high[k] - low[k]);
	/* no finer than the recording, nor than a small scene can show */
	double fine_m = fmin(fmax(ERROR_M, fitting->still_m / 4), ERROR_MOST_M);
	f->error_m = fitting->error_m > 0 ? fitting->error_m : size > 0 ? fmin(fine_m, size / 1000) : fine_m;
	f->error_deg = fitting->error_deg > 0 ? fitting->error_deg : f->flight->yaw_recorded ? ERROR_DEG : 2 * ERROR_DEG;
}

/* ---- Script ---- */

static void set_frames(struct eco_script *script, double length_s, double fps)
{
	static const double slower[] = { 30, 25, 15, 10, 5, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01 };
	script->fps = fps > 0 ? fps : FPS;
	for (size_t i = 0; fps <= 0 && i < sizeof slower / sizeof *slower && length_s * script->fps > ECO_SCRIPT_FRAMES; i++)
		script->fps = slower[i];
	script->frames = (uint32_t)fmin(floor(length_s * script->fps + 1e-6) + 1, UINT32_MAX);
}

static enum eco_code take_keys(struct eco_script *script, const struct fit *f, struct eco_error *error)
{
	script->keys = malloc(f->count * sizeof *script->keys);
	if (!script->keys)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u keyframes", f->count);
	script->count = f->count;
	for (uint32_t i = 0; i < f->count; i++) {
		const struct eco_sample *s = &f->flight->samples[f->key[i]];
		struct eco_key *key = &script->keys[i];
		key->time_s = f->key[i] * f->flight->step_s;
		key->fov_y_deg = s->fov_y_deg;
		for (int k = 0; k < 3; k++) {
			key->eye[k] = s->eye[k];
			key->target[k] = s->eye[k] + AHEAD_M * s->look[k];
			key->up[k] = s->up[k];
		}
	}
	return ECO_OK;
}

enum eco_code eco_script_fit(struct eco_script *script, const struct eco_flight *flight, const struct eco_fitting *fitting, struct eco_error *error)
{
	struct fit f = { .flight = flight };
	uint32_t keys_max = fitting->keys_max ? fitting->keys_max : KEYS;
	*script = (struct eco_script){ 0 };
	keys_max = keys_max < 2 ? 2 : keys_max < flight->count ? keys_max : flight->count;
	f.key = malloc(2 * ((size_t)keys_max + 2) * sizeof *f.key);
	if (!f.key)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u keyframes", keys_max);
	uint32_t *owned = f.key;
	f.next = f.key + keys_max + 2;
	choose_errors(&f, fitting);
	place_keys(&f, keys_max);
	set_frames(script, (flight->count - 1) * flight->step_s, fitting->fps);
	script->error_m = f.worst_m;
	script->error_deg = f.worst_deg;
	enum eco_code code = take_keys(script, &f, error);
	free(owned);
	return code;
}

/* Without zeros at its end. */
static void put(FILE *out, double value, int decimals)
{
	char text[64];
	int length = snprintf(text, sizeof text, "%.*f", decimals, value);
	while (length > 1 && strchr(text, '.') && (text[length - 1] == '0' || text[length - 1] == '.')) {
		bool point = text[length - 1] == '.';
		text[--length] = 0;
		if (point)
			break;
	}
	fputs(strcmp(text, "-0") == 0 ? "0" : text, out);
}

static void put_vector(FILE *out, const char *name, const double v[3], int decimals)
{
	fprintf(out, ", \"%s\": [", name);
	for (int k = 0; k < 3; k++) {
		fputs(k ? ", " : "", out);
		put(out, v[k], decimals);
	}
	fputc(']', out);
}

/* Level cameras that do not look straight up or down have the up that a script has without one. */
static bool is_level(const struct eco_script *script)
{
	for (uint32_t i = 0; i < script->count; i++) {
		const struct eco_key *k = &script->keys[i];
		double look[3] = { (k->target[0] - k->eye[0]) / AHEAD_M, (k->target[1] - k->eye[1]) / AHEAD_M, (k->target[2] - k->eye[2]) / AHEAD_M };
		double side = k->up[0] * look[1] - k->up[1] * look[0];
		if (fabs(look[2]) > 0.9 || fabs(side) > 1e-3 || k->up[2] < 0)
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
	int decimals = script->error_m > 0 && script->error_m < 1e-3 ? 6 : 4;
	if (!out)
		return NULL;
	fputs("{\"fps\": ", out);
	put(out, script->fps, 4);
	fputs(", \"keyframes\": [\n", out);
	for (uint32_t i = 0; i < script->count; i++) {
		const struct eco_key *k = &script->keys[i];
		fputs("  {\"time_s\": ", out);
		put(out, k->time_s, 6);
		put_vector(out, "eye", k->eye, decimals);
		put_vector(out, "target", k->target, decimals);
		if (!level)
			put_vector(out, "up", k->up, 5);
		fputs(", \"fov_y_deg\": ", out);
		put(out, k->fov_y_deg, 3);
		fputs(i + 1 < script->count ? "},\n" : "}\n", out);
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
