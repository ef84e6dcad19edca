/* Few models for many: how alike two models look, and the choice of those that stand for all (the
 * quantisation of plants of Deussen et al. 1998; own distance and clustering).
 *
 *   few_look(&looks[i], &model, &error);             each model, from its triangles alone
 *   few_difference(&looks[i], &looks[j]);            0 alike .. 1 nothing in common
 *   few_choose(difference, weight, count, keep, stand_in, &error);
 *
 * A look is the picture of a plant of height 1 in rows: how wide each is, how much of it is covered, and its
 * colour. Forms follow from it: a conifer narrows upwards, a palm is thin but for the top, a shrub is wide at
 * the foot. Rows are of the model turned about its axis, as instances are turned at random. */
#ifndef ECO_MAIN_FEW_H
#define ECO_MAIN_FEW_H

#include "ecofiles/base/status.h"
#include "ecofiles/format/model.h"

#define FEW_ROWS 12u
#define FEW_MODELS_MAX 4096u         /* the table of differences takes 8 bytes a pair */

struct few_look {
	double height_m, reach_m;    /* reach: the greatest distance from the axis */
	/* from the foot up; wide: half of its width / height */
	struct { double wide, cover, rgb[3]; } row[FEW_ROWS];
	double leaf;                 /* mean area of a leaf / height^2; 0: none */
};

enum eco_code few_look(struct few_look *look, const struct eco_model *model, struct eco_error *error);

/* The share of pixels that either covers and the other does not, or covers in another colour; a little more
 * where one has far larger leaves, or is far larger by nature: no tree should stand for a poppy.
 * Symmetric. */
double few_difference(const struct few_look *a, const struct few_look *b);

/* k-medoids: sets stand_in[i] to the model that stands for model i, itself where it is kept, so that the sum
 * of weight times difference is least: greedy (BUILD), then exchanges (SWAP) while one gains (Kaufman and
 * Rousseeuw 1990). Keeps at most `keep`, fewer where the rest weigh nothing or differ in nothing.
 * `difference`: count x count, symmetric, 0 on its diagonal. Deterministic; ties go to the first. */
enum eco_code few_choose(const double *difference, const double *weight, uint32_t count, uint32_t keep,
	uint32_t *stand_in, struct eco_error *error);

#endif
