/* The mean light of samples of a picture (lod_eye_sample) on the GPU: the light of each sample is added to
 * sums of floats, and their mean becomes the picture.
 *
 *   web_mean_prepare(&mean, &lit, count)    false: the driver has no sums of so many samples
 *   web_mean_first(&mean, &lit)             lit is sample 0
 *   web_mean_add(&mean, &lit, count)        lit is sample count - 1; after this the mean of `count` samples
 *
 * Drivers without EXT_float_blend add half floats. Sums of 16 half floats put the mean off by at most .21 steps of
 * 8 bits, or .54 where a driver cuts instead of rounding, as Mesa does (200,000 sums of random colours, and all sums of
 * equal ones). In 14 pictures 99.94 % of the bytes or more differ by at most 1 from those of view_light_samples.
 *
 * Nothing is made or compiled before the first picture that gets a second sample. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct web_lit {                         /* a lit picture: RGBA8, sRGB, its first row at the top */
	unsigned texture, framebuffer, vertex_array;
	uint32_t width, height;
};

struct web_mean {                        /* zero is empty */
	unsigned program, sums, framebuffer;
	uint32_t width, height;
	bool refused, halves;
};

#define WEB_MEAN_HALVES_MAX 16u
bool web_mean_prepare(struct web_mean *mean, const struct web_lit *lit, uint32_t count);
/* Both change the state of blending. */
void web_mean_first(const struct web_mean *mean, const struct web_lit *lit);
void web_mean_add(const struct web_mean *mean, const struct web_lit *lit, uint32_t count);
void web_mean_free(struct web_mean *mean);
