#include "tests/support/serve/served.h"

#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/ecopack/make.h"
#include "tests/support/files.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/scene_packs.h"
#include "tests/support/scratch.h"

enum eco_code served_feed(struct view_store *held, const struct srv_stream *stream, uint64_t *bytes,
	struct eco_error *error)
{
	struct eco_wire_parser *parser;
	struct srv_body body;
	enum eco_code code = ECO_OK;
	assert_int_equal(eco_wire_parser_new(&parser, &view_store_events, held, NULL), ECO_OK);
	assert_int_equal(srv_stream_write(stream, &body, NULL), ECO_OK);
	for (uint32_t i = 0; i < body.piece_count && !code; i++)
		code = eco_wire_feed(parser, body.pieces[i].bytes, body.pieces[i].size, error);
	if (!code)
		code = eco_wire_finish(parser, error);
	if (bytes)
		*bytes = body.size_bytes;
	eco_wire_parser_free(parser);
	srv_body_free(&body);
	return code;
}

const struct srv_scene *served_sample(struct srv_store *packs, const char *path, uint32_t side, double step_m,
	bool plain, double (*height)(double x, double y))
{
	double half_m = step_m * (side - 1) / 2;
	struct eco_ground ground = ground_make(side, side, -half_m, -half_m, step_m, height);
	folder_make("build/tmp");
	remove(path);
	srv_store_init(packs);
	assert_good(sample_pack_write_on(path, &ground, plain, &cause));
	assert_good(srv_store_add(packs, "sample", path, &cause));
	eco_ground_free(&ground);
	remove(path);
	return srv_store_find(packs, "sample");
}

void served_open(struct served *seen, const char *json, const char *pack)
{
	char from[512], to[512];
	snprintf(from, sizeof from, "%s", in_root(json));
	snprintf(to, sizeof to, "%s", in_root(pack));
	assert_good(make_pack(&(struct make_options){ .scene = from, .pack = to, .jobs = 2,
		.order = LOD_ORDER_COMBINED, .draft = true }, &cause));
	*seen = (struct served){ .scene = NULL };
	srv_store_init(&seen->packs);
	assert_good(srv_store_add(&seen->packs, "it", to, &cause));
	seen->scene = srv_store_find(&seen->packs, "it");
	assert_int_equal(view_store_new(&seen->held, &(struct view_store_options){ .images = true }, NULL), ECO_OK);
}

void served_look(struct served *seen, const struct eco_view *view, double ground_px)
{
	struct eco_request request = { .view = *view, .vertices = seen->vertices, .bytes =
		ECO_BYTES_UNBOUNDED, .ground_px = ground_px };
	struct eco_holdings holdings = { 0 };
	struct srv_stream_input input = { .scene = seen->scene, .request = &request, .holdings = &holdings };
	struct srv_stream stream;
	assert_int_equal(view_store_holdings(seen->held, &holdings, NULL), ECO_OK);
	assert_good(srv_stream_plan(&stream, &input, &cause));
	view_store_begin(seen->held);
	assert_good(served_feed(seen->held, &stream, NULL, &cause));
	srv_stream_free(&stream);
	free(holdings.items);
	lod_eye_make(&seen->eye, view);
	view_select_free(&seen->selection);
	assert_int_equal(view_select_make(&seen->selection, seen->held, &seen->eye, NULL), ECO_OK);
}

void served_close(struct served *seen)
{
	view_select_free(&seen->selection);
	view_store_free(seen->held);
	srv_store_free(&seen->packs);
}
