/* Impostors as OpenGL draws them: the pixels of the software rasteriser, as points and as triangles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_gl.h"
#include "client-min/view_reference.h"
#include "ecofiles/format/image.h"
#include "lod/build/impostor/impostor_make.h"
#include "tests/support/files.h"
#include "tests/support/plan_twin.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define TOLERANCE 0.0005                 /* of all pixels */
#define LEVELS ECO_IMPOSTOR_LEVELS

static struct scene_builder scene;
static struct lod_impostor levels[LEVELS];
static struct view_gl *gl;

static int open_all(void **state)
{
	struct eco_view view = scene_view();
	struct view_gl_options options = { view.width, view.height };
	struct eco_error error = { 0 };
	struct lod_impostors made;
	struct soup soup;
	scene_make(&scene, NULL, 0);
	soup_tree(&soup, 1500, 30, false);
	assert_ok(lod_impostors_make(&made, &soup.model, &(struct lod_impostors_options){ 0 }, &error),
		error);
	assert_int_equal(made.level_count, LEVELS);
	for (uint32_t i = 0; i < LEVELS; i++)
		assert_ok(lod_impostor_open(&levels[i], &made.body, &made.levels[i], &error), error);
	lod_impostors_free(&made);
	soup_free(&soup);
	if (view_gl_open(&gl, &options, &error))
		print_message("OpenGL tests are skipped: %s\n", error.text);
	else
		print_message("drawn by %s\n", view_gl_renderer(gl));
	return 0;
}

static int close_all(void **state)
{
	view_gl_close(gl);
	for (uint32_t i = 0; i < LEVELS; i++)
		lod_impostor_close(&levels[i]);
	scene_free(&scene);
	return 0;
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

/* A plan that draws one primitive of a list for each tree. */
static struct scene_held hold(const struct eco_view *view, uint32_t level, uint32_t groves)
{
	struct scene_held h = { .view = *view };
	struct eco_cut cut = scene_rule(A_TREE, L_POINTS, level, level + 1, 1, 0, ECO_BANDS);
	struct eco_plan *plan = &h.plan;
	lod_eye_make(&h.eye, view);
	scene_plan(&scene, view, 1, plan);
	memset(plan->cuts, 0, plan->cut_count * sizeof *plan->cuts);
	plan->cuts[0] = cut;
	plan->cut_count = 1;
	plant(plan, groves);
	plan->vertices = plan_twin_vertices(&scene.scene, plan, view, &plan->visible_plants);
	h.store = scene_store(&scene, plan, NULL);
	assert_non_null(h.store);
	scene_select(&h);
	return h;
}

/* The store's list of points, one primitive each, becomes one of impostors while `draw` draws. */
static void draw_impostors(const struct scene_held *h, uint32_t held,
	void (*draw)(const struct scene_held *h, struct view_picture *picture), struct view_picture *picture)
{
	struct view_list *list = (struct view_list *)view_store_list(h->store, L_POINTS), kept = *list;
	struct eco_error error = { 0 };
	list->list.kind = ECO_LIST_IMPOSTOR;
	list->impostors = levels;
	list->chunk_count = held;
	assert_ok(view_picture_init(picture, h->view.width, h->view.height, &error), error);
	draw(h, picture);
	*list = kept;
}

static void draw_gl(const struct scene_held *h, struct view_picture *picture)
{
	struct view_gl_job job = { h->store, &h->selection, &h->eye, 0.1, VIEW_TINT_NONE };
	struct eco_error error = { 0 };
	assert_ok(view_gl_draw(gl, &job, picture, &error), error);
}

static void draw_software(const struct scene_held *h, struct view_picture *picture)
{
	struct view_reference_job job = { h->store, &h->selection, &h->eye, 0.1, 2, NULL, VIEW_TINT_NONE };
	struct eco_error error = { 0 };
	assert_ok(view_reference_draw(&job, picture, &error), error);
}

static void save(const char *name, const char *by, const struct view_picture *p)
{
	char path[128];
	snprintf(path, sizeof path, "build/tmp/impostors-%s-%s.png", name, by);
	folder_make("build/tmp");
	eco_png_write(&(struct eco_pixels){ p->width, p->height, 3, p->rgb }, path, NULL);
}

/* Shares of all pixels whose owner differs; and of those of one owner, whose depth or colour differs much. */
struct difference { double covered, owner, depth, color; };

static struct difference compare(const struct view_picture *a, const struct view_picture *b)
{
	struct difference d = { 0 };
	double part = 1.0 / (a->width * a->height);
	for (uint32_t i = 0; i < a->width * a->height; i++) {
		const uint8_t *p = a->rgb + 3 * (size_t)i, *q = b->rgb + 3 * (size_t)i;
		d.covered += a->cover[i] ? part : 0;
		if (a->owner[i] != b->owner[i] || a->cover[i] != b->cover[i]) {
			d.owner += part;
			continue;
		}
		d.depth += fabsf(a->depth[i] - b->depth[i]) > 1e-4f * a->depth[i] ? part : 0;
		for (int k = 0; k < 3; k++)
			if (abs(p[k] - q[k]) > 1) {
				d.color += part;
				break;
			}
	}
	return d;
}

static void assert_agree(const char *name, struct eco_view view, uint32_t level, uint32_t groves)
{
	struct view_picture soft, hard;
	struct scene_held h = hold(&view, level, groves);
	draw_impostors(&h, level + 1, draw_software, &soft);
	draw_impostors(&h, level + 1, draw_gl, &hard);
	struct difference d = compare(&soft, &hard);
	print_message("%s: %llu plants cover %.2f %%; owners differ in %.4f %%, depths in %.4f %%, "
		"colours in %.4f %% of pixels\n", name, (unsigned long long)hard.vertices, 100 * d.covered,
		100 * d.owner, 100 * d.depth, 100 * d.color);
	save(name, "gl", &hard);
	save(name, "cpu", &soft);
	assert_true(d.covered > 0 && hard.vertices == h.selection.vertices);
	assert_true(d.owner <= TOLERANCE && d.depth <= TOLERANCE && d.color <= TOLERANCE);
	view_picture_free(&soft);
	view_picture_free(&hard);
	scene_release(&h);
}

/* Heights of a tree in pixels, in the middle of the picture; seen from the side, above and below. Some are
 * larger than points may be. */
UNIT_TEST(opengl_and_software_agree_on_all_levels)
{
	static const double sizes[] = { 5, 12, 40, 100, 192 }, up[] = { 0, 50, -20, 12, 85 };
	if (!gl)
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

/* Hundreds stand at the edges of the picture. */
UNIT_TEST(forests_agree)
{
	if (!gl)
		skip();
	for (uint32_t level = 0; level < LEVELS; level++) {
		struct eco_view view = scene_view();
		memcpy(view.eye, (double[3]){ -60, -40, 12 + 30 * level }, sizeof view.eye);
		memcpy(view.target, (double[3]){ 150, 170, 0 }, sizeof view.target);
		char name[64];
		snprintf(name, sizeof name, "forest-%u", level);
		assert_agree(name, view, level, 20);
	}
}

int main(void)
{
	return unit_tests_run(open_all, close_all);
}
