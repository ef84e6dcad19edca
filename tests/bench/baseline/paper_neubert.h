/* Neubert, Pirk, Deussen, Dachsbacher 2011 on whole scenes: the scale s_opt and the lambda_opt that keeps
 * Cook's quality (section 3), tabled for each plant of a pack; and what of each plant other plants hide
 * (section 4).
 *
 *   paper_tables_make(&tables, scene, &error);      draws the leaves of every plant alone
 *   paper_sight_new(&sight, scene);
 *   ... a plan by paper_cook with both, a frame ...
 *   paper_sight_update(sight, &frame, &view);       before the next plan
 *
 * An iso-surface's points that its own crown hides count as hidden in the paper. Here only other plants
 * hide, so that a plant alone has f = 1. */
#ifndef TESTS_BENCH_BASELINE_PAPER_NEUBERT_H
#define TESTS_BENCH_BASELINE_PAPER_NEUBERT_H

#include "tests/bench/baseline/paper_scene.h"

#define PAPER_LAMBDAS 12u

struct paper_table { /* of one plant's leaves, lambda ascending to 1 */
	double lambda[PAPER_LAMBDAS], s_opt[PAPER_LAMBDAS], s_cook[PAPER_LAMBDAS];
	double q_opt[PAPER_LAMBDAS], q_cook[PAPER_LAMBDAS];
	double leaves, share; /* share: lod_cook_share */
};
struct paper_tables;
enum eco_code paper_tables_make(struct paper_tables **tables, struct paper_scene *scene,
	struct eco_error *error);
void paper_tables_free(struct paper_tables *tables);
const struct paper_table *paper_tables_of(const struct paper_tables *tables, uint32_t plant);

/* The smallest lambda whose Q with s_opt is at least that of Cook at lambda; never above it. */
double paper_table_optimal(const struct paper_table *table, double lambda);
double paper_tables_optimal(const struct paper_tables *tables, uint32_t plant, double lambda);
double paper_tables_scale(const struct paper_tables *tables, uint32_t plant, double lambda);
/* Cook's, with the correction for depth complexity. */
double paper_tables_cook(const struct paper_tables *tables, uint32_t plant, double lambda);

/* ---- Occlusion ---- */

struct paper_sight;
enum eco_code paper_sight_new(struct paper_sight **sight, const struct paper_scene *scene,
	struct eco_error *error);
void paper_sight_free(struct paper_sight *sight);
/* One step in time of f as it is used, from the f that was counted: held while they differ by less than the
 * hysteresis, and smoothed. */
#define PAPER_SIGHT_HYSTERESIS 0.1
struct paper_sight_state {
	double held, smooth;
};
void paper_sight_step(struct paper_sight_state *state, double counted);
void paper_sight_update(struct paper_sight *sight, const struct paper_frame *frame,
	const struct eco_view *view);
/* 1 for plants not seen in the last frame, and of NULL. */
double paper_sight_of(const struct paper_sight *sight, uint32_t plant, uint32_t hash);
double paper_sight_share(double f); /* max(f, 0.1) */

#endif
