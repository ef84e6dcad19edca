#include "ecofiles/format/texture.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include <webp/decode.h>
#include <webp/encode.h>

#include "ecofiles/base/range.h"
#include "ecofiles/format/image.h"

#define TEMPLATE_BITS 10
#define OUTLINE_HEAD 8                   /* bytes: width and height */
#define EFFORT 6                         /* of libwebp, the most: packs are made once */
#define EFFORT_ALPHA 5                   /* the most takes 30 times as long for alpha, and saves a tenth of its bytes */
#define QUALITY 72.0f                    /* 0 to 100 (lod/EXPERIMENTS.md, Coders of colours) */

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

void eco_texture_part_free(struct eco_texture_part *part)
{
	free(part->texels);
	*part = (struct eco_texture_part){ 0 };
}

static bool sides_fit(uint64_t width, uint64_t height)
{
	return width >= 1 && height >= 1 && width <= ECO_TEXTURE_SIDE_MAX && height <= ECO_TEXTURE_SIDE_MAX
		&& width * height <= ECO_PIXELS_MAX;
}

enum eco_code eco_texture_part_add(struct eco_texture_part *part, const struct eco_texture_part *strip,
	struct eco_error *error)
{
	size_t row = (size_t)strip->width * strip->channels;
	if (!strip->height)
		return ECO_OK;
	if (part->height && (part->width != strip->width || part->channels != strip->channels
			|| !sides_fit(part->width, (uint64_t)part->height + strip->height)))
		return BAD("texture: a strip of %u x %u texels below %u x %u", strip->width, strip->height,
			part->width, part->height);
	uint8_t *texels = realloc(part->texels, row * ((size_t)part->height + strip->height));
	if (!texels)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u rows of a texture", part->height);
	memcpy(texels + row * part->height, strip->texels, row * strip->height);
	*part = (struct eco_texture_part){ strip->width, part->height + strip->height, strip->channels, texels };
	return ECO_OK;
}

/* ---- Outlines ---- */

/* Three texels two rows above, five in the row above, two to the left. */
static uint32_t context_at(const uint8_t *above2, const uint8_t *above, const uint8_t *row, size_t x)
{
	/* rows begin two texels early */
	return (uint32_t)(above2[x + 1] << 9 | above2[x + 2] << 8 | above2[x + 3] << 7 | above[x] << 6
		| above[x + 1] << 5 | above[x + 2] << 4 | above[x + 3] << 3 | above[x + 4] << 2 | row[x] << 1
		| row[x + 1]);
}

/* Writes texels, or reads them. */
static enum eco_code code_outline(struct eco_range *range, uint32_t width, uint32_t height, uint8_t *texels,
	struct eco_error *error)
{
	size_t stride = (size_t)width + 4;
	uint8_t *rows = calloc(3, stride);
	struct eco_bit *models = malloc((1u << TEMPLATE_BITS) * sizeof *models);
	bool good = rows && models;
	if (good)
		eco_bits_start(models, 1u << TEMPLATE_BITS);
	for (uint32_t y = 0; good && y < height; y++) {
		uint8_t *row = rows + (y % 3) * stride, *above = rows + ((y + 2) % 3) * stride,
			*above2 = rows + ((y + 1) % 3) * stride, *out = texels + (size_t)y * width;
		for (uint32_t x = 0; x < width; x++) {
			bool bit = eco_range_bit(range, &models[context_at(above2, above, row, x)],
				out[x] > 0);
			row[x + 2] = bit;
			out[x] = bit ? 255 : 0;
		}
	}
	free(rows);
	free(models);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for an outline %u texels wide",
		width);
}

static bool all_opaque(const struct eco_texture_part *part)
{
	size_t count = (size_t)part->width * part->height, i = 0;
	while (i < count && part->texels[i])
		i++;
	return i == count;
}

enum eco_code eco_texture_write_outline(struct eco_writer *w, const struct eco_texture_part *part,
	struct eco_error *error)
{
	assert(part->channels == 1);
	eco_write_u32(w, part->width);
	eco_write_u32(w, part->height);
	if (!all_opaque(part)) {
		struct eco_range range;
		eco_range_write(&range, w);
		ECO_PASS(code_outline(&range, part->width, part->height, part->texels, error));
		eco_write_u8(w, (uint8_t)eco_range_end(&range));
	}
	return w->failed ? eco_fail(error, ECO_NO_MEMORY, "no memory for an outline") : ECO_OK;
}

static enum eco_code read_outline(struct eco_texture_part *part, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	uint32_t width = eco_read_u32(&r), height = eco_read_u32(&r);
	if (r.failed || !sides_fit(width, height))
		return BAD("texture: an outline of %u x %u texels", width, height);
	*part = (struct eco_texture_part){ width, height, 1, malloc((size_t)width * height) };
	if (!part->texels)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for an outline of %u x %u texels", width,
			height);
	memset(part->texels, 255, (size_t)width * height);
	if (size == OUTLINE_HEAD)
		return ECO_OK;
	struct eco_range range;
	eco_range_read(&range, bytes + OUTLINE_HEAD, size - OUTLINE_HEAD - 1);
	ECO_PASS(code_outline(&range, width, height, part->texels, error));
	return eco_range_end(&range) == bytes[size - 1] ? ECO_OK
		: BAD("texture: the outline of %u x %u texels does not end where its %zu bytes do", width, height, size);
}

/* ---- Colours ---- */

enum eco_code eco_texture_write_colors(struct eco_writer *w, const struct eco_texture_part *part,
	struct eco_error *error)
{
	WebPConfig config;
	WebPPicture picture;
	WebPMemoryWriter memory;
	assert(part->channels == 3 || part->channels == 4);
	if (!WebPConfigPreset(&config, WEBP_PRESET_PICTURE, QUALITY) || !WebPPictureInit(&picture))
		return eco_fail(error, ECO_UNSUPPORTED, "libwebp has another version than its headers");
	WebPMemoryWriterInit(&memory);
	config.method = part->channels == 4 ? EFFORT_ALPHA : EFFORT;
	/* Noise moved to where texels are rough is error in pictures of plants, and a colour for four texels
	 * is fitted to how they look (lod/EXPERIMENTS.md, Textures). */
	config.sns_strength = 0;
	config.use_sharp_yuv = picture.use_argb = 1;
	picture.width = (int)part->width;
	picture.height = (int)part->height;
	picture.writer = WebPMemoryWrite;
	picture.custom_ptr = &memory;
	bool good = (part->channels == 3 ? WebPPictureImportRGB : WebPPictureImportRGBA)(&picture,
			    part->texels, (int)(part->channels * part->width)) &&
		WebPEncode(&config, &picture);
	if (good)
		eco_write_bytes(w, memory.mem, memory.size);
	WebPPictureFree(&picture);
	WebPMemoryWriterClear(&memory);
	return good && !w->failed ? ECO_OK : eco_fail(error, ECO_NO_MEMORY,
		"no memory to write %u x %u texels as WebP", part->width, part->height);
}

static enum eco_code read_colors(struct eco_texture_part *part, const uint8_t *bytes, size_t size,
	bool may_fade, struct eco_error *error)
{
	WebPBitstreamFeatures features;
	if (WebPGetFeatures(bytes, size, &features) != VP8_STATUS_OK || features.has_animation
			|| (features.has_alpha && !may_fade) || features.width < 1 || features.height < 1
			|| !sides_fit((uint64_t)features.width, (uint64_t)features.height))
		return BAD("texture: %zu bytes are no WebP file of colours", size);
	uint32_t width = (uint32_t)features.width, height = (uint32_t)features.height;
	uint32_t channels = may_fade ? 4 : 3;
	size_t room = channels * (size_t)width * height;
	*part = (struct eco_texture_part){ width, height, channels, malloc(room) };
	if (!part->texels)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u x %u texels", width, height);
	if (!(channels == 3 ? WebPDecodeRGBInto : WebPDecodeRGBAInto)(bytes, size, part->texels, room,
			(int)channels * features.width))
		return BAD("texture: the WebP file of %u x %u texels is damaged", width, height);
	return ECO_OK;
}

uint64_t eco_texture_texels(const uint8_t *bytes, size_t size, bool outline)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	int width = 0, height = 0;
	if (!outline)
		return WebPGetInfo(bytes, size, &width, &height) ? (uint64_t)width * (uint64_t)height : 0;
	uint64_t wide = eco_read_u32(&r), texels = wide * eco_read_u32(&r);
	return r.failed ? 0 : texels;
}

enum eco_code eco_texture_read(struct eco_texture_part *part, enum eco_list_kind kind, const uint8_t *bytes,
	size_t size, struct eco_error *error)
{
	*part = (struct eco_texture_part){ 0 };
	enum eco_code code = kind == ECO_LIST_OUTLINE ? read_outline(part, bytes, size, error)
		: read_colors(part, bytes, size, kind == ECO_LIST_GROUND_IMAGE, error);
	if (code)
		eco_texture_part_free(part);
	return code;
}

/* ---- Strips ---- */

static enum eco_code write_rows(struct eco_writer *w, const struct eco_texture_part *level, uint32_t first,
	uint32_t rows, struct eco_error *error)
{
	const struct eco_texture_part strip = { level->width, rows, level->channels,
		level->texels + (size_t)first * level->width * level->channels };
	size_t at = w->size, size;
	eco_write_u32(w, 0);
	ECO_PASS((level->channels == 1 ? eco_texture_write_outline : eco_texture_write_colors)(w, &strip,
		error));
	size = w->size - at - 4;
	if (size <= ECO_TEXTURE_CHUNK_BYTES || rows <= ECO_TEXTURE_STRIP_ROWS) {
		for (int i = 0; i < 4; i++)
			w->bytes[at + (size_t)i] = (uint8_t)(size >> 8 * i);
		return ECO_OK;
	}
	/* rows are not alike: an eighth more strips than the mean would need */
	uint32_t count = (uint32_t)(9 * size / (8 * ECO_TEXTURE_CHUNK_BYTES)) + 1, unit = ECO_TEXTURE_STRIP_ROWS,
		each = (rows / count + unit - 1) / unit * unit;
	w->size = at;
	each = each > unit ? each : unit;
	for (uint32_t y = 0; y < rows; y += each)
		ECO_PASS(write_rows(w, level, first + y, rows - y < each ? rows - y : each, error));
	return ECO_OK;
}

enum eco_code eco_texture_write_strips(struct eco_writer *w, const struct eco_texture_part *level,
	struct eco_error *error)
{
	return write_rows(w, level, 0, level->height, error);
}

enum eco_code eco_texture_read_level(struct eco_texture_part *part, const struct eco_pack *pack,
	const struct eco_list *list, uint32_t level, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	*part = (struct eco_texture_part){ 0 };
	for (uint32_t c = list->chunk_first, k = 0; !code && c < list->chunk_first + list->chunk_count; c++) {
		struct eco_texture_part strip = { 0 };
		const uint8_t *bytes;
		size_t size;
		if (k == level)
			code = eco_pack_payload(pack, c, &bytes, &size, error);
		if (k == level && !code)
			code = eco_texture_read(&strip, list->kind, bytes, size, error);
		if (k == level && !code)
			code = eco_texture_part_add(part, &strip, error);
		eco_texture_part_free(&strip);
		k += pack->scene.chunks[c].primitive_count;
	}
	if (code)
		eco_texture_part_free(part);
	return code;
}

/* ---- Together ---- */

enum eco_code eco_texture_show(struct eco_image *image, const struct eco_texture_part *colors,
	const struct eco_texture_part *outline, struct eco_error *error)
{
	const struct eco_texture_part *finer = outline && outline->width > colors->width ? outline : colors;
	size_t width = finer->width, height = finer->height;
	*image = (struct eco_image){ finer->width, finer->height, malloc(4 * width * height) };
	if (!image->rgba)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a texture of %zu x %zu texels", width,
			height);
	for (size_t y = 0; y < height; y++) {
		const uint8_t *row = colors->texels + 3 * (y * colors->height / height) * colors->width,
			*cut = outline ? outline->texels + (y * outline->height / height) * outline->width
			: NULL;
		for (size_t x = 0; x < width; x++) {
			uint8_t *to = image->rgba + 4 * (y * width + x);
			memcpy(to, row + 3 * (x * colors->width / width), 3);
			to[3] = cut ? cut[x * outline->width / width] : 255;
		}
	}
	return ECO_OK;
}
