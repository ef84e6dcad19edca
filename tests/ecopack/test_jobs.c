/* Work in threads, results in order: the same outcome with any number of threads; the first failure counts;
 * nothing is lost or freed twice. */
#include <stdatomic.h>
#include <stdlib.h>

#include "ecofiles/ecopack/run.h"
#include "tests/support/unit_test.h"

struct made { uint64_t *value; };
struct run { uint64_t fails_at, take_fails_at, taken, sum; atomic_uint alive; };

static enum eco_code make_value(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct run *run = ctx;
	struct made *made = result;
	made->value = malloc(sizeof *made->value);
	assert_non_null(made->value);
	*made->value = i * i;
	atomic_fetch_add(&run->alive, 1);
	return i >= run->fails_at ? eco_fail(error, ECO_DAMAGED, "piece %llu", (unsigned long long)i)
		: ECO_OK;
}

static enum eco_code take_value(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct run *run = ctx;
	assert_int_equal(i, run->taken);
	assert_int_equal(*((struct made *)result)->value, i * i);
	if (i == run->take_fails_at)
		return eco_fail(error, ECO_IO, "taking %llu", (unsigned long long)i);
	run->taken++;
	run->sum = 31 * run->sum + i;
	return ECO_OK;
}

static struct run *dropping;

static void drop_value(void *result)
{
	struct made *made = result;
	if (made->value)
		atomic_fetch_sub(&dropping->alive, 1);
	free(made->value);
}

static enum eco_code go(struct run *run, uint64_t count, uint32_t threads, struct eco_error *error)
{
	dropping = run;
	return main_jobs_run(&(struct main_jobs){ .count = count, .threads = threads,
		.result_size = sizeof(struct made), .work = make_value,
		.take = take_value, .drop = drop_value, .ctx = run }, error);
}

UNIT_TEST(the_first_failure_is_the_one_that_is_told)
{
	static const struct { uint64_t work, take; enum eco_code code; const char *says; uint64_t taken;
		} cases[] = {
		{ 0, UINT64_MAX, ECO_DAMAGED, "piece 0", 0 },
			{ 1500, UINT64_MAX, ECO_DAMAGED, "piece 1500", 1500 },
		{ UINT64_MAX, 1200, ECO_IO, "taking 1200", 1200 }, { 40, 30, ECO_IO, "taking 30", 30 },
		{ 30, 40, ECO_DAMAGED, "piece 30", 30 },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		for (uint32_t threads = 1; threads < 4; threads++) {
			struct run run = { .fails_at = cases[i].work, .take_fails_at = cases[i].take };
			struct eco_error error = { .code = ECO_OK };
			assert_int_equal(go(&run, 3000, threads, &error), cases[i].code);
			assert_string_equal(error.text, cases[i].says);
			assert_int_equal(run.taken, cases[i].taken);
			assert_int_equal(run.alive, 0);
		}
}
