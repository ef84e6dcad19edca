#include "client-min/view_truth.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/image.h"

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
