/* Packs that were built apart become one: `ecopack link`. What they hold is taken as it is stored; only what lies above them is made. */
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

/* The pack is that which `ecopack make` builds, byte for byte, from a scene that nests the parts' scene files in this order, as long as
 * no two parts nest the same file and none has ground. On failure the target is untouched. */
enum eco_code link_packs(const struct link_options *options, struct eco_error *error);

#endif
