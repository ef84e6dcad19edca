/* Images of the ground: the tree of squares, colours and classes as they come, and what rasters lack. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/scene/scene.h"
#include "tests/support/cases.h"
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
static void make(struct raster_file r, double pixel_m)
{
	const double place[6] = { WEST, pixel_m, 0, SOUTH + r.columns * pixel_m, 0, -pixel_m };
	r.rows = r.columns;
	r.sample = sample_at;
	r.of = r.of ? r.of : 1;
	r.place = pixel_m > 0 ? place : NULL;
	raster_file_write("image", &r);
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

static void free_tree(struct tree *tree)
{
	for (uint32_t i = 0; i < tree->count; i++)
		free(tree->leaves[i].rgba);
	*tree = (struct tree){ .count = 0 };
}

/* The tree that the test looks at; reading the next frees it. */
static struct tree tree;

/* Reads the image of a scene with these members, and plants in a box. */
static enum eco_code import(const char *scene, const char *box, uint32_t tiles_max)
{
	char text[1000];
	struct eco_source source;
	struct eco_ground_image_options options = { .source = &source.ground_image,
		.origin = { WEST, SOUTH, 0 }, .tiles_max = tiles_max, .warn = import_note };
	struct eco_ground_image_reader *reader;
	struct eco_error missed = { .code = ECO_OK };
	snprintf(text, sizeof text, "{%s, \"origin\": [%f, %f, 0], \"plants\": {}}", scene, WEST, SOUTH);
	assert_good(eco_source_parse(&source, text, strlen(text), "build/tmp/image/scene.json", false,
		&cause));
	assert_int_equal(sscanf(box, "%lf %lf %lf %lf", &options.low[0], &options.low[1],
		&options.high[0], &options.high[1]), 4);
	options.scene_crs = source.crs;
	free_tree(&tree);
	import_said[0] = 0;
	assert_good(eco_ground_image_open(&reader, &options, &cause));
	enum eco_code code = read_square(reader, &tree, (struct eco_list){ .kind = ECO_LIST_GROUND_IMAGE }, 0,
		&missed), verdict = eco_ground_image_close(reader, &cause);
	eco_source_free(&source);
	assert_true(verdict || !code);
	return verdict;
}

static void read_tree(const char *scene, const char *box, uint32_t tiles_max)
{
	assert_ok(import(scene, box, tiles_max), cause);
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

UNIT_TEST(rasters_become_images_or_questions)
{
	struct image_case { const char *name, *raster, *scene, *box, *wanted; };
	uint32_t count;
	const struct image_case *rows = cases_read("tests/import/cases/ground_image.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct raster_file r = { .palette = strstr(rows[i].raster, " palette") };
		char file[32], type[16], crs[16];
		double pixel_m;
		const char *nodata = strstr(rows[i].raster, " nodata="), *of = strstr(rows[i].raster, " of=");
		print_message("# %s, %s\n", *rows[i].name ? rows[i].name : "...", rows[i].wanted);
		assert_int_equal(sscanf(rows[i].raster, "%31s %d %d %15s %15s %lf", file, &r.columns, &r.bands,
			type, crs, &pixel_m), 6);
		r.name = file;
		r.type = GDALGetDataTypeByName(type);
		r.crs = *crs == '-' ? NULL : crs;
		r.has_nodata = nodata;
		r.nodata = nodata ? atof(nodata + 8) : 0;
		r.of = of ? atof(of + 4) : 0;
		make(r, pixel_m);
		if (*rows[i].wanted == '?') {
			assert_code(import(rows[i].scene, rows[i].box, 0), ECO_CODE_COUNT, rows[i].wanted + 1);
			continue;
		}
		read_tree(rows[i].scene, rows[i].box, 0);
		expect_told(rows[i].wanted, tell);
		/* a mean of colours of classes, never of their numbers */
		for (uint32_t k = 0; k < tree.count && r.palette && !strstr(rows[i].scene, "classes"); k++)
			for (const uint8_t *t =
				tree.leaves[k].rgba; t < tree.leaves[k].rgba + ECO_GROUND_IMAGE_BYTES; t += 4)
				assert_true(!t[3] || (t[1] == 10 && t[2] == 20));
	}
}

#define IMAGE(members) "\"crs\": \"" ZONE "\", \"ground\": {\"image\": {" members "}}"

UNIT_TEST(colours_lie_where_they_lie_in_the_raster_and_fade_at_its_border)
{
	make((struct raster_file){ "rgb.tif", 600, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 0.5);
	read_tree(IMAGE("\"file\": \"rgb.tif\""), "1 1 0 0", 0);
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
	static const char scene[] = IMAGE("\"file\": \"wide.tif\""), box[] = "10 10 20 20";
	make((struct raster_file){ "wide.tif", 4096, .bands = 3, .type = GDT_Byte, .crs = ZONE }, 1);
	read_tree(scene, box, 0);
	uint32_t fine = 0, coarse = 0;
	for (uint32_t i = 0; i < tree.count; i++) {
		const struct leaf *leaf = &tree.leaves[i];
		double away = fmax(fmax(leaf->low[0], leaf->low[1]) - 20, 1);
		assert_true(leaf->texel_m <= fmax(1, 2 * 0.00077 * away));
		fine += leaf->texel_m == 1;
		coarse += leaf->texel_m > 1;
	}
	assert_true(fine > 16 && coarse > 0);
	read_tree(scene, box, 16);
	assert_true(tree.count <= 16);
	read_tree(IMAGE("\"file\": \"wide.tif\", \"texel_m\": 8"), box, 0);
	assert_int_equal(tree.count, 4);
}
