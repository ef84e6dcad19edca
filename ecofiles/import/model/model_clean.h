/* The last steps of every reader of models. */
#ifndef ECO_MODEL_CLEAN_H
#define ECO_MODEL_CLEAN_H

#include "ecofiles/import/model/model_import.h"

struct eco_model_frame;
struct eco_notes;

/* Takes a soup as read: Z up, any place and size, anything in its indices and coordinates; triangles_in =
 * triangle_count + triangles that the reader dropped; frame: base and unit, 0 if not stated. Drops and
 * counts bad indices, coordinates that are not finite or beyond 1e9, triangles without area, duplicates
 * (by position, within a material, whatever their winding), and parts that rules leave out. Puts the plant
 * on its foot, scales it to height_m or to metres, and keeps only vertices, materials, parts and images in
 * use. Of the options it uses height_m, unit_m and rules. Errors name `what`. */
enum eco_code eco_model_clean(struct eco_model *model, const struct eco_model_frame *frame,
	const struct eco_model_options *options, const char *what, struct eco_notes *notes,
	struct eco_error *error);

/* One of its steps (model_stand.c): foot to x = y = 0, ground to z = 0, then the height. `place` is from
 * eco_model_places. */
enum eco_code eco_model_stand(struct eco_model *model, const uint32_t *place,
	const struct eco_model_frame *frame, const struct eco_model_options *options, const char *what,
	struct eco_notes *notes, struct eco_error *error);

#endif
