/* Plans as data: their order and checks, holdings, and owners that match where the same plant, or one like
 * it, is meant. */

#include "ecofiles/format/plan.h"
#include "tests/support/unit_test.h"

UNIT_TEST(a_summary_matches_any_plant_of_its_tile_and_species)
{
	uint32_t key = eco_owner_leaf(7) + eco_owner_child(3), other = eco_owner_leaf(8) + eco_owner_child(3);
	uint64_t summary = eco_owner_summary(key, 5);
	assert_true(eco_owner_match(summary, eco_owner_instance(key, 5, 0)));
	assert_int_equal(eco_owner_plant(summary), 5);
	assert_int_equal(eco_owner_plant(eco_owner_instance(key, 65535, 123456789)), 65535);
	assert_true(eco_owner_match(eco_owner_instance(key, 5, 123456), summary));
	assert_true(eco_owner_match(summary, eco_owner_summary(key & 0xFFFF, 5)));
	assert_false(eco_owner_match(summary, eco_owner_instance(key, 6, 0)));
	assert_false(eco_owner_match(summary, eco_owner_instance(other, 5, 0)));
	assert_false(eco_owner_match(summary, eco_owner_summary(other, 5)));
}

UNIT_TEST(chunks_held_are_found_by_list)
{
	struct eco_holding items[] = { { 0, 4 }, { 3, 1 }, { 4, 9 }, { 4000000000u, 2 } };
	struct eco_holdings held = { items, 4 }, none = { NULL, 0 };
	for (size_t i = 0; i < 4; i++)
		assert_int_equal(eco_holdings_chunks(&held, items[i].list), items[i].chunks);
	assert_int_equal(eco_holdings_chunks(&held, 1), 0);
	assert_int_equal(eco_holdings_chunks(&held, 5), 0);
	assert_int_equal(eco_holdings_chunks(&held, ECO_NONE), 0);
	assert_int_equal(eco_holdings_chunks(&none, 0), 0);
	assert_int_equal(eco_holdings_chunks(NULL, 0), 0);
}

static struct eco_cut rule(uint32_t anchor, uint32_t list, uint8_t band)
{
	return (struct eco_cut){ .list = list, .end = 1, .scale = 1, .anchor = anchor, .band_first = band,
		.band_end = band + 1,
		.share_end = ECO_SHARE_ONE };
}

UNIT_TEST(only_summaries_are_scattered_and_not_without_end)
{
	struct eco_cut cuts[] = { { .list = 9, .end = 4, .scale = 2, .anchor = ECO_NONE }, rule(1, 0, 4) };
	struct eco_placement placement = { .scale = 1 };
	struct eco_plan plan = { .cuts = cuts, .cut_count = 2, .placements = &placement, .placement_count = 1 };
	const struct eco_list list = { .kind = ECO_LIST_POINTS };
	cuts[0].halvings = ECO_HALVINGS_MAX;
	assert_int_equal(eco_plan_check(&plan, NULL), ECO_OK);
	assert_true(eco_cut_vertices(&cuts[0], &list) == 4ull << ECO_HALVINGS_MAX);
	cuts[0].halvings++;
	assert_int_equal(eco_plan_check(&plan, NULL), ECO_DAMAGED);
	cuts[0].halvings = 0;
	cuts[1].halvings = 1;
	assert_int_equal(eco_plan_check(&plan, NULL), ECO_DAMAGED);
}

UNIT_TEST(sorting_puts_summaries_first_then_anchor_list_and_band)
{
	struct eco_cut cuts[] = { rule(2, 0, 1), rule(1, 1, 0), rule(1, 0, 5),
		{ .list = 9, .end = 4, .scale = 2, .anchor = ECO_NONE }, rule(1, 0, 4), rule(0, 7, 7) };
	struct eco_run runs[] = { { 1, 0, 2, 0 }, { 0, 5, 6, 0 }, { 0, 1, 2, 0 } };
	struct eco_gate gates[] = { { 3, 10 }, { 1, 20 } };
	struct eco_placement placements[] = { { .scale = 1 }, { .scale = 2 } };
	struct eco_plan plan = { .cuts = cuts, .cut_count = 6, .runs = runs, .run_count = 3, .gates = gates,
		.gate_count = 2,
		.placements = placements, .placement_count = 2 };
	static const struct { uint32_t anchor, list; uint8_t band; } order[] =
		{ { ECO_NONE, 9, 0 }, { 0, 7, 7 }, { 1, 0, 4 }, { 1, 0, 5 },
		{ 1, 1, 0 }, { 2, 0, 1 } };
	assert_int_equal(eco_plan_check(&plan, NULL), ECO_DAMAGED);
	eco_plan_sort(&plan);
	assert_good(eco_plan_check(&plan, &cause));
	for (size_t i = 0; i < 6; i++)
		assert_true(cuts[i].anchor == order[i].anchor && cuts[i].list == order[i].list
			&& cuts[i].band_first == order[i].band);
	assert_true(runs[0].list_first == 1 && runs[1].list_first == 5 && runs[2].placement == 1);
	assert_true(gates[0].plant == 1);
}
