/* Ground beyond the rasters. Ring by ring outwards, each about twice as far from the border as the one
 * before, the border's heights are smoothed along it, as widely as the ring is far, and drawn to their mean:
 * a ridge that the border cuts ends in a rounded hill, and not in a wall or in furrows to the horizon. */
#include "ecofiles/import/ground/ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REACH_M 131072.0             /* from a tower of 1 km the horizon is 113 km away */
#define REACH_EXTENTS 4.0            /* and seen from above, so many times as far as the ground is wide */

struct margin {
	const struct eco_ground *inside;
	double *profile, *next; /* heights along the border, counter-clockwise from its south-west corner */
	uint32_t length;             /* samples of the border */
	double mean, fade_m;
};

static uint32_t margin_of(const struct eco_ground *g)
{
	double step = fmin(g->step_x_m, g->step_y_m), width = g->step_x_m * (g->columns - 1),
	       depth = g->step_y_m * (g->rows - 1), reach = fmax(REACH_M, REACH_EXTENTS * fmax(width, depth));
	uint32_t margin = 1;
	while (margin < ECO_GROUND_MARGIN_MAX && step * ((1 << margin) - 1) < reach)
		margin++;
	return margin;
}

/* Where sample (x, y) of the border comes along it. */
static uint32_t along_border(const struct eco_ground *g, uint32_t x, uint32_t y)
{
	uint32_t east = g->columns - 1, north = g->rows - 1;
	if (y == 0)
		return x;
	if (x == east)
		return east + y;
	return y == north ? east + north + (east - x) : 2 * east + north + (north - y);
}

static void take_profile(struct margin *m)
{
	const struct eco_ground *g = m->inside;
	double sum = 0;
	for (uint32_t y = 0; y < g->rows; y++)
		for (uint32_t x = 0; x < g->columns; x += y % (g->rows - 1) ? g->columns - 1 : 1)
			m->profile[along_border(g, x, y)] = (double)g->height_m[(size_t)y * g->columns + x];
	for (uint32_t i = 0; i < m->length; i++)
		sum += m->profile[i];
	m->mean = sum / m->length;
}

static void smooth(struct margin *m, uint32_t distance)
{
	for (uint32_t i = 0; i < m->length; i++)
		m->next[i] = (m->profile[(i + m->length - distance) % m->length] + 2 * m->profile[i]
			+ m->profile[(i + distance) % m->length]) / 4;
	double *profile = m->next;
	m->next = m->profile;
	m->profile = profile;
}

static uint32_t clamped(uint32_t i, uint32_t margin, uint32_t count)
{
	return i < margin ? 0 : i - margin < count ? i - margin : count - 1;
}

/* The samples of ring k, from 1: a rectangle. */
static void fill_ring(const struct margin *m, struct eco_ground *g, uint32_t k, double share)
{
	uint32_t low = g->margin - k, east = g->columns - 1 - low, north = g->rows - 1 - low;
	for (uint32_t y = low; y <= north; y++)
		for (uint32_t x = low; x <= east; x += y == low || y == north ? 1 : east - low) {
			uint32_t i = along_border(m->inside, clamped(x, g->margin, m->inside->columns),
				clamped(y, g->margin, m->inside->rows));
			g->height_m[(size_t)y * g->columns + x] =
				(float)(m->mean + (m->profile[i] - m->mean) * share);
		}
}

static void fill_rings(struct margin *m, struct eco_ground *g)
{
	double step = fmax(g->step_x_m, g->step_y_m);
	for (uint32_t k = 1; k <= g->margin; k++) {
		uint32_t width = 1u << (k - 1);
		double far = step * ((1 << k) - 1) / m->fade_m;
		if (width < m->length / 2)
			smooth(m, width);
		fill_ring(m, g, k, k < g->margin ? 1 / (1 + far * far) : 0);
	}
}

enum eco_code eco_ground_extend(struct eco_ground *ground, struct eco_error *error)
{
	const struct eco_ground inside = *ground;
	struct eco_ground g = inside;
	struct margin m = { .inside = &inside, .length = 2 * (inside.columns + inside.rows) - 4,
		.fade_m = (inside.step_x_m * inside.columns + inside.step_y_m * inside.rows) / 4 };
	g.margin = margin_of(&inside);
	g.columns += 2 * g.margin;
	g.rows += 2 * g.margin;
	g.height_m = malloc((size_t)g.columns * g.rows * sizeof *g.height_m);
	double *profiles = malloc(2 * sizeof *profiles * m.length);
	if (!g.height_m || !profiles) {
		free(g.height_m);
		free(profiles);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for ground of %u x %u samples", g.columns,
			g.rows);
	}
	m.profile = profiles;
	m.next = profiles + m.length;
	take_profile(&m);
	for (uint32_t y = 0; y < inside.rows; y++)
		memcpy(g.height_m + (size_t)(y + g.margin) * g.columns + g.margin,
			inside.height_m + (size_t)y * inside.columns, inside.columns * sizeof *g.height_m);
	fill_rings(&m, &g);
	free(profiles);
	eco_ground_free(ground);
	*ground = g;
	return ECO_OK;
}
