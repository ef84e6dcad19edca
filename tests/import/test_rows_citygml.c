/* Trees of city models: where they stand, what is said of them, in which CRS. */
#include <stdlib.h>

#include "tests/support/input_files.h"
#include "tests/support/rows_text.h"
#include "tests/support/unit_test.h"

#define POINT_3D "<gml:Point><gml:pos srsDimension=\"3\">"
#define IMPLICIT(pos) "<veg:lod2ImplicitRepresentation><core:ImplicitGeometry><core:referencePoint>" \
	POINT_3D pos "</gml:pos></gml:Point>" \
	"</core:referencePoint></core:ImplicitGeometry></veg:lod2ImplicitRepresentation>"
#define TREE(inside) "<core:cityObjectMember><veg:SolitaryVegetationObject gml:id=\"t\">" inside \
	"</veg:SolitaryVegetationObject></core:cityObjectMember>"

/* A model whose envelope names a CRS. */
static const char *model(const char *srs, const char *inside)
{
	static char text[20000];
	snprintf(text, sizeof text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<core:CityModel "
		"xmlns:core=\"http://www.opengis.net/citygml/2.0\" "
		"xmlns:veg=\"http://www.opengis.net/citygml/vegetation/2.0\" "
		"xmlns:gml=\"http://www.opengis.net/gml\">\n%s%s%s\n%s</core:CityModel>\n",
		srs != NULL ? "<gml:boundedBy><gml:Envelope srsName=\"" : "", srs != NULL ? srs : "",
		srs != NULL ? "\" srsDimension=\"3\"><gml:lowerCorner>0 0 "
		"0</gml:lowerCorner></gml:Envelope></gml:boundedBy>" : "", inside);
	return text;
}

static struct eco_rows *open_good(const char *text)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	assert_ok(eco_rows_open_citygml(&rows, input_text("rows_citygml", "city.gml", text), &error), error);
	return rows;
}

static void expect(const char *text, const char *wanted)
{
	char got[2000];
	assert_string_equal(rows_text_of(open_good(text), got, sizeof got), wanted);
}

UNIT_TEST(attributes_of_the_standard_and_generic_ones_are_columns)
{
	expect(model("EPSG:25832", TREE("<gml:name>Linde am "
		"Platz</gml:name><veg:class>1070</veg:class><veg:species>1640</veg:species>"
			"<veg:height uom=\"urn:adv:uom:m\">12.5</veg:height><veg:trunkDiameter "
			"uom=\"cm\">40</veg:trunkDiameter><veg:crownDiameter>6</veg:crownDiameter>"
			"<gen:stringAttribute name=\"Baumart\"><gen:value> B&#228;rche &amp; Co "
			"</gen:value></gen:stringAttribute>"
				IMPLICIT("690100.5 5335200.25 515.5"))
		TREE("<gen:measureAttribute name=\"height\"><gen:value "
		"uom=\"#ft\">30</gen:value></gen:measureAttribute>" IMPLICIT("690101 5335201 516"))),
		"id,name,class,species,height,trunkDiameter,crownDiameter,Baumart"
		" / (690100.5 5335200.25 515.5) t,Linde am Platz,1070,1640,12.5 m,40 cm,6,Bärche & Co / "
		"(690101 5335201 516) t,,,,30 ft,,,");
}

UNIT_TEST(all_versions_are_read)
{
	/* CityGML 1 without prefixes, GML 2 coordinates */
	expect("<CityModel "
		"xmlns=\"http://www.citygml.org/citygml/1/0/0\"><cityObjectMember><SolitaryVegetationObject>"
		"<species>oak</species>"
		"<lod1Geometry><Point "
		"srsName=\"EPSG:25832\"><coordinates>690000,5335000,500</coordinates></Point></lod1Geometry>"
		"</SolitaryVegetationObject>"
		"</cityObjectMember></CityModel>", "species / (690000 5335000 500) oak");
	/* CityGML 3 */
	expect("<CityModel "
		"xmlns=\"http://www.opengis.net/citygml/3.0\"><cityObjectMember>"
		"<veg:SolitaryVegetationObject gml:id=\"x\"><genericAttribute>"
		"<gen:StringAttribute><gen:name>Art</gen:name><gen:value>Eiche</gen:value>"
		"</gen:StringAttribute></genericAttribute><lod1ImplicitRepresentation>"
		"<ImplicitGeometry><transformationMatrix>0 -1 0 2 1 0 0 3 0 0 1 0.5 0 0 0 "
			"1</transformationMatrix><referencePoint><gml:Point><gml:pos>690000 5335000 "
		"500</gml:pos></gml:Point></referencePoint></ImplicitGeometry></lod1ImplicitRepresentation>"
		"<veg:species>1640</veg:species>"
		"</veg:SolitaryVegetationObject></cityObjectMember></CityModel>",
		"id,Art,species / (690002 5335003 500.5) x,Eiche,1640");
}

UNIT_TEST(a_geometry_stands_on_the_middle_of_its_lowest_part)
{
	/* a crown reaching to one side, over a thin trunk; the lower edge of one of two crossed pictures */
	expect(model("EPSG:25832", TREE("<veg:lod1Geometry><gml:MultiSurface><gml:posList>10 20 500 12 20 "
		"500 12 22 500 10 22 500 10 20 500</gml:posList>"
		"<gml:posList srsDimension=\"3\">10 20 505 40 20 505 40 60 "
		"510</gml:posList></gml:MultiSurface></veg:lod1Geometry>")),
		"id / (11 21 500) t");
	/* what is in local axes, or lies along the terrain, does not count */
	expect(model("EPSG:25832", TREE("<veg:lod1TerrainIntersection><gml:posList>0 0 0 1 1 "
		"1</gml:posList></veg:lod1TerrainIntersection>"
		"<veg:lod1ImplicitRepresentation><core:ImplicitGeometry><core:relativeGMLGeometry>"
		"<gml:Point><gml:pos>1 2 "
		"3</gml:pos></gml:Point></core:relativeGMLGeometry>"
		"<core:referencePoint>" POINT_3D "7 8 "
		"9</gml:pos></gml:Point></core:referencePoint></core:ImplicitGeometry>"
		"</veg:lod1ImplicitRepresentation>")),
		"id / (7 8 9) t");
	expect(model("EPSG:25832",
		TREE("<veg:lod1Geometry xlink:href=\"#other\"/>") TREE("<veg:lod1Geometry><gml:Point "
		"srsDimension=\"2\"><gml:pos>1 "
		"2</gml:pos></gml:Point></veg:lod1Geometry>")), "id / empty t / (1 2) t");
}

static const struct { const char *srs, *pos, *crs, *at, *note; } a_crs_cases[] = {
	{ "EPSG:25832", "690000 5335000 500", "EPSG:25832", "(690000 5335000 500)", NULL },
	{ "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", "690000 5335000 500", "EPSG:25832+7837",
		"(690000 5335000 500)", NULL },
	{ "urn:adv:crs:ETRS89_UTM33", "390000 5820000 40", "EPSG:25833", "(390000 5820000 40)",
		NULL },
	{ "http://www.opengis.net/gml/srs/epsg.xml#28992", "121000 487000 2", "EPSG:28992",
		"(121000 487000 2)", NULL },
	{ "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837", "690000 5335000 500",
		"urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837",
		"(690000 5335000 500)", NULL },
	{ "urn:ogc:def:crs:EPSG::4979", "48.1 11.5 520", "urn:ogc:def:crs:EPSG::4979",
		"(11.5 48.1 520)", NULL },
	{ "http://www.opengis.net/def/crs/EPSG/0/4258", "48.1 11.5 520",
		"http://www.opengis.net/def/crs/EPSG/0/4258", "(11.5 48.1 520)", NULL },
	{ "EPSG:4258", "48.1 11.5 520", "EPSG:4258", "(11.5 48.1 520)",
		"easting or longitude first" },
	{ "EPSG:4326", "11.5 48.1 520", "EPSG:4326", "(11.5 48.1 520)",
		"taken for longitude, latitude" },
	{ "urn:ogc:def:crs:EPSG::31467", "3560000 5820000 50", "urn:ogc:def:crs:EPSG::31467",
		"(3560000 5820000 50)", "the other way round" },
	{ "urn:ogc:def:crs:EPSG::31467", "5820000 3560000 50", "urn:ogc:def:crs:EPSG::31467",
		"(3560000 5820000 50)", NULL },
	{ NULL, "1 2 3", NULL, "(1 2 3)", NULL },
};

UNIT_TEST(a_crs_is_known_in_any_spelling_and_order)
{
	char inside[2000], wanted[200], got[2000];
	for (size_t i = 0; i < sizeof a_crs_cases / sizeof *a_crs_cases; i++) {
		struct eco_rows *rows;
		snprintf(inside, sizeof inside,
			TREE("<veg:lod1Geometry>" POINT_3D "%s</gml:pos></gml:Point></veg:lod1Geometry>"),
			a_crs_cases[i].pos);
		snprintf(wanted, sizeof wanted, "id / %s t", a_crs_cases[i].at);
		rows = open_good(model(a_crs_cases[i].srs, inside));
		assert_int_equal(rows->crs != NULL, a_crs_cases[i].crs != NULL);
		if (a_crs_cases[i].crs)
			assert_string_equal(rows->crs, a_crs_cases[i].crs);
		assert_int_equal(rows->note_count, a_crs_cases[i].note != NULL);
		if (a_crs_cases[i].note)
			assert_non_null(strstr(rows->notes[0], a_crs_cases[i].note));
		assert_true(rows->has_geometry && rows->has_z && !rows->local);
		assert_string_equal(rows_text_of(rows, got, sizeof got), wanted);
	}
}

UNIT_TEST(what_is_no_tree_is_passed_over)
{
	struct eco_rows *rows = open_good(model("EPSG:25832", "<bldg:Building><bldg:height "
		"uom=\"m\">9</bldg:height></bldg:Building>"
		"<veg:PlantCover><veg:averageHeight>3</veg:averageHeight></veg:PlantCover>"
		TREE(IMPLICIT("1 2 3"))));
	char got[2000];

	assert_int_equal(rows->note_count, 1);
	assert_non_null(strstr(rows->notes[0], "1 PlantCover"));
	assert_string_equal(rows_text_of(rows, got, sizeof got), "id / (1 2 3) t");
}

UNIT_TEST(files_that_are_attacks_or_accidents_are_refused)
{
	static const struct { const char *text, *says; } cases[] = {
		{ "<!DOCTYPE a [<!ENTITY b \"c\">]><CityModel>&b;</CityModel>",
			":1: it has a document type" },
		{ "<CityModel><SolitaryVegetationObject><species>oak</spec", "breaks off" },
		{ "<CityModel><a></b></CityModel>", "not XML: mismatched tag" },
		{ "<CityModel></CityModel>", "no SolitaryVegetationObject in it" },
		{ "<CityModel><PlantCover/></CityModel>", "\"scatter\"" },
		{ "<CityModel><SolitaryVegetationObject><p "
			"srsName=\"EPSG:1\"/></SolitaryVegetationObject><SolitaryVegetationObject><p "
			"srsName=\"EPSG:2\"/>"
			"</SolitaryVegetationObject></CityModel>", "in two CRS, \"EPSG:1\" and \"EPSG:2\"" },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_rows *rows;
		assert_int_not_equal(eco_rows_open_citygml(&rows,
			input_text("rows_citygml", "bad.gml", cases[i].text), &error), ECO_OK);
		assert_null(rows);
		if (!strstr(error.text, cases[i].says))
			fail_msg("%s\n  wanted ... %s", error.text, cases[i].says);
	}
}

UNIT_TEST(depth_is_bounded)
{
	char *text = calloc(1, 10000);
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	for (int i = 0; i < 1000; i++)
		strcat(text, "<a>");
	assert_int_equal(eco_rows_open_citygml(&rows, input_text("rows_citygml", "deep.gml", text), &error),
		ECO_TOO_LARGE);
	free(text);
}

UNIT_TEST(a_file_cut_off_anywhere_is_never_read_as_whole)
{
	const char *whole =
		model("EPSG:25832",
		TREE("<veg:height uom=\"m\">12</veg:height>" IMPLICIT("1 2 3")) TREE(IMPLICIT("4 5 6")));
	size_t size = strlen(whole) - 1;     /* without the last line break */
	char *text = malloc(size);
	memcpy(text, whole, size);
	for (size_t cut = 1; cut < size; cut += 7) {
		struct eco_rows *rows;
		struct eco_error error = { .code = ECO_OK };
		assert_int_not_equal(eco_rows_open_citygml(&rows,
			input_bytes("rows_citygml", "cut.gml", text, cut), &error), ECO_OK);
	}
	free(text);
}
