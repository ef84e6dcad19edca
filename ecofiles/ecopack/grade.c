#include "ecofiles/ecopack/grade.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/import/model/model_parts.h"
#include "lod/build/organ/organ.h"
#include "lod/light.h"
#include "lod/raster/texel.h"

#define WELD_BITS 16u

uint8_t *grade_organs(const struct eco_model *model)
{
	struct lod_arena arena = { 0 };
	struct lod_mesh mesh;
	struct lod_organs organs;
	uint8_t *organ = eco_alloc(model->triangle_count + 1u, 1);
	memset(organ, ECO_ORGAN_FOUND, model->triangle_count + 1u);
	lod_weld(&mesh, model, WELD_BITS, &arena);
	lod_organs_find(&organs, &mesh, model, &arena);
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		organ[mesh.source[t]] = organs.components[mesh.component[t]].organ;
	lod_arena_free(&arena);
	return organ;
}

static double luminance(const uint8_t rgb[3])
{
	return (0.2126 * lod_light_of[rgb[0]] + 0.7152 * lod_light_of[rgb[1]] + 0.0722 * lod_light_of[rgb[2]]) / 65535;
}

/* The color at the middle of a triangle; NULL: it is cut out there. */
static const uint8_t *color_of(const struct eco_model *model, uint32_t t)
{
	const struct eco_material *m = &model->materials[model->material[t]];
	if (m->image == ECO_NONE || !model->uv)
		return m->rgb;
	double at[2] = { 0, 0 };
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++)
			at[i] += (double)model->uv[2 * (size_t)model->index[3 * (size_t)t + (size_t)k] + (size_t)i] / 3;
	const uint8_t *texel = lod_texel_at(&model->images[m->image], at[0], at[1]);
	return m->cutout && texel[3] < 128 ? NULL : texel;
}

double grade_light(const struct eco_model *model, const uint8_t *organ)
{
	double light = 0, sum = 0;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		const uint8_t *color = organ[t] == ECO_ORGAN_FOLIAGE && !model->materials[model->material[t]].colourless
			? color_of(model, t) : NULL;
		double area = color ? eco_triangle_area(model, t) : 0;
		light += area > 0 ? area * luminance(color) : 0;
		sum += area;
	}
	return sum > 0 ? light / sum : 0;
}

static void darken(uint8_t rgb[3], double factor)
{
	for (int k = 0; k < 3; k++)
		rgb[k] = lod_light_byte(factor * lod_light_of[rgb[k]]);
}

static void darken_image(const struct eco_image *image, double factor)
{
	for (size_t i = 0; i < (size_t)image->width * image->height; i++)
		darken(image->rgba + 4 * i, factor);
}

/* Area of foliage less that of all else, of each material, or of each image. */
static double *foliage_of(const struct eco_model *model, const uint8_t *organ, bool images)
{
	double *more = eco_alloc(images ? model->image_count : model->material_count, sizeof *more);
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		uint32_t of = images ? model->materials[model->material[t]].image : model->material[t];
		double area = eco_triangle_area(model, t);
		if (of != ECO_NONE)
			more[of] += organ[t] == ECO_ORGAN_FOLIAGE ? area : -area;
	}
	return more;
}

void grade_foliage(struct eco_model *model)
{
	uint8_t *organ = grade_organs(model);
	double light = grade_light(model, organ), factor = GRADE_TO / light;
	double *materials = foliage_of(model, organ, false), *images = foliage_of(model, organ, true);
	for (uint32_t i = 0; i < model->material_count && light > GRADE_MOST; i++)
		if (materials[i] > 0 && model->materials[i].image == ECO_NONE)
			darken(model->materials[i].rgb, factor);
	for (uint32_t i = 0; i < model->image_count && light > GRADE_MOST; i++)
		if (images[i] > 0)
			darken_image(&model->images[i], factor);
	eco_free(images, materials, organ);
}
