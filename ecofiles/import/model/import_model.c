/* Reading a model. Each file is read in a child process, as assimp and the image readers have open
 * vulnerabilities. The soup comes back as bytes, is checked like any other input, joined with those of the
 * plant's other files, and cleaned, and its textures are coloured. */
#include "ecofiles/import/model/model_clean.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/base/phrase.h"
#include "ecofiles/format/image.h"
#include "ecofiles/base/module.h"

#define TRIANGLES_MAX 20000000u
#define FILES_MAX 64u
#define WIDE_M 100.0             /* a plant is not wider */

/* ---- From the child to the parent: counts, then arrays as they lie in memory ---- */

struct head {                    /* comes first; `model` for its counts, not its pointers */
	struct eco_notes notes;
	struct eco_model_frame frame;
	struct eco_model model;
	bool uv, part;
};

struct pipe { FILE *file; bool writes; };

/* Writes an array, or reads it into memory of its own. */
static bool pass(const struct pipe *p, void *array, size_t count, size_t size)
{
	void *items;
	memcpy(&items, array, sizeof items);
	if (!p->writes) {
		items = malloc(count * size + 1);
		memcpy(array, &items, sizeof items);
	}
	return items && (count == 0 || (p->writes ? fwrite(items, size, count, p->file)
		: fread(items, size, count, p->file)) == count);
}

static bool pass_images(const struct pipe *p, struct eco_model *m, uint32_t count)
{
	bool good = pass(p, &m->images, count, sizeof *m->images);
	for (uint32_t i = 0; good && i < count; i++) {
		struct eco_image *image = &m->images[i];
		uint64_t pixels = (uint64_t)image->width * image->height;
		good = pixels <= ECO_PIXELS_MAX && pass(p, &image->rgba, pixels, 4);
		if (!p->writes && pixels <= ECO_PIXELS_MAX)
			m->image_count = i + 1;
	}
	return good;
}

static bool pass_model(const struct pipe *p, struct eco_model *m, const struct head *head, uint32_t images)
{
	const size_t vertices = m->vertex_count, triangles = m->triangle_count;
	return pass(p, &m->position, 3 * vertices, sizeof *m->position)
		&& (!head->uv || pass(p, &m->uv, 2 * vertices, sizeof *m->uv))
		&& pass(p, &m->index, 3 * triangles, sizeof *m->index)
		&& pass(p, &m->material, triangles, sizeof *m->material)
		&& pass(p, &m->materials, m->material_count, sizeof *m->materials)
		&& (!head->part || (pass(p, &m->part, triangles, sizeof *m->part)
			&& pass(p, &m->parts, m->part_count, sizeof *m->parts)))
		&& pass_images(p, m, images);
}

static bool references_fit(struct eco_model *m)
{
	for (uint32_t i = 0; i < m->triangle_count; i++)
		if (m->material[i] >= m->material_count || (m->part && m->part[i] >= m->part_count))
			return false;
	for (uint32_t i = 0; i < m->material_count; i++) {
		if (m->materials[i].image != ECO_NONE && m->materials[i].image >= m->image_count)
			return false;
		m->materials[i].name[sizeof m->materials[i].name - 1] = 0;
	}
	for (uint32_t i = 0; i < m->part_count && m->parts; i++)
		m->parts[i].name[sizeof m->parts[i].name - 1] = 0;
	return true;
}

static bool counts_fit(const struct eco_model *m, uint32_t triangles_max)
{
	uint64_t accounted = m->triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m->dropped[i];
	return m->triangle_count <= triangles_max && m->vertex_count <= (uint64_t)triangles_max * 3
		&& m->material_count <= ECO_MODEL_MATERIALS_MAX && m->image_count <= ECO_MODEL_IMAGES_MAX
		&& m->part_count <= ECO_MODEL_PARTS_MAX && accounted == m->triangles_in;
}

static bool frame_fits(struct eco_model_frame *frame)
{
	frame->format[sizeof frame->format - 1] = 0;
	for (int k = 0; k < 3; k++)
		if (!(frame->base[k] >= -1e300 && frame->base[k] <= 1e300))
			return false;
	return frame->unit_m >= 0 && frame->unit_m <= 1e9 && frame->up <= ECO_UP_Z && frame->convention
		<= ECO_UP_Z;
}

static bool get_model(FILE *in, struct head *head, uint32_t triangles_max)
{
	struct eco_model *m = &head->model, counts = { 0 };
	bool whole = fread(head, sizeof *head, 1, in) == 1;
	if (whole)
		counts = *m;
	*m = (struct eco_model){ .vertex_count = counts.vertex_count, .triangle_count = counts.triangle_count,
		.material_count = counts.material_count, .triangles_in = counts.triangles_in,
		.part_count = head->part ? counts.part_count : 0 };
	memcpy(m->dropped, counts.dropped, sizeof m->dropped);
	head->notes.text[sizeof head->notes.text - 1] = 0;
	return whole && counts_fit(&counts, triangles_max) && frame_fits(&head->frame)
		&& pass_model(&(struct pipe){ in, false }, m, head, counts.image_count) && references_fit(m);
}

/* ---- In the child ---- */

struct job { const char *path; uint32_t triangles_max; };

/* Assimp has some fifty readers, most of them seldom used and seldom tested; and it looks for one that knows
 * the content where no reader has the extension. */
static bool assimp_may_read(const char *path)
{
	static const char *const extensions[] = { ".fbx", ".ply", ".dae", ".zae", ".stl", ".3ds", ".3mf" };
	for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
		if (eco_path_ends_with(path, extensions[i]))
			return true;
	return false;
}

static enum eco_code read_with_assimp(struct head *head, const struct job *job, struct eco_error *error)
{
	if (!assimp_may_read(job->path))
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: models are GLB, glTF, OBJ with MTL, FBX, "
			"PLY, Collada (.dae, .zae), STL, 3DS and 3MF, by these endings: export GLB",
			job->path);
	const struct eco_assimp_module *assimp = eco_module(ECO_MODULE_ASSIMP, error);
	return !assimp ? ECO_NOT_FOUND : assimp->read(&head->model, &head->frame, job->path, job->triangles_max,
		&head->notes, error);
}

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct job *job = ctx;
	struct head *head = calloc(1, sizeof *head);
	if (!head)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", job->path);
	head->frame.convention = ECO_UP_Y;
	enum eco_code code = eco_model_file_check(job->path, error);
	if (code == ECO_OK && eco_path_ends_with(job->path, ".obj"))
		code = eco_obj_read(&head->model, &head->frame, job->path, job->triangles_max, &head->notes,
			error);
	else if (code == ECO_OK && (eco_path_ends_with(job->path, ".glb")
			|| eco_path_ends_with(job->path, ".gltf") || eco_file_head_has(job->path, 4, "glTF")))
		code = eco_gltf_read_model(&head->model, &head->frame, job->path, job->triangles_max,
			&head->notes, error);
	else if (!code)
		code = read_with_assimp(head, job, error);
	head->uv = head->model.uv != NULL;
	head->part = head->model.part != NULL;
	if (!code && (fwrite(head, sizeof *head, 1, out) != 1
			|| !pass_model(&(struct pipe){ out, true }, &head->model, head, head->model.image_count)))
		code = eco_fail(error, ECO_IO, "%.300s: the model could not be handed over: %s", job->path,
			strerror(errno));
	eco_model_free(&head->model);
	free(head);
	return code;
}

/* ---- In the parent ---- */

static void drop_unused_uv(struct eco_model *m)
{
	for (uint32_t i = 0; i < m->material_count; i++)
		if (m->materials[i].image != ECO_NONE)
			return;
	free(m->uv);
	m->uv = NULL;
}

static void note_colourless(const struct eco_model *model, struct eco_notes *notes)
{
	uint64_t count = 0;
	for (uint32_t t = 0; t < model->triangle_count; t++)
		count += model->materials[model->material[t]].colourless;
	if (count > 0)
		eco_note(notes, "%s no colour in its files: wood is drawn brown, all else green",
			count == model->triangle_count ? "it has" : "a part of it has");
}

/* Notes several plants in one model, and one that is wider than any crown. */
static void note_size(const struct eco_model *model, const char *path, struct eco_notes *notes)
{
	double low[3], high[3], size[3];
	for (int k = 0; k < 3; k++) {
		low[k] = INFINITY;
		high[k] = -INFINITY;
		for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
			double at = (double)model->position[3 * (size_t)model->index[i] + (size_t)k];
			low[k] = fmin(low[k], at);
			high[k] = fmax(high[k], at);
		}
		size[k] = high[k] - low[k];
	}
	struct eco_apart apart = eco_model_apart(model, low, high);
	if (apart.count > 1 && apart.count <= ECO_APART_MOST)
		eco_note(notes, "%u plants stand apart in it, the first at %.3g, %.3g m, the second at "
			"%.3g, %.3g m: each place gets all of them; if they are meant one by one, make a file of "
			"each, as \"variants\"", apart.count, apart.at[0][0], apart.at[0][1], apart.at[1][0],
			apart.at[1][1]);
	if (fmax(size[0], size[1]) > WIDE_M)
		eco_note(notes, "%.200s is %.4g x %.4g m wide and %.3g m high, as a whole scene is: each place "
			"gets all of it. Make a file of each plant; if it is one plant, \"unit\" or \"height_m\" "
			"says its size", path, size[0], size[1], size[2]);
}

static void tell(const struct eco_model_options *options, struct eco_notes *notes)
{
	char *rest = notes->text, *line;
	while (options->warn && (line = strsep(&rest, "\n")))
		if (*line != 0)
			options->warn(options->ctx, line);
}

static struct eco_guard_limits limits_for(const char *path)
{
	struct stat status;
	struct eco_guard_limits limits = eco_guard_limits_for(stat(path, &status) == 0 && status.st_size > 0
		? (uint64_t)status.st_size : 0);
	if (eco_guard_unpacks(path))
		limits.memory_bytes = eco_guard_small_memory(&path, 1);
	return limits;
}

/* Reads one file in a child of its own; warns of its notes at once. */
static enum eco_code read_piece(struct eco_model_piece *piece, const struct eco_model_options *options,
	uint32_t triangles_max, struct eco_error *error)
{
	struct job job = { piece->path, triangles_max };
	struct eco_guard_limits limits = limits_for(piece->path);
	struct head *head = calloc(1, sizeof *head);
	FILE *result = NULL;
	enum eco_code code = !head ? eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", piece->path)
		: eco_guard_run(work, &job, piece->path, &limits, &result, error);

	if (code == ECO_OK && !get_model(result, head, triangles_max))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: the data from its reader contradict each other",
			piece->path);
	if (result)
		fclose(result);
	if (head) {
		piece->model = head->model;
		piece->frame = head->frame;
		if (!code)
			tell(options, &head->notes);
	}
	free(head);
	return code;
}

static enum eco_code read_pieces(struct eco_model_piece *pieces, const struct eco_model_options *options,
	struct eco_error *error)
{
	uint32_t left = options->triangles_max != 0 ? options->triangles_max : TRIANGLES_MAX;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < options->path_count && code == ECO_OK; i++) {
		pieces[i].path = options->paths[i];
		code = read_piece(&pieces[i], options, left, error);
		left -= pieces[i].model.triangle_count < left ? pieces[i].model.triangle_count : left;
	}
	return code;
}

enum eco_code eco_model_import(struct eco_model *model, const struct eco_model_options *options,
	struct eco_error *error)
{
	struct eco_model_piece *pieces = calloc(options->path_count + 1u, sizeof *pieces);
	struct eco_notes *notes = calloc(1, sizeof *notes);
	struct eco_model_frame frame;
	enum eco_code code = ECO_OK;
	*model = (struct eco_model){ .position = NULL };
	if (!pieces || !notes)
		code = eco_fail(error, ECO_NO_MEMORY, "out of memory");
	else if (options->path_count == 0 || options->path_count > FILES_MAX)
		code = eco_fail(error, ECO_BAD_INPUT, "a plant has 1 to %u files, not %u", FILES_MAX,
			options->path_count);
	else
		code = read_pieces(pieces, options, error);
	if (!code)
		code = eco_model_join(model, &frame, pieces, options->path_count, options, notes, error);
	if (!code) {
		drop_unused_uv(model);
		code = eco_model_clean(model, &frame, options, options->paths[0], notes, error);
	}
	if (!code)          /* after cleaning, for the triangles left */
		code = eco_model_bake_tints(model, options->paths[0], notes, error);
	if (!code && !eco_model_take_palettes(model))
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", options->paths[0]);
	if (!code) {
		drop_unused_uv(model);
		eco_model_see_colourless(model, notes);
		note_colourless(model, notes);
		note_size(model, options->paths[0], notes);
	}
	if (notes)
		tell(options, notes);
	for (uint32_t i = 0; pieces && i < options->path_count && i < FILES_MAX; i++)
		eco_model_free(&pieces[i].model);
	free(pieces);
	free(notes);
	if (code)
		eco_model_free(model);
	return code;
}
