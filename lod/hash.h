/* Hashes that programs and shaders compute alike: statements in words that C and GLSL share, of unsigned
 * numbers of 32 bits. C runs them, and shaders are given them as text (client-min/draw/view_shader.c). */
#pragma once

#define LOD_HASH_MIX hash = (hash ^ hash >> 16) * 0x21F0AAADu; hash = (hash ^ hash >> 15) * 0x735A2D97u

/* From `point` and `part`: where a part of a point lies (scattered.h). */
#define LOD_HASH_SCATTER hash = point * 0x9E3779B1u + part * 0x85EBCA77u; LOD_HASH_MIX; hash ^= hash >> 15

/* From the bits of a splat's centre, `x`, `y` and `z`, and the number `nth` of a sample; and from that and a
 * pixel's `column` and `row`: whether a splat that is not opaque covers it (splat.h). */
#define LOD_HASH_SALT salt = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ z * 0xC2B2AE3Du ^ nth * 0x27D4EB2Fu
#define LOD_HASH_SPLAT hash = salt + column * 0x9E3779B9u + row * 0x7FEB352Du; LOD_HASH_MIX
