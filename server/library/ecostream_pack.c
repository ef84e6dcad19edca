/* The end of libecostream where packs are: the server's store and streams, one scene at a time, without HTTP.
 * */
#include <stdlib.h>
#include <string.h>

#include "client-min/library/ecostream_status.h"
#include "ecofiles/format/wire.h"
#include "server/store.h"
#include "server/stream.h"

struct ecostream_pack { struct srv_store store; };       /* of one scene */

struct ecostream_answer {
	struct srv_stream stream;        /* its input points into this answer */
	struct eco_request request;
	struct eco_holdings holdings;
};

/* ---- Packs ---- */

enum ecostream_code ecostream_pack_open(struct ecostream_pack **out, const char *path,
	struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct ecostream_pack *pack = calloc(1, sizeof *pack);
	*out = NULL;
	if (!pack)
		return library_done(error, eco_no_memory(&own, "a pack"), &own);
	srv_store_init(&pack->store);
	enum eco_code code = srv_store_add(&pack->store, "pack", path, &own);
	if (code)
		ecostream_pack_close(pack);
	else
		*out = pack;
	return library_done(error, code, &own);
}

void ecostream_pack_close(struct ecostream_pack *pack)
{
	if (!pack)
		return;
	srv_store_free(&pack->store);
	free(pack);
}

void ecostream_pack_info(const struct ecostream_pack *pack, struct ecostream_pack_info *info)
{
	const struct eco_scene *scene = &pack->store.scenes[0]->pack->scene;
	const struct eco_tile *root = &scene->tiles[scene->root];
	*info = (struct ecostream_pack_info){ .name = scene->name, .plants = root->instance_count,
		.kinds = scene->plant_count, .lists = scene->list_count };
	memcpy(info->low, root->low, sizeof info->low);
	memcpy(info->high, root->high, sizeof info->high);
}

/* ---- Answers ---- */

static enum eco_code read_request(struct ecostream_answer *answer, const struct ecostream_request *request,
	struct eco_error *error)
{
	struct eco_request *r = &answer->request;
	*r = (struct eco_request){ .view = library_view_of(request), .vertices = request->vertices,
		.bytes = request->bytes ? request->bytes : ECO_BYTES_UNBOUNDED };
	ECO_PASS(eco_view_check(&r->view, error));
	if (r->vertices > ECO_VERTICES_MAX)
		return eco_fail(error, ECO_BAD_INPUT, "vertices: at most 2^63 - 1");
	return request->holdings ? eco_wire_read_holdings(request->holdings, request->holdings_size,
		&answer->holdings, error) : ECO_OK;
}

static enum eco_code plan(struct ecostream_answer *answer, const struct ecostream_pack *pack,
	const struct ecostream_request *request, struct eco_error *error)
{
	const struct srv_scene *scene = pack->store.scenes[0];
	ECO_PASS(read_request(answer, request, error));
	ECO_PASS(srv_holdings_check(&scene->pack->scene, &answer->holdings, error));
	return srv_stream_plan(&answer->stream, &(struct srv_stream_input){ .scene = scene,
		.request = &answer->request, .holdings = &answer->holdings }, error);
}

enum ecostream_code ecostream_plan(struct ecostream_answer **out, const struct ecostream_pack *pack,
	const struct ecostream_request *request, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct ecostream_answer *answer = calloc(1, sizeof *answer);
	*out = NULL;
	if (!answer)
		return library_done(error, eco_no_memory(&own, "an answer"), &own);
	enum eco_code code = plan(answer, pack, request, &own);
	if (code)
		ecostream_answer_free(answer);
	else
		*out = answer;
	return library_done(error, code, &own);
}

void ecostream_answer_free(struct ecostream_answer *answer)
{
	if (!answer)
		return;
	srv_stream_free(&answer->stream);
	free(answer->holdings.items);
	free(answer);
}

void ecostream_answer_counts(const struct ecostream_answer *answer, struct ecostream_counts *counts)
{
	const struct srv_stream *stream = &answer->stream;
	*counts = (struct ecostream_counts){ .bytes = 0 };
	if (!stream->fits)
		return;
	const struct eco_plan *plan = &stream->steps[stream->step_count - 1].plan;
	*counts = (struct ecostream_counts){ stream->body_bytes, plan->vertices, plan->visible_plants,
		stream->chunk_count, plan->cut_count, eco_predicted_q(&plan->prediction), plan->m16 };
}

enum ecostream_code ecostream_encode(const struct ecostream_answer *answer, ecostream_write *write,
	void *context, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct srv_body body = { .pieces = NULL };
	enum eco_code code = answer->stream.fits ? srv_stream_write(&answer->stream, &body, &own)
		: eco_fail(&own, ECO_BAD_INPUT, "not even the smallest stream fits %llu bytes: it has %llu",
		(unsigned long long)answer->request.bytes, (unsigned long long)answer->stream.body_bytes);
	for (uint32_t i = 0; i < body.piece_count && !code; i++)
		if (write(context, body.pieces[i].bytes, body.pieces[i].size) != 0)
			code = eco_fail(&own, ECO_IO, "the receiver ended the stream");
	srv_body_free(&body);
	return library_done(error, code, &own);
}
