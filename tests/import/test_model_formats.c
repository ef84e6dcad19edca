/* Formats and what people's exporters make of them: each oddity is written out as the small file that shows
 * it. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/model_try.h"

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

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

#define FBX(up, front, sign, unit, colour) "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: " \
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
	"\t\t\tP: " colour "\n\t\t}\n\t}\n}\nConnections:  " \
	"{\n\tC: \"OO\",2000,0\n\tC: \"OO\",1000,2000\n" \
	"\tC: \"OO\",3000,2000\n}\n"

#define GREY "\"DiffuseColor\", \"Color\", \"\", \"A\",0.2,0.2,0.2"
#define FACE "f 1 2 3\n"
#define TALL(units) "v 0 0 0\nv 1 0 0\nv 0 " units " 0\n" FACE
#define LYING "v 40 50 60\nv 50 50 60\nv 40 50 160\n" FACE
/* One triangle, 10 units wide and 100 units along the file's z, at (40, 50, 60). */
#define STATED "up_how=format|unit_how=format|material0=Bark|rgb0=51,51,51"
#define GIVEN "scale=0.5|up_how=given|unit_how=given|size="
#define STANDS "triangles=1|at=0.5,0,0|at=-0.5,0,1"
#define LIBRARY(line) line TRIANGLE "usemtl bark\n" FACE
#define VEILS "mtllib alpha.mtl\n" TRIANGLE "v 0 0 1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n"

static const struct model_case models[] = {
	{ "ply_text_brings_colours_and_counts_bad_faces", "color.ply", "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\n"
		"element vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nproperty uchar red\r\n"
		"property uchar green\r\nproperty uchar blue\r\nelement face 2\r\nproperty list uchar int vertex_indices\r\n"
		"end_header\r\n0 0 0 255 0 0\r\n1 0 0 255 0 0\r\n0 0 2 255 0 0\r\n0 1 0 255 0 0\r\n3 0 1 2\r\n3 0 1 9\r\n",
		.options = { .up = ECO_UP_Z }, .wanted = "triangles=1|bad=1|high=2|rgb0=255,0,0" },
	{ "ply_brings_colours_of_faces", "faces.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
		"property float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_index\nproperty uchar red\n"
		"property uchar green\nproperty uchar blue\nend_header\n0 0 0\n1 0 0\n0 0 2\n0 1 0\n3 0 1 2 255 0 0\n"
		"3 0 1 3 0 0 255\n", .options = { .up = ECO_UP_Z }, .wanted = "triangles=2|high=2|rgb0=255,0,0|rgb1=0,0,255" },
	{ "ply_brings_strips_of_triangles", "strips.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
		"property float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
		"0 0 0\n1 0 0\n0 0 2\n1 0 2\n0 1 0\n8 0 1 2 3 -1 0 1 4\n", .options = { .up = ECO_UP_Z },
		.wanted = "triangles=3|high=2" },
	{ NULL, "coloured_strips.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
		"property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement tristrips 1\n"
		"property list int int vertex_indices\nend_header\n0 0 0 0 255 0\n1 0 0 0 255 0\n0 0 2 0 255 0\n1 0 2 0 255 0\n"
		"4 0 1 2 3\n", .options = { .up = ECO_UP_Z }, .wanted = "triangles=2|rgb0=0,255,0" },
	{ "vertex_colours_beside_a_picture_are_weights", "weights.dae",
		RED_DAE("<library_images><image id=\"i\"><init_from>leaf.psd</init_from></image></library_images>",
		"<newparam sid=\"f\"><surface type=\"2D\"><init_from>i</init_from></surface></newparam>"
		"<newparam sid=\"s\"><sampler2D><source>f</source></sampler2D></newparam>",
		"<texture texture=\"s\" texcoord=\"u\"/>"),
		.wanted = "rgb0=255,255,255|~taken for weights of wind and shade, not for colours" },
	{ NULL, "colours.dae", RED_DAE("", "", "<color>1 1 1 1</color>"), .wanted = "rgb0=255,0,0" },
	{ "base_colours_are_linear_light", "base.fbx", FBX("2", "1", "-1", "100",
		"\"Maya|base_color\", \"Vector3D\", \"Vector\", \"\",0.067,0.0966,0.0529"), .wanted = "rgb0=73,88,65" },
	{ "formats_that_state_axes_and_unit_are_believed", "z.dae",
		DAE("<unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis>"),
		.wanted = STATED "|up=z|scale=0.0254|size=10,0,100|foot=45,50,60|part0=Trunk/g" },
	{ NULL, "y.dae", DAE("<up_axis>Y_UP</up_axis>"), .wanted = STATED "|up=y|scale=1|size=10,100,0|part0=Trunk/g" },
	{ NULL, "bare.dae", DAE(""), .wanted = STATED "|up=y|scale=1|size=10,100,0|part0=Trunk/g" },
	{ NULL, "z.fbx", FBX("2", "1", "-1", "2.54", GREY),
		.wanted = STATED "|up=z|scale=0.0254|size=10,0,100|foot=45,50,60|part0=Trunk/mesh" },
	{ NULL, "y.fbx", FBX("1", "2", "1", "1", GREY), .wanted = STATED "|up=y|scale=0.01|size=10,100,0|part0=Trunk/mesh" },
	{ NULL, "m.fbx", FBX("2", "1", "-1", "100", GREY),
		.wanted = STATED "|up=z|scale=1|size=10,0,100|foot=45,50,60|part0=Trunk/mesh" },
	{ "what_the_user_says_of_axes_and_unit_wins", "w.dae", DAE("<unit meter=\"0.0254\"/><up_axis> Y_UP </up_axis>"),
		.options = { .up = ECO_UP_Z, .unit_m = 0.5 }, .wanted = GIVEN "10,0,100" },
	{ NULL, "w.dae", DAE("<up_axis>Z_UP</up_axis>"), .options = { .up = ECO_UP_Z, .unit_m = 0.5 },
		.wanted = GIVEN "10,0,100" },
	{ NULL, "w.fbx", FBX("1", "2", "1", "1", GREY), .options = { .up = ECO_UP_Z, .unit_m = 0.5 },
		.wanted = GIVEN "10,0,100" },
	{ NULL, "w.fbx", FBX("2", "1", "-1", "1", GREY), .options = { .up = ECO_UP_Y, .unit_m = 0.5 },
		.wanted = GIVEN "10,100,0" },
	{ NULL, "w.obj", LYING, .options = { .up = ECO_UP_Z, .unit_m = 0.5 }, .wanted = GIVEN "10,0,100" },
	{ NULL, "w.obj", LYING, .options = { .up = ECO_UP_Y, .unit_m = 0.5 }, .wanted = GIVEN "10,100,0" },
	{ NULL, "w.obj", LYING, .options = { .up = ECO_UP_X, .unit_m = 0.5 }, .wanted = GIVEN "0,100,10" },
	{ NULL, "w.dae", DAE("<up_axis>Y_UP</up_axis>"), .options = { .up = ECO_UP_X, .unit_m = 0.5 },
		.wanted = GIVEN "0,100,10" },
	{ NULL, "w.fbx", FBX("2", "1", "-1", "1", GREY), .options = { .up = ECO_UP_X, .unit_m = 0.5 },
		.wanted = GIVEN "0,100,10" },
	{ "a_unit_is_guessed_from_the_height_and_said", "unit.obj", TALL("1103"), .options = { .up = ECO_UP_Y },
		.wanted = "high=11.03|unit_how=guessed|~1103 units high, taken for centimetres: 11 m; add \"unit\" or "
		"\"height_m\" if not" },
	{ NULL, "unit.obj", TALL("12"), .options = { .up = ECO_UP_Y },
		.wanted = "high=12|unit_how=guessed|~12 units high, taken for metres: 12 m" },
	{ NULL, "unit.obj", TALL("0.3"), .options = { .up = ECO_UP_Y }, .wanted = "high=0.3|~taken for metres: 0.3 m" },
	{ NULL, "unit.obj", TALL("61"), .options = { .up = ECO_UP_Y },
		.wanted = "high=0.61|~taken for centimetres: 0.61 m" },
	{ NULL, "unit.obj", TALL("18000"), .options = { .up = ECO_UP_Y }, .wanted = "high=18|~taken for millimetres: 18 m" },
	{ NULL, "unit.obj", .options = { .up = ECO_UP_Y, .height_m = 7 }, .wanted = "high=7|unit_how=height|!taken for" },
	{ NULL, "unit.obj", .options = { .up = ECO_UP_Y, .unit_m = 0.3048 },
		.wanted = "high=5486.4|unit_how=given|~high by the given unit" },
	{ NULL, "unit.obj", TALL("12"), .options = { .up = ECO_UP_Y, .unit_m = 0.3048 },
		.wanted = "high=3.6576|unit_how=given|!taken for" },
	{ "comments_about_units_are_read", "comment.obj", "# File units = centimeters\n" TRIANGLE FACE,
		.wanted = "scale=0.01|unit_how=format" },
	{ NULL, "comment.obj", "# Units: mm\n" TRIANGLE FACE, .wanted = "scale=0.001|unit_how=format" },
	{ NULL, "comment.obj", "#units=Inches\n" TRIANGLE FACE, .wanted = "scale=0.0254|unit_how=format" },
	{ NULL, "comment.obj", "# Unit: 1 m\n" TRIANGLE FACE, .wanted = "scale=1|unit_how=format" },
	{ NULL, "comment.obj", "# 12 units in the group\n" TRIANGLE FACE, .wanted = "unit_how=guessed" },
	{ NULL, "comment.obj", "# unit: minutes\n" TRIANGLE FACE, .wanted = "unit_how=guessed" },
	{ "any_line_end_and_byte_order_mark_will_do", "ends.obj", TRIANGLE FACE, .wanted = STANDS },
	{ NULL, "ends.obj", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", .wanted = STANDS },
	{ NULL, "ends.obj", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3", .wanted = STANDS },
	{ NULL, "ends.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", .wanted = STANDS },
	{ NULL, "ends.obj", "v  0\t0 0  \n\n  v 1 0 0 # right\nv 0 \\\n 1 0\nf 1 2 \\\r\n3\n", .wanted = STANDS },
	{ NULL, "ends.obj", "v 0 0 0 1.0\nv 1 0 0 1.0\nv 0 1 0 1.0\nf 1// 2// 3//\n", .wanted = STANDS },
	{ NULL, "ends.obj", TRIANGLE "vn 0 0 1\nf 1//1 2//1 3//1\n", .wanted = STANDS },
	{ NULL, "ends.obj", FACE TRIANGLE, .wanted = STANDS },
	{ NULL, "ends.obj", "mtllib\nusemtl\no\ng\ns 1\n" TRIANGLE "curv 0 1 1 2\nf -3 -2 -1\n", .wanted = STANDS },
	{ NULL, "ends.obj", "v +0 .0 0.e0\nv 1E0 0 0\nv 0 1.0e+0 0\nfo 1 2 3\n", .wanted = STANDS },
	{ "indices_that_are_not_there_cost_their_triangles_only", "index.obj", TRIANGLE "v 1 1 0\nf 1 2 3\nf 1 2 900\n"
		"f 0 1 2\nf -5 1 2\nf 1 x 2\nf 2 4 3 900 1\nf 99999999999999999999 1 2\nf 1 2\nf 1\nf\n",
		.wanted = "in=9|bad=7|triangles=2|~7 triangles name vertices that the file does not have" },
	{ "numbers_that_are_none_are_counted", "nan.obj", TRIANGLE "v nan 0 0\nv -nan(ind) 0 0\nv 1.#QNAN 0 0\n"
		"v 0 -1.#INF 0\nv 1e999 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\nf 1 2 7\nf 1 2 8\n",
		.wanted = "infinite=5|~5 triangles have coordinates that are no numbers" },
	/* a square metre at UTM coordinates in millimetres: a float there has steps of 0.5 m to the north */
	{ "map_coordinates_keep_their_detail", "utm.obj", "v 0 0 0\nv 747375.125 4308510.250 312.5\n"
		"v 747376.125 4308510.250 312.5\nv 747375.126 4308510.250 313.5\nv 747376.125 4308510.252 313.5\n"
		"f 2 3 4\nf 3 5 4\n", .options = { .up = ECO_UP_Z, .unit_m = 1 },
		.wanted = "foot=747375.625,4308510.25,312.5|at=-0.499,0,1|at=0.5,0.002,1" },
	{ "colours_of_vertices_may_be_shares_or_bytes", "vc.obj", "v 0 0 0 1 0.2 0\nv 1 0 0 1 0.2 0\nv 0 1 0 1 0.2 0\n" FACE,
		.wanted = "rgb0=255,51,0" },
	{ NULL, "vc.obj", "v 0 0 0 255 51 0\nv 1 0 0 255 51 0\nv 0 1 0 255 51 0\n" FACE, .wanted = "rgb0=255,51,0" },
	{ NULL, "vc.obj", "v 0 0 0 1 0.2 0 1\nv 1 0 0 1 0.2 0 1\nv 0 1 0 1 0.2 0 1\n" FACE, .wanted = "rgb0=255,51,0" },
	{ "libraries_are_found_as_exporters_meant", "lib.obj", LIBRARY("mtllib my trees.mtl\n"), "my trees.mtl",
		"newmtl bark\nKd 1 0 0\n", .wanted = "material0=bark|rgb0=255,0,0" },
	{ NULL, "lib.obj", LIBRARY("mtllib nothere.mtl b.mtl\n"), "b.mtl", "newmtl bark\nKd 1 0 0\n",
		.wanted = "material0=bark|rgb0=255,0,0|~nothere.mtl is not there" },
	{ NULL, "lib.obj", LIBRARY("mtllib C:\\Users\\me\\c.mtl\r\n"), "c.mtl", "newmtl bark\r\n\tKd 1 0 0\r\n",
		.wanted = "material0=bark|rgb0=255,0,0" },
	{ NULL, "lib.obj", LIBRARY("mtllib wald.mtl\n"), "Wald.MTL", "newmtl Bark\nkd 1.0 0.0 0.0\n",
		.wanted = "material0=bark|rgb0=255,0,0" },
	{ NULL, "lib.obj", LIBRARY("mtllib other.mtl\n"), "lib.mtl", "newmtl bark\nKd 1 0 0\n",
		.wanted = "material0=bark|rgb0=255,0,0|~lib.mtl stands in for it" },
	{ NULL, "lib.obj", LIBRARY(""), "lib.mtl", "\xef\xbb\xbfnewmtl bark\nKd 0.5 0.5 0.5\nnewmtl bark\nKd 1 0 0\n",
		.wanted = "material0=bark|rgb0=255,0,0" },
	{ "what_no_library_describes_is_grey_and_said", "bare.obj", TRIANGLE "v 0 0 1\nf 1 2 4\n"
		"usemtl \xc3\x84ste und Bl\xc3\xa4tter\nf 1 2 3\n", .wanted = "materials=2|material0=|rgb0=153,153,153|"
		"material1=\xc3\x84ste und Bl\xc3\xa4tter|rgb1=153,153,153|~1 of its materials are in no library "
		"(\xc3\x84ste und Bl\xc3\xa4tter): they have no colour" },
	{ NULL, "bare.obj", "mtllib gone.mtl\n" TRIANGLE "usemtl x\n" FACE,
		.wanted = "~its library of materials gone.mtl is not there" },
	/* d says how opaque, Tr how transparent, if exporters agree; no plant is meant to be invisible throughout */
	{ "transparency_is_read_with_sense", "alpha.obj", VEILS, "alpha.mtl", "newmtl a\nd 1\nTr 1\nnewmtl b\nd 1\nTr 1\n",
		.wanted = "clear=0" },
	{ NULL, "alpha.obj", VEILS, "alpha.mtl", "newmtl a\nTr 0\nnewmtl b\nTr 1\n",
		.wanted = "clear=1|~1 triangles have materials with alpha" },
	{ NULL, "alpha.obj", VEILS, "alpha.mtl", "newmtl a\nTr 1.0\nnewmtl b\nTr 1.0\n",
		.wanted = "clear=0|~all of its materials are fully transparent" },
	{ NULL, "alpha.obj", VEILS, "alpha.mtl", "newmtl a\nd 0\nnewmtl b\nd 0\n", .wanted = "clear=0|~taken for opaque" },
	{ NULL, "alpha.obj", VEILS, "alpha.mtl", "newmtl a\nd -halo 0.6\nnewmtl b\nd 0.2\n", .wanted = "clear=1" },
	{ "objects_and_groups_are_parts", "parts.obj", TRIANGLE "v 0 0 1\nv 0 0 2\nv 0 0 3\nf 1 2 3\no Oak Tree\nf 1 2 4\n"
		"g leaves\nf 1 2 5\no Pot\nf 1 2 6\n",
		.wanted = "parts=4|part0=|part1=Oak Tree|part2=Oak Tree/leaves|part3=Pot" },
};

UNIT_TEST(files_are_read_as_people_mean_them)
{
	expect_models("formats", models, sizeof models / sizeof *models);
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

#define TEXT(text) text, sizeof text - 1

UNIT_TEST(what_is_no_model_is_refused_with_what_to_do)
{
	static const struct { const char *name, *bytes; size_t size; enum eco_code code; const char *says; } refused[] = {
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
		{ "cloud.laz", "LASF", 4, ECO_UNSUPPORTED, "a point cloud" },
		{ "cloud.ply", TEXT("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
			"property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n"), ECO_BAD_INPUT, "no triangles in it, only 3 "
			"points or lines; a point cloud has no surfaces: make a mesh of it first" },
		{ "comma.obj", TEXT("# oak\nv 0,5 1,25 0\n"), ECO_BAD_INPUT, "line 2: \"0,5\": numbers need a decimal point" },
		{ "word.obj", TEXT("v 1 2 three\n"), ECO_BAD_INPUT, "line 1: \"three\" is not a number" },
		{ "short.obj", TEXT("v 1 2\n"), ECO_BAD_INPUT, "line 1: a vertex needs three numbers" },
		{ "coff.obj", "\x64\x86\x03\0\0\0\0\0", 8, ECO_BAD_INPUT, "binary, so no Wavefront OBJ file" },
		{ "wide.obj", "\xff\xfev\0 \0", 6, ECO_UNSUPPORTED, "UTF-16; save it as UTF-8" },
		{ "prose.obj", TEXT("This is a tree.\n"), ECO_BAD_INPUT, "no vertices in it" },
		{ "lines.obj", TEXT(TRIANGLE "l 1 2 3\np 1\n"), ECO_BAD_INPUT, "no triangles in it, only 3 vertices and 2 "
			"points or lines; a point cloud has no surfaces" },
	};

	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		import_refuses(input_bytes("formats", refused[i].name, refused[i].bytes, refused[i].size),
			refused[i].code, refused[i].says);
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

