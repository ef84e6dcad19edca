/* ecobench: all sections, in the order in which they run and stand in the report. */
#include "tests/bench/bench_state.h"

extern const struct bench_section bench_species __attribute__((weak)), bench_path __attribute__((weak)), bench_lee __attribute__((weak)),
	bench_scale __attribute__((weak)), bench_planner __attribute__((weak)), bench_frames __attribute__((weak)),
	bench_colour __attribute__((weak)), bench_steadiness __attribute__((weak)), bench_requests __attribute__((weak));

static const struct bench_section *const known[] = { &bench_frames, &bench_species, &bench_path, &bench_lee, &bench_scale, &bench_planner,
	&bench_colour, &bench_steadiness, &bench_requests };
#define SECTIONS (sizeof known / sizeof *known)

int main(int argc, char **argv)
{
	const struct bench_section *sections[SECTIONS + 1] = { NULL };
	uint32_t count = 0;
	for (size_t i = 0; i < SECTIONS; i++)
		if (known[i])                                    /* weak: one whose file is not linked is not there */
			sections[count++] = known[i];
	return bench_main(argc, argv, sections);
}
