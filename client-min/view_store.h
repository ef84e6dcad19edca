/* What the client holds of a scene: lists decoded chunk by chunk as a stream arrives, plants, and the plan to
 * draw.
 *
 *   view_store_new(&store, &options, &error);       once per scene
 *   view_store_begin(store);                        per frame: forget the old plan, keep everything else
 *   view_fetch_stream(fetch, store, ...);           the wire parser calls view_store_events with ctx = store
 *   view_select_make(&selection, store, &eye, ...); which instances each cut draws
 *   ... draw ...
 *   view_store_free(store);
 *
 * Everything a stream says is checked against what is already held: a chunk sent twice, a chunk out of order,
 * a count that does not fit (its own list's, or that of the list it is a form of) or a colour outside the
 * palette is ECO_DAMAGED. One thread at a time. */
#ifndef VIEW_STORE_H
#define VIEW_STORE_H

#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/model.h"
#include "ecofiles/format/wire.h"
#include "lod/impostor.h"

/* Chunks end here; geometry of a chunk can be made without walking the list. All exclusive, running totals.
 */
struct view_mark { uint32_t primitives, elements, corners; };

struct view_list {                       /* owned by the store; address is stable until the store is freed */
	uint32_t id;
	struct eco_list list;            /* as the stream described it */
	uint8_t (*palette)[3];           /* list.palette_count colours, sRGB */
	uint32_t next_form;              /* index of another form of the same list, or UINT32_MAX */
	uint32_t chunk_count;            /* chunks held: a prefix */
	struct view_mark *marks;         /* one per chunk held */
	struct eco_elements elements;    /* of all chunks held, in draw order */
	uint32_t element_room, corner_room;      /* what the arrays have space for */
	struct eco_image image;          /* lists of kind IMAGE, once their chunk is here */
	bool cutout;                     /* the image has texels with alpha < 0.5 */
	struct lod_impostor *impostors;  /* lists of kind IMPOSTOR: one for each chunk held */
	/* lists of kind GROUND, once their chunk is here: level, column and row */
	struct eco_ground_tile tile;
};

struct view_plant {
	struct eco_plant plant;
	struct eco_anchor *anchors;      /* plant.anchor_count */
};

struct view_store_stats {
	uint64_t memory_bytes;           /* decoded data held */
	uint64_t chunks, chunk_bytes;    /* decoded since the store was made */
	uint64_t chunks_twice;           /* chunks that were already held: each is a fault of the server */
	double decode_ms;                /* since view_store_begin */
};

struct view_store;

struct view_store_options {
	/* of decoded data; 0: 8 GiB. Beyond it a stream fails with ECO_TOO_LARGE */
	uint64_t memory_max;
	/* decode IMAGE lists (loads the image module); false: the payload is dropped */
	bool images;
};
enum eco_code view_store_new(struct view_store **store, const struct view_store_options *options,
	struct eco_error *error);
void view_store_free(struct view_store *store);                  /* NULL is fine */

extern const struct eco_wire_events view_store_events;           /* ctx is the store */

void view_store_begin(struct view_store *store);
/* The last plan of the stream, or NULL (none came: nothing is drawn). */
const struct eco_plan *view_store_plan(const struct view_store *store);
/* Tiles that it shows as points; 0: plants are drawn one by one. More plants may be in view than a plan looks
 * at, whatever the budget. */
uint32_t view_store_summaries(const struct view_store *store);
/* True once END has come; its count of vertices equals the plan's. */
bool view_store_complete(const struct view_store *store);
double view_store_near_m(const struct view_store *store);        /* 0 before the first SCENE */
const char *view_store_scene_name(const struct view_store *store);

/* NULL if not held */
const struct view_list *view_store_list(const struct view_store *store, uint32_t id);
const struct view_plant *view_store_plant(const struct view_store *store, uint32_t id);
/* Samples of the ground at full detail; 0 if the scene has none. */
void view_store_ground(const struct view_store *store, uint32_t *columns, uint32_t *rows);
uint32_t view_store_list_count(const struct view_store *store);
/* in order of arrival */
const struct view_list *view_store_list_at(const struct view_store *store, uint32_t index);

/* What to tell the server. Sorted by list; the caller frees items. */
enum eco_code view_store_holdings(const struct view_store *store, struct eco_holdings *holdings,
	struct eco_error *error);
const struct view_store_stats *view_store_stats(const struct view_store *store);

/* Elements of chunks [first, end) as a view into the list's arrays: nothing is copied, nothing to free. */
struct eco_elements view_list_chunks(const struct view_list *list, uint32_t first, uint32_t end);

/* Monotonic milliseconds; only for measuring. */
double view_clock_ms(void);

#endif
