#include "ecofiles/import/places/gis_files.h"

#include <math.h>
#include <string.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/base/module.h"
#include "ecofiles/import/ground/ground.h"

static enum eco_code work(void *path, FILE *out, struct eco_error *error)
{
	struct eco_raster_extent extent;
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	memset(&extent, 0, sizeof extent);
	ECO_PASS(!gdal ? ECO_NOT_FOUND : gdal->raster_extent(path, &extent, error));
	return fwrite(&extent, sizeof extent, 1, out) != 1 ? eco_fail(error, ECO_IO, "nobody reads on") : ECO_OK;
}

enum eco_code eco_raster_extent(const char *path, struct eco_raster_extent *extent, struct eco_error *error)
{
	FILE *result = NULL;
	enum eco_code code = eco_raster_file_check(path, error);
	struct eco_guard_limits limits = eco_raster_limits(&path, 1);
	if (!code)
		code = eco_guard_run(work, (void *)path, path, &limits, &result, error);
	if (code)
		return code;
	bool good = fread(extent, sizeof *extent, 1, result) == 1;
	fclose(result);
	extent->crs[sizeof extent->crs - 1] = 0;
	extent->bands[sizeof extent->bands - 1] = 0;
	good = good && extent->kind <= ECO_RASTER_DOUBTFUL;
	for (int k = 0; k < 2; k++)
		good = good && isfinite(extent->low[k]) && isfinite(extent->high[k])
			&& extent->low[k] < extent->high[k];
	return good ? ECO_OK : eco_fail(error, ECO_DAMAGED, "%.300s: it has no extent", path);
}

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
