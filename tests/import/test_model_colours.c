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
#define TRIANGLE_UV "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"

#define PRIMITIVE(material) "{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':1},'indices':2,'material':" \
	material "}]}"
#define GLTF(rest) "{'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0]}],'buffers':[" BUFFER "]," VIEWS \
	",'meshes':[" PRIMITIVE("0") "],'nodes':[{'mesh':0}]" rest "}"
/* Three triangles beside each other, one for each of the materials. */
#define BESIDE(materials, picture) "{'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0,1,2]}],'buffers':[" \
	BUFFER "]," VIEWS ",'meshes':[" PRIMITIVE("0") "," PRIMITIVE("1") "," PRIMITIVE("2") "],'nodes':[{'mesh':0}," \
	"{'mesh':1,'translation':[2,0,0]},{'mesh':2,'translation':[4,0,0]}],'materials':[" materials "]," \
	"'textures':[{'source':0}],'images':[{'uri':'" picture "'}]}"
#define TEXTURE "'baseColorTexture':{'index':0}"
#define ALPHA(mode) GLTF(",'materials':[{" mode "'pbrMetallicRoughness':{'baseColorFactor':[0.5,1,0,1]," TEXTURE "}}]," \
	"'textures':[{'source':0}],'images':[{'uri':'a%20b.png'}]")
#define LEAF_BARK_VEIL(veil, picture) BESIDE("{'name':'leaf','alphaMode':'MASK','pbrMetallicRoughness':{" TEXTURE "}}," \
	"{'name':'bark','pbrMetallicRoughness':{" TEXTURE "}},{'name':'veil','alphaMode':'BLEND'," \
	"'pbrMetallicRoughness':{'baseColorFactor':[1,1,1," veil "]," TEXTURE "}}", picture)
#define TURNED(transform) GLTF(",'extensionsUsed':['KHR_texture_transform'],'extensionsRequired':[" \
	"'KHR_texture_transform'],'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0,'extensions':{" \
	"'KHR_texture_transform':{" transform "}}}}}],'textures':[{'source':0}],'images':[{'uri':'cut.png'}]")
#define SWATCHES "mtllib palette.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0.2 0.9\nvt 0.3 0.6\nvt 0.75 0.25\n" \
	"usemtl m\nf 1/1 2/2 3/2\nf 4/3 5/3 1/3\n"
#define GREY "mtllib grey.mtl\n" TRIANGLE_UV
#define GREYS GREY "v 0 0 2\nv 1 0 2\nv 0 1 2\nusemtl n\nf 4 5 6\n"

static const struct { const char *name; uint32_t width, height; uint8_t rgba[16]; } pictures[] = {
	{ "leaf one.png", 2, 2, { 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0 } },
	{ "palette.png", 2, 2, { 200, 10, 20, 255, 0, 255, 0, 255, 0, 0, 255, 255, 30, 90, 40, 255 } },
	{ "solid.png", 2, 1, { 9, 9, 9, 255, 9, 9, 9, 255 } },
	{ "mask.png", 2, 1, { 255, 255, 255, 255, 0, 0, 0, 255 } },
	{ "white.png", 2, 1, { 255, 255, 255, 255, 255, 255, 255, 255 } },
	{ "snow.png", 2, 1, { 255, 255, 255, 255, 250, 250, 255, 255 } },
	{ "a b.png", 2, 1, { 255, 0, 0, 100, 0, 255, 0, 200 } },
	{ "half.png", 2, 1, { 255, 128, 0, 255, 188, 188, 255, 255 } },
	{ "black.png", 2, 1, { 0, 0, 0, 255, 0, 0, 0, 255 } },
	{ "moss.png", 2, 1, { 90, 120, 40, 255, 90, 120, 40, 255 } },
	{ "cut.png", 3, 1, { 9, 9, 9, 255, 8, 8, 8, 180, 7, 7, 7, 0 } },
	{ "soft.png", 3, 1, { 9, 9, 9, 100, 8, 8, 8, 60, 7, 7, 7, 0 } },
	{ "uncut.png", 2, 1, { 9, 9, 9, 255, 8, 8, 8, 240 } } };

static const struct model_case models[] = {
	/* OBJ's v points up: its (0, 0) is the bottom left, which is (0, 1) here; the foot is between the two lowest */
	{ "textures_lie_the_right_way_up_and_replace_the_colour", "t.obj", "mtllib t.mtl\n" TRIANGLE_UV, "t.mtl",
		"newmtl m\nKd 0.64 0.64 0.64\nmap_Kd leaf one.png\n", .wanted = "materials=1|images=1|image0=0|cut0=1|"
		"rgb0=255,255,255|texels0=255,0,0,255,0,255,0,255,0,0,255,255,255,255,255,0|at=-0.5,0,0,0,1|"
		"at=-0.5,0,1,0,0|at=0.5,0,0,1,1" },
	/* triangles that show one colour each need no picture, which would blur into its neighbours where it is coded */
	{ "a_picture_of_which_each_triangle_shows_one_colour_is_a_palette", "palette.obj", SWATCHES, "palette.mtl",
		"newmtl m\nKd 0.64 0.64 0.64\nmap_Kd palette.png\n",
		.wanted = "images=0|image0=-1|material0=m|rgb0=200,10,20|rgb1=30,90,40" },
	{ NULL, "palette.obj", SWATCHES "f 1/1 2/3 5/3\n", "palette.mtl",
		"newmtl m\nKd 0.64 0.64 0.64\nmap_Kd palette.png\n", .wanted = "images=1|image0=0" },
	{ "an_opacity_map_cuts_out", "o.obj", "mtllib o.mtl\n" TRIANGLE_UV, "o.mtl",
		"newmtl m\nmap_Kd solid.png\nmap_d mask.png\n", .wanted = "cut0=1|texels0=9,9,9,255,9,9,9,0" },
	{ NULL, "o.obj", "mtllib o.mtl\n" TRIANGLE_UV, "o.mtl", "newmtl m\nmap_Kd solid.png\n", .wanted = "cut0=0" },
	{ "a_grey_that_nobody_chose_is_no_colour", "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 1 1 1\nmap_Kd null\n",
		.wanted = "grey0=1|~no colour in its files" },
	/* the picture is lost, and what it was multiplied with is white */
	{ NULL, "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 0 0 0\nmap_Kd lost.png\n",
		.wanted = "grey0=1|~no colour in its files" },
	/* one grey all over: a default */
	{ NULL, "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 0.8 0.8 0.8\n", .wanted = "grey0=1|~no colour in its files" },
	/* too dark for one: charred wood */
	{ NULL, "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 0.1 0.1 0.1\n", .wanted = "grey0=0|!no colour in its files" },
	{ NULL, "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 0.5 0.6 0.4\nmap_Kd lost.png\n",
		.wanted = "grey0=0|!no colour in its files" },
	/* left by a tool that took pictures out */
	{ NULL, "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 1 1 1\nmap_Kd white.png\n",
		.wanted = "grey0=1|~no colour in its files" },
	{ NULL, "grey.obj", GREY, "grey.mtl", "newmtl m\nKd 1 1 1\nmap_Kd snow.png\n",
		.wanted = "grey0=0|!no colour in its files" },
	/* two greys were chosen: bark and snow */
	{ NULL, "greys.obj", GREYS, "grey.mtl", "newmtl m\nKd 0.9 0.9 0.9\nnewmtl n\nKd 0.4 0.4 0.4\n",
		.wanted = "triangles=2|grey0=0|grey1=0" },
	/* defaults of two programs; a default, and nothing */
	{ NULL, "greys.obj", GREYS, "grey.mtl", "newmtl m\nKd 0.8 0.8 0.8\nnewmtl n\nKd 1 1 1\n",
		.wanted = "grey0=1|grey1=1" },
	{ NULL, "greys.obj", GREYS, "grey.mtl", "newmtl m\nKd 0.8 0.8 0.8\n", .wanted = "grey0=1|grey1=1" },
	{ "colours_are_the_screens_unless_blender_wrote_them", "c.obj", "mtllib c.mtl\n" TRIANGLE_UV, "c.mtl",
		"newmtl m\nKd 0.2 0.2 0.2\n", .wanted = "rgb0=51,51,51" },
	{ NULL, "c.obj", "# Blender 3.4.1\nmtllib c.mtl\n" TRIANGLE_UV, "c.mtl", "newmtl m\nKd 0.2 0.2 0.2\n",
		.wanted = "rgb0=124,124,124" },      /* 0.2 linear */
	{ "invisible_materials_are_left_out_and_counted", "d.obj", "mtllib d.mtl\n" TRIANGLE_UV "v 5 0 0\nusemtl n\n"
		"f 1 2 3\nf 1 3 4\n", "d.mtl", "newmtl m\nd 0.3\nnewmtl n\nd 0.6\n", .wanted = "in=3|clear=1|triangles=2|"
		"materials=1|~1 triangles have materials with alpha below 0.5" },
	{ "vertex_colours_of_a_textured_mesh_become_their_mean", "vt.obj", "mtllib vt.mtl\nv 0 0 0 1 1 0\nv 1 0 0 0.4 1 0\n"
		"v 0 1 0 0.4 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n", "vt.mtl", "newmtl m\nmap_Kd mask.png\n",
		.wanted = "images=1|materials=1|texels0=153,255,0,255|~1 textured meshes have vertex colours that differ" },
	/* glTF's v points down */
	{ "alpha_modes_and_linear_colours_mean_what_gltf_says", "a.gltf", ALPHA("'alphaMode':'OPAQUE',"), .wanted = "images=1|"
		"cut0=0|rgb0=255,255,255|texels0=188,0,0,255,0,255,0,255|at=-0.5,0,0,0,0" },
	{ NULL, "a.gltf", ALPHA(""), .wanted = "images=1|cut0=0|texels0=188,0,0,255,0,255,0,255" },
	{ NULL, "a.gltf", ALPHA("'alphaMode':'BLEND',"), .wanted = "images=1|cut0=1|texels0=188,0,0,100,0,255,0,200" },
	{ NULL, "a.gltf", ALPHA("'alphaMode':'MASK',"), .wanted = "images=1|cut0=1|texels0=188,0,0,100,0,255,0,200" },
	{ NULL, "a.gltf", ALPHA("'alphaMode':'MASK','alphaCutoff':0.25,"),
		.wanted = "images=1|cut0=0|texels0=188,0,0,255,0,255,0,255" },
	{ NULL, "a.gltf", ALPHA("'alphaMode':'MASK','alphaCutoff':0.9,"),
		.wanted = "images=1|cut0=1|texels0=188,0,0,56,0,255,0,111" },
	/* equal to the cutoff is opaque: 200/255, 100/255, and whatever there is */
	{ NULL, "a.gltf", ALPHA("'alphaMode':'MASK','alphaCutoff':0.78431373,"),
		.wanted = "images=1|cut0=1|texels0=188,0,0,64,0,255,0,128" },
	{ NULL, "a.gltf", ALPHA("'alphaMode':'MASK','alphaCutoff':0.39215687,"),
		.wanted = "images=1|cut0=0|texels0=188,0,0,255,0,255,0,255" },
	{ NULL, "a.gltf", ALPHA("'alphaMode':'MASK','alphaCutoff':0,"),
		.wanted = "images=1|cut0=0|texels0=188,0,0,255,0,255,0,255" },
	/* a soft picture, of which 0.5 would leave nothing, is cut at half of its largest alpha */
	{ "soft_blends_keep_what_shows_most", "s.gltf", GLTF(",'materials':[{'alphaMode':'BLEND','pbrMetallicRoughness':{"
		TEXTURE "}}],'textures':[{'source':0}],'images':[{'uri':'soft.png'}]"),
		.wanted = "images=1|cut0=1|texels0=9,9,9,255,8,8,8,153,7,7,7,0" },
	{ "what_is_emitted_alone_is_the_colour", "e.gltf", GLTF(",'materials':[{'pbrMetallicRoughness':{'baseColorFactor':"
		"[0,0,0,1]},'emissiveFactor':[0.2140411,1,0]}]"), .wanted = "images=0|rgb0=127,255,0" },
	{ NULL, "e.gltf", GLTF(",'materials':[{'pbrMetallicRoughness':{'baseColorFactor':[0,0,0,1]},'emissiveFactor':"
		"[1,1,1],'emissiveTexture':{'index':0}}],'textures':[{'source':0}],'images':[{'uri':'half.png'}]"),
		.wanted = "images=1|texels0=255,128,0,255,188,188,255,255" },
	{ NULL, "e.gltf", GLTF(",'materials':[{'pbrMetallicRoughness':{" TEXTURE "},'emissiveFactor':[1,1,1],"
		"'emissiveTexture':{'index':1}}],'textures':[{'source':0},{'source':1}],'images':[{'uri':'black.png'},"
		"{'uri':'half.png'}]"), .wanted = "texels0=255,128,0,255,188,188,255,255" },
	{ NULL, "e.gltf", GLTF(",'materials':[{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0,0,1]},'emissiveFactor':"
		"[0,1,0]}]"), .wanted = "rgb0=188,0,0" },
	/* half the light: (128/255)^2.2 is 0.216, its half 0.108 */
	{ "a_texture_takes_each_colour_it_is_used_with", "row.gltf", BESIDE("{'name':'half','pbrMetallicRoughness':{"
		"'baseColorFactor':[0.5,0.5,0.5,1]," TEXTURE "}},{'name':'plain','pbrMetallicRoughness':{" TEXTURE "}},"
		"{'name':'also','pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1]," TEXTURE "}}", "half.png"),
		.wanted = "triangles=3|images=2|rgb0=255,255,255|texels0=188,93,0,255,138,138,188,255|rgb1=255,255,255|"
		"texels1=255,128,0,255,188,188,255,255|texels2=188,93,0,255,138,138,188,255" },
	{ "a_picture_of_one_colour_is_that_colour", "row.gltf", BESIDE("{'name':'half','pbrMetallicRoughness':{"
		"'baseColorFactor':[0.5,0.5,0.5,1]," TEXTURE "}},{'name':'moss','pbrMetallicRoughness':{" TEXTURE "}}",
		"moss.png"), .wanted = "images=0|image1=-1|rgb0=64,87,27|rgb1=90,120,40" },
	{ "a_texture_cut_out_here_is_opaque_there", "row.gltf", LEAF_BARK_VEIL("0.6", "cut.png"),
		.wanted = "images=3|cut0=1|cut1=0|cut2=1|texels0=9,9,9,255,8,8,8,180,7,7,7,0|"
		"texels1=9,9,9,255,8,8,8,255,7,7,7,255|texels2=9,9,9,153,8,8,8,108,7,7,7,0" },
	/* 0.4 of 1 is below 0.5 everywhere */
	{ "alpha_that_cuts_nothing_out_makes_no_other_image", "row.gltf", LEAF_BARK_VEIL("0.4", "uncut.png"),
		.wanted = "images=1|cut0=0|texels0=9,9,9,255,8,8,8,255|image1=0|material1=bark|clear=1" },
	/* 4 x 1 pixels, the first (200, 0, 0) at alpha 128 */
	{ "a_webp_texture_that_gltf_requires_is_read", "webp.gltf", GLTF(",'extensionsUsed':['EXT_texture_webp'],"
		"'extensionsRequired':['EXT_texture_webp'],'materials':[{'name':'g','alphaMode':'BLEND',"
		"'pbrMetallicRoughness':{" TEXTURE "}}],'textures':[{'extensions':{'EXT_texture_webp':{'source':0}}}],"
		"'images':[{'mimeType':'image/webp','uri':'data:image/webp;base64,"
		"UklGRjIAAABXRUJQVlA4TCUAAAAvAwAAEB8gECD43/FnQyyYzP+MKqxBEQgQ1p05E8DsrKHGEf0PAA=='}]"),
		.wanted = "images=1|cut0=1|material0=g|texels0=199" },
	/* the second: the lower left quadrant, a quarter turn: the example of the extension's specification */
	{ "texture_transforms_turn_about_the_images_corner", "turn.gltf", TURNED("'offset':[0.25,0.125],'scale':[0.5,2]"),
		.wanted = "at=-0.5,0,0,0.25,0.125|at=0.5,0,0,0.75,0.125|at=-0.5,0,1,0.25,2.125" },
	{ NULL, "turn.gltf", TURNED("'offset':[0,1],'rotation':1.57079632679,'scale':[0.5,0.5]"),
		.wanted = "at=-0.5,0,0,0,1|at=0.5,0,0,0,0.5|at=-0.5,0,1,0.5,1" },
};

UNIT_TEST(colours_and_textures_mean_what_the_file_meant)
{
	for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++)
		assert_good(eco_png_write(&(struct eco_pixels){ pictures[i].width, pictures[i].height, 4, pictures[i].rgba },
			input_path(TEST_FOLDER, pictures[i].name), &cause));
	expect_models(TEST_FOLDER, models, sizeof models / sizeof *models);
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
	import_file(input_text(TEST_FOLDER, "ramp.obj", text), NULL);
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

