/* Events that a parser of streams told, as bytes, so that two tellings can be compared. */
#ifndef TESTS_WIRE_TOLD_H
#define TESTS_WIRE_TOLD_H

#include "ecofiles/format/wire.h"

/* The event of number `fail_at` fails. `hosted`: the host's bytes for any chunk; NULL: it is passed over. */
struct wire_told { struct eco_writer w; uint32_t events, fail_at; const char *hosted; };

extern const struct eco_wire_events wire_telling;

/* Feeds in portions of `portion` bytes; 0: of random sizes. */
enum eco_code wire_tell(const uint8_t *bytes, size_t size, size_t portion, struct wire_told *told,
	struct eco_error *error);

#endif
