/* ECO_TRACE=plan,cache prints on stderr why things are as they are. One table of bits; reading it costs one
 * load when off. */
#ifndef SRV_TRACE_H
#define SRV_TRACE_H

#include <stdbool.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"

#define SRV_TRACE_BITS(X) \
	X(PLAN, "plan", "vertex budgets tried for a byte budget, steps taken or left out, and why") \
	X(CUTS, "cuts", "of each plan, why each cut is what it is") \
	X(CACHE, "cache", "chunk responses made, reused, refused") \
	X(CONNECTION, "connection", "connections that were shut down, and why")

enum srv_trace_bit {
#define X(bit, name, text) SRV_TRACE_##bit,
	SRV_TRACE_BITS(X)
#undef X
	SRV_TRACE_COUNT
};

/* Sets the bits from a comma-separated list of names (NULL: none), once, before threads start. ECO_BAD_USAGE
 * lists the names. */
enum eco_code srv_trace_set(const char *names, struct eco_error *error);
/* From now on what this thread says of its plans goes to `to`, too, a line each; NULL: no more. */
void srv_trace_capture(struct eco_writer *to);
bool srv_trace_on(enum srv_trace_bit bit);
void srv_trace(enum srv_trace_bit bit, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
