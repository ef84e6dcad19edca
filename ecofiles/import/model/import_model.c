/* Reading a model. Each file is read in a child process, as assimp and the image readers have open
 * vulnerabilities. The soup comes back as bytes, is checked like any other input, joined with those of the
 * plant's other files, and cleaned, and its textures are coloured. */
#include "ecofiles/import/model/model_clean.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
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

static bool pass_model(const struct pipe *p, struct eco_model *m, uint32_t images)
{
	const size_t vertices = m->vertex_count, triangles = m->triangle_count;
	return pass(p, &m->position, 3 * vertices, sizeof *m->position)
		&& pass(p, &m->uv, 2 * vertices, sizeof *m->uv)
		&& pass(p, &m->index, 3 * triangles, sizeof *m->index)
		&& pass(p, &m->material, triangles, sizeof *m->material)
		&& pass(p, &m->materials, m->material_count, sizeof *m->materials)
		&& pass(p, &m->part, triangles, sizeof *m->part)
		&& pass(p, &m->parts, m->part_count, sizeof *m->parts)
		&& pass_images(p, m, images);
}

static bool references_fit(struct eco_model *m)
{
	for (uint32_t i = 0; i < m->triangle_count; i++)
		if (m->material[i] >= m->material_count || m->part[i] >= m->part_count)
			return false;
	for (uint32_t i = 0; i < m->material_count; i++) {
		if (m->materials[i].image != ECO_NONE && m->materials[i].image >= m->image_count)
			return false;
		m->materials[i].name[sizeof m->materials[i].name - 1] = 0;
	}
	for (uint32_t i = 0; i < m->part_count; i++)
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
		.part_count = counts.part_count };
	memcpy(m->dropped, counts.dropped, sizeof m->dropped);
	return whole && counts_fit(&counts, triangles_max) && frame_fits(&head->frame)
		&& pass_model(&(struct pipe){ in, false }, m, counts.image_count) && references_fit(m);
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
	return !assimp ? ECO_NOT_FOUND
		       : assimp->read(&head->model, &head->frame, job->path, job->triangles_max, &head->notes,
				 error);
}

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct job *job = ctx;
	struct head *head = eco_alloc(1, sizeof *head);
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
	if (!code &&
		(fwrite(head, sizeof *head, 1, out) != 1 ||
			!pass_model(&(struct pipe){ out, true }, &head->model, head->model.image_count)))
		code = eco_fail(error, ECO_IO, "%.300s: the model could not be handed over: %s", job->path,
			strerror(errno));
	eco_model_free(&head->model);
	free(head);
	return code;
}

/* ---- Several files ----
 * Several files make one plant. They share one coordinate system, so the axes that one of them states hold
 * for those that state none. If none does, the shape of all together decides (model_up.c). Files whose
 * formats state different units (a GLB in metres, an FBX in centimetres) are brought to the first one's. */

struct eco_model_piece {         /* a file after its reader */
	struct eco_model model;
	struct eco_model_frame frame;
	const char *path;
};

struct sums { uint64_t vertices, triangles, triangles_in, materials, images, parts; };

static struct sums add_up(const struct eco_model_piece *pieces, uint32_t count)
{
	struct sums s = { 0 };
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_model *m = &pieces[i].model;
		s.vertices += m->vertex_count;
		s.triangles += m->triangle_count;
		s.triangles_in += m->triangles_in;
		s.materials += m->material_count;
		s.images += m->image_count;
		s.parts += m->part_count;
	}
	return s;
}

static void take_memory(struct eco_model *m, const struct sums *s)
{
	eco_model_reserve(m, s->vertices, s->triangles);
	m->parts = eco_alloc(s->parts, sizeof *m->parts);
	m->materials = eco_alloc(s->materials + 1u, sizeof *m->materials);
	m->images = eco_alloc((size_t)s->images + 1, sizeof *m->images);
}

/* ---- Axes ---- */

/* Corrects a coordinate that was turned to Z up as if `from` pointed up, when `to` does. Neither is FOUND. */
static void turn_point(enum eco_up from, enum eco_up to, double p[3])
{
	/* the file's axes as ours, and their signs, where Y, Z or X is up */
	static const struct { int axis[3], sign[3]; } ours[] = { [ECO_UP_Y] = { { 0, 2, 1 }, { 1, -1, 1 } },
		[ECO_UP_Z] = { { 0, 1, 2 }, { 1, 1, 1 } }, [ECO_UP_X] = { { 1, 2, 0 }, { 1, 1, 1 } } };
	double file[3];
	for (int k = 0; k < 3 && from != to; k++)
		file[ours[from].axis[k]] = ours[from].sign[k] * p[k];
	for (int k = 0; k < 3 && from != to; k++)
		p[k] = ours[to].sign[k] * file[ours[to].axis[k]];
}

/* The up axis that a frame's coordinates assume; coordinates left as in the file are Z up. */
static enum eco_up stands_as(const struct eco_model_frame *frame)
{
	return frame->up == ECO_UP_FOUND ? ECO_UP_Z : frame->up;
}

static void turn_frame(struct eco_model *m, struct eco_model_frame *frame, enum eco_up up)
{
	enum eco_up from = stands_as(frame);
	turn_point(from, up, frame->base);
	for (uint32_t i = 0; i < m->vertex_count && from != up; i++) {
		float *p = &m->position[(size_t)i * 3];
		double place[3] = { p[0], p[1], p[2] };
		turn_point(from, up, place);
		for (int k = 0; k < 3; k++)
			p[k] = (float)place[k];
	}
	frame->up = up;
}

/* ---- One soup ---- */

static void name_part(struct eco_part *to, const char *path, const char *name, bool several)
{
	const char *file = eco_path_last(path);
	int room = (int)sizeof to->name - 1;
	if (!several)
		snprintf(to->name, sizeof to->name, "%.*s", room, name);
	else if (*name == 0)
		snprintf(to->name, sizeof to->name, "%.*s", room, file);
	else
		snprintf(to->name, sizeof to->name, "%.*s/%.*s", room / 2, file, room / 2, name);
}

static void append_parts(struct eco_model *m, const struct eco_model_piece *piece, bool several)
{
	const struct eco_model *from = &piece->model;
	for (uint32_t i = 0; i < from->triangle_count; i++)
		m->part[m->triangle_count + i] = m->part_count + from->part[i];
	for (uint32_t i = 0; i < from->part_count; i++)
		name_part(&m->parts[m->part_count++], piece->path, from->parts[i].name, several);
}

/* Appends a piece, and takes its images. Positions are relative to `frame`'s base, in its unit. */
static void append(struct eco_model *m, const struct eco_model_frame *frame, struct eco_model_piece *piece,
	bool several)
{
	struct eco_model *from = &piece->model;
	double scale = frame->unit_m > 0 && piece->frame.unit_m > 0 ? piece->frame.unit_m / frame->unit_m : 1;
	for (uint32_t i = 0; i < from->vertex_count; i++)
		for (uint32_t k = 0; k < 3; k++)
			m->position[((size_t)m->vertex_count + i) * 3 + k] =
				(float)((from->position[(size_t)i * 3 + k] + piece->frame.base[k]) * scale
				- frame->base[k]);
	memcpy(&m->uv[(size_t)m->vertex_count * 2], from->uv, (size_t)from->vertex_count * 2 * sizeof *m->uv);
	for (size_t i = 0; i < (size_t)from->triangle_count * 3; i++)
		m->index[(size_t)m->triangle_count * 3 + i] = from->index[i] < from->vertex_count
			? from->index[i] + m->vertex_count : ECO_NONE;
	for (uint32_t i = 0; i < from->triangle_count; i++)
		m->material[m->triangle_count + i] = from->material[i] + m->material_count;
	append_parts(m, piece, several);
	for (uint32_t i = 0; i < from->material_count; i++) {
		m->materials[m->material_count + i] = from->materials[i];
		if (from->materials[i].image != ECO_NONE)
			m->materials[m->material_count + i].image += m->image_count;
	}
	for (uint32_t i = 0; i < from->image_count; i++)
		m->images[m->image_count + i] = from->images[i];
	m->vertex_count += from->vertex_count;
	m->triangle_count += from->triangle_count;
	m->material_count += from->material_count;
	m->image_count += from->image_count;
	from->image_count = 0;
	m->triangles_in += from->triangles_in;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		m->dropped[i] += from->dropped[i];
}

/* ---- Axes and unit, as far as known ---- */

/* Up by the shape of the joined soup, which has its files' axes, if that is clear; else the format's
 * convention. */
static enum eco_up find_up(struct eco_model *m, enum eco_up convention, struct eco_notes *notes)
{
	double certainty = 0;
	enum eco_up up = eco_model_find_up(m, &certainty);
	m->source.up_how = certainty >= ECO_UP_CERTAIN ? ECO_HOW_SHAPE : ECO_HOW_CONVENTION;
	if (certainty < ECO_UP_CERTAIN) {
		up = convention;
		eco_note(notes, "its shape does not tell which axis points up: taken for %s, as is usual in "
			"this format; add \"up\": \"%s\" if not", eco_up_name(up),
			eco_up_name(up == ECO_UP_Z ? ECO_UP_Y : ECO_UP_Z));
	} else if (up != convention) {
		eco_note(notes, "by its shape the %s axis points up, not %s as is usual in this format; add "
			"\"up\": \"%s\" if not", eco_up_name(up), eco_up_name(convention),
			eco_up_name(convention));
	}
	return up;
}

/* A format that says what points up is believed, but exporters leave what they write as it was where z does:
 * a plant that lies by its shape is told. */
static void doubt_up(struct eco_model *m, struct eco_model_frame *frame, struct eco_notes *notes)
{
	double certainty = 0;
	enum eco_up says = frame->up;
	turn_frame(m, frame, ECO_UP_Z);
	enum eco_up up = eco_model_find_up(m, &certainty);
	turn_frame(m, frame, says);
	if (up == says || certainty < ECO_UP_CERTAIN)
		return;
	m->source.up_by_shape = up;
	eco_note(notes, "by its shape the %s axis points up, though its format says %s: it lies; add "
		"\"up\": \"%s\" if it should stand", eco_up_name(up), eco_up_name(says), eco_up_name(up));
}

/* The axis that `options` or a piece names; ECO_UP_FOUND: none does. */
static enum eco_up known_up(const struct eco_model_piece *pieces, uint32_t count,
	const struct eco_model_options *options, enum eco_how *how)
{
	*how = options->up != ECO_UP_FOUND ? ECO_HOW_GIVEN : ECO_HOW_FORMAT;
	if (options->up != ECO_UP_FOUND)
		return options->up;
	for (uint32_t i = 0; i < count; i++)
		if (pieces[i].frame.up != ECO_UP_FOUND)
			return pieces[i].frame.up;
	return ECO_UP_FOUND;
}

static void share_unit(struct eco_model_piece *pieces, uint32_t count, double given)
{
	double known = given;
	for (uint32_t i = 0; i < count && known == 0; i++)
		known = pieces[i].frame.unit_m;
	for (uint32_t i = 0; i < count; i++)
		if (pieces[i].frame.unit_m == 0 || given > 0)
			pieces[i].frame.unit_m = known;
}

/* Turns all pieces alike; before, each stands as its own frame says. */
static void share_up(struct eco_model_piece *pieces, uint32_t count, enum eco_up up, bool given)
{
	for (uint32_t i = 0; i < count && up != ECO_UP_FOUND; i++)
		if (given || pieces[i].frame.up == ECO_UP_FOUND)
			turn_frame(&pieces[i].model, &pieces[i].frame, up);
}

/* Makes one soup of the pieces, which become empty: Z up, in the unit of the first file, parts named after
 * their files if there are several. Axes that a format does not state come from `options`, from another
 * piece, or from the shape, which is noted. `frame` receives base, unit and up of the whole. */
static enum eco_code join(struct eco_model *model, struct eco_model_frame *frame,
	struct eco_model_piece *pieces, uint32_t count, const struct eco_model_options *options,
	struct eco_notes *notes, struct eco_error *error)
{
	struct sums sums = add_up(pieces, count);
	enum eco_how how;
	enum eco_up up = known_up(pieces, count, options, &how);
	*model = (struct eco_model){ .position = NULL };
	if (sums.triangles_in > UINT32_MAX || sums.vertices >= ECO_NONE || sums.images > ECO_MODEL_IMAGES_MAX
		|| sums.materials > ECO_MODEL_MATERIALS_MAX || sums.parts > ECO_MODEL_PARTS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: with its other files it has too many "
			"vertices, materials, parts or images", pieces[0].path);
	share_unit(pieces, count, options->unit_m);
	share_up(pieces, count, up, options->up != ECO_UP_FOUND);
	*frame = pieces[0].frame;
	take_memory(model, &sums);
	for (uint32_t i = 0; i < count; i++) {
		append(model, frame, &pieces[i], count > 1);
		eco_model_free(&pieces[i].model);
	}
	snprintf(model->source.format, sizeof model->source.format, "%s", frame->format);
	model->source.up_how = how;
	if (up == ECO_UP_FOUND) {
		model->source.up_how = ECO_HOW_CONVENTION;
		up = options->object ? frame->convention : find_up(model, frame->convention, notes);
		turn_frame(model, frame, up);
	} else if (how == ECO_HOW_FORMAT && !options->object) {
		doubt_up(model, frame, notes);
	}
	model->source.up = options->up != ECO_UP_FOUND ? options->up : frame->up;
	return ECO_OK;
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

/* Notes a model that is wider than any crown. */
static void note_size(const struct eco_model *model, const char *path, struct eco_notes *notes)
{
	double size[3];
	for (int k = 0; k < 3; k++)
		size[k] = model->source.size[k] * model->scale;
	if (fmax(size[0], size[1]) > WIDE_M)
		eco_note(notes,
			"%.200s is %.4g x %.4g m wide and %.3g m high, as a whole scene is: each place "
			"gets all of it. Make a file of each plant; if it is one plant, \"unit\" or "
			"\"height_m\" "
			"says its size",
			path, size[0], size[1], size[2]);
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
	struct head *head = eco_alloc(1, sizeof *head);
	FILE *result = NULL;
	enum eco_code code = eco_guard_run(work, &job, piece->path, &limits, &result, error);

	if (code == ECO_OK && !get_model(result, head, triangles_max))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: the data from its reader contradict each other",
			piece->path);
	if (result)
		fclose(result);
	piece->model = head->model;
	piece->frame = head->frame;
	if (!code)
		eco_notes_tell(&head->notes, options->warn, options->ctx);
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
	struct eco_model_piece *pieces = eco_alloc(options->path_count + 1u, sizeof *pieces);
	struct eco_notes *notes = eco_alloc(1, sizeof *notes);
	struct eco_model_frame frame;
	enum eco_code code = ECO_OK;
	*model = (struct eco_model){ .position = NULL };
	if (options->path_count == 0 || options->path_count > FILES_MAX)
		code = eco_fail(error, ECO_BAD_INPUT, "a plant has 1 to %u files, not %u", FILES_MAX,
			options->path_count);
	else
		code = read_pieces(pieces, options, error);
	if (!code)
		code = join(model, &frame, pieces, options->path_count, options, notes, error);
	if (!code) {
		drop_unused_uv(model);
		code = eco_model_clean(model, &frame, options, options->paths[0], notes, error);
	}
	if (!code) {        /* after cleaning, for the triangles left */
		eco_model_bake_tints(model, notes);
		eco_model_take_palettes(model);
		drop_unused_uv(model);
		model->object = options->object;
		if (!options->object) {
			eco_model_see_colourless(model, notes);
			note_colourless(model, notes);
			note_size(model, options->paths[0], notes);
		}
	}
	eco_notes_tell(notes, options->warn, options->ctx);
	for (uint32_t i = 0; i < options->path_count && i < FILES_MAX; i++)
		eco_model_free(&pieces[i].model);
	free(pieces);
	free(notes);
	if (code)
		eco_model_free(model);
	return code;
}
