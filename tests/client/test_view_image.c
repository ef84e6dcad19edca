/* The image of the ground at a place, against a simple twin; and which tiles are a quadtree. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ground.h"
#include "ecofiles/format/ground_tile.h"
#include "lod/light.h"
#include "tests/support/unit_test.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
#define TILES 4u

/* Four tiles of two sizes: a coarse one in the west, and three of a fine one's quarters beside it. */
struct made { struct view_list lists[TILES]; struct view_image_tile tiles[TILES]; struct view_image image; };

static uint8_t value_at(double x, double y) { return (uint8_t)(60 + 100 * (x / 200) + 50 * (y / 100)); }

static void make_tile(struct made *m, uint32_t i, double west, double south, double side)
{
	struct view_list *list = &m->lists[i];
	list->parts = calloc(ECO_GROUND_IMAGE_LEVELS, sizeof *list->parts);
	list->chunk_count = ECO_GROUND_IMAGE_LEVELS;
	for (uint32_t k = 0; k < ECO_GROUND_IMAGE_LEVELS; k++) {
		uint32_t n = 32u << k;
		list->parts[k] = (struct eco_texture_part){ n, n, 3, malloc(3 * (size_t)n * n) };
		for (uint32_t y = 0; y < n; y++)
			for (uint32_t x = 0; x < n; x++)
				memset(list->parts[k].texels + 3 * ((size_t)y * n + x), value_at(west + (x + 0.5) * side / n,
					south + side - (y + 0.5) * side / n), 3);
	}
	list->list = (struct eco_list){ .kind = ECO_LIST_GROUND_IMAGE, .grid_origin = { west, south },
		.grid_step = { side / SIDE, side / SIDE } };
	m->tiles[i] = (struct view_image_tile){ list, ECO_GROUND_IMAGE_LEVELS };
}

static void make(struct made *m)
{
	memset(m, 0, sizeof *m);
	make_tile(m, 0, 0, 0, 100);
	make_tile(m, 1, 100, 0, 50);
	make_tile(m, 2, 150, 0, 50);
	make_tile(m, 3, 100, 50, 50);
	assert_good(view_image_of(&m->image, m->tiles, TILES, &cause));
}

static void unmake(struct made *m)
{
	for (uint32_t i = 0; i < TILES; i++) {
		for (uint32_t k = 0; k < m->lists[i].chunk_count; k++)
			eco_texture_part_free(&m->lists[i].parts[k]);
		free(m->lists[i].parts);
	}
	view_image_free(&m->image);
}

static struct view_image_color ask(const struct made *m, double x, double y, double half_m)
{
	return view_image_at(&m->image, &(struct view_image_spot){ { x, y }, { 0, half_m }, half_m });
}

/* A ramp is what it is at every place, whatever level or tile shows it: also across borders of tiles. */
UNIT_TEST(a_ramp_is_the_same_across_tiles_and_levels)
{
	struct made m;
	make(&m);
	for (double half_m = 0.05; half_m < 1.5; half_m *= 2)
		for (double y = 3; y < 48; y += 1.37)
			for (double x = 3; x < 197; x += 0.51) {
				struct view_image_color c = ask(&m, x, y, half_m);
				double wanted = lod_light_of[value_at(x, y)] / 65535.0;
				assert_true(c.alpha > 0.999f);
				assert_true(fabs((double)c.light[0] - wanted) < 0.02 && c.light[0] == c.light[2]);
			}
	unmake(&m);
}

UNIT_TEST(nothing_is_shown_where_no_tile_lies)
{
	struct made m;
	make(&m);
	assert_true(ask(&m, 175, 75, 0.1).alpha == 0);
	assert_true(ask(&m, -1, 50, 0.1).alpha == 0 && ask(&m, 201, 20, 0.1).alpha == 0);
	assert_true(ask(&m, 1e300, 0, 0.1).alpha == 0 && ask(&m, NAN, 0, 0.1).alpha == 0);
	unmake(&m);
}

/* Also where its texels are a small part of the root: single floats of places would be 12 texels apart. */
UNIT_TEST(a_small_tile_far_from_the_others_is_as_sharp)
{
	struct made m;
	memset(&m, 0, sizeof m);
	double west = 8e6, side = 1.0 / 64;
	make_tile(&m, 0, 0, 0, 1);
	make_tile(&m, 1, west, 0, side);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++)
			memset(m.lists[1].parts[3].texels + 3 * (y * SIDE + x), (int)x, 3);
	assert_good(view_image_of(&m.image, m.tiles, 2, &cause));
	for (uint32_t x = 0; x < SIDE; x++)
		assert_true(fabsf(ask(&m, west + (x + 0.5) * side / SIDE, side / 2, 1e-9).light[0]
			- (float)lod_light_of[x] / 65535) < 1e-4f);
	unmake(&m);
}

static enum eco_code code_of(const struct made *m, uint32_t count)
{
	FREED(view_image) image;
	struct eco_error error = { 0 };
	enum eco_code code = view_image_of(&image, m->tiles, count, &error);
	return code;
}

UNIT_TEST(what_is_no_quadtree_is_refused)
{
	struct made m;
	make(&m);
	struct eco_list *last = &m.lists[3].list;
	const struct eco_list kept = *last;
	/* where another lies; on a quarter of a larger one; no half of a half */
	static const double places[][3] = { { 100, 0, 50 }, { 50, 50, 50 }, { 100, 50, 33 }, { NAN, 50, 50 },
		{ INFINITY, 50, 50 }, { 1e300, 50, 50 }, { 1e17, 50, 50 }, { 100, 50, NAN }, { 100, 50, 0 },
		{ 100, 50, -1 }, { 100, 50, 1e-300 }, { 100, 50, 1e300 } };
	assert_int_equal(code_of(&m, TILES), ECO_OK);
	for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
		memcpy(last->grid_origin, places[i], 2 * sizeof *places[i]);
		last->grid_step[0] = places[i][2] / SIDE;
		assert_int_equal(code_of(&m, TILES), ECO_DAMAGED);
	}
	*last = kept;
	m.lists[3].parts[1].width = 63;
	assert_int_equal(code_of(&m, TILES), ECO_DAMAGED);
	unmake(&m);
}
