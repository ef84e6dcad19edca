/* Splats and balls that are wide in a picture: how wide, and whether their insides vary as the truth's do. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "lod/light.h"
#include "lod/raster/flip.h"
#include "lod/scattered.h"
#include "tests/bench/bench.h"

#define INSIDE_LEAST 32u         /* pixels; fewer say little of a deviation */
#define SURFACE 0.05             /* of a radius: a pixel shows an ellipsoid whose surface is so near */

struct look {
	const struct lod_eye *eye;
	const struct view_picture *smooth;
	float *lightness[2];             /* of the picture, of the truth: L* of each pixel */
	const struct eco_list *list;
	struct lod_geometry points;
	float area;                      /* of a ball of size 1 */
	struct bench_wide *wide;
	uint32_t *room;                  /* as many as pixels */
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

/* Distance of a place, led to from the centre, over the radius in that direction. */
static double radii_of(const struct look *look, uint32_t point, const struct lod_place *place, double reach,
	const double from[3])
{
	double sum = 0;
	if (!look->points.half)
		return length_of(from) / reach;
	for (int axis = 0; axis < 3; axis++) {
		double half[3];
		half_axis(look, point, axis, place, half);
		double along = lod_dot(half, from) / lod_dot(half, half);
		sum += along * along;
	}
	return sqrt(sum);
}

/* ---- Insides ---- */

struct ball { uint32_t point; const struct lod_place *place; double at[3], reach, x, y, radius_px; };

static bool shows(const struct look *look, const struct ball *ball, uint32_t x, uint32_t y)
{
	double ray[3], from[3], seen = look->smooth->depth[(size_t)y * look->smooth->width + x];
	if (!(seen > 0))
		return false;
	view_picture_ray(look->smooth, look->eye, x, y, ray);
	for (int k = 0; k < 3; k++)
		from[k] = ray[k] / seen - ball->at[k];
	return fabs(radii_of(look, ball->point, ball->place, ball->reach, from) - 1) <= SURFACE;
}

static uint32_t pixel_at(double at, uint32_t size) { return at < 0 ? 0 : at > size ? size : (uint32_t)at; }

/* Pixels that show an ellipse, and the box around them: [left, right) and [top, bottom). */
struct inside { uint32_t *pixel, count, left, right, top, bottom; };

static void find_inside(const struct look *look, const struct ball *b, struct inside *in)
{
	uint32_t width = look->smooth->width, height = look->smooth->height;
	*in = (struct inside){ look->room, 0, pixel_at(b->x - b->radius_px, width), pixel_at(b->x + b->radius_px + 1, width),
		pixel_at(b->y - b->radius_px, height), pixel_at(b->y + b->radius_px + 1, height) };
	for (uint32_t y = in->top; y < in->bottom; y++)
		for (uint32_t x = in->left; x < in->right; x++)
			if (shows(look, b, x, y))
				in->pixel[in->count++] = y * width + x;
}

/* Deviation of L* in pixels that lie `moved` after those of the ellipse. */
static double deviation_in(const float *lightness, const struct inside *in, int64_t moved)
{
	double sum = 0, squares = 0;
	for (uint32_t i = 0; i < in->count; i++) {
		double l = (double)lightness[in->pixel[i] + moved];
		sum += l;
		squares += l * l;
	}
	return sqrt(fmax(0, squares / in->count - sum / in->count * sum / in->count));
}

/* The share of four places half a width away where the truth itself deviates by less than half of `deviation`. */
static double chance_of(const struct look *look, const struct ball *b, const struct inside *in, double deviation)
{
	int64_t width = look->smooth->width, height = look->smooth->height, far = (int64_t)b->radius_px;
	double places = 0, flat = 0;
	for (int i = 0; i < 4; i++) {
		int64_t x = i < 2 ? (i ? far : -far) : 0, y = i < 2 ? 0 : i > 2 ? far : -far;
		if (in->left + x < 0 || in->right + x > width || in->top + y < 0 || in->bottom + y > height)
			continue;
		places++;
		flat += deviation_in(look->lightness[1], in, y * width + x) < deviation / 2;
	}
	return places > 0 ? flat / places : 0;
}

/* Counts an ellipse that shows enough, and whether it is flat. */
static void look_inside(const struct look *look, const struct ball *b)
{
	struct inside in;
	find_inside(look, b, &in);
	if (in.count < INSIDE_LEAST)
		return;
	double truth = deviation_in(look->lightness[1], &in, 0);
	look->wide->ellipses++;
	look->wide->flat += deviation_in(look->lightness[0], &in, 0) < truth / 2;
	look->wide->chance += chance_of(look, b, &in, truth);
}

/* ---- Widths ---- */

static void look_at(const struct look *look, uint32_t point, const struct lod_place *place)
{
	const struct lod_eye *eye = look->eye;
	const struct view_picture *p = look->smooth;
	struct ball b = { .point = point, .place = place };
	double back[3];
	lod_place_point(place, look->points.position + 3 * (size_t)point, b.at);
	for (int k = 0; k < 3; k++)
		back[k] = -(b.at[k] -= eye->at[k]);
	double forward = lod_dot(b.at, eye->forward);
	b.reach = reach_of(look, point, place, b.at);
	if (radii_of(look, point, place, b.reach, back) < 1)
		look->wide->widest_px = p->width;
	if (forward <= 0)
		return;
	b.radius_px = b.reach / (forward * eye->pixel_rad);
	b.x = (lod_dot(b.at, eye->right) / (forward * eye->tan_x) + 1) / 2 * p->width;
	b.y = (1 - lod_dot(b.at, eye->up) / (forward * eye->tan_y)) / 2 * p->height;
	if (2 * b.radius_px > BENCH_WIDE_PX && !(look->points.wood && look->points.wood[point] > 0))
		look_inside(look, &b);
	if (!(b.x >= 0 && b.x < p->width && b.y >= 0 && b.y < p->height))
		return;
	double seen = p->depth[(size_t)b.y * p->width + (size_t)b.x];
	if (seen > 0 && fabs(1 / seen - forward) <= 1.05 * b.reach)
		look->wide->widest_px = fmax(look->wide->widest_px, 2 * b.radius_px);
}

static void look_at_cut(struct look *look, const struct view_draw_job *job, uint32_t c)
{
	const struct view_selection *s = job->selection;
	const struct eco_cut *cut = &view_store_plan(job->store)->cuts[c];
	const struct view_list *list = view_store_list(job->store, cut->list);
	if (list->list.kind != ECO_LIST_POINTS)
		return;
	look->list = &list->list;
	look->area = ldexpf(list->list.unit_area * cut->scale, -cut->halvings);
	uint32_t drawn = (uint32_t)eco_cut_primitives(cut);
	if (!lod_geometry_make(&look->points, look->list, drawn, false))
		must(eco_no_memory(must_error, "points"));
	uint32_t points = lod_list_geometry(look->list, &list->elements, cut->first, cut->end, cut->scale,
		&look->points);
	lod_scatter(&look->points, points, cut->first, cut->halvings,
		lod_ball_radius(look->list, cut->scale));
	for (uint32_t m = s->member_first[c]; m < s->member_first[c + 1]; m++)
		for (uint32_t i = 0; i < drawn; i++)
			look_at(look, i, &s->instances[s->members[m]].place);
	lod_geometry_free(&look->points);
}

static float *lightness_of(const struct view_picture *picture)
{
	size_t pixels = (size_t)picture->width * picture->height;
	float *lightness = eco_alloc(pixels, sizeof *lightness);
	for (size_t i = 0; i < pixels; i++) {
		double light[3], lab[3];
		for (int k = 0; k < 3; k++)
			light[k] = lod_light_of[picture->rgb[3 * i + k]] / 65535.0;
		lod_lab(light, lab);
		lightness[i] = (float)lab[0];
	}
	return lightness;
}

void bench_find_wide(const struct view_draw_job *job, const struct view_picture *smooth,
	const struct view_picture *picture, const struct view_picture *truth, struct bench_wide *wide)
{
	struct look look = { .eye = job->eye, .smooth = smooth, .lightness = { lightness_of(picture),
		lightness_of(truth) }, .wide = wide,
		.room = eco_alloc((size_t)smooth->width * smooth->height, sizeof *look.room) };
	*wide = (struct bench_wide){ 0 };
	for (uint32_t c = 0; c < job->selection->cut_count; c++)
		look_at_cut(&look, job, c);
	free(look.lightness[0]);
	free(look.lightness[1]);
	free(look.room);
}
