/* Points that are evenly spread for any number of them: a progressive blue-noise set on a square that
 * repeats without seams.
 *
 * The most crowded random candidate is removed until the wanted number is left, and again for each halving
 * of that number. The reversed order of removal is the order of the set (Yuksel 2015, sample elimination,
 * with its progressive ordering). */
#include "ecofiles/import/places/scatter_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"

#define CANDIDATES (4 * ECO_BLUE_NOISE_POINTS)
#define SIDE 65536.0
#define CELLS_MOST 128u

struct field {
	uint16_t (*at)[2];
	uint32_t count;              /* of the candidates in use */
	uint32_t cells, *cell_first, *member;        /* cells * cells + 1, count */
	double reach;                /* distance beyond which two points do not crowd each other */
	double *weight;              /* how crowded each point is */
	uint32_t *heap, *place, heap_count;          /* most crowded first; position of each point in it */
};

/* Distance on a square that repeats: the shorter way. */
static double distance(const uint16_t a[2], const uint16_t b[2])
{
	double x = (int16_t)(uint16_t)(a[0] - b[0]), y = (int16_t)(uint16_t)(a[1] - b[1]);
	return sqrt(x * x + y * y);
}

static double crowding(const struct field *f, uint32_t a, uint32_t b)
{
	double near = 1 - distance(f->at[a], f->at[b]) / f->reach;
	if (near <= 0)
		return 0;
	near *= near;
	near *= near;
	return near * near;
}

static uint32_t cell_of(const struct field *f, const uint16_t at[2])
{
	return (uint32_t)at[1] * f->cells / 65536 * f->cells + (uint32_t)at[0] * f->cells / 65536;
}

static void fill_cells(struct field *f)
{
	memset(f->cell_first, 0, sizeof *f->cell_first * (f->cells * f->cells + 1));
	for (uint32_t i = 0; i < f->count; i++)
		f->cell_first[cell_of(f, f->at[i]) + 1]++;
	for (uint32_t c = 0; c < f->cells * f->cells; c++)
		f->cell_first[c + 1] += f->cell_first[c];
	for (uint32_t i = f->count; i-- > 0;)
		f->member[--f->cell_first[cell_of(f, f->at[i]) + 1]] = i;
	/* counting moved every bound one cell down: undo it */
	memmove(f->cell_first, f->cell_first + 1, sizeof *f->cell_first * (f->cells * f->cells));
	f->cell_first[f->cells * f->cells] = f->count;
}

/* ---- A heap of the points left ---- */

static bool before(const struct field *f, uint32_t a, uint32_t b)
{
	return f->weight[a] != f->weight[b] ? f->weight[a] > f->weight[b] : a < b;
}

static void set(struct field *f, uint32_t slot, uint32_t point)
{
	f->heap[slot] = point;
	f->place[point] = slot;
}

static void sink(struct field *f, uint32_t slot)
{
	uint32_t point = f->heap[slot];
	for (uint32_t child; (child = 2 * slot + 1) < f->heap_count; slot = child) {
		if (child + 1 < f->heap_count && before(f, f->heap[child + 1], f->heap[child]))
			child++;
		if (before(f, point, f->heap[child]))
			break;
		set(f, slot, f->heap[child]);
	}
	set(f, slot, point);
}

/* Build: adds up how its neighbours crowd `gone`; else subtracts from its neighbours how it crowded them. */
static void relieve(struct field *f, uint32_t gone, bool build)
{
	uint32_t x = (uint32_t)f->at[gone][0] * f->cells / 65536,
		y = (uint32_t)f->at[gone][1] * f->cells / 65536;
	for (uint32_t dy = f->cells - 1; dy <= f->cells + 1; dy++)
		for (uint32_t dx = f->cells - 1; dx <= f->cells + 1; dx++) {
			uint32_t cell = (y + dy) % f->cells * f->cells + (x + dx) % f->cells;
			for (uint32_t i = f->cell_first[cell]; i < f->cell_first[cell + 1]; i++) {
				uint32_t other = f->member[i];
				if (other == gone || f->place[other] == UINT32_MAX)
					continue;
				if (build) {
					f->weight[gone] += crowding(f, gone, other);
				} else {
					f->weight[other] -= crowding(f, gone, other);
					sink(f, f->place[other]);
				}
			}
		}
}

/* Removes points until `wanted` are left. Removed points lie behind these, the last removed first. */
static void eliminate(struct field *f, uint32_t wanted, uint16_t (*scratch)[2])
{
	f->reach = 2 * SIDE * sqrt(1 / (2 * sqrt(3.0) * wanted));
	f->cells = (uint32_t)(SIDE / f->reach);
	f->cells = f->cells < 3 ? 3 : f->cells > CELLS_MOST ? CELLS_MOST : f->cells;
	fill_cells(f);
	f->heap_count = f->count;
	for (uint32_t i = 0; i < f->count; i++)
		set(f, i, i);
	for (uint32_t i = 0; i < f->count; i++) {
		f->weight[i] = 0;
		relieve(f, i, true);
	}
	for (uint32_t i = f->count / 2; i-- > 0;)
		sink(f, i);
	while (f->heap_count > wanted) {
		uint32_t gone = f->heap[0];
		memcpy(scratch[f->heap_count - 1], f->at[gone], sizeof *scratch);
		f->place[gone] = UINT32_MAX;
		if (--f->heap_count > 0) {
			set(f, 0, f->heap[f->heap_count]);
			sink(f, 0);
		}
		relieve(f, gone, false);
	}
	uint32_t left = 0;
	for (uint32_t i = 0; i < f->count; i++)
		if (f->place[i] != UINT32_MAX)
			memcpy(scratch[left++], f->at[i], sizeof *scratch);
	memcpy(f->at, scratch, sizeof *scratch * f->count);
	f->count = wanted;
}

void eco_blue_noise(uint16_t points[ECO_BLUE_NOISE_POINTS][2])
{
	uint16_t (*at)[2] = eco_alloc(CANDIDATES, sizeof *at), (*scratch)[2] = eco_alloc(CANDIDATES,
		sizeof *scratch);
	struct field f =
		{ .at = at, .count = CANDIDATES,
			.cell_first = eco_alloc(CELLS_MOST * CELLS_MOST + 1, sizeof(uint32_t)),
			.member = eco_alloc(CANDIDATES, sizeof(uint32_t)),
			.weight = eco_alloc(CANDIDATES, sizeof(double)),
			.heap = eco_alloc(CANDIDATES, sizeof(uint32_t)),
			.place = eco_alloc(CANDIDATES, sizeof(uint32_t)) };
	for (uint32_t i = 0; i < CANDIDATES; i++) {
		uint64_t bits = eco_random(4096, i);
		at[i][0] = (uint16_t)bits;
		at[i][1] = (uint16_t)(bits >> 16);
	}
	/* each round orders the half that it removes */
	for (uint32_t wanted = ECO_BLUE_NOISE_POINTS; wanted >= 1; wanted /= 2)
		eliminate(&f, wanted, scratch);
	memcpy(points, at, sizeof *at * ECO_BLUE_NOISE_POINTS);
	free(at);
	free(scratch);
	free(f.cell_first);
	free(f.member);
	free(f.weight);
	free(f.heap);
	free(f.place);
}
