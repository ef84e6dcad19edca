#include "lod/plan/halvings.h"

#include <math.h>

#include "ecofiles/format/wire.h"
#include "lod/scattered.h"

#define PART_PX 8.0              /* narrower points look no better (lod/EXPERIMENTS.md, Scattered points) */
#define PART_STEP 1.41421356237309504880
#define PART_PX_MAX 1e6          /* wider points are not scattered */

float lod_summary_scale(const struct lod_entry *entry)
{
	return eco_wire_scale_round((float)((double)entry->full / fmax(entry->wanted,
		(double)entry->vertices)));
}

static double width_px(const struct lod_planner *p, const struct lod_entry *entry)
{
	const struct lod_node *node = &p->visible.nodes[entry->ladder];
	const struct eco_list *list = &p->scene->lists[p->scene->tiles[node->tile].summary];
	return 2 * lod_ball_radius(list, lod_summary_scale(entry)) * p->visible.placements[node->placement].scale
		/ (node->distance * p->visible.eye.pixel_rad);
}

uint8_t lod_halvings(const struct lod_planner *p, const struct lod_entry *entry, double part_px)
{
	bool seen = entry->vertices && isfinite(part_px) && p->visible.nodes[entry->ladder].distance > 0;
	double width = seen ? width_px(p, entry) : 0;
	uint8_t halvings = 0;
	for (; width > part_px && halvings < ECO_HALVINGS_MAX; width *= M_SQRT1_2)
		halvings++;
	return halvings;
}

static uint64_t added(const struct lod_planner *p, double part_px)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < p->entry_count; i++)
		if (p->entries[i].slot == ECO_NONE)
			sum += (p->entries[i].vertices << lod_halvings(p, &p->entries[i], part_px))
				- p->entries[i].vertices;
	return sum;
}

double lod_part_px(const struct lod_planner *p)
{
	uint64_t left = p->input->request->vertices - p->vertices;
	double part_px = PART_PX;
	while (part_px < PART_PX_MAX && added(p, part_px) > left)
		part_px *= PART_STEP;
	return part_px < PART_PX_MAX ? part_px : INFINITY;
}
