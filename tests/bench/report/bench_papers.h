/* papers.html: each table and figure of the papers beside ours, with a line on why they differ. What stands
 * beside what is in papers.json:
 *
 *   [{"paper", "title", "entries": [{"figure", "says", "section", "show": [names], "why"}]}]
 *
 * `show` names tables and pictures of the section's record as patterns (fnmatch), pictures with or without
 * their ".png". */
#ifndef TESTS_BENCH_PAPERS_H
#define TESTS_BENCH_PAPERS_H

#include <jansson.h>

#include "tests/bench/bench.h"

/* Written to OUT/papers.html from `papers` and the records that there are. An entry of which nothing is there
 * says what to run. Sets *missing to the number of names that match nothing in a record of a full run to its
 * end. */
enum eco_code bench_papers_write(const struct bench *bench, const json_t *papers, const json_t *records,
	uint32_t *missing, struct eco_error *error);

#endif
