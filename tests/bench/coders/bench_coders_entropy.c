#include "tests/bench/coders/bench_coders_entropy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/splat.h"

#define FEW 16u                  /* values for each different one, for their own entropy to mean something */

const char *const coders_part_names[CODERS_PARTS] = { "position", "corners", "texture", "colour", "width",
	"plant", "tile", "yaw", "scale", "growth", "size", "axes", "turn", "opacity" };

enum coders_part coders_part_of(const struct eco_list *list, uint32_t corners, uint32_t column)
{
	static const struct { uint32_t attribute; enum coders_part parts[8]; uint32_t count; } extra[] = {
		{ ECO_ATTR_COLOR, { CODERS_COLOR }, 1 }, { ECO_ATTR_WIDTH, { CODERS_WIDTH }, 1 },
		{ ECO_ATTR_PLANT, { CODERS_PLANT, CODERS_TILE }, 2 },
		{ ECO_ATTR_PLACE, { CODERS_YAW, CODERS_SCALE }, 2 },
		{ ECO_ATTR_GROWTH, { CODERS_GROWTH }, 1 },
		{ ECO_ATTR_SIZE, { CODERS_SIZE }, 1 },
		{ ECO_ATTR_SPLAT, { CODERS_AXES_OF, CODERS_AXES_OF, CODERS_AXES_OF, CODERS_TURN, CODERS_TURN,
			CODERS_TURN, CODERS_OPACITY }, ECO_SPLAT_CODES } };
	uint32_t at = 3 * corners, texture = list->attributes & ECO_ATTR_UV ? 2 * corners : 0;
	if (column < at + texture)
		return column < 3 ? CODERS_POSITION : column < at ? CODERS_CORNERS : CODERS_TEXTURE;
	at += texture;
	for (size_t i = 0; i < sizeof extra / sizeof *extra; i++) {
		uint32_t count = list->attributes & extra[i].attribute ? extra[i].count : 0;
		if (column < at + count)
			return extra[i].parts[column - at];
		at += count;
	}
	return CODERS_POSITION;
}

static bool add(struct coders_values *to, int32_t value)
{
	if (to->count == to->room) {
		size_t room = 2 * to->room + 64;
		int32_t *at = realloc(to->at, room * sizeof *at);
		if (!at)
			return false;
		to->at = at;
		to->room = room;
	}
	to->at[to->count++] = value;
	return true;
}

static bool add_column(struct coders_entropy *e, const struct coders_table *t, uint32_t column)
{
	const int32_t *v = t->values + column;
	int32_t before = v[0];
	for (uint32_t i = 0; i < t->rows; i++)
		before = v[(size_t)t->columns * i] < before ? v[(size_t)t->columns * i] : before;
	for (uint32_t i = 0; i < t->rows; i++) {
		int32_t value = v[(size_t)t->columns * i];
		int32_t step = (int32_t)((uint32_t)value - (uint32_t)before);
		if (!add(&e->plain[t->corners][column], value) || !add(&e->step[t->corners][column], step))
			return false;
		before = value;
	}
	return true;
}

bool coders_entropy_add(struct coders_entropy *e, const struct eco_list *list, const struct coders_set *set)
{
	for (uint32_t i = 0; i < set->count; i++) {
		const struct coders_table *t = &set->tables[i];
		for (uint32_t k = 0; k < t->columns - t->known; k++) {
			e->part[t->corners][k] = (uint8_t)coders_part_of(list, t->corners, k);
			if (!add_column(e, t, k))
				return false;
		}
	}
	return true;
}

static int compare_values(const void *a, const void *b)
{
	int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return x < y ? -1 : x > y;
}

static double cost(double count, double all)
{
	return count > 0 ? -count * log2(count / all) : 0;
}

static double bits_of(struct coders_values *v)
{
	double own = 0, sizes = 0, class[64] = { 0 };
	size_t different = 0;
	if (!v->count)
		return 0;
	qsort(v->at, v->count, sizeof *v->at, compare_values);
	for (size_t i = 0, end; i < v->count; i = end, different++) {
		for (end = i + 1; end < v->count && v->at[end] == v->at[i]; end++)
			;
		uint32_t size = v->at[i] < 0 ? 0u - (uint32_t)v->at[i] : (uint32_t)v->at[i],
			bits = size ? 32u - (uint32_t)__builtin_clz(size) : 0;
		own += cost((double)(end - i), (double)v->count);
		class[bits + (v->at[i] < 0 ? 32 : 0)] += (double)(end - i);
		sizes += bits ? (double)(end - i) * (bits - 1) : 0;
	}
	for (int i = 0; i < 64; i++)
		sizes += cost(class[i], (double)v->count);
	return different * FEW <= v->count ? fmin(own, sizes) : sizes;
}

void coders_entropy_bits(struct coders_entropy *e, double bits[CODERS_PARTS])
{
	memset(bits, 0, CODERS_PARTS * sizeof *bits);
	for (uint32_t c = 0; c <= ECO_CORNERS_MAX; c++)
		for (uint32_t k = 0; k < CODERS_COLUMNS_MAX; k++)
			bits[e->part[c][k]] += fmin(bits_of(&e->plain[c][k]), bits_of(&e->step[c][k]));
}

void coders_entropy_free(struct coders_entropy *e)
{
	for (uint32_t c = 0; c <= ECO_CORNERS_MAX; c++)
		for (uint32_t k = 0; k < CODERS_COLUMNS_MAX; k++) {
			free(e->plain[c][k].at);
			free(e->step[c][k].at);
		}
}
