#include "tests/support/scene_random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/impostor.h"

/* The order in which C evaluates operands and initialisers is open: an expression that draws twice is as the
 * compiler has it. */
uint64_t random_bits(struct scene_builder *b) { return eco_random_next(&b->state); }
double random_real(struct scene_builder *b, double low, double high)
{
	return low + (high - low) * eco_random_unit(random_bits(b));
}
uint32_t random_below(struct scene_builder *b, uint32_t n) { return (uint32_t)(random_bits(b) % n); }

/* ---- Lists ---- */

/* In two chunks, the first of a third. */
static uint32_t add_list(struct scene_builder *b, uint8_t kind, uint32_t primitives, uint32_t owner)
{
	if (primitives == 0)
		return ECO_NONE;
	struct eco_list list =
		scene_list(b, &(struct scene_row){ .kind = kind, .owner = owner, .other = ECO_NONE });
	list.chunk_first = b->scene.chunk_count;
	bool files = kind == ECO_LIST_IMPOSTOR || kind == ECO_LIST_IMAGE || kind == ECO_LIST_OUTLINE
		|| kind == ECO_LIST_GROUND_IMAGE;
	list.chunk_count = files ? primitives : primitives > 1 ? 2 : 1;
	list.primitive_count = list.element_count = primitives;
	for (uint32_t i = 0, left = primitives; i < list.chunk_count; i++) {
		uint32_t n = files ? 1 : i + 1 == list.chunk_count ? left : left / 3 + 1;
		scene_add_chunk(b,
			(struct eco_chunk){ .primitive_count = n, .element_count = n, .size_bytes = 10 * n });
		left -= n;
	}
	return scene_add_list(b, list);
}

uint32_t random_fans(struct scene_builder *b, uint32_t elements, uint32_t owner)
{
	uint32_t id = add_list(b, ECO_LIST_TRIANGLES, elements, owner), mixed = random_below(b, 2);
	struct eco_list *list = &b->lists[id];
	list->coder = ECO_CODER_ELEMENTS;
	list->primitive_count = 0;
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		struct eco_chunk *chunk = &b->chunks[list->chunk_first + c];
		chunk->primitive_count = 2 * chunk->element_count
			+ (mixed ? random_below(b, 2 * chunk->element_count + 1) : 0);
		list->primitive_count += chunk->primitive_count;
	}
	return id;
}

uint32_t random_form(struct scene_builder *b, uint8_t kind, uint32_t of, uint32_t corners)
{
	uint32_t id = add_list(b, kind, b->lists[of].element_count, b->lists[of].owner),
		each = corners == 4 ? 2 : 1;
	struct eco_list *list = &b->lists[id];
	list->coder = ECO_CODER_FORM;
	list->partner = of;
	for (uint32_t c = 0; c < list->chunk_count; c++)
		b->chunks[list->chunk_first + c].primitive_count *= each;
	list->primitive_count *= each;
	return id;
}

/* ---- Plants ---- */

static void add_curve(struct scene_builder *b, struct eco_ladder *ladder)
{
	static const float shares[4] = { 0.001f, 0.03f, 0.2f, 1 };
	float reach = 0;
	ladder->curve_first = b->scene.curve_count;
	ladder->curve_count = 4;
	ladder->flags |= ECO_LADDER_ABOVE;
	for (int i = 0; i < 4; i++) {
		float share = shares[i];
		reach = i == 3 ? 1 : reach + (1 - reach) * (float)random_real(b, 0, 0.8);
		scene_add_curve(b,
			(struct eco_curve)SCENE_CURVE(share, 1, reach, 0.4f * (1 - share), 0.4f * (1 - share)));
	}
	for (uint32_t i = 0; i < 4; i++) {
		struct eco_curve above = b->curves[ladder->curve_first + i];
		above.scale = above.share < 1 ? 1.25f : 1;
		above.fp *= 0.5f;
		scene_add_curve(b, above);
	}
}

enum { LEAVES, BLADES, PLAIN, WOOD };

static void add_leaves(struct scene_builder *b, struct eco_ladder *l, int kind, uint32_t k)
{
	l->triangles = random_fans(b, k, l->plant);
	if (kind == LEAVES) {
		l->points = random_form(b, ECO_LIST_POINTS, l->triangles, 1);
		if (random_below(b, 2))
			l->simple = random_form(b, ECO_LIST_TRIANGLES, l->triangles, 3 + random_below(b, 2));
	} else if (kind == BLADES) {
		l->lines = random_form(b, ECO_LIST_LINES, l->triangles, 2);
	}
}

static void add_wood(struct scene_builder *b, struct eco_ladder *l, uint32_t k)
{
	if (!(l->flags & ECO_LADDER_FAR))
		l->triangles = add_list(b, ECO_LIST_TRIANGLES, k, l->plant);
	l->lines = add_list(b, ECO_LIST_LINES, 1 + random_below(b, k), l->plant);
	if (l->triangles != ECO_NONE && k > 4) {
		l->level_count = 2;
		l->level_end[0] = k / 5;
		l->level_end[1] = k;
	}
}

static void add_ladder(struct scene_builder *b, const struct random_sizes *sizes, uint32_t anchor, int kind,
	uint8_t flags, uint32_t before)
{
	struct eco_ladder l = scene_ladder(b->scene.plant_count - 1, anchor, kind == WOOD ? ECO_ORGAN_WOOD
		: ECO_ORGAN_FOLIAGE);
	uint32_t k = 1 + random_below(b, sizes->elements);
	l.flags = flags;
	l.importance = random_below(b, 4) ? 1 : 3;
	l.area = (float)random_real(b, 0.1, 30);
	l.length = (float)random_real(b, 1, 100);
	l.epsilon = (float)random_real(b, 0, 0.05);
	if (kind == WOOD)
		add_wood(b, &l, k);
	else
		add_leaves(b, &l, kind, k);
	l.before = flags & ECO_LADDER_NEAR && kind != WOOD ? before : 0;
	l.total = (kind == WOOD ? b->lists[l.lines].primitive_count : k) + l.before;
	add_curve(b, &l);
	scene_add_ladder(b, l);
}

/* An impostor of a few levels, with their samples. */
static void add_impostor(struct scene_builder *b, struct eco_ladder *l, uint32_t full)
{
	uint32_t levels = 1 + random_below(b, ECO_IMPOSTOR_LEVELS);
	float error = (float)random_real(b, 0.1, 0.5);
	l->impostor = add_list(b, ECO_LIST_IMPOSTOR, levels, l->plant);
	for (uint32_t i = 0; i < levels; i++, error *= 0.8f)
		scene_add_curve(b, (struct eco_curve)SCENE_CURVE((float)((i + 1.0) / levels / full), 1, 1,
			error, error));
	l->curve_count += levels;
}

/* A few levels, some with leaves before them, those of cells too, and a curve that ends with an error, a small one or a
 * large one. With more splats some miss more and cover less that is wrong. */
static void add_splats(struct scene_builder *b, const struct random_sizes *sizes, uint32_t anchor, uint32_t leaves)
{
	struct eco_ladder l = scene_ladder(b->scene.plant_count - 1, anchor, ECO_ORGAN_FOLIAGE);
	uint32_t size = 1 + random_below(b, 1 + sizes->elements / 16), end = 0,
		levels = 1 + random_below(b, 4);
	while (l.level_count < levels) {
		l.level_end[l.level_count++] = end += size;
		size *= 2 + random_below(b, 3);
	}
	l.points = add_list(b, ECO_LIST_POINTS, end, l.plant);
	b->lists[l.points].attributes = ECO_ATTR_SPLAT;
	l.flags = ECO_LADDER_WHOLE;
	l.curve_first = b->scene.curve_count;
	l.curve_count = 11;
	uint32_t full = end;
	l.total = end;
	if (end % 2) {
		uint32_t cells = 0;
		for (uint32_t i = leaves + 1; i < b->scene.ladder_count; i++)
			if (b->ladders[i].organ != ECO_ORGAN_WOOD)
				cells += b->lists[b->ladders[i].triangles].primitive_count;
		l.triangles = b->ladders[leaves].triangles;
		l.total = b->lists[l.triangles].primitive_count;
		l.total = cells ? l.total + cells : (1 + l.total) / 2;
		full = end - (levels > 1 ? l.level_end[levels - 2] : 0) + 3 * l.total;
	}
	if (end > 1 && random_below(b, 2))
		add_impostor(b, &l, full);
	float first = (float)random_real(b, 0.1, 0.5), last = first * (float)random_real(b, 0, 1);
	float trade = random_below(b, 2) ? 0.09f : 0;
	for (int i = 0; i < 11; i++) {
		float error = first + (last - first) * (float)i / 10;
		if (l.impostor != ECO_NONE && ldexpf((float)full, i - 10) < 1.5f) {
			l.curve_count--;
			continue;
		}
		scene_add_curve(b, (struct eco_curve)SCENE_CURVE(ldexpf(1, i - 10), 1, 1,
			error * (1 - trade * (float)i), error * (1 + trade * (float)i)));
	}
	scene_add_ladder(b, l);
}

static void add_plant(struct scene_builder *b, const struct random_sizes *sizes)
{
	uint32_t cells = random_below(b, 2) ? 0 : 2 + random_below(b, sizes->cells - 1);
	int kind = (int)random_below(b, 3);
	float h = (float)random_real(b, 0.3, 25);
	scene_add_plant(b, (struct eco_plant){ .height_m = h });
	uint32_t anchor = scene_add_anchor(b, (struct eco_anchor){ { 0, 0, h / 2 }, h / 2 });
	uint32_t whole = anchor, leaves = b->scene.ladder_count;
	add_ladder(b, sizes, anchor, kind, 0, 0);
	add_ladder(b, sizes, anchor, WOOD, cells ? ECO_LADDER_FAR : 0, 0);
	for (uint32_t c = 0; c < cells; c++) {
		anchor =
			scene_add_anchor(b,
			(struct eco_anchor){
			{ (float)random_real(b, -h / 4, h / 4), (float)random_real(b, -h / 4, h / 4),
				(float)random_real(b, 0, h) }, h / 4 });
		add_ladder(b, sizes, anchor, kind, ECO_LADDER_NEAR, random_below(b, 40));
		add_ladder(b, sizes, anchor, WOOD, ECO_LADDER_NEAR, 0);
	}
	if (sizes->splats && random_below(b, 4))
		add_splats(b, sizes, whole, leaves);
}

/* ---- Tiles ---- */

static void add_places(struct scene_builder *b, uint32_t tile, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		struct eco_place place =
			{ .position = { (int32_t)random_below(b, 50000), (int32_t)random_below(b, 50000),
			0 } };
		place.scale = 32768 + random_below(b, 65536);
		place.turn = (uint16_t)random_bits(b);
		scene_add_place(b, place);
	}
	b->tiles[tile].instance_count += count;
	b->tiles[tile].area += 20.0 * count;
}

static void add_tile(struct scene_builder *b, const struct random_sizes *sizes, double x, double y)
{
	uint32_t tile =
		scene_add_tile(b,
		(struct eco_tile){ .low = { x - 30, y - 30, -30 }, .high = { x + 80, y + 80, 60 } });
	uint32_t groups = 1 + random_below(b, b->scene.plant_count), count = 0, first = 0;
	uint32_t *ends = malloc(groups * sizeof *ends);
	uint64_t place_first = b->scene.place_count;
	for (uint32_t g = 0; g < groups; g++) {
		uint32_t more = 1 + random_below(b, sizes->places);
		add_places(b, tile, more);
		ends[g] = count += more;
	}
	uint32_t list = add_list(b, ECO_LIST_INSTANCES, count, tile);
	b->lists[list].grid_origin[0] = x;
	b->lists[list].grid_origin[1] = y;
	for (uint32_t g = 0; g < groups; first = ends[g++])
		scene_add_group(b, (struct eco_group){ tile, g, list, place_first + first, first,
			ends[g] - first });
	free(ends);
	b->tiles[tile].summary = add_list(b, ECO_LIST_POINTS, 8 + random_below(b, 64), tile);
}

void random_scene_sized(struct scene_builder *b, uint64_t seed, uint32_t nested, struct random_sizes sizes)
{
	scene_free(b);
	b->state = seed;
	b->like = (struct eco_list){ .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f };
	b->scene.near_m = 0.01;
	uint32_t plants = 1 + random_below(b, sizes.species);
	while (b->scene.plant_count < plants)
		add_plant(b, &sizes);
	scene_add_tile(b, (struct eco_tile){ .low = { -2000, -2000, -30 }, .high = { 2000, 2000, 60 } });
	for (uint32_t i = 0; i < sizes.leaves; i++) {
		add_tile(b, &sizes, i % 2 * 50.0, (double)(i / 2) * 50);
		scene_add_child(b, 0, (struct eco_child){ .tile = 1 + i, .scale = 1 });
		b->tiles[0].instance_count += b->tiles[1 + i].instance_count;
		b->tiles[0].area += b->tiles[1 + i].area;
	}
	if (nested)
		add_tile(b, &sizes, 0, 0);
	for (uint32_t i = 0; i < nested; i++)
		scene_add_child(b, 0, (struct eco_child){ .tile = 1 + sizes.leaves, .placed = true,
			.at = { random_real(b, -500, 500), random_real(b, -500, 500), 0 },
			.turn = (uint16_t)random_bits(b),
			.scale = (float)random_real(b, 0.5, 1.5) });
	b->tiles[0].summary = add_list(b, ECO_LIST_POINTS, 100, 0);
}

void random_scene_make(struct scene_builder *b, uint64_t seed, uint32_t nested)
{
	random_scene_sized(b, seed, nested, (struct random_sizes){ .species = 4, .leaves = 4, .elements = 300,
		.places = 40, .cells = 7 });
}

void random_scene_splats(struct scene_builder *b, uint64_t seed, uint32_t nested)
{
	random_scene_sized(b, seed, nested, (struct random_sizes){ .species = 4, .leaves = 4, .elements = 300,
		.places = 40, .cells = 7, .splats = true });
}

struct eco_view random_view(struct scene_builder *b)
{
	struct eco_view view = { .up = { 0, 0, 1 }, .fov_y_deg = random_real(b, 20, 90),
		.width = 200 + random_below(b, 800),
		.height = 200 + random_below(b, 600) };
	for (int i = 0; i < 2; i++) {
		view.eye[i] = random_real(b, -200, 250);
		view.target[i] = random_real(b, 0, 100);
	}
	view.eye[2] = random_real(b, 1, 80);
	return view;
}

/* ---- As a pack ---- */

/* A root and four tiles under it, from -50 to 150 m. */
static void add_ground(struct scene_builder *b)
{
	struct eco_scene *s = &b->scene;
	s->ground_columns = s->ground_rows = 2 * ECO_GROUND_CELLS + 1;
	for (uint32_t i = 0; i < 5; i++) {
		struct eco_ground_tile t = { .level = i == 0, .column = i ? (i - 1) % 2 : 0,
			.row = i ? (i - 1) / 2 : 0, .child_count = i ? 0 : 4,
			.child_first = i ? 0 : 1, .error_m = i ? 0 : 0.5f, .low_m = -1, .high_m = 1 };
		struct eco_ground_span x, y;
		eco_ground_spans(&x, &y, &t, s->ground_columns, s->ground_rows);
		t.list = add_list(b, ECO_LIST_GROUND, 1, ECO_NONE);
		struct eco_list *list = &b->lists[t.list];
		struct eco_chunk *chunk = &b->chunks[list->chunk_first];
		list->level = t.level;
		list->columns = x.count;
		list->primitive_count = list->element_count = chunk->primitive_count = chunk->element_count =
			x.count * y.count;
		chunk->size_bytes = 30;
		for (int k = 0; k < 2; k++) {
			list->grid_origin[k] = -50;
			list->grid_step[k] = 100.0 / ECO_GROUND_CELLS;
		}
		scene_add_ground(b, t);
	}
}

/* A tile over all of that ground, its quarters, and the quarters of one of these; finer levels of more
 * bytes. */
static void add_ground_images(struct scene_builder *b)
{
	struct eco_list places[9];
	for (uint32_t i = 0; i < 9; i++) {
		uint32_t id = add_list(b, ECO_LIST_GROUND_IMAGE, ECO_GROUND_IMAGE_LEVELS, ECO_NONE);
		places[i] = i ? places[i < 5 ? 0 : 3] : b->lists[id];
		if (!i) {
			places[0].grid_origin[0] = places[0].grid_origin[1] = -50;
			places[0].grid_step[0] = places[0].grid_step[1] = 200.0 / ECO_GROUND_IMAGE_SIDE;
		} else {
			eco_ground_image_quarter(&places[i], (i - 1) % 4);
		}
		for (int k = 0; k < 2; k++) {
			b->lists[id].grid_origin[k] = places[i].grid_origin[k];
			b->lists[id].grid_step[k] = places[i].grid_step[k];
		}
		for (uint32_t k = 0; k < ECO_GROUND_IMAGE_LEVELS; k++)
			b->chunks[b->lists[id].chunk_first + k].size_bytes <<= k;
		scene_add_ground_image(b, (struct eco_ground_image){ id, i == 0 ? 1 : i == 3 ? 5 : 0 });
	}
}

static void finish_lists(struct scene_builder *b)
{
	static const uint8_t coders[] = { [ECO_LIST_TRIANGLES] = ECO_CODER_ELEMENTS,
		[ECO_LIST_LINES] = ECO_CODER_ELEMENTS, [ECO_LIST_POINTS] = ECO_CODER_KD,
		[ECO_LIST_INSTANCES] = ECO_CODER_ROWS, [ECO_LIST_GROUND] = ECO_CODER_ROWS,
		[ECO_LIST_IMAGE] = ECO_CODER_BYTES, [ECO_LIST_IMPOSTOR] = ECO_CODER_BYTES,
		[ECO_LIST_OUTLINE] = ECO_CODER_BYTES, [ECO_LIST_GROUND_IMAGE] = ECO_CODER_BYTES };
	uint32_t image = add_list(b, ECO_LIST_IMAGE, 4, 0),
		outline = add_list(b, ECO_LIST_OUTLINE, 4, 0);
	b->lists[image].unit_area = 1e-6f;
	b->lists[outline].level = 10;            /* 4 % are wrong without its last level */
	b->lists[image].image = outline;
	for (uint32_t i = 0; i < b->scene.list_count; i++) {
		struct eco_list *list = &b->lists[i];
		list->coder = coders[list->kind];
		list->partner = ECO_NONE;
		if (list->kind == ECO_LIST_INSTANCES)
			list->attributes = ECO_ATTR_PLACE;
		if (list->kind == ECO_LIST_TRIANGLES && list->owner == 0)
			list->image = image;
	}
	for (uint32_t i = 0; i < b->scene.tile_count; i++)
		b->lists[b->tiles[i].summary].attributes = ECO_ATTR_PLANT;
}

void random_stand_make(struct scene_builder *b, const struct random_stand *stand)
{
	scene_free(b);
	b->state = 1;
	b->like = (struct eco_list){ .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f };
	b->scene.near_m = 0.01;
	scene_add_plant(b, (struct eco_plant){ .height_m = stand->height_m });
	float half = stand->height_m / 2;
	uint32_t anchor = scene_add_anchor(b, (struct eco_anchor){ { 0, 0, half }, half });
	struct eco_ladder leaves = scene_ladder(0, anchor, ECO_ORGAN_FOLIAGE), splats = leaves;
	leaves.triangles = random_fans(b, leaves.total = stand->leaves, 0);
	leaves.area = stand->area;
	leaves.curve_first = b->scene.curve_count;
	leaves.curve_count = 4;
	for (int i = 0; i < 4; i++)
		scene_add_curve(b, (struct eco_curve)SCENE_CURVE(stand->shares[i], 1, stand->shares[i],
			stand->errors[i], stand->errors[i]));
	scene_add_ladder(b, leaves);
	if (!stand->splats)
		return;
	splats.points = scene_add_bare(b, &(struct scene_row){ .kind = ECO_LIST_POINTS,
		.attributes = ECO_ATTR_SPLAT, .other = ECO_NONE }, stand->splats, stand->splats);
	splats.flags = ECO_LADDER_WHOLE;
	splats.total = splats.level_end[0] = stand->splats;
	splats.level_count = 1;
	splats.curve_first = b->scene.curve_count;
	splats.curve_count = 2;
	for (int i = 0; i < 2; i++)
		scene_add_curve(b, (struct eco_curve)SCENE_CURVE(i ? 1 : 1.0f / (float)stand->splats, 1, 1,
			stand->splat_errors[i][0], stand->splat_errors[i][1]));
	scene_add_ladder(b, splats);
}

uint32_t random_crowd(struct scene_builder *b, struct eco_tile tile, const double origin[2], double size)
{
	uint32_t count = tile.instance_count, index, list, side = (uint32_t)(1000 * size);
	uint64_t first = b->scene.place_count;
	index = scene_add_tile(b, tile);
	list = scene_add_bare(b, &(struct scene_row){ .kind = ECO_LIST_INSTANCES, .owner = index,
		.other = ECO_NONE }, count, count);
	for (int i = 0; i < 2; i++)
		b->lists[list].grid_origin[i] = origin[i];
	for (uint32_t i = 0; i < count; i++)
		scene_add_place(b, (struct eco_place){ .position = { (int32_t)random_below(b, side),
			(int32_t)random_below(b, side), 0 }, .scale = 65536 });
	scene_add_group(b, (struct eco_group){ index, 0, list, first, 0, count });
	scene_add_child(b, 0, (struct eco_child){ .tile = index, .scale = 1 });
	return index;
}

struct random_pack *random_pack_make(uint64_t seed, uint32_t nested, uint32_t factor)
{
	struct random_pack *p = calloc(1, sizeof *p);
	struct scene_builder *b = &p->r;
	size_t size = 0;
	random_scene_make(b, seed, nested);
	add_ground(b);
	add_ground_images(b);
	finish_lists(b);
	for (uint32_t i = 0; i < b->scene.chunk_count; i++) {
		b->chunks[i].size_bytes = b->chunks[i].size_bytes * factor + 1 + random_below(b, 20);
		b->chunks[i].offset = size;
		size += b->chunks[i].size_bytes;
	}
	p->map = malloc(size + 8);
	for (size_t i = 0; i < size; i += 8) {
		uint64_t bits = random_bits(b);
		memcpy(p->map + i, &bits, 8);
	}
	for (uint32_t i = 0; i < b->scene.chunk_count; i++)
		b->chunks[i].id = eco_chunk_hash(p->map + b->chunks[i].offset, b->chunks[i].size_bytes);
	strcpy(b->scene.name, "random");
	b->scene.needs = 511 | ECO_NEED_GROUND_IMAGE;
	p->pack = (struct eco_pack){ .scene = b->scene, .id = eco_chunk_hash(p->map, size), .map = p->map,
		.map_size = size };
	return p;
}

void random_pack_free(struct random_pack *p)
{
	scene_free(&p->r);
	free(p->map);
	free(p);
}
