#include "tests/support/plant_walk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/export/plant_view.h"
#include "lod/ladder.h"

#define AWAY 64.0                /* of the camera, radii */
#define FRAME 1.03

struct walker {
	struct plant_view plant;
	struct eco_scene all;        /* the plant's scene before it was left one kind */
	struct eco_ladder *ladders;  /* that kind's */
	struct eco_curve *curves;
	uint32_t pixels;
	struct lod_raster raster;
	uint8_t *cover;              /* of full detail */
};

static void look(struct walker *w, uint32_t view, uint32_t views)
{
	struct plant_view *p = &w->plant;
	const struct eco_anchor *whole = &p->scene.anchors[p->scene.plants[p->number].anchor_first];
	double turn = (view + 0.37) * M_PI * (3 - sqrt(5)),
		rise = (-10 + 70 * (view + 0.5) / views) * M_PI / 180, away = AWAY * whole->radius;
	const double from[3] = { cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise) };
	p->view = (struct eco_view){ .up = { 0, 0, 1 }, .fov_y_deg = 2 * atan(FRAME / AWAY) * 180 / M_PI,
		.width = w->pixels, .height = w->pixels };
	for (int k = 0; k < 3; k++) {
		p->view.target[k] = whole->center[k];
		p->view.eye[k] = whole->center[k] + away * from[k];
	}
	lod_eye_make(&p->eye, &p->view);
}

/* One state in the view; the first of a view is full detail. */
static enum eco_code shoot(struct walker *w, uint64_t vertices, bool full, double *q, struct eco_error *error)
{
	struct plant_view_drawing drawing;
	struct eco_scene scene = w->plant.scene;
	if (full)
		w->plant.scene = w->all;
	enum eco_code code = plant_view_drawing_make(&drawing, &w->plant, vertices, error);
	w->plant.scene = scene;
	if (code)
		return code;
	plant_view_raster(&w->raster, &w->plant, &w->plant.eye, &drawing, false);
	plant_view_drawing_free(&drawing);
	if (full)
		memcpy(w->cover, w->raster.cover, (size_t)w->pixels * w->pixels);
	struct lod_score score;
	lod_score(&score, &(struct lod_score_input){ .width = w->pixels, .height = w->pixels,
		.cover = w->raster.cover, .reference = w->cover });
	*q += score.q;
	return ECO_OK;
}

/* ---- One kind alone ---- */

/* The planner takes what has no errors to save for useless: its scale stays. */
static void spoil(struct eco_curve *curve, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		curve[i].fp = curve[i].fn = 1;
}

/* The errors of splats, which follow those of an impostor: its shares are at most that of one vertex. */
static void spoil_splats(struct walker *w, const struct eco_ladder *ladder)
{
	struct eco_curve *curve = w->curves + ladder->curve_first;
	struct lod_way way;
	lod_way_begin(&way, &w->all, ladder);
	for (uint32_t i = 0; i < eco_ladder_samples(ladder); i++)
		if ((double)curve[i].share * (double)way.full > 1.5)
			spoil(&curve[i], 1);
}

/* Leaves the planner one kind. Organs stay in the scene, as what they cover is what counts, but save nothing
 * if they are not that kind. */
static void leave_one(struct walker *w, enum plant_kind kind)
{
	struct eco_scene *scene = &w->plant.scene;
	uint32_t kept = 0;
	w->all = *scene;
	if (kind == PLANT_ANY)
		return;
	w->ladders = eco_alloc(scene->ladder_count, sizeof *w->ladders);
	w->curves = eco_alloc(scene->curve_count, sizeof *w->curves);
	memcpy(w->curves, scene->curves, scene->curve_count * sizeof *w->curves);
	for (uint32_t i = 0; i < scene->ladder_count; i++) {
		struct eco_ladder *ladder = &w->ladders[kept];
		*ladder = scene->ladders[i];
		bool whole = ladder->flags & ECO_LADDER_WHOLE;
		if (!whole && kind != PLANT_ORGANS)
			spoil(w->curves + ladder->curve_first, eco_ladder_samples(ladder));
		if (whole && kind == PLANT_SPLATS)
			ladder->impostor = ECO_NONE;
		if (whole && kind == PLANT_IMPOSTOR)
			spoil_splats(w, ladder);
		kept += !whole || kind != PLANT_ORGANS;
	}
	scene->ladders = w->ladders;
	scene->ladder_count = kept;
	scene->curves = w->curves;
}

/* ---- Views ---- */

static enum eco_code walk_views(struct walker *w, struct plant_walk *walk, uint32_t views,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t view = 0; view < views && !code; view++) {
		look(w, view, views);
		for (uint32_t i = walk->count; i-- > 0 && !code;)
			code = shoot(w, i + 1 < walk->count ? walk->vertices[i] : ECO_VERTICES_MAX,
				i + 1 == walk->count, &walk->q[i], error);
	}
	double best = -INFINITY;
	for (uint32_t i = 0; i < walk->count; i++) {
		walk->q[i] /= views;
		best = fmax(best, walk->q[i]);
		if (best - walk->q[i] > walk->fall) {
			walk->fall = best - walk->q[i];
			walk->fall_at = walk->vertices[i];
		}
	}
	return code;
}

enum eco_code plant_walk(struct plant_walk *walk, const struct eco_pack *pack, uint32_t number,
	const struct plant_walk_options *options, struct eco_error *error)
{
	struct walker w = { .pixels = options->pixels };
	*walk = (struct plant_walk){ 0 };
	enum eco_code code = plant_view_open(&w.plant, pack, number, options->pixels, error);
	if (code)
		return code;
	for (uint64_t v = 1; v < w.plant.full && walk->count + 1 < PLANT_WALK_MAX; v *= 2)
		walk->vertices[walk->count++] = v;
	walk->vertices[walk->count++] = w.plant.full;
	w.cover = eco_alloc((size_t)w.pixels * w.pixels, 1);
	lod_raster_init(&w.raster, &(struct lod_raster_options){ .width = w.pixels, .height = w.pixels,
		.silhouette = true });
	leave_one(&w, options->kind);
	code = walk_views(&w, walk, options->views, error);
	lod_raster_free(&w.raster);
	free(w.cover);
	free(w.ladders);
	free(w.curves);
	plant_view_close(&w.plant);
	return code;
}

enum eco_code plant_regret(struct plant_regret *regret, const struct eco_pack *pack, uint32_t number,
	const struct plant_walk_options *options, struct eco_error *error)
{
	struct plant_walk walk[PLANT_KINDS];
	*regret = (struct plant_regret){ 0 };
	for (enum plant_kind k = PLANT_ANY; k < PLANT_KINDS; k++) {
		struct plant_walk_options one = *options;
		one.kind = k;
		enum eco_code code = plant_walk(&walk[k], pack, number, &one, error);
		if (code)
			return code;
	}
	for (uint32_t i = 0; i + 1 < walk->count; i++) {
		double below = 0;
		enum plant_kind best = PLANT_ANY;
		if (walk->vertices[i] < PLANT_REGRET_LEAST
				|| 2 * walk->vertices[i] > walk->vertices[walk->count - 1])
			continue;
		for (enum plant_kind k = PLANT_ORGANS; k < PLANT_KINDS; k++)
			if (walk[k].q[i] - walk->q[i] > below) {
				below = walk[k].q[i] - walk->q[i];
				best = k;
			}
		regret->count++;
		regret->within += below <= PLANT_REGRET_FREE;
		regret->mean += below;
		if (below > regret->worst) {
			regret->worst = below;
			regret->worst_at = walk->vertices[i];
			regret->best = best;
		}
	}
	if (regret->count)
		regret->mean /= regret->count;
	return ECO_OK;
}
