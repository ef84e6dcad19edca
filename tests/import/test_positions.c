/* Inventories as scenes ask for them: coordinates, species, filters, sizes, and what is said of rows that
 * cannot be used or were guessed at. Formats are tested in test_rows*.c, texts in test_inventory_text.c.
 * Longer than 600 lines: a case for each thing that is said of rows. */
#include "tests/support/inventory_scene.h"
#include "tests/support/unit_test.h"

#define UTM32 "\"crs\":\"EPSG:25832\",\"origin\":[690000,5335000,0],"
#define XY "\"x\":\"x\",\"y\":\"y\""

/* The report must hold each of `says`, parted by "|". */
static void check_report(const struct inventory *in, const char *says)
{
	char all[1000], *rest = all;
	snprintf(all, sizeof all, "%s", says);
	for (const char *one; (one = strsep(&rest, "|"));)
		if (!strstr(in->report, one))
			fail_msg("%s\n  wanted ... %s", in->report, one);
}

/* `plants` NULL: an error that holds `says`. */
static void expect_file(const char *file, const char *scene, const char *text, const char *entry,
	const char *plants, const char *says)
{
	const struct inventory *in;
	input_text("positions", file, text);
	in = inventory_of("positions", scene, file, entry);
	if (!plants) {
		if (!strstr(in->error, says))
			fail_msg("%s\n  wanted ... %s", in->error, says);
		return;
	}
	if (in->error[0] != 0)
		fail_msg("%s", in->error);
	assert_string_equal(in->plants, plants);
	check_report(in, says);
}

static void expect(const char *scene, const char *text, const char *entry, const char *plants,
	const char *says)
{
	expect_file("rows.csv", scene, text, entry, plants, says);
}

static void expect_error(const char *scene, const char *text, const char *entry, const char *says)
{
	expect_file("rows.csv", scene, text, entry, NULL, says);
}

static void expect_json(const char *scene, const char *text, const char *entry, const char *plants,
	const char *says)
{
	expect_file("rows.geojson", scene, text, entry, plants, says);
}

/* ---- Columns ---- */

UNIT_TEST(a_missing_column_is_named_beside_those_there_are)
{
	expect_error("", "X,y,h\n1,2,3\n", "\"plant\":\"oak\"," XY, "no column \"x\"; there are: X, y, h");
	expect_error("", "x;y\n1;2\n", "\"plant\":\"oak\",\"separator\":\",\"," XY,
		"is \"separator\" another?");
	expect_error("", "x,y,x\n1,2,3\n", "\"plant\":\"oak\"," XY, "two columns are named \"x\"");
	expect_error("", "Name;Rechtswert;Hochwert\na;1;2\n", "\"plant\":\"oak\"",
		"add \"x\": \"Rechtswert\", \"y\": \"Hochwert\"");
	expect_error("", "a,b\n1,2\n", "\"plant\":\"oak\"", "add \"x\": \"...\", \"y\": \"...\"; there are: "
		"a, b");
	expect_error("", "x,y\n1,2\n", "\"plant\":\"oak\",\"only\":{\"status\":\"Alive\"}," XY,
		"no column \"status\"");
	expect_error("", "x,y\n1,2\n", "\"plant\":\"oak\",\"height_m\":{\"column\":\"h\"}," XY,
		"no column \"h\"");
	expect_error("", "x,y\n1,2\n", "\"plant\":\"oak\",\"z\":\"geometry\"," XY, "no column \"geometry\"");
}

UNIT_TEST(rows_that_cannot_be_used_are_counted_by_reason)
{
	expect("", "sp,x,y\n" "oak,1,2\n" "lime,1,2\n" "oak,,2\n" "oak,1,NA\n" "oak,1,2m\n" "oak,0x10,2\n"
		"oak,nan,2\n" "stump,1,2\n" "oak,1\n"
		"oak,1e9,2\nlime,3,3\n" " Oak ,7,8\n", "\"species\":\"sp\",\"map\":{\"oak\":\"oak\","
		"\"stump\":null,\"gone\":null}," XY, "oak 1 2 / oak 7 8",
		"12 rows, 2 plants|3  left out: no coordinates (first in line 4)|2  left out: a coordinate "
		"that is not a number (first in line 6: \"2m\")|"
		"1  left out: more than 10,000 km|1  left out by the map: stump (first in line 9: "
		"\"stump\")|1  left out: too few fields (first in line 10: "
			"\"oak\")|2  left out: 1 species that the map does not have; add them, or \"*\" "
			"(first in line 3: \"lime\")|of these 2: \"lime\"|"
		"1 key of the map fit no row: \"gone\"");
	expect("", "x,y\n", "\"plant\":\"oak\"," XY, "", "it has no rows");
}

/* ---- Species ---- */

UNIT_TEST(species_fit_exactly_before_by_wildcard_before_by_fallback)
{
	static const char csv[] = "s,x,y\nQuercus robur,1,0\nquercus  ROBUR ,2,0\nQuercus "
		"rubra,3,0\nQuercus robur 'Fastigiata',4,0\nTilia,5,0\n,6,0\n";
	expect("", csv, "\"species\":\"s\",\"map\":{\"Quercus "
		"robur\":\"oak\",\"Quercus*\":\"ash\",\"Quercus robur*\":\"elm\",\"*\":null}," XY,
		"oak 1 0 / oak 2 0 / ash 3 0 / elm 4 0", "6 rows, 4 plants|2  left out by the map: * (first "
		"in line 6: \"Tilia\")");
	expect("", csv, "\"species\":\"s\",\"map\":{\"*\":\"oak\",\"\":null,\"*robur*\":null}," XY,
		"oak 3 0 / oak 5 0",
		"3  left out by the map: *robur* (first in line 2");
	expect("", "s,x,y\nASH,1,1\noak,2,2\n", "\"species\":\"s\"," XY, "ash 1 1 / oak 2 2",
		"1 key of the map fit no row: \"elm\"");
	expect("", "Baumart;x;y\nB\xc3\xa4renfichte;1;1\nB\xe4" "renfichte;2;2\n",
		"\"species\":\"Baumart\",\"map\":{\"BÄRENFICHTE\":\"oak\"}," XY,
		"oak 1 1 / oak 2 2", "not UTF-8 (first in line 3)");
	expect_error("", csv, "\"species\":\"s\",\"map\":{\"Tilia\":\"oak\",\"tilia \":\"ash\"}," XY,
		"are one species");
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
	expect("", csv, "\"species\":\"s\"," XY, "", "36  left out: 8 species|of these 8: \"kind 7\"|of "
		"these 7: \"kind 6\"|of these 4: \"kind 3\"");
	assert_null(strstr(inventory_of("positions", "", "rows.csv", "\"species\":\"s\"," XY)->report,
		"kind 2\"\n"));
}

UNIT_TEST(only_and_skip_leave_rows_out)
{
	static const char csv[] = "x,y,status,dbh\n1,1,Alive,5\n2,2,Stump,0\n3,3,dead "
		",12\n4,4,alive,0.0\n5,5,,7\n";
	expect("", csv, "\"plant\":\"oak\",\"only\":{\"status\":\"Alive\"}," XY, "oak 1 1 / oak 4 4",
		"3  left out: \"status\" is none of \"only\" (first in line 3: \"Stump\")");
	expect("", csv, "\"plant\":\"oak\",\"skip\":{\"status\":[\"D*\",\"\"],\"dbh\":0}," XY, "oak 1 1",
		"2  left out: \"skip\" of \"status\" (first in line 4: \"dead\")|2  left out: \"skip\" of "
		"\"dbh\" (first in line 3: \"0\")");
}

/* ---- Coordinates ---- */

UNIT_TEST(decimal_commas_are_asked_for_and_read)
{
	static const char csv[] = "x;y;h\n1,5;2,25;12,5\n1.234,5;3;4\n";

	expect_error("", csv, "\"plant\":\"oak\"," XY, ":2: \"1,5\" has a decimal comma; add \"decimal\": "
		"\",\"");
	expect_error("", "x;y;h\n1;2;\n1;2;12,5 m\n", "\"plant\":\"oak\",\"height_m\":{\"column\":\"h\"}," XY,
		":3: \"12,5 m\" has a comma; add \"decimal\": \",\"");
	expect_json(UTM32, "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\","
		"\"geometry\":{\"type\":\"Point\","
		"\"coordinates\":[11.5,48.1]},"
		"\"properties\":{\"h\":\"7,5 m\"}}]}", "\"plant\":\"oak\",\"height_m\":{\"column\":\"h\"}",
		NULL,
			".geojson, feature 1: \"7,5 m\" has a comma");
	expect("", "x;y;h\n1;2;3\n1;3;12,5\n", "\"plant\":\"oak\",\"height_m\":{\"column\":\"h\"}," XY,
		"oak 1 2 h3 / oak 1 3",
		"(first in line 3: \"12,5\")");
	expect("", csv, "\"plant\":\"oak\",\"decimal\":\",\",\"height_m\":{\"column\":\"h\"}," XY,
		"oak 1.5 2.25 h12.5 / oak 1234.5 3 h4",
		"separated by \";\"");
}

UNIT_TEST(thousands_are_parted_where_the_entry_says_so)
{
	expect_error("", "x;y\n691,234;334,000\n", "\"plant\":\"oak\"," XY, "or \"thousands\": \",\" if it parts thousands");
	expect("", "x;y;h\n691,234;5,334,000.5;2.5\n20;1 234;4\n", "\"plant\":\"oak\",\"thousands\":\",\",\"height_m\":"
		"{\"column\":\"h\"}," XY, "oak 691234 5334000.5 h2.5 / oak 20 1234 h4", "separated by \";\"");
	expect("", "x;y\n1.234;5.334.000,5\n", "\"plant\":\"oak\",\"thousands\":\".\"," XY, "oak 1234 5334000.5",
		"separated by \";\"");
}

UNIT_TEST(units_of_coordinates_are_honoured_or_asked_for)
{
	expect_error("", "x_cm,y_cm\n150,200\n", "\"plant\":\"oak\",\"x\":\"x_cm\",\"y\":\"y_cm\"",
		"\"x_cm\" and \"y_cm\" say cm, and coordinates without a CRS are in metres; add \"unit\": \"cm\"");
	expect("", "x_cm,y_cm\n150,200\n", "\"plant\":\"oak\",\"unit\":\"cm\",\"x\":\"x_cm\",\"y\":\"y_cm\"", "oak 1.5 2", "");
	expect("", "X (ft),Y (ft)\n10,20\n", "\"plant\":\"oak\",\"unit\":\"ft\",\"x\":\"X (ft)\",\"y\":\"Y (ft)\"",
		"oak 3.048 6.096", "");
	expect("", "x_cm,y_cm\n150,200\n", "\"plant\":\"oak\",\"unit\":\"m\",\"x\":\"x_cm\",\"y\":\"y_cm\"", "oak 150 200", "");
	expect("", "east_m,north_m\n150,200\n", "\"plant\":\"oak\",\"x\":\"east_m\",\"y\":\"north_m\"", "oak 150 200", "");
	expect(UTM32, "x_ft,y_ft\n690010,5335020\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25832\",\"x\":\"x_ft\",\"y\":\"y_ft\"",
		"oak 10 20", "");
}

UNIT_TEST(azimuths_and_distances_count_from_the_plots_centre)
{
	const char *turned = "\"plant\":\"oak\",\"polar\":{\"azimuth\":\"az\",\"distance\":\"d\"}";
	expect("", "az,d\n0,10\n90,20\n270,5\n,3\n", turned, "oak 0 10 / oak 20 0 / oak -5 0", "no coordinates");
	expect("", "az,d\n100,10\n200,20\n", "\"plant\":\"oak\",\"polar\":{\"azimuth\":\"az\",\"distance\":\"d\",\"whole_turn\":"
		"400,\"unit\":\"ft\"}", "oak 3.048 0 / oak 0 -6.096", "");
	expect(UTM32, "x,y,az,d\n690100,5335100,180,10\n690200,5335100,90,10\n", "\"plant\":\"oak\",\"polar\":{\"azimuth\":"
		"\"az\",\"distance\":\"d\"}," XY, "oak 100 90 / oak 210 100", "");
}

UNIT_TEST(x_and_y_may_count_within_quadrats)
{
	const char *entry = "\"plant\":\"oak\",\"quadrat\":{\"column\":\"q\",\"size_m\":20}," XY;
	expect("", "q,x,y\n0000,1,2\n0512,1.5,2.5\n512,1,2\n3,0,0\n05x2,1,1\n,1,1\n", entry,
		"oak 1 2 / oak 101.5 242.5 / oak 101 242 / oak 0 60", "05x2|no coordinates");
	expect("", "q,x,y\n0102,100,200\n", "\"plant\":\"oak\",\"unit\":\"cm\",\"quadrat\":{\"column\":\"q\",\"size_m\":10}," XY,
		"oak 11 22", "");
}

UNIT_TEST(coordinates_become_metres_from_the_origin)
{
	/* 3 degrees east is the central meridian of UTM zone 31, easting 500000 */
	expect("\"crs\":\"EPSG:32631\",\"origin\":[499000,-1000,40],", "x,y,z\n3,0,100\n",
		"\"plant\":\"oak\",\"crs\":\"EPSG:4326\",\"z\":\"z\"," XY,
		"oak 1000 1000 z60", "neither says a vertical datum");
	/* the same CRS is not converted at all */
	expect("\"crs\":\"EPSG:32631\",\"origin\":[499000,-1000,40],", "x,y\n499010.12345,-990\n",
		"\"plant\":\"oak\",\"crs\":\"epsg:32631\"," XY,
		"oak 10.12345 10", "1 row, 1 plant");
	/* easting or longitude is first, whatever the authority says: Gauss-Krueger has northing first */
	expect("\"crs\":\"EPSG:31467\",\"origin\":[3500000,5300000,0],", "x,y\n3500010,5300020\n",
		"\"plant\":\"oak\",\"crs\":\"EPSG:31467\"," XY,
		"oak 10 20", "1 plant");
	/* feet of a survey */
	expect("\"crs\":\"EPSG:26918\",\"origin\":[0,0,0],", "x,y\n1000000,1000000\n",
		"\"plant\":\"oak\",\"crs\":\"EPSG:2261\"," XY,
		"oak 425189.586 4732642.79", "1 plant");
	expect(UTM32, "x,y\n0,0\n200,95\n690001,5335001\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25832\"," XY,
		"oak -689800 -5334905 / oak 1 1",
		"left out: no coordinates (first in line 2: \"0, 0\")");
}

UNIT_TEST(a_crs_is_never_guessed)
{
	static const char csv[] = "x,y\n1,2\n", plain[] = "\"plant\":\"oak\"," XY;
	expect_error(UTM32, csv, plain, "\"crs\": \"EPSG:25832\"");
	expect_error("", csv, "\"plant\":\"oak\",\"crs\":\"EPSG:4326\"," XY,
		"the scene has no CRS to convert to: add \"crs\"");
	expect_error("\"crs\":\"EPSG:4326\",\"origin\":[0,0],", csv,
		"\"plant\":\"oak\",\"crs\":\"EPSG:4326\"," XY,
		"not one in metres; take a projected one");
	expect_error("\"crs\":\"EPSG:2261\",\"origin\":[0,0],", csv,
		"\"plant\":\"oak\",\"crs\":\"EPSG:2261\"," XY, "not one in metres");
	expect_error("\"crs\":\"EPSG:99999999\",\"origin\":[0,0],", csv,
		"\"plant\":\"oak\",\"crs\":\"EPSG:4326\"," XY, "is not known; write a code");
	expect_error(UTM32, csv, "\"plant\":\"oak\",\"crs\":\"EPSG:99999999\"," XY,
		"PROJ does not know it; write a code");
	expect_error(UTM32, csv, "\"plant\":\"oak\",\"crs\":\"ENGCRS[\\\"plan\\\",EDATUM[\\\"d\\\"],"
		"CS[Cartesian,2],AXIS[\\\"x\\\",east],AXIS[\\\"y\\\",north],"
		"LENGTHUNIT[\\\"metre\\\",1]]\"," XY, "no place on Earth");
	expect_error("", "lon,lat\n11.5,48.1\n", "\"plant\":\"oak\",\"x\":\"lon\",\"y\":\"lat\"",
		"are degrees, and the scene is in plain metres; add "
		"\"crs\": \"EPSG:4326\" to its entry, and \"crs\": \"EPSG:32632\"");
}

#define FEATURE(x, y) "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\"," \
	"\"coordinates\":[" x "," y "]}}"
#define FEATURES(crs, all) "{\"type\":\"FeatureCollection\"," crs "\"features\":[" all "]}"
#define SAYS(name) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" name "\"}},"

UNIT_TEST(a_file_that_says_its_crs_needs_no_more)
{
	expect_json(UTM32, FEATURES("", FEATURE("11.5", "48.1")), "\"plant\":\"oak\"",
		"oak -3878.244 -4561.87", "1 row, 1 plant");
	expect_json(UTM32, FEATURES(SAYS("urn:ogc:def:crs:EPSG::25832"), FEATURE("690001", "5335002")),
		"\"plant\":\"oak\"", "oak 1 2", "1 plant");
	/* what the entry says wins, aloud */
	expect_json(UTM32, FEATURES("", FEATURE("690001", "5335002")),
		"\"plant\":\"oak\",\"crs\":\"EPSG:25832\"", "oak 1 2",
		"the file says CRS \"EPSG:4326\", its entry says \"EPSG:25832\": the entry's is taken");
	expect_json(UTM32, FEATURES("", FEATURE("690001", "5335002")), "\"plant\":\"oak\"", NULL,
		"cannot be degrees, which this format means unless "
		"it says otherwise; add \"crs\": \"EPSG:25832\"");
	expect_json("", FEATURES("", FEATURE("11.5", "48.1")), "\"plant\":\"oak\"", NULL,
		"the scene has no CRS; add \"crs\"");
	expect(UTM32, "x,y\n690001,5335002\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25832\","
		"\"layer\":\"trees\"," XY, "oak 1 2",
		"it is one table; \"layer\" says nothing");
	/* one absurd place is one absurd row */
	expect_json(UTM32,
		FEATURES("", FEATURE("999", "999") "," FEATURE("11.5", "48.1") "," FEATURE("11.5", "48.1")),
		"\"plant\":\"oak\",\"duplicates\":\"skip\"",
		"oak -3878.244 -4561.87", "left out: not convertible to the scene's CRS (first in feature "
		"1: \"999, 999");
	/* columns win over the geometry */
	expect_json("", "{\"type\":\"Feature\",\"properties\":{\"e\":3,\"n\":4.5},\"geometry\":null}",
		"\"plant\":\"oak\",\"x\":\"e\",\"y\":\"n\"",
		"oak 3 4.5", "1 plant");
	expect_json(UTM32,
		FEATURES("", "{\"type\":\"Feature\",\"properties\":{},\"geometry\":null}," FEATURE("1e30",
		"3") ","
		"{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"LineString\","
		"\"coordinates\":[[1,2],[3,4]]}}," FEATURE("11.5", "48.1")),
		"\"plant\":\"oak\",\"crs\":\"EPSG:4326\"", "oak -3878.244 -4561.87",
		"1  left out: no geometry (first in feature 1)|not a point (areas with "
			"many plants: see \"scatter\") (first in feature 3: \"Line String\")|not "
			"convertible to the scene's CRS (first in feature 2: \"1e+30, 3");
}

UNIT_TEST(heights_of_places_need_one_datum_or_two_that_are_known)
{
	static const char csv[] = "x,y,z\n690001,5335002,512.5\n",
		entry[] = "\"plant\":\"oak\",\"z\":\"z\",\"crs\":\"EPSG:25832\"," XY;
	static const char with[] = "\"plant\":\"oak\",\"z\":\"z\",\"crs\":\"EPSG:25832\","
		"\"vertical\":\"EPSG:7837\"," XY;
	expect(UTM32, csv, entry, "oak 1 2 z512.5", "neither says a vertical datum; if they differ, add "
		"\"vertical\"");
	expect(UTM32 "\"vertical\":\"EPSG:7837\",", csv, with, "oak 1 2 z512.5", "1 plant");
	expect_error(UTM32, csv, with, "the scene's have none; add \"vertical\": \"EPSG:...\" to the scene");
	expect_error(UTM32 "\"vertical\":\"EPSG:7837\",", csv, entry,
		"these (z) have none; add \"vertical\": \"EPSG:...\" to its entry");
	expect_error(UTM32 "\"vertical\":\"ellipsoid\",", csv, with,
		"between the two vertical datums: it lacks ");
	expect_error(UTM32 "\"vertical\":\"EPSG:6360\",", csv, with,
		"does not count in metres, as scenes do; take its twin in metres");
	expect_error(UTM32 "\"vertical\":\"sea\",", csv, with, "not a vertical datum that PROJ knows; write "
		"a code");
	expect("\"crs\":\"EPSG:25832+7837\",\"origin\":[690000,5335000,500],", csv, with, "oak 1 2 z12.5",
		"1 plant");
	expect_json(UTM32, FEATURES(SAYS("EPSG:25832"), "{\"type\":\"Feature\",\"properties\":{},"
		"\"geometry\":{\"type\":\"Point\","
		"\"coordinates\":[690001,5335002,7]}}"), "\"plant\":\"oak\",\"z\":\"geometry\"", "oak 1 2 z7",
		"neither says a vertical datum");
	expect_json(UTM32, FEATURES("", FEATURE("11.5", "48.1")), "\"plant\":\"oak\",\"z\":\"geometry\"",
		NULL,
		"its points have no heights; leave \"z\" out");
}

UNIT_TEST(doubtful_places_are_said)
{
	expect("", "x,y\n1,1\n2,2\n1,1\n1.0004,1\n", "\"plant\":\"oak\"," XY,
		"oak 1 1 / oak 2 2 / oak 1 1 / oak 1.0004 1",
		"2  kept: at the place of an earlier plant, to the millimetre (\"duplicates\": \"skip\" "
		"leaves them out) (first in line 4: \"1.000, "
		"1.000\")");
	expect("", "x,y\n1,1\n2,2\n1,1\n", "\"plant\":\"oak\",\"duplicates\":\"skip\"," XY,
		"oak 1 1 / oak 2 2",
		"1  left out: at the place of an earlier plant");
	expect("", "x,y\n5,6\n5,6\n", "\"plant\":\"oak\"," XY, "oak 5 6 / oak 5 6",
		"all of them stand at one point; are x, y the right columns?");
	expect("", "x,y\n.1,0\n.2,0\n.3,0\n.4,0\n.5,0\n.6,0\n.7,0\n.8,0\n.9,0\n.95,0\n",
		"\"plant\":\"oak\"," XY,
		"oak 0.1 0 / oak 0.2 0 / oak 0.3 0 / oak 0.4 0 / "
		"oak 0.5 0 / oak 0.6 0 / oak 0.7 0 / oak 0.8 0 / oak 0.9 0 / oak 0.95 0",
		"stand within a metre; are x, y in degrees?");
	expect(UTM32, "lat,lon\n48.1,11.5\n", "\"plant\":\"oak\",\"crs\":\"EPSG:4326\",\"x\":\"lat\","
		"\"y\":\"lon\"", "oak 4415127.69 -3707671.88",
		"and would be near it with their coordinates swapped: x is easting or longitude");
	expect(UTM32, "x,y\n690000,5335000\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25829\"," XY,
		"oak -1337412.34 113372.818",
		"and more from the scene's origin; are x, y, crs");
	expect_error(UTM32, "x,y\n11°30'00O,48°06'N\n", "\"plant\":\"oak\",\"crs\":\"EPSG:4326\"," XY,
		"minutes and seconds are read as 48° 8' 15\" N, with N, S, E or W; or export decimals");
}

/* ---- Sizes ---- */

UNIT_TEST(heights_come_from_the_first_source_that_has_one)
{
	static const char csv[] = "x,y,h,d\n1,1,12.5,300\n2,2,21 to 30,300\n3,3,N/A,100\n4,4,-1,\n5,5,> "
		"101,\n6,6,40',\n7,7,9 m,\n8,8,0,NA\n";
	expect("", csv,
		"\"plant\":\"oak\",\"height_m\":[{\"column\":\"h\",\"unit\":\"ft\"},"
		"{\"from_dbh\":\"d\",\"unit\":\"mm\",\"max\":35,"
		"\"rate\":0.004},7]," XY,
		"oak 1 1 h3.81 / oak 2 2 h7.772 / oak 3 3 h12.41 / oak 4 4 h7 / oak 5 5 h30.785 / oak 6 6 "
		"h12.192 / oak 7 7 h9 / oak 8 8 h7",
		"1  kept: a size as a range, its middle is taken (first in line 3: \"21 to 30\")|1  kept: a "
		"size as a bound, the bound is taken (first in "
		"line 6: \"> 101\")|"
		"1  kept: a size with a unit of its own, which counts (first in line 8: \"9 m\")|1  kept: a "
		"size that is not understood, the next source or "
		"the plant's own is taken (first in line 5: \"-1\", which became 7 m, as for rows without a size)");
	expect("", csv, "\"plant\":\"oak\",\"height_m\":{\"column\":\"d\",\"unit\":\"cm\"}," XY,
		"oak 1 1 h3 / oak 2 2 h3 / oak 3 3 h1 / oak 4 4 / oak "
		"5 5 / oak 6 6 / oak 7 7 / oak 8 8", "5  kept at their plant's own height: the row says no "
		"usable one (first in line 5)");
	expect("", csv, "\"plant\":\"oak\",\"height_m\":9.5,\"only\":{\"h\":\"0\"}," XY, "oak 8 8 h9.5",
		"1 plant");
}

UNIT_TEST(allometry_may_differ_by_plant)
{
	static const char csv[] = "s,x,y,d,g\noak,1,1,100,31.4159265\nash,2,2,100,31.4159265\nelm,3,3,100,\n";
	expect("", csv, "\"species\":\"s\",\"height_m\":{\"from_dbh\":\"d\",\"unit\":\"mm\",\"max\":35,"
		"\"rate\":0.004,"
		"\"per_plant\":{\"ash\":{\"max\":21.3,\"rate\":0.01,\"shape\":2}}}," XY,
		"oak 1 1 h12.41 / ash 2 2 h9.292 / elm 3 3 h12.41", "3 plants");
	expect("", csv, "\"species\":\"s\",\"height_m\":{\"from_girth\":\"g\",\"unit\":\"cm\","
		"\"per_plant\":{\"oak\":{\"max\":35,\"rate\":0.004}}}," XY,
		"oak 1 1 h12.41 / ash 2 2 / elm 3 3", "2  kept at their plant's own height");
	expect_error("", csv, "\"species\":\"s\",\"height_m\":{\"from_dbh\":\"d\",\"max\":35,\"rate\":0.004}"
		"," XY, "\"unit\" is missing: one of");
	expect_error("", csv, "\"species\":\"s\",\"height_m\":{\"from_dbh_cm\":\"d\",\"max\":35}," XY,
		"needs \"max\" (m) and \"rate\" (per mm)");
}

UNIT_TEST(crowns_and_scales_are_handed_on)
{
	static const char csv[] = "x,y,k,s,h\n1,1,8 m,2,10\n2,2,4-6,0,\n3,3,,x,\n";
	expect("", csv, "\"plant\":\"oak\",\"crown_m\":{\"column\":\"k\",\"is\":\"diameter\"},"
		"\"scale\":\"s\",\"height_m\":{\"column\":\"h\"}," XY,
		"oak 1 1 h10 c4 s2 / oak 2 2 c2.5 / oak 3 3", "1  kept, scaled to their crown: no usable "
		"height (first in line 3)|1  kept at their plant's "
		"own height");
	expect_error("", csv, "\"plant\":\"oak\",\"crown_m\":{\"column\":\"k\"}," XY, "\"is\"");
}

UNIT_TEST(implausible_sizes_are_said)
{
	expect("", "x,y,h,d\n1,1,200,\n2,2,,50000\n3,3,900,\n",
		"\"plant\":\"oak\","
		"\"height_m\":[{\"column\":\"h\"},{\"from_dbh_cm\":\"d\",\"max\":35,"
		"\"rate\":0.004}]," XY,
		"oak 1 1 h200 / oak 2 2 h35 / oak 3 3",
		"2  kept at a size that no plant reaches: a height > 116 m, a trunk "
		"> 12 m or a crown > 60 m; is \"unit\" another? (first in line 2: \"200\", which became 200 m by "
		"\"h\")|1  kept at another size: a height below 0.01 or above 300 m, or a "
		"crown above 100 m, is not used; is \"unit\" another? (first in line 4: \"900\", which became its plant's own "
		"height)|1  kept at their plant's own height: the row says no usable one (first in line 4: \"900\")");
	expect("", "x,y,h,d\n1,1,12,\n2,2,510.0,20\n3,3,510,\n4,4,.001,\n",
		"\"plant\":\"oak\","
		"\"height_m\":[{\"column\":\"h\"},{\"from_dbh_cm\":\"d\",\"max\":35,\"rate\":0.004},11]," XY,
		"oak 1 1 h12 / oak 2 2 h19.858 / oak 3 3 h11 / oak 4 4 h11",
		"3  kept at another size: a "
		"height below 0.01 or above 300 m, or a crown above 100 m, is not used; is \"unit\" another? (first in line "
		"3: \"510.0\", which became 19.9 m by \"d\")");
	expect("", "x,y,h,k\n1,1,N/A,900\n2,2,old,8\n",
		"\"plant\":\"oak\",\"crown_m\":{\"column\":\"k\","
		"\"is\":\"radius\"},\"height_m\":[{\"column\":\"h\"}]," XY,
		"oak 1 1 / oak 2 2 c8",
		"(first in line 2: \"900\", which became its plant's own height)|1  kept: a size that is not understood, the "
		"next source or the plant's own is taken (first in line 3: \"old\", which became its plant's own "
		"height, scaled to its crown)");
	expect("", "x,y,h\n1,1,510\n", "\"plant\":\"oak\",\"height_m\":[{\"column\":\"h\"},11]," XY,
		"oak 1 1 h11", "(first in line 2: \"510\", which became 11 m, as for rows without a size)");
}

/* A unit that the scene states counts, and is doubted in a line; nothing is guessed. */
UNIT_TEST(a_unit_that_cannot_be_is_said_and_kept)
{
	const char *feet = "x,y,h,d\n1,1,35,300\n2,2,45,400\n3,3,90,250\n";
	expect("", feet, "\"plant\":\"oak\",\"height_m\":\"h\"," XY, "oak 1 1 h35 / oak 2 2 h45 / oak 3 3 "
		"h90",
		"half of its \"h\" are above 45 m, the largest about 90 m, which few plants are; is their "
		"\"unit\" \"ft\"?");
	expect("", feet,
		"\"plant\":\"oak\",\"height_m\":{\"from_dbh_cm\":\"d\",\"max\":35,\"rate\":0.004}," XY,
		"oak 1 1 h35 / oak 2 2 h35 / oak 3 3 h34.998",
		"half of its \"d\" are above 3 m, the "
		"largest about 4 m, which "
		"few trunks are; is their \"unit\" \"mm\"?");
	const struct inventory *in = inventory_of("positions", "", "rows.csv",
		"\"plant\":\"oak\",\"height_m\":"
		"{\"column\":\"h\",\"unit\":\"ft\"}," XY);
	if (strstr(in->report, "is their"))
		fail_msg("%s", in->report);
}

UNIT_TEST(an_entry_without_a_crs_is_in_the_scene_s)
{
	expect(UTM32, "x,y\n690010,5335020\n", "\"plant\":\"oak\"," XY, "oak 10 20", "");
	expect(UTM32, "what,where\na,POINT (690010 5335020)\n", "\"plant\":\"oak\"", "oak 10 20", "");
	expect_error(UTM32, "x,y\n11.56,48.14\n", "\"plant\":\"oak\"," XY, "they would be in the scene's, "
		"EPSG:25832; but "
		"11.56, 48.14 looks like degrees: add \"crs\": \"EPSG:4326\"");
	/* 0, 0 stands for no place */
	expect(UTM32, "x,y\n0,0\n690010,5335020\n", "\"plant\":\"oak\"," XY, "oak 10 20", "1  left out: no "
		"coordinates");
}

UNIT_TEST(latitude_and_longitude_swapped_are_no_silence)
{
	expect_error("\"crs\":\"EPSG:32610\",\"origin\":[525970,5040990],",
		"lat,lon\n45.52,-122.67\n45.53,-122.66\n",
		"\"plant\":\"oak\",\"x\":\"lat\",\"y\":\"lon\",\"crs\":\"EPSG:4326\"",
		"none of its 2 places can be converted, such as 45.52, -122.67; swapped they stand 0 km "
		"from the scene's "
		"origin: x is easting or longitude, y is northing or latitude; add \"x\": \"lon\", \"y\": "
		"\"lat\"");
}

UNIT_TEST(degrees_in_a_crs_of_metres_are_refused)
{
	static const char csv[] = "x,y\n8.61,50.1\n8.62,50.11\n", swapped[] = "x,y\n50.1,8.61\n50.11,8.62\n";
	expect_error(UTM32, csv, "\"plant\":\"oak\",\"crs\":\"EPSG:25832\"," XY, "such as 8.61, 50.1, look like degrees, "
		"but its CRS, EPSG:25832, counts in metres or feet: all plants would stand on one spot, at 4.511, 0.000; if "
		"they are longitude and latitude, say \"EPSG:4326\" instead");
	expect_error(UTM32, swapped, "\"plant\":\"oak\",\"crs\":\"EPSG:25832\"," XY, "look like degrees");
	expect_error(UTM32, csv, "\"plant\":\"oak\",\"crs\":\"EPSG:3857\"," XY, "look like degrees");
	expect_error(UTM32, csv, "\"plant\":\"oak\",\"crs\":\"EPSG:2263\"," XY, "look like degrees");
	expect_file("rows.geojson", UTM32, FEATURES(SAYS("urn:ogc:def:crs:EPSG::25832"), FEATURE("8.61", "50.1")),
		"\"plant\":\"oak\"", NULL, "look like degrees, but its CRS, EPSG:25832");
	/* one bad row does not refuse the others; a map of its own around the plot has such numbers */
	expect(UTM32, "x,y\n690001,5335002\n8.61,50.1\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25832\"," XY,
		"oak 1 2 / oak -689991.39 -5334949.9", "2 plants");
	expect("\"crs\":\"+proj=tmerc +lat_0=48.1 +lon_0=11.5 +type=crs\",\"origin\":[0,0,0],", "x,y\n8.5,50.25\n-20,3.5\n",
		"\"plant\":\"oak\",\"crs\":\"+proj=tmerc +lat_0=48.1 +lon_0=11.5 +type=crs\"," XY,
		"oak 8.5 50.25 / oak -20 3.5", "2 plants");
}

UNIT_TEST(swapped_places_are_compared_with_the_area_of_use)
{
	expect("\"crs\":\"EPSG:32639\",\"origin\":[400990,951020,0],", "lat,lon\n50.1,8.6\n", "\"plant\":\"oak\",\"crs\":"
		"\"EPSG:4258\",\"x\":\"lat\",\"y\":\"lon\"", "oak -22.776 -273.92", "outside the area of use of its CRS, "
		"EPSG:4258 (longitude -16.1 to 40.18, latitude 32.88 to 84.73), and inside with their coordinates swapped");
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

/* ---- Chance ---- */

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

/* ---- As people have them ---- */

UNIT_TEST(inventories_of_many_countries_go_through)
{
	/* a German register: semicolons, decimal commas, umlauts in Latin-1 */
	expect("\"crs\":\"EPSG:25833\",\"origin\":[390000,5820000,0],",
		"BAUM_NR;Gattung_Deutsch;Rechtswert;Hochwert;H\xf6he "
		"(m);Kronendurchmesser;Stammumfang cm\r\n"
		"\"0001\";Linde;390001,25;5820002,5;12,5;8,0;120\r\n\"0002\";Eiche;390.010,00;5.820.020,"
		"75;k.A.;;99\r\n\"0003\";;;;;;\r\n",
		"\"x\":\"Rechtswert\",\"y\":\"Hochwert\",\"crs\":\"EPSG:25833\",\"decimal\":\",\","
		"\"species\":\"Gattung_Deutsch\","
			"\"map\":{\"linde\":\"ash\",\"EICHE\":\"oak\"},"
		"\"height_m\":[{\"column\":\"Höhe (m)\"},{\"from_girth\":\"Stammumfang "
		"cm\",\"unit\":\"cm\",\"max\":30,\"rate\":0.005}],"
		"\"crown_m\":{\"column\":\"Kronendurchmesser\",\"is\":\"diameter\"}",
		"ash 1.25 2.5 h12.5 c4 / oak 10 20.75 h24.063",
		"3 rows, 2 plants|Windows-1252|1  left out: 1 species that the map does not have");
	/* a census: trunk diameters in inches, a state of each tree, degrees */
	expect("\"crs\":\"EPSG:32618\",\"origin\":[583960,4507523,0],",
		"created_at,tree_id,tree_dbh,stump_diam,status,spc_latin,latitude,longitude\n"
		"08/27/2015,1,3,0,Alive,Acer "
		"rubrum,40.72309177,-73.84421522\n09/03/2015,2,0,7,Stump,,40.79411067,-73.81867946\n"
		"09/05/2015,3,21,0,Dead,,40.71758074,-73.9366077\n",
		"\"x\":\"longitude\",\"y\":\"latitude\",\"crs\":\"EPSG:4326\","
			"\"only\":{\"status\":\"Alive\"},\"species\":"
		"\"spc_latin\",\"map\":{\"Acer*\":\"ash\",\"*\":\"oak\"},"
		"\"height_m\":{\"from_dbh_in\":\"tree_dbh\",\"max\":30,\"rate\":0.004}",
		"ash 13649.938 1137.705 h8.84", "3 rows, 1 plant|2  left out: \"status\" is none of "
		"\"only\" (first in line 3: \"Stump\")");
	/* an export of a GIS: a byte order mark, OBJECTID, X and Y in feet */
	expect("\"crs\":\"EPSG:26918\",\"origin\":[427000,4740000,0],",
		"\xef\xbb\xbfOBJECTID,Common_Nam,DBH,X,Y\n1,\"Maple, "
		"red\",12,1000000.5,1000000.25\n",
		"\"x\":\"X\",\"y\":\"Y\",\"crs\":\"EPSG:2261\",\"species\":\"Common_Nam\",\"map\":{\"maple,"
		"*\":\"ash\"}", "ash -1810.26 -7357.141",
			"1 row, 1 plant");
	/* observations of naturalists: many columns, some without a place */
	expect(UTM32, "id,observed_on,quality_grade,latitude,longitude,positional_accuracy,scientific_name,"
		"description\n"
		"1,2023-05-01,research,48.1,11.5,5,Quercus robur,\"old tree,\nby the "
		"lake\"\n2,2023-05-02,casual,,,,Tilia cordata,\n",
		"\"x\":\"longitude\",\"y\":\"latitude\",\"crs\":\"EPSG:4326\","
		"\"species\":\"scientific_name\",\"map\":{\"*\":\"oak\"},"
			"\"skip\":{\"quality_grade\":\"needs_id\"}", "oak -3878.244 -4561.87",
			"2 rows, 1 plant|1  left out: no coordinates (first in line 4)");
	/* a city's open data: one text for both coordinates is beside real columns and does no harm */
	expect(UTM32, "geo_point_2d;GENRE;HAUTEUR (m);x;y\n\"48.1, 11.5\";Platanus;12;690001;5335002\n",
		"\"crs\":\"EPSG:25832\",\"species\":\"GENRE\",\"map\":{\"*\":\"oak\"},"
		"\"height_m\":{\"column\":\"HAUTEUR (m)\"}," XY, "oak 1 2 h12", "separated by \";\"");
}

UNIT_TEST(a_dutch_feature_collection_goes_through)
{
	const struct inventory *in;
	input_text("positions", "bomen.gml", "<?xml version=\"1.0\" "
		"encoding=\"UTF-8\"?><wfs:FeatureCollection "
		"xmlns:wfs=\"http://www.opengis.net/wfs/2.0\" "
		"xmlns:app=\"http://www.deegree.org/app\" "
		"xmlns:gml=\"http://www.opengis.net/gml/3.2\"><wfs:member><app:bomen "
			"gml:id=\"bomen.1\"><app:boomsoort>Tilia "
		"europaea</app:boomsoort><app:hoogte>9 tot 12 m</app:hoogte><app:geometrie><gml:Point "
		"gml:id=\"g1\" "
			"srsName=\"urn:ogc:def:crs:EPSG::28992\"><gml:pos>"
		"121000.5 "
		"487000.25</gml:pos></gml:Point></app:geometrie></app:bomen></wfs:member>"
		"</wfs:FeatureCollection>");
	in = inventory_of("positions", "\"crs\":\"EPSG:28992\",\"origin\":[121000,487000,0],", "bomen.gml",
		"\"species\":\"boomsoort\",\"map\":{\"tilia*\":\"ash\"},"
		"\"height_m\":{\"column\":\"hoogte\"}");
	assert_string_equal(in->error, "");
	assert_string_equal(in->plants, "ash 0.5 0.25 h10.5");
}

UNIT_TEST(a_real_inventory_goes_through_whole)
{
	const char *data = getenv("ECO_DATA");
	char path[4096];
	struct eco_size height = { .kind = ECO_SIZE_NUMBER, .value_m = 9 };
	struct eco_positions_spec spec = { .x = (char *)"utm17n_e", .y = (char *)"utm17n_n",
		.crs = (char *)"EPSG:26917",
		.fallback = { (char *)"*", 0, 1 }, .heights = &height, .height_count = 1, .levels = 8 };
	const struct eco_frame frame = { "EPSG:26917", NULL, { 747375, 4308510, 0 } };
	struct eco_positions *reader;
	struct eco_position record;
	uint32_t count = 0;

	snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", data != NULL ? data : "");
	if (!data || access(path, R_OK) != 0)
		skip();
	spec.path = path;
	assert_int_equal(eco_positions_open(&reader, &spec, &frame, NULL), ECO_OK);
	while (eco_positions_next(reader, &record, NULL) == ECO_OK && record.plant != ECO_NONE) {
		assert_true(record.at[0] > -20 && record.at[0] < 430 && record.at[1] > -20
			&& record.at[1] < 660 && record.height_m == 9);
		count++;
	}
	assert_int_equal(count, 51253);
	eco_positions_close(reader);
}

/* Degrees and feet of a survey, by the city itself. */
UNIT_TEST(degrees_and_feet_of_a_real_inventory_meet)
{
	const char *data = getenv("ECO_DATA");
	char path[4096];
	struct eco_positions_spec spec = { .x = (char *)"Longitude", .y = (char *)"Latitude",
		.crs = (char *)"EPSG:4326", .fallback = { (char *)"*", 0, 1 } };
	struct eco_positions_spec other = { .x = (char *)"X", .y = (char *)"Y", .crs = (char *)"EPSG:2261",
		.fallback = { (char *)"*", 0, 1 } };
	const struct eco_frame frame = { "EPSG:26918", NULL, { 425000, 4661000, 0 } };
	struct eco_positions *degrees, *feet;
	struct eco_position a, b;
	uint32_t count = 0;
	snprintf(path, sizeof path, "%s/inventories/binghamton_ny_street_trees.csv",
		data != NULL ? data : "");
	if (!data || access(path, R_OK) != 0)
		skip();
	spec.path = other.path = path;
	assert_int_equal(eco_positions_open(&degrees, &spec, &frame, NULL), ECO_OK);
	assert_int_equal(eco_positions_open(&feet, &other, &frame, NULL), ECO_OK);
	while (eco_positions_next(degrees, &a, NULL) == ECO_OK && a.plant != ECO_NONE) {
		assert_int_equal(eco_positions_next(feet, &b, NULL), ECO_OK);
		assert_true(a.row == b.row && hypot(a.at[0] - b.at[0], a.at[1] - b.at[1]) < 1);
		count++;
	}
	assert_int_equal(count, 16875);
	eco_positions_close(degrees);
	eco_positions_close(feet);
}
