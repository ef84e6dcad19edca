/* Answers within bytes: a price at which the answer has no more than may be sent; and answers at higher prices,
 * coarser ones on the way to it. */
#include "lod/plan/allocation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/byte_price.h"

enum eco_code lod_bytes_size(struct lod_planner *p, struct eco_error *error)
{
	struct eco_plan plan = { 0 };
	enum eco_code code = lod_planner_emit(p, NULL, &plan, error);
	p->sized++;
	lod_planner_work(p, LOD_WORK_CHOICE * (uint64_t)p->entry_count);
	if (!code)
		code = lod_plan_size(p, &plan, error);
	eco_plan_free(&plan);
	return code;
}

struct fitted {
	double size, lambda, octave; /* size: bytes; octave: of the price, not a number before the first answer */
	struct lod_mix mix;
	bool first;                  /* tells what is beside: kinds share bytes in the next answer */
	double wrong;                /* pixels that it leaves */
	double beside;               /* bytes of the answer beside those that are priced */
};

/* Kinds share what a price leaves. */
static double relax_and_share(struct lod_allocation *m, struct fitted *fit, double target)
{
	fit->mix.used = false;
	double bytes = lod_price_relax(m, fit->lambda, fit->octave, NULL);
	if (lod_planner_spent(m->p) || (fit->first && !lod_planner_over(m->p, 4)))
		return bytes;
	return lod_kinds_share(m, fit->lambda, target, fit->octave, &fit->mix);
}

/* Relaxes within the vertices too: mostly at the lowest lambda, as bytes alone bind; else at the lambda, of
 * some between that and the one that uses the vertices alone, that leaves least wrong. Returns the bytes. */
static double find_prices(const struct lod_lambda_search *s, double target, uint64_t budget,
	struct fitted *fit)
{
	struct lod_allocation *m = s->allocation;
	double low = LOD_LAMBDA_LEAST, high = s->index == LOD_LAMBDA_COUNT ? low
		: fmax(low, lod_lambda_at(s->index));
	const bool again = !isnan(fit->octave);
	double least = INFINITY, used = 1;
	fit->lambda = again ? fit->lambda : low;
	lod_price_find(m, fit->lambda, target, fit->octave, &fit->octave);
	const bool both = !again && m->cost.vertices > (double)budget;
	double near = fit->octave;
	/* a lambda with more vertices, about as many times as the budget has */
	for (int i = 0; both && i <= LOD_PRICE_LAMBDAS && !(i && used >= (double)budget)
			&& !(i > 1 && lod_planner_over(m->p, 3)); i++) {
		double lambda = i ? fmax(low, fit->lambda * used / (double)budget) : high;
		lod_price_find(m, lambda, target, near, &near);
		if (i && (m->cost.vertices > (double)budget || lod_price_wrong(m) >= least))
			break;
		least = lod_price_wrong(m);
		used = fmax(1, m->cost.vertices);
		fit->lambda = lambda;
		fit->octave = near;
	}
	double bytes = relax_and_share(m, fit, target);
	/* where more bytes come, a vertex may have to save more */
	if (m->cost.vertices <= (double)budget)
		return bytes;
	fit->lambda = high;
	lod_price_find(m, high, target, fit->octave, &fit->octave);
	return relax_and_share(m, fit, target);
}

static enum eco_code fill_fitted(const struct lod_lambda_search *s, const struct fitted *fit, uint64_t budget,
	struct eco_error *error)
{
	lod_price_relax(s->allocation, fit->lambda, fit->octave, &fit->mix);
	enum eco_code code = lod_search_fill(s, fit->lambda, budget, error);
	return code ? code : lod_bytes_size(s->allocation->p, error);
}

/* Records and the plan itself, which are not priced, are learnt from the answers tried. */
static enum eco_code fit_prices(const struct lod_lambda_search *s, uint64_t budget, struct fitted *now,
	struct fitted *best, struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	struct lod_planner *p = m->p;
	enum eco_code code = ECO_OK;
	double most = (double)p->input->request->bytes;
	bool last = false;               /* the allocation is that of the best answer */
	for (int i = 0; i < LOD_SIZE_TRIES && !code; i++) {
		now->first = i == 0;
		double before = now->size, bytes = find_prices(s, most - now->beside, budget, now);
		code = fill_fitted(s, now, budget, error);
		now->size = (double)p->bytes;
		now->wrong = p->wrong;
		bool fits = now->size <= most, fitted = best->size <= most;
		last = !code && (fits && fitted ? now->wrong < best->wrong : now->size < best->size);
		if (last) {
			const struct lod_mix spare = best->mix;
			*best = *now;
			now->mix = spare;
		}
		if ((now->size == before && fits) || (now->size <= most && now->size >= most * (1 - LOD_PRICE_SLACK))
				|| (best->size <= most && lod_planner_over(p, 4)
				&& !(now->size > most && now->size < most * (1 + LOD_PRICE_SLACK)))
				|| (i > 0 && lod_planner_spent(p)))
			break;
		now->beside = now->size - bytes;
	}
	if (!code && !last)
		code = fill_fitted(s, best, budget, error);
	return code;
}

static enum eco_code fit_bytes(const struct lod_lambda_search *s, uint64_t budget, struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	enum eco_code code = lod_prices_make(m, NULL, 0, error);
	if (code)
		return code;
	size_t ladders = m->prices->ladder_count, plants = m->p->scene->plant_count;
	struct lod_arena a = { 0 };
	uint32_t *limits = lod_arena_try(&a, 2 * ladders, sizeof *limits);
	bool *off = lod_arena_try(&a, 2 * plants, 1);
	uint8_t *levels = lod_arena_try(&a, 2 * plants, 1);
	struct fitted now = { .lambda = LOD_LAMBDA_LEAST, .octave = NAN, .mix = { limits, off, levels, false } };
	struct fitted best = now;
	best.mix.limits += ladders;
	best.mix.off += plants;
	best.mix.levels += plants;
	best.size = INFINITY;
	best.octave = LOD_PRICE_HIGHEST;
	code = !a.failed ? fit_prices(s, budget, &now, &best, error)
		: eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %zu ladders", ladders);
	lod_arena_free(&a);
	return code;
}

static enum eco_code find_wanted(const struct lod_planner *p, struct eco_holdings *wanted, struct eco_error *error)
{
	struct eco_plan plan = { 0 };
	free(wanted->items);
	*wanted = (struct eco_holdings){ 0 };
	enum eco_code code = lod_planner_emit(p, NULL, &plan, error);
	code = code ? code : lod_plan_needs(p->scene, &plan, wanted, error);
	eco_plan_free(&plan);
	return code;
}

/* Without a price, so many vertices at most. */
static enum eco_code fill_few(struct lod_lambda_search *s, uint64_t vertices, struct eco_error *error)
{
	enum eco_code code = lod_search_grid(s, vertices, error);
	code = code ? code : lod_search_fill(s, lod_lambda_at(s->index), vertices, error);
	return code ? code : lod_bytes_size(s->allocation->p, error);
}

/* Between two prices an answer may fall from too many bytes to nothing, and no price that was tried may fit. Fewer
 * vertices without a price draw something then, as many as fit. Textures and the image of the ground are as at the
 * highest price. An empty answer that fits keeps the image that it has. */
static enum eco_code fit_few(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	struct lod_planner *p = m->p;
	const double image_price = p->image_price;
	const bool fits = p->bytes <= p->input->request->bytes;
	uint64_t few = 0, many = budget;
	enum eco_code code = ECO_OK;
	lod_price_relax(m, lod_lambda_at(0), LOD_PRICE_HIGHEST, NULL);
	p->price = m->price;
	lod_prices_lift(m);
	m->price = 0;
	for (uint64_t middle; !code
			&& (middle = few + (many - few) / (few ? 2 : LOD_FEW_FALL)) > few + few / LOD_FEW_SLACK;) {
		code = fill_few(s, middle, error);
		*(p->bytes <= p->input->request->bytes ? &few : &many) = middle;
	}
	code = !code && few ? fill_few(s, few, error) : code;
	if (code || (few && p->vertices))
		return code;
	lod_price_relax(m, lod_lambda_at(0), LOD_PRICE_HIGHEST, NULL);
	p->image_price = fits ? image_price : p->image_price;
	code = lod_search_fill(s, lod_lambda_at(0), budget, error);
	return code ? code : lod_bytes_size(p, error);
}

static void bound_work(struct lod_planner *p)
{
	uint64_t most = LOD_BYTES_WORK * p->work;
	if (!p->work_most || most < p->work_most)
		p->work_most = most;
}

enum eco_code lod_bytes_fit(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	struct lod_planner *p = m->p;
	bound_work(p);
	enum eco_code code = p->input->wanted ? find_wanted(p, p->input->wanted, error) : ECO_OK;
	if (!code)
		code = fit_bytes(s, budget, error);
	p->price = m->price;
	m->limited = false;
	if (!code && budget && (!p->vertices || p->bytes > p->input->request->bytes))
		code = fit_few(s, budget, error);
	return code;
}

/* ---- Coarser answers ---- */

/* *missing: payloads of the answer before. */
static enum eco_code hand_over(const struct lod_lambda_search *s, double lambda, uint64_t budget, uint64_t *missing,
	struct eco_error *error)
{
	struct lod_planner *p = s->allocation->p;
	struct lod_planner_coarser *coarser = p->input->coarser;
	enum eco_code code = lod_search_fill(s, lambda, budget, error);
	if (!code && !p->vertices)       /* what fits in the mean may not fit */
		return ECO_OK;
	struct eco_plan *plan = &coarser->plans[coarser->count];
	uint64_t now = 0;
	*plan = (struct eco_plan){ 0 };
	if (!code)
		code = lod_planner_emit(p, NULL, plan, error);
	if (!code)
		code = lod_plan_coarsen_ground(p, plan, &now, error);
	if (code || now >= *missing) {
		eco_plan_free(plan);
		return code;
	}
	*missing = now;
	coarser->count++;
	return ECO_OK;
}

/* From the answer's price upwards: an answer comes where so many bytes fewer are left, mostly as far as the last
 * one came. If a price leaves hardly fewer the next one is twice as far. One that leaves far fewer is a bound, and
 * the way to it is halved. */
static enum eco_code sweep_prices(const struct lod_lambda_search *s, uint64_t budget, uint64_t missing,
	struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	const struct lod_planner_coarser *coarser = m->p->input->coarser;
	const double price = m->p->price, lambda = fmax(s->lambda, LOD_LAMBDA_LEAST);
	double octave = price > 0 ? fmax(LOD_PRICE_LOW, 2 * lod_octaves(price)) : LOD_PRICE_LOWEST,
		before = lod_price_relax(m, lambda, octave, NULL), step = LOD_SWEEP_STEP,
		bound = INFINITY, left = 0;      /* bytes at the bound */
	double last = octave = fmax(octave, LOD_PRICE_LOW);
	enum eco_code code = ECO_OK;
	while (!code && coarser->count < coarser->most && missing > coarser->least
			&& before > (double)(coarser->least / 2) && octave < LOD_PRICE_HIGHEST) {
		const bool late = !(price > 0) && lod_planner_over(m->p, 3);
		const double ratio = late ? LOD_SWEEP_LATE_RATIO : coarser->ratio, steep = ratio * ratio,
			least = late ? LOD_SWEEP_STEP_MOST / 2 : LOD_SWEEP_STEP;
		if (left * ratio > before) {
			octave = bound;
			bound = INFINITY;
			left = 0;
		}
		double next = bound < INFINITY ? bound : octave + fmax(step, least);
		if (bound < INFINITY && left * steep < before && bound - octave > least)
			next = (octave + bound) / 2;
		double bytes = lod_price_relax(m, lambda, next, NULL);
		if (next >= bound) {
			left = bytes;
		} else if (bytes * steep < before && next - octave > least) {
			bound = next;
			left = bytes;
			continue;
		}
		octave = next;
		if (bytes * ratio > before) {
			step = fmin(2 * fmax(step, least), LOD_SWEEP_STEP_MOST);
		} else if (bytes > 0) {
			code = hand_over(s, lambda, budget, &missing, error);
			before = bytes;
			step = fmin(octave - last, LOD_SWEEP_STEP_MOST);
			last = octave;
		} else {
			break;
		}
	}
	return code;
}

enum eco_code lod_bytes_coarser(const struct lod_lambda_search *s, const struct eco_plan *answer,
	struct eco_error *error)
{
	struct eco_holdings kept;
	struct lod_planner *p = s->allocation->p;
	enum eco_code code = lod_plan_needs(p->scene, answer, &kept, error);
	if (!code)
		code = lod_prices_make(s->allocation, &kept, LOD_TIMES_COARSER, error);
	if (!code)
		code = sweep_prices(s, p->input->request->vertices,
			lod_plan_missing(p->scene, p->input->holdings, &kept, NULL), error);
	free(kept.items);
	return code;
}
