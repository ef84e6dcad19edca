/* Random requests over five scenes: what must hold whatever is asked for (requests.c says what). It is a
 * program of its own, so that a crash is one violation and not the end of the bench. */
#include <math.h>

#include "tests/bench/bench_state.h"

static const char *const scenes[] = { "park", "forest", "nested", "meadow", "tree" };
#define SCENES (sizeof scenes / sizeof *scenes)
#define BLOCK 2000u              /* requests of one unit */
#define BLOCKS_QUICK 1u          /* a scene */
#define BLOCKS_FULL 10u

static const char *const kinds[] = { "vertices", "bytes", "twice", "same", "falls", "unused", "whole",
	"senseless", "failed" };

enum eco_code bench_request_packs(struct bench *bench, struct eco_error *error)
{
	int lock = bench_lock(bench);
	bench_progress(bench, 0, "scenes for random requests");
	enum eco_code code = bench_command(bench, error, "BUILD='%s' CACHE='%s/plants' sh tests/bench/request_scenes.sh "
		"'%s/requests'", bench->build, bench->cache, bench->cache);
	bench_unlock(lock);
	return code;
}

/* One block of one scene: what the program prints, or a violation of its own where it prints nothing. */
static json_t *run_block(const struct bench *bench, const char *scene, uint32_t block)
{
	char command[2048], line[2048] = "";
	snprintf(command, sizeof command, "'%s/bench/requests' --json --seed %u %u '%s/requests/%s.eco'",
		bench->build, block + 1, BLOCK, bench->cache, scene);
	FILE *pipe = popen(command, "r");
	if (pipe && !fgets(line, sizeof line, pipe))
		line[0] = 0;
	int status = pipe ? pclose(pipe) : -1;
	json_t *result = json_loads(line, 0, NULL);
	if (!result)
		result = json_pack("{s:i, s:i, s:i, s:s}", "requests", 0, "violations", 1, "failed", 1,
			"command", command);
	json_object_set_new(result, "status", json_integer(status));
	return result;
}

static void add_counts(json_t *sum, const json_t *block)
{
	const char *key;
	json_t *value;
	json_object_foreach((json_t *)block, key, value) {
		if (json_is_integer(value))
			json_object_set_new(sum, key,
				json_integer(json_integer_value(json_object_get(sum, key))
				+ json_integer_value(value)));
		else if (json_is_real(value))
			json_object_set_new(sum, key,
				json_real(fmax(json_number_value(json_object_get(sum, key)),
				json_real_value(value))));
	}
}

static enum eco_code run_scene(struct bench *bench, uint32_t scene, json_t *sum, struct eco_error *error)
{
	uint32_t blocks = bench->full ? BLOCKS_FULL : BLOCKS_QUICK;
	for (uint32_t b = 0; b < blocks; b++) {
		char unit[96];
		snprintf(unit, sizeof unit, "requests-%s-%u", scenes[scene], b);
		if (bench_stopped(bench))
			return eco_fail(error, ECO_INTERRUPTED, "interrupted");
		bench_progress(bench, (scene + (double)b / blocks) / SCENES, unit);
		json_t *block = bench_recall(bench, unit, NULL);
		if (!block) {
			block = run_block(bench, scenes[scene], b);
			if (bench_stopped(bench) && json_integer_value(json_object_get(block, "status"))) {
				json_decref(block);      /* it was ended with us: no violation */
				return eco_fail(error, ECO_INTERRUPTED, "interrupted");
			}
			bench_keep(bench, unit, NULL, block);
		}
		add_counts(sum, block);
	}
	return ECO_OK;
}

static long long count_of(const json_t *sum, const char *key)
{
	return (long long)json_integer_value(json_object_get(sum, key));
}

static void add_row(struct bench_table *table, const char *name, const json_t *sum)
{
	char row[512];
	int at = snprintf(row, sizeof row, "%s,%lld,%lld,%lld,%lld", name, count_of(sum, "requests"),
		count_of(sum, "states"), count_of(sum, "chains"), count_of(sum, "violations"));
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		at += snprintf(row + at, sizeof row - (size_t)at, ",%lld", count_of(sum, kinds[i]));
	bench_table_row(table, "%s,%.4f", row, json_number_value(json_object_get(sum, "unused_most")));
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = bench_request_packs(bench, error);
	json_t *all = json_object();
	struct bench_table *table = code ? NULL : bench_table_open(bench, "requests",
		"scene,requests,states of streams,chains of "
		"budgets,violations,vertices,bytes,twice,same,falls,unused,whole,senseless,failed,most left "
		"over", true);
	for (uint32_t i = 0; i < SCENES && !code; i++) {
		json_t *sum = json_object();
		code = run_scene(bench, i, sum, error);
		add_row(table, scenes[i], sum);
		add_counts(all, sum);
		json_decref(sum);
	}
	if (!code) {
		add_row(table, "all", all);
		bench_say(bench, "Views inside plants, on corners, far away, with useless ups, extreme "
			"angles and pictures of one pixel to 4,096 x 4,096; "
			"budgets "
			"from nothing to beyond everything, a quarter of them with a budget of bytes. "
			"Counted by the client that draws: vertices of every "
			"state of a stream, bytes, chunks sent twice, answers that differ; for one view in "
			"some, ten budgets: predicted wrong pixels never rise "
			"with the budget, and vertices are left over only where nothing more is to be "
			"gained.");
		bench_key(bench, "requests_violations", (double)count_of(all, "violations"),
			"0: of what must always hold");
		bench_key(bench, "requests_count", (double)count_of(all, "requests"),
			"asked; 100,000 with FULL=1");
	}
	if (table)
		bench_table_close(table);
	json_decref(all);
	return code;
}

const struct bench_section bench_requests = { "requests", "Random requests: what must always hold", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/requests.o tests/bench/bench_requests.o "
	"tests-support.a" };
