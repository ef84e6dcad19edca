#include "tests/bench/bench_times.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/base/mix.h"
#include "lod/plan/plan_tables.h"

#define REPETITIONS_MAX 200u
#define REPETITIONS_LEAST 3u

static double now_ms(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

enum eco_code bench_plan_time(struct bench_plan_time *time, const struct eco_scene *scene, const struct eco_request *request, double least_ms,
	struct eco_error *error)
{
	double ms[REPETITIONS_MAX], sum = 0;
	struct lod_planner_stats stats = { 0 };
	struct lod_planner_input input = { .scene = scene, .request = request, .stats = &stats };
	uint32_t count = 0;
	enum eco_code code = lod_plan_tables_make(&input.tables, scene, error);
	while (!code && (count < REPETITIONS_LEAST || (count < REPETITIONS_MAX && sum < least_ms))) {
		struct eco_plan plan = { 0 };
		double from = now_ms();
		code = lod_plan(&plan, &input, error);
		sum += ms[count++] = now_ms() - from;
		*time = (struct bench_plan_time){ 0, stats.candidates, stats.gains, stats.looks, stats.places, plan.vertices, plan.cut_count, count };
		eco_plan_free(&plan);
	}
	lod_plan_tables_free(input.tables);
	if (code)
		return code;
	qsort(ms, count, sizeof *ms, ascending);
	time->ms = ms[count / 2];
	return ECO_OK;
}

#define BLOCK 250000000u
#define COPIES 5u

double bench_copy_ms(void)
{
	uint8_t *from = malloc(BLOCK), *to = malloc(BLOCK);
	double ms[COPIES] = { NAN };
	if (from && to) {
		memset(from, 1, BLOCK);
		memset(to, 2, BLOCK);
		for (uint32_t i = 0; i < COPIES; i++) {
			double start = now_ms();
			for (uint32_t k = 0; k < 1000000000u / BLOCK; k++) {
				from[k] = (uint8_t)i;
				memcpy(to, from, BLOCK);
				__asm__ volatile("" : : "r"(to) : "memory");
			}
			ms[i] = now_ms() - start;
		}
		qsort(ms, COPIES, sizeof *ms, ascending);
	}
	free(from);
	free(to);
	return from && to ? ms[COPIES / 2] : NAN;
}

/* ---- Scenes to choose in ---- */

#define PLANTS_EACH 8u
#define TILE_PLACES 512u
#define PLACE_M 6.0              /* between neighbours */
#define SAMPLES 12u

struct maker {                           /* tables of the scene that is made: those of `scene`, to be written to */
	struct eco_scene scene;
	struct eco_plant *plants;
	struct eco_anchor *anchors;
	struct eco_ladder *ladders;
	struct eco_curve *curves;
	struct eco_tile *tiles;
	struct eco_group *groups;
	struct eco_child *children;
	struct eco_list *lists;
	struct eco_chunk *chunks;
	uint8_t *places;
	uint64_t state;
	uint32_t across;
};

static double random_real(struct maker *m)
{
	return eco_mix_unit(eco_mix_next(&m->state));
}

static uint32_t add_list(struct maker *m, const struct eco_list *like, uint32_t elements)
{
	struct eco_list *list = &m->lists[m->scene.list_count];
	*list = *like;
	list->chunk_first = m->scene.chunk_count;
	list->chunk_count = 1;
	list->image = ECO_NONE;
	list->unit_area = 1e-3f;
	for (int i = 0; i < 3; i++)
		list->grid_step[i] = 1e-3;
	list->element_count = elements;
	m->chunks[m->scene.chunk_count++] = (struct eco_chunk){ .primitive_count = list->primitive_count, .element_count = elements,
		.size_bytes = 8 * elements };
	return m->scene.list_count++;
}

/* Points, then triangles in their order: errors that fall ever more slowly, from one leaf to all. */
static void add_plant(struct maker *m)
{
	struct eco_scene *s = &m->scene;
	uint32_t id = s->plant_count++, leaves = 2000 + (uint32_t)(4000 * random_real(m));
	float height = (float)(4 + 16 * random_real(m));
	struct eco_plant *p = &m->plants[id];
	*p = (struct eco_plant){ .height_m = height, .area = 3 * height * height, .anchor_first = s->anchor_count, .anchor_count = 1,
		.ladder_first = s->ladder_count, .ladder_count = 1 };
	m->anchors[s->anchor_count++] = (struct eco_anchor){ { 0, 0, height / 2 }, height / 2 };
	struct eco_ladder *l = &m->ladders[s->ladder_count++];
	*l = (struct eco_ladder){ .plant = id, .anchor = p->anchor_first, .organ = ECO_ORGAN_FOLIAGE, .lines = ECO_NONE, .simple = ECO_NONE,
		.importance = 1, .area = p->area, .total = leaves, .curve_first = s->curve_count, .curve_count = SAMPLES };
	l->triangles = add_list(m, &(struct eco_list){ .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS, .owner = id, .plant = ECO_NONE,
		.partner = ECO_NONE, .primitive_count = 2 * leaves }, leaves);
	l->points = add_list(m, &(struct eco_list){ .kind = ECO_LIST_POINTS, .coder = ECO_CODER_FORM, .owner = id, .plant = ECO_NONE,
		.partner = l->triangles, .primitive_count = leaves }, leaves);
	double bend = 0.25 + 0.4 * random_real(m);
	for (uint32_t i = 0; i < SAMPLES; i++) {
		float share = (float)ldexp(1, (int)i - (int)SAMPLES + 1), wrong = (float)(0.5 * (1 - pow(share, bend)));
		m->curves[s->curve_count++] = (struct eco_curve){ share, 1, 1 - wrong, wrong, wrong };
	}
}

/* A tile of places: groups of eight plants of one species after the other. */
static void add_tile(struct maker *m, uint32_t tile, uint32_t first_species, uint32_t species)
{
	struct eco_scene *s = &m->scene;
	uint32_t column = (tile - 1) % m->across, row = (tile - 1) / m->across, side = 23;
	double size = side * PLACE_M, x = column * size, y = row * size;
	struct eco_tile *t = &m->tiles[tile];
	*t = (struct eco_tile){ .low = { x - 30, y - 30, -1 }, .high = { x + size + 30, y + size + 30, 31 }, .summary = ECO_NONE,
		.group_first = s->group_count, .group_count = species };
	for (uint32_t g = 0; g < species; g++) {
		uint32_t list = add_list(m, &(struct eco_list){ .kind = ECO_LIST_INSTANCES, .owner = tile, .plant = first_species + g, .partner = ECO_NONE,
			.primitive_count = PLANTS_EACH }, PLANTS_EACH);
		m->lists[list].grid_origin[0] = x;
		m->lists[list].grid_origin[1] = y;
		m->groups[s->group_count++] = (struct eco_group){ tile, first_species + g, list, s->place_count };
		for (uint32_t i = 0; i < PLANTS_EACH; i++) {
			uint32_t spot = (g * PLANTS_EACH + i) * 7919u % (side * side), scale = 49152 + (uint32_t)(32768 * random_real(m));
			int32_t p[3] = { (int32_t)(1000 * PLACE_M * (spot % side)), (int32_t)(1000 * PLACE_M * (spot / side)), 0 };
			uint8_t *at = m->places + ECO_PLACE_BYTES * s->place_count++;
			for (int k = 0; k < 3; k++)
				for (int b = 0; b < 4; b++)
					at[4 * k + b] = (uint8_t)((uint32_t)p[k] >> (8 * b));
			for (int b = 0; b < 4; b++)
				at[16 + b] = (uint8_t)(scale >> (8 * b));
		}
		t->instance_count += PLANTS_EACH;
		t->area += PLANTS_EACH * (double)m->plants[first_species + g].area;
	}
	m->children[s->child_count++] = (struct eco_child){ .tile = tile, .scale = 1 };
}

static bool reserve(struct maker *m, uint32_t species, uint32_t tiles)
{
	m->scene.plants = m->plants = calloc(species, sizeof *m->plants);
	m->scene.anchors = m->anchors = calloc(species, sizeof *m->anchors);
	m->scene.ladders = m->ladders = calloc(species, sizeof *m->ladders);
	m->scene.curves = m->curves = calloc((size_t)SAMPLES * species, sizeof *m->curves);
	m->scene.tiles = m->tiles = calloc(tiles + 1u, sizeof *m->tiles);
	m->scene.groups = m->groups = calloc(species, sizeof *m->groups);
	m->scene.children = m->children = calloc(tiles, sizeof *m->children);
	m->scene.lists = m->lists = calloc(3 * (size_t)species, sizeof *m->lists);
	m->scene.chunks = m->chunks = calloc(3 * (size_t)species, sizeof *m->chunks);
	m->scene.places = m->places = calloc((size_t)species * PLANTS_EACH, ECO_PLACE_BYTES);
	return m->plants && m->anchors && m->ladders && m->curves && m->tiles && m->groups && m->children && m->lists && m->chunks && m->places;
}

enum eco_code bench_choice_make(struct bench_choice *choice, uint32_t species, struct eco_error *error)
{
	uint32_t each = TILE_PLACES / PLANTS_EACH, tiles = (species + each - 1) / each;
	struct maker m = { .scene = { .near_m = 0.1 }, .state = species, .across = (uint32_t)ceil(sqrt(tiles)) };
	bool room = reserve(&m, species, tiles);
	choice->scene = m.scene;
	if (!room) {
		bench_choice_free(choice);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a scene of %u species", species);
	}
	for (uint32_t i = 0; i < species; i++)
		add_plant(&m);
	double size = m.across * 23 * PLACE_M;
	m.tiles[0] = (struct eco_tile){ .low = { -30, -30, -1 }, .high = { size + 30, size + 30, 31 }, .summary = ECO_NONE };
	m.scene.tile_count = tiles + 1;
	for (uint32_t i = 0; i < tiles; i++) {
		uint32_t left = species - i * each;
		add_tile(&m, i + 1, i * each, left < each ? left : each);
		m.tiles[0].instance_count += m.tiles[i + 1].instance_count;
		m.tiles[0].area += m.tiles[i + 1].area;
	}
	m.tiles[0].child_count = m.scene.child_count;
	choice->scene = m.scene;
	choice->request = (struct eco_request){ .view = { .eye = { size / 2, -size, size }, .target = { size / 2, size / 2, 0 }, .up = { 0, 0, 1 },
		.fov_y_deg = 50, .width = 1600, .height = 1200 }, .bytes = ECO_BYTES_UNBOUNDED };
	return ECO_OK;
}

void bench_choice_free(struct bench_choice *choice)
{
	const struct eco_scene *s = &choice->scene;
	const void *all[] = { s->plants, s->anchors, s->ladders, s->curves, s->tiles, s->groups, s->children, s->lists, s->chunks, s->places };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free((void *)all[i]);
	*choice = (struct bench_choice){ 0 };
}
