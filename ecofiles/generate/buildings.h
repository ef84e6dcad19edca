/* Buildings from footprints: walls, and roofs that are flat or a few planes. A mesh is closed but at its bottom, which lies
 * below the ground.
 *
 *   struct eco_building building = { edges, edge_count, .base_m = 112.5, .height_m = 9, .roof = ECO_ROOF_GABLED };
 *   eco_buildings_make(&model, &building, 1, origin, &notes);       eco_model_free(&model)
 *
 * Rings count by the even-odd rule: holes, islands in them and several parts are told by where they lie, not by their
 * direction or order. Corners are rounded to millimetres, and all that decides is exact in integers, so that the same
 * footprints give the same bytes on every machine. */
#pragma once

#include "ecofiles/format/model.h"
#include "ecofiles/import/land/footprints.h"

#define ECO_BUILDING_SINK_M 0.5        /* walls reach so far below the base */
#define ECO_BUILDING_CORNERS_MAX 2048u /* of a footprint */
#define ECO_BUILDING_WIDE_M 10000.0    /* none is wider */

struct eco_building {
	const struct eco_edge *edges;
	uint32_t edge_count; /* rings, each closed, one after the other (areas.h), metres */
	double base_m;       /* z of the ground that it stands on */
	double height_m;     /* above base_m, of the ridge, or of the eaves */
	bool to_eaves;
	enum eco_roof roof;
	/* by eco_buildings_cover: stretches of its walls that another building draws, malloc'ed; it stands on another, as high */
	struct eco_edge *covers;
	uint32_t cover_count;
	bool twin, level;    /* level: some other's roof is in the plane of its own, beside a wall of both */
};

/* Finds the stretches of walls that several buildings have: the highest draws it, of equals the first. Flat roofs in one plane
 * above such a wall are moved apart by centimetres. The caller frees their covers. */
void eco_buildings_cover(struct eco_building *const *buildings, uint32_t count);

/* Whether anything of it is left to draw: it has a surface, within the limits above. */
bool eco_building_stands(const struct eco_building *building);

/* Buildings by what was done to them. */
struct eco_buildings_notes {
	uint32_t crossed; /* their rings cross or touch themselves, and were cut there */
	uint32_t nothing; /* left out: without a surface, or beyond the limits above */
	uint32_t flat;    /* their roofs are flat, as a pitched one does not fit a footprint with holes */
};

/* One object (model.h) of all buildings, relative to `origin`. Adds to the notes. Without a surface in any of them the
 * model is empty. */
void eco_buildings_make(struct eco_model *model, const struct eco_building *buildings, uint32_t count,
	const double origin[3], struct eco_buildings_notes *notes);
