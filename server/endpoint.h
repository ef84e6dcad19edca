/* The socket that takes connections: opened here, or handed over by systemd, which keeps it while the server is started again; before the server gives up its
 * privileges, as ports below 1024 need some. */
#ifndef SRV_ENDPOINT_H
#define SRV_ENDPOINT_H

#include <netdb.h>
#include <stdint.h>
#include <sys/socket.h>

#include "ecofiles/base/status.h"

#define SRV_LISTEN_DEFAULT "127.0.0.1:8080"

struct srv_endpoint {
	int fd;                          /* listens, nonblocking */
	uint16_t port;
	char url[NI_MAXHOST + 24];       /* "http://127.0.0.1:8080": with the port that was bound */
};

/* Is it HOST:PORT? NULL is fine. */
enum eco_code srv_endpoint_check(const char *listen, struct eco_error *error);
/* NULL: SRV_LISTEN_DEFAULT. Errors say what was wrong with the address, or who may hold the port. The caller
 * closes the descriptor; it is -1 on failure. */
enum eco_code srv_endpoint_open(struct srv_endpoint *endpoint, const char *listen, struct eco_error *error);
/* The same, but where systemd hands a socket over (LISTEN_FDS, as sd_listen_fds(3) describes it) that one,
 * and then `listen` must be NULL. Called once, by a program's main thread: the environment forgets it. */
enum eco_code srv_endpoint_take(struct srv_endpoint *endpoint, const char *listen, struct eco_error *error);

#endif
