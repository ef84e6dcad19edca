/* glTF models: what a viewer would show at rest is what arrives; the rest is counted, said, or refused by
 * name. */
#include <math.h>

#include "ecofiles/format/chunk/draco_shim.h"
#include "ecofiles/format/image.h"
#include "ecofiles/import/model/import_model.h"
#include "ecofiles/import/model/model_import.h"
#include "tests/support/cases.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/model_try.h"

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
	snprintf(import_said, sizeof import_said, "%s", notes.text);
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

/* ---- One document for all rows below: its accessors by number ---- */

static const float square[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } };

/* A file whose accessor 0 is the first `count` corners. */
static void gw_square(size_t count)
{
	gw_begin();
	gw_floats(square[0], count, "VEC3", 3);
}

static void gw_document(void)
{
	static const uint8_t bytes[6] = { 0, 1, 2, 2, 1, 3 }, joints[3][4] = { { 0, 1 }, { 0, 1 }, { 1, 0 } },
		colors[3][4] = { { 255, 0, 0, 255 }, { 255, 0, 0, 255 }, { 255, 0, 0, 0 } };
	static const uint16_t shorts[6] = { 0, 1, 2, 2, 1, 3 }, strip[] = { 0, 1, 2, 3, 0xffff, 3, 2, 1 },
		fan[] = { 0, 1, 3, 2 }, broken[6] = { 0, 1, 2, 2, 1, 4 };
	static const uint32_t words[6] = { 0, 1, 2, 2, 1, 3 };
	static const float far[3][3] = { { 1e7f, 0, 0 }, { 1e7f + 1, 0, 0 }, { 1e7f, 1, 0 } },
		places[3][3] = { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 0, 10 } },
		sizes[3][3] = { { 1, 1, 1 }, { 2, 2, 2 }, { 1, 1, 1 } },
		weights[3][4] = { { 1, 0 }, { 0.5f, 0.5f }, { 1, 0 } },
		inverse[2][16] = { { 0.01f, 0, 0, 0, 0, 0.01f, 0, 0, 0, 0, 0.01f, 0, 0, 0, 0, 1 },
			{ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
	static const int16_t turns[3][4] = { { 0, 0, 0, 32767 }, { 0, 0, 0, 32767 }, { 0, 23170, 0, 23170 } };
	gw_square(4);
	gw_floats(square[0], 3, "VEC3", 3);                                                     /* 1 */
	gw_accessor(gw_view(bytes, sizeof bytes, ""), GLTF_UBYTE, 6, "SCALAR", "");
	gw_accessor(gw_view(shorts, sizeof shorts, ""), GLTF_USHORT, 6, "SCALAR", "");
	gw_accessor(gw_view(words, sizeof words, ""), GLTF_UINT, 6, "SCALAR", "");
	gw_accessor(gw_view(strip, sizeof strip, ""), GLTF_USHORT, 8, "SCALAR", "");            /* 5 */
	gw_accessor(gw_view(fan, sizeof fan, ""), GLTF_USHORT, 4, "SCALAR", "");
	gw_accessor(gw_view(broken, sizeof broken, ""), GLTF_USHORT, 6, "SCALAR", "");
	gw_floats(far[0], 3, "VEC3", 3);
	gw_floats(places[0], 3, "VEC3", 3);
	gw_floats(sizes[0], 3, "VEC3", 3);                                                      /* 10 */
	gw_accessor(gw_view(turns, sizeof turns, ""), GLTF_SHORT, 3, "VEC4", ",'normalized':true");
	gw_accessor(-1, GLTF_FLOAT, 80000000, "VEC3", "");           /* zeros, which cost nothing */
	gw_accessor(gw_view(joints, sizeof joints, ""), GLTF_UBYTE, 3, "VEC4", "");
	gw_floats(weights[0], 3, "VEC4", 4);
	gw_floats(inverse[0], 2, "MAT4", 16);                                                   /* 15 */
	gw_accessor(gw_view(colors, sizeof colors, ""), GLTF_UBYTE, 3, "VEC4", ",'normalized':true");
	gw_floats(square[0], 3, "VEC2", 2);
	gw_floats(square[0], 2, "VEC3", 3);
}

/* Beside the keys of a model: "c": a corner in the file's own axes, by 3 * triangle + corner; "index": its
 * vertex;
 * "x": the first coordinate of a vertex. */
static void tell(const char *key, uint32_t number, const char *wanted, char *to, size_t size)
{
	const float *p = m.position;
	if (strcmp(key, "base") == 0)
		snprintf(to, size, "%.10g", frame.base[0]);
	else if (strcmp(key, "x") == 0 && number < m.vertex_count)
		snprintf(to, size, "%.10g", (double)p[number * 3]);
	else if (strcmp(key, "index") == 0 && number < m.triangle_count * 3)
		snprintf(to, size, m.index[number] == ECO_NONE ? "none" : "%u", m.index[number]);
	else if (strcmp(key, "c") == 0 && number < m.triangle_count * 3) {
		p += m.index[number] * 3;
		snprintf(to, size, "%.4f,%.4f,%.4f", (double)p[0], (double)p[2], 0.0 - (double)p[1]);
	} else
		model_told(key, number, wanted, to, size);
}

struct gltf_case { const char *name, *rest, *wanted, *code, *most; };

UNIT_TEST(what_a_viewer_shows_at_rest_arrives_or_is_refused)
{
	static const char *const codes[] = { "bad input", "damaged", "too large", "unsupported", NULL };
	static const enum eco_code code_of[] = { ECO_BAD_INPUT, ECO_DAMAGED, ECO_TOO_LARGE, ECO_UNSUPPORTED };
	const char *name = "";
	uint32_t count;
	const struct gltf_case *models = cases_read("tests/import/cases/gltf_model.tsv", sizeof *models, &count);
	gw_document();
	for (uint32_t i = 0; i < count; i++) {
		name = models[i].name ? models[i].name : name;
		print_message("# %s, %s\n", name, models[i].wanted);
		if (models[i].code) {
			assert_code(read_model(models[i].rest, models[i].most ? (uint32_t)cases_number(models[i].most) : 1000,
				&cause), code_of[cases_choice(models[i].code, codes)], models[i].wanted);
			continue;
		}
		read_good(models[i].rest);
		expect_told(models[i].wanted, tell);
	}
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
		unsigned bits = (unsigned)png[i] << 16 | (i + 1 < size ? png[i + 1] : 0u) << 8 | (i + 2 < size
			? png[i + 2] : 0u);
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
