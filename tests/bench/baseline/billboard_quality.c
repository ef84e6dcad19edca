/* How well billboards stand for faces (Kratt 2014, 3.4). */
#include <math.h>

#include "lod/sort.h"
#include "tests/bench/baseline/billboard_state.h"

/* ---- Validity and coverage ---- */

double billboard_quad_distance(const struct billboard_quad *quad, struct lod_v3 point)
{
	struct lod_v3 d = lod_v3_sub(point, quad->center);
	double x = fabs(lod_v3_dot(d, quad->u)) - quad->width,
		y = fabs(lod_v3_dot(d, quad->v)) - quad->height, z = lod_v3_dot(d, quad->normal);
	x = x > 0 ? x : 0;
	y = y > 0 ? y : 0;
	return sqrt(x * x + y * y + z * z);
}

static double nearest_distance(const struct billboard_quad *quads, uint32_t count, struct lod_v3 point,
	uint32_t *which)
{
	double best = INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		double d = billboard_quad_distance(&quads[i], point);
		if (d < best) {
			best = d;
			*which = i;
		}
	}
	return best;
}

void billboard_face_judge(struct billboard_validity *result, const struct billboard_face *face,
	const struct billboard_quad *quads, uint32_t count, double epsilon)
{
	struct lod_v3 middle = lod_v3_scale(lod_v3_add(face->corner[0],
		lod_v3_add(face->corner[1], face->corner[2])), 1.0 / 3);
	uint32_t near = 0;
	*result = (struct billboard_validity){ .valid = true };
	for (int k = 0; k < 3; k++)
		if (!(nearest_distance(quads, count, face->corner[k], &near) <= epsilon))
			result->valid = false;
	nearest_distance(quads, count, middle, &result->nearest);
	result->projected = count ? face->area * fabs(lod_v3_dot(face->normal, quads[result->nearest].normal))
		: 0;
}

void billboard_coverage_of(struct billboard_coverage *sum, const struct billboard_face *const *faces,
	uint32_t face_count, const struct billboard_quad *quads, uint32_t count, double epsilon)
{
	*sum = (struct billboard_coverage){ 0 };
	for (uint32_t i = 0; i < face_count; i++) {
		struct billboard_validity v;
		billboard_face_judge(&v, faces[i], quads, count, epsilon);
		*(v.valid ? &sum->valid : &sum->invalid) += v.projected;
		sum->area += faces[i]->area;
		sum->area_invalid += v.valid ? 0 : faces[i]->area;
	}
}

double billboard_error(const struct billboard_coverage *c, double sigma)
{
	double error = c->area > 0 ? sigma * (1 - billboard_coverage_value(c) / c->area) : 0;
	return error > 0 ? error : 0;        /* sums may pass the area by their last digit */
}

/* ---- Occlusion ---- */

struct field {
	const struct lod_v3 *generators;
	double radius;
	uint32_t count;
	struct lod_keyed *items;             /* generators by cell */
};

static uint64_t key_of(const struct field *f, struct lod_v3 p, int dx, int dy, int dz)
{
	double at[3] = { floor(p.x / f->radius) + dx, floor(p.y / f->radius) + dy,
		floor(p.z / f->radius) + dz };
	uint64_t key = 0;
	for (int k = 0; k < 3; k++)
		key = key << 21 | (uint64_t)(at[k] + 1048576.0);
	return key;
}

static double density_at(const struct field *f, struct lod_v3 p)
{
	double sum = 0;
	/* a row of three cells lies together */
	for (int i = 0; i < 9; i++) {
		uint64_t from = key_of(f, p, i % 3 - 1, i / 3 - 1, -1),
			to = key_of(f, p, i % 3 - 1, i / 3 - 1, 1);
		uint32_t low = 0, high = f->count;
		while (low < high) {
			uint32_t middle = low + (high - low) / 2;
			if (f->items[middle].key < from)
				low = middle + 1;
			else
				high = middle;
		}
		for (; low < f->count && f->items[low].key <= to; low++) {
			struct lod_v3 d = lod_v3_sub(p, f->generators[f->items[low].value]);
			double share = lod_v3_dot(d, d) / (f->radius * f->radius);
			sum += share < 1 ? (1 - share) * (1 - share) : 0;
		}
	}
	return sum;
}

void billboard_density(double *density, const struct lod_v3 *generators, uint32_t count, double radius,
	struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	/* cells are numbered in 20 bits */
	struct field f = { generators, radius > 1e-4 ? radius : 1e-4, count,
		lod_arena_take(arena, count, sizeof *f.items) };
	for (uint32_t i = 0; i < count; i++)
		f.items[i] = (struct lod_keyed){ key_of(&f, generators[i], 0, 0, 0), i };
	lod_sort(arena, f.items, count);
	for (uint32_t i = 0; i < count; i++)         /* none hides itself */
		density[i] = density_at(&f, generators[i]) - 1;
	lod_arena_release(arena, mark);
}

double billboard_sigma(double density, double most)
{
	if (density <= 0 || !(most > 0))
		return 1;
	return density < most ? 1 - density / most : 0;
}
