/* Generated scenes: the same seed gives the same bytes, another seed another scene; plants have believable
 * sizes; scenes parse. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "ecofiles/generate/generate.h"
#include "ecofiles/generate/generate_plants.h"
#include "ecofiles/scene/scene.h"
#include "ecofiles/format/view.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

/* A folder that is not there yet. */
static const char *fresh(const char *name)
{
	char command[600];
	const char *path = in_root(name);
	snprintf(command, sizeof command, "rm -rf '%s'", path);
	assert_int_equal(system(command), 0);
	return path;
}

static const char *in(const char *folder, const char *name)
{
	static char path[2][600];
	static int next;
	char *to = path[next++ % 2];
	snprintf(to, sizeof path[0], "%s/%s", folder, name);
	return to;
}

static void generate(const char *name, const char *folder, uint32_t plants, uint64_t seed)
{
	struct eco_error error = { 0 };
	enum eco_code code =
		eco_generate(&(struct eco_generate_options){ .name = name, .folder = folder, .plants = plants,
		.seed = seed }, &error);
	if (code)
		fail_msg("%s: %s", name, error.text);
}

static const struct { const char *name; uint32_t plants; const char *files[12]; } scenes[] = {
	{ "park", 60, { "scene.json", "camera.json", "dem.tif", "models/oak.obj", "models/oak.mtl",
		"models/linden.obj", "models/spray.png",
		"models/spruce.obj" } },
	{ "forest", 300, { "scene.json", "camera.json", "dem.tif", "stems.csv", "understory.csv",
	"models/beech.obj", "models/fern.obj",
		"models/leaf.png" } },
	{ "meadow", 500, { "scene.json", "camera.json", "dem.tif", "grasses.json", "poppies.json",
	"models/poppy.obj" } },
	{ "grove", 120, { "scene.json", "camera.json", "dem.tif", "plants.csv", "models/oak.obj",
	"models/spruce.obj" } },
	{ "palms", 60, { "scene.json", "camera.json", "plants.csv", "models/palm.obj" } },
	{ "sunflowers", 400, { "scene.json", "camera.json", "plants.csv", "models/sunflower.obj",
	"models/maple.obj" } },
	{ "outdoor", 500,
	{ "scene.json", "camera.json", "plants.csv", "models/pine.obj", "models/fern.obj" } },
	{ "billion", 230000, { "scene.json", "camera.json", "dem.tif", "hectare-0.json", "hectare-2.json",
	"block-1-1.json", "models/beech.obj" } },
	{ "city", 150, { "scene.json", "camera.json", "dem.tif", "plants.csv", "models/cards-1.obj",
	"models/cards-3.obj", "models/branch.png" } },
};
#define SCENES (sizeof scenes / sizeof *scenes)

UNIT_TEST(test_same_seed_same_bytes)
{
	for (size_t i = 0; i < SCENES; i++) {
		const char *a = fresh("a"), *b = fresh("b"), *c = fresh("c");
		generate(scenes[i].name, a, scenes[i].plants, 5);
		generate(scenes[i].name, b, scenes[i].plants, 5);
		generate(scenes[i].name, c, scenes[i].plants, 6);
		for (int f = 0; scenes[i].files[f]; f++)
			assert_true(files_alike(in(a, scenes[i].files[f]), in(b, scenes[i].files[f])));
		assert_false(files_alike(in(a, "scene.json"), in(c, "scene.json"))
			&& files_alike(in(a, "dem.tif"), in(c, "dem.tif")));
	}
}

UNIT_TEST(test_scenes_and_cameras_parse)
{
	for (size_t i = 0; i < SCENES; i++) {
		const char *folder = fresh("parse");
		struct eco_sources sources;
		struct eco_camera *camera = NULL;
		generate(scenes[i].name, folder, scenes[i].plants, 1);
		assert_good(eco_sources_load(&sources, in(folder, "scene.json"), &cause));
		assert_string_equal(sources.items[0].name, scenes[i].name);
		eco_sources_free(&sources);
		assert_good(eco_camera_load(&camera, in(folder, "camera.json"), &cause));
		assert_in_range(eco_camera_frame_count(camera), 6, 40);
		eco_camera_free(camera);
	}
}

UNIT_TEST(test_plants_have_believable_sizes)
{
	struct row { const char *name; double low, high, wide; uint32_t faces; };
	uint32_t count;
	const struct row *sizes = cases_rows("tests/import/cases/plant_sizes.tsv", "sdddu", sizeof *sizes,
		&count);
	assert_int_equal(count, gen_plant_count);
	for (uint32_t i = 0; i < gen_plant_count; i++) {
		struct gen_mesh mesh = { 0 };
		struct gen_random random = { 99 };
		double high = 0, low = 0, wide = 0;
		const struct gen_plant *plant = gen_plant_find(sizes[i].name);
		plant->grow(&mesh, plant->kind, &random);
		for (uint32_t k = 0; k < mesh.count; k++) {
			const struct gen_v3 *p = &mesh.position[k];
			assert_true(isfinite(p->x) && isfinite(p->y) && isfinite(p->z));
			high = fmax(high, p->z);
			low = fmin(low, p->z);
			wide = fmax(wide, hypot(p->x, p->y));
		}
		if (!(high >= sizes[i].low && high <= sizes[i].high && wide <= sizes[i].wide && low > -0.6
				&& mesh.face_count >= sizes[i].faces))
			fail_msg("%s: %g to %g m high, %g m wide, %u faces", sizes[i].name, low, high, wide,
				mesh.face_count);
		for (uint32_t f = 0; f < mesh.face_count; f++)
			for (uint32_t c = 0; c < mesh.faces[f].corners; c++)
				assert_true(mesh.faces[f].corner[c] < mesh.count && mesh.faces[f].material
					< mesh.material_count);
		gen_mesh_free(&mesh);
	}
}

static bool stop(void *ctx, const char *stage, double share)
{
	return --*(int *)ctx > 0;
}

UNIT_TEST(test_stopping_leaves_no_scene)
{
	const char *folder = fresh("stop");
	int left = 4;
	assert_code(eco_generate(&(struct eco_generate_options){ .name = "park", .folder = folder,
		.seed = 1, .progress = stop, .ctx = &left }, &cause), ECO_INTERRUPTED, "");
	assert_int_not_equal(access(in(folder, "scene.json"), F_OK), 0);
}

UNIT_TEST(test_errors_say_what)
{
	assert_code(eco_generate(&(struct eco_generate_options){ .name = "desert", .folder = "build/tmp/x" },
		&cause), ECO_BAD_USAGE, "park");
	assert_code(eco_generate(&(struct eco_generate_options){ .name = "park",
		.folder = "/dev/null/x" }, &cause), ECO_IO, "/dev/null/x");
}

static int start(void **state)
{
	scratch_open("generate");
	return 0;
}

UNIT_MAIN(start, scratch_close)
