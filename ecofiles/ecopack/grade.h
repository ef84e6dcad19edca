/* Foliage in colors that no leaf has. Leaves reflect 5 to 15 % of visible light, and let half as much
 * through; light takes a model's color for both (client-min/draw/view_light.glsl). Models for pictures of
 * single plants are often pastel, or of twice or four times that light, and then glare beside others. */
#pragma once

#include "ecofiles/format/model.h"

#define GRADE_MOST 0.22              /* of light that foliage sends on: brighter is worth a note */
#define GRADE_TO 0.15                /* what grading makes of it: a leaf in the middle of that range */

/* Organ of each triangle as building finds it (ECO_ORGAN_FOUND: covers nothing). The caller frees them. */
uint8_t *grade_organs(const struct eco_model *model);
/* Mean luminance of foliage by area, [0, 1]; 0: none has a color. */
double grade_light(const struct eco_model *model, const uint8_t *organ);
/* Darkens materials and images that are mostly on foliage, if that is brighter than GRADE_MOST. */
void grade_foliage(struct eco_model *model);
