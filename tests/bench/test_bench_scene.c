/* Scenes, cameras and models of ecobench, with a stand-in for ecopack that writes down what it was asked for.
 * */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/format/view.h"
#include "tests/bench/bench_shots.h"
#include "tests/bench/bench_state.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/bench-scene"

static const char program[] = "#!/bin/sh\n"
	"echo \"$@\" >>" ROOT "/asked\n"
	"[ ! -e " ROOT "/broken ] || exit 1\n"
	"cmd=$1 what=$2; while [ $# -gt 0 ]; do [ \"$1\" = -o ] && out=$2; shift; done\n"
	"case $cmd in\n"
	"generate) mkdir -p $out/models; echo '{}' >$out/scene.json\n"
	"  printf 'v 0 0 0\\nv 0 2 0\\nv 1 1 0\\nf 1 2 3\\n' >$out/models/$what.obj\n"
	"  echo '{\"fps\": 1, \"keyframes\": [{\"time_s\": 0, \"eye\": [0, -50, 30], \"target\": [0, 0, 0], "
	"\"fov_y_deg\": 40},"
	" {\"time_s\": 4, \"eye\": [0, -9, 1.7], \"target\": [0, 0, 1], \"fov_y_deg\": 60}]}' "
	">$out/camera.json ;;\n"
	"make) echo pack >$out ;;\n"
	"esac\n";

static struct bench_state state;
static struct bench bench;
static struct eco_error error;
static const struct bench_section section = { .name = "test", .title = "Test" };

static int asked(void)
{
	FILE *file = fopen(ROOT "/asked", "r");
	int count = 0;
	for (int c; file && (c = fgetc(file)) != EOF;)
		count += c == '\n';
	if (file)
		fclose(file);
	return count;
}

static int set_up(void **unused)
{
	error = (struct eco_error){ 0 };
	if (system("rm -rf " ROOT " && mkdir -p " ROOT "/programs")
			|| eco_file_write(ROOT "/programs/ecopack", program, sizeof program - 1, &error)
			|| system("chmod +x " ROOT "/programs/ecopack"))
		return 1;
	state = (struct bench_state){ .quiet = true };
	bench = (struct bench){ .build = ROOT "/programs", .out = ROOT "/out", .cache = ROOT "/cache",
		.state = &state };
	if (bench_open(&bench, &error))
		return 1;
	bench_begin(&bench, &section);
	return 0;
}

static int tear_down(void **unused)
{
	bench_end(&bench, ECO_OK, &error);
	bench_close(&bench);
	return 0;
}

UNIT_TEST_BETWEEN(test_packs_are_built_once_for_each_order_and_again_without_their_stamp, set_up, tear_down)
{
	static const char *const damages[] = { ":", "rm %s.stamp", "rm %s", "echo x >%s.stamp", ": >%s.stamp"
		};
	char path[512], other[512], command[640];
	assert_int_equal(bench_scene(&bench, "trees640", NULL, path, &error), ECO_OK);
	assert_int_equal(access(path, R_OK), 0);
	assert_int_equal(asked(), 2);
	assert_int_equal(bench_scene(&bench, "trees640", "stochastic", other, &error), ECO_OK);
	assert_int_equal(asked(), 3);
	assert_string_not_equal(path, other);
	for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
		snprintf(command, sizeof command, damages[i], path);
		assert_int_equal(system(command), 0);
		assert_int_equal(bench_scene(&bench, "trees640", NULL, path, &error), ECO_OK);
		assert_int_equal(asked(), 3 + i);
		assert_int_equal(access(path, R_OK), 0);
	}
}

UNIT_TEST_BETWEEN(test_the_quick_bench_names_the_scenes_that_it_leaves_out, set_up, tear_down)
{
	enum eco_code code = ECO_IO;
	char path[512];
	assert_false(bench_shot_scene(&bench, "trees5000", path, &code, &error));
	assert_int_equal(code, ECO_OK);
	assert_int_equal(asked(), 0);
	assert_true(json_is_true(json_object_get(state.left_out, "trees5000")));
	assert_true(bench_shot_scene(&bench, "outdoor", path, &code, &error));
	assert_int_equal(code, ECO_OK);
	assert_int_equal(json_object_size(state.left_out), 1);
	bench.full = true;
	assert_true(bench_shot_scene(&bench, "trees5000", path, &code, &error));
	assert_int_equal(access(path, R_OK), 0);
}

UNIT_TEST_BETWEEN(test_failures_are_said_and_leave_no_stamp, set_up, tear_down)
{
	static const struct { const char *before, *scene, *data; enum eco_code code; } steps[] = {
		{ ":", "desert", NULL, ECO_BAD_USAGE }, { ":", "scbi", NULL, ECO_NOT_FOUND },
		{ ":", "scbi", ROOT, ECO_NOT_FOUND }, { ": >" ROOT "/broken", "palms", NULL, ECO_IO },
		{ "rm " ROOT "/broken", "palms", NULL, ECO_OK }, { ":", "cards-2", NULL, ECO_OK } };
	char path[512];
	for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
		assert_int_equal(system(steps[i].before), 0);
		bench.data = steps[i].data;
		error = (struct eco_error){ 0 };
		assert_int_equal(bench_scene(&bench, steps[i].scene, NULL, path, &error), steps[i].code);
		assert_true(!error.text[0] == !steps[i].code);
	}
	/* a card tree is a scene of its own */
	assert_int_equal(system("grep -q models/cards-2.obj " ROOT "/cache/scenes/cards-2/scene.json"), 0);
}

UNIT_TEST_BETWEEN(test_views_run_from_first_to_last_of_the_script, set_up, tear_down)
{
	struct eco_request requests[16];
	assert_int_equal(bench_scene_views(&bench, "desert", requests, 7), 0);
	assert_int_equal(bench_scene_views(&bench, "outdoor", requests, 0), 0);
	for (uint32_t count = 1; count <= 7; count++) {
		assert_int_equal(bench_scene_views(&bench, "outdoor", requests, count), count);
		assert_true(requests[0].view.eye[2] == 30);
		assert_true(count == 1 || requests[count - 1].view.eye[2] == 1.7);
		for (uint32_t i = 0; i < count; i++) {
			assert_int_equal(eco_view_check(&requests[i].view, NULL), ECO_OK);
			assert_true(i == 0 || requests[i].view.eye[1] > requests[i - 1].view.eye[1]);
		}
	}
	/* the crown is seen from outside all around */
	assert_int_equal(bench_scene_views(&bench, "crown", requests, 16), 16);
	for (uint32_t i = 0; i < 16; i++)
		assert_true(hypot(requests[i].view.eye[0], requests[i].view.eye[1]) > 12
			&& requests[i].view.eye[2] > 1);
}

UNIT_TEST_BETWEEN(test_models_are_those_of_the_folder_that_read, set_up, tear_down)
{
	static const char triangle[] = "printf 'v 0 0 0\\nv 0 2 0\\nv 1 1 0\\nf 1 2 3\\n'";
	/* a folder, its models and how many triangles they have; the third time it is changed */
	static const struct { const char *folder, *make, *names; uint32_t triangles; } cases[] = {
		{ ROOT "/one",
			"%s >a/b/good.obj && echo nonsense >a/bad.obj && echo text >readme.txt && : "
			">a/empty.glb && " "xz -c a/b/good.obj >packed.OBJ.xz", "good.obj packed.OBJ", 1 },
		{ ROOT "/two", "%s | xz >plant.obj.xz", "plant.obj", 1 },
		{ ROOT "/two", "(%s; echo v 1 1 1; echo f 1 2 4) | xz >plant.obj.xz", "plant.obj", 2 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char command[640], names[512] = "";
		struct bench_model *models;
		uint32_t count;
		int at = snprintf(command, sizeof command, "mkdir -p %s/models/a/b && cd %s/models && ",
			cases[i].folder, cases[i].folder);
		snprintf(command + at, sizeof command - (size_t)at, cases[i].make, triangle);
		assert_int_equal(system(command), 0);
		bench.data = cases[i].folder;
		assert_int_equal(bench_models(&bench, &models, &count, &error), ECO_OK);
		for (uint32_t k = 0; k < count; k++) {
			struct eco_model read;
			assert_int_equal(bench_model_read(&bench, &models[k], &read, &error), ECO_OK);
			assert_int_equal(read.triangle_count, models[k].generated ? 1 : cases[i].triangles);
			assert_true(models[k].generated == !strncmp(models[k].name, "generated-", 10));
			strcat(strcat(names, k ? " " : ""), models[k].name);
			eco_model_free(&read);
		}
		snprintf(command, sizeof command,
			"%s generated-forest.obj generated-park.obj generated-sunflowers.obj",
			cases[i].names);
		assert_string_equal(names, command);
		free(models);
	}
}
