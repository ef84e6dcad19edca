/* Draws a plant with light and textures. The rasteriser finds the primitive at each sample (its owners are
 * primitives here). Colours follow, once a sample: the place where the ray meets the triangle, the texel
 * there, and the light on the surface. Nine samples make a pixel, averaged in linear light. The score is
 * taken at the pixels' size, without oversampling, as a viewer's is. */
#include "ecofiles/ecopack/sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/raster/texel.h"

#define AMBIENT 0.42f
#define POINT_LIGHT 0.74f        /* mean light, over all directions, of a surface that faces the eye */
#define DEEP 0.35f               /* how much darker a plant's back is than its front */
#define BACKGROUND 0.84f         /* linear */

const uint8_t sheet_organ_rgb[ECO_ORGAN_COUNT][3] = { { 139, 90, 43 }, { 46, 139, 60 }, { 214, 30, 160 } };

struct light {
	const struct lod_eye *eye;
	double sun[3];               /* direction to the sun */
	double front, depth;         /* distance of the plant's nearest point, and its depth */
	float linear[256];
};

/* ---- Rasterising ---- */

static void raster_batch(struct lod_raster *raster, const struct sheet_plant *p, const struct sheet_batch *b,
	bool one_by_one)
{
	const struct sheet_list *image = b->geometry.uv ? &p->lists[b->list->image] : NULL;
	if (b->impostor) {
		lod_raster_impostor(raster, b->impostor,
			&(struct lod_raster_batch){ .owner = (uint64_t)b->first + 1 });
		return;
	}
	uint32_t step = one_by_one ? 1 : b->count;
	for (uint32_t i = 0; i < b->count; i += step) {
		struct lod_geometry from = lod_geometry_from(&b->geometry, b->list->list, i);
		lod_raster_list(raster, b->list->list, &from,
			&(struct lod_raster_batch){ .count = step, .area = b->area,
			.cutout = image && image->cutout ? &image->picture : NULL,
			.owner = (uint64_t)b->first + i + 1 });
	}
}

static void raster_drawing(struct lod_raster *raster, const struct sheet_plant *p, const struct lod_eye *eye,
	const struct sheet_drawing *drawing, bool one_by_one)
{
	lod_raster_clear(raster);
	lod_raster_camera(raster, eye, p->scene.near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	for (uint32_t i = 0; i < drawing->count; i++)
		raster_batch(raster, p, &drawing->batches[i], one_by_one);
}

/* ---- Colours ---- */

static void light_make(struct light *light, const struct sheet_plant *p)
{
	const struct eco_anchor *whole = &p->scene.anchors[p->scene.plants[p->number].anchor_first];
	static const double from[3] = { -0.48, 0.60, 0.64 };     /* right, up, towards the eye */
	light->eye = &p->fine_eye;
	double away = 0;
	for (int k = 0; k < 3; k++) {
		light->sun[k] = from[0] * light->eye->right[k] + from[1] * light->eye->up[k]
			- from[2] * light->eye->forward[k];
		away += (whole->center[k] - light->eye->at[k]) * light->eye->forward[k];
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
		from[k] = light->eye->at[k] - corner[k];
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

static void color_primitive(const struct sheet_batch *b, uint32_t i, enum sheet_colors colors, uint8_t rgb[3])
{
	static const uint8_t plain[ECO_ORGAN_COUNT][3] = { { 120, 96, 72 }, { 95, 127, 79 },
		{ 220, 190, 200 } };
	const uint8_t white[3] = { 255, 255, 255 }, *from = b->geometry.uv ? white : plain[b->list->organ];
	int32_t color = b->impostor ? -1 : b->geometry.color[i];
	if (colors == SHEET_ORGANS)
		from = sheet_organ_rgb[b->list->organ];
	else if (b->impostor)
		from = b->impostor->rgb[i];
	else if (color >= 0 && (uint32_t)color < b->list->list->palette_count)
		from = b->list->palette[color];
	memcpy(rgb, from, 3);
}

static void shade_sample(const struct light *light, const struct sheet_plant *p, const struct sheet_batch *b,
	uint32_t i, const double ray[3], enum sheet_colors colors, float sum[3])
{
	uint8_t rgb[3];
	float lit = POINT_LIGHT;
	color_primitive(b, i, colors, rgb);
	if (b->list->list->kind == ECO_LIST_LINES) {
		lit = light_line(light, b->geometry.position + 6 * (size_t)i);
	} else if (b->list->list->kind == ECO_LIST_TRIANGLES) {
		double w[2];
		lit = light_triangle(light, b->geometry.position + 9 * (size_t)i, ray, w);
		if (b->geometry.uv && colors == SHEET_NATURAL) {
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

static const struct sheet_batch *batch_of(const struct sheet_drawing *d, uint32_t primitive)
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

static void add_sample(const struct light *light, const struct sheet_plant *p, const struct sheet_drawing *d,
	size_t at, enum sheet_colors colors, float sum[3])
{
	const struct lod_raster *r = &p->fine;
	if (!r->owner[at]) {
		for (int k = 0; k < 3; k++)
			sum[k] += BACKGROUND;
		return;
	}
	uint32_t primitive = (uint32_t)(r->owner[at] - 1);
	const struct sheet_batch *b = batch_of(d, primitive);
	primitive += b->impostor ? r->item[at] : 0;
	double x = (2 * ((double)(at % r->width) + 0.5) / r->width - 1) * light->eye->tan_x, ray[3];
	double y = (1 - 2 * ((double)(at / r->width) + 0.5) / r->height) * light->eye->tan_y;
	for (int k = 0; k < 3; k++)
		ray[k] = light->eye->forward[k] + x * light->eye->right[k] + y * light->eye->up[k];
	float one[3] = { 0, 0, 0 }, deep = (float)((1 / (double)r->depth[at] - light->front) / light->depth);
	float near = 1 - DEEP * fminf(fmaxf(deep, 0), 1);
	shade_sample(light, p, b, primitive - b->first, ray, colors, one);
	for (int k = 0; k < 3; k++)
		sum[k] += near * one[k];
}

static uint8_t encode(float linear)
{
	float v = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
	return (uint8_t)(255 * fminf(fmaxf(v, 0), 1) + 0.5f);
}

static void shade(const struct sheet_plant *p, const struct sheet_drawing *d, enum sheet_colors colors,
	uint8_t *rgb)
{
	struct light light;
	light_make(&light, p);
	for (uint32_t y = 0; y < p->coarse.height; y++)
		for (uint32_t x = 0; x < p->coarse.width; x++, rgb += 3) {
			float sum[3] = { 0, 0, 0 };
			for (uint32_t j = 0; j < SHEET_SAMPLES; j++)
				for (uint32_t i = 0; i < SHEET_SAMPLES; i++)
					add_sample(&light, p, d,
						(size_t)(SHEET_SAMPLES * y + j) * p->fine.width
						+ SHEET_SAMPLES * x + i, colors, sum);
			for (int k = 0; k < 3; k++)
				rgb[k] = encode(sum[k] / (SHEET_SAMPLES * SHEET_SAMPLES));
		}
}

/* ---- A picture ---- */

enum eco_code sheet_plant_draw(struct sheet_plant *plant, uint64_t vertices, enum sheet_colors colors,
	struct sheet_picture *picture, struct eco_error *error)
{
	struct sheet_drawing drawing;
	enum eco_code code = sheet_drawing_make(&drawing, plant, vertices, error);
	if (code)
		return code;
	size_t pixels = (size_t)plant->coarse.width * plant->coarse.height;
	raster_drawing(&plant->coarse, plant, &plant->eye, &drawing, false);
	if (vertices >= plant->full)
		memcpy(plant->reference, plant->coarse.cover, pixels);
	struct lod_score score;
	lod_score(&score,
		&(struct lod_score_input){ .width = plant->coarse.width, .height = plant->coarse.height,
		.cover = plant->coarse.cover, .reference = plant->reference });
	raster_drawing(&plant->fine, plant, &plant->fine_eye, &drawing, true);
	shade(plant, &drawing, colors, picture->rgb);
	picture->vertices = drawing.vertices;
	picture->q = score.q;
	sheet_drawing_free(&drawing);
	return ECO_OK;
}
