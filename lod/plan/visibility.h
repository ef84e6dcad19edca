/* What plants share of the picture: how much of each shows among the others, and what all of them together are expected to cover. Both on a
 * coarse grid of cells over the screen, from where plants stand and how dense they are: nothing is drawn.
 *
 *   lod_screen_init(&screen, &eye, &view, ground);
 *   visibility = lod_screen_add(&screen, center, &proxy shape) ...          one for each plant, or for a tile whose plants are not looked at
 *   lod_screen_shares(&screen, hide, &error)                    front to back: sets every visibility's share
 *   lod_screen_expect(&screen, wrong, ctx, &prediction, &error) given how well each visibility is drawn: pixels right and wrong
 *   lod_screen_free(&screen)
 *
 * A plant's crown is an upright ellipse, equally dense all over: light passes through a share of exp(-area / 2 / ellipse) of it (random
 * leaves in random directions). What lies behind is seen through that. Where a scene has ground, a plant's foot is a point of it:
 * whatever is farther away along the ground and lower on the screen than a foot in the same column is behind the ground. (Not in depth: seen from
 * above, what is lower on a slope is deeper, and not hidden.)
 *
 * Of a plant whose middle is not before the eye it is not known where in the picture it is, and its box is larger than the picture. It shows
 * much where the eye is within it, and mostly nothing where it is not: e^-r^2 of its box, r being its distance in its own radii. (In four
 * views among trees such plants would show 1,340,000 pixels by their boxes, and showed 350,000.) Without that each one that comes by would
 * take a part of the budget from all others, and give it back.
 *
 * Measured and left: such a plant as 64 proxy shapes, each where it is. 1 % fewer pixels are wrong among trees (7 at 100,000 vertices), but
 * shares change faster: 28 % of like plants at once at worst, in place of 17.
 *
 * What shows of a plant is what light lets through from before it. What is drawn of it too much is wrong where no other plant is, before it nor
 * behind; elsewhere it is covered anyway, but by the wrong plant: that counts LOD_OWNER_WEIGHT. So does all that a tile's summary covers, as no one
 * can tell whose its splats are; else near trees become heaps of squares, which cover well. Wrong pixels in thousands, of four views each of a
 * dense forest, an outdoor scene and 640 trees, at 30,000 to 1,000,000 vertices:
 *
 *   .3 for plants, nothing for summaries     186 406   -
 *   .1                                       181 402 347
 *   .15                                      180 402 342
 *   .2                                       181 401 344
 *   .05 for plants, .3 for summaries         220 404 349
 *
 * With .2 owners are right a little more often (owner Q of the outdoor scene + .002, of the forest from above + .05), but the outdoor scene has
 * 1 % more wrong pixels, and more like plants change at once; with .3 twice as many.
 *
 * Expected pixels, in each cell, as if visibilities were independent of each other: none covers it in the reference, none as drawn, none in
 * either: products over visibilities. Wrong pixels are those covered in one and not in the other; so holes in one plant are filled by
 * others behind it, and what is drawn beside a plant is not wrong where another stands. */
#ifndef LOD_VISIBILITY_H
#define LOD_VISIBILITY_H

#include "lod/eye.h"

#define LOD_SCREEN_COLUMNS 96u
#define LOD_OWNER_WEIGHT 0.15

struct lod_visibility {
	float x, y;                  /* centre, in cells from the top left */
	float reach_x, reach_y;      /* half of its box, in cells: all of the plant */
	float crown_y, crown_reach_x, crown_reach_y;     /* where its leaves are: what hides others and covers */
	float foot;                  /* row of its foot */
	float depth;                 /* metres in front of the eye */
	float range;                 /* the same along level ground; 0 of what lies behind, looking steeply down */
	float opacity;               /* of its crown, at full detail */
	float pixels;                /* covered at full detail, seen or not */
	double shown;                /* opacity in a picture, where its leaves stand along twigs: set by lod_screen_shares */
	float bottom;                /* row from which on ground hides it: set by lod_screen_shares */
	float share;                 /* of it that is in the picture and shows: set by lod_screen_shares; above 0 */
	float unoccluded;                  /* what weighs a pixel too many where a missing one weighs share; not above that */
	float ellipse;               /* pixels of its crown, gaps and all */
	uint32_t node, slot;         /* the caller's */
	uint16_t hash;               /* the caller's */
	float above;                 /* the caller's: how far from above it is seen (lod_seen_above) */
	bool beside;                 /* not before the eye, but around it: where it is in the picture is not known */
	float within;                /* of one near by: so much counts of what its box shows; 1 where `before` is 1, 0 where none of it is before the eye */
	float before;                /* of one near by: how much of it hides others; 0 where it is beside, 1 from twice as far before the eye on */
};

struct lod_screen {
	const struct lod_eye *eye;
	uint32_t columns, rows;
	double cell_x, cell_y;       /* pixels */
	bool ground;
	struct lod_visibility *visibilities;    uint32_t count, capacity;
};

/* `ground`: feet stand on ground that hides. `eye` must outlive the screen. */
void lod_screen_init(struct lod_screen *screen, const struct lod_eye *eye, const struct eco_view *view, bool ground);
void lod_screen_free(struct lod_screen *screen);

/* What a metre upwards, and one along the ground towards the eye or away, is up or down the picture at the same depth. */
struct lod_tilt { double upright, level; };
/* Of a place `from_eye` away; where that is not `closest` before the eye, as in the middle of the picture. */
struct lod_tilt lod_tilt_at(const struct lod_eye *eye, const double from_eye[3], double closest);
/* Half the height of an ellipsoid in the picture, in metres at its depth: seen from above it is as high as it is wide. */
double lod_tilt_height(const struct lod_tilt *tilt, double across, double up);

/* The shape of what is seen, about a centre: half extents across and upwards, its leaf area (a leaf counted once), in metres; and those of its
 * crown, whose centre is `rise` above. */
struct lod_proxy_shape { double across, up, area, crown_across, crown_up, rise; };
/* Adds a proxy shape at `center` (world). The caller sets what is its own; NULL without memory. */
struct lod_visibility *lod_screen_add(struct lod_screen *screen, const double center[3], const struct lod_proxy_shape *proxy_shape);

/* Expected share of an ellipse of its size that a crown covers, at full detail. */
double lod_proxy_shape_opacity(const struct lod_proxy_shape *proxy_shape);

/* Without `hide` only what lies beside the picture counts as not seen. */
enum eco_code lod_screen_shares(struct lod_screen *screen, bool hide, struct eco_error *error);

/* How a visibility is drawn: pixels too many and missing, over those that it covers; fn at most 1. While no visibility's fn nor fp + fn rises, no more
 * pixels are expected to be wrong. */
struct lod_wrong { double fp, fn; };

typedef struct lod_wrong (*lod_wrong_fn)(void *ctx, const struct lod_visibility *visibility);
enum eco_code lod_screen_expect(const struct lod_screen *screen, lod_wrong_fn wrong, void *ctx, struct eco_prediction *prediction,
	struct eco_error *error);

/* e^-x for x >= 0 and the logarithm of x > 0, the same on every machine, to about nine digits. */
double lod_exp_minus(double x);
double lod_log(double x);

#endif
