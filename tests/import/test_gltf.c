/* glTF documents: containers, numbers, compression, nodes: what the specification and its extensions say is
 * what arrives, and what does not fit is refused by name. Each oddity is the small file that shows it. */
#include <math.h>
#include <meshoptimizer.h>

#include "ecofiles/import/model/gltf.h"
#include "tests/support/cases.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

#define CHUNK_JSON ",'meshes':[]"

static struct eco_gltf *doc;

static enum eco_code open_bytes(const void *bytes, size_t size, struct eco_error *error)
{
	return eco_gltf_open(&doc, input_bytes("gltf", "x.glb", bytes, size), error);
}

static enum eco_code open_glb(const char *rest, char pad, struct eco_error *error)
{
	uint8_t *bytes;
	size_t size = gw_glb_bytes(rest, pad, &bytes);
	enum eco_code code = open_bytes(bytes, size, error);
	free(bytes);
	return code;
}

static void open_good(const char *rest)
{
	assert_good(open_glb(rest, ' ', &cause));
}

/* The whole accessor; *values is malloc'ed: count * components. */
static enum eco_code read_floats(uint32_t accessor, uint32_t components, double **values, uint64_t *count,
	struct eco_error *error)
{
	struct eco_gltf_accessor a;
	enum eco_code code = eco_gltf_accessor_open(doc, accessor, components, &a, error);
	*values = NULL;
	*count = 0;
	if (code)
		return code;
	*values = malloc(((size_t)a.count * a.components + 1) * sizeof **values);
	*count = a.count;
	for (uint64_t i = 0; i < *count; i++)
		eco_gltf_element(&a, i, *values + i * a.components);
	eco_gltf_accessor_close(&a);
	return code;
}

static void expect_floats(int accessor, uint32_t components, const double *wanted,
	uint64_t wanted_count)
{
	double *values;
	uint64_t count;
	assert_good(read_floats((uint32_t)accessor, components, &values, &count, &cause));
	assert_int_equal(count, wanted_count);
	for (uint64_t i = 0; i < count * components; i++)
		if (fabs(values[i] - wanted[i]) > 1e-6)
			fail_msg("value %llu is %g, not %g", (unsigned long long)i, values[i], wanted[i]);
	free(values);
}

static void expect_refused(int accessor, enum eco_code wanted, const char *says)
{
	double *values;
	uint64_t count;
	assert_code(read_floats((uint32_t)accessor, 0, &values, &count, &cause), wanted, "");
	assert_null(values);
	if (!strstr(cause.text, says))
		fail_msg("%s\n  wanted ... %s", cause.text, says);
}

/* ---- Containers ---- */

UNIT_TEST(json_may_be_padded_with_zeros_or_begin_with_a_mark)
{
	char text[130000];
	gw_begin();
	assert_good(open_glb(CHUNK_JSON, 0, &cause));
	eco_gltf_close(doc);
	snprintf(text, sizeof text, "\xef\xbb\xbf%s", gw_json("", CHUNK_JSON));
	assert_good(open_bytes(text, strlen(text), &cause));
	eco_gltf_close(doc);
}

UNIT_TEST(a_document_that_is_cut_off_is_refused)
{
	const float p[3] = { 1, 2, 3 };
	uint8_t *bytes;
	size_t size;
	gw_begin();
	gw_floats(p, 1, "VEC3", 3);
	size = gw_glb_bytes(CHUNK_JSON, ' ', &bytes);
	for (size_t at = 0; at < size; at++) {
		struct eco_error error = { .code = ECO_OK };
		assert_int_not_equal(open_bytes(bytes, at, &error), ECO_OK);
		assert_null(doc);
		assert_non_null(strstr(error.text, "x.glb"));
	}
	free(bytes);
}

UNIT_TEST(what_is_no_gltf_2_is_named)
{
	struct row { const char *text; enum eco_code code; const char *says; };
	uint32_t count;
	const struct row *cases = cases_rows("tests/import/cases/gltf_versions.tsv", "scs", sizeof *cases,
		&count);

	for (size_t i = 0; i < count; i++)
		assert_code(open_bytes(cases[i].text, strlen(cases[i].text), &cause), cases[i].code, cases[i].says);
}

UNIT_TEST(buffers_are_found_beside_or_within)
{
	static const float p[3] = { 1, 2, 3 };
	static const char *const uris[] = { "two words.bin", "two%20words.bin", ".\\\\two words.bin",
		"C:\\\\plants\\\\Two Words.BIN",
		"data:application/octet-stream;base64,AACAPwAAAEAAAEBA", "data:;base64,AACA\\nPwAAAEAAAEBA" };

	input_bytes("gltf", "two words.bin", p, sizeof p);
	for (size_t i = 0; i < sizeof uris / sizeof *uris; i++) {
		char buffer[200];
		gw_begin();
		gw_floats(p, 1, "VEC3", 3);
		snprintf(buffer, sizeof buffer, ",'uri':'%s'", uris[i]);
		assert_good(eco_gltf_open(&doc, input_text("gltf", "b.gltf", gw_json(buffer, CHUNK_JSON)),
			&cause));
		expect_floats(0, 3, (const double[]){ 1, 2, 3 }, 1);
		eco_gltf_close(doc);
	}
}

UNIT_TEST(a_buffer_that_is_missing_is_told_when_it_is_needed)
{
	struct row { const char *buffer; enum eco_code code; const char *says; };
	uint32_t count;
	const struct row *cases = cases_rows("tests/import/cases/gltf_buffers.tsv", "scs", sizeof *cases,
		&count);
	static const float p[3] = { 1, 2, 3 };
	for (size_t i = 0; i < count; i++) {
		gw_begin();
		gw_floats(p, 1, "VEC3", 3);
		assert_int_equal(eco_gltf_open(&doc,
			input_text("gltf", "b.gltf", gw_json(cases[i].buffer, CHUNK_JSON)), NULL), ECO_OK);
		expect_refused(0, cases[i].code, cases[i].says);
		eco_gltf_close(doc);
	}
}

/* ---- Accessors ---- */

UNIT_TEST(numbers_of_every_type_are_read)
{
	static const int8_t bytes[4] = { -128, -127, 0, 127 };
	static const int16_t shorts[4] = { -32768, -1, 0, 32767 };
	static const uint32_t words[4] = { 0, 1, 65536, 4000000000u };
	static const struct { int type; const void *from; size_t size; bool normalized; double wanted[4];
		} cases[] = {
		{ GLTF_BYTE, bytes, 4, false, { -128, -127, 0, 127 } },
			{ GLTF_BYTE, bytes, 4, true, { -1, -1, 0, 1 } },
		{ GLTF_UBYTE, bytes, 4, false, { 128, 129, 0, 127 } },
		{ GLTF_UBYTE, bytes, 4, true, { 128 / 255.0, 129 / 255.0, 0, 127 / 255.0 } },
		{ GLTF_SHORT, shorts, 8, false, { -32768, -1, 0, 32767 } },
		{ GLTF_SHORT, shorts, 8, true, { -1, -1 / 32767.0, 0, 1 } },
		{ GLTF_USHORT, shorts, 8, false, { 32768, 65535, 0, 32767 } },
		{ GLTF_USHORT, shorts, 8, true, { 32768 / 65535.0, 1, 0, 32767 / 65535.0 } },
		{ GLTF_UINT, words, 16, false, { 0, 1, 65536, 4e9 } },
		{ GLTF_UINT, words, 16, true, { 0, 1, 65536, 4e9 } },
		{ 5124, words, 16, false, { 0, 1, 65536, 4000000000.0 - 4294967296.0 } },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		gw_begin();
		gw_accessor(gw_view(cases[i].from, cases[i].size, ""), cases[i].type, 4, "SCALAR",
			cases[i].normalized ? ",'normalized':true" : "");
		open_good("");
		expect_floats(0, 1, cases[i].wanted, 4);
		eco_gltf_close(doc);
	}
}

UNIT_TEST(strides_and_offsets_are_kept)
{
	static const float interleaved[10] = { 9, 1, 2, 9, 9, 3, 4, 9, 5, 6 };
	gw_begin();
	gw_accessor(gw_view(interleaved, sizeof interleaved, ",'byteStride':16.0"), GLTF_FLOAT, 2, "VEC2",
		",'byteOffset':4");
	open_good("");
	expect_floats(0, 2, (const double[]){ 1, 2, 3, 4 }, 2);
	eco_gltf_close(doc);
}

UNIT_TEST(sparse_accessors_are_filled_in)
{
	static const float base[4] = { 1, 2, 3, 4 }, values[2] = { 20, 40 };
	static const uint8_t bytes[2] = { 1, 3 };
	static const uint32_t words[2] = { 1, 9 };
	char sparse[3][300];
	int v, i8, i32;
	gw_begin();
	v = gw_view(values, sizeof values, "");
	i8 = gw_view(bytes, sizeof bytes, "");
	i32 = gw_view(words, sizeof words, "");
	for (int i = 0; i < 3; i++)
		snprintf(sparse[i], sizeof sparse[i], ",'sparse':{'count':%d,'indices':{'bufferView':%d,"
			"'componentType':%d},'values':{'bufferView':%d}}", i == 2 ? 1 : 2, i == 0 ? i8 : i32,
			i == 0 ? GLTF_UBYTE : GLTF_UINT, v);
	gw_accessor(gw_view(base, sizeof base, ""), GLTF_FLOAT, 4, "SCALAR", sparse[0]);
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", sparse[0]);         /* of zeros */
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", "");
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", sparse[1]);
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", sparse[2]);
	open_good("");
	expect_floats(0, 1, (const double[]){ 1, 20, 3, 40 }, 4);
	expect_floats(1, 1, (const double[]){ 0, 20, 0, 40 }, 4);
	expect_floats(2, 1, (const double[]){ 0, 0, 0, 0 }, 4);
	expect_refused(3, ECO_DAMAGED, "names element 9 of 4");
	expect_floats(4, 1, (const double[]){ 0, 20, 0, 0 }, 4);
	eco_gltf_close(doc);
}

UNIT_TEST(accessors_beyond_their_bytes_are_refused)
{
	static const float four[4];
	struct row { const char *more; size_t count; const char *kind; enum eco_code code; const char *says; };
	uint32_t count;
	const struct row *cases = cases_rows("tests/import/cases/gltf_accessors.tsv", "szscs", sizeof *cases,
		&count);

	for (size_t i = 0; i < count; i++) {
		struct eco_error error = { .code = ECO_OK };
		gw_begin();
		gw_accessor(gw_view(four, sizeof four, ""), GLTF_FLOAT, cases[i].count, cases[i].kind,
			cases[i].more);
		if (open_glb("", ' ', &error) == ECO_OK)
			expect_refused(0, cases[i].code, cases[i].says);
		eco_gltf_close(doc);
	}
}

/* ---- meshopt ---- */

UNIT_TEST(views_compressed_with_meshopt_are_unpacked)
{
	float places[100][4];
	unsigned triangles[300], list[100];
	unsigned char packed[8192];
	double wanted[400], corners[300];
	for (unsigned i = 0; i < 100; i++)
		for (unsigned k = 0; k < 4; k++)
			wanted[i * 4 + k] = (double)(places[i][k] = (float)(i * k) * 0.25f - 3);
	for (unsigned i = 0; i < 300; i++)
		corners[i] = triangles[i] = i / 3 + i % 3;
	for (unsigned i = 0; i < 100; i++)
		list[i] = i * 37 % 100;
	gw_begin();
	for (int e = 0; e < 2; e++) {
		const char *extension = e == 0 ? "EXT_meshopt_compression" : "KHR_meshopt_compression";
		gw_accessor(gw_packed(packed,
			meshopt_encodeVertexBuffer(packed, sizeof packed, places, 100, 16), 100, 16,
			"ATTRIBUTES", "NONE", extension), GLTF_FLOAT, 100, "VEC4", "");
		gw_accessor(gw_packed(packed,
			meshopt_encodeIndexBuffer(packed, sizeof packed, triangles, 300), 300, 2, "TRIANGLES",
			"NONE", extension), GLTF_USHORT, 300, "SCALAR", "");
		gw_accessor(gw_packed(packed, meshopt_encodeIndexSequence(packed, sizeof packed, list, 100),
			100, 4, "INDICES", "NONE", extension), GLTF_UINT, 100, "SCALAR", "");
	}
	open_good("");
	for (int e = 0; e < 2; e++) {
		double *values;
		uint64_t count;
		expect_floats(e * 3, 4, wanted, 100);
		assert_int_equal(read_floats((uint32_t)e * 3 + 1, 1, &values, &count, NULL),
			ECO_OK);
		/* triangles keep their order, and may begin at another corner */
		for (unsigned i = 0; i < 300; i += 3)
			assert_true(values[i] + values[i + 1] + values[i + 2] == corners[i] + corners[i + 1]
				+ corners[i + 2]);
		free(values);
		assert_int_equal(read_floats((uint32_t)e * 3 + 2, 1, &values, &count, NULL),
			ECO_OK);
		for (unsigned i = 0; i < 100; i++)
			assert_true(values[i] == list[i]);
		free(values);
	}
	eco_gltf_close(doc);
}

UNIT_TEST(filters_of_meshopt_are_undone)
{
	static const float normals[4][4] = { { 0, 0, 1, 0 }, { 0.6f, 0.8f, 0, 0 }, { 0, -1, 0, 0 },
		{ -0.6f, 0, -0.8f, 0 } };
	static const float turns[2][4] = { { 0, 0.70710678f, 0, 0.70710678f }, { 0.5f, 0.5f, 0.5f, 0.5f } };
	static const float places[2][3] = { { 1, 2, 3 }, { -400, 0.25f, 0 } };
	unsigned char filtered[64], packed[512];
	double *values;
	uint64_t count;
	gw_begin();
	meshopt_encodeFilterOct(filtered, 4, 8, 16, normals[0]);
	gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, filtered, 4, 8), 4, 8,
		"ATTRIBUTES", "OCTAHEDRAL",
		"EXT_meshopt_compression"), GLTF_SHORT, 4, "VEC4", ",'normalized':true");
	meshopt_encodeFilterQuat(filtered, 2, 8, 16, turns[0]);
	gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, filtered, 2, 8), 2, 8,
		"ATTRIBUTES", "QUATERNION",
		"EXT_meshopt_compression"), GLTF_SHORT, 2, "VEC4", ",'normalized':true");
	meshopt_encodeFilterExp(filtered, 2, 12, 24, places[0]);
	gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, filtered, 2, 12), 2,
		12, "ATTRIBUTES", "EXPONENTIAL",
		"EXT_meshopt_compression"), GLTF_FLOAT, 2, "VEC3", "");
	open_good("");
	assert_int_equal(read_floats(0, 4, &values, &count, NULL), ECO_OK);
	for (int i = 0; i < 16; i++)
		assert_true(i % 4 == 3 || fabs(values[i] - (double)normals[i / 4][i % 4]) < 1e-3);
	free(values);
	assert_int_equal(read_floats(1, 4, &values, &count, NULL), ECO_OK);
	for (int i = 0; i < 8; i++)
		assert_true(fabs(values[i] - (double)turns[i / 4][i % 4]) < 1e-3);
	free(values);
	expect_floats(2, 3, (const double[]){ 1, 2, 3, -400, 0.25, 0 }, 2);
	eco_gltf_close(doc);
}

UNIT_TEST(meshopt_that_makes_no_sense_is_refused)
{
	uint8_t bytes[64] = { 0 };
	struct row { size_t count, stride; const char *mode, *filter; enum eco_code code; uint8_t first; };
	uint32_t count;
	const struct row *cases = cases_rows("tests/import/cases/gltf_meshopt.tsv", "zzsscy", sizeof *cases,
		&count);

	for (size_t i = 0; i < count; i++) {
		const uint8_t *view;
		size_t size;
		bytes[0] = cases[i].first;
		gw_begin();
		gw_packed(bytes, sizeof bytes, cases[i].count, cases[i].stride, cases[i].mode, cases[i].filter,
			bytes[0] == 0xa1 ? "KHR_meshopt_compression" : "EXT_meshopt_compression");
		open_good("");
		assert_code(eco_gltf_view(doc, 0, &view, &size, &cause), cases[i].code,
			bytes[0] == 0xa1 ? "gltfpack -ce ext" : "");
		eco_gltf_close(doc);
	}
}

/* ---- Nodes ---- */

UNIT_TEST(nodes_stand_where_their_ancestors_put_them)
{
	double m[16], p[3];
	gw_begin();
	open_good(",'nodes':[{'children':[1],'translation':[0,2,0],'scale':[2,2,2]},"
		"{'children':[2],'rotation':[0,0.6,0,0.6]},{'matrix':[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,"
		"1]},{'children':[4]},{'children':[3]},{'rotation':[0,0,0,0]},{'scale':[1,'x']}]");
	assert_int_equal(eco_gltf_node_matrix(doc, 2, m, NULL), ECO_OK);
	/* (6, 6, 7), a quarter turn about Y: (7, 6, -6), twice, 2 up */
	eco_gltf_apply(m, (const double[]){ 1, 0, 0 }, p);
	assert_true(fabs(p[0] - 14) < 1e-9 && fabs(p[1] - 14) < 1e-9 && fabs(p[2] + 12) < 1e-9);
	assert_code(eco_gltf_node_matrix(doc, 3, m, &cause), ECO_DAMAGED, "below itself");
	assert_int_equal(eco_gltf_node_matrix(doc, 5, m, NULL), ECO_OK);
	assert_true(m[0] == 1 && m[5] == 1);
	assert_int_equal(eco_gltf_node_matrix(doc, 6, m, NULL), ECO_DAMAGED);
	assert_int_equal(eco_gltf_node_matrix(doc, 7, m, NULL), ECO_DAMAGED);
	eco_gltf_close(doc);
}

static enum eco_code note_node(void *ctx, uint32_t node, const double world[16])
{
	char *order = ctx;
	size_t used = strlen(order);
	snprintf(order + used, 200 - used, "%u ", node);
	return ECO_OK;
}

/* 32 nodes, each twice below the one before, are 2^32 to visit. */
UNIT_TEST(nodes_are_walked_as_a_viewer_shows_them)
{
	char twice[1024] = ",'scenes':[{'nodes':[0]}],'nodes':[";
	for (int i = 1; i < 32; i++)
		sprintf(twice + strlen(twice), "{'children':[%d,%d]},", i, i);
	strcat(twice, "{}]");
	const struct { const char *rest, *order; enum eco_code code; const char *says; } cases[] = {
		{ ",'scene':1,'scenes':[{'nodes':[0]},{'nodes':[2,1]}],'nodes':[{},"
			"{'children':[3,4]},{},{},{}]", "2 1 3 4 ", ECO_OK, "" },
		{ ",'scenes':[{'nodes':[1]},{'nodes':[0]}],'nodes':[{},{}]", "1 ", ECO_OK, "" },
		{ ",'nodes':[{},{'children':[0]},{}]", "1 0 2 ", ECO_OK, "" },
		{ ",'nodes':[{'children':[1],'extensions':{'KHR_node_visibility':{'visible':false}"
			"}},{},{}]", "2 ", ECO_OK, "" },
		{ ",'scene':3,'scenes':[{}],'nodes':[{},{'children':[0]}]", "1 0 ", ECO_OK, "" },
		{ ",'scene':'hello','scenes':[{'nodes':[0]}],'nodes':[{},{}]", "0 1 ", ECO_OK, "" },
		{ ",'scene':0", "", ECO_OK, "" },
		{ ",'scenes':[{'nodes':[5]}],'nodes':[{}]", "", ECO_DAMAGED, "" },
		{ ",'nodes':[{'children':[-1]}]", "0 ", ECO_DAMAGED, "" },
		{ ",'scenes':[{'nodes':[0]}],'nodes':[{'children':[1]},{'children':[0]}]", NULL, ECO_DAMAGED,
			"node 0 or one above it lies below itself" },
		{ ",'scenes':[{'nodes':[0]}],'nodes':[{'children':[0,0]}]", NULL, ECO_DAMAGED, "lies below itself" },
		{ twice, NULL, ECO_TOO_LARGE, "more than 1048576 nodes" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char order[200] = "";
		gw_begin();
		open_good(cases[i].rest);
		assert_code(eco_gltf_walk(doc, note_node, order, &cause), cases[i].code, cases[i].says);
		if (cases[i].order)
			assert_string_equal(order, cases[i].order);
		eco_gltf_close(doc);
	}
}
