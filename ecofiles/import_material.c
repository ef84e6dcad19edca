/* Materials and their images: one colour, one base colour image, cut out or not. All shading beyond that is left behind.
 *
 * Alpha: a glTF material says OPAQUE (alpha does not count), MASK with a cutoff, or BLEND; other formats count alpha wherever there
 * is some. Cutoff and the material's own alpha go into the texels, so that 128 is the threshold everywhere after this. Lists of
 * triangles say which image they have, not whether its alpha counts: an image that is not cut out is 255 all over, and a texture
 * that is used both ways becomes two images. */
#include "ecofiles/import_model.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/image.h"

#define ALPHA_SLACK 1e-3          /* alpha equal to the cutoff is opaque, however the two were rounded */
#define ALL_PIXELS_MAX ((uint64_t)1 << 28)

enum alpha { ALPHA_BY_IMAGE, ALPHA_OPAQUE, ALPHA_MASK };

struct image_key {               /* one decoded image per key */
	char *texture, *opacity;     /* as the material names them; opacity NULL: none */
	enum alpha alpha;
	float gain;                  /* alpha is multiplied by this */
	bool cutout;
};

struct reader {
	struct eco_model *model;
	const struct aiScene *scene;
	const struct eco_model_file *file;
	struct image_key *keys;      /* per image of the model */
	uint64_t pixels;
	struct eco_notes *notes;
};

uint8_t eco_srgb_from_linear(double linear)
{
	double s = linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(linear, 1 / 2.4) - 0.055;

	return s > 0 ? s < 1 ? (uint8_t)(s * 255 + 0.5) : 255 : 0;
}

double eco_linear_from_srgb(uint8_t srgb)
{
	double s = srgb / 255.0;

	return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

/* ---- Finding and decoding ---- */

/* Percent-escapes undone, backslashes turned: what exporters on other systems meant. */
static void plain_path(char *text)
{
	char *to = text;

	for (char *from = text; *from != 0; from++) {
		unsigned code;

		if (*from == '%' && sscanf(from + 1, "%2x", &code) == 1 && code >= 0x20 && from[1] != 0 && from[2] != 0) {
			*to++ = (char)code;
			from += 2;
		} else {
			*to++ = *from == '\\' ? '/' : *from;
		}
	}
	*to = 0;
}

/* Beside the model: as named if that is relative, else by its last part; false if neither is there. */
static bool find_file(const char *model, const char *name, char *path, size_t size)
{
	const char *slash = strrchr(model, '/');
	int folder = slash != NULL ? (int)(slash - model) + 1 : 0;
	char plain[1024];
	const char *last;

	if (snprintf(plain, sizeof plain, "%s", name) >= (int)sizeof plain)
		return false;
	plain_path(plain);
	last = strrchr(plain, '/');
	last = last != NULL ? last + 1 : plain;
	if (*plain != '/' && strchr(plain, ':') == NULL
		&& snprintf(path, size, "%.*s%s", folder, model, plain) < (int)size && access(path, R_OK) == 0)
		return true;
	return snprintf(path, size, "%.*s%s", folder, model, last) < (int)size && access(path, R_OK) == 0;
}

static enum eco_code decode_raw(struct eco_image *image, const struct aiTexture *texture, struct eco_error *error)
{
	uint64_t pixels = (uint64_t)texture->mWidth * texture->mHeight;

	if (pixels == 0 || pixels > ECO_PIXELS_MAX || texture->pcData == NULL)
		return eco_fail(error, ECO_TOO_LARGE, "%llu pixels", (unsigned long long)pixels);
	image->rgba = malloc(pixels * 4);
	if (image->rgba == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
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
		return end != name + 1 && *end == 0 && index < scene->mNumTextures ? scene->mTextures[index] : NULL;
	}
	for (unsigned i = 0; i < scene->mNumTextures; i++)
		if (scene->mTextures[i]->mFilename.length > 0 && strcmp(scene->mTextures[i]->mFilename.data, name) == 0)
			return scene->mTextures[i];
	return NULL;
}

static enum eco_code decode(struct reader *r, struct eco_image *image, const char *name, struct eco_error *error)
{
	const struct aiTexture *embedded = embedded_texture(r->scene, name);
	char path[4096];

	if (embedded != NULL && embedded->mHeight != 0)
		return decode_raw(image, embedded, error);
	if (embedded != NULL)
		return eco_image_read_memory(image, embedded->pcData, embedded->mWidth, name, error);
	if (!find_file(r->file->path, name, path, sizeof path))
		return eco_fail(error, ECO_NOT_FOUND, "no such file beside the model");
	return eco_image_read(image, path, error);
}

/* ---- Alpha ---- */

/* A separate opacity map: its own alpha where it has some, else its brightness; nearest texel. */
static void merge_opacity(struct eco_image *image, const struct eco_image *opacity)
{
	bool own = false;

	for (size_t i = 0; i < (size_t)opacity->width * opacity->height && !own; i++)
		own = opacity->rgba[i * 4 + 3] != 255;
	for (uint32_t y = 0; y < image->height; y++)
		for (uint32_t x = 0; x < image->width; x++) {
			uint32_t ox = (uint32_t)((uint64_t)x * opacity->width / image->width);
			uint32_t oy = (uint32_t)((uint64_t)y * opacity->height / image->height);
			const uint8_t *o = &opacity->rgba[((size_t)oy * opacity->width + ox) * 4];

			image->rgba[((size_t)y * image->width + x) * 4 + 3] = own ? o[3] : (uint8_t)((o[0] + o[1] + o[2]) / 3);
		}
}

/* Applies the key's alpha rule; returns whether any texel is cut out. Where none is, alpha is 255. */
static bool apply_alpha(struct eco_image *image, const struct image_key *key)
{
	size_t count = (size_t)image->width * image->height;
	uint8_t table[256];
	bool cutout = false;

	for (int i = 0; i < 256; i++) {
		double alpha = i * (double)key->gain + ALPHA_SLACK;

		table[i] = key->alpha == ALPHA_OPAQUE ? 255 : alpha < 255 ? (uint8_t)(alpha + 0.5) : 255;
	}
	for (size_t i = 0; i < count && !cutout; i++)
		cutout = table[image->rgba[i * 4 + 3]] < 128;
	for (size_t i = 0; i < count; i++)
		image->rgba[i * 4 + 3] = cutout ? table[image->rgba[i * 4 + 3]] : 255;
	return cutout;
}

/* ---- Images ---- */

static bool same_key(const struct image_key *a, const struct image_key *b)
{
	return strcmp(a->texture, b->texture) == 0 && a->alpha == b->alpha && a->gain == b->gain
		&& (a->opacity == NULL) == (b->opacity == NULL) && (a->opacity == NULL || strcmp(a->opacity, b->opacity) == 0);
}

static bool load_image(struct reader *r, struct image_key *key, struct eco_image *image)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_image opacity = { .rgba = NULL };

	if (decode(r, image, key->texture, &error) != ECO_OK) {
		eco_note(r->notes, "texture %.200s: %.300s; its material keeps one colour", key->texture, error.text);
		return false;
	}
	if (key->opacity != NULL) {
		if (decode(r, &opacity, key->opacity, &error) == ECO_OK)
			merge_opacity(image, &opacity);
		else
			eco_note(r->notes, "opacity map %.200s: %.300s; it is not applied", key->opacity, error.text);
		eco_image_free(&opacity);
	}
	r->pixels += (uint64_t)image->width * image->height;
	if (r->pixels > ALL_PIXELS_MAX) {
		eco_note(r->notes, "texture %.200s: the images have more than %llu pixels together; its material keeps one colour", key->texture,
			(unsigned long long)ALL_PIXELS_MAX);
		eco_image_free(image);
		return false;
	}
	key->cutout = apply_alpha(image, key);
	return true;
}

/* Index of the image for `key` (takes it), ECO_NONE where it cannot be had; a failure is remembered too (no rgba). */
static uint32_t image_for(struct reader *r, struct image_key *key)
{
	struct eco_model *m = r->model;
	uint32_t i = 0;

	while (i < m->image_count && !same_key(&r->keys[i], key))
		i++;
	if (i < m->image_count || m->image_count == ECO_MODEL_IMAGES_MAX) {
		free(key->texture);
		free(key->opacity);
	} else {
		r->keys[m->image_count++] = *key;
		load_image(r, &r->keys[i], &m->images[i]);
	}
	return i < m->image_count && m->images[i].rgba != NULL ? i : ECO_NONE;
}

/* Removes images that could not be had. */
static void drop_empty_images(struct reader *r)
{
	struct eco_model *m = r->model;
	uint32_t kept = 0;

	for (uint32_t i = 0; i < m->image_count; i++) {
		if (m->images[i].rgba == NULL)
			continue;
		for (uint32_t j = 0; j < m->material_count; j++)
			if (m->materials[j].image == i)
				m->materials[j].image = kept;
		m->images[kept++] = m->images[i];
	}
	m->image_count = kept;
}

/* ---- Materials ---- */

static float number_of(const struct aiMaterial *from, const char *key, float otherwise)
{
	ai_real value = otherwise;

	if (aiGetMaterialFloatArray(from, key, 0, 0, &value, NULL) != AI_SUCCESS || !isfinite(value))
		return otherwise;
	return value;
}

static enum alpha alpha_mode(const struct reader *r, const struct aiMaterial *from, float *gain)
{
	struct aiString mode;

	if (!r->file->gltf)
		return ALPHA_BY_IMAGE;
	if (aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) != AI_SUCCESS || strcmp(mode.data, "OPAQUE") == 0)
		return ALPHA_OPAQUE;
	if (strcmp(mode.data, "MASK") == 0) {
		float cutoff = number_of(from, "$mat.gltf.alphaCutoff", 0.5f);

		if (cutoff <= 0)             /* nothing is below it */
			return ALPHA_OPAQUE;
		*gain = 0.5f / fmaxf(cutoff, 1e-6f);
		return ALPHA_MASK;
	}
	return ALPHA_BY_IMAGE;
}

/* The texture named for the base colour and its uv set. */
static char *texture_name(const struct aiMaterial *from, enum aiTextureType type, uint32_t *channel)
{
	struct aiString path;
	unsigned uv = 0;
	int coordinate = 0;

	if (aiGetMaterialTexture(from, type, 0, &path, NULL, &uv, NULL, NULL, NULL, NULL) != AI_SUCCESS || path.length == 0)
		return NULL;
	if (channel != NULL) {
		if (uv == 0 && aiGetMaterialIntegerArray(from, "$tex.file.texCoord", type, 0, &coordinate, NULL) == AI_SUCCESS && coordinate > 0)
			uv = (unsigned)coordinate;
		*channel = uv;
	}
	return strdup(path.data);
}

static void color_of(const struct reader *r, const struct aiMaterial *from, struct aiColor4D *color)
{
	*color = (struct aiColor4D){ 0.6f, 0.6f, 0.6f, 1 };
	if (aiGetMaterialColor(from, "$clr.base", 0, 0, color) != AI_SUCCESS)
		aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, color);
	if (!r->file->gltf)
		color->a = number_of(from, "$mat.opacity", 1);
	if (!isfinite(color->a))
		color->a = 1;
}

static uint8_t byte_of(const struct reader *r, float value)
{
	if (r->file->linear_colors)
		return eco_srgb_from_linear(isfinite(value) ? value : 0.6);
	return value > 0 ? value < 1 ? (uint8_t)(value * 255 + 0.5f) : 255 : 0;
}

static void name_of(const struct aiMaterial *from, char name[64])
{
	struct aiString text;

	if (aiGetMaterialString(from, AI_MATKEY_NAME, &text) != AI_SUCCESS)
		text.data[0] = 0;
	snprintf(name, 64, "%.63s", text.data);
}

static void read_material(struct reader *r, uint32_t index, uint32_t *channel, bool *invisible)
{
	const struct aiMaterial *from = r->scene->mMaterials[index];
	struct eco_material *to = &r->model->materials[index];
	struct image_key key = { .gain = 1 };
	struct aiColor4D color;

	name_of(from, to->name);
	color_of(r, from, &color);
	key.alpha = alpha_mode(r, from, &key.gain);
	if (key.alpha != ALPHA_OPAQUE)
		key.gain *= color.a;
	*invisible = key.alpha != ALPHA_OPAQUE && key.gain * 255 + ALPHA_SLACK < 127.5;
	to->image = ECO_NONE;
	key.texture = *invisible ? NULL : texture_name(from, aiTextureType_BASE_COLOR, channel);
	if (key.texture == NULL && !*invisible)
		key.texture = texture_name(from, aiTextureType_DIFFUSE, channel);
	if (key.texture != NULL) {
		key.opacity = texture_name(from, aiTextureType_OPACITY, NULL);
		if (key.opacity != NULL && (r->file->gltf || strcmp(key.opacity, key.texture) == 0)) {
			free(key.opacity);
			key.opacity = NULL;
		}
		to->image = image_for(r, &key);
	}
	to->cutout = to->image != ECO_NONE && r->keys[to->image].cutout;
	to->rgb[0] = byte_of(r, color.r);
	to->rgb[1] = byte_of(r, color.g);
	to->rgb[2] = byte_of(r, color.b);
	if (strcmp(to->name, "DefaultMaterial") == 0)        /* assimp's, for what has none */
		memset(to->rgb, 153, 3);
	/* in MTL files a map stands instead of the colour, whatever exporters leave there (0.8, 0.64, 0) */
	if (to->image != ECO_NONE && !r->file->gltf)
		memset(to->rgb, 255, 3);
}

enum eco_code eco_assimp_materials(struct eco_model *model, const struct aiScene *scene, const struct eco_model_file *file,
	uint32_t *channel, bool *invisible, struct eco_notes *notes, struct eco_error *error)
{
	struct reader r = { .model = model, .scene = scene, .file = file, .notes = notes };

	model->materials = calloc((size_t)scene->mNumMaterials + 1, sizeof *model->materials);
	model->images = calloc(ECO_MODEL_IMAGES_MAX, sizeof *model->images);
	r.keys = calloc(ECO_MODEL_IMAGES_MAX, sizeof *r.keys);
	if (model->materials == NULL || model->images == NULL || r.keys == NULL) {
		free(r.keys);
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", file->path);
	}
	model->material_count = scene->mNumMaterials;
	for (uint32_t i = 0; i < scene->mNumMaterials; i++)
		model->materials[i].image = ECO_NONE;
	for (uint32_t i = 0; i < scene->mNumMaterials; i++)
		read_material(&r, i, &channel[i], &invisible[i]);
	for (uint32_t i = 0; i < model->image_count; i++) {
		free(r.keys[i].texture);
		free(r.keys[i].opacity);
	}
	free(r.keys);
	drop_empty_images(&r);
	return ECO_OK;
}
