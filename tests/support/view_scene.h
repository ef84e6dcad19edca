/* A small scene for tests of the client, and streams of it as a server would write them: a tree with wood, lines, leaves that grow
 * by codes, a point for each, and two cells, one with simple forms too; a bush of textured cut-outs; both planted on a hilly ground, some
 * in a nested placement; a summary. */
#ifndef TESTS_VIEW_SCENE_H
#define TESTS_VIEW_SCENE_H

#include <stdlib.h>
#include <string.h>

#include "tests/support/ground_tiles.h"

#include "client-min/view_select.h"
#include "ecofiles/format/chunk.h"
#include "ecofiles/base/turn.h"
#include "ecofiles/format/wire.h"

enum { L_WOOD, L_LINES, L_LEAVES, L_POINTS, L_LOW, L_LOW_POINTS, L_HIGH, L_HIGH_POINTS, L_BUSH, L_IMAGE, L_TREES, L_BUSHES, L_GROUND,
	L_SUMMARY, L_SIMPLE, L_COUNT };
enum { A_TREE, A_LOW, A_HIGH, A_BUSH, A_COUNT };

struct view_scene {
	struct eco_scene scene;
	struct eco_plant plants[2];
	struct eco_anchor anchors[A_COUNT];
	struct eco_list lists[L_COUNT];
	struct eco_elements elements[L_COUNT];           /* before coding */
	struct eco_chunk chunks[512];
	uint8_t *payloads[512];
	uint8_t palette[8][3];
	const uint8_t *png; size_t png_size;             /* of the bush; NULL: the bush has no image */
	uint64_t state;
};

static inline double scene_random(struct view_scene *s)
{
	s->state = s->state * 6364136223846793005u + 1442695040888963407u;
	return (double)(s->state >> 40) / 16777216.0;
}

/* ---- Elements ---- */

static inline void scene_elements(struct view_scene *s, uint32_t id, uint32_t elements, uint32_t corners)
{
	struct eco_elements *e = &s->elements[id];
	e->extra_count = eco_list_extra_count(&s->lists[id]);
	e->corners = malloc(elements);
	e->position = calloc((size_t)elements * corners * 3, 4);
	e->uv = s->lists[id].attributes & ECO_ATTR_UV ? calloc((size_t)elements * corners * 2, 4) : NULL;
	e->extra = e->extra_count ? calloc((size_t)elements * e->extra_count, 4) : NULL;
	e->element_count = elements;
	e->corner_count = elements * corners;
	e->primitive_count = corners > 2 ? elements * (corners - 2) : elements;
	memset(e->corners, (int)corners, elements);
}

static inline void scene_put(struct view_scene *s, uint32_t id, uint32_t corner, double x, double y, double z)
{
	const struct eco_list *l = &s->lists[id];
	const double p[3] = { x, y, z };
	for (int k = 0; k < 3; k++) {
		double v = (p[k] - l->grid_origin[k]) / l->grid_step[k];
		s->elements[id].position[3 * (size_t)corner + k] = (int32_t)(v < 0 ? v - 0.5 : v + 0.5);
	}
}

static inline void scene_leaves(struct view_scene *s, uint32_t id, uint32_t count, double low, double high)
{
	scene_elements(s, id, count, 4);
	for (uint32_t i = 0; i < count; i++) {
		double x, y, z, a[3], b[3];
		do {
			x = scene_random(s) * 2 - 1, y = scene_random(s) * 2 - 1, z = scene_random(s) * 2 - 1;
		} while (x * x + y * y + z * z > 1);
		for (int k = 0; k < 3; k++)
			a[k] = (scene_random(s) - 0.5) * 0.5, b[k] = (scene_random(s) - 0.5) * 0.5;
		x *= 2, y *= 2, z = low + (z * 0.5 + 0.5) * (high - low);
		scene_put(s, id, 4 * i, x - a[0], y - a[1], z - a[2]);
		scene_put(s, id, 4 * i + 1, x - b[0], y - b[1], z - b[2]);
		scene_put(s, id, 4 * i + 2, x + a[0], y + a[1], z + a[2]);
		scene_put(s, id, 4 * i + 3, x + b[0], y + b[1], z + b[2]);
		s->elements[id].extra[2 * i] = (int32_t)(scene_random(s) * 3.999);
		s->elements[id].extra[2 * i + 1] = (int32_t)(scene_random(s) * 7.999);
	}
}

/* A point in each leaf's middle, of sizes that differ. */
static inline void scene_points(struct view_scene *s, uint32_t id, uint32_t leaves)
{
	const struct eco_elements *from = &s->elements[leaves];
	scene_elements(s, id, from->element_count, 1);
	for (uint32_t i = 0; i < from->element_count; i++) {
		for (int k = 0; k < 3; k++)
			s->elements[id].position[3 * i + k] = (from->position[12 * i + k] + from->position[12 * i + 6 + k]) / 2;
		s->elements[id].extra[2 * i] = from->extra[2 * i];
		s->elements[id].extra[2 * i + 1] = (int32_t)(ECO_SIZE_ONE + scene_random(s) * 12) - 6;
	}
}

/* Each leaf as one triangle that grows by the leaf's code. */
static inline void scene_simple(struct view_scene *s, uint32_t id, uint32_t leaves)
{
	const struct eco_elements *from = &s->elements[leaves];
	scene_elements(s, id, from->element_count, 3);
	for (uint32_t i = 0; i < from->element_count; i++)
		memcpy(s->elements[id].position + 9 * i, from->position + 12 * i, 9 * sizeof(int32_t));
	memcpy(s->elements[id].extra, from->extra, 2 * from->element_count * sizeof(int32_t));
}

static inline void scene_wood(struct view_scene *s)
{
	scene_elements(s, L_WOOD, 8 * 6, 4);
	for (uint32_t i = 0; i < 48; i++) {
		uint32_t ring = i / 8;
		static const int corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
		for (uint32_t c = 0; c < 4; c++) {
			double sine, cosine, z = 6.0 * (ring + corner[c][1]) / 6, r = 0.25 * (1 - z / 8);
			eco_turn_sincos((uint16_t)((i + (uint32_t)corner[c][0]) * 8192), &sine, &cosine);
			scene_put(s, L_WOOD, 4 * i + c, r * cosine, r * sine, z);
		}
		s->elements[L_WOOD].extra[i] = 4;
	}
	scene_elements(s, L_LINES, 30, 2);
	for (uint32_t i = 0; i < 30; i++) {
		double z = 0.2 * i, sine, cosine;
		eco_turn_sincos((uint16_t)(i * 19000), &sine, &cosine);
		scene_put(s, L_LINES, 2 * i, 0, 0, z);
		scene_put(s, L_LINES, 2 * i + 1, i % 3 ? 1.4 * cosine : 0, i % 3 ? 1.4 * sine : 0, z + (i % 3 ? 0.8 : 0.6));
		s->elements[L_LINES].extra[2 * i] = 4;
		s->elements[L_LINES].extra[2 * i + 1] = i % 3 ? 60 : 400;        /* in steps of 1 mm */
	}
}

static inline void scene_bush(struct view_scene *s)
{
	scene_elements(s, L_BUSH, 40, 4);
	for (uint32_t i = 0; i < 40; i++) {
		double x = scene_random(s) - 0.5, y = scene_random(s) - 0.5, sine, cosine;
		static const double corner[4][2] = { { -1, 0 }, { 1, 0 }, { 1, 1 }, { -1, 1 } };
		eco_turn_sincos((uint16_t)(scene_random(s) * 65535), &sine, &cosine);
		for (uint32_t c = 0; c < 4; c++) {
			double w = 0.4 * corner[c][0];
			scene_put(s, L_BUSH, 4 * i + c, x + w * cosine, y + w * sine, 0.9 * corner[c][1]);
			s->elements[L_BUSH].uv[2 * (4 * i + c)] = (int32_t)((corner[c][0] + 1) * ECO_UV_ONE) - ECO_UV_ONE / 2;
			s->elements[L_BUSH].uv[2 * (4 * i + c) + 1] = (int32_t)((1 - corner[c][1]) * ECO_UV_ONE);
		}
		s->elements[L_BUSH].extra[i] = 5;
	}
}

static inline double scene_height(double x, double y)
{
	return 0.02 * x + 0.0015 * (x * x - y * y) * 0.3;
}

static inline void scene_instances(struct view_scene *s, uint32_t id, uint32_t count, double reach)
{
	scene_elements(s, id, count, 1);
	for (uint32_t i = 0; i < count; i++) {
		double x = (scene_random(s) - 0.5) * 2 * reach, y = (scene_random(s) - 0.5) * 2 * reach;
		scene_put(s, id, i, x, y, scene_height(x, y));
		s->elements[id].extra[2 * i] = (int32_t)(scene_random(s) * 65535);
		s->elements[id].extra[2 * i + 1] = (int32_t)(65536 * (0.7 + 0.6 * scene_random(s)));
	}
}

static inline void scene_ground(struct view_scene *s)
{
	struct eco_ground ground = ground_make(17, 15, -40, -35, 5, scene_height);
	struct eco_ground_tile tile = { .level = 0 };
	s->lists[L_GROUND] = ground_list(&ground, &tile);
	s->elements[L_GROUND] = ground_elements(&ground, &tile, 0);
	eco_ground_free(&ground);
}

static inline void scene_summary(struct view_scene *s)
{
	scene_elements(s, L_SUMMARY, 400, 1);
	for (uint32_t i = 0; i < 400; i++) {
		int32_t *extra = s->elements[L_SUMMARY].extra + 3 * i;
		double x = (scene_random(s) - 0.5) * 30, y = (scene_random(s) - 0.5) * 30;
		scene_put(s, L_SUMMARY, i, x, y, scene_random(s) * 6);
		extra[0] = (int32_t)(i % 4);
		extra[1] = (int32_t)(i % 2);
		extra[2] = (int32_t)(eco_owner_leaf(i % 7) & 0xffff);
	}
}

/* ---- The scene ---- */

static inline void scene_list(struct view_scene *s, uint32_t id, uint8_t kind, uint8_t coder, uint8_t attributes, uint32_t owner)
{
	struct eco_list *l = &s->lists[id];
	*l = (struct eco_list){ .kind = kind, .coder = coder, .attributes = attributes, .owner = owner, .plant = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE, .palette_count = attributes & ECO_ATTR_COLOR ? 8 : 0 };
	for (int k = 0; k < 3; k++)
		l->grid_step[k] = 0.001;
	l->grid_origin[2] = -0.5;
}

static inline void scene_make_lists(struct view_scene *s)
{
	const uint8_t color = ECO_ATTR_COLOR;
	scene_list(s, L_WOOD, ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, color, 0);
	scene_list(s, L_LINES, ECO_LIST_LINES, ECO_CODER_ELEMENTS, color | ECO_ATTR_WIDTH, 0);
	for (uint32_t id = L_LEAVES; id <= L_HIGH; id += 2) {
		scene_list(s, id, ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, color | ECO_ATTR_GROWTH, 0);
		scene_list(s, id + 1, ECO_LIST_POINTS, ECO_CODER_FORM, color | ECO_ATTR_SIZE, 0);
		s->lists[id + 1].partner = id;
		s->lists[id + 1].unit_area = 0.06f;
	}
	scene_list(s, L_SIMPLE, ECO_LIST_TRIANGLES, ECO_CODER_FORM, color | ECO_ATTR_GROWTH, 0);
	s->lists[L_SIMPLE].partner = L_HIGH;
	scene_list(s, L_BUSH, ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, color | ECO_ATTR_UV, 1);
	s->lists[L_BUSH].image = s->png ? L_IMAGE : ECO_NONE;
	scene_list(s, L_IMAGE, ECO_LIST_IMAGE, ECO_CODER_BYTES, 0, 1);
	for (uint32_t id = L_TREES; id <= L_BUSHES; id++) {
		scene_list(s, id, ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 5);
		s->lists[id].plant = id - L_TREES;
	}
	scene_list(s, L_SUMMARY, ECO_LIST_POINTS, ECO_CODER_KD, color | ECO_ATTR_PLANT, 5);
	s->lists[L_SUMMARY].unit_area = 0.2f;
}

static inline uint32_t scene_encode(struct view_scene *s, uint32_t id, uint32_t chunk)
{
	uint32_t ends[64], count = 0, like = s->lists[id].coder == ECO_CODER_FORM ? s->lists[id].partner : id;
	struct eco_list *l = &s->lists[id];
	l->chunk_first = chunk;
	if (s->elements[like].element_count)
		count = eco_chunk_split(s->elements[like].element_count, id == L_GROUND ? s->elements[id].element_count : 64, ends, 64);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_chunk_input input = { &s->lists[like], &s->elements[like], i ? ends[i - 1] : 0, ends[i], i };
		size_t size = 0;
		enum eco_code code = like == id ? eco_chunk_encode(&input, &s->payloads[chunk], &size, NULL, NULL)
			: eco_chunk_encode_form(&input, l, &s->elements[id], &s->payloads[chunk], &size, NULL);
		if (code)
			abort();
		uint32_t elements = ends[i] - input.first, corners = s->elements[id].corners[0];
		s->chunks[chunk] = (struct eco_chunk){ eco_chunk_hash(s->payloads[chunk], size), 0, (uint32_t)size,
			corners > 2 ? elements * (corners - 2) : elements, elements };
		chunk++;
	}
	l->chunk_count = count;
	l->primitive_count = s->elements[id].primitive_count;
	l->element_count = s->elements[id].element_count;
	return chunk;
}

static inline uint32_t scene_encode_image(struct view_scene *s, uint32_t chunk)
{
	struct eco_list *l = &s->lists[L_IMAGE];
	l->chunk_first = chunk;
	if (!s->png)
		return chunk;
	s->payloads[chunk] = malloc(s->png_size);
	memcpy(s->payloads[chunk], s->png, s->png_size);
	s->chunks[chunk] = (struct eco_chunk){ eco_chunk_hash(s->png, s->png_size), 0, (uint32_t)s->png_size, 1, 1 };
	l->chunk_count = l->primitive_count = l->element_count = 1;
	return chunk + 1;
}

static inline void scene_make(struct view_scene *s, const uint8_t *png, size_t png_size)
{
	static const uint8_t colors[8][3] = { { 70, 110, 40 }, { 88, 130, 50 }, { 60, 96, 44 }, { 104, 140, 60 }, { 92, 70, 50 },
		{ 235, 240, 225 }, { 200, 60, 90 }, { 128, 128, 128 } };
	*s = (struct view_scene){ .state = 7, .png = png, .png_size = png_size };
	memcpy(s->palette, colors, sizeof colors);
	s->plants[0] = (struct eco_plant){ .name = "tree", .height_m = 7, .anchor_first = A_TREE, .anchor_count = 3 };
	s->plants[1] = (struct eco_plant){ .name = "bush", .height_m = 0.9f, .anchor_first = A_BUSH, .anchor_count = 1 };
	s->anchors[A_TREE] = (struct eco_anchor){ { 0, 0, 3.5f }, 4.6f };
	s->anchors[A_LOW] = (struct eco_anchor){ { 0, 0, 3.2f }, 3.2f };
	s->anchors[A_HIGH] = (struct eco_anchor){ { 0, 0, 5.6f }, 3.2f };
	s->anchors[A_BUSH] = (struct eco_anchor){ { 0, 0, 0.45f }, 1.3f };
	scene_make_lists(s);
	scene_wood(s);
	scene_leaves(s, L_LEAVES, 300, 2, 7);
	scene_leaves(s, L_LOW, 260, 2, 4.5);
	scene_leaves(s, L_HIGH, 260, 4.5, 7);
	for (uint32_t id = L_LEAVES; id <= L_HIGH; id += 2)
		scene_points(s, id + 1, id);
	scene_simple(s, L_SIMPLE, L_HIGH);
	scene_bush(s);
	scene_instances(s, L_TREES, 14, 14);
	scene_instances(s, L_BUSHES, 40, 14);
	scene_ground(s);
	scene_summary(s);
	uint32_t chunk = 0;
	for (uint32_t id = 0; id < L_COUNT; id++)
		chunk = id == L_IMAGE ? scene_encode_image(s, chunk) : scene_encode(s, id, chunk);
	s->scene = (struct eco_scene){ .name = "test", .ground_columns = 17, .ground_rows = 15, .near_m = 0.1, .plants = s->plants, .plant_count = 2,
		.anchors = s->anchors, .anchor_count = A_COUNT, .lists = s->lists, .list_count = L_COUNT, .chunks = s->chunks,
		.chunk_count = chunk, .palette = (const uint8_t(*)[3])s->palette, .palette_count = 8 };
}

static inline void scene_free(struct view_scene *s)
{
	for (uint32_t i = 0; i < s->scene.chunk_count; i++)
		free(s->payloads[i]);
	for (uint32_t i = 0; i < L_COUNT; i++)
		eco_elements_free(&s->elements[i]);
}

static inline struct eco_view scene_view(void)
{
	return (struct eco_view){ { -22, -19, 6.5 }, { 0, 0, 2.5 }, { 0, 0, 1 }, 45, 480, 320 };
}

/* ---- Plans ---- */

static inline struct eco_cut scene_rule(uint32_t anchor, uint32_t list, uint32_t first, uint32_t end, float scale, uint8_t band_first,
	uint8_t band_end)
{
	return (struct eco_cut){ .list = list, .first = first, .end = end, .scale = scale, .anchor = anchor, .band_first = band_first,
		.band_end = band_end, .share_end = ECO_SHARE_ONE };
}

/* The simple twin of view_select: every instance, every anchor, every cut. */
static inline uint64_t scene_count(const struct view_scene *s, const struct eco_plan *plan, const struct lod_eye *eye, uint64_t *plants)
{
	uint64_t vertices = 0;
	*plants = 0;
	for (uint32_t c = 0; c < plan->cut_count; c++)
		if (plan->cuts[c].anchor == ECO_NONE && plan->cuts[c].list != L_GROUND)
			vertices += plan->cuts[c].end - plan->cuts[c].first;
	for (uint32_t r = 0; r < plan->run_count; r++)
		for (uint32_t id = plan->runs[r].list_first; id < plan->runs[r].list_end; id++)
			for (uint32_t i = 0; i < s->lists[id].primitive_count; i++) {
				const struct eco_placement *placement = &plan->placements[plan->runs[r].placement];
				const struct eco_plant *plant = &s->plants[s->lists[id].plant];
				struct eco_place at = eco_place_of(&s->elements[id], i);
				struct lod_place place;
				struct lod_anchor_band seen[A_COUNT];
				uint32_t gate = 0;
				for (uint32_t g = 0; g < plan->gate_count; g++)
					if (plan->gates[g].plant == s->lists[id].plant)
						gate = plan->gates[g].end;
				lod_place_instance(&place, placement, &s->lists[id], &at);
				uint32_t hash = lod_share_hash(placement->path, id, i);
				if (lod_open_hash(hash) < plan->runs[r].left)
					continue;
				uint32_t count = lod_instance_anchors(eye, &place, s->anchors + plant->anchor_first, plant->anchor_first,
					plant->anchor_count, gate, hash, seen);
				*plants += count != 0;
				for (uint32_t a = 0; a < count; a++)
					for (uint32_t c = 0; c < plan->cut_count; c++) {
						const struct eco_cut *cut = &plan->cuts[c];
						if (cut->anchor == seen[a].anchor && cut->band_first <= seen[a].band && seen[a].band < cut->band_end &&
							cut->share_first <= hash && hash < cut->share_end)
							vertices += (uint64_t)(cut->end - cut->first) * eco_list_vertices(&s->lists[cut->list]);
					}
			}
	return vertices;
}

/* Near trees in cells (leaves and points below, simple forms and points above), far ones as points; wood as triangles or lines; half the
 * bushes by share; a nested placement of everything further back; a summary beyond it. `end_share` shortens prefixes. */
static inline void scene_plan(const struct view_scene *s, const struct eco_view *view, double end_share, struct eco_plan *plan)
{
	struct lod_eye eye;
	lod_eye_make(&eye, view);
	uint32_t cell = s->lists[L_HIGH].element_count, m = (uint32_t)(cell / 3 * end_share);
	const uint8_t near = 97, middle = 99;            /* about 20 and 28 m */
	struct eco_cut cuts[] = {
		{ .list = L_GROUND, .end = 17 * 15, .scale = 1, .anchor = ECO_NONE },
		{ .list = L_SUMMARY, .end = 300, .scale = 1.3f, .placement = 2, .anchor = ECO_NONE },
		scene_rule(A_TREE, L_WOOD, 0, s->lists[L_WOOD].primitive_count, 1, 0, middle),
		scene_rule(A_TREE, L_LINES, 0, 24, 1, middle, ECO_BANDS),
		scene_rule(A_TREE, L_LEAVES, 0, (uint32_t)(500 * end_share), 1.6f, 0, near),
		scene_rule(A_TREE, L_POINTS, 0, (uint32_t)(280 * end_share), 1.4f, near, ECO_BANDS),
		scene_rule(A_LOW, L_LOW, 0, 4 * m, 1.1f, 0, ECO_BANDS),
		scene_rule(A_LOW, L_LOW_POINTS, 2 * m, cell, 0.9f, 0, ECO_BANDS),
		scene_rule(A_HIGH, L_SIMPLE, 0, m, 1.7f, 0, ECO_BANDS),
		scene_rule(A_HIGH, L_HIGH_POINTS, m, cell, 1.2f, 0, ECO_BANDS),
		scene_rule(A_BUSH, L_BUSH, 0, 80, 1, 0, ECO_BANDS),
	};
	cuts[10].share_end = ECO_SHARE_ONE / 2;
	struct eco_placement placements[] = {
		{ .scale = 1 }, { .at = { 12, 16, 1 }, .turn = 9000, .scale = 0.8, .path = eco_owner_child(1) },
		{ .at = { 20, 25, 0.5 }, .turn = 40000, .scale = 1.2, .path = eco_owner_child(2) },
	};
	struct eco_run runs[] = { { 0, L_TREES, L_BUSHES + 1, 0 }, { 1, L_TREES, L_BUSHES + 1, 30000 } };
	*plan = (struct eco_plan){ .placement_count = 3, .run_count = 2, .gate_count = 1,
		.cut_count = sizeof cuts / sizeof cuts[0], .prediction = { 100, 10, 10 } };
	plan->placements = malloc(sizeof placements);
	plan->runs = malloc(sizeof runs);
	plan->gates = malloc(sizeof *plan->gates);
	plan->cuts = malloc(sizeof cuts);
	memcpy(plan->placements, placements, sizeof placements);
	memcpy(plan->runs, runs, sizeof runs);
	plan->gates[0] = (struct eco_gate){ 0, eco_gate_place(near, ECO_SHARE_ONE / 3) };
	memcpy(plan->cuts, cuts, sizeof cuts);
	eco_plan_sort(plan);
	plan->vertices = scene_count(s, plan, &eye, &plan->visible_plants);
}

/* ---- Streams ---- */

static inline void scene_frame(struct eco_writer *w, const struct view_scene *s, enum eco_frame_type type, uint32_t *number, uint32_t a,
	uint32_t b)
{
	struct eco_frame_mark mark = eco_frame_begin(w, type, (*number)++);
	static const struct eco_chunk_id pack = { { 1, 2, 3 } };
	if (type == ECO_FRAME_SCENE)
		eco_wire_write_scene(w, &s->scene, &pack);
	else if (type == ECO_FRAME_PLANT)
		eco_wire_write_plant(w, &s->scene, a);
	else if (type == ECO_FRAME_LIST)
		eco_wire_write_list(w, &s->scene, a);
	else {
		uint32_t chunk = s->lists[a].chunk_first + b;
		eco_wire_write_chunk(w, &s->scene, a, b);
		eco_write_bytes(w, s->payloads[chunk], s->chunks[chunk].size_bytes);
	}
	eco_frame_end(w, mark);
}

static inline void scene_plan_frame(struct eco_writer *w, const struct eco_plan *plan, uint32_t *number)
{
	struct eco_frame_mark mark = eco_frame_begin(w, ECO_FRAME_PLAN, (*number)++);
	eco_wire_write_plan(w, plan);
	eco_frame_end(w, mark);
}

static inline void scene_end_frame(struct eco_writer *w, uint64_t vertices, uint32_t *number)
{
	struct eco_frame_mark mark = eco_frame_begin(w, ECO_FRAME_END, (*number)++);
	eco_wire_write_end(w, vertices, w->size + 16);
	eco_frame_end(w, mark);
}

/* Chunks of a list that a plan needs. */
static inline uint32_t scene_needs(const struct view_scene *s, const struct eco_plan *plan, uint32_t id)
{
	uint32_t end = 0, chunks = 0, at = 0;
	if (id >= L_TREES && id <= L_GROUND)
		return s->lists[id].chunk_count;
	for (uint32_t c = 0; c < plan->cut_count; c++) {
		uint32_t list = plan->cuts[c].list;
		if (list == id && plan->cuts[c].end > end)
			end = plan->cuts[c].end;
		if (s->lists[list].image == id)
			end = 1;
	}
	for (; at < end; chunks++)
		at += s->chunks[s->lists[id].chunk_first + chunks].primitive_count;
	return chunks;
}

/* Everything that `plan` needs and `held` (chunks per list, or NULL) lacks. */
static inline void scene_stream(const struct view_scene *s, const struct eco_plan *plan, const uint32_t *held, struct eco_writer *w)
{
	uint32_t number = 0;
	*w = (struct eco_writer){ 0 };
	scene_frame(w, s, ECO_FRAME_SCENE, &number, 0, 0);
	if (!held) {
		scene_frame(w, s, ECO_FRAME_PLANT, &number, 0, 0);
		scene_frame(w, s, ECO_FRAME_PLANT, &number, 1, 0);
	}
	for (uint32_t id = 0; id < L_COUNT; id++) {
		uint32_t first = held ? held[id] : 0, end = scene_needs(s, plan, id);
		if (first == 0 && end)
			scene_frame(w, s, ECO_FRAME_LIST, &number, id, 0);
		for (uint32_t c = first; c < end; c++)
			scene_frame(w, s, ECO_FRAME_CHUNK, &number, id, c);
	}
	scene_plan_frame(w, plan, &number);
	scene_end_frame(w, plan->vertices, &number);
}

static inline enum eco_code scene_feed(struct view_store *store, const struct eco_writer *w, struct eco_error *error)
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

/* A store that holds the plan. */
static inline struct view_store *scene_store(const struct view_scene *s, const struct eco_plan *plan, struct eco_error *error)
{
	struct view_store *store;
	struct view_store_options options = { .images = true };
	struct eco_writer w;
	if (view_store_new(&store, &options, error))
		return NULL;
	scene_stream(s, plan, NULL, &w);
	if (scene_feed(store, &w, error)) {
		view_store_free(store);
		store = NULL;
	}
	eco_writer_free(&w);
	return store;
}

#endif
