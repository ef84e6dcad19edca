/* Drawing a selection in software: the reference that pictures are scored against, and what draws where there
 * is no OpenGL. Plants front to back, hidden ones skipped, by several threads: the same pixels whatever their
 * number. */
#ifndef VIEW_REFERENCE_H
#define VIEW_REFERENCE_H

#include "client-min/draw/view_light.h"
#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "lod/raster/blocks.h"
#include "lod/raster/raster.h"

/* Fills the picture, lit (view_light.h); vertices are those of the selection: hidden ones count as drawn. */
enum eco_code view_reference_draw(const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error);
/* The same, but colours are the mean light of samples x samples, evenly spread in each pixel and drawn in parts:
 * samples is at most 15, and costs less than as many pictures. */
enum eco_code view_reference_fine(const struct view_draw_job *job, uint32_t samples, struct view_picture *picture,
	struct eco_error *error);

/* Cover of each pixel by plants: the number of covered ones among samples x samples, evenly spread in it.
 * Memory is bounded, whatever the picture's size. */
struct view_coverage {
	uint32_t width, height, samples;         /* samples: at most 15 */
	uint8_t *count;                          /* one a pixel, the caller's: 0 to samples^2 */
};
enum eco_code view_reference_count(const struct view_draw_job *job, struct view_coverage *coverage,
	struct eco_error *error);

/* ---- Measures of a picture's error; samples are drawn in software, whatever drew the picture ---- */

/* Fills picture->soft, from VIEW_SOFT_SAMPLES x VIEW_SOFT_SAMPLES samples a pixel. */
#define VIEW_SOFT_SAMPLES 4u
enum eco_code view_measure_soft(const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error);
/* lod_q_ceiling of a reference, from 8 x 8 samples a pixel. */
enum eco_code view_measure_ceiling(const struct view_draw_job *job, const struct view_picture *reference,
	double *ceiling, struct eco_error *error);
/* How unsteady two frames of a camera are, over the truth's own motion (view_truth.h): shimmer, by the mean change of
 * sRGB bytes; pop, by that of whole blocks (lod_blocks_pop). They mean something for slow cameras only. rgb: before,
 * after. NaN: the truth does not change. */
struct view_motion { double shimmer, pop; };
void view_measure_motion(uint32_t width, uint32_t height, const uint8_t *const rgb[2], const uint8_t *const truth[2],
	struct view_motion *motion);
struct view_measures {
	struct lod_score score;
	double soft_q;                           /* lod_soft_q */
	double picture_error;                    /* mean of lod_flip */
	struct lod_block_error blocks;
};
double view_picture_error(const struct view_picture *picture, const struct view_picture *reference);
/* soft_q is NaN where a picture has no soft counts. `error_map`, if not NULL, receives lod_flip's error of each pixel. */
void view_measure_pair(const struct view_picture *picture, const struct view_picture *reference,
	float *error_map, struct view_measures *measures);

#endif
