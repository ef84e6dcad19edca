#include "tests/support/serve/http_client.h"

#include "tests/support/unit_test.h"

static uint32_t source;

void http_come_from(uint32_t number)
{
	source = number ? 0x7f000000u + number : 0;
}

int http_listen(uint16_t *port)
{
	struct sockaddr_in at = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	socklen_t size = sizeof at;
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_int_equal(bind(fd, (struct sockaddr *)&at, size), 0);
	assert_int_equal(listen(fd, 64), 0);
	assert_int_equal(getsockname(fd, (struct sockaddr *)&at, &size), 0);
	*port = ntohs(at.sin_port);
	return fd;
}

bool http_hear(int fd, char *request, size_t room, size_t *size)
{
	*size = 0;
	for (ssize_t got; (got = recv(fd, request + *size, room - 1 - *size, 0)) > 0;) {
		*size += (size_t)got;
		request[*size] = 0;
		char *end = strstr(request, "\r\n\r\n"), *length = strcasestr(request, "content-length:");
		if (end && *size >= (size_t)(end + 4 - request) + (length ? strtoul(length + 15, NULL, 10) : 0))
			return true;
	}
	return false;
}

int http_socket(void)
{
	struct sockaddr_in from = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(source) };
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd >= 0 && source && bind(fd, (struct sockaddr *)&from, sizeof from) != 0) {
		close(fd);
		return -1;
	}
	return fd;
}

int http_connect(uint16_t port)
{
	struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons(port),
		.sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	struct timeval patience = { .tv_sec = 50 };      /* against hanging for ever, not a measurement */
	int fd = http_socket();
	setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
	if (fd < 0 || connect(fd, (struct sockaddr *)&at, sizeof at) != 0) {
		close(fd);
		return -1;
	}
	return fd;
}

bool http_send(int fd, const void *bytes, size_t size)
{
	for (const char *at = bytes; size;) {
		ssize_t sent = send(fd, at, size, MSG_NOSIGNAL);
		if (sent <= 0)
			return false;
		at += sent;
		size -= (size_t)sent;
	}
	return true;
}

bool http_header(const struct http_answer *answer, const char *name, char *value, size_t size)
{
	size_t length = strlen(name);
	for (const char *line = strstr(answer->head, "\r\n"); line; line = strstr(line + 2, "\r\n"))
		if (strncasecmp(line + 2, name, length) == 0 && line[2 + length] == ':') {
			const char *first = line + 3 + length + strspn(line + 3 + length, " ");
			snprintf(value, size, "%.*s", (int)strcspn(first, "\r"), first);
			return true;
		}
	return false;
}

/* Takes interim responses off the front, and returns how many bytes are left. */
static size_t drop_interim(char *bytes, size_t size, struct http_answer *answer)
{
	for (char *end; size > 9 && bytes[9] == '1' && (end = strstr(bytes, "\r\n\r\n")); answer->interim++) {
		size -= (size_t)(end + 4 - bytes);
		memmove(bytes, end + 4, size + 1);
	}
	return size;
}

struct http_answer http_receive(int fd, bool no_body, bool to_end)
{
	struct http_answer answer = { 0 };
	size_t capacity = 1 << 16, size = 0, head_size = 0, expected = SIZE_MAX;
	char *bytes = malloc(capacity + 1), length[32];
	for (;;) {
		if (head_size && !to_end && size - head_size >= expected)
			break;
		if (size == capacity)
			bytes = realloc(bytes, (capacity *= 2) + 1);
		ssize_t got = recv(fd, bytes + size, capacity - size, 0);
		if (got <= 0) {
			answer.closed = got == 0;
			break;
		}
		size += (size_t)got;
		bytes[size] = 0;
		size = head_size ? size : drop_interim(bytes, size, &answer);
		char *blank = head_size ? NULL : strstr(bytes, "\r\n\r\n");
		if (blank) {
			head_size = (size_t)(blank - bytes) + 4;
			answer.head = bytes;
			answer.status = (unsigned)atoi(bytes + 9);
			bool none = no_body || answer.status == 204 || answer.status == 304;
			expected = none ? 0 : http_header(&answer, "Content-Length", length, sizeof length)
				? strtoull(length, NULL, 10) : SIZE_MAX;
		}
	}
	bytes[size] = 0;
	answer.head = bytes;
	answer.body = bytes + head_size;
	answer.size = size - head_size;
	if (head_size)
		bytes[head_size - 2] = 0;
	return answer;
}

struct http_answer http_raw(uint16_t port, const char *request, size_t size)
{
	int fd = http_connect(port);
	struct http_answer answer = { 0 };
	if (fd < 0)
		return answer;
	http_send(fd, request, size);
	answer = http_receive(fd, strncmp(request, "HEAD ", 5) == 0, true);
	close(fd);
	return answer;
}

struct http_answer http_ask(uint16_t port, const char *method, const char *target, const char *headers,
	const void *body, size_t body_size)
{
	char head[8192], length[64] = "";
	if (body)
		snprintf(length, sizeof length, "Content-Length: %zu\r\n", body_size);
	int size = snprintf(head, sizeof head, "%s %s HTTP/1.1\r\nHost: localhost\r\nConnection: "
		"close\r\n%s%s\r\n", method, target, headers, length);
	char *request = malloc((size_t)size + body_size + 1);
	memcpy(request, head, (size_t)size);
	if (body_size)
		memcpy(request + size, body, body_size);
	struct http_answer answer = http_raw(port, request, (size_t)size + body_size);
	free(request);
	return answer;
}

struct http_answer http_get(uint16_t port, const char *target)
{
	return http_ask(port, "GET", target, "", NULL, 0);
}

void http_free(struct http_answer *answer)
{
	free(answer->head);
	*answer = (struct http_answer){ 0 };
}

void http_receive_status(int fd, bool to_end, unsigned status)
{
	struct http_answer answer = http_receive(fd, false, to_end);
	assert_int_equal(answer.status, status);
	assert_true(status || answer.closed);
	http_free(&answer);
}

unsigned http_status(uint16_t port, const char *method, const char *target, const char *headers)
{
	struct http_answer answer = http_ask(port, method, target, headers, NULL, 0);
	unsigned status = answer.status;
	http_free(&answer);
	return status;
}

void http_expect(uint16_t port, const char *method, const char *target, const char *headers, unsigned status,
	const char *says)
{
	struct http_answer answer = http_ask(port, method, target, headers, NULL, 0);
	if (answer.status != status || (says && !strstr(answer.body, says)))
		fail_msg("%s %s: not %u, %s:\n%s\n%.300s", method, target, status, says ? says : "",
			answer.head, answer.body);
	http_free(&answer);
}

uint64_t http_metric(uint16_t port, const char *name)
{
	char line[100];
	struct http_answer answer = http_get(port, "/metrics");
	snprintf(line, sizeof line, "\necoserve_%s ", name);
	const char *at = answer.status == 200 ? strstr(answer.body, line) : NULL;
	assert_non_null(at);
	uint64_t value = strtoull(at + strlen(line), NULL, 10);
	http_free(&answer);
	return value;
}
