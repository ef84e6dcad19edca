/* Prices of textures: see lod/plan/byte_price.h. Colours and outlines are prefixes of their own, so
 * levels of each are chosen apart: those of colours that save, over coarser texels, what their bytes cost,
 * and those of an outline that show as much less wrong. */

#include <math.h>
#include <stdlib.h>

#include "ecofiles/format/texture.h"
#include "lod/plan/byte_price.h"
#include "lod/plan/texture_levels.h"

/* Pixels that a texel of a ladder's texture is wide where a choice stands. */
static double texel_px(const struct lod_allocation *m, const struct ladder_price *l, uint32_t id)
{
	const struct lod_slot *slot = &m->p->visible.slots[m->ladder_choices[id].slot];
	return lod_texel_px(m->p, m->prices->images[l->image].list, slot->anchor, slot->band);
}

/* The most levels that some choice of a ladder resolves. */
static void count_levels(struct lod_allocation *m, const struct ladder_price *l)
{
	struct image_price *image = &m->prices->images[l->image];
	for (uint32_t i = 0; i < l->count; i++) {
		uint32_t levels = lod_texture_levels(m->p, image->list,
			texel_px(m, l, m->prices->choices[l->first + i]));
		image->most = levels > image->most ? levels : image->most;
	}
}

static double missing_levels(const struct lod_allocation *m, uint32_t list, uint32_t levels)
{
	return lod_prices_missing(m, list, 0, lod_plan_chunks_for(m->p->scene, list, levels));
}

static void set_levels(struct lod_allocation *m, struct image_price *image, uint32_t levels,
	uint32_t outline_levels)
{
	image->levels = levels;
	image->outline_levels = outline_levels;
	image->bytes = missing_levels(m, image->list, levels);
	m->p->texture_levels[image->list] = (uint8_t)levels;
	if (image->outline == ECO_NONE)
		return;
	image->bytes += missing_levels(m, image->outline, outline_levels);
	m->p->texture_levels[image->outline] = (uint8_t)outline_levels;
}

static uint32_t levels_of(const struct lod_allocation *m, uint32_t list)
{
	return list == ECO_NONE ? 0 : m->p->scene->lists[list].primitive_count;
}

static bool is_of_cell(const struct lod_allocation *m, const struct ladder_price *l)
{
	const struct eco_ladder *ladder = &m->p->scene->ladders[l->ladder];
	return ladder->anchor != m->p->scene->plants[ladder->plant].anchor_first;
}

/* A texture is asked of the ladders of whole plants that show it in equal parts, and of cells likewise. */
static void share_images(struct lod_allocation *m)
{
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		struct ladder_price *l = &m->prices->ladders[i];
		const struct image_price *image = &m->prices->images[l->textured == ECO_NONE ? 0 : l->image];
		l->image_part = l->textured == ECO_NONE ? 0 : image->bytes / image->users[is_of_cell(m, l)];
	}
}

bool lod_images_make(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	const struct eco_scene *scene = m->p->scene;
	prices->images = lod_arena_try(&prices->memory, prices->ladder_count, sizeof *prices->images);
	uint32_t *of = lod_arena_try(&prices->memory, scene->list_count, sizeof *of);
	if (!m->p->texture_levels)
		m->p->texture_levels = calloc(scene->list_count + 1u, 1);
	if (prices->memory.failed || !m->p->texture_levels)
		return false;
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		struct ladder_price *l = &prices->ladders[i];
		const uint32_t list = l->image;
		if (l->textured == ECO_NONE)
			continue;
		if (!of[list]) {
			of[list] = ++prices->image_count;
			prices->images[of[list] - 1] = (struct image_price){ .list = list,
				.outline = scene->lists[list].image, .plant = scene->ladders[l->ladder].plant };
		}
		l->image = of[list] - 1;
		prices->images[l->image].users[is_of_cell(m, l)]++;
		count_levels(m, l);
	}
	for (uint32_t i = 0; i < prices->image_count; i++)
		set_levels(m, &prices->images[i], prices->images[i].most, levels_of(m, prices->images[i].outline));
	share_images(m);
	return true;
}

static bool shows(const struct ladder_price *l, uint32_t image)
{
	return l->textured != ECO_NONE && l->image == image;
}

/* Pixels of plants that are drawn as a whole in place of a choice. */
static double whole_pixels(const struct lod_allocation *m, uint32_t id)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[id];
	const struct lod_slot_choice *slot_choice = &m->slot_choices[choice->slot];
	if (slot_choice->whole == ECO_NONE || choice->when == LOD_NEAR)
		return 0;
	return m->uses.seen[choice->slot] * choice->weight_px
		* lod_prices_share(m, slot_choice->whole, false);
}

/* Adds, for each number of levels, what plants that draw a ladder lose by seeing no more of its texture. Sets
 * what is lost where it does not show: elements of one colour are as texels an octave wider than those of the
 * first level. */
static void add_texel_costs(const struct lod_allocation *m, struct ladder_price *l, double *costs)
{
	const struct image_price *image = &m->prices->images[l->image];
	uint32_t levels = m->p->scene->lists[image->list].primitive_count;
	l->seen_px = l->whole_lost = l->bare_lost = 0;
	for (uint32_t i = 0; i < l->count; i++) {
		uint32_t id = m->prices->choices[l->first + i];
		double seen = lod_prices_seen(m, id), px = texel_px(m, l, id),
			bare = lod_texel_loss(px, levels) - lod_texel_loss(px, levels - image->most);
		for (uint32_t n = levels; n > 0 && seen > 0; n--)
			costs[n] += seen * lod_texel_loss(px, levels - n);
		l->seen_px += seen;
		l->bare_lost += seen * bare;
		l->whole_lost += whole_pixels(m, id) * bare;
	}
	l->bare_lost = l->seen_px > 0 ? l->bare_lost / l->seen_px : 0;
}

/* Levels of a list, up to `most`, that are worth their bytes; ties: the most. costs[n]: wrong pixels with n of them. */
static uint32_t best_levels(const struct lod_allocation *m, uint32_t list, uint32_t most, const double *costs, double price)
{
	uint32_t best = most;
	double least = INFINITY;
	for (uint32_t n = most; n > 0; n--) {
		double cost = costs[n] + price * missing_levels(m, list, n);
		best = cost < least ? n : best;
		least = fmin(least, cost);
	}
	return best;
}

/* Sets levels of a texture, all where no plant draws it, and for ladders that show it what is lost of each pixel. */
static void limit_texture(struct lod_allocation *m, uint32_t i)
{
	struct lod_prices *prices = m->prices;
	struct image_price *image = &prices->images[i];
	uint32_t best = image->most, all = levels_of(m, image->outline), border = all;
	double costs[ECO_TEXTURE_LEVELS_MAX + 1] = { 0 }, borders[ECO_TEXTURE_LEVELS_MAX + 1] = { 0 }, pixels = 0;
	for (uint32_t k = 0; k < prices->ladder_count; k++)
		if (shows(&prices->ladders[k], i)) {
			add_texel_costs(m, &prices->ladders[k], costs);
			pixels += prices->ladders[k].seen_px;
		}
	if (pixels > 0) {
		for (uint32_t n = 1; n <= all; n++)
			borders[n] = pixels * lod_outline_loss(m->p, image->outline, n);
		best = best_levels(m, image->list, image->most, costs, image->price);
		border = best_levels(m, image->outline, all, borders, image->price);
	}
	set_levels(m, image, best, border);
	for (uint32_t k = 0; k < prices->ladder_count; k++)
		if (shows(&prices->ladders[k], i))
			prices->ladders[k].image_lost = pixels > 0
				? (borders[border] + costs[best] - costs[image->most]) / pixels : 0;
}

void lod_images_limit(struct lod_allocation *m)
{
	static const double times[LOD_KINDS_LEVELS] = LOD_KIND_TEXTURES;
	for (uint32_t i = 0; i < m->prices->image_count; i++) {
		m->prices->images[i].price = m->price * (m->limited ? times[m->prices->images[i].level] : 1);
		limit_texture(m, i);
	}
	share_images(m);
}
