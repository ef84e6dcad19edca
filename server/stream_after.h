/* Additions to an answer's stream: chunks that the next view lacks, and more lists for bytes that are left. Both
 * size the stream anew with a dry run of its frames. */
#ifndef SRV_STREAM_AFTER_H
#define SRV_STREAM_AFTER_H

#include "server/emit.h"
#include "server/stream.h"

/* Plans the next view as an answer of its own to a client that holds all of this one; within its bytes. */
enum eco_code srv_plan_next(struct srv_stream *stream, struct srv_emit *dry, struct eco_error *error);
void srv_stream_drop_next(struct srv_stream *stream);

/* Adds lists that the answer wanted and bytes did not allow, those that lack least first, as far as there is
 * room. An answer that draws nothing gets none. */
enum eco_code srv_send_rest(struct srv_stream *stream, struct srv_emit *dry, struct eco_error *error);

/* ---- In stream.c ---- */

/* Sets bytes and chunks of the whole stream, and where its steps end. */
enum eco_code srv_size_all(struct srv_stream *stream, struct srv_emit *dry, struct eco_error *error);
/* Bytes of the chunks that `needs` has and `holdings` (may be NULL) has not. */
uint64_t srv_missing_bytes(const struct eco_scene *scene, const struct eco_holdings *holdings,
	const struct eco_holdings *needs);
/* The rest of the answer's work. */
uint64_t srv_work_left(const struct srv_stream *stream);

#endif
