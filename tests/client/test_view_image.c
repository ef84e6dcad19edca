/* The image of the ground at a place, against a simple twin; and that it does not depend on how it came. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_image.h"
#include "ecofiles/format/ground_image.h"
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
	uint32_t size = side < 100;
	m->tiles[i] = (struct view_image_tile){ list, ECO_GROUND_IMAGE_LEVELS, size,
		(int64_t)floor(west / side), (int64_t)floor(south / side) };
}

static void make(struct made *m)
{
	memset(m, 0, sizeof *m);
	make_tile(m, 0, 0, 0, 100);
	make_tile(m, 1, 100, 0, 50);
	make_tile(m, 2, 150, 0, 50);
	make_tile(m, 3, 100, 50, 50);
	m->image = (struct view_image){ .tiles = m->tiles, .count = TILES, .texel_m = { 100.0 / SIDE, 50.0 / SIDE },
		.first = { 0, 1, TILES }, .size_count = 2 };
}

static void unmake(struct made *m)
{
	for (uint32_t i = 0; i < TILES; i++) {
		for (uint32_t k = 0; k < ECO_GROUND_IMAGE_LEVELS; k++)
			eco_texture_part_free(&m->lists[i].parts[k]);
		free(m->lists[i].parts);
	}
}

static struct view_image_color ask(const struct made *m, double x, double y, double half_m)
{
	uint32_t near = 0;
	double texel_m = 0;
	const struct view_image_spot spot = { { x, y }, { 0, half_m }, half_m };
	return view_image_at(&m->image, &spot, &near, &texel_m);
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

/* Where the last answer was has no influence. */
UNIT_TEST(answers_do_not_depend_on_where_is_looked_first)
{
	struct made m;
	make(&m);
	for (uint32_t first = 0; first <= TILES + 1; first++)
		for (double x = 1; x < 199; x += 7.3) {
			uint32_t near = first;
			double texel_m = 0;
			const struct view_image_spot spot = { { x, 20 }, { 0.3, 0 }, 0.1 };
			struct view_image_color a = view_image_at(&m.image, &spot, &near, &texel_m), b;
			near = 0;
			b = view_image_at(&m.image, &spot, &near, &texel_m);
			assert_memory_equal(&a, &b, sizeof a);
		}
	unmake(&m);
}
