/* From an inventory's coordinates to the scene's: easting or longitude always first, and heights between
 * vertical datums. PROJ (proj_crs.c) converts, unless they are the same metres already.
 *
 *   eco_crs_open(&crs, &request, &error);            checks what can be checked without a coordinate
 *   eco_crs_convert(crs, xyz, &error);               for each place
 *   eco_crs_close(crs); */
#ifndef ECO_POSITIONS_CRS_H
#define ECO_POSITIONS_CRS_H

#include <stdbool.h>

#include "ecofiles/import/places/crs_facts.h"
#include "ecofiles/import/places/positions.h"

struct eco_crs_request {
	const char *path;            /* for messages */
	const char *stated, *vertical;       /* in the scene's entry; win */
	const char *of_file;         /* in the file; NULL: not stated */
	/* why a file that should state its CRS does not: an error. NULL or "": places without a CRS of their
	 * own are in the scene's */
	const char *no_crs_says;
	bool use_z;                  /* heights are converted, so their datums matter */
	const struct eco_frame *frame;
	void (*note)(void *ctx, const char *format, ...) __attribute__((format(printf, 2, 3)));
	void *ctx;
};

struct eco_crs;

/* The request's frame must outlive the conversion; the rest need not. */
enum eco_code eco_crs_open(struct eco_crs **crs, const struct eco_crs_request *request,
	struct eco_error *error);
/* To metres from the origin; converted x and y (z with use_z) are rounded to the millimetre. *converted is
 * false if PROJ knows no way; *why says why. Fails only on the first place, for a grid that PROJ lacks. */
enum eco_code eco_crs_convert(struct eco_crs *crs, double xyz[3], bool *converted, const char **why,
	struct eco_error *error);
void eco_crs_close(struct eco_crs *crs);

/* Places in the coordinates of their file. */
struct eco_crs_span { double first[2], low[2], high[2]; bool any, has_decimals; };
void eco_crs_span_add(struct eco_crs_span *span, const double xy[2]);
/* ECO_BAD_INPUT: all places are degrees, and the CRS that is stated for them (NULL: none) counts in metres or feet.
 * `heap`: taken for metres they stand within one. *fit and *area ("" if not stated) are the first place's. */
enum eco_code eco_crs_refuse_degrees(const struct eco_crs_span *span, const char *crs, bool heap, const char *path,
	enum eco_crs_fit *fit, char area[80], struct eco_error *error);

/* A CRS for messages: a code as it is, the quoted name of WKT. Malloc'ed; NULL when memory ran out. */
char *eco_crs_short_name(const char *crs);

#endif
