#include "tests/bench/collapse/bench_collapse_draw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PANEL 256u
#define PANELS 4u
#define TOP_SIDE 512u
#define DOT 2

static const uint8_t white[3] = { 255, 255, 255 }, green[3] = { 88, 132, 48 }, line[3] = { 40, 40, 40 },
	red[3] = { 200, 60, 40 };

/* White, or NULL without memory. */
static uint8_t *sheet(uint32_t width, uint32_t height, struct eco_error *error)
{
	uint8_t *rgb = malloc(3 * (size_t)width * height);
	if (rgb)
		memset(rgb, 255, 3 * (size_t)width * height);
	else
		eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	return rgb;
}

static enum eco_code finish(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	uint8_t *rgb, struct eco_error *error)
{
	enum eco_code code = bench_picture_write(bench, file, width, height, rgb, error);
	free(rgb);
	return code;
}

/* ---- Figure 1 ---- */

struct flat { double x, y; };
#define SCALE 70.0                       /* pixels a metre */

/* Into the plane of node 2, seen with its main axis to the right. */
static struct flat flatten(const struct lod_collapse *c, struct lod_v3 p)
{
	const struct lod_collapse_node *quad = &c->node[2];
	struct lod_v3 d = lod_v3_sub(p, quad->center);
	return (struct flat){ PANEL / 2 + SCALE * lod_v3_dot(d, lod_v3_unit(quad->half[0])),
		PANEL / 2 - SCALE * lod_v3_dot(d, lod_v3_unit(quad->half[1])) };
}

static bool inside(const struct flat *p, uint32_t count, double x, double y)
{
	bool in = false;
	for (uint32_t i = 0, j = count - 1; i < count; j = i++)
		if ((p[i].y > y) != (p[j].y > y) && x < p[i].x + (p[j].x - p[i].x) * (y - p[i].y)
				/ (p[j].y - p[i].y))
			in = !in;
	return in;
}

static void mark(uint8_t *rgb, uint32_t width, uint32_t panel, int x, int y, const uint8_t color[3])
{
	if (x >= 0 && y >= 0 && x < (int)PANEL && y < (int)PANEL)
		memcpy(rgb + 3 * ((size_t)y * width + panel * PANEL + (uint32_t)x), color, 3);
}

static void outline(uint8_t *rgb, uint32_t width, uint32_t panel, struct flat low, struct flat high,
	const uint8_t color[3])
{
	for (int x = (int)low.x; x <= (int)high.x; x++) {
		mark(rgb, width, panel, x, (int)low.y, color);
		mark(rgb, width, panel, x, (int)high.y, color);
	}
	for (int y = (int)low.y; y <= (int)high.y; y++) {
		mark(rgb, width, panel, (int)low.x, y, color);
		mark(rgb, width, panel, (int)high.x, y, color);
	}
}

static void fill(uint8_t *rgb, uint32_t width, uint32_t panel, const struct flat *p, uint32_t count)
{
	for (uint32_t y = 0; y < PANEL; y++)
		for (uint32_t x = 0; x < PANEL; x++)
			if (inside(p, count, x + 0.5, y + 0.5))
				memcpy(rgb + 3 * ((size_t)y * width + panel * PANEL + x), green, 3);
}

/* The quad with its texture. */
static void fill_tile(uint8_t *rgb, uint32_t width, uint32_t panel, const struct lod_collapse_atlas *atlas,
	double half_x, double half_y)
{
	const struct lod_collapse_tile *tile = &atlas->tile[atlas->of[0][0]];
	for (int y = (int)-half_y; y < (int)half_y; y++)
		for (int x = (int)-half_x; x < (int)half_x; x++) {
			uint32_t u = tile->x + (uint32_t)((x + half_x) / (2 * half_x) * tile->side),
				v = tile->y + (uint32_t)((y + half_y) / (2 * half_y) * tile->side);
			const uint8_t *texel = atlas->image.rgba + 4 * ((size_t)v * atlas->image.width + u);
			if (texel[3] >= 128)
				memcpy(rgb + 3 * ((size_t)((int)PANEL / 2 + y) * width
					+ (uint32_t)((int)(panel * PANEL + PANEL / 2) + x)), green, 3);
		}
}

static void paint_pair(uint8_t *rgb, uint32_t width, struct lod_arena *arena)
{
	static const float corner[8][3] = { { -1.1f, 0, 0 }, { -0.5f, -0.35f, 0.1f }, { 0.3f, 0, 0 },
		{ -0.5f, 0.35f, 0.1f }, { 0.5f, -0.5f, 0 }, { 1.0f, 0.1f, -0.2f }, { 0.9f, 0.9f, -0.1f },
		{ 0.4f, 0.3f, 0.1f } };
	static const uint32_t first[3] = { 0, 4, 8 };
	const struct lod_collapse_leaves leaves = { 2, first, corner, NULL, 0, 0 };
	const struct lod_collapse_options options = { .distance_most = 9, .angle_most_rad = LOD_PI / 2 };
	struct lod_collapse c;
	struct lod_collapse_atlas atlas;
	struct lod_collapse_shape *shape = lod_arena_take(arena, 1, sizeof *shape);
	struct flat low = { INFINITY, INFINITY }, high = { -INFINITY, -INFINITY };
	lod_collapse_make(&c, &leaves, &options, arena);
	lod_collapse_shape_make(shape, corner, NULL, 4, NULL);
	lod_collapse_atlas_make(&atlas, &c, 1, shape, green, arena);
	for (uint32_t i = 0; i < 2; i++) {
		struct flat flat[4];
		for (uint32_t k = 0; k < 4; k++) {
			flat[k] = flatten(&c, lod_v3_of(corner[4 * i + k]));
			low = (struct flat){ fmin(low.x, flat[k].x), fmin(low.y, flat[k].y) };
			high = (struct flat){ fmax(high.x, flat[k].x), fmax(high.y, flat[k].y) };
		}
		fill(rgb, width, 0, flat, 4);
		fill(rgb, width, 1, flat, 4);
	}
	double half_x = SCALE * lod_v3_length(c.node[2].half[0]), half_y = SCALE
		* lod_v3_length(c.node[2].half[1]);
	const struct flat quad[2] = { { PANEL / 2 - half_x, PANEL / 2 - half_y },
		{ PANEL / 2 + half_x, PANEL / 2 + half_y } };
	outline(rgb, width, 1, low, high, line);
	outline(rgb, width, 1, quad[0], quad[1], red);
	outline(rgb, width, 2, quad[0], quad[1], red);
	fill_tile(rgb, width, 2, &atlas, half_x, half_y);
}

enum eco_code bench_collapse_draw_pair(struct bench *bench, const char *file, struct eco_error *error)
{
	struct lod_arena arena = { 0 };
	uint32_t width = 3 * PANEL;
	uint8_t *rgb = sheet(width, PANEL, error);
	if (!rgb)
		return ECO_NO_MEMORY;
	if (setjmp(arena.failed)) {
		lod_arena_free(&arena);
		free(rgb);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for two leaves");
	}
	paint_pair(rgb, width, &arena);
	lod_arena_free(&arena);
	return finish(bench, file, width, PANEL, rgb, error);
}

/* ---- Figure 2 ---- */

enum eco_code bench_collapse_draw_atlas(struct bench *bench, const char *file,
	const struct lod_collapse_atlas *atlas, struct eco_error *error)
{
	const struct eco_image *image = &atlas->image;
	uint8_t *rgb = sheet(image->width, image->height, error);
	if (!rgb)
		return ECO_NO_MEMORY;
	for (uint32_t t = 0; t < LOD_COLLAPSE_TILES; t++) {
		const struct lod_collapse_tile *tile = &atlas->tile[t];
		for (uint32_t i = 0; i < tile->side * tile->side; i++) {
			uint32_t x = i % tile->side, y = i / tile->side;
			size_t at = (size_t)(tile->y + y) * image->width + tile->x + x;
			bool edge = x == 0 || y == 0;
			if (edge || image->rgba[4 * at + 3] >= 128)
				memcpy(rgb + 3 * at, edge ? line : image->rgba + 4 * at, 3);
		}
	}
	return finish(bench, file, image->width, image->height, rgb, error);
}

/* ---- Figure 5 ---- */

enum eco_code bench_collapse_draw_levels(struct bench *bench, const char *file, struct bench_leaves *leaves,
	const struct bench_collapse_plant *plant, const struct lod_sights *sights, uint64_t vertices,
	struct eco_error *error)
{
	uint32_t width = PANELS * leaves->pixels, *order = lod_arena_take(&leaves->arena, plant->leaves,
		sizeof *order);
	uint8_t *rgb = sheet(width, leaves->pixels, error);
	double share = 1;
	if (!rgb)
		return ECO_NO_MEMORY;
	for (uint32_t panel = 0; panel < PANELS; panel++, share /= 4) {
		uint32_t row = bench_collapse_row(plant, 0, share * (double)vertices),
			count = bench_collapse_order(plant, 0, row, order);
		bench_leaves_ids(leaves, sights, 0,
			&(struct lod_sights_drawing){ .order = order, .count = count, .scale = 1 });
		for (size_t i = 0; i < (size_t)leaves->pixels * leaves->pixels; i++) {
			uint8_t *to = rgb + 3 * (i / leaves->pixels * width + panel * leaves->pixels
				+ i % leaves->pixels);
			bench_leaves_color(leaves, i, to);
			if (!leaves->ids.cover[i])
				memcpy(to, white, 3);
		}
	}
	return finish(bench, file, width, leaves->pixels, rgb, error);
}

/* ---- Figure 6 ---- */

static void dot(uint8_t *rgb, int x, int y, const uint8_t color[3])
{
	for (int dy = -DOT; dy <= DOT; dy++)
		for (int dx = -DOT; dx <= DOT; dx++)
			if (x + dx >= 0 && y + dy >= 0 && x + dx < (int)TOP_SIDE && y + dy < (int)TOP_SIDE)
				memcpy(rgb + 3 * ((size_t)(y + dy) * TOP_SIDE + (uint32_t)(x + dx)),
					color, 3);
}

enum eco_code bench_collapse_draw_sectors(struct bench *bench, const char *file,
	const struct lod_foliage *f, const struct lod_collapse_sectors *sectors, struct eco_error *error)
{
	static const uint8_t colors[9][3] = { { 60, 60, 60 }, { 214, 69, 65 }, { 244, 160, 60 },
		{ 230, 210, 70 }, { 120, 180, 70 }, { 40, 140, 110 }, { 60, 150, 210 }, { 70, 80, 180 },
		{ 170, 80, 170 } };
	uint8_t *rgb = sheet(TOP_SIDE, TOP_SIDE, error);
	double most = 0;
	if (!rgb)
		return ECO_NO_MEMORY;
	for (uint32_t i = 0; i < f->count; i++)
		most = fmax(most, fmax(fabs(f->center[i].x), fabs(f->center[i].y)));
	for (uint32_t s = sectors->count; s-- > 0;)      /* the innermost last: it lies over the others */
		for (uint32_t i = sectors->first[s]; i < sectors->first[s + 1] && most > 0; i++) {
			struct lod_v3 at = f->center[sectors->leaf[i]];
			dot(rgb, (int)(TOP_SIDE * (0.5 + 0.48 * at.x / most)),
				(int)(TOP_SIDE * (0.5 - 0.48 * at.y / most)), colors[s % 9]);
		}
	return finish(bench, file, TOP_SIDE, TOP_SIDE, rgb, error);
}
