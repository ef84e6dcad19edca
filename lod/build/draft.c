#include "lod/build/draft.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk.h"
#include "lod/light.h"

#define SMALLEST_CHUNK 32u       /* elements: small first chunks draw coarse plants from few bytes */
#define WOOD_CHUNK 2048u         /* triangles, about 1024 vertices, from which on edgebreaker pays */
#define ENDS_MAX 4096u

/* ---- Room ---- */

struct eco_ladder *lod_draft_ladder(struct lod_draft *draft)
{
	struct lod_plant *plant = draft->plant;
	eco_grow(&plant->ladders, &draft->ladder_capacity, plant->ladder_count, sizeof *plant->ladders);
	struct eco_ladder *ladder = &plant->ladders[plant->ladder_count++];
	*ladder = (struct eco_ladder){ .points = ECO_NONE, .lines = ECO_NONE, .simple = ECO_NONE,
		.triangles = ECO_NONE, .impostor = ECO_NONE, .importance = 1 };
	return ladder;
}

/* The size and kind of a list. */
struct shape { uint8_t kind, coder, attributes; uint32_t elements, corners, image; bool fine; };

static struct lod_list_draft *add_list(struct lod_draft *draft, const struct shape *shape)
{
	struct lod_plant *plant = draft->plant;
	eco_grow(&plant->lists, &draft->list_capacity, plant->list_count, sizeof *plant->lists);
	struct lod_list_draft *list = &plant->lists[plant->list_count++];
	*list = (struct lod_list_draft){ .list = { .kind = shape->kind, .coder = shape->coder,
		.attributes = shape->attributes,
		.owner = 0, .image = shape->image, .partner = ECO_NONE,
		.palette_count = shape->attributes & ECO_ATTR_COLOR ? draft->palette->count : 0 } };
	for (int a = 0; a < 3; a++) {
		list->list.grid_origin[a] = draft->mesh->origin[a];
		list->list.grid_step[a] = draft->mesh->step;
	}
	struct eco_elements *e = &list->elements;
	e->extra_count = eco_list_extra_count(&list->list);
	e->corners = eco_alloc(shape->elements, sizeof *e->corners);
	e->position = eco_alloc(3 * (size_t)shape->corners, sizeof *e->position);
	if (shape->fine)
		e->exact = eco_alloc(3 * (size_t)shape->corners, sizeof *e->exact);
	if (shape->attributes & ECO_ATTR_UV)
		e->uv = eco_alloc(2 * (size_t)shape->corners, sizeof *e->uv);
	if (e->extra_count)
		e->extra = eco_alloc((size_t)e->extra_count * shape->elements,
			sizeof *e->extra);
	return list;
}

/* Starts the next element, whose corners follow. Returns the place of its extra values. */
static int32_t *begin_element(struct eco_elements *e, uint32_t corners)
{
	e->corners[e->element_count] = (uint8_t)corners;
	e->primitive_count += corners < 3 ? 1 : corners - 2;
	return e->extra ? e->extra + (size_t)e->extra_count * e->element_count++ : (e->element_count++, NULL);
}

static void put_corner(struct eco_elements *e, const int32_t *position, const int32_t *uv)
{
	memcpy(e->position + 3 * (size_t)e->corner_count, position, 3 * sizeof *position);
	if (e->uv && uv)
		memcpy(e->uv + 2 * (size_t)e->corner_count, uv, 2 * sizeof *uv);
	e->corner_count++;
}

static uint32_t finish(struct lod_draft *draft, struct lod_list_draft *list, const uint32_t *ends,
	uint32_t end_count)
{
	list->list.element_count = list->elements.element_count;
	list->list.primitive_count = list->elements.primitive_count;
	list->ends = eco_alloc(end_count, sizeof *ends);
	memcpy(list->ends, ends, end_count * sizeof *ends);
	list->end_count = end_count;
	return (uint32_t)(list - draft->plant->lists);
}

static uint32_t finish_in_chunks(struct lod_draft *draft, struct lod_list_draft *list)
{
	uint32_t ends[ENDS_MAX];
	return finish(draft, list, ends, eco_chunk_split(list->elements.element_count, SMALLEST_CHUNK, ends,
		ENDS_MAX));
}

/* ---- Leaves ---- */

/* A corner on the grid, and its exact position: repeated shapes are placed more finely than corners are
 * rounded. */
static void put_fine(const struct lod_mesh *mesh, struct eco_elements *e, uint32_t vertex, const int32_t *uv)
{
	int32_t *exact = e->exact + 3 * (size_t)e->corner_count;
	for (uint32_t a = 0; a < 3; a++) {
		double v = ldexp((mesh->place[3 * (size_t)vertex + a] - mesh->origin[a]) / mesh->step,
			ECO_EXACT_SHIFT);
		exact[a] = (int32_t)floor(v + 0.5);
	}
	put_corner(e, mesh->grid + 3 * (size_t)vertex, uv);
}

static void put_fans(struct lod_draft *draft, struct lod_list_draft *list, const struct lod_element *elements,
	const uint8_t *growth, const uint32_t *items, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_element *e = &elements[items[i]];
		int32_t uv[2 * ECO_CORNERS_MAX], *extra = begin_element(&list->elements, e->corners);
		lod_element_uv(e, draft->mesh, uv);
		for (uint32_t k = 0; k < e->corners; k++)
			put_fine(draft->mesh, &list->elements, e->vertex[k], uv + 2 * k);
		if (list->list.image == ECO_NONE) {
			uint8_t rgb[3];
			lod_organs_mean(draft->organs, e->triangle, e->corners - 2u, rgb);
			*extra++ = (int32_t)lod_palette_index(draft->palette, rgb);
		}
		if (growth)
			*extra = growth[items[i]];
	}
}

/* Sorts `items` as they are decoded: what is measured is what clients draw. */
static void take_order(const struct lod_list_draft *list, uint32_t *items)
{
	for (uint32_t c = 0, first = 0; c < list->end_count; first = list->ends[c++]) {
		const struct eco_chunk_input input = { &list->list, &list->elements, first, list->ends[c], c };
		uint32_t count = list->ends[c] - first, *order = eco_alloc(count, sizeof *order),
			*sorted = eco_alloc(count, sizeof *sorted);
		if (!eco_chunk_order(&input, order, NULL)) {     /* else packing says what does not fit */
			for (uint32_t i = 0; i < count; i++)
				sorted[i] = items[first + order[i]];
			memcpy(items + first, sorted, count * sizeof *sorted);
		}
		free(sorted);
		free(order);
	}
}

uint32_t lod_draft_fans(struct lod_draft *draft, const struct lod_element *elements, const uint8_t *growth,
	uint32_t *items, uint32_t count, uint32_t image)
{
	uint32_t corners = 0;
	if (count == 0)
		return ECO_NONE;
	for (uint32_t i = 0; i < count; i++)
		corners += elements[items[i]].corners;
	struct lod_list_draft *list = add_list(draft, &(struct shape){ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS,
		(image == ECO_NONE ? ECO_ATTR_COLOR : ECO_ATTR_UV) | (growth ? ECO_ATTR_GROWTH : 0), count,
		corners, image, true });
	put_fans(draft, list, elements, growth, items, count);
	uint32_t number = finish_in_chunks(draft, list);
	take_order(list, items);
	list->elements.element_count = list->elements.corner_count = list->elements.primitive_count = 0;
	put_fans(draft, list, elements, growth, items, count);
	return number;
}

/* ---- Other forms ---- */

static struct lod_list_draft *add_form(struct lod_draft *draft, uint32_t partner, uint8_t kind,
	uint8_t attributes, uint32_t corners)
{
	uint32_t count = draft->plant->lists[partner].elements.element_count;
	struct lod_list_draft *list =
		add_list(draft, &(struct shape){ kind, ECO_CODER_FORM, attributes, count, corners * count,
		ECO_NONE, false });
	list->list.partner = partner;
	return list;
}

/* A form's chunks end with its partner's. */
static uint32_t finish_form(struct lod_draft *draft, struct lod_list_draft *list)
{
	const struct lod_list_draft *of = &draft->plant->lists[list->list.partner];
	assert(list->elements.element_count == of->elements.element_count);
	return finish(draft, list, of->ends, of->end_count);
}

uint32_t lod_draft_points(struct lod_draft *draft, uint32_t partner, const struct lod_point *points,
	const uint32_t *items, float unit_area, uint32_t cover)
{
	if (partner == ECO_NONE)
		return ECO_NONE;
	struct lod_list_draft *list = add_form(draft, partner, ECO_LIST_POINTS,
		ECO_ATTR_COLOR | ECO_ATTR_SIZE, 1);
	uint32_t count = draft->plant->lists[partner].elements.element_count;
	list->list.cover = cover;
	list->list.unit_area = eco_few_bits(unit_area / eco_list_opacity(&list->list));
	for (uint32_t i = 0; i < count; i++) {
		int32_t *extra = begin_element(&list->elements, 1);
		put_corner(&list->elements, points[items[i]].position, NULL);
		extra[0] = (int32_t)lod_palette_index(draft->palette, points[items[i]].rgb);
		extra[1] = points[items[i]].size;
	}
	return finish_form(draft, list);
}

uint32_t lod_draft_facets(struct lod_draft *draft, uint32_t partner, const struct lod_facet *facets,
	const uint8_t *growth, const uint32_t *items)
{
	if (partner == ECO_NONE)
		return ECO_NONE;
	struct lod_list_draft *list = add_form(draft, partner, ECO_LIST_TRIANGLES,
		ECO_ATTR_COLOR | (growth ? ECO_ATTR_GROWTH : 0), 3);
	uint32_t count = draft->plant->lists[partner].elements.element_count;
	for (uint32_t i = 0; i < count; i++) {
		int32_t *extra = begin_element(&list->elements, 3);
		for (uint32_t k = 0; k < 3; k++)
			put_corner(&list->elements, facets[i].corner[k], NULL);
		extra[0] = (int32_t)lod_palette_index(draft->palette, facets[i].rgb);
		if (growth)
			extra[1] = growth[items[i]];
	}
	return finish_form(draft, list);
}

/* ---- Lines ---- */

static void to_grid(const struct lod_mesh *mesh, struct lod_v3 p, int32_t grid[3])
{
	for (int a = 0; a < 3; a++)
		grid[a] = (int32_t)floor((lod_v3_axis(p, a) - mesh->origin[a]) / mesh->step + 0.5);
}

/* `owed`: area that rounding has added to lines so far, in grid steps times metres. Twigs may be a fraction
 * of a step wide, so what rounding adds to one line is taken from the next. */
static void put_line(struct lod_draft *draft, struct lod_list_draft *list, const struct lod_line *line,
	double *owed)
{
	double length = lod_v3_distance(line->end[0], line->end[1]), width = line->width / draft->mesh->step;
	double rounded = length > 0 ? floor(width - *owed / length + 0.5) : 1;
	int32_t *extra = begin_element(&list->elements, 2), at[3];
	rounded = rounded < 1 ? 1 : rounded;
	*owed += (rounded - width) * length;
	for (int i = 0; i < 2; i++) {
		to_grid(draft->mesh, line->end[i], at);
		put_corner(&list->elements, at, NULL);
	}
	extra[0] = (int32_t)lod_palette_index(draft->palette, line->rgb);
	extra[1] = (int32_t)rounded;
}

static bool has_length(const struct lod_mesh *mesh, const struct lod_line *line)
{
	int32_t a[3], b[3];
	to_grid(mesh, line->end[0], a);
	to_grid(mesh, line->end[1], b);
	return memcmp(a, b, sizeof a) != 0;
}

uint32_t lod_draft_lines(struct lod_draft *draft, const struct lod_line *lines, uint32_t count)
{
	double owed = 0;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < count; i++)
		kept += has_length(draft->mesh, &lines[i]);
	if (kept == 0)
		return ECO_NONE;
	struct lod_list_draft *list =
		add_list(draft,
		&(struct shape){ ECO_LIST_LINES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_WIDTH, kept,
		2 * kept, ECO_NONE, false });
	list->elements.part = eco_alloc(kept, sizeof *list->elements.part);
	for (uint32_t i = 0; i < count; i++)
		if (has_length(draft->mesh, &lines[i])) {
			list->elements.part[list->elements.element_count] = lines[i].limb;
			put_line(draft, list, &lines[i], &owed);
		}
	return finish_in_chunks(draft, list);
}

uint32_t lod_draft_blades(struct lod_draft *draft, uint32_t partner, const struct lod_line *lines,
	const uint32_t *items)
{
	double owed = 0;
	if (partner == ECO_NONE)
		return ECO_NONE;
	struct lod_list_draft *list = add_form(draft, partner, ECO_LIST_LINES,
		ECO_ATTR_COLOR | ECO_ATTR_WIDTH, 2);
	for (uint32_t i = 0; i < draft->plant->lists[partner].elements.element_count; i++)
		put_line(draft, list, &lines[items[i]], &owed);
	return finish_form(draft, list);
}

/* ---- Wood ---- */

/* Chunks of a level that ends at element `end`: even ones, each large enough for edgebreaker. */
static uint32_t end_level(uint32_t *ends, uint32_t count, uint32_t from, uint32_t end)
{
	uint32_t chunks = (end - from) / WOOD_CHUNK ? (end - from) / WOOD_CHUNK : 1;
	for (uint32_t i = 1; i <= chunks; i++)
		ends[count++] = from + (uint32_t)((uint64_t)(end - from) * i / chunks);
	return count;
}

static void put_wood(struct lod_draft *draft, struct eco_elements *e, const struct lod_corner corner[3],
	const uint8_t rgb[3])
{
	int32_t *extra = begin_element(e, 3), uv[6];
	for (int i = 0; i < 6; i++)
		uv[i] = corner[i / 2].uv[i % 2];
	lod_uv_unturn(uv, 3);
	for (int k = 0; k < 3; k++)
		put_corner(e, draft->mesh->grid + 3 * (size_t)corner[k].vertex, uv + 2 * k);
	if (extra)
		extra[0] = (int32_t)lod_palette_index(draft->palette, rgb);
}

void lod_draft_shade(struct lod_draft *draft)
{
	const struct lod_mesh *mesh = draft->mesh;
	draft->shade = lod_arena_take(draft->arena, mesh->vertex_count, sizeof *draft->shade);
	draft->shaded = lod_arena_take(draft->arena, mesh->component_count, sizeof *draft->shaded);
	struct lod_arena_piece *mark = draft->arena->last;
	struct lod_light *light = lod_arena_take(draft->arena, mesh->vertex_count, sizeof *light);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		uint32_t c = mesh->component[t];
		bool wood = draft->organs->components[c].organ == ECO_ORGAN_WOOD;
		draft->shaded[c] = draft->shaded[c]
			|| (wood && memcmp(draft->organs->rgb[t], draft->organs->components[c].rgb, 3) != 0);
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (uint32_t k = 0; k < 3 && draft->shaded[mesh->component[t]]; k++)
			lod_light_add(&light[mesh->index[3 * (size_t)t + k]], draft->organs->rgb[t],
				draft->organs->area[t]);
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		lod_light_mean(&light[v], draft->shade[v]);
	lod_arena_release(draft->arena, mark);
}

static void corner_colour(const struct lod_draft *draft, const struct lod_corner corner[3], uint8_t rgb[3])
{
	struct lod_light light = { { 0, 0, 0 }, 0 };
	memcpy(rgb, draft->organs->components[corner->component].rgb, 3);
	if (!draft->shaded[corner->component])
		return;
	for (int k = 0; k < 3; k++)
		lod_light_add(&light, draft->shade[corner[k].vertex], 1);
	lod_light_mean(&light, rgb);
}

uint32_t lod_draft_wood(struct lod_draft *draft, const struct lod_levels *levels, const uint32_t *triangles,
	uint32_t count, uint32_t image, struct eco_ladder *ladder)
{
	const struct lod_mesh *mesh = draft->mesh;
	uint32_t total = count, end_count = 0, at = 0;
	if (count == 0)
		return ECO_NONE;
	for (uint32_t l = 0; l < levels->count; l++)
		total += levels->triangle_count[l];
	struct lod_list_draft *list = add_list(draft, &(struct shape){ ECO_LIST_TRIANGLES, ECO_CODER_MESH,
		image == ECO_NONE ? ECO_ATTR_COLOR : ECO_ATTR_UV, total, 3 * total, image, false });
	uint32_t *ends = lod_arena_take(draft->arena, total / WOOD_CHUNK + LOD_LEVELS_SIMPLE + 2,
		sizeof *ends);
	if (levels->limb[levels->count])
		list->elements.part = eco_alloc(total, sizeof *list->elements.part);
	for (uint32_t l = 0; l <= levels->count && list->elements.part; l++) {
		uint32_t size = l < levels->count ? levels->triangle_count[l] : count;
		memcpy(list->elements.part + at, levels->limb[l], size * sizeof **levels->limb);
		at += size;
	}
	at = 0;
	for (uint32_t l = 0; l < levels->count; l++) {
		for (uint32_t i = 0; i < levels->triangle_count[l]; i++) {
			const struct lod_corner *corner = levels->corner[l] + 3 * (size_t)i;
			uint8_t rgb[3];
			corner_colour(draft, corner, rgb);
			put_wood(draft, &list->elements, corner, rgb);
		}
		end_count = end_level(ends, end_count, at, at + levels->triangle_count[l]);
		at += levels->triangle_count[l];
		ladder->level_end[l] = at;
	}
	for (uint32_t i = 0; i < count; i++) {
		struct lod_corner corner[3];
		uint32_t t = triangles[i];
		for (uint32_t k = 0; k < 3; k++)
			corner[k] = (struct lod_corner){ mesh->index[3 * (size_t)t + k], mesh->component[t],
				{ mesh->uv[6 * (size_t)t + 2 * k], mesh->uv[6 * (size_t)t + 2 * k + 1] } };
		put_wood(draft, &list->elements, corner, draft->organs->rgb[t]);
	}
	end_count = end_level(ends, end_count, at, at + count);
	if (levels->count) {
		ladder->level_count = (uint8_t)(levels->count + 1);
		ladder->level_end[levels->count] = at + count;
	}
	return finish(draft, list, ends, end_count);
}
