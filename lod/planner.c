/* A plan: what both rules share. planner_optimal.c and planner_deussen.c decide how much of everything is drawn, planner_emit.c writes it
 * down. */
#include "lod/planner.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "lod/planning.h"

enum eco_code lod_planning_begin(struct lod_planning *p, const struct lod_planner_input *input, struct eco_error *error)
{
	const struct eco_scene *scene = input->scene;
	*p = (struct lod_planning){ .input = input, .scene = scene };
	p->gates = calloc(scene->plant_count + 1, 1);
	p->ladder_first = calloc(scene->anchor_count + 2, sizeof *p->ladder_first);
	p->ladder_order = calloc(scene->ladder_count + 1, sizeof *p->ladder_order);
	if (!p->gates || !p->ladder_first || !p->ladder_order)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u ladders", scene->ladder_count);
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		p->ladder_first[scene->ladders[i].anchor + 2]++;
	for (uint32_t i = 2; i <= scene->anchor_count + 1; i++)
		p->ladder_first[i] += p->ladder_first[i - 1];
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		p->ladder_order[p->ladder_first[scene->ladders[i].anchor + 1]++] = i;
	return lod_visible_init(&p->visible, scene, &input->request->view, input->tiles_max ? input->tiles_max : 1000000,
		input->placements_max ? input->placements_max : 100000, error);
}

void lod_planning_end(struct lod_planning *p)
{
	free(p->gates);
	free(p->ladder_first);
	free(p->ladder_order);
	free(p->entries);
	free(p->bodies);
	lod_screen_free(&p->screen);
	if (p->visible.nodes)
		lod_visible_free(&p->visible);
}

enum eco_code lod_plan(struct eco_plan *plan, const struct lod_planner_input *input, struct eco_error *error)
{
	struct lod_planning p;
	double sample_distance = 0;
	assert(input->request->vertices <= ECO_VERTICES_MAX);
	*plan = (struct eco_plan){ 0 };
	enum eco_code code = lod_planning_begin(&p, input, error);
	if (!code && input->rule == LOD_RULE_DEUSSEN)
		code = lod_planning_deussen(&p, &sample_distance, error);
	else if (!code)
		code = lod_planning_optimal(&p, error);
	if (!code)
		code = lod_planning_emit(&p, sample_distance, plan, error);
	if (!code)
		code = lod_plan_ground(plan, input->scene, &input->request->view, input->request->ground_px, error);
	if (input->stats)
		*input->stats = (struct lod_planner_stats){ p.candidates, p.visible.places, p.cheapest, p.level, p.wrong };
	lod_planning_end(&p);
	if (code)
		eco_plan_free(plan);
	return code;
}
