/* A client's part of a scene: lists decoded chunk by chunk as a stream arrives, plants, and the plan to
 * draw.
 *
 *   view_store_new(&store, &options, &error);       once per scene
 *   view_store_begin(store);                        per frame: forget the old plan, keep everything else
 *   do                                              view_fetch_stream does all this
 *           ask for the view with view_store_holdings, and feed view_store_events with ctx = store
 *   while (view_store_again(store, &vertices));     its plan needs what had to go while it came
 *   view_select_make(&selection, store, &eye, ...); which instances each cut draws
 *   ... draw ...
 *   view_store_free(store);
 *
 * Everything a stream says is checked against what is already held: a chunk sent twice, a chunk out of order,
 * a count that does not fit its list's or a colour outside the palette is ECO_DAMAGED. One thread
 * at a time. */
#pragma once

#include "client-min/view_list.h"
#include "ecofiles/format/wire.h"

struct view_plant {
	struct eco_plant plant;
	struct eco_anchor *anchors;      /* anchor_count: 1 until cells are described, then plant.anchor_count */
	uint32_t anchor_count;
};

struct view_store_stats {
	uint64_t memory_bytes, memory_peak_bytes;        /* decoded data held, and its maximum; at most memory_max */
	uint64_t chunks, chunk_bytes;                    /* decoded since the store was made */
	uint64_t chunks_twice;                           /* that were already held: each is a fault of the server */
	uint64_t evictions, evicted_bytes;               /* chunks that went for want of memory, decoded */
	uint64_t chunks_again, again_bytes;              /* of `chunks`: those that had come before, and gone */
	double decode_ms;                                /* since view_store_begin */
};

struct view_store;

struct view_store_options {
	/* of decoded data; 0: 8 GiB. Beyond it chunks go (view_cache.h). A stream whose view alone needs more
	 * fails with ECO_TOO_LARGE, and says how much. Scratch of decoding, tables and copies on the GPU do
	 * not count */
	uint64_t memory_max;
	/* decode textures and their outlines; false: their payloads are dropped */
	bool images;
	/* decode nothing: count chunks, and check that none comes twice or out of order. A plan then has
	 * only its vertices and its prediction */
	bool counts;
	/* told of each plan that has come, and what it predicts (eco_predicted_q); may be NULL */
	void (*planned)(void *ctx, double predicted_q);
	void *ctx;
};
enum eco_code view_store_new(struct view_store **store, const struct view_store_options *options,
	struct eco_error *error);
void view_store_free(struct view_store *store);                  /* NULL is fine */

extern const struct eco_wire_events view_store_events;           /* ctx is the store */

/* Finds the payload of a chunk that a stream only names, as eco_wire_events.fetch. NULL: none can be. */
typedef enum eco_code view_store_find(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error);
void view_store_find_by(struct view_store *store, view_store_find *find, void *ctx);

void view_store_begin(struct view_store *store);
/* After a whole stream: true if its plan needs what has gone while it came. Then the same is to be asked
 * again, with the holdings of now, and what that plan needs stays; *vertices is its count, which a request
 * with a budget of bytes asks for in place of its own, as such plans depend on what is held. */
bool view_store_again(struct view_store *store, uint64_t *vertices);
/* After an answer that broke off: what came of it is held, and its last plan still is one to draw. The rest
 * is to be asked for with the holdings of now. */
void view_store_resume(struct view_store *store);
/* The last plan is all there is to come; false if there is none. */
bool view_store_settle(struct view_store *store);
/* The last plan has come, and what comes still is for the next view. */
bool view_store_ahead(const struct view_store *store);
/* The last plan of the stream, or NULL (none came, or it cannot be drawn: nothing is drawn). */
const struct eco_plan *view_store_plan(const struct view_store *store);
/* True once END has come, whose count of vertices equals the plan's, or the store has been settled. */
bool view_store_complete(const struct view_store *store);
/* The pack of its holdings, which the next request names; NULL before the first SCENE. */
const struct eco_chunk_id *view_store_pack(const struct view_store *store);
double view_store_near_m(const struct view_store *store);        /* 0.1 before the first SCENE */
const char *view_store_scene_name(const struct view_store *store);
/* enum eco_need; 0 before the first stream. */
uint32_t view_store_needs(const struct view_store *store);

/* NULL if not held. Lists stay where they are until the next view_store_begin. */
const struct view_list *view_store_list(const struct view_store *store, uint32_t id);
const struct view_plant *view_store_plant(const struct view_store *store, uint32_t id);
/* Samples of the ground at full detail; 0 if the scene has none. */
void view_store_ground(const struct view_store *store, uint32_t *columns, uint32_t *rows);
uint32_t view_store_list_count(const struct view_store *store);
/* in order of arrival, until a list has gone */
const struct view_list *view_store_list_at(const struct view_store *store, uint32_t index);

/* Holdings for the next request, sorted by list; the caller frees items. */
enum eco_code view_store_holdings(const struct view_store *store, struct eco_holdings *holdings,
	struct eco_error *error);
/* The same as the body of a request, behind what is in the writer. */
enum eco_code view_store_write_holdings(const struct view_store *store, struct eco_writer *body,
	struct eco_error *error);
struct view_store_stats view_store_stats(const struct view_store *store);

/* Monotonic milliseconds; only for measuring. */
double view_clock_ms(void);
