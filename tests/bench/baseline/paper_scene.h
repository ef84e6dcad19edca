/* A pack open for the rules of papers: every list decoded in a client's store, plans made of cuts, frames
 * drawn by the client's rasteriser. No server and no wire stand between, so a rule may draw lists that no
 * pack holds.
 *
 *   paper_scene_open(&s, path, &error);
 *   paper_shoot(s, &request, rule, ctx, &x, soft, &frame, &error);       calls the rule as often as it likes:
 *     paper_open(&p, d, &error);                    opens tiles and counts plants by slot
 *     paper_cut(&p, slot, &cut);                    a cut for all plants of a slot, or by share of hash
 *
 * Deussen's lists (2002, section 4.1, stratified): two points for each triangle, one behind the other, so
 * that points [2i, 2i + 2) stand for triangle i. The packs' own orders are random (`--order stochastic`). */
#ifndef TESTS_BENCH_BASELINE_PAPER_SCENE_H
#define TESTS_BENCH_BASELINE_PAPER_SCENE_H

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "lod/plan/planner_state.h"

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
	uint32_t *points;     /* per ladder: two points a triangle; ECO_NONE where it has lines */
	struct paper_lines *lines;   /* PAPER_WIDTHS per ladder; width 0: it has no lines */
	uint32_t **triangles; /* per list of triangles: those of its first i elements, i = 0 .. */
	double *wood_full;    /* per plant: vertices of its wood at full detail */
};
enum eco_code paper_scene_open(struct paper_scene **scene, const char *pack, struct eco_error *error);
void paper_scene_close(struct paper_scene *scene);

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
	bool no_memory;
};
/* Tiles whose summary suffices for d' become summaries; 0: every plant is counted. p->p.gates are set. */
enum eco_code paper_open(struct paper *p, double d, struct eco_error *error);
/* Takes list, first, end, scale and shares from `cut`; share_end 0: all plants of the slot. Empty cuts are
 * left out. */
void paper_cut(struct paper *p, const struct lod_slot *slot, const struct eco_cut *cut);
/* Whether a ladder is drawn in a slot: some only where a plant's cells are not. */
bool paper_applies(const struct paper *p, const struct eco_ladder *ladder, const struct lod_slot *slot);
struct paper_frame { /* owns both */
	struct view_picture picture;
	struct view_selection selection;
};
/* Takes the plan over. Soft counts are filled where `soft`. */
enum eco_code paper_draw(struct paper_scene *s, struct eco_plan *plan, const struct eco_view *view, bool soft,
	struct paper_frame *frame, struct eco_error *error);
void paper_frame_free(struct paper_frame *frame);

/* A rule at one value of its only parameter makes cuts. */
typedef enum eco_code paper_rule(struct paper *p, double x, void *ctx, struct eco_error *error);
/* Draws the plan of a rule. *x is its parameter; 0: the value with most vertices within the budget, which *x
 * becomes. It is searched in proportion; nothing is drawn if all are too many. */
enum eco_code paper_shoot(struct paper_scene *s, const struct eco_request *request, paper_rule *rule,
	void *ctx,
	double *x, bool soft, struct paper_frame *frame, struct eco_error *error);

#endif
