/* The child process (gdal_image.c) hands squares back through a pipe; what comes is checked here. */
#include "ecofiles/import/ground/import_ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/module.h"

struct eco_ground_image_reader {
	struct eco_ground_image_job job;
	struct eco_guard *guard;
	FILE *stream;
	bool begun;
	uint32_t open[GROUND_IMAGE_DEPTH], depth;        /* quarters to come, by depth */
};

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	return !gdal ? ECO_NOT_FOUND : gdal->ground_image_read(ctx, out, error);
}

static enum eco_code start(struct eco_ground_image_reader *r, const struct eco_ground_image_options *options,
	bool only_look, struct eco_error *error)
{
	const struct eco_ground_image_source *source = options->source;
	*r = (struct eco_ground_image_reader){ .job = { .options = options, .only_look = only_look } };
	for (uint32_t i = 0; i < source->file_count; i++) {
		enum eco_code code = eco_raster_file_check(source->files[i], error);
		if (code)
			return code;
	}
	struct eco_guard_limits limits = eco_raster_limits((const char *const *)source->files,
		source->file_count);
	return eco_guard_start(&r->guard, work, &r->job, source->files[0], &limits, &r->stream, error);
}

static bool read_head(struct eco_ground_image_reader *r)
{
	struct ground_image_head *head = &r->job.head;
	return fread(head, sizeof *head, 1, r->stream) == 1 && ground_notes_end(&head->notes)
		&& isfinite(head->low[0]) && isfinite(head->low[1]) && head->texel_m > 0
		&& isfinite(head->texel_m);
}

static void warn_all(const struct eco_ground_image_reader *r)
{
	ground_notes_tell(&r->job.head.notes, r->job.options->warn, r->job.options->ctx);
}

enum eco_code eco_ground_image_look(const struct eco_ground_image_options *options, struct eco_error *error)
{
	struct eco_ground_image_reader r;
	enum eco_code code = start(&r, options, true, error);
	if (code)
		return code;
	code = ground_finish(r.guard, read_head(&r), options->source->files[0], error);
	if (!code)
		warn_all(&r);
	return code;
}

enum eco_code eco_ground_image_open(struct eco_ground_image_reader **reader,
	const struct eco_ground_image_options *options, struct eco_error *error)
{
	*reader = malloc(sizeof **reader);
	if (!*reader)
		return eco_fail(error, ECO_NO_MEMORY, "no memory to read the ground's image");
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
			r->job.options->source->files[0]);
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

void eco_ground_image_source_free(struct eco_ground_image_source *source)
{
	for (uint32_t i = 0; i < source->file_count; i++)
		free(source->files[i]);
	free(source->files);
	free(source->crs);
	free(source->classes);
	*source = (struct eco_ground_image_source){ .files = NULL };
}
