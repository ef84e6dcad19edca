/* ecogdal.so: the part of this system that calls GDAL. */
#include "ecofiles/import/ground/gdal_module.h"

ECO_MODULE_EXPORT const struct eco_gdal_module eco_gdal_module = {
	.version = ECO_MODULE_VERSION, .ground_read = gdal_ground_read,
		.ground_image_read = gdal_image_read, .rows_knows = gdal_rows_knows,
		.rows_open = gdal_rows_open,
	.raster_write = gdal_raster_write, .raster_extent = gdal_raster_extent,
	.points_write = gdal_points_write,
};
