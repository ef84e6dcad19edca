/* A plant with few vertices as packs show it, beside billboard clouds: splats and impostors. */
#include <string.h>

#include "ecofiles/format/impostor.h"
#include "lod/build/impostor/impostor_make.h"
#include "tests/bench/pictures/bench_billboards.h"

#define STATE_MOST 4096u

const char *const bench_ours_names[BENCH_OURS_KINDS] = { "opaque splats", "splats with opacity",
	"best impostor" };

/* ---- Splats ---- */

void bench_splats_state(const struct lod_splats *s, uint32_t vertices, struct bench_splats *to)
{
	uint32_t level = 0, next = 0, gone = 0;
	while (level + 1 < s->level_count && s->level_end[level + 1] - s->level_end[level] <= vertices)
		level++;
	uint32_t size = s->level_end[level] - lod_splats_first(s, level);
	if (level + 1 < s->level_count) {
		next = (s->level_end[level + 1] - s->level_end[level]) / size;
		gone = (vertices - size) / (next - 1);
	}
	memcpy(to->items, s->items + s->level_end[level] - (gone ? 0 : size),
		next * gone * sizeof *to->items);
	memcpy(to->items + next * gone, s->items + lod_splats_first(s, level) + gone,
		(size - gone) * sizeof *to->items);
	to->count = next * gone + size - gone;
}

void bench_splats_draw(const void *what, struct lod_raster *raster)
{
	const struct bench_splats *drawn = what;
	for (uint32_t i = 0; i < drawn->count; i++) {
		const struct lod_splat *splat = &drawn->items[i];
		lod_raster_splats(raster, &(struct lod_raster_batch){ .count = 1, .position = splat->center,
			.half = splat->shape.half[0], .opacity = &splat->shape.opacity, .item = i,
			.owner = 1 });
	}
}

static void score_splats(const struct eco_model *model, bool opaque, const uint32_t *budgets, uint32_t count,
	bench_ours_score *score, void *ctx)
{
	static struct lod_splat items[STATE_MOST];
	struct lod_splats splats;
	struct bench_splats state = { .items = items };
	must(lod_splats_fit(&splats, model, &(struct lod_splats_options){ .opaque = opaque }, must_error));
	if (!splats.level_count)
		must(eco_fail(must_error, ECO_UNSUPPORTED, "a plant that shows nothing"));
	for (uint32_t b = 0; b < count; b++) {
		bench_splats_state(&splats, budgets[b], &state);
		score(ctx, opaque ? BENCH_OURS_OPAQUE : BENCH_OURS_SPLATS, b, bench_splats_draw, &state);
	}
	lod_splats_free(&splats);
}

/* ---- Impostors, as their bytes give them back ---- */

static void draw_impostor(const void *impostor, struct lod_raster *raster)
{
	lod_raster_impostor(raster, impostor, &(struct lod_raster_batch){ .count = 1, .owner = 1 });
}

static void score_impostors(const struct eco_model *model, bench_ours_score *score, void *ctx)
{
	struct lod_impostors made;
	must(lod_impostors_make(&made, model, &(struct lod_impostors_options){ 0 }, must_error));
	for (uint32_t i = 0; i < made.level_count; i++) {
		struct eco_writer w = { 0 };
		struct eco_impostor_level level = { 0 };
		struct eco_impostor_body body;
		struct lod_impostor impostor = { .cell_count = 0 };
		must(eco_impostor_level_write(&w, &made.body, &made.levels[i], NULL, must_error));
		must(eco_impostor_level_read(&level, &body, w.bytes, w.size, must_error));
		must(lod_impostor_open(&impostor, &body, &level, must_error));
		score(ctx, BENCH_OURS_IMPOSTOR, 0, draw_impostor, &impostor);
		lod_impostor_close(&impostor);
		eco_impostor_level_free(&level);
		eco_writer_free(&w);
	}
	lod_impostors_free(&made);
}

void bench_ours_each(const struct eco_model *model, const uint32_t *budgets, uint32_t count,
	bench_ours_score *score, void *ctx)
{
	score_splats(model, true, budgets, count, score, ctx);
	score_splats(model, false, budgets, count, score, ctx);
	score_impostors(model, score, ctx);
}
