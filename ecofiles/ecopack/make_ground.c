/* The ground of a pack: read, continued to the horizon, rounded to the pack's heights, cut into tiles. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/places/size_units.h"
#include "lod/build/ground_tree.h"
#include "lod/build/summary.h"
#include "lod/build/texture.h"
#include "lod/ground_choice.h"

/* Steps of heights that are not whole are a centimetre, or a part of the relief where that is less; but no
 * finer than light can show: a step of 1/256 of a cell changes a slope by 1/256, and colours have 255 values
 * (lod/EXPERIMENTS.md, Smaller tiles of ground). */
#define HEIGHT_STEP_M 0.01
#define RELIEF_STEPS 1024
#define CELL_STEPS 256
#define STEEP 3.0 /* metres up for one across: one slope in ten of a real DEM is never so steep */
#define SLOPES 65536u

/* The step of rasters in whole metres or decimetres, which keeps them exactly in a fraction of the bytes;
 * 0: heights are finer. */
static double whole_step(const struct eco_ground *ground, double least)
{
	static const double steps[] = { 1, 0.5, 0.25, 0.2, 0.1, 0.05, 0.025, 0.02 };
	size_t count = (size_t)ground->columns * ground->rows, fits = 0;
	for (size_t i = 0; i < count && fits < sizeof steps / sizeof *steps;) {
		double whole = ((double)ground->height_m[i] - least) / steps[fits];
		/* floats of thousands of metres are off by half a millimetre */
		if (fabs(whole - floor(whole + 0.5)) * steps[fits] > 0.001)
			fits++, i = 0;
		else
			i++;
	}
	return fits < sizeof steps / sizeof *steps ? steps[fits] : 0;
}

/* Chooses the heights that the pack can store. */
static void choose_steps(struct make *m)
{
	const struct eco_ground *ground = &m->ground;
	size_t count = (size_t)ground->columns * ground->rows;
	double least = ground->height_m[0], most = least, low, step;
	for (size_t i = 1; i < count; i++) {
		least = fmin(least, ground->height_m[i]);
		most = fmax(most, ground->height_m[i]);
	}
	low = least;
	step = most > least ? whole_step(ground, least) : 0;
	if (!(step > 0)) {
		double cell = fmin(ground->step_x_m, ground->step_y_m);
		step = lod_power_below(most > least ? fmax(fmin(HEIGHT_STEP_M, (most - least) / RELIEF_STEPS),
			cell / CELL_STEPS) : 1);
		while ((most - least) / step > 1 << 27)
			step *= 2;
		low = floor(least / step) * step + 0.0;
	}
	m->ground_low_m = low;
	m->ground_step_m = step;
}

/* Rounds heights as the pack stores them, so that plants stand on the drawn ground. Those beyond the border
 * lie between its own. */
/* Continues m->ground to the horizon, and rounds its heights as the pack stores them. */
static void finish_ground(struct make *m)
{
	choose_steps(m);
	eco_ground_extend(&m->ground);
	size_t count = (size_t)m->ground.columns * m->ground.rows;
	for (size_t i = 0; i < count; i++) {
		float *z = &m->ground.height_m[i];
		*z = (float)(m->ground_low_m + floor((*z - m->ground_low_m) / m->ground_step_m + 0.5)
			* m->ground_step_m);
	}
	m->has_ground = true;
}

/* Reports slopes that no land has: a unit may be wrong. */
static void doubt_ground(const struct make *m)
{
	const struct eco_ground *g = &m->ground;
	const struct eco_ground_source *source = &m->sources.items[0].ground;
	struct eco_spread slopes = { 0 };
	uint32_t across = g->columns - 1 - 2 * g->margin, up = g->rows - 1 - 2 * g->margin;      /* inside */
	uint64_t cells = (uint64_t)across * up;
	for (uint64_t i = 0; i < cells; i += cells / SLOPES + 1) {
		size_t at = (size_t)(g->margin + i / across) * g->columns + (size_t)(g->margin + i % across);
		double east = (double)(g->height_m[at + 1] - g->height_m[at]) / g->step_x_m,
			north = (double)(g->height_m[at + g->columns] - g->height_m[at]) / g->step_y_m;
		eco_spread_add(&slopes, hypot(east, north));
	}
	double steep = eco_spread_quantile(&slopes, 0.9);
	eco_spread_free(&slopes);
	if (steep > STEEP && source->unit_m == 0)
		main_note("%s: one slope in ten rises more than %.3g m on a metre, as no land does; are "
			"its heights in another unit? (\"ground\": {\"unit\": \"cm\"} or \"scale\" says "
			"it)", source->heights[0], steep);
}

static void tell(void *ctx, const char *text)
{
	(void)ctx;
	main_note("%s", text);
}

static void read_drawing(struct make *m)
{
	const struct eco_source *source = &m->sources.items[0];
	struct eco_frame frame = eco_source_frame(source);
	if (!source->draw_count)
		return;
	main_progress("reading what is drawn on the ground", NULL, 0);
	eco_check(eco_drawing_open(&m->drawing, source->draws, source->draw_count, &frame, m->error));
	eco_drawing_report(m->drawing, tell, NULL);
}

void make_ground_read(struct make *m)
{
	struct eco_source *source = &m->sources.items[0];
	read_drawing(m);
	if (!source->ground.height_count)
		return;
	main_progress("reading ground", NULL, 0);
	struct eco_ground_options options = { .source = &source->ground, .scene_crs = source->crs,
		.scene_vertical = source->vertical, .origin = { source->origin[0], source->origin[1],
		source->origin[2] }, .side_max = ECO_GROUND_INSIDE_MAX, .warn = main_note_text };
	eco_check(eco_ground_import(&m->ground, &options, m->error));
	if (m->drawing)
		eco_drawing_level(m->drawing, &m->ground, tell, NULL);
	finish_ground(m);
	doubt_ground(m);
}

struct tile_list {               /* of one tile, made in a thread */
	struct eco_list list;
	struct eco_encoded encoded;
};

static enum eco_code encode_tile(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	const struct make *m = ctx;
	const struct eco_ground *g = &m->ground;
	const struct eco_ground_tile *tile = &m->ground_tiles[i];
	struct tile_list *made = result;
	struct eco_ground_span x, y;
	struct eco_elements e;
	eco_ground_spans(&x, &y, tile, g->columns, g->rows);
	made->list = (struct eco_list){ .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS,
		.level = tile->level, .owner = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE,
		.grid_origin = { g->x_m, g->y_m, m->ground_low_m },
		.grid_step = { g->step_x_m, g->step_y_m, m->ground_step_m }, .columns = x.count };
	lod_ground_elements(&e, g, tile, m->ground_shifts[i], m->ground_low_m, m->ground_step_m);
	enum eco_code code = eco_pack_encode(&made->encoded, &made->list, &e, (const uint32_t[]){ e.element_count },
		1, error);
	eco_elements_free(&e);
	return code;
}

static enum eco_code add_tile(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct make *m = ctx;
	struct tile_list *made = result;
	(void)error;
	if (i % 64 == 0)
		main_progress("packing ground", NULL, (double)i / m->scene.ground_count);
	m->ground_tiles[i].list = make_add_encoded(m, &made->list, &made->encoded);
	return ECO_OK;
}

static void drop_tile(void *result)
{
	eco_encoded_free(&((struct tile_list *)result)->encoded);
}

/* Makes one list a tile, coarse to fine. Nothing finer is stored where a tile is off by less than a
 * centimetre. */
void make_ground_pack(struct make *m)
{
	struct lod_ground_tree tree;
	if (!m->has_ground)
		return;
	main_progress("measuring ground", NULL, 0);
	eco_check(lod_ground_build(&tree, &m->ground, m->ground_step_m, fmin(m->ground_step_m, HEIGHT_STEP_M),
		m->error));
	m->scene.ground = m->ground_tiles = tree.tiles;
	m->ground_shifts = tree.shifts;
	m->scene.ground_count = tree.count;
	m->scene.ground_columns = m->ground.columns;
	m->scene.ground_rows = m->ground.rows;
	m->scene.ground_margin = m->ground.margin;
	eco_check(main_jobs_run(&(struct main_jobs){ .count = tree.count, .threads = make_threads(m),
		.result_size = sizeof(struct tile_list), .work = encode_tile, .take = add_tile, .drop = drop_tile,
		.ctx = m }, m->error));
}

void make_ground_free(struct make *m)
{
	eco_ground_free(&m->ground);
	eco_drawing_close(m->drawing);
	eco_free(m->ground_tiles, m->ground_shifts, m->ground_images);
}

/* ---- Ground through plants ---- */

/* The ground of a scene without rasters, laid through the feet of its plants. These come from the scene's
 * tables, which `make` and `link` both have, so that linked packs get the ground of the whole. Beyond
 * FEET_MAX plants, that many are taken, evenly along the tree. */

#define FEET_MAX (1u << 20)
#define OFF_NOTED_M 0.1

struct feet {
	const struct eco_scene *scene;
	double (*at)[3]; uint32_t count;
	uint64_t apart;              /* plants from one that is taken to the next */
};

/* The first plant that is taken among those from number `first` on. */
static uint64_t taken_from(const struct feet *f, uint64_t first)
{
	uint64_t over = first % f->apart;
	return over ? f->apart - over : 0;
}

static void take_group(struct feet *f, const struct eco_group *group, const struct eco_placement *file,
	uint64_t first)
{
	const struct eco_list *list = &f->scene->lists[group->list];
	for (uint64_t i = taken_from(f, first); i < group->count; i += f->apart) {
		struct eco_place p = eco_place_read(f->scene, group->place_first + i);
		double at[3];
		for (int k = 0; k < 3; k++)
			at[k] = list->grid_origin[k] + list->grid_step[k] * p.position[k];
		eco_placement_point(file, at, f->at[f->count++]);
	}
}

/* first: the number of plants before the tile's. */
static void take_tile(struct feet *f, uint32_t id, const struct eco_placement *file, uint64_t first)
{
	const struct eco_scene *s = f->scene;
	const struct eco_tile *tile = &s->tiles[id];
	if (taken_from(f, first) >= tile->instance_count)
		return;
	for (uint32_t g = tile->group_first; g < tile->group_first + tile->group_count; g++) {
		take_group(f, &s->groups[g], file, first);
		first += s->groups[g].count;
	}
	for (uint32_t c = tile->child_first; c < tile->child_first + tile->child_count; c++) {
		const struct eco_child *child = &s->children[c];
		struct eco_placement inner = child->placed ? eco_placement_inside(file, child) : *file;
		take_tile(f, child->tile, &inner, first);
		first += s->tiles[child->tile].instance_count;
	}
}

/* Plants that stand where the ground cannot go, as their neighbours are at other heights. */
static void note_off(const struct make *m, const struct feet *f)
{
	uint32_t off = 0;
	double most = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		double z;
		eco_ground_height(&m->ground, f->at[i][0], f->at[i][1], &z);
		off += fabs(f->at[i][2] - z) > OFF_NOTED_M;
		most = fmax(most, fabs(f->at[i][2] - z));
	}
	if (off)
		main_note(
			"the scene names no ground; that through its plants is more than %g m off %u of %u feet, "
			"at most %.2f m, as plants close together stand at other heights: give \"ground\" the rasters "
			"of their heights, or null for none",
			OFF_NOTED_M, off, f->count, most);
}

void make_ground_through(struct make *m)
{
	const struct eco_tile *root = &m->scene.tiles[m->scene.root];
	struct feet f = { .scene = &m->scene, .apart = (root->instance_count + FEET_MAX - 1) / FEET_MAX };
	if (m->has_ground || root->instance_count == 0)
		return;
	main_progress("laying ground through the plants", NULL, 0);
	f.at = eco_alloc(root->instance_count / f.apart + 1, sizeof *f.at);
	take_tile(&f, m->scene.root, &(struct eco_placement){ .scale = 1 }, 0);
	struct eco_ground_feet feet = { .at = (const double (*)[3])f.at, .count = f.count,
		.low = { root->low[0], root->low[1] }, .high = { root->high[0], root->high[1] } };
	eco_ground_through(&m->ground, &feet);
	finish_ground(m);
	note_off(m, &f);
	m->ground_through = true;
	free(f.at);
	make_ground_pack(m);
}

/* ---- The image ---- */

/* The image of the ground: squares come from its reader depth first, and become tiles. Those that are split
 * are made of their quarters, so that no pixel is read twice. Encoding takes longest, and is done for a batch
 * of tiles at a time; lists are numbered coarse to fine, as they are sent. */

#define BATCH 64u                        /* tiles whose texels wait to be encoded */

struct tile {
	struct eco_list list;
	uint32_t children[4];        /* in image.tiles; 0: none */
	struct eco_writer levels[ECO_GROUND_IMAGE_LEVELS];
};

struct waiting { uint32_t tile; uint8_t *rgba; };

struct image {
	struct make *m;
	struct eco_ground_image_reader *reader;
	struct tile *tiles;          uint32_t count, capacity;
	struct waiting waiting[BATCH]; uint32_t waiting_count;
	uint32_t encoded;
};

/* Squares of a drawing without rasters: of 128 m for a town in the final pack. A draft is coarser. */
#define DRAWN_TILES 1024u
#define DRAFT_TILES 256u

static struct eco_ground_image_options options_of(const struct make *m)
{
	const struct eco_source *source = &m->sources.items[0];
	return (struct eco_ground_image_options){ .source = &source->ground_image, .scene_crs = source->crs,
		.drawing = eco_drawing_ground(m->drawing),
		.tiles_max = source->ground_image.file_count ? 0 : m->options->draft ? DRAFT_TILES : DRAWN_TILES,
		.origin = { source->origin[0], source->origin[1], source->origin[2] }, .low = { 1, 1 } };
}

/* Warns later, when it is known where plants stand. */
void make_image_look(struct make *m)
{
	const struct eco_ground_image_options options = options_of(m);
	if (options.source->file_count || options.drawing)
		eco_check(eco_ground_image_look(&options, m->error));
}

/* ---- Encoding ---- */

static void drop(void *result)
{
	struct eco_writer *levels = result;
	for (uint32_t i = 0; i < ECO_GROUND_IMAGE_LEVELS; i++)
		eco_writer_free(&levels[i]);
}

static enum eco_code encode(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	return lod_image_levels(result, ((const struct image *)ctx)->waiting[i].rgba, error);
}

static enum eco_code keep(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct image *image = ctx;
	struct tile *tile = &image->tiles[image->waiting[i].tile];
	(void)error;
	if (image->encoded++ % 16 == 0)
		main_progress("packing the ground's image", NULL, 0);
	memcpy(tile->levels, result, sizeof tile->levels);
	memset(result, 0, sizeof tile->levels);
	return ECO_OK;
}

static void encode_waiting(struct image *image)
{
	eco_check(main_jobs_run(&(struct main_jobs){ .count = image->waiting_count,
		.threads = make_threads(image->m), .result_size = sizeof image->tiles->levels, .work = encode,
		.take = keep, .drop = drop, .ctx = image }, image->m->error));
	for (uint32_t i = 0; i < image->waiting_count; i++)
		free(image->waiting[i].rgba);
	image->waiting_count = 0;
}

/* Takes a copy of the texels. */
static void wait_for(struct image *image, uint32_t tile, const uint8_t *rgba)
{
	uint8_t *copy = eco_alloc(1, ECO_GROUND_IMAGE_BYTES);
	memcpy(copy, rgba, ECO_GROUND_IMAGE_BYTES);
	image->waiting[image->waiting_count++] = (struct waiting){ tile, copy };
	if (image->waiting_count == BATCH)
		encode_waiting(image);
}

/* ---- The tree ---- */

static uint32_t read_tile(struct image *image, const struct eco_list *list, uint8_t *rgba);

static void read_quarters(struct image *image, uint32_t id, uint8_t *rgba)
{
	uint8_t *room = eco_alloc(4, ECO_GROUND_IMAGE_BYTES);
	const uint8_t *quarters[4];
	for (uint32_t q = 0; q < 4; q++) {
		struct eco_list list = image->tiles[id].list;
		eco_ground_image_quarter(&list, q);
		quarters[q] = room + (size_t)q * ECO_GROUND_IMAGE_BYTES;
		uint32_t child = read_tile(image, &list, room + (size_t)q * ECO_GROUND_IMAGE_BYTES);
		image->tiles[id].children[q] = child;
	}
	lod_image_join(rgba, quarters);
	free(room);
}

/* The next square, and what it is split into; returns its number. The root's place comes with it. */
static uint32_t read_tile(struct image *image, const struct eco_list *list, uint8_t *rgba)
{
	struct eco_ground_image_tile square = { .rgba = rgba };
	eco_check(eco_ground_image_next(image->reader, &square, image->m->error));
	eco_grow(&image->tiles, &image->capacity, image->count, sizeof *image->tiles);
	uint32_t id = image->count++;
	image->tiles[id] = (struct tile){ .list = *list };
	if (!id) {
		struct eco_list *root = &image->tiles[0].list;
		memcpy(root->grid_origin, square.low, sizeof square.low);
		root->grid_step[0] = root->grid_step[1] = square.texel_m;
	}
	if (square.split)
		read_quarters(image, id, rgba);
	wait_for(image, id, rgba);
	return id;
}

/* Level by level, as the pack wants them. */
static void pack_tiles(struct image *image)
{
	struct make *m = image->m;
	uint32_t *order = eco_alloc(image->count, sizeof *order), end = 1;
	m->ground_images = eco_alloc(image->count, sizeof *m->ground_images);
	for (uint32_t i = 0; i < image->count; i++) {
		struct tile *tile = &image->tiles[order[i]];
		m->ground_images[i].list = make_add_levels(m, &tile->list, tile->levels, ECO_GROUND_IMAGE_LEVELS);
		m->ground_images[i].child_first = tile->children[0] ? end : 0;
		for (uint32_t q = 0; q < 4 && tile->children[0]; q++)
			order[end++] = tile->children[q];
	}
	free(order);
	m->scene.ground_images = m->ground_images;
	m->scene.ground_image_count = image->count;
}

static void read_all(void *image)
{
	const struct eco_list root = { .kind = ECO_LIST_GROUND_IMAGE, .coder = ECO_CODER_BYTES,
		.owner = ECO_NONE, .image = ECO_NONE, .partner = ECO_NONE, .grid_step = { 1, 1, 1 } };
	uint8_t *rgba = eco_alloc(1, ECO_GROUND_IMAGE_BYTES);
	read_tile(image, &root, rgba);
	free(rgba);
}

void make_image(struct make *m)
{
	struct image image = { .m = m };
	struct eco_ground_image_options options = options_of(m);
	const struct eco_tile *root = &m->scene.tiles[m->scene.root];
	if (!(options.source->file_count || options.drawing) || !m->has_ground)
		return;
	main_progress("reading the ground's image", NULL, 0);
	memcpy(options.low, root->low, sizeof options.low);
	memcpy(options.high, root->high, sizeof options.high);
	options.warn = main_note_text;
	struct eco_error missed = { .code = ECO_OK }, *error = m->error;
	eco_check(eco_ground_image_open(&image.reader, &options, m->error));
	m->error = &missed;              /* what the child says comes first */
	enum eco_code code = eco_try(read_all, &image, &missed);
	m->error = error;
	eco_check(eco_ground_image_close(image.reader, m->error));
	if (code)
		eco_stop(code, "%s", missed.text);
	m->scene.needs |= eco_drawing_has_water(m->drawing) ? ECO_NEED_WATER : 0;
	encode_waiting(&image);
	pack_tiles(&image);
	for (uint32_t i = 0; i < image.count; i++)
		drop(image.tiles[i].levels);
	free(image.tiles);
}
