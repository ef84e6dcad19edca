/* Billboard clouds: what the section's files share, and `sheet`. */
#ifndef TESTS_BENCH_BILLBOARDS_H
#define TESTS_BENCH_BILLBOARDS_H

#include "tests/bench/bench.h"

/* Mean of a texture's opaque texels, darker than white. */
void bench_billboards_color(const struct eco_image *image, uint8_t rgb[3]);

/* A field of plants whose clouds have fewer billboards the further away they stand (figure 4, right), as the
 * picture `file`. `out` becomes the unit [plants in view of each level, vertices, vertices of full detail, Q,
 * Precision, Recall, owner_q]. */
#define BENCH_FIELD_LEVELS 4u
extern const uint32_t bench_field_caps[BENCH_FIELD_LEVELS];
enum eco_code bench_billboards_field(struct bench *bench, const struct bench_model *model, const char *file,
	const double epsilon[BENCH_FIELD_LEVELS], json_t **out, struct eco_error *error);

#endif
