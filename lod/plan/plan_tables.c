/* What planning needs of a scene: see lod/plan/plan_tables.h. */
#include "lod/plan/plan_tables.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define THINNEST 0.01            /* area of a plant over its radius squared: whatever has no area is still to be seen */

struct lod_tables {
	const struct eco_scene *scene;
	uint32_t *ladder_first, *ladder_order;               /* per anchor, into the order; anchor_count + 1 */
	struct lod_body *bodies;
	double ellipse;
	_Atomic(struct lod_tables_ladder *) *ladders;
	_Atomic size_t bytes;
};

/* ---- Ladders of anchors ---- */

static void sort_ladders(struct lod_tables *tables)
{
	const struct eco_scene *scene = tables->scene;
	uint32_t *first = tables->ladder_first;
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		first[scene->ladders[i].anchor + 2]++;
	for (uint32_t i = 2; i <= scene->anchor_count + 1; i++)
		first[i] += first[i - 1];
	for (uint32_t i = 0; i < scene->ladder_count; i++)
		tables->ladder_order[first[scene->ladders[i].anchor + 1]++] = i;
}

const uint32_t *lod_tables_anchor(const struct lod_tables *tables, uint32_t anchor, uint32_t *count)
{
	*count = tables->ladder_first[anchor + 1] - tables->ladder_first[anchor];
	return tables->ladder_order + tables->ladder_first[anchor];
}

/* ---- Plants as bodies ---- */

/* Area of what is drawn at an anchor in full detail. */
static double anchor_area(const struct lod_tables *tables, uint32_t anchor)
{
	double area = 0;
	for (uint32_t i = tables->ladder_first[anchor]; i < tables->ladder_first[anchor + 1]; i++)
		area += tables->scene->ladders[tables->ladder_order[i]].area;
	return area;
}

/* The ellipse that has the moments of the cells' areas, each spread over its sphere. */
static void find_crown(const struct lod_tables *tables, const struct eco_plant *plant, struct lod_body *body)
{
	const struct eco_anchor *all = &tables->scene->anchors[plant->anchor_first];
	double sum = 0, mean = 0, up = 0, across = 0;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		double area = anchor_area(tables, plant->anchor_first + i);
		sum += area;
		mean += area * ((double)all[i].center[2] - all->center[2]);
	}
	if (!(sum > 0))
		return;
	mean /= sum;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		const struct eco_anchor *cell = all + i;
		double area = anchor_area(tables, plant->anchor_first + i), ball = (double)cell->radius * cell->radius / 5;
		double x = (double)cell->center[0] - all->center[0], y = (double)cell->center[1] - all->center[1];
		double z = (double)cell->center[2] - all->center[2] - mean;
		up += area * (z * z + ball);
		across += area * ((x * x + y * y) / 2 + ball);
	}
	body->rise = mean;
	body->crown_up = fmin(2 * sqrt(up / sum), body->up);
	body->crown_across = fmin(2 * sqrt(across / sum), body->across);
}

/* A plant's anchor is a sphere around it; its cells, if it has any, tell how wide it is and where its crown is, else its height does. */
static struct lod_body body_of(const struct lod_tables *tables, const struct eco_plant *plant)
{
	const struct eco_anchor *all = &tables->scene->anchors[plant->anchor_first];
	double r = all->radius, up = plant->height_m > 0 ? fmin(r, 0.5 * (double)plant->height_m) : r, across = 0;
	for (uint32_t i = 1; i < plant->anchor_count; i++) {
		const struct eco_anchor *cell = all + i;
		double x = (double)cell->center[0] - all->center[0], y = (double)cell->center[1] - all->center[1];
		across = fmax(across, sqrt(x * x + y * y) + 0.6 * cell->radius);
	}
	if (plant->anchor_count < 2)
		across = fmax(0.5 * r, sqrt(fmax(0, r * r - up * up)));
	across = fmin(across, r);
	double area = plant->area > 0 ? (double)plant->area : anchor_area(tables, plant->anchor_first);
	struct lod_body body = { across, up, fmax(area, THINNEST * r * r), across, up, 0 };
	find_crown(tables, plant, &body);
	return body;
}

static void make_bodies(struct lod_tables *tables)
{
	const struct eco_scene *scene = tables->scene;
	for (uint32_t i = 0; i < scene->plant_count; i++) {
		struct lod_body *body = &tables->bodies[i];
		*body = body_of(tables, &scene->plants[i]);
		tables->ellipse += PI * body->crown_across * body->crown_up / body->area / scene->plant_count;
	}
}

const struct lod_body *lod_tables_bodies(const struct lod_tables *tables) { return tables->bodies; }
double lod_tables_ellipse(const struct lod_tables *tables) { return tables->ellipse; }

/* ---- Ladders ---- */

struct hulls {                       /* of one ladder, while they are made */
	struct lod_steps steps[2];
	struct lod_amount amounts[2][LOD_STEPS_MAX];
};

static void make_hull(struct hulls *hulls, int beside, const struct lod_way *way, uint64_t from, uint64_t to)
{
	struct lod_steps *steps = &hulls->steps[beside];
	*steps = (struct lod_steps){ hulls->amounts[beside], 0, LOD_EXTRA_LEAST };
	steps->count = lod_steps_sample(steps->amounts, way, from, to);
	lod_steps_hull(steps, LOD_STEPS_SPREAD);
	steps->extra = 1;
	lod_steps_hull(steps, LOD_STEPS_SPREAD);
	lod_steps_complete(steps, to);
}

static void hulls_of(const struct eco_scene *scene, const struct lod_way *way, struct hulls *hulls)
{
	const struct eco_ladder *ladder = way->ladder;
	const struct eco_plant *plant = &scene->plants[ladder->plant];
	bool coarse = plant->anchor_count > 1 && ladder->anchor == plant->anchor_first;
	uint64_t end = coarse ? lod_way_stage_end(way) : way->full;
	make_hull(hulls, 0, way, 0, end);
	if (coarse && !(ladder->flags & ECO_LADDER_FAR))
		make_hull(hulls, 1, way, end, way->full);
}

/* One piece of memory: the ladder, its legs, its amounts. */
static struct lod_tables_ladder *make_ladder(const struct eco_scene *scene, uint32_t id, size_t *bytes)
{
	struct lod_way way;
	lod_way_begin(&way, scene, &scene->ladders[id]);
	size_t legs = lod_way_legs_bound(&way) * sizeof(struct lod_forms_leg), amounts = 0;
	struct lod_forms_leg *kept = malloc(legs + 1);
	struct hulls *hulls = calloc(1, sizeof *hulls);
	struct lod_tables_ladder *made = NULL;
	if (kept && hulls) {
		lod_way_keep(&way, kept);
		hulls_of(scene, &way, hulls);
		legs = way.forms.leg_count * sizeof *kept;
		for (int i = 0; i < 2; i++)
			amounts += hulls->steps[i].count * sizeof(struct lod_amount);
		made = malloc(*bytes = sizeof *made + legs + amounts);
	}
	if (made) {
		struct lod_forms_leg *leg = (struct lod_forms_leg *)(made + 1);
		struct lod_amount *next = (struct lod_amount *)((char *)leg + legs);
		if (legs)
			memcpy(leg, kept, legs);
		made->way = way;
		made->way.forms.legs = leg;
		memcpy(made->steps, hulls->steps, sizeof made->steps);
		for (int i = 0; i < 2; i++) {
			struct lod_steps *steps = &made->steps[i];
			if (steps->count)
				memcpy(next, steps->amounts, steps->count * sizeof *next);
			steps->amounts = next;
			next += steps->count;
		}
	}
	free(kept);
	free(hulls);
	return made;
}

const struct lod_tables_ladder *lod_tables_ladder(struct lod_tables *tables, uint32_t ladder)
{
	struct lod_tables_ladder *found = atomic_load_explicit(&tables->ladders[ladder], memory_order_acquire), *none = NULL;
	size_t bytes = 0;
	if (found || !(found = make_ladder(tables->scene, ladder, &bytes)))
		return found;
	if (!atomic_compare_exchange_strong(&tables->ladders[ladder], &none, found)) {
		free(found);
		return none;
	}
	tables->bytes += bytes;
	return found;
}

/* ---- All ---- */

enum eco_code lod_tables_make(struct lod_tables **made, const struct eco_scene *scene, struct eco_error *error)
{
	struct lod_tables *tables = *made = calloc(1, sizeof *tables);
	size_t anchors = (size_t)scene->anchor_count + 2, ladders = (size_t)scene->ladder_count + 1, plants = (size_t)scene->plant_count + 1;
	if (tables) {
		tables->scene = scene;
		tables->ladder_first = calloc(anchors, sizeof *tables->ladder_first);
		tables->ladder_order = calloc(ladders, sizeof *tables->ladder_order);
		tables->bodies = calloc(plants, sizeof *tables->bodies);
		tables->ladders = calloc(ladders, sizeof *tables->ladders);
		tables->bytes = sizeof *tables + anchors * sizeof *tables->ladder_first + plants * sizeof *tables->bodies
			+ ladders * (sizeof *tables->ladder_order + sizeof *tables->ladders);
	}
	if (!tables || !tables->ladder_first || !tables->ladder_order || !tables->bodies || !tables->ladders) {
		lod_tables_free(tables);
		*made = NULL;
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for tables of %u ladders", scene->ladder_count);
	}
	sort_ladders(tables);
	make_bodies(tables);
	return ECO_OK;
}

void lod_tables_free(struct lod_tables *tables)
{
	if (!tables)
		return;
	for (uint32_t i = 0; tables->ladders && i < tables->scene->ladder_count; i++)
		free(tables->ladders[i]);
	free((void *)tables->ladders);
	free(tables->ladder_first);
	free(tables->ladder_order);
	free(tables->bodies);
	free(tables);
}

size_t lod_tables_bytes(const struct lod_tables *tables) { return tables->bytes; }
