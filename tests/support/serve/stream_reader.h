/* A client that only keeps books: parses a stream, remembers what it holds, and fails where a stream sends
 * something twice, out of order, or a plan that draws what has not been sent. */
#ifndef TESTS_STREAM_READER_H
#define TESTS_STREAM_READER_H

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/plan/planner.h"

struct stream_reader {
	const struct eco_scene *truth;       /* the pack's tables */
	uint32_t *have;                      /* chunks per list */
	bool *knows_list, *knows_plant;
	uint64_t budget_vertices;
	uint32_t plans, chunks, lists, plants;       /* frames seen in this stream */
	uint64_t vertices;                   /* of the last plan */
	bool ended;
};

void stream_reader_init(struct stream_reader *r, const struct eco_scene *truth);
void stream_reader_free(struct stream_reader *r);
/* Reads one whole stream on top of what is held already; counts restart. */
enum eco_code stream_reader_read(struct stream_reader *r, const void *bytes, size_t size,
	uint64_t budget_vertices, struct eco_error *error);
/* The holdings, as the body of the next request. */
struct eco_writer stream_reader_holdings(const struct stream_reader *r);

#endif
