/* What glTF files may require beyond assimp 5.2: refused by name, or rewritten. assimp itself ignores what it does not know, and
 * a model that silently lacks its leaves is worse than an error. A WebP texture is an ordinary texture whose `source` sits in an
 * extension: moving it out is all that is needed, for the image module reads WebP. */
#include "ecofiles/import_model.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "ecofiles/turn.h"

#define GLTF_BYTES_MAX ((off_t)1 << 31)
#define JSON_BYTES_MAX (256u << 20)
#define MATERIALS_MAX 65536u
#define CHUNK_JSON 0x4e4f534au

struct extension { const char *name, *why; };

/* Required extensions that are read correctly; every KHR_materials_* only changes a shading that is not computed here. */
static const char *const handled[] = { "KHR_draco_mesh_compression", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual",
	"KHR_xmp_json_ld" };
/* Those that lose geometry even where a file only "uses" them. */
static const struct extension lossy[] = {
	{ "EXT_mesh_gpu_instancing", "its instances would be lost: apply them in the program that wrote the file" },
	{ "EXT_meshopt_compression", "export without meshopt compression (gltfpack without -c)" },
	{ "KHR_mesh_quantization", "export without quantization (gltfpack -noq)" },
};

static enum eco_code read_file(const char *path, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	FILE *file = fopen(path, "rb");
	struct stat status;
	enum eco_code code = ECO_OK;

	*bytes = NULL;
	if (file == NULL)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", path, strerror(errno));
	if (fstat(fileno(file), &status) != 0 || !S_ISREG(status.st_mode))
		code = eco_fail(error, ECO_IO, "%s: not a regular file", path);
	else if (status.st_size > GLTF_BYTES_MAX)
		code = eco_fail(error, ECO_TOO_LARGE, "%s: more than %lld bytes", path, (long long)GLTF_BYTES_MAX);
	else if ((*bytes = malloc((size_t)status.st_size + 1)) == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", path);
	else
		*size = fread(*bytes, 1, (size_t)status.st_size, file);
	fclose(file);
	return code;
}

static uint32_t u32_at(const uint8_t *p)
{
	return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void put_u32(uint8_t *p, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		p[i] = (uint8_t)(v >> (8 * i));
}

/* ---- The document ---- */

static bool is_handled(const char *name)
{
	if (strncmp(name, "KHR_materials_", 14) == 0)
		return true;
	for (size_t i = 0; i < sizeof handled / sizeof *handled; i++)
		if (strcmp(name, handled[i]) == 0)
			return true;
	return false;
}

static enum eco_code check_extensions(const json_t *document, const char *path, struct eco_error *error)
{
	const json_t *used = json_object_get(document, "extensionsUsed"), *required = json_object_get(document, "extensionsRequired");
	const json_t *lists[] = { used, required };

	for (size_t l = 0; l < 2; l++)
		for (size_t i = 0; i < json_array_size(lists[l]); i++) {
			const char *name = json_string_value(json_array_get(lists[l], i));

			for (size_t k = 0; name != NULL && k < sizeof lossy / sizeof *lossy; k++)
				if (strcmp(name, lossy[k].name) == 0)
					return eco_fail(error, ECO_UNSUPPORTED, "%.200s: uses the glTF extension %s, which is not supported; %s", path, name,
						lossy[k].why);
		}
	for (size_t i = 0; i < json_array_size(required); i++) {
		const char *name = json_string_value(json_array_get(required, i));

		if (name == NULL || !is_handled(name))
			return eco_fail(error, ECO_UNSUPPORTED, "%.200s: requires the glTF extension %.100s, which is not supported; export without it",
				path, name != NULL ? name : "(not a name)");
	}
	return ECO_OK;
}

/* True if something was rewritten. */
static bool move_webp_sources(json_t *document)
{
	json_t *textures = json_object_get(document, "textures");
	bool changed = false;

	for (size_t i = 0; i < json_array_size(textures); i++) {
		json_t *texture = json_array_get(textures, i);
		json_t *webp = json_object_get(json_object_get(texture, "extensions"), "EXT_texture_webp");
		json_t *source = json_object_get(webp, "source");

		if (json_is_integer(source) && json_object_get(texture, "source") == NULL)
			changed |= json_object_set(texture, "source", source) == 0;
	}
	return changed;
}

static json_t *draco_indices(json_t *accessors, const json_t *primitive, uint64_t *vertices)
{
	const json_t *position = json_object_get(json_object_get(primitive, "attributes"), "POSITION");
	json_t *indices = json_object_get(primitive, "indices"), *accessor;

	if (json_object_get(json_object_get(primitive, "extensions"), "KHR_draco_mesh_compression") == NULL || !json_is_integer(indices)
		|| !json_is_integer(position) || json_integer_value(indices) < 0 || json_integer_value(position) < 0)
		return NULL;
	accessor = json_array_get(accessors, (size_t)json_integer_value(position));
	*vertices = (uint64_t)json_integer_value(json_object_get(accessor, "count"));
	accessor = json_array_get(accessors, (size_t)json_integer_value(indices));
	return json_integer_value(json_object_get(accessor, "componentType")) == 5125 ? accessor : NULL;
}

/* assimp 5.2 decodes Draco triangles, but forgets the result where indices are declared as 32-bit (its issue 4789). Declared as 16-bit
 * they mean the same, as long as that suffices. */
static enum eco_code narrow_draco_indices(json_t *document, const char *path, bool *changed, struct eco_error *error)
{
	json_t *meshes = json_object_get(document, "meshes"), *accessors = json_object_get(document, "accessors");

	for (size_t i = 0; i < json_array_size(meshes); i++) {
		const json_t *primitives = json_object_get(json_array_get(meshes, i), "primitives");

		for (size_t k = 0; k < json_array_size(primitives); k++) {
			uint64_t vertices = 0;
			json_t *accessor = draco_indices(accessors, json_array_get(primitives, k), &vertices);

			if (accessor == NULL)
				continue;
			if (vertices > 65535)
				return eco_fail(error, ECO_UNSUPPORTED, "%.200s: uses the glTF extension KHR_draco_mesh_compression with more than 65,535 vertices "
					"in one mesh, which is not supported; export without it", path);
			*changed |= json_object_set_new(accessor, "componentType", json_integer(5123)) == 0;
		}
	}
	return ECO_OK;
}

static void pair_of(const json_t *array, double out[2])
{
	for (size_t i = 0; i < 2; i++)
		if (json_is_number(json_array_get(array, i)) && fabs(json_number_value(json_array_get(array, i))) <= 65536)
			out[i] = json_number_value(json_array_get(array, i));
}

static bool read_transform(const json_t *material, struct eco_uv_transform *to)
{
	const json_t *texture = json_object_get(json_object_get(material, "pbrMetallicRoughness"), "baseColorTexture");
	const json_t *from = json_object_get(json_object_get(texture, "extensions"), "KHR_texture_transform");
	double radians = json_number_value(json_object_get(from, "rotation"));
	const json_t *channel = json_object_get(from, "texCoord");

	*to = (struct eco_uv_transform){ .used = from != NULL, .scale = { 1, 1 }, .channel = -1 };
	pair_of(json_object_get(from, "offset"), to->offset);
	pair_of(json_object_get(from, "scale"), to->scale);
	eco_turn_sincos(eco_turn_from_deg(fabs(radians) <= 1e6 ? radians * (180 / 3.14159265358979323846) : 0), &to->sine, &to->cosine);
	if (json_is_integer(channel) && json_integer_value(channel) >= 0)
		to->channel = json_integer_value(channel);
	return to->used;
}

/* assimp 5.2 turns and scales about the middle of the image; the extension does so about its corner. It is also told to leave the
 * extension alone: the entry is taken out of the document. */
static enum eco_code take_transforms(json_t *document, struct eco_model_file *file, bool *changed, struct eco_error *error)
{
	const json_t *materials = json_object_get(document, "materials");
	size_t count = json_array_size(materials);
	bool any = false;

	if (count > MATERIALS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %zu materials, at most %u are possible", file->path, count, MATERIALS_MAX);
	file->transforms = calloc(count + 1, sizeof *file->transforms);
	if (file->transforms == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", file->path);
	file->transform_count = (uint32_t)count;
	for (size_t i = 0; i < count; i++) {
		json_t *material = json_array_get(materials, i);
		json_t *texture = json_object_get(json_object_get(material, "pbrMetallicRoughness"), "baseColorTexture");

		if (read_transform(material, &file->transforms[i])) {
			json_object_del(json_object_get(texture, "extensions"), "KHR_texture_transform");
			any = true;
		}
	}
	*changed |= any;
	return ECO_OK;
}

/* ---- The container ---- */

/* JSON text within the file: all of a .gltf, the first chunk of a .glb. */
static bool find_json(const uint8_t *bytes, size_t size, bool *binary, size_t *at, size_t *length)
{
	*binary = size >= 4 && memcmp(bytes, "glTF", 4) == 0;
	*at = 0;
	*length = size;
	if (!*binary)
		return true;
	if (size < 20 || u32_at(bytes + 4) != 2 || u32_at(bytes + 16) != CHUNK_JSON || u32_at(bytes + 12) > size - 20)
		return false;
	*at = 20;
	*length = u32_at(bytes + 12);
	return true;
}

/* The same file with another JSON text. */
static bool replace_json(struct eco_model_file *file, const uint8_t *bytes, size_t size, bool binary, size_t rest, const char *json)
{
	size_t length = strlen(json), padded = binary ? (length + 3) & ~(size_t)3 : length, head = binary ? 20 : 0;

	if (rest > size)
		rest = size;
	file->size_bytes = head + padded + (binary ? size - rest : 0);
	file->bytes = malloc(file->size_bytes + 1);
	if (file->bytes == NULL || file->size_bytes > UINT32_MAX)
		return false;
	memset(file->bytes + head, ' ', padded);
	memcpy(file->bytes + head, json, length);
	if (binary) {
		memcpy(file->bytes, bytes, 20);
		put_u32(file->bytes + 8, (uint32_t)file->size_bytes);
		put_u32(file->bytes + 12, (uint32_t)padded);
		memcpy(file->bytes + head + padded, bytes + rest, size - rest);
	}
	return true;
}

static enum eco_code prepare_document(struct eco_model_file *file, const uint8_t *bytes, size_t size, struct eco_error *error)
{
	json_error_t problem;
	json_t *document;
	size_t at, length;
	bool binary, changed;
	enum eco_code code;

	if (!find_json(bytes, size, &binary, &at, &length))
		return eco_fail(error, ECO_DAMAGED, "%.300s: not a glTF 2.0 binary file, or cut off", file->path);
	if (length > JSON_BYTES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %zu bytes of JSON, at most %u are possible", file->path, length, JSON_BYTES_MAX);
	document = json_loadb((const char *)bytes + at, length, 0, &problem);
	if (document == NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: line %d of its JSON: %s", file->path, problem.line, problem.text);
	code = check_extensions(document, file->path, error);
	changed = move_webp_sources(document);
	if (code == ECO_OK)
		code = narrow_draco_indices(document, file->path, &changed, error);
	if (code == ECO_OK)
		code = take_transforms(document, file, &changed, error);
	if (code == ECO_OK && changed) {
		char *json = json_dumps(document, JSON_COMPACT);

		if (json == NULL || !replace_json(file, bytes, size, binary, at + ((length + 3) & ~(size_t)3), json))
			code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", file->path);
		free(json);
	}
	json_decref(document);
	return code;
}

static bool head_has(const char *path, const char *word)
{
	char head[513] = "";
	FILE *file = fopen(path, "rb");

	if (file == NULL)
		return false;
	head[fread(head, 1, sizeof head - 1, file)] = 0;
	fclose(file);
	return strstr(head, word) != NULL;
}

/* Blender writes scene-linear colours to MTL files; other programs write what the screen shall show, or pass on what they read.
 * The library of materials usually has the model's name. */
static bool from_blender(const char *path, const char *dot)
{
	char library[4096];

	if (head_has(path, "Blender"))
		return true;
	return dot != NULL && snprintf(library, sizeof library, "%.*s.mtl", (int)(dot - path), path) < (int)sizeof library
		&& head_has(library, "Blender");
}

enum eco_code eco_model_file_prepare(struct eco_model_file *file, struct eco_error *error)
{
	const char *dot = strrchr(file->path, '.');
	uint8_t *bytes;
	size_t size = 0;
	enum eco_code code;

	file->gltf = dot != NULL && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0);
	file->linear_colors = file->gltf || from_blender(file->path, dot);
	if (!file->gltf)
		return ECO_OK;
	code = read_file(file->path, &bytes, &size, error);
	if (code == ECO_OK)
		code = prepare_document(file, bytes, size, error);
	free(bytes);
	return code;
}
