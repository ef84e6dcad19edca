/* Visibility of each plant: how much of it shows among the others; and the pixels that all plants together
 * are expected to cover. Both are computed on a coarse grid of cells over the picture from proxy shapes,
 * where plants stand and how dense they are. Nothing is drawn.
 *
 *   lod_screen_init(&screen, &eye, &view, ground);
 *   lod_screen_add(&screen, center, &proxy_shape)         for each plant, and each tile that is not opened
 *   lod_screen_shares(&screen, hide, &error)              front to back: sets every visibility's share
 *   lod_screen_expect(&screen, wrong, ctx, &p, &error)    pixels right and wrong, by each visibility's error
 *   lod_screen_free(&screen)
 *
 * Leaves fill an upright ellipsoid evenly, the crown, seen in perspective (outline.h). They stand in clumps, so a
 * share exp(-.6 layers) of light passes (Beer's law; Nilson 1971), where layers are the leaves that face the eye on
 * its way through the crown: the mean way, or near the eye the way of each ray. Wood below the crown is an opaque
 * stem. From the nearest plant to the farthest each takes its part of the light that is left in each cell: that is
 * what shows of it, and all plants together show no more than the picture has.
 *
 * In a scene with ground a plant's foot is a point of it. Whatever is farther away along the ground and lower in
 * the picture than a foot in the same column is behind the ground. The distance is along the ground, not depth: seen
 * from above, what is lower on a slope is deeper and not hidden.
 *
 * Wood stands upright on a plant's axis. From afar it is as far away as the plant's middle and all leaves are
 * before it; who stands at a trunk sees it larger, and fewer leaves, or none, between.
 *
 * A false positive of a plant is wrong only where no other plant is, in front or behind; elsewhere the pixel
 * is covered anyway, by the wrong plant, which counts LOD_OWNER_WEIGHT. All that a tile's summary covers
 * counts so too, as nothing tells which plant a splat stands for; else near trees become heaps of squares
 * (lod/EXPERIMENTS.md, Weight of the wrong owner).
 *
 * Expected pixels are computed per cell as if visibilities were independent: the probability that no plant
 * covers a point in the reference, as drawn, or in either is a product over visibilities. Wrong pixels are
 * covered in one and not in the other. So plants behind fill holes, and a false positive is not wrong where
 * another plant stands. A summary's splats have a cover of their own, not by each plant's error: they are
 * often wider than crowns. */
#pragma once

#include "lod/seen/tuning.h"
#include "lod/seen/outline.h"
#include <stdint.h>

struct lod_runs { uint32_t first; uint16_t row, end; };      /* an outline's cells in rows [row, end) */
struct lod_stem { struct lod_outline outline; struct lod_runs runs; };

struct lod_visibility {
	float foot_x, foot;          /* column and row of its foot */
	float depth;                 /* metres in front of the eye */
	float distance;              /* metres from the eye to its middle */
	float range;                 /* metres along level ground; 0 if behind, when looking steeply down */
	float opacity;               /* of its crown, at full detail, if leaves stood at random */
	float shown;                 /* the same of clumped leaves; of a near one, in the picture */
	float density;               /* layers of clumped leaves that face the eye, a metre of way */
	float pixels;                /* covered at full detail, seen or not; of a near one, in the picture */
	float bottom;                /* set by lod_screen_shares: row from which on ground hides it */
	float share;                 /* set by lod_screen_shares: part of it in the picture and visible; above
	                              * 0 */
	float unoccluded;            /* set by lod_screen_shares: share times the weight of a false positive;
	                              * at most share */
	float ellipse;               /* pixels of its crown, gaps included; of a near one, in the picture */
	float leaves;                /* pixels of all its leaves, each by itself */
	float shade;                 /* pixels in view of its shadow, a disc below the crown, each by what it counts */
	struct lod_runs crown;       /* set by lod_screen_shares */
	uint32_t stem;               /* in the screen's stems, + 1; 0: it shows none beside its crown */
	uint32_t shadow;             /* likewise; 0: too small */
	bool near;                   /* the eye is in its crown or next to it: each ray has its way */
	uint32_t node, slot;         /* the caller's */
	uint16_t hash;               /* the caller's */
	float above;                 /* the caller's: how far from above it is seen (lod_seen_above) */
	float wood_nearer;           /* pixels of its wood, over those at the distance of its middle; 1 or
	                              * more */
	float wood_behind;           /* part of its crown's leaves that lie before its axis */
	float before;                /* how much its foot's ground hides: 0 beside the eye, 1 from twice as far
	                              * in front of it on */
};

struct lod_screen {
	const struct lod_eye *eye;
	uint32_t columns, rows;
	double cell_x, cell_y;       /* pixels */
	double per_x, per_y;         /* cells per length 1 of the image plane at distance 1 */
	bool ground;
	struct lod_visibility *visibilities;    uint32_t count, capacity;
	struct lod_outline *crowns;          uint32_t crown_capacity;        /* as many */
	struct lod_stem *stems;      uint32_t stem_count, stem_capacity;
	struct lod_run *runs;        uint32_t run_count, run_capacity;
	uint32_t shared;             /* of so many the shares are found; a caller that drops any says 0 */
};

/* `ground`: feet stand on ground that hides. `eye` must outlive the screen. */
void lod_screen_init(struct lod_screen *screen, const struct lod_eye *eye, const struct eco_view *view,
	bool ground);
void lod_screen_free(struct lod_screen *screen);

/* Half the height of an upright ellipsoid as seen from afar, in metres: from above it is as high as wide. */
double lod_height_seen(double across, double up, const double from_eye[3]);

/* A plant, or a tile, in metres. */
struct lod_proxy_shape {
	double across, up;           /* half extents of all of it */
	double area, leaf_area;      /* of all organs, and of those in the crown; a leaf counted once */
	double crown_across, crown_up, rise; /* half axes of its crown, whose centre is `rise` above its own */
	double stem;                 /* radius of the wood below the crown; 0: there is none */
};
/* Adds a proxy shape at `center` (world). The caller sets its own fields. NULL without memory. */
struct lod_visibility *lod_screen_add(struct lod_screen *screen, const double center[3],
	const struct lod_proxy_shape *proxy_shape);

/* Share of its ellipse that a crown is expected to cover at full detail. */
double lod_proxy_shape_opacity(const struct lod_proxy_shape *proxy_shape);

/* Cells that all of them touch, those around each included: the work that they are. */
uint64_t lod_screen_cells(const struct lod_screen *screen);
/* Half as many columns and rows, with all that was added. */
void lod_screen_coarsen(struct lod_screen *screen);
/* Sets shares, unless they are found. Without `hide` only what is outside the picture is not seen. */
enum eco_code lod_screen_shares(struct lod_screen *screen, bool hide, struct eco_error *error);

/* Error of a visibility as drawn, over the pixels that it covers: false positives and false negatives; fn at
 * most 1. While neither fn nor fp + fn of any visibility rises, the expected wrong pixels do not rise. */
struct lod_wrong { double fp, fn; };

/* Splats of a summary that stand for a visibility, in the mean: squares of `side` pixels. They lie on its
 * crown by chance and reach beyond it (lod/seen/visibility.c). */
struct lod_splats { double count, side; };

/* How a visibility is drawn: by `splats` where there are any, else with an error. */
struct lod_drawn { struct lod_wrong wrong; struct lod_splats splats; };

typedef struct lod_drawn (*lod_drawn_fn)(void *ctx, const struct lod_visibility *visibility);
enum eco_code lod_screen_expect(const struct lod_screen *screen, lod_drawn_fn drawn, void *ctx,
	struct eco_prediction *prediction, struct eco_error *error);

/* e^-x for x >= 0 and log x for x > 0, the same on every machine, to about nine digits. */
double lod_exp_minus(double x);
double lod_log(double x);
/* log2 of the side of a square of area x; 0 where there is none. */
double lod_octaves(double x);
