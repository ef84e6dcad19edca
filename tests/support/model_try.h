/* Importing small files in tests: what was said on the way is in `import_said`. */
#ifndef TESTS_MODEL_TRY_H
#define TESTS_MODEL_TRY_H

#include <math.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

extern char import_said[8000];

/* Imports one file, or options->paths where `path` is NULL; every triangle is kept or counted. The model is
 * freed first: it is a whole one or all zero. */
void import_file(struct eco_model *model, const char *path, const struct eco_model_options *options);
void import_refuses(const char *path, enum eco_code wanted, const char *says);
void import_says(const char *text);
bool close_to(double a, double b, double most);
bool has_place(const struct eco_model *m, double x, double y, double z);
const struct eco_material *material_of(const struct eco_model *m, const char *name);

#endif
