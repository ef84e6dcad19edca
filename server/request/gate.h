/* The gate between a client's socket and the HTTP library: every byte passes srv_framing_scan, and bad
 * requests are refused and closed here, before the library sees them.
 *
 * The library reads its sockets with recv() and has no hook for that, so the linker binds its calls to the
 * gate's (--wrap=recv, Makefile). Sockets without a gate are read as ever. A gate belongs to the connection's
 * polling thread. The refusal goes out in its turn: the library asks for more only when all earlier requests
 * of the connection have been answered. */
#ifndef SRV_GATE_H
#define SRV_GATE_H

#include "server/request/framing.h"

struct srv_gate {
	int fd;
	struct srv_framing framing;
	bool is_answering, has_ended;    /* a whole request is here; and the client has sent all it will */
};

/* False where the descriptor's number is too large: the connection is of no use then. */
bool srv_gate_open(struct srv_gate *gate, int fd);
/* From when a request is whole until its answer is out the end of what the client sends is kept from the
 * library, which would take it for an end of the connection. */
void srv_gate_answering(struct srv_gate *gate, bool is_answering);
/* Before the descriptor is closed. */
void srv_gate_close(struct srv_gate *gate);

uint64_t srv_gate_refused(void);          /* answers of srv_gate_answer so far */
/* Writes the problem document, without a body for HEAD, and tries to send it at once. */
void srv_gate_answer(int fd, enum srv_problem problem, const char *detail, bool is_head);

#endif
