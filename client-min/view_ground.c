#include "client-min/view_ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/light.h"

#define ANCHOR_MAX ((1 << 28) - 1)

static enum eco_code same_grid(const struct view_ground *g, uint32_t i, struct eco_error *error)
{
	const struct eco_list *a = &g->tiles[0].list->list, *b = &g->tiles[i].list->list;
	if (memcmp(a->grid_origin, b->grid_origin, sizeof a->grid_origin) == 0
			&& memcmp(a->grid_step, b->grid_step, sizeof a->grid_step) == 0)
		return ECO_OK;
	return eco_fail(error, ECO_DAMAGED, "lists %u and %u are ground on different grids",
		g->tiles[0].list->id, g->tiles[i].list->id);
}

static void find_anchor(struct view_ground *g, const struct lod_eye *eye)
{
	const struct eco_list *list = &g->tiles[0].list->list;
	for (int i = 0; i < 3; i++) {
		double step = list->grid_step[i],
			at = step > 0 ? floor((eye->at[i] - list->grid_origin[i]) / step + 0.5) : 0;
		at = at > ANCHOR_MAX ? ANCHOR_MAX : at < -ANCHOR_MAX ? -ANCHOR_MAX : at;
		g->anchor[i] = (int32_t)at;
		g->at[i] = list->grid_origin[i] + at * step;
		g->step[i] = (float)step;
		g->origin[i] = list->grid_origin[i];
	}
}

enum eco_code view_ground_make(struct view_ground *g, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error)
{
	const struct eco_plan *plan = view_store_plan(store);
	uint32_t columns, rows, most = 0;
	enum eco_code code = ECO_OK;
	*g = (struct view_ground){ 0 };
	view_store_ground(store, &columns, &rows);
	for (uint32_t i = 0; plan && columns && i < plan->cut_count; i++)
		most += view_store_list(store, plan->cuts[i].list)->list.kind == ECO_LIST_GROUND;
	if (!most)
		return ECO_OK;
	struct eco_ground_tile *tiles = malloc(most * sizeof *tiles);
	struct lod_ground_seam *seams = malloc(most * sizeof *seams);
	g->tiles = malloc(most * sizeof *g->tiles);
	for (uint32_t i = 0; tiles && g->tiles && i < plan->cut_count && !code; i++) {
		const struct view_list *list = view_store_list(store, plan->cuts[i].list);
		if (list->list.kind != ECO_LIST_GROUND)
			continue;
		struct view_ground_tile *tile = &g->tiles[g->count];
		tile->list = list;
		tiles[g->count] = list->tile;
		eco_ground_spans(&tile->x, &tile->y, &list->tile, columns, rows);
		code = same_grid(g, g->count++, error);
	}
	if (!tiles || !seams || !g->tiles || (!code && !lod_ground_seams(seams, tiles, g->count)))
		code = eco_no_memory(error, "the ground in view");
	for (uint32_t i = 0; !code && i < g->count; i++)
		g->tiles[i].seam = seams[i];
	if (!code)
		find_anchor(g, eye);
	else
		view_ground_free(g);
	free(tiles);
	free(seams);
	return code;
}

void view_ground_free(struct view_ground *g)
{
	free(g->tiles);
	*g = (struct view_ground){ 0 };
}

uint32_t view_ground_sample(const struct view_ground_tile *tile, uint32_t column, uint32_t row)
{
	lod_ground_corner(&column, &row, &tile->seam, &tile->x, &tile->y);
	return (row + tile->y.before) * tile->x.count + column + tile->x.before;
}

/* Rise from sample a to sample b, a metre along `axis`; 0 where they are one. */
static double slope(const struct view_list *list, const int32_t *a, const int32_t *b, int axis)
{
	double along = ((double)b[axis] - a[axis]) * list->list.grid_step[axis];
	return along > 0 ? ((double)b[2] - a[2]) * list->list.grid_step[2] / along : 0;
}

void view_ground_normal(const struct view_list *list, uint32_t sample, float normal[3])
{
	uint32_t columns = list->list.columns, rows = list->elements.element_count / columns,
		c = sample % columns, r = sample / columns;
	const int32_t *p = list->elements.position + 3 * (size_t)sample;
	size_t row = 3 * (size_t)columns;
	double x = -slope(list, c > 0 ? p - 3 : p, c + 1 < columns ? p + 3 : p, 0);
	double y = -slope(list, r > 0 ? p - row : p, r + 1 < rows ? p + row : p, 1);
	double length = sqrt(x * x + y * y + 1);
	normal[0] = (float)(x / length);
	normal[1] = (float)(y / length);
	normal[2] = (float)(1 / length);
}

void view_ground_place(const struct view_ground *ground, const struct view_ground_tile *tile, uint32_t sample,
	float out[3])
{
	const int32_t *at = tile->list->elements.position + 3 * (size_t)sample;
	for (int k = 0; k < 3; k++)
		out[k] = (float)(at[k] - ground->anchor[k]) * ground->step[k];
}

const uint32_t view_ground_corners[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };

uint32_t view_ground_triangles(const struct view_ground *ground, const struct view_ground_tile *tile,
	float *out)
{
	for (uint32_t y = 0; y + 1 < tile->y.inner && out; y++)
		for (uint32_t x = 0; x + 1 < tile->x.inner; x++)
			for (int c = 0; c < 6; c++, out += 3)
				view_ground_place(ground, tile, view_ground_sample(tile,
					x + view_ground_corners[c][0], y + view_ground_corners[c][1]), out);
	return 2 * (tile->x.inner - 1) * (tile->y.inner - 1);
}

/* The sample of the span's inner ones at or before `at`, but for the last, and how far `at` is on the way to
 * the next; false outside. Places of samples are `stride` apart. */
static bool find_cell(const struct eco_ground_span *span, const int32_t *places, size_t stride, double at,
	uint32_t *sample, double *share)
{
	uint32_t i = span->before, last = span->before + span->inner - 1;
	if (!(at >= places[stride * i] && at <= places[stride * last]))
		return false;
	while (i + 1 < last && at >= places[stride * (i + 1)])
		i++;
	double low = places[stride * i], high = places[stride * (i + 1)];
	*sample = i;
	*share = (at - low) / (high - low);
	return true;
}

bool view_ground_height(const struct view_ground *g, double x, double y, double *height_m)
{
	for (uint32_t i = 0; i < g->count; i++) {
		const struct view_ground_tile *tile = &g->tiles[i];
		const struct eco_list *list = &tile->list->list;
		uint32_t column, row;
		double u, v;
		const int32_t *at = tile->list->elements.position;
		if (!find_cell(&tile->x, at, 3, (x - list->grid_origin[0]) / list->grid_step[0], &column, &u)
			|| !find_cell(&tile->y, at + 1, 3 * (size_t)tile->x.count,
			(y - list->grid_origin[1]) / list->grid_step[1], &row, &v))
			continue;
		const int32_t *south = at + 3 * ((size_t)row * tile->x.count + column) + 2;
		const int32_t *north = south + 3 * (size_t)tile->x.count;
		double z = u >= v ? south[0] + u * (south[3] - (double)south[0])
			+ v * (north[3] - (double)south[3])
			: south[0] + v * (north[0] - (double)south[0]) + u * (north[3] - (double)north[0]);
		*height_m = list->grid_origin[2] + z * list->grid_step[2];
		return true;
	}
	return false;
}

/* ==== The image on the ground ==== */

#define SIDE_LEAST (ECO_GROUND_IMAGE_SIDE >> (ECO_GROUND_IMAGE_LEVELS - 1))
#define DEPTH_MAX 40                     /* sides of the smallest tile and of the root: 1 to 2^40 */

/* ---- What view_image.glsl is written in ---- */

#include "lod/glsl.h"

typedef double wide;
typedef const struct view_image *tree;
typedef struct image_color image_color;
typedef struct image_spot image_spot;
typedef struct image_pixel image_pixel;
#define image_color(...) ((struct image_color){ __VA_ARGS__ })
#define image_spot(...) ((struct image_spot){ __VA_ARGS__ })
#define widened(x) ((double)(x))
#define whole(x) ((uint32_t)(x))

#include "client-min/view_image.glsl"
#include "lod/glsl_end.h"

_Static_assert(LEAF == VIEW_IMAGE_LEAF && SIDE_LEAST == 32u, "view_image.glsl has the same numbers");

static uint tree_node(tree t, uint i) { return t->nodes[i]; }

static uint tree_level(tree t, uint leaf, uint level)
{
	(void)t;
	return VIEW_IMAGE_TILE(leaf) * ECO_GROUND_IMAGE_LEVELS + level;
}

static struct image_color tree_texel(tree t, uint of, uint texel)
{
	const struct view_image_tile *tile = &t->tiles[of / ECO_GROUND_IMAGE_LEVELS];
	const struct eco_texture_part *part = &tile->list->parts[of % ECO_GROUND_IMAGE_LEVELS];
	const uint8_t *c = part->texels + (size_t)texel * part->channels;
	float alpha = part->channels == 4 ? (float)c[3] / 255 : 1, share = alpha / 65535;
	return image_color((float)lod_light_of[c[0]] * share, (float)lod_light_of[c[1]] * share,
		(float)lod_light_of[c[2]] * share, alpha, 0);
}

struct view_image_color view_image_at(const struct view_image *image, const struct view_image_spot *spot)
{
	if (!image->count)
		return (struct view_image_color){ .alpha = 0 };
	double part = 1 / image->side_m;
	struct image_color c = image_seen(image, (struct image_pixel){
		(spot->at[0] - image->origin[0]) * part, (spot->at[1] - image->origin[1]) * part,
		(float)(spot->along[0] * part), (float)(spot->along[1] * part), (float)(spot->across_m * part) });
	return (struct view_image_color){ { c.red, c.green, c.blue }, c.alpha,
		(float)((double)c.texel * image->side_m) };
}

/* ---- Tiles ---- */

/* A tile's place among squares of its size, from the first tile's corner. */
struct square { int64_t at[2]; int depth; };     /* depth: below the largest tiles */

static enum eco_code no_quadtree(struct eco_error *error)
{
	return eco_fail(error, ECO_DAMAGED, "the tiles of the ground's image do not form a quadtree");
}

/* Levels are each twice as wide as the one before. */
static bool has_levels(const struct view_image_tile *tile)
{
	bool good = tile->levels >= 1 && tile->levels <= ECO_GROUND_IMAGE_LEVELS;
	for (uint32_t i = 0; i < tile->levels && good; i++) {
		const struct eco_texture_part *part = &tile->list->parts[i];
		good = part->width == SIDE_LEAST << i && part->height == part->width;
	}
	return good;
}

static bool locate(const struct view_image *image, const struct view_image_tile *tile, double largest_m,
	struct square *square)
{
	double side = eco_ground_image_side_m(&tile->list->list);
	if (!(side > 0 && side >= ldexp(largest_m, -DEPTH_MAX)))
		return false;
	square->depth = (int)lround(log2(largest_m / side));
	for (int k = 0; k < 2; k++) {
		double at = (tile->list->list.grid_origin[k] - image->origin[k]) / side;
		if (!(fabs(at) < 1e15))
			return false;
		square->at[k] = llround(at);
	}
	return fabs(ldexp(side, square->depth) / largest_m - 1) < 1e-6;
}

/* The least square whose corner is one of the largest tiles': that corner among these, and its side in them,
 * 2^above. */
struct root { int64_t low[2]; int above; };

static struct root find_root(const struct square *squares, uint32_t count)
{
	struct root root = { { INT64_MAX, INT64_MAX }, 0 };
	int64_t high[2] = { INT64_MIN, INT64_MIN };
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 2; k++) {
			int64_t at = squares[i].at[k] >> squares[i].depth;
			root.low[k] = at < root.low[k] ? at : root.low[k];
			high[k] = at > high[k] ? at : high[k];
		}
	while ((high[0] - root.low[0]) >> root.above || (high[1] - root.low[1]) >> root.above)
		root.above++;
	return root;
}

static bool add_quarters(struct view_image *image, uint32_t *room, uint32_t node)
{
	image->nodes[node] = image->node_count;
	for (int k = 0; k < 4; k++) {
		if (!eco_array_grow(&image->nodes, room, image->node_count, sizeof *image->nodes))
			return false;
		image->nodes[image->node_count++] = 0;
	}
	return true;
}

static enum eco_code put_tile(struct view_image *image, uint32_t *room, const struct root *root,
	const struct square *square, uint32_t index, struct eco_error *error)
{
	uint32_t node = 0;
	if (root->above + square->depth > DEPTH_MAX)
		return no_quadtree(error);
	for (int bit = root->above + square->depth - 1; bit >= 0; bit--) {
		if (!image->nodes[node] && !add_quarters(image, room, node))
			return eco_no_memory(error, "the image of the ground");
		if (image->nodes[node] >= VIEW_IMAGE_LEAF)
			return no_quadtree(error);
		node = image->nodes[node];
		for (int k = 0; k < 2; k++)
			node += (uint32_t)(((square->at[k] - root->low[k] * ((int64_t)1 << square->depth)) >> bit
				& 1) << k);
	}
	if (image->nodes[node])
		return no_quadtree(error);
	image->nodes[node] = VIEW_IMAGE_LEAF | (image->tiles[index].levels - 1) << 29 | index;
	return ECO_OK;
}

static enum eco_code put_tiles(struct view_image *image, struct square *squares, struct eco_error *error)
{
	double largest_m = 0;
	uint32_t room = 0;
	bool good = image->count <= VIEW_IMAGE_TILE(UINT32_MAX);
	for (uint32_t i = 0; i < image->count; i++)
		largest_m = fmax(largest_m, eco_ground_image_side_m(&image->tiles[i].list->list));
	memcpy(image->origin, image->tiles[0].list->list.grid_origin, sizeof image->origin);
	for (uint32_t i = 0; i < image->count && good; i++)
		good = has_levels(&image->tiles[i]) && locate(image, &image->tiles[i], largest_m, &squares[i]);
	if (!good)
		return no_quadtree(error);
	struct root root = find_root(squares, image->count);
	for (int k = 0; k < 2; k++)
		image->origin[k] += (double)root.low[k] * largest_m;
	image->side_m = ldexp(largest_m, root.above);
	if (!eco_array_grow(&image->nodes, &room, 0, sizeof *image->nodes))
		return eco_no_memory(error, "the image of the ground");
	image->nodes[image->node_count++] = 0;
	for (uint32_t i = 0; i < image->count; i++)
		ECO_PASS(put_tile(image, &room, &root, &squares[i], i, error));
	return ECO_OK;
}

enum eco_code view_image_of(struct view_image *image, const struct view_image_tile *tiles, uint32_t count,
	struct eco_error *error)
{
	struct square *squares = malloc(count * sizeof *squares + 1);
	*image = (struct view_image){ .tiles = malloc(count * sizeof *tiles + 1), .count = count };
	enum eco_code code = squares && image->tiles ? ECO_OK
		: eco_no_memory(error, "the image of the ground");
	if (!code && count) {
		memcpy(image->tiles, tiles, count * sizeof *tiles);
		code = put_tiles(image, squares, error);
	}
	free(squares);
	if (code)
		view_image_free(image);
	return code;
}

static bool shows(const struct view_list *list, const struct eco_cut *cut)
{
	return list->list.kind == ECO_LIST_GROUND_IMAGE && cut->end && list->chunk_count
		&& cut->end <= list->marks[list->chunk_count - 1].primitives && list->parts[cut->end - 1].height;
}

enum eco_code view_image_make(struct view_image *image, const struct view_store *store,
	struct eco_error *error)
{
	const struct eco_plan *plan = view_store_plan(store);
	struct view_image_tile *tiles = NULL;
	uint32_t count = 0, room = 0;
	enum eco_code code = ECO_OK;
	*image = (struct view_image){ .tiles = NULL };
	for (uint32_t i = 0; plan && i < plan->cut_count && !code; i++) {
		const struct view_list *list = view_store_list(store, plan->cuts[i].list);
		if (!shows(list, &plan->cuts[i]))
			continue;
		if (!eco_array_grow(&tiles, &room, count, sizeof *tiles))
			code = eco_no_memory(error, "the image of the ground");
		else
			tiles[count++] = (struct view_image_tile){ list, plan->cuts[i].end };
	}
	if (!code && count)
		code = view_image_of(image, tiles, count, error);
	free(tiles);
	return code;
}

void view_image_free(struct view_image *image)
{
	free(image->tiles);
	free(image->nodes);
	*image = (struct view_image){ .tiles = NULL };
}
