/* Which row of which inventory a plant comes from. Packs do not keep it; `ecopack map SCENE.json -o
 * plants.geojson` does: a point a plant, with species, height_m, file and row. viewer_rows.mjs is its twin.
 *
 *   view_rows_load(&rows, "plants.geojson", &error);
 *   row = view_rows_find(rows, &plant);              properties: species, file, row
 *   view_rows_free(rows); */
#ifndef VIEW_ROWS_H
#define VIEW_ROWS_H

#include <jansson.h>

#include "ecofiles/base/status.h"

struct view_rows;

/* ECO_BAD_INPUT: it is no such file. */
enum eco_code view_rows_load(struct view_rows **rows, const char *path, struct eco_error *error);
void view_rows_free(struct view_rows *rows);             /* NULL is fine */

struct view_plant_place { const char *species; double height_m, degrees[2]; };   /* longitude, latitude */
/* The nearest row within 5 cm, as high if its height is known; of several at one place one of that species.
 * Packs may name a plant by another species that has the same model, so a row of another species is one,
 * too. NULL: none. */
const json_t *view_rows_find(const struct view_rows *rows, const struct view_plant_place *plant);

#endif
