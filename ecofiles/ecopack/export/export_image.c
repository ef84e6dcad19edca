/* The ground's image as textures: for each tile of ground one of the part that lies on it, as fine as the
 * image is there where nothing finer follows, else as a viewer sees it before it refines. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/image.h"
#include "ecofiles/format/texture.h"

#define SIDE_LEAF 2048u
#define SIDE_COARSE 256u
#define SAME 1.001                       /* texels of such widths are alike */

struct painting {
	struct export *x;
	const double *low, *high;        /* of the tile, in the scene */
	double texel_m;
	uint32_t width, height;
	uint8_t *rgb;                    /* rows from the north */
};

static const struct eco_list *list_of(const struct painting *p, uint32_t tile)
{
	const struct eco_scene *s = &p->x->pack->scene;
	return &s->lists[s->ground_images[tile].list];
}

static bool touches(const struct painting *p, const struct eco_list *list)
{
	double side = eco_ground_image_side_m(list);
	for (int k = 0; k < 2; k++)
		if (list->grid_origin[k] >= p->high[k] || list->grid_origin[k] + side <= p->low[k])
			return false;
	return true;
}

/* The width of the finest texels on it; INFINITY: there are none. */
static double finest_m(const struct painting *p, uint32_t tile)
{
	uint32_t child = p->x->pack->scene.ground_images[tile].child_first;
	double finest = INFINITY;
	if (!touches(p, list_of(p, tile)))
		return INFINITY;
	for (uint32_t q = 0; q < 4 && child; q++)
		finest = fmin(finest, finest_m(p, child + q));
	return child ? finest : list_of(p, tile)->grid_step[0];
}

static void lay(const struct eco_texture_part *part, size_t from, uint8_t *to)
{
	const uint8_t *texel = part->texels + from * part->channels;
	int alpha = part->channels == 4 ? texel[3] : 255;
	for (int k = 0; k < 3; k++)
		to[k] = (uint8_t)((alpha * texel[k] + (255 - alpha) * export_grass[k] + 127) / 255);
}

/* Texels of the level that is about as wide, under the middles of the painting's. */
static void paint_level(struct painting *p, const struct eco_list *list)
{
	struct eco_texture_part part = { .texels = NULL };
	uint32_t levels = 1;
	while (levels < ECO_GROUND_IMAGE_LEVELS && eco_ground_image_texel_m(list, levels) > SAME * p->texel_m)
		levels++;
	double texel_m = eco_ground_image_texel_m(list, levels);
	eco_check(eco_texture_read_level(&part, p->x->pack, list, levels - 1, p->x->error));
	for (uint32_t y = 0; y < p->height; y++) {
		double north = p->high[1] - (y + 0.5) * (p->high[1] - p->low[1]) / p->height,
			row = part.height - (north - list->grid_origin[1]) / texel_m;
		for (uint32_t x = 0; x < p->width && row >= 0 && row < part.height; x++) {
			double east = p->low[0] + (x + 0.5) * (p->high[0] - p->low[0]) / p->width,
				column = (east - list->grid_origin[0]) / texel_m;
			if (column >= 0 && column < part.width)
				lay(&part, (size_t)row * part.width + (size_t)column,
					p->rgb + 3 * ((size_t)y * p->width + x));
		}
	}
	eco_texture_part_free(&part);
}

static void paint(struct painting *p, uint32_t tile)
{
	const struct eco_list *list = list_of(p, tile);
	uint32_t child = p->x->pack->scene.ground_images[tile].child_first;
	bool is_fine = !child || list->grid_step[0] <= SAME * p->texel_m;
	if (touches(p, list) && is_fine)
		paint_level(p, list);
	for (uint32_t q = 0; q < 4 && !is_fine && touches(p, list); q++)
		paint(p, child + q);
}

static uint32_t texels(double extent_m, double texel_m, uint32_t most)
{
	return (uint32_t)fmin(fmax(ceil(extent_m / texel_m), 1), most);
}

bool export_ground_image(struct export *x, const double low[3], const double high[3], bool is_leaf, const char *name)
{
	struct painting p = { .x = x, .low = low, .high = high };
	uint32_t most = is_leaf ? SIDE_LEAF : SIDE_COARSE;
	double finest = x->pack->scene.ground_image_count ? finest_m(&p, 0) : INFINITY;
	if (finest == INFINITY)
		return false;
	p.texel_m = fmax(finest, fmax(high[0] - low[0], high[1] - low[1]) / most);
	p.width = texels(high[0] - low[0], p.texel_m, most);
	p.height = texels(high[1] - low[1], p.texel_m, most);
	p.rgb = eco_alloc((size_t)p.width * p.height, 3);
	for (size_t i = 0; i < (size_t)p.width * p.height; i++)
		memcpy(p.rgb + 3 * i, export_grass, 3);
	struct eco_pixels pixels = { p.width, p.height, 3, p.rgb };
	uint8_t *png = NULL;
	size_t size = 0;
	paint(&p, 0);
	eco_check(eco_png_encode(&pixels, &png, &size, x->error));
	export_file(x, name, png, size);
	free(png);
	free(p.rgb);
	return true;
}
