/* Scenes, cameras and models of ecobench, with a stand-in for ecopack that writes down what it was asked for.
 */
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
static const struct bench_section section = { .name = "test", .title = "Test" };

static uint32_t asked(void)
{
	FILE *file = fopen(ROOT "/asked", "r");
	uint32_t count = 0;
	for (int c; file && (c = fgetc(file)) != EOF;)
		count += c == '\n';
	if (file)
		fclose(file);
	return count;
}

static int set_up(void **unused)
{
	struct eco_error error = { 0 };
	if (system("rm -rf " ROOT " && mkdir -p " ROOT "/programs"))
		return 1;
	if (bench_file_write(ROOT "/programs/ecopack", program, sizeof program - 1, &error)
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
	struct eco_error error = { 0 };
	bench_end(&bench, ECO_OK, &error);
	bench_close(&bench);
	return 0;
}

UNIT_TEST_BETWEEN(test_packs_are_built_once_for_each_order, set_up, tear_down)
{
	struct eco_error error = { 0 };
	char path[512], other[512];
	assert_int_equal(bench_scene(&bench, "trees640", NULL, path, &error), ECO_OK);
	assert_int_equal(access(path, R_OK), 0);
	assert_int_equal(asked(), 2);
	assert_int_equal(bench_scene(&bench, "trees640", NULL, path, &error), ECO_OK);
	assert_int_equal(asked(), 2);
	assert_int_equal(bench_scene(&bench, "trees640", "stochastic", other, &error), ECO_OK);
	assert_int_equal(asked(), 3);
	assert_string_not_equal(path, other);
}

UNIT_TEST_BETWEEN(test_the_quick_bench_names_the_scenes_that_it_leaves_out, set_up, tear_down)
{
	struct eco_error error = { 0 };
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

UNIT_TEST_BETWEEN(test_packs_without_their_stamp_are_built_again, set_up, tear_down)
{
	static const char *const damages[] = { "rm %s.stamp", "rm %s", "echo x >%s.stamp", ": >%s.stamp" };
	for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
		struct eco_error error = { 0 };
		char path[512], command[640];
		assert_int_equal(bench_scene(&bench, "crown", NULL, path, &error), ECO_OK);
		uint32_t before = asked();
		snprintf(command, sizeof command, damages[i], path);
		assert_int_equal(system(command), 0);
		assert_int_equal(bench_scene(&bench, "crown", NULL, path, &error), ECO_OK);
		assert_int_equal(asked(), before + 1);
		assert_int_equal(access(path, R_OK), 0);
	}
}

UNIT_TEST_BETWEEN(test_failures_are_said_and_leave_no_stamp, set_up, tear_down)
{
	struct eco_error error = { 0 };
	char path[512];
	assert_int_equal(bench_scene(&bench, "desert", NULL, path, &error), ECO_BAD_USAGE);
	error = (struct eco_error){ 0 };
	assert_int_equal(bench_scene(&bench, "scbi", NULL, path, &error), ECO_NOT_FOUND);
	assert_non_null(strstr(error.text, "--data"));
	error = (struct eco_error){ 0 };
	bench.data = ROOT;
	assert_int_equal(bench_scene(&bench, "scbi", NULL, path, &error), ECO_NOT_FOUND);
	error = (struct eco_error){ 0 };
	assert_int_equal(system(": >" ROOT "/broken"), 0);
	assert_int_equal(bench_scene(&bench, "palms", NULL, path, &error), ECO_IO);
	assert_int_equal(system("rm " ROOT "/broken"), 0);
	error = (struct eco_error){ 0 };
	assert_int_equal(bench_scene(&bench, "palms", NULL, path, &error), ECO_OK);
}

UNIT_TEST_BETWEEN(test_a_card_tree_is_a_scene_of_its_own, set_up, tear_down)
{
	struct eco_error error = { 0 };
	char path[512], text[512] = "";
	assert_int_equal(bench_scene(&bench, "cards-2", NULL, path, &error), ECO_OK);
	assert_int_equal(access(path, R_OK), 0);
	FILE *file = fopen(ROOT "/cache/scenes/cards-2/scene.json", "r");
	assert_non_null(file);
	assert_true(fread(text, 1, sizeof text - 1, file) > 0);
	fclose(file);
	assert_non_null(strstr(text, "models/cards-2.obj"));
}

UNIT_TEST_BETWEEN(test_views_run_from_first_to_last_of_the_script, set_up, tear_down)
{
	struct eco_request requests[7];
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
}

UNIT_TEST_BETWEEN(test_the_crown_is_seen_from_outside_all_around, set_up, tear_down)
{
	struct eco_request requests[16];
	assert_int_equal(bench_scene_views(&bench, "crown", requests, 16), 16);
	for (uint32_t i = 0; i < 16; i++)
		assert_true(hypot(requests[i].view.eye[0], requests[i].view.eye[1]) > 12
			&& requests[i].view.eye[2] > 1);
}

UNIT_TEST_BETWEEN(test_models_are_those_that_read, set_up, tear_down)
{
	struct eco_error error = { 0 };
	struct bench_model *models;
	uint32_t count;
	assert_int_equal(system("mkdir -p " ROOT "/data/models/a/b && cd " ROOT
		"/data/models && printf 'v 0 0 0\\nv 0 2 0\\nv 1 1 0\\nf 1 2 3\\n' "
		">a/b/good.obj && echo nonsense >a/bad.obj && echo text >readme.txt && : >a/empty.glb && xz "
		"-c a/b/good.obj >packed.OBJ.xz"), 0);
	bench.data = ROOT "/data";
	assert_int_equal(bench_models(&bench, &models, &count, &error), ECO_OK);
	static const char *const names[] = { "good.obj", "packed.OBJ", "generated-forest.obj",
		"generated-park.obj", "generated-sunflowers.obj" };
	assert_int_equal(count, 5);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_model read;
		assert_string_equal(models[i].name, names[i]);
		assert_true(models[i].generated == (i >= 2));
		assert_int_equal(bench_model_read(&bench, &models[i], &read, &error), ECO_OK);
		assert_int_equal(read.triangle_count, 1);
		eco_model_free(&read);
	}
	free(models);
}

UNIT_TEST_BETWEEN(test_packed_models_are_those_of_their_folder, set_up, tear_down)
{
	struct eco_error error = { 0 };
	struct bench_model *models;
	uint32_t count;
	/* one folder, another, and the same with one more triangle */
	for (int i = 0; i < 3; i++) {
		static const char *const folders[] = { ROOT "/one", ROOT "/two", ROOT "/two" };
		char command[512];
		struct eco_model read;
		snprintf(command, sizeof command, "mkdir -p %s/models && cd %s/models && rm -f * && (printf "
			"'v 0 0 0\\nv 0 2 0\\nv 1 1 0\\nv 1 1 1\\n'; "
			"for i in $(seq %d); do echo f 1 2 $((2 + i)); done) | xz >plant.obj.xz", folders[i],
			folders[i], i ? i : 2);
		assert_int_equal(system(command), 0);
		bench.data = folders[i];
		assert_int_equal(bench_models(&bench, &models, &count, &error), ECO_OK);
		assert_int_equal(count, 4);
		assert_int_equal(bench_model_read(&bench, &models[0], &read, &error), ECO_OK);
		assert_int_equal(read.triangle_count, i ? i : 2);
		eco_model_free(&read);
		free(models);
	}
}
