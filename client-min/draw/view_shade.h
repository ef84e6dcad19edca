/* A plant's shape for shading, and the shadows that plants cast on the ground where no shadow map
 * (view_shadow.h) is asked for: soft discs thrown along the sun's direction into a map over the part of the
 * scene that is near. Pictures only; masks and scores know nothing of it. */
#ifndef VIEW_SHADE_H
#define VIEW_SHADE_H

#include "client-min/view_select.h"

struct view_shape { float center_z, half_width, half_height; };          /* plant space, metres */
struct view_shape view_shape_of(const struct view_plant *plant);

#define VIEW_SHADE_PIXELS 1024
struct view_shade {
	double low[2], size_m;           /* a square of the world */
	uint8_t *texels;                 /* 2 per pixel: sunlight taken, skylight taken; row 0 is the south */
};
enum eco_code view_shade_make(struct view_shade *shade, const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error);
/* Shares of sunlight and skylight taken at a place, bilinear; none outside the square, or without texels. */
void view_shade_at(const struct view_shade *shade, const double world[2], float taken[2]);
void view_shade_free(struct view_shade *shade);

/* Metres after which haze hides all but 1/e, where it is `sea_m` at z = 0: air thins with height, so from far
 * above all of it is looked through within the last kilometres. */
double view_shade_haze_m(double sea_m, double eye_z);

#endif
