/* One picture, each step timed, and scored. The same rasteriser draws both pictures that are compared, the
 * one within its budget and full detail, so that no difference between renderers counts as error. A client
 * that sees compares a picture of BENCH_SAMPLES samples a pixel with the truth (view_truth.h).
 *
 * The time of drawing is OpenGL's where there is one, for one sample: of the second time that the same
 * picture is drawn, when its shaders are compiled and its data is on the card, as in all but the first frame
 * of a viewer; else the rasteriser's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_picture.h"
#include "client-min/view_report.h"
#include "client-min/view_measure.h"
#include "ecofiles/base/memory.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_fetch.h"

/* ---- One answer ---- */

static enum eco_code feed(struct view_store *store, const struct srv_body *body, struct eco_error *error)
{
	struct eco_wire_parser *parser;
	enum eco_code code = eco_wire_parser_new(&parser, &view_store_events, store, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < body->piece_count && !code; i++)
		code = eco_wire_feed(parser, body->pieces[i].bytes, body->pieces[i].size, error);
	if (!code)
		code = eco_wire_finish(parser, error);
	eco_wire_parser_free(parser);
	return code;
}

/* Adds one answer to `fetch`. */
static enum eco_code ask(struct bench_fetch *fetch, const struct srv_scene *scene,
	const struct eco_request *request,
	struct view_store *store, struct eco_error *error)
{
	struct eco_holdings holdings = { 0 };
	struct srv_stream stream = { 0 };
	struct srv_body body = { 0 };
	enum eco_code code = view_store_holdings(store, &holdings, error);
	struct srv_stream_input input = { .scene = scene, .request = request, .holdings = &holdings,
		.rule = fetch->rule,
		.ignore_occlusion = fetch->ignore_occlusion };
	double begun = view_clock_ms();
	if (!code)
		code = srv_stream_plan(&stream, &input, error);
	if (!code && !stream.fits)
		code = eco_fail(error, ECO_TOO_LARGE, "no answer has so few bytes");
	if (!code)
		code = srv_stream_write(&stream, &body, error);
	double planned = view_clock_ms();
	if (!code)
		code = feed(store, &body, error);
	fetch->requests++;
	fetch->plan_ms += planned - begun;
	fetch->decode_ms += view_clock_ms() - planned;
	fetch->bytes += body.size_bytes;
	srv_body_free(&body);
	srv_stream_free(&stream);
	free(holdings.items);
	return code;
}

enum eco_code bench_fetch(struct bench_fetch *fetch, const struct srv_scene *scene,
	const struct eco_request *request, struct view_store *store, struct eco_error *error)
{
	struct bench_fetch unasked = { 0 };
	struct eco_request now = *request;
	if (!fetch)
		fetch = &unasked;
	fetch->requests = 0;
	fetch->plan_ms = fetch->decode_ms = 0;
	fetch->bytes = 0;
	view_store_begin(store);
	enum eco_code code = ask(fetch, scene, &now, store, error);
	for (uint64_t vertices; !code && view_store_again(store, &vertices);) {
		now.vertices = request->bytes == ECO_BYTES_UNBOUNDED ? request->vertices : vertices;
		code = ask(fetch, scene, &now, store, error);
	}
	return code;
}

double bench_near_m(const struct view_store *store)
{
	return view_store_near_m(store) > 0 ? view_store_near_m(store) : 0.1;
}

enum eco_code bench_draw(struct bench_drawing *drawing, const struct view_store *store, const struct eco_view
	*view, const struct view_sky *sky, struct view_picture *picture, struct eco_error *error)
{
	*drawing = (struct bench_drawing){ .job = { .store = store, .selection = &drawing->selection,
		.eye = &drawing->eye, .near_m = bench_near_m(store) } };
	lod_eye_make(&drawing->eye, view);
	enum eco_code code = view_select_make(&drawing->selection, store, &drawing->eye, error);
	if (!code)
		code = view_picture_init(picture, view->width, view->height, error);
	if (!code && sky)
		drawing->selection.sky = *sky;
	return code ? code : view_reference_draw(&drawing->job, picture, error);
}

/* ---- Clients ---- */

struct bench_client {
	struct srv_store scenes;
	struct view_store *full;             /* holds full detail of all views so far */
	struct view_picture reference;       /* full detail of the view `of`, with the colours of the truth if it sees */
	struct eco_view of;
	struct bench_truth truth;            /* of the reference */
	const char *pack;
	struct bench *bench;                 /* whose cache holds truths; NULL: it does not see */
	uint64_t coarse;                     /* view_selection's, of the reference */
	bool has_reference, untimed;
};

struct bench_client *bench_client_open(const char *pack)
{
	struct view_store_options options = { .images = true, .memory_max = 16ull << 30 };
	struct bench_client *c = eco_alloc(1, sizeof *c);
	c->pack = pack;
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
	srv_store_free(&client->scenes);
	free(client);
}

void bench_client_see(struct bench_client *client, struct bench *bench) { client->bench = bench; }
void bench_client_untimed(struct bench_client *client) { client->untimed = true; }

/* ---- Drawing ---- */

static const struct view_sky *sky_of(const struct bench_client *client)
{
	return client->bench ? &client->bench->sky : NULL;
}

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
		drawn = !view_gl_draw(gl, &(struct view_draw_job){ store, selection, &eye, near_m,
			0, NULL, VIEW_TINT_NONE, 1, false }, &picture, &why);
	double ms = drawn ? picture.draw_ms : NAN;
	view_gl_close(gl);
	view_picture_free(&picture);
	return ms;
}

/* ---- Full detail ---- */

/* Colours become those of a still picture; soft counts come with them. */
static void draw_samples(struct view_draw_job *job, struct view_picture *picture)
{
	job->samples = BENCH_SAMPLES;
	must(view_reference_draw(job, picture, must_error));
	must(view_measure_soft(job, picture, must_error));
}

struct sight { struct bench_client *client; const struct view_draw_job *job; char dir[512]; };

/* The unit of a truth: figures of struct bench_truth. Draws and keeps the truth itself. */
static json_t *judge_full(void *ctx)
{
	const struct sight *s = ctx;
	struct view_draw_job job = *s->job;
	struct view_picture *reference = &s->client->reference, rough = { 0 };
	size_t bytes = 3 * (size_t)reference->width * reference->height;
	struct bench_truth t;
	must(view_picture_init(&rough, reference->width, reference->height, must_error));
	memcpy(rough.rgb, reference->rgb, bytes);
	must(view_truth_draw(&job, s->dir, reference, &t.cpu_ms, must_error));
	t.floor_one = view_picture_error(&rough, reference);
	job.samples = BENCH_SAMPLES;
	must(view_reference_draw(&job, &rough, must_error));
	t.floor = view_picture_error(&rough, reference);
	must(view_measure_ceiling(&job, reference, &t.ceiling, must_error));
	view_picture_free(&rough);
	return bench_reals(&t.cpu_ms, BENCH_TRUTH_FIGURES);
}

/* Gives the reference the colours of the truth, and says how it was drawn. */
static void find_truth(struct bench_client *client, const struct view_draw_job *job, const struct eco_view *view)
{
	struct sight s = { .client = client, .job = job };
	char name[64];
	double cpu_ms;
	snprintf(s.dir, sizeof s.dir, "%s/truths", client->bench->cache);
	snprintf(name, sizeof name, "truth-%016llx", (unsigned long long)XXH3_64bits(view, sizeof *view));
	bench_cells(bench_unit(client->bench, name, bench_pack_stamp(client->pack), judge_full, &s),
		&client->truth.cpu_ms, BENCH_TRUTH_FIGURES);
	must(view_truth_draw(job, s.dir, &client->reference, &cpu_ms, must_error));
	must(view_measure_soft(job, &client->reference, must_error));
}

void bench_client_reference(struct bench_client *client, const struct eco_request *request)
{
	struct eco_request full = { .view = request->view, .vertices = ECO_VERTICES_MAX,
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
	struct bench_drawing drawing = { .job = { .near_m = 0 } };
	if (client->has_reference && !memcmp(&client->of, &request->view, sizeof client->of))
		return;
	view_picture_free(&client->reference);
	must(bench_fetch(NULL, client->scenes.scenes[0], &full, client->full, must_error));
	must(bench_draw(&drawing, client->full, &full.view, sky_of(client), &client->reference, must_error));
	client->coarse = drawing.selection.coarse;
	if (client->bench && client->coarse)
		must(eco_fail(must_error, ECO_TOO_LARGE, "%s: a view has %llu plants or tiles that full detail draws "
			"coarsely, and no truth: look at fewer plants", client->pack,
			(unsigned long long)client->coarse));
	if (client->bench)
		find_truth(client, &drawing.job, &full.view);
	view_select_free(&drawing.selection);
	client->of = request->view;
	client->has_reference = true;
}

uint64_t bench_client_coarse(const struct bench_client *client) { return client->coarse; }

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
	frame->measures = (struct view_measures){ .soft_q = NAN, .picture_error = NAN, .blocks = { NAN, NAN, NAN } };
	if (client->bench)
		view_measure_pair(picture, reference, NULL, &frame->measures);
	else
		lod_score(&frame->measures.score, &(struct lod_score_input){ picture->width, picture->height,
			picture->cover, reference->cover, picture->owner, reference->owner });
	frame->truth = client->truth;
	frame->colour_rms = colour_rms(picture, reference);
}

/* One answer into a new store. */
static void answer(struct bench_client *client, struct bench_frame *frame, struct view_store **store)
{
	struct bench_fetch fetch = { .rule = frame->rule, .ignore_occlusion = frame->ignore_occlusion };
	must(view_store_new(store, &(struct view_store_options){ .images = true }, must_error));
	must(bench_fetch(&fetch, client->scenes.scenes[0], &frame->request, *store, must_error));
	const struct eco_plan *plan = view_store_plan(*store);
	frame->predicted_q = plan ? eco_predicted_q(&plan->prediction) : NAN;
	frame->vertices = plan ? plan->vertices : 0;
	frame->bytes = fetch.bytes;
	frame->plan_ms = fetch.plan_ms;
	frame->decode_ms = fetch.decode_ms;
}

void bench_client_frame(struct bench_client *client, struct bench_frame *frame, struct view_picture *picture)
{
	const struct eco_view *view = &frame->request.view;
	struct view_store *store = NULL;
	struct view_picture drawn = { 0 };
	struct bench_drawing drawing = { .job = { .near_m = 0 } };
	bench_client_reference(client, &frame->request);
	answer(client, frame, &store);
	must(bench_draw(&drawing, store, view, sky_of(client), &drawn, must_error));
	double gl_ms = client->untimed ? NAN : bench_gl_ms(store, &drawing.selection, view);
	frame->vertices = drawn.vertices;
	frame->draw_ms = isnan(gl_ms) ? drawn.draw_ms : gl_ms;
	if (client->bench)
		draw_samples(&drawing.job, &drawn);
	bench_client_score(client, frame, &drawn);
	if (frame->look)
		frame->look(frame->ctx, &drawing.job);
	view_select_free(&drawing.selection);
	view_store_free(store);
	if (picture)
		*picture = drawn;
	else
		view_picture_free(&drawn);
}

void bench_client_compare(struct bench_client *client, struct bench *bench, const char *file,
	const struct view_picture *picture, const char *const words[3])
{
	struct view_measures measures;
	uint32_t size[2];
	uint8_t *rgb = NULL;
	float *map = eco_alloc((size_t)picture->width * picture->height, sizeof *map);
	view_measure_pair(picture, &client->reference, map, &measures);
	must(view_compare_draw(&(struct view_compare){ picture, &client->reference, map,
		{ words[0], words[1], words[2] } }, &rgb, size, must_error));
	bench_picture_write(bench, file, size[0], size[1], rgb);
	free(rgb);
	free(map);
}
