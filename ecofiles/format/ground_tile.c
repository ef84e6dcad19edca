#include "ecofiles/format/ground_tile.h"

bool eco_ground_size_fits(uint32_t columns, uint32_t rows, uint32_t margin)
{
	if (columns == 0 && rows == 0)
		return margin == 0;
	return margin <= ECO_GROUND_MARGIN_MAX && columns >= 2 * margin + 2 && rows >= 2 * margin + 2
		&& columns <= ECO_GROUND_SIDE_MAX && rows <= ECO_GROUND_SIDE_MAX;
}

static void span_of(struct eco_ground_span *s, uint32_t samples, uint8_t level, uint32_t index)
{
	uint32_t stride = 1u << level, side = ECO_GROUND_CELLS << level;
	uint32_t low = index * side, last = samples - 1, high = last - low > side ? low + side : last;
	uint32_t inner = (high - low + stride - 1) / stride + 1, before = low > 0;
	*s = (struct eco_ground_span){ .low = low, .high = high, .stride = stride, .inner = inner,
		.count = inner + before + (high < last), .before = before, .last = last };
}

void eco_ground_spans(struct eco_ground_span *x, struct eco_ground_span *y,
	const struct eco_ground_tile *tile, uint32_t columns, uint32_t rows)
{
	span_of(x, columns, tile->level, tile->column);
	span_of(y, rows, tile->level, tile->row);
}

uint32_t eco_ground_span_at(const struct eco_ground_span *s, uint32_t i)
{
	if (i < s->before)
		return s->low - s->stride;
	i -= s->before;
	uint64_t at = (uint64_t)s->low + (uint64_t)(i < s->inner ? i : i - s->inner) * s->stride;
	if (i < s->inner)
		return at < s->high ? (uint32_t)at : s->high;
	at = (uint64_t)s->high + s->stride;
	return at < s->last ? (uint32_t)at : s->last;
}

bool eco_ground_on_grid(const struct eco_ground_tile *tile, uint32_t columns, uint32_t rows)
{
	uint32_t side = ECO_GROUND_CELLS << (tile->level % ECO_GROUND_LEVELS);
	return tile->level < ECO_GROUND_LEVELS && columns >= 2 && rows >= 2 && columns <= ECO_GROUND_SIDE_MAX
		&& rows <= ECO_GROUND_SIDE_MAX && tile->column <= (columns - 2) / side
		&& tile->row <= (rows - 2) / side;
}

uint8_t eco_ground_root_level(uint32_t columns, uint32_t rows)
{
	uint32_t cells = (columns > rows ? columns : rows) - 1;
	uint8_t level = 0;
	while (level + 1u < ECO_GROUND_LEVELS && (ECO_GROUND_CELLS << level) < cells)
		level++;
	return level;
}

/* Index of the tile whose first sample (of the ring, or its own) is `first`. */
static uint32_t index_of(uint32_t first, uint8_t level)
{
	return first == 0 ? 0 : (first + (1u << level)) / (ECO_GROUND_CELLS << level);
}

enum eco_code eco_ground_tile_of(struct eco_ground_tile *tile, const struct eco_list *list,
	const struct eco_elements *e, uint32_t columns, uint32_t rows, uint32_t margin,
	struct eco_error *error)
{
	struct eco_ground_span x, y;
	*tile = (struct eco_ground_tile){ .level = list->level };
	if (list->level >= ECO_GROUND_LEVELS || e->element_count == 0 || e->corner_count != e->element_count)
		return eco_fail(error, ECO_DAMAGED, "ground of level %u with %u samples", list->level,
			e->element_count);
	tile->column = index_of(eco_ground_sample_at(e->position[0], columns, margin), list->level);
	tile->row = index_of(eco_ground_sample_at(e->position[1], rows, margin), list->level);
	if (!eco_ground_on_grid(tile, columns, rows))
		return eco_fail(error, ECO_DAMAGED, "a tile of ground outside the ground's %u x %u samples",
			columns, rows);
	eco_ground_spans(&x, &y, tile, columns, rows);
	if (list->columns != x.count || e->element_count != x.count * y.count)
		return eco_fail(error, ECO_DAMAGED, "a tile of ground with %u samples in rows of %u, it "
			"should have %u x %u", e->element_count, list->columns, x.count, y.count);
	for (uint32_t row = 0, i = 0; row < y.count; row++) {
		int32_t at_y = eco_ground_place(eco_ground_span_at(&y, row), rows, margin);
		for (uint32_t column = 0; column < x.count; column++, i++)
			if (e->position[3 * i] !=
					eco_ground_place(eco_ground_span_at(&x, column), columns, margin) ||
				e->position[3 * i + 1] != at_y)
				return eco_fail(error, ECO_DAMAGED,
					"sample %u of a tile of ground is not at its place", i);
	}
	return ECO_OK;
}

void eco_ground_image_quarter(struct eco_list *list, uint32_t quarter)
{
	for (int k = 0; k < 2; k++) {
		list->grid_step[k] /= 2;
		if (quarter >> k & 1)
			list->grid_origin[k] += ECO_GROUND_IMAGE_SIDE * list->grid_step[k];
	}
}
