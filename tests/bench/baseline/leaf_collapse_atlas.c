/* Textures of the quads that leaf collapse makes: leaf_collapse.h says which. */
#include <string.h>

#include "ecofiles/base/random.h"
#include "tests/bench/baseline/leaf_collapse.h"

#define WIDTH 1024u
#define HEIGHT 256u
#define PAIR_SIDE 128u
#define SIDE 64u
#define LEAVES_MOST 16u          /* drawn in one tile */
#define DISTANCES 8u             /* bins of a quarter of the leaves' length */
#define TURNS 4u                 /* bins of 22.5 degrees */
#define DENSITIES 16u            /* bins */
#define BINS (DISTANCES * TURNS)
#define HALVINGS 16
#define GROW_MOST 16.0           /* of a tile's leaves */
#define SHAPE 64u
#define FAR 1e5                  /* eye's distance over a leaf's length */

/* ---- A leaf's shape ---- */

/* Its silhouette in the rectangle along its longest extent, as bits of rows. */
struct shape {
	uint64_t row[SHAPE];
	double wide;                 /* the rectangle's width over its length */
};

/* Seen straight onto its plane, from so far away that lines of sight are parallel. */
static void make_shape(struct shape *shape, const struct lod_fan *fan, struct lod_arena *arena)
{
	struct lod_collapse_node node;
	lod_collapse_node_of(&node, fan->corner, fan->corners);
	double length = lod_v3_length(node.half[0]), wide = lod_v3_length(node.half[1]);
	*shape = (struct shape){ .wide = length > 0 ? wide / length : 0 };
	if (!(shape->wide > 0))
		return;
	struct lod_footprint *print = lod_arena_take(arena, 1, sizeof *print);
	struct lod_v3 u = lod_v3_unit(node.half[0]), v = lod_v3_unit(node.half[1]), n = lod_v3_cross(u, v),
		at = lod_v3_add(node.center, lod_v3_scale(n, FAR * length));
	const struct lod_eye eye = { .at = { at.x, at.y, at.z }, .right = { u.x, u.y, u.z },
		.up = { -v.x, -v.y, -v.z }, .forward = { -n.x, -n.y, -n.z }, .tan_x = 1 / FAR,
		.tan_y = wide / length / FAR };
	struct lod_fan_seen seen;
	lod_fan_see(&seen, fan, &eye);
	if (lod_fan_cover(print, &seen, 1, SHAPE))
		for (uint32_t y = 0; y < print->rows; y++)
			shape->row[print->y + y] = print->bits[(size_t)y * print->words];
}

/* ---- Counting ---- */

struct bin { uint32_t count; double area, opaque, distance, turn, wide, high, leaves; };
/* Class 0: quads of two leaves by pose, DISTANCES x TURNS bins. The other classes: DENSITIES bins. */
struct count { struct bin bin[LOD_COLLAPSE_CLASSES][BINS]; };

/* The pose of two leaves: centres' distance over the leaves' lengths, and the angle between their main axes
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
	return leaves <= 2 ? 0 : leaves <= 4 ? 1 : leaves <= 8 ? 2 : leaves <= 32 ? 3 : 4;
}

static double density_of(const struct lod_collapse_node *quad)
{
	return quad->area > 0 ? quad->opaque_area / quad->area : 0;
}

static void count_quads(struct count *count, const struct lod_collapse *c)
{
	for (uint32_t i = c->leaves; i < c->leaves + c->made; i++) {
		const struct lod_collapse_node *quad = &c->node[i], *a = &c->node[quad->child[0]],
			*b = &c->node[quad->child[1]];
		double distance, turn, half = (lod_v3_length(a->half[0]) + lod_v3_length(b->half[0])) / 2;
		pose_of(c, quad, &distance, &turn);
		struct bin *bin = &count->bin[class_of(quad->represents)][quad->represents > 2
			? bin_of(density_of(quad), DENSITIES) : TURNS * bin_of(distance / (DISTANCES * 0.25),
			DISTANCES) + bin_of(turn / (LOD_PI / 2), TURNS)];
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

/* The bin of greatest count, the first of equals; NULL if all are empty. */
static struct bin *commonest(struct bin bins[BINS])
{
	struct bin *best = bins;
	for (struct bin *bin = bins; bin < bins + BINS; bin++)
		best = bin->count > best->count ? bin : best;
	return best->count ? best : NULL;
}

/* ---- Painting ---- */

struct leaf { double x, y, along[2]; };      /* in units of a leaf's half length; along: unit */
struct sheet {                   /* a tile being painted */
	uint32_t side, count;
	double wide, high;           /* half of the quad, same units */
	struct leaf leaves[LEAVES_MOST];
};

/* The leaves, `grow` times as long, in white on black; returns the opaque share. */
static double paint(const struct sheet *sheet, const struct shape *shape, double grow,
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
				texel[i] = shape->row[(uint32_t)((v + 1) / 2 * SHAPE)]
					>> (uint32_t)((u + 1) / 2 * SHAPE) & 1;
		}
		opaque += texel[i];
	}
	return (double)opaque / (side * side);
}

/* As large leaves as make the tile's density; a density of 1 is opaque all over. */
static void paint_dense(const struct sheet *sheet, const struct shape *shape, double density,
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

static void make_tile(struct lod_collapse_atlas *atlas, uint32_t index, const struct bin *bin,
	const struct shape *shape, const uint8_t rgb[3])
{
	bool texel[PAIR_SIDE * PAIR_SIDE], pair = index < LOD_COLLAPSE_CLASS_TILES;
	struct sheet sheet;
	uint32_t k = index - LOD_COLLAPSE_CLASS_TILES, row = WIDTH / SIDE;
	if (pair)
		pair_sheet(&sheet, bin);
	else
		strewn_sheet(&sheet, bin);
	struct lod_collapse_tile *tile = &atlas->tile[index];
	*tile = (struct lod_collapse_tile){ .x = pair ? index * PAIR_SIDE : k % row * SIDE,
		.y = pair ? 0 : PAIR_SIDE + k / row * SIDE, .side = sheet.side,
		.density = bin->area > 0 ? fmin(1, bin->opaque / bin->area) : 1,
		.distance = bin->distance / bin->count, .turn = bin->turn / bin->count };
	paint_dense(&sheet, shape, tile->density, texel);
	put_tile(atlas, tile, texel, rgb);
}

/* Among the tiles of its class. */
static uint8_t nearest(const struct lod_collapse_atlas *atlas, const struct lod_collapse *c,
	const struct lod_collapse_node *quad)
{
	uint32_t class = class_of(quad->represents), first = class * LOD_COLLAPSE_CLASS_TILES, best = first;
	double density = quad->area > 0 ? fmin(1, density_of(quad)) : 1, distance, turn, least = INFINITY;
	if (!class)
		pose_of(c, quad, &distance, &turn);
	for (uint32_t i = first; i < first + LOD_COLLAPSE_CLASS_TILES && atlas->tile[i].side; i++) {
		const struct lod_collapse_tile *tile = &atlas->tile[i];
		double off = class ? fabs(tile->density - density) : fabs(tile->distance - distance) / 0.25
			+ fabs(tile->turn - turn) / (LOD_PI / 8);
		best = off < least ? i : best;
		least = fmin(off, least);
	}
	return (uint8_t)best;
}

void lod_collapse_atlas_make(struct lod_collapse_atlas *atlas, const struct lod_collapse *forests,
	uint32_t sectors, const struct lod_fan *leaf, const uint8_t rgb[3], struct lod_arena *arena)
{
	struct shape shape;
	struct bin *bin;
	struct count *counted = lod_arena_take(arena, 1, sizeof *counted);
	*atlas = (struct lod_collapse_atlas){
		.image = { WIDTH, HEIGHT, lod_arena_take(arena, (size_t)WIDTH * HEIGHT, 4) } };
	for (uint32_t s = 0; s < sectors; s++)
		count_quads(counted, &forests[s]);
	make_shape(&shape, leaf, arena);
	for (uint32_t i = 0; i < LOD_COLLAPSE_TILES; i++)
		if ((bin = commonest(counted->bin[i / LOD_COLLAPSE_CLASS_TILES]))) {
			make_tile(atlas, i, bin, &shape, rgb);
			bin->count = 0;
		}
	for (uint32_t s = 0; s < sectors; s++)
		for (uint32_t i = 0; i < forests[s].made; i++) {
			struct lod_collapse_node *quad = &forests[s].node[forests[s].leaves + i];
			quad->tile = nearest(atlas, &forests[s], quad);
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
