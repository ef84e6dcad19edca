/* Precision and Recall of covered pixels (Neubert 2011, section 2.2, equations 1 and 4), with two companions
 * that a few large blobs cannot win: skill (relative to covering everything) and the score with owners.
 * raster.h has the conventions. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/plan.h"
#include "lod/raster/raster.h"

static double ratio(uint64_t part, uint64_t whole)
{
	return whole ? (double)part / (double)whole : 1;
}

static double quality(double precision, double recall)
{
	return 1 - sqrt((1 - precision) * (1 - precision) + (1 - recall) * (1 - recall));
}

/* Eight bytes at a time: 1 in each byte that is not 0. */
static uint64_t set_bytes(const uint8_t *at)
{
	const uint64_t low = UINT64_C(0x7f7f7f7f7f7f7f7f);
	uint64_t bytes;
	memcpy(&bytes, at, sizeof bytes);
	return (((bytes & low) + low) | bytes) >> 7 & UINT64_C(0x0101010101010101);
}

static uint32_t sum_of_bytes(uint64_t bytes)
{
	const uint64_t even = UINT64_C(0x00ff00ff00ff00ff);
	bytes = (bytes & even) + (bytes >> 8 & even);
	return (uint32_t)((bytes * UINT64_C(0x0001000100010001)) >> 48);
}

static void count_row(struct lod_score *score, const uint8_t *cover, const uint8_t *reference, uint32_t width)
{
	uint32_t both = 0, covered = 0, wanted = 0, x = 0;
	while (width - x >= 8) {
		uint64_t boths = 0, covers = 0, wants = 0;
		/* 255 counts fit a byte. */
		for (uint32_t most = 255; most && width - x >= 8; most--, x += 8) {
			uint64_t a = set_bytes(cover + x), b = set_bytes(reference + x);
			boths += a & b;
			covers += a;
			wants += b;
		}
		both += sum_of_bytes(boths);
		covered += sum_of_bytes(covers);
		wanted += sum_of_bytes(wants);
	}
	for (; x < width; x++) {
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
			owned += input->owner[i] == input->reference_owner[i]
				|| eco_owner_match(input->owner[i], input->reference_owner[i]);
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

double lod_soft_q(const uint8_t *count, const uint8_t *reference_count, size_t pixels)
{
	uint64_t both = 0, covered = 0, wanted = 0;
	for (size_t i = 0; i < pixels; i++) {
		both += count[i] < reference_count[i] ? count[i] : reference_count[i];
		covered += count[i];
		wanted += reference_count[i];
	}
	return quality(ratio(both, covered), ratio(both, wanted));
}

/* The count from which on about `wanted` pixels have as many: of two that are as near, the higher. */
static uint32_t equal_area(const uint64_t pixels_with[256], uint64_t wanted)
{
	uint32_t count = 256;
	for (uint64_t area = 0; count > 1; count--) {
		uint64_t next = area + pixels_with[count - 1];
		if (next > wanted && next - wanted >= wanted - area)
			break;
		area = next;
		if (area >= wanted)
			return count - 1;
	}
	return count;
}

double lod_q_ceiling(const uint8_t *reference_count, const uint8_t *reference, size_t pixels)
{
	uint64_t pixels_with[256] = { 0 }, wanted = 0, covered = 0, both = 0;
	for (size_t i = 0; i < pixels; i++) {
		pixels_with[reference_count[i]]++;
		wanted += reference[i] != 0;
	}
	uint32_t least = equal_area(pixels_with, wanted);
	for (size_t i = 0; i < pixels; i++) {
		bool is_covered = reference_count[i] >= least;
		covered += is_covered;
		both += is_covered && reference[i];
	}
	return quality(ratio(both, covered), ratio(both, wanted));
}
