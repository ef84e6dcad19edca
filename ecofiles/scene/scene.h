/* The scene source: SCENE.json, as written by people and scripts (every field, unit and default:
 * ecofiles/README.md).
 *
 *   eco_sources_load(&sources, "scene.json", &error);      the file and all files it nests, each once
 *   for each plant of each source                          eco_model_import(source.plants[i].models)
 *   for each source.instances                              plants one by one
 *   for each source.positions                              eco_positions_open, eco_positions_next
 *                                                          (positions.h)
 *   for each source.children                               sources.items[child.source], placed
 *   eco_sources_free(&sources);
 *
 * Everything is checked when it is read: types, ranges, names, files, cycles. Errors say FILE:LINE:COLUMN. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/generate/library.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/import/places/positions.h"
#include "ecofiles/import/land/drawing.h"
#include "ecofiles/import/land/footprints.h"
#include "ecofiles/import/land/scatter.h"
#include "ecofiles/base/status.h"

#define ECO_SOURCE_BYTES_MAX (64u << 20)
#define ECO_SOURCES_MAX 4096u
#define ECO_TILE_INSTANCES 128u          /* default of "tile": {"instances": N} */

/* A plant with several variants is several of these in a row, with one name: files, or sizes of a plant of
 * the library, each in all its individuals. An instance takes one of them, by a hash of its position in the
 * file, and of the library the size that is nearest to its own. References name the first variant; the
 * records and instances handed out name the one taken. */
struct eco_source_plant {
	char name[64];
	/* paths of the files that make up one plant, resolved against the file that names them */
	char **models; uint32_t model_count; /* 0: a plant of the library */
	struct eco_library_plant library;
	double height_m;                     /* height to which the model is scaled; 0: by its unit */
	double unit_m;                       /* metres per unit of the files; 0: theirs, else guessed */
	enum eco_up up;
	bool keep_origin;                    /* no foot is looked for: it is the point `foot` of the file, Z up */
	double foot[3];
	bool grade;                          /* foliage is darkened to what leaves reflect */
	bool object;                         /* no plant, such as a building (ecofiles/format/model.h) */
	struct eco_part_rule *parts; uint32_t part_count;    /* owned by the first variant, shared by all */
	float importance[ECO_ORGAN_COUNT];   /* organs not given: 1; all 0: none given, chosen by colours */
	uint32_t variant, variant_count;     /* 0..variant_count-1 */
};

struct eco_source_instance {
	uint32_t plant;
	double at[3];                        /* metres from the file's origin, z above the ground */
	double yaw_deg, scale;
	/* NaN: `scale` alone; else scale * height_m / the plant's height as imported */
	double height_m;
};

struct eco_source_child {
	uint32_t source;                     /* in eco_sources.items; ECO_NONE after eco_source_parse */
	char *eco;                           /* path */
	double at[3], yaw_deg, scale;
};

struct eco_source {
	char *path;                          /* as opened */
	char name[64];
	char *crs;                           /* NULL: none, coordinates are plain metres */
	double origin[3];
	double importance;                   /* factor of its own plants' importances */
	enum eco_season season;              /* of plants of the library that state none */
	char *vertical;                      /* datum of all heights; NULL: not stated */
	char *date;                          /* of the inventory, for captions; NULL: not stated */
	struct eco_ground_image_source ground_image;         /* file_count 0: none; as ground */
	struct eco_draw_spec *draws; uint32_t draw_count;    /* files drawn on the ground; as ground */
	struct eco_ground_source ground;     /* height_count 0: none. Only the outermost file has ground */
	uint32_t tile_instances;             /* a tile is split above this many */
	struct eco_source_plant *plants;                uint32_t plant_count;
	uint32_t *plants_by_name;            /* indices of first variants, sorted by name; name_count */
	uint32_t name_count;
	bool on_disk;                        /* whether named files were looked for */
	struct eco_source_instance *instances;          uint32_t instance_count;
	struct eco_positions_spec *positions;           uint32_t positions_count;
	struct eco_scatter_spec *scatters;              uint32_t scatter_count;
	struct eco_footprints_spec *footprints;         uint32_t footprints_count;
	struct eco_source_child *children;              uint32_t child_count;
};

/* [0] is the outermost file; a child's index is always greater than that of every file that names it. */
struct eco_sources {
	struct eco_source *items;
	uint32_t count;
};

enum eco_code eco_sources_load(struct eco_sources *sources, const char *path, struct eco_error *error);
void eco_sources_free(struct eco_sources *sources);

/* Parses one document from memory; `path` is its name in messages and the base of its relative paths. Looks
 * for the files that it names if it is `on_disk`; else touches no file. */
enum eco_code eco_source_parse(struct eco_source *source, const char *json, size_t size, const char *path,
	bool on_disk, struct eco_error *error);
void eco_source_free(struct eco_source *source);

/* The frame that inventories are converted to; lives as long as the source. */
struct eco_frame eco_source_frame(const struct eco_source *source);

#define ECO_UNITS "m, dm, cm, mm, in, ft, US survey ft"
/* Metres in the unit of that name; false: no such unit. */
bool eco_unit_metres(const char *name, double *metres);
/* "x", "y" or "z". */
bool eco_up_of(const char *name, enum eco_up *up);
