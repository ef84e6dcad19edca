/* Leaf collapse (Hidalgo, Abad, Camahort 2007) and the paper's figures: the quad of two leaves (1), the atlas
 * (2), an example of a chain and its table of levels (3, 4), sectors (6).
 *
 * The paper compares with nothing and gives no count of leaves, no time and no frame rate; its scenes of
 * millions of trees are a matter of the renderer. The section measures Q of levels drawn as the paper says,
 * with quads of the printed size, and of sectors that each have a level by how they face the eye. Wood is
 * drawn whole. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/sort.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/collapse/bench_collapse.h"

#define LEAVES_LEAST 500u
#define TEST_SEED 90217u                 /* views of bench_species.c */
#define VIEWS_MOST 12u
#define PIXELS 256u
#define PASSES 8                         /* of giving what full sectors leave to the others */
#define WEDGES BENCH_WEDGES
#define READ_QUICK 3u
#define MADE_QUICK 1u
#define TOP_SIDE 512u
#define DOT 5u                           /* pixels of a leaf seen from above */
#define SHARES 6u
static const double shares[SHARES] = { 0.02, 0.05, 0.1, 0.2, 0.3, 0.5 };         /* of all vertices */
static const uint8_t leaf_rgb[3] = { 76, 110, 40 };

enum kind { PRINTED, SECTORS, KINDS };
static const char *const kind_names[KINDS] = { "leaf collapse as printed", "leaf collapse by sectors" };

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves *leaves;
	struct lod_foliage bare;             /* without quads */
	struct lod_sights tests;
	double all;                          /* vertices */
	uint32_t *order;
	double q[KINDS][SHARES];
};

/* ---- Leaves and quads ---- */

static uint32_t element_of(const struct bench_collapse *c, uint32_t sector, uint32_t node)
{
	const struct lod_collapse *forest = &c->sectors.forest[sector];
	return node < forest->leaves ? forest->leaf[node] : c->base[sector] + node - forest->leaves;
}

/* The element whose area is the median: the shape of the leaves in all textures. */
static uint32_t median_leaf(const struct lod_foliage *f, struct lod_arena *arena)
{
	struct lod_keyed *items = lod_arena_take(arena, f->count, sizeof *items);
	for (uint32_t i = 0; i < f->count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(f->area[i]), i };
	lod_sort(arena, items, f->count);
	return items[f->count / 2].value;
}

/* Vertices of every level: two runs; the first only grows. */
static void count_vertices(struct bench_collapse *c, uint32_t sector, const struct lod_foliage *f,
	struct lod_arena *arena)
{
	const struct lod_collapse *forest = &c->sectors.forest[sector];
	uint64_t sum = 0;
	uint32_t done = 0;
	c->vertices[sector] = lod_arena_take(arena, (size_t)forest->made + 1, sizeof *c->vertices[sector]);
	for (uint32_t row = 0; row <= forest->made; row++) {
		for (; done < forest->level[row].a; done++) {
			uint32_t leaf = element_of(c, sector, forest->place[done]);
			sum += 3 * (f->first[leaf + 1] - f->first[leaf] - 2);
		}
		c->vertices[sector][row] = sum + 6 * (uint64_t)forest->level[row].c;
	}
}

static void *grown(struct lod_arena *arena, const void *old, size_t count, size_t room, size_t size)
{
	void *array = lod_arena_take(arena, room, size);
	memcpy(array, old, count * size);
	return array;
}

static void fill_quad(const struct bench_collapse *c, uint32_t sector, uint32_t quad, struct lod_foliage *f)
{
	const struct lod_collapse *forest = &c->sectors.forest[sector];
	const struct lod_collapse_node *node = &forest->node[forest->leaves + quad];
	uint32_t i = c->base[sector] + quad, at = f->first[i];
	struct lod_v3 corner[ECO_CORNERS_MAX];
	f->first[i + 1] = at + lod_collapse_corners(forest, NULL, forest->leaves + quad, corner);
	f->triangle_first[i + 1] = f->triangle_first[i] + 2;
	for (uint32_t k = 0; k < 4; k++) {
		float *to = f->corner[at + k];
		to[0] = (float)corner[k].x, to[1] = (float)corner[k].y, to[2] = (float)corner[k].z;
	}
	lod_collapse_atlas_uv(&c->atlas, c->atlas.of[sector][quad], f->uv + at);
	f->cutout[i] = &c->atlas.image;
	f->center[i] = node->center;
	f->normal[i] = lod_v3_scale(node->normal, node->area);
	f->area[i] = node->opaque_area;
}

void bench_collapse_grow(struct bench_collapse *c, uint32_t sectors, struct lod_foliage *f,
	struct lod_arena *arena)
{
	size_t n = f->count, quads = 0, corners = f->first[n];
	lod_collapse_sectors_make(&c->sectors, sectors, f, NULL, arena);
	for (uint32_t k = 0; k < sectors; k++) {
		c->base[k] = (uint32_t)(n + quads);
		quads += c->sectors.forest[k].made;
		count_vertices(c, k, f, arena);
	}
	uint32_t leaf = median_leaf(f, arena);
	const struct lod_fan shape = lod_foliage_fan(f, leaf);
	lod_collapse_atlas_make(&c->atlas, c->sectors.forest, sectors, &shape, leaf_rgb, arena);
	f->first = grown(arena, f->first, n + 1, n + quads + 1, sizeof *f->first);
	f->triangle_first = grown(arena, f->triangle_first, n + 1, n + quads + 1, sizeof *f->triangle_first);
	f->corner = grown(arena, f->corner, corners, corners + 4 * quads, sizeof *f->corner);
	f->uv = grown(arena, f->uv, corners, corners + 4 * quads, sizeof *f->uv);
	f->cutout = grown(arena, f->cutout, n, n + quads, sizeof *f->cutout);
	if (f->mask)                             /* quads have none: their images are looked up */
		f->mask = grown(arena, f->mask, n, n + quads, sizeof *f->mask);
	f->center = grown(arena, f->center, n, n + quads, sizeof *f->center);
	f->normal = grown(arena, f->normal, n, n + quads, sizeof *f->normal);
	f->area = grown(arena, f->area, n, n + quads, sizeof *f->area);
	for (uint32_t k = 0; k < sectors; k++)
		for (uint32_t i = 0; i < c->sectors.forest[k].made; i++)
			fill_quad(c, k, i, f);
}

uint64_t bench_collapse_level(const struct bench_collapse *c, uint32_t sector, double vertices, uint32_t *order,
	uint32_t *count)
{
	const struct lod_collapse *forest = &c->sectors.forest[sector];
	uint32_t low = 0, high = forest->made;
	while (low < high) {
		uint32_t middle = (low + high + 1) / 2;
		if ((double)c->vertices[sector][middle] <= vertices)
			low = middle;
		else
			high = middle - 1;
	}
	const struct lod_collapse_level *level = &forest->level[low];
	for (uint32_t i = 0; i < level->a + level->c; i++)
		order[(*count)++] = element_of(c, sector, forest->place[i < level->a ? i : level->b + i
			- level->a]);
	return c->vertices[sector][low];
}

/* ---- Quality ---- */

/* 1 for a wedge that faces the eye, 0 for one behind the tree. */
static double facing(const struct lod_collapse *forest, const struct lod_eye *eye)
{
	struct lod_v3 sum = { 0, 0, 0 }, to = { -eye->forward[0], -eye->forward[1], 0 };
	for (uint32_t i = 0; i < forest->leaves; i++)
		sum = lod_v3_add(sum, forest->node[i].center);
	sum.z = 0;
	return 0.5 + 0.5 * lod_v3_dot(lod_v3_unit(sum), to);
}

/* Vertices of each sector: by its weight and size, and none more than it has. */
static void allocate(const struct bench_collapse *c, const struct lod_eye *eye, double vertices, double *given)
{
	double weight[WEDGES], all[WEDGES];
	for (uint32_t k = 0; k < c->sectors.count; k++) {
		const struct lod_collapse *forest = &c->sectors.forest[k];
		all[k] = (double)c->vertices[k][forest->made];
		weight[k] = all[k] * (0.5 + (k ? facing(forest, eye) : 0));
		given[k] = 0;
	}
	for (int pass = 0; pass < PASSES; pass++) {
		double left = vertices, sum = 0;
		for (uint32_t k = 0; k < c->sectors.count; k++) {
			left -= given[k];
			sum += given[k] < all[k] ? weight[k] : 0;
		}
		for (uint32_t k = 0; k < c->sectors.count && sum > 0 && left > 0; k++)
			if (given[k] < all[k])
				given[k] = fmin(all[k], given[k] + left * weight[k] / sum);
	}
}

/* NaN where the coarsest levels have more vertices. */
static double q_of(struct study *s, const struct bench_collapse *c, double vertices)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < s->tests.count; v++) {
		struct lod_sights_drawing drawing = { .order = s->order, .scale = 1 };
		double given[WEDGES];
		uint64_t drawn = 0;
		allocate(c, &s->tests.eyes[v], vertices, given);
		for (uint32_t k = 0; k < c->sectors.count; k++)
			drawn += bench_collapse_level(c, k, given[k], s->order, &drawing.count);
		if ((double)drawn > vertices)
			return NAN;
		bench_leaves_compare(s->leaves, &s->tests, v, &drawing, &sum);
	}
	return bench_wrong_q(&sum);
}

/* ---- Pictures ---- */

/* Figure 2, with the upper and left edges of tiles. */
static enum eco_code draw_atlas(struct study *s, const struct lod_collapse_atlas *atlas,
	struct eco_error *error)
{
	static const uint8_t line[3] = { 40, 40, 40 };
	const struct eco_image *image = &atlas->image;
	uint8_t *rgb = lod_arena_take(&s->leaves->arena, (size_t)image->width * image->height, 3);
	char file[128];
	memset(rgb, 255, 3 * (size_t)image->width * image->height);
	for (uint32_t t = 0; t < LOD_COLLAPSE_CLASSES * LOD_COLLAPSE_CLASS_TILES; t++) {
		const struct lod_collapse_tile *tile = &atlas->tile[0][0] + t;
		for (uint32_t i = 0; i < tile->side * tile->side; i++) {
			uint32_t x = i % tile->side, y = i / tile->side;
			size_t at = (size_t)(tile->y + y) * image->width + tile->x + x;
			bool edge = x == 0 || y == 0;
			if (edge || image->rgba[4 * at + 3] >= 128)
				memcpy(rgb + 3 * at, edge ? line : image->rgba + 4 * at, 3);
		}
	}
	snprintf(file, sizeof file, "collapse-%s-atlas.png", s->name);
	return bench_picture_write(s->bench, file, image->width, image->height, rgb, error);
}

/* Figure 6: leaves from above as dots, in the colours of their sectors. The innermost lies over the
 * others. */
static enum eco_code draw_sectors(struct study *s, const struct lod_collapse_sectors *sectors,
	struct eco_error *error)
{
	static const uint8_t colors[WEDGES][3] = { { 60, 60, 60 }, { 214, 69, 65 }, { 244, 160, 60 },
		{ 230, 210, 70 }, { 120, 180, 70 }, { 40, 140, 110 }, { 60, 150, 210 }, { 70, 80, 180 },
		{ 170, 80, 170 } };
	const struct lod_foliage *f = &s->bare;
	uint8_t *rgb = lod_arena_take(&s->leaves->arena, (size_t)TOP_SIDE * TOP_SIDE, 3);
	double most = 0;
	char file[128];
	memset(rgb, 255, 3 * (size_t)TOP_SIDE * TOP_SIDE);
	for (uint32_t i = 0; i < f->count; i++)
		most = fmax(most, fmax(fabs(f->center[i].x), fabs(f->center[i].y)));
	for (uint32_t k = sectors->count; k-- > 0;)
		for (uint32_t i = DOT * DOT * sectors->first[k]; i < DOT * DOT * sectors->first[k + 1]; i++) {
			struct lod_v3 at = f->center[sectors->leaf[i / (DOT * DOT)]];
			uint32_t x = (uint32_t)((1 + 0.96 * at.x / most) / 2 * (TOP_SIDE - DOT)) + i % DOT,
				y = (uint32_t)((1 - 0.96 * at.y / most) / 2 * (TOP_SIDE - DOT)) + i / DOT % DOT;
			memcpy(rgb + 3 * (y * TOP_SIDE + x), colors[k], 3);
		}
	snprintf(file, sizeof file, "collapse-%s-sectors.png", s->name);
	return bench_picture_write(s->bench, file, TOP_SIDE, TOP_SIDE, rgb, error);
}

/* ---- One plant ---- */

/* The number of leaves, then a row of Q for each kind. */
static enum eco_code study_leaves(void *ctx, struct bench_leaves *leaves, json_t **out,
	struct eco_error *error)
{
	struct study *s = ctx;
	double to[VIEWS_MOST][3];
	uint32_t views = s->bench->full ? VIEWS_MOST : VIEWS_MOST / 2;
	s->leaves = leaves;
	s->bare = leaves->foliage;
	s->order = lod_arena_take(&leaves->arena, s->bare.count, sizeof *s->order);
	lod_directions_spread(to, views, TEST_SEED);
	enum eco_code code = lod_sights_make(&s->tests, &leaves->foliage, (const double (*)[3])to, views,
		PIXELS, &leaves->arena, error);
	for (uint32_t i = 0; i < s->bare.count; i++)
		s->all += 3 * (s->bare.first[i + 1] - s->bare.first[i] - 2);
	*out = json_pack("[i]", (int)s->bare.count);
	for (int kind = 0; kind < KINDS && !code; kind++) {
		struct bench_collapse crown;
		leaves->foliage = s->bare;
		bench_collapse_grow(&crown, kind == SECTORS ? WEDGES : 1, &leaves->foliage, &leaves->arena);
		for (uint32_t i = 0; i < SHARES; i++)
			s->q[kind][i] = q_of(s, &crown, shares[i] * s->all);
		code = kind == SECTORS ? draw_sectors(s, &crown.sectors, error)
			: draw_atlas(s, &crown.atlas, error);
		json_array_append_new(*out, bench_reals(s->q[kind], SHARES));
	}
	return code;
}

static enum eco_code study_plant(struct bench *bench, const struct bench_model *model,
	struct bench_table *table, double sum[KINDS][SHARES], struct eco_error *error)
{
	char name[96], stamp[64], file[128];
	json_t *unit;
	struct study s = { .bench = bench, .name = model->name };
	snprintf(name, sizeof name, "collapse-%s", model->name);
	snprintf(stamp, sizeof stamp, "%d %016llx", bench->full,
		(unsigned long long)bench_file_hash(model->path));
	enum eco_code code = bench_leaves_unit(bench, &(struct bench_leaves_unit){ name, stamp, model, PIXELS,
		study_leaves, &s, NULL }, &unit, error);
	for (int kind = 0; kind < KINDS && !code; kind++) {
		double q[SHARES];
		bench_cells(json_array_get(unit, (size_t)kind + 1), q, SHARES);
		for (uint32_t i = 0; i < SHARES; i++)
			sum[kind][i] += q[i];
		bench_table_row(table, "%s,%d,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", model->name,
			(int)json_integer_value(json_array_get(unit, 0)), kind_names[kind], q[0], q[1], q[2],
				q[3], q[4], q[5]);
	}
	snprintf(file, sizeof file, "collapse-%s-atlas.png", model->name);
	bench_picture(bench, file, "its atlas: pairs of leaves, then classes of counts by density");
	snprintf(file, sizeof file, "collapse-%s-sectors.png", model->name);
	bench_picture(bench, file, "its sectors from above");
	return code;
}

/* ---- Figures 1, 3 and 4: made leaves ---- */

#define FAR 1e4
#define CHAIN_LEAVES 10u
#define CROWN_RADIUS 5.0
#define LEAF_HALF 0.05

/* A raster of square metres seen along `forward`, with `half` metres from the middle to each side. */
static enum eco_code open_canvas(struct lod_raster *raster, uint32_t side, struct lod_v3 middle,
	struct lod_v3 right, struct lod_v3 up, double half, struct eco_error *error)
{
	struct lod_v3 back = lod_v3_cross(right, up), at = lod_v3_add(middle, lod_v3_scale(back, FAR * half));
	const struct lod_eye eye = { .at = { at.x, at.y, at.z }, .right = { right.x, right.y, right.z },
		.up = { up.x, up.y, up.z }, .forward = { -back.x, -back.y, -back.z }, .tan_x = 1 / FAR,
		.tan_y = 1 / FAR, .pixel_rad = 2 / FAR / side };
	enum eco_code code = lod_raster_init(raster, &(struct lod_raster_options){ .width = side,
		.height = side, .owner = true }, error);
	if (code)
		return code;
	lod_raster_camera(raster, &eye, half);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	return ECO_OK;
}

/* Colours by owner, from 1; white where nothing is. */
static void paint_canvas(const struct lod_raster *raster, const uint8_t (*colors)[3], uint8_t *rgb,
	size_t stride)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	for (size_t i = 0; i < (size_t)raster->width * raster->height; i++)
		memcpy(rgb + 3 * (i / raster->width * stride + i % raster->width), raster->owner[i]
			? colors[raster->owner[i] - 1] : white, 3);
}

static void draw_quad(struct lod_raster *raster, const struct lod_v3 corner[4], const float (*uv)[2],
	const struct eco_image *cutout, uint64_t owner)
{
	float position[18], at[12];
	for (uint32_t i = 0; i < 6; i++) {
		static const uint32_t which[6] = { 0, 1, 2, 0, 2, 3 };
		struct lod_v3 p = corner[which[i]];
		position[3 * i] = (float)p.x, position[3 * i + 1] = (float)p.y, position[3 * i
			+ 2] = (float)p.z;
		for (int k = 0; k < 2; k++)
			at[2 * i + (uint32_t)k] = uv ? uv[which[i]][k] : 0;
	}
	lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = 2, .position = position, .uv = at,
		.cutout = cutout, .owner = owner });
}

/* A rectangle in the plane of the quad and before it, as four thin quads. */
static void draw_frame(struct lod_raster *raster, const struct lod_collapse_node *quad, const double low[2],
	const double high[2], uint64_t owner)
{
	struct lod_v3 axis[2] = { lod_v3_unit(quad->half[0]), lod_v3_unit(quad->half[1]) },
		front = lod_v3_add(quad->center, lod_v3_cross(axis[0], axis[1]));
	for (int side = 0; side < 4; side++) {
		double from[2] = { low[0], low[1] }, to[2] = { high[0], high[1] };
		*(side % 2 ? &from[side / 2] : &to[side / 2]) = side % 2 ? high[side / 2] - 0.015
			: low[side / 2] + 0.015;
		struct lod_v3 corner[4];
		for (int k = 0; k < 4; k++)
			corner[k] = lod_v3_add(front, lod_v3_add(lod_v3_scale(axis[0], k == 1 || k == 2
				? to[0]
				: from[0]), lod_v3_scale(axis[1], k < 2 ? from[1] : to[1])));
		draw_quad(raster, corner, NULL, NULL, owner);
	}
}

/* Figure 1: two leaves; what encloses them and the quad in their place; the quad with its texture. */
static enum eco_code paint_pair(uint8_t *rgb, struct lod_arena *arena, struct eco_error *error)
{
	static float corner[8][3] = { { -1.1f, 0, 0 }, { -0.5f, -0.35f, 0.1f }, { 0.3f, 0, 0 },
		{ -0.5f, 0.35f, 0.1f }, { 0.5f, -0.5f, 0 }, { 1.0f, 0.1f, -0.2f }, { 0.9f, 0.9f, -0.1f },
		{ 0.4f, 0.3f, 0.1f } };
	static uint32_t first[3] = { 0, 4, 8 };
	static const uint8_t colors[3][3] = { { 88, 132, 48 }, { 40, 40, 40 }, { 200, 60, 40 } };
	const struct lod_foliage leaves = { .count = 2, .first = first, .corner = corner };
	struct lod_collapse c;
	struct lod_collapse_atlas atlas;
	struct lod_raster raster;
	lod_collapse_make(&c, &leaves, &(struct lod_collapse_options){ .distance_most = 9,
		.angle_most_rad = LOD_PI / 2 }, NULL, 0, NULL, arena);
	lod_collapse_atlas_make(&atlas, &c, 1, &(struct lod_fan){ .corner = (const float (*)[3])corner,
		.corners = 4 }, colors[0],
		arena);
	const struct lod_collapse_node *quad = &c.node[2];
	struct lod_v3 p[3][ECO_CORNERS_MAX], right = lod_v3_unit(quad->half[0]),
		up = lod_v3_unit(quad->half[1]);
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY },
		half[2] = { lod_v3_length(quad->half[0]), lod_v3_length(quad->half[1]) };
	enum eco_code code = open_canvas(&raster, PIXELS, quad->center, right, up, 1.83, error);
	for (uint32_t i = 0; i < 3; i++)
		for (uint32_t k = 0; k < lod_collapse_corners(&c, &leaves, i, p[i]) && i < 2; k++)
			for (int a = 0; a < 2; a++) {
				double at = lod_v3_dot(lod_v3_sub(p[i][k], quad->center), a ? up : right);
				low[a] = fmin(low[a], at);
				high[a] = fmax(high[a], at);
			}
	for (size_t panel = 0; panel < 3 && !code; panel++) {
		float uv[4][2];
		lod_raster_clear(&raster);
		lod_collapse_atlas_uv(&atlas, atlas.of[0][0], uv);
		for (uint32_t i = 0; i < 2 && panel < 2; i++)
			draw_quad(&raster, p[i], NULL, NULL, 1);
		if (panel == 1)
			draw_frame(&raster, quad, low, high, 2);
		if (panel == 2)
			draw_quad(&raster, p[2], (const float (*)[2])uv, &atlas.image, 1);
		if (panel)
			draw_frame(&raster, quad, (const double[2]){ -half[0], -half[1] }, half, 3);
		paint_canvas(&raster, colors, rgb + 3 * panel * PIXELS, 3 * (size_t)PIXELS);
	}
	lod_raster_free(&raster);
	return code;
}

static double dice(uint64_t *state) { return 2 * eco_random_unit(eco_random_next(state)) - 1; }

/* A square in a ball. */
static void strew(uint64_t *state, float corner[4][3])
{
	static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
	struct lod_v3 at, n;
	do
		at = (struct lod_v3){ dice(state), dice(state), dice(state) };
	while (lod_v3_dot(at, at) > 1);
	n = (struct lod_v3){ dice(state), dice(state), dice(state) };
	struct lod_v3 along = lod_v3_scale(lod_v3_unit(lod_v3_cross(n, (struct lod_v3){ 0, 0, 1 })),
		LEAF_HALF),
		across = lod_v3_scale(lod_v3_unit(lod_v3_cross(n, along)), LEAF_HALF);
	for (uint32_t k = 0; k < 4; k++) {
		struct lod_v3 p = lod_v3_add(lod_v3_scale(at, CROWN_RADIUS), lod_v3_add(lod_v3_scale(along,
			sign[k][0]), lod_v3_scale(across, sign[k][1])));
		corner[k][0] = (float)p.x, corner[k][1] = (float)p.y, corner[k][2] = (float)p.z;
	}
}

/* Numbers up to 9 are leaves, the others quads in the order of their collapses. */
static void write_chain(struct bench *bench, struct lod_arena *arena)
{
	struct lod_collapse c;
	struct lod_collapse_options options = lod_collapse_defaults;
	float corner[4 * CHAIN_LEAVES][3];
	uint32_t first[CHAIN_LEAVES + 1] = { 0 };
	uint64_t state = 2007;
	bench_head(bench, "A chain and its table of levels");
	struct bench_table *table = bench_table_open(bench, "collapse_chain",
		"level,leaves,a,b,c,first run [0;a),second run [b;b+c)", true);
	options.distance_most = 4;
	for (uint32_t i = 0; i < CHAIN_LEAVES; i++) {
		strew(&state, corner + 4 * i);
		first[i + 1] = 4 * (i + 1);
	}
	lod_collapse_make(&c, &(struct lod_foliage){ .count = CHAIN_LEAVES, .first = first,
		.corner = corner },
		&options, NULL, 0, NULL, arena);
	for (uint32_t i = 0; i <= c.made; i++) {
		const struct lod_collapse_level *l = &c.level[i];
		char run[2][128] = { "", "" };
		for (uint32_t k = 0; k < l->a + l->c; k++) {
			char *text = run[k >= l->a];
			snprintf(text + strlen(text), sizeof run[0] - strlen(text), "%s%u", *text ? " " : "",
				c.place[k < l->a ? k : l->b + k - l->a]);
		}
		bench_table_row(table, "%u,%u,%u,%u,%u,%s,%s", i, l->a + l->c, l->a, l->b, l->c, run[0],
			run[1]);
	}
	bench_table_close(table);
}

static enum eco_code write_made(struct bench *bench, struct eco_error *error)
{
	struct lod_arena arena = { 0 };
	if (setjmp(arena.failed)) {
		lod_arena_free(&arena);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for some leaves");
	}
	uint8_t *rgb = lod_arena_take(&arena, 3 * (size_t)PIXELS * PIXELS, 3);
	enum eco_code code = paint_pair(rgb, &arena, error);
	code = code ? code : bench_picture_write(bench, "collapse-pair.png", 3 * PIXELS, PIXELS, rgb, error);
	bench_picture(bench, "collapse-pair.png", "two leaves; what encloses them (dark) and the "
		"quad (red), whose area is the mean of both areas' sum and of what encloses them; "
		"the quad with its texture");
	write_chain(bench, &arena);
	lod_arena_free(&arena);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, done[2] = { 0 }, plants = 0;
	double sum[KINDS][SHARES] = { { 0 } };
	struct bench_series series[KINDS];
	enum eco_code code = write_made(bench, error);
	code = code ? code : bench_models(bench, &models, &count, error);
	struct bench_table *table = bench_table_open(bench, "collapse",
		"plant,leaves,method,Q at 2 %,Q at 5 %,"
		"Q at 10 %,Q at 20 %,Q at 30 %,Q at 50 % of the vertices", true);
	for (uint32_t i = 0; i < count && !code; i++) {
		bool made = models[i].generated;
		if (models[i].leaves < LEAVES_LEAST)
			continue;
		if (!bench->full && done[made] >= (made ? MADE_QUICK : READ_QUICK)) {
			bench_left_out(bench, models[i].name);
			continue;
		}
		bench_progress(bench, (double)i / count, models[i].name);
		code = study_plant(bench, &models[i], table, sum, error);
		done[made]++;
		plants++;
	}
	for (int kind = 0; kind < KINDS && !code; kind++) {      /* NaN if one plant has no figure */
		for (uint32_t i = 0; i < SHARES; i++)
			sum[kind][i] /= plants;
		bench_table_row(table, "mean,%u plants,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", plants,
			kind_names[kind],
			sum[kind][0], sum[kind][1], sum[kind][2], sum[kind][3], sum[kind][4], sum[kind][5]);
		series[kind] = (struct bench_series){ kind_names[kind], shares, sum[kind], SHARES, false };
	}
	bench_table_close(table);
	free(models);
	if (code)
		return code;
	bench_key(bench, "collapse_q_10", sum[PRINTED][2], "Q of leaf collapse at 10 % of the vertices");
	bench_say(bench, "Quads have the paper's sizes, which are too large: they reach beyond the crown. There is "
		"no figure where a coarsest level has more vertices than asked for.");
	return bench_plot(bench, &(struct bench_plot){ .name = "collapse", .title = "Q at equal vertices, "
		"mean over plants", .x = "share of the vertices", .y = "Q", .log_x = true, .series = series,
		.series_count = KINDS }, error);
}

const struct bench_section bench_collapse = { "collapse", "Leaf collapse", run };
