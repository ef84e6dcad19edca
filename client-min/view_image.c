#include "client-min/view_image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/ground_image.h"
#include "lod/light.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
#define SAMPLES_MAX 6                    /* along a pixel */

/* ---- Tiles ---- */

static int by_place(const void *a, const void *b)
{
	const struct view_image_tile *x = a, *y = b;
	if (x->size != y->size)
		return x->size < y->size ? -1 : 1;
	if (x->row != y->row)
		return x->row < y->row ? -1 : 1;
	return (x->column > y->column) - (x->column < y->column);
}

static bool shows(const struct view_list *list, const struct eco_cut *cut)
{
	return list->list.kind == ECO_LIST_GROUND_IMAGE && cut->end <= list->chunk_count
		&& list->parts && list->parts[cut->end - 1].texels;
}

/* Of each size once, descending. */
static bool add_size(struct view_image *image, double texel_m)
{
	uint32_t at = 0;
	while (at < image->size_count && image->texel_m[at] > texel_m)
		at++;
	if (at < image->size_count && image->texel_m[at] == texel_m)
		return true;
	if (image->size_count == VIEW_IMAGE_SIZES)
		return false;
	memmove(image->texel_m + at + 1, image->texel_m + at,
		(image->size_count - at) * sizeof *image->texel_m);
	image->texel_m[at] = texel_m;
	image->size_count++;
	return true;
}

static bool put_tile(struct view_image *image, const struct view_list *list, uint32_t levels)
{
	uint32_t size = 0;
	double place[2];
	while (image->texel_m[size] != list->list.grid_step[0])
		size++;
	for (int k = 0; k < 2; k++) {
		place[k] = floor(
			(list->list.grid_origin[k] - image->origin[k]) / (SIDE * image->texel_m[size]) + 0.5);
		if (!(fabs(place[k]) < 1e15))
			return false;
	}
	image->tiles[image->count++] = (struct view_image_tile){ list, levels, size, (int64_t)place[0],
		(int64_t)place[1] };
	return true;
}

enum eco_code view_image_make(struct view_image *image, const struct view_store *store,
	struct eco_error *error)
{
	const struct eco_plan *plan = view_store_plan(store);
	uint32_t most = 0;
	bool good = true;
	*image = (struct view_image){ .tiles = NULL };
	for (uint32_t i = 0; plan && i < plan->cut_count && good; i++) {
		const struct view_list *list = view_store_list(store, plan->cuts[i].list);
		if (!shows(list, &plan->cuts[i]))
			continue;
		if (!most++ || list->list.grid_step[0] > image->texel_m[0])
			memcpy(image->origin, list->list.grid_origin, sizeof image->origin);
		good = add_size(image, list->list.grid_step[0]);
	}
	if (!most)
		return ECO_OK;
	image->tiles = malloc(most * sizeof *image->tiles);
	if (!image->tiles)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the image of the ground");
	for (uint32_t i = 0; i < plan->cut_count && good; i++) {
		const struct view_list *list = view_store_list(store, plan->cuts[i].list);
		good = !shows(list, &plan->cuts[i]) || put_tile(image, list, plan->cuts[i].end);
	}
	if (!good) {
		view_image_free(image);
		return eco_fail(error, ECO_DAMAGED, "the tiles of the ground's image are no quadtree");
	}
	qsort(image->tiles, image->count, sizeof *image->tiles, by_place);
	for (uint32_t size = 0, i = 0; size <= image->size_count; size++) {
		while (i < image->count && image->tiles[i].size < size)
			i++;
		image->first[size] = i;
	}
	return ECO_OK;
}

void view_image_free(struct view_image *image)
{
	free(image->tiles);
	*image = (struct view_image){ .tiles = NULL };
}

/* ---- Texels ---- */

static bool holds(const struct view_image *image, const struct view_image_tile *tile, double x, double y)
{
	double side = SIDE * image->texel_m[tile->size];
	return floor((x - image->origin[0]) / side) == (double)tile->column
		&& floor((y - image->origin[1]) / side) == (double)tile->row;
}

static const struct view_image_tile *find_tile(const struct view_image *image, double x, double y,
	uint32_t *near)
{
	if (*near < image->count && holds(image, &image->tiles[*near], x, y))
		return &image->tiles[*near];
	for (uint32_t size = 0; size < image->size_count; size++) {
		double side = SIDE * image->texel_m[size], column = floor((x - image->origin[0]) / side),
			row = floor((y - image->origin[1]) / side);
		if (!(fabs(column) < 1e15 && fabs(row) < 1e15))
			continue;
		struct view_image_tile key = { .size = size, .column = (int64_t)column, .row = (int64_t)row };
		const struct view_image_tile *found = bsearch(&key, image->tiles + image->first[size],
			image->first[size + 1] - image->first[size], sizeof key, by_place);
		if (found) {
			*near = (uint32_t)(found - image->tiles);
			return found;
		}
	}
	return NULL;
}

static void add_texel(const struct eco_texture_part *part, uint32_t column, uint32_t row, float weight,
	struct view_image_color *sum)
{
	const uint8_t *texel = part->texels + ((size_t)row * part->width + column) * part->channels;
	float alpha = part->channels == 4 ? (float)texel[3] / 255 : 1;
	for (int k = 0; k < 3; k++)
		sum->light[k] += weight * alpha * (float)lod_light_of[texel[k]];
	sum->alpha += weight * alpha;
}

static uint32_t within(double v, uint32_t count)
{
	return v <= 0 ? 0 : v >= count ? count - 1 : (uint32_t)v;
}

/* The texel beyond the border: of the tile there, on the level whose texels are about as wide. */
static void add_beyond(const struct view_image *image, double x, double y, double texel_m, float weight,
	struct view_image_color *sum)
{
	uint32_t near = image->count;
	const struct view_image_tile *tile = find_tile(image, x, y, &near);
	if (!tile)
		return;
	double side = SIDE * image->texel_m[tile->size];
	uint32_t level = tile->levels - 1;
	while (level && side / tile->list->parts[level].width < 0.75 * texel_m)
		level--;
	const struct eco_texture_part *part = &tile->list->parts[level];
	double u = (x - image->origin[0]) / side - (double)tile->column,
		v = 1 - ((y - image->origin[1]) / side - (double)tile->row);
	add_texel(part, within(u * part->width, part->width), within(v * part->height, part->height), weight,
		sum);
}

/* Four texels around a place, of one level of the tile that holds it. */
static void add_mixed(const struct view_image *image, const struct view_image_tile *tile, uint32_t level,
	double x, double y, float weight, struct view_image_color *sum)
{
	const struct eco_texture_part *part = &tile->list->parts[level];
	double side = SIDE * image->texel_m[tile->size],
	       west = image->origin[0] + (double)tile->column * side,
	       north = image->origin[1] + (double)(tile->row + 1) * side;
	double texel_x = side / part->width, texel_y = side / part->height, u = (x - west) / texel_x - 0.5,
		v = (north - y) / texel_y - 0.5, column = floor(u), row = floor(v);
	for (int k = 0; k < 4; k++) {
		double c = column + k % 2, r = row + k / 2;
		float w = weight *
			(float)((k % 2 ? u - column : column + 1 - u) * (k / 2 ? v - row : row + 1 - v));
		if (c >= 0 && r >= 0 && c < part->width && r < part->height)
			add_texel(part, (uint32_t)c, (uint32_t)r, w, sum);
		else
			add_beyond(image, west + (c + 0.5) * texel_x, north - (r + 0.5) * texel_y, texel_x, w,
				sum);
	}
}

/* Between the two levels whose texels are next to `width_m`. */
static void add_sample(const struct view_image *image, const struct view_image_tile *tile, double x, double y,
	double width_m, float weight, struct view_image_color *sum)
{
	double side = SIDE * image->texel_m[tile->size];
	uint32_t level = tile->levels - 1;
	while (level && side / tile->list->parts[level].width < width_m)
		level--;
	double coarse = side / tile->list->parts[level].width;
	if (level + 1 == tile->levels || coarse <= width_m) {
		add_mixed(image, tile, level, x, y, weight, sum);
		return;
	}
	double fine = side / tile->list->parts[level + 1].width;
	float share = (float)((width_m - fine) / (coarse - fine));
	add_mixed(image, tile, level, x, y, weight * share, sum);
	add_mixed(image, tile, level + 1, x, y, weight * (1 - share), sum);
}

struct view_image_color view_image_at(const struct view_image *image, const struct view_image_spot *spot,
	uint32_t *near, double *texel_m)
{
	struct view_image_color sum = { .alpha = 0 };
	const struct view_image_tile *tile = find_tile(image, spot->at[0], spot->at[1], near);
	if (!tile)
		return sum;
	*texel_m = SIDE * image->texel_m[tile->size] / tile->list->parts[tile->levels - 1].width;
	double along = sqrt(spot->along[0] * spot->along[0] + spot->along[1] * spot->along[1]),
		across = fmax(spot->across_m, *texel_m / 2);
	int count = along > across ? (int)fmin(SAMPLES_MAX, ceil(along / across)) : 1;
	double width = 2 * fmax(across, along / count);
	for (int i = 0; i < count; i++) {
		double t = (2 * i + 1.0) / count - 1, x = spot->at[0] + t * spot->along[0],
			y = spot->at[1] + t * spot->along[1];
		const struct view_image_tile *there = find_tile(image, x, y, near);
		if (there)
			add_sample(image, there, x, y, width, 1.0f / (float)count, &sum);
	}
	for (int k = 0; k < 3 && sum.alpha > 0; k++)
		sum.light[k] /= 65535 * sum.alpha;
	return sum;
}
