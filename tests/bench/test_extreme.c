/* Places and cameras at the edge of what numbers can say. Where a scene stands, how it is turned and how large its metre
 * is must change nothing but rounding. Every view that passes the check is planned and drawn. A camera that trembles
 * by less than anyone can see has a plan that does not swing between two. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/sort.h"
#include "tests/bench/extreme/extreme_scene.h"

/* ---- One scene in two places ---- */

struct seen { struct eco_plan plan; struct view_picture picture; };

static struct seen see(const struct extreme_world *world, const struct extreme_site *site, const struct eco_request *from)
{
	struct eco_request request = *from;
	struct seen seen = { .plan = { 0 } };
	request.view = extreme_site_view(site, &from->view);
	extreme_plan(extreme_tables(world), &request, &seen.plan);
	extreme_draw(world, &request, &seen.picture);
	return seen;
}

static void forget(struct seen *seen)
{
	eco_plan_free(&seen->plan);
	view_picture_free(&seen->picture);
}

static const struct { const char *name; struct extreme_site site; } sites[] = {
	{ "1 km away", { .at = { 1e3, -1e3, 0 } } },
	{ "1000 km away", { .at = { 1e6, -1e6, 0 } } },
	{ "10000 km away", { .at = { 1e7, -1e7, 100 } } },
	{ "earth-centred", { .at = { 4178123.625, 853456.375, 4729876.5 } } },
	{ "1000 km away without a transform", { .at = { 1e6, -1e6, 100 }, .plain = true } },
	{ "10000 km away without a transform", { .at = { 1e7, -1e7, 0 }, .plain = true } },
	{ "earth-centred without a transform", { .at = { 4178123.625, 853456.375, 4729876.5 }, .plain = true } },
	{ "turned by 90 degrees", { .turn = 16384 } },
	{ "turned by 67.8 degrees", { .turn = 12345 } },
	{ "scaled by 1e-6", { .scale = 1e-6 } },
	{ "scaled by 1e6", { .scale = 1e6 } },
	{ "10000 km away, turned, scaled by 1/4", { .at = { 1e7, -1e7, 100 }, .turn = 54321, .scale = 0.25 } },
	{ "10000 km away, turned, scaled by 1e6", { .at = { 1e7, -1e7, 100 }, .turn = 777, .scale = 1e6 } } };

/* A plant on a border between bands may change sides. */
UNIT_TEST(places_of_a_scene_change_rounding_only)
{
	static const uint64_t budgets[] = { 1500, 20000 };
	const struct extreme_site origin = { 0 };
	for (size_t i = 0; i < 2 * sizeof sites / sizeof *sites; i++) {
		const struct extreme_site *site = &sites[i / 2].site;
		struct extreme_world moved = { 0 };
		struct eco_request request = extreme_request(budgets[i % 2]);
		extreme_world_open(&moved, extreme_stand(), site);
		struct seen here = see(extreme_world(), &origin, &request), there = see(&moved, site, &request);
		double pixels = extreme_pixels_differ(&here.picture, &there.picture,
			!(site->scale > 0) && site->at[2] == 0 && !site->turn);
		double vertices = fabs((double)there.plan.vertices / (double)here.plan.vertices - 1);
		must_hold(here.plan.visible_plants == there.plan.visible_plants && vertices <= 0.01 && pixels < 0.001,
			"%s: %llu plants in view for %llu, vertices off by %g, %g of pixels differ", sites[i / 2].name,
			(unsigned long long)there.plan.visible_plants, (unsigned long long)here.plan.visible_plants,
			vertices, pixels);
		forget(&here);
		forget(&there);
		extreme_world_close(&moved);
	}
}

/* ---- 1 mm beside 100 m ---- */

static void make_unlike(struct extreme_stand *stand)
{
	for (int moss = 0; moss < 2; moss++) {
		struct soup soup;
		soup_tree(&soup, 3000, 0, false);
		for (uint32_t i = 0; i < 3 * soup.model.vertex_count; i++)
			soup.model.position[i] *= moss ? 100.0f / 6 * 1e-5f : 100.0f / 6;
		assert_good(extreme_stand_add(stand, &soup, moss ? "moss" : "giant", &cause));
	}
	for (uint32_t i = 0; i < 12; i++)
		extreme_stand_place(stand, &(struct eco_source_instance){ .plant = i > 3,
			.at = { i < 4 ? 40 * (i + 1.0) - 90 : 1e-3 * i - 8e-3, i < 4 ? 60 : 0, 0 },
			.yaw_deg = 27 * i, .scale = 1 });
}

/* From 3 cm away the moss is drawn in full, and the trees far behind it as they should; from afar the moss is
 * nothing, and harms nothing. */
UNIT_TEST(plants_of_a_millimetre_stand_beside_some_of_100_m)
{
	static const double eyes[2][3] = { { 0, -0.03, 0.002 }, { 0, -300, 60 } };
	const struct extreme_site origin = { 0 };
	struct extreme_stand stand = { .plant_count = 0 };
	struct extreme_world world = { 0 };
	make_unlike(&stand);
	extreme_world_open(&world, &stand, &origin);
	for (int far = 0; far < 2; far++) {
		struct eco_request some = extreme_request(20000), all = extreme_request(ECO_VERTICES_MAX);
		some.view.target[2] = far ? some.view.target[2] : 5e-4;
		memcpy(some.view.eye, eyes[far], sizeof eyes[far]);
		all.view = some.view;
		struct seen seen = see(&world, &origin, &some), full = see(&world, &origin, &all);
		assert_true(extreme_covered(&full.picture) > 1000);
		assert_true(extreme_pixels_differ(&seen.picture, &full.picture, false) <= 0.2);
		forget(&seen);
		forget(&full);
	}
	extreme_world_close(&world);
	extreme_stand_free(&stand);
}

/* ---- Cameras ---- */

/* Eye and target of a shot are metres from somewhere: the scene's origin, its first tree's foot, the middle
 * of that tree or of its first cell; or the middle of one of its leaves, a corner of that leaf, and a metre
 * along its normal. `least`: share of pixels to be covered; -1: none may be. */
enum from { FROM_SCENE, FROM_TREE, FROM_MIDDLE, FROM_CELL, FROM_LEAF, FROM_CORNER, FROM_NORMAL };
#define NONE (-1)
#define LOOK(x, y, z, tx, ty, tz) { { x, y, z }, { tx, ty, tz }, { 0, 0, 1 }, 45, 320, 240 }
/* From beside the stand, with another up, lens or picture. */
#define BESIDE(ux, uy, uz, fov, width, height) { { -26, -21, 6.5 }, { 0, 0, 2 }, { ux, uy, uz }, fov, width, height }
#define HALF (EXTREME_SIDE_M / 2)
static const struct shot { const char *name; struct eco_view view; enum from eye, target; double least; } shots[] = {
	{ "in a leaf, along it", LOOK(0, 0, 0, 0, 0, 0), FROM_LEAF, FROM_CORNER, 0 },
	{ "in a leaf, across it", LOOK(0, 0, 0, 0, 0, 0), FROM_LEAF, FROM_NORMAL, 0 },
	{ "in the trunk, level", LOOK(0.02, 0, 1, 0, 0, 1), FROM_TREE, FROM_SCENE, 0.5 },
	{ "in the trunk, up", LOOK(0.02, 0, 1, 0.02, 0, 5), FROM_TREE, FROM_TREE, 0.5 },
	{ "in the trunk, down", LOOK(0.02, 0, 1, 0.02, 0, -5), FROM_TREE, FROM_TREE, 0.2 },
	{ "where four tiles meet", LOOK(0, 0, 1, 10, 10, 1), 0, 0, 0.01 },
	{ "on the ground there", LOOK(0, 0, 0, -1, 0, 0), 0, 0, 0.01 },
	{ "in a corner of the square", LOOK(-HALF, -HALF, 0, 0, 0, 0), 0, 0, 0.01 },
	{ "along an edge", LOOK(-HALF, 0, 2, HALF, 0, 2), 0, 0, 0.01 },
	{ "at the tree's foot", LOOK(0, 0, 0, 0, 1, 0), FROM_TREE, FROM_TREE, 0 },
	{ "at its middle", LOOK(0, 0, 0, 1, 0, 0), FROM_MIDDLE, FROM_MIDDLE, 0 },
	{ "at a cell's middle", LOOK(0, 0, 0, 1, 0, 0), FROM_CELL, FROM_CELL, 0 },
	{ "at 1e9 m", LOOK(-1e9, 0, 1e8, 0, 0, 2), 0, 0, 0 },
	{ "at 1e12 m", LOOK(-1e12, 1e12, 1e12, 0, 0, 2), 0, 0, 0 },
	{ "at 1e9 m through 2e-6 degrees", { { 0, -1e9, 1e8 }, { 0, 0, 2 }, { 0, 0, 1 }, 2e-6, 320, 240 }, 0, 0, 0.05 },
	{ "up is the direction", BESIDE(26, 21, -4.5, 45, 320, 240), 0, 0, 0.02 },
	{ "up is its opposite", BESIDE(-26, -21, 4.5, 45, 320, 240), 0, 0, 0.02 },
	{ "no up", BESIDE(0, 0, 0, 45, 320, 240), 0, 0, 0.02 },
	{ "straight down", LOOK(0, 0, 40, 0, 0, 0), 0, 0, 0.02 },
	{ "straight up", LOOK(0, 0, -40, 0, 0, 0), 0, 0, 0.02 },
	{ "nearly along up", BESIDE(26 * (1 + 1e-13), 21, -4.5, 45, 320, 240), 0, 0, 0.02 },
	{ "up of 1e-300", BESIDE(0, 0, 1e-300, 45, 320, 240), 0, 0, 0.02 },
	{ "0.001 degrees", BESIDE(0, 0, 1, 0.001, 320, 240), 0, 0, 0 },
	{ "1e-9 degrees", BESIDE(0, 0, 1, 1e-9, 320, 240), 0, 0, 0 },
	{ "0.001 degrees from 1000 km", { { -1e6, 0, 1e5 }, { 0, 0, 2 }, { 0, 0, 1 }, 0.001, 320, 240 }, 0, 0, 0.05 },
	{ "179.9 degrees", { { 0, 0, 2 }, { 10, 0, 2 }, { 0, 0, 1 }, 179.9, 320, 240 }, 0, 0, 0 },
	{ "179.999999 degrees", { { 0, 0, 2 }, { 10, 0, 2 }, { 0, 0, 1 }, 179.999999, 320, 240 }, 0, 0, 0 },
	{ "1 x 1", BESIDE(0, 0, 1, 45, 1, 1), 0, 0, 0 },
	{ "16384 x 1", BESIDE(0, 0, 1, 45, 16384, 1), 0, 0, 0 },
	{ "1 x 16384", BESIDE(0, 0, 1, 45, 1, 16384), 0, 0, 0 },
	{ "all behind, level", LOOK(-50, 0, 2, -100, 0, 2), 0, 0, NONE },
	{ "all behind, up", LOOK(-50, 0, 2, -50, 0, 100), 0, 0, NONE },
	{ "all behind, near", LOOK(-50, 0, 2, -50.5, 0, 2), 0, 0, NONE } };

/* A leaf of the first tree: its middle, a corner, and a metre along its normal. */
static void find_leaf(const struct lod_place *place, struct lod_v3 leaf[3])
{
	const struct lod_plant *tree = &extreme_stand()->plants[0];
	const struct lod_list_draft *leaves = NULL;
	struct lod_v3 corner[ECO_CORNERS_MAX], sum = { 0, 0, 0 };
	for (uint32_t i = 0; i < tree->ladder_count && !leaves; i++)
		if (tree->ladders[i].organ == ECO_ORGAN_FOLIAGE && tree->ladders[i].triangles != ECO_NONE)
			leaves = &tree->lists[tree->ladders[i].triangles];
	assert_non_null(leaves);
	const uint32_t corners = leaves->elements.corners[0];
	for (uint32_t k = 0; k < corners; k++) {
		float p[3];
		double at[3];
		for (uint32_t i = 0; i < 3; i++)
			p[i] = (float)(leaves->list.grid_origin[i]
				+ leaves->list.grid_step[i] * leaves->elements.position[3 * k + i]);
		lod_place_point(place, p, at);
		corner[k] = (struct lod_v3){ at[0], at[1], at[2] };
		sum = lod_v3_add(sum, corner[k]);
	}
	leaf[0] = lod_v3_scale(sum, 1.0 / corners);
	leaf[1] = corner[0];
	leaf[2] = lod_v3_add(leaf[0],
		lod_v3_unit(lod_v3_cross(lod_v3_sub(corner[0], leaf[0]), lod_v3_sub(corner[1], leaf[0]))));
}

static void add_place(enum from from, double at[3])
{
	const struct eco_scene *s = extreme_tables(extreme_world());
	struct lod_place place = extreme_placed(extreme_world(), 0, 0);
	const struct eco_plant *plant = &s->plants[s->groups[0].plant];
	struct lod_v3 leaf[3];
	double more[3] = { 0, 0, 0 };
	assert_true(from != FROM_CELL || plant->anchor_count > 1);
	if (from == FROM_TREE) {
		memcpy(more, place.at, sizeof more);
	} else if (from == FROM_MIDDLE || from == FROM_CELL) {
		lod_place_point(&place, s->anchors[plant->anchor_first + (from == FROM_CELL)].center, more);
	} else if (from >= FROM_LEAF) {
		find_leaf(&place, leaf);
		for (int i = 0; i < 3; i++)
			more[i] = lod_v3_axis(leaf[from - FROM_LEAF], i);
	}
	for (int i = 0; i < 3; i++)
		at[i] += more[i];
}

/* At every budget; drawn at a small one and in full. */
UNIT_TEST(every_view_is_planned_and_drawn)
{
	static const uint64_t budgets[] = { 0, 50, 5000, ECO_VERTICES_MAX };
	for (size_t i = 0; i < 4 * sizeof shots / sizeof *shots; i++) {
		const struct shot *shot = &shots[i / 4];
		struct eco_request request = { .view = shot->view, .vertices = budgets[i % 4],
			.bytes = ECO_BYTES_UNBOUNDED };
		struct view_picture picture = { 0 };
		add_place(shot->eye, request.view.eye);
		add_place(shot->target, request.view.target);
		assert_good(eco_view_check(&request.view, &cause));
		struct extreme_look look = extreme_twice(extreme_tables(extreme_world()), &request);
		must_hold(shot->least >= 0 || !(look.plants || look.vertices), "%s: plants are seen", shot->name);
		if (i % 2 == 0)
			continue;
		extreme_draw(extreme_world(), &request, &picture);
		double covered = (double)extreme_covered(&picture), all = (double)picture.width * picture.height;
		must_hold(shot->least < 0 ? covered == 0 : i % 4 < 3 || covered >= shot->least * all,
			"%s: %g of %g pixels", shot->name, covered, all);
		view_picture_free(&picture);
	}
}

UNIT_TEST(the_largest_picture_is_planned)
{
	struct eco_request request = extreme_request(5000);
	request.view.width = request.view.height = 16384;
	extreme_twice(extreme_tables(extreme_world()), &request);
}

/* ---- Trembling ---- */

/* vertices, predicted wrong pixels; plans that differ from the one before */
struct swing { uint64_t least, most; double wrong[2]; uint32_t changes; };

/* Plans around one view, the eye moved by up to `reach_m` along so many axes. */
static struct swing tremble(const struct eco_request *still, double reach_m, int axes, uint32_t count, uint64_t *state)
{
	struct eco_writer last = { 0 };
	struct swing s = { .least = UINT64_MAX, .wrong = { INFINITY, 0 } };
	for (uint32_t i = 0; i < count; i++) {
		struct eco_request request = *still;
		struct eco_plan plan = { 0 };
		struct eco_writer bytes = { 0 };
		for (int k = 0; k < axes; k++)
			request.view.eye[k] += reach_m * (eco_random_unit(*state = lod_mix(*state + 1)) * 2 - 1);
		extreme_plan(extreme_tables(extreme_world()), &request, &plan);
		double wrong = plan.prediction.fp + plan.prediction.fn;
		s.least = plan.vertices < s.least ? plan.vertices : s.least;
		s.most = plan.vertices > s.most ? plan.vertices : s.most;
		s.wrong[0] = fmin(s.wrong[0], wrong);
		s.wrong[1] = fmax(s.wrong[1], wrong);
		plan.prediction = (struct eco_prediction){ 0 };      /* may differ in its last bits */
		eco_wire_write_plan(&bytes, &plan);
		s.changes += i && (last.size != bytes.size || memcmp(last.bytes, bytes.bytes, last.size));
		eco_writer_free(&last);
		last = bytes;
		eco_plan_free(&plan);
	}
	eco_writer_free(&last);
	return s;
}

UNIT_TEST(trembling_by_a_nanometre_changes_one_plan_of_a_hundred)
{
	uint32_t changes = 0;
	uint64_t state = 5;
	for (int v = 0; v < 4; v++) {
		struct eco_request still = extreme_request(5000);
		still.view.eye[0] += 3.7 * v;
		still.view.eye[1] += 1.3 * v;
		struct swing s = tremble(&still, 1e-9, 3, 50, &state);
		assert_true(s.wrong[1] - s.wrong[0] <= 1e-4 * s.wrong[1] && s.most - s.least <= s.most / 1000);
		changes += s.changes;
	}
	assert_in_range(changes, 0, 2);
}

/* An eye exactly on the border between two bands of a plant: trembling may change that plant's band, with it
 * whether it is drawn as splats or by its organs, and hardly anything else. */
UNIT_TEST(trembling_by_a_millimetre_across_a_border_of_bands_hardly_changes_errors)
{
	uint64_t state = 9;
	for (int v = 0; v < 6; v++) {
		struct eco_request request = extreme_request(5000);
		double away = 8 * exp2(v / 4.0);
		memcpy(request.view.eye, (double[3]){ -away, -away, 3 }, sizeof request.view.eye);
		struct swing s = tremble(&request, 1e-3, 1, 40, &state);
		assert_true(s.wrong[1] <= 1.04 * s.wrong[0]);
	}
}
