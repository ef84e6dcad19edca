#include "tests/bench/lee/bench_lee_layers.h"

#include <stdlib.h>
#include <string.h>

#include "tests/bench/baseline/lee.h"
#include "tests/bench/lee/bench_crown.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/lee/bench_lee_study.h"

#define PIXELS 256u
#define VIEWS 12u
#define SEED 3119u
#define SHOWN 1u                 /* the view of the picture */
#define COLUMNS 7u               /* all; three methods at 50 %; at 30 % */

static const uint32_t layers[] = { 1, 2, 3, 5, 8, 12, 20, 40 };
#define LAYERS (sizeof layers / sizeof *layers)

struct layers {
	struct bench_leaves leaves;
	struct lod_sights sights;
	struct lod_lee_group *groups;
	uint32_t *kept, *chosen;
};

static enum eco_code prepare(struct layers *l, struct eco_error *error)
{
	double to[VIEWS][3];
	struct lod_arena *arena = &l->leaves.arena;
	const struct lod_foliage *f = &l->leaves.foliage;
	lod_directions_spread(to, VIEWS, SEED);
	enum eco_code code =
		lod_sights_make(&l->sights, f, (const double (*)[3])to, VIEWS, PIXELS, arena, error);
	if (code)
		return code;
	l->groups = lod_arena_take(arena, f->count, sizeof *l->groups);
	l->kept = lod_arena_take(arena, f->count, sizeof *l->kept);
	l->chosen = lod_arena_take(arena, f->count, sizeof *l->chosen);
	for (uint32_t i = 0; i < f->count; i++)
		lod_lee_group_make(&l->groups[i], f->center, f->normal, &i, 1);
	return ECO_OK;
}

static struct lod_sights_drawing choose(struct layers *l, enum lod_lee_method method, uint32_t layer_count,
	uint32_t percent, uint32_t view)
{
	const struct lod_eye *eye = &l->sights.eyes[view];
	const struct lod_lee_view from = { { eye->at[0], eye->at[1], eye->at[2] },
		{ eye->forward[0], eye->forward[1], eye->forward[2] }, layer_count };
	uint32_t n = l->leaves.foliage.count, count = 0;
	lod_lee_keep(l->kept, method, l->groups, n, &from, (uint64_t)n * percent / 100, &l->leaves.arena);
	for (uint32_t i = 0; i < n; i++)
		if (l->kept[i])
			l->chosen[count++] = i;
	return (struct lod_sights_drawing){ .order = l->chosen, .count = count, .scale = 1 };
}

/* [wrong over the reference's pixels, over all of the picture] for each share */
static json_t *measure(struct layers *l, enum lod_lee_method method, uint32_t layer_count)
{
	json_t *row = json_array();
	for (uint32_t s = 0; s < LEE_SHARES; s++) {
		struct bench_wrong sum = { 0 };
		for (uint32_t v = 0; v < VIEWS; v++) {
			const struct lod_sights_drawing drawing =
				choose(l, method, layer_count, bench_lee_percent[s], v);
			bench_leaves_compare(&l->leaves, &l->sights, v, &drawing, &sum);
		}
		json_array_append_new(row, json_pack("[ff]", bench_wrong_share(&sum),
			(double)(sum.fp + sum.fn) / ((double)VIEWS * PIXELS * PIXELS)));
	}
	return row;
}

/* ---- Figure 2 ---- */

static void draw_into(struct layers *l, const struct lod_sights_drawing *drawing, uint32_t column,
	uint8_t *rgb)
{
	bench_leaves_ids(&l->leaves, &l->sights, SHOWN, drawing);
	for (uint32_t y = 0; y < PIXELS; y++)
		for (uint32_t x = 0; x < PIXELS; x++) {
			size_t pixel = (size_t)y * PIXELS + x;
			uint8_t *at = rgb + 3 * ((size_t)y * COLUMNS * PIXELS + column * PIXELS + x);
			memset(at, 255, 3);
			if (l->leaves.ids.cover[pixel])
				bench_leaves_color(&l->leaves, pixel, at);
		}
}

static enum eco_code draw_figure(struct bench *bench, struct layers *l, struct eco_error *error)
{
	static const uint32_t percents[2] = { 50, 30 };
	uint8_t *rgb = malloc((size_t)COLUMNS * PIXELS * PIXELS * 3);
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	draw_into(l, NULL, 0, rgb);
	for (uint32_t i = 0; i < COLUMNS - 1; i++) {
		enum lod_lee_method method = (enum lod_lee_method)(i % LOD_LEE_COUNT);
		const struct lod_sights_drawing drawing =
			choose(l, method, 0, percents[i / LOD_LEE_COUNT], SHOWN);
		draw_into(l, &drawing, i + 1, rgb);
	}
	enum eco_code code =
		bench_picture_write(bench, "lee-figure-2.png", COLUMNS * PIXELS, PIXELS, rgb, error);
	free(rgb);
	return code;
}

/* ---- The unit ---- */

static enum eco_code study(struct bench *bench, struct layers *l, json_t **unit, struct eco_error *error)
{
	json_t *rows = json_array();
	enum eco_code code = draw_figure(bench, l, error);
	for (int m = LOD_LEE_DISTANCE; m < LOD_LEE_LAYER && !code; m++)
		json_array_append_new(rows, measure(l, (enum lod_lee_method)m, 0));
	for (size_t g = 0; g < LAYERS && !code; g++)
		json_array_append_new(rows, measure(l, LOD_LEE_LAYER, layers[g]));
	if (code)
		json_decref(rows);
	else
		*unit = bench_keep(bench, "lee-layers", NULL, rows);
	return code;
}

static double number(const json_t *rows, size_t row, size_t share, size_t column)
{
	const json_t *pair = json_array_get(json_array_get(rows, row), share);
	return 100 * json_number_value(json_array_get(pair, column));
}

static void write_row(struct bench_table *table, const char *method, const char *count, const json_t *rows,
	size_t row)
{
	bench_table_row(table, "%s,%s,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f", method, count,
		number(rows, row, 0, 0), number(rows, row, 1, 0), number(rows, row, 2, 0),
		number(rows, row, 3, 0), number(rows, row, 0, 1), number(rows, row, 1, 1),
		number(rows, row, 2, 1), number(rows, row, 3, 1));
}

static void write_table(struct bench *bench, const json_t *rows)
{
	bench_head(bench, "Layers, and shares of what");
	struct bench_table *table = bench_table_open(bench, "lee_layers",
		"method,G,80 %,50 %,30 %,10 %,of the picture: 80 %,50 % of it,30 % of it,10 % of it", true);
	bench_table_row(table, "%s", "distance (printed),-,3.03,9.09,14.03,18.42,-,-,-,-");
	bench_table_row(table, "%s", "normal (printed),-,5.31,12.87,16.49,19.13,-,-,-,-");
	bench_table_row(table, "%s", "layer+normal (printed),not said,2.86,10.06,15.07,18.75,-,-,-,-");
	write_row(table, "distance", "-", rows, 0);
	write_row(table, "normal", "-", rows, 1);
	for (size_t g = 0; g < LAYERS; g++) {
		char count[16];
		snprintf(count, sizeof count, "%u", layers[g]);
		write_row(table, "layer+normal", count, rows, 2 + g);
	}
	bench_table_close(table);
	bench_picture(bench, "lee-figure-2.png", "All leaves; distance, normal and layer+normal with 50 % "
		"of the leaves; the same with 30 %");
	bench_say(bench, "Leaves as they are, %u views of %u pixels. Printed figures stay below 20 %% where "
		"a tenth of the leaves is left: no share of the reference's pixels, whose greater part is "
		"missing then, but about the share of a picture that the tree does not fill.", VIEWS, PIXELS);
}

static enum eco_code make(struct bench *bench, json_t **rows, struct eco_error *error)
{
	struct layers l = { 0 };
	struct eco_model model = { 0 };
	volatile enum eco_code code;
	bench_progress(bench, 0, "layers");
	code = bench_crown_make(&model, error);
	code = code ? code : bench_leaves_open(&l.leaves, &model, PIXELS, error);
	if (code)
		return code;
	if (setjmp(l.leaves.arena.failed)) {
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for a crown");
	} else {
		code = prepare(&l, error);
		code = code ? code : study(bench, &l, rows, error);
	}
	bench_leaves_close(&l.leaves);
	return code;
}

enum eco_code bench_lee_layers(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	json_t *rows = bench_recall(bench, "lee-layers", NULL);
	if (!rows)
		code = make(bench, &rows, error);
	if (!code)
		write_table(bench, rows);
	return code;
}
