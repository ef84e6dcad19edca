/* Colours of summaries: few, near those of the plants, the same while little changes. */
#include "lod/build/summary.h"

#include <stdlib.h>
#include <string.h>

#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

#define POINTS 64u
#define MOST_PLANTS 4u
#define COLORS 40u               /* of a plant */

/* Tile 0 is an eco file's root with a leaf of each plant; it places tile 1, of another file, twice. */
enum { ROOT, OTHER, LEAVES };

struct world {
	struct scene_builder b;
	struct lod_pool pools[MOST_PLANTS];
	float at[POINTS][3];
	uint32_t color[MOST_PLANTS][POINTS];
};

static void add_leaf(struct world *w, uint32_t tile, uint32_t plant, uint32_t count)
{
	struct scene_builder *b = &w->b;
	uint32_t list = scene_add_bare(b, &(struct scene_row){ .kind = ECO_LIST_INSTANCES, .owner = tile,
		.other = ECO_NONE }, count, count);
	scene_add_group(b, (struct eco_group){ tile, plant, list, b->scene.place_count, 0, 0 });
	for (uint32_t i = 0; i < count; i++)
		scene_add_place(b, (struct eco_place){ { (int32_t)i, 0, 0 }, 0, 65536 });
	b->tiles[tile].instance_count += count;
	b->tiles[tile].area += count * (double)b->plants[plant].area;
}

/* Plant p has `colors` shades of its own hue. */
static void add_plant(struct world *w, uint32_t p, uint32_t colors)
{
	uint8_t rgb[COLORS][3];
	for (uint32_t i = 0; i < colors; i++) {
		memset(rgb[i], 30, 3);
		rgb[i][p % 3] = (uint8_t)(60 + 4 * i);
	}
	scene_add_plant(&w->b, (struct eco_plant){ .area = 2 });
	scene_add_colors(&w->b, (const uint8_t (*)[3])rgb, colors);
	for (uint32_t i = 0; i < POINTS; i++)
		w->color[p][i] = w->b.scene.palette_count - colors + i % colors;
	w->pools[p] = (struct lod_pool){ POINTS, w->at, w->color[p], 0 };
}

static void make_world(struct world *w, uint32_t plants, uint32_t colors, uint32_t count)
{
	memset(w, 0, sizeof *w);
	w->b.like = (struct eco_list){ .grid_step = { 1, 1, 1 } };
	for (uint32_t p = 0; p < plants; p++)
		add_plant(w, p, colors);
	for (uint32_t t = 0; t < LEAVES; t++)
		scene_add_tile(&w->b, (struct eco_tile){ .summary = ECO_NONE });
	for (uint32_t p = 0; p < plants; p++)
		add_leaf(w, ROOT, p, count + 3 * p);
}

static struct lod_summary_palette palette_of(const struct world *w,
	const struct lod_summary_root *const *roots)
{
	struct lod_summary_palette palette;
	struct eco_error error = { 0 };
	assert_ok(lod_summary_palette_make(&palette, &(struct lod_summary_input){ .scene = &w->b.scene,
		.pools = w->pools, .roots = roots }, ROOT, 1, &error), error);
	return palette;
}

static struct lod_summary summary_of(const struct world *w, const struct lod_summary_palette *palette,
	const struct lod_summary_root *const *roots)
{
	struct lod_summary s;
	lod_summary_make(&s, &(struct lod_summary_input){ .scene = &w->b.scene, .pools = w->pools,
		.tile = ROOT, .count = 500, .seed = 1, .roots = roots,
		.color_of = palette->color_of });
	assert_in_range(s.count, 250, 500);
	return s;
}

/* The plant of a point by its colour: the hue that stands out. */
static uint32_t hue(const uint8_t rgb[3])
{
	uint32_t most = 0;
	for (uint32_t k = 1; k < 3; k++)
		most = rgb[k] > rgb[most] ? k : most;
	return most;
}

UNIT_TEST(many_colours_become_near_ones)
{
	static struct world w;
	make_world(&w, 3, COLORS, 20);
	struct lod_summary_palette palette = palette_of(&w, NULL);
	struct lod_summary s = summary_of(&w, &palette, NULL);
	assert_in_range(palette.count, 20, LOD_SUMMARY_COLORS);
	for (uint32_t i = 0; i < s.count; i++) {
		assert_true(s.points[i].color < palette.count);
		assert_int_equal(hue(palette.rgb[s.points[i].color]), s.points[i].plant);
	}
	for (uint32_t i = 0; i < w.b.scene.palette_count; i++)
		for (int k = 0; k < 3; k++)
			assert_true(abs(palette.rgb[palette.color_of[i]][k] - w.b.scene.palette[i][k]) < 16);
	free(s.points);
	free(palette.color_of);
	scene_free(&w.b);
}

/* A few plants more or less change no colour. */
UNIT_TEST(colours_stay_while_little_changes)
{
	static struct world w;
	struct lod_summary_palette first = { .count = 0 };
	for (uint32_t count = 40; count < 48; count++) {
		make_world(&w, 3, COLORS, count);
		struct lod_summary_palette palette = palette_of(&w, NULL);
		if (count > 40)
			assert_memory_equal(palette.rgb, first.rgb, sizeof first.rgb);
		first = palette;
		free(palette.color_of);
		scene_free(&w.b);
	}
}

/* A nested file gives the colours of its summary, wherever they lie in the scene's palette. */
UNIT_TEST(nested_files_give_their_colours)
{
	static struct world w;
	static const uint8_t blue[2][3] = { { 10, 20, 200 }, { 10, 20, 220 } };
	struct lod_summary_root root = { .list = { .palette_count = 2, .grid_step = { 1, 1, 1 } } };
	uint8_t corners[POINTS];
	int32_t position[POINTS][3] = { { 0 } }, extra[POINTS][3] = { { 0 } };
	const struct lod_summary_root *roots[LEAVES] = { [OTHER] = &root };
	make_world(&w, 2, COLORS, 20);
	root.list.palette_first = w.b.scene.palette_count;
	scene_add_colors(&w.b, blue, 2);
	for (uint32_t i = 0; i < POINTS; i++) {
		corners[i] = 1;
		extra[i][0] = (int32_t)(i % 2);
		extra[i][1] = 1;
	}
	root.elements = (struct eco_elements){ .element_count = POINTS, .corner_count = POINTS,
		.primitive_count = POINTS, .extra_count = 3, .corners = corners,
		.position = &position[0][0], .extra = &extra[0][0] };
	w.b.tiles[OTHER].area = 100;
	w.b.tiles[OTHER].instance_count = 1000;
	for (int i = 0; i < 2; i++) {
		scene_add_child(&w.b, ROOT, (struct eco_child){ .tile = OTHER, .placed = true,
			.at = { 100.0 * (i + 1), 0, 0 }, .scale = 1 });
		w.b.tiles[ROOT].area += 100;
	}
	struct lod_summary_palette palette = palette_of(&w, roots);
	struct lod_summary s = summary_of(&w, &palette, roots);
	uint32_t nested = 0;
	for (uint32_t i = 0; i < s.count; i++) {
		const uint8_t *rgb = palette.rgb[s.points[i].color];
		bool far = s.points[i].at[0] > 90;
		nested += far;
		assert_int_equal(hue(rgb), far ? 2 : s.points[i].plant);
		assert_true(!far || abs(rgb[2] - 210) <= 11);
	}
	assert_in_range(nested, 50, 400);
	free(s.points);
	free(palette.color_of);
	scene_free(&w.b);
}

UNIT_TEST(tiles_that_show_nothing_have_no_colours)
{
	static struct world w;
	make_world(&w, 0, 0, 0);
	struct lod_summary_palette palette = palette_of(&w, NULL);
	assert_int_equal(palette.count, 0);
	free(palette.color_of);
	scene_free(&w.b);
	make_world(&w, 2, 5, 0);
	w.b.groups[0].plant = w.b.groups[1].plant = 1;
	palette = palette_of(&w, NULL);
	assert_int_equal(palette.count, 5);      /* three plants of the second kind */
	free(palette.color_of);
	scene_free(&w.b);
}

int main(void)
{
	return unit_tests_run(NULL, NULL);
}
