/* Bits of a texel of colours: what packs store, and other coders of pictures at the same error. Each level is
 * a file of its own, as it is a chunk of its own.
 *
 * WebP is libwebp's, called as packs are made. The others are programs of Debian 12: avifenc and avifdec
 * (package libavif-bin; libaom writes, dav1d reads), cjxl and djxl (libjxl-tools). */
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/format/image.h"
#include "ecofiles/format/texture.h"
#include "lod/build/texture.h"
#include "tests/bench/bench.h"

#define PATH 1200
#define SETTINGS 7u
enum coder { WEBP, AVIF_420, AVIF_444, JXL, CODERS };
static const char *const coder_names[CODERS] = { "WebP as stored", "AVIF 4:2:0", "AVIF 4:4:4", "JPEG XL" };
/* WebP's quality, AVIF's quantizer, JPEG XL's distance, from coarse to fine */
static const double settings[CODERS][SETTINGS] = { { ECO_TEXTURE_QUALITY }, { 56, 46, 36, 27, 19, 11, 3 },
	{ 60, 52, 42, 32, 23, 14, 5 }, { 8, 4.5, 2.6, 1.5, 0.8, 0.4, 0.1 } };

enum { SMALL, MIDDLE, LARGE, GROUPS };
static const char *const group_names[GROUPS] = { "up to 64", "65 to 256", "more" };

/* error: of sRGB bytes, root of the mean square over opaque texels and channels */
struct trial { double bytes, error; };
struct group { double levels, left_out, texels, squares, bytes[CODERS]; };
struct found { double textures; struct group groups[GROUPS]; };      /* doubles alone: a unit is an array */
#define FOUND_NUMBERS (sizeof(struct found) / sizeof(double))
struct study {
	struct bench *bench;
	struct found all, model;             /* model: the one that is being studied */
	bool there[CODERS];
};

/* ---- Coders ---- */

/* NaN where nothing is opaque. */
static double error_of(const struct eco_texture_part *a, const struct eco_texture_part *b,
	const struct eco_texture_part *outline)
{
	double squares = 0, count = 0;
	for (size_t i = 0; i < (size_t)a->width * a->height; i++)
		for (uint32_t k = 0; k < 3 && outline->texels[i]; k++, count++) {
			double off = a->texels[a->channels * i + k] - (double)b->texels[b->channels * i + k];
			squares += off * off;
		}
	return sqrt(squares / count);
}

static enum eco_code code_webp(struct trial *trial, const struct eco_texture_part *colors,
	struct eco_texture_part *back, struct eco_error *error)
{
	struct eco_writer w = { 0 };
	enum eco_code code = eco_texture_write_colors(&w, colors, settings[WEBP][0], error);
	if (!code)
		code = eco_texture_read_colors(back, w.bytes, w.size, error);
	trial->bytes = (double)w.size;
	eco_writer_free(&w);
	return code;
}

static bool is_there(enum coder coder)
{
	return coder == WEBP || !system(coder == JXL ?
		"{ command -v cjxl && command -v djxl; } >/dev/null 2>&1"
		: "{ command -v avifenc && command -v avifdec; } >/dev/null 2>&1");
}

/* BASE.png becomes BASE.coded and, back from that, BASE.back. */
static enum eco_code run_programs(struct bench *bench, enum coder coder, const char *base, double value,
	struct eco_error *error)
{
	if (coder == JXL)
		return bench_command(bench, error,
			"cd '%s' && cjxl --quiet --num_threads=0 --container=0 -d %g "
			"%s.png %s.coded 2>/dev/null && djxl --quiet --num_threads=0 %s.coded %s.ppm && "
			"mv %s.ppm %s.back", bench->cache, value, base, base, base, base, base, base);
	return bench_command(bench, error, "cd '%s' && avifenc -j 1 -c aom -s 6 -y %s --min 0 --max 63 -a "
		"end-usage=q -a cq-level=%g -o %s.coded %s.png >/dev/null && avifdec -j 1 -c dav1d "
		"--png-compress 0 %s.coded %s.out.png >/dev/null && mv %s.out.png %s.back", bench->cache,
		coder == AVIF_420 ? "420" : "444", value, base, base, base, base, base, base);
}

static enum eco_code code_program(struct trial *trial, struct bench *bench, enum coder coder,
	const struct eco_texture_part *colors, struct eco_texture_part *back, uint32_t setting,
	struct eco_error *error)
{
	char name[32], path[3][PATH];
	struct stat coded;
	struct eco_image image;
	snprintf(name, sizeof name, "texels-%ld", (long)getpid());
	for (int i = 0; i < 3; i++)
		snprintf(path[i], PATH, "%s/%s%s", bench->cache, name, (const char *const[]){ ".png",
			".coded", ".back" }[i]);
	enum eco_code code = eco_png_write(&(struct eco_pixels){ colors->width, colors->height, 3,
		colors->texels }, path[0], error);
	if (!code)
		code = run_programs(bench, coder, name, settings[coder][setting], error);
	if (!code && stat(path[1], &coded))
		code = eco_fail(error, ECO_IO, "%s: nothing is there", path[1]);
	if (!code)
		code = eco_image_read(&image, path[2], error);
	if (!code) {
		trial->bytes = (double)coded.st_size;
		*back = (struct eco_texture_part){ image.width, image.height, 4, image.rgba };
	}
	for (int i = 0; i < 3; i++)
		unlink(path[i]);
	return code;
}

static enum eco_code try_coder(struct trial *trial, struct bench *bench, enum coder coder,
	const struct lod_texture_level *level, uint32_t setting, struct eco_error *error)
{
	const struct eco_texture_part *colors = &level->colors;
	struct eco_texture_part back = { 0 };
	*trial = (struct trial){ 0 };
	enum eco_code code = coder == WEBP ? code_webp(trial, colors, &back, error)
		: code_program(trial, bench, coder, colors, &back, setting, error);
	if (!code && (back.width != colors->width || back.height != colors->height))
		code = eco_fail(error, ECO_DAMAGED, "%s: %u x %u texels became %u x %u", coder_names[coder],
			colors->width, colors->height, back.width, back.height);
	if (!code)
		trial->error = error_of(colors, &back, &level->outline);
	eco_texture_part_free(&back);
	return code;
}

/* ---- A level ---- */

/* Between the two trials whose errors lie around `error`: log(bytes) is linear in log(error). NaN where no
 * two lie around it. */
static double bytes_at(const struct trial *trials, uint32_t count, double error)
{
	const struct trial *above = NULL, *below = NULL;
	for (uint32_t i = 0; i < count; i++) {
		const struct trial *t = &trials[i];
		if (t->error >= error && (!above || t->error < above->error))
			above = t;
		if (t->error <= error && (!below || t->error > below->error))
			below = t;
	}
	if (!above || !below || !(below->error > 0) || !(error > 0))
		return NAN;
	double span = log(above->error / below->error),
		share = span > 0 ? log(error / below->error) / span : 0;
	return below->bytes * pow(above->bytes / below->bytes, share);
}

/* At the error of `stored`; NaN where no settings lie around it. */
static enum eco_code measure(double *bytes, struct bench *bench, enum coder coder,
	const struct lod_texture_level *level, double stored, struct eco_error *error)
{
	struct trial trials[SETTINGS];
	uint32_t count = 0, setting = SETTINGS / 2;
	*bytes = NAN;
	while (isnan(*bytes) && setting < SETTINGS && count < SETTINGS) {
		struct trial *trial = &trials[count++];
		enum eco_code code = try_coder(trial, bench, coder, level, setting, error);
		if (code)
			return code;
		*bytes = bytes_at(trials, count, stored);
		setting += trial->error > stored ? 1u : -1u;         /* finer, or coarser; -1: no more */
	}
	return ECO_OK;
}

static enum eco_code study_level(struct study *s, const struct lod_texture_level *level,
	struct eco_error *error)
{
	uint32_t width = level->colors.width, height = level->colors.height,
		side = width > height ? width : height;
	struct group *group = &s->model.groups[side <= 64 ? SMALL : side <= 256 ? MIDDLE : LARGE];
	struct trial stored;
	double bytes[CODERS] = { 0 }, texels = (double)width * height;
	enum eco_code code = try_coder(&stored, s->bench, WEBP, level, 0, error);
	bool all = stored.error > 0;
	bytes[WEBP] = stored.bytes;
	for (enum coder c = AVIF_420; c < CODERS && !code && all; c++)
		if (s->there[c]) {
			code = measure(&bytes[c], s->bench, c, level, stored.error, error);
			all = !code && bytes[c] > 0;
		}
	if (code || !all) {
		group->left_out++;
		return code;
	}
	group->levels++;
	group->texels += texels;
	group->squares += texels * stored.error * stored.error;
	for (enum coder c = 0; c < CODERS; c++)
		group->bytes[c] += bytes[c];
	return ECO_OK;
}

/* ---- All textures ---- */

static enum eco_code study_model(struct study *s, const struct eco_model *model, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t id = 0; id < model->image_count && !code; id++) {
		struct lod_texture_levels levels;
		code = lod_texture_levels_make(&levels, model, id, error);
		if (code)
			return code;
		s->model.textures += levels.texel_area > 0;
		for (uint32_t i = 0; i < levels.count && levels.texel_area > 0 && !code; i++)
			code = study_level(s, &levels.levels[i], error);
		lod_texture_levels_free(&levels);
	}
	return code;
}

struct work { struct study *study; const struct bench_model *item; };

static enum eco_code study_item(void *ctx, json_t **found, struct eco_error *error)
{
	const struct work *w = ctx;
	struct eco_model model;
	enum eco_code code = bench_model_read(w->study->bench, w->item, &model, error);
	if (code)
		return code;
	w->study->model = (struct found){ 0 };
	code = study_model(w->study, &model, error);
	eco_model_free(&model);
	*found = bench_reals((const double *)&w->study->model, FOUND_NUMBERS);
	return code;
}

static enum eco_code study_path(struct study *s, const struct bench_model *item, struct eco_error *error)
{
	char unit[128], stamp[32];
	json_t *found;
	snprintf(unit, sizeof unit, "texels-%s", item->name);
	snprintf(stamp, sizeof stamp, "%016llx%d%d", (unsigned long long)bench_file_hash(item->path),
		s->there[AVIF_420], s->there[JXL]);
	enum eco_code code = bench_unit(s->bench, unit, stamp, study_item, &(struct work){ s, item }, &found,
		error);
	for (size_t i = 0; i < FOUND_NUMBERS && !code; i++)
		((double *)&s->all)[i] += bench_cell(found, i);
	return code;
}

/* Models of the data folder; generated trees of cards share one image. */
static enum eco_code study_all(struct study *s, struct bench *bench, struct eco_error *error)
{
	struct bench_model *models, cards = { .name = "cards-1" };
	uint32_t count;
	char folder[512];
	snprintf(folder, sizeof folder, "%.440s/scenes/cards", bench->cache);
	snprintf(cards.path, sizeof cards.path, "%.440s/scenes/cards/models/cards-1.obj", bench->cache);
	enum eco_code code = bench_command(bench, error,
		"mkdir -p '%s' && '%s/ecopack' generate city -o '%s' "
		"--plants 20 --quiet", folder, bench->build, folder);
	if (!code)
		code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < count && !code; i++) {
		bench_progress(bench, (double)i / (count + 1), models[i].name);
		if (!models[i].generated)
			code = study_path(s, &models[i], error);
	}
	free(models);
	return code ? code : study_path(s, &cards, error);
}

/* ---- The report ---- */

static void add_group(struct bench_table *table, const struct study *s, uint32_t g)
{
	const struct group *group = &s->all.groups[g];
	for (enum coder c = 0; c < CODERS && group->levels > 0; c++)
		if (s->there[c])
			bench_table_row(table, "%s,%s,%.0f,%.0f,%.3f,%.2f,%.3f,%.3f", group_names[g],
				coder_names[c], group->levels, group->left_out, group->texels / 1e6,
				sqrt(group->squares / group->texels), 8 * group->bytes[c] / group->texels,
				group->bytes[c] / group->bytes[WEBP]);
}

static void add_key(struct bench *bench, const struct study *s)
{
	const struct group *group = &s->all.groups[LARGE];
	double best = NAN;
	for (enum coder c = AVIF_420; c < CODERS; c++)
		if (s->there[c])
			best = fmin(best, group->bytes[c] / group->bytes[WEBP]);
	bench_key(bench, "texels_best", best, "bytes of the best other coder over ours, levels of more than "
		"256 texels a side, at equal error");
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct study study = { .bench = bench }, *s = &study;
	for (enum coder c = 0; c < CODERS; c++) {
		s->there[c] = is_there(c);
		if (!s->there[c])
			bench_say(bench, "%s is left out: apt-get install %s", coder_names[c],
				c == JXL ? "libjxl-tools" : "libavif-bin");
	}
	enum eco_code code = study_all(s, bench, error);
	struct bench_table *table = bench_table_open(bench, "texels", "side,coder,levels,left out,"
		"megatexels,error,bits of a texel,of stored", true);
	for (uint32_t g = 0; g < GROUPS && !code; g++)
		add_group(table, s, g);
	bench_table_close(table);
	bench_say(bench, "%.0f textures. Bits of a texel at the error (sRGB bytes, opaque texels) that the stored "
		"file of the same level has, between two settings of a coder; levels where it has none on both "
		"sides are left out.",
		s->all.textures);
	if (!code)
		add_key(bench, s);
	return code;
}

const struct bench_section bench_texels = { "texels", "Bits of a texel of colours by several coders", run };
