/* Puts a plant on its foot and gives it its size.
 *
 * The foot is the stems' lower end: the mean of the edges there by length, so that each stem counts by its
 * girth, however finely it is modelled. Stems are components that reach through a good part of the height
 * and are large and thick beside the others; where rules name wood, the rules decide. If nothing is long
 * (a bush that is one hull), the whole lower part counts.
 *
 * The ground is at the lowest vertex, with two exceptions. Twigs may hang lower than the stem's foot
 * (willows, bushes): then the stem stands on the ground and the twigs end in it, as a floating stem would
 * be seen from far. But if something right under the foot surrounds it (a pot, roots, a trunk below a
 * crown that is one hull), the plant stands on that. And if the file's origin is in the stem just above
 * its lower end, the modeller let the stem or its roots reach below the ground: zero is the ground.
 *
 * The size is the one asked for; else that of the unit given, or of the file's unit; else of a unit that
 * makes it a plausible plant, which is reported. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/model_clean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/pack.h"

#define GUESS_MOST_M 60.0            /* higher trees are rarer than files in centimetres */
#define FOOT_SHARE 0.02              /* of the height: a stem's foot is this near its lowest vertex */
#define HULL_SHARE 0.25              /* the same if nothing is long */
#define STEMS_SHARE 0.1              /* of the height: stems on one ground differ by at most this */
#define TALL_SHARE 0.25              /* of the height: a component that reaches through less is no stem */
#define STEM_TRIANGLES 6u            /* least triangles of a stem: a tube has more, cards of leaves fewer */
#define WOOD_SHARE 0.1               /* least share of the largest component's area */
#define GIRTH_SHARE 0.5              /* least share of the thickest long component's circumference */
#define LONG 4.0                     /* least length, in circumferences / pi */
#define HANGS_MOST 0.1               /* most of the area that may be below the stem's foot */
#define DEPTH_MOST 0.35              /* most of the height that may hang */
#define UNDER 0.005                  /* of the height: how far below the foot to look for a support */
#define SECTORS_LEAST 3              /* least sixteenths of the circle that a support covers */
#define SECTORS_HALF 8
#define STEPS 8
#define TAN_22_5 0.41421356237309503
#define ROOTS_MOST 0.1               /* most of the height that may be below the file's zero */
#define PI 3.14159265358979323846

struct stance {
	const struct eco_model *model;
	struct eco_components components;
	bool *wood;                  /* per component */
	double girth;                /* of the thickest long component; 0: nothing is long */
	double box[2][3], area;      /* of the whole model */
	double low, high;            /* z of the box */
	double wood_low, foot[3];
};

/* Not hypot, which differs between machines. */
static double length_of(double x, double y)
{
	return sqrt(x * x + y * y);
}

/* Circumference of a tube with that area and length. */
static double girth_of(const struct eco_component *c)
{
	double length = eco_component_diagonal(c);
	return length > 0 ? c->area / length : 0;
}

static bool is_long(const struct eco_component *c)
{
	return PI * eco_component_diagonal(c) >= LONG * girth_of(c);
}

static void measure(struct stance *s)
{
	eco_components_bound(&s->components, s->box[0], s->box[1]);
	s->low = s->box[0][2];
	s->high = s->box[1][2];
	for (uint32_t i = 0; i < s->components.count; i++)
		s->area += s->components.items[i].area;
}

/* Candidates for stems: 2 may be a stem, 1 has enough triangles, 0 any. */
static int rank_of(const struct stance *s, const struct eco_component *c)
{
	return c->triangle_count < STEM_TRIANGLES ? 0
		: c->high[2] - c->low[2] >= TALL_SHARE * (s->high - s->low) ? 2 : 1;
}

/* Marks wood by shape: leaves and twigs are small, and branches that hang below the trunk's foot are thin.
 * Pots are thick, and marked too. If all components are alike (grass), or none is long (bushes), all large
 * ones are marked. */
static void mark_by_shape(struct stance *s)
{
	const struct eco_component *items = s->components.items;
	double largest = 0;
	int best = 0;
	for (uint32_t i = 0; i < s->components.count; i++) {
		int rank = rank_of(s, &items[i]);
		largest = rank > best ? items[i].area : rank == best ? fmax(largest, items[i].area) : largest;
		best = rank > best ? rank : best;
	}
	for (uint32_t i = 0; i < s->components.count; i++) {
		s->wood[i] = rank_of(s, &items[i]) >= best && items[i].area >= WOOD_SHARE * largest;
		if (s->wood[i] && is_long(&items[i]))
			s->girth = fmax(s->girth, girth_of(&items[i]));
	}
	for (uint32_t i = 0; i < s->components.count; i++)
		s->wood[i] = s->wood[i] && girth_of(&items[i]) >= GIRTH_SHARE * s->girth;
}

/* Rules win; but wood that ends high above everything else is no stem. */
static void find_wood(struct stance *s)
{
	const struct eco_model *m = s->model;
	bool ruled = false;
	mark_by_shape(s);
	for (uint32_t i = 0; i < m->triangle_count && m->organ; i++)
		if (m->organ[i] == ECO_ORGAN_WOOD) {
			if (!ruled)
				memset(s->wood, 0, s->components.count * sizeof *s->wood);
			ruled = s->wood[s->components.of[i]] = true;
		}
	s->wood_low = INFINITY;
	for (uint32_t i = 0; i < s->components.count; i++)
		if (s->wood[i])
			s->wood_low = fmin(s->wood_low, s->components.items[i].low[2]);
	if (ruled || s->wood_low <= s->low + DEPTH_MOST * (s->high - s->low))
		return;
	memset(s->wood, 1, s->components.count * sizeof *s->wood);
	s->wood_low = s->low;
}

/* Mean of the stems' edges near their lowest vertices, by length; without edges, the middle of the
 * vertices' box. */
static void find_foot(struct stance *s)
{
	const struct eco_model *m = s->model;
	double height = s->high - s->low, share = s->girth > 0 ? FOOT_SHARE : HULL_SHARE, sum[2] = { 0, 0 },
		weight = 0;
	double box[2][2] = { { INFINITY, -INFINITY }, { INFINITY, -INFINITY } };
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++) {
		const float *p = &m->position[(size_t)m->index[i] * 3],
			*q = &m->position[(size_t)m->index[i % 3 == 2 ? i - 2 : i + 1] * 3];
		uint32_t component = s->components.of[i / 3];
		double own = s->components.items[component].low[2], length;
		if (!s->wood[component] || own > s->wood_low + STEMS_SHARE * height
				|| p[2] > own + share * height)
			continue;
		for (int k = 0; k < 2; k++) {
			box[k][0] = fmin(box[k][0], p[k]);
			box[k][1] = fmax(box[k][1], p[k]);
		}
		if (q[2] > own + share * height)
			continue;
		length = length_of((double)q[0] - p[0], (double)q[1] - p[1]);
		weight += length;
		for (int k = 0; k < 2; k++)
			sum[k] += length * ((double)p[k] + q[k]) / 2;
	}
	for (int k = 0; k < 2; k++)
		s->foot[k] = weight > 0 ? sum[k] / weight : (box[k][0] + box[k][1]) / 2;
}

/* The sixteenth of the circle that a direction is in, by products and comparisons alone. */
static unsigned sector_of(double x, double y)
{
	unsigned sector = y < 0 ? 8 : 0;
	double ax = fabs(x), ay = fabs(y), low = ax < ay ? ax : ay, high = ax < ay ? ay : ax;
	unsigned eighth = (ay > ax ? 2 : 0) + ((low > TAN_22_5 * high) != (ay > ax) ? 1 : 0);
	return sector + ((x < 0) != (y < 0) ? 7 - eighth : eighth);
}

/* The sectors around the foot, as bits, that the triangle's cut with the plane at height z covers; 0: it
 * does not meet the plane. */
static unsigned sectors_at(const struct stance *s, uint32_t triangle, double z)
{
	double cut[3][2] = { { 0 } };
	unsigned count = 0, sectors = 0;
	for (uint32_t k = 0; k < 3; k++) {
		const float *p = &s->model->position[(size_t)s->model->index[(size_t)triangle * 3 + k] * 3];
		const float *q =
			&s->model->position[(size_t)s->model->index[(size_t)triangle * 3 + (k + 1) % 3] * 3];
		if ((p[2] < z) == (q[2] < z))
			continue;
		for (int j = 0; j < 2; j++)
			cut[count][j] = p[j] + ((double)q[j] - p[j]) * (z - p[2]) / ((double)q[2] - p[2])
				- s->foot[j];
		count++;
	}
	for (int i = 0; i <= STEPS && count >= 2; i++)
		sectors |= 1u << sector_of(cut[0][0] + (cut[1][0] - cut[0][0]) * i / STEPS,
			cut[0][1] + (cut[1][1] - cut[0][1]) * i / STEPS);
	return sectors;
}

/* Whether geometry right below the foot surrounds it at least half. */
static bool stands_on_something(const struct stance *s)
{
	double z = s->wood_low - UNDER * (s->high - s->low);
	unsigned *sectors = eco_alloc((size_t)s->components.count + 1, sizeof *sectors), all = 0;
	for (uint32_t i = 0; i < s->model->triangle_count; i++)
		if (s->components.items[s->components.of[i]].low[2] < z)
			sectors[s->components.of[i]] |= sectors_at(s, i, z);
	for (uint32_t i = 0; i < s->components.count; i++)
		all |= __builtin_popcount(sectors[i]) >= SECTORS_LEAST ? sectors[i] : 0;
	free(sectors);
	return __builtin_popcount(all) >= SECTORS_HALF;
}

/* Whether everything below the stem's foot only hangs there. */
static bool only_hangs(const struct stance *s)
{
	double below = 0;
	if (s->girth == 0 || s->wood_low - s->low > DEPTH_MOST * (s->high - s->low))
		return false;
	for (uint32_t i = 0; i < s->components.count; i++)
		below += s->components.items[i].high[2] < s->wood_low ? s->components.items[i].area : 0;
	return below <= HANGS_MOST * s->area && !stands_on_something(s);
}

static void find_ground(struct stance *s, const struct eco_model_frame *frame)
{
	double height = s->high - s->low, zero = -frame->base[2];
	double aside = length_of(s->foot[0] + frame->base[0], s->foot[1] + frame->base[1]);
	s->foot[2] = s->low;
	if (s->wood_low > s->low && only_hangs(s))
		s->foot[2] = s->wood_low;
	if (s->girth > 0 && zero > s->foot[2] && zero <= s->wood_low + ROOTS_MOST * height
			&& zero >= s->wood_low && aside <= ROOTS_MOST * height)
		s->foot[2] = zero;
}

/* ---- Size ---- */

static const struct known_unit { double metres; const char *name; } known_units[] = { { 1, "metres" },
	{ 0.01, "centimetres" }, { 0.001, "millimetres" } };

/* The largest of them in which it is no higher than most trees. */
static const struct known_unit *guess_unit(double height)
{
	int i = 0;
	while (i < 2 && height * known_units[i].metres > GUESS_MOST_M)
		i++;
	return &known_units[i];
}

static enum eco_code find_scale(struct model_clean *c, double top)
{
	const struct eco_model_options *options = c->options;
	const struct known_unit *guess = options->object ? known_units : guess_unit(top);
	struct eco_model_source *source = &c->model->source;
	const double stated_m = options->unit_m > 0 ? options->unit_m : c->frame->unit_m;
	source->unit_how = options->unit_m > 0 ? ECO_HOW_GIVEN : stated_m > 0 ? ECO_HOW_FORMAT
		: options->height_m > 0 ? ECO_HOW_HEIGHT : ECO_HOW_GUESSED;
	if (options->height_m > 0 && !(top > 0))
		return eco_fail(c->error, ECO_BAD_INPUT,
			"%.300s: the model is flat, so it cannot be made %g m "
			"high: leave height_m out, or say which axis is \"up\"",
			c->what, options->height_m);
	source->unit_m = stated_m > 0   ? stated_m
		: options->height_m > 0 ? options->height_m / top
					: guess->metres;
	c->model->scale = options->height_m > 0 ? options->height_m / top : source->unit_m;
	if (source->unit_how == ECO_HOW_GUESSED)
		eco_note(c->notes,
			"%.4g units high, taken for %s: %.3g m; add \"unit\" or \"height_m\" if not", top,
			guess->name, top * guess->metres);
	else if (!options->object && !(options->height_m > 0) && (top * source->unit_m > ECO_PLANT_HEIGHT_MOST_M
			|| top * source->unit_m < ECO_PLANT_HEIGHT_LEAST_M))
		eco_note(c->notes, "%.3g m high by %s unit (%.4g units of %.4g m), which no plant is; add "
			"\"height_m\" or another \"unit\"", top * source->unit_m,
			source->unit_how == ECO_HOW_GIVEN ? "the given" : "its file's", top, source->unit_m);
	return ECO_OK;
}

/* ---- All ---- */

static enum eco_code stand(struct stance *s, struct model_clean *c)
{
	struct eco_model *m = c->model;
	measure(s);
	find_wood(s);
	find_foot(s);
	find_ground(s, c->frame);
	for (int k = 0; k < 3 && (c->options->keep_origin || c->options->object); k++)
		s->foot[k] = c->options->origin[k] - c->frame->base[k];
	ECO_PASS(find_scale(c, s->high - s->foot[2]));
	for (int k = 0; k < 3; k++) {
		m->source.size[k] = s->box[1][k] - s->box[0][k];
		m->foot[k] = s->foot[k] + c->frame->base[k];
	}
	m->source.below = s->foot[2] - s->low;
	for (size_t i = 0; i < 3 * (size_t)m->vertex_count; i++)
		m->position[i] = (float)((m->position[i] - s->foot[i % 3]) * m->scale);
	return ECO_OK;
}

enum eco_code model_stand(struct model_clean *c)
{
	struct stance s = { .model = c->model };
	eco_components_find(&s.components, c->model, c->place, false);
	s.wood = eco_alloc(s.components.count + 1u, sizeof *s.wood);
	enum eco_code code = stand(&s, c);
	eco_components_free(&s.components);
	free(s.wood);
	return code;
}
