/* A binary heap: the greatest key first, among equal keys the least id, so that every machine pops the same
 * sequence. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct lod_heap_item { double key; uint32_t id; };       /* no NaN */

static inline bool lod_heap_before(struct lod_heap_item a, struct lod_heap_item b)
{
	return a.key != b.key ? a.key > b.key : a.id < b.id;
}

/* Restores a heap of `count` items after item `at` may have become worse. Logarithmic in count; does nothing
 * if at >= count. */
static inline void lod_heap_sift(struct lod_heap_item *heap, uint32_t count, uint32_t at)
{
	for (uint32_t child; (child = 2 * at + 1) < count; at = child) {
		if (child + 1 < count && lod_heap_before(heap[child + 1], heap[child]))
			child++;
		if (!lod_heap_before(heap[child], heap[at]))
			return;
		struct lod_heap_item better = heap[child];
		heap[child] = heap[at];
		heap[at] = better;
	}
}

/* Adds an item to a heap of `count`, which has room for it. Logarithmic in count. */
static inline void lod_heap_push(struct lod_heap_item *heap, uint32_t count, struct lod_heap_item item)
{
	for (; count > 0 && lod_heap_before(item, heap[(count - 1) / 2]); count = (count - 1) / 2)
		heap[count] = heap[(count - 1) / 2];
	heap[count] = item;
}

/* Makes a heap of any `count` items: the best is heap[0]. Linear. */
static inline void lod_heap_make(struct lod_heap_item *heap, uint32_t count)
{
	for (uint32_t i = count / 2; i-- > 0;)
		lod_heap_sift(heap, count, i);
}
