/* Several files make one plant. They share one coordinate system, so the axes that one of them states hold
 * for those that state none. If none does, the shape of all together decides (model_up.h). Files whose
 * formats state different units (a GLB in metres, an FBX in centimetres) are brought to the first one's. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/phrase.h"
#include "ecofiles/import/model/model_clean.h"

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
		s.parts += m->part ? m->part_count : 1;
	}
	return s;
}

static bool take_memory(struct eco_model *m, const struct sums *s)
{
	bool good = eco_model_reserve(m, s->vertices, s->triangles, s->parts);
	m->materials = malloc((s->materials + 1) * sizeof *m->materials);
	m->images = calloc((size_t)s->images + 1, sizeof *m->images);
	return good && m->materials && m->images;
}

/* ---- Axes ---- */

/* Corrects a coordinate that was turned to Z up as if `from` pointed up, when `to` does. Neither is FOUND. */
static void turn_point(enum eco_up from, enum eco_up to, double p[3])
{
	const double was[3] = { p[0], p[1], p[2] };
	double file[3] = { was[0], was[1], was[2] };
	if (from == to)
		return;
	if (from == ECO_UP_Y)
		memcpy(file, (double[]){ was[0], was[2], -was[1] }, sizeof file);
	else if (from == ECO_UP_X)
		memcpy(file, (double[]){ was[2], was[0], was[1] }, sizeof file);
	if (to == ECO_UP_Y)
		memcpy(p, (double[]){ file[0], -file[2], file[1] }, sizeof file);
	else if (to == ECO_UP_X)
		memcpy(p, (double[]){ file[1], file[2], file[0] }, sizeof file);
	else
		memcpy(p, file, sizeof file);
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
		m->part[m->triangle_count + i] = m->part_count + (from->part ? from->part[i] : 0);
	for (uint32_t i = 0; i < from->part_count && from->part; i++)
		name_part(&m->parts[m->part_count++], piece->path, from->parts[i].name, several);
	if (!from->part)
		name_part(&m->parts[m->part_count++], piece->path, "", several);
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
	if (from->uv)
		memcpy(&m->uv[(size_t)m->vertex_count * 2], from->uv,
			(size_t)from->vertex_count * 2 * sizeof *m->uv);
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

enum eco_code eco_model_join(struct eco_model *model, struct eco_model_frame *frame,
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
	if (!take_memory(model, &sums)) {
		eco_model_free(model);
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory for %llu triangles",
			pieces[0].path, (unsigned long long)sums.triangles);
	}
	for (uint32_t i = 0; i < count; i++) {
		append(model, frame, &pieces[i], count > 1);
		eco_model_free(&pieces[i].model);
	}
	snprintf(model->source.format, sizeof model->source.format, "%s", frame->format);
	model->source.up_how = how;
	if (up == ECO_UP_FOUND) {
		up = find_up(model, frame->convention, notes);
		turn_frame(model, frame, up);
	} else if (how == ECO_HOW_FORMAT) {
		doubt_up(model, frame, notes);
	}
	model->source.up = options->up != ECO_UP_FOUND ? options->up : frame->up;
	return ECO_OK;
}
