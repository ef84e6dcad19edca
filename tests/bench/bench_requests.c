/* Random requests over five scenes: what must hold whatever is asked for (requests.c says what). It is a
 * program of its own, so that a crash is one violation and not the end of the bench. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench.h"

static const char *const scenes[] = { "park", "forest", "nested", "meadow", "tree" };
#define SCENES (sizeof scenes / sizeof *scenes)
#define BLOCK 2000u              /* requests of one run of the program */
#define BLOCKS_QUICK 1u          /* a scene */
#define BLOCKS_FULL 10u

/* Keys of the program's answer and columns of the table. All are summed, but the last: the most counts. */
static const struct { const char *key, *head; } counts[] = { { "requests", "requests" },
	{ "states", "states of streams" }, { "chains", "chains of budgets" }, { "violations", "violations" },
	{ "vertices", "vertices" }, { "bytes", "bytes" }, { "twice", "twice" }, { "undrawn", "undrawn" },
	{ "same", "same" }, { "falls", "falls" }, { "unused", "unused" }, { "whole", "whole" },
	{ "senseless", "senseless" }, { "failed", "failed" }, { "unused_most", "most left over" } };
enum { COUNTS = sizeof counts / sizeof *counts, REQUESTS = 0, VIOLATIONS = 3, FAILED = COUNTS - 2, MOST };

void bench_request_packs(struct bench *bench)
{
	bench_progress(bench, 0, "scenes for random requests");
	bench_command(
		"BUILD='%s' CACHE='%s/plants' sh tests/bench/request_scenes.sh " "'%s/requests'",
		bench->build, bench->cache, bench->cache);
}

/* The counts of the program; a violation of its own where it prints nothing. */
static void run_block(const struct bench *bench, const char *scene, uint32_t number, double count[COUNTS])
{
	char command[2048], line[2048] = "";
	snprintf(command, sizeof command, "'%s/bench/requests' --seed %u %u '%s/requests/%s.eco'", bench->build,
		number + 1, BLOCK, bench->cache, scene);
	FILE *pipe = popen(command, "r");
	if (pipe && !fgets(line, sizeof line, pipe))
		line[0] = 0;
	if (pipe)
		pclose(pipe);
	json_t *result = json_loads(line, 0, NULL);
	for (int i = 0; i < COUNTS; i++) {
		double one = result ? json_number_value(json_object_get(result, counts[i].key))
			: i == VIOLATIONS || i == FAILED;
		count[i] = i == MOST ? fmax(count[i], one) : count[i] + one;
	}
	json_decref(result);
}

static void run(struct bench *bench)
{
	struct bench_column columns[COUNTS];
	double all[COUNTS] = { 0 };
	uint32_t blocks = bench->full ? BLOCKS_FULL : BLOCKS_QUICK;
	bench_request_packs(bench);
	for (int i = 0; i < COUNTS; i++)
		columns[i] = (struct bench_column){ counts[i].head, i == MOST ? 4 : 0 };
	struct bench_table *table = bench_table_described(bench, "requests", "scene", columns, COUNTS, true);
	for (uint32_t i = 0; i < SCENES; i++) {
		double sum[COUNTS] = { 0 };
		for (uint32_t b = 0; b < blocks; b++) {
			bench_progress(bench, (i + (double)b / blocks) / SCENES, scenes[i]);
			run_block(bench, scenes[i], b, sum);
		}
		bench_table_values(table, sum, "%s", scenes[i]);
		for (int k = 0; k < COUNTS; k++)
			all[k] = k == MOST ? fmax(all[k], sum[k]) : all[k] + sum[k];
	}
	bench_table_values(table, all, "all");
	bench_table_close(table);
	bench_say(bench, "Views inside plants, on corners, far away, with useless ups, extreme angles and pictures of "
		"one pixel to 4,096 x 4,096; budgets from nothing to beyond everything, a quarter of them with a "
		"budget of bytes. Counted by the client that draws: vertices of every state of a stream, bytes, "
		"chunks sent twice, answers that differ; for one view in some, ten budgets: predicted wrong "
		"pixels never rise with the budget, and vertices are left over only where nothing more is to be "
		"gained.");
	bench_key(bench, "requests_violations", all[VIOLATIONS], "0: of what must always hold");
	bench_key(bench, "requests_count", all[REQUESTS], "asked; 100,000 with FULL=1");
}

const struct bench_section bench_requests = { "requests", "Random requests: what must always hold", run };
