/* The document: container, JSON, buffers. Common departures from the specification are accepted: a JSON
 * chunk padded with zeros, a byte order mark, whole numbers written as 3.0, names of buffers in another
 * system's spelling, a GLB named .gltf. Damage is refused: a GLB shorter than its header says was cut off. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_gltf.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>


#define CHUNK_JSON 0x4e4f534au
#define CHUNK_BIN 0x004e4942u

/* ---- JSON ---- */

const json_t *eco_gltf_json(const struct eco_gltf *doc)
{
	return doc->root;
}

const char *eco_gltf_path(const struct eco_gltf *doc)
{
	return doc->path;
}

const json_t *eco_gltf_item(const struct eco_gltf *doc, const char *array, uint64_t index)
{
	return index < SIZE_MAX ? json_array_get(json_object_get(doc->root, array), (size_t)index) : NULL;
}

uint64_t eco_gltf_whole(const json_t *object, const char *key, uint64_t otherwise)
{
	const json_t *value = json_object_get(object, key);
	if (!value)
		return otherwise;
	if (json_is_integer(value))
		return json_integer_value(value) >= 0 ? (uint64_t)json_integer_value(value) : UINT64_MAX;
	if (json_is_real(value) && json_real_value(value) >= 0 && json_real_value(value) < 0x1p53
		&& json_real_value(value) == floor(json_real_value(value)))
		return (uint64_t)json_real_value(value);
	return UINT64_MAX;
}

uint32_t eco_gltf_index(const json_t *object, const char *key)
{
	uint64_t index = eco_gltf_whole(object, key, ECO_NONE);
	return index < ECO_NONE ? (uint32_t)index : ECO_NONE;
}

double eco_gltf_number(const json_t *object, const char *key, double otherwise)
{
	const json_t *value = json_object_get(object, key);
	return json_is_number(value) ? json_number_value(value) : otherwise;
}

bool eco_gltf_numbers(const json_t *object, const char *key, double *values, size_t count)
{
	const json_t *array = json_object_get(object, key);
	if (array && !json_is_array(array))
		return false;
	for (size_t i = 0; i < count && i < json_array_size(array); i++) {
		if (!json_is_number(json_array_get(array, i)))
			return false;
		values[i] = json_number_value(json_array_get(array, i));
	}
	return true;
}

const json_t *eco_gltf_extension(const json_t *object, const char *name)
{
	return json_object_get(json_object_get(object, "extensions"), name);
}

const char *eco_gltf_text(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

/* ---- Data URIs ---- */

/* Accepts white space and the URL alphabet. False at any other character. */
static bool decode_base64(const char *text, uint8_t *to, size_t *size)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/-_";
	uint32_t bits = 0, count = 0;
	*size = 0;
	for (text += strspn(text, " \t\r\n"); *text != 0 && *text != '=';
		text += 1 + strspn(text + 1, " \t\r\n")) {
		const char *digit = strchr(digits, *text);
		if (!digit)
			return false;
		uint32_t value = (uint32_t)(digit - digits);
		bits = bits << 6 | (value < 64 ? value : value - 2);
		count += 6;
		if (count >= 8) {
			count -= 8;
			to[(*size)++] = (uint8_t)(bits >> count);
		}
	}
	return true;
}

static size_t decode_percent(const char *text, uint8_t *to)
{
	size_t size = 0;
	for (; *text != 0; text++) {
		bool escaped =
			*text == '%' && isxdigit((unsigned char)text[1]) && isxdigit((unsigned char)text[2]);
		unsigned byte = (uint8_t)*text;
		if (escaped)
			sscanf(text + 1, "%2x", &byte);
		to[size++] = (uint8_t)byte;
		text += escaped ? 2 : 0;
	}
	return size;
}

enum eco_code eco_gltf_data_uri(const char *uri, bool *is_data, uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	const char *comma = strchr(uri, ',');
	*is_data = strncasecmp(uri, "data:", 5) == 0;
	if (!*is_data)
		return ECO_OK;
	*bytes = NULL;
	*size = 0;
	if (!comma)
		return eco_fail(error, ECO_DAMAGED, "a data URI without a comma");
	*bytes = eco_alloc(strlen(comma) + 1, 1);
	if (comma - uri < 7 || strncasecmp(comma - 7, ";base64", 7) != 0) {
		*size = decode_percent(comma + 1, *bytes);
	} else if (!decode_base64(comma + 1, *bytes, size)) {
		free(*bytes);
		*bytes = NULL;
		return eco_fail(error, ECO_DAMAGED, "a data URI that is no base64");
	}
	return ECO_OK;
}

/* ---- Buffers ---- */

static enum eco_code read_beside(const struct eco_gltf *doc, uint32_t index, const char *uri,
	struct gltf_bytes *to, struct eco_error *error)
{
	char path[4096];
	if (!eco_model_find_beside(doc->path, uri, path, sizeof path))
		return eco_fail(error, ECO_NOT_FOUND, "%.250s: buffer %u: no file %.150s beside it",
			doc->path, index, uri);
	enum eco_code code = eco_file_read(path, ECO_GLTF_FILE_MAX, &to->owned, &to->size, error);
	to->bytes = to->owned;
	return code;
}

static enum eco_code read_buffer(const struct eco_gltf *doc, uint32_t index, struct gltf_bytes *to,
	struct eco_error *error)
{
	const json_t *buffer = eco_gltf_item(doc, "buffers", index);
	const char *uri = json_string_value(json_object_get(buffer, "uri"));
	struct eco_error inner = { .code = ECO_OK };
	bool is_data = false;
	if (!uri) {
		if (index != 0 || !doc->chunk.bytes)
			return eco_fail(error, ECO_DAMAGED, "%.300s: buffer %u has no data", doc->path,
				index);
		*to = doc->chunk;
		return ECO_OK;
	}
	if (eco_gltf_data_uri(uri, &is_data, &to->owned, &to->size, &inner) != ECO_OK)
		return eco_fail(error, inner.code, "%.300s: buffer %u: %s", doc->path, index, inner.text);
	to->bytes = to->owned;
	return is_data ? ECO_OK : read_beside(doc, index, uri, to, error);
}

enum eco_code gltf_buffer_range(struct eco_gltf *doc, uint32_t buffer, uint64_t offset, uint64_t size,
	const uint8_t **bytes, struct eco_error *error)
{
	enum eco_code code;
	if (buffer >= doc->buffer_count)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names a buffer that is not there", doc->path);
	struct gltf_bytes *b = &doc->buffers[buffer];
	if (!b->bytes && (code = read_buffer(doc, buffer, b, error)) != ECO_OK)
		return code;
	if (offset > b->size || size > b->size - offset)
		return eco_fail(error, ECO_DAMAGED, "%.300s: buffer %u has only %zu bytes, its use needs "
			"%llu from %llu on; was it cut off?", doc->path, buffer, b->size,
			(unsigned long long)size, (unsigned long long)offset);
	*bytes = b->bytes + offset;
	return ECO_OK;
}

enum eco_code eco_gltf_view(struct eco_gltf *doc, uint32_t view, const uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "bufferViews", view), *packed;
	enum eco_code code;
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names bufferView %u, which is not there",
			doc->path, view);
	packed = gltf_meshopt_extension(json);
	if (!packed) {
		uint64_t length = eco_gltf_whole(json, "byteLength", UINT64_MAX);
		*size = (size_t)length;
		return gltf_buffer_range(doc, eco_gltf_index(json, "buffer"),
			eco_gltf_whole(json, "byteOffset", 0), length, bytes, error);
	}
	if (!doc->views[view].bytes
		&& (code = gltf_meshopt_unpack(doc, view, packed, &doc->views[view], error)) != ECO_OK)
		return code;
	*bytes = doc->views[view].bytes;
	*size = doc->views[view].size;
	return ECO_OK;
}

/* ---- The container ---- */

static uint32_t u32_at(const uint8_t *p)
{
	return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static enum eco_code refuse_version_1(const struct eco_gltf *doc, struct eco_error *error)
{
	return eco_fail(error, ECO_UNSUPPORTED, "%.300s: glTF 1.0 is not read; convert it to 2.0: npx "
		"gltf-pipeline -i OLD -o NEW.glb", doc->path);
}

/* The JSON text of a GLB; its binary chunk goes into the document. */
static enum eco_code open_binary(struct eco_gltf *doc, const uint8_t *bytes, size_t size, size_t *length,
	struct eco_error *error)
{
	if (size >= 8 && u32_at(bytes + 4) == 1)
		return refuse_version_1(doc, error);
	if (size < 20 || u32_at(bytes + 4) != 2 || u32_at(bytes + 16) != CHUNK_JSON)
		return eco_fail(error, ECO_DAMAGED, "%.300s: not a glTF 2.0 binary file, or cut off",
			doc->path);
	if (u32_at(bytes + 8) > size || u32_at(bytes + 12) > size - 20)
		return eco_fail(error, ECO_DAMAGED, "%.300s: cut off: says it has %u bytes, there are %zu",
			doc->path, u32_at(bytes + 8), size);
	*length = u32_at(bytes + 12);
	size_t at = 20 + ((*length + 3) & ~(size_t)3);
	size_t left = at < size ? size - at : 0;
	if (left >= 8 && u32_at(bytes + at + 4) == CHUNK_BIN) {
		if (u32_at(bytes + at) > left - 8)
			return eco_fail(error, ECO_DAMAGED, "%.300s: cut off: its binary chunk says %u "
				"bytes, there are %zu", doc->path, u32_at(bytes + at), left - 8);
		doc->chunk = (struct gltf_bytes){ .bytes = bytes + at + 8, .size = u32_at(bytes + at) };
	}
	return ECO_OK;
}

static enum eco_code check_version(const struct eco_gltf *doc, struct eco_error *error)
{
	const json_t *asset = json_object_get(doc->root, "asset");
	const char *version = eco_gltf_text(asset, "version");
	if (!json_is_object(doc->root) || (!asset && !json_object_get(doc->root, "meshes")))
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: JSON, but not glTF: it has no \"asset\"",
			doc->path);
	if (*version == '1' || *version == '0' || json_is_object(json_object_get(doc->root, "meshes")))
		return refuse_version_1(doc, error);
	if (*version != 0 && *version != '2')
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: glTF %.20s is not read, only 2.x", doc->path,
			version);
	return ECO_OK;
}

static enum eco_code parse(struct eco_gltf *doc, const uint8_t *bytes, size_t size, struct eco_error *error)
{
	const uint8_t *text = bytes;
	size_t length = size;
	json_error_t problem;
	enum eco_code code;
	if (size >= 4 && memcmp(bytes, "glTF", 4) == 0) {
		code = open_binary(doc, bytes, size, &length, error);
		if (code)
			return code;
		text = bytes + 20;
	}
	while (length > 0 && text[length - 1] == 0)
		length--;
	if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) {
		text += 3;
		length -= 3;
	}
	if (length > ECO_GLTF_JSON_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %zu bytes of JSON, at most %zu are possible",
			doc->path, length, ECO_GLTF_JSON_MAX);
	doc->root = json_loadb((const char *)text, length, 0, &problem);
	if (!doc->root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: line %d of its JSON: %s", doc->path,
			problem.line, problem.text);
	return check_version(doc, error);
}

static void take_arrays(struct eco_gltf *doc)
{
	doc->buffer_count = json_array_size(json_object_get(doc->root, "buffers"));
	doc->view_count = json_array_size(json_object_get(doc->root, "bufferViews"));
	doc->node_count = json_array_size(json_object_get(doc->root, "nodes"));
	doc->buffers = eco_alloc(doc->buffer_count + 1, sizeof *doc->buffers);
	doc->views = eco_alloc(doc->view_count + 1, sizeof *doc->views);
}

enum eco_code eco_gltf_open_memory(struct eco_gltf **doc, const char *name, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_gltf *d = eco_alloc(1, sizeof *d);
	*doc = NULL;
	d->path = eco_copy_text(name);
	enum eco_code code = parse(d, bytes, size, error);
	if (code) {
		eco_gltf_close(d);
		return code;
	}
	take_arrays(d);
	*doc = d;
	return ECO_OK;
}

enum eco_code eco_gltf_open(struct eco_gltf **doc, const char *path, struct eco_error *error)
{
	uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_file_read(path, ECO_GLTF_FILE_MAX, &bytes, &size, error);
	*doc = NULL;
	if (!code)
		code = eco_gltf_open_memory(doc, path, bytes, size, error);
	if (!code)
		(*doc)->owned = bytes;
	else
		free(bytes);
	return code;
}

void eco_gltf_close(struct eco_gltf *doc)
{
	if (!doc)
		return;
	for (size_t i = 0; i < doc->buffer_count && doc->buffers; i++)
		free(doc->buffers[i].owned);
	for (size_t i = 0; i < doc->view_count && doc->views; i++)
		free(doc->views[i].owned);
	free(doc->buffers);
	free(doc->views);
	free(doc->parent);
	free(doc->owned);
	free(doc->path);
	json_decref(doc->root);
	free(doc);
}
