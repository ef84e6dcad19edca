/* Seen from above on a coarse grid: cells that triangles touch grow together over a gap of one cell, so that
 * loose leaves of one crown are one piece. */
#include "ecofiles/import/model/model_clean.h"

#include <math.h>
#include <stdlib.h>

#define SIDE 64
#define CELLS (SIDE * SIDE)
#define TALL 0.4
#define STANDS 0.25              /* of the whole height: the lowest point is below */

struct cell { float low, high; bool full, seen; };
struct grid { struct cell cells[CELLS]; double from[2], step; int stack[CELLS]; };
struct piece { float low, high; double sum[2]; uint32_t cells; };

static int cell_at(const struct grid *g, int k, double value)
{
	int at = (int)floor((value - g->from[k]) / g->step);
	return at < 0 ? 0 : at >= SIDE ? SIDE - 1 : at;
}

static void mark(struct grid *g, const struct eco_model *m, uint32_t triangle)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (int corner = 0; corner < 3; corner++)
		for (int k = 0; k < 3; k++) {
			double value = (double)m->position[3 *
					(size_t)m->index[3 * (size_t)triangle + (size_t)corner] +
				(size_t)k];
			low[k] = fmin(low[k], value);
			high[k] = fmax(high[k], value);
		}
	for (int y = cell_at(g, 1, low[1]); y <= cell_at(g, 1, high[1]); y++)
		for (int x = cell_at(g, 0, low[0]); x <= cell_at(g, 0, high[0]); x++) {
			struct cell *c = &g->cells[y * SIDE + x];
			c->low = c->full ? fminf(c->low, (float)low[2]) : (float)low[2];
			c->high = c->full ? fmaxf(c->high, (float)high[2]) : (float)high[2];
			c->full = true;
		}
}

/* Everything within two cells of each other, from one cell on. */
static struct piece grow(struct grid *g, int first)
{
	struct piece piece = { .low = INFINITY, .high = -INFINITY };
	int depth = 0;
	g->stack[depth++] = first;
	g->cells[first].seen = true;
	while (depth > 0) {
		int at = g->stack[--depth], x = at % SIDE, y = at / SIDE;
		piece.low = fminf(piece.low, g->cells[at].low);
		piece.high = fmaxf(piece.high, g->cells[at].high);
		piece.sum[0] += x + 0.5;
		piece.sum[1] += y + 0.5;
		piece.cells++;
		for (int j = y > 1 ? y - 2 : 0; j <= y + 2 && j < SIDE; j++)
			for (int i = x > 1 ? x - 2 : 0; i <= x + 2 && i < SIDE; i++) {
				struct cell *c = &g->cells[j * SIDE + i];
				if (!c->full || c->seen)
					continue;
				c->seen = true;
				g->stack[depth++] = j * SIDE + i;
			}
	}
	return piece;
}

struct eco_apart eco_model_apart(const struct eco_model *model, const double low[3], const double high[3])
{
	struct eco_apart apart = { .count = 0 };
	struct grid *g = calloc(1, sizeof *g);
	double side = fmax(high[0] - low[0], high[1] - low[1]), tall = high[2] - low[2];
	if (!g || !(side > 0) || !(tall > 0)) {
		free(g);
		return apart;
	}
	g->from[0] = low[0];
	g->from[1] = low[1];
	g->step = side / SIDE;
	for (uint32_t t = 0; t < model->triangle_count; t++)
		mark(g, model, t);
	for (int i = 0; i < CELLS; i++) {
		if (!g->cells[i].full || g->cells[i].seen)
			continue;
		struct piece p = grow(g, i);
		if ((double)p.high - low[2] < TALL * tall || (double)p.low - low[2] > STANDS * tall)
			continue;
		for (int k = 0; k < 2 && apart.count < ECO_APART_MOST; k++)
			apart.at[apart.count][k] = g->from[k] + g->step * p.sum[k] / p.cells;
		apart.count++;
	}
	free(g);
	return apart;
}
