/* glTF as an inventory: a row for each instance or node, with all that the file says of it. */
#include "ecofiles/import/places/rows/rows.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

static void expect_rows(const char *rest, const char *columns, const char *const *lines, size_t line_count)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	char text[2000] = "";
	uint8_t *bytes;
	size_t size = gw_glb_bytes(rest, ' ', &bytes), line = 0;
	bool more = true;
	assert_ok(eco_rows_open_gltf(&rows, input_bytes("rows_gltf", "rows.glb", bytes, size), &error),
		error);
	free(bytes);
	for (uint32_t i = 0; i < rows->column_count; i++)
		snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i > 0 ? "," : "",
			rows->columns[i]);
	assert_string_equal(text, columns);
	for (;;) {
		assert_int_equal(rows->next(rows, &more, &error), ECO_OK);
		if (!more)
			break;
		text[0] = 0;
		for (uint32_t i = 0; i < rows->field_count; i++)
			snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i > 0 ? "," : "",
				rows->fields[i]);
		assert_true(line < line_count);
		assert_string_equal(text, lines[line++]);
		assert_int_equal(rows->row, line);
	}
	assert_int_equal(line, line_count);
	assert_int_equal(rows->note_count, strstr(rest, "quantized") != NULL);
	rows->close(rows);
}

UNIT_TEST(a_row_for_each_instance)
{
	static const float places[3][3] = { { 1, 2, 3 }, { 4, 0, -6 }, { 0, 0, 0 } },
		sizes[3][3] = { { 1, 1, 1 }, { 2, 2, 2 }, { 1, 8, 1 } };
	static const float turns[3][4] = { { 0, 0, 0, 1 }, { 0, 0.70710678f, 0, 0.70710678f },
		{ 0, -0.38268343f, 0, 0.92387953f } };
	static const uint16_t species[3] = { 7, 9, 7 };
	gw_begin();
	gw_floats(places[0], 3, "VEC3", 3);
	gw_floats(turns[0], 3, "VEC4", 4);
	gw_floats(sizes[0], 3, "VEC3", 3);
	gw_accessor(gw_view(species, sizeof species, ""), GLTF_USHORT, 3, "SCALAR", "");
	gw_floats(places[0], 1, "VEC3", 3);
	expect_rows(",\"nodes\":[{\"name\":\"oaks\",\"mesh\":0,\"translation\":[100,0,0],"
		"\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0,"
		"\"ROTATION\":1,\"SCALE\":2,\"_SPECIES\":3}}}},{\"mesh\":0},"
			"{\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":4}}}}"
			"],"
		"\"meshes\":[{\"name\":\"oak\"}]", "x,y,z,name,mesh,yaw_deg,scale,height_m,_SPECIES",
		(const char *const[]){ "101,-3,2,oaks,oak,0.0000,1,,7", "104,6,0,oaks,oak,90.0000,2,,9",
		"100,0,0,oaks,oak,315.0000,2,,7",
			"1,-3,2,,,0.0000,1,," }, 4);
}

UNIT_TEST(a_row_for_each_node_with_a_mesh)
{
	gw_begin();
	expect_rows(",\"nodes\":[{\"children\":[1,2],\"scale\":[2,2,2],\"name\":\"group\"},{\"mesh\":0,"
		"\"translation\":[1,0,-1],"
		"\"extras\":{\"dbh_cm\":31.5,\"alive\":true}},"
		"{\"mesh\":0,\"name\":\"Ash.001\",\"extras\":{\"species\":\"ash\",\"list\":[1],"
		"\"dbh_cm\":12}},{\"name\":\"lamp\"}],"
			"\"meshes\":[{\"name\":\"ash\"}]", "x,y,z,name,mesh,yaw_deg,scale,height_m,dbh_cm,"
			"alive,species",
		(const char *const[]){ "2,2,0,ash,ash,0.0000,2,,31.5,true,",
		"0,0,0,Ash.001,ash,0.0000,2,,12,,ash" }, 2);
}

/* Heights from floats, and from 16-bit fractions from -1 to 1 about the middle of the same mesh, which is 4
 * wide and 10 high. */
UNIT_TEST(heights_are_those_of_meshes_however_packed)
{
	static const float f[2][3] = { { 0, 0, 0 }, { 4, 10, 4 } };
	static const int16_t q[2][4] = { { -32767, -32767, -32767 }, { 32767, 32767, 32767 } };
	gw_begin();
	gw_accessor(gw_view(f, sizeof f, ""), GLTF_FLOAT, 2, "VEC3", ",\"min\":[0,0,0],\"max\":[4,10,4]");
	gw_accessor(gw_view(q, sizeof q, ",\"byteStride\":8"), GLTF_SHORT, 2, "VEC3",
		",\"normalized\":true,\"min\":[-32767,-32767,-32767],\"max\":"
		"[32767,32767,32767]");
	expect_rows(",\"nodes\":[{\"mesh\":0,\"translation\":[1,2,3],\"scale\":[2,2,2]},{\"mesh\":1,"
		"\"translation\":[2,5,2],\"scale\":[2,5,2],"
		"\"name\":\"quantized\"}],\"meshes\":["
		"{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},"
		"{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]",
		"x,y,z,name,mesh,yaw_deg,scale,height_m",
		(const char *const[]){ "1,-3,2,,,0.0000,2,20", "2,-2,0,quantized,,0.0000,,10" }, 2);
}

UNIT_TEST(a_scene_without_plants_is_no_inventory)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	assert_int_equal(eco_rows_open_gltf(&rows,
		input_text("rows_gltf", "none.gltf", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}]}"),
		&error), ECO_BAD_INPUT);
	assert_null(rows);
	assert_non_null(strstr(error.text, "none.gltf: no node"));
	assert_int_equal(eco_rows_open_gltf(&rows, "build/tmp/rows_gltf/nowhere.glb", NULL), ECO_NOT_FOUND);
}
