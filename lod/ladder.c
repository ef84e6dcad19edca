/* Ladders: a number of vertices of an organ at an anchor -> cuts. There are three kinds (struct eco_ladder):
 *
 *   forms    the elements of one list in several forms: lod/forms.h
 *   levels   points or lines first, then the triangles or the levels of wood; a level that draws no more vertices
 *            than the one before it is skipped. Samples of the curve may stand between two of these
 *   splats   one list of points in levels: splats give way to their children one by one; then leaves, those of the
 *            whole plant before those of its cells, or else wood, before the last level, which shrinks behind them */
#include "lod/ladder.h"

#include <assert.h>

static uint64_t primitives(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE ? 0 : scene->lists[list].primitive_count;
}

/* ---- Splats ---- */

/* A state: the first `p` splats of `level` have given way to their children; below the first level its first
 * `p` splats alone are drawn. */
struct splats { uint32_t level, p; };

static uint32_t splat_level_first(const struct eco_ladder *ladder, uint32_t level)
{
	return level ? ladder->level_end[level - 1] : 0;
}

static uint32_t splat_level_size(const struct eco_ladder *ladder, uint32_t level)
{
	return ladder->level_end[level] - splat_level_first(ladder, level);
}

/* Vertices added where a splat of a level gives way to its children. */
static uint32_t splat_step(const struct eco_ladder *ladder, uint32_t level)
{
	return splat_level_size(ladder, level + 1) / splat_level_size(ladder, level) - 1;
}

static struct splats splats_floor(const struct eco_ladder *ladder, uint64_t vertices)
{
	uint32_t level = ladder->level_count - 1;
	if (vertices < splat_level_size(ladder, 0))
		return (struct splats){ 0, (uint32_t)vertices };
	while (splat_level_size(ladder, level) > vertices)
		level--;
	uint64_t more = vertices - splat_level_size(ladder, level);
	return (struct splats){ level, level + 1 < ladder->level_count
		? (uint32_t)(more / splat_step(ladder, level)) : 0 };
}

/* All splats of the last level. */
static uint64_t splats_all(const struct eco_ladder *ladder)
{
	return splat_level_size(ladder, ladder->level_count - 1);
}

static uint64_t splats_vertices(const struct eco_ladder *ladder, uint64_t vertices, bool next)
{
	struct splats s = splats_floor(ladder, vertices);
	uint64_t all = splats_all(ladder);
	if (vertices >= all)
		return all + ((vertices - all) / 3 + next) * 3;
	if (vertices < splat_level_size(ladder, 0))
		return vertices + next;
	return splat_level_size(ladder, s.level)
		+ (uint64_t)splat_step(ladder, s.level) * (s.p + (uint64_t)next);
}

/* ---- Levels ---- */

/* Triangles as levels: level i is [start, end). Without levels the whole list is one level. */
static uint32_t level_count(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->triangles) == 0 ? 0 : ladder->level_count ? ladder->level_count : 1;
}

static void level_range(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level,
	uint32_t *first, uint32_t *end)
{
	*first = level ? ladder->level_end[level - 1] : 0;
	*end = ladder->level_count ? ladder->level_end[level]
		: (uint32_t)primitives(scene, ladder->triangles);
}

static uint64_t level_vertices(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level)
{
	uint32_t first, end;
	level_range(scene, ladder, level, &first, &end);
	return 3u * (uint64_t)(end - first);
}

/* The list that is drawn before the first level: lines, or points. */
static uint32_t first_list(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->lines) ? ladder->lines : primitives(scene, ladder->points)
		? ladder->points : ECO_NONE;
}

static uint64_t first_unit(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->lines) ? 2 : 1;
}

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	uint32_t levels = level_count(scene, ladder);
	if (eco_ladder_has_splats(scene, ladder))
		return splats_all(ladder) + (ladder->triangles == ECO_NONE ? 0 : 3 * (uint64_t)ladder->total);
	if (levels)
		return level_vertices(scene, ladder, levels - 1);
	return first_unit(scene, ladder) * primitives(scene, first_list(scene, ladder));
}

/* The greatest number of vertices of lines or points at or below `vertices`. Lines or points beyond the cost
 * of full detail are not drawn. */
static uint64_t first_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t unit = first_unit(scene, ladder), all = unit * primitives(scene, first_list(scene, ladder));
	uint64_t full = lod_ladder_full(scene, ladder);
	if (all > full)
		all = full / unit * unit;
	return vertices < all ? vertices / unit * unit : all;
}

static uint64_t levels_floor(const struct eco_scene *scene, const struct eco_ladder *ladder,
	uint64_t vertices)
{
	for (uint32_t level = level_count(scene, ladder); level-- > 0;) {
		uint64_t v = level_vertices(scene, ladder, level);
		if (v <= vertices && v > first_floor(scene, ladder, UINT64_MAX))
			return v;
	}
	return first_floor(scene, ladder, vertices);
}

static uint64_t levels_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t unit = first_unit(scene, ladder), first = first_floor(scene, ladder, UINT64_MAX);
	if (vertices < first)
		return vertices / unit * unit + unit;
	for (uint32_t level = 0; level < level_count(scene, ladder); level++) {
		uint64_t v = level_vertices(scene, ladder, level);
		if (v > vertices && v > first)
			return v;
	}
	return UINT64_MAX;
}

/* The cut of the points or lines, or of the level, that draws `vertices`, a value that levels_floor returns. */
static struct eco_cut whole_cut(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	struct eco_cut cut = { .list = first_list(scene, ladder), .scale = 1,
		.end = (uint32_t)(vertices / first_unit(scene, ladder)) };
	for (uint32_t level = 0; vertices > first_floor(scene, ladder, UINT64_MAX); level++)
		if (level_vertices(scene, ladder, level) == vertices) {
			cut.list = ladder->triangles;
			level_range(scene, ladder, level, &cut.first, &cut.end);
			break;
		}
	return cut;
}

/* The vertices of a sample of the curve that stands between two levels, and its cuts; 0: it is none. */
static uint64_t between_levels(const struct lod_way *way, const struct eco_curve *sample, struct eco_cut cuts[2])
{
	const struct eco_scene *scene = way->scene;
	const struct eco_ladder *ladder = way->ladder;
	uint64_t v = (uint64_t)((double)sample->share * (double)way->full + 0.5);
	if (!(sample->reach < 1) || v >= way->full || v <= first_floor(scene, ladder, UINT64_MAX))
		return 0;
	cuts[0] = whole_cut(scene, ladder, levels_next(scene, ladder, v));
	cuts[1] = whole_cut(scene, ladder, levels_floor(scene, ladder, v));
	uint64_t fine = (uint64_t)((double)sample->reach * (cuts[0].end - cuts[0].first) + 0.5),
		unit = cuts[1].end ? eco_list_vertices(&scene->lists[cuts[1].list]) : 1, rest = v - 3 * fine;
	if (!fine || 3 * fine >= v || rest % unit || rest / unit > cuts[1].end - cuts[1].first)
		return 0;
	cuts[0].end = cuts[0].first + (uint32_t)fine;
	cuts[1].first = cuts[1].end - (uint32_t)(rest / unit);
	return v;
}

/* The sample between two levels with the most vertices up to `vertices`, or, if `next`, the fewest above; 0: none. */
static uint64_t between_at(const struct lod_way *way, uint64_t vertices, bool next, struct eco_cut cuts[2])
{
	const struct eco_curve *curve = way->scene->curves + way->ladder->curve_first;
	uint32_t low = 0, high = way->ladder->curve_count;
	while (low < high) {
		uint32_t middle = (low + high) / 2;
		if ((double)curve[middle].share * (double)way->full < (double)vertices + 0.5)
			low = middle + 1;
		else
			high = middle;
	}
	for (; next && low < way->ladder->curve_count; low++) {
		uint64_t v = between_levels(way, &curve[low], cuts);
		if (v > vertices)
			return v;
	}
	while (!next && low-- > 0) {
		uint64_t v = between_levels(way, &curve[low], cuts);
		if (v)
			return v;
	}
	return 0;
}

uint64_t lod_way_level_above(const struct lod_way *way, uint64_t vertices)
{
	const struct eco_ladder *ladder = way->ladder;
	for (uint32_t level = 0; way->has_splats && level < ladder->level_count; level++)
		if (splat_level_size(ladder, level) > vertices)
			return splat_level_size(ladder, level);
	return UINT64_MAX;
}

/* ---- All kinds ---- */

void lod_way_begin(struct lod_way *way, const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	*way = (struct lod_way){ .scene = scene, .ladder = ladder, .full = lod_ladder_full(scene, ladder),
		.stage_end = UINT64_MAX, .has_splats = eco_ladder_has_splats(scene, ladder) };
	way->has_forms = lod_forms_find(&way->forms, scene, ladder);
}

uint32_t lod_way_legs_bound(const struct lod_way *way)
{
	return way->has_forms ? lod_forms_legs_bound(&way->forms) : 0;
}

void lod_way_keep(struct lod_way *way, struct lod_forms_leg *legs)
{
	if (way->has_forms)
		lod_forms_keep(&way->forms, legs);
	way->stage_end = lod_way_stage_end(way);
}

uint64_t lod_way_floor(const struct lod_way *way, uint64_t vertices)
{
	if (vertices >= way->full)
		return way->full;
	if (way->has_splats)
		return splats_vertices(way->ladder, vertices, false);
	struct eco_cut cuts[2];
	if (!way->has_forms) {
		uint64_t whole = levels_floor(way->scene, way->ladder, vertices),
			between = between_at(way, vertices, false, cuts);
		return between > whole ? between : whole;
	}
	struct lod_forms_state s = lod_forms_floor(&way->forms, vertices);
	return lod_forms_vertices(&way->forms, &s);
}

uint64_t lod_way_next(const struct lod_way *way, uint64_t vertices)
{
	if (vertices >= way->full)
		return UINT64_MAX;
	if (way->has_splats)
		return splats_vertices(way->ladder, vertices, true);
	if (way->has_forms)
		return lod_forms_next(&way->forms, vertices);
	struct eco_cut cuts[2];
	uint64_t whole = levels_next(way->scene, way->ladder, vertices), between = between_at(way, vertices, true, cuts);
	return between && between < whole ? between : whole;
}

/* part: of the way from a to b. */
static struct eco_seen seen_between(const struct eco_seen *a, const struct eco_seen *b, double part)
{
	struct eco_seen seen;
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++)
		for (int open = 0; open < 2; open++) {
			seen.color[size][open] = (uint16_t)(a->color[size][open]
				+ part * (b->color[size][open] - a->color[size][open]) + 0.5);
			seen.contrast[size][open] = (uint16_t)(a->contrast[size][open]
				+ part * (b->contrast[size][open] - a->contrast[size][open]) + 0.5);
		}
	return seen;
}

/* A ladder without a curve errs as its share says. */
#define UNMEASURED 34.0
static struct eco_curve unmeasured(double share)
{
	uint16_t error = (uint16_t)(UNMEASURED / ECO_SEEN_UNIT * (1 - share));
	struct eco_curve curve = { .share = (float)share, .scale = 1, .reach = 1, .fn = (float)(1 - share) };
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++)
		curve.seen.color[size][0] = curve.seen.color[size][1] = error;
	return curve;
}

struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder,
	double share)
{
	const struct eco_curve *curve = scene->curves + ladder->curve_first;
	uint32_t n = ladder->curve_count;
	if (n == 0)
		return unmeasured(share);
	if (share <= curve[0].share) {
		/* below one element nothing is drawn: the error tends to "all of it is missing" */
		double t = curve[0].share > 0 && share > 0 ? share / curve[0].share : 0;
		return (struct eco_curve){ .share = (float)share, .scale = curve[0].scale,
			.reach = (float)(curve[0].reach * t),
			.fp = (float)(curve[0].fp * t), .fn = (float)(1 + (curve[0].fn - 1) * t),
			.seen = seen_between(&ladder->nothing, &curve[0].seen, t) };
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
		.reach = (float)(curve[low].reach + t * (curve[high].reach - curve[low].reach)),
		.fp = (float)(curve[low].fp + t * (curve[high].fp - curve[low].fp)),
		.fn = (float)(curve[low].fn + t * (curve[high].fn - curve[low].fn)),
		.seen = seen_between(&curve[low].seen, &curve[high].seen, t),
	};
}

struct eco_curve lod_ladder_curve_seen(const struct eco_scene *scene, const struct eco_ladder *ladder,
	double share, double above)
{
	struct eco_curve curve = lod_ladder_curve(scene, ladder, share);
	if (!(above > 0) || !(ladder->flags & ECO_LADDER_ABOVE))
		return curve;
	struct eco_ladder from_above = *ladder;
	from_above.curve_first += ladder->curve_count;
	struct eco_curve to = lod_ladder_curve(scene, &from_above, share);
	curve.scale += (float)(above * ((double)to.scale - (double)curve.scale));
	curve.fp += (float)(above * ((double)to.fp - (double)curve.fp));
	curve.fn += (float)(above * ((double)to.fn - (double)curve.fn));
	return curve;
}

uint64_t lod_way_stage_end(const struct lod_way *way)
{
	if (way->stage_end != UINT64_MAX)
		return way->stage_end;
	if (way->has_splats)
		return splats_all(way->ladder);
	if (!way->has_forms)
		return first_floor(way->scene, way->ladder, UINT64_MAX);
	uint64_t all = way->forms.total == way->forms.own ? way->full : lod_forms_all_drawn(&way->forms);
	return all < way->full ? all : way->full;
}

double lod_way_share(const struct lod_way *way, uint64_t vertices)
{
	const struct eco_ladder *ladder = way->ladder;
	if (way->has_splats)
		return vertices < way->full ? (double)vertices / (double)way->full : 1;
	if (vertices >= way->full && ladder->before == 0
			&& !(way->has_forms && way->forms.own < way->forms.total))
		return 1;
	if (way->has_forms)
		return lod_forms_share(&way->forms, vertices);
	double share = (double)vertices / (double)way->full,
		all = (double)primitives(way->scene, first_list(way->scene, ladder));
	if (level_count(way->scene, ladder) == 0 && ladder->total > all)     /* the largest lines are stored */
		share *= all / ladder->total;
	return share < 1 ? share : 1;
}

uint64_t lod_way_vertices(const struct lod_way *way, double share)
{
	const struct eco_ladder *ladder = way->ladder;
	if (way->has_splats)
		return lod_way_floor(way, (uint64_t)(share * (double)way->full + 0.5));
	if (way->has_forms)
		return lod_forms_of_share(&way->forms, share);
	double all = (double)primitives(way->scene, first_list(way->scene, ladder));
	if (level_count(way->scene, ladder) == 0 && ladder->total > all && all > 0)
		share *= ladder->total / all;
	return lod_way_floor(way, (uint64_t)(share * (double)way->full + 0.5));
}

double lod_way_density(const struct lod_way *way, uint64_t vertices)
{
	if (way->has_splats)
		return 1;
	if (!way->has_forms) {
		double shown = (double)vertices / (double)first_unit(way->scene, way->ladder),
			total = way->ladder->total;
		return shown < total ? shown / total : 1;
	}
	return ((double)lod_forms_floor(&way->forms, vertices).e + way->forms.before) / way->forms.total;
}

/* ---- Cuts ---- */

/* The smallest share at which the curve attains `reach`. */
static double share_of_reach(const struct eco_scene *scene, const struct eco_ladder *ladder, double reach)
{
	const struct eco_curve *curve = scene->curves + ladder->curve_first;
	uint32_t i = 0;
	while (i < ladder->curve_count && curve[i].reach < reach)
		i++;
	if (i == 0 || i == ladder->curve_count)
		return i == 0 ? 0 : 1;
	double t = (reach - curve[i - 1].reach) / ((double)curve[i].reach - curve[i - 1].reach);
	return curve[i - 1].share + t * ((double)curve[i].share - curve[i - 1].share);
}

static float scale_at(const struct lod_way *way, uint64_t vertices, double density, double above)
{
	const struct eco_ladder *ladder = way->ladder;
	if (ladder->organ == ECO_ORGAN_WOOD)
		return 1;
	density = density < 1 ? density : 1;
	double share = way->has_forms && vertices < way->full ? lod_forms_first_share(&way->forms, vertices)
		: lod_way_share(way, vertices);
	if (density > lod_way_density(way, vertices)) {      /* cells show more: the list has their scale */
		double half = ladder->total ? 0.5 / ladder->total : 0,
			least = share_of_reach(way->scene, ladder, density - half);
		share = share > least ? share : least;
	}
	return (float)(lod_ladder_curve_seen(way->scene, ladder, share, above).scale / density);
}

static uint32_t put(struct eco_cut *cut, uint32_t list, uint64_t first, uint64_t end, float scale)
{
	if (first >= end)
		return 0;
	*cut = (struct eco_cut){ .list = list, .first = (uint32_t)first, .end = (uint32_t)end,
		.scale = scale };
	return 1;
}

static uint32_t forms_cuts(const struct lod_forms *forms, uint64_t vertices, float scale,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX])
{
	struct lod_forms_state s = lod_forms_floor(forms, vertices);
	uint32_t count = 0;
	assert(lod_forms_vertices(forms, &s) == vertices);
	if (s.f)
		count = put(cuts, forms->list[s.stage + 1], 0, lod_forms_range_end(forms, s.stage + 1, s.f),
			scale);
	return count + put(cuts + count, forms->list[s.stage], lod_forms_range_end(forms, s.stage, s.f),
		lod_forms_range_end(forms, s.stage, s.e), scale);
}

/* The first `triangles` of what stands before splats; of cells an equal share. */
static uint32_t front_cuts(const struct lod_way *way, uint64_t triangles,
	struct eco_cut cuts[1 + ECO_FRONT_MAX])
{
	const struct eco_ladder *ladder = way->ladder;
	uint32_t lists[ECO_FRONT_MAX];
	uint64_t own = primitives(way->scene, ladder->triangles),
		from = own > ladder->total ? own - ladder->total : 0,
		before = 0, all = ladder->total + from - own;
	uint32_t count = put(cuts, ladder->triangles, from, triangles < own - from ? from + triangles : own, 1);
	if (triangles <= own - from)
		return count;
	triangles -= own - from;
	for (uint32_t i = 0, cells = eco_ladder_front(way->scene, ladder, lists); i < cells; i++) {
		uint64_t here = before + primitives(way->scene, lists[i]);
		count += put(cuts + count, lists[i], 0, triangles * here / all - triangles * before / all, 1);
		before = here;
	}
	return count;
}

static uint32_t splats_cuts(const struct lod_way *way, uint64_t vertices, double above,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX])
{
	const struct eco_ladder *ladder = way->ladder;
	struct splats s = splats_floor(ladder, vertices);
	uint32_t first = splat_level_first(ladder, s.level), end = ladder->level_end[s.level], count = 0;
	if (vertices < splat_level_size(ladder, 0))
		return put(cuts, ladder->points, 0, vertices, 1);
	if (vertices > splats_all(ladder)) {
		float scale = lod_ladder_curve_seen(way->scene, ladder, lod_way_share(way, vertices), above).scale;
		count = front_cuts(way, (vertices - splats_all(ladder)) / 3, cuts);
		return count + put(cuts + count, ladder->points, first, end, scale);
	}
	if (s.p)
		count = put(cuts, ladder->points, end, end + (splat_step(ladder, s.level) + 1ull) * s.p, 1);
	return count + put(cuts + count, ladder->points, first + s.p, end, 1);
}

uint32_t lod_way_cuts_bound(const struct lod_way *way)
{
	const struct eco_ladder *ladder = way->ladder;
	uint64_t alone = way->has_splats ? splats_all(ladder) + 3 * primitives(way->scene, ladder->triangles) : way->full;
	return way->full > alone ? LOD_LADDER_CUTS_MAX : 2;
}

uint32_t lod_way_cuts(const struct lod_way *way, uint64_t vertices, double density, double above,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX])
{
	const struct eco_scene *scene = way->scene;
	const struct eco_ladder *ladder = way->ladder;
	if (vertices == 0)
		return 0;
	assert(density > 0);
	if (way->has_splats) {
		assert(lod_way_floor(way, vertices) == vertices);
		return splats_cuts(way, vertices, above, cuts);
	}
	if (way->has_forms)
		return forms_cuts(&way->forms, vertices, scale_at(way, vertices, density, above), cuts);
	if (vertices <= first_floor(scene, ladder, UINT64_MAX))
		return put(cuts, first_list(scene, ladder), 0, vertices / first_unit(scene, ladder),
			scale_at(way, vertices, density, above));
	if (levels_floor(scene, ladder, vertices) == vertices) {
		cuts[0] = whole_cut(scene, ladder, vertices);
		return 1;
	}
	uint64_t between = between_at(way, vertices, false, cuts);
	assert(between == vertices);
	return 2;
}
