#include "tests/support/view_scene.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/format/chunk/chunk.h"
#include "lod/build/impostor/impostor_make.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/plan_twin.h"
#include "tests/support/plant_models.h"
#include "client-min/draw/view_gpu.h"
#include "client-min/view_reference.h"
#include "tests/support/unit_test.h"
#include "ecofiles/format/image.h"
#include "lod/raster/flip.h"
#include "tests/support/files.h"

/* ---- Elements ---- */

static double unit(struct scene_builder *b) { return (lcg_bits(&b->state) >> 7) / 16777216.0; }

static void put(struct scene_builder *b, uint32_t id, uint32_t corner, double x, double y, double z)
{
	const struct eco_list *l = &b->lists[id];
	const double p[3] = { x, y, z };
	for (uint32_t k = 0; k < 3; k++) {
		double v = (p[k] - l->grid_origin[k]) / l->grid_step[k];
		b->elements[id].position[3 * corner + k] = (int32_t)(v < 0 ? v - 0.5 : v + 0.5);
	}
}

static void fill_leaves(struct scene_builder *b, uint32_t id, double low, double high)
{
	for (uint32_t i = 0; i < b->elements[id].element_count; i++) {
		double x, y, z, side[2][3];
		do {
			x = unit(b) * 2 - 1, y = unit(b) * 2 - 1, z = unit(b) * 2 - 1;
		} while (x * x + y * y + z * z > 1);
		for (int k = 0; k < 3; k++)
			side[0][k] = (unit(b) - 0.5) * 0.5, side[1][k] = (unit(b) - 0.5) * 0.5;
		x *= 2, y *= 2, z = low + (z * 0.5 + 0.5) * (high - low);
		for (uint32_t c = 0; c < 4; c++) {
			const double *s = side[c % 2], sign = c < 2 ? -1 : 1;
			put(b, id, 4 * i + c, x + sign * s[0], y + sign * s[1], z + sign * s[2]);
		}
		b->elements[id].extra[2 * i] = (int32_t)(unit(b) * 3.999);
		b->elements[id].extra[2 * i + 1] = (int32_t)(unit(b) * 7.999);
	}
}

/* A point in each leaf's middle, of sizes that differ. */
static void fill_points(struct scene_builder *b, uint32_t id)
{
	const struct eco_elements *from = &b->elements[b->lists[id].partner], *to = &b->elements[id];
	for (uint32_t i = 0; i < from->element_count; i++) {
		for (uint32_t k = 0; k < 3; k++)
			to->position[3 * i + k] =
				(from->position[12 * i + k] + from->position[12 * i + 6 + k]) / 2;
		to->extra[2 * i] = from->extra[2 * i];
		to->extra[2 * i + 1] = (int32_t)(ECO_SIZE_ONE + unit(b) * 12) - 6;
	}
}

/* Each leaf as one triangle that grows by the leaf's code. */
static void fill_simple(struct scene_builder *b, uint32_t id)
{
	const struct eco_elements *from = &b->elements[b->lists[id].partner], *to = &b->elements[id];
	for (uint32_t i = 0; i < from->element_count; i++)
		memcpy(to->position + 9 * i, from->position + 12 * i, 9 * sizeof(int32_t));
	memcpy(to->extra, from->extra, 2 * from->element_count * sizeof(int32_t));
}

static void fill_wood(struct scene_builder *b)
{
	static const int corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	double sine, cosine;
	for (uint32_t i = 0; i < 48; i++) {
		for (uint32_t c = 0; c < 4; c++) {
			double z = 6.0 * (i / 8 + (uint32_t)corner[c][1]) / 6, r = 0.25 * (1 - z / 8);
			eco_angle16_sincos((uint16_t)((i + (uint32_t)corner[c][0]) * 8192), &sine, &cosine);
			put(b, L_WOOD, 4 * i + c, r * cosine, r * sine, z);
		}
		b->elements[L_WOOD].extra[i] = 4;
	}
	for (uint32_t i = 0; i < 30; i++) {
		double z = 0.2 * i;
		eco_angle16_sincos((uint16_t)(i * 19000), &sine, &cosine);
		put(b, L_LINES, 2 * i, 0, 0, z);
		put(b, L_LINES, 2 * i + 1, i % 3 ? 1.4 * cosine : 0, i % 3 ? 1.4 * sine : 0,
			z + (i % 3 ? 0.8 : 0.6));
		b->elements[L_LINES].extra[2 * i] = 4;
		b->elements[L_LINES].extra[2 * i + 1] = i % 3 ? 60 : 400;        /* in steps of 1 mm */
	}
}

static void fill_bush(struct scene_builder *b)
{
	static const double corner[4][2] = { { -1, 0 }, { 1, 0 }, { 1, 1 }, { -1, 1 } };
	struct eco_elements *e = &b->elements[L_BUSH];
	for (uint32_t i = 0; i < e->element_count; i++) {
		double x = unit(b) - 0.5, y = unit(b) - 0.5, sine, cosine;
		eco_angle16_sincos((uint16_t)(unit(b) * 65535), &sine, &cosine);
		for (uint32_t c = 0; c < 4; c++) {
			double w = 0.4 * corner[c][0];
			put(b, L_BUSH, 4 * i + c, x + w * cosine, y + w * sine, 0.9 * corner[c][1]);
			e->uv[2 * (4 * i + c)] = (int32_t)((corner[c][0] + 1) * ECO_UV_ONE) - ECO_UV_ONE / 2;
			e->uv[2 * (4 * i + c) + 1] = (int32_t)((1 - corner[c][1]) * ECO_UV_ONE);
		}
		e->extra[i] = 5;
	}
}

static double height_at(double x, double y) { return 0.02 * x + 0.0015 * (x * x - y * y) * 0.3; }

static void fill_instances(struct scene_builder *b, uint32_t id, uint32_t plant)
{
	struct eco_elements *e = &b->elements[id];
	for (uint32_t i = 0; i < e->element_count; i++) {
		double x = (unit(b) - 0.5) * 2 * 14, y = (unit(b) - 0.5) * 2 * 14;
		put(b, id, i, x, y, height_at(x, y));
		e->extra[2 * i] = (int32_t)(unit(b) * 65535);
		e->extra[2 * i + 1] = (int32_t)(65536 * (0.7 + 0.6 * unit(b)));
	}
	scene_add_instances(b, id, plant);
}

static void fill_ground(struct scene_builder *b)
{
	struct eco_ground ground = ground_make(17, 15, -40, -35, 5, height_at);
	struct eco_ground_tile tile = { .level = 0 };
	b->lists[L_GROUND] = ground_list(&ground, &tile);
	b->elements[L_GROUND] = ground_elements(&ground, &tile, 0);
	b->scene.ground_columns = ground.columns;
	b->scene.ground_rows = ground.rows;
	eco_ground_free(&ground);
}

static void fill_summary(struct scene_builder *b)
{
	for (uint32_t i = 0; i < b->elements[L_SUMMARY].element_count; i++) {
		double x = (unit(b) - 0.5) * 30, y = (unit(b) - 0.5) * 30;
		put(b, L_SUMMARY, i, x, y, unit(b) * 6);
		memcpy(b->elements[L_SUMMARY].extra + 3 * i, (int32_t[3]){ (int32_t)(i % 4), (int32_t)(i % 2),
			(int32_t)(eco_owner_leaf(i % 7) & 0xffff) }, 12);
	}
}

/* ---- The scene ---- */

#define COLOR ECO_ATTR_COLOR
#define TILES 6                  /* the last has the plants */
#define LEAVES(n) { ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, COLOR | ECO_ATTR_GROWTH, 0, ECO_NONE, n, 4 }
#define POINTS(of, n) { ECO_LIST_POINTS, ECO_CODER_FORM, COLOR | ECO_ATTR_SIZE, 0, of, n, 1 }

static const struct scene_row rows[L_COUNT] = {
	[L_WOOD] = { ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, COLOR, 0, ECO_NONE, 48, 4 },
	[L_LINES] = { ECO_LIST_LINES, ECO_CODER_ELEMENTS, COLOR | ECO_ATTR_WIDTH, 0, ECO_NONE, 30, 2 },
	[L_LEAVES] = LEAVES(300), [L_POINTS] = POINTS(L_LEAVES, 300),
	[L_LOW] = LEAVES(260), [L_LOW_POINTS] = POINTS(L_LOW, 260),
	[L_HIGH] = LEAVES(260), [L_HIGH_POINTS] = POINTS(L_HIGH, 260),
	[L_BUSH] = { ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, COLOR | ECO_ATTR_UV, 1, L_IMAGE, 40, 4 },
	[L_IMAGE] = { ECO_LIST_IMAGE, ECO_CODER_BYTES, 0, 1, ECO_NONE, 0, 0 },
	[L_TREES] = { ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 5, ECO_NONE, 14, 1 },
	[L_BUSHES] = { ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 5, ECO_NONE, 40, 1 },
	[L_GROUND] = { ECO_LIST_GROUND, ECO_CODER_ROWS, 0, ECO_NONE, ECO_NONE, 0, 0 },
	[L_SUMMARY] = { ECO_LIST_POINTS, ECO_CODER_KD, COLOR | ECO_ATTR_PLANT, 5, ECO_NONE, 400, 1 },
	[L_SIMPLE] = { ECO_LIST_TRIANGLES, ECO_CODER_FORM, COLOR | ECO_ATTR_GROWTH, 0, L_HIGH, 260, 3 },
	[L_IMPOSTOR] = { ECO_LIST_IMPOSTOR, ECO_CODER_BYTES, 0, 0, ECO_NONE, 0, 0 },
	[L_OUTLINE] = { ECO_LIST_OUTLINE, ECO_CODER_BYTES, 0, 1, ECO_NONE, 0, 0 },
};

static uint32_t split_64(uint32_t count, uint32_t *ends) { return eco_chunk_split(count, 64, ends, 64); }

void scene_make(struct scene_builder *b, const struct eco_bytes *const texture[2], uint32_t levels)
{
	static const uint8_t colors[8][3] = { { 70, 110, 40 }, { 88, 130, 50 }, { 60, 96, 44 },
		{ 104, 140, 60 }, { 92, 70, 50 },
		{ 235, 240, 225 }, { 200, 60, 90 }, { 128, 128, 128 } };
	*b = (struct scene_builder){ .state = 7, .texture_levels = levels, .split = split_64,
		.texture = { texture ? texture[0] : NULL, texture ? texture[1] : NULL },
		.scene = { .name = "test", .near_m = 0.1 },
		.like = { .grid_origin = { 0, 0, -0.5 }, .grid_step = { 0.001, 0.001, 0.001 },
		.palette_count = 8 } };
	scene_add_colors(b, colors, 8);
	scene_add_plant(b, (struct eco_plant){ .name = "tree", .height_m = 7, .leaf_width = 2000, .leaf_tone = 40 });
	scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 3.5f }, 4.6f });
	scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 3.2f }, 3.2f });
	scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 5.6f }, 3.2f });
	scene_add_plant(b, (struct eco_plant){ .name = "bush", .height_m = 0.9f });
	scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 0.45f }, 1.3f });
	for (int i = 0; i < TILES; i++)
		scene_add_tile(b, (struct eco_tile){ .summary = ECO_NONE });
	scene_add_rows(b, rows, L_COUNT);
	b->lists[L_BUSH].image = texture ? L_IMAGE : ECO_NONE;
	b->lists[L_IMAGE].image = L_OUTLINE;
	b->lists[L_SUMMARY].unit_area = 0.2f;
	fill_wood(b);
	fill_leaves(b, L_LEAVES, 2, 7);
	fill_leaves(b, L_LOW, 2, 4.5);
	fill_leaves(b, L_HIGH, 4.5, 7);
	for (uint32_t id = L_POINTS; id <= L_HIGH_POINTS; id += 2) {
		b->lists[id].unit_area = 0.06f;
		fill_points(b, id);
	}
	b->lists[L_HIGH_POINTS].cover = 9;
	fill_simple(b, L_SIMPLE);
	fill_bush(b);
	fill_instances(b, L_TREES, 0);
	fill_instances(b, L_BUSHES, 1);
	fill_ground(b);
	fill_summary(b);
	scene_encode(b);
}

void scene_make_impostor(struct scene_builder *b, uint32_t leaves)
{
	struct soup soup;
	struct lod_impostors made;
	struct eco_bytes files[ECO_IMPOSTOR_LEVELS];
	soup_tree(&soup, leaves, leaves / 50, false);
	if (lod_impostors_make(&made, &soup.model, &(struct lod_impostors_options){ 0 }, NULL))
		abort();
	for (uint32_t i = 0; i < made.level_count; i++) {
		struct eco_writer w = { 0 };
		if (eco_impostor_level_write(&w, &made.body, &made.levels[i], NULL, NULL))
			abort();
		files[i] = (struct eco_bytes){ w.bytes, w.size };
	}
	scene_add_files(b, L_IMPOSTOR, files, made.level_count);
	for (uint32_t i = 0; i < made.level_count; i++)
		free(files[i].at);
	lod_impostors_free(&made);
	soup_free(&soup);
}

struct eco_view scene_view(void)
{
	return (struct eco_view){ { -22, -19, 6.5 }, { 0, 0, 2.5 }, { 0, 0, 1 }, 45, 480, 320 };
}

/* ---- Plans ---- */

struct eco_cut scene_rule(uint32_t anchor, uint32_t list, uint32_t first, uint32_t end, float scale,
	uint8_t band_first, uint8_t band_end)
{
	return (struct eco_cut){ .list = list, .first = first, .end = end, .scale = scale, .anchor = anchor,
		.band_first = band_first,
		.band_end = band_end, .share_end = ECO_SHARE_ONE };
}

void scene_plan(const struct scene_builder *b, const struct eco_view *view, double end_share,
	struct eco_plan *plan)
{
	uint32_t cell = b->lists[L_HIGH].element_count, m = (uint32_t)(cell / 3 * end_share);
	const uint8_t near = 97, middle = 99, far = ECO_BANDS;            /* about 20 and 28 m */
	struct eco_cut cuts[] = {
		{ .list = L_GROUND, .end = 17 * 15, .scale = 1, .anchor = ECO_NONE },
		{ .list = L_SUMMARY, .end = 300, .scale = 1.3f, .placement = 2, .anchor = ECO_NONE,
			.halvings = 2 },
		scene_rule(A_TREE, L_WOOD, 0, b->lists[L_WOOD].primitive_count, 1, 0, middle),
		scene_rule(A_TREE, L_LINES, 0, 24, 1, middle, far),
		scene_rule(A_TREE, L_LEAVES, 0, (uint32_t)(500 * end_share), 1.6f, 0, near),
		scene_rule(A_TREE, L_POINTS, 0, (uint32_t)(280 * end_share), 1.4f, near, far),
		scene_rule(A_LOW, L_LOW, 0, 4 * m, 1.1f, 0, far),
		scene_rule(A_LOW, L_LOW_POINTS, 2 * m, cell, 0.9f, 0, far),
		scene_rule(A_HIGH, L_SIMPLE, 0, m, 1.7f, 0, far),
		scene_rule(A_HIGH, L_HIGH_POINTS, m, cell, 1.2f, 0, far),
		scene_rule(A_BUSH, L_BUSH, 0, 80, 1, 0, far),
		{ .list = L_IMAGE, .end = b->texture_levels, .scale = 1, .anchor = ECO_NONE,
			.share_end = ECO_SHARE_ONE },
		{ .list = L_OUTLINE, .end = b->texture_levels, .scale = 1, .anchor = ECO_NONE,
			.share_end = ECO_SHARE_ONE },
	};
	cuts[10].share_end = ECO_SHARE_ONE / 2;
	const struct eco_placement placements[] = {
		{ .scale = 1 },
			{ .at = { 12, 16, 1 }, .turn = 9000, .scale = 0.8, .path = eco_owner_child(1) },
		{ .at = { 20, 25, 0.5 }, .turn = 40000, .scale = 1.2, .path = eco_owner_child(2) },
	};
	const struct eco_run runs[] = { { 0, L_TREES, L_BUSHES + 1, 0 },
		{ 1, L_TREES, L_BUSHES + 1, 30000 } };
	*plan = (struct eco_plan){ .placement_count = 3, .run_count = 2, .gate_count = 1,
		.cut_count = sizeof cuts / sizeof cuts[0] - (b->texture_levels ? 0 : 2),
		.prediction = { 100, 10, 10 } };
	plan->placements = memcpy(malloc(sizeof placements), placements, sizeof placements);
	plan->runs = memcpy(malloc(sizeof runs), runs, sizeof runs);
	plan->cuts = memcpy(malloc(sizeof cuts), cuts, sizeof cuts);
	plan->gates = malloc(sizeof *plan->gates);
	plan->gates[0] = (struct eco_gate){ 0, eco_gate_place(near, ECO_SHARE_ONE / 3) };
	eco_plan_sort(plan);
	plan->vertices = plan_twin_vertices(&b->scene, plan, view, &plan->visible_plants);
}

/* ---- Streams ---- */

void scene_frame(struct eco_writer *w, const struct scene_builder *s, enum eco_frame_type type,
	uint32_t *number, uint32_t a, uint32_t b)
{
	static const struct eco_chunk_id pack = { { 1, 2, 3 } };
	struct eco_wire_bundle bundle;
	const struct eco_chunk *chunk = NULL;
	if (*number == 0)
		eco_wire_items_start(&wire_items);
	if (type == ECO_FRAME_SCENE) {
		struct eco_frame_mark mark = eco_frame_begin(w, type, (*number)++);
		eco_wire_write_scene(w, &s->scene, &pack);
		eco_frame_end(w, mark);
		return;
	}
	struct eco_frame_mark mark = wire_bundle_begin(w, number, &bundle);
	if (b == SCENE_PLANT) {
		eco_wire_bundle_plant(&bundle, &s->scene, a, true);
	} else if (b == SCENE_RECORD) {
		eco_wire_bundle_list(&bundle, &s->scene, a);
	} else {
		eco_wire_bundle_chunk(&bundle, &s->scene, a, b, false);
		chunk = &s->chunks[s->lists[a].chunk_first + b];
	}
	wire_bundle_end(w, mark, &bundle, chunk ? s->payloads[chunk - s->chunks] : NULL,
		chunk ? chunk->size_bytes : 0);
}

uint32_t scene_needs(const struct scene_builder *b, const struct eco_plan *plan, uint32_t id)
{
	uint32_t end = 0, chunks = 0, at = 0;
	if (id >= L_TREES && id <= L_GROUND)
		return b->lists[id].chunk_count;
	for (uint32_t c = 0; c < plan->cut_count; c++) {
		uint32_t list = plan->cuts[c].list;
		if (list == id && plan->cuts[c].end > end)
			end = plan->cuts[c].end;
	}
	for (; at < end; chunks++)
		at += b->chunks[b->lists[id].chunk_first + chunks].primitive_count;
	return chunks;
}

void scene_stream(const struct scene_builder *b, const struct eco_plan *plan, const uint32_t *held,
	struct eco_writer *w)
{
	uint32_t number = 0;
	*w = (struct eco_writer){ 0 };
	scene_frame(w, b, ECO_FRAME_SCENE, &number, 0, 0);
	for (uint32_t plant = 0; plant < 2 && !held; plant++)
		scene_frame(w, b, ECO_FRAME_BUNDLE, &number, plant, SCENE_PLANT);
	for (uint32_t id = 0; id < L_COUNT; id++) {
		uint32_t first = held ? held[id] : 0, end = scene_needs(b, plan, id);
		if (first == 0 && end)
			scene_frame(w, b, ECO_FRAME_BUNDLE, &number, id, SCENE_RECORD);
		for (uint32_t c = first; c < end; c++)
			scene_frame(w, b, ECO_FRAME_BUNDLE, &number, id, c);
	}
	wire_put_plan(w, &number, plan);
	wire_put_end(w, &number, plan->vertices, 0);
}

enum eco_code scene_feed(struct view_store *store, const struct eco_writer *w, struct eco_error *error)
{
	struct eco_wire_parser *parser;
	enum eco_code code = eco_wire_parser_new(&parser, &view_store_events, store, error);
	view_store_begin(store);
	if (!code)
		code = eco_wire_feed(parser, w->bytes, w->size, error);
	if (!code)
		code = eco_wire_finish(parser, error);
	eco_wire_parser_free(parser);
	return code;
}

struct view_store *scene_store(const struct scene_builder *b, const struct eco_plan *plan,
	struct eco_error *error)
{
	struct view_store *store;
	struct view_store_options options = { .images = true };
	struct eco_writer w;
	if (view_store_new(&store, &options, error))
		return NULL;
	scene_stream(b, plan, NULL, &w);
	if (scene_feed(store, &w, error)) {
		view_store_free(store);
		store = NULL;
	}
	eco_writer_free(&w);
	return store;
}

struct scene_held scene_hold_view(const struct scene_builder *b, struct eco_view view, double end_share)
{
	struct scene_held h = { .view = view };
	struct eco_error error = { 0 };
	lod_eye_make(&h.eye, &view);
	scene_plan(b, &view, end_share, &h.plan);
	h.store = scene_store(b, &h.plan, &error);
	if (!h.store) {
		fprintf(stderr, "%s\n", error.text);
		abort();
	}
	return h;
}

struct scene_held scene_hold(const struct scene_builder *b) { return scene_hold_view(b, scene_view(), 1); }

void scene_select(struct scene_held *h)
{
	struct eco_error error = { 0 };
	if (view_select_make(&h->selection, h->store, &h->eye, &error)) {
		fprintf(stderr, "%s\n", error.text);
		abort();
	}
}

void scene_release(struct scene_held *h)
{
	view_select_free(&h->selection);
	view_store_free(h->store);
	eco_plan_free(&h->plan);
}

struct view_picture scene_draw(const struct scene_held *h, bool by_gl, enum view_tint tint)
{
	struct view_picture picture;
	assert_good(view_picture_init(&picture, h->view.width, h->view.height, &cause));
	if (by_gl)
		assert_good(view_gl_draw(scene_gl, &(struct view_draw_job){ h->store, &h->selection, &h->eye,
			0.1, 2, NULL, tint, 1, false },
			&picture, &cause));
	else
		assert_good(view_reference_draw(&(struct view_draw_job){ h->store, &h->selection, &h->eye,
			0.1, 2, NULL, tint, 1, false }, &picture, &cause));
	return picture;
}

struct picture_difference picture_compare(const struct view_picture *a, const struct view_picture *b)
{
	struct picture_difference d = { .seen = 1 };
	size_t pixels = (size_t)a->width * a->height;
	double part = 1 / (double)pixels;
	for (size_t i = 0; i < pixels; i++) {
		bool color = false, same = a->owner[i] == b->owner[i] && a->cover[i] == b->cover[i];
		for (size_t k = 3 * i; k < 3 * i + 3; k++) {
			int apart = abs(a->rgb[k] - b->rgb[k]);
			d.bytes += apart * part / 3;
			color |= apart > 1;
		}
		d.covered += a->cover[i] ? part : 0;
		d.masks += a->cover[i] != b->cover[i] ? part : 0;
		d.owners += same ? 0 : part;
		d.depths += same && fabsf(a->depth[i] - b->depth[i]) > 1e-4f * a->depth[i] ? part : 0;
		d.colors += same && color ? part : 0;
	}
	d.seen = lod_flip(&(struct lod_flip_input){ a->width, a->height, a->rgb, b->rgb, NULL });
	return d;
}

void picture_save(const char *name, const struct view_picture *p)
{
	char path[128];
	snprintf(path, sizeof path, "build/tmp/%s.png", name);
	folder_make("build/tmp");
	eco_png_write(&(struct eco_pixels){ p->width, p->height, 3, p->rgb }, path, NULL);
}

void scene_holdings(const struct view_store *store, uint32_t held[L_COUNT])
{
	struct eco_holdings holdings;
	assert_int_equal(view_store_holdings(store, &holdings, NULL), ECO_OK);
	for (uint32_t id = 0; id < L_COUNT; id++)
		held[id] = eco_holdings_chunks(&holdings, id);
	for (uint32_t i = 1; i < holdings.count; i++)
		assert_true(holdings.items[i - 1].list < holdings.items[i].list);
	free(holdings.items);
}

struct scene_builder grove;
struct view_gl *scene_gl;

int scene_open(void **state)
{
	scene_make(&grove, NULL, 0);
	return 0;
}

int scene_open_gl(void **state)
{
	struct eco_view view = scene_view();
	struct eco_error error = { 0 };
	if (!grove.lists)
		scene_open(state);
	if (view_gl_open(&scene_gl, &(struct view_gl_options){ view.width, view.height }, &error))
		print_message("OpenGL tests are skipped: %s\n", error.text);
	else
		print_message("drawn by %s\n", view_gl_renderer(scene_gl));
	return 0;
}

int scene_close(void **state)
{
	view_gl_close(scene_gl);
	scene_free(&grove);
	return 0;
}

/* ---- Shadow maps ---- */

static unsigned put_rows(const struct view_shadow *shadow)
{
	unsigned texture = view_gpu_texture(GL_RGBA32UI, 4, 1, GL_NEAREST);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 4, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, shadow->row);
	return texture;
}

static float *cast_by_gl(struct view_gl *gl, const struct view_shadow_job *job,
	const struct view_shadow *shadow)
{
	float *depths = malloc(sizeof *depths * job->size * job->size);
	unsigned framebuffer, table = put_rows(shadow),
		depth = view_gpu_texture(GL_DEPTH_COMPONENT32F, job->size, job->size, GL_NEAREST);
	const unsigned textures[] = { table, depth };
	glGenFramebuffers(1, &framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
	struct view_gl_map map = { job->store, job->casters, job->eye, framebuffer, table, job->size };
	assert_good(view_gl_cast(gl, &map, &cause));
	glReadPixels(0, 0, (int)job->size, (int)job->size, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteTextures(2, textures);
	return depths;
}

static size_t compare_tops(const struct view_shadow *shadow, const float *depths, const char *name)
{
	size_t covered = 0, apart = 0, count = (size_t)shadow->size * shadow->size;
	for (size_t i = 0; i < count; i++) {
		float top = shadow->top[i], part = 2 * depths[i] - 1;
		bool is = top > -INFINITY, there = depths[i] > 0;
		covered += is || there;
		apart += is != there || (is && fabsf(64 * part / (1 - fabsf(part)) - top) > 0.02f);
	}
	print_message("%s: of %zu texels %zu differ\n", name, covered, apart);
	assert_true(apart * 200 <= covered);
	return covered;
}

size_t shadow_gl_compare(struct view_gl *gl, const struct view_shadow_job *job, const char *name)
{
	struct view_shadow shadow;
	assert_good(view_shadow_make(&shadow, job, &cause));
	float *depths = cast_by_gl(gl, job, &shadow);
	size_t covered = compare_tops(&shadow, depths, name);
	free(depths);
	view_shadow_free(&shadow);
	return covered;
}
