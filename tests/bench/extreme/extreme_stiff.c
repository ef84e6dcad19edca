/* Stiff budgets and curves: where one vertex more or less, or one plant among a million, decides. Scenes are
 * tables only: the planner looks at no payload. */
#include <math.h>

#include "tests/bench/extreme/extreme_scene.h"
#include "tests/support/scene_builder.h"

#define PLACE_M 6.0              /* between neighbours */
#define TILE_SIDE 32u            /* places */

/* ---- Scenes of tables ---- */

struct kind {                            /* of a species: one ladder */
	const struct eco_curve *curve;  uint32_t curve_count;
	/* points and triangles of so many leaves; 0: wood of ten lines and levels of a million vertices each
	 * */
	uint32_t leaves;
	float importance;
};

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
		l.triangles =
			scene_add_bare(b, &(struct scene_row){ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, id,
			none, 0, 0 }, 2 * n, n);
		l.points =
			scene_add_bare(b,
			&(struct scene_row){ ECO_LIST_POINTS, ECO_CODER_FORM, 0, id, l.triangles, 0, 0 }, n,
			n);
	} else {
		l.lines =
			scene_add_bare(b,
			&(struct scene_row){ ECO_LIST_LINES, ECO_CODER_ELEMENTS, 0, id, none, 0, 0 }, 10, 10);
		l.triangles =
			scene_add_bare(b,
			&(struct scene_row){ ECO_LIST_TRIANGLES, ECO_CODER_MESH, 0, id, none, 0, 0 }, 1333334,
			1333334);
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
		uint32_t list =
			scene_add_bare(b,
			&(struct scene_row){ ECO_LIST_INSTANCES, ECO_CODER_ROWS, 0, tile, ECO_NONE, 0, 0 },
			stand->each, stand->each);
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

static void make_usual(struct scene_builder *t)
{
	static const struct kind kinds[] = { KIND(scene_falling, 2000, 1), KIND(convex, 700, 1),
		KIND(scene_falling, 150, 3), KIND(flat, 40, 1) };
	make_tables(t, kinds, 4, (struct stand){ 4, 2, 4, 40 });
}

/* ---- Budgets ---- */

#define ROUNDING 1e-3            /* of what is expected to be wrong */

struct sum { uint64_t vertices; double error; struct lod_planner_stats stats; };    /* error: pixels, by what is seen */

static struct sum plan_for(struct extreme *x, const struct scene_builder *t, uint64_t vertices, lod_rule *rule)
{
	struct eco_plan plan = { 0 };
	struct eco_request request = request_of(t, vertices);
	struct sum sum = { .vertices = 0 };
	struct lod_planner_input input = { .scene = &t->scene, .request = &request, .rule = rule,
		.stats = &sum.stats };
	extreme_good(x, lod_plan(&plan, &input, &x->error));
	extreme_sound(x, &plan, &request);
	extreme_must(x, sum.stats.converged, "budget %llu: the search did not converge",
		(unsigned long long)vertices);
	sum.vertices = plan.vertices;
	sum.error = sum.stats.wrong;
	eco_plan_free(&plan);
	return sum;
}

static void tiny(struct extreme *x)
{
	static const uint64_t budgets[] = { 0, 1, 2, 3, 4, 5, 6, 7, 159, 160, 161 };
	struct scene_builder t;
	double last = INFINITY;
	make_usual(&t);
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
		struct sum sum = plan_for(x, &t, budgets[i], lod_rule_optimal);
		extreme_must(x, budgets[i] - sum.vertices < sum.stats.cheapest, "%llu of %llu vertices used",
			(unsigned long long)sum.vertices, (unsigned long long)budgets[i]);
		extreme_most(x, "expected error", sum.error, last * (1 + ROUNDING));
		plan_for(x, &t, budgets[i], lod_rule_deussen);
		last = sum.error;
	}
	extreme_say(x, "0, 1, 2, 3 ... 161 vertices: no step that fits is left");
	scene_free(&t);
}

/* One vertex less, as many, and one more; returns the share that is left over of as many. */
static double around_step(struct extreme *x, const struct scene_builder *t, uint64_t v, bool deussen)
{
	struct sum sums[3];
	for (uint64_t d = 0; d < 3; d++) {
		sums[d] = plan_for(x, t, v + d - 1, deussen ? lod_rule_deussen : lod_rule_optimal);
		if (d > 0 && !deussen)
			extreme_most(x, "error of a vertex more", sums[d].error, sums[d - 1].error * (1 + ROUNDING));
	}
	extreme_must(x, deussen ? sums[1].vertices + v / 50 + 60 >= v
		: v - sums[1].vertices < sums[1].stats.cheapest, "%llu of %llu vertices used by %s rule",
		(unsigned long long)sums[1].vertices, (unsigned long long)v, deussen ? "Deussen's" : "our");
	return (double)(v - sums[1].vertices) / (double)v;
}

/* V(d') is a staircase: where it steps, one vertex decides which sample distance fits. */
static void steps(struct extreme *x)
{
	struct scene_builder t;
	uint32_t count = 0, most = x->quick ? 12 : 4000;
	uint64_t last = 0;
	double worst = 0;
	make_usual(&t);
	for (uint32_t i = 0; i < most; i++) {
		struct eco_request request = request_of(&t, (uint64_t)(20 * pow(1e5, (i + 0.5) / most)));
		struct lod_planner_input input = { .scene = &t.scene, .request = &request,
			.rule = lod_rule_deussen };
		struct eco_plan plan = { 0 };
		extreme_good(x, lod_plan(&plan, &input, &x->error));
		/* what the solved distance alone comes to is found by asking for no more than it */
		uint64_t v = plan.vertices;
		eco_plan_free(&plan);
		if (v == last || v < 1)
			continue;
		last = v;
		count++;
		around_step(x, &t, v, false);
		worst = fmax(worst, around_step(x, &t, v, true));
	}
	extreme_say(x, "%u steps by both rules; ours leaves less than any step, Deussen's %.2f %% at most",
		count, 100 * worst);
	scene_free(&t);
}

static void unbounded(struct extreme *x)
{
	static const uint64_t budgets[] = { UINT64_C(1) << 32, UINT64_C(1) << 53, (UINT64_C(1) << 53) + 1,
		(UINT64_C(1) << 63) - 2, (UINT64_C(1) << 63) - 1 };
	struct scene_builder t;
	uint64_t all = 0;
	make_usual(&t);
	for (uint32_t i = 0; i < t.scene.group_count; i++)
		all += 3 * (uint64_t)t.lists[t.ladders[t.groups[i].plant].triangles].primitive_count
			* t.groups[i].count;
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++)
		for (int rule = 0; rule < 2; rule++)
			extreme_same(x, "vertices", plan_for(x, &t, budgets[i], rule ? lod_rule_deussen
				: lod_rule_optimal).vertices, all);
	extreme_say(x, "2^32 to 2^63-1: all %llu vertices are drawn, by both rules", (unsigned long long)all);
	scene_free(&t);
}

/* ---- What must hold at any budget ---- */

/* what the budget before leaves wrong; vertices left over at most */
struct hold { double last; uint64_t unused; };

static void hold_at(struct extreme *x, const struct scene_builder *t, uint64_t budget, struct hold *h)
{
	struct sum sum = plan_for(x, t, budget, lod_rule_optimal);
	extreme_most(x, "expected error, with more budget", sum.error, h->last * (1 + ROUNDING));
	extreme_must(x, budget - sum.vertices < sum.stats.cheapest,
		"budget %llu: %llu used though a step of %llu is left", (unsigned long long)budget,
		(unsigned long long)sum.vertices, (unsigned long long)sum.stats.cheapest);
	if (sum.stats.cheapest != UINT64_MAX && budget - sum.vertices > h->unused)
		h->unused = budget - sum.vertices;
	h->last = sum.error;
}

/* At 0 and budgets that end with 0; of a scene that is made for it and freed by the caller. Returns how many
 * vertices are left over at most. */
static unsigned long long hold(struct extreme *x, struct scene_builder *t, const struct kind *kinds,
	uint32_t kind_count, struct stand stand, const uint64_t *budgets)
{
	struct hold h = { .last = INFINITY };
	make_tables(t, kinds, kind_count, stand);
	hold_at(x, t, 0, &h);
	for (; *budgets; budgets++)
		hold_at(x, t, *budgets, &h);
	return h.unused;
}

static const uint64_t many[] = { 1, 10, 100, 1000, 4001, 33333, 99999, 100000, 999999, 1000002, 1000003,
	3000000, 4000002, 30000000, 1000000000, 0 };

/* From one vertex to more than there is. */
static void sweep(struct extreme *x)
{
	struct scene_builder t;
	struct hold h = { .last = INFINITY };
	uint32_t count = x->quick ? 600 : 100000, rises = 0;
	double first = 0;
	make_usual(&t);
	for (uint32_t i = 0; i < count; i++) {
		double last = h.last;
		uint64_t budget = i < count / 4 ? i
			: (uint64_t)(count / 4 * pow(3e6 / (count / 4.0),
			(i - count / 4.0) / (count - count / 4.0)));
		hold_at(x, &t, budget, &h);
		rises += h.last > last * (1 + ROUNDING);
		first = i ? first : h.last;
	}
	extreme_say(x, "%u budgets up to 3e6, expected error falls from %.0f to %.0f pixels and rises %u "
		"times", count, first, h.last, rises);
	scene_free(&t);
}

static void jumps(struct extreme *x)
{
	static const struct kind kinds[] = { KIND(scene_falling, 0, 1), KIND(scene_falling, 300, 1) };
	struct scene_builder t;
	unsigned long long unused = hold(x, &t, kinds, 2, (struct stand){ 2, 1, 2, 20 }, many);
	extreme_say(x, "wood of 20, 1000002 or 4000002 vertices a plant: at most %llu vertices left "
		"over, less than any step", unused);
	scene_free(&t);
}

static void identical(struct extreme *x)
{
	static const struct kind one[] = { KIND(scene_falling, 4000, 1) };
	struct scene_builder t;
	/* a species a plant: nothing is shared, everything ties */
	uint32_t species = x->quick ? 1000 : 105000;
	unsigned long long unused = hold(x, &t, one, 1, (struct stand){ species, species / 250, 250, 1 },
		(const uint64_t[]){ 1000, 77777, 10000000, 0 });
	extreme_say(x, "%u species alike: %llu candidates, %llu vertices left over at most", species,
		(unsigned long long)plan_for(x, &t, 1000000, lod_rule_optimal).stats.candidates, unused);
	scene_free(&t);
	/* one species: they differ by their hashes alone */
	struct stand alike = { 1, x->quick ? 10 : 1000, 1, TILE_SIDE * TILE_SIDE };
	unused = hold(x, &t, one, 1, alike, (const uint64_t[]){ 1000, 77777, 5000000, 0 });
	extreme_say(x, "%u plants alike: %llu vertices left over at most", alike.tiles * alike.each, unused);
	scene_free(&t);
}

static void one_better(struct extreme *x)
{
	static const struct kind kinds[] = { KIND(scene_falling, 2000, 1e6f), KIND(scene_falling, 2000,
		1e-3f), KIND(scene_falling, 2000, 1e-3f), KIND(convex, 900, 1e-3f) };
	struct scene_builder t;
	struct eco_plan plan = { 0 };
	uint64_t best = 0;
	hold(x, &t, kinds, 4, (struct stand){ 4, 1, 4, 1 }, many);
	struct eco_request request = request_of(&t, 12000);
	extreme_plan(x, &t.scene, &request, &plan);
	for (uint32_t i = 0; i < plan.cut_count; i++)
		if (plan.cuts[i].list == t.ladders[0].triangles && plan.cuts[i].anchor != ECO_NONE)
			best += 3 * (plan.cuts[i].end - plan.cuts[i].first);
	extreme_same(x, "vertices of the best", best, 12000);
	extreme_say(x, "one weighs 1e9 times the others: the 12000 vertices that complete it are "
		"its own; what is left over is below any step");
	eco_plan_free(&plan);
	scene_free(&t);
}

static void odd_curves(struct extreme *x)
{
	static const struct { const char *name; struct kind kind; } rows[] = {
		{ "flat", KIND(flat, 500, 1) }, { "convex", KIND(convex, 500, 1) },
			{ "rising", KIND(rising, 500, 1) },
		{ "one point at the end", KIND(point, 500, 1) },
		{ "one point at 1 %", KIND(early_point, 500, 1) }, { "none", { point, 0, 500, 1 } },
		{ "one leaf", KIND(scene_falling, 1, 1) }, { "of no weight", KIND(scene_falling, 500, 0) } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		const struct kind mixed[2] = { rows[i].kind, KIND(scene_falling, 300, 1) };
		for (uint32_t kinds = 1; kinds <= 2; kinds++) {
			struct scene_builder t;
			hold(x, &t, mixed, kinds, (struct stand){ kinds, 1, kinds, 30 }, many);
			scene_free(&t);
		}
		extreme_say(x, "%s", rows[i].name);
	}
}

/* ---- Cases ---- */

#define HOLD "the search converges; within the budget; what is left over is less than any step; more " \
	"budget never predicts more error"

const struct extreme_case extreme_stiff[] = {
	EXTREME_CASE("budgets 0, 1, 2, 3 ...",
		"what is left over is less than any step; more never predicts more error", tiny),
	EXTREME_CASE("each step of V(d'), one less and one more",
		"within the budget, error does not rise, what is left over is less than any step; by Deussen's "
		"rule at most 2 %", steps),
	EXTREME_CASE("budgets to 2^63-1", "all there is, exactly", unbounded),
	EXTREME_CASE("1e5 budgets, swept", HOLD, sweep),
	EXTREME_CASE("jumps of 1e6 vertices", HOLD, jumps),
	EXTREME_CASE("1e6 identical candidates", HOLD "; also for 1e6 plants of one kind", identical),
	EXTREME_CASE("one candidate 1e9 times better", HOLD "; the best is completed first", one_better),
	EXTREME_CASE("flat, convex, rising and single-point curves", HOLD, odd_curves),
	{ .name = NULL } };
