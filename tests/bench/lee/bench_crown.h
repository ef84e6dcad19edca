/* A broad-leaved tree with exactly 6,143 leaves, as many as Lee's: for the table of bench_lee.c. */
#ifndef TESTS_BENCH_CROWN_H
#define TESTS_BENCH_CROWN_H

#include "ecofiles/format/model.h"

#define BENCH_CROWN_LEAVES 6143u

/* The caller frees it with eco_model_free. */
enum eco_code bench_crown_make(struct eco_model *model, struct eco_error *error);
/* Writes FOLDER/NAME.obj and .mtl. */
enum eco_code bench_crown_write(const char *folder, const char *name, struct eco_error *error);

#endif
