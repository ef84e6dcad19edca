/* Land around the trees, among the arguments: roads, water and land use, which are drawn on the ground, and woods and tree
 * rows in them, which are scattered; extracts of OpenStreetMap, which have all of it, buildings and single trees. */
#include "ecofiles/ecopack/start/start.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/land/drawing.h"
#include "ecofiles/import/land/footprints.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/places/crs.h"

#define WOOD_PLANTS 100000.0 /* that woods of one kind have at most */
#define SMALLEST 0.5         /* of the plants of a wood, as a share of the tallest */

/* One kind of plants in one column: "natural" is "wood". */
struct wood { uint32_t class, column; json_t *values; struct eco_areas areas; double low_y, high_y; };
struct look {
	uint64_t features, all_lines, areas, lines, buildings;   /* areas, lines: of a class that is drawn */
	struct wood *woods; uint32_t wood_count, wood_capacity;
	char *crs;                                       /* of the file; NULL: the trees' is to be taken */
};

static bool keep(void *wood, double xy[2], struct eco_error *error)
{
	struct wood *w = wood;
	(void)error;
	w->low_y = fmin(w->low_y, xy[1]);
	w->high_y = fmax(w->high_y, xy[1]);
	return true;
}

static void add_wood(struct look *look, uint32_t class, uint32_t column, const struct eco_rows *rows)
{
	uint32_t i = 0;
	bool kept;
	while (i < look->wood_count && (look->woods[i].class != class || look->woods[i].column != column))
		i++;
	if (i == look->wood_count) {
		eco_grow(&look->woods, &look->wood_capacity, i, sizeof *look->woods);
		look->woods[look->wood_count++] = (struct wood){ class, column, json_object(), .low_y = INFINITY,
			.high_y = -INFINITY };
	}
	struct wood *w = &look->woods[i];
	json_object_set_new(w->values, rows->fields[column], json_true());
	eco_areas_add_wkb(&w->areas, rows->place.wkb, rows->place.wkb_bytes, keep, w, &kept, NULL);
}

static void look_at_row(struct look *look, const struct eco_rows *rows, const struct eco_land_reader *reader,
	uint32_t building)
{
	const bool line = rows->place.wkb[1] == 2 || rows->place.wkb[1] == 5;    /* of well-known binary */
	uint32_t column, class = eco_land_class_of(reader, rows->fields, rows->field_count, line, &column);
	struct eco_land_class row;
	const char *text = building < rows->field_count ? rows->fields[building] : "";
	look->features++;
	look->all_lines += line;
	look->buildings += !line && *text && strcmp(text, "no") != 0;
	if (class == ECO_NONE || !eco_land_class(class, &row))
		return;
	look->lines += row.drawn && line;
	look->areas += row.drawn && !line;
	if (*row.plants && row.line == line)
		add_wood(look, class, column, rows);
}

/* An error: it cannot be read so. */
static void look_at(struct look *look, const char *path, const char *layer, char ***columns, uint32_t *column_count,
	struct eco_error *error)
{
	struct eco_rows *rows = NULL;
	struct eco_land_reader reader;
	bool more = true;
	*look = (struct look){ .features = 0 };
	if (eco_rows_open(&rows, &(struct eco_rows_source){ .path = path, .layer = layer, .areas = true }, error)) {
		eco_rows_close(rows);
		return;
	}
	uint32_t building = 0;
	while (building < rows->column_count && strcmp(rows->columns[building], "building") != 0)
		building++;
	eco_land_reader_open(&reader, rows->columns, rows->column_count);
	look->crs = rows->crs ? eco_copy_text(rows->crs) : NULL;
	while (!rows->next(rows, &more, error) && more)
		if (rows->place.kind == ECO_PLACE_AREA && rows->place.wkb_bytes > 4)
			look_at_row(look, rows, &reader, building);
	eco_land_reader_close(&reader);
	*columns = eco_alloc(rows->column_count + 1u, sizeof **columns);
	*column_count = rows->column_count;
	for (uint32_t i = 0; i < rows->column_count; i++)
		(*columns)[i] = eco_copy_text(rows->columns[i]);
	eco_rows_close(rows);
}

/* ---- Woods ---- */

/* In the units of the file. */
static double surface(struct wood *w)
{
	double sum = 0;
	if (eco_areas_index(&w->areas, 0, NULL))
		return 0;
	for (uint32_t i = 0; i < w->areas.count; i++)
		sum += w->areas.items[i].size_m2;
	return sum;
}

/* The plants wait for start_land_plants, as they are no models for the table's species, and so does their spacing, as a file
 * without a CRS has the trees'. */
static void take_wood(struct start *s, const struct look *look, uint32_t index, char **columns, json_t *entry)
{
	struct wood *w = &look->woods[index];
	struct eco_land_class row;
	json_t *values = json_array(), *skip = json_object();
	const char *value;
	json_t *set;
	eco_land_class(w->class, &row);
	json_object_foreach(w->values, value, set)
		json_array_append_new(values, json_string(value));
	json_object_set_new(entry, "only", json_pack("{s:o}", columns[w->column], values));
	for (uint32_t i = 0; i < index; i++) {   /* what an earlier column has told is done */
		if (look->woods[i].class != w->class)
			continue;
		values = json_array();
		json_object_foreach(look->woods[i].values, value, set)
			json_array_append_new(values, json_string(value));
		json_object_set_new(skip, columns[look->woods[i].column], values);
	}
	if (json_object_size(skip))
		json_object_set(entry, "skip", skip);
	json_decref(skip);
	json_object_set_new(entry, "wood", json_pack("{s:i, s:I, s:f, s:f, s:s, s:s*}", "class", (int)w->class, "count",
		(json_int_t)w->areas.count, "surface", surface(w), "latitude", (w->low_y + w->high_y) / 2, "column", columns[w->column],
		"crs", look->crs));
	json_array_append_new(s->scatters, entry);
}

/* Metres; without a CRS of the scene all numbers are. */
static double spacing_of(const struct start *s, const json_t *wood, const struct eco_land_class *row)
{
	const char *own = json_string_value(json_object_get(wood, "crs")), *crs = own ? own : s->place.crs;
	double surface = json_real_value(json_object_get(wood, "surface")), at[2] = { 0,
		json_real_value(json_object_get(wood, "latitude")) };
	struct eco_crs_facts facts;
	struct eco_error none = { .code = ECO_OK };
	if (*s->place.scene_crs && *crs && !eco_crs_look(crs, at, &facts, &none) && facts.geographic)
		surface *= ECO_DEGREE_M * eco_degree_m(at[1]);
	return row->line ? row->spacing_m : round(fmax(row->spacing_m, sqrt(surface / WOOD_PLANTS)) * 10) / 10;
}

/* ---- Files ---- */

static json_t *file_json(const char *key, const char *path, const char *layer, bool no_crs)
{
	json_t *entry = json_pack("{s:s}", key, path);
	if (layer)
		json_object_set_new(entry, "layer", json_string(layer));
	if (no_crs)
		json_object_set_new(entry, "crs", json_null());  /* the trees', once it is known */
	return entry;
}

static void take_buildings(struct start *s, const char *path, const struct look *look)
{
	char took[250], count[32];
	json_array_append_new(s->buildings, json_pack("{s:s, s:{s:[s,s]}, s:[{s:s, s:s}, {s:s, s:f}, f], s:s}", "extrude", path,
		"skip", "building", "", "no", "height_m", "column", "height", "unit", "m", "storeys", "building:levels", "storey_m",
		ECO_STOREY_M, ECO_BUILDING_M, "roof", "roof:shape"));
	snprintf(took, sizeof took, "%.200s", path);
	start_guess(s, "buildings", took, "\"extrude\" in the scene", "%s areas have \"building\"; heights by \"height\", \"building:"
		"levels\", else %g m", eco_phrase_count(look->buildings, count), ECO_BUILDING_M);
}

/* Draws, scatters and extrudes what a layer has, which must then be readable; false: nothing of it. `least`: the share of its features that must be of a
 * class that is known. */
static bool take_layer(struct start *s, const char *path, const char *layer, double least)
{
	struct look look;
	char **columns = NULL, areas[32], lines[32];
	uint32_t count = 0;
	struct eco_error own = { .code = ECO_OK };
	look_at(&look, path, layer, &columns, &count, &own);
	bool taken = !own.code;
	uint64_t drawn = look.areas + look.lines;
	uint32_t told = layer || !taken ? ECO_NONE : eco_land_class_told(eco_path_last(path), 2 * look.all_lines > look.features);
	bool known = taken && (double)drawn > least * (double)look.features && drawn + look.wood_count > 0;
	taken = known || (taken && (told != ECO_NONE && look.features));
	if (taken && !known) {
		struct eco_land_class class;
		eco_land_class(told, &class);
		json_t *entry = file_json("from", path, layer, !look.crs);
		json_object_set_new(entry, "class", json_string(class.name));
		json_array_append_new(s->draws, entry);
		start_guess(s, "ground", path, "\"class\" of \"draw\" in the scene", "no column says what its features are; by its name "
			"%s", class.name);
	} else if (taken && drawn) {
		json_t *entry = file_json("from", path, layer, !look.crs);
		for (uint32_t i = 0; i < count; i++)
			if (look.lines && strcmp(columns[i], "width") == 0)
				json_object_set_new(entry, "width_m", json_string("width"));
		json_array_append_new(s->draws, entry);
		start_guess(s, "ground", path, "\"draw\" in the scene", "%s areas and %s lines of %s features are of kinds that are "
			"drawn: roads, water, land use", eco_phrase_count(look.areas, areas), eco_phrase_count(look.lines, lines),
			layer ? layer : "its");
	}
	for (uint32_t i = 0; i < look.wood_count && known; i++)
		take_wood(s, &look, i, columns, file_json("scatter", path, layer, !look.crs));
	if (layer && !own.code && look.buildings)
		take_buildings(s, path, &look);
	for (uint32_t i = 0; i < look.wood_count; i++) {
		eco_areas_free(&look.woods[i].areas);
		json_decref(look.woods[i].values);
	}
	for (uint32_t i = 0; i < count; i++)
		free(columns[i]);
	eco_free(columns, look.woods, look.crs);
	if (layer && own.code)
		eco_stop(own.code, "%s", own.text);
	return taken || (layer && look.buildings);
}

bool start_land(struct start *s, const char *path, double least) { return take_layer(s, path, NULL, least); }

static bool has_trees(const char *path)
{
	struct eco_rows *rows = NULL;
	struct eco_error own = { .code = ECO_OK };
	bool more = false, found = !eco_rows_open(&rows, &(struct eco_rows_source){ .path = path }, &own) &&
		!rows->next(rows, &more, &own) && more;
	eco_rows_close(rows);
	return found;
}

bool start_is_osm(const char *path)
{
	size_t size;
	char *head = start_is_table(path) ? eco_file_read_head(path, &size) : NULL;
	bool is = head && (strstr(head, "<osm ") || (size > 16 && memcmp(head + 6, "OSMHeader", 9) == 0));
	free(head);
	return is;
}

bool start_osm(struct start *s, const char *path, bool as_table)
{
	bool areas = take_layer(s, path, "multipolygons", 0), lines = take_layer(s, path, "lines", 0), trees = has_trees(path);
	if (!areas && !lines && !trees)
		eco_stop(ECO_BAD_INPUT, "%.300s: an extract of OpenStreetMap in which nothing is known: no roads, water, land use, "
			"buildings nor trees", path);
	if (as_table && !trees)
		eco_stop(ECO_BAD_INPUT, "%.300s: it has no single trees (natural=tree), by which a scene is placed: name a table of "
			"trees beside it", path);
	if (trees)
		start_guess(s, "single trees", path, "", "%s", as_table ? "nodes with natural=tree; no table of trees is given"
			: "left out: a table of trees is given");
	return as_table;
}

/* ---- The scene ---- */

/* A path and a CRS as the scene has them. */
static json_t *finished(const struct start *s, const json_t *own, const char *key)
{
	json_t *entry = json_deep_copy(own);
	char *seen = start_path(s, json_string_value(json_object_get(own, key)));
	json_object_set_new(entry, key, json_string(seen));
	if (json_is_null(json_object_get(own, "crs")) && s->place.crs[0] == 0)
		json_object_del(entry, "crs"); /* all are metres of a plot */
	else if (json_is_null(json_object_get(own, "crs")))
		json_object_set_new(entry, "crs", json_string(s->place.crs));
	free(seen);
	return entry;
}

static void add_all(const struct start *s, const json_t *from, const char *key, json_t *to)
{
	size_t i;
	json_t *own;
	json_array_foreach(from, i, own)
		json_array_append_new(to, finished(s, own, key));
}

/* Plants of the library for "Fagus:3 Picea:2", as a scatter has them. */
void start_land_plants(struct start *s)
{
	size_t i;
	json_t *entry;
	json_array_foreach(s->scatters, i, entry) {
		json_t *mix = json_object(), *wood = json_object_get(entry, "wood");
		struct eco_land_class row;
		eco_land_class((uint32_t)json_integer_value(json_object_get(wood, "class")), &row);
		const uint64_t features = (uint64_t)json_integer_value(json_object_get(wood, "count"));
		const bool line = row.line;
		double all = 0, tallest = 0, share, spacing = spacing_of(s, wood, &row);
		char genus[40], took[150], count[32];
		snprintf(took, sizeof took, "%s %s%s, a plant every %.3g m: %.60s", eco_phrase_count(features, count), row.name,
			features == 1 ? "" : "s", spacing, row.plants);
		start_guess(s, line ? "tree rows" : "woods", took, "\"scatter\" in the scene", "\"%.60s\" of %.80s says so; nobody "
			"counted them", json_string_value(json_object_get(wood, "column")), json_string_value(json_object_get(entry, "scatter")));
		for (int pass = 0; pass < 2; pass++) {
			const char *at = row.plants;
			for (int used; sscanf(at, "%39[^:]:%lf%n", genus, &share, &used) == 2; at += used + (at[used] == ' ')) {
				struct eco_flora flora = eco_flora_of(genus, NULL);
				if (pass == 0) {
					all += share;
					continue;
				}
				uint32_t model = start_library_plant(s, &flora);
				s->models[model].rows++;
				tallest = fmax(tallest, flora.height_m);
				json_object_set_new(mix, s->models[model].name, json_real(line ? share : round(10000 * share / all / spacing / spacing * 10) / 10));
			}
		}
		json_object_set_new(entry, line ? "mix" : "density_per_ha", mix);
		if (line)
			json_object_set_new(entry, "spacing_m", json_real(spacing));
		if (tallest > 0)
			json_object_set_new(entry, "height_m", json_pack("{s:f, s:f}", "min", round(SMALLEST * 7 * tallest) / 10, "max",
				round(7 * tallest) / 10));
		json_object_del(entry, "wood");
	}
}

void start_land_add(const struct start *s, json_t *ground, json_t *instances)
{
	json_t *draws = json_array();
	add_all(s, s->draws, "from", draws);
	if (json_array_size(draws))
		json_object_set(ground, "draw", draws);
	json_decref(draws);
	add_all(s, s->buildings, "extrude", instances);
	add_all(s, s->scatters, "scatter", instances);
}
