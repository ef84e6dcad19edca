/* Impostors as OpenGL draws them: the pixels of the software rasteriser, as points and as triangles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_shadow.h"
#include "client-min/view_reference.h"
#include "lod/light.h"
#include "tests/support/plan_twin.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define TOLERANCE 0.0005                 /* of all pixels */
#define LEVELS ECO_IMPOSTOR_LEVELS

static int open_all(void **state)
{
	scene_open(state);
	scene_make_impostor(&grove, 1500);
	assert_int_equal(grove.lists[L_IMPOSTOR].chunk_count, LEVELS);
	return scene_open_gl(state);
}

/* Groves of trees, side by side, `side` times `side`. */
static void plant(struct eco_plan *plan, uint32_t side)
{
	uint32_t count = side * side;
	free(plan->placements);
	free(plan->runs);
	plan->placements = calloc(count, sizeof *plan->placements);
	plan->runs = calloc(count, sizeof *plan->runs);
	plan->placement_count = plan->run_count = count;
	for (uint32_t i = 0; i < count; i++) {
		plan->placements[i] = (struct eco_placement){ .scale = 1, .turn = (uint16_t)(9000 * i),
			.at = { 20.0 * (i / side), 20.0 * (i % side), 0 },
			.path = i ? eco_owner_child(i) : 0 };
		plan->runs[i] = (struct eco_run){ i, L_TREES, L_TREES + 1, 0 };
	}
}

/* A plan that draws a level for each tree, and the store that holds its stream: that level and those before
 * it. */
static struct scene_held hold(const struct eco_view *view, uint32_t level, uint32_t groves)
{
	struct scene_held h = { .view = *view };
	struct eco_cut cut = scene_rule(A_TREE, L_IMPOSTOR, level, level + 1, 1, 0, ECO_BANDS);
	struct eco_plan *plan = &h.plan;
	struct eco_error error = { 0 };
	lod_eye_make(&h.eye, view);
	scene_plan(&grove, view, 1, plan);
	memset(plan->cuts, 0, plan->cut_count * sizeof *plan->cuts);
	plan->cuts[0] = cut;
	plan->cut_count = 1;
	plant(plan, groves);
	plan->vertices = plan_twin_vertices(&grove.scene, plan, view, &plan->visible_plants);
	h.store = scene_store(&grove, plan, &error);
	if (!h.store)
		fail_msg("%s", error.text);
	assert_int_equal(view_store_list(h.store, L_IMPOSTOR)->chunk_count, level + 1);
	scene_select(&h);
	return h;
}

static void assert_agree(const char *name, struct eco_view view, uint32_t level, uint32_t groves)
{
	char file[96];
	AT_END(scene_release) struct scene_held h = hold(&view, level, groves);
	FREED(view_picture) soft = scene_draw(&h, false, VIEW_TINT_NONE),
		hard = scene_draw(&h, true, VIEW_TINT_NONE);
	struct picture_difference d = picture_compare(&soft, &hard);
	print_message("%s: %llu plants cover %.2f %%; owners differ in %.4f %%, depths in %.4f %%, "
		"colours in %.4f %% of pixels\n", name, (unsigned long long)hard.vertices, 100 * d.covered,
		100 * d.owners, 100 * d.depths, 100 * d.colors);
	snprintf(file, sizeof file, "impostors-%s-gl", name);
	picture_save(file, &hard);
	snprintf(file, sizeof file, "impostors-%s-cpu", name);
	picture_save(file, &soft);
	assert_true(d.covered > 0 && hard.vertices == h.selection.vertices);
	assert_true(d.owners <= TOLERANCE && d.depths <= TOLERANCE && d.colors <= TOLERANCE);
}

/* Heights of a tree in pixels, in the middle of the picture; seen from the side, above and below. Some are
 * larger than points may be. */
UNIT_TEST(opengl_and_software_agree_on_all_levels)
{
	static const double sizes[] = { 5, 12, 40, 100, 192 }, up[] = { 0, 50, -20, 12, 85 };
	if (!scene_gl)
		skip();
	for (uint32_t level = 0; level < LEVELS; level++)        /* each added to those on the GPU */
		for (uint32_t i = 0; i < 5; i++) {
			struct eco_view view = scene_view();
			double far = 320 / (2 * tan(M_PI / 8)) * 6 / sizes[i], turn = 2.4 * (5 * level + i),
				rise = up[i] * M_PI / 180;
			view.eye[0] = far * cos(rise) * cos(turn);
			view.eye[1] = far * cos(rise) * sin(turn);
			view.eye[2] = 3 + far * sin(rise);
			char name[64];
			snprintf(name, sizeof name, "level-%u-%.0f-px", level, sizes[i]);
			assert_agree(name, view, level, 1);
		}
}

/* Leaves on impostors are seen, but the share that gaps leave stays, and so does the mean of their light. */
UNIT_TEST(leaves_change_no_cover_and_no_mean)
{
	struct eco_view view = scene_view();
	view.eye[0] = 60;
	view.eye[2] = 30;
	AT_END(scene_release) struct scene_held h = hold(&view, LEVELS - 1, 2);
	FREED(view_picture) leafy = scene_draw(&h, false, VIEW_TINT_NONE);
	FREED(view_picture) smooth = { 0 };
	assert_good(view_picture_init(&smooth, view.width, view.height, &cause));
	assert_good(view_reference_draw(&(struct view_draw_job){ .store = h.store, .selection = &h.selection,
		.eye = &h.eye, .near_m = 0.1, .smooth = true }, &smooth, &cause));
	double light[2] = { 0, 0 }, covered[2] = { 0, 0 }, plants = 0, changed = 0;
	for (size_t i = 0; i < (size_t)view.width * view.height; i++) {
		covered[0] += leafy.owner[i] > 0;
		covered[1] += smooth.owner[i] > 0;
		if (!leafy.owner[i] || leafy.owner[i] != smooth.owner[i])
			continue;                        /* a gap, maybe with another plant behind it */
		plants++;
		changed += abs(leafy.rgb[3 * i + 1] - smooth.rgb[3 * i + 1]) > 2;
		light[0] += lod_light_of[leafy.rgb[3 * i + 1]];
		light[1] += lod_light_of[smooth.rgb[3 * i + 1]];
	}
	print_message("%.0f and %.0f pixels, %.0f of both, %.2f of these changed, light %.3f of smooth\n",
		covered[0], covered[1], plants, changed / plants, light[0] / light[1]);
	assert_true(fabs(covered[0] / covered[1] - 1) < 0.08 && plants > 0.5 * covered[1]);
	assert_true(plants > 1000 && changed > 0.5 * plants && fabs(light[0] / light[1] - 1) < 0.05);
}

/* Seen along the sun's beams from where the sun is, a plant is where its shadow is, and shades little of
 * itself; gaps of both lie anywhere. */
UNIT_TEST(impostors_cast_the_shadow_of_what_is_seen_from_the_sun)
{
	struct eco_view view = { { -400, -300, 400 }, { 0, 0, 3 }, { 0, 0, 1 }, 3, 512, 512 };
	struct scene_held h = hold(&view, LEVELS - 1, 1);
	struct view_picture picture = scene_draw(&h, false, VIEW_TINT_NONE);
	double whole = (double)view_store_list(h.store, L_IMPOSTOR)->impostors[LEVELS - 1].opacity;
	for (int kind = VIEW_SHADOWS_STANDARD; kind <= VIEW_SHADOWS_PERSPECTIVE; kind++) {
		const double *f = h.eye.forward;
		struct view_shadow_job job = { h.store, &h.selection, &h.eye, &picture,
			{ -(float)f[0], -(float)f[1], -(float)f[2] }, (enum view_shadows)kind, 1024, 1 };
		struct view_shadow shadow;
		uint32_t plants = 0, met = 0, lit = 0;
		assert_good(view_shadow_make(&shadow, &job, &cause));
		for (uint32_t y = 0; y < view.height; y++)
			for (uint32_t x = 0; x < view.width; x++) {
				size_t i = (size_t)y * view.width + x;
				double to[3];
				float texel[2], place[3];
				if (!picture.owner[i])
					continue;
				view_picture_ray(&picture, &h.eye, x, y, to);
				for (int k = 0; k < 3; k++)
					place[k] = (float)(to[k] /= (double)picture.depth[i]);
				plants++;
				if (!view_shadow_place(&shadow, place, texel))
					continue;
				float top = shadow.top[(uint32_t)texel[1] * 1024 + (uint32_t)texel[0]];
				met += top > -INFINITY;
				lit += (double)top + lod_dot(to, f) < 0.4;
			}
		print_message("%u pixels of plants: %u meet a shadow's caster, %u are lit\n", plants, met, lit);
		assert_true(plants > 5000 && met > 0.95 * whole * plants && lit > 0.75 * plants);
		view_shadow_free(&shadow);
		if (scene_gl)
			assert_true(shadow_gl_compare(scene_gl, &job, "by OpenGL") > 1000);
	}
	view_picture_free(&picture);
	scene_release(&h);
}

UNIT_MAIN(open_all, scene_close)
