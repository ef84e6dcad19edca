/* Draco behind a few C functions: meshes of integers to bytes and back; and meshes of glTF files. Nothing
 * else of Draco is visible; exceptions end here.
 *
 * Coding is lossless. Decoding refuses a stream whose header is not as Draco 1.5 writes it or has other
 * counts than were asked for, before it allocates anything for it. */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* From now on a C++ library that finds no memory where it can tell nobody ends the program with a message
 * and status 1, not by a signal: Draco in a destructor, meshoptimizer called from C. `note`, unless NULL, is
 * called before. */
void eco_draco_end_without_memory(void (*note)(void));

/* Draco allocates four bytes for each integer up to the largest difference. */
#define ECO_DRACO_VALUE_MAX (1 << 20)
/* Edgebreaker at its slowest speed. `position` 3 per vertex, within ECO_DRACO_VALUE_MAX of each other;
 * `index` 3 per face. Draco reorders faces and vertices and may drop faces: decode to see what was kept. */
enum eco_code eco_draco_encode_mesh(const int32_t *position, uint32_t vertices, const uint32_t *index,
	uint32_t faces, uint8_t **bytes, size_t *size, struct eco_error *error);   /* *bytes is malloc'ed */

/* Decodes exactly `faces` faces: position 9 per face, `vertex` 3 per face (in [0, 3 * faces)); the same
 * vertex number means the same position. ECO_DAMAGED otherwise. */
enum eco_code eco_draco_decode_mesh(const uint8_t *bytes, size_t size, uint32_t faces, int32_t *position,
	uint32_t *vertex, struct eco_error *error);

/* A mesh that another program wrote (KHR_draco_mesh_compression), with the attributes asked for by unique
 * id. */
struct eco_draco_attribute {
	uint32_t id;
	uint8_t components;          /* 1 to 16; components that the stream lacks are 0 */
	/* out: components per point, malloc'ed; integers as they are, not as fractions */
	float *values;
};
struct eco_draco_mesh {
	uint32_t faces, points;
	uint32_t *index;             /* 3 per face, each < points; malloc'ed */
};
/* Decodes bitstream version 2.2 with at most so many faces and points; counts are compared before anything
 * is allocated for them. Small streams may still take much memory and time: run it in the child of
 * guard.h. On failure mesh and values are empty. */
enum eco_code eco_draco_decode_gltf(const uint8_t *bytes, size_t size, uint32_t faces_max,
	uint32_t points_max, struct eco_draco_attribute *attributes, uint32_t attribute_count,
	struct eco_draco_mesh *mesh, struct eco_error *error);

#ifdef __cplusplus
}
#endif
