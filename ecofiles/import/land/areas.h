/* Polygons, lines and points in metres, and two questions about a place: is it inside, is it near?
 *
 *   eco_areas_read(&areas, &request, &frame, &report, &error);       a file's features; or
 *   eco_areas_add_wkb(&areas, wkb, size, convert, ctx, &error);      each feature, in any order
 *   eco_areas_index(&areas, near_m, &error);
 *   eco_area_holds(&areas, i, x, y);  eco_areas_hold(&areas, x, y);  eco_areas_near(&areas, x, y);
 *   eco_areas_free(&areas); */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "ecofiles/import/places/positions.h"
#include "ecofiles/import/places/rows/rows.h"

#define ECO_AREA_POINTS_MAX (1u << 26)   /* corners of all features */

struct eco_edge { double a[2], b[2]; };  /* of a ring or a line; a point: twice the same */

/* Items by the bands of y that they touch, in their order: those of band i are member[first[i]] to first[i +
 * 1]. */
struct eco_strips { double low, high; uint32_t count, *first, *member; };

struct eco_area {                        /* a feature: all its rings, by the even-odd rule */
	uint32_t edge_first, edge_count, ring_edges;     /* first the rings', then lines' and points' */
	double low[2], high[2];
	double size_m2;                      /* of the surface without its holes */
	struct eco_strips strips;                        /* its rings' edges; after eco_areas_index */
};

struct eco_areas {                       /* owns its arrays; zero-initialised is empty */
	struct eco_area *items; uint32_t count, capacity;
	struct eco_edge *edges; uint32_t edge_count, edge_capacity;
	struct eco_strips strips;            /* features with a surface */
	double near_m; struct eco_strips near;       /* edges, widened by near_m */
};

/* False: a corner cannot be converted; then the feature is left out and *kept is false. */
typedef bool eco_area_convert(void *ctx, double xy[2], struct eco_error *error);

/* Adds one feature, given as little-endian well-known binary of two dimensions: a point, a line, a polygon,
 * several of these or a collection. ECO_DAMAGED: malformed. */
enum eco_code eco_areas_add_wkb(struct eco_areas *areas, const uint8_t *wkb, size_t size,
	eco_area_convert *convert, void *ctx, bool *kept, struct eco_error *error);

/* Prepares the indices. near_m > 0: also for eco_areas_near. */
enum eco_code eco_areas_index(struct eco_areas *areas, double near_m, struct eco_error *error);

/* Whether a place is inside the surface of one feature. */
bool eco_area_holds(const struct eco_areas *areas, uint32_t area, double x, double y);
/* The range of x that the surface of one feature covers between two y, up to rounding; false: none. */
bool eco_area_span(const struct eco_areas *areas, uint32_t area, double low_y, double high_y, double span[2]);
/* Whether a place is inside any surface. */
bool eco_areas_hold(const struct eco_areas *areas, double x, double y);
/* Whether a place is within near_m of any edge; a box: of its line, and may be. */
bool eco_areas_near(const struct eco_areas *areas, double x, double y);
bool eco_areas_near_box(const struct eco_areas *areas, const double low[2], const double high[2]);
void eco_areas_free(struct eco_areas *areas);

/* ---- Areas of a file ---- */

enum eco_area_why { ECO_AREA_NOT_A_SURFACE, ECO_AREA_NO_GEOMETRY, ECO_AREA_NO_CONVERSION, ECO_AREA_TOO_FAR,
	ECO_AREA_NO_NUMBER, ECO_AREA_FILTERED, ECO_AREA_WHY_COUNT };

struct eco_areas_report {        /* zero-initialised is empty; owns its notes */
	uint64_t features, skipped[ECO_AREA_WHY_COUNT], first_line[ECO_AREA_WHY_COUNT];
	char *notes[2 * ECO_ROWS_NOTES_MAX]; uint32_t note_count;
	const char *refused;         /* says ECO_AREA_NO_NUMBER where `take` has another reason; NULL: it has not */
};

#define ECO_AREAS_COLUMNS 16u
struct eco_areas_request {
	const char *path, *layer, *crs;      /* layer, crs: NULL: not stated */
	const struct eco_filter *filters; uint32_t filter_count;
	const char *const *columns; uint32_t column_count;   /* up to ECO_AREAS_COLUMNS names; NULL: not asked for */
	/* Texts of a feature's columns, and the row with all of them, once it is area number `area`. False:
	 * it is left out, as ECO_AREA_NO_NUMBER, and the next has the same number. May be NULL */
	bool (*take)(void *ctx, uint32_t area, const struct eco_rows *rows, const char *const *texts);
	void *ctx;
	bool surfaces;               /* features without a surface are left out, and what is left out is counted */
	bool lines;                  /* lines and points are kept, too */
	double near_m;               /* or areas->near_m, which `take` may set */
};
/* Reads the features of a file into metres from the frame's origin, in a child process (guard.h), and indexes
 * them. Adds to the report. */
enum eco_code eco_areas_read(struct eco_areas *areas, const struct eco_areas_request *request,
	const struct eco_frame *frame, struct eco_areas_report *report, struct eco_error *error);
/* A line for each reason why features were left out. */
void eco_areas_report_say(const struct eco_areas_report *report, void (*say)(void *ctx, const char *text), void *ctx);
void eco_areas_report_free(struct eco_areas_report *report);
