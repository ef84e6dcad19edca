/* Where a raster lies and what it holds, as its file says: no sample is read. */
#ifndef ECO_RASTER_EXTENT_H
#define ECO_RASTER_EXTENT_H

#include "ecofiles/base/status.h"

/* Heights of the ground; its picture: bands of colours, or classes that have colours; or either. */
enum eco_raster_kind { ECO_RASTER_HEIGHTS, ECO_RASTER_PICTURE, ECO_RASTER_DOUBTFUL };

struct eco_raster_extent {
	double low[2], high[2];      /* in its own CRS, easting or longitude first */
	char crs[16384];             /* as WKT; "": not stated */
	enum eco_raster_kind kind;
	char bands[120];             /* what they are, as a phrase: why it is of that kind */
};

/* Reads it in a child process (guard.h). A picture without a place is an error. */
enum eco_code eco_raster_extent(const char *path, struct eco_raster_extent *extent, struct eco_error *error);

#endif
