/* Places and cameras at the edge of what numbers can say. Place and turn of a scene and how
 * large its metre is must change nothing but rounding. Every view that passes the check is planned and drawn.
 * A camera that trembles by less than anyone can see has a plan that does not swing between two. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/sort.h"
#include "tests/bench/extreme/extreme_scene.h"
#include "tests/support/cases.h"

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

struct site_row { const char *name, *at, *turn, *scale, *plain; };

static void read_v3(const char *text, double v[3])
{
	assert_int_equal(sscanf(text, "%lf %lf %lf", &v[0], &v[1], &v[2]), 3);
}

/* A plant on a border between bands may change sides. */
UNIT_TEST(places_of_a_scene_change_rounding_only)
{
	static const uint64_t budgets[] = { 1500, 20000 };
	const struct extreme_site origin = { 0 };
	uint32_t count;
	const struct site_row *rows = cases_read("tests/bench/cases/extreme_sites.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < 2 * count; i++) {
		const struct site_row *row = &rows[i / 2];
		struct extreme_site site = { .turn = (uint16_t)cases_number(row->turn),
			.scale = cases_number(row->scale), .plain = cases_number(row->plain) > 0 };
		struct extreme_world moved = { 0 };
		struct eco_request request = extreme_request(budgets[i % 2]);
		read_v3(row->at, site.at);
		extreme_world_open(&moved, extreme_stand(), &site);
		struct seen here = see(extreme_world(), &origin, &request), there = see(&moved, &site, &request);
		double pixels = extreme_pixels_differ(&here.picture, &there.picture,
			!(site.scale > 0) && site.at[2] == 0 && !site.turn);
		double vertices = fabs((double)there.plan.vertices / (double)here.plan.vertices - 1);
		must_hold(here.plan.visible_plants == there.plan.visible_plants && vertices <= 0.01 && pixels < 0.001,
			"%s: %llu plants in view for %llu, vertices off by %g, %g of pixels differ", row->name,
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

enum from { FROM_SCENE, FROM_TREE, FROM_MIDDLE, FROM_CELL, FROM_LEAF, FROM_CORNER, FROM_NORMAL };
static const char *const froms[] = { "scene", "tree", "middle", "cell", "leaf", "corner", "normal", NULL };
struct shot { const char *name, *eye_from, *eye, *target_from, *target, *up, *lens, *least; };

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

static struct eco_view view_of(const struct shot *shot)
{
	struct eco_view view = { .width = 0 };
	read_v3(shot->eye, view.eye);
	read_v3(shot->target, view.target);
	read_v3(shot->up, view.up);
	assert_int_equal(sscanf(shot->lens, "%lf %u %u", &view.fov_y_deg, &view.width, &view.height), 3);
	add_place((enum from)cases_choice(shot->eye_from, froms), view.eye);
	add_place((enum from)cases_choice(shot->target_from, froms), view.target);
	return view;
}

/* At every budget; drawn at a small one and in full. */
UNIT_TEST(every_view_is_planned_and_drawn)
{
	static const uint64_t budgets[] = { 0, 50, 5000, ECO_VERTICES_MAX };
	uint32_t count;
	const struct shot *shots = cases_read("tests/bench/cases/extreme_shots.tsv", sizeof *shots, &count);
	for (uint32_t i = 0; i < 4 * count; i++) {
		const struct shot *shot = &shots[i / 4];
		double least = cases_number(shot->least);
		struct eco_request request = { .view = view_of(shot), .vertices = budgets[i % 4],
			.bytes = ECO_BYTES_UNBOUNDED };
		struct view_picture picture = { 0 };
		assert_good(eco_view_check(&request.view, &cause));
		struct extreme_look look = extreme_twice(extreme_tables(extreme_world()), &request);
		must_hold(least >= 0 || !(look.plants || look.vertices), "%s: plants are seen", shot->name);
		if (i % 2 == 0)
			continue;
		extreme_draw(extreme_world(), &request, &picture);
		double covered = (double)extreme_covered(&picture), all = (double)picture.width * picture.height;
		must_hold(least < 0 ? covered == 0 : i % 4 < 3 || covered >= least * all,
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
