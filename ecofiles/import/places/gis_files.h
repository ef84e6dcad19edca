/* Files of a GIS beside inventories: where a raster lies, and plants as a table with points. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* Heights of the ground; its picture: bands of colours, or classes that have colours; or either. */
enum eco_raster_kind { ECO_RASTER_HEIGHTS, ECO_RASTER_PICTURE, ECO_RASTER_DOUBTFUL };

struct eco_raster_extent {
	double low[2], high[2];      /* in its own CRS, easting or longitude first */
	char crs[16384];             /* as WKT; "": not stated */
	enum eco_raster_kind kind;
	char bands[120];             /* what they are, as a phrase: why it is of that kind */
};

static inline bool eco_raster_extent_has(const struct eco_raster_extent *e, const double at[2])
{
	return at[0] >= e->low[0] && at[0] <= e->high[0] && at[1] >= e->low[1] && at[1] <= e->high[1];
}

/* Reads it in a child process (guard.h). A picture without a place is an error. */
enum eco_code eco_raster_extent(const char *path, struct eco_raster_extent *extent, struct eco_error *error);

struct eco_point {
	double at[2];                /* in the table's CRS, easting first */
	/* species: "": none is stated; plant: as the scene names what is shown; file: "": the scene itself */
	const char *species, *plant, *file;
	const char *class;           /* of a tint; "": none */
	double height_m, crown_m;    /* crown: its diameter; 0: not known */
	uint64_t row, line;          /* of the file, from 1; 0: none */
};

struct eco_shape {               /* rings, by the even-odd rule, then lines; of a building or a class of the ground */
	const double *ends; uint32_t ring_edges, edge_count; /* x0, y0, x1, y1 an edge, from `origin` of the table's */
	const char *object, *class, *file;
	double height_m;             /* 0: none */
};

struct eco_point_table {
	const char *name;            /* of the layer */
	const char *crs;             /* NULL: plain metres */
	bool has_classes;            /* a column of them */
	uint64_t count;
	void (*point)(void *ctx, uint64_t index, struct eco_point *point);
	void *ctx;
	/* objects and ground beside the plants, which then have a column "object" */
	const struct eco_shape *shapes; uint64_t shape_count;
	double origin[2];
};

/* Whether a path's extension is that of such a table: .gpkg, .geojson. */
bool eco_points_knows(const char *path);

/* The file's content, malloc'ed, in the format of the path's extension. GeoJSON is longitude and latitude of
 * WGS 84 (RFC 7946) where there is a CRS; what is not known is null. ECO_BAD_INPUT: a CRS that GDAL does not
 * know. */
enum eco_code eco_points_write(const struct eco_point_table *table, const char *path, uint8_t **bytes,
	size_t *size, struct eco_error *error);
