/* Tiled ground on its way: coarse before fine, within the bytes there are and before plants give way, never
 * twice; and drawn alike by OpenGL and in software. */
#include <math.h>

#include "client-min/draw/view_gl.h"
#include "client-min/view_reference.h"
#include "client-min/view_select.h"
#include "tests/support/serve/served.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define PATH "build/tmp/ground_stream.eco"
#define SIDE 1025u
#define STEP_M 3.0

static struct srv_store store;
static const struct srv_scene *scene;

static double hills(double x, double y)
{
	double z = 0;
	for (int i = 0; i < 7; i++) {
		double f = 0.004 * (1 << i);
		z += 40.0 / (1 << i) * sin(f * x + i * i) * cos(f * 1.1 * y - 0.7 * i);
	}
	return z;
}

static int open_all(void **state)
{
	scene = served_sample(&store, PATH, SIDE, STEP_M, true, hills);
	assert_non_null(scene);
	return 0;
}

static int close_all(void **state)
{
	srv_store_free(&store);
	return 0;
}

static struct eco_request request_of(double distance, double above, uint64_t vertices)
{
	struct eco_request request = { .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
	request.view = (struct eco_view){ { -distance, -0.7 * distance, 0 }, { 40, 20, 0 }, { 0, 0, 1 }, 50,
		480, 320 };
	request.view.eye[2] = hills(request.view.eye[0], request.view.eye[1]) + above;
	request.view.target[2] = hills(40, 20);
	return request;
}

static void plan(struct srv_stream *stream, const struct eco_request *request,
	const struct eco_holdings *holdings)
{
	struct srv_stream_input input = { .scene = scene, .request = request, .holdings = holdings };
	assert_good(srv_stream_plan(stream, &input, &cause));
}

static uint32_t ground_tiles(const struct srv_step *step)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < step->plan.cut_count; i++)
		count += scene->pack->scene.lists[step->plan.cuts[i].list].kind == ECO_LIST_GROUND;
	return count;
}

static struct view_store *receive(struct view_store *into, const struct srv_stream *stream)
{
	if (!into)
		assert_int_equal(view_store_new(&into, &(struct view_store_options){ 0 }, NULL), ECO_OK);
	view_store_begin(into);
	assert_good(served_feed(into, stream, NULL, &cause));
	assert_int_equal(view_store_stats(into).chunks_twice, 0);
	return into;
}

/* ---- Steps ---- */

UNIT_TEST(ground_comes_coarse_to_fine)
{
	struct eco_request request = request_of(900, 120, 300000);
	FREED(srv_stream) stream;
	request.ground_px = 0.1;
	plan(&stream, &request, NULL);
	assert_true(stream.step_count >= 2);
	for (uint32_t i = 0; i < stream.step_count; i++) {
		assert_true(i + 1 < stream.step_count || stream.steps[i].plan.ground_px == 0.1);
		if (i)
			assert_true(stream.steps[i].plan.ground_px <= stream.steps[i - 1].plan.ground_px
				&& stream.steps[i].missing_bytes > stream.steps[i - 1].missing_bytes
				&& ground_tiles(&stream.steps[i]) >= ground_tiles(&stream.steps[i - 1]));
	}
	/* a picture of the horizon long before all of it: 341 tiles are no burden on the first */
	assert_true(scene->pack->scene.ground_count > 300 && stream.steps[0].end_bytes
		< stream.body_bytes / 4);
	view_store_free(receive(NULL, &stream));
}

/* ---- Bytes ---- */

UNIT_TEST(ground_gives_way_before_plants)
{
	struct eco_request request = request_of(300, 60, 60000);
	struct srv_stream whole, stream;
	uint32_t coarser = 0, fewer = 0, none = 0;
	double last = 0;
	plan(&whole, &request, NULL);
	for (uint64_t part = 40; part > 0; part--) {
		request.bytes = whole.body_bytes * part / 40;
		plan(&stream, &request, NULL);
		if (!stream.fits) {
			none++;
			srv_stream_free(&stream);
			continue;
		}
		const struct srv_step *step = &stream.steps[stream.step_count - 1];
		assert_true(stream.body_bytes <= request.bytes);
		assert_true(step->plan.ground_px >= ECO_GROUND_PX);
		if (step->plan.ground_px > 8
				|| step->plan.vertices < whole.steps[whole.step_count - 1].plan.vertices) {
			fewer++;
			assert_true(step->plan.ground_px >= 8);
		} else if (step->plan.ground_px > ECO_GROUND_PX) {
			coarser++;
			assert_true(step->plan.ground_px >= last);
			last = step->plan.ground_px;
		}
		view_store_free(receive(NULL, &stream));
		srv_stream_free(&stream);
	}
	assert_true(coarser > 2 && fewer > 2);
	srv_stream_free(&whole);
}

/* ---- Pictures ---- */

UNIT_TEST(opengl_and_software_draw_the_same_ground)
{
	static const double views[][2] = { { 300, 60 }, { 40, 3 }, { 900, 500 }, { 30, 900 } };
	OWNED(view_gl) *gl = NULL;
	uint32_t seams = 0;
	if (view_gl_open(&gl, &(struct view_gl_options){ 480, 320 }, NULL))
		skip();
	for (int i = 0; i < 4; i++) {
		struct eco_request request = request_of(views[i][0], views[i][1], 20000);
		FREED(srv_stream) stream;
		AT_END(view_select_free) struct view_selection selection;
		FREED(view_picture) a, b;
		struct lod_eye eye;
		plan(&stream, &request, NULL);
		OWNED(view_store) *held = receive(NULL, &stream);
		lod_eye_make(&eye, &request.view);
		assert_int_equal(view_select_make(&selection, held, &eye, NULL), ECO_OK);
		assert_int_equal(selection.ground.count, ground_tiles(&stream.steps[stream.step_count - 1]));
		for (uint32_t t = 0; t < selection.ground.count; t++)
			for (int side = 0; side < 4; side++)
				seams += selection.ground.tiles[t].seam.coarser[side] > 0;
		assert_int_equal(view_picture_init(&a, 480, 320, NULL), ECO_OK);
		assert_int_equal(view_picture_init(&b, 480, 320, NULL), ECO_OK);
		assert_good(view_gl_draw(gl, &(struct view_draw_job){ held, &selection, &eye, 0.05,
			2, NULL, VIEW_TINT_NONE, 1, false },
				&a, &cause));
		assert_int_equal(view_reference_draw(&(struct view_draw_job){ held, &selection, &eye,
			0.05, 2, NULL, VIEW_TINT_NONE, 1, false }, &b, NULL), ECO_OK);
		struct picture_difference apart = picture_compare(&a, &b);
		assert_true(apart.seen < 0.01 && apart.masks < 1 / 2000.0 && apart.owners < 1 / 1000.0);
	}
	assert_true(seams > 20);
}

UNIT_MAIN(open_all, close_all)
