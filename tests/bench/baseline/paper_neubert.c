/* Q of a plant's leaves over lambda and scale, drawn alone and without wood from some directions, against
 * all of its leaves: Neubert 2011, section 3. */
#include <math.h>
#include <stdlib.h>

#include "client-min/view_reference.h"
#include "ecofiles/base/memory.h"
#include "lod/raster/raster.h"
#include "tests/bench/baseline/paper_rules.h"

#define VIEWS 3u
#define SIDE 128u
#define SCALES 13u /* tried from near 1 to Cook's and one beyond, in proportion */

/* The leaves of a plant as one selection. */
struct alone {
	struct paper_scene *s;
	uint32_t plant;
	struct view_picture full[VIEWS];
	double radius;
};

static void view_of(const struct alone *a, uint32_t number, struct eco_view *view)
{
	const struct eco_anchor *whole = &a->s->scene->anchors[a->s->scene->plants[a->plant].anchor_first];
	double turn = 0.4 + number * 2.1, away = 4 * a->radius, up[VIEWS] = { 0, 0.3, 0.9 };
	*view = (struct eco_view){ .up = { 0, 0, 1 }, .fov_y_deg = 30, .width = SIDE, .height = SIDE };
	for (int k = 0; k < 3; k++)
		view->target[k] = (double)whole->center[k];
	view->eye[0] = view->target[0] + away * cos(turn) * cos(up[number]);
	view->eye[1] = view->target[1] + away * sin(turn) * cos(up[number]);
	view->eye[2] = view->target[2] + away * sin(up[number]);
}

/* Q of the leaves [0, lambda) at a scale in one view against those of a->full; without `q` these are drawn.
 * */
static void draw(struct alone *a, double lambda, double scale, uint32_t number, double *q)
{
	const struct eco_scene *scene = a->s->scene;
	const struct eco_plant *of = &scene->plants[a->plant];
	uint32_t room = of->ladder_count + 1u, *index = eco_alloc(3 * (size_t)room, sizeof *index), first[2]
		= { 0 };
	/* a plan of the leaves alone, and the selection of it that a viewer would make */
	struct eco_plan plan = { .cuts = eco_alloc(room, sizeof *plan.cuts),
		.placements = eco_alloc(1, sizeof *plan.placements), .placement_count = 1 };
	uint8_t *roles = eco_alloc(room, 1);
	struct eco_view view;
	struct lod_eye eye;
	struct view_picture picture = { 0 }, *to = q ? &picture : &a->full[number];
	struct view_instance instance = { .place = { .cosine = 1, .scale = 1 }, .plant = a->plant,
		.owner = eco_owner_instance(1, a->plant, 0) };
	struct view_selection selection = { .instances = &instance, .instance_count = 1, .cut_first = first,
		.cuts = index, .member_first = index + room, .members = index + 2 * room, .roles = roles };
	for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++) {
		const struct eco_ladder *l = &scene->ladders[i];
		double own = paper_is_leaves(l) ? lambda * l->total - l->before : 0;
		if (!(own >= 0.5) || !scene->lists[l->triangles].element_count)
			continue;
		plan.cuts[plan.cut_count] = (struct eco_cut){ .list = l->triangles, .anchor = l->anchor,
			.end = paper_triangles(a->s, l->triangles, (uint32_t)(own + 0.5)),
			.scale = (float)scale, .band_end = ECO_BANDS, .share_end = ECO_SHARE_ONE };
		index[plan.cut_count] = plan.cut_count;
		plan.cut_count++;
		selection.member_first[plan.cut_count] = plan.cut_count;
	}
	plan.placements[0].scale = 1;
	selection.cut_count = first[1] = plan.cut_count;
	view_of(a, number, &view);
	lod_eye_make(&eye, &view);
	paper_must(view_store_events.plan(a->s->store, &plan, paper_error));
	paper_must(view_picture_init(to, SIDE, SIDE, paper_error));
	paper_must(view_reference_draw(&(struct view_draw_job){ .store = a->s->store, .selection
		= &selection, .eye = &eye, .near_m = 0.01 }, to, paper_error));
	free(index);
	free(roles);
	if (q) {
		struct lod_score score;
		lod_score(&score, &(struct lod_score_input){ SIDE, SIDE, picture.cover, a->full[number].cover,
			picture.owner, a->full[number].owner });
		*q = score.q;
	}
	view_picture_free(&picture);
}

static double measure(struct alone *a, double lambda, double scale)
{
	double sum = 0, q;
	for (uint32_t v = 0; v < VIEWS; v++) {
		draw(a, lambda, scale, v, &q);
		sum += q;
	}
	return sum / VIEWS;
}

static void fill_row(struct alone *a, struct paper_table *t, uint32_t row)
{
	double lambda = t->lambda[row], cook = 1 / lambda;
	uint32_t kept = (uint32_t)fmax(1, lambda * t->leaves + 0.5);
	t->s_opt[row] = t->s_cook[row] = lod_cook_scale_depth(kept, (uint32_t)t->leaves, t->share);
	t->q_opt[row] = t->q_cook[row] = measure(a, lambda, t->s_cook[row]);
	for (uint32_t i = 0; i < SCALES && lambda < 1; i++) {
		double s = pow(cook, (double)(i + 1) / (SCALES - 1)), q = measure(a, lambda, s);
		if (q > t->q_opt[row]) {
			t->q_opt[row] = q;
			t->s_opt[row] = s;
		}
	}
}

static void make_table(struct paper_scene *s, uint32_t plant, struct paper_table *t)
{
	const struct eco_plant *of = &s->scene->plants[plant];
	struct alone a = { .s = s, .plant = plant, .radius
		= (double)s->scene->anchors[of->anchor_first].radius };
	double pixel = 2 * tan(15 * M_PI / 180) * 4 * a.radius / SIDE, area = 0, covered = 0;
	for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++)
		if (paper_is_leaves(&s->scene->ladders[i]) &&
			s->scene->ladders[i].anchor == of->anchor_first) {
			t->leaves += s->scene->ladders[i].total;
			area += (double)s->scene->ladders[i].area;
		}
	if (t->leaves < 2)
		return;
	for (uint32_t v = 0; v < VIEWS; v++) {
		draw(&a, 1, 1, v, NULL);
		for (uint32_t i = 0; i < SIDE * SIDE; i++)
			covered += a.full[v].cover[i] != 0;
	}
	t->share = lod_cook_share((uint32_t)t->leaves, area / 2, covered / VIEWS * pixel * pixel);
	for (uint32_t i = 0; i < PAPER_LAMBDAS; i++) {
		t->lambda[i] = pow(1 / t->leaves, 1 - (double)i / (PAPER_LAMBDAS - 1));
		fill_row(&a, t, i);
	}
	for (uint32_t v = 0; v < VIEWS; v++)
		view_picture_free(&a.full[v]);
}

struct paper_table *paper_tables_make(struct paper_scene *scene)
{
	struct paper_table *tables = eco_alloc(scene->scene->plant_count, sizeof *tables);
	for (uint32_t i = 0; i < scene->scene->plant_count; i++)
		make_table(scene, i, &tables[i]);
	return tables;
}

/* ---- Looking up ---- */

/* Linear in log lambda between two rows. */
static double look(const struct paper_table *t, const double *values, double lambda)
{
	uint32_t i = 0;
	if (lambda <= t->lambda[0])
		return values[0];
	while (i + 2 < PAPER_LAMBDAS && lambda > t->lambda[i + 1])
		i++;
	double at = log(lambda / t->lambda[i]) / log(t->lambda[i + 1] / t->lambda[i]);
	return values[i] + fmin(1, at) * (values[i + 1] - values[i]);
}

double paper_table_optimal(const struct paper_table *t, double lambda)
{
	if (t->leaves < 2 || lambda <= t->lambda[0] || lambda >= 1)
		return lambda;
	double asked = look(t, t->q_cook, lambda);
	for (uint32_t i = 0; i < PAPER_LAMBDAS; i++) {
		if (t->q_opt[i] < asked)
			continue;
		double low = i ? t->q_opt[i - 1] : t->q_opt[0],
		       share = i ? (asked - low) / (t->q_opt[i] - low) : 0;
		double found =
			i ? t->lambda[i - 1] * pow(t->lambda[i] / t->lambda[i - 1], share) : t->lambda[0];
		return fmin(found, lambda);
	}
	return lambda;
}

double paper_table_scale(const struct paper_table *t, double lambda)
{
	double logs[PAPER_LAMBDAS];
	if (t->leaves < 2)
		return 1 / lambda;
	for (uint32_t i = 0; i < PAPER_LAMBDAS; i++)
		logs[i] = log(t->s_opt[i]);
	return exp(look(t, logs, lambda));
}

double paper_table_cook(const struct paper_table *t, double lambda)
{
	if (t->leaves < 2)
		return 1 / lambda;
	return lod_cook_scale_depth((uint32_t)fmax(1, lambda * t->leaves + 0.5), (uint32_t)t->leaves,
		t->share);
}

/* ---- Occlusion (section 4) ---- */

#define POINTS 32u
#define LEAST 0.1
#define SMOOTHING 0.5

struct seen {
	struct paper_sight_state state;
	uint32_t frame;
};
struct paper_sight {
	const struct paper_scene *scene;
	struct seen **plants;       /* by hash; NULL until one is seen */
	float (*points)[POINTS][3]; /* per plant: centres of leaves, at random by the list's order */
	uint32_t *counts, frame;
};

static void take_points(struct paper_sight *sight, uint32_t plant)
{
	const struct paper_scene *s = sight->scene;
	const struct eco_plant *of = &s->scene->plants[plant];
	for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++) {
		const struct eco_ladder *l = &s->scene->ladders[i];
		const struct view_list *list = paper_is_leaves(l) ? view_store_list(s->store, l->triangles)
			: NULL;
		const int32_t *at = list ? list->elements.position : NULL;
		for (uint32_t e = 0; list && e < list->elements.element_count
			&& sight->counts[plant] < POINTS; e++) {
			float *out = sight->points[plant][sight->counts[plant]++];
			for (int k = 0; k < 3; k++)
				out[k] = (float)(list->list.grid_origin[k] + list->list.grid_step[k] * at[k]);
			at += 3 * (size_t)list->elements.corners[e];
		}
	}
}

struct paper_sight *paper_sight_new(const struct paper_scene *scene)
{
	uint32_t n = scene->scene->plant_count;
	struct paper_sight *sight = eco_alloc(1, sizeof *sight);
	*sight = (struct paper_sight){ .scene = scene, .plants = eco_alloc(n, sizeof *sight->plants),
		.points = eco_alloc(n, sizeof *sight->points), .counts = eco_alloc(n, sizeof *sight->counts),
		.frame = 1 };
	for (uint32_t i = 0; i < n; i++)
		take_points(sight, i);
	return sight;
}

void paper_sight_free(struct paper_sight *sight)
{
	for (uint32_t i = 0; i < sight->scene->scene->plant_count; i++)
		free(sight->plants[i]);
	eco_free(sight->plants, sight->points, sight->counts, sight);
}

void paper_sight_step(struct paper_sight_state *state, double counted)
{
	if (fabs(counted - state->held) >= PAPER_SIGHT_HYSTERESIS)
		state->held = counted;
	state->smooth += SMOOTHING * (state->held - state->smooth);
}

double paper_sight_share(double f) { return fmax(f, LEAST); }

/* Outside the picture it counts as visible. */
static bool is_hidden(const struct lod_eye *eye, const struct view_picture *picture, uint64_t owner,
	const double world[3])
{
	double d[3];
	for (int k = 0; k < 3; k++)
		d[k] = world[k] - eye->at[k];
	double z = lod_dot(d, eye->forward), x = (lod_dot(d, eye->right) / z / eye->tan_x + 1) / 2
		* picture->width,
		y = (1 - lod_dot(d, eye->up) / z / eye->tan_y) / 2 * picture->height;
	if (!(z > 0 && x >= 0 && x < picture->width && y >= 0 && y < picture->height))
		return false;
	size_t at = (size_t)y * picture->width + (size_t)x;
	return picture->owner[at] && !eco_owner_match(picture->owner[at], owner)
		&& (double)picture->depth[at] > 1 / z;
}

static double count_visible(const struct paper_sight *sight, const struct view_instance *instance,
	const struct lod_eye *eye, const struct view_picture *picture)
{
	uint32_t hidden = 0, count = sight->counts[instance->plant];
	for (uint32_t i = 0; i < count; i++) {
		double world[3];
		lod_place_point(&instance->place, sight->points[instance->plant][i], world);
		hidden += is_hidden(eye, picture, instance->owner, world);
	}
	return count ? 1 - (double)hidden / count : 1;
}

void paper_sight_update(struct paper_sight *sight, const struct paper_frame *frame,
	const struct eco_view *view)
{
	struct lod_eye eye;
	lod_eye_make(&eye, view);
	sight->frame++;
	for (uint32_t i = 0; i < frame->selection.instance_count; i++) {
		const struct view_instance *instance = &frame->selection.instances[i];
		if (instance->plant == ECO_NONE)
			continue;
		struct seen **plant = &sight->plants[instance->plant];
		*plant = *plant ? *plant : eco_alloc(ECO_SHARE_ONE, sizeof **plant);
		struct seen *seen = &(*plant)[instance->hash];
		if (seen->frame + 1 < sight->frame) /* not in the last frame */
			seen->state = (struct paper_sight_state){ 1, 1 };
		if (seen->frame != sight->frame)
			paper_sight_step(&seen->state, count_visible(sight, instance, &eye, &frame->picture));
		seen->frame = sight->frame;
	}
}

double paper_sight_of(const struct paper_sight *sight, uint32_t plant, uint32_t hash)
{
	const struct seen *seen = sight && sight->plants[plant] ? &sight->plants[plant][hash] : NULL;
	return seen && seen->frame == sight->frame ? seen->state.smooth : 1;
}
