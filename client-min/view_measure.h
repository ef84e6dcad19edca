/* Measures of a picture's error, for ecoview and ecobench.
 *
 *   view_measure_soft(&job, &picture, &error);         for both pictures
 *   view_measure_ceiling(&job, &reference, &ceiling, &error);
 *   view_measure_pair(&picture, &reference, NULL, &measures, &error);
 *
 * All samples are drawn in software, whoever drew the pictures. */
#ifndef VIEW_MEASURE_H
#define VIEW_MEASURE_H

#include "client-min/view_reference.h"
#include "lod/raster/raster.h"

/* Fills picture->soft, from VIEW_SOFT_SAMPLES x VIEW_SOFT_SAMPLES samples a pixel. */
#define VIEW_SOFT_SAMPLES 4u
enum eco_code view_measure_soft(const struct view_reference_job *job, struct view_picture *picture,
	struct eco_error *error);

/* lod_q_ceiling of a reference, from 8 x 8 samples a pixel. */
enum eco_code view_measure_ceiling(const struct view_reference_job *job, const struct view_picture *reference,
	double *ceiling, struct eco_error *error);

struct view_measures {
	struct lod_score score;
	double soft_q, picture_error;    /* lod_soft_q; the mean of lod_flip */
};
/* Both have their soft counts. `error_map`, if not NULL, receives lod_flip's error of each pixel. */
enum eco_code view_measure_pair(const struct view_picture *picture, const struct view_picture *reference,
	float *error_map, struct view_measures *measures, struct eco_error *error);

#endif
