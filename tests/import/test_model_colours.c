/* Colours and textures of models mean what the file meant: OBJ with MTL, and glTF. */

#include "ecofiles/format/image.h"
#include "ecofiles/import/model/import_model.h"
#include "ecofiles/format/model.h"
#include "tests/support/model_try.h"

#define TEST_FOLDER "model-colours"

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

UNIT_TEST(colours_and_textures_mean_what_the_file_meant)
{
	for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++)
		assert_good(eco_png_write(&(struct eco_pixels){ pictures[i].width, pictures[i].height, 4, pictures[i].rgba },
			input_path(TEST_FOLDER, pictures[i].name), &cause));
	expect_models(TEST_FOLDER, "tests/import/cases/model_colours.tsv");
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

