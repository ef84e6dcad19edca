/* Several plants in one model. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

static char notes[2000];

static void keep(void *ctx, const char *text)
{
	size_t used = strlen(notes);
	snprintf(notes + used, sizeof notes - used, "%s\n", text);
}

/* Stems of `high` at `x` each, with a leaf on top; and a twig that hangs free in the air. */
static void import_stems(const double (*stems)[2], int count)
{
	static char text[20000];
	struct eco_error error = { 0 };
	struct eco_model model;
	size_t used = (size_t)snprintf(text, sizeof text, "# Units: m\n");
	for (int i = 0; i < count; i++)
		used += (size_t)snprintf(text + used, sizeof text - used,
			"v %g 0 0\nv %g 0 0.1\nv %g %g 0\nv %g %g 0.3\nv %g %g 0\nf %d %d %d\nf %d %d %d\n",
			stems[i][0], stems[i][0] + 0.1, stems[i][0], stems[i][1], stems[i][0] - 0.5,
			stems[i][1] * 0.9, stems[i][0] + 0.5, stems[i][1], 5 * i + 1, 5 * i + 2, 5 * i + 3,
			5 * i + 3, 5 * i + 4, 5 * i + 5);
	snprintf(text + used, sizeof text - used, "v 9 4 0\nv 9.5 4 0\nv 9 4.5 0\nf -1 -2 -3\n");
	const char *path = input_text("apart", "plants.obj", text);
	notes[0] = 0;
	assert_ok(eco_model_import(&model,
			  &(struct eco_model_options){ .paths = &path,
				  .path_count = 1,
				  .up = ECO_UP_Y,
				  .warn = keep },
			  &error),
		error);
	eco_model_free(&model);
}

UNIT_TEST(plants_that_stand_apart_are_counted_and_said)
{
	double x[2], y[2];
	import_stems((const double[][2]){ { 0, 5 }, { 4, 4 }, { 8, 6 } }, 3);
	const char *said = strstr(notes, "3 plants stand apart in it");
	assert_non_null(said);
	assert_int_equal(
		sscanf(said, "3 plants stand apart in it, the first at %lf, %lf m, the second at %lf, %lf",
			&x[0], &y[0], &x[1], &y[1]),
		4);
	assert_true(fabs(x[1] - x[0] - 4) < 0.5);
	assert_non_null(strstr(notes, "\"variants\""));
}

UNIT_TEST(one_plant_is_one)
{
	import_stems((const double[][2]){ { 0, 5 } }, 1);
	assert_null(strstr(notes, "apart"));
	/* a low neighbour is no second plant */
	import_stems((const double[][2]){ { 0, 5 }, { 4, 0.5 } }, 2);
	assert_null(strstr(notes, "apart"));
}

UNIT_TEST(a_whole_scene_is_no_plant_and_said_with_its_file)
{
	import_stems((const double[][2]){ { 0, 20 }, { 240, 20 } }, 2);
	assert_non_null(strstr(notes, "plants.obj is 241 x 0.3 m wide and 20 m high, as a whole scene is"));
	import_stems((const double[][2]){ { 0, 20 }, { 80, 20 } }, 2);
	assert_null(strstr(notes, "whole scene"));
}
