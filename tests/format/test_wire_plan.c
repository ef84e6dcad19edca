/* Plans as they travel: one encoding each, read back the same, small; whatever breaks a rule is neither
 * written nor read. */
#include <math.h>

#include "tests/support/unit_test.h"
#include "tests/support/wire_random.h"

UNIT_TEST(plan_survives_the_wire_and_has_one_encoding)
{
	struct wire_random r = { 1 };
	for (int i = 0; i < 3000; i++) {
		FREED(eco_plan) plan = wire_random_plan(&r, 1 + i % 60, i % 2 ? 9 : UINT32_MAX - 1,
			i % 3 ? 40 : UINT32_MAX), back;
		FREED(eco_writer) w = { 0 }, again = { 0 };
		assert_good(eco_plan_check(&plan, &cause));
		eco_wire_write_plan(&w, &plan);
		assert_false(w.failed);
		struct eco_reader reader = { .bytes = w.bytes, .size = w.size };
		assert_good(eco_wire_read_plan(&reader, &back, &cause));
		assert_true(reader.at == w.size);
		assert_same_plan(&plan, &back);
		eco_wire_write_plan(&again, &back);
		assert_true(again.size == w.size);
		assert_memory_equal(again.bytes, w.bytes, again.size);
	}
}

UNIT_TEST(order_of_a_plan_does_not_change_its_bytes)
{
	struct wire_random r = { 2 };
	for (int i = 0; i < 200; i++) {
		FREED(eco_plan) plan = wire_random_plan(&r, 30, 20, 50);
		FREED(eco_writer) a = { 0 }, b = { 0 };
		eco_wire_write_plan(&a, &plan);
		for (uint32_t n = plan.cut_count; n > 1; n--) {
			uint32_t k = wire_random_below(&r, n);
			struct eco_cut t = plan.cuts[k];
			plan.cuts[k] = plan.cuts[n - 1];
			plan.cuts[n - 1] = t;
		}
		eco_wire_write_plan(&b, &plan);
		assert_true(!a.failed && !b.failed && a.size == b.size);
		assert_memory_equal(a.bytes, b.bytes, a.size);
	}
}

/* No reader has to believe a count, nor a field that is said in vain: a plan has one encoding. */
UNIT_TEST(counts_beyond_the_bytes_and_vain_fields_are_refused)
{
	/* no vertices, no pixels, no m16; a placement, no run, no gate, cuts; the placement; then the cut, or none */
	static const struct { uint8_t bytes[16], size; bool good; } rows[] = {
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0 }, 14, true },      /* [0,1) of list 0 */
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 4, 2 }, 15, true },   /* [0,2) */
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 4, 0 }, 15, false },  /* its end differs by 0 */
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0 }, 15, false },  /* a byte behind it */
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0x80, 16 }, 15, false },      /* a field too many */
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 1, 8, 0, 0, 0, 0, 0 }, 15, false },  /* the turn is said to be 0 */
		{ { 0, 0, 0, 0, 0, 1, 0, 0, 0xFF, 0xFF, 0x3F, 0, 0, 0, 0 }, 15, false } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_reader reader = { .bytes = rows[i].bytes, .size = rows[i].size };
		struct eco_plan plan;
		struct eco_error error = { 0 };
		enum eco_code code = eco_wire_read_plan(&reader, &plan, &error);
		if ((code == ECO_OK) != rows[i].good)
			fail_msg("row %zu: code %d %s", i, code, error.text);
		eco_plan_free(&plan);
	}
}

/* A frame has a hash; what it holds says nothing twice. So a plan that was cut off may be another one, if
 * seldom, but never a bad one. */
UNIT_TEST(truncations_of_a_plan_are_refused_or_other_plans)
{
	struct wire_random r = { 4 };
	uint32_t refused = 0, other = 0;
	for (int i = 0; i < 40; i++) {
		struct eco_plan plan = wire_random_plan(&r, 12, 50, 50), back;
		FREED(eco_writer) w = { 0 };
		eco_wire_write_plan(&w, &plan);
		for (size_t size = 0; size < w.size; size++) {
			struct eco_error error = { 0 };
			/* so that the sanitizer sees a read beyond the end */
			uint8_t *exact = malloc(size + 1);
			memcpy(exact, w.bytes, size);
			struct eco_reader reader = { .bytes = exact, .size = size };
			if (eco_wire_read_plan(&reader, &back, &error) == ECO_OK) {
				FREED(eco_writer) again = { 0 };
				eco_wire_write_plan(&again, &back);
				assert_true(again.size == size && !memcmp(again.bytes, exact, size));
				eco_plan_free(&back);
				other++;
			} else {
				assert_int_equal(error.code, ECO_DAMAGED);
				assert_true(error.text[0] && !back.cuts && !back.placements);
				refused++;
			}
			free(exact);
		}
		eco_plan_free(&plan);
	}
	assert_true(refused > 1000 && other < refused / 200);
}

static struct eco_plan small_plan(void)
{
	struct eco_plan plan = { .placement_count = 1, .run_count = 8, .cut_count = 8,
		.placements = calloc(1, sizeof *plan.placements), .runs = calloc(8, sizeof *plan.runs),
		.gates = calloc(2, sizeof *plan.gates), .cuts = calloc(8, sizeof *plan.cuts) };
	plan.placements[0].scale = 1;
	for (uint32_t i = 0; i < 8; i++) {
		plan.runs[i] = (struct eco_run){ .list_first = 500 + 9 * i, .list_end = 508 + 9 * i };
		plan.cuts[i] = (struct eco_cut){ .list = i, .end = 100, .scale = 1, .anchor = 40 * i,
			.band_first = 100, .band_end = 101, .share_end = ECO_SHARE_ONE };
	}
	return plan;
}

UNIT_TEST(plans_that_break_a_rule_are_not_written)
{
	for (int fault = 0; fault <= 21; fault++) {
		FREED(eco_plan) plan = small_plan();
		FREED(eco_writer) w = { 0 };
		switch (fault) {
		case 0: plan.cuts[3].end = plan.cuts[3].first = 5; break;
		case 1: plan.cuts[3].scale = NAN; break;
		case 2: plan.cuts[3].scale = -1; break;
		case 3: plan.cuts[3].band_end = ECO_BANDS + 1; break;
		case 4: plan.cuts[3].band_first = plan.cuts[3].band_end; break;
		case 5: plan.cuts[3].share_end = ECO_SHARE_ONE + 1; break;
		case 6: plan.cuts[3].anchor = ECO_NONE, plan.cuts[3].placement = 1; break;
		case 7: plan.cuts[3] = plan.cuts[4]; break;
		case 8: plan.runs[3] = plan.runs[4]; break;
		case 9: plan.runs[3].placement = 1; break;
		case 10: plan.runs[3].list_end = plan.runs[3].list_first; break;
		case 11: plan.gate_count = 2; break;                     /* both of plant 0 */
		case 12: plan.gate_count = 1, plan.gates[0].end = ECO_GATE_OPEN + 1; break;
		case 13: plan.placements[0].scale = 0; break;
		case 14: plan.placements[0].at[1] = INFINITY; break;
		case 15: plan.sample_distance = -1; break;
		case 16: plan.runs[3].left = ECO_SHARE_ONE; break;
		case 17: plan.prediction.tp = -1; break;
		case 18: plan.prediction.fp = 1e17; break;
		case 19: plan.m16 = 1001; break;
		case 20:
			plan.m16 = eco_wire_m16_round(1e9);
			plan.prediction.tp = eco_wire_pixels_round(-1);
			plan.prediction.fp = eco_wire_pixels_round(1e17);
			break;
		}
		eco_wire_write_plan(&w, &plan);
		assert_int_equal(w.failed, fault < 20);      /* the last two are sound */
	}
}
