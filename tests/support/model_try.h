/* Importing small files in tests. */
#pragma once

#include <math.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/support/input_files.h"
#include "tests/support/told.h"
#include "tests/support/unit_test.h"

/* The model that was imported last. */
extern struct eco_model m;

/* Imports one file, or options->paths where `path` is NULL; every triangle is kept or counted. The model
 * before is freed. */
void import_file(const char *path, const struct eco_model_options *options);
void import_refuses(const char *path, enum eco_code wanted, const char *says);
bool has_place(double x, double y, double z);
/* The model, by the keys in model_try.c; their number is a triangle. "at=x,y,z" or "at=x,y,z,u,v": a vertex is there. */
told_value model_told;
/* Reads models of a table of cases (tests/import/cases/model*.tsv) in a folder, and checks what is told of them. */
void expect_models(const char *folder, const char *table);
