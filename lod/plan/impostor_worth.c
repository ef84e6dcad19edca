#include "lod/plan/impostor_worth.h"

#include "lod/impostor.h"

/* Even small plants look better in more directions, but bytes count (lod/EXPERIMENTS.md, Impostors, Small
 * pictures). */
uint32_t lod_impostor_level(uint32_t levels, double pixels)
{
	uint32_t level = 0;
	if (!levels || pixels > LOD_IMPOSTOR_PIXELS)
		return ECO_NONE;
	while (level + 1 < levels && eco_impostor_sizes[level].texels < pixels)
		level++;
	return level;
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
	uint32_t levels = lod_hull_impostor_levels(way), worth = m->impostor_levels[slot->plant];
	return lod_impostor_level(levels < worth ? levels : worth, slot_pixels(m, slot));
}

static double level_error(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level)
{
	const struct eco_curve *sample = &scene->curves[ladder->curve_first + level];
	return (double)sample->fp + (double)sample->fn;
}

/* Levels, from the smallest on, of which each is worth its bytes; `seen`: pixels of all plants of that
 * kind. */
static uint8_t levels_worth(const struct eco_scene *scene, const struct eco_ladder *ladder, double seen)
{
	const struct eco_list *list = &scene->lists[ladder->impostor];
	uint32_t level = 1;
	while (level < list->primitive_count
			&& seen * (level_error(scene, ladder, level - 1) - level_error(scene, ladder, level))
			>= LOD_IMPOSTOR_WORTH * scene->chunks[list->chunk_first + level].size_bytes)
		level++;
	return (uint8_t)level;
}

void lod_impostor_worth(struct lod_allocation *m)
{
	const struct lod_planner *p = m->p;
	const struct eco_scene *scene = p->scene;
	for (uint32_t s = 0; s < p->visible.slot_count; s++) {
		const struct lod_slot *slot = &p->visible.slots[s];
		double pixels = slot->cell ? 0 : m->slot_choices[s].seen * (double)m->counts[s];
		if (slot_pixels(m, slot) <= LOD_IMPOSTOR_PIXELS)
			m->plant_seen[slot->plant] += pixels;
	}
	for (uint32_t i = 0; i < scene->plant_count; i++) {
		uint32_t count;
		const uint32_t *whole = lod_plan_tables_whole(p->tables, scene->plants[i].anchor_first,
			&count);
		for (uint32_t k = 0; k < count; k++)
			if (scene->ladders[whole[k]].impostor != ECO_NONE)
				m->impostor_levels[i] = levels_worth(scene, &scene->ladders[whole[k]],
					m->plant_seen[i]);
	}
}
