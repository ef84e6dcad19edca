/* Plants made in code, for tests of what turns models into lists: soups that grow triangle by triangle. */
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/model.h"
#include "lod/build/foliage.h"
#include "lod/sort.h"
#include "lod/vector.h"

struct soup {
	struct eco_model model;
	uint32_t vertex_capacity, triangle_capacity;
	struct eco_material material[8];
	struct eco_image image[2];
	uint64_t state;
};

double soup_random(struct soup *s, double low, double high);
void soup_begin(struct soup *s);
uint32_t soup_material(struct soup *s, uint8_t r, uint8_t g, uint8_t b, uint32_t image, bool cutout);
/* A square image: opaque inside a disc, transparent outside; two colours. */
uint32_t soup_disc_image(struct soup *s, uint32_t size);
uint32_t soup_vertex(struct soup *s, struct lod_v3 p, double u, double v);
void soup_triangle(struct soup *s, uint32_t material, uint32_t a, uint32_t b, uint32_t c);
void soup_free(struct soup *s);
/* An open tube from a to b with `sides` corners and `rings` steps, tapering from r to t. */
void soup_tube(struct soup *s, uint32_t material, struct lod_v3 a, struct lod_v3 b, double r, double t,
	uint32_t sides, uint32_t rings);
/* A body turned about the z axis, from rings of a radius and a height each, in parts of `radius` and `height`. */
void soup_turned(struct soup *s, uint32_t material, double z, double radius, double height,
	const double (*ring)[2], uint32_t rings, uint32_t sides);
/* A flat leaf of two triangles around `at`, spanned by u and v. */
void soup_quad(struct soup *s, uint32_t material, struct lod_v3 at, struct lod_v3 u, struct lod_v3 v);
struct lod_v3 soup_direction(struct soup *s);
void soup_leaf(struct soup *s, uint32_t material, struct lod_v3 at, double length, double width);
/* `count` leaves all over a ball. */
void soup_leaves(struct soup *s, uint32_t material, int count, struct lod_v3 at, double radius, double size);
/* A closed ball. */
void soup_ball(struct soup *s, uint32_t material, struct lod_v3 at, double radius, uint32_t n);
/* A tree of `leaves` leaves, 6 m high: trunk and branches, leaves in a crown, red flowers if asked for.
 * `textured` leaves are cut-outs. */
void soup_tree(struct soup *s, uint32_t leaves, uint32_t flowers, bool textured);

/* For tests of orders: planar fans of some corners, spread in a ball over a stem. */
struct foliage_random { uint32_t leaves, corners; double radius, leaf; uint64_t seed; };

double foliage_dice(uint64_t *state);
void foliage_random(struct lod_foliage *f, const struct foliage_random *how, struct lod_arena *arena);
