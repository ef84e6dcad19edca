/* A large scene of billboard clouds (Kratt 2014, figure 4, right): one plant as many times as fit into a
 * view, turned and scaled at random, each with the cloud of its distance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/format/view.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/pictures/bench_billboards_q.h"

#define SIDE 40u                 /* plants along an edge of the field */
#define PLANTS (SIDE * SIDE)
#define APART 0.8                /* between neighbours, of the plant's height */
#define WIDTH 640u
#define HEIGHT 400u
#define PANELS 3u                /* full detail, clouds, their levels */

const uint32_t bench_field_caps[BENCH_FIELD_LEVELS] = { 333, 166, 33, 8 };
static const uint32_t known_cap[BENCH_FIELD_LEVELS] = { 5, 3, 2, 1 };    /* of bench_billboards_caps */
static const double least_px[BENCH_FIELD_LEVELS] = { 150, 75, 25, 0 };   /* heights on the screen */
static const uint8_t level_rgb[BENCH_FIELD_LEVELS][3] = { { 200, 60, 40 }, { 235, 160, 50 },
	{ 70, 150, 70 }, { 60, 110, 200 } };

struct stand { struct lod_place place; double away; uint32_t level; };
struct field {
	struct eco_model *model;
	double height, center[3], radius;
	struct lod_eye eye;
	struct stand stands[PLANTS];
	uint32_t count;              /* in view, the nearest first */
	struct lod_billboard_cloud clouds[BENCH_FIELD_LEVELS];
	uint8_t (*rgb[BENCH_FIELD_LEVELS])[3];
	struct lod_raster full, drawn;
};

/* ---- Places ---- */

static void measure_model(struct field *f)
{
	const struct eco_model *m = f->model;
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (size_t i = 0; i < 3 * (size_t)m->triangle_count; i++)
		for (int k = 0; k < 3; k++) {
			double at = m->position[3 * (size_t)m->index[i] + (size_t)k];
			low[k] = fmin(low[k], at);
			high[k] = fmax(high[k], at);
		}
	for (int k = 0; k < 3; k++) {
		f->center[k] = (low[k] + high[k]) / 2;
		f->radius += (high[k] - low[k]) * (high[k] - low[k]) / 4;
	}
	f->radius = sqrt(f->radius);
	f->height = high[2] - low[2];
}

static int by_distance(const void *a, const void *b)
{
	const struct stand *x = a, *y = b;
	return x->away < y->away ? -1 : x->away > y->away;
}

static double dice(uint64_t *state) { return eco_random_unit(eco_random_next(state)); }

/* Jittered rows before the eye. */
static void place_plants(struct field *f)
{
	double step = APART * f->height, to_px = f->height / f->eye.pixel_rad;
	uint64_t state = 2014;
	for (uint32_t i = 0; i < PLANTS; i++) {
		struct stand s = { .place = { .at = { (i % SIDE + dice(&state) - SIDE / 2.0) * step,
			(i / SIDE + dice(&state)) * step, 0 }, .scale = 0.75 + 0.5 * dice(&state) } };
		double world[3];
		eco_angle16_sincos((uint16_t)eco_random_next(&state), &s.place.sine, &s.place.cosine);
		const float center[3] = { (float)f->center[0], (float)f->center[1], (float)f->center[2] };
		lod_place_point(&s.place, center, world);
		for (int k = 0; k < 3; k++)
			s.away += (world[k] - f->eye.at[k]) * (world[k] - f->eye.at[k]);
		s.away = sqrt(s.away);
		while (s.place.scale * to_px / s.away < least_px[s.level])
			s.level++;
		if (lod_eye_sees(&f->eye, world, s.place.scale * f->radius))
			f->stands[f->count++] = s;
	}
	qsort(f->stands, f->count, sizeof *f->stands, by_distance);
}

static void look(struct field *f)
{
	const struct eco_view view = { .eye = { 0, -2 * f->height, 2.2 * f->height },
		.target = { 0, 8 * f->height, 0 }, .up = { 0, 0, 1 }, .fov_y_deg = 40, .width = WIDTH,
		.height = HEIGHT };
	lod_eye_make(&f->eye, &view);
}

/* ---- Drawing ---- */

static enum eco_code make_clouds(struct field *f, const struct bench_billboards_q *known,
	struct eco_error *error)
{
	struct lod_billboard_plant *plant;
	enum eco_code code = lod_billboard_plant_open(&plant, f->model, &(struct lod_billboard_options){ 0 },
		error);
	for (uint32_t i = 0; i < BENCH_FIELD_LEVELS && !code; i++) {
		struct lod_billboard_cloud *cloud = &f->clouds[i];
		code = lod_billboard_cloud_make(cloud, plant, &(struct lod_billboard_options){
			.cap = bench_field_caps[i],
			.epsilon = known->point[BENCH_BILLBOARDS_ALL][known_cap[i]].epsilon }, error);
		f->rgb[i] = code ? NULL : malloc((cloud->count + 1) * sizeof *f->rgb[i]);
		if (!code && !f->rgb[i])
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for colours");
		for (uint32_t k = 0; k < cloud->count && !code; k++)
			bench_billboards_color(&cloud->items[k].image, f->rgb[i][k]);
	}
	lod_billboard_plant_close(plant);
	return code;
}

static enum eco_code draw(struct bench *bench, struct field *f, struct eco_error *error)
{
	const struct lod_raster_options options = { .width = WIDTH, .height = HEIGHT, .owner = true,
		.item = true };
	enum eco_code code = lod_raster_init(&f->full, &options, error);
	if (!code)
		code = lod_raster_init(&f->drawn, &options, error);
	for (int clouds = 0; clouds < 2 && !code; clouds++) {
		struct lod_raster *raster = clouds ? &f->drawn : &f->full;
		lod_raster_clear(raster);
		lod_raster_camera(raster, &f->eye, 0.01 * f->height);
		for (uint32_t i = 0; i < f->count; i++) {
			const struct stand *s = &f->stands[i];
			double world[3];
			const float center[3] = { (float)f->center[0], (float)f->center[1],
				(float)f->center[2] };
			lod_place_point(&s->place, center, world);
			if (lod_raster_hides(raster, world, 1.05 * s->place.scale * f->radius))
				continue;
			lod_raster_object(raster, &s->place);
			if (clouds)
				lod_billboard_cloud_draw(&f->clouds[s->level], i + 1, raster);
			else
				bench_model_draw(f->model, i + 1, raster);
		}
		if (bench_stopped(bench))
			return eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	return code;
}

/* ---- The picture ---- */

/* Neighbours of one colour are told apart by how dark they are. */
static void paint_pixel(const struct field *f, uint32_t panel, size_t i, uint8_t rgb[3])
{
	static const uint8_t plain[3] = { 120, 150, 90 };
	const struct lod_raster *raster = panel ? &f->drawn : &f->full;
	memset(rgb, 255, 3);
	if (!raster->owner[i])
		return;
	const struct stand *s = &f->stands[raster->owner[i] - 1];
	const uint8_t *from = panel == 0 ? plain : panel == 1 ? f->rgb[s->level][raster->item[i]]
		: level_rgb[s->level];
	double shade = 0.7 + 0.3 * eco_random_unit(eco_random(4, raster->owner[i]));
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(shade * from[k]);
}

static enum eco_code write_picture(struct bench *bench, const struct field *f, const char *name,
	struct eco_error *error)
{
	char file[128];
	uint8_t *rgb = malloc((size_t)PANELS * WIDTH * HEIGHT * 3);
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	for (uint32_t panel = 0; panel < PANELS; panel++)
		for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
			paint_pixel(f, panel, i, rgb
				+ 3 * (i / WIDTH * PANELS * WIDTH + panel * WIDTH + i % WIDTH));
	snprintf(file, sizeof file, "billboards_field-%s.png", name);
	enum eco_code code = bench_picture_write(bench, file, PANELS * WIDTH, HEIGHT, rgb, error);
	free(rgb);
	return code;
}

static void score(const struct field *f, struct bench_field_q *q)
{
	struct lod_score score;
	lod_score(&score, &(struct lod_score_input){ WIDTH, HEIGHT, f->drawn.cover, f->full.cover,
		f->drawn.owner, f->full.owner });
	*q = (struct bench_field_q){ .q = score.q, .precision = score.precision, .recall = score.recall,
		.owner_q = score.owner_q };
	for (uint32_t i = 0; i < f->count; i++) {
		uint32_t level = f->stands[i].level;
		q->plants[level]++;
		q->vertices += 6.0 * f->clouds[level].count;
		q->full += 3.0 * f->model->triangle_count;
	}
}

enum eco_code bench_billboards_field(struct bench *bench, const char *name,
	const struct bench_billboards_q *known, struct bench_field_q *q, struct eco_model *model,
	struct eco_error *error)
{
	struct field *f = calloc(1, sizeof *f);
	enum eco_code code = f ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for a field of plants");
	if (!code) {
		f->model = model;
		measure_model(f);
		look(f);
		place_plants(f);
		code = make_clouds(f, known, error);
	}
	if (!code)
		code = draw(bench, f, error);
	if (!code) {
		score(f, q);
		code = write_picture(bench, f, name, error);
	}
	for (uint32_t i = 0; f && i < BENCH_FIELD_LEVELS; i++) {
		lod_billboard_cloud_free(&f->clouds[i]);
		free(f->rgb[i]);
	}
	if (f) {
		lod_raster_free(&f->full);
		lod_raster_free(&f->drawn);
	}
	free(f);
	eco_model_free(model);
	return code;
}
