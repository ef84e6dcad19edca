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

#include "ecofiles/base/array_grow.h"

struct piece {                       /* a primitive, read */
	struct gltf_surface surface;
	uint32_t whole;              /* one material for all; ECO_NONE: vertex colours differ */
};

struct shape {                       /* a mesh at rest, or with the morph weights of a node */
	uint32_t mesh;
	const json_t *weights;
	uint32_t first, count;       /* its pieces */
	uint64_t triangles;
};

struct place { uint32_t shape, node; double world[16]; };

struct soup {
	struct eco_gltf *doc;
	struct eco_model *model;
	struct eco_model_frame *frame;
	struct eco_notes *notes;
	struct eco_error *error;
	uint32_t triangles_max;
	struct gltf_look *looks;     uint32_t look_count;
	struct piece *pieces;        uint32_t piece_count, piece_room;
	struct shape *shapes;        uint32_t shape_count, shape_room;
	uint32_t *at_rest;                   /* per mesh: its shape, or ECO_NONE */
	struct place *places;        uint32_t place_count, place_room;
	struct gltf_skin *skins;     uint32_t skin_count;
	struct eco_tints tints;
	struct gltf_counts counts;
	/* triangles of all shapes; each is placed at least once, so their sum is bounded */
	uint64_t read;
	uint64_t triangles, vertices, hidden, instances;
	uint32_t averaged;           /* textured primitives whose vertex colours differ */
};

static enum eco_code out_of_memory(struct soup *s)
{
	return eco_fail(s->error, ECO_NO_MEMORY, "%.300s: out of memory", eco_gltf_path(s->doc));
}

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

static enum eco_code read_piece(struct soup *s, struct shape *shape, const json_t *primitive, uint32_t number)
{
	struct gltf_surface_source source = { .doc = s->doc, .looks = s->looks, .look_count = s->look_count,
		.primitive = primitive, .weights = shape->weights, .mesh = shape->mesh, .number = number,
		.triangles_max = s->triangles_max, .counts = &s->counts };
	if (!eco_array_grow(&s->pieces, &s->piece_room, s->piece_count, sizeof *s->pieces))
		return out_of_memory(s);
	struct piece *piece = &s->pieces[s->piece_count];
	enum eco_code code = gltf_surface_read(&piece->surface, &source, s->error);
	if (code)
		return code;
	s->piece_count++;
	shape->count++;
	shape->triangles += piece->surface.triangle_count;
	s->looks[piece->surface.material].used = true;
	s->read += piece->surface.triangle_count;
	return too_many(s, s->read);
}

/* The shape of a node's mesh; reads it if it is new. A node with weights has a shape of its own. */
static enum eco_code find_shape(struct soup *s, uint32_t mesh, const json_t *node, uint32_t *found)
{
	const json_t *json = eco_gltf_item(s->doc, "meshes", mesh), *own = json_object_get(node, "weights"),
		*primitives = json_object_get(json, "primitives");
	enum eco_code code = ECO_OK;
	if (!json)
		return eco_fail(s->error, ECO_DAMAGED, "%.300s: names mesh %u, which is not there",
			eco_gltf_path(s->doc), mesh);
	*found = own ? ECO_NONE : s->at_rest[mesh];
	if (*found != ECO_NONE)
		return ECO_OK;
	if (!eco_array_grow(&s->shapes, &s->shape_room, s->shape_count, sizeof *s->shapes))
		return out_of_memory(s);
	struct shape *shape = &s->shapes[s->shape_count];
	*shape = (struct shape){ .mesh = mesh, .weights = own ? own : json_object_get(json, "weights"),
		.first = s->piece_count };
	for (size_t i = 0; i < json_array_size(primitives) && code == ECO_OK; i++)
		code = read_piece(s, shape, json_array_get(primitives, i), (uint32_t)i);
	*found = s->shape_count++;
	if (!own)
		s->at_rest[mesh] = *found;
	return code;
}

/* ---- Places ---- */

static enum eco_code add_place(struct soup *s, uint32_t shape, uint32_t node, const double world[16])
{
	s->triangles += s->shapes[shape].triangles;
	if (too_many(s, s->triangles) != ECO_OK)
		return ECO_TOO_LARGE;
	if (!eco_array_grow(&s->places, &s->place_room, s->place_count, sizeof *s->places))
		return out_of_memory(s);
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
	enum eco_code code = find_shape(s, eco_gltf_index(json, "mesh"), json, &shape);
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

struct reach { struct eco_bounds bounds; double far; };

static double largest_scale(const double m[16])
{
	double most = 0;
	for (int c = 0; c < 3; c++)
		most = fmax(most, m[c * 4] * m[c * 4] + m[c * 4 + 1] * m[c * 4 + 1]
			+ m[c * 4 + 2] * m[c * 4 + 2]);
	return sqrt(most);
}

/* Calls act(s, surface, ...) for every piece of every place. */
typedef enum eco_code act_on(struct soup *s, void *ctx, const struct piece *piece, const struct place *place,
	const struct gltf_skin *skin);

static enum eco_code for_all(struct soup *s, act_on *act, void *ctx)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < s->place_count && code == ECO_OK; i++) {
		const struct place *place = &s->places[i];
		const struct shape *shape = &s->shapes[place->shape];
		const struct gltf_skin *skin;
		code = find_skin(s, place->node, &skin);
		for (uint32_t k = 0; k < shape->count && code == ECO_OK; k++)
			code = act(s, ctx, &s->pieces[shape->first + k], place, skin);
	}
	return code;
}

static enum eco_code measure(struct soup *s, void *ctx, const struct piece *piece, const struct place *place,
	const struct gltf_skin *skin)
{
	const struct gltf_surface *surface = &piece->surface;
	struct reach *r = ctx;
	if (!skin)
		r->far = fmax(r->far, surface->far * largest_scale(place->world));
	for (uint32_t v = 0; v < surface->vertex_count; v++) {
		double at[3];
		place_vertex(surface, v, place, skin, at);
		eco_bounds_add(&r->bounds, at);
	}
	s->vertices += surface->vertex_count;
	return ECO_OK;
}

static enum eco_code choose_base(struct soup *s)
{
	struct reach r = { ECO_NO_BOUNDS, 0 };
	enum eco_code code = for_all(s, measure, &r);
	if (code || r.bounds.low[0] > r.bounds.high[0])
		return code;
	eco_model_choose_base(&r.bounds, s->frame->base);
	eco_note_coarse(s->notes, r.far, eco_bounds_extent(&r.bounds));
	return ECO_OK;
}

/* ---- Colours of vertices ---- */

static void choose_whole(struct soup *s, struct piece *piece)
{
	const struct gltf_surface *surface = &piece->surface;
	struct eco_vertex_colors colors = { .count = 0 };
	for (uint32_t v = 0; v < surface->vertex_count && surface->color; v++)
		eco_vertex_colors_add(&colors, &surface->color[(size_t)v * 3]);
	piece->whole = eco_tints_get_whole(&s->tints, surface->material, &colors, true, &s->averaged);
}

static uint32_t triangle_material(struct soup *s, const struct piece *piece, const uint32_t *v)
{
	struct eco_vertex_colors colors = { .count = 0 };
	if (piece->whole != ECO_NONE)
		return piece->whole;
	if (v[0] == ECO_NONE || v[1] == ECO_NONE || v[2] == ECO_NONE)
		return piece->surface.material;
	for (int k = 0; k < 3; k++)
		eco_vertex_colors_add(&colors, &piece->surface.color[(size_t)v[k] * 3]);
	return eco_tints_get_step(&s->tints, piece->surface.material, &colors, true);
}

/* ---- The soup ---- */

static bool take_memory(struct soup *s)
{
	uint32_t parts = s->place_count < ECO_MODEL_PARTS_MAX ? s->place_count : ECO_MODEL_PARTS_MAX;
	return eco_model_reserve(s->model, s->vertices, s->triangles, parts)
		&& eco_tints_start(&s->tints, s->model);
}

static void add_vertices(struct soup *s, const struct gltf_surface *surface, const struct place *place,
	const struct gltf_skin *skin)
{
	struct eco_model *m = s->model;
	for (uint32_t v = 0; v < surface->vertex_count; v++) {
		size_t to = (size_t)m->vertex_count + v;
		double at[3];
		place_vertex(surface, v, place, skin, at);
		for (size_t k = 0; k < 3; k++)
			m->position[to * 3 + k] = (float)(at[k] - s->frame->base[k]);
		if (surface->uv)
			memcpy(&m->uv[to * 2], &surface->uv[(size_t)v * 2], 2 * sizeof *m->uv);
	}
}

static enum eco_code add_piece(struct soup *s, void *ctx, const struct piece *piece,
	const struct place *place, const struct gltf_skin *skin)
{
	const struct gltf_surface *surface = &piece->surface;
	struct eco_model *m = s->model;
	(void)ctx;
	m->triangles_in += surface->triangle_count;
	if (s->looks[surface->material].invisible) {
		m->dropped[ECO_DROP_TRANSPARENT] += surface->triangle_count;
		s->hidden += surface->triangle_count;
		return ECO_OK;
	}
	const char *node = eco_gltf_text(eco_gltf_item(s->doc, "nodes", place->node), "name"),
		*mesh = eco_gltf_text(eco_gltf_item(s->doc, "meshes", s->shapes[place->shape].mesh), "name");
	eco_model_add_part(m, node, strlen(node), mesh, strlen(mesh));
	add_vertices(s, surface, place, skin);
	for (uint32_t i = 0; i < surface->triangle_count; i++) {
		const uint32_t *v = &surface->index[(size_t)i * 3];
		for (size_t k = 0; k < 3; k++)
			m->index[(size_t)m->triangle_count * 3 + k] = v[k] != ECO_NONE
				? m->vertex_count + v[k] : ECO_NONE;
		m->part[m->triangle_count] = m->part_count - 1;
		m->material[m->triangle_count++] = triangle_material(s, piece, v);
	}
	m->vertex_count += surface->vertex_count;
	return ECO_OK;
}

/* ---- The file ---- */

static void tell(struct soup *s)
{
	size_t scenes = json_array_size(json_object_get(eco_gltf_json(s->doc), "scenes"));
	if (!eco_gltf_has_scene(s->doc))
		eco_note(s->notes, "%s: all of its nodes are read",
			scenes > 0 ? "its default scene is not there" : "no scene in it");
	else if (scenes > 1)
		eco_note(s->notes, "%zu scenes are in it: the default one is read, else the first", scenes);
	if (s->instances > 0)
		eco_note(s->notes, "%llu instances in it (EXT_mesh_gpu_instancing) make one plant",
			(unsigned long long)s->instances);
	if (s->counts.points > 0 || s->counts.lines > 0)
		eco_note(s->notes, "%llu points and %llu lines are left out: only triangles are drawn",
			(unsigned long long)s->counts.points, (unsigned long long)s->counts.lines);
	if (s->counts.shapeless > 0)
		eco_note(s->notes, "%llu primitives without positions are left out",
			(unsigned long long)s->counts.shapeless);
	if (s->counts.partial > 0)
		eco_note(s->notes, "%llu corners at the ends of lists of triangles make no triangle",
			(unsigned long long)s->counts.partial);
	if (s->counts.morphed > 0)
		eco_note(s->notes, "%llu morph targets of Draco meshes are not applied",
			(unsigned long long)s->counts.morphed);
	if (s->counts.faint > 0)
		eco_note(s->notes, "%llu vertices have colours with alpha below 0.5, which is not applied",
			(unsigned long long)s->counts.faint);
	eco_note_colors(s->notes, s->hidden, "baseColorFactor", s->averaged);
}

static enum eco_code prepare(struct soup *s)
{
	size_t meshes = json_array_size(json_object_get(eco_gltf_json(s->doc), "meshes"));
	size_t skins = json_array_size(json_object_get(eco_gltf_json(s->doc), "skins"));
	snprintf(s->frame->format, sizeof s->frame->format, "glTF");
	s->frame->unit_m = 1;
	s->frame->up = s->frame->convention = ECO_UP_Y;
	s->looks = gltf_looks_read(s->doc, &s->look_count);
	s->at_rest = malloc((meshes + 1) * sizeof *s->at_rest);
	s->skins = skins < ECO_NONE ? calloc(skins + 1, sizeof *s->skins) : NULL;
	if (!s->looks || !s->at_rest || !s->skins)
		return out_of_memory(s);
	memset(s->at_rest, 0xff, meshes * sizeof *s->at_rest);
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
	if (!code)
		code = choose_base(s);
	if (!code)
		code = gltf_materials_read(s->model, s->doc, s->looks, s->look_count, s->notes, s->error);
	if (code)
		return code;
	if (!take_memory(s))
		return out_of_memory(s);
	for (uint32_t i = 0; i < s->piece_count; i++)
		choose_whole(s, &s->pieces[i]);
	code = for_all(s, add_piece, NULL);
	tell(s);
	return code;
}

enum eco_code eco_gltf_read_document(struct eco_model *model, struct eco_model_frame *frame,
	struct eco_gltf *doc, uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	struct soup s = { .doc = doc, .model = model, .frame = frame, .notes = notes, .error = error,
		.triangles_max = triangles_max };
	enum eco_code code = read_soup(&s);
	eco_tints_end(&s.tints);
	for (uint32_t i = 0; i < s.piece_count; i++)
		gltf_surface_free(&s.pieces[i].surface);
	for (uint32_t i = 0; i < s.skin_count; i++)
		free(s.skins[i].matrix);
	free(s.pieces);
	free(s.shapes);
	free(s.places);
	free(s.skins);
	free(s.looks);
	free(s.at_rest);
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
