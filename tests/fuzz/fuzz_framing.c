/* A connection's bytes, as the gate reads them: at once, and in two parts, cut where the first byte says.
 * Heads that pass are what framing.h promises the HTTP library. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "server/request/framing.h"

/* A head that passed: whole lines, none of which begins with a space, a colon or nothing. */
static void check_head(const char *head, size_t size)
{
	assert(size <= SRV_HEAD_BYTES_MAX && size >= sizeof "A / HTTP/1.0\r\n\r\n" - 1);
	assert(memcmp(head + size - 4, "\r\n\r\n", 4) == 0);
	for (size_t i = 0; i < size; i++) {
		unsigned char c = (unsigned char)head[i];
		assert(c == '\r' ? head[i + 1] == '\n' : c == '\n' ? i && head[i - 1] == '\r'
			: c == '\t' || (c >= 0x20 && c != 0x7f));
		if (c == '\n' && i + 3 < size)
			assert(!strchr(" \t:\r\n", head[i + 1]));
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *input, size_t size)
{
	struct srv_framing whole = { 0 }, parts = { 0 };
	if (size < 1)
		return 0;
	size_t cut = input[0] % size, head = 0;
	char *bytes = malloc(size);
	memcpy(bytes, input + 1, size - 1);
	size_t passed = srv_framing_scan(&whole, bytes, size - 1), at = srv_framing_scan(&parts, bytes, cut);
	if (at == cut)
		at += srv_framing_scan(&parts, bytes + cut, size - 1 - cut);
	assert(at == passed && parts.problem == whole.problem && parts.heads == whole.heads);
	assert((passed < size - 1) == (whole.problem != SRV_PROBLEM_NONE) && !whole.problem == !whole.detail);
	struct srv_framing one = { 0 };
	for (at = 0; at < passed; at++) {
		uint32_t heads = one.heads;
		if (one.size == 0 && !one.body_left)     /* behind an empty line, if one comes first */
			head = bytes[at] == '\r' ? at + 2 : at;
		assert(srv_framing_scan(&one, bytes + at, 1) == 1);
		if (one.heads > heads)
			check_head(bytes + head, at + 1 - head);
	}
	free(bytes);
	return 0;
}
