/* glTF: what the specification and its extensions say is what arrives, and what does not fit is refused by name. Each oddity is the small
 * file that shows it. Long for that reason. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <meshoptimizer.h>

#include "ecofiles/draco_shim.h"
#include "ecofiles/gltf.h"
#include "ecofiles/image.h"
#include "ecofiles/import_model.h"
#include "ecofiles/rows.h"
#include "tests/gltf_writer.h"
#include "tests/input_files.h"

#define CHUNK_JSON ",\"meshes\":[]"

static uint8_t *file_bytes;          /* of the open document */

static struct eco_gltf *open_good(const char *rest)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_gltf *doc;
	size_t size = gw_glb_bytes(rest, ' ', &file_bytes);

	if (eco_gltf_open_memory(&doc, "build/tmp/gltf/x.glb", file_bytes, size, &error) != ECO_OK)
		fail_msg("%s", error.text);
	return doc;
}

static void close_good(struct eco_gltf *doc)
{
	eco_gltf_close(doc);
	free(file_bytes);
}

static void expect_floats(struct eco_gltf *doc, int accessor, uint32_t components, const double *wanted, uint64_t wanted_count)
{
	struct eco_error error = { .code = ECO_OK };
	double *values;
	uint64_t count;

	if (eco_gltf_read_floats(doc, (uint32_t)accessor, components, &values, &count, &error) != ECO_OK)
		fail_msg("%s", error.text);
	assert_int_equal(count, wanted_count);
	for (uint64_t i = 0; i < count * components; i++)
		if (fabs(values[i] - wanted[i]) > 1e-6)
			fail_msg("value %llu is %g, not %g", (unsigned long long)i, values[i], wanted[i]);
	free(values);
}

static void expect_refused(struct eco_gltf *doc, int accessor, enum eco_code wanted, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	double *values;
	uint64_t count;

	assert_int_equal(eco_gltf_read_floats(doc, (uint32_t)accessor, 0, &values, &count, &error), wanted);
	assert_null(values);
	if (strstr(error.text, says) == NULL)
		fail_msg("%s\n  wanted ... %s", error.text, says);
}

/* ---- Containers ---- */

static void json_may_be_padded_with_zeros_or_begin_with_a_mark(void **state)
{
	struct eco_gltf *doc;
	uint8_t *bytes;
	size_t size;
	char text[130000];

	(void)state;
	gw_begin();
	size = gw_glb_bytes(CHUNK_JSON, 0, &bytes);
	assert_int_equal(eco_gltf_open_memory(&doc, "a.glb", bytes, size, NULL), ECO_OK);
	eco_gltf_close(doc);
	free(bytes);
	snprintf(text, sizeof text, "\xef\xbb\xbf%s", gw_json("", CHUNK_JSON));
	assert_int_equal(eco_gltf_open_memory(&doc, "a.gltf", (uint8_t *)text, strlen(text), NULL), ECO_OK);
	eco_gltf_close(doc);
}

static void a_document_that_is_cut_off_is_refused(void **state)
{
	const float p[3] = { 1, 2, 3 };
	uint8_t *bytes;
	size_t size;

	(void)state;
	gw_begin();
	gw_floats(p, 1, "VEC3", 3);
	size = gw_glb_bytes(CHUNK_JSON, ' ', &bytes);
	for (size_t at = 0; at < size; at++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_gltf *doc;
		uint8_t *cut = malloc(at + 1);

		memcpy(cut, bytes, at);
		assert_int_not_equal(eco_gltf_open_memory(&doc, "cut.glb", cut, at, &error), ECO_OK);
		assert_null(doc);
		assert_non_null(strstr(error.text, "cut.glb"));
		free(cut);
	}
	free(bytes);
}

static void what_is_no_gltf_2_is_named(void **state)
{
	static const struct { const char *text; enum eco_code code; const char *says; } cases[] = {
		{ "{\"asset\":{\"version\":\"1.0\"}}", ECO_UNSUPPORTED, "glTF 1.0" },
		{ "{\"asset\":{},\"meshes\":{\"a\":{}}}", ECO_UNSUPPORTED, "glTF 1.0" },
		{ "glTF\1\0\0\0________________", ECO_DAMAGED, "cut off" }, { "{\"asset\":{\"version\":\"3.0\"}}", ECO_UNSUPPORTED, "glTF 3.0" },
		{ "{\"type\":\"FeatureCollection\"}", ECO_BAD_INPUT, "no \"asset\"" }, { "[1,2]", ECO_BAD_INPUT, "no \"asset\"" },
		{ "{\"asset\":\n{]}", ECO_BAD_INPUT, "line 2" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_gltf *doc;

		assert_int_equal(eco_gltf_open_memory(&doc, "n.gltf", (const uint8_t *)cases[i].text, strlen(cases[i].text), &error), cases[i].code);
		if (strstr(error.text, cases[i].says) == NULL)
			fail_msg("%s\n  wanted ... %s", error.text, cases[i].says);
	}
}

static void buffers_are_found_beside_or_within(void **state)
{
	static const float p[3] = { 1, 2, 3 };
	static const char *const uris[] = { "two words.bin", "two%20words.bin", ".\\\\two words.bin", "C:\\\\plants\\\\Two Words.BIN",
		"data:application/octet-stream;base64,AACAPwAAAEAAAEBA", "data:;base64,AACA\\nPwAAAEAAAEBA", "data:,%00%00%80%3f%00%00%00%40%00%00%40%40" };

	(void)state;
	input_bytes("gltf", "two words.bin", p, sizeof p);
	for (size_t i = 0; i < sizeof uris / sizeof *uris; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_gltf *doc;
		char buffer[200];

		gw_begin();
		gw_floats(p, 1, "VEC3", 3);
		snprintf(buffer, sizeof buffer, ",\"uri\":\"%s\"", uris[i]);
		if (eco_gltf_open(&doc, input_text("gltf", "b.gltf", gw_json(buffer, CHUNK_JSON)), &error) != ECO_OK)
			fail_msg("%s", error.text);
		expect_floats(doc, 0, 3, (const double[]){ 1, 2, 3 }, 1);
		eco_gltf_close(doc);
	}
}

static void a_buffer_that_is_missing_is_told_when_it_is_needed(void **state)
{
	static const struct { const char *buffer; enum eco_code code; const char *says; } cases[] = {
		{ ",\"uri\":\"none.bin\"", ECO_NOT_FOUND, "none.bin" }, { "", ECO_DAMAGED, "buffer 0 has no data" },
		{ ",\"uri\":\"data:base64\"", ECO_DAMAGED, "comma" }, { ",\"uri\":\"data:;base64,?\"", ECO_DAMAGED, "base64" },
		{ ",\"uri\":\"data:;base64,AAAA\"", ECO_DAMAGED, "has only 3 bytes" },
	};
	static const float p[3] = { 1, 2, 3 };

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_gltf *doc;

		gw_begin();
		gw_floats(p, 1, "VEC3", 3);
		assert_int_equal(eco_gltf_open(&doc, input_text("gltf", "b.gltf", gw_json(cases[i].buffer, CHUNK_JSON)), NULL), ECO_OK);
		expect_refused(doc, 0, cases[i].code, cases[i].says);
		eco_gltf_close(doc);
	}
}

/* ---- Accessors ---- */

static void numbers_of_every_type_are_read(void **state)
{
	static const int8_t bytes[4] = { -128, -127, 0, 127 };
	static const int16_t shorts[4] = { -32768, -1, 0, 32767 };
	static const uint32_t words[4] = { 0, 1, 65536, 4000000000u };
	static const double doubles[4] = { -1e100, 0, 1, 0.1 };
	static const struct { int type; const void *from; size_t size; bool normalized; double wanted[4]; } cases[] = {
		{ GLTF_BYTE, bytes, 4, false, { -128, -127, 0, 127 } }, { GLTF_BYTE, bytes, 4, true, { -1, -1, 0, 1 } },
		{ GLTF_UBYTE, bytes, 4, false, { 128, 129, 0, 127 } }, { GLTF_UBYTE, bytes, 4, true, { 128 / 255.0, 129 / 255.0, 0, 127 / 255.0 } },
		{ GLTF_SHORT, shorts, 8, false, { -32768, -1, 0, 32767 } }, { GLTF_SHORT, shorts, 8, true, { -1, -1 / 32767.0, 0, 1 } },
		{ GLTF_USHORT, shorts, 8, false, { 32768, 65535, 0, 32767 } }, { GLTF_USHORT, shorts, 8, true, { 32768 / 65535.0, 1, 0, 32767 / 65535.0 } },
		{ GLTF_UINT, words, 16, false, { 0, 1, 65536, 4e9 } }, { GLTF_UINT, words, 16, true, { 0, 1, 65536, 4e9 } },
		{ 5130, doubles, 32, false, { -1e100, 0, 1, 0.1 } },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_gltf *doc;

		gw_begin();
		gw_accessor(gw_view(cases[i].from, cases[i].size, ""), cases[i].type, 4, "SCALAR", cases[i].normalized ? ",\"normalized\":true" : "");
		doc = open_good("");
		expect_floats(doc, 0, 1, cases[i].wanted, 4);
		close_good(doc);
	}
}

static void strides_offsets_and_columns_are_kept(void **state)
{
	static const float interleaved[10] = { 9, 1, 2, 9, 9, 3, 4, 9, 5, 6 };
	static const uint8_t columns[2 * 12] = { 1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 11, 12, 13, 0, 14, 15, 16, 0, 17, 18, 19, 0 };
	struct eco_gltf *doc;

	(void)state;
	gw_begin();
	gw_accessor(gw_view(interleaved, sizeof interleaved, ",\"byteStride\":16.0"), GLTF_FLOAT, 2, "VEC2", ",\"byteOffset\":4");
	gw_accessor(gw_view(columns, sizeof columns, ""), GLTF_UBYTE, 2, "MAT3", "");
	doc = open_good("");
	expect_floats(doc, 0, 2, (const double[]){ 1, 2, 3, 4 }, 2);
	expect_floats(doc, 1, 9, (const double[]){ 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 16, 17, 18, 19 }, 2);
	close_good(doc);
}

static void sparse_accessors_are_filled_in(void **state)
{
	static const float base[4] = { 1, 2, 3, 4 }, values[2] = { 20, 40 };
	static const uint8_t bytes[2] = { 1, 3 };
	static const uint32_t words[2] = { 1, 9 };
	char sparse[3][300];
	int v, i8, i32;
	struct eco_gltf *doc;

	(void)state;
	gw_begin();
	v = gw_view(values, sizeof values, "");
	i8 = gw_view(bytes, sizeof bytes, "");
	i32 = gw_view(words, sizeof words, "");
	for (int i = 0; i < 3; i++)
		snprintf(sparse[i], sizeof sparse[i], ",\"sparse\":{\"count\":%d,\"indices\":{\"bufferView\":%d,\"componentType\":%d},\"values\":{"
			"\"bufferView\":%d}}", i == 2 ? 1 : 2, i == 0 ? i8 : i32, i == 0 ? GLTF_UBYTE : GLTF_UINT, v);
	gw_accessor(gw_view(base, sizeof base, ""), GLTF_FLOAT, 4, "SCALAR", sparse[0]);
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", sparse[0]);         /* of zeros */
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", "");
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", sparse[1]);
	gw_accessor(-1, GLTF_FLOAT, 4, "SCALAR", sparse[2]);
	doc = open_good("");
	expect_floats(doc, 0, 1, (const double[]){ 1, 20, 3, 40 }, 4);
	expect_floats(doc, 1, 1, (const double[]){ 0, 20, 0, 40 }, 4);
	expect_floats(doc, 2, 1, (const double[]){ 0, 0, 0, 0 }, 4);
	expect_refused(doc, 3, ECO_DAMAGED, "names element 9 of 4");
	expect_floats(doc, 4, 1, (const double[]){ 0, 20, 0, 0 }, 4);
	close_good(doc);
}

static void accessors_beyond_their_bytes_are_refused(void **state)
{
	static const float four[4];
	static const struct { const char *more; size_t count; const char *kind; enum eco_code code; const char *says; } cases[] = {
		{ "", 5, "SCALAR", ECO_DAMAGED, "needs 20 bytes" }, { ",\"byteOffset\":4", 4, "SCALAR", ECO_DAMAGED, "needs 16 bytes" },
		{ ",\"byteOffset\":-4", 1, "SCALAR", ECO_DAMAGED, "needs 4 bytes" }, { "", 2, "VEC3", ECO_DAMAGED, "needs 24 bytes" },
		{ ",\"byteOffset\":18446744073709551615", 1, "SCALAR", ECO_DAMAGED, "" }, { "", 1, "VEC5", ECO_DAMAGED, "VEC5" },
		{ "", (size_t)1 << 40, "SCALAR", ECO_TOO_LARGE, "more numbers" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_gltf *doc;
		uint8_t *bytes;
		size_t size;

		gw_begin();
		gw_accessor(gw_view(four, sizeof four, ""), GLTF_FLOAT, cases[i].count, cases[i].kind, cases[i].more);
		size = gw_glb_bytes("", ' ', &bytes);
		if (eco_gltf_open_memory(&doc, "x.glb", bytes, size, &error) == ECO_OK)
			expect_refused(doc, 0, cases[i].code, cases[i].says);
		eco_gltf_close(doc);
		free(bytes);
	}
}

/* ---- meshopt ---- */

static void views_compressed_with_meshopt_are_unpacked(void **state)
{
	float places[100][4];
	unsigned triangles[300], list[100];
	unsigned char packed[8192];
	double wanted[400], corners[300];
	struct eco_gltf *doc;

	(void)state;
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

		gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, places, 100, 16), 100, 16, "ATTRIBUTES", "NONE", extension),
			GLTF_FLOAT, 100, "VEC4", "");
		gw_accessor(gw_packed(packed, meshopt_encodeIndexBuffer(packed, sizeof packed, triangles, 300), 300, 2, "TRIANGLES", "NONE", extension),
			GLTF_USHORT, 300, "SCALAR", "");
		gw_accessor(gw_packed(packed, meshopt_encodeIndexSequence(packed, sizeof packed, list, 100), 100, 4, "INDICES", "NONE", extension),
			GLTF_UINT, 100, "SCALAR", "");
	}
	doc = open_good("");
	for (int e = 0; e < 2; e++) {
		double *values;
		uint64_t count;

		expect_floats(doc, e * 3, 4, wanted, 100);
		assert_int_equal(eco_gltf_read_floats(doc, (uint32_t)e * 3 + 1, 1, &values, &count, NULL), ECO_OK);
		for (unsigned i = 0; i < 300; i += 3)        /* triangles keep their order, and may begin at another corner */
			assert_true(values[i] + values[i + 1] + values[i + 2] == corners[i] + corners[i + 1] + corners[i + 2]);
		free(values);
		assert_int_equal(eco_gltf_read_floats(doc, (uint32_t)e * 3 + 2, 1, &values, &count, NULL), ECO_OK);
		for (unsigned i = 0; i < 100; i++)
			assert_true(values[i] == list[i]);
		free(values);
	}
	close_good(doc);
}

static void filters_of_meshopt_are_undone(void **state)
{
	static const float normals[4][4] = { { 0, 0, 1, 0 }, { 0.6f, 0.8f, 0, 0 }, { 0, -1, 0, 0 }, { -0.6f, 0, -0.8f, 0 } };
	static const float turns[2][4] = { { 0, 0.70710678f, 0, 0.70710678f }, { 0.5f, 0.5f, 0.5f, 0.5f } };
	static const float places[2][3] = { { 1, 2, 3 }, { -400, 0.25f, 0 } };
	unsigned char filtered[64], packed[512];
	double *values;
	uint64_t count;
	struct eco_gltf *doc;

	(void)state;
	gw_begin();
	meshopt_encodeFilterOct(filtered, 4, 8, 16, normals[0]);
	gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, filtered, 4, 8), 4, 8, "ATTRIBUTES", "OCTAHEDRAL",
		"EXT_meshopt_compression"), GLTF_SHORT, 4, "VEC4", ",\"normalized\":true");
	meshopt_encodeFilterQuat(filtered, 2, 8, 16, turns[0]);
	gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, filtered, 2, 8), 2, 8, "ATTRIBUTES", "QUATERNION",
		"EXT_meshopt_compression"), GLTF_SHORT, 2, "VEC4", ",\"normalized\":true");
	meshopt_encodeFilterExp(filtered, 2, 12, 24, places[0]);
	gw_accessor(gw_packed(packed, meshopt_encodeVertexBuffer(packed, sizeof packed, filtered, 2, 12), 2, 12, "ATTRIBUTES", "EXPONENTIAL",
		"EXT_meshopt_compression"), GLTF_FLOAT, 2, "VEC3", "");
	doc = open_good("");
	assert_int_equal(eco_gltf_read_floats(doc, 0, 4, &values, &count, NULL), ECO_OK);
	for (int i = 0; i < 16; i++)
		assert_true(i % 4 == 3 || fabs(values[i] - (double)normals[i / 4][i % 4]) < 1e-3);
	free(values);
	assert_int_equal(eco_gltf_read_floats(doc, 1, 4, &values, &count, NULL), ECO_OK);
	for (int i = 0; i < 8; i++)
		assert_true(fabs(values[i] - (double)turns[i / 4][i % 4]) < 1e-3);
	free(values);
	expect_floats(doc, 2, 3, (const double[]){ 1, 2, 3, -400, 0.25, 0 }, 2);
	close_good(doc);
}

/* Written by meshoptimizer 1.3 at its highest level: 20 vertices of 12 bytes whose channels are of the three kinds; four colours in 8 bits,
 * and in 16 of which 12 count. */
static void the_second_version_of_the_meshopt_codec_is_read(void **state)
{
	static const uint8_t golden[] = { 0xa1, 0x95, 0x97, 0x99, 0x05, 0x2a, 0xea, 0xea, 0xea, 0x05, 0x05, 0x05, 0xea, 0x00,
		0x00, 0x00, 0x05, 0x00, 0x10, 0x11, 0x08, 0x07, 0x08, 0x01, 0x00, 0x07, 0x00, 0x00, 0x01, 0x02, 0x01, 0x00, 0x02,
		0x00, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58, 0x58,
		0x58, 0x05, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x00, 0x00, 0x00, 0x05, 0x15, 0x55, 0x55, 0x55, 0x55, 0x00, 0x00, 0x00,
		0x05, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x00, 0x00, 0x00, 0x02, 0x01, 0x56, 0x06, 0x51, 0x15, 0x60, 0x65, 0x11, 0x0b,
		0x00, 0x05, 0x06, 0x06, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
		0xe8, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x32 };
	static const uint8_t narrow[] = { 0xa1, 0xff, 0x00, 0x3e, 0xbf, 0x02, 0x00, 0xe5, 0x17, 0x00, 0x00, 0xf0, 0x71, 0x00,
		0x00, 0x7d, 0x7f, 0xfe, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
		0x00, 0x00, 0x00, 0x00, 0x40, 0x7f, 0xc1, 0xff, 0x00 };
	static const uint8_t wide[] = { 0xa1, 0xff, 0xff, 0x00, 0x01, 0x00, 0x02, 0x00, 0x02, 0x14, 0x1d, 0x00, 0x65, 0x68,
		0x00, 0x00, 0x0d, 0x00, 0x00, 0x00, 0xcf, 0xce, 0x00, 0x00, 0x0e, 0x05, 0x00, 0x00, 0x02, 0x00, 0x01, 0x00, 0x05,
		0x07, 0x0e, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x04, 0xff,
		0x07, 0x01, 0xfc, 0xff, 0x0f, 0x00, 0x00 };
	static const double colors[16] = { 1, 0, 0, 1, 0.2, 0.6, 0.1, 0.5, 1, 1, 1, 0, 0, 0, 0, 1 };
	uint32_t words[60];
	struct eco_gltf *doc;
	const uint8_t *bytes;
	size_t size;

	(void)state;
	gw_begin();
	gw_packed(golden, sizeof golden, 20, 12, "ATTRIBUTES", "NONE", "KHR_meshopt_compression");
	gw_accessor(gw_packed(narrow, sizeof narrow, 4, 4, "ATTRIBUTES", "COLOR", "KHR_meshopt_compression"), GLTF_UBYTE, 4, "VEC4", ",\"normalized\":true");
	gw_accessor(gw_packed(wide, sizeof wide, 4, 8, "ATTRIBUTES", "COLOR", "KHR_meshopt_compression"), GLTF_USHORT, 4, "VEC4", ",\"normalized\":true");
	for (size_t cut = 0; cut < sizeof golden; cut++)
		gw_packed(golden, cut, 20, 12, "ATTRIBUTES", "NONE", "KHR_meshopt_compression");
	doc = open_good("");
	assert_int_equal(eco_gltf_view(doc, 0, &bytes, &size, NULL), ECO_OK);
	assert_int_equal(size, sizeof words);
	memcpy(words, bytes, sizeof words);
	for (uint32_t i = 0; i < 20; i++) {
		assert_int_equal(words[i * 3], (i & 3) + 256 * (i & 4) + 0x10000 * (i >> 3));
		assert_int_equal(words[i * 3 + 1], (i * 300) | (1000 - i) << 16);
		assert_int_equal(words[i * 3 + 2], (i * i % 7) << 13 | 0x40000000 * (i & 1));
	}
	for (int a = 0; a < 2; a++) {
		double *values;
		uint64_t count;

		assert_int_equal(eco_gltf_read_floats(doc, (uint32_t)a, 4, &values, &count, NULL), ECO_OK);
		for (int i = 0; i < 16; i++)
			assert_true(fabs(values[i] - colors[i]) < (a == 0 ? 0.02 : 0.002));
		free(values);
	}
	for (uint32_t cut = 0; cut < sizeof golden; cut++)
		assert_int_equal(eco_gltf_view(doc, cut + 3, &bytes, &size, NULL), ECO_DAMAGED);
	close_good(doc);
}

static void meshopt_that_makes_no_sense_is_refused(void **state)
{
	static const uint8_t bytes[64] = { 0xa0 };
	static const struct { size_t count, stride; const char *mode, *filter; enum eco_code code; } cases[] = {
		{ 10, 12, "ATTRIBUTES", "NONE", ECO_DAMAGED }, { 10, 13, "ATTRIBUTES", "NONE", ECO_DAMAGED }, { 10, 512, "ATTRIBUTES", "NONE", ECO_DAMAGED },
		{ 10, 0, "ATTRIBUTES", "NONE", ECO_DAMAGED }, { 10, 4, "TRIANGLES", "NONE", ECO_DAMAGED }, { 9, 3, "TRIANGLES", "NONE", ECO_DAMAGED },
		{ 9, 4, "TRIANGLES", "OCTAHEDRAL", ECO_DAMAGED }, { 10, 12, "ATTRIBUTES", "QUATERNION", ECO_DAMAGED },
		{ 10, 12, "ATTRIBUTES", "SECRET", ECO_UNSUPPORTED }, { 10, 12, "QUADS", "NONE", ECO_UNSUPPORTED },
		{ (size_t)1 << 31, 256, "ATTRIBUTES", "NONE", ECO_TOO_LARGE }, { (size_t)1 << 20, 256, "ATTRIBUTES", "NONE", ECO_DAMAGED },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const uint8_t *view;
		struct eco_gltf *doc;
		size_t size;

		gw_begin();
		gw_packed(bytes, sizeof bytes, cases[i].count, cases[i].stride, cases[i].mode, cases[i].filter, "EXT_meshopt_compression");
		doc = open_good("");
		assert_int_equal(eco_gltf_view(doc, 0, &view, &size, NULL), cases[i].code);
		close_good(doc);
	}
}

/* ---- Nodes ---- */

static void nodes_stand_where_their_ancestors_put_them(void **state)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_gltf *doc;
	double m[16], p[3];

	(void)state;
	gw_begin();
	doc = open_good(",\"nodes\":[{\"children\":[1],\"translation\":[0,2,0],\"scale\":[2,2,2]},{\"children\":[2],\"rotation\":[0,0.6,0,0.6]},"
		"{\"matrix\":[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]},{\"children\":[4]},{\"children\":[3]},{\"rotation\":[0,0,0,0]},{\"scale\":[1,\"x\"]}]");
	assert_int_equal(eco_gltf_node_matrix(doc, 2, m, NULL), ECO_OK);
	eco_gltf_apply(m, (const double[]){ 1, 0, 0 }, p);           /* (6, 6, 7), a quarter turn about Y: (7, 6, -6), twice, 2 up */
	assert_true(fabs(p[0] - 14) < 1e-9 && fabs(p[1] - 14) < 1e-9 && fabs(p[2] + 12) < 1e-9);
	assert_int_equal(eco_gltf_node_matrix(doc, 3, m, &error), ECO_DAMAGED);
	assert_non_null(strstr(error.text, "below itself"));
	assert_int_equal(eco_gltf_node_matrix(doc, 5, m, NULL), ECO_OK);
	assert_true(m[0] == 1 && m[5] == 1);
	assert_int_equal(eco_gltf_node_matrix(doc, 6, m, NULL), ECO_DAMAGED);
	assert_int_equal(eco_gltf_node_matrix(doc, 7, m, NULL), ECO_DAMAGED);
	close_good(doc);
}

static enum eco_code note_node(void *ctx, uint32_t node, const double world[16])
{
	(void)world;
	snprintf((char *)ctx + strlen(ctx), 20, "%u ", node);
	return ECO_OK;
}

static void what_a_viewer_would_show_is_walked(void **state)
{
	static const struct { const char *rest, *order; enum eco_code code; } cases[] = {
		{ ",\"scene\":1,\"scenes\":[{\"nodes\":[0]},{\"nodes\":[2,1]}],\"nodes\":[{},{\"children\":[3,4]},{},{},{}]", "2 1 3 4 ", ECO_OK },
		{ ",\"scenes\":[{\"nodes\":[1]},{\"nodes\":[0]}],\"nodes\":[{},{}]", "1 ", ECO_OK },
		{ ",\"nodes\":[{},{\"children\":[0]},{}]", "1 0 2 ", ECO_OK },
		{ ",\"nodes\":[{\"children\":[1],\"extensions\":{\"KHR_node_visibility\":{\"visible\":false}}},{},{}]", "2 ", ECO_OK },
		{ ",\"scene\":3,\"scenes\":[{}]", "", ECO_DAMAGED }, { ",\"scenes\":[{\"nodes\":[5]}],\"nodes\":[{}]", "", ECO_DAMAGED },
		{ ",\"nodes\":[{\"children\":[-1]}]", "0 ", ECO_DAMAGED },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char order[200] = "";
		struct eco_gltf *doc;

		gw_begin();
		doc = open_good(cases[i].rest);
		assert_int_equal(eco_gltf_walk(doc, note_node, order, NULL), cases[i].code);
		assert_string_equal(order, cases[i].order);
		close_good(doc);
	}
}

static enum eco_code ignore_node(void *ctx, uint32_t node, const double world[16])
{
	(void)ctx;
	(void)node;
	(void)world;
	return ECO_OK;
}

static void a_tree_that_is_none_ends(void **state)
{
	static const char *const cases[] = { ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1]},{\"children\":[0]}]",
		",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[0,0]}]" };

	(void)state;
	for (size_t i = 0; i < 2; i++) {
		struct eco_gltf *doc;

		gw_begin();
		doc = open_good(cases[i]);
		assert_int_equal(eco_gltf_walk(doc, ignore_node, NULL, NULL), ECO_TOO_LARGE);
		close_good(doc);
	}
}

/* ---- Models: as they are read, before anything is dropped or moved ---- */

static struct eco_model_frame frame;
static struct eco_notes notes;

static enum eco_code read_model(struct eco_model *m, const char *rest, uint32_t triangles_max, struct eco_error *error)
{
	struct eco_gltf *doc;
	uint8_t *bytes;
	size_t size = gw_glb_bytes(rest, ' ', &bytes);
	enum eco_code code;

	*m = (struct eco_model){ .position = NULL };
	frame = (struct eco_model_frame){ .unit_m = 0 };
	notes = (struct eco_notes){ .used = 0 };
	code = eco_gltf_open_memory(&doc, input_path("gltf", "m.glb"), bytes, size, error);
	if (code == ECO_OK)
		code = eco_gltf_read_document(m, &frame, doc, triangles_max, &notes, error);
	eco_gltf_close(doc);
	free(bytes);
	return code;
}

static void read_good(struct eco_model *m, const char *rest)
{
	struct eco_error error = { .code = ECO_OK };
	uint64_t accounted;

	if (read_model(m, rest, 1000000, &error) != ECO_OK)
		fail_msg("%s", error.text);
	accounted = m->triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m->dropped[i];
	assert_int_equal(accounted, m->triangles_in);
	assert_true(frame.unit_m == 1 && frame.up == ECO_UP_Y);
	for (uint32_t i = 0; i < m->triangle_count; i++)
		assert_true(m->material[i] < m->material_count && m->part[i] < m->part_count);
}

static void read_fails(const char *rest, enum eco_code wanted, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_model m;
	enum eco_code code = read_model(&m, rest, 1000, &error);

	eco_model_free(&m);
	if (code != wanted || strstr(error.text, says) == NULL)
		fail_msg("%s: %s\n  wanted %s ... %s", eco_code_name(code), error.text, eco_code_name(wanted), says);
}

/* Corner c of triangle t is at that place, in the file's own axes. */
static void expect_corner(const struct eco_model *m, uint32_t t, uint32_t c, double x, double y, double z)
{
	const float *p;

	assert_true(t < m->triangle_count && m->index[t * 3 + c] < m->vertex_count);
	p = &m->position[m->index[t * 3 + c] * 3];
	if (fabs((double)p[0] - x) + fabs((double)p[1] + z) + fabs((double)p[2] - y) > 1e-4)
		fail_msg("corner %u of triangle %u is at %g %g %g, not %g %g %g", c, t, (double)p[0], (double)p[2], -(double)p[1], x, y, z);
}

static const float square[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } };
#define ONE_MESH(attributes, more) ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{" attributes "}" more "}]}]"

static void indices_of_every_type_or_none_make_triangles(void **state)
{
	static const uint8_t bytes[6] = { 0, 1, 2, 2, 1, 3 };
	static const uint16_t shorts[6] = { 0, 1, 2, 2, 1, 3 };
	static const uint32_t words[6] = { 0, 1, 2, 2, 1, 3 };
	struct eco_model m;

	(void)state;
	for (int i = 0; i < 4; i++) {
		gw_begin();
		gw_floats(square[0], i < 3 ? 4 : 3, "VEC3", 3);
		if (i == 0)
			gw_accessor(gw_view(bytes, sizeof bytes, ""), GLTF_UBYTE, 6, "SCALAR", "");
		else if (i == 1)
			gw_accessor(gw_view(shorts, sizeof shorts, ""), GLTF_USHORT, 6, "SCALAR", "");
		else
			gw_accessor(gw_view(words, sizeof words, ""), GLTF_UINT, 6, "SCALAR", "");
		read_good(&m, i < 3 ? ONE_MESH("\"POSITION\":0", ",\"indices\":1") : ONE_MESH("\"POSITION\":0", ""));
		assert_int_equal(m.triangle_count, i < 3 ? 2 : 1);
		expect_corner(&m, 0, 1, 1, 0, 0);
		if (i < 3)
			expect_corner(&m, 1, 2, 1, 1, 0);
		eco_model_free(&m);
	}
}

static void strips_and_fans_become_triangles(void **state)
{
	static const uint16_t strip[] = { 0, 1, 2, 3, 0xffff, 3, 2, 1 }, fan[] = { 0, 1, 3, 2 };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 4, "VEC3", 3);
	gw_accessor(gw_view(strip, sizeof strip, ""), GLTF_USHORT, 8, "SCALAR", "");
	gw_accessor(gw_view(fan, sizeof fan, ""), GLTF_USHORT, 4, "SCALAR", "");
	read_good(&m, ONE_MESH("\"POSITION\":0", ",\"indices\":1,\"mode\":5"));
	assert_int_equal(m.triangle_count, 3);       /* and one behind the restart */
	expect_corner(&m, 0, 2, 0, 1, 0);
	expect_corner(&m, 1, 0, 0, 1, 0);            /* the second keeps the first's winding */
	expect_corner(&m, 1, 1, 1, 0, 0);
	expect_corner(&m, 1, 2, 1, 1, 0);
	expect_corner(&m, 2, 0, 1, 1, 0);
	eco_model_free(&m);
	read_good(&m, ONE_MESH("\"POSITION\":0", ",\"indices\":2,\"mode\":6"));
	assert_int_equal(m.triangle_count, 2);
	expect_corner(&m, 1, 0, 0, 0, 0);
	expect_corner(&m, 1, 1, 1, 1, 0);
	expect_corner(&m, 1, 2, 0, 1, 0);
	eco_model_free(&m);
}

static void points_and_lines_are_counted_and_said(void **state)
{
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 4, "VEC3", 3);
	read_good(&m, ",\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}},{\"attributes\":{\"POSITION\":0},\"mode\":0},"
		"{\"attributes\":{\"POSITION\":0},\"mode\":3},{\"attributes\":{}}]}]");
	assert_int_equal(m.triangle_count, 1);
	assert_non_null(strstr(notes.text, "4 points and 3 lines are left out"));
	assert_non_null(strstr(notes.text, "1 primitives without positions"));
	assert_non_null(strstr(notes.text, "1 corners"));
	eco_model_free(&m);
	read_fails(ONE_MESH("\"POSITION\":0", ",\"mode\":0"), ECO_BAD_INPUT, "only 4 points");
	read_fails(ONE_MESH("\"POSITION\":0", ",\"mode\":9"), ECO_DAMAGED, "meshes[0].primitives[0]: its mode");
	read_fails("", ECO_BAD_INPUT, "no triangles in its scene");
}

static void a_broken_index_is_kept_apart(void **state)
{
	static const uint16_t indices[6] = { 0, 1, 2, 2, 1, 4 };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 4, "VEC3", 3);
	gw_accessor(gw_view(indices, sizeof indices, ""), GLTF_USHORT, 6, "SCALAR", "");
	read_good(&m, ONE_MESH("\"POSITION\":0", ",\"indices\":1"));
	assert_int_equal(m.triangle_count, 2);
	assert_int_equal(m.index[5], ECO_NONE);
	assert_int_equal(m.vertex_count, 3);         /* what nobody names is left behind */
	eco_model_free(&m);
}

static void quantized_meshes_are_read(void **state)
{
	static const uint16_t corners[3][4] = { { 0, 0, 0 }, { 65535, 0, 0 }, { 0, 65535, 0 } };
	static const int8_t small[3][4] = { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 20, -30 } };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_accessor(gw_view(corners, sizeof corners, ",\"byteStride\":8"), GLTF_USHORT, 3, "VEC3", ",\"normalized\":true");
	gw_accessor(gw_view(small, sizeof small, ",\"byteStride\":4"), GLTF_BYTE, 3, "VEC3", "");
	read_good(&m, ",\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"nodes\":[{\"mesh\":0,\"scale\":[4,4,4],\"translation\":[1,0,0]},{\"mesh\":1}],"
		"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]");
	expect_corner(&m, 0, 0, 1, 0, 0);
	expect_corner(&m, 0, 1, 5, 0, 0);
	expect_corner(&m, 1, 2, 0, 20, -30);
	assert_string_equal(notes.text, "");
	eco_model_free(&m);
}

static void places_far_from_the_origin_keep_their_detail(void **state)
{
	static const float far[3][3] = { { 1e7f, 0, 0 }, { 1e7f + 1, 0, 0 }, { 1e7f, 1, 0 } };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_floats(far[0], 3, "VEC3", 3);
	read_good(&m, ",\"nodes\":[{\"mesh\":0,\"translation\":[5000000.25,100,0]}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]");
	assert_true(frame.base[0] == 5000000 && (double)m.position[0] == 0.25 && (double)m.position[3] == 1.25);
	assert_string_equal(notes.text, "");
	eco_model_free(&m);
	read_good(&m, ONE_MESH("\"POSITION\":1", ""));
	assert_non_null(strstr(notes.text, "in single precision"));
	eco_model_free(&m);
}

static void parts_are_nodes_and_meshes(void **state)
{
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	read_good(&m, ",\"nodes\":[{\"mesh\":0,\"name\":\"Tree\"},{\"mesh\":0},{\"mesh\":0,\"name\":\"Leaves\"},{\"mesh\":1,\"name\":\"Pot\"},{\"mesh\":1,\"name\":\"Pot\"}],"
		"\"meshes\":[{\"name\":\"Leaves\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]");
	assert_int_equal(m.part_count, 3);
	assert_string_equal(m.parts[m.part[0]].name, "Tree/Leaves");
	assert_string_equal(m.parts[m.part[1]].name, "Leaves");
	assert_string_equal(m.parts[m.part[2]].name, "Leaves");
	assert_string_equal(m.parts[m.part[3]].name, "Pot");
	assert_int_equal(m.part[3], m.part[4]);
	eco_model_free(&m);
}

static void instances_of_a_model_are_expanded(void **state)
{
	static const float places[3][3] = { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 0, 10 } }, sizes[3][3] = { { 1, 1, 1 }, { 2, 2, 2 }, { 1, 1, 1 } };
	static const int16_t turns[3][4] = { { 0, 0, 0, 32767 }, { 0, 0, 0, 32767 }, { 0, 23170, 0, 23170 } };
	static const char rest[] = ",\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"nodes\":[{\"mesh\":0,\"translation\":[0,1,0],\"extensions\":{"
		"\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":1,\"SCALE\":2,\"ROTATION\":3}}}}],\"meshes\":[{\"primitives\":[{\"attributes\":"
		"{\"POSITION\":0}}]}]";
	struct eco_error error = { .code = ECO_OK };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_floats(places[0], 3, "VEC3", 3);
	gw_floats(sizes[0], 3, "VEC3", 3);
	gw_accessor(gw_view(turns, sizeof turns, ""), GLTF_SHORT, 3, "VEC4", ",\"normalized\":true");
	read_good(&m, rest);
	assert_int_equal(m.triangle_count, 3);
	expect_corner(&m, 0, 1, 1, 1, 0);
	expect_corner(&m, 1, 1, 12, 1, 0);
	expect_corner(&m, 2, 1, 0, 1, 9);
	assert_non_null(strstr(notes.text, "3 instances"));
	eco_model_free(&m);
	assert_int_equal(read_model(&m, rest, 2, &error), ECO_TOO_LARGE);
	eco_model_free(&m);
}

static void instances_without_end_are_refused_at_once(void **state)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_accessor(-1, GLTF_FLOAT, 80000000, "VEC3", "");           /* zeros, which cost nothing */
	assert_int_equal(read_model(&m, ",\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":1}}}}],"
		"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]", 100, &error), ECO_TOO_LARGE);
	eco_model_free(&m);
}

/* A joint a hundred times as large, whose inverse bind matrix takes that back, 5 to the right; the node's own place does not count. */
static void skins_stand_where_their_joints_hold_them(void **state)
{
	static const float inverse[2][16] = { { 0.01f, 0, 0, 0, 0, 0.01f, 0, 0, 0, 0, 0.01f, 0, 0, 0, 0, 1 },
		{ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
	static const uint8_t joints[3][4] = { { 0, 1 }, { 0, 1 }, { 1, 0 } };
	static const float weights[3][4] = { { 1, 0 }, { 0.5f, 0.5f }, { 1, 0 } };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_accessor(gw_view(joints, sizeof joints, ""), GLTF_UBYTE, 3, "VEC4", "");
	gw_floats(weights[0], 3, "VEC4", 4);
	gw_floats(inverse[0], 2, "MAT4", 16);
	read_good(&m, ",\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[1000,0,0]},{\"translation\":[5,0,0],\"scale\":[100,100,100]},{\"translation\":[7,0,0]}],"
		"\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":3}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,"
		"\"WEIGHTS_0\":2}}]}]");
	expect_corner(&m, 0, 0, 5, 0, 0);
	expect_corner(&m, 0, 1, 7, 0, 0);            /* between 6 and 8 */
	expect_corner(&m, 0, 2, 7, 1, 0);
	eco_model_free(&m);
}

static void morph_targets_have_their_default_weights(void **state)
{
	static const float delta[3][3] = { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 0, 0 } };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_floats(delta[0], 3, "VEC3", 3);
	read_good(&m, ",\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"weights\":[0]},{\"mesh\":0}],\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{\"POSITION\":0},"
		"\"targets\":[{\"POSITION\":1}]}]}]");
	expect_corner(&m, 0, 1, 3, 0, 0);
	expect_corner(&m, 1, 1, 1, 0, 0);
	expect_corner(&m, 2, 1, 3, 0, 0);
	eco_model_free(&m);
}

static void vertex_colours_count_in_linear_light(void **state)
{
	static const uint8_t colors[3][4] = { { 255, 0, 0, 255 }, { 255, 0, 0, 255 }, { 255, 0, 0, 0 } };
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_accessor(gw_view(colors, sizeof colors, ""), GLTF_UBYTE, 3, "VEC4", ",\"normalized\":true");
	read_good(&m, ONE_MESH("\"POSITION\":0,\"COLOR_0\":1", ",\"material\":0") ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,1,1,1]}}]");
	assert_int_equal(m.materials[m.material[0]].rgb[0], 188);
	assert_int_equal(m.materials[m.material[0]].rgb[1], 0);
	assert_non_null(strstr(notes.text, "1 vertices have colours with alpha below 0.5"));
	eco_model_free(&m);
}

static void the_older_materials_and_those_without_any_have_colours(void **state)
{
	struct eco_model m;

	(void)state;
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	read_good(&m, ",\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0},{\"attributes\":{\"POSITION\":0}},"
		"{\"attributes\":{\"POSITION\":0},\"material\":1}]}],\"materials\":[{\"name\":\"old\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1]},"
		"\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0,1,0,1]}}},{\"name\":\"thin\",\"alphaMode\":\"BLEND\","
		"\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,0.2]}}]");
	assert_int_equal(m.triangle_count, 2);
	assert_int_equal(m.dropped[ECO_DROP_TRANSPARENT], 1);
	assert_string_equal(m.materials[m.material[0]].name, "old");
	assert_true(m.materials[m.material[0]].rgb[0] == 0 && m.materials[m.material[0]].rgb[1] == 255);
	assert_true(m.materials[m.material[1]].rgb[0] == 255 && m.materials[m.material[1]].rgb[1] == 255);
	eco_model_free(&m);
}

/* One texel, in a view, a data URI, a file, and nowhere. */
static void pictures_come_from_anywhere_or_are_missed_aloud(void **state)
{
	static const uint8_t rgba[] = { 10, 20, 30, 255 };
	static const float uv[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } }, second[3][2] = { { 5, 5 }, { 6, 5 }, { 5, 6 } };
	struct eco_error error = { .code = ECO_OK };
	struct eco_model m;
	char rest[3000], text[1000] = "";
	uint8_t *png;
	size_t size;

	(void)state;
	if (eco_png_encode(&(struct eco_pixels){ 1, 1, 4, rgba }, &png, &size, &error) != ECO_OK)
		fail_msg("%s", error.text);
	input_bytes("gltf", "bark one.png", png, size);
	for (size_t i = 0; i < size; i++)
		snprintf(text + strlen(text), 4, "%%%02x", png[i]);
	gw_begin();
	gw_floats(square[0], 3, "VEC3", 3);
	gw_floats(uv[0], 3, "VEC2", 2);
	gw_floats(second[0], 3, "VEC2", 2);
	gw_view(png, size, "");
	snprintf(rest, sizeof rest, ",\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[");
	for (int i = 0; i < 5; i++)
		snprintf(rest + strlen(rest), sizeof rest - strlen(rest), "%s{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"TEXCOORD_1\":2},\"material\":%d}",
			i > 0 ? "," : "", i);
	snprintf(rest + strlen(rest), sizeof rest - strlen(rest), "]}],\"materials\":[");
	for (int i = 0; i < 5; i++)
		snprintf(rest + strlen(rest), sizeof rest - strlen(rest), "%s{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":%d,\"texCoord\":%d%s}}}",
			i > 0 ? "," : "", i, i == 0, i == 1 ? ",\"extensions\":{\"KHR_texture_transform\":{\"texCoord\":1,\"scale\":[2,2]}}" : "");
	snprintf(rest + strlen(rest), sizeof rest - strlen(rest), "],\"textures\":[{\"source\":0},{\"source\":1},{\"extensions\":{\"EXT_texture_webp\":{\"source\":2}}},"
		"{\"source\":3},{}],\"images\":[{\"bufferView\":3,\"mimeType\":\"image/png\"},{\"uri\":\"data:image/png,%s\"},{\"uri\":\"bark%%20one.png\"},"
		"{\"uri\":\"none.png\"}]", text);
	free(png);
	read_good(&m, rest);
	assert_int_equal(m.image_count, 3);
	for (uint32_t i = 0; i < 3; i++) {
		assert_int_equal(m.materials[i].image, i);
		assert_memory_equal(m.images[i].rgba, rgba, 4);
	}
	assert_true(m.uv[m.index[0] * 2] == 5 && m.uv[m.index[3] * 2] == 10 && m.uv[m.index[6] * 2] == 0);
	assert_true(m.materials[3].image == ECO_NONE && m.materials[4].image == ECO_NONE);
	assert_non_null(strstr(notes.text, "none.png"));
	assert_non_null(strstr(notes.text, "no picture of a kind that is read"));
	eco_model_free(&m);
}

/* ---- Draco ---- */

#define DRACO_SIDE 300u              /* vertices: more than 16-bit indices reach */

static void draco_meshes_of_any_size_are_read(void **state)
{
	uint32_t vertices = DRACO_SIDE * DRACO_SIDE, faces = 0, *index = malloc(6 * vertices * sizeof *index);
	int32_t *position = malloc(3 * vertices * sizeof *position), view;
	struct eco_error error = { .code = ECO_OK };
	double sum = 0;
	struct eco_model m;
	uint8_t *bytes;
	size_t size;
	char rest[600];

	(void)state;
	for (uint32_t v = 0; v < vertices; v++) {
		position[v * 3] = (int32_t)(v % DRACO_SIDE);
		position[v * 3 + 1] = (int32_t)(v / DRACO_SIDE);
		position[v * 3 + 2] = (int32_t)(v % 5);
		if (v % DRACO_SIDE == DRACO_SIDE - 1 || v / DRACO_SIDE == DRACO_SIDE - 1)
			continue;
		memcpy(&index[faces * 3], (const uint32_t[]){ v, v + 1, v + DRACO_SIDE, v + DRACO_SIDE, v + 1, v + DRACO_SIDE + 1 }, 24);
		faces += 2;
	}
	if (eco_draco_encode_mesh(position, vertices, index, faces, &bytes, &size, &error) != ECO_OK)
		fail_msg("%s", error.text);
	gw_begin();
	view = gw_view(bytes, size, "");
	gw_accessor(-1, GLTF_FLOAT, vertices, "VEC3", "");
	gw_accessor(-1, GLTF_UINT, faces * 3, "SCALAR", "");
	gw_accessor(-1, GLTF_UINT, faces * 3 - 3, "SCALAR", "");
	for (int i = 1; i <= 2; i++) {
		snprintf(rest, sizeof rest, ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
			"{\"POSITION\":0},\"indices\":%d,\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":%d,\"attributes\":{\"POSITION\":0}}}}]}]", i, view);
		if (i == 2) {
			assert_int_equal(read_model(&m, rest, 1000000, &error), ECO_DAMAGED);        /* fewer faces declared than there are */
			assert_non_null(strstr(error.text, "more faces"));
			eco_model_free(&m);
			break;
		}
		read_good(&m, rest);
		assert_int_equal(m.triangle_count, faces);
		assert_int_equal(m.vertex_count, vertices);
		for (uint32_t k = 0; k < vertices * 3; k++)
			sum += (double)m.position[k];
		assert_true(sum == vertices * (DRACO_SIDE - 1.0 - 2));       /* x and y from 0 to the side, less z from 0 to 4 */
		eco_model_free(&m);
	}
	for (size_t cut = 0; cut < size; cut += size / 50 + 1) {
		struct eco_draco_attribute a = { .id = 0, .components = 3 };
		struct eco_draco_mesh mesh;
		uint8_t *part = malloc(cut + 1);

		memcpy(part, bytes, cut);
		assert_int_not_equal(eco_draco_decode_gltf(part, cut, faces, vertices * 3, &a, 1, &mesh, NULL), ECO_OK);
		assert_null(mesh.index);
		assert_null(a.values);
		free(part);
	}
	free(bytes);
	free(position);
	free(index);
}

static void draco_attributes_are_found_by_their_ids(void **state)
{
	static const int32_t position[9] = { 0, 0, 0, 10, 0, 0, 0, 10, 0 };
	static const uint32_t index[3] = { 0, 1, 2 };
	struct eco_draco_attribute a[2] = { { .id = 0, .components = 4 }, { .id = 7, .components = 3 } };
	struct eco_draco_mesh mesh;
	struct eco_error error = { .code = ECO_OK };
	uint8_t *bytes;
	size_t size;

	(void)state;
	assert_int_equal(eco_draco_encode_mesh(position, 3, index, 1, &bytes, &size, NULL), ECO_OK);
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 3, a, 1, &mesh, NULL), ECO_OK);
	assert_true(mesh.faces == 1 && mesh.points == 3);
	for (int k = 0; k < 3; k++)
		assert_true(a[0].values[k * 4] + a[0].values[k * 4 + 1] <= 10 && a[0].values[k * 4 + 3] == 0);
	free(a[0].values);
	free(mesh.index);
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 3, a, 2, &mesh, &error), ECO_DAMAGED);
	assert_non_null(strstr(error.text, "an attribute is missing"));
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 0, 3, a, 1, &mesh, NULL), ECO_DAMAGED);
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 2, a, 1, &mesh, NULL), ECO_DAMAGED);
	bytes[6] = 1;
	assert_int_equal(eco_draco_decode_gltf(bytes, size, 1, 3, a, 1, &mesh, NULL), ECO_UNSUPPORTED);
	free(bytes);
}

/* ---- Refusals ---- */

static void what_a_file_requires_and_is_not_read_is_named(void **state)
{
	static const struct { const char *list, *says; enum eco_code code; } cases[] = {
		{ "\"extensionsRequired\":[\"KHR_texture_basisu\"]", "KHR_texture_basisu", ECO_UNSUPPORTED },
		{ "\"extensionsRequired\":[\"KHR_mesh_quantization\",\"VENDOR_secret\"]", "VENDOR_secret", ECO_UNSUPPORTED },
		{ "\"extensionsRequired\":[3]", "not a name", ECO_UNSUPPORTED }, { "\"extensionsUsed\":[\"VENDOR_secret\"]", "", ECO_OK },
		{ "\"extensionsRequired\":[\"KHR_materials_anything\"]", "", ECO_OK },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char rest[500];

		gw_begin();
		gw_floats(square[0], 3, "VEC3", 3);
		snprintf(rest, sizeof rest, ONE_MESH("\"POSITION\":0", "") ",%s", cases[i].list);
		read_fails(rest, cases[i].code, cases[i].says);
	}
}

static void references_to_nothing_are_refused(void **state)
{
	static const struct { const char *rest, *says; } cases[] = {
		{ ",\"nodes\":[{\"mesh\":4}]", "mesh 4" }, { ONE_MESH("\"POSITION\":9", ""), "accessor 9" },
		{ ONE_MESH("\"POSITION\":0", ",\"indices\":8"), "accessor 8" }, { ONE_MESH("\"POSITION\":1", ""), "components" },
		{ ",\"nodes\":[{\"mesh\":0,\"skin\":2}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]", "skin" },
		{ ",\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]",
			"instances without" },
		{ ",\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0,\"SCALE\":2}}}}],\"meshes\":[{\"primitives\":"
			"[{\"attributes\":{\"POSITION\":0}}]}]", "3 and 2 places" },
		{ ONE_MESH("\"POSITION\":0", ",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}"), "Draco" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		gw_begin();
		gw_floats(square[0], 3, "VEC3", 3);
		gw_floats(square[0], 3, "VEC2", 2);
		gw_floats(square[0], 2, "VEC3", 3);
		read_fails(cases[i].rest, ECO_DAMAGED, cases[i].says);
	}
}

/* Through the child and the clean-up, whatever the file is called. */
static void a_glb_is_known_by_its_content(void **state)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_model m;
	const char *path;
	uint8_t *bytes;
	size_t size;

	(void)state;
	for (int i = 0; i < 3; i++) {
		gw_begin();
		gw_floats(square[0], 3, "VEC3", 3);
		size = gw_glb_bytes(ONE_MESH("\"POSITION\":0", ""), ' ', &bytes);
		path = input_bytes("gltf", i == 0 ? "leaf.glb" : i == 1 ? "leaf.gltf" : "leaf.bin", bytes, size);
		if (eco_model_import(&m, &(struct eco_model_options){ .paths = &path, .path_count = 1 }, &error) != ECO_OK)
			fail_msg("%s", error.text);
		assert_int_equal(m.triangle_count, 1);
		assert_true(fabs(eco_model_height(&m) - 1) < 1e-6);
		eco_model_free(&m);
		free(bytes);
	}
}

/* ---- Inventories ---- */

static void expect_rows(const char *rest, const char *columns, const char *const *lines, size_t line_count)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	char text[2000] = "";
	uint8_t *bytes;
	size_t size = gw_glb_bytes(rest, ' ', &bytes), line = 0;
	bool more = true;

	if (eco_rows_open_gltf(&rows, input_bytes("gltf", "rows.glb", bytes, size), &error) != ECO_OK)
		fail_msg("%s", error.text);
	free(bytes);
	for (uint32_t i = 0; i < rows->column_count; i++)
		snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i > 0 ? "," : "", rows->columns[i]);
	assert_string_equal(text, columns);
	for (;;) {
		assert_int_equal(rows->next(rows, &more, &error), ECO_OK);
		if (!more)
			break;
		text[0] = 0;
		for (uint32_t i = 0; i < rows->field_count; i++)
			snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i > 0 ? "," : "", rows->fields[i]);
		assert_true(line < line_count);
		assert_string_equal(text, lines[line++]);
		assert_int_equal(rows->row, line);
	}
	assert_int_equal(line, line_count);
	rows->close(rows);
}

static void a_row_for_each_instance(void **state)
{
	static const float places[3][3] = { { 1, 2, 3 }, { 4, 0, -6 }, { 0, 0, 0 } }, sizes[3][3] = { { 1, 1, 1 }, { 2, 2, 2 }, { 1, 8, 1 } };
	static const float turns[3][4] = { { 0, 0, 0, 1 }, { 0, 0.70710678f, 0, 0.70710678f }, { 0, -0.38268343f, 0, 0.92387953f } };
	static const uint16_t species[3] = { 7, 9, 7 };

	(void)state;
	gw_begin();
	gw_floats(places[0], 3, "VEC3", 3);
	gw_floats(turns[0], 3, "VEC4", 4);
	gw_floats(sizes[0], 3, "VEC3", 3);
	gw_accessor(gw_view(species, sizeof species, ""), GLTF_USHORT, 3, "SCALAR", "");
	gw_floats(places[0], 1, "VEC3", 3);
	expect_rows(",\"nodes\":[{\"name\":\"oaks\",\"mesh\":0,\"translation\":[100,0,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0,"
		"\"ROTATION\":1,\"SCALE\":2,\"_SPECIES\":3}}}},{\"mesh\":0},{\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":4}}}}],"
		"\"meshes\":[{\"name\":\"oak\"}]", "x,y,z,name,mesh,yaw_deg,scale,height_m,_SPECIES",
		(const char *const[]){ "101,-3,2,oaks,oak,0.0000,1,,7", "104,6,0,oaks,oak,90.0000,2,,9", "100,0,0,oaks,oak,315.0000,2,,7",
			"1,-3,2,,,0.0000,1,," }, 4);
}

static void a_row_for_each_node_with_a_mesh(void **state)
{
	(void)state;
	gw_begin();
	expect_rows(",\"nodes\":[{\"children\":[1,2],\"scale\":[2,2,2],\"name\":\"group\"},{\"mesh\":0,\"translation\":[1,0,-1],\"extras\":{\"dbh_cm\":31.5,\"alive\":true}},"
		"{\"mesh\":0,\"name\":\"Ash.001\",\"extras\":{\"species\":\"ash\",\"list\":[1],\"dbh_cm\":12}},{\"name\":\"lamp\"}],\"meshes\":[{\"name\":\"ash\"}]",
		"x,y,z,name,mesh,yaw_deg,scale,height_m,dbh_cm,alive,species",
		(const char *const[]){ "2,2,0,ash,ash,0.0000,2,,31.5,true,", "0,0,0,Ash.001,ash,0.0000,2,,12,,ash" }, 2);
}

/* Of floats, and of 16-bit fractions from -1 to 1 about the middle of the same mesh, which is 4 wide and 10 high. */
static void heights_are_those_of_meshes_however_packed(void **state)
{
	static const float f[2][3] = { { 0, 0, 0 }, { 4, 10, 4 } };
	static const int16_t q[2][4] = { { -32767, -32767, -32767 }, { 32767, 32767, 32767 } };

	(void)state;
	gw_begin();
	gw_accessor(gw_view(f, sizeof f, ""), GLTF_FLOAT, 2, "VEC3", ",\"min\":[0,0,0],\"max\":[4,10,4]");
	gw_accessor(gw_view(q, sizeof q, ",\"byteStride\":8"), GLTF_SHORT, 2, "VEC3", ",\"normalized\":true,\"min\":[-32767,-32767,-32767],\"max\":"
		"[32767,32767,32767]");
	expect_rows(",\"nodes\":[{\"mesh\":0,\"translation\":[1,2,3],\"scale\":[2,2,2]},{\"mesh\":1,\"translation\":[2,5,2],\"scale\":[2,5,2]}],\"meshes\":["
		"{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]",
		"x,y,z,name,mesh,yaw_deg,scale,height_m", (const char *const[]){ "1,-3,2,,,0.0000,2,20", "2,-2,0,,,0.0000,,10" }, 2);
}

static void a_scene_without_plants_is_no_inventory(void **state)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;

	(void)state;
	assert_int_equal(eco_rows_open_gltf(&rows, input_text("gltf", "none.gltf", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}]}"), &error), ECO_BAD_INPUT);
	assert_null(rows);
	assert_non_null(strstr(error.text, "none.gltf: no node"));
	assert_int_equal(eco_rows_open_gltf(&rows, "build/tmp/gltf/nowhere.glb", NULL), ECO_NOT_FOUND);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(json_may_be_padded_with_zeros_or_begin_with_a_mark),
		cmocka_unit_test(a_document_that_is_cut_off_is_refused),
		cmocka_unit_test(what_is_no_gltf_2_is_named),
		cmocka_unit_test(buffers_are_found_beside_or_within),
		cmocka_unit_test(a_buffer_that_is_missing_is_told_when_it_is_needed),
		cmocka_unit_test(numbers_of_every_type_are_read),
		cmocka_unit_test(strides_offsets_and_columns_are_kept),
		cmocka_unit_test(sparse_accessors_are_filled_in),
		cmocka_unit_test(accessors_beyond_their_bytes_are_refused),
		cmocka_unit_test(views_compressed_with_meshopt_are_unpacked),
		cmocka_unit_test(filters_of_meshopt_are_undone),
		cmocka_unit_test(the_second_version_of_the_meshopt_codec_is_read),
		cmocka_unit_test(meshopt_that_makes_no_sense_is_refused),
		cmocka_unit_test(nodes_stand_where_their_ancestors_put_them),
		cmocka_unit_test(what_a_viewer_would_show_is_walked),
		cmocka_unit_test(a_tree_that_is_none_ends),
		cmocka_unit_test(indices_of_every_type_or_none_make_triangles),
		cmocka_unit_test(strips_and_fans_become_triangles),
		cmocka_unit_test(points_and_lines_are_counted_and_said),
		cmocka_unit_test(a_broken_index_is_kept_apart),
		cmocka_unit_test(quantized_meshes_are_read),
		cmocka_unit_test(places_far_from_the_origin_keep_their_detail),
		cmocka_unit_test(parts_are_nodes_and_meshes),
		cmocka_unit_test(instances_of_a_model_are_expanded),
		cmocka_unit_test(instances_without_end_are_refused_at_once),
		cmocka_unit_test(skins_stand_where_their_joints_hold_them),
		cmocka_unit_test(morph_targets_have_their_default_weights),
		cmocka_unit_test(vertex_colours_count_in_linear_light),
		cmocka_unit_test(the_older_materials_and_those_without_any_have_colours),
		cmocka_unit_test(pictures_come_from_anywhere_or_are_missed_aloud),
		cmocka_unit_test(draco_meshes_of_any_size_are_read),
		cmocka_unit_test(draco_attributes_are_found_by_their_ids),
		cmocka_unit_test(what_a_file_requires_and_is_not_read_is_named),
		cmocka_unit_test(references_to_nothing_are_refused),
		cmocka_unit_test(a_glb_is_known_by_its_content),
		cmocka_unit_test(a_row_for_each_instance),
		cmocka_unit_test(a_row_for_each_node_with_a_mesh),
		cmocka_unit_test(heights_are_those_of_meshes_however_packed),
		cmocka_unit_test(a_scene_without_plants_is_no_inventory),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
