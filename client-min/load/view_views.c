#include "client-min/load/view_load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "ecofiles/base/random.h"

#define FRAMES 240u
#define EYE_M 1.7
#define WALK_RADIUS_M 60.0
#define FOV_DEG 50.0
#define TURN 6.283185307179586

struct extent {                          /* of a scene */
	double low[3], high[3];
	bool has_ground;
};

/* ---- Views made for a scene; z of an eye that walks and of all targets counts from the ground ---- */

static double share_of(const struct extent *e, int axis, double share)
{
	return e->low[axis] + share * (e->high[axis] - e->low[axis]);
}

static double width_of(const struct extent *e)
{
	return fmax(fmax(e->high[0] - e->low[0], e->high[1] - e->low[1]), 10);
}

static void set(double at[3], double x, double y, double z)
{
	at[0] = x;
	at[1] = y;
	at[2] = z;
}

static void walk_view(const struct extent *e, uint32_t frame, struct eco_view *view)
{
	double radius = fmin(0.25 * width_of(e), WALK_RADIUS_M), angle = TURN * frame / FRAMES;
	double x = share_of(e, 0, 0.5), y = share_of(e, 1, 0.5);
	set(view->eye, x + radius * cos(angle), y + radius * sin(angle), EYE_M);
	set(view->target, x + radius * cos(angle + 0.5), y + radius * sin(angle + 0.5), EYE_M);
}

/* A stripe of a fifth of the width after the other; every other one goes back. */
static void flyover_view(const struct extent *e, uint32_t frame, struct eco_view *view)
{
	uint32_t stripes = 5, length = FRAMES / stripes, stripe = frame / length;
	double along = (frame % length + 0.5) / length, back = stripe % 2 ? -1 : 1;
	double x = share_of(e, 0, back > 0 ? along : 1 - along), y = share_of(e, 1, (stripe + 0.5) / stripes);
	double above = fmax(0.15 * width_of(e), 2 * EYE_M);
	set(view->eye, x, y, above + (e->has_ground ? 0 : e->high[2]));
	set(view->target, x + back * 2 * above, y, 0);
}

static void random_view(const struct extent *e, uint64_t *random, struct eco_view *view)
{
	double of[5];
	for (int i = 0; i < 5; i++)
		of[i] = eco_random_unit(eco_random_next(random));
	double most = fmax(0.5 * width_of(e), 2 * EYE_M);
	set(view->eye, share_of(e, 0, of[0]), share_of(e, 1, of[1]), EYE_M * pow(most / EYE_M, of[2]));
	set(view->target, share_of(e, 0, of[3]), share_of(e, 1, of[4]), 0);
}

static enum eco_code read_extent(struct view_fetch *fetch, struct extent *e, struct eco_error *error)
{
	char *text;
	enum eco_code code = view_fetch_scene(fetch, &text, error);
	if (code)
		return code;
	json_t *about = json_loads(text, 0, NULL), *need;
	size_t i;
	free(text);
	if (json_unpack(about, "{s:{s:[F,F,F],s:[F,F,F]}}", "bounds", "low", &e->low[0], &e->low[1],
			&e->low[2], "high", &e->high[0], &e->high[1], &e->high[2]))
		code = eco_fail(error, ECO_BAD_INPUT, "the scene does not say its bounds, as ecoserve does");
	json_array_foreach(json_object_get(about, "needs"), i, need)
		e->has_ground |= json_is_string(need) && !strcmp(json_string_value(need), "ground");
	json_decref(about);
	return code;
}

static enum eco_code make_views(struct view_views *views, const struct view_views_options *o,
	struct view_fetch *fetch, bool *above_ground, struct eco_error *error)
{
	struct extent e = { .has_ground = false };
	uint64_t random = o->seed;
	enum eco_code code = read_extent(fetch, &e, error);
	if (code)
		return code;
	views->items = calloc(FRAMES, sizeof *views->items);
	if (!views->items)
		return eco_no_memory(error, "views");
	views->count = FRAMES;
	*above_ground = e.has_ground;
	for (uint32_t i = 0; i < FRAMES; i++) {
		struct eco_view *view = &views->items[i];
		*view = (struct eco_view){ .up = { 0, 0, 1 }, .fov_y_deg = FOV_DEG };
		if (!strcmp(o->camera, "walk"))
			walk_view(&e, i, view);
		else if (!strcmp(o->camera, "flyover"))
			flyover_view(&e, i, view);
		else
			random_view(&e, &random, view);
	}
	return ECO_OK;
}

static enum eco_code read_views(struct view_views *views, const char *path, bool *above_ground,
	struct eco_error *error)
{
	struct eco_camera *camera = NULL;
	enum eco_code code = eco_camera_load(&camera, path, error);
	if (code)
		return code;
	uint32_t count = eco_camera_frame_count(camera);
	views->items = calloc(count, sizeof *views->items);
	views->count = views->items ? count : 0;
	*above_ground = eco_camera_above_ground(camera);
	for (uint32_t i = 0; i < views->count; i++)
		eco_camera_frame(camera, i, &views->items[i]);
	eco_camera_free(camera);
	return views->count ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u views", count);
}

static enum eco_code stand_all(struct view_views *views, const struct view_views_options *o,
	struct view_fetch *fetch, struct eco_error *error)
{
	struct view_store_options options = { 0 };
	struct view_store *store = NULL;
	enum eco_code code = view_store_new(&store, &options, error);
	for (uint32_t i = 0; i < views->count && !code; i++) {
		struct eco_request request = { .view = views->items[i] };
		struct view_fetch_result result;
		code = o->stop && *o->stop ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: view_stand(fetch, store, &request, &result, error);
		views->items[i] = request.view;
	}
	view_store_free(store);
	return code;
}

enum eco_code view_views_make(struct view_views *views, const struct view_views_options *o,
	struct view_fetch *fetch, struct eco_error *error)
{
	bool above_ground = false, made = !strcmp(o->camera, "walk") || !strcmp(o->camera, "flyover")
		|| !strcmp(o->camera, "random");
	*views = (struct view_views){ 0 };
	enum eco_code code = made ? make_views(views, o, fetch, &above_ground, error)
		: read_views(views, o->camera, &above_ground, error);
	if (!code && above_ground)
		code = stand_all(views, o, fetch, error);
	for (uint32_t i = 0; i < views->count && !code; i++) {
		views->items[i].width = o->width;
		views->items[i].height = o->height;
		eco_view_snap(&views->items[i], o->snap_m);
		code = eco_view_check(&views->items[i], error);
	}
	if (code)
		view_views_free(views);
	return code;
}

void view_views_free(struct view_views *views)
{
	free(views->items);
	*views = (struct view_views){ 0 };
}
