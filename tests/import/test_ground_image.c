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

/* Colours, of so many steps each; one band has four classes, one a quarter: 1 2 in the south, 3 4 in the
 * north. */
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

/* "at=x,y,r,g,b,a,most": the texel there differs by no more than `most` from that; colours of -1 are any.
 * "root=x,y,step": the corner and the texels of the whole. */
static void tell(const char *key, uint32_t number, const char *wanted, char *to, size_t size)
{
	double at[2] = { 0 };
	int colour[4] = { 0 }, most = 0, off = 0;
	if (strcmp(key, "root") == 0) {
		snprintf(to, size, "%g,%g,%g", tree.root.low[0], tree.root.low[1], tree.root.texel_m);
		return;
	}
	assert_int_equal(sscanf(wanted, "%lf,%lf,%d,%d,%d,%d,%d", &at[0], &at[1], &colour[0], &colour[1],
		&colour[2], &colour[3],
		&most), 7);
	const uint8_t *texel = texel_at(at[0], at[1]);
	assert_non_null(texel);
	for (int k = 0; k < 4; k++)
		off = colour[k] >= 0 && abs(texel[k] - colour[k]) > off ? abs(texel[k] - colour[k]) : off;
	if (off <= most)
		snprintf(to, size, "%s", wanted);
	else
		snprintf(to, size, "%g,%g,%u,%u,%u,%u", at[0], at[1], texel[0], texel[1], texel[2], texel[3]);
}

static struct eco_ground_class one_class[] = { { 1, { 9, 8, 7 }, false } },
	two_classes[] = { { 1, { 9, 8, 7 }, false }, { 4, { 0 }, true } },
	three_classes[] = { { 1, { 9, 8, 7 }, false }, { 2, { 9, 8, 7 }, false }, { 3, { 9, 8, 7 }, false } };

#define COLORS(path_) { .path = path_, .scene_crs = ZONE, .low = { 1, 1 }, .high = { 0, 0 } }
#define BYTES(name, side, crs_) { name, side, .bands = 3, .type = GDT_Byte, .crs = crs_ }
#define CLASSES(name, type_) { name, 300, .bands = 1, .type = type_, .crs = ZONE }
#define ANYWHERE .scene_crs = ZONE, .low = { 1, 1 }
#define PHOTO_PLACE .has_place = true, .corner = { WEST + 100, SOUTH + 612 }, .pixel = { 2, 2 }

/* Wanted: the image, or with "?" the words of a refusal. */
static const struct { const char *name; struct raster_file raster; double pixel_m; struct given given; const char *wanted; } cases[] = {
	{ "rasters_of_another_crs_are_warped", BYTES("zone33.tif", 100, ZONE), 2, { .scene_crs = "EPSG:25832",
		.low = { 1, 1 } },
		"at=50,150,62,187,-1,255,3" },
	/* alpha is the file's, whatever the bands hold: clear in the east */
	{ "a_fourth_band_is_alpha", { "rgba.tif", 300, .bands = 4, .type = GDT_Byte, .crs = ZONE }, 1,
		{ ANYWHERE },
		"at=75,150,62,125,128,255,2|at=225,150,-1,-1,-1,0,0" },
	{ NULL, { "rgba16.tif", 300, .bands = 4, .type = GDT_UInt16, .crs = ZONE, .of = 257 }, 1,
		{ ANYWHERE, .source = { .has_range = true, .range = { 0, 65535 } } },
		"at=75,150,62,125,128,255,2|at=225,150,-1,-1,-1,0,0" },
	/* black and white are said, or guessed of all bands together and noted: 250 x 40, less a
	 * two-hundredth */
	{ "numbers_that_are_no_bytes_have_a_black_and_a_white",
		{ "deep.tif", 300, .bands = 3, .type = GDT_UInt16, .crs = ZONE, .of = 40 }, 1, { ANYWHERE },
		"~its bands hold UInt16|~for black and 99|at=150,75,127,63,131,-1,4" },
	{ NULL, { "deep.tif", 300, .bands = 3, .type = GDT_UInt16, .crs = ZONE, .of = 40 }, 1,
		{ ANYWHERE, .source = { .has_range = true, .range = { 0, 255 * 40 } } },
			"!\n|at=150,75,125,62,128,-1,1" },
	{ "an_image_that_does_not_reach_the_plants_is_said_to", BYTES("small.tif", 64, ZONE), 1,
		{ .scene_crs = ZONE, .low = { 10, 10 }, .high = { 104, 64 } }, "~does not reach all plants" },
	{ NULL, BYTES("small.tif", 64, ZONE), 1, { .scene_crs = ZONE, .low = { 5000, 5000 }, .high = { 5100,
		5100 } },
		"~does not reach any plants" },
	{ NULL, BYTES("small.tif", 64, ZONE), 1, { .scene_crs = ZONE, .low = { 5, 5 }, .high = { 60, 60 } },
		"!\n" },
	{ "classes_have_the_colours_of_the_file_or_of_the_scene",
		{ "palette.tif", 300, .bands = 1, .type = GDT_Byte, .crs = ZONE, .palette = true }, 1,
			{ ANYWHERE },
		"at=75,75,50,10,20,255,0|at=225,75,100,10,20,-1,0|at=75,225,150,10,20,-1,0|at=225,225,200,10,20,-1,0" },
	{ NULL, { "palette.tif", 300, .bands = 1, .type = GDT_Byte, .crs = ZONE, .palette = true }, 1,
		{ ANYWHERE, .source = { .classes = two_classes, .class_count = 2 } },
		"at=75,75,9,-1,-1,-1,0|at=225,75,100,-1,-1,-1,0|at=225,225,-1,-1,-1,0,0" },
	{ "nodata_is_clear", { "hole.tif", 300, .bands = 1, .type = GDT_Int16, .crs = ZONE,
		.has_nodata = true, .nodata = 4 }, 1,
		{ ANYWHERE, .source = { .classes = three_classes, .class_count = 3 } },
		"at=225,225,-1,-1,-1,0,0|at=75,75,-1,-1,-1,255,0" },
	{ NULL, CLASSES("hole2.tif", GDT_Int16), 1,
		{ ANYWHERE, .source = { .classes = three_classes, .class_count = 3, .has_nodata = true,
			.nodata = 4 } },
		"at=225,225,-1,-1,-1,0,0" },
	{ "a_picture_without_coordinates_lies_where_the_scene_says", BYTES("photo.tif", 256, NULL), 0,
		{ ANYWHERE, .source = { .crs = (char *)ZONE, PHOTO_PLACE } },
		"root=100,100,2|at=228,484,62,187,-1,-1,2" },
	{ "what_lacks_is_said", BYTES("no_crs.tif", 64, NULL), 1, { ANYWHERE },
		"?the file has no CRS; say it in the scene: "
		"\"ground\": {\"image\": {\"file\": ..., \"crs\": \"EPSG:32632\"}}" },
	{ NULL, BYTES("no_crs.tif", 64, NULL), 1, { ANYWHERE, .source = { .crs = (char *)ZONE } },
		"root=0,0,1" },
	{ NULL, BYTES("good.tif", 64, ZONE), 1, { .low = { 1, 1 } }, "?but the scene has no CRS" },
	{ NULL, { "height.tif", 64, .bands = 1, .type = GDT_Float32, .crs = ZONE }, 1, { ANYWHERE },
		"?it has one band of Float32: heights, classes or grey?" },
	{ NULL, CLASSES("unknown.tif", GDT_Byte), 1, { ANYWHERE, .source = { .classes = one_class,
		.class_count = 1 } },
		"?has no colour; add it to the scene's" },
	{ NULL, BYTES("bands.tif", 64, ZONE), 1, { ANYWHERE, .source = { .classes = one_class,
		.class_count = 1 } },
		"?it has 3 bands; a raster of classes has one" },
	{ NULL, BYTES("lost.tif", 64, NULL), 0, { .low = { 1, 1 } },
		"?it does not say where it lies; add to the image" },
};

UNIT_TEST(rasters_become_images_or_questions)
{
	const char *name = "";
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct given g = cases[i].given;
		name = cases[i].name ? cases[i].name : name;
		print_message("# %s, %s\n", name, cases[i].wanted);
		g.path = make(cases[i].raster, cases[i].pixel_m);
		if (*cases[i].wanted == '?') {
			fails(g, cases[i].wanted + 1);
			continue;
		}
		read_tree(g);
		expect_told(cases[i].wanted, tell);
		/* a mean of colours of classes, never of their numbers */
		for (uint32_t k = 0; k < tree.count && cases[i].raster.palette && !g.source.classes; k++)
			for (const uint8_t *t =
				tree.leaves[k].rgba; t < tree.leaves[k].rgba + ECO_GROUND_IMAGE_BYTES; t += 4)
				assert_true(!t[3] || (t[1] == 10 && t[2] == 20));
	}
}

UNIT_TEST(colours_lie_where_they_lie_in_the_raster_and_fade_at_its_border)
{
	read_tree((struct given)COLORS(make((struct raster_file){ "rgb.tif", 600, .bands = 3,
		.type = GDT_Byte, .crs = ZONE }, 0.5)));
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

/* Far from the plants no view resolves them; and so many squares are the most. */
UNIT_TEST(texels_are_wider_where_no_plant_is_near)
{
	struct given g =
		COLORS(make((struct raster_file){ "wide.tif", 4096, .bands = 3, .type = GDT_Byte,
		.crs = ZONE }, 1));
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
