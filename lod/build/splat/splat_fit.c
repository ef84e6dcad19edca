/* Fitting levels of splats. The points of the plant's visible surface are divided among the splats of a level,
 * rather evenly, and those of each splat among its children, which begin with the moments of their points. Then
 * gradient descent (Adam: Kingma and Ba 2015) moves all splats of a level, so that the mean Q of the views rises,
 * at last also between two levels. Measurements: lod/EXPERIMENTS.md, Splats. */
#include "lod/build/splat/splat_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/build/splat/splat_state.h"
#include "lod/lanes.h"
#include "lod/sort.h"

#define FIRST_SPREAD 1.6         /* half axes over standard deviations */

#define LARGE_PLANT 24000u       /* triangles: it has a level more */
#define ENOUGH 0.01              /* loss: no finer level */
#define PAYS 0.98                /* a last level has at most so much of the loss of the one before it */
#define PAYS_LEAST 0.002
#define MOST_SHARE 0.8           /* of the plant's vertices that a level may take (lod/EXPERIMENTS.md) */
#define FEW_POINTS 3u            /* fewer say nothing about a shape */
#define LEAST_HALF 0.01          /* half an axis, where points are given to splats */
#define ROUNDS 6u                /* of prices, for levels of at most so many splats */
#define ROUNDS_DRAFT 2u
#define PRICED 192u
#define MOST_SIBLINGS 4u

static const uint32_t usual_size[LOD_SPLAT_LEVELS] = { 1, 3, 6, 12, 24, 48, 192, 768, 3072, 12288 };
#define SPARSE 0.4               /* cover: blades stand apart (splat_blades.c) */
#define CHANCE_FEW 0.1f          /* at least, for levels of at most so many splats */
#define FEW_SPLATS 12u
#define CHANCE 0.03f
#define COARSE_SPLATS 48u        /* levels of at most so many are fitted in coarse views alone */
/* Levels of at most so many begin there: so much of their descent. Finer ones would lose by it. */
#define COARSE_FIRST 192u
#define COARSE_SHARE 0.7f
#define FEW_TRIANGLES 4096u      /* plants of blades have fewer */
struct fit {
	const struct lod_splats_options *options;
	struct lod_arena arena;
	struct splat_views views, coarse;
	struct splat_points points;
	uint32_t size[LOD_SPLAT_LEVELS], most;   /* splats of each level; levels at most */
	struct splat_blades blades;      /* levels 0: it is no plant of blades */
	struct splat_part *parts[LOD_SPLAT_LEVELS];
	struct splat_params *level[LOD_SPLAT_LEVELS];
	struct lod_splats *splats;
	double cover;                    /* mean cover of the pixels that the plant covers at all */
};

/* ---- Parts ---- */

/* Into two halves of halves, or into thirds, each along its own longest axis. */
static void divide(struct fit *fit, struct splat_part part, struct splat_part *to, uint32_t count)
{
	uint32_t by = count % 2 ? count : 2, each = count / by;
	if (count == 1) {
		*to = part;
		return;
	}
	splat_sort_along(fit->points.at + part.first, part.end - part.first, &fit->arena);
	uint64_t points = part.end - part.first;
	for (uint32_t i = 0; i < by; i++)
		divide(fit, (struct splat_part){ part.first + (uint32_t)(points * i / by),
			part.first + (uint32_t)(points * (i + 1) / by) }, to + i * each, each);
}

/* A quarter of a splat: at one of four places in the plane of its longer axes. */
static void shrink(const struct splat_params *parent, uint32_t which, struct splat_params *splat)
{
	struct splat_params straight = *parent;
	splat_orthogonal(&straight);
	*splat = straight;
	for (int i = 0; i < 3; i++)
		splat->v[i] += (which & 1 ? 0.5f : -0.5f) * straight.v[SPLAT_AXES + i]
			+ (which & 2 ? 0.5f : -0.5f) * straight.v[SPLAT_AXES + 3 + i];
	for (uint32_t j = SPLAT_AXES; j < SPLAT_OPACITY; j++)
		splat->v[j] *= 0.6f;
}

static void first_shape(struct fit *fit, const struct splat_part *part, const struct splat_params *parent,
	uint32_t which, struct splat_params *splat)
{
	double mean[3], value[3], vector[3][3];
	uint32_t count = part->end - part->first;
	splat_moments((const float (*)[3])(fit->points.at + part->first), count, mean, value, vector);
	if (count < FEW_POINTS && parent) {
		shrink(parent, which, splat);
		return;
	}
	double longest = FIRST_SPREAD * sqrt(value[0] > 0 ? value[0] : 0), least = 0.2 * longest;
	least = least > 0.002 ? least : 0.002;
	for (int k = 0; k < 3; k++) {
		double length = value[k] > 0 ? FIRST_SPREAD * sqrt(value[k]) : 0;
		length = length > least ? length : least;
		splat->v[k] = (float)mean[k];
		for (int i = 0; i < 3; i++)
			splat->v[SPLAT_AXES + 3 * k + i] = (float)(length * vector[k][i]);
	}
	splat->v[SPLAT_OPACITY] = 0.8f;
}

#define FOUR(n) (((n) + 3) / 4 * 4)

struct sharing {
	const struct splat_params *splats;
	double (*inverse)[3][3], *price; /* a splat with a high price takes fewer points */
	double *near;                    /* of a unit of squared distance: x^T C^-1 x is no less */
	double *at[3], *least;           /* centres; price times near; rounded up to fours */
	uint32_t count, *taken;
};

static inline __attribute__((always_inline)) double cost_of(const struct sharing *s, uint32_t i,
	const float point[3])
{
	return s->price[i] * splat_distance2(&s->splats[i], (const double (*)[3])s->inverse[i], point);
}

static double square(double x) { return x * x; }

/* Those of four splats that may cost no more than `cost`, a bit each. */
static inline __attribute__((always_inline)) unsigned may_take(const struct sharing *s, uint32_t i,
	const double point[3], double cost)
{
	lod_d4 away = { 0 }, at, least;
	for (int k = 0; k < 3; k++) {
		memcpy(&at, s->at[k] + i, sizeof at);
		at = point[k] - at;
		away += at * at;
	}
	memcpy(&least, s->least + i, sizeof least);
	least *= away;
	unsigned lanes = 0;
	for (unsigned lane = 0; lane < 4; lane++)
		lanes |= (unsigned)!(least[lane] > cost) << lane;
	return lanes;
}

/* Each point to the splat that holds it most, at its price; of equal ones to the first. The point before lies
 * near: its splat is asked first, and those that are certainly worse are not. */
LOD_CLONES static void share_once(const struct fit *fit, struct sharing *s, struct lod_keyed *keyed)
{
	uint32_t best = 0;
	memset(s->taken, 0, s->count * sizeof *s->taken);
	for (uint32_t i = 0; i < s->count; i++)
		s->least[i] = s->price[i] * s->near[i];
	for (uint32_t p = 0; p < fit->points.count; p++) {
		const float *point = fit->points.at[p];
		const double from[3] = { point[0], point[1], point[2] };
		double least = cost_of(s, best, point);
		for (uint32_t four = 0, first = best; four < s->count; four += 4)
			for (unsigned lanes = may_take(s, four, from, least); lanes; lanes &= lanes - 1) {
				uint32_t i = four + (unsigned)__builtin_ctz(lanes);
				if (i == first || i >= s->count)
					continue;
				double q = cost_of(s, i, point);
				if (q < least || (q == least && i < best)) {
					least = q;
					best = i;
				}
			}
		keyed[p] = (struct lod_keyed){ best, p };
		s->taken[best]++;
	}
}

/* The least eigenvalue of the inverse (splat_inverse) is no less than one over the sum of the matrix's, if it
 * has all three; a little is for rounding. */
static double near_of(const struct splat_params *splat)
{
	struct splat_params straight = *splat;
	double trace = 0;
	splat_orthogonal(&straight);
	for (uint32_t k = 0; k < 3; k++) {
		const float *half = straight.v + SPLAT_AXES + 3 * k;
		double length2 = square(half[0]) + square(half[1]) + square(half[2]);
		if (!(length2 > 0))
			return 0;
		trace += length2 + square(LEAST_HALF);
	}
	return 0.999 / trace;
}

/* Points go to the splats that hold them, so children begin where their parent has gone; rather evenly, as
 * each parent has the same number of children. */
static void share_points(struct fit *fit, uint32_t level)
{
	const struct lod_arena_piece *mark = fit->arena.last;
	struct sharing s = { .splats = fit->level[level], .count = fit->size[level] };
	s.inverse = lod_arena_take(&fit->arena, s.count, sizeof *s.inverse);
	s.price = lod_arena_take(&fit->arena, s.count, sizeof *s.price);
	s.near = lod_arena_take(&fit->arena, s.count, sizeof *s.near);
	s.taken = lod_arena_take(&fit->arena, s.count, sizeof *s.taken);
	for (int k = 0; k < 3; k++)
		s.at[k] = lod_arena_take(&fit->arena, FOUR(s.count), sizeof **s.at);
	s.least = lod_arena_take(&fit->arena, FOUR(s.count), sizeof *s.least);
	struct lod_keyed *keyed = lod_arena_take(&fit->arena, fit->points.count, sizeof *keyed);
	float (*copy)[3] = lod_arena_take(&fit->arena, fit->points.count, sizeof *copy);
	for (uint32_t i = 0; i < s.count; i++) {
		splat_inverse(&s.splats[i], LEAST_HALF, s.inverse[i]);
		s.near[i] = near_of(&s.splats[i]);
		for (int k = 0; k < 3; k++)
			s.at[k][i] = s.splats[i].v[k];
		s.price[i] = 1;
	}
	double mean = (double)fit->points.count / s.count;
	uint32_t rounds = s.count > PRICED ? 0 : fit->options->draft ? ROUNDS_DRAFT : ROUNDS;
	for (uint32_t round = 0; round <= rounds; round++) {
		for (uint32_t i = 0; round && i < s.count; i++)
			s.price[i] *= (s.taken[i] + mean) / (2 * mean);
		share_once(fit, &s, keyed);
	}
	lod_sort(&fit->arena, keyed, fit->points.count);
	memcpy(copy, fit->points.at, fit->points.count * sizeof *copy);
	for (uint32_t p = 0, i = 0; i < s.count; i++) {
		fit->parts[level][i].first = p;
		for (; p < fit->points.count && keyed[p].key == i; p++)
			memcpy(fit->points.at[p], copy[keyed[p].value], sizeof *copy);
		fit->parts[level][i].end = p;
	}
	lod_arena_release(&fit->arena, mark);
}

/* ---- Levels ---- */

static void choose_sizes(struct fit *fit, const struct eco_model *model)
{
	memcpy(fit->size, usual_size, sizeof usual_size);
	fit->most = LOD_SPLAT_LEVELS - (model->triangle_count < LARGE_PLANT);
	if (model->triangle_count < FEW_TRIANGLES
			&& splat_blades_find(&fit->blades, &fit->points, model, &fit->arena)) {
		memcpy(fit->size, fit->blades.size, sizeof fit->size);
		fit->most = fit->blades.levels;
	}
}

static void find_parts(struct fit *fit, uint32_t level)
{
	struct splat_part *parts = fit->parts[level];
	if (fit->blades.levels && level <= fit->blades.level) {
		for (uint32_t i = 0; i < fit->size[level]; i++)
			parts[i] = splat_blades_part(&fit->blades, level, i);
		return;
	}
	if (!level) {
		parts[0] = (struct splat_part){ 0, fit->points.count };
		return;
	}
	uint32_t children = fit->size[level] / fit->size[level - 1];
	if (!fit->blades.levels)
		share_points(fit, level - 1);
	for (uint32_t i = 0; i < fit->size[level - 1]; i++)
		divide(fit, fit->parts[level - 1][i], parts + i * children, children);
}

static void start_level(struct fit *fit, uint32_t level)
{
	uint32_t size = fit->size[level], children = level ? size / fit->size[level - 1] : 1;
	fit->level[level] = lod_arena_take(&fit->arena, size, sizeof **fit->level);
	fit->parts[level] = lod_arena_take(&fit->arena, size, sizeof **fit->parts);
	find_parts(fit, level);
	for (uint32_t i = 0; i < size; i++)
		first_shape(fit, &fit->parts[level][i], level ? &fit->level[level - 1][i / children] : NULL,
			i % children, &fit->level[level][i]);
}

static uint32_t count_levels(const struct fit *fit, const struct eco_model *model)
{
	uint32_t most = fit->options->levels && fit->options->levels < fit->most ? fit->options->levels
		: fit->most;
	uint32_t count = 1;
	while (count < most && fit->size[count] <= MOST_SHARE * 3 * model->triangle_count)
		count++;
	return count;
}

/* The points of all views become one array. */
static bool gather(struct fit *fit)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < fit->views.count; i++)
		count += fit->views.items[i].sample_count;
	fit->points.at = lod_arena_take(&fit->arena, count, sizeof *fit->points.at);
	fit->points.triangle = lod_arena_take(&fit->arena, count, sizeof *fit->points.triangle);
	for (uint32_t i = 0; i < fit->views.count; i++) {
		const struct splat_view *view = &fit->views.items[i];
		if (!view->sample_count)
			continue;
		memcpy(fit->points.at + fit->points.count, view->sample,
			view->sample_count * sizeof *view->sample);
		memcpy(fit->points.triangle + fit->points.count, view->triangle,
			view->sample_count * sizeof *view->triangle);
		fit->points.count += view->sample_count;
	}
	return count > 0;
}

static void place(struct lod_splats *splats, const struct splat_views *views)
{
	splats->radius = views->radius;
	splats->step = views->radius / 1024;
	splats->unit = (float)(views->radius / 16);
	for (int k = 0; k < 3; k++) {
		splats->center[k] = views->center[k];
		splats->origin[k] = views->center[k] - LOD_SPLAT_GRID / 2 * splats->step;
	}
}

/* The mean cover of the pixels that the plant covers at all. */
static double cover_of(const struct splat_views *views)
{
	double sum = 0;
	uint64_t pixels = 0;
	for (uint32_t v = 0; v < views->count; v++) {
		const struct splat_view *view = &views->items[v];
		sum += view->covered;
		for (size_t p = 0; p < (size_t)views->pixels * views->stride; p++)
			pixels += view->cover[p] > 0;
	}
	return sum / (double)(pixels + !pixels);
}

static bool descend(struct fit *fit, uint32_t level, uint32_t levels, bool settle)
{
	struct splat_descent descent = { .views = &fit->views, .splats = fit->level[level],
		.count = fit->size[level], .blades = fit->blades.levels > 0, .chance = CHANCE,
		.level = level, .levels = levels, .options = fit->options, .settle = settle };
	descent.coarse = &fit->coarse;
	descent.coarse_share = fit->blades.levels ? 0 : fit->size[level] <= COARSE_SPLATS ? 1
		: fit->size[level] <= COARSE_FIRST && !settle ? COARSE_SHARE : 0;
	if (fit->size[level] <= FEW_SPLATS && descent.chance < CHANCE_FEW)
		descent.chance = CHANCE_FEW;
	if (level && !settle) {
		descent.parents = fit->level[level - 1];
		descent.children = fit->size[level] / fit->size[level - 1];
	}
	bool go = splat_descend(&descent, &fit->arena);
	fit->splats->loss[level] = descent.loss;
	return go;
}

/* ---- Blades ---- */

/* Pixels that are covered little: half of the blades drawn well are better than haze, so the level before that
 * of the blades becomes half of its splats. If blades are dense, splats that stand for two are better. */
static void keep_heads(struct fit *fit)
{
	uint32_t level = fit->blades.level, half = level - 1, each = fit->size[level] / fit->size[half];
	for (uint32_t i = 0; i < fit->size[half]; i++)
		fit->level[half][i] = fit->level[level][(size_t)i * each];
}

/* ---- Order ---- */

/* gain[l][m][i]: what the descendants in level m of splat i of level l gain when they give way. */
struct family { double *gain[LOD_SPLAT_LEVELS][LOD_SPLAT_LEVELS]; };

static void find_gains(struct fit *fit, uint32_t levels, struct family *family)
{
	for (uint32_t l = 0; l < levels; l++)
		for (uint32_t m = l; m < levels; m++)
			family->gain[l][m] = lod_arena_take(&fit->arena, fit->size[l],
				sizeof *family->gain[l][m]);
	for (uint32_t l = levels - 1; l-- > 0;) {
		uint32_t children = fit->size[l + 1] / fit->size[l];
		splat_gains(&fit->views, fit->level[l], fit->size[l], fit->level[l + 1], children,
			&fit->arena, family->gain[l][l]);
		for (uint32_t m = l + 1; m < levels; m++)
			for (uint32_t i = 0; i < fit->size[l + 1]; i++)
				family->gain[l][m][i / children] += family->gain[l + 1][m][i];
	}
}

struct siblings {
	const struct family *family;
	uint32_t level, levels, first, count;
	uint32_t order[MOST_SIBLINGS], best[MOST_SIBLINGS];
	double least;                    /* what pictures between two levels lose in the best order */
};

/* The greatest distance of the gain below an even rise, squared and summed over all levels. */
static double dips_of(const struct siblings *s)
{
	double sum = 0;
	for (uint32_t m = s->level; m < s->levels; m++) {
		const double *gain = s->family->gain[s->level][m] + s->first;
		double all = 0, so_far = 0, worst = 0;
		for (uint32_t i = 0; i < s->count; i++)
			all += gain[i];
		for (uint32_t i = 0; i < s->count; i++) {
			so_far += gain[s->order[i]];
			double dip = all * (i + 1) / s->count - so_far;
			worst = dip > worst ? dip : worst;
		}
		sum += worst * worst;
	}
	return sum;
}

/* All orders of the siblings from `at` on. */
static void try_orders(struct siblings *s, uint32_t at)
{
	if (at == s->count) {
		double dips = dips_of(s);
		if (dips < s->least) {
			s->least = dips;
			memcpy(s->best, s->order, sizeof s->best);
		}
		return;
	}
	for (uint32_t i = at; i < s->count; i++) {
		uint32_t kept = s->order[at];
		s->order[at] = s->order[i];
		s->order[i] = kept;
		try_orders(s, at + 1);
		s->order[i] = s->order[at];
		s->order[at] = kept;
	}
}

/* Sorts the splats of a level within their groups; groups stand as their parents do, so the order of siblings
 * is that of all that descends from them, too. */
static void order_level(struct fit *fit, const struct family *family, uint32_t level, uint32_t levels,
	const uint32_t *parents, uint32_t *order)
{
	uint32_t count = fit->size[level] / fit->size[level - 1];
	for (uint32_t i = 0; i < fit->size[level]; i += count) {
		struct siblings s = { .family = family, .level = level, .levels = levels, .count = count,
			.first = parents[i / count] * count, .order = { 0, 1, 2, 3 }, .least = INFINITY };
		try_orders(&s, 0);
		for (uint32_t k = 0; k < count; k++)
			order[i + k] = s.first + s.best[k];
	}
	const struct lod_arena_piece *mark = fit->arena.last;
	struct splat_params *copy = lod_arena_take(&fit->arena, fit->size[level], sizeof *copy);
	memcpy(copy, fit->level[level], fit->size[level] * sizeof *copy);
	for (uint32_t i = 0; i < fit->size[level]; i++)
		fit->level[level][i] = copy[order[i]];
	lod_arena_release(&fit->arena, mark);
}

static void order_all(struct fit *fit, uint32_t levels)
{
	struct family *family = lod_arena_take(&fit->arena, 1, sizeof *family);
	uint32_t *order[LOD_SPLAT_LEVELS];
	find_gains(fit, levels, family);
	for (uint32_t l = 0; l < levels; l++) {
		order[l] = lod_arena_take(&fit->arena, fit->size[l], sizeof **order);
		if (l)
			order_level(fit, family, l, levels, order[l - 1], order[l]);
	}
}

/* ---- Rounding ---- */

static void round_level(struct fit *fit, uint32_t level, struct lod_splat *to)
{
	for (uint32_t i = 0; i < fit->size[level]; i++) {
		splat_store(&to[i], &fit->level[level][i], fit->splats);
		splat_restore(&fit->level[level][i], &to[i], fit->splats);
	}
}

/* Half axes are rounded by 5 %: what can be told more finely settles around them. */
static bool store(struct fit *fit, uint32_t levels)
{
	struct lod_splats *splats = fit->splats;
	uint32_t count = 0;
	for (uint32_t l = 0; l < levels; l++)
		splats->level_end[l] = count += fit->size[l];
	splats->items = eco_alloc(count, sizeof *splats->items);
	for (uint32_t l = 0; l < levels; l++) {
		struct lod_splat *to = splats->items + lod_splats_first(splats, l);
		round_level(fit, l, to);
		if (!descend(fit, l, levels, true))
			return false;
		round_level(fit, l, to);
		splats->tone = splat_color_level(&fit->views, fit->level[l], fit->size[l],
			l ? splats->items + lod_splats_first(splats, l - 1) : NULL,
			l ? fit->size[l] / fit->size[l - 1] : 1, &fit->arena, to);
	}
	splats->level_count = levels;
	return true;
}

static bool pays(double before, double loss)
{
	return loss <= PAYS * before && loss <= before - PAYS_LEAST;
}

/* False if progress says stop. */
static bool run(struct fit *fit, const struct eco_model *model)
{
	splat_views_make(&fit->views, model, fit->options, &fit->arena);
	fit->splats->leaf = splat_views_leaf(&fit->views) * fit->views.radius;
	if (!gather(fit))
		return true;
	splat_views_coarsen(&fit->coarse, &fit->views, &fit->arena);
	place(fit->splats, &fit->views);
	choose_sizes(fit, model);
	fit->cover = cover_of(&fit->views);
	uint32_t levels = count_levels(fit, model);
	for (uint32_t l = 0; l < levels; l++) {
		start_level(fit, l);
		if (!descend(fit, l, levels, false))
			return false;
		if (fit->blades.levels && l == fit->blades.level && fit->cover < SPARSE)
			keep_heads(fit);
		if (fit->splats->loss[l] < ENOUGH)
			levels = l + 1;
	}
	while (levels > 1 && !pays(fit->splats->loss[levels - 2], fit->splats->loss[levels - 1]))
		levels--;
	order_all(fit, levels);
	return store(fit, levels);
}

enum eco_code lod_splats_fit(struct lod_splats *splats, const struct eco_model *model,
	const struct lod_splats_options *options, struct eco_error *error)
{
	struct fit *fit = eco_alloc(1, sizeof *fit);
	memset(splats, 0, sizeof *splats);
	fit->options = options;
	fit->splats = splats;
	bool good = run(fit, model);
	lod_arena_free(&fit->arena);
	free(fit);
	if (good)
		return ECO_OK;
	lod_splats_free(splats);
	return eco_fail(error, ECO_INTERRUPTED, "interrupted");
}

void lod_splats_free(struct lod_splats *splats)
{
	free(splats->items);
	memset(splats, 0, sizeof *splats);
}
