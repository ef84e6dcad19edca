/* Organs: which triangles are wood, which foliage, which flowers. Rules of the scene file decide first, for
 * exactly the triangles that they name; then shape, place, colour and names.
 *
 * Wood is tube-like. For a tube of radius r and length L, however bent, the integral of mean curvature M and
 * the area A are M = pi L and A = 2 pi r L, so sums over edges give r = A / (2 M) and L = M / pi (Steiner's
 * formula: M is half the sum of length times angle, concave edges negative). Wood is thin against its
 * diagonal, as long as it is large, and round: its volume V is near the maximum (4 V M / A^2 is 1 for tubes,
 * 4/3 for balls, little for blades), its edge angles are moderate.
 *
 * A component in doubt follows the clear ones of its material, green ones and others apart; then names break
 * the tie (organ_name.c), then colours. A thick component is a crown or fruit modelled as a hull, or a thing
 * (stump, pot, rock): a thing stands on the ground with most of the plant above it, or is brown in a plant of
 * solids. Soil is a level sheet, not green, not one of many. Things count as wood. A plant of green tubes
 * alone is all foliage. Wrong names on clear components change nothing (lod/EXPERIMENTS.md, Organs). All of
 * an object is wood. */
#pragma once

#include "ecofiles/format/pack.h"
#include "lod/build/weld.h"

struct lod_component {
	uint32_t triangle_count, material;
	uint8_t organ;               /* enum eco_organ */
	uint8_t importance;          /* that a rule gives: its number in the model's importances */
	bool closed;                 /* no border to speak of: each ray hits it twice, its area counts half */
	double area;                 /* m^2, all triangles, both sides of a closed component */
	bool stout;                  /* no tube: a pot, a stump, soil */
	double radius, length;       /* of the tube with the same area and curvature */
	double turn;                 /* radians, mean edge angle weighted by angle: 2 pi / k for k sides */
	float low[3], high[3];
	uint8_t rgb[3];              /* mean colour */
};

struct lod_organs {
	struct lod_component *components;    /* per component of the mesh */
	/* Per triangle, m^2: half if its component is closed, times its opaque share. */
	double *area;
	/* Per triangle, mean opaque colour; brown wood and green leaves if the file has no colours. */
	uint8_t (*rgb)[3];
};

/* Arrays come from `arena`. Regroups the mesh's components (organ_split.c). */
void lod_organs_find(struct lod_organs *organs, struct lod_mesh *mesh, const struct eco_model *model,
	struct lod_arena *arena);

/* Mean colour of one or more triangles, weighted by their opaque area. */
void lod_organs_mean(const struct lod_organs *organs, const uint32_t *triangles, uint32_t count,
	uint8_t rgb[3]);
