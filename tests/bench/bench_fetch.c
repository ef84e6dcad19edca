#include "tests/bench/bench_fetch.h"

#include <stdlib.h>

static enum eco_code feed(struct view_store *store, const struct srv_body *body, uint64_t cut,
	struct eco_error *error)
{
	struct eco_wire_parser *parser;
	enum eco_code code = eco_wire_parser_new(&parser, &view_store_events, store, error);
	if (code)
		return code;
	uint64_t left = cut ? cut : UINT64_MAX;
	for (uint32_t i = 0; i < body->piece_count && !code; i++) {
		size_t size = body->pieces[i].size < left ? body->pieces[i].size : (size_t)left;
		code = eco_wire_feed(parser, body->pieces[i].bytes, size, error);
		left -= size;
	}
	if (!code && !cut)
		code = eco_wire_finish(parser, error);
	eco_wire_parser_free(parser);
	return code;
}

static uint64_t plan_bytes(const struct eco_plan *plan)
{
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, plan);
	uint64_t size = w.size;
	eco_writer_free(&w);
	return size;
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
		code = feed(store, &body, fetch->cut, error);
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
	fetch->plan_bytes = !code && view_store_plan(store) ? plan_bytes(view_store_plan(store)) : 0;
	return code;
}

double bench_near_m(const struct view_store *store)
{
	return view_store_near_m(store) > 0 ? view_store_near_m(store) : 0.1;
}

enum eco_code bench_draw(struct bench_drawing *drawing, const struct view_store *store, const struct eco_view
	*view, struct view_picture *picture, struct eco_error *error)
{
	*drawing = (struct bench_drawing){ .job = { .store = store, .selection = &drawing->selection,
		.eye = &drawing->eye, .near_m = bench_near_m(store) } };
	lod_eye_make(&drawing->eye, view);
	enum eco_code code = view_select_make(&drawing->selection, store, &drawing->eye, error);
	if (!code)
		code = view_picture_init(picture, view->width, view->height, error);
	return code ? code : view_reference_draw(&drawing->job, picture, error);
}
