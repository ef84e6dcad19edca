/* One picture, each step timed, and scored. The same rasteriser draws both pictures that are compared, the
 * one within its budget and full detail, so that no difference between renderers counts as error. The time of
 * drawing is OpenGL's where there is one: of the second time that the same picture is drawn, when its shaders
 * are compiled and its data is on the card, as in all but the first frame of a viewer; else the rasteriser's.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gl.h"
#include "client-min/view_reference.h"
#include "client-min/draw/view_picture.h"
#include "client-min/view_report.h"
#include "ecofiles/base/memory.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/pictures/bench_widest.h"

struct bench_client {
	struct srv_store scenes;
	struct view_store *full;             /* holds full detail of all views so far */
	struct view_store *steps;            /* holds what came in steps; NULL: nothing did */
	struct view_picture reference;       /* full detail of the view `of` */
	struct eco_view of;
	double ceiling;                      /* of the reference; NaN: not measured */
	bool has_reference, sees, untimed;
};

struct bench_client *bench_client_open(const char *pack)
{
	struct view_store_options options = { .images = true, .memory_max = 16ull << 30 };
	struct bench_client *c = eco_alloc(1, sizeof *c);
	srv_store_init(&c->scenes);
	must(srv_store_add(&c->scenes, "bench", pack, must_error));
	must(view_store_new(&c->full, &options, must_error));
	return c;
}

void bench_client_close(struct bench_client *client)
{
	if (!client)
		return;
	view_picture_free(&client->reference);
	view_store_free(client->full);
	view_store_free(client->steps);
	srv_store_free(&client->scenes);
	free(client);
}

void bench_client_see(struct bench_client *client) { client->sees = true; }
void bench_client_untimed(struct bench_client *client) { client->untimed = true; }

/* ---- Drawing ---- */

double bench_gl_ms(const struct view_store *store, const struct view_selection *selection,
	const struct eco_view *view)
{
	struct lod_eye eye;
	struct view_picture picture = { 0 };
	struct view_gl *gl = NULL;
	struct eco_error why = { 0 };
	double near_m = bench_near_m(store);
	lod_eye_make(&eye, view);
	bool drawn = !view_gl_open(&gl, &(struct view_gl_options){ view->width, view->height }, &why) &&
		!view_picture_init(&picture, view->width, view->height, &why);
	for (int i = 0; i < 2 && drawn; i++)
		drawn = !view_gl_draw(gl, &(struct view_gl_job){ store, selection, &eye, near_m,
			VIEW_TINT_NONE }, &picture, &why);
	double ms = drawn ? picture.draw_ms : NAN;
	view_gl_close(gl);
	view_picture_free(&picture);
	return ms;
}

/* Draws what the store holds, and the soft counts of a client that sees. */
static void draw(const struct bench_client *client, struct bench_drawing *drawing, const struct view_store *store,
	const struct eco_view *view, struct view_picture *picture)
{
	must(bench_draw(drawing, store, view, picture, must_error));
	if (client->sees)
		must(view_measure_soft(&drawing->job, picture, must_error));
}

/* ---- Full detail ---- */

void bench_client_reference(struct bench_client *client, const struct eco_request *request)
{
	struct eco_request full = { .view = request->view, .vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED,
		.ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
	struct bench_drawing drawing = { .job = { .near_m = 0 } };
	if (client->has_reference && !memcmp(&client->of, &request->view, sizeof client->of))
		return;
	view_picture_free(&client->reference);
	client->ceiling = NAN;
	must(bench_fetch(NULL, client->scenes.scenes[0], &full, client->full, must_error));
	draw(client, &drawing, client->full, &full.view, &client->reference);
	if (client->sees)
		must(view_measure_ceiling(&drawing.job, &client->reference, &client->ceiling, must_error));
	view_select_free(&drawing.selection);
	client->of = request->view;
	client->has_reference = true;
}

uint32_t bench_client_summaries(const struct bench_client *client) { return view_store_summaries(client->full); }

const struct view_picture *bench_client_full(const struct bench_client *client)
{
	return &client->reference;
}

/* ---- Frames ---- */

/* Root mean square over all channels of the pixels that one of both covers. */
static double colour_rms(const struct view_picture *a, const struct view_picture *b)
{
	double sum = 0;
	uint64_t count = 0;
	for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
		if (!a->cover[i] && !b->cover[i])
			continue;
		for (int k = 0; k < 3; k++) {
			double d = (a->rgb[3 * i + k] - b->rgb[3 * i + k]) / 255.0;
			sum += d * d;
		}
		count += 3;
	}
	return count ? sqrt(sum / (double)count) : 0;
}

void bench_client_score(const struct bench_client *client, struct bench_frame *frame,
	const struct view_picture *picture)
{
	const struct view_picture *reference = &client->reference;
	struct view_measures measures = { .soft_q = NAN, .picture_error = NAN };
	if (client->sees)
		must(view_measure_pair(picture, reference, NULL, &measures, must_error));
	else
		lod_score(&measures.score, &(struct lod_score_input){ picture->width, picture->height,
			picture->cover, reference->cover, picture->owner, reference->owner });
	frame->score = measures.score;
	frame->soft_q = measures.soft_q;
	frame->picture_error = measures.picture_error;
	frame->ceiling = client->ceiling;
	frame->colour_rms = colour_rms(picture, reference);
}

/* One answer into the store, which is made where it is NULL. False where no answer has so few bytes. */
static bool answer(struct bench_client *client, struct bench_frame *frame, struct view_store **store)
{
	struct bench_fetch fetch = { .rule = frame->rule, .ignore_occlusion = frame->ignore_occlusion,
		.cut = frame->cut };
	if (!*store)
		must(view_store_new(store, &(struct view_store_options){ .images = true }, must_error));
	enum eco_code code = bench_fetch(&fetch, client->scenes.scenes[0], &frame->request, *store, must_error);
	if (code == ECO_TOO_LARGE && frame->request.bytes != ECO_BYTES_UNBOUNDED) {
		*must_error = (struct eco_error){ 0 };
		return false;
	}
	must(code);
	const struct eco_plan *plan = view_store_plan(*store);
	frame->predicted_q = plan ? eco_predicted_q(&plan->prediction) : NAN;
	frame->vertices = plan ? plan->vertices : 0;
	frame->bytes = fetch.bytes;
	frame->plan_bytes = fetch.plan_bytes;
	frame->plan_ms = fetch.plan_ms;
	frame->decode_ms = fetch.decode_ms;
	return true;
}

bool bench_client_frame(struct bench_client *client, struct bench_frame *frame, struct view_picture *picture)
{
	const struct eco_view *view = &frame->request.view;
	struct view_store *store = NULL;
	struct view_picture drawn = { 0 };
	struct bench_drawing drawing = { .job = { .near_m = 0 } };
	bench_client_reference(client, &frame->request);
	bool answered = answer(client, frame, &store);
	if (answered) {
		draw(client, &drawing, store, view, &drawn);
		bench_client_score(client, frame, &drawn);
		double gl_ms = client->untimed ? NAN : bench_gl_ms(store, &drawing.selection, view);
		frame->widest_px = !client->sees ? NAN : bench_widest_px(store, &drawing.selection, &drawing.eye,
			&drawn);
		frame->vertices = drawn.vertices;
		frame->draw_ms = isnan(gl_ms) ? drawn.draw_ms : gl_ms;
	}
	view_select_free(&drawing.selection);
	view_store_free(store);
	if (picture)
		*picture = drawn;
	else
		view_picture_free(&drawn);
	return answered;
}

void bench_client_step(struct bench_client *client, struct bench_frame *frame, struct view_picture *picture)
{
	struct bench_drawing drawing = { .job = { .near_m = 0 } };
	answer(client, frame, &client->steps);
	if (picture)
		draw(client, &drawing, client->steps, &frame->request.view, picture);
	view_select_free(&drawing.selection);
}

void bench_client_compare(struct bench_client *client, struct bench *bench, const char *file,
	const struct view_picture *picture, const char *const words[3])
{
	struct view_measures measures;
	uint32_t size[2];
	uint8_t *rgb = NULL;
	float *map = eco_alloc((size_t)picture->width * picture->height, sizeof *map);
	must(view_measure_pair(picture, &client->reference, map, &measures, must_error));
	must(view_compare_draw(&(struct view_compare){ picture, &client->reference, map,
		{ words[0], words[1], words[2] } }, &rgb, size, must_error));
	bench_picture_write(bench, file, size[0], size[1], rgb);
	free(rgb);
	free(map);
}
