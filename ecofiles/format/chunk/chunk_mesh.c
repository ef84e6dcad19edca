/* Connected wood through edgebreaker. It codes a vertex once for all its triangles and derives the triangles'
 * order from their neighbours. In return it chooses order and first corners itself, and may drop triangles.
 * Therefore the encoder decodes its output, finds each triangle again, and stores colours and texture coordinates in
 * that order; if a triangle is missing or altered, the caller codes the chunk in another way. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_payload.h"

/* A triangle with its corners rotated so that the least position comes first: three rotations become one. */
struct turned {
	int32_t position[9];
	uint32_t index;              /* the triangle's number */
	uint8_t first;               /* the corner that comes first now */
};

static int compare_positions(const int32_t *a, const int32_t *b, int count)
{
	for (int i = 0; i < count; i++)
		if (a[i] != b[i])
			return a[i] < b[i] ? -1 : 1;
	return 0;
}

static int compare_turned(const void *left, const void *right)
{
	const struct turned *a = left, *b = right;
	int order = compare_positions(a->position, b->position, 9);
	return order != 0 ? order : a->index < b->index ? -1 : a->index > b->index;
}

static void turn(struct turned *out, const int32_t *position, uint32_t index)
{
	out->index = index;
	out->first = 0;
	for (uint8_t c = 1; c < 3; c++)
		if (compare_positions(position + 3 * c, position + 3 * out->first, 3) < 0)
			out->first = c;
	for (unsigned c = 0; c < 3; c++)
		memcpy(out->position + 3 * c, position + 3 * ((c + out->first) % 3), 3 * sizeof *position);
}

static struct turned *turn_all(const int32_t *position, uint32_t triangles)
{
	struct turned *turned = malloc(triangles * sizeof *turned);
	if (!turned)
		return NULL;
	for (uint32_t i = 0; i < triangles; i++)
		turn(&turned[i], position + 9 * (size_t)i, i);
	qsort(turned, triangles, sizeof *turned, compare_turned);
	return turned;
}

/* For a decoded triangle: the input triangle, and which of its corners comes first. */
struct match { uint32_t triangle; uint8_t corner; };

/* NULL with *same = false: not the same triangles; NULL with *same = true: out of memory. */
static struct match *match_triangles(const int32_t *input, const int32_t *decoded, uint32_t triangles,
	bool *same)
{
	struct turned *a = turn_all(input, triangles), *b = turn_all(decoded, triangles);
	struct match *matches = malloc(triangles * sizeof *matches);
	*same = true;
	if (!a || !b) {
		free(matches);
		matches = NULL;
	}
	for (uint32_t i = 0; matches && i < triangles; i++) {
		if (compare_positions(a[i].position, b[i].position, 9) != 0) {
			*same = false;
			free(matches);
			matches = NULL;
			break;
		}
		matches[b[i].index] =
			(struct match){ a[i].index, (uint8_t)((a[i].first + 3 - b[i].first) % 3) };
	}
	free(a);
	free(b);
	return matches;
}

struct corner { int32_t position[3]; uint32_t index; };

static int compare_corners(const void *left, const void *right)
{
	const struct corner *a = left, *b = right;
	int order = compare_positions(a->position, b->position, 3);
	return order != 0 ? order : a->index < b->index ? -1 : a->index > b->index;
}

/* Merges corners at equal positions into one vertex. vertices: 3 per vertex, room for all corners; index:
 * one per corner. */
static enum eco_code weld(const int32_t *position, uint32_t corner_count, int32_t *vertices, uint32_t *index,
	uint32_t *vertex_count, struct eco_error *error)
{
	struct corner *corners = malloc(corner_count * sizeof *corners);
	if (!corners)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u corners", corner_count);
	for (uint32_t i = 0; i < corner_count; i++) {
		memcpy(corners[i].position, position + 3 * (size_t)i, sizeof corners[i].position);
		corners[i].index = i;
	}
	qsort(corners, corner_count, sizeof *corners, compare_corners);
	*vertex_count = 0;
	for (uint32_t i = 0; i < corner_count; i++) {
		if (i == 0 || compare_positions(corners[i].position, corners[i - 1].position, 3) != 0)
			memcpy(vertices + 3 * (size_t)(*vertex_count)++, corners[i].position,
				sizeof corners[i].position);
		index[corners[i].index] = *vertex_count - 1;
	}
	free(corners);
	return ECO_OK;
}

static bool narrow(const int32_t *position, uint32_t corner_count)
{
	for (int axis = 0; axis < 3; axis++) {
		int32_t low = position[axis], high = position[axis];
		for (uint32_t i = 1; i < corner_count; i++) {
			int32_t v = position[3 * (size_t)i + axis];
			low = v < low ? v : low;
			high = v > high ? v : high;
		}
		if ((int64_t)high - low > ECO_DRACO_VALUE_MAX)
			return false;
	}
	return true;
}

/* The columns of the stream beside a mesh: uv of three corners, then the extra values. */
struct side {
	struct eco_draco_column columns[3 + ECO_ROWS_EXTRA_MAX];
	uint32_t column_count, extra_first;
	int32_t *storage;
};

static enum eco_code side_make(struct side *side, const struct eco_list *list, uint32_t triangles,
	struct eco_error *error)
{
	uint32_t extra_count = eco_list_extra_count(list), per_row = 0;
	int32_t *at;
	memset(side, 0, sizeof *side);
	if (list->attributes & ECO_ATTR_UV)
		for (int c = 0; c < 3; c++)
			side->columns[side->column_count++] = (struct eco_draco_column){ .components = 2 };
	side->extra_first = side->column_count;
	for (uint32_t i = 0; i < extra_count; i++)
		side->columns[side->column_count++] = (struct eco_draco_column){ .components = 1,
			.difference = true };
	for (uint32_t i = 0; i < side->column_count; i++)
		per_row += side->columns[i].components;
	at = side->storage = calloc((size_t)per_row * triangles, sizeof *at);
	if (!at)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for attributes of %u triangles",
			triangles);
	for (uint32_t i = 0; i < side->column_count; i++) {
		side->columns[i].values = at;
		at += (size_t)side->columns[i].components * triangles;
	}
	return ECO_OK;
}

/* Predicts a corner's uv: the last uv of its vertex, or else the last uv of all. */
struct uv_memory {
	int32_t (*uv)[2];            /* by vertex */
	bool *seen;
	int32_t last[2];
};

static enum eco_code uv_memory_make(struct uv_memory *memory, uint32_t triangles, struct eco_error *error)
{
	*memory = (struct uv_memory){ calloc(3 * (size_t)triangles, sizeof *memory->uv),
		calloc(3 * (size_t)triangles, 1), { 0, 0 } };
	if (!memory->uv || !memory->seen)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for texture coordinates of %u "
			"triangles", triangles);
	return ECO_OK;
}

static const int32_t *uv_recall(const struct uv_memory *memory, uint32_t vertex)
{
	return memory->seen[vertex] ? memory->uv[vertex] : memory->last;
}

static void uv_remember(struct uv_memory *memory, uint32_t vertex, const int32_t *uv)
{
	memory->seen[vertex] = true;
	memcpy(memory->uv[vertex], uv, sizeof memory->last);
	memcpy(memory->last, uv, sizeof memory->last);
}

static void uv_memory_free(struct uv_memory *memory)
{
	free(memory->uv);
	free(memory->seen);
}

/* Encodes uv and extra values in decoded order. *fits = false: values are too far apart for Draco. */
static enum eco_code encode_side(const struct eco_list *list, const struct eco_elements *e, uint32_t first,
	uint32_t triangles, const struct match *matches, const uint32_t *vertex, struct eco_stream *stream,
	bool *fits, struct eco_error *error)
{
	struct uv_memory memory;
	struct side side;
	enum eco_code code = side_make(&side, list, triangles, error),
		memory_code = uv_memory_make(&memory, triangles, error);
	uint8_t *bytes;
	code = code != ECO_OK ? code : memory_code;
	for (uint32_t i = 0; code == ECO_OK && i < triangles; i++) {
		size_t triangle = first + (size_t)matches[i].triangle;
		for (uint32_t c = 0; c < 3 && side.extra_first > 0; c++) {
			const int32_t *uv = e->uv + 2 * (3 * triangle + (c + matches[i].corner) % 3);
			const int32_t *known = uv_recall(&memory, vertex[3 * (size_t)i + c]);
			for (int k = 0; k < 2; k++) {
				int32_t v = uv[k] - known[k];
				side.columns[c].values[2 * (size_t)i + k] = v;
				*fits &= v <= ECO_DRACO_VALUE_MAX && v >= -ECO_DRACO_VALUE_MAX;
			}
			uv_remember(&memory, vertex[3 * (size_t)i + c], uv);
		}
		for (uint32_t k = 0; k < e->extra_count; k++) {
			int32_t v = e->extra[e->extra_count * triangle + k];
			side.columns[side.extra_first + k].values[i] = v;
			*fits &= v <= ECO_DRACO_VALUE_MAX / 2 && v >= -ECO_DRACO_VALUE_MAX / 2;
		}
	}
	if (code == ECO_OK && *fits)
		code = eco_draco_encode_rows(ECO_DRACO_SEQUENTIAL, side.columns, side.column_count, triangles,
			&bytes, &stream->size, error);
	if (code == ECO_OK && *fits)
		stream->bytes = bytes;
	uv_memory_free(&memory);
	free(side.storage);
	return code;
}

static bool degenerate(const uint32_t *index)
{
	return index[0] == index[1] || index[1] == index[2] || index[2] == index[0];
}

struct scratch {
	int32_t *vertices, *decoded;
	uint32_t *index, *vertex;
	struct match *matches;
};

static void scratch_free(struct scratch *s)
{
	free(s->vertices);
	free(s->decoded);
	free(s->index);
	free(s->vertex);
	free(s->matches);
}

/* Encodes the positions, decodes them again and matches: *fits says whether everything came back. */
static enum eco_code encode_positions(const int32_t *position, uint32_t triangles, struct scratch *s,
	struct eco_stream *stream, bool *fits, struct eco_error *error)
{
	uint32_t vertex_count = 0, corner_count = 3 * triangles;
	uint8_t *bytes;
	s->vertices = malloc(sizeof(int32_t) * 3 * corner_count);
	s->decoded = malloc(sizeof(int32_t) * 3 * corner_count);
	s->index = malloc(sizeof(uint32_t) * corner_count);
	s->vertex = malloc(sizeof(uint32_t) * corner_count);
	if (!s->vertices || !s->decoded || !s->index || !s->vertex)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u triangles", triangles);
	enum eco_code code = weld(position, corner_count, s->vertices, s->index, &vertex_count, error);
	for (uint32_t i = 0; code == ECO_OK && i < triangles; i++)
		if (degenerate(s->index + 3 * (size_t)i))
			return eco_fail(error, ECO_BAD_INPUT, "chunk: two corners of mesh triangle %u "
				"coincide; drop it before packing", i);
	*fits = narrow(position, corner_count);
	if (code != ECO_OK || !*fits)
		return code;
	/* A failure of Draco is not ours: the triangles can be coded otherwise. */
	*fits = eco_draco_encode_mesh(s->vertices, vertex_count, s->index, triangles, &bytes, &stream->size,
		NULL) == ECO_OK;
	if (!*fits)
		return ECO_OK;
	stream->bytes = bytes;
	*fits = eco_draco_decode_mesh(stream->bytes, stream->size, triangles, s->decoded, s->vertex, NULL)
		== ECO_OK;
	if (!*fits)
		return ECO_OK;
	s->matches = match_triangles(position, s->decoded, triangles, fits);
	if (!s->matches && *fits)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u triangles", triangles);
	return ECO_OK;
}

enum eco_code eco_mesh_encode(const struct eco_list *list, const struct eco_elements *elements,
	uint32_t first, uint32_t end, struct eco_payload *payload, bool *fits, struct eco_error *error)
{
	const int32_t *position = elements->position + 9 * (size_t)first;
	struct eco_stream *side = payload->streams, *mesh = payload->streams + (list->attributes != 0);
	struct scratch s = { 0 };
	payload->stream_count = list->attributes != 0 ? 2 : 1;
	side->corners = 1;
	mesh->corners = 3;
	side->elements = mesh->elements = end - first;
	enum eco_code code = encode_positions(position, end - first, &s, mesh, fits, error);
	if (code == ECO_OK && *fits && list->attributes != 0)
		code = encode_side(list, elements, first, end - first, s.matches, s.vertex, side, fits,
			error);
	scratch_free(&s);
	return code;
}

/* Undoes encode_side; the decoded values are bounded as those of other coders. */
static enum eco_code decode_side(const struct eco_list *list, const struct eco_stream *stream,
	const uint32_t *vertex, struct eco_elements *e, struct eco_error *error)
{
	struct uv_memory memory;
	struct side side;
	enum eco_code code = side_make(&side, list, e->element_count, error);
	enum eco_code memory_code = uv_memory_make(&memory, e->element_count, error);
	bool good = true;
	code = code != ECO_OK ? code : memory_code;
	if (!code)
		code = eco_draco_decode_rows(ECO_DRACO_SEQUENTIAL, stream->bytes, stream->size, side.columns,
			side.column_count, e->element_count, error);
	for (uint32_t i = 0; code == ECO_OK && good && i < e->element_count; i++) {
		for (uint32_t c = 0; c < 3 && side.extra_first > 0; c++) {
			int32_t *uv = e->uv + 2 * (3 * (size_t)i + c);
			const int32_t *known = uv_recall(&memory, vertex[3 * (size_t)i + c]);
			for (int k = 0; k < 2; k++) {
				int64_t v = (int64_t)side.columns[c].values[2 * (size_t)i + k] + known[k];
				good &= v >= -ECO_ROWS_VALUE_MAX && v <= ECO_ROWS_VALUE_MAX;
				uv[k] = good ? (int32_t)v : 0;
			}
			uv_remember(&memory, vertex[3 * (size_t)i + c], uv);
		}
		for (uint32_t k = 0; k < e->extra_count; k++) {
			int32_t v = side.columns[side.extra_first + k].values[i];
			good &= v >= -ECO_ROWS_VALUE_MAX && v <= ECO_ROWS_VALUE_MAX;
			e->extra[e->extra_count * (size_t)i + k] = v;
		}
	}
	uv_memory_free(&memory);
	free(side.storage);
	if (code == ECO_OK && !good)
		code = eco_fail(error, ECO_DAMAGED, "chunk: an attribute of the mesh is out of bounds");
	return code;
}

enum eco_code eco_mesh_decode(const struct eco_list *list, const struct eco_payload *payload,
	struct eco_elements *elements, struct eco_error *error)
{
	const struct eco_stream *mesh = &payload->streams[payload->stream_count - 1];
	uint32_t *vertex = malloc(sizeof(uint32_t) * 3 * elements->element_count);
	if (!vertex)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u triangles",
			elements->element_count);
	memset(elements->corners, 3, elements->element_count);
	enum eco_code code = eco_draco_decode_mesh(mesh->bytes, mesh->size, mesh->elements,
		elements->position, vertex, error);
	for (size_t i = 0; code == ECO_OK && i < 9 * (size_t)elements->element_count; i++)
		if (elements->position[i] < -ECO_ROWS_VALUE_MAX || elements->position[i] > ECO_ROWS_VALUE_MAX)
			code = eco_fail(error, ECO_DAMAGED, "chunk: a position of the mesh is out of bounds");
	if (code == ECO_OK && list->attributes != 0)
		code = decode_side(list, &payload->streams[0], vertex, elements, error);
	free(vertex);
	return code;
}
