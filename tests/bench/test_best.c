/* The planner against everything that could be done instead, in scenes so small that it can be tried.
 *
 * A scene is a random tree of tiles with a few plants, some with cells, seen from a random eye. The search
 * tries every choice of open tiles and of bands whose plants draw their cells. For each, dynamic programming
 * over vertices finds the best amounts of every plant and summary, of all amounts that a ladder can draw, by
 * the planner's own objective. With splats scenes are smaller, some plants have a ladder of splats for the
 * whole plant, and each slot is tried with it and without. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/ladder.h"
#include "lod/plan/allocation.h"
#include "lod/plan/fill_budget.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

#define BUDGET_MOST 600u
#define CHOICES_MOST 24u         /* tiles that may be opened or not,
	slots whose plants may be drawn whole or not */

static struct search {
	struct lod_allocation allocation;
	struct lod_planner planner;
	/* wrong, with at most so many vertices */
	double least[BUDGET_MOST + 1], next[BUDGET_MOST + 1];
	uint64_t budget;
	double *choices[CHOICES_MOST];               /* shares, each 0 or 1 */
	uint32_t choice_count, whole_count;
	/* seen wrong pixels: of the best there is, of nothing drawn */
	double best, empty;
	uint32_t structures;                         /* choices of tiles and gates that were tried */
} s;
static struct eco_error error;

/* ---- Hull points ---- */

static const struct lod_way *way_of(const struct lod_candidate *candidate)
{
	return lod_planner_way(&s.planner, s.allocation.ladder_choices[candidate->ladder_choice].ladder);
}

/* Error of a hull point: a ladder's by its curve, a summary's between those of its hull. */
static double error_at(const struct lod_candidate *candidate, uint64_t vertices)
{
	const struct lod_hull *hull = candidate->hull;
	uint32_t i = 0;
	if (candidate->ladder_choice != ECO_NONE && vertices > hull->points->vertices) {
		struct lod_hull_point point = lod_hull_point_at(way_of(candidate), vertices, hull->size,
			hull->impostor);
		return lod_hull_error(hull, &point);
	}
	while (i + 1 < hull->count && hull->points[i + 1].vertices <= vertices)
		i++;
	const struct lod_hull_point *a = &hull->points[i], *b = i + 1 < hull->count ? a + 1 : a;
	double part = b->vertices > a->vertices
		? (double)(vertices - a->vertices) / (double)(b->vertices - a->vertices) : 0;
	return lod_hull_error(hull, a) + part * (lod_hull_error(hull, b) - lod_hull_error(hull, a));
}

static uint64_t next_point(const struct lod_candidate *candidate, uint64_t vertices)
{
	uint64_t last = candidate->hull->points[candidate->hull->count - 1].vertices, next = vertices + 1;
	if (candidate->ladder_choice != ECO_NONE)
		next = lod_way_next(way_of(candidate), vertices);
	return next > last ? UINT64_MAX : next;
}

/* One more plant, or a summary: at any hull point. */
static void add_one(const struct lod_candidate *candidate)
{
	double weight_px = candidate->seen / (double)candidate->count;
	for (uint64_t v = 0; v <= s.budget; v++)
		s.next[v] = INFINITY;
	for (uint64_t a = candidate->hull->points[0].vertices; a <= s.budget; a = next_point(candidate, a)) {
		double wrong = weight_px * error_at(candidate, a);
		for (uint64_t v = a; v <= s.budget; v++)
			s.next[v] = fmin(s.next[v], s.least[v - a] + wrong);
	}
	memcpy(s.least, s.next, sizeof s.least);
}

/* ---- Structures ---- */

static void try_structure(void)
{
	struct lod_fill fill = { 0 };
	double closed = 0;
	lod_uses_set_each(&s.allocation);
	lod_allocation_fix(&s.allocation);
	assert_ok(lod_fill_make(&fill, &s.allocation, &error), error);
	for (uint32_t n = 0; n < s.planner.visible.node_count; n++) {
		const struct lod_tile_choice *choice = &s.allocation.tile_choices[n];
		if (s.planner.visible.nodes[n].state == LOD_CLOSED)
			closed += choice->weight * choice->weight_px;
	}
	for (uint64_t v = 0; v <= s.budget; v++)
		s.least[v] = closed;
	for (uint32_t i = 0; i < fill.candidate_count; i++)
		for (uint64_t k = 0; k < fill.candidates[i].count; k++)
			add_one(&fill.candidates[i]);
	lod_fill_free(&fill);
	s.structures++;
	s.best = fmin(s.best, s.least[s.budget]);
}

static void try_choices(void)
{
	for (uint32_t bits = 0; bits < 1u << s.choice_count; bits++) {
		for (uint32_t i = 0; i < s.choice_count; i++)
			*s.choices[i] = bits >> i & 1;
		try_structure();
	}
}

/* Gates at every band in which whole plants are, and none. */
static void try_gates(uint32_t plant)
{
	if (plant == s.planner.scene->plant_count) {
		try_choices();
		return;
	}
	s.planner.gates[plant] = 0;
	try_gates(plant + 1);
	for (uint32_t band = 0; band < s.allocation.gates_counted[plant]; band++)
		if (s.allocation.slot_of[plant * (size_t)ECO_BANDS + band]) {
			s.planner.gates[plant] = (band + 1) * ECO_SHARE_ONE;
			try_gates(plant + 1);
		}
}

static void find_best(const struct lod_planner_input *input, uint32_t level)
{
	struct lod_allocation *m = &s.allocation;
	assert_ok(lod_planner_begin(&s.planner, input, &error), error);
	assert_ok(lod_planner_open_level(&s.planner, level, &error), error);
	assert_ok(lod_allocation_make(m, &s.planner, &error), error);
	s.empty = m->tile_choices ? m->tile_choices[0].weight_px : 0;
	for (uint32_t n = 0; n < s.planner.visible.node_count; n++) {
		struct lod_tile_choice *choice = &m->tile_choices[n];
		choice->share = choice->open && !choice->has_summary;
		if (choice->open && choice->has_summary && s.choice_count < CHOICES_MOST)
			s.choices[s.choice_count++] = &choice->share;
	}
	for (uint32_t i = 0; i < s.planner.visible.slot_count; i++) {
		struct lod_slot_choice *choice = &m->slot_choices[i];
		if (!choice->whole_count || !m->counts[i] || s.choice_count == CHOICES_MOST)
			continue;
		choice->whole = choice->ladder_choice_first + choice->ladder_choice_count - 1;
		s.choices[s.choice_count++] = &choice->whole_share;
		s.whole_count++;
	}
	try_gates(0);
	lod_allocation_free(m);
	lod_planner_end(&s.planner);
}

/* ---- Scenes ---- */

static void make_scene(struct scene_builder *r, uint64_t seed, bool splats, struct eco_request *request)
{
	random_scene_sized(r, seed, 0,
		(struct random_sizes){ .species = 2, .leaves = splats ? 1 : 2 + (uint32_t)(seed % 2),
		.elements = 40, .places = splats ? 2 : 4, .cells = 3, .splats = splats });
	for (uint32_t i = 0; i < r->scene.ladder_count; i++)
		if (!(r->ladders[i].flags & ECO_LADDER_NEAR))
			r->plants[r->ladders[i].plant].area += r->ladders[i].area;
	*request = (struct eco_request){
		.view = { .eye = { random_real(r, -40, 90), random_real(r, -90, -20), random_real(r, 2, 50) },
		.target = { random_real(r, 0, 60), random_real(r, 0, 60), random_real(r, 0, 10) },
		.up = { 0, 0, 1 }, .fov_y_deg = random_real(r, 30, 80), .width = 400, .height = 300 },
		.vertices = 1 + random_below(r, BUDGET_MOST), .bytes = ECO_BYTES_UNBOUNDED };
}

/* Fills s; returns the wrong pixels of the plan. */
static double find(uint64_t seed, bool splats)
{
	struct scene_builder scene = { 0 };
	struct eco_request request;
	struct eco_plan plan = { 0 };
	struct lod_planner_stats stats = { 0 };
	make_scene(&scene, seed, splats, &request);
	struct lod_planner_input input = { .scene = &scene.scene, .request = &request, .stats = &stats };
	s = (struct search){ .budget = request.vertices, .best = INFINITY };
	assert_ok(lod_plan(&plan, &input, &error), error);
	eco_plan_free(&plan);
	find_best(&input, stats.level);
	scene_free(&scene);
	return stats.wrong;
}

/* ---- Tests ---- */

#define ROUNDING 1e-9
/* Seeds of scenes where one dear step is worth some cheap ones, or tiles must be looked at with the amounts
 * that they would have. */
static const uint64_t hard[] = { 301, 1191, 2513, 2988, 3450, 3664, 3752, 5435, 5449, 5736 };
#define HARD (sizeof hard / sizeof *hard)

/* Seeds, then bounds of what the plan has more wrong than the best, over what is wrong with nothing drawn;
 * `many`: share of scenes above .5 %. */
static const struct { bool splats; uint32_t seeds, least; double mean, worst, many; } runs[] = {
	{ false, 200, 100, 0.001, 0.05, 1 / 40.0 }, { true, 400, 133, 0.001, 0.1, 1 / 60.0 } };

/* The best is never worse than the plan: else something was not tried. */
UNIT_TEST(plans_are_close_to_the_best_there_is)
{
	for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
		double sum = 0, worst = 0;
		uint32_t count = 0, tried = 0, above = 0;
		for (uint64_t i = 0; i < runs[r].seeds + (runs[r].splats ? 0 : HARD); i++) {
			double plan = find(i < runs[r].seeds ? i + 1 : hard[i - runs[r].seeds],
				runs[r].splats);
			if (!(s.empty > 0) || (runs[r].splats && !s.whole_count))
				continue;
			double over = (plan - s.best) / s.empty;
			assert_true(over >= -ROUNDING && s.best <= s.empty * (1 + ROUNDING));
			sum += over;
			worst = fmax(worst, over);
			above += over > 0.005;
			tried += s.structures;
			count++;
		}
		print_message("          above the best, of what is wrong with nothing drawn: mean %.4f %%, "
			"at most "
			"%.4f %%, above .5 %% in %u of %u\n", 100 * sum / count, 100 * worst, above, count);
		assert_true(count > runs[r].least && tried > 2 * count);
		assert_true(sum / count <= runs[r].mean && worst <= runs[r].worst
			&& above <= runs[r].many * count);
	}
}
