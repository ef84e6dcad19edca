/* More vertices look no worse, each plant alone with 1, 2, 4, ... vertices: a generated tree of cards and
 * fields of blades; nor do they stay unused. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/ecopack/export/plant_view.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/generate/generate.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/test_monotone"
#define FALL_MOST 0.005

/* ---- Q with ever more vertices, as the planner draws a plant alone ---- */

#define COUNTS_MAX 33u
#define VIEWS 12u                /* all around, of elevation -10 to 60 degrees */
#define PIXELS 96u
#define AWAY 64.0                /* of the camera, radii: as good as orthographic */
#define FRAME 1.03

struct plant_walk {
	uint32_t count;
	uint64_t vertices[COUNTS_MAX];       /* 1, 2, 4, ...; full detail */
	double q[COUNTS_MAX];                /* means over views */
};

static void look(struct plant_view *p, uint32_t view)
{
	const struct eco_anchor *whole = &p->scene.anchors[p->scene.plants[p->number].anchor_first];
	double turn = (view + 0.37) * M_PI * (3 - sqrt(5)), rise = (-10 + 70 * (view + 0.5) / VIEWS) * M_PI / 180,
		away = AWAY * whole->radius;
	const double from[3] = { cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise) };
	p->view = (struct eco_view){ .up = { 0, 0, 1 }, .fov_y_deg = 2 * atan(FRAME / AWAY) * 180 / M_PI,
		.width = PIXELS, .height = PIXELS };
	for (int k = 0; k < 3; k++) {
		p->view.target[k] = whole->center[k];
		p->view.eye[k] = whole->center[k] + away * from[k];
	}
	lod_eye_make(&p->eye, &p->view);
}

/* Q of one state in the view. */
static double shoot(struct plant_view *plant, uint64_t vertices)
{
	struct plant_view_drawing drawing;
	assert_good(plant_view_drawing_make(&drawing, plant, vertices, &cause));
	plant_view_raster(&plant->raster, plant, &plant->eye, &drawing, false);
	if (vertices == ECO_VERTICES_MAX)
		memcpy(plant->reference, plant->raster.cover, (size_t)PIXELS * PIXELS);
	double q = plant_view_q(plant, &drawing);
	plant_view_drawing_free(&drawing);
	return q;
}

static struct plant_walk walk_plant(const struct eco_pack *pack)
{
	struct plant_view plant;
	struct plant_walk walk = { .count = 0 };
	assert_good(plant_view_open(&plant, pack, 0, PIXELS, &cause));
	for (uint64_t v = 1; v < plant.full && walk.count + 1 < COUNTS_MAX; v *= 2)
		walk.vertices[walk.count++] = v;
	walk.vertices[walk.count++] = plant.full;
	for (uint32_t view = 0; view < VIEWS; view++) {
		look(&plant, view);
		walk.q[walk.count - 1] += shoot(&plant, ECO_VERTICES_MAX) / VIEWS;
		for (uint32_t i = 0; i + 1 < walk.count; i++)
			walk.q[i] += shoot(&plant, walk.vertices[i]) / VIEWS;
	}
	plant_view_close(&plant);
	return walk;
}

/* ---- Plants ---- */

struct field { const char *name; uint32_t count, turn; double height, spread, width, q[3]; };

/* Bent blades of three triangles. */
static void write_blades(const char *path, const struct field *field)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	for (uint32_t i = 0; i < field->count; i++) {
		double turn = 2.39996 * i, face = field->turn * i,
			r = field->spread * sqrt((i + 0.5) / field->count),
			high = field->height * (0.6 + 0.4 * (i * 7 % 11) / 10), half = field->width / 2,
			x = r * cos(turn), z = r * sin(turn), side = half * sin(face),
			deep = half * cos(face),
			mx = x + 0.1 * high * cos(face), mz = z - 0.1 * high * sin(face);
		fprintf(file, "v %.5f 0 %.5f\nv %.5f 0 %.5f\nv %.5f %.5f %.5f\nv %.5f %.5f %.5f\nv %.5f %.5f "
			"%.5f\nf -5 -4 -3\nf -5 -3 -2\nf -2 -3 -1\n", x - side, z - deep, x + side, z + deep,
			mx + side, 0.6 * high, mz + deep, mx - side, 0.6 * high, mz - deep,
			x + 0.4 * high * cos(face), 0.9 * high, z - 0.4 * high * sin(face));
	}
	assert_int_equal(fclose(file), 0);
}

/* Q with a share of the vertices, between two counts. */
static double q_at(const struct plant_walk *walk, double share)
{
	double at = share * (double)walk->vertices[walk->count - 1];
	uint32_t i = 1;
	while (i + 1 < walk->count && (double)walk->vertices[i] < at)
		i++;
	double low = (double)walk->vertices[i - 1], part = (at - low) / ((double)walk->vertices[i] - low);
	return walk->q[i - 1] + part * (walk->q[i] - walk->q[i - 1]);
}

static struct plant_walk walk(const char *scene, uint32_t least_splats)
{
	struct eco_error error = { 0 };
	OWNED(eco_pack) *pack;
	if (make_pack(&(struct make_options){ .scene = scene, .pack = ROOT "/plant.eco", .jobs = 1 }, &error))
		fail_msg("%s", error.text);
	assert_ok(eco_pack_open(&pack, ROOT "/plant.eco", &error), error);
	uint32_t splats = 0;
	for (uint32_t i = 0; i < pack->scene.list_count; i++)
		splats += pack->scene.lists[i].attributes & ECO_ATTR_SPLAT
			? pack->scene.lists[i].element_count : 0;
	assert_true(splats >= least_splats);
	struct plant_walk walk = walk_plant(pack);
	double best = 0;
	for (uint32_t i = 0; i < walk.count; i++) {
		best = fmax(best, walk.q[i]);
		if (!(best - walk.q[i] <= FALL_MOST))
			fail_msg("%s: Q falls by %f at %llu vertices", scene, best - walk.q[i],
				(unsigned long long)walk.vertices[i]);
	}
	assert_true(fabs(walk.q[walk.count - 1] - 1) < 1e-9);
	return walk;
}

static void write_scene(const char *path, const char *model)
{
	char text[300];
	snprintf(text, sizeof text, "{\"plants\": {\"plant\": {\"model\": \"%s\"}}, \"instances\": "
		"[{\"plant\": \"plant\", \"at\": [0, 0, 0]}]}", model);
	file_write_text(path, text);
}

static int make_models(void **state)
{
	struct eco_error error = { 0 };
	folder_make(ROOT);
	eco_progress_quiet(true);
	if (eco_generate(&(struct eco_generate_options){ .name = "city", .folder = ROOT, .plants = 3,
			.detail = 0.3, .seed = 1 }, &error))
		fail_msg("%s", error.text);
	return 0;
}

/* Its textures hold more than its triangles: more splats than half of them. */
UNIT_TEST(a_tree_of_cards_never_falls)
{
	write_scene(ROOT "/cards.json", "models/cards-1.obj");
	walk(ROOT "/cards.json", 1 + 3 + 12 + 48 + 192);
}

/* Blades that are thinner than a pixel: a picture that is off by a quarter of a pixel has a Q of .4 or .5, an
 * impostor with gaps by chance 0, though both look right. */
UNIT_TEST(fields_of_blades_hold)
{
	static const struct field fields[] = { { "turf", 220, 1, 0.26, 0.75, 0.012, { 0.7, 0.2, 0.1 } },
		{ "reeds", 90, 3, 1.6, 0.5, 0.02, { 0.45, 0.35, 0.35 } } };
	for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
		char model[60], scene[100], path[100];
		snprintf(model, sizeof model, "%s.obj", fields[i].name);
		snprintf(scene, sizeof scene, ROOT "/%s.json", fields[i].name);
		snprintf(path, sizeof path, ROOT "/%s", model);
		write_blades(path, &fields[i]);
		write_scene(scene, model);
		struct plant_walk walked = walk(scene, fields[i].count);
		for (int k = 0; k < 3; k++)
			assert_true(q_at(&walked, 1.0 / (8 << k)) > fields[i].q[k]);
	}
}

/* ---- Vertices ---- */

#define LEAST 4u                 /* vertices */
#define BUDGETS 24u
#define USED_LEAST 0.9           /* of a budget */

/* Whatever the budget, most of it is used: leaves of cells stand before splats, too. */
UNIT_TEST(a_plant_with_cells_uses_its_budget)
{
	struct eco_error error = { 0 };
	OWNED(eco_pack) *pack;
	struct plant_view plant;
	file_write_text(ROOT "/spruce.json", "{\"plants\": {\"spruce\": {\"library\": \"spruce\", \"height_m\": 22}}, "
		"\"instances\": [{\"plant\": \"spruce\", \"at\": [0, 0, 0]}]}");
	if (make_pack(&(struct make_options){ .scene = ROOT "/spruce.json", .pack = ROOT "/spruce.eco", .jobs = 1,
			.draft = true }, &error))
		fail_msg("%s", error.text);
	assert_ok(eco_pack_open(&pack, ROOT "/spruce.eco", &error), error);
	assert_true(pack->scene.plants[0].anchor_count > 4);
	assert_good(plant_view_open(&plant, pack, 0, PIXELS, &cause));
	look(&plant, 3);
	double step = pow((double)plant.full / LEAST, 1.0 / (BUDGETS - 1)), budget = LEAST;
	for (uint32_t i = 0; i < BUDGETS; i++, budget *= step) {
		uint64_t most = (uint64_t)(budget + 0.5);
		struct plant_view_drawing drawing;
		assert_good(plant_view_drawing_make(&drawing, &plant, most, &cause));
		if (drawing.vertices > most || (double)drawing.vertices < USED_LEAST * (double)most)
			fail_msg("%llu of %llu vertices are used", (unsigned long long)drawing.vertices,
				(unsigned long long)most);
		plant_view_drawing_free(&drawing);
	}
	plant_view_close(&plant);
}

UNIT_MAIN(make_models, NULL)
