/* The ground: a grid of heights under a scene, read from a raster.
 *
 *   eco_ground_import(&ground, &options, &error);   any raster GDAL opens -> samples in scene metres
 *   eco_ground_height(&ground, x, y, &z);           where a plant stands
 *   eco_ground_free(&ground);
 *
 * Sample (c, r) is the height at x = x_m + c * step_x_m, y = y_m + r * step_y_m: the centre of a raster's pixel. A cell between
 * four samples is two triangles along the diagonal from its south-west to its north-east corner, in pictures and in heights, so
 * that nothing floats. */
#ifndef ECO_GROUND_H
#define ECO_GROUND_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/status.h"

#define ECO_GROUND_SIDE_MAX 4096u

struct eco_ground {
	uint32_t columns, rows;      /* >= 2 each */
	double x_m, y_m;             /* the south-west sample, metres from the scene's origin */
	double step_x_m, step_y_m;   /* > 0 */
	float *height_m;             /* columns * rows, row by row from the south-west, minus the origin's z; owned */
	uint64_t filled;             /* samples the raster did not have, filled from their neighbours */
};

struct eco_ground_options {
	const char *path;
	const char *crs;             /* of the raster; NULL: as the file says */
	const char *scene_crs;       /* NULL: the raster's coordinates are scene metres plus origin */
	double origin[3];            /* of the scene, in its CRS */
	uint32_t side_max;           /* columns and rows at most; 0: ECO_GROUND_SIDE_MAX. A larger raster is averaged down */
	void (*warn)(void *ctx, const char *text);   /* may be NULL; one sentence per call */
	void *ctx;
};

/* Reads band 1 (scale and offset applied). A raster in another CRS, or one that is rotated, is resampled into the scene's
 * CRS, bilinearly, at about its own resolution. NODATA, values that are not finite or beyond 100 km are filled from their neighbours
 * and counted. The raster is read in a child process with limits (guard.h). Errors name the file and say what to add. */
enum eco_code eco_ground_import(struct eco_ground *ground, const struct eco_ground_options *options, struct eco_error *error);

/* Height at (x, y) in *z, exactly on the triangles above. Outside the grid: the height of the nearest point of its border, and
 * false. */
bool eco_ground_height(const struct eco_ground *ground, double x, double y, double *z);
void eco_ground_free(struct eco_ground *ground);

#endif
