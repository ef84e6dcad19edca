/* glTF models: what a viewer would show at rest is what arrives; the rest is counted, said, or refused by
 * name. */
#include <math.h>

#include "ecofiles/format/chunk/draco_shim.h"
#include "ecofiles/format/image.h"
#include "ecofiles/import/model/import_model.h"
#include "ecofiles/import/model/model_import.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

/* The model that the test looks at; reading the next frees it. */
static struct eco_model m;

/* ---- Models: as they are read, before anything is dropped or moved ---- */

static struct eco_model_frame frame;
static struct eco_notes notes;

static enum eco_code read_model(const char *rest, uint32_t triangles_max,
	struct eco_error *error)
{
	uint8_t *bytes;
	size_t size = gw_glb_bytes(rest, ' ', &bytes);
	eco_model_free(&m);
	frame = (struct eco_model_frame){ .unit_m = 0 };
	notes = (struct eco_notes){ .used = 0 };
	enum eco_code code = eco_gltf_read_model(&m, &frame, input_bytes("gltf_model", "m.glb", bytes, size),
		triangles_max, &notes, error);
	free(bytes);
	return code;
}

static void read_good(const char *rest)
{
	uint64_t accounted;
	assert_good(read_model(rest, 1000000, &cause));
	accounted = m.triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m.dropped[i];
	assert_int_equal(accounted, m.triangles_in);
	assert_true(frame.unit_m == 1 && frame.up == ECO_UP_Y);
	for (uint32_t i = 0; i < m.triangle_count; i++)
		assert_true(m.material[i] < m.material_count && m.part[i] < m.part_count);
}

static void read_fails(const char *rest, enum eco_code wanted, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	enum eco_code code = read_model(rest, 1000, &error);
	if (code != wanted || !strstr(error.text, says))
		fail_msg("%s: %s\n  wanted %s ... %s", eco_code_name(code), error.text, eco_code_name(wanted),
			says);
}

/* Corner c of triangle t is at that place, in the file's own axes. */
static void expect_corner(uint32_t t, uint32_t c, double x, double y, double z)
{
	const float *p;
	assert_true(t < m.triangle_count && m.index[t * 3 + c] < m.vertex_count);
	p = &m.position[m.index[t * 3 + c] * 3];
	if (fabs((double)p[0] - x) + fabs((double)p[1] + z) + fabs((double)p[2] - y) > 1e-4)
		fail_msg("corner %u of triangle %u is at %g %g %g, not %g %g %g", c, t, (double)p[0],
			(double)p[2], -(double)p[1], x, y, z);
}

static const float square[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } };

/* A file whose accessor 0 is its first `count` corners. */
static void gw_square(size_t count)
{
	gw_begin();
	gw_floats(square[0], count, "VEC3", 3);
}

#define ONE_MESH(attributes, more) ",'scenes':[{'nodes':[0]}],'nodes':[{'mesh':0}]," \
	"'meshes':[{'primitives':[{'attributes':{" attributes "}" more "}]}]"

UNIT_TEST(indices_of_every_type_or_none_make_triangles)
{
	static const uint8_t bytes[6] = { 0, 1, 2, 2, 1, 3 };
	static const uint16_t shorts[6] = { 0, 1, 2, 2, 1, 3 };
	static const uint32_t words[6] = { 0, 1, 2, 2, 1, 3 };
	for (int i = 0; i < 4; i++) {
		gw_square(i < 3 ? 4 : 3);
		if (i == 0)
			gw_accessor(gw_view(bytes, sizeof bytes, ""), GLTF_UBYTE, 6, "SCALAR", "");
		else if (i == 1)
			gw_accessor(gw_view(shorts, sizeof shorts, ""), GLTF_USHORT, 6, "SCALAR", "");
		else
			gw_accessor(gw_view(words, sizeof words, ""), GLTF_UINT, 6, "SCALAR", "");
		read_good(i < 3 ? ONE_MESH("'POSITION':0", ",'indices':1")
			: ONE_MESH("'POSITION':0", ""));
		assert_int_equal(m.triangle_count, i < 3 ? 2 : 1);
		expect_corner(0, 1, 1, 0, 0);
		if (i < 3)
			expect_corner(1, 2, 1, 1, 0);
	}
}

UNIT_TEST(strips_and_fans_become_triangles)
{
	static const uint16_t strip[] = { 0, 1, 2, 3, 0xffff, 3, 2, 1 }, fan[] = { 0, 1, 3, 2 };
	gw_square(4);
	gw_accessor(gw_view(strip, sizeof strip, ""), GLTF_USHORT, 8, "SCALAR", "");
	gw_accessor(gw_view(fan, sizeof fan, ""), GLTF_USHORT, 4, "SCALAR", "");
	read_good(ONE_MESH("'POSITION':0", ",'indices':1,'mode':5"));
	assert_int_equal(m.triangle_count, 3);       /* and one behind the restart */
	expect_corner(0, 2, 0, 1, 0);
	expect_corner(1, 0, 0, 1, 0);            /* the second keeps the first's winding */
	expect_corner(1, 1, 1, 0, 0);
	expect_corner(1, 2, 1, 1, 0);
	expect_corner(2, 0, 1, 1, 0);
	read_good(ONE_MESH("'POSITION':0", ",'indices':2,'mode':6"));
	assert_int_equal(m.triangle_count, 2);
	expect_corner(1, 0, 0, 0, 0);
	expect_corner(1, 1, 1, 1, 0);
	expect_corner(1, 2, 0, 1, 0);
}

UNIT_TEST(points_and_lines_are_counted_and_said)
{
	gw_square(4);
	read_good(",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}},"
		"{'attributes':{'POSITION':0},'mode':0},{'attributes':{'POSITION':0},'mode':3},"
		"{'attributes':{}}]}]");
	assert_int_equal(m.triangle_count, 1);
	assert_non_null(strstr(notes.text, "4 points are left out: only triangles are drawn\n3 lines are left out"));
	assert_non_null(strstr(notes.text, "1 primitives without positions"));
	assert_non_null(strstr(notes.text, "1 corners"));
	read_fails(ONE_MESH("'POSITION':0", ",'mode':0"), ECO_BAD_INPUT, "only 4 points");
	read_fails(ONE_MESH("'POSITION':0", ",'mode':9"), ECO_DAMAGED,
		"meshes[0].primitives[0]: its mode");
	read_fails("", ECO_BAD_INPUT, "no triangles in its scene");
}

UNIT_TEST(a_broken_index_is_kept_apart)
{
	static const uint16_t indices[6] = { 0, 1, 2, 2, 1, 4 };
	gw_square(4);
	gw_accessor(gw_view(indices, sizeof indices, ""), GLTF_USHORT, 6, "SCALAR", "");
	read_good(ONE_MESH("'POSITION':0", ",'indices':1"));
	assert_int_equal(m.triangle_count, 2);
	assert_int_equal(m.index[5], ECO_NONE);
	assert_int_equal(m.vertex_count, 3);         /* what nobody names is left behind */
}

UNIT_TEST(places_far_from_the_origin_keep_their_detail)
{
	static const float far[3][3] = { { 1e7f, 0, 0 }, { 1e7f + 1, 0, 0 }, { 1e7f, 1, 0 } };
	gw_square(3);
	gw_floats(far[0], 3, "VEC3", 3);
	read_good(",'scenes':[{'nodes':[0]}],'nodes':[{'mesh':0,'translation':[5000000.25,100,0]}],"
		"'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]");
	assert_true(frame.base[0] == 5000000 && (double)m.position[0] == 0.25 && (double)m.position[3]
		== 1.25);
	assert_string_equal(notes.text, "");
	read_good(ONE_MESH("'POSITION':1", ""));
	assert_non_null(strstr(notes.text, "in single precision"));
}

UNIT_TEST(parts_are_nodes_and_meshes)
{
	gw_square(3);
	read_good(",'nodes':[{'mesh':0,'name':'Tree'},{'mesh':0},{'mesh':0,'name':'Leaves'},"
		"{'mesh':1,'name':'Pot'},{'mesh':1,'name':'Pot'}],"
		"'meshes':[{'name':'Leaves','primitives':[{'attributes':{'POSITION':0}}]},"
		"{'primitives':[{'attributes':{'POSITION':0}}]}]");
	assert_int_equal(m.part_count, 3);
	assert_string_equal(m.parts[m.part[0]].name, "Tree/Leaves");
	assert_string_equal(m.parts[m.part[1]].name, "Leaves");
	assert_string_equal(m.parts[m.part[2]].name, "Leaves");
	assert_string_equal(m.parts[m.part[3]].name, "Pot");
	assert_int_equal(m.part[3], m.part[4]);
}

UNIT_TEST(instances_of_a_model_are_expanded)
{
	static const float places[3][3] = { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 0, 10 } },
		sizes[3][3] = { { 1, 1, 1 }, { 2, 2, 2 }, { 1, 1, 1 } };
	static const int16_t turns[3][4] = { { 0, 0, 0, 32767 }, { 0, 0, 0, 32767 }, { 0, 23170, 0, 23170 } };
	static const char rest[] = ",'extensionsRequired':['EXT_mesh_gpu_instancing'],"
		"'nodes':[{'mesh':0,'translation':[0,1,0],"
		"'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':1,'SCALE':2,"
		"'ROTATION':3}}}}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]";

	gw_square(3);
	gw_floats(places[0], 3, "VEC3", 3);
	gw_floats(sizes[0], 3, "VEC3", 3);
	gw_accessor(gw_view(turns, sizeof turns, ""), GLTF_SHORT, 3, "VEC4", ",'normalized':true");
	read_good(rest);
	assert_int_equal(m.triangle_count, 3);
	expect_corner(0, 1, 1, 1, 0);
	expect_corner(1, 1, 12, 1, 0);
	expect_corner(2, 1, 0, 1, 9);
	assert_non_null(strstr(notes.text, "3 instances"));
	assert_code(read_model(rest, 2, &cause), ECO_TOO_LARGE, "");
}

UNIT_TEST(instances_without_end_are_refused_at_once)
{
	gw_square(3);
	gw_accessor(-1, GLTF_FLOAT, 80000000, "VEC3", "");           /* zeros, which cost nothing */
	assert_code(read_model(",'nodes':[{'mesh':0,"
		"'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':1}}}}],"
		"'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]", 100, &cause), ECO_TOO_LARGE, "");
}

/* A joint a hundred times as large, whose inverse bind matrix takes that back, 5 to the right; the node's own
 * place does not count. */
UNIT_TEST(skins_stand_where_their_joints_hold_them)
{
	static const float inverse[2][16] = { { 0.01f, 0, 0, 0, 0, 0.01f, 0, 0, 0, 0, 0.01f, 0, 0, 0, 0, 1 },
		{ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
	static const uint8_t joints[3][4] = { { 0, 1 }, { 0, 1 }, { 1, 0 } };
	static const float weights[3][4] = { { 1, 0 }, { 0.5f, 0.5f }, { 1, 0 } };
	gw_square(3);
	gw_accessor(gw_view(joints, sizeof joints, ""), GLTF_UBYTE, 3, "VEC4", "");
	gw_floats(weights[0], 3, "VEC4", 4);
	gw_floats(inverse[0], 2, "MAT4", 16);
	read_good(",'nodes':[{'mesh':0,'skin':0,'translation':[1000,0,0]},{'translation':[5,0,0],"
		"'scale':[100,100,100]},{'translation':[7,0,0]}],'skins':[{'joints':[1,2],"
		"'inverseBindMatrices':3}],'meshes':[{'primitives':[{'attributes':{'POSITION':0,"
		"'JOINTS_0':1,'WEIGHTS_0':2}}]}]");
	expect_corner(0, 0, 5, 0, 0);
	expect_corner(0, 1, 7, 0, 0);            /* between 6 and 8 */
	expect_corner(0, 2, 7, 1, 0);
}

UNIT_TEST(vertex_colours_count_in_linear_light)
{
	static const uint8_t colors[3][4] = { { 255, 0, 0, 255 }, { 255, 0, 0, 255 }, { 255, 0, 0, 0 } };
	gw_square(3);
	gw_accessor(gw_view(colors, sizeof colors, ""), GLTF_UBYTE, 3, "VEC4", ",'normalized':true");
	read_good(ONE_MESH("'POSITION':0,'COLOR_0':1", ",'material':0") ","
		"'materials':[{'pbrMetallicRoughness':{'baseColorFactor':[0.5,1,1,1]}}]");
	assert_int_equal(m.materials[m.material[0]].rgb[0], 188);
	assert_int_equal(m.materials[m.material[0]].rgb[1], 0);
	assert_non_null(strstr(notes.text, "1 vertices have colours with alpha below 0.5"));
}

UNIT_TEST(the_older_materials_and_those_without_any_have_colours)
{
	gw_square(3);
	read_good(",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0},"
		"'material':0},{'attributes':{'POSITION':0}},{'attributes':{'POSITION':0},"
		"'material':1}]}],'materials':[{'name':'old',"
		"'pbrMetallicRoughness':{'baseColorFactor':[1,0,0,1]},"
		"'extensions':{'KHR_materials_pbrSpecularGlossiness':{'diffuseFactor':[0,1,0,1]}}},"
		"{'name':'thin','alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[1,"
		"0,0,0.2]}}]");
	assert_int_equal(m.triangle_count, 2);
	assert_int_equal(m.dropped[ECO_DROP_TRANSPARENT], 1);
	assert_string_equal(m.materials[m.material[0]].name, "old");
	assert_true(m.materials[m.material[0]].rgb[0] == 0 && m.materials[m.material[0]].rgb[1] == 255);
	assert_true(m.materials[m.material[1]].rgb[0] == 255 && m.materials[m.material[1]].rgb[1] == 255);
}

/* One texel, in a view, a data URI, a file, and nowhere. */
UNIT_TEST(pictures_come_from_anywhere_or_are_missed_aloud)
{
	static const uint8_t rgba[] = { 10, 20, 30, 255 };
	static const float uv[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } },
		second[3][2] = { { 5, 5 }, { 6, 5 }, { 5, 6 } };
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	char rest[3000], text[1000] = "";
	uint8_t *png;
	size_t size;
	assert_good(eco_png_encode(&(struct eco_pixels){ 1, 1, 4, rgba }, &png, &size, &cause));
	input_bytes("gltf_model", "bark one.png", png, size);
	for (size_t i = 0; i < size; i += 3) {
		unsigned bits = (unsigned)png[i] << 16 | (i + 1 < size ? png[i + 1] : 0u) << 8 | (i + 2 < size ? png[i + 2] : 0u);
		for (size_t k = 0; k < 4; k++)
			text[i / 3 * 4 + k] = k > size - i ? '=' : digits[bits >> (18 - 6 * k) & 63];
	}
	gw_square(3);
	gw_floats(uv[0], 3, "VEC2", 2);
	gw_floats(second[0], 3, "VEC2", 2);
	gw_view(png, size, "");
	snprintf(rest, sizeof rest, ",'nodes':[{'mesh':0}],'meshes':[{'primitives':[");
	for (int i = 0; i < 5; i++)
		snprintf(rest + strlen(rest), sizeof rest - strlen(rest),
			"%s{'attributes':{'POSITION':0,'TEXCOORD_0':1,'TEXCOORD_1':2},"
			"'material':%d}", i > 0 ? "," : "", i);
	snprintf(rest + strlen(rest), sizeof rest - strlen(rest), "]}],'materials':[");
	for (int i = 0; i < 5; i++)
		snprintf(rest + strlen(rest), sizeof rest - strlen(rest),
			"%s{'pbrMetallicRoughness':{'baseColorTexture':{'index':%d,'texCoord':%d%s}}}",
			i > 0 ? "," : "", i, i == 0, i == 1 ? ","
			"'extensions':{'KHR_texture_transform':{'texCoord':1,'scale':[2,2]}}" : "");
	snprintf(rest + strlen(rest), sizeof rest - strlen(rest),
		"],'textures':[{'source':0},{'source':1},{'extensions':{'EXT_texture_webp':{'source':2}}},"
		"{'source':3},{}],'images':[{'bufferView':3,'mimeType':'image/png'},{'uri':'data:image/png;base64,"
		"%s'},{'uri':'bark%%20one.png'},{'uri':'none.png'}]", text);
	free(png);
	read_good(rest);
	assert_int_equal(m.image_count, 3);
	for (uint32_t i = 0; i < 3; i++) {
		assert_int_equal(m.materials[i].image, i);
		assert_memory_equal(m.images[i].rgba, rgba, 4);
	}
	assert_true(m.uv[m.index[0] * 2] == 5 && m.uv[m.index[3] * 2] == 10 && m.uv[m.index[6] * 2] == 0);
	assert_true(m.materials[3].image == ECO_NONE && m.materials[4].image == ECO_NONE);
	assert_non_null(strstr(notes.text, "none.png"));
	assert_non_null(strstr(notes.text, "no picture in a known format"));
}

/* ---- Draco ---- */

#define DRACO_SIDE 300u              /* vertices: more than 16-bit indices reach */

UNIT_TEST(draco_meshes_of_any_size_are_read)
{
	uint32_t vertices = DRACO_SIDE * DRACO_SIDE, faces = 0, *index = malloc(6 * vertices * sizeof *index);
	int32_t *position = malloc(3 * vertices * sizeof *position), view;
	double sum = 0;
	uint8_t *bytes;
	size_t size;
	char rest[600];
	for (uint32_t v = 0; v < vertices; v++) {
		position[v * 3] = (int32_t)(v % DRACO_SIDE);
		position[v * 3 + 1] = (int32_t)(v / DRACO_SIDE);
		position[v * 3 + 2] = (int32_t)(v % 5);
		if (v % DRACO_SIDE == DRACO_SIDE - 1 || v / DRACO_SIDE == DRACO_SIDE - 1)
			continue;
		memcpy(&index[faces * 3], (const uint32_t[]){ v, v + 1, v + DRACO_SIDE, v + DRACO_SIDE, v + 1,
			v + DRACO_SIDE + 1 }, 24);
		faces += 2;
	}
	assert_good(eco_draco_encode_mesh(position, vertices, index, faces, &bytes, &size, &cause));
	gw_begin();
	view = gw_view(bytes, size, "");
	gw_accessor(-1, GLTF_FLOAT, vertices, "VEC3", "");
	gw_accessor(-1, GLTF_UINT, faces * 3, "SCALAR", "");
	gw_accessor(-1, GLTF_UINT, faces * 3 - 3, "SCALAR", "");
	for (int i = 1; i <= 2; i++) {
		snprintf(rest, sizeof rest, ",'extensionsRequired':['KHR_draco_mesh_compression'],"
			"'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0},"
			"'indices':%d,'extensions':{'KHR_draco_mesh_compression':{'bufferView':%d,"
			"'attributes':{'POSITION':0}}}}]}]",
				i, view);
		if (i == 2) {
			/* fewer faces declared than there are */
			assert_code(read_model(rest, 1000000, &cause), ECO_DAMAGED, "more faces");
			break;
		}
		read_good(rest);
		assert_int_equal(m.triangle_count, faces);
		assert_int_equal(m.vertex_count, vertices);
		for (uint32_t k = 0; k < vertices * 3; k++)
			sum += (double)m.position[k];
		/* x and y from 0 to the side, less z from 0 to 4 */
		assert_true(sum == vertices * (DRACO_SIDE - 1.0 - 2));
	}
	for (size_t cut = 0; cut < size; cut += size / 50 + 1) {
		struct eco_draco_attribute a = { .id = 0, .components = 3 };
		struct eco_draco_mesh mesh;
		uint8_t *part = malloc(cut + 1);
		memcpy(part, bytes, cut);
		assert_int_not_equal(eco_draco_decode_gltf(part, cut, faces, vertices * 3, &a, 1, &mesh,
			NULL), ECO_OK);
		assert_null(mesh.index);
		assert_null(a.values);
		free(part);
	}
	free(bytes);
	free(position);
	free(index);
}

UNIT_TEST(draco_attributes_are_found_by_their_ids)
{
	static const int32_t position[9] = { 0, 0, 0, 10, 0, 0, 0, 10, 0 };
	static const uint32_t index[3] = { 0, 1, 2 };
	struct eco_draco_attribute a[2] = { { .id = 0, .components = 4 }, { .id = 7, .components = 3 } };
	struct eco_draco_mesh mesh;
	uint8_t *bytes;
	size_t size;
	assert_int_equal(eco_draco_encode_mesh(position, 3, index, 1, &bytes, &size, NULL), ECO_OK);
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 3, a, 1, &mesh, NULL), ECO_OK);
	assert_true(mesh.faces == 1 && mesh.points == 3);
	for (int k = 0; k < 3; k++)
		assert_true(a[0].values[k * 4] + a[0].values[k * 4 + 1] <= 10 && a[0].values[k * 4 + 3] == 0);
	free(a[0].values);
	free(mesh.index);
	assert_code(eco_draco_decode_gltf(bytes, size, 1, 3, a, 2, &mesh, &cause), ECO_DAMAGED,
		"an attribute is missing");
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 0, 3, a, 1, &mesh, NULL), ECO_DAMAGED);
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 2, a, 1, &mesh, NULL), ECO_DAMAGED);
	bytes[6] = 1;
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 3, a, 1, &mesh, NULL), ECO_UNSUPPORTED);
	free(bytes);
}

/* ---- Refusals ---- */

UNIT_TEST(what_a_file_requires_and_is_not_read_is_named)
{
	static const struct { const char *list, *says; enum eco_code code; } cases[] = {
		{ "'extensionsRequired':['KHR_texture_basisu']", "KHR_texture_basisu", ECO_UNSUPPORTED },
		{ "'extensionsRequired':['KHR_mesh_quantization','VENDOR_secret']", "VENDOR_secret",
			ECO_UNSUPPORTED },
		{ "'extensionsRequired':[3]", "not a name", ECO_UNSUPPORTED },
		{ "'extensionsUsed':['VENDOR_secret']", "", ECO_OK },
		{ "'extensionsRequired':['KHR_materials_anything']", "", ECO_OK },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char rest[500];
		gw_square(3);
		snprintf(rest, sizeof rest, ONE_MESH("'POSITION':0", "") ",%s", cases[i].list);
		read_fails(rest, cases[i].code, cases[i].says);
	}
}

static const struct { const char *rest, *says; } references_to_cases[] = {
	{ ",'nodes':[{'mesh':4}]", "mesh 4" }, { ONE_MESH("'POSITION':9", ""), "accessor 9" },
	{ ONE_MESH("'POSITION':0", ",'indices':8"), "accessor 8" },
	{ ONE_MESH("'POSITION':1", ""), "components" },
	{ ",'nodes':[{'mesh':0,'skin':2}],"
		"'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]", "skin" },
	{ ",'nodes':[{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':{}}}],"
		"'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]",
		"instances without" },
	{ ",'nodes':[{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':0,"
		"'SCALE':2}}}}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]",
		"3 and 2 places" },
	{ ONE_MESH("'POSITION':0", ",'extensions':{'KHR_draco_mesh_compression':{'bufferView':0,"
		"'attributes':{'POSITION':0}}}"),
		"Draco" },
};

UNIT_TEST(references_to_nothing_are_refused)
{
	for (size_t i = 0; i < sizeof references_to_cases / sizeof *references_to_cases; i++) {
		gw_square(3);
		gw_floats(square[0], 3, "VEC2", 2);
		gw_floats(square[0], 2, "VEC3", 3);
		read_fails(references_to_cases[i].rest, ECO_DAMAGED, references_to_cases[i].says);
	}
}
