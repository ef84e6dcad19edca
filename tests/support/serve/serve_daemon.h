/* A daemon on a loopback socket that serves the sample scene, for the tests of server/. */
#pragma once

#include <jansson.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/exchange.h"
#include "server/request/query.h"
#include "server/site.h"
#include "tests/support/serve/http_client.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

/* plans of so small a scene would be bounded where they have hardly begun */
#define SAMPLE_PLAN_TIMES 100
#define BASE "/v1/scenes/sample"
#define VIEW "eye=50,-30,12&target=50,30,2&width=400&height=300"
#define VIEW_BY(vertices) VIEW "&vertices=" vertices
#define OCTETS "Content-Type: application/octet-stream\r\n"
#define HOST "Host: t\r\n"
#define STREAM "POST " BASE "/stream?" VIEW_BY("1") " HTTP/1.1\r\n" HOST OCTETS
#define NOTHING_HELD "\0\0\0\0", 4

extern struct srv_store store;
extern const struct srv_site sample_site;  /* a page; what its compressed forms hold is not compressed */
extern struct srv_daemon *daemon_;
extern uint16_t port;
extern char pack_path[64];         /* tests run at the same time, each with a pack of its own */

const struct eco_scene *scene(void);
int serve_start(void **state);
int serve_stop(void **state);
void assert_header(const struct http_answer *answer, const char *name, const char *expected);
json_t *json_of(const struct http_answer *answer);
void chunk_target(char target[128], const struct eco_scene *tables, uint32_t chunk);
/* Another daemon, of the same store, with these members of its configuration. */
#define SERVE_ANOTHER(...) serve_another(&(struct srv_config){ .listen = "127.0.0.1:0", ##__VA_ARGS__ })
struct srv_daemon *serve_another(const struct srv_config *config);
static inline uint16_t srv_daemon_port(const struct srv_daemon *daemon) { return daemon->endpoint.port; }
/* GET of JSON, with status 200; a number of an object. */
json_t *json_get(const char *target);
int64_t count_in(const json_t *json, const char *key);

#define WAIT_UNTIL(condition) while (!(condition)) usleep(1000)
