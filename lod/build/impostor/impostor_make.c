/* Impostors: pictures of the model from the directions of tiles, then levels of them, then bytes of a plant.
 * Each picture is taken from both sides: the middle between the nearest and the farthest surface serves
 * opposite directions alike. */
#include "lod/build/impostor/impostor_make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/arena.h"
#include "lod/build/model_draw.h"
#include "lod/build/weld.h"
#include "lod/light.h"
#include "lod/sort.h"

#define VIEW_TEXELS ECO_IMPOSTOR_TEXELS_MAX
#define VIEW_CELLS 16u                   /* a side, of depths and colours */
#define VIEW_SAMPLES 4u                  /* a side of a texel */

struct impostor_cell {
	double count;                        /* covered samples */
	double middle;                       /* sum: middle between near and far surface, towards the eye, radii */
	double light[3];                     /* 1/65535 */
};
/* A tile as it is. */
struct impostor_view {
	uint8_t count[VIEW_TEXELS * VIEW_TEXELS];        /* covered samples */
	struct impostor_cell cell[VIEW_CELLS * VIEW_CELLS];
	double thick, ball;                  /* sums over samples: half the thickness, radii, and that of an
	                                      * ellipsoid that fills the tile and is 1 in its middle */
};

/* ---- Pictures ---- */

#define AWAY 512.0               /* of the camera, radii: as good as parallel */
#define SIDE (VIEW_TEXELS * VIEW_SAMPLES)
#define PARTS 4u                 /* that are drawn at a time */
#define EXTENT_MIN 1e-5f         /* of the smaller side of the cylinder, metres */

struct drawing {
	struct impostor_view *views;
	struct eco_impostor_axes axes[ECO_IMPOSTOR_TILES_MAX];
	uint32_t tiles, parts;
	const struct eco_impostor_body *body;
	const struct eco_model *model;
	const struct lod_mask *masks;
	const uint8_t (*rgb)[3];
	double radius;
	struct lod_raster near[PARTS], far[PARTS];
};

/* The cylinder around the usable triangles, without `thick`. False: there are none. */
static bool find_body(struct eco_impostor_body *body, const struct eco_model *model)
{
	float low[3], high[3], wide2 = 0;
	if (!lod_model_bounds(model, low, high))
		return false;
	for (int k = 0; k < 3; k++)
		body->center[k] = 0.5f * (low[k] + high[k]);
	for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
		if (!lod_mesh_usable(model, (uint32_t)(i / 3), NULL))
			continue;
		const float *at = model->position + 3 * (size_t)model->index[i];
		float x = at[0] - body->center[0], y = at[1] - body->center[1];
		wide2 = fmaxf(wide2, x * x + y * y);
	}
	body->wide = fmaxf(sqrtf(wide2), EXTENT_MIN);
	body->high = fmaxf(0.5f * (high[2] - low[2]), EXTENT_MIN);
	body->thick = 0;
	return true;
}

/* From the direction of a tile, or from the opposite one; then the picture is mirrored. */
static void start(const struct drawing *d, uint32_t tile, bool opposite, struct lod_raster *raster)
{
	const struct eco_impostor_axes *axes = &d->axes[tile];
	double away = AWAY * d->radius, side = opposite ? -1 : 1;
	struct lod_eye eye = { .tan_x = d->body->wide / away,
		.tan_y = eco_impostor_reach_up(d->body, axes) / away };
	eye.pixel_rad = 2 * eye.tan_y / SIDE;
	for (int k = 0; k < 3; k++) {
		eye.at[k] = (double)d->body->center[k] + side * away * axes->toward[k];
		eye.forward[k] = -side * axes->toward[k];
		eye.right[k] = side * axes->right[k];
		eye.up[k] = axes->up[k];
	}
	lod_raster_look(raster, &eye, (AWAY - 2) * d->radius);
	lod_model_draw(d->model, d->masks, raster);
}

static void add_sample(const struct drawing *d, uint32_t tile, uint32_t part, uint32_t x, uint32_t y)
{
	const struct lod_raster *near = &d->near[part], *far = &d->far[part];
	struct impostor_view *view = &d->views[tile];
	size_t at = (size_t)y * SIDE + x, mirrored = (size_t)y * SIDE + (SIDE - 1 - x);
	if (!near->cover[at])
		return;
	view->count[y / VIEW_SAMPLES * VIEW_TEXELS + x / VIEW_SAMPLES]++;
	struct impostor_cell *cell = &view->cell[y * VIEW_CELLS / SIDE * VIEW_CELLS + x * VIEW_CELLS / SIDE];
	double front = AWAY - 1 / (double)near->depth[at] / d->radius,
		back = far->cover[mirrored] ? 1 / (double)far->depth[mirrored] / d->radius - AWAY : front;
	double u = (x + 0.5) / SIDE * 2 - 1, v = 1 - (y + 0.5) / SIDE * 2, out2 = u * u + v * v;
	view->thick += back < front ? 0.5 * (front - back) : 0;
	view->ball += out2 < 1 ? sqrt(1 - out2) : 0;
	cell->middle += 0.5 * (front + back);
	cell->count++;
	for (int k = 0; k < 3; k++)
		cell->light[k] += lod_light_of[d->rgb[near->item[at]][k]];
}

static void draw_part(void *pieces, uint32_t part)
{
	struct drawing *d = pieces;
	for (uint32_t tile = part; tile < d->tiles; tile += d->parts) {
		start(d, tile, false, &d->near[part]);
		start(d, tile, true, &d->far[part]);
		for (uint32_t i = 0; i < SIDE * SIDE; i++)
			add_sample(d, tile, part, i % SIDE, i / SIDE);
	}
}

/* The views of all tiles of a set, in memory of the arena. */
static struct impostor_view *make_views(enum eco_impostor_set set, const struct eco_impostor_body *body,
	const struct eco_model *model, const struct lod_impostors_options *options, const uint8_t (*rgb)[3],
	struct lod_arena *arena)
{
	struct drawing *d = lod_arena_take(arena, 1, sizeof *d);
	*d = (struct drawing){ .tiles = eco_impostor_tiles(set), .parts = options->each ? PARTS : 1,
		.body = body, .model = model,
		.masks = lod_model_masks(model, arena), .rgb = rgb, .radius = eco_impostor_radius(body) };
	d->views = lod_arena_take(arena, d->tiles, sizeof *d->views);
	eco_impostor_axes(set, d->axes);
	for (uint32_t i = 0; i < d->parts; i++) {
		lod_raster_init(&d->near[i], &(struct lod_raster_options){ .width = SIDE, .height = SIDE,
			.item = true });
		lod_raster_init(&d->far[i], &(struct lod_raster_options){ .width = SIDE, .height = SIDE });
	}
	lod_each_run(options->each, options->ctx, d->parts, draw_part, d);
	for (uint32_t i = 0; i < d->parts; i++) {
		lod_raster_free(&d->near[i]);
		lod_raster_free(&d->far[i]);
	}
	return d->views;
}

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

/* Samples of a texel that is covered, `full` or fewer: two values stand for what texels hold, nothing and
 * this one. With each, the fullest texels are covered, as many as hold all of the plant together; least
 * squares choose it. */
static uint32_t choose_held(const struct making *m, const struct eco_impostor_size *size, uint32_t full)
{
	uint32_t texels = size->texels * size->texels, count[VIEW_TEXELS * VIEW_TEXELS], *number, held = full;
	double all = 0, most = 0;
	number = lod_arena_take(m->arena, full + 1, sizeof *number);
	for (uint32_t i = 0; i < eco_impostor_tiles(size->set); i++) {
		count_samples(&m->views[size->set][i], size->texels, count);
		for (uint32_t k = 0; k < texels; k++) {
			number[count[k]]++;
			all += count[k];
		}
	}
	for (uint32_t code = ECO_IMPOSTOR_GAPS; code; code--) {
		double each = (double)full * code / ECO_IMPOSTOR_GAPS, left = all / each, fits = 0;
		for (uint32_t least = full; least && left > 0; left -= number[least--])
			fits += (left < number[least] ? left : number[least]) * each * (2.0 * least - each);
		if (fits > most) {
			most = fits;
			held = full * code / ECO_IMPOSTOR_GAPS;
		}
	}
	return held;
}

/* As many texels as hold the plant, if each holds so many samples: the fullest; of equal ones those with more
 * around them. *rest: samples that the tiles before left over, and this one does. */
static void choose_texels(struct making *m, const struct impostor_view *view, uint32_t side, uint32_t held,
	int64_t *rest, uint8_t *texel)
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
	for (uint32_t i = 0; i < texels && count[order[i].value] && *rest >= held / 2; i++, *rest -= held)
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

static void make_level(struct making *m, uint32_t number)
{
	struct eco_impostor_level *level = &m->out->levels[number];
	const struct eco_impostor_size *size = &eco_impostor_sizes[number];
	uint32_t tiles = eco_impostor_tiles(size->set), few = eco_impostor_tiles(ECO_IMPOSTOR_FEW),
		block = VIEW_TEXELS / size->texels * VIEW_SAMPLES, full = block * block,
		held = choose_held(m, size, full);
	int64_t rest = 0;
	struct eco_error error;
	if (eco_impostor_level_make(level, number, &error))
		eco_end(error.text);
	level->gaps = ECO_IMPOSTOR_GAPS - held * ECO_IMPOSTOR_GAPS / full;
	m->out->level_count = number + 1;
	for (uint32_t i = 0; i < tiles; i++) {
		const struct impostor_view *view = &m->views[size->set][i];
		choose_texels(m, view, size->texels, held, &rest,
			level->texel + (size_t)i * size->texels * size->texels);
		put_depths(view, level, i);
	}
	for (uint32_t i = 0; i < few; i++)
		put_colors(&m->views[ECO_IMPOSTOR_FEW][i], level, i);
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

enum eco_code lod_impostors_make(struct lod_impostors *impostors, const struct eco_model *model,
	const struct lod_impostors_options *options, struct eco_error *error)
{
	struct lod_arena arena = { 0 };
	struct making m = { impostors, { NULL }, &arena };
	uint32_t levels = options->levels && options->levels < ECO_IMPOSTOR_LEVELS ? options->levels
		: ECO_IMPOSTOR_LEVELS;
	memset(impostors, 0, sizeof *impostors);
	if (!find_body(&impostors->body, model))
		return ECO_OK;
	const uint8_t (*rgb)[3] = options->rgb ? options->rgb : lod_model_colors(model, &arena);
	bool go = true;
	for (uint32_t i = 0; i < levels && (go = goes_on(options, (double)i / levels)); i++) {
		enum eco_impostor_set set = eco_impostor_sizes[i].set;
		if (!m.views[set])
			m.views[set] = make_views(set, &impostors->body, model, options, rgb, &arena);
		if (!i)
			find_thickness(&m);
		make_level(&m, i);
	}
	lod_arena_free(&arena);
	if (go)
		return ECO_OK;
	lod_impostors_free(impostors);
	return eco_fail(error, ECO_INTERRUPTED, "interrupted");
}

void lod_impostors_free(struct lod_impostors *impostors)
{
	for (uint32_t i = 0; i < ECO_IMPOSTOR_LEVELS; i++)
		eco_impostor_level_free(&impostors->levels[i]);
	memset(impostors, 0, sizeof *impostors);
}

/* ---- Impostors of plants ---- */

#define DRAFT_PIXELS 160u        /* of curves: below, a build is a draft */
#define DRAFT_LEVELS 2u
/* A triangle takes about 6 bytes in a pack, a texel of an image 0.4 to 0.7. Beyond the first, levels that
 * need about twice the bytes of all of them are left out: the plant itself is sooner there. */
#define BYTES_OF_TRIANGLE 12u
#define BYTES_OF_TEXEL 1u

static struct eco_bytes write_level(const struct lod_impostors *made, uint32_t level)
{
	struct eco_writer w = { 0 };
	struct eco_error error;
	if (eco_impostor_level_write(&w, &made->body, &made->levels[level], NULL, &error))
		eco_end(error.text);
	return (struct eco_bytes){ w.bytes, w.size };
}

static size_t level_bytes_most(const struct eco_model *model)
{
	size_t bytes = (size_t)BYTES_OF_TRIANGLE * model->triangle_count;
	for (uint32_t i = 0; i < model->image_count; i++)
		bytes += (size_t)BYTES_OF_TEXEL * model->images[i].width * model->images[i].height;
	return bytes;
}

/* How level the plant's leaves lie, as its points say; 0 where it has none. */
static uint8_t level_code(const struct lod_plant *plant)
{
	for (uint32_t i = 0; i < plant->list_count; i++)
		if (plant->lists[i].list.kind == ECO_LIST_POINTS && plant->lists[i].list.level)
			return plant->lists[i].list.level;
	return 0;
}

enum eco_code lod_plant_add_impostor(struct lod_plant *plant, const struct eco_model *model,
	const uint8_t (*rgb)[3], const struct lod_plant_options *options, struct eco_error *error)
{
	struct lod_impostors made;
	bool draft = options->pixels && options->pixels < DRAFT_PIXELS;
	struct lod_impostors_options how = { .levels = draft ? DRAFT_LEVELS : 0, .rgb = rgb,
		.progress = options->progress, .each = options->each, .ctx = options->ctx };
	enum eco_code code = lod_impostors_make(&made, model, &how, error);
	if (code)
		return code;
	plant->impostor = eco_alloc(made.level_count, sizeof *plant->impostor);
	for (uint32_t i = 0; i < made.level_count; i++) {
		struct eco_bytes bytes = write_level(&made, i);
		if (i && bytes.size > level_bytes_most(model)) {
			free(bytes.at);
			break;
		}
		plant->impostor[plant->impostor_count++] = bytes;
	}
	lod_impostors_free(&made);
	if (plant->impostor_count) {
		plant->impostor_level = level_code(plant);
		plant->ladders[plant->ladder_count - 1].impostor = plant->list_count;
	}
	return ECO_OK;
}

void lod_plant_open_impostor(struct lod_impostor *impostor, const struct lod_plant *plant, uint32_t level)
{
	struct eco_impostor_body body;
	struct eco_impostor_level read;
	struct eco_error error;
	if (eco_impostor_level_read(&read, &body, plant->impostor[level].at, plant->impostor[level].size, &error)
			|| lod_impostor_open(impostor, &body, &read, &error))
		eco_end(error.text);
	eco_impostor_level_free(&read);
}
