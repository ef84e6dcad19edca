/* Leaves on splats: they change details, and no mean. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/view.h"
#include "lod/leaf.h"
#include "lod/raster/raster.h"
#include "tests/support/unit_test.h"

#define SIDE 400u

static struct lod_raster raster;

static float between(float low, float high) { return low + (high - low) * (float)rand() / (float)RAND_MAX; }

/* A camera 100 m south of a place that sees so much to all sides. */
static void look(const float at[3], double half_m)
{
	struct eco_view view = { .eye = { at[0], at[1] - 100, at[2] }, .target = { at[0], at[1], at[2] }, .up = { 0, 0, 1 },
		.fov_y_deg = 360 / M_PI * atan(half_m / 100), .width = SIDE, .height = SIDE };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	lod_raster_look(&raster, &eye, 0.1);
}

/* The picture of one splat: pixels, sums over them. */
struct sums { double pixels, depth, tone, lit, facing; };

static void draw(const struct lod_raster_batch *batch, double half_m, struct sums *sums)
{
	look(batch->position, half_m);
	lod_raster_splats(&raster, batch);
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		uint32_t leaf = raster.leaf[i];
		if (!raster.cover[i])
			continue;
		uint32_t look = leaf_look(leaf), side = leaf_side(look);
		float turn[3] = { leaf_turn(side, 0), leaf_turn(side, 1), leaf_turn(side, 2) };
		float length = sqrtf(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
		sums->pixels++;
		sums->depth += 1 / (double)raster.depth[i];
		sums->tone += (double)leaf_tone(leaf, look, 0.4f);
		sums->lit += leaf_is_lit(leaf, look);
		/* cosine between the eye and the unit vector of that direction, and that to the eye */
		sums->facing += sqrt(0.5 + 0.5 * (double)(turn[0] / length));
	}
}

static int set_up(void **state)
{
	(void)state;
	lod_raster_init(&raster, &(struct lod_raster_options){ .width = SIDE, .height = SIDE, .owner = true, .item = true });
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	lod_raster_free(&raster);
	return 0;
}

/* Many splats, far and near, of few leaves and of many, opaque or not: covered pixels, depths and tones are
 * in the mean those of smooth ones; leaves are turned as those that are seen of all directions (2/3). */
UNIT_TEST(leaves_keep_what_splats_show)
{
	struct sums smooth = { 0 }, leafy = { 0 };
	srand(7);
	for (int k = 0; k < 600; k++) {
		float center[3], half[9] = { 0 }, opacity = (float)(1 + rand() % 16) / 16;
		double half_m = 5 << k % 4;
		for (int i = 0; i < 3; i++) {
			center[i] = between(-200, 200);
			half[4 * i] = between(0.4f, 2.5f);
		}
		struct lod_raster_batch batch = { .count = 1, .position = center, .half = half,
			.opacity = &opacity, .owner = 1 };
		draw(&batch, half_m, &smooth);
		batch.leaf = between(0.02f, 0.8f);
		draw(&batch, half_m, &leafy);
	}
	print_message("%.0f pixels, %.4f with leaves; depth %+.4f m, tone %.4f, %.3f facing\n", smooth.pixels,
		leafy.pixels / smooth.pixels, leafy.depth / leafy.pixels - smooth.depth / smooth.pixels,
		leafy.tone / leafy.pixels, leafy.facing / leafy.pixels);
	assert_true(fabs(leafy.pixels / smooth.pixels - 1) < 0.01);
	assert_true(fabs(leafy.depth / leafy.pixels - smooth.depth / smooth.pixels) < 0.1);
	assert_true(fabs(leafy.tone / leafy.pixels - 1) < 0.01);
	assert_true(fabs(leafy.facing / leafy.pixels - 2.0 / 3) < 0.01);
}

/* Leaves wider than a pixel are all lit as leaves, of thinner ones as many as leave their contrast. */
UNIT_TEST(contrast_fades_where_leaves_are_finer_than_pixels)
{
	const float center[3] = { 0, 0, 0 }, half[9] = { 5, 0, 0, 0, 5, 0, 0, 0, 5 };
	static const struct { float leaf; double lit; } cases[] = { { 0.4f, 1 }, { 0.1f, 1 }, { 0.025f, 0.25 },
		{ 0.00625f, 0.0156 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct sums sums = { 0 };
		draw(&(struct lod_raster_batch){ .count = 1, .position = center, .half = half,
			.leaf = cases[i].leaf, .owner = 1 }, 10, &sums);
		assert_true(fabs(sums.lit / sums.pixels - cases[i].lit) < 0.03);
	}
}

/* From afar a plant's leaves are a few cells, which cover all of its splat or nothing: plants of one kind
 * differ in them, and so do splats of one plant. */
UNIT_TEST(far_plants_of_a_kind_lack_different_leaves)
{
	const float origin[3] = { 0, 0, 0 }, at[6] = { 0, 0, 0, 0.01f, 0, 0 },
		half[18] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1 }, opacity[2] = { 0.5f, 0.5f };
	double pixels[2][2] = { { 0 } };         /* of one splat, of two in one place; smooth, with leaves */
	for (uint32_t two = 0; two < 2; two++)
		for (uint32_t leafy = 0; leafy < 2; leafy++) {
			look(origin, 100);
			for (uint32_t i = 0; i < 3600; i++) {
				lod_raster_object(&raster, &(struct lod_place){
					.at = { 3.1 * (i % 60) - 92, 0, 3.1 * (i / 60) - 92 }, .cosine = 1, .scale = 1, .salt = lod_share_hash(0, 0, i) & 0xFFFF });
				lod_raster_splats(&raster, &(struct lod_raster_batch){ .count = 1 + two,
					.position = at, .half = half, .opacity = opacity, .owner = 1,
					.leaf = leafy ? 0.02f : 0 });
			}
			for (uint32_t i = 0; i < SIDE * SIDE; i++)
				pixels[two][leafy] += raster.cover[i] != 0;
		}
	print_message("%.0f %.0f of one splat, %.0f %.0f of two\n", pixels[0][0], pixels[0][1], pixels[1][0],
		pixels[1][1]);
	for (int two = 0; two < 2; two++)
		assert_true(fabs(pixels[two][1] / pixels[two][0] - 1) < 0.05);
}

/* Wood, and what is drawn without leaves, is as it was. */
UNIT_TEST(wood_stays_smooth)
{
	const float center[3] = { 0, 0, 0 }, half[9] = { 3, 0, 0, 0, 1, 0, 0, 0, 4 }, opacity = 0.5f, wood = 1;
	struct lod_raster_batch batch = { .count = 1, .position = center, .half = half, .opacity = &opacity, .owner = 1 };
	static float depth[2][SIDE * SIDE];
	for (int k = 0; k < 2; k++) {
		struct sums sums = { 0 };
		draw(&batch, 10, &sums);
		assert_true(sums.pixels > 1000);
		memcpy(depth[k], raster.depth, sizeof depth[k]);
		batch.leaf = 0.2f;
		batch.wood = &wood;
	}
	assert_memory_equal(depth[0], depth[1], sizeof depth[0]);
}

UNIT_MAIN(set_up, tear_down)
