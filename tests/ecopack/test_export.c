/* 3D Tiles: every file that is named is there, volumes hold what is below them, errors only shrink, and each
 * plant stands in each level once. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/model/gltf.h"
#include "tests/support/files.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/test_export"
#define DIR ROOT "/tiles"

static double slope(double x, double y) { return 0.1 * x + sin(0.05 * y); }

static int make_pack(void **state)
{
	struct eco_error error = { 0 };
	struct eco_ground ground = ground_make(90, 70, -8, -8, 8, slope);
	folder_make(ROOT);
	folder_empty(DIR "/plants");
	folder_empty(DIR "/tiles");
	folder_empty(DIR);
	rmdir(DIR "/plants");
	rmdir(DIR "/tiles");
	rmdir(DIR);
	main_progress_quiet(true);
	assert_ok(eco_ground_extend(&ground, &error), error);
	assert_ok(sample_pack_write_on(ROOT "/sample.eco", &ground, true, &error), error);
	eco_ground_free(&ground);
	return 0;
}

static enum eco_code run(const char *line, struct eco_error *error)
{
	char text[300], *argv[12];
	int argc = 0;
	snprintf(text, sizeof text, "%s --quiet", line);
	for (char *word = strtok(text, " "); word && argc < 12; word = strtok(NULL, " "))
		argv[argc++] = word;
	*error = (struct eco_error){ 0 };
	return main_command_export.run(argc, argv, error);
}

/* ---- Walking ---- */

struct seen { uint64_t instances, contents, levels; };

static json_t *load(const char *name)
{
	char path[200];
	snprintf(path, sizeof path, DIR "/%s", name);
	json_t *json = json_load_file(path, 0, NULL);
	if (!json)
		fail_msg("%s is no JSON", path);
	return json;
}

static enum eco_code count_instances(void *ctx, uint32_t node, const double world[16])
{
	struct { struct eco_gltf *doc; uint64_t instances, meshes; } *c = ctx;
	struct eco_gltf_instances instances;
	struct eco_error error = { 0 };
	bool there;
	(void)world;
	assert_ok(eco_gltf_instances_open(c->doc, node, &there, &instances, &error), error);
	if (there) {
		c->instances += instances.count;
		eco_gltf_instances_close(&instances);
	}
	c->meshes += eco_gltf_index(eco_gltf_item(c->doc, "nodes", node), "mesh") != UINT32_MAX;
	return ECO_OK;
}

/* Every accessor is read; instances are counted. */
static uint64_t read_content(const char *uri)
{
	char path[200];
	struct eco_error error = { 0 };
	struct { struct eco_gltf *doc; uint64_t instances, meshes; } c = { .instances = 0 };
	snprintf(path, sizeof path, DIR "/%s", uri);
	assert_ok(eco_gltf_open(&c.doc, path, &error), error);
	size_t accessors = json_array_size(json_object_get(eco_gltf_json(c.doc), "accessors"));
	for (uint32_t i = 0; i < accessors; i++) {
		struct eco_gltf_accessor a;
		assert_ok(eco_gltf_accessor_open(c.doc, i, 0, &a, &error), error);
		for (uint64_t k = 0; k < a.count; k++) {
			double values[16];
			eco_gltf_element(&a, k, values);
			for (uint32_t v = 0; v < a.components; v++)
				assert_true(isfinite(values[v]));
		}
		eco_gltf_accessor_close(&a);
	}
	assert_ok(eco_gltf_walk(c.doc, count_instances, &c, &error), error);
	assert_true(c.meshes > 0);
	eco_gltf_close(c.doc);
	return c.instances;
}

static void assert_inside(const json_t *inner, const json_t *outer)
{
	for (size_t k = 0; k < 3; k++) {
		double a = json_number_value(json_array_get(inner, k)),
			b = json_number_value(json_array_get(outer, k)),
			ha = json_number_value(json_array_get(inner, 3 + 4 * k)),
			hb = json_number_value(json_array_get(outer, 3 + 4 * k));
		assert_true(fabs(a - b) + ha <= hb * (1 + 1e-9) + 0.011);
	}
}

static void walk(const json_t *tile, const json_t *outer, double error_m, struct seen *seen, bool above)
{
	const json_t *box = json_object_get(json_object_get(tile, "boundingVolume"), "box"), *child;
	const char *uri = json_string_value(json_object_get(json_object_get(tile, "content"), "uri"));
	double own = json_number_value(json_object_get(tile, "geometricError"));
	size_t i;
	assert_int_equal(json_array_size(box), 12);
	assert_true(own <= error_m);
	if (outer)
		assert_inside(box, outer);
	uint64_t instances = uri ? read_content(uri) : 0;
	seen->contents += uri != NULL;
	/* of levels that replace each other the first counts, and the others are of as many */
	if (instances && !above)
		seen->instances += instances;
	seen->levels += instances > 0;
	json_array_foreach(json_object_get(tile, "children"), i, child)
		walk(child, box, own, seen, instances > 0);
}

UNIT_TEST(all_plants_are_in_a_tree_of_tiles)
{
	struct eco_error error;
	struct seen seen = { 0 };
	struct eco_pack *pack;
	assert_ok(run(ROOT "/sample.eco --3dtiles " DIR, &error), error);
	json_t *json = load("tileset.json");
	assert_string_equal(json_string_value(json_object_get(json_object_get(json, "asset"), "version")),
		"1.1");
	assert_int_equal(json_array_size(json_object_get(json_object_get(json, "root"), "transform")), 16);
	walk(json_object_get(json, "root"), NULL, INFINITY, &seen, false);
	/* plants and a raster of 90 x 70 samples, 8 m apart: none of the ground goes on to the horizon */
	const json_t *root = json_object_get(json, "root");
	const json_t *box = json_object_get(json_object_get(root, "boundingVolume"), "box");
	assert_true(json_number_value(json_array_get(box, 3)) < 500);
	assert_true(json_number_value(json_array_get(box, 7)) < 500);
	/* it has no content: from afar, too, viewers look below */
	assert_true(json_number_value(json_object_get(root, "geometricError")) > 1e6);
	assert_ok(eco_pack_open(&pack, ROOT "/sample.eco", &error), error);
	assert_int_equal(seen.instances, pack->scene.tiles[pack->scene.root].instance_count);
	assert_true(seen.contents > seen.levels && seen.levels > 0);
	eco_pack_close(pack);
	json_decref(json);
}

/* The scene's origin lies where its longitude and latitude say, and its axes are a rotation. */
UNIT_TEST(a_place_on_earth_is_the_roots_transform)
{
	json_t *json = load("tileset.json"),
		*list = json_object_get(json_object_get(json, "root"), "transform");
	double m[16], length = 0, degree = acos(-1) / 180;
	for (size_t i = 0; i < 16; i++)
		m[i] = json_number_value(json_array_get(list, i));
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++) {
			double sum = m[4 * a] * m[4 * b] + m[4 * a + 1] * m[4 * b + 1]
				+ m[4 * a + 2] * m[4 * b + 2];
			assert_true(fabs(sum - (a == b)) < 1e-9);
		}
	for (int k = 0; k < 3; k++)
		length += m[12 + k] * m[12 + k];
	assert_true(fabs(sqrt(length) - 6366500) < 3000);
	assert_true(fabs(atan2(m[13], m[12]) / degree - 11.5621) < 1e-9);
	json_decref(json);
}

UNIT_TEST(what_is_there_is_kept_and_failures_leave_nothing)
{
	struct eco_error error;
	assert_int_equal(run(ROOT "/sample.eco --3dtiles " ROOT "/sample.eco", &error), ECO_BAD_USAGE);
	assert_non_null(strstr(error.text, "is kept"));
	assert_int_equal(run(ROOT "/none.eco --3dtiles " ROOT "/other", &error), ECO_NOT_FOUND);
	assert_int_not_equal(access(ROOT "/other", F_OK), 0);
	assert_int_equal(run(ROOT "/sample.eco", &error), ECO_BAD_USAGE);
	size_t size;
	uint8_t *bytes = file_read(ROOT "/sample.eco", &size);
	bytes[size - 100] ^= 1;
	file_write(ROOT "/damaged.eco", bytes, size);
	free(bytes);
	assert_int_not_equal(run(ROOT "/damaged.eco --3dtiles " ROOT "/other", &error), ECO_OK);
	assert_int_not_equal(access(ROOT "/other", F_OK), 0);
}

int main(void)
{
	return unit_tests_run(make_pack, NULL);
}
