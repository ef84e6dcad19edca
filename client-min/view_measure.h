/* Measures of a picture's error, and the truth that its colours are judged by: full detail, the mean light of
 * 64 samples a pixel. Samples are drawn in software, whatever drew the picture. */
#pragma once

#include "client-min/view_reference.h"
#include "lod/raster/blocks.h"

/* Fills picture->soft, from VIEW_SOFT_SAMPLES x VIEW_SOFT_SAMPLES samples a pixel. */
#define VIEW_SOFT_SAMPLES 4u
enum eco_code view_measure_soft(const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error);
/* lod_q_ceiling of a reference, from 8 x 8 samples a pixel. */
enum eco_code view_measure_ceiling(const struct view_draw_job *job, const struct view_picture *reference,
	double *ceiling, struct eco_error *error);
/* How unsteady two frames of a camera are, over the truth's own motion: shimmer, by the mean change of sRGB
 * bytes; pop, by that of whole blocks (lod_blocks_pop). They mean something for slow cameras only. rgb:
 * before, after. NaN: the truth does not change. */
struct view_motion { double shimmer, pop; };
void view_measure_motion(uint32_t width, uint32_t height, const uint8_t *const rgb[2],
	const uint8_t *const truth[2], struct view_motion *motion);
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

#define VIEW_TRUTH_SIDE 8u               /* samples along each side of a pixel */
/* Replaces the colours of `picture`, which the job's selection drew, by those of the truth, drawn in
 * software. dir: a folder where truths are kept and looked for, by pack, view, light and what two samples a
 * pixel show, so that a program that draws otherwise draws them anew; or NULL. *cpu_ms: processor time of
 * drawing, kept with it. */
enum eco_code view_truth_draw(const struct view_draw_job *job, const char *dir, struct view_picture *picture,
	double *cpu_ms, struct eco_error *error);
