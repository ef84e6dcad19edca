/* Attacks by anonymous clients, of one address or several, that cost them little: none may cost the daemon or
 * others much. */
#include "tests/support/serve/serve_daemon.h"

#include <errno.h>
#include <malloc.h>
#include <sys/resource.h>

static uint64_t connections(const struct srv_daemon *daemon)
{
	return srv_reaper_held(daemon->reaper, SRV_HELD_CONNECTIONS);
}

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
		http_receive_status(fds[i], true, status);
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
	for (int i = 0; i < 2; i++) {
		struct srv_daemon *daemon = SERVE_ANOTHER();
		send_on_many(daemon, requests[i], 50, statuses[i]);
		size_t before = allocated();
		send_on_many(daemon, requests[i], 100, statuses[i]);
		usleep(300000);                  /* until refused connections are forgotten */
		assert_in_range(allocated(), 0, before + 100000);
		srv_daemon_stop(daemon);
		free(requests[i]);
	}
}

static void open_idle(const struct srv_daemon *daemon, int *fds, int count)
{
	for (int i = 0; i < count; i++) {
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(fds[i] >= 0);
	}
}

static void close_all(const int *fds, int count)
{
	for (int i = 0; i < count; i++)
		close(fds[i]);
}

static void assert_served(const struct srv_daemon *daemon)
{
	http_expect(srv_daemon_port(daemon), "GET", "/healthz", "", 200, NULL);
}

/* The connection that has waited the longest gives way, and none that is in the middle of something. */
UNIT_TEST(idle_connections_give_way_and_busy_ones_do_not)
{
	static const char begun[] = STREAM "Content-Length: 100\r\n\r\nab",
		ask[] = "GET /healthz HTTP/1.1\r\n" HOST "\r\n";
	struct srv_daemon *daemon = SERVE_ANOTHER(.connections_per_address = 4);
	int fds[5];
	open_idle(daemon, fds, 2);
	assert_true(http_send(fds[1], begun, sizeof begun - 1));
	WAIT_UNTIL(srv_daemon_busy(daemon) == 1);
	usleep(20000);
	open_idle(daemon, fds + 2, 3);           /* the first gives way to the fifth */
	assert_true(http_send(fds[4], ask, sizeof ask - 1));
	http_receive_status(fds[4], false, 200);
	http_receive_status(fds[0], true, 0);
	assert_true(http_send(fds[2], ask, sizeof ask - 1));     /* has waited less */
	http_receive_status(fds[2], false, 200);
	for (int i = 2; i < 5; i++)
		assert_true(http_send(fds[i], begun, sizeof begun - 1));
	WAIT_UNTIL(srv_daemon_busy(daemon) == 4);
	usleep(20000);
	http_expect(srv_daemon_port(daemon), "GET", "/healthz", "", 503, "from this address");   /* nobody waits */
	close_all(fds + 1, 4);
	srv_daemon_stop(daemon);
}

UNIT_TEST(a_trusted_proxy_has_no_share_of_its_own)
{
	struct srv_config config = { .listen = "127.0.0.1:0",
		.connections_per_address = 2,
		.connections_max = 30 };
	int fds[40];
	assert_good(srv_networks_parse("10.0.0.0/8,127.0.0.1", &config.trusted, &cause));
	struct srv_daemon *daemon = serve_another(&config);
	open_idle(daemon, fds, 20);
	assert_served(daemon);
	WAIT_UNTIL(connections(daemon) == 20);         /* who was served has left */
	open_idle(daemon, fds + 20, 20);
	assert_served(daemon);
	assert_in_range(connections(daemon), 29, 30);
	close_all(fds, 40);
	srv_daemon_stop(daemon);
}

/* ---- Several addresses ---- */

enum { PLACES = 40, PLACES_EACH = 30, CROWD_MAX = 120, HONEST = 1000 };
static const char dripping[] = STREAM "Content-Length: 100\r\n\r\nab";

/* Connections of address HONEST + 1 and on, `each` one after the other, that send a part of a body. */
static void crowd(const struct srv_daemon *daemon, int addresses, int each, int *fds)
{
	assert_in_range(addresses * each, 1, CROWD_MAX);
	for (int i = 0; i < addresses * each; i++) {
		http_come_from((uint32_t)(HONEST + 1 + i / each));
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fds[i], dripping, sizeof dripping - 1));
		usleep(2000);
	}
	http_come_from(0);
}

static void assert_answered(const struct srv_daemon *daemon, uint32_t source, const char *target)
{
	http_come_from(source);
	http_expect(srv_daemon_port(daemon), "GET", target, "", 200, NULL);
	http_come_from(0);
}

/* Others come in, however many addresses hold how much, and end what they have begun. */
UNIT_TEST(crowds_of_addresses_lock_nobody_out)
{
	static const struct { int addresses, each; } rows[] = { { 2, 30 }, { 3, 20 }, { 8, 8 }, { 20, 4 }, { 40, 3 } };
	char rest[98] = { 0 };
	for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
		struct srv_daemon *daemon = SERVE_ANOTHER(.connections_max = PLACES,
			.connections_per_address = PLACES_EACH);
		int fds[CROWD_MAX];
		http_come_from(HONEST);
		int honest = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(honest, dripping, sizeof dripping - 1));
		usleep(20000);
		crowd(daemon, rows[r].addresses, rows[r].each, fds);
		assert_answered(daemon, 0, "/healthz");
		for (uint32_t i = 1; i < 20; i++)
			assert_answered(daemon, HONEST - i, i % 2 ? "/healthz" : BASE "/stream?" VIEW_BY("1000"));
		assert_in_range(connections(daemon), PLACES - 10, PLACES + 16);
		assert_true(http_send(honest, rest, sizeof rest));
		http_receive_status(honest, false, 400);         /* read, and found to be no holdings */
		close(honest);
		close_all(fds, rows[r].addresses * rows[r].each);
		srv_daemon_stop(daemon);
	}
}

/* A newcomer has no better claim if each address holds one, and none waits; but a watcher on the server's own
 * machine is answered. */
UNIT_TEST(the_own_machine_is_answered_when_all_is_taken)
{
	struct srv_daemon *daemon = SERVE_ANOTHER(.connections_max = PLACES);
	int fds[CROWD_MAX];
	crowd(daemon, PLACES + 16, 1, fds);
	for (int i = 0; i < 3; i++)
		assert_answered(daemon, 0, "/healthz");
	close_all(fds, PLACES + 16);
	srv_daemon_stop(daemon);
}

/* The address whose bodies take most gives way, and not the one that needs a little. */
UNIT_TEST(bodies_of_few_addresses_lock_nobody_out)
{
	enum { BODY = 200000, LATER = 100 };
	static const char head[] = STREAM "Content-Length: 200100\r\n\r\n";
	struct srv_daemon *daemon = SERVE_ANOTHER(.bodies_max = 1u << 20);
	uint8_t *zeros = calloc(1, BODY + LATER);
	int fds[12];
	for (int i = 0; i < 12; i++) {           /* of three addresses, twice as much as there is room for */
		http_come_from((uint32_t)(HONEST + 1 + i % 3));
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fds[i], head, sizeof head - 1));
		assert_true(http_send(fds[i], zeros, BODY));
		usleep(20000);
	}
	for (uint32_t i = 0; i < 5; i++) {
		http_come_from(HONEST - i);
		struct http_answer answer = http_ask(srv_daemon_port(daemon), "POST", BASE "/stream?"
			VIEW_BY("1"), OCTETS, zeros, BODY / 2);
		assert_int_equal(answer.status, 400);
		http_free(&answer);
	}
	http_come_from(0);
	close_all(fds, 12);
	free(zeros);
	srv_daemon_stop(daemon);
}

/* Out of descriptors: no busy loop, and who comes when there are some again is served. */
UNIT_TEST(exhausted_descriptors_are_waited_for)
{
	struct srv_daemon *daemon = SERVE_ANOTHER(.connections_per_address = 1000);
	struct rlimit limit, few;
	int fds[40], highest = dup(0);
	close(highest);
	assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
	open_idle(daemon, fds, 40);              /* 80 descriptors, both ends */
	WAIT_UNTIL(connections(daemon) >= 40);
	few = (struct rlimit){ .rlim_cur = (rlim_t)highest + 81, .rlim_max = limit.rlim_max };
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
	int last[4], count = 0;
	while (count < 4 && (last[count] = http_connect(srv_daemon_port(daemon))) >= 0)
		count++;
	assert_true(count >= 1);
	usleep(400000);
	assert_in_range(atomic_load(&daemon->accept_failures), 1, 40);
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &limit), 0);
	assert_served(daemon);
	close_all(fds, 40);
	close_all(last, count);
	srv_daemon_stop(daemon);
}

enum { ANSWERS = 300 };

/* A connection with a small window that asks for much more than any buffer holds. */
static int ask_much(const struct srv_daemon *daemon)
{
	static const char request[] = "GET " BASE "/stream?" VIEW_BY("3000000") " HTTP/1.1\r\n" HOST "\r\n";
	struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons(srv_daemon_port(daemon)),
		.sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	int fd = http_socket(), room = 4096;
	setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
	assert_int_equal(connect(fd, (struct sockaddr *)&at, sizeof at), 0);
	for (int i = 0; i < ANSWERS && http_send(fd, request, sizeof request - 1); i++)
		;
	return fd;
}

/* Connections that ask for much and take nothing: their answers stay within the bound, and what others ask
 * for is sent to its end. */
UNIT_TEST(answers_that_are_being_sent_are_bounded_together)
{
	enum { MOST = 1000000, STALLED = 24 };
	struct srv_daemon *daemon = SERVE_ANOTHER(.answers_max = MOST);
	int fds[STALLED];
	for (int i = 0; i < STALLED; i++) {
		http_come_from((uint32_t)(HONEST + 1 + i % 3));
		fds[i] = ask_much(daemon);
	}
	WAIT_UNTIL(http_metric(srv_daemon_port(daemon), "answers_bytes") >= MOST / 2);
	for (uint32_t i = 0; i < 20; i++) {
		assert_answered(daemon, HONEST - i, i % 2 ? BASE "/stream?" VIEW_BY("3000000") : "/healthz");
		assert_in_range(http_metric(srv_daemon_port(daemon), "answers_bytes"), 0, MOST);
	}
	close_all(fds, STALLED);
	srv_daemon_stop(daemon);
}

/* An answer that the bound of all can never hold is said to be too large, not to be asked for again. */
UNIT_TEST(an_answer_larger_than_all_may_be_is_refused)
{
	struct srv_daemon *daemon = SERVE_ANOTHER(.answers_max = 1000);
	http_expect(srv_daemon_port(daemon), "GET", "/healthz", "", 200, NULL);
	http_expect(srv_daemon_port(daemon), "GET", BASE "/stream?" VIEW_BY("3000000"), "", 422, NULL);
	srv_daemon_stop(daemon);
}

/* A client that takes nothing of an answer is closed after two windows, however large the answer. */
UNIT_TEST(answers_that_nobody_takes_are_given_up)
{
	struct srv_daemon *daemon = SERVE_ANOTHER(.send_ms = 200, .rate_bytes_s = 1);
	struct http_answer whole = http_get(srv_daemon_port(daemon), BASE "/stream?" VIEW_BY("3000000"));
	size_t size = whole.size, got = 0;
	http_free(&whole);
	int fd = ask_much(daemon);
	char bytes[65536];
	assert_true(recv(fd, bytes, 1, MSG_PEEK) == 1);  /* it has begun */
	while (connections(daemon))    /* until it is given up */
		usleep(10000);
	for (ssize_t part; (part = recv(fd, bytes, sizeof bytes, 0)) > 0;)
		got += (size_t)part;
	assert_in_range(got, 1, ANSWERS * size - 1);
	close(fd);
	srv_daemon_stop(daemon);
}

/* A client that takes some in each window gets all of it, however many windows that takes. */
UNIT_TEST(answers_that_are_taken_slowly_arrive)
{
	struct srv_daemon *daemon = SERVE_ANOTHER(.send_ms = 1500, .rate_bytes_s = 1);
	struct http_answer whole = http_get(srv_daemon_port(daemon), BASE "/stream?" VIEW_BY("3000000"));
	int fd = ask_much(daemon);
	char *bytes = malloc(whole.size);
	for (int i = 0; i < 40; i++) {           /* for more than a window */
		assert_true(recv(fd, bytes, whole.size / 40, 0) > 0);
		usleep(50000);
	}
	struct timeval patience = { .tv_sec = 50 };
	setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
	for (size_t left = ANSWERS * whole.size / 2; left;) {
		ssize_t part = recv(fd, bytes, whole.size < left ? whole.size : left, 0);
		assert_true(part > 0);
		left -= (size_t)part;
	}
	free(bytes);
	close(fd);
	http_free(&whole);
	srv_daemon_stop(daemon);
}

/* Plans that nobody waits for any more are not made: with one thread and many waiting, some were not begun
 * when their clients had left. What was planned is kept, and says nothing of timing when it is asked for
 * again. */
UNIT_TEST(plans_of_clients_that_left_are_not_made)
{
	enum { PLANS = 60 };
	struct srv_daemon *daemon = SERVE_ANOTHER(.work_threads = 1, .queue_share_max = 64,
		.plan_times = 1000);
	char target[300], request[400], timing[100];
	int fds[PLANS], made = 0;
	for (int i = 0; i < PLANS; i++) {
		snprintf(request, sizeof request,
			"GET " BASE "/stream?" VIEW "&vertices=%d&bytes=200000 HTTP/1.1\r\n" HOST "\r\n",
			1000000 + i);
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fds[i], request, strlen(request)));
	}
	WAIT_UNTIL(srv_daemon_busy(daemon));
	close_all(fds, PLANS);
	WAIT_UNTIL(!srv_daemon_busy(daemon));
	for (int i = 0; i < PLANS; i++) {
		snprintf(target, sizeof target, BASE "/stream?" VIEW "&vertices=%d&bytes=200000",
			1000000 + i);
		struct http_answer answer = http_ask(srv_daemon_port(daemon), "HEAD", target, "", NULL, 0);
		assert_int_equal(answer.status, 200);
		made += !http_header(&answer, "Server-Timing", timing, sizeof timing);
		http_free(&answer);
	}
	assert_in_range(made, 0, PLANS - 1);
	srv_daemon_stop(daemon);
}

/* One that only ends its sending (`nc -N`) gets its answer, after interim ones if that takes a while; by
 * HTTP/1.0, which has none of those, too. */
UNIT_TEST(clients_that_send_no_more_get_their_answers)
{
	enum { PLANS = 30 };
	struct srv_daemon *daemon = SERVE_ANOTHER(.work_threads = 1, .plan_times = 1000);
	char request[400];
	int fds[PLANS];
	unsigned interim[2] = { 0 };
	for (int i = 0; i < PLANS; i++) {
		snprintf(request, sizeof request,
			"GET " BASE "/stream?" VIEW "&vertices=%d&bytes=200000 HTTP/1.%d\r\n" HOST "\r\n",
			2000000 + i, i % 2);
		fds[i] = http_connect(srv_daemon_port(daemon));
		assert_true(http_send(fds[i], request, strlen(request)));
		assert_int_equal(shutdown(fds[i], SHUT_WR), 0);
	}
	for (int i = 0; i < PLANS; i++) {
		struct http_answer answer = http_receive(fds[i], false, true);
		assert_int_equal(answer.status, 200);
		assert_true(answer.closed);
		interim[i % 2] += answer.interim;
		http_free(&answer);
		close(fds[i]);
	}
	assert_int_equal(interim[0], 0);
	srv_daemon_stop(daemon);
}

/* ---- Slow clients, and the end ---- */

UNIT_TEST(overdue_connections_are_shut)
{
	static const char *const starts[] = { "", "GET /hea", "GET /healthz HTTP/1.1\r\nHost: t\r\nX: ",
		STREAM "Content-Length: 100\r\n\r\nab" };
	struct srv_daemon *daemon = SERVE_ANOTHER(.head_ms = 200, .body_ms = 200);
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
	struct srv_daemon *daemon = SERVE_ANOTHER(.bodies_max = 1u << 20);
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
	close_all(fds, 64);
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
	struct srv_daemon *daemon = SERVE_ANOTHER();
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
	for (int round = 0; round < 12; round++) {
		struct srv_daemon *daemon = SERVE_ANOTHER(.work_threads = 2, .queue_max = 8);
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
		close_all(fds, 24);
	}
}

UNIT_TEST(a_taken_port_is_named)
{
	char listen_at[32];
	struct srv_config config = { .listen = listen_at };
	struct srv_daemon *daemon;
	snprintf(listen_at, sizeof listen_at, "127.0.0.1:%u", port);
	assert_code(srv_daemon_start(&daemon, &config, &store, &cause), ECO_IO, "");
	assert_null(daemon);
	assert_non_null(strstr(cause.text, listen_at));
	assert_non_null(strstr(cause.text, "--listen"));
	static const char *const bad[] = { "", "8080", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536",
		"127.0.0.1:-1", "::1:80", "[::1]",
		"127.0.0.1:80x" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		config.listen = bad[i];
		assert_code(srv_daemon_start(&daemon, &config, &store, &cause), ECO_BAD_USAGE, "");
	}
}

UNIT_MAIN(serve_start, serve_stop)
