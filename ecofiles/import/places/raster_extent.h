/* Where a raster lies, as its file says: no sample is read. */
#ifndef ECO_RASTER_EXTENT_H
#define ECO_RASTER_EXTENT_H

#include "ecofiles/base/status.h"

struct eco_raster_extent {
	double low[2], high[2];      /* in its own CRS, easting or longitude first */
	char crs[16384];             /* as WKT; "": not stated */
};

/* Reads it in a child process (guard.h). A picture without a place is an error. */
enum eco_code eco_raster_extent(const char *path, struct eco_raster_extent *extent, struct eco_error *error);

#endif
