/* Precision and Recall by the size on screen and the view (Neubert 2011, 2.2 and 2.4): cuts of a plant's
 * foliage at the scales of its curve, in views that the curve was not measured on. */
#include <math.h>

#include "lod/build/measure/probe.h"
#include "lod/ladder.h"
#include "tests/bench/bench_leaves.h"

#define ELEMENTS_LEAST 500u
/* not those of the curves: other heights, turned by an angle of a 3-4-5 triangle */
#define VIEWS 11u

enum { SIZES = 5, LAMBDAS = 3 };
static const uint32_t sizes[SIZES] = { 64, 128, 256, 512, 1024 };
static const double lambdas[LAMBDAS] = { 0.05, 0.2, 0.5 };
#define PLOTTED 1

/* Means over the views, and standard deviations. */
enum { P, P_SPREAD, R, R_SPREAD, Q, FIGURES };
static const struct bench_column columns[FIGURES] = { { "P", 3 }, { "spread of P", 3 }, { "R", 3 },
	{ "spread of R", 3 }, { "Q", 3 } };

static void turn(double v[3])
{
	double x = 0.8 * v[0] - 0.6 * v[1];
	v[1] = 0.6 * v[0] + 0.8 * v[1];
	v[0] = x;
}

static void open_probe(struct lod_probe *probe, const struct lod_plant *plant, const struct eco_model *model,
	uint32_t pixels)
{
	lod_probe_init(probe, plant, model, &(struct lod_probe_options){ .views = VIEWS, 
		.pixels = pixels });
	for (uint32_t i = 0; i < probe->views; i++) {
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
}

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

static void draw(struct lod_probe *probe, const struct eco_ladder *ladder, double share)
{
	struct lod_way way;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	lod_way_begin(&way, &probe->scene, ladder);
	uint64_t vertices = lod_way_floor(&way, (uint64_t)(share * (double)way.full + 0.5));
	uint32_t count = lod_way_cuts(&way, vertices, lod_way_density(&way, vertices), 0, cuts);
	lod_probe_clear(probe);
	for (uint32_t i = 0; i < count; i++)
		lod_probe_add(probe, &cuts[i]);
}

static void measure_size(struct lod_probe *probe, const struct eco_ladder *ladder, json_t *rows)
{
	draw(probe, ladder, 1);
	bool any = lod_probe_keep(probe);
	for (int l = 0; l < LAMBDAS && any; l++) {
		struct lod_probe_result result;
		double p = 0, pp = 0, r = 0, rr = 0, n = probe->views;
		draw(probe, ladder, lambdas[l]);
		lod_probe_compare(probe, 1, &result);
		for (uint32_t v = 0; v < probe->views; v++) {
			const struct lod_score *s = &probe->scores[v];
			p += s->precision / n, pp += s->precision * s->precision / n;
			r += s->recall / n, rr += s->recall * s->recall / n;
		}
		json_array_append_new(rows, bench_reals((double[]){ p, sqrt(fmax(0, pp - p * p)), r,
			sqrt(fmax(0, rr - r * r)), 1 - result.loss }, FIGURES));
	}
}

struct work { struct bench *bench; const struct bench_model *model; };

/* A row of figures for each size and lambda; none for a plant of few leaves. */
static json_t *study(void *ctx)
{
	const struct work *w = ctx;
	struct eco_model read;
	struct lod_plant plant;
	/* One ladder for all of an organ: a plant in cells draws the same curve from several. */
	const struct lod_plant_options options = { .name = w->model->name, .cell_triangles = UINT32_MAX };
	json_t *rows = json_array();
	bench_model_read(w->model, &read);
	must(lod_plant_build(&plant, &read, &options, must_error));
	bool enough = plant.organ[ECO_ORGAN_FOLIAGE].elements >= ELEMENTS_LEAST;
	if (enough)
		must(lod_plant_measure(&plant, &read, &options, must_error));
	for (int i = 0; i < SIZES && enough; i++) {
		struct lod_probe probe;
		open_probe(&probe, &plant, &read, sizes[i]);
		measure_size(&probe, largest_foliage(&plant, &probe.scene), rows);
		lod_probe_free(&probe);
	}
	lod_plant_free(&plant);
	eco_model_free(&read);
	return rows;
}

/* P and R at one lambda over the size, mean over plants. */
static void plot_sizes(struct bench *bench, double sum[SIZES][FIGURES], uint32_t count)
{
	double x[SIZES], line[2][SIZES], range = 0;
	const struct bench_series series[2] = { { "P", x, line[0], SIZES, false }, { "R", x, line[1], SIZES, false } };
	for (int i = 0; i < SIZES; i++) {
		x[i] = sizes[i];
		for (int j = 0; j < 2; j++) {
			line[j][i] = sum[i][j ? R : P] / count;
			range = fmax(range, fabs(line[j][i] - line[j][0]));
		}
	}
	bench_say(bench, "Precision and Recall by the size on screen, at lambda %g: means over %u plants "
		"differ by %.3f at most between %u and %u pixels. The table has standard deviations over "
		"%u views, too.", lambdas[PLOTTED], count, range, sizes[0], sizes[SIZES - 1], VIEWS);
	bench_plot(bench, &(struct bench_plot){ .name = "scale-sizes",
		.title = "Precision and Recall by size on screen (lambda 0.2)", 
		.x = "height of the picture, pixels",
		.y = "share", .log_x = true, .series = series, .series_count = 2 });
}

static void run(struct bench *bench)
{
	struct bench_walk walk = { .bench = bench, .leaves = ELEMENTS_LEAST, .most = 8, .quick = 2 };
	double sum[SIZES][FIGURES] = { { 0 } };
	struct bench_table *table = bench_table_described(bench, "scale_sizes", "plant,pixels,lambda",
		columns, FIGURES, true);
	for (const struct bench_model *model; (model = bench_walk(&walk));) {
		char name[96];
		snprintf(name, sizeof name, "sizes-%s", model->name);
		const json_t *rows = bench_unit(bench, name, must_stamp(model->path), study,
			&(struct work){ bench, model });
		for (size_t i = 0; i < SIZES * LAMBDAS && i < json_array_size(rows); i++) {
			double value[FIGURES];
			bench_cells(json_array_get(rows, i), value, FIGURES);
			bench_table_values(table, value, "%s,%u,%.2f", model->name, sizes[i / LAMBDAS],
				lambdas[i % LAMBDAS]);
			for (int f = 0; f < FIGURES && i % LAMBDAS == PLOTTED; f++)
				sum[i / LAMBDAS][f] += value[f];
		}
		walk.found[model->generated] += json_array_size(rows) > 0;
	}
	bench_table_close(table);
	if (walk.found[0] + walk.found[1])
		plot_sizes(bench, sum, walk.found[0] + walk.found[1]);
}

const struct bench_section bench_scale = { "scale", "Precision and Recall by size and view", run };
