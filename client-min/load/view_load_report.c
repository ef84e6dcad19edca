#include "client-min/load/view_load.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_reference.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"

/* ---- Columns ---- */

enum group { GROUP_ALL, GROUP_WARM, GROUP_COLD, GROUPS };
static const char *const group_names[GROUPS] = { "all", "warm", "cold" };

#define QUANTILES 5
static const struct { const char *name; double share; } quantiles[QUANTILES] = {
	{ "p50", 0.5 }, { "p90", 0.9 },
	{ "p99", 0.99 }, { "p99_9", 0.999 }, { "max", 1 } };

/* given_up: also of answers that were given up: their time until then */
#define FIELD(name) offsetof(struct view_answer, name)
static const struct column_kind { const char *name, *title; size_t offset; bool given_up; } kinds[] = {
	{ "latency_ms", "latency", FIELD(done_ms), true },
	{ "service_ms", "of it service", FIELD(service_ms), true },
	{ "first_byte_ms", "first byte", FIELD(first_byte_ms), false },
	{ "picture_ms", "first picture", FIELD(picture_ms), false },
	{ "q80_ms", "predicted Q .8", FIELD(q80_ms), false },
	{ "q90_ms", "predicted Q .9", FIELD(q90_ms), false },
	{ "plan_ms", "server's plan", FIELD(plan_ms), false },
};
#define KINDS (sizeof kinds / sizeof *kinds)

/* Values that are not NaN, ascending; `of`: answers of the group that could have had one. */
struct column { float *values; uint32_t count, of; };

static float value_of(const struct view_answer *answer, const struct column_kind *kind)
{
	return *(const float *)((const char *)answer + kind->offset);
}

static bool is_of(const struct view_answer *answer, enum group group)
{
	return group == GROUP_ALL || answer->cold == (group == GROUP_COLD);
}

/* A failure at once says nothing of times; an answer that was given up took at least so long. */
static bool has_time(const struct view_answer *answer, const struct column_kind *kind)
{
	return answer->outcome == VIEW_ANSWERED || (kind->given_up && (answer->outcome == VIEW_LATE
		|| answer->outcome == VIEW_UNFINISHED));
}

ECO_ORDER(by_value, float, [0])

/* The caller frees its values. */
static struct column make_column(const struct view_answers *answers, const struct column_kind *kind,
	enum group group)
{
	struct column column = { .values = eco_alloc(answers->count, sizeof *column.values) };
	for (uint32_t i = 0; i < answers->count; i++) {
		const struct view_answer *answer = &answers->items[i];
		if (!is_of(answer, group) || !has_time(answer, kind))
			continue;
		float value = value_of(answer, kind);
		column.of++;
		if (!isnan(value))
			column.values[column.count++] = value;
	}
	qsort(column.values, column.count, sizeof *column.values, by_value);
	return column;
}

/* Bytes of each client together. */
static struct column client_bytes(const struct view_load_report *r)
{
	const struct view_answers *answers = &r->answers;
	uint32_t clients = (uint32_t)r->options->clients;
	uint64_t *bytes = eco_alloc(clients, sizeof *bytes);
	float *values = eco_alloc(clients, sizeof *values);
	for (uint32_t i = 0; i < answers->count; i++)
		bytes[answers->items[i].client] += answers->items[i].bytes;
	for (uint32_t i = 0; i < clients; i++)
		values[i] = (float)bytes[i];
	free(bytes);
	qsort(values, clients, sizeof *values, by_value);
	return (struct column){ values, clients, clients };
}

/* The least value that a share of them does not exceed; NaN without values. */
static double quantile(const float *values, uint32_t count, double share)
{
	double at = ceil(share * count);
	uint32_t index = at < 1 ? 0 : at > count ? count - 1 : (uint32_t)at - 1;
	return count ? (double)values[index] : NAN;
}

/* All clients, and where there are both kinds, each of them. */
static bool has_group(const struct view_load_options *o, enum group group)
{
	return group == GROUP_ALL || (o->cold && o->cold < o->clients);
}

/* ---- For people ---- */

static void print_values(FILE *out, const char *name, const struct column *column, double unit,
	const char *unit_name)
{
	fprintf(out, "  %-15s", name);
	for (size_t i = 0; i < QUANTILES; i++) {
		double value = quantile(column->values, column->count, quantiles[i].share);
		isnan(value) ? fprintf(out, " %9s", "-") : fprintf(out, " %9.1f", value * unit);
	}
	fprintf(out, " %s", unit_name);
	if (column->count < column->of)
		fprintf(out, ", of %.1f %%", 100.0 * column->count / column->of);
	fputc('\n', out);
}

static void print_group(const struct view_load_report *r, enum group group, FILE *out)
{
	fprintf(out, "%-17s", group ? group_names[group] : "times");
	for (size_t i = 0; i < QUANTILES; i++)
		fprintf(out, " %9s", quantiles[i].name);
	fputc('\n', out);
	for (size_t i = 0; i < KINDS; i++) {
		struct column column = make_column(&r->answers, &kinds[i], group);
		print_values(out, kinds[i].title, &column, 1, "ms");
		free(column.values);
	}
}

static void print_counts(const struct view_load_report *r, FILE *out)
{
	const struct view_load_options *o = r->options;
	fprintf(out, "requests          %u in %.1f s: %.1f /s, %.2f MB/s\n", r->answers.count, r->seconds,
		r->answers.count / r->seconds, (double)r->bytes / r->seconds / 1e6);
	fprintf(out, "clients           %llu, %llu of them cold, %llu decoding; ",
		(unsigned long long)o->clients, (unsigned long long)o->cold, (unsigned long long)o->decoding);
	if (o->rate > 0)
		fprintf(out, "open loop, %g requests/s%s\n", o->rate, o->random_arrivals ? " at random" : "");
	else
		fputs("closed loop\n", out);
}

static void print_faults(const struct view_load_report *r, FILE *out)
{
	fprintf(out,
		"chunks            %llu, %llu decoded, %llu named, %llu sent twice; %llu answers without "
		"a picture\n",
		(unsigned long long)r->chunks, (unsigned long long)r->chunks_decoded,
		(unsigned long long)r->chunks_named, (unsigned long long)r->chunks_twice, (unsigned long long)r->nothing);
	if (r->renewed)
		fprintf(out, "packs             %llu times a client started again, because the scene's "
			"pack changed\n",
			(unsigned long long)r->renewed);
	if (r->resumed)
		fprintf(out, "resumed           %llu answers broke off, and came when asked for again\n",
			(unsigned long long)r->resumed);
	fprintf(out, "violations        vertices %llu, bytes %llu\n",
		(unsigned long long)r->vertex_violations, (unsigned long long)r->byte_violations);
	fputs("failures         ", out);
	for (int i = VIEW_ANSWERED + 1; i < VIEW_OUTCOMES; i++)
		fprintf(out, " %s %llu%s", view_outcome_names[i], (unsigned long long)r->outcomes[i],
			i + 1 < VIEW_OUTCOMES ? "," : "\n");
	if (r->first_failure[0])
		fprintf(out, "the first         %s\n", r->first_failure);
	fprintf(out, "ecoload itself    %.2f of %u processors\n", r->cpu_seconds / r->seconds,
		r->processors);
	for (uint32_t i = 0; i < r->scored_count; i++) {
		const struct view_scored *v = &r->scored[i];
		fprintf(out, "view %-6u       Q %.4f, Precision %.4f, Recall %.4f", v->frame, v->q,
			v->precision, v->recall);
		isnan(v->predicted_q) ? fputs("; no picture fits\n", out)
			: fprintf(out, "; predicted Q %.4f%s\n", v->predicted_q,
			v->coarse ? "; the reference is not full detail" : "");
	}
}

void view_load_print(const struct view_load_report *r, FILE *out)
{
	struct column column = client_bytes(r);
	print_counts(r, out);
	for (int group = 0; group < GROUPS; group++)
		if (has_group(r->options, (enum group)group))
			print_group(r, (enum group)group, out);
	print_values(out, "bytes/client", &column, 1e-3, "kB");
	free(column.values);
	print_faults(r, out);
}

/* ---- JSON ---- */

static json_t *real(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

/* Frees its values. */
static json_t *column_json(const struct column *column)
{
	json_t *o = json_object();
	for (size_t i = 0; i < QUANTILES; i++)
		json_object_set_new(o, quantiles[i].name, real(quantile(column->values,
			column->count, quantiles[i].share)));
	json_object_set_new(o, "reached", real(column->of ? (double)column->count / column->of : NAN));
	free(column->values);
	return o;
}

static void add_group(const struct view_load_report *r, enum group group, json_t *into)
{
	for (size_t i = 0; i < KINDS; i++) {
		struct column column = make_column(&r->answers, &kinds[i], group);
		json_object_set_new(into, kinds[i].name, column_json(&column));
	}
}

static json_t *options_json(const struct view_load_report *r)
{
	const struct view_load_options *o = r->options;
	return json_pack("{s:s, s:s, s:I, s:I, s:I, s:s, s:o, s:I, s:o, s:I, s:f, s:o, s:s?, s:I}",
		"url", o->url, "camera", o->camera, "clients", (json_int_t)o->clients,
		"cold_clients", (json_int_t)o->cold, "decoding_clients", (json_int_t)o->decoding,
		"loop", o->rate > 0 ? o->random_arrivals ? "open, random" : "open" : "closed",
		"rate", o->rate > 0 ? json_real(o->rate) : json_null(),
		"budget_vertices", (json_int_t)o->vertices,
		"budget_bytes", o->bytes > INT64_MAX ? json_null() : json_integer((json_int_t)o->bytes),
		"bandwidth_bytes_s", (json_int_t)o->bandwidth_bytes_s, "line_latency_ms", o->latency_ms,
		"deadline_ms", o->deadline_ms > 0 ? json_real(o->deadline_ms) : json_null(),
		"chunks_url", o->chunks, "resumes", (json_int_t)o->resumes);
}

static json_t *failures_json(const struct view_load_report *r)
{
	json_t *failures = json_object();
	for (int i = VIEW_ANSWERED + 1; i < VIEW_OUTCOMES; i++)
		json_object_set_new(failures, view_outcome_names[i],
			json_integer((json_int_t)r->outcomes[i]));
	return failures;
}

static json_t *scored_json(const struct view_load_report *r)
{
	json_t *scored = json_array();
	for (uint32_t i = 0; i < r->scored_count; i++) {
		const struct view_scored *v = &r->scored[i];
		json_array_append_new(scored, json_pack("{s:I, s:o, s:o, s:o, s:o, s:I}",
			"view", (json_int_t)v->frame, "predicted_q", real(v->predicted_q), "q", real(v->q),
			"precision", real(v->precision), "recall", real(v->recall),
			"reference_coarse", (json_int_t)v->coarse));
	}
	return scored;
}

static json_t *counts_json(const struct view_load_report *r)
{
	static const char *const names[VIEW_LOAD_COUNTS] = { "nothing", "bytes", "vertices", "chunks",
		"chunks_decoded", "chunks_named", "chunks_twice", "resumed", "renewed", "vertex_violations",
		"byte_violations" };
	json_t *o = json_pack("{s:f, s:I, s:f, s:f, s:f, s:I, s:o, s:s?, s:o, s:o}", "seconds", r->seconds,
		"requests", (json_int_t)r->answers.count, "requests_per_s", r->answers.count / r->seconds,
		"bytes_per_s", (double)r->bytes / r->seconds, "cpu_seconds", r->cpu_seconds,
		"processors", (json_int_t)r->processors, "failures", failures_json(r),
		"first_failure", r->first_failure[0] ? r->first_failure : NULL, "scored", scored_json(r),
		"options", options_json(r));
	for (int i = 0; i < VIEW_LOAD_COUNTS; i++)
		json_object_set_new(o, names[i], json_integer((json_int_t)r->counts[i]));
	return o;
}

json_t *view_load_json(const struct view_load_report *r)
{
	struct column column = client_bytes(r);
	json_t *json = counts_json(r);
	if (!json)
		eco_end("no memory");
	json_object_set_new(json, "client_bytes", column_json(&column));
	add_group(r, GROUP_ALL, json);
	for (int group = GROUP_ALL + 1; group < GROUPS; group++)
		if (has_group(r->options, (enum group)group)) {
			json_t *of = json_object();
			add_group(r, (enum group)group, of);
			json_object_set_new(json, group_names[group], of);
		}
	return json;
}

/* ---- CSV ---- */

static void csv_line(FILE *out, const struct view_answer *a)
{
	fprintf(out, "%u,%u,%s,%.3f,%s,%u,%u,%llu,%llu,%.6g", a->client, a->frame, a->cold ? "cold" : "warm",
		a->due_ms, view_outcome_names[a->outcome], a->status, a->resumed,
		(unsigned long long)a->bytes, (unsigned long long)a->vertices, (double)a->predicted_q);
	for (size_t i = 0; i < KINDS; i++) {
		float value = value_of(a, &kinds[i]);
		isnan(value) ? fputc(',', out) : fprintf(out, ",%.3f", (double)value);
	}
	fputc('\n', out);
}

enum eco_code view_load_csv(const struct view_load_report *r, const char *path, struct eco_error *error)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		eco_end("no memory");
	fputs("client,view,holds,due_ms,outcome,status,resumed,bytes,vertices,predicted_q", out);
	for (size_t i = 0; i < KINDS; i++)
		fprintf(out, ",%s", kinds[i].name);
	fputc('\n', out);
	for (uint32_t i = 0; i < r->answers.count; i++)
		csv_line(out, &r->answers.items[i]);
	if (fclose(out))
		eco_end("no memory");
	enum eco_code code = eco_file_write(path, text, size, error);
	free(text);
	return code;
}

/* ---- Scores ---- */

/* Asks a client that holds nothing, and draws what it gets. */
static enum eco_code draw(struct view_fetch *fetch, const struct eco_request *request,
	const volatile sig_atomic_t *stop, struct view_picture *picture, double *predicted_q,
	uint64_t *coarse, struct eco_error *error)
{
	struct view_store_options options = { .images = true };
	struct view_fetch_result result;
	struct view_selection selection = { 0 };
	struct view_store *store;
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	enum eco_code code = view_store_new(&store, &options, error);
	if (!code)
		code = view_fetch_stream(fetch, store, request, &result, error);
	if (!code)
		code = view_select_make(&selection, store, &eye, error);
	if (!code) {
		const struct eco_plan *plan = view_store_plan(store);
		*predicted_q = plan ? eco_predicted_q(&plan->prediction) : NAN;
		code = view_reference_draw(&(struct view_draw_job){ .store = store,
			.selection = &selection, .eye = &eye, .near_m = view_store_near_m(store),
			.stop = stop }, picture, error);
	}
	*coarse = selection.coarse;
	view_select_free(&selection);
	view_store_free(store);
	return code;
}

static enum eco_code score_one(const struct view_load_options *o, struct view_fetch *fetch,
	struct view_picture pictures[2], struct view_scored *scored, struct eco_error *error)
{
	const struct eco_view *view = &o->views[scored->frame];
	struct eco_request request = { .view = *view, .vertices = o->vertices, .bytes = o->bytes };
	struct eco_request everything = { .view = *view, .vertices = ECO_VERTICES_MAX,
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
	struct lod_score score;
	double all_q;
	uint64_t coarse;
	ECO_PASS(draw(fetch, &request, o->stop, &pictures[0], &scored->predicted_q, &coarse,
		error));
	ECO_PASS(draw(fetch, &everything, o->stop, &pictures[1], &all_q, &scored->coarse, error));
	lod_score(&score, &(struct lod_score_input){ view->width, view->height, pictures[0].cover,
		pictures[1].cover, pictures[0].owner, pictures[1].owner });
	scored->q = score.q;
	scored->precision = score.precision;
	scored->recall = score.recall;
	return ECO_OK;
}

enum eco_code view_score_sample(struct view_load_report *r, struct view_fetch *fetch, uint32_t count,
	struct eco_error *error)
{
	const struct view_load_options *o = r->options;
	struct view_picture pictures[2] = { { 0 } };
	enum eco_code code = ECO_OK;
	if (count > r->answers.count)
		count = r->answers.count;
	free(r->scored);
	r->scored = eco_alloc(count, sizeof *r->scored);
	r->scored_count = 0;
	for (int i = 0; i < 2 && !code && count; i++)
		code = view_picture_init(&pictures[i], o->views[0].width, o->views[0].height, error);
	for (uint32_t i = 0; i < count && !code; i++) {
		uint32_t at = (uint32_t)((uint64_t)r->answers.count * i / count);
		r->scored[i].frame = r->answers.items[at].frame;
		code = score_one(o, fetch, pictures, &r->scored[i], error);
		r->scored_count += !code;
	}
	for (int i = 0; i < 2; i++)
		view_picture_free(&pictures[i]);
	return code;
}
