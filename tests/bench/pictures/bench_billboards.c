/* Billboard clouds (Kratt et al. 2014) against splats, points and impostors at equal vertices, for the plants
 * with leaves of the section `splats` and in its pictures; and over a turn against pruned leaves of the same
 * mean Q (Neubert 2011, figure 11).
 *
 * The paper prints Precision and Recall of levels of a few trees as a diagram without a scale of vertices
 * (figure 3), levels of one tree, and a large scene without figures (figure 4). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"
#include "tests/bench/pictures/bench_billboards_q.h"

#define POINT_NUMBERS 15u
#define PLANTS_MOST 8u
#define PLANTS_QUICK 1u

/* ---- Kept ---- */

static json_t *pack(const struct bench_billboards_q *q)
{
	json_t *points = json_array(), *turns = json_array(), *vertices = json_array();
	for (uint32_t i = 0; i < BENCH_BILLBOARDS_KINDS * BENCH_BILLBOARDS_CAPS; i++) {
		const struct bench_billboards_point *p = &q->point[0][0] + i;
		const double row[POINT_NUMBERS] = { p->count, p->parts, p->forms[0], p->forms[1], p->forms[2],
			p->error, p->invalid, p->epsilon, p->texels, p->bytes, p->seconds, p->q.hard,
			p->q.soft, p->q.precision, p->q.recall };
		for (uint32_t k = 0; k < POINT_NUMBERS; k++)
			json_array_append_new(points, json_real(row[k]));
	}
	for (uint32_t i = 0; i < BENCH_TURN_METHODS * BENCH_TURN_VIEWS; i++) {
		double at = (&q->turn[0][0])[i];
		json_array_append_new(turns, isfinite(at) ? json_real(at) : json_null());
	}
	for (int m = 0; m < BENCH_TURN_METHODS; m++)
		json_array_append_new(vertices, json_real(q->vertices[m]));
	json_array_append_new(vertices, json_real(q->wood_vertices));
	return json_pack("{s:o,s:o,s:o}", "points", points, "turns", turns, "vertices", vertices);
}

static double number(const json_t *array, uint32_t i)
{
	const json_t *value = json_array_get(array, i);
	return json_is_number(value) ? json_number_value(value) : NAN;
}

static void unpack(struct bench_billboards_q *q, const json_t *kept)
{
	const json_t *points = json_object_get(kept, "points"), *turns = json_object_get(kept, "turns"),
		*vertices = json_object_get(kept, "vertices");
	for (uint32_t i = 0; i < BENCH_BILLBOARDS_KINDS * BENCH_BILLBOARDS_CAPS; i++) {
		double row[POINT_NUMBERS];
		for (uint32_t k = 0; k < POINT_NUMBERS; k++)
			row[k] = number(points, POINT_NUMBERS * i + k);
		(&q->point[0][0])[i] = (struct bench_billboards_point){ (uint32_t)row[0], (uint32_t)row[1],
			{ (uint32_t)row[2], (uint32_t)row[3], (uint32_t)row[4] }, row[5], row[6], row[7],
			row[8], row[9], row[10], { row[11], row[12], row[13], row[14] } };
	}
	for (uint32_t i = 0; i < BENCH_TURN_METHODS * BENCH_TURN_VIEWS; i++)
		(&q->turn[0][0])[i] = number(turns, i);
	for (uint32_t m = 0; m < BENCH_TURN_METHODS; m++)
		q->vertices[m] = number(vertices, m);
	q->wood_vertices = number(vertices, BENCH_TURN_METHODS);
}

static enum eco_code measure(struct bench *bench, const struct bench_model *model,
	struct bench_billboards_q *q, struct eco_error *error)
{
	char unit[96], stamp[32];
	struct eco_model read;
	snprintf(unit, sizeof unit, "billboards-%s", model->name);
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(model->path));
	json_t *kept = bench_recall(bench, unit, stamp);
	if (kept) {
		unpack(q, kept);
		return ECO_OK;
	}
	enum eco_code code = bench_model_read(bench, model, &read, error);
	if (!code)
		code = bench_billboards_measure(bench, model->name, q, &read, error);
	if (!code)
		bench_keep(bench, unit, stamp, pack(q));
	return code;
}

/* ---- Tables ---- */

/* Rows of the comparison: kinds of billboards, what stands beside them, and the best of ours. */
#define OURS ((int)BENCH_BILLBOARDS_KINDS)
#define BEST (OURS + (int)BENCH_SPLATS_KINDS)
#define ROWS (BEST + 1)
#define BUDGETS BENCH_SPLATS_BUDGETS

struct means {
	struct bench_splats_q q[ROWS][BUDGETS];
	double sd[BENCH_TURN_METHODS], cap_error[BENCH_BILLBOARDS_CAPS];
	uint32_t plants, turned[BENCH_TURN_METHODS];
	char name[PLANTS_MOST][64];
	double precision[PLANTS_MOST][BENCH_BILLBOARDS_CAPS], recall[PLANTS_MOST][BENCH_BILLBOARDS_CAPS];
};
struct tables { struct bench_table *caps, *q, *turn; };

static const char *row_name(int row)
{
	return row == BEST ? "best of ours" : row < OURS ? bench_billboards_kind_names[row]
		: bench_splats_kind_names[row - OURS];
}

static void write_row(const struct tables *t, const char *plant, int row, const struct bench_splats_q *q)
{
	bench_table_row(t->q, "%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", plant, row_name(row),
		q[0].hard, q[1].hard, q[2].hard, q[3].hard, q[0].soft, q[1].soft, q[2].soft, q[3].soft);
}

static void write_caps(const struct tables *t, struct means *means, const char *plant,
	const struct bench_billboards_q *q)
{
	for (uint32_t i = 0; i < BENCH_BILLBOARDS_KINDS * BENCH_BILLBOARDS_CAPS; i++) {
		const struct bench_billboards_point *p = &q->point[0][0] + i;
		uint32_t cap = i % BENCH_BILLBOARDS_CAPS;
		if (!bench_billboards_has((int)(i / BENCH_BILLBOARDS_CAPS), cap))
			continue;
		bench_table_row(t->caps, "%s,%s,%u,%u,%u,%u,%u,%u,%.3f,%.3f,%.4f,%.0f,%.0f,%.1f,%.3f,%.3f,"
			"%.3f,%.3f", plant, bench_billboards_kind_names[i / BENCH_BILLBOARDS_CAPS],
			bench_billboards_caps[cap], p->count, p->parts, p->forms[0], p->forms[1], p->forms[2],
			p->error, p->invalid, p->epsilon, p->texels / 1000, p->bytes / 1000, p->seconds,
			p->q.precision, p->q.recall, p->q.hard, p->q.soft);
		if (i < BENCH_BILLBOARDS_CAPS)
			means->cap_error[cap] += p->error;
	}
}

static void write_beside(const struct tables *t, struct means *means, const char *plant,
	const struct bench_billboards_q *q, const struct bench_splats_q ours[BENCH_SPLATS_KINDS][BUDGETS])
{
	struct bench_splats_q rows[ROWS][BUDGETS] = { { { 0 } } };
	for (uint32_t b = 0; b < BUDGETS; b++) {
		for (int k = 0; k < OURS; k++)
			rows[k][b] = q->point[k][b].q;
		for (int k = 0; k < BENCH_SPLATS_KINDS; k++) {
			rows[OURS + k][b] = ours[k][b];
			rows[BEST][b].hard = fmax(rows[BEST][b].hard, ours[k][b].hard);
			rows[BEST][b].soft = fmax(rows[BEST][b].soft, ours[k][b].soft);
		}
	}
	for (int row = 0; row < ROWS; row++) {
		write_row(t, plant, row, rows[row]);
		for (uint32_t b = 0; b < BUDGETS; b++) {
			means->q[row][b].hard += rows[row][b].hard;
			means->q[row][b].soft += rows[row][b].soft;
		}
	}
}

static void write_turn(const struct tables *t, struct means *means, const char *plant,
	const struct bench_billboards_q *q)
{
	for (int m = 0; m < BENCH_TURN_METHODS; m++) {
		double sum = 0, square = 0, least = INFINITY, most = -INFINITY;
		for (uint32_t v = 0; v < BENCH_TURN_VIEWS; v++) {
			double at = q->turn[m][v];
			sum += at / BENCH_TURN_VIEWS;
			least = fmin(least, at);
			most = fmax(most, at);
		}
		for (uint32_t v = 0; v < BENCH_TURN_VIEWS; v++)
			square += (q->turn[m][v] - sum) * (q->turn[m][v] - sum) / BENCH_TURN_VIEWS;
		bench_table_row(t->turn, "%s,%s,%.0f,%.0f,%.3f,%.3f,%.3f,%.2e,%.4f", plant,
			bench_turn_names[m], q->vertices[m], m == BENCH_TURN_BILLBOARDS ? 0
			: q->wood_vertices, sum, least, most, square, sqrt(square));
		if (isfinite(square)) {
			means->sd[m] += sqrt(square);
			means->turned[m]++;
		}
	}
}

static enum eco_code plot_turn(struct bench *bench, const char *plant, const struct bench_billboards_q *q,
	struct eco_error *error)
{
	char name[100], title[160];
	double degrees[BENCH_TURN_VIEWS];
	struct bench_series series[BENCH_TURN_METHODS];
	for (uint32_t v = 0; v < BENCH_TURN_VIEWS; v++)
		degrees[v] = 360.0 * v / BENCH_TURN_VIEWS;
	for (int m = 0; m < BENCH_TURN_METHODS; m++)
		series[m] = (struct bench_series){ bench_turn_names[m], degrees, q->turn[m],
			BENCH_TURN_VIEWS, false };
	snprintf(name, sizeof name, "billboards_turn_%s", plant);
	snprintf(title, sizeof title, "%s: Q over a turn, equal in the mean", plant);
	return bench_plot(bench, &(struct bench_plot){ .name = name, .title = title, .x = "degrees",
		.y = "Q", .series = series, .series_count = BENCH_TURN_METHODS }, error);
}

static enum eco_code study_plant(struct bench *bench, const struct bench_model *model, const struct tables *t,
	struct means *means, struct eco_error *error)
{
	struct bench_billboards_q q;
	struct bench_splats_q ours[BENCH_SPLATS_KINDS][BUDGETS];
	char file[100];
	enum eco_code code = measure(bench, model, &q, error);
	if (!code)
		code = bench_splats_of(bench, model, ours, error);
	if (code)
		return code;
	write_caps(t, means, model->name, &q);
	write_beside(t, means, model->name, &q, (const struct bench_splats_q (*)[BUDGETS])ours);
	write_turn(t, means, model->name, &q);
	uint32_t plant = means->plants++;
	snprintf(means->name[plant], sizeof means->name[plant], "%s", model->name);
	for (uint32_t cap = 0; cap < BENCH_BILLBOARDS_CAPS; cap++) {
		means->precision[plant][cap] = q.point[0][cap].q.precision;
		means->recall[plant][cap] = q.point[0][cap].q.recall;
	}
	snprintf(file, sizeof file, "billboards-%s.png", model->name);
	bench_picture(bench, file, "full detail; at most 8, 33, 166 billboards, each in its mean colour; "
		"of the last Precision and Recall: light grey true, grey missing, black too many");
	return plot_turn(bench, model->name, &q, error);
}

/* ---- A field ---- */

static json_t *pack_field(const struct bench_field_q *q)
{
	return json_pack("[f,f,f,f,f,f,f,f,f,f]", (double)q->plants[0], (double)q->plants[1],
		(double)q->plants[2], (double)q->plants[3], q->vertices, q->full, q->q, q->precision,
		q->recall, q->owner_q);
}

static struct bench_field_q unpack_field(const json_t *kept)
{
	return (struct bench_field_q){ { (uint32_t)number(kept, 0), (uint32_t)number(kept, 1),
		(uint32_t)number(kept, 2), (uint32_t)number(kept, 3) }, number(kept, 4), number(kept, 5),
		number(kept, 6), number(kept, 7), number(kept, 8), number(kept, 9) };
}

static enum eco_code measure_field(struct bench *bench, const struct bench_model *model,
	struct bench_field_q *q, struct eco_error *error)
{
	char unit[96], stamp[32];
	struct bench_billboards_q known;
	struct eco_model read;
	enum eco_code code = measure(bench, model, &known, error);
	snprintf(unit, sizeof unit, "billboards-field-%s", model->name);
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(model->path));
	json_t *kept = code ? NULL : bench_recall(bench, unit, stamp);
	if (code || kept) {
		*q = unpack_field(kept);
		return code;
	}
	code = bench_model_read(bench, model, &read, error);
	if (!code)
		code = bench_billboards_field(bench, model->name, &known, q, &read, error);
	if (!code)
		bench_keep(bench, unit, stamp, pack_field(q));
	return code;
}

/* Figure 4, right: many times the plant of most leaves. */
static enum eco_code study_field(struct bench *bench, const struct bench_model *model,
	struct eco_error *error)
{
	struct bench_field_q q = { .q = NAN };
	char file[128];
	enum eco_code code = measure_field(bench, model, &q, error);
	struct bench_table *table = bench_table_open(bench, "billboards_field", "plant,plants in view,"
		"of 333 billboards,of 166,of 33,of 8,vertices,vertices of full detail,Q,Precision,Recall,"
		"owner_q", true);
	if (!code)
		bench_table_row(table, "%s,%u,%u,%u,%u,%u,%.0f,%.0f,%.3f,%.3f,%.3f,%.3f", model->name,
			q.plants[0] + q.plants[1] + q.plants[2] + q.plants[3], q.plants[0], q.plants[1],
			q.plants[2], q.plants[3], q.vertices, q.full, q.q, q.precision, q.recall, q.owner_q);
	bench_table_close(table);
	snprintf(file, sizeof file, "billboards_field-%s.png", model->name);
	if (!code)
		bench_picture(bench, file, "a field: full detail; clouds in their billboards' mean colours; "
			"their levels: at most 333 billboards (red), 166 (orange), 33 (green), 8 (blue)");
	return code;
}

/* ---- Plots ---- */

static enum eco_code plot_means(struct bench *bench, struct means *means, struct eco_error *error)
{
	double x[BUDGETS], y[ROWS][BUDGETS], caps[BENCH_BILLBOARDS_CAPS];
	struct bench_series series[PLANTS_MOST > ROWS ? PLANTS_MOST : ROWS];
	for (int row = 0; row < ROWS; row++) {
		for (uint32_t b = 0; b < BUDGETS; b++) {
			x[b] = bench_splats_budgets[b];
			y[row][b] = means->q[row][b].hard;
		}
		series[row] = (struct bench_series){ row_name(row), x, y[row], BUDGETS, false };
	}
	enum eco_code code = bench_plot(bench, &(struct bench_plot){ .name = "billboards",
		.title = "Hard Q at equal vertices, mean over plants", .x = "vertices", .y = "Q",
		.log_x = true, .series = series, .series_count = ROWS }, error);
	for (uint32_t cap = 0; cap < BENCH_BILLBOARDS_CAPS; cap++)
		caps[cap] = bench_billboards_caps[cap];
	series[0] = (struct bench_series){ "error of the mean part", caps, means->cap_error,
		BENCH_BILLBOARDS_CAPS, false };
	if (!code)
		code = bench_plot(bench, &(struct bench_plot){ .name = "billboards_error",
			.title = "The method's own error against the cap", .x = "billboards at most",
			.y = "error", .log_x = true, .series = series, .series_count = 1 }, error);
	for (uint32_t i = 0; i < means->plants; i++)
		series[i] = (struct bench_series){ means->name[i], means->recall[i], means->precision[i],
			BENCH_BILLBOARDS_CAPS, true };
	return code ? code : bench_plot(bench, &(struct bench_plot){ .name = "billboards_pr",
		.title = "Precision and Recall of clouds of 2 to 333 billboards", .x = "Recall",
		.y = "Precision", .series = series, .series_count = means->plants }, error);
}

static void write_means(struct bench *bench, const struct tables *t, struct means *means)
{
	for (int row = 0; row < ROWS && means->plants; row++) {
		for (uint32_t b = 0; b < BUDGETS; b++) {
			means->q[row][b].hard /= means->plants;
			means->q[row][b].soft /= means->plants;
		}
		write_row(t, "mean", row, means->q[row]);
	}
	for (uint32_t cap = 0; cap < BENCH_BILLBOARDS_CAPS; cap++)
		means->cap_error[cap] /= means->plants;
	bench_key(bench, "billboards_hard_200", means->q[0][2].hard, "Q of at most 200 vertices");
	bench_key(bench, "billboards_hard_1000", means->q[0][3].hard, "of at most 1000");
	bench_key(bench, "billboards_best_of_ours_hard_200", means->q[BEST][2].hard, "beside it");
	bench_key(bench, "billboards_best_of_ours_hard_1000", means->q[BEST][3].hard, "beside it");
	for (int m = 0; m < BENCH_TURN_METHODS; m++) {
		char key[64];
		snprintf(key, sizeof key, "billboards_turn_sd_%s", m ? bench_turn_names[m] : "billboards");
		bench_key(bench, key, means->turned[m] ? means->sd[m] / means->turned[m] : NAN,
			"standard deviation of Q over a turn, mean over plants");
	}
}

static enum eco_code study_all(struct bench *bench, const struct tables *t, struct means *means,
	struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, last = 0;
	enum eco_code code = bench_models(bench, &models, &count, error);
	for (uint32_t i = 0; i < count && !code && means->plants < PLANTS_MOST; i++) {
		/* without the data folder generated plants stand for those with leaves */
		if (bench->data ? !bench_splats_is_foliage(&models[i]) : means->plants == 2)
			continue;
		if (!bench->full && means->plants == PLANTS_QUICK) {
			bench_left_out(bench, models[i].name);
			continue;
		}
		bench_progress(bench, (double)i / count, models[i].name);
		code = study_plant(bench, &models[i], t, means, error);
		last = i;
		if (!code && bench_stopped(bench))
			code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	if (!code && means->plants)
		code = study_field(bench, &models[last], error);
	free(models);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct means *means = calloc(1, sizeof *means);
	if (!means)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for means");
	const struct tables t = { bench_table_open(bench, "billboards_caps", "plant,kind,cap,billboards,"
		"parts,crosses,planes,strips,error,invalid,epsilon,thousand texels,PNG kB,CPU s,Precision,"
		"Recall,hard,soft", true), bench_table_open(bench, "billboards", "plant,kind,hard 12,hard 48,"
		"hard 200,hard 1000,soft 12,soft 48,soft 200,soft 1000", true), bench_table_open(bench,
		"billboards_turn", "plant,method,vertices,of wood besides,mean Q,least,most,variance,"
		"standard deviation", true) };
	enum eco_code code = study_all(bench, &t, means, error);
	if (!code && means->plants)
		write_means(bench, &t, means);
	bench_table_close(t.caps);
	bench_table_close(t.q);
	bench_table_close(t.turn);
	if (!code && means->plants)
		code = plot_means(bench, means, error);
	if (!code)
		bench_say(bench, "A billboard has six vertices, a splat or a point one. Vertices do not "
			"count textures: a cloud of another cap has other ones, so that clouds are "
			"alternatives and none continues another. Over a turn leaves are pruned over whole "
			"wood.");
	free(means);
	return code;
}

const struct bench_section bench_billboards = { "billboards", "Billboard clouds against splats and impostors",
	run, .objects = BENCH_OBJECTS_PLANTS "tests/bench/pictures/bench_billboards*.o "
	"tests/bench/pictures/bench_splats*.o", .alone = true };
