#include "tests/bench/bench_leaves.h"

#include <stdlib.h>
#include <string.h>

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
	jmp_buf callers;
	volatile enum eco_code code = ECO_OK;
	memcpy(&callers, &arena->failed, sizeof callers);
	if (setjmp(arena->failed))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for the leaves of a model of %u triangles",
			model->triangle_count);
	else
		make(foliage, model, arena);
	memcpy(&arena->failed, &callers, sizeof callers);
	if (!code && foliage->count == 0)
		code = eco_fail(error, ECO_BAD_INPUT, "the model has no leaves or flowers: all of its %u "
			"triangles are wood", model->triangle_count);
	return code;
}

enum eco_code bench_leaves_open(struct bench_leaves *leaves, struct eco_model *model, uint32_t pixels,
	struct eco_error *error)
{
	memset(leaves, 0, sizeof *leaves);
	leaves->model = *model;
	leaves->pixels = pixels;
	memset(model, 0, sizeof *model);
	enum eco_code code = bench_foliage_make(&leaves->foliage, &leaves->model, &leaves->arena, error);
	if (!code)
		code = lod_raster_init(&leaves->cover,
			&(struct lod_raster_options){ .width = pixels, .height = pixels, .silhouette = true },
			error);
	if (!code && !(leaves->mask = calloc((size_t)pixels * (pixels + 63) / 64 + 1, sizeof *leaves->mask)))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for a mask of %u x %u pixels", pixels,
			pixels);
	if (code)
		bench_leaves_close(leaves);
	return code;
}

void bench_leaves_close(struct bench_leaves *leaves)
{
	lod_raster_free(&leaves->cover);
	lod_arena_free(&leaves->arena);
	eco_model_free(&leaves->model);
	free(leaves->mask);
	memset(leaves, 0, sizeof *leaves);
}

struct opening { struct bench *bench; const struct bench_leaves_unit *unit; };

static enum eco_code make_unit(void *ctx, json_t **made, struct eco_error *error)
{
	const struct opening *o = ctx;
	const struct bench_leaves_unit *unit = o->unit;
	struct bench_leaves leaves;
	struct eco_model model;
	enum eco_code code = unit->make ? unit->make(&model, error)
		: bench_model_read(o->bench, unit->model, &model, error);
	code = code ? code : bench_leaves_open(&leaves, &model, unit->pixels, error);
	if (code)
		return code;
	code = setjmp(leaves.arena.failed) ? eco_fail(error, ECO_NO_MEMORY, "no memory for %s", unit->name)
		: unit->study(unit->ctx, &leaves, made, error);
	bench_leaves_close(&leaves);
	return code ? code : bench_go_on(o->bench, error);
}

enum eco_code bench_leaves_unit(struct bench *bench, const struct bench_leaves_unit *unit, json_t **out,
	struct eco_error *error)
{
	return bench_unit(bench, unit->name, unit->stamp, make_unit, &(struct opening){ bench, unit }, out,
		error);
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

void bench_leaves_compare(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing, struct bench_wrong *sum)
{
	const uint64_t *reference = sights->reference[view], *wood = sights->wood[view];
	memset(leaves->mask, 0, sights->words * sizeof *leaves->mask);
	lod_sights_draw(sights, view, drawing, &leaves->cover, leaves->mask);
	for (uint32_t i = 0; i < sights->words; i++) {
		uint64_t shown = leaves->mask[i] | wood[i];
		sum->fp += (uint64_t)__builtin_popcountll(shown & ~reference[i]);
		sum->fn += (uint64_t)__builtin_popcountll(reference[i] & ~shown);
	}
	sum->pixels += sights->reference_pixels[view];
}

void bench_leaves_compare_drawn(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	bool wood, bench_draw_call *draw, const void *what, struct bench_wrong *sum)
{
	struct lod_raster *raster = &leaves->cover;
	lod_raster_clear(raster);
	lod_raster_camera(raster, &sights->eyes[view], sights->near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	draw(what, raster);
	for (uint32_t i = 0; i < sights->pixels * sights->pixels; i++) {
		uint32_t word = i / sights->pixels * (sights->words / sights->pixels) + i % sights->pixels / 64;
		uint64_t bit = UINT64_C(1) << i % sights->pixels % 64;
		bool shown = raster->cover[i] || (wood && sights->wood[view][word] & bit),
			wanted = sights->reference[view][word] & bit;
		sum->fp += shown && !wanted;
		sum->fn += wanted && !shown;
	}
	sum->pixels += sights->reference_pixels[view];
}

double bench_wrong_share(const struct bench_wrong *wrong)
{
	return wrong->pixels ? (double)(wrong->fp + wrong->fn) / (double)wrong->pixels : 0;
}

double bench_wrong_q(const struct bench_wrong *wrong)
{
	double right = (double)(wrong->pixels - wrong->fn), shown = right + (double)wrong->fp;
	double lost_p = shown > 0 ? (double)wrong->fp / shown : 0, lost_r = wrong->pixels
		? (double)wrong->fn / (double)wrong->pixels : 0;
	return 1 - sqrt(lost_p * lost_p + lost_r * lost_r);
}
