/* The first view of a scene. A picture of all trees of a city is a haze of dots, and its middle may be a
 * river; therefore the first view of a wide scene is a place with many plants. */
#ifndef SRV_OUTLOOK_H
#define SRV_OUTLOOK_H

#include "ecofiles/format/pack.h"

struct srv_outlook { double low[3], high[3]; };          /* metres, in the scene's coordinates */

/* All of a scene that is at most SRV_OUTLOOK_WHOLE_M wide. Of a wider one the plants of a square of 200 m:
 * the one that holds the most, or half as many nearer to the scene's middle. All 0 without tiles. Looks at
 * some hundred thousand plants at most, evenly. */
#define SRV_OUTLOOK_WHOLE_M 1000.0
enum eco_code srv_outlook_find(const struct eco_scene *scene, struct srv_outlook *out,
	struct eco_error *error);

#endif
