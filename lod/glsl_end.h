/* Takes back what glsl.h calls otherwise in C. */
#undef abs
#undef ceil
#undef floor
#undef max
#undef min
#undef sqrt
