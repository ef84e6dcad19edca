/* Place: where a scene stands, how it is turned and how large its metre is must change nothing but rounding.
 * Each scene is packed anew for its place, planned and drawn, and compared with the one at the origin. */
#include <math.h>
#include <string.h>

#include "tests/bench/extreme/extreme_scene.h"

/* ---- One scene in two places ---- */

struct seen { struct eco_plan plan; struct view_picture picture; };

static struct seen see(struct extreme *x, const struct extreme_world *world, const struct extreme_site *site,
	const struct eco_request *from)
{
	struct eco_request request = *from;
	struct seen seen = { .plan = { 0 } };
	request.view = extreme_site_view(site, &from->view);
	extreme_plan(x, extreme_tables(world), &request, &seen.plan);
	extreme_draw(x, world, &request, &seen.picture);
	return seen;
}

static void compare(struct extreme *x, const struct seen *here, const struct seen *there, bool colours)
{
	const struct eco_plan *a = &here->plan, *b = &there->plan;
	double pixels = extreme_pixels_differ(&here->picture, &there->picture, colours);
	uint32_t same = 0;
	for (uint32_t i = 0, k; i < a->cut_count; i++) {
		for (k = 0; k < b->cut_count && memcmp(&a->cuts[i], &b->cuts[k], sizeof *a->cuts); k++)
			;
		same += k < b->cut_count;
	}
	extreme_same(x, "plants in view, as at the origin", b->visible_plants, a->visible_plants);
	/* a plant on a border between bands may change sides */
	extreme_most(x, "vertices, off those at the origin",
		fabs((double)b->vertices - (double)a->vertices) / (double)a->vertices, 0.01);
	extreme_must(x, pixels < 0.001, "%.4f %% of pixels differ (%u of %u cuts are the same)", 100 * pixels,
		same, a->cut_count);
	extreme_say(x, "%u of %u cuts are the same, %.4f %% of pixels differ", same, a->cut_count, 100
		* pixels);
}

static void at_site(struct extreme *x)
{
	static const uint64_t budgets[] = { 1500, 20000, ECO_VERTICES_MAX };
	const struct extreme_site *site = x->made, origin = { 0 };
	const struct extreme_world *world = extreme_world(x);
	struct extreme_world moved = { 0 };
	extreme_world_open(x, &moved, extreme_stand(x), site);
	for (int i = 0; i < (x->quick ? 2 : 3); i++) {
		struct eco_request request = extreme_request(budgets[i]);
		struct seen seen[2] = { see(x, world, &origin, &request), see(x, &moved, site, &request) };
		compare(x, &seen[0], &seen[1], !(site->scale > 0) && site->at[2] == 0 && !site->turn);
		for (int k = 0; k < 2; k++) {
			eco_plan_free(&seen[k].plan);
			view_picture_free(&seen[k].picture);
		}
	}
	extreme_world_close(&moved);
}

/* ---- 1 mm beside 100 m ---- */

static void make_unlike(struct extreme *x, struct extreme_stand *stand)
{
	for (int moss = 0; moss < 2; moss++) {
		struct soup soup;
		soup_tree(&soup, 3000, 0, false);
		for (uint32_t i = 0; i < 3 * soup.model.vertex_count; i++)
			soup.model.position[i] *= moss ? 100.0f / 6 * 1e-5f : 100.0f / 6;
		extreme_good(x, extreme_stand_add(stand, &soup, moss ? "moss" : "giant", &x->error));
	}
	for (uint32_t i = 0; i < 12; i++)
		extreme_stand_place(stand, &(struct eco_source_instance){ .plant = i > 3,
			.at = { i < 4 ? 40 * (i + 1.0) - 90 : 1e-3 * i - 8e-3, i < 4 ? 60 : 0, 0 },
			.yaw_deg = 27 * i, .scale = 1 });
}

static void look_unlike(struct extreme *x, const struct extreme_world *world, const struct eco_request *request,
	const char *name)
{
	const struct extreme_site origin = { 0 };
	struct seen seen = see(x, world, &origin, request);
	struct view_picture full = { 0 };
	struct eco_request all = *request;
	all.vertices = ECO_VERTICES_MAX;
	extreme_draw(x, world, &all, &full);
	double differ = extreme_pixels_differ(&seen.picture, &full, false);
	unsigned long long covered = extreme_covered(&full);
	extreme_least(x, "pixels covered", (double)covered, 1001);
	extreme_most(x, "share of the picture that differs from full detail", differ, 0.2);
	extreme_say(x, "%s: %llu plants in view, %llu pixels covered, %.1f %% differ from full detail", name,
		(unsigned long long)seen.plan.visible_plants, covered, 100 * differ);
	eco_plan_free(&seen.plan);
	view_picture_free(&seen.picture);
	view_picture_free(&full);
}

/* From 3 cm away the moss is drawn in full, and the trees far behind it as they should; from afar the moss is
 * nothing, and harms nothing. */
static void unlike(struct extreme *x)
{
	struct extreme_stand stand = { .plant_count = 0 };
	struct extreme_world world = { 0 };
	struct eco_request near = extreme_request(20000), far = near;
	near.view.target[2] = 5e-4;
	memcpy(near.view.eye, (double[3]){ 0, -0.03, 0.002 }, sizeof near.view.eye);
	memcpy(far.view.eye, (double[3]){ 0, -300, 60 }, sizeof far.view.eye);
	make_unlike(x, &stand);
	extreme_world_open(x, &world, &stand, &(struct extreme_site){ 0 });
	look_unlike(x, &world, &near, "from 3 cm");
	look_unlike(x, &world, &far, "from 300 m");
	extreme_world_close(&world);
	extreme_stand_free(&stand);
}

#define SITE(title, slow, ...) { title, "same plan up to rounding; < 0.1 % of pixels differ from the " \
	"origin's; at 1500 and 20000 vertices and in full", at_site, \
	&(const struct extreme_site)__VA_ARGS__, slow }

const struct extreme_case extreme_place[] = {
	SITE("1 km away", false, { .at = { 1e3, -1e3, 0 } }),
	SITE("1000 km away", false, { .at = { 1e6, -1e6, 0 } }),
	SITE("10000 km away", false, { .at = { 1e7, -1e7, 100 } }),
	SITE("earth-centred coordinates", false, { .at = { 4178123.625, 853456.375, 4729876.5 } }),
	SITE("1000 km away without a transform", false, { .at = { 1e6, -1e6, 100 }, .plain = true }),
	SITE("10000 km away without a transform", false, { .at = { 1e7, -1e7, 0 }, .plain = true }),
	SITE("earth-centred without a transform", false,
		{ .at = { 4178123.625, 853456.375, 4729876.5 }, .plain = true }),
	SITE("turned by 90 degrees", false, { .turn = 16384 }),
	SITE("turned by 67.8 degrees", false, { .turn = 12345 }),
	SITE("scaled by 1e-6", false, { .scale = 1e-6 }), SITE("scaled by 1e-3", true, { .scale = 1e-3 }),
	SITE("scaled by 1e3", true, { .scale = 1e3 }),
	SITE("scaled by 1e6", false, { .scale = 1e6 }),
	SITE("10000 km away; turned; scaled by 1/4", false, { .at = { 1e7, -1e7, 100 }, .turn = 54321, .scale
	= 0.25 }), SITE("10000 km away; turned; scaled by 1e6", true, { .at = { 1e7, -1e7, 100 }, .turn = 777,
	.scale = 1e6 }),
	EXTREME_CASE("plants of 1 mm beside 100 m",
		"sound plans and pictures from 3 cm and from 300 m; < 20 % of pixels differ from full detail "
		"with 20000 vertices", unlike),
	{ .name = NULL } };
