#include "tests/bench/pictures/bench_views.h"

#define VIEWS "tests/bench/pictures/pictures.json"

static bool read_view(const json_t *item, struct bench_view *to, struct eco_error *error)
{
	struct eco_view *view = &to->view;
	*view = (struct eco_view){ .up = { 0, 0, 1 }, .width = BENCH_SHOT_WIDTH,
		.height = BENCH_SHOT_HEIGHT };
	return !json_unpack((json_t *)item, "{s:s, s:[F,F,F], s:[F,F,F], s:F}", "camera", &to->camera,
		"eye", &view->eye[0], &view->eye[1], &view->eye[2],
		"target", &view->target[0], &view->target[1], &view->target[2], "fov_y_deg",
		&view->fov_y_deg) && !eco_view_check(view, error);
}

/* `done`: the share of all scenes before this one. */
static enum eco_code each_camera(struct bench *bench, const json_t *item, double done, bench_view_call *call,
	void *ctx, struct eco_error *error)
{
	const json_t *cameras = json_object_get(item, "cameras"), *camera;
	char pack[512];
	struct bench_view view = { .pack = pack, .scene = json_string_value(json_object_get(item, "scene")) };
	enum eco_code code;
	size_t i;
	if (!bench_shot_scene(bench, view.scene, pack, &code, error))
		return ECO_OK;
	json_array_foreach(cameras, i, camera) {
		bench_progress(bench, done, view.scene);
		if (!code)
			code = read_view(camera, &view, error) ? call(bench, ctx, &view, error)
				: eco_fail(error, ECO_BAD_INPUT, VIEWS ": a camera of %s is not one",
				view.scene);
	}
	return code;
}

enum eco_code bench_views_each(struct bench *bench, size_t quick, bench_view_call *call, void *ctx,
	struct eco_error *error)
{
	json_t *file = json_load_file(VIEWS, 0, NULL), *scenes = json_object_get(file, "scenes"), *item;
	enum eco_code code = scenes ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, VIEWS " cannot be read");
	size_t i;
	json_array_foreach(scenes, i, item) {
		if (!bench->full && i >= quick)
			bench_left_out(bench, json_string_value(json_object_get(item, "scene")));
		else if (!code)
			code = each_camera(bench, item, (double)i / (double)json_array_size(scenes), call,
				ctx, error);
	}
	json_decref(file);
	return code;
}

struct work { struct bench *bench; const struct bench_view *view; const struct bench_view_shoot *shoot; };

/* null where no answer has so few bytes */
static enum eco_code add_row(const struct work *w, struct bench_client *client, uint32_t budget, json_t *rows,
	struct eco_error *error)
{
	struct bench_frame frame = { .method = "ours", .rule = lod_rule_optimal,
		.request = { .view = w->view->view } };
	struct view_picture picture = { 0 };
	w->shoot->ask(budget, &frame);
	enum eco_code code = bench_client_frame(client, &frame, &picture, error);
	bool few = code == ECO_TOO_LARGE && frame.request.bytes != ECO_BYTES_UNBOUNDED;
	if (!code && w->shoot->show)
		code = w->shoot->show(w->bench, client, w->view, budget, &frame, &picture, error);
	json_array_append_new(rows, code ? json_null() : bench_shot_row(&frame));
	view_picture_free(&picture);
	return few ? ECO_OK : code;
}

static enum eco_code make_rows(void *ctx, json_t **rows, struct eco_error *error)
{
	const struct work *w = ctx;
	struct bench_client *client = NULL;
	enum eco_code code = bench_client_open(&client, w->view->pack, error);
	*rows = json_array();
	if (!code) {
		bench_client_see(client);
		bench_client_untimed(client);
	}
	for (uint32_t b = 0; b < w->shoot->count && !code; b++) {
		code = bench_go_on(w->bench, error);
		if (!code)
			code = add_row(w, client, b, *rows, error);
	}
	bench_client_close(client);
	return code;
}

enum eco_code bench_view_rows(struct bench *bench, const struct bench_view *view,
	const struct bench_view_shoot *shoot, json_t **rows, struct eco_error *error)
{
	const struct eco_view *v = &view->view;
	char unit[96], stamp[256];
	snprintf(unit, sizeof unit, "%s-%s-%s", shoot->name, view->scene, view->camera);
	snprintf(stamp, sizeof stamp, "%s %g %g %g %g %g %g %g", bench_pack_stamp(view->pack), v->eye[0], v->eye[1],
		v->eye[2], v->target[0], v->target[1], v->target[2], v->fov_y_deg);
	return bench_unit(bench, unit, stamp, make_rows, &(struct work){ bench, view, shoot }, rows, error);
}
