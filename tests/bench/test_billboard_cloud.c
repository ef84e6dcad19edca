/* Billboard clouds (Kratt 2014): validity, and whole clouds of small plants. */
#include <math.h>
#include <string.h>

#include "lod/build/model_draw.h"
#include "lod/raster/raster.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define PIXELS 128u

static struct soup soup;
static struct lod_arena arena;

/* A quad of 2 by 4 in the plane z = 0, and triangles of area 1/2: valid within epsilon, projected on it. */
static const struct { struct lod_v3 corner[3]; double epsilon; bool valid; } judged[] = {
	{ { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0.2 } }, 0.2 + 1e-9, true },
	{ { { 0, 0, 0.2 }, { 1, 0, 0 }, { 0, 1, 0 } }, 0.2 - 1e-9, false },
	{ { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 1, 0 } }, 3 - 1e-9, false },          /* beside it, in its plane */
	{ { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 1, 0 } }, 3 + 1e-9, true },
};
/* 1 - coverage of the first of these with an area, and the fourth with .25. Valid .4, invalid .2 of .75; both
 * valid; the other way round never below nothing. */
static const struct { double area, epsilon, uncovered; } covered[] = { { 0.5, 0.3, 1 - 0.2 / 0.75 },
	{ 0.5, 9, 0.2 }, { 0.1, 0.3, 1 } };

UNIT_TEST(coverage_is_of_valid_faces_less_invalid_ones)
{
	const struct billboard_quad flat = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, 1, 2 };
	struct billboard_face faces[4];
	const struct billboard_face *list[2] = { &faces[0], &faces[3] };
	for (size_t i = 0; i < sizeof judged / sizeof *judged; i++) {
		uint32_t nearest;
		double projected;
		faces[i] = (struct billboard_face){ .normal = { 0, 0.6, 0.8 }, .area = 0.5 };
		memcpy(faces[i].corner, judged[i].corner, sizeof judged[i].corner);
		assert_int_equal(billboard_face_judge(&faces[i], &flat, 1, judged[i].epsilon, &nearest,
			&projected), judged[i].valid);
		assert_true(fabs(projected - 0.4) < 1e-9);
	}
	faces[3].area = 0.25;
	for (size_t i = 0; i < sizeof covered / sizeof *covered; i++) {
		faces[0].area = covered[i].area;
		assert_true(fabs(billboard_uncovered(&(struct billboard_fit_input){ list, 2, { 0, 0, 0 }, 4,
			covered[i].epsilon }, &flat, 1) - covered[i].uncovered) < 1e-9);
	}
}

/* Q of the cloud seen against y, from far away; the eye's right is x. The tree is 6 m high. */
static double q_seen(const struct lod_billboard_cloud *cloud)
{
	struct lod_raster raster[2];
	struct lod_score score;
	const struct lod_eye eye = { .at = { 0, -3000, 3 }, .right = { 1, 0, 0 }, .up = { 0, 0, 1 },
		.forward = { 0, 1, 0 }, .tan_x = 0.0011, .tan_y = 0.0011, .pixel_rad = 0.0022 / PIXELS };
	for (int i = 0; i < 2; i++) {
		lod_raster_init(&raster[i], &(struct lod_raster_options){ .width = PIXELS, .height = PIXELS });
		lod_raster_clear(&raster[i]);
		lod_raster_camera(&raster[i], &eye, 3);
		lod_raster_object(&raster[i], &(struct lod_place){ .cosine = 1, .scale = 1 });
	}
	lod_model_draw(&soup.model, NULL, &raster[0]);
	lod_billboard_cloud_draw(cloud, 1, &raster[1]);
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
	soup_tree(&soup, 240, 0, false);
	const struct lod_billboard_plant *plant = lod_billboard_plant_make(&soup.model, &arena);
	for (size_t i = 0; i < sizeof caps / sizeof *caps; i++) {
		struct lod_billboard_cloud cloud;
		lod_billboard_cloud_make(&cloud, plant, caps[i], &arena);
		assert_true(cloud.count <= caps[i] && cloud.count + 2 >= 0.75 * caps[i]);
		assert_true(cloud.error >= 0 && cloud.error <= (caps[i] < 8 ? 1 + 1e-9 : 0.5));
		assert_true(cloud.invalid >= 0 && cloud.invalid <= 1 + 1e-9);
		assert_int_equal(cloud.forms[0] + cloud.forms[1] + cloud.forms[2], cloud.parts);
		for (const struct lod_billboard *b = cloud.items; b < cloud.items + cloud.count; b++)
			assert_true(b->image.width && b->image.height && fabs(lod_v3_dot(lod_v3_unit(b->u),
				lod_v3_unit(b->v))) < 1e-5);
		q = q_seen(&cloud);
	}
	assert_true(q > 0.6);
	soup_free(&soup);
	lod_arena_free(&arena);
}

/* A sparse crown high up, and the same leaves in a fifth of the width below, which no part holds within so
 * small an epsilon either: only sigma tells them apart. Heights are shares of the plant's, from its
 * middle. */
UNIT_TEST(hidden_parts_get_fewer_billboards)
{
	struct billboard_work work;
	uint32_t above = 0, below = 0;
	soup_begin(&soup);
	uint32_t material = soup_material(&soup, 60, 90, 40, ECO_NONE, false);
	soup_tube(&soup, material, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 8 }, 0.05, 0.05, 4, 40);
	soup_leaves(&soup, material, 300, (struct lod_v3){ 0, 0, 6.5 }, 1.5, 0.1);
	soup_leaves(&soup, material, 300, (struct lod_v3){ 0, 0, 2 }, 0.3, 0.1);
	billboard_work_open(&work, lod_billboard_plant_make(&soup.model, &arena), 60, &arena);
	billboard_parts_settle(&work, 0.004);
	for (uint32_t i = 0; i < work.part_count; i++)
		for (uint32_t q = 0; q < work.parts[i].fit.quad_count; q++)
			*(work.parts[i].fit.quads[q].center.z > 0 ? &above : &below) += 1;
	assert_true(above > 1.5 * below);
	soup_free(&soup);
	lod_arena_free(&arena);
}
