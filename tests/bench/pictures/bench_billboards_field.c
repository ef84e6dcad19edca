/* A large scene of billboard clouds (Kratt 2014, figure 4, right): one plant as many times as fit into a
 * view, turned and scaled at random, each with the cloud of its distance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/view.h"
#include "lod/build/model_draw.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/pictures/bench_billboards.h"

#define SIDE 40u                 /* plants along an edge of the field */
#define PLANTS (SIDE * SIDE)
#define APART 0.8                /* between neighbours, of the plant's height */
#define WIDTH 640u
#define HEIGHT 400u
#define PANELS 3u                /* full detail, clouds, their levels */
#define LEVELS 4u

static const uint32_t caps[LEVELS] = { 333, 166, 33, 8 };
static const double least_px[LEVELS] = { 150, 75, 25, 0 };       /* heights on the screen */
static const uint8_t level_rgb[LEVELS][3] = { { 200, 60, 40 }, { 235, 160, 50 }, { 70, 150, 70 },
	{ 60, 110, 200 } };
/* Plants in view of each level, then of the picture. */
enum { VERTICES = LEVELS, FULL, Q, PRECISION, RECALL, FIGURES };

struct stand { struct lod_place place; double world[3], away; uint32_t level; };
struct field {
	struct bench *bench;
	const struct bench_model *file;
	char picture[128];
	struct eco_model model;
	const struct lod_mask *masks;
	const uint8_t (*colors)[3];          /* per triangle */
	double radius;
	struct lod_eye eye;
	struct stand stands[PLANTS];
	uint32_t count;              /* in view, the nearest first */
	struct lod_billboard_cloud clouds[LEVELS];
	struct lod_raster rasters[2];        /* full detail, clouds */
};

ECO_ORDER(by_distance, struct stand, ->away)

static double dice(uint64_t *state) { return eco_random_unit(eco_random_next(state)); }

/* Jittered rows before the eye. */
static void place_plants(struct field *f)
{
	float low[3] = { 0 }, high[3] = { 0 }, center[3];
	lod_model_bounds(&f->model, low, high);
	for (int k = 0; k < 3; k++)
		center[k] = (float)(((double)low[k] + high[k]) / 2);
	f->radius = lod_v3_distance(lod_v3_of(low), lod_v3_of(high)) / 2;
	double height = (double)high[2] - low[2], step = APART * height;
	lod_eye_make(&f->eye, &(struct eco_view){ .eye = { 0, -2 * height, 2.2 * height },
		.target = { 0, 8 * height, 0 }, .up = { 0, 0, 1 }, .fov_y_deg = 40, .width = WIDTH,
		.height = HEIGHT });
	uint64_t state = 2014;
	for (uint32_t i = 0; i < PLANTS; i++) {
		struct stand s = { .place = { .at = { (i % SIDE + dice(&state) - SIDE / 2.0) * step,
			(i / SIDE + dice(&state)) * step, 0 }, .scale = 0.75 + 0.5 * dice(&state) } };
		eco_angle16_sincos((uint16_t)eco_random_next(&state), &s.place.sine, &s.place.cosine);
		lod_place_point(&s.place, center, s.world);
		for (int k = 0; k < 3; k++)
			s.away += (s.world[k] - f->eye.at[k]) * (s.world[k] - f->eye.at[k]);
		s.away = sqrt(s.away);
		while (s.place.scale * height / f->eye.pixel_rad / s.away < least_px[s.level])
			s.level++;
		if (lod_eye_sees(&f->eye, s.world, s.place.scale * f->radius))
			f->stands[f->count++] = s;
	}
	qsort(f->stands, f->count, sizeof *f->stands, by_distance);
}

static void draw(struct field *f, bool clouds)
{
	struct lod_raster *raster = &f->rasters[clouds];
	lod_raster_init(raster, &(struct lod_raster_options){ .width = WIDTH, .height = HEIGHT,
		.owner = clouds, .item = true });
	lod_raster_clear(raster);
	lod_raster_camera(raster, &f->eye, -0.005 * f->eye.at[1]);
	for (uint32_t i = 0; i < f->count; i++) {
		const struct stand *s = &f->stands[i];
		if (lod_raster_hides(raster, s->world, 1.05 * s->place.scale * f->radius))
			continue;
		lod_raster_object(raster, &s->place);
		if (clouds)
			lod_billboard_cloud_draw(&f->clouds[s->level], i + 1, raster);
		else
			lod_model_draw(&f->model, f->masks, raster);
	}
}

/* Full detail; clouds, whose neighbours are told apart by how dark they are; their levels. */
static void paint_pixel(const struct field *f, uint32_t panel, size_t i, uint8_t rgb[3])
{
	const struct lod_raster *full = &f->rasters[0], *clouds = &f->rasters[1];
	memset(rgb, 255, 3);
	if (panel == 0 && full->cover[i])
		memcpy(rgb, f->colors[full->item[i]], 3);
	if (panel == 0 || !clouds->owner[i])
		return;
	uint32_t level = f->stands[clouds->owner[i] - 1].level;
	const uint8_t *from = panel == 2 ? level_rgb[level] : f->clouds[level].items[clouds->item[i]].rgb;
	double shade = 0.7 + 0.3 * eco_random_unit(eco_random(4, clouds->owner[i]));
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(shade * from[k]);
}

static json_t *score(const struct field *f)
{
	struct lod_score score;
	double figure[FIGURES] = { [FULL] = 3.0 * f->count * f->model.triangle_count };
	lod_score(&score, &(struct lod_score_input){ WIDTH, HEIGHT, f->rasters[1].cover, f->rasters[0].cover,
		NULL, NULL });
	for (uint32_t i = 0; i < f->count; i++) {
		figure[f->stands[i].level]++;
		figure[VERTICES] += 6.0 * f->clouds[f->stands[i].level].count;
	}
	figure[Q] = score.q;
	figure[PRECISION] = score.precision;
	figure[RECALL] = score.recall;
	return bench_reals(figure, FIGURES);
}

static json_t *make_field(void *ctx)
{
	static uint8_t rgb[PANELS * WIDTH * HEIGHT][3];
	struct field *f = ctx;
	struct lod_arena arena = { 0 };
	bench_model_read(f->file, &f->model);
	f->masks = lod_model_masks(&f->model, &arena);
	f->colors = lod_model_colors(&f->model, &arena);
	place_plants(f);
	const struct lod_billboard_plant *plant = lod_billboard_plant_make(&f->model, &arena);
	for (uint32_t i = 0; i < LEVELS; i++)
		lod_billboard_cloud_make(&f->clouds[i], plant, caps[i], &arena);
	draw(f, false);
	draw(f, true);
	for (size_t i = 0; i < (size_t)PANELS * WIDTH * HEIGHT; i++)
		paint_pixel(f, i / WIDTH % PANELS, i / (PANELS * WIDTH) * WIDTH + i % WIDTH, rgb[i]);
	bench_picture_write(f->bench, f->picture, PANELS * WIDTH, HEIGHT, *rgb);
	json_t *made = score(f);
	lod_arena_free(&arena);
	lod_raster_free(&f->rasters[0]);
	lod_raster_free(&f->rasters[1]);
	eco_model_free(&f->model);
	return made;
}

void bench_billboards_field(struct bench *bench, const struct bench_model *model)
{
	double q[FIGURES];
	struct field *f = eco_alloc(1, sizeof *f);
	f->bench = bench;
	f->file = model;
	snprintf(f->picture, sizeof f->picture, "billboards_field-%s.png", model->name);
	bench_cells(bench_unit(bench, f->picture, must_stamp(model->path), make_field, f), q, FIGURES);
	struct bench_table *table = bench_table_open(bench, "billboards_field", "plant,plants in view,"
		"of 333 billboards,of 166,of 33,of 8,vertices,vertices of full detail,Q,Precision,Recall",
		true);
	bench_table_row(table, "%s,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.3f,%.3f,%.3f", model->name,
		q[0] + q[1] + q[2] + q[3], q[0], q[1], q[2], q[3], q[VERTICES], q[FULL], q[Q],
		q[PRECISION], q[RECALL]);
	bench_table_close(table);
	bench_picture(bench, f->picture, "a field: full detail; clouds in their billboards' mean colours; "
		"their levels: at most 333 billboards (red), 166 (orange), 33 (green), 8 (blue)");
	free(f);
}
