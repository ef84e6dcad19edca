/* One walk over a plant's arrays serves both directions. Neighbouring corners are near each other: as
 * differences in varints they take a third of their memory, which a bounded cache is short of. */
#include "lod/build/plant.h"

#include <stdlib.h>
#include <string.h>

struct carrier { struct eco_writer *to; struct eco_reader *from; };      /* one of them is NULL */

/* New memory for what at least `least` bytes say; NULL without memory or where they are not there. */
static void *take(struct carrier *c, uint64_t least, uint64_t bytes)
{
	struct eco_reader *r = c->from;
	void *own = !r->failed && least <= r->size - r->at ? malloc((size_t)bytes + 1) : NULL;
	r->failed |= !own;
	return own;
}

/* An array at the pointer `place`, which a reader sets: it held that of the writer. */
static void carry(struct carrier *c, void *place, uint64_t count, size_t size)
{
	void **items = place;
	size_t bytes = (size_t)count * size;
	if (c->to) {
		eco_write_bytes(c->to, *items, bytes);
		return;
	}
	*items = take(c, bytes, bytes);
	if (*items)
		memcpy(*items, eco_read_bytes(c->from, bytes), bytes);
}

/* Rows of `stride` integers, each as its difference to the row before. An absent array stays absent. */
static void carry_rows(struct carrier *c, int32_t **place, uint64_t rows, uint32_t stride)
{
	uint64_t count = rows * stride;
	if (!*place)
		return;
	if (c->from)
		*place = take(c, count, count * sizeof **place);
	int32_t *values = *place;
	for (uint64_t i = 0; values && i < count; i++) {
		uint32_t before = i < stride ? 0 : (uint32_t)values[i - stride];
		if (c->to)
			eco_write_zigzag(c->to, (int32_t)((uint32_t)values[i] - before));
		else
			values[i] = (int32_t)((uint32_t)eco_read_zigzag(c->from) + before);
	}
}

static void carry_list(struct carrier *c, struct lod_list_draft *draft)
{
	struct eco_elements *e = &draft->elements;
	carry(c, &draft->ends, draft->end_count, sizeof *draft->ends);
	carry(c, &e->corners, e->element_count, sizeof *e->corners);
	carry_rows(c, &e->position, e->corner_count, 3);
	carry_rows(c, &e->exact, e->corner_count, 3);
	carry_rows(c, &e->uv, e->corner_count, 2);
	carry_rows(c, &e->extra, e->element_count, e->extra_count);
	carry_rows(c, &e->part, e->element_count, 1);
}

static void carry_arrays(struct carrier *c, struct lod_plant *p)
{
	carry(c, &p->anchors, p->plant.anchor_count, sizeof *p->anchors);
	carry(c, &p->ladders, p->ladder_count, sizeof *p->ladders);
	carry(c, &p->curves, p->curve_count, sizeof *p->curves);
	carry(c, &p->palette, p->palette_count, sizeof *p->palette);
	carry(c, &p->images, p->image_count, sizeof *p->images);
	carry(c, &p->lists, p->list_count, sizeof *p->lists);
	carry(c, &p->impostor, p->impostor_count, sizeof *p->impostor);
	p->list_count = p->lists ? p->list_count : 0;
	p->impostor_count = p->impostor ? p->impostor_count : 0;
	for (uint32_t i = 0; i < p->list_count; i++)
		carry_list(c, &p->lists[i]);
	for (uint32_t i = 0; i < p->impostor_count; i++)
		carry(c, &p->impostor[i].at, p->impostor[i].size, 1);
}

void lod_plant_write(struct eco_writer *w, const struct lod_plant *plant)
{
	struct lod_plant nameless = *plant;
	memset(nameless.plant.name, 0, sizeof nameless.plant.name);
	eco_write_bytes(w, &nameless, sizeof nameless);
	carry_arrays(&(struct carrier){ .to = w }, &nameless);
}

enum eco_code lod_plant_read(struct lod_plant *plant, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_reader r = { bytes, size, 0, false };
	*plant = (struct lod_plant){ 0 };
	if (size < sizeof *plant)
		return eco_fail(error, ECO_DAMAGED, "%zu bytes are no plant", size);
	memcpy(plant, eco_read_bytes(&r, sizeof *plant), sizeof *plant);
	carry_arrays(&(struct carrier){ .from = &r }, plant);
	if (!r.failed && r.at == r.size)
		return ECO_OK;
	lod_plant_free(plant);
	return eco_fail(error, ECO_DAMAGED, "a plant's bytes are cut off, or there is no memory for them");
}
