/* SHAPES: a chunk whose repeated elements are placed shapes. What is left over stays corners.
 *
 * Stored order is that of ELEMENTS, so that forms of the elements need not know how these are coded. */
#include "ecofiles/chunk.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/bytes.h"
#include "ecofiles/chunk_payload.h"
#include "ecofiles/shape.h"

#define USES_LEAST 3u            /* elements of one shape: for fewer its entry costs more than it saves */
#define PLACING_COLUMNS 4u       /* kind, centre, turn, size; extra values follow */
#define COLUMNS_MAX (PLACING_COLUMNS + ECO_ROWS_EXTRA_MAX)
#define UV_MAX ECO_ROWS_VALUE_MAX
#define WIDTH_MAX 30u
#define DRACO_HEAD 30u           /* bytes that a stream takes beside its columns */
#define UNITS_SAMPLE 1024u       /* elements by which units are chosen */

/* The columns of placings. A kind is 4 * shape + which entry of the quaternion is left out. */
struct columns {
	struct eco_draco_column items[COLUMNS_MAX];
	uint32_t count, rows;
	int32_t *storage;
};

static enum eco_code columns_make(struct columns *c, uint32_t rows, uint32_t extra_count, struct eco_error *error)
{
	static const uint8_t components[PLACING_COLUMNS] = { 1, 3, 3, 1 };
	int32_t *at = c->storage = calloc((size_t)rows * (8 + extra_count), sizeof *at);

	assert(extra_count <= ECO_ROWS_EXTRA_MAX);
	if (c->storage == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u placed elements", rows);
	c->rows = rows;
	c->count = PLACING_COLUMNS + extra_count;
	for (uint32_t i = 0; i < c->count; i++) {
		c->items[i] = (struct eco_draco_column){ .values = at, .components = i < PLACING_COLUMNS ? components[i] : 1 };
		at += (size_t)rows * c->items[i].components;
	}
	return ECO_OK;
}

static void put_placing(const struct columns *c, uint32_t row, uint32_t shape, const struct eco_placing *p)
{
	c->items[0].values[row] = (int32_t)(4 * shape + p->left);
	for (uint32_t k = 0; k < 3; k++) {
		c->items[1].values[3 * (size_t)row + k] = p->center[k];
		c->items[2].values[3 * (size_t)row + k] = p->turn[k];
	}
	c->items[3].values[row] = p->size;
}

static struct eco_placing get_placing(const struct columns *c, uint32_t row, uint32_t *shape)
{
	struct eco_placing p = { .left = (uint8_t)(c->items[0].values[row] & 3), .size = c->items[3].values[row] };

	*shape = (uint32_t)c->items[0].values[row] / 4;
	for (uint32_t k = 0; k < 3; k++) {
		p.center[k] = c->items[1].values[3 * (size_t)row + k];
		p.turn[k] = c->items[2].values[3 * (size_t)row + k];
	}
	return p;
}

/* ---- Packed columns ---- */

/* The part of column values that one component has. */
struct span { int32_t *values; uint32_t stride, rows; };

static struct span span_of(const struct columns *c, uint32_t column, uint32_t component)
{
	return (struct span){ c->items[column].values + component, c->items[column].components, c->rows };
}

/* As many bits for each value as the largest needs, from the low end, each component from a new byte on. */
static void pack_span(struct eco_writer *w, struct span s)
{
	int32_t low = s.values[0], high = low;
	uint32_t width = 0, held = 0;
	uint64_t bits = 0;

	for (uint32_t i = 1; i < s.rows; i++) {
		int32_t v = s.values[(size_t)s.stride * i];

		low = v < low ? v : low;
		high = v > high ? v : high;
	}
	while ((uint32_t)(high - low) >> width)
		width++;
	eco_write_zigzag(w, low);
	eco_write_u8(w, (uint8_t)width);
	for (uint32_t i = 0; i < s.rows && width; i++) {
		bits |= (uint64_t)(uint32_t)(s.values[(size_t)s.stride * i] - low) << held;
		for (held += width; held >= 8; held -= 8, bits >>= 8)
			eco_write_u8(w, (uint8_t)bits);
	}
	if (held)
		eco_write_u8(w, (uint8_t)bits);
}

/* Refuses bits that are set where no value is. */
static bool unpack_span(struct eco_reader *r, struct span s)
{
	int64_t low = eco_read_zigzag(r);
	uint32_t width = eco_read_u8(r), held = 0;
	uint64_t bits = 0;

	if (r->failed || width > WIDTH_MAX || low < -2 * ECO_ROWS_VALUE_MAX || low > 2 * ECO_ROWS_VALUE_MAX)
		return false;
	const uint8_t *bytes = eco_read_bytes(r, ((uint64_t)width * s.rows + 7) / 8);
	for (uint32_t i = 0; bytes && i < s.rows; i++) {
		for (; held < width; held += 8)
			bits |= (uint64_t)*bytes++ << held;
		int64_t v = low + (int64_t)(bits & ((1u << width) - 1));
		if (v < -ECO_ROWS_VALUE_MAX || v > ECO_ROWS_VALUE_MAX)
			return false;
		s.values[(size_t)s.stride * i] = (int32_t)v;
		bits >>= width;
		held -= width;
	}
	return bytes != NULL && bits == 0;
}

/* ---- Encoding ---- */

struct encoding {
	const struct eco_chunk_input *input;
	const struct eco_placed_element *elements;
	uint32_t count, placed;
	struct eco_shapes shapes;
	uint32_t *of;                /* per stored element */
	struct eco_placing *placing;
	struct columns columns;
};

static bool find_shapes(struct encoding *c)
{
	size_t *at = malloc(c->count * sizeof *at);
	uint32_t *by_element = malloc(c->count * sizeof *by_element);
	bool good = at && by_element;

	for (uint32_t i = 0; good && i < c->count; i++)
		at[c->elements[i].element] = c->elements[i].corner_at;
	good = good && eco_shapes_find(&c->shapes, &(struct eco_shapes_input){ c->input->elements, c->input->first, c->input->end, at,
		ECO_EXACT_SHIFT }, USES_LEAST, by_element);
	for (uint32_t i = 0; good && i < c->count; i++)
		c->of[i] = by_element[c->elements[i].element];
	free(at);
	free(by_element);
	return good;
}

static uint32_t bit_length(uint32_t v)
{
	return v ? 32u - (uint32_t)__builtin_clz(v) : 0;
}

/* About how many bits a sample of the elements takes with the units in c->shapes. */
static double cost_of(const struct encoding *c, double soup_bits)
{
	const struct eco_elements *e = c->input->elements;
	uint32_t step = c->count / UNITS_SAMPLE + 1, placed = 0, left = 0, width = 0;
	int32_t low[4], high[4];

	for (uint32_t i = 0; i < c->count; i += step) {
		struct eco_placing p;

		if (c->of[i] == ECO_SHAPE_NONE)
			continue;
		if (!eco_shape_fit(&c->shapes, &c->shapes.items[c->of[i]], e->exact + 3 * c->elements[i].corner_at, ECO_EXACT_SHIFT, &p)) {
			left++;
			continue;
		}
		for (int k = 0; k < 4; k++) {
			int32_t v = k < 3 ? p.center[k] : p.size;

			low[k] = placed && low[k] < v ? low[k] : v;
			high[k] = placed && high[k] > v ? high[k] : v;
		}
		placed++;
	}
	for (int k = 0; k < 4 && placed > 0; k++)
		width += bit_length((uint32_t)(high[k] - low[k]));
	return step * (placed * (width + 3.0 * (c->shapes.turn_bits + 1)) + left * soup_bits) + (left ? ECO_STREAM_BITS : 0);
}

/* Coarser units take fewer bits, and leave more elements to corners. From the finest that could be of use, one kind of unit after the
 * other is made coarser as long as that pays. */
static void choose_units(struct encoding *c, double soup_bits)
{
	struct eco_shapes best = c->shapes;
	double least = cost_of(c, soup_bits);

	for (bool better = true; better;) {
		const struct eco_shapes from = best;

		better = false;
		for (int kind = 0; kind < 3; kind++) {
			c->shapes = from;
			if (kind == 0 ? from.turn_bits == 0 : kind == 1 ? from.size_shift > ECO_EXACT_SHIFT : from.place_shift >= ECO_EXACT_SHIFT)
				continue;
			c->shapes.turn_bits -= kind == 0;
			c->shapes.size_shift += kind == 1;
			c->shapes.place_shift += kind == 2;
			double cost = cost_of(c, soup_bits);
			if (cost < least) {
				least = cost;
				best = c->shapes;
				better = true;
			}
		}
	}
	c->shapes = best;
}

static void place_all(struct encoding *c, bool *soup)
{
	const int32_t *exact = c->input->elements->exact;

	for (uint32_t i = 0; i < c->count; i++) {
		soup[i] = c->of[i] == ECO_SHAPE_NONE || !eco_shape_fit(&c->shapes, &c->shapes.items[c->of[i]],
			exact + 3 * c->elements[i].corner_at, ECO_EXACT_SHIFT, &c->placing[i]);
		c->placed += !soup[i];
	}
}

static enum eco_code fill_columns(struct encoding *c, const bool *soup, struct eco_error *error)
{
	const struct eco_elements *e = c->input->elements;
	enum eco_code code = columns_make(&c->columns, c->placed, e->extra_count, error);

	for (uint32_t i = 0, row = 0; code == ECO_OK && i < c->count; i++) {
		uint32_t element = c->input->first + c->elements[i].element;

		if (soup[i])
			continue;
		put_placing(&c->columns, row, c->of[i], &c->placing[i]);
		for (uint32_t k = 0; k < e->extra_count; k++)
			c->columns.items[PLACING_COLUMNS + k].values[row] = e->extra[(size_t)e->extra_count * element + k];
		row++;
	}
	return code;
}

/* Values or differences, whichever is smaller; *good becomes false where Draco can code neither. */
static enum eco_code choose(struct eco_draco_column *column, uint32_t rows, bool *good, size_t *least, struct eco_error *error)
{
	int32_t low = column->values[0], high = low;
	size_t size[2] = { SIZE_MAX, SIZE_MAX };
	enum eco_code code = ECO_OK;

	for (size_t i = 0; i < (size_t)column->components * rows; i++) {
		low = column->values[i] < low ? column->values[i] : low;
		high = column->values[i] > high ? column->values[i] : high;
	}
	*good = *good && high <= ECO_DRACO_VALUE_MAX && low >= -ECO_DRACO_VALUE_MAX && high - low <= ECO_DRACO_VALUE_MAX;
	for (int difference = 0; *good && difference < 2 && code == ECO_OK; difference++) {
		uint8_t *bytes;

		column->difference = difference;
		code = eco_draco_encode_rows(ECO_DRACO_SEQUENTIAL, column, 1, rows, &bytes, &size[difference], error);
		free(bytes);
	}
	column->difference = size[1] < size[0];
	*least = size[1] < size[0] ? size[1] : size[0];
	return code;
}

static void pack_column(struct eco_writer *w, const struct columns *c, uint32_t column)
{
	for (uint32_t k = 0; k < c->items[column].components; k++)
		pack_span(w, span_of(c, column, k));
}

/* The columns in `mask` through Draco, the others packed. */
static enum eco_code write_mixed(struct eco_writer *w, const struct columns *c, uint32_t mask, struct eco_error *error)
{
	struct eco_draco_column coded[COLUMNS_MAX];
	uint32_t count = 0;
	uint8_t *bytes = NULL;
	size_t size = 0;
	enum eco_code code = ECO_OK;

	eco_write_varint(w, mask);
	for (uint32_t i = 0; i < c->count; i++)
		if (mask >> i & 1)
			coded[count++] = c->items[i];
		else
			pack_column(w, c, i);
	if (count > 0)
		code = eco_draco_encode_rows(ECO_DRACO_SEQUENTIAL, coded, count, c->rows, &bytes, &size, error);
	if (code == ECO_OK)
		eco_write_bytes(w, bytes, size);
	free(bytes);
	return code;
}

/* Draco's tables pay where rows are many and values repeat: none of the columns, those that gain by it, or all, whichever is smallest. */
static enum eco_code write_columns(struct eco_writer *w, struct columns *c, struct eco_error *error)
{
	uint32_t all = (1u << c->count) - 1, gain = 0;
	struct eco_writer best = { 0 };
	enum eco_code code = ECO_OK;

	for (uint32_t i = 0; i < c->count && code == ECO_OK; i++) {
		struct eco_writer packed = { 0 };
		bool good = true;
		size_t size = 0;

		code = choose(&c->items[i], c->rows, &good, &size, error);
		pack_column(&packed, c, i);
		if (good && size < packed.size + DRACO_HEAD)
			gain |= 1u << i;
		if (!good)
			all = 0;
		eco_writer_free(&packed);
	}
	const uint32_t masks[3] = { 0, gain, all };
	for (int i = 0; i < 3 && code == ECO_OK; i++) {
		struct eco_writer tried = { 0 };

		code = write_mixed(&tried, c, masks[i], error);
		if (best.bytes == NULL || tried.size < best.size) {
			struct eco_writer worse = best;

			best = tried;
			tried = worse;
		}
		best.failed |= tried.failed;
		eco_writer_free(&tried);
	}
	eco_write_bytes(w, best.bytes, best.size);
	w->failed |= best.failed;
	eco_writer_free(&best);
	return code;
}

static void write_shapes(struct eco_writer *w, const struct eco_shapes *shapes, bool uv)
{
	eco_write_u8(w, shapes->place_shift);
	eco_write_u8(w, shapes->size_shift);
	eco_write_u8(w, shapes->turn_bits);
	eco_write_u8(w, (uint8_t)(shapes->count - 1));
	for (uint32_t i = 0; i < shapes->count; i++) {
		const struct eco_shape *s = &shapes->items[i];

		eco_write_u8(w, s->corners);
		for (uint32_t k = 0; k < 3u * s->corners; k++)
			eco_write_zigzag(w, s->position[k]);
		for (uint32_t k = 0; uv && k < 2u * s->corners; k++)
			eco_write_zigzag(w, s->uv[k] - (k < 2 ? 0 : s->uv[k - 2]));
	}
}

/* One bit an element, from the low end: set where it is left to a stream of corners. */
static void write_mask(struct eco_writer *w, const bool *soup, uint32_t count)
{
	for (uint32_t i = 0; i < count; i += 8) {
		uint8_t bits = 0;

		for (uint32_t k = 0; k < 8 && i + k < count; k++)
			bits |= (uint8_t)(soup[i + k] << k);
		eco_write_u8(w, bits);
	}
}

static enum eco_code write_stream(struct encoding *c, struct eco_payload *payload, const bool *soup, struct eco_error *error)
{
	struct eco_writer w = { 0 };
	enum eco_code code;

	write_shapes(&w, &c->shapes, c->input->elements->uv != NULL);
	eco_write_varint(&w, c->placed);
	if (c->placed < c->count)
		write_mask(&w, soup, c->count);
	code = write_columns(&w, &c->columns, error);
	if (code == ECO_OK && w.failed)
		code = eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u placed elements", c->placed);
	if (code == ECO_OK)
		payload->streams[payload->stream_count++] = (struct eco_stream){ .corners = ECO_STREAM_PLACINGS, .elements = c->count,
			.bytes = w.bytes, .size = w.size };
	else
		eco_writer_free(&w);
	return code;
}

enum eco_code eco_shapes_encode(const struct eco_chunk_input *input, const struct eco_placed_element *elements, double soup_bits,
	struct eco_payload *payload, bool *soup, bool *fits, struct eco_error *error)
{
	struct encoding c = { .input = input, .elements = elements, .count = input->end - input->first };
	enum eco_code code = ECO_OK;

	*fits = false;
	c.of = malloc(c.count * sizeof *c.of);
	c.placing = calloc(c.count, sizeof *c.placing);
	if (c.of == NULL || c.placing == NULL || !find_shapes(&c))
		code = eco_fail(error, ECO_NO_MEMORY, "chunk %u: out of memory for the shapes of %u elements", input->ordinal, c.count);
	if (code == ECO_OK && c.shapes.count > 0) {
		choose_units(&c, soup_bits);
		place_all(&c, soup);
		*fits = c.placed > 0;
	}
	if (*fits)
		code = fill_columns(&c, soup, error);
	if (code == ECO_OK && *fits)
		code = write_stream(&c, payload, soup, error);
	eco_shapes_free(&c.shapes);
	free(c.of);
	free(c.placing);
	free(c.columns.storage);
	return code;
}

/* ---- Decoding ---- */

struct eco_shape_rows {
	uint32_t count, extra_count;
	struct eco_shapes shapes;
	uint8_t *corners;            /* per stored element */
	bool *soup;
	struct columns columns;
};

static bool read_shapes(struct eco_reader *r, struct eco_shapes *shapes, bool uv)
{
	shapes->place_shift = eco_read_u8(r);
	shapes->size_shift = eco_read_u8(r);
	shapes->turn_bits = eco_read_u8(r);
	shapes->count = eco_read_u8(r) + 1u;
	if (r->failed || shapes->place_shift > 15 || shapes->size_shift > 15 || shapes->turn_bits > ECO_SHAPE_TURN_BITS_MAX)
		return false;
	for (uint32_t i = 0; i < shapes->count; i++) {
		struct eco_shape *s = &shapes->items[i];

		s->corners = eco_read_u8(r);
		if (r->failed || s->corners < 3 || s->corners > ECO_CORNERS_MAX)
			return false;
		for (uint32_t k = 0; k < 3u * s->corners; k++) {
			int64_t v = eco_read_zigzag(r);

			if (r->failed || v < -ECO_SHAPE_COORDINATE_MAX || v > ECO_SHAPE_COORDINATE_MAX)
				return false;
			s->position[k] = (int32_t)v;
		}
		for (uint32_t k = 0; uv && k < 2u * s->corners; k++) {
			int64_t v = eco_read_zigzag(r);

			if (r->failed || v < -2 * (int64_t)UV_MAX || v > 2 * (int64_t)UV_MAX)
				return false;
			v += k < 2 ? 0 : s->uv[k - 2];
			if (v < -UV_MAX || v > UV_MAX)
				return false;
			s->uv[k] = (int32_t)v;
		}
	}
	return true;
}

/* As many elements are placed as stated, and no bit is set beyond the last element. */
static bool read_mask(struct eco_reader *r, struct eco_shape_rows *rows, uint32_t placed)
{
	const uint8_t *bits = eco_read_bytes(r, (rows->count + 7) / 8);
	uint32_t soup = 0;

	for (uint32_t i = 0; bits && i < rows->count; i++)
		soup += rows->soup[i] = bits[i / 8] >> i % 8 & 1;
	return bits && soup == rows->count - placed && (rows->count % 8 == 0 || bits[rows->count / 8] >> rows->count % 8 == 0);
}

static enum eco_code read_columns(struct eco_reader *r, struct columns *c, struct eco_error *error)
{
	struct eco_draco_column coded[COLUMNS_MAX];
	uint64_t mask = eco_read_varint(r);
	uint32_t count = 0;
	bool good = !r->failed && mask >> c->count == 0;

	for (uint32_t i = 0; i < c->count; i++) {
		if (mask >> i & 1)
			coded[count++] = c->items[i];
		for (uint32_t k = 0; good && !(mask >> i & 1) && k < c->items[i].components; k++)
			good = unpack_span(r, span_of(c, i, k));
	}
	if (!good || r->failed || (count == 0 && r->at != r->size))
		return eco_fail(error, ECO_DAMAGED, "chunk: columns of %u placings are cut short or impossible", c->rows);
	return count == 0 ? ECO_OK
		: eco_draco_decode_rows(ECO_DRACO_SEQUENTIAL, r->bytes + r->at, r->size - r->at, coded, count, c->rows, error);
}

/* Elements that are not placed have the corners of the streams, in their order: stored order ascends in corners. */
static bool find_corners(struct eco_shape_rows *rows, const struct eco_payload *payload)
{
	uint32_t row = 0, stream = 0, taken = 0;

	for (uint32_t i = 0; i < rows->count; i++) {
		uint32_t shape = rows->soup[i] ? 0 : (uint32_t)rows->columns.items[0].values[row++] / 4;

		if (shape >= rows->shapes.count)
			return false;
		rows->corners[i] = rows->shapes.items[shape].corners;
		if (!rows->soup[i])
			continue;
		if (stream + 1 >= payload->stream_count)
			return false;
		rows->corners[i] = payload->streams[stream].corners;
		if (++taken == payload->streams[stream].elements) {
			taken = 0;
			stream++;
		}
	}
	return stream + 1 == payload->stream_count && taken == 0;
}

static enum eco_code decode_rows(const struct eco_list *list, const struct eco_payload *payload, struct eco_shape_rows *rows,
	struct eco_error *error)
{
	const struct eco_stream *stream = &payload->streams[payload->stream_count - 1];
	struct eco_reader r = { .bytes = stream->bytes, .size = stream->size };
	enum eco_code code;

	if (!read_shapes(&r, &rows->shapes, (list->attributes & ECO_ATTR_UV) != 0))
		return eco_fail(error, ECO_DAMAGED, "chunk: its table of shapes is cut short or holds impossible values");
	uint64_t placed = eco_read_varint(&r);
	if (r.failed || placed < 1 || placed > rows->count || (placed < rows->count && !read_mask(&r, rows, (uint32_t)placed)))
		return eco_fail(error, ECO_DAMAGED, "chunk: %llu placed elements of %u", (unsigned long long)placed, rows->count);
	code = columns_make(&rows->columns, (uint32_t)placed, rows->extra_count, error);
	if (code == ECO_OK)
		code = read_columns(&r, &rows->columns, error);
	if (code == ECO_OK && !find_corners(rows, payload))
		code = eco_fail(error, ECO_DAMAGED, "chunk: an element has a shape that is not there, or streams of corners are not as long as stated");
	return code;
}

enum eco_code eco_shapes_decode(const struct eco_list *list, const struct eco_payload *payload, struct eco_shape_rows **out,
	struct eco_error *error)
{
	struct eco_shape_rows *rows = *out = calloc(1, sizeof *rows);
	enum eco_code code = ECO_OK;

	if (rows) {
		rows->count = payload->streams[payload->stream_count - 1].elements;
		rows->extra_count = eco_list_extra_count(list);
		rows->corners = malloc(rows->count);
		rows->soup = calloc(rows->count, sizeof *rows->soup);
		rows->shapes.items = calloc(ECO_SHAPES_MAX, sizeof *rows->shapes.items);
	}
	if (rows == NULL || rows->corners == NULL || rows->soup == NULL || rows->shapes.items == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for its shapes");
	if (code == ECO_OK)
		code = decode_rows(list, payload, rows, error);
	if (code != ECO_OK) {
		eco_shape_rows_free(rows);
		*out = NULL;
	}
	return code;
}

const uint8_t *eco_shape_rows_corners(const struct eco_shape_rows *rows)
{
	return rows->corners;
}

bool eco_shape_rows_soup(const struct eco_shape_rows *rows, uint32_t stored)
{
	return rows->soup[stored];
}

enum eco_code eco_shape_rows_give(const struct eco_shape_rows *rows, const struct eco_place_in *places, struct eco_elements *e,
	struct eco_error *error)
{
	uint32_t row = 0, number;

	for (uint32_t i = 0; i < rows->count; i++) {
		if (rows->soup[i])
			continue;
		struct eco_placing p = get_placing(&rows->columns, row, &number);
		const struct eco_shape *shape = &rows->shapes.items[number];

		if (!eco_shape_place(&rows->shapes, shape, &p, e->position + 3 * (size_t)places[i].corner))
			return eco_fail(error, ECO_DAMAGED, "chunk: stored element %u is not placed anywhere", i);
		if (e->uv)
			memcpy(e->uv + 2 * (size_t)places[i].corner, shape->uv, 2 * sizeof *shape->uv * shape->corners);
		for (uint32_t k = 0; k < e->extra_count; k++) {
			int32_t v = rows->columns.items[PLACING_COLUMNS + k].values[row];

			if (v < -ECO_ROWS_VALUE_MAX || v > ECO_ROWS_VALUE_MAX)
				return eco_fail(error, ECO_DAMAGED, "chunk: an attribute of stored element %u is out of bounds", i);
			e->extra[(size_t)e->extra_count * places[i].element + k] = v;
		}
		e->corners[places[i].element] = shape->corners;
		row++;
	}
	return ECO_OK;
}

void eco_shape_rows_free(struct eco_shape_rows *rows)
{
	if (rows == NULL)
		return;
	eco_shapes_free(&rows->shapes);
	free(rows->corners);
	free(rows->soup);
	free(rows->columns.storage);
	free(rows);
}
