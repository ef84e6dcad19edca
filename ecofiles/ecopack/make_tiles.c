/* Tiles become tables and lists: instance lists in depth-first order, so that a run of them is a range of
 * ids; then summaries. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/pack_record.h"
#include "lod/build/summary.h"

/* ---- Instance lists ---- */

/* Plants of one leaf, in order: eco->places[items[0 .. count)]. */
struct stand {
	const struct make_eco *eco;
	uint32_t *items;
	uint32_t tile, count, group_first, group_count;      /* groups: of the scene's table */
};

/* Their list, and the same as a range of the scene's places. */
struct stand_list { struct eco_list list; struct eco_encoded encoded; struct eco_writer twin; };

#define HEIGHT_STEPS 512.0       /* of the smallest plant's height, at least */
#define TURN_STEP 32u            /* of 65536: a plant as wide as high moves by its height / 1304 at its rim */
#define SCALE_BITS 11

/* One grid for all. A plant at [0, 0, 0] stands there exactly. */
static void instance_grid(const struct make *m, const struct stand *stand, struct eco_list *list)
{
	double low[3], high[3], height = INFINITY, extent = 0;
	for (uint32_t k = 0; k < stand->count; k++) {
		const struct make_place *p = &stand->eco->places[stand->items[k]];
		height = fmin(height, p->scale * m->plants[p->plant].built.plant.height_m);
		for (int i = 0; i < 3; i++) {
			low[i] = k ? fmin(low[i], p->at[i]) : p->at[i];
			high[i] = k ? fmax(high[i], p->at[i]) : p->at[i];
			extent = fmax(extent, high[i] - low[i]);
		}
	}
	double step = lod_power_below(fmax(height / HEIGHT_STEPS, 1e-9));
	while (extent / step > 1 << 26)          /* half the limit of a chunk's values: origins are coarser */
		step *= 2;
	lod_grid_place(list, low, high, step);
}

static int32_t round_to(const struct eco_list *list, const double at[3], int axis)
{
	return (int32_t)floor((at[axis] - list->grid_origin[axis]) / list->grid_step[axis] + 0.5);
}

struct standing { uint32_t item, plant, cell[2]; };

static int by_plant_and_cell(const void *one, const void *two)
{
	const struct standing *a = one, *b = two;
	int cells = eco_order_cells(a->cell, b->cell, 2);
	return a->plant != b->plant ? ECO_RISES(a, b, ->plant) : cells ? cells : ECO_RISES(a, b, ->item);
}

/* Each plant's in the order in which places take fewest bits (chunk_columns.h). */
static void sort_stand(const struct stand *stand, const struct eco_list *list)
{
	struct standing *all = eco_alloc(stand->count, sizeof *all);
	int32_t low[2] = { INT32_MAX, INT32_MAX };
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t k = 0; k < stand->count; k++) {
			const struct make_place *p = &stand->eco->places[stand->items[k]];
			int32_t x = round_to(list, p->at, 0), y = round_to(list, p->at, 1);
			low[0] = x < low[0] ? x : low[0];
			low[1] = y < low[1] ? y : low[1];
			all[k] = (struct standing){ stand->items[k], p->plant,
				{ (uint32_t)(x - low[0]), (uint32_t)(y - low[1]) } };
		}
	qsort(all, stand->count, sizeof *all, by_plant_and_cell);
	for (uint32_t k = 0; k < stand->count; k++)
		stand->items[k] = all[k].item;
	free(all);
}

/* Turns and scales are as exact as places: off by less than a plant's height / 1024, half a pixel where it
 * fills a picture 512 pixels high (lod/EXPERIMENTS.md, Coarser grids). */
static int32_t turn_of(const struct make_place *place, const int32_t position[3])
{
	if (isnan(place->yaw_deg))
		return eco_place_turn(position);
	return (uint16_t)((eco_angle16_from_deg(place->yaw_deg) + TURN_STEP / 2) / TURN_STEP * TURN_STEP);
}

static int32_t round_scale(double scale)
{
	int exponent;
	double whole = scale * 65536;
	frexp(whole, &exponent);
	double step = ldexp(1, exponent > SCALE_BITS ? exponent - SCALE_BITS : 0);
	return (int32_t)(floor(whole / step + 0.5) * step);
}

/* Lists of plants in their models' proportions store no widths, those without a class no tints. */
static uint8_t attributes_of(const struct stand *stand)
{
	uint8_t attributes = ECO_ATTR_PLACE;
	for (uint32_t k = 0; k < stand->count; k++) {
		const struct make_place *p = &stand->eco->places[stand->items[k]];
		attributes |= (p->width ? ECO_ATTR_WIDTH : 0) | (p->tint ? ECO_ATTR_COLOR : 0);
	}
	return attributes;
}

static enum eco_code encode_stand(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	const struct make *m = ctx;
	const struct stand *stand = (const struct stand *)m->stands.items + i;
	struct stand_list *made = result;
	uint32_t count = stand->count, end_count = 0, ends[512];
	struct eco_elements e = { .element_count = count, .corner_count = count, .primitive_count = count,
		.corners = eco_alloc(count, 1), .position = eco_alloc(count, 3 * sizeof(int32_t)),
		.extra = eco_alloc(count, 4 * sizeof(int32_t)) };
	made->list = (struct eco_list){ .kind = ECO_LIST_INSTANCES, .coder = ECO_CODER_ROWS,
		.attributes = attributes_of(stand), .owner = stand->tile, .group_count = stand->group_count,
		.image = ECO_NONE, .partner = ECO_NONE };
	if (made->list.attributes & ECO_ATTR_COLOR) {
		made->list.palette_first = stand->eco->tint_first;
		made->list.palette_count = stand->eco->tints.class_count;
	}
	e.extra_count = eco_list_extra_count(&made->list);
	instance_grid(m, stand, &made->list);
	sort_stand(stand, &made->list);
	for (uint32_t k = 0; k < count; k++) {
		const struct make_place *p = &stand->eco->places[stand->items[k]];
		e.corners[k] = 1;
		for (size_t axis = 0; axis < 3; axis++)
			e.position[3 * (size_t)k + axis] = round_to(&made->list, p->at, (int)axis);
		int32_t *extra = e.extra + (size_t)k * e.extra_count;
		if (made->list.attributes & ECO_ATTR_COLOR)
			*extra++ = (int32_t)p->tint;
		if (made->list.attributes & ECO_ATTR_WIDTH)
			*extra++ = p->width;
		extra[0] = turn_of(p, e.position + 3 * (size_t)k);
		extra[1] = round_scale(p->scale);
		struct eco_place twin = eco_place_of(&made->list, &e, k);
		eco_record_write(&made->twin, ECO_SECTION_PLACES, &twin);
	}
	for (uint32_t end = 0; end < count && end_count < 512;)
		ends[end_count++] = end = count - end > ECO_CHUNK_ELEMENTS_MAX ? end + ECO_CHUNK_ELEMENTS_MAX
			: count;
	if (made->twin.failed)
		eco_end("no memory");
	enum eco_code code = eco_pack_encode(&made->encoded, &made->list, &e, ends, end_count, error);
	eco_elements_free(&e);
	return code;
}

static void add_rows(struct make *m, const struct stand *stand)
{
	const struct eco_source *source = &m->sources.items[stand->eco - m->ecos];
	for (uint32_t k = 0; k < stand->count; k++) {
		const struct make_place *p = &stand->eco->places[stand->items[k]];
		const char *species = m->species.items[p->species];
		struct eco_inventory_row row = {
			.species = strcmp(species, m->plants[p->plant].name) != 0 ? species : NULL,
			.file = p->file ? eco_path_last(source->positions[p->file - 1].path) : NULL,
			.row = p->row, .line = p->line };
		if (p->cells)
			memcpy(row.cells, (const char *(*)[ECO_INVENTORY_CELLS])m->cells.items + p->cells - 1, sizeof row.cells);
		make_inventory_add(m, p->plant, &row);
	}
}

static enum eco_code add_stand(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct make *m = ctx;
	const struct stand *stand = (const struct stand *)m->stands.items + i;
	struct stand_list *made = result;
	uint64_t place_first = m->places.count;
	(void)error;
	make_add(&m->places, made->twin.bytes, stand->count, ECO_PLACE_BYTES);
	if (i % 1024 == 0)
		main_progress("packing instances", NULL, (double)i / (double)m->stands.count);
	uint32_t list = make_add_encoded(m, &made->list, &made->encoded);
	add_rows(m, stand);
	struct eco_group *group = (struct eco_group *)m->groups.items + stand->group_first;
	for (uint32_t k = 0; k < stand->group_count; k++) {
		group[k].list = list;
		group[k].place_first = place_first + group[k].first;
	}
	return ECO_OK;
}

static void drop_stand(void *result)
{
	struct stand_list *made = result;
	eco_encoded_free(&made->encoded);
	eco_writer_free(&made->twin);
}

/* ---- Tables ---- */

static void add_child(struct make *m, const struct eco_child *child)
{
	make_add(&m->children, child, 1, sizeof *child);
}

static void add_nested(struct make *m, uint32_t source, const struct make_nested *item)
{
	const struct eco_source_child *child = &m->sources.items[source].children[item->child];
	m->scene.needs |= ECO_NEED_PLACEMENTS;
	add_child(m, &(struct eco_child){ .tile = m->ecos[child->source].tile_first, .placed = true,
		.at = { item->at[0], item->at[1], item->at[2] }, .turn = eco_angle16_from_deg(child->yaw_deg),
		.scale = (float)child->scale });
}

/* Adds the groups of a stand whose plants are known; add_stand says where they are. */
static void add_groups(struct make *m, struct stand *stand)
{
	const struct make_place *places = stand->eco->places;
	stand->group_first = (uint32_t)m->groups.count;
	for (uint32_t first = 0, end; first < stand->count; first = end) {
		uint32_t plant = places[stand->items[first]].plant;
		for (end = first + 1; end < stand->count && places[stand->items[end]].plant == plant; end++)
			;
		struct eco_group group = { .tile = stand->tile, .plant = plant, .list = ECO_NONE,
			.first = first, .count = end - first };
		make_add(&m->groups, &group, 1, sizeof group);
	}
	stand->group_count = (uint32_t)m->groups.count - stand->group_first;
}

/* A leaf's items are sorted by plant, nested eco files last. */
static void add_leaf(struct make *m, uint32_t source, const struct lod_tile_node *node, uint32_t id)
{
	const struct make_eco *eco = &m->ecos[source];
	struct stand stand = { .eco = eco, .items = eco->tiles.order + node->item_first, .tile = id };
	while (stand.count < node->item_count && stand.items[stand.count] < eco->place_count)
		stand.count++;
	add_groups(m, &stand);
	if (stand.count)
		make_add(&m->stands, &stand, 1, sizeof stand);
	for (uint32_t i = stand.count; i < node->item_count; i++)
		add_nested(m, source, &eco->nested[stand.items[i] - eco->place_count]);
}

static void add_tile(struct make *m, uint32_t source, uint32_t index)
{
	const struct make_eco *eco = &m->ecos[source];
	const struct lod_tile_node *node = &eco->tiles.nodes[index];
	uint32_t id = eco->tile_first + index;
	struct eco_tile *tile = make_append(&m->tiles, sizeof *tile);
	*tile = (struct eco_tile){ .summary = ECO_NONE, .group_first = (uint32_t)m->groups.count,
		.child_first = (uint32_t)m->children.count };
	memcpy(tile->low, node->low, sizeof tile->low);
	memcpy(tile->high, node->high, sizeof tile->high);
	for (uint32_t i = 0; i < node->child_count; i++)
		add_child(m, &(struct eco_child){ .tile = eco->tile_first + node->child[i], .scale = 1 });
	if (node->child_count == 0)
		add_leaf(m, source, node, id);
	tile = (struct eco_tile *)m->tiles.items + id;
	tile->group_count = (uint32_t)m->groups.count - tile->group_first;
	tile->child_count = (uint32_t)m->children.count - tile->child_first;
}

static void add_tint_colors(struct make *m, struct make_eco *eco)
{
	_Static_assert(ECO_TINTS_CLASSES_MAX <= ECO_LIST_TINTS_MAX, "lists have codes for all classes");
	uint8_t rgb[ECO_TINTS_CLASSES_MAX][3];
	for (uint32_t i = 0; i < eco->tints.class_count; i++)
		memcpy(rgb[i], eco->tints.classes[i].rgb, sizeof *rgb);
	if (eco->tints.class_count)
		eco->tint_first = make_add_colors(m, (const uint8_t (*)[3])rgb, eco->tints.class_count);
}

static void add_tiles(struct make *m)
{
	uint64_t total = 0;
	for (uint32_t s = 0; s < m->sources.count; s++) {
		m->ecos[s].tile_first = (uint32_t)total;
		total += m->ecos[s].tiles.node_count;
	}
	if (total >= ECO_NONE / 4)
		eco_stop(ECO_TOO_LARGE, "%llu tiles: allow more instances a tile, or nest eco files",
			(unsigned long long)total);
	for (uint32_t s = 0; s < m->sources.count; s++) {
		add_tint_colors(m, &m->ecos[s]);
		for (uint32_t i = 0; i < m->ecos[s].tiles.node_count; i++)
			add_tile(m, s, i);
	}
	eco_check(main_jobs_run(&(struct main_jobs){ .count = m->stands.count, .threads = make_threads(m),
		.result_size = sizeof(struct stand_list), .work = encode_stand, .take = add_stand,
		.drop = drop_stand, .ctx = m }, m->error));
}

void make_refer(struct make *m)
{
	struct eco_scene *s = &m->scene;
#define REFER(table, record) s->table = m->table.items, s->record##_count = (uint32_t)m->table.count;
	REFER(anchors, anchor) REFER(ladders, ladder) REFER(curves, curve) REFER(tiles, tile)
	REFER(groups, group) REFER(children, child) REFER(lists, list) REFER(palette, palette)
#undef REFER
	s->places = m->places.items;
	s->place_count = m->places.count;
}

void make_add_up(struct make *m, uint32_t tiles_end)
{
	const struct eco_scene *s = &m->scene;
	struct eco_tile *tiles = m->tiles.items;
	for (uint32_t id = tiles_end; id-- > 0;) {    /* children have greater ids */
		struct eco_tile *t = &tiles[id];
		for (uint32_t g = t->group_first; g < t->group_first + t->group_count; g++) {
			const struct eco_group *group = &s->groups[g];
			t->instance_count += group->count;
			for (uint32_t i = 0; i < group->count; i++) {
				struct eco_place place = eco_place_read(s, group->place_first + i);
				t->area += s->plants[group->plant].area * eco_place_area(&place);
			}
		}
		for (uint32_t c = t->child_first; c < t->child_first + t->child_count; c++) {
			const struct eco_child *child = &s->children[c];
			t->instance_count += tiles[child->tile].instance_count;
			t->area += tiles[child->tile].area * child->scale * child->scale;
		}
		t->area = (double)eco_few_bits((float)t->area);
	}
}

void make_tiles(struct make *m)
{
	main_times_stage(MAIN_STAGE_TILES);
	add_tiles(m);
	make_places_drop(m);             /* the scene's own tables have everything now */
	make_refer(m);
	make_add_up(m, m->scene.tile_count);
	main_times_stage(MAIN_STAGE_SUMMARIES);
	if (m->palette.count)
		make_summaries(m);
	make_refer(m);
}

/* ---- Summaries ---- */

/* Point summaries of tiles. Eco files are summed up from the innermost out; of a nested file only its
 * stored summary is used. So a summary's cost does not depend on what lies below, and linking (link.c)
 * sums up packs that were built apart in the same way. */

#define POOL_POINTS 2048u
#define SUMMARY_CHUNK 256u       /* a far tile asks for few points: small first chunks */

struct summary_list { struct eco_list list; struct eco_encoded encoded; bool any; };

static enum eco_code encode_summary(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	const struct make_summing *summing = ctx;
	const struct eco_scene *scene = &summing->m->scene;
	struct summary_list *made = result;
	struct lod_summary summary;
	struct eco_elements elements;
	uint32_t ends[64], tile = summing->first + (uint32_t)i;
	lod_summary_make(&summary, &(struct lod_summary_input){ .scene = scene,
		.pools = summing->pools, .tile = tile, .count = lod_summary_count(&scene->tiles[tile]),
		.seed = 1, .roots = (const struct lod_summary_root *const *)summing->roots,
		.color_of = summing->palette.color_of, .color_count = summing->palette.color_count });
	made->any = summary.count > 0;
	if (made->any)
		lod_summary_list(&summary, scene, tile, summing->palette.count, &made->list, &elements);
	free(summary.points);
	if (!made->any)
		return ECO_OK;
	enum eco_code code = eco_pack_encode(&made->encoded, &made->list, &elements, ends,
		eco_chunk_split(elements.element_count, SUMMARY_CHUNK, ends, 64), error);
	eco_elements_free(&elements);
	return code;
}

static enum eco_code add_summary(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct make_summing *summing = ctx;
	struct make *m = summing->m;
	struct summary_list *made = result;
	(void)error;
	if (summing->done++ % 64 == 0)
		main_progress("summing up tiles", NULL, (double)summing->done / (double)m->tiles.count);
	if (made->any) {
		made->list.palette_first = summing->palette_first;
		((struct eco_tile *)m->tiles.items)[summing->first + i].summary
			= make_add_encoded(m, &made->list, &made->encoded);
		m->scene.needs |= ECO_NEED_SUMMARIES;
		make_refer(m);           /* the lists may have moved */
	}
	return ECO_OK;
}

static void drop_summary(void *result) { eco_encoded_free(&((struct summary_list *)result)->encoded); }

void make_summing_begin(struct make_summing *summing, struct make *m)
{
	*summing = (struct make_summing){ .m = m, .roots = eco_alloc(m->tiles.count, sizeof *summing->roots) };
}

static void choose_colors(struct make_summing *summing, uint32_t first, uint32_t count)
{
	struct make *m = summing->m;
	struct lod_summary_palette *palette = &summing->palette;
	make_refer(m);
	free(palette->color_of);
	lod_summary_palette_make(palette, &(struct lod_summary_input){ .scene = &m->scene,
		.pools = summing->pools, .roots = (const struct lod_summary_root *const *)summing->roots }, first, count);
	summing->palette_first = make_add_colors(m, (const uint8_t (*)[3])palette->rgb, palette->count);
	make_refer(m);
}

void make_summing_run(struct make_summing *summing, uint32_t first, uint32_t count)
{
	summing->first = first;
	choose_colors(summing, first, count);
	eco_check(main_jobs_run(&(struct main_jobs){ .count = count, .threads = make_threads(summing->m),
		.result_size = sizeof(struct summary_list), .work = encode_summary, .take = add_summary,
		.drop = drop_summary, .ctx = summing }, summing->m->error));
}

void make_summing_keep(struct make_summing *summing, uint32_t tile)
{
	struct make *m = summing->m;
	uint32_t list = m->scene.tiles[tile].summary;
	if (list == ECO_NONE)
		return;
	struct lod_summary_root *root = summing->roots[tile] = eco_alloc(1, sizeof *root);
	root->list = m->scene.lists[list];
	eco_check(eco_pack_read_points(m->writer, list, &root->elements, m->error));
	const struct eco_elements *e = &root->elements;
	for (uint32_t i = 0; i < e->element_count; i++)
		if ((uint32_t)e->extra[(size_t)i * e->extra_count] >= root->list.palette_count)
			eco_stop(ECO_DAMAGED, "the summary of tile %u names a colour that is not there", tile);
}

void make_summing_end(struct make_summing *summing)
{
	for (uint32_t i = 0; summing->pools && i < summing->m->plant_count; i++)
		lod_pool_free(&summing->pools[i]);
	free(summing->pools);
	free(summing->palette.color_of);
	for (uint64_t i = 0; summing->roots && i < summing->m->tiles.count; i++) {
		if (summing->roots[i])
			eco_elements_free(&summing->roots[i]->elements);
		free(summing->roots[i]);
	}
	free(summing->roots);
}

void make_summaries(struct make *m)
{
	struct make_summing summing;
	make_summing_begin(&summing, m);
	summing.pools = eco_alloc(m->plant_count, sizeof *summing.pools);
	for (uint32_t i = 0; i < m->plant_count; i++)
		lod_pool_make(&summing.pools[i], &m->plants[i].built, m->plants[i].palette_first, POOL_POINTS);
	for (uint32_t s = m->sources.count, end = (uint32_t)m->tiles.count; s-- > 0; end = m->ecos[s].tile_first) {
		make_summing_run(&summing, m->ecos[s].tile_first, end - m->ecos[s].tile_first);
		if (s > 0)
			make_summing_keep(&summing, m->ecos[s].tile_first);
	}
	make_summing_end(&summing);
}
