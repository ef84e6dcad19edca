/* Small random scenes for tests of the planner and of what evaluates its plans: tables only, no chunks' payloads. Every kind of ladder
 * (points, simple forms and triangles, blades, wood with levels, plain triangles), plants with and without cells, tiles in two levels,
 * nested placements. */
#ifndef TESTS_SCENE_RANDOM_H
#define TESTS_SCENE_RANDOM_H

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/mix.h"
#include "ecofiles/format/pack.h"

#define RANDOM_MOST 512

struct random_sizes { uint32_t species, leaves, elements, places, cells; };      /* at most; leaves: exactly, up to 4 */

struct random_scene {
	struct eco_scene scene;
	uint64_t state;
	struct random_sizes sizes;
	struct eco_plant plants[RANDOM_MOST];
	struct eco_anchor anchors[RANDOM_MOST];
	struct eco_ladder ladders[RANDOM_MOST];
	struct eco_curve curves[2 * RANDOM_MOST];
	struct eco_tile tiles[RANDOM_MOST];
	struct eco_group groups[RANDOM_MOST];
	struct eco_child children[RANDOM_MOST];
	struct eco_list lists[4 * RANDOM_MOST];
	struct eco_chunk chunks[8 * RANDOM_MOST];
	uint8_t places[1 << 18];
};

static inline uint64_t random_bits(struct random_scene *r)
{
	return eco_mix_next(&r->state);
}

static inline double random_real(struct random_scene *r, double low, double high)
{
	return low + (high - low) * eco_mix_unit(random_bits(r));
}

static inline uint32_t random_below(struct random_scene *r, uint32_t n)
{
	return (uint32_t)(random_bits(r) % n);
}

static inline uint32_t random_list(struct random_scene *r, uint8_t kind, uint32_t primitives, uint32_t owner, uint32_t plant)
{
	if (primitives == 0)
		return ECO_NONE;
	struct eco_scene *s = &r->scene;
	struct eco_list *list = &r->lists[s->list_count];
	*list = (struct eco_list){ .kind = kind, .owner = owner, .plant = plant, .image = ECO_NONE, .partner = ECO_NONE,
		.grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f, .chunk_first = s->chunk_count, .chunk_count = 2,
		.primitive_count = primitives, .element_count = primitives };
	if (primitives == 1)
		list->chunk_count = 1;
	for (uint32_t i = 0, left = primitives; i < list->chunk_count; i++) {
		uint32_t n = i + 1 == list->chunk_count ? left : left / 3 + 1;
		r->chunks[s->chunk_count++] = (struct eco_chunk){ .primitive_count = n, .element_count = n, .size_bytes = 10 * n };
		left -= n;
	}
	return s->list_count++;
}

/* Elements of one to four triangles; and another form of them, one to four `corners` each. */
static inline uint32_t random_fans(struct random_scene *r, uint32_t elements, uint32_t owner)
{
	uint32_t id = random_list(r, ECO_LIST_TRIANGLES, elements, owner, ECO_NONE);
	if (id == ECO_NONE)
		return id;
	struct eco_list *list = &r->lists[id];
	uint32_t mixed = random_below(r, 2);
	list->coder = ECO_CODER_ELEMENTS;
	list->primitive_count = 0;
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		struct eco_chunk *chunk = &r->chunks[list->chunk_first + c];
		chunk->primitive_count = mixed ? 2 * chunk->element_count + random_below(r, 2 * chunk->element_count + 1) : 2 * chunk->element_count;
		list->primitive_count += chunk->primitive_count;
	}
	return id;
}

static inline uint32_t random_form(struct random_scene *r, uint8_t kind, uint32_t of, uint32_t corners)
{
	uint32_t id = random_list(r, kind, r->lists[of].element_count, r->lists[of].owner, ECO_NONE);
	if (id == ECO_NONE)
		return id;
	struct eco_list *list = &r->lists[id];
	list->coder = ECO_CODER_FORM;
	list->partner = of;
	uint32_t each = corners == 4 ? 2 : 1;
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		struct eco_chunk *chunk = &r->chunks[list->chunk_first + c];
		chunk->primitive_count = each * chunk->element_count;
	}
	list->primitive_count *= each;
	return id;
}

static inline void random_curve(struct random_scene *r, struct eco_ladder *ladder)
{
	ladder->curve_first = r->scene.curve_count;
	ladder->curve_count = 4;
	float reach = 0;
	for (int i = 0; i < 4; i++) {
		float share = i == 0 ? 0.001f : i == 1 ? 0.03f : i == 2 ? 0.2f : 1;
		reach = i == 3 ? 1 : reach + (1 - reach) * (float)random_real(r, 0, 0.8);
		r->curves[r->scene.curve_count++] = (struct eco_curve){ share, 1, reach, 0.4f * (1 - share), 0.4f * (1 - share) };
	}
	ladder->flags |= ECO_LADDER_ABOVE;
	for (uint32_t i = 0; i < ladder->curve_count; i++) {
		struct eco_curve *above = &r->curves[r->scene.curve_count++];
		*above = r->curves[ladder->curve_first + i];
		above->scale = above->share < 1 ? 1.25f : 1;
		above->fp *= 0.5f;
	}
}

static inline void random_ladder(struct random_scene *r, uint32_t plant, uint32_t anchor, int kind, uint8_t flags, uint32_t before)
{
	struct eco_ladder *l = &r->ladders[r->scene.ladder_count++];
	uint32_t k = 1 + random_below(r, r->sizes.elements);
	*l = (struct eco_ladder){ .plant = plant, .anchor = anchor, .flags = flags, .organ = ECO_ORGAN_FOLIAGE, .points = ECO_NONE,
		.lines = ECO_NONE, .simple = ECO_NONE, .triangles = ECO_NONE, .importance = random_below(r, 4) ? 1 : 3,
		.area = (float)random_real(r, 0.1, 30),
		.length = (float)random_real(r, 1, 100), .epsilon = (float)random_real(r, 0, 0.05) };
	if (kind < 3)
		l->triangles = random_fans(r, k, plant);
	else if (!(flags & ECO_LADDER_FAR))
		l->triangles = random_list(r, ECO_LIST_TRIANGLES, k, plant, ECO_NONE);
	if (kind == 0) {
		l->points = random_form(r, ECO_LIST_POINTS, l->triangles, 1);
		if (random_below(r, 2))
			l->simple = random_form(r, ECO_LIST_TRIANGLES, l->triangles, 3 + random_below(r, 2));
	}
	if (kind == 1)
		l->lines = random_form(r, ECO_LIST_LINES, l->triangles, 2);
	if (kind == 3)
		l->lines = random_list(r, ECO_LIST_LINES, 1 + random_below(r, k), plant, ECO_NONE);
	if (kind == 3) {
		l->organ = ECO_ORGAN_WOOD;
		before = 0;
		if (l->triangles != ECO_NONE && k > 4) {
			l->level_count = 2;
			l->level_end[0] = k / 5;
			l->level_end[1] = k;
		}
	}
	uint32_t own = kind == 3 ? r->lists[l->lines].primitive_count : k;
	l->before = flags & ECO_LADDER_NEAR ? before : 0;
	l->total = own + l->before;
	random_curve(r, l);
}

static inline void random_plant(struct random_scene *r)
{
	struct eco_scene *s = &r->scene;
	uint32_t id = s->plant_count++, cells = random_below(r, 2) ? 0 : 2 + random_below(r, r->sizes.cells - 1);
	struct eco_plant *p = &r->plants[id];
	int kind = (int)random_below(r, 3);
	*p = (struct eco_plant){ .height_m = (float)random_real(r, 0.3, 25), .anchor_first = s->anchor_count, .anchor_count = 1 + cells,
		.ladder_first = s->ladder_count };
	r->anchors[s->anchor_count++] = (struct eco_anchor){ { 0, 0, p->height_m / 2 }, p->height_m / 2 };
	random_ladder(r, id, p->anchor_first, kind, 0, 0);
	random_ladder(r, id, p->anchor_first, 3, cells ? ECO_LADDER_FAR : 0, 0);
	for (uint32_t c = 0; c < cells; c++) {
		float h = p->height_m;
		uint32_t anchor = s->anchor_count++;
		r->anchors[anchor] = (struct eco_anchor){ { (float)random_real(r, -h / 4, h / 4), (float)random_real(r, -h / 4, h / 4),
			(float)random_real(r, 0, h) }, h / 4 };
		random_ladder(r, id, anchor, kind, ECO_LADDER_NEAR, random_below(r, 40));
		random_ladder(r, id, anchor, 3, ECO_LADDER_NEAR, 0);
	}
	p->ladder_count = s->ladder_count - p->ladder_first;
}

static inline void random_leaf(struct random_scene *r, uint32_t tile, double x, double y, double size)
{
	struct eco_scene *s = &r->scene;
	struct eco_tile *t = &r->tiles[tile];
	t->group_first = s->group_count;
	t->group_count = 1 + random_below(r, s->plant_count);
	for (uint32_t g = 0; g < t->group_count; g++) {
		uint32_t count = 1 + random_below(r, r->sizes.places), list = random_list(r, ECO_LIST_INSTANCES, count, tile, g);
		r->lists[list].grid_origin[0] = x;
		r->lists[list].grid_origin[1] = y;
		r->groups[s->group_count++] = (struct eco_group){ tile, g, list, s->place_count };
		for (uint32_t i = 0; i < count; i++) {
			uint8_t *at = r->places + ECO_PLACE_BYTES * s->place_count++;
			int32_t p[3] = { (int32_t)random_below(r, (uint32_t)(size * 1000)), (int32_t)random_below(r, (uint32_t)(size * 1000)), 0 };
			uint32_t scale = 32768 + random_below(r, 65536);
			uint16_t turn = (uint16_t)random_bits(r);
			memcpy(at, p, 12);                   /* tests run on little-endian machines */
			memcpy(at + 12, &turn, 2);
			memset(at + 14, 0, 2);
			memcpy(at + 16, &scale, 4);
		}
		t->instance_count += count;
		t->area += 20.0 * count;
	}
	t->summary = random_list(r, ECO_LIST_POINTS, 8 + random_below(r, 64), tile, ECO_NONE);
}

/* `nested` adds placed copies of one eco file under the root. The result points into *r: do not copy it. */
static inline void random_scene_sized(struct random_scene *r, uint64_t seed, uint32_t nested, struct random_sizes sizes)
{
	memset(r, 0, sizeof *r);
	r->state = seed;
	r->sizes = sizes;
	struct eco_scene *s = &r->scene;
	*s = (struct eco_scene){ .near_m = 0.01, .plants = r->plants, .anchors = r->anchors, .ladders = r->ladders,
		.curves = r->curves, .tiles = r->tiles, .groups = r->groups, .children = r->children, .lists = r->lists,
		.chunks = r->chunks, .places = r->places };
	uint32_t plants = 1 + random_below(r, sizes.species);
	while (s->plant_count < plants)
		random_plant(r);
	uint32_t leaves = sizes.leaves;
	s->tile_count = 1 + leaves + (nested ? 1 : 0);
	r->tiles[0] = (struct eco_tile){ .low = { -2000, -2000, -30 }, .high = { 2000, 2000, 60 }, .child_first = 0 };
	for (uint32_t i = 0; i < leaves; i++) {
		double x = i % 2 * 50.0, y = (double)(i / 2) * 50;
		r->tiles[1 + i] = (struct eco_tile){ .low = { x - 30, y - 30, -30 }, .high = { x + 80, y + 80, 60 }, .summary = ECO_NONE };
		random_leaf(r, 1 + i, x, y, 50);
		r->children[s->child_count++] = (struct eco_child){ .tile = 1 + i, .scale = 1 };
		r->tiles[0].instance_count += r->tiles[1 + i].instance_count;
		r->tiles[0].area += r->tiles[1 + i].area;
	}
	if (nested) {
		uint32_t inner = 1 + leaves;
		r->tiles[inner] = (struct eco_tile){ .low = { -30, -30, -30 }, .high = { 80, 80, 60 } };
		random_leaf(r, inner, 0, 0, 50);
		for (uint32_t i = 0; i < nested; i++)
			r->children[s->child_count++] = (struct eco_child){ .tile = inner, .placed = true,
				.at = { random_real(r, -500, 500), random_real(r, -500, 500), 0 }, .turn = (uint16_t)random_bits(r),
				.scale = (float)random_real(r, 0.5, 1.5) };
	}
	r->tiles[0].child_count = s->child_count;
	r->tiles[0].summary = random_list(r, ECO_LIST_POINTS, 100, 0, ECO_NONE);
}

static inline void random_scene_make(struct random_scene *r, uint64_t seed, uint32_t nested)
{
	random_scene_sized(r, seed, nested, (struct random_sizes){ .species = 4, .leaves = 4, .elements = 300, .places = 40, .cells = 7 });
}

#endif
