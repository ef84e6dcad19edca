/* Shared by the files of the scene reader. */
#pragma once

#include "ecofiles/base/json_read.h"
#include "ecofiles/scene/scene.h"

#define ECO_PATH_BYTES 4096u
#define ECO_METRES_MAX 1e7           /* largest coordinate of anything placed */
#define ECO_IMPORTANCE_LEAST 0.01
#define ECO_IMPORTANCE_MOST 100.0

/* All of the reader's functions stop at the first error (eco_try in memory.h). */
_Noreturn void eco_scene_fail(const struct eco_json *at, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* Stops where `good`, which a function of json_read.h returned, is false. */
void eco_scene_need(bool good);

/* ---- Fields (scene_field.c) ---- */

enum eco_field_kind {
	ECO_IS_OTHER,        /* read by its own function */
	ECO_IS_COLUMN,       /* a text of up to 256 bytes: malloc'ed, as TEXT, CRS and PATH */
	ECO_IS_TEXT,
	ECO_IS_CRS,          /* an error in a scene without one, which could not convert it */
	ECO_IS_PATH,         /* as seen from the folder of the file that names it; a document from a file: exists */
	ECO_IS_UNIT,         /* its metres */
	ECO_IS_NUMBER,       /* low to high: a double or float */
	ECO_IS_NUMBERS,      /* two, or as many doubles as the member has */
	ECO_IS_WHOLE,        /* uint64_t or uint32_t */
	ECO_IS_REQUIRED = 16 /* beside one of these */
};
struct eco_field {
	const char *name;            /* NULL behind the last */
	unsigned kind;
	double low, high;
	size_t at, bytes;            /* of the member */
};
#define ECO_FIELD(name, kind, low, high, record, member) \
	{ name, ECO_IS_##kind, low, high, offsetof(struct eco_##record, member), \
		sizeof ((struct eco_##record *)0)->member }
#define ECO_OTHER(name) { name, ECO_IS_OTHER, 0, 0, 0, 0 }
#define ECO_FIELDS_END { NULL, 0, 0, 0, 0, 0 }

/* Reads an object's fields into their members of `to`. Those that are absent stay. "notes" may be among the
 * members: a text, an array or an object of texts, for people. */
void eco_scene_fields(const struct eco_source *source, const struct eco_json *at, const struct eco_field *fields,
	void *to);
void eco_scene_fields_free(const struct eco_field *fields, void *of);

/* Reads one path, or an array of up to `most`; errors name `what`. When it stops, *paths holds the *count
 * paths read so far. */
void eco_scene_parse_paths(const struct eco_source *source, const struct eco_json *at, const char *what,
	size_t most, char ***paths, uint32_t *count);
void eco_scene_paths_free(char **paths, uint32_t count);
/* One of `names`, which end with NULL, in *which, if present. The error says what the field is. */
void eco_scene_choice(const struct eco_json *at, const char *key, const char *const *names, const char *says,
	unsigned *which);
#define ECO_COLUMN_BYTES 256u
/* Keeps a text, in the place of what *out was. */
void eco_scene_copy(const struct eco_json *at, size_t bytes_max, char **out);
/* "#rrggbb" */
void eco_scene_color(const struct eco_json *at, uint8_t rgb[3]);
/* How many an array has; what is no array is one, its own first. */
size_t eco_scene_several(const struct eco_json *at);
struct eco_json eco_scene_one(const struct eco_json *at, size_t index);

/* Names end up in URLs, file names and messages: 1 to 63 bytes, no characters that
 * eco_utf8_control finds. */
void eco_source_check_name(const struct eco_json *at, const char *name, size_t bytes);

/* "season" of an object, in *season; absent: it stays (scene_plant.c). */
void eco_scene_parse_season(const struct eco_json *at, enum eco_season *season);
/* "plants" (scene_plant.c). */
void eco_scene_parse_plants(struct eco_source *source, const struct eco_json *top);
void eco_source_plant_free(struct eco_source_plant *plant);

/* "ground" (scene_ground.c). */
void eco_scene_parse_ground(struct eco_source *source, const struct eco_json *top);
void eco_ground_source_free(struct eco_ground_source *ground);
void eco_ground_image_source_free(struct eco_ground_image_source *source);
void eco_scene_draws_free(struct eco_source *source);

/* The first plant of that name. The error, at `at`, lists the plants there are. */
uint32_t eco_source_plant_named(const struct eco_source *source, const struct eco_json *at, const char *name);
/* The plant that a text names. */
uint32_t eco_source_plant_of(const struct eco_source *source, const struct eco_json *at);

/* One entry of "instances" with "scatter" . When it stops, the spec holds the part read so
 * far. */
void eco_scene_parse_scatter(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec);
void eco_scatter_spec_free(struct eco_scatter_spec *spec);

/* The same with "extrude". */
void eco_scene_parse_footprints(const struct eco_source *source, const struct eco_json *at,
	struct eco_footprints_spec *spec);
void eco_footprints_spec_free(struct eco_footprints_spec *spec);
/* "only" and "skip" of an entry. When it stops, they hold the part read so far. */
void eco_scene_parse_filters(const struct eco_json *at, struct eco_filter **filters, uint32_t *count);

/* One entry of "instances" with "from". When it stops, the spec holds the part read so far. */
void eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec);
void eco_positions_spec_free(struct eco_positions_spec *spec);
