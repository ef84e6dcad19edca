/* The meaning of a table's columns, and the places of its plants. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/place_guess.h"
#include "ecofiles/import/places/table_columns.h"
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

static const struct { const char *text, *roles; char decimal;
} tables[] = {
	{ "id,lon,lat,species,height,dbh\n1,11.5,48.1,oak,12,30\n", "lon|lat|species|height|dbh|-", '.' },
	{ "Latitude,Longitude,Common Name,Scientific Name,Height (ft),Diameter at breast height\n"
	  "45.1,-122.5,oak,Quercus robur,40,12\n",
		"Longitude|Latitude|Scientific Name|Height (ft)|Diameter at breast height|-",
		'.' },
	{ "Baumart;H\u00f6he;Kronendurchmesser;Stammumfang;Rechtswert;Hochwert\n"
		"Eiche;12,5;8,5;90,5;4468000,5;5334000,5\n",
		"Rechtswert|Hochwert|Baumart|H\u00f6he|-|Stammumfang", ',' },
	{ "Gattung;Art;Baumh\u00f6he;X;Y\nQuercus;robur;12;691000;5334000\nTilia;cordata;9;691001;5334001\n",
		"X|Y|Gattung|Baumh\u00f6he|-|-", '.' },
	{ "essence\thauteur totale\thauteur du fut\tcirconf\u00e9rence\tlongitude\tlatitude\n"
	  "Ch\u00eane\t12\t3\t90\t2.3\t48.8\n",
		"longitude|latitude|essence|hauteur totale|-|circonf\u00e9rence",
		'.' },
	{ "especie,altura,di\u00e1metro copa,dap,longitud,latitud\nroble,12,5,30,-70,-33\n",
		"longitud|latitud|especie|altura|dap|-", '.' },
	{ "boomsoort;hoogte;stamdiameter;x_rd;y_rd\neik;12;30;121000;487000\n",
		"x_rd|y_rd|boomsoort|hoogte|stamdiameter|-", '.' },
	{ "X,Y,Latitude,Longitude,Species,Species code\n1008714,770748,42.1,-75.8,oak,qu\n",
		"Longitude|Latitude|Species|-|-|-", '.' },
	{ "tag,gx,gy,utm17n_e,utm17n_n,sp\n1,3.5,4.5,747375,4308510,quru\n", "utm17n_e|utm17n_n|sp|-|-|-",
		'.' },
	{ "tag,sp_code,x,y,dbh_mm\n1,litu,3.5,4.5,200\n2,quru,5.5,4.5,300\n", "x|y|sp_code|-|dbh_mm|-", '.' },
	{ "立木ID,樹種,胸高直径,樹高,幹周,経度,緯度\n1,アテ,5.2,4.4,16.3,136.9,37.3\n", "経度|緯度|樹種|樹高|胸高直径|幹周", '.' },
	{ "Порода;Широта;ДОЛГОТА;Высота, м;Диаметр кроны, м;Диаметр, см\nДуб;55.75;37.6;12;5;30\n",
		"ДОЛГОТА|Широта|Порода|Высота, м|Диаметр, см|-", '.' },
	{ "lon,lat,botanic,common\n11.5,48.1,Quercus robur,English oak\n", "lon|lat|botanic|-|-|-", '.' },
	{ "Family,Genus,Species,lat,lon\nSapotaceae,Pouteria,erythrochrysa,-2.59,-60.2\n"
	  "Fabaceae,Inga,alba,-2.58,-60.2\n", "lon|lat|Genus|-|-|-", '.' },
	{ "genus,species,lat,lon\nQuercus,Quercus robur,48.1,11.5\nTilia,Tilia cordata,48.2,11.6\n",
		"lon|lat|species|-|-|-", '.' },
	{ "date,tree_type,lat,lon\n1,Urban Street Tree,45,-123\n", "lon|lat|tree_type|-|-|-", '.' },
	{ "a,b\n1,2\n", "-|-|-|-|-|-", '.' },
};

UNIT_TEST(columns_are_found_in_many_languages)
{
	for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
		struct read r;
		read_text(&r, tables[i].text);
		if (strcmp(roles_of(&r), tables[i].roles) != 0)
			fail_msg("%s  is %s\n  wanted %s", tables[i].text, roles_of(&r), tables[i].roles);
		assert_int_equal(r.columns.decimal, tables[i].decimal);
		eco_table_free(&r.table);
	}
}

UNIT_TEST(commas_part_thousands_where_something_says_so)
{
	static const struct { const char *text, *says; } cases[] = { /* decimal, thousands, whether it is open */
		{ "x;y;h\n691,234;5,334,000;12\n691,240;5,334,010;9\n", ".," },
		{ "x;y;h\n691,234;334,000.5;12\n691,240;334,010;9\n", ".," },
		{ "x;y;h\n691.234;5.334.000;12,5\n691.240;5.334.010,5;9\n", ",." },
		{ "x;y;h\n691,234;334,000;12.5\n691,240;334,010;9\n", ".," },
		{ "x;y;h\n691,234;334,000;12,5\n691,240;334,010;9\n", ",-" },
		{ "x;y;h\n691,234;334,000;12\n691,240;334,010;9\n", ",-?" },
		{ "lon;lat;h\n-122,575;37,137;12\n-122,576;37,138;9\n", ",-" },
		{ "lon;lat;h\n-122,575;-122,137;12.5\n", ",-" },
		{ "x;y;h\n91,234;34,000;12\n91,240;34,010;9\n", ",-" },
		{ "x;y;h\n691234,5;5334000,25;12\n", ",-" },
		{ "x;y;h\n691.234;334.000;12\n691.240;334.010;9\n", ".-" },
		{ "x;y;h\n691 234,5;5 334 000;12\n", ",-" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
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

static const struct eco_raster_extent berlin = { .low = { 390000, 5819000 }, .high = { 393000, 5821000 },
	.crs = "EPSG:25833" };

/* `says`: the CRS of the table and of the scene, whether swapped; or after "?" a part of a question. `other`:
 * the second
 * row; NULL: as the first. */
static const struct { const char *names, *row, *crs; const struct eco_raster_extent *dem; const char *says,
	*other;
} places[] = {
	{ "lon,lat", "11.57,48.14", NULL, NULL, "EPSG:4326 EPSG:32632", NULL },
	{ "lon,lat", "-70.6,-33.4", NULL, NULL, "EPSG:4326 EPSG:32719", NULL },
	{ "lon,lat", "48.14,-122.6", NULL, NULL, "EPSG:4326 EPSG:32610 swapped", NULL },
	{ "x,y", "11.57,48.14", NULL, NULL, "EPSG:4326 EPSG:32632", NULL },
	{ "utm33n_e,utm33n_n", "391000,5820000", NULL, NULL, "EPSG:32633 EPSG:32633", NULL },
	{ "x_25833,y_25833", "391000,5820000", NULL, NULL, "EPSG:25833 EPSG:25833", NULL },
	{ "E_LV95,N_LV95", "2600000,1200000", NULL, NULL, "EPSG:2056 EPSG:2056", NULL },
	{ "x_mga55,y_mga55", "320000,5813000", NULL, NULL, "EPSG:7855 EPSG:7855", NULL },
	{ "x,y", "391000,5820000", "EPSG:25833", NULL, "EPSG:25833 EPSG:25833", NULL },
	{ "x,y", "1008714,770748", "EPSG:2261", NULL, "EPSG:2261 EPSG:32618", NULL },
	{ "x,y", "5820000,391000", "EPSG:25833", NULL, "EPSG:25833 EPSG:25833 swapped", NULL },
	{ "x,y", "12.5,340.2", NULL, NULL, "- -", NULL },
	{ "lon,lat", "237.6,37.7", NULL, NULL, "EPSG:4326 EPSG:32610", NULL },
	{ "x,y", "237.6,37.7", NULL, NULL, "- -", NULL },
	{ "x,y", "0,0", NULL, NULL, "- -", NULL },              /* whole numbers are no degrees ... */
	{ "lon,lat", "11,48", NULL, NULL, "EPSG:4326 EPSG:32632", NULL },       /* unless they say so */
	{ "x,y", "391000,5820000", NULL, NULL, "?each UTM zone, at latitude 52.5", NULL },
	{ "x,y", "2600000,1200000", NULL, NULL, "?EPSG:2056", NULL },
	{ "x,y", "391000,5820000", NULL, &berlin, "EPSG:25833 EPSG:25833", NULL },
	{ "lon,lat", "13.4,52.52", NULL, &berlin, "EPSG:4326 EPSG:25833", NULL },
	{ "lon,lat", "52.52,13.4", NULL, &berlin, "EPSG:4326 EPSG:25833 swapped", NULL },
	/* surveyors' x counts to the north */
	{ "X (PUWG 1992),Y (PUWG 1992)", "486567,637273", NULL, NULL,
		"?--x \"Y (PUWG 1992)\" --y \"X (PUWG 1992)\"", NULL },
	{ "easting 1992,northing 1992", "637273,486567", NULL, NULL, "EPSG:2180 EPSG:2180", NULL },
	{ "X_5677,Y_5677", "5933874,3567274", NULL, NULL, "EPSG:5677 EPSG:5677 swapped", NULL },
	{ "x,y", "486567,637273", "EPSG:2180",
		&(struct eco_raster_extent){ .low = { 637000, 486000 }, .high = { 638000, 487000 },
			.crs = "EPSG:2180" },
		"EPSG:2180 EPSG:2180 swapped", NULL },
	{ "x,y", "391000,5820000", "nonsense", NULL, "?\"nonsense\" is not known", NULL },
	/* a column says the zone, or that rows are in several; the eighth is a park's, perhaps */
	{ "easting,northing,utm_zone", "323400,4307500,18N", NULL, NULL, "EPSG:32618 EPSG:32618", NULL },
	{ "easting,northing,UTM Zone", "323400,4307500,18 T", NULL, NULL, "EPSG:32618 EPSG:32618", NULL },
	{ "easting,northing,zone", "323400,1307500,UTM zone 18L", NULL, NULL, "EPSG:32718 EPSG:32718", NULL },
	{ "x,y,epsg", "323400,4307500,26918", NULL, NULL, "EPSG:26918 EPSG:26918", NULL },
	{ "x,y,zone", "323400,4307500,EPSG:32618", NULL, NULL, "EPSG:32618 EPSG:32618", NULL },
	{ "x,y,utm_zone", "323400,4307500,18", NULL, NULL,
		"?\"18\": is that zone 18 in the north, --crs EPSG:32618, or "
		"in the south, --crs EPSG:32718?", NULL },
	{ "x,y,utm_zone", "323400,4307500,18S", NULL, NULL, "?is that zone 18 in the north", NULL },
	{ "x,y,zone", "323400,4307500,3", NULL, NULL, "?each UTM zone", NULL },
	{ "x,y,utm_zone", "323400,4307500,18N", NULL, NULL, "?is \"18N\" and \"17N\", and an entry has "
		"one CRS. Put each zone into a table of its own; or start with --crs EPSG:32618",
		"723400,4307500,17N" },
};

static const char *place_text(const struct eco_place_guess *g)
{
	static char text[100];
	snprintf(text, sizeof text, "%s %s%s", g->crs[0] ? g->crs : "-", g->scene_crs[0] ? g->scene_crs : "-",
		g->swapped ? " swapped" : "");
	return text;
}

UNIT_TEST(places_get_a_crs_or_a_question)
{
	for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
		const char *says = places[i].says, *row = places[i].row;
		struct eco_place_guess guess;
		char text[200];
		struct read r;
		snprintf(text, sizeof text, "%s\n%s\n%s\n", places[i].names, row, places[i].other
			? places[i].other : row);
		read_text(&r, text);
		struct eco_rows_source source = { .path = r.table.path };
		struct eco_place_asked asked = { .table = &r.table, .source = &source, .columns = &r.columns,
			.crs = places[i].crs, .dem = places[i].dem };
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
