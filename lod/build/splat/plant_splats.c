
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/build/grid.h"
#include "lod/build/impostor/impostor_make.h"
#include "lod/build/model_draw.h"
#include "lod/build/organ/organ.h"
#include "lod/build/palette.h"
#include "lod/build/splat/splat_fit.h"
#include "lod/light.h"
#include "lod/tint.h"

#define FIRST_CHUNK 16u          /* splats: the levels up to here are one chunk */
/* A beginning of a level takes the places of the first of its parents, and plants draw it alone: so a level
 * is cut into up to LEVEL_CHUNKS chunks of at least LEAST_CHUNK splats. */
#define LEVEL_CHUNKS 16u
#define LEAST_CHUNK 48u
#define LEVELS_DRAFT 8u
#define COLORS 16u               /* more would be no better to see: lod/EXPERIMENTS.md, Splats, Colours */

static struct eco_list list_of(const struct lod_splats *splats, uint32_t count)
{
	struct eco_list list = { .kind = ECO_LIST_POINTS, .coder = ECO_CODER_ROWS,
		.attributes = ECO_ATTR_COLOR | ECO_ATTR_SPLAT, .image = ECO_NONE,
		.partner = ECO_NONE, .unit_area = splats->unit * splats->unit,
		.element_count = count, .primitive_count = count };
	for (int k = 0; k < 3; k++) {
		list.grid_origin[k] = splats->origin[k];
		list.grid_step[k] = splats->step;
	}
	return list;
}

/* Chunks from the last end to that of a level. */
static void add_ends(struct lod_list_draft *draft, uint32_t end)
{
	uint32_t first = draft->end_count ? draft->ends[draft->end_count - 1] : 0, count = end - first,
		chunks = first ? count / LEAST_CHUNK : 1;
	chunks = chunks < 1 ? 1 : chunks > LEVEL_CHUNKS ? LEVEL_CHUNKS : chunks;
	for (uint32_t i = 1; i <= chunks; i++)
		draft->ends[draft->end_count++] = first + (uint32_t)((uint64_t)count * i / chunks);
}

static void put_elements(struct lod_list_draft *draft, const struct lod_splats *splats)
{
	struct eco_elements *e = &draft->elements;
	uint32_t count = draft->list.element_count;
	e->element_count = e->corner_count = e->primitive_count = count;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_splat *splat = &splats->items[i];
		int32_t *extra = e->extra + (size_t)e->extra_count * i;
		e->corners[i] = 1;
		memcpy(e->position + 3 * (size_t)i, splat->at, sizeof splat->at);
		memcpy(extra + 1, splat->code, sizeof splat->code);
	}
	for (uint32_t level = 0; level < splats->level_count; level++)
		if (splats->level_end[level] > FIRST_CHUNK || level + 1 == splats->level_count
				|| splats->level_end[level + 1] > FIRST_CHUNK)
			add_ends(draft, splats->level_end[level]);
}

/* ---- Colours ---- */

static bool has_colorless(const struct eco_model *model)
{
	bool any = false;
	for (uint32_t i = 0; i < model->material_count; i++)
		any = any || model->materials[i].colourless;
	return any;
}

/* The model's triangles, in its order. rgb: the usual colours of their organs where the file says none; NULL if it
 * says all. leaf: components, but ECO_NONE of wood. level: how level leaves lie (eco_level_code); 0: there are none. */
struct triangles { uint8_t *organ, (*rgb)[3]; uint32_t *leaf; uint8_t level; struct lod_light wood; };

static void color_triangles(struct triangles *triangles, const struct eco_model *model, const struct lod_mesh *mesh,
	const struct lod_organs *organs, struct lod_arena *arena)
{
	triangles->rgb = lod_arena_take(arena, model->triangle_count, sizeof *triangles->rgb);
	for (uint32_t t = 0; t < model->triangle_count; t++)
		memcpy(triangles->rgb[t], lod_mesh_material(model, model->material[t])->rgb, sizeof *triangles->rgb);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		memcpy(triangles->rgb[mesh->source[t]], organs->rgb[t], sizeof *triangles->rgb);
}

static uint8_t level_of(const struct lod_mesh *mesh, const struct lod_organs *organs)
{
	double square = 0, area = 0;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		struct lod_v3 n = lod_mesh_area_normal(mesh, t);
		double length = lod_v3_length(n);
		if (organs->components[mesh->component[t]].organ == ECO_ORGAN_WOOD || !(length > 0))
			continue;
		square += n.z * n.z / length;
		area += length;
	}
	return area > 0 ? eco_level_code(square / area) : 0;
}

static struct triangles read_organs(const struct eco_model *model, struct lod_arena *arena)
{
	struct triangles triangles = { lod_arena_take(arena, model->triangle_count, 1), NULL,
		lod_arena_take(arena, model->triangle_count, sizeof *triangles.leaf), .level = 0 };
	struct lod_mesh mesh;
	struct lod_organs organs;
	lod_weld(&mesh, model, lod_grid_bits_least(model), arena);
	lod_organs_find(&organs, &mesh, model, arena);
	memset(triangles.leaf, 0xff, model->triangle_count * sizeof *triangles.leaf);
	for (uint32_t t = 0; t < mesh.triangle_count; t++) {
		uint8_t organ = triangles.organ[mesh.source[t]] = organs.components[mesh.component[t]].organ;
		triangles.leaf[mesh.source[t]] = organ == ECO_ORGAN_WOOD ? ECO_NONE : mesh.component[t];
		if (organ == ECO_ORGAN_WOOD)
			lod_light_add(&triangles.wood, organs.rgb[t],
				lod_v3_length(lod_mesh_area_normal(&mesh, t)));
	}
	if (has_colorless(model))
		color_triangles(&triangles, model, &mesh, &organs, arena);
	triangles.level = level_of(&mesh, &organs);
	return triangles;
}

/* The share of a splat in the plant's picture, in 2^-20 of its radius squared: the mean area of its three
 * sections, times opacity. */
static uint32_t shown(const struct lod_splat *splat, double radius)
{
	double length[3], sum = 0;
	for (int k = 0; k < 3; k++) {
		const float *half = splat->shape.half[k];
		length[k] = sqrt((double)half[0] * (double)half[0] + (double)half[1] * (double)half[1]
			+ (double)half[2] * (double)half[2]) / radius;
	}
	for (int k = 0; k < 3; k++)
		sum += length[k] * length[(k + 1) % 3] / 3;
	sum *= (double)splat->shape.opacity * (1 << 20);
	return sum < 1u << 24 ? (uint32_t)sum : 1u << 24;
}

static void append_colors(struct lod_plant *plant, const uint8_t (*rgb)[3], uint32_t count)
{
	plant->palette = eco_realloc(plant->palette, plant->palette_count + count, sizeof *plant->palette);
	memcpy(plant->palette + plant->palette_count, rgb, count * sizeof *plant->palette);
	plant->palette_count += count;
}

#define COLOR_NOISE 1e-5         /* variance of light that says nothing of wood */

static int32_t wood_byte(double value) { return (int32_t)floor(fmin(fmax(value, INT8_MIN), INT8_MAX) + 0.5); }

/* The share of wood in a colour (lod/tint.h): least squares of what splats show. color: in the palette. */
static uint32_t wood_code(const struct lod_splats *splats, uint32_t count, const uint32_t *weights,
	const struct lod_palette *palette, const int32_t *color, uint32_t stride)
{
	double mean[4] = { 0 }, all = 0, m[3][4] = { { 0 } }, of[3];
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t i = 0; i < count; i++) {
			double own[4] = { [3] = (double)splats->items[i].wood };
			for (int k = 0; k < 3; k++)
				own[k] = (double)lod_tint_light(palette->rgb[color[(size_t)stride * i]][k]);
			all += pass ? 0 : weights[i];
			for (int k = 0; k < 4; k++)
				mean[k] += pass ? 0 : weights[i] * own[k];
			for (int k = 0; k < 12 && pass; k++)
				m[k / 4][k % 4] += weights[i] * (own[k / 4] - mean[k / 4] / all)
					* (own[k % 4] - mean[k % 4] / all);
		}
	if (!(mean[3] > 0))
		return 0;
	for (int k = 0; k < 3; k++) {
		m[k][k] += COLOR_NOISE * all;
		for (int j = 0; j < k; j++)
			for (int c = 3; c > j; c--)
				m[k][c] -= m[j][c] * m[k][j] / m[j][j];
	}
	uint32_t code = 0;
	double constant = mean[3] / all;
	for (int k = 2; k >= 0; k--) {
		for (int j = k + 1; j < 3; j++)
			m[k][3] -= m[k][j] * of[j];
		of[k] = m[k][3] / m[k][k];
		int32_t byte = wood_byte(of[k] * LOD_TINT_FACTOR);
		code |= (uint32_t)(uint8_t)byte << 8 * k;
		constant -= byte / LOD_TINT_FACTOR * mean[k] / all;
	}
	return code | (uint32_t)wood_byte(constant * LOD_TINT_CONSTANT) << 24;
}

/* A splat mixes leaves, wood and flowers, so its colour may be far from every colour of the plant: splats
 * have a palette of their own. */
static void color_elements(struct lod_list_draft *draft, struct lod_plant *plant,
	const struct lod_splats *splats, const struct lod_light *wood)
{
	uint8_t wood_rgb[1][3];
	struct lod_arena arena = { 0 };
	uint32_t count = draft->list.element_count;
	uint8_t (*rgb)[3] = lod_arena_take(&arena, count, sizeof *rgb);
	uint32_t *weights = lod_arena_take(&arena, count, sizeof *weights);
	struct lod_palette *palette = lod_arena_take(&arena, 1, sizeof *palette);
	for (uint32_t i = 0; i < count; i++) {
		memcpy(rgb[i], splats->items[i].rgb, sizeof rgb[i]);
		weights[i] = shown(&splats->items[i], splats->radius);
	}
	lod_palette_make(palette, COLORS, (const uint8_t (*)[3])rgb, weights, count, &arena);
	draft->list.palette_first = plant->palette_count;
	draft->list.palette_count = palette->count;
	for (uint32_t i = 0; i < count; i++)
		draft->elements.extra[(size_t)draft->elements.extra_count * i] =
			(int32_t)lod_palette_index(palette, rgb[i]);
	append_colors(plant, (const uint8_t (*)[3])palette->rgb, palette->count);
	draft->list.wood = wood->weight > 0 ? wood_code(splats, count, weights, palette, draft->elements.extra,
		draft->elements.extra_count) : 0;
	if (draft->list.wood) {
		lod_light_mean(wood, wood_rgb[0]);
		append_colors(plant, (const uint8_t (*)[3])wood_rgb, 1);
	}
	lod_arena_free(&arena);
}

/* ---- The ladder ---- */

/* Appends an empty list with room for its elements. The memory is the plant's. */
static struct lod_list_draft *add_list(struct lod_plant *plant, const struct eco_list *list, uint32_t ends)
{
	plant->lists = eco_realloc(plant->lists, plant->list_count + 1u, sizeof *plant->lists);
	struct lod_list_draft *draft = &plant->lists[plant->list_count++];
	*draft = (struct lod_list_draft){ .list = *list, .ends = eco_alloc(ends, sizeof *draft->ends) };
	struct eco_elements *e = &draft->elements;
	size_t count = list->element_count;
	e->extra_count = eco_list_extra_count(list);
	e->corners = eco_alloc(count, 1);
	e->position = eco_alloc(3 * count, sizeof *e->position);
	e->extra = eco_alloc(e->extra_count * count, sizeof *e->extra);
	return draft;
}

/* Sets what stands before the splats: the triangles of most leaves, or else the last level of wood. */
static void add_front(const struct lod_plant *plant, struct eco_ladder *whole)
{
	bool leaves = false;
	const struct eco_ladder *front = NULL;
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *l = &plant->ladders[i];
		bool wood = l->organ == ECO_ORGAN_WOOD;
		if (l->anchor || l->flags & ECO_LADDER_FAR || l->triangles == ECO_NONE || (wood && leaves))
			continue;
		uint32_t count = plant->lists[l->triangles].list.primitive_count
			- (l->level_count > 1 ? l->level_end[l->level_count - 2] : 0);
		if (count > whole->total || leaves == wood) {
			whole->triangles = l->triangles;
			whole->total = count;
			front = l;
		}
		leaves |= !wood;
	}
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *l = &plant->ladders[i];
		if (front && l->flags & ECO_LADDER_NEAR && l->organ == front->organ
				&& l->triangles != ECO_NONE && plant->lists[l->triangles].list.image
				== plant->lists[front->triangles].list.image)
			whole->total += plant->lists[l->triangles].list.primitive_count;
	}
}

static void add_ladder(struct lod_plant *plant, const struct lod_splats *splats)
{
	plant->ladders = eco_realloc(plant->ladders, plant->ladder_count + 1u, sizeof *plant->ladders);
	struct eco_ladder *ladder = &plant->ladders[plant->ladder_count];
	*ladder = (struct eco_ladder){ .organ = ECO_ORGAN_FOLIAGE, .flags = ECO_LADDER_WHOLE,
		.level_count = (uint8_t)splats->level_count, .points = plant->list_count - 1,
		.lines = ECO_NONE, .simple = ECO_NONE, .triangles = ECO_NONE, .impostor = ECO_NONE,
		.importance = 1 };
	memcpy(ladder->level_end, splats->level_end, splats->level_count * sizeof *ladder->level_end);
	add_front(plant, ladder);
	plant->plant.ladder_count = ++plant->ladder_count;
}

/* A body that is one piece, such as a rock, has no leaves: it would be drawn as one on three shells, which shade each
 * other. */
#define LEAF_MOST 0.25                   /* a leaf's width over the largest extent of its plant */

static uint16_t leaf_width(double leaf, const struct eco_model *model)
{
	float low[3], high[3];
	double extent = 0;
	if (!lod_model_bounds(model, low, high))
		return 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)high[k] - (double)low[k]);
	return leaf > LEAF_MOST * extent ? 0 : (uint16_t)fmin(leaf / ECO_LEAF_UNIT_M + 0.5, UINT16_MAX);
}

enum eco_code lod_plant_add_splats(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error)
{
	struct lod_splats splats;
	struct lod_arena arena = { 0 };
	struct triangles triangles = read_organs(model, &arena);
	const uint8_t (*rgb)[3] = (const uint8_t (*)[3])triangles.rgb;
	/* a build with small curves is a draft in its splats, too */
	bool small = options->draft || (options->pixels && options->pixels < 160);
	struct lod_splats_options fit = { .views = small ? 8 : 0, .pixels = small ? 72 : 0,
		.levels = options->draft ? LEVELS_DRAFT : 0, .draft = options->draft,
		.rgb = rgb, .organ = triangles.organ, .leaf = triangles.leaf, .progress = options->progress,
		.each = options->each, .ctx = options->ctx };
	lod_plant_enter(options, LOD_STAGE_SPLATS);
	enum eco_code code = lod_splats_fit(&splats, model, &fit, error);
	if (code) {
		lod_arena_free(&arena);
		return code;
	}
	if (splats.level_count) {
		struct eco_list list = list_of(&splats, splats.level_end[splats.level_count - 1]);
		list.level = triangles.level;
		struct lod_list_draft *draft = add_list(plant, &list,
			splats.level_count * LEVEL_CHUNKS);
		put_elements(draft, &splats);
		add_ladder(plant, &splats);
		color_elements(draft, plant, &splats, &triangles.wood);
		plant->plant.leaf_width = leaf_width(splats.leaf, model);
		plant->plant.leaf_tone = (uint8_t)fmin(splats.tone * ECO_TONE_ONE + 0.5, UINT8_MAX);
		if (!options->draft)
			code = lod_plant_add_impostor(plant, model, rgb, options, error);
	}
	lod_arena_free(&arena);
	lod_splats_free(&splats);
	return code;
}
