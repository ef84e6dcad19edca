/* Places of plants: instances of the scene files and rows of inventories, put on the ground and scaled to
 * their heights. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"
#include "ecofiles/import/places/size_units.h"

#define SCALE_LEAST (1.0 / 4096)
#define SCALE_MOST 4000.0           /* a chunk's values must hold it in 1/65536 */
#define PLACES_MAX 500000000u
/* a nested eco file counts as one plant for each 16 when tiles are split, ... */
#define NESTED_PLANTS 16u
#define NESTED_MOST 32u          /* ... up to 32: opening a tile opens everything that it places */

void make_place_add(struct make *m, uint32_t source, const struct make_place *place)
{
	struct make_eco *eco = &m->ecos[source];
	if (!(place->scale >= SCALE_LEAST && place->scale <= SCALE_MOST))
		eco_stop(ECO_BAD_INPUT, "%s at [%g, %g]: it would be scaled by %g; heights must be within 1/4096 and 4000 "
			"times the model's %g m (is the model's unit metres?)", m->plants[place->plant].name,
			place->at[0], place->at[1], place->scale,
			(double)m->plants[place->plant].built.plant.height_m);
	if (eco->place_count == PLACES_MAX)
		eco_stop(ECO_TOO_LARGE, "no room for more than %u plants in one eco file; nest eco files instead",
			PLACES_MAX);
	eco_grow(&eco->places, &eco->place_capacity, eco->place_count, sizeof *eco->places);
	eco->places[eco->place_count++] = *place;
}

static void count_off_ground(struct make *m, const double at[3])
{
	const struct eco_ground *g = &m->ground;
	const double width = g->step_x_m * (g->columns - 1 - 2 * g->margin),
		height = g->step_y_m * (g->rows - 1 - 2 * g->margin);
	const double beyond[MAKE_SIDES] = { g->x_m - at[0], at[0] - g->x_m - width, g->y_m - at[1],
		at[1] - g->y_m - height };
	m->off_ground++;
	for (int side = 0; side < MAKE_SIDES; side++) {
		m->off_side[side] += beyond[side] > 0;
		m->off_ground_m = fmax(m->off_ground_m, beyond[side]);
	}
}

static double on_ground(struct make *m, uint32_t source, const double at[3])
{
	double z = 0;
	if (source == 0 && m->has_ground && !eco_ground_height(&m->ground, at[0], at[1], &z))
		count_off_ground(m, at);
	return at[2] + z;
}

/* height_m NaN: no height was given. */
static double scale_for(const struct make *m, uint32_t plant, double scale, double height_m)
{
	return isnan(height_m) ? scale : scale * height_m / m->plants[plant].built.plant.height_m;
}

/* A place's species: as its row states it, else (NULL: no row, or no column for it) as the scene file names
 * the plant. */
static uint32_t species_of(struct make *m, uint32_t source, uint32_t plant, const char *stated)
{
	return eco_string_number(&m->species, !stated || m->options->no_rows ? m->sources.items[source].plants[plant].name
		: *stated ? stated : ECO_INVENTORY_UNSTATED);
}

static bool is_of_library(const struct make *m, uint32_t source, uint32_t plant)
{
	return m->sources.items[source].plants[plant].model_count == 0;
}

static double times(double a, double b) { return fmax(a / b, b / a); }

/* The size of a library's plant with the nearest height and, where radius_m is known, proportions, in the
 * individual that the hash took. */
static uint32_t fitting_size(const struct make *m, uint32_t source, uint32_t plant, double height_m, double radius_m)
{
	const struct eco_source_plant *plants = m->sources.items[source].plants;
	uint32_t first = plant - plants[plant].variant, count = plants[first].variant_count, best = plant;
	double least = INFINITY;
	for (uint32_t i = first; i < first + count && !isnan(height_m); i++) {
		const struct eco_library_plant *l = &plants[i].library;
		if (l->individual != plants[plant].library.individual)
			continue;
		double off = times(l->height_m, height_m), own = m->plants[m->plant_of[source][i]].crown / l->height_m;
		if (!isnan(radius_m))
			off *= times(own, radius_m / height_m);
		if (off < least) {
			least = off;
			best = i;
		}
	}
	return m->plant_of[source][best];
}

static uint32_t plant_of_size(const struct make *m, uint32_t source, uint32_t plant, double height_m)
{
	return is_of_library(m, source, plant) ? fitting_size(m, source, plant, height_m, NAN) : m->plant_of[source][plant];
}

static void place_instances(struct make *m, uint32_t source)
{
	const struct eco_source *s = &m->sources.items[source];
	for (uint32_t i = 0; i < s->instance_count; i++) {
		const struct eco_source_instance *instance = &s->instances[i];
		uint32_t plant = plant_of_size(m, source, instance->plant, instance->height_m);
		make_place_add(m, source, &(struct make_place){ .plant = plant,
			.at = { instance->at[0], instance->at[1], on_ground(m, source, instance->at) },
			.scale = scale_for(m, plant, instance->scale, instance->height_m),
			.species = species_of(m, source, instance->plant, NULL),
			.yaw_deg = instance->yaw_deg });
	}
}

static const char *plural(uint64_t count) { return count == 1 ? "" : "s"; }

#define BASE_OFF 0.15            /* of the height: a crown that begins so much lower or higher looks like another */

static uint32_t count_base(struct make *m, uint32_t source, const struct eco_position *row, uint32_t plant)
{
	m->ecos[source].bases += !isnan(row->base);
	m->ecos[source].bases_off += fabs(m->plants[plant].base - row->base) > BASE_OFF;         /* not of NaN */
	return plant;
}

/* The variant with the nearest proportions: width by height where both are measured, and where the crown
 * begins. A base that is off by half of the height counts as a width that is off by a factor of 2. */
static uint32_t fitting_variant(struct make *m, uint32_t source, const struct eco_position *row)
{
	uint32_t best = row->plant;
	double least = INFINITY;
	if (is_of_library(m, source, row->plant))
		return count_base(m, source, row, fitting_size(m, source, row->plant, row->height_m, row->crown_radius_m));
	bool wide = !isnan(row->height_m) && !isnan(row->crown_radius_m) && !row->crown_is_guess, based = !isnan(row->base);
	for (uint32_t i = 0; i < row->variant_count && (wide || based); i++) {
		const struct make_plant *plant = &m->plants[m->plant_of[source][row->variant_first + i]];
		double ratio = wide ? row->height_m * plant->crown / (row->crown_radius_m * (double)plant->built.plant.height_m) : 1;
		double base = based ? fabs(plant->base - row->base) : 0, off = fmax(ratio, 1 / ratio) * (1 + 2 * base);
		/* among equals, the one that the hash took */
		if (off < least || (off == least && row->variant_first + i == row->plant)) {
			least = off;
			best = row->variant_first + i;
		}
	}
	return count_base(m, source, row, m->plant_of[source][best]);
}

static double row_scale(const struct make *m, uint32_t plant, const struct eco_position *row)
{
	if (isnan(row->height_m) && !isnan(row->crown_radius_m))
		return row->scale * row->crown_radius_m / m->plants[plant].crown;
	return scale_for(m, plant, row->scale, row->height_m);
}

/* The code of the width that a crown has beside the plant's scale; 0: the model's own, or none is known. */
static uint8_t row_width(const struct make *m, uint32_t plant, const struct eco_position *row, double scale)
{
	double own = m->plants[plant].crown * scale;
	if (isnan(row->crown_radius_m) || !(own > 0))
		return 0;
	double code = floor(ECO_WIDTH_ONE * row->crown_radius_m * row->scale / own + 0.5);
	code = fmin(fmax(code, ECO_WIDTH_LEAST), ECO_WIDTH_MOST);
	return code == ECO_WIDTH_ONE ? 0 : (uint8_t)code;
}

/* Which row of the source's inventory number `file`, from 1 on, the place is. */
static void note_row(const struct make *m, struct make_place *place, const struct eco_positions *reader,
	uint32_t file, const struct eco_position *row)
{
	if (m->options->no_rows || row->row > ECO_INVENTORY_ROW_MAX || row->line > ECO_INVENTORY_ROW_MAX)
		return;
	place->file = file;
	place->row = (uint32_t)row->row;
	place->line = eco_positions_has_lines(reader) ? (uint32_t)row->line : 0;
}

/* Why its height and crown are as they are, for packs with columns; else nothing is kept of a row. */
static void note_cells(struct make *m, struct make_place *place, const struct eco_position *row)
{
	const uint32_t named = m->options->columns.count;
	const char *texts[ECO_INVENTORY_CELLS] = { 0 }, **kept;
	if (!named)
		return;
	memcpy(texts, row->cells, named * sizeof *texts);
	texts[named] = row->height_from;
	texts[named + 1] = row->crown_from;
	kept = make_append(&m->cells, sizeof texts);
	for (uint32_t i = 0; i < ECO_INVENTORY_CELLS; i++) {
		uint32_t number = texts[i] ? eco_string_number(&m->cell_texts, texts[i]) : 0;
		kept[i] = texts[i] ? m->cell_texts.items[number] : NULL;
	}
	place->cells = (uint32_t)m->cells.count;
}

static void read_rows(struct make *m, uint32_t source, struct eco_positions *reader, uint32_t number)
{
	const struct eco_positions_spec *spec = &m->sources.items[source].positions[number];
	struct eco_position row;
	for (uint64_t i = 0;; i++) {
		eco_check(eco_positions_next(reader, &row, m->error));
		if (row.plant == ECO_NONE)
			return;
		uint32_t plant = fitting_variant(m, source, &row);
		struct make_place place = { .plant = plant,
			.at = { row.at[0], row.at[1], row.absolute ? row.at[2] : on_ground(m, source, row.at) },
			.scale = row_scale(m, plant, &row), .species = species_of(m, source, row.plant, row.species),
			.yaw_deg = row.yaw_deg };
		place.width = row_width(m, plant, &row, place.scale);
		place.tint = eco_tints_value(&m->ecos[source].tints, &spec->tint, row.tint);
		note_row(m, &place, reader, number + 1, &row);
		note_cells(m, &place, &row);
		make_place_add(m, source, &place);
		if (i % 4096 == 0)
			main_progress("reading positions", spec->path, 0);
	}
}

/* Two scales move no crown's base. */
static void say_bases(const struct make_eco *eco, const char *path)
{
	char all[32], off[32];
	if (eco->bases > 0)
		main_note("%s: of %s rows that say where the crown begins %s have a model where that is off by more than %g of its "
			"height%s", path, eco_phrase_count(eco->bases, all), eco_phrase_count(eco->bases_off, off), BASE_OFF,
			eco->bases_off > 0 ? "; models with other crowns as variants would be chosen by it" : "");
}

static void note(void *ctx, const char *text) { main_note("%s: %s", (const char *)ctx, text); }

/* Places the rows of a table; errors name the file where needed. */
static void place_rows(struct make *m, uint32_t source)
{
	const struct eco_source *s = &m->sources.items[source];
	struct make_eco *eco = &m->ecos[source];
	struct eco_frame frame = eco_source_frame(s);
	for (uint32_t i = 0; i < s->positions_count; i++) {
		struct eco_positions *reader = NULL;
		eco_check(eco_positions_open(&reader, &s->positions[i], &frame, m->error));
		read_rows(m, source, reader, i);
		uint64_t rows = 0;
		const struct eco_skipped *skipped = eco_positions_skipped(reader, &rows);
		eco->rows += rows;
		for (int k = 0; k < ECO_SKIP_COUNT; k++) {
			if (skipped[k].count && !eco->skipped[k].count)
				eco->skipped[k] = skipped[k];
			else
				eco->skipped[k].count += skipped[k].count;
		}
		eco_positions_report(reader, main_note_text, NULL);
		eco_positions_close(reader);
	}
	eco_check(eco_tints_settle(&eco->tints, m->error));
	for (uint32_t i = 0; i < eco->place_count; i++)
		eco->places[i].tint = eco_tints_class(&eco->tints, eco->places[i].tint);
	say_bases(eco, s->path);
}

static void place_scatters(struct make *m, uint32_t source)
{
	const struct eco_source *s = &m->sources.items[source];
	struct eco_frame frame = eco_source_frame(s);
	for (uint32_t i = 0; i < s->scatter_count; i++) {
		struct eco_scatter *scatter = NULL;
		struct eco_scatter_place row;
		char *path = s->scatters[i].path;
		eco_check(eco_scatter_open(&scatter, &s->scatters[i], &frame, main_scatter_progress, path, m->error));
		while (eco_scatter_next(scatter, &row)) {
			uint32_t plant = plant_of_size(m, source, row.plant, row.height_m);
			make_place_add(m, source, &(struct make_place){ .plant = plant,
				.at = { row.at[0], row.at[1], on_ground(m, source, (double[]){ row.at[0], row.at[1], 0 }) },
				.scale = scale_for(m, plant, 1, row.height_m),
				.species = species_of(m, source, row.plant, NULL),
				.yaw_deg = NAN });
		}
		eco_scatter_report(scatter, note, path);
		eco_scatter_close(scatter);
	}
}

uint32_t make_nested_weight(uint64_t instances)
{
	uint64_t weight = instances / NESTED_PLANTS;
	return weight < 1 ? 1 : weight > NESTED_MOST ? NESTED_MOST : (uint32_t)weight;
}

static void find_nested(struct make *m, uint32_t source, struct lod_tile_item *items)
{
	const struct eco_source *s = &m->sources.items[source];
	struct make_eco *eco = &m->ecos[source];
	for (uint32_t i = 0; i < s->child_count; i++) {
		const struct eco_source_child *child = &s->children[i];
		const struct make_eco *inner = &m->ecos[child->source];
		const struct lod_tile_node *root = &inner->tiles.nodes[0];
		double x = fmax(fabs(root->low[0]), fabs(root->high[0])),
			y = fmax(fabs(root->low[1]), fabs(root->high[1]));
		struct make_nested *nested = &eco->nested[i];
		*nested =
			(struct make_nested){
			.at = { child->at[0], child->at[1], on_ground(m, source, child->at) }, .child = i };
		items[i] = (struct lod_tile_item){ .reach = child->scale * sqrt(x * x + y * y),
			.below = -child->scale * root->low[2],
			.above = child->scale * root->high[2], .plant = ECO_NONE,
			.weight = make_nested_weight(inner->instances) };
		memcpy(items[i].at, nested->at, sizeof items[i].at);
		if (__builtin_add_overflow(eco->instances, inner->instances, &eco->instances))
			eco_stop(ECO_TOO_LARGE, "%s: with the files it nests it has more than 2^64 plants", s->path);
	}
}

/* Tiles the places, then nested eco files with their bounds (these are tiled before). */
static void tile_places(struct make *m, uint32_t source)
{
	const struct eco_source *s = &m->sources.items[source];
	struct make_eco *eco = &m->ecos[source];
	uint64_t count = (uint64_t)eco->place_count + s->child_count;
	struct lod_tile_item *items = eco_alloc(count, sizeof *items);
	eco->nested = eco_alloc(s->child_count, sizeof *eco->nested);
	eco->instances = eco->place_count;
	for (uint32_t i = 0; i < eco->place_count; i++) {
		const struct make_place *p = &eco->places[i];
		const struct make_plant *plant = &m->plants[p->plant];
		items[i] = (struct lod_tile_item){
			.reach = p->scale * plant->reach * fmax(eco_place_width(p->width), 1), .below = -p->scale * plant->low, .above = p->scale * plant->high,
			.plant = p->plant };
		memcpy(items[i].at, p->at, sizeof items[i].at);
	}
	find_nested(m, source, items + eco->place_count);
	lod_tiles_build(&eco->tiles, items, (uint32_t)count, s->tile_instances);
	free(items);
}

/* Opens an inventory and takes its first plant, which shows errors of columns, CRS, PROJ grids and number
 * notation. */
static void check_rows(struct make *m, const struct eco_positions_spec *spec, const struct eco_frame *frame,
	bool has_column[ECO_CELLS_MAX])
{
	struct eco_positions_spec plain = *spec;
	struct eco_positions *reader = NULL;
	struct eco_position first;
	plain.levels = 0;                /* levels need the whole file */
	eco_check(eco_positions_open(&reader, &plain, frame, m->error));
	eco_check(eco_positions_next(reader, &first, m->error));
	for (uint32_t i = 0; i < spec->cell_count; i++)
		has_column[i] |= eco_positions_has_cell(reader, i);
	eco_positions_close(reader);
}

void make_places_check(struct make *m)
{
	bool has_column[ECO_CELLS_MAX] = { 0 };
	for (uint32_t source = 0; source < m->sources.count; source++) {
		const struct eco_source *s = &m->sources.items[source];
		struct eco_frame frame = eco_source_frame(s);
		for (uint32_t i = 0; i < s->positions_count; i++)
			check_rows(m, &s->positions[i], &frame, has_column);
		for (uint32_t i = 0; i < s->scatter_count; i++)
			eco_check(eco_scatter_check(&s->scatters[i], &frame, m->error));
	}
	for (uint32_t i = 0; i < m->options->columns.count; i++)
		if (!has_column[i])
			eco_stop(ECO_BAD_INPUT, "--columns: no inventory of the scene has a column \"%.200s\"",
				m->options->columns.items[i]);
}

/* ---- Doubts: sizes that no such plant has; a line says what to add ---- */

/* By the plant's name; of a name that says nothing, by its first file's, or by its genus in the library. */
static struct eco_flora flora_of(const struct make_plant *plant)
{
	struct eco_flora flora = eco_flora_of(plant->source->name, NULL);
	return flora.genus || flora.form != ECO_FORM_UNKNOWN ? flora
		: eco_flora_of(plant->source->model_count ? eco_path_last(plant->source->models[0]) : plant->source->library.genus,
			NULL);
}

static void doubt_height(const struct make *m, uint32_t id, double middle_m, uint64_t count)
{
	const struct make_plant *plant = &m->plants[id];
	struct eco_flora flora = flora_of(plant);
	struct eco_form_size usual = eco_form_size(flora.form);
	char number[32];
	if (middle_m >= usual.least_m && middle_m <= usual.most_m)
		return;
	main_note("%s: half of its %s plants are %s %.3g m high, where a %s has %.3g to %.3g m; is the "
		"unit of its model or of its heights another? (\"height_m\" or \"unit\" of the plant says "
		"it)", plant->name,
		eco_phrase_count(count, number), middle_m > usual.most_m ? "more than" : "less "
			"than", middle_m,
		eco_form_names[flora.form], usual.least_m, usual.most_m);
}

static void doubt_plant(const struct make *m, uint32_t id, struct eco_spread *heights)
{
	const struct make_plant *plant = &m->plants[id];
	if (heights->seen > 0 && flora_of(plant).form == ECO_FORM_NOTHING)
		main_note("%s: by its name it is no plant; rocks and stumps take vertices from the "
			"plants", plant->name);
	else if (heights->seen > 0 && plant->source->height_m == 0)
		doubt_height(m, id, eco_spread_quantile(heights, 0.5), heights->seen);
}

#define SMALLEST 0.5             /* of a model's size: beyond these its leaves are too small or too large */
#define LARGEST 2.0

struct doubt { struct eco_spread heights; uint64_t small, large; };

/* Plants that are drawn far from their model's height or width. */
static void doubt_scale(const struct make_plant *plant, const struct doubt *doubt)
{
	char texts[3][32];
	if (doubt->small + doubt->large > 0)
		main_note("%s: of its %s plants %s are drawn at less than %g and %s at more than %g of its model's height, %.3g m, or "
			"width, %.3g m; models of other sizes as variants keep leaves and bark in proportion", plant->name,
			eco_phrase_count(doubt->heights.seen, texts[0]), eco_phrase_count(doubt->small, texts[1]), SMALLEST,
			eco_phrase_count(doubt->large, texts[2]), LARGEST, (double)plant->built.plant.height_m, 2 * plant->crown);
}

static void doubt_plants(const struct make *m)
{
	struct doubt *doubts = eco_alloc(m->plant_count, sizeof *doubts);
	for (uint32_t s = 0; s < m->sources.count; s++)
		for (uint32_t i = 0; i < m->ecos[s].place_count; i++) {
			const struct make_place *place = &m->ecos[s].places[i];
			double wide = place->scale * eco_place_width(place->width);
			struct doubt *doubt = &doubts[place->plant];
			doubt->small += fmin(place->scale, wide) < SMALLEST;
			doubt->large += fmax(place->scale, wide) > LARGEST;
			eco_spread_add(&doubt->heights, place->scale * (double)m->plants[place->plant].built.plant.height_m);
		}
	for (uint32_t i = 0; i < m->plant_count; i++) {
		if (!m->plants[i].block && !m->plants[i].source->object) {
			doubt_scale(&m->plants[i], &doubts[i]);
			doubt_plant(m, i, &doubts[i].heights);
		}
		eco_spread_free(&doubts[i].heights);
	}
	free(doubts);
}

/* ---- All ---- */

static void say_off_ground(const struct make *m)
{
	static const char *const names[MAKE_SIDES] = { "west", "east", "south", "north" };
	char sides[120] = "", one[40];
	for (int side = 0; side < MAKE_SIDES; side++) {
		snprintf(one, sizeof one, "%llu %s", (unsigned long long)m->off_side[side], names[side]);
		if (m->off_side[side] > 0)
			eco_phrase_add(sides, sizeof sides, one);
	}
	main_note("%s: %llu plant%s or nested scene%s stand%s beyond its border (%s of it, up to %.4g m "
		"away), where the ground goes on from there", m->sources.items[0].ground.heights[0],
		(unsigned long long)m->off_ground, plural(m->off_ground), plural(m->off_ground),
		m->off_ground == 1 ? "s" : "", sides, m->off_ground_m);
}

void make_places(struct make *m)
{
	m->ecos = eco_alloc(m->sources.count, sizeof *m->ecos);
	/* nested files come after the files that nest them, and are needed first */
	for (uint32_t s = m->sources.count; s-- > 0;) {
		place_instances(m, s);
		place_rows(m, s);
		place_scatters(m, s);
		make_buildings_place(m, s);
		tile_places(m, s);
	}
	if (m->off_ground)
		say_off_ground(m);
	doubt_plants(m);
	if (m->ecos[0].instances == 0)
		eco_stop(ECO_BAD_INPUT, "%s: there are no plants to pack; add \"instances\" or \"children\"",
			m->sources.items[0].path);
}

void make_places_drop(struct make *m)
{
	for (uint32_t s = 0; s < m->sources.count; s++) {
		struct make_eco *eco = &m->ecos[s];
		free(eco->places);
		free(eco->nested);
		eco->places = NULL;
		eco->nested = NULL;
		lod_tiles_free(&eco->tiles);
	}
	free(m->stands.items);
	m->stands = (struct make_array){ 0 };
}

void make_places_free(struct make *m)
{
	if (m->ecos)
		make_places_drop(m);
	for (uint32_t s = 0; m->ecos && s < m->sources.count; s++)
		eco_tints_free(&m->ecos[s].tints);
	free(m->ecos);
	free(m->cells.items);
	eco_string_pool_free(&m->species);
	eco_string_pool_free(&m->cell_texts);
}
