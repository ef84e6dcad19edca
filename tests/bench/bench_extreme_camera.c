/* Camera: places and lenses that no one would choose and some script will. Everything that a view check lets through must be planned and drawn. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_select.h"
#include "lod/geometry.h"
#include "lod/raster/raster.h"
#include "lod/vector.h"
#include "lod/eye.h"
#include "tests/bench/bench_extreme_scene.h"
#include "tests/bench/bench_fetch.h"

#define SIDE 40.0                /* of the stand */

static const uint64_t budgets[] = { 0, 50, 5000, ECO_VERTICES_MAX };
enum { BUDGETS = sizeof budgets / sizeof *budgets };

/* ---- Looking ---- */

struct look { uint64_t plants, vertices, covered; };     /* in full */

/* The same request twice gives the same bytes, at every budget. */
static bool plans_agree(struct extreme *x, const struct eco_scene *scene, const struct eco_request *request, struct look *look)
{
	struct eco_plan plan[2] = { { 0 } };
	if (!extreme_plan_of(x, scene, request, &plan[0]))
		return false;
	bool good = extreme_plan_of(x, scene, request, &plan[1]);
	if (good) {
		struct eco_writer a = extreme_plan_bytes(&plan[0]), b = extreme_plan_bytes(&plan[1]);
		good = extreme_must(x, extreme_same_bytes(&a, &b), "the same request is answered in two ways");
		eco_writer_free(&a);
		eco_writer_free(&b);
		eco_plan_free(&plan[1]);
	}
	look->plants = plan[0].visible_plants;
	look->vertices = plan[0].vertices;
	eco_plan_free(&plan[0]);
	return good;
}

static bool look_through(struct extreme *x, struct extreme_world *world, const struct eco_view *view, bool drawn, struct look *look)
{
	struct eco_request request = { .view = *view, .bytes = ECO_BYTES_UNBOUNDED };
	struct eco_error error = { 0 };
	struct view_picture picture = { 0 };
	*look = (struct look){ 0 };
	if (!extreme_good(x, eco_view_check(view, &error), &error))
		return false;
	for (int i = 0; i < BUDGETS; i++) {
		request.vertices = budgets[i];
		if (!plans_agree(x, &world->scene->pack->scene, &request, look))
			return false;
		if (drawn && (i == 1 || i == BUDGETS - 1)) {
			view_picture_free(&picture);
			if (!extreme_good(x, extreme_draw(world, &request, &picture, &error), &error))
				return false;
		}
	}
	for (size_t i = 0; drawn && i < (size_t)picture.width * picture.height; i++)
		look->covered += picture.cover[i] != 0;
	view_picture_free(&picture);
	return true;
}

struct shot { const char *name; struct eco_view view; bool planned_only; double least; };    /* least: share of pixels to be covered */

static void look_at_all(struct extreme *x, const struct shot *shots, size_t count)
{
	struct extreme_world world;
	bool good = extreme_world_shared(x, &world);
	for (size_t i = 0; i < count && good; i++) {
		struct look look;
		const struct eco_view *v = &shots[i].view;
		good = look_through(x, &world, v, !shots[i].planned_only, &look);
		if (!good)
			break;
		double share = (double)look.covered / ((double)v->width * v->height);
		extreme_must(x, shots[i].planned_only || share >= shots[i].least, "%s: %.1f %% of the picture are covered, at least %.1f %% should be",
			shots[i].name, 100 * share, 100 * shots[i].least);
		if (shots[i].planned_only)
			extreme_say(x, "%s: %llu plants, %llu vertices", shots[i].name, (unsigned long long)look.plants, (unsigned long long)look.vertices);
		else
			extreme_say(x, "%s: %llu plants, %llu vertices, %.1f %% covered", shots[i].name, (unsigned long long)look.plants,
				(unsigned long long)look.vertices, 100 * share);
	}
	extreme_world_close(&world);
}

static struct eco_view view_of(double x, double y, double z, double tx, double ty, double tz)
{
	return (struct eco_view){ { x, y, z }, { tx, ty, tz }, { 0, 0, 1 }, 45, 320, 240 };
}

/* ---- Where ---- */

static const struct extreme_place *first_tree(struct extreme *x)
{
	const struct extreme_stand *stand = extreme_stand_shared(x);
	return stand ? &stand->places[0] : NULL;
}

/* As the pack has it: on the grid of its list. */
static struct lod_place placed(struct extreme_world *world, uint32_t group, uint32_t index)
{
	const struct eco_scene *s = &world->scene->pack->scene;
	struct eco_place stored = eco_place_read(s, s->groups[group].place_first + index);
	struct eco_placement origin = { .scale = 1 };
	struct lod_place place;
	lod_place_instance(&place, &origin, &s->lists[s->groups[group].list], &stored);
	return place;
}

/* The eye exactly where a leaf's middle is, looking along it and across it. */
static void inside_leaf(struct extreme *x)
{
	const struct extreme_stand *stand = extreme_stand_shared(x);
	struct extreme_world world;
	struct shot shots[2] = { { .name = "along it" }, { .name = "across it" } };
	const struct lod_list_draft *leaves = NULL;
	if (!stand || !extreme_world_shared(x, &world))
		return;
	for (uint32_t i = 0; i < stand->plants[0].ladder_count && !leaves; i++)
		if (stand->plants[0].ladders[i].organ == ECO_ORGAN_FOLIAGE && stand->plants[0].ladders[i].triangles != ECO_NONE)
			leaves = &stand->plants[0].lists[stand->plants[0].ladders[i].triangles];
	struct lod_place place = placed(&world, 0, 0);
	extreme_world_close(&world);
	if (!extreme_must(x, leaves != NULL, "the tree has no leaves"))
		return;
	double corner[2][3], middle[3] = { 0 };
	for (uint32_t k = 0; k < leaves->elements.corners[0]; k++) {
		float p[3];
		double at[3];
		for (int i = 0; i < 3; i++)
			p[i] = (float)(leaves->list.grid_origin[i] + leaves->list.grid_step[i] * leaves->elements.position[3 * k + (uint32_t)i]);
		lod_place_point(&place, p, at);
		for (int i = 0; i < 3; i++)
			middle[i] += at[i] / leaves->elements.corners[0];
		if (k < 2)
			memcpy(corner[k], at, sizeof at);
	}
	struct lod_v3 m = { middle[0], middle[1], middle[2] }, a = { corner[0][0], corner[0][1], corner[0][2] },
		b = { corner[1][0], corner[1][1], corner[1][2] };
	struct lod_v3 n = lod_v3_unit(lod_v3_cross(lod_v3_sub(a, m), lod_v3_sub(b, m)));
	shots[0].view = view_of(m.x, m.y, m.z, a.x, a.y, a.z);
	shots[1].view = view_of(m.x, m.y, m.z, m.x + n.x, m.y + n.y, m.z + n.z);
	look_at_all(x, shots, 2);
}

static void inside_trunk(struct extreme *x)
{
	const struct extreme_place *t = first_tree(x);
	if (!t)
		return;
	const double *p = t->at;
	const struct shot shots[] = {
		{ "level", view_of(p[0] + 0.02, p[1], 1, 0, 0, 1), false, 0.5 },
		{ "up", view_of(p[0] + 0.02, p[1], 1, p[0] + 0.02, p[1], 5), false, 0.5 },
		{ "down", view_of(p[0] + 0.02, p[1], 1, p[0] + 0.02, p[1], -5), false, 0.2 },
	};
	look_at_all(x, shots, 3);
}

static void tile_corner(struct extreme *x)
{
	const struct shot shots[] = {
		{ "where four tiles meet", view_of(0, 0, 1, 10, 10, 1), false, 0.01 },
		{ "on the ground there", view_of(0, 0, 0, -1, 0, 0), false, 0.01 },
		{ "corner of the square", view_of(-SIDE / 2, -SIDE / 2, 0, 0, 0, 0), false, 0.01 },
		{ "along an edge", view_of(-SIDE / 2, 0, 2, SIDE / 2, 0, 2), false, 0.01 },
	};
	look_at_all(x, shots, 4);
}

/* At a plant's place, and at the middle of its anchor: nothing between the eye and what it looks at. */
static void distance_0(struct extreme *x)
{
	struct extreme_world world;
	struct shot shots[3] = { { .name = "at its foot" }, { .name = "at its middle" }, { .name = "at a cell's middle" } };
	size_t count = 0;
	if (!extreme_world_shared(x, &world))
		return;
	const struct eco_scene *s = &world.scene->pack->scene;
	struct lod_place place = placed(&world, 0, 0);
	const struct eco_plant *plant = &s->plants[s->groups[0].plant];
	for (uint32_t i = 0; i < 2 && i < plant->anchor_count; i++) {
		double at[3];
		lod_place_point(&place, s->anchors[plant->anchor_first + i].center, at);
		shots[1 + i].view = view_of(at[0], at[1], at[2], at[0] + 1, at[1], at[2]);
		count = 2 + i;
	}
	shots[0].view = view_of(place.at[0], place.at[1], place.at[2], place.at[0], place.at[1] + 1, place.at[2]);
	extreme_world_close(&world);
	look_at_all(x, shots, count);
}

static void far_away(struct extreme *x)
{
	const struct shot shots[] = {
		{ "1e9 m", view_of(-1e9, 0, 1e8, 0, 0, 2), false, 0 },
		{ "1e12 m", view_of(-1e12, 1e12, 1e12, 0, 0, 2), false, 0 },
		{ "1e9 m through 2e-6 degrees", { { 0, -1e9, 1e8 }, { 0, 0, 2 }, { 0, 0, 1 }, 2e-6, 320, 240 }, false, 0.05 },
	};
	look_at_all(x, shots, 3);
}

/* ---- How ---- */

static void up_along(struct extreme *x)
{
	struct shot shots[] = {
		{ "up is the direction", view_of(-26, -21, 6.5, 0, 0, 2), false, 0.02 },
		{ "up is its opposite", view_of(-26, -21, 6.5, 0, 0, 2), false, 0.02 },
		{ "no up", view_of(-26, -21, 6.5, 0, 0, 2), false, 0.02 },
		{ "straight down", view_of(0, 0, 40, 0, 0, 0), false, 0.02 },
		{ "straight up", view_of(0, 0, -40, 0, 0, 0), false, 0.02 },
		{ "nearly along", view_of(-26, -21, 6.5, 0, 0, 2), false, 0.02 },
		{ "up of 1e-300", view_of(-26, -21, 6.5, 0, 0, 2), false, 0.02 },
	};
	for (int i = 0; i < 3; i++) {
		double d = shots[0].view.target[i] - shots[0].view.eye[i];
		shots[0].view.up[i] = d;
		shots[1].view.up[i] = -d;
		shots[2].view.up[i] = 0;
		shots[5].view.up[i] = d * (1 + (i == 0) * 1e-13);
		shots[6].view.up[i] = i == 2 ? 1e-300 : 0;
	}
	look_at_all(x, shots, sizeof shots / sizeof *shots);
}

static void narrow(struct extreme *x)
{
	struct shot shots[] = {
		{ "0.001 degrees", view_of(-26, -21, 6.5, 0, 0, 2), false, 0 },
		{ "1e-9 degrees", view_of(-26, -21, 6.5, 0, 0, 2), false, 0 },
		{ "0.001 degrees from 1000 km", view_of(-1e6, 0, 1e5, 0, 0, 2), false, 0.05 },
	};
	shots[0].view.fov_y_deg = shots[2].view.fov_y_deg = 0.001;
	shots[1].view.fov_y_deg = 1e-9;
	look_at_all(x, shots, 3);
}

static void wide(struct extreme *x)
{
	struct shot shots[] = { { "179.9 degrees", view_of(0, 0, 2, 10, 0, 2), false, 0 }, { "179.999999 degrees", view_of(0, 0, 2, 10, 0, 2),
		false, 0 } };
	shots[0].view.fov_y_deg = 179.9;
	shots[1].view.fov_y_deg = 179.999999;
	look_at_all(x, shots, 2);
}

/* One cut for all plants that draw it; what is covered is all that is asked. */
static bool draw_cut(struct lod_raster *raster, const struct view_store *store, const struct view_selection *s, uint32_t c)
{
	const struct eco_cut *cut = &view_store_plan(store)->cuts[c];
	const struct view_list *list = view_store_list(store, cut->list);
	size_t count = cut->end - cut->first;
	struct lod_geometry g = { .position = malloc(36 * count + 1), .width = malloc(4 * count + 1), .color = malloc(4 * count + 1),
		.size = malloc(4 * count + 1) };
	bool good = g.position && g.width && g.color && g.size;
	struct lod_raster_batch batch = { .count = (uint32_t)count, .position = g.position, .width = g.width, .area = list->list.unit_area * cut->scale,
		.size = list->list.attributes & ECO_ATTR_SIZE ? g.size : NULL, .owner = 1 };
	if (good)
		lod_list_geometry(&list->list, &list->elements, cut->first, cut->end, cut->scale, &g);
	for (uint32_t m = s->member_first[c]; m < s->member_first[c + 1] && good; m++) {
		lod_raster_object(raster, &s->instances[s->members[m]].place);
		(list->list.kind == ECO_LIST_TRIANGLES ? lod_raster_triangles : list->list.kind == ECO_LIST_LINES ? lod_raster_lines
			: lod_raster_points)(raster, &batch);
	}
	free(g.position);
	free(g.width);
	free(g.color);
	free(g.size);
	return good;
}

/* What covers, and nothing else: five bytes a pixel, so that the largest picture takes 1.3 GB and not 7. */
static bool silhouette(struct extreme *x, struct extreme_world *world, const struct eco_view *view, struct lod_raster *raster)
{
	struct eco_request request = { .view = *view, .vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED };
	struct view_store_options options = { .images = true };
	struct view_store *store = NULL;
	struct view_selection s = { 0 };
	struct eco_error error = { 0 };
	struct lod_eye eye;
	lod_eye_make(&eye, view);
	bool good = extreme_good(x, view_store_new(&store, &options, &error), &error)
		&& extreme_good(x, bench_fetch(NULL, world->scene, &request, store, &error), &error)
		&& extreme_good(x, view_select_make(&s, store, &eye, &error), &error)
		&& extreme_good(x, lod_raster_init(raster, &(struct lod_raster_options){ view->width, view->height, .silhouette = true }, &error), &error);
	if (good) {
		lod_raster_clear(raster);
		lod_raster_camera(raster, &eye, world->scene->pack->scene.near_m);
	}
	for (uint32_t c = 0; c < s.cut_count && good; c++)
		good = s.member_first[c] == s.member_first[c + 1] || extreme_must(x, draw_cut(raster, store, &s, c), "no memory");
	view_select_free(&s);
	view_store_free(store);
	return good;
}

/* Blocks of 16 x 16 pixels of the largest picture against pixels of the small one: what is all covered, or not at all, is so there. */
static void compare_blocks(struct extreme *x, const struct lod_raster *large, const struct lod_raster *small)
{
	uint32_t times = large->width / small->width, odd = 0;
	uint64_t covered[2] = { 0 }, pixels = (uint64_t)small->width * small->height;
	for (uint32_t i = 0; i < pixels; i++) {
		const uint8_t *block = large->cover + ((size_t)(i / small->width) * large->width + i % small->width) * times;
		uint32_t count = 0;
		for (uint32_t k = 0; k < times * times; k++)
			count += block[(size_t)(k / times) * large->width + k % times] != 0;
		covered[0] += count;
		covered[1] += small->cover[i] != 0;
		odd += (count == 0 && small->cover[i]) || (count == times * times && !small->cover[i]);
	}
	double share = (double)covered[0] / ((double)pixels * times * times), coarse = (double)covered[1] / (double)pixels;
	extreme_must(x, odd <= pixels / 10000, "%u blocks of the largest picture are unlike the pixels of a small one", odd);
	extreme_must(x, share > 0.02 && fabs(share - coarse) < 0.005 * share, "%.3f %% covered in the largest picture, %.3f %% in a small one",
		100 * share, 100 * coarse);
	extreme_say(x, "16384 x 16384 drawn: %.3f %% covered, %.3f %% at 1024 x 1024, %u of %llu blocks unlike", 100 * share, 100 * coarse, odd,
		(unsigned long long)pixels);
}

static void draw_largest(struct extreme *x, struct eco_view view)
{
	struct extreme_world world;
	struct lod_raster large = { 0 }, small = { 0 };
	bool good = extreme_world_shared(x, &world) && silhouette(x, &world, &view, &large);
	view.width = view.height = 1024;
	if (good && silhouette(x, &world, &view, &small))
		compare_blocks(x, &large, &small);
	lod_raster_free(&large);
	lod_raster_free(&small);
	extreme_world_close(&world);
}

static void images(struct extreme *x)
{
	static const uint32_t sizes[][2] = { { 1, 1 }, { 16384, 1 }, { 1, 16384 }, { 16384, 16384 } };
	struct shot shots[4] = { { .name = "1 x 1" }, { .name = "16384 x 1" }, { .name = "1 x 16384" },
		{ .name = "16384 x 16384, planned", .planned_only = true } };
	for (int i = 0; i < 4; i++) {
		shots[i].view = view_of(-26, -21, 6.5, 0, 0, 2);
		shots[i].view.width = sizes[i][0];
		shots[i].view.height = sizes[i][1];
	}
	look_at_all(x, shots, 4);
	if (!x->failed && !x->quick)
		draw_largest(x, shots[3].view);
}

static void all_behind(struct extreme *x)
{
	static const double ways[][3] = { { -100, 0, 2 }, { -50, 0, 100 }, { -50.5, 0, 2 } };
	struct extreme_world world;
	bool good = extreme_world_shared(x, &world);
	for (int i = 0; i < 3 && good; i++) {
		struct eco_view view = view_of(-50, 0, 2, ways[i][0], ways[i][1], ways[i][2]);
		struct look look;
		good = look_through(x, &world, &view, true, &look)
			&& extreme_must(x, look.plants == 0 && look.vertices == 0 && look.covered == 0, "%llu plants, %llu vertices and %llu pixels of what "
			"is behind", (unsigned long long)look.plants, (unsigned long long)look.vertices, (unsigned long long)look.covered);
	}
	if (!x->failed)
		extreme_say(x, "no plant, no vertex, no pixel in 3 views at 4 budgets");
	extreme_world_close(&world);
}

/* ---- A horizon of a million tiles ---- */

#define LEVELS 10u               /* 4^10 stands of four tiles */

struct wide_scene {
	struct eco_scene scene;
	struct eco_tile tiles[LEVELS + 8];
	struct eco_child children[4 * LEVELS + 8];
	struct eco_group groups[32];
};

/* The stand planted 4^LEVELS times: each level is four of the one below. A tile stands for what is below it by the stand's own summary. */
static void widen(struct wide_scene *w, const struct eco_scene *from)
{
	w->scene = *from;
	for (uint32_t i = 1; i < from->tile_count; i++) {
		w->tiles[LEVELS + i - 1] = from->tiles[i];
		w->tiles[LEVELS + i - 1].child_first += 4 * LEVELS;
	}
	for (uint32_t i = 0; i < from->child_count; i++) {
		w->children[4 * LEVELS + i] = from->children[i];
		w->children[4 * LEVELS + i].tile += LEVELS - 1;
	}
	for (uint32_t i = 0; i < from->group_count; i++) {
		w->groups[i] = from->groups[i];
		w->groups[i].tile += LEVELS - 1;
	}
	for (uint32_t level = LEVELS; level-- > 0;) {
		const struct eco_tile *below = &w->tiles[level + 1];
		double quarter = SIDE / 2 * ldexp(1, (int)(LEVELS - 1 - level));
		struct eco_tile *t = &w->tiles[level];
		*t = (struct eco_tile){ .area = 4 * below->area, .instance_count = 4 * below->instance_count, .summary = from->tiles[1].summary,
			.child_first = 4 * level, .child_count = 4 };
		for (int i = 0; i < 3; i++) {
			t->low[i] = below->low[i] - (i < 2 ? quarter : 0);
			t->high[i] = below->high[i] + (i < 2 ? quarter : 0);
		}
		for (uint32_t c = 0; c < 4; c++)
			w->children[4 * level + c] = (struct eco_child){ level + 1, true, { c & 1 ? quarter : -quarter, c & 2 ? quarter : -quarter, 0 }, 0, 1 };
	}
	w->scene.root = 0;
	w->scene.tiles = w->tiles;
	w->scene.tile_count = LEVELS + from->tile_count - 1;
	w->scene.children = w->children;
	w->scene.child_count = 4 * LEVELS + from->child_count;
	w->scene.groups = w->groups;
}

static void horizon(struct extreme *x)
{
	struct extreme_world world;
	struct wide_scene *w = calloc(1, sizeof *w);
	if (extreme_must(x, w != NULL, "no memory") && extreme_world_shared(x, &world)) {
		static const uint64_t most[] = { 1000, 100000, 1000000 };
		double reach = SIDE / 2 * ldexp(1, LEVELS), eyes[][3] = { { -reach, -reach, 1.7 }, { 0, 0, 1.7 }, { 0, 0, 0 } };
		double targets[][3] = { { 0, 0, 1.7 }, { reach, 0, 1.7 }, { reach, reach, 0 } };
		widen(w, &world.scene->pack->scene);
		for (int v = 0; v < 3 && !x->failed; v++)
			for (int b = 0; b < (x->quick ? 2 : 3) && !x->failed; b++) {
				struct eco_request request = { .view = view_of(eyes[v][0], eyes[v][1], eyes[v][2], targets[v][0], targets[v][1], targets[v][2]),
					.vertices = most[b], .bytes = ECO_BYTES_UNBOUNDED };
				struct look look = { 0 };
				if (plans_agree(x, &w->scene, &request, &look) && b)
					extreme_say(x, "%llu plants in view, %llu vertices", (unsigned long long)look.plants, (unsigned long long)look.vertices);
				extreme_must(x, look.vertices >= most[b] / 2, "%llu vertices where %llu were allowed", (unsigned long long)look.vertices,
					(unsigned long long)most[b]);
			}
		extreme_world_close(&world);
	}
	free(w);
}

#define SOUND "planned at 0, 50, 5000 and all vertices: within the budget, finite, the same twice; drawn"

static const struct extreme_case cases[] = {
	{ "inside a leaf", SOUND, false, inside_leaf },
	{ "inside the trunk", SOUND ": wood around the eye", false, inside_trunk },
	{ "on a tile's corner", SOUND, false, tile_corner },
	{ "at distance 0", SOUND, false, distance_0 },
	{ "at 1e9 m", SOUND, false, far_away },
	{ "up along the direction", SOUND ": another up is taken", false, up_along },
	{ "field of view 0.001 degrees", SOUND, false, narrow },
	{ "field of view 179.9 degrees", SOUND, false, wide },
	{ "pictures of 1 x 1 to 16384 x 16384", SOUND "; the largest: what it covers, against a small one", false, images },
	{ "everything behind", "nothing is drawn, nothing predicted", false, all_behind },
	{ "horizon along 4e6 tiles", "1e6 copies of a stand of four tiles: plans within the budget that use half of it at least", false, horizon },
};

const struct extreme_family extreme_camera = { "camera", cases, sizeof cases / sizeof *cases };
