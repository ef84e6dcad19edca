/* The answer to a view: which steps, which frames, exactly how many bytes, and then the bytes.
 *
 *   srv_stream_plan(&stream, &input, &error);       plans, steps and the exact size of the body
 *   if (stream.fits) srv_stream_write(&stream, &body, &error);
 *   ... body.pieces, in order ...                   payloads are pieces that point into the mapped pack
 *   srv_body_free(&body); srv_stream_free(&stream);
 *
 * Steps. The last step is the plan for the whole budget. Coarser answers go before it, each with about three
 * quarters of the bytes of the next, down to 10 kB (lod/plan/planner.h), in a 128th of the bytes that is left to them; those
 * that send most of what the answer does not use give way first. So a client that stops reading has
 * about the best picture for its bytes. Their ground takes at most a quarter of their bytes, and goes first,
 * coarse to fine.
 *
 * First picture. Bytes leave no room for what coarser answers send and the answer does not use. So a client
 * that holds nothing gets a picture within SRV_FIRST_BYTES, one window of TCP, and the answer is planned for
 * one that holds this picture's chunks.
 *
 * Byte budget. It bounds the whole body, END included. The planner spends it, ground included, and knows what
 * a body takes (ecofiles/format/wire_body.h). If not even a plan that draws nothing on the coarsest ground
 * fits, `fits` is false: 204. Bytes that are left go to chunks that the answer would need without the budget,
 * of those lists first that lack least, if it draws anything.
 *
 * Next view. Chunks that its plan lacks follow the answer within the same bytes.
 *
 * Named chunks. Chunks of at least so many bytes are named by id and size, not carried, if the request says
 * so. The client fetches them from .../chunks/{id} or from any host that has them, as a cache. Budgets
 * count their bytes as if they were carried.
 *
 * The same input gives the same bytes: no clock, no history, nothing shared. */
#pragma once

#include <stdatomic.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/plan.h"
#include "lod/plan/explain.h"
#include "lod/plan/planner.h"
#include "server/store.h"

#define SRV_STEPS_MAX 32u
#define SRV_FIRST_BYTES 14000u

struct srv_stream_input {
	const struct srv_scene *scene;
	const struct eco_request *request;           /* has passed eco_view_check */
	const struct eco_holdings *holdings;         /* has passed srv_holdings_check; may be NULL */
	uint64_t body_max;                           /* bytes; beyond it ECO_TOO_LARGE; 0: 2 GiB */
	lod_rule *rule;                              /* NULL: the optimiser */
	bool ignore_occlusion;                       /* as struct lod_planner_input */
	uint64_t work_max, level_work;               /* of all its plans, as struct lod_planner_input */
	bool explain;                                /* the answer says why it is as it is */
	bool single;                                 /* one step, without coarser answers before it */
	uint8_t *places;                             /* as struct lod_planner_input */
	/* looked at while it is planned and written: ECO_INTERRUPTED; may be NULL */
	const atomic_bool *cancelled;
};

struct srv_step {
	struct eco_plan plan;
	struct eco_holdings needs;                   /* chunks per list that the plan needs, sorted */
	struct lod_explanation why;                  /* of the last one, where it is asked for */
	uint64_t missing_bytes;                      /* payloads that the client lacks at the beginning */
	uint64_t end_bytes;                          /* of the body, up to and with this step's PLAN */
};

struct srv_stream {
	struct srv_stream_input input;
	struct srv_step steps[SRV_STEPS_MAX];        /* ascending; the last is the answer */
	uint32_t step_count;
	/* the same of the next view's plan, with what was left of the bytes; of its coarser answers first */
	struct eco_holdings next[SRV_STEPS_MAX];     uint32_t next_count;
	/* what the answer would need without a budget of bytes; of that, what the rest of the bytes holds */
	struct eco_holdings wanted, rest;
	/* from fine to coarse, while steps are made */
	struct eco_plan coarser[SRV_STEPS_MAX];      uint32_t coarser_count;
	bool fits;
	/* exact, named chunks counted; where it does not fit, that of the smallest body */
	uint64_t body_bytes, next_bytes;             /* next_bytes: of these, for the next view */
	uint64_t chunk_count, chunk_bytes;           /* payloads in the body, or named by it: ... */
	uint64_t named_bytes;                        /* ... so many of these bytes */
	uint64_t work;                               /* of all plans, as struct lod_planner_stats */
	bool cut_short;                              /* one of them might be better with more work */
};

struct srv_piece { const void *bytes; size_t size; };
struct srv_body {
	struct srv_piece *pieces;
	uint32_t piece_count;
	uint64_t size_bytes;
	struct eco_writer frames;                    /* owns everything but the payloads */
};

enum eco_code srv_stream_plan(struct srv_stream *stream, const struct srv_stream_input *input,
	struct eco_error *error);

/* body->size_bytes == stream->body_bytes - stream->named_bytes. ECO_DAMAGED if a payload is. */
enum eco_code srv_stream_write(const struct srv_stream *stream, struct srv_body *body,
	struct eco_error *error);
void srv_stream_free(struct srv_stream *stream);
void srv_body_free(struct srv_body *body);

/* Lists that exist, and no more chunks than they have. */
enum eco_code srv_holdings_check(const struct eco_scene *scene, const struct eco_holdings *holdings,
	struct eco_error *error);

/* ---- Between stream.c and stream_after.c ---- */

/* Plans a first picture and the answer behind it. No steps, and `stream` is as it was but for its work: they
 * do not fit together. */
enum eco_code srv_plan_first(struct srv_stream *stream, struct eco_error *error);
/* Plans the next view as an answer of its own to a client that holds all of this one; within its bytes. */
enum eco_code srv_plan_next(struct srv_stream *stream, struct eco_error *error);
void srv_stream_drop_next(struct srv_stream *stream);
/* Adds lists that the answer wanted and bytes did not allow, those that lack least first, as far as there is
 * room. An answer that draws nothing gets none. */
enum eco_code srv_send_rest(struct srv_stream *stream, struct eco_error *error);
/* Sets bytes and chunks of the whole stream, and where its steps end, by a dry run. */
enum eco_code srv_size_all(struct srv_stream *stream, struct eco_error *error);
uint64_t srv_work_left(const struct srv_stream *stream);         /* of the answer's */

/* ---- The work of an ordinary request ---- */

/* The counted work of an ordinary request to a scene, which bounds that of any request: the median of a few
 * fixed requests, with eyes and targets anywhere in and around the scene, and pictures and budgets of any
 * size. It depends on the pack alone; a multiple of it cuts all servers' plans at the same place. */

/* Work of the median request (struct lod_planner_stats), found at the first call, which takes about
 * SRV_TYPICAL_REQUESTS ordinary plans. Random requests to a wide scene mostly see little of it, and those
 * that see all need more than a few times that (lod/EXPERIMENTS.md, Wide scenes from the air). Therefore it
 * is at least a look at each plant, from SRV_TYPICAL_WORK_LEAST (.5 milliseconds) to SRV_TYPICAL_WORK_WIDE.
 * Any thread. */
#define SRV_TYPICAL_REQUESTS 63u
#define SRV_TYPICAL_WORK_LEAST 72000u
#define SRV_TYPICAL_WORK_WIDE 720000u
/* 0: *cancelled (may be NULL) was set meanwhile, and it was not found. */
uint64_t srv_typical_find(struct srv_scene *scene, const atomic_bool *cancelled);
/* Finds that of all scenes of a store. */
bool srv_typical_find_all(const struct srv_store *store, const atomic_bool *cancelled);
