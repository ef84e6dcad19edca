#include "client-min/view_measure.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

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

void view_measure_motion(uint32_t width, uint32_t height, const uint8_t *const rgb[2],
	const uint8_t *const truth[2], struct view_motion *motion)
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
	return lod_flip(&(struct lod_flip_input){ picture->width, picture->height, picture->rgb,
		reference->rgb, NULL });
}

void view_measure_pair(const struct view_picture *picture, const struct view_picture *reference,
	float *error_map, struct view_measures *measures)
{
	lod_score(&measures->score, &(struct lod_score_input){ picture->width, picture->height,
		picture->cover, reference->cover, picture->owner, reference->owner });
	measures->soft_q = picture->soft && reference->soft ? lod_soft_q(picture->soft, reference->soft,
		(size_t)picture->width * picture->height) : NAN;
	measures->picture_error = lod_flip(&(struct lod_flip_input){ picture->width, picture->height,
		picture->rgb, reference->rgb, error_map });
	compare_blocks(picture, reference, &measures->blocks);
}

/* ---- The truth ---- */

/* The name of a kept truth is VIEW-DRAWING-MS.png: two hashes, and the processor time. */
#define VIEW_LETTERS 17u
#define NAME_LETTERS 34u

/* Draws the view roughly, for its hash: another build, or another light, may draw other bits. */
static enum eco_code name_truth(const struct view_draw_job *job, struct view_picture *rough,
	char name[NAME_LETTERS + 1], struct eco_error *error)
{
	const struct view_sky *sky = &job->selection->sky;
	const struct lod_eye *eye = job->eye;
	const struct eco_chunk_id *pack = view_store_pack(job->store);
	const double numbers[] = { eye->at[0], eye->at[1], eye->at[2], eye->forward[0], eye->forward[1],
		eye->forward[2], eye->up[0], eye->up[1], eye->up[2], eye->tan_y, rough->width,
		rough->height, job->tint, (double)sky->sun[0], (double)sky->sun[1], (double)sky->sun[2],
		sky->haze_m, sky->shadows, sky->shadow_size, VIEW_TRUTH_SIDE };
	uint64_t view = XXH3_64bits(numbers, sizeof numbers);
	struct view_draw_job two = *job;
	two.samples = 2;
	enum eco_code code = view_reference_draw(&two, rough, error);
	if (pack)
		view = XXH3_64bits_withSeed(pack, sizeof *pack, view);
	snprintf(name, NAME_LETTERS + 1, "%016llx-%016llx-", (unsigned long long)view,
		(unsigned long long)XXH3_64bits(rough->rgb, 3 * (size_t)rough->width * rough->height));
	return code;
}

/* Looks for the truth of this name, and removes those of its view that were drawn otherwise. */
static bool find_kept(const char *dir, const char *name, char *path, size_t size, double *cpu_ms)
{
	DIR *all = opendir(dir);
	bool found = false;
	for (const struct dirent *entry; all && (entry = readdir(all));) {
		const char *end = strrchr(entry->d_name, '.');
		if (strncmp(entry->d_name, name, VIEW_LETTERS) || !end || strcmp(end, ".png"))
			continue;
		bool same = strncmp(entry->d_name, name, NAME_LETTERS) == 0;
		if (!same)
			unlinkat(dirfd(all), entry->d_name, 0);
		else if (snprintf(path, size, "%s/%s", dir, entry->d_name) < (int)size)
			*cpu_ms = strtod(entry->d_name + NAME_LETTERS, NULL);
		found |= same;
	}
	if (all)
		closedir(all);
	return found;
}

static bool take_kept(const char *path, struct view_picture *picture)
{
	struct eco_image image = { 0 };
	bool kept = !eco_image_read(&image, path, NULL) && image.width == picture->width
		&& image.height == picture->height;
	for (size_t i = 0; kept && i < (size_t)image.width * image.height; i++)
		memcpy(picture->rgb + 3 * i, image.rgba + 4 * i, 3);
	free((void *)image.rgba);
	return kept;
}

static enum eco_code draw_truth(const struct view_draw_job *job, struct view_picture *fine,
	struct view_picture *picture, double *cpu_ms, struct eco_error *error)
{
	clock_t start = clock();
	enum eco_code code = view_reference_fine(job, VIEW_TRUTH_SIDE, fine, error);
	if (!code)
		memcpy(picture->rgb, fine->rgb, 3 * (size_t)picture->width * picture->height);
	*cpu_ms = round(1e3 * (double)(clock() - start) / CLOCKS_PER_SEC);
	return code;
}

enum eco_code view_truth_draw(const struct view_draw_job *job, const char *dir, struct view_picture *picture,
	double *cpu_ms, struct eco_error *error)
{
	char name[NAME_LETTERS + 1], path[4096];
	struct view_picture fine = { 0 };
	enum eco_code code = view_picture_init(&fine, picture->width, picture->height, error);
	*cpu_ms = 0;
	if (!code && dir)
		code = name_truth(job, &fine, name, error);
	if (!code && !(dir && find_kept(dir, name, path, sizeof path, cpu_ms) && take_kept(path, picture))) {
		code = draw_truth(job, &fine, picture, cpu_ms, error);
		const struct eco_pixels pixels = { picture->width, picture->height, 3, picture->rgb };
		if (!code && dir && snprintf(path, sizeof path, "%s/%s%.0f.png", dir, name, *cpu_ms)
				< (int)sizeof path)
			code = eco_png_write(&pixels, path, error);
	}
	view_picture_free(&fine);
	return code;
}
