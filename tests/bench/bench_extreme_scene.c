#include "tests/bench/bench_extreme_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client-min/view_reference.h"
#include "client-min/view_select.h"
#include "ecofiles/base/turn.h"
#include "ecofiles/format/wire.h"
#include "lod/build/summary.h"
#include "tests/bench/bench_fetch.h"
#include "tests/support/plant_models.h"

#define TILES 4u
#define STEP_M 0x1p-13           /* of instance grids */
#define BODY_M 1.5               /* plants reach so many times their radius from their place */

/* ---- Stands ---- */

enum eco_code extreme_stand_add(struct extreme_stand *stand, const struct eco_model *model, const char *name, struct eco_error *error)
{
	struct lod_plant_options options = { .name = name, .seed = 1, .order = LOD_ORDER_COMBINED, .grid_bits = 14, .cell_triangles = 1500, .views = 4,
		.pixels = 64 };
	struct lod_plant *plant = &stand->plants[stand->plant_count];
	enum eco_code code = lod_plant_build(plant, model, &options, error);
	if (!code)
		code = lod_plant_measure(plant, model, &options, error);
	stand->plant_count += !code;
	return code;
}

bool extreme_stand_place(struct extreme_stand *stand, const struct extreme_place *place)
{
	struct extreme_place *bigger = realloc(stand->places, (stand->place_count + 1) * sizeof *bigger);
	if (!bigger)
		return false;
	stand->places = bigger;
	stand->places[stand->place_count++] = *place;
	return true;
}

/* `count` of a plant anywhere in the square, sizes 0.8 to 1.2. */
static bool scatter(struct extreme_stand *stand, uint32_t plant, uint32_t count, uint64_t seed)
{
	bool good = true;
	for (uint32_t i = 0; i < count && good; i++) {
		double unit[4];
		for (int k = 0; k < 4; k++)
			unit[k] = eco_mix_unit(seed = lod_mix(seed + 1));
		good = extreme_stand_place(stand, &(struct extreme_place){ .plant = plant,
			.at = { (unit[0] - 0.5) * stand->side, (unit[1] - 0.5) * stand->side, 0 },
			.turn = (uint16_t)(unit[2] * 65535), .scale = 0.8 + 0.4 * unit[3] });
	}
	return good;
}

static enum eco_code add_soup(struct extreme_stand *stand, struct soup *soup, const char *name, struct eco_error *error)
{
	enum eco_code code = extreme_stand_add(stand, &soup->model, name, error);
	soup_free(soup);
	return code;
}

/* A tree, a bush and grass, 60 of them in four tiles with a summary above. */
static enum eco_code make_stand(struct extreme_stand *stand, struct eco_error *error)
{
	struct soup soup;
	*stand = (struct extreme_stand){ .side = 40, .near_m = 0.05, .summaries = true };
	soup_tree(&soup, 1500, 60, false);
	enum eco_code code = add_soup(stand, &soup, "tree", error);
	soup_begin(&soup);
	uint32_t leaf = soup_material(&soup, 70, 130, 50, ECO_NONE, false);
	for (int i = 0; i < 400; i++)
		soup_leaf(&soup, leaf, lod_v3_add((struct lod_v3){ 0, 0, 0.6 }, lod_v3_scale(soup_direction(&soup), 0.6 * sqrt(soup_random(&soup, 0, 1)))),
			0.12, 0.07);
	code = code ? code : add_soup(stand, &soup, "bush", error);
	soup_begin(&soup);
	leaf = soup_material(&soup, 90, 150, 60, ECO_NONE, false);
	for (int i = 0; i < 60; i++)
		soup_quad(&soup, leaf, (struct lod_v3){ soup_random(&soup, -0.3, 0.3), soup_random(&soup, -0.3, 0.3), 0.2 },
			(struct lod_v3){ 0.02, 0, 0 }, (struct lod_v3){ soup_random(&soup, -0.1, 0.1), soup_random(&soup, -0.1, 0.1), 0.4 });
	code = code ? code : add_soup(stand, &soup, "grass", error);
	if (!code && !(scatter(stand, 0, 14, 1) && scatter(stand, 1, 20, 2) && scatter(stand, 2, 26, 3)))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for a stand");
	return code;
}

void extreme_stand_free(struct extreme_stand *stand)
{
	for (uint32_t i = 0; i < stand->plant_count; i++)
		lod_plant_free(&stand->plants[i]);
	free(stand->places);
	*stand = (struct extreme_stand){ 0 };
}

static struct extreme_stand shared;

static void free_shared(void) { extreme_stand_free(&shared); }

const struct extreme_stand *extreme_stand_shared(struct extreme *x)
{
	struct eco_error error = { 0 };
	if (shared.plant_count)
		return &shared;
	if (!extreme_good(x, make_stand(&shared, &error), &error)) {
		extreme_stand_free(&shared);
		return NULL;
	}
	atexit(free_shared);
	return &shared;
}

/* ---- Packs ---- */

struct packing {                         /* tables of a scene while it is written */
	const struct extreme_stand *stand;
	const struct extreme_site *site;
	struct eco_pack_writer *writer;
	struct eco_scene scene;
	struct eco_plant plants[EXTREME_PLANTS];
	struct eco_anchor *anchors;
	struct eco_ladder *ladders;
	struct eco_curve *curves;
	uint8_t (*palette)[3];
	uint32_t palette_first[EXTREME_PLANTS];
	struct eco_tile tiles[2 + TILES];            /* the root places the stand's own, which has four */
	struct eco_group groups[TILES * EXTREME_PLANTS];
	struct eco_child children[1 + TILES];
	struct eco_writer places;
	struct eco_error *error;
};

static enum eco_code pack_list(struct packing *p, uint32_t id, uint32_t i, uint32_t *lists)
{
	const struct lod_plant *plant = &p->stand->plants[id];
	const struct lod_list_draft *draft = &plant->lists[i], *like = draft->list.partner == ECO_NONE ? draft : &plant->lists[draft->list.partner];
	struct eco_list list = draft->list;
	list.owner = id;
	list.plant = list.image = ECO_NONE;
	list.palette_first += list.palette_count ? p->palette_first[id] : 0;
	list.partner = list.partner == ECO_NONE ? ECO_NONE : lists[list.partner];
	return eco_pack_add_list(p->writer, &list, &draft->elements, like->ends, like->end_count, like == draft ? NULL : &like->elements, &lists[i],
		p->error);
}

static uint32_t moved(const uint32_t *ids, uint32_t index) { return index == ECO_NONE ? ECO_NONE : ids[index]; }

static enum eco_code pack_plant(struct packing *p, uint32_t id)
{
	const struct lod_plant *plant = &p->stand->plants[id];
	struct eco_scene *s = &p->scene;
	uint32_t *lists = calloc(plant->list_count + 1u, sizeof *lists);
	enum eco_code code = lists ? ECO_OK : ECO_NO_MEMORY;
	p->palette_first[id] = s->palette_count;
	memcpy(p->palette + s->palette_count, plant->palette, plant->palette_count * sizeof *p->palette);
	s->palette_count += plant->palette_count;
	for (int forms = 0; forms < 2; forms++)
		for (uint32_t i = 0; i < plant->list_count && !code; i++)
			if ((plant->lists[i].list.partner != ECO_NONE) == forms)
				code = pack_list(p, id, i, lists);
	p->plants[id] = plant->plant;
	p->plants[id].anchor_first = s->anchor_count;
	p->plants[id].ladder_first = s->ladder_count;
	p->plants[id].ladder_count = plant->ladder_count;
	memcpy(p->anchors + s->anchor_count, plant->anchors, plant->plant.anchor_count * sizeof *p->anchors);
	memcpy(p->curves + s->curve_count, plant->curves, plant->curve_count * sizeof *p->curves);
	for (uint32_t i = 0; i < plant->ladder_count && !code; i++) {
		struct eco_ladder *l = &p->ladders[s->ladder_count + i];
		*l = plant->ladders[i];
		l->plant = id;
		l->anchor += s->anchor_count;
		l->curve_first += s->curve_count;
		l->points = moved(lists, l->points);
		l->lines = moved(lists, l->lines);
		l->simple = moved(lists, l->simple);
		l->triangles = moved(lists, l->triangles);
	}
	s->anchor_count += plant->plant.anchor_count;
	s->ladder_count += plant->ladder_count;
	s->curve_count += plant->curve_count;
	s->needs |= plant->plant.anchor_count > 1 ? ECO_NEED_CELLS : 0;
	s->plant_count++;
	free(lists);
	return code;
}

static uint32_t tile_of(const struct extreme_place *place) { return (place->at[0] >= 0) + 2 * (place->at[1] >= 0); }

static void grow_tile(struct packing *p, struct eco_tile *tile, const struct extreme_place *place)
{
	const struct eco_plant *plant = &p->plants[place->plant];
	const struct eco_anchor *anchor = &p->anchors[plant->anchor_first];
	double reach = BODY_M * (anchor->radius + hypot(anchor->center[0], anchor->center[1])) * place->scale,
		high = (anchor->center[2] + anchor->radius) * BODY_M * place->scale;
	for (int i = 0; i < 3; i++) {
		double at = place->at[i] + (p->site->plain ? p->site->at[i] : 0);
		double low = at - reach, top = at + (i < 2 ? reach : high);
		tile->low[i] = tile->instance_count ? fmin(tile->low[i], low) : low;
		tile->high[i] = tile->instance_count ? fmax(tile->high[i], top) : top;
	}
	tile->instance_count++;
	tile->area += (double)plant->area * place->scale * place->scale;
}

/* The plants of one species in one tile, if there are any. */
static enum eco_code pack_group(struct packing *p, uint32_t tile, uint32_t plant)
{
	uint32_t count = 0, most = p->stand->place_count, group = p->scene.group_count;
	struct eco_list list = { .kind = ECO_LIST_INSTANCES, .coder = ECO_CODER_ROWS, .attributes = ECO_ATTR_PLACE, .owner = 2 + tile, .plant = plant,
		.image = ECO_NONE, .partner = ECO_NONE };
	struct eco_elements e = { .extra_count = 2, .corners = malloc(most), .position = malloc(12 * (size_t)most), .extra = malloc(8 * (size_t)most) };
	double corner = p->stand->side / 2;
	enum eco_code code = e.corners && e.position && e.extra ? ECO_OK : ECO_NO_MEMORY;
	for (int i = 0; i < 3; i++) {
		list.grid_step[i] = STEP_M;
		list.grid_origin[i] = (i < 2 ? -corner : 0) + (p->site->plain ? p->site->at[i] : 0);
	}
	p->groups[group] = (struct eco_group){ 2 + tile, plant, ECO_NONE, p->scene.place_count };
	for (uint32_t i = 0; i < most && !code; i++) {
		const struct extreme_place *place = &p->stand->places[i];
		struct eco_place stored = { .turn = place->turn, .scale = (uint32_t)(place->scale * 65536 + 0.5) };
		if (place->plant != plant || tile_of(place) != tile)
			continue;
		for (int k = 0; k < 3; k++)
			e.position[3 * count + (uint32_t)k] = stored.position[k] = (int32_t)floor((place->at[k] + (k < 2 ? corner : 0)) / STEP_M + 0.5);
		e.corners[count] = 1;
		e.extra[2 * count] = stored.turn;
		e.extra[2 * count + 1] = (int32_t)stored.scale;
		eco_place_write(&p->places, &stored);
		grow_tile(p, &p->tiles[2 + tile], place);
		count++;
	}
	e.element_count = e.corner_count = e.primitive_count = count;
	if (!code && count)
		code = eco_pack_add_list(p->writer, &list, &e, &count, 1, NULL, &p->groups[group].list, p->error);
	if (!code && count) {
		p->tiles[2 + tile].group_count++;
		p->scene.group_count++;
		p->scene.place_count += count;
	}
	eco_elements_free(&e);
	return code;
}

static enum eco_code pack_tiles(struct packing *p)
{
	enum eco_code code = ECO_OK;
	struct eco_tile *stand = &p->tiles[1];
	for (uint32_t t = 0; t < TILES && !code; t++) {
		p->tiles[2 + t] = (struct eco_tile){ .summary = ECO_NONE, .group_first = p->scene.group_count };
		for (uint32_t plant = 0; plant < p->stand->plant_count && !code; plant++)
			code = pack_group(p, t, plant);
	}
	*stand = (struct eco_tile){ .summary = ECO_NONE, .child_first = 1 };
	p->scene.child_count = 1;
	for (uint32_t t = 0; t < TILES; t++) {
		const struct eco_tile *tile = &p->tiles[2 + t];
		if (!tile->instance_count)
			continue;
		for (int i = 0; i < 3; i++) {
			stand->low[i] = stand->child_count ? fmin(stand->low[i], tile->low[i]) : tile->low[i];
			stand->high[i] = stand->child_count ? fmax(stand->high[i], tile->high[i]) : tile->high[i];
		}
		p->children[p->scene.child_count++] = (struct eco_child){ .tile = 2 + t, .scale = 1 };
		stand->child_count++;
		stand->area += tile->area;
		stand->instance_count += tile->instance_count;
	}
	return code;
}

static void pack_root(struct packing *p)
{
	const struct extreme_site *site = p->site;
	const struct eco_tile *stand = &p->tiles[1];
	double scale = site->scale > 0 ? site->scale : 1, far = 0;
	struct eco_child *child = &p->children[0];
	*child = (struct eco_child){ .tile = 1, .placed = true, .scale = 1 };
	if (!site->plain)
		*child = (struct eco_child){ 1, true, { site->at[0], site->at[1], site->at[2] }, site->turn, (float)scale };
	for (int i = 0; i < 3; i++)
		far = fmax(far, fmax(fabs(stand->low[i]), fabs(stand->high[i])));
	p->tiles[0] = (struct eco_tile){ .area = stand->area * scale * scale, .instance_count = stand->instance_count, .summary = ECO_NONE,
		.child_count = 1 };
	for (int i = 0; i < 3; i++) {
		p->tiles[0].low[i] = child->at[i] - 2 * scale * far;
		p->tiles[0].high[i] = child->at[i] + 2 * scale * far;
	}
	p->scene.near_m = fmax(p->stand->near_m * scale, 1e-9);
}

static enum eco_code pack_summary(struct packing *p, const struct lod_pool *pools, uint32_t tile)
{
	struct lod_summary summary = { 0 };
	struct eco_list list;
	struct eco_elements e = { 0 };
	enum eco_code code = lod_summary_make(&summary, &(struct lod_summary_input){ .scene = &p->scene, .pools = pools, .tile = tile,
		.count = lod_summary_count(&p->tiles[tile]), .seed = 1 }, p->error);
	if (!code && summary.count)
		code = lod_summary_list(&summary, &p->scene, tile, p->scene.palette_count, &list, &e, p->error);
	if (!code && summary.count)
		code = eco_pack_add_list(p->writer, &list, &e, &e.element_count, 1, NULL, &p->tiles[tile].summary, p->error);
	free(summary.points);
	eco_elements_free(&e);
	return code;
}

static enum eco_code pack_summaries(struct packing *p)
{
	struct lod_pool pools[EXTREME_PLANTS] = { { 0 } };
	struct eco_list *lists = NULL;
	uint32_t last = 0;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < p->scene.group_count; i++)
		last = p->groups[i].list > last ? p->groups[i].list : last;
	lists = calloc(last + 1u, sizeof *lists);
	for (uint32_t i = 0; i <= last && lists; i++)
		lists[i] = *eco_pack_list(p->writer, i);
	p->scene.lists = lists;
	p->scene.list_count = last + 1;
	for (uint32_t i = 0; i < p->stand->plant_count && !code; i++)
		code = lod_pool_make(&pools[i], &p->stand->plants[i], p->palette_first[i], 512, p->error);
	for (uint32_t t = 1; t < 2 + TILES && !code && lists; t++)
		if (p->tiles[t].instance_count)
			code = pack_summary(p, pools, t);
	for (uint32_t i = 0; i < p->stand->plant_count; i++)
		lod_pool_free(&pools[i]);
	free(lists);
	p->scene.lists = NULL;
	p->scene.list_count = 0;
	return code;
}

static enum eco_code pack_all(struct packing *p, const char *path)
{
	uint32_t anchors = 1, ladders = 1, curves = 1, colors = 1;
	for (uint32_t i = 0; i < p->stand->plant_count; i++) {
		anchors += p->stand->plants[i].plant.anchor_count;
		ladders += p->stand->plants[i].ladder_count;
		curves += p->stand->plants[i].curve_count;
		colors += p->stand->plants[i].palette_count;
	}
	p->anchors = calloc(anchors, sizeof *p->anchors);
	p->ladders = calloc(ladders, sizeof *p->ladders);
	p->curves = calloc(curves, sizeof *p->curves);
	p->palette = calloc(colors, sizeof *p->palette);
	if (!p->anchors || !p->ladders || !p->curves || !p->palette)
		return eco_fail(p->error, ECO_NO_MEMORY, "no memory for a scene");
	enum eco_code code = eco_pack_create(&p->writer, path, p->error);
	for (uint32_t i = 0; i < p->stand->plant_count && !code; i++)
		code = pack_plant(p, i);
	if (!code)
		code = pack_tiles(p);
	pack_root(p);
	struct eco_scene *s = &p->scene;
	strcpy(s->name, "extreme");
	s->needs |= ECO_NEED_POINTS | ECO_NEED_LINES | ECO_NEED_TRIANGLES | ECO_NEED_PLACEMENTS | (p->stand->summaries ? ECO_NEED_SUMMARIES : 0);
	s->plants = p->plants;
	s->anchors = p->anchors;
	s->ladders = p->ladders;
	s->curves = p->curves;
	s->tiles = p->tiles;
	s->tile_count = 2 + TILES;
	s->groups = p->groups;
	s->children = p->children;
	s->palette = (const uint8_t(*)[3])p->palette;
	s->places = p->places.bytes;
	if (!code && p->stand->summaries)
		code = pack_summaries(p);
	if (!code)
		code = eco_pack_commit(p->writer, s, "{\"name\":\"extreme\"}", p->error);
	else
		eco_pack_abort(p->writer);
	return code;
}

enum eco_code extreme_world_open(struct extreme_world *world, const struct extreme_stand *stand, const struct extreme_site *site,
	struct eco_error *error)
{
	char path[64];
	struct packing *p = calloc(1, sizeof *p);
	if (!p)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a scene");
	*p = (struct packing){ .stand = stand, .site = site, .error = error };
	mkdir("build", 0777);
	mkdir("build/tmp", 0777);
	snprintf(path, sizeof path, "build/tmp/extreme-%ld.eco", (long)getpid());
	enum eco_code code = pack_all(p, path);
	srv_store_init(&world->store);
	if (!code)
		code = srv_store_add(&world->store, "extreme", path, error);
	unlink(path);                            /* what is mapped stays */
	world->scene = code ? NULL : &world->store.scenes[0];
	eco_writer_free(&p->places);
	free(p->anchors);
	free(p->ladders);
	free(p->curves);
	free(p->palette);
	free(p);
	return code;
}

bool extreme_world_shared(struct extreme *x, struct extreme_world *world)
{
	const struct extreme_stand *stand = extreme_stand_shared(x);
	struct eco_error error = { 0 };
	*world = (struct extreme_world){ 0 };
	return stand && extreme_good(x, extreme_world_open(world, stand, &(struct extreme_site){ 0 }, &error), &error);
}

void extreme_world_close(struct extreme_world *world) { srv_store_free(&world->store); }

/* ---- Views ---- */

struct eco_view extreme_site_view(const struct extreme_site *site, const struct eco_view *view)
{
	struct eco_view out = *view;
	double sine, cosine, scale = site->scale > 0 && !site->plain ? site->scale : 1;
	eco_turn_sincos(site->plain ? 0 : site->turn, &sine, &cosine);
	for (int point = 0; point < 3; point++) {
		const double *p = point == 0 ? view->eye : point == 1 ? view->target : view->up;
		double *to = point == 0 ? out.eye : point == 1 ? out.target : out.up, s = point == 2 ? 1 : scale;
		double turned[3] = { cosine * p[0] - sine * p[1], sine * p[0] + cosine * p[1], p[2] };
		for (int i = 0; i < 3; i++)
			to[i] = s * turned[i] + (point == 2 ? 0 : site->at[i]);
	}
	return out;
}

struct eco_request extreme_request(uint64_t vertices)
{
	return (struct eco_request){ .view = { .eye = { -26, -21, 6.5 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_y_deg = 45, .width = 400,
		.height = 300 }, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
}

enum eco_code extreme_plan(struct extreme_world *world, const struct eco_request *request, struct eco_plan *plan, struct lod_planner_stats *stats,
	struct eco_error *error)
{
	struct lod_planner_input input = { .scene = &world->scene->pack->scene, .request = request, .stats = stats };
	return lod_plan(plan, &input, error);
}

enum eco_code extreme_draw(struct extreme_world *world, const struct eco_request *request, struct view_picture *picture, struct eco_error *error)
{
	struct view_store_options options = { .images = true };
	struct view_store *store = NULL;
	struct view_selection selection = { 0 };
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	enum eco_code code = view_store_new(&store, &options, error);
	if (!code)
		code = bench_fetch(NULL, world->scene, request, store, error);
	if (!code)
		code = view_select_make(&selection, store, &eye, error);
	if (!code)
		code = view_picture_init(picture, request->view.width, request->view.height, error);
	if (!code)
		code = view_reference_draw(&(struct view_reference_job){ .store = store, .selection = &selection, .eye = &eye,
			.near_m = world->scene->pack->scene.near_m }, picture, error);
	view_select_free(&selection);
	view_store_free(store);
	return code;
}

/* ---- Judging ---- */

struct eco_writer extreme_plan_bytes(const struct eco_plan *plan)
{
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, plan);
	return w;
}

bool extreme_same_bytes(const struct eco_writer *a, const struct eco_writer *b)
{
	return a->size == b->size && !memcmp(a->bytes, b->bytes, a->size);
}

bool extreme_plan_sound(struct extreme *x, const struct eco_plan *plan, const struct eco_request *request)
{
	struct eco_plan *sorted = (struct eco_plan *)plan;
	const struct eco_prediction *p = &plan->prediction;
	struct eco_error error = { 0 };
	double pixels = (double)request->view.width * request->view.height * (1 + 1e-6);
	eco_plan_sort(sorted);
	return extreme_must(x, plan->vertices <= request->vertices, "%llu vertices of at most %llu", (unsigned long long)plan->vertices,
			(unsigned long long)request->vertices)
		&& extreme_good(x, eco_plan_check(sorted, &error), &error)
		&& extreme_must(x, p->tp >= 0 && p->fp >= 0 && p->fn >= 0 && p->tp <= pixels && p->fp <= pixels && p->fn <= pixels,
			"predicted %g, %g and %g of %g pixels", p->tp, p->fp, p->fn, pixels);
}

double extreme_pixels_differ(const struct view_picture *a, const struct view_picture *b, bool colours)
{
	size_t count = (size_t)a->width * a->height, differ = 0;
	for (size_t i = 0; i < count; i++)
		differ += a->cover[i] != b->cover[i] || a->owner[i] != b->owner[i] || (colours && memcmp(a->rgb + 3 * i, b->rgb + 3 * i, 3));
	return (double)differ / (double)count;
}

bool extreme_plan_of(struct extreme *x, const struct eco_scene *scene, const struct eco_request *request, struct eco_plan *plan)
{
	struct lod_planner_input input = { .scene = scene, .request = request };
	struct eco_error error = { 0 };
	if (!extreme_good(x, lod_plan(plan, &input, &error), &error))
		return false;
	if (extreme_plan_sound(x, plan, request))
		return true;
	eco_plan_free(plan);
	return false;
}
