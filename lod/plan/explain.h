/* Why a plan is as it is: for each cut its tile or plant, the vertices that it draws, the pixels that these
 * save, and the reason in words.
 *
 *   struct lod_explanation why = { 0 };
 *   lod_plan(&plan, &(struct lod_planner_input){ ..., .explanation = &why }, &error);
 *   lod_explain_text(text, sizeof text, &why, &why.rows[i]);
 *   lod_explanation_free(&why);
 *
 * A plan without an explanation takes no time or memory for it. */
#pragma once

#include "ecofiles/format/plan.h"
#include "lod/eye.h"

#define LOD_EXPLAINED_MAX 10000u /* rows; further ones are counted in `omitted` */
#define LOD_EXPLAINED_LEAST 1000u        /* the same where work is bounded, or more */

enum lod_why {
	LOD_WHY_DISTANCE,            /* Deussen's rule: the sample distance asks for it */
	LOD_WHY_STEP,                /* the next step of its hull saves less per vertex than lambda */
	LOD_WHY_ROOM,                /* the next step would pay, but is larger than the rest of the budget */
	LOD_WHY_BYTES,               /* the next step would pay for its vertices, but not for its bytes */
	LOD_WHY_PART,                /* lambda lies within a step, which a share of the plants has taken */
	LOD_WHY_LEFT_OVER,           /* added from the rest of the budget, which no lambda or sample distance
	                              * uses */
	LOD_WHY_ALL,                 /* the hull has ended: everything is drawn */
	LOD_WHY_WHOLE,               /* a ladder that shows the whole plant saves more than its organs */
	LOD_WHY_SUMMARY,             /* a tile's summary saves more than its plants and children */
	LOD_WHY_FAR,                 /* a tile's summary is fine enough: its plants are not counted */
	LOD_WHY_GIVES_WAY,           /* summary and plants save nearly the same: both are drawn in part */
	LOD_WHY_PLANTS,              /* a tile's plants and children save more than its summary: there is no
	                              * cut, a run draws them */
	LOD_WHY_GROUND,
	LOD_WHY_COUNT
};
const char *lod_why_name(enum lod_why why);     /* "next step", "left over", ...; for tables */

/* Pixels saved are wrong pixels as the objective weighs them (lod/plan/README.md). */
struct lod_reason {
	enum lod_why why;
	double gain;                 /* saved by its ladder or summary for all its plants, compared with
	                              * nothing drawn; 0 with Deussen's rule */
	double next;                 /* saved per vertex by the next step of the hull; 0: there is none */
	double margin;               /* PART, GIVES_WAY: share of the plants. SUMMARY, PLANTS, WHOLE: how much
	                              * more is saved, as a share; INFINITY: the other choice saves nothing;
	                              * WHOLE: 0 where it saves no more at lambda, but leaves less wrong at
	                              * the budget. GROUND: error in pixels */
	double expected_px;          /* that a plant, or the summary, is expected to show */
	double share;                /* WHOLE: of the slot's plants beyond the gate, that draw it */
	uint64_t ahead;              /* plants that draw more than the others of the slot */
};

struct lod_explained {
	struct eco_cut cut;          /* as in the plan, but of one band; PLANTS: its list is ECO_NONE */
	uint32_t tile;               /* of a summary, ground or PLANTS; else ECO_NONE */
	uint32_t plant;              /* of a rule; else ECO_NONE */
	uint64_t plants;             /* instances that the cut matches in this band */
	double expected_px;          /* that these show, whatever is drawn of them; 0 with Deussen's rule */
	uint64_t vertices;           /* drawn by the cut for these; all rows sum to the plan's unless some are
	                              * omitted */
	struct lod_reason reason;
};

struct lod_explanation {
	double lambda;               /* wrong pixels that a vertex must save; 0: everything fits, or Deussen's
	                              * rule */
	double sample_distance;      /* d' of Deussen's rule, radians; else 0 */
	struct lod_explained *rows;  uint32_t count, capacity;
	uint64_t omitted;
	double expected_px[LOD_DISTANCES];       /* that plants and tiles show, as the planner expects */
	uint32_t most;               /* rows, set by lod_plan */
};
void lod_explanation_free(struct lod_explanation *explanation);

/* One sentence for people without a full stop, such as "more detail would hardly be seen here: elsewhere it
 * improves the picture 2.1 times as much"; at most 120 bytes. */
void lod_explain_text(char *text, size_t size, const struct lod_explanation *explanation,
	const struct lod_explained *row);

/* The row as a line of a table for people: tile or plant with its band, vertices, pixels saved and the
 * sentence. At most 300 bytes. */
void lod_explain_line(char *text, size_t size, const struct eco_scene *scene,
	const struct lod_explanation *explanation, const struct lod_explained *row);
