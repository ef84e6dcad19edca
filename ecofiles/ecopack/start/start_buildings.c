/* Footprints of buildings among the arguments: tables beside that of the trees whose features are polygons. */
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/land/footprints.h"

#define LOOKED_AT 256u /* features */
#define POLYGON 3      /* kinds of well-known binary */
#define POLYGONS 6

/* Sums over the features looked at; per column: texts, sizes of buildings, forms of roofs. Plants have crowns. */
struct look {
	uint32_t features, polygons, plants;
	uint32_t filled[ECO_COLUMNS_MAX], sizes[ECO_COLUMNS_MAX], roofs[ECO_COLUMNS_MAX];
};

static void look_at_row(struct look *look, const struct eco_rows *rows)
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
	}
	look->plants += plant;
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
	while (more && look->features < LOOKED_AT && !rows->next(rows, &more, &own) && more)
		look_at_row(look, rows);
	if (2 * look->polygons > look->features && 2 * look->plants < look->features) {
		entry = json_object();
		start_guess(s, "buildings", path, "\"extrude\" in the scene",
			"a table beside that of the trees; %u of the first %u "
			"features are polygons",
			look->polygons, look->features);
		if (!rows->crs)
			json_object_set_new(entry, "crs", json_null()); /* the trees', once it is known */
		take_columns(s, entry, rows, look);
	}
	eco_rows_close(rows);
	free(look);
	return entry;
}

uint32_t start_buildings(struct start *s, char **names, uint32_t count)
{
	uint32_t tables = 0, kept = 0;
	for (uint32_t i = 0; i < count; i++)
		tables += start_is_table(names[i]);
	s->buildings = json_array();
	for (uint32_t i = 0; i < count; i++) {
		json_t *entry = tables > 1 && start_is_table(names[i]) ? look_at(s, names[i]) : NULL;
		if (entry) {
			json_object_set_new(entry, "extrude", json_string(names[i]));
			json_array_append_new(s->buildings, entry);
			tables--;
		} else
			names[kept++] = names[i];
	}
	return kept;
}

void start_buildings_add(const struct start *s, json_t *instances)
{
	size_t i;
	json_t *own;
	json_array_foreach(s->buildings, i, own)
	{
		json_t *entry = json_deep_copy(own);
		char *seen = start_path(s, json_string_value(json_object_get(own, "extrude")));
		json_object_set_new(entry, "extrude", json_string(seen));
		if (json_is_null(json_object_get(own, "crs")) && s->place.crs[0] == 0)
			json_object_del(entry, "crs"); /* all are metres of a plot */
		else if (json_is_null(json_object_get(own, "crs")))
			json_object_set_new(entry, "crs", json_string(s->place.crs));
		json_array_append_new(instances, entry);
		free(seen);
	}
}
