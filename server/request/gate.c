#include "server/request/framing.h"

#include <errno.h>
#include <microhttpd.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/socket.h>

#define DESCRIPTORS_MAX (1 << 20)

ssize_t __real_recv(int fd, void *bytes, size_t size, int flags);
ssize_t __wrap_recv(int fd, void *bytes, size_t size, int flags);

/* One process, one table of descriptors; pages of it that are not used take no memory. */
static _Atomic(struct srv_gate *) gates[DESCRIPTORS_MAX];

static _Atomic(uint64_t) refused;

uint64_t srv_gate_refused(void)
{
	return atomic_load(&refused);
}

bool srv_gate_open(struct srv_gate *gate, int fd)
{
	if (fd < 0 || fd >= DESCRIPTORS_MAX)
		return false;
	*gate = (struct srv_gate){ .fd = fd };
	atomic_store(&gates[fd], gate);
	return true;
}

void srv_gate_close(struct srv_gate *gate)
{
	atomic_store(&gates[gate->fd], NULL);
}

void srv_gate_answering(struct srv_gate *gate, bool is_answering)
{
	gate->is_answering = is_answering;
	if (!is_answering && gate->has_ended)
		shutdown(gate->fd, SHUT_RD);     /* wakes the library */
}

void srv_gate_answer(int fd, enum srv_problem problem, const char *detail, bool is_head)
{
	struct srv_json json = { 0 };
	atomic_fetch_add_explicit(&refused, 1, memory_order_relaxed);
	unsigned status = srv_problem_rows[problem].status;
	char text[1024];
	srv_problem_write(&json, problem, detail, NULL);
	if (!json.out.failed) {
		int size = snprintf(text, sizeof text, "HTTP/1.1 %u %s\r\nContent-Type: "
			"application/problem+json\r\nCache-Control: no-store\r\n%sConnection: close\r\n"
			"Content-Length: %zu\r\n\r\n%.*s", status, MHD_get_reason_phrase_for(status),
			status == MHD_HTTP_SERVICE_UNAVAILABLE ? "Retry-After: 1\r\n" : "", json.out.size,
			is_head ? 0 : (int)json.out.size, (const char *)json.out.bytes);
		if (size > 0 && (size_t)size < sizeof text)
			(void)!send(fd, text, (size_t)size, MSG_NOSIGNAL | MSG_DONTWAIT);
	}
	eco_writer_free(&json.out);
}

/* To the library the client has left; the reaper drops what still comes. */
static ssize_t end_refused(struct srv_gate *gate)
{
	const struct srv_framing *framing = &gate->framing;
	srv_gate_answer(gate->fd, framing->problem, framing->detail, framing->is_head);
	shutdown(gate->fd, SHUT_WR);
	return 0;
}

static ssize_t receive(struct srv_gate *gate, void *bytes, size_t size, int flags)
{
	if (gate->framing.problem)
		return end_refused(gate);
	ssize_t got = __real_recv(gate->fd, bytes, size, flags);
	if (got == 0 && gate->is_answering) {
		gate->has_ended = true;
		errno = EAGAIN;
		return -1;
	}
	if (got <= 0)
		return got;
	uint32_t heads = gate->framing.heads;
	bool in_head = !gate->framing.body_left;
	size_t passed = srv_framing_scan(&gate->framing, bytes, (size_t)got);
	/* nothing that is whole has passed, only what comes before the problem in the same head */
	if (passed < (size_t)got && in_head && heads == gate->framing.heads)
		return end_refused(gate);
	if (passed < (size_t)got)
		shutdown(gate->fd, SHUT_RD);     /* wakes the library when it has answered what passed */
	return (ssize_t)passed;
}

ssize_t __wrap_recv(int fd, void *bytes, size_t size, int flags)
{
	struct srv_gate *gate = fd >= 0 && fd < DESCRIPTORS_MAX ? atomic_load(&gates[fd]) : NULL;
	return gate ? receive(gate, bytes, size, flags) : __real_recv(fd, bytes, size, flags);
}
