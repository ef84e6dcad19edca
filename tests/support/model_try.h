/* Importing small files in tests: what was said on the way is in `import_said`. */
#ifndef TESTS_MODEL_TRY_H
#define TESTS_MODEL_TRY_H

#include <math.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

extern char import_said[8192];
void import_note(void *ctx, const char *text);       /* adds to it */
/* The model that was imported last. */
extern struct eco_model m;

/* Imports one file, or options->paths where `path` is NULL; every triangle is kept or counted. The model
 * before is freed. */
void import_file(const char *path, const struct eco_model_options *options);
void import_high(const char *path, double height_m);
void import_refuses(const char *path, enum eco_code wanted, const char *says);
void import_says(const char *text);
bool close_to(double a, double b, double most);
bool has_place(double x, double y, double z);
const struct eco_material *material_of(const char *name);
/* Checks of what was read. `wanted` is parted by "|": "key=value", numbers in it parted by commas and equal but for
 * rounding to float; "~text": this was said; "!text": it was not. A number may follow the key: "rgb0=255,0,0". */
typedef void told_value(const char *key, uint32_t number, const char *wanted, char *to, size_t size);
void expect_told(const char *wanted, told_value *value_of);
/* The model, by the keys in model_try.c; their number is a triangle. "at=x,y,z" or "at=x,y,z,u,v": a vertex is there. */
told_value model_told;
void expect_model(const char *wanted);
/* Files of a model and what import makes of them. */
struct model_case {
	const char *name;                    /* of the property; NULL: as above */
	const char *file, *text;             /* text NULL: it is there; ' stands for " in JSON */
	const char *beside, *beside_text;    /* a file beside it, or NULL; removed afterwards */
	struct eco_model_options options;
	const char *wanted;
};
void expect_models(const char *folder, const struct model_case *cases, size_t count);
/* Whether a vertex at that place, with that uv where uv is asked for, is there. */
bool has_vertex(double x, double y, double z, const float *uv);

#endif
