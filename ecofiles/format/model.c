/* A model in memory. */
#include "ecofiles/format/model.h"

#include <stdlib.h>

#include "ecofiles/base/array_grow.h"

const char *const eco_drop_names[ECO_DROP_COUNT] = {
	[ECO_DROP_BAD_INDEX] = "bad index",
	[ECO_DROP_NOT_FINITE] = "not finite",
	[ECO_DROP_DEGENERATE] = "degenerate",
	[ECO_DROP_DUPLICATE] = "duplicate",
	[ECO_DROP_TRANSPARENT] = "transparent",
	[ECO_DROP_QUANTIZED] = "collapsed on the grid",
	[ECO_DROP_LEFT_OUT] = "left out",
};

void eco_image_free(struct eco_image *image)
{
	free(image->rgba);
	*image = (struct eco_image){ .rgba = NULL };
}

bool eco_image_has_holes(const struct eco_image *image)
{
	size_t pixels = (size_t)image->width * image->height;
	for (size_t i = 0; i < pixels; i++)
		if (image->rgba[4 * i + 3] < 128)
			return true;
	return false;
}

void eco_model_free(struct eco_model *model)
{
	for (uint32_t i = 0; i < model->image_count; i++)
		free(model->images[i].rgba);
	eco_free(model->images, model->materials, model->position, model->uv, model->index, model->material,
		model->part, model->organ, model->importance, model->parts);
	*model = (struct eco_model){ .position = NULL };
}

double eco_model_height(const struct eco_model *model)
{
	double top = 0;
	for (uint32_t i = 0; i < model->vertex_count; i++)
		if (model->position[i * 3 + 2] > top)
			top = model->position[i * 3 + 2];
	return top;
}
