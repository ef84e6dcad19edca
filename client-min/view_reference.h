/* Drawing a selection in software: the reference that pictures are scored against, and what draws where there
 * is no OpenGL. Plants front to back, hidden ones skipped, by several threads: the same pixels whatever their
 * number. */
#pragma once

#include "client-min/draw/view_light.h"
#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "lod/raster/raster.h"

/* Fills the picture, lit (view_light.h); vertices are those of the selection: hidden ones count as drawn. */
enum eco_code view_reference_draw(const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error);
/* The same, but colours are the mean light of samples x samples, evenly spread in each pixel and drawn in
 * parts: samples is at most 15, and costs less than as many pictures. */
enum eco_code view_reference_fine(const struct view_draw_job *job, uint32_t samples,
	struct view_picture *picture, struct eco_error *error);

/* Cover of each pixel by plants: the number of covered ones among samples x samples, evenly spread in it.
 * Memory is bounded, whatever the picture's size. */
struct view_coverage {
	uint32_t width, height, samples;         /* samples: at most 15 */
	uint8_t *count;                          /* one a pixel, the caller's: 0 to samples^2 */
};
enum eco_code view_reference_count(const struct view_draw_job *job, struct view_coverage *coverage,
	struct eco_error *error);
