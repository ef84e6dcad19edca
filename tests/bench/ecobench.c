/* ecobench: all sections, in the order in which they run and stand in the report. */
#include "tests/bench/bench_state.h"

extern const struct bench_section bench_packs, bench_frames, bench_species, bench_path, bench_lee, bench_scale, bench_planner, bench_colour,
	bench_steadiness, bench_requests, bench_extreme, bench_needs, bench_hierarchy;

int main(int argc, char **argv)
{
	static const struct bench_section *const sections[] = { &bench_packs, &bench_frames, &bench_species, &bench_path, &bench_lee, &bench_scale,
		&bench_colour, &bench_steadiness, &bench_requests, &bench_extreme, &bench_needs, &bench_planner, &bench_hierarchy, NULL };
	return bench_main(argc, argv, sections);
}
