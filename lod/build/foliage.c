/* The stages are those of lod_plant_build up to its elements, so that element i here is element i of the
 * packed plant. */
#include "lod/build/foliage.h"

#include <string.h>

#include "lod/build/element.h"
#include "lod/build/model_draw.h"

/* Per image of the model: whether it has transparent texels. */
static bool *find_holes(const struct eco_model *model, struct lod_arena *arena)
{
	bool *holes = lod_arena_take(arena, model->image_count, sizeof *holes);
	for (uint32_t i = 0; i < model->image_count; i++)
		holes[i] = eco_image_has_holes(&model->images[i]);
	return holes;
}

static void take_arrays(struct lod_foliage *foliage, const struct lod_elements *elements,
	struct lod_arena *arena)
{
	size_t corners = 0, n = elements->count;
	for (uint32_t i = 0; i < elements->count; i++)
		corners += elements->items[i].corners;
	foliage->count = elements->count;
	foliage->first = lod_arena_take(arena, n + 1, sizeof *foliage->first);
	foliage->triangle_first = lod_arena_take(arena, n + 1, sizeof *foliage->triangle_first);
	foliage->corner = lod_arena_take(arena, corners, sizeof *foliage->corner);
	foliage->uv = lod_arena_take(arena, corners, sizeof *foliage->uv);
	foliage->cutout = lod_arena_take(arena, n, sizeof *foliage->cutout);
	foliage->mask = lod_arena_take(arena, n, sizeof *foliage->mask);
	foliage->group = lod_arena_take(arena, n, sizeof *foliage->group);
	foliage->center = lod_arena_take(arena, n, sizeof *foliage->center);
	foliage->normal = lod_arena_take(arena, n, sizeof *foliage->normal);
	foliage->area = lod_arena_take(arena, n, sizeof *foliage->area);
}

/* Groups are numbered in the order of their first elements. */
static uint32_t group_of(struct lod_foliage *foliage, uint32_t *number, uint32_t organ, uint32_t image,
	uint32_t images)
{
	uint32_t *known = &number[(size_t)organ * (images + 1) + (image == ECO_NONE ? images : image)];
	if (*known == 0)
		*known = ++foliage->group_count;
	return *known - 1;
}

static void fill_element(struct lod_foliage *foliage, uint32_t i, const struct lod_foliage_parts *parts)
{
	const struct lod_element *e = &parts->elements->items[i];
	const struct lod_mesh *mesh = parts->mesh;
	int32_t uv[2 * ECO_CORNERS_MAX];
	uint32_t at = foliage->first[i];
	lod_element_uv(e, mesh, uv);
	for (uint32_t k = 0; k < e->corners; k++) {
		memcpy(foliage->corner[at + k], mesh->place + 3 * (size_t)e->vertex[k],
			sizeof foliage->corner[0]);
		for (int a = 0; a < 2; a++)
			foliage->uv[at + k][a] = (float)uv[2 * k + (uint32_t)a] / ECO_UV_ONE;
	}
	foliage->first[i + 1] = at + e->corners;
	foliage->triangle_first[i + 1] = foliage->triangle_first[i] + e->corners - 2u;
	foliage->center[i] = lod_element_center(e, mesh);
	foliage->normal[i] = lod_element_normal(e, mesh);
	for (uint32_t k = 0; k + 2 < e->corners; k++)
		foliage->area[i] += parts->organs->area[e->triangle[k]];
}

static void fill_wood(struct lod_foliage *foliage, const struct lod_foliage_parts *parts,
	struct lod_arena *arena)
{
	const struct lod_mesh *mesh = parts->mesh;
	for (int pass = 0; pass < 2; pass++) {
		uint64_t count = 0;
		for (uint32_t t = 0; t < mesh->triangle_count; t++) {
			if (mesh->collapsed[t] || parts->organs->components[mesh->component[t]].organ
					!= ECO_ORGAN_WOOD)
				continue;
			for (uint32_t k = 0; k < 3 && pass == 1; k++)
				memcpy(foliage->wood + 9 * count + 3 * k,
					mesh->place + 3 * (size_t)mesh->index[3 * (size_t)t + k],
					3 * sizeof(float));
			count++;
		}
		foliage->wood_count = count;
		if (pass == 0)
			foliage->wood = lod_arena_take(arena, count, 9 * sizeof *foliage->wood);
	}
}

void lod_foliage_from(struct lod_foliage *foliage, const struct lod_foliage_parts *parts,
	struct lod_arena *arena)
{
	const struct lod_mesh *mesh = parts->mesh;
	const struct eco_model *model = parts->model;
	*foliage = (struct lod_foliage){ .low = lod_v3_of(mesh->low), .high = lod_v3_of(mesh->high) };
	take_arrays(foliage, parts->elements, arena);
	bool *holes = find_holes(model, arena);
	const struct lod_mask *masks = lod_model_masks(model, arena);
	uint32_t *number = lod_arena_take(arena, ECO_ORGAN_COUNT * ((size_t)model->image_count + 1),
		sizeof *number);
	for (uint32_t i = 0; i < foliage->count; i++) {
		uint32_t triangle = parts->elements->items[i].triangle[0];
		const struct lod_component *c = &parts->organs->components[mesh->component[triangle]];
		const struct eco_image *image = lod_mesh_image(model, c->material);
		uint32_t image_index = image ? (uint32_t)(image - model->images) : ECO_NONE;
		fill_element(foliage, i, parts);
		foliage->group[i] = group_of(foliage, number, c->organ, image_index, model->image_count);
		if (image && lod_mesh_material(model, c->material)->cutout && holes[image_index]) {
			foliage->cutout[i] = image;
			foliage->mask[i] = lod_model_mask(model, masks, image);
		}
	}
	fill_wood(foliage, parts, arena);
}
