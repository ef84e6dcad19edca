/* Layouts that look like landscapes: plants stand in groups, along curves and at distances that suit their
 * sizes.
 *
 * park    beds (a plant, a place, a radius, a number) filled by dart throwing, and an avenue along a
 * winding path forest  large trees first, then smaller ones, none closer to another than their crowns
 * allow (a hard-core process, as
 *         in grown stands); slow noise chooses the species, so that groups form
 * meadow  eco files of a few square metres, placed many times with a turn; flowers by slow noise, a few
 * trees */
#include "ecofiles/generate/generate_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/generate/generate_plants.h"

/* ---- Plants one by one ---- */

struct gen_instance { const char *plant; double x, y, yaw_deg, scale; };

/* ---- Park ---- */

struct bed { const char *plant; double x, y, radius; uint32_t count; double room, small, large; };

static const struct bed park_beds[] = {
	{ "oak", 21, -13, 5, 1, 11, 0.95, 1.05 }, { "oak", -25, 19, 8, 2, 11, 0.8, 1.05 },
	{ "birch", 25, 17, 5, 3, 4, 0.8, 1.1 },
	{ "spruce", -1, 32, 12, 7, 5, 0.6, 1.1 },
	{ "palm", -19, -17, 5, 3, 4, 0.75, 1.1 },
	{ "shrub", 10, 18, 7, 5, 2.4, 0.6, 1.2 }, { "azalea", -9, -20, 5, 4, 2.1, 0.8, 1.3 },
	{ "grass", 2, -10, 5, 6, 0.8, 0.9, 1.6 }, { "grass", 12, -7, 3, 3, 0.9, 0.9, 1.5 },
	{ "turf", 0, -13, 4, 5, 1.4, 0.9, 1.1 },
	{ "daisy", 2, -14, 2, 4, 0.5, 0.9, 1.3 }, { "poppy", -3, -13, 2, 4, 0.5, 0.9, 1.3 },
	{ "cornflower", 4, -12, 2, 3, 0.5, 0.9, 1.3 },
};
#define PARK_PLANTS 60
#define PARK_HALF_M 40.0         /* half the side of the planted square */
#define AVENUE 10

static double path_y(double x, double span) { double t = x / span; return 0.42 * x * (1 - t * t); }

static bool on_path(double x, double y, double span)
{
	return fabs(x) < span && fabs(y - path_y(x, span)) < 2.4;
}

static double turn_anyhow(struct gen_random *random) { return floor(gen_random_in(random, 0, 3600)) / 10; }

/* Plants `wanted` plants of a bed; a plant that finds no room within many throws is left out. */
static uint32_t plant_bed(struct gen_layout *layout, const struct bed *bed, double stretch, uint32_t wanted,
	struct gen_stand *stand, struct gen_instance *out)
{
	uint32_t count = 0;
	for (uint32_t throw = 0; throw < 60 * wanted && count < wanted; throw++) {
		struct gen_v3 way = gen_heading(gen_random_in(&layout->random, 0, 360), 0);
		double r = bed->radius * stretch * sqrt(gen_random_unit(&layout->random));
		double x = bed->x * stretch + r * way.x, y = bed->y * stretch + r * way.y;
		if (on_path(x, y, PARK_HALF_M * stretch) || !gen_stand_add(stand, x, y, bed->room))
			continue;
		out[count++] = (struct gen_instance){ bed->plant, x, y, turn_anyhow(&layout->random),
			gen_random_in(&layout->random, bed->small, bed->large) };
	}
	return count;
}

static uint32_t plant_avenue(struct gen_layout *layout, double stretch, uint32_t wanted,
	struct gen_stand *stand, struct gen_instance *out)
{
	double span = PARK_HALF_M * stretch;
	uint32_t count = 0;
	for (uint32_t i = 0; i < wanted; i++) {
		double x = (2 * ((i / 2) + 0.5) / ((wanted + 1) / 2) - 1) * 0.8 * span, side = i % 2 ? 1 : -1;
		x += gen_random_in(&layout->random, -0.8, 0.8);
		double slope = (path_y(x + 0.5, span) - path_y(x - 0.5, span)),
			length = sqrt(1 + slope * slope);
		double y = path_y(x, span) + side * 4.6 / length;
		x -= side * 4.6 * slope / length;
		if (gen_stand_add(stand, x, y, 6))
			out[count++] = (struct gen_instance){ "linden", x, y, turn_anyhow(&layout->random),
				gen_random_in(&layout->random, 0.85, 1.08) };
	}
	return count;
}

/* Plants one by one, and then the scene's. */
static void print_scene(FILE *out, const char *name, uint32_t tile_instances, const char *const names[],
	const struct gen_instance *instances, uint32_t count)
{
	if (tile_instances)
		gen_print_head(out, name, tile_instances);
	else
		fprintf(out, "{\n  \"name\": \"%s\",\n", name);
	gen_print_plants(out, names);
	fputs("  \"instances\": [", out);
	for (uint32_t i = 0; i < count; i++)
		fprintf(out, "%s\n    {\"plant\": \"%s\", \"at\": [%.2f, %.2f, 0], \"yaw_deg\": %.1f, "
			"\"scale\": %.3f}", i ? "," : "", instances[i].plant, instances[i].x, instances[i].y,
			instances[i].yaw_deg, instances[i].scale);
	fputs("\n  ]", out);
}

void gen_park(struct gen_layout *layout)
{
	static const char *const names[] = { "oak", "linden", "birch", "spruce", "palm", "shrub", "azalea",
		"grass", "turf", "daisy", "poppy", "cornflower", NULL };
	double share = (double)layout->plants / PARK_PLANTS, stretch = share > 1 ? sqrt(share) : 1;
	struct gen_terrain terrain = { layout->options->seed + 11, 9, 105, 0.5, 21 };
	struct gen_stand stand;
	const struct gen_look looks[] = {
		{ 0, { 36 * stretch, -46 * stretch, 24 * stretch }, { -1, 1, 0 }, 42 },
		{ 3, { 13, -36, 7 }, { -2, 0, 4 }, 45 },
		{ 6, { 5, -22.5, 1.7 }, { -1, -6, 2.2 }, 50 },
		{ 7, { 2.5, -18.6, 1.2 }, { -0.4, -12, 0.6 }, 50 } };
	gen_write_setting(layout, &(struct gen_setting){ names, &terrain, 220 + 60 * stretch, 4, looks, 4 });
	struct gen_instance *instances = eco_alloc((size_t)layout->plants + 64, sizeof *instances);
	gen_stand_open(&stand, layout->plants + 64, 50 * stretch, 11);
	uint32_t count = plant_avenue(layout, stretch, (uint32_t)(AVENUE * share + 0.5), &stand, instances);
	for (size_t i = 0; i < sizeof park_beds / sizeof *park_beds && count < layout->plants; i++) {
		uint32_t wanted = (uint32_t)(park_beds[i].count * share + 0.5), left = layout->plants - count;
		count += plant_bed(layout, &park_beds[i], stretch, wanted < left ? wanted : left, &stand,
			instances + count);
	}
	FILE *out = gen_open(layout);
	print_scene(out, "park", 16, names, instances, count);
	fputs("\n}\n", out);
	gen_close(layout, out, "scene.json");
	gen_stand_close(&stand);
	free(instances);
}

/* ---- Forest ---- */

static const struct species { const char *code, *plant; double niche; } forest_species[] = {
	{ "FASY", "beech", 0.15 }, { "ACPS", "maple", 0.35 }, { "BEPE", "birch", 0.55 },
		{ "PISY", "pine", 0.72 }, { "PIAB", "spruce", 0.9 },
};
#define SPECIES (sizeof forest_species / sizeof *forest_species)

/* Slow noise is the site. Each species prefers one value; chance decides among species near the site's. */
static const struct species *species_at(uint64_t seed, double x, double y, struct gen_random *random)
{
	double site = gen_clamp(1.6 * (gen_noise(seed, x / 45, y / 45) - 0.5) + 0.5, 0, 1), weight[SPECIES],
		sum = 0;
	for (size_t i = 0; i < SPECIES; i++) {
		double d = (site - forest_species[i].niche) / 0.17;
		sum += weight[i] = 1 / (0.03 + d * d * d * d + 0.2 * d * d);
	}
	double pick = gen_random_unit(random) * sum;
	for (size_t i = 0; i + 1 < SPECIES; i++)
		if ((pick -= weight[i]) < 0)
			return &forest_species[i];
	return &forest_species[SPECIES - 1];
}

/* Stem diameters for dart throwing, the thickest first: many thin stems and few thick ones. */
static double stem_mm(double rank)
{
	double thin = 1 - rank;
	return 70 + 560 * thin * thin * (0.25 + 0.75 * thin);
}

static void write_stems(struct gen_layout *layout, uint32_t trees, double half_m, struct gen_stand *stand)
{
	uint64_t site_seed = layout->options->seed + 29;
	FILE *out = gen_open(layout);
	fputs("tag,species,easting,northing,dbh_mm\n", out);
	for (uint32_t i = 0, tag = 1; i < trees; i++) {
		double dbh = stem_mm((i + 0.5) / trees) * gen_random_in(&layout->random, 0.92, 1.08),
			room = 1.3 + 0.0080 * dbh;
		/* plants every stem asked for: where no room is found, the stem takes less room */
		for (int attempt = 0; attempt < 600; attempt++, room *= attempt > 24 ? 0.98 : 1) {
			double x = gen_random_in(&layout->random, -half_m, half_m),
				y = gen_random_in(&layout->random, -half_m, half_m);
			if (!gen_stand_add(stand, x, y, room))
				continue;
			fprintf(out, "%u,%s,%.2f,%.2f,%.0f\n", tag++,
				species_at(site_seed, x, y, &layout->random)->code, GEN_EASTING + x,
				GEN_NORTHING + y, dbh);
			break;
		}
		if (i % 65536 == 65535)
			gen_progress(layout, "stems", 0.85 + 0.1 * i / trees);
	}
	gen_close(layout, out, "stems.csv");
}

/* Shrubs and ferns grow in patches where slow noise lets light in. */
static void write_understory(struct gen_layout *layout, uint32_t wanted, double half_m,
	struct gen_stand *stand)
{
	uint64_t seed = layout->options->seed + 31;
	FILE *out = gen_open(layout);
	fputs("plant,easting,northing,height_m\n", out);
	for (uint64_t throw = 0, count = 0; throw < 2000ull * wanted && count < wanted; throw++) {
		/* in the end also in the shade, and closer */
		double crowding = throw / (8.0 * wanted), ease = crowding > 1 ? 1 / crowding : 1;
		double x = gen_random_in(&layout->random, -half_m, half_m),
			y = gen_random_in(&layout->random, -half_m, half_m);
		double light = gen_noise(seed, x / 14, y / 14);
		bool fern = gen_noise(seed + 1, x / 22, y / 22) + gen_random_in(&layout->random, -0.15, 0.15)
			> 0.45;
		if (light + gen_random_in(&layout->random, -0.2, 0.2) < 0.5 * ease
				|| !gen_stand_add(stand, x, y, (fern ? 0.8 : 1.7) * ease))
			continue;
		fprintf(out, "%s,%.2f,%.2f,%.2f\n", fern ? "fern" : "shrub", GEN_EASTING + x,
			GEN_NORTHING + y, fern ? gen_random_in(&layout->random, 0.4, 0.75)
			: gen_random_in(&layout->random, 1.0, 2.6));
		count++;
	}
	gen_close(layout, out, "understory.csv");
}

static void print_forest(FILE *out, const char *const names[])
{
	gen_print_head(out, "forest", 128);
	gen_print_plants(out, names);
	fputs("  \"instances\": [\n    {\"from\": \"stems.csv\", \"x\": \"easting\", \"y\": \"northing\", "
		"\"crs\": \"" GEN_CRS "\", "
		"\"species\": \"species\",\n"
		"     \"map\": {", out);
	for (size_t i = 0; i < SPECIES; i++)
		fprintf(out, "%s\"%s\": \"%s\"", i ? ", " : "", forest_species[i].code,
			forest_species[i].plant);
	fputs("},\n     \"height_m\": {\"from_dbh_mm\": \"dbh_mm\", \"max\": 31, \"rate\": 0.0042, "
		"\"levels\": 8}, \"seed\": 1},\n", out);
	fputs("    {\"from\": \"understory.csv\", \"x\": \"easting\", \"y\": \"northing\", \"crs\": "
		"\"" GEN_CRS "\", \"species\": \"plant\",\n"
		"     \"map\": {\"shrub\": \"shrub\", \"fern\": \"fern\"}, \"height_m\": {\"column\": "
		"\"height_m\"}, \"seed\": 2}\n  ]\n}\n", out);
}

void gen_forest(struct gen_layout *layout)
{
	static const char *const names[] = { "beech", "maple", "birch", "pine", "spruce", "shrub", "fern",
		NULL };
	uint32_t low = layout->plants / 3, trees = layout->plants - low;
	double half_m = fmax(0.5 * sqrt(trees / 0.060), 8);          /* 600 stems a hectare */
	struct gen_terrain terrain = { layout->options->seed + 13, 38, 170, 5, 48 };
	struct gen_stand stand;
	const struct gen_look looks[] = {
		{ 0, { 0.6 * half_m, -half_m - 60, 0.55 * half_m + 45 }, { 0, -0.1 * half_m, 8 }, 45 },
		{ 3, { 0.25 * half_m, -1.0 * half_m - 30, 18 }, { 0, 0, 10 }, 48 },
		{ 6, { 0, -half_m - 4, 1.7 }, { -4, -half_m + 26, 6 }, 60 } };
	gen_write_setting(layout, &(struct gen_setting){ names, &terrain, half_m + 200, 5, looks, 3 });
	gen_stand_open(&stand, layout->plants, half_m, 6.9);
	gen_progress(layout, "stems", 0.85);
	write_stems(layout, trees, half_m, &stand);
	write_understory(layout, low, half_m, &stand);
	gen_stand_close(&stand);
	FILE *out = gen_open(layout);
	print_forest(out, names);
	gen_close(layout, out, "scene.json");
}

/* ---- Meadow ---- */

#define PATCH_M 5.0
#define PATCH_PLANTS 52

/* Kinds of patches: plants, and their shares. */
static const struct patch { const char *name, *plants[5]; double shares[4]; } patches[] = {
	{ "grasses", { "grass", "turf", "cornflower", NULL }, { 0.48, 0.48, 0.04 } },
	{ "daisies", { "grass", "turf", "daisy", NULL }, { 0.3, 0.38, 0.32 } },
	{ "poppies", { "grass", "turf", "poppy", "cornflower", NULL }, { 0.36, 0.32, 0.26, 0.06 } } };
#define PATCHES (sizeof patches / sizeof *patches)

/* An eco file around its origin: grasses of two kinds, and the flowers of the patch's kind. */
static void write_patch(struct gen_layout *layout, const struct patch *patch)
{
	struct gen_instance instances[PATCH_PLANTS];
	struct gen_stand stand;
	char path[64];
	gen_stand_open(&stand, PATCH_PLANTS, PATCH_M, 1);
	for (uint32_t throw = 0; throw < 4000 && stand.count < PATCH_PLANTS; throw++) {
		/* a disc a little larger than the patch's share of the meadow, so that turned patches
		 * leave no gaps */
		double azimuth = gen_random_in(&layout->random, 0, 360),
			r = 0.66 * PATCH_M * sqrt(gen_random_unit(&layout->random));
		double x = r * gen_heading(azimuth, 0).x, y = r * gen_heading(azimuth, 0).y;
		double pick = gen_random_unit(&layout->random);
		uint32_t kind = 0, at = stand.count;
		while (patch->plants[kind + 1] && (pick -= patch->shares[kind]) >= 0)
			kind++;
		if (gen_stand_add(&stand, x, y, throw < 2000 ? 0.62 : 0.4))
			instances[at] = (struct gen_instance){ patch->plants[kind], x, y,
				turn_anyhow(&layout->random), gen_random_in(&layout->random, 0.75, 1.25) };
	}
	FILE *out = gen_open(layout);
	print_scene(out, patch->name, 0, patch->plants, instances, stand.count);
	fputs("\n}\n", out);
	snprintf(path, sizeof path, "%s.json", patch->name);
	gen_close(layout, out, path);
	gen_stand_close(&stand);
}

static void print_patches(FILE *out, struct gen_layout *layout, double half_m)
{
	uint64_t seed = layout->options->seed + 37;
	bool first = true;
	for (double y = -half_m + PATCH_M / 2; y < half_m; y += PATCH_M) {
		for (double x = -half_m + PATCH_M / 2; x < half_m; x += PATCH_M) {
			double color = gen_noise(seed, x / 17, y / 17) + gen_random_in(&layout->random, -0.12,
				0.12);
			uint32_t kind = color > 0.64 ? 2 : color < 0.36 ? 1 : 0;
			fprintf(out, "%s\n    {\"eco\": \"%s.json\", \"at\": [%.2f, %.2f, 0], \"yaw_deg\": "
				"%u, \"scale\": %.3f}", first ? "" : ",", patches[kind].name,
				x + gen_random_in(&layout->random, -0.5, 0.5),
				y + gen_random_in(&layout->random, -0.5, 0.5),
				(uint32_t)(gen_random_bits(&layout->random) % 360),
				gen_random_in(&layout->random, 0.92, 1.1));
			first = false;
		}
	}
}

void gen_meadow(struct gen_layout *layout)
{
	static const char *const names[] = { "oak", "birch", "shrub", "grass", "turf", "daisy", "poppy",
		"cornflower", NULL };
	static const char *const trees[] = { "oak", "birch", "shrub", NULL };
	double half_m = 0.5 * PATCH_M * ceil(sqrt((double)layout->plants / PATCH_PLANTS));
	struct gen_terrain terrain = { layout->options->seed + 17, 4, 95, 0.15, 25 };
	struct gen_instance standing[48];
	struct gen_stand stand;
	uint32_t count = 0, wanted = (uint32_t)gen_clamp(6 + layout->plants / 2000.0, 6, 48);
	const struct gen_look looks[] = {
		{ 0, { 0.7 * half_m, -1.5 * half_m - 8, 0.6 * half_m + 6 }, { 0, 0, 0 }, 45 },
		{ 3, { 0.2 * half_m, -half_m - 4, 4 }, { 0, 0, 1 }, 50 },
		{ 6, { 0, -0.6 * half_m, 1.2 }, { -1, -0.6 * half_m + 9, 0.5 }, 55 } };
	gen_write_setting(layout, &(struct gen_setting){ names, &terrain, half_m + 160, 4, looks, 3 });
	for (size_t i = 0; i < PATCHES; i++)
		write_patch(layout, &patches[i]);
	gen_stand_open(&stand, 48, half_m, 9);
	for (uint32_t throw = 0; throw < 4000 && count < wanted; throw++) {
		const char *plant = trees[gen_random_bits(&layout->random) % 3];
		double x = gen_random_in(&layout->random, -half_m, half_m),
			y = gen_random_in(&layout->random, 0.1 * half_m, half_m);
		if (gen_stand_add(&stand, x, y, 9))
			standing[count++] = (struct gen_instance){ plant, x, y, turn_anyhow(&layout->random),
				gen_random_in(&layout->random, 0.5, 0.95) };
	}
	FILE *out = gen_open(layout);
	print_scene(out, "meadow", 32, trees, standing, count);
	fputs(",\n  \"children\": [", out);
	print_patches(out, layout, half_m);
	fputs("\n  ]\n}\n", out);
	gen_close(layout, out, "scene.json");
	gen_stand_close(&stand);
}
