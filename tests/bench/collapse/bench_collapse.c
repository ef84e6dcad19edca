/* Leaf collapse (Hidalgo, Abad, Camahort 2007) and the paper's figures: the quad of two leaves (1), the atlas
 * (2), an example of a chain and its table of levels (3, 4), sectors (6).
 *
 * The paper compares with nothing and gives no count of leaves, no time and no frame rate; its scenes of
 * millions of trees are a matter of the renderer. The section measures Q at equal vertices beside our orders
 * and packs: of levels drawn as the paper says (quads of the printed size), of levels whose quads are scaled
 * as all other methods here are, without textures, and by sectors that each have a level by how they face the
 * eye. Wood is drawn whole.
 *
 * The leaves of a crown and behind them the quads of all sectors are one foliage: a level is drawn as any
 * other choice of elements is (lod/build/foliage.h). */
#include <math.h>
#include <string.h>

#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"
#include "lod/build/foliage.h"
#include "lod/raster/texel.h"
#include "lod/sort.h"
#include "tests/bench/baseline/leaf_collapse.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/ladder/bench_species.h"

#define TEST_SEED 90217u                 /* views of bench_species.c, these and those that scales are from */
#define TUNING_SEED 7411u
#define TUNING_VIEWS 5u
#define STEP_LOW (-16)                   /* eighths of an octave of area */
#define STEP_HIGH 8
#define VIEWS_MOST 12u
#define PASSES 8                         /* of giving what full sectors leave to the others */
#define WEDGES 9u                /* sectors: the innermost, and eight wedges */
#define TOP_SIDE 512u
#define DOT 5u                           /* pixels of a leaf seen from above */
#define SHARES BENCH_SHARES
static const uint8_t leaf_rgb[3] = { 76, 110, 40 };

/* SCALED: quads at the scale that is best in other views; SOLID: and opaque. PRINTED: as large as the paper
 * has them. SECTORS: each sector has a level, the finer the more it faces the eye. */
enum kind { SCALED, PRINTED, SOLID, SECTORS, KINDS };
static const char *const kind_names[KINDS] = { "leaf collapse", "leaf collapse as printed",
	"leaf collapse without textures", "leaf collapse by sectors" };

struct crown {
	uint32_t sectors;
	struct lod_collapse forest[WEDGES];
	struct lod_collapse_atlas atlas;
	uint32_t base[WEDGES];               /* per sector: the element of its first quad */
	uint64_t *vertices[WEDGES];          /* per sector and level, 3 a triangle */
};

struct study {
	struct bench *bench;
	const struct bench_model *model;
	struct bench_leaves *leaves;
	struct lod_foliage bare;             /* without quads */
	struct lod_sights tuning, tests;
	double all;                          /* vertices */
	uint32_t *order;
	float *factor;
};

/* ---- Leaves and quads ---- */

static uint32_t element_of(const struct crown *c, uint32_t sector, uint32_t node)
{
	const struct lod_collapse *forest = &c->forest[sector];
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
static uint64_t *count_vertices(struct crown *c, uint32_t sector, const struct lod_foliage *f,
	struct lod_arena *arena)
{
	const struct lod_collapse *forest = &c->forest[sector];
	uint64_t sum = 0, *vertices = lod_arena_take(arena, (size_t)forest->made + 1, sizeof *vertices);
	for (uint32_t row = 0, done = 0; row <= forest->made; row++) {
		for (; done < forest->level[row].a; done++)
			sum += bench_leaves_vertices(f, &forest->leaf[forest->place[done]], 1);
		vertices[row] = sum + 6 * (uint64_t)forest->level[row].c;
	}
	return vertices;
}

/* An array of foliage with room for more. */
#define GROW(array, count, room) \
	array = memcpy(lod_arena_take(arena, room, sizeof *(array)), array, (count) * sizeof *(array))

/* Extends the foliage by quads; its count stays. `solid`: quads are drawn without textures. */
static void grow(struct crown *c, uint32_t sectors, bool solid, struct lod_foliage *f,
	struct lod_arena *arena)
{
	size_t n = f->count, quads = 0, corners = f->first[n];
	uint32_t leaf = median_leaf(f, arena);
	const struct lod_fan shape = lod_foliage_fan(f, leaf);
	c->sectors = sectors;
	lod_collapse_make(c->forest, sectors, f, NULL, arena);
	for (uint32_t k = 0; k < sectors; k++) {
		c->base[k] = (uint32_t)(n + quads);
		quads += c->forest[k].made;
		c->vertices[k] = count_vertices(c, k, f, arena);
	}
	lod_collapse_atlas_make(&c->atlas, c->forest, sectors, &shape, leaf_rgb, arena);
	GROW(f->first, n + 1, n + quads + 1);
	GROW(f->triangle_first, n + 1, n + quads + 1);
	GROW(f->corner, corners, corners + 4 * quads);
	GROW(f->uv, corners, corners + 4 * quads);
	GROW(f->cutout, n, n + quads);
	if (f->mask)                             /* quads have none: their images are looked up */
		GROW(f->mask, n, n + quads);
	GROW(f->center, n, n + quads);
	GROW(f->normal, n, n + quads);
	GROW(f->area, n, n + quads);
	for (size_t i = n, k = 0, quad = 0; i < n + quads; i++, quad++) {
		for (; quad == c->forest[k].made; k++)
			quad = 0;
		uint32_t at = f->first[i], id = c->forest[k].leaves + (uint32_t)quad;
		const struct lod_collapse_node *node = &c->forest[k].node[id];
		struct lod_v3 corner[ECO_CORNERS_MAX];
		f->first[i + 1] = at + lod_collapse_corners(&c->forest[k], NULL, id, corner);
		f->triangle_first[i + 1] = f->triangle_first[i] + 2;
		for (int j = 0; j < 12; j++)
			f->corner[at + (uint32_t)j / 3][j % 3] = (float)lod_v3_axis(corner[j / 3], j % 3);
		lod_collapse_atlas_uv(&c->atlas, node->tile, f->uv + at);
		f->cutout[i] = solid ? NULL : &c->atlas.image;
		f->center[i] = node->center;
		f->normal[i] = lod_v3_scale(node->normal, node->area);
		f->area[i] = node->opaque_area;
	}
}

/* Adds the finest level of a sector of at most so many vertices to the order, the coarsest if all have more.
 * Returns its vertices. */
static uint64_t add_level(const struct crown *c, uint32_t sector, double vertices,
	uint32_t *order, uint32_t *count)
{
	const struct lod_collapse *forest = &c->forest[sector];
	uint32_t low = 1, high = forest->made + 1;
	ECO_LEAST(low, high, i, (double)c->vertices[sector][i] > vertices)
	low--;
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
static void allocate(const struct crown *c, const struct lod_eye *eye, double vertices,
	double *given)
{
	double weight[WEDGES], all[WEDGES];
	for (uint32_t k = 0; k < c->sectors; k++) {
		const struct lod_collapse *forest = &c->forest[k];
		all[k] = (double)c->vertices[k][forest->made];
		weight[k] = all[k] * (0.5 + (k ? facing(forest, eye) : 0));
		given[k] = 0;
	}
	for (int pass = 0; pass < PASSES; pass++) {
		double left = vertices, sum = 0;
		for (uint32_t k = 0; k < c->sectors; k++) {
			left -= given[k];
			sum += given[k] < all[k] ? weight[k] : 0;
		}
		for (uint32_t k = 0; k < c->sectors && sum > 0 && left > 0; k++)
			if (given[k] < all[k])
				given[k] = fmin(all[k], given[k] + left * weight[k] / sum);
	}
}

/* NaN where the coarsest levels have more vertices. Quads are scaled by 2^(step / 8). */
static double q_of(struct study *s, const struct crown *c, double vertices,
	const struct lod_sights *sights, int step)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < sights->count; v++) {
		struct lod_sights_drawing drawing = { .order = s->order, .scale = 1, .factor = s->factor };
		double given[WEDGES];
		uint64_t drawn = 0;
		allocate(c, &sights->eyes[v], vertices, given);
		for (uint32_t k = 0; k < c->sectors; k++)
			drawn += add_level(c, k, given[k], s->order, &drawing.count);
		if ((double)drawn > vertices)
			return NAN;
		for (uint32_t k = 0; k < drawing.count; k++)
			s->factor[s->order[k]] = s->order[k] < s->bare.count ? 1 : (float)exp2(step / 8.0);
		bench_leaves_compare(s->leaves, sights, v, &drawing, &sum);
	}
	return bench_wrong_q(&sum);
}

static double scaled_q(struct study *s, const struct crown *c, double vertices)
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

/* ---- Pictures ---- */

static void write_picture(struct study *s, const char *what, uint32_t width, uint32_t height,
	const uint8_t *rgb)
{
	char file[128];
	snprintf(file, sizeof file, "collapse-%s-%s.png", s->model->name, what);
	bench_picture_write(s->bench, file, width, height, rgb);
}

/* Figure 2, with the upper and left edges of tiles. */
static void draw_atlas(struct study *s, const struct lod_collapse_atlas *atlas)
{
	static const uint8_t line[3] = { 40, 40, 40 };
	const struct eco_image *image = &atlas->image;
	uint8_t *rgb = lod_arena_take(&s->leaves->arena, (size_t)image->width * image->height, 3);
	memset(rgb, 255, 3 * (size_t)image->width * image->height);
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
	write_picture(s, "atlas", image->width, image->height, rgb);
}

/* Figure 6: leaves from above as dots, in the colours of their sectors. The innermost lies over the
 * others. */
static void draw_sectors(struct study *s, const struct crown *c)
{
	static const uint8_t colors[WEDGES][3] = { { 60, 60, 60 }, { 214, 69, 65 }, { 244, 160, 60 },
		{ 230, 210, 70 }, { 120, 180, 70 }, { 40, 140, 110 }, { 60, 150, 210 }, { 70, 80, 180 },
		{ 170, 80, 170 } };
	const struct lod_foliage *f = &s->bare;
	uint8_t *rgb = lod_arena_take(&s->leaves->arena, (size_t)TOP_SIDE * TOP_SIDE, 3);
	double most = 0;
	memset(rgb, 255, 3 * (size_t)TOP_SIDE * TOP_SIDE);
	for (uint32_t i = 0; i < f->count; i++)
		most = fmax(most, fmax(fabs(f->center[i].x), fabs(f->center[i].y)));
	for (uint32_t k = c->sectors; k-- > 0;)
		for (uint32_t i = 0; i < DOT * DOT * c->forest[k].leaves; i++) {
			struct lod_v3 at = f->center[c->forest[k].leaf[i / (DOT * DOT)]];
			uint32_t x = (uint32_t)((1 + 0.96 * at.x / most) / 2 * (TOP_SIDE - DOT)) + i % DOT,
				y = (uint32_t)((1 - 0.96 * at.y / most) / 2 * (TOP_SIDE - DOT))
				+ i / DOT % DOT;
			memcpy(rgb + 3 * (y * TOP_SIDE + x), colors[k], 3);
		}
	write_picture(s, "sectors", TOP_SIDE, TOP_SIDE, rgb);
}

/* All leaves, then levels of quads of the printed size. */
static void draw_levels(struct study *s, const struct crown *c)
{
	enum { LEVELS = 3 };
	uint8_t *rgb = lod_arena_take(&s->leaves->arena, (1 + LEVELS) * BENCH_PIXELS * BENCH_PIXELS, 3);
	bench_leaves_paint(s->leaves, &s->tests, 0, NULL, 0, 1 + LEVELS, rgb);
	for (uint32_t i = 0; i < LEVELS; i++) {
		struct lod_sights_drawing drawing = { .order = s->order, .scale = 1 };
		add_level(c, 0, ldexp(s->all, -2 * (int)(i + 1)), s->order, &drawing.count);
		bench_leaves_paint(s->leaves, &s->tests, 0, &drawing, 1 + i, 1 + LEVELS, rgb);
	}
	write_picture(s, "levels", (1 + LEVELS) * BENCH_PIXELS, BENCH_PIXELS, rgb);
}

/* ---- One plant ---- */

/* The unit: Q of each kind at each share. */
static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct study *s = ctx;
	double q[KINDS][SHARES] = { { 0 } };
	s->leaves = leaves;
	s->bare = leaves->foliage;
	s->order = lod_arena_take(&leaves->arena, s->bare.count, sizeof *s->order);
	s->factor = lod_arena_take(&leaves->arena, 2 * (size_t)s->bare.count, sizeof *s->factor);
	s->all = (double)bench_leaves_vertices(&s->bare, NULL, s->bare.count);
	bench_leaves_look(leaves, &s->tuning, TUNING_VIEWS, TUNING_SEED);
	bench_leaves_look(leaves, &s->tests, s->bench->full ? VIEWS_MOST : VIEWS_MOST / 2, TEST_SEED);
	for (int kind = SCALED; kind < KINDS; kind++) {
		struct crown crown;
		leaves->foliage = s->bare;
		grow(&crown, kind == SECTORS ? WEDGES : 1, kind == SOLID, &leaves->foliage,
			&leaves->arena);
		for (uint32_t i = 0; i < SHARES; i++)
			q[kind][i] = kind == SCALED || kind == SOLID ? scaled_q(s, &crown,
			bench_shares[i] * s->all)
				: q_of(s, &crown, bench_shares[i] * s->all, &s->tests, 0);
		if (kind == SECTORS)
			draw_sectors(s, &crown);
		if (kind != PRINTED)
			continue;
		draw_atlas(s, &crown.atlas);
		draw_levels(s, &crown);
	}
	return bench_reals(*q, KINDS * SHARES);
}

/* Rows: our orders, then kinds. */
#define ROWS (BENCH_ORDERS + (int)KINDS)

static void study_plant(struct bench *bench, const struct bench_model *model, double sum[ROWS][SHARES])
{
	char file[128];
	struct bench_savings savings;
	struct study s = { .bench = bench, .model = model };
	double q[ROWS][SHARES];
	bench_leaves_unit(bench, "collapse", model, study_leaves, &s, q[BENCH_ORDERS], KINDS * SHARES);
	bench_savings_of(bench, &savings, model);
	memcpy(q, savings.q, sizeof savings.q);
	for (int i = 0; i < ROWS * (int)SHARES; i++)
		sum[i / (int)SHARES][i % (int)SHARES] += q[i / (int)SHARES][i % (int)SHARES];
	for (int i = 0; i < 3; i++) {
		static const char *const pictures[3][2] = { { "levels", "all leaves; levels of a quarter, a 16th, a 64th of the "
			"vertices" }, { "atlas", "its atlas: pairs of leaves, then classes of counts by density" },
			{ "sectors", "its sectors from above" } };
		snprintf(file, sizeof file, "collapse-%s-%s.png", model->name, pictures[i][0]);
		bench_picture(bench, file, pictures[i][1]);
	}
}

/* ---- Figures 1, 3 and 4: made leaves ---- */

#define CHAIN_LEAVES 10u
#define CROWN_RADIUS 5.0
#define LEAF_HALF 0.05
#define PAIR_HALF 1.83           /* metres from the middle of a panel to each side */
#define FRAME 0.015

/* Whether a point lies in a polygon of four corners. */
static bool is_inside(double corner[4][2], const double at[2])
{
	bool inside = false;
	for (int i = 0, k = 3; i < 4; k = i++)
		if ((corner[i][1] > at[1]) != (corner[k][1] > at[1]) && at[0] < corner[i][0] + (corner[k][0]
				- corner[i][0]) * (at[1] - corner[i][1]) / (corner[k][1] - corner[i][1]))
			inside = !inside;
	return inside;
}

/* Whether it lies within a rectangle, `rim` from its edges. */
static bool is_within(const double low[2], const double high[2], double rim, const double at[2])
{
	return at[0] >= low[0] + rim && at[0] <= high[0] - rim && at[1] >= low[1] + rim && at[1] <= high[1]
		- rim;
}

/* Figure 1, seen straight onto the quad: two leaves; what encloses them and the quad in their place; the quad
 * with its texture. */
static void write_pair(struct bench *bench, struct lod_arena *arena)
{
	static float corner[8][3] = { { -1.1f, 0, 0 }, { -0.5f, -0.35f, 0.1f }, { 0.3f, 0, 0 },
		{ -0.5f, 0.35f, 0.1f }, { 0.5f, -0.5f, 0 }, { 1.0f, 0.1f, -0.2f }, { 0.9f, 0.9f, -0.1f },
		{ 0.4f, 0.3f, 0.1f } };
	static uint32_t first[3] = { 0, 4, 8 };
	static const uint8_t colors[4][3] = { { 255, 255, 255 }, { 88, 132, 48 }, { 40, 40, 40 }, { 200, 60,
		40 } };
	const struct lod_foliage leaves = { .count = 2, .first = first, .corner = corner };
	const struct lod_fan shape = { .corner = (const float (*)[3])corner, .corners = 4 };
	struct lod_collapse c;
	struct lod_collapse_atlas atlas;
	uint8_t *rgb = lod_arena_take(arena, 3 * (size_t)BENCH_PIXELS * BENCH_PIXELS, 3);
	lod_collapse_make(&c, 1, &leaves, &(struct lod_collapse_options){ .distance_most = 9,
		.angle_most_rad = LOD_PI / 2 }, arena);
	lod_collapse_atlas_make(&atlas, &c, 1, &shape, colors[1], arena);
	const struct lod_collapse_node *quad = &c.node[2];
	double flat[2][4][2], low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY },
		half[2] = { lod_v3_length(quad->half[0]), lod_v3_length(quad->half[1]) };
	for (int i = 0; i < 16; i++) {
		double *at = &flat[i / 8][i / 2 % 4][i % 2];
		*at = lod_v3_dot(lod_v3_sub(lod_v3_of(corner[i / 2]), quad->center),
			lod_v3_unit(quad->half[i % 2]));
		low[i % 2] = fmin(low[i % 2], *at);
		high[i % 2] = fmax(high[i % 2], *at);
	}
	float uv[4][2];
	lod_collapse_atlas_uv(&atlas, quad->tile, uv);
	for (uint32_t i = 0; i < 3 * BENCH_PIXELS * BENCH_PIXELS; i++) {
		uint32_t panel = i / BENCH_PIXELS % 3, color = 0;
		const double at[2] = { PAIR_HALF * (2 * (i % BENCH_PIXELS + 0.5) / BENCH_PIXELS - 1),
			PAIR_HALF * (1 - 2 * (i / (3 * BENCH_PIXELS) + 0.5) / BENCH_PIXELS) }, least[2] = { -half[0],
			-half[1] };
		if (panel < 2)
			color = is_inside(flat[0], at) || is_inside(flat[1], at);
		else if (is_within(least, half, 0, at))
			color = lod_texel_at(&atlas.image, uv[0][0] + (at[0] / half[0] + 1) / 2
				* (double)(uv[2][0] - uv[0][0]), uv[0][1] + (at[1] / half[1] + 1) / 2
				* (double)(uv[2][1] - uv[0][1]))[3] > 0;
		if (panel == 1 && is_within(low, high, 0, at) && !is_within(low, high, FRAME, at))
			color = 2;
		if (panel && is_within(least, half, 0, at) && !is_within(least, half, FRAME, at))
			color = 3;
		memcpy(rgb + 3 * (size_t)i, colors[color], 3);
	}
	bench_picture_write(bench, "collapse-pair.png", 3 * BENCH_PIXELS, BENCH_PIXELS, rgb);
	bench_picture(bench, "collapse-pair.png", "two leaves; what encloses them (dark) and the "
		"quad (red), whose area is the mean of both areas' sum and of what encloses them; "
		"the quad with its texture");
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
	struct lod_v3 along = lod_v3_unit(lod_v3_cross(n, (struct lod_v3){ 0, 0, 1 })),
		across = lod_v3_unit(lod_v3_cross(n, along));
	for (int i = 0; i < 12; i++)
		corner[i / 3][i % 3] = (float)(CROWN_RADIUS * lod_v3_axis(at, i % 3)
		+ LEAF_HALF * (sign[i / 3][0]
			* lod_v3_axis(along, i % 3) + sign[i / 3][1] * lod_v3_axis(across, i % 3)));
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
	lod_collapse_make(&c, 1, &(struct lod_foliage){ .count = CHAIN_LEAVES, .first = first, .corner
		= corner }, &options, arena);
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

/* A mean is NaN if one plant has no figure. */
static void write_means(struct bench *bench, double sum[ROWS][SHARES], uint32_t plants)
{
	struct bench_series series[ROWS];
	uint32_t plotted = 0;
	struct bench_table *table = bench_table_open(bench, "collapse_means", "method,Q at 2 %,Q at 5 %,Q at "
		"10 %,Q at 20 %,Q at 30 %,Q at 50 % of the vertices,plants", true);
	for (int row = 0; row < ROWS; row++) {
		const char *name = row < BENCH_ORDERS ? bench_order_names[row] : kind_names[row
			- BENCH_ORDERS];
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
	bench_say(bench, "Orders, leaf collapse and its quads without textures each have their best scale. "
		"Rows as printed and by sectors have the paper's sizes, which are too large: quads reach "
		"beyond the crown. Packs draw as much wood as they choose, which is whole in all other rows. "
		"There is no figure where a coarsest level has more vertices than asked for.");
	bench_plot(bench, &(struct bench_plot){ .name = "collapse", .title = "Q at equal vertices, "
		"mean over plants", .x = "share of the vertices", .y = "Q", .log_x = true, .series = series,
		.series_count = plotted });
}

static void run(struct bench *bench)
{
	struct lod_arena arena = { 0 };
	double sum[ROWS][SHARES] = { { 0 } };
	struct bench_walk walk = { .bench = bench, .leaves = BENCH_ELEMENTS_LEAST, .most = UINT32_MAX, .quick
		= 3, .quick_made = 1 };
	write_pair(bench, &arena);
	write_chain(bench, &arena);
	lod_arena_free(&arena);
	for (const struct bench_model *model; (model = bench_walk(&walk));) {
		study_plant(bench, model, sum);
		walk.found[model->generated]++;
	}
	write_means(bench, sum, walk.found[0] + walk.found[1]);
}

const struct bench_section bench_collapse = { "collapse", "Leaf collapse beside our orders and packs", run };
