/* Levels of impostors from views of tiles. */
#include "lod/build/impostor/impostor_make.h"

#include <math.h>
#include <string.h>

#include "lod/build/impostor/impostor_state.h"
#include "lod/build/model_draw.h"
#include "lod/light.h"
#include "lod/sort.h"

#define SETS 2u

struct making {
	struct lod_impostors *out;
	struct impostor_view *views[SETS];
	struct lod_arena *arena;
};

/* ---- Texels ---- */

/* Samples of each texel of a tile, and those around it. */
static void count_samples(const struct impostor_view *view, uint32_t side, uint32_t *count)
{
	uint32_t block = VIEW_TEXELS / side;
	memset(count, 0, (size_t)side * side * sizeof *count);
	for (uint32_t i = 0; i < VIEW_TEXELS * VIEW_TEXELS; i++)
		count[i / VIEW_TEXELS / block * side + i % VIEW_TEXELS / block] += view->count[i];
}

static uint32_t count_around(const uint32_t *count, uint32_t side, uint32_t x, uint32_t y)
{
	uint32_t sum = 0;
	for (uint32_t j = y ? y - 1 : 0; j <= y + 1 && j < side; j++)
		for (uint32_t i = x ? x - 1 : 0; i <= x + 1 && i < side; i++)
			sum += count[j * side + i];
	return sum;
}

/* As many texels as are covered, those covered most; of equal ones those with more around them. *rest:
 * samples that the tiles before left over, and this one does. */
static void choose_texels(struct making *m, const struct impostor_view *view, uint32_t side, int64_t *rest,
	uint8_t *texel)
{
	const struct lod_arena_piece *mark = m->arena->last;
	uint32_t texels = side * side, block = VIEW_TEXELS / side * VIEW_SAMPLES, full = block * block;
	uint32_t *count = lod_arena_take(m->arena, texels, sizeof *count);
	struct lod_keyed *order = lod_arena_take(m->arena, texels, sizeof *order);
	count_samples(view, side, count);
	for (uint32_t i = 0; i < texels; i++) {
		*rest += count[i];
		order[i] = (struct lod_keyed){ (uint64_t)(full - count[i]) << 32
			| (9 * full - count_around(count, side, i % side, i / side)), i };
	}
	lod_sort(m->arena, order, texels);
	for (uint32_t i = 0; i < texels && count[order[i].value] && *rest >= full / 2; i++, *rest -= full)
		texel[order[i].value] = 1;
	lod_arena_release(m->arena, mark);
}

/* ---- Depths and colours ---- */

/* Codes of a tile's cells; -1: nothing is there. */
struct grid { int32_t code[VIEW_CELLS * VIEW_CELLS]; uint32_t side; };

/* The mean around an empty cell; -1: nothing is there. */
static int32_t mean_around(const struct grid *g, uint32_t i)
{
	int32_t sum = 0, count = 0, side = (int32_t)g->side;
	for (int32_t k = 0; k < 9; k++) {
		int32_t x = (int32_t)i % side + k % 3 - 1, y = (int32_t)i / side + k / 3 - 1;
		if (x < 0 || y < 0 || x >= side || y >= side || g->code[y * side + x] < 0)
			continue;
		sum += g->code[y * side + x];
		count++;
	}
	return count ? (2 * sum + count) / (2 * count) : -1;
}

/* Cells beside those where something is have their mean, as what is drawn is linear between cells; those
 * farther away whatever takes no bytes. */
static void put_grid(const struct grid *g, const struct eco_impostor_cells *cells, uint32_t tile)
{
	for (uint32_t i = 0; i < g->side * g->side; i++) {
		uint32_t x = i % g->side, y = i / g->side;
		int32_t code = g->code[i] < 0 ? mean_around(g, i) : g->code[i];
		*eco_impostor_cell(cells, tile, x, y) = code < 0 ? eco_impostor_predict(cells, tile, x, y)
			: (uint8_t)code;
	}
}

/* The sum of cells for each of side x side. */
static void sum_cells(const struct impostor_view *view, uint32_t side, struct impostor_cell *sums)
{
	uint32_t block = VIEW_CELLS / side;
	memset(sums, 0, (size_t)side * side * sizeof *sums);
	for (uint32_t i = 0; i < VIEW_CELLS * VIEW_CELLS; i++) {
		const struct impostor_cell *cell = &view->cell[i];
		struct impostor_cell *sum = &sums[i / VIEW_CELLS / block * side + i % VIEW_CELLS / block];
		sum->count += cell->count;
		sum->middle += cell->middle;
		for (int k = 0; k < 3; k++)
			sum->light[k] += cell->light[k];
	}
}

static int32_t depth_code(const struct impostor_cell *sum, uint32_t codes)
{
	int32_t most = (int32_t)codes - 1;
	double code = floor((sum->middle / sum->count + 1) * 0.5 * most + 0.5);
	return code < 0 ? 0 : code < most ? (int32_t)code : most;
}

static void put_depths(const struct impostor_view *view, const struct eco_impostor_level *level,
	uint32_t tile)
{
	struct eco_impostor_cells cells = eco_impostor_depth_cells(level);
	struct impostor_cell sums[VIEW_CELLS * VIEW_CELLS];
	struct grid grid = { .side = cells.side };
	sum_cells(view, cells.side, sums);
	for (uint32_t i = 0; i < cells.side * cells.side; i++)
		grid.code[i] = sums[i].count > 0 ? depth_code(&sums[i], cells.codes) : -1;
	put_grid(&grid, &cells, tile);
}

static int32_t color_code(const struct impostor_cell *sum, uint32_t k)
{
	return (lod_light_byte(sum->light[k] / sum->count) * 31 + 127) / 255;
}

static void put_colors(const struct impostor_view *view, const struct eco_impostor_level *level,
	uint32_t tile)
{
	struct impostor_cell sums[VIEW_CELLS * VIEW_CELLS];
	for (uint32_t k = 0; k < 3; k++) {
		struct eco_impostor_cells cells = eco_impostor_color_cells(level, k);
		struct grid grid = { .side = cells.side };
		sum_cells(view, cells.side, sums);
		for (uint32_t i = 0; i < cells.side * cells.side; i++)
			grid.code[i] = sums[i].count > 0 ? color_code(&sums[i], k) : -1;
		put_grid(&grid, &cells, tile);
	}
}

/* ---- Levels ---- */

static enum eco_code make_level(struct making *m, uint32_t number, struct eco_error *error)
{
	struct eco_impostor_level *level = &m->out->levels[number];
	const struct eco_impostor_size *size = &eco_impostor_sizes[number];
	uint32_t tiles = eco_impostor_tiles(size->set), few = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	int64_t rest = 0;
	enum eco_code code = eco_impostor_level_make(level, number, error);
	if (code)
		return code;
	m->out->level_count = number + 1;
	for (uint32_t i = 0; i < tiles; i++) {
		const struct impostor_view *view = &m->views[size->set][i];
		choose_texels(m, view, size->texels, &rest,
			level->texel + (size_t)i * size->texels * size->texels);
		put_depths(view, level, i);
	}
	for (uint32_t i = 0; i < few; i++)
		put_colors(&m->views[ECO_IMPOSTOR_FEW][i], level, i);
	return ECO_OK;
}

static void find_thickness(struct making *m)
{
	double thick = 0, ball = 0;
	for (uint32_t i = 0; i < eco_impostor_tiles(ECO_IMPOSTOR_FEW); i++) {
		thick += m->views[ECO_IMPOSTOR_FEW][i].thick;
		ball += m->views[ECO_IMPOSTOR_FEW][i].ball;
	}
	double share = ball > 0 ? thick / ball : 0;
	m->out->body.thick = (float)(share < 1 ? share : 1) * eco_impostor_radius(&m->out->body);
}

static bool goes_on(const struct lod_impostors_options *options, double share)
{
	return !options->progress || options->progress(options->ctx, share);
}

static enum eco_code make_all(struct making *m, const struct eco_model *model,
	const struct lod_impostors_options *options, struct eco_error *error)
{
	uint32_t levels = options->levels && options->levels < ECO_IMPOSTOR_LEVELS ? options->levels
		: ECO_IMPOSTOR_LEVELS;
	const uint8_t (*rgb)[3] = options->rgb ? options->rgb : lod_model_colors(model, m->arena);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < levels && !code; i++) {
		enum eco_impostor_set set = eco_impostor_sizes[i].set;
		if (!goes_on(options, (double)i / levels))
			return eco_fail(error, ECO_INTERRUPTED, "interrupted");
		if (!m->views[set])
			code = impostor_views_make(&m->views[set], set, &m->out->body, model, options, rgb,
				m->arena, error);
		if (!code && !i)
			find_thickness(m);
		if (!code)
			code = make_level(m, i, error);
	}
	return code;
}

enum eco_code lod_impostors_make(struct lod_impostors *impostors, const struct eco_model *model,
	const struct lod_impostors_options *options, struct eco_error *error)
{
	struct lod_arena arena = { 0 };
	struct making m = { impostors, { NULL }, &arena };
	memset(impostors, 0, sizeof *impostors);
	if (setjmp(arena.failed)) {
		lod_arena_free(&arena);
		lod_impostors_free(impostors);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for pictures of a plant");
	}
	enum eco_code code = impostor_body_find(&impostors->body, model)
		? make_all(&m, model, options, error) : ECO_OK;
	lod_arena_free(&arena);
	if (code)
		lod_impostors_free(impostors);
	return code;
}

void lod_impostors_free(struct lod_impostors *impostors)
{
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS; i++)
		eco_impostor_level_free(&impostors->levels[i]);
	memset(impostors, 0, sizeof *impostors);
}
