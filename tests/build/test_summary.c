/* Summaries: their points lie on the plants, in proportion to area, under the keys by which owners match;
 * through placements too. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/format/plan.h"
#include "lod/plan/summary_hull.h"
#include "lod/plan/visibility.h"
#include "lod/build/summary.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

/* Root tile 0 has two leaves (1, 2) and places an eco file (tile 3, a leaf) twice. Two plants: a small one
 * (area 1) with a pool near its foot, a large one (area 8) with a pool two metres up. */
enum { TILES = 4 };

static struct {
	struct scene_builder b;
	struct lod_pool pools[2];
	float pool_at[2][16][3];
	uint32_t pool_color[2][16];
} w;

static void add_group(struct scene_builder *b, uint32_t tile, uint32_t plant, uint32_t count, double x,
	double y)
{
	uint32_t list =
		scene_add_bare(b,
		&(struct scene_row){ .kind = ECO_LIST_INSTANCES, .owner = tile, .other = ECO_NONE }, count,
		count);
	b->lists[list].grid_origin[0] = x;
	b->lists[list].grid_origin[1] = y;
	scene_add_group(b, (struct eco_group){ tile, plant, list, b->scene.place_count, 0, 0 });
	for (uint32_t i = 0; i < count; i++)
		scene_add_place(b, (struct eco_place){ { (int32_t)(i * 100), (int32_t)(i % 3 * 100), 0 },
			(uint16_t)(i * 7000), 65536 });
	b->tiles[tile].instance_count += count;
	b->tiles[tile].area += count * (double)b->plants[plant].area;
}

static void make_pool(int p)
{
	for (int i = 0; i < 16; i++) {
		w.pool_at[p][i][0] = (float)(i % 4) * 0.1f;
		w.pool_at[p][i][2] = p == 0 ? 0.1f : 2.0f;
		w.pool_color[p][i] = (uint32_t)(10 * p + i % 3);
	}
	w.pools[p] = (struct lod_pool){ 16, w.pool_at[p], w.pool_color[p], (uint8_t)(100 + p) };
}

static void make_world(void)
{
	struct scene_builder *b = &w.b;
	scene_free(b);
	b->like = (struct eco_list){ .grid_step = { 0.01, 0.01, 0.01 } };
	scene_add_plant(b, (struct eco_plant){ .area = 1 });
	scene_add_plant(b, (struct eco_plant){ .area = 8 });
	scene_add_tile(b, (struct eco_tile){ .summary = ECO_NONE, .area = 10 + 80 + 16 + 16 * 4,
		.instance_count = 38 });
	for (uint32_t i = 1; i < 4; i++)
		scene_add_tile(b, (struct eco_tile){ .summary = ECO_NONE });
	add_group(b, 1, 0, 10, 0, 0);
	add_group(b, 2, 1, 10, 100, 0);
	add_group(b, 3, 0, 8, 0, 0);
	add_group(b, 3, 1, 1, 5, 5);
	scene_add_child(b, 0, (struct eco_child){ .tile = 1, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 2, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 3, .placed = true, .at = { 500, 0, 3 },
		.turn = 16384, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 3, .placed = true, .at = { -500, 0, 0 },
		.scale = 2 });
	for (int p = 0; p < 2; p++)
		make_pool(p);
}

static struct lod_summary summary_of(uint32_t tile, uint32_t count)
{
	struct lod_summary s;
	lod_summary_make(&s, &(struct lod_summary_input){ .scene = &w.b.scene, .pools = w.pools, .tile = tile,
		.count = count, .seed = 7 });
	return s;
}

UNIT_TEST(test_as_many_points_as_asked)
{
	make_world();
	for (uint32_t tile = 0; tile < TILES; tile++) {
		for (uint32_t count = 0; count < 400; count += 37) {
			struct lod_summary s = summary_of(tile, count);
			assert_int_equal(s.count, count);
			free(s.points);
		}
	}
}

UNIT_TEST(test_points_follow_area)
{
	double per[4] = { 0 };               /* leaf 1, leaf 2, placed right, placed left */
	make_world();
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

UNIT_TEST(test_keys_match_owners)
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
UNIT_TEST(test_parents_merge_children)
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
UNIT_TEST(test_nested_summaries_stand_for_their_files)
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

UNIT_TEST(test_list_holds_the_points)
{
	struct eco_list list;
	struct eco_elements e;
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
	eco_elements_free(&e);
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

UNIT_TEST(test_pool_follows_what_is_seen)
{
	uint32_t below = pooled_leaves(90), above = pooled_leaves(150);
	print_message("          leaves %u of 1000 with the stem below them, %u with it above\n", below,
		above);
	assert_true(above > 650 && above < 850);         /* nearly what the areas are */
	assert_true(below > 900);                        /* what hides is seen, from nearly everywhere */
}
