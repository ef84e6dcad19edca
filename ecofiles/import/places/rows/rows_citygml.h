/* Inside the reader of CityGML: where a plant stands in the coordinates of its file (rows_citygml_shape.c),
 * and what these mean (rows_citygml_crs.c). Not for others. */
#ifndef ECO_ROWS_CITYGML_H
#define ECO_ROWS_CITYGML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- Shape ---- */

#define ECO_CITYGML_POINTS_MAX (1u << 22)

struct eco_citygml_shape {       /* zero to begin with; whoever has it frees points */
	double (*points)[3];
	uint32_t count, capacity;
	double reference[3], matrix[16];     /* of an implicit geometry */
	bool has_reference, has_matrix;
};

void eco_citygml_shape_begin(struct eco_citygml_shape *shape);
/* Takes the coordinates in a text, of so many dimensions (other than 2 or 3: as their number suggests), as
 * points of the geometry or as the reference point, of which the first counts. False when there are too many.
 */
bool eco_citygml_shape_read(struct eco_citygml_shape *shape, const char *text, int dimension, bool reference);
void eco_citygml_shape_matrix(struct eco_citygml_shape *shape, const char *text);
/* Where it stands, with NaN for an unknown height; *yaw_deg is set where a matrix turns it. False: nowhere.
 */
bool eco_citygml_shape_place(const struct eco_citygml_shape *shape, double at[3], double *yaw_deg);

/* ---- CRS: what a srsName means, and which of its two axes comes first ---- */

#define ECO_CITYGML_SAMPLES 64u

struct eco_citygml_crs {
	char name[256];              /* srsName as written; of the plants, else of the model */
	char code[256];              /* as PROJ knows it, "" unknown */
	bool of_plants;
	/* a URN or URI: axes in the authority's order; else easting or longitude first */
	bool as_authority;
	bool swapped;                /* northing or latitude comes first */
	double seen[ECO_CITYGML_SAMPLES][2];
	uint32_t seen_count;
};

/* A srsName of the model or of a plant, which counts more. False if plants name two that differ. */
bool eco_citygml_crs_name(struct eco_citygml_crs *crs, const char *name, bool of_plant);
/* A place, as written. */
void eco_citygml_crs_see(struct eco_citygml_crs *crs, const double at[3]);

#endif
