/* The bound on how often pixels can show the leaf that they should: above whatever any choice of leaves reaches, and not far above. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "lod/sort.h"
#include "tests/bench/bench_owners.h"

#define LEAVES 10u
#define VIEWS 3u
#define CASES 200

static struct lod_arena arena;

struct plant { struct bench_owners owners; uint32_t own[LEAVES][BENCH_OWNERS_VIEWS], cost[LEAVES]; double shown[VIEWS]; };

static uint32_t below(uint64_t seed, uint32_t n) { return (uint32_t)(lod_mix(seed) % n); }

static void make(struct plant *p, uint64_t seed)
{
	*p = (struct plant){ .owners = { .leaves = LEAVES, .views = VIEWS } };
	p->owners.own = p->own;
	for (uint32_t v = 0; v < VIEWS; v++) {
		p->owners.wood[v] = p->owners.wanted[v] = below(seed * 977 + v, 20);
		for (uint32_t i = 0; i < LEAVES; i++)
			p->owners.wanted[v] += p->own[i][v] = below(seed * 8191 + 31 * i + v, 3) ? below(seed * 131 + 17 * i + v, 40) : 0;
		p->owners.wanted[v] = fmax(1, p->owners.wanted[v]);
		p->shown[v] = p->owners.wanted[v] * (0.7 + 0.1 * below(seed * 61 + v, 7));
	}
	for (uint32_t i = 0; i < LEAVES; i++)
		p->cost[i] = seed % 2 ? 3 : 3 + 3 * below(seed * 37 + i, 3);
}

/* The best of all choices that cost no more; of what is right no more than can be. */
static double best_choice(const struct plant *p, uint32_t vertices)
{
	double best = -INFINITY;
	for (uint32_t set = 0; set < 1u << LEAVES; set++) {
		uint32_t cost = 0;
		double sum = 0;
		for (uint32_t i = 0; i < LEAVES; i++)
			cost += set >> i & 1 ? p->cost[i] : 0;
		for (uint32_t v = 0; v < VIEWS && cost <= vertices; v++) {
			double right = p->owners.wood[v];
			for (uint32_t i = 0; i < LEAVES; i++)
				right += set >> i & 1 ? p->own[i][v] : 0;
			sum += bench_owner_q(fmin(right, fmin(p->shown[v], p->owners.wanted[v])), p->shown[v], p->owners.wanted[v]);
		}
		if (cost <= vertices)
			best = fmax(best, sum / VIEWS);
	}
	return best;
}

static void the_bound_is_never_below_the_best_choice_nor_far_above(void **state)
{
	double above = 0;
	(void)state;
	for (uint64_t seed = 1; seed <= CASES; seed++) {
		struct plant p;
		make(&p, seed);
		uint32_t vertices = 3 * below(seed * 5, 2 * LEAVES);
		double most = bench_owners_most(&p.owners, p.shown, vertices, p.cost, &arena), best = best_choice(&p, vertices);
		assert_true(most >= best - 1e-9);
		above += (most - best) / CASES;
	}
	assert_true(above < 0.08);
}

static void more_vertices_never_lower_the_bound_by_much(void **state)
{
	(void)state;
	for (uint64_t seed = 1; seed <= CASES; seed++) {
		struct plant p;
		double before = -INFINITY;
		make(&p, seed);
		for (uint32_t vertices = 0; vertices <= 9 * LEAVES; vertices += 3) {
			double most = bench_owners_most(&p.owners, p.shown, vertices, p.cost, &arena);
			assert_true(most >= before - 0.02);              /* tangents differ */
			before = most;
		}
	}
}

static void without_leaves_only_wood_is_right(void **state)
{
	struct plant p;
	double expected = 0;
	(void)state;
	make(&p, 5);
	for (uint32_t v = 0; v < VIEWS; v++)
		expected += bench_owner_q(fmin(p.owners.wood[v], p.shown[v]), p.shown[v], p.owners.wanted[v]) / VIEWS;
	assert_true(fabs(bench_owners_most(&p.owners, p.shown, 0, p.cost, &arena) - expected) < 1e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_bound_is_never_below_the_best_choice_nor_far_above),
		cmocka_unit_test(more_vertices_never_lower_the_bound_by_much),
		cmocka_unit_test(without_leaves_only_wood_is_right),
	};
	if (setjmp(arena.failed))                /* no memory */
		return 1;
	int failed = cmocka_run_group_tests_name("owners", tests, NULL, NULL);
	lod_arena_free(&arena);
	return failed;
}
