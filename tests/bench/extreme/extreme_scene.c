#include "tests/bench/extreme/extreme_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client-min/view_select.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/wire.h"
#include "tests/bench/bench_fetch.h"
#include "tests/support/files.h"

#define TILE_PLANTS 20u          /* so that the shared stand has four tiles */

/* ---- Stands ---- */

enum eco_code extreme_stand_add(struct extreme_stand *stand, struct soup *soup, const char *name,
	struct eco_error *error)
{
	struct lod_plant_options options = { .name = name, .seed = 1, .order = LOD_ORDER_COMBINED,
		.grid_bits = 14, .cell_triangles = 1500, .views = 4,
		.pixels = 64 };
	struct lod_plant *plant = &stand->plants[stand->plant_count];
	enum eco_code code = lod_plant_build(plant, &soup->model, &options, error);
	if (!code)
		code = lod_plant_measure(plant, &soup->model, &options, error);
	stand->plant_count += !code;
	soup_free(soup);
	return code;
}

void extreme_stand_place(struct extreme_stand *stand, const struct eco_source_instance *place)
{
	stand->places[stand->place_count] = *place;
	stand->places[stand->place_count++].height_m = NAN;
}

/* `count` of a plant anywhere in the square, sizes 0.8 to 1.2. */
static void scatter(struct extreme_stand *stand, uint32_t plant, uint32_t count, uint64_t seed)
{
	for (uint32_t i = 0; i < count; i++) {
		double unit[4];
		for (int k = 0; k < 4; k++)
			unit[k] = eco_random_unit(seed = lod_mix(seed + 1));
		extreme_stand_place(stand, &(struct eco_source_instance){ .plant = plant,
			.at = { (unit[0] - 0.5) * EXTREME_SIDE_M, (unit[1] - 0.5) * EXTREME_SIDE_M, 0 },
			.yaw_deg = 360 * unit[2], .scale = 0.8 + 0.4 * unit[3] });
	}
}

static void make_stand(struct extreme_stand *stand)
{
	struct soup soup;
	*stand = (struct extreme_stand){ .place_count = 0 };
	soup_tree(&soup, 1500, 60, false);
	assert_good(extreme_stand_add(stand, &soup, "tree", &cause));
	soup_begin(&soup);
	uint32_t leaf = soup_material(&soup, 70, 130, 50, ECO_NONE, false);
	for (int i = 0; i < 400; i++)
		soup_leaf(&soup, leaf,
			lod_v3_add((struct lod_v3){ 0, 0, 0.6 },
			lod_v3_scale(soup_direction(&soup), 0.6 * sqrt(soup_random(&soup, 0, 1)))), 0.12,
			0.07);
	assert_good(extreme_stand_add(stand, &soup, "bush", &cause));
	soup_begin(&soup);
	leaf = soup_material(&soup, 90, 150, 60, ECO_NONE, false);
	for (int i = 0; i < 60; i++)
		soup_quad(&soup, leaf,
			(struct lod_v3){ soup_random(&soup, -0.3, 0.3), soup_random(&soup, -0.3, 0.3), 0.2 },
			(struct lod_v3){ 0.02, 0, 0 },
			(struct lod_v3){ soup_random(&soup, -0.1, 0.1), soup_random(&soup, -0.1, 0.1), 0.4 });
	assert_good(extreme_stand_add(stand, &soup, "grass", &cause));
	scatter(stand, 0, 14, 1);
	scatter(stand, 1, 20, 2);
	scatter(stand, 2, 26, 3);
}

void extreme_stand_free(struct extreme_stand *stand)
{
	for (uint32_t i = 0; i < stand->plant_count; i++)
		lod_plant_free(&stand->plants[i]);
	*stand = (struct extreme_stand){ 0 };
}

static struct extreme_stand shared;
static struct extreme_world shared_world;

static void free_shared(void)
{
	extreme_world_close(&shared_world);
	extreme_stand_free(&shared);
}

const struct extreme_stand *extreme_stand(void)
{
	if (!shared.plant_count) {
		atexit(free_shared);
		make_stand(&shared);
	}
	return &shared;
}

struct extreme_world *extreme_world(void)
{
	if (!shared_world.scene)
		extreme_world_open(&shared_world, extreme_stand(), &(struct extreme_site){ 0 });
	return &shared_world;
}

/* ---- Packs ---- */

/* Packs a file that nests the one of the stand, of plants that are built, as ecopack would. */
static void pack(void *make)
{
	make_create(make);
	make_plants_pack(make);
	make_places(make);
	make_tiles(make);
	make_commit(make, json_object());
}

static enum eco_code write_pack(const struct extreme_stand *stand, const struct extreme_site *site,
	const char *path, struct eco_error *error)
{
	static char *model[] = { "soup" };
	uint32_t own[EXTREME_PLANTS] = { 0, 1, 2, 3 }, *plant_of[] = { NULL, own };
	struct eco_source_plant plants[EXTREME_PLANTS];
	struct eco_source_instance instances[EXTREME_PLACES];
	struct eco_source_child child = { .source = 1, .scale = site->scale > 0 && !site->plain ? site->scale : 1,
		.yaw_deg = site->plain ? 0 : site->turn * 360.0 / 65536 };
	struct eco_source files[] = { { .path = "site", .tile_instances = ECO_TILE_INSTANCES,
		.children = &child, .child_count = 1 },
		{ .path = "stand", .tile_instances = TILE_PLANTS, .plants = plants, .plant_count = stand->plant_count,
		.instances = instances, .instance_count = stand->place_count } };
	struct make_options options = { .pack = path, .jobs = 1 };
	struct make m = { .options = &options, .error = error, .sources = { files, 2 }, .plant_of = plant_of,
		.plants = eco_alloc(EXTREME_PLANTS, sizeof *m.plants), .plant_count = stand->plant_count,
		.scene.name = "extreme" };
	for (uint32_t i = 0; i < stand->plant_count; i++) {
		plants[i] = (struct eco_source_plant){ .models = model, .model_count = 1 };
		m.plants[i] = (struct make_plant){ .source = &plants[i], .built = stand->plants[i], .importance = 1 };
		memcpy(plants[i].name, stand->plants[i].plant.name, sizeof plants[i].name);
		memcpy(m.plants[i].name, plants[i].name, sizeof plants[i].name);
	}
	memcpy(instances, stand->places, sizeof instances);
	for (int k = 0; k < 3; k++) {
		child.at[k] = site->plain ? 0 : site->at[k];
		for (uint32_t i = 0; i < stand->place_count && site->plain; i++)
			instances[i].at[k] += site->at[k];
	}
	bool was_quiet = eco_progress_quiet(true);
	enum eco_code code = eco_try(pack, &m, error);
	eco_progress_quiet(was_quiet);
	for (uint32_t i = 0; i < stand->plant_count; i++)
		free(m.plants[i].images);
	make_places_free(&m);
	make_tables_free(&m);
	return code;
}

void extreme_world_open(struct extreme_world *world, const struct extreme_stand *stand,
	const struct extreme_site *site)
{
	char path[64];
	folder_make("build/tmp");
	snprintf(path, sizeof path, "build/tmp/extreme-%ld.eco", (long)getpid());
	srv_store_init(&world->store);
	assert_good(write_pack(stand, site, path, &cause));
	assert_good(srv_store_add(&world->store, "extreme", path, &cause));
	unlink(path);                            /* the mapping stays */
	world->scene = world->store.scenes[0];
}

void extreme_world_close(struct extreme_world *world)
{
	srv_store_free(&world->store);
	world->scene = NULL;
}

struct lod_place extreme_placed(const struct extreme_world *world, uint32_t group, uint32_t index)
{
	const struct eco_scene *s = extreme_tables(world);
	struct eco_place stored = eco_place_read(s, s->groups[group].place_first + index);
	struct eco_placement origin = { .scale = 1 };
	struct lod_place place;
	lod_place_instance(&place, &origin, &s->lists[s->groups[group].list], &stored);
	return place;
}

/* ---- Views ---- */

struct eco_view extreme_site_view(const struct extreme_site *site, const struct eco_view *view)
{
	struct eco_view out = *view;
	double sine, cosine, scale = site->scale > 0 && !site->plain ? site->scale : 1;
	eco_angle16_sincos(site->plain ? 0 : site->turn, &sine, &cosine);
	for (int point = 0; point < 3; point++) {
		const double *p = point == 0 ? view->eye : point == 1 ? view->target : view->up;
		double *to = point == 0 ? out.eye : point == 1 ? out.target : out.up,
			s = point == 2 ? 1 : scale;
		double turned[3] = { cosine * p[0] - sine * p[1], sine * p[0] + cosine * p[1], p[2] };
		for (int i = 0; i < 3; i++)
			to[i] = s * turned[i] + (point == 2 ? 0 : site->at[i]);
	}
	return out;
}

struct eco_request extreme_request(uint64_t vertices)
{
	return (struct eco_request){ .view = { .eye = { -26, -21, 6.5 }, .target = { 0, 0, 2 },
		.up = { 0, 0, 1 }, .fov_y_deg = 45, .width = 400,
		.height = 300 }, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
}

/* ---- Plans ---- */

void extreme_sound(const struct eco_plan *plan, const struct eco_request *request)
{
	struct eco_plan *sorted = (struct eco_plan *)plan;
	const struct eco_prediction *p = &plan->prediction;
	double pixels = (double)request->view.width * request->view.height * (1 + 1e-6);
	eco_plan_sort(sorted);
	must_hold(plan->vertices <= request->vertices, "%llu vertices of at most %llu",
		(unsigned long long)plan->vertices, (unsigned long long)request->vertices);
	assert_good(eco_plan_check(sorted, &cause));
	must_hold(p->tp >= 0 && p->fp >= 0 && p->fn >= 0 && p->tp <= pixels && p->fp <= pixels
		&& p->fn <= pixels, "predicted %g, %g and %g of %g pixels", p->tp, p->fp, p->fn, pixels);
}

void extreme_plan(const struct eco_scene *scene, const struct eco_request *request,
	struct eco_plan *plan)
{
	struct lod_planner_input input = { .scene = scene, .request = request };
	assert_good(lod_plan(plan, &input, &cause));
	extreme_sound(plan, request);
}

struct extreme_look extreme_twice(const struct eco_scene *scene, const struct eco_request *request)
{
	struct eco_writer bytes[2] = { { 0 } };
	struct extreme_look look;
	for (int i = 0; i < 2; i++) {
		struct eco_plan plan = { 0 };
		extreme_plan(scene, request, &plan);
		look = (struct extreme_look){ .plants = plan.visible_plants, .vertices = plan.vertices };
		eco_wire_write_plan(&bytes[i], &plan);
		eco_plan_free(&plan);
	}
	assert_int_equal(bytes[0].size, bytes[1].size);
	assert_memory_equal(bytes[0].bytes, bytes[1].bytes, bytes[0].size);
	eco_writer_free(&bytes[0]);
	eco_writer_free(&bytes[1]);
	return look;
}

/* ---- Pictures ---- */

void extreme_draw(const struct extreme_world *world, const struct eco_request *request, struct view_picture *picture)
{
	struct bench_drawing drawing;
	struct view_store *store;
	assert_good(view_store_new(&store, &(struct view_store_options){ .images = true }, &cause));
	assert_good(bench_fetch(NULL, world->scene, request, store, &cause));
	assert_good(bench_draw(&drawing, store, &request->view, NULL, picture, &cause));
	view_select_free(&drawing.selection);
	view_store_free(store);
}

uint64_t extreme_covered(const struct view_picture *picture)
{
	uint64_t covered = 0;
	for (size_t i = 0; i < (size_t)picture->width * picture->height; i++)
		covered += picture->cover[i] != 0;
	return covered;
}

double extreme_pixels_differ(const struct view_picture *a, const struct view_picture *b, bool colours)
{
	size_t count = (size_t)a->width * a->height, differ = 0;
	for (size_t i = 0; i < count; i++)
		differ += a->cover[i] != b->cover[i] || a->owner[i] != b->owner[i]
			|| (colours && memcmp(a->rgb + 3 * i, b->rgb + 3 * i, 3));
	return (double)differ / (double)count;
}
