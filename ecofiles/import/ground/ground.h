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

/* "ground" in a scene file: what is stated here wins over what the files say. */
struct eco_ground_source {
	char **heights; uint32_t height_count;   /* paths; where several have a height, the first counts */
	char *crs, *vertical;        /* NULL: as the files say */
	uint32_t band;               /* from 1; 0 is 1 */
	/* height = (value * scale + offset) * unit_m; what is 0 or not there is as the files say, else 1, 0 and 1 */
	double scale, offset, unit_m;
	double nodata;               /* value that is no height, beside what the files say */
	bool has_offset, has_nodata; /* without: what stands out as a hole is looked for */
	bool no_holes;               /* every value is a height */
	bool has_place;              /* of a picture without coordinates: */
	double corner[2], pixel[2];  /* x, y of the outer north-west corner and size of a pixel, in `crs` */
};

struct eco_ground_options {
	const struct eco_ground_source *source;
	const char *scene_crs;       /* NULL: the rasters' coordinates are scene metres plus origin */
	const char *scene_vertical;  /* datum of the scene's heights; NULL: not stated */
	double origin[3];            /* of the scene, in its CRS */
	uint32_t side_max;           /* columns and rows at most; 0: ECO_GROUND_SIDE_MAX. What is larger is averaged down */
	bool keep_missing;           /* what is no height stays NaN, and datums do not matter: a raster of something else */
	void (*warn)(void *ctx, const char *text);   /* may be NULL; one sentence per call */
	void *ctx;
};

/* Rasters in another CRS, or rotated, are resampled into the scene's CRS, bilinearly, at about their own resolution; several become one
 * grid of the finest resolution among them. Files are read row by row. No height are: NODATA and masks; values that are not finite or
 * beyond 100 km; and a constant that stands out from all around it as no terrain does (0, -9999, ...), which is said. They are filled
 * from their neighbours and counted. The rasters are read in a child process with limits (guard.h). Errors name the file and say
 * what to add. */
enum eco_code eco_ground_import(struct eco_ground *ground, const struct eco_ground_options *options, struct eco_error *error);

/* Gives samples that are NaN the mean of their neighbours, ring by ring from the known ones inwards; counts them in ground->filled. The
 * result depends on no order. ECO_BAD_INPUT if there is no height at all. */
enum eco_code eco_ground_fill(struct eco_ground *ground, struct eco_error *error);

#endif
