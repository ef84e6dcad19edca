/* Reading a model: in a child process, for assimp and the image readers have open vulnerabilities; the soup comes back as bytes, is
 * checked like any other input, and is cleaned, its textures coloured. */
#include "ecofiles/import_model.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/guard.h"
#include "ecofiles/image.h"
#include "ecofiles/model_clean.h"

#define TRIANGLES_MAX 20000000u
#define MATERIALS_MAX (1u << 20)

void eco_note(struct eco_notes *notes, const char *format, ...)
{
	va_list arguments;
	size_t left = sizeof notes->text - notes->used;
	int wanted;

	va_start(arguments, format);
	wanted = vsnprintf(notes->text + notes->used, left, format, arguments);
	va_end(arguments);
	if (wanted < 0 || (size_t)wanted + 2 > left) {
		notes->text[notes->used] = 0;
		return;
	}
	notes->used += (size_t)wanted;
	notes->text[notes->used++] = '\n';
	notes->text[notes->used] = 0;
}

/* ---- From the child to the parent: counts, then arrays, as they lie in memory ---- */

static bool put(FILE *out, const void *bytes, size_t size)
{
	return size == 0 || fwrite(bytes, size, 1, out) == 1;
}

static bool put_model(FILE *out, const struct eco_model *m, const struct eco_notes *notes)
{
	bool good = put(out, notes, sizeof *notes) && put(out, m, sizeof *m)
		&& put(out, m->position, (size_t)m->vertex_count * 3 * sizeof *m->position)
		&& put(out, m->uv, (size_t)m->vertex_count * 2 * sizeof *m->uv)
		&& put(out, m->index, (size_t)m->triangle_count * 3 * sizeof *m->index)
		&& put(out, m->material, (size_t)m->triangle_count * sizeof *m->material)
		&& put(out, m->materials, (size_t)m->material_count * sizeof *m->materials);

	for (uint32_t i = 0; good && i < m->image_count; i++)
		good = put(out, &m->images[i], sizeof m->images[i])
			&& put(out, m->images[i].rgba, (size_t)m->images[i].width * m->images[i].height * 4);
	return good;
}

static void *get(FILE *in, size_t size)
{
	void *bytes = malloc(size + 1);

	if (bytes != NULL && size > 0 && fread(bytes, size, 1, in) != 1) {
		free(bytes);
		return NULL;
	}
	return bytes;
}

static bool get_images(FILE *in, struct eco_model *m, uint32_t count)
{
	m->images = calloc((size_t)count + 1, sizeof *m->images);
	if (m->images == NULL)
		return false;
	for (uint32_t i = 0; i < count; i++) {
		struct eco_image image;

		if (fread(&image, sizeof image, 1, in) != 1 || (uint64_t)image.width * image.height > ECO_PIXELS_MAX)
			return false;
		image.rgba = get(in, (size_t)image.width * image.height * 4);
		if (image.rgba == NULL)
			return false;
		m->images[m->image_count++] = image;
	}
	return true;
}

static bool references_fit(const struct eco_model *m)
{
	for (uint32_t i = 0; i < m->triangle_count; i++)
		if (m->material[i] >= m->material_count)
			return false;
	for (uint32_t i = 0; i < m->material_count; i++) {
		if (m->materials[i].image != ECO_NONE && m->materials[i].image >= m->image_count)
			return false;
		m->materials[i].name[sizeof m->materials[i].name - 1] = 0;
	}
	return true;
}

static bool counts_fit(const struct eco_model *m, uint32_t triangles_max)
{
	uint64_t accounted = m->triangle_count;

	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m->dropped[i];
	return m->triangle_count <= triangles_max && m->vertex_count <= (uint64_t)triangles_max * 3 && m->material_count <= MATERIALS_MAX
		&& m->image_count <= ECO_MODEL_IMAGES_MAX && accounted == m->triangles_in;
}

static bool get_model(FILE *in, struct eco_model *m, struct eco_notes *notes, uint32_t triangles_max)
{
	struct eco_model head;

	if (fread(notes, sizeof *notes, 1, in) != 1 || fread(&head, sizeof head, 1, in) != 1 || !counts_fit(&head, triangles_max))
		return false;
	notes->text[sizeof notes->text - 1] = 0;
	*m = (struct eco_model){ .vertex_count = head.vertex_count, .triangle_count = head.triangle_count,
		.material_count = head.material_count, .triangles_in = head.triangles_in };
	memcpy(m->dropped, head.dropped, sizeof m->dropped);
	return (m->position = get(in, (size_t)m->vertex_count * 3 * sizeof *m->position)) != NULL
		&& (m->uv = get(in, (size_t)m->vertex_count * 2 * sizeof *m->uv)) != NULL
		&& (m->index = get(in, (size_t)m->triangle_count * 3 * sizeof *m->index)) != NULL
		&& (m->material = get(in, (size_t)m->triangle_count * sizeof *m->material)) != NULL
		&& (m->materials = get(in, (size_t)m->material_count * sizeof *m->materials)) != NULL
		&& get_images(in, m, head.image_count) && references_fit(m);
}

/* ---- The import ---- */

struct job { const char *path; uint32_t triangles_max; };

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct job *job = ctx;
	struct eco_model model = { .position = NULL };
	struct eco_model_file file = { .path = job->path };
	struct eco_notes *notes = calloc(1, sizeof *notes);
	enum eco_code code = notes == NULL ? eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", job->path)
		: eco_model_file_prepare(&file, error);

	if (code == ECO_OK)
		code = eco_assimp_read(&model, &file, job->triangles_max, notes, error);
	if (code == ECO_OK && !put_model(out, &model, notes))
		code = eco_fail(error, ECO_IO, "%.300s: the model could not be handed over: %s", job->path, strerror(errno));
	eco_model_free(&model);
	free(file.bytes);
	free(file.transforms);
	free(notes);
	return code;
}

static void drop_unused_uv(struct eco_model *m)
{
	for (uint32_t i = 0; i < m->material_count; i++)
		if (m->materials[i].image != ECO_NONE)
			return;
	free(m->uv);
	m->uv = NULL;
}

static void tell(const struct eco_model_options *options, struct eco_notes *notes)
{
	char *rest = notes->text, *line;

	while (options->warn != NULL && (line = strsep(&rest, "\n")) != NULL)
		if (*line != 0)
			options->warn(options->ctx, line);
}

enum eco_code eco_model_import(struct eco_model *model, const struct eco_model_options *options, struct eco_error *error)
{
	struct job job = { options->paths[0], options->triangles_max != 0 ? options->triangles_max : TRIANGLES_MAX };
	struct eco_notes *notes;
	FILE *result;
	enum eco_code code;

	*model = (struct eco_model){ .position = NULL };
	if (access(options->paths[0], R_OK) != 0)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", options->paths[0], strerror(errno));
	code = eco_guard_run(work, &job, options->paths[0], NULL, &result, error);
	if (code != ECO_OK)
		return code;
	notes = malloc(sizeof *notes);
	if (notes == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", options->paths[0]);
	else if (!get_model(result, model, notes, job.triangles_max))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: what its reader handed over does not hold together", options->paths[0]);
	fclose(result);
	if (code == ECO_OK) {
		drop_unused_uv(model);
		code = eco_model_clean(model, options->height_m, options->paths[0], error);
		if (code == ECO_OK)          /* of what is left only */
			code = eco_model_bake_tints(model, options->paths[0], notes, error);
		tell(options, notes);
	}
	free(notes);
	if (code != ECO_OK)
		eco_model_free(model);
	return code;
}
