/* A small real pack, written through the writer: two species (leaves, a point for each, and twigs; a textured bush), 400 plants in two
 * tiles under a root with a summary, ground, a texture. About 800 KB in 2,000 chunks, so that large budgets get coarse
 * steps. */
#ifndef TESTS_SAMPLE_PACK_H
#define TESTS_SAMPLE_PACK_H

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk.h"
#include "ecofiles/format/pack.h"
#include "lod/build/ground_tree.h"
#include "tests/support/ground_tiles.h"

#define SAMPLE_LEAVES 30000u
#define SAMPLE_PLANTS 100u           /* of each species in each tile */

struct sample {
	struct eco_pack_writer *writer;
	uint64_t state;
	struct eco_error *error;
	enum eco_code code;
	uint8_t *places;
	uint64_t place_count;
	struct lod_ground_tree ground;
	uint32_t ground_columns, ground_rows;
};

static inline uint32_t sample_bits(struct sample *s)
{
	s->state = s->state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(s->state >> 33);
}

/* Elements of `corners` corners at random places of a cube of 4096 steps, corners near each other. */
static inline struct eco_elements sample_elements(struct sample *s, uint32_t count, uint8_t corners, const struct eco_list *list)
{
	struct eco_elements e = { .element_count = count, .corner_count = count * corners,
		.primitive_count = corners < 3 ? count : count * (corners - 2u), .extra_count = eco_list_extra_count(list) };
	e.corners = malloc(count);
	e.position = malloc(3 * (size_t)e.corner_count * sizeof *e.position);
	e.uv = list->attributes & ECO_ATTR_UV ? calloc(2 * (size_t)e.corner_count, sizeof *e.uv) : NULL;
	e.extra = e.extra_count ? calloc((size_t)e.extra_count * count, sizeof *e.extra) : NULL;
	memset(e.corners, corners, count);
	for (uint32_t i = 0; i < count; i++)
		for (int axis = 0; axis < 3; axis++) {
			int32_t base = (int32_t)(sample_bits(s) % 4096);
			for (uint32_t c = 0; c < corners; c++)
				e.position[3 * ((size_t)i * corners + c) + (size_t)axis] = base + (int32_t)(sample_bits(s) % 64);
		}
	for (uint32_t i = 0; e.uv && i < 2 * e.corner_count; i++)
		e.uv[i] = (int32_t)(sample_bits(s) % ECO_UV_ONE);
	return e;
}

static inline struct eco_list sample_list(uint8_t kind, uint8_t coder, uint8_t attributes, uint32_t owner)
{
	return (struct eco_list){ .kind = kind, .coder = coder, .attributes = attributes, .owner = owner, .plant = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE, .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f,
		.palette_count = attributes & ECO_ATTR_COLOR ? 2 : 0 };
}

static inline uint32_t sample_add(struct sample *s, const struct eco_list *list, const struct eco_elements *elements,
	const struct eco_elements *partner)
{
	static uint32_t ends[4096];
	uint32_t total = (partner ? partner : elements)->element_count, id = ECO_NONE, count = 0;
	for (uint32_t end = 32; end < total; end += 32)      /* many small chunks: more than one send, one page, one vector holds */
		ends[count++] = end;
	ends[count++] = total;
	if (!s->code)
		s->code = eco_pack_add_list(s->writer, list, elements, ends, count, partner, &id, s->error);
	return id;
}

static inline uint32_t sample_simple(struct sample *s, struct eco_list list, uint32_t count, uint8_t corners)
{
	struct eco_elements e = sample_elements(s, count, corners, &list);
	uint32_t id = sample_add(s, &list, &e, NULL);
	eco_elements_free(&e);
	return id;
}

/* Leaves and a point for each; returns the leaves, the points are the next list. */
static inline uint32_t sample_leaves(struct sample *s)
{
	struct eco_list list = sample_list(ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 0);
	struct eco_elements leaves = sample_elements(s, SAMPLE_LEAVES, 3, &list);
	uint32_t id = sample_add(s, &list, &leaves, NULL);
	list = sample_list(ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_COLOR, 0);
	list.partner = id;
	struct eco_elements points = sample_elements(s, SAMPLE_LEAVES, 1, &list);
	sample_add(s, &list, &points, &leaves);
	eco_elements_free(&leaves);
	eco_elements_free(&points);
	return id;
}

static inline uint32_t sample_instances(struct sample *s, uint32_t tile, uint32_t plant, double x)
{
	struct eco_list list = sample_list(ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, tile);
	list.plant = plant;
	list.grid_origin[0] = x;
	list.grid_step[0] = list.grid_step[1] = 50.0 / 4096;
	struct eco_elements e = sample_elements(s, SAMPLE_PLANTS, 1, &list);
	for (uint32_t i = 0; i < SAMPLE_PLANTS; i++) {
		e.position[3 * i + 2] = 0;
		e.extra[2 * i] = (int32_t)(sample_bits(s) % 65536);
		e.extra[2 * i + 1] = (int32_t)(32768 + sample_bits(s) % 65536);
		uint8_t *at = s->places + ECO_PLACE_BYTES * s->place_count++;
		uint16_t turn = (uint16_t)e.extra[2 * i];
		memcpy(at, &e.position[3 * i], 12);      /* tests run on little-endian machines */
		memcpy(at + 12, &turn, 2);
		memset(at + 14, 0, 2);
		memcpy(at + 16, &e.extra[2 * i + 1], 4);
	}
	uint32_t id = sample_add(s, &list, &e, NULL);
	eco_elements_free(&e);
	return id;
}

static inline uint32_t sample_image(struct sample *s)
{
	struct eco_list list = sample_list(ECO_LIST_IMAGE, ECO_CODER_BYTES, 0, 1);
	uint8_t bytes[3000];
	uint32_t id = ECO_NONE;
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (uint8_t)sample_bits(s);
	if (!s->code)
		s->code = eco_pack_add_bytes(s->writer, &list, bytes, sizeof bytes, &id, s->error);
	return id;
}

static inline double sample_height(double x, double y)
{
	return 2 + sin(x * 0.3) + 0.01 * y;
}

/* All tiles of a ground; s->ground lists them. */
static inline void sample_ground(struct sample *s, const struct eco_ground *ground)
{
	struct lod_ground_tree tree = { 0 };
	if (!s->code)
		s->code = lod_ground_build(&tree, ground, GROUND_TILES_STEP_M, GROUND_TILES_STEP_M, s->error);
	for (uint32_t i = 0; i < tree.count && !s->code; i++) {
		struct eco_list list = ground_list(ground, &tree.tiles[i]);
		struct eco_elements e = ground_elements(ground, &tree.tiles[i], tree.shifts[i]);
		s->code = eco_pack_add_list(s->writer, &list, &e, &e.element_count, 1, NULL, &tree.tiles[i].list, s->error);
		eco_elements_free(&e);
	}
	s->ground = tree;
	s->ground_columns = ground->columns;
	s->ground_rows = ground->rows;
}

static inline void sample_commit(struct sample *s, const uint32_t instances[4], uint32_t leaves, uint32_t wood, uint32_t bush,
	uint32_t summary)
{
	static const uint8_t palette[2][3] = { { 30, 90, 30 }, { 90, 60, 30 } };
	const struct eco_curve curves[] = { { .01f, 1, .01f, .3f, .3f }, { .1f, 1, .1f, .2f, .2f }, { 1, 1, 1, 0, 0 } };
	const struct eco_anchor anchors[] = { { { 2, 2, 2 }, 4 }, { { 2, 2, 2 }, 4 } };
	struct eco_ladder ladders[] = {
		{ .plant = 0, .anchor = 0, .organ = ECO_ORGAN_FOLIAGE, .points = leaves + 1, .lines = ECO_NONE, .simple = ECO_NONE, .triangles = leaves,
			.total = SAMPLE_LEAVES, .area = 20, .curve_count = 3 },
		{ .plant = 0, .anchor = 0, .organ = ECO_ORGAN_WOOD, .points = ECO_NONE, .lines = wood, .simple = ECO_NONE, .triangles = ECO_NONE,
			.total = 300, .area = 2, .length = 30, .epsilon = .01f, .curve_count = 3 },
		{ .plant = 1, .anchor = 1, .organ = ECO_ORGAN_FOLIAGE, .points = ECO_NONE, .lines = ECO_NONE, .simple = ECO_NONE, .triangles = bush,
			.total = 400, .area = 5, .curve_count = 3 },
	};
	for (int i = 0; i < 3; i++)
		ladders[i].importance = 1;
	const struct eco_plant plants[] = {
		{ .name = "tree", .height_m = 4, .anchor_count = 1, .ladder_count = 2, .area = 22, .triangles = SAMPLE_LEAVES },
		{ .name = "bush", .height_m = 4, .anchor_first = 1, .anchor_count = 1, .ladder_first = 2, .ladder_count = 1, .area = 5,
			.triangles = 800 },
	};
	struct eco_group groups[4];
	for (uint32_t i = 0; i < 4; i++)
		groups[i] = (struct eco_group){ 1 + i / 2, i % 2, instances[i], i * SAMPLE_PLANTS };
	const struct eco_tile tiles[] = {
		{ .low = { -5, -5, -5 }, .high = { 110, 60, 15 }, .area = 8000, .instance_count = 4 * SAMPLE_PLANTS, .summary = summary,
			.child_count = 2 },
		{ .low = { -5, -5, -5 }, .high = { 60, 60, 15 }, .area = 4000, .instance_count = 2 * SAMPLE_PLANTS, .summary = ECO_NONE,
			.group_count = 2 },
		{ .low = { 45, -5, -5 }, .high = { 110, 60, 15 }, .area = 4000, .instance_count = 2 * SAMPLE_PLANTS, .summary = ECO_NONE,
			.group_first = 2, .group_count = 2 },
	};
	const struct eco_child children[] = { { .tile = 1, .scale = 1 }, { .tile = 2, .scale = 1 } };
	const struct eco_scene scene = { .name = "sample", .root = 0, .ground = s->ground.tiles, .ground_count = s->ground.count,
		.ground_columns = s->ground_columns, .ground_rows = s->ground_rows, .near_m = 0.05,
		.needs = ECO_NEED_POINTS | ECO_NEED_LINES | ECO_NEED_TRIANGLES | ECO_NEED_TEXTURES | ECO_NEED_GROUND | ECO_NEED_SUMMARIES,
		.plants = plants, .plant_count = 2, .anchors = anchors, .anchor_count = 2, .ladders = ladders, .ladder_count = 3,
		.curves = curves, .curve_count = 3, .tiles = tiles, .tile_count = 3, .groups = groups, .group_count = 4,
		.children = children, .child_count = 2, .palette = palette, .palette_count = 2, .places = s->places,
		.place_count = s->place_count };
	if (s->code)
		eco_pack_abort(s->writer);
	else
		s->code = eco_pack_commit(s->writer, &scene, "{\"name\":\"sample\"}", s->error);
}

/* `plain`: bushes have no texture (the one they have is no picture). */
static inline enum eco_code sample_pack_write_on(const char *path, const struct eco_ground *ground, bool plain, struct eco_error *error)
{
	struct sample s = { .error = error, .state = 7 };
	uint32_t instances[4];
	s.code = eco_pack_create(&s.writer, path, error);
	if (s.code)
		return s.code;
	s.places = malloc(4 * SAMPLE_PLANTS * ECO_PLACE_BYTES);
	uint32_t leaves = sample_leaves(&s);
	uint32_t wood = sample_simple(&s, sample_list(ECO_LIST_LINES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_WIDTH, 0), 300, 2);
	struct eco_list bush = sample_list(ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_UV, 1);
	if (!plain)
		bush.image = sample_image(&s);
	uint32_t bush_id = sample_simple(&s, bush, 400, 4);
	for (uint32_t i = 0; i < 4; i++)
		instances[i] = sample_instances(&s, 1 + i / 2, i % 2, i / 2 * 50.0);
	uint32_t summary = sample_simple(&s, sample_list(ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_COLOR | ECO_ATTR_PLANT, 0), 2000, 1);
	sample_ground(&s, ground);
	sample_commit(&s, instances, leaves, wood, bush_id, summary);
	free(s.places);
	lod_ground_tree_free(&s.ground);
	return s.code;
}

/* On 16 x 16 samples: one tile. */
static inline enum eco_code sample_pack_write(const char *path, struct eco_error *error)
{
	struct eco_ground ground = ground_make(16, 16, -8, -8, 8, sample_height);
	enum eco_code code = sample_pack_write_on(path, &ground, false, error);
	eco_ground_free(&ground);
	return code;
}

#endif
