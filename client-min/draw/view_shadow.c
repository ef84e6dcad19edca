#include "client-min/draw/view_shadow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_shadow_cast.h"

#define LOWEST 0.02f                     /* of the sun: lower it gives no light that is worth a shadow */
#define SPREAD 64.0                      /* the largest texel's side over the smallest's, at most */
#define BEYOND 1.25                      /* times as far as the farthest plant ground is still shaded */
#define BACK 0.25                        /* about a texel a pixel near the eye: lod/EXPERIMENTS.md, Shadows */
#define MARGIN 2.0                       /* texels around what is seen */

/* Places from the eye of what is seen in pixels. */
struct fit {
	const struct view_shadow_job *job;
	double nearest_m, farthest_m;    /* forward of the eye */
	double row[3][4];                /* U, V, W */
};

/* ---- What is seen ---- */

/* From the eye to what a pixel shows; false: nothing, or something beyond the range. */
static bool place_of(const struct fit *fit, uint32_t x, uint32_t y, double to[3])
{
	const struct view_picture *p = fit->job->picture;
	const struct lod_eye *eye = fit->job->eye;
	float depth = p->depth[(size_t)y * p->width + x];
	if (!(depth > 0) || 1 / (double)depth > fit->farthest_m)
		return false;
	double u = ((x + 0.5) / p->width * 2 - 1) * eye->tan_x,
		v = (1 - (y + 0.5) / p->height * 2) * eye->tan_y;
	for (int k = 0; k < 3; k++)
		to[k] = (eye->forward[k] + u * eye->right[k] + v * eye->up[k]) / (double)depth;
	return true;
}

/* Ground counts as far as plants are seen; without plants all of it. */
static bool find_range(struct fit *fit)
{
	const struct view_picture *p = fit->job->picture;
	float deepest = 0, shallowest = INFINITY, plant = INFINITY;
	for (size_t i = 0; i < (size_t)p->width * p->height; i++) {
		if (!(p->depth[i] > 0))
			continue;
		deepest = fmaxf(deepest, p->depth[i]);
		shallowest = fminf(shallowest, p->depth[i]);
		if (p->owner[i])
			plant = fminf(plant, p->depth[i]);
	}
	if (!(deepest > 0))
		return false;
	fit->nearest_m = 1 / (double)deepest;
	fit->farthest_m = plant < INFINITY ? BEYOND / (double)plant : 1 / (double)shallowest;
	return true;
}

static double apply(const double row[4], const double to[3])
{
	return row[0] * to[0] + row[1] * to[1] + row[2] * to[2] + row[3];
}

/* Least and most of what is seen: of W; or of U / W and V / W. */
struct extent { double low[2], high[2]; };

static void grow(struct extent *e, int i, double v)
{
	e->low[i] = v < e->low[i] ? v : e->low[i];
	e->high[i] = v > e->high[i] ? v : e->high[i];
}

static struct extent find_extent(const struct fit *fit, bool of_w)
{
	const struct view_picture *p = fit->job->picture;
	struct extent e = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
	double to[3];
	for (uint32_t y = 0; y < p->height; y++)
		for (uint32_t x = 0; x < p->width; x++) {
			if (!place_of(fit, x, y, to))
				continue;
			double w = apply(fit->row[2], to);
			grow(&e, 0, of_w ? w : apply(fit->row[0], to) / w);
			if (!of_w)
				grow(&e, 1, apply(fit->row[1], to) / w);
		}
	return e;
}

/* ---- Maps ---- */

static void cross(const double a[3], const double b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Two directions across an axis, the first of them across `other`, too; where that is the axis, `instead`. */
static void across(const double axis[3], const double other[3], const double instead[3], double out[2][3])
{
	cross(axis, other, out[0]);
	if (!(lod_dot(out[0], out[0]) > 1e-9 * lod_dot(axis, axis) * lod_dot(other, other)))
		cross(axis, instead, out[0]);
	cross(axis, out[0], out[1]);
	for (int i = 0; i < 2; i++) {
		double part = 1 / sqrt(lod_dot(out[i], out[i]));
		for (int k = 0; k < 3; k++)
			out[i][k] *= part;
	}
}

static void map_standard(struct fit *fit)
{
	const float *s = fit->job->sun;
	const struct lod_eye *eye = fit->job->eye;
	double side[2][3];
	across((const double[3]){ (double)s[0], (double)s[1], (double)s[2] }, eye->forward, eye->up, side);
	memset(fit->row, 0, sizeof fit->row);
	memcpy(fit->row[0], side[0], sizeof side[0]);
	memcpy(fit->row[1], side[1], sizeof side[1]);
	fit->row[2][3] = 1;
}

/* The eye's space after perspective, x, y, z in [-1, 1] and w, as rows of places from the eye. */
static void perspective_rows(const struct fit *fit, double row[4][4])
{
	const struct lod_eye *eye = fit->job->eye;
	double back = BACK * sqrt(fit->nearest_m * fit->farthest_m), near = fit->nearest_m + back,
		far = fmax(fit->farthest_m, fit->nearest_m * 1.01) + back, deep = (far + near) / (far - near),
		shift = 2 * far * near / (far - near);
	for (int k = 0; k < 3; k++) {
		row[0][k] = eye->right[k] / eye->tan_x;
		row[1][k] = eye->up[k] / eye->tan_y;
		row[2][k] = eye->forward[k] * deep;
		row[3][k] = eye->forward[k];
	}
	row[0][3] = row[1][3] = 0;
	row[2][3] = back * deep - shift;
	row[3][3] = back;
}

/* A W that is the same everywhere makes texels of one size: as much of it as keeps them within SPREAD; then
 * the least W is 1. */
static void limit_spread(struct fit *fit)
{
	struct extent e = find_extent(fit, true);
	double more = (e.high[0] / SPREAD - e.low[0]) / (1 - 1 / SPREAD);
	more = more > 0 ? more : 0;
	fit->row[2][3] += more;
	for (int k = 0; k < 4; k++)
		fit->row[2][k] /= fmax(e.low[0] + more, 1e-9);
}

static void map_perspective(struct fit *fit)
{
	const float *s = fit->job->sun;
	const double sun[3] = { (double)s[0], (double)s[1], (double)s[2] };
	double eye[4][4], at[4], side[2][3];
	perspective_rows(fit, eye);
	for (int i = 0; i < 4; i++)
		at[i] = lod_dot(eye[i], sun);
	double length = sqrt(lod_dot(at, at));
	across(at, (const double[3]){ 0, 0, 1 }, (const double[3]){ 0, 1, 0 }, side);
	for (int k = 0; k < 4; k++) {
		double q[3] = { eye[0][k], eye[1][k], eye[2][k] };
		fit->row[0][k] = lod_dot(side[0], q);
		fit->row[1][k] = lod_dot(side[1], q);
		fit->row[2][k] = length * eye[3][k] - at[3] * lod_dot(at, q) / length;
	}
	limit_spread(fit);
}

/* Moves and stretches what is seen to the whole map. */
static void fill_map(struct view_shadow *shadow, struct fit *fit)
{
	struct extent e = find_extent(fit, false);
	for (int i = 0; i < 2; i++) {
		double factor = (shadow->size - 2 * MARGIN) / fmax(e.high[i] - e.low[i], 1e-6);
		for (int k = 0; k < 4; k++)
			fit->row[i][k] = (fit->row[i][k] - e.low[i] * fit->row[2][k]) * factor
				+ MARGIN * fit->row[2][k];
	}
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++)
			shadow->row[i][k] = (float)fit->row[i][k];
	memcpy(shadow->row[3], shadow->sun, sizeof shadow->sun);
	shadow->row[3][3] = 0;
}

enum eco_code view_shadow_make(struct view_shadow *shadow, const struct view_shadow_job *job,
	struct eco_error *error)
{
	struct fit fit = { .job = job };
	*shadow = (struct view_shadow){ .size = job->size };
	memcpy(shadow->sun, job->sun, sizeof shadow->sun);
	if (!(job->sun[2] > LOWEST) || !find_range(&fit))
		return ECO_OK;
	shadow->top = malloc((size_t)job->size * job->size * sizeof *shadow->top);
	if (!shadow->top)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a shadow map of %u x %u texels",
			job->size, job->size);
	if (job->kind == VIEW_SHADOWS_PERSPECTIVE)
		map_perspective(&fit);
	else
		map_standard(&fit);
	fill_map(shadow, &fit);
	enum eco_code code = view_shadow_cast(shadow, job, error);
	if (code)
		view_shadow_free(shadow);
	return code;
}

void view_shadow_free(struct view_shadow *shadow)
{
	free(shadow->top);
	*shadow = (struct view_shadow){ 0 };
}

/* ---- Looking up ---- */

static float dot3(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross3(const float a[3], const float b[3], float out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

bool view_shadow_place(const struct view_shadow *shadow, const float to[3], float texel[2])
{
	float w = dot3(shadow->row[2], to) + shadow->row[2][3], last = (float)shadow->size - 1.5f;
	if (!shadow->top || !(w > 0))
		return false;
	for (int i = 0; i < 2; i++)
		texel[i] = (dot3(shadow->row[i], to) + shadow->row[i][3]) / w;
	return texel[0] >= 1.5f && texel[1] >= 1.5f && texel[0] < last && texel[1] < last;
}

/* Metres across the beams from one texel to the next, to the right and down. */
static void find_steps(const struct view_shadow *shadow, const float to[3], const float texel[2],
	float step[2][3])
{
	float w = dot3(shadow->row[2], to) + shadow->row[2][3], slope[2][3];
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 3; k++)
			slope[i][k] = (shadow->row[i][k] - texel[i] * shadow->row[2][k]) / w;
	cross3(slope[1], shadow->sun, step[0]);
	cross3(shadow->sun, slope[0], step[1]);
	float part = 1 / dot3(slope[0], step[0]);
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 3; k++)
			step[i][k] *= part;
}

/* How much lower a surface may be within the texels that are looked at, so that it is not its own shadow. */
static float slack_of(const struct view_shadow *shadow, const float step[2][3], const float *normal)
{
	float sum = 0;
	for (int i = 0; i < 2; i++)
		sum += normal ? fabsf(dot3(normal, step[i])) : sqrtf(dot3(step[i], step[i]));
	return 1.5f * sum / (normal ? fmaxf(fabsf(dot3(normal, shadow->sun)), 0.1f) : 1);
}

float view_shadow_lit(const struct view_shadow *shadow, const float to[3], const float normal[3],
	float *texel_m)
{
	float at[2], step[2][3], share[2][3], lit = 0;
	int from[2];
	if (!view_shadow_place(shadow, to, at))
		return -1;
	find_steps(shadow, to, at, step);
	*texel_m = sqrtf(fmaxf(dot3(step[0], step[0]), dot3(step[1], step[1])));
	float height = dot3(shadow->row[3], to) + slack_of(shadow, step, normal);
	for (int i = 0; i < 2; i++) {
		float low = floorf(at[i] - 0.5f), part = at[i] - 0.5f - low;
		from[i] = (int)low - (part < 0.5f);
		part += part < 0.5f ? 0.5f : -0.5f;
		share[i][0] = 0.5f * (1 - part);
		share[i][1] = 0.5f;
		share[i][2] = 0.5f * part;
	}
	for (int j = 0; j < 3; j++) {
		const float *top = shadow->top + (size_t)(from[1] + j) * shadow->size + (size_t)from[0];
		for (int i = 0; i < 3; i++)
			lit += height >= top[i] ? share[0][i] * share[1][j] : 0;
	}
	return lit;
}

/* ---- How fine it is ---- */

struct pair { double depth, texels; };

static int by_texels(const void *a, const void *b)
{
	double x = ((const struct pair *)a)->texels, y = ((const struct pair *)b)->texels;
	return x < y ? -1 : x > y;
}

static int by_nearness(const void *a, const void *b)
{
	double x = ((const struct pair *)a)->depth, y = ((const struct pair *)b)->depth;
	return x > y ? -1 : x < y;
}

/* Texels between a pixel of the ground and the one to its right or below it, whichever are more. */
static bool pair_at(const struct view_shadow *shadow, const struct fit *fit, uint32_t x, uint32_t y,
	struct pair *pair)
{
	const struct view_picture *p = fit->job->picture;
	float texel[3][2];
	pair->texels = 0;
	for (int i = 0; i < 3; i++) {
		uint32_t px = x + (i == 1), py = y + (i == 2);
		double to[3];
		if (p->owner[(size_t)py * p->width + px] || !place_of(fit, px, py, to))
			return false;
		if (!view_shadow_place(shadow, (const float[3]){ (float)to[0], (float)to[1], (float)to[2] },
				texel[i]))
			return false;
		pair->texels = fmax(pair->texels, hypot((double)(texel[i][0] - texel[0][0]),
			(double)(texel[i][1] - texel[0][1])));
	}
	pair->depth = (double)p->depth[(size_t)y * p->width + x];
	return true;
}

double view_shadow_sharpness(const struct view_shadow *shadow, const struct view_picture *picture,
	const struct lod_eye *eye)
{
	const struct view_shadow_job job = { .picture = picture, .eye = eye };
	const struct fit fit = { .job = &job, .farthest_m = INFINITY };
	size_t count = 0, near;
	struct pair *pairs = malloc((size_t)picture->width * picture->height * sizeof *pairs);
	double median = NAN;
	for (uint32_t y = 0; pairs && y + 1 < picture->height; y += 3)
		for (uint32_t x = 0; x + 1 < picture->width; x += 3)
			count += pair_at(shadow, &fit, x, y, &pairs[count]);
	near = count / 10;
	if (near) {
		qsort(pairs, count, sizeof *pairs, by_nearness);
		qsort(pairs, near, sizeof *pairs, by_texels);
		median = pairs[near / 2].texels;
	}
	free(pairs);
	return median;
}
