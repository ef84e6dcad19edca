/* Rows that something decoded before tells of: a splat's parent, a ground sample's neighbours. */
#include <stdlib.h>
#include <string.h>

#include "tests/bench/coders/bench_coders_kind.h"

/* ---- Splats ---- */

const struct eco_ladder *coders_splat_ladder(const struct eco_scene *scene, uint32_t list)
{
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		if (scene->ladders[i].points == list && eco_ladder_has_splats(scene, &scene->ladders[i]))
			return &scene->ladders[i];
	return NULL;
}

/* The splat of the level before that splat `i` stands for; UINT32_MAX for one of the first level. */
static uint32_t parent_of(const struct eco_ladder *ladder, uint32_t i)
{
	uint32_t level = 0;
	while (level + 1 < ladder->level_count && i >= ladder->level_end[level])
		level++;
	if (level == 0)
		return UINT32_MAX;
	uint32_t first = level > 1 ? ladder->level_end[level - 2] : 0, end = ladder->level_end[level - 1],
		many = (ladder->level_end[level] - end) / (end - first);
	return many ? first + (i - end) / many : UINT32_MAX;
}

bool coders_splat_rows(struct coders_set *set, const struct coders_set *whole,
	const struct eco_ladder *ladder, uint32_t first)
{
	struct coders_table *t = &set->tables[0];
	const struct coders_table *all = &whole->tables[0];
	uint32_t columns = t->columns;
	int32_t *values = calloc((size_t)t->rows * 2 * columns, sizeof *values);
	if (!values)
		return false;
	for (uint32_t i = 0; i < t->rows; i++) {
		uint32_t parent = parent_of(ladder, first + i);
		int32_t *row = values + (size_t)2 * columns * i;
		memcpy(row, t->values + (size_t)columns * i, columns * sizeof *row);
		if (parent != UINT32_MAX)
			memcpy(row + columns, all->values + (size_t)columns * parent, columns * sizeof *row);
		/* places and lengths less the parent's; colours, turns and opacity as they are */
		for (uint32_t k = 0; k < columns; k++)
			if (k < CODERS_AXES || (k >= CODERS_AXES + 1 && k < CODERS_AXES + 4))
				row[k] -= row[columns + k];
	}
	free(t->values);
	t->values = values;
	t->known = columns;
	t->columns = 2 * columns;
	return true;
}

/* ---- Ground ---- */

static int32_t height_at(const struct coders_table *t, uint32_t row)
{
	return t->values[(size_t)t->columns * row + 2];
}

/* As chunk_rows.h predicts heights. */
static int32_t ground_guess(const struct coders_table *t, uint32_t i, uint32_t columns)
{
	uint32_t column = i % columns;
	if (i == 0)
		return 0;
	if (column == 0)
		return height_at(t, i - columns);
	return i < columns ? height_at(t, i - 1)
		: height_at(t, i - 1) + height_at(t, i - columns) - height_at(t, i - columns - 1);
}

static uint32_t size_of(int32_t v)
{
	return v < 0 ? 0u - (uint32_t)v : (uint32_t)v;
}

/* Columns: x and y less those of the samples beside, the miss of the height, the known misses beside it. */
bool coders_ground_rows(struct coders_set *set, uint32_t columns)
{
	struct coders_table *t = &set->tables[0];
	const uint32_t wide = CODERS_AXES + 1;
	int32_t *values = calloc((size_t)t->rows * wide, sizeof *values);
	if (!values || set->count != 1 || t->columns != CODERS_AXES || !columns) {
		free(values);
		return false;
	}
	for (uint32_t i = 0; i < t->rows; i++) {
		const int32_t *from = t->values + (size_t)t->columns * i;
		int32_t *row = values + (size_t)wide * i;
		row[0] = from[0] - (i >= columns ? from[-(ptrdiff_t)(columns * t->columns)] : 0);
		row[1] = from[1] - (i % columns ? from[1 - (ptrdiff_t)t->columns] : 0);
		row[2] = from[2] - ground_guess(t, i, columns);
		uint32_t beside = i % columns ? size_of(row[2 - (ptrdiff_t)wide]) : 0;
		beside += i >= columns ? size_of(row[2 - (ptrdiff_t)(wide * columns)]) : 0;
		row[3] = (int32_t)(beside & INT32_MAX);
	}
	free(t->values);
	*t = (struct coders_table){ t->rows, wide, 1, 1, values };
	return true;
}
