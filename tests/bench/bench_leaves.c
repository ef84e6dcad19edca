#include "tests/bench/bench_leaves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/export/plant_view.h"
#include "ecofiles/format/pack.h"
#include "lod/build/element.h"
#include "lod/sort.h"

/* of the grid that tells which triangles are too small to count (lod/build/weld.h) */
#define GRID_BITS 14u

static void make(struct lod_foliage *foliage, const struct eco_model *model, struct lod_arena *arena)
{
	struct lod_mesh mesh;
	struct lod_organs organs;
	struct lod_elements elements;
	lod_weld(&mesh, model, GRID_BITS, arena);
	lod_elements_turn_diagonals(&mesh, arena);
	lod_organs_find(&organs, &mesh, model, arena);
	lod_elements_make(&elements, &mesh, &organs, arena);
	lod_foliage_from(foliage, &(struct lod_foliage_parts){ model, &mesh, &organs, &elements }, arena);
}

enum eco_code bench_foliage_make(struct lod_foliage *foliage, const struct eco_model *model,
	struct lod_arena *arena, struct eco_error *error)
{
	make(foliage, model, arena);
	return foliage->count ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "the model has no leaves or flowers: all of "
		"its %u triangles are wood", model->triangle_count);
}

struct opening { const struct bench_model *model; bench_leaves_study *study; void *ctx; };

static json_t *make_unit(void *ctx)
{
	const struct opening *o = ctx;
	struct bench_leaves leaves = { .mask = NULL };
	if (o->model)
		bench_model_read(o->model, &leaves.model);
	else
		leaves.model = bench_crown_make();
	must(bench_foliage_make(&leaves.foliage, &leaves.model, &leaves.arena, must_error));
	lod_raster_init(&leaves.cover, &(struct lod_raster_options){ .width = BENCH_PIXELS,
		.height = BENCH_PIXELS, .silhouette = true });
	leaves.mask = lod_arena_take(&leaves.arena, BENCH_PIXELS * BENCH_PIXELS / 64, sizeof *leaves.mask);
	json_t *made = o->study(o->ctx, &leaves);
	lod_raster_free(&leaves.cover);
	lod_arena_free(&leaves.arena);
	eco_model_free(&leaves.model);
	return made;
}

void bench_leaves_unit(struct bench *bench, const char *prefix, const struct bench_model *model,
	bench_leaves_study *study, void *ctx, double *values, uint32_t count)
{
	char name[128], stamp[64];
	snprintf(name, sizeof name, model ? "%s-%s" : "%s", prefix, model ? model->name : "");
	snprintf(stamp, sizeof stamp, "%d %s", bench->full, model ? must_stamp(model->path) : "");
	bench_cells(bench_unit(bench, name, stamp, make_unit, &(struct opening){ model, study, ctx }), values, count);
}

void bench_leaves_sights(struct bench_leaves *leaves, struct lod_sights *sights,
	const double (*directions)[3], uint32_t count)
{
	lod_sights_make(sights, &leaves->foliage, directions, count, BENCH_PIXELS, &leaves->arena);
}

void bench_leaves_look(struct bench_leaves *leaves, struct lod_sights *sights, uint32_t count, uint32_t seed)
{
	double to[BENCH_LOOKS][3];
	lod_directions_spread(to, count, seed);
	bench_leaves_sights(leaves, sights, (const double (*)[3])to, count);
}

uint64_t bench_leaves_vertices(const struct lod_foliage *f, const uint32_t *order, uint32_t count)
{
	uint64_t sum = 0;
	for (uint32_t k = 0; k < count; k++) {
		uint32_t i = order ? order[k] : k;
		sum += 3 * (f->first[i + 1] - f->first[i] - 2);
	}
	return sum;
}

uint32_t *bench_leaves_order(struct bench_leaves *leaves, enum lod_order_method method, double noise)
{
	const struct lod_foliage *f = &leaves->foliage;
	struct lod_arena *arena = &leaves->arena;
	uint32_t *order = lod_arena_take(arena, f->count, sizeof *order);
	struct lod_arena_piece *mark = arena->last;
	double *survival = lod_arena_take(arena, f->count, sizeof *survival);
	struct lod_keyed *items = lod_arena_take(arena, f->count, sizeof *items);
	lod_order_survival_by(survival, method,
		&(struct lod_order_input){ f->count, f->center, f->normal, f->high.z - f->low.z, 1, noise },
		arena);
	for (uint32_t i = 0; i < f->count; i++)
		items[i] = (struct lod_keyed){ ~lod_sort_key(survival[i]), i };
	lod_sort(arena, items, f->count);
	for (uint32_t i = 0; i < f->count; i++)
		order[i] = items[i].value;
	lod_arena_release(arena, mark);
	return order;
}

/* Compares leaves->mask, and `wood` if not NULL. */
static void count_wrong(const struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const uint64_t *wood, struct bench_wrong *sum)
{
	const uint64_t *reference = sights->reference[view];
	for (uint32_t i = 0; i < sights->words; i++) {
		uint64_t shown = leaves->mask[i] | (wood ? wood[i] : 0);
		sum->fp += (uint64_t)__builtin_popcountll(shown & ~reference[i]);
		sum->fn += (uint64_t)__builtin_popcountll(reference[i] & ~shown);
	}
	sum->pixels += sights->reference_pixels[view];
}

void bench_leaves_compare(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing, struct bench_wrong *sum)
{
	memset(leaves->mask, 0, sights->words * sizeof *leaves->mask);
	lod_sights_draw(sights, view, drawing, &leaves->cover, leaves->mask);
	count_wrong(leaves, sights, view, sights->wood[view], sum);
}

void bench_leaves_compare_drawn(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	bench_draw_call *draw, const void *what, struct bench_wrong *sum)
{
	struct lod_raster *raster = &leaves->cover;
	uint32_t side = sights->pixels;
	lod_raster_clear(raster);
	lod_raster_camera(raster, &sights->eyes[view], sights->near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	draw(what, &sights->eyes[view], raster);
	memset(leaves->mask, 0, sights->words * sizeof *leaves->mask);
	for (uint32_t i = 0; i < side * side; i++)
		if (raster->cover[i])
			leaves->mask[i / side * (sights->words / side) + i % side / 64] |= UINT64_C(1) << i % side % 64;
	count_wrong(leaves, sights, view, NULL, sum);
}

void bench_leaves_paint(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing, uint32_t column, uint32_t columns, uint8_t *rgb)
{
	static const uint8_t colors[3][3] = { { 255, 255, 255 }, { 96, 78, 60 }, { 76, 128, 48 } };
	struct bench_wrong wrong = { 0 };
	const uint64_t *shown = drawing ? leaves->mask : sights->reference[view], *wood = sights->wood[view];
	uint32_t side = sights->pixels;
	if (drawing)
		bench_leaves_compare(leaves, sights, view, drawing, &wrong);
	for (size_t i = 0; i < (size_t)side * side; i++) {
		size_t word = i / side * (sights->words / side) + i % side / 64;
		uint64_t bit = UINT64_C(1) << i % side % 64;
		int color = wood[word] & bit ? 1 : shown[word] & bit ? 2 : 0;
		memcpy(rgb + 3 * ((i / side * columns + column) * side + i % side), colors[color], 3);
	}
}

double bench_wrong_share(const struct bench_wrong *wrong)
{
	return wrong->pixels ? (double)(wrong->fp + wrong->fn) / (double)wrong->pixels : 0;
}

double bench_wrong_precision(const struct bench_wrong *wrong)
{
	double right = (double)(wrong->pixels - wrong->fn), shown = right + (double)wrong->fp;
	return shown > 0 ? right / shown : 1;
}

double bench_wrong_recall(const struct bench_wrong *wrong)
{
	return wrong->pixels ? (double)(wrong->pixels - wrong->fn) / (double)wrong->pixels : 1;
}

double bench_wrong_q(const struct bench_wrong *wrong)
{
	double lost_p = 1 - bench_wrong_precision(wrong), lost_r = 1 - bench_wrong_recall(wrong);
	return 1 - sqrt(lost_p * lost_p + lost_r * lost_r);
}

/* ---- A pack ---- */

struct ours { struct plant_view plant; struct plant_view_drawing drawing; };

static void draw_ours(const void *what, const struct lod_eye *eye, struct lod_raster *raster)
{
	const struct ours *ours = what;
	plant_view_raster(raster, &ours->plant, eye, &ours->drawing, false);
}

static double foliage_vertices(const struct plant_view_drawing *drawing)
{
	double sum = 0;
	for (const struct plant_view_batch *b = drawing->batches; b < drawing->batches + drawing->count; b++) {
		bool wood = b->list->organ == ECO_ORGAN_WOOD && !(b->list->list->attributes & ECO_ATTR_SPLAT);
		sum += b->impostor ? 1 : wood ? 0 : (double)b->count * eco_list_vertices(b->list->list);
	}
	return sum;
}

void bench_leaves_ours(struct bench *bench, struct bench_leaves *leaves, const struct bench_model *model,
	const struct lod_sights *sights, const double *vertices, uint32_t count, double *q, double *drawn)
{
	char path[512];
	struct eco_pack *pack;
	struct ours ours;
	bench_model_pack(bench, model, path);
	must(eco_pack_open(&pack, path, must_error));
	must(plant_view_open(&ours.plant, pack, 0, BENCH_PIXELS, must_error));
	for (uint32_t i = 0; i < count; i++) {
		struct bench_wrong sum = { 0 };
		must(plant_view_drawing_make(&ours.drawing, &ours.plant, (uint64_t)vertices[i], must_error));
		for (uint32_t v = 0; v < sights->count; v++)
			bench_leaves_compare_drawn(leaves, sights, v, draw_ours, &ours, &sum);
		q[i] = bench_wrong_q(&sum);
		if (drawn)
			drawn[i] = foliage_vertices(&ours.drawing);
		plant_view_drawing_free(&ours.drawing);
	}
	plant_view_close(&ours.plant);
	eco_pack_close(pack);
}

/* ---- Plants ---- */

const char *must_stamp(const char *path)
{
	static char stamp[32];
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(path));
	return stamp;
}

const struct bench_model *bench_walk(struct bench_walk *w)
{
	if (!w->models)
		w->models = bench_models(w->bench, &w->count);
	while (w->next < w->count) {
		const struct bench_model *model = &w->models[w->next++];
		bool made = model->generated && w->quick_made;
		uint32_t found = w->quick_made ? w->found[made] : w->found[0] + w->found[1];
		if (model->leaves < w->leaves || (w->wants && !w->wants(w->bench, model)))
			continue;
		if (w->bench->full && w->found[0] + w->found[1] >= w->most)
			break;
		if (!w->bench->full && found >= (made ? w->quick_made : w->quick)) {
			bench_left_out(w->bench, model->name);
			continue;
		}
		bench_progress((double)w->next / w->count, model->name);
		return model;
	}
	free(w->models);
	w->models = NULL;
	return NULL;
}
