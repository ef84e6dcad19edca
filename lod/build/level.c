#include "lod/build/level.h"

#include <string.h>

#include <meshoptimizer.h>

#include "lod/sort.h"

#define PAYS 0.7                 /* a level has at most this share of the next one's triangles */
#define LEAST 96u                /* triangles of a level: with fewer, lines serve better */

/* Corners of triangles as a mesh for meshoptimizer: a vertex for each combination of place, texture
 * coordinates and component. */
struct wedges {
	uint32_t count;
	struct lod_corner *corner;
	float *position;             /* grid coordinates, exact in floats */
	uint32_t *index;
};

static void make_wedges(struct wedges *w, const struct lod_mesh *mesh, const uint32_t *triangles,
	uint32_t count, struct lod_arena *arena)
{
	uint32_t size = 16;
	while (size < 6 * (uint64_t)count)
		size *= 2;
	uint32_t *table = lod_arena_take(arena, size, sizeof *table);
	memset(table, 0xff, size * sizeof *table);
	w->count = 0;
	w->corner = lod_arena_take(arena, 3 * (size_t)count, sizeof *w->corner);
	w->position = lod_arena_take(arena, 9 * (size_t)count, sizeof *w->position);
	w->index = lod_arena_take(arena, 3 * (size_t)count, sizeof *w->index);
	for (uint32_t i = 0; i < 3 * count; i++) {
		uint32_t t = triangles[i / 3];
		const int32_t *uv = mesh->uv + 6 * (size_t)t + 2 * (i % 3);
		struct lod_corner c = { mesh->index[3 * (size_t)t + i % 3], mesh->component[t],
			{ uv[0], uv[1] } };
		uint64_t hash = lod_mix((uint64_t)(uint32_t)c.uv[0] << 32 | (uint32_t)c.uv[1]);
		uint32_t at = (uint32_t)lod_mix(c.vertex + lod_mix(c.component + hash)) & (size - 1);
		while (table[at] != ECO_NONE && memcmp(&w->corner[table[at]], &c, sizeof c))
			at = (at + 1) & (size - 1);
		if (table[at] == ECO_NONE) {
			table[at] = w->count;
			w->corner[w->count] = c;
			for (int a = 0; a < 3; a++)
				w->position[3 * (size_t)w->count + a] =
					(float)mesh->grid[3 * (size_t)c.vertex + a];
			w->count++;
		}
		w->index[i] = table[at];
	}
}

static bool has_area(const struct lod_mesh *mesh, const struct lod_corner *c)
{
	const int32_t *a = mesh->grid + 3 * (size_t)c[0].vertex;
	int64_t u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (int64_t)mesh->grid[3 * (size_t)c[1].vertex + k] - a[k];
		v[k] = (int64_t)mesh->grid[3 * (size_t)c[2].vertex + k] - a[k];
	}
	return u[1] * v[2] != u[2] * v[1] || u[2] * v[0] != u[0] * v[2] || u[0] * v[1] != u[1] * v[0];
}

/* Simplifies a part to 1 / divisor of its triangles and appends those with area to `out`, which has room for
 * all. */
static uint32_t simplify(struct lod_corner *out, const struct lod_mesh *mesh, const struct lod_levels_part *part,
	uint32_t divisor, struct lod_arena *arena)
{
	if (part->count == 0)
		return 0;
	struct lod_arena_piece *mark = arena->last;
	struct wedges w;
	uint32_t kept = 0;
	make_wedges(&w, mesh, part->triangle, part->count, arena);
	unsigned int *simple = lod_arena_take(arena, 3 * (size_t)part->count, sizeof *simple);
	float extent = meshopt_simplifyScale(w.position, w.count, 3 * sizeof(float));
	float error = extent > 0 ? (float)(part->reach / mesh->step / extent) : 1;
	size_t indices = meshopt_simplify(simple, w.index, 3 * (size_t)part->count, w.position, w.count,
		3 * sizeof(float), 3 * (size_t)(part->count / divisor), error,
		part->keep_border ? meshopt_SimplifyLockBorder : 0, NULL);
	for (size_t i = 0; i + 2 < indices; i += 3) {
		struct lod_corner c[3] = { w.corner[simple[i]], w.corner[simple[i + 1]],
			w.corner[simple[i + 2]] };
		if (!has_area(mesh, c))
			continue;
		memcpy(out + 3 * (size_t)kept, c, sizeof c);
		kept++;
	}
	lod_arena_release(arena, mark);
	return kept;
}

void lod_levels_make(struct lod_levels *levels, const struct lod_mesh *mesh,
	const struct lod_levels_part *parts, uint32_t part_count, struct lod_arena *arena)
{
	static const uint32_t divisors[LOD_LEVELS_SIMPLE] = { 16, 4 };
	uint32_t finer = 0;
	struct { struct lod_corner *corner; uint32_t count; } made[LOD_LEVELS_SIMPLE] = { { NULL, 0 } };
	bool pays[LOD_LEVELS_SIMPLE];
	*levels = (struct lod_levels){ 0 };
	for (uint32_t p = 0; p < part_count; p++)
		finer += parts[p].count;
	for (uint32_t i = 0; i < LOD_LEVELS_SIMPLE; i++) {
		made[i].corner = lod_arena_take(arena, 3 * (size_t)finer, sizeof *made[i].corner);
		for (uint32_t p = 0; p < part_count; p++)
			made[i].count += simplify(made[i].corner + 3 * (size_t)made[i].count, mesh, &parts[p],
				divisors[i], arena);
	}
	for (uint32_t i = LOD_LEVELS_SIMPLE; i-- > 0;) {
		pays[i] = made[i].count >= LEAST && made[i].count <= PAYS * finer;
		finer = pays[i] ? made[i].count : finer;
	}
	for (uint32_t i = 0; i < LOD_LEVELS_SIMPLE; i++) {
		if (!pays[i])
			continue;
		levels->triangle_count[levels->count] = made[i].count;
		levels->corner[levels->count++] = made[i].corner;
	}
}
