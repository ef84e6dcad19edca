/* The path of a flight through a scene. */
#ifndef TESTS_BENCH_FLIGHT_H
#define TESTS_BENCH_FLIGHT_H

#include "tests/bench/bench_shots.h"

#define BENCH_FLIGHT_FPS 10u
#define BENCH_FLIGHT_S 60u               /* a whole flight */
#define BENCH_FLIGHT_FRAMES (BENCH_FLIGHT_FPS * BENCH_FLIGHT_S)

/* The views of `count` frames from frame `first` of BENCH_FLIGHT_FRAMES on: from the air down to eye level in
 * a third of the time, then along the longer side of the scene's bounds through it. The caller frees *views. */
enum eco_code bench_flight_path(const char *pack, uint32_t first, uint32_t count, struct eco_view **views,
	struct eco_error *error);

#endif
