/* One picture of three side by side, with words under each: ours, full detail, and the error that people see,
 * from black (none) over violet and orange to pale yellow (1). */
#ifndef VIEW_COMPARE_H
#define VIEW_COMPARE_H

#include "client-min/draw/view_picture.h"

struct view_compare {
	const struct view_picture *picture, *reference;
	const float *error_map;                  /* lod_flip's, 0 to 1 a pixel */
	const char *words[3];                    /* ASCII; letters are drawn as capitals */
};
/* *rgb is malloc'ed: 3 bytes a pixel, size[0] x size[1] pixels. */
enum eco_code view_compare_draw(const struct view_compare *compare, uint8_t **rgb, uint32_t size[2],
	struct eco_error *error);

#endif
