#include "tests/bench/pictures/bench_widest.h"

#include <math.h>

#include "lod/scattered.h"

struct look {
	const struct lod_eye *eye;
	const struct view_picture *picture;
	const struct eco_list *list;
	struct lod_geometry points;
	float area;                  /* of a ball of size 1 */
};

static double length_of(const double v[3]) { return sqrt(lod_dot(v, v)); }

static void half_axis(const struct look *look, uint32_t point, int axis, const struct lod_place *place,
	double half[3])
{
	struct lod_place turn = { .sine = place->sine, .cosine = place->cosine, .scale = place->scale };
	lod_place_point(&turn, look->points.half + 9 * (size_t)point + 3 * axis, half);
}

/* The longest way from the middle to the rim, across the line of sight: metres in the scene. */
static double reach_of(const struct look *look, uint32_t point, const struct lod_place *place,
	const double from_eye[3])
{
	const struct lod_geometry *g = &look->points;
	double longest = 0, away = length_of(from_eye);
	if (!g->half)
		return place->scale * sqrt(look->area * (g->size ? g->size[point] : 1) / M_PI);
	for (int axis = 0; axis < 3; axis++) {
		double half[3];
		half_axis(look, point, axis, place, half);
		double along = lod_dot(half, from_eye) / away;
		longest = fmax(longest, sqrt(fmax(0, lod_dot(half, half) - along * along)));
	}
	return longest;
}

/* Whether the eye stands in a ball or splat, which then fills the picture. `from_eye` leads to its centre. */
static bool holds_eye(const struct look *look, uint32_t point, const struct lod_place *place,
	const double from_eye[3])
{
	const struct lod_geometry *g = &look->points;
	double sum = 0;
	if (!g->half)
		return length_of(from_eye) < reach_of(look, point, place, from_eye);
	for (int axis = 0; axis < 3; axis++) {
		double half[3];
		half_axis(look, point, axis, place, half);
		double along = lod_dot(half, from_eye) / lod_dot(half, half);
		sum += along * along;
	}
	return sum < 1;
}

/* 0 where something else is nearest at its centre, or where that is not in the picture. */
static double width_px(const struct look *look, uint32_t point, const struct lod_place *place)
{
	const struct lod_eye *eye = look->eye;
	double at[3];
	lod_place_point(place, look->points.position + 3 * (size_t)point, at);
	for (int k = 0; k < 3; k++)
		at[k] -= eye->at[k];
	if (holds_eye(look, point, place, at))
		return look->picture->width;
	double forward = lod_dot(at, eye->forward);
	if (forward <= 0)
		return 0;
	double x = (lod_dot(at, eye->right) / (forward * eye->tan_x) + 1) / 2 * look->picture->width,
		y = (1 - lod_dot(at, eye->up) / (forward * eye->tan_y)) / 2 * look->picture->height;
	if (!(x >= 0 && x < look->picture->width && y >= 0 && y < look->picture->height))
		return 0;
	double reach = reach_of(look, point, place, at),
		seen = look->picture->depth[(size_t)y * look->picture->width + (size_t)x];
	bool nearest = seen > 0 && fabs(1 / seen - forward) <= 1.05 * reach;
	return nearest ? 2 * reach / (forward * eye->pixel_rad) : 0;
}

static double widest_of_cut(struct look *look, const struct view_selection *s, uint32_t cut, uint32_t points)
{
	double widest = 0;
	for (uint32_t m = s->member_first[cut]; m < s->member_first[cut + 1]; m++)
		for (uint32_t i = 0; i < points; i++)
			widest = fmax(widest, width_px(look, i, &s->instances[s->members[m]].place));
	return widest;
}

double bench_widest_px(const struct view_store *store, const struct view_selection *selection,
	const struct lod_eye *eye, const struct view_picture *picture)
{
	const struct eco_plan *plan = view_store_plan(store);
	double widest = 0;
	for (uint32_t c = 0; c < selection->cut_count; c++) {
		const struct eco_cut *cut = &plan->cuts[c];
		const struct view_list *list = view_store_list(store, cut->list);
		if (list->list.kind != ECO_LIST_POINTS)
			continue;
		struct look look = { .eye = eye, .picture = picture, .list = &list->list,
			.area = ldexpf(list->list.unit_area * cut->scale, -cut->halvings) };
		uint32_t drawn = (uint32_t)eco_cut_primitives(cut);
		if (!lod_geometry_make(&look.points, look.list, drawn, false))
			return NAN;
		uint32_t points = lod_list_geometry(look.list, &list->elements, cut->first, cut->end,
			cut->scale, &look.points);
		lod_scatter(&look.points, points, cut->first, cut->halvings,
			lod_ball_radius(look.list, cut->scale));
		widest = fmax(widest, widest_of_cut(&look, selection, c, drawn));
		lod_geometry_free(&look.points);
	}
	return widest;
}
