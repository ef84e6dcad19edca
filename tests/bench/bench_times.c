#include "tests/bench/bench_times.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/base/random.h"

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

enum eco_code bench_plan_time(struct bench_plan_time *time, const struct eco_scene *scene,
	const struct eco_request *request, double least_ms, struct eco_error *error)
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
		*time = (struct bench_plan_time){ 0, stats.candidates, stats.gains, stats.looks, stats.places,
			plan.vertices, plan.cut_count, count };
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
#define SIDE 23u                 /* places along a tile's side */
#define PLACE_M 6.0              /* between neighbours */
#define SAMPLES 12u

static double unit(struct scene_builder *b) { return eco_random_unit(eco_random_next(&b->state)); }

/* Points, then triangles in their order: errors that fall ever more slowly, from one leaf to all. */
static void add_plant(struct scene_builder *b)
{
	uint32_t id = b->scene.plant_count, leaves = 2000 + (uint32_t)(4000 * unit(b));
	float height = (float)(4 + 16 * unit(b));
	scene_add_plant(b, (struct eco_plant){ .height_m = height, .area = 3 * height * height });
	struct eco_ladder l =
		scene_ladder(id, scene_add_anchor(b, (struct eco_anchor){ { 0, 0, height / 2 }, height / 2 }),
		ECO_ORGAN_FOLIAGE);
	l.area = b->plants[id].area;
	l.total = leaves;
	l.curve_first = b->scene.curve_count;
	l.curve_count = SAMPLES;
	l.triangles =
		scene_add_bare(b, &(struct scene_row){ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, id,
		ECO_NONE, 0, 0 }, 2 * leaves, leaves);
	l.points =
		scene_add_bare(b, &(struct scene_row){ ECO_LIST_POINTS, ECO_CODER_FORM, 0, id, l.triangles, 0,
		0 }, leaves, leaves);
	scene_add_ladder(b, l);
	double bend = 0.25 + 0.4 * unit(b);
	for (uint32_t i = 0; i < SAMPLES; i++) {
		float share = (float)ldexp(1, (int)i - (int)SAMPLES + 1),
			wrong = (float)(0.5 * (1 - pow(share, bend)));
		scene_add_curve(b, (struct eco_curve){ share, 1, 1 - wrong, wrong, wrong });
	}
}

/* A tile of places: groups of eight plants of one species after the other. */
static void add_tile(struct scene_builder *b, uint32_t tile, uint32_t across, uint32_t first_species,
	uint32_t species)
{
	double size = SIDE * PLACE_M, x = (tile - 1) % across * size, y = (tile - 1) / across * size;
	scene_add_tile(b, (struct eco_tile){ .low = { x - 30, y - 30, -1 },
		.high = { x + size + 30, y + size + 30, 31 }, .summary = ECO_NONE,
		.instance_count = (uint64_t)species * PLANTS_EACH });
	for (uint32_t g = 0; g < species; g++) {
		uint32_t plant = first_species + g;
		uint32_t list =
			scene_add_bare(b,
			&(struct scene_row){ ECO_LIST_INSTANCES, 0, 0, tile, ECO_NONE, 0, 0 }, PLANTS_EACH,
			PLANTS_EACH);
		b->lists[list].grid_origin[0] = x;
		b->lists[list].grid_origin[1] = y;
		scene_add_group(b, (struct eco_group){ tile, plant, list, b->scene.place_count, 0, 0 });
		for (uint32_t i = 0; i < PLANTS_EACH; i++) {
			uint32_t spot = (g * PLANTS_EACH + i) * 7919u % (SIDE * SIDE),
				scale = 49152 + (uint32_t)(32768 * unit(b));
			scene_add_place(b, (struct eco_place){
				{ (int32_t)(1000 * PLACE_M * (spot % SIDE)),
					(int32_t)(1000 * PLACE_M * (spot / SIDE)), 0 }, 0, scale });
		}
		b->tiles[tile].area += PLANTS_EACH * (double)b->plants[plant].area;
	}
	scene_add_child(b, 0, (struct eco_child){ .tile = tile, .scale = 1 });
	b->tiles[0].instance_count += b->tiles[tile].instance_count;
	b->tiles[0].area += b->tiles[tile].area;
}

void bench_choice_make(struct bench_choice *choice, uint32_t species)
{
	uint32_t each = TILE_PLACES / PLANTS_EACH, tiles = (species + each - 1) / each,
		across = (uint32_t)ceil(sqrt(tiles));
	struct scene_builder *b = &choice->made;
	double size = across * SIDE * PLACE_M;
	*b = (struct scene_builder){ .scene.near_m = 0.1, .state = species,
		.like = { .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f } };
	for (uint32_t i = 0; i < species; i++)
		add_plant(b);
	scene_add_tile(b, (struct eco_tile){ .low = { -30, -30, -1 }, .high = { size + 30, size + 30, 31 },
		.summary = ECO_NONE });
	for (uint32_t i = 0; i < tiles; i++)
		add_tile(b, i + 1, across, i * each, species - i * each < each ? species - i * each : each);
	choice->request =
		(struct eco_request){
		.view = { .eye = { size / 2, -size, size }, .target = { size / 2, size / 2, 0 },
		.up = { 0, 0, 1 },
		.fov_y_deg = 50, .width = 1600, .height = 1200 }, .bytes = ECO_BYTES_UNBOUNDED };
}

void bench_choice_free(struct bench_choice *choice) { scene_free(&choice->made); }
