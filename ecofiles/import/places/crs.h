/* Coordinate reference systems: what is known of one, which ones plain numbers may be in (by PROJ's register,
 * EPSG, and its areas of use), and the way from an inventory's coordinates to the scene's: easting or
 * longitude always first, heights between vertical datums.
 *
 *   eco_crs_open(&crs, &request, &error);            checks what can be checked without a coordinate
 *   eco_crs_convert(crs, xyz, &error);               for each place
 *   eco_crs_close(crs); */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "ecofiles/import/places/positions.h"

struct eco_crs_facts {
	bool geographic, metric_map; /* degrees; projected, in metres */
	bool x_is_north;             /* its own axis x counts to the north, as surveyors have it */
	double degrees[2];           /* longitude, latitude of the place asked about; NaN: none */
	bool inside;                 /* the CRS's area of use has the place, or is not stated */
	double area[4];              /* of use: west, south, east, north in degrees; NaN: not stated */
	char name[96], code[32];     /* "WGS 84 / UTM zone 32N", "EPSG:32632"; code "": not in the register */
};

/* `xy`: a place in it, easting or longitude first. ECO_BAD_INPUT: PROJ does not know it. */
enum eco_code eco_crs_look(const char *crs, const double xy[2], struct eco_crs_facts *facts,
	struct eco_error *error);

enum eco_crs_fit {
	ECO_CRS_FITS,                /* within the CRS's area of use, or this is not stated */
	ECO_CRS_OUTSIDE,
	ECO_CRS_SWAPPED,             /* outside, and within once x and y change places */
	ECO_CRS_DEGREES              /* degrees where the CRS has metres or feet: no place of plants */
};
/* Plants of an inventory do not stand within so many metres: those are degrees. */
#define ECO_HEAP_M 1.0
/* Whether a place in degrees lies in an area of use; false if that is not stated. */
bool eco_crs_area_has(const double area[4], const double degrees[2]);
/* "longitude 6 to 12, latitude 38.76 to 84.33"; returns `text`. */
const char *eco_crs_area_text(const double area[4], char text[80]);

/* The place on Earth of a place of a map: degrees of WGS 84, and the clockwise turn of the map's north from
 * true north there (grid convergence). */
struct eco_crs_place { double longitude_deg, latitude_deg, convergence_deg; };
/* `xy`: easting and northing. ECO_BAD_INPUT: PROJ does not know the CRS, or the place is not on its map. */
enum eco_code eco_crs_place(const char *crs, const double xy[2], struct eco_crs_place *place,
	struct eco_error *error);

struct eco_crs_choice {
	char code[32], name[96], area[96];
	bool metric;                 /* in metres, not in feet */
	uint32_t usual;              /* as eco_crs_usual */
	double degrees[2], extent_deg;       /* of the place; of the area's longer side */
};
#define ECO_CRS_CHOICES_MAX 128u

/* Projected CRSs that have a place within their areas of use, usual ones first, then those of small areas,
 * one for each place on Earth (of several datums the usual one, else WGS 84's, else the first in the
 * register). With `words` (words.h, NULL for none) only those whose names have these, in this order.
 * `choices` has room for ECO_CRS_CHOICES_MAX; *found may exceed that. Without words it takes seconds. */
enum eco_code eco_crs_choices(const double xy[2], const char *words,
	struct eco_crs_choice *choices, uint32_t *found, struct eco_error *error);

/* How usual a CRS is for tables of plants: 0 for most, the higher the more usual. */
uint32_t eco_crs_usual(uint32_t epsg);
/* Words of columns in tables of the country of a CRS, "EPSG:2154"; "": none. */
const char *eco_crs_words(const char *code);

#define ECO_DEGREE_M 111195.0        /* of a great circle */
/* Metres of a degree of longitude at a latitude; 0 at the poles, beyond them, and for NaN. */
double eco_degree_m(double latitude_deg);

/* The code of the UTM zone of a place in degrees: "EPSG:32632". */
void eco_crs_utm(const double degrees[2], char code[32]);

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
/* ECO_BAD_INPUT: all places are degrees, and the CRS that they would be in (NULL: plain metres) counts in
 * metres or feet. `heap`: taken for metres they stand within one, or are named as degrees. *fit and *area
 * ("" if not stated) are the first place's. */
enum eco_code eco_crs_refuse_degrees(const struct eco_crs_span *span, const char *crs, bool heap,
	const char *path,
	enum eco_crs_fit *fit, char area[80], struct eco_error *error);

/* A CRS for messages: a code as it is, the quoted name of WKT. Malloc'ed; NULL when memory ran out. */
char *eco_crs_short_name(const char *crs);
