/* Shared by the reader of the ground's image and ecogdal.so, which does the work in a child process. */
#ifndef ECO_IMPORT_GROUND_IMAGE_H
#define ECO_IMPORT_GROUND_IMAGE_H

#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/import/ground/import_ground.h"

#define GROUND_IMAGE_DEPTH 24u           /* of the tree, at most */

/* The child writes the head, then a byte for each square, depth first: 1 if it is split; else 0 and
 * texels. */
struct ground_image_head { struct ground_notes notes; double low[2], texel_m; };

struct eco_ground_image_job {
	const struct eco_ground_image_options *options;
	bool only_look;                          /* ends after the head */
	struct ground_image_head head;
};

#endif
