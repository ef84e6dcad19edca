/* Bytes of an answer on the wire, with its ground (lod/plan/planner_state.h). The ground's detail gives way before
 * plants do: once an answer has too many bytes, its ground is as coarse as takes no more than its part of them. */
#include "lod/plan/planner_state.h"

#include <math.h>
#include <stdlib.h>

/* Puts ground of p->ground_px below a plan, and finds what it needs. The caller frees needs->items. */
static enum eco_code put_on_ground(struct lod_planner *p, struct eco_plan *plan, struct eco_holdings *needs,
	struct eco_error *error)
{
	free(needs->items);
	needs->items = NULL;
	enum eco_code code = lod_plan_ground(plan, p->scene, &p->input->request->view, p->ground_px, error);
	code = code ? code : lod_plan_needs(p->scene, plan, needs, error);
	p->beside += LOD_SIZING_WORK * ((uint64_t)plan->cut_count + needs->count) + p->scene->list_count / 4;
	return code;
}

/* Sets p->bytes; `enough`: payloads alone, where these are too many. */
static enum eco_code count_bytes(struct lod_planner *p, const struct eco_plan *plan,
	const struct eco_holdings *needs, bool enough, struct eco_error *error)
{
	p->bytes = lod_plan_missing(p->scene, p->input->holdings, needs, NULL);
	if (enough && p->bytes > p->input->request->bytes)
		return ECO_OK;
	enum eco_code code = p->body.scene ? ECO_OK
		: eco_wire_body_init(&p->body, p->scene, NULL, NULL, p->input->request->name_from, error);
	p->body.cancelled = p->input->cancelled;
	return code ? code : eco_wire_body_size(&p->body, p->input->holdings, plan, needs, &p->bytes, error);
}

/* Makes ground coarser until it takes no more than its part of `most` bytes, 0: of the plan's own; where it always
 * does, as coarse as takes least: a few tiles of rough ground may need more than finer ones beside the view. */
static enum eco_code coarsen_ground(struct lod_planner *p, struct eco_plan *plan, uint64_t most,
	struct eco_holdings *needs, struct eco_error *error)
{
	double best_px = p->ground_px;
	uint64_t least = UINT64_MAX, ground;
	for (;;) {
		ECO_PASS(put_on_ground(p, plan, needs, error));
		uint64_t all = lod_plan_missing(p->scene, p->input->holdings, needs, &ground);
		if (ground < least) {
			least = ground;
			best_px = p->ground_px;
		}
		if (p->ground_px >= ECO_GROUND_PX_MAX || ground <= (most ? most : all) / LOD_GROUND_PART)
			break;
		p->ground_px = fmin(LOD_GROUND_STEP * p->ground_px, ECO_GROUND_PX_MAX);
	}
	if (p->ground_px == best_px)
		return ECO_OK;
	p->ground_px = best_px;
	return put_on_ground(p, plan, needs, error);
}

enum eco_code lod_plan_size(struct lod_planner *p, struct eco_plan *plan, struct eco_error *error)
{
	const uint64_t most = p->input->request->bytes;
	const bool first = !p->ground_settled;
	struct eco_holdings needs = { .items = NULL };
	enum eco_code code = put_on_ground(p, plan, &needs, error);
	code = code ? code : count_bytes(p, plan, &needs, first, error);
	if (!code && first && p->bytes > most) {
		p->ground_settled = true;
		if (p->scene->ground_count) {
			p->ground_px = fmax(p->ground_px, LOD_GROUND_PX_SCARCE);
			code = coarsen_ground(p, plan, most, &needs, error);
			code = code ? code : count_bytes(p, plan, &needs, first, error);
		}
	}
	free(needs.items);
	return code;
}

enum eco_code lod_plan_coarsen_ground(struct lod_planner *p, struct eco_plan *plan, uint64_t *missing,
	struct eco_error *error)
{
	struct eco_holdings needs = { .items = NULL };
	enum eco_code code = coarsen_ground(p, plan, 0, &needs, error);
	*missing = code ? 0 : lod_plan_missing(p->scene, p->input->holdings, &needs, NULL);
	free(needs.items);
	return code;
}
