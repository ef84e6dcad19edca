#include "ecofiles/import/places/point_table.h"

#include <string.h>

#include "ecofiles/base/module.h"

bool eco_points_knows(const char *path)
{
	const char *dot = strrchr(path, '.');
	return dot && (strcmp(dot, ".gpkg") == 0 || strcmp(dot, ".geojson") == 0);
}

enum eco_code eco_points_write(const struct eco_point_table *table, const char *path, uint8_t **bytes,
	size_t *size, struct eco_error *error)
{
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	return !gdal ? ECO_NOT_FOUND : gdal->points_write(table, path, bytes, size, error);
}
