/* A city: a square grid of streets with trees on both sides, about ten metres apart, here and there one
 * missing. The trees are few crossed cards with leaves cut out by alpha, as models of games and cities are.
 * The camera flies in over the roofs that are not there and then walks along the middle street. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/generate/generate_scenes.h"

#define BLOCK_M 90.0             /* from street to street */
#define STREET_M 6.0             /* from its middle to a row of trees */
#define ROW 8u                   /* trees in a row of a block */
#define PLACES (4 * ROW)         /* of a block: two rows along x, two along y */
#define PLANTED 28u              /* about so many of them have a tree */
#define LOOKS 12u

static const char *const names[] = { "cards-1", "cards-2", "cards-3", NULL };

static void print_tree(struct gen_layout *layout, double along, double across, bool turned, FILE *out)
{
	double x = along + gen_random_in(&layout->random, -0.8, 0.8),
		y = across + gen_random_in(&layout->random, -0.5, 0.5);
	fprintf(out, "%s,%.2f,%.2f,%.2f\n", names[gen_random_bits(&layout->random) % 3],
		GEN_EASTING + (turned ? y : x), GEN_NORTHING + (turned ? x : y),
		gen_random_in(&layout->random, 8, 13));
}

/* Each place has a tree with the share of trees left to places left, so that the number holds. */
static void write_trees(struct gen_layout *layout, uint32_t blocks)
{
	double half_m = 0.5 * BLOCK_M * blocks;
	uint64_t places = (uint64_t)blocks * blocks * PLACES, left = layout->plants;
	FILE *out = gen_open(layout);
	if (!out)
		return;
	fputs("plant,easting,northing,height_m\n", out);
	for (uint64_t i = 0; places; i++, places--) {
		uint64_t block = i / PLACES;
		uint32_t place = i % PLACES, row = place / ROW;
		double corner_x = (double)(block % blocks) * BLOCK_M - half_m,
			corner_y = (double)(block / blocks) * BLOCK_M - half_m,
			along = BLOCK_M * (place % ROW + 1.0) / (ROW + 1.0),
			across = 0.5 * BLOCK_M + (row % 2 ? STREET_M : -STREET_M);
		bool turned = row >= 2;
		if (!(gen_random_unit(&layout->random) * (double)places < (double)left))
			continue;
		print_tree(layout, along + (turned ? corner_y : corner_x),
			across + (turned ? corner_x : corner_y), turned, out);
		left--;
	}
	gen_close(layout, out, "plants.csv");
}

void gen_city(struct gen_layout *layout)
{
	uint32_t blocks = (uint32_t)ceil(sqrt((double)layout->plants / PLANTED));
	/* an odd number of blocks has a street through the origin, an even one half a block beside it */
	double half_m = 0.5 * BLOCK_M * blocks, street = blocks % 2 ? 0 : 0.5 * BLOCK_M;
	struct gen_terrain terrain = { layout->options->seed + 61, 6, 420, 0, 40 };
	struct gen_look looks[LOOKS] = {
		{ 0, { 0.6 * half_m, -1.3 * half_m - 40, 0.5 * half_m + 60 }, { 0, 0, 0 }, 45 },
		{ 3, { -0.3 * half_m, -0.9 * half_m - 30, 60 }, { 0, 0, 5 }, 50 },
		{ 6, { street - 60, -0.5 * half_m, 25 }, { street, 0, 5 }, 55 } };
	for (uint32_t i = 3; i < LOOKS; i++) {
		double y = half_m * (-0.4 + 0.08 * (i - 3));
		looks[i] = (struct gen_look){ 5 + i, { street, y, 1.7 }, { street, y + 40, 4 }, 58 };
	}
	gen_write_setting(layout, &(struct gen_setting){ names, &terrain, half_m + 160, 5, looks, LOOKS });
	if (gen_progress(layout, "plants", 0.85))
		write_trees(layout, blocks);
	gen_write_listed(layout, "city", 64, names);
}
