/* Wavefront OBJ and MTL as people's exporters write them: each oddity stands here as the small file that
 * shows it. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/model_try.h"

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

/* The model that the test looks at; reading the next frees it. */
static struct eco_model m;

/* ---- OBJ: the text ---- */

UNIT_TEST(any_line_end_and_byte_order_mark_will_do)
{
	static const char *const files[] = { TRIANGLE "f 1 2 3\n", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 "
		"3\r\n", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
		"\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
		"v  0\t0 0  \n\n  v 1 0 0 # right\nv 0 \\\n 1 0\nf 1 2 \\\r\n3\n",
		"v 0 0 0 1.0\nv 1 0 0 1.0\nv 0 1 0 1.0\nf 1// 2// 3//\n", TRIANGLE
		"vn 0 0 1\nf 1//1 2//1 3//1\n", "f 1 2 3\n" TRIANGLE,
		"mtllib\nusemtl\no\ng\ns 1\n" TRIANGLE "curv 0 1 1 2\nf -3 -2 -1\n",
		"v +0 .0 0.e0\nv 1E0 0 0\nv 0 1.0e+0 0\nfo 1 2 3\n" };

	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		import_file(&m, input_text("formats", "ends.obj", files[i]),
			&(struct eco_model_options){ .up = ECO_UP_Y });
		if (m.triangle_count != 1 || !has_place(&m, 0.5, 0, 0) || !has_place(&m, -0.5, 0, 1))
			fail_msg("file %zu: %u triangles", i, m.triangle_count);
	}
}

UNIT_TEST(indices_that_are_not_there_cost_their_triangles_only)
{
	import_file(&m, input_text("formats", "index.obj", TRIANGLE "v 1 1 0\nf 1 2 3\nf 1 2 900\nf 0 1 2\nf "
		"-5 1 2\nf 1 x 2\nf 2 4 3 900 1\nf 99999999999999999999 1 2\nf 1 2\nf 1\nf\n"), NULL);
	assert_int_equal(m.triangles_in, 1 + 4 + 3 + 1);
	assert_int_equal(m.dropped[ECO_DROP_BAD_INDEX], 4 + 2 + 1);
	assert_int_equal(m.triangle_count, 2);
	import_says("7 triangles name vertices that the file does not have");
}

UNIT_TEST(numbers_that_are_none_are_counted_or_named_with_their_line)
{
	import_file(&m, input_text("formats", "nan.obj", TRIANGLE "v nan 0 0\nv -nan(ind) 0 0\nv 1.#QNAN 0 "
		"0\nv 0 -1.#INF 0\nv 1e999 0 0\n"
		"f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\nf 1 2 7\nf 1 2 8\n"), NULL);
	assert_int_equal(m.dropped[ECO_DROP_NOT_FINITE], 5);
	import_says("5 triangles have coordinates that are no numbers");
	import_refuses(input_text("formats", "comma.obj", "# oak\nv 0,5 1,25 0\n"), ECO_BAD_INPUT,
		"line 2: \"0,5\": numbers need a decimal point");
	import_refuses(input_text("formats", "word.obj", "v 1 2 three\n"), ECO_BAD_INPUT,
		"line 1: \"three\" is not a number");
	import_refuses(input_text("formats", "short.obj", "v 1 2\n"), ECO_BAD_INPUT,
		"line 1: a vertex needs three numbers");
}

UNIT_TEST(what_is_no_obj_is_named)
{
	import_refuses(input_bytes("formats", "coff.obj", "\x64\x86\x03\0\0\0\0\0", 8), ECO_BAD_INPUT,
		"binary, so no Wavefront OBJ file");
	import_refuses(input_bytes("formats", "wide.obj", "\xff\xfev\0 \0", 6), ECO_UNSUPPORTED,
		"UTF-16; save it as UTF-8");
	import_refuses(input_text("formats", "prose.obj", "This is a tree.\n"), ECO_BAD_INPUT,
		"no vertices in it");
	import_refuses(input_text("formats", "lines.obj", TRIANGLE "l 1 2 3\np 1\n"), ECO_BAD_INPUT,
		"no triangles in it, only 3 vertices and 2 points or lines; a point cloud has no surfaces");
}

/* A square metre at UTM coordinates in millimetres' detail: a float there has steps of 0.5 m to the north. */
UNIT_TEST(map_coordinates_keep_their_detail)
{
	import_file(&m, input_text("formats", "utm.obj", "v 0 0 0\nv 747375.125 4308510.250 312.5\nv "
		"747376.125 4308510.250 312.5\n"
		"v 747375.126 4308510.250 313.5\nv 747376.125 4308510.252 313.5\nf 2 3 4\nf 3 5 4\n"),
		&(struct eco_model_options){ .up = ECO_UP_Z,
		.unit_m = 1 });
	assert_true(close_to(m.foot[0], 747375.625, 1e-6) && close_to(m.foot[1], 4308510.25, 1e-6)
		&& close_to(m.foot[2], 312.5, 1e-6));
	assert_true(has_place(&m, -0.499, 0, 1) && has_place(&m, 0.5, 0.002, 1));
}

UNIT_TEST(colours_of_vertices_may_be_shares_or_bytes)
{
	static const char *const files[] = { "v 0 0 0 1 0.2 0\nv 1 0 0 1 0.2 0\nv 0 1 0 1 0.2 0\nf 1 2 3\n",
		"v 0 0 0 255 51 0\nv 1 0 0 255 51 0\nv 0 1 0 255 51 0\nf 1 2 3\n",
		"v 0 0 0 1 0.2 0 1\nv 1 0 0 1 0.2 0 1\nv 0 1 0 1 0.2 0 1\nf 1 2 3\n" };

	for (size_t i = 0; i < 3; i++) {
		import_file(&m, input_text("formats", "vc.obj", files[i]), NULL);
		assert_memory_equal(m.materials[m.material[0]].rgb, ((const uint8_t[]){ 255, 51, 0 }), 3);
	}
}

/* ---- OBJ: materials and parts ---- */

UNIT_TEST(libraries_are_found_as_exporters_meant)
{
	static const struct { const char *file, *library, *line, *says; } cases[] = {
		{ "my trees.mtl", "newmtl bark\nKd 1 0 0\n", "mtllib my trees.mtl\n", "" },
		{ "b.mtl", "newmtl bark\nKd 1 0 0\n", "mtllib nothere.mtl b.mtl\n",
			"nothere.mtl is not there" },
		{ "c.mtl", "newmtl bark\r\n\tKd 1 0 0\r\n", "mtllib C:\\Users\\me\\c.mtl\r\n", "" },
		{ "Wald.MTL", "newmtl Bark\nkd 1.0 0.0 0.0\n", "mtllib wald.mtl\n", "" },
		{ "lib.mtl", "newmtl bark\nKd 1 0 0\n", "mtllib other.mtl\n", "lib.mtl stands in for it" },
		{ "lib.mtl", "\xef\xbb\xbfnewmtl bark\nKd 0.5 0.5 0.5\nnewmtl bark\nKd 1 0 0\n", "", "" },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char text[300];
		snprintf(text, sizeof text, "%s" TRIANGLE "usemtl bark\nf 1 2 3\n", cases[i].line);
		input_text("formats", cases[i].file, cases[i].library);
		import_file(&m, input_text("formats", "lib.obj", text), NULL);
		if (material_of(&m, "bark")->rgb[0] != 255 || material_of(&m, "bark")->rgb[1] != 0)
			fail_msg("case %zu: %s", i, import_said);
		import_says(cases[i].says);
		unlink(input_path("formats", cases[i].file));
	}
}

UNIT_TEST(what_no_library_describes_is_grey_and_said)
{
	import_file(&m, input_text("formats", "bare.obj", TRIANGLE "v 0 0 1\nf 1 2 4\nusemtl \xc3\x84ste "
		"und Bl\xc3\xa4tter\nf 1 2 3\n"), NULL);
	assert_int_equal(m.material_count, 2);
	assert_int_equal(material_of(&m, "\xc3\x84ste und Bl\xc3\xa4tter")->rgb[1], 153);
	assert_int_equal(material_of(&m, "")->rgb[1], 153);
	import_says("1 of its materials are in no library (\xc3\x84ste und Bl\xc3\xa4tter): they have no "
		"colour");
	import_file(&m, input_text("formats", "bare.obj", "mtllib gone.mtl\n" TRIANGLE "usemtl x\nf 1 2 3\n"),
		NULL);
	import_says("its library of materials gone.mtl is not there");
}

/* d says how opaque, Tr how transparent, if exporters agree; a plant that would be invisible throughout was
 * not meant to be. */
UNIT_TEST(transparency_is_read_with_sense)
{
	static const struct { const char *library; uint32_t hidden; const char *says; } cases[] = {
		{ "newmtl a\nd 1\nTr 1\nnewmtl b\nd 1\nTr 1\n", 0, "" },
			{ "newmtl a\nTr 0\nnewmtl b\nTr 1\n", 1, "1 triangles have materials with alpha" },
		{ "newmtl a\nTr 1.0\nnewmtl b\nTr 1.0\n", 0, "all of its materials are fully transparent" },
		{ "newmtl a\nd 0\nnewmtl b\nd 0\n", 0, "taken for opaque" },
		{ "newmtl a\nd -halo 0.6\nnewmtl b\nd 0.2\n", 1, "" },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		input_text("formats", "alpha.mtl", cases[i].library);
		import_file(&m,
			input_text("formats", "alpha.obj", "mtllib alpha.mtl\n" TRIANGLE
			"v 0 0 1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n"), NULL);
		if (m.dropped[ECO_DROP_TRANSPARENT] != cases[i].hidden)
			fail_msg("case %zu: %u left out", i, m.dropped[ECO_DROP_TRANSPARENT]);
		import_says(cases[i].says);
	}
}

UNIT_TEST(objects_and_groups_are_parts)
{
	import_file(&m, input_text("formats", "parts.obj", TRIANGLE "v 0 0 1\nv 0 0 2\nv 0 0 3\nf 1 2 3\no "
		"Oak Tree\nf 1 2 4\ng leaves\nf 1 2 5\no Pot\nf 1 2 6\n"), NULL);
	assert_int_equal(m.part_count, 4);
	assert_string_equal(m.parts[m.part[0]].name, "");
	assert_string_equal(m.parts[m.part[1]].name, "Oak Tree");
	assert_string_equal(m.parts[m.part[2]].name, "Oak Tree/leaves");
	assert_string_equal(m.parts[m.part[3]].name, "Pot");
}
