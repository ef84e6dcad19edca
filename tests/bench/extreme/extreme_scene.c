#include "tests/bench/extreme/extreme_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client-min/view_select.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/format/wire.h"
#include "lod/build/summary.h"
#include "tests/bench/bench_fetch.h"
#include "tests/support/files.h"
#include "tests/support/scene_builder.h"

#define TILES 4u
#define LISTS_MOST 256u          /* of a plant */
#define STEP_M 0x1p-13           /* of instance grids */
#define BODY_M 1.5               /* plants reach so many times their radius from their place */

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
	return code ? code : plant->list_count <= LISTS_MOST ? ECO_OK
		: eco_fail(error, ECO_TOO_LARGE, "%u lists", plant->list_count);
}

void extreme_stand_place(struct extreme_stand *stand, const struct extreme_place *place)
{
	stand->places[stand->place_count++] = *place;
}

/* `count` of a plant anywhere in the square, sizes 0.8 to 1.2. */
static void scatter(struct extreme_stand *stand, uint32_t plant, uint32_t count, uint64_t seed)
{
	for (uint32_t i = 0; i < count; i++) {
		double unit[4];
		for (int k = 0; k < 4; k++)
			unit[k] = eco_random_unit(seed = lod_mix(seed + 1));
		extreme_stand_place(stand, &(struct extreme_place){ .plant = plant,
			.at = { (unit[0] - 0.5) * stand->side, (unit[1] - 0.5) * stand->side, 0 },
			.turn = (uint16_t)(unit[2] * 65535), .scale = 0.8 + 0.4 * unit[3] });
	}
}

static void make_stand(struct extreme *x, struct extreme_stand *stand)
{
	struct soup soup;
	*stand = (struct extreme_stand){ .side = EXTREME_SIDE_M, .near_m = 0.05, .summaries = true };
	soup_tree(&soup, 1500, 60, false);
	extreme_good(x, extreme_stand_add(stand, &soup, "tree", &x->error));
	soup_begin(&soup);
	uint32_t leaf = soup_material(&soup, 70, 130, 50, ECO_NONE, false);
	for (int i = 0; i < 400; i++)
		soup_leaf(&soup, leaf,
			lod_v3_add((struct lod_v3){ 0, 0, 0.6 },
			lod_v3_scale(soup_direction(&soup), 0.6 * sqrt(soup_random(&soup, 0, 1)))), 0.12,
			0.07);
	extreme_good(x, extreme_stand_add(stand, &soup, "bush", &x->error));
	soup_begin(&soup);
	leaf = soup_material(&soup, 90, 150, 60, ECO_NONE, false);
	for (int i = 0; i < 60; i++)
		soup_quad(&soup, leaf,
			(struct lod_v3){ soup_random(&soup, -0.3, 0.3), soup_random(&soup, -0.3, 0.3), 0.2 },
			(struct lod_v3){ 0.02, 0, 0 },
			(struct lod_v3){ soup_random(&soup, -0.1, 0.1), soup_random(&soup, -0.1, 0.1), 0.4 });
	extreme_good(x, extreme_stand_add(stand, &soup, "grass", &x->error));
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

const struct extreme_stand *extreme_stand(struct extreme *x)
{
	if (!shared.plant_count) {
		atexit(free_shared);
		make_stand(x, &shared);
	}
	return &shared;
}

struct extreme_world *extreme_world(struct extreme *x)
{
	if (!shared_world.scene)
		extreme_world_open(x, &shared_world, extreme_stand(x), &(struct extreme_site){ 0 });
	return &shared_world;
}

/* ---- Packs ---- */

/* a scene while it is written: its root places a tile that has the stand's four */
struct packing {
	const struct extreme_stand *stand;
	const struct extreme_site *site;
	struct scene_builder b;
	uint32_t palette_first[EXTREME_PLANTS];
};

static uint32_t add_list(struct packing *p, uint32_t id, uint32_t i, const uint32_t *lists)
{
	const struct lod_plant *plant = &p->stand->plants[id];
	const struct lod_list_draft *draft = &plant->lists[i], *like = draft->list.partner == ECO_NONE ? draft
		: &plant->lists[draft->list.partner];
	struct eco_list list = draft->list;
	list.owner = id;
	list.image = ECO_NONE;
	list.palette_first += list.palette_count ? p->palette_first[id] : 0;
	list.partner = list.partner == ECO_NONE ? ECO_NONE : lists[list.partner];
	uint32_t added = scene_add_made(&p->b, list, draft->elements);
	p->b.ends[added] = (struct scene_ends){ like->ends, like->end_count, NULL };
	return added;
}

static uint32_t add_impostor(struct packing *p, uint32_t id)
{
	const struct lod_plant *plant = &p->stand->plants[id];
	struct scene_row row = { .kind = ECO_LIST_IMPOSTOR, .coder = ECO_CODER_BYTES, .owner = id,
		.other = ECO_NONE };
	if (!plant->impostor_count)
		return ECO_NONE;
	struct eco_list list = scene_list(&p->b, &row);
	for (int k = 0; k < 3; k++)
		list.grid_step[k] = 1;
	uint32_t added = scene_add_list(&p->b, list);
	p->b.ends[added] = (struct scene_ends){ NULL, plant->impostor_count, plant->impostor };
	return added;
}

static uint32_t moved(const uint32_t *ids, uint32_t index)
{
	return index == ECO_NONE ? ECO_NONE : ids[index];
}

/* Elements and ends of its lists stay the stand's. */
static void add_plant(struct packing *p, uint32_t id)
{
	const struct lod_plant *plant = &p->stand->plants[id];
	struct scene_builder *b = &p->b;
	uint32_t lists[LISTS_MOST + 1], anchors = b->scene.anchor_count, curves = b->scene.curve_count;
	p->palette_first[id] = b->scene.palette_count;
	scene_add_colors(b, plant->palette, plant->palette_count);
	for (int forms = 0; forms < 2; forms++)
		for (uint32_t i = 0; i < plant->list_count; i++)
			if ((plant->lists[i].list.partner != ECO_NONE) == forms)
				lists[i] = add_list(p, id, i, lists);
	lists[plant->list_count] = add_impostor(p, id);
	scene_add_plant(b, plant->plant);
	for (uint32_t i = 0; i < plant->plant.anchor_count; i++)
		scene_add_anchor(b, plant->anchors[i]);
	for (uint32_t i = 0; i < plant->curve_count; i++)
		scene_add_curve(b, plant->curves[i]);
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		struct eco_ladder l = plant->ladders[i];
		l.plant = id;
		l.anchor += anchors;
		l.curve_first += curves;
		l.points = moved(lists, l.points);
		l.lines = moved(lists, l.lines);
		l.simple = moved(lists, l.simple);
		l.triangles = moved(lists, l.triangles);
		l.impostor = moved(lists, l.impostor);
		scene_add_ladder(b, l);
	}
	b->scene.needs |= ECO_NEED_SPLATS | ECO_NEED_IMPOSTORS;
	b->scene.needs |= plant->plant.anchor_count > 1 ? ECO_NEED_CELLS : 0;
}

/* Extends the tile by plants within these bounds. */
static void grow_tile(struct eco_tile *tile, const double low[3], const double high[3], uint64_t count,
	double area)
{
	for (int i = 0; i < 3; i++) {
		tile->low[i] = tile->instance_count ? fmin(tile->low[i], low[i]) : low[i];
		tile->high[i] = tile->instance_count ? fmax(tile->high[i], high[i]) : high[i];
	}
	tile->instance_count += count;
	tile->area += area;
}

static void grow_by_plant(struct packing *p, uint32_t tile, const struct extreme_place *place)
{
	const struct eco_plant *plant = &p->b.plants[place->plant];
	const struct eco_anchor *anchor = &p->b.anchors[plant->anchor_first];
	double reach = BODY_M * (anchor->radius + hypot(anchor->center[0], anchor->center[1])) * place->scale,
		low[3], high[3];
	for (int i = 0; i < 3; i++) {
		double at = place->at[i] + (p->site->plain ? p->site->at[i] : 0);
		low[i] = at - reach;
		high[i] = at + (i < 2 ? reach : (anchor->center[2] + anchor->radius) * BODY_M * place->scale);
	}
	grow_tile(&p->b.tiles[tile], low, high, 1, (double)plant->area * place->scale * place->scale);
}

/* The plants of one species in one quarter, if there are any. */
static void add_group(struct packing *p, uint32_t quarter, uint32_t tile, uint32_t plant)
{
	struct eco_list list =
		scene_list(&p->b, &(struct scene_row){ ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE,
		tile, ECO_NONE, 0, 0 });
	struct eco_elements e = elements_make(&list, p->stand->place_count, 1);
	double corner = p->stand->side / 2;
	uint32_t count = 0;
	for (int i = 0; i < 3; i++) {
		list.grid_step[i] = STEP_M;
		list.grid_origin[i] = (i < 2 ? -corner : 0) + (p->site->plain ? p->site->at[i] : 0);
	}
	for (uint32_t i = 0; i < p->stand->place_count; i++) {
		const struct extreme_place *place = &p->stand->places[i];
		if (place->plant != plant || (place->at[0] >= 0) + 2u * (place->at[1] >= 0) != quarter)
			continue;
		for (uint32_t k = 0; k < 3; k++)
			e.position[3 * count + k] =
				(int32_t)floor((place->at[k] + (k < 2 ? corner : 0)) / STEP_M + 0.5);
		e.extra[2 * count] = place->turn;
		e.extra[2 * count + 1] = (int32_t)(place->scale * 65536 + 0.5);
		grow_by_plant(p, tile, place);
		count++;
	}
	e.element_count = e.corner_count = e.primitive_count = count;
	if (count)
		scene_add_instances(&p->b, scene_add_made(&p->b, list, e), plant);
	else
		eco_elements_free(&e);
}

static void add_root(struct packing *p)
{
	const struct extreme_site *site = p->site;
	double scale = site->scale > 0 ? site->scale : 1, far = 0;
	struct eco_child child = { .tile = 1, .placed = true, .scale = 1 };
	if (!site->plain)
		child = (struct eco_child){ 1, true, { site->at[0], site->at[1], site->at[2] }, site->turn,
			(float)scale };
	scene_add_child(&p->b, 0, child);
	for (uint32_t t = 2; t < p->b.scene.tile_count; t++) {
		const struct eco_tile *tile = &p->b.tiles[t];
		if (!tile->instance_count)
			continue;
		grow_tile(&p->b.tiles[1], tile->low, tile->high, tile->instance_count, tile->area);
		scene_add_child(&p->b, 1, (struct eco_child){ .tile = t, .scale = 1 });
	}
	struct eco_tile *root = &p->b.tiles[0], *stand = &p->b.tiles[1];
	for (int i = 0; i < 3; i++)
		far = fmax(far, fmax(fabs(stand->low[i]), fabs(stand->high[i])));
	for (int i = 0; i < 3; i++) {
		root->low[i] = child.at[i] - 2 * scale * far;
		root->high[i] = child.at[i] + 2 * scale * far;
	}
	root->area = stand->area * scale * scale;
	root->instance_count = stand->instance_count;
	p->b.scene.near_m = fmax(p->stand->near_m * scale, 1e-9);
}

static void add_summary(struct packing *p, const struct lod_pool *pools, uint32_t tile)
{
	struct lod_summary summary = { 0 };
	struct eco_list list;
	struct eco_elements e = { 0 };
	lod_summary_make(&summary, &(struct lod_summary_input){ .scene = &p->b.scene, .pools = pools,
		.tile = tile,
		.count = lod_summary_count(&p->b.tiles[tile]), .seed = 1 });
	if (summary.count) {
		lod_summary_list(&summary, &p->b.scene, tile, p->b.scene.palette_count, &list, &e);
		p->b.tiles[tile].summary = scene_add_made(&p->b, list, e);
	}
	free(summary.points);
}

static void add_summaries(struct packing *p)
{
	struct lod_pool pools[EXTREME_PLANTS] = { { 0 } };
	for (uint32_t i = 0; i < p->stand->plant_count; i++)
		lod_pool_make(&pools[i], &p->stand->plants[i], p->palette_first[i], 512);
	for (uint32_t t = 1; t < p->b.scene.tile_count; t++)
		if (p->b.tiles[t].instance_count)
			add_summary(p, pools, t);
	for (uint32_t i = 0; i < p->stand->plant_count; i++)
		lod_pool_free(&pools[i]);
}

static enum eco_code write_pack(const struct extreme_stand *stand, const struct extreme_site *site,
	const char *path, struct eco_error *error)
{
	struct packing p =
		{ .stand = stand, .site = site,
		.b.scene = { .name = "extreme", .needs = ECO_NEED_POINTS | ECO_NEED_LINES | ECO_NEED_TRIANGLES
			| ECO_NEED_PLACEMENTS | (stand->summaries ? ECO_NEED_SUMMARIES : 0) } };
	for (uint32_t i = 0; i < stand->plant_count; i++)
		add_plant(&p, i);
	uint32_t borrowed = p.b.scene.list_count;
	for (uint32_t t = 0; t < 2; t++)
		scene_add_tile(&p.b, (struct eco_tile){ .summary = ECO_NONE });
	for (uint32_t t = 0; t < TILES; t++) {
		uint32_t tile =
			scene_add_tile(&p.b,
			(struct eco_tile){ .summary = ECO_NONE, .group_first = p.b.scene.group_count });
		for (uint32_t plant = 0; plant < stand->plant_count; plant++)
			add_group(&p, t, tile, plant);
	}
	add_root(&p);
	if (stand->summaries)
		add_summaries(&p);
	enum eco_code code = scene_write(&p.b, path, "{\"name\":\"extreme\"}", NULL, error);
	memset(p.b.elements, 0, borrowed * sizeof *p.b.elements);
	scene_free(&p.b);
	return code;
}

void extreme_world_open(struct extreme *x, struct extreme_world *world, const struct extreme_stand *stand,
	const struct extreme_site *site)
{
	char path[64];
	folder_make("build/tmp");
	snprintf(path, sizeof path, "build/tmp/extreme-%ld.eco", (long)getpid());
	srv_store_init(&world->store);
	extreme_good(x, write_pack(stand, site, path, &x->error));
	extreme_good(x, srv_store_add(&world->store, "extreme", path, &x->error));
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

struct eco_view extreme_view(const double eye[3], const double target[3])
{
	return (struct eco_view){ { eye[0], eye[1], eye[2] }, { target[0], target[1], target[2] },
		{ 0, 0, 1 }, 45, 320, 240 };
}

/* ---- Plans ---- */

void extreme_sound(struct extreme *x, const struct eco_plan *plan, const struct eco_request *request)
{
	struct eco_plan *sorted = (struct eco_plan *)plan;
	const struct eco_prediction *p = &plan->prediction;
	double pixels = (double)request->view.width * request->view.height * (1 + 1e-6);
	eco_plan_sort(sorted);
	extreme_must(x, plan->vertices <= request->vertices, "%llu vertices of at most %llu",
		(unsigned long long)plan->vertices, (unsigned long long)request->vertices);
	extreme_good(x, eco_plan_check(sorted, &x->error));
	extreme_must(x, p->tp >= 0 && p->fp >= 0 && p->fn >= 0 && p->tp <= pixels && p->fp <= pixels
		&& p->fn <= pixels, "predicted %g, %g and %g of %g pixels", p->tp, p->fp, p->fn, pixels);
}

void extreme_plan(struct extreme *x, const struct eco_scene *scene, const struct eco_request *request,
	struct eco_plan *plan)
{
	struct lod_planner_input input = { .scene = scene, .request = request };
	extreme_good(x, lod_plan(plan, &input, &x->error));
	extreme_sound(x, plan, request);
}

bool extreme_same_bytes(const struct eco_writer *a, const struct eco_writer *b)
{
	return a->size == b->size && !memcmp(a->bytes, b->bytes, a->size);
}

void extreme_again(struct extreme *x, const struct eco_scene *scene, const struct eco_request *request,
	struct eco_writer *first, struct extreme_look *look)
{
	struct eco_plan plan = { 0 };
	struct eco_writer bytes = { 0 };
	extreme_plan(x, scene, request, &plan);
	if (look)
		*look = (struct extreme_look){ .plants = plan.visible_plants, .vertices = plan.vertices };
	eco_wire_write_plan(first->size ? &bytes : first, &plan);
	eco_plan_free(&plan);
	extreme_must(x, !bytes.size || extreme_same_bytes(first, &bytes),
		"the same request is answered in two ways");
	eco_writer_free(&bytes);
}

/* ---- Pictures ---- */

static struct view_store *fetch(struct extreme *x, const struct extreme_world *world,
	const struct eco_request *request)
{
	struct view_store *store;
	extreme_good(x, view_store_new(&store, &(struct view_store_options){ .images = true }, &x->error));
	extreme_good(x, bench_fetch(NULL, world->scene, request, store, &x->error));
	return store;
}

void extreme_draw(struct extreme *x, const struct extreme_world *world, const struct eco_request *request,
	struct view_picture *picture)
{
	struct bench_drawing drawing;
	struct view_store *store = fetch(x, world, request);
	extreme_good(x, bench_draw(&drawing, store, &request->view, NULL, picture, &x->error));
	view_select_free(&drawing.selection);
	view_store_free(store);
}

void extreme_cover(struct extreme *x, const struct extreme_world *world, const struct eco_request *request,
	uint8_t *cover)
{
	struct view_selection selection;
	struct view_store *store = fetch(x, world, request);
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	extreme_good(x, view_select_make(&selection, store, &eye, &x->error));
	extreme_good(x, view_reference_count(&(struct view_draw_job){ .store = store,
		.selection = &selection, .eye = &eye, .near_m = bench_near_m(store) },
		&(struct view_coverage){ request->view.width, request->view.height, 1, cover }, &x->error));
	view_select_free(&selection);
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
