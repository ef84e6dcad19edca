#include "ecofiles/import/land/scatter.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/blue_noise.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/import/land/scatter_parts.h"

#define HECTARE_M2 10000.0
#define LATTICE_CELLS 64u
#define SPARE 1.2                    /* times the places wanted that the set has; up to four times more */
#define SIDE_EXPONENT_MIN -10        /* side of the set's square: a millimetre to a thousand kilometres */
#define SIDE_EXPONENT_MAX 20
#define TRIES 3                      /* sets, each four times as dense, tried if places are short */
/* of the mean spacing: least distance of a later set's places to others */
#define SPREAD 0.5
#define NEAREST_M 0.001

struct lattice {                     /* the set, by cells of its square */
	uint16_t point[ECO_BLUE_NOISE_POINTS][2];
	uint32_t cell_first[LATTICE_CELLS * LATTICE_CELLS + 1], member[ECO_BLUE_NOISE_POINTS];
};

struct candidate { uint32_t rank, tie; double at[2]; };

struct candidates { struct candidate *items; uint32_t count, capacity; };

struct near_grid { uint32_t *head, *next; uint32_t mask; double cell_m; };

struct eco_scatter {
	const struct eco_scatter_spec *spec;
	struct eco_scatter_input input;
	struct lattice *lattice;
	struct candidates candidates;
	struct near_grid grid;
	struct eco_scatter_place *places; uint64_t count, capacity, at;
	uint64_t wanted, short_areas;
	double hectares;
	bool (*progress)(void *ctx, double share);
	void *ctx;
	struct eco_error *error;
};

static enum eco_code too_many(struct eco_scatter *s)
{
	return eco_fail(s->error, ECO_TOO_LARGE, "%.200s: more than %u plants; take lower densities, split "
		"it, or nest eco files", s->spec->path, ECO_SCATTER_PLANTS_MAX);
}

/* ---- The set, repeated over the plane ---- */

void eco_blue_noise(uint16_t points[ECO_BLUE_NOISE_POINTS][2])
{
	_Static_assert(sizeof blue_noise_rows / sizeof *blue_noise_rows == ECO_BLUE_NOISE_POINTS, "a row for each point");
	for (uint32_t i = 0; i < ECO_BLUE_NOISE_POINTS; i++) {
		points[i][0] = (uint16_t)blue_noise_rows[i].x;
		points[i][1] = (uint16_t)blue_noise_rows[i].y;
	}
}

static struct lattice *make_lattice(void)
{
	struct lattice *l = eco_alloc(1, sizeof *l);
	eco_blue_noise(l->point);
	for (int pass = 0; pass < 2; pass++) {
		for (uint32_t i = ECO_BLUE_NOISE_POINTS; i-- > 0;) {
			uint32_t cell = l->point[i][1] / (65536 / LATTICE_CELLS) * LATTICE_CELLS
				+ l->point[i][0] / (65536 / LATTICE_CELLS);
			if (pass == 0)
				l->cell_first[cell]++;
			else
				l->member[--l->cell_first[cell]] = i;
		}
		for (uint32_t c = 1; pass == 0 && c <= LATTICE_CELLS * LATTICE_CELLS; c++)
			l->cell_first[c] += l->cell_first[c - 1];
	}
	return l;
}

/* Side of the square at which the set has at least SPARE times the density. A power of two, so that areas
 * of similar density share places along their borders. */
static double side_for(double density_m2)
{
	int exponent;
	frexp(sqrt(ECO_BLUE_NOISE_POINTS / (SPARE * density_m2)), &exponent);
	exponent = exponent < SIDE_EXPONENT_MIN + 1 ? SIDE_EXPONENT_MIN + 1 : exponent > SIDE_EXPONENT_MAX + 1
		? SIDE_EXPONENT_MAX + 1 : exponent;
	return ldexp(0.5, exponent);
}

struct sweep {
	struct eco_scatter *scatter;
	const struct eco_area *area;
	double side;
	uint32_t rank_end, index;    /* index: of the area */
};

static void sweep_cell(const struct sweep *w, int64_t column, int64_t row, uint32_t cell)
{
	const struct lattice *l = w->scatter->lattice;
	struct candidates *c = &w->scatter->candidates;
	const uint32_t tie = (uint32_t)eco_random((uint64_t)column, (uint64_t)row);
	for (uint32_t i = l->cell_first[cell]; i < l->cell_first[cell + 1]; i++) {
		uint32_t rank = l->member[i];
		double x = w->side * ((double)column + l->point[rank][0] / 65536.0),
			y = w->side * ((double)row + l->point[rank][1] / 65536.0);
		if (rank >= w->rank_end || !eco_area_holds(&w->scatter->input.areas, w->index, x, y))
			continue;
		eco_grow(&c->items, &c->capacity, c->count, sizeof *c->items);
		c->items[c->count++] = (struct candidate){ rank, tie, { x, y } };
	}
}

static int64_t square_of(int64_t cell)
{
	return cell >= 0 ? cell / LATTICE_CELLS : -((LATTICE_CELLS - 1 - cell) / LATTICE_CELLS);
}

/* Visits all places of the area's box with ranks below rank_end, cell row by cell row, as far as the area
 * reaches in that row, with a cell to spare: a road across the country is a small part of its box. */
static void sweep_box(const struct sweep *w)
{
	double cell = w->side / LATTICE_CELLS;
	w->scatter->candidates.count = 0;
	for (int64_t y = (int64_t)floor(w->area->low[1] / cell); y <= (int64_t)floor(w->area->high[1] / cell); y++) {
		double span[2];
		int64_t row = square_of(y);
		if (!eco_area_span(&w->scatter->input.areas, w->index, (double)(y - 1) * cell,
			(double)(y + 2) * cell, span))
			continue;
		for (int64_t x = (int64_t)floor(span[0] / cell) - 1; x <= (int64_t)floor(span[1] / cell) + 1;
				x++) {
			int64_t column = square_of(x);
			sweep_cell(w, column, row,
				(uint32_t)((y - row * LATTICE_CELLS) * LATTICE_CELLS
				+ (x - column * LATTICE_CELLS)));
		}
	}
}

static int candidate_order(const void *a, const void *b)
{
	const struct candidate *p = a, *q = b;
	if (p->rank != q->rank)
		return p->rank < q->rank ? -1 : 1;
	if (p->tie != q->tie)
		return p->tie < q->tie ? -1 : 1;
	return p->at[1] != q->at[1] ? (p->at[1] < q->at[1] ? -1 : 1) : (p->at[0] > q->at[0])
		- (p->at[0] < q->at[0]);
}

/* ---- Distances ---- */

static uint32_t *grid_head(const struct near_grid *g, int64_t x, int64_t y)
{
	return &g->head[(uint32_t)(eco_random((uint64_t)x, (uint64_t)y) >> 32) & g->mask];
}

static void grid_put(struct near_grid *g, const struct eco_scatter_place *places, uint32_t place)
{
	uint32_t *head = grid_head(g, (int64_t)floor(places[place].at[0] / g->cell_m),
		(int64_t)floor(places[place].at[1] / g->cell_m));
	g->next[place] = *head;
	*head = place;
}

static void grid_grow(struct eco_scatter *s)
{
	struct near_grid *g = &s->grid;
	g->head = eco_realloc(g->head, 2 * s->capacity, sizeof *g->head);
	g->next = eco_realloc(g->next, s->capacity, sizeof *g->next);
	g->mask = (uint32_t)(2 * s->capacity - 1);
	memset(g->head, 0xff, 2 * s->capacity * sizeof *g->head);
	for (uint32_t i = 0; i < s->count; i++)
		grid_put(g, s->places, i);
}

/* Whether another place is nearer than `distance`, which is at most the grid's cell. */
static bool is_near(const struct eco_scatter *s, const double at[2], double distance)
{
	const struct near_grid *g = &s->grid;
	int64_t x = (int64_t)floor(at[0] / g->cell_m), y = (int64_t)floor(at[1] / g->cell_m);
	if (!g->head)
		return false;
	for (int64_t row = y - 1; row <= y + 1; row++)
		for (int64_t column = x - 1; column <= x + 1; column++)
			for (uint32_t i = *grid_head(g, column, row); i != UINT32_MAX; i = g->next[i]) {
				double dx = s->places[i].at[0] - at[0], dy = s->places[i].at[1] - at[1];
				if (dx * dx + dy * dy < distance * distance)
					return true;
			}
	return false;
}

static enum eco_code add_place(struct eco_scatter *s, const double at[2], uint32_t plant)
{
	const struct eco_scatter_spec *spec = s->spec;
	uint64_t key = eco_random((uint64_t)(int64_t)floor(at[0] * 1000 + 0.5),
		(uint64_t)(int64_t)floor(at[1] * 1000 + 0.5));
	uint64_t bits = eco_random(spec->seed, key);
	double share = (double)(bits >> 40) / (1 << 24);
	if (s->count == s->capacity) {
		if (s->count >= ECO_SCATTER_PLANTS_MAX)
			return too_many(s);
		s->capacity = s->capacity ? 2 * s->capacity : 1024;
		s->places = eco_realloc(s->places, s->capacity, sizeof *s->places);
		grid_grow(s);
	}
	s->places[s->count] = (struct eco_scatter_place){
		.plant = spec->plants[plant].plant + eco_random_variant(spec->seed, key,
			spec->plants[plant].variant_count), .at = { at[0], at[1] },
		.height_m = spec->height_low_m + (spec->height_high_m - spec->height_low_m) * share };
	grid_put(&s->grid, s->places, (uint32_t)s->count++);
	return ECO_OK;
}

/* ---- Areas ---- */

static bool is_clear(const struct eco_scatter *s, const double at[2])
{
	return !eco_areas_near(&s->input.clear, at[0], at[1])
		&& !eco_areas_hold(&s->input.clear, at[0], at[1]);
}

/* The plant of the next place: the one furthest behind its share. */
static uint32_t next_plant(const struct eco_scatter_spec *spec, double total, const uint64_t *given,
	uint64_t placed)
{
	uint32_t best = 0;
	double most = -INFINITY;
	for (uint32_t i = 0; i < spec->plant_count; i++) {
		double behind = spec->plants[i].weight / total * (double)(placed + 1) - (double)given[i];
		if (behind > most) {
			most = behind;
			best = i;
		}
	}
	return best;
}

struct filling { uint32_t area; uint64_t wanted, placed, *given; double total, distance; };

static enum eco_code take_candidates(struct eco_scatter *s, struct filling *f)
{
	struct candidates *c = &s->candidates;
	qsort(c->items, c->count, sizeof *c->items, candidate_order);
	for (size_t i = 0; i < c->count && f->placed < f->wanted; i++) {
		if (!is_clear(s, c->items[i].at) || is_near(s, c->items[i].at, f->distance))
			continue;
		uint32_t plant = next_plant(s->spec, f->total, f->given, f->placed);
		ECO_PASS(add_place(s, c->items[i].at, plant));
		f->given[plant]++;
		f->placed++;
	}
	return ECO_OK;
}

/* Finds the share of an area that is not kept clear. A density counts only there; a number of plants
 * counts for the whole area. */
static void clear_share(struct eco_scatter *s, struct filling *f)
{
	const struct eco_area *area = &s->input.areas.items[f->area];
	const struct candidates *c = &s->candidates;
	struct sweep w = { s, area, side_for((double)f->wanted / area->size_m2), ECO_BLUE_NOISE_POINTS,
		f->area };
	size_t clear = 0;
	if (s->input.clear.count == 0 || s->spec->count_column)
		return;
	sweep_box(&w);
	for (size_t i = 0; i < c->count; i++)
		clear += is_clear(s, c->items[i].at);
	if (c->count > 0)
		f->wanted = (uint64_t)((double)f->wanted * (double)clear / (double)c->count + 0.5);
}

/* Fills the area in the set's order; if one set does not suffice, from ever denser ones. */
static enum eco_code fill_area(struct eco_scatter *s, struct filling *f)
{
	const struct eco_area *area = &s->input.areas.items[f->area];
	double density = (double)f->wanted / area->size_m2, side = side_for(density),
		spacing = 1 / sqrt(density);
	enum eco_code code = ECO_OK;
	for (int attempt = 0; attempt < TRIES && f->placed < f->wanted && code == ECO_OK;
			attempt++, side /= 2) {
		double expected = ECO_BLUE_NOISE_POINTS / (side * side) * area->size_m2;
		struct sweep w = { .scatter = s, .area = area, .side = side, .index = f->area };
		/* most areas find enough in few more ranks than they need; else all ranks are tried */
		f->distance = fmax(attempt > 0 ? fmax(SPREAD * spacing, NEAREST_M) : NEAREST_M,
			s->spec->distance_m);
		f->distance = fmin(f->distance, s->grid.cell_m);
		for (int all = 0; all < 2 && !code && f->placed < f->wanted; all++) {
			double need = 1.1 * (double)(f->wanted - f->placed) / expected * ECO_BLUE_NOISE_POINTS
				+ 64;
			w.rank_end = all || attempt > 0 || need >= ECO_BLUE_NOISE_POINTS
				? ECO_BLUE_NOISE_POINTS : (uint32_t)need;
			sweep_box(&w);
			code = take_candidates(s, f);
			all += w.rank_end == ECO_BLUE_NOISE_POINTS;
		}
	}
	return code;
}

/* ---- Rows ---- */

/* Plants along a feature's lines, every spacing_m, the first after half of that. */
static enum eco_code fill_lines(struct eco_scatter *s, struct filling *f)
{
	const struct eco_area *area = &s->input.areas.items[f->area];
	const struct eco_edge *edges = s->input.areas.edges + area->edge_first;
	const double spacing = s->spec->spacing_m;
	double left = spacing / 2;   /* to the next plant */
	enum eco_code code = ECO_OK;
	for (uint32_t i = area->ring_edges; i < area->edge_count && !code; i++) {
		const struct eco_edge *e = &edges[i];
		double dx = e->b[0] - e->a[0], dy = e->b[1] - e->a[1], length = sqrt(dx * dx + dy * dy);
		for (; left <= length && length > 0 && !code; left += spacing) {
			double at[2] = { e->a[0] + dx * left / length, e->a[1] + dy * left / length };
			if (s->wanted + ++f->wanted > ECO_SCATTER_PLANTS_MAX)
				return too_many(s);
			if (!is_clear(s, at) || is_near(s, at, fmin(fmax(s->spec->distance_m, NEAREST_M), s->grid.cell_m)))
				continue;
			uint32_t plant = next_plant(s->spec, f->total, f->given, f->placed);
			code = add_place(s, at, plant);
			f->given[plant]++;
			f->placed++;
		}
		left -= length;
	}
	return code;
}

static int area_order(const void *a, const void *b, void *ctx)
{
	const struct eco_area *items = ctx, *p = &items[*(const uint32_t *)a],
		*q = &items[*(const uint32_t *)b];
	if (p->size_m2 != q->size_m2)
		return p->size_m2 > q->size_m2 ? -1 : 1;
	if (p->low[1] != q->low[1])
		return p->low[1] < q->low[1] ? -1 : 1;
	return p->low[0] != q->low[0] ? (p->low[0] < q->low[0] ? -1 : 1) : (p->edge_first > q->edge_first)
		- (p->edge_first < q->edge_first);
}

static double total_weight(const struct eco_scatter_spec *spec)
{
	double total = 0;
	for (uint32_t i = 0; i < spec->plant_count; i++)
		total += spec->plants[i].weight;
	return total;
}

/* Number of plants wanted in an area; chance, by the area's place, decides about a fraction. */
static uint64_t wanted_in(const struct eco_scatter *s, uint32_t index)
{
	const struct eco_area *area = &s->input.areas.items[index];
	double hectares = area->size_m2 / HECTARE_M2, number = total_weight(s->spec) * hectares;
	uint64_t key = eco_random((uint64_t)(int64_t)floor(area->low[0] * 1000 + 0.5),
		(uint64_t)(int64_t)floor(area->low[1] * 1000 + 0.5));
	if (s->spec->count_column)
		number = s->input.number[index];
	else if (s->spec->density_column)
		number = s->input.number[index] * hectares;
	number = fmin(number, 2.0 * ECO_SCATTER_PLANTS_MAX);
	return (uint64_t)(number + eco_random_unit(eco_random(s->spec->seed, key)));
}

static enum eco_code place_in_areas(struct eco_scatter *s)
{
	struct eco_areas *areas = &s->input.areas;
	uint32_t *order = eco_alloc(areas->count + 1u, sizeof *order);
	uint64_t *given = eco_alloc(s->spec->plant_count + 1u, sizeof *given);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < areas->count; i++)
		order[i] = i;
	qsort_r(order, areas->count, sizeof *order, area_order, areas->items);
	for (uint32_t i = 0; i < areas->count && code == ECO_OK; i++) {
		struct filling f = { .area = order[i], .wanted = s->spec->spacing_m > 0 ? 0 : wanted_in(s, order[i]),
			.given = given, .total = total_weight(s->spec) };
		s->hectares += areas->items[order[i]].size_m2 / HECTARE_M2;
		if (f.wanted > 0 && areas->items[order[i]].size_m2 > 0)
			clear_share(s, &f);
		memset(given, 0, s->spec->plant_count * sizeof *given);
		if (s->spec->spacing_m > 0)
			code = fill_lines(s, &f);
		s->wanted += f.wanted;
		if (s->wanted > ECO_SCATTER_PLANTS_MAX)
			code = too_many(s);
		if (f.wanted == 0 || code != ECO_OK)
			continue;
		if (areas->items[order[i]].size_m2 > 0 && !(s->spec->spacing_m > 0))
			code = fill_area(s, &f);
		s->short_areas += f.placed < f.wanted;
		if (code == ECO_OK && s->progress && !s->progress(s->ctx, (double)i / areas->count))
			code = eco_fail(s->error, ECO_INTERRUPTED, "interrupted");
	}
	free(order);
	free(given);
	return code;
}

/* ---- The whole ---- */

enum eco_code eco_scatter_open(struct eco_scatter **scatter, const struct eco_scatter_spec *spec,
	const struct eco_frame *frame, bool (*progress)(void *ctx, double share), void *ctx,
	struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct eco_scatter *s = eco_alloc(1, sizeof *s);
	*scatter = NULL;
	assert(spec->plant_count > 0);
	*s = (struct eco_scatter){ .spec = spec, .lattice = make_lattice(), .progress = progress, .ctx = ctx,
		.error = error ? error : &own };
	s->grid.cell_m = fmax(spec->distance_m, 1);
	enum eco_code code = eco_scatter_read(&s->input, spec, frame, s->error);
	if (!code)
		code = place_in_areas(s);
	free(s->candidates.items);
	s->candidates = (struct candidates){ .items = NULL };
	s->error = NULL;
	if (!code)
		*scatter = s;
	else
		eco_scatter_close(s);
	return code;
}

enum eco_code eco_scatter_check(const struct eco_scatter_spec *spec, const struct eco_frame *frame,
	struct eco_error *error)
{
	struct eco_scatter_input input = { .number = NULL };
	enum eco_code code = eco_scatter_read(&input, spec, frame, error);
	eco_scatter_input_free(&input);
	return code;
}

bool eco_scatter_next(struct eco_scatter *scatter, struct eco_scatter_place *place)
{
	if (scatter->at == scatter->count)
		return false;
	*place = scatter->places[scatter->at++];
	return true;
}

void eco_scatter_report(const struct eco_scatter *s, void (*say)(void *ctx, const char *text), void *ctx)
{
	char line[512];
	for (uint32_t i = 0; i < s->input.report.note_count; i++)
		say(ctx, s->input.report.notes[i]);
	char what[40];
	snprintf(what, sizeof what, s->spec->spacing_m > 0 ? "" : " of %.4g ha", s->hectares);
	snprintf(line, sizeof line, "%u %s%s%s: %llu plants of %llu wanted", s->input.areas.count,
		s->spec->spacing_m > 0 ? "line" : "area", s->input.areas.count == 1 ? "" : "s", what, (unsigned long long)s->count,
		(unsigned long long)s->wanted);
	say(ctx, line);
	eco_areas_report_say(&s->input.report, say, ctx);
	if (s->short_areas > 0) {
		snprintf(line, sizeof line, "  %llu area%s no room for as many plants as wanted, at %g m "
			"from each other%s", (unsigned long long)s->short_areas, s->short_areas == 1 ? " has"
			: "s have", s->spec->distance_m, s->spec->clear_of
			? " and away from \"clear_of\"" : "");
		say(ctx, line);
	}
}

const struct eco_areas *eco_scatter_areas(const struct eco_scatter *s) { return &s->input.areas; }

const struct eco_areas *eco_scatter_clear_of(const struct eco_scatter *s) { return &s->input.clear; }

void eco_scatter_close(struct eco_scatter *s)
{
	if (!s)
		return;
	eco_scatter_input_free(&s->input);
	eco_free(s->lattice, s->candidates.items, s->grid.head, s->grid.next, s->places, s);
}
