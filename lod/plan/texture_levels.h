/* How much of each texture a plan shows.
 *
 * A texture and its outline are lists of levels (ecofiles/format/texture.h). A plan has a cut of each, which
 * draws nothing: its end says how many levels are held, and that the last of them is shown, by all that have
 * this texture. Texels of colours may be so many pixels wide as the request says where the nearest plant that
 * shows them stands. Outlines are whole unless bytes have a price: a pixel shows one sample, and one of a
 * coarser outline is another, however narrow its texels are (lod/EXPERIMENTS.md, Textures). */
#ifndef LOD_TEXTURE_LEVELS_H
#define LOD_TEXTURE_LEVELS_H

#include "lod/plan/planner_state.h"

/* Pixels that a texel of a texture's last level is wide, at most, on plants that cuts of this anchor and band
 * draw; INFINITY where the eye may be among its leaves, or the texels' size is not known. */
double lod_texel_px(const struct lod_planner *p, uint32_t image, uint32_t anchor, uint8_t band);

/* Levels of colours that show a texture as the request says where texels of the last one are `px` pixels
 * wide. */
uint32_t lod_texture_levels(const struct lod_planner *p, uint32_t image, double px);

/* Cost in wrong pixels of a pixel that is seen through texels of `px` pixels (any above 0, or INFINITY):
 * little for each octave up to a pixel, then as much as for elements that are wider (lod/plan/README.md). */
double lod_texel_cost(double px);

/* Cost of a pixel that is seen through `fewer` levels less than all of a texture whose last texels are `px`
 * pixels wide. As nothing is finer than the last level, it costs no more than texels of a pixel: else all
 * levels would cost alike where each is wide, around the eye. */
double lod_texel_loss(double px, uint32_t fewer);

/* Wrong pixels, too much and too little, for each that is seen through an outline of `levels` levels, 1 to its
 * number; INFINITY: it must be whole, as nobody measured it. */
double lod_outline_loss(const struct lod_planner *p, uint32_t outline, uint32_t levels);

/* Adds the cuts of its textures to a plan that has none. */
enum eco_code lod_plan_textures(struct eco_plan *plan, const struct lod_planner *p, struct eco_error *error);

#endif
