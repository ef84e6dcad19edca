/* A drawn frame in memory, by any renderer: colours, the mask of covered pixels, whose they are, and what
 * light needs to know of them (view_light.h). Row 0 is the top. */
#pragma once

#include <stdint.h>

#include "lod/eye.h"

struct view_picture {                    /* owns its arrays */
	uint32_t width, height;
	uint8_t *rgb;                    /* 3 per pixel, sRGB */
	uint16_t *light;                 /* rgb before it is rounded (lod_light_of); NULL unless wanted */
	uint8_t *cover;                  /* 255 where a plant is nearest, else 0 */
	uint64_t *owner;                 /* 0: nothing or ground */
	float *depth;                    /* 1 / distance forward of the eye; 0: the sky */
	uint32_t *surface;               /* view_light.h; of a plant or the ground */
	uint8_t *soft;                   /* samples covered (view_measure_soft); NULL until counted */
	uint64_t vertices;               /* counted at the draw calls */
	double draw_ms;
	/* if shadows are cast: of these; texels for a pixel near the eye (view_shadow_sharpness) */
	double shadow_ms, shadow_texels;
};

enum eco_code view_picture_init(struct view_picture *picture, uint32_t width, uint32_t height,
	struct eco_error *error);
void view_picture_free(struct view_picture *picture);
/* From the eye towards the middle of a pixel, 1 forward, by the world's axes. */
void view_picture_ray(const struct view_picture *picture, const struct lod_eye *eye, double x, double y,
	double ray[3]);

/* True and false positives and negatives in three colours over black (neither) : 3 bytes a pixel into `rgb`.
 */
void view_picture_compare(const uint8_t *cover, const uint8_t *reference, uint32_t pixels, uint8_t *rgb);

/* Whose each pixel is, 3 bytes a pixel into `rgb`: a plant has a colour of its own, which it keeps in other
 * pictures (two share one by chance, of 2^24), and what is no plant's is black. */
void view_picture_owners(const struct view_picture *picture, uint8_t *rgb);

/* Three pictures side by side, with words under each: ours, full detail, and the error that people see, from
 * black (none) over violet and orange to pale yellow (1). */
struct view_compare {
	const struct view_picture *picture, *reference;
	const float *error_map;                  /* lod_flip's, 0 to 1 a pixel */
	const char *words[3];                    /* ASCII; letters are drawn as capitals */
};
/* *rgb is malloc'ed: 3 bytes a pixel, size[0] x size[1] pixels. */
enum eco_code view_compare_draw(const struct view_compare *compare, uint8_t **rgb, uint32_t size[2],
	struct eco_error *error);

/* ---- Work on pictures, in equal shares by several threads ---- */

/* As many as are `wanted`, but at most 64; 0: 2. */
uint32_t view_thread_count(uint32_t wanted);
/* work(ctx, n) for each n below `count` (a view_thread_count), each on a thread of its own, 0 on the
 * caller's. The caller also does the shares whose threads the system refuses. Returns when all are done. */
void view_threads_run(uint32_t count, void (*work)(void *ctx, uint32_t number), void *ctx);
