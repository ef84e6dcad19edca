/* How much of each texture a plan shows.
 *
 * A texture and its outline are lists of levels (ecofiles/format/texture.h). A plan has a cut of each, which
 * draws nothing: its end says how many levels are held, and that the last of them is shown, by all that have
 * this texture. Texels of colours may be so many pixels wide as the request says where the nearest plant that
 * shows them stands. Outlines are whole unless bytes have a price: a pixel shows one sample, and one of a
 * coarser outline is another, however narrow its texels are (lod/EXPERIMENTS.md, Textures). */
#pragma once

#include "lod/plan/allocation.h"

/* Pixels that a texel of a texture's last level is wide, at most, on plants that cuts of this anchor and band
 * draw; INFINITY where the eye may be among its leaves, or the texels' size is not known. */
double lod_texel_px(const struct lod_planner *p, uint32_t image, uint32_t anchor, uint8_t band);

/* Levels of colours that show a texture as the request says where texels of the last one are `px` pixels
 * wide. */
uint32_t lod_texture_levels(const struct lod_planner *p, uint32_t image, double px);

/* Cost of a pixel that is seen through `fewer` levels less than all of a texture whose last texels are `px`
 * pixels wide. As nothing is finer than the last level, it costs no more than texels of a pixel: else all
 * levels would cost alike where each is wide, around the eye. */
double lod_texel_loss(double px, uint32_t fewer);

/* Wrong pixels, too much and too little, for each that is seen through an outline of `levels` levels, 1 to its
 * number; INFINITY: it must be whole, as nobody measured it. */
double lod_outline_loss(const struct lod_planner *p, uint32_t outline, uint32_t levels);

/* Adds the cuts of its textures to a plan that has none. */
enum eco_code lod_plan_textures(struct eco_plan *plan, const struct lod_planner *p, struct eco_error *error);

/* Which levels of impostors are worth their bytes.
 *
 * All levels are one vertex, and the larger one is better at every size. But its bytes are paid once for all
 * plants of a kind, and where few of these are seen they buy more elsewhere. So a level is used if a byte of
 * it sets at least 0.1 of a pixel right, whatever the budget is: with a larger one nothing may
 * become worse (lod/EXPERIMENTS.md, Bytes of first visits).
 *
 * As a camera moves, a kind must not change its level at once: where a byte is just worth it, only the
 * largest plants have the level, and the others follow, the more a byte sets right, up to twice that. */

/* The pixels across from which a level shows plants: what is larger, up to LOD_IMPOSTOR_PIXELS. `times`: how
 * often it is worth its bytes; INFINITY below once. */
double lod_impostor_from(uint32_t level, double times);
/* Sets allocation->impostors, per plant, from the pixels that its slots show, `seen` of each. Above a price of
 * bytes a level must be worth that. */
void lod_impostor_worth(struct lod_allocation *allocation, const double *seen);
/* The level for the plants of a slot; ECO_NONE where the ladder has none, or where they are too large. */
uint32_t lod_impostor_of_slot(const struct lod_allocation *allocation, const struct lod_slot *slot,
	const struct lod_way *way);
