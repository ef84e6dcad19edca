/* A plant's leaves and flowers as elements with geometry, and its wood: orders are made from them and
 * measured on them. The elements are those of the pack (lod/build/element.h), in the model's own coordinates.
 *
 *   lod_foliage_from(&foliage, &parts, &arena);
 *   lod_sights_make(&sights, &foliage, directions, count, pixels, &arena);   views; reference masks
 *   lod_sights_draw(&sights, view, &drawing, mask)                           the cover of a subset, scaled */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/model.h"
#include "lod/arena.h"
#include "lod/raster/raster.h"
#include "lod/vector.h"

struct lod_foliage {                 /* arrays of an arena */
	uint32_t count;              /* elements */
	/* Element i has corners [first[i], first[i + 1]), 3 to ECO_CORNERS_MAX: a fan around the first. */
	uint32_t *first;
	float (*corner)[3], (*uv)[2];
	/* Element i has triangles [triangle_first[i], triangle_first[i + 1]), counted in order. */
	uint32_t *triangle_first;
	const struct eco_image **cutout;     /* per element: its image if that is a cut-out, or NULL */
	const struct lod_mask **mask;        /* the same, its mask; NULL: none is known */
	/* Per element, from 0: elements of the same organ and texture, which share a list of a pack. */
	uint32_t *group;
	uint32_t group_count;
	struct lod_v3 *center, *normal;      /* normal: length is area */
	double *area;                /* m^2, opaque part, one side */
	uint64_t wood_count;         /* triangles drawn whole in every picture */
	float *wood;                 /* 9 floats each */
	struct lod_v3 low, high;     /* of everything */
};

/* From the stages of a build (plant.c), which owns their arrays: element i is elements->items[i]. May be
 * empty. */
struct lod_mesh;
struct lod_organs;
struct lod_elements;
struct lod_foliage_parts {
	const struct eco_model *model;
	const struct lod_mesh *mesh;
	const struct lod_organs *organs;
	const struct lod_elements *elements;
};
void lod_foliage_from(struct lod_foliage *foliage, const struct lod_foliage_parts *parts,
	struct lod_arena *arena);

/* Unit vectors from the plant towards the eye, evenly spread over the upper part of the sphere (from slightly
 * below the horizon to steeply above). Different seeds share no direction: build with one, test with
 * another. */
void lod_directions_spread(double (*directions)[3], uint32_t count, uint32_t seed);

/* Pictures from directions, 16 radii away (as in probe.h). Masks are bits, rows padded to whole 64-bit
 * words. */
struct lod_sights {
	const struct lod_foliage *foliage;
	uint32_t count, pixels, words;       /* views; size; 64-bit words of a mask */
	struct lod_eye *eyes;
	double near_m;
	uint64_t **reference, **wood; /* masks per view: everything; wood alone (its pixels are in both) */
	uint64_t *reference_pixels;          /* bits of `reference`, per view */
};
void lod_sights_make(struct lod_sights *sights, const struct lod_foliage *foliage,
	const double (*directions)[3], uint32_t count, uint32_t pixels, struct lod_arena *arena);

/* Draws elements order[0..count) over the wood, each scaled by its area factor about the mean of its drawn
 * corners (`factor` NULL: `scale` for all). `shape`: an opaque triangle in place of an element; NULL, or
 * without corners, for the element itself. */
struct lod_simple { float corner[3][3]; uint8_t corners; };      /* 3; 0: none */
struct lod_sights_drawing {
	const uint32_t *order;       /* NULL: in the order of their numbers */
	uint32_t count;
	const float *factor;         /* per element (not per position in the order), or NULL */
	float scale;
	const struct lod_simple *shape;      /* per element, or NULL */
};
/* ORs into mask[0..words). `raster`: the caller's scratch rasteriser (silhouette, pixels x pixels), one per
 * thread. */
void lod_sights_draw(const struct lod_sights *sights, uint32_t view, const struct lod_sights_drawing *drawing,
	struct lod_raster *raster, uint64_t *mask);
