/* From a model to lists: a plant ready to be packed.
 *
 *   lod_plant_build(&plant, &model, &options, &error);     organs -> elements -> order -> cells -> lists
 *   lod_plant_measure(&plant, &model, &options, &error);   the grid's bits; scales and curves
 *   ... the caller packs plant.lists (eco_pack_add_list) and the tables ...
 *   lod_plant_free(&plant);
 *
 * An object (model.h) is wood in levels and nothing else: no lines, points, splats, impostor or cells, so
 * that whatever is drawn of it is a whole mesh. Its levels have a bound on their error in place of a number
 * of triangles, so that no part of it goes.
 *
 * Pure and deterministic: the same model and options give the same lists, byte for byte. References between
 * drafts are indices into this plant's own arrays; the caller shifts them when packing. */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/model.h"
#include "ecofiles/format/pack.h"
#include "lod/build/order/order.h"

/* Searches and how they end: within a tolerance of the optimum, or at a bound on tries. A result at the bound
 * is valid, but counted as not converged (`ecopack info --json`, `searches`; lod_planner_stats;
 * ECO_TRACE=plan). Work with a fixed number of passes is not counted. */
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

struct lod_list_draft {
	struct eco_list list;                /* kind, coder, attributes, grid, unit_area, counts; image,
	                                      * partner and palette_* are indices into this plant's images,
	                                      * lists, palette (ECO_NONE: absent) */
	struct eco_elements elements;        /* in priority order */
	uint32_t *ends; /* element index at the end of each chunk; level ends are chunk ends */
	uint32_t end_count;
};

struct lod_organ_stats {
	uint32_t components, elements, triangles;
	double area;                         /* m^2 */
};

struct lod_plant {
	struct eco_plant plant;              /* name, height, area, triangles; the caller sets the *_first */
	struct eco_anchor *anchors;          /* [0] is the whole plant */
	struct eco_ladder *ladders;          /* plant = 0; anchor, lists, curve_first: indices into this
	                                      * plant's arrays */
	uint32_t ladder_count;
	struct eco_curve *curves;            uint32_t curve_count;
	struct lod_list_draft *lists;        uint32_t list_count;
	uint8_t (*palette)[3];               uint32_t palette_count;
	/* levels of its impostor as bytes (ecofiles/format/impostor.h); a ladder that has it names the list
	 * after `lists` */
	struct eco_bytes *impostor;          uint32_t impostor_count;
	uint8_t impostor_level;              /* code for eco_level_share, as in its lists of points */
	uint32_t *images;                    uint32_t image_count; /* indices of the model's images in use */
	struct lod_organ_stats organ[ECO_ORGAN_COUNT];
	uint32_t triangles_in, triangles_stored, dropped[ECO_DROP_COUNT];   /* in = stored + sum of dropped */
	struct lod_solved solved[LOD_SOLVER_COUNT];  /* searches that this plant took */
};

/* Calls piece(pieces, i) once for each i below count, in any order and in any number of threads; returns when
 * all are done. */
typedef void lod_each(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces);

/* each(...), or the pieces in turn where `each` is NULL. */
static inline void lod_each_run(lod_each *each, void *ctx, uint32_t count,
	void (*piece)(void *pieces, uint32_t i), void *pieces)
{
	if (each)
		each(ctx, count, piece, pieces);
	for (uint32_t i = 0; !each && i < count; i++)
		piece(pieces, i);
}

enum lod_plant_stage { LOD_STAGE_ELEMENTS, LOD_STAGE_ORDERS, LOD_STAGE_LISTS, LOD_STAGE_SPLATS,
	LOD_STAGE_CURVES };

struct lod_plant_options {
	const char *name;
	float importance[ECO_ORGAN_COUNT];   /* all 0: from colours; else 0 means 1 */
	uint32_t seed;
	/* 0: LOD_ORDER_GREEDY. It takes long, so with grid_bits 0 lod_plant_build makes a draft in combined
	 * order, and lod_plant_measure builds again once the grid is chosen. */
	enum lod_order_method order;
	uint32_t cell_triangles;             /* a cell of more triangles is split (octree); 0: 4096 */
	uint32_t grid_bits;                  /* of the largest extent; 0: chosen by measurement, 12 to 18 */
	uint32_t views, pixels;              /* for curves; 0: 12 views of 256 pixels */
	bool no_splats;                      /* no ladder for the plant as a whole */
	/* A plant for a first look, in about a tenth of the time: in combined order, whatever `order` is, on
	 * the least grid, with fewer samples in few small views, short fits of splats, and no impostor. */
	bool draft;
	/* called now and then with the share done, in [0,1]; returns false to stop with ECO_INTERRUPTED; may
	 * be NULL */
	bool (*progress)(void *ctx, double share);
	double progress_end;                 /* the share that is done after lod_plant_build; 0: 1 */
	/* A stage begins, perhaps not for the first time; may be NULL. */
	void (*stage)(void *ctx, enum lod_plant_stage stage);
	/* For work that can run in parallel, with the same result; NULL: sequential. */
	lod_each *each;
	void *ctx;
};

static inline bool lod_plant_goes_on(const struct lod_plant_options *options, double share)
{
	double end = options->progress_end > 0 ? options->progress_end : 1;
	return !options->progress || options->progress(options->ctx, end * share);
}

static inline void lod_plant_enter(const struct lod_plant_options *options, enum lod_plant_stage stage)
{
	if (options->stage)
		options->stage(options->ctx, stage);
}

enum eco_code lod_plant_build(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error);
enum eco_code lod_plant_measure(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error);
void lod_plant_free(struct lod_plant *plant);

/* A finished plant as bytes, and back, equal in every field but its name; after a failure *plant is empty.
 * Only the program that wrote the bytes may read them: they are its memory, with differences of lists in
 * varints. */
void lod_plant_write(struct eco_writer *writer, const struct lod_plant *plant);
enum eco_code lod_plant_read(struct lod_plant *plant, const uint8_t *bytes, size_t size,
	struct eco_error *error);
