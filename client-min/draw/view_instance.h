/* An instance as the vertex shaders read it: four texels of four words. */
#ifndef VIEW_INSTANCE_H
#define VIEW_INSTANCE_H

#include "client-min/view_select.h"

#define VIEW_INSTANCE_TEXELS 4

/* The rows of object -> view, then its scale and half the width of its plant; plant: NULL for a summary's. */
void view_instance_write(uint32_t *words, const struct lod_eye *eye, const struct view_instance *instance,
	const struct view_plant *plant);

#endif
