#include "lod/build/model_draw.h"

#include <math.h>
#include <string.h>

#include "lod/build/weld.h"
#include "lod/raster/texel.h"

#define SOUP 512u

/* ---- Extent ---- */

/* The corner of the model, or NULL if its triangle is not usable. */
static const float *corner_at(const struct eco_model *model, size_t corner)
{
	return lod_mesh_usable(model, (uint32_t)(corner / 3), NULL)
		? model->position + 3 * (size_t)model->index[corner] : NULL;
}

bool lod_model_bounds(const struct eco_model *model, float low[3], float high[3])
{
	bool any = false;
	for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
		const float *at = corner_at(model, i);
		for (int k = 0; k < 3 && at; k++) {
			low[k] = !any || at[k] < low[k] ? at[k] : low[k];
			high[k] = !any || at[k] > high[k] ? at[k] : high[k];
		}
		any |= at != NULL;
	}
	return any;
}

double lod_model_sphere(const struct eco_model *model, double center[3])
{
	float low[3] = { 0 }, high[3] = { 0 };
	double far2 = 0;
	lod_model_bounds(model, low, high);
	for (int k = 0; k < 3; k++)
		center[k] = ((double)low[k] + high[k]) / 2;
	for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
		const float *at = corner_at(model, i);
		double d2 = 0;
		for (int k = 0; k < 3 && at; k++)
			d2 += (at[k] - center[k]) * (at[k] - center[k]);
		far2 = d2 > far2 ? d2 : far2;
	}
	return sqrt(far2);
}

/* ---- Colours of triangles ---- */

static void color_triangle(uint8_t rgb[3], const struct eco_model *model, uint32_t t,
	struct lod_texels *texels)
{
	const struct eco_material *material = lod_mesh_material(model, model->material[t]);
	memcpy(rgb, material->rgb, 3);
	if (!model->uv || material->image >= model->image_count)
		return;
	int32_t uv[6];
	for (int i = 0; i < 6; i++) {
		float at = model->uv[2 * (size_t)model->index[3 * (size_t)t + (size_t)i / 2] + (size_t)i % 2]
			* (float)ECO_UV_ONE;
		uv[i] = at > -1e9f && at < 1e9f ? (int32_t)floorf(at + 0.5f) : 0;
	}
	lod_texels_mean(&texels[material->image], material->rgb, uv, rgb);
}

const uint8_t (*lod_model_colors(const struct eco_model *model, struct lod_arena *arena))[3]
{
	uint8_t (*rgb)[3] = lod_arena_take(arena, model->triangle_count, sizeof *rgb);
	struct lod_texels *texels = lod_arena_take(arena, model->image_count, sizeof *texels);
	bool *cut = lod_arena_take(arena, model->image_count, sizeof *cut);
	for (uint32_t i = 0; i < model->material_count; i++)
		if (model->materials[i].image < model->image_count)
			cut[model->materials[i].image] |= model->materials[i].cutout;
	for (uint32_t i = 0; i < model->image_count; i++)
		lod_texels_open(&texels[i], &model->images[i], cut[i], arena);
	for (uint32_t t = 0; t < model->triangle_count; t++)
		if (lod_mesh_usable(model, t, NULL))
			color_triangle(rgb[t], model, t, texels);
	return (const uint8_t (*)[3])rgb;
}

/* ---- Drawing ---- */

const struct lod_mask *lod_model_masks(const struct eco_model *model, struct lod_arena *arena)
{
	struct lod_mask *masks = lod_arena_take(arena, model->image_count, sizeof *masks);
	for (uint32_t i = 0; i < model->material_count; i++) {
		uint32_t image = model->materials[i].image;
		if (model->materials[i].cutout && image < model->image_count && !masks[image].words)
			lod_mask_open(&masks[image], &model->images[image], arena);
	}
	return masks;
}

/* Triangles [first, first + count) of the model. */
struct soup { uint32_t first, count; float position[SOUP * 9], uv[SOUP * 6]; };

static void flush(const struct eco_model *model, const struct lod_mask *masks, struct lod_raster *raster,
	struct soup *soup, uint32_t material_index)
{
	const struct eco_material *material = lod_mesh_material(model, material_index);
	const struct eco_image *image = material->cutout && model->uv
		&& material->image < model->image_count ? &model->images[material->image] : NULL;
	struct lod_raster_batch batch = { .count = soup->count, .position = soup->position,
		.uv = image ? soup->uv : NULL, .cutout = image,
		.mask = lod_model_mask(model, masks, image), .item = soup->first, .owner = 1 };
	if (soup->count)
		lod_raster_triangles(raster, &batch);
	soup->count = 0;
}

void lod_model_draw(const struct eco_model *model, const struct lod_mask *masks, struct lod_raster *raster)
{
	struct soup soup;
	soup.count = 0;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		bool good = lod_mesh_usable(model, t, NULL);
		soup.first = soup.count ? soup.first : t;
		for (uint32_t i = 0; i < 3 && good; i++) {
			size_t vertex = model->index[3 * (size_t)t + i];
			memcpy(soup.position + 9 * soup.count + 3 * i, model->position + 3 * vertex,
				3 * sizeof(float));
			if (model->uv)
				memcpy(soup.uv + 6 * soup.count + 2 * i, model->uv + 2 * vertex,
					2 * sizeof(float));
		}
		soup.count += good;
		if (!good || soup.count == SOUP || t + 1 == model->triangle_count
				|| model->material[t + 1] != model->material[t])
			flush(model, masks, raster, &soup, model->material[t]);
	}
}
