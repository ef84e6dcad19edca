/* The steps after every reader of models, and what each needs. */
#pragma once

#include "ecofiles/import/model/import_model.h"
#include "ecofiles/import/model/model_parts.h"

/* Takes a soup as read: Z up, any place and size, anything in its indices and coordinates; triangles_in =
 * triangle_count + triangles that the reader dropped; frame: base and unit, 0 if not stated. Drops and
 * counts bad indices, coordinates that are not finite or beyond 1e9, triangles without area, duplicates
 * (by position, within a material, whatever their winding), and parts that rules leave out. Puts the plant
 * on its foot, scales it to height_m or to metres, and keeps only vertices, materials, parts and images in
 * use. Options used: height_m, unit_m, rules. Errors name `what`. */
enum eco_code eco_model_clean(struct eco_model *model, const struct eco_model_frame *frame,
	const struct eco_model_options *options, const char *what, struct eco_notes *notes,
	struct eco_error *error);

/* ---- Its steps ---- */

struct model_clean {
	struct eco_model *model;
	const struct eco_model_frame *frame;
	const struct eco_model_options *options;
	const char *what;
	struct eco_notes *notes;
	struct eco_error *error;
	uint32_t *place;             /* per vertex, of eco_model_places */
	uint8_t *why;                /* per triangle, for model_drop */
};

/* Keeps the triangles whose `why` is ECO_DROP_COUNT; counts the others. */
void model_drop(struct eco_model *model, const uint8_t *why);
/* Applies the first rule that fits each triangle: drops and counts it (ECO_DROP_LEFT_OUT), or sets
 * model->organ and, where a rule gives one, model->importance. Notes rules that fit nothing, with the names
 * there are. Fails if no triangle is left. */
enum eco_code model_apply_rules(struct model_clean *clean);
/* Foot to x = y = 0, ground to z = 0, then the height. */
enum eco_code model_stand(struct model_clean *clean);

/* ---- What else the shape says ---- */

/* The axis of a model that points up, by shape alone: formats rarely state it, and exporters disagree.
 *
 * A plant shows it from the side. It stands on a narrow foot, under its centre of mass, and spreads from
 * there; seen from above it is about as wide as deep; to the sides both ends are alike, and end in a few
 * leaves. If leaves reach to the ground, its large parts (stems, boughs, pots) still show this. Each of
 * these properties, measured along the file's y and z axes, is a contrast between the two in [-1, 1];
 * their weighted sum decides, and its size is the certainty. The file's zero at one end of one axis only
 * counts a little.
 *
 * Returns ECO_UP_Y or ECO_UP_Z of a soup with the file's axes. Triangles that are not usable do not count.
 * `certainty` receives 0 (no idea, and the answer is ECO_UP_Y) to 1. Scale does not matter. Linear in the
 * triangles, and the same answer on every machine. Without memory large parts are not used. -0 becomes 0. */
enum eco_up eco_model_find_up(struct eco_model *soup, double *certainty);
/* Act on the answer from this certainty on; below it keep the format's convention. */
#define ECO_UP_CERTAIN 0.5
