/* Precision and Recall of masks known by hand. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/plan.h"
#include "lod/raster/raster.h"
#include "tests/support/unit_test.h"

#define NEAR(a, b) assert_true(fabs((a) - (b)) < 1e-12)

struct row { const char *cover, *reference; double precision, recall, skill; };

static uint32_t mask_of(const char *text, uint8_t *mask)
{
	uint32_t n = (uint32_t)strlen(text);
	for (uint32_t i = 0; i < n; i++)
		mask[i] = text[i] == '#' ? (uint8_t)(1 + 50 * i) : 0;
	return n;
}

static const struct row rows[] = {
	{ "##..", "##..", 1, 1, 1 },
	{ "###.", "##..", 2.0 / 3, 1, 1.0 / 3 },          /* q 2/3, all covered 1/2 */
	{ "#...", "##..", 1, 0.5, 0 },
	{ "##..", "..##", 0, 0, -2 * (M_SQRT2 - 0.5) },
	{ "####", "#...", 0.25, 1, 0 },
	{ "....", "....", 1, 1, 1 },
	/* nothing wanted, nothing done: all covered would score 0 */
	{ "#...", "....", 0, 1, 0 },
	{ "....", "#...", 1, 0, -1.0 / 3 },
	{ "##..", "####", 1, 0.5, NAN },
	{ "", "", 1, 1, NAN },
};

/* Fills both masks; returns their length. */
static uint32_t score_row(const struct row *row, struct lod_score *score, uint8_t *cover, uint8_t *reference)
{
	uint32_t n = mask_of(row->cover, cover);
	mask_of(row->reference, reference);
	lod_score(score, &(struct lod_score_input){ .width = n, .height = 1, .cover = cover,
		.reference = reference });
	return n;
}

UNIT_TEST(known_masks_have_known_scores)
{
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		uint8_t cover[8], reference[8];
		struct lod_score score;
		uint32_t n = score_row(&rows[i], &score, cover, reference);
		NEAR(score.precision, rows[i].precision);
		NEAR(score.recall, rows[i].recall);
		NEAR(score.q, 1 - hypot(1 - score.precision, 1 - score.recall));
		NEAR(score.owner_q, score.q);
		if (isnan(rows[i].skill))
			assert_true(isnan(score.skill));
		else
			NEAR(score.skill, rows[i].skill);
		assert_int_equal(score.pixels, n);
		assert_int_equal(score.tp_owner, score.tp);
	}
}

UNIT_TEST(owners_must_match_where_they_are_known)
{
	uint32_t leaf = eco_owner_leaf(3), other = eco_owner_leaf(4);
	uint64_t reference[4] = { eco_owner_instance(leaf, 2, 0), eco_owner_instance(leaf, 2, 1),
		eco_owner_instance(leaf, 2, 2), eco_owner_instance(leaf, 5, 0) };
	uint64_t drawn[4] = { eco_owner_instance(leaf, 2, 0), eco_owner_instance(leaf, 2, 9),
		eco_owner_summary(leaf, 2), eco_owner_summary(other, 5) };
	uint8_t mask[4] = { 1, 1, 1, 1 };
	struct lod_score score;
	lod_score(&score, &(struct lod_score_input){ 4, 1, mask, mask, drawn, reference });
	assert_int_equal(score.tp, 4);
	assert_int_equal(score.tp_owner, 2);
	NEAR(score.q, 1);
	NEAR(score.owner_q, 1 - hypot(0.5, 0.5));
}

UNIT_TEST(soft_q_of_half_covered_pixels)
{
	static const struct { uint8_t count[4], reference[4]; double precision, recall; } soft[] = {
		{ { 16, 16, 0, 0 }, { 16, 16, 0, 0 }, 1, 1 },
		{ { 8, 8, 0, 0 }, { 8, 8, 0, 0 }, 1, 1 },        /* a mask would see all or nothing */
		{ { 16, 0, 0, 0 }, { 8, 8, 0, 0 }, 0.5, 0.5 },
		{ { 16, 16, 0, 0 }, { 8, 8, 0, 0 }, 0.5, 1 },
		{ { 4, 0, 0, 0 }, { 16, 0, 0, 0 }, 1, 0.25 },
		{ { 12, 4, 0, 16 }, { 8, 8, 16, 0 }, 12.0 / 32, 12.0 / 32 },
		{ { 0, 0, 0, 0 }, { 0, 0, 0, 0 }, 1, 1 },
		{ { 0, 0, 0, 0 }, { 3, 0, 0, 0 }, 1, 0 },
	};
	for (size_t i = 0; i < sizeof soft / sizeof *soft; i++)
		NEAR(lod_soft_q(soft[i].count, soft[i].reference, 4),
			1 - hypot(1 - soft[i].precision, 1 - soft[i].recall));
}

UNIT_TEST(ceiling_is_of_equal_area)
{
	static const struct { uint8_t count[6], reference[6]; double q; } ceilings[] = {
		{ { 64, 64, 64, 64, 64, 64 }, { 1, 1, 1, 1, 1, 1 }, 1 },     /* all of the screen */
		{ { 64, 64, 40, 20, 0, 0 }, { 1, 1, 1, 0, 0, 0 }, 1 },
		{ { 64, 40, 30, 10, 0, 0 }, { 1, 0, 1, 1, 0, 0 }, 1 - M_SQRT2 / 3 },       /* 2 for 4 */
		{ { 64, 10, 10, 10, 10, 10 }, { 1, 1, 0, 0, 0, 0 }, 0.5 },   /* 1, not 6, is nearer to 2 */
		{ { 0, 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0, 0 }, 1 },
		{ { 9, 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0, 0 }, 1 },
	};
	for (size_t i = 0; i < sizeof ceilings / sizeof *ceilings; i++)
		NEAR(lod_q_ceiling(ceilings[i].count, ceilings[i].reference, 6), ceilings[i].q);
}
