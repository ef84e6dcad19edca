/* The ground: a grid of heights under a scene, read from rasters.
 *
 *   eco_ground_import(&ground, &options, &error);   any rasters GDAL opens -> samples in scene metres
 *   eco_ground_height(&ground, x, y, &z);           where a plant stands
 *   eco_ground_free(&ground);
 */
#ifndef ECO_GROUND_H
#define ECO_GROUND_H

#include "ecofiles/base/status.h"
#include "ecofiles/format/heights.h"

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
	bool keep_missing;           /* missing samples stay NaN, datums are ignored: not heights */
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

#endif
