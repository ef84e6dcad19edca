/* Writing a stream's frames, for real or only to learn their size, by the same code.
 *
 *   srv_emit_init(&emit, scene, holdings, name_from, dry, &error);
 *   srv_emit_scene(&emit);
 *   srv_emit_step(&emit, &plan, &needs, &error);    for each step: BUNDLEs of what is missing by now, then PLAN
 *   srv_emit_ahead(&emit);                          the rest is for the next view
 *   srv_emit_needs(&emit, &needs, &error);          without a PLAN
 *   srv_emit_end(&emit, vertices);
 *   ... emit.bytes is exact; srv_emit_take(&emit, &body) if it was not dry ...
 *   srv_emit_free(&emit);
 *
 * A dry run keeps no frame and looks at no payload. A payload that is sent is a reference into the mapped pack. */
#ifndef SRV_EMIT_H
#define SRV_EMIT_H

#include "ecofiles/format/wire.h"
#include "server/stream.h"

/* stands behind the first `at` bytes of frames */
struct srv_payload { size_t at; const uint8_t *bytes; size_t size; };

struct srv_emit {
	const struct srv_scene *scene;
	bool dry;
	const atomic_bool *cancelled;        /* looked at before each list; NULL, or set after init */
	uint32_t *have;                      /* per list: chunks of its prefix that the client has by now */
	bool *known;                         /* per plant: the client knows it */
	struct eco_writer frames;            /* dry: the current frame only */
	struct srv_payload *payloads;        uint32_t payload_count, payload_capacity;
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

/* `name_from`: as in a request. */
enum eco_code srv_emit_init(struct srv_emit *emit, const struct srv_scene *scene,
	const struct eco_holdings *holdings, uint64_t name_from, bool dry, struct eco_error *error);
/* as after init, arrays reused */
void srv_emit_restart(struct srv_emit *emit, const struct eco_holdings *holdings);
void srv_emit_scene(struct srv_emit *emit);
enum eco_code srv_emit_step(struct srv_emit *emit, const struct eco_plan *plan,
	const struct eco_holdings *needs, struct eco_error *error);
enum eco_code srv_emit_needs(struct srv_emit *emit, const struct eco_holdings *needs,
	struct eco_error *error);
void srv_emit_ahead(struct srv_emit *emit);
void srv_emit_end(struct srv_emit *emit, uint64_t vertices);
/* Moves what was written into *body. ECO_NO_MEMORY if that, or any frame before, failed. */
enum eco_code srv_emit_take(struct srv_emit *emit, struct srv_body *body, struct eco_error *error);
void srv_emit_free(struct srv_emit *emit);

#endif
