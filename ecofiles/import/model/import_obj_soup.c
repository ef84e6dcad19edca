/* From an OBJ file's faces to a soup. A run of faces with one material and one part is a mesh. */
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/model/import_obj.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/random.h"

#define GREY 0.6                     /* colour without a material, as sRGB */

struct maker {
	const struct eco_obj *obj;
	struct eco_model *model;
	struct eco_mtl mtl;
	const struct eco_mtl_material **of;  /* per material; NULL: in no library */
	bool *invisible;             /* per material */
	struct eco_soup soup;
	float color_scale;           /* 1/255 for colours written as bytes */
	uint64_t missing_uv;
	struct eco_obj_corner *key;  /* per vertex: its origin; vt only where the material has an image */
	uint32_t *transform;         /* per vertex: material whose -s and -o its uv has, or ECO_NONE */
	uint32_t *table, mask;       /* open addressing: vertex, ECO_NONE is free */
	double *corners;             /* scratch of one polygon */
	uint32_t *split;
};

/* Corners of face f: [*first, end). */
static const struct eco_obj_corner *corners_of(const struct eco_obj *o, uint32_t f, uint32_t *n)
{
	uint32_t first = o->faces[f].first,
		 end = f + 1 < o->face_count ? o->faces[f + 1].first : o->corner_count;
	*n = end - first;
	return o->corners + first;
}

static const double *place_of(const struct eco_obj *o, uint32_t v)
{
	return v < o->place_count ? o->place[v] : NULL;
}

/* ---- Materials ---- */

static enum eco_code read_library(struct maker *m, const char *name, bool *found)
{
	char path[4096];
	*found = eco_model_find_beside(m->obj->text.path, name, path, sizeof path);
	return *found ? eco_mtl_read(&m->mtl, path, m->obj->error) : ECO_OK;
}

/* A line names one library, whose name may have spaces, or several. If none is named or found, tries the one
 * with the model's name. */
static enum eco_code read_libraries(struct maker *m)
{
	const struct eco_obj *o = m->obj;
	const char *file = eco_path_last(o->text.path), *dot = strrchr(file, '.');
	char own[300];
	bool found = true;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < o->libraries.count && !code; i++) {
		char *rest = o->libraries.items[i];
		code = read_library(m, rest, &found);
		for (char *name; !found && !code && (name = strsep(&rest, " \t"));) {
			bool there = true;
			code = *name ? read_library(m, name, &there) : ECO_OK;
			if (!there)
				eco_note(o->notes,
					"its library of materials %.200s is not there: its materials "
					"have no colour",
					name);
		}
	}
	if (code || m->mtl.count > 0 || !dot)
		return code;
	snprintf(own, sizeof own, "%.*s.mtl", (int)(dot - file), file);
	code = read_library(m, own, &found);
	if (found && o->libraries.count > 0)
		eco_note(o->notes, "%.200s stands in for it", own);
	return code;
}

static void note_unknown(const struct maker *m)
{
	const struct eco_obj *o = m->obj;
	char names[300] = "";
	uint32_t count = 0;
	for (uint32_t i = 0; i < o->materials.count; i++) {
		const char *name = o->materials.items[i];
		if (m->of[i] || *name == 0 || strcasecmp(name, "none") == 0 || strcmp(name, "(null)") == 0)
			continue;
		count++;
		eco_phrase_add(names, sizeof names, name);
	}
	if (count > 0)
		eco_note(o->notes, "%u of its materials are in no library (%s): they have no colour", count,
			names);
}

static void make_material(struct maker *m, uint32_t i, struct eco_images *images)
{
	const struct eco_mtl_material *from = m->of[i];
	struct eco_material *to = &m->model->materials[i];
	snprintf(to->name, sizeof to->name, "%.63s", m->obj->materials.items[i]);
	to->image = ECO_NONE;
	memset(to->rgb, m->obj->color_count > 0 && (!from || !from->has_color) ? 255 : (int)(GREY * 255), 3);
	to->colourless = m->obj->color_count == 0 && (!from || (!from->has_color && !from->texture));
	for (int k = 0; k < 3 && from && from->has_color; k++)
		to->rgb[k] = m->mtl.linear ? eco_srgb_from_linear(from->rgb[k])
					   : eco_byte_from_share(from->rgb[k]);
	if (!from || m->invisible[i] || !from->texture)
		return;
	const double alpha = eco_mtl_alpha(from);
	struct eco_image_wanted wanted = { .texture = from->texture,
		.gain = eco_alpha_shows(alpha) && alpha < 1 ? (float)alpha : 1 };

	if (from->opacity && strcmp(from->opacity, from->texture) != 0)
		wanted.opacity = from->opacity;
	to->image = eco_images_get(images, &wanted, &to->cutout);
	/* the map replaces the colour, whatever exporters leave there (0.8, 0.64, 0) */
	if (to->image != ECO_NONE)
		memset(to->rgb, 255, 3);
	else if (m->obj->color_count == 0)
		eco_material_lost_picture(to);
}

static enum eco_code make_materials(struct maker *m)
{
	const struct eco_obj *o = m->obj;
	uint32_t count = o->materials.count;
	struct eco_images images = { .model = m->model, .path = o->text.path, .notes = o->notes };
	enum eco_code code = read_libraries(m);
	if (code)
		return code;
	m->mtl.linear |= o->linear;
	m->model->materials = eco_alloc((size_t)count + 1, sizeof *m->model->materials);
	m->of = eco_alloc((size_t)count + 1, sizeof *m->of);
	m->invisible = eco_alloc((size_t)count + 1, sizeof *m->invisible);
	eco_images_start(&images);
	eco_mtl_find(&m->mtl, o->materials.items, count, m->of);
	for (uint32_t i = 0; i < count; i++)
		m->invisible[i] = m->of[i] && !eco_alpha_shows(eco_mtl_alpha(m->of[i]));
	note_unknown(m);
	eco_model_see_invisible(m->invisible, count, o->notes);
	m->model->material_count = count;
	for (uint32_t i = 0; i < count; i++)
		make_material(m, i, &images);
	eco_images_end(&images);
	return ECO_OK;
}

/* ---- Vertices ---- */

/* The uv matters only with an image, and so does the texture's own transform. */
static struct eco_obj_corner key_of(struct maker *m, struct eco_obj_corner c, uint32_t material,
	uint32_t *transform)
{
	const struct eco_mtl_material *from = m->of[material];
	*transform = ECO_NONE;
	if (m->model->materials[material].image == ECO_NONE)
		c.vt = ECO_NONE;
	if (c.vt != ECO_NONE && c.vt >= m->obj->uv_count) {
		m->missing_uv++;
		c.vt = ECO_NONE;
	}
	if (c.vt != ECO_NONE && (from->uv_scale[0] != 1 || from->uv_scale[1] != 1 || from->uv_offset[0] != 0
			|| from->uv_offset[1] != 0))
		*transform = material;
	return c;
}

/* OBJ counts v upwards; here (0, 0) is the image's top left. */
static void set_uv(const struct maker *m, struct eco_obj_corner c, uint32_t transform, float uv[2])
{
	static const float none[2] = { 0, 1 };
	const float *from = c.vt != ECO_NONE ? m->obj->uv[c.vt] : none;
	double u = from[0], v = from[1];
	if (transform != ECO_NONE) {
		u = u * m->of[transform]->uv_scale[0] + m->of[transform]->uv_offset[0];
		v = v * m->of[transform]->uv_scale[1] + m->of[transform]->uv_offset[1];
	}
	uv[0] = fabs(u) <= 65536 ? (float)u : 0;
	uv[1] = fabs(v) <= 65536 ? (float)(1 - v) : 0;
}

/* The vertex of a corner, made if it is new; ECO_NONE: the corner names none. */
static uint32_t vertex_of(struct maker *m, struct eco_obj_corner corner, uint32_t material)
{
	const double *place = place_of(m->obj, corner.v);
	const float *color = corner.v < m->obj->color_count ? m->obj->color[corner.v] : NULL;
	uint32_t transform, slot, v;
	float uv[2], rgb[3];
	if (!place)
		return ECO_NONE;
	struct eco_obj_corner key = key_of(m, corner, material, &transform);
	for (slot = eco_random_slot(key.v, key.vt, transform) & m->mask; (v = m->table[slot]) != ECO_NONE;
			slot = (slot + 1) & m->mask)
		if (m->key[v].v == key.v && m->key[v].vt == key.vt && m->transform[v] == transform)
			return v;
	set_uv(m, key, transform, uv);
	for (int k = 0; k < 3; k++)
		rgb[k] = color && color[0] >= 0 ? color[k] * m->color_scale : (float)GREY;
	v = m->table[slot] = eco_soup_vertex(&m->soup, place, uv, rgb);
	m->key[v] = key;
	m->transform[v] = transform;
	return v;
}

/* ---- Faces ---- */

static void add_face(struct maker *m, uint32_t f)
{
	const struct eco_obj_face *face = &m->obj->faces[f];
	uint32_t n, v[3];
	const struct eco_obj_corner *c = corners_of(m->obj, f, &n);
	for (uint32_t i = 0; i < 3 * n; i++) {
		const double *p = place_of(m->obj, c[i / 3].v);
		m->corners[i] = p ? p[i % 3] : NAN;
	}
	eco_model_split(m->corners, n, m->split);
	m->soup.part = face->part;
	for (uint32_t i = 0; i + 2 < n; i++) {
		for (int k = 0; k < 3; k++)
			v[k] = vertex_of(m, c[m->split[n + 3 * i + (uint32_t)k]], face->material);
		eco_soup_triangle(&m->soup, v[0], v[1], v[2]);
	}
}

static void add_faces(struct maker *m)
{
	const struct eco_obj *o = m->obj;
	for (uint32_t f = 0; f < o->face_count; f++) {
		const struct eco_obj_face *face = &o->faces[f];
		if (f == 0 || face->material != face[-1].material || face->part != face[-1].part)
			eco_soup_mesh(&m->soup, face->material, o->color_count > 0);
		add_face(m, f);
	}
}

/* ---- All ---- */

static void find_color_scale(struct maker *m)
{
	float most = 0;
	for (size_t i = 0; i < 3 * (size_t)m->obj->color_count; i++)
		most = fmaxf(most, m->obj->color[i / 3][i % 3]);
	m->color_scale = most > 1.5f ? 1 / 255.0f : 1;
}

static void take_memory(struct maker *m)
{
	const struct eco_obj *o = m->obj;
	size_t vertices = o->corner_count;
	eco_soup_reserve(&m->soup, vertices, o->triangles, o->parts.count, o->color_count > 0);
	m->key = eco_alloc(vertices + 1, sizeof *m->key);
	m->transform = eco_alloc(vertices + 1, sizeof *m->transform);
	m->table = model_table_new(vertices, &m->mask);
	m->corners = eco_alloc(ECO_POLYGON_CORNERS_MAX * 3, sizeof *m->corners);
	m->split = eco_alloc(ECO_POLYGON_CORNERS_MAX * 4, sizeof *m->split);
}

enum eco_code eco_obj_soup(struct eco_model *model, struct eco_model_frame *frame, const struct eco_obj *obj)
{
	struct maker m = { .obj = obj, .model = model,
		.soup = { .model = model, .frame = frame, .notes = obj->notes } };
	*frame = (struct eco_model_frame){ .format = "Wavefront OBJ", .unit_m = obj->unit_m,
		.convention = ECO_UP_Y };
	enum eco_code code = make_materials(&m);
	m.soup.invisible = m.invisible;
	find_color_scale(&m);
	if (!code) {
		take_memory(&m);
		add_faces(&m);
		eco_soup_end(&m.soup, "d, Tr, opacity");
	}
	for (uint32_t i = 0; i < obj->parts.count && !code; i++)
		snprintf(model->parts[model->part_count++].name, sizeof model->parts->name, "%.63s",
			obj->parts.items[i]);
	if (m.missing_uv > 0)
		eco_note(obj->notes, "%llu corners name texture coordinates that are not there",
			(unsigned long long)m.missing_uv);
	eco_soup_free(&m.soup);
	eco_mtl_free(&m.mtl);
	free(m.of);
	free(m.invisible);
	free(m.key);
	free(m.transform);
	free(m.table);
	free(m.corners);
	free(m.split);
	return code;
}
