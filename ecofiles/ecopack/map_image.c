/* The ground's image on the map: squares as make reads them, no finer than the map's pixels. */
#include "ecofiles/ecopack/map.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/progress.h"
#include "ecofiles/import/ground/ground_image_import.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
#define SQUARES_MAX 1024u

struct picture {
	const struct map *m;
	struct eco_ground_image_reader *reader;
	uint8_t *rgba, *square;      /* the map's pixels; a square's texels */
};

/* The texels under the middles of the map's pixels. */
static void paint(const struct picture *p, const struct eco_list *list)
{
	const struct map *m = p->m;
	uint32_t width = (uint32_t)m->width, height = (uint32_t)m->height;
	double texel_m = list->grid_step[0];
	for (uint32_t y = 0; y < height; y++) {
		double north = m->view.high[1] - (y + 0.5) / m->scale,
			row = SIDE - (north - list->grid_origin[1]) / texel_m;
		if (!(row >= 0 && row < SIDE))
			continue;
		for (uint32_t x = 0; x < width; x++) {
			double east = m->view.low[0] + (x + 0.5) / m->scale,
				column = (east - list->grid_origin[0]) / texel_m;
			if (column >= 0 && column < SIDE)
				memcpy(p->rgba + 4 * ((size_t)y * width + x),
					p->square + 4 * ((size_t)row * SIDE + (size_t)column), 4);
		}
	}
}

static enum eco_code read_square(const struct picture *p, struct eco_list list, bool is_root)
{
	struct eco_ground_image_tile tile = { .rgba = p->square };
	enum eco_code code = eco_ground_image_next(p->reader, &tile, p->m->error);
	if (code)
		return code;
	if (is_root) {
		memcpy(list.grid_origin, tile.low, sizeof tile.low);
		list.grid_step[0] = list.grid_step[1] = tile.texel_m;
	}
	for (uint32_t q = 0; q < 4 && tile.split && !code; q++) {
		struct eco_list quarter = list;
		eco_ground_image_quarter(&quarter, q);
		code = read_square(p, quarter, false);
	}
	if (!tile.split && !code)
		paint(p, &list);
	return code;
}

enum eco_code map_read_image(struct map *m, uint8_t **rgba)
{
	const struct eco_source *source = &m->sources.items[0];
	struct eco_ground_image_source image = source->ground_image;
	struct eco_ground_image_options options = { .source = &image, .scene_crs = source->crs,
		.origin = { source->origin[0], source->origin[1], source->origin[2] },
		.low = { m->bounds[0].low[0], m->bounds[0].low[1] },
		.high = { m->bounds[0].high[0], m->bounds[0].high[1] }, .tiles_max = SQUARES_MAX,
		.warn = main_note_text };
	struct eco_error missed = { .code = ECO_OK }, *error = m->error;
	*rgba = NULL;
	if (!image.file_count)
		return ECO_OK;
	if (!main_progress("drawing", "the ground's image", 0.1))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	image.texel_m = image.texel_m > 1 / m->scale ? image.texel_m : 1 / m->scale;
	struct picture p = { .m = m, .rgba = calloc((size_t)m->width * (size_t)m->height, 4),
		.square = malloc(ECO_GROUND_IMAGE_BYTES) };
	enum eco_code code = p.rgba && p.square ? eco_ground_image_open(&p.reader, &options, error)
		: map_no_memory(m);
	if (!code) {
		m->error = &missed;      /* what the child says comes first */
		code = read_square(&p, (struct eco_list){ .kind = ECO_LIST_GROUND_IMAGE }, true);
		m->error = error;
		enum eco_code verdict = eco_ground_image_close(p.reader, error);
		if (!verdict && code)
			eco_fail(error, code, "%s", missed.text);
		code = verdict ? verdict : code;
	}
	free(p.square);
	*rgba = code ? NULL : p.rgba;
	if (code)
		free(p.rgba);
	return code;
}
