#include "lod/build/texture.h"

#include <stdlib.h>

#include "ecofiles/format/list.h"
#include "lod/build/texture_levels.h"

/* What a level of half the texels shows wrong of a finer one, for struct lod_texture. */
static uint8_t loss_of(const struct eco_texture_part *coarse, const struct eco_texture_part *fine)
{
	uint64_t opaque = 0, wrong = 0;
	for (uint32_t y = 0; y < fine->height; y++)
		for (uint32_t x = 0; x < fine->width; x++) {
			uint8_t texel = fine->texels[(size_t)y * fine->width + x];
			opaque += texel != 0;
			wrong += texel != coarse->texels[(size_t)(y / 2) * coarse->width + x / 2];
		}
	uint64_t loss = opaque ? (wrong * ECO_LOSS_ONE + opaque) / (2 * opaque) : 0;
	return (uint8_t)(loss < 1 ? 1 : loss < ECO_LOSS_ONE ? loss : ECO_LOSS_ONE);
}

static enum eco_code write_levels(struct lod_texture *texture, const struct lod_texture_levels *levels,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < levels->count && !code; i++) {
		const struct lod_texture_level *level = &levels->levels[i];
		texture->count = i + 1;
		if (texture->outlines)
			code = eco_texture_write_outline(&texture->outlines[i], &level->outline, error);
		if (texture->outlines && i)
			texture->loss = loss_of(&level[-1].outline, &level->outline);
		if (!code)
			code = eco_texture_write_colors(&texture->colors[i], &level->colors, ECO_TEXTURE_QUALITY, error);
	}
	return code;
}

enum eco_code lod_texture_make(struct lod_texture *texture, const struct eco_model *model, uint32_t id,
	struct eco_error *error)
{
	struct lod_texture_levels levels;
	bool holes = eco_image_has_holes(&model->images[id]);
	*texture = (struct lod_texture){ .colors = calloc(ECO_TEXTURE_LEVELS_MAX, sizeof *texture->colors),
		.outlines = holes ? calloc(ECO_TEXTURE_LEVELS_MAX, sizeof *texture->outlines) : NULL };
	enum eco_code code = texture->colors && (!holes || texture->outlines) ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for a texture of %u x %u texels",
		model->images[id].width, model->images[id].height);
	if (!code)
		code = lod_texture_levels_make(&levels, model, id, error);
	if (!code) {
		texture->texel_area = levels.texel_area;
		code = write_levels(texture, &levels, error);
		lod_texture_levels_free(&levels);
	}
	if (code)
		lod_texture_free(texture);
	return code;
}

void lod_texture_free(struct lod_texture *texture)
{
	for (uint32_t i = 0; i < texture->count; i++) {
		eco_writer_free(&texture->colors[i]);
		if (texture->outlines)
			eco_writer_free(&texture->outlines[i]);
	}
	free(texture->colors);
	free(texture->outlines);
	*texture = (struct lod_texture){ 0 };
}
