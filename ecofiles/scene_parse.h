/* Inside the scene reader: what its files share. Not for others. */
#ifndef ECO_SCENE_PARSE_H
#define ECO_SCENE_PARSE_H

#include "ecofiles/json_read.h"
#include "ecofiles/scene.h"

#define ECO_PATH_BYTES 4096u
#define ECO_METRES_MAX 1e7           /* of anything placed */

/* `relative` as seen from the folder of `base`; malloc'ed, NULL when memory ran out. */
char *eco_path_beside(const char *base, const char *relative);

/* Names end up in URLs, file names and messages: 1 to 63 bytes, no control characters. */
bool eco_source_name_is_fine(const struct eco_json *at, const char *name, size_t bytes);

/* "plants" (scene_plant.c). */
bool eco_scene_parse_plants(struct eco_source *source, const struct eco_json *top);
void eco_source_plant_free(struct eco_source_plant *plant);

/* "ground" (scene_ground.c). */
bool eco_scene_parse_ground(struct eco_source *source, const struct eco_json *top);
void eco_ground_source_free(struct eco_ground_source *ground);

/* Metres in a unit of that name; false where there is none. */
#define ECO_UNITS "m, cm, mm, in, ft, US survey ft"
bool eco_unit_metres(const char *name, double *metres);

/* Index of the first plant of that name, or ECO_NONE. */
uint32_t eco_source_find_plant(const struct eco_source *source, const char *name);
/* The plant a text names; an error lists the plants there are. */
bool eco_source_plant_of(const struct eco_source *source, const struct eco_json *at, uint32_t *plant);

/* False after an error at `at` when the file is not there; true for documents from memory. */
bool eco_source_has_file(const struct eco_source *source, const struct eco_json *at, const char *path);

enum eco_code eco_source_parse_as(struct eco_source *source, const char *json, size_t size, const char *path, bool on_disk,
	struct eco_error *error);

#define ECO_COLUMN_BYTES 256u
/* *out becomes a copy of the text of that key, malloc'ed, where it is there. */
bool eco_scene_copy_text(const struct eco_json *at, const char *key, size_t bytes_max, char **out);

/* "only" and "skip" of an entry (scene_filter.c). On failure they hold what was read so far. */
bool eco_scene_parse_filters(const struct eco_json *at, struct eco_filter **filters, uint32_t *count);

/* One entry of "instances" that has "scatter" (scene_scatter.c). On failure the spec holds what was read so far. */
bool eco_scene_parse_scatter(const struct eco_source *source, const struct eco_json *at, struct eco_scatter_spec *spec);
void eco_scatter_spec_free(struct eco_scatter_spec *spec);

/* One entry of "instances" that has "from". On failure the spec holds what was read so far. */
bool eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec);
void eco_positions_spec_free(struct eco_positions_spec *spec);

#endif
