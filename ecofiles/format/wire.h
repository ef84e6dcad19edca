/* The stream: how a plan and the chunks it needs travel. One response body is a sequence of frames; any
 * prefix that ends after a PLAN frame is a valid picture within the vertex budget.
 *
 *   SCENE                                     once
 *   step: BUNDLE* PLAN                        one or more, coarse first; only what the client lacks
 *   AHEAD BUNDLE*                             for the next view, where one was given and lacks something
 *   END                                       missing END = truncated
 *
 * Frame (little-endian):
 *   0   u8  type      1  u8[3] 0      4  u32 payload length n
 *   8   u64 XXH3-64 of bytes [0,8), of the frame's number in the stream (u32, from 0) and of the payload
 *   16  n bytes
 *
 * SCENE  u32 version = ECO_WIRE_VERSION, u8[16] pack id, f64 near_m, u32 needs, u32 ground columns, rows,
 *        margin (3), u32 plant count, u32 list count, str name
 * BUNDLE v size of the directory, u8 zeros that were left off at its end, the directory, then payloads
 *        in the order of its chunks. The directory names plants, lists and chunks (wire_items.h): a plant
 *        before the first list of it, a list before its first chunk; ordinals of chunks ascend per list.
 *        A chunk's id is the hash of its payload; one that is named has its id and no payload here, and the
 *        client fetches it, if its request said so (name_from)
 * PLAN   below; replaces the plan before it. Each `list` in it is held up to its `end`
 * AHEAD  nothing: the last PLAN has come, and who has turned elsewhere may hang up
 * END    u64 vertices of the last plan, u64 bytes of the body, END included
 *
 * v: varint, z: zigzag varint.
 *
 * str: varint length (at most 63), UTF-8 without NUL. Holdings (body of a POST): u32 count, then per list,
 * ascending: varint list delta (from the list before; the first from 0), varint chunks (at least 1). A
 * client that holds a chunk of a list knows its record; one that holds a chunk of any list of a plant
 * (not of its instances) knows the plant, and the anchors of its cells if the list is of a cell.
 *
 * PLAN. Varints, and f64 where so said. A plan has one encoding: arrays are in the order of eco_plan_sort, a
 * field that is said differs from what is expected of it. Everything else is refused. Figures that only a server
 * reports (visible plants, the sample distance) do not travel. A usual cut takes 3 to 6 bytes, a plant none.
 *
 *   v vertices   pixels in sixteenths: v tp, v fp, v fn   v m16 in thousandths
 *   v counts: placements, runs, gates, cuts; then these
 *   placement    v fields: 1, 2, 4: the axis is no whole millimetre; 8, 16: turn, path are not 0; 32: scale is
 *                not 1 but an f32; 64: but an f64. 3 axes: f64, or z millimetres less the axis's last whole ones.
 *                v turn, v path, scale: v bits of the f32, or f64; if they are there
 *   run          v placement - before's (first: -1). A row: list_first (expected: before's list_end; of another
 *                placement: list_first of the first run of the placement before), list_end - list_first, left
 *   gate         v plant - before's, z end - before's
 *   cut          a row, expected as the cut before (first: drawn once, list 0, [0,1), scale 1), but
 *     of another list or anchor: as the first cut of those before
 *     behind [first, L), L the lowest power of 4 above first > 0: these splats' children, [L, 4 first)
 *     else: the rest of the share in these bands, or all of as many bands behind them; [first, L) if first > 0
 *     Fields: list, anchor, end (less L), first, band_first, share_end, share_first, scale (its bits with the
 *     low 17 in front), bands, placement, halvings. A cut drawn once has bands [0, ECO_BANDS) and all of the
 *     share; another one has placement 0
 *   row          v which fields differ from what is expected, the first one lowest; of each: z by how much,
 *                modulo 2^32 */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/plan.h"
#include "ecofiles/format/wire_items.h"

enum eco_frame_type { ECO_FRAME_SCENE = 1, ECO_FRAME_BUNDLE, ECO_FRAME_PLAN, ECO_FRAME_END, ECO_FRAME_AHEAD };
#define ECO_WIRE_VERSION 28u
#define ECO_FRAME_HEADER_BYTES 16u
#define ECO_FRAME_PAYLOAD_MAX (1u << 27)
#define ECO_END_FRAME_BYTES (ECO_FRAME_HEADER_BYTES + 16u)

/* Lower-case name of a frame type, or NULL; and the payload lengths that a frame of that type may have,
 * both inclusive. */
const char *eco_frame_name(uint32_t type);
void eco_frame_limits(enum eco_frame_type type, uint32_t *least, uint32_t *most);
uint64_t eco_frame_hash(const uint8_t header[8], uint32_t number, const uint8_t *payload, size_t size);

/* Writing: frames are appended to a writer. Begin, write the payload's fields, end (patches length and
 * hash). A payload outside its type's limits sets w->failed. */
struct eco_frame_mark { size_t at; uint32_t number; };
struct eco_frame_mark eco_frame_begin(struct eco_writer *w, enum eco_frame_type type, uint32_t number);
void eco_frame_end(struct eco_writer *w, struct eco_frame_mark mark);

void eco_wire_write_scene(struct eco_writer *w, const struct eco_scene *scene,
	const struct eco_chunk_id *pack_id);

/* A bundle that is being written; `items` are the stream's. It must not move between begin and end. */
struct eco_wire_bundle {
	struct eco_wire_items *items;
	struct eco_writer directory;
	struct eco_range range;
};
void eco_wire_bundle_begin(struct eco_wire_bundle *bundle, struct eco_wire_items *items);
void eco_wire_bundle_plant(struct eco_wire_bundle *bundle, const struct eco_scene *scene, uint32_t plant,
	bool cells);
void eco_wire_bundle_list(struct eco_wire_bundle *bundle, const struct eco_scene *scene, uint32_t list);
void eco_wire_bundle_chunk(struct eco_wire_bundle *bundle, const struct eco_scene *scene, uint32_t list,
	uint32_t ordinal, bool named);
/* Appends all but the payloads; w->failed where memory failed. The directory's memory serves the next. */
void eco_wire_bundle_end(struct eco_wire_bundle *bundle, struct eco_writer *w);
void eco_wire_bundle_free(struct eco_wire_bundle *bundle);
/* Writes a plan given in any order; reading gives it in the order of eco_plan_sort. Sets w->failed if
 * eco_plan_check refuses the plan. */
void eco_wire_write_plan(struct eco_writer *w, const struct eco_plan *plan);
/* Bytes of that payload: what a view costs a client that holds every chunk. */
uint64_t eco_wire_plan_bytes(const struct eco_plan *plan);
void eco_wire_write_end(struct eco_writer *w, uint64_t vertices, uint64_t body_bytes);

/* The nearest scale with 6 bits behind the leading one: a relative error of at most 1/128, which is 1/256 of
 * a length; other scales travel exactly. Pixels in sixteenths, from 0 to 1e14, and m16 in thousandths, from 0
 * to 1000: no plan with others is written. All take few bits; a planner rounds them, so that client and
 * planner use the same. */
float eco_wire_scale_round(float scale);
double eco_wire_pixels_round(double pixels);
double eco_wire_m16_round(double m16);

/* Reading: an incremental parser. Feed bytes as they arrive; it calls back once per whole frame, in order,
 * with every field bounded and checked as far as one stream can tell. The receiver checks what depends on
 * earlier streams (a chunk sent twice, a cut beyond the chunks held). The first error is final, also one from
 * a callback. Memory grows with the bytes that came, not with the length in a header. A NULL callback ignores
 * its frames. Pointers are valid during the call. */
struct eco_wire_events {
	/* set: name, needs, ground_columns, _rows and _margin, near_m, counts of plants and lists; root is
	 * ECO_NONE; no arrays */
	enum eco_code (*scene)(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *pack_id,
		struct eco_error *e);
	/* set: name, height, anchor range; the rest is 0. `anchors`: the first, or all: those of cells come with
	 * the first list of a cell, and the plant once more */
	enum eco_code (*plant)(void *ctx, uint32_t id, const struct eco_plant *plant,
		const struct eco_anchor *anchors, uint32_t anchor_count, struct eco_error *e);
	/* groups: list->group_count, their place_first is 0; together they are the list */
	enum eco_code (*list)(void *ctx, uint32_t id, const struct eco_list *list,
		const uint8_t (*palette)[3], const struct eco_group *groups, struct eco_error *e);
	/* set: id, size and counts; offset is 0; the payload's hash has been checked against chunk->id */
	enum eco_code (*chunk)(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
		const uint8_t *payload, struct eco_error *e);
	/* owns the plan's arrays from here on, even if it fails */
	enum eco_code (*plan)(void *ctx, struct eco_plan *plan, struct eco_error *e);
	enum eco_code (*end)(void *ctx, uint64_t vertices, struct eco_error *e);
	/* finds the payload of a chunk that is only named: chunk->size_bytes, which are then checked against
	 * chunk->id; valid until the next call. *payload stays NULL: the chunk is passed over. This callback
	 * NULL: a chunk that is named is an error */
	enum eco_code (*fetch)(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
		struct eco_error *e);
	enum eco_code (*ahead)(void *ctx, struct eco_error *e);
};
struct eco_wire_parser;
enum eco_code eco_wire_parser_new(struct eco_wire_parser **parser, const struct eco_wire_events *events,
	void *ctx, struct eco_error *error);
/* Takes bytes in any portions, 0 included. An error names the frame's number, type and offset in the
 * stream. */
enum eco_code eco_wire_feed(struct eco_wire_parser *parser, const uint8_t *bytes, size_t size,
	struct eco_error *error);
/* ECO_DAMAGED if END has not been seen or bytes follow it. */
enum eco_code eco_wire_finish(struct eco_wire_parser *parser, struct eco_error *error);
void eco_wire_parser_free(struct eco_wire_parser *parser);   /* NULL is fine */

/* Reads one plan, which is all that the reader still has. It passes eco_plan_check; *plan is empty on
 * failure. */
enum eco_code eco_wire_read_plan(struct eco_reader *r, struct eco_plan *plan, struct eco_error *error);

/* Holdings must be sorted as plan.h says. Reading accepts the one encoding and nothing after it, at most
 * ECO_HOLDINGS_MAX, with memory in proportion to `size`. The caller frees items; *holdings is empty on
 * failure. */
void eco_wire_write_holdings(struct eco_writer *w, const struct eco_holdings *holdings);
enum eco_code eco_wire_read_holdings(const uint8_t *bytes, size_t size, struct eco_holdings *holdings,
	struct eco_error *error);
