/* Place: where a scene stands, how it is turned and how large its metre is must change nothing but rounding. Each scene is packed anew for
 * its place, planned and drawn, and compared with the one at the origin. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/plan.h"
#include "tests/bench/bench_extreme_scene.h"
#include "tests/support/plant_models.h"

#define PIXELS_MOST 0.001        /* share that may differ */
#define VERTICES_MOST 0.01       /* a plant on a border between bands may change sides */

/* ---- One scene in two places ---- */

struct seen { struct eco_plan plan; struct view_picture picture; };

static void free_seen(struct seen *seen)
{
	eco_plan_free(&seen->plan);
	view_picture_free(&seen->picture);
}

static bool see(struct extreme *x, const struct extreme_stand *stand, const struct extreme_site *site, const struct eco_request *from,
	struct seen *seen)
{
	struct extreme_world world = { 0 };
	struct eco_request request = *from;
	struct eco_error error = { 0 };
	request.view = extreme_site_view(site, &from->view);
	*seen = (struct seen){ 0 };
	bool good = extreme_good(x, extreme_world_open(&world, stand, site, &error), &error)
		&& extreme_good(x, extreme_plan(&world, &request, &seen->plan, NULL, &error), &error)
		&& extreme_plan_sound(x, &seen->plan, &request)
		&& extreme_good(x, extreme_draw(&world, &request, &seen->picture, &error), &error);
	extreme_world_close(&world);
	if (!good)
		free_seen(seen);
	return good;
}

/* Cuts of one that the other has, too. */
static uint32_t shared_cuts(const struct eco_plan *a, const struct eco_plan *b)
{
	uint32_t same = 0;
	for (uint32_t i = 0; i < a->cut_count; i++)
		for (uint32_t k = 0; k < b->cut_count; k++)
			if (!memcmp(&a->cuts[i], &b->cuts[k], sizeof *a->cuts)) {
				same++;
				break;
			}
	return same;
}

static void compare(struct extreme *x, const struct seen *here, const struct seen *there, bool colours)
{
	double pixels = extreme_pixels_differ(&here->picture, &there->picture, colours);
	double vertices = fabs((double)there->plan.vertices - (double)here->plan.vertices) / (double)here->plan.vertices;
	uint32_t same = shared_cuts(&here->plan, &there->plan);
	extreme_must(x, here->plan.visible_plants == there->plan.visible_plants, "%llu plants in view, %llu at the origin",
		(unsigned long long)there->plan.visible_plants, (unsigned long long)here->plan.visible_plants);
	extreme_must(x, vertices <= VERTICES_MOST, "%llu vertices, %llu at the origin", (unsigned long long)there->plan.vertices,
		(unsigned long long)here->plan.vertices);
	extreme_must(x, pixels < PIXELS_MOST, "%.4f %% of pixels differ (%u of %u cuts are the same)", 100 * pixels, same, here->plan.cut_count);
	extreme_say(x, "%u of %u cuts are the same, %.4f %% of pixels differ", same, here->plan.cut_count, 100 * pixels);
}

static void at_site(struct extreme *x, const struct extreme_site *site)
{
	static const uint64_t budgets[] = { 1500, 20000, ECO_VERTICES_MAX };
	const struct extreme_stand *stand = extreme_stand_shared(x);
	for (int i = 0; i < (x->quick ? 2 : 3) && stand; i++) {
		struct eco_request request = extreme_request(budgets[i]);
		struct seen here, there;
		if (!see(x, stand, &(struct extreme_site){ 0 }, &request, &here))
			return;
		if (see(x, stand, site, &request, &there)) {
			compare(x, &here, &there, !(site->scale > 0) && site->at[2] == 0);
			free_seen(&there);
		}
		free_seen(&here);
	}
}

/* ---- Shifted, turned, scaled ---- */

static void shift_1e3(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e3, -1e3, 0 } }); }
static void shift_1e6(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e6, -1e6, 0 } }); }
static void shift_1e7(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e7, -1e7, 100 } }); }
static void shift_ecef(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 4178123.625, 853456.375, 4729876.5 } }); }
static void plain_1e6(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e6, -1e6, 100 }, .plain = true }); }
static void plain_1e7(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e7, -1e7, 0 }, .plain = true }); }
static void plain_ecef(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 4178123.625, 853456.375, 4729876.5 }, .plain = true }); }
static void turn_quarter(struct extreme *x) { at_site(x, &(struct extreme_site){ .turn = 16384 }); }
static void turn_odd(struct extreme *x) { at_site(x, &(struct extreme_site){ .turn = 12345 }); }
static void scale_1e_6(struct extreme *x) { at_site(x, &(struct extreme_site){ .scale = 1e-6 }); }
static void scale_1e_3(struct extreme *x) { at_site(x, &(struct extreme_site){ .scale = 1e-3 }); }
static void scale_1e3(struct extreme *x) { at_site(x, &(struct extreme_site){ .scale = 1e3 }); }
static void scale_1e6(struct extreme *x) { at_site(x, &(struct extreme_site){ .scale = 1e6 }); }
static void all_small(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e7, -1e7, 100 }, .turn = 54321, .scale = 0.25 }); }
static void all_large(struct extreme *x) { at_site(x, &(struct extreme_site){ .at = { 1e7, -1e7, 100 }, .turn = 777, .scale = 1e6 }); }

/* ---- 1 mm beside 100 m ---- */

static enum eco_code make_unlike(struct extreme_stand *stand, struct eco_error *error)
{
	struct soup soup;
	*stand = (struct extreme_stand){ .side = 200, .near_m = 1e-4 };
	soup_tree(&soup, 3000, 0, false);
	for (uint32_t i = 0; i < 3 * soup.model.vertex_count; i++)
		soup.model.position[i] *= 100.0f / 6;
	enum eco_code code = extreme_stand_add(stand, &soup.model, "giant", error);
	for (uint32_t i = 0; i < 3 * soup.model.vertex_count; i++)
		soup.model.position[i] *= 1e-5f;
	code = code ? code : extreme_stand_add(stand, &soup.model, "moss", error);
	soup_free(&soup);
	for (uint32_t i = 0; i < 12 && !code; i++)
		if (!extreme_stand_place(stand, &(struct extreme_place){ .plant = i > 3, .at = { i < 4 ? 40 * (i + 1.0) - 90 : 1e-3 * i - 8e-3,
			i < 4 ? 60 : 0, 0 }, .turn = (uint16_t)(5000 * i), .scale = 1 }))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for a stand");
	return code;
}

/* From 3 cm away the moss is drawn in full, and the trees far behind it as they should; from afar the moss is nothing, and harms nothing. */
static void unlike(struct extreme *x)
{
	struct extreme_stand stand;
	struct extreme_world world = { 0 };
	struct eco_error error = { 0 };
	struct eco_request near = extreme_request(20000), far = near;
	near.view.target[2] = 5e-4;
	memcpy(near.view.eye, (double[3]){ 0, -0.03, 0.002 }, sizeof near.view.eye);
	memcpy(far.view.eye, (double[3]){ 0, -300, 60 }, sizeof far.view.eye);
	bool good = extreme_good(x, make_unlike(&stand, &error), &error)
		&& extreme_good(x, extreme_world_open(&world, &stand, &(struct extreme_site){ 0 }, &error), &error);
	for (int v = 0; v < 2 && good; v++) {
		const struct eco_request *request = v ? &far : &near;
		struct eco_plan plan = { 0 };
		struct view_picture picture = { 0 }, full = { 0 };
		struct eco_request all = *request;
		uint64_t covered = 0;
		all.vertices = ECO_VERTICES_MAX;
		good = extreme_good(x, extreme_plan(&world, request, &plan, NULL, &error), &error) && extreme_plan_sound(x, &plan, request)
			&& extreme_good(x, extreme_draw(&world, request, &picture, &error), &error)
			&& extreme_good(x, extreme_draw(&world, &all, &full, &error), &error);
		for (size_t i = 0; good && i < (size_t)full.width * full.height; i++)
			covered += full.cover[i] != 0;
		if (good) {
			double differ = extreme_pixels_differ(&picture, &full, false);
			extreme_must(x, covered > 1000 && differ < 0.2, "%s: %llu pixels covered, %.1f %% of the picture differ from full detail",
				v ? "afar" : "near", (unsigned long long)covered, 100 * differ);
			extreme_say(x, "%s: %llu plants in view, %llu pixels covered, %.1f %% differ from full detail", v ? "from 300 m" : "from 3 cm",
				(unsigned long long)plan.visible_plants, (unsigned long long)covered, 100 * differ);
		}
		eco_plan_free(&plan);
		view_picture_free(&picture);
		view_picture_free(&full);
	}
	extreme_world_close(&world);
	extreme_stand_free(&stand);
}

#define SAME "same plan up to rounding; < 0.1 % of pixels differ from the origin's; at 1500 and 20000 vertices and in full"

static const struct extreme_case cases[] = {
	{ "1 km away", SAME, false, shift_1e3 },
	{ "1000 km away", SAME, false, shift_1e6 },
	{ "10000 km away", SAME, false, shift_1e7 },
	{ "earth-centred coordinates", SAME, false, shift_ecef },
	{ "1000 km away without a transform", SAME, false, plain_1e6 },
	{ "10000 km away without a transform", SAME, false, plain_1e7 },
	{ "earth-centred without a transform", SAME, false, plain_ecef },
	{ "turned by 90 degrees", SAME, false, turn_quarter },
	{ "turned by 67.8 degrees", SAME, false, turn_odd },
	{ "scaled by 1e-6", SAME, false, scale_1e_6 },
	{ "scaled by 1e-3", SAME, true, scale_1e_3 },
	{ "scaled by 1e3", SAME, true, scale_1e3 },
	{ "scaled by 1e6", SAME, false, scale_1e6 },
	{ "10000 km away; turned; scaled by 1/4", SAME, false, all_small },
	{ "10000 km away; turned; scaled by 1e6", SAME, true, all_large },
	{ "plants of 1 mm beside 100 m", "sound plans and pictures from 3 cm and from 300 m; < 20 % of pixels differ from full detail with 20000 "
		"vertices", false, unlike },
};

const struct extreme_family extreme_place = { "place", cases, sizeof cases / sizeof *cases };
