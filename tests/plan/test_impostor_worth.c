/* Impostors in plans: which levels are worth their bytes, where they are drawn and what they need. */
#include <math.h>
#include <stdlib.h>

#include "lod/eye.h"
#include "lod/impostor.h"
#include "lod/plan/texture_levels.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

#define SCENES 30u
#define PLANTS_MAX 64u

static struct scene_builder scene;

/* All of a scene that is 100 m wide, from 80 m or further. */
static struct eco_request request_of(uint64_t seed, uint64_t vertices)
{
	double far = 80 << seed % 4;
	random_scene_splats(&scene, seed, seed % 3 ? 0 : 4);
	return (struct eco_request){ .view = { .eye = { 50 - far, 50, far / 3 }, .target = { 50, 50, 5 },
		.up = { 0, 0, 1 }, .fov_y_deg = 50, .width = 800, .height = 600 }, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED };
}

/* ---- Levels by pixels ---- */

/* Levels are worth their bytes many times. */
static uint32_t level_of(uint32_t levels, double pixels)
{
	uint32_t level = 0;
	if (!levels || pixels > LOD_IMPOSTOR_PIXELS)
		return ECO_NONE;
	while (level + 1 < levels && lod_impostor_from(level + 1, 100) < pixels)
		level++;
	return level;
}

/* ---- Levels by bytes ---- */

/* Levels of all plants for a request. */
struct chosen { uint8_t levels[PLANTS_MAX]; };

static double across_px(const struct lod_eye *eye, uint32_t anchor, uint8_t band)
{
	return 2 * (double)scene.anchors[anchor].radius / (lod_band_distance_m(band) * eye->pixel_rad);
}

/* More vertices are better, also after an impostor. */
static void check_whole_hull(const struct lod_hull *hull)
{
	for (uint32_t i = 1; i < hull->count; i++)
		assert_true(lod_hull_error(hull, &hull->points[i]) <= lod_hull_error(hull, &hull->points[i - 1]));
}

static void check_slots(const struct lod_allocation *m)
{
	for (uint32_t c = 0; c < m->ladder_choice_count; c++) {
		const struct lod_ladder_choice *choice = &m->ladder_choices[c];
		const struct lod_slot *slot = &m->p->visible.slots[choice->slot];
		uint32_t list = scene.ladders[choice->ladder].impostor;
		if (choice->when != LOD_WHOLE)
			continue;
		check_whole_hull(&choice->hull);
		const struct lod_impostor_use *use = &m->impostors[slot->plant];
		double pixels = across_px(&m->p->visible.eye, slot->anchor, slot->band);
		uint32_t levels = list == ECO_NONE ? 0 : scene.lists[list].primitive_count,
			level = choice->hull.impostor;
		assert_true(!levels || (use->levels >= 1 && use->levels <= levels));
		assert_int_equal(level == ECO_NONE, !levels || pixels > LOD_IMPOSTOR_PIXELS);
		if (level == ECO_NONE)
			continue;
		assert_true(level < use->levels && level <= level_of(levels, pixels));
		assert_true(!level || pixels > use->from_px[level]);
		assert_true(level + 1 == use->levels || pixels <= use->from_px[level + 1]);
		const struct lod_way *way = lod_planner_way(m->p, choice->ladder);
		struct lod_hull_point one = lod_hull_point_at(way, 1, 0, level);
		struct eco_curve curve = lod_ladder_curve(&scene.scene, way->ladder, (level + 1.0) / levels / (double)way->full);
		double says = lod_seen_worth(&curve.seen, 0);
		assert_true(says > 0 && fabs(one.alike + one.open - LOD_IMPOSTOR_WRONG * says) <= 1e-5 * says);
	}
}

static struct chosen choose(const struct eco_request *request)
{
	struct lod_planner_input input = { .scene = &scene.scene, .request = request };
	struct lod_planner p;
	struct lod_allocation m;
	struct chosen chosen = { .levels = { 0 } };
	assert_good(lod_planner_begin(&p, &input, &cause));
	assert_good(lod_planner_open_level(&p, 4, &cause));
	assert_good(lod_allocation_make(&m, &p, &cause));
	assert_true(scene.scene.plant_count <= PLANTS_MAX);
	for (uint32_t i = 0; i < scene.scene.plant_count; i++)
		chosen.levels[i] = (uint8_t)m.impostors[i].levels;
	check_slots(&m);
	lod_allocation_free(&m);
	lod_planner_end(&p);
	return chosen;
}

/* All levels of all impostors take so many bytes. */
static void set_bytes(uint32_t bytes)
{
	for (uint32_t i = 0; i < scene.scene.list_count; i++)
		for (uint32_t c = 0; c < scene.lists[i].chunk_count
				&& scene.lists[i].kind == ECO_LIST_IMPOSTOR; c++)
			scene.chunks[scene.lists[i].chunk_first + c].size_bytes = bytes;
}

UNIT_TEST(levels_do_not_fall_as_the_budget_grows)
{
	uint32_t several = 0;
	assert_true(lod_impostor_from(1, 0.999) == INFINITY && lod_impostor_from(1, 1) == LOD_IMPOSTOR_PIXELS);
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct chosen last = { .levels = { 0 } };
		struct eco_request request = request_of(seed, 0);
		for (request.vertices = 1; request.vertices < 1 << 24; request.vertices *= 8) {
			struct chosen chosen = choose(&request);
			for (uint32_t i = 0; i < scene.scene.plant_count; i++) {
				assert_true(chosen.levels[i] >= last.levels[i]);
				several += chosen.levels[i] > 1;
			}
			last = chosen;
		}
	}
	assert_true(several > 0);
}

/* ---- In plans ---- */

/* The levels of a list that its largest cut needs. */
static uint32_t prefix_of(const struct eco_plan *plan, uint32_t list)
{
	uint32_t end = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (plan->cuts[i].list == list && plan->cuts[i].end > end)
			end = plan->cuts[i].end;
	return end;
}

static uint32_t check_cut(const struct eco_plan *plan, const struct eco_request *request, uint32_t cut_id)
{
	const struct eco_cut *cut = &plan->cuts[cut_id];
	const struct eco_list *list = &scene.lists[cut->list];
	struct lod_eye eye;
	if (list->kind != ECO_LIST_IMPOSTOR)
		return 0;
	lod_eye_make(&eye, &request->view);
	double largest = across_px(&eye, cut->anchor, cut->band_first),
		smallest = across_px(&eye, cut->anchor, (uint8_t)(cut->band_end - 1));
	assert_true(cut->end == cut->first + 1 && cut->end <= list->primitive_count && cut->scale == 1);
	assert_true(largest <= LOD_IMPOSTOR_PIXELS);
	assert_true(cut->first <= level_of(list->primitive_count, smallest));
	return 1;
}

UNIT_TEST(plans_draw_impostors_of_small_plants_and_need_a_prefix)
{
	uint32_t drawn = 0, later = 0;
	for (uint64_t seed = 1; seed <= 3 * SCENES; seed++) {
		struct eco_request request = request_of(100 + seed, 20 << seed % 12);
		struct eco_plan plan;
		struct eco_holdings needs;
		set_bytes(seed % 2 ? 300 : 1);
		plan_make(&plan, (struct lod_planner_input){ .scene = &scene.scene, .request = &request });
		assert_good(lod_plan_needs(&scene.scene, &plan, &needs, &cause));
		for (uint32_t i = 0; i < plan.cut_count; i++) {
			drawn += check_cut(&plan, &request, i);
			later += scene.lists[plan.cuts[i].list].kind == ECO_LIST_IMPOSTOR
				&& plan.cuts[i].first;
		}
		for (uint32_t id = 0; id < scene.scene.list_count; id++)
			if (scene.lists[id].kind == ECO_LIST_IMPOSTOR)
				assert_int_equal(eco_holdings_chunks(&needs, id), prefix_of(&plan, id));
		free(needs.items);
		eco_plan_free(&plan);
	}
	print_message("%u cuts draw impostors, %u of them a level after the first\n", drawn, later);
	assert_true(drawn > 50 && later > 10);
}

/* With a lens so long that every plant is larger than impostors may be. */
UNIT_TEST(large_plants_are_no_impostors)
{
	uint64_t vertices = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct eco_request request = request_of(seed, 500);
		struct eco_plan plan;
		request.view.fov_y_deg = 0.5;
		request.view.width = request.view.height = 16384;
		plan_make(&plan, (struct lod_planner_input){ .scene = &scene.scene, .request = &request });
		vertices += plan.vertices;
		for (uint32_t i = 0; i < plan.cut_count; i++)
			assert_true(scene.lists[plan.cuts[i].list].kind != ECO_LIST_IMPOSTOR);
		eco_plan_free(&plan);
	}
	assert_true(vertices > 0);
}

static int clean_up(void **state)
{
	scene_free(&scene);
	return 0;
}

UNIT_MAIN(NULL, clean_up)
