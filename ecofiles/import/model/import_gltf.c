/* A glTF model becomes a soup. First the scene is walked, and each mesh in it is read once. Then it is
 * known which materials count and how far from the origin everything is. Then each place of each mesh is
 * written out, in double.
 *
 * Axes and unit are the format's: Y up, metres. A file that requires an extension unknown here is refused
 * by name: an error is better than a model that silently lacks its leaves. */
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"


struct shape {                       /* a mesh */
	uint32_t mesh;
	uint32_t first, count;       /* its pieces */
	uint64_t triangles, vertices;
};

struct place { uint32_t shape, node; double world[16]; };

struct soup {
	struct eco_gltf *doc;
	struct eco_error *error;
	uint32_t triangles_max;
	struct eco_soup soup;
	struct gltf_look *looks;     uint32_t look_count;
	struct gltf_surface *pieces; uint32_t piece_count, piece_room;       /* primitives, read */
	struct shape *shapes;        uint32_t shape_count, shape_room;
	uint32_t *shape_of;                   /* per mesh: its shape, or ECO_NONE */
	struct place *places;        uint32_t place_count, place_room;
	struct gltf_skin *skins;     uint32_t skin_count;
	struct gltf_counts counts;
	/* triangles of all shapes; each is placed at least once, so their sum is bounded */
	uint64_t read;
	uint64_t triangles, vertices, instances;
	bool colored;                        /* some vertices have colours */
};

/* ---- Required extensions ---- */

/* Extensions that are read, or that do not change a plant at rest; every KHR_materials_* only changes
 * shading, which is not computed here. */
static const char *const handled[] = { "KHR_draco_mesh_compression", "KHR_mesh_quantization",
	"EXT_meshopt_compression", "KHR_meshopt_compression", "EXT_mesh_gpu_instancing", "EXT_texture_webp",
	"KHR_texture_transform", "KHR_lights_punctual", "KHR_node_visibility", "KHR_animation_pointer",
	"KHR_xmp", "KHR_xmp_json_ld", "EXT_mesh_primitive_restart", "KHR_mesh_primitive_restart",
	"EXT_mesh_features", "EXT_instance_features", "EXT_structural_metadata", "EXT_lights_image_based",
	"EXT_lights_ies", "MSFT_lod", "FB_ngon_encoding", "GODOT_single_root" };

static bool is_handled(const char *name)
{
	if (strncmp(name, "KHR_materials_", 14) == 0)
		return true;
	for (size_t i = 0; i < sizeof handled / sizeof *handled; i++)
		if (strcmp(name, handled[i]) == 0)
			return true;
	return false;
}

static enum eco_code check_required(const struct soup *s)
{
	const json_t *required = json_object_get(eco_gltf_json(s->doc), "extensionsRequired");
	for (size_t i = 0; i < json_array_size(required); i++) {
		const char *name = json_string_value(json_array_get(required, i));
		if (name
			&& (strcmp(name, "KHR_texture_basisu") == 0 || strcmp(name, "EXT_texture_avif") == 0))
			return eco_fail(s->error, ECO_UNSUPPORTED,
				"%.200s: requires the glTF extension %s, which is not supported; export with "
				"PNG, JPEG or WebP textures", eco_gltf_path(s->doc), name);
		if (!name || !is_handled(name))
			return eco_fail(s->error, ECO_UNSUPPORTED,
				"%.200s: requires the glTF extension %.100s, which is not supported; export "
				"without it", eco_gltf_path(s->doc), name ? name : "(not a name)");
	}
	return ECO_OK;
}

/* ---- Meshes ---- */

static enum eco_code too_many(struct soup *s, uint64_t triangles)
{
	return triangles <= s->triangles_max ? ECO_OK : eco_fail(s->error, ECO_TOO_LARGE,
		"%.300s: %llu triangles or more, at most %u are possible",
		eco_gltf_path(s->doc), (unsigned long long)triangles, s->triangles_max);
}

static bool has_weights(const struct soup *s, uint32_t mesh)
{
	const json_t *weights = json_object_get(eco_gltf_item(s->doc, "meshes", mesh), "weights");
	for (size_t i = 0; i < json_array_size(weights); i++)
		if (json_number_value(json_array_get(weights, i)) != 0)
			return true;
	return false;
}

static enum eco_code read_piece(struct soup *s, struct shape *shape, const json_t *primitive, uint32_t number)
{
	struct gltf_surface_source source = { .doc = s->doc, .looks = s->looks, .look_count = s->look_count,
		.primitive = primitive, .morphed = has_weights(s, shape->mesh), .mesh = shape->mesh, .number = number,
		.triangles_max = s->triangles_max, .counts = &s->counts };
	eco_grow(&s->pieces, &s->piece_room, s->piece_count, sizeof *s->pieces);
	struct gltf_surface *piece = &s->pieces[s->piece_count];
	enum eco_code code = gltf_surface_read(piece, &source, s->error);
	if (code)
		return code;
	s->piece_count++;
	shape->count++;
	shape->triangles += piece->triangle_count;
	shape->vertices += piece->vertex_count;
	s->looks[piece->material].used = true;
	s->colored |= piece->color != NULL;
	s->read += piece->triangle_count;
	return too_many(s, s->read);
}

/* The shape of a mesh; reads it if it is new. */
static enum eco_code find_shape(struct soup *s, uint32_t mesh, uint32_t *found)
{
	const json_t *json = eco_gltf_item(s->doc, "meshes", mesh), *primitives = json_object_get(json, "primitives");
	enum eco_code code = ECO_OK;
	if (!json)
		return eco_fail(s->error, ECO_DAMAGED, "%.300s: names mesh %u, which is not there",
			eco_gltf_path(s->doc), mesh);
	*found = s->shape_of[mesh];
	if (*found != ECO_NONE)
		return ECO_OK;
	eco_grow(&s->shapes, &s->shape_room, s->shape_count, sizeof *s->shapes);
	struct shape *shape = &s->shapes[s->shape_count];
	*shape = (struct shape){ .mesh = mesh, .first = s->piece_count };
	for (size_t i = 0; i < json_array_size(primitives) && code == ECO_OK; i++)
		code = read_piece(s, shape, json_array_get(primitives, i), (uint32_t)i);
	*found = s->shape_of[mesh] = s->shape_count++;
	return code;
}

/* ---- Places ---- */

static enum eco_code add_place(struct soup *s, uint32_t shape, uint32_t node, const double world[16])
{
	s->triangles += s->shapes[shape].triangles;
	s->vertices += s->shapes[shape].vertices;
	if (too_many(s, s->triangles) != ECO_OK)
		return ECO_TOO_LARGE;
	eco_grow(&s->places, &s->place_room, s->place_count, sizeof *s->places);
	struct place *place = &s->places[s->place_count++];
	place->shape = shape;
	place->node = node;
	memcpy(place->world, world, sizeof place->world);
	return ECO_OK;
}

static enum eco_code add_instances(struct soup *s, uint32_t shape, uint32_t node, const double world[16],
	bool *there)
{
	struct eco_gltf_instances all;
	enum eco_code code = eco_gltf_instances_open(s->doc, node, there, &all, s->error);
	if (code != ECO_OK || !*there)
		return code;
	for (uint64_t i = 0; i < all.count && s->shapes[shape].triangles > 0 && code == ECO_OK; i++) {
		double matrix[16];
		eco_gltf_instance_matrix(&all, i, world, matrix);
		code = add_place(s, shape, node, matrix);
	}
	s->instances += all.count;
	eco_gltf_instances_close(&all);
	return code;
}

static enum eco_code visit(void *ctx, uint32_t node, const double world[16])
{
	struct soup *s = ctx;
	const json_t *json = eco_gltf_item(s->doc, "nodes", node);
	uint32_t shape = ECO_NONE;
	bool instanced = false;
	if (!json_object_get(json, "mesh"))
		return ECO_OK;
	enum eco_code code = find_shape(s, eco_gltf_index(json, "mesh"), &shape);
	if (!code)
		code = add_instances(s, shape, node, world, &instanced);
	if (code == ECO_OK && !instanced && s->shapes[shape].triangles > 0)
		code = add_place(s, shape, node, world);
	return code;
}

/* The skin of a place; reads it if it is new; NULL: none. */
static enum eco_code find_skin(struct soup *s, uint32_t node, const struct gltf_skin **skin)
{
	const json_t *json = eco_gltf_item(s->doc, "nodes", node);
	uint32_t index = eco_gltf_index(json, "skin");
	*skin = NULL;
	if (!json_object_get(json, "skin"))
		return ECO_OK;
	if (index >= s->skin_count)
		return eco_fail(s->error, ECO_DAMAGED, "%.300s: node %u names a skin that is not there",
			eco_gltf_path(s->doc), node);
	*skin = &s->skins[index];
	return s->skins[index].matrix ? ECO_OK : gltf_skin_read(&s->skins[index], s->doc, index, s->error);
}

/* A vertex's place in the scene, Z up. */
static void place_vertex(const struct gltf_surface *surface, uint32_t v, const struct place *place,
	const struct gltf_skin *skin, double out[3])
{
	const float *p = &surface->position[(size_t)v * 3];
	const double local[3] = { (double)p[0], (double)p[1], (double)p[2] };
	double world[3];
	if (!skin || !gltf_skin_place(skin, surface, v, world))
		eco_gltf_apply(place->world, local, world);
	out[0] = world[0];
	out[1] = -world[2];
	out[2] = world[1];
}

static double largest_scale(const double m[16])
{
	double most = 0;
	for (int c = 0; c < 3; c++)
		most = fmax(most, m[c * 4] * m[c * 4] + m[c * 4 + 1] * m[c * 4 + 1]
			+ m[c * 4 + 2] * m[c * 4 + 2]);
	return sqrt(most);
}

/* ---- The soup ---- */

static void add_piece(struct soup *s, const struct gltf_surface *piece, const struct place *place,
	const struct gltf_skin *skin)
{
	struct eco_soup *soup = &s->soup;
	const char *node = eco_gltf_text(eco_gltf_item(s->doc, "nodes", place->node), "name"),
		*mesh = eco_gltf_text(eco_gltf_item(s->doc, "meshes", s->shapes[place->shape].mesh), "name");
	const uint32_t first = soup->model->vertex_count;
	if (!s->looks[piece->material].invisible)
		eco_soup_part(soup, node, strlen(node), mesh, strlen(mesh));
	if (!skin)
		soup->far = fmax(soup->far, piece->far * largest_scale(place->world));
	for (uint32_t v = 0; v < piece->vertex_count; v++) {
		double at[3];
		place_vertex(piece, v, place, skin, at);
		eco_soup_vertex(soup, at, piece->uv ? &piece->uv[(size_t)v * 2] : NULL,
			piece->color ? &piece->color[(size_t)v * 3] : NULL);
	}
	eco_soup_mesh(soup, piece->material, piece->color);
	for (uint32_t i = 0; i < piece->triangle_count; i++) {
		uint32_t v[3];
		for (int k = 0; k < 3; k++) {
			uint32_t own = piece->index[(size_t)i * 3 + (size_t)k];
			v[k] = own != ECO_NONE ? first + own : ECO_NONE;
		}
		eco_soup_triangle(soup, v[0], v[1], v[2]);
	}
}

static enum eco_code add_places(struct soup *s)
{
	uint32_t parts = s->place_count < ECO_MODEL_PARTS_MAX ? s->place_count : ECO_MODEL_PARTS_MAX;
	eco_soup_reserve(&s->soup, s->vertices, s->triangles, parts, s->colored);
	for (uint32_t i = 0; i < s->place_count; i++) {
		const struct place *place = &s->places[i];
		const struct shape *shape = &s->shapes[place->shape];
		const struct gltf_skin *skin;
		enum eco_code code = find_skin(s, place->node, &skin);
		for (uint32_t k = 0; k < shape->count && !code; k++)
			add_piece(s, &s->pieces[shape->first + k], place, skin);
		if (code)
			return code;
	}
	return ECO_OK;
}

/* ---- The file ---- */

static void tell(struct soup *s)
{
	struct eco_notes *notes = s->soup.notes;
	const struct { uint64_t count; const char *are; } odd[] = {
		{ s->instances, "instances in it (EXT_mesh_gpu_instancing) make one plant" },
		{ s->counts.points, "points are left out: only triangles are drawn" },
		{ s->counts.lines, "lines are left out: only triangles are drawn" },
		{ s->counts.shapeless, "primitives without positions are left out" },
		{ s->counts.partial, "corners at the ends of lists of triangles make no triangle" },
		{ s->counts.morphed, "meshes have morph targets at rest, which are not applied" },
		{ s->counts.faint, "vertices have colours with alpha below 0.5, which is not applied" } };
	size_t scenes = json_array_size(json_object_get(eco_gltf_json(s->doc), "scenes"));
	if (!eco_gltf_has_scene(s->doc))
		eco_note(notes, "%s: all of its nodes are read",
			scenes > 0 ? "its default scene is not there" : "no scene in it");
	else if (scenes > 1)
		eco_note(notes, "%zu scenes are in it: the default one is read, else the first", scenes);
	for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
		if (odd[i].count > 0)
			eco_note(notes, "%llu %s", (unsigned long long)odd[i].count, odd[i].are);
}

static enum eco_code prepare(struct soup *s)
{
	size_t meshes = json_array_size(json_object_get(eco_gltf_json(s->doc), "meshes"));
	size_t skins = json_array_size(json_object_get(eco_gltf_json(s->doc), "skins"));
	*s->soup.frame = (struct eco_model_frame){ .format = "glTF", .unit_m = 1, .up = ECO_UP_Y,
		.convention = ECO_UP_Y };
	s->looks = gltf_looks_read(s->doc, &s->look_count);
	if (!s->looks)
		return eco_fail(s->error, ECO_NO_MEMORY, "%.300s: out of memory", eco_gltf_path(s->doc));
	s->shape_of = eco_alloc(meshes + 1, sizeof *s->shape_of);
	s->skins = eco_alloc(skins + 1, sizeof *s->skins);
	memset(s->shape_of, 0xff, meshes * sizeof *s->shape_of);
	s->skin_count = (uint32_t)skins;
	return check_required(s);
}

static enum eco_code check_totals(const struct soup *s)
{
	const char *path = eco_gltf_path(s->doc);
	if (s->triangles == 0 && s->counts.points + s->counts.lines > 0)
		return eco_fail(s->error, ECO_BAD_INPUT, "%.300s: no triangles in it, only %llu points and "
			"%llu lines; a point cloud has no surfaces: make a mesh of it first", path,
			(unsigned long long)s->counts.points, (unsigned long long)s->counts.lines);
	if (s->triangles == 0)
		return eco_fail(s->error, ECO_BAD_INPUT, "%.300s: no triangles in its scene", path);
	return ECO_OK;
}

static enum eco_code read_soup(struct soup *s)
{
	enum eco_code code = prepare(s);
	if (!code)
		code = eco_gltf_walk(s->doc, visit, s, s->error);
	if (!code)
		code = check_totals(s);
	if (code)
		return code;
	gltf_materials_read(s->soup.model, s->doc, s->looks, s->look_count, s->soup.notes);
	code = add_places(s);
	if (code)
		return code;
	bool *invisible = eco_alloc(s->look_count + 1u, 1);
	for (uint32_t i = 0; i <= s->look_count; i++)
		invisible[i] = s->looks[i].invisible;
	s->soup.invisible = invisible;
	tell(s);
	eco_soup_end(&s->soup, "baseColorFactor");
	free(invisible);
	return ECO_OK;
}

enum eco_code eco_gltf_read_document(struct eco_model *model, struct eco_model_frame *frame,
	struct eco_gltf *doc, uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	struct soup s = { .doc = doc, .error = error, .triangles_max = triangles_max,
		.soup = { .model = model, .frame = frame, .notes = notes, .linear = true } };
	enum eco_code code = read_soup(&s);
	eco_soup_free(&s.soup);
	for (uint32_t i = 0; i < s.piece_count; i++)
		gltf_surface_free(&s.pieces[i]);
	for (uint32_t i = 0; i < s.skin_count; i++)
		free(s.skins[i].matrix);
	free(s.pieces);
	free(s.shapes);
	free(s.places);
	free(s.skins);
	free(s.looks);
	free(s.shape_of);
	return code;
}

enum eco_code eco_gltf_read_model(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	struct eco_gltf *doc;
	enum eco_code code = eco_gltf_open(&doc, path, error);
	if (!code)
		code = eco_gltf_read_document(model, frame, doc, triangles_max, notes, error);
	eco_gltf_close(doc);
	return code;
}
