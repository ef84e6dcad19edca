/* The part of KHR_meshopt_compression that Debian 12's meshoptimizer lacks. Private to gltf_meshopt.c. */
#ifndef ECO_GLTF_MESHOPT_H
#define ECO_GLTF_MESHOPT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GLTF_MESHOPT_V1 0xa1u        /* first byte of attributes in the codec's second version */

/* `count` vertices of `stride` bytes (a multiple of 4, at most 256) into to[count * stride]. False:
 * damaged. */
bool gltf_meshopt_decode_v1(uint8_t *to, size_t count, size_t stride, const uint8_t *bytes, size_t size);

/* Undoes the filter COLOR in place: `stride` 4 (8 bits a channel) or 8 (16 bits). */
void gltf_meshopt_filter_color(uint8_t *bytes, size_t count, size_t stride);

#endif
