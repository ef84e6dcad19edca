/* Models: what a file holds arrives or is counted, colours and textures mean what the file meant, and what cannot be read is refused
 * by name. Long, as each oddity of a format is written out as the small file that shows it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <signal.h>

#include "ecofiles/guard.h"
#include "ecofiles/image.h"
#include "ecofiles/import_model.h"
#include "ecofiles/model.h"
#include "ecofiles/model_clean.h"
#include "ecofiles/polygon.h"
#include "tests/input_files.h"

static char warnings[2000];

static void note(void *ctx, const char *text)
{
	(void)ctx;
	strncat(warnings, text, sizeof warnings - strlen(warnings) - 2);
	strcat(warnings, "\n");
}

static struct eco_model_options asked = { .warn = note };

static void import_good(struct eco_model *model, const char *path, double height_m)
{
	struct eco_error error = { .code = ECO_OK };
	uint64_t accounted;

	warnings[0] = 0;
	asked.paths = (const char *[]){ path };
	asked.path_count = 1;
	asked.height_m = height_m;
	if (eco_model_import(model, &asked, &error) != ECO_OK)
		fail_msg("%s", error.text);
	accounted = model->triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += model->dropped[i];
	assert_int_equal(accounted, model->triangles_in);
	for (uint32_t i = 0; i < model->triangle_count * 3; i++)
		assert_true(model->index[i] < model->vertex_count);
}

static void import_fails(const char *path, enum eco_code wanted, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_model model;
	enum eco_code code = eco_model_import(&model, &(struct eco_model_options){ .paths = (const char *[]){ path }, .path_count = 1 }, &error);

	assert_null(model.position);
	if (code != wanted || strstr(error.text, says) == NULL)
		fail_msg("%s: %s\n  wanted %s ... %s", eco_code_name(code), error.text, eco_code_name(wanted), says);
}

/* Whether a vertex at that place, with that uv where uv is asked for, is there. */
static bool has_vertex(const struct eco_model *m, float x, float y, float z, const float *uv)
{
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		const float *p = &m->position[i * 3];

		if (fabsf(p[0] - x) + fabsf(p[1] - y) + fabsf(p[2] - z) < 1e-5f
			&& (uv == NULL || (m->uv != NULL && fabsf(m->uv[i * 2] - uv[0]) + fabsf(m->uv[i * 2 + 1] - uv[1]) < 1e-5f)))
			return true;
	}
	return false;
}

static const struct eco_material *material_named(const struct eco_model *m, const char *name)
{
	for (uint32_t i = 0; i < m->material_count; i++)
		if (strcmp(m->materials[i].name, name) == 0)
			return &m->materials[i];
	fail_msg("no material %s", name);
	return NULL;
}

/* ---- OBJ ---- */

static void y_up_becomes_z_up_on_its_foot_at_its_height(void **state)
{
	/* a square tube from (10, 5, -20), 1 wide and 8 high along Y */
	const char *obj = "v 9.5 5 -20.5\nv 10.5 5 -20.5\nv 10.5 5 -19.5\nv 9.5 5 -19.5\nv 9.5 13 -20.5\nv 10.5 13 -20.5\nv 10.5 13 -19.5\n"
		"v 9.5 13 -19.5\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
	struct eco_model m;

	(void)state;
	import_good(&m, input_text("model", "tube.obj", obj), 0);
	assert_int_equal(m.triangles_in, 8);
	assert_int_equal(m.triangle_count, 8);
	assert_true(has_vertex(&m, -0.5f, 0.5f, 0, NULL) && has_vertex(&m, 0.5f, -0.5f, 8, NULL));
	assert_true(m.foot[0] == 10 && m.foot[1] == 20 && m.foot[2] == 5 && m.scale == 1);
	assert_true(eco_model_height(&m) == 8);
	assert_null(m.uv);
	eco_model_free(&m);
	import_good(&m, "build/tmp/model/tube.obj", 2);
	assert_true(fabs(eco_model_height(&m) - 2) < 1e-6 && m.scale == 0.25);
	assert_true(has_vertex(&m, -0.125f, 0.125f, 2, NULL));
	eco_model_free(&m);
}

static void polygons_count_as_corners_minus_two(void **state)
{
	/* an L of six corners, concave, and a quad: areas 3 and 1 */
	const char *obj = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\n"
		"f 1 2 3 4 5 6\nf 7 8 9 10\np 1\nl 1 2\n";
	struct eco_model m;
	double area = 0;

	(void)state;
	import_good(&m, input_text("model", "l.obj", obj), 0);
	assert_int_equal(m.triangles_in, 6);
	assert_int_equal(m.triangle_count, 6);
	for (uint32_t i = 0; i < m.triangle_count; i++) {
		const float *a = &m.position[m.index[i * 3] * 3], *b = &m.position[m.index[i * 3 + 1] * 3], *c = &m.position[m.index[i * 3 + 2] * 3];

		area += fabs(((double)b[0] - a[0]) * ((double)c[2] - a[2]) - ((double)b[2] - a[2]) * ((double)c[0] - a[0])) / 2;
	}
	if (fabs(area - 4) >= 1e-6)
		fail_msg("the area is %g", area);
	eco_model_free(&m);
}

/* Star-shaped polygons in tilted planes, concave as can be, some with corners in a line or repeated: the triangles' areas, none of them
 * negative, add up to the polygon's. */
static void any_simple_polygon_is_covered_exactly_once(void **state)
{
	uint32_t seed = 1;

	(void)state;
	for (uint32_t round = 0; round < 2000; round++) {
		uint32_t n = 3 + round % 30, scratch[32], triangles[96];
		double corners[96], polygon = 0, sum = 0;

		for (uint32_t i = 0; i < n; i++) {
			double angle = 6.283185307 * i / n, radius;

			seed = seed * 1664525u + 1013904223u;
			radius = 1 + (double)(seed >> 28);           /* whole numbers: corners in a line occur */
			if (round % 7 == 0 && i > 0 && i % 5 == 0) {
				memcpy(&corners[i * 3], &corners[i * 3 - 3], 3 * sizeof *corners);
				continue;
			}
			corners[i * 3] = radius * cos(angle);
			corners[i * 3 + 1] = radius * sin(angle) * (round % 2 ? 1 : -1);
			corners[i * 3 + 2] = round % 3 * corners[i * 3] - 2 * corners[i * 3 + 1];
		}
		for (uint32_t i = 0; i < n; i++) {
			const double *a = &corners[i * 3], *b = &corners[(i + 1) % n * 3];

			polygon += a[0] * b[1] - a[1] * b[0];
		}
		eco_polygon_split(corners, n, scratch, triangles);
		for (uint32_t i = 0; i < n - 2; i++) {
			const double *a = &corners[triangles[i * 3] * 3], *b = &corners[triangles[i * 3 + 1] * 3], *c = &corners[triangles[i * 3 + 2] * 3];
			double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

			assert_true(area * (polygon < 0 ? -1 : 1) >= -1e-9);
			sum += area;
		}
		assert_true(fabs(sum - polygon) < 1e-6);
	}
}

static void what_covers_nothing_is_dropped_and_counted(void **state)
{
	const char *obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\nv 1 0 0\n"
		"f 1 2 3\nf 3 1 2\nf 3 6 1\n"            /* the same thrice: turned, and with a twin of a vertex */
		"f 1 2 4\nf 1 2 2\nf 2 6 3\n"            /* in a line, twice one corner, twice one place */
		"f 1 2 5\n";
	struct eco_model m;

	(void)state;
	import_good(&m, input_text("model", "drop.obj", obj), 0);
	assert_int_equal(m.triangles_in, 7);
	assert_int_equal(m.triangle_count, 1);
	assert_int_equal(m.dropped[ECO_DROP_DUPLICATE], 2);
	assert_int_equal(m.dropped[ECO_DROP_DEGENERATE], 3);
	assert_int_equal(m.dropped[ECO_DROP_NOT_FINITE], 1);
	assert_int_equal(m.vertex_count, 3);
	eco_model_free(&m);
}

static void bad_indices_are_dropped_by_the_last_step_too(void **state)
{
	struct eco_model m = { .vertex_count = 3, .triangle_count = 3, .triangles_in = 3, .material_count = 1 };
	struct eco_model_frame frame = { .unit_m = 1 };
	struct eco_notes notes = { .used = 0 };
	static const float position[] = { 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	static const uint32_t index[] = { 0, 1, 7, 0, 1, 2, ECO_NONE, 1, 2 };

	(void)state;
	m.position = malloc(sizeof position);
	m.index = malloc(sizeof index);
	m.material = calloc(3, sizeof *m.material);
	m.materials = calloc(1, sizeof *m.materials);
	m.materials[0].image = ECO_NONE;
	memcpy(m.position, position, sizeof position);
	memcpy(m.index, index, sizeof index);
	assert_int_equal(eco_model_clean(&m, &frame, &(struct eco_model_options){ .height_m = 0 }, "memory", &notes, NULL), ECO_OK);
	assert_int_equal(m.triangle_count, 1);
	assert_int_equal(m.dropped[ECO_DROP_BAD_INDEX], 2);
	eco_model_free(&m);
}

static void the_foot_is_the_trunks_not_a_hanging_branchs(void **state)
{
	char obj[8000];
	size_t used = 0;
	struct eco_model m;

	(void)state;
	/* a thick tube at x = 0 from 1 to 9, a thin one at x = 6 from 0 to 9, and leaves */
	for (int tube = 0; tube < 2; tube++)
		for (int i = 0; i < 16; i++)
			used += (size_t)snprintf(obj + used, sizeof obj - used, "v %g %g %g\n", tube * 6 + (tube ? 0.05 : 0.5) * cos(i % 8 * 0.785398),
				i < 8 ? 1.0 - tube : 9.0, (tube ? 0.05 : 0.5) * sin(i % 8 * 0.785398));
	for (int i = 0; i < 32; i++)
		if (i % 16 < 8)
			used += (size_t)snprintf(obj + used, sizeof obj - used, "f %d %d %d %d\n", i + 1, i / 16 * 16 + (i + 1) % 8 + 1,
				i / 16 * 16 + (i + 1) % 8 + 9, i + 9);
	asked.up = ECO_UP_Y;         /* of two tubes no shape tells it */
	import_good(&m, input_text("model", "willow.obj", obj), 0);
	asked.up = ECO_UP_FOUND;
	assert_true(fabs(m.foot[0]) < 1e-5 && fabs(m.foot[1]) < 1e-5 && m.foot[2] == 1);
	assert_true(fabs(eco_model_height(&m) - 8) < 1e-5 && has_vertex(&m, 0.5f, 0, 0, NULL) && has_vertex(&m, 6.05f, 0, -1, NULL));
	eco_model_free(&m);
}

#define TRIANGLE_UV "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"

static void write_png(const char *name, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	struct eco_error error = { .code = ECO_OK };

	if (eco_png_write(&(struct eco_pixels){ width, height, 4, rgba }, input_path("model", name), &error) != ECO_OK)
		fail_msg("%s", error.text);
}

static void textures_lie_the_right_way_up_and_replace_the_colour(void **state)
{
	static const uint8_t rgba[] = { 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0 };
	struct eco_model m;

	(void)state;
	write_png("leaf one.png", rgba, 2, 2);
	input_text("model", "t.mtl", "newmtl m\nKd 0.64 0.64 0.64\nmap_Kd leaf one.png\n");
	import_good(&m, input_text("model", "t.obj", "mtllib t.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.material_count, 1);
	assert_int_equal(m.image_count, 1);
	assert_int_equal(m.materials[0].image, 0);
	assert_true(m.materials[0].cutout);
	assert_int_equal(m.materials[0].rgb[1], 255);
	assert_memory_equal(m.images[0].rgba, rgba, sizeof rgba);
	/* OBJ's v points up: its (0, 0) is the bottom left, which is (0, 1) here; the foot is between the two lowest vertices */
	assert_true(has_vertex(&m, -0.5f, 0, 0, (const float[]){ 0, 1 }));
	assert_true(has_vertex(&m, -0.5f, 0, 1, (const float[]){ 0, 0 }));
	assert_true(has_vertex(&m, 0.5f, 0, 0, (const float[]){ 1, 1 }));
	eco_model_free(&m);
}

static void an_opacity_map_cuts_out(void **state)
{
	static const uint8_t solid[] = { 9, 9, 9, 255, 9, 9, 9, 255 }, mask[] = { 255, 255, 255, 255, 0, 0, 0, 255 };
	struct eco_model m;

	(void)state;
	write_png("solid.png", solid, 2, 1);
	write_png("mask.png", mask, 2, 1);
	input_text("model", "o.mtl", "newmtl m\nmap_Kd solid.png\nmap_d mask.png\n");
	import_good(&m, input_text("model", "o.obj", "mtllib o.mtl\n" TRIANGLE_UV), 0);
	assert_true(m.materials[0].cutout && m.images[0].rgba[3] == 255 && m.images[0].rgba[7] == 0);
	eco_model_free(&m);
	input_text("model", "o.mtl", "newmtl m\nmap_Kd solid.png\n");
	import_good(&m, "build/tmp/model/o.obj", 0);
	assert_false(m.materials[0].cutout);
	eco_model_free(&m);
}

static void a_missing_or_broken_texture_is_told_not_fatal(void **state)
{
	struct eco_model m;

	(void)state;
	input_text("model", "g.mtl", "newmtl m\nKd 1 0 0.5\nmap_Kd C:\\trees\\gone.png\n");
	import_good(&m, input_text("model", "g.obj", "mtllib g.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.image_count, 0);
	assert_int_equal(m.materials[0].image, ECO_NONE);
	assert_true(m.materials[0].rgb[0] == 255 && m.materials[0].rgb[1] == 0 && m.materials[0].rgb[2] == 128);
	assert_non_null(strstr(warnings, "gone.png: no such file beside the model"));
	assert_null(m.uv);
	eco_model_free(&m);
	input_text("model", "gone.png", "this is no picture");
	import_good(&m, "build/tmp/model/g.obj", 0);         /* found by its last part, but broken */
	assert_int_equal(m.image_count, 0);
	assert_non_null(strstr(warnings, "gone.png"));
	eco_model_free(&m);
	unlink("build/tmp/model/gone.png");
}

static void colours_are_the_screens_unless_blender_wrote_them(void **state)
{
	struct eco_model m;

	(void)state;
	input_text("model", "c.mtl", "newmtl m\nKd 0.2 0.2 0.2\n");
	import_good(&m, input_text("model", "c.obj", "mtllib c.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.materials[0].rgb[0], 51);
	eco_model_free(&m);
	import_good(&m, input_text("model", "c.obj", "# Blender 3.4.1\nmtllib c.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.materials[0].rgb[0], 124);        /* 0.2 linear */
	eco_model_free(&m);
}

static void invisible_materials_are_left_out_and_counted(void **state)
{
	struct eco_model m;

	(void)state;
	input_text("model", "d.mtl", "newmtl m\nd 0.3\nnewmtl n\nd 0.6\n");
	import_good(&m, input_text("model", "d.obj", "mtllib d.mtl\n" TRIANGLE_UV "v 5 0 0\nusemtl n\nf 1 2 3\nf 1 3 4\n"), 0);
	assert_int_equal(m.triangles_in, 3);
	assert_int_equal(m.dropped[ECO_DROP_TRANSPARENT], 1);
	assert_int_equal(m.triangle_count, 2);
	assert_int_equal(m.material_count, 1);
	assert_non_null(strstr(warnings, "1 triangles have materials with alpha below 0.5"));
	eco_model_free(&m);
}

/* ---- glTF ---- */

/* Positions (0,0,0) (1,0,0) (0,1,0), uv (0,0) (1,0) (0,1), indices 0 1 2, as base64: 36 + 24 + 6 bytes. */
#define BUFFER "{\"byteLength\":66,\"uri\":\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" \
	"AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAABAAIA\"}"
#define VIEWS "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":24},{\"buffer\":0,\"byteOffset\":60," \
	"\"byteLength\":6}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}," \
	"{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"},{\"bufferView\":2,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}]"
#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2,\"material\":0}]}]"

static const char *gltf(const char *name, const char *nodes, const char *rest)
{
	static char text[6000];

	snprintf(text, sizeof text, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"buffers\":[" BUFFER "]," VIEWS ","
		MESH ",\"nodes\":[%s]%s}", nodes, rest);
	return input_text("model", name, text);
}

static void nodes_place_their_meshes(void **state)
{
	struct eco_model m;

	(void)state;
	/* the mesh twice: moved by a parent, and turned by 90 degrees about Y below it, which takes +X to -Z and so to +Y here */
	import_good(&m, gltf("nodes.gltf", "{\"children\":[1],\"mesh\":0,\"translation\":[0,2,0]},{\"mesh\":0,\"translation\":[4,0,0],"
		"\"rotation\":[0,0.70710678,0,0.70710678]}", ",\"materials\":[{}]"), 0);
	assert_int_equal(m.triangles_in, 2);
	assert_int_equal(m.triangle_count, 2);
	assert_true(m.foot[2] == 2);
	assert_true(has_vertex(&m, (float)(1 - m.foot[0]), (float)-m.foot[1], 0, NULL));
	assert_true(has_vertex(&m, (float)(4 - m.foot[0]), (float)(1 - m.foot[1]), 0, NULL));
	eco_model_free(&m);
}

static void alpha_modes_and_linear_colours_mean_what_gltf_says(void **state)
{
	static const uint8_t rgba[] = { 255, 0, 0, 100, 0, 255, 0, 200 };
	static const struct { const char *mode; bool cutout; uint8_t alpha[2]; } modes[] = {
		{ "\"alphaMode\":\"OPAQUE\",", false, { 255, 255 } }, { "", false, { 255, 255 } }, { "\"alphaMode\":\"BLEND\",", true, { 100, 200 } },
		{ "\"alphaMode\":\"MASK\",", true, { 100, 200 } }, { "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,", false, { 255, 255 } },
		{ "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.9,", true, { 56, 111 } },
		/* equal to the cutoff is opaque: 200/255, 100/255, and whatever there is */
		{ "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.78431373,", true, { 64, 128 } },
		{ "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.39215687,", false, { 255, 255 } },
		{ "\"alphaMode\":\"MASK\",\"alphaCutoff\":0,", false, { 255, 255 } },
	};

	(void)state;
	write_png("a b.png", rgba, 2, 1);
	for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
		struct eco_model m;
		char rest[500];

		snprintf(rest, sizeof rest, ",\"materials\":[{%s\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,1,0,1],\"baseColorTexture\":{\"index\":0}}}],"
			"\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a%%20b.png\"}]", modes[i].mode);
		import_good(&m, gltf("alpha.gltf", "{\"mesh\":0}", rest), 0);
		assert_int_equal(m.image_count, 1);
		assert_int_equal(m.materials[0].cutout, modes[i].cutout);
		assert_int_equal(m.images[0].rgba[3], modes[i].alpha[0]);
		assert_int_equal(m.images[0].rgba[7], modes[i].alpha[1]);
		assert_memory_equal(m.materials[0].rgb, "\377\377\377", 3);
		assert_true(m.images[0].rgba[0] == 188 && m.images[0].rgba[1] == 0 && m.images[0].rgba[5] == 255);
		assert_true(has_vertex(&m, -0.5f, 0, 0, (const float[]){ 0, 0 }));       /* glTF's v points down */
		eco_model_free(&m);
	}
}

/* Three triangles beside each other, one for each of the materials (JSON); their texture 0 is `rgba`, one row. */
static void import_textured(struct eco_model *m, const char *materials, const uint8_t *rgba, uint32_t width)
{
	char meshes[2000] = "", nodes[2000] = "", text[8000];
	size_t mesh = 0, node = 0;

	write_png("row.png", rgba, width, 1);
	for (uint32_t i = 0; i < 3; i++) {
		mesh += (size_t)snprintf(meshes + mesh, sizeof meshes - mesh, "%s{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},"
			"\"indices\":2,\"material\":%u}]}", i > 0 ? "," : "", i);
		node += (size_t)snprintf(nodes + node, sizeof nodes - node, ",{\"mesh\":%u,\"translation\":[%u,0,0]}", i, 2 * i);
	}
	snprintf(text, sizeof text, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2,3]}],\"buffers\":[" BUFFER "]," VIEWS
		",\"meshes\":[%s],\"nodes\":[{}%s],\"materials\":[%s],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"row.png\"}]}", meshes, nodes,
		materials);
	import_good(m, input_text("model", "row.gltf", text), 0);
}

static void assert_texel(const struct eco_model *m, const char *material, uint32_t x, const uint8_t wanted[4])
{
	const struct eco_material *of = material_named(m, material);
	const uint8_t *texel;

	assert_true(of->image < m->image_count);
	assert_memory_equal(of->rgb, "\377\377\377", 3);
	texel = &m->images[of->image].rgba[x * 4];
	if (memcmp(texel, wanted, 4) != 0)
		fail_msg("%s, texel %u: %u %u %u %u", material, x, texel[0], texel[1], texel[2], texel[3]);
}

static void a_texture_takes_each_colour_it_is_used_with(void **state)
{
	static const uint8_t rgba[] = { 255, 128, 0, 255, 188, 188, 255, 255 };
	struct eco_model m;

	(void)state;
	import_textured(&m, "{\"name\":\"half\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.5,0.5,1],\"baseColorTexture\":{\"index\":0}}},"
		"{\"name\":\"plain\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
		"{\"name\":\"also\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.5,0.5,1],\"baseColorTexture\":{\"index\":0}}}", rgba, 2);
	assert_int_equal(m.triangle_count, 3);
	assert_int_equal(m.image_count, 2);
	assert_int_equal(material_named(&m, "half")->image, material_named(&m, "also")->image);
	assert_texel(&m, "plain", 0, rgba);
	assert_texel(&m, "plain", 1, rgba + 4);
	/* half the light: (128/255)^2.2 is 0.216, its half 0.108 */
	assert_texel(&m, "half", 0, (const uint8_t[]){ 188, 93, 0, 255 });
	assert_texel(&m, "half", 1, (const uint8_t[]){ 138, 138, 188, 255 });
	eco_model_free(&m);
}

static void a_texture_cut_out_here_is_opaque_there(void **state)
{
	static const uint8_t rgba[] = { 9, 9, 9, 255, 8, 8, 8, 180, 7, 7, 7, 0 };
	struct eco_model m;

	(void)state;
	import_textured(&m, "{\"name\":\"leaf\",\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
		"{\"name\":\"bark\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
		"{\"name\":\"veil\",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.6],\"baseColorTexture\":"
		"{\"index\":0}}}", rgba, 3);
	assert_int_equal(m.image_count, 3);
	assert_true(material_named(&m, "leaf")->cutout && material_named(&m, "veil")->cutout && !material_named(&m, "bark")->cutout);
	for (uint32_t x = 0; x < 3; x++) {
		uint8_t level = (uint8_t)(9 - x);

		assert_texel(&m, "leaf", x, (const uint8_t[]){ level, level, level, rgba[x * 4 + 3] });
		assert_texel(&m, "bark", x, (const uint8_t[]){ level, level, level, 255 });
		assert_texel(&m, "veil", x, (const uint8_t[]){ level, level, level, (uint8_t)(rgba[x * 4 + 3] * 0.6 + 0.5) });
	}
	eco_model_free(&m);
}

static void alpha_that_cuts_nothing_out_makes_no_other_image(void **state)
{
	static const uint8_t rgba[] = { 9, 9, 9, 255, 8, 8, 8, 240 };
	struct eco_model m;

	(void)state;
	import_textured(&m, "{\"name\":\"leaf\",\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
		"{\"name\":\"bark\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}},"
		"{\"name\":\"veil\",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.4],\"baseColorTexture\":"
		"{\"index\":0}}}", rgba, 2);
	assert_int_equal(m.image_count, 1);
	assert_false(material_named(&m, "leaf")->cutout);
	assert_texel(&m, "leaf", 1, (const uint8_t[]){ 8, 8, 8, 255 });
	assert_int_equal(material_named(&m, "bark")->image, 0);
	assert_int_equal(m.dropped[ECO_DROP_TRANSPARENT], 1);        /* 0.4 of 1 is below 0.5 everywhere */
	eco_model_free(&m);
}

/* A model in memory of `count` triangles, each with its own colour of the one image, which has one white texel. */
static void make_motley(struct eco_model *m, uint32_t count)
{
	*m = (struct eco_model){ .material_count = count, .image_count = 1 };
	m->materials = calloc(count, sizeof *m->materials);
	m->images = calloc(1, sizeof *m->images);
	m->images[0] = (struct eco_image){ .width = 1, .height = 1, .rgba = malloc(4) };
	memset(m->images[0].rgba, 255, 4);
	for (uint32_t i = 0; i < count; i++) {
		m->materials[i].image = 0;
		memset(m->materials[i].rgb, (int)(255 - i), 3);
	}
}

static void beyond_what_is_kept_the_nearest_colour_stands_in(void **state)
{
	struct eco_notes notes = { .used = 0 };
	struct eco_model m;

	(void)state;
	make_motley(&m, 200);
	assert_int_equal(eco_model_bake_tints(&m, "memory", &notes, NULL), ECO_OK);
	assert_int_equal(m.image_count, 32);
	for (uint32_t i = 0; i < 200; i++) {
		const uint8_t *texel = m.images[m.materials[i].image].rgba;

		assert_true(texel[0] == (i < 32 ? 255 - i : 224) && texel[2] == texel[0] && texel[3] == 255 && m.materials[i].rgb[1] == 255);
	}
	assert_non_null(strstr(notes.text, "168 materials are drawn in the nearest"));
	eco_model_free(&m);
}

static void vertex_colours_of_a_textured_mesh_become_their_mean(void **state)
{
	static const uint8_t white[] = { 255, 255, 255, 255 };
	struct eco_model m;

	(void)state;
	write_png("white.png", white, 1, 1);
	input_text("model", "vt.mtl", "newmtl m\nmap_Kd white.png\n");
	import_good(&m, input_text("model", "vt.obj", "mtllib vt.mtl\nv 0 0 0 1 1 0\nv 1 0 0 0.4 1 0\nv 0 1 0 0.4 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
		"usemtl m\nf 1/1 2/2 3/3\n"), 0);
	assert_int_equal(m.image_count, 1);
	assert_int_equal(m.material_count, 1);
	assert_texel(&m, "m", 0, (const uint8_t[]){ 153, 255, 0, 255 });
	assert_non_null(strstr(warnings, "1 textured meshes have vertex colours that differ"));
	eco_model_free(&m);
}

static void a_webp_texture_that_gltf_requires_is_read(void **state)
{
	/* 4 x 1 pixels, the first (200,0,0) at alpha 128 */
	const char *rest = ",\"extensionsUsed\":[\"EXT_texture_webp\"],\"extensionsRequired\":[\"EXT_texture_webp\"],\"materials\":[{\"name\":\"g\","
		"\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],\"textures\":[{\"extensions\":"
		"{\"EXT_texture_webp\":{\"source\":0}}}],\"images\":[{\"mimeType\":\"image/webp\",\"uri\":\"data:image/webp;base64,"
		"UklGRjIAAABXRUJQVlA4TCUAAAAvAwAAEB8gECD43/FnQyyYzP+MKqxBEQgQ1p05E8DsrKHGEf0PAA==\"}]";
	struct eco_model m;

	(void)state;
	import_good(&m, gltf("webp.gltf", "{\"mesh\":0}", rest), 0);
	assert_int_equal(m.image_count, 1);
	assert_int_equal(m.images[0].width, 4);
	assert_true(material_named(&m, "g")->cutout);
	assert_in_range(m.images[0].rgba[0], 198, 202);
	eco_model_free(&m);
}

static void draco_meshes_are_read(void **state)
{
	/* a unit square of two triangles, indices declared as 32-bit */
	static const char head[] = "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],\"extensionsRequired\":"
		"[\"KHR_draco_mesh_compression\"],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"materials\":[{}],\"buffers\":"
		"[{\"byteLength\":120,\"uri\":\"data:application/octet-stream;base64,RFJBQ08CAgEBAAAABAIBAgAAAR//ARH/AREC/wAAAAAAAQAJAwAAAgEDCQIAAQABAQEA"
		"AwMBMAEQAwAkgkoEAAAAAP8/AAAAAAAAAAAAAAAAAAAAAIA/DgAAAAAAAIA/AACAPwAAAAAAAIA/AACAPwAAAAAAAAAA\"}],\"bufferViews\":[{\"buffer\":0,"
		"\"byteLength\":120}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2,\"material\":0,"
		"\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1}}}}]}],\"accessors\":"
		"[{\"componentType\":5126,\"count\":";
	static const char tail[] = ",\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]},{\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
		"{\"componentType\":5125,\"count\":6,\"type\":\"SCALAR\"}]}";
	char text[3000];
	struct eco_model m;

	(void)state;
	snprintf(text, sizeof text, "%s4%s", head, tail);
	import_good(&m, input_text("model", "draco.gltf", text), 0);
	assert_int_equal(m.triangle_count, 2);
	assert_true(has_vertex(&m, 0.5f, 0, 1, NULL) && has_vertex(&m, -0.5f, 0, 0, NULL));
	eco_model_free(&m);
}

static void vertex_colours_become_materials(void **state)
{
	struct eco_model m;

	(void)state;
	import_good(&m, input_text("model", "vc.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 0 1 0 0 1\nv 1 0 1 0 0 1\nv 0 1 1 0 0 1\n"
		"v 0 0 2 1 1 1\nv 1 0 2 1 1 1\nv 0 1 2 1 1 1\nf 1 2 3\nf 4 5 6\nf 7 8 9\n"), 0);
	assert_int_equal(m.material_count, 3);       /* red, blue, and white, which changes nothing */
	for (uint32_t i = 0; i < 3; i++) {
		const uint8_t *rgb = m.materials[m.material[i]].rgb;

		assert_true(rgb[0] == (i != 1 ? 255 : 0) && rgb[1] == (i == 2 ? 255 : 0) && rgb[2] == (i != 0 ? 255 : 0));
	}
	eco_model_free(&m);
}

static void texture_transforms_turn_about_the_images_corner(void **state)
{
	static const uint8_t rgba[] = { 9, 9, 9, 255 };
	static const struct { const char *transform; float uv[3][2]; } cases[] = {
		{ "\"offset\":[0.25,0.125],\"scale\":[0.5,2]", { { 0.25f, 0.125f }, { 0.75f, 0.125f }, { 0.25f, 2.125f } } },
		/* the lower left quadrant, a quarter turn: the example of the extension's specification */
		{ "\"offset\":[0,1],\"rotation\":1.57079632679,\"scale\":[0.5,0.5]", { { 0, 1 }, { 0, 0.5f }, { 0.5f, 1 } } },
	};

	(void)state;
	write_png("one.png", rgba, 1, 1);
	for (size_t i = 0; i < 2; i++) {
		struct eco_model m;
		char rest[700];

		snprintf(rest, sizeof rest, ",\"extensionsUsed\":[\"KHR_texture_transform\"],\"extensionsRequired\":[\"KHR_texture_transform\"],"
			"\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{%s}}}}}],"
			"\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"one.png\"}]", cases[i].transform);
		import_good(&m, gltf("turn.gltf", "{\"mesh\":0}", rest), 0);
		assert_true(has_vertex(&m, -0.5f, 0, 0, cases[i].uv[0]) && has_vertex(&m, 0.5f, 0, 0, cases[i].uv[1])
			&& has_vertex(&m, -0.5f, 0, 1, cases[i].uv[2]));
		eco_model_free(&m);
	}
}

static void what_gltf_requires_and_is_not_read_is_refused_by_name(void **state)
{
	static const struct { const char *list, *name; } cases[] = {
		{ "extensionsRequired", "KHR_texture_basisu" }, { "extensionsRequired", "VENDOR_secret" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char rest[200];

		snprintf(rest, sizeof rest, ",\"%s\":[\"%s\"]", cases[i].list, cases[i].name);
		import_fails(gltf("ext.gltf", "{\"mesh\":0}", rest), ECO_UNSUPPORTED, cases[i].name);
	}
}

/* ---- Hostile input ---- */

static void files_that_are_no_models_are_refused(void **state)
{
	(void)state;
	import_fails("build/tmp/model/none.obj", ECO_NOT_FOUND, "No such file");
	import_fails(input_text("model", "empty.obj", ""), ECO_BAD_INPUT, "empty.obj");
	import_fails(input_text("model", "points.obj", "v 0 0 0\nv 1 1 1\n"), ECO_BAD_INPUT, "points.obj");
	import_fails(input_text("model", "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), ECO_BAD_INPUT, "none of its 1 triangles");
	import_fails(input_text("model", "what.xyz", "v 0 0 0\n"), ECO_BAD_INPUT, "what.xyz");
	import_fails(input_text("model", "stems.csv", "species,x,y\nquru,1,2\n"), ECO_BAD_INPUT, "stems.csv: not a model that can be read; use OBJ");
	import_fails(input_text("model", "cut.glb", "glTF"), ECO_DAMAGED, "cut.glb");
	import_fails(input_text("model", "json.gltf", "{\"asset\":"), ECO_BAD_INPUT, "json.gltf: line 1");
	import_fails(input_text("model", "index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 900\n"), ECO_BAD_INPUT, "index.obj");
}

static void more_triangles_than_allowed_are_refused(void **state)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_model m;
	const char *path = input_text("model", "three.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 2 0\nf 1 2 3\nf 2 4 3\nf 3 4 5\n");

	(void)state;
	assert_int_equal(eco_model_import(&m, &(struct eco_model_options){ .paths = (const char *[]){ path }, .path_count = 1, .triangles_max = 2 }, &error), ECO_TOO_LARGE);
	assert_non_null(strstr(error.text, "3 triangles"));
	assert_int_equal(eco_model_import(&m, &(struct eco_model_options){ .paths = (const char *[]){ path }, .path_count = 1, .triangles_max = 3 }, NULL), ECO_OK);
	eco_model_free(&m);
}

/* Every document that is cut off, and many with a changed byte: a status or a sound model. */
static void damaged_files_are_survived(void **state)
{
	const char *path = gltf("whole.gltf", "{\"mesh\":0}", ",\"materials\":[{}]");
	char text[6000];
	FILE *file = fopen(path, "rb");
	size_t size = fread(text, 1, sizeof text, file), step = size / 40;

	(void)state;
	fclose(file);
	for (size_t at = 1; at < size; at += step) {
		struct eco_model m;
		char kept = text[at];

		if (eco_model_import(&m, &(struct eco_model_options){ .paths = (const char *[]){ input_bytes("model", "cut.gltf", text, at) }, .path_count = 1 }, NULL) == ECO_OK)
			fail_msg("%zu of %zu bytes were taken for a model", at, size);
		text[at] = (char)(kept ^ 1);
		if (eco_model_import(&m, &(struct eco_model_options){ .paths = (const char *[]){ input_bytes("model", "bit.gltf", text, size) }, .path_count = 1 }, NULL) == ECO_OK)
			for (uint32_t i = 0; i < m.triangle_count * 3; i++)
				assert_true(m.index[i] < m.vertex_count);
		eco_model_free(&m);
		text[at] = kept;
	}
}

/* ---- The guard ---- */

static enum eco_code misbehave(void *ctx, FILE *out, struct eco_error *error)
{
	switch (*(const int *)ctx) {
	case 0:
		return fputs("result", out) >= 0 ? ECO_OK : ECO_IO;
	case 1:
		return eco_fail(error, ECO_UNSUPPORTED, "as it was said");
	case 2:
		signal(SIGSEGV, SIG_DFL);
		raise(SIGSEGV);
		break;
	case 3:
		_exit(7);
	}
	return ECO_OK;
}

static void a_crash_in_the_child_is_an_error_here(void **state)
{
	static const struct { enum eco_code code; const char *says; } wanted[] = {
		{ ECO_OK, "" }, { ECO_UNSUPPORTED, "as it was said" }, { ECO_DAMAGED, "tree.obj: reading it ended with signal 11" },
		{ ECO_DAMAGED, "exit status 7" },
	};

	(void)state;
	for (int i = 0; i < 4; i++) {
		struct eco_error error = { .code = ECO_OK };
		char text[16] = "";
		FILE *result;

		assert_int_equal(eco_guard_run(misbehave, &i, "tree.obj", NULL, &result, &error), wanted[i].code);
		assert_non_null(strstr(error.text, wanted[i].says));
		assert_int_equal(result != NULL, i == 0);
		if (result == NULL)
			continue;
		assert_int_equal(fread(text, 1, sizeof text - 1, result), 6);
		assert_string_equal(text, "result");
		fclose(result);
	}
}

/* ---- Models of others ---- */

static void shared_models_arrive_whole(void **state)
{
	static const struct { const char *path; uint32_t triangles, degenerate, images; bool cutout; double height; } models[] = {
		{ "eztree/eztree_bush_1.glb", 13872, 0, 2, true, 30.15 }, { "eztree/eztree_pine_medium.obj", 19872, 8, 2, true, 51.29 },
		{ "eztree/grass.glb", 6, 0, 1, true, 2 }, { "eztree/flower_yellow.glb", 788, 0, 4, false, 1.769 },
		{ "quaternius/TreeStump.obj", 232, 0, 0, false, 0.622 }, { "sh3d_scopia/bush/bush.obj", 40292, 0, 2, true, 1.3119 },
		{ "sh3d_scopia/poplar/poplar.obj", 132050, 0, 1, false, 7.3003 }, { "sh3d_cc0/plant/plant.obj", 14370, 0, 0, false, 1.171 },
	};
	const char *data = getenv("ECO_DATA");

	(void)state;
	if (data == NULL)
		skip();
	for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
		struct eco_model m;
		char path[4096];
		bool cutout = false;

		snprintf(path, sizeof path, "%s/models/%s", data, models[i].path);
		if (access(path, R_OK) != 0)
			continue;
		import_good(&m, path, 0);
		assert_int_equal(m.triangles_in, models[i].triangles);
		assert_int_equal(m.dropped[ECO_DROP_DEGENERATE], models[i].degenerate);
		assert_int_equal(m.image_count, models[i].images);
		for (uint32_t k = 0; k < m.material_count; k++)
			cutout |= m.materials[k].cutout;
		assert_int_equal(cutout, models[i].cutout);
		if (!(fabs((eco_model_height(&m) + m.source.below * m.scale) / models[i].height - 1) < 0.001))
			fail_msg("%s: %g m high: %s", path, eco_model_height(&m), warnings);
		eco_model_free(&m);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(y_up_becomes_z_up_on_its_foot_at_its_height),
		cmocka_unit_test(polygons_count_as_corners_minus_two),
		cmocka_unit_test(any_simple_polygon_is_covered_exactly_once),
		cmocka_unit_test(what_covers_nothing_is_dropped_and_counted),
		cmocka_unit_test(bad_indices_are_dropped_by_the_last_step_too),
		cmocka_unit_test(the_foot_is_the_trunks_not_a_hanging_branchs),
		cmocka_unit_test(textures_lie_the_right_way_up_and_replace_the_colour),
		cmocka_unit_test(an_opacity_map_cuts_out),
		cmocka_unit_test(a_missing_or_broken_texture_is_told_not_fatal),
		cmocka_unit_test(colours_are_the_screens_unless_blender_wrote_them),
		cmocka_unit_test(invisible_materials_are_left_out_and_counted),
		cmocka_unit_test(nodes_place_their_meshes),
		cmocka_unit_test(alpha_modes_and_linear_colours_mean_what_gltf_says),
		cmocka_unit_test(a_texture_takes_each_colour_it_is_used_with),
		cmocka_unit_test(a_texture_cut_out_here_is_opaque_there),
		cmocka_unit_test(alpha_that_cuts_nothing_out_makes_no_other_image),
		cmocka_unit_test(beyond_what_is_kept_the_nearest_colour_stands_in),
		cmocka_unit_test(vertex_colours_of_a_textured_mesh_become_their_mean),
		cmocka_unit_test(a_webp_texture_that_gltf_requires_is_read),
		cmocka_unit_test(draco_meshes_are_read),
		cmocka_unit_test(vertex_colours_become_materials),
		cmocka_unit_test(texture_transforms_turn_about_the_images_corner),
		cmocka_unit_test(what_gltf_requires_and_is_not_read_is_refused_by_name),
		cmocka_unit_test(files_that_are_no_models_are_refused),
		cmocka_unit_test(more_triangles_than_allowed_are_refused),
		cmocka_unit_test(damaged_files_are_survived),
		cmocka_unit_test(a_crash_in_the_child_is_an_error_here),
		cmocka_unit_test(shared_models_arrive_whole),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
