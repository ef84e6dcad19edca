/* Answers: a status and a response object of the HTTP library, made from what the rest of the server found
 * out.
 *
 * Each function fills *answer; where even that fails for want of memory, answer->response is NULL and the
 * connection is to be dropped. A chunk's whole response is made once, shared by all connections and kept
 * (srv_answer_drop_shared): the library counts references, the payload is the mapped file. */
#ifndef SRV_ANSWER_H
#define SRV_ANSWER_H

#include "server/condition.h"
#include "server/problem.h"
#include "server/stream.h"

#define SRV_ETAG_BYTES 35                /* 32 hex digits, two quotes, 0 */

struct srv_answer {
	struct MHD_Response *response;
	unsigned status;
	uint64_t size_bytes;             /* of the body that a GET gets */
	bool shared;                     /* the response is not ours to destroy */
};

/* `allow`: value of an Allow header or NULL; `close`: the connection cannot be used again. */
struct srv_problem_details { enum srv_problem problem; const char *detail, *instance, *allow; bool close; };
void srv_answer_problem(struct srv_answer *answer, const struct srv_problem_details *details);

/* Takes json->out. `etag` with quotes; NULL: no ETag and not to be stored. `timing`: a Server-Timing value or
 * NULL. If the ETag is in `if_none_match` the answer is 304. */
void srv_answer_json(struct srv_answer *answer, struct srv_json *json, const char *etag,
	const char *if_none_match, const char *timing);

/* Takes *body; the rest as srv_answer_json. */
void srv_answer_stream(struct srv_answer *answer, struct srv_body *body, const char *etag,
	const char *if_none_match, const char *timing);
void srv_answer_no_stream(struct srv_answer *answer, const char *timing);        /* 204 */

/* The chunk, a part of it, 304, 416, or the problem that its payload is damaged. Range counts for GET only.
 */
void srv_answer_chunk(struct srv_answer *answer, struct srv_scene *scene, uint32_t chunk,
	const struct srv_conditions *conditions, bool get, const char *instance);

/* Lets go of an answer that was queued (the library holds its own reference) or is not wanted. */
void srv_answer_free(struct srv_answer *answer);
void srv_answer_drop_shared(struct srv_store *store);

void srv_etag_of(char etag[SRV_ETAG_BYTES], const struct eco_chunk_id *id);
/* A validator for what a server of this version answers to `target` from this pack: the same request gives
 * the same bytes. */
void srv_etag_request(char etag[SRV_ETAG_BYTES], const struct srv_scene *scene, const char *target);

#endif
