/* Exchanges of steps between candidates: see lod/plan/fill_budget.h. */
#include "lod/plan/fill_budget.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PASSES 4                 /* over all candidates */

/* Releases the last step, or all of them. False where nothing is drawn. */
static bool release_step(struct lod_candidate *candidate, bool all)
{
	uint32_t step = all ? 0 : candidate->step;
	if (candidate->low == candidate->hull->points[0].vertices && candidate->ahead == 0)
		return false;
	if (!all && candidate->ahead == 0 && candidate->low == lod_candidate_point(candidate)->vertices)
		step--;
	lod_candidate_reach(candidate, step);
	return true;
}

/* Adds the next step for all of a candidate's plants, or for one more of them. False at the hull's end. */
static bool add_step(struct lod_fill *fill, struct lod_candidate *candidate, bool all)
{
	if (lod_candidate_ended(candidate))
		return false;
	uint64_t ahead = candidate->ladder_choice != ECO_NONE
		&& candidate->high == lod_candidate_point(candidate)[1].vertices ? candidate->ahead : 0;
	ahead = all || candidate->ladder_choice == ECO_NONE ? candidate->count
		: lod_fill_share_next(fill, candidate, ahead);
	lod_candidate_reach(candidate, candidate->step + (ahead == candidate->count));
	candidate->ahead = ahead == candidate->count ? 0 : ahead;
	return true;
}

struct release { double loss; uint64_t freed; }; /* what releasing a candidate's last step loses and frees;
                                                  * freed 0: it has none */

static struct release release_of(const struct lod_fill *fill, const struct lod_candidate *candidate)
{
	struct lod_candidate after = *candidate;
	if (!release_step(&after, false))
		return (struct release){ 0 };
	return (struct release){ lod_fill_wrong_of(fill, &after) - lod_fill_wrong_of(fill, candidate),
		lod_candidate_vertices(candidate) - lod_candidate_vertices(&after) };
}

/* All candidates but `except` release steps until the budget holds, those first that lose least per vertex
 * needed. False if it cannot hold. */
static bool release_others(struct lod_fill *fill, uint64_t budget, uint32_t except, struct release *releases)
{
	fill->vertices = 0;
	lod_planner_work(fill->allocation->p, LOD_WORK_CHOICE * (uint64_t)fill->candidate_count);
	for (uint32_t i = 0; i < fill->candidate_count; i++) {
		fill->vertices += lod_candidate_vertices(&fill->candidates[i]);
		releases[i] = i == except ? (struct release){ 0 } : release_of(fill, &fill->candidates[i]);
	}
	while (fill->vertices > budget) {
		uint64_t needed = fill->vertices - budget;
		uint32_t best = ECO_NONE;
		double least = INFINITY;
		for (uint32_t i = 0; i < fill->candidate_count; i++) {
			double each = releases[i].freed
				? releases[i].loss / (double)(releases[i].freed < needed ? releases[i].freed
				: needed) : INFINITY;
			if (each < least) {
				least = each;
				best = i;
			}
		}
		lod_planner_work(fill->allocation->p, fill->candidate_count);
		if (best == ECO_NONE)
			return false;
		release_step(&fill->candidates[best], false);
		fill->vertices -= releases[best].freed;
		releases[best] = release_of(fill, &fill->candidates[best]);
	}
	return true;
}

/* The change of one candidate that the others make up for. */
enum swap { RELEASE_STEP, RELEASE_ALL, ADD_ONE, ADD_STEP, SWAP_KINDS };

static bool change(struct lod_fill *fill, uint64_t budget, uint32_t i, enum swap kind,
	struct release *releases)
{
	struct lod_candidate *candidate = &fill->candidates[i];
	if (kind == RELEASE_STEP || kind == RELEASE_ALL)
		return release_step(candidate, kind == RELEASE_ALL);
	return (kind == ADD_STEP || candidate->count > 1) && add_step(fill, candidate, kind == ADD_STEP)
		&& release_others(fill, budget, i, releases);
}

/* Makes the change and keeps it if less is wrong. False without memory. */
static bool try_swap(struct lod_fill *fill, uint64_t budget, uint32_t i, enum swap kind,
	struct lod_candidate *spare, struct release *releases, bool *better)
{
	double before = fill->wrong;
	uint64_t vertices = fill->vertices;
	memcpy(spare, fill->candidates, fill->candidate_count * sizeof *spare);
	if (change(fill, budget, i, kind, releases)) {
		if (!lod_fill_rest(fill, budget, i) || !lod_fill_rest(fill, budget, ECO_NONE))
			return false;
		lod_fill_sum(fill);
		if (fill->wrong < before) {
			*better = true;
			return true;
		}
	}
	memcpy(fill->candidates, spare, fill->candidate_count * sizeof *spare);
	fill->wrong = before;
	fill->vertices = vertices;
	return true;
}

bool lod_swap_steps(struct lod_fill *fill, uint64_t budget)
{
	struct lod_candidate *spare = malloc(((size_t)fill->candidate_count + 1) * sizeof *spare);
	struct release *releases = malloc(((size_t)fill->candidate_count + 1) * sizeof *releases);
	bool good = spare && releases, better = true;
	for (int pass = 0; good && better && pass < PASSES; pass++) {
		better = false;
		for (uint32_t i = 0; good && i < SWAP_KINDS * fill->candidate_count
				&& !lod_planner_over(fill->allocation->p, 2); i++)
			good = try_swap(fill, budget, i / SWAP_KINDS, i % SWAP_KINDS, spare, releases,
				&better);
	}
	free(releases);
	free(spare);
	return good;
}
