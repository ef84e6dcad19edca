#include "tests/bench/bench_shots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/view.h"

const struct bench_method bench_methods[BENCH_METHODS] = {
	[BENCH_OURS] = { "ours", NULL, lod_rule_optimal, false, false },
	[BENCH_DEUSSEN_RULE] = { "Deussen's rule", NULL, lod_rule_deussen, false, false },
	[BENCH_STOCHASTIC] = { "stochastic order", "stochastic", lod_rule_optimal, false, false },
	[BENCH_UNOCCLUDED] = { "occlusion ignored", NULL, lod_rule_optimal, true, false },
	[BENCH_COMBINED] = { "combined order", "combined", lod_rule_optimal, false, true },
	[BENCH_DEUSSEN_2002] = { "Deussen's rule on the stochastic order", "stochastic", lod_rule_deussen, false,
		true },
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

bool bench_scene_asked(struct bench *bench, const char *scene)
{
	bool asked = bench->full || bench_scene_quick(scene);
	if (!asked)
		bench_left_out(bench, scene);
	return asked;
}

bool bench_shot_scene(struct bench *bench, const char *scene, char pack[512], enum eco_code *code,
	struct eco_error *error)
{
	*code = ECO_OK;
	if (!bench_scene_asked(bench, scene))
		return false;
	*code = bench_scene(bench, scene, NULL, pack, error);
	if (*code != ECO_NOT_FOUND)
		return true;
	bench_say(bench, "Without %s: %s", scene, error->text);
	*error = (struct eco_error){ 0 };
	*code = ECO_OK;
	return false;
}

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
	const struct { const char *key; double value; } figures[] = { { "vertices", (double)f->vertices },
		{ "bytes", (double)f->bytes }, { "plan_bytes", (double)f->plan_bytes }, { "q", f->score.q },
		{ "p", f->score.precision }, { "r", f->score.recall },
		{ "wrong", (double)(f->score.fp + f->score.fn) }, { "skill", f->score.skill },
		{ "owner_q", f->score.owner_q }, { "colour", f->colour_rms }, { "soft_q", f->soft_q },
		{ "ceiling", f->ceiling }, { "picture_error", f->picture_error },
		{ "predicted_q", f->predicted_q }, { "plan_ms", f->plan_ms },
		{ "decode_ms", f->decode_ms }, { "draw_ms", f->draw_ms } };
	json_t *row = json_object();
	for (size_t i = 0; i < sizeof figures / sizeof *figures; i++)
		json_object_set_new(row, figures[i].key,
			isfinite(figures[i].value) ? json_real(figures[i].value) : json_null());
	return row;
}

struct work { struct bench *bench; const char *scene, *pack; const struct bench_method *method; uint32_t view; };

static enum eco_code shoot(void *ctx, json_t **rows, struct eco_error *error)
{
	const struct work *w = ctx;
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	uint32_t count = bench_budgets(w->bench, w->scene, budgets),
		views = bench_shot_views(w->bench, w->scene, requests);
	struct bench_client *client = NULL;
	if (w->view >= views)
		return eco_fail(error, ECO_NOT_FOUND, "%s has %u views", w->scene, views);
	enum eco_code code = bench_client_open(&client, w->pack, error);
	if (!code)
		bench_client_see(client);
	*rows = json_array();
	for (uint32_t i = 0; i < count && !code; i++) {
		struct bench_frame frame = { .method = w->method->name, .rule = w->method->rule,
			.ignore_occlusion = w->method->ignore_occlusion, .request = requests[w->view] };
		frame.request.vertices = budgets[i];
		code = bench_go_on(w->bench, error);
		if (!code)
			code = bench_client_frame(client, &frame, NULL, error);
		json_array_append_new(*rows, bench_shot_row(&frame));
	}
	bench_client_close(client);
	return code;
}

enum eco_code bench_shots(struct bench *bench, const char *scene, uint32_t method, uint32_t view,
	json_t **rows, struct eco_error *error)
{
	char name[128], pack[512];
	enum eco_code code = bench_scene(bench, scene, bench_methods[method].order, pack, error);
	if (code)
		return code;
	snprintf(name, sizeof name, "shots-%s-%u-%u-%s", scene, method, view, bench->full ? "full" : "quick");
	return bench_unit(bench, name, bench_pack_stamp(pack), shoot,
		&(struct work){ bench, scene, pack, &bench_methods[method], view }, rows, error);
}
