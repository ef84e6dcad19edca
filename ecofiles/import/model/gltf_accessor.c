/* Accessors: the place and the meaning of numbers. An accessor is resolved once into a start, a stride and
 * a type, and elements are read from it one by one; only sparse ones are copied. */
#include "ecofiles/import/model/gltf.h"

#include <math.h>
#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"

#define UNPACKED_MAX ((uint64_t)1 << 32)     /* bytes of all compressed views together */
#define STRIDE_MAX (1u << 20)

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

static uint32_t number_of(const char *name, const char *const *names, uint32_t count)
{
	uint32_t i = 0;
	while (i < count && strcmp(names[i], name) != 0)
		i++;
	return i;
}

static bool strides_fit(const struct packed *p)
{
	if (p->mode == ATTRIBUTES)
		return p->stride > 0 && p->stride <= 256 && p->stride % 4 == 0
			&& (p->filter != OCTAHEDRAL || p->stride == 4 || p->stride == 8)
			&& (p->filter != QUATERNION || p->stride == 8);
	return p->filter == NONE && (p->stride == 2 || p->stride == 4)
		&& (p->mode != TRIANGLES || p->count % 3 == 0);
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
	if (!strides_fit(p) || p->count > UNPACKED_MAX)
		return eco_fail(error, ECO_DAMAGED, "%.300s: bufferView %u: meshopt compression with "
			"impossible sizes", doc->path, view);
	if (p->count * p->stride > UNPACKED_MAX - doc->unpacked)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: unpacks to more than %llu bytes", doc->path,
			(unsigned long long)UNPACKED_MAX);
	enum eco_code code = eco_gltf_buffer_range(doc, eco_gltf_index(json, "buffer"),
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
	if (meshopt_decodeVertexBuffer(to, count, stride, p->bytes, length) != 0)
		return false;
	if (p->filter == OCTAHEDRAL)
		meshopt_decodeFilterOct(to, count, stride);
	else if (p->filter == QUATERNION)
		meshopt_decodeFilterQuat(to, count, stride);
	else if (p->filter == EXPONENTIAL)
		meshopt_decodeFilterExp(to, count, stride);
	return true;
}

/* Unpacks view `index`; *to then owns its bytes. */
static enum eco_code unpack(struct eco_gltf *doc, uint32_t index, const json_t *extension,
	struct eco_gltf_bytes *to, struct eco_error *error)
{
	struct packed p;
	ECO_PASS(read_packed(doc, index, extension, &p, error));
	/* no codec compresses better than 1024 to 1: a view that claims more gets no memory */
	const uint64_t size = p.count * p.stride;
	uint8_t *bytes = size <= p.length * 1024 ? eco_alloc((size_t)size, 1) : NULL;
	if (!bytes || !decode(&p, bytes)) {
		free(bytes);
		return eco_fail(error, ECO_DAMAGED, "%.300s: bufferView %u: its meshopt compression cannot "
			"be undone", doc->path, index);
	}
	doc->unpacked += size;
	*to = (struct eco_gltf_bytes){ .bytes = bytes, .size = (size_t)size, .owned = bytes };
	return ECO_OK;
}

enum eco_code eco_gltf_view(struct eco_gltf *doc, uint32_t view, const uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "bufferViews", view),
		*packed = eco_gltf_extension(json, "KHR_meshopt_compression");
	enum eco_code code = ECO_OK;
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names bufferView %u, which is not there",
			doc->path, view);
	packed = packed ? packed : eco_gltf_extension(json, "EXT_meshopt_compression");
	if (!packed) {
		uint64_t length = eco_gltf_whole(json, "byteLength", UINT64_MAX);
		*size = (size_t)length;
		return eco_gltf_buffer_range(doc, eco_gltf_index(json, "buffer"),
			eco_gltf_whole(json, "byteOffset", 0), length, bytes, error);
	}
	if (!doc->views[view].bytes)
		code = unpack(doc, view, packed, &doc->views[view], error);
	*bytes = doc->views[view].bytes;
	*size = doc->views[view].size;
	return code;
}

/* ---- Types ---- */

/* Matrices of smaller sizes, whose columns are padded, are of no use in a model. */
static const struct { const char *name; uint32_t components; } shapes[] = { { "SCALAR", 1 }, { "VEC2", 2 },
	{ "VEC3", 3 }, { "VEC4", 4 }, { "MAT4", 16 } };
#define SHAPES (sizeof shapes / sizeof *shapes)

/* Bytes of a component; 0: unknown type. */
static size_t component_bytes(uint64_t type)
{
	static const uint8_t bytes[] = { 1, 1, 2, 2, 4, 4, 4 };
	return type >= 5120 && type <= 5126 ? bytes[type - 5120] : 0;
}

static size_t element_bytes(const struct eco_gltf_accessor *a)
{
	return a->components * component_bytes(a->type);
}

/* Reads type and count of an accessor's JSON. */
static enum eco_code read_shape(const struct eco_gltf *doc, uint32_t index, const json_t *json,
	struct eco_gltf_accessor *a, struct eco_error *error)
{
	static const double most[] = { 127, 255, 32767, 65535 };
	const char *name = eco_gltf_text(json, "type");
	uint64_t type = eco_gltf_whole(json, "componentType", 0);
	size_t i = 0;
	while (i < SHAPES && strcmp(shapes[i].name, name) != 0)
		i++;
	if (i == SHAPES || component_bytes(type) == 0)
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u has no known type (%.20s of %llu)",
			doc->path, index, name, (unsigned long long)type);
	a->components = shapes[i].components;
	a->type = (uint32_t)type;
	a->divisor = json_is_true(json_object_get(json, "normalized")) && type <= 5123 ? most[type - 5120]
		: 0;
	a->count = eco_gltf_whole(json, "count", UINT64_MAX);
	a->stride = element_bytes(a);
	if (a->count > ECO_GLTF_VALUES_MAX / a->components)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: accessor %u: no count, or more numbers than "
			"are possible (%llu)", doc->path, index, (unsigned long long)ECO_GLTF_VALUES_MAX);
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
	ECO_PASS(eco_gltf_view(doc, view, &start, &size, error));
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
	const json_t *view = eco_gltf_item(doc, "bufferViews", eco_gltf_whole(json, "bufferView",
		UINT64_MAX));
	uint64_t stride = eco_gltf_whole(view, "byteStride", 0);
	if (stride > STRIDE_MAX)
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u: a byteStride of %llu", doc->path,
			index, (unsigned long long)stride);
	if (stride != 0)
		a->stride = (size_t)stride;
	return locate(doc, index, json, a->count, element_bytes(a), a->stride, &a->bytes, error);
}

static uint32_t whole_at(const uint8_t *p, uint64_t type)
{
	uint32_t whole = 0;
	for (size_t i = component_bytes(type); i-- > 0;)
		whole = whole << 8 | p[i];
	return whole;
}

/* Makes a dense copy of the elements; missing ones are zeros. */
static void own_elements(struct eco_gltf_accessor *a)
{
	const size_t bytes = element_bytes(a);
	a->owned = eco_alloc((size_t)a->count, bytes);
	for (uint64_t i = 0; a->bytes && i < a->count; i++)
		memcpy(a->owned + i * bytes, a->bytes + i * a->stride, bytes);
	a->bytes = a->owned;
	a->stride = bytes;
}

static enum eco_code substitute(struct eco_gltf *doc, uint32_t index, const json_t *sparse,
	struct eco_gltf_accessor *a, struct eco_error *error)
{
	const json_t *indices = json_object_get(sparse, "indices"),
		*values = json_object_get(sparse, "values");
	uint64_t count = eco_gltf_whole(sparse, "count", UINT64_MAX),
		type = eco_gltf_whole(indices, "componentType", 0);
	const uint8_t *where, *what;
	const size_t bytes = element_bytes(a), number_bytes = component_bytes(type);
	if (count > a->count || (type != 5121 && type != 5123 && type != 5125))
		return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u: its sparse part does not fit it",
			doc->path, index);
	ECO_PASS(locate(doc, index, indices, count, number_bytes, number_bytes, &where, error));
	ECO_PASS(locate(doc, index, values, count, bytes, bytes, &what, error));
	own_elements(a);
	for (uint64_t i = 0; i < count; i++) {
		uint32_t element = whole_at(where + i * number_bytes, type);
		if (element >= a->count)
			return eco_fail(error, ECO_DAMAGED, "%.300s: accessor %u: its sparse part names "
				"element %u of %llu", doc->path, index, element,
				(unsigned long long)a->count);
		memcpy(a->owned + element * bytes, what + i * bytes, bytes);
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

static double component(const uint8_t *p, uint32_t type)
{
	uint32_t bits = whole_at(p, type);
	float single;
	memcpy(&single, &bits, sizeof single);
	/* 5124 is no type of glTF, but some exporters write signed indices */
	return type == 5120 ? (int8_t)bits : type == 5122 ? (int16_t)bits : type == 5124 ? (int32_t)bits
		: type == 5126 ? (double)single : bits;
}

void eco_gltf_element(const struct eco_gltf_accessor *a, uint64_t i, double *values)
{
	for (uint32_t c = 0; c < a->components; c++) {
		values[c] = a->bytes ? component(a->bytes + i * a->stride + c * component_bytes(a->type),
			a->type) : 0;
		if (a->divisor > 0)
			values[c] = fmax(values[c] / a->divisor, -1);
	}
}

uint32_t eco_gltf_element_index(const struct eco_gltf_accessor *a, uint64_t i)
{
	double value = a->bytes ? component(a->bytes + i * a->stride, a->type) : 0;
	return value >= 0 && value < ECO_NONE ? (uint32_t)value : ECO_NONE;
}
