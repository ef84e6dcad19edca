/* SCENE.json: what it may say, and that what it may not say is answered with a place. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/scene/scene.h"
#include "tests/support/files.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

/* Documents go to the folder that SCENES_KEPT names, with the reader's verdicts: test_scene_schema.sh holds the schema
 * against them. */
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
		"'ash': {'model': 'c.obj', 'grade': true, 'object': true}},\n'instances': [{'plant': 'ash', 'at': [1, 2, 3], 'yaw_deg': 30, "
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
#define LONG(n) "'a23456789b23456789c23456789d23456789-" #n "': {'model': 'o.obj'}"
#define MANY_PLANTS \
	"'plants': {" LONG(1) ", " LONG(2) ", " LONG(3) ", " LONG(4) ", " LONG(5) ", " LONG(6) "}"
#define ROWS "'from': 't.csv', 'x': 'x', 'y': 'y'"

static const struct { const char *json, *place, *says; } bad[] = {
	{ "", ":1:", "" },
	{ "[1]", ":1:1:", "must be an object" },
	{ "{'name': 'a',\n  'nam': 1}", ":2:3:", "unknown field \"nam\"; known here: name, crs" },
	{ "{'name': 'a', 'name': 'b'}", ":1:", "duplicate" },
	{ "{'name':\n\n   3}", ":3:4:", "\"name\" must be a text, not a number" },
	{ "{'\\u00e9': 1, 'x': 2}", ":1:2:", "unknown field" },
	{ "{'name': ''}", ":1:10:", "1 to 63" },
	{ "{'name': 'a\\u001bb'}", ":1:10:", "control character" },
	{ "{'name': 'a\\u009b31m'}", ":1:10:", "control character" },
	{ "{'name': 'a\\u202eb'}", ":1:10:", "steers the direction" },
	{ "{'name': 'a\\u2028b'}", ":1:10:", "the lines of text" },
	{ "{'plants': {'o\\u2066ak': {'model': 'o'}}}", ":1:", "control character" },
	{ "{'plants': {'o\\u0085ak': {'model': 'o'}}}", ":1:", "control character" },
	{ "{'crs': 'EPSG:1'}", ":1:1:", "\"origin\" is missing" },
	{ "{'origin': [1]}", ":1:12:", "2 or 3" },
	{ "{'origin': [1, '2', 3]}", ":1:16:", "must be a number, not a text" },
	{ "{'origin': [1, 1e300, 3]}", ":1:16:", "between" },
	{ "{'tile': {'instances': 0}}", ":1:24:", "between 1 and 65536" },
	{ "{'tile': {'instances': 1.5}}", ":1:24:", "whole number" },
	{ "{'ground': {'band': 1}}", ":1:12:", "\"heights\" is missing" },
	{ "{'ground': {'heights': 'a', 'crs': 'EPSG:1'}}", ":1:36:", "add \"crs\": \"EPSG:1\"" },
	{ "{'ground': {'heights': []}}", ":1:24:", "names no raster" },
	{ "{'ground': {'heights': ['a', 3]}}", ":1:30:", "must be a text" },
	{ "{'ground': {'heights': 'a', 'scale': 0}}", ":1:38:", "would make all heights one" },
	{ "{'ground': {'heights': 'a', 'unit': 'yd'}}", ":1:37:", "is not one of m, dm, cm" },
	{ "{'ground': {'heights': 'a', 'pixel': 3}}", ":1:12:", "go together" },
	{ "{'ground': {'heights': ['a', 'b'], 'pixel': 3, 'north_west': [1, 2]}}", ":1:62:", "a world file" },
	{ "{'plants': {'oak': {'model': 'o', 'height': 3}}}", ":1:35:",
		"known here: model, variants, height_m, unit, up, grade, foot, object, parts, importance" },
	{ "{'plants': {'oak': {'library': 'oak'}}}", ":1:32:", "in the library: round, oval, conical" },
	{ "{'plants': {'oak': {'library': 'round', 'model': 'o'}}}", ":1:41:", "known here: library, height_m, crown_m" },
	{ "{'plants': {'oak': {'library': 'round', 'genus': 'Xyzzy'}}}", ":1:32:", "no genus of \"Xyzzy\" is known" },
	{ "{'plants': {'oak': {'library': 'round', 'height_m': 0}}}", ":1:32:", "is 0.02 to 150 m high" },
	{ "{'plants': {'oak': {'library': 'round', 'height_m': [3, 1e9]}}}", ":1:32:", "is 0.02 to 150 m high" },
	{ "{'plants': {'oak': {'library': 'round', 'height_m': 'tall'}}}", ":1:53:", "is a number, or an array" },
	{ "{'plants': {'oak': {'library': 'round', 'height_m': []}}}", ":1:53:", "has 1 to 16 numbers" },
	{ "{'plants': {'oak': {'library': 'round', 'height_m': [3, 4], 'crown_m': [1, 2, 3]}}}", ":1:20:", "each has its own" },
	{ "{'plants': {'oak': {'library': 'round', 'crown_m': 1e9}}}", ":1:32:", "times as wide" },
	{ "{'plants': {'oak': {'library': 'round', 'individual': 1.5}}}", ":1:32:", "is a whole number" },
	{ "{'plants': {'oak': {'library': 'round', 'individual': 17}}}", ":1:32:", "there are 16" },
	{ "{'plants': {'oak': {'library': 'round', 'season': 'monsoon'}}}", ":1:51:", "\"winter\"" },
	{ "{'season': 'wet'}", ":1:12:", "\"winter\"" },
	{ "{'plants': {'oak': {'model': 'o', 'grade': 1}}}", ":1:44:", "is true or false" },
	{ "{'plants': {'hut': {'model': 'o', 'object': 'yes'}}}", ":1:45:", "is true or false" },
	{ "{'plants': {'oak': {}}}", ":1:20:", "a plant has either \"model\"" },
	{ "{'plants': {'oak': {'model': []}}}", ":1:30:", "names no file" },
	{ "{'plants': {'oak': {'model': ['a', 3]}}}", ":1:36:", "must be a text" },
	{ "{'plants': {'oak': {'model': 'o', 'height_m': -3}}}", ":1:47:", "between" },
	{ "{'plants': {'oak': {'model': 'o', 'importance': {'root': 1}}}}", ":1:50:",
		"wood, foliage, flower" },
	{ "{" PLANTS ", 'instances': [\n {'plant': 'oak', 'at': [0, 0]},\n {'plant': 'elm', 'at': [0, 0]}]}", ":3:12:",
		"plant \"elm\" is not among \"plants\": oak" },
	{ "{" MANY_PLANTS ", 'instances': [{'plant': 'elm', 'at': [0, 0]}]}", ":1:",
		"plants\": a23456789b23456789c23456789d23456789-1, a23456789b23456789c23456789d23456789-2, "
		"a23456789b23456789c23456789d23456789-3, a23456789b23456789c23456789d23456789-4 and 2 more" },
	{ "{'importance': 0}", ":1:16:", "between 0.01 and 100" },
	{ "{'plants': {'oak': {'model': 'o', 'parts': [{'name': 'p', 'importance': 101}]}}}", ":1:73:", "between 0.01 and 100" },
	{ "{'plants': {'oak': {'model': 'o', 'parts': [{'name': 'p'}]}}}", ":1:45:", "\"is\" is missing" },
	{ "{" PLANTS ", 'instances': [{'plant': 'oak'}]}", ":1:", "\"at\" is missing" },
	{ "{" PLANTS ", 'instances': [{'plant': 'oak', 'at': [0, 0], 'scale': 0}]}", ":1:", "between" },
	{ "{" PLANTS ",\n'instances': [{" ROWS "}]}", ":2:15:", "say what stands there" },
	{ "{" PLANTS ",\n'instances': [{'from': 't.csv', 'y': 'y', 'plant': 'oak'}]}", ":2:15:",
		"\"x\" is missing" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'species': 's'}]}", ":2:62:", "leave out" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'species': 's', 'map': {'a': 'oak', 'b': 'elm'}}]}", ":2:", "\"elm\" is not among" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'crs': 'EPSG:4326'}]}", ":2:",
		"the scene has no CRS" },
	{ "{'name': 'a',\n 'notes': {'crs': 3}}", ":2:19:", "a note is a text" },
	{ "{'notes': ['a', ['b']]}", ":1:17:", "a note is a text" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'height_m': {'from_dbh_mm': 'd'}}]}", ":2:", "needs \"max\"" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'height_m': {'column': 'd', 'value': 3}}]}", ":2:", "exactly one" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'height_m': {'column': 'd', "
		"'unit': 'yd'}}]}", ":2:",
		"not one of m, dm, cm" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'height_m': {'from_dbh_mm': "
		"'d', 'unit': 'cm', 'max': 9, 'rate': 1}}]}", ":2:", "leave out \"unit\"" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': 3}]}", ":2:", "must be an object" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h'}}]}", ":2:", "\"palette\" is missing" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'palette': 'health'}}]}", ":2:", "\"column\" is missing" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': 'rainbow'}}]}", ":2:", "a palette is one of health, age, status, owner" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': {}}}]}", ":2:", "without a colour" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': {'good': 'green'}}}]}", ":2:", "no colour" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': ['#000000'], 'breaks': [1]}}]}", ":2:", "an array of 2 colours" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': 'age', 'breaks': [5, 3]}}]}", ":2:", "ascend" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': 'age', 'breaks': ['NaN']}}]}", ":2:", "ascend" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': {'a': '#000000'}, 'breaks': [1]}}]}", ":2:", "need the name of a palette" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'tint': {'column': 'h', 'palette': 'age', 'break': [1]}}]}", ":2:", "unknown field" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'separator': 'ab'}]}", ":2:",
		"\"separator\"" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'decimal': ',', 'thousands': ','}]}", ":2:", "are different signs" },
	{ "{" PLANTS ",\n'instances': [{'from': 't.csv', 'plant': 'oak', 'unit': 'cm'}]}", ":2:",
		"\"unit\" is that of x and y without" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'polar': {'azimuth': 'a'}}]}", ":2:",
		"\"distance\" is missing" },
	{ "{" PLANTS ",\n'instances': [{" ROWS ", 'plant': 'oak', 'polar': {'azimuth': 'a', 'distance': "
		"'d', 'whole_turn': 380}}]}", ":2:", "360 (degrees) or 400 (gon)" },
	{ "{" PLANTS ",\n'instances': [{'from': 't.csv', 'plant': 'oak', 'quadrat': {'column': 'q', 'size_m': 20}}]}",
		":2:", "\"x\" is missing" },
	{ "{'instances': [{'extrude': 'b.gpkg', 'height': 3}]}", ":1:38:", "known here: extrude, layer, crs, roof" },
	{ "{'instances': [{'extrude': 'b.gpkg', 'height_m': 0}]}", ":1:50:", "between 0.1 and 1000" },
	{ "{'instances': [{'extrude': 'b.gpkg', 'height_m': [[]]}]}", ":1:51:", "an object such as" },
	{ "{'instances': [{'extrude': 'b.gpkg', 'height_m': {'column': 'h', 'storeys': 's'}}]}", ":1:50:", "a height's object is" },
	{ "{'instances': [{'extrude': 'b.gpkg', 'height_m': {'storeys': 's', 'unit': 'm'}}]}", ":1:50:", "a height's object is" },
	{ "{'instances': [{'extrude': 'b.gpkg', 'height_m': {'storeys': 's', 'storey_m': 0}}]}", ":1:79:", "between 0.5 and 100" },
	{ "{'children': [{'at': [0, 0]}]}", ":1:15:", "\"eco\" is missing" },
	{ "{'children': {}}", ":1:14:", "must be an array" },
	{ "{'instances': [[]]}", ":1:16:", "must be an object" },
	{ "{'origin': [0, 0],\n}", ":2:1:", "(no comma stands before a closing bracket)" },
	{ "{'origin': [0, 0, ]}", ":1:19:", "(no comma stands before a closing bracket)" },
	{ "{'name': 'a'\n 'crs': 3}", ":2:6:", "(is a comma missing before it?)" },
	{ "{'name': 'a', // mine\n}", ":1:15:", "(JSON has no comments)" },
	{ "ECOPACK1 and more", ":1:1:", "not a JSON file" },
	{ "glTF\x02 and more", ":1:1:", "a model, not a JSON file" },
	{ "\x89PNG\r\n and more", ":1:1:", "a picture, not a JSON file" },
	{ "\xff\xfe{", ":1:1:", "save it as UTF-8" },
	{ "\xef\xbb\xbf{'name': 3}", ":1:10:", "must be a text" },
};

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
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
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
