#include "tests/support/raster_files.h"

#include <ogr_srs_api.h>

#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

static void write_band(GDALDatasetH file, const struct raster_file *r, int number)
{
	GDALRasterBandH band = GDALGetRasterBand(file, number + 1);
	double *row = malloc((size_t)r->columns * sizeof *row);
	if (r->palette) {
		GDALColorTableH table = GDALCreateColorTable(GPI_RGB);
		for (int i = 0; i < 5; i++)
			GDALSetColorEntry(table, i, &(GDALColorEntry){ (short)(50 * i), 10, 20, 255 });
		GDALSetRasterColorTable(band, table);
		GDALDestroyColorTable(table);
	}
	if (number == 3)
		GDALSetRasterColorInterpretation(band, GCI_AlphaBand);
	if (r->has_nodata)
		GDALSetRasterNoDataValue(band, r->nodata);
	if (r->scale) {
		GDALSetRasterScale(band, r->scale);
		GDALSetRasterOffset(band, r->offset);
	}
	if (r->unit)
		GDALSetRasterUnitType(band, r->unit);
	for (int y = 0; y < r->rows; y++) {
		for (int x = 0; x < r->columns; x++)
			row[x] = r->sample(r, x, y, number);
		assert_int_equal(GDALRasterIO(band, GF_Write, 0, y, r->columns, 1, row, r->columns, 1, GDT_Float64, 0, 0),
			CE_None);
	}
	free(row);
}

const char *raster_file_write(const char *folder, const struct raster_file *r)
{
	const char *path = input_path(folder, r->name);
	bool png = strstr(r->name, ".png") != NULL;
	int bands = r->bands ? r->bands : 1;
	GDALAllRegister();
	remove(path);
	GDALDatasetH file = GDALCreate(GDALGetDriverByName(png ? "MEM" : "GTiff"), path, r->columns, r->rows,
		bands, r->type, NULL);
	assert_non_null(file);
	if (r->place)
		GDALSetGeoTransform(file, (double *)r->place);
	if (r->crs) {
		OGRSpatialReferenceH reference = OSRNewSpatialReference(NULL);
		OSRSetFromUserInput(reference, r->crs);
		GDALSetSpatialRef(file, reference);
		OSRDestroySpatialReference(reference);
	}
	for (int b = 0; b < bands; b++)
		write_band(file, r, b);
	if (png)
		GDALClose(GDALCreateCopy(GDALGetDriverByName("PNG"), path, file, FALSE, NULL, NULL, NULL));
	GDALClose(file);
	return path;
}
