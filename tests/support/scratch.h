/* A folder of one run's own under build/tmp, and files in it: for tests that write packs and what they are
 * made of. */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/support/unit_test.h"

extern char scratch_root[256];

void scratch_open(const char *test);
/* The folder of this run, with all in it: a teardown. */
int scratch_close(void **state);
/* Path of a file in it; sixteen may be in use at a time. */
const char *in_root(const char *name);
FILE *open_text(const char *name);
void write_text(const char *name, const char *text);
/* All of it, which the caller frees. */
char *read_all(const char *name, size_t *size);
/* A plant as an OBJ file, Y up, with these first lines: a stem of that height, leaves around its upper half. */
void write_shrub(const char *path, const char *head, double height, int leaves);
