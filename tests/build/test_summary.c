/* Summaries: their points lie on the plants, in proportion to area, under the keys by which owners match;
 * through placements too. Their colours are few, near those of the plants, the same while little changes.
 * Points in parts lie around their point, and the first parts stay where there are more. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/plan.h"
#include "lod/build/summary.h"
#include "lod/scattered.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

enum { TILES = 4, POINTS = 64, PLANTS = 4, COLORS = 40 };

static struct {
	struct scene_builder b;
	struct lod_pool pools[PLANTS];
	float at[PLANTS][POINTS][3];
	uint32_t color[PLANTS][POINTS];
	bool keeps[POINTS];
} w;

static void add_group(uint32_t tile, uint32_t plant, uint32_t count, double x, double y)
{
	struct scene_builder *b = &w.b;
	uint32_t list = scene_add_bare(b, &(struct scene_row){ .kind = ECO_LIST_INSTANCES, .owner = tile,
		.other = ECO_NONE }, count, count);
	b->lists[list].grid_origin[0] = x;
	b->lists[list].grid_origin[1] = y;
	scene_add_group(b, (struct eco_group){ tile, plant, list, b->scene.place_count, 0, 0 });
	for (uint32_t i = 0; i < count; i++)
		scene_add_place(b, (struct eco_place){ { (int32_t)(i * 100), (int32_t)(i % 3 * 100), 0 },
			(uint16_t)(i * 7000), 65536, 0, 0 });
	b->tiles[tile].instance_count += count;
	b->tiles[tile].area += count * (double)b->plants[plant].area;
}

/* With a pool at a height, of `colors` shades of a hue of its own. */
static void add_plant(float area, float z, uint32_t colors)
{
	uint8_t rgb[COLORS][3];
	uint32_t p = scene_add_plant(&w.b, (struct eco_plant){ .area = area });
	for (uint32_t i = 0; i < colors; i++) {
		memset(rgb[i], 30, 3);
		rgb[i][p % 3] = (uint8_t)(60 + 4 * i);
	}
	scene_add_colors(&w.b, (const uint8_t (*)[3])rgb, colors);
	for (uint32_t i = 0; i < POINTS; i++) {
		w.at[p][i][0] = (float)(i % 4) * 0.1f;
		w.at[p][i][2] = z;
		w.color[p][i] = w.b.scene.palette_count - colors + i % colors;
	}
	w.pools[p] = (struct lod_pool){ POINTS, w.at[p], w.color[p], w.keeps, (uint8_t)(100 + p) };
}

static void begin(uint32_t tiles)
{
	scene_free(&w.b);
	w.b.like = (struct eco_list){ .grid_step = { 0.01, 0.01, 0.01 } };
	while (w.b.scene.tile_count < tiles)
		scene_add_tile(&w.b, (struct eco_tile){ .summary = ECO_NONE });
}

/* Root tile 0 has two leaves (1, 2) and places an eco file (tile 3, a leaf) twice. Two plants: a small one
 * (area 1) with a pool near its foot, a large one (area 8) with a pool two metres up. */
static void make_world(void)
{
	struct scene_builder *b = &w.b;
	begin(TILES);
	add_plant(1, 0.1f, 3);
	add_plant(8, 2, 3);
	b->tiles[0].area = 10 + 80 + 16 + 16 * 4;
	b->tiles[0].instance_count = 38;
	add_group(1, 0, 10, 0, 0);
	add_group(2, 1, 10, 100, 0);
	add_group(3, 0, 8, 0, 0);
	add_group(3, 1, 1, 5, 5);
	scene_add_child(b, 0, (struct eco_child){ .tile = 1, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 2, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 3, .placed = true, .at = { 500, 0, 3 },
		.turn = 16384, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 3, .placed = true, .at = { -500, 0, 0 },
		.scale = 2 });
}

static struct lod_summary summary_of(uint32_t tile, uint32_t count)
{
	struct lod_summary s;
	lod_summary_make(&s, &(struct lod_summary_input){ .scene = &w.b.scene, .pools = w.pools, .tile = tile,
		.count = count, .seed = 7 });
	assert_int_equal(s.count, count);
	return s;
}

UNIT_TEST(points_follow_area)
{
	double per[4] = { 0 };               /* leaf 1, leaf 2, placed right, placed left */
	make_world();
	for (uint32_t tile = 0; tile < TILES; tile++)
		free(summary_of(tile, 37 * tile).points);
	struct lod_summary s = summary_of(0, 1700);
	for (uint32_t i = 0; i < s.count; i++) {
		double x = s.points[i].at[0];
		per[x < -100 ? 3 : x > 300 ? 2 : x > 80 ? 1 : 0]++;
	}
	assert_true(fabs(per[0] - 100) <= 2);
	assert_true(fabs(per[1] - 800) <= 2);
	assert_true(fabs(per[2] - 160) <= 2);
	assert_true(fabs(per[3] - 640) <= 2);
	free(s.points);
	/* inside a leaf: 8 small ones have half the area */
	double large = 0;
	s = summary_of(3, 1000);
	for (uint32_t i = 0; i < s.count; i++)
		large += s.points[i].plant == 1;
	assert_true(fabs(large - 500) <= 10);
	free(s.points);
}

UNIT_TEST(keys_match_owners)
{
	make_world();
	struct lod_summary s = summary_of(0, 500);
	for (uint32_t i = 0; i < s.count; i++) {
		const struct lod_summary_point *p = &s.points[i];
		uint32_t leaf = p->at[0] > 300 || p->at[0] < -100 ? 3 : p->at[0] > 80 ? 2 : 1;
		uint32_t path = p->at[0] > 300 ? eco_owner_step(&w.b.scene, 0, 2) : p->at[0] < -100
			? eco_owner_step(&w.b.scene, 0, 3) : 0;
		uint64_t plant = eco_owner_instance(eco_owner_leaf(leaf) + path, p->plant, 5);
		uint64_t other = eco_owner_instance(eco_owner_leaf(leaf == 1 ? 2 : 1) + path, p->plant, 5);
		assert_true(eco_owner_match(eco_owner_summary(p->key, p->plant), plant));
		assert_false(eco_owner_match(eco_owner_summary(p->key, p->plant), other));
	}
	free(s.points);
}

static int by_place(const void *a, const void *b) { return memcmp(a, b, sizeof(struct lod_summary_point)); }

/* A parent takes the beginnings of its children's sequences: what it takes of a leaf, a longer summary of
 * that leaf has too. */
UNIT_TEST(parents_merge_children)
{
	make_world();
	struct lod_summary parent = summary_of(0, 170), leaf = summary_of(2, 200);
	uint32_t taken = 0;
	qsort(leaf.points, leaf.count, sizeof *leaf.points, by_place);
	for (uint32_t i = 0; i < parent.count; i++) {
		if (parent.points[i].at[0] < 80 || parent.points[i].at[0] > 300)
			continue;
		taken++;
		/* as the leaf counts itself */
		parent.points[i].key = (uint16_t)(parent.points[i].key - eco_owner_leaf(2));
		assert_non_null(bsearch(&parent.points[i], leaf.points, leaf.count, sizeof *leaf.points,
			by_place));
	}
	assert_true(taken >= 78);
	free(parent.points);
	free(leaf.points);
}

/* The stored summaries of nested eco files are enough; a file that has none is left out. */
UNIT_TEST(nested_summaries_stand_for_their_files)
{
	struct lod_summary inner, outer;
	struct lod_summary_root root = { 0 };
	const struct lod_summary_root *roots[TILES] = { NULL };
	struct lod_summary_input input = { .scene = &w.b.scene, .tile = 0, .count = 100, .seed = 7,
		.roots = roots };
	make_world();
	w.b.tiles[0].child_first = w.b.tiles[0].child_count = 2;     /* both of tile 3 */
	lod_summary_make(&outer, &input);
	assert_int_equal(outer.count, 0);
	free(outer.points);
	inner = summary_of(3, 200);
	lod_summary_list(&inner, &w.b.scene, 3, 20, &root.list, &root.elements);
	roots[3] = &root;
	lod_summary_make(&outer, &input);
	assert_int_equal(outer.count, 100);
	for (uint32_t i = 0; i < outer.count; i++)
		assert_true(fabs(fabs(outer.points[i].at[0]) - 500) < 20);
	free(outer.points);
	free(inner.points);
	eco_elements_free(&root.elements);
}

UNIT_TEST(list_holds_the_points)
{
	struct eco_list list;
	FREED(eco_elements) e;
	make_world();
	struct lod_summary s = summary_of(2, 256);
	lod_summary_list(&s, &w.b.scene, 2, 40, &list, &e);
	assert_int_equal(e.element_count, 256);
	assert_true(fabs((double)list.unit_area * 256 - w.b.tiles[2].area / 2) < 1e-3);
	assert_true(list.level >= 100 && list.level < 110);      /* between those of its plants */
	for (uint32_t i = 0; i < s.count; i++) {
		for (int a = 0; a < 3; a++) {
			double at = list.grid_origin[a] + list.grid_step[a] * e.position[3 * i + (uint32_t)a];
			assert_true(fabs(at - s.points[i].at[a]) <= 0.5 * list.grid_step[a] + 1e-12);
		}
		assert_int_equal(e.extra[3 * i], s.points[i].color);
		assert_int_equal(e.extra[3 * i + 1], s.points[i].plant);
		assert_int_equal(e.extra[3 * i + 2], s.points[i].key);
	}
	free(s.points);
}

/* ---- Pools ---- */

/* A plant of a card of 4 m^2 at z = 1 (foliage, colour 1) and a triangle of area 1 (wood, colour 0) below or
 * above it. */
static uint32_t pooled_leaves(int32_t stem_z)
{
	uint8_t fan[] = { 4 }, tri[] = { 3 };
	int32_t card[] = { 0, 0, 100, 200, 0, 100, 200, 200, 100, 0, 200, 100 }, one[] = { 1 },
		zero[] = { 0 };
	int32_t stem[] = { 0, 0, stem_z, 200, 0, stem_z, 0, 100, stem_z };
	struct lod_list_draft drafts[2] = {
		{ .list = { .kind = ECO_LIST_TRIANGLES, .attributes = ECO_ATTR_COLOR,
			.grid_step = { 0.01, 0.01, 0.01 }, .palette_count = 2 },
		  .elements = { 1, 4, 2, 1, fan, card, NULL, one, NULL } },
		{ .list = { .kind = ECO_LIST_TRIANGLES, .attributes = ECO_ATTR_COLOR,
		.grid_step = { 0.01, 0.01, 0.01 }, .palette_count = 2 },
		  .elements = { 1, 3, 1, 1, tri, stem, NULL, zero, NULL } } };
	struct eco_ladder ladders[2] = {
		{ .organ = ECO_ORGAN_FOLIAGE, .points = ECO_NONE, .lines = ECO_NONE, .triangles = 0 },
		{ .organ = ECO_ORGAN_WOOD, .points = ECO_NONE, .lines = ECO_NONE, .triangles = 1,
			.level_count = 1, .level_end = { 1 } } };
	struct eco_anchor anchor = { { 0, 0, 0 }, 1 };
	struct lod_plant plant = { .anchors = &anchor, .ladders = ladders, .ladder_count = 2, .lists = drafts,
		.list_count = 2 };
	struct lod_pool pool;
	uint32_t leaves = 0;
	plant.organ[ECO_ORGAN_FOLIAGE].area = 4;
	plant.organ[ECO_ORGAN_WOOD].area = 1;
	lod_pool_make(&pool, &plant, 30, 1000);
	assert_int_equal(pool.count, 1000);
	for (uint32_t i = 0; i < pool.count; i++) {
		bool leaf = fabsf(pool.position[i][2] - 1) < 0.1f;
		leaves += leaf;
		assert_int_equal(pool.color[i], leaf ? 31 : 30);
		assert_true(pool.position[i][0] >= 0 && pool.position[i][0] <= 2.00001f && pool.position[i][1]
			>= 0 && pool.position[i][1] <= 2.00001f);
	}
	lod_pool_free(&pool);
	plant.ladder_count = 0;
	lod_pool_make(&pool, &plant, 30, 1000);
	assert_int_equal(pool.count, 1);
	lod_pool_free(&pool);
	return leaves;
}

UNIT_TEST(pool_follows_what_is_seen)
{
	uint32_t below = pooled_leaves(90), above = pooled_leaves(150);
	print_message("          leaves %u of 1000 with the stem below them, %u with it above\n", below,
		above);
	assert_true(above > 650 && above < 850);         /* nearly what the areas are */
	assert_true(below > 900);                        /* what hides is seen, from nearly everywhere */
}

/* ---- Colours ---- */

/* Tile 0 is an eco file's root with plants of each kind; tile 1 belongs to another file. */
enum { ROOT, OTHER, FILES };

static void make_colored(uint32_t plants, uint32_t colors, uint32_t count)
{
	begin(FILES);
	for (uint32_t p = 0; p < plants; p++)
		add_plant(2, 0, colors);
	for (uint32_t p = 0; p < plants; p++)
		add_group(ROOT, p, count + 3 * p, 0, 0);
}

static struct lod_summary_palette palette_of(const struct lod_summary_root *const *roots)
{
	struct lod_summary_palette palette;
	lod_summary_palette_make(&palette, &(struct lod_summary_input){ .scene = &w.b.scene,
		.pools = w.pools, .roots = roots }, ROOT, 1);
	return palette;
}

static struct lod_summary colored_of(const struct lod_summary_palette *palette,
	const struct lod_summary_root *const *roots)
{
	struct lod_summary s;
	lod_summary_make(&s, &(struct lod_summary_input){ .scene = &w.b.scene, .pools = w.pools,
		.tile = ROOT, .count = 500, .seed = 1, .roots = roots, .color_of = palette->color_of });
	assert_in_range(s.count, 250, 500);
	return s;
}

/* The plant of a point by its colour: the hue that stands out. */
static uint32_t hue(const uint8_t rgb[3])
{
	return rgb[1] > rgb[0] ? rgb[2] > rgb[1] ? 2 : 1 : rgb[2] > rgb[0] ? 2 : 0;
}

UNIT_TEST(many_colours_become_near_ones)
{
	make_colored(3, COLORS, 20);
	struct lod_summary_palette palette = palette_of(NULL);
	struct lod_summary s = colored_of(&palette, NULL);
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
}

/* A few plants more or less change no colour. */
UNIT_TEST(colours_stay_while_little_changes)
{
	struct lod_summary_palette first = { .count = 0 };
	for (uint32_t count = 40; count < 48; count++) {
		make_colored(3, COLORS, count);
		struct lod_summary_palette palette = palette_of(NULL);
		if (count > 40)
			assert_memory_equal(palette.rgb, first.rgb, sizeof first.rgb);
		first = palette;
		free(palette.color_of);
		}
}

/* A nested file gives the colours of its summary, wherever they lie in the scene's palette. */
UNIT_TEST(nested_files_give_their_colours)
{
	static const uint8_t blue[2][3] = { { 10, 20, 200 }, { 10, 20, 220 } };
	struct lod_summary_root root = { .list = { .palette_count = 2, .grid_step = { 1, 1, 1 } } };
	uint8_t corners[POINTS];
	int32_t position[POINTS][3] = { { 0 } }, extra[POINTS][3] = { { 0 } };
	const struct lod_summary_root *roots[FILES] = { [OTHER] = &root };
	make_colored(2, COLORS, 20);
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
	struct lod_summary_palette palette = palette_of(roots);
	struct lod_summary s = colored_of(&palette, roots);
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
}

UNIT_TEST(tiles_that_show_nothing_have_no_colours)
{
	make_colored(0, 0, 0);
	struct lod_summary_palette palette = palette_of(NULL);
	assert_int_equal(palette.count, 0);
	free(palette.color_of);
	make_colored(2, 5, 0);
	w.b.groups[0].plant = w.b.groups[1].plant = 1;
	palette = palette_of(NULL);
	assert_int_equal(palette.count, 5);      /* three plants of the second kind */
	free(palette.color_of);
}

/* ---- Points in parts ---- */

enum { WHOLE = 50, FIRST = 7 };

static struct lod_geometry scattered(unsigned halvings)
{
	struct lod_geometry g = { .position = malloc(sizeof *g.position * 3 * ((size_t)WHOLE << halvings)),
		.color = malloc(sizeof *g.color * ((size_t)WHOLE << halvings)) };
	for (uint32_t i = 0; i < WHOLE; i++) {
		for (uint32_t k = 0; k < 3; k++)
			g.position[3 * i + k] = (float)(100 * k + i);
		g.color[i] = (int32_t)i;
	}
	lod_scatter(&g, WHOLE, FIRST, halvings, 2.5);
	return g;
}

UNIT_TEST(each_part_keeps_its_points_colour_and_more_parts_add_to_those_before)
{
	struct lod_geometry sets[2] = { scattered(2), scattered(3) };
	for (uint32_t i = 0; i < 8 * WHOLE; i++) {
		const float *at = sets[1].position + 3 * i;
		float offset[3];
		lod_scattered_offset(offset, FIRST + i / 8, i % 8);
		for (uint32_t k = 0; k < 3; k++)
			assert_true(at[k] == (float)(100 * k + i / 8) + 2.5f * offset[k]);
		assert_int_equal(sets[1].color[i], i / 8);
		assert_true(i % 8 >= 4 || !memcmp(at, sets[0].position + 3 * (i / 8 * 4 + i % 8), 3 * sizeof *at));
	}
	for (int i = 0; i < 2; i++) {
		free(sets[i].position);
		free(sets[i].color);
	}
}

static int tear_down(void **state)
{
	scene_free(&w.b);
	return 0;
}

UNIT_MAIN(NULL, tear_down)
