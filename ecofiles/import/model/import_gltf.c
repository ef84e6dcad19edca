/* A glTF model becomes a soup. The scene is walked; each mesh in it is read once, from accessors or Draco
 * streams, and written out at each of its places, in double.
 *
 * Axes and unit are the format's: Y up, metres. A file that requires an extension unknown here is refused by
 * name: an error is better than a model that silently lacks its leaves. Longer than 600 lines: one walk fills one soup. */
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/image.h"

/* ---- Materials ----
 * One linear colour, one base colour texture, cut out or not; other shading is ignored.
 * A material may be described twice: metallic-roughness, and the older specular-glossiness extension,
 * which then wins, as it demands; its diffuse part is read.
 *
 * OPAQUE: alpha does not count. MASK: the cutoff is scaled to 0.5. BLEND: cut at 0.5, or, where that
 * leaves little of a soft picture, at half of its largest alpha (import_material.c). */

#define PI 3.14159265358979323846

static const json_t *old_style(const json_t *material)
{
	return eco_gltf_extension(material, "KHR_materials_pbrSpecularGlossiness");
}

#define BLACK 0.02               /* linear light */

static bool is_black(const double rgb[3]) { return rgb[0] < BLACK && rgb[1] < BLACK && rgb[2] < BLACK; }

/* A material without light of its own under a colour that it emits: shadeless models have it so. */
static bool is_emissive(const json_t *material)
{
	double base[4] = { 1, 1, 1, 1 }, emitted[3] = { 0, 0, 0 };
	eco_gltf_numbers(json_object_get(material, "pbrMetallicRoughness"), "baseColorFactor", base, 4);
	return !old_style(material) && is_black(base) && eco_gltf_numbers(material, "emissiveFactor", emitted, 3)
		&& emitted[0] + emitted[1] + emitted[2] > 0;
}

static const json_t *texture_of(const json_t *material)
{
	const json_t *old = old_style(material);
	if (is_emissive(material))
		return json_object_get(material, "emissiveTexture");
	return old ? json_object_get(old, "diffuseTexture")
		: json_object_get(json_object_get(material, "pbrMetallicRoughness"), "baseColorTexture");
}

static void factor_of(const json_t *material, double rgba[4])
{
	const json_t *old = old_style(material);
	double read[4] = { 1, 1, 1, 1 };
	if (!(old ? eco_gltf_numbers(old, "diffuseFactor", read, 4)
		: eco_gltf_numbers(json_object_get(material, "pbrMetallicRoughness"), "baseColorFactor", read,
		4)))
		read[0] = read[1] = read[2] = read[3] = 1;
	if (is_emissive(material))
		eco_gltf_numbers(material, "emissiveFactor", read, 3);
	memcpy(rgba, read, sizeof read);
}

static enum eco_alpha alpha_of(const json_t *material, float *gain)
{
	const char *mode = eco_gltf_text(material, "alphaMode");
	double cutoff = eco_gltf_number(material, "alphaCutoff", 0.5);
	*gain = 1;
	if (strcmp(mode, "BLEND") == 0)
		return ECO_ALPHA_BY_IMAGE;
	if (strcmp(mode, "MASK") != 0 || cutoff <= 0)        /* no alpha is below 0 */
		return ECO_ALPHA_OPAQUE;
	*gain = (float)(0.5 / fmax(cutoff, 1e-6));
	return ECO_ALPHA_MASK;
}

static bool opacity_shows(enum eco_alpha alpha, float gain, double opacity)
{
	return alpha == ECO_ALPHA_OPAQUE || eco_alpha_shows((double)gain * opacity);
}

/* ---- Looks ---- */

static void read_transform(const json_t *texture, struct gltf_look *look)
{
	const json_t *from = eco_gltf_extension(texture, "KHR_texture_transform");
	double radians = eco_gltf_number(from, "rotation", 0);
	look->uv.scale[0] = look->uv.scale[1] = 1;
	eco_gltf_numbers(from, "offset", look->uv.offset, 2);
	eco_gltf_numbers(from, "scale", look->uv.scale, 2);
	for (int k = 0; k < 2; k++) {
		if (fabs(look->uv.offset[k]) > 65536)
			look->uv.offset[k] = 0;
		if (fabs(look->uv.scale[k]) > 65536)
			look->uv.scale[k] = 1;
	}
	eco_angle16_sincos(eco_angle16_from_deg(fabs(radians) <= 1e6 ? radians * (180 / PI) : 0),
		&look->uv.sine, &look->uv.cosine);
	look->uv_set = eco_gltf_index(from, "texCoord");
	if (look->uv_set == ECO_NONE)
		look->uv_set = eco_gltf_index(texture, "texCoord");
	if (look->uv_set == ECO_NONE)
		look->uv_set = 0;
}

static void read_look(const json_t *material, struct gltf_look *look)
{
	double rgba[4];
	float gain;
	enum eco_alpha alpha = alpha_of(material, &gain);
	factor_of(material, rgba);
	look->textured = texture_of(material) != NULL;
	look->invisible = !opacity_shows(alpha, gain, rgba[3]);
	read_transform(texture_of(material), look);
}

static struct gltf_look *read_looks(const struct eco_gltf *doc, uint32_t count)
{
	struct gltf_look *looks = eco_alloc(count + 1u, sizeof *looks);
	for (uint32_t i = 0; i <= count; i++)
		read_look(eco_gltf_item(doc, "materials", i), &looks[i]);
	return looks;
}

/* uv' = offset + turned(scale * uv), v pointing down. */
static void look_apply(const struct gltf_look *look, const double from[2], float to[2])
{
	double x = from[0] * look->uv.scale[0], y = from[1] * look->uv.scale[1];
	double u = look->uv.offset[0] + look->uv.cosine * x + look->uv.sine * y,
		v = look->uv.offset[1] - look->uv.sine * x + look->uv.cosine * y;

	to[0] = fabs(u) <= 65536 ? (float)u : 0;
	to[1] = fabs(v) <= 65536 ? (float)v : 0;
}

/* ---- Images ---- */

/* The image's name for notes, by which the callback below finds it again: "images[3] bark". */
static bool image_name(const struct eco_gltf *doc, uint32_t index, char *name, size_t size)
{
	const json_t *image = eco_gltf_item(doc, "images", index);
	const char *uri = eco_gltf_text(image, "uri");
	if (!image)
		return false;
	if (*uri != 0 && strncasecmp(uri, "data:", 5) != 0)
		return snprintf(name, size, "%s", uri) < (int)size;
	snprintf(name, size, "images[%u] %.60s", index, eco_gltf_text(image, "name"));
	return true;
}

static enum eco_code decode_data_uri(const char *uri, const char *name, struct eco_image *image,
	struct eco_error *error)
{
	bool is_data;
	uint8_t *bytes = NULL;
	size_t size = 0;
	enum eco_code code = eco_gltf_data_uri(uri, &is_data, &bytes, &size, error);
	if (!code)
		code = eco_image_read_memory(image, bytes, size, name, error);
	free(bytes);
	return code;
}

static bool embedded(void *ctx, const char *name, struct eco_image *image, enum eco_code *code,
	struct eco_error *error)
{
	struct eco_gltf *doc = ctx;
	const uint8_t *bytes;
	const char *uri;
	unsigned index;
	size_t size;
	if (sscanf(name, "images[%u] ", &index) != 1)
		return false;
	const json_t *json = eco_gltf_item(doc, "images", index);
	uri = eco_gltf_text(json, "uri");
	if (!json || (*uri != 0 && strncasecmp(uri, "data:", 5) != 0))
		return false;
	if (*uri != 0) {
		*code = decode_data_uri(uri, name, image, error);
		return true;
	}
	*code = eco_gltf_view(doc, eco_gltf_index(json, "bufferView"), &bytes, &size, error);
	if (*code == ECO_OK)
		*code = eco_image_read_memory(image, bytes, size, name, error);
	return true;
}

/* The picture of a texture: the plain one, else the WebP one. */
static uint32_t source_of(const struct eco_gltf *doc, const json_t *texture)
{
	const json_t *json = eco_gltf_item(doc, "textures", eco_gltf_whole(texture, "index", UINT64_MAX));
	uint32_t source = eco_gltf_index(json, "source");
	return source != ECO_NONE ? source : eco_gltf_index(eco_gltf_extension(json, "EXT_texture_webp"),
		"source");
}

/* Under a picture that is emitted it shows nothing. */
static bool is_black_picture(const struct eco_image *image)
{
	for (size_t i = 0; i < (size_t)image->width * image->height; i++)
		if (image->rgba[4 * i] + image->rgba[4 * i + 1] + image->rgba[4 * i + 2] > 0)
			return false;
	return true;
}

static void read_material(struct eco_images *images, const struct eco_gltf *doc, uint32_t index,
	const struct gltf_look *look, struct eco_notes *notes)
{
	const json_t *material = eco_gltf_item(doc, "materials", index);
	struct eco_material *to = &images->model->materials[index];
	struct eco_image_wanted wanted = { .texture = NULL };
	double rgba[4];
	char name[2048];
	snprintf(to->name, sizeof to->name, "%.63s", eco_gltf_text(material, "name"));
	factor_of(material, rgba);
	for (int k = 0; k < 3; k++)
		to->rgb[k] = eco_srgb_from_linear(rgba[k]);
	if (!look->used || !look->textured || look->invisible)
		return;
	wanted.alpha = alpha_of(material, &wanted.gain);
	if (wanted.alpha != ECO_ALPHA_OPAQUE)
		wanted.gain *= (float)rgba[3];
	if (image_name(doc, source_of(doc, texture_of(material)), name, sizeof name))
		wanted.texture = name;
	else
		eco_note(notes, "material %.63s: its texture has no picture in a known format; it keeps "
			"one colour", to->name);
	eco_material_take_picture(to, images, &wanted, false);
	const json_t *emitted = json_object_get(material, "emissiveTexture");
	if (emitted && to->image != ECO_NONE && is_black_picture(&images->model->images[to->image])
			&& image_name(doc, source_of(doc, emitted), name, sizeof name))
		eco_material_take_picture(to, images, &wanted, false);
}

static void read_materials(struct eco_model *model, struct eco_gltf *doc, const struct gltf_look *looks,
	uint32_t count, struct eco_notes *notes)
{
	struct eco_images images = { .model = model, .path = doc->path, .notes = notes,
		.embedded = embedded, .ctx = doc };
	uint32_t all = count + looks[count].used;
	model->materials = eco_alloc((size_t)all + 1, sizeof *model->materials);
	eco_images_start(&images);
	model->material_count = all;
	for (uint32_t i = 0; i < all; i++)
		model->materials[i].image = ECO_NONE;
	for (uint32_t i = 0; i < all; i++)
		read_material(&images, doc, i, &looks[i], notes);
	if (all > count)                     /* for primitives without a material */
		model->materials[count].colourless = true;
	eco_images_end(&images);
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

static enum eco_code check_required(const struct gltf_reader *r)
{
	const json_t *required = json_object_get(r->doc->root, "extensionsRequired");
	for (size_t i = 0; i < json_array_size(required); i++) {
		const char *name = json_string_value(json_array_get(required, i));
		bool read = name && strncmp(name, "KHR_materials_", 14) == 0;
		for (size_t k = 0; name && k < sizeof handled / sizeof *handled; k++)
			read |= strcmp(name, handled[k]) == 0;
		bool picture = name && (strcmp(name, "KHR_texture_basisu") == 0 || strcmp(name,
			"EXT_texture_avif") == 0);
		if (!read)
			return eco_fail(r->error, ECO_UNSUPPORTED,
				"%.200s: requires the glTF extension %.100s, which is not supported; export %s",
				r->doc->path, name ? name : "(not a name)", picture
				? "with PNG, JPEG or WebP textures"
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
	enum eco_code code = !json_object_get(json, "inverseBindMatrices") ? ECO_OK
		: eco_gltf_accessor_open(r->doc,
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
static bool skin_place(const struct gltf_skin *skin, const struct gltf_piece *p, uint32_t vertex,
	const double from[3],
	double out[3])
{
	double sum = 0, to[3] = { 0, 0, 0 };
	for (int set = 0; set < GLTF_JOINT_SETS && p->values[GLTF_JOINTS + set].there
		&& p->values[GLTF_WEIGHTS + set].there; set++) {
		double joints[4] = { 0, 0, 0, 0 }, weights[4] = { 0, 0, 0, 0 }, place[3];
		if (!gltf_values(p, (enum gltf_attribute)(GLTF_JOINTS + set), vertex, joints)
				|| !gltf_values(p, (enum gltf_attribute)(GLTF_WEIGHTS + set), vertex,
					weights))
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
static void add_vertex(struct gltf_reader *r, const struct gltf_piece *p, uint32_t vertex,
	const double world[16],
	const struct gltf_skin *skin)
{
	double values[4] = { 0, 0, 0, 0 }, at[3];
	float uv[2] = { 0, 0 }, rgb[3];
	gltf_values(p, GLTF_POSITION, vertex, values);
	const double local[3] = { (double)(float)values[0], (double)(float)values[1],
		(double)(float)values[2] };
	if (!skin || !skin_place(skin, p, vertex, local, at))
		eco_gltf_apply(world, local, at);
	if (gltf_values(p, GLTF_TEXCOORD, vertex, values))
		look_apply(&r->looks[p->material], values, uv);
	values[0] = values[1] = values[2] = 1;
	gltf_values(p, GLTF_COLOR, vertex, values);
	for (int k = 0; k < 3; k++)
		rgb[k] = isfinite(values[k]) ? (float)values[k] : 1;
	eco_soup_vertex(&r->soup, (const double[3]){ at[0], -at[2], at[1] }, uv, rgb);
}

#define WEIGHT_RANGE 0.3         /* linear light: from the least to the largest weight */
#define WEIGHT_LOW 0.1           /* the mean of each vertex's darkest primary */
#define WEIGHT_CHROMA 0.2        /* the mean between its primaries: shades have none */
#define WEIGHT_DARK 0.5          /* tints are brighter */

/* Whether vertex colours beside a picture are dark, differ, and are no shades of grey: games keep there how
 * far wind moves a leaf. Other colours tint the picture. */
static bool are_weights(const struct gltf_reader *r, const struct gltf_piece *p)
{
	double least[3] = { INFINITY, INFINITY, INFINITY }, most[3] = { 0, 0, 0 }, low = 0, chroma = 0, bright = 0,
	       range = 0;
	if (!p->values[GLTF_COLOR].there || !r->looks[p->material].textured)
		return false;
	for (uint32_t v = 0; v < p->vertex_count; v++) {
		double values[4] = { 0, 0, 0, 0 };
		gltf_values(p, GLTF_COLOR, p->source[v], values);
		double dark = fmin(fmin(values[0], values[1]), values[2]), light = fmax(fmax(values[0], values[1]), values[2]);
		low += dark / p->vertex_count;
		chroma += (light - dark) / p->vertex_count;
		bright += (values[0] + values[1] + values[2]) / 3 / p->vertex_count;
		for (int k = 0; k < 3; k++) {
			least[k] = fmin(least[k], values[k]);
			most[k] = fmax(most[k], values[k]);
			range = fmax(range, most[k] - least[k]);
		}
	}
	return range > WEIGHT_RANGE && chroma > (low < WEIGHT_LOW ? WEIGHT_CHROMA / 2 : WEIGHT_CHROMA)
		&& bright < WEIGHT_DARK;
}

static void add_piece(struct gltf_reader *r, const struct gltf_piece *p, const double world[16],
	const struct gltf_skin *skin)
{
	const uint32_t first = r->soup.vertex_count;
	if (!skin)
		r->soup.far = fmax(r->soup.far, p->far * largest_scale(world));
	for (uint32_t v = 0; v < p->vertex_count; v++)
		add_vertex(r, p, p->source[v], world, skin);
	bool weights = are_weights(r, p);
	r->weighted += weights;
	eco_soup_mesh(&r->soup, p->material, p->values[GLTF_COLOR].there && !weights);
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
	ECO_PASS(gltf_too_many(r, r->soup.triangle_count + mesh->triangles));
	ECO_PASS(find_skin(r, node, &skin));
	for (uint32_t i = 0; i < mesh->count; i++) {
		const struct gltf_piece *p = &r->pieces[mesh->first + i];
		if (!r->looks[p->material].invisible)
			eco_soup_part(&r->soup, node_name, strlen(node_name), mesh_name, strlen(mesh_name));
		add_piece(r, p, world, skin);
	}
	return ECO_OK;
}

/* Places a mesh at each instance of EXT_mesh_gpu_instancing. */
static enum eco_code place_instances(struct gltf_reader *r, uint32_t mesh, uint32_t node,
	const json_t *attributes,
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
		code = eco_gltf_accessor_open(r->doc, eco_gltf_index(attributes, kinds[k].name),
			kinds[k].components,
			&a[k], r->error);
		if (!code && count != UINT64_MAX && count != a[k].count)
			code = eco_fail(r->error, ECO_DAMAGED,
				"%.300s: node %u: its instances have %llu and %llu "
				"places, turns or sizes", r->doc->path, node, (unsigned long long)count,
				(unsigned long long)a[k].count);
		count = a[k].count;
	}
	if (!code && count == UINT64_MAX)
		code = eco_fail(r->error, ECO_DAMAGED,
			"%.300s: node %u: instances without places, turns or sizes",
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
		{ r->weighted, "meshes have dark vertex colours that differ beside a picture: they are taken for "
			"weights of wind, not for colours" },
		{ r->doc->coarser, "nodes are coarser levels of others (MSFT_lod): they are left out" },
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
		code = eco_fail(r->error, ECO_TOO_LARGE, "%.300s: %zu materials are too many", r->doc->path,
			materials);
	if (code)
		return code;
	*r->soup.frame = (struct eco_model_frame){ .format = "glTF", .unit_m = 1, .up = ECO_UP_Y,
		.convention = ECO_UP_Y };
	r->look_count = (uint32_t)materials;
	r->looks = read_looks(r->doc, r->look_count);
	r->meshes = eco_alloc(json_array_size(json_object_get(r->doc->root, "meshes")), sizeof *r->meshes);
	r->skin_count = (uint32_t)json_array_size(json_object_get(r->doc->root, "skins"));
	r->skins = eco_alloc(r->skin_count, sizeof *r->skins);
	code = eco_gltf_walk(r->doc, visit, r, r->error);
	if (!code)
		code = check_totals(r);
	if (code)
		return code;
	read_materials(r->soup.model, r->doc, r->looks, r->look_count, r->soup.notes);
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
	eco_free(r.pieces, r.meshes, r.skins, r.looks);
	eco_gltf_close(r.doc);
	return code;
}
