/* Bits of a texel of colours: what packs store, and other coders of pictures at the same error. Each level is
 * a file of its own, as it is a chunk of its own. */
#include <math.h>
#include <stdlib.h>

#include "lod/build/texture.h"
#include "tests/bench/bench_state.h"
#include "tests/bench/bench_texels.h"

enum { SMALL, MIDDLE, LARGE, GROUPS };
static const char *const group_names[GROUPS] = { "up to 64", "65 to 256", "more" };

struct sums { double bytes, head; };
struct group { double levels, left_out, texels, squares; struct sums of[TEXELS_CODERS]; };
struct found { double textures; struct group groups[GROUPS]; };      /* doubles alone: a unit is an array */
#define FOUND_NUMBERS (sizeof(struct found) / sizeof(double))
struct study {
	struct found all, model;             /* model: the one that is being studied */
	bool there[TEXELS_CODERS];
};

static uint32_t group_of(const struct eco_texture_part *part)
{
	uint32_t side = part->width > part->height ? part->width : part->height;
	return side <= 64 ? SMALL : side <= 256 ? MIDDLE : LARGE;
}

/* ---- A level ---- */

/* At the error of `stored`; bytes are NaN where no settings lie around it. */
static enum eco_code measure(struct sums *sums, struct bench *bench, enum texels_coder coder,
	const struct lod_texture_level *level, double stored, struct eco_error *error)
{
	struct texels_trial trials[TEXELS_SETTINGS];
	uint32_t count = 0, nearest = 0, setting = TEXELS_SETTINGS / 2;
	double bytes = NAN;
	while (isnan(bytes) && setting < TEXELS_SETTINGS && count < TEXELS_SETTINGS) {
		struct texels_trial *trial = &trials[count++];
		enum eco_code code = texels_code(trial, bench, coder, &level->colors, &level->outline, setting,
			error);
		if (code)
			return code;
		bytes = texels_bytes_at(trials, count, stored, &nearest);
		setting += trial->error > stored ? 1u : -1u;         /* finer, or coarser; -1: no more */
	}
	*sums = (struct sums){ bytes, trials[nearest].head };
	return ECO_OK;
}

static enum eco_code study_level(struct study *s, struct bench *bench, const struct lod_texture_level *level,
	struct eco_error *error)
{
	struct group *group = &s->model.groups[group_of(&level->colors)];
	struct texels_trial stored;
	struct sums sums[TEXELS_CODERS];
	enum eco_code code = texels_code(&stored, bench, TEXELS_WEBP, &level->colors, &level->outline, 0, error);
	sums[TEXELS_WEBP] = (struct sums){ stored.bytes, 0 };
	bool all = stored.error > 0;
	for (enum texels_coder c = TEXELS_AVIF_420; c < TEXELS_CODERS && !code && all; c++) {
		if (s->there[c])
			code = measure(&sums[c], bench, c, level, stored.error, error);
		all = !code && (!s->there[c] || sums[c].bytes > 0);
	}
	if (code || !all) {
		group->left_out++;
		return code;
	}
	double texels = (double)level->colors.width * level->colors.height;
	group->levels++;
	group->texels += texels;
	group->squares += texels * stored.error * stored.error;
	for (enum texels_coder c = 0; c < TEXELS_CODERS; c++)
		if (s->there[c]) {
			group->of[c].bytes += sums[c].bytes;
			group->of[c].head += sums[c].head;
		}
	return ECO_OK;
}

/* ---- All textures ---- */

static enum eco_code study_model(struct study *s, struct bench *bench, const struct eco_model *model,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t id = 0; id < model->image_count && !code; id++) {
		struct lod_texture_levels levels;
		code = lod_texture_levels_make(&levels, model, id, error);
		if (code)
			return code;
		s->model.textures += levels.texel_area > 0;
		for (uint32_t i = 0; i < levels.count && levels.texel_area > 0 && !code; i++)
			code = study_level(s, bench, &levels.levels[i], error);
		lod_texture_levels_free(&levels);
	}
	return code;
}

struct work { struct study *study; struct bench *bench; const struct bench_model *item; };

static enum eco_code study_item(void *ctx, json_t **found, struct eco_error *error)
{
	const struct work *w = ctx;
	struct eco_model model;
	enum eco_code code = bench_model_read(w->bench, w->item, &model, error);
	if (code)
		return code;
	w->study->model = (struct found){ 0 };
	code = study_model(w->study, w->bench, &model, error);
	eco_model_free(&model);
	*found = bench_reals((const double *)&w->study->model, FOUND_NUMBERS);
	return code;
}

static enum eco_code study_path(struct study *s, struct bench *bench, const struct bench_model *item,
	struct eco_error *error)
{
	char unit[128], stamp[32];
	json_t *found;
	snprintf(unit, sizeof unit, "texels-%s", item->name);
	snprintf(stamp, sizeof stamp, "%016llx%d%d", (unsigned long long)bench_file_hash(item->path),
		s->there[TEXELS_AVIF_420], s->there[TEXELS_JXL]);
	enum eco_code code = bench_unit(bench, unit, stamp, study_item, &(struct work){ s, bench, item }, &found,
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
	enum eco_code code = bench_folder_make(folder, error);
	if (!code)
		code = bench_command(bench, error, "'%s/ecopack' generate city -o '%s' --plants 20 --quiet",
			bench->build, folder);
	if (!code)
		code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < count && !code; i++) {
		bench_progress(bench, (double)i / (count + 1), models[i].name);
		if (!models[i].generated)
			code = study_path(s, bench, &models[i], error);
	}
	free(models);
	return code ? code : study_path(s, bench, &cards, error);
}

/* ---- The report ---- */

static void add_group(struct bench_table *table, const struct study *s, uint32_t g)
{
	const struct group *group = &s->all.groups[g];
	const struct sums *stored = &group->of[TEXELS_WEBP];
	for (enum texels_coder c = 0; c < TEXELS_CODERS && group->levels > 0; c++) {
		const struct sums *sums = &group->of[c];
		if (s->there[c])
			bench_table_row(table, "%s,%s,%.0f,%.0f,%.3f,%.2f,%.3f,%.3f,%.3f",
				group_names[g], texels_names[c], group->levels, group->left_out,
				group->texels / 1e6, sqrt(group->squares / group->texels),
				8 * sums->bytes / group->texels, sums->bytes / stored->bytes,
				(sums->bytes - sums->head) / stored->bytes);
	}
}

static void add_key(struct bench *bench, const struct study *s)
{
	const struct group *group = &s->all.groups[LARGE];
	double best = NAN;
	for (enum texels_coder c = TEXELS_AVIF_420; c < TEXELS_CODERS; c++)
		if (s->there[c])
			best = fmin(best, group->of[c].bytes / group->of[TEXELS_WEBP].bytes);
	bench_key(bench, "texels_best", best, "bytes of the best other coder over ours, levels of more than "
		"256 texels a side, at equal error");
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for figures");
	for (enum texels_coder c = 0; c < TEXELS_CODERS; c++) {
		s->there[c] = texels_coder_is_there(c);
		if (!s->there[c])
			bench_say(bench, "%s is left out: apt-get install %s", texels_names[c],
				c == TEXELS_JXL ? "libjxl-tools" : "libavif-bin");
	}
	enum eco_code code = study_all(s, bench, error);
	struct bench_table *table = bench_table_open(bench, "texels", "side,coder,levels,left out,"
		"megatexels,error,bits of a texel,of stored,without head", true);
	for (uint32_t g = 0; g < GROUPS && !code; g++)
		add_group(table, s, g);
	bench_table_close(table);
	bench_say(bench, "%.0f textures. Bits of a texel at the error (sRGB bytes, opaque texels) that the stored "
		"file of the same level has, between two settings of a coder; levels where it has none on both "
		"sides are left out.",
		s->all.textures);
	if (!code)
		add_key(bench, s);
	free(s);
	return code;
}

const struct bench_section bench_texels = { "texels", "Bits of a texel of colours by several coders", run,
	.objects = "ecofiles-*.a lod-build.a tests/bench/bench_texels*.o" };
