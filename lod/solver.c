#include "lod/solver.h"

const char *const lod_solver_names[LOD_SOLVER_COUNT] =
	{ [LOD_SOLVER_GRID] = "grid", [LOD_SOLVER_SCALE] = "scale" };
