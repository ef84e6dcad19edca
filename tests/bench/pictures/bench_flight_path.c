/* The path of a flight: made from the bounds of a scene's plants and the height of its ground alone, so that
 * no scene's own cameras, which people chose, decide. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "client-min/view_select.h"
#include "ecofiles/format/view.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_state.h"
#include "tests/bench/pictures/bench_flight.h"

#define FOV_DEG 55.0
#define EYE_M 2.5                        /* above the ground, where the flight goes through */
#define EYE_LEAST_M 1.0                  /* between keyframes */
#define DOWN_S 20u                       /* the air ends; the rest goes through */
#define KEY_S 4u

/* The longer horizontal side is along. */
struct stage {
	const struct view_ground *ground;
	double centre[3], along[2], across[2], half_along, half_across, half;
};

/* Metres from the centre, and above the ground there. */
static void put(const struct stage *s, double along, double across, double above, double out[3])
{
	double ground;
	for (int k = 0; k < 2; k++)
		out[k] = s->centre[k] + along * s->along[k] + across * s->across[k];
	bool has = view_ground_height(s->ground, out[0], out[1], &ground);
	out[2] = above + (has ? ground : s->centre[2]);
}

/* Where the eye is on its way through, from 0 to 1. */
static void put_through(const struct stage *s, double way, double above, double out[3])
{
	put(s, s->half_along * (1.8 * way - 0.9), 0.2 * s->half_across * sin(2 * M_PI * way), above, out);
}

static void put_keyframe(const struct stage *s, double time_s, double eye[3], double target[3])
{
	double way = (time_s - DOWN_S) / (BENCH_FLIGHT_S - DOWN_S), air = 1 - time_s / DOWN_S;
	if (way >= 0) {
		put_through(s, way, EYE_M, eye);
		put_through(s, way + 0.15, EYE_M, target);
		return;
	}
	put(s, -s->half_along * (0.9 + 1.1 * air), s->half * 0.8 * air, EYE_M + s->half * 1.2 * air * air,
		eye);
	put(s, s->half_along * (-0.63 + 0.63 * air), 0, EYE_M, target);
}

static char *write_script(const struct stage *s)
{
	char *text = NULL;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		return NULL;
	fprintf(out, "{\"fps\": %u, \"keyframes\": [", BENCH_FLIGHT_FPS);
	for (uint32_t t = 0; t <= BENCH_FLIGHT_S; t += KEY_S) {
		double eye[3], target[3];
		put_keyframe(s, t, eye, target);
		fprintf(out, "%s{\"time_s\": %u, \"eye\": [%.9g, %.9g, %.9g], "
			"\"target\": [%.9g, %.9g, %.9g], \"fov_y_deg\": %g}", t ? ", " : "", t, eye[0],
			eye[1], eye[2], target[0], target[1], target[2], FOV_DEG);
	}
	fputs("]}", out);
	return fclose(out) ? free(text), NULL : text;
}

static void take_views(const struct stage *s, const struct eco_camera *camera, uint32_t first,
	struct bench_flight *flight)
{
	for (uint32_t f = 0; f < flight->count; f++) {
		struct eco_view *view = &flight->views[f];
		double ground;
		memset(view, 0, sizeof *view);
		eco_camera_frame(camera, first + f, view);
		view->width = BENCH_SHOT_WIDTH;
		view->height = BENCH_SHOT_HEIGHT;
		if (view_ground_height(s->ground, view->eye[0], view->eye[1], &ground))
			view->eye[2] = fmax(view->eye[2], ground + EYE_LEAST_M);
	}
}

static struct stage stage_of(const struct eco_tile *root, const struct view_ground *ground)
{
	double side[2] = { root->high[0] - root->low[0], root->high[1] - root->low[1] };
	int longer = side[1] > side[0];
	struct stage s = { .ground = ground, .centre = { 0, 0, root->low[2] } };
	for (int k = 0; k < 2; k++)
		s.centre[k] = (root->low[k] + root->high[k]) / 2;
	s.along[longer] = s.across[!longer] = 1;
	s.half_along = side[longer] / 2;
	s.half_across = side[!longer] / 2;
	s.half = fmax(s.half_along, root->high[2] - root->low[2]);
	return s;
}

/* The whole ground, at full detail: a picture from straight above. */
static enum eco_code fetch_ground(const struct srv_scene *scene, struct view_store *store,
	struct view_selection *selection, struct eco_error *error)
{
	const struct eco_tile *root = &scene->pack->scene.tiles[scene->pack->scene.root];
	struct eco_request request = { .bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN,
		.view = { .up = { 0, 1, 0 }, .fov_y_deg = 90, .width = 512, .height = 512 } };
	struct lod_eye eye;
	for (int k = 0; k < 3; k++)
		request.view.eye[k] = request.view.target[k] = (root->low[k] + root->high[k]) / 2;
	request.view.eye[2] =
		root->high[2] + hypot(root->high[0] - root->low[0], root->high[1] - root->low[1]);
	lod_eye_make(&eye, &request.view);
	enum eco_code code = bench_fetch(NULL, scene, &request, store, error);
	return code ? code : view_select_make(selection, store, &eye, error);
}

static enum eco_code make_views(const struct srv_scene *scene, struct bench_flight *flight, uint32_t first,
	struct eco_error *error)
{
	const struct eco_scene *tables = &scene->pack->scene;
	struct view_store_options options = { .images = false };
	struct view_selection selection = { 0 };
	struct view_store *store = NULL;
	struct eco_camera *camera = NULL;
	char *script = NULL;
	enum eco_code code = view_store_new(&store, &options, error);
	if (!code)
		code = fetch_ground(scene, store, &selection, error);
	struct stage stage = stage_of(&tables->tiles[tables->root], &selection.ground);
	if (!code)
		script = write_script(&stage);
	if (!code)
		code = script ? eco_camera_parse(&camera, script, strlen(script), "flight", error)
			: eco_fail(error, ECO_NO_MEMORY, "no memory for a path");
	if (!code)
		take_views(&stage, camera, first, flight);
	eco_camera_free(camera);
	free(script);
	view_select_free(&selection);
	view_store_free(store);
	return code;
}

enum eco_code bench_flight_path(struct bench *bench, struct bench_flight *flight, uint32_t first,
	struct eco_error *error)
{
	struct srv_store served;
	char folder[1024];
	size_t size = flight->count * sizeof *flight->views;
	flight->views = malloc(size);
	if (!flight->views)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a path");
	srv_store_init(&served);
	enum eco_code code = srv_store_add(&served, "flight", flight->pack, error);
	if (!code)
		code = make_views(served.scenes[0], flight, first, error);
	srv_store_free(&served);
	snprintf(folder, sizeof folder, "%s/flight", bench->cache);
	snprintf(flight->files, sizeof flight->files, "%s/%s-%u", folder, flight->scene, flight->count);
	if (code)
		return code;
	snprintf(flight->stamp, sizeof flight->stamp, "%s %u %016llx", bench_pack_stamp(flight->pack),
		flight->every, (unsigned long long)XXH3_64bits(flight->views, size));
	return bench_folder_make(folder, error);
}
