/* Plants as a table with points, for a GIS: GeoPackage or GeoJSON. */
#ifndef ECO_POINT_TABLE_H
#define ECO_POINT_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct eco_point {
	double at[2];                /* in the table's CRS, easting first */
	/* species: "": none is stated; plant: as the scene names what is shown; file: "": the scene itself */
	const char *species, *plant, *file;
	double height_m;             /* 0: not known */
	uint64_t row, line;          /* of the file, from 1; 0: none */
};

struct eco_point_table {
	const char *name;            /* of the layer */
	const char *crs;             /* NULL: plain metres */
	uint64_t count;
	void (*point)(void *ctx, uint64_t index, struct eco_point *point);
	void *ctx;
};

/* Whether a path's extension is that of such a table: .gpkg, .geojson. */
bool eco_points_knows(const char *path);

/* The file's content, malloc'ed, in the format of the path's extension. GeoJSON is longitude and latitude of
 * WGS 84 (RFC 7946) where there is a CRS; what is not known is null. ECO_BAD_INPUT: a CRS that GDAL does not
 * know. */
enum eco_code eco_points_write(const struct eco_point_table *table, const char *path, uint8_t **bytes,
	size_t *size, struct eco_error *error);

#endif
