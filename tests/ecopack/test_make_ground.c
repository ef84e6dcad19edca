/* The ground that a scene gets, as a client draws it: plants stand on it, with rasters and without, and it
 * covers every pixel below the horizon. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "client-min/view_reference.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/ecopack/run.h"
#include "tests/support/scratch.h"
#include "tests/support/serve/served.h"
#include "tests/support/unit_test.h"

#define PLANTS_MOST 1000u

/* ---- Where plants stand ---- */

struct feet { double at[PLANTS_MOST][3]; uint32_t count; };

static void find_feet(struct feet *feet, const struct eco_scene *s, uint32_t tile,
	const struct lod_place *file)
{
	const struct eco_tile *t = &s->tiles[tile];
	for (uint32_t g = t->group_first; g < t->group_first + t->group_count; g++) {
		const struct eco_list *list = &s->lists[s->groups[g].list];
		for (uint32_t i = 0; i < list->primitive_count; i++) {
			struct eco_place stored = eco_place_read(s, s->groups[g].place_first + i);
			float at[3];
			for (int k = 0; k < 3; k++)
				at[k] = (float)(list->grid_origin[k] +
					list->grid_step[k] * stored.position[k]);
			assert_true(feet->count < PLANTS_MOST);
			lod_place_point(file, at, feet->at[feet->count++]);
		}
	}
	for (uint32_t c = t->child_first; c < t->child_first + t->child_count; c++) {
		const struct eco_child *child = &s->children[c];
		struct lod_place inner = *file;
		if (child->placed) {
			const float at[3] = { (float)child->at[0], (float)child->at[1], (float)child->at[2] };
			double sine, cosine;
			lod_place_point(file, at, inner.at);
			eco_angle16_sincos(child->turn, &sine, &cosine);
			inner.sine = file->sine * cosine + file->cosine * sine;
			inner.cosine = file->cosine * cosine - file->sine * sine;
			inner.scale = file->scale * (double)child->scale;
		}
		find_feet(feet, s, child->tile, &inner);
	}
}

/* From far above, in so large a picture that all tiles have to be of full detail. */
static void look_down(struct served *seen)
{
	const struct eco_scene *s = &seen->scene->pack->scene;
	const struct eco_tile *root = &s->tiles[s->root];
	double x = (root->low[0] + root->high[0]) / 2, y = (root->low[1] + root->high[1]) / 2,
		half = fmax(root->high[0] - root->low[0], root->high[1] - root->low[1]) / 2;
	served_look(seen, &(struct eco_view){ { x, y, 1e5 }, { x, y, 0 }, { 0, 1, 0 },
		2.2 * atan(half / 9e4) * 57.29577951, ECO_IMAGE_MAX, ECO_IMAGE_MAX }, ECO_GROUND_PX_MIN);
}

/* The ground that is drawn under every plant is where the plant stands, to so many metres. */
static void all_stand(struct served *seen, uint32_t count, double within_m)
{
	static struct feet feet;
	const struct eco_scene *s = &seen->scene->pack->scene;
	feet.count = 0;
	find_feet(&feet, s, s->root, &(struct lod_place){ .cosine = 1, .scale = 1 });
	assert_int_equal(feet.count, count);
	look_down(seen);
	for (uint32_t i = 0; i < count; i++) {
		const double *at = feet.at[i];
		double z;
		if (!view_ground_height(&seen->selection.ground, at[0], at[1], &z))
			fail_msg("no ground under a plant at %g, %g", at[0], at[1]);
		if (fabs(z - at[2]) > within_m)
			fail_msg("a plant at %g, %g stands %g m above the ground", at[0], at[1], at[2] - z);
	}
}

/* ---- What covers the picture ---- */

/* Looking from `eye`, every pixel that looks down at more than what is beyond 100 km shows ground. */
static void covers(struct served *seen, const double eye[3], const double target[3], double above_m)
{
	struct eco_view view = { .up = { 0, 0, 1 }, .fov_y_deg = 60, .width = 160, .height = 120 };
	FREED(view_picture) picture;
	uint32_t below = 0;
	memcpy(view.eye, eye, sizeof view.eye);
	memcpy(view.target, target, sizeof view.target);
	served_look(seen, &view, 0);
	assert_int_equal(view_picture_init(&picture, view.width, view.height, NULL), ECO_OK);
	assert_int_equal(view_reference_draw(&(struct view_draw_job){ seen->held, &seen->selection,
						     &seen->eye, 0.05, 1, NULL, VIEW_TINT_NONE, 1, false },
				 &picture, NULL),
		ECO_OK);
	for (uint32_t i = 0; i < view.width * view.height; i++) {
		double u = ((i % view.width + 0.5) / view.width * 2 - 1) * seen->eye.tan_x,
			v = (1 - (i / view.width + 0.5) / view.height * 2) * seen->eye.tan_y, ray[3];
		for (int k = 0; k < 3; k++)
			ray[k] = seen->eye.forward[k] + u * seen->eye.right[k] + v * seen->eye.up[k];
		double down = -ray[2] / hypot(ray[0], ray[1]);
		bool must = down > (above_m + 60) / 1e5 + 0.01;
		below += must;
		if (must && picture.depth[i] == 0)
			fail_msg("from %g, %g, %g pixel %u, %u shows no ground", eye[0], eye[1], eye[2],
				i % view.width, i / view.width);
	}
	assert_true(below > 1000);
}

static void is_covered(struct served *seen, double x, double y)
{
	static const double from[][3] = { { 0, -40, 2 }, { 200, 100, 150 }, { -3000, 500, 1000 },
		{ 1, 0, 4000 }, { 30000, -20000, 1.7 }, { 0, 70, 20000 } };
	for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
		double eye[3] = { x + from[i][0], y + from[i][1], 0 }, target[3] = { x, y, 0 }, z = 0;
		struct eco_view down = { { eye[0], eye[1], 1e5 }, { eye[0], eye[1], 0 }, { 0, 1, 0 }, 0.0001,
			8, 8 };
		served_look(seen, &down, 1);
		assert_true(view_ground_height(&seen->selection.ground, eye[0], eye[1], &z));
		eye[2] = z + from[i][2];
		target[2] = z;
		covers(seen, eye, target, from[i][2]);
	}
}

/* ---- Scenes ---- */

#define PLANT "\"plants\": {\"a\": {\"model\": \"a.obj\"}}"

static double unit(uint64_t *state) { return eco_random_unit(eco_random_next(state)); }

/* `count` plants over a square; with_height: on hills. */
static void write_rows(const char *name, uint32_t count, double side, bool with_height)
{
	FILE *file = open_text(name);
	uint32_t row = (uint32_t)ceil(sqrt(count));
	uint64_t state = count;
	fputs("x,y,z\n", file);
	for (uint32_t i = 0; i < count; i++) {
		double x = (i % row + 0.8 * unit(&state)) * side / row,
		       y = (i / row + 0.8 * unit(&state)) * side / row;
		fprintf(file, "%.3f,%.3f,%.3f\n", x, y,
			with_height ? 0.15 * x + 9 * sin(x / 40) * cos(y / 35) : 0);
	}
	assert_int_equal(fclose(file), 0);
}

UNIT_TEST(without_heights_plants_stand_on_a_plain)
{
	AT_END(served_close) struct served seen;
	write_rows("flat.csv", 150, 300, false);
	write_text("flat.json",
		"{" PLANT ", \"instances\": [{\"from\": \"flat.csv\", \"x\": \"x\", \"y\": \"y\", "
		"\"plant\": \"a\"}]}");
	served_open(&seen, "flat.json", "flat.eco");
	const struct eco_scene *s = &seen.scene->pack->scene;
	assert_true(s->ground_count == 1 && s->ground[0].low_m == 0 && s->ground[0].high_m == 0);
	assert_true(s->chunks[s->lists[s->ground[0].list].chunk_first].size_bytes < 250);
	all_stand(&seen, 150, 0);
	is_covered(&seen, 150, 150);
}

/* A file that is nested keeps its shape, wherever it is: the ground goes through the plants of all. */
UNIT_TEST(nested_plants_stand_on_the_ground_of_the_whole)
{
	AT_END(served_close) struct served seen;
	write_rows("part.csv", 60, 80, true);
	write_text("part.json",
		"{" PLANT ", \"instances\": [{\"from\": \"part.csv\", \"x\": \"x\", \"y\": \"y\", "
		"\"z\": \"z\", \"plant\": \"a\"}]}");
	write_text("nest.json",
		"{" PLANT ", \"instances\": [{\"plant\": \"a\", \"at\": [200, 30, 9]}], "
		"\"children\": [{\"eco\": \"part.json\", \"at\": [0, 0, 5]}, {\"eco\": \"part.json\", \"at\": "
		"[300, 0, 20], \"yaw_deg\": 90, \"scale\": 0.7}]}");
	served_open(&seen, "nest.json", "nest.eco");
	all_stand(&seen, 121, 0.05);
	is_covered(&seen, 100, 50);
}

UNIT_TEST(plants_beyond_a_raster_stand_on_the_ground_that_goes_on)
{
	AT_END(served_close) struct served seen;
	FILE *file = open_text("dem.asc");
	fputs("ncols 60\nnrows 50\nxllcorner 0\nyllcorner 0\ncellsize 5\n", file);
	for (int r = 0; r < 50; r++)
		for (int c = 0; c < 60; c++)
			fprintf(file, "%.2f%c", 800 + 2 * c + 12 * sin(r * 0.3), c == 59 ? '\n' : ' ');
	assert_int_equal(fclose(file), 0);
	write_rows("off.csv", 250, 1500, false);
	write_text("off.json",
		"{\"ground\": {\"heights\": \"dem.asc\"}, " PLANT ", \"instances\": [{\"from\": "
		"\"off.csv\", \"x\": \"x\", \"y\": \"y\", \"plant\": \"a\"}]}");
	served_open(&seen, "off.json", "off.eco");
	all_stand(&seen, 250, 0.03);
	is_covered(&seen, 150, 120);
	is_covered(&seen, -200, 400);
}

UNIT_TEST(ground_that_is_null_stays_off)
{
	AT_END(served_close) struct served seen;
	write_text("none.json",
		"{\"ground\": null, " PLANT ", \"instances\": [{\"plant\": \"a\", \"at\": [0, 0, 1]}, "
		"{\"plant\": \"a\", \"at\": [9, 9, 4]}]}");
	served_open(&seen, "none.json", "none.eco");
	const struct eco_scene *s = &seen.scene->pack->scene;
	assert_true(s->ground_count == 0 && s->ground_columns == 0 && !(s->needs & ECO_NEED_GROUND));
}

static int prepare(void **state)
{
	scratch_open("make_ground");
	eco_progress_quiet(true);
	write_shrub(in_root("a.obj"), "", 4, 20);
	return 0;
}

UNIT_MAIN(prepare, scratch_close)
