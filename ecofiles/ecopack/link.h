/* `ecopack link`: packs that were built apart become one. Stored lists are copied; only the tiles above
 * them are made. */
#ifndef ECO_MAIN_LINK_H
#define ECO_MAIN_LINK_H

#include <stdint.h>

#include "ecofiles/base/status.h"

#define LINK_PARTS_MAX 4095u

struct link_options {
	const char *pack;            /* the target */
	const char *const *parts;    /* packs, at least one */
	uint32_t count;
	uint32_t jobs;               /* threads; 0: as many as there are processors */
};

/* The result equals, byte for byte, the pack that `ecopack make` builds from a scene that nests the parts'
 * scene files in this order, provided that no two parts nest the same file and none has ground. On failure
 * the target is untouched. */
enum eco_code link_packs(const struct link_options *options, struct eco_error *error);

#endif
