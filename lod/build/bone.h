/* Lines for wood (Deussen 2002, 4.2): the skeleton of a tubular surface.
 *
 * The surface is cut at equal steps of the distance along it from a component's lower end. A ring between two
 * slabs has a joint at its centre, and a line leads through each slab from joint to joint (the Reeb graph of
 * that function). Lines that run on straight at similar width become one. A line is as wide as its area
 * demands: a tube of surface a and length l has diameter a / (pi l), an open strip width a / l. Wood that is
 * no tube gets one line, fitted to its surface. */
#pragma once

#include "lod/build/organ/organ.h"
#include "lod/vector.h"

struct lod_bone {
	struct lod_v3 end[2];        /* metres */
	double width, error;         /* metres; error: greatest distance of its wood beyond its surface */
	uint32_t component;
	uint8_t rgb[3];              /* mean of its triangles */
	uint32_t cell;               /* that it belongs to; 0 until lod_wood_split */
};

/* The part of a bone, from 0 at its first end to 1, that a triangle of the mesh lies along. */
struct lod_bone_span { uint32_t bone, triangle; float from, to; };

struct lod_bones {
	uint32_t count;
	struct lod_bone *items;
	/* Every triangle of wood has a span for each bone that stands for a part of it. */
	uint32_t span_count;
	struct lod_bone_span *spans;
};

/* Lines of all wood, component by component. Arrays from `arena`. */
void lod_bones_make(struct lod_bones *bones, const struct lod_mesh *mesh, const struct lod_organs *organs,
	struct lod_arena *arena);

/* How far a point is from a bone's surface; negative inside. */
double lod_bone_away(const struct lod_bone *bone, struct lod_v3 point);

/* Sorts bones into drawing order: the largest (length times width) first, those of similar size (half
 * octaves) in random order, so that the first ones are spread over the plant. */
void lod_bones_sort(struct lod_bones *bones, uint32_t seed, struct lod_arena *arena);
