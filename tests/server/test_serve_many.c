/* The daemon with slow clients, and when it is told to stop. */
#include "tests/support/serve/serve_daemon.h"

#include <errno.h>

UNIT_TEST(overdue_connections_are_shut)
{
	static const char *const starts[] = { "", "GET /hea", "GET /healthz HTTP/1.1\r\nHost: t\r\nX: ",
		STREAM "Content-Length: 100\r\n\r\nab" };
	const struct srv_config config = { .listen = "127.0.0.1:0", .head_ms = 200, .body_ms = 200 };
	struct srv_daemon *daemon = serve_another(&config);
	for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
		int fd = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fd, starts[i], strlen(starts[i])));
		struct http_answer answer = http_receive(fd, false, true);
		assert_true(answer.closed || errno == ECONNRESET);
		assert_int_equal(answer.status, 0);
		http_free(&answer);
		close(fd);
	}
	srv_daemon_stop(daemon);
}

/* Declared bytes cost a client nothing and take nothing from others; arrived bytes do. */
UNIT_TEST(bodies_are_bounded_together)
{
	static const char start[] = STREAM "Content-Length: 4194304\r\n\r\n";
	const struct srv_config config = { .listen = "127.0.0.1:0", .bodies_max = 1u << 20 };
	struct srv_daemon *daemon = serve_another(&config);
	int fds[64];
	uint8_t *zeros = calloc(1, 4u << 20);
	for (int i = 0; i < 64; i++) {
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fds[i], start, sizeof start - 1));
	}
	WAIT_UNTIL(srv_daemon_busy(daemon) == 64);
	usleep(50000);                           /* until heads are not only begun, but read */
	struct http_answer answer = http_ask(srv_daemon_port(daemon), "POST", BASE "/stream?" VIEW_BY("1"),
		OCTETS, NOTHING_HELD);
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	assert_true(http_send(fds[0], zeros, 4u << 20));
	http_receive_status(fds[0], true, 503);
	for (int i = 0; i < 64; i++)
		close(fds[i]);
	WAIT_UNTIL(srv_daemon_busy(daemon) == 0);
	answer = http_ask(srv_daemon_port(daemon), "POST", BASE "/stream?" VIEW_BY("1"), OCTETS, zeros,
		500000);
	assert_int_equal(answer.status, 400);    /* read, and found to be no holdings */
	http_free(&answer);
	srv_daemon_stop(daemon);
	free(zeros);
}

UNIT_TEST(stopping_refuses_new_requests_and_ends)
{
	static const char request[] = "GET /healthz HTTP/1.1\r\nHost: t\r\n\r\n";
	const struct srv_config config = { .listen = "127.0.0.1:0" };
	struct srv_daemon *daemon = serve_another(&config);
	int fd = http_connect(srv_daemon_port(daemon)), unfinished = http_connect(srv_daemon_port(daemon));
	assert_true(http_send(fd, request, sizeof request - 1));
	http_receive_status(fd, false, 200);
	assert_true(http_send(unfinished, "GET /", 5));
	srv_daemon_quiesce(daemon);
	assert_true(http_send(fd, request, sizeof request - 1));
	struct http_answer answer = http_receive(fd, false, true);
	assert_int_equal(answer.status, 503);
	assert_header(&answer, "Retry-After", "1");
	assert_true(answer.closed);
	http_free(&answer);
	srv_daemon_stop(daemon);
	close(fd);
	close(unfinished);
}

/* Connections that wait for a plan are suspended; the library aborts if one still is when it is stopped. */
UNIT_TEST(stopping_while_planning_is_clean)
{
	static const char request[] = "GET " BASE
		"/stream?" VIEW_BY("2000000") "&bytes=300000 HTTP/1.1\r\n" HOST "\r\n";
	const struct srv_config config = { .listen = "127.0.0.1:0", .work_threads = 2, .queue_max = 8 };
	for (int round = 0; round < 12; round++) {
		struct srv_daemon *daemon = serve_another(&config);
		int fds[24];
		for (int i = 0; i < 24; i++) {
			fds[i] = http_connect(srv_daemon_port(daemon));
			assert_true(http_send(fds[i], request, sizeof request - 1));
		}
		/* an answer, or a refusal because the queue is full; never nothing */
		if (round % 3) {
			struct http_answer answer = http_receive(fds[round], false, false);
			assert_true(answer.status == 200 || answer.status == 503);
			http_free(&answer);
		}
		if (round % 2)
			srv_daemon_quiesce(daemon);
		srv_daemon_stop(daemon);
		for (int i = 0; i < 24; i++)
			close(fds[i]);
	}
}

UNIT_TEST(a_taken_port_is_named)
{
	char listen_at[32];
	struct srv_config config = { .listen = listen_at };
	struct srv_daemon *daemon;
	struct eco_error error = { 0 };
	snprintf(listen_at, sizeof listen_at, "127.0.0.1:%u", port);
	assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_IO);
	assert_null(daemon);
	assert_non_null(strstr(error.text, listen_at));
	assert_non_null(strstr(error.text, "--listen"));
	static const char *const bad[] = { "", "8080", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536",
		"127.0.0.1:-1", "::1:80", "[::1]",
		"127.0.0.1:80x" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		config.listen = bad[i];
		error = (struct eco_error){ 0 };
		assert_int_equal(srv_daemon_start(&daemon, &config, &store, &error), ECO_BAD_USAGE);
	}
}

int main(void)
{
	return unit_tests_run(serve_start, serve_stop);
}
