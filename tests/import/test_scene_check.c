/* Agreement of a scene's tables: a small pack's are sound, and each way to break one of them is found and
 * said. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/files.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define PATH "build/tmp/test_scene_check.eco"

/* Each breaks a copy of the small pack's scene, or the scene of splats, and puts itself among the cases. */
#define BREAK_OF(of_splats, id, what) \
	static void break_##id(struct scene_builder *l) { what; } \
	__attribute__((constructor)) static void add_##id(void) \
	{ \
		cases[case_count++] = (struct broken){ #id, break_##id, of_splats }; \
	}
#define BREAK(id, what) BREAK_OF(false, id, what)
#define BREAK_SPLATS(id, what) BREAK_OF(true, id, what)
#define BREAKS 171

static struct broken { const char *name; void (*apply)(struct scene_builder *); bool splats; } cases[BREAKS];
static size_t case_count;

BREAK(name, memset(l->scene.name, 'x', sizeof l->scene.name))
BREAK(needs, l->scene.needs = ECO_NEEDS_ALL + 1)
BREAK(missing_need, l->scene.needs = 511 & ~ECO_NEED_LINES)
BREAK(missing_cells, l->scene.needs = 511 & ~ECO_NEED_CELLS)
BREAK(root, l->scene.root = 2)
BREAK(near, l->scene.near_m = NAN)
BREAK(near_zero, l->scene.near_m = 0)
BREAK(ground, l->ground[0].list = 5)
BREAK(ground_range, l->ground[0].list = 99)
BREAK(ground_size, l->scene.ground_columns = 71)
BREAK(ground_none, l->scene.ground_columns = 0)
BREAK(ground_margin, l->scene.ground_margin = 10)
BREAK(ground_rows, l->scene.ground_rows = 0)
BREAK(ground_lost, l->scene.ground_count = 2)
BREAK(ground_level, l->ground[1].level = 1)
BREAK(ground_column, l->ground[2].column = 2)
BREAK(ground_twice, l->ground[2].column = 0)
BREAK(ground_children, l->ground[0].child_count = 1)
BREAK(ground_child_first, l->ground[0].child_first = 2)
BREAK(ground_orphans, l->ground[0].child_count = 0; l->ground[0].child_first = 0)
BREAK(ground_cycle, l->ground[1].child_count = 2; l->ground[1].child_first = 0)
BREAK(ground_error, l->ground[0].error_m = -1)
BREAK(ground_error_nan, l->ground[0].error_m = NAN)
BREAK(ground_error_child, l->ground[1].error_m = 0.5f)
BREAK(ground_bounds, l->ground[0].low_m = 1)
BREAK(ground_bounds_child, l->ground[2].high_m = 0.75f)
BREAK(ground_grid, l->lists[7].grid_origin[0] = 0)
BREAK(ground_chunks, l->lists[8].chunk_count = 0; l->lists[8].primitive_count = l->lists[8].element_count = 0)
BREAK(level_large, l->lists[6].level = 8)
BREAK(level_other, l->lists[7].level = 1)
BREAK(plant_name, memset(l->plants[0].name, 'x', 64))
BREAK(no_anchor, l->plants[0].anchor_count = 0)
BREAK(anchors, l->plants[0].anchor_first = UINT32_MAX)
BREAK(ladders, l->plants[0].ladder_count = 5)
BREAK(orphan_ladder, l->plants[0].ladder_count = 3)
BREAK(height, l->plants[0].height_m = INFINITY)
BREAK(radius, l->anchors[1].radius = -1)
BREAK(center, l->anchors[0].center[2] = NAN)
BREAK(ladder_plant, l->ladders[2].plant = 1)
BREAK(ladder_anchor, l->ladders[2].anchor = 2)
BREAK(organ, l->ladders[0].organ = ECO_ORGAN_COUNT)
BREAK(flags, l->ladders[0].flags = 16)
BREAK(above_range, l->ladders[0].flags |= ECO_LADDER_ABOVE)
BREAK(above_share, l->ladders[0].flags |= ECO_LADDER_ABOVE; l->ladders[0].curve_count = 1)
BREAK(both_flags, l->ladders[0].flags = 3)
BREAK(no_list, l->ladders[3].triangles = ECO_NONE)
BREAK(wrong_kind, l->ladders[3].triangles = 4)
BREAK(summary_in_ladder, l->ladders[0].points = 9)
BREAK(pair, l->ladders[0].triangles = 5)
BREAK(levels, l->ladders[1].level_count = 7)
BREAK(level_end, l->ladders[1].level_end[1] = 31)
BREAK(level_order, l->ladders[1].level_end[1] = 8)
BREAK(level_rest, l->ladders[1].level_end[2] = 1)
BREAK(before, l->ladders[0].before = 41)
BREAK(importance, l->ladders[0].importance = -1)
BREAK(epsilon, l->ladders[1].epsilon = NAN)
BREAK(curve_range, l->ladders[0].curve_count = 4)
BREAK(share_zero, l->curves[0].share = 0)
BREAK(share_order, l->curves[1].share = 0.1f)
BREAK(share_one, l->curves[2].share = 1.5f)
BREAK(share_nan, l->curves[1].share = NAN)
BREAK(scale, l->curves[1].scale = INFINITY)
BREAK(fn, l->curves[1].fn = -0.1f)
BREAK(bounds, l->tiles[0].low[1] = 11)
BREAK(bounds_nan, l->tiles[1].high[1] = NAN)
BREAK(instance_count, l->tiles[1].instance_count = 8)
BREAK(subtree_count, l->tiles[0].instance_count = 7)
BREAK(summary, l->tiles[1].summary = 2)
BREAK(summary_tile, l->tiles[0].summary = 9)
BREAK(groups, l->tiles[1].group_first = 1)
BREAK(two_tiles_a_group, l->tiles[0].group_count = 1)
BREAK(children, l->tiles[0].child_count = 3)
BREAK(lost_child, l->tiles[0].child_count = 1)
BREAK(cycle, l->children[0].tile = 0)
BREAK(child_tile, l->children[0].tile = 2)
BREAK(child_at, l->children[1].at[0] = INFINITY)
BREAK(child_scale, l->children[1].scale = 0)
BREAK(group_tile, l->groups[0].tile = 0)
BREAK(group_plant, l->groups[0].plant = 1)
BREAK(group_list, l->groups[0].list = 12)
BREAK(group_kind, l->groups[0].list = 9)
BREAK(places, l->groups[0].place_first = 1)
BREAK(places_overflow, l->groups[0].place_first = UINT64_MAX)
BREAK(kind, l->lists[1].kind = 0)
BREAK(kind_large, l->lists[1].kind = 7)
BREAK(coder, l->lists[1].coder = ECO_CODER_KD)
BREAK(attributes, l->lists[4].attributes = ECO_ATTR_PLACE)
BREAK(level, l->lists[4].level = 1)
BREAK(tints_need, l->lists[10].attributes |= ECO_ATTR_COLOR; l->lists[10].palette_count = 1)
BREAK(tints_many, l->lists[10].palette_count = ECO_LIST_TINTS_MAX + 1)
BREAK(tints_none, l->lists[10].attributes |= ECO_ATTR_COLOR; l->scene.needs |= ECO_NEED_TINTS; l->lists[10].palette_count = 0)
BREAK(no_place, l->lists[10].attributes = 0)
BREAK(owner, l->lists[4].owner = 1)
BREAK(owner_tile, l->lists[10].owner = 2)
BREAK(owner_none, l->lists[4].owner = ECO_NONE)
BREAK(group_first, l->groups[0].first = 1)
BREAK(group_none, l->groups[0].count = 0)
BREAK(group_small, l->groups[0].count--)
BREAK(group_large, l->groups[0].count++)
BREAK(list_groups_none, l->lists[10].group_count = 0)
BREAK(list_groups_more, l->lists[10].group_count = 2)
BREAK(list_groups_of_plain, l->lists[9].group_count = 1)
BREAK(grid_step, l->lists[0].grid_step[1] = 0)
BREAK(grid_origin, l->lists[0].grid_origin[1] = NAN)
BREAK(unit_area, l->lists[2].unit_area = NAN)
BREAK(palette, l->lists[1].palette_first = 1)
BREAK(palette_overflow, l->lists[1].palette_first = UINT32_MAX)
BREAK(no_palette, l->lists[1].palette_count = 0)
BREAK(image, l->lists[1].image = 2)
BREAK(image_range, l->lists[1].image = 12)
BREAK(partner, l->lists[2].partner = ECO_NONE)
BREAK(partner_kind, l->lists[2].partner = 3)
BREAK(partner_range, l->lists[2].partner = 99)
BREAK(partner_of_plain, l->lists[9].partner = 1)
BREAK(columns, l->lists[6].columns = 5)
BREAK(no_columns, l->lists[6].columns = 0)
BREAK(columns_of_plain, l->lists[9].columns = 5)
BREAK(chunk_range, l->lists[10].chunk_first = 19)
BREAK(chunk_shared, l->lists[10].chunk_count = 18)
BREAK(primitives, l->lists[5].primitive_count++)
BREAK(elements, l->lists[5].element_count--)
BREAK(chunk_empty, l->chunks[9].element_count = 0)
BREAK(chunk_size, l->chunks[9].size_bytes = 0)
BREAK(chunk_huge, l->chunks[9].size_bytes = UINT32_MAX)
BREAK(chunk_primitives, l->chunks[9].primitive_count = 1)
BREAK(chunk_forms, l->chunks[3].primitive_count -= 2; l->chunks[4].primitive_count += 2;
	l->chunks[3].element_count -= 2;
	l->chunks[4].element_count += 2)
BREAK(form_of_form, l->lists[11].partner = 2)
BREAK(form_of_itself, l->lists[11].partner = 11)
BREAK(form_of_wood, l->lists[11].partner = 3)
BREAK(form_count, l->lists[11].partner = 5)
BREAK(form_primitives, l->lists[11].primitive_count = 60; l->chunks[18].primitive_count = 20;
	l->chunks[19].primitive_count = 40)
BREAK(form_shape, l->lists[11].primitive_count = 80;
	l->chunks[18].primitive_count = 20; l->chunks[19].primitive_count = 60)
BREAK(form_coder, l->lists[11].coder = ECO_CODER_ELEMENTS)
BREAK(simple, l->ladders[0].simple = 5)
BREAK(simple_of_other, l->ladders[0].points = ECO_NONE; l->ladders[0].triangles = 5)
BREAK(simple_kind, l->ladders[0].simple = 2)
BREAK(reach, l->curves[1].reach = 1.1f)
BREAK(reach_nan, l->curves[1].reach = NAN)
BREAK(cover_all, l->lists[2].cover = ECO_COVER_ONE)
BREAK(cover_of_summary, l->lists[9].cover = 8)
BREAK(cover_of_triangles, l->lists[11].cover = 8)
BREAK(rows_before_other_chunks, struct eco_list *rows = &l->lists[l->scene.list_count - 1];
	struct eco_chunk chunk = l->chunks[rows->chunk_first];
	memmove(l->chunks + 1, l->chunks, rows->chunk_first * sizeof chunk);
	l->chunks[0] = chunk;
	for (uint32_t i = 0; i + 1 < l->scene.list_count; i++)
		l->lists[i].chunk_first++;
	rows->chunk_first = 0)

/* ---- Splats ---- */

enum { SPLATS, WOOD, IMPOSTOR, TEXTURE, WHOLE = 0, ORGAN };

/* A plant of wood, with one cell, and all of it as 4, 8 and 24 splats; and a texture. */
static void make_splats(struct scene_builder *l)
{
	*l = (struct scene_builder){ .scene = { .needs = ECO_NEEDS_ALL, .near_m = 0.1 },
		.like = { .grid_step = { 0.01, 0.01, 0.01 }, .unit_area = 0.01f } };
	scene_add_bare(l, &(struct scene_row){ .kind = ECO_LIST_POINTS, .coder = ECO_CODER_ELEMENTS,
		.attributes = ECO_ATTR_SPLAT, .other = ECO_NONE }, 36, 36);
	scene_add_bare(l, &(struct scene_row){ .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS,
		.other = ECO_NONE }, 50, 50);
	scene_add_bare(l, &(struct scene_row){ .kind = ECO_LIST_IMPOSTOR, .coder = ECO_CODER_BYTES,
		.other = ECO_NONE }, 1, 1);
	scene_add_bare(l, &(struct scene_row){ .kind = ECO_LIST_IMAGE, .coder = ECO_CODER_BYTES,
		.other = ECO_NONE }, 1, 1);
	scene_add_plant(l, (struct eco_plant){ .height_m = 10 });
	scene_add_anchor(l, (struct eco_anchor){ { 0, 0, 5 }, 6 });
	scene_add_anchor(l, (struct eco_anchor){ { 0, 0, 8 }, 2 });
	struct eco_ladder whole = scene_ladder(0, 0, ECO_ORGAN_FOLIAGE), wood = scene_ladder(0, 0,
		ECO_ORGAN_WOOD);
	whole.flags = ECO_LADDER_WHOLE;
	whole.points = SPLATS;
	whole.impostor = IMPOSTOR;
	whole.level_count = 3;
	whole.curve_count = 2;
	memcpy(whole.level_end, (uint32_t[3]){ 4, 12, 36 }, sizeof(uint32_t[3]));
	wood.triangles = WOOD;
	scene_add_ladder(l, whole);
	scene_add_ladder(l, wood);
	scene_add_curve(l, (struct eco_curve)SCENE_CURVE(0.1f, 1, 1, 0.5f, 0.5f));
	scene_add_curve(l, (struct eco_curve)SCENE_CURVE(1, 1, 1, 0.1f, 0.1f));
	scene_add_tile(l, (struct eco_tile){ .summary = ECO_NONE });
}

BREAK_SPLATS(whole_near, l->ladders[WHOLE].flags |= ECO_LADDER_NEAR)
BREAK_SPLATS(whole_far, l->ladders[WHOLE].flags |= ECO_LADDER_FAR)
BREAK_SPLATS(whole_cell, l->ladders[WHOLE].anchor = 1)
BREAK_SPLATS(whole_flags, l->ladders[WHOLE].flags |= 16)
BREAK_SPLATS(splats_beside_lines, l->lists[WOOD].kind = ECO_LIST_LINES; l->ladders[WHOLE].lines = WOOD)
BREAK_SPLATS(splats_level_size, l->ladders[WHOLE].level_end[1] = 13)
BREAK_SPLATS(splats_level_same, l->ladders[WHOLE].level_end[0] = 6)
BREAK_SPLATS(splats_level_smaller, l->ladders[WHOLE].level_end[1] = 20)
BREAK_SPLATS(splats_level_order, l->ladders[WHOLE].level_end[1] = 4)
BREAK_SPLATS(splats_left_over, l->ladders[WHOLE].level_end[2] = 28)
BREAK_SPLATS(splats_too_few, l->ladders[WHOLE].level_end[2] = 44)
BREAK_SPLATS(splats_level_rest, l->ladders[WHOLE].level_end[3] = 36)
BREAK_SPLATS(splats_levels, l->ladders[WHOLE].level_count = ECO_LEVELS_MAX + 1)
BREAK_SPLATS(splats_no_level, l->ladders[WHOLE].level_count = 0; memset(l->ladders[WHOLE].level_end, 0,
	sizeof l->ladders[WHOLE].level_end))
BREAK_SPLATS(leaves_before_splats, l->ladders[WHOLE].triangles = WOOD; l->ladders[WHOLE].total = 51)
BREAK_SPLATS(leaves_of_cells, l->ladders[WHOLE].triangles = WOOD; l->ladders[WHOLE].total = 99;
	struct eco_ladder cell = l->ladders[ORGAN]; cell.anchor = 1; cell.flags = ECO_LADDER_NEAR; scene_add_ladder(l, cell))
BREAK_SPLATS(splats_reach, l->curves[0].reach = 0.5f)
BREAK_SPLATS(impostor_kind, l->ladders[WHOLE].impostor = WOOD)
BREAK_SPLATS(impostor_of_organ, l->ladders[ORGAN].impostor = IMPOSTOR)
BREAK_SPLATS(impostor_without_splats, l->lists[SPLATS].attributes = 0)
BREAK_SPLATS(impostor_without_samples, l->ladders[WHOLE].curve_count = 0)
BREAK_SPLATS(impostor_missing, l->ladders[WHOLE].impostor = 4)
BREAK_SPLATS(impostor_levels, l->lists[IMPOSTOR].primitive_count = l->lists[IMPOSTOR].element_count = 2)
BREAK_SPLATS(impostor_coder, l->lists[IMPOSTOR].coder = ECO_CODER_ROWS)
BREAK_SPLATS(splats_kind, l->lists[SPLATS].kind = ECO_LIST_LINES)
BREAK_SPLATS(wood_without_a_color, l->lists[SPLATS].wood = 1)
BREAK_SPLATS(strip_behind_the_last_level, scene_add_chunk(l, (struct eco_chunk){ .size_bytes = 8 });
	l->lists[TEXTURE].chunk_count++)

/* ---- Tiles that no view can close ---- */

/* Each has the next one twice. */
static void nest_tiles(struct scene_builder *l)
{
	for (uint32_t i = 0; i < 16; i++) {
		uint32_t tile = scene_add_tile(l, (struct eco_tile){ .summary = ECO_NONE });
		scene_add_child(l, i, (struct eco_child){ .tile = tile, .placed = true, .scale = 1 });
		scene_add_child(l, i, (struct eco_child){ .tile = tile, .placed = true, .scale = 1 });
	}
}

static void place_often(struct scene_builder *l, bool summary)
{
	for (uint32_t i = 2; i <= ECO_OPEN_PLANTS_MAX / SMALL_PACK_PLANTS; i++)
		scene_add_child(l, 0, (struct eco_child){ .tile = 1, .placed = true, .scale = 1 });
	l->tiles[1].child_first = l->scene.child_count;
	l->tiles[0].instance_count = SMALL_PACK_PLANTS * (uint64_t)l->scene.child_count;
	l->tiles[1].summary = summary ? l->tiles[1].summary : ECO_NONE;
}

BREAK_SPLATS(open_tiles, nest_tiles(l))
BREAK(open_plants, place_often(l, false))

static struct eco_pack *open_small(struct scene_builder *l)
{
	struct scene_builder made;
	struct eco_pack *pack;
	assert_good(small_pack_write(&made, PATH, NULL, &cause));
	scene_free(&made);
	assert_good(eco_pack_open(&pack, PATH, &cause));
	scene_copy(l, &pack->scene);
	return pack;
}

UNIT_TEST(a_summary_stands_for_any_number_of_plants)
{
	struct scene_builder l;
	struct eco_pack *pack = open_small(&l);
	place_often(&l, true);
	assert_good(eco_scene_check(&l.scene, &cause));
	scene_free(&l);
	eco_pack_close(pack);
	unlink(PATH);
}

/* The last level of the ground's image is two chunks. */
UNIT_TEST(a_level_of_an_image_may_be_strips)
{
	struct scene_builder l;
	struct eco_pack *pack = open_small(&l);
	struct eco_list *list = &l.lists[l.ground_images[0].list];
	uint32_t end = list->chunk_first + list->chunk_count++;
	l.scene.chunks = l.chunks = realloc(l.chunks, ++l.scene.chunk_count * sizeof *l.chunks);
	memmove(&l.chunks[end], &l.chunks[end - 1], (l.scene.chunk_count - end) * sizeof *l.chunks);
	l.chunks[end - 1].primitive_count = l.chunks[end - 1].element_count = 0;
	for (uint32_t i = 0; i < l.scene.list_count; i++)
		l.lists[i].chunk_first += l.lists[i].chunk_first >= end;
	assert_good(eco_scene_check(&l.scene, &cause));
	scene_free(&l);
	eco_pack_close(pack);
	unlink(PATH);
}

UNIT_TEST(every_inconsistency_is_found)
{
	struct eco_error error = { 0 };
	struct scene_builder made;
	struct eco_pack *pack;

	folder_make("build/tmp");
	assert_int_equal(small_pack_write(&made, PATH, NULL, &error), ECO_OK);
	scene_free(&made);
	assert_int_equal(eco_pack_open(&pack, PATH, &error), ECO_OK);
	assert_int_equal(case_count, BREAKS);
	for (size_t i = 0; i < case_count; i++) {
		struct scene_builder l;
		if (cases[i].splats)
			make_splats(&l);
		else
			scene_copy(&l, &pack->scene);
		error = (struct eco_error){ 0 };
		assert_int_equal(eco_scene_check(&l.scene, &error), ECO_OK);
		cases[i].apply(&l);
		if (eco_scene_check(&l.scene, &error) == ECO_OK)
			fail_msg("%s is not found", cases[i].name);
		assert_true(error.text[0] != 0);
		scene_free(&l);
	}
	eco_pack_close(pack);
	unlink(PATH);
}
