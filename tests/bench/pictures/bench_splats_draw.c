/* Pictures of one plant, whole and of few vertices. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "lod/build/weld.h"
#include "tests/bench/pictures/bench_splats.h"

#define AWAY 512.0               /* of the camera, radii */
#define FRAME 1.02
#define SOUP 1024u
#define SIDE 4u                  /* samples a pixel: SIDE x SIDE */

/* ---- Views ---- */

static double bound(struct bench_splats_pictures *p)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY },
		far2 = 0;
	for (int pass = 0; pass < 2; pass++)
		for (size_t i = 0; i < 3 * (size_t)p->model->triangle_count; i++) {
			const float *at = p->model->position + 3 * (size_t)p->model->index[i];
			double d2 = 0;
			for (int k = 0; k < 3; k++) {
				low[k] = at[k] < low[k] ? at[k] : low[k];
				high[k] = at[k] > high[k] ? at[k] : high[k];
				p->center[k] = (low[k] + high[k]) / 2;
				d2 += (at[k] - p->center[k]) * (at[k] - p->center[k]);
			}
			far2 = pass && d2 > far2 ? d2 : far2;
		}
	p->radius = sqrt(far2);
	return high[2] - low[2];
}

static void look(struct bench_splats_pictures *p)
{
	for (uint32_t i = 0; i < BENCH_SPLATS_VIEWS; i++) {
		struct lod_eye *eye = &p->eyes[i];
		double s, c, up, flat;
		eco_angle16_sincos(eco_angle16_from_deg(i * 137.5 + 31), &s, &c);
		eco_angle16_sincos(eco_angle16_from_deg(-10 + 70 * (i + 0.5) / BENCH_SPLATS_VIEWS), &up, &flat);
		const double from[3] = { flat * c, flat * s, up };
		*eye = (struct lod_eye){ .right = { -s, c, 0 }, .up = { -up * c, -up * s, flat },
			.tan_x = FRAME / AWAY, .tan_y = FRAME / AWAY };
		for (int k = 0; k < 3; k++) {
			eye->at[k] = p->center[k] + AWAY * p->radius * from[k];
			eye->forward[k] = -from[k];
		}
	}
}

static void start(const struct bench_splats_pictures *p, uint32_t view, struct lod_raster *raster)
{
	struct lod_eye eye = p->eyes[view];
	eye.pixel_rad = 2 * eye.tan_y / raster->height;
	lod_raster_clear(raster);
	lod_raster_camera(raster, &eye, (AWAY - 2) * p->radius);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
}

/* ---- The whole plant ---- */

void bench_model_draw(const struct eco_model *model, uint64_t owner, struct lod_raster *raster)
{
	float position[9 * SOUP], uv[6 * SOUP];
	uint32_t count = 0;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		enum eco_drop why;
		bool good = lod_mesh_usable(model, t, &why);
		for (uint32_t i = 0; i < 3 && good; i++) {
			size_t vertex = model->index[3 * (size_t)t + i];
			memcpy(position + 9 * count + 3 * i, model->position + 3 * vertex, 3 * sizeof(float));
			if (model->uv)
				memcpy(uv + 6 * count + 2 * i, model->uv + 2 * vertex, 2 * sizeof(float));
		}
		count += good;
		if (count < SOUP && t + 1 < model->triangle_count
				&& model->material[t + 1] == model->material[t])
			continue;
		const struct eco_material *m = lod_mesh_material(model, model->material[t]);
		const struct eco_image *image = m->cutout && model->uv && m->image < model->image_count
			? &model->images[m->image] : NULL;
		lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = count, .position = position,
			.uv = image ? uv : NULL, .cutout = image, .owner = owner });
		count = 0;
	}
}

/* Covered samples of each pixel, from a picture `by` times as wide and high. */
static void count_samples(const struct lod_raster *fine, uint32_t side, uint32_t by, uint8_t *count)
{
	memset(count, 0, (size_t)side * side);
	for (uint32_t y = 0; y < side * by; y++)
		for (uint32_t x = 0; x < side * by; x++)
			count[(size_t)(y / by) * side + x / by] +=
				fine->cover[(size_t)y * fine->width + x] & 1;
}

static enum eco_code make_size(struct bench_splats_pictures *p, struct bench_splats_size *size,
	double height_px, double height, struct eco_error *error)
{
	size->side = (uint32_t)ceil(2 * FRAME * p->radius * height_px / height);
	size_t pixels = (size_t)size->side * size->side;
	enum eco_code code = lod_raster_init(&size->raster, &(struct lod_raster_options){ .width = size->side,
		.height = size->side, .item = true }, error);
	if (!code)
		code = lod_raster_init(&size->fine, &(struct lod_raster_options){ .width = SIDE * size->side,
			.height = SIDE * size->side, .silhouette = true }, error);
	size->count = malloc(pixels);
	for (uint32_t view = 0; view < BENCH_SPLATS_VIEWS && !code; view++) {
		size->hard[view] = malloc(pixels);
		size->soft[view] = malloc(pixels);
		if (!size->count || !size->hard[view] || !size->soft[view])
			return eco_fail(error, ECO_NO_MEMORY, "no memory for pictures");
		start(p, view, &size->raster);
		bench_model_draw(p->model, 1, &size->raster);
		memcpy(size->hard[view], size->raster.cover, pixels);
		start(p, view, &size->fine);
		bench_model_draw(p->model, 1, &size->fine);
		count_samples(&size->fine, size->side, SIDE, size->soft[view]);
	}
	return code;
}

enum eco_code bench_splats_open(struct bench_splats_pictures *p, const struct eco_model *model,
	const double heights_px[BENCH_SPLATS_SIZES], struct eco_error *error)
{
	*p = (struct bench_splats_pictures){ .model = model };
	double height = bound(p);
	enum eco_code code = height > 0.05 * p->radius ? ECO_OK
		: eco_fail(error, ECO_UNSUPPORTED, "a plant without height");
	look(p);
	for (uint32_t i = 0; i < BENCH_SPLATS_SIZES && !code; i++)
		code = make_size(p, &p->sizes[i], heights_px[i], height, error);
	if (code)
		bench_splats_close(p);
	return code;
}

void bench_splats_close(struct bench_splats_pictures *p)
{
	for (uint32_t i = 0; i < BENCH_SPLATS_SIZES; i++) {
		struct bench_splats_size *size = &p->sizes[i];
		lod_raster_free(&size->raster);
		lod_raster_free(&size->fine);
		for (uint32_t view = 0; view < BENCH_SPLATS_VIEWS; view++) {
			free(size->hard[view]);
			free(size->soft[view]);
		}
		free(size->count);
	}
	memset(p, 0, sizeof *p);
}

/* ---- Scores and paintings ---- */

void bench_splats_score(struct bench_splats_pictures *p, uint32_t which,
	void (*draw)(const void *what, struct lod_raster *raster), const void *what, struct bench_splats_q *q)
{
	uint32_t first = which < BENCH_SPLATS_SIZES ? which : 0,
		end = which < BENCH_SPLATS_SIZES ? which + 1 : BENCH_SPLATS_SIZES;
	double share = 1.0 / (BENCH_SPLATS_VIEWS * (end - first));
	*q = (struct bench_splats_q){ 0 };
	for (uint32_t i = first; i < end; i++)
		for (uint32_t view = 0; view < BENCH_SPLATS_VIEWS; view++) {
			struct bench_splats_size *size = &p->sizes[i];
			struct lod_score score;
			start(p, view, &size->raster);
			draw(what, &size->raster);
			lod_score(&score, &(struct lod_score_input){ .width = size->side,
				.height = size->side, .cover = size->raster.cover,
				.reference = size->hard[view] });
			q->hard += share * score.q;
			q->precision += share * score.precision;
			q->recall += share * score.recall;
			start(p, view, &size->fine);
			draw(what, &size->fine);
			count_samples(&size->fine, size->side, SIDE, size->count);
			q->soft += share * lod_soft_q(size->count, size->soft[view],
				(size_t)size->side * size->side);
		}
}

void bench_splats_paint(struct bench_splats_pictures *p, uint32_t view,
	void (*draw)(const void *what, struct lod_raster *raster), const void *what, const uint8_t (*rgb)[3],
	uint8_t *to, uint32_t stride)
{
	static const uint8_t grey[3] = { 60, 60, 60 };
	struct bench_splats_size *size = &p->sizes[BENCH_SPLATS_SIZES - 1];
	struct lod_raster *raster = &size->raster;
	start(p, view, raster);
	if (draw)
		draw(what, raster);
	else
		bench_model_draw(p->model, 1, raster);
	for (uint32_t y = 0; y < size->side; y++)
		for (uint32_t x = 0; x < size->side; x++) {
			size_t i = (size_t)y * size->side + x;
			uint8_t *at = to + 3 * ((size_t)y * stride + x);
			memset(at, 255, 3);
			if (raster->cover[i])
				memcpy(at, rgb ? rgb[raster->item[i]] : grey, 3);
		}
}

/* ---- Few vertices ---- */

uint32_t bench_splats_state(const struct lod_splats *s, uint32_t vertices, struct lod_splat *to)
{
	uint32_t level = 0, size = 1, next = 0, gone = 0;
	while (level + 1 < s->level_count && s->level_end[level + 1] - s->level_end[level] <= vertices)
		level++;
	size = s->level_end[level] - lod_splats_first(s, level);
	if (level + 1 < s->level_count) {
		next = (s->level_end[level + 1] - s->level_end[level]) / size;
		gone = (vertices - size) / (next - 1);
	}
	if (gone)
		memcpy(to, s->items + s->level_end[level], next * gone * sizeof *to);
	memcpy(to + next * gone, s->items + lod_splats_first(s, level) + gone, (size - gone) * sizeof *to);
	return next * gone + size - gone;
}

void bench_splats_draw(const void *drawn_of, struct lod_raster *raster)
{
	const struct bench_splats_drawn *drawn = drawn_of;
	for (uint32_t i = 0; i < drawn->count; i++) {
		const struct lod_splat *splat = &drawn->items[i];
		lod_raster_splats(raster, &(struct lod_raster_batch){ .count = 1, .position = splat->center,
			.half = splat->shape.half[0], .opacity = &splat->shape.opacity, .item = i,
			.owner = 1 });
	}
}
