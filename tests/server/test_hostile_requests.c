/* Requests over raw sockets that no friendly client sends, and what exactly comes back: how many answers,
 * which, and whether the connection is closed behind them. Each is sent at once, and byte by byte. */
#include "tests/support/serve/serve_daemon.h"

#include <netinet/tcp.h>

#include "tests/support/cases.h"

#define LINE "GET /healthz HTTP/1.1\r\n"
#define GET LINE HOST

/* `answers`: statuses in order; a full stop where the connection is closed behind the last. */
struct hostile_row { const char *request; size_t size; const char *answers; };
struct row { const char *request, *answers; };               /* of the table */

/* All that comes until the end. */
static char *read_all(int fd, size_t *size)
{
	size_t room = 1 << 16;
	char *bytes = malloc(room + 1);
	*size = 0;
	for (ssize_t got; (got = recv(fd, bytes + *size, room - *size, 0)) > 0;)
		if ((*size += (size_t)got) == room)
			bytes = realloc(bytes, (room *= 2) + 1);
	bytes[*size] = 0;
	return bytes;
}

/* The statuses of the answers, one after the other as their lengths say; "?" where something is no answer. */
static void list_answers(char *list, size_t room, const char *bytes, size_t size, bool is_head)
{
	size_t used = 0;
	*list = 0;
	for (const char *at = bytes; at < bytes + size && used + 8 < room; is_head = false) {
		const char *end = strstr(at, "\r\n\r\n"), *length = strcasestr(at, "\r\nContent-Length: ");
		unsigned status = strncmp(at, "HTTP/1.", 7) == 0 && end ? (unsigned)atoi(at + 9) : 0;
		used += (size_t)snprintf(list + used, room - used, status ? "%s%u" : "%s?", used ? " " : "",
			status);
		if (!status)
			return;
		bool none = is_head || status == 100 || status == 304 || !length || length > end;
		at = end + 4 + (none ? 0 : strtoul(length + 18, NULL, 10));
	}
}

static bool asks_head(const char *request)
{
	return strncmp(request, "HEAD ", 5) == 0;
}

/* Sends the request and, if the server took it for well, one that closes; its answer is dropped from the
 * list. */
static void ask(char list[256], const struct hostile_row *row, bool byte_by_byte)
{
	static const char last[] = "GET /healthz HTTP/1.1\r\nHost: last\r\nConnection: close\r\n\r\n";
	int fd = http_connect(port), on = 1;
	size_t size;
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
	bool sent = true;
	for (size_t i = 0; i < row->size && sent; i += byte_by_byte ? 1 : row->size)
		sent = http_send(fd, row->request + i, byte_by_byte ? 1 : row->size);
	bool open = !strchr(row->answers, '.');
	if (open)
		http_send(fd, last, sizeof last - 1);
	char *bytes = read_all(fd, &size);
	list_answers(list, 250, bytes, size, asks_head(row->request));
	size_t used = strlen(list);
	if (open && used >= 4 && strcmp(list + used - 4, " 200") == 0)
		list[used - 4] = 0;
	else
		strcat(list, ".");
	free(bytes);
	close(fd);
}

/* Whether the row was answered otherwise. */
static bool is_wrong(const struct hostile_row *row)
{
	char list[256];
	bool wrong = false;
	for (int byte_by_byte = 0; byte_by_byte < 2; byte_by_byte++) {
		ask(list, row, byte_by_byte);
		if (strcmp(list, row->answers) == 0)
			continue;
		print_error("%s: %s, not %s: %s\n", byte_by_byte ? "byte by byte" : "at once", list,
			row->answers, row->request);
		wrong = true;
	}
	return wrong;
}

UNIT_TEST(each_request_gets_exactly_its_answers)
{
	unsigned wrong = 0;
	uint32_t count;
	const struct row *rows = cases_read("tests/server/cases/hostile_requests.tsv", sizeof *rows, &count);
	for (const struct row *r = rows; r < rows + count; r++)
		wrong += is_wrong(&(struct hostile_row){ r->request, cases_size(&r->request), r->answers });
	assert_int_equal(wrong, 0);
}

/* A byte that belongs nowhere, at every place of a request (but its end): one refusal, and the end. */
UNIT_TEST(a_control_character_anywhere_is_refused)
{
	static const char request[] = LINE "Host: t\r\nAccept: */*\r\nX-Y:z\r\n\r\n";
	char list[256], made[sizeof request + 1];
	for (size_t at = 0; at < sizeof request - 2; at++)
		for (char bad = 0; bad <= ' '; bad++) {
			if (bad == '\t')
				continue;        /* belongs into values */
			memcpy(made, request, at);
			made[at] = bad < ' ' ? bad : 0x7f;
			memcpy(made + at + 1, request + at, sizeof request - at);
			const struct hostile_row row = { made, sizeof request, "400." };
			ask(list, &row, false);
			if (strcmp(list, "400.") != 0)
				fail_msg("byte %u before offset %zu: %s", (unsigned)made[at], at, list);
		}
}

/* Heads of every size and kind up to the limits and beyond: well, or refused by a problem document; never by
 * what the library says when its memory runs out. */
UNIT_TEST(large_heads_are_served_or_refused_well)
{
	static char head[32768];
	unsigned served = 0, refused = 0;
	for (int headers = 0; headers <= 98; headers += 14)
		for (int cookies = 0; cookies <= 160; cookies += 32)
			for (int fill = 0; fill <= 8000; fill += 400) {
				int size = sprintf(head, GET "Connection: close\r\nX: %0*d\r\nCookie: ", fill,
					0);
				for (int i = 0; i < cookies; i++)
					size += sprintf(head + size, "a=b;");
				for (int i = 0; i < headers; i++)
					size += sprintf(head + size, "\r\nX-%d: a", i);
				size += sprintf(head + size, "\r\n\r\n");
				struct http_answer answer = http_raw(port, head, (size_t)size);
				bool is_large = answer.status == 431 && strstr(answer.body, "head-too-large");
				if (answer.status != 200 && !is_large)
					fail_msg("%d headers, %d cookies, %d filled: %s", headers, cookies,
						fill, answer.head);
				served += answer.status == 200;
				refused += is_large;
				http_free(&answer);
			}
	assert_true(served > 300 && refused > 300);
}

UNIT_MAIN(serve_start, serve_stop)
