#include "lod/plan/impostor_worth.h"

#include <math.h>
#include <string.h>

#include "lod/impostor.h"

/* Even small plants look better in more directions, but bytes count (lod/EXPERIMENTS.md, Impostors, Small
 * pictures): a level begins where the one before has fewer texels than pixels. */
double lod_impostor_from(uint32_t level, double times)
{
	double least = level ? eco_impostor_sizes[level - 1].texels : 0;
	if (level && !(times >= 1))
		return INFINITY;
	return level && times < 2 ? least + (2 - times) * (LOD_IMPOSTOR_PIXELS - least) : least;
}

/* Across, of the whole plant's sphere. */
static double slot_pixels(const struct lod_allocation *m, const struct lod_slot *slot)
{
	double px = 1 / (lod_band_distance_m(slot->band) * m->p->visible.eye.pixel_rad);
	return 2 * (double)m->p->scene->anchors[slot->anchor].radius * px;
}

uint32_t lod_impostor_of_slot(const struct lod_allocation *m, const struct lod_slot *slot,
	const struct lod_way *way)
{
	const struct lod_impostor_use *use = &m->impostors[slot->plant];
	double pixels = slot_pixels(m, slot);
	uint32_t level = 0;
	if (!lod_hull_impostor_levels(way) || pixels > LOD_IMPOSTOR_PIXELS)
		return ECO_NONE;
	while (level + 1 < use->levels && use->from_px[level + 1] < pixels)
		level++;
	return level;
}

static double level_error(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level)
{
	const struct eco_curve *sample = &scene->curves[ladder->curve_first + level];
	return (double)sample->fp + (double)sample->fn;
}

/* `seen`: pixels of all plants of that kind. */
static struct lod_impostor_use use_of(const struct eco_scene *scene, const struct eco_ladder *ladder,
	double seen, double price)
{
	const struct eco_list *list = &scene->lists[ladder->impostor];
	struct lod_impostor_use use = { .levels = 1 };
	for (uint32_t level = 1; level < list->primitive_count; level++) {
		double less = level_error(scene, ladder, level - 1) - level_error(scene, ladder, level),
			right = seen * less, bytes = scene->chunks[list->chunk_first + level].size_bytes,
			from = lod_impostor_from(level, right
			/ (fmax(price, lod_impostor_worth_least(level)) * bytes));
		if (!(from < INFINITY))
			break;
		use.from_px[level] = fmax(from, use.from_px[level - 1]);
		use.levels++;
	}
	return use;
}

void lod_impostor_worth(struct lod_allocation *m, const double *seen)
{
	const struct lod_planner *p = m->p;
	const struct eco_scene *scene = p->scene;
	memset(m->plant_seen, 0, scene->plant_count * sizeof *m->plant_seen);
	for (uint32_t s = 0; s < p->visible.slot_count; s++) {
		const struct lod_slot *slot = &p->visible.slots[s];
		if (!slot->cell && slot_pixels(m, slot) <= LOD_IMPOSTOR_PIXELS)
			m->plant_seen[slot->plant] += seen[s];
	}
	for (uint32_t i = 0; i < scene->plant_count; i++) {
		uint32_t count;
		const uint32_t *whole = lod_plan_tables_whole(p->tables, scene->plants[i].anchor_first,
			&count);
		for (uint32_t k = 0; k < count; k++)
			if (scene->ladders[whole[k]].impostor != ECO_NONE)
				m->impostors[i] = use_of(scene, &scene->ladders[whole[k]], m->plant_seen[i], m->price);
	}
}
