/* Pictures of full detail that are kept in the cache. Sections look at the same views of the same packs, and
 * one such picture takes up to a minute of processor time.
 *
 *   bench_reference_path(bench, pack, view, sees, path)
 *   if (!bench_reference_read(path, &reference))
 *       draw it; bench_reference_write(path, &reference, &error)
 *
 * A file is a zstd frame with a checksum: a head of eight 64-bit words, then the picture's arrays. It is read
 * on the machine that wrote it. */
#ifndef TESTS_BENCH_REFERENCE_H
#define TESTS_BENCH_REFERENCE_H

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench.h"

#define BENCH_REFERENCE_PATH 1024

struct bench_reference {
	struct view_picture picture; /* soft is NULL where samples were not counted */
	double ceiling;              /* NaN where it was not measured */
	uint32_t summaries;          /* tiles that are points in it */
};

/* Its name in the cache: from the pack's content, the view, whether samples are counted (`sees`), and the
 * objects that draw. False where the content is not known: of packs that bench_scene did not build. */
bool bench_reference_path(const struct bench *bench, const char *pack, const struct eco_view *view, bool sees,
	char path[BENCH_REFERENCE_PATH]);
/* The caller frees the picture. False where there is none, or a damaged one. */
bool bench_reference_read(const char *path, struct bench_reference *reference);
enum eco_code bench_reference_write(const char *path, const struct bench_reference *reference,
	struct eco_error *error);

#endif
