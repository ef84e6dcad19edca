/* Colours and textures of models mean what the file meant: OBJ with MTL, and glTF. */

#include "ecofiles/format/image.h"
#include "ecofiles/import/model/import_model.h"
#include "ecofiles/format/model.h"
#include "tests/support/model_try.h"

#define TEST_FOLDER "model-colours"

/* Positions (0,0,0) (1,0,0) (0,1,0), uv (0,0) (1,0) (0,1), indices 0 1 2, as base64: 36 + 24 + 6 bytes. */
#define BUFFER "{'byteLength':66,'uri':'data:application/octet-stream;base64," \
	"AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" \
	"AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAABAAIA'}"
#define VIEWS "'bufferViews':[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36," \
	"'byteLength':24},{'buffer':0,'byteOffset':60," \
	"'byteLength':6}],'accessors':[{'bufferView':0,'componentType':5126,'count':3," \
	"'type':'VEC3','min':[0,0,0],'max':[1,1,0]}," \
	"{'bufferView':1,'componentType':5126,'count':3,'type':'VEC2'},{'bufferView':2," \
	"'componentType':5123,'count':3,'type':'SCALAR'}]"
#define MESH "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':1}," \
	"'indices':2,'material':0}]}]"

static const char *gltf(const char *name, const char *nodes, const char *rest)
{
	static char text[6000];
	snprintf(text, sizeof text, "{'asset':{'version':'2.0'},'scene':0,"
		"'scenes':[{'nodes':[0]}],'buffers':[" BUFFER "]," VIEWS ","
		MESH ",'nodes':[%s]%s}", nodes, rest);
	return input_json(TEST_FOLDER, name, text);
}

#define TRIANGLE_UV "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"

static void write_png(const char *name, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	assert_good(eco_png_write(&(struct eco_pixels){ width, height, 4, rgba }, input_path(TEST_FOLDER,
		name),
			&cause));
}

UNIT_TEST(textures_lie_the_right_way_up_and_replace_the_colour)
{
	static const uint8_t rgba[] = { 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0 };
	write_png("leaf one.png", rgba, 2, 2);
	input_text(TEST_FOLDER, "t.mtl", "newmtl m\nKd 0.64 0.64 0.64\nmap_Kd leaf one.png\n");
	import_high(input_text(TEST_FOLDER, "t.obj", "mtllib t.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.material_count, 1);
	assert_int_equal(m.image_count, 1);
	assert_int_equal(m.materials[0].image, 0);
	assert_true(m.materials[0].cutout);
	assert_int_equal(m.materials[0].rgb[1], 255);
	assert_memory_equal(m.images[0].rgba, rgba, sizeof rgba);
	/* OBJ's v points up: its (0, 0) is the bottom left, which is (0, 1) here; the foot is between the two
	 * lowest vertices */
	assert_true(has_vertex(-0.5f, 0, 0, (const float[]){ 0, 1 }));
	assert_true(has_vertex(-0.5f, 0, 1, (const float[]){ 0, 0 }));
	assert_true(has_vertex(0.5f, 0, 0, (const float[]){ 1, 1 }));
}

#define SWATCHES \
	"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0.2 0.9\nvt 0.3 0.6\nvt 0.75 0.25\nusemtl m\n" \
	"f 1/1 2/2 3/2\nf 4/3 5/3 1/3\n"

/* Triangles that show one colour each need no picture, which would blur into its neighbours where it is
 * coded. */
UNIT_TEST(a_picture_of_which_each_triangle_shows_one_colour_is_a_palette)
{
	static const uint8_t rgba[] = { 200, 10, 20, 255, 0, 255, 0, 255, 0, 0, 255, 255, 30, 90, 40, 255 };
	static const struct { const char *more; uint32_t images; } cases[] = { { "", 0 },
		{ "f 1/1 2/3 5/3\n", 1 } };
	write_png("palette.png", rgba, 2, 2);
	input_text(TEST_FOLDER, "palette.mtl", "newmtl m\nKd 0.64 0.64 0.64\nmap_Kd palette.png\n");
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char text[400];
		snprintf(text, sizeof text, "mtllib palette.mtl\n%s%s", SWATCHES, cases[i].more);
		import_high(input_text(TEST_FOLDER, "palette.obj", text), 0);
		assert_int_equal(m.image_count, cases[i].images);
		assert_true((m.uv != NULL) == (cases[i].images > 0));
		const struct eco_material *first = &m.materials[m.material[0]];
		if (cases[i].images == 0) {
			assert_memory_equal(first->rgb, rgba, 3);
			assert_memory_equal(m.materials[m.material[1]].rgb, rgba + 12, 3);
			assert_string_equal(first->name, "m");
		}
		assert_int_equal(first->image, cases[i].images > 0 ? 0 : ECO_NONE);
	}
}

/* A picture of 256 colours under a triangle each, and `count` of them. */
static struct eco_model model_of_palettes(uint32_t count, uint32_t users)
{
	uint32_t triangles = 256 * count * users;
	struct eco_model model = { .uv = calloc(triangles, 2 * sizeof *model.uv),
		.index = calloc(triangles, 3 * sizeof *model.index),
		.material = calloc(triangles, sizeof *model.material), .vertex_count = triangles,
		.triangle_count = triangles, .materials = calloc(count * users, sizeof *model.materials),
		.material_count = count * users, .images = calloc(count, sizeof *model.images),
		.image_count = count };
	for (uint32_t i = 0; i < count; i++) {
		model.images[i] = (struct eco_image){ .width = 256, .height = 1, .rgba = malloc(1024) };
		for (uint32_t x = 0; x < 256; x++)
			memcpy(model.images[i].rgba + (size_t)4 * x,
				(uint8_t[]){ (uint8_t)x, (uint8_t)i, 7, 255 }, 4);
	}
	for (uint32_t t = 0; t < triangles; t++) {
		uint32_t own = t / 256;
		model.material[t] = own;
		model.materials[own] =
			(struct eco_material){ .rgb = { 255, 255, 255 }, .image = own % count };
		model.uv[2 * (size_t)t] = ((float)(t % 256) + 0.5f) / 256;
		model.uv[2 * (size_t)t + 1] = 0.5f;
		for (int c = 0; c < 3; c++)
			model.index[3 * (size_t)t + (size_t)c] = t;
	}
	return model;
}

UNIT_TEST(each_palette_has_colours_of_its_own_and_none_is_lost)
{
	static const struct { uint32_t count, users, kept; } cases[] = { { 3, 1, 0 }, { 16, 1, 0 },
		{ 20, 1, 4 }, { 2, 10, 1 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_model model = model_of_palettes(cases[i].count, cases[i].users);
		eco_model_take_palettes(&model);
		assert_int_equal(model.image_count, cases[i].kept);
		for (uint32_t t = 0; t < model.triangle_count; t++) {
			const struct eco_material *own = &model.materials[model.material[t]];
			const uint8_t rgb[3] = { (uint8_t)(t % 256), (uint8_t)(t / 256 % cases[i].count), 7 };
			if (own->image == ECO_NONE)
				assert_memory_equal(own->rgb, rgb, 3);
		}
		eco_model_free(&model);
	}
}

UNIT_TEST(an_opacity_map_cuts_out)
{
	static const uint8_t solid[] = { 9, 9, 9, 255, 9, 9, 9, 255 },
		mask[] = { 255, 255, 255, 255, 0, 0, 0, 255 };
	write_png("solid.png", solid, 2, 1);
	write_png("mask.png", mask, 2, 1);
	input_text(TEST_FOLDER, "o.mtl", "newmtl m\nmap_Kd solid.png\nmap_d mask.png\n");
	import_high(input_text(TEST_FOLDER, "o.obj", "mtllib o.mtl\n" TRIANGLE_UV), 0);
	assert_true(m.materials[0].cutout && m.images[0].rgba[3] == 255 && m.images[0].rgba[7] == 0);
	input_text(TEST_FOLDER, "o.mtl", "newmtl m\nmap_Kd solid.png\n");
	import_high("build/tmp/" TEST_FOLDER "/o.obj", 0);
	assert_false(m.materials[0].cutout);
}

UNIT_TEST(a_grey_that_nobody_chose_is_no_colour)
{
	static const struct { const char *mtl; bool colourless;
	} cases[] = { { "newmtl m\nKd 1 1 1\nmap_Kd null\n", true },
		/* the picture is lost, and what it was multiplied with is white */
		{ "newmtl m\nKd 0 0 0\nmap_Kd lost.png\n", true },
		{ "newmtl m\nKd 0.8 0.8 0.8\n", true },  /* one grey all over: a default */
		{ "newmtl m\nKd 0.1 0.1 0.1\n", false }, /* too dark for one: charred wood */
		{ "newmtl m\nKd 0.5 0.6 0.4\nmap_Kd lost.png\n", false },
		{ "newmtl m\nKd 1 1 1\nmap_Kd white.png\n",
			true }, /* left by a tool that took pictures out */
		{ "newmtl m\nKd 1 1 1\nmap_Kd snow.png\n", false } };
	const uint8_t white[8] = { 255, 255, 255, 255, 255, 255, 255, 255 },
		snow[8] = { 255, 255, 255, 255, 250, 250, 255, 255 };

	write_png("white.png", white, 2, 1);
	write_png("snow.png", snow, 2, 1);
	input_text(TEST_FOLDER, "grey.obj", "mtllib grey.mtl\n" TRIANGLE_UV);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		input_text(TEST_FOLDER, "grey.mtl", cases[i].mtl);
		import_high("build/tmp/" TEST_FOLDER "/grey.obj", 0);
		if (m.materials[m.material[0]].colourless != cases[i].colourless)
			fail_msg("%s", cases[i].mtl);
		assert_int_equal(strstr(import_said, "no colour in its files") != NULL, cases[i].colourless);
	}
	input_text(TEST_FOLDER, "grey.mtl", "newmtl m\nKd 0.9 0.9 0.9\nnewmtl n\nKd 0.4 0.4 0.4\n");
		/* two greys were chosen: bark and snow */
	import_high(input_text(TEST_FOLDER, "greys.obj", "mtllib grey.mtl\n" TRIANGLE_UV
		"v 0 0 2\nv 1 0 2\nv 0 1 2\nusemtl n\nf 4 5 6\n"), 0);
	assert_int_equal(m.triangle_count, 2);
	assert_false(m.materials[m.material[0]].colourless || m.materials[m.material[1]].colourless);
	input_text(TEST_FOLDER, "grey.mtl", "newmtl m\nKd 0.8 0.8 0.8\nnewmtl n\nKd 1 1 1\n");
		/* defaults of two programs */
	import_high("build/tmp/" TEST_FOLDER "/greys.obj", 0);
	assert_true(m.materials[m.material[0]].colourless && m.materials[m.material[1]].colourless);
	input_text(TEST_FOLDER, "grey.mtl", "newmtl m\nKd 0.8 0.8 0.8\n"); /* a default, and nothing */
	import_high("build/tmp/" TEST_FOLDER "/greys.obj", 0);
	assert_true(m.materials[m.material[0]].colourless && m.materials[m.material[1]].colourless);
}

/* Six triangles above each other, of one vertex colour each. */
static void import_ramp(double (*rgb)[3])
{
	char text[2000] = "", faces[200] = "";
	for (int v = 0; v < 18; v++) {
		const double *own = rgb[v / 3];
		sprintf(text + strlen(text), "v %d %d %d %g %g %g\n", v % 3 == 1, v % 3 == 2, v / 3, own[0],
			own[1], own[2]);
		if (v % 3 == 2)
			sprintf(faces + strlen(faces), "f %d %d %d\n", v - 1, v, v + 1);
	}
	strcat(text, faces);
	import_high(input_text(TEST_FOLDER, "ramp.obj", text), 0);
	assert_int_equal(m.triangle_count, 6);
}

UNIT_TEST(colours_of_vertices_from_black_to_red_are_weights)
{
	static const struct { int channel; double add; bool weights; } cases[] = { { 0, 0, true },
		{ 2, 0, true }, { 1, 0, false }, { 0, 0.5, false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double rgb[6][3] = { { 0 } };
		for (int k = 0; k < 6; k++) {
			rgb[k][cases[i].channel] = k / 5.0;
			rgb[k][(cases[i].channel + 1) % 3] = cases[i].add;
		}
		import_ramp(rgb);
		assert_int_equal(m.materials[m.material[0]].colourless, cases[i].weights);
		assert_int_equal(strstr(import_said, "taken for weights of wind") != NULL, cases[i].weights);
	}
}

/* Shade on white is no colour; other greys, or a colour beside them, are. */
UNIT_TEST(greys_of_vertices_on_white_are_shade)
{
	static const struct { double least, blue; bool shade; } cases[] = { { 0.3, 1, true },
		{ 0.3, 0.5, false }, { 0.9, 1, false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double rgb[6][3];
		for (int k = 0; k < 6; k++) {
			rgb[k][0] = rgb[k][1] = cases[i].least + (1 - cases[i].least) * k / 5.0;
			rgb[k][2] = rgb[k][0] * (k < 5 ? 1 : cases[i].blue);
		}
		import_ramp(rgb);
		assert_int_equal(strstr(import_said, "taken for shade") != NULL, cases[i].shade);
		if (cases[i].least < 0.9)
			assert_int_equal(m.materials[m.material[0]].colourless, cases[i].shade);
	}
}

UNIT_TEST(colours_are_the_screens_unless_blender_wrote_them)
{
	input_text(TEST_FOLDER, "c.mtl", "newmtl m\nKd 0.2 0.2 0.2\n");
	import_high(input_text(TEST_FOLDER, "c.obj", "mtllib c.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.materials[0].rgb[0], 51);
	import_high(input_text(TEST_FOLDER, "c.obj", "# Blender 3.4.1\nmtllib c.mtl\n" TRIANGLE_UV), 0);
	assert_int_equal(m.materials[0].rgb[0], 124);        /* 0.2 linear */
}

UNIT_TEST(invisible_materials_are_left_out_and_counted)
{
	input_text(TEST_FOLDER, "d.mtl", "newmtl m\nd 0.3\nnewmtl n\nd 0.6\n");
	import_high(input_text(TEST_FOLDER, "d.obj", "mtllib d.mtl\n" TRIANGLE_UV
		"v 5 0 0\nusemtl n\nf 1 2 3\nf 1 3 4\n"), 0);
	assert_int_equal(m.triangles_in, 3);
	assert_int_equal(m.dropped[ECO_DROP_TRANSPARENT], 1);
	assert_int_equal(m.triangle_count, 2);
	assert_int_equal(m.material_count, 1);
	assert_non_null(strstr(import_said, "1 triangles have materials with alpha below 0.5"));
}

/* ---- glTF ---- */

static const struct { const char *mode; bool cutout; uint8_t alpha[2]; } modes[] = {
	{ "'alphaMode':'OPAQUE',", false, { 255, 255 } }, { "", false, { 255, 255 } },
		{ "'alphaMode':'BLEND',", true, { 100, 200 } },
	{ "'alphaMode':'MASK',", true, { 100, 200 } },
	{ "'alphaMode':'MASK','alphaCutoff':0.25,", false, { 255, 255 } },
	{ "'alphaMode':'MASK','alphaCutoff':0.9,", true, { 56, 111 } },
	/* equal to the cutoff is opaque: 200/255, 100/255, and whatever there is */
	{ "'alphaMode':'MASK','alphaCutoff':0.78431373,", true, { 64, 128 } },
	{ "'alphaMode':'MASK','alphaCutoff':0.39215687,", false, { 255, 255 } },
	{ "'alphaMode':'MASK','alphaCutoff':0,", false, { 255, 255 } },
};

UNIT_TEST(alpha_modes_and_linear_colours_mean_what_gltf_says)
{
	static const uint8_t rgba[] = { 255, 0, 0, 100, 0, 255, 0, 200 };
	write_png("a b.png", rgba, 2, 1);
	for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
		char rest[500];
		snprintf(rest, sizeof rest, ",'materials':[{%s'pbrMetallicRoughness':{'baseColorFactor':[0.5,"
			"1,0,1],'baseColorTexture':{'index':0}}}],'textures':[{'source':0}],"
			"'images':[{'uri':'a%%20b.png'}]", modes[i].mode);
		import_high(gltf("alpha.gltf", "{'mesh':0}", rest), 0);
		assert_int_equal(m.image_count, 1);
		assert_int_equal(m.materials[0].cutout, modes[i].cutout);
		assert_int_equal(m.images[0].rgba[3], modes[i].alpha[0]);
		assert_int_equal(m.images[0].rgba[7], modes[i].alpha[1]);
		assert_memory_equal(m.materials[0].rgb, "\377\377\377", 3);
		assert_true(m.images[0].rgba[0] == 188 && m.images[0].rgba[1] == 0 && m.images[0].rgba[5]
			== 255);
		/* glTF's v points down */
		assert_true(has_vertex(-0.5f, 0, 0, (const float[]){ 0, 0 }));
	}
}

/* Three triangles beside each other, one for each of the materials (JSON); their texture 0 is `rgba`, one
 * row. */
static void import_textured(const char *materials, const uint8_t *rgba,
	uint32_t width)
{
	char meshes[2000] = "", nodes[2000] = "", text[8000];
	size_t mesh = 0, node = 0;
	write_png("row.png", rgba, width, 1);
	for (uint32_t i = 0; i < 3; i++) {
		mesh += (size_t)snprintf(meshes + mesh, sizeof meshes - mesh,
			"%s{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':1},"
			"'indices':2,'material':%u}]}", i > 0 ? "," : "", i);
		node += (size_t)snprintf(nodes + node, sizeof nodes - node,
			",{'mesh':%u,'translation':[%u,0,0]}", i, 2 * i);
	}
	snprintf(text, sizeof text, "{'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0,"
		"1,2,3]}],'buffers':[" BUFFER "]," VIEWS
		",'meshes':[%s],'nodes':[{}%s],'materials':[%s],'textures':[{'source':0}],"
		"'images':[{'uri':'row.png'}]}", meshes, nodes, materials);
	import_high(input_json(TEST_FOLDER, "row.gltf", text), 0);
}

static void assert_texel(const char *material, uint32_t x,
	const uint8_t wanted[4])
{
	const struct eco_material *of = material_of(material);
	const uint8_t *texel;
	assert_true(of->image < m.image_count);
	assert_memory_equal(of->rgb, "\377\377\377", 3);
	texel = &m.images[of->image].rgba[x * 4];
	if (memcmp(texel, wanted, 4) != 0)
		fail_msg("%s, texel %u: %u %u %u %u", material, x, texel[0], texel[1], texel[2], texel[3]);
}

UNIT_TEST(a_texture_takes_each_colour_it_is_used_with)
{
	static const uint8_t rgba[] = { 255, 128, 0, 255, 188, 188, 255, 255 };
	import_textured("{'name':'half','pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,"
		"1],'baseColorTexture':{'index':0}}},"
		"{'name':'plain','pbrMetallicRoughness':{'baseColorTexture':{'index':0}}},"
		"{'name':'also','pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1],"
		"'baseColorTexture':{'index':0}}}", rgba, 2);
	assert_int_equal(m.triangle_count, 3);
	assert_int_equal(m.image_count, 2);
	assert_int_equal(material_of("half")->image, material_of("also")->image);
	assert_texel("plain", 0, rgba);
	assert_texel("plain", 1, rgba + 4);
	/* half the light: (128/255)^2.2 is 0.216, its half 0.108 */
	assert_texel("half", 0, (const uint8_t[]){ 188, 93, 0, 255 });
	assert_texel("half", 1, (const uint8_t[]){ 138, 138, 188, 255 });
}

UNIT_TEST(a_picture_of_one_colour_is_that_colour)
{
	static const uint8_t moss[] = { 90, 120, 40, 255, 90, 120, 40, 255 };
	import_textured("{'name':'half','pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1],"
		"'baseColorTexture':{'index':0}}},"
		"{'name':'moss','pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}", moss, 2);
	assert_int_equal(m.image_count, 0);
	assert_int_equal(material_of("moss")->image, ECO_NONE);
	assert_memory_equal(material_of("moss")->rgb, moss, 3);
	assert_memory_equal(material_of("half")->rgb, ((uint8_t[]){ 64, 87, 27 }), 3);
}

UNIT_TEST(a_texture_cut_out_here_is_opaque_there)
{
	static const uint8_t rgba[] = { 9, 9, 9, 255, 8, 8, 8, 180, 7, 7, 7, 0 };
	import_textured("{'name':'leaf','alphaMode':'MASK',"
		"'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}},{'name':'bark',"
		"'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}},{'name':'veil',"
		"'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.6],"
		"'baseColorTexture':{'index':0}}}", rgba, 3);
	assert_int_equal(m.image_count, 3);
	assert_true(material_of("leaf")->cutout && material_of("veil")->cutout
		&& !material_of("bark")->cutout);
	for (uint32_t x = 0; x < 3; x++) {
		uint8_t level = (uint8_t)(9 - x);
		assert_texel("leaf", x, (const uint8_t[]){ level, level, level, rgba[x * 4 + 3] });
		assert_texel("bark", x, (const uint8_t[]){ level, level, level, 255 });
		assert_texel("veil", x,
			(const uint8_t[]){ level, level, level, (uint8_t)(rgba[x * 4 + 3] * 0.6 + 0.5) });
	}
}

UNIT_TEST(alpha_that_cuts_nothing_out_makes_no_other_image)
{
	static const uint8_t rgba[] = { 9, 9, 9, 255, 8, 8, 8, 240 };
	import_textured("{'name':'leaf','alphaMode':'MASK',"
		"'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}},{'name':'bark',"
		"'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}},{'name':'veil',"
		"'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.4],"
		"'baseColorTexture':{'index':0}}}", rgba, 2);
	assert_int_equal(m.image_count, 1);
	assert_false(material_of("leaf")->cutout);
	assert_texel("leaf", 1, (const uint8_t[]){ 8, 8, 8, 255 });
	assert_int_equal(material_of("bark")->image, 0);
	assert_int_equal(m.dropped[ECO_DROP_TRANSPARENT], 1);        /* 0.4 of 1 is below 0.5 everywhere */
}

/* A model in memory of `count` triangles, each with its own colour of the one image, which has a white texel
 * and a black one. */
static void make_motley(uint32_t count)
{
	eco_model_free(&m);
	m = (struct eco_model){ .material_count = count, .image_count = 1 };
	m.materials = calloc(count, sizeof *m.materials);
	m.images = calloc(1, sizeof *m.images);
	m.images[0] = (struct eco_image){ .width = 2, .height = 1, .rgba = malloc(8) };
	memcpy(m.images[0].rgba, (uint8_t[]){ 255, 255, 255, 255, 0, 0, 0, 255 }, 8);
	for (uint32_t i = 0; i < count; i++) {
		m.materials[i].image = 0;
		memset(m.materials[i].rgb, (int)(255 - i), 3);
	}
}

UNIT_TEST(beyond_what_is_kept_the_nearest_colour_stands_in)
{
	struct eco_notes notes = { .used = 0 };
	make_motley(200);
	eco_model_bake_tints(&m, &notes);
	assert_int_equal(m.image_count, 32);
	for (uint32_t i = 0; i < 200; i++) {
		const uint8_t *texel = m.images[m.materials[i].image].rgba;
		assert_true(texel[0] == (i < 32 ? 255 - i : 224) && texel[2] == texel[0] && texel[3] == 255
			&& m.materials[i].rgb[1] == 255);
	}
	assert_non_null(strstr(notes.text, "168 materials are drawn in the nearest"));
}

UNIT_TEST(vertex_colours_of_a_textured_mesh_become_their_mean)
{
	static const uint8_t white[] = { 255, 255, 255, 255, 0, 0, 0, 255 };
	write_png("white.png", white, 2, 1);
	input_text(TEST_FOLDER, "vt.mtl", "newmtl m\nmap_Kd white.png\n");
	import_high(input_text(TEST_FOLDER, "vt.obj", "mtllib vt.mtl\nv 0 0 0 1 1 0\nv 1 0 0 0.4 1 0\nv "
		"0 1 0 0.4 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"), 0);
	assert_int_equal(m.image_count, 1);
	assert_int_equal(m.material_count, 1);
	assert_texel("m", 0, (const uint8_t[]){ 153, 255, 0, 255 });
	assert_non_null(strstr(import_said, "1 textured meshes have vertex colours that differ"));
}

UNIT_TEST(a_webp_texture_that_gltf_requires_is_read)
{
	/* 4 x 1 pixels, the first (200,0,0) at alpha 128 */
	const char *rest = ",'extensionsUsed':['EXT_texture_webp'],"
		"'extensionsRequired':['EXT_texture_webp'],'materials':[{'name':'g',"
		"'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}],"
		"'textures':[{'extensions':{'EXT_texture_webp':{'source':0}}}],"
		"'images':[{'mimeType':'image/webp','uri':'data:image/webp;base64,"
		"UklGRjIAAABXRUJQVlA4TCUAAAAvAwAAEB8gECD43/FnQyyYzP+MKqxBEQgQ1p05E8DsrKHGEf0PAA=='}]";

	import_high(gltf("webp.gltf", "{'mesh':0}", rest), 0);
	assert_int_equal(m.image_count, 1);
	assert_int_equal(m.images[0].width, 4);
	assert_true(material_of("g")->cutout);
	assert_in_range(m.images[0].rgba[0], 198, 202);
}

UNIT_TEST(texture_transforms_turn_about_the_images_corner)
{
	uint8_t rgba[4 * 4 * 4];
	static const struct { const char *transform; float uv[3][2]; } cases[] = {
		{ "'offset':[0.25,0.125],'scale':[0.5,2]",
			{ { 0.25f, 0.125f }, { 0.75f, 0.125f }, { 0.25f, 2.125f } } },
		/* the lower left quadrant, a quarter turn: the example of the extension's specification */
		{ "'offset':[0,1],'rotation':1.57079632679,'scale':[0.5,0.5]",
		{ { 0, 1 }, { 0, 0.5f }, { 0.5f, 1 } } },
	};

	for (size_t i = 0; i < sizeof rgba; i++)
		rgba[i] = i % 4 == 3 ? 255 : (uint8_t)i;
	write_png("one.png", rgba, 4, 4);
	for (size_t i = 0; i < 2; i++) {
		char rest[700];
		snprintf(rest, sizeof rest, ",'extensionsUsed':['KHR_texture_transform'],"
			"'extensionsRequired':['KHR_texture_transform'],"
			"'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0,"
			"'extensions':{'KHR_texture_transform':{%s}}}}}],"
			"'textures':[{'source':0}],'images':[{'uri':'one.png'}]",
			cases[i].transform);
		import_high(gltf("turn.gltf", "{'mesh':0}", rest), 0);
		assert_true(has_vertex(-0.5f, 0, 0, cases[i].uv[0])
			&& has_vertex(0.5f, 0, 0, cases[i].uv[1])
			&& has_vertex(-0.5f, 0, 1, cases[i].uv[2]));
	}
}
