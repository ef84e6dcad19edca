/* The most that an answer of a scene may draw and take, whatever is asked for: a request above it is answered
 * as if it had asked for that much. The scene's description states both. A cap of one scene goes before the
 * one for all. */
#ifndef SRV_CAPS_H
#define SRV_CAPS_H

#include "ecofiles/base/options.h"
#include "ecofiles/format/view.h"
#include "server/store.h"

#define SRV_CAPS_MAX 256u

struct srv_cap { char scene[SRV_NAME_BYTES]; uint64_t most; };   /* scene "": all */
struct srv_cap_list { struct srv_cap items[SRV_CAPS_MAX]; uint32_t count; };
struct srv_caps { struct srv_cap_list vertices, bytes; };        /* 0: none */

/* "N", or "SCENE=N", N above 0 and read as an option of `kind`; the last of a scene holds. `option`: what errors
 * call it. */
enum eco_code srv_cap_add(struct srv_cap_list *list, const char *argument, enum eco_option_kind kind,
	const char *option, struct eco_error *error);
struct srv_sources;
/* ECO_BAD_USAGE names a scene that has a cap, but is neither there nor named by an argument. */
enum eco_code srv_caps_check(const struct srv_caps *caps, const struct srv_store *store,
	const struct srv_sources *sources, struct eco_error *error);

/* Caps of a scene's answers; UINT64_MAX: no cap. `caps` NULL: no scene has one. */
struct srv_most { uint64_t vertices, bytes; };
struct srv_most srv_caps_of(const struct srv_caps *caps, const char *scene);
void srv_caps_apply(const struct srv_most *most, struct eco_request *request);

#endif
