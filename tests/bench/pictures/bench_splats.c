/* Splats alone: single plants with few vertices, against full detail in views that no fit has seen.
 *
 *   hard Q       one sample a pixel in both pictures
 *   soft Q       shares of pixels, 4 x 4 samples in both
 *   ceiling      the best hard Q of what does not repeat the reference's single samples
 *   dip          how far pictures between two levels lie below the line between these levels, at most
 *
 * Beside opaque splats and splats with opacity stand square points of the pack's order, grown by the best of
 * eight factors; and impostors of one vertex (bench_impostors.c). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/bench/bench.h"
#include "tests/bench/pictures/bench_impostors.h"
#include "tests/bench/pictures/bench_splats.h"

#define BUDGETS BENCH_SPLATS_BUDGETS
const uint32_t bench_splats_budgets[BUDGETS] = { 12, 48, 200, 1000 };
#define BETWEEN 3u               /* pictures between two levels */

enum kind { OPAQUE = BENCH_SPLATS_OPAQUE, OPACITY = BENCH_SPLATS_OPACITY, POINTS = BENCH_SPLATS_POINTS,
	KINDS };
const char *const bench_splats_kind_names[BENCH_SPLATS_KINDS] = { "opaque splats", "splats with opacity",
	"square points", "best impostor" };
enum group { FOLIAGE, BARE, CONIFER, GENERATED, GROUPS };
static const char *const group_names[GROUPS] = { "foliage", "bare", "conifer", "generated" };
const double bench_splats_heights_px[BENCH_SPLATS_SIZES] = { 64, 256 };
static const double wanted[2][2][BUDGETS] = { { { .66, .74, .78, .795 }, { .67, .76, .815, .85 } },
	{ { .64, .72, .765, .79 }, { .70, .80, .855, .885 } } };

/* Files of the data folder. */
static const struct { const char *file; enum group group; } plants[] = {
	{ "/eztree_oak_large.", FOLIAGE }, { "/eztree_pine_medium.", FOLIAGE }, { "/orchids.", FOLIAGE },
	{ "/bush.", FOLIAGE }, { "/sapling_quaking_aspen_s7.", FOLIAGE }, { "/coconutTree.", FOLIAGE },
	{ "/BirchTree_Dead_1.", BARE }, { "/sapling_white_birch_bare_s4.", BARE },
	{ "/PineTree_1.", CONIFER }, { "/sapling_douglas_fir_s2.", CONIFER } };
static const uint32_t quick_plants[GROUPS] = { 1, 1, 1, 1 };

static enum group group_of(const struct bench_model *model)
{
	for (size_t i = 0; i < sizeof plants / sizeof *plants; i++)
		if (!model->generated && strstr(model->path, plants[i].file))
			return plants[i].group;
	return model->generated ? GENERATED : GROUPS;
}

bool bench_splats_is_foliage(const struct bench_model *model) { return group_of(model) == FOLIAGE; }

extern const struct bench_section bench_splats;

struct work {
	struct bench *bench;
	const struct bench_model *model;
	struct bench_splats_pictures pictures;
	struct lod_splat *drawn;
};

/* ---- One plant ---- */

static void score_splats(struct work *w, const struct lod_splats *splats, uint32_t vertices, uint32_t size,
	struct bench_splats_q *q)
{
	struct bench_splats_drawn drawn = { w->drawn, bench_splats_state(splats, vertices, w->drawn) };
	bench_splats_score(&w->pictures, size, bench_splats_draw, &drawn, q);
}

static uint32_t level_size(const struct lod_splats *splats, uint32_t level)
{
	return splats->level_end[level] - lod_splats_first(splats, level);
}

/* From 12 splats on, at the smaller size. */
static double worst_dip(struct work *w, const struct lod_splats *splats)
{
	double worst = 0;
	for (uint32_t l = 2; l + 1 < splats->level_count && level_size(splats, l + 1) <= 768; l++) {
		uint32_t from = level_size(splats, l), to = level_size(splats, l + 1);
		struct bench_splats_q low, high, at;
		score_splats(w, splats, from, 0, &low);
		score_splats(w, splats, to, 0, &high);
		for (uint32_t i = 1; i <= BETWEEN; i++) {
			double t = (double)i / (BETWEEN + 1);
			score_splats(w, splats, from + (uint32_t)((to - from) * t), 0, &at);
			worst = fmax(worst, low.hard + t * (high.hard - low.hard) - at.hard);
			worst = fmax(worst, low.soft + t * (high.soft - low.soft) - at.soft);
		}
	}
	return worst;
}

static enum eco_code paint(struct work *w, const struct lod_splats *splats, const char *file,
	struct eco_error *error)
{
	uint32_t side = w->pictures.sizes[BENCH_SPLATS_SIZES - 1].side, wide = side * (BUDGETS + 1);
	uint8_t *picture = malloc((size_t)wide * side * 3), (*rgb)[3] = malloc(1000 * sizeof *rgb);
	if (!picture || !rgb) {
		free(picture);
		free(rgb);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	}
	bench_splats_paint(&w->pictures, 7, NULL, NULL, NULL, picture, wide);
	for (uint32_t b = 0; b < BUDGETS; b++) {
		struct bench_splats_drawn drawn = { w->drawn,
			bench_splats_state(splats, bench_splats_budgets[b], w->drawn) };
		for (uint32_t i = 0; i < drawn.count; i++)
			memcpy(rgb[i], w->drawn[i].rgb, 3);
		bench_splats_paint(&w->pictures, 7, bench_splats_draw, &drawn, (const uint8_t (*)[3])rgb,
			picture + 3 * (size_t)side * (b + 1), wide);
	}
	enum eco_code code = bench_picture_write(w->bench, file, wide, side, picture, error);
	free(picture);
	free(rgb);
	return code;
}

/* `few`: gets what few pixels show of them, where it is not NULL. */
static enum eco_code study_splats(struct work *w, const struct eco_model *model, bool opaque, json_t *row,
	json_t *few, struct eco_error *error)
{
	struct lod_splats splats;
	clock_t begun = clock();
	char file[100];
	enum eco_code code = lod_splats_fit(&splats, model, &(struct lod_splats_options){ .opaque = opaque },
		error);
	double seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
	if (code)
		return code;
	if (!splats.level_count)
		code = eco_fail(error, ECO_UNSUPPORTED, "%s shows nothing", w->model->name);
	for (uint32_t b = 0; b < BUDGETS && !code; b++) {
		struct bench_splats_q q;
		score_splats(w, &splats, bench_splats_budgets[b], BENCH_SPLATS_SIZES, &q);
		json_array_append_new(row, json_pack("[f, f]", q.hard, q.soft));
	}
	snprintf(file, sizeof file, "splats-%s-%s.png", w->model->name, opaque ? "opaque" : "opacity");
	if (!code)
		code = paint(w, &splats, file, error);
	if (!code)
		json_array_append_new(row, json_pack("[f, f]", worst_dip(w, &splats), seconds));
	if (!code && few)
		code = bench_few_splats(model, &splats, few, error);
	lod_splats_free(&splats);
	return code;
}

static enum eco_code study_points(struct work *w, const struct eco_model *model, json_t *row,
	struct eco_error *error)
{
	static const double growths[] = { 8, 4, 2, 1, 0.5, 0.25, 0.12, 0.06 };
	struct lod_plant plant;
	struct lod_plant_options options = { .name = w->model->name, .grid_bits = 12 };
	enum eco_code code = lod_plant_build(&plant, model, &options, error);
	if (code)
		return code;
	for (uint32_t b = 0; b < BUDGETS; b++) {
		struct bench_splats_q q, best = { .hard = -1 };
		struct bench_points_drawn drawn = { &plant, bench_splats_budgets[b], 1 };
		double growth = 1;
		for (size_t i = 0; i < sizeof growths / sizeof *growths; i++) {
			drawn.growth = growths[i];
			bench_splats_score(&w->pictures, 0, bench_points_draw, &drawn, &q);
			if (q.hard > best.hard) {
				best = q;
				growth = growths[i];
			}
		}
		drawn.growth = growth;
		bench_splats_score(&w->pictures, BENCH_SPLATS_SIZES, bench_points_draw, &drawn, &q);
		json_array_append_new(row, json_pack("[f, f]", q.hard, q.soft));
	}
	lod_plant_free(&plant);
	return ECO_OK;
}

static enum eco_code study_plant(struct bench *bench, const struct bench_model *of, json_t **result,
	struct eco_error *error)
{
	struct eco_model model;
	struct work w = { .bench = bench, .model = of, .drawn = calloc(4096, sizeof *w.drawn) };
	enum eco_code code = w.drawn ? bench_model_read(bench, of, &model, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for splats");
	if (code) {
		free(w.drawn);
		return code;
	}
	json_t *rows[KINDS], *few = json_array(), *impostors = json_array();
	for (int k = 0; k < KINDS; k++)
		rows[k] = json_array();
	code = bench_splats_open(&w.pictures, &model, bench_splats_heights_px, error);
	double ceiling = w.pictures.ceiling;
	if (!code)
		code = study_splats(&w, &model, true, rows[OPAQUE], NULL, error);
	if (!code)
		code = study_splats(&w, &model, false, rows[OPACITY], few, error);
	if (!code)
		code = study_points(&w, &model, rows[POINTS], error);
	if (!code)
		code = bench_impostors_study(bench, of->name, &w.pictures, impostors, few, error);
	*result = json_pack("{s:f, s:[o,o,o], s:o, s:o}", "ceiling", ceiling, "rows", rows[0], rows[1],
		rows[2], "impostors", impostors, "few", few);
	bench_splats_close(&w.pictures);
	eco_model_free(&model);
	free(w.drawn);
	return code;
}

static enum eco_code unit_of(struct bench *bench, const struct bench_model *model, json_t **unit,
	struct eco_error *error)
{
	char name[640];
	snprintf(name, sizeof name, "splats-%s-%s", model->name, model->path);
	*unit = bench_recall(bench, name, NULL);
	if (*unit)
		return ECO_OK;
	json_t *result = NULL;
	enum eco_code code = study_plant(bench, model, &result, error);
	if (code)
		json_decref(result);
	else
		*unit = bench_keep(bench, name, NULL, result);
	return code;
}

static double number(json_t *row, uint32_t b, size_t i)
{
	return json_number_value(json_array_get(json_array_get(row, b), i));
}

enum eco_code bench_splats_of(struct bench *bench, const struct bench_model *model,
	struct bench_splats_q q[BENCH_SPLATS_KINDS][BENCH_SPLATS_BUDGETS], struct eco_error *error)
{
	json_t *unit = NULL;
	const char *before = bench_objects(bench, bench_splats.objects);
	enum eco_code code = unit_of(bench, model, &unit, error);
	bench_objects(bench, before);
	json_t *impostors = json_object_get(unit, "impostors");
	for (uint32_t b = 0; b < BUDGETS && !code; b++) {
		struct bench_splats_q *best = &q[BENCH_SPLATS_IMPOSTOR][b];
		for (int k = 0; k < KINDS; k++) {
			json_t *row = json_array_get(json_object_get(unit, "rows"), (size_t)k);
			q[k][b] = (struct bench_splats_q){ .hard = number(row, b, 0),
				.soft = number(row, b, 1) };
		}
		*best = (struct bench_splats_q){ 0 };
		for (uint32_t i = 0; i < json_array_size(impostors); i++) {
			best->hard = fmax(best->hard, number(impostors, i, 2));
			best->soft = fmax(best->soft, number(impostors, i, 3));
		}
	}
	return code;
}

/* ---- Tables ---- */

struct sums { double q[KINDS][2][BUDGETS], ceiling, seconds[2], dip; uint32_t count; };

static void write_row(struct bench_table *table, const char *plant, const char *kind, const char *more,
	const double q[2][BUDGETS])
{
	bench_table_row(table, "%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%s", plant, kind, q[0][0],
		q[0][1], q[0][2], q[0][3], q[1][0], q[1][1], q[1][2], q[1][3], more);
}

static void add_plant(struct bench_table *table, const struct bench_model *model, json_t *unit,
	struct sums *sums)
{
	char more[100];
	double ceiling = json_number_value(json_object_get(unit, "ceiling"));
	sums->ceiling += ceiling;
	sums->count++;
	for (int k = 0; k < KINDS; k++) {
		json_t *row = json_array_get(json_object_get(unit, "rows"), (size_t)k);
		double q[2][BUDGETS];
		for (uint32_t b = 0; b < BUDGETS; b++)
			for (int s = 0; s < 2; s++)
				sums->q[k][s][b] += q[s][b] = number(row, b, (size_t)s);
		double dip = k == POINTS ? NAN : number(row, BUDGETS, 0),
			seconds = k == POINTS ? NAN : number(row, BUDGETS, 1);
		snprintf(more, sizeof more, "%.3f,%.4f,%.1f", ceiling, dip, seconds);
		if (k != POINTS) {
			sums->dip = fmax(sums->dip, number(row, BUDGETS, 0));
			sums->seconds[k] = fmax(sums->seconds[k], number(row, BUDGETS, 1));
		}
		write_row(table, model->name, bench_splats_kind_names[k], more, (const double (*)[BUDGETS])q);
	}
}

static void write_means(struct bench_table *table, const struct sums sums[GROUPS])
{
	char more[32];
	for (int g = 0; g < GROUPS; g++)
		for (int k = 0; k < KINDS && sums[g].count; k++) {
			double q[2][BUDGETS];
			for (uint32_t b = 0; b < 2 * BUDGETS; b++)
				q[b / BUDGETS][b % BUDGETS] = sums[g].q[k][b / BUDGETS][b % BUDGETS]
					/ sums[g].count;
			snprintf(more, sizeof more, "%.3f,%u", sums[g].ceiling / sums[g].count,
				sums[g].count);
			write_row(table, group_names[g], bench_splats_kind_names[k], more,
				(const double (*)[BUDGETS])q);
		}
}

static void write_keys(struct bench *bench, const struct sums *s)
{
	char key[64], bar[32];
	for (int k = 0; k < POINTS; k++)
		for (uint32_t b = 0; b < 2 * BUDGETS; b++) {
			snprintf(key, sizeof key, "splats_%s_%s_%u", k == OPAQUE ? "opaque" : "opacity",
				b < BUDGETS ? "hard" : "soft", bench_splats_budgets[b % BUDGETS]);
			snprintf(bar, sizeof bar, ">= %.3f", wanted[k][b / BUDGETS][b % BUDGETS]);
			bench_key(bench, key, s->count ? s->q[k][b / BUDGETS][b % BUDGETS] / s->count : NAN,
				bar);
		}
	bench_key(bench, "splats_fit_s", s->count ? fmax(s->seconds[0], s->seconds[1]) : NAN, "<= 10");
	bench_key(bench, "splats_dip", s->count ? s->dip : NAN, "<= 0.01");
}

#define COLUMNS "hard 12,hard 48,hard 200,hard 1000,soft 12,soft 48,soft 200,soft 1000,ceiling,"

static enum eco_code study_all(struct bench *bench, const struct bench_model *models, uint32_t count,
	struct bench_table *table, struct sums sums[GROUPS], struct bench_impostors impostors[GROUPS],
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code; i++) {
		enum group group = group_of(&models[i]);
		char file[100];
		json_t *result = NULL;
		bool enough = group < GROUPS && !bench->full && sums[group].count == quick_plants[group];
		if (enough)
			bench_left_out(bench, models[i].name);
		if (group == GROUPS || enough)
			continue;
		bench_progress(bench, (double)i / count, models[i].name);
		code = unit_of(bench, &models[i], &result, error);
		if (!code) {
			add_plant(table, &models[i], result, &sums[group]);
			bench_impostors_add(&impostors[group], models[i].name,
				json_object_get(result, "impostors"), json_object_get(result, "few"));
			snprintf(file, sizeof file, "splats-%s-opacity.png", models[i].name);
			bench_picture(bench, file, "full detail; splats with opacity: 12, 48, 200, 1000");
			snprintf(file, sizeof file, "impostors-%s.png", models[i].name);
			bench_picture(bench, file, "full detail; impostors of one vertex, from level 0 on");
		}
		if (bench_stopped(bench))
			code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct sums sums[GROUPS] = { 0 };
	static struct bench_impostors impostors[GROUPS];
	enum eco_code code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "splats", "plant,kind," COLUMNS
		"dip,fit CPU s", true);
	memset(impostors, 0, sizeof impostors);
	code = study_all(bench, models, count, table, sums, impostors, error);
	bench_table_close(table);
	free(models);
	if (code)
		return code;
	bench_say(bench, "Means over plants of a kind, 24 directions and projected heights of 64 and 256 "
		"pixels.");
	table = bench_table_open(bench, "splats_means", "plants,kind," COLUMNS "count", true);
	write_means(table, sums);
	bench_table_close(table);
	bench_impostors_write(bench, impostors, group_names, GROUPS);
	if (!bench->full)                    /* bars are means over all plants of the group */
		return ECO_OK;
	write_keys(bench, &sums[FOLIAGE]);
	bench_impostors_keys(bench, &impostors[FOLIAGE]);
	return ECO_OK;
}

const struct bench_section bench_splats = { .name = "splats", .title = "Plants of few splats", .run = run,
	.objects = BENCH_OBJECTS_PLANTS BENCH_OBJECTS_SPLATS };
