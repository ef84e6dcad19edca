/* Looking into packs: `ecopack info` and `ecopack verify`. */
#ifndef ECO_MAIN_INSPECT_H
#define ECO_MAIN_INSPECT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "ecofiles/format/pack.h"
#include "ecofiles/base/status.h"

/* A table for people, or JSON for scripts, to `out`. */
enum eco_code inspect_info(const char *path, bool json, FILE *out, struct eco_error *error);

/* Checks every hash, decodes every chunk, and compares counts, places with instance lists, and ladders
 * with their lists. Writes one line to `out` for each damage, and goes on. ECO_DAMAGED if there was any. */
struct inspect_counts { uint64_t lists, chunks, primitives, damaged; };
enum eco_code inspect_verify(const char *path, FILE *out, struct inspect_counts *counts,
	struct eco_error *error);

#endif
