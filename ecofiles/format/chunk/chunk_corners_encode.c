/* The encoder's choices: the trends of a chunk, and how each element is stored. Trends are fitted as
 * k-means fits centres: a new trend starts from the elements that the present ones predict worst, then
 * each is fitted to the elements that it predicts best. A fit minimises the sum of misses, not of their
 * squares, as most leaves may bend alike and a few differently. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk_shapes.h"

#define ROUNDS 4
#define STEADY 1e-3              /* added to the diagonal, in units: systems may be singular */
#define WEIGHT_COST 9.0          /* bits of one weight, about */
#define LEAVES_MAX 512u

/* Greatest squared error of a corner: as far as rounding to the coarse grid could move it. */
static const int64_t room = 3 * (1 << ECO_EXACT_SHIFT >> 1) * (1 << ECO_EXACT_SHIFT >> 1);

static int64_t distance2(const int32_t *a, const int32_t *b)
{
	int64_t d2 = 0;
	for (int i = 0; i < 3; i++)
		d2 += ((int64_t)a[i] - b[i]) * ((int64_t)a[i] - b[i]);
	return d2;
}

/* ---- Planning ---- */

static int64_t floor_div(int64_t v, int64_t by)
{
	return v >= 0 ? v / by : -((by - 1 - v) / by);
}

/* Finds the lattice point nearest to `exact`: the best of those that are nearest for each number of steps
 * along the first axis. */
static bool nearest_miss(const struct eco_frame *f, const int64_t guess[3], const int32_t *from,
	const int32_t *exact, int32_t *miss, int32_t *at)
{
	int64_t along[3], best = room + 1, off[3];
	int32_t tried[3], there[3];
	for (int i = 0; i < 3; i++)
		off[i] = (int64_t)exact[i] - from[i];
	for (int a = 0; a < 3; a++)
		along[a] = ((off[0] * f->axis[a][0] + off[1] * f->axis[a][1] + off[2] * f->axis[a][2])
			>> ECO_AXIS_BITS) - guess[a];
	for (int32_t step = -1; step <= 2; step++) {
		int64_t first = floor_div(along[0], ECO_LATTICE_STEP) + step;
		if (first > INT32_MAX / 16 || first < -INT32_MAX / 16)
			return false;
		tried[0] = (int32_t)first;
		for (int a = 1; a < 3; a++)
			tried[a] = (int32_t)floor_div(along[a] - ECO_LATTICE_STEP * (tried[0] & 1)
				+ ECO_LATTICE_STEP, 2 * ECO_LATTICE_STEP);
		if (!eco_corner_place(f, guess, tried, from, there) || distance2(there, exact) >= best)
			continue;
		best = distance2(there, exact);
		memcpy(miss, tried, sizeof tried);
		memcpy(at, there, sizeof there);
	}
	return best <= room;
}

static uint32_t cost_of(const int32_t miss[3])
{
	uint32_t bits = 0;
	for (int i = 0; i < 3; i++)
		bits += eco_bit_length((uint64_t)(miss[i] < 0 ? -(int64_t)miss[i] : miss[i]));
	return bits;
}

static bool find_again(const struct eco_shapes_codec *c, struct eco_leaf *l, uint32_t k)
{
	l->found[k] = c->slots[eco_corners_slot(c, l->coarse + 3 * k)];
	if (l->found[k] == UINT32_MAX)
		return false;
	const int32_t *at = c->seen + 3 * (size_t)l->found[k];
	if (distance2(at, l->exact + 3 * k) > room) {
		l->found[k] = UINT32_MAX;
		return false;
	}
	memcpy(l->position + 3 * k, at, 3 * sizeof *at);
	return true;
}

/* Bits of the element under a trend, or UINT32_MAX where a corner would be too far off. */
static uint32_t plan_with(const struct eco_shapes_codec *c, struct eco_leaf *l, uint8_t trend)
{
	bool plain = trend == c->head.trends[l->corners - 3];
	struct eco_frame frame = { .of = 0 };
	uint32_t bits = plain;
	l->trend = trend;
	for (uint32_t k = 1; k < l->corners; k++) {
		int32_t *miss = l->miss + 3 * k, *at = l->position + 3 * k;
		if (find_again(c, l, k))
			continue;
		if (plain) {
			for (int i = 0; i < 3; i++) {
				miss[i] = (int32_t)floor_div((int64_t)l->exact[3 * k + (uint32_t)i]
					- at[i - 3] + (1 << ECO_EXACT_SHIFT >> 1), 1 << ECO_EXACT_SHIFT);
				at[i] = at[i - 3] + miss[i] * (1 << ECO_EXACT_SHIFT);
			}
		} else {
			int64_t guess[3];
			eco_corner_frame(&frame, l->position, k);
			eco_corner_guess(&frame, c->head.trend[l->corners - 3][trend].weight[k], guess);
			if (!nearest_miss(&frame, guess, l->position, l->exact + 3 * k, miss, at))
				return UINT32_MAX;
		}
		bits += cost_of(miss);
	}
	return bits;
}

void eco_corners_plan(const struct eco_shapes_codec *c, struct eco_leaf *l)
{
	struct eco_leaf best = *l;
	uint32_t least = UINT32_MAX;
	for (uint32_t i = 0; i < 3; i++)
		l->position[i] = l->coarse[i] * (1 << ECO_EXACT_SHIFT);
	for (uint32_t t = c->head.trends[l->corners - 3] + 1u; t-- > 0;) {
		uint32_t bits = plan_with(c, l, (uint8_t)t);
		if (bits < least) {
			least = bits;
			best = *l;
		}
	}
	*l = best;
}

/* ---- Fitting ---- */

/* A frame in floating point, and its corner from the element's first; bases beyond the frame's are 0. */
struct view { double base[3][ECO_BASES_MAX], axis[3][3], to[3]; uint32_t bases; };

struct fit {
	uint32_t corners, count, trends;
	const int32_t *const *at;
	struct eco_trend trend[ECO_TRENDS_MAX];
	uint8_t of[LEAVES_MAX];
	double miss[LEAVES_MAX];     /* bits of the misses under its trend */
	double share;                /* elements that each sampled one stands for */
	struct view *views;          /* of corners 2 and on, for each */
};

static struct view *view_of(const struct fit *f, uint32_t i, uint32_t k)
{
	return &f->views[(size_t)i * (f->corners - 2) + k - 2];
}

static void make_view(struct view *view, const struct eco_frame *frame, const int32_t *at, uint32_t k)
{
	*view = (struct view){ .bases = frame->bases };
	for (uint32_t i = 0; i < 3; i++) {
		for (uint32_t j = 0; j < frame->bases; j++)
			view->base[i][j] = frame->base[j][i];
		for (uint32_t a = 0; a < 3; a++)
			view->axis[a][i] = (double)frame->axis[a][i];
		view->to[i] = (double)at[3 * k + i] - at[i];
	}
}

static void make_views(struct fit *f)
{
	f->views = eco_alloc((size_t)f->count * (f->corners - 2), sizeof *f->views);
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_frame frame = { .of = 0 };
		for (uint32_t k = 2; k < f->corners; k++) {
			eco_corner_frame(&frame, f->at[i], k);
			make_view(view_of(f, i, k), &frame, f->at[i], k);
		}
	}
}

/* Solves a x = b by Gauss's method for up to ECO_BASES_MAX unknowns; a is symmetric and positive. False: a
 * pivot is too small. */
static bool solve(double a[ECO_BASES_MAX][ECO_BASES_MAX], double b[ECO_BASES_MAX], uint32_t n)
{
	for (uint32_t i = 0; i < n; i++) {
		if (!(a[i][i] > 1e-9))
			return false;
		for (uint32_t r = i + 1; r < n; r++) {
			double f = a[r][i] / a[i][i];
			for (uint32_t k = i; k < n; k++)
				a[r][k] -= f * a[i][k];
			b[r] -= f * b[i];
		}
	}
	for (uint32_t i = n; i-- > 0;) {
		for (uint32_t k = i + 1; k < n; k++)
			b[i] -= a[i][k] * b[k];
		b[i] /= a[i][i];
	}
	return true;
}

/* The vector from the weighted guess to the corner. */
static void miss_of(const struct view *view, const double *weight, double miss[3])
{
	for (int i = 0; i < 3; i++) {
		miss[i] = view->to[i];
		for (uint32_t j = 0; j < view->bases; j++)
			miss[i] -= weight[j] * view->base[i][j];
	}
}

static int32_t usual_weight(uint32_t k, uint32_t base)
{
	return base + 1 < k ? 1 << ECO_WEIGHT_BITS : 0;
}

/* Fixes the weight of base j at the default, so that it is no unknown. */
static void pin(double a[ECO_BASES_MAX][ECO_BASES_MAX], double b[ECO_BASES_MAX], uint32_t n, uint32_t j,
	double weight)
{
	for (uint32_t l = 0; l < n; l++) {
		b[l] -= a[l][j] * weight;
		a[l][j] = a[j][l] = l == j;
	}
	b[j] = weight;
}

/* Fits the weights of corner k, except those of the bases in `pinned`. */
static void fit_corner(const struct fit *f, uint8_t trend, uint32_t k, uint32_t pinned, int32_t *weight)
{
	double x[ECO_BASES_MAX] = { 0 };
	const uint32_t n = eco_corner_bases(k);
	for (int round = 0; round < ROUNDS; round++) {
		double a[ECO_BASES_MAX][ECO_BASES_MAX] = { { 0 } }, b[ECO_BASES_MAX] = { 0 }, miss[3];
		for (uint32_t i = 0; i < f->count; i++) {
			const struct view *view = view_of(f, i, k);
			if (f->of[i] != trend)
				continue;
			miss_of(view, x, miss);
			double share = round == 0 ? 1
				: 1 / (sqrt(miss[0] * miss[0] + miss[1] * miss[1] + miss[2] * miss[2]) + 8);
			for (int d = 0; d < 3; d++)
				for (uint32_t j = 0; j < n; j++) {
					double part = share * view->base[d][j];
					for (uint32_t l = 0; l < ECO_BASES_MAX; l++)
						a[j][l] += part * view->base[d][l];
					b[j] += part * view->to[d];
				}
		}
		for (uint32_t j = 0; j < n; j++)
			a[j][j] += STEADY + 1e-7 * a[j][j];
		for (uint32_t j = 0; j < n; j++)
			if (pinned >> j & 1)
				pin(a, b, n, j, ldexp(usual_weight(k, j), -(int)ECO_WEIGHT_BITS));
		if (!solve(a, b, n))
			break;
		memcpy(x, b, sizeof x);
	}
	for (uint32_t j = 0; j < n; j++)
		weight[j] = fabs(x[j]) * (1 << ECO_WEIGHT_BITS) < ECO_WEIGHT_MAX
			? (int32_t)floor(ldexp(x[j], ECO_WEIGHT_BITS) + 0.5) : 0;
}

static double corner_bits(const struct fit *f, const int32_t *weight, uint32_t i, uint32_t k)
{
	const struct view *view = view_of(f, i, k);
	double bits = 0, miss[3], x[ECO_BASES_MAX];
	for (uint32_t j = 0; j < view->bases; j++)
		x[j] = weight[j] * (1.0 / (1 << ECO_WEIGHT_BITS));
	miss_of(view, x, miss);
	for (int a = 0; a < 3; a++)
		bits += log2(1
			+ fabs(miss[0] * view->axis[a][0] + miss[1] * view->axis[a][1]
			+ miss[2] * view->axis[a][2]) / (double)((int64_t)1 << ECO_AXIS_BITS)
			/ (1 << ECO_EXACT_SHIFT));
	return bits;
}

/* Bits of corner k over all elements that follow the trend, and of its weights. */
static double cost_with(const struct fit *f, uint8_t trend, uint32_t k, const int32_t *weight)
{
	double bits = 0;
	for (uint32_t i = 0; i < f->count; i++)
		if (f->of[i] == trend)
			bits += corner_bits(f, weight, i, k);
	bits *= f->share;
	for (uint32_t j = 0; j < eco_corner_bases(k); j++)
		if (weight[j] != usual_weight(k, j))
			bits += 4 + eco_bit_length((uint64_t)abs(weight[j] - usual_weight(k, j)));
	return bits;
}

/* Resets weights that do not pay to the default. */
static void prune(struct fit *f, uint8_t trend, uint32_t k)
{
	int32_t *weight = f->trend[trend].weight[k], tried[ECO_BASES_MAX];
	double least = cost_with(f, trend, k, weight);
	uint32_t pinned = 0;
	for (uint32_t j = eco_corner_bases(k); j-- > 0;) {
		fit_corner(f, trend, k, pinned | 1u << j, tried);
		double cost = cost_with(f, trend, k, tried);
		if (cost > least)
			continue;
		least = cost;
		pinned |= 1u << j;
		memcpy(weight, tried, sizeof tried);
	}
}

/* Fits all trends, gives each element to the best one, and returns the bits of all. */
static double refine(struct fit *f)
{
	double bits = 0;
	for (int round = 0; round < ROUNDS; round++) {
		for (uint8_t t = 0; t < f->trends; t++)
			for (uint32_t k = 2; k < f->corners; k++)
				fit_corner(f, t, k, 0, f->trend[t].weight[k]);
		bits = 0;
		for (uint32_t i = 0; i < f->count; i++) {
			f->miss[i] = INFINITY;
			for (uint8_t t = 0; t < f->trends; t++) {
				double missed = 0;
				for (uint32_t k = 2; k < f->corners; k++)
					missed += corner_bits(f, f->trend[t].weight[k], i, k);
				if (missed < f->miss[i]) {
					f->miss[i] = missed;
					f->of[i] = t;
				}
			}
			bits += f->miss[i];
		}
	}
	return bits;
}

void eco_corners_trends(struct eco_shapes_head *head, uint32_t corners, const int32_t *const *at,
	uint32_t count, double share)
{
	struct fit *f = eco_alloc(1, sizeof *f);
	uint32_t weights = 0;
	*f = (struct fit){ .corners = corners, .count = count < LEAVES_MAX ? count : LEAVES_MAX, .at = at,
		.trends = 1, .share = share };
	make_views(f);
	for (uint32_t k = 2; k < corners; k++)
		weights += eco_corner_bases(k);
	double least = refine(f);

	for (;;) {
		head->trends[corners - 3] = (uint8_t)f->trends;
		for (uint8_t t = 0; t < f->trends; t++)
			for (uint32_t k = 2; k < corners; k++)
				prune(f, t, k);
		memcpy(head->trend[corners - 3], f->trend, sizeof f->trend);
		if (f->trends == ECO_TRENDS_MAX)
			break;
		for (uint32_t i = 0; i < f->count; i++)
			if (f->miss[i] > least / f->count)
				f->of[i] = (uint8_t)f->trends;
		f->trends++;
		double bits = refine(f);

		if (share * (bits + f->count) + WEIGHT_COST * weights > share * least)
			break;
		least = bits;
	}
	free(f->views);
	free(f);
}
