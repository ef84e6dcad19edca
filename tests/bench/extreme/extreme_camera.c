/* Camera: unusual places and lenses. Every view that passes the check must be planned and drawn. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_select.h"
#include "lod/eye.h"
#include "lod/geometry.h"
#include "lod/raster/raster.h"
#include "lod/vector.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/extreme/extreme_scene.h"
#include "tests/support/scene_builder.h"

static const uint64_t budgets[] = { 0, 50, 5000, ECO_VERTICES_MAX };
enum { BUDGETS = sizeof budgets / sizeof *budgets };

/* Eye and target of a shot are metres from somewhere: the scene's origin, its first tree's foot, the middle
 * of that tree or of its first cell; or the middle of one of its leaves, a corner of that leaf, and a metre
 * along its normal. `least`: share of pixels to be covered. Arrays end with a shot without a name. */
enum from { FROM_SCENE, FROM_TREE, FROM_MIDDLE, FROM_CELL, FROM_LEAF, FROM_CORNER, FROM_NORMAL };
struct shot { const char *name; struct eco_view view; enum from eye, target; double least; bool planned_only;
	};

/* ---- Looking ---- */

/* The same request twice, and what it sees. */
static bool plan_twice(struct extreme *x, const struct eco_scene *scene, const struct eco_request *request,
	struct extreme_look *look)
{
	struct eco_writer first = { 0 };
	bool good = extreme_again(x, scene, request, &first, look)
		&& extreme_again(x, scene, request, &first, NULL);
	eco_writer_free(&first);
	return good;
}

/* At every budget; drawn at a small one and in full. */
static bool look_through(struct extreme *x, const struct extreme_world *world, const struct eco_view *view,
	bool drawn, struct extreme_look *look)
{
	struct eco_request request = { .view = *view, .bytes = ECO_BYTES_UNBOUNDED };
	struct eco_error error = { 0 };
	bool good = extreme_good(x, eco_view_check(view, &error), &error);
	for (int i = 0; i < BUDGETS && good; i++) {
		struct view_picture picture = { 0 };
		request.vertices = budgets[i];
		good = plan_twice(x, extreme_tables(world), &request, look);
		if (good && drawn && (i == 1 || i == BUDGETS - 1)) {
			good = extreme_draw(x, world, &request, &picture);
			look->covered = good ? extreme_covered(&picture) : 0;
		}
		view_picture_free(&picture);
	}
	return good;
}

/* A leaf of the first tree: its middle, a corner, and a metre along its normal. */
static bool find_leaf(struct extreme *x, const struct lod_place *place, struct lod_v3 leaf[3])
{
	const struct lod_plant *tree = &extreme_stand(x)->plants[0];
	const struct lod_list_draft *leaves = NULL;
	struct lod_v3 corner[2] = { { 0, 0, 0 } };
	for (uint32_t i = 0; i < tree->ladder_count && !leaves; i++)
		if (tree->ladders[i].organ == ECO_ORGAN_FOLIAGE && tree->ladders[i].triangles != ECO_NONE)
			leaves = &tree->lists[tree->ladders[i].triangles];
	if (!extreme_must(x, leaves != NULL, "the tree has no leaves"))
		return false;
	leaf[0] = (struct lod_v3){ 0, 0, 0 };
	for (uint32_t k = 0, n = leaves->elements.corners[0]; k < n; k++) {
		float p[3];
		double at[3];
		for (int i = 0; i < 3; i++)
			p[i] = (float)(leaves->list.grid_origin[i]
				+ leaves->list.grid_step[i] * leaves->elements.position[3 * k + (uint32_t)i]);
		lod_place_point(place, p, at);
		leaf[0] = lod_v3_add(leaf[0], (struct lod_v3){ at[0] / n, at[1] / n, at[2] / n });
		if (k < 2)
			corner[k] = (struct lod_v3){ at[0], at[1], at[2] };
	}
	leaf[1] = corner[0];
	leaf[2] =
		lod_v3_add(leaf[0],
		lod_v3_unit(lod_v3_cross(lod_v3_sub(corner[0], leaf[0]), lod_v3_sub(corner[1], leaf[0]))));
	return true;
}

static bool place_of(struct extreme *x, const struct extreme_world *world, enum from from,
	double at[3])
{
	const struct eco_scene *s = extreme_tables(world);
	struct lod_place place = extreme_placed(world, 0, 0);
	const struct eco_plant *plant = &s->plants[s->groups[0].plant];
	struct lod_v3 leaf[3];
	memset(at, 0, 3 * sizeof *at);
	if (from == FROM_TREE)
		memcpy(at, place.at, 3 * sizeof *at);
	else if (from == FROM_MIDDLE || from == FROM_CELL)
		lod_place_point(&place, s->anchors[plant->anchor_first + (from == FROM_CELL)].center, at);
	else if (from >= FROM_LEAF) {
		if (!find_leaf(x, &place, leaf))
			return false;
		memcpy(at,
			(double[3]){ leaf[from - FROM_LEAF].x, leaf[from - FROM_LEAF].y,
			leaf[from - FROM_LEAF].z }, 3 * sizeof *at);
	}
	return extreme_must(x, from != FROM_CELL || plant->anchor_count > 1, "the tree has no cells");
}

static bool take_shot(struct extreme *x, const struct extreme_world *world, const struct shot *shot)
{
	struct eco_view view = shot->view;
	struct extreme_look look = { 0 };
	double eye[3], target[3];
	if (!place_of(x, world, shot->eye, eye) || !place_of(x, world, shot->target, target))
		return false;
	for (int i = 0; i < 3; i++) {
		view.eye[i] += eye[i];
		view.target[i] += target[i];
	}
	if (!look_through(x, world, &view, !shot->planned_only, &look))
		return false;
	double share = (double)look.covered / ((double)view.width * view.height);
	extreme_least(x, shot->name, shot->planned_only ? 1 : share, shot->least);
	char covered[32] = "";
	if (!shot->planned_only)
		snprintf(covered, sizeof covered, ", %.1f %% covered", 100 * share);
	extreme_say(x, "%s: %llu plants, %llu vertices%s", shot->name, (unsigned long long)look.plants,
		(unsigned long long)look.vertices, covered);
	return true;
}

static void look_at(struct extreme *x)
{
	const struct extreme_world *world = extreme_world(x);
	for (const struct shot *shot = x->made; world && shot->name && take_shot(x, world, shot);
			shot++)
		;
}

/* ---- The largest picture ---- */

/* Covers the pixels of one cut, for all plants that draw it. */
static bool draw_cut(struct lod_raster *raster, const struct view_store *store,
	const struct view_selection *s, uint32_t c)
{
	const struct eco_cut *cut = &view_store_plan(store)->cuts[c];
	const struct view_list *list = view_store_list(store, cut->list);
	size_t count = cut->end - cut->first;
	struct lod_geometry g = { .position = malloc(36 * count + 1), .width = malloc(4 * count + 1),
		.color = malloc(4 * count + 1),
		.size = malloc(4 * count + 1) };
	bool good = g.position && g.width && g.color && g.size;
	struct lod_raster_batch batch = { .count = (uint32_t)count, .position = g.position, .width = g.width,
		.area = list->list.unit_area * cut->scale,
		.size = list->list.attributes & ECO_ATTR_SIZE ? g.size : NULL, .owner = 1 };
	if (good)
		lod_list_geometry(&list->list, &list->elements, cut->first, cut->end, cut->scale, &g);
	for (uint32_t m = s->member_first[c]; m < s->member_first[c + 1] && good; m++) {
		lod_raster_object(raster, &s->instances[s->members[m]].place);
		(list->list.kind == ECO_LIST_TRIANGLES ? lod_raster_triangles : list->list.kind
			== ECO_LIST_LINES ? lod_raster_lines
			: lod_raster_splats)(raster, &batch);
	}
	free(g.position);
	free(g.width);
	free(g.color);
	free(g.size);
	return good;
}

/* Draws the cover and nothing else: five bytes a pixel, so that the largest picture takes 1.3 GB and not 7.
 */
static bool silhouette(struct extreme *x, const struct extreme_world *world, const struct eco_view *view,
	struct lod_raster *raster)
{
	struct eco_request request = { .view = *view, .vertices = ECO_VERTICES_MAX,
		.bytes = ECO_BYTES_UNBOUNDED };
	struct view_store_options options = { .images = true };
	struct view_store *store = NULL;
	struct view_selection s = { 0 };
	struct eco_error error = { 0 };
	struct lod_eye eye;
	lod_eye_make(&eye, view);
	bool good = extreme_good(x, view_store_new(&store, &options, &error), &error)
		&& extreme_good(x, bench_fetch(NULL, world->scene, &request, store, &error), &error)
		&& extreme_good(x, view_select_make(&s, store, &eye, &error), &error)
		&& extreme_good(x, lod_raster_init(raster,
		&(struct lod_raster_options){ view->width, view->height, .silhouette = true }, &error),
		&error);
	if (good) {
		lod_raster_clear(raster);
		lod_raster_camera(raster, &eye, extreme_tables(world)->near_m);
	}
	for (uint32_t c = 0; c < s.cut_count && good; c++)
		good = s.member_first[c] == s.member_first[c + 1]
			|| extreme_must(x, draw_cut(raster, store, &s, c), "no memory");
	view_select_free(&s);
	view_store_free(store);
	return good;
}

/* Blocks of 16 x 16 pixels of the largest picture against pixels of the small one: what is all covered, or
 * not at all, is so there. */
static void compare_blocks(struct extreme *x, const struct lod_raster *large, const struct lod_raster *small)
{
	uint32_t times = large->width / small->width, odd = 0;
	uint64_t covered[2] = { 0 }, pixels = (uint64_t)small->width * small->height;
	for (uint32_t i = 0; i < pixels; i++) {
		const uint8_t *block = large->cover
			+ ((size_t)(i / small->width) * large->width + i % small->width) * times;
		uint32_t count = 0;
		for (uint32_t k = 0; k < times * times; k++)
			count += block[(size_t)(k / times) * large->width + k % times] != 0;
		covered[0] += count;
		covered[1] += small->cover[i] != 0;
		odd += (count == 0 && small->cover[i]) || (count == times * times && !small->cover[i]);
	}
	double share = (double)covered[0] / ((double)pixels * times * times),
		coarse = (double)covered[1] / (double)pixels;
	extreme_most(x, "blocks of the largest picture unlike the pixels of a small one", odd,
		(double)(pixels / 10000));
	extreme_least(x, "share covered in the largest picture", share, 0.02);
	extreme_most(x, "share covered in it, off the small one's", fabs(share - coarse), 0.005 * share);
	extreme_say(x, "16384 x 16384 drawn: %.3f %% covered, %.3f %% at 1024 x 1024, %u of %llu blocks "
		"unlike", 100 * share, 100 * coarse, odd, (unsigned long long)pixels);
}

static void images(struct extreme *x)
{
	const struct extreme_world *world = extreme_world(x);
	struct lod_raster large = { 0 }, small = { 0 };
	struct eco_view view = extreme_view((double[3]){ -26, -21, 6.5 }, (double[3]){ 0, 0, 2 });
	look_at(x);
	if (x->failed || x->quick)
		return;
	view.width = view.height = 16384;
	bool good = silhouette(x, world, &view, &large);
	view.width = view.height = 1024;
	if (good && silhouette(x, world, &view, &small))
		compare_blocks(x, &large, &small);
	lod_raster_free(&large);
	lod_raster_free(&small);
}

static void all_behind(struct extreme *x)
{
	static const double ways[][3] = { { -100, 0, 2 }, { -50, 0, 100 }, { -50.5, 0, 2 } };
	const struct extreme_world *world = extreme_world(x);
	for (int i = 0; i < 3 && world && !x->failed; i++) {
		struct eco_view view = extreme_view((double[3]){ -50, 0, 2 }, ways[i]);
		struct extreme_look look = { 0 };
		if (look_through(x, world, &view, true, &look))
			extreme_same(x, "plants, vertices and pixels of what is behind",
				look.plants + look.vertices + look.covered, 0);
	}
	if (!x->failed)
		extreme_say(x, "no plant, no vertex, no pixel in 3 views at 4 budgets");
}

/* ---- A horizon of a million tiles ---- */

#define SIDE EXTREME_SIDE_M
#define LEVELS 10u               /* 4^10 stands of four tiles */

/* The stand planted 4^LEVELS times: each level is four of the one below. A tile stands for what is below it
 * by the stand's own summary. Other tables stay those of `from`. */
static void widen(struct scene_builder *b, const struct eco_scene *from)
{
	const uint32_t shift = LEVELS - 1;       /* of the stand's tiles, which follow the levels */
	*b = (struct scene_builder){ .scene = *from };
	b->scene.root = b->scene.tile_count = b->scene.child_count = b->scene.group_count = 0;
	for (uint32_t i = 0; i < LEVELS; i++)
		scene_add_tile(b, (struct eco_tile){ .summary = from->tiles[1].summary });
	for (uint32_t i = 1; i < from->tile_count; i++) {
		struct eco_tile tile = from->tiles[i];
		tile.child_count = tile.group_count = 0;
		scene_add_tile(b, tile);
		for (uint32_t c = 0; c < from->tiles[i].child_count; c++) {
			struct eco_child child = from->children[from->tiles[i].child_first + c];
			child.tile += shift;
			scene_add_child(b, i + shift, child);
		}
	}
	for (uint32_t i = 0; i < from->group_count; i++)
		scene_add_group(b, (struct eco_group){ from->groups[i].tile + shift, from->groups[i].plant,
			from->groups[i].list, from->groups[i].place_first, from->groups[i].first,
			from->groups[i].count });
	for (uint32_t level = LEVELS; level-- > 0;) {
		double quarter = SIDE / 2 * ldexp(1, (int)(shift - level));
		struct eco_tile *t = &b->tiles[level], *below = t + 1;
		for (int i = 0; i < 3; i++) {
			t->low[i] = below->low[i] - (i < 2 ? quarter : 0);
			t->high[i] = below->high[i] + (i < 2 ? quarter : 0);
		}
		t->area = 4 * below->area;
		t->instance_count = 4 * below->instance_count;
		for (uint32_t c = 0; c < 4; c++)
			scene_add_child(b, level,
				(struct eco_child){ level + 1, true,
				{ c & 1 ? quarter : -quarter, c & 2 ? quarter : -quarter, 0 }, 0, 1 });
	}
}

static void look_along(struct extreme *x, const struct eco_scene *scene, const struct eco_view *view,
	uint64_t most, bool told)
{
	struct eco_request request = { .view = *view, .vertices = most, .bytes = ECO_BYTES_UNBOUNDED };
	struct extreme_look look = { 0 };
	if (plan_twice(x, scene, &request, &look) && told)
		extreme_say(x, "%llu plants in view, %llu vertices", (unsigned long long)look.plants,
			(unsigned long long)look.vertices);
	extreme_least(x, "vertices", (double)look.vertices, (double)(most / 2));
}

static void horizon(struct extreme *x)
{
	static const uint64_t most[] = { 1000, 100000, 1000000 };
	struct scene_builder w = { .scene.near_m = 0 };
	const struct extreme_world *world = extreme_world(x);
	const double reach = SIDE / 2 * ldexp(1, LEVELS);
	const double eyes[][3] = { { -reach, -reach, 1.7 }, { 0, 0, 1.7 }, { 0, 0, 0 } };
	const double targets[][3] = { { 0, 0, 1.7 }, { reach, 0, 1.7 }, { reach, reach, 0 } };
	if (world)
		widen(&w, extreme_tables(world));
	for (int v = 0; v < 3 && world; v++)
		for (int b = 0; b < (x->quick ? 2 : 3) && !x->failed; b++) {
			struct eco_view view = extreme_view(eyes[v], targets[v]);
			look_along(x, &w.scene, &view, most[b], b > 0);
		}
	scene_free(&w);
}

/* ---- Cases ---- */

#define SOUND "planned at 0, 50, 5000 and all vertices: within the budget, finite, the same twice; drawn"
#define LOOK(x, y, z, tx, ty, tz) { { x, y, z }, { tx, ty, tz }, { 0, 0, 1 }, 45, 320, 240 }
/* From beside the stand, with another up, lens or picture. */
#define BESIDE(ux, uy, uz, fov, width, height) { { -26, -21, 6.5 }, { 0, 0, 2 }, { ux, uy, uz }, fov, width, \
	height }
#define SHOTS(title, holds, ...) { title, holds, look_at, \
	(const struct shot[]){ __VA_ARGS__, { .name = NULL } }, false }

static const struct shot sizes[] = {
	{ .name = "1 x 1", .view = BESIDE(0, 0, 1, 45, 1, 1) },
	{ .name = "16384 x 1", .view = BESIDE(0, 0, 1, 45, 16384, 1) },
	{ .name = "1 x 16384", .view = BESIDE(0, 0, 1, 45, 1, 16384) },
	{ .name = "16384 x 16384, planned", .view = BESIDE(0, 0, 1, 45, 16384, 16384), .planned_only = true },
	{ .name = NULL },
};

const struct extreme_case extreme_camera[] = {
	SHOTS("inside a leaf", SOUND,
		{ "along it", LOOK(0, 0, 0, 0, 0, 0), FROM_LEAF, FROM_CORNER, 0, false },
		{ "across it", LOOK(0, 0, 0, 0, 0, 0), FROM_LEAF, FROM_NORMAL, 0, false }),
	SHOTS("inside the trunk", SOUND ": wood around the eye",
		{ "level", LOOK(0.02, 0, 1, 0, 0, 1), FROM_TREE, FROM_SCENE, 0.5, false },
		{ "up", LOOK(0.02, 0, 1, 0.02, 0, 5), FROM_TREE, FROM_TREE, 0.5, false },
		{ "down", LOOK(0.02, 0, 1, 0.02, 0, -5), FROM_TREE, FROM_TREE, 0.2, false }),
	SHOTS("on a tile's corner", SOUND,
		{ .name = "where four tiles meet", .view = LOOK(0, 0, 1, 10, 10, 1), .least = 0.01 },
		{ .name = "on the ground there", .view = LOOK(0, 0, 0, -1, 0, 0), .least = 0.01 },
		{ .name = "corner of the square",
			.view = LOOK(-EXTREME_SIDE_M / 2, -EXTREME_SIDE_M / 2, 0, 0, 0, 0), .least = 0.01 },
		{ .name = "along an edge", .view = LOOK(-EXTREME_SIDE_M / 2, 0, 2, EXTREME_SIDE_M / 2, 0, 2),
			.least = 0.01 }),
	/* nothing between the eye and what it looks at */
	SHOTS("at distance 0", SOUND,
		{ "at its foot", LOOK(0, 0, 0, 0, 1, 0), FROM_TREE, FROM_TREE, 0, false },
		{ "at its middle", LOOK(0, 0, 0, 1, 0, 0), FROM_MIDDLE, FROM_MIDDLE, 0, false },
		{ "at a cell's middle", LOOK(0, 0, 0, 1, 0, 0), FROM_CELL, FROM_CELL, 0, false }),
	SHOTS("at 1e9 m", SOUND,
		{ .name = "1e9 m", .view = LOOK(-1e9, 0, 1e8, 0, 0, 2) },
		{ .name = "1e12 m", .view = LOOK(-1e12, 1e12, 1e12, 0, 0, 2) },
		{ .name = "1e9 m through 2e-6 degrees",
		.view = { { 0, -1e9, 1e8 }, { 0, 0, 2 }, { 0, 0, 1 }, 2e-6, 320, 240 }, .least = 0.05 }),
	SHOTS("up along the direction", SOUND ": another up is taken",
		{ .name = "up is the direction", .view = BESIDE(26, 21, -4.5, 45, 320, 240), .least = 0.02 },
		{ .name = "up is its opposite", .view = BESIDE(-26, -21, 4.5, 45, 320, 240), .least = 0.02 },
		{ .name = "no up", .view = BESIDE(0, 0, 0, 45, 320, 240), .least = 0.02 },
		{ .name = "straight down", .view = LOOK(0, 0, 40, 0, 0, 0), .least = 0.02 },
		{ .name = "straight up", .view = LOOK(0, 0, -40, 0, 0, 0), .least = 0.02 },
		{ .name = "nearly along", .view = BESIDE(26 * (1 + 1e-13), 21, -4.5, 45, 320, 240),
			.least = 0.02 },
		{ .name = "up of 1e-300", .view = BESIDE(0, 0, 1e-300, 45, 320, 240), .least = 0.02 }),
	SHOTS("field of view 0.001 degrees", SOUND,
		{ .name = "0.001 degrees", .view = BESIDE(0, 0, 1, 0.001, 320, 240) },
		{ .name = "1e-9 degrees", .view = BESIDE(0, 0, 1, 1e-9, 320, 240) },
		{ .name = "0.001 degrees from 1000 km",
		.view = { { -1e6, 0, 1e5 }, { 0, 0, 2 }, { 0, 0, 1 }, 0.001, 320, 240 }, .least = 0.05 }),
	SHOTS("field of view 179.9 degrees", SOUND,
		{ .name = "179.9 degrees",
			.view = { { 0, 0, 2 }, { 10, 0, 2 }, { 0, 0, 1 }, 179.9, 320, 240 } },
		{ .name = "179.999999 degrees",
			.view = { { 0, 0, 2 }, { 10, 0, 2 }, { 0, 0, 1 }, 179.999999, 320, 240 } }),
	{ "pictures of 1 x 1 to 16384 x 16384", SOUND "; the largest: what it covers, "
		"against a small one", images, sizes, false },
	EXTREME_CASE("everything behind", "nothing is drawn, nothing predicted", all_behind),
	EXTREME_CASE("horizon along 4e6 tiles",
		"1e6 copies of a stand of four tiles: plans within the budget that use half of it at least",
		horizon),
	{ .name = NULL } };
