/* Maps: what is counted, what is said to be left out, which part of the world is shown, and that a failure
 * leaves nothing. */
#include <cairo/cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/map.h"
#include "ecofiles/ecopack/run.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/test_map"
#define PLANTS "\"plants\": {\"oak\": {\"model\": \"any.obj\", \"height_m\": 20}, \"ash\": {\"model\": " \
	"\"any.obj\"}, \"elm\": {\"model\": \"any.obj\"}}"

static int make_files(void **state)
{
	folder_make(ROOT);
	cases_write("tests/ecopack/cases/map_files.tsv", ROOT);
	eco_progress_quiet(true);
	return 0;
}

static void gather(struct map *m, const char *scene)
{
	static struct eco_error error;
	error = (struct eco_error){ 0 };
	*m = (struct map){ .error = &error };
	if (map_gather(m, scene))
		fail_msg("%s: %s", scene, error.text);
}

static const struct map_kind *kind(const struct map *m, const char *name)
{
	for (uint32_t i = 0; i < m->kind_count; i++)
		if (strcmp(m->kinds[i].name, name) == 0)
			return &m->kinds[i];
	fail_msg("no kind %s", name);
	return NULL;
}

static bool says(const struct map *m, const char *text)
{
	for (uint32_t i = 0; i < m->line_count; i++)
		if (strstr(m->lines[i].text, text))
			return true;
	return false;
}

/* ---- Counting ---- */

UNIT_TEST(test_plants_are_counted_by_kind_and_rows_left_out_by_reason)
{
	FREED(map) m;
	gather(&m, ROOT "/one.json");
	assert_int_equal(m.total, 4);
	assert_int_equal(m.points.count, 4);
	assert_int_equal(kind(&m, "oak")->count, 2);
	assert_int_equal(kind(&m, "ash")->count, 1);
	assert_int_equal(kind(&m, "elm")->count, 1);
	assert_true(kind(&m, "oak")->low_m == 10 && kind(&m, "oak")->high_m == 20);
		/* one has no height: the plant's own */
	assert_true(kind(&m, "elm")->low_m == 8);                                        /* 4 m twice */
	static const char *const lines[] = { "rows.csv: 8 rows, 3 plants", " 1  left out: no coordinates",
		" 1  left out: a coordinate that is not a number", " 1  left out: 1 species that the map does not have",
		" 2  left out by the map: stump", "of these 1: \"weed\"", " 1  kept at their plant's own height" };
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		if (!says(&m, lines[i]))
			fail_msg("no line says: %s", lines[i]);
	assert_int_equal(m.left_points.count, 2);        /* where the stumps are: gray dots */
}

UNIT_TEST(test_nested_plants_are_turned_moved_and_scaled)
{
	FREED(map) m;
	bool found = false;
	gather(&m, ROOT "/nested.json");
	/* oak at [10, 0], turned to [0, 10], twice as large, at [100, 0] */
	for (uint64_t i = 0; i < m.points.count; i++)
		found |= fabsf(m.points.items[i].x - 100) < 1e-3f && fabsf(m.points.items[i].y - 20) < 1e-3f
			&& m.points.items[i].height_m == 40;
	assert_true(found);
}

UNIT_TEST(test_scattered_plants_are_shown_with_their_areas)
{
	FREED(map) m;
	gather(&m, ROOT "/scatter.json");
	assert_int_equal(m.areas.count, 3);
	assert_int_equal(m.clear_of.count, 1);
	assert_true(kind(&m, "oak")->count > 100 && m.total == kind(&m, "oak")->count
		+ kind(&m, "ash")->count);
	assert_int_equal(map_write(&m, ROOT "/drawn.png", 300), ECO_OK);
	assert_int_equal(m.outside, 0);
}

/* ---- The part that is shown ---- */

static void write_rows(const char *path, uint32_t count, const char *more)
{
	FILE *file = fopen(path, "wb");
	fputs("x,y\n", file);
	for (uint32_t i = 0; i < count; i++)
		fprintf(file, "%u,%u\n", i * 37 % 1000, i * 71 % 1000);
	fputs(more, file);
	fclose(file);
}

#define ROWS_SCENE(name) "{" PLANTS ", \"instances\": [{\"from\": \"" name "\", \"x\": \"x\", \"y\": " \
	"\"y\", \"plant\": \"oak\"}]}"

UNIT_TEST(test_strays_do_not_shrink_the_rest_and_few_plants_have_a_map)
{
	static const struct { uint32_t count; const char *more; double widest; uint64_t outside; } cases[] =
		{ { 1000, "", 1100, 0 },
		{ 1000, "4000000,0\n", 1500, 1 }, { 1000, "0,-900000\n5,4000000\n", 1500, 2 },
		{ 1000, "2000,2000\n", 2200, 0 },
		{ 3, "4000000,0\n", 5e6, 0 }, { 0, "5,5\n", 5e6, 0 }, { 0, "0,0\n100,0\n", 5e6, 0 },
		{ 0, "7,1\n7,900\n", 5e6, 0 }, { 0, "1,1\n1,1\n1,1\n", 5e6, 0 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		FREED(map) m;
		write_rows(ROOT "/stray.csv", cases[i].count, cases[i].more);
		file_write_text(ROOT "/stray.json", ROWS_SCENE("stray.csv"));
		gather(&m, ROOT "/stray.json");
		assert_int_equal(map_write(&m, ROOT "/drawn.png", 400), ECO_OK);
		assert_true(m.view.high[0] - m.view.low[0] <= cases[i].widest);
		assert_int_equal(m.outside, cases[i].outside);
		assert_true(m.width >= 90 && m.width <= 400 && m.height >= 90 && m.height <= 400);
	}
}

/* ---- The command ---- */

static enum eco_code run(const char *line, struct eco_error *error)
{
	char text[400], *argv[24];
	int argc = 0;
	snprintf(text, sizeof text, "%s --quiet", line);
	for (char *word = strtok(text, " "); word && argc < 24; word = strtok(NULL, " "))
		argv[argc++] = word;
	*error = (struct eco_error){ 0 };
	return main_command_map.run(argc, argv, error);
}

/* 100 m from west to east, 0 to 50 m high; nothing is known of the last column. */
static void write_ground(void)
{
	FILE *file = fopen(ROOT "/dem.asc", "wb");
	fputs("ncols 11\nnrows 6\nxllcorner -5\nyllcorner -5\ncellsize 10\nNODATA_value -9999\n", file);
	for (int r = 0; r < 6; r++)
		for (int c = 0; c < 11; c++)
			fprintf(file, "%d%s", 5 * c, c < 10 ? " " : "\n");
	fclose(file);
}

UNIT_TEST(test_the_same_scene_gives_the_same_picture)
{
	size_t size, again;
	struct eco_error error;
	write_ground();
	static const char *const scenes[] = { ROOT "/one.json", ROOT "/nested.json", ROOT "/hill.json" };
	for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
		char line[300];
		snprintf(line, sizeof line, "%s -o " ROOT "/a.png --size 300", scenes[i]);
		assert_ok(run(line, &error), error);
		FREED_MEMORY uint8_t *first = file_read(ROOT "/a.png", &size);
		assert_int_equal(run(line, &error), ECO_OK);
		FREED_MEMORY uint8_t *second = file_read(ROOT "/a.png", &again);
		assert_int_equal(size, again);
		assert_memory_equal(first, second, size);
	}
}

#define UTM "\"crs\": \"EPSG:32632\", \"origin\": [691000, 5334000, 500], "
#define TWO_MAPPED "\"map\": {\"oak\": \"oak\", \"ash\": \"ash\"}, \"height_m\": {\"column\": "

/* A table that map wrote is an inventory: read as one, it gives the same plants with their rows. */
UNIT_TEST(test_tables_are_inventories_of_the_same_plants)
{
	static const char *const names[] = { "table.gpkg", "table.geojson" };
	static const uint32_t rows[] = { 0, 1, 3 }, lines[] = { 0, 2, 4 };
	for (size_t t = 0; t < sizeof names / sizeof *names; t++) {
		char line[200], scene[600];
		struct map m, again;
		struct eco_error error;
		snprintf(line, sizeof line, ROOT "/%s", names[t]);
		unlink(line);
		snprintf(line, sizeof line, ROOT "/utm.json -o " ROOT "/%s", names[t]);
		assert_ok(run(line, &error), error);
		snprintf(scene, sizeof scene,
			"{" UTM PLANTS ", \"instances\": [{\"from\": \"%s\", \"species\": "
			"\"species\", " TWO_MAPPED "\"height_m\"}}]}", names[t]);
		file_write_text(ROOT "/again.json", scene);
		gather(&m, ROOT "/utm.json");
		gather(&again, ROOT "/again.json");
		assert_int_equal(m.points.count, 3);
		assert_int_equal(again.points.count, 3);
		for (uint32_t i = 0; i < 3; i++) {
			const struct map_point *a = &m.points.items[i], *b = &again.points.items[i];
			assert_string_equal(m.kinds[a->kind].name, again.kinds[b->kind].name);
			assert_true(fabsf(a->height_m - b->height_m) < 1e-4f);
			/* GeoJSON has 1e-7 degrees */
			assert_true(hypotf(a->x - b->x, a->y - b->y) < (t ? 0.02f : 0.002f));
			assert_int_equal(a->row, rows[i]);
			assert_int_equal(a->line, lines[i]);
			assert_string_equal(m.species.items[a->species], again.species.items[b->species]);
		}
		map_free(&again);
		/* each says its line, and what it is shown as */
		snprintf(scene, sizeof scene,
			"{" UTM PLANTS ", \"instances\": [{\"from\": \"%s\", \"species\": \"plant\", "
			"\"skip\": {\"row\": \"\"}, " TWO_MAPPED "\"line\"}}]}", names[t]);
		file_write_text(ROOT "/again.json", scene);
		gather(&again, ROOT "/again.json");
		assert_int_equal(again.points.count, 2);
		for (uint32_t i = 0; i < 2; i++) {
			assert_true(again.points.items[i].height_m == (float)lines[i + 1]);
			assert_int_equal(again.points.items[i].kind, m.points.items[i + 1].kind);
		}
		assert_string_equal(m.files[m.points.items[2].file], "utm.csv");
		assert_string_equal(m.species.items[m.points.items[2].species], "ASH");
		map_free(&m);
		map_free(&again);
		assert_int_equal(run(line, &error), ECO_BAD_USAGE);
		assert_non_null(strstr(error.text, "it is kept"));
	}
}

/* Long names are cut, and lines of the legend are broken. */
UNIT_TEST(test_long_texts_of_any_script_are_drawn)
{
	static const char *const names[] = { "Ahorn \xc3\xa4", "\xf0\x9f\x8c\xb3", "\xd0\xb4\xd1\x83\xd0\xb1",
		"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx",
		"one two three four five six seven eight nine ten eleven" };
	struct eco_error error;
	FILE *file = fopen(ROOT "/texts.json", "wb");
	fputs("{\"name\": \"a \xe2\x82\xac\", \"plants\": {", file);
	for (size_t i = 0; i < 80; i++)
		fprintf(file, "%s\"%zu %s\": {\"model\": \"any.obj\"}", i ? ", " : "", i, names[i % 5]);
	fprintf(file, "}, \"instances\": [{\"plant\": \"0 %s\", \"at\": [0, 0]}, "
		"{\"plant\": \"4 %s\", \"at\": [100, 100]}]}", names[0], names[4]);
	fclose(file);
	assert_ok(run(ROOT "/texts.json -o " ROOT "/texts.png --size 200", &error), error);
	cairo_surface_t *picture = cairo_image_surface_create_from_png(ROOT "/texts.png");
	assert_int_equal(cairo_image_surface_get_width(picture), 20 + 62 + 200 + 20 + 380 + 20);
	cairo_surface_destroy(picture);
}

UNIT_TEST(test_only_pictures_are_replaced)
{
	static const struct { const char *path; bool allowed;
	} cases[] = { { "text", false }, { "short", false }, { "empty", true }, { "old.png", true },
		{ "new.PNG", true }, { "new.jpg", false }, { ".", false }, { "nowhere/x.png", false } };
	file_write(ROOT "/text", "hello, world", 12);
	file_write(ROOT "/short", "\x89PN", 3);
	file_write(ROOT "/empty", "", 0);
	file_write(ROOT "/old.png", "\x89PNG\r\n\x1a\n....", 12);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_error error;
		char line[200];
		snprintf(line, sizeof line, ROOT "/one.json -o " ROOT "/%s --size 200", cases[i].path);
		assert_int_equal(run(line, &error) == ECO_OK, cases[i].allowed);
		assert_int_equal(error.text[0] == 0, cases[i].allowed);
	}
}

UNIT_TEST(test_bad_command_lines_and_scenes_are_told)
{
	static const struct { const char *line; enum eco_code code; const char *says; } cases[] =
		{ { ROOT "/one.json", ECO_BAD_USAGE, "-o" },
		{ "-o " ROOT "/x.png", ECO_BAD_USAGE, "the scene file" },
		{ ROOT "/one.json -o " ROOT "/x.png --size 20", ECO_BAD_USAGE, "--size" },
		{ ROOT "/none.json -o " ROOT "/x.png", ECO_NOT_FOUND, "none.json" },
		{ ROOT "/rows.csv -o " ROOT "/x.png", ECO_BAD_INPUT, "rows.csv" },
		{ ROOT "/one.json -o " ROOT "/rows.csv", ECO_BAD_INPUT, "kept" },
		{ ROOT "/nothing.json -o " ROOT "/x.png", ECO_BAD_INPUT,
			"nothing to show" },
		{ ROOT "/column.json -o " ROOT "/x.png", ECO_BAD_INPUT, "easting" } };
	unlink(ROOT "/x.png");
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_error error;
		enum eco_code code = run(cases[i].line, &error);
		if (code != cases[i].code || !strstr(error.text, cases[i].says))
			fail_msg("%s: %s: %s", cases[i].line, eco_code_name(code), error.text);
	}
	assert_int_not_equal(access(ROOT "/x.png", F_OK), 0);
}

UNIT_MAIN(make_files, NULL)
