/* Random plans and streams that are valid: for tests of the wire and as seeds of its fuzz target. The same
 * seed gives the same bytes. */
#pragma once

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/wire.h"

struct wire_random { uint64_t state; };

uint32_t wire_random_below(struct wire_random *r, uint32_t n);
/* Small numbers are more likely than large ones: every length of a varint occurs. */
uint32_t wire_random_size(struct wire_random *r, uint32_t most);
void assert_same_plan(const struct eco_plan *a, const struct eco_plan *b);
/* A sorted plan of up to `most` items an array that names lists below `lists` and plants below `plants`. */
struct eco_plan wire_random_plan(struct wire_random *r, uint32_t most, uint32_t lists, uint32_t plants);

/* ---- A stream: `steps` steps of a scene of 2 plants and 6 lists ---- */

#define WIRE_RANDOM_LISTS 6u
#define WIRE_RANDOM_PLANTS 2u

/* State of the stream that is being written; a SCENE begins one. */
extern struct eco_wire_items wire_items;
/* The next bundle of it, between its items and its payloads. */
struct eco_frame_mark wire_bundle_begin(struct eco_writer *w, uint32_t *number,
	struct eco_wire_bundle *bundle);
void wire_bundle_end(struct eco_writer *w, struct eco_frame_mark mark, struct eco_wire_bundle *bundle,
	const void *payload, size_t size);
void wire_put_scene(struct eco_writer *w, uint32_t *number, uint32_t version);
void wire_put_plant(struct eco_writer *w, uint32_t *number, uint32_t plant, const struct eco_anchor *anchors,
	uint32_t anchor_count);
struct eco_list wire_random_list(uint32_t id);
void wire_put_chunk(struct eco_writer *w, uint32_t *number, uint32_t list, uint32_t ordinal,
	const void *payload, size_t size, bool whole);
/* A chunk that is named, not carried. */
void wire_put_name(struct eco_writer *w, uint32_t *number, uint32_t list, uint32_t ordinal,
	const void *payload, size_t size);
void wire_put_plan(struct eco_writer *w, uint32_t *number, const struct eco_plan *plan);
void wire_put_end(struct eco_writer *w, uint32_t *number, uint64_t vertices, int64_t bytes_off);
void wire_random_stream(struct wire_random *r, struct eco_writer *w, uint32_t steps);

/* ---- Events that a parser told, as bytes, so that two tellings can be compared ---- */

/* The event of number `fail_at` fails. `hosted`: the host's bytes for any chunk; NULL: it is passed over. */
struct wire_told { struct eco_writer w; uint32_t events, fail_at; const char *hosted; };

extern const struct eco_wire_events wire_telling;

/* Feeds in portions of `portion` bytes; 0: of random sizes. */
enum eco_code wire_tell(const uint8_t *bytes, size_t size, size_t portion, struct wire_told *told,
	struct eco_error *error);
