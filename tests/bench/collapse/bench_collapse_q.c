#include "tests/bench/collapse/bench_collapse_q.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/bench/collapse/bench_collapse_draw.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/pictures/bench_splats.h"

#define TEST_SEED 90217u                 /* views of bench_savings.c, these and those that scales are from */
#define TUNING_SEED 7411u
#define TUNING_VIEWS 5u
#define STEP_LOW (-16)                   /* eighths of an octave of area */
#define STEP_HIGH 8
#define SPLATS_MOST 8192u
#define PIXELS 256u
#define PASSES 8                         /* of giving what full sectors leave to the others */

const char *const bench_collapse_kind_names[BENCH_COLLAPSE_KINDS] = { "leaf collapse as printed",
	"leaf collapse without textures", "leaf collapse by sectors", "splats" };
const uint32_t bench_collapse_pixels[BENCH_COLLAPSE_SIZES] = { 256, 128, 64, 32 };

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves leaves;
	struct lod_foliage bare;             /* without quads */
	struct lod_sights tuning, tests[BENCH_COLLAPSE_SIZES];
	uint64_t vertices;
	uint32_t views, *order;
	float *factor;                       /* per element, with quads */
	struct bench_collapse_q *q;
};

static double q_of(struct study *s, const struct lod_sights *sights, uint32_t count)
{
	struct bench_wrong sum = { 0 };
	const struct lod_sights_drawing drawing = { .order = s->order, .count = count, .scale = 1 };
	for (uint32_t v = 0; v < sights->count; v++)
		bench_leaves_compare(&s->leaves, sights, v, &drawing, &sum);
	return bench_wrong_q(&sum);
}

/* ---- One forest ---- */

static void grow(struct study *s, struct bench_collapse_plant *plant,
	const struct bench_collapse_options *options)
{
	clock_t begun = clock();
	bench_collapse_make(plant, &s->bare, options, &s->leaves.arena);
	s->q->seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
	s->leaves.foliage = s->bare;
	bench_collapse_extend(plant, &s->leaves.foliage, &s->leaves.arena);
}

static void measure_shares(struct study *s, const struct bench_collapse_plant *plant, double *q)
{
	for (uint32_t i = 0; i < BENCH_SHARES; i++) {
		uint32_t row = bench_collapse_row(plant, 0, bench_shares[i] * (double)s->vertices);
		q[i] = plant->vertices[0][row] > bench_shares[i] * (double)s->vertices ? NAN
			: q_of(s, &s->tests[0], bench_collapse_order(plant, 0, row, s->order));
	}
}

static double scaled_q(struct study *s, const struct lod_sights *sights, uint32_t count, double step)
{
	struct bench_wrong sum = { 0 };
	const struct lod_sights_drawing drawing = { .order = s->order, .count = count, .factor = s->factor };
	for (uint32_t k = 0; k < count; k++)
		s->factor[s->order[k]] = s->order[k] < s->bare.count ? 1 : (float)exp2(step / 8);
	for (uint32_t v = 0; v < sights->count; v++)
		bench_leaves_compare(&s->leaves, sights, v, &drawing, &sum);
	return bench_wrong_q(&sum);
}

/* As measure_shares, with quads at their best scale. */
static void measure_scaled(struct study *s, const struct bench_collapse_plant *plant, double *q)
{
	s->factor = lod_arena_take(&s->leaves.arena, (size_t)plant->leaves + plant->quads, sizeof *s->factor);
	for (uint32_t i = 0; i < BENCH_SHARES; i++) {
		double vertices = bench_shares[i] * (double)s->vertices, best = -INFINITY, best_step = 0;
		uint32_t row = bench_collapse_row(plant, 0, vertices),
			count = bench_collapse_order(plant, 0, row, s->order);
		for (int step = STEP_LOW; step <= STEP_HIGH; step += 2) {
			double now = scaled_q(s, &s->tuning, count, step);
			best_step = now > best ? step : best_step;
			best = fmax(best, now);
		}
		q[i] = (double)plant->vertices[0][row] > vertices ? NAN
			: scaled_q(s, &s->tests[0], count, best_step);
	}
}

/* In smaller pictures: the same plant farther away. */
static enum eco_code measure_levels(struct study *s, const struct bench_collapse_plant *plant,
	struct eco_error *error)
{
	const struct lod_collapse *forest = plant->sectors.forest;
	for (uint32_t z = 0; z < BENCH_COLLAPSE_SIZES; z++) {
		struct lod_raster raster, kept = s->leaves.cover;
		uint32_t count = forest->leaves, size = bench_collapse_pixels[z], n = 0;
		enum eco_code code = lod_raster_init(&raster, &(struct lod_raster_options){ .width = size,
			.height = size, .silhouette = true }, error);
		if (code)
			return code;
		s->leaves.cover = raster;
		for (; n < BENCH_COLLAPSE_LEVELS && (n == 0 || count >= forest->roots); count /= 2, n++) {
			const struct lod_collapse_level *level = lod_collapse_level_of(forest, count);
			uint32_t row = (uint32_t)(level - forest->level);
			struct bench_collapse_level *to = &s->q->level[n];
			to->a = level->a, to->b = level->b, to->c = level->c;
			to->vertices = plant->vertices[0][row];
			to->q[z] = q_of(s, &s->tests[z], bench_collapse_order(plant, 0, row, s->order));
		}
		s->q->level_count = n;
		s->leaves.cover = kept;
		lod_raster_free(&raster);
	}
	return ECO_OK;
}

static enum eco_code measure_forest(struct study *s, struct eco_error *error)
{
	struct bench_collapse_plant plant;
	char file[128];
	grow(s, &plant, &(struct bench_collapse_options){ .solid = true });
	measure_scaled(s, &plant, s->q->q[BENCH_COLLAPSE_SOLID]);
	grow(s, &plant, &(struct bench_collapse_options){ .solid = false });
	s->q->quads = plant.quads;
	s->q->roots = plant.sectors.forest->roots;
	s->q->least = (double)plant.vertices[0][0] / (double)s->vertices;
	measure_shares(s, &plant, s->q->q[BENCH_COLLAPSE_PRINTED]);
	enum eco_code code = measure_levels(s, &plant, error);
	snprintf(file, sizeof file, "collapse-%s-atlas.png", s->name);
	if (!code)
		code = bench_collapse_draw_atlas(s->bench, file, &plant.atlas, error);
	snprintf(file, sizeof file, "collapse-%s-levels.png", s->name);
	if (!code)
		code = bench_collapse_draw_levels(s->bench, file, &s->leaves, &plant, &s->tests[0],
			s->vertices, error);
	return code;
}

/* ---- Sectors ---- */

/* 1 for a wedge that faces the eye, 0 for one behind the tree, a half for the inner sector. */
static double facing(const struct lod_collapse *forest, const struct lod_eye *eye)
{
	struct lod_v3 sum = { 0, 0, 0 }, to = { -eye->forward[0], -eye->forward[1], 0 };
	for (uint32_t i = 0; i < forest->leaves; i++)
		sum = lod_v3_add(sum, forest->node[i].center);
	sum.z = 0;
	return 0.5 + 0.5 * lod_v3_dot(lod_v3_unit(sum), to);
}

/* Vertices of each sector: by its weight and size, and none more than it has. */
static void allocate(const struct bench_collapse_plant *plant, const struct lod_eye *eye, double vertices,
	double *given)
{
	double weight[BENCH_COLLAPSE_WEDGES], all[BENCH_COLLAPSE_WEDGES];
	for (uint32_t k = 0; k < BENCH_COLLAPSE_WEDGES; k++) {
		const struct lod_collapse *forest = &plant->sectors.forest[k];
		all[k] = (double)plant->vertices[k][forest->made];
		weight[k] = all[k] * (0.5 + (k ? facing(forest, eye) : 0));
		given[k] = 0;
	}
	for (int pass = 0; pass < PASSES; pass++) {
		double left = vertices, sum = 0;
		for (uint32_t k = 0; k < BENCH_COLLAPSE_WEDGES; k++) {
			left -= given[k];
			sum += given[k] < all[k] ? weight[k] : 0;
		}
		for (uint32_t k = 0; k < BENCH_COLLAPSE_WEDGES && sum > 0 && left > 0; k++)
			if (given[k] < all[k])
				given[k] = fmin(all[k], given[k] + left * weight[k] / sum);
	}
}

static uint32_t order_sectors(struct study *s, const struct bench_collapse_plant *plant, uint32_t view,
	double vertices, bool *fits)
{
	double given[BENCH_COLLAPSE_WEDGES];
	uint32_t count = 0;
	uint64_t drawn = 0;
	allocate(plant, &s->tests[0].eyes[view], vertices, given);
	for (uint32_t k = 0; k < BENCH_COLLAPSE_WEDGES; k++) {
		uint32_t row = bench_collapse_row(plant, k, given[k]);
		drawn += plant->vertices[k][row];
		count += bench_collapse_order(plant, k, row, s->order + count);
	}
	*fits = (double)drawn <= vertices;
	return count;
}

static enum eco_code measure_sectors(struct study *s, struct eco_error *error)
{
	struct bench_collapse_plant plant;
	char file[128];
	double seconds = s->q->seconds;
	grow(s, &plant, &(struct bench_collapse_options){ .sectors = BENCH_COLLAPSE_WEDGES });
	s->q->seconds = seconds;
	for (uint32_t i = 0; i < BENCH_SHARES; i++) {
		struct bench_wrong sum = { 0 };
		bool fits = true;
		for (uint32_t v = 0; v < s->views && fits; v++) {
			const struct lod_sights_drawing drawing = { .order = s->order, .scale = 1,
				.count = order_sectors(s, &plant, v, bench_shares[i] * (double)s->vertices,
				&fits) };
			bench_leaves_compare(&s->leaves, &s->tests[0], v, &drawing, &sum);
		}
		s->q->q[BENCH_COLLAPSE_SECTORS][i] = fits ? bench_wrong_q(&sum) : NAN;
	}
	snprintf(file, sizeof file, "collapse-%s-sectors.png", s->name);
	return bench_collapse_draw_sectors(s->bench, file, &s->bare, &plant.sectors, error);
}

/* ---- Splats ---- */

static void compare_splats(struct study *s, const struct bench_splats_drawn *drawn, uint32_t view,
	struct bench_wrong *sum)
{
	const struct lod_sights *sights = &s->tests[0];
	struct lod_raster *raster = &s->leaves.cover;
	uint32_t row_words = sights->words / sights->pixels;
	lod_raster_clear(raster);
	lod_raster_camera(raster, &sights->eyes[view], sights->near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	bench_splats_draw(drawn, raster);
	for (size_t i = 0; i < (size_t)sights->pixels * sights->pixels; i++) {
		size_t word = i / sights->pixels * row_words + i % sights->pixels / 64;
		uint64_t bit = UINT64_C(1) << (i % sights->pixels % 64);
		bool shown = raster->cover[i] || (sights->wood[view][word] & bit),
			wanted = sights->reference[view][word] & bit;
		sum->fp += shown && !wanted;
		sum->fn += wanted && !shown;
	}
	sum->pixels += sights->reference_pixels[view];
}

static enum eco_code measure_splats(struct study *s, struct eco_error *error)
{
	struct lod_splats splats;
	struct lod_splat *items = lod_arena_take(&s->leaves.arena, SPLATS_MOST, sizeof *items);
	const struct lod_splats_options options = { 0 };
	enum eco_code code = lod_splats_fit(&splats, &s->leaves.model, &options, error);
	for (uint32_t i = 0; i < BENCH_SHARES && !code && splats.level_count; i++) {
		struct bench_wrong sum = { 0 };
		double room = fmin(bench_shares[i] * (double)s->vertices, SPLATS_MOST);
		struct bench_splats_drawn drawn = { items,
			bench_splats_state(&splats, (uint32_t)room, items) };
		for (uint32_t v = 0; v < s->views; v++)
			compare_splats(s, &drawn, v, &sum);
		s->q->q[BENCH_COLLAPSE_SPLATS][i] = bench_wrong_q(&sum);
	}
	if (!code)
		lod_splats_free(&splats);
	return code;
}

/* ---- All of it ---- */

static enum eco_code run_study(struct study *s, struct eco_error *error)
{
	double directions[12][3];
	lod_directions_spread(directions, TUNING_VIEWS, TUNING_SEED);
	enum eco_code code = lod_sights_make(&s->tuning, &s->leaves.foliage,
		(const double (*)[3])directions, TUNING_VIEWS, PIXELS, &s->leaves.arena, error);
	lod_directions_spread(directions, s->views, TEST_SEED);
	for (uint32_t z = 0; z < BENCH_COLLAPSE_SIZES && !code; z++)
		code = lod_sights_make(&s->tests[z], &s->leaves.foliage, (const double (*)[3])directions,
			s->views, bench_collapse_pixels[z], &s->leaves.arena, error);
	s->bare = s->leaves.foliage;
	s->order = lod_arena_take(&s->leaves.arena, s->bare.count, sizeof *s->order);
	for (uint32_t i = 0; i < s->bare.count; i++)
		s->vertices += 3 * (s->bare.first[i + 1] - s->bare.first[i] - 2);
	s->q->leaves = s->bare.count;
	if (!code)
		code = measure_forest(s, error);
	if (!code)
		code = measure_sectors(s, error);
	if (!code && bench_stopped(s->bench))
		code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	return code ? code : measure_splats(s, error);
}

enum eco_code bench_collapse_measure(struct bench *bench, const char *name, struct bench_collapse_q *q,
	struct eco_model *model, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	*q = (struct bench_collapse_q){ 0 };
	if (!s) {
		eco_model_free(model);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a study of leaf collapse");
	}
	*s = (struct study){ .bench = bench, .name = name, .q = q, .views = bench->full ? 12 : 6 };
	enum eco_code code = bench_leaves_open(&s->leaves, model, PIXELS, error);
	if (!code) {
		if (setjmp(s->leaves.arena.failed))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for levels of %u leaves",
				s->leaves.foliage.count);
		else
			code = run_study(s, error);
		bench_leaves_close(&s->leaves);
	}
	free(s);
	return code;
}
