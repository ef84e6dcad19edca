/* The last step of every reader of models. */
#ifndef ECO_MODEL_CLEAN_H
#define ECO_MODEL_CLEAN_H

#include "ecofiles/model.h"

/* Takes a soup as it was read (Z up, any place and size, anything in its indices and coordinates; triangles_in = triangle_count +
 * what the reader dropped). Drops and counts bad indices, coordinates that are not finite or beyond 1e9, triangles without area
 * and duplicates (by position, within a material, whatever their winding); puts the foot at the origin and the lowest vertex at
 * z = 0; scales to height_m unless that is 0; keeps only vertices in use. Errors name `path`. */
enum eco_code eco_model_clean(struct eco_model *model, double height_m, const char *path, struct eco_error *error);

#endif
