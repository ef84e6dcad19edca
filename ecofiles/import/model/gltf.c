/* The document: container, JSON, buffers, nodes. Common departures from the specification are accepted: a
 * JSON chunk padded with zeros, a byte order mark, whole numbers written as 3.0, names of buffers in another
 * system's spelling, a GLB named .gltf. Damage is refused: a GLB shorter than its header says was cut off. */
#include "ecofiles/import/model/gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_model.h"

#define FILE_MAX ((uint64_t)1 << 32)
#define JSON_MAX ((size_t)256 << 20)
#define CHUNK_JSON 0x4e4f534au
#define CHUNK_BIN 0x004e4942u

/* ---- JSON ---- */

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
	if (comma - uri < 7 || strncasecmp(comma - 7, ";base64", 7) != 0 || !decode_base64(comma + 1, *bytes,
		size)) {
		free(*bytes);
		*bytes = NULL;
		return eco_fail(error, ECO_DAMAGED, "a data URI that is not base64");
	}
	return ECO_OK;
}

/* ---- Buffers ---- */

static enum eco_code read_beside(const struct eco_gltf *doc, uint32_t index, const char *uri,
	struct eco_gltf_bytes *to, struct eco_error *error)
{
	char path[4096];
	if (!eco_model_find_beside(doc->path, uri, path, sizeof path))
		return eco_fail(error, ECO_NOT_FOUND, "%.250s: buffer %u: no file %.150s beside it",
			doc->path, index, uri);
	enum eco_code code = eco_file_read(path, FILE_MAX, &to->owned, &to->size, error);
	to->bytes = to->owned;
	return code;
}

static enum eco_code read_buffer(const struct eco_gltf *doc, uint32_t index, struct eco_gltf_bytes *to,
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

enum eco_code eco_gltf_buffer_range(struct eco_gltf *doc, uint32_t buffer, uint64_t offset, uint64_t size,
	const uint8_t **bytes, struct eco_error *error)
{
	enum eco_code code;
	if (buffer >= doc->buffer_count)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names a buffer that is not there", doc->path);
	struct eco_gltf_bytes *b = &doc->buffers[buffer];
	if (!b->bytes && (code = read_buffer(doc, buffer, b, error)) != ECO_OK)
		return code;
	if (offset > b->size || size > b->size - offset)
		return eco_fail(error, ECO_DAMAGED, "%.300s: buffer %u has only %zu bytes, its use needs "
			"%llu from %llu on; was it cut off?", doc->path, buffer, b->size,
			(unsigned long long)size, (unsigned long long)offset);
	*bytes = b->bytes + offset;
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
		doc->chunk = (struct eco_gltf_bytes){ .bytes = bytes + at + 8, .size = u32_at(bytes + at) };
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

static enum eco_code parse(struct eco_gltf *doc, struct eco_error *error)
{
	const uint8_t *text = doc->owned;
	size_t length = doc->size;
	json_error_t problem;
	if (length >= 4 && memcmp(text, "glTF", 4) == 0) {
		ECO_PASS(open_binary(doc, text, doc->size, &length, error));
		text += 20;
	}
	while (length > 0 && text[length - 1] == 0)
		length--;
	if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) {
		text += 3;
		length -= 3;
	}
	if (length > JSON_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %zu bytes of JSON, at most %zu are possible",
			doc->path, length, JSON_MAX);
	doc->root = json_loadb((const char *)text, length, 0, &problem);
	if (!doc->root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: line %d of its JSON: %s", doc->path,
			problem.line, problem.text);
	doc->buffer_count = json_array_size(json_object_get(doc->root, "buffers"));
	doc->view_count = json_array_size(json_object_get(doc->root, "bufferViews"));
	doc->node_count = json_array_size(json_object_get(doc->root, "nodes"));
	doc->buffers = eco_alloc(doc->buffer_count, sizeof *doc->buffers);
	doc->views = eco_alloc(doc->view_count, sizeof *doc->views);
	return check_version(doc, error);
}

enum eco_code eco_gltf_open(struct eco_gltf **doc, const char *path, struct eco_error *error)
{
	struct eco_gltf *d = eco_alloc(1, sizeof *d);
	d->path = eco_copy_text(path);
	enum eco_code code = eco_file_read(path, FILE_MAX, &d->owned, &d->size, error);
	if (!code)
		code = parse(d, error);
	*doc = code ? NULL : d;
	if (code)
		eco_gltf_close(d);
	return code;
}

void eco_gltf_close(struct eco_gltf *doc)
{
	if (!doc)
		return;
	for (size_t i = 0; i < doc->buffer_count; i++)
		free(doc->buffers[i].owned);
	for (size_t i = 0; i < doc->view_count; i++)
		free(doc->views[i].owned);
	eco_free(doc->buffers, doc->views, doc->parent, doc->owned, doc->path);
	json_decref(doc->root);
	free(doc);
}

/* ---- Nodes: no recursion, as a stranger's file may have a tree of any depth, or none ---- */

void eco_gltf_multiply(double out[16], const double a[16], const double b[16])
{
	double product[16];
	for (int c = 0; c < 4; c++)
		for (int r = 0; r < 4; r++)
			product[c * 4 + r] = a[r] * b[c * 4] + a[4 + r] * b[c * 4 + 1]
				+ a[8 + r] * b[c * 4 + 2] + a[12 + r] * b[c * 4 + 3];
	memcpy(out, product, sizeof product);
}

void eco_gltf_apply(const double m[16], const double p[3], double out[3])
{
	double x = p[0], y = p[1], z = p[2];
	for (int r = 0; r < 3; r++)
		out[r] = m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r];
}

void eco_gltf_compose(double out[16], const double t[3], const double q[4], const double s[3])
{
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]),
		unit = length > 0 ? 1 / length : 0;
	double x = q[0] * unit, y = q[1] * unit, z = q[2] * unit, w = length > 0 ? q[3] * unit : 1;
	const double turn[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w),
		2 * (x * y - z * w), 1 - 2 * (x * x + z * z),
		2 * (y * z + x * w), 2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y) };

	for (int c = 0; c < 3; c++) {
		for (int r = 0; r < 3; r++)
			out[c * 4 + r] = turn[c * 3 + r] * s[c];
		out[c * 4 + 3] = 0;
		out[12 + c] = t[c];
	}
	out[15] = 1;
}

static enum eco_code local_matrix(const struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "nodes", node);
	double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names node %u, which is not there", doc->path,
			node);
	bool good = eco_gltf_numbers(json, "translation", t, 3) && eco_gltf_numbers(json, "rotation", q, 4)
		&& eco_gltf_numbers(json, "scale", s, 3);
	eco_gltf_compose(matrix, t, q, s);
	if (json_array_size(json_object_get(json, "matrix")) == 16)
		good = eco_gltf_numbers(json, "matrix", matrix, 16);
	return good ? ECO_OK : eco_fail(error, ECO_DAMAGED, "%.300s: node %u is not placed by numbers",
		doc->path, node);
}

static uint32_t node_number(const struct eco_gltf *doc, const json_t *value)
{
	json_int_t node = json_is_integer(value) ? json_integer_value(value) : -1;
	return node >= 0 && (uint64_t)node < doc->node_count && node < ECO_NONE ? (uint32_t)node : ECO_NONE;
}

static void find_parents(struct eco_gltf *doc)
{
	if (doc->parent)
		return;
	doc->parent = eco_alloc(doc->node_count, sizeof *doc->parent);
	memset(doc->parent, 0xff, doc->node_count * sizeof *doc->parent);
	for (size_t i = 0; i < doc->node_count && i < ECO_NONE; i++) {
		const json_t *children = json_object_get(eco_gltf_item(doc, "nodes", i), "children");
		for (size_t k = 0; k < json_array_size(children); k++) {
			uint32_t child = node_number(doc, json_array_get(children, k));
			if (child != ECO_NONE && doc->parent[child] == ECO_NONE)
				doc->parent[child] = (uint32_t)i;
		}
	}
}

enum eco_code eco_gltf_node_matrix(struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error)
{
	enum eco_code code = local_matrix(doc, node, matrix, error);
	size_t steps = 0;
	find_parents(doc);
	while (code == ECO_OK && doc->parent[node] != ECO_NONE) {
		double local[16];
		node = doc->parent[node];
		if (++steps > doc->node_count)
			return eco_fail(error, ECO_DAMAGED, "%.300s: node %u is below itself", doc->path,
				node);
		code = local_matrix(doc, node, local, error);
		if (!code)
			eco_gltf_multiply(matrix, local, matrix);
	}
	return code;
}

/* ---- The scene ---- */

struct walk {
	struct eco_gltf *doc;
	struct entry { uint32_t node, depth; double world[16]; } *stack;     /* depth: nodes above it */
	uint32_t count, capacity, seen;
	struct eco_error *error;
};

static enum eco_code push(struct walk *w, uint32_t node, uint32_t depth, const double world[16])
{
	if (depth >= w->doc->node_count)
		return eco_fail(w->error, ECO_DAMAGED,
			"%.300s: node %u or one above it lies below itself: nodes must be a tree",
			w->doc->path, node);
	if (++w->seen > ECO_GLTF_NODES_MAX)
		return eco_fail(w->error, ECO_TOO_LARGE,
			"%.300s: more than %u nodes, as some have several parents", w->doc->path,
			ECO_GLTF_NODES_MAX);
	eco_grow(&w->stack, &w->capacity, w->count, sizeof *w->stack);
	struct entry *to = &w->stack[w->count++];
	to->node = node;
	to->depth = depth;
	memcpy(to->world, world, sizeof to->world);
	return ECO_OK;
}

/* Pushes in reverse, so that the first is popped first. */
static enum eco_code push_all(struct walk *w, const json_t *nodes, uint32_t depth, const double world[16])
{
	enum eco_code code = ECO_OK;
	for (size_t i = json_array_size(nodes); i-- > 0 && code == ECO_OK;) {
		const json_t *value = json_array_get(nodes, i);
		uint32_t node = node_number(w->doc, value);
		if (node == ECO_NONE)
			return eco_fail(w->error, ECO_DAMAGED, "%.300s: names node %lld, which is not there",
				w->doc->path, json_is_integer(value) ? (long long)json_integer_value(value)
				: -1);
		code = push(w, node, depth, world);
	}
	return code;
}

const json_t *eco_gltf_scene(const struct eco_gltf *doc)
{
	return eco_gltf_item(doc, "scenes", json_object_get(doc->root, "scene") != NULL
		? eco_gltf_whole(doc->root, "scene", ECO_NONE) : 0);
}

/* Marks the nodes that MSFT_lod names as coarser levels of others. */
static bool *find_coarser(const struct eco_gltf *doc)
{
	bool *coarser = eco_alloc(doc->node_count + 1u, sizeof *coarser);
	for (size_t i = 0; i < doc->node_count; i++) {
		const json_t *ids = json_object_get(eco_gltf_extension(eco_gltf_item(doc, "nodes", i), "MSFT_lod"), "ids");
		for (size_t k = 0; k < json_array_size(ids); k++) {
			uint32_t node = node_number(doc, json_array_get(ids, k));
			if (node != ECO_NONE && node != i)
				coarser[node] = true;
		}
	}
	return coarser;
}

static enum eco_code push_roots(struct walk *w)
{
	static const double identity[16] = { [0] = 1, [5] = 1, [10] = 1, [15] = 1 };
	const json_t *scene = eco_gltf_scene(w->doc);
	enum eco_code code = ECO_OK;
	if (scene)
		return push_all(w, json_object_get(scene, "nodes"), 0, identity);
	find_parents(w->doc);
	for (size_t i = w->doc->node_count; i-- > 0 && code == ECO_OK;)
		if (w->doc->parent[i] == ECO_NONE)
			code = push(w, (uint32_t)i, 0, identity);
	return code;
}

enum eco_code eco_gltf_walk(struct eco_gltf *doc, eco_gltf_visit *visit, void *ctx, struct eco_error *error)
{
	struct walk w = { .doc = doc, .error = error };
	bool *coarser = find_coarser(doc);
	enum eco_code code = push_roots(&w);
	doc->coarser = 0;
	while (code == ECO_OK && w.count > 0) {
		struct entry top = w.stack[--w.count];
		const json_t *node = eco_gltf_item(doc, "nodes", top.node);
		double local[16];
		if (coarser[top.node]) {
			doc->coarser++;
			continue;
		}
		if (json_is_false(json_object_get(eco_gltf_extension(node, "KHR_node_visibility"),
			"visible")))
			continue;
		code = local_matrix(doc, top.node, local, error);
		if (code)
			break;
		eco_gltf_multiply(top.world, top.world, local);
		code = visit(ctx, top.node, top.world);
		if (!code)
			code = push_all(&w, json_object_get(node, "children"), top.depth + 1, top.world);
	}
	free(w.stack);
	free(coarser);
	return code;
}
