/* Errors that are seen in a plant's lists, beside what they cover: pictures in colour, all around, under
 * light from the sky.
 *
 *   lod_seen_init(&seen, &probe, &options);
 *   lod_seen_back(&seen);                              the probe's drawings, if any, are part of all that
 * follows   lod_seen_keep(&seen);                              the probe's drawings become the reference
 *   lod_seen_compare(&seen, &error);                   others against it; without any, what full detail is
 * worth   lod_seen_free(&seen);
 *
 * A picture is divided into blocks of 16 x 16 pixels (lod/raster/blocks.h). Its errors are those of the
 * blocks' mean colours and of their deviations of lightness, over the pixels that show the reference: both
 * add up over plants, and neither asks where in a block a leaf is. They depend on how large the plant is
 * in the picture, so the same samples are taken as pixels of ECO_SEEN_SIZES widths. Leaves are drawn on
  * splats and points. */
#pragma once

#include "lod/build/measure/probe.h"

#define LOD_SEEN_VIEWS_MAX 4u

/* samples: a side of a pixel of the largest size. */
struct lod_seen_options { uint32_t views, samples; };

struct lod_seen {
	struct lod_probe *probe;         /* whose drawings are compared; probe->colored while it lasts */
	struct lod_arena arena;
	struct lod_texels *texels;       /* per image of the model */
	struct lod_seen_options options;
	struct lod_eye eyes[LOD_SEEN_VIEWS_MAX];
	struct lod_seen_view *views;
	struct lod_seen_light *light;
	uint8_t (*rgb)[3];               /* own colours of the drawings' primitives */
	uint64_t rgb_capacity;
	bool has_back;                   /* lod_seen_back drew something */
	float alike[3];                  /* mean light of what the reference covers */
};

/* The probe must be colored, and outlive it. */
void lod_seen_init(struct lod_seen *seen, struct lod_probe *probe, const struct lod_seen_options *options);
void lod_seen_free(struct lod_seen *seen);
void lod_seen_back(struct lod_seen *seen);
void lod_seen_keep(struct lod_seen *seen);
void lod_seen_compare(struct lod_seen *seen, struct eco_seen *error);
