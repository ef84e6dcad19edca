/* Searches and how they end. A search has a tolerance, within which it has found its optimum, and a bound on
 * tries, so that it always ends. A result at the bound is valid, but perhaps not the optimum, and is counted
 * as not converged: in a pack's META (`ecopack info --json`, `searches`), and for plans in lod_planner_stats
 * and ECO_TRACE=plan.
 *
 * Work with a fixed number of passes is not counted: orders are picked in one pass and refined in up to four
 * (rank_refine.c), colours are cut into boxes once (palette.c), levels of wood are simplified once (level.c).
 * Ground ends at its tolerance or at its bound on tiles, and states its error (ground_choice.h). */
#ifndef LOD_SOLVER_H
#define LOD_SOLVER_H

#include <stdbool.h>
#include <stdint.h>

enum lod_solver {
	LOD_SOLVER_GRID,             /* bits of a plant's grid: within LOD_GRID_LOSS of the model, or more
	                              * bits do not help; bound: 18 */
	LOD_SOLVER_SCALE,            /* scale of a curve's sample: its neighbours are worse; bound: 1/4 to 8
	                              * times Cook's */
	LOD_SOLVER_COUNT
};
extern const char *const lod_solver_names[LOD_SOLVER_COUNT];

struct lod_solved { uint32_t runs, converged; };

static inline void lod_solved_add(struct lod_solved *solved, bool converged)
{
	solved->runs++;
	solved->converged += converged;
}

#endif
