/* Rows of inventories on their way into the pack: a block is coded as soon as it is full, so that only one is
 * held as rows. */
#include "ecofiles/base/memory.h"
#include "ecofiles/base/version.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/places/crs.h"
#include "lod/build/grid.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Species ---- */

/* The species that each plant of the pack stands for, and how many plants of the scene have each: for a
 * legend, which cannot look at every plant. A nested file counts once. */

#define SAID_MOST 32u    /* species of a plant that META names */
#define PLANT_DIGITS 8u

struct make_species {
	struct eco_string_pool pairs; /* plant, as hexadecimal digits, and species */
	uint64_t *counts;
	uint32_t count_room;
	uint32_t plant, pair;   /* counted last */
};

static const char *species_of(const struct make_species *s, uint32_t pair)
{
	return s->pairs.items[pair] + PLANT_DIGITS;
}

/* The pair's number. */
static uint32_t find_pair(struct make_species *s, uint32_t plant, const char *species)
{
	char key[PLANT_DIGITS + ECO_INVENTORY_NAME_MAX + 1];
	snprintf(key, sizeof key, "%08x%.*s", plant, (int)ECO_INVENTORY_NAME_MAX, species);
	uint32_t before = s->pairs.count, pair = eco_string_number(&s->pairs, key);
	eco_grow(&s->counts, &s->count_room, pair, sizeof *s->counts);
	if (pair == before)
		s->counts[pair] = 0;
	return pair;
}

static void count_species(struct make_species *s, uint32_t plant, const char *species)
{
	if (!s->pairs.count || plant != s->plant || strcmp(species_of(s, s->pair), species) != 0)
		s->pair = find_pair(s, plant, species);
	s->plant = plant;
	s->counts[s->pair]++;
}

/* By plant; of a plant, the commonest first. */
static int by_most(const void *a, const void *b, void *ctx)
{
	const struct make_species *s = ctx;
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	int plants = memcmp(s->pairs.items[x], s->pairs.items[y], PLANT_DIGITS);
	if (plants)
		return plants;
	if (s->counts[x] != s->counts[y])
		return s->counts[x] > s->counts[y] ? -1 : 1;
	return strcmp(species_of(s, x), species_of(s, y));
}

/* {"of": number of species, "most": [[name, or null where rows state none, plants], ...]} */
static json_t *said_of(const struct make_species *s, const uint32_t *pairs, uint32_t count)
{
	json_t *most = json_array();
	for (uint32_t i = 0; i < count && i < SAID_MOST; i++) {
		const char *name = species_of(s, pairs[i]);
		bool is_stated = strcmp(name, ECO_INVENTORY_UNSTATED) != 0;
		json_array_append_new(most,
			json_pack("[s?, I]", is_stated ? name : NULL, (json_int_t)s->counts[pairs[i]]));
	}
	return json_pack("{s:I, s:o}", "of", (json_int_t)count, "most", most);
}

/* ---- Rows ---- */

struct make_inventory {
	struct make_species species_of;
	struct eco_inventory_row rows[ECO_INVENTORY_PLACES];
	uint32_t count;
	struct eco_bytes *blocks;
	uint32_t block_count, block_room;
	struct eco_string_pool names;
	uint32_t species, file, cells[ECO_INVENTORY_CELLS]; /* those of the row before */
	bool is_needed;         /* something is to be said of a plant */
};

void make_species_say(const struct make *m, json_t *plants)
{
	const struct make_species *s = m->inventory ? &m->inventory->species_of : NULL;
	uint32_t count = s ? s->pairs.count : 0, *order = eco_alloc(count, sizeof *order);
	for (uint32_t i = 0; i < count; i++)
		order[i] = i;
	qsort_r(order, count, sizeof *order, by_most, (void *)s);
	for (uint32_t i = 0, end; i < count; i = end) {
		char plant[PLANT_DIGITS + 1] = "";
		memcpy(plant, s->pairs.items[order[i]], PLANT_DIGITS);
		for (end = i + 1; end < count && memcmp(s->pairs.items[order[end]], plant, PLANT_DIGITS) == 0;)
			end++;
		json_object_set_new(json_array_get(plants, strtoul(plant, NULL, 16)), "species",
			said_of(s, order + i, end - i));
	}
	free(order);
}

/* The kept name that equals `name`, or NULL; *number: of a kept one that it often is. */
static const char *keep_name(struct eco_string_pool *names, const char *name, uint32_t *number)
{
	if (name && !(*number < names->count && strcmp(names->items[*number], name) == 0))
		*number = eco_string_number(names, name);
	return name ? names->items[*number] : NULL;
}

static void close_block(struct make_inventory *in)
{
	eco_grow(&in->blocks, &in->block_room, in->block_count, sizeof *in->blocks);
	in->blocks[in->block_count++] = eco_inventory_encode(in->rows, in->count);
	in->count = 0;
}

void make_inventory_add(struct make *m, uint32_t plant, const struct eco_inventory_row *row)
{
	struct make_inventory *in = m->inventory;
	if (!in)
		in = m->inventory = eco_alloc(1, sizeof *in);
	struct eco_inventory_row *kept = &in->rows[in->count];
	*kept = *row;
	kept->species = keep_name(&in->names, row->species, &in->species);
	kept->file = keep_name(&in->names, row->file, &in->file);
	in->is_needed = in->is_needed || kept->species || kept->file;
	for (uint32_t i = 0; i < ECO_INVENTORY_CELLS; i++) {
		kept->cells[i] = keep_name(&in->names, row->cells[i], &in->cells[i]);
		in->is_needed = in->is_needed || kept->cells[i];
	}
	count_species(&in->species_of, plant, row->species ? row->species : m->table[plant].name);
	if (++in->count == ECO_INVENTORY_PLACES)
		close_block(in);
}

void make_inventory_pack(struct make *m)
{
	struct make_inventory *in = m->inventory;
	const struct eco_list list = { .kind = ECO_LIST_INVENTORY, .coder = ECO_CODER_BYTES, .owner = ECO_NONE,
		.grid_step = { 1, 1, 1 }, .image = ECO_NONE, .partner = ECO_NONE };
	if (!in || !in->is_needed)
		return;
	if (in->count)
		close_block(in);
	make_add_bytes(m, &list, in->blocks, in->block_count);
}

void make_inventory_free(struct make *m)
{
	struct make_inventory *in = m->inventory;
	if (!in)
		return;
	for (uint32_t i = 0; i < in->block_count; i++)
		free(in->blocks[i].at);
	free(in->blocks);
	eco_string_pool_free(&in->names);
	eco_string_pool_free(&in->species_of.pairs);
	free(in->species_of.counts);
	free(in);
	m->inventory = NULL;
}

/* ---- META ---- */

/* META: facts for people and `ecopack info` that the tables do not have, such as the models' files and
 * dropped triangles by reason. */

static json_t *dropped_json(const struct make_plant *plant)
{
	json_t *reasons = json_object();
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		if (plant->built.dropped[i])
			json_object_set_new(reasons, eco_drop_names[i], json_integer(plant->built.dropped[i]));
	return reasons;
}

static json_t *organs_json(const struct make_plant *plant)
{
	json_t *organs = json_object();
	for (int i = 0; i < ECO_ORGAN_COUNT; i++) {
		const struct lod_organ_stats *s = &plant->built.organ[i];
		if (s->triangles == 0 && s->elements == 0)
			continue;
		json_object_set_new(organs, eco_organ_names[i],
			json_pack("{s:I, s:I, s:I, s:f}", "components", (json_int_t)s->components,
			"elements", (json_int_t)s->elements, "triangles", (json_int_t)s->triangles, "area_m2",
			floor(s->area * 1e6 + 0.5) / 1e6));
	}
	return organs;
}

/* Bits of the plant's largest extent on its finest grid. */
static uint32_t grid_bits(const struct make_plant *plant)
{
	double extent = fmax(2 * plant->reach, plant->high - plant->low), step = extent;
	uint32_t bits = 0;
	for (uint32_t i = 0; i < plant->built.list_count; i++)
		for (int axis = 0; axis < 3; axis++)
			step = fmin(step, plant->built.lists[i].list.grid_step[axis]);
	while (bits < 31 && ldexp(step, (int)bits) < extent)
		bits++;
	return bits;
}

/* The distance beyond which rounding to grids moves nothing by more than half a pixel. */
static double half_a_pixel_m(const struct lod_plant *plant)
{
	double most = 0;
	for (uint32_t i = 0; i < plant->list_count; i++)
		if (plant->lists[i].list.kind == ECO_LIST_TRIANGLES || plant->lists[i].list.kind
				== ECO_LIST_LINES)
			most = fmax(most, lod_grid_nearest_m(&plant->lists[i].list, LOD_GRID_PIXEL_RAD));
	return most;
}

/* The number of a plant's searches that converged before their bound. */
static json_t *searches_json(const struct lod_plant *plant)
{
	json_t *searches = json_object();
	for (int i = 0; i < LOD_SOLVER_COUNT; i++)
		if (plant->solved[i].runs)
			json_object_set_new(searches, lod_solver_names[i],
				json_pack("{s:I, s:I}", "runs", (json_int_t)plant->solved[i].runs,
				"converged", (json_int_t)plant->solved[i].converged));
	return searches;
}

static json_t *plant_json(const struct make_plant *plant)
{
	return json_pack("{s:s, s:s, s:f, s:I, s:I, s:o, s:o, s:I, s:f, s:o, s:[f,f,f], s:f, s:o*}", "name",
		plant->name, "model", basename(plant->path),
		"height_m", floor((double)plant->built.plant.height_m * 1e4 + 0.5) / 1e4, "triangles_in",
		(json_int_t)plant->built.triangles_in,
		"triangles_stored", (json_int_t)plant->built.triangles_stored, "dropped", dropped_json(plant),
		"organs", organs_json(plant),
		"grid_bits", (json_int_t)grid_bits(plant), "half_a_pixel_m",
		floor(half_a_pixel_m(&plant->built) * 1e4 + 0.5) / 1e4,
		"searches", searches_json(&plant->built), "foot", plant->foot[0], plant->foot[1],
		plant->foot[2], "scale", plant->scale, "object",
		plant->block || plant->source->object ? json_true() : NULL);
}

static json_t *rows_json(const struct make *m)
{
	json_t *skipped = json_object();
	uint64_t rows = 0;
	for (int k = 0; k < ECO_SKIP_COUNT; k++) {
		uint64_t count = 0;
		for (uint32_t s = 0; s < m->sources.count; s++)
			count += m->ecos[s].skipped[k].count;
		if (count)
			json_object_set_new(skipped, eco_skip_name(k), json_integer((json_int_t)count));
	}
	for (uint32_t s = 0; s < m->sources.count; s++)
		rows += m->ecos[s].rows;
	return json_pack("{s:I, s:o}", "read", (json_int_t)rows, "skipped", skipped);
}

const char *make_ground_origin(const struct make *m)
{
	return m->ground_through ? MAKE_GROUND_THROUGH : m->has_ground ? "rasters" : "none";
}

/* The origin's place on Earth; null without a CRS that PROJ knows. */
static json_t *place_json(const struct eco_source *outer)
{
	struct eco_crs_place place;
	struct eco_error unknown = { 0 };
	enum eco_code code = outer->crs ? eco_crs_place(outer->crs, outer->origin, &place, &unknown) : ECO_NOT_FOUND;
	if (code == ECO_NO_MEMORY)
		eco_end("no memory");
	if (code)
		return json_null();
	return json_pack("{s:f, s:f, s:f}", "longitude_deg", place.longitude_deg, "latitude_deg",
		place.latitude_deg, "convergence_deg", place.convergence_deg);
}

void make_columns_say(const struct make *m, json_t *meta)
{
	json_t *columns = json_array();
	for (uint32_t i = 0; i < m->columns.count; i++)
		json_array_append_new(columns, json_string(m->columns.items[i]));
	if (m->columns.count)
		json_object_set(meta, "columns", columns);
	json_decref(columns);
}

void make_tint_say(json_t *meta, const char *column, const char *name, json_t *color, uint64_t plants)
{
	json_t *tints = json_object_get(meta, "tints"), *tint = NULL, *class = NULL;
	size_t i;
	if (!tints)
		json_object_set_new(meta, "tints", tints = json_array());
	json_array_foreach(tints, i, tint)
		if (strcmp(json_string_value(json_object_get(tint, "column")), column) == 0)
			break;
	if (i == json_array_size(tints))
		json_array_append_new(tints, tint = json_pack("{s:s, s:[]}", "column", column, "classes"));
	json_t *classes = json_object_get(tint, "classes");
	json_array_foreach(classes, i, class)
		if (strcmp(json_string_value(json_object_get(class, "name")), name) == 0
				&& json_equal(json_object_get(class, "color"), color))
			break;
	if (i == json_array_size(classes))
		json_array_append_new(classes, class = json_pack("{s:s, s:O, s:I}", "name", name, "color", color, "plants",
			(json_int_t)0));
	json_object_set_new(class, "plants",
		json_integer(json_integer_value(json_object_get(class, "plants")) + (json_int_t)plants));
	json_decref(color);
}

static void say_tints(const struct make *m, json_t *meta)
{
	for (uint32_t s = 0; s < m->sources.count; s++)
		for (uint32_t i = 0; i < m->ecos[s].tints.class_count; i++) {
			const struct eco_tint_legend *c = &m->ecos[s].tints.classes[i];
			make_tint_say(meta, c->column, c->name, c->own ? json_null()
				: json_sprintf("#%02x%02x%02x", c->rgb[0], c->rgb[1], c->rgb[2]), c->plants);
		}
}

/* "drawn": as "tints", the classes that are drawn on the ground and the numbers of their features. */
static void say_drawn(const struct make *m, json_t *meta)
{
	json_t *classes = json_array();
	const char *name;
	uint8_t rgb[3];
	uint64_t features;
	for (uint32_t i = 0; eco_drawing_class(m->drawing, i, &name, rgb, &features); i++)
		if (features)
			json_array_append_new(classes, json_pack("{s:s, s:o, s:I}", "name", name, "color", json_sprintf("#%02x%02x%02x", rgb[0],
				rgb[1], rgb[2]), "features", (json_int_t)features));
	if (json_array_size(classes))
		json_object_set(meta, "drawn", classes);
	json_decref(classes);
}

json_t *make_meta(const struct make *m)
{
	const struct eco_source *outer = &m->sources.items[0];
	json_t *plants = json_array(), *root;
	for (uint32_t i = 0; i < m->plant_count; i++)
		json_array_append_new(plants, plant_json(&m->plants[i]));
	make_species_say(m, plants);
	root = json_pack("{s:s, s:s, s:s, s:o, s:[f,f,f], s:o, s:I, s:I, s:I, s:s, s:I, s:o, s:o}",
		"generator",
		"ecopack " ECO_VERSION, "order", lod_order_names[m->options->order], "name", outer->name,
		"crs", outer->crs ? json_string(outer->crs) : json_null(), "origin", outer->origin[0],
		outer->origin[1], outer->origin[2], "place", place_json(outer), "eco_files",
		(json_int_t)m->sources.count, "instances",
		(json_int_t)m->ecos[0].instances, "tiles", (json_int_t)m->scene.tile_count, "ground",
		make_ground_origin(m), "off_ground", (json_int_t)m->off_ground, "rows", rows_json(m),
		"plants", plants);
	say_tints(m, root);
	say_drawn(m, root);
	make_columns_say(m, root);
	if (m->options->draft)
		json_object_set_new(root, "draft", json_true());
	if (outer->date)
		json_object_set_new(root, "date", json_string(outer->date));
	if (m->options->season_given)
		json_object_set_new(root, "season", json_string(eco_season_names[m->options->season]));
	return root;
}
