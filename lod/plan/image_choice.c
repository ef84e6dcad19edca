#include "lod/plan/image_choice.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/wire_body.h"
#include "lod/ground_choice.h"
#include "lod/plan/planner.h"
#include "lod/seen/visibility.h"

#define NODES_MAX 16384u

struct lod_image_node {
	uint32_t tile;
	uint32_t child_first;        /* in nodes; 0: none */
	uint8_t child_count, most;   /* levels that the view resolves */
	double pixels;               /* of the picture, that it covers */
	double px; /* width of a texel of the last level; INFINITY where the eye may be in it */
	/* of the last choice: */
	double cost;
	uint8_t levels;              /* 0: its children */
	bool reached;                /* by way of tiles that show their children */
};

/* ---- What is seen ---- */

static const struct eco_list *list_of(const struct eco_scene *scene, uint32_t tile)
{
	return &scene->lists[scene->ground_images[tile].list];
}

static void box_of(const struct eco_scene *scene, uint32_t tile, double low[3], double high[3])
{
	const struct eco_list *list = list_of(scene, tile);
	for (int k = 0; k < 2; k++) {
		low[k] = list->grid_origin[k];
		high[k] = low[k] + eco_ground_image_side_m(list);
	}
	lod_ground_heights(scene, low, high);
}

/* Pixels of a level square in the middle of the box, by parts of it. */
static double pixels_of(const struct lod_eye *eye, const double low[3], const double high[3], double most)
{
	double sum = 0, side = (high[0] - low[0]) / LOD_IMAGE_SAMPLES, pixel = eye->pixel_rad * eye->pixel_rad;
	for (int i = 0; i < LOD_IMAGE_SAMPLES * LOD_IMAGE_SAMPLES; i++) {
		double d[3] = { low[0] + (i % LOD_IMAGE_SAMPLES + 0.5) * side - eye->at[0],
			low[1] + (i / LOD_IMAGE_SAMPLES + 0.5) * side - eye->at[1],
			(low[2] + high[2]) / 2 - eye->at[2] };
		double far = lod_dot(d, eye->forward), square = lod_dot(d, d);
		if (!(far > 0) || fabs(lod_dot(d, eye->right)) > eye->tan_x * far
				|| fabs(lod_dot(d, eye->up)) > eye->tan_y * far)
			continue;
		sum += fmin(side * side * fabs(d[2]) / (square * sqrt(square) * pixel),
			most / (LOD_IMAGE_SAMPLES * LOD_IMAGE_SAMPLES));
	}
	return sum;
}

static double texel_px(const struct lod_eye *eye, const double low[3], const double high[3], double texel_m)
{
	double depth = lod_box_depth(eye, low, high), above = fabs(eye->at[2] - (low[2] + high[2]) / 2);
	return depth > 0 ? texel_m / (depth * eye->pixel_rad) * sqrt(fmin(1, fmax(LOD_IMAGE_FLAT_LEAST, above / depth)))
		: INFINITY;
}

/* Levels whose texels are no wider than that. */
static uint8_t levels_within(double px, double most_px)
{
	uint8_t levels = ECO_GROUND_IMAGE_LEVELS;
	for (; levels > 1 && 2 * px <= most_px; levels--)
		px *= 2;
	return levels;
}

struct looking { const struct eco_scene *scene; const struct lod_eye *eye; double texel_px, pixels; };

static void look_at(struct lod_image *image, const struct looking *look, uint32_t tile)
{
	double low[3], high[3];
	box_of(look->scene, tile, low, high);
	if (!lod_box_seen(look->eye, low, high))
		return;
	double px = texel_px(look->eye, low, high, eco_ground_image_texel_m(list_of(look->scene, tile),
		ECO_GROUND_IMAGE_LEVELS));
	image->nodes[image->count++] = (struct lod_image_node){ .tile = tile, .px = px,
		.most = levels_within(px, look->texel_px),
		.pixels = pixels_of(look->eye, low, high, look->pixels) };
}

/* A tile covers what its children cover: samples of its own are too few for a large one, and with fewer
 * pixels it would seem to be wrong in fewer. */
static void sum_pixels(struct lod_image *image)
{
	for (uint32_t i = image->count; i-- > 0;) {
		struct lod_image_node *node = &image->nodes[i];
		node->pixels = node->child_count ? 0 : node->pixels;
		for (uint32_t k = 0; k < node->child_count; k++)
			node->pixels += image->nodes[node->child_first + k].pixels;
	}
}

enum eco_code lod_image_see(struct lod_image *image, const struct eco_scene *scene, const struct lod_eye *eye,
	const struct eco_view *view, double texel_px, struct eco_error *error)
{
	const struct looking look = { scene, eye, texel_px, (double)view->width * view->height };
	uint32_t most = scene->ground_image_count < NODES_MAX ? scene->ground_image_count : NODES_MAX;
	*image = (struct lod_image){ .share = 1 };
	if (!most)
		return ECO_OK;
	image->nodes = malloc(most * sizeof *image->nodes);
	if (!image->nodes)
		return eco_fail(error, ECO_NO_MEMORY,
			"planning: no memory for %u tiles of the ground's image", most);
	look_at(image, &look, 0);
	for (uint32_t i = 0; i < image->count; i++) {
		uint32_t child = scene->ground_images[image->nodes[i].tile].child_first, first = image->count;
		if (!child || image->nodes[i].px <= texel_px || most - image->count < 4)
			continue;
		for (uint32_t q = 0; q < 4; q++)
			look_at(image, &look, child + q);
		image->nodes[i].child_first = first;
		image->nodes[i].child_count = (uint8_t)(image->count - first);
	}
	sum_pixels(image);
	return ECO_OK;
}

void lod_image_free(struct lod_image *image)
{
	free(image->nodes);
	*image = (struct lod_image){ .nodes = NULL };
}

/* ---- What is chosen ---- */

static double missing_bytes(const struct eco_scene *scene, const struct eco_holdings *holdings, uint32_t tile,
	uint32_t levels)
{
	uint32_t list = scene->ground_images[tile].list, end = lod_plan_chunks_for(scene, list, levels);
	double sum = 0;
	for (uint32_t c = eco_holdings_chunks(holdings, list); c < end; c++)
		sum += eco_wire_chunk_bytes(scene, list, c);
	return sum;
}

static double cost_of(double px)
{
	double octaves = px < 1e6 ? lod_octaves(px * px) - LOD_IMAGE_COST_FROM : LOD_IMAGE_COST_OCTAVES;
	return LOD_IMAGE_COST * fmin(LOD_IMAGE_COST_OCTAVES, fmax(0, octaves));
}

/* From the leaves up: levels of its own, of equal ones the finest, or what its children chose. Returns
 * whether anything is shown. */
static bool choose(const struct lod_image *image, const struct eco_scene *scene,
	const struct eco_holdings *holdings, double price)
{
	for (uint32_t i = image->count; i-- > 0;) {
		struct lod_image_node *node = &image->nodes[i];
		double pixels = image->share * node->pixels, px = node->px, split = 0;
		node->cost = INFINITY;
		for (uint8_t n = ECO_GROUND_IMAGE_LEVELS; n > 0; n--, px *= 2) {
			if (n > node->most)
				continue;
			double cost =
				pixels * cost_of(px) + price * missing_bytes(scene, holdings, node->tile, n);
			if (cost < node->cost) {
				node->cost = cost;
				node->levels = n;
			}
		}
		for (uint32_t k = 0; k < node->child_count; k++)
			split += image->nodes[node->child_first + k].cost;
		if (node->child_count && split < node->cost) {
			node->cost = split;
			node->levels = 0;
		}
	}
	return image->count && !(price > 0 && image->share * image->nodes[0].pixels * LOD_IMAGE_COST_NONE
		< image->nodes[0].cost);
}

/* Chooses, and opens what is reached from the root; false: nothing is shown. */
static bool choose_all(const struct lod_image *image, const struct eco_scene *scene,
	const struct eco_holdings *holdings, double price)
{
	if (!choose(image, scene, holdings, price))
		return false;
	for (uint32_t i = 0; i < image->count; i++)
		image->nodes[i].reached = i == 0;
	for (uint32_t i = 0; i < image->count; i++)
		for (uint32_t k = 0; k < image->nodes[i].child_count; k++)
			image->nodes[image->nodes[i].child_first + k].reached = image->nodes[i].reached
				&& !image->nodes[i].levels;
	return true;
}

double lod_image_bytes(const struct lod_image *image, const struct eco_scene *scene,
	const struct eco_holdings *holdings, double price)
{
	double sum = 0;
	bool shown = choose_all(image, scene, holdings, price);
	for (uint32_t i = 0; shown && i < image->count; i++)
		if (image->nodes[i].reached && image->nodes[i].levels)
			sum += missing_bytes(scene, holdings, image->nodes[i].tile, image->nodes[i].levels);
	return sum;
}

uint32_t lod_image_cuts(const struct lod_image *image, const struct eco_scene *scene,
	const struct eco_holdings *holdings, double price, struct eco_cut *cuts)
{
	uint32_t count = 0;
	bool shown = choose_all(image, scene, holdings, price);
	for (uint32_t i = 0; shown && i < image->count; i++)
		if (image->nodes[i].reached && image->nodes[i].levels)
			cuts[count++] = (struct eco_cut){ .list = scene->ground_images[image->nodes[i].tile].list,
				.end = image->nodes[i].levels, .scale = 1, .anchor = ECO_NONE, .share_end = ECO_SHARE_ONE };
	return count;
}
