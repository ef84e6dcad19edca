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
	if (!code)
		code = lod_raster_init(&leaves->ids,
			&(struct lod_raster_options){ .width = pixels, .height = pixels, .owner = true,
			.item = true }, error);
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
	lod_raster_free(&leaves->ids);
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

/* ---- Whose pixels ---- */

/* The item of a leaf's first triangle: its light in the upper bits, so that the others' have it, too. */
static uint32_t lit_item(double light) { return (uint32_t)(255 * light) << 8; }

void bench_leaves_color(const struct bench_leaves *leaves, size_t pixel, uint8_t rgb[3])
{
	double light = leaves->ids.item[pixel] >> 8;
	const uint8_t wood[3] = { 96, 78, 60 }, green[3] = { (uint8_t)(40 + 70 * light / 255),
		(uint8_t)(70 + 100 * light / 255), (uint8_t)(25 + 45 * light / 255) };
	memset(rgb, 0, 3);
	if (leaves->ids.cover[pixel])
		memcpy(rgb, leaves->ids.owner[pixel] == BENCH_WOOD ? wood : green, 3);
}

static void draw_leaf(struct bench_leaves *leaves, const struct lod_eye *eye, uint32_t i, float scale)
{
	const struct lod_foliage *f = &leaves->foliage;
	uint32_t corners = f->first[i + 1] - f->first[i], count = corners - 2;
	float position[9 * (ECO_CORNERS_MAX - 2)], uv[6 * (ECO_CORNERS_MAX - 2)], root = sqrtf(scale);
	const float center[3] = { (float)f->center[i].x, (float)f->center[i].y, (float)f->center[i].z };
	struct lod_v3 n = lod_v3_unit(f->normal[i]);
	double light = fabs(n.x * eye->forward[0] + n.y * eye->forward[1] + n.z * eye->forward[2]);
	for (uint32_t t = 0; t < count; t++) {
		const uint32_t corner[3] = { 0, t + 1, t + 2 };
		for (int k = 0; k < 3; k++) {
			const float *p = f->corner[f->first[i] + corner[k]];
			for (int a = 0; a < 3; a++)
				position[9 * t + 3 * k + a] = scale == 1 ? p[a]
					: center[a] + root * (p[a] - center[a]);
			memcpy(uv + 6 * t + 2 * k, f->uv[f->first[i] + corner[k]], 2 * sizeof *uv);
		}
	}
	lod_raster_triangles(&leaves->ids,
		&(struct lod_raster_batch){ .count = count, .position = position, .uv = uv,
		.cutout = f->cutout[i],
		.item = lit_item(light), .owner = i + 1 });
}

void bench_leaves_ids(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing)
{
	const struct lod_foliage *f = &leaves->foliage;
	const struct lod_eye *eye = &sights->eyes[view];
	const struct lod_place place = { .cosine = 1, .scale = 1 };
	lod_raster_clear(&leaves->ids);
	lod_raster_camera(&leaves->ids, eye, sights->near_m);
	lod_raster_object(&leaves->ids, &place);
	if (f->wood_count)
		lod_raster_triangles(&leaves->ids,
			&(struct lod_raster_batch){ .count = (uint32_t)f->wood_count, .position = f->wood,
			.owner = BENCH_WOOD });
	uint32_t count = drawing ? drawing->count : f->count;
	for (uint32_t k = 0; k < count; k++) {
		uint32_t i = drawing ? drawing->order[k] : k;
		float scale = !drawing ? 1 : drawing->factor ? drawing->factor[i] : drawing->scale;
		draw_leaf(leaves, eye, i, scale);
	}
}
