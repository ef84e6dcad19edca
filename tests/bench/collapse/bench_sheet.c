/* Plants side by side: full detail, then leaf collapse (Hidalgo 2007) and billboard clouds (Kratt 2014), each
 * beside ours at as many vertices. A row of cells is a picture of its own. Wood, leaves and billboards are
 * drawn in plain colours, and triangles of ours by how they face the eye. */
#include <math.h>
#include <string.h>

#include "ecofiles/ecopack/export/plant_view.h"
#include "lod/raster/texel.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/collapse/bench_collapse.h"
#include "tests/bench/pictures/bench_billboards.h"

#define PIXELS 200u
#define BACKGROUND 236
#define GAP 8u
#define LEAVES_LEAST 500u

/* Levels of leaf collapse by their share of the leaves' vertices, clouds by their cap. */
static const struct { const char *title; double share; uint32_t cap; } columns[] = {
	{ "leaf collapse 1/4", 1 / 4.0, 0 }, { "leaf collapse 1/16", 1 / 16.0, 0 },
	{ "leaf collapse 1/64", 1 / 64.0, 0 }, { "166 billboards", 0, 166 }, { "33 billboards", 0, 33 } };
#define COLUMNS (sizeof columns / sizeof *columns)
#define CELLS (2 * COLUMNS)      /* theirs, ours */
#define WIDTH (GAP + (1 + (uint32_t)CELLS) * (PIXELS + GAP))

struct cell { double vertices, q; };
struct row {
	struct bench *bench;
	const char *name, *pack;
	struct plant_view plant;
	struct bench_leaves *leaves;
	struct lod_sights sights;    /* one, the plant's */
	struct lod_raster ids;
	struct bench_collapse levels;
	double all;                  /* vertices of leaves */
	struct lod_billboard_plant *skeleton;
	uint8_t *rgb;
	struct cell cells[CELLS];
};

/* ---- Cells ---- */

/* A pixel of a cell: 0 is full detail. */
static uint8_t *pixel_of(const struct row *r, uint32_t cell, size_t i)
{
	return r->rgb + 3 * (i / PIXELS * WIDTH + GAP + cell * (PIXELS + GAP) + i % PIXELS);
}

/* Colour of a primitive: its own, its texture's in the middle, or the organ's; by how a triangle faces the
 * eye. */
static void color_of(const struct plant_view *view, const struct plant_view_batch *b, uint32_t i,
	uint8_t rgb[3])
{
	static const uint8_t plain[ECO_ORGAN_COUNT][3] = { { 120, 96, 72 }, { 95, 127, 79 }, { 220, 190,
		200 } };
	const float *uv = b->geometry.uv + 6 * (size_t)i, *p = b->geometry.position + 9 * (size_t)i;
	double light = 1;
	memcpy(rgb, plain[b->list->organ], 3);
	if (b->impostor)
		memcpy(rgb, b->impostor->rgb[i], 3);
	else if (b->geometry.color[i] >= 0 && (uint32_t)b->geometry.color[i] < b->list->list->palette_count)
		memcpy(rgb, b->list->palette[b->geometry.color[i]], 3);
	else if (b->geometry.uv)
		memcpy(rgb, lod_texel_at(&view->lists[b->list->image].picture, (uv[0] + uv[2] + uv[4]) / 3,
			(uv[1] + uv[3] + uv[5]) / 3), 3);
	if (b->list->list->kind == ECO_LIST_TRIANGLES) {
		const double *to = view->eye.forward;
		struct lod_v3 n = lod_v3_unit(lod_v3_cross(lod_v3_sub(lod_v3_of(p + 3), lod_v3_of(p)),
			lod_v3_sub(lod_v3_of(p + 6), lod_v3_of(p))));
		light = 0.6 + 0.4 * fabs(n.x * to[0] + n.y * to[1] + n.z * to[2]);
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(light * rgb[k]);
}

static void draw_ours(struct row *r, uint32_t place, uint64_t vertices, struct cell *cell)
{
	struct lod_raster *ids = &r->ids;
	struct plant_view_drawing drawing;
	must(plant_view_drawing_make(&drawing, &r->plant, vertices, must_error));
	*cell = (struct cell){ (double)drawing.vertices, plant_view_q(&r->plant, &drawing) };
	plant_view_raster(ids, &r->plant, &r->plant.eye, &drawing, true);
	for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++) {
		uint32_t primitive = (uint32_t)ids->owner[i] - 1, n = 0;
		if (!ids->owner[i])
			continue;
		while (n + 1 < drawing.count && drawing.batches[n + 1].first <= primitive)
			n++;
		const struct plant_view_batch *batch = &drawing.batches[n];
		color_of(&r->plant, batch, primitive - batch->first + (batch->impostor ? ids->item[i] : 0),
			pixel_of(r, place, i));
	}
	plant_view_drawing_free(&drawing);
}

static double score(const struct row *r, const uint8_t *cover)
{
	struct lod_score score;
	lod_score(&score, &(struct lod_score_input){ .width = PIXELS, .height = PIXELS, .cover = cover,
		.reference = r->plant.reference });
	return score.q;
}

static void aim(const struct row *r, struct lod_raster *raster)
{
	lod_raster_clear(raster);
	lod_raster_camera(raster, &r->plant.eye, r->plant.scene.near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
}

/* Wood lies over leaves. */
static struct cell draw_level(struct row *r, double share, uint32_t place)
{
	static const uint8_t colors[2][3] = { { 76, 128, 48 }, { 96, 78, 60 } };
	struct bench_leaves *leaves = r->leaves;
	struct lod_sights_drawing drawing = { .scale = 1 };
	uint32_t *order = lod_arena_take(&leaves->arena, leaves->foliage.count, sizeof *order);
	uint64_t vertices = bench_collapse_level(&r->levels, 0, share * r->all, order, &drawing.count);
	drawing.order = order;
	memset(leaves->mask, 0, r->sights.words * sizeof *leaves->mask);
	lod_sights_draw(&r->sights, 0, &drawing, &leaves->cover, leaves->mask);
	aim(r, &r->ids);
	lod_raster_triangles(&r->ids, &(struct lod_raster_batch){ .position = leaves->foliage.wood,
		.count = (uint32_t)leaves->foliage.wood_count, .owner = 1 });
	for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++) {
		uint64_t word = leaves->mask[i / PIXELS * (r->sights.words / PIXELS) + i % PIXELS / 64];
		bool wood = r->ids.cover[i];
		if (wood || word >> i % PIXELS % 64 & 1)
			memcpy(pixel_of(r, place, i), colors[wood], 3);
		r->ids.cover[i] |= word >> i % PIXELS % 64 & 1;
	}
	return (struct cell){ (double)(vertices + 3 * leaves->foliage.wood_count), score(r, r->ids.cover) };
}

static struct cell draw_cloud(struct row *r, uint32_t cap, uint32_t place)
{
	struct lod_raster *raster = &r->ids;
	struct lod_billboard_cloud cloud;
	lod_billboard_cloud_make(&cloud, r->skeleton, cap, &r->leaves->arena);
	aim(r, raster);
	lod_billboard_cloud_draw(&cloud, 1, raster);
	for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++)
		if (raster->cover[i])
			bench_billboards_color(&cloud.items[raster->item[i]].image, pixel_of(r, place, i));
	return (struct cell){ 6.0 * cloud.count, score(r, raster->cover) };
}

/* ---- A row ---- */

static void draw_row(struct row *r)
{
	static const double any[1][3] = { { 1, 0, 0 } };
	struct cell full;
	char file[96];
	struct lod_arena *arena = &r->leaves->arena;
	struct lod_foliage *f = &r->leaves->foliage;
	bench_leaves_sights(r->leaves, &r->sights, any, 1);
	/* leaves are drawn from the eye that draws ours, without the wood that the other eye saw */
	memset(r->sights.wood[0], 0, r->sights.words * sizeof **r->sights.wood);
	r->sights.eyes[0] = r->plant.eye;
	r->sights.near_m = r->plant.scene.near_m;
	r->all = (double)bench_leaves_vertices(f, NULL, f->count);
	r->rgb = lod_arena_take(arena, (size_t)WIDTH * PIXELS, 3);
	memset(r->rgb, BACKGROUND, 3 * (size_t)WIDTH * PIXELS);
	lod_raster_init(&r->ids, &(struct lod_raster_options){ .width = PIXELS, .height = PIXELS,
		.owner = true, .item = true });
	draw_ours(r, 0, ECO_VERTICES_MAX, &full);
	bench_collapse_grow(&r->levels, 1, false, f, arena);
	r->skeleton = lod_billboard_plant_make(&r->leaves->model, arena);
	for (uint32_t i = 0; i < COLUMNS; i++) {
		struct cell *theirs = &r->cells[2 * i];
		*theirs = columns[i].cap ? draw_cloud(r, columns[i].cap, 1 + 2 * i)
			: draw_level(r, columns[i].share, 1 + 2 * i);
		draw_ours(r, 2 + 2 * i, (uint64_t)theirs->vertices, theirs + 1);
	}
	lod_raster_free(&r->ids);
	snprintf(file, sizeof file, "sheet-%s.png", r->name);
	bench_picture_write(r->bench, file, WIDTH, PIXELS, r->rgb);
}

/* The unit: vertices and Q of each cell. */
static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct row *r = ctx;
	struct eco_pack *pack;
	must(eco_pack_open(&pack, r->pack, must_error));
	r->leaves = leaves;
	must(plant_view_open(&r->plant, pack, 0, PIXELS, must_error));
	draw_row(r);
	plant_view_close(&r->plant);
	eco_pack_close(pack);
	return bench_reals(&r->cells[0].vertices, 2 * CELLS);
}

/* ---- The section ---- */

static void write_row(struct bench *bench, struct bench_table *table, const struct bench_model *model)
{
	char path[512], file[96];
	struct row r = { .bench = bench, .name = model->name, .pack = path };
	bench_model_pack(bench, model, path);
	const json_t *kept = bench_leaves_unit(bench, "sheet", must_stamp(path), model, PIXELS, study_leaves,
		&r);
	for (size_t i = 0; i < COLUMNS; i++)
		bench_table_row(table, "%s,%s,%.0f,%.3f,%.0f,%.3f", model->name, columns[i].title,
			bench_cell(kept, 4 * i), bench_cell(kept, 4 * i + 1), bench_cell(kept, 4 * i + 2),
			bench_cell(kept, 4 * i + 3));
	snprintf(file, sizeof file, "sheet-%s.png", model->name);
	bench_picture(bench, file, "full detail; leaf collapse and billboard clouds, each beside ours at as "
		"many vertices");
}

static bool is_wanted(const struct bench *bench, const struct bench_model *model)
{
	return !model->generated || !bench->data;
}

static void run(struct bench *bench)
{
	struct bench_walk walk = { .bench = bench, .leaves = LEAVES_LEAST, .most = 8, .quick = 2, .wants
		= is_wanted };
	struct bench_table *table = bench_table_open(bench, "sheet",
		"plant,column,vertices,Q,vertices of ours,Q of ours", true);
	for (const struct bench_model *model; (model = bench_walk(&walk));) {
		write_row(bench, table, model);
		walk.found[model->generated]++;
	}
	bench_table_close(table);
	bench_say(bench, "The %u plants with the fewest leaves (%u or more), one view, %u pixels. Wood is "
		"whole under leaf collapse and counts; ours may draw as much. Billboards stand in their "
		"mean colours. Packs hold neither, as neither is best anywhere (lod/EXPERIMENTS.md, Leaf "
		"collapse, Billboard clouds).",
		walk.found[0] + walk.found[1], LEAVES_LEAST, PIXELS);
}

const struct bench_section bench_sheet = { "sheet", "Leaf collapse and billboard clouds beside ours", run };
