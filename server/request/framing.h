/* The bytes of a connection, read strictly before the HTTP library sees them: the end of a request is decided
 * here. libmicrohttpd 0.9.75 takes a NUL or an empty name at the start of a line for the end of the head,
 * cuts values at a NUL, joins folded lines, and accepts two lengths, or a length beside Transfer-Encoding. A
 * proxy in front may read such a request in another way, and a body for one is a second request for the other
 * (smuggling).
 *
 * The grammar is RFC 9112's, without what it only tolerates: lines end with CRLF, one space parts the request
 * line, no line is folded, names are tokens, values hold no control characters. One Host (HTTP/1.0: at most
 * one), at most one Content-Length, no Transfer-Encoding, and once only what else may be given once. A head
 * and its parts are bounded, so that it fits the memory that the library gives it. Control characters are
 * refused as they come, and lines at their CR, where the library would read them.
 *
 *   struct srv_framing framing = { 0 };
 *   passed = srv_framing_scan(&framing, bytes, size);        as bytes come, of one request after the other
 *   if (passed < size) refuse: framing.problem, framing.detail; the connection is of no more use */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/request/json.h"

#define SRV_HEAD_BYTES_MAX 8192u
#define SRV_HEADERS_MAX 100u
/* Memory that the library needs for a connection: the head, 56 bytes for each header, parameter and cookie,
 * and the cookies once more. That memory is filled with zeros after each request, so it is not larger. */
#define SRV_HEAD_MEMORY_MAX (12u << 10)
#define SRV_CONNECTION_MEMORY (16u << 10)

enum srv_framing_state { SRV_AT_START, SRV_AT_REQUEST_LINE, SRV_AT_HEADER, SRV_AT_END };

struct srv_framing {
	enum srv_problem problem;        /* and why, in a sentence */
	const char *detail;
	uint32_t heads;                  /* that have passed */
	uint64_t body_left;              /* of the body that follows the last head */
	bool is_http_1_0;                /* the last request line */
	/* of the head that is being read */
	enum srv_framing_state state;
	uint32_t size, entries, header_count;
	uint32_t seen;                   /* a bit for each header that may be given once */
	bool is_head, after_cr;
	uint64_t length;
	uint32_t line_size;
	char line[SRV_HEAD_BYTES_MAX + 1];
};

/* How many of the bytes are well; all of them, if there is no problem. */
size_t srv_framing_scan(struct srv_framing *framing, const char *bytes, size_t size);

/* ---- The gate ---- */

/* The gate between a client's socket and the HTTP library: every byte passes srv_framing_scan, and bad
 * requests are refused and closed here, before the library sees them.
 *
 * The library reads its sockets with recv() and has no hook for that, so the linker binds its calls to the
 * gate's (--wrap=recv, Makefile). Sockets without a gate are read as ever. A gate belongs to the connection's
 * polling thread. The refusal goes out in its turn: the library asks for more only when all earlier requests
 * of the connection have been answered. */
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
