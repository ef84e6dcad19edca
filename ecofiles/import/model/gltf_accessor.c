/* Accessors: the place and the meaning of numbers. An accessor is resolved once into a start, a stride and
 * a type, and elements are read from it one by one; only sparse ones are copied. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/model.h"

struct shape { const char *name; uint32_t components, rows; };

static const struct shape shapes[] = {
	{ "SCALAR", 1, 1 }, { "VEC2", 2, 2 }, { "VEC3", 3, 3 }, { "VEC4", 4, 4 }, { "MAT2", 4, 2 },
		{ "MAT3", 9, 3 }, { "MAT4", 16, 4 },
};

/* Bytes of a component; 0: unknown type. */
static size_t component_bytes(uint64_t type)
{
	switch (type) {
	case 5120: case 5121: return 1;
	case 5122: case 5123: return 2;
	case 5124: case 5125: case 5126: return 4;
	case 5130: return 8;
	default: return 0;
	}
}

static size_t element_bytes(const struct eco_gltf_accessor *a)
{
	return a->column_bytes * (a->components / a->rows - 1) + a->rows * component_bytes(a->type);
}

static size_t dense_stride(const struct eco_gltf_accessor *a)
{
	return a->column_bytes * (a->components / a->rows);
}

/* Reads type and count of an accessor's JSON. */
static enum eco_code read_shape(const struct eco_gltf *doc, uint32_t index, const json_t *json,
	struct eco_gltf_accessor *a, struct eco_error *error)
{
	const char *name = eco_gltf_text(json, "type");
	uint64_t type = eco_gltf_whole(json, "componentType", 0);
	size_t i = 0, bytes = component_bytes(type);
	while (i < sizeof shapes / sizeof *shapes && strcmp(shapes[i].name, name) != 0)
		i++;
	if (i == sizeof shapes / sizeof *shapes || bytes == 0)
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u has no known type (%.20s of %llu)",
			doc->path, index, name, (unsigned long long)type);
	a->components = shapes[i].components;
	a->rows = shapes[i].rows;
	a->type = (uint32_t)type;
	a->normalized = json_is_true(json_object_get(json, "normalized")) && type < 5125;
	a->column_bytes = a->rows * bytes;
	if (a->rows < a->components)         /* columns of matrices begin at multiples of four bytes */
		a->column_bytes = (a->column_bytes + 3) & ~(size_t)3;
	a->count = eco_gltf_whole(json, "count", UINT64_MAX);
	if (a->count > ECO_GLTF_VALUES_MAX / a->components)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: accessor %u: no count, or more numbers than "
			"are possible (%llu)", doc->path, index, (unsigned long long)ECO_GLTF_VALUES_MAX);
	a->stride = dense_stride(a);
	return ECO_OK;
}

/* Finds `count` elements of `bytes` bytes each in a view, from json's byteOffset on. */
static enum eco_code locate(struct eco_gltf *doc, uint32_t accessor, const json_t *json, uint64_t count,
	size_t bytes, size_t stride, const uint8_t **at, struct eco_error *error)
{
	uint32_t view = eco_gltf_index(json, "bufferView");
	uint64_t offset = eco_gltf_whole(json, "byteOffset", 0), need;
	const uint8_t *start;
	size_t size;
	enum eco_code code = eco_gltf_view(doc, view, &start, &size, error);
	if (code)
		return code;
	need = count == 0 ? 0 : (count - 1) * stride + bytes;
	if (offset > size || need > size - offset)
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u needs %llu bytes of bufferView %u, "
			"which has %zu", doc->path, accessor, (unsigned long long)need, view, size);
	*at = start + offset;
	return ECO_OK;
}

static enum eco_code place_dense(struct eco_gltf *doc, uint32_t index, const json_t *json,
	struct eco_gltf_accessor *a, struct eco_error *error)
{
	const json_t *view = eco_gltf_item(doc, "bufferViews",
		eco_gltf_whole(json, "bufferView", UINT64_MAX));
	uint64_t stride = eco_gltf_whole(view, "byteStride", 0);
	if (stride > 1u << 20)
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u: a byteStride of %llu", doc->path,
			index, (unsigned long long)stride);
	if (stride != 0)
		a->stride = (size_t)stride;
	return locate(doc, index, json, a->count, element_bytes(a), a->stride, &a->bytes, error);
}

static uint32_t whole_at(const uint8_t *p, uint64_t type)
{
	if (type == 5121)
		return p[0];
	if (type == 5123)
		return p[0] | (uint32_t)p[1] << 8;
	return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* Makes a dense copy of the elements; missing ones are zeros. */
static bool own_elements(struct eco_gltf_accessor *a)
{
	size_t stride = dense_stride(a);
	uint8_t *copy = calloc((size_t)a->count + 1, stride);
	for (uint64_t i = 0; copy && a->bytes && i < a->count; i++)
		memcpy(copy + i * stride, a->bytes + i * a->stride, element_bytes(a));
	a->owned = copy;
	a->bytes = copy;
	a->stride = stride;
	return copy;
}

static enum eco_code substitute(struct eco_gltf *doc, uint32_t index, const json_t *sparse,
	struct eco_gltf_accessor *a, struct eco_error *error)
{
	const json_t *indices = json_object_get(sparse, "indices"),
		*values = json_object_get(sparse, "values");
	uint64_t count = eco_gltf_whole(sparse, "count", UINT64_MAX),
		type = eco_gltf_whole(indices, "componentType", 0);
	const uint8_t *where, *what;
	size_t stride = dense_stride(a);
	if (count > a->count || (type != 5121 && type != 5123 && type != 5125))
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u: its sparse part does not fit it",
			doc->path, index);
	enum eco_code code = locate(doc, index, indices, count, component_bytes(type), component_bytes(type),
		&where, error);
	if (!code)
		code = locate(doc, index, values, count, element_bytes(a), stride, &what, error);
	if (code)
		return code;
	if (!own_elements(a))
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory for accessor %u", doc->path,
			index);
	for (uint64_t i = 0; i < count; i++) {
		uint32_t element = whole_at(where + i * component_bytes(type), type);
		if (element >= a->count)
			return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u: its sparse part names "
				"element %u of %llu", doc->path, index, element,
				(unsigned long long)a->count);
		memcpy(a->owned + element * stride, what + i * stride, element_bytes(a));
	}
	return ECO_OK;
}

enum eco_code eco_gltf_accessor_open(struct eco_gltf *doc, uint32_t accessor, uint32_t components,
	struct eco_gltf_accessor *a, struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "accessors", accessor),
		*sparse = json_object_get(json, "sparse");
	*a = (struct eco_gltf_accessor){ .bytes = NULL };
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names accessor %u, which is not there",
			doc->path, accessor);
	enum eco_code code = read_shape(doc, accessor, json, a, error);
	if (code == ECO_OK && components != 0 && a->components != components)
		code = eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u has %u components, its use needs %u",
			doc->path, accessor, a->components, components);
	if (code == ECO_OK && json_object_get(json, "bufferView"))
		code = place_dense(doc, accessor, json, a, error);
	if (code == ECO_OK && sparse)
		code = substitute(doc, accessor, sparse, a, error);
	if (code)
		eco_gltf_accessor_close(a);
	return code;
}

void eco_gltf_accessor_close(struct eco_gltf_accessor *a)
{
	free(a->owned);
	*a = (struct eco_gltf_accessor){ .bytes = NULL };
}

/* ---- Elements ---- */

static double fraction(double value, double most, bool normalized)
{
	return !normalized ? value : value < -most ? -1 : value / most;
}

static double component(const uint8_t *p, uint32_t type, bool normalized)
{
	uint32_t bits = type == 5120 ? p[0] : type == 5122 ? whole_at(p, 5123) : whole_at(p, type);
	uint64_t wide;
	float single;
	double exact;
	switch (type) {
	case 5120: return fraction((int8_t)bits, 127, normalized);
	case 5121: return fraction(bits, 255, normalized);
	case 5122: return fraction((int16_t)bits, 32767, normalized);
	case 5123: return fraction(bits, 65535, normalized);
	case 5124: return fraction((int32_t)bits, 2147483647.0, normalized);
	case 5126:
		memcpy(&single, &bits, sizeof single);
		return (double)single;
	case 5130:
		wide = bits | (uint64_t)whole_at(p + 4, 5125) << 32;
		memcpy(&exact, &wide, sizeof exact);
		return exact;
	default: return bits;
	}
}

void eco_gltf_element(const struct eco_gltf_accessor *a, uint64_t i, double *values)
{
	const uint8_t *p = a->bytes ? a->bytes + i * a->stride : NULL;
	size_t bytes = component_bytes(a->type);
	for (uint32_t c = 0; c < a->components; c++)
		values[c] = !p ? 0 : component(p + c / a->rows * a->column_bytes + c % a->rows * bytes,
			a->type, a->normalized);
}

uint32_t eco_gltf_element_index(const struct eco_gltf_accessor *a, uint64_t i)
{
	if (!a->bytes)
		return 0;
	if (a->type == 5121 || a->type == 5123 || a->type == 5125)
		return whole_at(a->bytes + i * a->stride, a->type);
	double value = component(a->bytes + i * a->stride, a->type, false);
	return value >= 0 && value < ECO_NONE ? (uint32_t)value : ECO_NONE;
}

/* ---- Views compressed with meshoptimizer ----
 * EXT_meshopt_compression, KHR_meshopt_compression. The decoders
 * withstand damaged bytes but trust sizes, so sizes are checked here. The library of Debian 12 knows the
 * codec's first version; the second, and the filter COLOR, came with the KHR extension and are refused. */

enum mode { ATTRIBUTES, TRIANGLES, INDICES, MODES };
static const char *const mode_names[MODES] = { "ATTRIBUTES", "TRIANGLES", "INDICES" };

enum filter { NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL, FILTERS };
static const char *const filter_names[FILTERS] = { "NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL" };

#define EXPORT "export with EXT_meshopt_compression (gltfpack -ce ext), or without compression"
#define SECOND_VERSION 0xa1u         /* first byte of attributes */

struct packed {
	uint32_t mode, filter;
	uint64_t count, stride, length;
	const uint8_t *bytes;
};

const json_t *gltf_meshopt_extension(const json_t *view)
{
	const json_t *khr = eco_gltf_extension(view, "KHR_meshopt_compression");
	return khr ? khr : eco_gltf_extension(view, "EXT_meshopt_compression");
}

static uint32_t number_of(const char *name, const char *const *names, uint32_t count)
{
	uint32_t i = 0;
	while (i < count && strcmp(names[i], name) != 0)
		i++;
	return i;
}

static bool strides_fit(const struct packed *p)
{
	if (p->mode == ATTRIBUTES ? p->stride == 0 || p->stride > 256 || p->stride % 4 != 0 : p->stride != 2
			&& p->stride != 4)
		return false;
	if (p->mode == TRIANGLES && p->count % 3 != 0)
		return false;
	switch (p->filter) {
	case NONE: return true;
	case OCTAHEDRAL: return p->mode == ATTRIBUTES && (p->stride == 4 || p->stride == 8);
	case QUATERNION: return p->mode == ATTRIBUTES && p->stride == 8;
	default: return p->mode == ATTRIBUTES;
	}
}

static enum eco_code read_packed(struct eco_gltf *doc, uint32_t view, const json_t *json, struct packed *p,
	struct eco_error *error)
{
	const char *filter = eco_gltf_text(json, "filter");
	p->mode = number_of(eco_gltf_text(json, "mode"), mode_names, MODES);
	p->filter = *filter == 0 ? NONE : number_of(filter, filter_names, FILTERS);
	p->count = eco_gltf_whole(json, "count", UINT64_MAX);
	p->stride = eco_gltf_whole(json, "byteStride", 0);
	p->length = eco_gltf_whole(json, "byteLength", UINT64_MAX);
	if (p->mode == MODES || p->filter == FILTERS)
		return eco_fail(error, ECO_UNSUPPORTED,
			"%.300s: bufferView %u: meshopt compression of mode "
			"%.20s, filter %.20s is not read; " EXPORT,
			doc->path, view, eco_gltf_text(json, "mode"), filter);
	if (!strides_fit(p) || p->count > ECO_GLTF_UNPACKED_MAX)
		return eco_fail(error, ECO_DAMAGED, "%.300s: bufferView %u: meshopt compression with sizes "
			"that make no sense", doc->path, view);
	if (p->count * p->stride > ECO_GLTF_UNPACKED_MAX - doc->unpacked)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: unpacks to more than %llu bytes", doc->path,
			(unsigned long long)ECO_GLTF_UNPACKED_MAX);
	enum eco_code code = gltf_buffer_range(doc, eco_gltf_index(json, "buffer"),
		eco_gltf_whole(json, "byteOffset", 0), p->length, &p->bytes, error);
	return code || p->mode != ATTRIBUTES || !p->length || p->bytes[0] != SECOND_VERSION
		? code
		: eco_fail(error, ECO_UNSUPPORTED,
			  "%.300s: bufferView %u: the second version of meshopt's codec is not read; " EXPORT,
			  doc->path, view);
}

static bool decode(const struct packed *p, uint8_t *to)
{
	size_t count = (size_t)p->count, stride = (size_t)p->stride, length = (size_t)p->length;
	if (p->mode == TRIANGLES)
		return meshopt_decodeIndexBuffer(to, count, stride, p->bytes, length) == 0;
	if (p->mode == INDICES)
		return meshopt_decodeIndexSequence(to, count, stride, p->bytes, length) == 0;
	return meshopt_decodeVertexBuffer(to, count, stride, p->bytes, length) == 0;
}

static void undo_filter(const struct packed *p, uint8_t *bytes)
{
	size_t count = (size_t)p->count, stride = (size_t)p->stride;
	switch (p->filter) {
	case OCTAHEDRAL: meshopt_decodeFilterOct(bytes, count, stride); break;
	case QUATERNION: meshopt_decodeFilterQuat(bytes, count, stride); break;
	case EXPONENTIAL: meshopt_decodeFilterExp(bytes, count, stride); break;
	default: break;
	}
}

/* No codec compresses better than 1024 to 1: a view that claims more gets no memory. */
static bool can_be(const struct packed *p)
{
	return p->count * p->stride <= p->length * 1024;
}

enum eco_code gltf_meshopt_unpack(struct eco_gltf *doc, uint32_t index, const json_t *extension,
	struct gltf_bytes *to, struct eco_error *error)
{
	struct packed p;
	enum eco_code code = read_packed(doc, index, extension, &p, error);
	if (code)
		return code;
	uint8_t *bytes = can_be(&p) ? eco_alloc((size_t)(p.count * p.stride) + 1, 1) : NULL;
	if (!bytes || !decode(&p, bytes)) {
		free(bytes);
		return eco_fail(error, ECO_DAMAGED, "%.300s: bufferView %u: its meshopt compression cannot "
			"be undone", doc->path, index);
	}
	undo_filter(&p, bytes);
	doc->unpacked += p.count * p.stride;
	*to = (struct gltf_bytes){ .bytes = bytes, .size = (size_t)(p.count * p.stride), .owned = bytes };
	return ECO_OK;
}
