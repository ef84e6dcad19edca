/* Floating-point traps around lod/, in all that tests link: a division by zero, an operation that has no
 * result, a conversion to an integer that cannot hold it, an overflow ends the program where it happens
 * (SIGFPE), instead of going on as an infinity or a NaN. The linker puts these functions before lod's own
 * (TRAPPED in the Makefile). Traps are a thread's own, and threads inherit them. */
#include <fenv.h>

#include "lod/build/ground_tree.h"
#include "lod/plan/allocation.h"
#include "lod/plan/planner.h"
#include "lod/build/plant.h"
#include "lod/raster/raster.h"
#include "lod/plan/fill_budget.h"
#include "lod/build/summary.h"
#include "lod/build/tile.h"

#define TRAPS (FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW)

/* If the compiler assumes that nobody looks (it moves computations to where their result is not needed),
 * traps are not set. */
#ifdef __clang__
static int begin(int traps) { return traps; }
static void end(int before) { (void)before; }
#else
static int begin(int traps)
{
	int before = fegetexcept();
	fedisableexcept(TRAPS);
	feclearexcept(TRAPS);
	feenableexcept(traps);
	return before;
}

static void end(int before) { begin(before & TRAPS); }
#endif

#define TRAPPED(name, parameters, ...) \
	enum eco_code __real_##name parameters; \
	enum eco_code __wrap_##name parameters; \
	enum eco_code __wrap_##name parameters \
	{ \
		int before = begin(TRAPS); \
		enum eco_code code = __real_##name(__VA_ARGS__); \
		end(before); \
		return code; \
	}

#define WITH(traps, name, parameters, ...) \
	void __real_##name parameters; \
	void __wrap_##name parameters; \
	void __wrap_##name parameters \
	{ \
		int before = begin(traps); \
		__real_##name(__VA_ARGS__); \
		end(before); \
	}
#define TRAPPED_VOID(...) WITH(TRAPS, __VA_ARGS__)

/* Four triangles at a time: lanes that nobody reads hold whatever, and may divide by the area of nothing.
 * Those that are read are compared with an integer twin by the rasteriser's own tests. */
#define LANES(...) WITH(0, __VA_ARGS__)

TRAPPED(lod_plan, (struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error),
	plan, input, error)
TRAPPED(lod_plan_ground, (struct eco_plan *plan, const struct eco_scene *scene, const struct eco_view *view,
	double px, struct eco_error *error), plan, scene, view, px, error)
TRAPPED(lod_allocation_make,
	(struct lod_allocation *allocation, struct lod_planner *p, struct eco_error *error), allocation, p,
	error)
TRAPPED(lod_fill_finish, (struct lod_fill *fill, uint64_t budget, struct eco_error *error), fill,
	budget, error)
TRAPPED(lod_plant_build,
	(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error), plant, model, options, error)
TRAPPED(lod_plant_measure,
	(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error), plant, model, options, error)
TRAPPED_VOID(lod_pool_make, (struct lod_pool *pool, const struct lod_plant *plant, uint32_t first, uint32_t count),
	pool, plant, first, count)
TRAPPED_VOID(lod_summary_make, (struct lod_summary *summary, const struct lod_summary_input *input), summary, input)
TRAPPED_VOID(lod_summary_list, (const struct lod_summary *summary, const struct eco_scene *scene, uint32_t tile,
	uint32_t palette, struct eco_list *list, struct eco_elements *elements), summary, scene, tile,
	palette, list, elements)
TRAPPED_VOID(lod_tiles_build, (struct lod_tiles *tiles, const struct lod_tile_item *items, uint32_t count,
	uint32_t most), tiles, items, count, most)
TRAPPED(lod_ground_build, (struct lod_ground_tree *tree, const struct eco_ground *ground, double step,
	double least, struct eco_error *error), tree, ground, step, least, error)
LANES(lod_raster_triangles, (struct lod_raster *raster, const struct lod_raster_batch *batch), raster, batch)
LANES(lod_raster_lines, (struct lod_raster *raster, const struct lod_raster_batch *batch), raster, batch)
