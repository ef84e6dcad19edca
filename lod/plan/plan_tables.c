/* Tables of a scene for planning: see lod/plan/plan_tables.h. */
#include "lod/plan/plan_tables.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define CELL_HALF 0.57735026918962576    /* of its sphere's radius: a cell is a cube */

struct lod_plan_tables {
	const struct eco_scene *scene;
	uint32_t *ladder_first, *ladder_order; /* per anchor, into the order; anchor_count + 1 */
	struct lod_proxy_shape *proxy_shapes;
	double ellipse;
	_Atomic(struct lod_plan_tables_ladder *) *ladders;
};

/* ---- Ladders of anchors ---- */

static bool is_whole(const struct lod_plan_tables *tables, uint32_t ladder)
{
	return tables->scene->ladders[ladder].flags & ECO_LADDER_WHOLE;
}

/* By anchor; at an anchor those of organs come first. */
static void sort_ladders(struct lod_plan_tables *tables)
{
	const struct eco_scene *scene = tables->scene;
	uint32_t *first = tables->ladder_first;
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		first[scene->ladders[i].anchor + 2]++;
	for (uint32_t i = 2; i <= scene->anchor_count + 1; i++)
		first[i] += first[i - 1];
	for (int whole = 0; whole < 2; whole++)
		for (uint32_t i = 0; i < scene->ladder_count; i++)
			if (is_whole(tables, i) == whole)
				tables->ladder_order[first[scene->ladders[i].anchor + 1]++] = i;
}

const uint32_t *lod_plan_tables_anchor(const struct lod_plan_tables *tables, uint32_t anchor, uint32_t *count)
{
	const uint32_t *ladders = tables->ladder_order + tables->ladder_first[anchor];
	*count = tables->ladder_first[anchor + 1] - tables->ladder_first[anchor];
	while (*count && is_whole(tables, ladders[*count - 1]))
		--*count;
	return ladders;
}

const uint32_t *lod_plan_tables_whole(const struct lod_plan_tables *tables, uint32_t anchor, uint32_t *count)
{
	uint32_t organs;
	const uint32_t *ladders = lod_plan_tables_anchor(tables, anchor, &organs);
	*count = tables->ladder_first[anchor + 1] - tables->ladder_first[anchor] - organs;
	return ladders + organs;
}

/* ---- Plants as proxy shapes ---- */

/* Area of leaves, or of all wood, at an anchor in full detail. */
static double anchor_area(const struct lod_plan_tables *tables, uint32_t anchor, bool wood)
{
	double area = 0;
	uint32_t count;
	const uint32_t *ladders = lod_plan_tables_anchor(tables, anchor, &count);
	for (uint32_t i = 0; i < count; i++)
		if ((tables->scene->ladders[ladders[i]].organ == ECO_ORGAN_WOOD) == wood)
			area += tables->scene->ladders[ladders[i]].area;
	return area;
}

/* The ellipse that has the moments of the cells' areas, each spread over its sphere. */
static void find_crown(const struct lod_plan_tables *tables, const struct eco_plant *plant,
	struct lod_proxy_shape *proxy_shape, bool wood)
{
	const struct eco_anchor *all = &tables->scene->anchors[plant->anchor_first];
	double sum = 0, mean = 0, up = 0, across = 0;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		double area = anchor_area(tables, plant->anchor_first + i, wood);
		sum += area;
		mean += area * ((double)all[i].center[2] - all->center[2]);
	}
	if (!(sum > 0))
		return;
	mean /= sum;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		const struct eco_anchor *cell = all + i;
		double area = anchor_area(tables, plant->anchor_first + i, wood),
			ball = (double)cell->radius * cell->radius / 5;
		double x = (double)cell->center[0] - all->center[0],
			y = (double)cell->center[1] - all->center[1];
		double z = (double)cell->center[2] - all->center[2] - mean;
		up += area * (z * z + ball);
		across += area * ((x * x + y * y) / 2 + ball);
	}
	proxy_shape->rise = mean;
	proxy_shape->crown_up = fmin(2 * sqrt(up / sum), proxy_shape->up);
	proxy_shape->crown_across = fmin(2 * sqrt(across / sum), proxy_shape->across);
}

/* Wood below the crown of leaves, as a cylinder; a cell's wood is spread over its height. */
static void find_stem(const struct lod_plan_tables *tables, const struct eco_plant *plant,
	struct lod_proxy_shape *shape)
{
	const struct eco_anchor *all = &tables->scene->anchors[plant->anchor_first];
	double to = shape->rise - shape->crown_up, height = to + shape->up, area = 0;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		double half = CELL_HALF * (double)all[i].radius, low = (double)all[i].center[2] - all->center[2] - half;
		area += half > 0 ? anchor_area(tables, plant->anchor_first + i, true)
			* fmax(0, fmin(1, (to - low) / (2 * half))) : 0;
	}
	shape->stem = height > LOD_STEM_LEAST * shape->up ? area / (2 * PI * height) : 0;
}

/* A plant's anchor is a sphere around it. Its cells say how wide it is and where its crown is; without cells
 * its height does. */
static struct lod_proxy_shape proxy_shape_of(const struct lod_plan_tables *tables,
	const struct eco_plant *plant)
{
	const struct eco_anchor *all = &tables->scene->anchors[plant->anchor_first];
	double r = all->radius, up = plant->height_m > 0 ? fmin(r, 0.5 * (double)plant->height_m) : r,
		across = 0;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		const struct eco_anchor *cell = all + i;
		double x = (double)cell->center[0] - all->center[0],
			y = (double)cell->center[1] - all->center[1];
		across = fmax(across, sqrt(x * x + y * y) + LOD_PLANT_CELL * cell->radius);
	}
	if (plant->anchor_count < 2)
		across = fmax(LOD_PLANT_NARROWEST * r, sqrt(fmax(0, r * r - up * up)));
	across = fmin(across, r);
	double leaves = anchor_area(tables, plant->anchor_first, false), wood = anchor_area(tables, plant->anchor_first, true),
		area = plant->area > 0 ? (double)plant->area : leaves + wood, least = LOD_PLANT_THINNEST * r * r;
	bool bare = !(leaves > 0);
	struct lod_proxy_shape proxy_shape = { across, up, fmax(area, least), fmax(bare ? area : leaves, least), across,
		up, 0, 0 };
	find_crown(tables, plant, &proxy_shape, bare);
	if (!bare)
		find_stem(tables, plant, &proxy_shape);
	return proxy_shape;
}

static void make_proxy_shapes(struct lod_plan_tables *tables)
{
	const struct eco_scene *scene = tables->scene;
	for (uint32_t i = 0; i < scene->plant_count; i++) {
		struct lod_proxy_shape *proxy_shape = &tables->proxy_shapes[i];
		*proxy_shape = proxy_shape_of(tables, &scene->plants[i]);
		tables->ellipse += PI * proxy_shape->crown_across * proxy_shape->crown_up / proxy_shape->area
			/ scene->plant_count;
	}
}

const struct lod_proxy_shape *lod_plan_tables_proxy_shapes(const struct lod_plan_tables *tables)
{
	return tables->proxy_shapes;
}
double lod_plan_tables_ellipse(const struct lod_plan_tables *tables) { return tables->ellipse; }

/* ---- Ladders ---- */

struct hulls {                       /* of one ladder, while they are made */
	struct lod_hull hull[2];
	struct lod_hull_point points[2][LOD_HULL_POINTS_MAX];
};

/* Keeps the points that are on the hull of some size and weight, and the last. */
static void keep_used(struct lod_hull *hull)
{
	double errors[LOD_HULL_POINTS_MAX];
	uint8_t on[LOD_HULL_POINTS_MAX];
	bool used[LOD_HULL_POINTS_MAX] = { false };
	uint32_t kept = 0;
	used[hull->count - 1] = true;
	for (uint32_t i = 0; i < 2 * ECO_SEEN_SIZES; i++) {
		for (uint32_t k = 0; k < hull->count; k++) {
			const struct lod_seen_error *seen = &hull->points[k].seen[i / 2];
			errors[k] = (double)seen->alike + (i % 2 ? 1 : LOD_OPEN_LEAST) * (double)seen->open;
		}
		uint32_t count = lod_hull_lower(hull->points, errors, hull->count, LOD_HULL_SLOPE_RATIO, on);
		for (uint32_t k = 0; k < count; k++)
			used[on[k]] = true;
	}
	for (uint32_t k = 0; k < hull->count; k++)
		if (used[k])
			hull->points[kept++] = hull->points[k];
	hull->count = kept;
}

static void make_hull(struct hulls *hulls, int beside, const struct lod_way *way, uint64_t from, uint64_t to)
{
	struct lod_hull *hull = &hulls->hull[beside];
	*hull = (struct lod_hull){ hulls->points[beside], 0, 1, 0, ECO_NONE };
	hull->count = lod_hull_sample(hull->points, way, from, to, hull->size);
	if (!(way->ladder->flags & ECO_LADDER_WHOLE))
		keep_used(hull);
}

static void hulls_of(const struct eco_scene *scene, const struct lod_way *way, struct hulls *hulls)
{
	const struct eco_ladder *ladder = way->ladder;
	const struct eco_plant *plant = &scene->plants[ladder->plant];
	bool coarse = plant->anchor_count > 1 && ladder->anchor == plant->anchor_first
		&& !(ladder->flags & ECO_LADDER_WHOLE);
	uint64_t end = coarse ? lod_way_stage_end(way) : way->full;
	make_hull(hulls, 0, way, 0, end);
	if (coarse && !(ladder->flags & ECO_LADDER_FAR))
		make_hull(hulls, 1, way, end, way->full);
}

/* In one allocation: the ladder, its legs, its hull points. */
static struct lod_plan_tables_ladder *make_ladder(const struct eco_scene *scene, uint32_t id)
{
	struct lod_way way;
	lod_way_begin(&way, scene, &scene->ladders[id]);
	size_t legs = lod_way_legs_bound(&way) * sizeof(struct lod_forms_leg), points = 0;
	struct lod_forms_leg *kept = malloc(legs + 1);
	struct hulls *hulls = calloc(1, sizeof *hulls);
	struct lod_plan_tables_ladder *made = NULL;
	if (kept && hulls) {
		lod_way_keep(&way, kept);
		hulls_of(scene, &way, hulls);
		legs = way.forms.leg_count * sizeof *kept;
		for (int i = 0; i < 2; i++)
			points += hulls->hull[i].count * sizeof(struct lod_hull_point);
		made = malloc(sizeof *made + legs + points);
	}
	if (made) {
		struct lod_forms_leg *leg = (struct lod_forms_leg *)(made + 1);
		struct lod_hull_point *next = (struct lod_hull_point *)((char *)leg + legs);
		if (legs)
			memcpy(leg, kept, legs);
		made->way = way;
		made->way.forms.legs = leg;
		memcpy(made->hull, hulls->hull, sizeof made->hull);
		for (int i = 0; i < 2; i++) {
			struct lod_hull *hull = &made->hull[i];
			if (hull->count)
				memcpy(next, hull->points, hull->count * sizeof *next);
			hull->points = next;
			next += hull->count;
		}
	}
	free(kept);
	free(hulls);
	return made;
}

const struct lod_plan_tables_ladder *lod_plan_tables_ladder(struct lod_plan_tables *tables, uint32_t ladder)
{
	struct lod_plan_tables_ladder *found = atomic_load_explicit(&tables->ladders[ladder],
		memory_order_acquire), *none = NULL;
	if (found || !(found = make_ladder(tables->scene, ladder)))
		return found;
	if (!atomic_compare_exchange_strong(&tables->ladders[ladder], &none, found)) {
		free(found);
		return none;
	}
	return found;
}

/* ---- All ---- */

enum eco_code lod_plan_tables_make(struct lod_plan_tables **made, const struct eco_scene *scene,
	struct eco_error *error)
{
	struct lod_plan_tables *tables = *made = calloc(1, sizeof *tables);
	size_t anchors = (size_t)scene->anchor_count + 2, ladders = (size_t)scene->ladder_count + 1,
		plants = (size_t)scene->plant_count + 1;
	if (tables) {
		tables->scene = scene;
		tables->ladder_first = calloc(anchors, sizeof *tables->ladder_first);
		tables->ladder_order = calloc(ladders, sizeof *tables->ladder_order);
		tables->proxy_shapes = calloc(plants, sizeof *tables->proxy_shapes);
		tables->ladders = calloc(ladders, sizeof *tables->ladders);
	}
	if (!tables || !tables->ladder_first || !tables->ladder_order || !tables->proxy_shapes
			|| !tables->ladders) {
		lod_plan_tables_free(tables);
		*made = NULL;
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for tables of %u ladders",
			scene->ladder_count);
	}
	sort_ladders(tables);
	make_proxy_shapes(tables);
	return ECO_OK;
}

void lod_plan_tables_free(struct lod_plan_tables *tables)
{
	if (!tables)
		return;
	for (uint32_t i = 0; tables->ladders && i < tables->scene->ladder_count; i++)
		free(tables->ladders[i]);
	free((void *)tables->ladders);
	free(tables->ladder_first);
	free(tables->ladder_order);
	free(tables->proxy_shapes);
	free(tables);
}
