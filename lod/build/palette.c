#include "lod/build/palette.h"

#include <assert.h>
#include <string.h>

#include "lod/light.h"

#define BINS 32768u

struct tally { uint64_t weight, light[3]; };
struct box { uint32_t first, end; uint64_t weight; };

static uint32_t bin_of(const uint8_t rgb[3])
{
	return (uint32_t)(rgb[0] >> 3) << 10 | (uint32_t)(rgb[1] >> 3) << 5 | (uint32_t)(rgb[2] >> 3);
}

static uint32_t channel(uint32_t bin, int axis)
{
	return bin >> (10 - 5 * axis) & 31;
}

/* All colours if they are few enough: entry i is the i-th new one. */
static bool take_all(struct lod_palette *p, uint32_t most, const uint8_t (*rgb)[3], uint32_t count)
{
	p->count = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t k = 0;
		if (i > 0 && memcmp(rgb[i], rgb[i - 1], 3) == 0)
			continue;
		while (k < p->count && memcmp(p->rgb[k], rgb[i], 3) != 0)
			k++;
		if (k < p->count)
			continue;
		if (p->count == most)
			return false;
		memcpy(p->rgb[p->count++], rgb[i], 3);
	}
	return true;
}

/* The longest side of the box around bins [first, end), and its length in bins. */
static uint32_t longest_side(const uint16_t *bins, const struct box *box, int *axis)
{
	uint32_t most = 0;
	*axis = 0;
	for (int a = 0; a < 3; a++) {
		uint32_t low = 31, high = 0;
		for (uint32_t i = box->first; i < box->end; i++) {
			uint32_t c = channel(bins[i], a);
			low = c < low ? c : low;
			high = c > high ? c : high;
		}
		if (high - low > most) {
			most = high - low;
			*axis = a;
		}
	}
	return most;
}

/* Sorts the box's bins by one channel (a counting sort of 32 values). */
static void sort_box(uint16_t *bins, const struct box *box, int axis, uint16_t *scratch)
{
	uint32_t n = 0;
	for (uint32_t c = 0; c < 32; c++)
		for (uint32_t i = box->first; i < box->end; i++)
			if (channel(bins[i], axis) == c)
				scratch[n++] = bins[i];
	memcpy(bins + box->first, scratch, n * sizeof *bins);
}

/* Cuts the box at its median weight, never inside one value of the channel. */
static void cut(uint16_t *bins, const struct tally *tally, struct box *box, struct box *rest, int axis,
	uint16_t *scratch)
{
	uint64_t before = 0;
	uint32_t at = box->first;
	sort_box(bins, box, axis, scratch);
	while (at < box->end && (before + tally[bins[at]].weight <= box->weight / 2 || at == box->first
		|| channel(bins[at], axis) == channel(bins[at - 1], axis)))
		before += tally[bins[at++]].weight;
	if (at == box->end) {        /* the last value holds the median: cut before it */
		while (channel(bins[at - 1], axis) == channel(bins[box->end - 1], axis))
			before -= tally[bins[--at]].weight;
	}
	*rest = (struct box){ at, box->end, box->weight - before };
	*box = (struct box){ box->first, at, before };
}

void lod_palette_make(struct lod_palette *p, uint32_t most_colors, const uint8_t (*rgb)[3],
	const uint32_t *weights, uint32_t count, struct lod_arena *arena)
{
	assert(most_colors >= 1 && most_colors <= LOD_PALETTE_MAX);
	memset(p, 0, sizeof *p);
	p->exact = take_all(p, most_colors, rgb, count);
	if (p->exact)
		return;
	struct lod_arena_piece *mark = arena->last;
	struct tally *tally = lod_arena_take(arena, BINS, sizeof *tally);
	uint16_t *bins = lod_arena_take(arena, BINS, sizeof *bins),
		*scratch = lod_arena_take(arena, BINS, sizeof *scratch);
	struct box boxes[LOD_PALETTE_MAX] = { { 0 } };
	for (uint32_t i = 0; i < count; i++) {
		struct tally *t = &tally[bin_of(rgb[i])];
		uint64_t weight = weights[i] ? weights[i] : 1;
		t->weight += weight;
		for (int k = 0; k < 3; k++)
			t->light[k] += weight * lod_light_of[rgb[i][k]];
	}
	for (uint32_t b = 0; b < BINS; b++)
		if (tally[b].weight) {
			bins[boxes[0].end++] = (uint16_t)b;
			boxes[0].weight += tally[b].weight;
		}
	for (p->count = 1; p->count < most_colors; p->count++) {
		uint32_t best = 0;
		uint64_t most = 0;
		int axis, best_axis = 0;
		for (uint32_t i = 0; i < p->count; i++) {
			uint64_t score = longest_side(bins, &boxes[i], &axis) * boxes[i].weight;
			if (score > most) {
				most = score;
				best = i;
				best_axis = axis;
			}
		}
		if (most == 0)
			break;
		cut(bins, tally, &boxes[best], &boxes[p->count], best_axis, scratch);
	}
	memset(p->bin, 0xff, sizeof p->bin);
	for (uint32_t i = 0; i < p->count; i++) {
		struct tally sum = { 0 };
		for (uint32_t j = boxes[i].first; j < boxes[i].end; j++) {
			p->bin[bins[j]] = (uint16_t)i;
			sum.weight += tally[bins[j]].weight;
			for (int k = 0; k < 3; k++)
				sum.light[k] += tally[bins[j]].light[k];
		}
		for (int k = 0; k < 3; k++)
			p->rgb[i][k] = lod_light_byte((double)sum.light[k] / (double)sum.weight);
	}
	lod_arena_release(arena, mark);
}

static uint32_t nearest(const struct lod_palette *p, const uint8_t rgb[3])
{
	uint32_t best = 0, least = UINT32_MAX;
	for (uint32_t i = 0; i < p->count; i++) {
		uint32_t distance = 0;
		for (int k = 0; k < 3; k++) {
			int d = p->rgb[i][k] - rgb[k];
			distance += (uint32_t)(d * d);
		}
		if (distance < least) {
			least = distance;
			best = i;
		}
	}
	return best;
}

uint32_t lod_palette_index(const struct lod_palette *p, const uint8_t rgb[3])
{
	uint16_t bin = p->exact ? LOD_PALETTE_NONE : p->bin[bin_of(rgb)];
	return bin == LOD_PALETTE_NONE ? nearest(p, rgb) : bin;
}
