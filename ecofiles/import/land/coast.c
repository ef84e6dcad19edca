/* The sea, as OpenStreetMap has no area of it: coastlines, which have the land on their left, are joined to rings; what is open goes on
 * straight, away from the middle of the file, to a box around all that is drawn, and along its sides. */
#include "ecofiles/import/land/drawing_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"

#define BEYOND_M 2000.0      /* beyond what is drawn, the sea goes on */
#define COAST_MOST_M 200000.0 /* from the origin a corner of it lies: products of two are exact enough, and the picture ends */

/* next: ECO_NONE: it ends; leave: of a chain's first one, the mark of its end */
struct piece { const struct eco_edge *edges; uint32_t count, next, leave; bool ended, used; };
struct mark { double at; uint32_t piece; bool leaves; };    /* along the box's sides, clockwise from the south-west */
struct coast {
	struct piece *pieces; uint32_t count, capacity;
	double low[2], high[2], middle[2];
	struct mark *marks; uint32_t mark_count;
	struct eco_areas *sea;
};

static bool same(const double a[2], const double b[2]) { return a[0] == b[0] && a[1] == b[1]; }

static void widen(struct coast *c, const double at[2])
{
	for (int k = 0; k < 2; k++) {
		double near = fmin(fmax(at[k], -COAST_MOST_M), COAST_MOST_M);
		c->low[k] = fmin(c->low[k], near);
		c->high[k] = fmax(c->high[k], near);
	}
}

/* Runs of edges that follow each other. */
static void take_file(struct coast *c, const struct drawn_file *file, uint32_t class)
{
	for (uint32_t i = 0; i < file->areas.count; i++) {
		const struct eco_area *area = &file->areas.items[i];
		const struct eco_edge *e = file->areas.edges + area->edge_first;
		widen(c, area->low);
		widen(c, area->high);
		for (uint32_t k = 0; k < area->edge_count && file->items[i].class == class; k++)
			if (k && same(e[k].a, e[k - 1].b))
				c->pieces[c->count - 1].count++;
			else {
				eco_grow(&c->pieces, &c->capacity, c->count, sizeof *c->pieces);
				c->pieces[c->count++] = (struct piece){ .edges = e + k, .count = 1, .next = ECO_NONE };
			}
	}
}

static int by_place(const double p[2], const double q[2])
{
	return p[0] != q[0] ? (p[0] > q[0] ? 1 : -1) : (p[1] > q[1]) - (p[1] < q[1]);
}

static int by_start(const void *a, const void *b)
{
	return by_place(((const struct piece *)a)->edges->a, ((const struct piece *)b)->edges->a);
}

static const double *end_of(const struct piece *p) { return p->edges[p->count - 1].b; }

/* 0: one is a copy of the other, by their ends, second corners and numbers of edges. */
static int by_line(const void *a, const void *b)
{
	const struct piece *p = a, *q = b;
	int order = by_start(a, b);
	order = order ? order : by_place(p->edges->b, q->edges->b);
	order = order ? order : by_place(end_of(p), end_of(q));
	return order ? order : (p->count > q->count) - (p->count < q->count);
}

/* The piece that begins where another ends. Copies are left out, as extracts that overlap have the same coast. */
static void join(struct coast *c)
{
	uint32_t kept = 0;
	qsort(c->pieces, c->count, sizeof *c->pieces, by_line);
	for (uint32_t i = 0; i < c->count; i++)
		if (!kept || by_line(&c->pieces[kept - 1], &c->pieces[i]))
			c->pieces[kept++] = c->pieces[i];
	c->count = kept;
	for (uint32_t i = 0; i < c->count; i++) {
		struct eco_edge at = { { end_of(&c->pieces[i])[0], end_of(&c->pieces[i])[1] }, { 0, 0 } };
		const struct piece key = { .edges = &at }, *found = bsearch(&key, c->pieces, c->count, sizeof key, by_start);
		if (found && !found->ended) {
			c->pieces[i].next = (uint32_t)(found - c->pieces);
			c->pieces[c->pieces[i].next].ended = true;       /* its beginning is taken */
		}
	}
}

static void add_edge(struct coast *c, const double a[2], const double b[2])
{
	struct eco_areas *s = c->sea;
	if (same(a, b))
		return;
	eco_grow(&s->edges, &s->edge_capacity, s->edge_count, sizeof *s->edges);
	s->edges[s->edge_count++] = (struct eco_edge){ { a[0], a[1] }, { b[0], b[1] } };
}

/* ---- The box ---- */

static void corner(const struct coast *c, unsigned i, double at[2])
{
	at[0] = i % 4 == 0 || i % 4 == 1 ? c->low[0] : c->high[0];
	at[1] = i % 4 == 0 || i % 4 == 3 ? c->low[1] : c->high[1];
}

/* The way from the middle through a place meets the box at `at`; how far that is along its sides: 0 to 4. */
static double meet(const struct coast *c, const double from[2], double at[2])
{
	double way[2] = { from[0] - c->middle[0], from[1] - c->middle[1] }, half[2], least = INFINITY;
	int axis = 1;
	for (int k = 0; k < 2; k++) {
		half[k] = (c->high[k] - c->low[k]) / 2;
		double part = way[k] != 0 ? half[k] / fabs(way[k]) : INFINITY;
		axis = part < least ? k : axis;
		least = fmin(least, part);
	}
	way[1] = isfinite(least) ? way[1] : -1;
	least = isfinite(least) ? least : half[1];
	for (int k = 0; k < 2; k++)
		at[k] = k == axis ? (way[k] > 0 ? c->high[k] : c->low[k]) : c->middle[k] + way[k] * least;
	double x = (at[0] - c->low[0]) / (2 * half[0]), y = (at[1] - c->low[1]) / (2 * half[1]);
	return axis == 0 ? (way[0] < 0 ? y : 3 - y) : way[1] > 0 ? 1 + x : 4 - x;
}

static void add_mark(struct coast *c, const double at[2], uint32_t piece, bool leaves)
{
	double on[2];
	c->marks[c->mark_count++] = (struct mark){ meet(c, at, on), piece, leaves };
}

ECO_ORDER_TWO(by_way, struct mark, ->at, ->piece)

/* Clockwise along the sides, from one mark to the next. */
static void add_sides(struct coast *c, double from, double to, const double a[2], const double b[2])
{
	double at[2] = { a[0], a[1] }, next[2];
	to += to < from ? 4 : 0;
	for (unsigned i = (unsigned)from + 1; i <= 8 && (double)i < to; i++) {
		corner(c, i, next);
		add_edge(c, at, next);
		memcpy(at, next, sizeof at);
	}
	add_edge(c, at, b);
}

/* ---- Rings ---- */

/* The last piece of a chain from piece `first` on, whose edges are added; twice the area to its left. */
static uint32_t add_chain(struct coast *c, uint32_t first, double *area)
{
	uint32_t last = first;
	for (uint32_t i = first; i != ECO_NONE && !c->pieces[i].used; i = c->pieces[i].next) {
		c->pieces[i].used = true;
		last = i;
		for (uint32_t k = 0; k < c->pieces[i].count; k++) {
			const struct eco_edge *e = &c->pieces[i].edges[k];
			add_edge(c, e->a, e->b);
			*area += e->a[0] * e->b[1] - e->b[0] * e->a[1];
		}
	}
	return last;
}

/* Chains that end, from side to side. False: one leaves the box where the next does, too: a gap. */
static bool add_open(struct coast *c)
{
	double none = 0, out[2], in[2];
	bool good = true;
	for (uint32_t i = 0; i < c->count; i++)
		if (!c->pieces[i].ended) {
			uint32_t last = i;
			while (c->pieces[last].next != ECO_NONE)
				last = c->pieces[last].next;
			add_mark(c, c->pieces[i].edges->a, i, false);
			add_mark(c, end_of(&c->pieces[last]), i, true);
		}
	qsort(c->marks, c->mark_count, sizeof *c->marks, by_way);
	for (uint32_t i = 0; i < c->mark_count; i++) {
		good = good && c->marks[i].leaves != c->marks[(i + 1) % c->mark_count].leaves;
		if (c->marks[i].leaves)
			c->pieces[c->marks[i].piece].leave = i;
	}
	for (uint32_t i = 0; i < c->mark_count && good; i++)
		for (uint32_t m = i; !c->marks[m].leaves && !c->pieces[c->marks[m].piece].used;) {
			const struct piece *first = &c->pieces[c->marks[m].piece];
			meet(c, first->edges->a, in);
			add_edge(c, in, first->edges->a);
			const double *end = end_of(&c->pieces[add_chain(c, c->marks[m].piece, &none)]);
			double from = meet(c, end, out);
			add_edge(c, end, out);
			m = (first->leave + 1) % c->mark_count;
			meet(c, c->pieces[c->marks[m].piece].edges->a, in);
			add_sides(c, from, c->marks[m].at, out, in);
		}
	return good;
}

/* Islands, and seas that land surrounds. Around an island without other coasts there is sea. */
static void add_closed(struct coast *c)
{
	double largest = 0, at[2][2];
	for (uint32_t i = 0; i < c->count; i++) {
		double area = 0;
		if (!c->pieces[i].used)
			add_chain(c, i, &area);
		largest = fabs(area) > fabs(largest) ? area : largest;
	}
	for (unsigned i = 0; i < 4 && !c->mark_count && largest > 0; i++) {
		corner(c, i, at[0]);
		corner(c, i + 1, at[1]);
		add_edge(c, at[0], at[1]);
	}
}

enum eco_code drawing_sea(struct drawn_file *sea, const struct drawn_file *files, uint32_t count, uint32_t class, bool *gap,
	struct eco_error *error)
{
	struct coast c = { .low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY }, .sea = &sea->areas };
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count; i++)
		take_file(&c, &files[i], class);
	for (int k = 0; k < 2; k++) {
		c.low[k] -= BEYOND_M;
		c.high[k] += BEYOND_M;
		c.middle[k] = (c.low[k] + c.high[k]) / 2;
	}
	join(&c);
	c.marks = eco_alloc(2 * (size_t)c.count + 1, sizeof *c.marks);
	*gap = !add_open(&c);
	if (!*gap)
		add_closed(&c);
	if (!*gap && c.sea->edge_count) {
		c.sea->items = eco_alloc(1, sizeof *c.sea->items);
		c.sea->items[c.sea->count++] = (struct eco_area){ .edge_count = c.sea->edge_count, .ring_edges = c.sea->edge_count,
			.low = { c.low[0], c.low[1] }, .high = { c.high[0], c.high[1] } };
		code = eco_areas_index(c.sea, 0.01, error);
	}
	free(c.pieces);
	free(c.marks);
	return code;
}
