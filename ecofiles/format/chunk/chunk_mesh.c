/* Connected wood through edgebreaker. It codes a vertex once for all its triangles and derives the triangles'
 * order from their neighbours. In return it chooses order and first corners itself, and may drop triangles.
 * Therefore the encoder decodes its output, finds each triangle again, and stores colours and texture coordinates in
 * that order; if a triangle is missing or altered, the caller codes the chunk in another way. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/format/chunk/chunk_columns.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/chunk/draco_shim.h"

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
	struct turned *turned = eco_alloc(triangles, sizeof *turned);
	for (uint32_t i = 0; i < triangles; i++)
		turn(&turned[i], position + 9 * (size_t)i, i);
	qsort(turned, triangles, sizeof *turned, compare_turned);
	return turned;
}

/* For a decoded triangle: the input triangle, and which of its corners comes first. */
struct match { uint32_t triangle; uint8_t corner; };

/* NULL: not the same triangles. */
static struct match *match_triangles(const int32_t *input, const int32_t *decoded, uint32_t triangles)
{
	struct turned *a = turn_all(input, triangles), *b = turn_all(decoded, triangles);
	struct match *matches = eco_alloc(triangles, sizeof *matches);
	bool same = true;
	for (uint32_t i = 0; same && i < triangles; i++) {
		same = compare_positions(a[i].position, b[i].position, 9) == 0;
		matches[b[i].index] =
			(struct match){ a[i].index, (uint8_t)((a[i].first + 3 - b[i].first) % 3) };
	}
	free(a);
	free(b);
	if (same)
		return matches;
	free(matches);
	return NULL;
}

struct corner { int32_t position[3]; uint32_t index; };

static int compare_corners(const void *left, const void *right)
{
	const struct corner *a = left, *b = right;
	int order = compare_positions(a->position, b->position, 3);
	return order != 0 ? order : a->index < b->index ? -1 : a->index > b->index;
}

/* Merges corners at equal positions into one vertex. vertices: 3 per vertex, room for all corners; index:
 * one per corner. Returns how many there are. */
static uint32_t weld(const int32_t *position, uint32_t corner_count, int32_t *vertices, uint32_t *index)
{
	struct corner *corners = eco_alloc(corner_count, sizeof *corners);
	uint32_t count = 0;
	for (uint32_t i = 0; i < corner_count; i++) {
		memcpy(corners[i].position, position + 3 * (size_t)i, sizeof corners[i].position);
		corners[i].index = i;
	}
	qsort(corners, corner_count, sizeof *corners, compare_corners);
	for (uint32_t i = 0; i < corner_count; i++) {
		if (i == 0 || compare_positions(corners[i].position, corners[i - 1].position, 3) != 0)
			memcpy(vertices + 3 * (size_t)count++, corners[i].position,
				sizeof corners[i].position);
		index[corners[i].index] = count - 1;
	}
	free(corners);
	return count;
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

static bool has_area(const uint32_t *index)
{
	return index[0] != index[1] && index[1] != index[2] && index[2] != index[0];
}

/* Encodes the positions, decodes them again and matches; vertex: one per decoded corner. NULL: Draco cannot
 * code them, or not everything came back. */
static struct match *encode_positions(const int32_t *position, uint32_t triangles, struct eco_stream *stream,
	uint32_t *vertex)
{
	uint32_t corner_count = 3 * triangles, *index = eco_alloc(corner_count, sizeof *index);
	int32_t *vertices = eco_alloc(corner_count, 3 * sizeof *vertices),
		*decoded = eco_alloc(corner_count, 3 * sizeof *decoded);
	uint32_t vertex_count = weld(position, corner_count, vertices, index);
	uint8_t *bytes = NULL;
	bool fits = narrow(position, corner_count);
	for (uint32_t i = 0; fits && i < triangles; i++)
		fits = has_area(index + 3 * (size_t)i);
	fits = fits && !eco_draco_encode_mesh(vertices, vertex_count, index, triangles, &bytes, &stream->size, NULL)
		&& !eco_draco_decode_mesh(bytes, stream->size, triangles, decoded, vertex, NULL);
	stream->bytes = bytes;
	struct match *matches = fits ? match_triangles(position, decoded, triangles) : NULL;
	eco_free(index, vertices, decoded);
	return matches;
}

/* ---- The stream beside a mesh: parts, uv of three corners, then the extra values, in decoded order ---- */

struct side {
	struct eco_chunk_rows rows;
	uint32_t part_columns, uv_columns;
	int32_t (*uv)[2];            /* by vertex: its last one, which predicts the next; or else ... */
	bool *seen;
	int32_t last[2];             /* ... the last of all */
};

static bool side_make(struct side *s, const struct eco_list *list, const struct eco_stream *stream)
{
	struct eco_chunk_rows *rows = &s->rows;
	*s = (struct side){ .rows.stream = *stream, .part_columns = stream->predictors };
	for (uint32_t i = 0; i < s->part_columns; i++)
		rows->columns[rows->column_count++] = (struct eco_column){ .components = 1 };
	for (uint32_t c = 0; c < 3 && (list->attributes & ECO_ATTR_UV); c++)
		rows->columns[rows->column_count++] = (struct eco_column){ .components = 2 };
	s->uv_columns = rows->column_count - s->part_columns;
	for (uint32_t i = 0; i < eco_list_extra_count(list); i++)
		rows->columns[rows->column_count++] = (struct eco_column){ .components = 1 };
	rows->storage = eco_rows_storage(rows->columns, rows->column_count, stream->elements);
	s->uv = calloc(3 * (size_t)stream->elements, sizeof *s->uv);
	s->seen = calloc(3 * (size_t)stream->elements, 1);
	return rows->storage && s->uv && s->seen;
}

static void side_free(struct side *s)
{
	eco_rows_free(&s->rows);
	free(s->uv);
	free(s->seen);
}

/* Writes the column's value, or reads it into `value`. False: it is out of bounds. */
static bool code_value(int32_t *column, int32_t known, int32_t *value, bool writing)
{
	int64_t v = (int64_t)*column + known;
	bool good = writing || (v >= -ECO_ROWS_VALUE_MAX && v <= ECO_ROWS_VALUE_MAX);
	if (writing)
		*column = *value - known;
	else
		*value = good ? (int32_t)v : 0;
	return good;
}

/* Values of e->uv and e->extra to columns, if `writing`, or back. False: some are out of bounds. */
static bool code_side(struct side *s, const struct eco_elements *e, const uint32_t *vertex, bool writing)
{
	const struct eco_column *columns = s->rows.columns + s->part_columns;
	bool good = true;
	int32_t last = 0;
	for (size_t i = 0; i < e->element_count; i++) {
		if (s->part_columns) {
			good &= code_value(&s->rows.columns->values[i], last, &e->part[i], writing);
			last = e->part[i];
		}
		for (uint32_t c = 0; c < s->uv_columns; c++) {
			uint32_t v = vertex[3 * i + c];
			int32_t *uv = e->uv + 2 * (3 * i + c), *known = s->seen[v] ? s->uv[v] : s->last;
			for (int k = 0; k < 2; k++)
				good &= code_value(&columns[c].values[2 * i + (size_t)k], known[k], &uv[k], writing);
			s->seen[v] = true;
			memcpy(s->uv[v], uv, sizeof s->last);
			memcpy(s->last, uv, sizeof s->last);
		}
		for (uint32_t k = 0; k < e->extra_count; k++)
			good &= code_value(&columns[s->uv_columns + k].values[i], 0, &e->extra[e->extra_count * i + k],
				writing);
	}
	return good;
}

static void encode_side(const struct eco_chunk_input *input, const struct match *matches, const uint32_t *vertex,
	struct eco_stream *stream)
{
	const struct eco_elements *e = input->elements;
	uint32_t triangles = input->end - input->first;
	struct eco_elements ordered = { .element_count = triangles, .extra_count = e->extra_count,
		.uv = eco_alloc(triangles, 6 * sizeof *e->uv),
		.extra = eco_alloc((size_t)triangles * e->extra_count, sizeof *e->extra),
		.part = eco_alloc(triangles, sizeof *e->part) };
	struct side side;
	for (size_t i = 0; i < triangles; i++) {
		size_t triangle = input->first + (size_t)matches[i].triangle;
		for (uint32_t c = 0; c < 3 && e->uv; c++)
			memcpy(ordered.uv + 2 * (3 * i + c), e->uv + 2 * (3 * triangle
				+ (c + matches[i].corner) % 3), 2 * sizeof *e->uv);
		for (uint32_t k = 0; k < e->extra_count; k++)
			ordered.extra[e->extra_count * i + k] = e->extra[e->extra_count * triangle + k];
		ordered.part[i] = e->part ? e->part[triangle] : 0;
		stream->predictors |= ordered.part[i] != ordered.part[0];
	}
	if (!side_make(&side, input->list, stream))
		eco_end("no memory");
	code_side(&side, &ordered, vertex, true);
	eco_columns_encode(&side.rows, stream);
	side_free(&side);
	eco_elements_free(&ordered);
}

bool eco_mesh_encode(const struct eco_chunk_input *input, struct eco_payload *payload)
{
	bool sided = input->list->attributes != 0;
	uint32_t triangles = input->end - input->first, *vertex = eco_alloc(triangles, 3 * sizeof *vertex);
	struct eco_stream *side = payload->streams, *mesh = payload->streams + sided;
	payload->stream_count = sided ? 2 : 1;
	side->corners = 1;
	mesh->corners = 3;
	side->elements = mesh->elements = triangles;
	struct match *matches = encode_positions(input->elements->position + 9 * (size_t)input->first, triangles, mesh,
		vertex);
	if (matches && sided)
		encode_side(input, matches, vertex, side);
	free(vertex);
	free(matches);
	return matches != NULL;
}

struct parted { int32_t part; uint32_t index; };

ECO_ORDER_TWO(compare_parted, struct parted, ->part, ->index)

/* Puts values, `size` bytes for each of the triangles, into their order. False: no memory. */
static bool put_by(const struct parted *order, uint32_t triangles, void *values, size_t size)
{
	uint8_t *copy = malloc(triangles * size), *to = values;
	for (uint32_t i = 0; copy && i < triangles; i++)
		memcpy(copy + i * size, to + order[i].index * size, size);
	if (copy)
		memcpy(to, copy, triangles * size);
	free(copy);
	return copy;
}

static bool sort_parts(struct eco_elements *e)
{
	uint32_t triangles = e->element_count;
	struct parted *order = malloc(triangles * sizeof *order);
	for (uint32_t i = 0; order && i < triangles; i++)
		order[i] = (struct parted){ e->part[i], i };
	if (order)
		qsort(order, triangles, sizeof *order, compare_parted);
	bool good = order && put_by(order, triangles, e->position, 9 * sizeof *e->position)
		&& (!e->uv || put_by(order, triangles, e->uv, 6 * sizeof *e->uv))
		&& (!e->extra || put_by(order, triangles, e->extra, e->extra_count * sizeof *e->extra));
	free(order);
	free(e->part);
	e->part = NULL;
	return good;
}

static enum eco_code decode_side(const struct eco_list *list, const struct eco_stream *stream,
	const uint32_t *vertex, struct eco_elements *e, struct eco_error *error)
{
	struct side side;
	e->part = stream->predictors ? malloc(e->element_count * sizeof *e->part) : NULL;
	enum eco_code code = side_make(&side, list, stream) && (e->part || !stream->predictors) ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for attributes of %u triangles",
		e->element_count);
	if (!code)
		code = eco_columns_decode(&side.rows, error);
	if (!code && !code_side(&side, e, vertex, false))
		code = eco_fail(error, ECO_DAMAGED, "chunk: an attribute of the mesh is out of bounds");
	if (!code && e->part && !sort_parts(e))
		code = eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for parts of %u triangles",
			e->element_count);
	side_free(&side);
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
