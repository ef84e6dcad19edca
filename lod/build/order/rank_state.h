/* The inside of the greedy order (rank.h), shared by rank.c and the files named below. */
#pragma once

#include "ecofiles/format/list.h"
#include "lod/build/order/footprint.h"
#include "lod/build/order/rank.h"

/* ---- Covers (rank_crown.c) ---- */

/* The cover of a plant's outline in all its views at once: an element's gain, and adding it.
 *
 *   lod_crown_open(&crown, &foliage, &options, &arena);
 *   lod_crown_clear(&crown, views);                                      the wood alone
 *   lod_crown_gain(&crown, element, &edge, 1, views, &gain);             what it would add at that size
 *   lod_crown_add(&crown, element, edge, views); */

/* The same views in several sizes: large elements are judged in small pictures, at a tenth of the work, where
 * they cover as many pixels as small ones do in large pictures. */
#define LOD_CROWN_LEVELS 4u
struct lod_crown_level {
	struct lod_sights sights;
	struct lod_canvas *canvas;               /* per view */
};
struct lod_crown {
	const struct lod_foliage *foliage;
	bool points;                             /* gains are of the points that stand for elements */
	uint32_t views, level_count;
	struct lod_crown_level levels[LOD_CROWN_LEVELS];     /* the smallest pictures first */
	struct lod_crown_level *level;           /* the one in use */
};

/* Views, pixels and the seed of their directions are of the options; pixels 0: leaves of the usual size are
 * two pixels wide. */
void lod_crown_open(struct lod_crown *crown, const struct lod_foliage *foliage,
	const struct lod_rank_options *options, struct lod_arena *arena);

/* Selects the level for `count` elements drawn so large that they fill the crown. */
void lod_crown_set_level(struct lod_crown *crown, uint32_t count);

/* Edges of elements at a scale, by growth code: on a grid so fine that a leaf a few pixels wide shows no
 * difference. Codes often share an edge then, and one look. */
#define LOD_CROWN_EDGES 512u
/* The same step means the same edge; steps are below LOD_CROWN_EDGES. */
struct lod_crown_edges { double edge[ECO_GROWTHS]; uint16_t step[ECO_GROWTHS]; };
/* `points`: points follow the scale alike, whatever their code. */
void lod_crown_set_scale(struct lod_crown_edges *edges, double scale, bool points);

/* An element in a view, drawn as itself or as its point. */
void lod_crown_see(const struct lod_crown *crown, struct lod_fan_seen *seen, uint32_t element, uint32_t view,
	bool points);

/* Every `stride`th view from `first` on. */
struct lod_crown_views { uint32_t first, stride; };
void lod_crown_clear(struct lod_crown *crown, struct lod_crown_views views);
/* Sums over the views of the element's gain, for each of edge[0..count). Threads may ask about different
 * elements. */
void lod_crown_gain(const struct lod_crown *crown, uint32_t element, const double *edge, uint32_t count,
	struct lod_crown_views views, struct lod_gain *gain);
void lod_crown_add(struct lod_crown *crown, uint32_t element, double edge, struct lod_crown_views views);

/* Pixels of the views: covered and in the reference, covered and not in it, in the reference. */
struct lod_crown_sum { uint64_t right, wrong, wanted; };
struct lod_crown_sum lod_crown_sum(const struct lod_crown *crown, struct lod_crown_views views);

/* ---- The triangle that stands for a leaf (rank_simple.c) ---- */

/* Fits the triangle with the fewest pixels that only one of the two covers, among the candidates, face on and
 * from four oblique sides; a leaf of one triangle is its own. The triangle is opaque and fitted to the leaf's
 * opaque part. Corners are finite and lie within the leaf's bounding sphere grown by a half. */
void lod_simple_fit(struct lod_simple *simple, const struct lod_fan *leaf);

/* ---- Refining: from which key on an element is drawn, and its growth code (rank_refine.c) ---- */

/* The share of lod_rank_make's progress before the refinement. */
#define LOD_RANK_REFINE_FROM 0.7

struct lod_rank_refining {
	struct lod_crown *crown;
	const struct lod_rank_options *options;      /* progress, each, ctx */
	uint32_t count;              /* elements */
	uint32_t *order;             /* in and out */
	uint8_t *growth;             /* per element: in and out */
	bool many_points;            /* leaves are points far into the list */
};
/* False if progress returns false. The caller releases scratch memory of the arena. */
bool lod_rank_refine(const struct lod_rank_refining *refining, struct lod_arena *arena);
