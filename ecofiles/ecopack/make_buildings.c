/* Footprints of the scene files, put on the ground and gathered in blocks: leaves of a quadtree over their
 * corners. A block is a plant of the pack with one instance. One for each building would be as many curves
 * and ladders as buildings; one for a quarter would hide all behind it or nothing. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/run.h"

#define BLOCK_CORNERS 256u /* of a block's footprints: some 20 to 40 houses, 1,000 triangles */
#define NAME "buildings"

static void note(void *ctx, const char *text)
{
	main_note("%s: %s", (const char *)ctx, text);
}

/* The least ground below a building's corners; only the outermost file has ground. */
static double least_ground(const struct make *m, uint32_t source, const struct eco_building *building)
{
	double least = INFINITY, z;
	for (uint32_t i = 0; i < building->edge_count && source == 0 && m->has_ground; i++) {
		z = 0;
		eco_ground_height(&m->ground, building->edges[i].a[0], building->edges[i].a[1], &z);
		least = fmin(least, z);
	}
	return isfinite(least) ? least : 0;
}

static void add_block(struct make *m, uint32_t source, const struct make_footprints *own,
	const uint32_t *order, uint32_t count)
{
	struct make_block *block = make_append(&m->blocks, sizeof *block);
	*block = (struct make_block){ .source = source,
		.at = { 0, 0, INFINITY },
		.count = count,
		.buildings = eco_alloc(count, sizeof *block->buildings) };
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_building *b = &own->buildings[order[i]];
		block->buildings[i] = *b;
		block->at[2] = fmin(block->at[2], b->base_m);
		for (uint32_t e = 0; e < b->edge_count; e++)
			for (int k = 0; k < 2; k++) {
				low[k] = fmin(low[k], b->edges[e].a[k]);
				high[k] = fmax(high[k], b->edges[e].a[k]);
			}
	}
	for (int k = 0; k < 2; k++)
		block->at[k] = floor((low[k] + high[k]) / 2 + 0.5);
}

/* Divides the buildings of a source by their places. */
static void divide(struct make *m, uint32_t source, const struct make_footprints *own)
{
	struct lod_tiles tiles;
	struct lod_tile_item *items = eco_alloc(own->count, sizeof *items);
	for (uint32_t i = 0; i < own->count; i++) {
		const struct eco_building *b = &own->buildings[i];
		items[i].weight = b->edge_count;
		for (uint32_t e = 0; e < b->edge_count; e++)
			for (int k = 0; k < 2; k++)
				items[i].at[k] += b->edges[e].a[k] / b->edge_count;
	}
	lod_tiles_build(&tiles, items, own->count, BLOCK_CORNERS);
	for (uint32_t i = 0; i < tiles.node_count; i++)
		if (tiles.nodes[i].child_count == 0 && tiles.nodes[i].item_count)
			add_block(m, source, own, tiles.order + tiles.nodes[i].item_first,
				tiles.nodes[i].item_count);
	lod_tiles_free(&tiles);
	free(items);
}

static void take(struct make *m, uint32_t source, const struct eco_footprints *f, struct make_footprints *own)
{
	own->buildings = eco_alloc(f->areas.count, sizeof *own->buildings);
	for (uint32_t i = 0; i < f->areas.count; i++) {
		const struct eco_area *area = &f->areas.items[i];
		struct eco_building *b = &own->buildings[own->count++];
		*b = (struct eco_building){ .edges = f->areas.edges + area->edge_first,
			.edge_count = area->ring_edges,
			.height_m = f->items[i].height_m,
			.to_eaves = f->items[i].to_eaves,
			.roof = f->items[i].roof };
		if (eco_building_stands(b))
			b->base_m = least_ground(m, source, b);
		else {
			own->count--;
			own->lost++;
		}
	}
}

/* Those that stand upon another are left out. */
static void cover(struct make *m, uint64_t first)
{
	struct make_footprints *all = (struct make_footprints *)m->footprints.items;
	uint32_t total = 0, twins = 0;
	char count[32];
	for (uint64_t i = first; i < m->footprints.count; i++)
		total += all[i].count;
	struct eco_building **buildings = eco_alloc(total, sizeof *buildings);
	total = 0;
	for (uint64_t i = first; i < m->footprints.count; i++)
		for (uint32_t k = 0; k < all[i].count; k++)
			buildings[total++] = &all[i].buildings[k];
	eco_buildings_cover(buildings, total);
	free(buildings);
	for (uint64_t i = first; i < m->footprints.count; i++) {
		uint32_t kept = 0;
		for (uint32_t k = 0; k < all[i].count; k++) {
			struct eco_building *b = &all[i].buildings[k];
			if (!b->twin)
				all[i].buildings[kept++] = *b;
			else
				free(b->covers);
		}
		twins += all[i].count - kept;
		all[i].count = kept;
	}
	if (twins)
		main_note("footprints left out, as others, as high, stand on the same: %s", eco_phrase_count(twins, count));
}

void make_buildings_read(struct make *m)
{
	for (uint32_t s = 0; s < m->sources.count; s++) {
		struct eco_source *source = &m->sources.items[s];
		struct eco_frame frame = eco_source_frame(source);
		const uint64_t first = m->footprints.count;
		for (uint32_t i = 0; i < source->footprints_count; i++) {
			struct make_footprints *own = make_append(&m->footprints, sizeof *own);
			*own = (struct make_footprints){ .count = 0 };
			main_progress("reading footprints", source->footprints[i].path, 0);
			eco_check(eco_footprints_read(&own->footprints, &source->footprints[i], &frame,
				m->error));
			eco_footprints_report(&own->footprints, note, source->footprints[i].path);
			take(m, s, &own->footprints, own);
		}
		if (m->footprints.count > first)
			cover(m, first);
		for (uint64_t i = first; i < m->footprints.count; i++)
			divide(m, s, (struct make_footprints *)m->footprints.items + i);
	}
}

void make_buildings_plant(struct make *m, uint32_t number, struct make_plant *plant)
{
	static const struct eco_source_plant buildings = { .name = NAME, .variant_count = 1 };
	struct make_block *block = (struct make_block *)m->blocks.items + number;
	*plant = (struct make_plant){ .source = &buildings,
		.block = block,
		.path = eco_copy_text(""),
		.importance = m->sources.items[block->source].importance };
	snprintf(plant->name, sizeof plant->name, NAME "-%u", number + 1);
	block->plant = (uint32_t)(plant - m->plants);
}

void make_buildings_model(struct make_plant *plant, struct eco_model *model)
{
	struct make_block *block = plant->block;
	eco_buildings_make(model, block->buildings, block->count, block->at, &block->notes);
}

void make_buildings_place(struct make *m, uint32_t source)
{
	for (uint64_t i = 0; i < m->blocks.count; i++) {
		const struct make_block *block = (const struct make_block *)m->blocks.items + i;
		if (block->source != source)
			continue;
		struct make_place place = { .plant = block->plant,
			.at = { block->at[0], block->at[1], block->at[2] },
			.scale = 1,
			.species = eco_string_number(&m->species, NAME) };
		make_place_add(m, source, &place);
	}
}

void make_buildings_say(const struct make *m)
{
	struct eco_buildings_notes all = { 0 };
	char count[32];
	for (uint64_t i = 0; i < m->blocks.count; i++) {
		const struct eco_buildings_notes *own =
			&((const struct make_block *)m->blocks.items)[i].notes;
		all.crossed += own->crossed;
		all.nothing += own->nothing;
		all.flat += own->flat;
	}
	for (uint64_t i = 0; i < m->footprints.count; i++)
		all.nothing += ((const struct make_footprints *)m->footprints.items)[i].lost;
	if (all.crossed)
		main_note("%s footprints cross or touch themselves, and were cut there",
			eco_phrase_count(all.crossed, count));
	if (all.nothing)
		main_note(
			"%s footprints are left out: without a surface, wider than %g m, or of more than %u corners",
			eco_phrase_count(all.nothing, count), ECO_BUILDING_WIDE_M, ECO_BUILDING_CORNERS_MAX);
	if (all.flat)
		main_note("%s roofs are flat: a pitched one does not fit a footprint with holes",
			eco_phrase_count(all.flat, count));
}

void make_buildings_free(struct make *m)
{
	for (uint64_t i = 0; i < m->blocks.count; i++)
		free(((struct make_block *)m->blocks.items)[i].buildings);
	for (uint64_t i = 0; i < m->footprints.count; i++) {
		struct make_footprints *own = (struct make_footprints *)m->footprints.items + i;
		eco_footprints_free(&own->footprints);
		for (uint32_t k = 0; k < own->count; k++)
			free(own->buildings[k].covers);
		free(own->buildings);
	}
	free(m->blocks.items);
	free(m->footprints.items);
}
