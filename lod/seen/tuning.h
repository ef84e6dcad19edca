/* Every number that steers a plan. Each has its unit and meaning beside it. Shares are 0 to 1, octaves are log2,
 * prices are wrong pixels a byte, work is counted in units of about 7 ns (struct lod_planner_stats). "..." goes on
 * in the next line. Experiments that chose them: lod/EXPERIMENTS.md, What a plan costs, Bytes of first visits,
 * Weight of the wrong owner, Larger leaves among other plants, Ties of splats, Textures, Impostors, Scattered
 * points. Tolerances of arithmetic and bounds of arrays are with the code that has them. */
#pragma once

/* ---- Errors seen, and hulls of them ---- */
#define LOD_SEEN_COLOR 0.05  /* of a difference of mean colours, a unit of CIELAB, ... */
#define LOD_SEEN_CONTRAST 0.025  /* ... and of deviations of lightness: half as much, or from .2 to 2 times,
				* is as good */
#define LOD_SEEN_NOTHING 1.7  /* about what is wrong with a pixel of a plant that is not there */
#define LOD_HULL_SLOPE_RATIO 1.25  /* for ladders: where a curve is nearly straight more points save nothing,
				* but more plants change as a camera moves */
#define LOD_HULL_BLUR 1.25  /* a step is taken in part at lambdas within this factor of its slope */
#define LOD_HULL_GROWTH 4u  /* samples grow by a quarter: curves are smooth */

/* ---- The coarse screen ---- */
#define LOD_SCREEN_COLUMNS 96u  /* cells across the picture */
#define LOD_OWNER_WEIGHT 0.5  /* of a false positive that covers another plant (visibility.h) */
#define LOD_SCREEN_AROUND 2.5  /* false positives of a plant lie in a box so much wider and higher than its
				* own */
#define LOD_SCREEN_SEEN_LEAST 1e-4  /* share seen of what is hidden or outside the picture: it may be seen
				* through an unknown gap */
#define LOD_SCREEN_HILL 1.0f  /* columns on either side of a foot in which ground hides */
#define LOD_SCREEN_CLUMPED 0.6  /* leaves stand along twigs: a picture shows as many as of so many random ones
				* (Nilson 1971; forests: 0.5 to 0.7) */
#define LOD_SCREEN_CLOSEST 0.25  /* of the larger half extent: nothing counts as nearer */
#define LOD_SCREEN_NEAR 2.0  /* half axes of a crown, to an eye that looks through it ray by ray */
#define LOD_SCREEN_SHADOW 0.003  /* of the pixels of its leaves: so many a near plant shows at least, for the
				* shadow that it casts from above the picture or beside it */
#define LOD_SCREEN_SHADE 1.5  /* what a pixel in the shadow of a crown counts, over one of the crown */
#define LOD_SCREEN_SHADE_FLAT 0.05  /* half axis upwards of a shadow, over those across */
#define LOD_SCREEN_STEM_ROWS 2  /* half as high, in rows: a stem shows beside its crown, a shadow on the
				* ground */
#define LOD_SCREEN_TRUNK 0.1  /* of a crown's half extent across: wood is no nearer than this */
#define LOD_SCREEN_DENSEST 0.66666667f  /* see cover_of */
#define LOD_SCREEN_SMALL 1.5  /* half as high, in rows: an ellipse is a box of its area */

/* ---- Summaries ---- */
#define LOD_SUMMARY_FILLING 0.5  /* splats lie where plants do: they fill gaps like half as many at random */
#define LOD_SUMMARY_SCALE_LEAST 0.01  /* area of splats over that of the leaves, at least */
#define LOD_SUMMARY_OCTAVES 2  /* between two numbers of points that are tried */

/* ---- Proxy shapes ---- */
#define LOD_STEM_LEAST 0.1  /* of half a plant's height: a stem below the crown is no shorter */
#define LOD_PLANT_CELL 0.6  /* of a cell's radius: so far it reaches beyond its middle, across */
#define LOD_PLANT_NARROWEST 0.5  /* of its radius: a plant without cells is no narrower */
#define LOD_PLANT_THINNEST 0.01  /* area of a plant over its radius squared: a plant without area is visible
				* all the same */
#define LOD_SPLAT_FACTOR 1.3  /* c_p, Deussen 2002, 5.1: 1.2 to 1.5 */

/* ---- Textures and impostors ---- */
#define LOD_TEXEL_COST_BELOW 0.01  /* of a pixel seen, for each octave of a texel's width up to a pixel */
#define LOD_TEXEL_COST_ABOVE 0.1  /* the same for each octave beyond a pixel */
#define LOD_TEXEL_COST_FROM -5.0  /* octaves of a pixel, from which on width costs */
#define LOD_TEXEL_COST_OCTAVES 3.0  /* octaves beyond a pixel that count */
#define LOD_OUTLINE_LOSS_MAX 0.4  /* share of an outline's opaque texels */
#define LOD_OUTLINE_WRONG 0.5  /* leaves behind a leaf hide half of what it has wrong */
#define LOD_IMPOSTOR_WRONG 1.5  /* what is wrong with an impostor, over what its curve says: curves are measured
				* without sun, whose light and shade are smooth on it */
#define LOD_IMPOSTOR_SIZE 1u  /* of eco_seen: what most plants are that an impostor shows */
#define LOD_IMPOSTOR_WORTH 0.1  /* pixels that a byte of a level must set right */

/* ---- The ground's image ---- */
#define LOD_IMAGE_SAMPLES 4  /* along each side of a tile, to count its pixels */
#define LOD_IMAGE_FLAT_LEAST 0.25  /* sine of the least angle that narrows texels */
#define LOD_IMAGE_COST 0.04  /* of a pixel, for each octave from ... */
#define LOD_IMAGE_COST_FROM -2.0  /* ... texels of a quarter of a pixel on, ... */
#define LOD_IMAGE_COST_OCTAVES 14.0  /* ... for so many octaves */
#define LOD_IMAGE_COST_NONE 0.6  /* of a pixel of ground in its plain colour */
#define LOD_IMAGE_PRICE 0.5  /* of a byte, for a rule that knows none */

/* ---- Deussen's rule ---- */
#define LOD_DEUSSEN_STEPS 256  /* of d': next to none of a budget is left */
#define LOD_DEUSSEN_PLACES 1000000u  /* plants looked at with a step, where summaries stand for the others */
#define LOD_DEUSSEN_HIT 0.7  /* of the points of a summary, which is not measured: on its plants */
#define LOD_DEUSSEN_NODE_WORK 300u  /* of a tile in view, from opening it at many steps to sending its cut */

/* ---- Weights of choices ---- */
#define LOD_FEW_PLANTS 40  /* in view: fewer than this change one by one in any case */
#define LOD_SMOOTH_BANDS 3  /* on either side count towards a slot's mean, ... */
#define LOD_SMOOTH_PLANTS 400.0  /* ... but less where there are more plants than this: most plants of many
				* are hidden */
#define LOD_CELLS_PART 8  /* of the work of a plan: cells of the screen in each of its passes; ... */
#define LOD_CELLS_LEAST 64u  /* ... a screen of so few stays */
#define LOD_WOOD_HIDDEN 0.2  /* share of wood that still counts where leaves cover it wholly: leaves are drawn
				* with holes */

/* ---- Relaxation ---- */
#define LOD_LAMBDA_COUNT 128  /* of the grid, down to where a vertex saves nothing visible; then 0 */
#define LOD_TIE_SHARE 0.1  /* tiles and gates blend where both choices differ by less than this share of what
				* the finer one costs, errors and vertices */
#define LOD_TIE_STEP 0.25  /* splats and organs blend where what organs save differs by less than this share
				* from what their vertices cost */

/* ---- Limits of bytes ---- */
#define LOD_PRICE_ROUNDS 2  /* of limits at each lambda and price */
#define LOD_GROUND_LEAST 0.1  /* share of the ground that shows, at least */

/* ---- Prices, log2 ---- */
#define LOD_PRICE_LOWEST -30.0  /* wrong pixels a byte: nothing is worth so little, ... */
#define LOD_PRICE_HIGHEST 30.0  /* ... or so much */
#define LOD_PRICE_LOW -10.0  /* octaves: at lower prices hardly anything is left out */
#define LOD_PRICE_SLACK 0.03  /* share of the bytes that may be left */
#define LOD_PRICE_NEAR 0.25  /* the same from a price that nearly fits */
#define LOD_PRICE_USUAL -1.0  /* octave of the first price tried; the next is one further, then twice as far */
#define LOD_PRICE_STEP 0.1  /* octaves to which a price is searched */
#define LOD_PRICE_SEARCHES 5  /* of a search, whatever work is done: the highest price draws nothing */

/* ---- Kinds that share bytes ---- */
#define LOD_KIND_PRICES { 0, 1.5, 0.5, -0.125, -0.5, -1, -2 }  /* octaves, beside that of tiles, whose limits a kind may
				* have; the first is that price */
#define LOD_KIND_TEXTURES { 1, 4 }  /* times the price of tiles, that a kind's textures may pay */
#define LOD_KIND_BINS 256  /* of the bytes that kinds share */
#define LOD_KIND_ENOUGH 0.985  /* of the bytes: kinds need share none */
#define LOD_KIND_TRIES 5  /* of a mix: tiles that choose others need bytes, too */

/* ---- Fill ---- */
#define LOD_LAMBDA_STEP 0.1  /* a lambda that fits in the mean may not fit with whole plants: it is raised by
				* this share, then by twice as much each time, until it fits */

/* ---- Few plants ---- */
#define LOD_FEW_BINS 256u  /* into which a budget of vertices is divided; fewer where ... */
#define LOD_FEW_TRIES (1u << 18)  /* ... so many options in bins are tried */
#define LOD_FEW_PARTS 32u  /* into which a step is divided, at most */
#define LOD_CELL_LAMBDAS 48  /* for all cells: none, then an eighth of an octave apart from ... */
#define LOD_CELL_STEP 0.917004  /* ... */
#define LOD_CELL_HIGHEST 8  /* ... so many times that of the relaxation on */

/* ---- Explanations ---- */
#define LOD_ROW_WORK 2400u  /* of a bounded plan for each row that is made and written: four times what it
				* takes */

/* ---- Cuts ---- */
#define LOD_PART_PX 8.0  /* narrower points look no better (lod/EXPERIMENTS.md, Scattered points) */
#define LOD_LEAF_GROWTH 0.6  /* at most so much is added to leaves' areas among other plants */
#define LOD_LEAF_MISSED 0.15  /* share of a plant's pixels missed from which all of GROWTH is added */
#define LOD_SCALE_STEPS 8  /* rounds scales, so that bands of nearly one scale are one cut */
#define LOD_SCALE_NEARLY 0.03125f  /* areas that differ by no larger share are one */

/* ---- Ground within bytes ---- */
#define LOD_GROUND_STEP 4.0  /* how much coarser ground becomes at once */
#define LOD_GROUND_PX_SCARCE 2.0  /* at least so coarse it is where bytes bind */
#define LOD_GROUND_PART 4u  /* ground takes at most this part of the bytes */
#define LOD_SIZING_WORK 12u  /* a cut or a list whose bytes are counted */

/* ---- Search for lambda, and levels of detail ---- */
#define LOD_LAMBDA_HIGHEST 30  /* octaves: more pixels than a picture can have */
#define LOD_LAMBDA_TRIES 6  /* halvings between two grid lambdas, ... */
#define LOD_LAMBDA_SLACK 0.001  /* ... which ends when no more than this share of the budget is unused */
#define LOD_LAMBDA_UNUSED 0.01  /* a larger share asks for other tiles and gates, of few plants in view */
#define LOD_TILES_PX 0.5  /* sample distance to which tiles are opened, ... */
#define LOD_CELLS_PX 1.0  /* ... and cells; less at finer levels */
#define LOD_FINER_OCTAVES 3  /* from one level to the next */
#define LOD_FINER_TIMES 3  /* levels above 0; the last opens all */
#define LOD_SMALL_STEPS 4  /* levels below 0 that are one octave apart */
#define LOD_COARSEST -12  /* level: the last that is tried */
#define LOD_PLACES_MOST 100000u  /* plants that one level walks over */
#define LOD_CELLS_WORK 64  /* of a plan, for each cell of a plant, where all are drawn */
#define LOD_PLACES_WALKS 4  /* as large as may be, that the work allows */
#define LOD_SLOT_CHOICES 3  /* work of a plan, over that of one pass over all choices: these are how many of a
				* slot, usually */
#define LOD_FINER_WORK 4  /* of a finer level, over that of a level */
#define LOD_PASSES_VERTICES 74  /* over all choices, in a plan for vertices */
#define LOD_PASSES_BYTES 172  /* the same within bytes */
#define LOD_PASSES_EVERYTHING 8  /* no search: an end of the grid, the fill, and its prediction */
#define LOD_NODE_BYTES 2  /* times that a tile is passed in each of these */
#define LOD_HIDDEN_MOST 0.05  /* of what a picture has */
#define LOD_TALLIES_UNCHANGED 2  /* one of so many tallies is summed again, for the others nothing changed */
#define LOD_PASS_TALLIES 4  /* so many tallies that are only passed take the work of one that is summed */

/* ---- Answers within bytes ---- */
#define LOD_PRICE_LAMBDAS 3  /* tried below that one, where vertices bind as well */
/* A search takes the plan to so many times the work of that for the vertices alone, which is about twice that
 * with its coarser answers: without a bound the worst rows are 3 to 15 times, for .6 % fewer wrong pixels */
#define LOD_BYTES_WORK 6
#define LOD_FEW_SLACK 8u  /* of the vertices that fit: 1 / so many may be missed */
#define LOD_FEW_FALL 4  /* vertices of one try over those of the next, where hardly any fit */
#define LOD_SIZE_TRIES 5  /* answers whose bytes are counted */
#define LOD_TIMES_COARSER 16.0  /* their bytes count chunks of coarser answers that the answer lacks */
#define LOD_SWEEP_STEP 0.375  /* octaves of the price to the next one tried, at least ... */
#define LOD_SWEEP_STEP_MOST 3.0  /* ... and at most; half of it at least once that work is done, where bytes do not bind: ... */
#define LOD_SWEEP_LATE_RATIO 2.5  /* ... answers have so many times fewer bytes then */

/* ---- Vertices for a rule that knows no bytes ---- */
#define LOD_SEARCH_MOST 0.9  /* of the bytes that are allowed, or of the vertices: aim of the next plan */
#define LOD_SEARCH_PART 8u  /* of the work may each plan of it take: 1 / so many */

/* ---- Work ---- */

/* Weights of the work that is counted, by measurement (lod/EXPERIMENTS.md, What a plan costs). */
enum lod_work_weight {
	LOD_WORK_PLACE = 24,         /* a plant looked at */
	LOD_WORK_NODE = 6,           /* a tile, a tally, a choice, a candidate, each time it is passed */
	LOD_WORK_TALLY = 2,
	LOD_WORK_CHOICE = 5,
	LOD_WORK_CANDIDATE = 2,
	LOD_WORK_CURVE = 10,         /* a curve read anywhere on it */
	LOD_WORK_SUMMARY = 300,      /* the hull of a summary */
	LOD_WORK_VISIBILITY = 16,    /* a plant on the coarse screen, and a cell of it */
	LOD_WORK_CELL = 1,
	LOD_WORK_CUT = 3             /* a cut compared with another */
};
