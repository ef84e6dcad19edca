/* Wavefront OBJ, read here and not by assimp: assimp 5.2 refuses a file for one missing index, loses the
 * vertex behind a byte order mark, takes 1,5 for 1, keeps georeferenced coordinates as floats, and copies
 * every corner of every face. This reader counts what it cannot use, names the line of an error, and
 * subtracts a base far from the origin before it rounds.
 *
 * Vertices and faces are gathered as they come, as faces may name vertices that follow. At the end they
 * become a soup: a run of faces with one material and one part is a mesh. */
#include "ecofiles/import/model/import_obj.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/text.h"

#define UNIT_LINES 200u              /* comments about units stand at the top */
#define GREY 0.6                     /* colour without a material, as sRGB */

struct vertex { double place[3]; float color[3]; };  /* color[0] < 0: none */
struct corner { uint32_t v, vt; };   /* ECO_NONE: not given, or missing */
struct face { uint32_t first, material, part; };     /* its corners end where the next face begins */

struct obj {
	struct eco_obj_text text;
	struct eco_error *error;
	struct eco_notes *notes;
	struct vertex *vertices;     uint32_t vertex_count, vertex_room;
	float (*uv)[2];              uint32_t uv_count, uv_room;
	struct corner *corners;      uint32_t corner_count, corner_room;
	struct face *faces;          uint32_t face_count, face_room;
	struct eco_string_pool materials, parts, libraries;
	uint32_t material, part, triangles_max;
	uint64_t triangles, loose;
	char object[256], group[256];
	double unit_m;               /* from a comment; 0: none */
	bool colored;                /* some vertices have colours */
	/* the soup */
	struct eco_soup soup;
	struct eco_mtl mtl;
	const struct eco_mtl_material **of;  /* per material; NULL: in no library */
	bool *invisible;             /* per material */
	float color_scale;           /* 1/255 for colours written as bytes */
	uint64_t missing_uv;
	/* per vertex of the soup: its origin (vt only where the material has an image), and the material
	 * whose -s and -o its uv has, or ECO_NONE */
	struct key { struct corner corner; uint32_t transform; } *keys;
	uint32_t *table, mask;       /* open addressing: vertex, ECO_NONE is free */
};

/* Reads a whole word as a number, also NaN and infinity in any spelling. A decimal comma or anything else
 * is an error that says what to do. */
static enum eco_code read_number(const struct eco_obj_text *t, const char *word, double *number,
struct eco_error *error)
{
	char *end;
	*number = strtod(word, &end);
	if (end != word && *end == 0)
		return ECO_OK;
	if (end != word && *end == '#') {        /* from Windows: 1.#QNAN, -1.#IND, 1.#INF */
		*number = NAN;
		return ECO_OK;
	}
	if (strchr(word, ','))
		return eco_fail(error, ECO_BAD_INPUT, "%.250s: line %u: \"%.40s\": numbers need a decimal "
			"point, not a comma; export it again with "
			"English number format, or replace the commas", t->path, t->line, word);
	return eco_fail(error, ECO_BAD_INPUT, "%.250s: line %u: \"%.40s\" is not a number", t->path, t->line,
		word);
}

/* ---- Statements ---- */

/* Makes room for one more of an array's items. */
#define GROW(o, items, item) \
	eco_grow(&(o)->items, &(o)->item##_room, (o)->item##_count, sizeof *(o)->items)

/* Beyond `most` names each new one gets the last number. */
static uint32_t number_name(struct eco_string_pool *names, const char *name, uint32_t most)
{
	return names->count >= most ? most - 1 : eco_string_number(names, name);
}

/* x y z, x y z w, x y z r g b, x y z r g b a */
static enum eco_code read_vertex(struct obj *o, char *rest)
{
	double number[7];
	int count = 0;
	enum eco_code code = ECO_OK;
	for (char *word; code == ECO_OK && count < 7 && (word = eco_obj_word(&rest)); count++)
		code = read_number(&o->text, word, &number[count], o->error);
	if (code)
		return code;
	if (count < 3)
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: line %u: a vertex needs three numbers",
			o->text.path, o->text.line);
	GROW(o, vertices, vertex);
	struct vertex *v = &o->vertices[o->vertex_count++];
	memcpy(v->place, number, sizeof v->place);
	for (int k = 0; k < 3; k++)
		v->color[k] = count >= 6 && isfinite(number[3 + k]) ? (float)number[3 + k] : -1;
	o->colored |= count >= 6;
	return ECO_OK;
}

static enum eco_code read_uv(struct obj *o, char *rest)
{
	double number[2] = { 0, 0 };
	enum eco_code code = ECO_OK;
	char *word;
	GROW(o, uv, uv);
	for (int k = 0; k < 2 && !code && (word = eco_obj_word(&rest)); k++)
		code = read_number(&o->text, word, &number[k], o->error);
	for (int k = 0; k < 2; k++)
		o->uv[o->uv_count][k] = fabs(number[k]) <= 65536 ? (float)number[k] : 0;
	o->uv_count++;
	return code;
}

/* An index counts from 1, or backwards from -1; ECO_NONE: neither. Whether the vertex exists is checked at
 * the end, as faces may come first. */
static uint32_t index_of(const char *digits, char **end, size_t count)
{
	long long number = strtoll(digits, end, 10);
	if (*end == digits)
		return ECO_NONE;
	if (number < 0)
		number += (long long)count + 1;
	return number > 0 && number < ECO_NONE ? (uint32_t)(number - 1) : ECO_NONE;
}

/* v, v/vt, v//vn, v/vt/vn */
static struct corner read_corner(const struct obj *o, const char *word)
{
	char *end;
	struct corner c = { index_of(word, &end, o->vertex_count), ECO_NONE };
	if (*end == '/' && end[1] != '/' && end[1] != 0)
		c.vt = index_of(end + 1, &end, o->uv_count);
	return c;
}

/* Faces before the first `o`, `g` or `usemtl` have a nameless part and material. */
static void number_part(struct obj *o)
{
	char name[520];
	bool both = o->object[0] != 0 && o->group[0] != 0 && strcmp(o->object, o->group) != 0;
	snprintf(name, sizeof name, "%s%s%s", o->object, both ? "/" : "", both || o->object[0] == 0 ? o->group
		: "");
	o->part = number_name(&o->parts, name, ECO_MODEL_PARTS_MAX);
}

static enum eco_code read_face(struct obj *o, char *rest)
{
	uint32_t first = o->corner_count, n;
	for (char *word; (word = eco_obj_word(&rest));) {
		GROW(o, corners, corner);
		o->corners[o->corner_count++] = read_corner(o, word);
	}
	n = o->corner_count - first;
	if (n < 3) {
		o->corner_count = first;
		o->loose++;
		return ECO_OK;
	}
	if (n > ECO_POLYGON_CORNERS_MAX)
		return eco_fail(o->error, ECO_TOO_LARGE, "%.300s: line %u: a polygon of %u corners, at most "
			"%u are possible", o->text.path, o->text.line, n, (unsigned)ECO_POLYGON_CORNERS_MAX);
	o->triangles += n - 2;
	if (o->triangles > o->triangles_max)
		return eco_fail(o->error, ECO_TOO_LARGE, "%.300s: %llu triangles by line %u, at most %u "
			"triangles are possible", o->text.path, (unsigned long long)o->triangles,
			o->text.line, o->triangles_max);
	if (o->part == ECO_NONE)
		number_part(o);
	if (o->material == ECO_NONE)
		o->material = number_name(&o->materials, "", ECO_MODEL_MATERIALS_MAX);
	GROW(o, faces, face);
	o->faces[o->face_count++] = (struct face){ first, o->material, o->part };
	return ECO_OK;
}

/* "# File units = centimeters", "# Units: mm" and the like, as some exporters write. */
static void read_comment(struct obj *o, const char *text)
{
	static const struct { const char *word; double metres; } units[] =
		{ { "millimet", 0.001 }, { "centimet", 0.01 }, { "kilomet", 1000 },
		{ "met", 1 }, { "inch", 0.0254 }, { "foot", 0.3048 }, { "feet", 0.3048 }, { "mm", 0.001 },
		{ "cm", 0.01 }, { "km", 1000 }, { "in", 0.0254 },
		{ "ft", 0.3048 }, { "m", 1 } };
	const char *unit = strcasestr(text, "unit"), *word = unit ? strpbrk(unit, ":=") : NULL;
	size_t letters = 0;
	if (!word || o->unit_m > 0)
		return;
	for (word++; *word == ' ' || *word == '\t' || *word == '"'; word++)
		;
	if (word[0] == '1' && word[1] == ' ')
		word += 2;
	while (isalpha((unsigned char)word[letters]))
		letters++;
	for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
		size_t length = strlen(units[i].word);
		if (strncasecmp(word, units[i].word, length) == 0
				&& (letters == length || (length >= 3 && letters > length))) {
			o->unit_m = units[i].metres;
			return;
		}
	}
}

static enum eco_code read_line(struct obj *o, char *line)
{
	if (*line == '#') {
		if (o->text.line <= UNIT_LINES)
			read_comment(o, line);
		return ECO_OK;
	}
	const char *key = line;
	char *rest = eco_obj_arguments(line);
	if (strcmp(key, "v") == 0)
		return read_vertex(o, rest);
	if (strcmp(key, "vt") == 0)
		return read_uv(o, rest);
	if (strcmp(key, "f") == 0 || strcmp(key, "fo") == 0)
		return read_face(o, rest);
	if (strcmp(key, "l") == 0 || strcmp(key, "p") == 0) {
		o->loose++;
	} else if (strcmp(key, "usemtl") == 0) {
		o->material = number_name(&o->materials, rest, ECO_MODEL_MATERIALS_MAX - ECO_TINTS_MAX);
	} else if (strcmp(key, "o") == 0) {
		snprintf(o->object, sizeof o->object, "%s", rest);
		o->group[0] = 0;
		o->part = ECO_NONE;
	} else if (strcmp(key, "g") == 0) {
		snprintf(o->group, sizeof o->group, "%s", rest);
		o->part = ECO_NONE;
	} else if (strcmp(key, "mtllib") == 0) {
		eco_string_number(&o->libraries, rest);
	}
	return ECO_OK;
}

static enum eco_code read_text(struct obj *o)
{
	enum eco_code code = ECO_OK;
	char *line;
	while (code == ECO_OK && (line = eco_obj_line(&o->text, true)))
		code = read_line(o, line);
	if (code)
		return code;
	if (o->vertex_count == 0 && o->face_count == 0)
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: no vertices in it: not a Wavefront OBJ "
			"file, or an empty one", o->text.path);
	if (o->face_count == 0)
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: no triangles in it, only %u vertices and "
			"%llu points or lines; a point cloud has no surfaces: make a mesh of it first",
			o->text.path, o->vertex_count, (unsigned long long)o->loose);
	return ECO_OK;
}

/* ---- Materials ---- */

static enum eco_code read_library(struct obj *o, const char *name, bool *found)
{
	char path[4096];
	*found = eco_model_find_beside(o->text.path, name, path, sizeof path);
	return *found ? eco_mtl_read(&o->mtl, path, o->error) : ECO_OK;
}

/* A line names one library, whose name may have spaces, or several. If none is named or found, tries the one
 * with the model's name. */
static enum eco_code read_libraries(struct obj *o)
{
	const char *file = eco_path_last(o->text.path), *dot = strrchr(file, '.');
	char own[300];
	bool found = true;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < o->libraries.count && !code; i++) {
		char *rest = o->libraries.items[i];
		code = read_library(o, rest, &found);
		for (char *name; !found && !code && (name = strsep(&rest, " \t"));) {
			bool there = true;
			code = *name ? read_library(o, name, &there) : ECO_OK;
			if (!there)
				eco_note(o->notes,
					"its library of materials %.200s is not there: its materials "
					"have no colour",
					name);
		}
	}
	if (code || o->mtl.count > 0 || !dot)
		return code;
	snprintf(own, sizeof own, "%.*s.mtl", (int)(dot - file), file);
	code = read_library(o, own, &found);
	if (found && o->libraries.count > 0)
		eco_note(o->notes, "%.200s stands in for it", own);
	return code;
}

static void note_unknown(const struct obj *o)
{
	char names[300] = "";
	uint32_t count = 0;
	for (uint32_t i = 0; i < o->materials.count; i++) {
		const char *name = o->materials.items[i];
		if (o->of[i] || *name == 0 || strcasecmp(name, "none") == 0 || strcmp(name, "(null)") == 0)
			continue;
		count++;
		eco_phrase_add(names, sizeof names, name);
	}
	if (count > 0)
		eco_note(o->notes, "%u of its materials are in no library (%s): they have no colour", count,
			names);
}

static void make_material(struct obj *o, uint32_t i, struct eco_images *images)
{
	const struct eco_mtl_material *from = o->of[i];
	struct eco_material *to = &o->soup.model->materials[i];
	bool has_color = from && from->has_color;
	snprintf(to->name, sizeof to->name, "%.63s", o->materials.items[i]);
	to->image = ECO_NONE;
	memset(to->rgb, o->colored && !has_color ? 255 : (int)(GREY * 255), 3);
	for (int k = 0; k < 3 && has_color; k++)
		to->rgb[k] = o->mtl.linear ? eco_srgb_from_linear(from->rgb[k])
			: eco_byte_from_share(from->rgb[k]);
	if (from && !o->invisible[i] && from->texture) {
		bool mask = from->opacity && strcmp(from->opacity, from->texture) != 0;
		eco_material_take_picture(to, images, &(struct eco_image_wanted){ .texture = from->texture,
			.opacity = mask ? from->opacity : NULL,
			.gain = eco_alpha_shows(from->alpha) && from->alpha < 1 ? (float)from->alpha : 1 },
			true);
	} else {
		to->colourless = !has_color && !(from && from->texture);
	}
	to->colourless &= !o->colored;
}

static enum eco_code make_materials(struct obj *o)
{
	uint32_t count = o->materials.count;
	struct eco_model *model = o->soup.model;
	struct eco_images images = { .model = model, .path = o->text.path, .notes = o->notes };
	ECO_PASS(read_libraries(o));
	o->mtl.linear |= o->text.blender;
	model->materials = eco_alloc(count, sizeof *model->materials);
	model->material_count = count;
	o->of = eco_alloc(count, sizeof *o->of);
	o->soup.invisible = o->invisible = eco_alloc(count, sizeof *o->invisible);
	eco_images_start(&images);
	eco_mtl_find(&o->mtl, o->materials.items, count, o->of);
	for (uint32_t i = 0; i < count; i++)
		o->invisible[i] = o->of[i] && !eco_alpha_shows(o->of[i]->alpha);
	note_unknown(o);
	eco_model_see_invisible(o->invisible, count, o->notes);
	for (uint32_t i = 0; i < count; i++)
		make_material(o, i, &images);
	eco_images_end(&images);
	return ECO_OK;
}

/* ---- The soup ---- */

/* The uv matters only with an image, and so does the texture's own transform. */
static struct key key_of(struct obj *o, struct corner c, uint32_t material)
{
	const struct eco_mtl_material *from = o->of[material];
	if (o->soup.model->materials[material].image == ECO_NONE)
		c.vt = ECO_NONE;
	if (c.vt != ECO_NONE && c.vt >= o->uv_count) {
		o->missing_uv++;
		c.vt = ECO_NONE;
	}
	bool moves = c.vt != ECO_NONE && (from->uv_scale[0] != 1 || from->uv_scale[1] != 1
		|| from->uv_offset[0] != 0 || from->uv_offset[1] != 0);
	return (struct key){ c, moves ? material : ECO_NONE };
}

/* OBJ counts v upwards; here (0, 0) is the image's top left. */
static void set_uv(const struct obj *o, const struct key *key, float uv[2])
{
	double at[2] = { 0, 1 };
	for (int k = 0; k < 2 && key->corner.vt != ECO_NONE; k++) {
		at[k] = o->uv[key->corner.vt][k];
		if (key->transform != ECO_NONE)
			at[k] = at[k] * o->of[key->transform]->uv_scale[k] + o->of[key->transform]->uv_offset[k];
	}
	uv[0] = fabs(at[0]) <= 65536 ? (float)at[0] : 0;
	uv[1] = fabs(at[1]) <= 65536 ? (float)(1 - at[1]) : 0;
}

/* The vertex of a corner, made if it is new: they are shared where position and texture coordinate are equal.
 * ECO_NONE: the corner names none. */
static uint32_t vertex_of(struct obj *o, struct corner corner, uint32_t material)
{
	uint32_t slot, v;
	float uv[2], rgb[3];
	if (corner.v >= o->vertex_count)
		return ECO_NONE;
	const struct vertex *from = &o->vertices[corner.v];
	const struct key key = key_of(o, corner, material);
	for (slot = eco_random_slot(key.corner.v, key.corner.vt, key.transform) & o->mask;
			(v = o->table[slot]) != ECO_NONE; slot = (slot + 1) & o->mask)
		if (memcmp(&o->keys[v], &key, sizeof key) == 0)
			return v;
	set_uv(o, &key, uv);
	for (int k = 0; k < 3; k++)
		rgb[k] = from->color[0] >= 0 ? from->color[k] * o->color_scale : (float)GREY;
	v = o->table[slot] = eco_soup_vertex(&o->soup, from->place, uv, rgb);
	o->keys[v] = key;
	return v;
}

static void add_face(struct obj *o, const struct face *face, uint32_t end)
{
	const struct corner *c = o->corners + face->first;
	uint32_t n = end - face->first, v[3];
	double *corners = eco_soup_corners(&o->soup);
	for (uint32_t i = 0; i < 3 * n; i++)
		corners[i] = c[i / 3].v < o->vertex_count ? o->vertices[c[i / 3].v].place[i % 3] : NAN;
	const uint32_t *split = eco_soup_split(&o->soup, n);
	o->soup.part = face->part;
	for (uint32_t i = 0; i + 2 < n; i++) {
		for (uint32_t k = 0; k < 3; k++)
			v[k] = vertex_of(o, c[split[3 * i + k]], face->material);
		eco_soup_triangle(&o->soup, v[0], v[1], v[2]);
	}
}

static void add_faces(struct obj *o)
{
	float most = 0;
	for (size_t i = 0; i < 3 * (size_t)o->vertex_count; i++)
		most = fmaxf(most, o->vertices[i / 3].color[i % 3]);
	o->color_scale = most > 1.5f ? 1 / 255.0f : 1;
	o->keys = eco_alloc(o->corner_count, sizeof *o->keys);
	o->table = model_table_new(o->corner_count, &o->mask);
	for (uint32_t f = 0; f < o->face_count; f++) {
		const struct face *face = &o->faces[f];
		if (f == 0 || face->material != face[-1].material || face->part != face[-1].part)
			eco_soup_mesh(&o->soup, face->material, o->colored);
		add_face(o, face, f + 1 < o->face_count ? face[1].first : o->corner_count);
	}
}

static enum eco_code make_soup(struct obj *o)
{
	struct eco_model *model = o->soup.model;
	*o->soup.frame = (struct eco_model_frame){ .format = "Wavefront OBJ", .unit_m = o->unit_m,
		.convention = ECO_UP_Y };
	ECO_PASS(make_materials(o));
	add_faces(o);
	model->parts = eco_alloc(o->parts.count, sizeof *model->parts);
	for (uint32_t i = 0; i < o->parts.count; i++)
		snprintf(model->parts[model->part_count++].name, sizeof model->parts->name, "%.63s",
			o->parts.items[i]);
	eco_soup_end(&o->soup, "d, Tr, opacity");
	if (o->missing_uv > 0)
		eco_note(o->notes, "%llu corners name texture coordinates that are not there",
			(unsigned long long)o->missing_uv);
	return ECO_OK;
}

/* ---- The file ---- */

static void free_obj(struct obj *o)
{
	eco_soup_free(&o->soup);
	eco_mtl_free(&o->mtl);
	eco_string_pool_free(&o->materials);
	eco_string_pool_free(&o->parts);
	eco_string_pool_free(&o->libraries);
	eco_free(o->vertices, o->uv, o->corners, o->faces, o->of, o->invisible, o->keys, o->table);
}

/* Refuses binary files. */
static enum eco_code start_text(struct obj *o, uint8_t *bytes, size_t size)
{
	if (size >= 2 && (memcmp(bytes, "\xff\xfe", 2) == 0 || memcmp(bytes, "\xfe\xff", 2) == 0))
		return eco_fail(o->error, ECO_UNSUPPORTED, "%.300s: text in UTF-16; save it as UTF-8",
			o->text.path);
	if (memchr(bytes, 0, size < 4096 ? size : 4096))
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: binary, so no Wavefront OBJ file",
			o->text.path);
	eco_obj_text_start(&o->text, bytes, size);
	return ECO_OK;
}

enum eco_code eco_obj_read(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	struct obj o = { .text = { .path = path }, .error = error, .notes = notes,
		.triangles_max = triangles_max,
		.material = ECO_NONE, .part = ECO_NONE, .soup = { .model = model, .frame = frame,
		.notes = notes } };
	uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_file_read(path, ECO_MODEL_FILE_MAX, &bytes, &size, error);
	if (!code)
		code = start_text(&o, bytes, size);
	if (!code)
		code = read_text(&o);
	free(bytes);
	if (!code)
		code = make_soup(&o);
	free_obj(&o);
	return code;
}
