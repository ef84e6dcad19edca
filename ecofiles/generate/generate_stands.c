/* Layouts with a given number of plants, for measuring. Each is a table of species: share, distance and
 * patches. Stands come from dart throwing, the plants that need most room first; where no room is found, a
 * plant takes less, so that the number holds. A ride stays free; the camera flies in over the stand and
 * then walks along the ride.
 *
 * They follow the scenes of Deussen 2002 (table 1) and of Neubert 2011: hundreds to thousands of trees,
 * palms, a field of sunflowers. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/generate/generate_plants.h"
#include "ecofiles/generate/generate_scenes.h"

struct stock {
	const char *plant;
	double share, room_m;
	double low_m, high_m;                /* heights */
	double patch_m;                      /* size of its patches; 0: anywhere */
};

struct stand_kind {
	const char *name;
	const struct stock *stocks;          /* the one that needs most room first */
	uint32_t count;
	double plant_m2;                     /* ground per plant, on average */
	double ride_m;                       /* half the ride's width */
	struct gen_terrain terrain;
	const char *lone;                    /* one plant in the middle, with room around it; or NULL */
	double lone_room_m, lone_m;
	uint32_t tile;
};

/* The ride: a winding line through the middle. */
static double ride_y(double x, double half_m)
{
	double t = x / half_m;
	return 0.3 * x * (1 - t * t) - 0.06 * half_m;
}

static bool on_ride(double x, double y, double half_m, double width_m)
{
	return fabs(y - ride_y(x, half_m)) < width_m;
}

static bool in_patch(const struct stock *s, uint64_t seed, double x, double y, struct gen_random *random)
{
	return s->patch_m <= 0 || gen_noise(seed, x / s->patch_m, y / s->patch_m)
		+ gen_random_in(random, -0.15, 0.15) > 0.5;
}

#define THROWS 800u
#define THROWS_STRICT 40u        /* after so many throws the room asked for shrinks */

static void plant_stock(struct gen_layout *layout, const struct stand_kind *kind, uint32_t which,
	uint32_t wanted, double half_m, struct gen_stand *stand, FILE *out)
{
	const struct stock *s = &kind->stocks[which];
	uint64_t seed = layout->options->seed + 41 + which;
	for (uint32_t i = 0; i < wanted; i++) {
		double room = s->room_m * gen_random_in(&layout->random, 0.85, 1.15);
		for (uint32_t throw = 0; throw < THROWS; throw++, room *= throw > THROWS_STRICT ? 0.985 : 1) {
			double x = gen_random_in(&layout->random, -half_m, half_m),
				y = gen_random_in(&layout->random, -half_m, half_m);
			double free_m = kind->ride_m + (s->room_m > 2 ? 0.3 * s->room_m : 0);
			/* a small scene may have no patch */
			bool patch = throw > THROWS / 2 || in_patch(s, seed, x, y, &layout->random);
			if (on_ride(x, y, half_m, free_m) || !patch || !gen_stand_add(stand, x, y, room))
				continue;
			fprintf(out, "%s,%.2f,%.2f,%.2f\n", s->plant, GEN_EASTING + x, GEN_NORTHING + y,
				gen_random_in(&layout->random, s->low_m, s->high_m));
			break;
		}
	}
}

/* Splits the number of plants by the shares, into whole numbers that add up. */
static void write_plants(struct gen_layout *layout, const struct stand_kind *kind, double half_m)
{
	struct gen_stand stand;
	double room = fmax(kind->stocks[0].room_m * 1.2, kind->lone_room_m), sum = 0;
	uint32_t left = layout->plants, planted = 0;
	gen_stand_open(&stand, layout->plants + 1, half_m, room);
	FILE *out = gen_open(layout);
	fputs("plant,easting,northing,height_m\n", out);
	if (kind->lone) {
		double y = 0.3 * half_m;
		gen_stand_add(&stand, 0, y, kind->lone_room_m);
		fprintf(out, "%s,%.2f,%.2f,%.2f\n", kind->lone, GEN_EASTING, GEN_NORTHING + y, kind->lone_m);
		left--;
	}
	for (uint32_t i = 0; i < kind->count; i++) {
		gen_progress(layout, "plants", 0.85 + 0.15 * sum);
		sum += kind->stocks[i].share;
		uint32_t until = i + 1 == kind->count ? left : (uint32_t)(left * sum + 0.5);
		plant_stock(layout, kind, i, until - planted, half_m, &stand, out);
		planted = until;
	}
	gen_close(layout, out, "plants.csv");
	gen_stand_close(&stand);
}

/* ---- The camera: over the stand, down, and along the ride at the height of a walker's eyes ---- */

#define FLIGHT 4u
#define WALK 25u

static void make_looks(double half_m, double tall_m, struct gen_look looks[FLIGHT + WALK])
{
	const struct gen_look flight[FLIGHT] = {
		{ 0, { 0.85 * half_m, -1.25 * half_m - 20, 0.45 * half_m + 2.2 * tall_m },
			{ 0, -0.1 * half_m, 0.4 * tall_m }, 45 },
		{ 3, { -0.5 * half_m, -1.15 * half_m - 15, 0.3 * half_m + 1.8 * tall_m },
		{ 0.1 * half_m, 0, 0.4 * tall_m }, 45 },
		{ 6, { -1.1 * half_m - 10, -0.4 * half_m, 0.15 * half_m + 1.4 * tall_m },
		{ 0, 0, 0.4 * tall_m }, 50 },
		{ 8, { -1.0 * half_m - 5, ride_y(-half_m, half_m), 0.5 * tall_m + 2 },
		{ -0.4 * half_m, ride_y(-0.4 * half_m, half_m), 0.3 * tall_m }, 55 } };
	memcpy(looks, flight, sizeof flight);
	for (uint32_t i = 0; i < WALK; i++) {
		double x = half_m * (-0.9 + 1.5 * i / (WALK - 1.0)), ahead = x + fmax(0.25 * half_m, 6);
		looks[FLIGHT + i] = (struct gen_look){ 10 + i, { x, ride_y(x, half_m), 1.7 },
			{ ahead, ride_y(ahead, half_m), 1.7 + 0.08 * tall_m }, 58 };
	}
}

#define NAMES_MAX 16

static void list_names(const struct stand_kind *kind, const char *names[NAMES_MAX])
{
	uint32_t count = 0;
	if (kind->lone)
		names[count++] = kind->lone;
	for (uint32_t i = 0; i < kind->count; i++) {
		uint32_t at = 0;
		while (at < count && strcmp(names[at], kind->stocks[i].plant) != 0)
			at++;
		if (at == count)
			names[count++] = kind->stocks[i].plant;
	}
	names[count] = NULL;
}

static void write_stand(struct gen_layout *layout, const struct stand_kind *kind)
{
	const char *names[NAMES_MAX];
	struct gen_look looks[FLIGHT + WALK];
	struct gen_terrain terrain = kind->terrain;
	double half_m = fmax(0.5 * sqrt(layout->plants * kind->plant_m2), 6), tall_m = kind->lone_m;
	for (uint32_t i = 0; i < kind->count; i++)
		tall_m = fmax(tall_m, kind->stocks[i].high_m);
	terrain.seed += layout->options->seed;
	list_names(kind, names);
	make_looks(half_m, tall_m, looks);
	gen_write_setting(layout,
		&(struct gen_setting){ names, &terrain, half_m + 160, 4, looks, FLIGHT + WALK });
	write_plants(layout, kind, half_m);
	gen_write_listed(layout, kind->name, kind->tile, names);
}

/* ---- Layouts ---- */

void gen_grove(struct gen_layout *layout)
{
	static const struct stock stocks[] = { { "oak", 0.08, 8.5, 11, 16, 0 },
		{ "linden", 0.22, 6, 9, 14, 60 }, { "beech", 0.12, 6, 16, 24, 80 },
		{ "maple", 0.20, 5.5, 13, 21, 0 }, { "spruce", 0.20, 4.5, 10, 19, 50 },
		{ "birch", 0.18, 4, 9, 15, 40 } };
	write_stand(layout, &(struct stand_kind){ .name = "grove", .stocks = stocks, .count = 6,
		.plant_m2 = 52, .ride_m = 3, .terrain = { 43, 9, 190, 0.3, 60 }, .tile = 64 });
}

void gen_palms(struct gen_layout *layout)
{
	static const struct stock stocks[] = { { "palm", 1, 4.2, 5, 10, 0 } };
	write_stand(layout, &(struct stand_kind){ .name = "palms", .stocks = stocks, .count = 1,
		.plant_m2 = 27, .ride_m = 2, .terrain = { 47, 4, 160, 0.4, 30 }, .tile = 64 });
}

void gen_sunflowers(struct gen_layout *layout)
{
	static const struct stock stocks[] = { { "sunflower", 1, 0.42, 1.3, 2.1, 0 } };
	write_stand(layout, &(struct stand_kind){ .name = "sunflowers", .stocks = stocks, .count = 1,
		.plant_m2 = 0.42, .ride_m = 0.9, .terrain = { 53, 3, 130, 0.1, 25 }, .lone = "maple",
		.lone_room_m = 9, .lone_m = 17, .tile = 128 });
}

void gen_outdoor(struct gen_layout *layout)
{
	static const struct stock stocks[] = { { "oak", 0.012, 9, 11, 16, 110 },
		{ "linden", 0.014, 6.5, 9, 14, 90 }, { "beech", 0.018, 6, 16, 24, 120 },
		{ "spruce", 0.040, 4.2, 8, 19, 70 }, { "pine", 0.016, 5, 12, 19, 80 },
		{ "birch", 0.020, 4, 8, 15, 50 }, { "shrub", 0.06, 2.2, 1, 2.8, 25 },
		{ "azalea", 0.02, 1.9, 0.9, 1.7, 20 }, { "fern", 0.10, 0.8, 0.4, 0.8, 18 },
		{ "grass", 0.30, 0.55, 0.4, 0.8, 14 },
		{ "poppy", 0.14, 0.4, 0.35, 0.6, 10 }, { "daisy", 0.14, 0.4, 0.35, 0.6, 12 },
		{ "cornflower", 0.12, 0.4, 0.35, 0.6, 9 } };
	write_stand(layout, &(struct stand_kind){ .name = "outdoor", .stocks = stocks, .count = 13,
		.plant_m2 = 6, .ride_m = 1.8, .terrain = { 59, 16, 240, 0.4, 40 }, .tile = 128 });
}

/* ---- City ---- */

/* A city: a square grid of streets with trees on both sides, about ten metres apart, here and there one
 * missing. The trees are few crossed cards with leaves cut out by alpha, as models of games and cities are.
 * The camera flies in over the roofs that are not there and then walks along the middle street. */

#define BLOCK_M 90.0             /* from street to street */
#define STREET_M 6.0             /* from its middle to a row of trees */
#define ROW 8u                   /* trees in a row of a block */
#define PLACES (4 * ROW)         /* of a block: two rows along x, two along y */
#define PLANTED 28u              /* about so many of them have a tree */
#define LOOKS 12u

static const char *const city_names[] = { "cards-1", "cards-2", "cards-3", NULL };

static void print_tree(struct gen_layout *layout, double along, double across, bool turned, FILE *out)
{
	double x = along + gen_random_in(&layout->random, -0.8, 0.8),
		y = across + gen_random_in(&layout->random, -0.5, 0.5);
	fprintf(out, "%s,%.2f,%.2f,%.2f\n", city_names[gen_random_bits(&layout->random) % 3],
		GEN_EASTING + (turned ? y : x), GEN_NORTHING + (turned ? x : y),
		gen_random_in(&layout->random, 8, 13));
}

/* Each place has a tree with the share of trees left to places left, so that the number holds. */
static void write_trees(struct gen_layout *layout, uint32_t blocks)
{
	double half_m = 0.5 * BLOCK_M * blocks;
	uint64_t places = (uint64_t)blocks * blocks * PLACES, left = layout->plants;
	FILE *out = gen_open(layout);
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
	gen_write_setting(layout,
		&(struct gen_setting){ city_names, &terrain, half_m + 160, 5, looks, LOOKS });
	gen_progress(layout, "plants", 0.85);
	write_trees(layout, blocks);
	gen_write_listed(layout, "city", 64, city_names);
}
