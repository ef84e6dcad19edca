/* Shared by the readers of ground and of its image, and ecogdal.so, which does the work in a child
 * process. */
#pragma once

#include <stdint.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/import/model/import_file.h"

/* The child writes notes, the struct eco_ground, then its samples. */
struct eco_ground_job {
	const struct eco_ground_options *options;
	uint32_t side_max;
	struct eco_notes notes;
};

#define GROUND_IMAGE_DEPTH 24u           /* of the tree, at most */

/* The child writes the head, then a byte for each square, depth first: 1 if it is split; else 0 and
 * texels. */
struct ground_image_head { struct eco_notes notes; double low[2], texel_m; };

struct eco_ground_image_job {
	const struct eco_ground_image_options *options;
	bool only_look;                          /* ends after the head */
	struct ground_image_head head;
};
