/* Writes small glTF files for tests: views and accessors one by one into a buffer, the rest as JSON text, in
 * which ' stands for ". */
#pragma once

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLTF_BYTE 5120
#define GLTF_UBYTE 5121
#define GLTF_SHORT 5122
#define GLTF_USHORT 5123
#define GLTF_UINT 5125
#define GLTF_FLOAT 5126

void gw_begin(void);
/* A view of new bytes; `more` is further JSON of it, beginning with a comma, or "". */
int gw_view(const void *bytes, size_t size, const char *more);
/* A view that is compressed: of `size` bytes once it is unpacked, in a buffer 1 without data. */
int gw_packed(const void *bytes, size_t size, size_t count, size_t stride, const char *mode,
	const char *filter, const char *extension);
/* view < 0: none. */
int gw_accessor(int view, int type, size_t count, const char *kind, const char *more);
int gw_floats(const float *values, size_t count, const char *kind, size_t components);
/* The whole document; `rest` is the JSON of its other members, beginning with a comma, or "". */
const char *gw_json(const char *buffer, const char *rest);
/* The same as GLB; `pad` fills the JSON up to a multiple of four. *bytes is malloc'ed. */
size_t gw_glb_bytes(const char *rest, char pad, uint8_t **bytes);
