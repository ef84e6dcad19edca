/* Quantization: corners are integers. For each list it is stated from which distance on rounding them moves
 * nothing by more than half a pixel (lod/build/grid.h); here every stored corner is looked up among those of the
 * source, and how far these moved is projected. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/build/grid.h"
#include "tests/bench/extreme/extreme_scene.h"

/* ---- Stored corners ---- */

struct point { int32_t p[3]; };

static int compare(const void *a, const void *b) { return memcmp(a, b, sizeof(struct point)); }

/* A corner of the model: where it is on the grid of the lists, and the square of its distance from where the
 * nearest corner of them is stored. */
struct source { struct point at; uint32_t vertex; double square; };

static struct source *sources_of(const struct eco_model *model, const struct eco_list *grid)
{
	struct source *sources = eco_alloc(model->vertex_count, sizeof *sources);
	for (uint32_t v = 0; v < model->vertex_count; v++) {
		sources[v] = (struct source){ .vertex = v, .square = INFINITY };
		for (uint32_t k = 0; k < 3; k++)
			sources[v].at.p[k] = (int32_t)floor(((double)model->position[3 * v + k]
				- grid->grid_origin[k]) / grid->grid_step[k] + 0.5);
	}
	qsort(sources, model->vertex_count, sizeof *sources, compare);
	return sources;
}

/* Notes a stored corner at all sources around it: one that was welded to another is beside its own step at
 * most. Returns the square of its distance from the nearest of those that are on its own place of the grid. */
static double note_corner(const struct eco_list *list, const int32_t *p, const struct eco_model *model,
	struct source *sources)
{
	double own = INFINITY;
	for (int near = 0; near < 27; near++) {
		struct point q = { { p[0] + near % 3 - 1, p[1] + near / 3 % 3 - 1, p[2] + near / 9 - 1 } };
		struct source *s = bsearch(&q, sources, model->vertex_count, sizeof *s, compare),
			*end = sources + model->vertex_count;
		for (; s && s > sources && !compare(s - 1, &q); s--)
			;
		for (; s && s < end && !compare(s, &q); s++) {
			double square = 0;
			for (uint32_t k = 0; k < 3; k++) {
				double off = list->grid_origin[k] + list->grid_step[k] * p[k]
					- (double)model->position[3 * s->vertex + k];
				square += off * off;
			}
			s->square = fmin(s->square, square);
			own = near == 13 ? fmin(own, square) : own;
		}
	}
	return own;
}

/* ---- Plants ---- */

/* All lists of triangles are on one grid. Each list of the model's own triangles is measured at the distance
 * that is stated for it: px[0] the least and px[1] the greatest of them, in pixels. Returns the grid. */
static const struct eco_list *measure_lists(struct extreme *x, const struct lod_plant *plant,
	const struct eco_model *model, struct source **sources, double px[2], uint32_t *count)
{
	const struct eco_list *grid = NULL;
	px[0] = INFINITY;
	px[1] = 0;
	for (uint32_t i = 0; i < plant->list_count; i++) {
		const struct lod_list_draft *d = &plant->lists[i];
		double most = 0, one = lod_grid_nearest_m(&d->list, LOD_GRID_PIXEL_RAD) * LOD_GRID_PIXEL_RAD;
		if (d->list.kind != ECO_LIST_TRIANGLES)
			continue;
		grid = grid ? grid : &d->list;
		*sources = *sources ? *sources : sources_of(model, grid);
		extreme_must(x, !memcmp(grid->grid_step, d->list.grid_step, sizeof grid->grid_step)
			&& !memcmp(grid->grid_origin, d->list.grid_origin, sizeof grid->grid_origin),
			"%s: lists of one plant are on grids that differ", plant->plant.name);
		for (size_t c = 0; c < d->elements.corner_count; c++)
			most = fmax(most, note_corner(&d->list, d->elements.position + 3 * c, model, *sources));
		if (d->list.coder == ECO_CODER_FORM)
			continue;
		extreme_most(x, "pixels that a list is off at the stated distance", sqrt(most) / one,
			0.5 * (1 + 1e-4));
		px[0] = fmin(px[0], sqrt(most) / one);
		px[1] = fmax(px[1], sqrt(most) / one);
		++*count;
	}
	return grid;
}

static void measure_plant(struct extreme *x, const struct lod_plant *plant, const struct eco_model *model,
	uint32_t lost_most)
{
	struct source *sources = NULL;
	double lists[2], moved = 0;
	uint32_t list_count = 0, lost = 0;
	const struct eco_list *grid = measure_lists(x, plant, model, &sources, lists, &list_count);
	extreme_must(x, grid != NULL, "%s: no triangles", plant->plant.name);
	for (uint32_t v = 0; v < model->vertex_count; v++) {
		lost += isinf(sources[v].square) != 0;
		moved = isinf(sources[v].square) ? moved : fmax(moved, sqrt(sources[v].square));
	}
	free(sources);
	/* welding moves a corner by another 1e-6 of the plant */
	double radius = (double)plant->anchors[0].radius,
		nearest = lod_grid_nearest_m(grid, LOD_GRID_PIXEL_RAD), one = nearest * LOD_GRID_PIXEL_RAD;
	extreme_most(x, "pixels off at the stated distance", moved / one, 0.5 + 4e-6 * radius / one);
	extreme_most(x, "corners that are nowhere", lost, lost_most);
	extreme_most(x, "stated distance", nearest, 2.5 * radius);
	extreme_say(x, "%s of %.3g m, %u cells: steps of %.2g m, %u lists of triangles at %.2g m: %.3f to %.3f px",
		plant->plant.name, (double)plant->plant.height_m, plant->plant.anchor_count - 1,
		grid->grid_step[0], list_count, nearest, lists[0], lists[1]);
}

static void measure(struct extreme *x, struct soup *soup, const char *name, uint32_t bits, uint32_t lost_most)
{
	struct lod_plant plant = { 0 };
	struct lod_plant_options options = { .name = name, .seed = 1, .order = LOD_ORDER_STOCHASTIC,
		.grid_bits = bits, .views = 2, .pixels = 64 };
	extreme_good(x, lod_plant_build(&plant, &soup->model, &options, &x->error));
	extreme_good(x, lod_plant_measure(&plant, &soup->model, &options, &x->error));
	measure_plant(x, &plant, &soup->model, lost_most);
	lod_plant_free(&plant);
	soup_free(soup);
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
	double stated = lod_grid_nearest_m(&extreme_stand(x)->plants[0].lists[0].list, LOD_GRID_PIXEL_RAD);
	const double *tree = extreme_stand(x)->places[0].at;
	for (int k = 0; k < 4; k++) {
		double away = stated * ldexp(1, -2 * k);
		struct eco_request request =
			{ .view = extreme_view((double[3]){ tree[0] - away - 0.2, tree[1], 1 },
				(double[3]){ tree[0], tree[1], 1 }),
				.vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED };
		struct view_picture picture = { 0 };
		extreme_draw(x, world, &request, &picture);
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
