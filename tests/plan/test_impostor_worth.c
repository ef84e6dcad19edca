/* Impostors in plans: which levels are worth their bytes, where they are drawn and what they need. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "lod/eye.h"
#include "lod/impostor.h"
#include "lod/plan/impostor_worth.h"
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

UNIT_TEST(larger_plants_have_larger_levels_up_to_a_size)
{
	static const struct { uint32_t levels; double pixels; uint32_t level; } rows[] = {
		{ 3, 0, 0 }, { 3, 1, 0 }, { 3, 16, 0 }, { 3, 16.1, 1 }, { 3, 32, 1 }, { 3, 32.1, 2 },
		{ 3, 64, 2 }, { 3, 65, 2 }, { 3, LOD_IMPOSTOR_PIXELS, 2 },
		{ 3, LOD_IMPOSTOR_PIXELS + 0.1, ECO_NONE }, { 3, 1e9, ECO_NONE },
		{ 2, 16, 0 }, { 2, 17, 1 }, { 2, LOD_IMPOSTOR_PIXELS, 1 }, { 2, 193, ECO_NONE },
		{ 1, 1, 0 }, { 1, LOD_IMPOSTOR_PIXELS, 0 }, { 1, 193, ECO_NONE },
		{ 0, 1, ECO_NONE }, { 0, 193, ECO_NONE },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		assert_int_equal(level_of(rows[i].levels, rows[i].pixels), rows[i].level);
}

/* The largest plants first, the others as it becomes worth more. */
UNIT_TEST(a_level_begins_little_by_little)
{
	assert_true(lod_impostor_from(0, 0) == 0 && lod_impostor_from(0, 3) == 0);
	for (uint32_t level = 1; level < ECO_IMPOSTOR_LEVELS; level++) {
		assert_true(lod_impostor_from(level, 0.999) == INFINITY);
		assert_true(lod_impostor_from(level, NAN) == INFINITY);
		assert_true(lod_impostor_from(level, 1) == LOD_IMPOSTOR_PIXELS);
		assert_true(lod_impostor_from(level, 2) == eco_impostor_sizes[level - 1].texels);
		for (double times = 1; times < 3; times += 0.01)
			assert_in_range(1000 * (lod_impostor_from(level, times)
				- lod_impostor_from(level, times + 0.01)), 0, 2000);
	}
}

/* ---- Levels by bytes ---- */

/* The levels of all plants for a request, and of each plant the pixels seen of it. */
struct chosen { uint8_t levels[PLANTS_MAX]; double seen[PLANTS_MAX]; };

static double across_px(const struct lod_eye *eye, uint32_t anchor, uint8_t band)
{
	return 2 * (double)scene.anchors[anchor].radius / (lod_band_distance_m(band) * eye->pixel_rad);
}

/* After an impostor come splats only where their Q is higher, and no splats are much worse than fewer. */
static void check_whole_hull(const struct lod_hull *hull)
{
	double best = -INFINITY;
	for (uint32_t i = 0; i < hull->count; i++) {
		double q = lod_hull_own_q(&hull->points[i]);
		bool impostor = hull->points[i].vertices == 1 && hull->impostor != ECO_NONE;
		assert_true(q >= best);
		best = fmax(best, impostor ? q + LOD_HULL_Q_MORE : q - LOD_HULL_Q_FALL);
	}
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
	}
}

static struct chosen choose(const struct eco_request *request)
{
	struct lod_planner_input input = { .scene = &scene.scene, .request = request };
	struct lod_planner p;
	struct lod_allocation m;
	struct chosen chosen = { .levels = { 0 } };
	struct eco_error error = { 0 };
	assert_ok(lod_planner_begin(&p, &input, &error), error);
	assert_ok(lod_planner_open_level(&p, 4, &error), error);
	assert_ok(lod_allocation_make(&m, &p, &error), error);
	assert_true(scene.scene.plant_count <= PLANTS_MAX);
	for (uint32_t i = 0; i < scene.scene.plant_count; i++)
		chosen.levels[i] = (uint8_t)m.impostors[i].levels;
	memcpy(chosen.seen, m.plant_seen, scene.scene.plant_count * sizeof *m.plant_seen);
	check_slots(&m);
	lod_allocation_free(&m);
	lod_planner_end(&p);
	return chosen;
}

static const struct eco_ladder *ladder_of(uint32_t plant)
{
	const struct eco_plant *p = &scene.plants[plant];
	for (uint32_t i = p->ladder_first; i < p->ladder_first + p->ladder_count; i++)
		if (scene.ladders[i].impostor != ECO_NONE)
			return &scene.ladders[i];
	return NULL;
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

static uint32_t levels_worth(const struct eco_ladder *l, double seen, uint32_t bytes)
{
	uint32_t level = 1;
	for (; level < scene.lists[l->impostor].primitive_count; level++) {
		const struct eco_curve *at = &scene.curves[l->curve_first + level], *before = at - 1;
		double wrong = (double)at->fp + (double)at->fn,
			more = (double)before->fp + (double)before->fn;
		if (seen * (more - wrong) < lod_impostor_worth_least(level) * bytes)
			break;
	}
	return level;
}

/* The first is always used, and the only one where levels are dear. */
UNIT_TEST(a_level_is_used_if_it_sets_enough_pixels_right)
{
	static const uint32_t bytes[] = { 1, 300, 1000, 3000, 100000, ECO_CHUNK_BYTES_MAX };
	uint32_t used[ECO_IMPOSTOR_LEVELS + 1] = { 0 }, fell = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct eco_request request = request_of(seed, 10000);
		uint8_t before[PLANTS_MAX];
		memset(before, 255, sizeof before);
		for (size_t k = 0; k < sizeof bytes / sizeof *bytes; k++) {
			set_bytes(bytes[k]);
			struct chosen chosen = choose(&request);
			for (uint32_t i = 0; i < scene.scene.plant_count; i++) {
				const struct eco_ladder *l = ladder_of(i);
				uint32_t level = l ? levels_worth(l, chosen.seen[i], bytes[k]) : 0;
				assert_int_equal(chosen.levels[i], level);
				assert_true(level <= before[i]);
				assert_true(bytes[k] < ECO_CHUNK_BYTES_MAX || level <= 1);
				fell += level < before[i] && k;
				before[i] = (uint8_t)level;
				used[level]++;
			}
		}
	}
	assert_true(fell > 0);
	for (uint32_t level = 0; level <= ECO_IMPOSTOR_LEVELS; level++)
		assert_true(used[level] > 0);
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
		struct lod_planner_input input = { .scene = &scene.scene, .request = &request };
		struct eco_plan plan;
		struct eco_holdings needs;
		struct eco_error error = { 0 };
		set_bytes(seed % 2 ? 300 : 1);
		assert_ok(lod_plan(&plan, &input, &error), error);
		assert_ok(lod_plan_needs(&scene.scene, &plan, &needs, &error), error);
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
		struct lod_planner_input input = { .scene = &scene.scene, .request = &request };
		struct eco_plan plan;
		struct eco_error error = { 0 };
		request.view.fov_y_deg = 0.5;
		request.view.width = request.view.height = 16384;
		assert_ok(lod_plan(&plan, &input, &error), error);
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

int main(void)
{
	return unit_tests_run(NULL, clean_up);
}
