/* Answers: a status and a response object of the HTTP library. Each function fills *answer; without memory
 * even for that, answer->response is NULL and the connection is to be dropped. */
#ifndef SRV_ANSWER_H
#define SRV_ANSWER_H

#include "server/request/condition.h"
#include "server/plan_cache.h"
#include "server/request/json.h"
#include "server/site.h"
#include "server/stream.h"

#define SRV_ETAG_BYTES 35                /* 32 hex digits, two quotes, 0 */

struct srv_answer {
	struct MHD_Response *response;
	unsigned status;
	uint64_t size_bytes;             /* of the body that a GET gets */
	uint64_t memory_bytes;           /* that it takes until it is sent; 0: next to none of its own */
};

/* `allow`: value of an Allow header or NULL; `close`: the connection cannot be used again. */
struct srv_problem_details { enum srv_problem problem; const char *detail, *instance, *allow; bool close; };
void srv_answer_problem(struct srv_answer *answer, const struct srv_problem_details *details);

/* Validators of an answer's state. `etag` with quotes; "": none, and the answer is not to be stored.
 * `modified_s`: since 1970, 0: not known. */
struct srv_validators {
	char etag[SRV_ETAG_BYTES];
	int64_t modified_s;
	bool is_private;                 /* no cache that others share may keep it */
};

/* Takes json->out. */
void srv_answer_json(struct srv_answer *answer, struct srv_json *json, const struct srv_validators *validators);

/* Takes *body. `timing`: a Server-Timing value or NULL. */
void srv_answer_body(struct srv_answer *answer, struct srv_body *body, const char *type,
	const struct srv_validators *validators, const char *timing);
/* From a body that is held; holds it, too. */
void srv_answer_kept(struct srv_answer *answer, struct srv_kept_body *body, const char *type,
	const struct srv_validators *validators, const char *timing);
/* srv_kept_body_make of pieces with `size` bytes together. */
struct srv_kept_body *srv_kept_body_copy(const struct srv_piece *pieces, uint32_t count, uint64_t size);
void srv_answer_no_stream(struct srv_answer *answer, const char *timing);        /* 204 */

/* An answer without its body: 304, or a 200 or 204 to HEAD. `size_bytes` of the body that GET
 * gets; SRV_SIZE_UNKNOWN closes the connection. `type`: the body's. */
#define SRV_SIZE_UNKNOWN UINT64_MAX
void srv_answer_head(struct srv_answer *answer, unsigned status, uint64_t size_bytes, const char *type,
	const struct srv_validators *validators);

/* Lets the request's preconditions count for an answer that has been made: it stays, or is 304 or 412
 * instead. */
void srv_answer_judge(struct srv_answer *answer, const struct srv_conditions *conditions,
	const struct srv_validators *validators, const char *instance);
void srv_answer_failed_condition(struct srv_answer *answer, const char *instance);

/* The chunk, a part of it (to GET alone), 304, 416, or the problem that its payload is damaged. The scene
 * outlives the answer. */
struct srv_chunk_terms { bool get, is_private; };
void srv_answer_chunk(struct srv_answer *answer, const struct srv_scene *scene, uint32_t chunk,
	const struct srv_conditions *conditions, struct srv_chunk_terms terms, const char *instance);

/* A file of the viewer in one of its forms. The site outlives the answer. `immutable`: its address names its
 * content. `frames`: the origins beside its own whose pages may have it in a frame, each behind a space. */
void srv_answer_file(struct srv_answer *answer, const struct srv_site_file *file, enum srv_form form,
	bool immutable, const char *frames, const struct srv_validators *validators);
/* A page that says that there is none (404). */
void srv_answer_no_page(struct srv_answer *answer, const char *html);
/* A temporary redirect. */
void srv_answer_elsewhere(struct srv_answer *answer, const char *location);

/* The daemon's numbers; takes *text. */
void srv_answer_metrics(struct srv_answer *answer, struct eco_writer *text);
/* To OPTIONS: what the resource takes. */
void srv_answer_options(struct srv_answer *answer, const char *allow);
/* Adds Access-Control-Allow-Origin; origin NULL: none. `varies`: the value depends on the request. */
void srv_answer_allow_origin(struct srv_answer *answer, const char *origin, bool varies);
void srv_answer_add(struct srv_answer *answer, const char *name, const char *value);

/* Lets go of an answer that was queued (the library holds its own reference) or is not wanted. */
void srv_answer_free(struct srv_answer *answer);

void srv_etag_of(char etag[SRV_ETAG_BYTES], const struct eco_chunk_id *id);
/* A validator for what a server of this version, with these limits of work, vertices and bytes, answers to
 * `target` from this pack: the same request gives the same bytes. */
void srv_etag_request(char etag[SRV_ETAG_BYTES], const struct srv_scene *scene, const uint64_t limits[3],
	const char *target);

#endif
