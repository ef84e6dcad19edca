#include "tests/bench/pictures/bench_splats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/impostor.h"
#include "lod/build/impostor/impostor_make.h"
#include "lod/build/plant.h"
#include "lod/geometry.h"
#include "lod/impostor.h"

#define BUDGETS BENCH_SPLATS_BUDGETS
#define STATE_MOST 4096u
const uint32_t bench_splats_budgets[BUDGETS] = { 12, 48, 200, 1000 };
const char *const bench_splats_kind_names[BENCH_SPLATS_KINDS] = { "opaque splats", "splats with opacity",
	"points", "best impostor" };
const double bench_splats_heights_px[BENCH_SPLATS_SIZES] = { 64, 256 };

bool bench_splats_is_foliage(const struct bench_model *model)
{
	static const char *const files[] = { "/eztree_oak_large.", "/eztree_pine_medium.", "/orchids.",
		"/bush.", "/sapling_quaking_aspen_s7.", "/coconutTree." };
	for (size_t i = 0; i < sizeof files / sizeof *files; i++)
		if (!model->generated && strstr(model->path, files[i]))
			return true;
	return false;
}

/* ---- Splats ---- */

static enum eco_code score_splats(struct bench_splats_pictures *pictures, const char *name, bool opaque,
	struct bench_splats_q q[BUDGETS], struct eco_error *error)
{
	struct lod_splats splats = { 0 };
	struct lod_splat *items = calloc(STATE_MOST, sizeof *items);
	if (!items)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for splats");
	enum eco_code code = lod_splats_fit(&splats, pictures->model,
		&(struct lod_splats_options){ .opaque = opaque }, error);
	if (!code && !splats.level_count)
		code = eco_fail(error, ECO_UNSUPPORTED, "%s shows nothing", name);
	for (uint32_t b = 0; b < BUDGETS && !code; b++) {
		struct bench_splats_drawn drawn = { items,
			bench_splats_state(&splats, bench_splats_budgets[b], items) };
		bench_splats_score(pictures, BENCH_SPLATS_SIZES, bench_splats_draw, &drawn, &q[b]);
	}
	lod_splats_free(&splats);
	free(items);
	return code;
}

/* ---- Points as balls, and lines for wood that has no points, by the areas of organs ---- */

struct points { const struct lod_plant *plant; uint32_t vertices; double growth; };

/* `growth`: areas of points over those that keep the sum. */
static void draw_list(const struct lod_list_draft *draft, uint32_t vertices, double growth,
	struct lod_raster *raster)
{
	const struct eco_list *list = &draft->list;
	uint32_t all = list->element_count, count = vertices / eco_list_vertices(list);
	bool points = list->kind == ECO_LIST_POINTS;
	count = count < all ? count : all;
	double scale = points && count ? growth * all / count : 1;
	struct lod_geometry geometry;
	if (!count || !lod_geometry_make(&geometry, list, count, false))
		return;
	lod_list_geometry(list, &draft->elements, 0, count, (float)(scale > 1 ? scale : 1), &geometry);
	struct lod_raster_batch batch = { .count = count, .position = geometry.position,
		.width = geometry.width, .area = list->unit_area * (float)(scale > 1 ? scale : 1),
		.size = geometry.size, .owner = 1 };
	if (points)
		lod_raster_splats(raster, &batch);
	else
		lod_raster_lines(raster, &batch);
	lod_geometry_free(&geometry);
}

static void draw_points(const void *of, struct lod_raster *raster)
{
	const struct points *drawn = of;
	const struct lod_plant *plant = drawn->plant;
	double area = 0;
	for (int organ = 0; organ < ECO_ORGAN_COUNT; organ++)
		area += plant->organ[organ].area;
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *ladder = &plant->ladders[i];
		uint32_t list = ladder->points != ECO_NONE ? ladder->points : ladder->lines;
		if (ladder->anchor || ladder->flags & ECO_LADDER_WHOLE || list == ECO_NONE || !(area > 0))
			continue;
		double share = plant->organ[ladder->organ].area / area;
		draw_list(&plant->lists[list], (uint32_t)(drawn->vertices * share), drawn->growth, raster);
	}
}

/* The growth is chosen by hard Q at the smaller size. */
static enum eco_code score_points(struct bench_splats_pictures *pictures, const char *name,
	struct bench_splats_q q[BUDGETS], struct eco_error *error)
{
	static const double growths[] = { 8, 4, 2, 1, 0.5, 0.25, 0.12, 0.06 };
	struct lod_plant plant;
	enum eco_code code = lod_plant_build(&plant, pictures->model,
		&(struct lod_plant_options){ .name = name, .grid_bits = 12 }, error);
	if (code)
		return code;
	for (uint32_t b = 0; b < BUDGETS; b++) {
		struct points drawn = { &plant, bench_splats_budgets[b], 1 };
		double growth = 1, best = -1;
		for (size_t i = 0; i < sizeof growths / sizeof *growths; i++) {
			drawn.growth = growths[i];
			bench_splats_score(pictures, 0, draw_points, &drawn, &q[b]);
			if (q[b].hard > best) {
				best = q[b].hard;
				growth = growths[i];
			}
		}
		drawn.growth = growth;
		bench_splats_score(pictures, BENCH_SPLATS_SIZES, draw_points, &drawn, &q[b]);
	}
	lod_plant_free(&plant);
	return ECO_OK;
}

/* ---- Impostors ---- */

static void draw_impostor(const void *impostor, struct lod_raster *raster)
{
	lod_raster_impostor(raster, impostor, &(struct lod_raster_batch){ .count = 1, .owner = 1 });
}

/* As its bytes give it back. */
static enum eco_code score_level(struct bench_splats_pictures *pictures, const struct lod_impostors *made,
	uint32_t which, struct bench_splats_q *q, struct eco_error *error)
{
	struct eco_writer w = { 0 };
	struct eco_impostor_level level = { 0 };
	struct eco_impostor_body body;
	struct lod_impostor impostor = { .cell_count = 0 };
	size_t shape;
	enum eco_code code = eco_impostor_level_write(&w, &made->body, &made->levels[which], &shape, error);
	if (!code)
		code = eco_impostor_level_read(&level, &body, w.bytes, w.size, error);
	if (!code)
		code = lod_impostor_open(&impostor, &body, &level, error);
	if (!code)
		bench_splats_score(pictures, BENCH_SPLATS_SIZES, draw_impostor, &impostor, q);
	lod_impostor_close(&impostor);
	eco_impostor_level_free(&level);
	eco_writer_free(&w);
	return code;
}

/* One vertex whatever the budget. */
static enum eco_code score_impostors(struct bench_splats_pictures *pictures, const char *name,
	struct bench_splats_q q[BUDGETS], struct eco_error *error)
{
	struct lod_impostors made = { 0 };
	struct bench_splats_q best = { 0 }, one;
	enum eco_code code = lod_impostors_make(&made, pictures->model,
		&(struct lod_impostors_options){ .levels = 0 }, error);
	if (!code && made.level_count < ECO_IMPOSTOR_LEVELS)
		code = eco_fail(error, ECO_UNSUPPORTED, "%s shows nothing", name);
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS && !code; i++) {
		code = score_level(pictures, &made, i, &one, error);
		best.hard = fmax(best.hard, one.hard);
		best.soft = fmax(best.soft, one.soft);
	}
	for (uint32_t b = 0; b < BUDGETS; b++)
		q[b] = best;
	lod_impostors_free(&made);
	return code;
}

/* ---- A plant ---- */

struct work { struct bench *bench; const struct bench_model *model; };

/* Hard and soft Q of each kind and budget. */
static enum eco_code measure(void *ctx, json_t **rows, struct eco_error *error)
{
	const struct work *w = ctx;
	const char *name = w->model->name;
	struct eco_model model;
	struct bench_splats_pictures pictures;
	struct bench_splats_q q[BENCH_SPLATS_KINDS][BUDGETS] = { { { 0 } } };
	enum eco_code code = bench_model_read(w->bench, w->model, &model, error);
	if (code)
		return code;
	code = bench_splats_open(&pictures, &model, bench_splats_heights_px, error);
	if (!code) {
		code = score_splats(&pictures, name, true, q[BENCH_SPLATS_OPAQUE], error);
		if (!code)
			code = score_splats(&pictures, name, false, q[BENCH_SPLATS_OPACITY], error);
		if (!code)
			code = score_points(&pictures, name, q[BENCH_SPLATS_POINTS], error);
		if (!code)
			code = score_impostors(&pictures, name, q[BENCH_SPLATS_IMPOSTOR], error);
		bench_splats_close(&pictures);
	}
	eco_model_free(&model);
	*rows = json_array();
	for (size_t i = 0; i < BENCH_SPLATS_KINDS * BUDGETS; i++)
		json_array_append_new(*rows, bench_reals((double[]){ q[i / BUDGETS][i % BUDGETS].hard,
			q[i / BUDGETS][i % BUDGETS].soft }, 2));
	return code;
}

enum eco_code bench_splats_of(struct bench *bench, const struct bench_model *model,
	struct bench_splats_q q[BENCH_SPLATS_KINDS][BENCH_SPLATS_BUDGETS], struct eco_error *error)
{
	char name[640];
	json_t *rows;
	snprintf(name, sizeof name, "splats-%s-%s", model->name, model->path);
	const char *before = bench_objects(bench, BENCH_OBJECTS_PLANTS BENCH_OBJECTS_SPLATS);
	enum eco_code code = bench_unit(bench, name, NULL, measure, &(struct work){ bench, model }, &rows, error);
	bench_objects(bench, before);
	for (size_t i = 0; i < BENCH_SPLATS_KINDS * BUDGETS && !code; i++) {
		const json_t *row = json_array_get(rows, i);
		q[i / BUDGETS][i % BUDGETS] = (struct bench_splats_q){ .hard = bench_cell(row, 0),
			.soft = bench_cell(row, 1) };
	}
	return code;
}
