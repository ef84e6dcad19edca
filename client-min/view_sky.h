/* Light of a picture: the sun, haze and shadows. */
#ifndef VIEW_SKY_H
#define VIEW_SKY_H

#include "ecofiles/base/status.h"

enum view_shadows { VIEW_SHADOWS_NONE, VIEW_SHADOWS_STANDARD, VIEW_SHADOWS_PERSPECTIVE };
#define VIEW_SHADOW_SIZE 1024u           /* texels a side, unless others are asked for */
#define VIEW_SHADOW_SIZE_MIN 64u
#define VIEW_SHADOW_SIZE_MAX 8192u

struct view_selection;

struct view_sky {                        /* zero is the usual light */
	float sun[3];                    /* towards it (view_sun_at); all 0: the usual one */
	double haze_m;                   /* at sea level it hides all but 1/e of what is so far; 0: 5200 */
	enum view_shadows shadows;       /* by maps (draw/view_shadow.h) */
	uint32_t shadow_size;            /* texels a side of the map, in the limits above */
	const struct view_selection *casters;    /* view_select_casters; NULL: the plants in sight */
};

struct view_sun_place { double longitude_deg, latitude_deg, convergence_deg; };  /* openapi.yaml: origin */
/* Towards the sun in the scene's coordinates, of length 1; below the horizon sun[2] < 0. `unix_s`: seconds
 * since 1970, UTC. Source: Michalsky 1988, "The Astronomical Almanac's algorithm for approximate solar
 * position", Solar Energy 40(3); within 0.01 degrees from 1950 to 2050. */
void view_sun_at(const struct view_sun_place *place, double unix_s, float sun[3]);

#endif
