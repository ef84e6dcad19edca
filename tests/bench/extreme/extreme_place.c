/* Place: where a scene stands, how it is turned and how large its metre is must change nothing but rounding.
 * Each scene is packed anew for its place, planned and drawn, and compared with the one at the origin. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/plan.h"
#include "tests/bench/extreme/extreme_cases.h"
#include "tests/bench/extreme/extreme_scene.h"

#define PIXELS_MOST 0.001        /* share that may differ */
#define VERTICES_MOST 0.01       /* a plant on a border between bands may change sides */

/* ---- One scene in two places ---- */

struct seen { struct eco_plan plan; struct view_picture picture; };

static void free_seen(struct seen *seen)
{
	eco_plan_free(&seen->plan);
	view_picture_free(&seen->picture);
}

static bool see(struct extreme *x, const struct extreme_world *world, const struct extreme_site *site,
	const struct eco_request *from, struct seen *seen)
{
	struct eco_request request = *from;
	request.view = extreme_site_view(site, &from->view);
	*seen = (struct seen){ 0 };
	return extreme_plan(x, extreme_tables(world), &request, &seen->plan)
		&& extreme_draw(x, world, &request, &seen->picture);
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
	double vertices = fabs((double)there->plan.vertices - (double)here->plan.vertices)
		/ (double)here->plan.vertices;
	uint32_t same = shared_cuts(&here->plan, &there->plan);
	extreme_must(x, here->plan.visible_plants == there->plan.visible_plants,
		"%llu plants in view, %llu at the origin", (unsigned long long)there->plan.visible_plants,
		(unsigned long long)here->plan.visible_plants);
	extreme_must(x, vertices <= VERTICES_MOST, "%llu vertices, %llu at the origin",
		(unsigned long long)there->plan.vertices, (unsigned long long)here->plan.vertices);
	extreme_must(x, pixels < PIXELS_MOST, "%.4f %% of pixels differ (%u of %u cuts are the same)",
		100 * pixels, same, here->plan.cut_count);
	extreme_say(x, "%u of %u cuts are the same, %.4f %% of pixels differ", same, here->plan.cut_count,
		100 * pixels);
}

void extreme_at_site(struct extreme *x)
{
	static const uint64_t budgets[] = { 1500, 20000, ECO_VERTICES_MAX };
	const struct extreme_site *site = x->made, origin = { 0 };
	const struct extreme_world *world = extreme_world(x);
	struct extreme_world moved = { 0 };
	bool good = world && extreme_world_open(x, &moved, extreme_stand(x), site);
	for (int i = 0; i < (x->quick ? 2 : 3) && good; i++) {
		struct eco_request request = extreme_request(budgets[i]);
		struct seen here = { 0 }, there = { 0 };
		good = see(x, world, &origin, &request, &here) && see(x, &moved, site, &request, &there);
		if (good)
			compare(x, &here, &there, !(site->scale > 0) && site->at[2] == 0 && !site->turn);
		free_seen(&here);
		free_seen(&there);
	}
	extreme_world_close(&moved);
}

/* ---- 1 mm beside 100 m ---- */

static void scaled_tree(struct soup *soup, float factor)
{
	soup_tree(soup, 3000, 0, false);
	for (uint32_t i = 0; i < 3 * soup->model.vertex_count; i++)
		soup->model.position[i] *= factor;
}

static enum eco_code make_unlike(struct extreme_stand *stand, struct eco_error *error)
{
	struct soup soup;
	scaled_tree(&soup, 100.0f / 6);
	enum eco_code code = extreme_stand_add(stand, &soup, "giant", error);
	scaled_tree(&soup, 100.0f / 6 * 1e-5f);
	code = code ? code : extreme_stand_add(stand, &soup, "moss", error);
	for (uint32_t i = 0; i < 12; i++)
		extreme_stand_place(stand,
			&(struct extreme_place){ .plant = i > 3,
			.at = { i < 4 ? 40 * (i + 1.0) - 90 : 1e-3 * i - 8e-3, i < 4 ? 60 : 0, 0 },
			.turn = (uint16_t)(5000 * i), .scale = 1 });
	return code;
}

static bool look_unlike(struct extreme *x, const struct extreme_world *world,
	const struct eco_request *request, const char *name)
{
	struct eco_plan plan = { 0 };
	struct view_picture picture = { 0 }, full = { 0 };
	struct eco_request all = *request;
	all.vertices = ECO_VERTICES_MAX;
	bool good = extreme_plan(x, extreme_tables(world), request, &plan)
		&& extreme_draw(x, world, request, &picture) && extreme_draw(x, world, &all, &full);
	if (good) {
		double differ = extreme_pixels_differ(&picture, &full, false);
		unsigned long long covered = extreme_covered(&full);
		extreme_must(x, covered > 1000 && differ < 0.2, "%s: %llu pixels covered, %.1f %% of the "
			"picture differ from full detail", name, covered, 100 * differ);
		extreme_say(x, "%s: %llu plants in view, %llu pixels covered, %.1f %% differ from full "
			"detail", name, (unsigned long long)plan.visible_plants, covered, 100 * differ);
	}
	eco_plan_free(&plan);
	view_picture_free(&picture);
	view_picture_free(&full);
	return good;
}

/* From 3 cm away the moss is drawn in full, and the trees far behind it as they should; from afar the moss is
 * nothing, and harms nothing. */
void extreme_unlike(struct extreme *x)
{
	struct extreme_stand stand = { .side = 200, .near_m = 1e-4 };
	struct extreme_world world = { 0 };
	struct eco_error error = { 0 };
	struct eco_request near = extreme_request(20000), far = near;
	near.view.target[2] = 5e-4;
	memcpy(near.view.eye, (double[3]){ 0, -0.03, 0.002 }, sizeof near.view.eye);
	memcpy(far.view.eye, (double[3]){ 0, -300, 60 }, sizeof far.view.eye);
	if (extreme_good(x, make_unlike(&stand, &error), &error)
			&& extreme_world_open(x, &world, &stand, &(struct extreme_site){ 0 })
			&& look_unlike(x, &world, &near, "from 3 cm"))
		look_unlike(x, &world, &far, "from 300 m");
	extreme_world_close(&world);
	extreme_stand_free(&stand);
}
