/* assimp's materials: one colour, one base colour image, cut out or not; other shading is ignored. None of
 * these formats says whether alpha counts, so it does wherever there is some. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/assimp_module.h"

#include <assimp/material.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"

struct reader {
	const struct aiScene *scene;
	bool linear_colors;          /* Blender's materials are linear, except in PLY, which has none */
	struct eco_images images;
};

/* ---- Textures within the file ---- */

static enum eco_code decode_raw(struct eco_image *image, const struct aiTexture *texture,
	struct eco_error *error)
{
	uint64_t pixels = (uint64_t)texture->mWidth * texture->mHeight;
	if (pixels == 0 || pixels > ECO_PIXELS_MAX || !texture->pcData)
		return eco_fail(error, ECO_TOO_LARGE, "%llu pixels", (unsigned long long)pixels);
	image->rgba = eco_alloc(pixels, 4);
	for (uint64_t i = 0; i < pixels; i++) {
		const struct aiTexel *t = &texture->pcData[i];
		uint8_t rgba[4] = { t->r, t->g, t->b, t->a };
		memcpy(&image->rgba[i * 4], rgba, 4);
	}
	image->width = texture->mWidth;
	image->height = texture->mHeight;
	return ECO_OK;
}

/* "*3" is texture 3 of the scene; some readers give embedded textures file names instead. */
static const struct aiTexture *embedded_texture(const struct aiScene *scene, const char *name)
{
	char *end;
	unsigned long index;
	if (*name == '*') {
		index = strtoul(name + 1, &end, 10);
		return end != name + 1 && *end == 0 && index < scene->mNumTextures ? scene->mTextures[index]
			: NULL;
	}
	for (unsigned i = 0; i < scene->mNumTextures; i++)
		if (scene->mTextures[i]->mFilename.length > 0
				&& strcmp(scene->mTextures[i]->mFilename.data, name) == 0)
			return scene->mTextures[i];
	return NULL;
}

static bool embedded(void *ctx, const char *name, struct eco_image *image, enum eco_code *code,
	struct eco_error *error)
{
	const struct aiTexture *texture = embedded_texture(ctx, name);
	if (!texture)
		return false;
	*code = texture->mHeight != 0 ? decode_raw(image, texture, error)
		: eco_image_read_memory(image, texture->pcData, texture->mWidth, name, error);
	return true;
}

/* ---- Materials ---- */

static float number_of(const struct aiMaterial *from, const char *key, float otherwise)
{
	ai_real value = otherwise;

	if (aiGetMaterialFloatArray(from, key, 0, 0, &value, NULL) != AI_SUCCESS || !isfinite(value))
		return otherwise;
	return value;
}

/* The base colour's texture and its uv set. */
static char *texture_name(const struct aiMaterial *from, enum aiTextureType type, uint32_t *channel)
{
	struct aiString path;
	unsigned uv = 0;
	if (aiGetMaterialTexture(from, type, 0, &path, NULL, &uv, NULL, NULL, NULL, NULL) != AI_SUCCESS
			|| path.length == 0)
		return NULL;
	if (channel)
		*channel = uv;
	return eco_copy_text(path.data);
}

/* Whether the colour is linear light: so physically based materials have it. */
static bool color_of(const struct aiMaterial *from, struct aiColor4D *color)
{
	*color = (struct aiColor4D){ 0.6f, 0.6f, 0.6f, 1 };
	bool base = aiGetMaterialColor(from, "$clr.base", 0, 0, color) == AI_SUCCESS;
	if (!base)
		aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, color);
	color->a = number_of(from, "$mat.opacity", 1);
	return base;
}

bool assimp_has_picture(const struct aiMaterial *material)
{
	return aiGetMaterialTextureCount(material, aiTextureType_BASE_COLOR) > 0
		|| aiGetMaterialTextureCount(material, aiTextureType_DIFFUSE) > 0;
}

static uint8_t byte_of(bool linear, float value)
{
	return !linear ? eco_byte_from_share(value) : eco_srgb_from_linear(isfinite(value) ? value : 0.6);
}

static void name_of(const struct aiMaterial *from, char name[64])
{
	struct aiString text;
	if (aiGetMaterialString(from, AI_MATKEY_NAME, &text) != AI_SUCCESS)
		text.data[0] = 0;
	snprintf(name, 64, "%.63s", text.data);
}

/* The material's own alpha, without its image's. */
static void judge_alpha(const struct reader *r, uint32_t index, bool *invisible)
{
	struct aiColor4D color;
	color_of(r->scene->mMaterials[index], &color);
	*invisible = !eco_alpha_shows(color.a);
}

/* False if the material names a picture that cannot be read. */
static bool read_image(struct reader *r, const struct aiMaterial *from, struct eco_material *to,
	float opacity, uint32_t *channel)
{
	struct eco_image_wanted wanted = { .gain = 1 };
	char *texture = texture_name(from, aiTextureType_BASE_COLOR, channel), *mask;
	if (!texture)
		texture = texture_name(from, aiTextureType_DIFFUSE, channel);
	if (!texture)
		return true;
	mask = texture_name(from, aiTextureType_OPACITY, NULL);
	wanted.texture = texture;
	wanted.opacity = mask && strcmp(mask, texture) != 0 ? mask : NULL;
	if (eco_alpha_shows(opacity))
		wanted.gain = opacity;
	to->image = eco_images_get(&r->images, &wanted, &to->cutout);
	free(texture);
	free(mask);
	return to->image != ECO_NONE;
}

static void read_material(struct reader *r, uint32_t index, uint32_t *channel, bool invisible)
{
	const struct aiMaterial *from = r->scene->mMaterials[index];
	struct eco_material *to = &r->images.model->materials[index];
	struct aiColor4D color;
	name_of(from, to->name);
	bool linear = color_of(from, &color) || r->linear_colors;
	bool lost = !invisible && !read_image(r, from, to, color.a, channel);
	to->rgb[0] = byte_of(linear, color.r);
	to->rgb[1] = byte_of(linear, color.g);
	to->rgb[2] = byte_of(linear, color.b);
	/* a map replaces the colour, whatever exporters leave there (0.8, 0.64, 0) */
	if (to->image != ECO_NONE)
		memset(to->rgb, 255, 3);
	if (lost)
		eco_material_lost_picture(to);
}

void assimp_materials(struct eco_model *model, const struct aiScene *scene, const char *path, uint32_t *channel,
	bool *invisible, struct eco_notes *notes)
{
	struct reader r = { .scene = scene, .linear_colors = !eco_path_ends_with(path, ".ply")
		&& eco_file_head_has(path, 4096, "Blender"), .images = { .model = model, .path = path,
		.notes = notes, .embedded = embedded, .ctx = (void *)scene } };

	model->materials = eco_alloc((size_t)scene->mNumMaterials + 1, sizeof *model->materials);
	eco_images_start(&r.images);
	model->material_count = scene->mNumMaterials;
	for (uint32_t i = 0; i < scene->mNumMaterials; i++) {
		model->materials[i].image = ECO_NONE;
		judge_alpha(&r, i, &invisible[i]);
	}
	eco_model_see_invisible(invisible, scene->mNumMaterials, notes);
	for (uint32_t i = 0; i < scene->mNumMaterials; i++)
		read_material(&r, i, &channel[i], invisible[i]);
	eco_images_end(&r.images);
}
