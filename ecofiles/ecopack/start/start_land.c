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

#define WOOD_PLANTS 100000.0 /* that woods of one kind have at most */
#define SMALLEST 0.5         /* of the plants of a wood, as a share of the tallest */

/* One kind of plants in one column: "natural" is "wood". */
struct wood { uint32_t class, column; json_t *values; struct eco_areas areas; double low_y, high_y; bool degrees; };
struct look {
	uint64_t features, all_lines, areas, lines, buildings;   /* areas, lines: of a class that is drawn */
	struct wood *woods; uint32_t wood_count, wood_capacity;
};

static bool keep(void *wood, double xy[2], struct eco_error *error)
{
	struct wood *w = wood;
	(void)error;
	w->low_y = fmin(w->low_y, xy[1]);
	w->high_y = fmax(w->high_y, xy[1]);
	w->degrees = w->degrees && fabs(xy[0]) <= 360 && fabs(xy[1]) <= 90;
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
			.high_y = -INFINITY, .degrees = true };
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

/* An error: it cannot be read so. *no_crs: the trees' is to be taken. */
static void look_at(struct look *look, const char *path, const char *layer, char ***columns, uint32_t *column_count,
	bool *no_crs, struct eco_error *error)
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
	*no_crs = !rows->crs;
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

static double hectares(struct wood *w)
{
	double sum = 0, metre = w->degrees ? 111195 : 1, turn = w->degrees ? (w->low_y + w->high_y) / 2 * M_PI / 180 : 0;
	if (eco_areas_index(&w->areas, 0, NULL))
		return 0;
	for (uint32_t i = 0; i < w->areas.count; i++)
		sum += w->areas.items[i].size_m2;
	return sum * metre * metre * cos(turn) / 10000;
}

/* The plants wait for start_land_plants, as they are no models for the table's species. */
static void take_wood(struct start *s, const struct look *look, uint32_t index, char **columns, json_t *entry)
{
	struct wood *w = &look->woods[index];
	struct eco_land_class row;
	json_t *values = json_array(), *skip = json_object();
	const char *value;
	json_t *set;
	char took[150], count[32];
	double spacing;
	eco_land_class(w->class, &row);
	json_object_foreach(w->values, value, set)
		json_array_append_new(values, json_string(value));
	spacing = row.line ? row.spacing_m : fmax(row.spacing_m, sqrt(hectares(w) * 10000 / WOOD_PLANTS));
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
	json_object_set_new(entry, "plants", json_string(row.plants));
	json_object_set_new(entry, "line", json_boolean(row.line));
	json_object_set_new(entry, "spacing", json_real(round(spacing * 10) / 10));
	json_array_append_new(s->scatters, entry);
	snprintf(took, sizeof took, "%s %s%s, a plant every %.3g m: %.60s", eco_phrase_count(w->areas.count, count), row.name,
		w->areas.count == 1 ? "" : "s", spacing, row.plants);
	start_guess(s, row.line ? "tree rows" : "woods", took, "\"scatter\" in the scene", "\"%.60s\" of %.80s says so; nobody counted them",
		columns[w->column], json_string_value(json_object_get(entry, "scatter")));
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
	bool no_crs = false;
	look_at(&look, path, layer, &columns, &count, &no_crs, &own);
	bool taken = !own.code;
	uint64_t drawn = look.areas + look.lines;
	uint32_t told = layer || !taken ? ECO_NONE : eco_land_class_told(eco_path_last(path), 2 * look.all_lines > look.features);
	bool known = taken && (double)drawn > least * (double)look.features && drawn + look.wood_count > 0;
	taken = known || (taken && (told != ECO_NONE && look.features));
	if (taken && !known) {
		struct eco_land_class class;
		eco_land_class(told, &class);
		json_t *entry = file_json("from", path, layer, no_crs);
		json_object_set_new(entry, "class", json_string(class.name));
		json_array_append_new(s->draws, entry);
		start_guess(s, "ground", path, "\"class\" of \"draw\" in the scene", "no column says what its features are; by its name "
			"%s", class.name);
	} else if (taken && drawn) {
		json_t *entry = file_json("from", path, layer, no_crs);
		for (uint32_t i = 0; i < count; i++)
			if (look.lines && strcmp(columns[i], "width") == 0)
				json_object_set_new(entry, "width_m", json_string("width"));
		json_array_append_new(s->draws, entry);
		start_guess(s, "ground", path, "\"draw\" in the scene", "%s areas and %s lines of %s features are of kinds that are "
			"drawn: roads, water, land use", eco_phrase_count(look.areas, areas), eco_phrase_count(look.lines, lines),
			layer ? layer : "its");
	}
	for (uint32_t i = 0; i < look.wood_count && known; i++)
		take_wood(s, &look, i, columns, file_json("scatter", path, layer, no_crs));
	if (layer && !own.code && look.buildings)
		take_buildings(s, path, &look);
	for (uint32_t i = 0; i < look.wood_count; i++) {
		eco_areas_free(&look.woods[i].areas);
		json_decref(look.woods[i].values);
	}
	for (uint32_t i = 0; i < count; i++)
		free(columns[i]);
	free(columns);
	free(look.woods);
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
		json_t *mix = json_object();
		bool line = json_is_true(json_object_get(entry, "line"));
		double all = 0, tallest = 0, share, spacing = json_real_value(json_object_get(entry, "spacing"));
		char genus[40];
		for (int pass = 0; pass < 2; pass++) {
			const char *at = json_string_value(json_object_get(entry, "plants"));
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
		json_object_del(entry, "plants");
		json_object_del(entry, "line");
		json_object_del(entry, "spacing");
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
