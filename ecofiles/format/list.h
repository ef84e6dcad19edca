/* The one idea: everything drawable is a list in priority order, stored in chunks, fetched as a prefix,
 * drawn as a range.
 *
 *   list      elements in priority order, on one integer grid, cut into chunks
 *   element   kept, dropped or scaled as one: 1 corner (a point, an instance, a ground sample), 2 (a line) or
 *             3 to 6 (a leaf: a fan of 1 to 4 triangles 0-1-2, 0-2-3, ... around corner 0)
 *   primitive the unit of ranges: a point, a line, a triangle, an instance, a ground sample; a fan of n
 *             corners has n-2
 *   vertices  the unit of budgets: point 1, impostor 1 (it is drawn as a point), line 2, triangle 3 (for each
 *             primitive drawn; instances multiply)
 *
 * Ranges [first, end) are in primitives of the list's draw order (after decoding and permuting). */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_CORNERS_MAX 6

enum eco_list_kind {
	/* fans; or single triangles of connected wood when coder is ECO_CODER_MESH */
	ECO_LIST_TRIANGLES = 1,
	ECO_LIST_LINES,
	ECO_LIST_POINTS,         /* a plant's points, or a tile's summary when ECO_ATTR_PLANT is set */
	ECO_LIST_INSTANCES,      /* plants of one tile, species by species (struct eco_group) */
	/* one tile of the ground: samples row by row from the south-west, `columns` wide (ground_tile.h) */
	ECO_LIST_GROUND,
	/* a texture in levels (texture.h): primitive and element k is level k, in one or more chunks */
	ECO_LIST_IMAGE,
	/* a plant's impostors (impostor.h): primitive, element and chunk k is level k. Levels are
	 * alternatives: a cut draws one of them, though what is fetched is a prefix */
	ECO_LIST_IMPOSTOR,
	ECO_LIST_OUTLINE,        /* what is opaque of a texture, in levels as that */
	/* a tile of the picture on the ground, in levels as a texture (ground_tile.h) */
	ECO_LIST_GROUND_IMAGE,
	/* the inventory and row of each plant (inventory.h): primitive, element and chunk k is block
	 * k. Never drawn, never in a stream */
	ECO_LIST_INVENTORY
};

/* Coders: the ways from a payload to elements (chunk.h), all lossless.
 *   ELEMENTS  rows, one run per corner count ascending, Morton order inside; then the seeded permutation
 *             eco_chunk_permutation(ordinal, element count) puts a chunk's elements into draw order.
 *   FORM      another form of the elements of list `partner`: one element for each, all with the same number
 *             of corners (1: a point, 2: a line, 3, or 4: a quad), never with more vertices. Chunks match by
 *             ordinal and have the partner's stored order and permutation: element i is element i of the
 *             partner, drawn in another way.
 *   KD        points in a kd-tree (order is lost, attributes stay with their point), then permuted as
 *             ELEMENTS.
 *   ROWS      rows, order kept, no permutation (instances, ground).
 *   MESH      edgebreaker; triangles in the decoder's order, every element has 3 corners, no permutation.
 *   BYTES     the payload is a part of a texture, a level of an impostor, or a block of an inventory.
 *   SHAPES    a coder of chunks, not of lists: in a chunk of an ELEMENTS list of triangles, elements of one
 *             shape are stored as placings of it (shape.h). */
enum eco_coder { ECO_CODER_ELEMENTS = 1, ECO_CODER_FORM, ECO_CODER_KD, ECO_CODER_ROWS, ECO_CODER_MESH,
	ECO_CODER_BYTES, ECO_CODER_SHAPES };

/* Attributes per element beyond positions, in this order in `struct eco_elements.extra`. */
enum eco_attr {
	/* palette index, relative to the list's palette_first; instances: tint (pack.h), 0: none, else index + 1 */
	ECO_ATTR_COLOR = 1,
	/* per corner: u, v on a grid of 1/ECO_UV_ONE, kept in `uv`, not in `extra` */
	ECO_ATTR_UV = 2,
	/* lines: full width in units of grid_step[0]; instances: width across the height's scale, a code for
	 * eco_place_width, where some differ */
	ECO_ATTR_WIDTH = 4,
	/* summary points: plant id, then the leaf tile key's low 16 bits less those of the list's tile */
	ECO_ATTR_PLANT = 8,
	ECO_ATTR_PLACE = 16,     /* instances: yaw in 1/65536 turns, then scale in 1/65536 (two values) */
	ECO_ATTR_GROWTH = 32,    /* triangles: how far it follows its cut's scale, a code for eco_growth */
	ECO_ATTR_SIZE = 64,      /* points: this point's area is unit_area * eco_size(code) */
	ECO_ATTR_SPLAT = 128     /* points: an ellipsoid, ECO_SPLAT_CODES values (splat.h) */
};
#define ECO_UV_ONE 4096
#define ECO_LOSS_ONE 255
#define ECO_COVER_ONE 16u

struct eco_list {
	uint8_t kind, coder, attributes;
	uint8_t level;               /* ground: samples are 2^level apart; points, splats, impostors: how level
	                              * their leaves lie (eco_level_share); outlines: ECO_LOSS_ONE times
	                              * what the level before the last shows wrong, of what is opaque, 0:
	                              * not known; else 0 */
	uint32_t owner;              /* plant id; tile id for instances, summaries; ECO_NONE for ground, its
	                              * image, inventories, and textures, which plants share */
	uint32_t group_count;        /* instances: groups of one species each (struct eco_group); else 0 */
	double grid_origin[3];       /* metres; plant space, tile's eco space, or scene space for ground; of
	                              * its image: the south-west corner of the tile */
	double grid_step[3];         /* metres; position = origin + integer * step; of the ground's image: a
	                              * texel of the last level */
	float unit_area;             /* points and summaries: projected area (m^2, random
	                              * orientation: area / 2) of one point when all are drawn, over the share
	                              * `cover`: it is a ball whose disc has the area unit_area * scale.
	                              * Splats: the square of their unit of length. Images, outlines: what a
	                              * texel of the last level covers on the plant, in the mean; 0: not known */
	uint32_t palette_first, palette_count;
	uint32_t image;              /* list id of the texture, or a texture's outline; or ECO_NONE */
	uint32_t partner;            /* FORM: list id of the elements in their finest form; else ECO_NONE */
	union {
		uint32_t columns;    /* ground: samples per row, the ring among them; else 0 */
		/* splats and impostors, where the pack has tints: how much of a colour is wood, whose own
		 * ends the palette (lod/tint.h); 0: none is */
		uint32_t wood;
		/* points of a plant: the share of their discs that is covered, in 1/ECO_COVER_ONE; 0: all */
		uint32_t cover;
	};
	uint32_t primitive_count, element_count;
	uint32_t chunk_first, chunk_count;   /* in the pack's chunk table */
};

/* XXH3-128 of the payload, canonical (big-endian) order; 32 hex digits in URLs */
struct eco_chunk_id { uint8_t bytes[16]; };
/* In lower case and ended by 0, for URLs and names of files: eco_id_text(id.bytes).hex. */
struct eco_id_text { char hex[33]; };
struct eco_id_text eco_id_text(const uint8_t bytes[16]);

struct eco_chunk {
	struct eco_chunk_id id;
	uint64_t offset;             /* of the payload in the pack */
	uint32_t size_bytes;
	uint32_t primitive_count, element_count;
};

#define ECO_EXACT_SHIFT 3u

/* Elements in draw order: input of the encoder and output of the decoder. Owns its arrays. */
struct eco_elements {
	uint32_t element_count, corner_count, primitive_count;
	uint32_t extra_count;        /* values per element: 2 for PLANT and PLACE, 7 for SPLAT, else 1 */
	uint8_t *corners;            /* per element */
	int32_t *position;           /* 3 per corner */
	int32_t *uv;                 /* 2 per corner, or NULL */
	int32_t *extra;              /* extra_count per element, or NULL */
	int32_t *exact;              /* fans: 3 per corner, the corners before rounding, on a grid
	                              * 2^ECO_EXACT_SHIFT times finer; or NULL. For encoders: decoding gives
	                              * such elements on the finer grid, where position says or as near to
	                              * `exact` as rounding to position could be. Decoders leave it NULL */
	int32_t *part;               /* wood: per element, ascending in each level, or NULL. For encoders: MESH
	                              * keeps the order of parts, not that within one. Decoders leave it NULL */
};
void eco_elements_free(struct eco_elements *elements);
/* NULL, or what is wrong with decoded elements of a list: other attributes than its own, colours beyond its
 * palette, plants from plant_count on, codes that do not exist, an impossible turn, width or scale. */
const char *eco_elements_fault(const struct eco_elements *elements, const struct eco_list *list,
	uint32_t plant_count);
uint32_t eco_list_extra_count(const struct eco_list *list);
/* Index of an attribute's first value among an element's extra values; the list must have the attribute. */
uint32_t eco_list_extra_at(const struct eco_list *list, enum eco_attr attribute);

/* A list whose chunks are levels of texels (texture.h): a texture, its outline, a tile of the ground's
 * image. */
static inline bool eco_list_has_texels(const struct eco_list *list)
{
	return list->kind == ECO_LIST_IMAGE || list->kind == ECO_LIST_OUTLINE
		|| list->kind == ECO_LIST_GROUND_IMAGE;
}

/* Whether its colours mix leaves and wood. */
static inline bool eco_list_is_mixed(const struct eco_list *list)
{
	return list->kind == ECO_LIST_IMPOSTOR || list->attributes & ECO_ATTR_SPLAT;
}

/* The share of a point's disc that is covered. */
static inline float eco_list_opacity(const struct eco_list *list)
{
	return list->kind == ECO_LIST_POINTS && !eco_list_is_mixed(list) && list->cover
		? (float)list->cover / (float)ECO_COVER_ONE : 1;
}

/* Whether all of its elements are wood: connected triangles, or lines that are no form of leaves. */
static inline bool eco_list_is_wood(const struct eco_list *list)
{
	return list->coder == ECO_CODER_MESH || (list->kind == ECO_LIST_LINES && list->coder == ECO_CODER_ELEMENTS);
}

/* The turn of an instance whose yaw nobody gave: one of 64, by its position on the list's grid. */
uint16_t eco_place_turn(const int32_t position[3]);

/* Vertices of one primitive of the list: 1, 2 or 3; 0 for instances, ground and images. */
uint32_t eco_list_vertices(const struct eco_list *list);

/* Area factor of an element with growth code `code` in a cut with scale `scale`. An element that grows
 * into empty sky does harm, one that grows over others does not: so elements at an outline have low codes
 * and stay sharp, while those behind them fill gaps. 1 for code 0, and for scale 1 whatever the code, so
 * that full detail is the model. Below 1 it is the scale itself. Elements of lists without ECO_ATTR_GROWTH
 * have code ECO_GROWTH_PLAIN: the scale itself. */
#define ECO_GROWTHS 8u
#define ECO_GROWTH_PLAIN 5u
float eco_growth(uint32_t code, float scale);

/* 2^((code - ECO_SIZE_ONE) / 4), code < ECO_SIZES. */
#define ECO_SIZES 64u
#define ECO_SIZE_ONE 32u
float eco_size(uint32_t code);

/* The nearest float with 10 significant bits: it travels in fewer (wire_items.h, server/publish/index_columns.h),
 * and areas and errors need no more. */
float eco_few_bits(float v);

/* Levelness of a plant's leaves, for lighting: a share of them is taken as level, the others as
 * facing all directions. The share comes from the mean square, by area, of the height of their unit
 * normals. Code 0 is not known, and stands for the mean of broadleaved trees, 27 % (Ross's index of 0.25:
 * Sellers 1985; land surface models). Conifers and flowers have far more, grass none. */
#define ECO_LEVEL_USUAL 0.27
uint8_t eco_level_code(double mean_square);
double eco_level_share(uint8_t code);
