#include "client-min/view_measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/image.h"
#include "lod/raster/flip.h"

/* ---- Scores ---- */

#define CEILING_SAMPLES 8u

static enum eco_code count(const struct view_draw_job *job, const struct view_picture *picture,
	uint32_t samples, uint8_t *counts, struct eco_error *error)
{
	struct view_coverage coverage = { picture->width, picture->height, samples, counts };
	return view_reference_count(job, &coverage, error);
}

enum eco_code view_measure_soft(const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	if (!picture->soft)
		picture->soft = eco_alloc(picture->width, picture->height);
	return count(job, picture, VIEW_SOFT_SAMPLES, picture->soft, error);
}

enum eco_code view_measure_ceiling(const struct view_draw_job *job, const struct view_picture *reference,
	double *ceiling, struct eco_error *error)
{
	size_t pixels = (size_t)reference->width * reference->height;
	uint8_t *counts = eco_alloc(pixels, 1);
	enum eco_code code = count(job, reference, CEILING_SAMPLES, counts, error);
	if (!code)
		*ceiling = lod_q_ceiling(counts, reference->cover, pixels);
	free(counts);
	return code;
}

/* Mean change of bytes, and of blocks. */
static void find_change(uint32_t width, uint32_t height, const uint8_t *const rgb[2], double *bytes, double *pop)
{
	uint32_t count = lod_block_count(width, height);
	struct lod_block *blocks = eco_alloc(2 * (size_t)count, sizeof *blocks);
	uint64_t sum = 0;
	for (size_t i = 0; i < 3 * (size_t)width * height; i++)
		sum += (uint64_t)abs(rgb[0][i] - rgb[1][i]);
	for (int i = 0; i < 2; i++)
		lod_blocks_make(blocks + (size_t)i * count, width, height, rgb[i]);
	*bytes = (double)sum / (3.0 * width * height);
	*pop = lod_blocks_pop(blocks, blocks + count, count);
	free(blocks);
}

void view_measure_motion(uint32_t width, uint32_t height, const uint8_t *const rgb[2], const uint8_t *const truth[2],
	struct view_motion *motion)
{
	double bytes[2], pop[2];
	find_change(width, height, rgb, &bytes[0], &pop[0]);
	find_change(width, height, truth, &bytes[1], &pop[1]);
	*motion = (struct view_motion){ bytes[1] > 0 ? bytes[0] / bytes[1] : NAN, pop[1] > 0 ? pop[0] / pop[1] : NAN };
}

/* Colours and contrast of blocks. */
static void compare_blocks(const struct view_picture *picture, const struct view_picture *reference,
	struct lod_block_error *error)
{
	uint32_t count = lod_block_count(picture->width, picture->height);
	struct lod_block *blocks = eco_alloc(2 * (size_t)count, sizeof *blocks);
	lod_blocks_make(blocks, picture->width, picture->height, picture->rgb);
	lod_blocks_make(blocks + count, picture->width, picture->height, reference->rgb);
	lod_blocks_compare(error, blocks, blocks + count, count);
	free(blocks);
}

double view_picture_error(const struct view_picture *picture, const struct view_picture *reference)
{
	return lod_flip(&(struct lod_flip_input){ picture->width, picture->height, picture->rgb, reference->rgb,
		NULL });
}

void view_measure_pair(const struct view_picture *picture, const struct view_picture *reference,
	float *error_map, struct view_measures *measures)
{
	lod_score(&measures->score, &(struct lod_score_input){ picture->width, picture->height,
		picture->cover, reference->cover, picture->owner, reference->owner });
	measures->soft_q = picture->soft && reference->soft ? lod_soft_q(picture->soft, reference->soft,
		(size_t)picture->width * picture->height) : NAN;
	measures->picture_error = lod_flip(&(struct lod_flip_input){ picture->width, picture->height, picture->rgb,
		reference->rgb, error_map });
	compare_blocks(picture, reference, &measures->blocks);
}

/* ---- The truth ---- */

/* Another build may draw other bits. */
static uint64_t program_hash(void)
{
	uint64_t hash = 0;
	uint8_t *program;
	size_t size;
	if (!eco_file_read("/proc/self/exe", UINT32_MAX, &program, &size, NULL)) {
		hash = XXH3_64bits(program, size);
		free(program);
	}
	return hash;
}

static void find_path(const struct view_draw_job *job, const char *dir, const struct view_picture *picture,
	char *path, size_t size)
{
	const struct view_sky *sky = &job->selection->sky;
	const struct lod_eye *eye = job->eye;
	const double view[] = { eye->at[0], eye->at[1], eye->at[2], eye->forward[0], eye->forward[1],
		eye->forward[2], eye->up[0], eye->up[1], eye->up[2], eye->tan_y, picture->width,
		picture->height, job->tint, (double)sky->sun[0], (double)sky->sun[1], (double)sky->sun[2],
		sky->haze_m, sky->shadows, sky->shadow_size };
	XXH3_state_t *state = XXH3_createState();
	uint64_t program = program_hash();
	const struct eco_chunk_id *pack = view_store_pack(job->store);
	if (!state)
		eco_end("no memory");
	XXH3_64bits_reset(state);
	XXH3_64bits_update(state, &program, sizeof program);
	XXH3_64bits_update(state, view, sizeof view);
	if (pack)
		XXH3_64bits_update(state, pack, sizeof *pack);
	snprintf(path, size, "%s/%016llx.png", dir, (unsigned long long)XXH3_64bits_digest(state));
	XXH3_freeState(state);
}

static bool take_kept(const char *path, struct view_picture *picture)
{
	struct eco_image image = { 0 };
	bool kept = access(path, R_OK) == 0 && !eco_image_read(&image, path, NULL)
		&& image.width == picture->width && image.height == picture->height;
	for (size_t i = 0; kept && i < (size_t)image.width * image.height; i++)
		memcpy(picture->rgb + 3 * i, image.rgba + 4 * i, 3);
	free((void *)image.rgba);
	return kept;
}

enum eco_code view_truth_draw(const struct view_draw_job *job, const char *dir, struct view_picture *picture,
	double *cpu_ms, struct eco_error *error)
{
	char path[4096];
	clock_t start = clock();
	struct view_picture fine = { 0 };
	*cpu_ms = 0;
	if (dir) {
		find_path(job, dir, picture, path, sizeof path);
		if (take_kept(path, picture))
			return ECO_OK;
	}
	enum eco_code code = view_picture_init(&fine, picture->width, picture->height, error);
	if (!code)
		code = view_reference_fine(job, VIEW_TRUTH_SIDE, &fine, error);
	if (!code) {
		memcpy(picture->rgb, fine.rgb, 3 * (size_t)picture->width * picture->height);
		*cpu_ms = 1e3 * (double)(clock() - start) / CLOCKS_PER_SEC;
	}
	if (!code && dir)
		code = eco_png_write(&(struct eco_pixels){ picture->width, picture->height, 3, picture->rgb }, path,
			error);
	view_picture_free(&fine);
	return code;
}
