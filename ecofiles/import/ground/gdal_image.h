/* Inside ecogdal.so: the colours of one raster. */
#ifndef ECO_GDAL_IMAGE_H
#define ECO_GDAL_IMAGE_H

#include "ecofiles/import/ground/gdal_ground.h"
#include "ecofiles/import/ground/import_ground_image.h"

struct ground_colors {
	struct ground_raster raster;
	GDALDatasetH own;            /* what raster.file shows elsewhere; or NULL */
	bool by_class;               /* numbers of classes; else colours */
	bool by_range;               /* colours of numbers from range[0], black, to range[1], white */
	double range[2];
	int bands[3], alpha;         /* red, green, blue; alpha, 0: none */
	struct eco_ground_class *classes;
	uint32_t class_count; /* ascending; the scene's and the file's */
	bool has_nodata;
	double nodata;
};

/* Finds out what an opened raster shows; its CRS and place need not be known. `range`, black and white of
 * bands that are no bytes, is guessed and noted where it is empty, and then holds for all rasters. */
enum eco_code ground_colors_open(struct ground_colors *colors, const struct eco_ground_image_source *source,
	double range[2], struct ground_notes *notes, struct eco_error *error);
/* Puts a raster whose place was found where the scene says. */
enum eco_code ground_colors_locate(struct ground_colors *colors, const struct eco_ground_image_source *source,
	struct eco_error *error);
/* Closes the raster, too. */
void ground_colors_close(struct ground_colors *colors);

/* What it shows of a square of ECO_GROUND_IMAGE_SIDE texels a side: west, south, east, north in the scene's
 * CRS; rows from the north. */
enum eco_code ground_colors_read(const struct ground_colors *colors, const struct ground_scene *scene,
	const double bounds[4], uint8_t *rgba, struct eco_error *error);

#endif
