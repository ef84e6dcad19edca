/* Ladders: every amount can be drawn to the primitive, amounts ascend, and nothing that is drawn is lost on
 * the way. */
#include <string.h>

#include "lod/ladder.h"
#include "lod/eye.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

static struct scene_builder scene;

static const struct lod_way *way_of(const struct eco_ladder *ladder)
{
	static struct lod_way way;
	lod_way_begin(&way, &scene.scene, ladder);
	return &way;
}

static uint64_t drawn(const struct eco_cut *cuts, uint32_t count)
{
	uint64_t total = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint8_t kind = scene.lists[cuts[i].list].kind;
		total += (uint64_t)(cuts[i].end - cuts[i].first) * (kind == ECO_LIST_TRIANGLES ? 3
			: kind == ECO_LIST_LINES ? 2 : 1);
	}
	return total;
}

UNIT_TEST(every_step_draws_what_it_says)
{
	for (uint64_t seed = 1; seed < 80; seed++) {
		(seed < 40 ? random_scene_make : random_scene_splats)(&scene, seed, 0);
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			const struct eco_ladder *ladder = &scene.ladders[l];
			uint64_t v = 0, full = way_of(ladder)->full, steps = 0;
			assert_int_equal(lod_way_floor(way_of(ladder), 0), 0);
			while (v != full) {
				uint64_t next = lod_way_next(way_of(ladder), v);
				struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
				assert_true(next > v && next <= full);
				assert_int_equal(lod_way_floor(way_of(ladder), next), next);
				assert_int_equal(lod_way_floor(way_of(ladder), next - 1), v);
				uint32_t n = lod_way_cuts(way_of(ladder), next, 0.5, 0, cuts);
				assert_int_equal(drawn(cuts, n), next);
				v = next;
				assert_true(++steps < 100000);
			}
			assert_true(lod_way_next(way_of(ladder), full) == UINT64_MAX);
			assert_int_equal(lod_way_floor(way_of(ladder), UINT64_MAX), full);
		}
	}
}

static void set_curve(struct eco_ladder *ladder, const struct eco_curve *samples, uint32_t count)
{
	memcpy(scene.curves, samples, count * sizeof *samples);
	ladder->curve_count = count;
}

/* `k` elements of `each` triangles, and points of them. */
static struct eco_ladder points_and_fans(uint32_t k, uint32_t each)
{
	random_scene_make(&scene, 3, 0);
	uint32_t triangles = random_fans(&scene, k, 0);
	struct eco_list *fans = &scene.lists[triangles];
	for (uint32_t c = 0; c < fans->chunk_count; c++)
		scene.chunks[fans->chunk_first + c].primitive_count =
			each * scene.chunks[fans->chunk_first + c].element_count;
	fans->primitive_count = each * k;
	return (struct eco_ladder){ .organ = ECO_ORGAN_FOLIAGE, .lines = ECO_NONE, .simple = ECO_NONE,
		.impostor = ECO_NONE,
		.triangles = triangles, .total = k,
		.points = random_form(&scene, ECO_LIST_POINTS, triangles, 1) };
}

/* The level that a splat belongs to. */
static uint32_t level_of(const struct eco_ladder *ladder, uint32_t splat)
{
	uint32_t level = 0;
	while (ladder->level_end[level] <= splat)
		level++;
	return level;
}

/* Fineness in which splat `i` of the first level is drawn: the level of each of its descendants, summed over
 * those of the last level; levels count from 1, and nothing drawn counts 0. */
static uint64_t fineness(const struct eco_ladder *ladder, const struct eco_cut *cuts, uint32_t count,
	uint32_t i)
{
	uint32_t roots = ladder->level_end[0], last = ladder->level_count - 1;
	uint32_t all = (ladder->level_end[last] - (last ? ladder->level_end[last - 1] : 0)) / roots;
	uint64_t sum = 0;
	for (uint32_t c = 0; c < count; c++)
		for (uint32_t splat = cuts[c].first; splat < cuts[c].end; splat++) {
			uint32_t level = level_of(ladder, splat), first = level ? ladder->level_end[level - 1]
				: 0, each = (ladder->level_end[level] - first) / roots;
			if ((splat - first) / each == i)
				sum += (level + 1ull) * (all / each);
		}
	return sum;
}

/* Splats give way to their children from the front: a larger number of vertices draws no splat coarser, no
 * splat beside its children, and everything from the first level's end on. */
UNIT_TEST(splats_give_way_to_their_children)
{
	uint32_t tried = 0;
	for (uint64_t seed = 1; seed < 60; seed++) {
		random_scene_splats(&scene, seed, 0);
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			const struct eco_ladder *ladder = &scene.ladders[l];
			if (!(ladder->flags & ECO_LADDER_WHOLE))
				continue;
			uint32_t roots = ladder->level_end[0], last = ladder->level_count - 1, each =
				(ladder->level_end[last] - (last ? ladder->level_end[last - 1] : 0)) / roots;
			uint64_t had[64] = { 0 }, before = 0;
			assert_true(roots <= 64);
			for (uint64_t v = lod_way_next(way_of(ladder), 0); v <= lod_way_stage_end(way_of(ladder));
					before = v, v = lod_way_next(way_of(ladder), v), tried++) {
				struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
				uint32_t count = lod_way_cuts(way_of(ladder), v, 0.5, 0, cuts);
				assert_true(v <= before + 3);
				assert_int_equal(drawn(cuts, count), v);
				for (uint32_t c = 0; c < count; c++) {
					assert_true(cuts[c].scale == 1 && cuts[c].list == ladder->points);
					assert_int_equal(level_of(ladder, cuts[c].first),
						level_of(ladder, cuts[c].end - 1));
				}
				if (count == 2)
					assert_int_equal(level_of(ladder, cuts[0].first),
						level_of(ladder, cuts[1].first) + 1);
				for (uint32_t i = 0; i < roots; i++) {
					uint64_t now = fineness(ladder, cuts, count, i);
					assert_true(now >= had[i] && (now >= each || v < roots));
					assert_true(now <= (last + 1ull) * each);
					had[i] = now;
				}
				assert_true(lod_way_density(way_of(ladder), v) == 1);
				assert_int_equal(lod_way_vertices(way_of(ladder), lod_way_share(way_of(ladder), v)), v);
			}
			for (uint32_t i = 0; i < roots; i++)
				assert_int_equal(had[i], (last + 1ull) * each);
			assert_int_equal(lod_way_stage_end(way_of(ladder)), before);
		}
	}
	assert_true(tried > 2000);
}

/* Beyond its splats a ladder draws leaves from the first on, then an equal share of those of each cell, with all splats
 * of the last level at the curve's scale. At the end all leaves are drawn. */
UNIT_TEST(leaves_stand_before_splats)
{
	uint32_t tried = 0, of_cells = 0;
	for (uint64_t seed = 1; seed < 60; seed++) {
		random_scene_splats(&scene, seed, 0);
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			const struct eco_ladder *ladder = &scene.ladders[l];
			if (!(ladder->flags & ECO_LADDER_WHOLE) || ladder->triangles == ECO_NONE)
				continue;
			const struct lod_way *way = way_of(ladder);
			uint64_t splats = lod_way_stage_end(way), v = splats;
			scene.curves[ladder->curve_first + ladder->curve_count - 1].scale = 0.5f;
			uint32_t own = scene.lists[ladder->triangles].primitive_count, from = own > ladder->total
				? own - ladder->total : 0, cells = ladder->total + from - own, seen = 0;
			assert_int_equal(way->full, splats + 3 * ladder->total);
			while ((v = lod_way_next(way, v)) != UINT64_MAX) {
				struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
				uint32_t count = lod_way_cuts(way, v, 1, 0, cuts), last = count - 1;
				uint64_t leaves = (v - splats) / 3, left = leaves < own - from ? 0 : leaves - (own - from);
				assert_true(count <= lod_way_cuts_bound(way));
				assert_int_equal(drawn(cuts, count), v);
				assert_true(cuts[0].list == ladder->triangles && cuts[0].first == from && cuts[0].scale == 1
					&& cuts[0].end - from == leaves - left);
				for (uint32_t i = 1; i < last; i++) {
					const struct eco_list *list = &scene.lists[cuts[i].list];
					double part = (double)left * list->primitive_count / cells;
					assert_true(cuts[i].first == 0 && cuts[i].scale == 1 && list->owner == ladder->plant
						&& cuts[i].end < part + 1 && cuts[i].end > part - 1);
				}
				assert_true(cuts[last].list == ladder->points && cuts[last].end - cuts[last].first == splats
					&& cuts[last].scale == lod_ladder_curve(&scene.scene, ladder, lod_way_share(way, v)).scale);
				seen = count - 2;
				of_cells += left > 0;
				tried++;
			}
			assert_true(cells ? seen + 1 == scene.scene.plants[ladder->plant].anchor_count : !seen);
		}
	}
	assert_true(tried > 1000 && of_cells > 1000);
}

/* Wood with lines and two levels. A sample of the curve stands between two of these: the first of the finer one with
 * the last of the coarser one. One that is not to be drawn is not there. */
UNIT_TEST(wood_gives_way_in_parts)
{
	uint32_t tried = 0;
	for (uint64_t seed = 1; seed < 40; seed++) {
		random_scene_make(&scene, seed, 0);
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			struct eco_ladder ladder = scene.ladders[l];
			uint32_t lines = ladder.lines == ECO_NONE ? 0 : scene.lists[ladder.lines].primitive_count,
				coarse = ladder.level_end[0], fine = ladder.level_end[1] - coarse;
			if (ladder.organ != ECO_ORGAN_WOOD || ladder.level_count != 2 || lines < 2 || coarse < 4
					|| 2 * lines > 3 * coarse - 6)
				continue;
			ladder.curve_first = 0;
			ladder.flags = 0;
			float full = (float)(3 * fine), last = full - 3;
			uint32_t first = 2 * (lines / 2) + 3 * (coarse - 2), second = 3 * 2 + 3 * (coarse - 1);
			set_curve(&ladder, (struct eco_curve[]){
				SCENE_CURVE((float)first / full, 1, (float)(coarse - 2) / (float)coarse, 0.3f, 0.3f),
				SCENE_CURVE((float)(second - 1) / full, 1, 2 / (float)fine, 0.2f, 0.2f),
				SCENE_CURVE((float)second / full, 1, 2 / (float)fine, 0.2f, 0.2f),
				SCENE_CURVE(last / full, 1, 0.001f, 0.1f, 0.1f), SCENE_CURVE(1, 1, 1, 0, 0) }, 5);
			struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
			if (first > 2 * lines && first < 3 * coarse) {
				assert_int_equal(lod_way_floor(way_of(&ladder), 3 * coarse - 1), first);
				assert_int_equal(lod_way_cuts(way_of(&ladder), first, 1, 0, cuts), 2);
				assert_true(cuts[0].list == ladder.triangles && cuts[0].first == 0
					&& cuts[0].end == coarse - 2);
				assert_true(cuts[1].list == ladder.lines && cuts[1].first == lines - lines / 2
					&& cuts[1].end == lines);
				tried++;
			}
			assert_int_equal(lod_way_next(way_of(&ladder), 3 * coarse), second);
			assert_int_equal(lod_way_next(way_of(&ladder), second), 3 * fine);
			assert_int_equal(lod_way_floor(way_of(&ladder), 3 * fine - 1), second);
			assert_int_equal(lod_way_cuts(way_of(&ladder), second, 1, 0, cuts), 2);
			assert_true(cuts[0].first == coarse && cuts[0].end == coarse + 2 && cuts[1].first == 1
				&& cuts[1].end == coarse && cuts[1].list == ladder.triangles);
			tried++;
			/* nothing is left of what is before the first level */
			ladder.lines = ladder.points = ECO_NONE;
			set_curve(&ladder, (struct eco_curve[]){ SCENE_CURVE(6 / full, 1, 2 / (float)coarse, 0.2f, 0.2f),
				SCENE_CURVE(1, 1, 1, 0, 0) }, 2);
			assert_int_equal(lod_way_floor(way_of(&ladder), 3 * coarse - 1), 0);
			assert_int_equal(lod_way_next(way_of(&ladder), 0), 3 * coarse);
		}
	}
	assert_true(tried > 20);
}

static double elements_of(const struct eco_list *list, double primitives)
{
	double elements = 0;
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		const struct eco_chunk *chunk = &scene.chunks[list->chunk_first + c];
		if (primitives < chunk->primitive_count)
			return elements + primitives * chunk->element_count / chunk->primitive_count;
		primitives -= chunk->primitive_count;
		elements += chunk->element_count;
	}
	return elements;
}

/* Elements that an amount draws in a form or a finer one: `drawn` of all, then each finer form. */
static void count_elements(const struct eco_ladder *ladder, const struct eco_cut *cuts, uint32_t count,
	double drawn_in[4])
{
	const uint32_t lists[4] = { ladder->points, ladder->lines, ladder->simple, ladder->triangles };
	drawn_in[0] = drawn_in[1] = drawn_in[2] = drawn_in[3] = 0;
	for (uint32_t i = 0; i < count; i++)
		for (int form = 0; form < 4; form++)
			if (lists[form] != ECO_NONE && cuts[i].list == lists[form])
				for (int coarser = 0; coarser <= form; coarser++) {
					double end = elements_of(&scene.lists[cuts[i].list], cuts[i].end);
					drawn_in[coarser] = end > drawn_in[coarser] ? end : drawn_in[coarser];
				}
}

/* Whatever the curve says: a larger amount has all elements of a smaller one, none of them coarser. */
UNIT_TEST(nothing_is_dropped_or_coarsened_as_amounts_grow)
{
	for (uint64_t seed = 1; seed < 60; seed++) {
		random_scene_make(&scene, seed, 0);
		for (uint32_t i = 0; i < scene.scene.curve_count; i++)       /* curves of any shape */
			if (seed % 3 == 0)
				scene.curves[i].reach = (float)random_real(&scene, 0, 1);
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			const struct eco_ladder *ladder = &scene.ladders[l];
			if (ladder->organ == ECO_ORGAN_WOOD)
				continue;
			double last[4] = { 0, 0, 0, 0 }, share = 0, density = 0;
			for (uint64_t v = lod_way_next(way_of(ladder), 0); v != UINT64_MAX;
					v = lod_way_next(way_of(ladder), v)) {
				struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
				double now[4], now_share = lod_way_share(way_of(ladder), v),
					now_density = lod_way_density(way_of(ladder), v);
				uint32_t count = lod_way_cuts(way_of(ladder), v, now_density, 0, cuts);
				count_elements(ladder, cuts, count, now);
				for (int form = 0; form < 4; form++) {
					/* in mixed lists ends are means */
					assert_true(now[form] >= last[form] - 1.01);
					last[form] = now[form];
				}
				assert_true(now_share >= share && now_share <= 1 && now_density >= density
					&& now_density <= 1);
				assert_true(lod_way_vertices(way_of(ladder), now_share) <= v);
				share = now_share;
				density = now_density;
			}
			assert_true(lod_way_share(way_of(ladder), way_of(ladder)->full) == 1);
		}
	}
}

/* Some leaves have a triangle less than what stands for them: a step may then cost less than nothing. Every
 * amount that is named can be drawn, all the same. */
UNIT_TEST(amounts_can_be_drawn_where_leaves_are_cheaper_than_their_forms)
{
	const uint32_t k = 300;
	for (uint64_t seed = 1; seed < 60; seed++) {
		random_scene_make(&scene, seed, 0);
		uint32_t triangles = random_fans(&scene, k, 0);
		struct eco_list *fans = &scene.lists[triangles];
		fans->primitive_count = 0;
		for (uint32_t c = 0; c < fans->chunk_count; c++) {
			struct eco_chunk *chunk = &scene.chunks[fans->chunk_first + c];
			chunk->primitive_count = chunk->element_count
				+ (uint32_t)(random_real(&scene, 0, 3) * chunk->element_count);
			fans->primitive_count += chunk->primitive_count;
		}
		struct eco_ladder ladder = { .organ = ECO_ORGAN_FOLIAGE, .triangles = triangles,
			.lines = ECO_NONE, .impostor = ECO_NONE, .total = k, .curve_count = 5,
			.points = random_form(&scene, ECO_LIST_POINTS, triangles, 1),
			.simple = random_form(&scene, ECO_LIST_TRIANGLES, triangles, 2) };
		for (uint32_t i = 0; i < 5; i++)
			scene.curves[i] = (struct eco_curve)SCENE_CURVE(0.02f * (float)(1 << i), 1,
				(float)random_real(&scene, 0, 1), 0.1f, 0.1f);
		uint64_t full = way_of(&ladder)->full, next = 0, steps = 0;
		for (uint64_t asked = 1; asked <= full + 3; asked++) {
			struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
			uint64_t v = lod_way_floor(way_of(&ladder), asked);
			assert_true(v <= asked && lod_way_floor(way_of(&ladder), v) == v);
			if (v > 0)
				assert_int_equal(drawn(cuts,
					lod_way_cuts(way_of(&ladder), v,
					lod_way_density(way_of(&ladder), v), 0, cuts)), v);
		}
		while ((next = lod_way_next(way_of(&ladder), next)) != UINT64_MAX && steps++ <= full)
			assert_int_equal(lod_way_floor(way_of(&ladder), next), next);
		assert_true(steps <= full);
	}
}

/* Elements of the region that the whole-plant list holds come first: a cell begins where the curve reaches
 * beyond them. */
UNIT_TEST(cells_draw_what_the_whole_plant_list_does_not)
{
	const uint32_t k = 300;
	struct eco_ladder ladder = points_and_fans(k, 4);
	ladder.before = 100;
	ladder.total = 100 + k;
	struct eco_curve samples[] = { SCENE_CURVE(0.01f, 1, 0.05f, 0.5f, 0.5f), SCENE_CURVE(0.05f, 1, 0.25f, 0.4f, 0.4f),
		SCENE_CURVE(0.2f, 1, 1, 0.2f, 0.2f), SCENE_CURVE(1, 1, 1, 0, 0) };
	set_curve(&ladder, samples, 4);
	assert_int_equal(lod_way_vertices(way_of(&ladder), 0.05f), 0);
	assert_float_equal(lod_way_share(way_of(&ladder), 0), 0.05, 1e-6);
	assert_float_equal(lod_way_density(way_of(&ladder), 0), 0.25, 1e-6);
	uint64_t all = lod_way_vertices(way_of(&ladder), 0.2f);
	assert_float_equal(lod_way_density(way_of(&ladder), all), 1, 1e-6);
	assert_true(all >= k);
	/* the whole-plant list of a plant with cells: alone it reaches as far as it has elements */
	ladder.before = 0;
	ladder.total = 4 * k;
	uint64_t end = lod_way_stage_end(way_of(&ladder));
	assert_float_equal(lod_way_density(way_of(&ladder), end), 0.25, 1e-6);
	assert_true(end >= k && end < way_of(&ladder)->full);
	assert_true(lod_way_density(way_of(&ladder), lod_way_floor(way_of(&ladder), end - 1)) < 0.25);
}

UNIT_TEST(from_above_scales_and_errors_turn_into_those_of_the_other_curve)
{
	random_scene_make(&scene, 5, 0);
	struct eco_curve samples[] = { SCENE_CURVE(0.1f, 2, 0.5f, 0.2f, 0.4f), SCENE_CURVE(1, 1, 1, 0, 0),
		SCENE_CURVE(0.1f, 3, 0.5f, 0.1f, 0.2f), SCENE_CURVE(1, 1, 1, 0, 0) };
	memcpy(scene.curves, samples, sizeof samples);
	struct eco_ladder ladder = { .curve_first = 0, .curve_count = 2, .flags = ECO_LADDER_ABOVE };
	struct { double below, distance, scale, fp, fn; } rows[] =
		{ { -5, 10, 2, 0.2, 0.4 }, { 2, 10, 2, 0.2, 0.4 }, { 4.5, 10, 2.5, 0.15, 0.3 },
		{ 7, 10, 3, 0.1, 0.2 }, { 10, 10, 3, 0.1, 0.2 }, { 1, 0, 2, 0.2, 0.4 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_curve c = lod_ladder_curve_seen(&scene.scene, &ladder, 0.1,
			lod_seen_above(rows[i].below, rows[i].distance));
		assert_float_equal(c.scale, rows[i].scale, 1e-5);
		assert_float_equal(c.reach, 0.5, 1e-5);
		assert_float_equal(c.fp, rows[i].fp, 1e-5);
		assert_float_equal(c.fn, rows[i].fn, 1e-5);
	}
	ladder.flags = 0;
	assert_float_equal(lod_ladder_curve_seen(&scene.scene, &ladder, 0.1, 1).scale, 2, 1e-5);
}
