/* From an inventory's coordinates to the scene's, by PROJ (proj_crs.c) where they are not the same metres already: easting or
 * longitude always first, and heights between vertical datums.
 *
 *   eco_crs_open(&crs, &request, &error);            checks what can be checked without a coordinate
 *   eco_crs_convert(crs, xyz, &error);               for each place
 *   eco_crs_close(crs); */
#ifndef ECO_POSITIONS_CRS_H
#define ECO_POSITIONS_CRS_H

#include <stdbool.h>

#include "ecofiles/import/places/positions.h"

struct eco_crs_request {
	const char *path;            /* for messages */
	const char *stated, *vertical;       /* by the entry; win */
	const char *of_file;         /* by the file, NULL where it does not say */
	const char *no_crs_says;     /* after "its CRS is not stated", may be NULL */
	bool local;                  /* places count from the scene's origin if `stated` is NULL */
	bool use_z;                  /* heights are converted too, so their datums matter */
	const struct eco_frame *frame;
	void (*note)(void *ctx, const char *format, ...) __attribute__((format(printf, 2, 3)));
	void *ctx;
};

struct eco_crs;

/* The request's frame must outlive the conversion, the rest need not. */
enum eco_code eco_crs_open(struct eco_crs **crs, const struct eco_crs_request *request, struct eco_error *error);
/* To metres from the origin, x and y (z with use_z) to the millimetre where they were converted. *converted is false where PROJ knows
 * no way; *why says why. Fails only on the first place, for a grid that PROJ lacks. */
enum eco_code eco_crs_convert(struct eco_crs *crs, double xyz[3], bool *converted, const char **why, struct eco_error *error);
void eco_crs_close(struct eco_crs *crs);

/* For messages: a code as it is, the name in quotes of WKT. Malloc'ed; NULL when memory ran out. */
char *eco_crs_short_name(const char *crs);

#endif
