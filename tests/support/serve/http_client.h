/* A blocking HTTP client of one connection that sends exactly the bytes it is told to: what a library would
 * refuse to send too. */
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

struct http_answer {
	unsigned status;             /* 0: no answer */
	unsigned interim;            /* responses before it that said to wait */
	char *head;                  /* status line and headers, 0-terminated; owns the memory of all */
	char *body;                  /* 0-terminated too */
	size_t size;
	bool closed;                 /* the server closed the connection behind it */
};

/* A socket that listens on a free port of 127.0.0.1, for servers that tests play. */
int http_listen(uint16_t *port);
/* Reads one request whole, with a body of its Content-Length, as a text. False: the connection ended before. */
bool http_hear(int fd, char *request, size_t room, size_t *size);
int http_connect(uint16_t port);
int http_socket(void);               /* not connected yet */
/* Sockets come from 127.0.0.0 + `number` from now on; 0: from where the system likes. */
void http_come_from(uint32_t number);
bool http_send(int fd, const void *bytes, size_t size);
/* Value of a header into `value`, or false. */
bool http_header(const struct http_answer *answer, const char *name, char *value, size_t size);
/* Reads one answer; `no_body` for HEAD. Reads to the end of the connection where `to_end` or no length is
 * given. */
struct http_answer http_receive(int fd, bool no_body, bool to_end);
/* Sends raw bytes on a new connection and reads until the server closes it: `request` must make it do so. */
struct http_answer http_raw(uint16_t port, const char *request, size_t size);
/* One request on a new connection. `headers`: further header lines, each ended by \r\n. */
struct http_answer http_ask(uint16_t port, const char *method, const char *target, const char *headers,
	const void *body, size_t body_size);
struct http_answer http_get(uint16_t port, const char *target);
void http_free(struct http_answer *answer);
/* A value of /metrics. */
uint64_t http_metric(uint16_t port, const char *name);
/* Receives an answer of this status (0: none, and the end of the connection); drops it. */
void http_receive_status(int fd, bool to_end, unsigned status);
/* Status of the answer alone. */
unsigned http_status(uint16_t port, const char *method, const char *target, const char *headers);
/* Fails the test unless the answer has this status and its body contains `says` (NULL: anything). */
void http_expect(uint16_t port, const char *method, const char *target, const char *headers, unsigned status,
	const char *says);
