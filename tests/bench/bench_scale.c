/* The scale that is drawn, from the table in the pack, against the best one for views that the table was not
 * measured on; and how Precision and Recall change with the size on screen and the view (Neubert 2011, 2.2
 * and 2.4).
 *
 * A plant's curve is sampled over shares of its vertices and interpolated, and it was measured on 12 views of
 * 256 pixels. Here the same cuts are drawn at the interpolated scale and at all scales around it, in other
 * views; the best of these knows the answer, so the difference in Q is what the table loses by being a table
 * and by having seen other views. */
#include <math.h>
#include <stdlib.h>

#include "lod/ladder.h"
#include "lod/build/measure/probe.h"
#include "tests/bench/bench.h"

#define MODELS 8u
#define MODELS_QUICK 2u
#define LAMBDAS 10u
#define ELEMENTS_LEAST 500u
/* not those of the curves: other heights, turned by an angle of a 3-4-5 triangle */
#define VIEWS 11u
#define PIXELS 256u
#define STEPS 12                 /* eighths of an octave up and down from the table's scale */

enum { SIZES = 5, INVARIANT = 3 };
static const uint32_t sizes[SIZES] = { 64, 128, 256, 512, 1024 };
static const double invariant_lambda[INVARIANT] = { 0.05, 0.2, 0.5 };

/* ---- Unseen views ---- */

static void turn(double v[3])
{
	double x = 0.8 * v[0] - 0.6 * v[1];
	v[1] = 0.6 * v[0] + 0.8 * v[1];
	v[0] = x;
}

static enum eco_code open_probe(struct lod_probe *probe, const struct lod_plant *plant,
	const struct eco_model *model, uint32_t pixels, struct eco_error *error)
{
	enum eco_code code = lod_probe_init(probe, plant, model,
		&(struct lod_probe_options){ .views = VIEWS, .pixels = pixels }, error);
	for (uint32_t i = 0; !code && i < probe->views; i++) {
		struct lod_eye *eye = &probe->eyes[i];
		for (int k = 0; k < 3; k++)
			eye->at[k] -= probe->center[k];
		turn(eye->at);
		turn(eye->right);
		turn(eye->up);
		turn(eye->forward);
		for (int k = 0; k < 3; k++)
			eye->at[k] += probe->center[k];
	}
	return code;
}

/* ---- Drawing a share of the foliage ---- */

static const struct eco_ladder *largest_foliage(const struct lod_plant *plant, const struct eco_scene *scene)
{
	const struct eco_ladder *best = NULL;
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *l = &plant->ladders[i];
		if (l->organ == ECO_ORGAN_FOLIAGE && !(l->flags & ECO_LADDER_FAR)
				&& (!best || lod_ladder_full(scene, l) > lod_ladder_full(scene, best)))
			best = l;
	}
	return best;
}

/* The cuts of a share of the ladder, their scales times `factor`. */
static enum eco_code draw(struct lod_probe *probe, const struct eco_ladder *ladder, double share,
	double factor, struct eco_error *error)
{
	struct lod_way way;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	lod_way_begin(&way, &probe->scene, ladder);
	uint64_t vertices = lod_way_floor(&way, (uint64_t)(share * (double)way.full + 0.5));
	uint32_t count = lod_way_cuts(&way, vertices, lod_way_density(&way, vertices), 0, cuts);
	enum eco_code code = ECO_OK;
	lod_probe_clear(probe);
	for (uint32_t i = 0; i < count && !code; i++) {
		cuts[i].scale *= (float)factor;
		code = lod_probe_add(probe, &cuts[i], error);
	}
	return code;
}

static enum eco_code q_of(struct lod_probe *probe, const struct eco_ladder *ladder, double share,
	double factor, double *q, struct eco_error *error)
{
	struct lod_probe_result result = { 0 };
	enum eco_code code = draw(probe, ladder, share, factor, error);
	if (!code)
		lod_probe_compare(probe, 1, &result);
	*q = 1 - result.loss;
	return code;
}

static double lambda_of(uint32_t i)
{
	return 0.01 * pow(80, (double)i / (LAMBDAS - 1));       /* 0.01 to 0.8 */
}

/* [lambda, Q at the table's scale, best Q, best scale over the table's] for each lambda. */
static enum eco_code measure_gaps(struct lod_probe *probe, const struct eco_ladder *ladder, json_t *rows,
	struct eco_error *error)
{
	bool any;
	enum eco_code code = draw(probe, ladder, 1, 1, error);
	any = !code && lod_probe_keep(probe);
	for (uint32_t i = 0; i < LAMBDAS && !code && any; i++) {
		double lambda = lambda_of(i), table, best = -1, best_factor = 1;
		code = q_of(probe, ladder, lambda, 1, &table, error);
		for (int step = -STEPS; step <= STEPS && !code; step++) {
			double factor = exp2(step / 8.0), q;
			code = q_of(probe, ladder, lambda, factor, &q, error);
			if (q > best) {
				best = q;
				best_factor = factor;
			}
		}
		json_array_append_new(rows, json_pack("[ffff]", lambda, table, best, best_factor));
	}
	return code;
}

/* [size, lambda, mean P, spread of P over views, mean R, spread of R, mean Q] */
static enum eco_code measure_size(struct lod_probe *probe, const struct eco_ladder *ladder, uint32_t size,
	json_t *rows, struct eco_error *error)
{
	bool any;
	enum eco_code code = draw(probe, ladder, 1, 1, error);
	any = !code && lod_probe_keep(probe);
	for (int l = 0; l < INVARIANT && !code && any; l++) {
		struct lod_probe_result result;
		double p = 0, pp = 0, r = 0, rr = 0, n = probe->views;
		code = draw(probe, ladder, invariant_lambda[l], 1, error);
		if (code)
			break;
		lod_probe_compare(probe, 1, &result);
		for (uint32_t v = 0; v < probe->views; v++) {
			const struct lod_score *s = &probe->scores[v];
			p += s->precision / n, pp += s->precision * s->precision / n;
			r += s->recall / n, rr += s->recall * s->recall / n;
		}
		json_array_append_new(rows,
			json_pack("[iffffff]", (int)size, invariant_lambda[l], p, sqrt(fmax(0, pp - p * p)),
			r, sqrt(fmax(0, rr - r * r)), 1 - result.loss));
	}
	return code;
}

static enum eco_code study_plant(const struct lod_plant *plant, const struct eco_model *model, json_t *out,
	struct eco_error *error)
{
	json_t *gaps = json_array(), *invariance = json_array();
	json_object_set_new(out, "gaps", gaps);
	json_object_set_new(out, "sizes", invariance);
	struct lod_probe probe;
	enum eco_code code = open_probe(&probe, plant, model, PIXELS, error);
	if (code)
		return code;
	const struct eco_ladder *ladder = largest_foliage(plant, &probe.scene);
	if (ladder)
		code = measure_gaps(&probe, ladder, gaps, error);
	lod_probe_free(&probe);
	for (int i = 0; i < SIZES && !code && ladder; i++) {
		code = open_probe(&probe, plant, model, sizes[i], error);
		if (!code) {
			code = measure_size(&probe, ladder, sizes[i], invariance, error);
			lod_probe_free(&probe);
		}
	}
	return code;
}

static enum eco_code unit(struct bench *bench, const struct bench_model *model, json_t **out,
	struct eco_error *error)
{
	char name[96], stamp[32];
	struct eco_model read;
	struct lod_plant plant;
	snprintf(name, sizeof name, "scale-%s", model->name);
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(model->path));
	if ((*out = bench_recall(bench, name, stamp)))
		return ECO_OK;
	enum eco_code code = bench_model_read(bench, model, &read, error);
	if (code)
		return code;
	/* One ladder for all of an organ: a plant in cells draws the same curve from several. */
	const struct lod_plant_options options = { .name = model->name, .cell_triangles = UINT32_MAX };
	json_t *result = json_object();
	code = lod_plant_build(&plant, &read, &options, error);
	if (!code) {
		uint32_t elements = plant.organ[ECO_ORGAN_FOLIAGE].elements;
		json_object_set_new(result, "elements", json_integer(elements));
		if (elements >= ELEMENTS_LEAST)
			code = lod_plant_measure(&plant, &read, &options, error);
		if (!code && elements >= ELEMENTS_LEAST)
			code = study_plant(&plant, &read, result, error);
		lod_plant_free(&plant);
	}
	eco_model_free(&read);
	if (code)
		json_decref(result);
	else
		*out = bench_keep(bench, name, stamp, result);
	return code;
}

/* ---- Report ---- */

static double number(const json_t *rows, size_t row, size_t column)
{
	return json_number_value(json_array_get(json_array_get(rows, row), column));
}

struct tables { struct bench_table *gaps, *sizes; double worst, sum; uint32_t count; char worst_of[96]; };

static void write_rows(struct tables *t, const char *name, const json_t *one)
{
	const json_t *gaps = json_object_get(one, "gaps"), *rows = json_object_get(one, "sizes");
	for (size_t i = 0; i < json_array_size(gaps); i++) {
		double gap = number(gaps, i, 2) - number(gaps, i, 1);
		bench_table_row(t->gaps, "%s,%.4f,%.4f,%.4f,%.4f,%.3f", name, number(gaps, i, 0),
			number(gaps, i, 1), number(gaps, i, 2), gap, number(gaps, i, 3));
		t->sum += gap;
		t->count++;
		if (gap > t->worst) {
			t->worst = gap;
			snprintf(t->worst_of, sizeof t->worst_of, "%s at lambda %.3f", name,
				number(gaps, i, 0));
		}
	}
	for (size_t i = 0; i < json_array_size(rows); i++)
		bench_table_row(t->sizes, "%s,%.0f,%.2f,%.3f,%.3f,%.3f,%.3f,%.3f", name, number(rows, i, 0),
			number(rows, i, 1), number(rows, i, 2), number(rows, i, 3), number(rows, i, 4),
			number(rows, i, 5), number(rows, i, 6));
}

/* P and R at the middle lambda over the size, mean over plants, and how far views lie apart. */
static enum eco_code plot_sizes(struct bench *bench, json_t *const *units, uint32_t count,
	struct eco_error *error)
{
	double x[SIZES], line[6][SIZES] = { { 0 } }, range = 0;
	for (int i = 0; i < SIZES; i++) {
		size_t row = (size_t)i * INVARIANT + 1;
		x[i] = sizes[i];
		for (uint32_t k = 0; k < count; k++) {
			const json_t *rows = json_object_get(units[k], "sizes");
			double p = number(rows, row, 2), ps = number(rows, row, 3), r = number(rows, row, 4),
				rs = number(rows, row, 5);
			const double values[6] = { p, p - ps, p + ps, r, r - rs, r + rs };
			for (int j = 0; j < 6; j++)
				line[j][i] += values[j] / count;
		}
		for (int j = 0; j < 6; j += 3)
			range = fmax(range, fabs(line[j][i] - line[j][0]));
	}
	const char *const names[6] = { "P", "P - spread over views", "P + spread", "R",
		"R - spread over views", "R + spread" };
	struct bench_series series[6];
	for (int j = 0; j < 6; j++)
		series[j] = (struct bench_series){ names[j], x, line[j], SIZES, false };
	bench_say(bench, "Precision and Recall by the size on screen, at lambda 0.2: means over %u plants "
		"differ by %.3f at most between %u and "
		"%u pixels. The spread is the standard deviation over %u views.", count, range, sizes[0],
		sizes[SIZES - 1], VIEWS);
	return bench_plot(bench,
		&(struct bench_plot){ .name = "scale-sizes", .title = "Precision and Recall by size on "
		"screen (lambda 0.2)",
		.x = "height of the picture, pixels", .y = "share", .log_x = true, .series = series,
		.series_count = 6 }, error);
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, found = 0, wanted = bench->full ? MODELS : MODELS_QUICK;
	json_t *units[MODELS];
	enum eco_code code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	struct tables t = { bench_table_open(bench, "scale_gaps", "plant,lambda,Q at the table's scale,best "
		"Q,gap,best scale over the table's", false),
		bench_table_open(bench, "scale_sizes", "plant,pixels,lambda,P,spread of P,R,spread of R,Q",
		true), -1, 0, 0, "" };
	for (uint32_t k = 0; k < count && found < MODELS && !code; k++) {
		json_t *one = NULL;
		if (models[k].leaves < ELEMENTS_LEAST)
			continue;
		if (found == wanted) {
			bench_left_out(bench, models[k].name);
			continue;
		}
		bench_progress(bench, (double)found / wanted, models[k].name);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: unit(bench, &models[k], &one, error);
		if (code || !json_array_size(json_object_get(one, "gaps")))
			continue;
		write_rows(&t, models[k].name, one);
		units[found++] = one;
	}
	bench_table_close(t.gaps);
	bench_table_close(t.sizes);
	free(models);
	if (!code && found) {
		code = plot_sizes(bench, units, found, error);
		bench_say(bench, "Scale from the table against the best for unseen views, %u plants, %u "
			"shares from 0.01 to 0.8: mean gap in Q %.4f, "
			"largest %.4f (%s).", found, LAMBDAS, t.sum / t.count, t.worst, t.worst_of);
		bench_key(bench, "s_opt_gap", t.worst, "<= 0.01: Q lost by the table's scale, worst plant "
			"and share");
	}
	return code;
}

const struct bench_section bench_scale = { "scale", "The scale of the table, and Precision and Recall by "
	"size and view", run,
	.objects = BENCH_OBJECTS_PLANTS "tests/bench/bench_scale.o" };
