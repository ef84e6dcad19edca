/* How much of the ground's image a plan shows (ecofiles/format/ground_tile.h).
 *
 *   lod_image_see(&image, scene, &eye, &view, texel_px, &error);    once a request: tiles in view
 *   lod_image_bytes(&image, scene, holdings, price)                 what comes at a price of bytes
 *   lod_image_cuts(&image, scene, holdings, price, cuts)            the same as cuts
 *   lod_image_free(&image);
 *
 * A tile shows some of its levels, or its four children show what lies in it: the tiles of a plan are leaves
 * of the tree, and cover what they can of the ground in view. Texels are chosen no narrower than `texel_px`
 * pixels, counted between their width and the height that is left of it where the ground is seen flatly. A
 * pixel costs the more, in wrong pixels, the wider the texels are that it is seen through: IMAGE_COST for
 * each octave. Bytes that the client lacks cost the price that plants' lists cost (byte_price.h), so that
 * both compete for a budget. Costs of tiles add up: for each price the choice is the best there is. */
#pragma once

#include "ecofiles/format/plan.h"
#include "lod/eye.h"

struct lod_image_node;
struct lod_image {                       /* zero: no image in view */
	struct lod_image_node *nodes; uint32_t count;    /* children behind their parents */
	double share;                    /* of the ground's pixels, that no plant hides */
};

/* `eye` is that of `view`. */
enum eco_code lod_image_see(struct lod_image *image, const struct eco_scene *scene, const struct lod_eye *eye,
	const struct eco_view *view, double texel_px, struct eco_error *error);
void lod_image_free(struct lod_image *image);

/* `holdings` may be NULL. A price of 0: bytes do not count. The higher the price, the fewer. */
double lod_image_bytes(const struct lod_image *image, const struct eco_scene *scene,
	const struct eco_holdings *holdings, double price);
/* Room for image->count cuts; returns how many there are, by list. */
uint32_t lod_image_cuts(const struct lod_image *image, const struct eco_scene *scene,
	const struct eco_holdings *holdings, double price, struct eco_cut *cuts);
