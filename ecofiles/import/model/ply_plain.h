/* PLY files that assimp reads in part: colours of faces, and strips of triangles. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* The file as a PLY of triangles with coloured vertices, malloc'ed; *bytes NULL: assimp reads it as it is. */
enum eco_code eco_ply_plain(const char *path, uint8_t **bytes, size_t *size, struct eco_error *error);
