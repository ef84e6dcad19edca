/* The gate between a client's socket and the HTTP library: every byte passes srv_framing_scan, and what is
 * not well is refused and closed here, before the library sees it.
 *
 * The library reads its sockets with recv() and has no hook for that, so the linker binds its calls to the
 * gate's (--wrap=recv, Makefile; libmicrohttpd is linked in for that). Sockets without a gate are read as
 * ever.
 *
 * A gate belongs to the connection's polling thread. The refusal goes out in its turn: the library asks for
 * more only when all earlier requests of the connection have been answered. */
#ifndef SRV_GATE_H
#define SRV_GATE_H

#include "server/framing.h"

struct srv_gate {
	int fd;
	struct srv_framing framing;
};

/* False where the descriptor's number is too large: the connection is of no use then. */
bool srv_gate_open(struct srv_gate *gate, int fd);
/* Before the descriptor is closed. */
void srv_gate_close(struct srv_gate *gate);

/* Writes the problem document, without a body for HEAD, and tries to send it at once. */
void srv_gate_answer(int fd, enum srv_problem problem, const char *detail, bool is_head);

#endif
