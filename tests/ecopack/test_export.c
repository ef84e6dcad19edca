/* 3D Tiles: every file that is named is there, volumes hold what is below them, errors only shrink, each
 * plant stands in each level once, and compressed triangles are those that --plain writes. */
#include <glob.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/model/gltf.h"
#include "tests/support/files.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/test_export"
#define DIR ROOT "/tiles"
#define PLAIN ROOT "/plain"

static double slope(double x, double y) { return 0.1 * x + sin(0.05 * y); }

static int make_pack(void **state)
{
	FREED(eco_ground) ground = ground_make(90, 70, -8, -8, 8, slope);
	assert_int_equal(system("rm -rf " ROOT), 0);
	folder_make(ROOT);
	eco_progress_quiet(true);
	eco_ground_extend(&ground);
	assert_good(sample_pack_write_on(ROOT "/sample.eco", &ground, true, &cause));
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
	const json_t *json = eco_gltf_item(c->doc, "nodes", node),
		*places = json_object_get(eco_gltf_extension(json, "EXT_mesh_gpu_instancing"), "attributes");
	(void)world;
	if (places)
		c->instances += eco_gltf_whole(eco_gltf_item(c->doc, "accessors",
			eco_gltf_index(places, "TRANSLATION")), "count", 0);
	c->meshes += eco_gltf_index(json, "mesh") != UINT32_MAX;
	return ECO_OK;
}

/* Every accessor is read; instances are counted. */
static uint64_t read_content(const char *uri)
{
	char path[200];
	struct { struct eco_gltf *doc; uint64_t instances, meshes; } c = { .instances = 0 };
	snprintf(path, sizeof path, DIR "/%s", uri);
	assert_good(eco_gltf_open(&c.doc, path, &cause));
	size_t accessors = json_array_size(json_object_get(c.doc->root, "accessors"));
	for (uint32_t i = 0; i < accessors; i++) {
		AT_END(eco_gltf_accessor_close) struct eco_gltf_accessor a;
		assert_good(eco_gltf_accessor_open(c.doc, i, 0, &a, &cause));
		for (uint64_t k = 0; k < a.count; k++) {
			double values[16];
			eco_gltf_element(&a, k, values);
			for (uint32_t v = 0; v < a.components; v++)
				assert_true(isfinite(values[v]));
		}
	}
	assert_good(eco_gltf_walk(c.doc, count_instances, &c, &cause));
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

/* ---- Compression ---- */

/* Sums over the corners of all triangles, in whatever order these are: of each value and of its square. */
struct sums { double of[2][4]; size_t count; };

static struct sums sums_of(struct eco_gltf *doc, const json_t *primitive, const char *name)
{
	AT_END(eco_gltf_accessor_close) struct eco_gltf_accessor index, a;
	struct sums sums = { .count = 0 };
	assert_good(eco_gltf_accessor_open(doc, eco_gltf_index(primitive, "indices"), 1, &index, &cause));
	assert_good(eco_gltf_accessor_open(doc, eco_gltf_index(json_object_get(primitive, "attributes"), name), 0, &a,
		&cause));
	sums.count = (size_t)index.count;
	for (size_t i = 0; i < sums.count; i++) {
		double values[16];
		eco_gltf_element(&a, eco_gltf_element_index(&index, i), values);
		for (size_t k = 0; k < a.components; k++) {
			sums.of[0][k] += values[k];
			sums.of[1][k] += values[k] * values[k];
		}
	}
	return sums;
}

/* Positions of a summary are rounded to a part of their size, all others to a millimetre. */
static void assert_same_triangles(struct eco_gltf *docs[2], const json_t *primitives[2], bool is_summary)
{
	static const char *const names[] = { "POSITION", "COLOR_0", "TEXCOORD_0" };
	for (size_t n = 0; n < 3; n++) {
		if (!json_object_get(json_object_get(primitives[0], "attributes"), names[n]))
			continue;
		struct sums plain = sums_of(docs[0], primitives[0], names[n]),
			packed = sums_of(docs[1], primitives[1], names[n]);
		double off = n == 0 ? is_summary ? 0.5 : 0.001 : 1e-4;
		assert_int_equal(plain.count, packed.count);
		for (int k = 0; k < 4; k++) {
			double most = sqrt(plain.of[1][k] / (double)plain.count) + off;
			assert_true(fabs(plain.of[0][k] - packed.of[0][k]) <= off * (double)plain.count);
			assert_true(fabs(plain.of[1][k] - packed.of[1][k]) <= 2 * off * most * (double)plain.count);
		}
	}
}

static bool requires_meshopt(const struct eco_gltf *doc)
{
	const json_t *name;
	size_t i;
	json_array_foreach(json_object_get(doc->root, "extensionsRequired"), i, name)
		if (strcmp(json_string_value(name), "EXT_meshopt_compression") == 0)
			return true;
	return false;
}

static void assert_same_content(const char *name)
{
	static const char *const dirs[2] = { PLAIN, DIR };
	struct eco_gltf *docs[2];
	const json_t *mesh;
	size_t number, i;
	for (i = 0; i < 2; i++) {
		char path[400];
		snprintf(path, sizeof path, "%s/tiles/%s", dirs[i], name);
		assert_good(eco_gltf_open(&docs[i], path, &cause));
		assert_int_equal(requires_meshopt(docs[i]), i == 1);
	}
	assert_true(json_equal(json_object_get(docs[0]->root, "nodes"),
		json_object_get(docs[1]->root, "nodes")));
	json_array_foreach(json_object_get(docs[0]->root, "meshes"), number, mesh) {
		const json_t *lists[2] = { json_object_get(mesh, "primitives"),
			json_object_get(eco_gltf_item(docs[1], "meshes", number), "primitives") };
		assert_int_equal(json_array_size(lists[0]), json_array_size(lists[1]));
		for (i = 0; i < json_array_size(lists[0]); i++)
			assert_same_triangles(docs, (const json_t *[]){ json_array_get(lists[0], i),
				json_array_get(lists[1], i) }, strstr(name, "-s.") != NULL);
	}
	eco_gltf_close(docs[0]);
	eco_gltf_close(docs[1]);
}

static uint64_t bytes_of(const char *pattern)
{
	uint64_t sum = 0;
	struct stat status;
	glob_t found;
	assert_int_equal(glob(pattern, 0, NULL, &found), 0);
	for (size_t i = 0; i < found.gl_pathc; i++)
		sum += stat(found.gl_pathv[i], &status) == 0 ? (uint64_t)status.st_size : 0;
	globfree(&found);
	return sum;
}

UNIT_TEST(compressed_triangles_are_the_plain_ones)
{
	struct eco_error error;
	glob_t contents;
	assert_ok(run(ROOT "/sample.eco --plain --3dtiles " PLAIN, &error), error);
	assert_int_equal(glob(PLAIN "/tiles/*.gltf", 0, NULL, &contents), 0);
	assert_true(contents.gl_pathc > 3);
	for (size_t i = 0; i < contents.gl_pathc; i++)
		assert_same_content(strrchr(contents.gl_pathv[i], '/') + 1);
	globfree(&contents);
	assert_true(bytes_of(DIR "/plants/*.bin") * 2 < bytes_of(PLAIN "/plants/*.bin"));
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
	FREED_MEMORY uint8_t *bytes = file_read(ROOT "/sample.eco", &size);
	bytes[size - 100] ^= 1;
	file_write(ROOT "/damaged.eco", bytes, size);
	assert_int_not_equal(run(ROOT "/damaged.eco --3dtiles " ROOT "/other", &error), ECO_OK);
	assert_int_not_equal(access(ROOT "/other", F_OK), 0);
}

UNIT_MAIN(make_pack, NULL)
