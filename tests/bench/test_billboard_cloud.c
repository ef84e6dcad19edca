/* Billboard clouds (Kratt 2014): validity, and whole clouds of small trees. */
#include <math.h>
#include <string.h>

#include "lod/raster/raster.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 4096u                   /* triangles */
#define PIXELS 128u

static float place[9 * MOST];
static uint32_t corner_of[3 * MOST], material_of[MOST];
static struct eco_model model;
static struct eco_error error;
static struct lod_arena arena;
static struct lod_billboard_plant *plant;
static struct lod_billboard_cloud cloud;

static const struct lod_v3 O = { 0, 0, 0 };

static void none(void)
{
	model = (struct eco_model){ .position = place, .index = corner_of, .material = material_of };
}

static void triangle(struct lod_v3 a, struct lod_v3 b, struct lod_v3 c)
{
	const struct lod_v3 p[3] = { a, b, c };
	assert_true(model.triangle_count < MOST);
	for (uint32_t k = 0; k < 3; k++) {
		float *to = place + 3 * model.vertex_count;
		to[0] = (float)p[k].x, to[1] = (float)p[k].y, to[2] = (float)p[k].z;
		corner_of[3 * model.triangle_count + k] = model.vertex_count++;
	}
	model.triangle_count++;
}

/* A rectangle: a corner and two edges. */
static void leaf(struct lod_v3 at, struct lod_v3 along, struct lod_v3 across)
{
	struct lod_v3 b = lod_v3_add(at, along), c = lod_v3_add(b, across), d = lod_v3_add(at, across);
	triangle(at, b, c);
	triangle(at, c, d);
}

/* A tube of four sides; its rings lie `step` apart. */
static void tube(struct lod_v3 from, struct lod_v3 to, double radius, double step)
{
	struct lod_v3 along = lod_v3_sub(to, from), u = lod_v3_unit(lod_v3_cross(along, fabs(along.x)
		> fabs(along.z) ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 })),
		v = lod_v3_unit(lod_v3_cross(along, u));
	const struct lod_v3 side[4] = { lod_v3_scale(u, radius), lod_v3_scale(v, radius),
		lod_v3_scale(u, -radius), lod_v3_scale(v, -radius) };
	int rings = (int)(lod_v3_length(along) / step + 0.5);
	for (int i = 0; i < 4 * rings; i++) {
		struct lod_v3 low = lod_v3_mix(from, to, (double)(i / 4) / rings),
			high = lod_v3_mix(from, to, (i / 4 + 1.0) / rings), a = lod_v3_add(low, side[i % 4]),
			b = lod_v3_add(low, side[(i + 1) % 4]), c = lod_v3_add(high, side[(i + 1) % 4]);
		triangle(a, b, c);
		triangle(a, c, lod_v3_add(high, side[i % 4]));
	}
}

static struct lod_v3 dice3(uint64_t *seed)
{
	double x = foliage_dice(seed), y = foliage_dice(seed);
	return (struct lod_v3){ x, y, foliage_dice(seed) };
}

/* A stem with boughs, and leaves along them. */
static void grow_tree(uint64_t seed, uint32_t boughs, uint32_t leaves)
{
	none();
	tube(O, (struct lod_v3){ 0, 0, 4 }, 0.1, 0.2);
	for (uint32_t i = 0; i < boughs; i++) {
		struct lod_v3 from = { 0.1, 0, 1 + 3.0 * i / boughs },
			to = lod_v3_add(from, lod_v3_scale(lod_v3_unit(dice3(&seed)), 1.5));
		tube(from, to, 0.03, 0.1);
		for (uint32_t k = 0; k < leaves; k++) {
			struct lod_v3 at = lod_v3_mix(from, to, (k + 1.0) / leaves), along = dice3(&seed);
			struct lod_v3 across = lod_v3_cross(along, dice3(&seed));
			at.z += 0.03;
			leaf(at, lod_v3_scale(lod_v3_unit(along), 0.2), lod_v3_scale(lod_v3_unit(across),
				0.1));
		}
	}
}

static void tidy(void)
{
	lod_billboard_cloud_free(&cloud);
	lod_billboard_plant_close(plant);
	lod_arena_free(&arena);
	plant = NULL;
}

static void make(uint32_t cap)
{
	tidy();
	assert_ok(lod_billboard_plant_open(&plant, &model, &error), error);
	assert_ok(lod_billboard_cloud_make(&cloud, plant, cap, &error), error);
	assert_true(cloud.count <= cap && cloud.error >= 0 && cloud.error <= 1 + 1e-9);
	assert_true(cloud.invalid >= 0 && cloud.invalid <= 1 + 1e-9);
	assert_int_equal(cloud.forms[0] + cloud.forms[1] + cloud.forms[2], cloud.parts);
	for (uint32_t i = 0; i < cloud.count; i++) {
		const struct lod_billboard *b = &cloud.items[i];
		assert_true(b->image.width && b->image.height && lod_v3_length(b->u) > 0
			&& lod_v3_length(b->v) > 0);
		assert_true(fabs(lod_v3_dot(lod_v3_unit(b->u), lod_v3_unit(b->v))) < 1e-5);
	}
}

/* ---- Validity ---- */

/* A quad of 2 by 4 in the plane z = 0, and triangles of area 1/2: valid within epsilon, projected on it. */
static const struct { struct lod_v3 corner[3]; double epsilon; bool valid; } judged[] = {
	{ { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0.2 } }, 0.2 + 1e-9, true },
	{ { { 0, 0, 0.2 }, { 1, 0, 0 }, { 0, 1, 0 } }, 0.2 - 1e-9, false },
	{ { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 1, 0 } }, 3 - 1e-9, false },          /* beside it, in its plane */
	{ { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 1, 0 } }, 3 + 1e-9, true },
};

UNIT_TEST(coverage_is_of_valid_faces_less_invalid_ones)
{
	const struct billboard_quad flat = { O, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, 1, 2 };
	struct billboard_face faces[2];
	const struct billboard_face *list[2] = { &faces[0], &faces[1] };
	for (size_t i = 0; i < sizeof judged / sizeof *judged; i++) {
		uint32_t nearest;
		double projected;
		faces[i % 2] = (struct billboard_face){ .normal = { 0, 0.6, 0.8 }, .area = 0.5 };
		memcpy(faces[i % 2].corner, judged[i].corner, sizeof judged[i].corner);
		assert_int_equal(billboard_face_judge(&faces[i % 2], &flat, 1, judged[i].epsilon, &nearest,
			&projected), judged[i].valid);
		assert_true(fabs(projected - 0.4) < 1e-9);
	}
	memcpy(faces[0].corner, judged[0].corner, sizeof judged[0].corner);
	faces[1].area = 0.25;
	/* valid .4, invalid .2 of .75; both valid; the other way round never below nothing */
	assert_true(fabs(billboard_uncovered(&(struct billboard_fit_input){ list, 2, O, 4, 0.3 }, &flat, 1)
		- (1 - 0.2 / 0.75)) < 1e-9);
	assert_true(fabs(billboard_uncovered(&(struct billboard_fit_input){ list, 2, O, 4, 9 }, &flat, 1)
		- 0.2) < 1e-9);
	faces[0].area = 0.1;
	assert_true(billboard_uncovered(&(struct billboard_fit_input){ list, 2, O, 4, 0.3 }, &flat, 1) == 1);
}

/* ---- Clouds ---- */

/* Q of the cloud seen against y, from far away; the eye's right is x. */
static double q_seen(double half)
{
	struct lod_raster raster[2];
	struct lod_score score;
	struct lod_eye eye = { .at = { 0, -1000 * half, half }, .right = { 1, 0, 0 }, .up = { 0, 0, 1 },
		.forward = { 0, 1, 0 }, .tan_x = 0.0011, .tan_y = 0.0011, .pixel_rad = 0.0022 / PIXELS };
	for (int i = 0; i < 2; i++) {
		assert_ok(lod_raster_init(&raster[i], &(struct lod_raster_options){ .width = PIXELS,
			.height = PIXELS }, &error), error);
		lod_raster_clear(&raster[i]);
		lod_raster_camera(&raster[i], &eye, half);
		lod_raster_object(&raster[i], &(struct lod_place){ .cosine = 1, .scale = 1 });
	}
	lod_raster_triangles(&raster[0], &(struct lod_raster_batch){ .count = model.triangle_count,
		.position = place, .owner = 1 });
	lod_billboard_cloud_draw(&cloud, 1, &raster[1]);
	lod_score(&score, &(struct lod_score_input){ .width = PIXELS, .height = PIXELS,
		.cover = raster[1].cover, .reference = raster[0].cover });
	lod_raster_free(&raster[0]);
	lod_raster_free(&raster[1]);
	return score.q;
}

UNIT_TEST(clouds_use_their_cap_and_look_like_their_tree)
{
	static const uint32_t caps[] = { 1, 2, 3, 5, 8, 13, 33, 70, 150 };
	double q = -1;
	grow_tree(7, 20, 12);
	for (size_t i = 0; i < sizeof caps / sizeof *caps; i++) {
		make(caps[i]);
		assert_true(cloud.count + 2 >= 0.75 * caps[i] && (caps[i] < 8 || cloud.error <= 0.5));
		q = q_seen(2);
	}
	assert_true(q > 0.65);
	tidy();
}

/* A sparse crown high up, and the same leaves in a quarter of the width below, which no part holds within so
 * small an epsilon either: only sigma tells them apart. Heights are shares of the plant's, from its
 * middle. */
UNIT_TEST(hidden_parts_get_fewer_billboards)
{
	struct billboard_work work;
	uint64_t seed = 11;
	uint32_t above = 0, below = 0;
	none();
	tube(O, (struct lod_v3){ 0, 0, 8 }, 0.05, 0.2);
	for (int i = 0; i < 300; i++) {
		struct lod_v3 at = dice3(&seed), along = lod_v3_scale(lod_v3_unit(dice3(&seed)), 0.1),
			across = lod_v3_scale(lod_v3_unit(lod_v3_cross(along, at)), 0.1);
		leaf(lod_v3_add(lod_v3_scale(at, 1.5), (struct lod_v3){ 0, 0, 6.5 }), along, across);
		leaf(lod_v3_add(lod_v3_scale(at, 0.3), (struct lod_v3){ 0, 0, 2 }), along, across);
	}
	assert_ok(lod_billboard_plant_open(&plant, &model, &error), error);
	assert_int_equal(setjmp(arena.failed), 0);
	billboard_work_open(&work, plant, 60, &arena);
	billboard_parts_settle(&work, 0.004);
	for (uint32_t i = 0; i < work.part_count; i++)
		for (uint32_t q = 0; q < work.parts[i].fit.quad_count; q++)
			*(work.parts[i].fit.quads[q].center.z > 0 ? &above : &below) += 1;
	assert_true(above > 1.5 * below);
	tidy();
}
