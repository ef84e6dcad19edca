/* The search for the lambda that uses a budget of vertices, as planner_optimal.c leaves it, and what
 * planner_bytes.c does with it where bytes count. */
#ifndef LOD_LAMBDA_SEARCH_H
#define LOD_LAMBDA_SEARCH_H

#include "lod/plan/allocation.h"

#define LOD_LAMBDA_COUNT 240     /* of the grid, down to where a vertex saves nothing visible; then 0 */

struct lod_outcome { double vertices, wrong; }; /* of a relaxation */

struct lod_evaluation { int at; struct lod_outcome outcome; struct eco_prediction prediction; };

struct lod_lambda_search {
	struct lod_allocation *allocation;
	/* indices: where anything may be chosen, after which nothing more gains */
	int first, last;
	struct lod_evaluation from, to;      /* the predicted lambdas around the budget */
	int index;                           /* the last lambda whose vertices fit the budget */
	struct lod_outcome here, next;       /* there, and at the next lambda */
	double lambda;                       /* of the answer */
	double price;                        /* of a byte in the answer where bytes do not bind; 0: none */
};

void lod_search_free(struct lod_lambda_search *s);       /* NULL is fine */
double lod_lambda_at(int index);

/* Entries for the structure of a lambda, within so many vertices. */
enum eco_code lod_search_fill(const struct lod_lambda_search *s, double lambda, uint64_t budget,
	struct eco_error *error);

/* Finds the bytes of the answer that carries the entries: p->bytes. */
enum eco_code lod_bytes_size(struct lod_planner *p, struct eco_error *error);
/* Entries with fewer bytes in place of the answer's, if hardly less is right: s->price, p->bytes. */
enum eco_code lod_bytes_spare(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error);
/* Entries whose answer has at most the bytes asked for, and the prediction. */
enum eco_code lod_bytes_fit(const struct lod_lambda_search *s, uint64_t budget, struct eco_error *error);
/* After the answer: hands coarser ones to input->coarser. Entries are those of the last of them then. */
enum eco_code lod_bytes_coarser(const struct lod_lambda_search *s, const struct eco_plan *answer,
	struct eco_error *error);

#endif
