/* Drawing with OpenGL: what is counted, hidden, coloured, and kept on the GPU between frames. */

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_light.h"
#include "client-min/draw/view_shader.h"
#include "tests/support/plan_twin.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

static struct view_store *empty_store(void)
{
	struct view_store *store;
	struct view_store_options options = { 0 };
	assert_int_equal(view_store_new(&store, &options, NULL), ECO_OK);
	return store;
}

/* Draws what the store holds. */
static struct view_picture draw(struct view_store *store, enum view_tint tint)
{
	struct scene_held h = { .view = scene_view(), .store = store };
	lod_eye_make(&h.eye, &h.view);
	scene_select(&h);
	struct view_picture picture = scene_draw(&h, true, tint);
	assert_true(picture.vertices == h.selection.vertices);
	view_select_free(&h.selection);
	return picture;
}

static uint32_t covered(const struct view_picture *p)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < p->width * p->height; i++)
		count += p->cover[i] != 0;
	return count;
}

static void assert_same(const struct view_picture *a, const struct view_picture *b)
{
	size_t pixels = (size_t)a->width * a->height;
	assert_memory_equal(a->cover, b->cover, pixels);
	assert_memory_equal(a->owner, b->owner, 8 * pixels);
	assert_memory_equal(a->rgb, b->rgb, 3 * pixels);
}

UNIT_TEST(empty_store_draws_an_empty_picture)
{
	if (!scene_gl)
		skip();
	OWNED(view_store) *store = empty_store();
	struct view_picture p = draw(store, VIEW_TINT_NONE);
	assert_int_equal(covered(&p), 0);
	assert_true(p.vertices == 0);
	view_picture_free(&p);
	/* and none of another size than the target */
	struct view_selection selection = { 0 };
	struct view_draw_job job = { store, &selection, &(struct lod_eye){ .tan_x = 1 }, 0.1, 0, NULL,
		VIEW_TINT_NONE, 1, false };
	assert_int_equal(view_picture_init(&p, 7, 5, NULL), ECO_OK);
	assert_int_not_equal(view_gl_draw(scene_gl, &job, &p, NULL), ECO_OK);
	view_picture_free(&p);
}

/* Lists that no store holds any more go from the GPU, and come again where they are drawn. */
UNIT_TEST(gpu_keeps_what_some_store_holds)
{
	if (!scene_gl)
		skip();
	AT_END(scene_release) struct scene_held h = scene_hold(&grove),
		part = scene_hold_view(&grove, scene_view(), 0.2);
	OWNED(view_store) *empty = empty_store();
	FREED(view_picture) first = draw(h.store, VIEW_TINT_NONE);
	uint64_t bytes = view_gl_bytes(scene_gl);
	view_gl_keep(scene_gl, (const struct view_store *[]){ empty, h.store }, 2);
	assert_true(bytes > 0 && view_gl_bytes(scene_gl) == bytes);
	/* lists of which that store has less go as a whole */
	view_gl_keep(scene_gl, (const struct view_store *[]){ part.store }, 1);
	uint64_t rest = view_gl_bytes(scene_gl);
	assert_true(rest > 0 && rest < bytes);
	for (int i = 0; i < 2; i++) {
		FREED(view_picture) again = draw(h.store, VIEW_TINT_NONE);
		assert_same(&first, &again);
		assert_true(view_gl_bytes(scene_gl) <= bytes);
		view_gl_keep(scene_gl, (const struct view_store *[]){ empty }, 1);
		assert_true(view_gl_bytes(scene_gl) == 0);
	}
}

/* The hue tells the representation: green triangles, red lines, blue points, yellow to orange blends. */
UNIT_TEST(tint_shows_all_four_kinds)
{
	if (!scene_gl)
		skip();
	struct scene_held h = scene_hold(&grove);
	uint32_t green = 0, red = 0, blue = 0, yellow = 0;
	struct view_picture p = draw(h.store, VIEW_TINT_KIND),
		plain = draw(h.store, VIEW_TINT_NONE);
	/* the mask does not depend on shading */
	assert_memory_equal(plain.owner, p.owner, 8 * (size_t)p.width * p.height);
	view_picture_free(&plain);
	for (uint32_t i = 0; i < p.width * p.height; i++) {
		const uint8_t *c = p.rgb + 3 * (size_t)i;
		if (!p.cover[i])
			continue;
		green += c[1] > c[0] + 40 && c[1] > c[2] + 40;
		red += c[0] > c[1] + 40 && c[0] > c[2] + 40 && c[1] < c[0] / 2;
		blue += c[2] > c[0] + 40 && c[2] > c[1] + 20;
		yellow += c[0] > c[2] + 40 && c[1] > c[2] + 20 && c[1] >= c[0] / 2;
	}
	print_message("pixels: triangles %u, lines %u, points %u, blends %u\n", green, red, blue, yellow);
	assert_true(green > 500 && red > 20 && blue > 500 && yellow > 500);
	view_picture_free(&p);
	scene_release(&h);
}

/* Data uploaded for an earlier frame is extended; the picture is that of a context that has seen nothing
 * before. */
UNIT_TEST(uploads_in_parts_draw_the_same)
{
	if (!scene_gl)
		skip();
	struct eco_view view = scene_view();
	struct view_gl_options options = { view.width, view.height };
	FREED(eco_plan) small, large;
	FREED(eco_writer) w;
	struct view_gl *usual = scene_gl;
	uint32_t held[L_COUNT];
	scene_plan(&grove, &view, 0.1, &small);
	scene_plan(&grove, &view, 1, &large);
	assert_int_equal(view_gl_open(&scene_gl, &options, NULL), ECO_OK);
	OWNED(view_store) *store = scene_store(&grove, &small, NULL);
	FREED(view_picture) first = draw(store, VIEW_TINT_NONE);
	scene_holdings(store, held);
	scene_stream(&grove, &large, held, &w);
	assert_int_equal(scene_feed(store, &w, NULL), ECO_OK);
	FREED(view_picture) grown = draw(store, VIEW_TINT_NONE);
	view_gl_close(scene_gl);
	assert_int_equal(view_gl_open(&scene_gl, &options, NULL), ECO_OK);
	FREED(view_picture) whole = draw(store, VIEW_TINT_NONE);
	assert_same(&grown, &whole);
	assert_true(covered(&first) < covered(&whole));
	view_gl_close(scene_gl);
	scene_gl = usual;
}

/* A plan that draws only the first points of each tree, and the store that holds its stream. */
static struct scene_held hold_points(const struct eco_view *view, uint32_t count, float scale)
{
	struct scene_held h = { .view = *view };
	struct eco_plan *plan = &h.plan;
	struct eco_error error = { 0 };
	lod_eye_make(&h.eye, view);
	scene_plan(&grove, view, 1, plan);
	plan->cuts[0] = scene_rule(A_TREE, L_POINTS, 0, count, scale, 0, ECO_BANDS);
	plan->cut_count = plan->run_count = 1;
	plan->vertices = plan_twin_vertices(&grove.scene, plan, view, &plan->visible_plants);
	h.store = scene_store(&grove, plan, &error);
	assert_string_equal(error.text, "");
	scene_select(&h);
	view_ground_free(&h.selection.ground);
	return h;
}

/* Points of less than a pixel, of some, and wider than a driver's points. */
UNIT_TEST(points_of_all_sizes_are_those_of_software)
{
	static const struct { double near; uint32_t count; float scale; } views[] = { { 8, 280, 1 },
		{ 1, 280, 1 }, { 0.5, 3, 60 } };
	if (!scene_gl)
		skip();
	for (uint32_t i = 0; i < 3; i++) {
		struct eco_view view = scene_view();
		for (int k = 0; k < 3; k++)
			view.eye[k] = view.target[k] + (view.eye[k] - view.target[k]) * views[i].near;
		AT_END(scene_release) struct scene_held h = hold_points(&view, views[i].count,
			views[i].scale);
		FREED(view_picture) soft = scene_draw(&h, false, VIEW_TINT_NONE),
			hard = scene_draw(&h, true, VIEW_TINT_NONE);
		struct picture_difference apart = picture_compare(&soft, &hard);
		print_message("at %g times the distance: %.4f %% covered, %.4f %% of other owners\n",
			views[i].near, 100 * apart.covered, 100 * apart.owners);
		assert_true(covered(&soft) > 100 && apart.owners * 200 <= apart.covered);
	}
}

UNIT_TEST(own_colours_are_those_that_were_recorded)
{
	if (!scene_gl)
		skip();
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	FREED(view_picture) own = draw(h.store, VIEW_TINT_OWN), recorded;
	assert_int_equal(view_picture_init(&recorded, own.width, own.height, NULL), ECO_OK);
	assert_int_equal(view_gl_read(scene_gl, 0, &recorded, NULL), ECO_OK);
	uint32_t ground = 0, plants = 0;
	for (size_t i = 0; i < (size_t)own.width * own.height; i++) {
		const uint8_t *seen = own.rgb + 3 * i, *is = recorded.rgb + 3 * i;
		plants += own.owner[i] != 0;
		ground += !own.owner[i] && own.depth[i] > 0;
		for (int k = 0; k < 3; k++)
			assert_int_equal(seen[k], own.owner[i] ? is[k] : own.depth[i] > 0 ? VIEW_OWN_GROUND : 0);
	}
	assert_true(plants && ground);
}

UNIT_TEST(what_draws_held_lists_is_compiled_before_there_is_a_plan)
{
	const uint32_t far = 1u << VIEW_PROGRAM_GROUND | 1u << VIEW_PROGRAM_SUMMARY | 1u << VIEW_PROGRAM_SPLATS;
	if (!scene_gl)
		skip();
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	struct view_gl_options size = { h.view.width, h.view.height };
	OWNED(view_gl) *empty, *full;
	OWNED(view_store) *none;
	FREED(view_picture) picture;
	assert_int_equal(view_store_new(&none, &(struct view_store_options){ 0 }, NULL), ECO_OK);
	assert_int_equal(view_gl_open(&empty, &size, NULL), ECO_OK);
	assert_int_equal(view_gl_programs(empty), 0);
	assert_int_equal(view_gl_prepare(empty, none, NULL), ECO_OK);
	assert_int_equal(view_gl_programs(empty), far);

	assert_int_equal(view_gl_open(&full, &size, NULL), ECO_OK);
	assert_int_equal(view_gl_prepare(full, h.store, NULL), ECO_OK);
	uint32_t prepared = view_gl_programs(full);
	assert_int_equal(view_picture_init(&picture, size.width, size.height, NULL), ECO_OK);
	assert_int_equal(view_gl_draw(full, &(struct view_draw_job){ .store = h.store, .selection = &h.selection,
		.eye = &h.eye, .near_m = view_store_near_m(h.store), .smooth = true }, &picture, NULL), ECO_OK);
	assert_int_equal(view_gl_programs(full), prepared);
	assert_true(prepared & 1u << VIEW_PROGRAM_TRIANGLES && prepared & 1u << VIEW_PROGRAM_GROUND);
}

UNIT_MAIN(scene_open_gl, scene_close)
