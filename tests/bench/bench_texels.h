/* Colours of textures by coders of pictures: bytes and error at some settings.
 *
 *   texels_code(&trial, bench, TEXELS_WEBP, &colors, &outline, 0, &error);       of each setting
 *   bytes = texels_bytes_at(trials, count, error_of_what_is_stored);
 *
 * WebP is libwebp's, called as packs are made. The others are programs of Debian 12 that a child process runs:
 * avifenc and avifdec (package libavif-bin; libaom writes, dav1d reads), cjxl and djxl (libjxl-tools). */
#ifndef TESTS_BENCH_TEXELS_H
#define TESTS_BENCH_TEXELS_H

#include "ecofiles/format/texture.h"
#include "tests/bench/bench.h"

enum texels_coder { TEXELS_WEBP, TEXELS_AVIF_420, TEXELS_AVIF_444, TEXELS_JXL, TEXELS_CODERS };
extern const char *const texels_names[TEXELS_CODERS];
#define TEXELS_SETTINGS 7u

/* `head`: bytes of a file beside its coded picture, where a client could put them back; error: of sRGB bytes,
 * root of the mean square over opaque texels and channels. */
struct texels_trial { double bytes, head, error; };

/* False: the coder's programs are not there. */
bool texels_coder_is_there(enum texels_coder coder);
/* `setting`: below TEXELS_SETTINGS, from coarse to fine; TEXELS_WEBP has one, that of packs. */
enum eco_code texels_code(struct texels_trial *trial, struct bench *bench, enum texels_coder coder,
	const struct eco_texture_part *colors, const struct eco_texture_part *outline, uint32_t setting,
	struct eco_error *error);

/* NaN where nothing is opaque. */
double texels_error(const struct eco_texture_part *a, const struct eco_texture_part *b,
	const struct eco_texture_part *outline);
/* Between the two trials whose errors lie around `error`: log(bytes) is linear in log(error). *nearest: the
 * trial whose error is the nearer. NaN where no two lie around it. */
double texels_bytes_at(const struct texels_trial *trials, uint32_t count, double error, uint32_t *nearest);
/* Bytes of an AVIF file that are not in its box of coded data ("mdat"). */
size_t texels_avif_head(const uint8_t *bytes, size_t size);

#endif
