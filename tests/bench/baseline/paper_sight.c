/* The share of each plant that other plants hide, from the owners and depths of the last frame. Plants of a species
 * with one share hash are one. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/baseline/paper_neubert.h"

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

enum eco_code paper_sight_new(struct paper_sight **out, const struct paper_scene *scene,
	struct eco_error *error)
{
	uint32_t n = scene->scene->plant_count;
	struct paper_sight *sight = *out = calloc(1, sizeof *sight);
	if (sight)
		*sight = (struct paper_sight){ .scene = scene, .plants = calloc(n + 1, sizeof *sight->plants),
			.points = calloc(n + 1, sizeof *sight->points),
			.counts = calloc(n + 1, sizeof *sight->counts), .frame = 1 };
	if (!sight || !sight->plants || !sight->points || !sight->counts) {
		paper_sight_free(sight);
		*out = NULL;
		return eco_fail(error, ECO_NO_MEMORY, "no memory for what plants hide");
	}
	for (uint32_t i = 0; i < n; i++)
		take_points(sight, i);
	return ECO_OK;
}

void paper_sight_free(struct paper_sight *sight)
{
	if (!sight)
		return;
	for (uint32_t i = 0; sight->plants && i < sight->scene->scene->plant_count; i++)
		free(sight->plants[i]);
	free(sight->plants);
	free(sight->points);
	free(sight->counts);
	free(sight);
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
		*plant = *plant ? *plant : calloc(ECO_SHARE_ONE, sizeof **plant);
		if (!*plant)
			continue; /* counts as visible */
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
