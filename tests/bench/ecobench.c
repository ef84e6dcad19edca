/* ecobench: all sections, in the order in which they run and stand in the report. */
#include "tests/bench/bench.h"

#define SECTIONS(each) each(frames) each(rules) each(species) each(drawn) each(collapse) \
	each(lee) each(scale) each(hierarchy) each(importance) each(tints) each(billboards) each(deussen) \
	each(neubert) each(cache) each(visibility)
#define DECLARE(name) extern const struct bench_section bench_##name;
#define LIST(name) &bench_##name,
SECTIONS(DECLARE)

int main(int argc, char **argv)
{
	static const struct bench_section *const sections[] = { SECTIONS(LIST) NULL };
	return bench_main(argc, argv, sections);
}
