/* What a client of a load test holds: chunks of lists, counted but not decoded, or decoded in a store. It
 * takes the same streams either way, and checks what it can: chunks in order, none twice, no more vertices
 * than allowed.
 *
 *   view_holder_new(&holder, decodes, &error);
 *   view_holder_begin(holder, passed, ctx);          a request; `passed` is told of each plan that has come
 *   eco_wire_parser_new(&parser, &view_holder_events, holder, &error);   and feed it
 *   view_holder_check(holder, &request, &error);     after a whole answer
 *   view_holder_free(holder);
 * */
#ifndef VIEW_HOLDER_H
#define VIEW_HOLDER_H

#include "client-min/view_store.h"

struct view_holder;
typedef void view_holder_passed(void *ctx, double predicted_q);

enum eco_code view_holder_new(struct view_holder **holder, bool decodes, struct eco_error *error);
void view_holder_free(struct view_holder *holder);               /* NULL is fine */

extern const struct eco_wire_events view_holder_events;          /* ctx is the holder */

void view_holder_begin(struct view_holder *holder, view_holder_passed *passed, void *ctx);
/* Finds payloads of chunks that are named, as eco_wire_events.fetch. */
void view_holder_find_by(struct view_holder *holder, view_store_find *find, void *ctx);
/* Holds nothing from then on. */
enum eco_code view_holder_forget(struct view_holder *holder, struct eco_error *error);

/* What to tell the server; sorted by list; the caller frees items. */
enum eco_code view_holder_holdings(const struct view_holder *holder, struct eco_holdings *holdings,
	struct eco_error *error);
/* NULL: of none yet. */
const struct eco_chunk_id *view_holder_pack(const struct view_holder *holder);

struct view_holder_counts { uint64_t chunks, chunks_twice, decoded; };
struct view_holder_counts view_holder_counts(const struct view_holder *holder);
/* Of the last plan; where chunks are decoded, counted anew from what would be drawn, which may find damage.
 */
enum eco_code view_holder_vertices(const struct view_holder *holder, const struct eco_view *view,
	uint64_t *vertices, struct eco_error *error);

#endif
