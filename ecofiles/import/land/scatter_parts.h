/* Shared by the files of scatter; private. */
#pragma once

#include "ecofiles/import/land/areas.h"
#include "ecofiles/import/land/scatter.h"

struct eco_scatter_input {       /* the files' content, in metres from the origin */
	struct eco_areas areas;
	double *number;              /* per area: its density or count; NULL: no such column */
	struct eco_areas clear;
	struct eco_areas_report report;
};

/* Areas and what is to be clear (areas.c). */
enum eco_code eco_scatter_read(struct eco_scatter_input *input, const struct eco_scatter_spec *spec,
	const struct eco_frame *frame, struct eco_error *error);
void eco_scatter_input_free(struct eco_scatter_input *input);

/* ---- Places (words/blue_noise.tsv) ---- */

#define ECO_BLUE_NOISE_POINTS 4096u

/* x and y in 1/65536 of the square's side; the first n points are evenly spread for any n. */
void eco_blue_noise(uint16_t points[ECO_BLUE_NOISE_POINTS][2]);
