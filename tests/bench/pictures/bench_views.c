#include "tests/bench/pictures/bench_views.h"

#define VIEWS "tests/bench/pictures/pictures.json"

const json_t *bench_views_load(json_t **file, struct eco_error *error)
{
	*file = json_load_file(VIEWS, 0, NULL);
	const json_t *scenes = json_object_get(*file, "scenes");
	if (json_is_array(scenes))
		return scenes;
	eco_fail(error, ECO_BAD_INPUT, VIEWS " cannot be read");
	return NULL;
}

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

enum eco_code bench_views_each(struct bench *bench, const json_t *scenes, size_t quick, bench_view_call *call,
	void *ctx, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	size_t count = json_array_size(scenes);
	for (size_t i = 0; i < count && !code; i++) {
		const json_t *item = json_array_get(scenes, i), *cameras = json_object_get(item, "cameras");
		char pack[512];
		struct bench_view view = { .pack = pack,
			.scene = json_string_value(json_object_get(item, "scene")) };
		if (view.scene && !bench->full && i >= quick) {
			bench_left_out(bench, view.scene);
			continue;
		}
		if (!view.scene || !bench_shot_scene(bench, view.scene, pack, &code, error))
			continue;
		for (size_t c = 0; c < json_array_size(cameras) && !code; c++) {
			bench_progress(bench, ((double)i + (double)c / (double)json_array_size(cameras))
				/ (double)count, view.scene);
			code = read_view(json_array_get(cameras, c), &view, error)
				? call(bench, ctx, &view, error)
				: eco_fail(error, ECO_BAD_INPUT, VIEWS ": a camera of %s is not one",
				view.scene);
		}
	}
	return code;
}

static enum eco_code make_rows(struct bench *bench, const struct bench_view *view,
	const struct bench_view_shoot *shoot, json_t *rows, struct eco_error *error)
{
	struct bench_client *client = NULL;
	enum eco_code code = bench_client_open(&client, view->pack, error);
	if (!code) {
		bench_client_see(client);
		bench_client_keep(client, bench);
		bench_client_untimed(client);
	}
	for (uint32_t b = 0; b < shoot->count && !code; b++) {
		struct bench_frame frame = { .method = "ours", .rule = lod_rule_optimal,
			.request = { .view = view->view } };
		struct view_picture picture = { 0 };
		json_t *row = NULL;
		shoot->ask(b, &frame);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: bench_client_frame(client, &frame, &picture, error);
		bool few = code == ECO_TOO_LARGE && frame.request.bytes != ECO_BYTES_UNBOUNDED;
		if (!code)
			code = shoot->take(bench, client, view, b, &frame, &picture, &row, error);
		else if (few)
			code = ECO_OK;
		if (!code)
			json_array_append_new(rows, row ? row : json_null());
		view_picture_free(&picture);
	}
	bench_client_close(client);
	return code;
}

void bench_view_stamp(const struct bench_view *view, char stamp[256])
{
	const struct eco_view *v = &view->view;
	snprintf(stamp, 256, "%s %g %g %g %g %g %g %g", bench_pack_stamp(view->pack), v->eye[0], v->eye[1],
		v->eye[2], v->target[0], v->target[1], v->target[2], v->fov_y_deg);
}

enum eco_code bench_view_rows(struct bench *bench, const struct bench_view *view,
	const struct bench_view_shoot *shoot, json_t **rows, struct eco_error *error)
{
	char unit[96], stamp[256];
	snprintf(unit, sizeof unit, "%s-%s-%s", shoot->name, view->scene, view->camera);
	bench_view_stamp(view, stamp);
	*rows = bench_recall(bench, unit, stamp);
	if (*rows)
		return ECO_OK;
	json_t *made = json_array();
	enum eco_code code = make_rows(bench, view, shoot, made, error);
	if (code)
		json_decref(made);
	else
		*rows = bench_keep(bench, unit, stamp, made);
	return code;
}
