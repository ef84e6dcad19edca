/* Savings as pieces of work, and their means. */
#include <stdio.h>

#include "tests/bench/ladder/bench_savings.h"

static json_t *pack_row(const double *values, uint32_t count)
{
	json_t *row = json_array();
	for (uint32_t d = 0; d < count; d++)
		json_array_append_new(row, json_real(values[d]));
	return row;
}

static void read_row(const json_t *row, double *values, uint32_t count)
{
	for (uint32_t d = 0; d < count; d++)
		values[d] = json_number_value(json_array_get(row, d));
}

static json_t *pack(const struct bench_savings *s)
{
	json_t *methods = json_array(), *spacings = json_array();
	for (int m = 0; m < BENCH_METHODS; m++)
		json_array_append_new(methods,
			json_pack("{s:f,s:f,s:o}", "owner_q", s->beside[m].owner_q, "colour_rms",
			s->beside[m].colour_rms, "q", pack_row(s->q[m], BENCH_SHARES)));
	for (int g = 0; g < BENCH_SPACINGS; g++) {
		json_t *lambdas = json_array();
		for (int m = 0; m < BENCH_METHODS; m++)
			json_array_append_new(lambdas, pack_row(s->at[g].lambda[m], BENCH_DISTANCES));
		json_array_append_new(spacings,
			json_pack("{s:o,s:o,s:o}",
			"cook_lambda", pack_row(s->at[g].cook_lambda, BENCH_DISTANCES),
			"cook_q", pack_row(s->at[g].cook_q, BENCH_DISTANCES), "lambda", lambdas));
	}
	return json_pack("{s:i,s:i,s:f,s:o,s:f,s:f,s:o}", "elements", (int)s->elements, "vertices",
		(int)s->vertices, "layers", s->layers, "spacings", spacings,
		"owner_q", s->cook.owner_q, "colour_rms", s->cook.colour_rms, "methods", methods);
}

static double number(const json_t *object, const char *name)
{
	return json_number_value(json_object_get(object, name));
}

static void unpack(struct bench_savings *s, const json_t *kept)
{
	*s = (struct bench_savings){ .elements = (uint32_t)number(kept, "elements"),
		.vertices = (uint32_t)number(kept, "vertices"), .layers = number(kept, "layers"),
		.cook = { number(kept, "owner_q"), number(kept, "colour_rms") } };
	for (int g = 0; g < BENCH_SPACINGS; g++) {
		const json_t *spacing = json_array_get(json_object_get(kept, "spacings"), (size_t)g);
		read_row(json_object_get(spacing, "cook_lambda"), s->at[g].cook_lambda, BENCH_DISTANCES);
		read_row(json_object_get(spacing, "cook_q"), s->at[g].cook_q, BENCH_DISTANCES);
		for (int m = 0; m < BENCH_METHODS; m++)
			read_row(json_array_get(json_object_get(spacing, "lambda"), (size_t)m),
				s->at[g].lambda[m], BENCH_DISTANCES);
	}
	for (int m = 0; m < BENCH_METHODS; m++) {
		const json_t *method = json_array_get(json_object_get(kept, "methods"), (size_t)m);
		s->beside[m] = (struct bench_beside){ number(method, "owner_q"),
			number(method, "colour_rms") };
		read_row(json_object_get(method, "q"), s->q[m], BENCH_SHARES);
	}
}

enum eco_code bench_savings_of(struct bench *bench, struct bench_savings *savings, const char *name,
	const char *path, struct eco_error *error)
{
	char unit[96], stamp[32];
	struct bench_model file = { 0 };
	struct eco_model model;
	/* by what the file holds: the same plant in two scenes is measured once */
	snprintf(unit, sizeof unit, "savings-%016llx", (unsigned long long)bench_file_hash(path));
	snprintf(stamp, sizeof stamp, "%u views", bench->full ? 12 : 6);
	json_t *kept = bench_recall(bench, unit, stamp);
	if (kept) {
		unpack(savings, kept);
		return ECO_OK;
	}
	snprintf(file.name, sizeof file.name, "%s", name);
	snprintf(file.path, sizeof file.path, "%s", path);
	enum eco_code code = bench_model_read(bench, &file, &model, error);
	if (!code)
		code = bench_savings_measure(bench, savings, &model, error);
	if (!code)
		bench_keep(bench, unit, stamp, pack(savings));
	return code;
}

double bench_saving_beyond(const struct bench_savings *s, enum bench_spacing spacing,
	enum bench_method method, double least)
{
	const struct bench_reach *at = &s->at[spacing];
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++)
		if (bench_distance(spacing, d) >= least - 1e-9) {
			sum += 1 - at->lambda[method][d] / at->cook_lambda[d];
			count++;
		}
	return sum / count;
}

double bench_saving_mean(const struct bench_savings *s, enum bench_spacing spacing, enum bench_method method)
{
	return bench_saving_beyond(s, spacing, method, 0);
}

double bench_saving_total(const struct bench_savings *s, enum bench_spacing spacing, enum bench_method method)
{
	const struct bench_reach *at = &s->at[spacing];
	double ours = 0, cook = 0;
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
		ours += at->lambda[method][d];
		cook += at->cook_lambda[d];
	}
	return 1 - ours / cook;
}
