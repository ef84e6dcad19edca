/* The scene's place on Earth, as the server knows it. */
#ifndef VIEW_PLACE_H
#define VIEW_PLACE_H

#include "client-min/view_fetch.h"
#include "client-min/view_sun.h"

struct view_map { char crs[2048]; double at[3]; };       /* of the origin; crs "": plain metres */

/* The scene's CRS, and where its origin is in it. ECO_UNSUPPORTED: it does not fit. */
enum eco_code view_map_fetch(struct view_fetch *fetch, struct view_map *map, struct eco_error *error);

/* ECO_BAD_INPUT: the scene has no place. */
enum eco_code view_place_fetch(struct view_fetch *fetch, struct view_sun_place *place,
	struct eco_error *error);

#endif
