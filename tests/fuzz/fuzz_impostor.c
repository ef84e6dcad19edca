/* Levels of impostors, with the body before them: what is read can be written, and is then read as the same;
 * and drawn. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "lod/impostor.h"

#define LEVEL_AT 24u                     /* of its bytes: after the body */
#define FINE_EVERY 32u                   /* sizes of inputs of which one may be of a finer level */

static void assert_same(const struct eco_impostor_level *a, const struct eco_impostor_level *b)
{
	const struct eco_impostor_size *s = &eco_impostor_sizes[a->level];
	size_t tiles = eco_impostor_tiles(s->set), few = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	assert(a->level == b->level && memcmp(a->texel, b->texel, tiles * s->texels * s->texels) == 0);
	assert(memcmp(a->depth, b->depth, tiles * s->depths * s->depths) == 0);
	assert(memcmp(a->color, b->color, few * s->colors * s->colors * 3) == 0);
}

static void look_around(const struct lod_impostor *impostor)
{
	for (int i = 0; i < 27; i++) {
		const float far = 3 * impostor->radius, eye[3] = { far * (float)(i % 3 - 1),
			far * (float)(i / 3 % 3 - 1), far * (float)(i / 9 - 1) }, ray[3] = { -eye[0], -eye[1],
			-eye[2] };
		struct lod_impostor_look look;
		struct lod_impostor_hit hit;
		lod_impostor_look(&look, impostor, eye);
		assert(!lod_impostor_hit(impostor, &look, ray, &hit) || hit.cell < impostor->cell_count);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_impostor_body body;
	struct eco_impostor_level level, again;
	struct lod_impostor impostor;
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
	/* code that all levels share takes 3 ms for the coarsest, 36 and 180 ms for those after it */
	if (size > LEVEL_AT && bytes[LEVEL_AT] > (size % FINE_EVERY == 0))
		return 0;
#endif
	enum eco_code code = eco_impostor_level_read(&level, &body, bytes, size, &error);
	assert(code == error.code);
	if (code)
		return 0;
	struct eco_writer w = { 0 };
	code = eco_impostor_level_write(&w, &body, &level, NULL, &error);
	assert(!code);
	if (w.size != size || memcmp(w.bytes, bytes, size) != 0) { /* else it would be read as before */
		code = eco_impostor_level_read(&again, &body, w.bytes, w.size, &error);
		assert(!code);
		assert_same(&level, &again);
		eco_impostor_level_free(&again);
	}
	code = lod_impostor_open(&impostor, &body, &level, &error);
	assert(!code);
	look_around(&impostor);
	lod_impostor_close(&impostor);
	eco_impostor_level_free(&level);
	eco_writer_free(&w);
	return 0;
}
