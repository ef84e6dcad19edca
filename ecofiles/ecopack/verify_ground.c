/* Compares the table of ground with its lists: heights within bounds, samples that two levels share equal,
 * and no tile further from its children than its error. */
#include <math.h>
#include <stdio.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/ecopack/inspect.h"

struct decoded {
	const struct eco_ground_tile *tile;
	const struct eco_list *list;
	struct eco_ground_span x, y;
	uint32_t margin;
	struct eco_elements samples;
};

/* False: the chunk is damaged, which has been reported. */
static bool decode(struct decoded *d, const struct eco_pack *pack, uint32_t id)
{
	const struct eco_scene *s = &pack->scene;
	const uint8_t *bytes;
	size_t size;
	*d = (struct decoded){ .tile = &s->ground[id], .list = &s->lists[s->ground[id].list],
		.margin = s->ground_margin };
	eco_ground_spans(&d->x, &d->y, d->tile, s->ground_columns, s->ground_rows);
	const struct eco_chunk *chunk = &s->chunks[d->list->chunk_first];
	return eco_pack_payload(pack, d->list->chunk_first, &bytes, &size, NULL) == ECO_OK
		&& eco_chunk_decode(d->list, chunk, 0, bytes, size, &d->samples, NULL) == ECO_OK
		&& d->samples.element_count == d->x.count * d->y.count;
}

static double height_m(const struct decoded *d, uint32_t column, uint32_t row)
{
	size_t i = (size_t)(row + d->y.before) * d->x.count + column + d->x.before;
	return d->list->grid_origin[2] + d->samples.position[3 * i + 2] * d->list->grid_step[2];
}

static const char *check_samples(const struct decoded *d, const struct eco_scene *s)
{
	struct eco_ground_tile found;
	double slack = (double)d->tile->error_m + d->list->grid_step[2];
	if (eco_ground_tile_of(&found, d->list, &d->samples, s->ground_columns, s->ground_rows,
		s->ground_margin, NULL)
			!= ECO_OK || found.column != d->tile->column
		|| found.row != d->tile->row)
		return "its samples are not those of its column and row";
	for (uint32_t r = 0; r < d->y.inner; r++)
		for (uint32_t c = 0; c < d->x.inner; c++) {
			double z = height_m(d, c, r);
			if (z < (double)d->tile->low_m - slack || z > (double)d->tile->high_m + slack)
				return "it has heights beyond its bounds";
		}
	return NULL;
}

static double place(const struct decoded *d, const struct eco_ground_span *span, uint32_t sample)
{
	return eco_ground_place(sample, span->last + 1, d->margin);
}

/* Height of the tile's triangles at a sample of the full grid. */
static double surface_m(const struct decoded *d, uint32_t x, uint32_t y)
{
	uint32_t c = (x - d->x.low) / d->x.stride, r = (y - d->y.low) / d->y.stride;
	c = c < d->x.inner - 1 ? c : d->x.inner - 2;
	r = r < d->y.inner - 1 ? r : d->y.inner - 2;
	double x0 = place(d, &d->x, eco_ground_span_at(&d->x, c + d->x.before)),
		x1 = place(d, &d->x, eco_ground_span_at(&d->x, c + 1 + d->x.before));
	double y0 = place(d, &d->y, eco_ground_span_at(&d->y, r + d->y.before)),
		y1 = place(d, &d->y, eco_ground_span_at(&d->y, r + 1 + d->y.before));
	double u = (place(d, &d->x, x) - x0) / (x1 - x0), v = (place(d, &d->y, y) - y0) / (y1 - y0),
	       sw = height_m(d, c, r), ne = height_m(d, c + 1, r + 1);

	return u >= v ? sw + u * (height_m(d, c + 1, r) - sw) + v * (ne - height_m(d, c + 1, r))
		: sw + v * (height_m(d, c, r + 1) - sw) + u * (ne - height_m(d, c, r + 1));
}

static const char *check_child(const struct decoded *d, const struct decoded *child)
{
	/* the child's own rounding (lod/ground_choice.h) */
	double slack = (double)d->tile->error_m + (double)child->tile->error_m / 16
		+ 1e-6 * (1 + fabs((double)d->tile->high_m));
	for (uint32_t r = 0; r < child->y.inner; r++)
		for (uint32_t c = 0; c < child->x.inner; c++) {
			uint32_t x = eco_ground_span_at(&child->x, c + child->x.before),
				y = eco_ground_span_at(&child->y, r + child->y.before);
			if (fabs(surface_m(d, x, y) - height_m(child, c, r)) > slack)
				return "it is further from its children than its error says";
		}
	return NULL;
}

void inspect_verify_ground(const struct eco_pack *pack, void (*say)(void *ctx, const char *text), void *ctx)
{
	const struct eco_scene *s = &pack->scene;
	for (uint32_t i = 0; i < s->ground_count; i++) {
		struct decoded tile;
		const char *bad = decode(&tile, pack, i) ? check_samples(&tile, s) : NULL;
		char text[160];
		for (uint32_t k = 0; !bad && tile.samples.element_count > 0 && k < tile.tile->child_count;
				k++) {
			struct decoded child;
			if (decode(&child, pack, tile.tile->child_first + k))
				bad = check_child(&tile, &child);
			eco_elements_free(&child.samples);
		}
		eco_elements_free(&tile.samples);
		if (!bad)
			continue;
		snprintf(text, sizeof text, "ground tile %u (list %u): %s", i, s->ground[i].list, bad);
		say(ctx, text);
	}
}
