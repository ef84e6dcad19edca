/* Billboard clouds of one plant: what the section `billboards` measures. */
#ifndef TESTS_BENCH_BILLBOARDS_Q_H
#define TESTS_BENCH_BILLBOARDS_Q_H

#include "tests/bench/pictures/bench_splats.h"

/* ALL: as the method is. CROSSES: the only generator. VALID: faces that no billboard holds are not drawn. */
enum bench_billboards_kind { BENCH_BILLBOARDS_ALL, BENCH_BILLBOARDS_CROSSES, BENCH_BILLBOARDS_VALID,
	BENCH_BILLBOARDS_KINDS };
extern const char *const bench_billboards_kind_names[BENCH_BILLBOARDS_KINDS];

/* Caps: the first have as many vertices, at 6 each, as bench_splats_budgets; then that of Neubert's
 * figure 11. */
#define BENCH_BILLBOARDS_CAPS 6u
extern const uint32_t bench_billboards_caps[BENCH_BILLBOARDS_CAPS];
#define BENCH_BILLBOARDS_TURNED 4u       /* of the caps: 209 */
/* Other kinds have no figures for caps without a budget. */
static inline bool bench_billboards_has(int kind, uint32_t cap)
{
	return kind == BENCH_BILLBOARDS_ALL || cap < BENCH_SPLATS_BUDGETS;
}

struct bench_billboards_point {
	uint32_t count, parts, forms[3];
	double error, invalid, epsilon, texels, bytes, seconds;
	struct bench_splats_q q;
};

/* Over a turn around the plant, 209 billboards against three orders of leaves that are pruned to the same
 * mean Q, each at its best scale. Wood is whole in these. */
#define BENCH_TURN_VIEWS 36u
enum bench_turn { BENCH_TURN_BILLBOARDS, BENCH_TURN_STOCHASTIC, BENCH_TURN_COMBINED, BENCH_TURN_GREEDY,
	BENCH_TURN_METHODS };
extern const char *const bench_turn_names[BENCH_TURN_METHODS];

struct bench_billboards_q {
	struct bench_billboards_point point[BENCH_BILLBOARDS_KINDS][BENCH_BILLBOARDS_CAPS];
	/* Q of each view; NaN: the mean is not reached */
	double turn[BENCH_TURN_METHODS][BENCH_TURN_VIEWS];
	double vertices[BENCH_TURN_METHODS], wood_vertices;
};

/* Takes the model over. Writes billboards-NAME.png. */
enum eco_code bench_billboards_measure(struct bench *bench, const char *name, struct bench_billboards_q *q,
	struct eco_model *model, struct eco_error *error);
/* Mean of a texture's opaque texels, darker than white. */
void bench_billboards_color(const struct eco_image *image, uint8_t rgb[3]);

/* A field of plants whose clouds have fewer billboards the further away they stand (figure 4, right). */
#define BENCH_FIELD_LEVELS 4u
extern const uint32_t bench_field_caps[BENCH_FIELD_LEVELS];
struct bench_field_q {
	uint32_t plants[BENCH_FIELD_LEVELS]; /* in view, by level */
	double vertices, full;               /* of clouds; of all triangles of the same plants */
	double q, precision, recall, owner_q;
};
/* Takes the model over. `known`: its clouds by cap, for their epsilon. Writes billboards_field-NAME.png. */
enum eco_code bench_billboards_field(struct bench *bench, const char *name,
	const struct bench_billboards_q *known, struct bench_field_q *q, struct eco_model *model,
	struct eco_error *error);

#endif
