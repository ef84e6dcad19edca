/* Formats and what people's exporters make of them: each oddity is written out as the small file that shows
 * it. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/model_try.h"

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

/* ---- PLY ---- */

UNIT_TEST(ply_text_brings_colours_and_counts_bad_faces)
{
	import_file(input_text("formats", "color.ply", "ply\r\nformat ascii 1.0\r\ncomment made by "
		"hand\r\nelement vertex 4\r\nproperty float x\r\n"
		"property float y\r\nproperty float z\r\nproperty uchar red\r\nproperty uchar "
		"green\r\nproperty uchar blue\r\nelement face 2\r\n"
		"property list uchar int vertex_indices\r\nend_header\r\n0 0 0 255 0 0\r\n1 0 0 255 0 "
		"0\r\n0 0 2 255 0 0\r\n0 1 0 255 0 0\r\n"
		"3 0 1 2\r\n3 0 1 9\r\n"), &(struct eco_model_options){ .up = ECO_UP_Z });
	assert_int_equal(m.triangle_count, 1);
	assert_int_equal(m.dropped[ECO_DROP_BAD_INDEX], 1);
	assert_true(close_to(eco_model_height(&m), 2, 1e-6));
	assert_memory_equal(m.materials[m.material[0]].rgb, ((const uint8_t[]){ 255, 0, 0 }), 3);
}

UNIT_TEST(a_point_cloud_is_refused_as_one)
{
	import_refuses(input_text("formats", "cloud.ply",
			       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
			       "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n"),
		ECO_BAD_INPUT,
		"no triangles in it, only 3 points or lines; a point cloud has no surfaces: make a mesh of "
		"it first");
	import_refuses(input_text("formats", "cloud.laz", "LASF"), ECO_UNSUPPORTED, "a point cloud");
}

/* ---- Axes and units that formats state ---- */

/* A triangle in Collada; `images`, `sampler`, `colours` and `input`: what a picture and colours of vertices take. */
#define COLLADA(asset, images, sampler, diffuse, places, colours, input, node) "<?xml version=\"1.0\"?>\n<COLLADA " \
	"xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset>" asset "</asset>" images \
	"<library_effects><effect id=\"e\"><profile_COMMON>" sampler "<technique sid=\"c\"><lambert><diffuse>" \
	diffuse "</diffuse></lambert></technique></profile_COMMON></effect></library_effects><library_materials>" \
	"<material id=\"m\" name=\"Bark\"><instance_effect url=\"#e\"/></material></library_materials>" \
	"<library_geometries><geometry id=\"g\" name=\"g\"><mesh>" SOURCE("p", places, "X", "Y", "Z") colours \
	"<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles material=\"s\" " \
	"count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>" input "<p>0 1 2</p></triangles>" \
	"</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"w\">" \
	"<node id=\"n\" name=\"Trunk\">" node "<instance_geometry url=\"#g\"><bind_material><technique_common>" \
	"<instance_material symbol=\"s\" target=\"#m\"/></technique_common></bind_material></instance_geometry>" \
	"</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#w\"/></scene></COLLADA>\n"
#define SOURCE(id, values, x, y, z) "<source id=\"" id "\"><float_array id=\"" id "a\" count=\"9\">" values \
	"</float_array><technique_common><accessor source=\"#" id "a\" count=\"3\" stride=\"3\">" \
	"<param name=\"" x "\" type=\"float\"/><param name=\"" y "\" type=\"float\"/>" \
	"<param name=\"" z "\" type=\"float\"/></accessor></technique_common></source>"
#define DAE(asset) COLLADA(asset, "", "", "<color>0.2 0.2 0.2 1</color>", "0 0 0 10 0 0 0 0 100", "", "", \
	"<translate>40 50 60</translate>")
/* Its vertices are red. */
#define RED_DAE(images, sampler, diffuse) COLLADA("", images, sampler, diffuse, "0 0 0 1 0 0 0 1 0", \
	SOURCE("q", "1 0 0 1 0 0 1 0 0", "R", "G", "B"), "<input semantic=\"COLOR\" source=\"#q\" offset=\"0\"/>", "")

#define FBX(up, front, sign, unit) "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: " \
	"1003\n\tFBXVersion: 7300\n}\nGlobalSettings:  {\n" \
	"\tVersion: 1000\n\tProperties70:  {\n\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\"," up "\n" \
	"\t\tP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n" \
	"\t\tP: \"FrontAxis\", \"int\", \"Integer\", \"\"," front "\n\t\tP: \"FrontAxisSign\", \"int\", " \
	"\"Integer\", \"\"," sign "\n" \
	"\t\tP: \"CoordAxis\", \"int\", \"Integer\", \"\",0\n\t\tP: \"CoordAxisSign\", \"int\", " \
	"\"Integer\", \"\",1\n" \
	"\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\"," unit "\n\t}\n}\nDefinitions:  " \
	"{\n\tVersion: 100\n\tCount: 3\n" \
	"\tObjectType: \"Geometry\" {\n\t\tCount: 1\n\t}\n\tObjectType: \"Model\" {\n\t\tCount: " \
	"1\n\t}\n\tObjectType: \"Material\" {\n\t\tCount: 1\n\t}\n}\n" \
	"Objects:  {\n\tGeometry: 1000, \"Geometry::mesh\", \"Mesh\" {\n\t\tVertices: *9 {\n\t\t\ta: " \
	"0,0,0,10,0,0,0,0,100\n\t\t}\n" \
	"\t\tPolygonVertexIndex: *3 {\n\t\t\ta: 0,1,-3\n\t\t}\n\t\tGeometryVersion: " \
	"124\n\t\tLayerElementMaterial: 0 {\n\t\t\tVersion: 101\n\t\t\tName: \"\"\n" \
	"\t\t\tMappingInformationType: \"AllSame\"\n\t\t\tReferenceInformationType: " \
	"\"IndexToDirect\"\n\t\t\tMaterials: *1 {\n\t\t\t\ta: 0\n\t\t\t}\n" \
	"\t\t}\n\t\tLayer: 0 {\n\t\t\tVersion: 100\n\t\t\tLayerElement:  {\n\t\t\t\tType: " \
	"\"LayerElementMaterial\"\n\t\t\t\tTypedIndex: 0\n" \
	"\t\t\t}\n\t\t}\n\t}\n\tModel: 2000, \"Model::Trunk\", \"Mesh\" {\n\t\tVersion: 232\n" \
	"\t\tProperties70:  {\n\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", " \
	"\"A\",40,50,60\n\t\t}\n\t}\n" \
	"\tMaterial: 3000, \"Material::Bark\", \"\" {\n\t\tVersion: 102\n\t\tShadingModel: " \
	"\"lambert\"\n\t\tProperties70:  {\n" \
	"\t\t\tP: \"DiffuseColor\", \"Color\", \"\", \"A\",0.2,0.2,0.2\n\t\t}\n\t}\n}\nConnections:  " \
	"{\n\tC: \"OO\",2000,0\n\tC: \"OO\",1000,2000\n" \
	"\tC: \"OO\",3000,2000\n}\n"

UNIT_TEST(vertex_colours_beside_a_picture_are_weights)
{
	import_file(input_text("formats", "weights.dae",
		RED_DAE("<library_images><image id=\"i\"><init_from>leaf.psd</init_from></image></library_images>",
		"<newparam sid=\"f\"><surface type=\"2D\"><init_from>i</init_from></surface></newparam>"
		"<newparam sid=\"s\"><sampler2D><source>f</source></sampler2D></newparam>",
		"<texture texture=\"s\" texcoord=\"u\"/>")), NULL);
	const struct eco_material *leaf = &m.materials[m.material[0]];
	assert_false(leaf->rgb[0] == 255 && leaf->rgb[1] == 0);
	import_says("taken for weights of wind and shade, not for colours");
	import_file(input_text("formats", "colours.dae", RED_DAE("", "", "<color>1 1 1 1</color>")), NULL);
	assert_memory_equal(m.materials[m.material[0]].rgb, ((const uint8_t[]){ 255, 0, 0 }), 3);
}

UNIT_TEST(base_colours_are_linear_light)
{
	static const char plain[] = "\"DiffuseColor\", \"Color\", \"\", \"A\",0.2,0.2,0.2",
		based[] = "\"Maya|base_color\", \"Vector3D\", \"Vector\", \"\",0.067,0.0966,0.0529";
	static const char file[] = FBX("2", "1", "-1", "100");
	const char *at = strstr(file, plain);
	char text[6000];
	snprintf(text, sizeof text, "%.*s%s%s", (int)(at - file), file, based, at + sizeof plain - 1);
	import_file(input_text("formats", "base.fbx", text), NULL);
	assert_memory_equal(m.materials[0].rgb, ((const uint8_t[]){ 73, 88, 65 }), 3);
	import_file(input_text("formats", "plain.fbx", file), NULL);
	assert_memory_equal(m.materials[0].rgb, ((const uint8_t[]){ 51, 51, 51 }), 3);
}

/* One triangle, 10 units wide and 100 units along the file's z, at (40, 50, 60). */
UNIT_TEST(formats_that_state_axes_and_unit_are_believed)
{
	static const struct { const char *name, *text; enum eco_up up; double unit_m, wide, deep, high,
		foot[3]; } cases[] = {
		{ "z.dae", DAE("<unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis>"), ECO_UP_Z,
			0.0254, 10, 0, 100, { 45, 50, 60 } },
		{ "y.dae", DAE("<up_axis>Y_UP</up_axis>"), ECO_UP_Y, 1, 10, 100, 0, { 0, 0, 50 } },
		{ "bare.dae", DAE(""), ECO_UP_Y, 1, 10, 100, 0, { 0, 0, 50 } },
		{ "z.fbx", FBX("2", "1", "-1", "2.54"), ECO_UP_Z, 0.0254, 10, 0, 100, { 45, 50, 60 } },
		{ "y.fbx", FBX("1", "2", "1", "1"), ECO_UP_Y, 0.01, 10, 100, 0, { 0, 0, 50 } },
		{ "m.fbx", FBX("2", "1", "-1", "100"), ECO_UP_Z, 1, 10, 0, 100, { 45, 50, 60 } },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		import_file(input_text("formats", cases[i].name, cases[i].text), NULL);
		if (m.source.up != cases[i].up || m.source.up_how != ECO_HOW_FORMAT
				|| m.source.unit_how != ECO_HOW_FORMAT
			|| !close_to(m.scale, cases[i].unit_m, 1e-9)
			|| !close_to(m.source.size[0], cases[i].wide, 1e-3)
			|| !close_to(m.source.size[1], cases[i].deep, 1e-3)
			|| !close_to(m.source.size[2], cases[i].high, 1e-3)
			|| !close_to(m.foot[2], cases[i].foot[2], 1e-3)
			|| (cases[i].high > 0
			&& (!close_to(m.foot[0], cases[i].foot[0], 1e-3)
			|| !close_to(m.foot[1], cases[i].foot[1], 1e-3))))
			fail_msg("%s: %g x %g x %g of %g m, foot %g %g %g: %s", cases[i].name,
				m.source.size[0], m.source.size[1], m.source.size[2], m.scale, m.foot[0],
				m.foot[1], m.foot[2], import_said);
		assert_string_equal(m.materials[0].name, "Bark");
		assert_int_equal(m.materials[0].rgb[0], 51);
		assert_memory_equal(m.parts[0].name, "Trunk", 5);
	}
}

UNIT_TEST(what_the_user_says_of_axes_and_unit_wins)
{
	static const struct { const char *name, *text; enum eco_up up; double high; } cases[] = {
		{ "w.dae", DAE("<unit meter=\"0.0254\"/><up_axis> Y_UP </up_axis>"), ECO_UP_Z, 100 },
		{ "w.dae", DAE("<up_axis>Z_UP</up_axis>"), ECO_UP_Z, 100 },
		{ "w.fbx", FBX("1", "2", "1", "1"), ECO_UP_Z, 100 },
		{ "w.fbx", FBX("2", "1", "-1", "1"), ECO_UP_Y, 0 },
		{ "w.obj", "v 40 50 60\nv 50 50 60\nv 40 50 160\nf 1 2 3\n", ECO_UP_Z, 100 },
		{ "w.obj", "v 40 50 60\nv 50 50 60\nv 40 50 160\nf 1 2 3\n",
			ECO_UP_Y, 0 },
		{ "w.obj", "v 40 50 60\nv 50 50 60\nv 40 50 160\nf 1 2 3\n", ECO_UP_X, 10 },
		{ "w.dae", DAE("<up_axis>Y_UP</up_axis>"), ECO_UP_X, 10 },
		{ "w.fbx", FBX("2", "1", "-1", "1"), ECO_UP_X, 10 },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		import_file(input_text("formats", cases[i].name, cases[i].text),
			&(struct eco_model_options){ .up = cases[i].up, .unit_m = 0.5 });
		if (!close_to(m.source.size[2], cases[i].high, 1e-3) || m.scale != 0.5
				|| m.source.up_how != ECO_HOW_GIVEN || m.source.unit_how != ECO_HOW_GIVEN)
			fail_msg("case %zu: %g high, scale %g", i, m.source.size[2], m.scale);
	}
}

/* ---- Units that nobody states ---- */

static const struct { double units; const char *says; double metres; } a_unit_cases[] = {
	{ 1103, "1103 units high, taken for centimetres: 11 m; add \"unit\" or \"height_m\" if not",
		11.03 },
	{ 12, "12 units high, taken for metres: 12 m", 12 }, { 0.3, "taken for metres: 0.3 m", 0.3 },
	{ 61, "taken for centimetres: 0.61 m", 0.61 },
	{ 18000, "taken for millimetres: 18 m", 18 },
};

UNIT_TEST(a_unit_is_guessed_from_the_height_and_said)
{
	for (size_t i = 0; i < sizeof a_unit_cases / sizeof *a_unit_cases; i++) {
		char text[200];
		snprintf(text, sizeof text, "v 0 0 0\nv 1 0 0\nv 0 %g 0\nf 1 2 3\n", a_unit_cases[i].units);
		import_file(input_text("formats", "unit.obj", text),
			&(struct eco_model_options){ .up = ECO_UP_Y });
		import_says(a_unit_cases[i].says);
		assert_true(close_to(eco_model_height(&m), a_unit_cases[i].metres, 1e-4) && m.source.unit_how
			== ECO_HOW_GUESSED);
		import_file("build/tmp/formats/unit.obj",
			&(struct eco_model_options){ .up = ECO_UP_Y, .height_m = 7 });
		assert_true(close_to(eco_model_height(&m), 7, 1e-5) && !strstr(import_said, "taken for")
			&& m.source.unit_how == ECO_HOW_HEIGHT);
		import_file("build/tmp/formats/unit.obj",
			&(struct eco_model_options){ .up = ECO_UP_Y, .unit_m = 0.3048 });
		assert_true(close_to(eco_model_height(&m) / (a_unit_cases[i].units * 0.3048), 1, 1e-5));
		if (a_unit_cases[i].units * 0.3048 > 120)
			import_says("high by the given unit");
	}
}

UNIT_TEST(comments_about_units_are_read)
{
	static const struct { const char *comment; double metres; } cases[] =
		{ { "# File units = centimeters", 0.01 }, { "# Units: mm", 0.001 },
		{ "#units=Inches", 0.0254 }, { "# Unit: 1 m", 1 }, { "# 12 units in the group", 0 },
		{ "# unit: minutes", 0 } };

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char text[200];
		snprintf(text, sizeof text, "%s\n" TRIANGLE "f 1 2 3\n", cases[i].comment);
		import_file(input_text("formats", "comment.obj", text), NULL);
		if (m.source.unit_how != (cases[i].metres > 0 ? ECO_HOW_FORMAT : ECO_HOW_GUESSED)
				|| (cases[i].metres > 0 && m.scale != cases[i].metres))
			fail_msg("%s: %g", cases[i].comment, m.scale);
	}
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
	static const struct { const char *name, *bytes; size_t size; enum eco_code code; const char *says;
		} cases[] = {
		{ "oak.obj.xz", "\xfd" "7zXZ\0\0", 7, ECO_UNSUPPORTED,
			"packed with xz; unpack it first: xz -dk oak.obj.xz" },
		{ "oak.obj.gz", "\x1f\x8b\x08", 3, ECO_UNSUPPORTED, "gunzip -k oak.obj.gz" },
		{ "oak.blend", "\x1f\x8b\x08", 3, ECO_UNSUPPORTED,
			"zcat <oak.blend >unpacked-oak.blend" },
			{ "oak.zip", "PK\x03\x04", 4, ECO_UNSUPPORTED, "unzip oak.zip" },
		{ "oak.obj", "BZh91AY", 7, ECO_UNSUPPORTED, "bzcat <oak.obj >unpacked-oak.obj" },
		{ "oak.glb", "", 0, ECO_BAD_INPUT, "the file is empty" },
		{ "oak.fbx", "version https://git-lfs.github.com/spec/v1\n", 43, ECO_BAD_INPUT,
			"a pointer of Git LFS" },
		{ "oak.gltf", "\n<!DOCTYPE html><html>", 22, ECO_BAD_INPUT, "a web page, not a model" },
		{ "oak.mtl", "newmtl x\n", 9, ECO_UNSUPPORTED, "name the OBJ file" },
		{ "oak.skp", "x", 1, ECO_UNSUPPORTED, "export GLB, Collada or OBJ" },
		{ "oak.usdz", "PK\3\4", 4, ECO_UNSUPPORTED, "USD is not read" },
		{ "oak.STEP", "ISO-10303", 9, ECO_UNSUPPORTED, "CAD" },
		{ "oak.blend", "BLENDER-v300", 12, ECO_UNSUPPORTED, "export GLB" },
		{ "oak.x3d", "<X3D></X3D>", 11, ECO_UNSUPPORTED, "by these endings: export GLB" },
		{ "oak.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 5 0\n3 0 1 2\n", 36, ECO_UNSUPPORTED,
			"export GLB" },
		{ "oak", "; FBX 7.4.0 project file", 24, ECO_UNSUPPORTED, "by these endings: export GLB" },
		{ "oak.fbx", "Kaydara FBX", 11, ECO_BAD_INPUT, "oak.fbx" },
		{ "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", 32, ECO_BAD_INPUT,
			"none of its 1 triangles can be drawn (degenerate); is the file whole?" },
		{ "stems.csv", "species,x,y\nquru,1,2\n", 21, ECO_UNSUPPORTED,
			"stems.csv: models are GLB, glTF, OBJ" },
		{ "cut.glb", "glTF", 4, ECO_DAMAGED, "cut.glb" },
		{ "json.gltf", "{\"asset\":", 9, ECO_BAD_INPUT, "json.gltf: line 1" },
		{ "index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 900\n", 34, ECO_BAD_INPUT, "index.obj" },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		import_refuses(input_bytes("formats", cases[i].name, cases[i].bytes, cases[i].size),
			cases[i].code, cases[i].says);
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
		import_file(input_text("formats", "ends.obj", files[i]),
			&(struct eco_model_options){ .up = ECO_UP_Y });
		if (m.triangle_count != 1 || !has_place(0.5, 0, 0) || !has_place(-0.5, 0, 1))
			fail_msg("file %zu: %u triangles", i, m.triangle_count);
	}
}

UNIT_TEST(indices_that_are_not_there_cost_their_triangles_only)
{
	import_file(input_text("formats", "index.obj", TRIANGLE "v 1 1 0\nf 1 2 3\nf 1 2 900\nf 0 1 2\nf "
		"-5 1 2\nf 1 x 2\nf 2 4 3 900 1\nf 99999999999999999999 1 2\nf 1 2\nf 1\nf\n"), NULL);
	assert_int_equal(m.triangles_in, 1 + 4 + 3 + 1);
	assert_int_equal(m.dropped[ECO_DROP_BAD_INDEX], 4 + 2 + 1);
	assert_int_equal(m.triangle_count, 2);
	import_says("7 triangles name vertices that the file does not have");
}

UNIT_TEST(numbers_that_are_none_are_counted_or_named_with_their_line)
{
	import_file(input_text("formats", "nan.obj", TRIANGLE "v nan 0 0\nv -nan(ind) 0 0\nv 1.#QNAN 0 "
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
	import_file(input_text("formats", "utm.obj", "v 0 0 0\nv 747375.125 4308510.250 312.5\nv "
		"747376.125 4308510.250 312.5\n"
		"v 747375.126 4308510.250 313.5\nv 747376.125 4308510.252 313.5\nf 2 3 4\nf 3 5 4\n"),
		&(struct eco_model_options){ .up = ECO_UP_Z,
		.unit_m = 1 });
	assert_true(close_to(m.foot[0], 747375.625, 1e-6) && close_to(m.foot[1], 4308510.25, 1e-6)
		&& close_to(m.foot[2], 312.5, 1e-6));
	assert_true(has_place(-0.499, 0, 1) && has_place(0.5, 0.002, 1));
}

UNIT_TEST(colours_of_vertices_may_be_shares_or_bytes)
{
	static const char *const files[] = { "v 0 0 0 1 0.2 0\nv 1 0 0 1 0.2 0\nv 0 1 0 1 0.2 0\nf 1 2 3\n",
		"v 0 0 0 255 51 0\nv 1 0 0 255 51 0\nv 0 1 0 255 51 0\nf 1 2 3\n",
		"v 0 0 0 1 0.2 0 1\nv 1 0 0 1 0.2 0 1\nv 0 1 0 1 0.2 0 1\nf 1 2 3\n" };

	for (size_t i = 0; i < 3; i++) {
		import_file(input_text("formats", "vc.obj", files[i]), NULL);
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
		import_file(input_text("formats", "lib.obj", text), NULL);
		if (material_of("bark")->rgb[0] != 255 || material_of("bark")->rgb[1] != 0)
			fail_msg("case %zu: %s", i, import_said);
		import_says(cases[i].says);
		unlink(input_path("formats", cases[i].file));
	}
}

UNIT_TEST(what_no_library_describes_is_grey_and_said)
{
	import_file(input_text("formats", "bare.obj", TRIANGLE "v 0 0 1\nf 1 2 4\nusemtl \xc3\x84ste "
		"und Bl\xc3\xa4tter\nf 1 2 3\n"), NULL);
	assert_int_equal(m.material_count, 2);
	assert_int_equal(material_of("\xc3\x84ste und Bl\xc3\xa4tter")->rgb[1], 153);
	assert_int_equal(material_of("")->rgb[1], 153);
	import_says("1 of its materials are in no library (\xc3\x84ste und Bl\xc3\xa4tter): they have no "
		"colour");
	import_file(input_text("formats", "bare.obj", "mtllib gone.mtl\n" TRIANGLE "usemtl x\nf 1 2 3\n"),
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
		import_file(input_text("formats", "alpha.obj", "mtllib alpha.mtl\n" TRIANGLE
			"v 0 0 1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n"), NULL);
		if (m.dropped[ECO_DROP_TRANSPARENT] != cases[i].hidden)
			fail_msg("case %zu: %u left out", i, m.dropped[ECO_DROP_TRANSPARENT]);
		import_says(cases[i].says);
	}
}

UNIT_TEST(objects_and_groups_are_parts)
{
	import_file(input_text("formats", "parts.obj", TRIANGLE "v 0 0 1\nv 0 0 2\nv 0 0 3\nf 1 2 3\no "
		"Oak Tree\nf 1 2 4\ng leaves\nf 1 2 5\no Pot\nf 1 2 6\n"), NULL);
	assert_int_equal(m.part_count, 4);
	assert_string_equal(m.parts[m.part[0]].name, "");
	assert_string_equal(m.parts[m.part[1]].name, "Oak Tree");
	assert_string_equal(m.parts[m.part[2]].name, "Oak Tree/leaves");
	assert_string_equal(m.parts[m.part[3]].name, "Pot");
}
