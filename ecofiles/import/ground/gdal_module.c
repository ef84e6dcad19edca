/* ecogdal.so: the part of this system that calls GDAL. Its functions, and heights to a GeoTIFF. */
#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include "ecofiles/import/ground/gdal_module.h"

static enum eco_code write_samples(GDALDatasetH file, const struct eco_raster *r, const char *wkt,
	const char *path, struct eco_error *error)
{
	/* a GeoTIFF's place is the outer corner of its first pixel */
	double transform[6] = { r->west - r->step_m / 2, r->step_m, 0, r->north + r->step_m / 2, 0,
		-r->step_m };
	int side = (int)r->side;
	GDALSetGeoTransform(file, transform);
	GDALSetProjection(file, wkt);
	if (GDALRasterIO(GDALGetRasterBand(file, 1), GF_Write, 0, 0, side, side, (void *)r->samples, side,
			side, GDT_Float32, 0, 0) != CE_None)
		return eco_fail(error, ECO_IO, "%s: %s", path, CPLGetLastErrorMsg());
	return ECO_OK;
}

enum eco_code gdal_raster_write(const struct eco_raster *raster, const char *path, struct eco_error *error)
{
	OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
	char *wkt = NULL;
	GDALDatasetH file;
	enum eco_code code;
	GDALAllRegister();
	GDALDriverH driver = GDALGetDriverByName("GTiff");
	if (!driver || OSRImportFromEPSG(crs, raster->epsg) != OGRERR_NONE || OSRExportToWkt(crs, &wkt)
			!= OGRERR_NONE) {
		code = eco_fail(error, ECO_NOT_FOUND, "GDAL cannot write GeoTIFF in EPSG:%d: is proj-data "
			"installed?", raster->epsg);
	} else if (!(file = GDALCreate(driver, path, (int)raster->side, (int)raster->side, 1, GDT_Float32,
			NULL))) {
		code = eco_fail(error, ECO_IO, "%s: %s", path, CPLGetLastErrorMsg());
	} else {
		code = write_samples(file, raster, wkt, path, error);
		GDALClose(file);
	}
	CPLFree(wkt);
	OSRDestroySpatialReference(crs);
	return code;
}

ECO_MODULE_EXPORT const struct eco_gdal_module eco_gdal_module = {
	.version = ECO_MODULE_VERSION, .ground_read = gdal_ground_read,
		.ground_image_read = gdal_image_read, .rows_knows = gdal_rows_knows,
		.rows_open = gdal_rows_open,
	.raster_write = gdal_raster_write, .raster_extent = gdal_raster_extent,
	.points_write = gdal_points_write,
};
