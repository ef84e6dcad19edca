/* A forest of any size from a few files: hectares of a thousand plants, blocks of ten times ten hectares,
 * blocks of ten times ten blocks, and so on, up to the number of plants asked for. Hectares and blocks are
 * squares turned by quarters, so that they tile. Each size has three kinds, placed by slow noise, so that
 * there are patterns to see at every height. The files grow with the logarithm of the number of plants:
 * 10^12 plants take five files of each kind.
 *
 * A ride between hectares stays free. The first camera stands on a crossing of two rides, the last at a
 * satellite's height. */
#include "ecofiles/generate/generate_scenes.h"

#include <math.h>
#include <stdio.h>

#include "ecofiles/base/random.h"

#define KINDS 3
#define HECTARE_M 100.0
#define HECTARE_PLANTS 1000u
#define RIDE_M 2.5               /* free on each side of a hectare's border */
#define SIDE 10u                 /* blocks are SIDE x SIDE of the size below */

struct share { const char *plant; double share, room_m, low, high; };

/* Species that need most room come first. Every kind has every species, in other shares. */
#define SPECIES 6
static const struct share hectares[KINDS][SPECIES] = {
	{ { "beech", 0.10, 5.2, 0.8, 1.1 }, { "spruce", 0.34, 3.4, 0.6, 1.1 },
		{ "pine", 0.06, 4.5, 0.8, 1.1 }, { "birch", 0.04, 3.4, 0.7, 1.0 },
		{ "shrub", 0.10, 1.8, 0.5, 1.2 }, { "fern", 0.36, 0.9, 0.7, 1.3 } },
	{ { "beech", 0.28, 4.6, 0.7, 1.1 }, { "spruce", 0.05, 3.8, 0.6, 1.0 },
	{ "pine", 0.02, 4.5, 0.8, 1.0 }, { "birch", 0.10, 3.6, 0.7, 1.0 },
		{ "shrub", 0.25, 1.8, 0.5, 1.2 }, { "fern", 0.30, 0.9, 0.7, 1.3 } },
	{ { "beech", 0.03, 6, 0.6, 0.9 }, { "spruce", 0.04, 4, 0.4, 0.8 }, { "pine", 0.13, 5, 0.7, 1.1 },
	{ "birch", 0.15, 4, 0.6, 1.0 },
		{ "shrub", 0.40, 2, 0.6, 1.3 }, { "fern", 0.25, 0.9, 0.7, 1.3 } },
};
#define NAME_BYTES 40
static void file_name(char name[NAME_BYTES], uint32_t level, uint32_t kind)
{
	if (level > 0)
		snprintf(name, NAME_BYTES, "block-%u-%u.json", level, kind);
	else
		snprintf(name, NAME_BYTES, "hectare-%u.json", kind);
}

static double side_m(uint32_t level)
{
	double side = HECTARE_M;
	while (level-- > 0)
		side *= SIDE;
	return side;
}

static const char *const species[] = { "beech", "spruce", "pine", "birch", "shrub", "fern", NULL };

/* A species' share of the throws sets its number: where no room is found, a plant takes less room. */
static void plant_kind(struct gen_layout *layout, const struct share *kind, uint32_t wanted,
	struct gen_stand *stand, FILE *out, bool *first)
{
	double half_m = HECTARE_M / 2 - RIDE_M;
	for (uint32_t i = 0; i < wanted; i++) {
		double room = kind->room_m * gen_random_in(&layout->random, 0.85, 1.15);
		for (uint32_t throw = 0; throw < 800; throw++, room *= throw > 60 ? 0.985 : 1) {
			double x = gen_random_in(&layout->random, -half_m, half_m),
				y = gen_random_in(&layout->random, -half_m, half_m);
			if (!gen_stand_add(stand, x, y, room))
				continue;
			fprintf(out, "%s\n    {\"plant\": \"%s\", \"at\": [%.2f, %.2f, 0], \"yaw_deg\": %u, "
				"\"scale\": %.3f}", *first ? "" : ",", kind->plant, x, y,
				(uint32_t)(gen_random_bits(&layout->random) % 360),
				gen_random_in(&layout->random, kind->low, kind->high));
			*first = false;
			break;
		}
	}
}

static void write_hectare(struct gen_layout *layout, uint32_t kind, uint32_t plants)
{
	struct gen_stand stand;
	char name[NAME_BYTES];
	bool first = true;
	double sum = 0;
	uint32_t planted = 0;
	gen_stand_open(&stand, plants, HECTARE_M / 2, 7);
	FILE *out = gen_open(layout);
	fprintf(out, "{\n  \"name\": \"hectare-%u\",\n", kind);
	gen_print_plants(out, species);
	fputs("  \"instances\": [", out);
	for (uint32_t i = 0; i < SPECIES; i++) {
		sum += hectares[kind][i].share;
		uint32_t until = i + 1 == SPECIES ? plants : (uint32_t)(plants * sum + 0.5);
		plant_kind(layout, &hectares[kind][i], until - planted, &stand, out, &first);
		planted = until;
	}
	fputs("\n  ]\n}\n", out);
	file_name(name, 0, kind);
	gen_close(layout, out, name);
	gen_stand_close(&stand);
}

/* Children in rows from the south-west, around the origin: the first `count` of columns x columns. Noise
 * and the parent's kind choose each child's kind. */
static void print_children(FILE *out, struct gen_layout *layout, uint32_t level, uint32_t kind,
	uint32_t columns, uint32_t count)
{
	uint32_t rows = (count + columns - 1) / columns;
	double each_m = side_m(level - 1);
	uint64_t seed = eco_random(layout->options->seed + 61, level * KINDS + kind);
	fputs("  \"children\": [", out);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t column = i % columns, row = i / columns;
		double pick = gen_noise(seed, column / 3.1, row / 3.1) + gen_random_in(&layout->random, -0.1,
			0.1);
		uint32_t of = pick < 0.36 ? (kind + 1) % KINDS : pick > 0.64 ? (kind + 2) % KINDS : kind;
		char eco[NAME_BYTES];
		file_name(eco, level - 1, of);
		fprintf(out, "%s\n    {\"eco\": \"%s\", \"at\": [%.0f, %.0f, 0], \"yaw_deg\": %u}",
			i ? "," : "", eco, (column - 0.5 * columns + 0.5) * each_m,
			(row - 0.5 * rows + 0.5) * each_m,
			90 * (uint32_t)(gen_random_bits(&layout->random) % 4));
	}
	fputs("\n  ]\n}\n", out);
}

static void write_block(struct gen_layout *layout, uint32_t level, uint32_t kind)
{
	char name[NAME_BYTES];
	FILE *out = gen_open(layout);
	fprintf(out, "{\n  \"name\": \"block-%u-%u\",\n", level, kind);
	print_children(out, layout, level, kind, SIDE, SIDE * SIDE);
	file_name(name, level, kind);
	gen_close(layout, out, name);
}

/* Camera heights, from a walker's eyes to a view of the whole, in equal ratios. */
#define HEIGHTS 6
#define EYE_M 1.7
#define SECOND_M 16.0

void gen_billion(struct gen_layout *layout)
{
	const struct gen_terrain flat = { layout->options->seed, 0, 1000, 0, 100 };
	uint64_t plants = layout->options->plants ? layout->options->plants : 1000000000u,
		count = (plants + HECTARE_PLANTS - 1) / HECTARE_PLANTS;
	uint32_t plants_each = (uint32_t)((plants + count - 1) / count), level = 1;
	while (count > SIDE * SIDE) {
		count = (count + SIDE * SIDE - 1) / (SIDE * SIDE);
		level++;
	}
	uint32_t columns = (uint32_t)ceil(sqrt((double)count));
	double half_m = 0.5 * columns * side_m(level - 1);
	struct gen_look looks[HEIGHTS] = { { 0, { 0.5, -40, EYE_M }, { 1.5, 0, 4 }, 55 } };
	double times = pow(1.7 * half_m / SECOND_M, 1.0 / (HEIGHTS - 2)), h = SECOND_M;
	for (uint32_t i = 1; i < HEIGHTS; i++, h *= times)
		looks[i] = (struct gen_look){ i, { 0.3 * h, -1.4 * h, h }, { 0, i > 1 ? 0 : 30, 0 }, 50 };
	gen_write_setting(layout,
		&(struct gen_setting){ species, &flat, half_m * 1.25, half_m / 4, looks, HEIGHTS });
	for (uint32_t kind = 0; kind < KINDS; kind++)
		write_hectare(layout, kind, plants_each);
	for (uint32_t l = 1; l < level; l++)
		for (uint32_t kind = 0; kind < KINDS; kind++)
			write_block(layout, l, kind);
	FILE *out = gen_open(layout);
	fputs("{\n  \"name\": \"billion\", \"crs\": \"" GEN_CRS
		"\", \"ground\": {\"heights\": \"dem.tif\"},\n", out);
	fprintf(out, "  \"origin\": [%.0f, %.0f, %.0f],\n", GEN_EASTING, GEN_NORTHING, GEN_ALTITUDE);
	print_children(out, layout, level, 0, columns, (uint32_t)count);
	gen_close(layout, out, "scene.json");
}
