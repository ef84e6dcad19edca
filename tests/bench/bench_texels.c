/* Bits of a texel of colours: what packs store, and other coders of pictures at the same error. Each level is
 * a file of its own, as it is a chunk of its own.
 *
 * WebP is libwebp's, called as packs are made. The others are programs of Debian 12: avifenc and avifdec
 * (package libavif-bin; libaom writes, dav1d reads), cjxl and djxl (libjxl-tools). */
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>

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
struct study {
	struct bench *bench;
	double textures;
	struct group groups[GROUPS];
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

static double code_webp(struct bench *bench, const struct eco_texture_part *colors, struct eco_texture_part *back)
{
	struct eco_writer w = { 0 };
	must(eco_texture_write_colors(&w, colors, settings[WEBP][0], must_error));
	must(eco_texture_read(back, ECO_LIST_IMAGE, w.bytes, w.size, must_error));
	double bytes = (double)w.size;
	eco_writer_free(&w);
	return bytes;
}

static bool is_there(enum coder coder)
{
	return coder == WEBP || !system(coder == JXL ?
		"{ command -v cjxl && command -v djxl; } >/dev/null 2>&1"
		: "{ command -v avifenc && command -v avifdec; } >/dev/null 2>&1");
}

/* texel.png becomes texel.coded and, back from that, texel.back. */
static double code_program(struct bench *bench, enum coder coder, const struct eco_texture_part *colors,
	struct eco_texture_part *back, double value)
{
	char path[PATH];
	struct stat coded;
	struct eco_image image;
	snprintf(path, sizeof path, "%s/texel.png", bench->cache);
	must(eco_png_write(&(struct eco_pixels){ colors->width, colors->height, 3, colors->texels },
		path, must_error));
	if (coder == JXL)
		bench_command("cd '%s' && cjxl --quiet --num_threads=0 "
			"--container=0 -d %g texel.png texel.coded 2>/dev/null && djxl --quiet --num_threads=0 "
			"texel.coded texel.ppm && mv texel.ppm texel.back", bench->cache, value);
	else
		bench_command("cd '%s' && avifenc -j 1 -c aom -s 6 -y %s --min 0 "
			"--max 63 -a end-usage=q -a cq-level=%g -o texel.coded texel.png >/dev/null && avifdec "
			"-j 1 -c dav1d --png-compress 0 texel.coded texel.out.png >/dev/null && mv texel.out.png "
			"texel.back", bench->cache, coder == AVIF_420 ? "420" : "444", value);
	snprintf(path, sizeof path, "%s/texel.coded", bench->cache);
	must(stat(path, &coded) ? eco_fail(must_error, ECO_IO, "%s: nothing is there", path) : ECO_OK);
	snprintf(path, sizeof path, "%s/texel.back", bench->cache);
	must(eco_image_read(&image, path, must_error));
	*back = (struct eco_texture_part){ image.width, image.height, 4, image.rgba };
	return (double)coded.st_size;
}

static struct trial try_coder(struct bench *bench, enum coder coder, const struct lod_texture_level *level,
	uint32_t setting)
{
	const struct eco_texture_part *colors = &level->colors;
	struct eco_texture_part back = { 0 };
	struct trial trial = { .bytes = coder == WEBP ? code_webp(bench, colors, &back)
		: code_program(bench, coder, colors, &back, settings[coder][setting]) };
	if (back.width != colors->width || back.height != colors->height)
		must(eco_fail(must_error, ECO_DAMAGED, "%s: %u x %u texels became %u x %u",
			coder_names[coder], colors->width, colors->height, back.width, back.height));
	trial.error = error_of(colors, &back, &level->outline);
	eco_texture_part_free(&back);
	return trial;
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

/* Bytes at the error of `stored`; NaN where no settings lie around it. */
static double measure(struct bench *bench, enum coder coder, const struct lod_texture_level *level, double stored)
{
	struct trial trials[SETTINGS];
	uint32_t count = 0, setting = SETTINGS / 2;
	double bytes = NAN;
	while (isnan(bytes) && setting < SETTINGS && count < SETTINGS) {
		struct trial *trial = &trials[count++];
		*trial = try_coder(bench, coder, level, setting);
		bytes = bytes_at(trials, count, stored);
		setting += trial->error > stored ? 1u : -1u;         /* finer, or coarser; -1: no more */
	}
	return bytes;
}

static void study_level(struct study *s, const struct lod_texture_level *level)
{
	uint32_t width = level->colors.width, height = level->colors.height,
		side = width > height ? width : height;
	struct group *group = &s->groups[side <= 64 ? SMALL : side <= 256 ? MIDDLE : LARGE];
	struct trial stored = try_coder(s->bench, WEBP, level, 0);
	double bytes[CODERS] = { stored.bytes }, texels = (double)width * height;
	bool all = stored.error > 0;
	for (enum coder c = AVIF_420; c < CODERS && all; c++)
		if (s->there[c]) {
			bytes[c] = measure(s->bench, c, level, stored.error);
			all = bytes[c] > 0;
		}
	if (!all) {
		group->left_out++;
		return;
	}
	group->levels++;
	group->texels += texels;
	group->squares += texels * stored.error * stored.error;
	for (enum coder c = 0; c < CODERS; c++)
		group->bytes[c] += bytes[c];
}

static void study_model(struct study *s, const struct bench_model *item)
{
	struct eco_model model;
	bench_model_read(item, &model);
	for (uint32_t id = 0; id < model.image_count; id++) {
		struct lod_texture_levels levels;
		lod_texture_levels_make(&levels, &model, id);
		s->textures += levels.texel_area > 0;
		for (uint32_t i = 0; i < levels.count && levels.texel_area > 0; i++)
			study_level(s, &levels.levels[i]);
		lod_texture_levels_free(&levels);
	}
	eco_model_free(&model);
}

/* Models of the data folder; generated trees of cards share one image. */
static void study_all(struct study *s, struct bench *bench)
{
	struct bench_model *models, cards = { .name = "cards-1" };
	uint32_t count;
	snprintf(cards.path, sizeof cards.path, "%.440s/scenes/cards/models/cards-1.obj", bench->cache);
	bench_command("mkdir -p '%s/scenes/cards' && '%s/ecopack' generate "
		"city -o '%s/scenes/cards' --plants 20 --quiet", bench->cache, bench->build, bench->cache);
	models = bench_models(bench, &count);
	for (uint32_t i = 0; i < count; i++) {
		bench_progress(bench, (double)i / (count + 1), models[i].name);
		if (!models[i].generated)
			study_model(s, &models[i]);
	}
	free(models);
	study_model(s, &cards);
}

/* ---- The report ---- */

static void add_group(struct bench_table *table, const struct study *s, uint32_t g)
{
	const struct group *group = &s->groups[g];
	for (enum coder c = 0; c < CODERS && group->levels > 0; c++)
		if (s->there[c])
			bench_table_row(table, "%s,%s,%.0f,%.0f,%.3f,%.2f,%.3f,%.3f", group_names[g],
				coder_names[c], group->levels, group->left_out, group->texels / 1e6,
				sqrt(group->squares / group->texels), 8 * group->bytes[c] / group->texels,
				group->bytes[c] / group->bytes[WEBP]);
}

static void add_key(struct bench *bench, const struct study *s)
{
	const struct group *group = &s->groups[LARGE];
	double best = NAN;
	for (enum coder c = AVIF_420; c < CODERS; c++)
		if (s->there[c])
			best = fmin(best, group->bytes[c] / group->bytes[WEBP]);
	bench_key(bench, "texels_best", best, "bytes of the best other coder over ours, levels of more than "
		"256 texels a side, at equal error");
}

static void run(struct bench *bench)
{
	struct study study = { .bench = bench }, *s = &study;
	for (enum coder c = 0; c < CODERS; c++) {
		s->there[c] = is_there(c);
		if (!s->there[c])
			bench_say(bench, "%s is left out: apt-get install %s", coder_names[c],
				c == JXL ? "libjxl-tools" : "libavif-bin");
	}
	study_all(s, bench);
	struct bench_table *table = bench_table_open(bench, "texels", "side,coder,levels,left out,"
		"megatexels,error,bits of a texel,of stored", true);
	for (uint32_t g = 0; g < GROUPS; g++)
		add_group(table, s, g);
	bench_table_close(table);
	bench_say(bench, "%.0f textures. Bits of a texel at the error (sRGB bytes, opaque texels) that the stored "
		"file of the same level has, between two settings of a coder; levels where it has none on both "
		"sides are left out.",
		s->textures);
	add_key(bench, s);
}

const struct bench_section bench_texels = { "texels", "Bits of a texel of colours by several coders", run };
