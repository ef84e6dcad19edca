/* Permissions and caps of scenes: bearer tokens (RFC 6750) of scenes and of the operator, origins whose pages
 * may read answers (CORS), and the most that an answer may draw and take. A scene without a token is
 * everybody's. The operator's resources need the operator's token; without one, a request from this machine,
 * by no page and no proxy.
 *
 * Tokens are read from files, as everybody sees what a program is started with; they are compared in a time
 * that says nothing about them, and printed nowhere. */
#pragma once

#include "ecofiles/format/view.h"
#include "server/describe.h"

#define SRV_TOKENS_MAX 256u
#define SRV_TOKEN_BYTES_LEAST 16u
#define SRV_TOKEN_BYTES_MAX 128u
#define SRV_ORIGINS_MAX 16u
#define SRV_FRAMES_BYTES 1024u
#define SRV_CAPS_MAX 256u

struct srv_token { char scene[SRV_NAME_BYTES]; uint8_t bytes[SRV_TOKEN_BYTES_MAX]; };     /* 0s behind it */
/* A request for more is answered as if it asked for this. A cap of one scene goes before the one for all
 * (scene ""). */
struct srv_cap { char scene[SRV_NAME_BYTES]; uint64_t most; };
struct srv_cap_list { struct srv_cap items[SRV_CAPS_MAX]; uint32_t count; };
struct srv_access {                      /* all 0: everybody may do all */
	struct srv_token tokens[SRV_TOKENS_MAX]; uint32_t token_count;   /* scene "": the operator's */
	const char *origins[SRV_ORIGINS_MAX]; uint32_t origin_count;     /* "*": any */
	char frames[SRV_FRAMES_BYTES];   /* " ORIGIN ORIGIN": whose pages may have the viewer in a frame */
	/* the most that an answer of a scene draws and takes */
	struct srv_cap_list vertices, bytes;
};

/* Readers of options (struct eco_option). "SCENE=FILE", and FILE of the operator's: the first line of FILE is
 * a token, of letters, digits and -._~+/=. A scene may have several. */
enum eco_code srv_access_add_token(const char *argument, void *access, struct eco_error *error);
enum eco_code srv_access_add_operator(const char *file, void *access, struct eco_error *error);
/* "*", or "https://map.example:8443"; keeps the text. */
enum eco_code srv_access_add_origin(const char *origin, void *access, struct eco_error *error);
enum eco_code srv_access_add_frame(const char *origin, void *access, struct eco_error *error);

/* "N", or "SCENE=N", N above 0; the last of a scene holds. `list`: a struct srv_cap_list. */
enum eco_code srv_cap_add_vertices(const char *argument, void *list, struct eco_error *error);
enum eco_code srv_cap_add_bytes(const char *argument, void *list, struct eco_error *error);

struct srv_most srv_caps_of(const struct srv_access *access, const char *scene);

struct srv_sources;
/* ECO_BAD_USAGE names a scene that has a token or a cap, but is neither there nor named by an argument:
 * another may be the one that should have it. `before`: the scenes of an earlier start or reload, or NULL; a
 * file of one that has a token must not become one without. */
enum eco_code srv_access_check(const struct srv_access *access, const struct srv_store *store,
	const struct srv_sources *sources, const struct srv_store *before, struct eco_error *error);

/* `scene` "": the operator's resources. `authorization`: the header's value, or NULL. The operator's token
 * opens every scene. True if there is no token to have. */
bool srv_access_scene(const struct srv_access *access, const char *scene, const char *authorization);
bool srv_access_is_private(const struct srv_access *access, const char *scene);
bool srv_access_has_private(const struct srv_access *access);    /* any scene */

/* The value of Access-Control-Allow-Origin to a request of `origin` (NULL: of no page), or NULL. If all
 * have the same, it does not depend on the request. */
const char *srv_access_origin(const struct srv_access *access, const char *origin);
bool srv_access_origins_vary(const struct srv_access *access);
