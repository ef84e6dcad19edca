/* Looking into packs and models: `ecopack info`, `ecopack verify` and the text of `ecopack model`. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <jansson.h>

#include "ecofiles/format/pack.h"
#include "ecofiles/base/status.h"

/* A table for people, or JSON for scripts, to `out`. */
enum eco_code inspect_info(const char *path, bool json, FILE *out, struct eco_error *error);

/* Checks every hash, decodes every chunk, and compares counts, places with instance lists, and ladders
 * with their lists. Writes one line to `out` for each damage, and goes on. ECO_DAMAGED if there was any. */
struct inspect_counts { uint64_t lists, chunks, primitives, damaged; };
enum eco_code inspect_verify(const char *path, FILE *out, struct inspect_counts *counts,
	struct eco_error *error);

/* ---- Facts, which scripts read as JSON, for people ---- */

/* A line for each of these facts that there is; `keys` are separated by spaces. */
void inspect_lines(FILE *out, const json_t *facts, const char *keys);
/* A table of at most INSPECT_ROWS records: of an array, or of an object, whose keys come first under `title`.
 * No records, no table. */
#define INSPECT_ROWS 40u
void inspect_table(FILE *out, const char *title, const json_t *records, const char *keys);
