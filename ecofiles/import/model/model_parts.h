/* Places and connected components of a model, and a scene file's rules about its parts. */
#ifndef ECO_MODEL_PARTS_H
#define ECO_MODEL_PARTS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/import/model/model_import.h"

struct eco_notes;

/* place[i] becomes the first vertex at the position of vertex i, or ECO_NONE if that is not finite or
 * beyond 1e9. -0 becomes 0. False when memory ran out. */
bool eco_model_places(struct eco_model *model, uint32_t *place);

struct eco_component {
	double area, low[3], high[3];        /* in the model's unit */
	uint32_t triangle_count, first;      /* its first triangle */
};

/* Connected components, by shared places. Owns its arrays. */
struct eco_components {
	uint32_t count;
	uint32_t *of;                        /* per triangle */
	struct eco_component *items;         /* by falling area; ties by first triangle */
};

/* All places of the model's triangles must be finite (eco_model_clean sees to it). `by_material`:
 * triangles of different materials are never connected, as in lod/build/weld.h; rules and `ecopack model`
 * number these components from 1. False when memory ran out. */
bool eco_components_find(struct eco_components *components, const struct eco_model *model,
const uint32_t *place, bool by_material);
void eco_components_free(struct eco_components *components);

double eco_component_diagonal(const struct eco_component *component);
double eco_triangle_area(const struct eco_model *model, uint32_t triangle);

/* Whether `pattern` (* any characters, ? one, any case) fits `name`, or a part of it between slashes.
 * UTF-8. */
bool eco_part_name_fits(const char *pattern, const char *name);

/* Applies the first rule that fits each triangle: drops and counts it (ECO_DROP_LEFT_OUT), or sets
 * model->organ and, where a rule gives one, model->importance. Notes rules that fit nothing, with the names
 * there are. Fails if no triangle is left; errors name `what`. */
enum eco_code eco_model_apply_rules(struct eco_model *model, const uint32_t *place,
const struct eco_part_rule *rules, uint32_t count,
	const char *what, struct eco_notes *notes, struct eco_error *error);

#endif
