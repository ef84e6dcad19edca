/* Formats and what people's exporters make of them: each oddity is written out as the small file that shows
 * it. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/cases.h"
#include "tests/support/model_try.h"

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

/* ---- Axes and units that formats state ---- */

/* A triangle in Collada. */
#define DAE(asset) "<?xml version=\"1.0\"?>\n<COLLADA " \
	"xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset>" asset "</asset>" \
	"<library_effects><effect id=\"e\"><profile_COMMON><technique sid=\"c\"><lambert><diffuse>" \
	"<color>0.2 0.2 0.2 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>" \
	"<library_materials><material id=\"m\" name=\"Bark\"><instance_effect url=\"#e\"/></material></library_materials>" \
	"<library_geometries><geometry id=\"g\" name=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" count=\"9\">" \
	"0 0 0 10 0 0 0 0 100</float_array><technique_common><accessor source=\"#pa\" count=\"3\" stride=\"3\">" \
	"<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>" \
	"</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" \
	"<triangles material=\"s\" count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p></triangles>" \
	"</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"w\">" \
	"<node id=\"n\" name=\"Trunk\"><translate>40 50 60</translate><instance_geometry url=\"#g\"><bind_material>" \
	"<technique_common><instance_material symbol=\"s\" target=\"#m\"/></technique_common></bind_material>" \
	"</instance_geometry></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#w\"/></scene>" \
	"</COLLADA>\n"

UNIT_TEST(files_are_read_as_people_mean_them)
{
	expect_models("formats", "tests/import/cases/model_formats.tsv");
}

/* ---- Other formats ---- */

static size_t chunk(uint8_t *to, unsigned id, const uint8_t *body, size_t size)
{
	memmove(to + 6, body, size);
	to[0] = (uint8_t)id;
	to[1] = (uint8_t)(id >> 8);
	for (int i = 0; i < 4; i++)
		to[2 + i] = (uint8_t)((size + 6) >> (8 * i));
	return size + 6;
}

/* 3DS of one triangle, 2 wide and 5 high along z; STL of the same. None says which axis is up: as is
 * usual in them. */
UNIT_TEST(formats_without_axes_follow_their_convention)
{
	static const float places[9] = { 0, 0, 0, 2, 0, 0, 0, 0, 5 };
	uint8_t bytes[400], list[100];
	size_t used, at = 0;
	list[0] = 3;
	list[1] = 0;
	memcpy(list + 2, places, 36);
	used = chunk(bytes, 0x4110, list, 38);
	memcpy(list, (const uint8_t[]){ 1, 0, 0, 0, 1, 0, 2, 0, 0, 0 }, 10);
	used += chunk(bytes + used, 0x4120, list, 10);
	used = chunk(bytes, 0x4100, bytes, used);
	memmove(bytes + 6, bytes, used);
	memcpy(bytes, "trunk", 6);
	used = chunk(bytes, 0x4000, bytes, used + 6);
	used = chunk(bytes, 0x3d3d, bytes, used);
	used = chunk(bytes, 0x4d4d, bytes, used);
	import_file(input_bytes("formats", "tree.3ds", bytes, used), NULL);
	assert_true(close_to(m.source.size[2], 5, 1e-6) && m.source.up == ECO_UP_Z
		&& close_to(m.source.size[0], 2, 1e-6));
	memset(bytes, 0, sizeof bytes);
	memcpy(bytes, "binary STL", 10);
	bytes[80] = 1;
	memcpy(bytes + 84 + 12, places, 36);
	for (at = 0; at < 2; at++) {
		import_file(at == 0 ? input_bytes("formats", "tree.stl", bytes, 84 + 50)
			: input_text("formats", "text.STL",
			"solid oak\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 0 "
			"5\nendloop\nendfacet\nendsolid oak\n"), NULL);
		assert_true(close_to(m.source.size[2], 5, 1e-6) && m.source.up == ECO_UP_Z);
		assert_int_equal(m.materials[0].rgb[0], 153);
	}
}

/* assimp 5.2 takes a line feed there for the header's end. */
UNIT_TEST(binary_ply_may_begin_with_any_byte)
{
	static const float places[12] = { 10, 20, 0, 11, 20, 0, 11, 21, 3, 10, 21, 0.5f };
	for (int first = -1; first < 256; first += first < 64 ? 1 : 13) {        /* -1: big-endian */
		bool big = first < 0;
		uint8_t file[600];
		size_t used = (size_t)snprintf((char *)file, sizeof file,
			       "ply\nformat binary_%s_endian 1.0\nelement "
			       "vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face "
			       "2\nproperty "
			       "list uchar int vertex_indices\nend_header\n",
			       big ? "big" : "little"),
		       data = used;
		for (size_t i = 0; i < sizeof places; i++)
			file[used++] = ((const uint8_t *)places)[big ? i ^ 3 : i];
		if (!big)
			file[data] = (uint8_t)first;
		for (int t = 0; t < 2; t++) {
			file[used++] = 3;
			for (int k = 0; k < 3; k++, used += 4) {
				memset(file + used, 0, 4);
				file[used + (big ? 3 : 0)] = (uint8_t)(k > 0 ? k + t : 0);
			}
		}
		import_file(input_bytes("formats", "first.ply", file, used), NULL);
		assert_int_equal(m.triangle_count, 2);
		assert_true(close_to(m.source.size[2], 3, 1e-5) && close_to(m.source.size[0], 1, 1e-4));
	}
}

UNIT_TEST(what_is_no_model_is_refused_with_what_to_do)
{
	struct fault { const char *name, *bytes, *code, *says; };

	static const char *const codes[] = { "bad input", "damaged", "unsupported", NULL };
	static const enum eco_code code_of[] = { ECO_BAD_INPUT, ECO_DAMAGED, ECO_UNSUPPORTED };
	uint32_t count;
	const struct fault *refused = cases_read("tests/import/cases/model_faults.tsv", sizeof *refused, &count);
	for (const struct fault *f = refused; f < refused + count; f++)
		import_refuses(input_bytes("formats", f->name, f->bytes, cases_size(&f->bytes)),
			code_of[cases_choice(f->code, codes)], f->says);
	import_refuses("build/tmp", ECO_BAD_INPUT, "a folder, not a model");
	import_refuses("build/tmp/formats/none.obj", ECO_NOT_FOUND, "No such file");
}

/* ---- Several files ---- */

UNIT_TEST(several_files_are_one_plant)
{
	const char *paths[3];
	input_text("formats", "wood.mtl", "newmtl same\nKd 1 0 0\n");
	input_text("formats", "leaf.mtl", "newmtl same\nKd 0 1 0\n");
	paths[0] = input_text("formats", "wood.obj", "mtllib wood.mtl\nusemtl same\no Stem\nv 9 0 0\nv 11 0 "
		"0\nv 10 4 0\nf 1 2 3\n");
	paths[1] = input_text("formats", "leaf.obj", "mtllib leaf.mtl\nusemtl same\nv 10 3 0\nv 11 5 0\nv "
		"10 5 0\nf 1 2 3\n");
	import_file(NULL, &(struct eco_model_options){ .paths = paths, .path_count = 2, .up = ECO_UP_Y,
		.height_m = 10 });
	assert_int_equal(m.triangle_count, 2);
	assert_true(close_to(m.foot[0], 10, 1e-6) && close_to(m.scale, 2, 1e-9) && has_place(0, 0, 8)
		&& has_place(2, 0, 10));
	assert_string_equal(m.parts[m.part[0]].name, "wood.obj/Stem");
	assert_string_equal(m.parts[m.part[1]].name, "leaf.obj");
	assert_true(m.materials[m.material[0]].rgb[0] == 255 && m.materials[m.material[1]].rgb[1] == 255);
}

/* A Collada file in inches, Z up; an OBJ file that says nothing is meant in the same system. */
UNIT_TEST(files_that_do_not_say_follow_those_that_do)
{
	const char *paths[2];
	paths[1] = input_text("formats", "says.dae", DAE("<unit meter=\"0.0254\"/><up_axis>Z_UP</up_axis>"));
	paths[0] = input_text("formats", "silent.obj", "v 44 50 160\nv 46 50 160\nv 45 50 200\nf 1 2 3\n");
	import_file(NULL, &(struct eco_model_options){ .paths = paths, .path_count = 2 });
	assert_true(m.source.up == ECO_UP_Z && close_to(m.source.size[2], 140, 1e-3)
		&& close_to(m.scale, 0.0254, 1e-9) && !strstr(import_said, "taken for"));
	paths[0] = input_text("formats", "metres.dae", DAE("<unit meter=\"1\"/><up_axis>Z_UP</up_axis>"));
	import_file(NULL, &(struct eco_model_options){ .paths = paths, .path_count = 2 });
	assert_true(close_to(m.source.size[2], 100 + 60 - 60 * 0.0254, 1e-3));
}

UNIT_TEST(one_bad_file_of_several_is_named)
{
	const char *paths[2] = { input_text("formats", "good.obj", TRIANGLE "f 1 2 3\n"),
		"build/tmp/formats/gone.obj" };
	eco_model_free(&m);
	assert_code(eco_model_import(&m, &(struct eco_model_options){ .paths = paths, .path_count = 2 },
		&cause), ECO_NOT_FOUND, "gone.obj");
	assert_null(m.position);
	assert_code(eco_model_import(&m, &(struct eco_model_options){ .paths = paths, .path_count = 0 },
		&cause), ECO_BAD_INPUT, "");
	paths[1] = paths[0];
	assert_code(eco_model_import(&m,
		&(struct eco_model_options){ .paths = paths, .path_count = 2, .triangles_max = 1 }, &cause),
		ECO_TOO_LARGE, "");
}

