/* Leaf collapse (Hidalgo, Abad, Camahort 2007) and the paper's figures: the quad of two leaves (1), the atlas
 * (2), an example of a chain and its table of levels (3, 4), sectors (6).
 *
 * The paper compares with nothing and gives no count of leaves, no time and no frame rate; its scenes of
 * millions of trees are a matter of the renderer. The section measures Q at equal vertices beside our orders and
 * splats: of levels drawn as the paper says (quads of the printed size), of levels whose quads are scaled as all
 * other methods here are, without textures, and by sectors that each have a level by how they face the eye.
 * Wood is drawn whole. Longer than 600 lines: the figures of one paper, from one study. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/sort.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/collapse/bench_collapse.h"
#include "tests/bench/ladder/bench_species.h"
#include "tests/bench/pictures/bench_billboards.h"

#define TEST_SEED 90217u                 /* views of bench_species.c, these and those that scales are from */
#define TUNING_SEED 7411u
#define TUNING_VIEWS 5u
#define STEP_LOW (-16)                   /* eighths of an octave of area */
#define STEP_HIGH 8
#define SPLATS_MOST 8192u
#define VIEWS_MOST 12u
#define PIXELS 256u
#define PASSES 8                         /* of giving what full sectors leave to the others */
#define WEDGES BENCH_WEDGES
#define READ_QUICK 3u
#define MADE_QUICK 1u
#define TOP_SIDE 512u
#define DOT 5u                           /* pixels of a leaf seen from above */
#define SHARES BENCH_SHARES
static const uint8_t leaf_rgb[3] = { 76, 110, 40 };

/* SCALED: quads at the scale that is best in other views; SOLID: and opaque. PRINTED: as large as the paper has
 * them. SECTORS: each sector has a level, the finer the more it faces the eye. SPLATS: of the whole plant, over
 * whole wood. */
enum kind { SCALED, PRINTED, SOLID, SECTORS, SPLATS, KINDS };
static const char *const kind_names[KINDS] = { "leaf collapse", "leaf collapse as printed",
	"leaf collapse without textures", "leaf collapse by sectors", "splats" };

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves *leaves;
	struct lod_foliage bare;             /* without quads */
	struct lod_sights tuning, tests;
	double all;                          /* vertices */
	uint32_t *order;
	float *factor;
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

static void fill_quad(const struct bench_collapse *c, uint32_t sector, uint32_t quad, bool solid,
	struct lod_foliage *f)
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
	f->cutout[i] = solid ? NULL : &c->atlas.image;
	f->center[i] = node->center;
	f->normal[i] = lod_v3_scale(node->normal, node->area);
	f->area[i] = node->opaque_area;
}

void bench_collapse_grow(struct bench_collapse *c, uint32_t sectors, bool solid, struct lod_foliage *f,
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
			fill_quad(c, k, i, solid, f);
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

/* NaN where the coarsest levels have more vertices. Quads are scaled by 2^(step / 8). */
static double q_of(struct study *s, const struct bench_collapse *c, double vertices,
	const struct lod_sights *sights, int step)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < sights->count; v++) {
		struct lod_sights_drawing drawing = { .order = s->order, .scale = 1, .factor = s->factor };
		double given[WEDGES];
		uint64_t drawn = 0;
		allocate(c, &sights->eyes[v], vertices, given);
		for (uint32_t k = 0; k < c->sectors.count; k++)
			drawn += bench_collapse_level(c, k, given[k], s->order, &drawing.count);
		if ((double)drawn > vertices)
			return NAN;
		for (uint32_t k = 0; k < drawing.count; k++)
			s->factor[s->order[k]] = s->order[k] < s->bare.count ? 1 : (float)exp2(step / 8.0);
		bench_leaves_compare(s->leaves, sights, v, &drawing, &sum);
	}
	return bench_wrong_q(&sum);
}

static double scaled_q(struct study *s, const struct bench_collapse *c, double vertices)
{
	double best = -INFINITY;
	int best_step = 0;
	for (int step = STEP_LOW; step <= STEP_HIGH; step += 2) {
		double now = q_of(s, c, vertices, &s->tuning, step);
		best_step = now > best ? step : best_step;
		best = fmax(best, now);
	}
	return q_of(s, c, vertices, &s->tests, best_step);
}

static enum eco_code measure_splats(struct study *s, double q[SHARES], struct eco_error *error)
{
	struct lod_splats splats;
	struct bench_splats drawn = { .items = lod_arena_take(&s->leaves->arena, SPLATS_MOST,
		sizeof *drawn.items) };
	enum eco_code code = lod_splats_fit(&splats, &s->leaves->model, &(struct lod_splats_options){ 0 }, error);
	for (uint32_t i = 0; i < SHARES && !code && splats.level_count; i++) {
		struct bench_wrong sum = { 0 };
		bench_splats_state(&splats, (uint32_t)fmin(bench_shares[i] * s->all, SPLATS_MOST), &drawn);
		for (uint32_t v = 0; v < s->tests.count; v++)
			bench_leaves_compare_drawn(s->leaves, &s->tests, v, true, bench_splats_draw, &drawn,
				&sum);
		q[i] = bench_wrong_q(&sum);
	}
	if (!code)
		lod_splats_free(&splats);
	return code;
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

static enum eco_code look(struct study *s, struct lod_sights *sights, uint32_t count, uint32_t seed,
	struct eco_error *error)
{
	double to[VIEWS_MOST][3];
	lod_directions_spread(to, count, seed);
	return lod_sights_make(sights, &s->leaves->foliage, (const double (*)[3])to, count, PIXELS,
		&s->leaves->arena, error);
}

/* A row of Q for each kind. */
static enum eco_code study_leaves(void *ctx, struct bench_leaves *leaves, json_t **out,
	struct eco_error *error)
{
	struct study *s = ctx;
	s->leaves = leaves;
	s->bare = leaves->foliage;
	s->order = lod_arena_take(&leaves->arena, s->bare.count, sizeof *s->order);
	s->factor = lod_arena_take(&leaves->arena, 2 * (size_t)s->bare.count, sizeof *s->factor);
	enum eco_code code = look(s, &s->tuning, TUNING_VIEWS, TUNING_SEED, error);
	code = code ? code : look(s, &s->tests, s->bench->full ? VIEWS_MOST : VIEWS_MOST / 2, TEST_SEED, error);
	for (uint32_t i = 0; i < s->bare.count; i++)
		s->all += 3 * (s->bare.first[i + 1] - s->bare.first[i] - 2);
	*out = json_array();
	for (int kind = 0; kind < KINDS && !code; kind++) {
		struct bench_collapse crown;
		double q[SHARES] = { 0 };
		if (kind != SPLATS) {
			leaves->foliage = s->bare;
			bench_collapse_grow(&crown, kind == SECTORS ? WEDGES : 1, kind == SOLID, &leaves->foliage,
				&leaves->arena);
		}
		for (uint32_t i = 0; i < SHARES && kind != SPLATS; i++)
			q[i] = kind == SCALED || kind == SOLID ? scaled_q(s, &crown, bench_shares[i] * s->all)
				: q_of(s, &crown, bench_shares[i] * s->all, &s->tests, 0);
		code = kind == SPLATS ? measure_splats(s, q, error)
			: kind == SECTORS ? draw_sectors(s, &crown.sectors, error)
			: kind == PRINTED ? draw_atlas(s, &crown.atlas, error) : ECO_OK;
		json_array_append_new(*out, bench_reals(q, SHARES));
	}
	return code;
}

/* Rows: our orders, then kinds. */
#define ROWS (BENCH_ORDERS + (int)KINDS)

static enum eco_code study_plant(struct bench *bench, const struct bench_model *model,
	double sum[ROWS][SHARES], struct eco_error *error)
{
	char name[96], stamp[64], file[128];
	json_t *unit;
	struct bench_savings savings;
	struct study s = { .bench = bench, .name = model->name };
	snprintf(name, sizeof name, "collapse-%s", model->name);
	snprintf(stamp, sizeof stamp, "%d %016llx", bench->full,
		(unsigned long long)bench_file_hash(model->path));
	enum eco_code code = bench_leaves_unit(bench, &(struct bench_leaves_unit){ name, stamp, model, PIXELS,
		study_leaves, &s, NULL }, &unit, error);
	code = code ? code : bench_savings_of(bench, &savings, model, error);
	for (int row = 0; row < ROWS && !code; row++) {
		double q[SHARES];
		if (row >= BENCH_ORDERS)
			bench_cells(json_array_get(unit, (size_t)(row - BENCH_ORDERS)), q, SHARES);
		for (uint32_t i = 0; i < SHARES; i++)
			sum[row][i] += row < BENCH_ORDERS ? savings.q[row][i] : q[i];
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

/* A mean is NaN if one plant has no figure. */
static enum eco_code write_means(struct bench *bench, double sum[ROWS][SHARES], uint32_t plants,
	struct eco_error *error)
{
	struct bench_series series[ROWS];
	uint32_t plotted = 0;
	struct bench_table *table = bench_table_open(bench, "collapse_means", "method,Q at 2 %,Q at 5 %,Q at "
		"10 %,Q at 20 %,Q at 30 %,Q at 50 % of the vertices,plants", true);
	for (int row = 0; row < ROWS; row++) {
		const char *name = row < BENCH_ORDERS ? bench_order_names[row] : kind_names[row - BENCH_ORDERS];
		double *q = sum[row];
		for (uint32_t i = 0; i < SHARES; i++)
			q[i] /= plants;
		bench_table_row(table, "%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%u", name, q[0], q[1], q[2], q[3],
			q[4], q[5], plants);
		/* as many as there are colours */
		if (row == BENCH_STOCHASTIC || row >= BENCH_GREEDY)
			series[plotted++] = (struct bench_series){ name, bench_shares, q, SHARES, false };
	}
	bench_table_close(table);
	bench_key(bench, "collapse_q_10", sum[BENCH_ORDERS + SCALED][2],
		"Q of leaf collapse at 10 % of the vertices");
	bench_say(bench, "Orders, leaf collapse and its quads without textures each have their best scale. Rows as "
		"printed and by sectors have the paper's sizes, which are too large: quads reach beyond the crown. "
		"Splats show wood and leaves, one vertex each, over wood that is drawn whole as in all other rows. "
		"There is no figure where a coarsest level has more vertices than asked for.");
	return bench_plot(bench, &(struct bench_plot){ .name = "collapse", .title = "Q at equal vertices, "
		"mean over plants", .x = "share of the vertices", .y = "Q", .log_x = true, .series = series,
		.series_count = plotted }, error);
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, done[2] = { 0 };
	double sum[ROWS][SHARES] = { { 0 } };
	enum eco_code code = write_made(bench, error);
	code = code ? code : bench_models(bench, &models, &count, error);
	for (uint32_t i = 0; i < count && !code; i++) {
		bool made = models[i].generated;
		if (models[i].leaves < BENCH_ELEMENTS_LEAST)
			continue;
		if (!bench->full && done[made] >= (made ? MADE_QUICK : READ_QUICK)) {
			bench_left_out(bench, models[i].name);
			continue;
		}
		bench_progress(bench, (double)i / count, models[i].name);
		code = study_plant(bench, &models[i], sum, error);
		done[made]++;
	}
	free(models);
	return code ? code : write_means(bench, sum, done[0] + done[1], error);
}

const struct bench_section bench_collapse = { "collapse", "Leaf collapse against orders and splats", run };
