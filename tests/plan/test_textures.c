/* Textures of plans, on random scenes: shown by all that have them, finer where they are nearer, and given up
 * for bytes. */
#include <math.h>
#include <stdlib.h>

#include "lod/plan/planner.h"
#include "lod/plan/texture_levels.h"
#include "tests/support/plan_size.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

#define SCENES 30
#define LEVELS 4u                /* of the scenes' texture */

static struct eco_plan plan_it(const struct random_pack *pack, const struct eco_view *view, double texel_px)
{
	struct eco_plan plan;
	const struct eco_request request = { .view = *view, .vertices = 1000000, .bytes = ECO_BYTES_UNBOUNDED,
		.texel_px = texel_px };
	plan_make(&plan, (struct lod_planner_input){ .scene = &pack->pack.scene, .request = &request });
	return plan;
}

/* Levels that a plan shows of a list; 0: it has no cut of it. */
static uint32_t shown(const struct eco_plan *plan, uint32_t list)
{
	uint32_t levels = 0, cuts = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (plan->cuts[i].list == list) {
			assert_true(plan->cuts[i].anchor == ECO_NONE && plan->cuts[i].first == 0);
			levels = plan->cuts[i].end;
			cuts++;
		}
	assert_true(cuts <= 1);
	return levels;
}

static bool draws_textured(const struct eco_plan *plan, const struct eco_scene *scene)
{
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (plan->cuts[i].anchor != ECO_NONE && scene->lists[plan->cuts[i].list].image != ECO_NONE)
			return true;
	return false;
}

static uint32_t image_of(const struct eco_scene *scene)
{
	uint32_t list = 0;
	while (scene->lists[list].kind != ECO_LIST_IMAGE)
		list++;
	assert_true(list < scene->list_count && scene->lists[list].image != ECO_NONE);
	return list;
}

UNIT_TEST(a_texture_is_shown_where_something_has_it)
{
	uint32_t textured = 0, coarse = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, 0, 1);
		const struct eco_scene *scene = &pack->pack.scene;
		struct eco_view view = random_view(&pack->r);
		uint32_t image = image_of(scene), outline = scene->lists[image].image, before = LEVELS;
		for (double px = ECO_TEXEL_PX_MIN; px < 1000; px *= 4) {
			struct eco_plan plan = plan_it(pack, &view, px);
			struct eco_holdings needs;
			uint32_t levels = shown(&plan, image);
			eco_plan_sort(&plan);
			assert_good(eco_plan_check(&plan, &cause));
			assert_int_equal(levels > 0, draws_textured(&plan, scene));
			assert_int_equal(shown(&plan, outline), levels ? LEVELS : 0);
			assert_true(!levels || levels <= before);
			before = levels ? levels : before;
			textured += levels > 0;
			coarse += levels == 1;
			/* what is shown is fetched, and nothing more of it */
			assert_good(lod_plan_needs(scene, &plan, &needs, &cause));
			assert_int_equal(eco_holdings_chunks(&needs, image), levels);
			free(needs.items);
			eco_plan_free(&plan);
		}
		random_pack_free(pack);
	}
	assert_true(textured > SCENES && coarse > 0);
}

static void plan_within(struct eco_plan *plan, const struct eco_scene *scene,
	const struct eco_view *view, uint64_t bytes)
{
	const struct eco_request request = { .view = *view, .vertices = 1000000, .bytes = bytes,
		.texel_px = ECO_TEXEL_PX_MIN };
	assert_true(plan_make(plan, (struct lod_planner_input){ .scene = scene, .request = &request,
		.sent = true }).bytes <= bytes);
}

/* Levels of a list as large as they are where textures are large: all else comes first. */
static void enlarge(struct random_pack *pack, uint32_t list)
{
	for (uint32_t k = 0; k < LEVELS; k++)
		pack->r.chunks[pack->pack.scene.lists[list].chunk_first + k].size_bytes = 200u << (2 * k);
}

UNIT_TEST(levels_are_given_up_for_bytes)
{
	uint32_t fewer = 0, shows = 0, rough = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, 0, 1);
		const struct eco_scene *scene = &pack->pack.scene;
		struct eco_view view = random_view(&pack->r);
		uint32_t image = image_of(scene), outline = scene->lists[image].image;
		enlarge(pack, image);
		enlarge(pack, outline);
		struct eco_plan whole = plan_it(pack, &view, ECO_TEXEL_PX_MIN), plan;
		uint64_t bytes;
		bytes = plan_bytes(scene, &whole, NULL);
		for (uint64_t part = 2; part <= 8 && shown(&whole, image); part *= 2) {
			plan_within(&plan, scene, &view, bytes / part);
			uint32_t levels = shown(&plan, image), border = shown(&plan, outline);
			assert_true(levels <= LEVELS);
			assert_true(border <= LEVELS && (border > 0) == (levels > 0));
			shows += levels > 0;
			fewer += levels > 0 && levels < LEVELS;
			rough += border > 0 && border < LEVELS;
			eco_plan_free(&plan);
		}
		eco_plan_free(&whole);
		random_pack_free(pack);
	}
	print_message("          of %u plans that show the texture %u show less of it, %u of its outline\n",
		shows, fewer, rough);
	assert_true(fewer > 3 && rough > 3);
}

/* Large levels, with texels of 1 cm. */
static uint32_t add_large_texture(struct scene_builder *b)
{
	struct eco_list image = scene_list(b, &(struct scene_row){ .kind = ECO_LIST_IMAGE,
		.other = ECO_NONE });
	image.chunk_first = b->scene.chunk_count;
	image.primitive_count = image.element_count = image.chunk_count = LEVELS;
	image.unit_area = 1e-4f;
	for (uint32_t k = 0; k < LEVELS; k++)
		scene_add_chunk(b, (struct eco_chunk){ .size_bytes = 500u << (2 * k), .primitive_count = 1,
			.element_count = 1 });
	return scene_add_list(b, image);
}

/* A tree of cards, 13 m high, and splats that show it nearly as well as its leaves, but for their texture, which
 * is returned. */
static uint32_t make_card_tree(struct scene_builder *b)
{
	*b = (struct scene_builder){ .state = 0 };
	random_stand_make(b, &(struct random_stand){ .height_m = 13, .leaves = 160, .area = 300,
		.shares = { .01f, .3f, .98f, 1 }, .errors = { .4f, .1f, 1e-5f, 0 }, .splats = 64,
		.splat_errors = { { .3f, .3f }, { .02f, .02f } } });
	uint32_t texture = add_large_texture(b);
	b->lists[b->ladders[0].triangles].image = texture;
	uint32_t tile = scene_add_tile(b, (struct eco_tile){ .low = { -7, -7, 0 }, .high = { 7, 7, 13 },
		.instance_count = 1, .area = 300, .summary = ECO_NONE });
	uint32_t list = scene_add_bare(b, &(struct scene_row){ .kind = ECO_LIST_INSTANCES, .owner = tile,
		.other = ECO_NONE }, 1, 1);
	scene_add_group(b, (struct eco_group){ tile, 0, list, b->scene.place_count, 0, 1 });
	scene_add_place(b, (struct eco_place){ .scale = 65536 });
	return texture;
}

/* If there is room for cards and a part of their texture, they are drawn with that: splats show none of
 * it. Which pixels are covered is not a matter of texels. */
UNIT_TEST(a_coarse_texture_is_better_than_none)
{
	struct scene_builder b;
	uint32_t image = make_card_tree(&b), coarse = 0;
	for (double away = 12; away < 60; away *= 1.2) {
		const struct eco_view view = { .target = { 0, 0, 6.5 }, .eye = { away, 0, 6 },
			.up = { 0, 0, 1 }, .fov_y_deg = 45, .width = 480, .height = 320 };
		struct random_pack pack = { .pack.scene = b.scene };
		struct eco_plan whole = plan_it(&pack, &view, ECO_TEXEL_PX_MIN), plan;
		uint64_t all, finer = 0;
		all = plan_bytes(&b.scene, &whole, NULL);
		assert_int_equal(shown(&whole, image), LEVELS);
		for (uint32_t k = 1; k < LEVELS; k++)
			finer += b.chunks[b.lists[image].chunk_first + k].size_bytes;
		for (uint64_t bytes = all - finer + 300; bytes < all; bytes += bytes / 4) {
			plan_within(&plan, &b.scene, &view, bytes);
			assert_true(shown(&plan, image) > 0);
			assert_true(eco_predicted_q(&plan.prediction) > 0.97);
			coarse += shown(&plan, image) < LEVELS;
			eco_plan_free(&plan);
		}
		eco_plan_free(&whole);
	}
	assert_true(coarse > 20);
	scene_free(&b);
}

UNIT_TEST(where_nothing_is_known_all_levels_are_shown)
{
	struct eco_anchor anchor = { { 0, 0, 2 }, 2 };
	struct eco_list list = { .kind = ECO_LIST_OUTLINE, .primitive_count = LEVELS };
	struct eco_scene scene = { .lists = &list, .list_count = 1, .anchors = &anchor, .anchor_count = 1 };
	struct eco_request request = { .texel_px = 0.5 };
	struct lod_planner_input input = { .scene = &scene, .request = &request };
	struct lod_planner p = { .input = &input, .scene = &scene, .visible.eye.pixel_rad = 0.001 };
	assert_int_equal(lod_texture_levels(&p, 0, lod_texel_px(&p, 0, 0, ECO_BANDS - 1)), LEVELS);
	assert_true(lod_outline_loss(&p, 0, LEVELS) == 0 && lod_outline_loss(&p, 0, LEVELS - 1) == INFINITY);
}
