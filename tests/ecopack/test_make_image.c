/* The ground's image from the scene to pictures: where it is seen, by OpenGL and in software; on the map; in 3D Tiles. */
#include <glob.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gl.h"
#include "client-min/view_reference.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/map.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/image.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/serve/served.h"
#include "tests/support/unit_test.h"

#define SIDE 512                         /* texels of the photo, of a quarter of a metre */
#define PIXELS 120
#define TOLERANCE 2                      /* bytes, between OpenGL and software */

static void color_at(double east, double north, uint8_t rgb[3])
{
	static const uint8_t red[3] = { 200, 40, 30 }, blue[3] = { 30, 50, 200 }, white[3] = { 230, 230, 230 };
	memcpy(rgb, east < 0 ? red : north > 0 ? white : blue, 3);
}

/* The west red, the south-east blue, the north-east white. */
static void write_photo(void)
{
	FREED_MEMORY uint8_t *rgb = malloc(3 * SIDE * SIDE);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			color_at(x - SIDE / 2 + 0.5, SIDE / 2 - 0.5 - y, rgb + 3 * (y * SIDE + x));
	assert_int_equal(eco_png_write(&(struct eco_pixels){ SIDE, SIDE, 3, rgb }, in_root("photo.png"), NULL), ECO_OK);
}

/* Reds are the west's, and so on: what is lit and seen through air is not the texel's colour any more. */
static void is_seen(const uint8_t *rgb, double east, double north)
{
	int r = rgb[0], g = rgb[1], b = rgb[2];
	bool good = east < 0 ? r > 2 * b && r > 2 * g : north > 0 ? abs(r - b) < 40 && g > 90 : b > 2 * r;
	if (!good)
		fail_msg("%.1f, %.1f shows %d %d %d", east, north, r, g, b);
}

UNIT_TEST(colours_are_seen_where_they_lie_by_opengl_and_in_software)
{
	const struct eco_view view = { .eye = { 0, 0, 150 }, .target = { 0, 0, 0 }, .up = { 0, 1, 0 }, .fov_y_deg = 40,
		.width = PIXELS, .height = PIXELS };
	struct served seen;
	struct view_picture soft, hard;
	struct view_gl *gl = NULL;
	struct eco_error error = { 0 };
	uint32_t ground = 0;
	served_open(&seen, "photo.json", "photo.eco");
	seen.vertices = 100000;
	served_look(&seen, &view, 1);
	assert_true(seen.selection.image.count > 0);
	assert_int_equal(view_picture_init(&soft, PIXELS, PIXELS, NULL), ECO_OK);
	assert_int_equal(view_picture_init(&hard, PIXELS, PIXELS, NULL), ECO_OK);
	assert_int_equal(view_reference_draw(&(struct view_draw_job){ seen.held, &seen.selection, &seen.eye, 0.1, 2,
		NULL, VIEW_TINT_NONE, 1, false }, &soft, NULL), ECO_OK);
	if (view_gl_open(&gl, &(struct view_gl_options){ PIXELS, PIXELS }, &error))
		print_message("only in software: %s\n", error.text);
	else
		assert_ok(view_gl_draw(gl, &(struct view_draw_job){ seen.held, &seen.selection, &seen.eye, 0.1,
			2, NULL, VIEW_TINT_NONE, 1, false }, &hard, &error), error);
	for (uint32_t i = 0; i < PIXELS * PIXELS; i++) {
		double half = 150 * tan(20 * M_PI / 180), east = ((i % PIXELS + 0.5) / PIXELS * 2 - 1) * half,
			north = (1 - (i / PIXELS + 0.5) / PIXELS * 2) * half;
		if (soft.cover[i] || (gl && hard.cover[i]))
			continue;
		if (fabs(east) > 2 && (east < 0 || fabs(north) > 2))
			is_seen(soft.rgb + 3 * i, east, north);
		for (int k = 0; k < 3 && gl; k++)
			assert_true(abs(soft.rgb[3 * i + (uint32_t)k] - hard.rgb[3 * i + (uint32_t)k]) <= TOLERANCE);
		ground++;
	}
	assert_true(ground > PIXELS * PIXELS / 2);
	view_gl_close(gl);
	view_picture_free(&soft);
	view_picture_free(&hard);
	served_close(&seen);
}

/* ---- Bytes ---- */

static void make(const char *scene, const char *pack, uint32_t jobs, bool draft)
{
	assert_good(make_pack(&(struct make_options){ .scene = in_root(scene), .pack = in_root(pack), .jobs = jobs,
		.draft = draft, .order = LOD_ORDER_COMBINED }, &cause));
}

UNIT_TEST(the_pack_is_the_same_with_any_number_of_threads)
{
	make("photo.json", "one.eco", 1, false);
	make("photo.json", "four.eco", 4, false);
	assert_true(files_alike(in_root("one.eco"), in_root("four.eco")));
}

/* A road and a pond alone: their squares are split, the plain between them is not; the same by one thread and by four. */
UNIT_TEST(drawings_are_images_whose_squares_are_few)
{
	struct eco_pack *pack;
	make("draw.json", "draw1.eco", 1, false);
	make("draw.json", "draw4.eco", 4, false);
	assert_true(files_alike(in_root("draw1.eco"), in_root("draw4.eco")));
	assert_good(eco_pack_open(&pack, in_root("draw1.eco"), &cause));
	assert_true(pack->scene.ground_image_count > 8);
	uint32_t leaves = 0, fine = 0;
	double root = pack->scene.lists[pack->scene.ground_images[0].list].grid_step[0];
	for (uint32_t i = 0; i < pack->scene.ground_image_count; i++)
		if (!pack->scene.ground_images[i].child_first) {
			leaves++;
			fine += pack->scene.lists[pack->scene.ground_images[i].list].grid_step[0] == 0.25;
		}
	double squares = root / 0.25 * root / 0.25;
	assert_true(fine > 4 && leaves < 0.7 * squares);
	eco_pack_close(pack);
}

/* ---- The map and 3D Tiles ---- */

UNIT_TEST(the_map_shows_it)
{
	struct eco_error error = { 0 };
	FREED(map) m = { .error = &error };
	assert_ok(map_gather(&m, in_root("photo.json")), error);
	assert_ok(map_write(&m, in_root("map.png"), 200), error);
	assert_non_null(m.image);
	for (uint32_t y = 20; y < 180; y += 20)
		for (uint32_t x = 20; x < 180; x += 20) {
			double east = m.view.low[0] + (x + 0.5) / m.scale, north = m.view.high[1] - (y + 0.5) / m.scale;
			uint8_t wanted[3];
			const uint8_t *pixel = m.image + 4 * ((size_t)y * (uint32_t)m.width + x);
			color_at(east, north, wanted);
			if (fabs(east) > 2 && fabs(north) > 2)
				assert_true(pixel[3] == 255 && memcmp(pixel, wanted, 3) == 0);
		}
}

UNIT_TEST(tiles_of_ground_carry_it)
{
	struct eco_pack *pack;
	FREED(eco_image) image;
	size_t size;
	make("photo.json", "tiles.eco", 2, true);
	assert_good(eco_pack_open(&pack, in_root("tiles.eco"), &cause));
	assert_good(export_tiles(pack, in_root("tiles"), false, &cause));
	eco_pack_close(pack);
	FREED_MEMORY char *gltf = read_all("tiles/tiles/ground-0.gltf", &size);
	assert_non_null(strstr(gltf, "TEXCOORD_0"));
	assert_non_null(strstr(gltf, "\"ground-0.png\""));
	assert_null(strstr(gltf, "MASK"));
	uint8_t *png = (uint8_t *)read_all("tiles/tiles/ground-0.png", &size);
	assert_good(eco_image_read_memory(&image, png, size, "ground-0.png", &cause));
	assert_true(image.width >= 400 && image.height >= 400);
	for (uint32_t i = 0; i < 16; i++) {
		uint32_t x = image.width * (2 * (i % 4) + 1) / 8, y = image.height * (2 * (i / 4) + 1) / 8;
		uint8_t wanted[3];
		const uint8_t *texel = image.rgba + 4 * ((size_t)y * image.width + x);
		color_at((double)x - image.width / 2.0, image.height / 2.0 - y, wanted);
		for (int k = 0; k < 3; k++)
			assert_true(abs(texel[k] - wanted[k]) < 12);
	}
	free(png);
}

/* A house with a yard, a track and a pond: META, 3D Tiles and GeoJSON have them. */
UNIT_TEST(exports_carry_buildings_and_classes_of_the_ground)
{
	struct eco_pack *pack;
	size_t size, i, objects = 0;
	glob_t contents;
	json_t *feature;
	make("house.json", "house.eco", 1, false);
	assert_good(eco_pack_open(&pack, in_root("house.eco"), &cause));
	assert_true(pack->scene.needs & ECO_NEED_WATER);
	json_t *meta = json_loadb(pack->meta, pack->meta_size, 0, NULL), *drawn = json_object_get(meta, "drawn");
	assert_int_equal(json_array_size(drawn), 2);
	for (i = 0; i < 2; i++) {
		json_t *class = json_array_get(drawn, i);
		assert_string_equal(json_string_value(json_object_get(class, "name")), i ? "track" : "water");
		assert_int_equal(json_integer_value(json_object_get(class, "features")), 1);
	}
	json_decref(meta);
	assert_good(export_tiles(pack, in_root("house"), false, &cause));
	eco_pack_close(pack);
	assert_int_equal(glob(in_root("house/tiles/*.gltf"), 0, NULL, &contents), 0);
	for (i = 0; i < contents.gl_pathc; i++) {
		FREED_MEMORY char *gltf = (char *)file_read(contents.gl_pathv[i], &size);
		objects += memmem(gltf, size, "\"extras\":{\"object\":true}", 24) != NULL;
	}
	globfree(&contents);
	assert_true(objects > 0);
	char line[600];
	snprintf(line, sizeof line, "%s", in_root("house.json"));
	char *argv[] = { line, (char *)"-o", strdup(in_root("all.geojson")), (char *)"--quiet" };
	assert_good(main_command_map.run(4, argv, &cause));
	free(argv[2]);
	json_t *all = json_load_file(in_root("all.geojson"), 0, NULL), *features = json_object_get(all, "features");
	uint32_t seen[3] = { 0 };
	assert_int_equal(json_array_size(features), 5);
	json_array_foreach(features, i, feature) {
		json_t *own = json_object_get(feature, "properties"), *shape = json_object_get(feature, "geometry");
		const char *object = json_string_value(json_object_get(own, "object")), *class = json_string_value(json_object_get(own, "class"));
		const char *type = json_string_value(json_object_get(shape, "type"));
		seen[0] += !object && strcmp(type, "Point") == 0;
		seen[1] += object && class && strcmp(object, "ground") == 0 && strstr(type, strcmp(class, "track") ? "Polygon" : "LineString");
		if (object && strcmp(object, "building") == 0) {
			seen[2]++;
			assert_int_equal(json_array_size(json_object_get(shape, "coordinates")), 2);     /* with its yard */
			assert_true(json_number_value(json_object_get(own, "height_m")) == 9);
		}
	}
	assert_int_equal(seen[0] + 10 * seen[1] + 100 * seen[2], 122);
	json_decref(all);
}

static int prepare(void **state)
{
	scratch_open("make_image");
	cases_write("tests/ecopack/cases/image_files.tsv", scratch_root);
	eco_progress_quiet(true);
	write_shrub(in_root("a.obj"), "", 4, 20);
	write_photo();
	/* no heights, no CRS: the picture is laid where the scene says */
	return 0;
}

UNIT_MAIN(prepare, scratch_close)
