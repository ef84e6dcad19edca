/* Precision and Recall of covered pixels (Neubert 2011, section 2.2, equations 1 and 4), with two companions that a few large blobs
 * cannot win: skill (against covering everything) and the same score with owners. raster.h states the conventions. */
#include <math.h>

#include "ecofiles/plan.h"
#include "lod/raster.h"

static double ratio(uint64_t part, uint64_t whole)
{
	return whole ? (double)part / (double)whole : 1;
}

static double quality(double precision, double recall)
{
	return 1 - sqrt((1 - precision) * (1 - precision) + (1 - recall) * (1 - recall));
}

static void count_row(struct lod_score *score, const uint8_t *cover, const uint8_t *reference, uint32_t width)
{
	uint32_t both = 0, covered = 0, wanted = 0;
	for (uint32_t x = 0; x < width; x++) {
		uint32_t a = cover[x] != 0, b = reference[x] != 0;
		both += a & b;
		covered += a;
		wanted += b;
	}
	score->tp += both;
	score->fp += covered - both;
	score->fn += wanted - both;
}

static uint64_t count_owned(const struct lod_score_input *input, size_t first, uint32_t width)
{
	uint64_t owned = 0;
	for (size_t i = first; i < first + width; i++) {
		if (input->cover[i] && input->reference[i])
			owned += input->owner[i] == input->reference_owner[i] || eco_owner_match(input->owner[i], input->reference_owner[i]);
	}
	return owned;
}

static double skill_of(const struct lod_score *score)
{
	uint64_t wanted = score->tp + score->fn;
	double q_on = !score->pixels ? 1 : quality(ratio(wanted, score->pixels), 1);
	return q_on < 1 ? (score->q - q_on) / (1 - q_on) : NAN;
}

void lod_score(struct lod_score *score, const struct lod_score_input *input)
{
	*score = (struct lod_score){ .pixels = (uint64_t)input->width * input->height };
	bool owners = input->owner && input->reference_owner;
	for (uint32_t y = 0; y < input->height; y++) {
		size_t first = (size_t)y * input->width;
		count_row(score, input->cover + first, input->reference + first, input->width);
		if (owners)
			score->tp_owner += count_owned(input, first, input->width);
	}
	if (!owners)
		score->tp_owner = score->tp;
	uint64_t covered = score->tp + score->fp, wanted = score->tp + score->fn;
	score->precision = ratio(score->tp, covered);
	score->recall = ratio(score->tp, wanted);
	score->q = quality(score->precision, score->recall);
	score->skill = skill_of(score);
	score->owner_q = quality(ratio(score->tp_owner, covered), ratio(score->tp_owner, wanted));
}
