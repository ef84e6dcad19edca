/* wood MODEL ...: how much of the wood that full detail shows at a pixel or more of width is there if a plant's
 * cells draw it as lines, as levels of triangles, or each in a form of its own. Exit 1 if a mix of cells has a
 * hole, or if a level loses more than 2 % of the wood. Lines alone have no bound: from above a line does not show
 * the foot of a trunk, and a pot is no line.
 *
 * Twelve directions, 512 pixels around the plant, drawn at twice that. A pixel is covered if wood is drawn within
 * one pixel of it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/import/model/model_import.h"
#include "lod/build/measure/probe.h"
#include "lod/build/plant.h"

#define VIEWS 12u
#define PIXELS 1024u
#define ALL (PIXELS * PIXELS)
#define STATES 4u                /* of a cell: lines, then levels, of which the last is full detail */
#define MIXED STATES             /* each cell in a state by chance */
#define MIXES 16u
#define HOLES_MOST 0.002         /* of the wood in one direction: what each state covers and a mix does not */
#define LEVEL_LEAST 0.98

static struct lod_probe probe;
/* Per direction: 1 where full detail shows wide wood, 2 where each state does too. */
static uint8_t wide[VIEWS][ALL], scratch[ALL];

/* Pixels of 2 x 2 blocks that are covered as a whole: a pixel of half the size wide. */
static void open_blocks(const uint8_t *cover, uint8_t *out)
{
	memset(out, 0, ALL);
	for (size_t i = 0; i + PIXELS + 1 < ALL; i++)
		if (i % PIXELS + 1 < PIXELS && cover[i] && cover[i + 1] && cover[i + PIXELS]
				&& cover[i + PIXELS + 1])
			out[i] = out[i + 1] = out[i + PIXELS] = out[i + PIXELS + 1] = 2;
}

/* Covered pixels grow by two, along rows and columns. */
static void widen(uint8_t *cover)
{
	for (int k = 0; k < 2; k++) {
		memcpy(scratch, cover, ALL);
		for (size_t i = PIXELS; i < ALL - PIXELS; i++)
			cover[i] |= scratch[i - 1] | scratch[i + 1] | scratch[i - PIXELS] | scratch[i + PIXELS];
	}
}

/* A cell without lines has no wood in the state of lines. */
static struct eco_cut cut_of(const struct eco_ladder *ladder, uint32_t state)
{
	uint32_t list = state ? ladder->triangles : ladder->lines;
	struct eco_cut cut = { .scale = 1, .list = list };
	if (list != ECO_NONE && state && ladder->level_count) {
		uint32_t level = state <= ladder->level_count ? state - 1 : ladder->level_count - 1u;
		cut.first = level ? ladder->level_end[level - 1] : 0;
		cut.end = ladder->level_end[level];
	} else if (list != ECO_NONE) {
		cut.end = probe.plant->lists[list].list.primitive_count;
	}
	return cut;
}

/* Draws all cells in a state; the reference is then the picture. */
static void draw(uint32_t state, uint32_t mix)
{
	lod_probe_clear(&probe);
	for (uint32_t i = 0; i < probe.plant->ladder_count; i++) {
		const struct eco_ladder *ladder = &probe.plant->ladders[i];
		uint64_t random = (uint64_t)mix << 32 | i;
		struct eco_cut cut = cut_of(ladder, state == MIXED ? eco_random_next(&random) % STATES : state);
		if (ladder->organ == ECO_ORGAN_WOOD && ladder->flags & ECO_LADDER_NEAR && cut.list != ECO_NONE)
			lod_probe_add(&probe, &cut);
	}
	lod_probe_keep(&probe);
}

/* The mean share of wide wood that the last picture covers, and the greatest of holes. `all`: it is a state that
 * no mix may fall below. */
static double compare(bool all, double *hole)
{
	double mean = 0;
	for (uint32_t view = 0; view < VIEWS; view++) {
		uint8_t *cover = probe.reference + (size_t)view * ALL;
		uint64_t total = 0, there = 0, holes = 0;
		widen(cover);
		for (size_t i = 0; i < ALL; i++) {
			total += wide[view][i] != 0;
			there += wide[view][i] && cover[i];
			holes += wide[view][i] == 2 && !cover[i];
			if (all && wide[view][i] && !cover[i])
				wide[view][i] = 1;
		}
		mean += (total ? (double)there / (double)total : 1) / VIEWS;
		*hole = fmax(*hole, total ? (double)holes / (double)total : 0);
	}
	return mean;
}

/* Whether the model's wood holds. */
static bool measure(const char *path)
{
	struct eco_model model;
	struct lod_plant plant;
	struct eco_error error = { 0 };
	double same[STATES], mixed = 1, hole = 0, none = 0;
	if (eco_model_import(&model, &(struct eco_model_options){ .paths = &path, .path_count = 1 }, &error)
			|| lod_plant_build(&plant, &model, &(struct lod_plant_options){ .name = "plant", .seed = 1,
			.order = LOD_ORDER_COMBINED }, &error)) {
		printf("%s: %s\n", path, error.text);
		return false;
	}
	lod_probe_init(&probe, &plant, &model, &(struct lod_probe_options){ .views = VIEWS, .pixels = PIXELS });
	draw(STATES - 1, 0);
	for (uint32_t view = 0; view < VIEWS; view++)
		open_blocks(probe.reference + (size_t)view * ALL, wide[view]);
	for (uint32_t state = 0; state < STATES; state++) {
		draw(state, 0);
		same[state] = compare(true, &none);
	}
	for (uint32_t mix = 1; mix <= MIXES; mix++) {
		draw(MIXED, mix);
		mixed = fmin(mixed, compare(false, &hole));
	}
	bool good = hole <= HOLES_MOST && fmin(same[1], fmin(same[2], same[3])) >= LEVEL_LEAST;
	printf("%s: all lines %.4f, levels %.4f %.4f %.4f, mixes %.4f, holes %.5f%s\n", path, same[0], same[1],
		same[2], same[3], mixed, hole, good ? "" : ": FAILED");
	lod_probe_free(&probe);
	lod_plant_free(&plant);
	eco_model_free(&model);
	return good;
}

int main(int argc, char **argv)
{
	int failed = 0;
	for (int i = 1; i < argc; i++) {
		failed += !measure(argv[i]);
		fflush(stdout);
	}
	printf("wood: %d of %d failed\n", failed, argc - 1);
	return failed > 0;
}
