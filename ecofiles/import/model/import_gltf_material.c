/* Materials of glTF: one linear colour, one base colour texture, cut out or not; other shading is ignored.
 * A material may be described twice: metallic-roughness, and the older specular-glossiness extension,
 * which then wins, as it demands; its diffuse part is read.
 *
 * OPAQUE: alpha does not count. MASK: the cutoff is scaled to 0.5. BLEND: cut at 0.5. */
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"

#define PI 3.14159265358979323846

/* ---- JSON ---- */

static const json_t *old_style(const json_t *material)
{
	return eco_gltf_extension(material, "KHR_materials_pbrSpecularGlossiness");
}

static const json_t *texture_of(const json_t *material)
{
	const json_t *old = old_style(material);
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
	look->invisible = !opacity_shows(alpha, gain, rgba[3]);
	look->textured = texture_of(material) != NULL;
	read_transform(texture_of(material), look);
}

struct gltf_look *gltf_looks_read(const struct eco_gltf *doc, uint32_t count)
{
	struct gltf_look *looks = eco_alloc(count + 1u, sizeof *looks);
	for (uint32_t i = 0; i <= count; i++)
		read_look(eco_gltf_item(doc, "materials", i), &looks[i]);
	return looks;
}

/* uv' = offset + turned(scale * uv), v pointing down. */
void gltf_look_apply(const struct gltf_look *look, const double from[2], float to[2])
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
		eco_note(notes, "material %.63s: its texture has no picture of a kind that is read; it "
			"keeps one colour", to->name);
	eco_material_take_picture(to, images, &wanted, false);
}

void gltf_materials_read(struct eco_model *model, struct eco_gltf *doc, const struct gltf_look *looks,
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
