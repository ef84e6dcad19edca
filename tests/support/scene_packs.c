#include "tests/support/scene_packs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/ground_tile.h"
#include "tests/support/ground_tiles.h"

/* ---- The sample ---- */

enum { LEAVES = 30000 };

static uint32_t split_32(uint32_t count, uint32_t *ends)
{
	uint32_t n = 0;
	/* many small chunks: more than one send, one page, one vector holds */
	for (uint32_t end = 32; end < count; end += 32)
		ends[n++] = end;
	ends[n++] = count;
	return n;
}

/* Corners near each other, elements anywhere in a cube of 4096 steps; instances turned and scaled. */
static void fill_randomly(struct scene_builder *b, const struct eco_list *list, struct eco_elements *e)
{
	for (uint32_t i = 0, corner = 0; i < e->element_count; corner += e->corners[i++])
		for (uint32_t axis = 0; axis < 3; axis++) {
			int32_t base = (int32_t)(lcg_bits(&b->state) % 4096);
			for (uint32_t c = 0; c < e->corners[i]; c++)
				e->position[3 * (corner + c) + axis] =
					base + (int32_t)(lcg_bits(&b->state) % 64);
		}
	for (uint32_t i = 0; e->uv && i < 2 * e->corner_count; i++)
		e->uv[i] = (int32_t)(lcg_bits(&b->state) % ECO_UV_ONE);
	for (uint32_t i = 0; list->kind == ECO_LIST_INSTANCES && i < e->element_count; i++) {
		e->position[3 * i + 2] = 0;
		e->extra[2 * i] = (int32_t)(lcg_bits(&b->state) % 65536);
		e->extra[2 * i + 1] = (int32_t)(32768 + lcg_bits(&b->state) % 65536);
	}
}

static void sample_lists(struct scene_builder *b, bool plain)
{
	const uint32_t bush = plain ? 3 : 4;
	const struct scene_row rows[] = {
		{ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 0, ECO_NONE, LEAVES, 3 },
		{ ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_COLOR, 0, 0, LEAVES, 1 },
		{ ECO_LIST_LINES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_WIDTH, 0, ECO_NONE, 300, 2 },
		{ ECO_LIST_IMAGE, ECO_CODER_BYTES, 0, 1, ECO_NONE, 0, 0 },
		{ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_UV, 1, plain ? ECO_NONE : 3, 400, 4 },
		{ ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1, ECO_NONE, SAMPLE_PLANTS, 1 },
		{ ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1, ECO_NONE, SAMPLE_PLANTS, 1 },
		{ ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 2, ECO_NONE, SAMPLE_PLANTS, 1 },
		{ ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 2, ECO_NONE, SAMPLE_PLANTS, 1 },
		{ ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_COLOR | ECO_ATTR_PLANT, 0, ECO_NONE, 2000, 1 },
	};
	scene_add_rows(b, rows, 3);
	if (!plain)
		scene_add_rows(b, rows + 3, 1);
	scene_add_rows(b, rows + 4, 6);
	for (uint32_t id = 0; id < b->scene.list_count; id++) {
		struct eco_list *list = &b->lists[id];
		if (list->kind == ECO_LIST_INSTANCES) {
			list->grid_origin[0] = (id - bush - 1) / 2 * 50.0;
			list->grid_step[0] = list->grid_step[1] = 50.0 / 4096;
		}
		for (uint32_t k = 0; list->kind == ECO_LIST_IMAGE && k < b->texture_levels; k++)
			for (size_t i = 0; i < b->texture[0][k].size; i++)
				b->texture[0][k].at[i] = (uint8_t)lcg_bits(&b->state);
		fill_randomly(b, list, &b->elements[id]);
	}
}

static void sample_ladder(struct scene_builder *b, uint32_t plant, enum eco_organ organ, uint32_t lists[3],
	uint32_t total, float area)
{
	struct eco_ladder l = scene_ladder(plant, plant, organ);
	l.points = lists[0];
	l.lines = lists[1];
	l.triangles = lists[2];
	l.total = total;
	l.area = area;
	l.length = organ == ECO_ORGAN_WOOD ? 30 : 0;
	l.epsilon = organ == ECO_ORGAN_WOOD ? .01f : 0;
	l.curve_count = 3;
	scene_add_ladder(b, l);
}

static void sample_tables(struct scene_builder *b, bool plain)
{
	static const uint8_t palette[2][3] = { { 30, 90, 30 }, { 90, 60, 30 } };
	static const struct eco_curve curves[] = { SCENE_CURVE(.01f, 1, .01f, .3f, .3f), SCENE_CURVE(.1f, 1, .1f, .2f, .2f),
		SCENE_CURVE(1, 1, 1, 0, 0) };
	const uint32_t bush = plain ? 3 : 4, none = ECO_NONE;
	scene_add_colors(b, palette, 2);
	for (int i = 0; i < 3; i++)
		scene_add_curve(b, curves[i]);
	scene_add_plant(b,
		(struct eco_plant){ .name = "tree", .height_m = 4, .area = 22, .triangles = LEAVES });
	scene_add_anchor(b, (struct eco_anchor){ { 2, 2, 2 }, 4 });
	sample_ladder(b, 0, ECO_ORGAN_FOLIAGE, (uint32_t[3]){ 1, none, 0 }, LEAVES, 20);
	sample_ladder(b, 0, ECO_ORGAN_WOOD, (uint32_t[3]){ none, 2, none }, 300, 2);
	scene_add_plant(b, (struct eco_plant){ .name = "bush", .height_m = 4, .area = 5, .triangles = 800 });
	scene_add_anchor(b, (struct eco_anchor){ { 2, 2, 2 }, 4 });
	sample_ladder(b, 1, ECO_ORGAN_FOLIAGE, (uint32_t[3]){ none, none, bush }, 400, 5);
	for (uint32_t i = 0; i < 3; i++) {
		double from = i == 2 ? 50 : 0, to = i == 1 ? 50 : 100;
		scene_add_tile(b, (struct eco_tile){ .low = { from - 5, -5, -5 }, .high = { to + 10, 60, 15 },
			.area = i ? 4000 : 8000,
			.instance_count = (i ? 2 : 4) * SAMPLE_PLANTS, .summary = i ? ECO_NONE : bush + 5 });
		if (i)
			scene_add_child(b, 0, (struct eco_child){ .tile = i, .scale = 1 });
	}
	for (uint32_t i = 1; i <= 4; i++)
		scene_add_instances(b, bush + i, (i - 1) % 2);
}

static enum eco_code sample_write(const char *path, const struct eco_ground *ground, bool plain,
	const struct eco_bytes *levels, uint32_t level_count, struct eco_error *error)
{
	struct scene_builder b =
		{ .state = 7, .split = split_32, .texture = { levels }, .texture_levels = level_count,
			.scene = { .name = "sample", .near_m = 0.05, .needs = ECO_NEED_POINTS | ECO_NEED_LINES
			| ECO_NEED_TRIANGLES | ECO_NEED_TEXTURES | ECO_NEED_GROUND | ECO_NEED_SUMMARIES },
		.like = { .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f, .palette_count = 2 } };
	sample_lists(&b, plain);
	sample_tables(&b, plain);
	enum eco_code code = scene_add_heights(&b, ground, error);
	code = code ? code : scene_write(&b, path, "{\"name\":\"sample\",\"draft\":true,\"crs\":\"EPSG:32632\",\"origin\":"
		"[691000,5334000,500.5],\"place\":{\"longitude_deg\":11.5621,\"latitude_deg\":48.129,"
		"\"convergence_deg\":1.9082}}", NULL, error);
	scene_free(&b);
	return code;
}

static uint8_t image[1 << 20];

enum eco_code sample_pack_write_on(const char *path, const struct eco_ground *ground, bool plain,
	struct eco_error *error)
{
	static const struct eco_bytes levels[2] = { { image, 1000 }, { image + 1000, 2000 } };
	return sample_write(path, ground, plain, levels, 2, error);
}

static double hills(double x, double y) { return 2 + sin(x * 0.3) + 0.01 * y; }

enum eco_code sample_pack_write_textured(const char *path, const uint32_t *sizes, uint32_t count,
	struct eco_error *error)
{
	struct eco_ground ground = ground_make(16, 16, -8, -8, 8, hills);
	struct eco_bytes levels[SAMPLE_LEVELS_MAX];
	for (uint32_t i = 0, at = 0; i < count; at += sizes[i++])
		levels[i] = (struct eco_bytes){ image + at, sizes[i] };
	enum eco_code code = sample_write(path, &ground, false, levels, count, error);
	eco_ground_free(&ground);
	return code;
}

enum eco_code sample_pack_write(const char *path, struct eco_error *error)
{
	return sample_pack_write_textured(path, (const uint32_t[]){ 1000, 2000 }, 2, error);
}

/* ---- The small one ---- */

enum {
	IMAGE,
	QUADS,
	POINTS,
	WOOD,
	LINES,
	CELL,
	GROUND,
	SUMMARY = GROUND + 3,
	INSTANCES,
	SIMPLE,
	GROUND_IMAGE
};

static uint32_t split_quarter(uint32_t count, uint32_t *ends)
{
	ends[0] = count == 1 ? 1 : count / 4 + 1;
	ends[1] = count;
	return count == 1 ? 1 : 2;
}

struct eco_elements small_pack_elements(const struct eco_list *list, uint32_t count, uint8_t corners)
{
	static const int8_t square[4][3] = { { 0, 0, 0 }, { 20, 0, 1 }, { 20, 15, 5 }, { 0, 15, 4 } };
	struct eco_elements e = elements_make(list, count, corners);
	for (uint32_t i = 0; i < e.corner_count; i++) {
		const int8_t *at = square[i % corners % 4];
		for (uint32_t axis = 0; axis < 3; axis++)
			e.position[3 * i + axis] = (int32_t)(i / corners * (37 + 50 * axis) % 1000)
				+ at[axis];
		for (uint32_t k = 0; e.uv && k < 2; k++)
			e.uv[2 * i + k] = at[k] * 100;
	}
	for (uint32_t i = 0; i < count * e.extra_count; i++)
		e.extra[i] = (int32_t)(i % 3);
	return e;
}

static void small_lists(struct scene_builder *b)
{
	static const struct scene_row rows[] = {
		[IMAGE] = { ECO_LIST_IMAGE, ECO_CODER_BYTES, 0, 0, ECO_NONE, 0, 0 },
		[QUADS] = { ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS,
		ECO_ATTR_COLOR | ECO_ATTR_UV | ECO_ATTR_GROWTH, 0, IMAGE, 40, 4 },
		[POINTS] = { ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_COLOR | ECO_ATTR_SIZE, 0, QUADS, 40,
		1 }, [WOOD] = { ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR, 0, ECO_NONE, 30, 3 },
		[LINES] = { ECO_LIST_LINES, ECO_CODER_ELEMENTS, ECO_ATTR_WIDTH, 0, ECO_NONE, 12, 2 },
		[CELL] = { ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 0, ECO_NONE, 20, 4 },
		/* two tiles of 38 x 20 samples and what stands for both */
		[GROUND] = { ECO_LIST_GROUND, ECO_CODER_ROWS, 0, ECO_NONE, ECO_NONE, 0, 0 },
		[GROUND + 1] = { ECO_LIST_GROUND, ECO_CODER_ROWS, 0, ECO_NONE, ECO_NONE, 0, 0 },
		[GROUND + 2] = { ECO_LIST_GROUND, ECO_CODER_ROWS, 0, ECO_NONE, ECO_NONE, 0, 0 },
		[SUMMARY] = { ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_COLOR | ECO_ATTR_PLANT, 1, ECO_NONE, 50,
		1 }, [INSTANCES] = { ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1, ECO_NONE,
		SMALL_PACK_PLANTS, 1 },
		/* the leaves as one triangle each: forms need not follow what they are forms of */
		[SIMPLE] = { ECO_LIST_TRIANGLES, ECO_CODER_FORM, ECO_ATTR_COLOR, 0, QUADS, 40, 3 },
	};
	for (uint32_t id = 0; id <= SIMPLE; id++) {
		scene_add_list(b, scene_list(b, &rows[id]));
		if (rows[id].count)
			b->elements[id] = small_pack_elements(&b->lists[id], rows[id].count,
				rows[id].corners);
	}
	for (uint32_t i = 0; i < SMALL_PACK_PLANTS; i++) {
		b->elements[INSTANCES].extra[2 * i] = (int32_t)(9000 * i);
		b->elements[INSTANCES].extra[2 * i + 1] = (int32_t)(60000 + 1000 * i);
	}
	static const struct eco_bytes levels[2] = { { (uint8_t *)"no WebP file", 12 },
		{ (uint8_t *)"and no other", 12 } };
	b->texture[0] = levels;
	b->texture_levels = 2;
}

static void small_ground(struct scene_builder *b)
{
	b->scene.ground_columns = 38;
	b->scene.ground_rows = 20;
	for (uint32_t i = 0; i < 3; i++) {
		struct eco_ground_tile t = { .list = GROUND + i, .level = i == 0, .column = i == 2,
			.child_count = i ? 0 : 2, .child_first = i == 0,
			.error_m = i ? 0 : 0.25f, .low_m = 0, .high_m = 0.5f };
		struct eco_list *list = &b->lists[t.list];
		struct eco_ground_span x, y;
		eco_ground_spans(&x, &y, &t, 38, 20);
		list->level = t.level;
		list->columns = x.count;
		scene_elements(b, t.list, x.count * y.count, 1);
		for (uint32_t k = 0; k < x.count * y.count; k++) {
			int32_t column = (int32_t)eco_ground_span_at(&x, k % x.count),
				row = (int32_t)eco_ground_span_at(&y, k / x.count);
			memcpy(b->elements[t.list].position + 3 * k,
				(int32_t[3]){ column, row, column * row % 20 }, 12);
		}
		scene_add_ground(b, t);
	}
}

/* One tile, in levels that are as little WebP as the texture's. */
static void small_ground_image(struct scene_builder *b)
{
	static const struct eco_bytes levels[4] = { { (uint8_t *)"level 0", 7 }, { (uint8_t *)"level 1", 7 },
		{ (uint8_t *)"level 2", 7 }, { (uint8_t *)"level 3", 7 } };
	struct eco_list list = scene_list(b,
		&(struct scene_row){ ECO_LIST_GROUND_IMAGE, ECO_CODER_BYTES, 0, ECO_NONE, ECO_NONE, 0, 0 });
	list.grid_step[0] = list.grid_step[1] = 0.25;
	uint32_t id = scene_add_list(b, list);
	b->ends[id] = (struct scene_ends){ NULL, 4, levels };
	scene_add_ground_image(b, (struct eco_ground_image){ .list = id });
}

const struct eco_inventory_row small_pack_rows[SMALL_PACK_PLANTS] = { { NULL, "trees.csv", 12, 14, { NULL } },
	{ NULL, "trees.csv", 3, 5, { NULL } }, { "ash", "trees.csv", 4, 6, { NULL } }, { "ash", NULL, 0, 0, { NULL } }, { 0 },
	{ "elm", "more.geojson", 70000, 0, { NULL } }, { NULL, "more.geojson", 1, 0, { NULL } } };

static void small_inventory(struct scene_builder *b)
{
	static uint8_t bytes[256];
	static struct eco_bytes block = { bytes, 0 };
	struct eco_bytes made = eco_inventory_encode(small_pack_rows, SMALL_PACK_PLANTS);
	if (made.size > sizeof bytes)
		abort();
	memcpy(bytes, made.at, made.size);
	block.size = made.size;
	free(made.at);
	uint32_t id = scene_add_list(b, scene_list(b,
		&(struct scene_row){ ECO_LIST_INVENTORY, ECO_CODER_BYTES, 0, ECO_NONE, ECO_NONE, 0, 0 }));
	b->ends[id] = (struct scene_ends){ NULL, 1, &block };
}

static void small_ladder(struct scene_builder *b, uint32_t anchor, struct eco_ladder l)
{
	l.anchor = anchor;
	l.importance = l.area = l.length = 1;
	l.total = l.total ? l.total : 1;
	l.impostor = ECO_NONE;
	scene_add_ladder(b, l);
}

static void small_plant(struct scene_builder *b)
{
	static const struct eco_curve curves[] =
		{ SCENE_CURVE(0.1f, 2, 0.1f, 0.5f, 0.5f), SCENE_CURVE(0.3f, 1.5f, 0.3f, 0.2f, 0.3f), SCENE_CURVE(1, 1, 1, 0, 0) };
	const uint32_t none = ECO_NONE;
	for (int i = 0; i < 3; i++)
		scene_add_curve(b, curves[i]);
	scene_add_plant(b, (struct eco_plant){ .name = "oak", .height_m = 10, .area = 5, .triangles = 150 });
	scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 5 }, 6 });
	scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 8 }, 2 });
	small_ladder(b, 0, (struct eco_ladder){ .organ = ECO_ORGAN_FOLIAGE, .points = POINTS, .lines = none,
		.simple = SIMPLE, .triangles = QUADS,
		.total = 40, .curve_count = 3 });
	small_ladder(b, 0, (struct eco_ladder){ .organ = ECO_ORGAN_WOOD, .points = none, .lines = LINES,
		.simple = none, .triangles = WOOD,
		.level_count = 2, .level_end = { 8, 30 } });
	small_ladder(b, 0, (struct eco_ladder){ .flags = ECO_LADDER_FAR, .points = none, .lines = LINES,
		.simple = none, .triangles = none });
	small_ladder(b, 1, (struct eco_ladder){ .flags = ECO_LADDER_NEAR, .points = none, .lines = none,
		.simple = none, .triangles = CELL });
}

enum eco_code small_pack_write(struct scene_builder *b, const char *path, struct eco_pack_writer **keep,
	struct eco_error *error)
{
	static const uint8_t colors[4][3] = { { 10, 90, 20 }, { 20, 120, 30 }, { 90, 60, 30 },
		{ 255, 255, 0 } };
	*b = (struct scene_builder){ .split = split_quarter,
		.scene = { .name = "small", .needs = 511 | ECO_NEED_GROUND_IMAGE, .near_m = 0.1 },
		.like = { .grid_origin = { -5, -5, 0 }, .grid_step = { 0.01, 0.01, 0.01 }, .unit_area = 0.01f,
		.palette_count = 4 } };
	scene_add_colors(b, colors, 4);
	small_lists(b);
	small_ground(b);
	small_ground_image(b);
	if (!keep)               /* else it would not be the last list */
		small_inventory(b);
	small_plant(b);
	scene_add_tile(b, (struct eco_tile){ .low = { -10, -10, 0 }, .high = { 10, 10, 12 }, .area = 70,
		.instance_count = 2 * SMALL_PACK_PLANTS,
		.summary = ECO_NONE });
	scene_add_tile(b, (struct eco_tile){ .low = { -5, -5, 0 }, .high = { 5, 5, 12 }, .area = 35,
		.instance_count = SMALL_PACK_PLANTS,
		.summary = SUMMARY, .child_first = 2 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 1, .scale = 1 });
	scene_add_child(b, 0, (struct eco_child){ .tile = 1, .placed = true, .at = { 3, 4, 5 }, .turn = 16384,
		.scale = 1.5f });
	scene_add_instances(b, INSTANCES, 0);
	return scene_write(b, path, SMALL_PACK_META, keep, error);
}
