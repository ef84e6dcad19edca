#include "tests/bench/bench_shots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_picture.h"
#include "ecofiles/format/view.h"

const struct bench_method bench_methods[BENCH_METHODS] = {
	[BENCH_OURS] = { "ours", NULL, lod_rule_optimal, false, false },
	[BENCH_DEUSSEN_RULE] = { "Deussen's rule", NULL, lod_rule_deussen, false, false },
	[BENCH_STOCHASTIC] = { "stochastic order", "stochastic", lod_rule_optimal, false, false },
	[BENCH_UNOCCLUDED] = { "occlusion ignored", NULL, lod_rule_optimal, true, false },
	[BENCH_COMBINED] = { "combined order", "combined", lod_rule_optimal, false, true },
	[BENCH_DEUSSEN_2002] = { "Deussen's rule on the stochastic order", "stochastic", lod_rule_deussen,
		false, true },
	[BENCH_DENSITY_ORDER] = { "density order", "density", lod_rule_optimal, false, true },
	[BENCH_ORIENTATION_ORDER] = { "orientation order", "orientation", lod_rule_optimal, false, true } };

/* Vertices of the pictures in Deussen 2002, table 1: points + 2 lines + 3 triangles; Neubert 2011 for the
 * 5,000 trees. */
static const struct { const char *scene; uint64_t vertices[2]; } printed[] =
	{ { "trees640", { 2100000 } }, { "palms", { 1760000 } },
	{ "outdoor", { 2480000 } }, { "sunflowers", { 2190000 } }, { "trees5000", { 5000000, 26000000 } } };
static const uint64_t quick_budgets[] = { 30000, 100000, 300000, 1000000 };
static const uint64_t full_budgets[] = { 10000, 20000, 50000, 100000, 200000, 500000, 1000000, 2000000,
	5000000, 10000000 };

#define ONE_TREE 30u              /* a scene of one needs so many times less */

static int ascending(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return x < y ? -1 : x > y;
}

uint32_t bench_budgets(const struct bench *bench, const char *scene, uint64_t budgets[BENCH_BUDGETS_MAX])
{
	uint32_t count = bench->full ? sizeof full_budgets / sizeof *full_budgets
		: sizeof quick_budgets / sizeof *quick_budgets, kept = 0;
	memcpy(budgets, bench->full ? full_budgets : quick_budgets, count * sizeof *budgets);
	for (uint32_t i = 0; i < count && strcmp(scene, "crown") == 0; i++)
		budgets[i] /= ONE_TREE;
	for (size_t i = 0; i < sizeof printed / sizeof *printed; i++)
		for (int k = 0; k < 2 && strcmp(printed[i].scene, scene) == 0 && printed[i].vertices[k]; k++)
			budgets[count++] = printed[i].vertices[k];
	qsort(budgets, count, sizeof *budgets, ascending);
	for (uint32_t i = 0; i < count; i++)
		if (i == 0 || budgets[i] != budgets[kept - 1])
			budgets[kept++] = budgets[i];
	return kept;
}

uint32_t bench_shot_views(struct bench *bench, const char *scene,
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX])
{
	bool slow = strcmp(scene, "trees5000") == 0;
	uint32_t wanted = bench->full ? slow ? 4 : 8 : 2,
		count = bench_scene_views(bench, scene, requests, wanted);
	for (uint32_t i = 0; i < count; i++) {
		requests[i].view.width = BENCH_SHOT_WIDTH;
		requests[i].view.height = BENCH_SHOT_HEIGHT;
		requests[i].bytes = ECO_BYTES_UNBOUNDED;
	}
	return count;
}

double bench_shot_number(const json_t *row, const char *key)
{
	const json_t *value = json_object_get(row, key);
	return json_is_number(value) ? json_number_value(value) : NAN;
}

json_t *bench_shot_row(const struct bench_frame *f)
{
	const struct view_measures *m = &f->measures;
	const struct bench_truth *t = &f->truth;
	const struct { const char *key; double value; } figures[] = { { "vertices", (double)f->vertices },
		{ "bytes", (double)f->bytes }, { "q", m->score.q },
		{ "p", m->score.precision }, { "r", m->score.recall },
		{ "wrong", (double)(m->score.fp + m->score.fn) }, { "skill", m->score.skill },
		{ "owner_q", m->score.owner_q }, { "colour", f->colour_rms }, { "soft_q", m->soft_q },
		{ "picture_error", m->picture_error }, { "m16", m->blocks.color }, { "s16", m->blocks.contrast },
		{ "s16_abs", m->blocks.contrast_abs }, { "floor_error", t->floor }, { "one_floor", t->floor_one },
		{ "ceiling", t->ceiling }, { "truth_cpu_ms", t->cpu_ms },
		{ "predicted_q", f->predicted_q }, { "plan_ms", f->plan_ms },
		{ "decode_ms", f->decode_ms }, { "draw_ms", f->draw_ms } };
	json_t *row = json_object();
	for (size_t i = 0; i < sizeof figures / sizeof *figures; i++)
		json_object_set_new(row, figures[i].key,
			isfinite(figures[i].value) ? json_real(figures[i].value) : json_null());
	return row;
}

/* ---- Rows ---- */

struct work { struct bench *bench; const struct bench_view *view; const struct bench_shoot *shoot; };

static json_t *make_row(const struct work *w, struct bench_client *client, uint32_t row)
{
	const struct bench_shoot *shoot = w->shoot;
	const struct bench_method *method = shoot->method ? shoot->method : &bench_methods[BENCH_OURS];
	struct bench_frame frame = { .method = method->name, .rule = method->rule,
		.ignore_occlusion = method->ignore_occlusion,
		.request = { .view = w->view->view, .vertices = shoot->vertices[row], .bytes = ECO_BYTES_UNBOUNDED } };
	struct view_picture picture = { 0 };
	bench_client_frame(client, &frame, &picture);
	if (shoot->show)
		shoot->show(w->bench, client, w->view, row, &frame, &picture);
	view_picture_free(&picture);
	return bench_shot_row(&frame);
}

static json_t *make_rows(void *ctx)
{
	const struct work *w = ctx;
	struct bench_client *client = bench_client_open(w->view->pack);
	json_t *rows = json_array();
	bench_client_see(client, w->bench);
	if (!w->shoot->method)
		bench_client_untimed(client);
	for (uint32_t i = 0; i < w->shoot->count; i++)
		json_array_append_new(rows, make_row(w, client, i));
	bench_client_close(client);
	return rows;
}

json_t *bench_view_rows(struct bench *bench, const struct bench_view *view, const struct bench_shoot *shoot)
{
	const struct eco_view *v = &view->view;
	char unit[96], stamp[512];
	snprintf(unit, sizeof unit, "%s-%s-%s", shoot->name, view->scene, view->camera);
	snprintf(stamp, sizeof stamp, "%s %u %g %g %g %g %g %g %g", bench_pack_stamp(view->pack),
		shoot->count, v->eye[0], v->eye[1], v->eye[2], v->target[0], v->target[1], v->target[2], v->fov_y_deg);
	return bench_unit(bench, unit, stamp, make_rows, &(struct work){ bench, view, shoot });
}

json_t *bench_shots(struct bench *bench, const char *scene, uint32_t method, uint32_t view)
{
	char name[16], camera[16], pack[512];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	bench_scene(bench, scene, bench_methods[method].order, pack);
	bench_shot_views(bench, scene, requests);
	snprintf(name, sizeof name, "shots%u", method);
	snprintf(camera, sizeof camera, "%u", view);
	return bench_view_rows(bench, &(struct bench_view){ scene, camera, pack, requests[view].view },
		&(struct bench_shoot){ .name = name, .count = bench_budgets(bench, scene, budgets),
			.vertices = budgets, .method = &bench_methods[method] });
}

/* ---- Cameras ---- */

#define VIEWS "tests/bench/pictures/pictures.json"

static bool read_view(const json_t *item, struct bench_view *to)
{
	struct eco_view *view = &to->view;
	*view = (struct eco_view){ .up = { 0, 0, 1 }, .width = BENCH_SHOT_WIDTH,
		.height = BENCH_SHOT_HEIGHT };
	return !json_unpack((json_t *)item, "{s:s, s:[F,F,F], s:[F,F,F], s:F}", "camera", &to->camera,
		"eye", &view->eye[0], &view->eye[1], &view->eye[2],
		"target", &view->target[0], &view->target[1], &view->target[2], "fov_y_deg",
		&view->fov_y_deg) && !eco_view_check(view, NULL);
}

void bench_views_each(struct bench *bench, size_t quick, bench_view_call *call, void *ctx)
{
	json_t *file = json_load_file(VIEWS, 0, NULL), *scenes = json_object_get(file, "scenes"), *item, *camera;
	char pack[512], what[96];
	size_t i, k;
	if (!scenes)
		must(eco_fail(must_error, ECO_BAD_INPUT, VIEWS " cannot be read"));
	json_array_foreach(scenes, i, item) {
		struct bench_view view = { .pack = pack,
			.scene = json_string_value(json_object_get(item, "scene")) };
		if (!bench->full && i >= quick)
			bench_left_out(bench, view.scene);
		else if (bench_scene_there(bench, view.scene, pack))
			json_array_foreach(json_object_get(item, "cameras"), k, camera) {
				if (!read_view(camera, &view))
					must(eco_fail(must_error, ECO_BAD_INPUT,
						VIEWS ": a camera of %s is not one", view.scene));
				snprintf(what, sizeof what, "%s, %s", view.scene, view.camera);
				bench_progress((double)i / (double)json_array_size(scenes), what);
				call(bench, ctx, &view);
			}
	}
	json_decref(file);
}
