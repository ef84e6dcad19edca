/* Quantization: corners are integers. For each list it is stated from which distance on rounding them moves
 * nothing by more than half a pixel (lod/build/grid.h); here every corner of the source is looked up among
 * those that are stored, and how far it moved is projected. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/build/grid.h"
#include "tests/bench/extreme/extreme_scene.h"

/* ---- Stored corners ---- */

struct point { int32_t p[3]; };

static int compare(const void *a, const void *b) { return memcmp(a, b, sizeof(struct point)); }

static double on_grid(const struct eco_model *model, const struct eco_list *grid, uint32_t vertex, uint32_t k)
{
	return ((double)model->position[3 * vertex + k] - grid->grid_origin[k]) / grid->grid_step[k];
}

/* All corners of the plant's triangles, sorted. Their lists are on one grid: `grid` is one of them. */
static struct point *corners_of(const struct lod_plant *plant, const struct eco_list **grid, size_t *count,
	bool *one_grid)
{
	size_t all = 0;
	*grid = NULL;
	*one_grid = true;
	for (uint32_t i = 0; i < plant->list_count; i++)
		all += plant->lists[i].list.kind == ECO_LIST_TRIANGLES ? plant->lists[i].elements.corner_count
			: 0;
	struct point *points = malloc((all + 1) * sizeof *points);
	*count = 0;
	for (uint32_t i = 0; i < plant->list_count && points; i++) {
		const struct lod_list_draft *d = &plant->lists[i];
		if (d->list.kind != ECO_LIST_TRIANGLES)
			continue;
		*grid = *grid ? *grid : &d->list;
		*one_grid = *one_grid
			&& !memcmp((*grid)->grid_step, d->list.grid_step, sizeof d->list.grid_step)
			&& !memcmp((*grid)->grid_origin, d->list.grid_origin, sizeof d->list.grid_origin);
		memcpy(points + *count, d->elements.position, d->elements.corner_count * sizeof *points);
		*count += d->elements.corner_count;
	}
	if (points)
		qsort(points, *count, sizeof *points, compare);
	return points;
}

/* The greatest distance of the source's corners from where they are stored; those that are nowhere near are
 * counted. */
static double farthest(const struct eco_model *model, const struct eco_list *grid, const struct point *points,
	size_t count, uint32_t *lost)
{
	double most = 0;
	*lost = 0;
	for (uint32_t v = 0; v < model->vertex_count; v++) {
		double best = INFINITY;
		/* a corner that was welded to another is beside its own step at most */
		for (int near = 0; near < 27; near++) {
			struct point q;
			double square = 0;
			for (int k = 0, digit = near; k < 3; k++, digit /= 3) {
				double at = on_grid(model, grid, v, (uint32_t)k);
				q.p[k] = (int32_t)floor(at + 0.5) + digit % 3 - 1;
				square += (at - q.p[k]) * (at - q.p[k]) * grid->grid_step[k]
					* grid->grid_step[k];
			}
			if (square < best && bsearch(&q, points, count, sizeof q, compare))
				best = square;
		}
		if (best < INFINITY)
			most = fmax(most, best);
		else
			++*lost;
	}
	return sqrt(most);
}

/* ---- Lists ---- */

struct source { struct point at; uint32_t vertex; };     /* where a corner of the model is on the grid */

static struct source *sources_of(const struct eco_model *model, const struct eco_list *grid)
{
	struct source *sources = malloc((model->vertex_count + 1ul) * sizeof *sources);
	for (uint32_t v = 0; v < model->vertex_count && sources; v++) {
		sources[v].vertex = v;
		for (uint32_t k = 0; k < 3; k++)
			sources[v].at.p[k] = (int32_t)floor(on_grid(model, grid, v, k) + 0.5);
	}
	if (sources)
		qsort(sources, model->vertex_count, sizeof *sources, compare);
	return sources;
}

/* The greatest distance of a list's corners from the nearest corner of the model at the same place of the
 * grid. */
static double list_error(const struct lod_list_draft *d, const struct eco_model *model,
	const struct source *sources)
{
	double most = 0;
	for (uint32_t c = 0; c < d->elements.corner_count; c++) {
		const int32_t *p = d->elements.position + 3 * (size_t)c;
		const struct source *s = bsearch(p, sources, model->vertex_count, sizeof *sources, compare),
			*end = sources + model->vertex_count;
		double best = INFINITY;
		for (; s && s > sources && !compare(s - 1, p); s--)
			;
		for (; s && s < end && !compare(s, p); s++) {
			double square = 0;
			for (uint32_t k = 0; k < 3; k++) {
				double off = d->list.grid_origin[k] + d->list.grid_step[k] * p[k]
					- (double)model->position[3 * s->vertex + k];
				square += off * off;
			}
			best = fmin(best, square);
		}
		most = fmax(most, best);
	}
	return sqrt(most);
}

/* Each list of the model's own triangles, at the distance that is stated for it; returns how many there are.
 */
static uint32_t measure_lists(struct extreme *x, const struct lod_plant *plant, const struct eco_model *model,
	double px[2])
{
	uint32_t count = 0;
	struct source *sources = NULL;
	px[0] = INFINITY;
	px[1] = 0;
	for (uint32_t i = 0; i < plant->list_count; i++) {
		const struct lod_list_draft *d = &plant->lists[i];
		if (d->list.kind != ECO_LIST_TRIANGLES || d->list.coder == ECO_CODER_FORM)
			continue;
		sources = sources ? sources : sources_of(model, &d->list);
		double one = lod_grid_nearest_m(&d->list, LOD_GRID_PIXEL_RAD) * LOD_GRID_PIXEL_RAD,
			error = sources ? list_error(d, model, sources) / one : INFINITY;
		extreme_most(x, "pixels that a list is off at the stated distance", error, 0.5 * (1 + 1e-4));
		px[0] = fmin(px[0], error);
		px[1] = fmax(px[1], error);
		count++;
	}
	free(sources);
	return count;
}

/* ---- Plants ---- */

static void measure(struct extreme *x, struct soup *soup, const char *name, uint32_t bits, uint32_t lost_most)
{
	struct lod_plant plant = { 0 };
	struct eco_error error = { 0 };
	struct lod_plant_options options = { .name = name, .seed = 1, .order = LOD_ORDER_STOCHASTIC,
		.grid_bits = bits, .views = 2, .pixels = 64 };
	enum eco_code code = lod_plant_build(&plant, &soup->model, &options, &error);
	if (!code)
		code = lod_plant_measure(&plant, &soup->model, &options, &error);
	if (!extreme_good(x, code, &error)) {
		soup_free(soup);
		return;
	}
	const struct eco_list *grid;
	size_t count;
	bool one_grid;
	uint32_t lost = 0;
	struct point *points = corners_of(&plant, &grid, &count, &one_grid);
	if (extreme_must(x, points && grid, "%s: no triangles", name)) {
		double moved = farthest(&soup->model, grid, points, count, &lost),
			nearest = lod_grid_nearest_m(grid, LOD_GRID_PIXEL_RAD);
		/* welding moves a corner by another 1e-6 of the plant */
		double px = moved / (nearest * LOD_GRID_PIXEL_RAD),
			slack = 1e-6 * (double)plant.anchors[0].radius * 4 / (nearest * LOD_GRID_PIXEL_RAD);
		extreme_most(x, "pixels off at the stated distance", px, 0.5 + slack);
		extreme_most(x, "corners that are nowhere", lost, lost_most);
		extreme_must(x, one_grid, "%s: lists of one plant are on grids that differ", name);
		extreme_most(x, "stated distance", nearest, 2.5 * (double)plant.anchors[0].radius);
		double lists[2];
		uint32_t list_count = measure_lists(x, &plant, &soup->model, lists);
		extreme_say(x, "%s of %.3g m, %u cells: steps of %.2g m, %u lists of triangles at %.2g m: "
			"%.3f to %.3f px", name, (double)plant.plant.height_m, plant.plant.anchor_count - 1,
			grid->grid_step[0], list_count, nearest, lists[0], lists[1]);
	}
	free(points);
	soup_free(soup);
	lod_plant_free(&plant);
}

static double extent_of(const struct eco_model *model)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY },
		most = 0;
	for (uint32_t i = 0; i < 3 * model->vertex_count; i++) {
		low[i % 3] = fmin(low[i % 3], (double)model->position[i]);
		high[i % 3] = fmax(high[i % 3], (double)model->position[i]);
		most = fmax(most, high[i % 3] - low[i % 3]);
	}
	return most;
}

/* Scaled and shifted; `bits` 0: the grid is found; `lost`: share of corners that may be nowhere. Arrays end
 * with a tree without a name. */
struct tree { const char *name; double factor, shift_m; uint32_t leaves, quick_leaves, flowers, bits;
	double lost;
	bool cells; };

/* Plants larger than what LOD_GRID_NEAR_M leaves to the coarsest grid get more bits, so that half a pixel is
 * reached from there on. (A grid for each cell costs more bytes than the same steps for all:
 * lod/build/grid.c.) */
static void rounded(struct extreme *x)
{
	for (const struct tree *t = x->made; t->name; t++) {
		struct soup s;
		if (x->quick && !t->quick_leaves)
			continue;
		soup_tree(&s, x->quick ? t->quick_leaves : t->leaves, t->flowers, false);
		for (uint32_t i = 0; i < 3 * s.model.vertex_count; i++)
			s.model.position[i] =
				(float)(t->factor * (double)s.model.position[i]
				+ (i % 3 == 0 ? t->shift_m : 0));
		double bits =
			ceil(log2(extent_of(&s.model) * sqrt(3) / (LOD_GRID_NEAR_M * LOD_GRID_PIXEL_RAD)));
		extreme_must(x, !t->cells || lod_grid_bits_least(&s.model)
			== (uint32_t)fmax(LOD_GRID_BITS_MIN, bits), "%s: %u bits at least", t->name,
			lod_grid_bits_least(&s.model));
		measure(x, &s, t->name, t->bits, (uint32_t)(t->lost * s.model.vertex_count));
	}
}

/* Leaves stay as large as they are, the plant grows: the grid has to be finer, as much as the picture needs.
 */
static void large(struct extreme *x)
{
	struct soup s;
	soup_begin(&s);
	uint32_t leaf = soup_material(&s, 60, 150, 40, ECO_NONE, false),
		bark = soup_material(&s, 110, 80, 50, ECO_NONE, false);
	soup_tube(&s, bark, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 95 }, 1.5, 0.1, 12, 60);
	for (uint32_t i = 0; i < (x->quick ? 3000u : 40000u); i++)
		soup_leaf(&s, leaf,
			lod_v3_add((struct lod_v3){ 0, 0, 75 },
			lod_v3_scale(soup_direction(&s), 25 * sqrt(soup_random(&s, 0, 1)))), 0.06, 0.04);
	measure(x, &s, "a giant with small leaves", 0, 0);
}

/* Nearer than stated the error grows as the picture does, and nothing tears: what is drawn is full detail on
 * the same grid. */
static void nearer(struct extreme *x)
{
	const struct extreme_world *world = extreme_world(x);
	if (!world)
		return;
	double stated = lod_grid_nearest_m(&extreme_stand(x)->plants[0].lists[0].list, LOD_GRID_PIXEL_RAD);
	const double *tree = extreme_stand(x)->places[0].at;
	for (int k = 0; k < 4; k++) {
		double away = stated * ldexp(1, -2 * k);
		struct eco_request request =
			{ .view = extreme_view((double[3]){ tree[0] - away - 0.2, tree[1], 1 },
				(double[3]){ tree[0], tree[1], 1 }),
				.vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED };
		struct view_picture picture = { 0 };
		if (!extreme_draw(x, world, &request, &picture))
			break;
		double covered = (double)extreme_covered(&picture) / (320 * 240);
		view_picture_free(&picture);
		extreme_least(x, "share of the picture that the trunk covers", covered, 0.01);
		extreme_say(x, "%.2g m: up to %.1f px, %.0f %% covered", away, 0.5 * stated / away,
			100 * covered);
	}
}

/* ---- Cases ---- */

#define HALF "every corner of the source is stored, within half a pixel (1080 rows over 45 degrees) from " \
	"the stated distance on, which is at most " \
	"the plant's size"
#define TREES(...) rounded, (const struct tree[]){ __VA_ARGS__, { .name = NULL } }, false

const struct extreme_case extreme_quantization[] = {
	{ "plants of 6 mm to 108 m", HALF,
		TREES({ "moss", 1e-3, 0, 200, 200, 0, 0, 0, false },
		{ "herb", 0.03, 0, 200, 200, 0, 0, 0, false }, { "tree", 1, 0, 1500, 1500, 0, 0, 0, false },
		{ "giant", 18, 0, 3000, 3000, 0, 0, 0, false }) },
	{ "plants of 30 m to 600 m, with cells",
		HALF "; and is at most 20 m: all lists on one lattice, seams of cells closed",
		TREES({ "30 m", 5, 0, 9000, 2500, 0, 0, 0, true },
		{ "60 m", 10, 0, 9000, 2500, 0, 0, 0, true },
		{ "120 m", 20, 0, 9000, 2500, 0, 0, 0, true },
		{ "600 m", 100, 0, 9000, 2500, 0, 0, 0, true }) },
	EXTREME_CASE("a large plant with small leaves",
		HALF "; all its cells on one grid, so that seams stay closed", large),
	{ "grids of 12 to 18 bits", HALF,
		TREES({ "12 bits", 1, 0, 400, 400, 20, 12, 0, false },
		{ "13 bits", 1, 0, 400, 0, 20, 13, 0, false }, { "14 bits", 1, 0, 400, 0, 20, 14, 0, false },
		{ "15 bits", 1, 0, 400, 400, 20, 15, 0, false },
		{ "16 bits", 1, 0, 400, 0, 20, 16, 0, false },
		{ "17 bits", 1, 0, 400, 0, 20, 17, 0, false },
		{ "18 bits", 1, 0, 400, 400, 20, 18, 0, false }) },
	{ "a model far from its own origin",
		HALF "; floats hold no more there: corners that meet in the source may",
		TREES({ "1 km from its own origin", 1, 1000, 400, 400, 0, 0, 0.02, false }) },
	EXTREME_CASE("nearer than stated", "error grows as 1 / distance; drawn in full, without holes",
		nearer),
	{ .name = NULL } };
_Static_assert(LOD_GRID_BITS_MIN == 12 && LOD_GRID_BITS_MAX == 18, "the table names every grid");
