/* The picture that others are judged by: full detail, its light the mean of 64 samples a pixel. */
#ifndef VIEW_TRUTH_H
#define VIEW_TRUTH_H

#include "client-min/view_reference.h"

#define VIEW_TRUTH_SIDE 8u               /* samples along each side of a pixel */
/* Replaces the colours of `picture`, which the job's selection drew, by those of the truth, drawn in software.
 * dir: a folder of truths by pack, view, light and program, where it is looked for first and kept; or NULL.
 * *cpu_ms: processor time of drawing; 0 where it was kept. */
enum eco_code view_truth_draw(const struct view_draw_job *job, const char *dir, struct view_picture *picture,
	double *cpu_ms, struct eco_error *error);

#endif
