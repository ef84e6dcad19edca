/* Chunks that a client of a load test holds: decoded in a store, or only counted. Either way it takes the same
 * streams, and checks what it can: chunks in order, none twice, no more vertices than allowed.
 *
 *   view_holder_new(&holder, &options, &error);
 *   view_holder_begin(holder, &parser, &error);      a request: feed its answer to the parser
 *   view_holder_vertices(holder, &view, &vertices, &error);         after a whole answer
 *   view_holder_free(holder); */
#ifndef VIEW_HOLDER_H
#define VIEW_HOLDER_H

#include "client-min/view_store.h"

struct view_holder;
struct view_holder_options {
	bool decodes;
	view_store_find *find;           /* payloads of chunks that are named; NULL: none are */
	void (*planned)(void *ctx, double predicted_q);  /* as in struct view_store_options */
	void *ctx;                       /* of both */
};
enum eco_code view_holder_new(struct view_holder **holder, const struct view_holder_options *options,
	struct eco_error *error);
void view_holder_free(struct view_holder *holder);               /* NULL is fine */
enum eco_code view_holder_begin(struct view_holder *holder, struct eco_wire_parser **parser,
	struct eco_error *error);
/* Holds nothing from then on. */
enum eco_code view_holder_forget(struct view_holder *holder, struct eco_error *error);

/* What to tell the server; sorted by list; the caller frees items. */
enum eco_code view_holder_holdings(const struct view_holder *holder, struct eco_holdings *holdings,
	struct eco_error *error);
const struct eco_chunk_id *view_holder_pack(const struct view_holder *holder);   /* NULL: of none yet */

struct view_holder_counts { uint64_t chunks, chunks_twice, decoded; };
struct view_holder_counts view_holder_counts(const struct view_holder *holder);
/* Vertices of the last plan; where chunks are decoded, counted anew from what would be drawn, which may find damage. */
enum eco_code view_holder_vertices(const struct view_holder *holder, const struct eco_view *view,
	uint64_t *vertices, struct eco_error *error);

#endif
