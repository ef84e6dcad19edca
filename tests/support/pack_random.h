/* A random scene (scene_random.h) as an open pack with payloads: random bytes under true hashes. The server never decodes, so that
 * is a pack to it; ground, an image and textured triangles are added. */
#ifndef TESTS_PACK_RANDOM_H
#define TESTS_PACK_RANDOM_H

#include "ecofiles/format/view.h"
#include "ecofiles/format/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "tests/support/scene_random.h"

struct random_pack {
	struct random_scene r;
	struct eco_ground_tile ground[5];
	struct eco_pack pack;
	uint8_t *map;
};

/* A root and four tiles under it, from -50 to 150 m. */
static inline void random_pack_ground(struct random_pack *p)
{
	struct eco_scene *s = &p->r.scene;
	s->ground = p->ground;
	s->ground_count = 5;
	s->ground_columns = s->ground_rows = 2 * ECO_GROUND_CELLS + 1;
	for (uint32_t i = 0; i < 5; i++) {
		struct eco_ground_tile *t = &p->ground[i];
		struct eco_ground_span x, y;
		*t = (struct eco_ground_tile){ .level = i == 0, .column = i ? (i - 1) % 2 : 0, .row = i ? (i - 1) / 2 : 0, .child_count = i ? 0 : 4,
			.child_first = i ? 0 : 1, .error_m = i ? 0 : 0.5f, .low_m = -1, .high_m = 1 };
		eco_ground_spans(&x, &y, t, s->ground_columns, s->ground_rows);
		t->list = random_list(&p->r, ECO_LIST_GROUND, 1, ECO_NONE, ECO_NONE);
		struct eco_list *list = &p->r.lists[t->list];
		struct eco_chunk *chunk = &p->r.chunks[list->chunk_first];
		list->level = t->level;
		list->columns = x.count;
		list->primitive_count = list->element_count = chunk->primitive_count = chunk->element_count = x.count * y.count;
		chunk->size_bytes = 30;
		for (int k = 0; k < 2; k++) {
			list->grid_origin[k] = -50;
			list->grid_step[k] = 100.0 / ECO_GROUND_CELLS;
		}
	}
}

static inline void random_pack_lists(struct random_pack *p)
{
	static const uint8_t coders[] = { [ECO_LIST_TRIANGLES] = ECO_CODER_ELEMENTS, [ECO_LIST_LINES] = ECO_CODER_ELEMENTS,
		[ECO_LIST_POINTS] = ECO_CODER_KD, [ECO_LIST_INSTANCES] = ECO_CODER_ROWS, [ECO_LIST_GROUND] = ECO_CODER_ROWS,
		[ECO_LIST_IMAGE] = ECO_CODER_BYTES };
	struct eco_scene *s = &p->r.scene;
	random_pack_ground(p);
	uint32_t image = random_list(&p->r, ECO_LIST_IMAGE, 1, 0, ECO_NONE);
	for (uint32_t i = 0; i < s->list_count; i++) {
		struct eco_list *list = &p->r.lists[i];
		list->coder = coders[list->kind];
		if (list->kind == ECO_LIST_INSTANCES)
			list->attributes = ECO_ATTR_PLACE;
		if (list->kind == ECO_LIST_TRIANGLES && list->owner == 0)
			list->image = image;
	}
	for (uint32_t i = 0; i < s->tile_count; i++)
		if (s->tiles[i].summary != ECO_NONE)
			p->r.lists[s->tiles[i].summary].attributes = ECO_ATTR_PLANT;
}

/* Payloads of about `factor` times 10 bytes a primitive. Free with random_pack_free. */
static inline struct random_pack *random_pack_make(uint64_t seed, uint32_t nested, uint32_t factor)
{
	struct random_pack *p = malloc(sizeof *p);
	random_scene_make(&p->r, seed, nested);
	random_pack_lists(p);
	struct eco_scene *s = &p->r.scene;
	size_t size = 0;
	for (uint32_t i = 0; i < s->chunk_count; i++) {
		p->r.chunks[i].size_bytes = p->r.chunks[i].size_bytes * factor + 1 + random_below(&p->r, 20);
		p->r.chunks[i].offset = size;
		size += p->r.chunks[i].size_bytes;
	}
	p->map = malloc(size + 8);
	for (size_t i = 0; i < size; i += 8) {
		uint64_t bits = random_bits(&p->r);
		memcpy(p->map + i, &bits, 8);
	}
	for (uint32_t i = 0; i < s->chunk_count; i++)
		p->r.chunks[i].id = eco_chunk_hash(p->map + p->r.chunks[i].offset, p->r.chunks[i].size_bytes);
	strcpy(s->name, "random");
	s->needs = 511;
	p->pack = (struct eco_pack){ .scene = *s, .id = eco_chunk_hash(p->map, size), .map = p->map, .map_size = size };
	return p;
}

static inline void random_pack_free(struct random_pack *p)
{
	free(p->map);
	free(p);
}

/* A view of the random scene from somewhere in or around it. */
static inline struct eco_view random_view(struct random_scene *r)
{
	struct eco_view view = { .up = { 0, 0, 1 }, .fov_y_deg = random_real(r, 20, 90), .width = 200 + random_below(r, 800),
		.height = 200 + random_below(r, 600) };
	for (int i = 0; i < 2; i++) {
		view.eye[i] = random_real(r, -200, 250);
		view.target[i] = random_real(r, 0, 100);
	}
	view.eye[2] = random_real(r, 1, 80);
	return view;
}

#endif
