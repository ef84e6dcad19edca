/* Ladders: vertices of an organ at an anchor -> cuts. The stages, in ascending vertices (struct eco_ladder):
 *
 *   points    p < 2k: the first p points; 2k <= p < 3k: triangles [0, p-2k) and points [2(p-2k), 2k) of the others, which is p
 *             vertices again; p >= 3k: all k triangles          (Deussen 2002, 5.3; needs two points a triangle, in its order)
 *   lines     the first lines, two vertices each; then the triangles, or the levels of simplified wood one after the other
 *   plain     the first triangles alone, scaled                 (Neubert 2011)
 *
 * A level is skipped where it would not draw more vertices than what came before it, so a ladder always ascends. */
#include "lod/ladder.h"

#include <assert.h>

static uint64_t primitives(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE ? 0 : scene->lists[list].primitive_count;
}

/* Triangles as levels: level i is [start, end). Without levels the whole list is one. */
static uint32_t level_count(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->triangles) == 0 ? 0 : ladder->level_count ? ladder->level_count : 1;
}

static void level_range(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level, uint32_t *first,
	uint32_t *end)
{
	*first = level ? ladder->level_end[level - 1] : 0;
	*end = ladder->level_count ? ladder->level_end[level] : (uint32_t)primitives(scene, ladder->triangles);
}

static uint64_t level_vertices(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level)
{
	uint32_t first, end;
	level_range(scene, ladder, level, &first, &end);
	return 3u * (uint64_t)(end - first);
}

enum stage { STAGE_POINTS, STAGE_LINES, STAGE_PLAIN };

static enum stage stage_of(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	if (primitives(scene, ladder->points))
		return STAGE_POINTS;
	return primitives(scene, ladder->lines) || ladder->level_count ? STAGE_LINES : STAGE_PLAIN;
}

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	uint32_t levels = level_count(scene, ladder);
	if (levels)
		return level_vertices(scene, ladder, levels - 1);
	uint64_t points = primitives(scene, ladder->points), lines = primitives(scene, ladder->lines);
	return points ? points : 2 * lines;
}

/* Vertices of the lines stage that lies at or below `vertices`. Lines that would cost as much as everything are not drawn. */
static uint64_t lines_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t all = 2 * primitives(scene, ladder->lines), full = lod_ladder_full(scene, ladder);
	if (all > full)
		all = full / 2 * 2;
	return vertices < all ? vertices / 2 * 2 : all;
}

uint64_t lod_ladder_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t full = lod_ladder_full(scene, ladder);
	if (vertices >= full)
		return full;
	switch (stage_of(scene, ladder)) {
	case STAGE_POINTS:
		return vertices;
	case STAGE_PLAIN:
		return vertices / 3 * 3;
	case STAGE_LINES:
		break;
	}
	for (uint32_t level = level_count(scene, ladder); level-- > 0;) {
		uint64_t v = level_vertices(scene, ladder, level);
		if (v <= vertices && v > lines_floor(scene, ladder, UINT64_MAX))
			return v;
	}
	return lines_floor(scene, ladder, vertices);
}

uint64_t lod_ladder_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t full = lod_ladder_full(scene, ladder);
	if (vertices >= full)
		return UINT64_MAX;
	switch (stage_of(scene, ladder)) {
	case STAGE_POINTS:
		return vertices + 1;
	case STAGE_PLAIN:
		return vertices / 3 * 3 + 3;
	case STAGE_LINES:
		break;
	}
	uint64_t lines = lines_floor(scene, ladder, UINT64_MAX);
	if (vertices < lines)
		return vertices / 2 * 2 + 2;
	for (uint32_t level = 0; level < level_count(scene, ladder); level++) {
		uint64_t v = level_vertices(scene, ladder, level);
		if (v > vertices && v > lines)
			return v;
	}
	return UINT64_MAX;
}

struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder, double share)
{
	const struct eco_curve *curve = scene->curves + ladder->curve_first;
	uint32_t n = ladder->curve_count;
	if (n == 0)
		return (struct eco_curve){ .share = (float)share, .scale = 1 };
	if (share <= curve[0].share) {
		/* below one element there is nothing: the error goes to "all of it missing" */
		double t = curve[0].share > 0 && share > 0 ? share / curve[0].share : 0;
		return (struct eco_curve){ .share = (float)share, .scale = curve[0].scale, .fp = (float)(curve[0].fp * t),
			.fn = (float)(1 + (curve[0].fn - 1) * t) };
	}
	uint32_t low = 0, high = n - 1;
	if (share >= curve[high].share)
		return curve[high];
	while (high - low > 1) {
		uint32_t middle = (low + high) / 2;
		if (curve[middle].share <= share)
			low = middle;
		else
			high = middle;
	}
	double t = (share - curve[low].share) / ((double)curve[high].share - curve[low].share);
	return (struct eco_curve){
		.share = (float)share,
		.scale = (float)(curve[low].scale + t * (curve[high].scale - curve[low].scale)),
		.fp = (float)(curve[low].fp + t * (curve[high].fp - curve[low].fp)),
		.fn = (float)(curve[low].fn + t * (curve[high].fn - curve[low].fn)),
	};
}

uint64_t lod_ladder_stage_end(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	switch (stage_of(scene, ladder)) {
	case STAGE_POINTS:
		return primitives(scene, ladder->points);
	case STAGE_LINES:
		return lines_floor(scene, ladder, UINT64_MAX);
	case STAGE_PLAIN:
		break;
	}
	return lod_ladder_full(scene, ladder);
}

/* Primitives of the first stage that are this ladder's own. */
static double own_count(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	switch (stage_of(scene, ladder)) {
	case STAGE_POINTS:
		return (double)primitives(scene, ladder->points);
	case STAGE_LINES:
		return (double)primitives(scene, ladder->lines);
	case STAGE_PLAIN:
		break;
	}
	return (double)primitives(scene, ladder->triangles);
}

double lod_ladder_share(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	double full = (double)lod_ladder_full(scene, ladder), own = own_count(scene, ladder);
	if (!(full > 0) || ladder->total == 0 || !(own > 0))
		return full > 0 ? (double)vertices / full : 1;
	double part = (double)vertices / full, end = (double)lod_ladder_stage_end(scene, ladder) / full;
	double share = (part * own + (part > end ? part : end) * ladder->before) / ladder->total;
	return share < 1 ? share : 1;
}

static float stage_scale(const struct eco_scene *scene, const struct eco_ladder *ladder, double density)
{
	if (ladder->organ == ECO_ORGAN_WOOD)
		return 1;
	density = density < 1 ? density : 1;
	double full = (double)lod_ladder_full(scene, ladder), end = (double)lod_ladder_stage_end(scene, ladder);
	return (float)(lod_ladder_curve(scene, ladder, full > 0 ? density * end / full : 1).scale / density);
}

static uint32_t put(struct eco_cut *cut, uint32_t list, uint64_t first, uint64_t end, float scale)
{
	if (first >= end)
		return 0;
	*cut = (struct eco_cut){ .list = list, .first = (uint32_t)first, .end = (uint32_t)end, .scale = scale };
	return 1;
}

uint32_t lod_ladder_cuts(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices, double density,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX])
{
	if (vertices == 0)
		return 0;
	enum stage stage = stage_of(scene, ladder);
	uint64_t triangles = primitives(scene, ladder->triangles), points = primitives(scene, ladder->points);
	assert(density > 0);
	if (stage == STAGE_PLAIN)
		return put(cuts, ladder->triangles, 0, vertices / 3, stage_scale(scene, ladder, density));
	if (stage == STAGE_POINTS) {
		if (vertices <= points)
			return put(cuts, ladder->points, 0, vertices, stage_scale(scene, ladder, density));
		assert(points == 2 * triangles && vertices <= 3 * triangles);
		uint64_t m = vertices - points;
		uint32_t count = put(cuts, ladder->triangles, 0, m, 1);
		return count + put(cuts + count, ladder->points, 2 * m, points, stage_scale(scene, ladder, 1));
	}
	if (vertices <= lines_floor(scene, ladder, UINT64_MAX))
		return put(cuts, ladder->lines, 0, vertices / 2, stage_scale(scene, ladder, density));
	for (uint32_t level = 0; level < level_count(scene, ladder); level++)
		if (level_vertices(scene, ladder, level) == vertices) {
			uint32_t first, end;
			level_range(scene, ladder, level, &first, &end);
			return put(cuts, ladder->triangles, first, end, 1);
		}
	assert(!"vertices is not a value that lod_ladder_floor returns");
	return 0;
}
