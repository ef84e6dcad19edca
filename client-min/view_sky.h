/* What lights a picture, beside what is in it. */
#ifndef VIEW_SKY_H
#define VIEW_SKY_H

#include "ecofiles/base/status.h"

enum view_shadows { VIEW_SHADOWS_NONE, VIEW_SHADOWS_STANDARD, VIEW_SHADOWS_PERSPECTIVE };
#define VIEW_SHADOW_SIZE 1024u           /* texels a side, unless others are asked for */
#define VIEW_SHADOW_SIZE_MIN 64u
#define VIEW_SHADOW_SIZE_MAX 8192u

struct view_selection;

struct view_sky {                        /* zero is the usual light */
	float sun[3];                    /* towards it (view_sun.h); all 0: the usual one */
	double haze_m;                   /* at sea level it hides all but 1/e of what is so far; 0: 5200 */
	enum view_shadows shadows;       /* by maps (draw/view_shadow.h) */
	uint32_t shadow_size;            /* texels a side of the map, in the limits above */
	const struct view_selection *casters;    /* view_select_casters; NULL: the plants in sight */
};

/* "standard", "perspective", or one of them with a size as in "perspective,2048": shadows and shadow_size of
 * *sky, a struct view_sky. ECO_BAD_USAGE. */
enum eco_code view_sky_read_shadows(const char *text, void *sky, struct eco_error *error);

#endif
