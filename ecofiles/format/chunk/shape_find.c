/* Finds equal shapes among elements, and their placings. A shape is taken from one element. Another
 * element has it if the linear map that best takes the first's corners to the second's is a rotation times
 * lengths of axes, up to the rounding of both. Rounding affects large elements less, so they come first
 * and become the shapes.
 *
 * The axes along which leaves stretch cannot be seen in one leaf, but in two of different proportions:
 * they are the singular vectors of the map from one to the other. So some pairs are tried, and the axes
 * kept with which most leaves have one shape.
 *
 * An element is stored as a placed shape if placing it, with all values rounded, puts every corner near
 * enough; where a corner is too far off, values are moved by one step as long as that helps. Longer than
 * 600 lines: one search, whose steps share its state. */
#include "ecofiles/format/chunk/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"

#define FLAT 1e-3                /* a shape is flat if its corners are nearer to a plane, in radii */
#define WAYS_FINE 2.0            /* a direction's square is at most about so many 2^-way_bits wide */
#define MOVES_MAX 24

/* ---- Vectors ---- */

typedef double vector[3];

static double dot(const vector a, const vector b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const vector a, const vector b, vector c)
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

static bool make_unit(vector v)
{
	double length = sqrt(dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length > 0 ? length : 1;
	return length > 0;
}

static int32_t nearest(double v)
{
	return (int32_t)floor(v + 0.5);
}

/* The furthest that rounding to the list's grid moves a corner, along an axis, and squared. */
static const double half = 0.5 * (1u << ECO_EXACT_SHIFT);
static const double room = 0.75 * (1u << 2 * ECO_EXACT_SHIFT);

/* ---- Elements and models of shapes ---- */

struct body { vector center, corner[ECO_CORNERS_MAX]; double radius; };      /* corners from the centre */

static bool body_of(struct body *b, const int32_t *exact, uint32_t corners)
{
	double sum = 0;
	memset(b, 0, sizeof *b);
	for (uint32_t k = 0; k < corners; k++)
		for (int i = 0; i < 3; i++)
			b->center[i] += (double)exact[3 * k + (uint32_t)i] / corners;
	for (uint32_t k = 0; k < corners; k++) {
		for (int i = 0; i < 3; i++)
			b->corner[k][i] = exact[3 * k + (uint32_t)i] - b->center[i];
		sum += dot(b->corner[k], b->corner[k]);
	}
	b->radius = sqrt(sum / corners);
	return b->radius >= 1;
}

/* A shape's corners, and weights that give the nearest linear map from them to another element's corners. */
struct model {
	uint32_t corners;
	bool flat;
	vector corner[ECO_CORNERS_MAX];
	vector weight[ECO_CORNERS_MAX];      /* map = sum of corner * weight: images of x, y, z */
	double span[3];                      /* sum of squares along each axis */
};

/* Inverse of the matrix of second moments, times corners; for flat shapes in x and y alone. False: corners
 * on a line. */
static bool model_make(struct model *m)
{
	double s[3][3] = { { 0 } };
	for (uint32_t k = 0; k < m->corners; k++)
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				s[i][j] += m->corner[k][i] * m->corner[k][j];
	for (int i = 0; i < 3; i++)
		m->span[i] = s[i][i];
	m->flat = s[2][2] < FLAT * FLAT * (s[0][0] + s[1][1]);
	if (m->flat) {
		s[0][2] = s[1][2] = s[2][0] = s[2][1] = 0;
		s[2][2] = 1;
	}
	vector c[3];
	for (int i = 0; i < 3; i++)
		cross(s[(i + 1) % 3], s[(i + 2) % 3], c[i]);
	double det = dot(s[0], c[0]);
	if (!(det > 1e-12 * s[0][0] * s[0][0] * s[2][2]))
		return false;
	for (uint32_t k = 0; k < m->corners; k++) {
		for (int i = 0; i < 3; i++)
			m->weight[k][i] = dot(c[i], m->corner[k]) / det;
		if (m->flat)
			m->weight[k][2] = 0;
	}
	return true;
}

static bool model_of(struct model *m, const struct eco_shape *shape)
{
	m->corners = shape->corners;
	for (uint32_t k = 0; k < m->corners; k++)
		for (uint32_t i = 0; i < 3; i++)
			m->corner[k][i] = (double)shape->position[3 * k + i] / ECO_SHAPE_ONE;
	return model_make(m);
}

/* map[j]: the image of the model's axis j. */
static void map_to(const struct model *m, const struct body *b, vector map[3])
{
	memset(map, 0, 3 * sizeof(vector));
	for (uint32_t k = 0; k < m->corners; k++)
		for (int j = 0; j < 3; j++)
			for (int i = 0; i < 3; i++)
				map[j][i] += b->corner[k][i] * m->weight[k][j];
	if (m->flat)
		cross(map[0], map[1], map[2]);
}

/* ---- Poses ---- */

/* About the nearest pose to the map: the axis that matters most keeps its direction. `misfit`: greatest
 * squared distance of a corner from its place. */
static bool pose_of(const struct model *m, const struct body *b, uint8_t stretch, struct eco_pose *p,
	double *misfit)
{
	vector map[3];
	map_to(m, b, map);
	int first = m->span[1] > m->span[0] ? 1 : 0, second = 1 - first;
	memcpy(p->axis[first], map[first], sizeof(vector));
	if (!make_unit(p->axis[first]))
		return false;
	double along = dot(map[second], p->axis[first]);
	for (int i = 0; i < 3; i++)
		p->axis[second][i] = map[second][i] - along * p->axis[first][i];
	if (!make_unit(p->axis[second]))
		return false;
	cross(p->axis[0], p->axis[1], p->axis[2]);
	for (int j = 0; j < 3; j++)
		p->size[j] = dot(map[j], p->axis[j]);
	double xx = m->span[0] * p->size[0], yy = m->span[1] * p->size[1],
		zz = m->flat ? 0 : m->span[2] * p->size[2];
	double z = m->flat ? 0 : m->span[2];
	if (stretch == ECO_STRETCH_NONE)
		p->size[0] = p->size[1] = p->size[2] = (xx + yy + zz) / (m->span[0] + m->span[1] + z);
	else if (stretch == ECO_STRETCH_WIDTH)
		p->size[0] = p->size[2] = (xx + zz) / (m->span[0] + z);
	else if (stretch == ECO_STRETCH_LENGTH)
		p->size[1] = p->size[2] = (yy + zz) / (m->span[1] + z);
	else if (m->flat)
		p->size[2] = 0;
	*misfit = 0;
	for (uint32_t k = 0; k < m->corners; k++) {
		double d2 = 0;
		for (int i = 0; i < 3; i++) {
			double d = b->corner[k][i];
			for (int j = 0; j < 3; j++)
				d -= p->axis[j][i] * p->size[j] * m->corner[k][j];
			d2 += d * d;
		}
		*misfit = fmax(*misfit, d2);
	}
	return true;
}

/* ---- Fitting ---- */

static int32_t clamp(int32_t v, int32_t most)
{
	return v < 0 ? 0 : v > most ? most : v;
}

static void round_way(const struct eco_shapes *s, const vector x, int32_t way[2])
{
	double sum = fabs(x[0]) + fabs(x[1]) + fabs(x[2]), u = x[0] / sum, v = x[1] / sum;
	if (x[2] < 0) {
		double folded = copysign(1 - fabs(v), u);
		v = copysign(1 - fabs(u), v);
		u = folded;
	}
	way[0] = clamp((int32_t)floor(ldexp(u + 1, s->way_bits)), (2 << s->way_bits) - 1);
	way[1] = clamp((int32_t)floor(ldexp(v + 1, s->way_bits)), (2 << s->way_bits) - 1);
}

/* The roll that brings y nearest to its place, given x's direction after rounding; as in shape.c, but in
 * floating point. */
static int32_t round_roll(const struct eco_shapes *s, const struct eco_placing *p, const vector y)
{
	double one = ldexp(1, s->way_bits + 1), u = 2.0 * p->way[0] + 1 - one, v = 2.0 * p->way[1] + 1 - one;
	vector x = { u, v, one - fabs(u) - fabs(v) }, level, up;
	if (x[2] < 0) {
		x[0] = copysign(one - fabs(v), u);
		x[1] = copysign(one - fabs(u), v);
	}
	make_unit(x);
	bool upright = x[0] == 0 && x[1] == 0;
	level[0] = upright ? 0 : -x[1];
	level[1] = upright ? 1 : x[0];
	level[2] = 0;
	make_unit(level);
	cross(x, level, up);
	double c = dot(y, level), sine = dot(y, up), sum = fabs(c) + fabs(sine);
	double turn = sum == 0 ? 0 : sine >= 0 ? 1 - c / sum : 3 + c / sum;
	return nearest(ldexp(turn, s->roll_bits)) & ((4 << s->roll_bits) - 1);
}

struct trial { const struct eco_shapes *shapes; const struct eco_shape *shape; const int32_t *exact; };

/* A placing with its axes and offsets. */
struct placed { struct eco_placing p; int64_t axis[3][3]; int32_t offset[3 * ECO_CORNERS_MAX]; };

/* The greatest squared distance of a corner from its place; INFINITY where that is not below `least`. */
static double miss_of(const struct trial *t, const struct placed *placed, double least)
{
	int32_t at[3 * ECO_CORNERS_MAX];
	double worst = 0;
	if (!eco_shape_place(t->shapes, &placed->p, placed->offset, t->shape->corners, at))
		return INFINITY;
	for (uint32_t k = 0; k < t->shape->corners; k++) {
		double d2 = 0;
		for (int i = 0; i < 3; i++) {
			double d = (double)at[3 * k + (uint32_t)i] - t->exact[3 * k + (uint32_t)i];
			d2 += d * d;
		}
		if (!(d2 < least))
			return INFINITY;
		worst = d2 > worst ? d2 : worst;
	}
	return worst;
}

/* The values of a placing: those from TURNS on move its axes, those from SIZES on only its offsets. */
enum { CENTER, TURNS = 3, SIZES = 6, VALUES = 9 };

static int32_t *value_of(struct eco_placing *p, int i)
{
	return i < TURNS ? &p->center[i] : i < TURNS + 2 ? &p->way[i - TURNS] : i < SIZES ? &p->roll
		: &p->size[i - SIZES];
}

/* Its miss after value i has changed. */
static double miss_after(const struct trial *t, struct placed *placed, int i, double least)
{
	if (i >= TURNS && i < SIZES && !eco_shape_axes(t->shapes, &placed->p, placed->axis))
		return INFINITY;
	if (i >= TURNS && !eco_shape_offset(t->shapes, t->shape, &placed->p, placed->axis, placed->offset))
		return INFINITY;
	return miss_of(t, placed, least);
}

/* While the worst corner is too far off, moves one value at a time by one step if that brings it nearer. */
static double improve(const struct trial *t, struct placed *placed, double miss)
{
	const int count = t->shapes->stretch == ECO_STRETCH_NONE ? SIZES + 1
		: t->shapes->stretch == ECO_STRETCH_ALL ? VALUES : SIZES + 2;
	for (int moves = 0; moves < MOVES_MAX && miss > room; moves++) {
		const struct placed from = *placed;
		for (int i = CENTER; i < count; i++)
			for (int step = -1; step <= 1; step += 2) {
				struct placed tried = from;
				*value_of(&tried.p, i) += step;
				double m = miss_after(t, &tried, i, miss);
				if (m < miss) {
					miss = m;
					*placed = tried;
				}
			}
		if (memcmp(&from.p, &placed->p, sizeof from.p) == 0)
			break;
	}
	return miss;
}

bool eco_shape_round(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact,
	const struct eco_pose *pose, struct eco_placing *p)
{
	const struct trial t = { shapes, shape, exact };
	struct placed placed = { .p = { .roll = 0 } };
	for (int i = 0; i < 3; i++) {
		double size = ldexp(pose->size[i], -shapes->size_shift[i]);
		if (!(fabs(size) <= ECO_SHAPE_SIZE_MAX))
			return false;
		placed.p.size[i] = nearest(size);
		placed.p.center[i] = nearest(ldexp(pose->center[i], -shapes->place_shift));
	}
	if (shapes->stretch == ECO_STRETCH_NONE)
		placed.p.size[1] = placed.p.size[2] = 0;
	else if (shapes->stretch != ECO_STRETCH_ALL)
		placed.p.size[2] = 0;
	round_way(shapes, pose->axis[0], placed.p.way);
	placed.p.roll = round_roll(shapes, &placed.p, pose->axis[1]);
	double miss = improve(&t, &placed, miss_after(&t, &placed, TURNS, INFINITY));
	*p = placed.p;
	return miss <= room;
}

bool eco_shape_pose(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact,
	struct eco_pose *pose)
{
	struct model m;
	struct body b;
	double misfit;
	if (!model_of(&m, shape) || !body_of(&b, exact, m.corners)
			|| !pose_of(&m, &b, shapes->stretch, pose, &misfit) || misfit > room)
		return false;
	memcpy(pose->center, b.center, sizeof pose->center);
	return true;
}

bool eco_shape_fit(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact,
	struct eco_placing *placing)
{
	struct eco_pose pose;
	return eco_shape_pose(shapes, shape, exact, &pose)
		&& eco_shape_round(shapes, shape, exact, &pose, placing);
}

/* ---- Axes ---- */

/* One rotation of Jacobi's method: entry (p, q) of a symmetric matrix becomes 0; the rows of `axis` turn
 * along. */
static void rotate(double g[3][3], vector axis[3], int p, int q)
{
	if (g[p][q] == 0)
		return;
	double theta = (g[q][q] - g[p][p]) / (2 * g[p][q]),
		t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
	double c = 1 / sqrt(t * t + 1), s = t * c;
	for (int i = 0; i < 3; i++) {
		double a = g[i][p], b = g[i][q];
		g[i][p] = c * a - s * b;
		g[i][q] = s * a + c * b;
	}
	for (int i = 0; i < 3; i++) {
		double a = g[p][i], b = g[q][i], u = axis[p][i], v = axis[q][i];
		g[p][i] = c * a - s * b;
		g[q][i] = s * a + c * b;
		axis[p][i] = c * u - s * v;
		axis[q][i] = s * u + c * v;
	}
}

static void axes_of_matrix(double g[3][3], bool flat, vector axis[3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			axis[i][j] = i == j;
	for (int sweep = 0; sweep < (flat ? 1 : 6); sweep++) {
		rotate(g, axis, 0, 1);
		if (!flat) {
			rotate(g, axis, 0, 2);
			rotate(g, axis, 1, 2);
		}
	}
}

/* Turns the model to its own axes: x the longest, z the shortest; a flat model keeps z. */
static void turn_model(struct model *m, vector axis[3])
{
	double span[3] = { 0 };
	for (uint32_t k = 0; k < m->corners; k++)
		for (int i = 0; i < 3; i++) {
			double v = dot(m->corner[k], axis[i]);
			span[i] += v * v;
		}
	int order[3] = { 0, 1, 2 };
	for (int i = 0; i < 3; i++)
		for (int j = 2; j > 0; j--)
			if (span[order[j]] > span[order[j - 1]]) {
				int o = order[j];
				order[j] = order[j - 1];
				order[j - 1] = o;
			}
	vector z;
	cross(axis[order[0]], axis[order[1]], z);
	for (uint32_t k = 0; k < m->corners; k++) {
		vector v = { dot(m->corner[k], axis[order[0]]), dot(m->corner[k], axis[order[1]]),
			dot(m->corner[k], z) };
		memcpy(m->corner[k], v, sizeof v);
	}
}

/* An element in its principal axes, of radius 1. */
static bool model_from(struct model *m, const struct body *b, uint32_t corners)
{
	double g[3][3] = { { 0 } };
	vector axis[3];
	m->corners = corners;
	for (uint32_t k = 0; k < corners; k++)
		for (int i = 0; i < 3; i++) {
			m->corner[k][i] = b->corner[k][i] / b->radius;
			for (int j = 0; j < 3; j++)
				g[i][j] += b->corner[k][i] * b->corner[k][j];
		}
	axes_of_matrix(g, false, axis);
	turn_model(m, axis);
	return model_make(m);
}

/* ---- Finding ---- */

struct finder {
	const struct eco_shapes_input *in;
	uint32_t count;
	struct body *bodies;
	uint32_t *by_size;           /* elements, the largest first, without those of size 0 */
	uint32_t sized;
	struct model *models;        /* of the shapes */
};

static uint8_t corners_of(const struct finder *f, uint32_t i)
{
	return f->in->elements->corners[f->in->first + i];
}

static const int32_t *uv_of(const struct finder *f, uint32_t i)
{
	return f->in->elements->uv ? f->in->elements->uv + 2 * f->in->at[i] : NULL;
}

static bool same_skin(const struct finder *f, uint32_t a, uint32_t b)
{
	return corners_of(f, a) == corners_of(f, b)
		&& (!uv_of(f, a) || memcmp(uv_of(f, a), uv_of(f, b), 2 * sizeof(int32_t) * corners_of(f, a))
		== 0);
}

static bool is_of(const struct finder *f, const struct model *m, uint8_t stretch, uint32_t i)
{
	struct eco_pose pose;
	double misfit;
	return pose_of(m, &f->bodies[i], stretch, &pose, &misfit) && misfit <= room / 4;
}

#define ASKED_MAX 6
#define TRIED_MAX 20

/* Picks elements that may have the shape of the element at `place` (in by_size), spread over those after
 * it. */
static uint32_t find_alike(const struct finder *f, uint32_t place, uint32_t alike[TRIED_MAX])
{
	uint32_t count = 0, step = (f->sized - place) / (2 * TRIED_MAX) + 1;
	for (uint32_t i = place + 1; i < f->sized && count < TRIED_MAX; i += step)
		if (same_skin(f, f->by_size[place], f->by_size[i]))
			alike[count++] = f->by_size[i];
	return count;
}

/* Turns the model to the axes whose stretching makes it equal to the most other elements. */
static void choose_axes(const struct finder *f, struct model *m, uint8_t stretch, uint32_t place)
{
	uint32_t alike[TRIED_MAX], count = find_alike(f, place, alike), most = 0;
	struct model best = *m;
	for (uint32_t a = 0; a <= count && a <= ASKED_MAX; a++) {
		struct model turned = *m;
		uint32_t good = 0;
		if (a > 0) {
			vector map[3], axis[3];
			double g[3][3];
			map_to(m, &f->bodies[alike[a - 1]], map);
			for (int i = 0; i < 3; i++)
				for (int j = 0; j < 3; j++)
					g[i][j] = dot(map[i], map[j]);
			axes_of_matrix(g, m->flat, axis);
			turn_model(&turned, axis);
			if (!model_make(&turned))
				continue;
		}
		for (uint32_t i = 0; i < count; i++)
			good += is_of(f, &turned, stretch, alike[i]);
		if (good > most) {
			most = good;
			best = turned;
		}
	}
	*m = best;
}

/* Rounds coordinates to steps that move no corner by more than half a step of the grid. */
static void shape_from(struct eco_shape *s, const struct model *m, double radius, const int32_t *uv)
{
	int shift = 0;
	while (shift < 9 && ldexp(radius, shift + 1) <= ECO_SHAPE_ONE)
		shift++;
	*s = (struct eco_shape){ .corners = (uint8_t)m->corners };
	for (uint32_t k = 0; k < m->corners; k++)
		for (uint32_t i = 0; i < 3; i++)
			s->position[3 * k + i] = m->flat && i == 2 ? 0
				: nearest(m->corner[k][i] * ldexp(ECO_SHAPE_ONE, -shift)) * (1 << shift);
	if (uv)
		memcpy(s->uv, uv, 2 * sizeof *uv * m->corners);
}

static uint32_t match(const struct finder *f, struct eco_shapes *shapes, uint32_t place, uint32_t found)
{
	uint32_t i = f->by_size[place], s = 0;
	const int32_t *uv = uv_of(f, i);
	while (s < shapes->count && (shapes->items[s].corners != corners_of(f, i)
			|| (uv && memcmp(shapes->items[s].uv, uv, 2 * sizeof *uv * corners_of(f, i)) != 0)
			|| !is_of(f, &f->models[s], shapes->stretch, i)))
		s++;
	if (s < shapes->count)
		return s;
	struct model m;
	/* where little repeats, more shapes would not help */
	if (s == ECO_SHAPES_MAX || s > 12 + found || !model_from(&m, &f->bodies[i], corners_of(f, i)))
		return ECO_SHAPE_NONE;
	if (shapes->stretch != ECO_STRETCH_NONE)
		choose_axes(f, &m, shapes->stretch, place);
	shape_from(&shapes->items[s], &m, f->bodies[i].radius, uv);
	if (!model_of(&f->models[s], &shapes->items[s]))
		return ECO_SHAPE_NONE;
	shapes->count++;
	return s;
}

uint32_t eco_shapes_keep(struct eco_shapes *shapes, uint32_t *of, uint32_t count, uint32_t uses)
{
	uint32_t used[ECO_SHAPES_MAX] = { 0 }, number[ECO_SHAPES_MAX], kept = 0, having = 0;
	for (uint32_t i = 0; i < count; i++)
		if (of[i] != ECO_SHAPE_NONE)
			used[of[i]]++;
	for (uint32_t s = 0; s < shapes->count; s++) {
		number[s] = used[s] >= uses ? kept : ECO_SHAPE_NONE;
		if (used[s] >= uses) {
			having += used[s];
			shapes->items[kept++] = shapes->items[s];
		}
	}
	for (uint32_t i = 0; i < count; i++)
		of[i] = of[i] == ECO_SHAPE_NONE ? ECO_SHAPE_NONE : number[of[i]];
	shapes->count = kept;
	return having;
}

/* About the gain, in leaves that cost nothing: each stored length takes something, and a shape as much as
 * a leaf. */
static double find_with(const struct finder *f, struct eco_shapes *shapes, uint8_t stretch, uint32_t uses,
	uint32_t *of)
{
	static const double share[] = { 0.4, 0.36, 0.36, 0.3 };
	uint32_t found = 0;
	shapes->stretch = stretch;
	shapes->count = 0;
	for (uint32_t i = 0; i < f->count; i++)
		of[i] = ECO_SHAPE_NONE;
	for (uint32_t place = 0; place < f->sized; place++) {
		uint32_t before = shapes->count, s = match(f, shapes, place, found);
		of[f->by_size[place]] = s;
		found += s != ECO_SHAPE_NONE && shapes->count == before;
	}
	uint32_t having = eco_shapes_keep(shapes, of, f->count, uses);
	return share[stretch] * having - 0.7 * shapes->count;
}

struct by_radius { double radius; uint32_t element; };

ECO_ORDER_FALLING_TWO(compare_radius, struct by_radius, ->radius, ->element)

static void measure(struct finder *f)
{
	struct by_radius *by = eco_alloc(f->count, sizeof *by);
	for (uint32_t i = 0; i < f->count; i++)
		if (body_of(&f->bodies[i], f->in->elements->exact + 3 * f->in->at[i], corners_of(f, i)))
			by[f->sized++] = (struct by_radius){ f->bodies[i].radius, i };
	qsort(by, f->sized, sizeof *by, compare_radius);
	for (uint32_t i = 0; i < f->sized; i++)
		f->by_size[i] = by[i].element;
	free(by);
}

static void finest_steps(const struct finder *f, struct eco_shapes *s)
{
	double typical = f->sized ? f->bodies[f->by_size[f->sized / 8]].radius : 0;
	s->place_shift = ECO_EXACT_SHIFT - 1;
	for (int i = 0; i < 3; i++)
		s->size_shift[i] = ECO_EXACT_SHIFT - 1;
	s->way_bits = 1;
	while (s->way_bits < ECO_SHAPE_TURN_BITS_MAX && ldexp(typical * WAYS_FINE, -s->way_bits) > half)
		s->way_bits++;
	s->roll_bits = s->way_bits;
}

static void find(struct finder *f, struct eco_shapes *shapes, uint32_t uses, uint32_t *of)
{
	struct eco_shapes other = { .items = eco_alloc(ECO_SHAPES_MAX, sizeof *other.items) };
	uint32_t *other_of = eco_alloc(f->count, sizeof *other_of);
	double most = find_with(f, shapes, ECO_STRETCH_NONE, uses, of);
	for (uint8_t stretch = ECO_STRETCH_WIDTH; stretch <= ECO_STRETCH_ALL && most < 0.37 * f->sized; stretch++) {
		double gain = find_with(f, &other, stretch, uses, other_of);
		if (gain <= most)
			continue;
		most = gain;
		struct eco_shapes worse = *shapes;
		*shapes = other;
		other = worse;
		memcpy(of, other_of, f->count * sizeof *of);
	}
	free(other.items);
	free(other_of);
}

void eco_shapes_find(struct eco_shapes *shapes, const struct eco_shapes_input *in, uint32_t uses, uint32_t *of)
{
	struct finder f = { .in = in, .count = in->end - in->first };
	f.bodies = eco_alloc(f.count, sizeof *f.bodies);
	f.by_size = eco_alloc(f.count, sizeof *f.by_size);
	f.models = eco_alloc(ECO_SHAPES_MAX, sizeof *f.models);
	*shapes = (struct eco_shapes){ .items = eco_alloc(ECO_SHAPES_MAX, sizeof *shapes->items) };
	measure(&f);
	find(&f, shapes, uses, of);
	finest_steps(&f, shapes);
	eco_free(f.bodies, f.by_size, f.models);
}
