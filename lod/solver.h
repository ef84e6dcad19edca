/* What searches say when they end. A search has a tolerance, within which it has found what it looks for, and a bound of tries, so that it ends
 * whatever it is given. Where it ends at the bound, its result is sound and no more than that: so it is counted, and said in a pack's META
 * (`ecopack info --json`), of plans by ECO_TRACE=plan (lod_planner_stats.converged).
 *
 * What makes a fixed number of passes looks for nothing that it could miss, and is not counted: orders are picked in one pass and looked at again in
 * up to four (rank_refine.c), colours are cut into boxes once (palette.c), levels of wood are simplified once, to a number of triangles or a
 * distance, whichever comes first (level.c). Ground ends at its tolerance or at its most tiles, and says how far off it is (ground.h). */
#ifndef LOD_SOLVER_H
#define LOD_SOLVER_H

#include <stdbool.h>
#include <stdint.h>

enum lod_solver {
	LOD_SOLVER_GRID,             /* bits of a plant's grid: full detail within LOD_GRID_LOSS of the model, or more bits do not help; bound: 18 bits */
	LOD_SOLVER_SCALE,            /* scale of a sample of a curve: those beside it are worse; bound: 1/4 to 8 times Cook's */
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
