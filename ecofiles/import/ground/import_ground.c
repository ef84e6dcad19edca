/* Ground from rasters: a child process reads them (gdal_ground.c, gdal_image.c) and hands back struct
 * eco_ground and its samples, or squares of texels, through a pipe; both are checked here. */
#include "ecofiles/import/ground/import_ground.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/import/model/import_file.h"

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	return !gdal ? ECO_NOT_FOUND : gdal->ground_read(ctx, out, error);
}

/* The child's own verdict comes before what was missed here. `path` is for the message. */
static enum eco_code ground_finish(struct eco_guard *guard, bool whole, const char *path,
	struct eco_error *error)
{
	struct eco_error verdict = { .code = ECO_OK };
	enum eco_code code = eco_guard_finish(guard, &verdict);
	if (code)
		return eco_fail(error, code, "%s", verdict.text);
	return whole ? ECO_OK
		     : eco_fail(error, ECO_DAMAGED,
			       "%.300s: the data from its reader contradict each other",
			       path);
}

static bool get_ground(FILE *in, struct eco_ground *ground, struct eco_ground_job *job)
{
	struct eco_ground head;
	size_t count;
	if (fread(&job->notes, sizeof job->notes, 1, in) != 1 || fread(&head, sizeof head, 1, in) != 1
		|| head.columns < 2 || head.rows < 2 || head.columns > job->side_max
		|| head.rows > job->side_max || !(head.step_x_m > 0) || !(head.step_y_m > 0)
		|| !isfinite(head.x_m) || !isfinite(head.y_m))
		return false;
	count = (size_t)head.columns * head.rows;
	head.height_m = eco_alloc(count, sizeof *head.height_m);
	*ground = head;
	if (fread(ground->height_m, sizeof *ground->height_m, count, in) != count || fgetc(in) != EOF)
		return false;
	for (size_t i = 0; i < count; i++)
		if (!isfinite(ground->height_m[i]))
			return false;
	return true;
}

static void tell(const struct eco_ground_options *options, const struct eco_ground *ground,
	struct eco_ground_job *job)
{
	char text[400];
	eco_notes_tell(&job->notes, options->warn, options->ctx);
	if (ground->filled == 0 || !options->warn)
		return;
	snprintf(text, sizeof text, "%.250s: %llu of %llu samples have no height and were filled from their "
		"neighbours", options->source->heights[0], (unsigned long long)ground->filled,
		(unsigned long long)ground->columns * ground->rows);
	options->warn(options->ctx, text);
}

enum eco_code eco_raster_file_check(const char *path, struct eco_error *error)
{
	struct stat status;
	size_t size;
	if (access(path, R_OK) != 0 || stat(path, &status) != 0)
		return eco_fail_read(error, path, errno);
	if (!S_ISREG(status.st_mode))            /* folders are rasters of some formats */
		return ECO_OK;
	char *head = eco_file_read_head(path, &size);
	/* GDAL looks into zip files */
	enum eco_code code = eco_file_check_head(path, head, size, true, "a raster", error);
	free(head);
	return code;
}

struct eco_guard_limits eco_raster_limits(const char *const *paths, uint32_t count)
{
	struct eco_guard_limits limits = { 0 };
	for (uint32_t i = 0; i < count; i++)
		if (eco_guard_unpacks(paths[i]))
			limits.memory_bytes = eco_guard_small_memory(paths, count);
	return limits;
}

static enum eco_code check_files(char *const *paths, uint32_t count, struct eco_error *error)
{
	for (uint32_t i = 0; i < count; i++)
		ECO_PASS(eco_raster_file_check(paths[i], error));
	return ECO_OK;
}

enum eco_code eco_ground_import(struct eco_ground *ground, const struct eco_ground_options *options,
	struct eco_error *error)
{
	struct eco_ground_job job = { .options = options, .side_max = options->side_max };
	struct eco_guard *guard;
	FILE *result;
	*ground = (struct eco_ground){ .height_m = NULL };
	if (job.side_max < 2 || job.side_max > ECO_GROUND_SIDE_MAX)
		job.side_max = ECO_GROUND_SIDE_MAX;
	if (options->source->height_count == 0)
		return eco_fail(error, ECO_BAD_INPUT, "the ground names no raster");
	enum eco_code code = check_files(options->source->heights, options->source->height_count, error);
	struct eco_guard_limits limits = eco_raster_limits((const char *const *)options->source->heights,
		options->source->height_count);
	if (!code)
		code = eco_guard_start(&guard, work, &job, options->source->heights[0], &limits, &result,
			error);
	if (code)
		return code;
	code = ground_finish(guard, get_ground(result, ground, &job), options->source->heights[0], error);
	if (!code)
		tell(options, ground, &job);
	else
		eco_ground_free(ground);
	return code;
}

/* ---- The picture on the ground, square by square ---- */

struct eco_ground_image_reader {
	struct eco_ground_image_job job;
	struct eco_guard *guard;
	FILE *stream;
	bool begun;
	uint32_t open[GROUND_IMAGE_DEPTH], depth;        /* quarters to come, by depth */
};

static enum eco_code image_work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	return !gdal ? ECO_NOT_FOUND : gdal->ground_image_read(ctx, out, error);
}

/* For messages. */
static const char *name_of(const struct eco_ground_image_source *source)
{
	return source->file_count ? source->files[0] : "\"draw\"";
}

static enum eco_code start(struct eco_ground_image_reader *r, const struct eco_ground_image_options *options,
	bool only_look, struct eco_error *error)
{
	const struct eco_ground_image_source *source = options->source;
	*r = (struct eco_ground_image_reader){ .job = { .options = options, .only_look = only_look } };
	ECO_PASS(check_files(source->files, source->file_count, error));
	struct eco_guard_limits limits = eco_raster_limits((const char *const *)source->files,
		source->file_count);
	return eco_guard_start(&r->guard, image_work, &r->job, name_of(source), &limits, &r->stream, error);
}

static bool read_head(struct eco_ground_image_reader *r)
{
	struct ground_image_head *head = &r->job.head;
	return fread(head, sizeof *head, 1, r->stream) == 1 && isfinite(head->low[0])
		&& isfinite(head->low[1]) && head->texel_m > 0
		&& isfinite(head->texel_m);
}

static void warn_all(struct eco_ground_image_reader *r)
{
	eco_notes_tell(&r->job.head.notes, r->job.options->warn, r->job.options->ctx);
}

enum eco_code eco_ground_image_look(const struct eco_ground_image_options *options, struct eco_error *error)
{
	struct eco_ground_image_reader r;
	ECO_PASS(start(&r, options, true, error));
	enum eco_code code = ground_finish(r.guard, read_head(&r), name_of(options->source), error);
	if (!code)
		warn_all(&r);
	return code;
}

enum eco_code eco_ground_image_open(struct eco_ground_image_reader **reader,
	const struct eco_ground_image_options *options, struct eco_error *error)
{
	*reader = eco_alloc(1, sizeof **reader);
	enum eco_code code = start(*reader, options, false, error);
	if (code) {
		free(*reader);
		*reader = NULL;
	}
	return code;
}

enum eco_code eco_ground_image_next(struct eco_ground_image_reader *r, struct eco_ground_image_tile *tile,
	struct eco_error *error)
{
	bool good = r->begun || read_head(r);
	if (good && !r->begun)
		warn_all(r);
	r->begun = true;
	int split = good ? fgetc(r->stream) : EOF;
	good = good && (split == 0 || (split == 1 && r->depth + 1 < GROUND_IMAGE_DEPTH))
		&& (split || fread(tile->rgba, ECO_GROUND_IMAGE_BYTES, 1, r->stream) == 1);
	if (!good)
		return eco_fail(error, ECO_DAMAGED, "%.300s: its reader ended early",
			name_of(r->job.options->source));
	for (int k = 0; k < 2; k++)
		tile->low[k] = r->job.head.low[k];
	tile->texel_m = r->job.head.texel_m;
	tile->split = split;
	if (split)
		r->open[++r->depth] = 4;
	else
		while (r->depth && !--r->open[r->depth])
			r->depth--;
	return ECO_OK;
}

enum eco_code eco_ground_image_close(struct eco_ground_image_reader *r, struct eco_error *error)
{
	if (!r)
		return ECO_OK;
	enum eco_code code = ground_finish(r->guard, true, "", error);
	free(r);
	return code;
}
