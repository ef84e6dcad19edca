/* Views compressed with meshoptimizer (EXT_meshopt_compression, KHR_meshopt_compression). Its decoders
 * withstand damaged bytes but trust sizes, so sizes are checked here. The library of Debian 12 knows the
 * codec's first version; the second, and the filter COLOR, came with the KHR extension and are refused. */
#include "ecofiles/import/model/gltf_document.h"

#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/model.h"

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
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: bufferView %u: meshopt compression of mode "
			"%.20s, filter %.20s is not read; " EXPORT, doc->path, view, eco_gltf_text(json, "mode"),
			filter);
	if (!strides_fit(p) || p->count > ECO_GLTF_UNPACKED_MAX)
		return eco_fail(error, ECO_DAMAGED, "%.300s: bufferView %u: meshopt compression with sizes "
			"that make no sense", doc->path, view);
	if (p->count * p->stride > ECO_GLTF_UNPACKED_MAX - doc->unpacked)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: unpacks to more than %llu bytes", doc->path,
			(unsigned long long)ECO_GLTF_UNPACKED_MAX);
	enum eco_code code = gltf_buffer_range(doc, eco_gltf_index(json, "buffer"),
		eco_gltf_whole(json, "byteOffset", 0), p->length, &p->bytes, error);
	return code || p->mode != ATTRIBUTES || !p->length || p->bytes[0] != SECOND_VERSION ? code
		: eco_fail(error, ECO_UNSUPPORTED, "%.300s: bufferView %u: the second version of meshopt's codec "
			"is not read; " EXPORT, doc->path, view);
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
	uint8_t *bytes = can_be(&p) ? malloc((size_t)(p.count * p.stride) + 1) : NULL;
	if (!bytes && can_be(&p))
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory for bufferView %u", doc->path,
			index);
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
