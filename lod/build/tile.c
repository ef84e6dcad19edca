/* Quadtree, top down: a tile sorts its items into quarters and recurses into those that are not empty. A tile
 * with all items in one quarter is skipped, as it would have a single child. If the southern and the northern
 * half can each be a leaf, the tile is cut into these two: leaves of an even forest are then at least half
 * full, and a plant costs the same wherever their number lies between two powers of four. Items at one place
 * are cut by their number: each request that opens a tile walks through all of its plants. */
#include "lod/build/tile.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "lod/build/summary.h"

#define BOUND_STEPS 256.0        /* of a leaf, by which its bounds may be wider */
#define DEPTH_MAX 60             /* halvings: beyond it doubles do not separate positions */

struct square { double x, y, side; };        /* south-west corner */

struct build {
	struct lod_tiles *tiles;
	const struct lod_tile_item *items;
	uint32_t most, node_capacity;
	uint32_t *scratch;           /* as long as order */
};

static uint32_t add_node(struct build *b, uint32_t first, uint32_t count)
{
	struct lod_tiles *t = b->tiles;
	eco_grow(&t->nodes, &b->node_capacity, t->node_count, sizeof *t->nodes);
	t->nodes[t->node_count] = (struct lod_tile_node){ .item_first = first, .item_count = count };
	return t->node_count++;
}

static uint32_t quarter_of(const struct lod_tile_item *item, double x, double y)
{
	return (item->at[0] >= x ? 1 : 0) + (item->at[1] >= y ? 2 : 0);
}

/* Sorts the range by quarter, stable; ends[q] is the end of quarter q. */
static void part(struct build *b, uint32_t first, uint32_t count, double x, double y, uint32_t ends[4])
{
	uint32_t *order = b->tiles->order + first, starts[4] = { 0 }, sizes[4] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		sizes[quarter_of(&b->items[order[i]], x, y)]++;
	for (int q = 1; q < 4; q++)
		starts[q] = starts[q - 1] + sizes[q - 1];
	for (int q = 0; q < 4; q++)
		ends[q] = first + starts[q] + sizes[q];
	for (uint32_t i = 0; i < count; i++)
		b->scratch[starts[quarter_of(&b->items[order[i]], x, y)]++] = order[i];
	memcpy(order, b->scratch, count * sizeof *order);
}

/* ---- Leaves ---- */

struct sorting { uint32_t plant, item; };
ECO_ORDER_TWO(by_plant, struct sorting, ->plant, ->item)

static void sort_leaf(struct build *b, uint32_t first, uint32_t count)
{
	struct sorting *sorting = eco_alloc(count, sizeof *sorting);
	uint32_t *order = b->tiles->order + first;
	for (uint32_t i = 0; i < count; i++)
		sorting[i] = (struct sorting){ b->items[order[i]].plant, order[i] };
	if (count > 1)
		qsort(sorting, count, sizeof *sorting, by_plant);
	for (uint32_t i = 0; i < count; i++)
		order[i] = sorting[i].item;
	free(sorting);
}

/* Bounds of few bits, as an index of a published scene holds those of all tiles. */
static void widen(struct lod_tile_node *node)
{
	double extent = 0;
	for (int i = 0; i < 3; i++)
		extent = fmax(extent, node->high[i] - node->low[i]);
	double step = extent > 0 ? lod_power_below(extent / BOUND_STEPS) : 0;
	for (int i = 0; i < 3 && step > 0; i++) {
		node->low[i] = floor(node->low[i] / step) * step;
		node->high[i] = ceil(node->high[i] / step) * step;
	}
}

static void hold_items(struct build *b, struct lod_tile_node *node)
{
	for (int i = 0; i < 3; i++) {
		node->low[i] = node->item_count ? INFINITY : 0;
		node->high[i] = node->item_count ? -INFINITY : 0;
	}
	for (uint32_t k = 0; k < node->item_count; k++) {
		const struct lod_tile_item *item = &b->items[b->tiles->order[node->item_first + k]];
		for (int i = 0; i < 3; i++) {
			node->low[i] = fmin(node->low[i], item->at[i] - (i < 2 ? item->reach : item->below));
			node->high[i] =
				fmax(node->high[i], item->at[i] + (i < 2 ? item->reach : item->above));
		}
	}
	widen(node);
}

/* ---- The tree ---- */

static bool few(const struct build *b, uint32_t first, uint32_t count)
{
	uint64_t sum = 0;
	if (count <= 1)
		return true;
	for (uint32_t i = first; i < first + count && sum <= b->most; i++)
		sum += b->items[b->tiles->order[i]].weight > 1 ? b->items[b->tiles->order[i]].weight : 1;
	return sum <= b->most;
}

/* Items that no square separates, in equal parts, plant by plant. */
static void part_evenly(struct build *b, uint32_t first, uint32_t count, uint32_t ends[4])
{
	sort_leaf(b, first, count);
	for (uint32_t q = 0; q < 4; q++)
		ends[q] = first + (uint32_t)((uint64_t)count * (q + 1) / 4);
}

static uint32_t split(struct build *b, uint32_t first, uint32_t count, struct square square, int depth)
{
	uint32_t ends[4];
	/* skip squares with all items in one quarter */
	for (;; depth++) {
		if (few(b, first, count)) {
			uint32_t leaf = add_node(b, first, count);
			sort_leaf(b, first, count);
			hold_items(b, &b->tiles->nodes[leaf]);
			return leaf;
		}
		if (depth >= DEPTH_MAX) {
			part_evenly(b, first, count, ends);
			break;
		}
		double half = square.side / 2;
		part(b, first, count, square.x + half, square.y + half, ends);
		int only = -1;
		for (int q = 0; q < 4; q++)
			if (ends[q] - (q ? ends[q - 1] : first) == count)
				only = q;
		if (only < 0)
			break;
		square = (struct square){ square.x + (only & 1 ? half : 0), square.y + (only & 2 ? half : 0),
			half };
	}
	/* quarters instead of halves would be twice as many lists, half as long */
	bool halves = few(b, first, ends[1] - first) && few(b, ends[1], first + count - ends[1]);
	if (halves) {
		ends[0] = ends[1];
		ends[2] = ends[3];
	}
	uint32_t node = add_node(b, first, count), begin = first;
	for (int q = 0; q < 4; begin = ends[q++]) {
		if (ends[q] == begin)
			continue;
		double half = square.side / 2;
		struct square quarter = { square.x + (q & 1 ? half : 0), square.y + (q & 2 ? half : 0),
			half };
		uint32_t child = split(b, begin, ends[q] - begin, halves ? square : quarter, depth + 1);
		struct lod_tile_node *n = &b->tiles->nodes[node], *c = &b->tiles->nodes[child];
		for (int i = 0; i < 3; i++) {
			n->low[i] = n->child_count ? fmin(n->low[i], c->low[i]) : c->low[i];
			n->high[i] = n->child_count ? fmax(n->high[i], c->high[i]) : c->high[i];
		}
		n->child[n->child_count++] = child;
	}
	return node;
}

static struct square square_around(const struct lod_tile_item *items, uint32_t count)
{
	double low[2] = { 0, 0 }, high[2] = { 0, 0 };
	for (uint32_t k = 0; k < count; k++) {
		for (int i = 0; i < 2; i++) {
			assert(isfinite(items[k].at[i]));
			low[i] = k ? fmin(low[i], items[k].at[i]) : items[k].at[i];
			high[i] = k ? fmax(high[i], items[k].at[i]) : items[k].at[i];
		}
	}
	return (struct square){ low[0], low[1], fmax(high[0] - low[0], high[1] - low[1]) };
}

void lod_tiles_build(struct lod_tiles *tiles, const struct lod_tile_item *items, uint32_t count, uint32_t most)
{
	assert(most >= 1);
	*tiles = (struct lod_tiles){ .order = eco_alloc((size_t)count + 1, sizeof *tiles->order) };
	struct build b = { .tiles = tiles, .items = items, .most = most,
		.scratch = eco_alloc((size_t)count + 1, sizeof *b.scratch) };
	for (uint32_t i = 0; i < count; i++)
		tiles->order[i] = i;
	split(&b, 0, count, square_around(items, count), 0);
	free(b.scratch);
}

void lod_tiles_free(struct lod_tiles *tiles)
{
	free(tiles->nodes);
	free(tiles->order);
	*tiles = (struct lod_tiles){ 0 };
}
