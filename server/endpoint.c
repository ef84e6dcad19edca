#include "server/daemon.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/request/query.h"

#define BACKLOG 1024
#define HANDED_OVER 3            /* the first descriptor that systemd passes on */

static enum eco_code split_listen(const char *listen_at, char host[NI_MAXHOST], char port[8],
	struct eco_error *error)
{
	const char *colon = strrchr(listen_at, ':');
	size_t size = colon ? (size_t)(colon - listen_at) : 0;
	bool brackets = size >= 2 && listen_at[0] == '[' && listen_at[size - 1] == ']';
	uint64_t number;
	if (!colon || size == 0 || size >= NI_MAXHOST || !srv_parse_count(colon + 1, &number)
			|| number > 65535
		|| (!brackets && memchr(listen_at, ':', size)))
		return eco_fail(error, ECO_BAD_USAGE, "--listen: '%.80s' is not HOST:PORT, as "
			"127.0.0.1:8080, [::1]:8080, or port 0 for any", listen_at);
	snprintf(host, NI_MAXHOST, "%.*s", (int)(size - 2 * brackets), listen_at + brackets);
	snprintf(port, 8, "%u", (unsigned)number);
	return ECO_OK;
}

enum eco_code srv_endpoint_check(const char *listen_at, struct eco_error *error)
{
	char host[NI_MAXHOST], port[8];
	return split_listen(listen_at ? listen_at : SRV_LISTEN_DEFAULT, host, port, error);
}

static enum eco_code bind_to(int fd, const struct addrinfo *at, const char *listen_at,
	struct eco_error *error)
{
	int on = 1;
	setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
	if (at->ai_family == AF_INET6)
		setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
	if (bind(fd, at->ai_addr, at->ai_addrlen) == 0 && listen(fd, BACKLOG) == 0)
		return ECO_OK;
	return eco_fail(error, ECO_IO, "cannot listen on %s: %s%s", listen_at, strerror(errno),
		errno == EADDRINUSE
		? "; stop what listens there, or choose another port with --listen HOST:PORT (port 0: any)"
		: errno == EACCES ? "; ports below 1024 need privileges: choose a higher one with --listen"
		: "");
}

static void name_endpoint(struct srv_endpoint *endpoint)
{
	struct sockaddr_storage address = { 0 };
	socklen_t size = sizeof address;
	char host[NI_MAXHOST] = "?", port[8] = "0";
	getsockname(endpoint->fd, (struct sockaddr *)&address, &size);
	getnameinfo((struct sockaddr *)&address, size, host, sizeof host, port, sizeof port,
		NI_NUMERICHOST | NI_NUMERICSERV);
	endpoint->port = (uint16_t)atoi(port);
	snprintf(endpoint->url, sizeof endpoint->url, address.ss_family == AF_INET6 ? "http://[%s]:%s"
		: "http://%s:%s", host, port);
}

enum eco_code srv_endpoint_open(struct srv_endpoint *endpoint, const char *listen_at, struct eco_error *error)
{
	char host[NI_MAXHOST], port[8];
	struct addrinfo hints = { .ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE | AI_NUMERICSERV },
		*found;
	listen_at = listen_at ? listen_at : SRV_LISTEN_DEFAULT;
	*endpoint = (struct srv_endpoint){ .fd = -1 };
	ECO_PASS(split_listen(listen_at, host, port, error));
	int failed = getaddrinfo(host, port, &hints, &found);
	if (failed)
		return eco_fail(error, ECO_IO, "--listen: '%s' names no address of this machine: %s", host,
			gai_strerror(failed));
	endpoint->fd = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	enum eco_code code = endpoint->fd < 0 ? eco_fail(error, ECO_IO, "cannot open a socket: %s", strerror(errno))
		: bind_to(endpoint->fd, found, listen_at, error);
	freeaddrinfo(found);
	if (!code)
		name_endpoint(endpoint);
	else if (endpoint->fd >= 0)
		close(endpoint->fd);
	endpoint->fd = code ? -1 : endpoint->fd;
	return code;
}

/* How many sockets systemd has handed over to this process: the variables may be another's. */
static uint64_t count_handed_over(void)
{
	const char *to = getenv("LISTEN_PID"), *many = getenv("LISTEN_FDS");
	uint64_t process, count;
	bool ours = to && many && srv_parse_count(to, &process) && process == (uint64_t)getpid()
		&& srv_parse_count(many, &count);
	unsetenv("LISTEN_PID");
	unsetenv("LISTEN_FDS");
	unsetenv("LISTEN_FDNAMES");
	return ours ? count : 0;
}

static bool listens_on_tcp(int fd)
{
	struct sockaddr_storage address = { 0 };
	socklen_t size = sizeof address, bytes = sizeof(int);
	int listens = 0, type = 0;
	return getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &bytes) == 0 && listens
		&& getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &bytes) == 0 && type == SOCK_STREAM
		&& getsockname(fd, (struct sockaddr *)&address, &size) == 0
		&& (address.ss_family == AF_INET || address.ss_family == AF_INET6);
}

enum eco_code srv_endpoint_take(struct srv_endpoint *endpoint, const char *listen_at, struct eco_error *error)
{
	uint64_t count = count_handed_over();
	if (!count)
		return srv_endpoint_open(endpoint, listen_at, error);
	*endpoint = (struct srv_endpoint){ .fd = -1 };
	if (listen_at)
		return eco_fail(error, ECO_BAD_USAGE, "--listen %.80s: systemd has handed a socket over, "
			"too: leave out --listen, or the socket unit", listen_at);
	if (count > 1 || !listens_on_tcp(HANDED_OVER))
		return eco_fail(error, ECO_BAD_USAGE, "systemd has handed over %s: the socket unit must have "
			"one ListenStream= with a port, as 443 or [::]:8080 (both families: "
			"BindIPv6Only=both)", count > 1 ? "more than one socket" : "what is no TCP socket "
			"that listens");
	endpoint->fd = HANDED_OVER;
	if (fcntl(endpoint->fd, F_SETFD, FD_CLOEXEC) || fcntl(endpoint->fd, F_SETFL, O_NONBLOCK))
		return eco_fail(error, ECO_IO, "the socket that systemd has handed over: %s", strerror(errno));
	name_endpoint(endpoint);
	return ECO_OK;
}
