/* Images of the ground: the tree of squares, colours and classes as they come, and what rasters lack. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/import/ground/ground_image_import.h"
#include "tests/support/model_try.h"
#include "tests/support/raster_files.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
#define ZONE "EPSG:32632"
#define WEST 691000.0
#define SOUTH 5334000.0

/* ---- Rasters ---- */

/* Bands k of the pixel that far east and north, 0 to 1. */
static int value_at(double east, double north, int band)
{
	if (band == 0)
		return (int)(250 * east);
	return band == 1 ? (int)(250 * north) : band == 2 ? 128 : east < 0.5 ? 255 : 0;
}

/* Colours, of so many steps each; one band has four classes, one a quarter: 1 2 in the south, 3 4 in the north. */
static double sample_at(const struct raster_file *r, int x, int y, int band)
{
	double east = (x + 0.5) / r->columns, north = 1 - (y + 0.5) / r->rows;
	return r->bands == 1 ? 1 + (east >= 0.5) + 2 * (north >= 0.5) : value_at(east, north, band) * r->of;
}

/* A square raster with samples of pixel_m; 0: it does not say where it lies. */
static const char *make(struct raster_file r, double pixel_m)
{
	const double place[6] = { WEST, pixel_m, 0, SOUTH + r.columns * pixel_m, 0, -pixel_m };
	r.rows = r.columns;
	r.sample = sample_at;
	r.of = r.of ? r.of : 1;
	r.place = pixel_m > 0 ? place : NULL;
	return raster_file_write("image", &r);
}

/* ---- Trees ---- */

/* All squares of a tree that are not split. */
struct leaf { double low[2], texel_m; uint8_t *rgba; };
struct tree { struct leaf leaves[700]; uint32_t count, depth; struct eco_ground_image_tile root; };

static enum eco_code read_square(struct eco_ground_image_reader *reader, struct tree *tree,
	struct eco_list list, uint32_t depth, struct eco_error *error)
{
	struct eco_ground_image_tile tile = { .rgba = malloc(ECO_GROUND_IMAGE_BYTES) };
	enum eco_code code = eco_ground_image_next(reader, &tile, error);
	if (!depth && !code) {
		tree->root = tile;
		memcpy(list.grid_origin, tile.low, sizeof tile.low);
		list.grid_step[0] = list.grid_step[1] = tile.texel_m;
	}
	tree->depth = depth > tree->depth ? depth : tree->depth;
	if (code || tile.split)
		free(tile.rgba);
	for (uint32_t q = 0; q < 4 && tile.split && !code; q++) {
		struct eco_list quarter = list;
		eco_ground_image_quarter(&quarter, q);
		code = read_square(reader, tree, quarter, depth + 1, error);
	}
	if (!code && !tile.split) {
		assert_true(tree->count < 700);
		tree->leaves[tree->count++] = (struct leaf){ { list.grid_origin[0], list.grid_origin[1] },
			list.grid_step[0], tile.rgba };
	}
	return code;
}

struct given {
	struct eco_ground_image_source source;
	const char *path, *scene_crs;
	double low[2], high[2];
	uint32_t tiles_max;
};

static struct eco_ground_image_options options_of(struct given *g, char **paths)
{
	paths[0] = (char *)g->path;
	g->source.files = paths;
	g->source.file_count = 1;
	return (struct eco_ground_image_options){ .source = &g->source,
		.scene_crs = g->scene_crs,
		.origin = { WEST, SOUTH, 0 },
		.low = { g->low[0], g->low[1] },
		.high = { g->high[0], g->high[1] },
		.tiles_max = g->tiles_max,
		.warn = import_note };
}

static void free_tree(struct tree *tree)
{
	for (uint32_t i = 0; i < tree->count; i++)
		free(tree->leaves[i].rgba);
	*tree = (struct tree){ .count = 0 };
}

/* The tree that the test looks at; reading the next frees it. */
static struct tree tree;

static void read_tree(struct given g)
{
	struct eco_error error = { .code = ECO_OK }, verdict = { .code = ECO_OK };
	char *paths[1];
	struct eco_ground_image_options options = options_of(&g, paths);
	struct eco_ground_image_reader *reader;
	free_tree(&tree);
	import_said[0] = 0;
	assert_ok(eco_ground_image_open(&reader, &options, &error), error);
	enum eco_code code =
		read_square(reader, &tree, (struct eco_list){ .kind = ECO_LIST_GROUND_IMAGE }, 0, &error);
	assert_ok(eco_ground_image_close(reader, &verdict), verdict);
	assert_ok(code, error);
}

/* The texel at a place; NULL: no square holds it. */
static const uint8_t *texel_at(double x, double y)
{
	for (uint32_t i = 0; i < tree.count; i++) {
		const struct leaf *leaf = &tree.leaves[i];
		double column = (x - leaf->low[0]) / leaf->texel_m,
		       row = SIDE - (y - leaf->low[1]) / leaf->texel_m;
		if (column >= 0 && column < SIDE && row >= 0 && row < SIDE)
			return leaf->rgba + 4 * ((size_t)row * SIDE + (size_t)column);
	}
	return NULL;
}

static void fails(struct given g, const char *says)
{
	struct eco_error error = { .code = ECO_OK }, missed = { .code = ECO_OK };
	char *paths[1];
	struct eco_ground_image_options options = options_of(&g, paths);
	struct eco_ground_image_reader *reader;
	free_tree(&tree);
	assert_ok(eco_ground_image_open(&reader, &options, &error), error);
	read_square(reader, &tree, (struct eco_list){ .kind = 0 }, 0, &missed);
	assert_int_not_equal(eco_ground_image_close(reader, &error), ECO_OK);
	if (!strstr(error.text, says))
		fail_msg("%s\n  wanted ... %s", error.text, says);
}

/* ---- Tests ---- */

#define COLORS(path_) { .path = path_, .scene_crs = "EPSG:32632", .low = { 1, 1 }, .high = { 0, 0 } }

UNIT_TEST(colours_lie_where_they_lie_in_the_raster_and_fade_at_its_border)
{
	read_tree((struct given)COLORS(make((struct raster_file){ "rgb.tif", 600, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 0.5)));
	assert_true(tree.root.low[0] == 0 && tree.root.low[1] == 0 && tree.root.texel_m == 2);
	assert_int_equal(tree.depth, 2);
	for (int i = 0; i < 100; i++) {
		double east = (i % 10 + 0.5) / 10, north = (i / 10 + 0.5) / 10;
		const uint8_t *texel = texel_at(300 * east, 300 * north);
		assert_non_null(texel);
		assert_true(abs(texel[0] - value_at(east, north, 0)) <= 2 &&
			abs(texel[1] - value_at(east, north, 1)) <= 2 && texel[2] == 128);
		bool inside = fabs(east - 0.5) < 0.4 && fabs(north - 0.5) < 0.4;
		assert_true(!inside || texel[3] == 255);
	}
	uint8_t before = 0;
	for (double y = 299.9; y > 270; y -= 0.5) {        /* from the northern border inwards */
		uint8_t alpha = texel_at(150, y)[3];
		assert_true(alpha >= before && alpha - before < 40);
		before = alpha;
	}
	assert_int_equal(before, 255);
	assert_int_equal(texel_at(150, 320)[3], 0);
}

UNIT_TEST(rasters_of_another_crs_are_warped)
{
	read_tree((struct given){ .path = make((struct raster_file){ "zone33.tif", 100, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 2), .scene_crs = "EPSG:25832", .low = { 1, 1 } });
	const uint8_t *texel = texel_at(50, 150);
	assert_true(abs(texel[0] - 62) <= 3 && abs(texel[1] - 187) <= 3 && texel[3] == 255);
}

/* Alpha is the file's, whatever the bands hold: clear in the east. */
UNIT_TEST(a_fourth_band_is_alpha)
{
	for (int deep = 0; deep < 2; deep++) {
		struct given g = COLORS(make((struct raster_file){ deep ? "rgba16.tif" : "rgba.tif", 300, .bands = 4,
			.type = deep ? GDT_UInt16 : GDT_Byte, .crs = ZONE, .of = deep ? 257 : 1 }, 1));
		g.source.has_range = deep;
		g.source.range[1] = 65535;
		read_tree(g);
		const uint8_t *west = texel_at(75, 150), *east = texel_at(225, 150);
		assert_true(abs(west[0] - 62) <= 2 && abs(west[1] - 125) <= 2 && west[2] == 128 &&
			west[3] == 255);
		assert_int_equal(east[3], 0);
	}
}

/* 16 bits: black and white are said, or guessed of all bands together and noted. */
UNIT_TEST(numbers_that_are_no_bytes_have_a_black_and_a_white)
{
	struct given g = COLORS(make((struct raster_file){ "deep.tif", 300, .bands = 3, .type = GDT_UInt16, .crs = ZONE, .of = 40 }, 1));
	read_tree(g);
	import_says("its bands hold UInt16");
	import_says("for black and 99");       /* 250 x 40, less a two-hundredth */
	const uint8_t *texel = texel_at(150, 75);
	assert_true(abs(texel[0] - 127) <= 4 && abs(texel[1] - 63) <= 4 && abs(texel[2] - 131) <= 4);
	g.source.has_range = true;
	g.source.range[1] = 255 * 40;
	read_tree(g);
	assert_string_equal(import_said, "");
	texel = texel_at(150, 75);
	assert_true(abs(texel[0] - 125) <= 1 && abs(texel[1] - 62) <= 1 && texel[2] == 128);
}

/* Plants beyond an image are said. */
UNIT_TEST(an_image_that_does_not_reach_the_plants_is_said_to)
{
	struct given g =
		COLORS(make((struct raster_file){ "small.tif", 64, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 1));
	g.low[0] = g.low[1] = 10;
	g.high[0] = 104, g.high[1] = 64;
	read_tree(g);
	import_says("does not reach all plants");
	g.low[0] = g.low[1] = 5000;
	g.high[0] = g.high[1] = 5100;
	read_tree(g);
	import_says("does not reach any plants");
	g.low[0] = g.low[1] = 5;
	g.high[0] = g.high[1] = 60;
	read_tree(g);
	assert_string_equal(import_said, "");
}

/* Far from the plants no view resolves them; and so many squares are the most. */
UNIT_TEST(texels_are_wider_where_no_plant_is_near)
{
	struct given g =
		COLORS(make((struct raster_file){ "wide.tif", 4096, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 1));
	g.low[0] = g.low[1] = 10;
	g.high[0] = g.high[1] = 20;
	read_tree(g);
	uint32_t fine = 0, coarse = 0;
	for (uint32_t i = 0; i < tree.count; i++) {
		const struct leaf *leaf = &tree.leaves[i];
		double away = fmax(fmax(leaf->low[0], leaf->low[1]) - 20, 1);
		assert_true(leaf->texel_m <= fmax(1, 2 * 0.00077 * away));
		fine += leaf->texel_m == 1;
		coarse += leaf->texel_m > 1;
	}
	assert_true(fine > 16 && coarse > 0);
	g.tiles_max = 16;
	read_tree(g);
	assert_true(tree.count <= 16);
	g.tiles_max = 0;
	g.source.texel_m = 8;
	read_tree(g);
	assert_int_equal(tree.count, 4);
}

UNIT_TEST(classes_have_the_colours_of_the_file_or_of_the_scene)
{
	struct eco_ground_class classes[] = { { 1, { 9, 8, 7 }, false }, { 4, { 0 }, true } };
	struct given g = COLORS(make((struct raster_file){ "palette.tif", 300, .bands = 1, .type = GDT_Byte, .crs = ZONE, .palette = true }, 1));
	read_tree(g);
	assert_int_equal(texel_at(75, 75)[0], 50);
	assert_int_equal(texel_at(225, 75)[0], 100);
	assert_int_equal(texel_at(75, 225)[0], 150);
	assert_int_equal(texel_at(225, 225)[0], 200);
	for (uint32_t i = 0; i < tree.count; i++) /* a mean of colours of classes, never of their numbers */
		for (size_t t = 0; t < ECO_GROUND_IMAGE_BYTES; t += 4) {
			const uint8_t *texel = tree.leaves[i].rgba + t;
			assert_true(!texel[3] || (texel[1] == 10 && texel[2] == 20));
		}
	g.source.classes = classes;
	g.source.class_count = 2;
	read_tree(g);
	assert_int_equal(texel_at(75, 75)[0], 9);
	assert_int_equal(texel_at(225, 75)[0], 100);
	assert_int_equal(texel_at(225, 225)[3], 0);
}

UNIT_TEST(nodata_is_clear)
{
	struct eco_ground_class classes[] = { { 1, { 9, 8, 7 }, false }, { 2, { 9, 8, 7 }, false },
		{ 3, { 9, 8, 7 }, false } };
	struct given g = COLORS(make((struct raster_file){ "hole.tif", 300, .bands = 1, .type = GDT_Int16, .crs = ZONE, .has_nodata = true, .nodata = 4 }, 1));
	g.source.classes = classes;
	g.source.class_count = 3;
	read_tree(g);
	assert_int_equal(texel_at(225, 225)[3], 0);
	assert_int_equal(texel_at(75, 75)[3], 255);
	g.path =
		make((struct raster_file){ "hole2.tif", 300, .bands = 1, .type = GDT_Int16, .crs = ZONE }, 1);
	g.source.has_nodata = true;
	g.source.nodata = 4;
	read_tree(g);
	assert_int_equal(texel_at(225, 225)[3], 0);
}

UNIT_TEST(what_lacks_is_said)
{
	static const struct { struct raster_file raster; double pixel_m; const char *scene_crs; uint32_t classes; const char *says;
	} cases[] = {
		{ { "no_crs.tif", 64, .bands = 3, .type = GDT_Byte }, 1, ZONE, 0, "the file has no CRS; say it in the scene: "
			"\"ground\": {\"image\": {\"file\": ..., \"crs\": \"EPSG:32632\"}}" },
		{ { "good.tif", 64, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 1, NULL, 0, "but the scene has no CRS" },
		{ { "height.tif", 64, .bands = 1, .type = GDT_Float32, .crs = ZONE }, 1, ZONE, 0,
			"it has one band of Float32: heights, classes or grey?" },
		{ { "unknown.tif", 300, .bands = 1, .type = GDT_Byte, .crs = ZONE }, 1, ZONE, 1,
			"has no colour; add it to the scene's" },
		{ { "bands.tif", 64, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 1, ZONE, 1,
			"it has 3 bands; a raster of classes has one" },
		{ { "lost.tif", 64, .bands = 3, .type = GDT_Byte }, 0, NULL, 0,
			"it does not say where it lies; add to the image" },
	};
	struct eco_ground_class classes[] = { { 1, { 9, 8, 7 }, false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct given g = COLORS(make(cases[i].raster, cases[i].pixel_m));
		g.scene_crs = cases[i].scene_crs;
		g.source.classes = classes;
		g.source.class_count = cases[i].classes;
		fails(g, cases[i].says);
	}
	struct given g = COLORS("build/tmp/image/no_crs.tif");
	g.source.crs = (char *)ZONE;
	read_tree(g);
}

/* A picture without coordinates, put where the scene says. */
UNIT_TEST(a_picture_without_coordinates_lies_where_the_scene_says)
{
	struct given g = COLORS(make((struct raster_file){ "photo.tif", 256, .bands = 3, .type = GDT_Byte }, 0));
	g.source.crs = (char *)"EPSG:32632";
	g.source.has_place = true;
	g.source.corner[0] = WEST + 100;
	g.source.corner[1] = SOUTH + 612;
	g.source.pixel[0] = g.source.pixel[1] = 2;
	read_tree(g);
	assert_true(tree.root.low[0] == 100 && tree.root.low[1] == 100 && tree.root.texel_m == 2);
	assert_true(abs(texel_at(100 + 128, 100 + 384)[0] - 62) <= 2);
	assert_true(abs(texel_at(100 + 128, 100 + 384)[1] - 187) <= 2);
}
