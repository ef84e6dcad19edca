/* One pair of leaves: its cost, and the quad that takes its place (sections 3.1 and 3.2 of the paper). */
#include <string.h>

#include "tests/bench/baseline/leaf_collapse_state.h"

#define CORNERS_MAX (2 * ECO_CORNERS_MAX)
/* an axis shorter than that over the leaves' extent has no direction: corners are floats */
#define COINCIDENT 1e-6

/* ---- Cost ---- */

static double difference(double a, double b)
{
	return a + b > 0 ? fabs(a - b) / (a + b) : 0;
}

/* A leaf without area lies in every plane. */
static double angle_between(struct lod_v3 a, struct lod_v3 b)
{
	double length = lod_v3_length(a) * lod_v3_length(b);
	return length > 0 ? lod_arc_cosine(fabs(lod_v3_dot(a, b)) / length) : 0;
}

/* Terms that take a root or an angle come last: most candidates are out by the others. */
double lod_collapse_cost_below(const struct lod_collapse_node *a, const struct lod_collapse_node *b,
	const struct lod_collapse_crown *crown, const struct lod_collapse_options *options, double least)
{
	const double *weight = options->weight;
	double most = options->distance_most * crown->radius, apart = lod_v3_distance(a->center, b->center);
	if (apart > most)
		return INFINITY;
	if (options->leaves_most && (uint64_t)a->represents + b->represents > options->leaves_most)
		return INFINITY;
	double cost = weight[LOD_COLLAPSE_DISTANCE] * (most > 0 ? apart / most : 0)
		+ weight[LOD_COLLAPSE_LEAVES] * difference(a->represents, b->represents)
		+ weight[LOD_COLLAPSE_AREA] * difference(a->area, b->area);
	if (cost >= least)
		return cost;
	double x = (a->center.x + b->center.x) / 2 - crown->axis_x,
		y = (a->center.y + b->center.y) / 2 - crown->axis_y;
	double angle = angle_between(a->normal, b->normal);
	if (angle > options->angle_most_rad)
		return INFINITY;
	return cost + weight[LOD_COLLAPSE_INTERIORITY]
		* (crown->across > 0 ? sqrt(x * x + y * y) / crown->across : 0)
		+ weight[LOD_COLLAPSE_ANGLE] * angle / (LOD_PI / 2);
}

double lod_collapse_cost(const struct lod_collapse_node *a, const struct lod_collapse_node *b,
	const struct lod_collapse_crown *crown, const struct lod_collapse_options *options)
{
	return lod_collapse_cost_below(a, b, crown, options, INFINITY);
}

void lod_collapse_extent(struct lod_collapse_crown *crown, const struct lod_collapse_node *node,
	const struct lod_collapse_leaves *leaves)
{
	struct lod_v3 low = { 0, 0, 0 }, high = low;
	*crown = (struct lod_collapse_crown){ .axis_x = leaves->axis_x, .axis_y = leaves->axis_y };
	for (uint32_t i = 0; i < leaves->count; i++) {
		struct lod_v3 at = node[i].center;
		double x = at.x - crown->axis_x, y = at.y - crown->axis_y;
		low = i ? (struct lod_v3){ fmin(low.x, at.x), fmin(low.y, at.y), fmin(low.z, at.z) } : at;
		high = i ? (struct lod_v3){ fmax(high.x, at.x), fmax(high.y, at.y), fmax(high.z, at.z) } : at;
		crown->across = fmax(crown->across, sqrt(x * x + y * y));
	}
	crown->radius = lod_v3_distance(low, high) / 2;
}

/* ---- Leaves ---- */

static struct lod_v3 leaf_corner(const struct lod_collapse_leaves *leaves, uint32_t i, uint32_t k)
{
	return lod_v3_of(leaves->corner[leaves->first[i] + k]);
}

/* Half of the leaf's longest extent from its centre, and across it in the leaf's plane. */
static void find_axes(struct lod_collapse_node *node, const struct lod_collapse_leaves *leaves, uint32_t i)
{
	struct lod_v3 far = { 0, 0, 0 }, across;
	double wide = 0;
	uint32_t corners = leaves->first[i + 1] - leaves->first[i];
	for (uint32_t k = 0; k < corners; k++) {
		struct lod_v3 d = lod_v3_sub(leaf_corner(leaves, i, k), node->center);
		far = lod_v3_dot(d, d) > lod_v3_dot(far, far) ? d : far;
	}
	across = lod_v3_unit(lod_v3_cross(node->normal, far));
	for (uint32_t k = 0; k < corners; k++)
		wide = fmax(wide, fabs(lod_v3_dot(across,
			lod_v3_sub(leaf_corner(leaves, i, k), node->center))));
	node->half[0] = far;
	node->half[1] = lod_v3_scale(across, wide);
}

void lod_collapse_node_of(struct lod_collapse_node *node, const struct lod_collapse_leaves *leaves,
	uint32_t i)
{
	struct lod_v3 sum = { 0, 0, 0 }, first = leaf_corner(leaves, i, 0);
	uint32_t corners = leaves->first[i + 1] - leaves->first[i];
	*node = (struct lod_collapse_node){ .represents = 1, .child = { ECO_NONE, ECO_NONE },
		.parent = ECO_NONE };
	for (uint32_t k = 0; k < corners; k++)
		node->center = lod_v3_add(node->center,
			lod_v3_scale(leaf_corner(leaves, i, k), 1.0 / corners));
	for (uint32_t k = 1; k + 1 < corners; k++) {
		struct lod_v3 n = lod_v3_cross(lod_v3_sub(leaf_corner(leaves, i, k), first),
			lod_v3_sub(leaf_corner(leaves, i, k + 1), first));
		/* bent leaves: triangles add up, whichever way they are wound */
		n = lod_v3_dot(n, sum) < 0 ? lod_v3_scale(n, -1) : n;
		node->area += lod_v3_length(n) / 2;
		sum = lod_v3_add(sum, n);
	}
	node->normal = lod_v3_unit(sum);
	node->opaque_area = leaves->opaque_area ? leaves->opaque_area[i] : node->area;
	find_axes(node, leaves, i);
}

uint32_t lod_collapse_corners(const struct lod_collapse *collapse, const struct lod_collapse_leaves *leaves,
	uint32_t id, struct lod_v3 corner[ECO_CORNERS_MAX])
{
	static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
	const struct lod_collapse_node *node = &collapse->node[id];
	uint32_t count = id < collapse->leaves ? leaves->first[id + 1] - leaves->first[id] : 4;
	for (uint32_t k = 0; k < count; k++)
		corner[k] = id < collapse->leaves ? leaf_corner(leaves, id, k)
			: lod_v3_add(node->center, lod_v3_add(lod_v3_scale(node->half[0], sign[k][0]),
			lod_v3_scale(node->half[1], sign[k][1])));
	return count;
}

/* ---- The new quad ---- */

static struct lod_v3 in_plane(struct lod_v3 v, struct lod_v3 normal)
{
	return lod_v3_sub(v, lod_v3_scale(normal, lod_v3_dot(v, normal)));
}

/* Any direction in the plane. */
static struct lod_v3 some_axis(struct lod_v3 normal)
{
	struct lod_v3 other = fabs(normal.z) < 0.9 ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 };
	return lod_v3_unit(in_plane(other, normal));
}

/* The weighted mean of the normals; b's is turned to the side of a's first, as a leaf has no back. */
static struct lod_v3 mean_normal(const struct lod_collapse_node *a, const struct lod_collapse_node *b)
{
	double turn = lod_v3_dot(a->normal, b->normal) < 0 ? -1 : 1;
	struct lod_v3 sum = lod_v3_unit(lod_v3_add(lod_v3_scale(a->normal, a->represents),
		lod_v3_scale(b->normal, turn * b->represents)));
	return lod_v3_length(sum) > 0 ? sum : (struct lod_v3){ 0, 0, 1 };
}

/* The line through the projected centres; where they coincide, the larger leaf's own main axis. */
static struct lod_v3 main_axis(const struct lod_collapse_node *a, const struct lod_collapse_node *b,
	struct lod_v3 normal)
{
	const struct lod_collapse_node *larger = b->area > a->area ? b : a;
	double extent = lod_v3_length(a->half[0]) + lod_v3_length(b->half[0]);
	struct lod_v3 axis = in_plane(lod_v3_sub(b->center, a->center), normal);
	if (lod_v3_length(axis) > COINCIDENT * extent)
		return lod_v3_unit(axis);
	axis = in_plane(larger->half[0], normal);
	return lod_v3_length(axis) > COINCIDENT * extent ? lod_v3_unit(axis) : some_axis(normal);
}

/* Sides of the rectangle along both axes that encloses all corners projected onto their plane. */
static void enclose(double side[2], const struct lod_v3 *corner, uint32_t count, const struct lod_v3 axis[2])
{
	for (int a = 0; a < 2; a++) {
		double low = INFINITY, high = -INFINITY;
		for (uint32_t k = 0; k < count; k++) {
			double at = lod_v3_dot(corner[k], axis[a]);
			low = fmin(low, at);
			high = fmax(high, at);
		}
		side[a] = high - low;
	}
}

void lod_collapse_pair(struct lod_collapse *collapse, const struct lod_collapse_leaves *leaves, uint32_t a,
	uint32_t b)
{
	uint32_t id = collapse->leaves + collapse->made++;
	struct lod_collapse_node *node = &collapse->node[id], *one = &collapse->node[a],
		*two = &collapse->node[b];
	struct lod_v3 corner[CORNERS_MAX];
	double weight = (double)two->represents / ((double)one->represents + two->represents), side[2];
	*node = (struct lod_collapse_node){ .center = lod_v3_mix(one->center, two->center, weight),
		.normal = mean_normal(one, two), .opaque_area = one->opaque_area + two->opaque_area,
		.represents = one->represents + two->represents, .child = { a, b }, .parent = ECO_NONE };
	one->parent = two->parent = id;
	struct lod_v3 axis[2] = { main_axis(one, two, node->normal) };
	axis[1] = lod_v3_cross(node->normal, axis[0]);
	uint32_t count = lod_collapse_corners(collapse, leaves, a, corner);
	count += lod_collapse_corners(collapse, leaves, b, corner + count);
	enclose(side, corner, count, axis);
	double enclosing = side[0] * side[1];
	node->area = (one->area + two->area + enclosing) / 2;
	/* seen from the side both leaves are a line: the quad has their area as a square */
	double root = sqrt(node->area), grow = enclosing > 0 ? sqrt(node->area / enclosing) : 0;
	node->half[0] = lod_v3_scale(axis[0], (enclosing > 0 ? grow * side[0] : root) / 2);
	node->half[1] = lod_v3_scale(axis[1], (enclosing > 0 ? grow * side[1] : root) / 2);
}
