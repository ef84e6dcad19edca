/* The body of an answer: its frames, for real or only to learn their size, by the same code.
 *
 *   eco_wire_body_init(&body, scene, pack, holdings, name_from, &error);
 *   eco_wire_body_scene(&body);
 *   eco_wire_body_step(&body, &plan, &needs, &error);    for each step: BUNDLEs of what is missing by now, then PLAN
 *   eco_wire_body_ahead(&body);                          the rest is for the next view
 *   eco_wire_body_needs(&body, &needs, &error);          without a PLAN
 *   eco_wire_body_end(&body, vertices);
 *   ... body.bytes is exact; frames and payloads are the body ...
 *   eco_wire_body_free(&body);
 *
 * Without a pack the run is dry: it keeps no frame and looks at no payload. A payload that is sent is a
 * reference into the mapped pack, whose hash the caller has checked. */
#pragma once

#include <stdatomic.h>

#include "ecofiles/format/wire.h"

/* Stands behind the first `at` bytes of frames. */
struct eco_wire_payload { size_t at; uint32_t chunk; const uint8_t *bytes; size_t size; };

struct eco_wire_body {
	const struct eco_scene *scene;
	const struct eco_pack *pack;         /* NULL: a dry run */
	const atomic_bool *cancelled;        /* looked at before each list; NULL, or set after init */
	uint32_t *have;                      /* per list: chunks of its prefix that the client has by now */
	uint8_t *known;                      /* per plant: 0; 1: the client knows it; 2: its cells, too */
	bool *of_cell;                       /* per list: the client knows the cells of its plant */
	struct eco_writer frames;            /* dry: the current frame only */
	struct eco_wire_payload *payloads;        uint32_t payload_count, payload_capacity;
	uint32_t number;                     /* of the next frame */
	struct eco_wire_items items;
	struct eco_wire_bundle bundle;       /* that is being filled, if any is: */
	bool bundle_open;
	uint32_t bundle_payload;             /* its first payload */
	uint64_t bundle_bytes;               /* of its payloads so far */
	uint64_t bytes;                      /* so far, and of chunks that are named */
	uint64_t chunk_count, chunk_bytes;   /* carried or named */
	uint64_t name_from, named_bytes;     /* chunks of so many bytes are named; 0: none. Bytes of those */
};

/* About what a chunk takes in a body: its payload, its fields, and with a list's first chunk the list's record. */
static inline double eco_wire_chunk_bytes(const struct eco_scene *scene, uint32_t list, uint32_t ordinal)
{
	const struct eco_list *l = &scene->lists[list];
	return (double)scene->chunks[l->chunk_first + ordinal].size_bytes + 3 + (ordinal ? 0 : 12 + (double)l->group_count);
}

/* `holdings` may be NULL. `name_from`: as in a request. */
enum eco_code eco_wire_body_init(struct eco_wire_body *body, const struct eco_scene *scene, const struct eco_pack *pack,
	const struct eco_holdings *holdings, uint64_t name_from, struct eco_error *error);
/* As after init; arrays are reused. */
void eco_wire_body_restart(struct eco_wire_body *body, const struct eco_holdings *holdings);
void eco_wire_body_scene(struct eco_wire_body *body);
enum eco_code eco_wire_body_step(struct eco_wire_body *body, const struct eco_plan *plan,
	const struct eco_holdings *needs, struct eco_error *error);
enum eco_code eco_wire_body_needs(struct eco_wire_body *body, const struct eco_holdings *needs,
	struct eco_error *error);
void eco_wire_body_ahead(struct eco_wire_body *body);
void eco_wire_body_end(struct eco_wire_body *body, uint64_t vertices);
/* Exact bytes of a body with one step, for a client with these holdings; a dry run. */
enum eco_code eco_wire_body_size(struct eco_wire_body *body, const struct eco_holdings *holdings,
	const struct eco_plan *plan, const struct eco_holdings *needs, uint64_t *bytes, struct eco_error *error);
void eco_wire_body_free(struct eco_wire_body *body);
