/* A small reader of PLY (Turk 1994, "The PLY polygon file format"), text or binary, for what assimp 5.2 drops
 * without a word: colours of faces and strips of triangles. Each corner of a coloured face becomes a vertex
 * of its own. */
#include "ecofiles/import/model/ply_plain.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_file.h"

#define HEAD_BYTES 65536u
#define ELEMENTS_MOST 16u
#define PROPERTIES_MOST 64u
#define CORNERS_MOST (1u << 24)

enum use { OTHER, X, Y, Z, RED, GREEN, BLUE, INDICES, USES };

struct property { char type, count_type; enum use use; };        /* types: one letter; count_type 0: no list */
struct element {
	char name[32];
	uint64_t count;
	struct property of[PROPERTIES_MOST]; uint32_t property_count;
};

struct ply {
	const char *path;
	uint8_t *bytes, *at, *end;
	size_t size;
	char format;                 /* a: text; l, b: binary, little or big end first */
	struct element elements[ELEMENTS_MOST]; uint32_t element_count;
	double (*vertex)[USES]; uint64_t vertex_count;       /* by use */
	int64_t *corner; uint32_t corner_count, corner_capacity;     /* of the list being read */
	FILE *out, *faces;
	uint64_t out_vertices, out_triangles;
	bool colored, by_vertex, broken;     /* colored: faces have colours, or, by_vertex, the corners of strips */
};

/* One letter for each type: its size and form follow. */
static char type_named(const char *name)
{
	static const struct { const char *name; char letter; } types[] = { { "char", 'c' }, { "int8", 'c' }, { "uchar", 'C' },
		{ "uint8", 'C' }, { "short", 's' }, { "int16", 's' }, { "ushort", 'S' }, { "uint16", 'S' }, { "int", 'i' },
		{ "int32", 'i' }, { "uint", 'I' }, { "uint32", 'I' }, { "float", 'f' }, { "float32", 'f' },
		{ "double", 'd' }, { "float64", 'd' } };
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (strcmp(types[i].name, name) == 0)
			return types[i].letter;
	return 0;
}

static size_t size_of(char type) { return strchr("cC", type) ? 1 : strchr("sS", type) ? 2 : type == 'd' ? 8 : 4; }

static enum use use_of(const char *name)
{
	static const struct { const char *name; enum use use; } uses[] = { { "x", X }, { "y", Y }, { "z", Z },
		{ "red", RED }, { "green", GREEN }, { "blue", BLUE }, { "diffuse_red", RED }, { "diffuse_green", GREEN },
		{ "diffuse_blue", BLUE }, { "r", RED }, { "g", GREEN }, { "b", BLUE }, { "vertex_indices", INDICES },
		{ "vertex_index", INDICES } };
	for (size_t i = 0; i < sizeof uses / sizeof *uses; i++)
		if (strcmp(uses[i].name, name) == 0)
			return uses[i].use;
	return OTHER;
}

/* ---- The head ---- */

static void read_property(struct ply *p, const char *line)
{
	char type[32], count[32], name[64];
	struct element *e = p->element_count > 0 ? &p->elements[p->element_count - 1] : NULL;
	if (!e || e->property_count == PROPERTIES_MOST) {
		p->broken = true;
		return;
	}
	struct property *to = &e->of[e->property_count++];
	if (sscanf(line, "property list %31s %31s %63s", count, type, name) == 3)
		*to = (struct property){ type_named(type), type_named(count), use_of(name) };
	else if (sscanf(line, "property %31s %63s", type, name) == 2)
		*to = (struct property){ type_named(type), 0, use_of(name) };
	p->broken = p->broken || to->type == 0;
}

static void read_line(struct ply *p, const char *line)
{
	unsigned long long count;
	char word[32];
	if (sscanf(line, "format %31s", word) == 1)
		p->format = word[0] == 'a' ? 'a' : strstr(word, "big") ? 'b' : 'l';
	else if (strncmp(line, "element", 7) == 0 && p->element_count < ELEMENTS_MOST) {
		struct element *e = &p->elements[p->element_count++];
		p->broken = p->broken || sscanf(line, "element %31s %llu", e->name, &count) != 2;
		e->count = count;
	} else if (strncmp(line, "property", 8) == 0)
		read_property(p, line);
}

static bool read_head(struct ply *p)
{
	char line[256];
	while (p->at < p->end && !p->broken) {
		uint8_t *stop = memchr(p->at, '\n', (size_t)(p->end - p->at));
		if (!stop)
			return false;
		snprintf(line, sizeof line, "%.*s", (int)(stop - p->at < 255 ? stop - p->at : 255), (char *)p->at);
		line[strcspn(line, "\r")] = 0;
		p->at = stop + 1;
		if (strcmp(line, "end_header") == 0)
			return true;
		read_line(p, line);
	}
	return false;
}

static bool has_use(const struct element *e, enum use use)
{
	for (uint32_t i = 0; i < e->property_count; i++)
		if (e->of[i].use == use)
			return true;
	return false;
}

/* Whether assimp would lose something. */
static bool is_needed(struct ply *p)
{
	bool strips = false, vertices = false;
	for (uint32_t i = 0; i < p->element_count; i++) {
		bool own = strcmp(p->elements[i].name, "tristrips") == 0;
		strips |= own;
		vertices |= strcmp(p->elements[i].name, "vertex") == 0 && has_use(&p->elements[i], RED);
		p->colored |= (own || strcmp(p->elements[i].name, "face") == 0) && has_use(&p->elements[i], RED);
	}
	p->by_vertex = strips && vertices && !p->colored;
	p->colored |= p->by_vertex;
	return strips || p->colored;
}

/* ---- Values ---- */

static double read_value(struct ply *p, char type)
{
	uint8_t raw[8];
	size_t size = size_of(type);
	if (p->format == 'a') {
		char *end;
		double value = strtod((char *)p->at, &end);
		p->broken = p->broken || end == (char *)p->at;
		p->at = (uint8_t *)end;
		return value;
	}
	if ((size_t)(p->end - p->at) < size) {
		p->broken = true;
		return 0;
	}
	for (size_t i = 0; i < size; i++)
		raw[p->format == 'b' ? size - 1 - i : i] = p->at[i];
	p->at += size;
	uint64_t bits = 0;
	for (size_t i = size; i-- > 0;)
		bits = bits << 8 | raw[i];
	float single;
	double both;
	memcpy(&single, raw, sizeof single);
	memcpy(&both, raw, sizeof both);
	switch (type) {
	case 'c': return (int8_t)bits;
	case 's': return (int16_t)bits;
	case 'i': return (int32_t)bits;
	case 'f': return (double)single;
	case 'd': return both;
	default: return (double)bits;
	}
}

/* Reads a row: numbers by use, and the list of indices. */
static void read_row(struct ply *p, const struct element *e, double values[USES])
{
	for (uint32_t i = 0; i < e->property_count && !p->broken; i++) {
		const struct property *of = &e->of[i];
		double count = of->count_type ? read_value(p, of->count_type) : 1;
		p->broken = p->broken || !(count >= 0 && count <= CORNERS_MOST);
		for (uint32_t k = 0; !p->broken && k < (uint32_t)count; k++) {
			double value = read_value(p, of->type);
			if (of->use == INDICES) {
				eco_grow(&p->corner, &p->corner_capacity, p->corner_count, sizeof *p->corner);
				p->corner[p->corner_count++] = isfinite(value) ? (int64_t)value : -1;
			} else if (!of->count_type)
				values[of->use] = strchr("fd", of->type) && of->use >= RED && of->use <= BLUE ? 255 * value
					: value;
		}
	}
}

/* ---- Triangles ---- */

static void write_corner(struct ply *p, int64_t index, const double values[USES])
{
	const double *at = p->vertex[index];
	fprintf(p->out, "%.9g %.9g %.9g", at[X], at[Y], at[Z]);
	for (int k = RED; k <= BLUE && p->colored; k++)
		fprintf(p->out, " %d", (int)fmin(fmax((p->by_vertex ? at : values)[k] + 0.5, 0), 255));
	fprintf(p->out, "\n");
}

static void write_triangle(struct ply *p, int64_t a, int64_t b, int64_t c, const double values[USES])
{
	const int64_t v[3] = { a, b, c };
	for (int k = 0; k < 3; k++)
		if (v[k] < 0 || (uint64_t)v[k] >= p->vertex_count)
			return;
	if (a == b || b == c || a == c)
		return;
	for (int k = 0; k < 3; k++)
		write_corner(p, v[k], values);
	fprintf(p->faces, "3 %llu %llu %llu\n", (unsigned long long)p->out_vertices,
		(unsigned long long)p->out_vertices + 1, (unsigned long long)p->out_vertices + 2);
	p->out_vertices += 3;
	p->out_triangles++;
}

/* -1 ends a strip; every second triangle is turned. */
static void write_strips(struct ply *p, const double values[USES])
{
	uint32_t first = 0;
	for (uint32_t i = 0; i < p->corner_count; i++) {
		const int64_t *v = p->corner;
		if (v[i] < 0)
			first = i + 1;
		else if (i >= first + 2)
			write_triangle(p, v[i - 2 + (i - first) % 2], v[i - 1 - (i - first) % 2], v[i], values);
	}
}

static void write_face(struct ply *p, const double values[USES])
{
	for (uint32_t i = 2; i < p->corner_count; i++)
		write_triangle(p, p->corner[0], p->corner[i - 1], p->corner[i], values);
}

static void read_element(struct ply *p, const struct element *e)
{
	bool vertices = strcmp(e->name, "vertex") == 0, strips = strcmp(e->name, "tristrips") == 0,
	     faces = strcmp(e->name, "face") == 0;
	if (vertices && (p->vertex || e->count > p->size)) {
		p->broken = true;
		return;
	}
	if (vertices)
		p->vertex = eco_alloc(e->count + 1, sizeof *p->vertex);
	for (uint64_t row = 0; row < e->count && !p->broken; row++) {
		double values[USES] = { [RED] = 153, [GREEN] = 153, [BLUE] = 153 };
		p->corner_count = 0;
		read_row(p, e, values);
		if (vertices)
			memcpy(p->vertex[p->vertex_count++], values, sizeof *p->vertex);
		else if (strips)
			write_strips(p, values);
		else if (faces)
			write_face(p, values);
	}
}

/* ---- The file ---- */

static enum eco_code write_plain(struct ply *p, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	char *corners = NULL, *faces = NULL, *all = NULL;
	size_t corner_bytes = 0, face_bytes = 0;
	p->out = open_memstream(&corners, &corner_bytes);
	p->faces = open_memstream(&faces, &face_bytes);
	for (uint32_t i = 0; i < p->element_count && !p->broken; i++)
		read_element(p, &p->elements[i]);
	fclose(p->out);
	fclose(p->faces);
	if (!p->broken)
		*size = (size_t)asprintf(&all, "ply\nformat ascii 1.0\nelement vertex %llu\nproperty float x\nproperty float y\n"
			"property float z\n%selement face %llu\n"
			"property list uchar int vertex_indices\nend_header\n%s%s", (unsigned long long)p->out_vertices,
			p->colored ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "",
			(unsigned long long)p->out_triangles, corners, faces);
	*bytes = (uint8_t *)all;
	free(corners);
	free(faces);
	return p->broken ? eco_fail(error, ECO_DAMAGED, "%.300s: it breaks off, or its elements are none of PLY; export it "
		"again", p->path) : ECO_OK;
}

enum eco_code eco_ply_plain(const char *path, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	struct ply p = { .path = path };
	*bytes = NULL;
	if (!eco_file_head_has(path, HEAD_BYTES, "tristrips") && !eco_file_head_has(path, HEAD_BYTES, "red"))
		return ECO_OK;
	enum eco_code code = eco_file_read(path, UINT32_MAX, &p.bytes, &p.size, error);
	if (code)
		return code;
	p.bytes = eco_realloc(p.bytes, p.size + 1, 1);
	p.bytes[p.size] = 0;             /* an end for strtod */
	p.at = p.bytes;
	p.end = p.bytes + p.size;
	if (read_head(&p) && is_needed(&p))
		code = write_plain(&p, bytes, size, error);
	eco_free(p.bytes, p.vertex, p.corner);
	return code;
}
