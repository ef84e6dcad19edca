/* Plants that nobody counted one by one: a number per hectare within areas.
 *
 *   eco_scatter_open(&scatter, &spec, &frame, &error);       reads the areas, and places everything
 *   while (eco_scatter_next(scatter, &place)) ...
 *   eco_scatter_report(scatter, say, ctx);
 *   eco_scatter_close(scatter);
 *
 * Places come from one progressive blue-noise set (words/blue_noise.tsv) that repeats over the plane, at a
 * density in steps of four. An area takes the places inside it in the set's order until it has its number.
 * Counts are exact and plants evenly spread, whatever the order of the file and the other areas. If plants
 * would stand too close to those of another area, the larger area comes first, then the one further
 * south-west. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/import/places/positions.h"

#define ECO_SCATTER_PLANTS_MAX 100000000u

/* plants a hectare, or shares of a column's number */
struct eco_scatter_plant { uint32_t plant, variant_count; double weight; };

struct eco_scatter_spec {        /* texts are owned by the spec's maker; NULL: not given */
	char *path, *layer, *crs;
	struct eco_scatter_plant *plants; uint32_t plant_count;
	char *density_column;        /* plants a hectare, all kinds; weights are then shares */
	char *count_column;          /* plants in the area */
	double spacing_m;            /* > 0: along the lines of the features, in place of a number; weights are shares */
	double distance_m;           /* between any two plants of this entry; 0: none */
	char *clear_of, *clear_layer, *clear_crs;        /* features kept clear, and clear_m around */
	double clear_m;
	struct eco_filter *filters;  uint32_t filter_count;
	/* NaN: the plant's own; else evenly between the two */
	double height_low_m, height_high_m;
	uint64_t seed;
	uint32_t line, column;       /* in the scene file, for messages */
};

struct eco_scatter_place {
	uint32_t plant;              /* one of the plant's variants */
	double at[2];                /* metres from the origin */
	double height_m;             /* NaN: the plant's own */
};

struct eco_scatter;

/* `spec` and `frame` must outlive it. Files are read in a child process (guard.h). Errors name the file
 * and what to add. `progress` may be NULL; returning false stops with ECO_INTERRUPTED. */
enum eco_code eco_scatter_open(struct eco_scatter **scatter, const struct eco_scatter_spec *spec,
	const struct eco_frame *frame, bool (*progress)(void *ctx, double share), void *ctx,
	struct eco_error *error);
/* Reads the areas and drops them, to report their errors before other work takes time. */
enum eco_code eco_scatter_check(const struct eco_scatter_spec *spec, const struct eco_frame *frame,
	struct eco_error *error);
bool eco_scatter_next(struct eco_scatter *scatter, struct eco_scatter_place *place);
/* Reports areas, hectares, plants wanted and placed, and features left out by reason: a line per call. */
void eco_scatter_report(const struct eco_scatter *scatter, void (*say)(void *ctx, const char *text),
	void *ctx);
/* The areas and the features kept clear of, for pictures. */
struct eco_areas;
const struct eco_areas *eco_scatter_areas(const struct eco_scatter *scatter);
const struct eco_areas *eco_scatter_clear_of(const struct eco_scatter *scatter);
void eco_scatter_close(struct eco_scatter *scatter);
