#include "tests/bench/pictures/bench_impostors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lod/build/impostor/impostor_make.h"
#include "lod/impostor.h"

static const double few_px[BENCH_FEW_HEIGHTS] = { 8, 16, 32, 64 };
static const uint32_t few_splats[BENCH_FEW_SPLATS] = { 1, 3, 12, 48, 192 };

/* ---- One plant ---- */

typedef void draw_call(const void *what, struct lod_raster *raster);

static void draw_impostor(const void *impostor, struct lod_raster *raster)
{
	lod_raster_impostor(raster, impostor, &(struct lod_raster_batch){ .count = 1, .owner = 1 });
}

/* Hard and soft Q of several things, each at all heights; a row each. */
static enum eco_code score_few(const struct eco_model *model, draw_call *draw, const void *const *what,
	uint32_t count, json_t *few, struct eco_error *error)
{
	double rows[BENCH_FEW_ROWS][2 * BENCH_FEW_HEIGHTS];
	enum eco_code code = ECO_OK;
	for (uint32_t h = 0; h < BENCH_FEW_HEIGHTS && !code; h += BENCH_SPLATS_SIZES) {
		struct bench_splats_pictures pictures;
		struct bench_splats_q q;
		code = bench_splats_open(&pictures, model, few_px + h, error);
		for (uint32_t i = 0; i < count && !code; i++)
			for (uint32_t size = 0; size < BENCH_SPLATS_SIZES; size++) {
				bench_splats_score(&pictures, size, draw, what[i], &q);
				rows[i][2 * (h + size)] = q.hard;
				rows[i][2 * (h + size) + 1] = q.soft;
			}
		if (!code)
			bench_splats_close(&pictures);
	}
	for (uint32_t i = 0; i < count && !code; i++) {
		json_t *row = json_array();
		for (uint32_t k = 0; k < 2 * BENCH_FEW_HEIGHTS; k++)
			json_array_append_new(row, json_real(rows[i][k]));
		json_array_append_new(few, row);
	}
	return code;
}

enum eco_code bench_few_splats(const struct eco_model *model, const struct lod_splats *splats, json_t *few,
	struct eco_error *error)
{
	struct bench_splats_drawn drawn[BENCH_FEW_SPLATS];
	const void *what[BENCH_FEW_SPLATS];
	struct lod_splat *items = calloc(BENCH_FEW_SPLATS * 512, sizeof *items);
	if (!items)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for splats");
	for (uint32_t i = 0; i < BENCH_FEW_SPLATS; i++) {
		struct lod_splat *here = items + (size_t)i * 512;
		drawn[i].items = here;
		drawn[i].count = bench_splats_state(splats, few_splats[i], here);
		what[i] = &drawn[i];
	}
	enum eco_code code = score_few(model, bench_splats_draw, what, BENCH_FEW_SPLATS, few, error);
	free(items);
	return code;
}

/* A level as its bytes give it back. */
static enum eco_code open_level(struct lod_impostor *impostor, const struct lod_impostors *made,
	uint32_t which, double bytes[2], struct eco_error *error)
{
	struct eco_writer w = { 0 };
	struct eco_impostor_level level = { 0 };
	struct eco_impostor_body body;
	size_t shape = 0;
	enum eco_code code = eco_impostor_level_write(&w, &made->body, &made->levels[which], &shape, error);
	if (!code)
		code = eco_impostor_level_read(&level, &body, w.bytes, w.size, error);
	if (!code)
		code = lod_impostor_open(impostor, &body, &level, error);
	bytes[0] = (double)shape;
	bytes[1] = (double)(w.size - shape);
	eco_impostor_level_free(&level);
	eco_writer_free(&w);
	return code;
}

static enum eco_code paint(struct bench *bench, const char *name, struct bench_splats_pictures *pictures,
	const struct lod_impostor *levels, struct eco_error *error)
{
	uint32_t side = pictures->sizes[BENCH_SPLATS_SIZES - 1].side, wide = side * (ECO_IMPOSTOR_LEVELS + 1);
	uint8_t *picture = malloc((size_t)wide * side * 3);
	char file[100];
	if (!picture)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	bench_splats_paint(pictures, 7, NULL, NULL, NULL, picture, wide);
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS; i++)
		bench_splats_paint(pictures, 7, draw_impostor, &levels[i],
			(const uint8_t (*)[3])levels[i].rgb, picture + 3 * (size_t)side * (i + 1), wide);
	snprintf(file, sizeof file, "impostors-%s.png", name);
	enum eco_code code = bench_picture_write(bench, file, wide, side, picture, error);
	free(picture);
	return code;
}

static enum eco_code study_levels(struct bench *bench, const char *name,
	struct bench_splats_pictures *pictures, const struct lod_impostors *made, double seconds,
	json_t *result, json_t *few, struct eco_error *error)
{
	struct lod_impostor levels[ECO_IMPOSTOR_LEVELS] = { { .cell_count = 0 } };
	const void *what[ECO_IMPOSTOR_LEVELS];
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS && !code; i++) {
		struct bench_splats_q q;
		double bytes[2];
		what[i] = &levels[i];
		code = open_level(&levels[i], made, i, bytes, error);
		if (code)
			break;
		bench_splats_score(pictures, BENCH_SPLATS_SIZES, draw_impostor, &levels[i], &q);
		json_array_append_new(result, json_pack("[f, f, f, f, f]", bytes[0], bytes[1], q.hard, q.soft,
			seconds));
	}
	if (!code)
		code = paint(bench, name, pictures, levels, error);
	if (!code)
		code = score_few(pictures->model, draw_impostor, what, ECO_IMPOSTOR_LEVELS, few, error);
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS; i++)
		lod_impostor_close(&levels[i]);
	return code;
}

enum eco_code bench_impostors_study(struct bench *bench, const char *name,
	struct bench_splats_pictures *pictures, json_t *result, json_t *few, struct eco_error *error)
{
	struct lod_impostors made;
	clock_t begun = clock();
	enum eco_code code = lod_impostors_make(&made, pictures->model,
		&(struct lod_impostors_options){ .levels = 0 }, error);
	double seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
	if (!code && made.level_count < ECO_IMPOSTOR_LEVELS)
		code = eco_fail(error, ECO_UNSUPPORTED, "%s shows nothing", name);
	if (!code)
		code = study_levels(bench, name, pictures, &made, seconds, result, few, error);
	lod_impostors_free(&made);
	return code;
}

/* ---- Tables ---- */

static double number(json_t *rows, size_t row, size_t column)
{
	return json_number_value(json_array_get(json_array_get(rows, row), column));
}

void bench_impostors_add(struct bench_impostors *to, const char *name, json_t *result, json_t *few)
{
	if (to->count == BENCH_IMPOSTOR_PLANTS)
		return;
	uint32_t plant = to->count++;
	snprintf(to->name[plant], sizeof to->name[plant], "%s", name);
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS; i++)
		to->plant[plant][i] = (struct bench_impostor){ number(result, i, 0), number(result, i, 1),
			number(result, i, 2), number(result, i, 3) };
	to->seconds[plant] = number(result, 0, 4);
	for (uint32_t i = 0; i < BENCH_FEW_ROWS; i++)
		for (uint32_t k = 0; k < 2 * BENCH_FEW_HEIGHTS; k++)
			to->few[i][k] += number(few, i, k);
}

static void write_level(struct bench_table *table, const char *plants, uint32_t level,
	const struct bench_impostor *sum, double count, double seconds)
{
	const struct eco_impostor_size *size = &eco_impostor_sizes[level];
	bench_table_row(table, "%s,%u,%u,%u,%.0f,%.0f,%.3f,%.3f,%.2f", plants, level,
		eco_impostor_tiles(size->set), size->texels, sum->shape_bytes / count,
		sum->color_bytes / count, sum->hard / count, sum->soft / count, seconds / count);
}

static void write_group(struct bench_table *table, const struct bench_impostors *group, const char *name)
{
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS && group->count; i++) {
		struct bench_impostor sum = { 0 };
		double seconds = 0;
		for (uint32_t p = 0; p < group->count; p++) {
			const struct bench_impostor *at = &group->plant[p][i];
			write_level(table, group->name[p], i, at, 1, group->seconds[p]);
			sum.shape_bytes += at->shape_bytes;
			sum.color_bytes += at->color_bytes;
			sum.hard += at->hard;
			sum.soft += at->soft;
			seconds += group->seconds[p];
		}
		write_level(table, name, i, &sum, group->count, seconds);
	}
}

static void write_few(struct bench_table *table, const struct bench_impostors *group, const char *name)
{
	for (uint32_t i = 0; i < BENCH_FEW_ROWS && group->count; i++) {
		char kind[32];
		double q[2 * BENCH_FEW_HEIGHTS];
		snprintf(kind, sizeof kind, i < BENCH_FEW_SPLATS ? "%u splats" : "impostor level %u",
			i < BENCH_FEW_SPLATS ? few_splats[i] : i - BENCH_FEW_SPLATS);
		for (uint32_t k = 0; k < 2 * BENCH_FEW_HEIGHTS; k++)
			q[k] = group->few[i][k] / group->count;
		bench_table_row(table, "%s,%s,%u,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", name, kind,
			i < BENCH_FEW_SPLATS ? few_splats[i] : 1, q[0], q[2], q[4], q[6], q[1], q[3], q[5],
			q[7]);
	}
}

void bench_impostors_write(struct bench *bench, const struct bench_impostors *groups,
	const char *const *names, uint32_t count)
{
	bench_head(bench, "Impostors");
	bench_say(bench, "One vertex each. Bytes are those of texels and depths, and of colours.");
	struct bench_table *table = bench_table_open(bench, "impostors", "plants,level,directions,texels,"
		"bytes,bytes of colours,hard,soft,make CPU s", true);
	for (uint32_t i = 0; i < count; i++)
		write_group(table, &groups[i], names[i]);
	bench_table_close(table);
	bench_say(bench, "Plants of few pixels in height, beside splats with opacity.");
	table = bench_table_open(bench, "impostors_few_pixels", "plants,kind,vertices,hard 8,hard 16,hard 32,"
		"hard 64,soft 8,soft 16,soft 32,soft 64", true);
	for (uint32_t i = 0; i < count; i++)
		write_few(table, &groups[i], names[i]);
	bench_table_close(table);
}

/* The means over plants of the largest level of each that has at most so many bytes. */
static struct bench_impostor best_within(const struct bench_impostors *group, double bytes)
{
	struct bench_impostor mean = { 0 };
	for (uint32_t p = 0; p < group->count; p++) {
		const struct bench_impostor *best = &group->plant[p][0];
		for (uint32_t i = 1; i < ECO_IMPOSTOR_LEVELS; i++)
			best = group->plant[p][i].shape_bytes <= bytes ? &group->plant[p][i] : best;
		mean.hard += best->hard / group->count;
		mean.soft += best->soft / group->count;
	}
	return mean;
}

void bench_impostors_keys(struct bench *bench, const struct bench_impostors *foliage)
{
	double seconds = 0;
	struct bench_impostor large = best_within(foliage, 50e3), small = best_within(foliage, 12e3);
	for (uint32_t p = 0; p < foliage->count; p++)
		seconds = fmax(seconds, foliage->seconds[p]);
	bool any = foliage->count > 0;
	bench_key(bench, "impostors_hard_50k", any ? large.hard : NAN, ">= 0.75: at 50 kB without colours");
	bench_key(bench, "impostors_soft_50k", any ? large.soft : NAN, ">= 0.80");
	bench_key(bench, "impostors_hard_12k", any ? small.hard : NAN, ">= 0.68: at 12 kB");
	bench_key(bench, "impostors_make_s", any ? seconds : NAN, "<= 5: CPU seconds a plant");
}
