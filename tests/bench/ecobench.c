/* ecobench: all sections, in the order in which they run and stand in the report. */
#include "tests/bench/bench.h"

extern const struct bench_section bench_frames, bench_pictures, bench_bytes,
	bench_rising, bench_rules, bench_curves, bench_species, bench_ladders, bench_path,
	bench_drawn, bench_collapse, bench_lee, bench_scale, bench_hierarchy,
	bench_importance, bench_steadiness, bench_switches, bench_extreme, bench_billboards, bench_deussen, bench_neubert,
	bench_requests, bench_needs, bench_cache, bench_planner,
	bench_visibility;

int main(int argc, char **argv)
{
	static const struct bench_section *const sections[] = { &bench_frames, &bench_pictures,
		&bench_bytes, &bench_rising, &bench_rules, &bench_curves,
		&bench_species, &bench_ladders, &bench_path, &bench_drawn, &bench_collapse,
		&bench_lee, &bench_scale, &bench_hierarchy, &bench_importance,
		&bench_steadiness, &bench_switches, &bench_extreme, &bench_billboards, &bench_deussen, &bench_neubert,
		&bench_requests, &bench_needs, &bench_cache, &bench_planner,
		&bench_visibility, NULL };
	return bench_main(argc, argv, sections);
}
