/* Stiff budgets and curves: where one vertex more or less, or one plant among a million, decides. Scenes are tables only: the planner looks at
 * no payload. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/query.h"
#include "tests/bench/bench_extreme_scene.h"

#define PLACE_M 6.0              /* between neighbours */
#define TILE_SIDE 32u            /* places */

/* ---- Scenes of tables ---- */

struct kind {                            /* of a species: one ladder */
	const struct eco_curve *curve;  uint32_t curve_count;
	uint32_t leaves;                     /* points and triangles of so many leaves; 0: wood of ten lines and levels of a million vertices each */
	float importance;
};

struct tables {
	struct eco_scene scene;
	struct eco_plant *plants;
	struct eco_anchor *anchors;
	struct eco_ladder *ladders;
	struct eco_curve *curves;
	struct eco_tile *tiles;
	struct eco_group *groups;
	struct eco_child *children;
	struct eco_list *lists;
	struct eco_chunk *chunks;
	uint8_t *places;
};

static void tables_free(struct tables *t)
{
	void *all[] = { t->plants, t->anchors, t->ladders, t->curves, t->tiles, t->groups, t->children, t->lists, t->chunks, t->places };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
	memset(t, 0, sizeof *t);
}

static uint32_t add_list(struct tables *t, uint8_t kind, uint8_t coder, uint32_t owner, uint32_t primitives, uint32_t elements)
{
	struct eco_list *list = &t->lists[t->scene.list_count];
	*list = (struct eco_list){ .kind = kind, .coder = coder, .owner = owner, .plant = ECO_NONE, .image = ECO_NONE, .partner = ECO_NONE,
		.grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f, .primitive_count = primitives, .element_count = elements,
		.chunk_first = t->scene.chunk_count, .chunk_count = 1 };
	t->chunks[t->scene.chunk_count++] = (struct eco_chunk){ .primitive_count = primitives, .element_count = elements, .size_bytes = 8 * elements };
	return t->scene.list_count++;
}

static void add_species(struct tables *t, const struct kind *kind)
{
	struct eco_scene *s = &t->scene;
	uint32_t id = s->plant_count++;
	struct eco_plant *p = &t->plants[id];
	struct eco_ladder *l = &t->ladders[s->ladder_count++];
	*p = (struct eco_plant){ .height_m = 6, .area = 60, .anchor_first = s->anchor_count, .anchor_count = 1, .ladder_first = id, .ladder_count = 1 };
	t->anchors[s->anchor_count++] = (struct eco_anchor){ { 0, 0, 3 }, 3 };
	*l = (struct eco_ladder){ .plant = id, .anchor = id, .organ = ECO_ORGAN_FOLIAGE, .points = ECO_NONE, .lines = ECO_NONE, .simple = ECO_NONE,
		.importance = kind->importance, .area = 60, .length = 20, .total = kind->leaves ? kind->leaves : 10, .curve_first = s->curve_count,
		.curve_count = kind->curve_count };
	if (kind->leaves) {
		l->triangles = add_list(t, ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, id, 2 * kind->leaves, kind->leaves);
		l->points = add_list(t, ECO_LIST_POINTS, ECO_CODER_FORM, id, kind->leaves, kind->leaves);
		t->lists[l->points].partner = l->triangles;
	} else {
		l->organ = ECO_ORGAN_WOOD;
		l->lines = add_list(t, ECO_LIST_LINES, ECO_CODER_ELEMENTS, id, 10, 10);
		l->triangles = add_list(t, ECO_LIST_TRIANGLES, ECO_CODER_MESH, id, 1333334, 1333334);
		l->level_count = 2;
		l->level_end[0] = 333334;
		l->level_end[1] = 1333334;
	}
	memcpy(t->curves + s->curve_count, kind->curve, kind->curve_count * sizeof *kind->curve);
	s->curve_count += kind->curve_count;
}

static void put_u32(uint8_t *at, uint32_t v)
{
	for (int b = 0; b < 4; b++)
		at[b] = (uint8_t)(v >> (8 * b));
}

/* A square of places; species take turns. */
static void add_tile(struct tables *t, uint32_t tile, uint32_t across, uint32_t species, uint32_t each)
{
	struct eco_scene *s = &t->scene;
	double size = TILE_SIDE * PLACE_M, x = (tile - 1) % across * size, y = (tile - 1) / across * size;
	uint32_t first = s->plant_count > 1 ? (tile - 1) * species % s->plant_count : 0, spot = 0;
	struct eco_tile *at = &t->tiles[tile];
	*at = (struct eco_tile){ .low = { x - 3, y - 3, 0 }, .high = { x + size + 3, y + size + 3, 6 }, .summary = ECO_NONE, .group_first = s->group_count,
		.group_count = species };
	for (uint32_t g = 0; g < species; g++) {
		uint32_t plant = (first + g) % s->plant_count, list = add_list(t, ECO_LIST_INSTANCES, ECO_CODER_ROWS, tile, each, each);
		t->lists[list].plant = plant;
		t->lists[list].grid_origin[0] = x;
		t->lists[list].grid_origin[1] = y;
		t->groups[s->group_count++] = (struct eco_group){ tile, plant, list, s->place_count };
		for (uint32_t i = 0; i < each; i++, spot++) {
			uint8_t *place = t->places + ECO_PLACE_BYTES * s->place_count++;
			put_u32(place, (uint32_t)(1000 * PLACE_M * (spot % TILE_SIDE)));
			put_u32(place + 4, (uint32_t)(1000 * PLACE_M * (spot / TILE_SIDE % TILE_SIDE)));
			put_u32(place + 16, 65536);
		}
	}
	at->instance_count = (uint64_t)species * each;
	at->area = 60.0 * (double)at->instance_count;
	t->children[s->child_count++] = (struct eco_child){ .tile = tile, .scale = 1 };
}

/* `tiles` tiles of `species` species each, `each` plants of each; all species are among kinds[0 .. kind_count), in turn. */
static bool make_tables(struct extreme *x, struct tables *t, const struct kind *kinds, uint32_t kind_count, uint32_t all, uint32_t tiles,
	uint32_t species, uint32_t each)
{
	uint32_t curve_count = 0, across = (uint32_t)ceil(sqrt(tiles)), lists = 2 * all + tiles * species;
	for (uint32_t i = 0; i < all; i++)
		curve_count += kinds[i % kind_count].curve_count;
	*t = (struct tables){ .plants = calloc(all, sizeof *t->plants), .anchors = calloc(all, sizeof *t->anchors), .ladders = calloc(all, sizeof *t->ladders),
		.curves = calloc(curve_count + 1, sizeof *t->curves), .tiles = calloc(tiles + 1, sizeof *t->tiles),
		.groups = calloc((size_t)tiles * species, sizeof *t->groups),
		.children = calloc(tiles, sizeof *t->children), .lists = calloc(lists, sizeof *t->lists), .chunks = calloc(lists, sizeof *t->chunks),
		.places = calloc((size_t)tiles * species * each, ECO_PLACE_BYTES) };
	if (!extreme_must(x, t->plants && t->anchors && t->ladders && t->curves && t->tiles && t->groups && t->children && t->lists && t->chunks
		&& t->places, "no memory")) {
		tables_free(t);
		return false;
	}
	for (uint32_t i = 0; i < all; i++)
		add_species(t, &kinds[i % kind_count]);
	double size = across * TILE_SIDE * PLACE_M;
	t->tiles[0] = (struct eco_tile){ .low = { -3, -3, 0 }, .high = { size + 3, size + 3, 6 }, .summary = ECO_NONE, .child_count = tiles };
	for (uint32_t i = 1; i <= tiles; i++) {
		add_tile(t, i, across, species, each);
		t->tiles[0].instance_count += t->tiles[i].instance_count;
		t->tiles[0].area += t->tiles[i].area;
	}
	struct eco_scene *s = &t->scene;
	s->near_m = 0.1;
	s->tile_count = tiles + 1;
	s->plants = t->plants;
	s->anchors = t->anchors;
	s->ladders = t->ladders;
	s->curves = t->curves;
	s->tiles = t->tiles;
	s->groups = t->groups;
	s->children = t->children;
	s->lists = t->lists;
	s->chunks = t->chunks;
	s->places = t->places;
	return true;
}

/* All of the first tiles in view. */
static struct eco_request request_of(const struct tables *t, uint64_t vertices)
{
	double size = t->tiles[0].high[0];
	return (struct eco_request){ .view = { .eye = { size / 2, -0.6 * size, 0.5 * size }, .target = { size / 2, size / 2, 0 }, .up = { 0, 0, 1 },
		.fov_y_deg = 60, .width = 800, .height = 600 }, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
}

static const struct eco_curve falling[] = { { 0.002f, 1, 0.005f, 0.45f, 0.6f }, { 0.02f, 1, 0.05f, 0.3f, 0.4f }, { 0.1f, 1, 0.3f, 0.2f, 0.2f },
	{ 0.3f, 1, 0.8f, 0.08f, 0.09f }, { 1, 1, 1, 0, 0 } };
static const struct eco_curve flat[] = { { 0.002f, 1, 0.005f, 0.3f, 0.3f }, { 0.1f, 1, 0.3f, 0.3f, 0.3f }, { 1, 1, 1, 0.3f, 0.3f } };
static const struct eco_curve convex[] = { { 0.002f, 1, 0.005f, 0.4f, 0.599f }, { 0.1f, 1, 0.3f, 0.4f, 0.59f }, { 0.5f, 1, 0.9f, 0.4f, 0.5f },
	{ 1, 1, 1, 0, 0 } };
static const struct eco_curve rising[] = { { 0.002f, 1, 0.005f, 0, 0.1f }, { 0.1f, 1, 0.3f, 0.2f, 0.5f }, { 1, 1, 1, 0.5f, 0.9f } };
static const struct eco_curve point[] = { { 1, 1, 1, 0, 0 } };
static const struct eco_curve early_point[] = { { 0.01f, 1, 0.02f, 0.1f, 0.2f } };
#define KIND(name, n, weight) { name, sizeof name / sizeof *name, n, weight }

static bool make_usual(struct extreme *x, struct tables *t)
{
	static const struct kind kinds[] = { KIND(falling, 2000, 1), KIND(convex, 700, 1), KIND(falling, 150, 3), KIND(flat, 40, 1) };
	return make_tables(x, t, kinds, 4, 4, 2, 4, 40);
}

/* ---- Budgets ---- */

struct sum { uint64_t vertices; double wrong; struct lod_planner_stats stats; };

static bool plan_for(struct extreme *x, const struct eco_scene *scene, struct eco_request request, uint64_t vertices, lod_rule *rule,
	struct sum *sum)
{
	struct eco_plan plan = { 0 };
	struct eco_error error = { 0 };
	request.vertices = vertices;
	struct lod_planner_input input = { .scene = scene, .request = &request, .rule = rule, .stats = &sum->stats };
	bool good = extreme_good(x, lod_plan(&plan, &input, &error), &error) && extreme_plan_sound(x, &plan, &request)
		&& extreme_must(x, sum->stats.converged, "budget %llu: the search did not converge", (unsigned long long)vertices);
	sum->vertices = plan.vertices;
	sum->wrong = plan.prediction.fp + plan.prediction.fn;
	eco_plan_free(&plan);
	return good;
}

static void tiny(struct extreme *x)
{
	static const uint64_t budgets[] = { 0, 1, 2, 3, 4, 5, 6, 7, 159, 160, 161 };
	struct tables t;
	struct sum sum, last = { .wrong = INFINITY };
	bool good = make_usual(x, &t);
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets && good; i++) {
		good = plan_for(x, &t.scene, request_of(&t, 0), budgets[i], lod_rule_optimal, &sum)
			&& extreme_must(x, sum.vertices == budgets[i], "%llu of %llu vertices used", (unsigned long long)sum.vertices,
			(unsigned long long)budgets[i])
			&& extreme_must(x, sum.wrong <= last.wrong, "%llu vertices predict more error", (unsigned long long)budgets[i])
			&& plan_for(x, &t.scene, request_of(&t, 0), budgets[i], lod_rule_deussen, &last);
		last = sum;
	}
	extreme_say(x, "0, 1, 2, 3 ... 161 vertices: all of them used, by points one by one");
	tables_free(&t);
}

/* V(d') is a staircase: where it steps, one vertex decides which sample distance fits. */
static void steps(struct extreme *x)
{
	struct tables t;
	struct eco_plan plan = { 0 };
	uint32_t count = 0, most = x->quick ? 12 : 4000;
	uint64_t last = 0;
	double worst = 0;
	bool good = make_usual(x, &t);
	for (uint32_t i = 0; i < most && good; i++) {
		struct eco_request request = request_of(&t, (uint64_t)(20 * pow(1e5, (i + 0.5) / most)));
		struct lod_planner_input input = { .scene = &t.scene, .request = &request, .rule = lod_rule_deussen };
		struct eco_error error = { 0 };
		good = extreme_good(x, lod_plan(&plan, &input, &error), &error);
		/* what the solved distance alone comes to is found by asking for no more than it */
		uint64_t v = plan.vertices;
		eco_plan_free(&plan);
		if (!good || v == last || v < 1)
			continue;
		last = v;
		count++;
		for (int rule = 0; rule < 2 && good; rule++) {
			struct sum sums[3];
			for (int d = 0; d < 3 && good; d++)
				good = plan_for(x, &t.scene, request, v + (uint64_t)d - 1, rule ? lod_rule_deussen : lod_rule_optimal, &sums[d]);
			good = good && (rule || extreme_must(x, sums[0].wrong >= sums[1].wrong && sums[1].wrong >= sums[2].wrong,
				"around %llu vertices error rises",
				(unsigned long long)v)) && extreme_must(x, rule ? sums[1].vertices + v / 50 + 60 >= v : v - sums[1].vertices < sums[1].stats.cheapest,
				"%llu of %llu vertices used by %s rule", (unsigned long long)sums[1].vertices, (unsigned long long)v, rule ? "Deussen's" : "our");
			worst = rule && good ? fmax(worst, (double)(v - sums[1].vertices) / (double)v) : worst;
		}
	}
	extreme_say(x, "%u steps by both rules; ours leaves less than any step, Deussen's %.2f %% at most", count, 100 * worst);
	tables_free(&t);
}

static void unbounded(struct extreme *x)
{
	static const uint64_t budgets[] = { UINT64_C(1) << 32, UINT64_C(1) << 53, (UINT64_C(1) << 53) + 1, (UINT64_C(1) << 63) - 2,
		(UINT64_C(1) << 63) - 1 };
	struct tables t;
	bool good = make_usual(x, &t);
	uint64_t all = 0;
	for (uint32_t i = 0; good && i < t.scene.group_count; i++)
		all += 3 * (uint64_t)t.lists[t.ladders[t.groups[i].plant].triangles].primitive_count * t.lists[t.groups[i].list].primitive_count;
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets && good; i++)
		for (int rule = 0; rule < 2 && good; rule++) {
			struct sum sum;
			good = plan_for(x, &t.scene, request_of(&t, 0), budgets[i], rule ? lod_rule_deussen : lod_rule_optimal, &sum)
				&& extreme_must(x, sum.vertices == all, "%llu of all %llu vertices", (unsigned long long)sum.vertices, (unsigned long long)all);
		}
	extreme_say(x, "2^32 to 2^63-1: all %llu vertices are drawn, by both rules", (unsigned long long)all);
	tables_free(&t);
}

static void impossible(struct extreme *x)
{
	static const char *const bad[] = { "vertices=nan", "vertices=-1", "vertices=-0", "vertices=9223372036854775808", "vertices=18446744073709551616",
		"vertices=1e5",
		"vertices=inf", "vertices=+1", "vertices=0x10", "vertices=1.5", "vertices=99999999999999999999999999", "vertices=1&eye=nan,0,0",
			"vertices=1&fov_y_deg=nan",
		"vertices=1&fov_y_deg=0", "vertices=1&fov_y_deg=180", "vertices=1&fov_y_deg=-45", "vertices=1&fov_y_deg=1e-999", "vertices=1&eye=1e999,0,0",
		"vertices=1&eye=1e13,0,0", "vertices=1&ground_px=nan", "vertices=1&ground_px=-1", "vertices=1&bytes=-1", "vertices=1&width=0",
			"vertices=1&width=16385", "vertices=1&eye=4,5,6" };
	static const char *const fine[] = { "vertices=0", "vertices=1", "vertices=9223372036854775807", "vertices=1&fov_y_deg=1e-9",
		"vertices=1&eye=-1e12,1e12,1e12" };
	uint32_t refused = 0, taken = 0;
	for (size_t i = 0; i < sizeof bad / sizeof *bad + sizeof fine / sizeof *fine; i++) {
		bool is_bad = i < sizeof bad / sizeof *bad;
		const char *text = is_bad ? bad[i] : fine[i - sizeof bad / sizeof *bad];
		char raw[400];
		struct srv_target target;
		struct srv_query query;
		struct eco_error error = { 0 };
		snprintf(raw, sizeof raw, "/v1/scenes/a/plan?%s%s%s&target=4,5,6%s", text, strstr(text, "eye=") ? "" : "&eye=1,2,3",
			strstr(text, "width=") ? "" : "&width=800", "&height=600");
		enum eco_code code = srv_target_parse(&target, raw, strlen(raw), &error);
		if (!code)
			code = srv_query_parse(&query, &target, &error);
		extreme_must(x, is_bad == (code == ECO_BAD_INPUT) && (is_bad || code == ECO_OK), "%s: status %d", text, code);
		extreme_must(x, !is_bad || strlen(error.text) > 10, "%s: refused without a reason", text);
		refused += is_bad && code == ECO_BAD_INPUT;
		taken += !is_bad && code == ECO_OK;
	}
	extreme_say(x, "%u refused with a reason; %u accepted", refused, taken);
}

/* From one vertex to more than there is: never more than asked for, never more error than with less. */
static void sweep(struct extreme *x)
{
	struct tables t;
	uint32_t count = x->quick ? 600 : 100000, rises = 0;
	double last = INFINITY, first = 0;
	bool good = make_usual(x, &t);
	for (uint32_t i = 0; i < count && good; i++) {
		struct sum sum;
		uint64_t budget = i < count / 4 ? i : (uint64_t)(count / 4 * pow(3e6 / (count / 4.0), (i - count / 4.0) / (count - count / 4.0)));
		good = plan_for(x, &t.scene, request_of(&t, 0), budget, lod_rule_optimal, &sum)
			&& extreme_must(x, sum.wrong <= last, "budget %llu: %.12g wrong pixels are predicted, with less %.12g", (unsigned long long)budget,
			sum.wrong, last)
			&& extreme_must(x, budget - sum.vertices < sum.stats.cheapest, "budget %llu: %llu used though a step of %llu is left",
				(unsigned long long)budget, (unsigned long long)sum.vertices, (unsigned long long)sum.stats.cheapest);
		rises += sum.wrong > last;
		first = i ? first : sum.wrong;
		last = sum.wrong;
	}
	extreme_say(x, "%u budgets up to 3e6, predicted wrong pixels fall from %.0f to %.0f and rise %u times", count, first, last, rises);
	tables_free(&t);
}

/* ---- Curves ---- */

/* What must hold at any budget, for whatever scene. */
static bool hold_at(struct extreme *x, const struct tables *t, const uint64_t *budgets, size_t count, uint64_t *unused)
{
	double last = INFINITY;
	for (size_t i = 0; i < count; i++) {
		struct sum sum;
		if (!plan_for(x, &t->scene, request_of(t, 0), budgets[i], lod_rule_optimal, &sum))
			return false;
		if (!extreme_must(x, sum.wrong <= last, "budget %llu: more predicted error than with less", (unsigned long long)budgets[i]))
			return false;
		if (!extreme_must(x, budgets[i] - sum.vertices < sum.stats.cheapest, "budget %llu: %llu used though a step of %llu is left",
				(unsigned long long)budgets[i], (unsigned long long)sum.vertices, (unsigned long long)sum.stats.cheapest))
			return false;
		if (sum.stats.cheapest != UINT64_MAX)
			*unused = budgets[i] - sum.vertices > *unused ? budgets[i] - sum.vertices : *unused;
		last = sum.wrong;
	}
	return true;
}

static const uint64_t many[] = { 0, 1, 10, 100, 1000, 4001, 33333, 99999, 100000, 999999, 1000002, 1000003, 3000000, 4000002, 30000000, 1000000000 };
#define MANY (sizeof many / sizeof *many)

static void jumps(struct extreme *x)
{
	static const struct kind kinds[] = { KIND(falling, 0, 1), KIND(falling, 300, 1) };
	struct tables t;
	uint64_t unused = 0;
	if (make_tables(x, &t, kinds, 2, 2, 1, 2, 20) && hold_at(x, &t, many, MANY, &unused))
		extreme_say(x, "wood of 20, 1000002 or 4000002 vertices a plant: at most %llu vertices left over, less than any step",
			(unsigned long long)unused);
	tables_free(&t);
}

static void identical(struct extreme *x)
{
	static const struct kind one[] = { KIND(falling, 4000, 1) };
	struct tables t;
	uint64_t unused = 0;
	struct sum sum = { 0 };
	/* a species a plant: nothing is shared, everything ties */
	uint32_t species = x->quick ? 1000 : 105000;
	if (make_tables(x, &t, one, 1, species, species / 250, 250, 1) && hold_at(x, &t, (const uint64_t[]){ 1000, 77777, 10000000 }, 3, &unused)
			&& plan_for(x, &t.scene, request_of(&t, 0), 1000000, lod_rule_optimal, &sum))
		extreme_say(x, "%u species alike: %llu candidates, %llu vertices left over at most", species, (unsigned long long)sum.stats.candidates,
			(unsigned long long)unused);
	tables_free(&t);
	/* one species: they differ by their hashes alone */
	uint32_t tiles = x->quick ? 10 : 1000;
	unused = 0;
	if (make_tables(x, &t, one, 1, 1, tiles, 1, TILE_SIDE * TILE_SIDE) && hold_at(x, &t, (const uint64_t[]){ 1000, 77777, 5000000 }, 3, &unused))
		extreme_say(x, "%u plants alike: %llu vertices left over at most", tiles * TILE_SIDE * TILE_SIDE, (unsigned long long)unused);
	tables_free(&t);
}

static void one_better(struct extreme *x)
{
	static const struct kind kinds[] = { KIND(falling, 2000, 1e6f), KIND(falling, 2000, 1e-3f), KIND(falling, 2000, 1e-3f),
		KIND(convex, 900, 1e-3f) };
	struct tables t;
	uint64_t unused = 0;
	if (make_tables(x, &t, kinds, 4, 4, 1, 4, 1) && hold_at(x, &t, many, MANY, &unused)) {
		struct eco_request request = request_of(&t, 12000);
		struct eco_plan plan;
		uint64_t best = 0;
		if (extreme_plan_of(x, &t.scene, &request, &plan)) {
			for (uint32_t i = 0; i < plan.cut_count; i++)
				if (plan.cuts[i].list == t.ladders[0].triangles && plan.cuts[i].anchor != ECO_NONE)
					best += 3 * (plan.cuts[i].end - plan.cuts[i].first);
			eco_plan_free(&plan);
			extreme_must(x, best == 12000, "of 12000 vertices the best gets %llu triangles' worth", (unsigned long long)best);
			extreme_say(x, "one weighs 1e9 times the others: the 12000 vertices that complete it are its own; what is left over is below any step");
		}
	}
	tables_free(&t);
}

static void odd_curves(struct extreme *x)
{
	static const struct { const char *name; struct kind kind; } rows[] = {
		{ "flat", KIND(flat, 500, 1) }, { "convex", KIND(convex, 500, 1) }, { "rising", KIND(rising, 500, 1) },
		{ "one point at the end", KIND(point, 500, 1) },
		{ "one point at 1 %", KIND(early_point, 500, 1) }, { "none", { point, 0, 500, 1 } }, { "one leaf", KIND(falling, 1, 1) },
		{ "of no weight", KIND(falling, 500, 0) } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct kind mixed[2] = { rows[i].kind, KIND(falling, 300, 1) };
		for (uint32_t kinds = 1; kinds <= 2; kinds++) {
			struct tables t;
			uint64_t unused = 0;
			bool good = make_tables(x, &t, mixed, kinds, kinds, 1, kinds, 30);
			good = good && hold_at(x, &t, many, MANY, &unused);
			tables_free(&t);
			if (!good)
				return;
		}
		extreme_say(x, "%s", rows[i].name);
	}
}

#define HOLD "the search converges; within the budget; what is left over is less than any step; more budget never predicts more error"

static const struct extreme_case cases[] = {
	{ "budgets 0, 1, 2, 3 ...", "every vertex is used where points cost one; more never predicts more error", false, tiny },
	{ "each step of V(d'), one less and one more", "within the budget, error does not rise, what is left over is less than any step; by Deussen's "
		"rule at most 2 %", false, steps },
	{ "budgets to 2^63-1", "all there is, exactly", false, unbounded },
	{ "budgets and views that are no numbers", "refused with a reason before anything is computed", false, impossible },
	{ "1e5 budgets, swept", HOLD, false, sweep },
	{ "jumps of 1e6 vertices", HOLD, false, jumps },
	{ "1e6 identical candidates", HOLD "; also for 1e6 plants of one kind", false, identical },
	{ "one candidate 1e9 times better", HOLD "; the best is completed first", false, one_better },
	{ "flat, convex, rising and single-point curves", HOLD, false, odd_curves },
};

const struct extreme_family extreme_stiff = { "stiff", cases, sizeof cases / sizeof *cases };
