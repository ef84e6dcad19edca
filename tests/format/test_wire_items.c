/* Directories of bundles: whatever is written is read back the same, to the bit; what is alike takes few
 * bytes; damage does no harm. */
#include <math.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/format/wire_items.h"
#include "tests/support/unit_test.h"

#define ITEMS 60u
#define ARRAY_MOST 5u

/* An item with its arrays. */
struct whole {
	struct eco_wire_item item;
	struct eco_anchor anchors[ARRAY_MOST];
	struct eco_group groups[ARRAY_MOST];
	uint8_t colours[ARRAY_MOST][3];
	bool coloured;
};

static uint32_t below(uint64_t *state, uint32_t n) { return (uint32_t)(eco_random_next(state) % n); }

/* Any number, small ones and the edges of its range often. */
static uint32_t any(uint64_t *state)
{
	static const uint32_t edges[] = { 0, 1, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff };
	return below(state, 4) == 0 ? edges[below(state, 6)] : (uint32_t)(eco_random_next(state) >> below(state, 64));
}

static double any_real(uint64_t *state)
{
	static const double edges[] = { 0, -0.0, 1, -1, 0.1, 5e-324, 1.7976931348623157e308, INFINITY, NAN };
	uint64_t bits = eco_random_next(state);
	double v;
	memcpy(&v, &bits, sizeof v);
	return below(state, 3) == 0 ? edges[below(state, 9)] : below(state, 2) ? v
		: (double)(int32_t)any(state) / 1024;
}

static float any_float(uint64_t *state)
{
	uint32_t bits = any(state);
	float v;
	memcpy(&v, &bits, sizeof v);
	return isnan(v) ? 0.25f : v;
}

static struct eco_list any_list(uint64_t *state)
{
	struct eco_list l = { .kind = (uint8_t)below(state, 16), .coder = (uint8_t)below(state, 8),
		.attributes = (uint8_t)any(state), .level = (uint8_t)any(state), .owner = any(state),
		.group_count = below(state, ARRAY_MOST + 1), .unit_area = any_float(state),
		.palette_first = any(state), .palette_count = below(state, ARRAY_MOST + 1),
		.image = any(state), .partner = any(state), .columns = any(state), .element_count = any(state),
		.primitive_count = any(state), .chunk_count = below(state, 3) ? 1 : any(state) };
	for (int i = 0; i < 3; i++) {
		l.grid_origin[i] = any_real(state);
		l.grid_step[i] = i && below(state, 2) ? l.grid_step[i - 1] : any_real(state);
	}
	return l;
}

static void any_item(uint64_t *state, struct whole *w)
{
	memset(w, 0, sizeof *w);
	struct eco_wire_item *item = &w->item;
	item->kind = 1 + below(state, 3);
	item->id = any(state);
	if (item->kind == ECO_ITEM_CHUNK)        /* the only chunk of a list says nothing of its counts */
		item->id |= 1u << 30;
	if (item->kind == ECO_ITEM_LIST)
		item->id &= ~(1u << 30);
	if (item->kind == ECO_ITEM_PLANT) {
		item->plant.height_m = any_float(state);
		item->plant.anchor_first = any(state);
		item->plant.anchor_count = 1 + below(state, ARRAY_MOST);
		for (uint32_t i = below(state, 64); i > 0; i--)
			item->plant.name[i - 1] = (char)(1 + below(state, 255));
	} else if (item->kind == ECO_ITEM_LIST) {
		item->list = any_list(state);
	} else {
		item->ordinal = any(state);
		item->named = below(state, 2);
		item->chunk.element_count = any(state) >> 1;
		item->chunk.primitive_count = item->chunk.element_count / 2 * (1 + below(state, 2))
			+ (item->chunk.element_count + 1) / 2;
		item->chunk.size_bytes = any(state);
		for (int i = 0; item->named && i < 16; i++)
			item->chunk.id.bytes[i] = (uint8_t)any(state);
	}
	for (uint32_t i = 0; i < ARRAY_MOST; i++) {
		w->anchors[i] = (struct eco_anchor){ { any_float(state), any_float(state), 0.5f }, 2 };
		w->groups[i] = (struct eco_group){ .plant = any(state), .count = 1 + (any(state) >> 1) };
		for (int c = 0; c < 3; c++)
			w->colours[i][c] = (uint8_t)any(state);
	}
}

/* Codes an item and its arrays, either way. */
static void code(struct eco_range *r, struct eco_wire_items *items, struct whole *w)
{
	eco_wire_item_code(r, items, &w->item);
	const struct eco_list *l = &w->item.list;
	if (items->bad)
		return;
	if (w->item.kind == ECO_ITEM_PLANT)
		for (uint32_t i = 0; i < w->item.plant.anchor_count && i < ARRAY_MOST; i++)
			eco_wire_anchor_code(r, items, &w->anchors[i]);
	if (w->item.kind != ECO_ITEM_LIST)
		return;
	for (uint32_t i = 0; i < l->group_count && i < ARRAY_MOST; i++)
		eco_wire_group_code(r, items, i, &w->groups[i]);
	w->coloured = l->palette_count && !eco_wire_same_palette(items, l);
	for (uint32_t i = 0; w->coloured && i < l->palette_count && i < ARRAY_MOST; i++)
		eco_wire_colour_code(r, w->colours[i]);
}

static uint32_t write_all(struct eco_writer *w, struct whole *all, uint32_t count)
{
	struct eco_wire_items items;
	struct eco_range range;
	struct whole end = { .item.kind = ECO_ITEM_END };
	eco_wire_items_start(&items);
	eco_range_write(&range, w);
	for (uint32_t i = 0; i < count; i++)
		code(&range, &items, &all[i]);
	code(&range, &items, &end);
	assert_false(items.bad);
	return eco_range_end(&range);
}

/* Returns whether the bytes are a directory of at most ITEMS items. */
static bool read_all(const uint8_t *bytes, size_t size, uint32_t zeros, struct whole *all, uint32_t *count)
{
	struct eco_wire_items items;
	struct eco_range range;
	eco_wire_items_start(&items);
	eco_range_read(&range, bytes, size);
	for (*count = 0; *count <= ITEMS; ++*count) {
		struct whole *w = &all[*count];
		memset(w, 0, sizeof *w);
		code(&range, &items, w);
		if (items.bad || !eco_wire_items_bits(&range))
			return false;
		if (w->item.kind == ECO_ITEM_END)
			return eco_range_end(&range) == zeros;
	}
	return false;
}

static void assert_same_item(const struct whole *a, const struct whole *b)
{
	assert_int_equal(a->item.kind, b->item.kind);
	assert_int_equal(a->item.id, b->item.id);
	assert_memory_equal(&a->item.plant, &b->item.plant, sizeof a->item.plant);
	assert_memory_equal(&a->item.list, &b->item.list, sizeof a->item.list);
	assert_int_equal(a->item.named, b->item.named);
	assert_int_equal(a->coloured, b->coloured);
	for (uint32_t i = 0; i < a->item.plant.anchor_count && i < ARRAY_MOST; i++)
		assert_memory_equal(&a->anchors[i], &b->anchors[i], sizeof *a->anchors);
	for (uint32_t i = 0; i < a->item.list.group_count && i < ARRAY_MOST; i++)
		assert_true(a->groups[i].plant == b->groups[i].plant && a->groups[i].count == b->groups[i].count);
	for (uint32_t i = 0; a->coloured && i < a->item.list.palette_count && i < ARRAY_MOST; i++)
		assert_memory_equal(a->colours[i], b->colours[i], sizeof *a->colours);
	if (a->item.kind != ECO_ITEM_CHUNK)
		return;
	assert_int_equal(a->item.chunk.size_bytes, b->item.chunk.size_bytes);
	assert_memory_equal(&a->item.chunk.id, &b->item.chunk.id, sizeof a->item.chunk.id);
	assert_int_equal(a->item.ordinal, b->item.ordinal);
	assert_int_equal(a->item.chunk.element_count, b->item.chunk.element_count);
	assert_int_equal(a->item.chunk.primitive_count, b->item.chunk.primitive_count);
}

static struct whole all[ITEMS + 1], back[ITEMS + 1];

UNIT_TEST(items_are_read_as_they_were_written)
{
	for (uint64_t seed = 1; seed <= 400; seed++) {
		struct eco_writer w = { 0 };
		uint64_t state = seed;
		uint32_t count = below(&state, ITEMS), got;
		for (uint32_t i = 0; i < count; i++)
			any_item(&state, &all[i]);
		uint32_t zeros = write_all(&w, all, count);
		assert_true(read_all(w.bytes, w.size, zeros, back, &got));
		assert_int_equal(got, count);
		for (uint32_t i = 0; i < count; i++)
			assert_same_item(&all[i], &back[i]);
		eco_writer_free(&w);
	}
}
