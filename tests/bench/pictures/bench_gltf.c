#include "tests/bench/pictures/bench_gltf.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/format/chunk/chunk.h"
#include "lod/ground_choice.h"

enum component { BYTES = 5121, FLOATS = 5126 };  /* glTF's component types */

/* ---- Buffers ---- */

static enum eco_code close_file(FILE *file, const char *path, struct eco_error *error)
{
	bool good = file && !ferror(file);
	return file && fclose(file) == 0 && good ? ECO_OK : eco_fail(error, ECO_IO, "%.400s cannot be "
		"written", path);
}

static void write_corner(FILE *file, const float p[3])
{
	fwrite((const float[3]){ p[0], p[2], -p[1] }, sizeof(float), 3, file);   /* Y up */
}

static void write_mesh(FILE *file, const struct bench_full *full, const struct bench_full_mesh *m)
{
	for (uint32_t c = 0; c < m->corners; c++)
		write_corner(file, m->position + 3 * (size_t)c);
	if (m->uv)
		fwrite(m->uv, 2 * sizeof *m->uv, m->corners, file);
	for (uint32_t c = 0; c < m->corners && m->colored; c++) {
		const uint8_t *rgb = full->pack->scene.palette[m->color[c / 3]];
		fwrite((const uint8_t[4]){ rgb[0], rgb[1], rgb[2], 255 }, 1, 4, file);
	}
}

/* The first texture with the same texels: the pack has such once, and so should its peers. */
static uint32_t same_texture(const struct eco_scene *s, uint32_t image)
{
	uint64_t at = s->chunks[bench_full_last_chunk(s, image)].offset;
	for (uint32_t i = 0; i < image; i++)
		if (s->lists[i].kind == ECO_LIST_IMAGE
				&& s->chunks[bench_full_last_chunk(s, i)].offset == at)
			return i;
	return image;
}

static enum eco_code write_texture(const struct bench_full *full, const char *folder, uint32_t image,
	struct eco_error *error)
{
	char path[1024];
	const uint8_t *bytes;
	size_t size;
	snprintf(path, sizeof path, "%s/%u.webp", folder, image);
	enum eco_code code = eco_pack_payload(full->pack, bench_full_last_chunk(&full->pack->scene, image),
		&bytes, &size, error);
	return code ? code : eco_file_write(path, bytes, size, error);
}

enum eco_code bench_gltf_buffer(const struct bench_full *full, const char *folder, struct eco_error *error)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/plants.bin", folder);
	FILE *file = fopen(path, "wb");
	for (uint32_t i = 0; i < full->mesh_count && file; i++)
		write_mesh(file, full, &full->meshes[i]);
	enum eco_code code = close_file(file, path, error);
	for (uint32_t i = 0; i < full->mesh_count && !code; i++)
		if (full->meshes[i].image != ECO_NONE)
			code = write_texture(full, folder, same_texture(&full->pack->scene,
				full->meshes[i].image), error);
	return code;
}

/* ---- JSON ---- */

struct writer {
	const struct bench_full *full;
	json_t *root, *nodes, *meshes, *materials, *images, *textures, *accessors, *views;
	uint64_t *offsets;               /* of meshes in the buffer */
	uint32_t *mesh_of;               /* per plant: its mesh in the file; ECO_NONE: none yet */
	uint64_t outline_bytes;
};

/* Appends, and returns the index. */
static json_int_t add(json_t *array, json_t *item)
{
	json_array_append_new(array, item);
	return (json_int_t)json_array_size(array) - 1;
}

/* `bytes`: of all elements, at *offset, which moves on. */
static json_int_t add_accessor(struct writer *w, uint64_t *offset, uint64_t bytes, uint32_t count,
	const char *type)
{
	bool colors = !strcmp(type, "VEC4");
	json_int_t view = add(w->views, json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset",
		(json_int_t)*offset, "byteLength", (json_int_t)bytes));
	*offset += bytes;
	return add(w->accessors, json_pack("{s:I, s:i, s:b, s:I, s:s}", "bufferView", view,
		"componentType", colors ? BYTES : FLOATS, "normalized", (int)colors, "count",
		(json_int_t)count, "type", type));
}

static json_int_t texture_of(struct writer *w, uint32_t image)
{
	char uri[32];
	snprintf(uri, sizeof uri, "%u.webp", same_texture(&w->full->pack->scene, image));
	for (size_t i = 0; i < json_array_size(w->images); i++)
		if (!strcmp(json_string_value(json_object_get(json_array_get(w->images, i), "uri")), uri))
			return (json_int_t)i;
	const struct eco_scene *s = &w->full->pack->scene;
	if (s->lists[image].image != ECO_NONE)
		w->outline_bytes += s->chunks[bench_full_last_chunk(s, s->lists[image].image)].size_bytes;
	add(w->textures, json_pack("{s:I}", "source", (json_int_t)json_array_size(w->images)));
	return add(w->images, json_pack("{s:s}", "uri", uri));
}

/* Named by its texture. */
static json_int_t add_material(struct writer *w, const struct bench_full_mesh *mesh)
{
	char name[32];
	snprintf(name, sizeof name, "%u", mesh->image);
	json_t *look = json_object();
	if (mesh->uv)
		json_object_set_new(look, "baseColorTexture", json_pack("{s:I}", "index",
			texture_of(w, mesh->image)));
	return add(w->materials, json_pack("{s:s, s:b, s:s, s:o}", "name", name, "doubleSided", 1,
		"alphaMode", mesh->uv ? "MASK" : "OPAQUE", "pbrMetallicRoughness", look));
}

static json_t *primitive_of(struct writer *w, uint32_t mesh)
{
	const struct bench_full_mesh *m = &w->full->meshes[mesh];
	uint64_t offset = w->offsets[mesh], count = m->corners;
	json_t *attributes = json_pack("{s:I}", "POSITION", add_accessor(w, &offset, 12 * count, m->corners,
		"VEC3"));
	if (m->uv)
		json_object_set_new(attributes, "TEXCOORD_0", json_integer(add_accessor(w, &offset,
			8 * count, m->corners, "VEC2")));
	if (m->colored)
		json_object_set_new(attributes, "COLOR_0", json_integer(add_accessor(w, &offset, 4 * count,
			m->corners, "VEC4")));
	return json_pack("{s:o, s:I}", "attributes", attributes, "material", add_material(w, m));
}

/* The plant's mesh in the file. */
static uint32_t mesh_of(struct writer *w, uint32_t plant)
{
	if (w->mesh_of[plant] != ECO_NONE)
		return w->mesh_of[plant];
	json_t *primitives = json_array();
	for (uint32_t i = 0; i < w->full->mesh_count; i++)
		if (w->full->meshes[i].plant == plant && w->full->meshes[i].corners)
			json_array_append_new(primitives, primitive_of(w, i));
	return w->mesh_of[plant] = (uint32_t)add(w->meshes, json_pack("{s:o}", "primitives", primitives));
}

static uint64_t mesh_bytes(const struct bench_full_mesh *m)
{
	return (12u + (m->uv ? 8u : 0) + (m->colored ? 4u : 0)) * (uint64_t)m->corners;
}

static bool begin(struct writer *w, const struct bench_full *full)
{
	uint32_t plants = full->pack->scene.plant_count;
	uint64_t size = 0;
	*w = (struct writer){ .full = full, .nodes = json_array(), .meshes = json_array(),
		.materials = json_array(), .images = json_array(), .textures = json_array(),
		.accessors = json_array(), .views = json_array(),
		.offsets = malloc(((size_t)full->mesh_count + 1) * sizeof *w->offsets),
		.mesh_of = malloc(((size_t)plants + 1) * sizeof *w->mesh_of) };
	for (uint32_t i = 0; w->offsets && i < full->mesh_count; i++) {
		w->offsets[i] = size;
		size += mesh_bytes(&full->meshes[i]);
	}
	if (w->mesh_of)
		memset(w->mesh_of, 255, plants * sizeof *w->mesh_of);
	w->root = json_pack("{s:{s:s}, s:i, s:o, s:o, s:o, s:o, s:o, s:[{s:s, s:I}]}", "asset", "version",
		"2.0", "scene", 0, "nodes", w->nodes, "meshes", w->meshes, "materials", w->materials,
		"accessors", w->accessors, "bufferViews", w->views, "buffers", "uri", "plants.bin",
		"byteLength", (json_int_t)size);
	return w->offsets && w->mesh_of && w->root;
}

/* Empty arrays are not allowed. */
static enum eco_code finish(struct writer *w, const char *path, struct eco_error *error)
{
	json_t *roots = json_array();
	for (size_t i = 0; i < json_array_size(w->nodes); i++)
		json_array_append_new(roots, json_integer((json_int_t)i));
	json_object_set_new(w->root, "scenes", json_pack("[{s:o}]", "nodes", roots));
	if (json_array_size(w->images)) {
		json_object_set(w->root, "images", w->images);
		json_object_set(w->root, "textures", w->textures);
	}
	return json_dump_file(w->root, path, JSON_COMPACT) ? eco_fail(error, ECO_IO, "%.400s cannot be "
		"written", path) : ECO_OK;
}

static void close(struct writer *w)
{
	json_decref(w->root);
	json_decref(w->images);
	json_decref(w->textures);
	free(w->offsets);
	free(w->mesh_of);
}

/* ---- Plants ---- */

static bool sees(const struct bench_full *full, const struct lod_eye *eye, const struct bench_full_stand *s)
{
	const struct eco_scene *scene = &full->pack->scene;
	const struct eco_anchor *whole = &scene->anchors[scene->plants[s->plant].anchor_first];
	double center[3];
	lod_place_point(&s->place, whole->center, center);
	return lod_eye_sees(eye, center, (double)whole->radius * s->place.scale);
}

/* Turned about Y, up, by half angles. */
static json_t *node_of(const struct lod_place *p, json_int_t mesh)
{
	double half = 0.5 * atan2(p->sine, p->cosine);
	return json_pack("{s:I, s:[f,f,f], s:[f,f,f,f], s:[f,f,f]}", "mesh", mesh, "translation", p->at[0],
		p->at[2], -p->at[1], "rotation", 0.0, sin(half), 0.0, cos(half), "scale", p->scale, p->scale,
		p->scale);
}

/* gltfpack gives a plant that stands alone the coordinates of the scene, which coarsens the grid of all: so
 * it stands there twice. */
static void double_single(struct writer *w, const uint32_t *stands)
{
	for (size_t i = 0, count = json_array_size(w->nodes); i < count; i++) {
		json_t *node = json_array_get(w->nodes, i);
		if (stands[json_integer_value(json_object_get(node, "mesh"))] == 1)
			json_array_append(w->nodes, node);
	}
}

enum eco_code bench_gltf_view(const struct bench_full *full, const struct lod_eye *eye, const char *path,
	uint64_t *plants, uint64_t *outlines, struct eco_error *error)
{
	struct writer w;
	uint32_t *stands = calloc((size_t)full->pack->scene.plant_count + 1, sizeof *stands);
	bool good = begin(&w, full) && stands;
	*plants = 0;
	for (uint64_t i = 0; good && i < full->stand_count; i++) {
		const struct bench_full_stand *s = &full->stands[i];
		if (!sees(full, eye, s))
			continue;
		uint32_t mesh = mesh_of(&w, s->plant);
		stands[mesh]++;
		json_array_append_new(w.nodes, node_of(&s->place, mesh));
		++*plants;
	}
	if (good)
		double_single(&w, stands);
	*outlines = w.outline_bytes;
	enum eco_code code = !good ? eco_fail(error, ECO_NO_MEMORY, "no memory for %.400s", path)
		: *plants ? finish(&w, path, error) : ECO_OK;
	close(&w);
	free(stands);
	return code;
}

enum eco_code bench_gltf_kinds(const struct bench_full *full, const char *path, struct eco_error *error)
{
	struct writer w;
	bool good = begin(&w, full);
	for (uint32_t i = 0; good && i < full->pack->scene.plant_count; i++) {
		char name[16];
		snprintf(name, sizeof name, "%u", i);
		json_array_append_new(w.nodes, json_pack("{s:s, s:I}", "name", name, "mesh",
			(json_int_t)mesh_of(&w, i)));
	}
	enum eco_code code = good ? finish(&w, path, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for %.400s", path);
	close(&w);
	return code;
}

/* ---- Ground ---- */

/* Writes one tile and counts its corners. Samples lie as in ground_tile.h. */
static enum eco_code write_tile(const struct bench_full *full, uint32_t tile, FILE *file, uint64_t *corners,
	struct eco_error *error)
{
	static const uint32_t cell[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };
	const struct eco_scene *s = &full->pack->scene;
	const struct eco_list *list = &s->lists[s->ground[tile].list];
	struct eco_elements e = { 0 };
	struct eco_ground_span x, y;
	const uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_pack_payload(full->pack, list->chunk_first, &bytes, &size, error);
	if (!code)
		code = eco_chunk_decode(list, &s->chunks[list->chunk_first], 0, bytes, size, &e, error);
	eco_ground_spans(&x, &y, &s->ground[tile], s->ground_columns, s->ground_rows);
	for (uint32_t i = 0; !code && i < (x.inner - 1) * (y.inner - 1) * 6; i++, ++*corners) {
		uint32_t column = x.before + i / 6 % (x.inner - 1) + cell[i % 6][0],
			row = y.before + i / 6 / (x.inner - 1) + cell[i % 6][1];
		float p[3];
		for (size_t k = 0; k < 3; k++)
			p[k] = (float)(list->grid_origin[k] + list->grid_step[k]
				* e.position[3 * ((size_t)row * x.count + column) + k]);
		write_corner(file, p);
	}
	eco_elements_free(&e);
	return code;
}

static enum eco_code write_ground_json(const char *path, const char *buffer, uint64_t corners,
	struct eco_error *error)
{
	const char *slash = strrchr(buffer, '/');
	json_int_t size = (json_int_t)(3 * sizeof(float) * corners);
	json_t *root = json_pack("{s:{s:s}, s:i, s:[{s:[i]}], s:[{s:i}], s:[{s:[{s:{s:i}}]}], "
		"s:[{s:i, s:i, s:I, s:s}], s:[{s:i, s:I}], s:[{s:s, s:I}]}",
		"asset", "version", "2.0", "scene", 0, "scenes", "nodes", 0, "nodes", "mesh", 0,
		"meshes", "primitives", "attributes", "POSITION", 0,
		"accessors", "bufferView", 0, "componentType", FLOATS, "count", (json_int_t)corners,
		"type", "VEC3", "bufferViews", "buffer", 0, "byteLength", size,
		"buffers", "uri", slash ? slash + 1 : buffer, "byteLength", size);
	bool good = root && !json_dump_file(root, path, JSON_COMPACT);
	json_decref(root);
	return good ? ECO_OK : eco_fail(error, ECO_IO, "%.400s cannot be written", path);
}

enum eco_code bench_gltf_ground(const struct bench_full *full, const struct lod_eye *eye, const char *path,
	bool *any, struct eco_error *error)
{
	char buffer[1024], json[1024];
	struct lod_ground_choice choice = { .tiles = NULL };
	uint64_t corners = 0;
	enum eco_code code = lod_ground_select(&choice, &full->pack->scene, eye,
		&(struct lod_ground_limits){ .tolerance_px = ECO_GROUND_PX_MIN }, error);
	*any = !code && choice.count;
	if (!*any)
		return code;
	snprintf(buffer, sizeof buffer, "%s.bin", path);
	snprintf(json, sizeof json, "%s.gltf", path);
	FILE *file = fopen(buffer, "wb");
	for (uint32_t i = 0; i < choice.count && file && !code; i++)
		code = write_tile(full, choice.tiles[i], file, &corners, error);
	free(choice.tiles);
	enum eco_code closed = close_file(file, buffer, code ? NULL : error);
	code = code ? code : closed;
	return code ? code : write_ground_json(json, buffer, corners, error);
}
