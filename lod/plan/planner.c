/* A plan, in three steps: set-up, a rule (planner_optimal.c, planner_deussen.c), cuts (planner_emit.c). */
#include "lod/plan/planner.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "lod/plan/fill_budget.h"
#include "lod/plan/allocation.h"

#define CELLS_MOST (1u << 26)            /* of plants, whatever a pack says */

/* Deussen's rule knows no bytes: it is asked again for less. */
static bool knows_bytes(const struct lod_planner_input *input)
{
	return !input->rule || input->rule == lod_rule_optimal || input->request->bytes == ECO_BYTES_UNBOUNDED;
}

enum eco_code lod_planner_begin(struct lod_planner *p, const struct lod_planner_input *input,
	struct eco_error *error)
{
	const struct eco_scene *scene = input->scene;
	*p = (struct lod_planner){ .input = input, .scene = scene, .work_most = input->work_max,
		.level_work = input->level_work ? input->level_work : input->work_max };
	p->ground_px = input->request->ground_px > 0 ? input->request->ground_px : ECO_GROUND_PX;
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
	p->visible.known = input->places;
	const struct eco_request *r = input->request;
	return code ? code : lod_image_see(&p->image, scene, &p->visible.eye, &r->view,
		r->texel_px > 0 ? fmax(r->texel_px, ECO_GROUND_TEXEL_PX_MIN) : ECO_GROUND_TEXEL_PX, error);
}

void lod_planner_end(struct lod_planner *p)
{
	free(p->gates);
	free(p->texture_levels);
	lod_image_free(&p->image);
	eco_wire_body_free(&p->body);
	free(p->entries);
	lod_search_free(p->search);
	lod_plan_tables_free(p->own);
	lod_screen_free(&p->screen);
	if (p->visible.nodes)
		lod_visible_tree_free(&p->visible);
}

/* They are sorted, as are the lists that they need. */
static void count_cuts(struct lod_planner *p, const struct eco_plan *plan)
{
	uint64_t compares = 1;
	for (uint32_t count = plan->cut_count; count; count /= 2)
		compares++;
	lod_planner_work(p, LOD_WORK_CUT * compares * plan->cut_count);
}

/* Draws nothing on the coarsest ground: no answer is smaller, as far as is known. */
static enum eco_code plan_smallest(struct lod_planner *p, struct eco_plan *plan, struct eco_error *error)
{
	const struct eco_view *view = &p->input->request->view;
	eco_plan_free(plan);
	plan->placements = malloc(sizeof *plan->placements);
	if (!plan->placements)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory");
	plan->placements[plan->placement_count++] = (struct eco_placement){ .scale = 1 };
	plan->prediction.fn = (double)view->width * view->height;
	plan->m16 = eco_wire_m16_round(LOD_SEEN_NOTHING / LOD_SEEN_COLOR);
	p->ground_px = ECO_GROUND_PX_MAX;
	if (p->input->explanation)
		lod_explain_begin(p->input->explanation, p->input->work_max);
	return lod_plan_size(p, plan, error);
}

/* The plan of a rule, with its ground. */
static enum eco_code plan_by_rule(struct lod_planner *p, struct eco_plan *plan, struct eco_error *error)
{
	const struct eco_request *request = p->input->request;
	enum eco_code code = (p->input->rule ? p->input->rule : lod_rule_optimal)(p, error);
	code = code ? code : lod_planner_check(p, error);
	if (!code)
		code = lod_planner_emit(p, p->input->explanation, plan, error);
	count_cuts(p, plan);
	if (!code && p->input->explanation)
		p->input->explanation->sample_distance = p->sample_distance;
	if (!code && p->input->sent)
		code = lod_plan_size(p, plan, error);
	else if (!code)
		code = lod_plan_ground(plan, p->scene, &request->view, p->ground_px, error);
	if (!code && p->input->sent && p->bytes > request->bytes && (knows_bytes(p->input) || !request->vertices))
		code = plan_smallest(p, plan, error);
	if (!code)
		lod_explain_ground(p, plan);
	return code;
}

static enum eco_code add_coarser(struct lod_planner *p, const struct eco_plan *plan, struct eco_error *error)
{
	const struct lod_planner_input *input = p->input;
	struct lod_planner_input unexplained = *input;
	unexplained.explanation = NULL;
	input->coarser->count = 0;
	if (!p->search || !input->sent)
		return ECO_OK;
	p->input = &unexplained;
	enum eco_code code = lod_bytes_coarser(p->search, plan, error);
	p->input = input;
	return code;
}

/* `image_price`: of the ground's image, for a rule that knows no bytes. */
static enum eco_code plan_once(struct eco_plan *plan, const struct lod_planner_input *input, double image_price,
	struct lod_planner_stats *stats, struct eco_error *error)
{
	struct lod_planner p;
	*plan = (struct eco_plan){ 0 };
	if (input->explanation)
		lod_explain_begin(input->explanation, input->work_max);
	enum eco_code code = lod_planner_begin(&p, input, error);
	p.image_price = image_price;
	if (!code)
		code = plan_by_rule(&p, plan, error);
	*stats = (struct lod_planner_stats){ p.looks, p.visible.places, 0, p.cheapest, p.level,
		p.converged, p.bytes, p.sized, p.price, p.wrong };
	if (!code && input->coarser)
		code = add_coarser(&p, plan, error);
	if (!code)
		code = lod_planner_check(&p, error);
	stats->work = p.work + p.beside;
	lod_planner_end(&p);
	if (code)
		eco_plan_free(plan);
	return code;
}

/* For a rule that knows no bytes: plans with a share of the vertices, and an image as much dearer. It falls until a
 * plan fits, faster each time, as bytes of textures hardly fall with vertices; then halves the way to more. */
static enum eco_code search_share(struct eco_plan *plan, const struct lod_planner_input *input,
	struct eco_request *request, struct lod_planner_stats *stats, struct eco_error *error)
{
	const uint64_t all = plan->vertices;
	uint64_t work = stats->work;
	double share = 1, part = 1, fits = 0, over = 1;
	enum eco_code code = ECO_OK;
	request->ground_px = plan->ground_px;
	for (uint32_t left = LOD_SEARCH_PART - 1; !code && left > 0; left--) {
		const double used = (double)stats->bytes / (double)request->bytes;
		*(used <= 1 ? &fits : &over) = share;
		if (used <= 1 && (used >= LOD_SEARCH_MOST || left == 1))
			break;
		part *= fmin(LOD_SEARCH_MOST, LOD_SEARCH_MOST / used);
		share = left == 1 ? fits : fits > 0 ? sqrt(fits * over) : share * part;
		request->vertices = (uint64_t)(share * (double)all);
		eco_plan_free(plan);
		code = plan_once(plan, input, fmin(LOD_IMAGE_PRICE / share, ldexp(1, (int)LOD_PRICE_HIGHEST)), stats, error);
		work += stats->work;
		left = request->vertices ? left : 1;
	}
	stats->work = work;
	return code;
}

enum eco_code lod_plan(struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error)
{
	struct lod_planner_stats stats;
	struct lod_planner_input within = *input;
	struct eco_request request = *input->request;
	assert(request.vertices <= ECO_VERTICES_MAX);
	within.request = &request;
	within.work_max /= knows_bytes(input) ? 1 : LOD_SEARCH_PART;
	enum eco_code code = plan_once(plan, &within, knows_bytes(input) ? 0 : LOD_IMAGE_PRICE, &stats, error);
	if (!code && stats.bytes > request.bytes && !knows_bytes(input))
		code = search_share(plan, &within, &request, &stats, error);
	if (code)
		eco_plan_free(plan);
	if (input->stats)
		*input->stats = stats;
	return code;
}
