/* The ground: a grid of heights under a scene, read from rasters, or laid through its plants.
 *
 *   eco_ground_import(&ground, &options, &error);   any rasters GDAL opens -> samples in scene metres
 *   eco_ground_through(&ground, &feet);             or, without rasters
 *   eco_ground_extend(&ground);                     beyond its border, to the horizon
 *   eco_ground_height(&ground, x, y, &z);           where a plant stands
 *   eco_ground_free(&ground); */
#pragma once

#include "ecofiles/base/guard.h"
#include "ecofiles/base/status.h"
#include "ecofiles/format/heights.h"
#include "ecofiles/format/pack.h"

#define ECO_GROUND_FILES_MAX 1024u

/* "ground" of a scene file: statements here win over those of the files. */
struct eco_ground_source {
	char **heights; uint32_t height_count;   /* paths; where several have a height, the first counts */
	char *crs, *vertical;        /* NULL: from the files */
	uint32_t band;               /* from 1; 0 is 1 */
	/* height = (value * scale + offset) * unit_m. Absent: from the file, else 1, 0 and 1; scale and
	 * unit_m: 0 is absent */
	double scale, offset, unit_m;
	double nodata;               /* a value that is no height, beside the files' own */
	bool has_offset, has_nodata; /* has_nodata false: looks for values that stand out as holes */
	bool no_holes;               /* every value is a height */
	bool none;                   /* "ground": null: not even one through the plants */
	bool has_place;              /* for a picture without coordinates: */
	double corner[2], pixel[2];  /* x, y of the outer north-west corner, and size of a pixel, in `crs` */
};

struct eco_ground_options {
	const struct eco_ground_source *source;
	const char *scene_crs;       /* NULL: the rasters' coordinates are scene metres plus origin */
	const char *scene_vertical;  /* datum of the scene's heights; NULL: not stated */
	double origin[3];            /* of the scene, in its CRS */
	/* most columns and rows; 0: ECO_GROUND_SIDE_MAX; more are averaged down */
	uint32_t side_max;
	void (*warn)(void *ctx, const char *text);   /* may be NULL; one sentence per call */
	void *ctx;
};

/* Reads rasters into one grid. A raster in another CRS, or rotated, is resampled into the scene's CRS,
 * bilinearly, at about its own resolution; several become one grid of the finest resolution among them.
 * Files are read row by row. Samples without a height are NODATA and masks, values that are not finite or
 * beyond 100 km, and a constant that stands out as no terrain does (0, -9999, ...), which is reported.
 * They are filled from their neighbours and counted. The rasters are read in a child process with limits
 * (guard.h). Errors name the file and say what to add. */
enum eco_code eco_ground_import(struct eco_ground *ground, const struct eco_ground_options *options,
	struct eco_error *error);

/* Gives samples that are NaN the mean of their neighbours, ring by ring from the known ones inwards, and
 * counts them in ground->filled. The result does not depend on the order of samples. ECO_BAD_INPUT if
 * there is no height at all. */
enum eco_code eco_ground_fill(struct eco_ground *ground, struct eco_error *error);

/* Adds margins (heights.h): at the border the heights of the ground, graded to their mean towards the
 * horizon, 131 km away or more. Not twice; at most ECO_GROUND_INSIDE_MAX samples a side. */
#define ECO_GROUND_INSIDE_MAX (ECO_GROUND_SIDE_MAX - 2 * ECO_GROUND_MARGIN_MAX)
void eco_ground_extend(struct eco_ground *ground);

/* Points on the ground, metres from the scene's origin, and a box around them that the ground shall cover. */
struct eco_ground_feet { const double (*at)[3]; uint32_t count; double low[2], high[2]; };

/* Ground that goes through at least one point, to a centimetre; a plane if that does. Points at other heights
 * than their neighbours may be further off: its cells are at least 25 cm wide, and at most 512 x 512. */
void eco_ground_through(struct eco_ground *ground, const struct eco_ground_feet *feet);

/* Refuses what no reader reads: files that are not there, empty, packed, pointers of Git LFS, web pages. */
enum eco_code eco_raster_file_check(const char *path, struct eco_error *error);
/* Limits for reading rasters: memory is small where one of them unpacks (guard.h). */
struct eco_guard_limits eco_raster_limits(const char *const *paths, uint32_t count);
