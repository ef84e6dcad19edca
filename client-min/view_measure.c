#include "client-min/view_measure.h"

#include <stdlib.h>

#include "lod/raster/flip.h"

#define CEILING_SAMPLES 8u

static enum eco_code count(const struct view_reference_job *job, const struct view_picture *picture,
	uint32_t samples, uint8_t *counts, struct eco_error *error)
{
	struct view_coverage coverage = { picture->width, picture->height, samples, counts };
	return counts ? view_reference_count(job, &coverage, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for the samples of a picture");
}

enum eco_code view_measure_soft(const struct view_reference_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	if (!picture->soft)
		picture->soft = malloc((size_t)picture->width * picture->height);
	return count(job, picture, VIEW_SOFT_SAMPLES, picture->soft, error);
}

enum eco_code view_measure_ceiling(const struct view_reference_job *job, const struct view_picture *reference,
	double *ceiling, struct eco_error *error)
{
	size_t pixels = (size_t)reference->width * reference->height;
	uint8_t *counts = malloc(pixels);
	enum eco_code code = count(job, reference, CEILING_SAMPLES, counts, error);
	if (!code)
		*ceiling = lod_q_ceiling(counts, reference->cover, pixels);
	free(counts);
	return code;
}

enum eco_code view_measure_pair(const struct view_picture *picture, const struct view_picture *reference,
	float *error_map, struct view_measures *measures, struct eco_error *error)
{
	lod_score(&measures->score, &(struct lod_score_input){ picture->width, picture->height,
		picture->cover, reference->cover, picture->owner, reference->owner });
	measures->soft_q = lod_soft_q(picture->soft, reference->soft,
		(size_t)picture->width * picture->height);
	return lod_flip(&(struct lod_flip_input){ picture->width, picture->height, picture->rgb,
		reference->rgb, error_map }, &measures->picture_error, error);
}
