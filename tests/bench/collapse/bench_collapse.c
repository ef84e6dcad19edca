/* Leaf collapse (Hidalgo, Abad, Camahort 2007) and the paper's figures of the atlas (2) and of sectors (6).
 *
 * The paper compares with nothing and gives no count of leaves, no time and no frame rate; its scenes of
 * millions of trees are a matter of the renderer. The section measures Q of levels drawn as the paper says,
 * with quads of the printed size, and of sectors that each have a level by how they face the eye. Wood is
 * drawn whole. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/sort.h"
#include "tests/bench/baseline/leaf_collapse.h"
#include "tests/bench/bench_leaves.h"

#define LEAVES_LEAST 500u
#define TEST_SEED 90217u                 /* views of bench_species.c */
#define VIEWS_MOST 12u
#define PIXELS 256u
#define PASSES 8                         /* of giving what full sectors leave to the others */
#define WEDGES 9u                        /* sectors: the innermost, and eight wedges */
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

/* ---- A crown: its leaves, and behind them the quads of all sectors, so that one level is drawn as any other
 * choice of elements is ---- */

struct crown {
	struct lod_collapse_sectors sectors;
	struct lod_collapse_atlas atlas;
	uint32_t base[WEDGES];               /* per sector: the element of its first quad */
	uint64_t *vertices[WEDGES];          /* per sector and level, 3 a triangle */
};

static uint32_t element_of(const struct crown *c, uint32_t sector, uint32_t node)
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
static void count_vertices(struct crown *c, uint32_t sector, const struct lod_foliage *f,
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

static void fill_quad(const struct crown *c, uint32_t sector, uint32_t quad, struct lod_foliage *f)
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

/* Extends the leaves' foliage, whose count stays. */
static void grow(struct study *s, struct crown *c, uint32_t sectors)
{
	struct lod_arena *arena = &s->leaves->arena;
	struct lod_foliage *f = &s->leaves->foliage;
	size_t n = s->bare.count, quads = 0, corners = s->bare.first[n];
	*f = s->bare;
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

/* Adds the finest level of a sector of at most so many vertices to the order, the coarsest if all have more.
 * Returns its vertices. */
static uint64_t add_level(const struct crown *c, uint32_t sector, double vertices, uint32_t *order,
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
static void allocate(const struct crown *c, const struct lod_eye *eye, double vertices, double *given)
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
static double q_of(struct study *s, const struct crown *c, double vertices)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < s->tests.count; v++) {
		struct lod_sights_drawing drawing = { .order = s->order, .scale = 1 };
		double given[WEDGES];
		uint64_t drawn = 0;
		allocate(c, &s->tests.eyes[v], vertices, given);
		for (uint32_t k = 0; k < c->sectors.count; k++)
			drawn += add_level(c, k, given[k], s->order, &drawing.count);
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
		struct crown crown;
		grow(s, &crown, kind == SECTORS ? WEDGES : 1);
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

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, done[2] = { 0 }, plants = 0;
	double sum[KINDS][SHARES] = { { 0 } };
	struct bench_series series[KINDS];
	enum eco_code code = bench_models(bench, &models, &count, error);
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
