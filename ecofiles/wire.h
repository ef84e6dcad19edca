/* The stream: how a plan and the chunks it needs travel. One response body is a sequence of frames; any prefix that ends after a
 * PLAN frame is a valid picture within the vertex budget.
 *
 *   SCENE                                     once
 *   step: (PLANT | LIST | CHUNK)* PLAN        one or more, coarse first; only what the client lacks
 *   END                                       missing END = truncated
 *
 * Frame (little-endian):
 *   0   u8  type      1  u8[3] 0      4  u32 payload length n
 *   8   u64 XXH3-64 of bytes [0,8), of the frame's number in the stream (u32, from 0) and of the payload
 *   16  n bytes
 *
 * SCENE  u32 version = 1, u8[16] pack id, f64 near_m, u32 needs, u32 ground list, u32 plant count, u32 list count, str name
 * PLANT  u32 plant, str name, f32 height, u32 anchor first, u32 anchor count, anchors            once per plant the client has
 *                                                                                                nothing of
 * LIST   u32 list, the list record of pack.h (eco_list_write), its palette (3 bytes a colour)    before its first chunk
 * CHUNK  u32 list, u32 ordinal, u8[16] id, u32 primitives, u32 elements, payload                 ordinals ascending per list
 * PLAN   see eco_wire_write_plan; replaces the plan before it. Each `list` in it is held up to its `end`.
 * END    u64 vertices of the last plan, u64 bytes of the body, END included
 *
 * str: varint length, UTF-8. Holdings (body of a POST): u32 count, then per list, ascending: varint list delta, varint chunks.
 * A client that holds a chunk of a list knows its LIST record; one that holds a chunk of any list of a plant (not of its
 * instances) knows its PLANT record. */
#ifndef ECO_WIRE_H
#define ECO_WIRE_H

#include "ecofiles/bytes.h"
#include "ecofiles/plan.h"

enum eco_frame_type { ECO_FRAME_SCENE = 1, ECO_FRAME_PLANT, ECO_FRAME_LIST, ECO_FRAME_CHUNK, ECO_FRAME_PLAN, ECO_FRAME_END };
#define ECO_FRAME_HEADER_BYTES 16u
#define ECO_FRAME_PAYLOAD_MAX (1u << 27)
#define ECO_END_FRAME_BYTES (ECO_FRAME_HEADER_BYTES + 16u)

/* Writing: frames appended to a writer. Begin, write the payload's fields, end (patches length and hash). */
struct eco_frame_mark { size_t at; uint32_t number; };
struct eco_frame_mark eco_frame_begin(struct eco_writer *w, enum eco_frame_type type, uint32_t number);
void eco_frame_end(struct eco_writer *w, struct eco_frame_mark mark);

void eco_wire_write_scene(struct eco_writer *w, const struct eco_scene *scene, const struct eco_chunk_id *pack_id);
void eco_wire_write_plant(struct eco_writer *w, const struct eco_scene *scene, uint32_t plant);
void eco_wire_write_list(struct eco_writer *w, const struct eco_scene *scene, uint32_t list);
/* Only the fields before the payload; the caller appends the payload. */
void eco_wire_write_chunk(struct eco_writer *w, const struct eco_scene *scene, uint32_t list, uint32_t ordinal);
void eco_wire_write_plan(struct eco_writer *w, const struct eco_plan *plan);
void eco_wire_write_end(struct eco_writer *w, uint64_t vertices, uint64_t body_bytes);

/* Reading: an incremental parser. Feed bytes as they arrive; it calls back once per whole, checked frame, in order, with every
 * field bounded. The first error is final. Nothing is allocated beyond the current frame. */
struct eco_wire_events {
	enum eco_code (*scene)(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *pack_id, struct eco_error *e);
	enum eco_code (*plant)(void *ctx, uint32_t id, const struct eco_plant *plant, const struct eco_anchor *anchors,
		struct eco_error *e);
	enum eco_code (*list)(void *ctx, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3], struct eco_error *e);
	/* the payload's hash has been checked against chunk->id */
	enum eco_code (*chunk)(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk, const uint8_t *payload,
		struct eco_error *e);
	enum eco_code (*plan)(void *ctx, struct eco_plan *plan, struct eco_error *e);   /* takes the plan's arrays */
	enum eco_code (*end)(void *ctx, uint64_t vertices, struct eco_error *e);
};
struct eco_wire_parser;
enum eco_code eco_wire_parser_new(struct eco_wire_parser **parser, const struct eco_wire_events *events, void *ctx,
	struct eco_error *error);
enum eco_code eco_wire_feed(struct eco_wire_parser *parser, const uint8_t *bytes, size_t size, struct eco_error *error);
/* ECO_DAMAGED if END has not been seen or bytes follow it. */
enum eco_code eco_wire_finish(struct eco_wire_parser *parser, struct eco_error *error);
void eco_wire_parser_free(struct eco_wire_parser *parser);

enum eco_code eco_wire_read_plan(struct eco_reader *r, struct eco_plan *plan, struct eco_error *error);
void eco_wire_write_holdings(struct eco_writer *w, const struct eco_holdings *holdings);
enum eco_code eco_wire_read_holdings(const uint8_t *bytes, size_t size, struct eco_holdings *holdings, struct eco_error *error);

#endif
