/* A published scene's answers. Payloads lie in memory of their own, as the chunks' file is elsewhere: they are made
 * when they are asked for, filled by JavaScript, and freed with the next request, but for lists of plants. */
#include "server/publish/web/planner.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/format/chunk/chunk_columns.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/legend.h"
#include "ecofiles/format/wire.h"
#include "lod/plan/planner.h"
#include "server/describe.h"
#include "server/log.h"
#include "server/publish/index.h"

static struct {
	uint8_t *bytes;
	struct srv_index *index;
	struct eco_error error;
	struct srv_target target;
	struct srv_query query;
	struct eco_holdings holdings;
	struct srv_stream stream;
	bool planned;
	uint8_t **payloads;              /* per chunk, or NULL */
	struct planner_wanted *wanted;   uint32_t *chunks, wanted_count, wanted_capacity, chunk_capacity;
	uint32_t there;                  /* of what is wanted */
	struct eco_pack rows;            /* the index's pack, without a list of rows where they are not published */
	struct eco_writer body;
} own;

/* ---- What ecoserve has elsewhere ---- */

bool srv_trace_on(enum srv_trace_bit bit)
{
	(void)bit;
	return false;
}

void srv_trace(enum srv_trace_bit bit, const char *format, ...)
{
	(void)bit, (void)format;
}

/* Classes of tints are told by the legend alone. */
const char *eco_legend_class(const json_t *meta, const struct eco_scene *scene, uint32_t list, uint64_t place)
{
	(void)meta, (void)scene, (void)list, (void)place;
	return NULL;
}

/* Other payloads than plants' places are for who draws them. */
static enum eco_code no_drawing(struct eco_error *error)
{
	return eco_fail(error, ECO_UNSUPPORTED, "a planner decodes plants' places alone");
}

enum eco_code eco_mesh_decode(const struct eco_list *list, const struct eco_payload *payload, struct eco_elements *elements,
	struct eco_error *error)
{
	(void)list, (void)payload, (void)elements;
	return no_drawing(error);
}

enum eco_code eco_shapes_decode(const struct eco_list *list, const struct eco_stream *stream, struct eco_elements *stored,
	struct eco_error *error)
{
	(void)list, (void)stream, (void)stored;
	return no_drawing(error);
}

enum eco_code eco_ground_decode(struct eco_chunk_rows *rows, struct eco_error *error)
{
	(void)rows;
	return no_drawing(error);
}

static enum eco_code want(uint32_t chunk, struct eco_error *error)
{
	const struct eco_chunk *c = &own.index->pack.scene.chunks[chunk];
	bool room = eco_array_grow(&own.wanted, &own.wanted_capacity, own.wanted_count, sizeof *own.wanted)
		&& eco_array_grow(&own.chunks, &own.chunk_capacity, own.wanted_count, sizeof *own.chunks);
	own.payloads[chunk] = room ? calloc(1, c->size_bytes + 1u) : NULL;
	if (!own.payloads[chunk])
		return eco_no_memory(error, "the chunks of a view");
	own.wanted[own.wanted_count] = (struct planner_wanted){ (double)c->offset, c->size_bytes,
		(double)(uintptr_t)own.payloads[chunk] };
	own.chunks[own.wanted_count++] = chunk;
	return ECO_OK;
}

enum eco_code srv_scene_payload(const struct srv_scene *scene, uint32_t chunk, const uint8_t **bytes,
	size_t *size_bytes, struct eco_error *error)
{
	enum eco_code code = own.payloads[chunk] ? ECO_OK : want(chunk, error);
	*bytes = own.payloads[chunk];
	*size_bytes = scene->pack->scene.chunks[chunk].size_bytes;
	return code;
}

/* Rows; ECO_INTERRUPTED: JavaScript fetches them first. */
enum eco_code eco_pack_payload(const struct eco_pack *pack, uint32_t chunk, const uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error)
{
	bool missing = !own.payloads[chunk];
	enum eco_code code = srv_scene_payload(&own.index->scene, chunk, bytes, size_bytes, error);
	(void)pack;
	return code ? code : missing ? ECO_INTERRUPTED : ECO_OK;
}

/* ---- Opening ---- */

static int status_of(enum eco_code code)
{
	return code ? (int)srv_problem_rows[srv_problem_of(code)].status : 200;
}

int planner_open(uint8_t *index, size_t size)
{
	own.bytes = index;
	enum eco_code code = srv_index_read(&own.index, index, size, &own.error);
	if (!code && !(own.payloads = calloc(own.index->pack.scene.chunk_count + 1u, sizeof *own.payloads)))
		code = eco_no_memory(&own.error, "a published scene");
	if (!code) {
		own.index->pack.payloads = own.payloads;
		own.rows = own.index->pack;
		const struct eco_list *rows = eco_inventory_list(&own.rows.scene);
		if (rows && own.rows.scene.chunks[rows->chunk_first].size_bytes == SRV_INDEX_NO_ROWS)
			own.rows.scene.list_count--;
	}
	return status_of(code);
}

const char *planner_error(void) { return own.error.text; }

/* ---- Asking ---- */

static bool is_kept(enum eco_list_kind kind) { return kind == ECO_LIST_INSTANCES || kind == ECO_LIST_INVENTORY; }

/* Frees what the answer before this one left, but for lists of plants and their rows. */
static void forget(void)
{
	const struct eco_scene *scene = &own.index->pack.scene;
	own.error = (struct eco_error){ 0 };     /* the first one of a request counts */
	if (own.planned)
		srv_stream_free(&own.stream);
	own.planned = false;
	for (uint32_t i = own.there; i < own.wanted_count; i++) {
		free(own.payloads[own.chunks[i]]);
		own.payloads[own.chunks[i]] = NULL;
	}
	for (uint32_t g = 0; g < scene->group_count; g++)
		if (own.index->known[g] == LOD_PLACES_WANTED)
			own.index->known[g] = LOD_PLACES_MISSING;
	for (uint32_t i = 0; i < scene->list_count; i++)
		for (uint32_t c = 0; !is_kept(scene->lists[i].kind) && c < scene->lists[i].chunk_count; c++) {
			free(own.payloads[scene->lists[i].chunk_first + c]);
			own.payloads[scene->lists[i].chunk_first + c] = NULL;
		}
	free(own.holdings.items);
	own.holdings = (struct eco_holdings){ 0 };
	own.wanted_count = own.there = 0;
	own.body.size = 0;
}

static int refuse(int status, const char *why)
{
	if (why)
		eco_fail(&own.error, ECO_BAD_INPUT, "%s", why);
	return status;
}

int planner_ask(const char *target, const uint8_t *holdings, size_t size)
{
	const struct eco_pack *pack = &own.index->pack;
	forget();
	if (srv_target_parse(&own.target, target, strlen(target), &own.error)
			|| srv_query_parse(&own.query, &own.target, &own.error)
			|| eco_wire_read_holdings(holdings, size, &own.holdings, &own.error)
			|| srv_holdings_check(&pack->scene, &own.holdings, &own.error))
		return refuse(400, NULL);
	return own.query.pack.given && memcmp(&own.query.pack.id, &pack->id, sizeof pack->id) != 0
		? refuse(409, "the pack is not the one that 'pack' names") : 200;
}

/* ---- Answering ---- */

/* Places of lists that have come. */
static enum eco_code take_places(void)
{
	const struct eco_scene *scene = &own.index->pack.scene;
	enum eco_code code = ECO_OK;
	for (uint32_t g = 0; g < scene->group_count && !code; g++) {
		const struct eco_list *list = &scene->lists[scene->groups[g].list];
		for (uint32_t c = 0; own.index->known[g] == LOD_PLACES_WANTED && c < list->chunk_count && !code; c++)
			code = srv_index_take(own.index, scene->groups[g].list, c, own.payloads[list->chunk_first + c],
				scene->chunks[list->chunk_first + c].size_bytes, &own.error);
	}
	own.wanted_count = code ? own.wanted_count : 0;          /* what is damaged is fetched anew the next time */
	return code;
}

static enum eco_code want_places(void)
{
	const struct eco_scene *scene = &own.index->pack.scene;
	enum eco_code code = ECO_OK;
	for (uint32_t g = 0; g < scene->group_count && !code; g++) {
		const struct eco_list *list = &scene->lists[scene->groups[g].list];
		for (uint32_t c = 0; own.index->known[g] == LOD_PLACES_WANTED && c < list->chunk_count && !code; c++)
			code = own.payloads[list->chunk_first + c] ? ECO_OK : want(list->chunk_first + c, &own.error);
	}
	return code;
}

const struct planner_wanted *planner_wanted(void) { return own.wanted; }
uint32_t planner_wanted_count(void) { return own.wanted_count; }
const uint8_t *planner_body(void) { return own.body.bytes; }

/* The frame in which the payload of a chunk begins. */
static size_t frame_with(const struct srv_body *body, const uint8_t *payload)
{
	size_t at = 0, end = 0, frame = 0;
	for (uint32_t i = 0; i < body->piece_count && body->pieces[i].bytes != payload; i++)
		end += body->pieces[i].size;
	while (frame <= end && frame < own.body.size) {
		const uint8_t *size = own.body.bytes + frame + 4;
		at = frame;
		frame += ECO_FRAME_HEADER_BYTES
			+ ((size_t)size[0] | (size_t)size[1] << 8 | (size_t)size[2] << 16 | (size_t)size[3] << 24);
	}
	return at;
}

double planner_part(uint32_t count)
{
	struct srv_body body;
	own.there = count;
	own.body.size = 0;
	enum eco_code code = srv_stream_write(&own.stream, &body, &own.error);
	for (uint32_t i = 0; i < body.piece_count && !code; i++)
		eco_write_bytes(&own.body, body.pieces[i].bytes, body.pieces[i].size);
	double final = code || own.body.failed ? -1 : count >= own.wanted_count ? (double)own.body.size
		: (double)frame_with(&body, own.payloads[own.chunks[count]]);
	srv_body_free(&body);
	return final;
}

int planner_go(void)
{
	bool explain = own.query.explain;
	struct srv_stream_input input = { .scene = &own.index->scene, .request = &own.query.request, .rule = own.query.rule,
		.explain = explain, .holdings = &own.holdings, .places = own.index->known,
		.work_max = SRV_INDEX_PLAN_TIMES * atomic_load(&own.index->scene.typical_work) };
	enum eco_code code = take_places();
	code = code ? code : srv_stream_plan(&own.stream, &input, &own.error);
	own.planned = !code;
	if (code == ECO_INTERRUPTED) {
		code = want_places();
		return code ? status_of(code) : PLANNER_WANTS;
	}
	if (code || explain)
		return status_of(code);
	return !own.stream.fits ? 204 : planner_part(0) < 0 ? 500 : 200;
}

const char *planner_described(void)
{
	struct srv_json json = { .out = own.body };
	json.out.size = 0;
	srv_describe_plan(&json, &own.stream);
	eco_write_u8(&json.out, 0);
	own.body = json.out;
	return own.body.failed ? NULL : (const char *)own.body.bytes;
}

static enum eco_code describe_plants(struct srv_json *json)
{
	const struct srv_scene rows = { .pack = &own.rows }, *scene = &rows;
	struct srv_plants_query plants;
	struct srv_find_query find;
	const char *variables[2];
	const struct srv_route *route = srv_route_find(&own.target, variables);
	bool finds = route == &srv_routes[SRV_FIND];
	enum eco_code code = finds ? srv_find_query_parse(&find, &own.target, &own.error)
		: srv_plants_query_parse(&plants, &own.target, &own.error);
	if (code || finds)
		return code ? code : srv_describe_found(json, scene, own.index->known, &find, &own.error);
	uint32_t list = route == &srv_routes[SRV_PLANTS] ? srv_plants_list(scene, variables[1]) : ECO_NONE;
	return list == ECO_NONE ? eco_fail(&own.error, ECO_NOT_FOUND, "the scene has no such list of plants")
		: srv_describe_plants(json, scene, list, &plants, &own.error);
}

int planner_plants(const char *target, int again)
{
	struct srv_json json = { .out = own.body };
	if (!again)
		forget();
	enum eco_code code = again ? take_places() : srv_target_parse(&own.target, target, strlen(target), &own.error);
	own.wanted_count = code ? own.wanted_count : 0;
	json.out.size = 0;
	code = code ? code : describe_plants(&json);
	eco_write_u8(&json.out, 0);
	own.body = json.out;
	if (own.wanted_count || code == ECO_INTERRUPTED)
		code = want_places();
	return code == ECO_NOT_FOUND ? 404 : code && !own.wanted_count ? status_of(code) : own.wanted_count ? PLANNER_WANTS : own.body.failed ? 500 : 200;
}
