/* What stands beside first visits of ours in the section `bytes`: all chunks at once, the plants of the view
 * as glTF, and a still picture.
 *
 *   bench_beside_open(&beside, bench, &error);
 *   bench_beside_rows(beside, &view, &rows, &error);        for each view, scene by scene
 *   bench_beside_close(beside); */
#ifndef TESTS_BENCH_BESIDE_H
#define TESTS_BENCH_BESIDE_H

#include "tests/bench/pictures/bench_views.h"

extern const char bench_beside_chunks[], bench_beside_gltf[], bench_beside_fast[], bench_beside_webp[];

struct bench_beside;
/* Says in the report what the methods are, and which tool is missing. */
enum eco_code bench_beside_open(struct bench_beside **beside, struct bench *bench, struct eco_error *error);
void bench_beside_close(struct bench_beside *beside);                    /* NULL is fine */

/* An array, made or recalled: rows with method (one of those above), setting, bytes, picture_error and, null
 * where they have no meaning, vertices, q, skill, owner_q. Rows of a method stand together, by ascending
 * bytes. Borrowed. */
enum eco_code bench_beside_rows(struct bench_beside *beside, const struct bench_view *view, json_t **rows,
	struct eco_error *error);

#endif
