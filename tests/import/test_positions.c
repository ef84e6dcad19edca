/* Inventories as scenes ask for them: coordinates, species, filters, sizes, and what is said of rows that
 * cannot be used or were guessed at. Formats are tested in test_rows*.c, texts in test_words.c. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/scene/scene.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

#define UTM32 "\"crs\":\"EPSG:25832\",\"origin\":[690000,5335000,0],"
#define XY "\"x\":\"x\",\"y\":\"y\""

/* species: what each plant's row states; "": none, "-": no column does. */
struct inventory { char plants[8000], species[8000], report[8000], error[1024]; };

static void inventory_say(void *ctx, const char *text)
{
	struct inventory *in = ctx;
	size_t used = strlen(in->report);
	snprintf(in->report + used, sizeof in->report - used, "%s\n", text);
}

static void inventory_put(struct inventory *in, const struct eco_source *source, const struct eco_position *p)
{
	size_t used = strlen(in->plants), size = sizeof in->plants;
#define INVENTORY_PUT(...) (used += used < size ? (size_t)snprintf(in->plants + used, size - used, \
	__VA_ARGS__) : 0)
	INVENTORY_PUT("%s%s %.9g %.9g", used > 0 ? " / " : "", source->plants[p->plant].name, p->at[0],
		p->at[1]);
	if (p->absolute)
		INVENTORY_PUT(" z%.9g", p->at[2]);
	if (!isnan(p->height_m))
		INVENTORY_PUT(" h%.9g", p->height_m);
	if (!isnan(p->crown_radius_m))
		INVENTORY_PUT(" c%.9g", p->crown_radius_m);
	if (p->scale != 1)
		INVENTORY_PUT(" s%.9g", p->scale);
#undef INVENTORY_PUT
	used = strlen(in->species);
	snprintf(in->species + used, sizeof in->species - used, "%s%s", used > 0 ? " / " : "",
		p->species ? p->species : "-");
}

static enum eco_code inventory_read_rows(struct inventory *in, const struct eco_source *source,
	struct eco_error *error)
{
	struct eco_frame frame = { .crs = source->crs, .vertical = source->vertical,
		.origin = { source->origin[0], source->origin[1], source->origin[2] } };
	struct eco_positions *reader;
	struct eco_position record;
	enum eco_code code = eco_positions_open(&reader, &source->positions[0], &frame, error);
	if (code)
		return code;
	while ((code = eco_positions_next(reader, &record, error)) == ECO_OK && record.plant != ECO_NONE)
		inventory_put(in, source, &record);
	if (!code)
		eco_positions_report(reader, inventory_say, in);
	eco_positions_close(reader);
	return code;
}

/* `scene`: its fields before "plants", each with its comma; `entry`: fields of the entry, after "from".
 * Plants are oak, ash and elm; elm has three variants. The message of a failure is in `error`, which is empty
 * otherwise. */
static const struct inventory *inventory_of(const char *test, const char *scene, const char *file, const char *entry)
{
	static struct inventory in;
	struct eco_error error = { .code = ECO_OK };
	struct eco_source source;
	char json[6000], path[600];
	in = (struct inventory){ .plants = "" };
	snprintf(path, sizeof path, "%s", input_path(test, "scene.json"));
	snprintf(json, sizeof json, "{%s\"plants\":{\"oak\":{\"model\":\"m.obj\"},"
		"\"ash\":{\"model\":\"m.obj\"},\"elm\":{\"variants\":[\"a.obj\","
		"\"b.obj\",\"c.obj\"]}},\"instances\":[{\"from\":\"%s\"%s%s}]}", scene, file,
		*entry != 0 ? "," : "", entry);
	if (eco_source_parse(&source, json, strlen(json), path, false, &error) == ECO_OK) {
		inventory_read_rows(&in, &source, &error);
		eco_source_free(&source);
	}
	snprintf(in.error, sizeof in.error, "%s", error.text);
	return &in;
}

/* The report must hold each of `says`, parted by "|". */
static void check_report(const struct inventory *in, const char *says)
{
	char all[1000], *rest = all;
	snprintf(all, sizeof all, "%s", says);
	for (const char *one; (one = strsep(&rest, "|"));)
		if (!strstr(in->report, one))
			fail_msg("%s\n  wanted ... %s", in->report, one);
}

/* Fields of an entry in single quotes. Each has a plant, if no species, and x and y, if it is of a CSV and does not
 * name its own or begin with "-". */
static const char *entry_of(const char *fields, bool csv)
{
	static char entry[1000];
	bool bare = *fields == '-', placed = bare || !csv || strstr(fields, "'x':");
	fields += bare;
	int used = snprintf(entry, sizeof entry, "%s%s", strstr(fields, "'species':") || strstr(fields, "'plant':") ? ""
		: *fields || !placed ? "'plant':'oak'," : "'plant':'oak'", fields);
	if (!placed)
		snprintf(entry + used, sizeof entry - (size_t)used, "%s'x':'x','y':'y'", *fields ? "," : "");
	for (char *c = entry; *c; c++)
		*c = *c == '\'' ? '"' : *c;
	return entry;
}

#define FEATURE(x, y) "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\"," \
	"\"coordinates\":[" x "," y "]}}"
#define FEATURES(crs, all) "{\"type\":\"FeatureCollection\"," crs "\"features\":[" all "]}"
#define SAYS(name) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" name "\"}},"

static const char species_csv[] = "s,x,y\nQuercus robur,1,0\nquercus  ROBUR ,2,0\nQuercus rubra,3,0\nQuercus robur 'Fastigiata',4,"
		"0\nTilia,5,0\n,6,0\n";
static const char filters_csv[] = "x,y,status,dbh\n1,1,Alive,5\n2,2,Stump,0\n3,3,dead ,12\n4,4,alive,0.0\n5,5,,7\n";
static const char commas_csv[] = "x;y;h\n1,5;2,25;12,5\n1.234,5;3;4\n";
static const char plain_csv[] = "x,y\n1,2\n";
static const char datums_csv[] = "x,y,z\n690001,5335002,512.5\n";
static const char sources_csv[] = "x,y,h,d\n1,1,12.5,300\n2,2,21 to 30,300\n3,3,N/A,100\n4,4,-1,\n5,5,> 101,\n6,6,40',\n7,7,9 m,\n"
		"8,8,0,NA\n";
static const char trunks_csv[] = "s,x,y,d,g\noak,1,1,100,31.4159265\nash,2,2,100,31.4159265\nelm,3,3,100,\n";
static const char crowns_a_csv[] = "x,y,k,s,h\n1,1,8 m,2,10\n2,2,4-6,0,\n3,3,,x,\n";
static const char degrees_csv[] = "x,y\n8.61,50.1\n8.62,50.11\n";

/* name: NULL: as above; plants NULL: an error, which holds `says` */
static const struct { const char *name, *scene, *text, *entry, *plants, *says; } cases[] = {
	{ "a_missing_column_is_named_beside_those_there_are", "", "X,y,h\n1,2,3\n", "", NULL,
		"no column \"x\"; there are: X, y, h" },
	{ NULL, "", "x;y\n1;2\n", "'separator':','", NULL, "is \"separator\" another?" },
	{ NULL, "", "x,y,x\n1,2,3\n", "", NULL, "two columns are named \"x\"" },
	{ NULL, "", "Name;Rechtswert;Hochwert\na;1;2\n", "-", NULL,
		"add \"x\": \"Rechtswert\", \"y\": \"Hochwert\"" },
	{ NULL, "", "a,b\n1,2\n", "-", NULL, "add \"x\": \"...\", \"y\": \"...\"; there are: a, b" },
	{ NULL, "", "x,y\n1,2\n", "'only':{'status':'Alive'}", NULL, "no column \"status\"" },
	{ NULL, "", "x,y\n1,2\n", "'height_m':{'column':'h'}", NULL, "no column \"h\"" },
	{ NULL, "", "x,y\n1,2\n", "'z':'geometry'", NULL, "no column \"geometry\"" },
	{ "rows_that_cannot_be_used_are_counted_by_reason", "", "sp,x,y\noak,1,2\nlime,1,2\noak,,2\noak,1,"
		"NA\noak,1,2m\noak,0x10,2\noak,nan,2\nstump,1,2\noak,1\noak,1e9,2\nlime,3,3\n Oak ,7,8\n",
		"'species':'sp','map':{'oak':'oak','stump':null,'gone':null}", "oak 1 2 / oak 7 8",
		"12 rows, 2 plants|3  left out: no coordinates (first in line 4)|2  left out: a coordinate "
		"that is not a number (first in line 6: \"2m\")|1  left out: more than 10,000 km|1  left out "
		"by the map: stump (first in line 9: \"stump\")|1  left out: too few fields (first in line "
		"10: \"oak\")|2  left out: 1 species that the map does not have; add them, or \"*\" (first "
		"in line 3: \"lime\")|of these 2: \"lime\"|1 key of the map fit no row: \"gone\"" },
	{ NULL, "", "x,y\n", "", "", "it has no rows" },
	{ "species_fit_exactly_before_by_wildcard_before_by_fallback", "", species_csv, "'species':'s',"
		"'map':{'Quercus robur':'oak','Quercus*':'ash','Quercus robur*':'elm','*':null}",
		"oak 1 0 / oak 2 0 / ash 3 0 / elm 4 0", "6 rows, 4 plants|2  left out by the map: * "
		"(first in line 6: \"Tilia\")" },
	{ NULL, "", species_csv, "'species':'s','map':{'*':'oak','':null,'*robur*':null}",
		"oak 3 0 / oak 5 0", "3  left out by the map: *robur* (first in line 2" },
	{ NULL, "", "s,x,y\nASH,1,1\noak,2,2\n", "'species':'s'", "ash 1 1 / oak 2 2",
		"1 key of the map fit no row: \"elm\"" },
	{ NULL, "", "Baumart;x;y\nB\xc3\xa4renfichte;1;1\nB\xe4" "renfichte;2;2\n",
		"'species':'Baumart','map':{'BÄRENFICHTE':'oak'}", "oak 1 1 / oak 2 2",
		"not UTF-8 (first in line 3)" },
	{ NULL, "", species_csv, "'species':'s','map':{'Tilia':'oak','tilia ':'ash'}", NULL,
		"are one species" },
	{ "only_and_skip_leave_rows_out", "", filters_csv, "'only':{'status':'Alive'}", "oak 1 1 / oak 4 4",
		"3  left out: \"status\" is none of \"only\" (first in line 3: \"Stump\")" },
	{ NULL, "", filters_csv, "'skip':{'status':['D*',''],'dbh':0}", "oak 1 1", "2  left out: \"skip\" "
		"of \"status\" (first in line 4: \"dead\")|2  left out: \"skip\" of \"dbh\" (first in "
		"line 3: \"0\")" },
	{ "decimal_commas_are_asked_for_and_read", "", commas_csv, "", NULL,
		":2: \"1,5\" has a decimal comma; add \"decimal\": \",\"" },
	{ NULL, "", "x;y;h\n1;2;\n1;2;12,500 m\n", "'height_m':{'column':'h'}", NULL,
		":3: \"12,500 m\" has a comma; add \"decimal\": \",\"" },
	{ NULL, UTM32, "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\","
		"\"geometry\":{\"type\":\"Point\",\"coordinates\":[11.5,48.1]},\"properties\":{\"h\":\"7,500 "
		"m\"}}]}", "'height_m':{'column':'h'}", NULL, ".geojson, feature 1: \"7,500 m\" has a comma" },
	{ NULL, "", "x;y;h\n1;2;3\n1;3;12,500\n", "'height_m':{'column':'h'}", "oak 1 2 h3 / oak 1 3",
		"(first in line 3: \"12,500\")" },
	{ NULL, "", commas_csv, "'decimal':',','height_m':{'column':'h'}",
		"oak 1.5 2.25 h12.5 / oak 1234.5 3 h4", "separated by \";\"" },
	{ "thousands_are_parted_where_the_entry_says_so", "", "x;y\n691,234;334,000\n", "", NULL,
		"or \"thousands\": \",\" if it parts thousands" },
	{ NULL, "", "x;y;h\n691,234;5,334,000.5;2.5\n20;1 234;4\n",
		"'thousands':',','height_m':{'column':'h'}", "oak 691234 5334000.5 h2.5 / oak 20 1234 h4",
		"separated by \";\"" },
	{ NULL, "", "x;y\n1.234;5.334.000,5\n", "'thousands':'.'", "oak 1234 5334000.5",
		"separated by \";\"" },
	{ "units_of_coordinates_are_honoured_or_asked_for", "", "x_cm,y_cm\n150,200\n",
		"'x':'x_cm','y':'y_cm'", NULL, "\"x_cm\" and \"y_cm\" say cm, and coordinates without a "
		"CRS are in metres; add \"unit\": \"cm\"" },
	{ NULL, "", "x_cm,y_cm\n150,200\n", "'unit':'cm','x':'x_cm','y':'y_cm'", "oak 1.5 2", "" },
	{ NULL, "", "X (ft),Y (ft)\n10,20\n", "'unit':'ft','x':'X (ft)','y':'Y (ft)'", "oak 3.048 6.096",
		"" },
	{ NULL, "", "x_cm,y_cm\n150,200\n", "'unit':'m','x':'x_cm','y':'y_cm'", "oak 150 200", "" },
	{ NULL, "", "east_m,north_m\n150,200\n", "'x':'east_m','y':'north_m'", "oak 150 200", "" },
	{ NULL, UTM32, "x_ft,y_ft\n690010,5335020\n", "'crs':'EPSG:25832','x':'x_ft','y':'y_ft'", "oak 10 20",
		"" },
	{ "azimuths_and_distances_count_from_the_plots_centre", "", "az,d\n0,10\n90,20\n270,5\n,3\n",
		"-'polar':{'azimuth':'az','distance':'d'}", "oak 0 10 / oak 20 0 / oak -5 0",
		"no coordinates" },
	{ NULL, "", "az,d\n100,10\n200,20\n", "-'polar':{'azimuth':'az','distance':'d','whole_turn':400,"
		"'unit':'ft'}", "oak 3.048 0 / oak 0 -6.096", "" },
	{ NULL, UTM32, "x,y,az,d\n690100,5335100,180,10\n690200,5335100,90,10\n",
		"'polar':{'azimuth':'az','distance':'d'}", "oak 100 90 / oak 210 100", "" },
	{ "x_and_y_may_count_within_quadrats", "", "q,x,y\n0000,1,2\n0512,1.5,2.5\n512,1,2\n3,0,0\n05x2,1,"
		"1\n,1,1\n", "'quadrat':{'column':'q','size_m':20}",
		"oak 1 2 / oak 101.5 242.5 / oak 101 242 / oak 0 60", "05x2|no coordinates" },
	{ NULL, "", "q,x,y\n0102,100,200\n", "'unit':'cm','quadrat':{'column':'q','size_m':10}", "oak 11 22",
		"" },
	/* 3 degrees east is the central meridian of UTM zone 31, easting 500000 */
	{ "coordinates_become_metres_from_the_origin", "\"crs\":\"EPSG:32631\",\"origin\":[499000,-1000,40],",
		"x,y,z\n3,0,100\n", "'crs':'EPSG:4326','z':'z'", "oak 1000 1000 z60",
		"neither says a vertical datum" },
	/* the same CRS is not converted at all */
	{ NULL, "\"crs\":\"EPSG:32631\",\"origin\":[499000,-1000,40],", "x,y\n499010.12345,-990\n",
		"'crs':'epsg:32631'", "oak 10.12345 10", "1 row, 1 plant" },
	/* easting or longitude is first, whatever the authority says: Gauss-Krueger has northing first */
	{ NULL, "\"crs\":\"EPSG:31467\",\"origin\":[3500000,5300000,0],", "x,y\n3500010,5300020\n",
		"'crs':'EPSG:31467'", "oak 10 20", "1 plant" },
	/* feet of a survey */
	{ NULL, "\"crs\":\"EPSG:26918\",\"origin\":[0,0,0],", "x,y\n1000000,1000000\n", "'crs':'EPSG:2261'",
		"oak 425189.586 4732642.79", "1 plant" },
	{ NULL, UTM32, "x,y\n0,0\n200,95\n690001,5335001\n", "'crs':'EPSG:25832'",
		"oak -689800 -5334905 / oak 1 1", "left out: no coordinates (first in line 2: \"0, 0\")" },
	{ "a_crs_is_never_guessed", UTM32, plain_csv, "", NULL, "look like degrees, but EPSG:25832" },
	{ NULL, "", plain_csv, "'crs':'EPSG:4326'", NULL, "the scene has no CRS to convert to: add \"crs\"" },
	{ NULL, "\"crs\":\"EPSG:4326\",\"origin\":[0,0],", plain_csv, "'crs':'EPSG:4326'", NULL,
		"not one in metres; take a projected one" },
	{ NULL, "\"crs\":\"EPSG:2261\",\"origin\":[0,0],", plain_csv, "'crs':'EPSG:2261'", NULL,
		"not one in metres" },
	{ NULL, "\"crs\":\"EPSG:99999999\",\"origin\":[0,0],", plain_csv, "'crs':'EPSG:4326'", NULL,
		"is not known; write a code" },
	{ NULL, UTM32, plain_csv, "'crs':'EPSG:99999999'", NULL, "PROJ does not know it; write a code" },
	{ NULL, UTM32, plain_csv, "'crs':'ENGCRS[\\'plan\\',EDATUM[\\'d\\'],CS[Cartesian,2],AXIS[\\'x\\',"
		"east],AXIS[\\'y\\',north],LENGTHUNIT[\\'metre\\',1]]'", NULL, "no place on Earth" },
	{ NULL, "", "lon,lat\n11.5,48.1\n", "'x':'lon','y':'lat'", NULL, "in its entry (ecopack start: "
		"--crs EPSG:4326), and \"crs\": \"EPSG:32632\" (their UTM zone)" },
	{ "a_file_that_says_its_crs_needs_no_more", UTM32, FEATURES("", FEATURE("11.5", "48.1")), "",
		"oak -3878.244 -4561.87", "1 row, 1 plant" },
	{ NULL, UTM32, FEATURES(SAYS("urn:ogc:def:crs:EPSG::25832"), FEATURE("690001", "5335002")), "",
		"oak 1 2", "1 plant" },
	/* what the entry says wins, aloud */
	{ NULL, UTM32, FEATURES("", FEATURE("690001", "5335002")), "'crs':'EPSG:25832'", "oak 1 2",
		"the file says CRS \"EPSG:4326\", its entry says \"EPSG:25832\": the entry's is taken" },
	{ NULL, UTM32, FEATURES("", FEATURE("690001", "5335002")), "", NULL, "cannot be degrees, which "
		"this format means unless it says otherwise; add \"crs\": \"EPSG:25832\"" },
	{ NULL, "", FEATURES("", FEATURE("11.5", "48.1")), "", NULL, "the scene has no CRS; add \"crs\"" },
	{ NULL, UTM32, "x,y\n690001,5335002\n", "'crs':'EPSG:25832','layer':'trees'", "oak 1 2",
		"it is one table; \"layer\" says nothing" },
	/* one absurd place is one absurd row */
	{ NULL, UTM32,
		FEATURES("", FEATURE("999", "999") "," FEATURE("11.5", "48.1") "," FEATURE("11.5", "48.1")),
		"'duplicates':'skip'", "oak -3878.244 -4561.87",
		"left out: not convertible to the scene's CRS (first in feature 1: \"999, 999" },
	/* columns win over the geometry */
	{ NULL, "", "{\"type\":\"Feature\",\"properties\":{\"e\":3,\"n\":4.5},\"geometry\":null}",
		"'x':'e','y':'n'", "oak 3 4.5", "1 plant" },
	{ NULL, UTM32,
		FEATURES("", "{\"type\":\"Feature\",\"properties\":{},\"geometry\":null}," FEATURE("1e30", "3") "," "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"LineString\"," "\"coordinates\":[[1,2],[3,4]]}}," FEATURE("11.5", "48.1")),
		"'crs':'EPSG:4326'", "oak -3878.244 -4561.87", "1  left out: no geometry (first in "
		"feature 1)|not a point (areas with many plants: see \"scatter\") (first in feature 3: "
		"\"Line String\")|not convertible to the scene's CRS (first in feature 2: \"1e+30, 3" },
	{ "heights_of_places_need_one_datum_or_two_that_are_known", UTM32, datums_csv,
		"'z':'z','crs':'EPSG:25832'", "oak 1 2 z512.5",
		"neither says a vertical datum; if they differ, add \"vertical\"" },
	{ NULL, UTM32 "\"vertical\":\"EPSG:7837\",", datums_csv,
		"'z':'z','crs':'EPSG:25832','vertical':'EPSG:7837'", "oak 1 2 z512.5", "1 plant" },
	{ NULL, UTM32, datums_csv, "'z':'z','crs':'EPSG:25832','vertical':'EPSG:7837'", NULL,
		"the scene's have none; add \"vertical\": \"EPSG:...\" to the scene" },
	{ NULL, UTM32 "\"vertical\":\"EPSG:7837\",", datums_csv, "'z':'z','crs':'EPSG:25832'", NULL,
		"these (z) have none; add \"vertical\": \"EPSG:...\" to its entry" },
	{ NULL, UTM32 "\"vertical\":\"ellipsoid\",", datums_csv,
		"'z':'z','crs':'EPSG:25832','vertical':'EPSG:7837'", NULL,
		"between the two vertical datums: it lacks " },
	{ NULL, UTM32 "\"vertical\":\"EPSG:6360\",", datums_csv,
		"'z':'z','crs':'EPSG:25832','vertical':'EPSG:7837'", NULL,
		"does not count in metres, as scenes do; take its twin in metres" },
	{ NULL, UTM32 "\"vertical\":\"sea\",", datums_csv, "'z':'z','crs':'EPSG:25832',"
		"'vertical':'EPSG:7837'", NULL, "not a vertical datum that PROJ knows; write a code" },
	{ NULL, "\"crs\":\"EPSG:25832+7837\",\"origin\":[690000,5335000,500],", datums_csv,
		"'z':'z','crs':'EPSG:25832','vertical':'EPSG:7837'", "oak 1 2 z12.5", "1 plant" },
	{ NULL, UTM32,
		FEATURES(SAYS("EPSG:25832"), "{\"type\":\"Feature\",\"properties\":{}," "\"geometry\":{\"type\":\"Point\"," "\"coordinates\":[690001,5335002,7]}}"),
		"'z':'geometry'", "oak 1 2 z7", "neither says a vertical datum" },
	{ NULL, UTM32, FEATURES("", FEATURE("11.5", "48.1")), "'z':'geometry'", NULL,
		"its points have no heights; leave \"z\" out" },
	{ "doubtful_places_are_said", "", "x,y\n1,1\n2,2\n1,1\n1.0004,1\n", "",
		"oak 1 1 / oak 2 2 / oak 1 1 / oak 1.0004 1", "2  kept: at the place of an earlier plant, "
		"to the millimetre (\"duplicates\": \"skip\" leaves them out) (first in line 4: \"1.000, "
		"1.000\")" },
	{ NULL, "", "x,y\n1,1\n2,2\n1,1\n", "'duplicates':'skip'", "oak 1 1 / oak 2 2",
		"1  left out: at the place of an earlier plant" },
	{ NULL, "", "x,y\n5,6\n5,6\n", "", "oak 5 6 / oak 5 6",
		"all of them stand at one point; are x, y the right columns?" },
	{ NULL, "", "x,y\n.1,0\n.2,0\n.3,0\n.4,0\n.5,0\n.6,0\n.7,0\n.8,0\n.9,0\n.95,0\n", "", "oak 0.1 0 / "
		"oak 0.2 0 / oak 0.3 0 / oak 0.4 0 / oak 0.5 0 / oak 0.6 0 / oak 0.7 0 / oak 0.8 0 / oak "
		"0.9 0 / oak 0.95 0", "stand within a metre; are x, y in degrees?" },
	{ NULL, UTM32, "lat,lon\n48.1,11.5\n", "'crs':'EPSG:4326','x':'lat','y':'lon'",
		"oak 4415127.69 -3707671.88", "and would be near it with their coordinates swapped: x is "
		"easting or longitude" },
	{ NULL, UTM32, "x,y\n690000,5335000\n", "'crs':'EPSG:25829'", "oak -1337412.34 113372.818",
		"and more from the scene's origin; are x, y, crs" },
	{ NULL, UTM32, "x,y\n11°30'00O,48°06'N\n", "'crs':'EPSG:4326'", NULL,
		"minutes and seconds are read as 48° 8' 15\" N, with N, S, E or W; or export decimals" },
	{ "heights_come_from_the_first_source_that_has_one", "", sources_csv, "'height_m':[{'column':'h',"
		"'unit':'ft'},{'from_dbh':'d','unit':'mm','max':35,'rate':0.004},7]", "oak 1 1 h3.81 / oak "
		"2 2 h7.772 / oak 3 3 h12.41 / oak 4 4 h7 / oak 5 5 h30.785 / oak 6 6 h12.192 / oak 7 7 h9 /"
		" oak 8 8 h7", "1  kept: a size as a range, its middle is taken (first in line 3: \"21 to "
		"30\")|1  kept: a size as a bound, the bound is taken (first in line 6: \"> 101\")|1  "
		"kept: a size with a unit of its own, which counts (first in line 8: \"9 m\")|1  kept: a "
		"size that is not understood, the next source or the plant's own is taken (first in line "
		"5: \"-1\")" },
	{ NULL, "", sources_csv, "'height_m':{'column':'d','unit':'cm'}",
		"oak 1 1 h3 / oak 2 2 h3 / oak 3 3 h1 / oak 4 4 / oak 5 5 / oak 6 6 / oak 7 7 / oak 8 8",
		"5  kept at their plant's own height: the row says no usable one (first in line 5)" },
	{ NULL, "", sources_csv, "'height_m':9.5,'only':{'h':'0'}", "oak 8 8 h9.5", "1 plant" },
	{ "allometry_may_differ_by_plant", "", trunks_csv, "'species':'s','height_m':{'from_dbh':'d',"
		"'unit':'mm','max':35,'rate':0.004,'per_plant':{'ash':{'max':21.3,'rate':0.01,'shape':2}}}",
		"oak 1 1 h12.41 / ash 2 2 h9.292 / elm 3 3 h12.41", "3 plants" },
	{ NULL, "", trunks_csv, "'species':'s','height_m':{'from_girth':'g','unit':'cm',"
		"'per_plant':{'oak':{'max':35,'rate':0.004}}}", "oak 1 1 h12.41 / ash 2 2 / elm 3 3",
		"2  kept at their plant's own height" },
	{ NULL, "", trunks_csv, "'species':'s','height_m':{'from_dbh':'d','max':35,'rate':0.004}", NULL,
		"\"unit\" is missing: one of" },
	{ NULL, "", trunks_csv, "'species':'s','height_m':{'from_dbh_cm':'d','max':35}", NULL,
		"needs \"max\" (m) and \"rate\" (per mm)" },
	{ "crowns_and_scales_are_handed_on", "", crowns_a_csv,
		"'crown_m':{'column':'k','is':'diameter'},'scale':'s','height_m':{'column':'h'}",
		"oak 1 1 h10 c4 s2 / oak 2 2 c2.5 / oak 3 3", "1  kept, scaled to their crown: no usable "
		"height (first in line 3)|1  kept at their plant's own height" },
	{ NULL, "", crowns_a_csv, "'crown_m':{'column':'k'}", NULL, "\"is\"" },
	{ NULL, "", "x,y,k,b\n1,1,12.566,\n2,2,,6 x 8 m\n", "'crown_m':{'column':'k','is':'area'}", "oak 1 1 c2 / oak 2 2", "2 plants" },
	{ NULL, "", "x,y,k\n2,2,6 x 8 m\n", "'crown_m':{'column':'k','is':'diameter'}", "oak 2 2 c3.5", "1 plant" },
	{ "implausible_sizes_are_said", "", "x,y,h,d\n1,1,200,\n2,2,,50000\n3,3,900,\n",
		"'height_m':[{'column':'h'},{'from_dbh_cm':'d','max':35,'rate':0.004}]",
		"oak 1 1 h200 / oak 2 2 / oak 3 3", "1  kept at a size that no plant reaches: a "
		"height > 116 m or a crown > 60 m; is \"unit\" another? (first in line 2: "
		"\"200\")|2  kept at another size: a height below 0.01 or "
		"above 300 m, a trunk above 12 m or a crown above 100 m is not used; is \"unit\" another? (first in line 3: "
		"\"50000\")|2  kept at their plant's own height: the "
		"row says no usable one" },
	{ "ages_and_species_give_sizes", "", "s,x,y,a,p,r,q\noak,1,1,30,,2,4\noak,2,2,,1996-04-01,,\noak,3,3,,,,6\n",
		"'species':'s','height_m':[{'from_age':'a','max':20,'rate':0.02},"
		"{'from_year':'p','now':2026,'by':'species'}],'crown_m':{'column':['r','q'],'is':'radius',"
		"'otherwise':'species'}", "oak 1 1 h9.847 c3 / oak 2 2 h17.131 c6.981 / oak 3 3 c6",
		"heights: 2 by age, 1 as the model; crowns: 2 measured, 1 guessed" },
	{ "several_stems_are_one_trunk", "", "x,y,d\n1,1,12;15;9\n2,2,20+18 cm\n3,3,3x10\n4,4,21.213\n",
		"'height_m':{'from_dbh_cm':'d','max':35,'rate':0.004}",
		"oak 1 1 h20.575 / oak 2 2 h23.513 / oak 3 3 h18.144 / oak 4 4 h20.575", "3  kept: several stems in a field" },
	{ NULL, "", "x,y,h,d\n1,1,12,\n2,2,510.0,20\n3,3,510,\n4,4,.001,\n",
		"'height_m':[{'column':'h'},{'from_dbh_cm':'d','max':35,'rate':0.004},11]",
		"oak 1 1 h12 / oak 2 2 h19.858 / oak 3 3 h11 / oak 4 4 h11", "3  kept at another size: a "
		"height below 0.01 or above 300 m, a trunk above 12 m or a crown above 100 m is not used; is \"unit\" "
		"another? (first in line 3: \"510.0\")" },
	{ NULL, "", "x,y,h,k\n1,1,N/A,900\n2,2,old,8\n", "'crown_m':{'column':'k','is':'radius'},"
		"'height_m':[{'column':'h'}]", "oak 1 1 / oak 2 2 c8", "(first in line 2: \"900\")|1  kept: a size "
		"that is not understood, the next source or the plant's own is taken (first in line 3: \"old\")" },
	{ NULL, "", "x,y,h\n1,1,510\n", "'height_m':[{'column':'h'},11]", "oak 1 1 h11",
		"(first in line 2: \"510\")" },
	{ "an_entry_without_a_crs_is_in_the_scene_s", UTM32, "x,y\n690010,5335020\n", "", "oak 10 20", "" },
	{ NULL, UTM32, "what,where\na,POINT (690010 5335020)\n", "-", "oak 10 20", "" },
	{ NULL, UTM32, "x,y\n11.56,48.14\n", "", NULL, "such as 11.56, 48.14, look like degrees, but "
		"EPSG:25832 counts in metres or feet" },
	/* 0, 0 stands for no place */
	{ NULL, UTM32, "x,y\n0,0\n690010,5335020\n", "", "oak 10 20", "1  left out: no coordinates" },
	{ "latitude_and_longitude_swapped_are_no_silence", "\"crs\":\"EPSG:32610\",\"origin\":[525970,"
		"5040990],", "lat,lon\n45.52,-122.67\n45.53,-122.66\n",
		"'x':'lat','y':'lon','crs':'EPSG:4326'", NULL, "none of its 2 places can be converted, "
		"such as 45.52, -122.67; swapped they stand 0 km from the scene's origin: x is easting or "
		"longitude, y is northing or latitude; add \"x\": \"lon\", \"y\": \"lat\"" },
	{ "degrees_in_a_crs_of_metres_are_refused", UTM32, degrees_csv, "'crs':'EPSG:25832'", NULL,
		"such as 8.61, 50.1, look like degrees, but EPSG:25832 counts in metres or "
		"feet: all plants would stand on one spot; if they are longitude and latitude, say" },
	{ NULL, UTM32, "x,y\n50.1,8.61\n50.11,8.62\n", "'crs':'EPSG:25832'", NULL, "look like degrees" },
	{ NULL, UTM32, degrees_csv, "'crs':'EPSG:3857'", NULL, "look like degrees" },
	{ NULL, UTM32, degrees_csv, "'crs':'EPSG:2263'", NULL, "look like degrees" },
	{ NULL, UTM32, FEATURES(SAYS("urn:ogc:def:crs:EPSG::25832"), FEATURE("8.61", "50.1")), "", NULL,
		"look like degrees, but EPSG:25832" },
	/* one bad row does not refuse the others; a map of its own around the plot has such numbers */
	{ NULL, UTM32, "x,y\n690001,5335002\n8.61,50.1\n", "'crs':'EPSG:25832'",
		"oak 1 2 / oak -689991.39 -5334949.9", "2 plants" },
	{ NULL, "\"crs\":\"+proj=tmerc +lat_0=48.1 +lon_0=11.5 +type=crs\",\"origin\":[0,0,0],",
		"x,y\n8.5,50.25\n-20,3.5\n", "'crs':'+proj=tmerc +lat_0=48.1 +lon_0=11.5 +type=crs'",
		"oak 8.5 50.25 / oak -20 3.5", "2 plants" },
	{ "swapped_places_are_compared_with_the_area_of_use",
		"\"crs\":\"EPSG:32639\",\"origin\":[400990,951020,0],", "lat,lon\n50.1,8.6\n",
		"'crs':'EPSG:4258','x':'lat','y':'lon'", "oak -22.776 -273.92", "outside the area of use "
		"of its CRS, EPSG:4258 (longitude -16.1 to 40.18, latitude 32.88 to 84.73), and inside "
		"with their coordinates swapped" },
	/* a German register: semicolons, decimal commas, umlauts in Latin-1 */
	{ "inventories_of_many_countries_go_through", "\"crs\":\"EPSG:25833\",\"origin\":[390000,5820000,0],",
		"BAUM_NR;Gattung_Deutsch;Rechtswert;Hochwert;H\xf6he (m);Kronendurchmesser;Stammumfang "
		"cm\r\n\"0001\";Linde;390001,25;5820002,5;12,5;8,0;120\r\n\"0002\";Eiche;390.010,"
		"00;5.820.020,75;k.A.;;99\r\n\"0003\";;;;;;\r\n", "'x':'Rechtswert','y':'Hochwert',"
		"'crs':'EPSG:25833','decimal':',','species':'Gattung_Deutsch','map':{'linde':'ash',"
		"'EICHE':'oak'},'height_m':[{'column':'Höhe (m)'},{'from_girth':'Stammumfang cm','unit':'cm',"
		"'max':30,'rate':0.005}],'crown_m':{'column':'Kronendurchmesser','is':'diameter'}", "ash 1.25 2.5 h12.5 c4 / oak 10 20.75 h24.063",
		"3 rows, 2 plants|Windows-1252|1  left out: 1 species that the map does not have" },
	/* a census: trunk diameters in inches, a state of each tree, degrees */
	{ NULL, "\"crs\":\"EPSG:32618\",\"origin\":[583960,4507523,0],", "created_at,tree_id,tree_dbh,"
		"stump_diam,status,spc_latin,latitude,longitude\n08/27/2015,1,3,0,Alive,Acer rubrum,"
		"40.72309177,-73.84421522\n09/03/2015,2,0,7,Stump,,40.79411067,-73.81867946\n09/05/2015,3,"
		"21,0,Dead,,40.71758074,-73.9366077\n", "'x':'longitude','y':'latitude','crs':'EPSG:4326',"
		"'only':{'status':'Alive'},'species':'spc_latin','map':{'Acer*':'ash','*':'oak'},"
		"'height_m':{'from_dbh_in':'tree_dbh','max':30,'rate':0.004}", "ash 13649.938 1137.705 h8.84",
		"3 rows, 1 plant|2  left out: \"status\" is none of \"only\" (first in line 3: \"Stump\")" },
	/* an export of a GIS: a byte order mark, OBJECTID, X and Y in feet */
	{ NULL, "\"crs\":\"EPSG:26918\",\"origin\":[427000,4740000,0],",
		"\xef\xbb\xbfOBJECTID,Common_Nam,DBH,X,Y\n1,\"Maple, red\",12,1000000.5,1000000.25\n",
		"'x':'X','y':'Y','crs':'EPSG:2261','species':'Common_Nam','map':{'maple,*':'ash'}",
		"ash -1810.26 -7357.141", "1 row, 1 plant" },
	/* observations of naturalists: many columns, some without a place */
	{ NULL, UTM32, "id,observed_on,quality_grade,latitude,longitude,positional_accuracy,scientific_name,"
		"description\n1,2023-05-01,research,48.1,11.5,5,Quercus robur,\"old tree,\nby the lake\"\n2,"
		"2023-05-02,casual,,,,Tilia cordata,\n", "'x':'longitude','y':'latitude','crs':'EPSG:4326',"
		"'species':'scientific_name','map':{'*':'oak'},'skip':{'quality_grade':'needs_id'}",
		"oak -3878.244 -4561.87", "2 rows, 1 plant|1  left out: no coordinates (first in line 4)" },
	/* a city's open data: one text for both coordinates is beside real columns and does no harm */
	{ NULL, UTM32, "geo_point_2d;GENRE;HAUTEUR (m);x;y\n\"48.1, 11.5\";Platanus;12;690001;5335002\n",
		"'crs':'EPSG:25832','species':'GENRE','map':{'*':'oak'},'height_m':{'column':'HAUTEUR (m)'}",
		"oak 1 2 h12", "separated by \";\"" },
};

static void check(const char *name, const char *scene, const char *text, const char *entry, const char *plants,
	const char *says)
{
	bool csv = text[0] != '{';
	const char *file = csv ? "rows.csv" : "rows.geojson";
	input_text("positions", file, text);
	const struct inventory *in = inventory_of("positions", scene, file, entry_of(entry, csv));
	if (plants ? in->error[0] != 0 || strcmp(in->plants, plants) != 0 : !strstr(in->error, says))
		fail_msg("%s: %s: %s%s\n  wanted %s", name, text, in->error, in->plants, plants ? plants : says);
	if (plants)
		check_report(in, says);
}

UNIT_TEST(inventories_become_plants_or_questions)
{
	const char *name = NULL;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		name = cases[i].name ? cases[i].name : name;
		check(name, cases[i].scene, cases[i].text, cases[i].entry, cases[i].plants, cases[i].says);
	}
}

static void expect_species(const char *file, const char *text, const char *entry, const char *species)
{
	input_text("positions", file, text);
	const struct inventory *in = inventory_of("positions", UTM32, file, entry);
	assert_string_equal(in->error, "");
	assert_string_equal(in->species, species);
}

/* As the file has it, whatever the map leads it to; what nobody could read, or would rather not, is not there. */
UNIT_TEST(a_row_says_its_own_species)
{
	static const char mapped[] = "\"species\":\"s\",\"map\":{\"oak\":\"oak\",\"*\":\"elm\"},\"crs\":"
		"\"EPSG:25832\"," XY;
	char csv[700], long_name[256], want[600];
	expect_species("rows.csv", "s,x,y\n OAK ,1,1\ncards-3,2,1\n,3,1\nn/a,4,1\n?,5,1\n", mapped,
		"OAK / cards-3 /  /  / ");
	expect_species("rows.csv", "s,x,y\noak,1,1\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25832\"," XY, "-");
	expect_species("rows.csv", "s,x,y\n\"a\tb\x01\x7f\nc\xc2\x85\",1,1\n\"\x02\",2,1\nB\xe4um,3,1\n", mapped,
		"a b   c   /  / B\xc3\xa4um");
	snprintf(long_name, sizeof long_name, "%0253d", 0);
	snprintf(csv, sizeof csv, "s,x,y\n%s\xc3\xa9t\xc3\xa9,1,1\n%sx\xe2\x82\xac,2,1\n", long_name, long_name);
	snprintf(want, sizeof want, "%s\xc3\xa9 / %sx", long_name, long_name);
	expect_species("rows.csv", csv, mapped, want);
	expect_species("rows.geojson", "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\","
		"\"properties\":{\"s\":\"a\xff\u202e\"},\"geometry\":{\"type\":\"Point\",\"coordinates\":[11.5,48.1]}},"
		"{\"type\":\"Feature\",\"properties\":{\"s\":null},\"geometry\":{\"type\":\"Point\","
		"\"coordinates\":[11.5,48.2]}}]}", "\"species\":\"s\",\"map\":{\"*\":\"elm\"}", "a?    / ");
}

UNIT_TEST(the_commonest_unknown_species_are_named)
{
	char csv[8000] = "s,x,y\n";
	size_t used = strlen(csv);
	for (int kind = 0; kind < 8; kind++)
		for (int i = 0; i <= kind; i++)
			used += (size_t)snprintf(csv + used, sizeof csv - used, "kind %d,%d,%d\n", kind, kind,
				i);
	check("unknown", "", csv, "'species':'s'", "", "36  left out: 8 species|of these 8: \"kind 7\"|of these 7: "
		"\"kind 6\"|of these 4: \"kind 3\"");
	assert_null(strstr(inventory_of("positions", "", "rows.csv", "\"species\":\"s\"," XY)->report,
		"kind 2\"\n"));
}

UNIT_TEST(levels_keep_the_tall_few_and_the_relative_error)
{
	char csv[20000] = "x,y,h\n", *at;
	double seen[64];
	uint32_t count = 0, rows = 0;
	size_t used = strlen(csv);
	const struct inventory *in;
	for (int i = 0; i < 300; i++)        /* many of 2 to 4 m, one in fifty of 20 to 32 m */
		used += (size_t)snprintf(csv + used, sizeof csv - used, "%d,1,%.2f\n", i,
			i % 50 == 0 ? 20 + i * 0.04 : 2 + (i * 7 % 200) * 0.01);
	input_text("positions", "rows.csv", csv);
	in = inventory_of("positions", "", "rows.csv", "\"plant\":\"oak\",\"levels\":6,"
		"\"height_m\":{\"column\":\"h\"}," XY);
	assert_string_equal(in->error, "");
	for (at = strstr(in->plants, " h"); at; at = strstr(at + 1, " h")) {
		int i = (int)rows++;
		double exact = i % 50 == 0 ? 20 + i * 0.04 : 2 + (i * 7 % 200) * 0.01,
			got = strtod(at + 2, NULL);
		uint32_t k = 0;
		assert_true(fabs(got / exact - 1) < 0.5);    /* one class spans 16^(1/6) = 1.59 */
		while (k < count && seen[k] != got)
			k++;
		if (k == count)
			seen[count++] = got;
	}
	assert_int_equal(rows, 300);
	assert_in_range(count, 3, 6);
	assert_non_null(strstr(in->report, "300 rows, 300 plants"));        /* though it was read twice */
}

static struct eco_positions *open_plain(struct eco_positions_spec *spec, const char *csv, uint64_t seed,
	const char *yaw)
{
	static const struct eco_frame plain;
	struct eco_positions *reader;
	*spec = (struct eco_positions_spec){ .path = (char *)input_text("positions", "turns.csv", csv),
		.x = (char *)"x", .y = (char *)"y",
		.fallback = { (char *)"*", 0, 3 }, .seed = seed, .yaw_deg = (char *)yaw };
	assert_int_equal(eco_positions_open(&reader, spec, &plain, NULL), ECO_OK);
	return reader;
}

UNIT_TEST(yaw_and_variant_are_the_seeds_and_the_rows_alone)
{
	static const char csv[] = "x,y,r\n1,1,90\n2,2,\n3,bad,\n4,4,\n";
	double first[3], again[3], other[3], *into[] = { first, again, other };
	struct eco_positions_spec spec;
	struct eco_positions *reader;
	struct eco_position record;
	for (int pass = 0; pass < 3; pass++) {
		reader = open_plain(&spec, csv, pass == 2 ? 8 : 7, NULL);
		for (int i = 0; i < 3; i++) {
			assert_int_equal(eco_positions_next(reader, &record, NULL), ECO_OK);
			assert_in_range(record.plant, 0, 2);
			assert_true(record.yaw_deg >= 0 && record.yaw_deg < 360);
			into[pass][i] = record.yaw_deg;
		}
		eco_positions_close(reader);
	}
	assert_memory_equal(first, again, sizeof first);
	assert_true(first[0] != other[0] && first[0] != first[1]);
	reader = open_plain(&spec, csv, 7, "r");
	assert_int_equal(eco_positions_next(reader, &record, NULL), ECO_OK);
	assert_true(record.yaw_deg == 90);
	assert_int_equal(eco_positions_next(reader, &record, NULL), ECO_OK);
	assert_true(record.yaw_deg == first[1]);
	eco_positions_close(reader);
}
