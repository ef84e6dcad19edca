/* Turning on a slow link: somebody walks at eye level, turns by a right angle every 20 s, and is sent no more
 * than the link carries; with and without telling the view after the next turn. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/pictures/bench_views.h"

#define VERTICES 1000000u
#define STEP_S 0.5
#define LINK_BYTES 62500u        /* of a step, at 1 Mbit/s */
#define LEG_STEPS 40u            /* straight ahead, and the last of them turns */
#define LEGS 3u
#define STEPS (LEGS * LEG_STEPS)
#define WINDOW 6u                /* steps after a turn that are looked at: 3 s */
#define WALK_M_S 0.25
#define ABOVE 1.2                /* picture error over that of a link without limit */
#define SEEN_LEAST 5e-3          /* picture errors below are none: nobody sees them */

enum way { STEADY, ALONE, TOLD, WAYS };
static const char *const ways[WAYS] = { "steady", "alone", "told" };

struct study {
	struct bench_table *table;
	uint32_t looked, above[WAYS];
	double bytes[WAYS];
};

/* The camera of the scene turned by right angles, and walked from leg to leg. */
static struct eco_view view_at(const struct eco_view *first, uint32_t step)
{
	struct eco_view view = *first;
	double to[2] = { first->target[0] - first->eye[0], first->target[1] - first->eye[1] };
	double length = sqrt(to[0] * to[0] + to[1] * to[1]), walked = STEP_S * WALK_M_S;
	for (uint32_t i = 1; i <= step; i++) {
		if (i % LEG_STEPS) {
			for (int k = 0; k < 2; k++)
				view.eye[k] += walked * to[k] / length;
		} else {
			double x = to[0];
			to[0] = -to[1];
			to[1] = x;
		}
	}
	for (int k = 0; k < 2; k++)
		view.target[k] = view.eye[k] + to[k];
	return view;
}

static bool is_looked_at(uint32_t step) { return step >= LEG_STEPS && step % LEG_STEPS < WINDOW; }

static enum eco_code take_step(struct bench_client *client, const struct eco_view *first, uint32_t step,
	enum way way, json_t *bytes, json_t *seen, struct eco_error *error)
{
	uint32_t turn = (step / LEG_STEPS + 1) * LEG_STEPS;
	struct bench_frame frame = { .method = ways[way], .rule = lod_rule_optimal, .request = {
		.view = view_at(first, step), .vertices = VERTICES,
		.bytes = way == STEADY ? ECO_BYTES_UNBOUNDED : LINK_BYTES } };
	struct view_picture picture = { 0 };
	if (way == TOLD && turn < STEPS) {
		struct eco_view next = view_at(first, turn);
		frame.request.next.given = true;
		memcpy(frame.request.next.eye, next.eye, sizeof next.eye);
		memcpy(frame.request.next.target, next.target, sizeof next.target);
	}
	bool looks = is_looked_at(step);
	enum eco_code code = looks ? bench_client_reference(client, &frame.request, NULL, error) : ECO_OK;
	if (!code)
		code = bench_client_step(client, &frame, looks ? &picture : NULL, error);
	if (!code && looks)
		code = bench_client_score(client, &frame, &picture, error);
	view_picture_free(&picture);
	json_array_append_new(bytes, json_integer((json_int_t)frame.bytes));
	json_array_append_new(seen, looks && !code ? json_real(frame.picture_error) : json_null());
	return code;
}

static enum eco_code walk(struct bench *bench, const struct bench_view *view, enum way way, json_t **row,
	struct eco_error *error)
{
	struct bench_client *client = NULL;
	json_t *bytes = json_array(), *seen = json_array();
	enum eco_code code = bench_client_open(&client, view->pack, error);
	if (!code) {
		bench_client_see(client);
		bench_client_keep(client, bench);
		bench_client_untimed(client);
	}
	for (uint32_t step = 0; step < STEPS && !code; step++)
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: take_step(client, &view->view, step, way, bytes, seen, error);
	bench_client_close(client);
	*row = json_pack("{s:o, s:o}", "bytes", bytes, "seen", seen);
	return code;
}

static enum eco_code recall(struct bench *bench, const struct bench_view *view, enum way way, json_t **row,
	struct eco_error *error)
{
	char unit[96];
	snprintf(unit, sizeof unit, "ahead-%s-%s", view->scene, ways[way]);
	*row = bench_recall(bench, unit, bench_pack_stamp(view->pack));
	if (*row)
		return ECO_OK;
	json_t *made;
	enum eco_code code = walk(bench, view, way, &made, error);
	if (code)
		json_decref(made);
	else
		*row = bench_keep(bench, unit, bench_pack_stamp(view->pack), made);
	return code;
}

static double number_at(const json_t *row, const char *key, uint32_t step)
{
	return json_number_value(json_array_get(json_object_get(row, key), step));
}

static void add_rows(struct study *s, const char *scene, json_t *const rows[WAYS])
{
	for (uint32_t step = 0; step < STEPS; step++) {
		double seen[WAYS], steady = fmax(number_at(rows[STEADY], "seen", step), SEEN_LEAST);
		for (int w = 0; w < WAYS; w++) {
			s->bytes[w] += number_at(rows[w], "bytes", step);
			seen[w] = number_at(rows[w], "seen", step);
			s->above[w] += is_looked_at(step) && seen[w] > ABOVE * steady;
		}
		if (!is_looked_at(step))
			continue;
		s->looked++;
		bench_table_row(s->table, "%s,%.1f,%.4f,%.4f,%.4f,%.0f,%.0f", scene,
			(step % LEG_STEPS) * STEP_S, seen[STEADY], seen[ALONE], seen[TOLD],
			number_at(rows[ALONE], "bytes", step), number_at(rows[TOLD], "bytes", step));
	}
}

static enum eco_code study_view(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	json_t *rows[WAYS];
	if (strcmp(view->camera, "eye"))
		return ECO_OK;
	for (int w = 0; w < WAYS && !code; w++)
		code = recall(bench, view, (enum way)w, &rows[w], error);
	if (!code)
		add_rows(ctx, view->scene, rows);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *views;
	const json_t *scenes = bench_views_load(&views, error);
	struct study s = { .looked = 0 };
	if (!scenes) {
		json_decref(views);
		return ECO_BAD_INPUT;
	}
	bench_say(bench, "From each scene's camera at eye level, %u x %u, at most %u vertices: %g m/s "
		"straight ahead, and every %.0f s a right angle to the left. Every %.1f s a request for what "
		"1 Mbit/s carries in that time. Looked at: the %.0f s after each turn; steady: without limit "
		"of bytes.",
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, VERTICES, WALK_M_S, LEG_STEPS * STEP_S, STEP_S,
		WINDOW * STEP_S);
	s.table = bench_table_open(bench, "ahead", "scene,seconds after the turn,picture error steady,"
		"alone,told,bytes alone,bytes told", true);
	enum eco_code code = bench_views_each(bench, scenes, BENCH_VIEWS_QUICK, study_view, &s, error);
	bench_table_close(s.table);
	if (!code && s.looked && s.above[ALONE]) {
		bench_key(bench, "ahead_above", (double)s.above[TOLD] / s.above[ALONE], "<= 0.5: frames "
			"whose picture error is 20 % above the steady one, told of the turn over not told");
		bench_key(bench, "ahead_above_alone", (double)s.above[ALONE] / s.looked, "share of the "
			"frames looked at, not told");
		bench_key(bench, "ahead_bytes", s.bytes[TOLD] / s.bytes[ALONE],
			"<= 1.1: bytes told over not told");
	}
	json_decref(views);
	return code;
}

const struct bench_section bench_ahead = { "ahead", "Turning on a slow link", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o "
	"tests/bench/pictures/bench_ahead.o tests/bench/pictures/bench_views.o "
	"tests/bench/pictures/bench_widest.o" };
