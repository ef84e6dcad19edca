/* Words of GLSL for texts that C compiles, too: include this before the text and glsl_end.h after it. */
#ifndef LOD_GLSL_H
#define LOD_GLSL_H

#include <math.h>
#include <stdint.h>

#define LIGHT static inline      /* before each function */
typedef uint32_t uint;

#endif

#define real(x) ((float)(x))
#define abs fabsf
#define ceil ceilf
#define floor floorf
#define max fmaxf
#define min fminf
#define sqrt sqrtf
