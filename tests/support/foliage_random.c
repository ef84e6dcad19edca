#include "tests/support/foliage_random.h"

double foliage_dice(uint64_t *state)
{
	return 2 * eco_random_unit(*state = lod_mix(*state)) - 1;
}

static struct lod_v3 foliage_direction(uint64_t *state)
{
	struct lod_v3 d = { 0, 0, 0 };
	while (!(lod_v3_length(d) > 0.1) || lod_v3_length(d) > 1)
		d = (struct lod_v3){ foliage_dice(state), foliage_dice(state), foliage_dice(state) };
	return d;
}

static void foliage_leaf(struct lod_foliage *f, uint32_t i, struct lod_v3 at, struct lod_v3 along,
	struct lod_v3 across, uint32_t corners)
{
	static const double shape[6][2] = { { -1, 0 }, { -0.5, -0.4 }, { 0.5, -0.4 }, { 1, 0 }, { 0.5, 0.4 },
		{ -0.5, 0.4 } };
	f->first[i + 1] = f->first[i] + corners;
	f->triangle_first[i + 1] = f->triangle_first[i] + corners - 2;
	for (uint32_t k = 0; k < corners; k++) {
		const double *s = shape[k * 6 / corners];
		struct lod_v3 p =
			lod_v3_add(at, lod_v3_add(lod_v3_scale(along, s[0]), lod_v3_scale(across, s[1])));
		float *to = f->corner[f->first[i] + k];
		to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z;
		f->low = (struct lod_v3){ fmin(f->low.x, p.x), fmin(f->low.y, p.y), fmin(f->low.z, p.z) };
		f->high = (struct lod_v3){ fmax(f->high.x, p.x), fmax(f->high.y, p.y), fmax(f->high.z, p.z) };
	}
	f->center[i] = at;
	f->normal[i] = lod_v3_cross(along, across);
	f->area[i] = lod_v3_length(f->normal[i]);
}

void foliage_random(struct lod_foliage *f, const struct foliage_random *how, struct lod_arena *arena)
{
	uint64_t dice = how->seed;
	size_t n = how->leaves;
	*f = (struct lod_foliage){ .count = how->leaves, .group_count = 1, .wood_count = 1 };
	f->first = lod_arena_take(arena, n + 1, sizeof *f->first);
	f->triangle_first = lod_arena_take(arena, n + 1, sizeof *f->triangle_first);
	f->corner = lod_arena_take(arena, n * how->corners, sizeof *f->corner);
	f->uv = lod_arena_take(arena, n * how->corners, sizeof *f->uv);
	f->cutout = lod_arena_take(arena, n, sizeof *f->cutout);
	f->group = lod_arena_take(arena, n, sizeof *f->group);
	f->center = lod_arena_take(arena, n, sizeof *f->center);
	f->normal = lod_arena_take(arena, n, sizeof *f->normal);
	f->area = lod_arena_take(arena, n, sizeof *f->area);
	f->wood = lod_arena_take(arena, 9, sizeof *f->wood);
	f->wood[3] = 0.05f;
	f->wood[8] = (float)-how->radius;
	f->low.z = -how->radius;
	for (uint32_t i = 0; i < how->leaves; i++) {
		struct lod_v3 along = lod_v3_scale(lod_v3_unit(foliage_direction(&dice)), how->leaf);
		struct lod_v3 across =
			lod_v3_scale(lod_v3_unit(lod_v3_cross(along, foliage_direction(&dice))), how->leaf);
		foliage_leaf(f, i, lod_v3_scale(foliage_direction(&dice), how->radius), along, across,
			how->corners);
	}
}
