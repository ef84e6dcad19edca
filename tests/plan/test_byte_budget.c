/* Plans under two budgets, on random scenes: never above the bytes, most of them used, and what is held is
 * free. */
#include <math.h>
#include <stdlib.h>

#include "lod/plan/byte_price.h"
#include "tests/support/plan_size.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

#define SCENES 40
#define BUDGETS 6

static struct lod_planner_stats plan_it(struct eco_plan *plan, const struct eco_scene *scene,
	const struct eco_view *view, uint64_t vertices, uint64_t bytes, const struct eco_holdings *holdings)
{
	const struct eco_request request = { .view = *view, .vertices = vertices, .bytes = bytes };
	return plan_make(plan, (struct lod_planner_input){ .scene = scene, .request = &request,
		.holdings = holdings, .sent = true });
}

static uint64_t bytes_of(const struct eco_scene *scene, const struct eco_view *view, uint64_t vertices,
	uint64_t bytes, const struct eco_holdings *holdings, struct eco_prediction *prediction)
{
	struct eco_plan plan;
	struct lod_planner_stats stats = plan_it(&plan, scene, view, vertices, bytes, holdings);
	if (prediction)
		*prediction = plan.prediction;
	assert_true(plan.vertices <= vertices);
	eco_plan_free(&plan);
	return stats.bytes;
}

static void assert_same(const struct eco_plan *a, const struct eco_plan *b)
{
	assert_int_equal(a->vertices, b->vertices);
	assert_int_equal(a->cut_count, b->cut_count);
	for (uint32_t i = 0; i < a->cut_count; i++) {
		assert_int_equal(a->cuts[i].list, b->cuts[i].list);
		assert_int_equal(a->cuts[i].end, b->cuts[i].end);
		assert_true(a->cuts[i].scale == b->cuts[i].scale);
	}
}

/* All of the picture is expected to be wrong if nothing fits. */
static void check_nothing(const struct eco_scene *scene, const struct eco_view *view)
{
	struct eco_plan plan;
	plan_it(&plan, scene, view, 5000, 0, NULL);
	assert_true(plan.vertices == 0 && plan.m16 > 1);
	assert_true(plan.prediction.fn == (double)view->width * view->height);
	eco_plan_free(&plan);
}

/* A plan that is held needs no chunks. */
static void check_held(const struct eco_scene *scene, const struct eco_view *view)
{
	struct eco_plan plan, held;
	struct eco_holdings needs;
	plan_it(&plan, scene, view, 5000, ECO_BYTES_UNBOUNDED, NULL);
	assert_int_equal(lod_plan_needs(scene, &plan, &needs, NULL), ECO_OK);
	plan_it(&held, scene, view, 5000, plan_bytes(scene, &plan, &needs), &needs);
	assert_same(&plan, &held);
	free(needs.items);
	eco_plan_free(&plan);
	eco_plan_free(&held);
}

UNIT_TEST(never_above_the_bytes_most_of_them_used_and_more_predict_a_better_picture)
{
	double used = 0, asked = 0;
	uint32_t plans = 0, better = 0, worse = 0;
	for (uint64_t seed = 1; seed <= 2 * SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, seed % 2 ? 0 : 3, 1 + seed % 5);
		const struct eco_scene *scene = &pack->pack.scene;
		struct eco_view view = random_view(&pack->r);
		uint64_t vertices = UINT64_C(1) << (6 + random_below(&pack->r, 14));
		uint64_t all = bytes_of(scene, &view, vertices, ECO_BYTES_UNBOUNDED, NULL, NULL),
			least = bytes_of(scene, &view, vertices, 0, NULL, NULL);   /* nothing fits */
		double before = -INFINITY;
		assert_true(least <= all);
		for (int i = 1; i <= BUDGETS; i++) {
			struct eco_prediction p;
			uint64_t most = least + (all - least) * (uint64_t)i / BUDGETS,
				bytes = bytes_of(scene, &view, vertices, most, NULL, &p);
			double q = eco_predicted_q(&p), sixteenths = 0.25 / fmax(0.5, p.tp + fmin(p.fp, p.fn));
			assert_true(bytes <= most);
			used += (double)bytes;
			asked += (double)most;
			worse += q < before - sixteenths;
			better += q > before;
			before = q;
			plans++;
		}
		check_held(scene, &view);
		check_nothing(scene, &view);
		random_pack_free(pack);
	}
	print_message("used %.3f of the bytes; %u of %u plans predict a higher Q than one with fewer bytes, %u a lower one\n",
		used / asked, better, plans, worse);
	assert_true(used > 0.75 * asked);
	assert_true(better * 2 > plans && 16 * worse <= plans);
}

/* ---- Relaxations ---- */

#define RELAXATIONS 30

struct relaxed { struct lod_planner p; struct lod_allocation m; };

static void begin(struct relaxed *r, const struct lod_planner_input *input)
{
	assert_good(lod_planner_begin(&r->p, input, &cause));
	assert_good(lod_planner_open_level(&r->p, 12, &cause));
	assert_good(lod_allocation_make(&r->m, &r->p, &cause));
	assert_good(lod_prices_make(&r->m, NULL, 0, &cause));
}

static void end(struct relaxed *r)
{
	lod_allocation_free(&r->m);
	lod_planner_end(&r->p);
}

/* Nothing of the last relaxation is taken over by the next one. */
static void forget(struct lod_allocation *m)
{
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++)
		lod_allocation_unsettle(m, s);
	memset(m->uses.stale, true, m->p->visible.node_count);
	m->relaxed.lambda = NAN;
}

/* At the highest price nothing is drawn: however little work is left, a search goes on to one that uses bytes. */
static void find_price(struct relaxed *r, uint32_t *searched, uint32_t *some)
{
	double target = lod_price_relax(&r->m, 1e-9, -20, NULL) / 2, octave;
	if (target > 0) {
		double bytes = lod_price_find(&r->m, 1e-9, target, NAN, &octave);
		assert_true(bytes <= target);
		*some += bytes > 0.8 * target;
		*searched += 1;
	}
}

/* Kinds share bytes that a price leaves: within them less is wrong. Returns whether they do. */
static bool share_bytes(struct relaxed *r, double octave)
{
	struct lod_mix mix = { malloc((r->m.prices->ladder_count + 1) * sizeof *mix.limits),
		malloc(r->p.scene->plant_count + 1u), malloc(r->p.scene->plant_count + 1u), false };
	double bytes = lod_price_relax(&r->m, 1e-3, octave, NULL), target = 2 * bytes,
		worth = lod_price_wrong(&r->m) + 1e-3 * r->m.cost.vertices,
		now = lod_kinds_share(&r->m, 1e-3, target, octave, &mix);
	bool used = mix.used;
	assert_true(!used || now <= target);
	assert_true(!used || lod_price_wrong(&r->m) + 1e-3 * r->m.cost.vertices < worth);
	forget(&r->m);
	assert_true(lod_price_relax(&r->m, 1e-3, octave, &mix) == now);
	free(mix.limits);
	free(mix.off);
	free(mix.levels);
	return used;
}

/* The image is that of the price also where a few vertices were tried in vain, not the coarsest. */
UNIT_TEST(an_answer_without_plants_has_the_image_that_its_bytes_allow)
{
	uint32_t empty = 0, levels = 0;
	for (uint64_t seed = 1; seed <= 2 * SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, 0, 1 + seed % 5);
		const struct eco_scene *scene = &pack->pack.scene;
		const struct eco_view view = random_view(&pack->r);
		const uint64_t least = bytes_of(scene, &view, 1000000, 0, NULL, NULL);
		for (uint64_t part = 2; part <= 64; part *= 2) {
			struct eco_plan plan;
			plan_it(&plan, scene, &view, 1000000, least + 65536 / part, NULL);
			empty += !plan.vertices;
			for (uint32_t i = 0; !plan.vertices && i < plan.cut_count; i++)
				levels += scene->lists[plan.cuts[i].list].kind == ECO_LIST_GROUND_IMAGE ? plan.cuts[i].end : 0;
			eco_plan_free(&plan);
		}
		random_pack_free(pack);
	}
	print_message("%u levels in %u answers\n", levels, empty);
	assert_true(2 * levels > 17 * empty);
}

UNIT_TEST(a_lower_price_fits_where_bytes_rise_with_the_price)
{
	static const double tried[][2] = { { 0, 1000 }, { .05, 500 }, { .1, 2000 }, { .15, 400 } };
	struct random_pack *pack = random_pack_make(1, 0, 2);
	const struct eco_request request = { .view = random_view(&pack->r), .vertices = 10000 };
	const struct lod_planner_input input = { .scene = &pack->pack.scene, .request = &request };
	struct relaxed r;
	double octave;
	begin(&r, &input);
	for (size_t i = 0; i < sizeof tried / sizeof *tried; i++) {
		r.m.tries.at[i].lambda = 1e-9;
		r.m.tries.at[i].octave = tried[i][0];
		r.m.tries.at[i].bytes = tried[i][1];
	}
	r.m.tries.count = sizeof tried / sizeof *tried;
	lod_price_find(&r.m, 1e-9, 600, NAN, &octave);
	assert_true(octave == .05);
	lod_price_find(&r.m, 1e-9, 450, NAN, &octave);
	assert_true(octave == .15);
	end(&r);
	random_pack_free(pack);
}

UNIT_TEST(what_is_kept_from_one_relaxation_to_the_next_changes_none_and_a_price_is_found)
{
	uint32_t shared = 0, searched = 0, some = 0;
	uint64_t less = 0, looks = 0, work = 0, all = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, seed % 2 ? 0 : 3, 1 + seed % 5);
		const struct eco_request request = { .view = random_view(&pack->r), .vertices = 10000 };
		const struct lod_planner_input input = { .scene = &pack->pack.scene, .request = &request,
			.work_max = 1 };
		struct relaxed a, b;
		begin(&a, &input);
		begin(&b, &input);
		for (int i = 0; i < RELAXATIONS; i++) {
			double lambda = ldexp(1, -(int)random_below(&pack->r, 3) * 4),
				octave = -(double)random_below(&pack->r, 3) * 3;
			forget(&b.m);
			assert_true(lod_price_relax(&a.m, lambda, octave, NULL)
				== lod_price_relax(&b.m, lambda, octave, NULL));
			assert_true(a.m.cost.vertices == b.m.cost.vertices);
			assert_true(lod_price_wrong(&a.m) == lod_price_wrong(&b.m));
			assert_memory_equal(a.p.gates, b.p.gates,
				pack->pack.scene.plant_count * sizeof *a.p.gates);
			assert_memory_equal(a.m.uses.drawn, b.m.uses.drawn,
				a.p.visible.slot_count * sizeof *a.m.uses.drawn);
			assert_memory_equal(a.m.uses.seen, b.m.uses.seen,
				a.p.visible.slot_count * sizeof *a.m.uses.seen);
		}
		less += a.p.looks;
		looks += b.p.looks;
		work += a.p.work;
		all += b.p.work;
		find_price(&a, &searched, &some);
		for (int i = 0; i < 6; i++)
			shared += share_bytes(&a, 3 - 3 * i);
		end(&a);
		end(&b);
		random_pack_free(pack);
	}
	print_message("kinds share bytes in %u of %u\n", shared, 6 * SCENES);
	assert_true(shared > 0);
	print_message("%.2f of the looks at hulls, %.2f of the work\n", (double)less / (double)looks,
		(double)work / (double)all);
	assert_true(less < looks && work < all - all / 10);
	print_message("%u of %u use four fifths of the bytes\n", some, searched);
	assert_true(searched > 5 && some > searched / 3);
}

/* Four tiles of so many bushes each, 40 m wide, with summaries, as has the tile above them. */
#define BUSHES 150u
#define SUMMARY 512u

static void make_bushes(struct scene_builder *b)
{
	random_stand_make(b, &(struct random_stand){ .height_m = 4, .leaves = 300, .area = 30,
		.shares = { .01f, .1f, .5f, 1 }, .errors = { .6f, .4f, .2f, 0 } });
	scene_add_tile(b, (struct eco_tile){ .high = { 80, 80, 4 }, .instance_count = 4 * BUSHES,
		.area = 4 * 30.0 * BUSHES });
	for (int i = 0; i < 4; i++) {
		double x = i % 2 * 40, y = i / 2 * 40;
		random_crowd(b, (struct eco_tile){ .low = { x, y, 0 }, .high = { x + 40, y + 40, 4 },
			.instance_count = BUSHES, .area = 30.0 * BUSHES }, (const double[]){ x, y }, 40);
	}
	for (uint32_t tile = 0; tile < 5; tile++)
		b->tiles[tile].summary = scene_add_bare(b, &(struct scene_row){ .kind = ECO_LIST_POINTS,
			.attributes = ECO_ATTR_PLANT, .owner = tile, .other = ECO_NONE }, SUMMARY, SUMMARY);
}

/* Holdings of a client that has all summaries. The caller frees them. */
static struct eco_holdings summaries_of(const struct eco_scene *scene)
{
	struct eco_holdings held = { .items = calloc(scene->tile_count, sizeof *held.items),
		.count = scene->tile_count };
	for (uint32_t tile = 0; tile < scene->tile_count; tile++)
		held.items[tile] = (struct eco_holding){ scene->tiles[tile].summary,
			scene->lists[scene->tiles[tile].summary].chunk_count };
	return held;
}

static struct eco_view view_of_bushes(struct scene_builder *b, double farthest)
{
	const double away = random_real(b, 50, farthest), turn = random_real(b, 0, 6.28);
	return (struct eco_view){ .target = { 40, 40, 0 }, .eye = { 40 + away * cos(turn), 40 + away * sin(turn),
		0.4 * away }, .up = { 0, 0, 1 }, .fov_y_deg = 50, .width = 1920, .height = 1080 };
}

/* At the highest lambda of the grid plants of such a pack still gain: no tile and no gate may need them. */
UNIT_TEST(plants_of_the_greatest_importance_stay_within_the_vertices)
{
	uint64_t bytes = 0;
	struct scene_builder b = { 0 };
	make_bushes(&b);
	for (uint32_t i = 0; i < b.scene.ladder_count; i++)
		b.ladders[i].importance = 1e9f;
	for (int i = 0; i < 100; i++) {
		const struct eco_view view = view_of_bushes(&b, 350);
		bytes += bytes_of(&b.scene, &view, UINT64_C(1) << random_below(&b, 10), i % 2 ? ECO_BYTES_UNBOUNDED : 9000,
			NULL, NULL);
	}
	scene_free(&b);
	assert_true(bytes > 0);
}

/* Within half of the bytes of a plan a rule that knows none draws less of the ground's image and fewer vertices. */
UNIT_TEST(a_rule_that_knows_no_bytes_uses_most_of_them)
{
	double used = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, 1, 3);
		struct eco_request request = { .view = random_view(&pack->r), .vertices = 2000,
			.bytes = ECO_BYTES_UNBOUNDED };
		const struct lod_planner_input input = { .scene = &pack->pack.scene, .request = &request,
			.rule = lod_rule_deussen, .sent = true };
		struct eco_plan plan;
		request.bytes = plan_make(&plan, input).bytes / 2;
		eco_plan_free(&plan);
		const uint64_t bytes = plan_make(&plan, input).bytes;
		assert_true(bytes <= request.bytes && plan.vertices > 0);
		used += (double)bytes / (double)request.bytes;
		eco_plan_free(&plan);
		random_pack_free(pack);
	}
	print_message("%.3f of the bytes\n", used / SCENES);
	assert_true(used > 0.75 * SCENES);
}

/* Whether the choice of a tile with a summary draws a part of both. */
static bool draws_both(const struct lod_allocation *m, uint32_t n)
{
	const struct lod_tile_choice *choice = &m->tile_choices[n];
	return choice->open && choice->has_summary && choice->share > 0 && choice->share < 1;
}

/* Bytes of a summary and of what stands in its tile do not blend: where both are drawn both are paid, and must
 * be worth it. Nor are points of such a summary filled up, for which there are vertices enough where bytes
 * bind: they would cover once more what is covered already. */
UNIT_TEST(a_tile_draws_its_plants_or_its_summary_where_bytes_have_a_price)
{
	uint32_t open = 0, closed = 0, both = 0;
	struct scene_builder b = { 0 };
	make_bushes(&b);
	struct eco_holdings held = summaries_of(&b.scene);
	for (int i = 0; i < 400; i++) {
		double away = random_real(&b, 50, 150), turn = random_real(&b, 0, 6.28),
			octave = random_real(&b, -12, 4), lambda = ldexp(1, -(int)random_below(&b, 12));
		const struct eco_request request = { .vertices = 100000, .view = { .target = { 40, 40, 0 },
			.eye = { 40 + away * cos(turn), 40 + away * sin(turn), 0.4 * away }, .up = { 0, 0, 1 },
			.fov_y_deg = 50, .width = 640, .height = 480 } };
		struct relaxed r;
		bool holds = i % 2;
		begin(&r, &(struct lod_planner_input){ .scene = &b.scene, .request = &request,
			.holdings = holds ? &held : NULL });
		lod_price_relax(&r.m, lambda, octave, NULL);
		for (uint32_t n = 0; n < r.p.visible.node_count; n++) {
			const struct lod_tile_choice *choice = &r.m.tile_choices[n];
			const struct lod_cost *cost = &choice->cost;
			double plants, summary, paid = cost->alike + cost->open
				+ lambda * cost->vertices + r.m.price * cost->bytes;
			open += choice->share >= 1;
			closed += choice->share <= 0 && choice->points > 0;
			if (holds || !draws_both(&r.m, n) || !(choice->points > 0))
				continue;
			lod_allocation_compare(&r.m, n, &plants, &summary);
			assert_true(choice->weight_px - paid >= plants - 1e-6 * choice->weight_px);
		}
		lod_allocation_fix(&r.m);
		for (uint32_t n = 0; n < r.p.visible.node_count; n++)
			if (draws_both(&r.m, n)) {
				assert_int_equal(r.m.tile_choices[n].partial_hull.count, 1);
				both++;
			}
		end(&r);
	}
	free(held.items);
	scene_free(&b);
	print_message("%u tiles draw their plants, %u their summaries, %u both\n", open, closed, both);
	assert_true(open > 50 && closed > 50 && both > 5);
}

/* ---- Coarser answers ---- */

#define MOST 12

/* With coarser answers after it a plan is the same. They are within the vertices, and mostly of what it needs. */
static uint32_t check_coarser(const struct eco_scene *scene, const struct eco_request *request,
	const struct eco_plan *alone, uint64_t *sum, uint64_t *waste)
{
	struct eco_plan plans[MOST];
	struct lod_planner_coarser coarser = { 1.3, 500, MOST, plans, 0 };
	struct eco_plan answer;
	struct eco_holdings needs;
	plan_make(&answer, (struct lod_planner_input){ .scene = scene, .request = request,
		.coarser = &coarser, .sent = true });
	assert_same(&answer, alone);
	assert_int_equal(lod_plan_needs(scene, &answer, &needs, NULL), ECO_OK);
	for (uint32_t i = 0; i < coarser.count; i++) {
		assert_in_range(plans[i].vertices, 1, request->vertices);
		*sum += plan_bytes(scene, &plans[i], NULL);
		*waste += plan_bytes(scene, &plans[i], &needs);
		eco_plan_free(&plans[i]);
	}
	free(needs.items);
	eco_plan_free(&answer);
	return coarser.count;
}

/* Without a budget of bytes: the plan is one for which none count. */
UNIT_TEST(coarser_answers_need_few_chunks_that_the_answer_lacks)
{
	uint64_t sum = 0, waste = 0;
	uint32_t many = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, seed % 2 ? 0 : 3, 40 + seed % 5);
		const struct eco_scene *scene = &pack->pack.scene;
		for (int v = 0; v < 2; v++) {
			const struct eco_request request = { .view = random_view(&pack->r),
				.bytes = ECO_BYTES_UNBOUNDED,
				.vertices = UINT64_C(1) << (v ? 14 + random_below(&pack->r, 8)
				: 6 + random_below(&pack->r, 14)) };
			struct eco_plan plan;
			plan_make(&plan, (struct lod_planner_input){ .scene = scene, .request = &request });
			many += check_coarser(scene, &request, &plan, &sum, &waste) > 2;
			eco_plan_free(&plan);
		}
		random_pack_free(pack);
	}
	print_message("%u have more than 2 coarser answers; %.3f of their bytes the answer does not use\n",
		many, (double)waste / (double)sum);
	assert_true(many > SCENES / 4 && waste * 2 < sum);
}

/* ---- Organs that come at once ---- */

/* Levels of textures become most of the bytes. */
static void enlarge_textures(struct random_pack *pack)
{
	const struct eco_scene *scene = &pack->pack.scene;
	for (uint32_t i = 0; i < scene->list_count; i++) {
		const struct eco_list *list = &scene->lists[i];
		for (uint32_t k = 0; list->kind == ECO_LIST_IMAGE && k < list->chunk_count; k++)
			pack->r.chunks[list->chunk_first + k].size_bytes = 200u << (2 * k);
	}
}

/* Pixels left wrong, as a mean of logarithms: 8.694; 8.705 where kinds share none. */
UNIT_TEST(kinds_share_bytes_that_a_price_leaves)
{
	double wrong = 0;
	uint32_t rows = 0;
	for (uint64_t seed = 1; seed <= SCENES; seed++) {
		struct random_pack *pack = random_pack_make(seed, 0, 6 + seed % 5);
		const struct eco_scene *scene = &pack->pack.scene;
		struct eco_view view = random_view(&pack->r);
		enlarge_textures(pack);
		uint64_t all = bytes_of(scene, &view, 1000000, ECO_BYTES_UNBOUNDED, NULL, NULL);
		for (uint64_t part = 2; part <= 32; part++, rows++) {
			struct eco_plan plan;
			wrong += log(plan_it(&plan, scene, &view, 1000000, all / part, NULL).wrong + 1);
			eco_plan_free(&plan);
		}
		random_pack_free(pack);
	}
	print_message("          %u plans, %.4f\n", rows, wrong / rows);
	assert_true(wrong / rows < 8.7);
}
