/* The rasteriser finds the primitive at each sample (its owners are primitives here). Colours follow, once a
 * sample: the place where the ray meets the triangle, the texel there, and the light on the surface. Nine
 * samples make a pixel, averaged in linear light. Q is taken at the pixels' size, without oversampling, as a
 * viewer's is. */
#include "tests/bench/collapse/bench_sheet_draw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/raster/texel.h"

#define SAMPLES 3u               /* samples a pixel and axis */
#define AMBIENT 0.42f
#define POINT_LIGHT 0.74f        /* mean light, over all directions, of a surface that faces the eye */
#define DEEP 0.35f               /* how much darker a plant's back is than its front */
#define BACKGROUND 0.84f         /* linear */

struct light {
	struct lod_raster raster;    /* of samples */
	struct lod_eye eye;
	double sun[3];               /* direction to the sun */
	double front, depth;         /* distance of the plant's nearest point, and its depth */
	float linear[256];
};

/* ---- Colours ---- */

static void light_make(struct light *light, const struct plant_view *p)
{
	const struct eco_anchor *whole = &p->scene.anchors[p->scene.plants[p->number].anchor_first];
	static const double from[3] = { -0.48, 0.60, 0.64 };     /* right, up, towards the eye */
	struct eco_view fine = p->view;
	double away = 0;
	fine.width *= SAMPLES;
	fine.height *= SAMPLES;
	lod_eye_make(&light->eye, &fine);
	for (int k = 0; k < 3; k++) {
		light->sun[k] = from[0] * light->eye.right[k] + from[1] * light->eye.up[k]
			- from[2] * light->eye.forward[k];
		away += (whole->center[k] - light->eye.at[k]) * light->eye.forward[k];
	}
	light->front = away - whole->radius;
	light->depth = 2.0 * whole->radius;
	for (int i = 0; i < 256; i++)
		light->linear[i] = i <= 10 ? (float)i / 3294.6f
			: powf(((float)i / 255 + 0.055f) / 1.055f, 2.4f);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void difference(const float a[3], const float b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = (double)a[k] - b[k];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Brightness of a triangle, both sides alike; and the point where the ray meets it, as weights of its
 * second and third corner. */
static float light_triangle(const struct light *light, const float *corner, const double ray[3],
	double weight[2])
{
	double u[3], v[3], n[3], from[3], q[3];
	difference(corner + 3, corner, u);
	difference(corner + 6, corner, v);
	cross(u, v, n);
	double length = sqrt(dot(n, n)), facing = -dot(n, ray);
	weight[0] = weight[1] = 1.0 / 3;
	if (!(length > 0))
		return 1;
	for (int k = 0; k < 3; k++)
		from[k] = light->eye.at[k] - corner[k];
	if (fabs(facing) > 1e-12 * length) {     /* Moeller and Trumbore 1997 */
		cross(from, ray, q);
		weight[0] = fmin(fmax(dot(v, q) / facing, 0), 1);
		weight[1] = fmin(fmax(-dot(u, q) / facing, 0), 1 - weight[0]);
	}
	double lit = dot(n, light->sun) / (facing < 0 ? -length : length);
	return AMBIENT + (1 - AMBIENT) * (float)fmax(lit, 0);
}

/* A round branch: the best lit of its visible sides. */
static float light_line(const struct light *light, const float *ends)
{
	double along[3];
	difference(ends + 3, ends, along);
	double square = dot(along, along), lit = square > 0 ? dot(along, light->sun) / sqrt(square) : 0;
	return AMBIENT + (1 - AMBIENT) * 0.8f * (float)sqrt(fmax(1 - lit * lit, 0));
}

static void color_primitive(const struct plant_view_batch *b, uint32_t i, uint8_t rgb[3])
{
	static const uint8_t plain[ECO_ORGAN_COUNT][3] = { { 120, 96, 72 }, { 95, 127, 79 },
		{ 220, 190, 200 } };
	const uint8_t white[3] = { 255, 255, 255 }, *from = b->geometry.uv ? white : plain[b->list->organ];
	int32_t color = b->impostor ? -1 : b->geometry.color[i];
	if (b->impostor)
		from = b->impostor->rgb[i];
	else if (color >= 0 && (uint32_t)color < b->list->list->palette_count)
		from = b->list->palette[color];
	memcpy(rgb, from, 3);
}

static void shade_sample(const struct light *light, const struct plant_view *p,
	const struct plant_view_batch *b, uint32_t i, const double ray[3], float sum[3])
{
	uint8_t rgb[3];
	float lit = POINT_LIGHT;
	color_primitive(b, i, rgb);
	if (b->list->list->kind == ECO_LIST_LINES) {
		lit = light_line(light, b->geometry.position + 6 * (size_t)i);
	} else if (b->list->list->kind == ECO_LIST_TRIANGLES) {
		double w[2];
		lit = light_triangle(light, b->geometry.position + 9 * (size_t)i, ray, w);
		if (b->geometry.uv) {
			const float *uv = b->geometry.uv + 6 * (size_t)i;
			double rest = 1 - w[0] - w[1];
			uint8_t tint[3] = { rgb[0], rgb[1], rgb[2] };
			lod_texel_tint(lod_texel_at(&p->lists[b->list->image].picture,
				rest * uv[0] + w[0] * uv[2] + w[1] * uv[4],
				rest * uv[1] + w[0] * uv[3] + w[1] * uv[5]), tint, rgb);
		}
	}
	for (int k = 0; k < 3; k++)
		sum[k] += lit * light->linear[rgb[k]];
}

static const struct plant_view_batch *batch_of(const struct plant_view_drawing *d, uint32_t primitive)
{
	uint32_t low = 0, high = d->count;
	while (high - low > 1) {
		uint32_t middle = (low + high) / 2;
		if (d->batches[middle].first <= primitive)
			low = middle;
		else
			high = middle;
	}
	return &d->batches[low];
}

static void add_sample(const struct light *light, const struct plant_view *p,
	const struct plant_view_drawing *d, size_t at, float sum[3])
{
	const struct lod_raster *r = &light->raster;
	if (!r->owner[at]) {
		for (int k = 0; k < 3; k++)
			sum[k] += BACKGROUND;
		return;
	}
	uint32_t primitive = (uint32_t)(r->owner[at] - 1);
	const struct plant_view_batch *b = batch_of(d, primitive);
	primitive += b->impostor ? r->item[at] : 0;
	double x = (2 * ((double)(at % r->width) + 0.5) / r->width - 1) * light->eye.tan_x, ray[3];
	double y = (1 - 2 * ((double)(at / r->width) + 0.5) / r->height) * light->eye.tan_y;
	for (int k = 0; k < 3; k++)
		ray[k] = light->eye.forward[k] + x * light->eye.right[k] + y * light->eye.up[k];
	float one[3] = { 0, 0, 0 }, deep = (float)((1 / (double)r->depth[at] - light->front) / light->depth);
	float near = 1 - DEEP * fminf(fmaxf(deep, 0), 1);
	shade_sample(light, p, b, primitive - b->first, ray, one);
	for (int k = 0; k < 3; k++)
		sum[k] += near * one[k];
}

static uint8_t encode(float linear)
{
	float v = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
	return (uint8_t)(255 * fminf(fmaxf(v, 0), 1) + 0.5f);
}

static void shade(const struct light *light, const struct plant_view *p, const struct plant_view_drawing *d,
	uint8_t *rgb)
{
	for (uint32_t y = 0; y < p->view.height; y++)
		for (uint32_t x = 0; x < p->view.width; x++, rgb += 3) {
			float sum[3] = { 0, 0, 0 };
			for (uint32_t j = 0; j < SAMPLES; j++)
				for (uint32_t i = 0; i < SAMPLES; i++)
					add_sample(light, p, d,
						(size_t)(SAMPLES * y + j) * light->raster.width +
							SAMPLES * x + i,
						sum);
			for (int k = 0; k < 3; k++)
				rgb[k] = encode(sum[k] / (SAMPLES * SAMPLES));
		}
}

enum eco_code bench_sheet_draw(struct plant_view *view, uint64_t vertices, uint8_t *rgb, uint64_t *drawn,
	double *q, struct eco_error *error)
{
	struct light light;
	struct plant_view_drawing drawing;
	light_make(&light, view);
	enum eco_code code = lod_raster_init(&light.raster, &(struct lod_raster_options){ .owner = true,
		.item = true, .width = view->view.width * SAMPLES, .height = view->view.height * SAMPLES },
		error);
	if (!code)
		code = plant_view_drawing_make(&drawing, view, vertices, error);
	if (!code) {
		*drawn = drawing.vertices;
		*q = plant_view_q(view, &drawing);
		plant_view_raster(&light.raster, view, &light.eye, &drawing, true);
		shade(&light, view, &drawing, rgb);
		plant_view_drawing_free(&drawing);
	}
	lod_raster_free(&light.raster);
	return code;
}
