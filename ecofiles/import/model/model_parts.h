/* Places and connected components of a model, and the names of its parts. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/import/model/model_import.h"

/* place[i] becomes the first vertex at the position of vertex i, or ECO_NONE if that is not finite or
 * beyond 1e9. -0 becomes 0. False when memory ran out. */
void eco_model_places(struct eco_model *model, uint32_t *place);

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

/* A triangle that eco_triangle_usable denies is a component of its own, without a box. `by_material`:
 * triangles of different materials are never connected, as in lod/build/weld.h; rules and `ecopack model`
 * number these components from 1. False when memory ran out. */
void eco_components_find(struct eco_components *components, const struct eco_model *model,
	const uint32_t *place, bool by_material);
void eco_components_free(struct eco_components *components);
/* The box of all. */
void eco_components_bound(const struct eco_components *components, double low[3], double high[3]);

double eco_component_diagonal(const struct eco_component *component);
double eco_triangle_area(const struct eco_model *model, uint32_t triangle);
/* Whether its vertices are there, with coordinates of at most 1e9. */
bool eco_triangle_usable(const struct eco_model *model, uint32_t triangle);

/* Whether `pattern` (* any characters, ? one, any case) fits `name`, or a part of it between slashes.
 * UTF-8. */
bool eco_part_name_fits(const char *pattern, const char *name);

/* By a part's name: 0 for tree_LOD0, 1 for Tree.lod1/bark, ECO_SPARE_NONE where it says no level,
 * ECO_SPARE_COLLIDER for UCX_tree and tree_collider, ECO_SPARE_CARD for a billboard, spare where there
 * are levels. */
#define ECO_SPARE_NONE (-1)
#define ECO_SPARE_COLLIDER 1000
#define ECO_SPARE_CARD 999
int eco_model_spare_level(const char *name);
