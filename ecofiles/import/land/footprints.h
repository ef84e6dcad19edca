/* Footprints: polygons of a file with heights by their columns, of buildings that are to be extruded.
 *
 *   eco_footprints_read(&footprints, &spec, &frame, &error);         in a child process (guard.h)
 *   for each area i of footprints.areas                              its rings are edges; footprints.items[i]
 *   eco_footprints_report(&footprints, say, ctx);
 *   eco_footprints_free(&footprints); */
#pragma once

#include "ecofiles/import/land/areas.h"

#define ECO_STOREY_M 3.0           /* a storey, where the scene says nothing else */
#define ECO_BUILDING_M 6.0         /* a building of which no height is told: two storeys */
#define ECO_BUILDING_MOST_M 1000.0 /* none is higher */

enum eco_roof {
	ECO_ROOF_FLAT,
	ECO_ROOF_HIPPED,
	ECO_ROOF_GABLED,
	ECO_ROOF_PYRAMIDAL,
	ECO_ROOF_SHED,
	ECO_ROOF_COUNT
};
extern const char *const eco_roof_names[ECO_ROOF_COUNT]; /* as in words/roofs.tsv */
/* The form that a text names; ECO_ROOF_COUNT: none that is known. */
enum eco_roof eco_roof_of(const char *text);

#define ECO_FOOTPRINT_HEIGHTS 8u
struct eco_footprint_height { /* a source; column NULL: value_m, of all */
	char *column;
	double unit_m; /* metres per unit of the column, or per storey */
	bool storeys;  /* up to the eaves; else up to the ridge */
	double value_m;
};

struct eco_footprints_spec { /* texts are owned by the spec's maker; NULL: not given */
	char *path, *layer, *crs;
	struct eco_footprint_height heights[ECO_FOOTPRINT_HEIGHTS];
	uint32_t height_count; /* the first that tells one counts */
	char *roof;            /* column of forms; NULL: all are flat */
	struct eco_filter *filters;
	uint32_t filter_count;
	uint32_t line, column; /* in the scene file, for messages */
};

struct eco_footprint {
	double height_m; /* above the ground */
	bool to_eaves;   /* height_m is that of the walls; else of the ridge */
	enum eco_roof roof;
};

struct eco_footprints { /* owns its arrays; zero-initialised is empty */
	struct eco_areas areas;
	struct eco_footprint *items; /* per area */
	struct eco_areas_report report;
	/* features without a height from any source, and with that of a number behind columns; texts of heights that are
	 * none: 0, below it, above ECO_BUILDING_MOST_M, words; roof forms that are not known */
	struct eco_footprint_note { uint64_t count, first_line; char example[40]; } untold, by_number, unusable, unknown;
};

/* `frame` need not outlive it. ECO_BAD_INPUT: no polygon is in the file. Errors name the file and what to add. */
enum eco_code eco_footprints_read(struct eco_footprints *footprints, const struct eco_footprints_spec *spec,
	const struct eco_frame *frame, struct eco_error *error);
/* Reports what was read and what was left out: a line per call. */
void eco_footprints_report(const struct eco_footprints *footprints, void (*say)(void *ctx, const char *text),
	void *ctx);
void eco_footprints_free(struct eco_footprints *footprints);
