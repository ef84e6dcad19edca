/* A plan, in three steps: set-up, a rule (planner_optimal.c, planner_deussen.c), cuts (planner_emit.c). */
#include "lod/plan/planner.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "lod/plan/fill_budget.h"
#include "lod/plan/allocation.h"

#define CELLS_MOST (1u << 26)            /* of plants, whatever a pack says */
#define IMAGE_PART 4u                    /* of an answer's bytes: 1 / so many */

enum eco_code lod_planner_begin(struct lod_planner *p, const struct lod_planner_input *input,
	struct eco_error *error)
{
	const struct eco_scene *scene = input->scene;
	*p = (struct lod_planner){ .input = input, .scene = scene, .work_most = input->work_max };
	p->gates = calloc(scene->plant_count + 1, sizeof *p->gates);
	p->tables = input->tables;
	if (!p->gates)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u plants",
			scene->plant_count);
	enum eco_code code = p->tables ? ECO_OK : lod_plan_tables_make(&p->own, scene, error);
	if (code)
		return code;
	p->tables = p->tables ? p->tables : p->own;
	code = lod_visible_tree_init(&p->visible, scene, &input->request->view,
		input->tiles_max ? input->tiles_max : 1000000, input->placements_max ? input->placements_max
		: 100000, error);
	p->visible.cells_most = input->work_max ? CELLS_MOST : 0;
	const struct eco_request *r = input->request;
	return code ? code : lod_image_see(&p->image, scene, &p->visible.eye, &r->view,
		r->texel_px > 0 ? fmax(r->texel_px, ECO_GROUND_TEXEL_PX_MIN) : ECO_GROUND_TEXEL_PX, error);
}

void lod_planner_end(struct lod_planner *p)
{
	free(p->gates);
	free(p->texture_levels);
	lod_image_free(&p->image);
	free(p->entries);
	lod_search_free(p->search);
	lod_plan_tables_free(p->own);
	lod_screen_free(&p->screen);
	if (p->visible.nodes)
		lod_visible_tree_free(&p->visible);
}

static struct lod_planner_input without_explanation(const struct lod_planner_input *input)
{
	struct lod_planner_input unexplained = *input;
	unexplained.explanation = NULL;
	return unexplained;
}

/* They are sorted, as are the lists that they need. */
static void count_cuts(struct lod_planner *p, const struct eco_plan *plan)
{
	uint64_t compares = 1;
	for (uint32_t count = plan->cut_count; count; count /= 2)
		compares++;
	lod_planner_work(p, LOD_WORK_CUT * compares * plan->cut_count);
}

enum eco_code lod_plan(struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error)
{
	struct lod_planner p;
	assert(input->request->vertices <= ECO_VERTICES_MAX);
	*plan = (struct eco_plan){ 0 };
	if (input->explanation)
		lod_explain_begin(input->explanation, input->work_max);
	enum eco_code code = lod_planner_begin(&p, input, error);
	/* a rule that knows no bytes leaves the image a part of them */
	if (!code && input->rule && input->rule != lod_rule_optimal
			&& input->request->bytes != ECO_BYTES_UNBOUNDED)
		p.image_price = lod_image_price(&p.image, input->scene, input->holdings,
			input->request->bytes / IMAGE_PART);
	if (!code)
		code = (input->rule ? input->rule : lod_rule_optimal)(&p, error);
	if (!code)
		code = lod_planner_check(&p, error);
	if (!code)
		code = lod_planner_emit(&p, plan, error);
	count_cuts(&p, plan);
	if (!code && input->explanation)
		input->explanation->sample_distance = p.sample_distance;
	if (!code)
		code = lod_plan_ground(plan, input->scene, &input->request->view, input->request->ground_px,
			error);
	if (!code && input->explanation)
		lod_explain_ground(input->explanation, plan, input->scene, input->request->ground_px);
	struct lod_planner_stats stats = { p.candidates, p.gains, p.looks, p.visible.places, 0, p.cheapest,
		p.level, p.converged, p.bytes, p.sized, p.price, p.wrong };
	const struct lod_planner_input unexplained = without_explanation(input);
	p.input = &unexplained;          /* coarser answers have none */
	bool many = input->coarser && (!input->size || p.bytes > input->coarser->least);
	if (!code && many && p.search)
		code = lod_bytes_coarser(p.search, plan, error);
	if (!code)
		code = lod_planner_check(&p, error);
	stats.work = p.work + p.explaining;
	if (input->stats)
		*input->stats = stats;
	lod_planner_end(&p);
	if (code)
		eco_plan_free(plan);
	return code;
}
