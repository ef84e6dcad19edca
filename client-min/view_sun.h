/* Where the sun is, by time and place: Michalsky 1988, "The Astronomical Almanac's algorithm for approximate
 * solar position", Solar Energy 40(3); within 0.01 degrees from 1950 to 2050. */
#ifndef VIEW_SUN_H
#define VIEW_SUN_H

#include <stdbool.h>

#include "ecofiles/base/status.h"

struct view_sun_place { double longitude_deg, latitude_deg, convergence_deg; };  /* openapi.yaml: origin */

/* Towards the sun in the scene's coordinates, of length 1; below the horizon sun[2] < 0. `unix_s`: seconds
 * since 1970, UTC. */
void view_sun_at(const struct view_sun_place *place, double unix_s, float sun[3]);

/* A time such as 2026-06-21T10:00Z, 2026-06-21T10:00:30Z or 2026-06-21T12:00+02:00 into *unix_s, a double.
 * ECO_BAD_USAGE. */
enum eco_code view_sun_read_time(const char *text, void *unix_s, struct eco_error *error);

#endif
