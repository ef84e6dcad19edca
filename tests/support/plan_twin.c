#include "tests/support/plan_twin.h"

#include "lod/eye.h"
#include "tests/support/unit_test.h"

#define ANCHORS_MOST 64

static uint32_t gate_of(const struct eco_plan *plan, uint32_t plant)
{
	for (uint32_t i = 0; i < plan->gate_count; i++)
		if (plan->gates[i].plant == plant)
			return plan->gates[i].end;
	return 0;
}

struct twin {
	const struct eco_scene *scene;
	const struct eco_plan *plan;
	struct lod_eye eye;
	plan_twin_seen *seen;
	void *ctx;
	uint64_t plants;
};

static uint64_t anchor_vertices(const struct twin *t, const struct lod_anchor_band *at, uint32_t hash,
	uint64_t place)
{
	uint64_t vertices = 0;
	for (uint32_t c = 0; c < t->plan->cut_count; c++) {
		const struct eco_cut *cut = &t->plan->cuts[c];
		if (cut->anchor != at->anchor || at->band < cut->band_first || at->band >= cut->band_end
				|| hash < cut->share_first || hash >= cut->share_end)
			continue;
		vertices += eco_cut_vertices(cut, &t->scene->lists[cut->list]);
		if (t->seen)
			t->seen(t->ctx, place, cut);
	}
	return vertices;
}

/* All plants of one group in one placement. */
static uint64_t group_vertices(struct twin *t, const struct eco_run *run, const struct eco_group *group)
{
	const struct eco_scene *scene = t->scene;
	const struct eco_placement *placement = &t->plan->placements[run->placement];
	const struct eco_plant *plant = &scene->plants[group->plant];
	uint32_t gate = gate_of(t->plan, group->plant);
	uint64_t vertices = 0;
	for (uint32_t i = 0; i < group->count; i++) {
		struct eco_place stored = eco_place_read(scene, group->place_first + i);
		struct lod_anchor_band seen[ANCHORS_MOST];
		struct lod_place place;
		uint32_t hash = lod_share_hash(placement->path, group->list, group->first + i);
		lod_place_instance(&place, placement, &scene->lists[group->list], &stored);
		uint32_t count = lod_instance_anchors(&t->eye, &place, scene->anchors + plant->anchor_first,
			plant->anchor_first, plant->anchor_count, gate, hash, seen);
		if (count && t->seen)
			t->seen(t->ctx, group->place_first + i, NULL);
		if (lod_open_hash(hash) < run->left)
			continue;
		t->plants += count != 0;
		for (uint32_t a = 0; a < count; a++)
			vertices += anchor_vertices(t, &seen[a], hash, group->place_first + i);
	}
	return vertices;
}

uint64_t plan_twin_draw(const struct eco_scene *scene, const struct eco_plan *plan,
	const struct eco_view *view, uint64_t *plants, plan_twin_seen *seen, void *ctx)
{
	struct twin t = { .scene = scene, .plan = plan, .seen = seen, .ctx = ctx };
	uint64_t vertices = 0;
	lod_eye_make(&t.eye, view);
	for (uint32_t c = 0; c < plan->cut_count; c++)
		if (plan->cuts[c].anchor == ECO_NONE)
			vertices += eco_cut_vertices(&plan->cuts[c], &scene->lists[plan->cuts[c].list]);
	for (uint32_t r = 0; r < plan->run_count; r++)
		for (uint32_t g = 0; g < scene->group_count; g++)
			if (plan->runs[r].list_first <= scene->groups[g].list && scene->groups[g].list
					< plan->runs[r].list_end)
				vertices += group_vertices(&t, &plan->runs[r], &scene->groups[g]);
	if (plants)
		*plants = t.plants;
	return vertices;
}

uint64_t plan_twin_vertices(const struct eco_scene *scene, const struct eco_plan *plan,
	const struct eco_view *view, uint64_t *plants)
{
	return plan_twin_draw(scene, plan, view, plants, NULL, NULL);
}

struct lod_planner_stats plan_make(struct eco_plan *plan, struct lod_planner_input input)
{
	struct lod_planner_stats stats = { 0 };
	input.stats = &stats;
	assert_good(lod_plan(plan, &input, &cause));
	return stats;
}
