/* Writes the lists of a plant under construction. The caller owns the plant's arrays. */
#pragma once

#include "lod/build/bone.h"
#include "lod/build/element.h"
#include "lod/build/palette.h"
#include "lod/build/plant.h"

struct lod_draft {
	struct lod_arena *arena;
	struct lod_plant *plant;
	const struct lod_mesh *mesh;
	const struct lod_organs *organs;
	const struct lod_palette *palette;
	/* Per vertex of the mesh: mean colour of the wood of several colours around it (lod_draft_shade). */
	uint8_t (*shade)[3];
	bool *shaded;                /* per component: its triangles differ in colour */
	uint32_t list_capacity, ladder_capacity;
};

/* Appends an empty ladder and returns it (valid until the next one is added). */
struct eco_ladder *lod_draft_ladder(struct lod_draft *draft);

/* Each of the following writes a list and returns its index, or ECO_NONE if it would have no elements.
 * `image`: of the plant, or ECO_NONE. */

/* Elements items[0..count) as fans, with texture coordinates if there is an image, else with colours;
 * `growth`: a code for each of all elements, or NULL. `items` get the order in which they are decoded. */
uint32_t lod_draft_fans(struct lod_draft *draft, const struct lod_element *elements, const uint8_t *growth,
	uint32_t *items, uint32_t count, uint32_t image);

/* Other forms of the elements of list `partner`, one each, in its order: those of `items`. */

/* Points; their areas are codes for eco_size, times unit_area; cover: as of the list. */
struct lod_point { int32_t position[3]; uint8_t rgb[3], size; };
uint32_t lod_draft_points(struct lod_draft *draft, uint32_t partner, const struct lod_point *points,
	const uint32_t *items, float unit_area, uint32_t cover);

/* Lines. */
struct lod_line { struct lod_v3 end[2]; double width; uint8_t rgb[3]; int32_t limb; };
uint32_t lod_draft_blades(struct lod_draft *draft, uint32_t partner, const struct lod_line *lines,
	const uint32_t *items);

/* Triangles in one colour, which are in the list's order; `growth` is of all elements. */
struct lod_facet { int32_t corner[3][3]; uint8_t rgb[3]; };
uint32_t lod_draft_facets(struct lod_draft *draft, uint32_t partner, const struct lod_facet *facets,
	const uint8_t *growth, const uint32_t *items);

/* Lines that are no form of other elements. Those without length on the grid are left out. */
uint32_t lod_draft_lines(struct lod_draft *draft, const struct lod_line *lines, uint32_t count);

/* Fills `shade` and `shaded`, the colours of simplified levels; to be called before lod_draft_wood. */
void lod_draft_shade(struct lod_draft *draft);

/* Simplified levels of wood (plant_wood.c). */
#define LOD_LEVELS_SIMPLE (ECO_LEVELS_MAX - 1u)

struct lod_corner { uint32_t vertex, component; int32_t uv[2]; };        /* vertex of the mesh */

struct lod_levels {
	uint32_t count;              /* simplified levels that pay, coarse first, without full detail */
	uint32_t triangle_count[LOD_LEVELS_SIMPLE];
	struct lod_corner *corner[LOD_LEVELS_SIMPLE];    /* 3 per triangle */
	/* Ascending limbs of triangles, at last of those of full detail; NULL: levels do not mix. */
	int32_t *limb[LOD_LEVELS_SIMPLE + 1];
};

/* Wood: simplified levels, then the triangles themselves. Sets level_count and level_end of `ladder` if there
 * are levels. */
uint32_t lod_draft_wood(struct lod_draft *draft, const struct lod_levels *levels, const uint32_t *triangles,
	uint32_t count, uint32_t image, struct eco_ladder *ladder);
