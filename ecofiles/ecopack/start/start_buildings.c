/* Footprints of buildings among the arguments: tables beside that of the trees whose features are polygons. And which of
 * these tables are land (start_land.c). */
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/land/drawing.h"
#include "ecofiles/import/land/footprints.h"

#define LOOKED_AT 256u /* features */
#define POLYGON 3      /* kinds of well-known binary */
#define POLYGONS 6

/* Sums over the features looked at; per column: texts, sizes of buildings, forms of roofs. Plants have crowns. */
struct look {
	uint32_t features, polygons, plants, land;
	bool buildings;          /* a column says so */
	uint32_t filled[ECO_COLUMNS_MAX], sizes[ECO_COLUMNS_MAX], roofs[ECO_COLUMNS_MAX];
};

static void look_at_row(struct look *look, const struct eco_rows *rows, const struct eco_land_reader *reader)
{
	const struct eco_rows_place *place = &rows->place;
	bool area = place->kind == ECO_PLACE_AREA && place->wkb_bytes > 4;
	bool plant = false;
	look->features++;
	look->polygons += area && (place->wkb[1] == POLYGON || place->wkb[1] == POLYGONS);
	for (uint32_t i = 0; i < rows->column_count; i++) {
		double size = 0, unit_m;
		const char *text = i < rows->field_count ? rows->fields[i] : "";
		if (eco_text_is_missing(text))
			continue;
		look->filled[i]++;
		plant = plant || (eco_column_points(ECO_ROLE_SPECIES, rows->columns[i]) >= ECO_COLUMN_ENOUGH &&
					 eco_flora_of(text, NULL).genus);
		look->sizes[i] += eco_text_size(text, '.', &size, &unit_m) != ECO_FORM_NONE && size > 0;
		look->roofs[i] += eco_roof_of(text) != ECO_ROOF_COUNT;
		look->buildings |= strcmp(rows->columns[i], "building") == 0;
	}
	look->plants += plant;
	look->land += eco_land_class_of(reader, rows->fields, rows->field_count, false, NULL) != ECO_NONE;
}

static bool says(const char *name, const char *set)
{
	return eco_words_any(name, eco_words_set(set));
}

/* The first column of a role; ECO_NONE: none. */
enum role { HEIGHT, STOREYS, ROOF };
static uint32_t find(const struct eco_rows *rows, const struct look *look, enum role role)
{
	for (uint32_t i = 0; i < rows->column_count; i++) {
		const char *name = rows->columns[i];
		bool roof = says(name, "roof"),
		     mostly = 2 * (role == ROOF ? look->roofs : look->sizes)[i] > look->filled[i];
		bool is = role == ROOF ? roof
				       : !roof && !says(name, "lowest") &&
				(role == STOREYS ? says(name, "storeys")
						 : eco_column_points(ECO_ROLE_HEIGHT, name) >=
							ECO_COLUMN_ENOUGH);
		if (is && mostly)
			return i;
	}
	return ECO_NONE;
}

/* name NULL: no column, `other` is taken. */
static void say_column(struct start *s, const char *what, const char *name, const char *unit, const char *other,
	const char *option)
{
	char took[120];
	snprintf(took, sizeof took, "%s%.70s%s%s", name ? "\"" : "", name ? name : other, name ? "\"" : "", name ? unit : "");
	start_guess(s, what, took, option, "%s", name ? "by its name and what stands in it" : "no column says it");
}

static void take_columns(struct start *s, json_t *entry, const struct eco_rows *rows, const struct look *look)
{
	json_t *heights = json_array();
	uint32_t height = find(rows, look, HEIGHT), storeys = find(rows, look, STOREYS),
		 roof = find(rows, look, ROOF);
	const char *unit = height == ECO_NONE ? NULL : eco_unit_of_name(rows->columns[height]);
	char in[16];
	if (height != ECO_NONE)
		json_array_append_new(heights,
			json_pack("{s:s, s:s}", "column", rows->columns[height], "unit", unit ? unit : "m"));
	if (storeys != ECO_NONE)
		json_array_append_new(heights,
			json_pack("{s:s, s:f}", "storeys", rows->columns[storeys], "storey_m", ECO_STOREY_M));
	json_array_append_new(heights, json_real(ECO_BUILDING_M));
	json_object_set_new(entry, "height_m", heights);
	snprintf(in, sizeof in, " in %s", unit ? unit : "m");
	say_column(s, "their heights", height == ECO_NONE ? NULL : rows->columns[height], in,
		storeys == ECO_NONE ? "6 m" : "by storeys", "\"height_m\" in the scene");
	if (storeys != ECO_NONE)
		say_column(s, "their storeys", rows->columns[storeys], ", 3 m each", "", "\"storey_m\" in the scene");
	say_column(s, "their roofs", roof == ECO_NONE ? NULL : rows->columns[roof], "", "flat", "\"roof\" in the scene");
	if (roof != ECO_NONE)
		json_object_set_new(entry, "roof", json_string(rows->columns[roof]));
}

/* An entry of "instances" for a file of footprints; NULL: its features are no polygons, or crowns, or GDAL reads none. */
static json_t *look_at(struct start *s, const char *path)
{
	struct eco_rows *rows = NULL;
	struct eco_error own = { .code = ECO_OK };
	struct look *look = eco_alloc(1, sizeof *look);
	json_t *entry = NULL;
	bool more = !eco_rows_open(&rows, &(struct eco_rows_source){ .path = path, .areas = true }, &own);
	struct eco_land_reader reader = { .tests = NULL };
	if (more)
		eco_land_reader_open(&reader, rows->columns, rows->column_count);
	while (more && look->features < LOOKED_AT && !rows->next(rows, &more, &own) && more)
		look_at_row(look, rows, &reader);
	eco_land_reader_close(&reader);
	bool sized = rows && (find(rows, look, HEIGHT) != ECO_NONE || find(rows, look, STOREYS) != ECO_NONE || look->buildings);
	if (2 * look->polygons > look->features && 2 * look->plants < look->features &&
		(sized || 2 * look->land < look->features)) {
		entry = json_object();
		start_guess(s, "buildings", path, "\"extrude\" in the scene",
			"a table beside that of the trees; %u of the first %u "
			"features are polygons",
			look->polygons, look->features);
		if (!rows->crs)
			json_object_set_new(entry, "crs", json_null()); /* the trees', once it is known */
		take_columns(s, entry, rows, look);
		if (look->buildings && look->land)
			json_object_set_new(entry, "skip", json_pack("{s:[s,s]}", "building", "", "no"));
	}
	eco_rows_close(rows);
	free(look);
	return entry;
}

/* Roads and land use are told by their classes, unless sizes of buildings stand beside them; a file may have both. */
static bool take(struct start *s, const char *path, bool as_table)
{
	if (start_is_osm(path))
		return !start_osm(s, path, as_table);
	json_t *entry = as_table ? NULL : look_at(s, path);
	if (entry) {
		json_object_set_new(entry, "extrude", json_string(path));
		json_array_append_new(s->buildings, entry);
	}
	bool both = json_object_get(entry, "skip"), land = !as_table && (!entry || both) && start_land(s, path, both ? 0 : 0.5);
	return entry || land;
}

uint32_t start_buildings(struct start *s, char **names, uint32_t count)
{
	uint32_t tables = 0, kept = 0;
	for (uint32_t i = 0; i < count; i++)
		tables += start_is_table(names[i]);
	s->buildings = json_array();
	s->draws = json_array();
	s->scatters = json_array();
	/* extracts last: they are the table if there is no other */
	for (int osm = 0; osm < 2; osm++) {
		uint32_t left = count;
		count = kept = 0;
		for (uint32_t i = 0; i < left; i++) {
			bool table = start_is_table(names[i]), now = table && start_is_osm(names[i]) == osm;
			if (now && take(s, names[i], tables == 1))
				tables--;
			else
				names[kept++] = names[i];
		}
		count = kept;
	}
	return kept;
}
