/* Stiff budgets and curves: where one vertex more or less, or one plant among many, decides. At any budget
 * the search converges, within the budget; what is left over is less than any step; more budget never
 * predicts more error. Scenes are tables only: the planner looks at no payload. */
#include <math.h>

#include "tests/bench/extreme/extreme_scene.h"
#include "tests/support/scene_builder.h"

#define PLACE_M 6.0              /* between neighbours */
#define TILE_SIDE 32u            /* places */

/* ---- Scenes of tables ---- */

struct kind {                            /* of a species: one ladder */
	const struct eco_curve *curve;  uint32_t curve_count;
	/* points and triangles of so many leaves; 0: wood of ten lines and levels of a million vertices each */
	uint32_t leaves;
	float importance;
};

static uint32_t add_list(struct scene_builder *b, uint8_t kind, uint8_t coder, uint32_t owner, uint32_t other, uint32_t primitives)
{
	uint32_t elements = coder == ECO_CODER_ELEMENTS && kind == ECO_LIST_TRIANGLES ? primitives / 2 : primitives;
	return scene_add_bare(b, &(struct scene_row){ kind, coder, 0, owner, other, 0, 0 }, primitives, elements);
}

static void add_species(struct scene_builder *b, const struct kind *kind)
{
	uint32_t id = scene_add_plant(b, (struct eco_plant){ .height_m = 6, .area = 60 }), n = kind->leaves,
		none = ECO_NONE;
	struct eco_ladder l = scene_ladder(id, scene_add_anchor(b, (struct eco_anchor){ { 0, 0, 3 }, 3 }),
		n ? ECO_ORGAN_FOLIAGE : ECO_ORGAN_WOOD);
	l.importance = kind->importance;
	l.area = 60;
	l.length = 20;
	l.total = n ? n : 10;
	l.curve_first = b->scene.curve_count;
	l.curve_count = kind->curve_count;
	if (n) {
		l.triangles = add_list(b, ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, id, none, 2 * n);
		l.points = add_list(b, ECO_LIST_POINTS, ECO_CODER_FORM, id, l.triangles, n);
	} else {
		l.lines = add_list(b, ECO_LIST_LINES, ECO_CODER_ELEMENTS, id, none, 10);
		l.triangles = add_list(b, ECO_LIST_TRIANGLES, ECO_CODER_MESH, id, none, 1333334);
		l.level_count = 2;
		l.level_end[0] = 333334;
		l.level_end[1] = 1333334;
	}
	for (uint32_t i = 0; i < kind->curve_count; i++)
		scene_add_curve(b, kind->curve[i]);
	scene_add_ladder(b, l);
}

/* groups: species of a tile; each: plants of one of them */
struct stand { uint32_t species, tiles, groups, each; };

/* A square of places; species take turns. */
static void add_tile(struct scene_builder *b, uint32_t tile, uint32_t across, const struct stand *stand)
{
	double size = TILE_SIDE * PLACE_M, x = (tile - 1) % across * size, y = (tile - 1) / across * size;
	uint32_t spot = 0, count = stand->groups * stand->each;
	scene_add_tile(b,
		(struct eco_tile){ .low = { x - 3, y - 3, 0 }, .high = { x + size + 3, y + size + 3, 6 },
		.summary = ECO_NONE,
		.instance_count = count, .area = 60.0 * count });
	for (uint32_t g = 0; g < stand->groups; g++) {
		uint32_t plant = ((tile - 1) * stand->groups + g) % stand->species;
		uint32_t list = add_list(b, ECO_LIST_INSTANCES, ECO_CODER_ROWS, tile, ECO_NONE, stand->each);
		b->lists[list].grid_origin[0] = x;
		b->lists[list].grid_origin[1] = y;
		scene_add_group(b, (struct eco_group){ tile, plant, list, b->scene.place_count, 0, 0 });
		for (uint32_t i = 0; i < stand->each; i++, spot++)
			scene_add_place(b,
				(struct eco_place){ { (int32_t)(1000 * PLACE_M * (spot % TILE_SIDE)),
				(int32_t)(1000 * PLACE_M * (spot / TILE_SIDE % TILE_SIDE)), 0 }, 0, 65536, 0, 0 });
	}
	scene_add_child(b, 0, (struct eco_child){ .tile = tile, .scale = 1 });
	b->tiles[0].instance_count += count;
	b->tiles[0].area += 60.0 * count;
}

/* All species are among kinds[0 .. kind_count), in turn. The caller frees the scene. */
static void make_tables(struct scene_builder *b, const struct kind *kinds, uint32_t kind_count,
	struct stand stand)
{
	uint32_t across = (uint32_t)ceil(sqrt(stand.tiles));
	double size = across * TILE_SIDE * PLACE_M;
	*b = (struct scene_builder){ .scene.near_m = 0.1,
		.like = { .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f } };
	for (uint32_t i = 0; i < stand.species; i++)
		add_species(b, &kinds[i % kind_count]);
	scene_add_tile(b, (struct eco_tile){ .low = { -3, -3, 0 }, .high = { size + 3, size + 3, 6 },
		.summary = ECO_NONE });
	for (uint32_t i = 1; i <= stand.tiles; i++)
		add_tile(b, i, across, &stand);
}

/* All of the first tiles in view. */
static struct eco_request request_of(const struct scene_builder *t, uint64_t vertices)
{
	double size = t->tiles[0].high[0];
	return (struct eco_request){ .view = { .eye = { size / 2, -0.6 * size, 0.5 * size },
		.target = { size / 2, size / 2, 0 }, .up = { 0, 0, 1 },
		.fov_y_deg = 60, .width = 800, .height = 600 }, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED };
}

static const struct eco_curve flat[] = { SCENE_CURVE(0.002f, 1, 0.005f, 0.3f, 0.3f), SCENE_CURVE(0.1f, 1, 0.3f, 0.3f, 0.3f),
	SCENE_CURVE(1, 1, 1, 0.3f, 0.3f) };
static const struct eco_curve convex[] = { SCENE_CURVE(0.002f, 1, 0.005f, 0.4f, 0.599f),
	SCENE_CURVE(0.1f, 1, 0.3f, 0.4f, 0.59f), SCENE_CURVE(0.5f, 1, 0.9f, 0.4f, 0.5f),
	SCENE_CURVE(1, 1, 1, 0, 0) };
static const struct eco_curve rising[] = { SCENE_CURVE(0.002f, 1, 0.005f, 0, 0.1f), SCENE_CURVE(0.1f, 1, 0.3f, 0.2f, 0.5f),
	SCENE_CURVE(1, 1, 1, 0.5f, 0.9f) };
static const struct eco_curve point[] = { SCENE_CURVE(1, 1, 1, 0, 0) };
static const struct eco_curve early_point[] = { SCENE_CURVE(0.01f, 1, 0.02f, 0.1f, 0.2f) };
#define KIND(name, n, weight) { name, sizeof name / sizeof *name, n, weight }

/* ---- What must hold at any budget ---- */

#define ROUNDING 1e-3            /* of what is expected to be wrong */

struct sum { uint64_t vertices; double error; struct lod_planner_stats stats; };    /* error: pixels, by what is seen */

static struct sum plan_for(const struct scene_builder *t, uint64_t vertices, lod_rule *rule)
{
	struct eco_plan plan = { 0 };
	struct eco_request request = request_of(t, vertices);
	struct sum sum = { .vertices = 0 };
	assert_good(lod_plan(&plan, &(struct lod_planner_input){ .scene = &t->scene, .request = &request,
		.rule = rule, .stats = &sum.stats }, &cause));
	extreme_sound(&plan, &request);
	assert_true(sum.stats.converged);
	sum.vertices = plan.vertices;
	sum.error = sum.stats.wrong;
	eco_plan_free(&plan);
	return sum;
}

/* Returns the error, which must not be above that of a smaller budget. */
static double hold_at(const char *name, const struct scene_builder *t, uint64_t budget, double last)
{
	struct sum sum = plan_for(t, budget, lod_rule_optimal);
	must_hold(sum.error <= last * (1 + ROUNDING) && budget - sum.vertices < sum.stats.cheapest,
		"%s: budget %llu: %llu used, a step of %llu is left; error %g after %g", name, (unsigned long long)budget,
		(unsigned long long)sum.vertices, (unsigned long long)sum.stats.cheapest, sum.error, last);
	return sum.error;
}

static const uint64_t many[] = { 0, 1, 2, 3, 4, 5, 6, 7, 10, 100, 159, 160, 161, 1000, 4001, 33333, 77777,
	99999, 100000, 999999, 1000002, 1000003, 3000000, 4000002, 30000000, 1000000000 };
#define BUDGETS (sizeof many / sizeof *many)

#define TWICE(kind) { kind, KIND(scene_falling, 300, 1) }
static const struct kind usual[] = { KIND(scene_falling, 2000, 1), KIND(convex, 700, 1), KIND(scene_falling, 150, 3),
	KIND(flat, 40, 1) }, wood[] = TWICE(KIND(scene_falling, 0, 1)), large[] = { KIND(scene_falling, 4000, 1) },
	unlike[] = { KIND(scene_falling, 2000, 1e6f), KIND(scene_falling, 2000, 1e-3f), KIND(scene_falling, 2000, 1e-3f),
	KIND(convex, 900, 1e-3f) }, odd[][2] = { TWICE(KIND(flat, 500, 1)), TWICE(KIND(convex, 500, 1)),
	TWICE(KIND(rising, 500, 1)), TWICE(KIND(point, 500, 1)), TWICE(KIND(early_point, 500, 1)),
	TWICE(((struct kind){ point, 0, 500, 1 })), TWICE(KIND(scene_falling, 1, 1)), TWICE(KIND(scene_falling, 500, 0)) };

static const struct { const char *name; const struct kind *kinds; uint32_t count; struct stand stand; } scenes[] = {
	{ "usual", usual, 4, { 4, 2, 4, 40 } },
	{ "jumps of a million vertices", wood, 2, { 2, 1, 2, 20 } },
	{ "a species a plant, all alike", large, 1, { 1000, 4, 250, 1 } },
	{ "plants alike but for their hashes", large, 1, { 1, 10, 1, TILE_SIDE * TILE_SIDE } },
	{ "one plant worth a billion times the others", unlike, 4, { 4, 1, 4, 1 } } };

UNIT_TEST(budgets_are_used_and_more_never_predict_more_errors)
{
	for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
		struct scene_builder t;
		double last = INFINITY;
		make_tables(&t, scenes[i].kinds, scenes[i].count, scenes[i].stand);
		for (size_t b = 0; b < BUDGETS; b++)
			last = hold_at(scenes[i].name, &t, many[b], last);
		scene_free(&t);
	}
}

/* Flat, convex, rising, of one point or none, of one leaf, of no weight: alone, and beside a usual one. */
UNIT_TEST(odd_curves_are_planned)
{
	for (uint32_t i = 0; i < 2 * sizeof odd / sizeof *odd; i++) {
		struct scene_builder t;
		double last = INFINITY;
		char name[32];
		uint32_t kinds = 1 + i % 2;
		snprintf(name, sizeof name, "curve %u", i / 2);
		make_tables(&t, odd[i / 2], kinds, (struct stand){ kinds, 1, kinds, 30 });
		for (size_t b = 0; b < BUDGETS; b++)
			last = hold_at(name, &t, many[b], last);
		scene_free(&t);
	}
}

/* From one vertex to more than there is. */
UNIT_TEST(six_hundred_budgets_never_predict_more_errors)
{
	struct scene_builder t;
	double last = INFINITY;
	make_tables(&t, usual, 4, (struct stand){ 4, 2, 4, 40 });
	for (uint32_t i = 0; i < 600; i++)
		last = hold_at("sweep", &t, i < 150 ? i : (uint64_t)(150 * pow(3e6 / 150, (i - 150) / 450.0)), last);
	scene_free(&t);
}

/* V(d') is a staircase: where it steps, one vertex decides which sample distance fits. By Deussen's rule at most 2 % are left. */
UNIT_TEST(each_step_of_sample_distances_one_vertex_less_and_one_more)
{
	struct scene_builder t;
	make_tables(&t, usual, 4, (struct stand){ 4, 2, 4, 40 });
	for (uint32_t i = 0; i < 12; i++) {
		/* what the solved distance alone comes to is found by asking for no more than it */
		uint64_t v = plan_for(&t, (uint64_t)(20 * pow(1e5, (i + 0.5) / 12)), lod_rule_deussen).vertices;
		double last = INFINITY;
		for (uint64_t budget = v ? v - 1 : 0; budget <= v + 1; budget++)
			last = hold_at("a step", &t, budget, last);
		assert_true(plan_for(&t, v, lod_rule_deussen).vertices + v / 50 + 60 >= v);
	}
	scene_free(&t);
}

UNIT_TEST(all_there_is_fits_in_any_large_budget)
{
	static const uint64_t budgets[] = { UINT64_C(1) << 32, UINT64_C(1) << 53, (UINT64_C(1) << 53) + 1,
		(UINT64_C(1) << 63) - 2, (UINT64_C(1) << 63) - 1 };
	struct scene_builder t;
	uint64_t all = 0;
	make_tables(&t, usual, 4, (struct stand){ 4, 2, 4, 40 });
	for (uint32_t i = 0; i < t.scene.group_count; i++)
		all += 3 * (uint64_t)t.lists[t.ladders[t.groups[i].plant].triangles].primitive_count * t.groups[i].count;
	for (size_t i = 0; i < 2 * sizeof budgets / sizeof *budgets; i++)
		assert_int_equal(plan_for(&t, budgets[i / 2], i % 2 ? lod_rule_deussen : lod_rule_optimal).vertices, all);
	scene_free(&t);
}

/* The 12,000 vertices that complete the plant that weighs most are its own. */
UNIT_TEST(the_plant_that_weighs_most_is_completed_first)
{
	struct scene_builder t;
	struct eco_plan plan = { 0 };
	uint64_t best = 0;
	make_tables(&t, unlike, 4, (struct stand){ 4, 1, 4, 1 });
	struct eco_request request = request_of(&t, 12000);
	extreme_plan(&t.scene, &request, &plan);
	for (uint32_t i = 0; i < plan.cut_count; i++)
		if (plan.cuts[i].list == t.ladders[0].triangles && plan.cuts[i].anchor != ECO_NONE)
			best += 3 * (plan.cuts[i].end - plan.cuts[i].first);
	assert_int_equal(best, 12000);
	eco_plan_free(&plan);
	scene_free(&t);
}
