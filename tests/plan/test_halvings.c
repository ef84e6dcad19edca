/* Vertices that a plan has left scatter the points of its summaries, the widest first. */
#include <math.h>

#include "lod/plan/halvings.h"
#include "lod/scattered.h"
#include "tests/support/unit_test.h"

#define ENTRIES 40u
#define NARROW 8.0               /* pixels */

static struct eco_list lists[ENTRIES];
static struct eco_tile tiles[ENTRIES];
static struct lod_node nodes[ENTRIES];
static struct lod_entry entries[ENTRIES];
static struct eco_placement placements[] = { { .scale = 1 }, { .scale = 2.5 } };
static const struct eco_scene scene = { .lists = lists, .tiles = tiles };
static struct eco_request request;
static const struct lod_planner_input input = { .scene = &scene, .request = &request };

/* Summaries from 25 m on, of points of all widths; each third entry is no summary, each seventh draws none. */
static struct lod_planner make_planner(void)
{
	struct lod_planner p = { .scene = &scene, .input = &input, .entries = entries,
		.entry_count = ENTRIES, .visible = { .nodes = nodes, .placements = placements } };
	p.visible.eye.pixel_rad = 1e-3;
	for (uint32_t i = 0; i < ENTRIES; i++) {
		uint64_t full = 100 + 13 * i;
		lists[i] = (struct eco_list){ .unit_area = 0.02f * (float)(1 + i * i % 17) };
		tiles[i].summary = i;
		nodes[i] = (struct lod_node){ .tile = i, .placement = i % 2, .distance = 25.0 * (1 + i % 9) };
		entries[i] = (struct lod_entry){ .slot = i % 3 == 2 ? 5 : ECO_NONE, .ladder = i,
			.vertices = i % 7 ? full / (1 + i % 11) : 0, .full = full };
		p.vertices += entries[i].vertices;
	}
	return p;
}

static double width_px(uint32_t i, unsigned halvings)
{
	return 2 * lod_ball_radius(&lists[i], ldexpf(lod_summary_scale(&entries[i]), -(int)halvings))
		* placements[i % 2].scale / (nodes[i].distance * 1e-3);
}

static uint64_t added(const struct lod_planner *p, double part_px)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < ENTRIES; i++)
		if (entries[i].slot == ECO_NONE)
			sum += entries[i].vertices * ((1u << lod_halvings(p, &entries[i], part_px)) - 1);
	return sum;
}

UNIT_TEST(with_plenty_of_vertices_points_are_narrow_or_halved_most)
{
	struct lod_planner p = make_planner();
	uint32_t whole = 0, most = 0;
	request.vertices = ECO_VERTICES_MAX;
	double part_px = lod_part_px(&p);
	for (uint32_t i = 0; i < ENTRIES; i++) {
		unsigned halvings = lod_halvings(&p, &entries[i], part_px);
		if (!entries[i].vertices) {
			assert_int_equal(halvings, 0);
			continue;
		}
		assert_true(width_px(i, halvings) <= NARROW * 1.0001 || halvings == ECO_HALVINGS_MAX);
		assert_true(!halvings || width_px(i, halvings - 1) > NARROW * 0.9999);
		whole += halvings == 0;
		most += halvings == ECO_HALVINGS_MAX;
	}
	print_message("          %u of %u are whole, %u are halved most\n", whole, ENTRIES, most);
	assert_true(whole > 0 && most > 0);
}

UNIT_TEST(never_more_than_the_vertices_left_and_the_more_the_finer)
{
	struct lod_planner p = make_planner();
	double before = INFINITY;
	for (uint64_t left = 0; left < 2000000; left += 1 + left / 4) {
		request.vertices = p.vertices + left;
		double part_px = lod_part_px(&p);
		assert_true(added(&p, part_px) <= left && part_px <= before);
		assert_true(left || part_px == INFINITY || added(&p, part_px) == 0);
		before = part_px;
	}
	assert_true(before <= NARROW);
}
