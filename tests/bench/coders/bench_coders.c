/* Bits that a primitive takes as it is stored, beside its entropy and what other coders make of the same
 * integers: those of a chunk, and those of a list as one chunk. Every coder here decodes to the same rows;
 * where the permutation after decoding re-makes the order of drawing, rows may come in any order. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench_shots.h"
#include "tests/bench/coders/bench_coders_kind.h"

#define LISTS_QUICK 60u          /* of a kind and scene that a quick run looks at */

static const char *const scenes[] = { "outdoor", "park", "city", "trees5000", "scbi" };
#define SCENES (sizeof scenes / sizeof *scenes)

struct study {
	struct bench_table *chunks, *lists, *parts, *times;
	struct coders_figures sum[CODERS_KINDS];
	uint32_t scene_count;
};

/* ---- Units ---- */

static json_t *numbers(const double *values, uint32_t count)
{
	json_t *array = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(array, isfinite(values[i]) ? json_real(values[i]) : json_null());
	return array;
}

static void numbers_read(const json_t *array, double *values, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		const json_t *value = json_array_get(array, i);
		values[i] = json_is_number(value) ? json_number_value(value) : NAN;
	}
}

static json_t *figures_json(const struct coders_figures *f)
{
	json_t *unit = json_pack("{s:I, s:I, s:I}", "chunks", (json_int_t)f->chunks, "primitives",
		(json_int_t)f->primitives, "parted", (json_int_t)f->parted);
	json_object_set_new(unit, "bytes", numbers(f->bytes, CODERS_CODERS));
	json_object_set_new(unit, "whole", numbers(f->whole, CODERS_CODERS));
	json_object_set_new(unit, "ns", numbers(f->ns, CODERS_CODERS));
	json_object_set_new(unit, "entropy", numbers(f->entropy, CODERS_PARTS));
	json_object_set_new(unit, "counts", numbers(f->part[0], CODERS_PARTS));
	json_object_set_new(unit, "order", numbers(f->part[1], CODERS_PARTS));
	return unit;
}

static void figures_read(struct coders_figures *f, const json_t *unit)
{
	f->chunks = (uint64_t)json_integer_value(json_object_get(unit, "chunks"));
	f->primitives = (uint64_t)json_integer_value(json_object_get(unit, "primitives"));
	f->parted = (uint64_t)json_integer_value(json_object_get(unit, "parted"));
	numbers_read(json_object_get(unit, "bytes"), f->bytes, CODERS_CODERS);
	numbers_read(json_object_get(unit, "whole"), f->whole, CODERS_CODERS);
	numbers_read(json_object_get(unit, "ns"), f->ns, CODERS_CODERS);
	numbers_read(json_object_get(unit, "entropy"), f->entropy, CODERS_PARTS);
	numbers_read(json_object_get(unit, "counts"), f->part[0], CODERS_PARTS);
	numbers_read(json_object_get(unit, "order"), f->part[1], CODERS_PARTS);
}

static uint32_t lists_of(const struct eco_pack *pack, enum coders_kind kind)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < pack->scene.list_count; i++)
		count += coders_kind_has(kind, &pack->scene.lists[i]);
	return count;
}

static enum eco_code kind_figures(struct bench *bench, const char *scene, const char *path,
	enum coders_kind kind, struct coders_figures *figures, struct eco_error *error)
{
	char unit[64], stamp[64];
	struct eco_pack *pack;
	snprintf(unit, sizeof unit, "coders-%s-%s%s", scene, coders_kind_names[kind],
		bench->full ? "-full" : "");
	snprintf(stamp, sizeof stamp, "%s", bench_pack_stamp(path));
	const json_t *kept = bench_recall(bench, unit, stamp);
	if (kept) {
		figures_read(figures, kept);
		return ECO_OK;
	}
	if (bench_stopped(bench))
		return ECO_INTERRUPTED;
	enum eco_code code = eco_pack_open(&pack, path, error);
	if (code)
		return code;
	uint32_t step = bench->full ? 1 : lists_of(pack, kind) / LISTS_QUICK + 1;
	code = coders_kind_measure(figures, pack, kind, step, error);
	eco_pack_close(pack);
	if (!code)
		bench_keep(bench, unit, stamp, figures_json(figures));
	return code;
}

/* ---- Rows ---- */

static double each(double bytes, const struct coders_figures *f)
{
	return 8 * bytes / (double)f->primitives;
}

/* The smallest of other coders; *which names it. */
static double best_of(const double bytes[CODERS_CODERS], const char **which)
{
	double best = INFINITY;
	for (uint32_t c = CODERS_KD; c < CODERS_CODERS; c++)
		if (bytes[c] < best) {
			best = bytes[c];
			*which = coders_names[c];
		}
	return best;
}

static void add_bits(struct bench_table *table, const char *scene, enum coders_kind kind,
	const struct coders_figures *f, const double bytes[CODERS_CODERS])
{
	const char *which = "-";
	double best = best_of(bytes, &which);
	if (!isfinite(best))
		return;
	bench_table_row(table, "%s,%s,%llu,%llu,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%s,%.3f",
		coders_kind_names[kind], scene, (unsigned long long)f->primitives,
		(unsigned long long)f->chunks, each(bytes[CODERS_STORED], f), each(bytes[CODERS_ENTROPY], f),
		each(bytes[CODERS_KD], f), each(bytes[CODERS_SEQUENTIAL], f), each(bytes[CODERS_MESHOPT], f),
		each(bytes[CODERS_BY_OCTREE], f), each(bytes[CODERS_BY_COUNTS], f),
		each(bytes[CODERS_BY_ORDER], f), which, best / bytes[CODERS_STORED]);
}

static void add_parts(struct study *s, const char *scene, enum coders_kind kind,
	const struct coders_figures *f)
{
	for (uint32_t p = 0; p < CODERS_PARTS; p++)
		if (f->entropy[p] > 0 && kind != CODERS_WOOD)
			bench_table_row(s->parts, "%s,%s,%s,%.2f,%.2f,%.2f", coders_kind_names[kind], scene,
				coders_part_names[p], f->entropy[p] / (double)f->primitives,
				f->part[0][p] > 0 ? f->part[0][p] / (double)f->parted : NAN,
				f->part[1][p] / (double)f->parted);
}

static void add_times(struct study *s, const char *scene, enum coders_kind kind,
	const struct coders_figures *f)
{
	double n = (double)f->primitives;
	bench_table_row(s->times, "%s,%s,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f", coders_kind_names[kind], scene,
		f->ns[CODERS_STORED] / n, f->ns[CODERS_KD] / n, f->ns[CODERS_SEQUENTIAL] / n,
		f->ns[CODERS_MESHOPT] / n, f->ns[CODERS_BY_OCTREE] / n, f->ns[CODERS_BY_COUNTS] / n,
		f->ns[CODERS_BY_ORDER] / n);
}

static void add_sum(struct coders_figures *sum, const struct coders_figures *f)
{
	sum->primitives += f->primitives;
	sum->chunks += f->chunks;
	for (uint32_t c = 0; c < CODERS_CODERS; c++) {
		sum->bytes[c] += f->bytes[c];
		sum->whole[c] += f->whole[c];
		sum->ns[c] += f->ns[c];
	}
}

static enum eco_code study_scene(struct bench *bench, struct study *s, const char *scene,
	struct eco_error *error)
{
	char path[512];
	enum eco_code code;
	if (!bench_shot_scene(bench, scene, path, &code, error))
		return ECO_OK;
	for (enum coders_kind kind = 0; kind < CODERS_KINDS && !code; kind++) {
		struct coders_figures f;
		bench_progress(bench, (double)kind / CODERS_KINDS, scene);
		code = kind_figures(bench, scene, path, kind, &f, error);
		if (code || !f.primitives)
			continue;
		add_bits(s->chunks, scene, kind, &f, f.bytes);
		add_bits(s->lists, scene, kind, &f, f.whole);
		add_parts(s, scene, kind, &f);
		add_times(s, scene, kind, &f);
		add_sum(&s->sum[kind], &f);
	}
	return code;
}

/* ---- The report ---- */

static void open_tables(struct bench *bench, struct study *s)
{
	static const char columns[] = "kind,scene,primitives,chunks,stored,entropy,Draco kd,Draco sequential,"
		"meshopt+zstd,octree,counts,in order,best,best / stored";
	bench_say(bench, "Bits of a primitive. Stored: the chunks of the pack. Entropy: zero-order, of "
		"values or their differences along a Morton curve, over all chunks, tables free. Draco kd, "
		"sequential: at speed 0. meshopt+zstd: vertex codec and zstd 19 along a Morton curve, of "
		"wood with its index codec. Octree: occupancy with neighbours as contexts; counts: points in "
		"the halves of a kd-tree; both with adaptive columns for the rest. In order: adaptive "
		"columns in the stored order, of splats less their parents, of ground the misses of its "
		"prediction. "
		"Leaves are stored as placings of shapes or by prediction, others code their corners on the "
		"list's grid. Points, lines and simple leaves are forms of leaves and must have their "
		"order: for them only the last column is a coder that could be had as it is.");
	s->chunks = bench_table_open(bench, "coders", columns, true);
	s->lists = bench_table_open(bench, "coders-lists", columns, false);
	s->parts = bench_table_open(bench, "coders-parts", "kind,scene,part,entropy,counts,in order", true);
	s->times = bench_table_open(bench, "coders-ns", "kind,scene,stored,Draco kd,Draco sequential,"
		"meshopt+zstd,octree,counts,in order", true);
}

static void close_tables(struct study *s)
{
	bench_table_close(s->chunks);
	bench_table_close(s->lists);
	bench_table_close(s->parts);
	bench_table_close(s->times);
}

static void add_keys(struct bench *bench, struct study *s)
{
	static const char *const keys[CODERS_KINDS] = { "instance", "summary", "splat", "point", "line",
		"leaf", "simple_leaf", "wood", "ground" };
	for (enum coders_kind kind = 0; kind < CODERS_KINDS; kind++) {
		const struct coders_figures *f = &s->sum[kind];
		const char *which = "-";
		char key[64];
		if (!f->primitives)
			continue;
		add_bits(s->chunks, "all", kind, f, f->bytes);
		add_bits(s->lists, "all", kind, f, f->whole);
		add_times(s, "all", kind, f);
		snprintf(key, sizeof key, "coders_%s_bits", keys[kind]);
		bench_key(bench, key, each(f->bytes[CODERS_STORED], f), "bits of a primitive as stored");
		snprintf(key, sizeof key, "coders_%s_best", keys[kind]);
		bench_key(bench, key, best_of(f->bytes, &which) / f->bytes[CODERS_STORED],
			">= 0.9: bytes of the best other coder over ours");
	}
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	enum eco_code code = s ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for figures");
	if (code)
		return code;
	open_tables(bench, s);
	for (size_t i = 0; i < SCENES && !code; i++)
		code = study_scene(bench, s, scenes[i], error);
	if (!code)
		add_keys(bench, s);
	close_tables(s);
	bench_say(bench, "Colours of textures are in the section texels. Their outlines, JBIG's template in a range "
		"coder, and impostors, a coder of their own, are not here.");
	free(s);
	return code;
}

const struct bench_section bench_coders = { "coders", "Bits of a primitive by several coders", run,
	.objects = "ecofiles-*.a tests/bench/coders/bench_coders*.o" };
