/* Wavefront OBJ, read here and not by assimp: assimp 5.2 refuses a file for one missing index, loses the
 * vertex behind a byte order mark, takes 1,5 for 1, keeps georeferenced coordinates as floats, and copies
 * every corner of every face. This reader counts what it cannot use, names the line of an error, and
 * subtracts a base far from the origin before it rounds.
 *
 * The text is cut up in place (eco_obj_text). Vertices and faces are gathered as they come (struct obj);
 * at the end import_obj_soup.c makes triangles of them. */
#include "ecofiles/import/model/import_obj.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"

#define UNIT_LINES 200u              /* comments about units stand at the top */

/* ---- Lines and words ---- */

/* The next line without surrounding spaces; NULL at the end. Lines end with LF, CRLF or CR; if `joins`, a
 * backslash at the end of a line continues it. */
static char *next_line(struct eco_obj_text *t, bool joins)
{
	char *start = t->at, *end;
	if (start >= t->end)
		return NULL;
	t->line++;
	for (end = start; end < t->end && *end != '\n' && *end != '\r'; end++)
		if (joins && *end == '\\' && (end[1] == '\n' || (end[1] == '\r' && end[2] == '\n'))) {
			memset(end, ' ', end[1] == '\r' ? 3 : 2);
			t->line++;
		}
	t->at = end + (end < t->end ? *end == '\r' && end[1] == '\n' ? 2 : 1 : 0);
	while (end > start && (end[-1] == ' ' || end[-1] == '\t'))
		end--;
	*end = 0;
	while (*start == ' ' || *start == '\t')
		start++;
	return start;
}

/* The next word of a line; NULL at its end or at a comment. */
static char *next_word(char **line)
{
	char *word = *line, *end;
	while (*word == ' ' || *word == '\t')
		word++;
	if (*word == 0 || *word == '#')
		return NULL;
	for (end = word; *end != 0 && *end != ' ' && *end != '\t'; end++)
		;
	*line = end + (*end != 0);
	*end = 0;
	return word;
}

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
static enum eco_code read_vertex(struct eco_obj *o, char *rest)
{
	double number[7];
	int count = 0;
	enum eco_code code = ECO_OK;
	for (char *word; code == ECO_OK && count < 7 && (word = next_word(&rest)); count++)
		code = read_number(&o->text, word, &number[count], o->error);
	if (code)
		return code;
	if (count < 3)
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: line %u: a vertex needs three numbers",
			o->text.path, o->text.line);
	GROW(o, place, place);
	memcpy(o->place[o->place_count++], number, sizeof *o->place);
	while (count >= 6 && o->color_count < o->place_count) {
		GROW(o, color, color);
		for (int k = 0; k < 3; k++)
			o->color[o->color_count][k] = o->color_count + 1 == o->place_count
				&& isfinite(number[3 + k]) ? (float)number[3 + k] : -1;
		o->color_count++;
	}
	return ECO_OK;
}

static enum eco_code read_uv(struct eco_obj *o, char *rest)
{
	double number[2] = { 0, 0 };
	enum eco_code code = ECO_OK;
	char *word;
	GROW(o, uv, uv);
	for (int k = 0; k < 2 && !code && (word = next_word(&rest)); k++)
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
static struct eco_obj_corner read_corner(const struct eco_obj *o, const char *word)
{
	char *end;
	struct eco_obj_corner c = { index_of(word, &end, o->place_count), ECO_NONE };
	if (*end == '/' && end[1] != '/' && end[1] != 0)
		c.vt = index_of(end + 1, &end, o->uv_count);
	return c;
}

/* Faces before the first `o`, `g` or `usemtl` have a nameless part and material. */
static void number_part(struct eco_obj *o)
{
	char name[520];
	bool both = o->object[0] != 0 && o->group[0] != 0 && strcmp(o->object, o->group) != 0;
	snprintf(name, sizeof name, "%s%s%s", o->object, both ? "/" : "", both || o->object[0] == 0 ? o->group
		: "");
	o->part = number_name(&o->parts, name, ECO_MODEL_PARTS_MAX);
}

static enum eco_code read_face(struct eco_obj *o, char *rest)
{
	uint32_t first = o->corner_count, n;
	for (char *word; (word = next_word(&rest));) {
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
	o->faces[o->face_count++] = (struct eco_obj_face){ first, o->material, o->part };
	return ECO_OK;
}

/* "# File units = centimeters", "# Units: mm" and the like, as some exporters write. */
static void read_comment(struct eco_obj *o, const char *text)
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

static enum eco_code read_line(struct eco_obj *o, char *line)
{
	char *rest = line + strcspn(line, " \t"), *key = line;
	if (*line == '#') {
		if (o->text.line <= UNIT_LINES)
			read_comment(o, line);
		return ECO_OK;
	}
	if (*rest != 0)
		*rest++ = 0;
	rest += strspn(rest, " \t");
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

static enum eco_code read_text(struct eco_obj *o)
{
	enum eco_code code = ECO_OK;
	char *line;
	while (code == ECO_OK && (line = next_line(&o->text, true)))
		code = read_line(o, line);
	if (code)
		return code;
	if (o->place_count == 0 && o->face_count == 0)
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: no vertices in it: not a Wavefront OBJ "
			"file, or an empty one", o->text.path);
	if (o->face_count == 0)
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: no triangles in it, only %u vertices and "
			"%llu points or lines; a point cloud has no surfaces: make a mesh of it first",
			o->text.path, o->place_count, (unsigned long long)o->loose);
	return ECO_OK;
}

/* ---- The file ---- */

static void free_obj(struct eco_obj *o)
{
	free(o->place);
	free(o->color);
	free(o->uv);
	free(o->corners);
	free(o->faces);
	eco_string_pool_free(&o->materials);
	eco_string_pool_free(&o->parts);
	eco_string_pool_free(&o->libraries);
}

/* Skips a byte order mark; refuses binary files. */
static enum eco_code start_text(struct eco_obj *o, uint8_t *bytes, size_t size)
{
	if (size >= 2 && (memcmp(bytes, "\xff\xfe", 2) == 0 || memcmp(bytes, "\xfe\xff", 2) == 0))
		return eco_fail(o->error, ECO_UNSUPPORTED, "%.300s: text in UTF-16; save it as UTF-8",
			o->text.path);
	if (memchr(bytes, 0, size < 4096 ? size : 4096))
		return eco_fail(o->error, ECO_BAD_INPUT, "%.300s: binary, so no Wavefront OBJ file",
			o->text.path);
	o->text.at = (char *)bytes + (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
	o->text.end = (char *)bytes + size;
	o->linear = memmem(bytes, size < 4096 ? size : 4096, "Blender", 7) != NULL;
	return ECO_OK;
}

enum eco_code eco_obj_read(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	struct eco_obj o = { .text = { .path = path }, .error = error, .notes = notes,
		.triangles_max = triangles_max, .material = ECO_NONE, .part = ECO_NONE };
	uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_file_read(path, ECO_MODEL_FILE_MAX, &bytes, &size, error);
	if (!code)
		code = start_text(&o, bytes, size);
	if (!code)
		code = read_text(&o);
	free(bytes);
	if (!code)
		code = eco_obj_soup(model, frame, &o);
	free_obj(&o);
	return code;
}

/* ---- Libraries of materials: one colour, one texture and one opacity ---- */

#define MTL_BYTES_MAX ((uint64_t)1 << 28)
#define MATERIALS_MAX 65536u

/* its arguments: a number of words, or up to a number of numbers */
struct option { const char *name; int words, numbers; };

static const struct option options[] = { { "-blendu", 1, 0 }, { "-blendv", 1, 0 }, { "-cc", 1, 0 },
	{ "-clamp", 1, 0 },
	{ "-texres", 1, 0 }, { "-imfchan", 1, 0 }, { "-type", 1, 0 }, { "-bm", 1, 0 }, { "-boost", 1, 0 },
	{ "-colorspace", 1, 0 },
	{ "-mm", 2, 0 }, { "-s", 0, 3 }, { "-o", 0, 3 }, { "-t", 0, 3 } };

static char *skip_space(char *at)
{
	while (*at == ' ' || *at == '\t')
		at++;
	return at;
}

static char *skip_word(char *at)
{
	while (*at != 0 && *at != ' ' && *at != '\t')
		at++;
	return at;
}

static const struct option *option_at(const char *at)
{
	for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
		size_t length = strlen(options[i].name);
		if (strncasecmp(at, options[i].name, length) == 0
				&& (at[length] == ' ' || at[length] == '\t'))
			return &options[i];
	}
	return NULL;
}

/* Reads up to three numbers and keeps the first two. */
static char *read_numbers(char *at, int most, double *keep)
{
	for (int i = 0; i < most; i++) {
		char *end;
		double number = strtod(at, &end);
		if (end == at || (*end != 0 && *end != ' ' && *end != '\t') || !(fabs(number) <= 65536))
			break;
		if (keep && i < 2)
			keep[i] = number;
		at = skip_space(end);
	}
	return at;
}

/* The file name behind the options of a map_ statement, which may have spaces. */
static char *map_name(char *at, struct eco_mtl_material *m)
{
	const struct option *o;
	for (at = skip_space(at); (o = option_at(at));) {
		at = skip_space(skip_word(at));
		if (o->numbers > 0)
			at = read_numbers(at, o->numbers, !m ? NULL : strcmp(o->name, "-s") == 0
				? m->uv_scale
				: strcmp(o->name, "-o") == 0 ? m->uv_offset : NULL);
		for (int i = 0; i < o->words; i++)
			at = skip_space(skip_word(at));
	}
	size_t length = strlen(at);
	if (length >= 2 && at[0] == '"' && at[length - 1] == '"') {
		at[length - 1] = 0;
		at++;
	}
	return at;
}

static void set_text(char **to, const char *text)
{
	if (*text == 0)
		return;
	free(*to);
	*to = eco_copy_text(text);
}

static void read_color(char *rest, struct eco_mtl_material *m)
{
	double rgb[3];
	int count = 0;
	for (char *word; count < 3 && (word = next_word(&rest)); count++) {
		char *end;
		rgb[count] = strtod(word, &end);
		if (*end != 0 || !isfinite(rgb[count]))
			return;
	}
	if (count != 1 && count != 3)
		return;
	for (int k = 0; k < 3; k++)
		m->rgb[k] = rgb[count == 1 ? 0 : k];
	m->has_color = true;
}

static void read_share(char *rest, double *to, bool *has)
{
	char *word = next_word(&rest), *end;
	if (word && strcmp(word, "-halo") == 0)
		word = next_word(&rest);
	double share = word ? strtod(word, &end) : 0;
	if (!word || *end != 0 || !isfinite(share))
		return;
	*to = share;
	*has = true;
}

static void read_statement(struct eco_mtl_material *m, const char *key, char *rest)
{
	if (strcasecmp(key, "Kd") == 0)
		read_color(rest, m);
	else if (strcmp(key, "d") == 0)
		read_share(rest, &m->d, &m->has_d);
	else if (strcasecmp(key, "Tr") == 0)
		read_share(rest, &m->tr, &m->has_tr);
	else if (strcasecmp(key, "map_Kd") == 0)
		set_text(&m->texture, map_name(rest, m));
	else if (strcasecmp(key, "map_d") == 0 || strcasecmp(key, "map_opacity") == 0)
		set_text(&m->opacity, map_name(rest, NULL));
}

/* Cuts off a statement's key; *rest becomes its arguments. */
static char *split_key(char *line, char **rest)
{
	char *end = skip_word(line);
	*rest = end;
	if (*end != 0) {
		*end = 0;
		*rest = skip_space(end + 1);
	}
	return line;
}

enum eco_code eco_mtl_read(struct eco_mtl *mtl, const char *path, struct eco_error *error)
{
	struct eco_obj_text text = { .path = path };
	uint8_t *bytes;
	size_t size;
	char *line, *key, *rest;
	bool inside = false;
	if (eco_file_read(path, MTL_BYTES_MAX, &bytes, &size, error) != ECO_OK)
		return error ? error->code : ECO_IO;
	mtl->linear |= memmem(bytes, size < 4096 ? size : 4096, "Blender", 7) != NULL;
	text.at = (char *)bytes + (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
	text.end = (char *)bytes + size;
	while ((line = next_line(&text, false))) {
		key = split_key(line, &rest);
		if (strcasecmp(key, "newmtl") == 0 && mtl->count < MATERIALS_MAX) {
			mtl->items = eco_realloc(mtl->items, (size_t)mtl->count + 1, sizeof *mtl->items);
			mtl->items[mtl->count++] = (struct eco_mtl_material){ .name = eco_copy_text(rest),
				.uv_scale = { 1, 1 } };
			inside = true;
		} else if (inside) {
			read_statement(&mtl->items[mtl->count - 1], key, rest);
		}
	}
	free(bytes);
	return ECO_OK;
}

/* The number of a name, in any case if `fold`. */
static uint32_t number_folded(struct eco_string_pool *names, const char *name, bool fold)
{
	char *text = eco_copy_text(name);
	for (char *c = text; fold && *c != 0; c++)
		*c = (char)tolower((unsigned char)*c);
	uint32_t number = eco_string_number(names, text);
	free(text);
	return number;
}

/* Finds the names that are not found yet. Each list of names is walked once: both may be long. */
static void find_names(const struct eco_mtl *mtl, char *const *names, uint32_t count, bool fold,
	const struct eco_mtl_material **found)
{
	struct eco_string_pool known = { 0 };
	uint32_t *last = eco_alloc((size_t)mtl->count + 1, sizeof *last);
	for (uint32_t i = 0; i < mtl->count; i++)
		last[number_folded(&known, mtl->items[i].name, fold)] = i;
	uint32_t known_count = known.count;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t number = !found[i] ? number_folded(&known, names[i], fold) : known_count;
		if (number < known_count)
			found[i] = &mtl->items[last[number]];
	}
	free(last);
	eco_string_pool_free(&known);
}

void eco_mtl_find(const struct eco_mtl *mtl, char *const *names, uint32_t count,
	const struct eco_mtl_material **found)
{
	memset(found, 0, count * sizeof *found);
	find_names(mtl, names, count, false, found);
	find_names(mtl, names, count, true, found);
}

double eco_mtl_alpha(const struct eco_mtl_material *m)
{
	return m->has_d ? m->d : m->has_tr ? 1 - m->tr : 1;
}

void eco_mtl_free(struct eco_mtl *mtl)
{
	for (uint32_t i = 0; i < mtl->count; i++) {
		free(mtl->items[i].name);
		free(mtl->items[i].texture);
		free(mtl->items[i].opacity);
	}
	free(mtl->items);
	*mtl = (struct eco_mtl){ .count = 0 };
}
