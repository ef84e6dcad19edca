/* Shared by the files of the scene reader. */
#ifndef ECO_SCENE_PARSE_H
#define ECO_SCENE_PARSE_H

#include "ecofiles/base/json_read.h"
#include "ecofiles/scene/scene.h"

#define ECO_PATH_BYTES 4096u
#define ECO_METRES_MAX 1e7           /* largest coordinate of anything placed */
#define ECO_IMPORTANCE_LEAST 0.01
#define ECO_IMPORTANCE_MOST 100.0

/* Fields of several parts (scene_field.c). */

/* As eco_json_object, and "notes" may be among the members: a text, an array or an object of texts, for
 * people. */
bool eco_scene_object(const struct eco_json *at, const char *const *fields);

/* A path, as seen from the folder of the file that names it; malloc'ed, or NULL. False after an error at
 * `at`, also if the file does not exist (not checked for documents from memory). */
bool eco_scene_parse_path(const struct eco_source *source, const struct eco_json *at, char **path);
/* Reads one path, or an array of up to `most`; errors name `what`. On failure *paths holds the *count paths
 * read so far. */
bool eco_scene_parse_paths(const struct eco_source *source, const struct eco_json *at, const char *what,
	size_t most, char ***paths, uint32_t *count);
/* Copies the text of that key, if present, to *out (malloc'ed). */
#define ECO_COLUMN_BYTES 256u
bool eco_scene_copy_text(const struct eco_json *at, const char *key, size_t bytes_max, char **out);
/* As eco_scene_copy_text for a CRS; an error in a scene without one, which could not convert it. */
bool eco_scene_parse_crs(const struct eco_source *source, const struct eco_json *at, const char *key,
	char **crs);
/* "unit" in metres, if present. */
bool eco_scene_parse_unit(const struct eco_json *at, double *unit_m);
/* Names end up in URLs, file names and messages: 1 to 63 bytes, no characters that
 * eco_utf8_control finds. */
bool eco_source_name_is_fine(const struct eco_json *at, const char *name, size_t bytes);

/* "plants" (scene_plant.c). */
bool eco_scene_parse_plants(struct eco_source *source, const struct eco_json *top);
void eco_source_plant_free(struct eco_source_plant *plant);

/* "ground" (scene_ground.c). */
bool eco_scene_parse_ground(struct eco_source *source, const struct eco_json *top);
void eco_ground_source_free(struct eco_ground_source *ground);

/* The first plant of that name. The error, at `at`, lists the plants there are. */
bool eco_source_plant_named(const struct eco_source *source, const struct eco_json *at, const char *name,
	uint32_t *plant);
/* The plant that a text names. */
bool eco_source_plant_of(const struct eco_source *source, const struct eco_json *at, uint32_t *plant);

enum eco_code eco_source_parse_as(struct eco_source *source, const char *json, size_t size, const char *path,
	bool on_disk, struct eco_error *error);

/* "only" and "skip" of an entry (scene_rows.c). On failure they hold the part read so far. */
bool eco_scene_parse_filters(const struct eco_json *at, struct eco_filter **filters, uint32_t *count);

/* One entry of "instances" with "scatter" (scene_scatter.c). On failure the spec holds the part read so
 * far. */
bool eco_scene_parse_scatter(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec);
void eco_scatter_spec_free(struct eco_scatter_spec *spec);

/* One entry of "instances" with "from". On failure the spec holds the part read so far. */
bool eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec);
void eco_positions_spec_free(struct eco_positions_spec *spec);

#endif
