/* Rasters for tests, from a function of the sample's place. */
#pragma once

#include <gdal.h>
#include <stdbool.h>

struct raster_file {
	const char *name;                    /* a PNG if it ends so, else a GeoTIFF */
	int columns, rows, bands;            /* bands 0: 1; the fourth is alpha */
	GDALDataType type;
	/* from the north-western corner; `of` is the function's own */
	double (*sample)(const struct raster_file *r, int x, int y, int band), of;
	const double *place;                 /* six numbers of GDAL; NULL: none */
	const char *crs, *unit;              /* NULL: none */
	double scale, offset;                /* of stored numbers; scale 0: neither */
	bool has_nodata, palette;            /* palette: colours (50 i, 10, 20) */
	double nodata;
};

/* Path of the file, which is written below build/tmp/FOLDER. */
const char *raster_file_write(const char *folder, const struct raster_file *r);
