#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <math.h>
#include <ogr_srs_api.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/ground/gdal_module.h"
#include "ecofiles/import/places/raster_extent.h"

static void measure(GDALDatasetH file, const double transform[6], struct eco_raster_extent *extent)
{
	double columns = GDALGetRasterXSize(file), rows = GDALGetRasterYSize(file);
	for (int k = 0; k < 2; k++) {
		extent->low[k] = INFINITY;
		extent->high[k] = -INFINITY;
		for (int corner = 0; corner < 4; corner++) {
			double at = transform[3 * k] + transform[3 * k + 1] * (corner & 1 ? columns : 0)
				+ transform[3 * k + 2] * (corner & 2 ? rows : 0);
			extent->low[k] = fmin(extent->low[k], at);
			extent->high[k] = fmax(extent->high[k], at);
		}
	}
}

/* A CRS too long to keep is as good as none: the user will be asked. */
static void copy_crs(GDALDatasetH file, char *text, size_t size)
{
	OGRSpatialReferenceH own = GDALGetSpatialRef(file);
	const char *const options[] = { "FORMAT=WKT2_2019", NULL };
	char *wkt = NULL;
	text[0] = 0;
	if (own && (OSRIsProjected(own) || OSRIsGeographic(own)) && OSRExportToWktEx(own, &wkt, options)
			== OGRERR_NONE && strlen(wkt) < size)
		snprintf(text, size, "%s", wkt);
	CPLFree(wkt);
}

/* One band of finer or larger numbers than bytes are heights; three and more, or a table of colours, are a
 * picture. One band of bytes may be either: grey, whole metres, or classes without colours. */
static void find_kind(GDALDatasetH file, struct eco_raster_extent *extent)
{
	int count = GDALGetRasterCount(file), alpha = 0;
	GDALRasterBandH first = GDALGetRasterBand(file, 1);
	GDALDataType type = first ? GDALGetRasterDataType(first) : GDT_Unknown;
	bool named = false;
	for (int b = 1; b <= count; b++) {
		GDALColorInterp is = GDALGetRasterColorInterpretation(GDALGetRasterBand(file, b));
		alpha += is == GCI_AlphaBand;
		named = named || is == GCI_RedBand;
	}
	count -= alpha;
	bool table = first && GDALGetRasterColorTable(first);
	extent->kind = (table && count == 1) || (count >= 3 && (named || type == GDT_Byte || type == GDT_UInt16))
		? ECO_RASTER_PICTURE
		: count == 1 && type != GDT_Byte && !GDALDataTypeIsComplex(type) ? ECO_RASTER_HEIGHTS
		: ECO_RASTER_DOUBTFUL;
	snprintf(extent->bands, sizeof extent->bands, "it has %d band%s of %s%s%s", count, count == 1 ? "" : "s",
		GDALGetDataTypeName(type), table ? " with a table of colours" : "", alpha ? " and alpha" : "");
}

enum eco_code gdal_raster_extent(const char *path, struct eco_raster_extent *extent, struct eco_error *error)
{
	double transform[6];
	GDALAllRegister();
	CPLPushErrorHandler(CPLQuietErrorHandler);
	GDALDatasetH file = GDALOpen(path, GA_ReadOnly);
	enum eco_code code = ECO_OK;
	if (!file)
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: no raster that GDAL opens: %.200s", path,
			CPLGetLastErrorMsg());
	else if (GDALGetGeoTransform(file, transform) != CE_None)
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: the raster does not say where it lies; make a "
			"GeoTIFF of it, or start without it and add \"ground\" with \"north_west\" and "
			"\"pixel\" to the scene", path);
	else
		measure(file, transform, extent);
	if (!code)
		copy_crs(file, extent->crs, sizeof extent->crs);
	if (!code)
		find_kind(file, extent);
	if (file)
		GDALClose(file);
	CPLPopErrorHandler();
	return code;
}
