/* Rules of papers that spend the vertices of a whole scene, each by one parameter that the budget decides.
 *
 *   Deussen 2002   the sample distance d' (paper_deussen)
 *   Cook 2007      the distance r up to which all leaves are drawn (paper_cook): lambda = min(1, (r / R)^2),
 *                  so that leaves keep their size in pixels beyond it
 *   Neubert 2011   the same r, for the lambda whose quality is to be kept (paper_cook with tables of
 *                  paper_neubert.h)
 *   Lee 2007       the same lambda as a budget of leaves for each plant (paper_lee)
 *
 * Wood: Deussen's lines and polygons; the other papers prune leaves alone, and their wood is what our ladders
 * draw for the share lambda of its vertices. */
#ifndef TESTS_BENCH_BASELINE_PAPER_RULES_H
#define TESTS_BENCH_BASELINE_PAPER_RULES_H

#include "tests/bench/baseline/lee.h"
#include "tests/bench/baseline/paper_scene.h"

/* ---- Deussen 2002, section 5 ---- */

struct paper_deussen {
	double splat_factor; /* c_p, 1.2 to 1.5; 0: 1.3 */
	/* without the octree (6.1): all cells of a plant at its mean distance, over all instances of it */
	bool whole;
};

/* The scene's points and lines. */
enum eco_code paper_deussen_lists(struct paper_scene *s, struct eco_error *error);
/* Points that a surface needs at distance r: c_p A / (2 r^2) / d'^2, equation 1 without its misprint. */
double paper_deussen_points(double area, double r, double d, double splat_factor);
/* q of equation 2: the share of lines that cover the wood or blades when each is as wide as d'; above 1 they
 * are polygons. width: A / l. */
double paper_deussen_lines(double width, double r, double d);

/* Blend of section 5.3, of k triangles and 2k points of which p vertices are asked for: triangles [0,
 * triangles) and points [first, end). It draws floor(p) vertices, at most 3k. */
struct paper_blend {
	uint32_t triangles, first, end;
};
struct paper_blend paper_deussen_blend(double p, uint32_t k);
/* Area factor of a point where all 2k would cover the projected area together: each of p covers c_p / p. */
double paper_deussen_scale(double p, double k, double splat_factor);

/* d: the sample distance. deussen: struct paper_deussen, or NULL. */
enum eco_code paper_deussen(struct paper *p, double d, void *deussen, struct eco_error *error);

/* ---- Cook 2007, and Neubert 2011 ---- */

double paper_cook_lambda(double r, double full_m);

struct paper_sight;
struct paper_tables;
struct paper_cook {
	/* per plant, of paper_tables_make; NULL: scale 1 / lambda without correction */
	const struct paper_tables *tables;
	bool optimal;              /* Neubert's lambda_opt and s_opt */
	struct paper_sight *sight; /* with it, lambda_opt max(f, .1); NULL: every plant is visible */
};
enum eco_code paper_cook(struct paper *p, double full_m, void *cook, struct eco_error *error);

/* Cuts of wood for a share of its vertices. */
void paper_wood(struct paper *p, const struct lod_slot *slot, uint32_t ladder, double lambda,
	uint32_t share_first, uint32_t share_end);

#endif
