/* Drawing of impostors (ecofiles/format/impostor.h), shared by the rasteriser and by what measures them.
 *
 *   lod_impostor_open(&impostor, &body, &level, &error);         once a level
 *   lod_impostor_look(&look, &impostor, eye);                    once a picture and plant
 *   if (lod_impostor_hit(&impostor, &look, ray, &hit)) ...       each pixel
 *
 * A ray is looked up in four tiles: the two nearest on each of the rings above and below the eye. It meets
 * the plane through the plant's middle; the depth there moves it to the plant; the texels there are mixed by
 * the nearness of directions, and what exceeds LOD_IMPOSTOR_LEAST is covered. All in single floats, + - * /
 * and square roots in a fixed order. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/impostor.h"

/* Less than half, as means of several tiles are lower than each of them. */
#define LOD_IMPOSTOR_LEAST 0.45f
#define LOD_IMPOSTOR_HOPE 0.449f         /* less than that by more than sums of floats err */
#define LOD_IMPOSTOR_LIGHT 0.1f          /* once a ray is covered, tiles of less weight together are left out */
#define LOD_IMPOSTOR_LOOKED 4u           /* tiles that a ray is looked up in */
/* Across, in pixels: plants that are larger in the picture are not drawn as impostors. */
#define LOD_IMPOSTOR_PIXELS 192u
/* Radii: what the shadow map leaves to a crown's own shade, as a plant casts from its middle. With less, a
 * closed wood from the air is too light (by 4 L* at 0), with more single trees are too dark. */
#define LOD_IMPOSTOR_REACH 0.3f
/* How deep in a plant a ray ends, as a part of its way through: near the front where nothing is seen through
 * it, anywhere where nearly all is. Beer's law with u / (1 - u) in place of logarithms; need is even in [0,
 * opacity). */
#define LOD_IMPOSTOR_DEEP(need, opacity) ((need) * (1.0f - (opacity)) / ((opacity) * (1.0f - (need))))

/* (x, y, z) of a tile = axis . point from the centre: x and y in [-1, 1], z in radii. */
struct lod_impostor_tile { float axis[3][3]; };

struct lod_impostor {                    /* owns its arrays */
	struct eco_impostor_body body;
	struct eco_impostor_size size;
	float radius;
	float opacity;                   /* share of rays that meet the plant where texels are covered */
	uint8_t *texel;                  /* 1: covered, else 0 */
	float *depth;
	uint8_t (*rgb)[3];               /* sRGB, of cells: few tiles * colors * colors */
	uint32_t cell_count;
	struct eco_impostor_rings rings;
	struct lod_impostor_tile tile[ECO_IMPOSTOR_TILES_MAX], color_tile[ECO_IMPOSTOR_TILES_MAX];
};
/* The level is not needed afterwards. */
enum eco_code lod_impostor_open(struct lod_impostor *impostor, const struct eco_impostor_body *body,
	const struct eco_impostor_level *level, struct eco_error *error);
size_t lod_impostor_bytes(const struct lod_impostor *impostor); /* of its arrays */
void lod_impostor_close(struct lod_impostor *impostor);

/* From one eye. */
struct lod_impostor_look {
	uint32_t tile[LOD_IMPOSTOR_LOOKED], color_tile;
	float weight[LOD_IMPOSTOR_LOOKED];
	float eye[3];
	float from[LOD_IMPOSTOR_LOOKED][3];      /* the eye in each tile */
};
/* eye: from the body's centre, plant space. */
void lod_impostor_look(struct lod_impostor_look *look, const struct lod_impostor *impostor,
	const float eye[3]);

/* middle: along the ray as well, half way through the plant. */
struct lod_impostor_hit { float along, middle; uint32_t cell; };
/* Whether eye + along * ray meets the plant or a gap in it, and where; which of `rgb` is its colour. */
bool lod_impostor_hit(const struct lod_impostor *impostor, const struct lod_impostor_look *look,
	const float ray[3], struct lod_impostor_hit *hit);
