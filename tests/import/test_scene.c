/* SCENE.json: what it may say, and that what it may not say is answered with a place. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/scene/scene.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

/* Documents go to the folder that SCENES_KEPT names, with the reader's verdicts: test_scene_schema.sh holds
 * the schema against them. */
static void keep(const char *verdict, const char *json, const char *says)
{
	static unsigned number;
	const char *folder = getenv("SCENES_KEPT");
	char path[300];
	if (!folder)
		return;
	snprintf(path, sizeof path, "%s/%s-%03u.json", folder, verdict, ++number);
	file_write_text(path, json);
	snprintf(path, sizeof path, "%s/%s-%03u.says", folder, verdict, number);
	file_write_text(path, says);
}

/* JSON in which ' stands for ". */
static const char *json_of(const char *text)
{
	static char json[8192];
	snprintf(json, sizeof json, "%s", text);
	for (char *at = json; (at = strchr(at, '\''));)
		*at = '"';
	return json;
}

static void parse_good(struct eco_source *source, const char *text)
{
	const char *json = json_of(text);
	assert_good(eco_source_parse(source, json, strlen(json), "dir/scene.json", false, &cause));
	keep("good", json, "");
}

UNIT_TEST(everything_that_may_be_said_is_read)
{
	struct eco_source s;
	const struct eco_positions_spec *p;
	parse_good(&s, "{ 'name': 'n', 'crs': 'EPSG:26917', 'origin': [747375, 4308510, 2], 'tile': "
		"{'instances': 7},\n'ground': {'heights': 'dem.tif', 'crs': 'EPSG:26917'},\n'plants': "
		"{'oak': {'variants': ['a.glb', '/b.obj'], 'height_m': 18, 'importance': {'flower': 3}}, "
		"'ash': {'model': 'c.obj', 'grade': true, 'object': true, 'foot': [691000, 5334000, 510.5]}},\n'instances': [{'plant': 'ash', 'at': [1, 2, 3], 'yaw_deg': 30, "
		"'scale': 1.5}, {'plant': 'ash', 'at': [1, 2]},\n  {'from': 't.csv', 'x': 'e', 'y': 'n', "
		"'z': 'h', 'crs': 'EPSG:4326', 'species': 'sp', 'separator': ';',\n   'map': {'q': 'oak', "
		"'stump': null, '*': 'ash'}, 'seed': 9, 'yaw_deg': 'y',\n   'height_m': {'from_dbh_mm': 'd', "
		"'max': 35, 'rate': 0.004, 'levels': 8}}],\n'children': [{'eco': 'sub/h.json', 'at': [100, 0,"
		" 0], 'yaw_deg': 90, 'scale': 2}] }");
	assert_string_equal(s.name, "n");
	assert_string_equal(s.crs, "EPSG:26917");
	assert_true(s.origin[0] == 747375 && s.origin[1] == 4308510 && s.origin[2] == 2);
	assert_int_equal(s.tile_instances, 7);
	assert_false(s.plants[0].grade);
	assert_true(s.plants[s.plant_count - 1].grade && s.plants[s.plant_count - 1].object && !s.plants[0].object);
	assert_true(s.plants[s.plant_count - 1].keep_origin && s.plants[s.plant_count - 1].foot[2] == 510.5 && !s.plants[0].keep_origin);
	assert_string_equal(s.ground.heights[0], "dir/dem.tif");
	assert_int_equal(s.plant_count, 3);
	assert_string_equal(s.plants[0].models[0], "dir/a.glb");
	assert_string_equal(s.plants[1].models[0], "/b.obj");
	assert_int_equal(s.plants[1].variant, 1);
	assert_int_equal(s.plants[0].variant_count, 2);
	assert_true(s.plants[0].importance[ECO_ORGAN_FLOWER] == 3 && s.plants[0].importance[ECO_ORGAN_WOOD]
		== 1);
	assert_int_equal(s.instance_count, 2);
	assert_int_equal(s.instances[0].plant, 2);
	assert_true(s.instances[0].at[2] == 3 && s.instances[0].scale == 1.5
		&& isnan(s.instances[0].height_m));
	assert_true(s.instances[1].at[2] == 0 && s.instances[1].scale == 1);
	assert_int_equal(s.positions_count, 1);
	p = &s.positions[0];
	assert_string_equal(p->path, "dir/t.csv");
	assert_int_equal(p->map_count, 2);
	assert_string_equal(p->map[0].name, "q");
	assert_int_equal(p->map[0].variant_count, 2);
	assert_int_equal(p->map[1].plant, ECO_NONE);
	assert_int_equal(p->fallback.plant, 2);
	assert_int_equal(p->height_count, 1);
	assert_int_equal(p->heights[0].kind, ECO_SIZE_DBH);
	assert_int_equal(p->levels, 8);
	assert_int_equal(p->separator, ';');
	assert_int_equal(p->line, 5);
	assert_int_equal(s.child_count, 1);
	assert_string_equal(s.children[0].eco, "dir/sub/h.json");
	assert_true(s.children[0].yaw_deg == 90 && s.children[0].scale == 2);
	eco_source_free(&s);
}

UNIT_TEST(ground_may_be_several_rasters_and_say_what_they_do_not)
{
	struct eco_source s;
	parse_good(&s, "{'crs': 'EPSG:26917', 'origin': [0, 0], 'vertical': 'EPSG:5703', "
		"'ground': {'heights': ['a.tif', '/b.tif'], 'vertical': 'NAVD88 height', "
		"'band': 2, 'scale': 0.001, 'offset': 273.5, 'unit': 'ft', 'nodata': -1}}");
	assert_string_equal(s.vertical, "EPSG:5703");
	assert_int_equal(s.ground.height_count, 2);
	assert_string_equal(s.ground.heights[0], "dir/a.tif");
	assert_string_equal(s.ground.heights[1], "/b.tif");
	assert_string_equal(s.ground.vertical, "NAVD88 height");
	assert_true(s.ground.band == 2 && s.ground.scale == 0.001 && s.ground.offset == 273.5
		&& s.ground.has_offset && s.ground.unit_m == 0.3048);
	assert_true(s.ground.nodata == -1 && s.ground.has_nodata && !s.ground.no_holes
		&& !s.ground.has_place);
	eco_source_free(&s);
	parse_good(&s, "{'ground': {'heights': 'map.png', 'nodata': null, 'north_west': [10, 20], "
		"'pixel': 2}}");
	assert_true(s.ground.no_holes && !s.ground.has_nodata && !s.ground.has_offset && s.ground.scale == 0
		&& s.ground.unit_m == 0);
	assert_true(s.ground.has_place && s.ground.corner[1] == 20 && s.ground.pixel[0] == 2
		&& s.ground.pixel[1] == 2);
	eco_source_free(&s);
}

UNIT_TEST(defaults_fill_what_is_not_said)
{
	struct eco_source s;
	parse_good(&s, "{}");
	assert_string_equal(s.name, "scene");
	assert_null(s.crs);
	assert_int_equal(s.tile_instances, ECO_TILE_INSTANCES);
	assert_int_equal(s.plant_count + s.instance_count + s.positions_count + s.child_count, 0);
	eco_source_free(&s);
	parse_good(&s, "\xef\xbb\xbf{'name': 'marked'}");
		/* by an editor, with a byte order mark */
	assert_string_equal(s.name, "marked");
	eco_source_free(&s);
	parse_good(&s, "{'plants': {'b': {'model': 'b.obj'}, 'a': {'model': 'a.obj'}}, "
		"'instances': [{'from': 't.csv', 'x': 'x', 'y': 'y', 'species': 's'}]}");
	assert_int_equal(s.positions[0].map_count, 2);       /* species are plants' names */
	assert_string_equal(s.positions[0].map[1].name, "a");
	assert_int_equal(s.positions[0].map[1].plant, 1);
	eco_source_free(&s);
}

UNIT_TEST(files_are_drawn_on_the_ground)
{
	struct eco_source s;
	parse_good(&s, "{'ground': {'draw': [{'from': 'r.gpkg', 'layer': 'l', 'width_m': 'w', 'skip': {'k': 'v'}}, {'from': '/s', "
		"'class': 'street', 'width_m': 5}]}}");
	assert_int_equal(s.draw_count, 2);
	assert_string_equal(s.draws[0].path, "dir/r.gpkg");
	assert_string_equal(s.draws[0].width, "w");
	assert_true(s.draws[0].filter_count == 1 && s.draws[0].width_m == 0 && !s.draws[0].class);
	assert_string_equal(s.draws[1].class, "street");
	assert_true(s.draws[1].width_m == 5 && s.ground.height_count == 0);
	eco_source_free(&s);
}

UNIT_TEST(footprints_have_sources_of_heights)
{
	struct eco_source s;
	parse_good(&s, "{'crs': 'EPSG:26917', 'origin': [0, 0], 'instances': [{'extrude': 'b.gpkg', 'layer': 'l', 'crs': 'EPSG:4326', "
		"'roof': 'r', 'only': {'k': 'house'}, 'height_m': ['h', {'column': 'f', 'unit': 'ft'}, {'storeys': 's'}, "
		"{'storeys': 't', 'storey_m': 2.8}, 7.5]}, {'extrude': 'c.gpkg'}, {'extrude': 'd.gpkg', 'height_m': 5}]}");
	assert_int_equal(s.footprints_count, 3);
	const struct eco_footprints_spec *f = &s.footprints[0];
	assert_string_equal(f->path, "dir/b.gpkg");
	assert_string_equal(f->roof, "r");
	assert_int_equal(f->filter_count, 1);
	assert_int_equal(f->height_count, 5);
	assert_string_equal(f->heights[0].column, "h");
	assert_true(f->heights[0].unit_m == 1 && !f->heights[0].storeys);
	assert_true(f->heights[1].unit_m == 0.3048 && !f->heights[1].storeys);
	assert_true(f->heights[2].unit_m == ECO_STOREY_M && f->heights[2].storeys);
	assert_true(f->heights[3].unit_m == 2.8);
	assert_true(!f->heights[4].column && f->heights[4].value_m == 7.5);
	assert_int_equal(f[1].height_count, 0);
	assert_true(f[2].height_count == 1 && f[2].heights[0].value_m == 5);
	eco_source_free(&s);
}

#define PLANTS "'plants': {'oak': {'model': 'o.obj'}}"
#define ROWS "'from': 't.csv', 'x': 'x', 'y': 'y'"

struct scene_fault { const char *json, *place, *says; };

/* Sizes and individuals of a plant of the library are its variants, sizes first. */
UNIT_TEST(plants_of_the_library_are_read)
{
	struct eco_source s;
	parse_good(&s, "{'season': 'winter', 'plants': {'elm': {'library': 'vase', 'genus': 'Ulmus', 'height_m': [8, 16], "
		"'crown_m': [6, 11], 'individual': [1, 3], 'season': 'autumn', 'importance': {'wood': 2}}, 'reed': {'library': 'reed'}}, "
		"'instances': [{'plant': 'elm', 'at': [0, 0], 'height_m': 9}]}");
	assert_int_equal(s.plant_count, 5);
	assert_int_equal(s.plants[0].variant_count, 4);
	for (uint32_t i = 0; i < 4; i++) {
		const struct eco_library_plant *l = &s.plants[i].library;
		assert_true(s.plants[i].model_count == 0 && s.plants[i].variant == i && l->season == ECO_SEASON_AUTUMN);
		assert_true(l->height_m == (i < 2 ? 8 : 16) && l->crown_m == (i < 2 ? 6 : 11) && l->individual == (i % 2 ? 3 : 1));
		assert_true(s.plants[i].importance[ECO_ORGAN_WOOD] == 2);
	}
	assert_string_equal(s.plants[0].library.genus, "Ulmus");
	assert_true(s.plants[4].library.height_m == eco_library_height("reed") && s.plants[4].library.season == ECO_SEASON_WINTER);
	eco_source_free(&s);
}

UNIT_TEST(what_may_not_be_said_has_a_line_and_a_column)
{
	uint32_t count;
	const struct scene_fault *bad = cases_read("tests/import/cases/scene_faults.tsv", sizeof *bad, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_source s;
		char start[64];
		const char *json = json_of(bad[i].json);
		assert_int_not_equal(eco_source_parse(&s, json, strlen(json), "s.json", false, &error), ECO_OK);
		assert_null(s.path);
		keep("bad", json, error.text);
		snprintf(start, sizeof start, "s.json%s", bad[i].place);
		if (strncmp(error.text, start, strlen(start)) != 0 || !strstr(error.text, bad[i].says))
			fail_msg("%s\n  gives  %s\n  wanted %s ... %s", json, error.text, start, bad[i].says);
		assert_int_not_equal(eco_source_parse(&s, json, strlen(json), "s.json", false, NULL), ECO_OK);
	}
}

/* ---- Files ---- */

UNIT_TEST(nested_files_are_read_once_and_come_after_their_parents)
{
	struct eco_sources sources;
	const char *root;
	input_json("scene", "leaf.json", (char[]){ "{}" });
	input_json("scene", "mid.json", (char[]){ "{'children': [{'eco': 'leaf.json', 'at': [0, 0]}]}" });
	root = input_json("scene", "root.json", (char[]){ "{'children': [{'eco': 'leaf.json', 'at': [0, 0]}, "
		"{'eco': 'leaf.json', 'at': [9, 0]}, {'eco': 'mid.json', 'at': [0, 0]}, "
		"{'eco': '../scene/mid.json', 'at': [0, 5]}]}" });
	assert_good(eco_sources_load(&sources, root, &cause));
	assert_int_equal(sources.count, 3);
	assert_string_equal(sources.items[0].name, "root");
	for (uint32_t i = 0; i < sources.count; i++)
		for (uint32_t j = 0; j < sources.items[i].child_count; j++)
			assert_true(sources.items[i].children[j].source > i);
	assert_int_equal(sources.items[0].children[0].source, sources.items[0].children[1].source);
	assert_int_equal(sources.items[0].children[2].source, sources.items[0].children[3].source);
	eco_sources_free(&sources);
}

static void load_fails(const char *path, const char *says, const char *also)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_sources sources;
	assert_int_not_equal(eco_sources_load(&sources, path, &error), ECO_OK);
	if (!strstr(error.text, says) || !strstr(error.text, also))
		fail_msg("%s\n  wanted %s ... %s", error.text, says, also);
	assert_null(sources.items);
}

UNIT_TEST(a_cycle_shows_its_chain)
{
	const char *root;
	input_json("scene", "b.json", (char[]){ "{'children': [{'eco': 'c.json', 'at': [0, 0]}]}" });
	input_json("scene", "c.json", (char[]){ "{'name': 'c',\n 'children': [{'at': [0, 0], 'eco': "
		"'b.json'}]}" });
	root = input_json("scene", "a.json", (char[]){ "{'children': [{'eco': 'b.json', 'at': [0, 0]}]}" });
	load_fails(root, "c.json:2:37: a file cannot be inside itself: ",
		"b.json -> build/tmp/scene/c.json -> build/tmp/scene/b.json");
	root = input_json("scene", "self.json", (char[]){ "{'children': [{'eco': 'self.json', 'at': [0, 0]}]}" });
	load_fails(root, "self.json:1:23:", "self.json -> build/tmp/scene/self.json");
}

UNIT_TEST(a_missing_file_is_named_where_it_is_named)
{
	load_fails("build/tmp/scene/none.json", "none.json", "No such file");
	load_fails(input_json("scene", "m.json", (char[]){ "{'plants': {\n 'oak': {'model': 'gone.obj'}}}" }),
		"m.json:2:19:", "gone.obj: No such file");
	load_fails(input_json("scene", "m.json", (char[]){ "{'ground': {'heights':\n'gone.tif'}}" }), "m.json:2:1:",
		"gone.tif");
	load_fails(input_json("scene", "m.json", (char[]){ "{'children': [{'eco': 'gone.json', 'at': [0, "
		"0]}]}" }), "m.json:1:23:", "gone.json");
	input_json("scene", "o.obj", (char[]){ "" });
	load_fails(input_json("scene", "m.json", (char[]){ "{" PLANTS ", 'instances': [{" ROWS
		", 'plant': 'oak'}]}" }), "m.json:1:", "t.csv");
}

UNIT_TEST(ground_belongs_to_the_outermost_file)
{
	input_json("scene", "dem.tif", (char[]){ "" });
	input_json("scene", "g.json", (char[]){ "{'ground': {'heights': 'dem.tif'}}" });
	load_fails(input_json("scene", "n.json", (char[]){ "{'children': [{'eco': 'g.json', 'at': [0, 0]}]}" }),
		"n.json:1:23:", "only the outermost");
}
