/* From scene files to packs, end to end: what stands where, what is shared, what is refused, and that a
 * failure leaves nothing. Longer than 600 lines: scenes are made once for all. */
#include <dirent.h>
#include <glob.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/impostor.h"
#include "ecofiles/import/model/gltf.h"
#include "lod/eye.h"
#include "tests/support/cases.h"
#include "tests/support/scene_packs.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

/* Drafts, since most tests are of where plants stand; only finished plants have impostors. */
static bool finished;

static enum eco_code make(const char *scene, const char *pack, uint32_t jobs, struct eco_error *error)
{
	char from[512], to[512];
	snprintf(from, sizeof from, "%s/%s", scratch_root, scene);
	snprintf(to, sizeof to, "%s/%s", scratch_root, pack);
	return make_pack(&(struct make_options){ .scene = from, .pack = to, .jobs = jobs, .draft = !finished,
		.order = finished ? LOD_ORDER_GREEDY : LOD_ORDER_COMBINED }, error);
}

static struct eco_pack *made(const char *scene, const char *pack)
{
	struct eco_error error = { 0 };
	struct eco_pack *opened = NULL;
	struct inspect_counts counts;
	FILE *out = tmpfile();
	assert_ok(make(scene, pack, 2, &error), error);
	assert_ok(inspect_verify(in_root(pack), out, &counts, &error), error);
	fclose(out);
	assert_int_equal(counts.damaged, 0);
	assert_int_equal(eco_pack_open(&opened, in_root(pack), &error), ECO_OK);
	return opened;
}

/* World position of every plant that stands directly in the outermost file. */
static uint32_t placed(const struct eco_scene *s, struct lod_place *place, uint32_t *plant, uint32_t most)
{
	static const struct eco_placement here = { .scale = 1 };
	uint32_t count = 0;
	for (uint32_t g = 0; g < s->group_count; g++) {
		for (uint32_t i = 0; i < s->groups[g].count && count < most; i++, count++) {
			struct eco_place stored = eco_place_read(s, s->groups[g].place_first + i);
			lod_place_instance(&place[count], &here, &s->lists[s->groups[g].list], &stored);
			plant[count] = s->groups[g].plant;
		}
	}
	return count;
}

static uint32_t standing(const struct eco_scene *s, double at[][3], uint32_t *plant, uint32_t most)
{
	struct lod_place place[128];
	uint32_t count = placed(s, place, plant, most < 128 ? most : 128);
	for (uint32_t i = 0; i < count; i++)
		memcpy(at[i], place[i].at, sizeof at[i]);
	return count;
}

/* ---- What is built ---- */

/* 120 of three kinds on a slope, in tiles of at most 20. */
static void write_slope(void)
{
	FILE *file = fopen(in_root("slope.json"), "wb");
	assert_non_null(file);
	fputs("{\"name\": \"slope\", \"origin\": [1000, 2000, 100], \"ground\": {\"heights\": "
		"\"slope.asc\"}, \"tile\": {\"instances\": 20},\n"
		"\"plants\": {\"a\": {\"model\": \"a.obj\"}, \"b\": {\"model\": \"b.obj\", \"height_m\": "
		"2.5}, \"again\": {\"model\": "
		"\"a.obj\"}},\n\"instances\": [", file);
	for (int i = 0; i < 120; i++)
		fprintf(file, "%s{\"plant\": \"%s\", \"at\": [%.3f, %.3f, %d], \"yaw_deg\": %d, \"scale\": "
			"%.2f}", i ? ",\n" : "", i % 3 == 0 ? "a" : i % 3 == 1
			? "b" : "again", (i * 37 % 101) * 0.83 - 40, (i * 59 % 103) * 0.71 - 35,
			i == 7 ? 2 : 0, i * 11 % 360, 0.5 + i % 10 * 0.1);
	fputs("]}\n", file);
	assert_int_equal(fclose(file), 0);
	file = fopen(in_root("slope.asc"), "wb");
	assert_non_null(file);
	fputs("ncols 21\nnrows 21\nxllcorner 945\nyllcorner 1945\ncellsize 5\nNODATA_value -9999\n", file);
	for (int r = 0; r < 21; r++)
		for (int c = 0; c < 21; c++)
			fprintf(file, "%.2f%c", 100 + c * 0.5 + (20 - r) * 0.25, c == 20 ? '\n' : ' ');
	assert_int_equal(fclose(file), 0);
}

static double slope_height(double x, double y) { return (x + 55 - 2.5) * 0.1 + (y + 55 - 2.5) * 0.05; }

UNIT_TEST(test_plants_stand_where_the_scene_says)
{
	static double at[200][3];
	static uint32_t plant[200];
	write_slope();
	OWNED(eco_pack) *pack = made("slope.json", "slope.eco");
	const struct eco_scene *s = &pack->scene;
	assert_int_equal(s->plant_count, 2);             /* one model under two names is one plant */
	assert_int_equal(s->tiles[s->root].instance_count, 120);
	assert_int_equal(standing(s, at, plant, 200), 120);
	for (int i = 0; i < 120; i++) {
		double x = (i * 37 % 101) * 0.83 - 40, y = (i * 59 % 103) * 0.71 - 35,
			z = slope_height(x, y) + (i == 7 ? 2 : 0), nearest = 1e9;
		for (int k = 0; k < 120; k++) {
			double dx = at[k][0] - x, dy = at[k][1] - y, dz = at[k][2] - z;
			if (plant[k] == (i % 3 == 1 ? 1u : 0u))
				nearest = fmin(nearest, sqrt(dx * dx + dy * dy + dz * dz));
		}
		assert_true(nearest < 0.012);            /* ground to the centimetre, places far finer */
	}
	assert_true(s->needs & ECO_NEED_GROUND);
	assert_true(s->ground_columns == 21 + 2 * s->ground_margin && s->ground_margin == 15);
}

/* 10 m high; a crown of 16 sides that reaches so far begins at a height. */
static void write_tree(const char *name, double reach, double base)
{
	char text[2000] = "v -.2 0 -.2\nv .2 0 -.2\nv .2 0 .2\nv -.2 0 .2\nv -.2 9 -.2\nv .2 9 -.2\nv .2 9 .2\nv -.2 9 .2\nf 1 2 6 5\nf 2 "
		"3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
	size_t at = strlen(text);
	at += (size_t)snprintf(text + at, sizeof text - at, "v 0 10 0\nv 0 %g 0\n", base);
	for (int i = 0; i < 16; i++)
		at += (size_t)snprintf(text + at, sizeof text - at, "v %.4f %g %.4f\n", reach * cos(i * M_PI / 8), base + .2,
			reach * sin(i * M_PI / 8));
	for (int i = 0; i < 16; i++)
		at += (size_t)snprintf(text + at, sizeof text - at, "f 9 %d %d\nf 10 %d %d\n", 11 + (i + 1) % 16, 11 + i, 11 + i,
			11 + (i + 1) % 16);
	write_text(name, text);
}

#define AREA_ROUNDED (1.0 / 1024)        /* eco_few_bits, twice */
#define SIXTEEN_SIDES 0.97450    /* of a disc's area */
#define STAND 300

/* A stand from the air: each crown covers as much as its diameter in the table says, whatever model it has;
 * the rows that say where crowns begin have the model where they do. */
/* 120 boxes of 8 x 6 m on ground that rises by .1 to the east. */
static void write_quarter(void)
{
	FILE *file = fopen(in_root("quarter.geojson"), "wb");
	assert_non_null(file);
	fputs("{\"type\": \"FeatureCollection\", \"crs\": {\"type\": \"name\", \"properties\": {\"name\": "
		"\"urn:ogc:def:crs:EPSG::32617\"}}, \"features\": [", file);
	for (int i = 0; i < 120; i++) {
		int x = 500000 + i % 12 * 12, y = 4200000 + i / 12 * 12;
		fprintf(file, "%s{\"type\": \"Feature\", \"properties\": {\"levels\": %d}, \"geometry\": {\"type\": \"Polygon\", "
			"\"coordinates\": [[[%d, %d], [%d, %d], [%d, %d], [%d, %d], [%d, %d]]]}}", i ? ",\n" : "", 1 + i % 4,
			x, y, x + 8, y, x + 8, y + 6, x, y + 6, x, y);
	}
	/* without a surface, and far away */
	fputs(",{\"type\": \"Feature\", \"properties\": {\"levels\": 1}, \"geometry\": {\"type\": \"Polygon\", \"coordinates\": "
		"[[[501000, 4201000], [501005, 4201005], [501010, 4201010], [501000, 4201000]]]}}]}", file);
	assert_int_equal(fclose(file), 0);
	file = fopen(in_root("rise.asc"), "wb");
	assert_non_null(file);
	fputs("ncols 21\nnrows 21\nxllcorner 499980\nyllcorner 4199980\ncellsize 10\nNODATA_value -9999\n", file);
	for (int i = 0; i < 441; i++)
		fprintf(file, "%d%c", 100 + i % 21, i % 21 == 20 ? '\n' : ' ');
	assert_int_equal(fclose(file), 0);
}

UNIT_TEST(test_buildings_are_blocks_that_stand_on_the_ground)
{
	double at[128][3];
	uint32_t plant[128], triangles = 0;
	write_quarter();
	OWNED(eco_pack) *pack = made("quarter.json", "quarter.eco");
	const struct eco_scene *s = &pack->scene;
	uint32_t count = standing(s, at, plant, 128);
	assert_int_equal(count, s->plant_count);         /* the shrub, and a place for each block */
	assert_in_range(count - 1, 2, 8);                /* 480 corners */
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_plant *p = &s->plants[plant[i]];
		bool block = strncmp(p->name, "buildings-", 10) == 0;
		assert_int_equal(block, plant[i] > 0);
		if (!block)
			continue;
		triangles += p->triangles;
		const struct eco_anchor *anchor = &s->anchors[p->anchor_first];
		double west = at[i][0] + (double)anchor->center[0] - (double)anchor->radius;
		assert_int_equal(p->anchor_count, 1);
		assert_int_equal(p->ladder_count, 1);
		/* the ground below the western wall, which is east of the sphere's end */
		assert_true(at[i][2] >= 0.1 * (west + 20) - 0.5 - 0.01 && at[i][2] <= 0.1 * (at[i][0] + 20));
	}
	assert_int_equal(triangles, 120 * 10);
	/* what is no plant is said in the pack's META, which says nothing of plants */
	json_t *meta = json_loadb(pack->meta, pack->meta_size, 0, NULL), *said = json_object_get(meta, "plants");
	for (uint32_t i = 0; i < s->plant_count; i++)
		assert_true(json_is_true(json_object_get(json_array_get(said, i), "object")) == (i > 0));
	assert_null(json_object_get(json_array_get(said, 0), "object"));
	json_decref(meta);
	OWNED(eco_pack) *again = NULL;
	assert_good(make("quarter.json", "again.eco", 1, &cause));
	assert_good(eco_pack_open(&again, in_root("again.eco"), &cause));
	assert_memory_equal(&pack->id, &again->id, sizeof pack->id);
}

UNIT_TEST(test_crowns_cover_what_the_table_says)
{
	static struct lod_place place[STAND];
	static double crown[STAND], base[STAND];
	static uint32_t plant[STAND];
	static char text[16384] = "x,y,h,c,b\n";
	double sum = 0, want = 0;
	uint32_t chosen = 0;
	write_tree("low.obj", 2.6, 2);
	write_tree("high.obj", 3, 6);
	for (int i = 0; i < STAND; i++) {
		double h = 8 + i * 7 % 30 * 0.5;
		crown[i] = h * (0.3 + i * 13 % 50 * 0.008);
		base[i] = i % 2 ? 0.2 : 0.6;
		snprintf(text + strlen(text), sizeof text - strlen(text), "%d,%d,%g,%g,%g\n", 20 * (i % 20), 20 * (i / 20), h, crown[i],
			base[i] * h);
	}
	write_text("stand.csv", text);
	OWNED(eco_pack) *pack = made("stand.json", "stand.eco");
	const struct eco_scene *s = &pack->scene;
	uint32_t low = s->anchors[s->plants[0].anchor_first].radius > s->anchors[s->plants[1].anchor_first].radius ? 1 : 0;
	assert_int_equal(placed(s, place, plant, STAND), STAND);
	for (uint32_t k = 0; k < STAND; k++) {
		uint32_t row = (uint32_t)(place[k].at[0] / 20 + 0.5) + 20 * (uint32_t)(place[k].at[1] / 20 + 0.5);
		double radius = (plant[k] == low ? 2.6 : 3) * place[k].scale * lod_place_width(&place[k]);
		double area = SIXTEEN_SIDES * radius * radius, table = crown[row] * crown[row] / 4;
		assert_true(fabs(area / table - 1) < 0.05);
		sum += area;
		want += table;
		chosen += (plant[k] == low) == (base[row] < 0.4);
	}
	assert_true(fabs(sum / want - 1) < 0.02);
	assert_true(chosen > 0.9 * STAND);
}

UNIT_TEST(test_crowns_choose_the_variant_and_the_size)
{
	double at[8][3];
	uint32_t plant[8];
	write_tree("narrow.obj", 1, 5);
	write_tree("wide.obj", 5, 5);
	struct eco_pack *pack = made("crowns.json", "crowns.eco");
	const struct eco_scene *s = &pack->scene;
	uint32_t count = standing(s, at, plant, 8);
	uint32_t wide = s->anchors[s->plants[0].anchor_first].radius
		> s->anchors[s->plants[1].anchor_first].radius ? 0 : 1;
	assert_int_equal(count, 4);
	for (uint32_t i = 0; i < count; i++)
		assert_int_equal(plant[i] == wide, at[i][0] > 50 && at[i][0] < 250);
	eco_pack_close(pack);
	/* without a height the crown says how large */
	pack = made("crown.json", "crown.eco");
	struct lod_place place[2];
	assert_int_equal(placed(&pack->scene, place, plant, 2), 2);
	uint32_t far = place[1].at[0] > 50;
	assert_true(fabs(place[far].scale / place[!far].scale - 2 / (5 * sqrt(SIXTEEN_SIDES))) < 0.005);
	eco_pack_close(pack);
}

/* No files: each row takes the size that is nearest to its own, and both individuals occur. */
UNIT_TEST(test_the_library_grows_what_a_scene_names)
{
	char rows[4000] = "x,y,h\n";
	uint32_t stands[4] = { 0 };
	for (int i = 0; i < 40; i++)
		snprintf(rows + strlen(rows), sizeof rows - strlen(rows), "%d,0,%d\n", 9 * i, i < 20 ? 1 : 2 + i % 2);
	write_text("library.csv", rows);
	struct eco_pack *pack = made("library.json", "library.eco");
	const struct eco_scene *s = &pack->scene;
	double at[40][3];
	uint32_t plant[40], count = standing(s, at, plant, 40);
	assert_int_equal(s->plant_count, 4);
	assert_int_equal(count, 40);
	for (uint32_t i = 0; i < count; i++) {
		assert_true(fabs((double)s->plants[plant[i]].height_m - (at[i][0] < 9 * 20 - 1 ? 1 : 2.5)) < 0.01);
		stands[plant[i]]++;
	}
	for (int i = 0; i < 4; i++)
		assert_in_range(stands[i], 4, 16);
	eco_pack_close(pack);
}

/* Sums the widths beside the heights of the instances of a 3D tile, each of which stands in `levels` files. */
static enum eco_code add_widths(void *ctx, uint32_t node, const double world[16])
{
	struct { struct eco_gltf *doc; double sum; uint64_t count; } *c = ctx;
	const json_t *places = json_object_get(eco_gltf_extension(eco_gltf_item(c->doc, "nodes", node), "EXT_mesh_gpu_instancing"),
		"attributes");
	(void)world;
	if (!places)
		return ECO_OK;
	AT_END(eco_gltf_accessor_close) struct eco_gltf_accessor a;
	assert_good(eco_gltf_accessor_open(c->doc, eco_gltf_index(places, "SCALE"), 0, &a, &cause));
	for (uint64_t k = 0; k < a.count; k++, c->count++) {
		double scale[16];
		eco_gltf_element(&a, k, scale);
		assert_true(scale[0] == scale[1]);
		c->sum += scale[0] / scale[2];
	}
	return ECO_OK;
}

static double mean_width_of_tiles(const char *folder)
{
	struct { struct eco_gltf *doc; double sum; uint64_t count; } c = { .count = 0 };
	char pattern[200];
	glob_t found;
	snprintf(pattern, sizeof pattern, "%s/tiles/*.gltf", folder);
	assert_int_equal(glob(pattern, 0, NULL, &found), 0);
	for (size_t i = 0; i < found.gl_pathc; i++) {
		assert_good(eco_gltf_open(&c.doc, found.gl_pathv[i], &cause));
		assert_good(eco_gltf_walk(c.doc, add_widths, &c, &cause));
		eco_gltf_close(c.doc);
	}
	globfree(&found);
	assert_true(c.count > 0);
	return c.sum / (double)c.count;
}

/* Heights and widths are apart; plants in their model's proportions store no width. */
UNIT_TEST(test_crowns_have_a_width_of_their_own)
{
	static const char entry[] = "{\"plants\": {\"a\": {\"model\": \"wide.obj\", \"up\": \"y\"}}, \"instances\": [{\"from\": "
		"\"widths.csv\", \"x\": \"x\", \"y\": \"y\", \"plant\": \"a\", \"height_m\": {\"column\": \"h\"}%s}]}";
	char text[600];
	struct lod_place place[2];
	write_tree("wide.obj", 5, 5);
	snprintf(text, sizeof text, entry, "");
	write_text("widths.json", text);
	struct eco_pack *pack = made("widths.json", "plain.eco");
	assert_false(pack->scene.needs & ECO_NEED_WIDTHS);
	assert_int_equal(eco_place_read(&pack->scene, 0).width, 0);
	eco_pack_close(pack);
	snprintf(text, sizeof text, entry, ", \"crown_m\": {\"column\": \"c\", \"is\": \"diameter\"}");
	write_text("widths.json", text);
	pack = made("widths.json", "widths.eco");
	assert_true(pack->scene.needs & ECO_NEED_WIDTHS);
	for (uint32_t i = 0; i < 2; i++) {
		struct eco_place stored = eco_place_read(&pack->scene, i);
		lod_place_instance(&place[i], &(struct eco_placement){ .scale = 1 },
			&pack->scene.lists[pack->scene.groups[0].list], &stored);
	}
	double narrow = lod_place_width(&place[0]), wide = lod_place_width(&place[1]);
	assert_true(fabs(fmax(narrow, wide) / fmin(narrow, wide) - 2) < 0.05);
	assert_true(place[0].scale == place[1].scale);
	const struct eco_tile *root = &pack->scene.tiles[pack->scene.root];
	assert_true(fabs(root->area / (pack->scene.plants[0].area * place[0].scale * place[0].scale) - narrow - wide) < 0.001);
	eco_pack_close(pack);
	char *line[] = { eco_copy_text(in_root("widths.eco")), "--3dtiles", eco_copy_text(in_root("widths-tiles")), "--plain", "--quiet" };
	assert_good(main_command_export.run(5, line, &cause));
	assert_true(fabs(mean_width_of_tiles(line[2]) - (narrow + wide) / 2) < 1e-5);
	free(line[0]);
	free(line[2]);
}

/* Rows have a class each, missing values too, and control characters are spaces; a scene without a tint stores none. */
UNIT_TEST(test_plants_have_the_tint_of_their_row)
{
	static const char entry[] = "{\"plants\": {\"a\": {\"model\": \"wide.obj\", \"up\": \"y\"}}, \"instances\": [{\"from\": "
		"\"tints.csv\", \"x\": \"x\", \"y\": \"y\", \"plant\": \"a\"%s}, {\"plant\": \"a\", \"at\": [50, 50]}]}";
	static const struct { const char *column, *palette; uint32_t classes, of_row[6]; } cases[] = {
		{ "health", "\"health\"", 4, { 1, 2, 3, 4, 4, 3 } },
		{ "health", "{\"Poor\": \"#102030\", \"good\": null, \"*\": \"#000000\"}", 3, { 1, 2, 2, 3, 3, 2 } },
		{ "age", "\"age\", \"breaks\": [10, 20.5]", 4, { 1, 2, 3, 4, 4, 4 } },
		{ "owner", "[\"#ff0000\", \"#00ff00\"]", 4, { 2, 1, 1, 4, 3, 3 } } };
	char text[600], tint[200];
	write_tree("wide.obj", 5, 5);
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		snprintf(tint, sizeof tint, ", \"tint\": {\"column\": \"%s\", \"palette\": %s}", cases[c].column,
			cases[c].palette);
		snprintf(text, sizeof text, entry, tint);
		write_text("tints.json", text);
		OWNED(eco_pack) *pack = made("tints.json", "tints.eco");
		const struct eco_scene *s = &pack->scene;
		json_t *meta = json_loadb(pack->meta, pack->meta_size, 0, NULL),
			*classes = json_object_get(json_array_get(json_object_get(meta, "tints"), 0), "classes");
		double at[8][3];
		uint32_t plant[8], plants = 0;
		assert_true(s->needs & ECO_NEED_TINTS);
		assert_int_equal(s->lists[s->groups[0].list].palette_count, cases[c].classes);
		assert_int_equal(json_array_size(classes), cases[c].classes);
		for (uint32_t i = 0; i < cases[c].classes; i++)
			plants += (uint32_t)json_integer_value(json_object_get(json_array_get(classes, i), "plants"));
		assert_int_equal(plants, 6);
		assert_string_equal(json_string_value(json_object_get(json_array_get(classes, cases[c].classes - 1), "name")),
			"not stated");
		assert_int_equal(standing(s, at, plant, 8), 7);
		for (uint32_t i = 0; i < 7; i++) {
			uint8_t found = eco_place_read(s, s->groups[0].place_first + i).tint;
			assert_int_equal(found, at[i][1] > 40 ? 0 : cases[c].of_row[(uint32_t)(at[i][0] / 10 + 0.5)]);
		}
		json_decref(meta);
	}
	snprintf(text, sizeof text, entry, "");
	write_text("tints.json", text);
	OWNED(eco_pack) *pack = made("tints.json", "plain.eco");
	assert_false(pack->scene.needs & ECO_NEED_TINTS);
	assert_int_equal(eco_place_read(&pack->scene, 0).tint, 0);
	assert_null(memmem(pack->meta, pack->meta_size, "\"tints\":", 8));
}

UNIT_TEST(test_tints_that_cannot_be_are_refused)
{
	static char text[30000];
	struct eco_error error = { 0 };
	int used = snprintf(text, sizeof text, "{\"plants\": {\"a\": {\"model\": \"wide.obj\"}}, \"instances\": [{\"from\": "
		"\"tints.csv\", \"x\": \"x\", \"y\": \"y\", \"plant\": \"a\", \"tint\": {\"column\": \"healthy\", \"palette\": \"health\"}}]}");
	write_text("hostile.json", text);
	assert_int_not_equal(make("hostile.json", "hostile.eco", 1, &error), ECO_OK);
	assert_non_null(strstr(error.text, "healthy"));
	used = snprintf(text, sizeof text, "{\"plants\": {\"a\": {\"model\": \"wide.obj\"}}, \"instances\": [{\"from\": \"tints.csv\", "
		"\"x\": \"x\", \"y\": \"y\", \"plant\": \"a\", \"tint\": {\"column\": \"health\", \"palette\": {");
	for (int i = 0; i < 300; i++)
		used += snprintf(text + used, sizeof text - (size_t)used, "%s\"c%d\": \"#%06x\"", i ? ", " : "", i, i + 1);
	snprintf(text + used, sizeof text - (size_t)used, "}}}]}");
	write_text("hostile.json", text);
	error = (struct eco_error){ 0 };
	assert_int_not_equal(make("hostile.json", "hostile.eco", 1, &error), ECO_OK);
	assert_non_null(strstr(error.text, "64"));
}

/* Plants, rows and nested files beyond the raster are kept, and counted. */
UNIT_TEST(test_what_stands_beyond_the_ground_is_counted)
{
	write_slope();
	write_text("two.csv", "x,y\n1000,2000\n1500,2001\n");
	OWNED(eco_pack) *pack = made("off.json", "off.eco");
	json_t *meta = json_loadb(pack->meta, pack->meta_size, 0, NULL);
	assert_int_equal(pack->scene.tiles[pack->scene.root].instance_count, 6);
	assert_int_equal(json_integer_value(json_object_get(meta, "off_ground")), 3);
	json_decref(meta);
}

UNIT_TEST(test_tiles_are_small_and_summed_up)
{
	write_slope();
	OWNED(eco_pack) *pack = made("slope.json", "slope.eco");
	const struct eco_scene *s = &pack->scene;
	uint32_t last = 0;
	assert_true(s->tile_count > 6);
	for (uint32_t t = 0; t < s->tile_count; t++) {
		const struct eco_tile *tile = &s->tiles[t];
		uint64_t own = 0;
		for (uint32_t g = tile->group_first; g < tile->group_first + tile->group_count; g++) {
			uint32_t list = s->groups[g].list;
			own += s->groups[g].count;
			/* a tile has one list for all its plants, and a run of tiles is a range of lists */
			assert_true(last == 0 || list == last + (g == tile->group_first));
			last = list;
		}
		assert_true(own <= 20);
		assert_int_not_equal(tile->summary, ECO_NONE);
		const struct eco_list *summary = &s->lists[tile->summary];
		assert_true(summary->primitive_count >= 64);
		assert_true(fabs((double)summary->unit_area * summary->primitive_count / (tile->area / 2) - 1)
			< AREA_ROUNDED);
	}
}

UNIT_TEST(test_nested_files_are_built_once)
{
	OWNED(eco_pack) *pack = made("nest.json", "nest.eco");
	const struct eco_scene *s = &pack->scene;
	assert_int_equal(s->plant_count, 1);
	assert_int_equal(s->tile_count, 3);
	assert_int_equal(s->place_count, 3);
	assert_int_equal(s->tiles[0].instance_count, 1 + 2 * 3 * 2 + 2);
	assert_int_equal(s->tiles[0].child_count, 3);
	assert_true(s->needs & ECO_NEED_PLACEMENTS);
	double patch = s->tiles[2].area, one = (double)s->plants[0].area;
	assert_true(fabs(patch / (one * 1.25) - 1) < AREA_ROUNDED);
	assert_true(fabs(s->tiles[1].area / (patch * 6) - 1) < AREA_ROUNDED);
	assert_true(fabs(s->tiles[0].area / (one + patch * 13) - 1) < AREA_ROUNDED);
	assert_true(s->tiles[0].high[0] >= 120 && s->tiles[0].high[1] >= 100);
}

/* ---- What is refused ---- */

static uint32_t files_with(const char *part)
{
	DIR *folder = opendir(scratch_root);
	struct dirent *entry;
	uint32_t count = 0;
	while ((entry = readdir(folder)))
		count += strstr(entry->d_name, part) != NULL;
	closedir(folder);
	return count;
}

UNIT_TEST(test_failure_leaves_the_old_pack)
{
	struct fault { const char *scene, *says; };
	uint32_t count;
	const struct fault *bad = cases_read("tests/ecopack/cases/make_faults.tsv", sizeof *bad, &count);
	write_text("two.csv", "x,y\n1,2\n500,1\n");
	for (uint32_t i = 0; i < count; i++) {
		struct eco_error error = { 0 };
		size_t size;
		write_text("bad.json", bad[i].scene);
		assert_int_not_equal(make("bad.json", "kept.eco", 1, &error), ECO_OK);
		if (!strstr(error.text, bad[i].says))
			fail_msg("case %u: \"%s\" does not name %s", i, error.text, bad[i].says);
		char *kept = read_all("kept.eco", &size);
		assert_int_equal(size, strlen("ECOPACK1 that was there before"));
		free(kept);
		assert_int_equal(files_with(".tmp-"), 0);
	}
}

UNIT_TEST(test_damage_is_found_and_named)
{
	size_t size;
	write_slope();
	eco_pack_close(made("slope.json", "whole.eco"));
	FREED_MEMORY char *bytes = read_all("whole.eco", &size);
	for (int i = 0; i < 24; i++) {
		struct inspect_counts counts;
		struct eco_error error = { 0 };
		size_t at = 40 + (size - 41) * (size_t)i / 23;
		bytes[at] ^= 0x10;
		FILE *file = fopen(in_root("hurt.eco"), "wb"), *out = tmpfile();
		fwrite(bytes, 1, size, file);
		fclose(file);
		bytes[at] ^= 0x10;
		assert_int_not_equal(inspect_verify(in_root("hurt.eco"), out, &counts, &error), ECO_OK);
		assert_int_not_equal(error.text[0], 0);
		if (counts.damaged) {
			char line[256] = { 0 };
			rewind(out);
			assert_non_null(fgets(line, sizeof line, out));
			assert_memory_equal(line, "list ", 5);
			assert_non_null(strstr(line, "offset"));
			assert_true(counts.chunks > counts.damaged);     /* it goes on */
		}
		fclose(out);
	}
}

/* A hilly ground of several tiles under one plant. */
static void write_hills(void)
{
	FILE *file = fopen(in_root("hills.asc"), "wb");
	assert_non_null(file);
	fputs("ncols 150\nnrows 140\nxllcorner 0\nyllcorner 0\ncellsize 2\n", file);
	for (int r = 0; r < 140; r++)
		for (int c = 0; c < 150; c++)
			fprintf(file, "%.2f%c", 50 + 9 * sin(c * 0.37) * cos(r * 0.29) + 0.1 * c,
				c == 149 ? '\n' : ' ');
	assert_int_equal(fclose(file), 0);
}

UNIT_TEST(test_ground_is_tiles_that_hold_what_they_say)
{
	write_hills();
	OWNED(eco_pack) *pack = made("hills.json", "hills.eco");
	const struct eco_scene *s = &pack->scene;
	assert_true(s->ground_margin == 17 && s->ground_columns == 150 + 2 * 17 &&
		s->ground_rows == 140 + 2 * 17);
	assert_true(s->ground_count == 1 + 4 + 9 + 36 && s->ground[0].level == 3);
	assert_true(s->ground[0].error_m > 3 && s->ground[1 + 4 + 9].error_m == 0);
}

/* Other heights have steps of a centimetre, less where relief is low, but of a 256th of a cell at least. */
UNIT_TEST(test_steps_of_heights_are_as_fine_as_cells_show)
{
	static const struct { const char *cell, *top; double step; } grids[] = { { "0.5", "602", 1.0 / 128 },
		{ "2", "602", 1.0 / 128 }, { "10", "602", 1.0 / 32 }, { "90", "602", 1.0 / 4 },
		{ "0.125", "99.412", 1.0 / 2048 }, { "2", "99.412", 1.0 / 128 } };
	for (size_t i = 0; i < sizeof grids / sizeof *grids; i++) {
		char text[200];
		snprintf(text, sizeof text, "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize %s\n"
			"99.0217 %s 99.3791\n99.3 99.012 99\n", grids[i].cell, grids[i].top);
		write_text("wide.asc", text);
		OWNED(eco_pack) *pack = made("wide.json", "wide.eco");
		assert_true(pack->scene.lists[pack->scene.ground[0].list].grid_step[2] == grids[i].step);
	}
}

/* ---- Impostors ---- */

/* The first list of impostors with two levels or more. */
static uint32_t impostor_of(const struct eco_scene *s)
{
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_IMPOSTOR && s->lists[i].chunk_count > 1)
			return i;
	fail_msg("no impostor of two levels");
	return 0;
}

/* A small pack with these as the levels of an impostor, under hashes that are right: what verify says of a
 * chunk of them; NULL: nothing of any. */
static void verify_says(const struct eco_bytes *levels, uint32_t count, uint32_t chunk, const char *says)
{
	struct eco_list list = { .kind = ECO_LIST_IMPOSTOR, .coder = ECO_CODER_BYTES, .image = ECO_NONE,
		.partner = ECO_NONE, .grid_step = { 1, 1, 1 } };
	AT_END(scene_free) struct scene_builder b;
	struct eco_pack_writer *w;
	struct inspect_counts counts;
	struct eco_error error = { 0 };
	char line[256], wanted[64];
	bool found = false;
	assert_ok(small_pack_write(&b, in_root("hurt.eco"), &w, &error), error);
	uint32_t id = eco_pack_add_bytes(w, &list, levels, count);
	b.scene.needs |= ECO_NEED_IMPOSTORS;
	assert_ok(eco_pack_commit(w, &b.scene, SMALL_PACK_META, &error), error);
	FILE *out = tmpfile();
	inspect_verify(in_root("hurt.eco"), out, &counts, &error);
	rewind(out);
	snprintf(wanted, sizeof wanted, "list %u, chunk %u, offset ", id, chunk);
	while (fgets(line, sizeof line, out)) {
		assert_true(says || strncmp(line, "list ", 5) || (uint32_t)atoi(line + 5) != id);
		found = found || (says && !strncmp(line, wanted, strlen(wanted)) && strstr(line, says));
	}
	if (says && !found)
		fail_msg("verify says nothing like '%s...%s'", wanted, says);
	assert_true(!says || counts.damaged > 0);
	fclose(out);
}

/* Leaves on a sphere, enough for two levels. */
static void write_sphere(const char *name, uint32_t leaves)
{
	FILE *file = open_text(name);
	for (uint32_t i = 0; i < leaves; i++) {
		double z = (i + 0.5) / leaves * 2 - 1, r = sqrt(1 - z * z), x = r * cos(2.4 * i),
			y = r * sin(2.4 * i);
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf -4 -3 -2 -1\n", x, z + 1, y,
			x + 0.1, z + 1, y, x + 0.1, z + 1.1, y + 0.05, x, z + 1.1, y);
	}
	assert_int_equal(fclose(file), 0);
}

/* Hashes hold, but the bytes of a level are no level, or another one. */
UNIT_TEST(test_damaged_impostors_are_named)
{
	struct eco_bytes levels[2];
	write_sphere("many.obj", 400);
	finished = true;
	OWNED(eco_pack) *pack = made("levels.json", "levels.eco");
	finished = false;
	uint32_t first = pack->scene.lists[impostor_of(&pack->scene)].chunk_first;
	for (uint32_t i = 0; i < 2; i++) {
		const uint8_t *payload;
		size_t size;
		assert_good(eco_pack_payload(pack, first + i, &payload, &size, &cause));
		levels[i] = (struct eco_bytes){ memcpy(malloc(size), payload, size), size };
	}
	verify_says(levels, 2, 0, NULL);
	verify_says((struct eco_bytes[2]){ levels[1], levels[0] }, 2, 0,
		"holds another level of an impostor than its number says");
	verify_says((struct eco_bytes[2]){ levels[0], levels[0] }, 2, 1,
		"holds another level of an impostor than its number says");
	verify_says((struct eco_bytes[2]){ levels[0], { levels[1].at, levels[1].size - 1 } }, 2, 1,
		"impostor: level 1 is damaged");
	verify_says((struct eco_bytes[2]){ levels[0], { levels[1].at, 20 } }, 2, 1, "impostor");
	levels[0].at[24] = ECO_IMPOSTOR_LEVELS;
	verify_says(levels, 2, 0, "impostor: its ");
	free(levels[0].at);
	free(levels[1].at);
}

static int prepare(void **state)
{
	scratch_open("make");
	cases_write("tests/ecopack/cases/make_files.tsv", scratch_root);
	eco_progress_quiet(true);
	write_shrub(in_root("a.obj"), "mtllib none.mtl\n", 4, 60);
	write_shrub(in_root("b.obj"), "mtllib none.mtl\n", 1.5, 25);
	return 0;
}

UNIT_MAIN(prepare, scratch_close)
