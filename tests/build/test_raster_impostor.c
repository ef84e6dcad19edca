/* Impostors in the rasteriser: outlines from directions that no tile has, depths and owners. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/view.h"
#include "lod/bake.h"
#include "lod/build/impostor/impostor_make.h"
#include "lod/build/model_draw.h"
#include "lod/impostor.h"
#include "lod/raster/raster.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define SIDE 300u
#define LEVELS ECO_IMPOSTOR_LEVELS
#define BEST (LEVELS - 1)

static struct lod_raster raster, whole;
static struct soup ball;
static struct lod_impostor balls[LEVELS];
static const struct lod_place origin = { .cosine = 1, .scale = 1 };

/* From `far` metres to a point, that many degrees around and up; half_m: from the middle of the picture to
 * its edge there. */
static void look(struct lod_raster *r, const double at[3], double turn_deg, double up_deg, double far,
	double half_m)
{
	double turn = turn_deg * M_PI / 180, up = up_deg * M_PI / 180;
	struct eco_view view = { .target = { at[0], at[1], at[2] }, .up = { 0, 0, 1 },
		.eye = { at[0] + far * cos(up) * cos(turn), at[1] + far * cos(up) * sin(turn),
			at[2] + far * sin(up) },
		.fov_y_deg = 360 / M_PI * atan(half_m / far), .width = SIDE, .height = SIDE };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	lod_raster_clear(r);
	lod_raster_camera(r, &eye, 0.1);
	lod_raster_object(r, &origin);
}

static void open_levels(struct lod_impostor *levels, const struct eco_model *model)
{
	FREED(lod_impostors) made;
	assert_good(lod_impostors_make(&made, model, &(struct lod_impostors_options){ .levels = LEVELS }, &cause));
	assert_int_equal(made.level_count, LEVELS);
	for (uint32_t i = 0; i < LEVELS; i++)
		assert_good(lod_impostor_open(&levels[i], &made.body, &made.levels[i], &cause));
}

static void close_levels(struct lod_impostor *levels)
{
	for (uint32_t i = 0; i < LEVELS; i++)
		lod_impostor_close(&levels[i]);
}

static void draw(struct lod_raster *r, const struct lod_impostor *impostor, uint64_t owner)
{
	lod_raster_impostor(r, impostor, &(struct lod_raster_batch){ .count = 1, .owner = owner, .item = 5 });
}

/* The mean Q over directions all around, from afar or in perspective. */
static double mean_q(const struct eco_model *model, const struct lod_impostor *impostor, double far)
{
	const double at[3] = { impostor->body.center[0], impostor->body.center[1], impostor->body.center[2] };
	double mean = 0;
	for (int i = 0; i < 12; i++) {
		double turn = 137.5 * i + 11, up = -25 + 10 * i;
		struct lod_score score;
		look(&whole, at, turn, up, far, 1.3 * impostor->radius);
		lod_model_draw(model, NULL, &whole);
		look(&raster, at, turn, up, far, 1.3 * impostor->radius);
		draw(&raster, impostor, 1);
		lod_score(&score, &(struct lod_score_input){ .width = SIDE, .height = SIDE,
			.cover = raster.cover, .reference = whole.cover });
		mean += score.q / 12;
	}
	return mean;
}

static void make_box(struct soup *soup)
{
	soup_begin(soup);
	uint32_t grey = soup_material(soup, 90, 90, 90, ECO_NONE, false);
	for (int axis = 0; axis < 3; axis++)
		for (int side = -1; side <= 1; side += 2) {
			double n[3] = { 0 }, u[3] = { 0 }, v[3] = { 0 };
			n[axis] = side, u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2;
			soup_quad(soup, grey, (struct lod_v3){ n[0], 0.5 * n[1], 2 + 2 * n[2] },
				(struct lod_v3){ u[0], 0.5 * u[1], 2 * u[2] },
				(struct lod_v3){ v[0], 0.5 * v[1], 2 * v[2] });
		}
}

UNIT_TEST(balls_boxes_and_trees_keep_their_outlines)
{
	static const struct { double far[2], near[2]; } least[] = {
		{ { .96, .98 }, { .95, .97 } },
		{ { .92, .96 }, { .91, .94 } },
		{ { .13, .28 }, { .12, .27 } } };   /* gaps lie anywhere */
	for (int kind = 0; kind < 3; kind++) {
		struct soup soup;
		struct lod_impostor made[LEVELS];
		if (kind == 1)
			make_box(&soup);
		else if (kind == 2)
			soup_tree(&soup, 400, 0, false);
		if (kind)
			open_levels(made, &soup.model);
		for (uint32_t level = 1; level <= BEST; level++) {
			const struct lod_impostor *impostor = kind ? &made[level] : &balls[level];
			const struct eco_model *model = kind ? &soup.model : &ball.model;
			assert_true(mean_q(model, impostor, 300 * impostor->radius) > least[kind].far[level - 1]);
			assert_true(mean_q(model, impostor, 6 * impostor->radius) > least[kind].near[level - 1]);
		}
		if (kind) {
			close_levels(made);
			soup_free(&soup);
		}
	}
}

/* Gaps let a sparse crown show no more of itself than its model does; what has none is whole. */
UNIT_TEST(crowns_show_as_much_as_their_models)
{
	FREED(soup) soup;
	struct lod_impostor tree[LEVELS];
	soup_tree(&soup, 400, 0, false);
	open_levels(tree, &soup.model);
	for (uint32_t level = 0; level < LEVELS; level++) {
		const double at[3] = { tree[level].body.center[0], tree[level].body.center[1], tree[level].body.center[2] };
		double shown = 0, model = 0;
		for (int i = 0; i < 8; i++) {
			look(&whole, at, 50 * i, 10 * i, 300 * tree[level].radius, 1.3 * tree[level].radius);
			lod_model_draw(&soup.model, NULL, &whole);
			look(&raster, at, 50 * i, 10 * i, 300 * tree[level].radius, 1.3 * tree[level].radius);
			draw(&raster, &tree[level], 1);
			for (uint32_t k = 0; k < SIDE * SIDE; k++) {
				shown += raster.cover[k] > 0;
				model += whole.cover[k] > 0;
			}
		}
		assert_true(tree[level].opacity < 0.8f && balls[level].opacity >= 1);
		assert_in_range(100 * shown / model, 80, 120);
	}
	close_levels(tree);
}

/* Those of the model, but at the outline, where depths change fast. */
UNIT_TEST(depths_are_those_of_the_near_side)
{
	const double at[3] = { 1, 2, 3 };
	double off = 0, pixels = 0;
	for (int i = 0; i < 8; i++) {
		look(&whole, at, 50 * i, 12 * i - 10, 12, 1.3);
		lod_model_draw(&ball.model, NULL, &whole);
		look(&raster, at, 50 * i, 12 * i - 10, 12, 1.3);
		draw(&raster, &balls[BEST], 1);
		for (uint32_t k = 0; k < SIDE * SIDE; k++)
			if (raster.cover[k] && whole.cover[k]) {
				double miss = fabs(1 / raster.depth[k] - 1 / whole.depth[k]);
				assert_true(miss < 0.75);
				off += miss;
				pixels++;
			}
	}
	assert_true(off / pixels < 0.15);
}

UNIT_TEST(the_nearer_plant_owns_the_pixels_whatever_the_order)
{
	const double at[3] = { 1, 2, 3 };
	FREED_MEMORY uint64_t *first = malloc(SIDE * SIDE * sizeof *first);
	uint32_t count[3] = { 0 };
	for (int order = 0; order < 2; order++) {
		look(&raster, at, 0, 10, 30, 2.5);
		for (int i = 0; i < 2; i++) {
			/* one a radius farther away and to the side: they cross */
			bool far = i != order;
			lod_raster_object(&raster, &(struct lod_place){
				.at = { far ? -1 : 0, far ? 1 : 0, 0 }, .cosine = 1, .scale = 1 });
			draw(&raster, &balls[BEST], far ? 2 : 1);
		}
		if (order)
			assert_memory_equal(first, raster.owner, SIDE * SIDE * sizeof *first);
		else
			memcpy(first, raster.owner, SIDE * SIDE * sizeof *first);
	}
	for (uint32_t k = 0; k < SIDE * SIDE; k++)
		count[raster.owner[k]]++;
	assert_int_equal(raster.owner[SIDE / 2 * SIDE + SIDE / 2], 1);
	/* a disc, and what a disc a radius aside shows of itself: 61 % at least */
	assert_true(count[2] > 0.55 * count[1] && count[2] < 0.75 * count[1]);
}

UNIT_TEST(what_cannot_be_drawn_is_left_out)
{
	const double at[3] = { 1, 2, 3 };
	for (int i = 0; i < 3; i++) {
		look(&raster, at, 0, 10, i < 2 ? 0.5 + i * 0.5 : 30, 2);
		if (i == 2)                                  /* behind the eye */
			lod_raster_object(&raster, &(struct lod_place){ .at = { 60, 0, 0 }, .cosine = 1,
				.scale = 1 });
		draw(&raster, &balls[0], 1);
		for (uint32_t k = 0; k < SIDE * SIDE; k++)
			assert_int_equal(raster.cover[k], 0);
	}
}

/* An icosahedron in its place, size and colour; few ellipsoids are too. */
UNIT_TEST(impostors_and_few_splats_are_baked_as_balls)
{
	static const float half[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, at[3] = { 1, 2, 3 };
	static const uint8_t red[1][3] = { { 200, 30, 10 } };
	const struct lod_geometry geometry = { .position = (float *)at, .half = (float *)half,
		.color = (int32_t[]){ 0 } };
	const struct eco_list list = { .kind = ECO_LIST_POINTS, .palette_count = 1, .image = ECO_NONE };
	for (int splat = 0; splat < 2; splat++) {
		FREED(lod_bake) bake;
		assert_good(lod_bake_make(&bake, &(struct lod_bake_input){ .list = &list, .palette = red,
			.geometry = &geometry, .count = 1, .impostor = splat ? NULL : &balls[BEST] },
			&cause));
		assert_true(bake.vertex_count == 12 && bake.index_count == 60);
		for (uint32_t v = 0; v < bake.vertex_count; v++) {
			const float *p = bake.position + 3 * v;
			double far = hypot(hypot((double)p[0] - 1, (double)p[1] - 2), (double)p[2] - 3);
			assert_true(far > 0.95 && far < 1.2);
			assert_true(bake.color[4 * v] > 8 * bake.color[4 * v + 1]
				&& bake.color[4 * v + 3] == 65535);
		}
		for (uint32_t i = 0; i < bake.index_count; i++)
			assert_true(bake.index[i] < bake.vertex_count);
	}
}

static int set_up(void **state)
{
	const struct lod_raster_options options = { .width = SIDE, .height = SIDE, .owner = true,
		.item = true };
	soup_begin(&ball);
	soup_ball(&ball, soup_material(&ball, 200, 30, 10, ECO_NONE, false), (struct lod_v3){ 1, 2, 3 }, 1, 48);
	open_levels(balls, &ball.model);
	lod_raster_init(&raster, &options);
	lod_raster_init(&whole, &options);
	return 0;
}

static int tear_down(void **state)
{
	close_levels(balls);
	soup_free(&ball);
	lod_raster_free(&raster);
	lod_raster_free(&whole);
	return 0;
}

UNIT_MAIN(set_up, tear_down)
