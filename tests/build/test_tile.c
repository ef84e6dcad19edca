/* Tiling: every thing in one leaf, bounds that hold bodies, leaves of few, order that a pack can rely on. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/random.h"
#include "lod/build/tile.h"
#include "tests/support/unit_test.h"

enum layout { SCATTERED, CLUSTERED, ONE_PLACE, ONE_LINE, FAR_AWAY };

static double unit(uint64_t seed, uint64_t n) { return eco_random_unit(eco_random(seed, n)); }

static void lay_out(struct lod_tile_item *items, uint32_t count, enum layout layout)
{
	for (uint32_t i = 0; i < count; i++) {
		double x = unit(1, i) * 100, y = unit(2, i) * 70;
		if (layout == CLUSTERED && i % 10) {
			x = 3 + x * 1e-4;
			y = 5 + y * 1e-4;
		}
		if (layout == ONE_PLACE)
			x = y = 17.25;
		if (layout == ONE_LINE)
			y = -4;
		if (layout == FAR_AWAY) {
			x += 4e6;
			y -= 5e6;
		}
		items[i] = (struct lod_tile_item){ .at = { x, y, unit(3, i) }, .reach = 0.1 + unit(4, i),
			.below = 0.01, .above = 2 * unit(5, i),
			.plant = i % 7 == 6 ? ECO_NONE : i % 3, .index = i };
	}
}

static void check_leaf(const struct lod_tiles *tiles, const struct lod_tile_node *node,
	const struct lod_tile_item *items, uint32_t *seen, uint32_t most)
{
	for (uint32_t k = node->item_first; k < node->item_first + node->item_count; k++) {
		const struct lod_tile_item *item = &items[tiles->order[k]];
		seen[tiles->order[k]]++;
		for (int i = 0; i < 3; i++) {
			assert_true(item->at[i] - (i < 2 ? item->reach : item->below) >= node->low[i]);
			assert_true(item->at[i] + (i < 2 ? item->reach : item->above) <= node->high[i]);
		}
		if (k > node->item_first)
			assert_true(items[tiles->order[k - 1]].plant <= item->plant);
	}
	double extent = 0;
	for (int i = 0; i < 3; i++)
		extent = fmax(extent, node->high[i] - node->low[i]);
	for (int i = 0; i < 3 && extent > 0; i++) {      /* steps of 1/512 of it at least */
		double step = exp2(floor(log2(extent)) - 9);
		assert_true(fmod(node->low[i], step) == 0 && fmod(node->high[i], step) == 0);
	}
	assert_true(node->item_count <= most);
}

static void check_inner(const struct lod_tiles *tiles, uint32_t id)
{
	const struct lod_tile_node *node = &tiles->nodes[id];
	uint32_t next = node->item_first;
	assert_true(node->child_count >= 2);
	for (uint32_t c = 0; c < node->child_count; c++) {
		const struct lod_tile_node *child = &tiles->nodes[node->child[c]];
		assert_true(node->child[c] > id);
		assert_int_equal(child->item_first, next);
		next += child->item_count;
		for (int i = 0; i < 3; i++) {
			assert_true(child->low[i] >= node->low[i]);
			assert_true(child->high[i] <= node->high[i]);
		}
	}
	assert_int_equal(next, node->item_first + node->item_count);
}

static void check(uint32_t count, uint32_t most, enum layout layout)
{
	FREED_MEMORY struct lod_tile_item *items = calloc(count + 1u, sizeof *items);
	uint32_t *seen = calloc(count + 1u, sizeof *seen), reached = 1;
	FREED(lod_tiles) tiles;
	lay_out(items, count, layout);
	lod_tiles_build(&tiles, items, count, most);
	assert_int_equal(tiles.nodes[0].item_count, count);
	for (uint32_t n = 0; n < tiles.node_count; n++) {
		reached += tiles.nodes[n].child_count;
		if (tiles.nodes[n].child_count == 0)
			check_leaf(&tiles, &tiles.nodes[n], items, seen, most);
		else
			check_inner(&tiles, n);
	}
	assert_int_equal(reached, tiles.node_count);
	for (uint32_t i = 0; i < count; i++)
		assert_int_equal(seen[i], 1);
	if (layout == SCATTERED && count > 4 * most)
		assert_true(tiles.node_count > count / most);
	free(seen);
}

UNIT_TEST(test_each_thing_in_one_leaf)
{
	static const uint32_t counts[] = { 0, 1, 2, 127, 128, 129, 1000, 5000 }, mosts[] = { 1, 4, 128 };
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
		for (size_t m = 0; m < sizeof mosts / sizeof *mosts; m++)
			for (int layout = SCATTERED; layout <= FAR_AWAY; layout++)
				check(counts[c], mosts[m], (enum layout)layout);
}

/* In the mean, of evenly scattered things, whatever their number. */
UNIT_TEST(test_leaves_are_not_nearly_empty)
{
	static struct lod_tile_item items[10000];
	for (uint32_t count = 129; count <= 10000; count += count / 8) {
		FREED(lod_tiles) tiles;
		uint32_t leaves = 0;
		lay_out(items, count, SCATTERED);
		for (uint32_t i = 0; i < count; i++)
			items[i].at[1] = unit(2, i) * 100;
		lod_tiles_build(&tiles, items, count, 128);
		for (uint32_t n = 0; n < tiles.node_count; n++)
			leaves += tiles.nodes[n].child_count == 0;
		assert_true(leaves * 50 <= count);
	}
}
