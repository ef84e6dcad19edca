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

/* Checks every hash, decodes every chunk, compares counts, places with instance lists, what ladders ask with what lists hold. Each thing
 * that is damaged is one line to `out`; it goes on and counts. ECO_DAMAGED if there was any. */
struct inspect_counts { uint64_t lists, chunks, primitives, damaged; };
enum eco_code inspect_verify(const char *path, FILE *out, struct inspect_counts *counts, struct eco_error *error);

/* The ground of an open pack; each thing that does not hold is one text. Chunks that cannot be read are left out. */
void inspect_verify_ground(const struct eco_pack *pack, void (*say)(void *ctx, const char *text), void *ctx);

#endif
