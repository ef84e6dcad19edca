/* The CRS of a CityGML file (rows_citygml_crs.c): what a srsName means, and which of its two axes comes first. Not for others. */
#ifndef ECO_ROWS_CITYGML_H
#define ECO_ROWS_CITYGML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ECO_CITYGML_SAMPLES 64u

struct eco_citygml_crs {
	char name[256];              /* srsName as written; of the plants, else of the model */
	char code[256];              /* as PROJ knows it, "" unknown */
	bool of_plants;
	bool as_authority;           /* a URN or URI: axes in the authority's order; else easting or longitude first */
	bool swapped;                /* northing or latitude comes first */
	double seen[ECO_CITYGML_SAMPLES][2];
	uint32_t seen_count;
};

/* A srsName of the model or of a plant, which counts more. False if plants name two that differ. */
bool eco_citygml_crs_name(struct eco_citygml_crs *crs, const char *name, bool of_plant);
/* A place, as written. */
void eco_citygml_crs_see(struct eco_citygml_crs *crs, const double at[3]);
/* Decides `swapped`: where only one order puts the places into the CRS's area of use, it is that; else as the form of the srsName
 * says. What is odd is written into note ("" if nothing). */
void eco_citygml_crs_settle(struct eco_citygml_crs *crs, char *note, size_t size);

#endif
