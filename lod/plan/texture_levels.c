#include "lod/plan/texture_levels.h"
#include "lod/impostor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEARER 0.8408964152537145        /* 2^(-1/4): a plant of a band against the band's middle, at most */

#define COST_FULL 8.0

double lod_texel_px(const struct lod_planner *p, uint32_t image, uint32_t anchor, uint8_t band)
{
	double area = (double)p->scene->lists[image].unit_area,
		distance = NEARER * lod_band_distance_m(band) - (double)p->scene->anchors[anchor].radius;
	return area > 0 && distance > 0 ? sqrt(area) / (distance * p->visible.eye.pixel_rad) : INFINITY;
}

uint32_t lod_texture_levels(const struct lod_planner *p, uint32_t image, double px)
{
	double asked = p->input->request->texel_px, most = asked > 0 ? asked : ECO_TEXEL_PX;
	uint32_t levels = p->scene->lists[image].primitive_count;
	for (; levels > 1 && 2 * px <= most; levels--)
		px *= 2;
	return levels;
}

/* Each level less loses what lies along twice as wide a border, until it knows no more than how much is opaque
 * (lod/EXPERIMENTS.md, Textures). */
double lod_outline_loss(const struct lod_planner *p, uint32_t outline, uint32_t levels)
{
	const struct eco_list *list = &p->scene->lists[outline];
	double share = 0, step = (double)list->level / ECO_LOSS_ONE;
	if (levels < list->primitive_count && list->level == 0)
		return INFINITY;
	for (uint32_t n = list->primitive_count; n > levels; n--, step *= 2)
		share += step * fmax(0, 1 - share / LOD_OUTLINE_LOSS_MAX);
	return LOD_OUTLINE_WRONG * fmin(share, LOD_OUTLINE_LOSS_MAX);
}

/* Octaves of rounding do no harm: the cost is the same on every machine. */
/* Cost in wrong pixels of a pixel that is seen through texels of `px` pixels (any above 0, or INFINITY):
 * little for each octave up to a pixel, then as much as for elements that are wider (lod/plan/README.md). */
static double texel_cost(double px)
{
	double octaves = px < COST_FULL ? lod_octaves(px) : LOD_TEXEL_COST_OCTAVES,
		below = fmin(0, fmax(octaves, LOD_TEXEL_COST_FROM)) - LOD_TEXEL_COST_FROM,
		above = fmin(LOD_TEXEL_COST_OCTAVES, fmax(0, octaves));
	return LOD_TEXEL_COST_BELOW * below + LOD_TEXEL_COST_ABOVE * above;
}

double lod_texel_loss(double px, uint32_t fewer)
{
	px = fmin(1, px);
	while (fewer--)
		px *= 2;
	return texel_cost(px);
}

static int by_list(const void *a, const void *b)
{
	const struct eco_cut *x = a, *y = b;
	if (x->list != y->list)
		return x->list < y->list ? -1 : 1;
	return x->end < y->end ? -1 : x->end > y->end;
}

static struct eco_cut cut_of(uint32_t list, uint32_t levels)
{
	return (struct eco_cut){ .list = list, .end = levels, .scale = 1, .anchor = ECO_NONE,
		.share_end = ECO_SHARE_ONE };
}

/* Two cuts at most for each that shows a texture, behind the plan's; returns how many. */
static uint32_t cuts_of(const struct eco_plan *plan, const struct lod_planner *p, struct eco_cut *to)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		const struct eco_cut *cut = &plan->cuts[i];
		uint32_t image = p->scene->lists[cut->list].image;
		if (image == ECO_NONE)
			continue;
		double px = lod_texel_px(p, image, cut->anchor, cut->band_first);
		uint32_t levels = lod_texture_levels(p, image, px),
			most = p->texture_levels ? p->texture_levels[image] : 0;
		to[count++] = cut_of(image, most && most < levels ? most : levels);
		uint32_t outline = p->scene->lists[image].image;
		if (outline == ECO_NONE)
			continue;
		most = p->texture_levels ? p->texture_levels[outline] : 0;
		to[count++] = cut_of(outline, most ? most : p->scene->lists[outline].primitive_count);
	}
	return count;
}

enum eco_code lod_plan_textures(struct eco_plan *plan, const struct lod_planner *p, struct eco_error *error)
{
	uint32_t textured = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		textured += p->scene->lists[plan->cuts[i].list].image != ECO_NONE;
	if (!textured)
		return ECO_OK;
	size_t room = (size_t)plan->cut_count + 2 * (size_t)textured;
	struct eco_cut *cuts = realloc(plan->cuts, room * sizeof *cuts);
	if (!cuts)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for textures of %u cuts",
			plan->cut_count);
	plan->cuts = cuts;
	cuts += plan->cut_count;
	uint32_t count = cuts_of(plan, p, cuts);
	qsort(cuts, count, sizeof *cuts, by_list);
	for (uint32_t i = 0; i < count; i++)     /* of equal lists the last shows most */
		if (i + 1 == count || cuts[i + 1].list != cuts[i].list)
			plan->cuts[plan->cut_count++] = cuts[i];
	return ECO_OK;
}

/* ---- Levels of impostors ---- */

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
	return lod_seen_worth(&sample->seen, LOD_IMPOSTOR_SIZE);
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
			/ (fmax(price, LOD_IMPOSTOR_WORTH) * bytes));
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
