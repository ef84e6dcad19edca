/* Rules of papers that spend the vertices of a whole scene, each by one parameter that the budget decides.
 *
 *   Deussen 2002   the sample distance d' (paper_deussen)
 *   Cook 2007      the distance r up to which all leaves are drawn (paper_cook): lambda = min(1, (r / R)^2),
 *                  so that leaves keep their size in pixels beyond it
 *   Neubert 2011   the same r, for the lambda whose quality is to be kept (paper_cook with its tables)
 *   Lee 2007       the same lambda as a budget of leaves for each plant (paper_lee)
 *
 * Wood: Deussen's lines and polygons; the other papers prune leaves alone, and their wood is what our ladders
 * draw for the share lambda of its vertices. */
#pragma once

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "lod/arena.h"
#include "lod/plan/planner_state.h"
#include "lod/vector.h"
#include "tests/bench/baseline/cook.h"

/* ---- Scenes (paper_scene.c) ----
 *
 * A pack open for the rules of papers: every list decoded in a client's store, plans made of cuts, frames
 * drawn by the client's rasteriser. No server and no wire stand between, so a rule may draw lists that no
 * pack holds.
 *
 *   paper_scene_open(&s, path, &error);
 *   paper_shoot(s, &request, rule, ctx, &x, samples, &frame);       calls the rule as often as it likes:
 *     paper_open(&p, d, &error);                    opens tiles and counts plants by slot
 *     paper_cut(&p, slot, &cut);                    a cut for all plants of a slot, or by share of hash
 *
 * Deussen's lists (2002, section 4.1, stratified): two points for each triangle, one behind the other, so
 * that points [2i, 2i + 2) stand for triangle i. The packs' own orders are random (`--order stochastic`). */

/* A ladder's lines in another order: those wider than `width` come first, as wide as they are, since a trunk
 * is no twig and its modeller would not draw it as one; then all others at random, each `width` wide. List i
 * has 2^(i/2) times the mean width. */
#define PAPER_WIDTHS 13u
struct paper_lines {
	uint32_t list, thick;
	double width, thin;          /* metres; thin: the mean of the others as they were modelled */
};

struct paper_scene {
	struct eco_pack *pack;
	const struct eco_scene *scene;
	struct lod_plan_tables *tables;
	struct view_store *store;
	struct view_sky sky;  /* of frames; the caller's */
	uint32_t *points;     /* per ladder: two points a triangle; ECO_NONE where it has lines */
	struct paper_lines *lines;   /* PAPER_WIDTHS per ladder; width 0: it has no lines */
	uint32_t **triangles; /* per list of triangles: those of its first i elements, i = 0 .. */
	double *wood_full;    /* per plant: vertices of its wood at full detail */
};
/* The pack may be none that can be read. */
enum eco_code paper_scene_open(struct paper_scene **scene, const char *pack, struct eco_error *error);
void paper_scene_close(struct paper_scene *scene);       /* NULL is fine */

/* Other errors end the program: paper_must(call(..., paper_error)). */
extern struct eco_error *const paper_error;
void paper_must(enum eco_code code);

/* Triangles of a list's first elements. */
uint32_t paper_triangles(const struct paper_scene *s, uint32_t list, uint32_t elements);
/* A ladder of leaves: not of wood, not one that shows the whole plant, with triangles. */
bool paper_is_leaves(const struct eco_ladder *ladder);

struct paper {
	const struct paper_scene *s;
	struct lod_planner_input input;
	struct eco_request request;
	struct lod_planner p;
	struct eco_cut *cuts;
	uint32_t cut_count, cut_room;
};
/* Tiles whose summary suffices for d' become summaries; 0: every plant is counted. p->p.gates are set. False:
 * the view holds more than a walk may look at. */
bool paper_open(struct paper *p, double d);
/* Takes list, first, end, scale and shares from `cut`; share_end 0: all plants of the slot. Empty cuts are
 * left out. */
void paper_cut(struct paper *p, const struct lod_slot *slot, const struct eco_cut *cut);
/* Whether a ladder is drawn in a slot: some only where a plant's cells are not. */
bool paper_applies(const struct paper *p, const struct eco_ladder *ladder, const struct lod_slot *slot);
struct paper_frame { /* owns picture and selection */
	struct view_picture picture;
	struct view_selection selection;
};
void paper_frame_free(struct paper_frame *frame);

/* A rule at one value of its only parameter makes cuts; false as paper_open. */
typedef bool paper_rule(struct paper *p, double x, void *ctx);
/* Draws the plan of a rule with so many samples a pixel and soft counts; 0: one, and no counts. *x is its
 * parameter; 0: the value with most vertices within the budget, which *x becomes. It is searched in
 * proportion; nothing is drawn if all are too many. */
void paper_shoot(struct paper_scene *s, const struct eco_request *request, paper_rule *rule, void *ctx,
	double *x, uint32_t samples, struct paper_frame *frame);

/* ---- Deussen 2002, section 5 ---- */

struct paper_deussen {
	double splat_factor; /* c_p, 1.2 to 1.5; 0: 1.3 */
	/* without the octree (6.1): all cells of a plant at its mean distance, over all instances of it */
	bool whole;
};

/* The scene's points and lines. */
void paper_deussen_lists(struct paper_scene *s);
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
bool paper_deussen(struct paper *p, double d, void *deussen);

/* ---- Neubert 2011: tables (section 3) and occlusion (section 4) ----
 *
 *   tables = paper_tables_make(scene);      draws the leaves of every plant alone
 *   sight = paper_sight_new(scene);
 *   ... a plan by paper_cook with both, a frame ...
 *   paper_sight_update(sight, &frame, &view);       before the next plan
 *
 * An iso-surface's points that its own crown hides count as hidden in the paper. Here only other plants
 * hide, so that a plant alone has f = 1. */

#define PAPER_LAMBDAS 12u

struct paper_table { /* of one plant's leaves, lambda ascending to 1 */
	double lambda[PAPER_LAMBDAS], s_opt[PAPER_LAMBDAS], s_cook[PAPER_LAMBDAS];
	double q_opt[PAPER_LAMBDAS], q_cook[PAPER_LAMBDAS];
	double leaves, share; /* share: lod_cook_share */
};
/* One per plant; the caller frees them. */
struct paper_table *paper_tables_make(struct paper_scene *scene);

/* The smallest lambda whose Q with s_opt is at least that of Cook at lambda; never above it. */
double paper_table_optimal(const struct paper_table *table, double lambda);
double paper_table_scale(const struct paper_table *table, double lambda);
/* Cook's, with the correction for depth complexity. */
double paper_table_cook(const struct paper_table *table, double lambda);

struct paper_sight;
struct paper_sight *paper_sight_new(const struct paper_scene *scene);
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

/* ---- Cook 2007, and Neubert 2011 ---- */

double paper_cook_lambda(double r, double full_m);

struct paper_cook {
	/* per plant, of paper_tables_make; NULL: scale 1 / lambda without correction */
	const struct paper_table *tables;
	bool optimal;              /* Neubert's lambda_opt and s_opt */
	struct paper_sight *sight; /* with it, lambda_opt max(f, .1); NULL: every plant is visible */
};
bool paper_cook(struct paper *p, double full_m, void *cook);

/* Leaves [0, kept) of a region. The ladder's list holds those after `before`. Fewer than one leaf is one leaf
 * of some of the plants. */
void paper_leaves(struct paper *p, const struct lod_slot *slot, const struct eco_ladder *l, double kept,
	double scale, uint32_t share_first, uint32_t share_end);
/* Cuts of wood for a share of its vertices. */
void paper_wood(struct paper *p, const struct lod_slot *slot, uint32_t ladder, double lambda,
	uint32_t share_first, uint32_t share_end);

/* ---- Lee 2007: leaves under a budget, ranked for one view ----
 *
 *   distance       the nearest leaf first, by Euclidean distance
 *   normal         the leaf that faces the eye best first: |normal . direction to the eye|
 *   layer+normal   G layers of equal thickness along the view; layer i from the front gets (G - i + 1) / (1 +
 *                  ... + G) of the budget, what it cannot use goes to the next, and what the last cannot use
 *                  goes to the front again; inside a layer by normal */

enum lod_lee_method { LOD_LEE_DISTANCE, LOD_LEE_NORMAL, LOD_LEE_LAYER, LOD_LEE_COUNT };

/* The paper does not say how many. */
#define LOD_LEE_LAYERS 5u

/* Leaves: normals of any length; zero ones face nowhere. Or cells of `size` leaves each, as the paper says
 * that it must be at run time: `facing` is then the mean of n n^T over their unit normals: xx, yy, zz, xy,
 * xz, yz. */
struct lod_lee_leaves {
	uint32_t count, *size;
	struct lod_v3 *center, *normal;
	double (*facing)[6];
};
/* Room for `most` cells; adds one. */
void lod_lee_cells(struct lod_lee_leaves *cells, uint32_t most, struct lod_arena *arena);
void lod_lee_cell_add(struct lod_lee_leaves *cells, const struct lod_v3 *center, const struct lod_v3 *normal,
	const uint32_t *leaves, uint32_t count);
/* forward: unit; layers: 0 for LOD_LEE_LAYERS */
struct lod_lee_view { struct lod_v3 eye, forward; uint32_t layers; };

/* The numbers of the leaves that are drawn: as many as the budget, or all there are; returns how many. Ties
 * go to the smaller number. A cell stands in it once for each leaf. */
uint32_t lod_lee_keep(uint32_t *kept, enum lod_lee_method method, const struct lod_lee_leaves *leaves,
	const struct lod_lee_view *view, uint32_t budget, struct lod_arena *arena);

/* On whole scenes the three orders choose among the cells of each plant, for a budget of leaves that Cook's
 * lambda gives each plant. A cell keeps the first leaves of its list, scaled as Cook's are. A plant with a
 * budget of so few leaves that most cells would be empty draws the first leaves of the whole. */
extern const char *const paper_lee_names[LOD_LEE_COUNT];

struct paper_lee_plant;
struct paper_lee {
	const struct paper_table *tables;
	enum lod_lee_method method;
	struct paper_lee_plant *plants;
	struct lod_arena arena;
};
void paper_lee_begin(struct paper_lee *lee, const struct paper_scene *s);
void paper_lee_end(struct paper_lee *lee);
bool paper_lee(struct paper *p, double full_m, void *lee);
