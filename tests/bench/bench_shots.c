#include "tests/bench/bench_shots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_picture.h"
#include "ecofiles/base/order.h"
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

ECO_ORDER(ascending, uint64_t, [0])

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

static json_t *row_of(const struct bench_frame *f)
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

struct work { struct bench *bench; const struct bench_method *method; const char *pack; struct eco_view view;
	const uint64_t *vertices; uint32_t count; };

static json_t *make_row(const struct work *w, struct bench_client *client, uint64_t vertices)
{
	struct bench_frame frame = { .rule = w->method->rule, .ignore_occlusion = w->method->ignore_occlusion,
		.request = { .view = w->view, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED } };
	bench_client_frame(client, &frame, NULL);
	return row_of(&frame);
}

static json_t *make_rows(void *ctx)
{
	const struct work *w = ctx;
	struct bench_client *client = bench_client_open(w->pack);
	json_t *rows = json_array();
	bench_client_see(client, w->bench);
	for (uint32_t i = 0; i < w->count; i++)
		json_array_append_new(rows, make_row(w, client, w->vertices[i]));
	bench_client_close(client);
	return rows;
}

json_t *bench_shots(struct bench *bench, const char *scene, uint32_t method, uint32_t view)
{
	char unit[96], stamp[512], pack[512];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	bench_scene(bench, scene, bench_methods[method].order, pack);
	bench_shot_views(bench, scene, requests);
	const struct eco_view *v = &requests[view].view;
	snprintf(unit, sizeof unit, "shots%u-%s-%u", method, scene, view);
	/* a full bench has other budgets and other views of these numbers */
	snprintf(stamp, sizeof stamp, "%s %d %g %g %g %g %g %g", bench_pack_stamp(pack), bench->full, v->eye[0], v->eye[1], v->eye[2],
		v->target[0], v->target[1], v->target[2]);
	return bench_unit(bench, unit, stamp, make_rows, &(struct work){ bench, &bench_methods[method],
		pack, requests[view].view, budgets, bench_budgets(bench, scene, budgets) });
}
