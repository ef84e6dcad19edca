/* Camera: unusual places and lenses. Every view that passes the check must be planned and drawn. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/vector.h"
#include "tests/bench/extreme/extreme_scene.h"

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
static struct extreme_look plan_twice(struct extreme *x, const struct eco_scene *scene,
	const struct eco_request *request)
{
	struct eco_writer first = { 0 };
	struct extreme_look look;
	extreme_again(x, scene, request, &first, &look);
	extreme_again(x, scene, request, &first, NULL);
	eco_writer_free(&first);
	return look;
}

/* At every budget; drawn at a small one and in full. */
static struct extreme_look look_through(struct extreme *x, const struct extreme_world *world,
	const struct eco_view *view, bool drawn)
{
	struct eco_request request = { .view = *view, .bytes = ECO_BYTES_UNBOUNDED };
	struct extreme_look look = { 0 };
	extreme_good(x, eco_view_check(view, &x->error));
	for (int i = 0; i < BUDGETS; i++) {
		struct view_picture picture = { 0 };
		request.vertices = budgets[i];
		look = plan_twice(x, extreme_tables(world), &request);
		if (drawn && (i == 1 || i == BUDGETS - 1)) {
			extreme_draw(x, world, &request, &picture);
			look.covered = extreme_covered(&picture);
		}
		view_picture_free(&picture);
	}
	return look;
}

/* A leaf of the first tree: its middle, a corner, and a metre along its normal. */
static void find_leaf(struct extreme *x, const struct lod_place *place, struct lod_v3 leaf[3])
{
	const struct lod_plant *tree = &extreme_stand(x)->plants[0];
	const struct lod_list_draft *leaves = NULL;
	struct lod_v3 corner[2] = { { 0, 0, 0 } };
	for (uint32_t i = 0; i < tree->ladder_count && !leaves; i++)
		if (tree->ladders[i].organ == ECO_ORGAN_FOLIAGE && tree->ladders[i].triangles != ECO_NONE)
			leaves = &tree->lists[tree->ladders[i].triangles];
	extreme_must(x, leaves != NULL, "the tree has no leaves");
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
}

static void place_of(struct extreme *x, const struct extreme_world *world, enum from from, double at[3])
{
	const struct eco_scene *s = extreme_tables(world);
	struct lod_place place = extreme_placed(world, 0, 0);
	const struct eco_plant *plant = &s->plants[s->groups[0].plant];
	struct lod_v3 leaf[3];
	memset(at, 0, 3 * sizeof *at);
	extreme_must(x, from != FROM_CELL || plant->anchor_count > 1, "the tree has no cells");
	if (from == FROM_TREE) {
		memcpy(at, place.at, 3 * sizeof *at);
	} else if (from == FROM_MIDDLE || from == FROM_CELL) {
		lod_place_point(&place, s->anchors[plant->anchor_first + (from == FROM_CELL)].center, at);
	} else if (from >= FROM_LEAF) {
		find_leaf(x, &place, leaf);
		at[0] = leaf[from - FROM_LEAF].x;
		at[1] = leaf[from - FROM_LEAF].y;
		at[2] = leaf[from - FROM_LEAF].z;
	}
}

static void look_at(struct extreme *x)
{
	const struct extreme_world *world = extreme_world(x);
	for (const struct shot *shot = x->made; shot->name; shot++) {
		struct eco_view view = shot->view;
		double eye[3], target[3];
		char covered[32] = "";
		place_of(x, world, shot->eye, eye);
		place_of(x, world, shot->target, target);
		for (int i = 0; i < 3; i++) {
			view.eye[i] += eye[i];
			view.target[i] += target[i];
		}
		struct extreme_look look = look_through(x, world, &view, !shot->planned_only);
		double share = (double)look.covered / ((double)view.width * view.height);
		extreme_least(x, shot->name, shot->planned_only ? 1 : share, shot->least);
		if (!shot->planned_only)
			snprintf(covered, sizeof covered, ", %.1f %% covered", 100 * share);
		extreme_say(x, "%s: %llu plants, %llu vertices%s", shot->name, (unsigned long long)look.plants,
			(unsigned long long)look.vertices, covered);
	}
}

/* ---- The largest picture ---- */

enum { LARGE = 16384, SMALL = 1024, TIMES = LARGE / SMALL };

/* Blocks of pixels of the largest picture against pixels of the small one: what is all covered, or not at all,
 * is so there. */
static void compare_blocks(struct extreme *x, const uint8_t *large, const uint8_t *small)
{
	uint32_t odd = 0;
	uint64_t covered[2] = { 0 };
	for (uint32_t i = 0; i < SMALL * SMALL; i++) {
		const uint8_t *block = large + ((size_t)(i / SMALL) * LARGE + i % SMALL) * TIMES;
		uint32_t count = 0;
		for (uint32_t k = 0; k < TIMES * TIMES; k++)
			count += block[(size_t)(k / TIMES) * LARGE + k % TIMES];
		covered[0] += count;
		covered[1] += small[i];
		odd += (count == 0 && small[i]) || (count == TIMES * TIMES && !small[i]);
	}
	double share = (double)covered[0] / ((double)LARGE * LARGE),
		coarse = (double)covered[1] / ((double)SMALL * SMALL);
	extreme_most(x, "blocks of the largest picture unlike the pixels of a small one", odd,
		SMALL * SMALL / 10000);
	extreme_least(x, "share covered in the largest picture", share, 0.02);
	extreme_most(x, "share covered in it, off the small one's", fabs(share - coarse), 0.005 * share);
	extreme_say(x, "16384 x 16384 drawn: %.3f %% covered, %.3f %% at 1024 x 1024, %u of %u blocks "
		"unlike", 100 * share, 100 * coarse, odd, SMALL * SMALL);
}

static void images(struct extreme *x)
{
	struct eco_request request = { .vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED,
		.view = extreme_view((double[3]){ -26, -21, 6.5 }, (double[3]){ 0, 0, 2 }) };
	look_at(x);
	if (x->quick)
		return;
	uint8_t *large = eco_alloc((size_t)LARGE * LARGE, 1), *small = eco_alloc((size_t)SMALL * SMALL, 1);
	request.view.width = request.view.height = LARGE;
	extreme_cover(x, extreme_world(x), &request, large);
	request.view.width = request.view.height = SMALL;
	extreme_cover(x, extreme_world(x), &request, small);
	compare_blocks(x, large, small);
	free(large);
	free(small);
}

static void all_behind(struct extreme *x)
{
	static const double ways[][3] = { { -100, 0, 2 }, { -50, 0, 100 }, { -50.5, 0, 2 } };
	for (int i = 0; i < 3; i++) {
		struct eco_view view = extreme_view((double[3]){ -50, 0, 2 }, ways[i]);
		struct extreme_look look = look_through(x, extreme_world(x), &view, true);
		extreme_same(x, "plants, vertices and pixels of what is behind",
			look.plants + look.vertices + look.covered, 0);
	}
	extreme_say(x, "no plant, no vertex, no pixel in 3 views at 4 budgets");
}

/* ---- A horizon of a million tiles ---- */

#define SIDE EXTREME_SIDE_M
#define LEVELS 10u               /* 4^10 stands of four tiles */

/* The stand planted 4^LEVELS times: each level is four of the one below, behind the stand's own tiles. A tile
 * stands for what is below it by the stand's own summary. The caller frees tiles and children. */
static struct eco_scene widen(const struct eco_scene *from)
{
	uint32_t below = 1, tile = from->tile_count, child = from->child_count;
	struct eco_tile *tiles = eco_alloc(tile + LEVELS, sizeof *tiles);
	struct eco_child *children = eco_alloc(child + 4 * LEVELS, sizeof *children);
	struct eco_scene scene = *from;
	memcpy(tiles, from->tiles, tile * sizeof *tiles);
	memcpy(children, from->children, child * sizeof *children);
	for (uint32_t level = 0; level < LEVELS; level++, below = tile++) {
		double quarter = SIDE / 2 * ldexp(1, (int)level);
		struct eco_tile *t = &tiles[tile];
		*t = tiles[below];
		t->group_count = 0;
		t->child_first = child;
		t->child_count = 4;
		for (int i = 0; i < 2; i++) {
			t->low[i] -= quarter;
			t->high[i] += quarter;
		}
		t->area *= 4;
		t->instance_count *= 4;
		for (uint32_t c = 0; c < 4; c++)
			children[child++] = (struct eco_child){ below, true,
				{ c & 1 ? quarter : -quarter, c & 2 ? quarter : -quarter, 0 }, 0, 1 };
	}
	scene.root = below;
	scene.tiles = tiles;
	scene.children = children;
	scene.tile_count = tile;
	scene.child_count = child;
	return scene;
}

static void horizon(struct extreme *x)
{
	static const uint64_t most[] = { 1000, 100000, 1000000 };
	const double reach = SIDE / 2 * ldexp(1, LEVELS);
	const double eyes[][3] = { { -reach, -reach, 1.7 }, { 0, 0, 1.7 }, { 0, 0, 0 } };
	const double targets[][3] = { { 0, 0, 1.7 }, { reach, 0, 1.7 }, { reach, reach, 0 } };
	struct eco_scene wide = widen(extreme_tables(extreme_world(x)));
	for (int v = 0; v < 3; v++)
		for (int b = 0; b < (x->quick ? 2 : 3); b++) {
			struct eco_request request = { .view = extreme_view(eyes[v], targets[v]),
				.vertices = most[b], .bytes = ECO_BYTES_UNBOUNDED };
			struct extreme_look look = plan_twice(x, &wide, &request);
			if (b > 0)
				extreme_say(x, "%llu plants in view, %llu vertices",
					(unsigned long long)look.plants, (unsigned long long)look.vertices);
			extreme_least(x, "vertices", (double)look.vertices, (double)(most[b] / 2));
		}
	free((void *)(uintptr_t)wide.tiles);
	free((void *)(uintptr_t)wide.children);
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
