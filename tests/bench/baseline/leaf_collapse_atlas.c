#include "tests/bench/baseline/leaf_collapse_atlas.h"

#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/raster/texel.h"

#define WIDTH 1024u
#define HEIGHT 256u
#define PAIR_SIDE 128u
#define SIDE 64u
#define LEAVES_MOST 16u          /* drawn in one tile */
#define DISTANCES 8u             /* bins of a quarter of the leaves' length */
#define TURNS 4u                 /* bins of 22.5 degrees */
#define DENSITIES 16u            /* bins */
#define HALVINGS 16
#define GROW_MOST 16.0           /* of a tile's leaves */

/* ---- A leaf's shape ---- */

struct flat { double x, y, u, v; };

/* Barycentric coordinates of (x, y), or false outside. */
static bool within(const struct flat t[3], double x, double y, double weight[3])
{
	double all = (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[2].x - t[0].x) * (t[1].y - t[0].y);
	if (all == 0)
		return false;
	weight[1] = ((x - t[0].x) * (t[2].y - t[0].y) - (t[2].x - t[0].x) * (y - t[0].y)) / all;
	weight[2] = ((t[1].x - t[0].x) * (y - t[0].y) - (x - t[0].x) * (t[1].y - t[0].y)) / all;
	weight[0] = 1 - weight[1] - weight[2];
	return weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0;
}

static bool covered(const struct flat *at, uint32_t corners, double x, double y,
	const struct eco_image *cutout)
{
	for (uint32_t k = 1; k + 1 < corners; k++) {
		const struct flat t[3] = { at[0], at[k], at[k + 1] };
		double w[3];
		if (!within(t, x, y, w))
			continue;
		if (!cutout || lod_texel_at(cutout, w[0] * t[0].u + w[1] * t[1].u + w[2] * t[2].u,
				w[0] * t[0].v + w[1] * t[1].v + w[2] * t[2].v)[3] >= 128)
			return true;
	}
	return false;
}

/* The corners in the leaf's own axes, in [-1, 1]. Returns the width over the length. */
static double flatten(struct flat *at, const struct lod_collapse_leaves *leaf, const float (*uv)[2])
{
	struct lod_collapse collapse;
	struct lod_collapse_node node;
	struct lod_v3 corner[ECO_CORNERS_MAX];
	collapse = (struct lod_collapse){ .leaves = 1, .node = &node };
	lod_collapse_node_of(&node, leaf, 0);
	uint32_t count = lod_collapse_corners(&collapse, leaf, 0, corner);
	double length = lod_v3_length(node.half[0]), wide = lod_v3_length(node.half[1]);
	for (uint32_t k = 0; k < count; k++) {
		struct lod_v3 d = lod_v3_sub(corner[k], node.center);
		at[k] = (struct flat){ length > 0 ? lod_v3_dot(d, node.half[0]) / (length * length) : 0,
			wide > 0 ? lod_v3_dot(d, node.half[1]) / (wide * wide) : 0, uv ? (double)uv[k][0] : 0,
			uv ? (double)uv[k][1] : 0 };
	}
	return length > 0 ? wide / length : 0;
}

void lod_collapse_shape_make(struct lod_collapse_shape *shape, const float (*corner)[3],
	const float (*uv)[2], uint32_t corners, const struct eco_image *cutout)
{
	const uint32_t first[2] = { 0, corners };
	struct flat at[ECO_CORNERS_MAX];
	shape->wide = flatten(at, &(struct lod_collapse_leaves){ 1, first, corner, NULL, 0, 0 }, uv);
	for (uint32_t y = 0; y < LOD_COLLAPSE_SHAPE; y++)
		for (uint32_t x = 0; x < LOD_COLLAPSE_SHAPE; x++)
			shape->opaque[y][x] = covered(at, corners, (2 * x + 1.0) / LOD_COLLAPSE_SHAPE - 1,
				(2 * y + 1.0) / LOD_COLLAPSE_SHAPE - 1, uv ? cutout : NULL);
}

/* ---- Counting ---- */

struct bin { uint32_t count; double area, opaque, distance, turn, wide, high, leaves; };
struct count { struct bin pair[DISTANCES][TURNS], density[LOD_COLLAPSE_CLASSES][DENSITIES]; };

/* Of a quad of two leaves: centres' distance over the leaves' lengths, and the angle between their main axes
 * as they lie in the quad's plane. */
static void pose_of(const struct lod_collapse *c, const struct lod_collapse_node *quad, double *distance,
	double *turn)
{
	const struct lod_collapse_node *a = &c->node[quad->child[0]], *b = &c->node[quad->child[1]];
	struct lod_v3 x = lod_v3_unit(quad->half[0]), y = lod_v3_unit(quad->half[1]),
		d = lod_v3_sub(b->center, a->center);
	double ax = lod_v3_dot(a->half[0], x), ay = lod_v3_dot(a->half[0], y),
		bx = lod_v3_dot(b->half[0], x), by = lod_v3_dot(b->half[0], y);
	double length = lod_v3_length(a->half[0]) + lod_v3_length(b->half[0]),
		product = sqrt((ax * ax + ay * ay) * (bx * bx + by * by));
	*distance = length > 0 ? sqrt(lod_v3_dot(d, x) * lod_v3_dot(d, x)
		+ lod_v3_dot(d, y) * lod_v3_dot(d, y)) / length : 0;
	*turn = product > 0 ? lod_arc_cosine(fmin(1, fabs(ax * bx + ay * by) / product)) : 0;
}

static uint32_t bin_of(double share, uint32_t bins)
{
	return share >= 1 ? bins - 1 : share > 0 ? (uint32_t)(share * bins) : 0;
}

static uint32_t class_of(uint32_t leaves)
{
	return leaves <= 4 ? 0 : leaves <= 8 ? 1 : leaves <= 32 ? 2 : 3;
}

static struct bin *find_bin(struct count *count, const struct lod_collapse *c,
	const struct lod_collapse_node *quad, double *distance, double *turn)
{
	*distance = *turn = 0;
	if (quad->represents == 2) {
		pose_of(c, quad, distance, turn);
		return &count->pair[bin_of(*distance / (DISTANCES * 0.25), DISTANCES)]
			[bin_of(*turn / (LOD_PI / 2), TURNS)];
	}
	return &count->density[class_of(quad->represents)]
		[bin_of(quad->area > 0 ? quad->opaque_area / quad->area : 0, DENSITIES)];
}

static void count_quads(struct count *count, const struct lod_collapse *c)
{
	for (uint32_t i = c->leaves; i < c->leaves + c->made; i++) {
		const struct lod_collapse_node *quad = &c->node[i], *a = &c->node[quad->child[0]],
			*b = &c->node[quad->child[1]];
		double distance, turn, half = (lod_v3_length(a->half[0]) + lod_v3_length(b->half[0])) / 2;
		struct bin *bin = find_bin(count, c, quad, &distance, &turn);
		bin->count++;
		bin->area += quad->area;
		bin->opaque += quad->opaque_area;
		bin->distance += distance;
		bin->turn += turn;
		bin->wide += half > 0 ? lod_v3_length(quad->half[0]) / half : 0;
		bin->high += half > 0 ? lod_v3_length(quad->half[1]) / half : 0;
		bin->leaves += quad->represents;
	}
}

/* The `most` bins of greatest count, each taken once; returns how many have any. Ties: the first. */
static uint32_t commonest(const struct bin *bins, uint32_t count, uint32_t most, uint32_t *chosen)
{
	uint32_t n = 0;
	while (n < most) {
		uint32_t best = ECO_NONE;
		for (uint32_t i = 0; i < count; i++) {
			bool taken = false;
			for (uint32_t k = 0; k < n; k++)
				taken = taken || chosen[k] == i;
			if (!taken && bins[i].count && (best == ECO_NONE || bins[i].count > bins[best].count))
				best = i;
		}
		if (best == ECO_NONE)
			break;
		chosen[n++] = best;
	}
	return n;
}

/* ---- Painting ---- */

struct leaf { double x, y, along[2]; };      /* in units of a leaf's half length; along: unit */
struct sheet {                   /* a tile being painted */
	uint32_t side, count;
	double wide, high;           /* half of the quad, same units */
	struct leaf leaves[LEAVES_MOST];
};

/* The leaves, `grow` times as long, in white on black; returns the opaque share. */
static double paint(const struct sheet *sheet, const struct lod_collapse_shape *shape, double grow,
	bool *texel)
{
	uint32_t opaque = 0, side = sheet->side;
	for (uint32_t i = 0; i < side * side; i++) {
		double x = ((2 * (i % side) + 1.0) / side - 1) * sheet->wide,
			y = ((2 * (i / side) + 1.0) / side - 1) * sheet->high;
		texel[i] = false;
		for (uint32_t k = 0; k < sheet->count && !texel[i]; k++) {
			const struct leaf *leaf = &sheet->leaves[k];
			double dx = (x - leaf->x) / grow, dy = (y - leaf->y) / grow;
			double u = dx * leaf->along[0] + dy * leaf->along[1],
				aside = dy * leaf->along[0] - dx * leaf->along[1],
				v = shape->wide > 0 ? aside / shape->wide : 2;
			if (fabs(u) < 1 && fabs(v) < 1)
				texel[i] = shape->opaque[(uint32_t)((v + 1) / 2 * LOD_COLLAPSE_SHAPE)]
					[(uint32_t)((u + 1) / 2 * LOD_COLLAPSE_SHAPE)];
		}
		opaque += texel[i];
	}
	return (double)opaque / (side * side);
}

/* As large leaves as make the tile's density; a density of 1 is opaque all over. */
static void paint_dense(const struct sheet *sheet, const struct lod_collapse_shape *shape, double density,
	bool *texel)
{
	double low = 0.01, high = GROW_MOST;
	for (int i = 0; i < HALVINGS && density < 1; i++) {
		double grow = sqrt(low * high);
		if (paint(sheet, shape, grow, texel) < density)
			low = grow;
		else
			high = grow;
	}
	/* a shape with holes, or none at all, cannot be so dense */
	if (density >= 1 || paint(sheet, shape, sqrt(low * high), texel) < density - 0.1)
		for (uint32_t i = 0; i < sheet->side * sheet->side; i++)
			texel[i] = density >= 0.5 || texel[i];
}

static void put_tile(struct lod_collapse_atlas *atlas, struct lod_collapse_tile *tile, const bool *texel,
	const uint8_t rgb[3])
{
	for (uint32_t i = 0; i < tile->side * tile->side; i++) {
		size_t at = (size_t)(tile->y + i / tile->side) * WIDTH + tile->x + i % tile->side;
		memcpy(atlas->image.rgba + 4 * at, rgb, 3);
		atlas->image.rgba[4 * at + 3] = texel[i] ? 255 : 0;
	}
}

/* (cos, sin) of half an angle in [0, pi / 2], by its cosine. */
static void half_turn(double turn, double out[2])
{
	double t = turn / 2, c = 1 - t * t / 2 + t * t * t * t / 24;     /* within 1e-3 up to 45 degrees */
	out[0] = c;
	out[1] = sqrt(1 - c * c);
}

static void pair_sheet(struct sheet *sheet, const struct bin *bin)
{
	double cs[2], apart = bin->distance / bin->count;    /* half of it, in half lengths: the same */
	half_turn(bin->turn / bin->count, cs);
	*sheet = (struct sheet){ .side = PAIR_SIDE, .count = 2, .wide = bin->wide / bin->count,
		.high = bin->high / bin->count, .leaves = { { -apart, 0, { cs[0], cs[1] } },
		{ apart, 0, { cs[0], -cs[1] } } } };
}

static double unit_of(uint32_t number) { return eco_random_unit(eco_random(17, number)); }

/* Strewn by the two ratios of the plastic number, which leave no gap; turned at random. */
static void strewn_sheet(struct sheet *sheet, const struct bin *bin)
{
	double leaves = bin->leaves / bin->count, high = bin->wide > 0 ? bin->high / bin->wide : 1;
	*sheet = (struct sheet){ .side = SIDE, .count = leaves < LEAVES_MOST ? (uint32_t)(leaves + 0.5)
		: LEAVES_MOST, .wide = 1, .high = high > 0 ? high : 1 };
	for (uint32_t k = 0; k < sheet->count; k++) {
		double x = 0.5 + 0.7548776662466927 * k, y = 0.5 + 0.5698402909980532 * k;
		double cs[2];
		half_turn(LOD_PI / 2 * unit_of(2 * k), cs);
		double sign = unit_of(2 * k + 1) < 0.5 ? -1 : 1;
		bool across = unit_of(2 * k + 1) > 0.25 && unit_of(2 * k + 1) < 0.75;
		sheet->leaves[k] = (struct leaf){ (2 * (x - floor(x)) - 1) * sheet->wide,
			(2 * (y - floor(y)) - 1) * sheet->high, { cs[across], sign * cs[!across] } };
	}
}

/* ---- The atlas ---- */

struct choice { uint32_t pair[LOD_COLLAPSE_PAIR_TILES], pairs,
	density[LOD_COLLAPSE_CLASSES][LOD_COLLAPSE_DENSITIES], densities[LOD_COLLAPSE_CLASSES]; };

static void make_tile(struct lod_collapse_atlas *atlas, uint32_t index, const struct bin *bin,
	const struct lod_collapse_shape *shape, const uint8_t rgb[3])
{
	bool texel[PAIR_SIDE * PAIR_SIDE];
	struct lod_collapse_tile *tile = &atlas->tile[index];
	struct sheet sheet;
	bool pair = index < LOD_COLLAPSE_PAIR_TILES;
	uint32_t k = index - LOD_COLLAPSE_PAIR_TILES, row = WIDTH / SIDE;
	if (pair)
		pair_sheet(&sheet, bin);
	else
		strewn_sheet(&sheet, bin);
	*tile = (struct lod_collapse_tile){ .x = pair ? index * PAIR_SIDE : k % row * SIDE,
		.y = pair ? 0 : PAIR_SIDE + k / row * SIDE, .side = sheet.side,
		.density = bin->area > 0 ? fmin(1, bin->opaque / bin->area) : 1,
		.distance = bin->distance / bin->count, .turn = bin->turn / bin->count };
	paint_dense(&sheet, shape, tile->density, texel);
	put_tile(atlas, tile, texel, rgb);
}

static void make_tiles(struct lod_collapse_atlas *atlas, const struct count *count, struct choice *choice,
	const struct lod_collapse_shape *shape, const uint8_t rgb[3])
{
	choice->pairs = commonest(&count->pair[0][0], DISTANCES * TURNS, LOD_COLLAPSE_PAIR_TILES,
		choice->pair);
	for (uint32_t i = 0; i < choice->pairs; i++)
		make_tile(atlas, i, &count->pair[0][0] + choice->pair[i], shape, rgb);
	for (uint32_t c = 0; c < LOD_COLLAPSE_CLASSES; c++) {
		choice->densities[c] = commonest(count->density[c], DENSITIES, LOD_COLLAPSE_DENSITIES,
			choice->density[c]);
		for (uint32_t i = 0; i < choice->densities[c]; i++)
			make_tile(atlas, LOD_COLLAPSE_PAIR_TILES + c * LOD_COLLAPSE_DENSITIES + i,
				&count->density[c][choice->density[c][i]], shape, rgb);
	}
}

/* Among the tiles of its level. */
static uint32_t nearest(const struct lod_collapse_atlas *atlas, const struct choice *choice,
	const struct lod_collapse *c, const struct lod_collapse_node *quad)
{
	bool pair = quad->represents == 2;
	uint32_t class = pair ? 0 : class_of(quad->represents), best = 0,
		first = pair ? 0 : LOD_COLLAPSE_PAIR_TILES + class * LOD_COLLAPSE_DENSITIES,
		count = pair ? choice->pairs : choice->densities[class];
	double density = quad->area > 0 ? fmin(1, quad->opaque_area / quad->area) : 1, distance, turn,
		least = INFINITY;
	if (pair)
		pose_of(c, quad, &distance, &turn);
	for (uint32_t i = first; i < first + count; i++) {
		const struct lod_collapse_tile *tile = &atlas->tile[i];
		double off = pair ? fabs(tile->distance - distance) / 0.25 + fabs(tile->turn - turn)
			/ (LOD_PI / 8) : fabs(tile->density - density);
		if (off < least) {
			least = off;
			best = i;
		}
	}
	return best;
}

void lod_collapse_atlas_make(struct lod_collapse_atlas *atlas, const struct lod_collapse *forests,
	uint32_t count, const struct lod_collapse_shape *shape, const uint8_t rgb[3],
	struct lod_arena *arena)
{
	struct choice choice;
	*atlas = (struct lod_collapse_atlas){
		.image = { WIDTH, HEIGHT, lod_arena_take(arena, (size_t)WIDTH * HEIGHT, 4) },
		.of = lod_arena_take(arena, count, sizeof *atlas->of) };
	struct count *counted = lod_arena_take(arena, 1, sizeof *counted);
	for (uint32_t s = 0; s < count; s++)
		count_quads(counted, &forests[s]);
	make_tiles(atlas, counted, &choice, shape, rgb);
	for (uint32_t s = 0; s < count; s++) {
		const struct lod_collapse *c = &forests[s];
		atlas->of[s] = lod_arena_take(arena, c->made, sizeof **atlas->of);
		for (uint32_t i = 0; i < c->made; i++) {
			uint32_t tile = nearest(atlas, &choice, c, &c->node[c->leaves + i]);
			atlas->of[s][i] = (uint8_t)tile;
			atlas->tile[tile].quads++;
		}
	}
}

/* A quarter of a texel inside, so that no sample falls into the tile beside it. */
void lod_collapse_atlas_uv(const struct lod_collapse_atlas *atlas, uint32_t index, float uv[4][2])
{
	const struct lod_collapse_tile *tile = &atlas->tile[index];
	const double low[2] = { (tile->x + 0.25) / WIDTH, (tile->y + 0.25) / HEIGHT },
		high[2] = { (tile->x + tile->side - 0.25) / WIDTH, (tile->y + tile->side - 0.25) / HEIGHT };
	for (int k = 0; k < 4; k++) {
		uv[k][0] = (float)(k == 1 || k == 2 ? high[0] : low[0]);
		uv[k][1] = (float)(k >= 2 ? high[1] : low[1]);
	}
}

double lod_collapse_atlas_share(const struct lod_collapse_atlas *atlas, uint32_t index)
{
	const struct lod_collapse_tile *tile = &atlas->tile[index];
	uint32_t opaque = 0;
	for (uint32_t i = 0; i < tile->side * tile->side; i++)
		opaque += atlas->image.rgba[4 * ((size_t)(tile->y + i / tile->side) * WIDTH + tile->x
			+ i % tile->side) + 3] >= 128;
	return tile->side ? (double)opaque / (tile->side * tile->side) : 0;
}
