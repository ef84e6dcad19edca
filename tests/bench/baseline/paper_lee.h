/* Lee, Peng, Kuo on whole scenes: which cells of each plant are drawn, by their three orders (lee.h), for a
 * budget of leaves that Cook's lambda gives each plant. The view is the plant's own; rounded to one of eight
 * sectors, so that orders could be made beforehand; or none (static): the eight sectors share the budget.
 *
 * A cell keeps the first leaves of its list, scaled as Cook's are. Plants of which so few leaves are asked
 * for that most cells would be empty draw the first leaves of the whole, as cells cannot be chosen there. */
#ifndef TESTS_BENCH_BASELINE_PAPER_LEE_H
#define TESTS_BENCH_BASELINE_PAPER_LEE_H

#include "tests/bench/baseline/paper_neubert.h"
#include "tests/bench/baseline/paper_rules.h"

enum { PAPER_LEE_VIEW, PAPER_LEE_SECTOR, PAPER_LEE_STATIC, PAPER_LEE_ORDERS };
#define PAPER_LEE_RULES (LOD_LEE_COUNT * PAPER_LEE_ORDERS)
extern const char *const paper_lee_names[PAPER_LEE_RULES];

struct paper_lee_plant { /* cells with leaves */
	struct lod_lee_group *groups;
	uint32_t *ladders, count;
	double leaves;
};
struct paper_lee {
	const struct paper_tables *tables;
	uint32_t rule;                  /* method * PAPER_LEE_ORDERS + order */
	struct paper_lee_plant *plants;
	struct lod_arena *arena;
};
enum eco_code paper_lee_begin(struct paper_lee *lee, const struct paper_scene *s, struct eco_error *error);
void paper_lee_end(struct paper_lee *lee);
enum eco_code paper_lee(struct paper *p, double full_m, void *lee, struct eco_error *error);

/* Leaves of each group for an eye in the plant's own coordinates. */
void paper_lee_keep(uint32_t *kept, uint32_t rule, const struct lod_lee_group *groups, uint32_t count,
	const struct lod_v3 *center, const struct lod_v3 *eye, uint64_t budget, struct lod_arena *arena);

#endif
