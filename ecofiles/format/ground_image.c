#include "ecofiles/format/ground_image.h"

void eco_ground_image_quarter(struct eco_list *list, uint32_t quarter)
{
	for (int k = 0; k < 2; k++) {
		list->grid_step[k] /= 2;
		if (quarter >> k & 1)
			list->grid_origin[k] += ECO_GROUND_IMAGE_SIDE * list->grid_step[k];
	}
}
