/* A glTF model becomes a soup. The scene is walked; each mesh in it is read once, from accessors or Draco streams,
 * and written out at each of its places, in double.
 *
 * Axes and unit are the format's: Y up, metres. A file that requires an extension unknown here is refused
 * by name: an error is better than a model that silently lacks its leaves. */
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"

/* ---- Required extensions ---- */

/* Extensions that are read, or that do not change a plant at rest; every KHR_materials_* only changes
 * shading, which is not computed here. */
static const char *const handled[] = { "KHR_draco_mesh_compression", "KHR_mesh_quantization",
	"EXT_meshopt_compression", "KHR_meshopt_compression", "EXT_mesh_gpu_instancing", "EXT_texture_webp",
	"KHR_texture_transform", "KHR_lights_punctual", "KHR_node_visibility", "KHR_animation_pointer",
	"KHR_xmp", "KHR_xmp_json_ld", "EXT_mesh_primitive_restart", "KHR_mesh_primitive_restart",
	"EXT_mesh_features", "EXT_instance_features", "EXT_structural_metadata", "EXT_lights_image_based",
	"EXT_lights_ies", "MSFT_lod", "FB_ngon_encoding", "GODOT_single_root" };

static enum eco_code check_required(const struct gltf_reader *r)
{
	const json_t *required = json_object_get(r->doc->root, "extensionsRequired");
	for (size_t i = 0; i < json_array_size(required); i++) {
		const char *name = json_string_value(json_array_get(required, i));
		bool read = name && strncmp(name, "KHR_materials_", 14) == 0;
		for (size_t k = 0; name && k < sizeof handled / sizeof *handled; k++)
			read |= strcmp(name, handled[k]) == 0;
		bool picture = name && (strcmp(name, "KHR_texture_basisu") == 0 || strcmp(name, "EXT_texture_avif") == 0);
		if (!read)
			return eco_fail(r->error, ECO_UNSUPPORTED,
				"%.200s: requires the glTF extension %.100s, which is not supported; export %s",
				r->doc->path, name ? name : "(not a name)", picture ? "with PNG, JPEG or WebP textures"
				: "without it");
	}
	return ECO_OK;
}

/* ---- Skins at rest: joints place a skinned mesh. The specification says to ignore its node's own place,
 * which is wrong by a factor of a hundred in files whose skeletons carry the scale or the axis ---- */

static enum eco_code read_skin(struct gltf_reader *r, uint32_t index)
{
	struct gltf_skin *skin = &r->skins[index];
	const json_t *json = eco_gltf_item(r->doc, "skins", index), *joints = json_object_get(json, "joints");
	size_t count = json_array_size(joints);
	struct eco_gltf_accessor inverse = { .bytes = NULL };
	enum eco_code code = !json_object_get(json, "inverseBindMatrices") ? ECO_OK : eco_gltf_accessor_open(r->doc,
		eco_gltf_index(json, "inverseBindMatrices"), 16, &inverse, r->error);
	skin->read = true;
	skin->matrix = eco_alloc(count, 16 * sizeof *skin->matrix);
	skin->count = (uint32_t)count;
	for (size_t i = 0; i < count && code == ECO_OK; i++) {
		json_int_t node = json_is_integer(json_array_get(joints, i))
			? json_integer_value(json_array_get(joints, i)) : -1;
		double *matrix = &skin->matrix[i * 16], bind[16];
		code = eco_gltf_node_matrix(r->doc, node >= 0 && node < ECO_NONE ? (uint32_t)node : ECO_NONE,
			matrix, r->error);
		if (code == ECO_OK && i < inverse.count) {
			eco_gltf_element(&inverse, i, bind);
			eco_gltf_multiply(matrix, matrix, bind);
		}
	}
	eco_gltf_accessor_close(&inverse);
	return code;
}

/* The skin of a node; NULL: none. */
static enum eco_code find_skin(struct gltf_reader *r, uint32_t node, const struct gltf_skin **skin)
{
	const json_t *json = eco_gltf_item(r->doc, "nodes", node);
	uint32_t index = eco_gltf_index(json, "skin");
	*skin = NULL;
	if (!json_object_get(json, "skin"))
		return ECO_OK;
	if (index >= r->skin_count)
		return eco_fail(r->error, ECO_DAMAGED, "%.300s: node %u names a skin that is not there",
			r->doc->path, node);
	*skin = &r->skins[index];
	return r->skins[index].read ? ECO_OK : read_skin(r, index);
}

/* Places a vertex in the world; false: no joint holds it. */
static bool skin_place(const struct gltf_skin *skin, const struct gltf_piece *p, uint32_t vertex, const double from[3],
	double out[3])
{
	double sum = 0, to[3] = { 0, 0, 0 };
	for (int set = 0; set < GLTF_JOINT_SETS && p->values[GLTF_JOINTS + set].there && p->values[GLTF_WEIGHTS + set].there; set++) {
		double joints[4] = { 0, 0, 0, 0 }, weights[4] = { 0, 0, 0, 0 }, place[3];
		if (!gltf_values(p, (enum gltf_attribute)(GLTF_JOINTS + set), vertex, joints)
				|| !gltf_values(p, (enum gltf_attribute)(GLTF_WEIGHTS + set), vertex, weights))
			continue;
		for (int i = 0; i < 4; i++) {
			double weight = isfinite(weights[i]) ? (double)(float)weights[i] : 0;
			if (!(weight > 0) || !(joints[i] >= 0 && joints[i] < skin->count))
				continue;
			eco_gltf_apply(&skin->matrix[(size_t)joints[i] * 16], from, place);
			for (int k = 0; k < 3; k++)
				to[k] += weight * place[k];
			sum += weight;
		}
	}
	for (int k = 0; k < 3; k++)
		out[k] = sum > 0 ? to[k] / sum : 0;
	return sum > 0;
}

/* ---- Places ---- */

static double largest_scale(const double m[16])
{
	double most = 0;
	for (int c = 0; c < 3; c++)
		most = fmax(most, m[c * 4] * m[c * 4] + m[c * 4 + 1] * m[c * 4 + 1]
			+ m[c * 4 + 2] * m[c * 4 + 2]);
	return sqrt(most);
}

/* Z up. */
static void add_vertex(struct gltf_reader *r, const struct gltf_piece *p, uint32_t vertex, const double world[16],
	const struct gltf_skin *skin)
{
	double values[4] = { 0, 0, 0, 0 }, at[3];
	float uv[2] = { 0, 0 }, rgb[3];
	gltf_values(p, GLTF_POSITION, vertex, values);
	const double local[3] = { (double)(float)values[0], (double)(float)values[1], (double)(float)values[2] };
	if (!skin || !skin_place(skin, p, vertex, local, at))
		eco_gltf_apply(world, local, at);
	if (gltf_values(p, GLTF_TEXCOORD, vertex, values))
		gltf_look_apply(&r->looks[p->material], values, uv);
	values[0] = values[1] = values[2] = 1;
	gltf_values(p, GLTF_COLOR, vertex, values);
	for (int k = 0; k < 3; k++)
		rgb[k] = isfinite(values[k]) ? (float)values[k] : 1;
	eco_soup_vertex(&r->soup, (const double[3]){ at[0], -at[2], at[1] }, uv, rgb);
}

static void add_piece(struct gltf_reader *r, const struct gltf_piece *p, const double world[16], const struct gltf_skin *skin)
{
	const uint32_t first = r->soup.vertex_count;
	if (!skin)
		r->soup.far = fmax(r->soup.far, p->far * largest_scale(world));
	for (uint32_t v = 0; v < p->vertex_count; v++)
		add_vertex(r, p, p->source[v], world, skin);
	eco_soup_mesh(&r->soup, p->material, p->values[GLTF_COLOR].there);
	for (uint32_t i = 0; i < p->triangle_count; i++) {
		uint32_t v[3];
		for (int k = 0; k < 3; k++) {
			uint32_t own = p->index[(size_t)i * 3 + (size_t)k];
			v[k] = own != ECO_NONE ? first + own : ECO_NONE;
		}
		eco_soup_triangle(&r->soup, v[0], v[1], v[2]);
	}
}

static enum eco_code place_mesh(struct gltf_reader *r, uint32_t number, uint32_t node, const double world[16])
{
	const struct gltf_mesh *mesh = &r->meshes[number];
	const char *node_name = eco_gltf_text(eco_gltf_item(r->doc, "nodes", node), "name"),
		*mesh_name = eco_gltf_text(eco_gltf_item(r->doc, "meshes", number), "name");
	const struct gltf_skin *skin;
	enum eco_code code = gltf_too_many(r, r->soup.triangle_count + mesh->triangles);
	if (!code)
		code = find_skin(r, node, &skin);
	for (uint32_t i = 0; i < mesh->count && !code; i++) {
		const struct gltf_piece *p = &r->pieces[mesh->first + i];
		if (!r->looks[p->material].invisible)
			eco_soup_part(&r->soup, node_name, strlen(node_name), mesh_name, strlen(mesh_name));
		add_piece(r, p, world, skin);
	}
	return code;
}

/* Places a mesh at each instance of EXT_mesh_gpu_instancing. */
static enum eco_code place_instances(struct gltf_reader *r, uint32_t mesh, uint32_t node, const json_t *attributes,
	const double world[16])
{
	static const struct { const char *name; uint32_t components; } kinds[] = { { "TRANSLATION", 3 },
		{ "ROTATION", 4 }, { "SCALE", 3 } };
	struct eco_gltf_accessor a[3] = { { .bytes = NULL } };
	uint64_t count = UINT64_MAX;
	enum eco_code code = ECO_OK;
	for (int k = 0; k < 3 && !code; k++) {
		if (!json_object_get(attributes, kinds[k].name))
			continue;
		code = eco_gltf_accessor_open(r->doc, eco_gltf_index(attributes, kinds[k].name), kinds[k].components,
			&a[k], r->error);
		if (!code && count != UINT64_MAX && count != a[k].count)
			code = eco_fail(r->error, ECO_DAMAGED, "%.300s: node %u: its instances have %llu and %llu "
				"places, turns or sizes", r->doc->path, node, (unsigned long long)count,
				(unsigned long long)a[k].count);
		count = a[k].count;
	}
	if (!code && count == UINT64_MAX)
		code = eco_fail(r->error, ECO_DAMAGED, "%.300s: node %u: instances without places, turns or sizes",
			r->doc->path, node);
	for (uint64_t i = 0; i < count && r->meshes[mesh].triangles > 0 && !code; i++) {
		double at[3][4] = { { 0 }, { 0, 0, 0, 1 }, { 1, 1, 1 } }, matrix[16];
		for (int k = 0; k < 3; k++)
			if (a[k].count > 0)
				eco_gltf_element(&a[k], i, at[k]);
		eco_gltf_compose(matrix, at[0], at[1], at[2]);
		eco_gltf_multiply(matrix, world, matrix);
		code = place_mesh(r, mesh, node, matrix);
	}
	r->instances += count;
	for (int k = 0; k < 3; k++)
		eco_gltf_accessor_close(&a[k]);
	return code;
}

static enum eco_code visit(void *ctx, uint32_t node, const double world[16])
{
	struct gltf_reader *r = ctx;
	const json_t *json = eco_gltf_item(r->doc, "nodes", node),
		*instanced = eco_gltf_extension(json, "EXT_mesh_gpu_instancing");
	uint32_t mesh = eco_gltf_index(json, "mesh");
	if (!json_object_get(json, "mesh"))
		return ECO_OK;
	enum eco_code code = gltf_mesh_read(r, mesh);
	if (!code && instanced)
		code = place_instances(r, mesh, node, json_object_get(instanced, "attributes"), world);
	else if (!code && r->meshes[mesh].triangles > 0)
		code = place_mesh(r, mesh, node, world);
	return code;
}

/* ---- The file ---- */

static void tell(struct gltf_reader *r)
{
	struct eco_notes *notes = r->soup.notes;
	const struct { uint64_t count; const char *are; } odd[] = {
		{ r->instances, "instances in it (EXT_mesh_gpu_instancing) make one plant" },
		{ r->points, "points are left out: only triangles are drawn" },
		{ r->lines, "lines are left out: only triangles are drawn" },
		{ r->shapeless, "primitives without positions are left out" },
		{ r->partial, "corners at the ends of lists of triangles make no triangle" },
		{ r->morphed, "meshes have morph targets at rest, which are not applied" },
		{ r->faint, "vertices have colours with alpha below 0.5, which is not applied" } };
	size_t scenes = json_array_size(json_object_get(r->doc->root, "scenes"));
	if (!eco_gltf_scene(r->doc))
		eco_note(notes, "%s: all of its nodes are read",
			scenes > 0 ? "its default scene is not there" : "no scene in it");
	else if (scenes > 1)
		eco_note(notes, "%zu scenes are in it: the default one is read, else the first", scenes);
	for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
		if (odd[i].count > 0)
			eco_note(notes, "%llu %s", (unsigned long long)odd[i].count, odd[i].are);
}

static enum eco_code check_totals(const struct gltf_reader *r)
{
	if (r->soup.triangle_count == 0 && r->points + r->lines > 0)
		return eco_fail(r->error, ECO_BAD_INPUT, "%.300s: no triangles in it, only %llu points and "
			"%llu lines; a point cloud has no surfaces: make a mesh of it first", r->doc->path,
			(unsigned long long)r->points, (unsigned long long)r->lines);
	return r->soup.triangle_count > 0 ? ECO_OK
		: eco_fail(r->error, ECO_BAD_INPUT, "%.300s: no triangles in its scene", r->doc->path);
}

static enum eco_code read_document(struct gltf_reader *r)
{
	size_t materials = json_array_size(json_object_get(r->doc->root, "materials"));
	enum eco_code code = check_required(r);
	if (!code && materials >= ECO_MODEL_MATERIALS_MAX - ECO_TINTS_MAX)
		code = eco_fail(r->error, ECO_TOO_LARGE, "%.300s: %zu materials are too many", r->doc->path, materials);
	if (code)
		return code;
	*r->soup.frame = (struct eco_model_frame){ .format = "glTF", .unit_m = 1, .up = ECO_UP_Y,
		.convention = ECO_UP_Y };
	r->look_count = (uint32_t)materials;
	r->looks = gltf_looks_read(r->doc, r->look_count);
	r->meshes = eco_alloc(json_array_size(json_object_get(r->doc->root, "meshes")), sizeof *r->meshes);
	r->skin_count = (uint32_t)json_array_size(json_object_get(r->doc->root, "skins"));
	r->skins = eco_alloc(r->skin_count, sizeof *r->skins);
	code = eco_gltf_walk(r->doc, visit, r, r->error);
	if (!code)
		code = check_totals(r);
	if (code)
		return code;
	gltf_materials_read(r->soup.model, r->doc, r->looks, r->look_count, r->soup.notes);
	tell(r);
	bool *invisible = eco_alloc(r->look_count + 1u, 1);
	for (uint32_t i = 0; i <= r->look_count; i++)
		invisible[i] = r->looks[i].invisible;
	r->soup.invisible = invisible;
	eco_soup_end(&r->soup, "baseColorFactor");
	free(invisible);
	return ECO_OK;
}

enum eco_code eco_gltf_read_model(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	struct gltf_reader r = { .error = error, .triangles_max = triangles_max,
		.soup = { .model = model, .frame = frame, .notes = notes, .linear = true } };
	enum eco_code code = eco_gltf_open(&r.doc, path, error);
	if (!code)
		code = read_document(&r);
	eco_soup_free(&r.soup);
	for (uint32_t i = 0; i < r.piece_count; i++)
		gltf_piece_free(&r.pieces[i]);
	for (uint32_t i = 0; i < r.skin_count; i++)
		free(r.skins[i].matrix);
	free(r.pieces);
	free(r.meshes);
	free(r.skins);
	free(r.looks);
	eco_gltf_close(r.doc);
	return code;
}
