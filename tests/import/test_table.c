/* The meaning of a table's columns, and the places of its plants. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/place_guess.h"
#include "ecofiles/import/places/table_columns.h"
#include "tests/support/cases.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

struct read { struct eco_table table; struct eco_columns columns; };

static void read_text(struct read *r, const char *text)
{
	struct eco_rows_source source = { .path = input_text("table", "rows.csv", text) };
	assert_good(eco_table_read(&r->table, &source, &cause));
	r->columns = (struct eco_columns){ .decimal = 0 };
	for (int i = 0; i < ECO_ROLE_COUNT; i++)
		r->columns.of[i] = ECO_NONE;
	eco_table_columns(&r->table, &r->columns);
}

/* Names of x, y, species, height, trunk and girth, "-" for none. */
static const char *roles_of(const struct read *r)
{
	static char text[400];
	size_t used = 0;
	for (int i = 0; i <= ECO_ROLE_GIRTH; i++)
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", i ? "|" : "",
			r->columns.of[i] == ECO_NONE ? "-" : r->table.columns[r->columns.of[i]]);
	return text;
}

struct columns_case { const char *text, *roles, *decimal; };

UNIT_TEST(columns_are_found_in_many_languages)
{
	uint32_t count;
	const struct columns_case *tables = cases_read("tests/import/cases/columns.tsv", sizeof *tables, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct read r;
		read_text(&r, tables[i].text);
		if (strcmp(roles_of(&r), tables[i].roles) != 0)
			fail_msg("%s  is %s\n  wanted %s", tables[i].text, roles_of(&r), tables[i].roles);
		assert_int_equal(r.columns.decimal, tables[i].decimal[0]);
		eco_table_free(&r.table);
	}
}

UNIT_TEST(commas_part_thousands_where_something_says_so)
{
	struct thousands_case { const char *text, *says; };
	uint32_t count;
	const struct thousands_case *cases = cases_read("tests/import/cases/thousands.tsv", sizeof *cases, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct read r;
		read_text(&r, cases[i].text);
		const struct eco_columns *c = &r.columns;
		const char says[] = { c->decimal, c->thousands ? c->thousands : '-', c->thousands_open ? '?'
			: 0, 0 };
		if (strcmp(says, cases[i].says) != 0 || c->of[ECO_ROLE_X] != 0 || c->of[ECO_ROLE_Y] != 1)
			fail_msg("%s  is %s instead of %s", cases[i].text, says, cases[i].says);
		eco_table_free(&r.table);
	}
}

UNIT_TEST(an_even_selection_of_many_rows_stays)
{
	static char text[200000] = "n\n";
	size_t used = 2;
	for (int i = 0; i < 20000; i++)
		used += (size_t)snprintf(text + used, sizeof text - used, "%d\n", i);
	struct read r;
	read_text(&r, text);
	assert_int_equal(r.table.rows, 20000);
	assert_true(r.table.row_count > ECO_TABLE_ROWS / 2 && r.table.row_count <= ECO_TABLE_ROWS);
	int step = atoi(eco_table_field(&r.table, 1, 0)) - atoi(eco_table_field(&r.table, 0, 0));
	assert_int_equal(step, 16);
	for (uint32_t i = 0; i < r.table.row_count; i++)
		assert_int_equal(atoi(eco_table_field(&r.table, i, 0)), step * (int)i);
	eco_table_free(&r.table);
}

UNIT_TEST(values_are_counted_most_first)
{
	struct eco_rows_source source = { .path = input_text("table", "values.csv", "a,sp\n1,oak\n2, elm "
		"\n3,elm\n4\n5,ash\n") };
	struct eco_table_values values;
	assert_good(eco_table_values_read(&values, &source, (const char *const[]){ "sp" }, 1, &cause));
	assert_int_equal(values.count, 3);
	assert_string_equal(values.items[0].text, "elm");
	assert_int_equal(values.items[0].rows, 2);
	assert_int_equal(values.items[0].first_line, 3);
	assert_string_equal(values.items[1].text, "oak");
	eco_table_values_free(&values);
	assert_code(eco_table_values_read(&values, &source, (const char *const[]){ "none" }, 1, &cause), ECO_BAD_INPUT, "");
}

/* ---- Places ---- */

struct place_case { const char *names, *row, *crs, *dem, *says, *other; };

static const char *place_text(const struct eco_place_guess *g)
{
	static char text[100];
	snprintf(text, sizeof text, "%s %s%s", g->crs[0] ? g->crs : "-", g->scene_crs[0] ? g->scene_crs : "-",
		g->swapped ? " swapped" : "");
	return text;
}

UNIT_TEST(places_get_a_crs_or_a_question)
{
	static const struct eco_raster_extent berlin = { .low = { 390000, 5819000 }, .high = { 393000, 5821000 },
		.crs = "EPSG:25833" }, lodz = { .low = { 637000, 486000 }, .high = { 638000, 487000 }, .crs = "EPSG:2180" };
	uint32_t count;
	const struct place_case *places = cases_read("tests/import/cases/places.tsv", sizeof *places, &count);
	for (uint32_t i = 0; i < count; i++) {
		const char *says = places[i].says, *row = places[i].row;
		struct eco_place_guess guess;
		char text[200];
		struct read r;
		snprintf(text, sizeof text, "%s\n%s\n%s\n", places[i].names, row, places[i].other
			? places[i].other : row);
		read_text(&r, text);
		struct eco_rows_source source = { .path = r.table.path };
		struct eco_place_asked asked = { .table = &r.table, .source = &source, .columns = &r.columns,
			.crs = places[i].crs,
			.dem = !places[i].dem ? NULL : *places[i].dem == 'b' ? &berlin : &lodz };
		cause = (struct eco_error){ 0 };
		enum eco_code code = eco_place_guess(&guess, &asked, &cause);
		if (says[0] == '?' ? !code || !strstr(cause.text, says + 1) : code
			|| strcmp(place_text(&guess), says) != 0)
			fail_msg("%s: %s; wanted %s", text, code ? cause.text : place_text(&guess), says);
		eco_table_free(&r.table);
	}
}

UNIT_TEST(origins_are_round_and_in_the_middle)
{
	struct eco_place_guess guess;
	struct read r;
	read_text(&r, "x,y\n391003,5820004\n391013,5820014\n391027,5820021\n");
	struct eco_rows_source source = { .path = r.table.path };
	struct eco_place_asked asked = { .table = &r.table, .source = &source, .columns = &r.columns,
		.crs = "EPSG:25833" };
	assert_good(eco_place_guess(&guess, &asked, &cause));
	assert_true(guess.origin[0] == 391010 && guess.origin[1] == 5820010);
	assert_true(fabs(guess.degrees[0] - 13.395) < 0.01 && fabs(guess.degrees[1] - 52.52) < 0.02);
	eco_table_free(&r.table);
}

/* East of a zone's middle, north of the equator, a map's north lies clockwise of true north: by about the
 * difference in longitude times the latitude's sine. */
UNIT_TEST(a_place_of_a_map_is_a_place_on_earth)
{
	static const struct { const char *crs; double xy[2], degrees[2], middle; } cases[] = {
		{ "EPSG:26917", { 747375, 4308510 }, { -78.14779, 38.89055 }, -81 },
		{ "EPSG:32632", { 500000, 5205000 }, { 9, 46.99921 }, 9 },
		{ "EPSG:32760", { 400000, 5000000 }, { 175.728, -45.1464 }, 177 },
		{ "EPSG:32632+5773", { 300000, 5205000 }, { 6.3698, 46.9667 }, 9 } };
	struct eco_crs_place place;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const double *degrees = cases[i].degrees;
		assert_good(eco_crs_place(cases[i].crs, cases[i].xy, &place, &cause));
		if (fabs(place.longitude_deg - degrees[0]) > 1e-2
			|| fabs(place.latitude_deg - degrees[1]) > 1e-2
				|| fabs(place.convergence_deg - (degrees[0] - cases[i].middle)
				* sin(degrees[1] * 3.14159265 / 180)) > 5e-3)
			fail_msg("%s: %.5f, %.5f, %.4f", cases[i].crs, place.longitude_deg,
				place.latitude_deg, place.convergence_deg);
	}
	assert_code(eco_crs_place("EPSG:7", cases[0].xy, &place, &cause), ECO_BAD_INPUT, "");
}

UNIT_TEST(a_crs_has_its_facts)
{
	struct eco_crs_facts facts;
	char zone[32];
	assert_good(eco_crs_look("EPSG:25832", (double[]){ 691607, 5334760 }, &facts, &cause));
	assert_true(facts.metric_map && facts.inside && !facts.geographic);
	assert_string_equal(facts.code, "EPSG:25832");
	assert_good(eco_crs_look("EPSG:4326", (double[]){ 11.5, 48 }, &facts, &cause));
	assert_true(facts.geographic && facts.degrees[0] == 11.5 && facts.degrees[1] == 48);
	assert_code(eco_crs_look("EPSG:7", (double[]){ 0, 0 }, &facts, &cause), ECO_BAD_INPUT, "");
	eco_crs_utm((double[]){ 179.99, -1 }, zone);
	assert_string_equal(zone, "EPSG:32760");
	eco_crs_utm((double[]){ -180, 1 }, zone);
	assert_string_equal(zone, "EPSG:32601");
}
