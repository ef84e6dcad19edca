/* Modules (eco*.so): libraries that few scenes need, each behind a table of functions, loaded when
 * something first calls it. GDAL alone depends on more than a hundred libraries, which every program would
 * otherwise map and start at every call.
 *
 *   const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, &error);
 *   if (!gdal)
 *           return ECO_NOT_FOUND;
 *   code = gdal->rows_open(&rows, &source, &error);
 *
 * A module is looked for in the folder that ECO_MODULES names, if it is set, else beside the running
 * executable, else in the folder above (test programs lie one below), else where `make install` puts modules,
 * as seen from the executable (../lib/ecostream). It is linked with the parts of ecofiles that it needs and
 * sees nothing of the executable. The tables are plain C; each module defines its own under the name in the
 * comment. */
#pragma once

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "ecofiles/base/status.h"

#ifdef __cplusplus
extern "C" {
#endif



#define ECO_MODULES_VARIABLE "ECO_MODULES"

enum eco_module { ECO_MODULE_ASSIMP, ECO_MODULE_CAIRO, ECO_MODULE_GDAL, ECO_MODULE_IMAGE, ECO_MODULE_PROJ,
	ECO_MODULE_COUNT };

/* The module's table, loaded at the first call and kept until the program ends (libraries keep state of
 * their own). NULL: it cannot be loaded; the error is ECO_NOT_FOUND and says what was looked for, where,
 * and what to do. Thread-safe. */
const void *eco_module(enum eco_module module, struct eco_error *error);

/* The path of the module's file, as eco_module would load it; false where it is not there. */
bool eco_module_find(enum eco_module module, char path[PATH_MAX]);

/* Each table begins with this number; a table of another version is refused. Raise it whenever a table, or
 * a type that passes through one, changes. */
#define ECO_MODULE_VERSION 12u
#define ECO_MODULE_EXPORT __attribute__((visibility("default")))

/* ---- ecoassimp.so: models of formats that have no reader of their own ---- */

struct eco_model;
struct eco_model_frame;
struct eco_notes;

struct eco_assimp_module {               /* eco_assimp_module */
	uint32_t version;
	/* Positions, uv from the top left, materials, parts and images, not cleaned; triangles_in and
	 * triangles that assimp could not make are counted. Only in a guarded child. */
	enum eco_code (*read)(struct eco_model *model, struct eco_model_frame *frame,
		const char *path, uint32_t triangles_max, struct eco_notes *notes,
		struct eco_error *error);
};

/* ---- ecocairo.so: maps, and what is drawn on the ground ---- */

struct map;

struct eco_cairo_module {                /* eco_cairo_module */
	uint32_t version;
	/* Draws the map (ecopack/map.h), whose view and image are set, as a PNG in memory: free(*png). */
	enum eco_code (*map_png)(struct map *m, uint8_t **png, size_t *size);
	/* Draws a square of the ground's picture (import/land/drawing_parts.h). */
	enum eco_code (*drawing_paint)(const void *drawing, const double low[2], double texel_m, uint8_t *rgba,
		struct eco_error *error);
};

/* ---- ecogdal.so: rasters and tables with geometry ---- */

struct eco_ground_job;
struct eco_ground_image_job;
struct eco_rows;
struct eco_rows_source;
struct eco_raster;
struct eco_raster_extent;
struct eco_point_table;

struct eco_gdal_module {                 /* eco_gdal_module */
	uint32_t version;
	/* Reads all rasters of the job onto one grid (import_ground.h). Only in a guarded child. */
	enum eco_code (*ground_read)(struct eco_ground_job *job, FILE *out, struct eco_error *error);
	/* Reads the rasters of an image of the ground, square by square (import_ground.h). Only in a
	 * guarded child. */
	enum eco_code (*ground_image_read)(struct eco_ground_image_job *job, FILE *out,
		struct eco_error *error);
	/* Whether a driver of OGR other than CSV's claims the file. Only in a guarded child, as rows_open. */
	bool (*rows_knows)(const char *path);
	enum eco_code (*rows_open)(struct eco_rows **rows, const struct eco_rows_source *source,
		struct eco_error *error);
	enum eco_code (*raster_write)(const struct eco_raster *raster, const char *path,
		struct eco_error *error);
	/* As eco_raster_extent (gis_files.h). Only in a guarded child. */
	enum eco_code (*raster_extent)(const char *path, struct eco_raster_extent *extent,
		struct eco_error *error);
	/* As eco_points_write (gis_files.h). */
	enum eco_code (*points_write)(const struct eco_point_table *table, const char *path, uint8_t **bytes,
		size_t *size, struct eco_error *error);
};

/* A grid of heights, rows from the north; the first sample's centre is at (west, north). Written as
 * GeoTIFF. */
struct eco_raster {
	const float *samples;
	uint32_t side;
	double west, north, step_m;
	int epsg;
};

/* ---- ecoimage.so: pictures other than PNG (OpenImageIO) ---- */

struct eco_image_module {                /* eco_image_module */
	uint32_t version;
	/* Returns 0, or an error after writing a sentence to `text`. The result is malloc'ed.
	 * Thread-safe. `name`: a file to open when bytes is NULL, else only its extension counts. More
	 * than pixels_max pixels is an error. */
	int (*decode)(const char *name, const void *bytes, size_t size, uint64_t pixels_max, uint32_t *width,
		uint32_t *height, uint8_t **rgba, char *text, size_t text_size);
};

/* ---- ecoproj.so: coordinate reference systems ---- */

struct eco_crs_request;
struct eco_crs_path;
struct eco_crs_facts;
struct eco_crs_choice;
struct eco_crs_place;

struct eco_proj_module {                 /* eco_proj_module */
	uint32_t version;
	/* From an inventory's coordinates to the scene's CRS (crs.h): open fails for a CRS that
	 * PROJ does not know. convert writes coordinates in the scene's CRS, not yet relative to the
	 * origin; *converted is false where PROJ knows no way, and *why says why. */
	enum eco_code (*crs_open)(struct eco_crs_path **path, const struct eco_crs_request *request,
		struct eco_error *error);
	enum eco_code (*crs_convert)(struct eco_crs_path *path, double xyz[3], bool *converted,
		const char **why, struct eco_error *error);
	void (*crs_close)(struct eco_crs_path *path);
	/* As eco_crs_look and eco_crs_choices (crs.h). */
	enum eco_code (*crs_look)(const char *crs, const double xy[2], struct eco_crs_facts *facts,
		struct eco_error *error);
	enum eco_code (*crs_choices)(const double xy[2], const char *words, struct eco_crs_choice *choices,
		uint32_t *found, struct eco_error *error);
	/* As eco_crs_place (crs.h). */
	enum eco_code (*crs_place)(const char *crs, const double xy[2], struct eco_crs_place *place,
		struct eco_error *error);
	/* Places of a CRS, easting first, become longitude and latitude of WGS 84. ECO_BAD_INPUT: PROJ does
	 * not know the CRS, or a place is not on its map. */
	enum eco_code (*crs_degrees)(const char *crs, double (*places)[2], size_t count,
		struct eco_error *error);
};

#ifdef __cplusplus
}
#endif

/* Files that belong to a program: in the build tree beside its executable, installed where `make install`
 * puts them. Both are looked for from the executable's own folder, so that a tree may be moved. */

/* Writes to `path` the first of `places` in which `file` is. A place is a path from the executable's folder:
 * "", or "/" and what follows; the last one is followed by NULL. False where it is in none, or /proc is not
 * there. */
bool eco_data_path(const char *const *places, const char *file, char path[PATH_MAX]);
