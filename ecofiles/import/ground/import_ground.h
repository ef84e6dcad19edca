/* Shared by the reader of ground and ecogdal.so, which does the work in a child process. */
#ifndef ECO_IMPORT_GROUND_H
#define ECO_IMPORT_GROUND_H

#include <stdint.h>

#include "ecofiles/import/ground/ground.h"

/* Notes for the user travel to the parent with the samples. */
#define GROUND_NOTES_MAX 24u
#define GROUND_NOTE_BYTES 480u
struct ground_notes { uint32_t count; char text[GROUND_NOTES_MAX][GROUND_NOTE_BYTES]; };

/* The child writes notes, the struct eco_ground, then its samples. */
struct eco_ground_job {
	const struct eco_ground_options *options;
	uint32_t side_max;
	struct ground_notes notes;
};

#endif
