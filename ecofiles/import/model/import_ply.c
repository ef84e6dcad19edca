/* PLY before assimp sees it. assimp holds points as floats, whatever the file has: scans in map
 * coordinates would lose their leaves. Here vertices are first moved near the origin, in a copy of the
 * file: binary doubles in place, text line by line. A file without faces is a point cloud, and is refused
 * as one.
 *
 * assimp 5.2 takes a line feed at the start of binary data for the header's end and loses a byte. So such
 * a byte is raised by one here: it is the lowest byte of the first vertex's first number, or (big-endian)
 * the highest byte of a number near 10^-32. */
#include "ecofiles/import/model/import_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define PROPERTIES_MAX 256u

struct ply {
	const char *path;
	uint8_t *bytes;
	size_t size, data;           /* offset of the elements */
	enum { ASCII, LITTLE, BIG } format;
	uint64_t vertices, surfaces; /* of element "vertex"; of "face", "tristrips" and the like */
	bool vertex_first;
	uint32_t property_count;     /* of a vertex */
	size_t offset[PROPERTIES_MAX], stride;
	bool is_double[PROPERTIES_MAX];
	uint32_t axis[3];            /* properties x, y, z; ECO_NONE: absent */
};

static size_t type_bytes(const char *type)
{
	static const struct { const char *name; size_t bytes; } types[] =
		{ { "char", 1 }, { "uchar", 1 }, { "int8", 1 }, { "uint8", 1 },
		{ "short", 2 }, { "ushort", 2 }, { "int16", 2 }, { "uint16", 2 }, { "int", 4 }, { "uint", 4 },
		{ "int32", 4 }, { "uint32", 4 },
		{ "float", 4 }, { "float32", 4 }, { "double", 8 }, { "float64", 8 } };

	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (strcmp(type, types[i].name) == 0)
			return types[i].bytes;
	return 0;
}

static bool add_property(struct ply *p, const char *type, const char *name)
{
	uint32_t i = p->property_count;
	size_t bytes = type_bytes(type);
	if (i == PROPERTIES_MAX || bytes == 0)
		return false;
	p->offset[i] = p->stride;
	p->is_double[i] = bytes == 8;
	for (int k = 0; k < 3; k++)
		if (name[0] == "xyz"[k] && name[1] == 0)
			p->axis[k] = i;
	p->stride += bytes;
	p->property_count++;
	return true;
}

/* False: no header that leads to a vertex; assimp may still read it. */
static bool read_header(struct ply *p)
{
	size_t at = 0;
	bool in_vertex = false, any = false;
	while (at < p->size) {
		const uint8_t *end = memchr(p->bytes + at, '\n', p->size - at);
		char line[256], word[3][64] = { "", "", "" };
		size_t length = end ? (size_t)(end - (p->bytes + at)) : p->size - at;
		snprintf(line, sizeof line, "%.*s", length < 255 ? (int)length : 255,
			(const char *)p->bytes + at);
		at += length + 1;
		if (sscanf(line, "%63s %63s %63s", word[0], word[1], word[2]) < 1)
			continue;
		if (strcmp(word[0], "end_header") == 0) {
			p->data = at < p->size ? at : p->size;
			return true;
		}
		if (strcmp(word[0], "format") == 0)
			p->format = strcmp(word[1], "ascii") == 0 ? ASCII
				: strcmp(word[1], "binary_big_endian") == 0 ? BIG : LITTLE;
		if (strcmp(word[0], "element") == 0) {
			in_vertex = strcmp(word[1], "vertex") == 0;
			p->vertex_first |= in_vertex && !any;
			any = true;
			if (in_vertex)
				p->vertices = strtoull(word[2], NULL, 10);
			else if (strcmp(word[1], "edge") != 0)
				p->surfaces += strtoull(word[2], NULL, 10);
		}
		if (strcmp(word[0], "property") == 0 && in_vertex && !add_property(p, word[1], word[2]))
			return false;
	}
	return false;
}

/* ---- Binary ---- */

static double get_double(const uint8_t *from, bool big)
{
	uint64_t bits = 0;
	double value;
	for (int i = 0; i < 8; i++)
		bits |= (uint64_t)from[i] << (big ? 56 - 8 * i : 8 * i);
	memcpy(&value, &bits, sizeof value);
	return value;
}

static void put_double(uint8_t *to, bool big, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	for (int i = 0; i < 8; i++)
		to[i] = (uint8_t)(bits >> (big ? 56 - 8 * i : 8 * i));
}

static uint8_t *binary_at(const struct ply *p, uint64_t vertex, int k)
{
	return p->bytes + p->data + (size_t)vertex * p->stride + p->offset[p->axis[k]];
}

/* ---- Text ---- */

/* The numbers of x, y and z in a line, and their places in it; false if one is missing. */
static bool line_places(const struct ply *p, char *line, double place[3], char *from[3], char *to[3])
{
	int found = 0;
	for (uint32_t i = 0; i < p->property_count; i++) {
		char *end;
		double number = strtod(line, &end);
		if (end == line || memchr(line, '\n', (size_t)(end - line)))
			return false;
		for (int k = 0; k < 3; k++)
			if (p->axis[k] == i) {
				place[k] = number;
				from[k] = line + strspn(line, " \t");
				to[k] = end;
				found++;
			}
		line = end;
	}
	return found == 3;
}

static char *next_line(const struct ply *p, char *line)
{
	char *end = memchr(line, '\n', (size_t)((char *)p->bytes + p->size - line));
	return end ? end + 1 : (char *)p->bytes + p->size;
}

/* Copies the file with its vertices moved. */
static bool rewrite_text(struct eco_model_file *file, struct ply *p, const double base[3])
{
	char *line = (char *)p->bytes + p->data;
	size_t room = p->size + (size_t)p->vertices * 96 + 1, used = p->data;
	char *text = malloc(room);
	if (!text)
		return false;
	memcpy(text, p->bytes, p->data);
	for (uint64_t i = 0; i < p->vertices; i++) {
		char *next = next_line(p, line), *from[3], *to[3], *at = line;
		double place[3];
		if (!line_places(p, line, place, from, to)) {
			free(text);
			return false;
		}
		for (int k = 0; k < 3; k++) {            /* in the order of the file's columns */
			int first = 0;

			for (int j = 1; j < 3; j++)
				if (from[j] && (!from[first] || from[j] < from[first]))
					first = j;
			memcpy(text + used, at, (size_t)(from[first] - at));
			used += (size_t)(from[first] - at);
			used += (size_t)snprintf(text + used, room - used, "%.9g",
				place[first] - base[first]);
			at = to[first];
			from[first] = NULL;
		}
		memcpy(text + used, at, (size_t)(next - at));
		used += (size_t)(next - at);
		line = next;
	}
	memcpy(text + used, line, (size_t)((char *)p->bytes + p->size - line));
	used += (size_t)((char *)p->bytes + p->size - line);
	file->bytes = (uint8_t *)text;
	file->size_bytes = used;
	return true;
}

/* ---- Both ---- */

static bool find_bounds(struct ply *p, double low[3], double high[3])
{
	char *line = (char *)p->bytes + p->data, *from[3], *to[3];
	double place[3];
	for (int k = 0; k < 3; k++) {
		low[k] = INFINITY;
		high[k] = -INFINITY;
	}
	for (uint64_t i = 0; i < p->vertices; i++) {
		if (p->format == ASCII && !line_places(p, line, place, from, to))
			return false;
		for (int k = 0; k < 3 && p->format != ASCII; k++)
			place[k] = get_double(binary_at(p, i, k), p->format == BIG);
		if (p->format == ASCII)
			line = next_line(p, line);
		if (!isfinite(place[0] + place[1] + place[2]))
			continue;
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], place[k]);
			high[k] = fmax(high[k], place[k]);
		}
	}
	return low[0] <= high[0];
}

/* Whether the vertices can be moved: they come first, and are text or doubles. */
static bool can_move(const struct ply *p)
{
	if (!p->vertex_first || p->axis[0] == ECO_NONE || p->axis[1] == ECO_NONE || p->axis[2] == ECO_NONE)
		return false;
	if (p->format == ASCII)
		return p->vertices <= p->size;
	return p->is_double[p->axis[0]] && p->is_double[p->axis[1]] && p->is_double[p->axis[2]]
		&& p->vertices <= (p->size - p->data) / p->stride;
}

/* The changed copy replaces the file on disk. */
static void hand_over(struct eco_model_file *file, struct ply *p)
{
	file->bytes = p->bytes;
	file->size_bytes = p->size;
	p->bytes = NULL;
}

static bool starts_with_line_feed(const struct ply *p)
{
	return p->format != ASCII && p->data > 1 && p->data < p->size && p->bytes[p->data] == '\n'
		&& p->bytes[p->data - 2] != '\r';
}

enum eco_code eco_ply_prepare(struct eco_model_file *file, double base[3], struct eco_error *error)
{
	struct ply p = { .path = file->path, .axis = { ECO_NONE, ECO_NONE, ECO_NONE } };
	double low[3], high[3];
	bool moved = false;
	enum eco_code code = eco_file_read(file->path, ECO_MODEL_FILE_MAX, &p.bytes, &p.size, error);
	if (code)
		return code;
	if (read_header(&p) && p.surfaces == 0) {
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: no faces in it, only %llu points; a point "
			"cloud has no surfaces: make a mesh of it first", file->path,
			(unsigned long long)p.vertices);
	} else if (p.data > 0 && can_move(&p) && find_bounds(&p, low, high)) {
		eco_model_choose_base(low, high, base);
		if (base[0] == 0 && base[1] == 0 && base[2] == 0) {
			/* near enough */
		} else if (p.format == ASCII) {
			if (!rewrite_text(file, &p, base))
				base[0] = base[1] = base[2] = 0;
		} else {
			for (uint64_t i = 0; i < p.vertices; i++)
				for (int k = 0; k < 3; k++)
					put_double(binary_at(&p, i, k), p.format == BIG,
						get_double(binary_at(&p, i, k), p.format == BIG) - base[k]);
			moved = true;
		}
	}
	if (starts_with_line_feed(&p)) {
		p.bytes[p.data]++;
		moved = true;
	}
	if (code == ECO_OK && moved)
		hand_over(file, &p);
	free(p.bytes);
	return code;
}
