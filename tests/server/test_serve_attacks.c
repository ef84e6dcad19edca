/* Attacks by one anonymous client that cost it little: none may cost the daemon much. */
#include "tests/support/serve_daemon.h"

#include <malloc.h>

/* Bytes that the process has allocated; 0 where the allocator does not say (sanitizers, which look for leaks
 * themselves). */
static size_t allocated(void)
{
	return mallinfo2().uordblks + mallinfo2().hblkhd;
}

static char *repeat(const char *before, const char *what, size_t count, const char *after)
{
	char *text = malloc(strlen(before) + strlen(what) * count + strlen(after) + 1), *at = text;
	at += sprintf(at, "%s", before);
	for (size_t i = 0; i < count; i++)
		at += sprintf(at, "%s", what);
	strcpy(at, after);
	return text;
}

static struct srv_daemon *start(const struct srv_config *config)
{
	struct srv_daemon *daemon;
	struct eco_error error = { 0 };
	assert_ok(srv_daemon_start(&daemon, config, &store, &error), error);
	return daemon;
}

/* Sends the request on `count` connections; each is answered so, and closed. */
static void send_on_many(const struct srv_daemon *daemon, const char *request, int count,
	unsigned status)
{
	int fds[100];
	assert_in_range(count, 1, 100);
	for (int i = 0; i < count; i++) {
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fds[i], request, strlen(request)));
	}
	for (int i = 0; i < count; i++) {
		struct http_answer answer = http_receive(fds[i], false, true);
		assert_int_equal(answer.status, status);
		http_free(&answer);
		close(fds[i]);
	}
}

/* libmicrohttpd drops these between the request line and the first call of the handler, and completes none;
 * so they are refused before it sees them. */
UNIT_TEST(requests_that_the_library_would_drop_are_refused)
{
	char *requests[] = { repeat("GET /healthz?", "&", 300, " HTTP/1.1\r\n" HOST "\r\n"),
		repeat("GET /healthz HTTP/1.1\r\n" HOST "Cookie: ", "a;", 1000, "\r\n\r\n") };
	static const unsigned statuses[] = { 400, 431 };
	const struct srv_config config = { .listen = "127.0.0.1:0" };
	for (int i = 0; i < 2; i++) {
		struct srv_daemon *daemon = start(&config);
		send_on_many(daemon, requests[i], 50, statuses[i]);
		size_t before = allocated();
		send_on_many(daemon, requests[i], 100, statuses[i]);
		assert_in_range(allocated(), 0, before + 100000);
		srv_daemon_stop(daemon);
		free(requests[i]);
	}
}

int main(void)
{
	return unit_tests_run(serve_start, serve_stop);
}
