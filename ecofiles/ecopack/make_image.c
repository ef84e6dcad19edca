/* The image of the ground: squares come from its reader depth first, and become tiles. Those that are split
 * are made of their quarters, so that no pixel is read twice. Encoding takes longest, and is done for a batch
 * of tiles at a time; lists are numbered coarse to fine, as they are sent. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/make.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/run.h"
#include "lod/build/texture.h"

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

static struct eco_ground_image_options options_of(const struct make *m)
{
	const struct eco_source *source = &m->sources.items[0];
	return (struct eco_ground_image_options){ .source = &source->ground_image, .scene_crs = source->crs,
		.origin = { source->origin[0], source->origin[1], source->origin[2] }, .low = { 1, 1 } };
}

/* Warns later, when it is known where plants stand. */
void make_image_look(struct make *m)
{
	const struct eco_ground_image_options options = options_of(m);
	if (options.source->file_count)
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

static enum eco_code encode_waiting(struct image *image)
{
	enum eco_code code = main_jobs_run(&(struct main_jobs){ .count = image->waiting_count,
		.threads = make_threads(image->m), .result_size = sizeof image->tiles->levels, .work = encode,
		.take = keep, .drop = drop, .ctx = image }, image->m->error);
	for (uint32_t i = 0; i < image->waiting_count; i++)
		free(image->waiting[i].rgba);
	image->waiting_count = 0;
	return code;
}

/* Takes a copy of the texels. */
static enum eco_code wait_for(struct image *image, uint32_t tile, const uint8_t *rgba)
{
	uint8_t *copy = eco_alloc(1, ECO_GROUND_IMAGE_BYTES);
	memcpy(copy, rgba, ECO_GROUND_IMAGE_BYTES);
	image->waiting[image->waiting_count++] = (struct waiting){ tile, copy };
	return image->waiting_count < BATCH ? ECO_OK : encode_waiting(image);
}

/* ---- The tree ---- */

static enum eco_code read_tile(struct image *image, const struct eco_list *list, uint32_t *id, uint8_t *rgba);

static enum eco_code read_quarters(struct image *image, uint32_t id, uint8_t *rgba)
{
	uint8_t *room = eco_alloc(4, ECO_GROUND_IMAGE_BYTES);
	const uint8_t *quarters[4];
	enum eco_code code = ECO_OK;
	for (uint32_t q = 0; q < 4 && !code; q++) {
		struct eco_list list = image->tiles[id].list;
		uint32_t child = 0;
		eco_ground_image_quarter(&list, q);
		quarters[q] = room + (size_t)q * ECO_GROUND_IMAGE_BYTES;
		code = read_tile(image, &list, &child, room + (size_t)q * ECO_GROUND_IMAGE_BYTES);
		image->tiles[id].children[q] = child;
	}
	if (!code)
		lod_image_join(rgba, quarters);
	free(room);
	return code;
}

/* The next square, and what it is split into. The root's place comes with it. */
static enum eco_code read_tile(struct image *image, const struct eco_list *list, uint32_t *id, uint8_t *rgba)
{
	struct eco_ground_image_tile square = { .rgba = rgba };
	enum eco_code code = eco_ground_image_next(image->reader, &square, image->m->error);
	if (code)
		return code;
	eco_grow(&image->tiles, &image->capacity, image->count, sizeof *image->tiles);
	*id = image->count++;
	image->tiles[*id] = (struct tile){ .list = *list };
	if (!*id) {
		struct eco_list *root = &image->tiles[0].list;
		memcpy(root->grid_origin, square.low, sizeof square.low);
		root->grid_step[0] = root->grid_step[1] = square.texel_m;
	}
	if (square.split)
		code = read_quarters(image, *id, rgba);
	return code ? code : wait_for(image, *id, rgba);
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

static enum eco_code read_all(struct image *image)
{
	const struct eco_list root = { .kind = ECO_LIST_GROUND_IMAGE,
		.coder = ECO_CODER_BYTES,
		.owner = ECO_NONE,
		.image = ECO_NONE,
		.partner = ECO_NONE,
		.grid_step = { 1, 1, 1 } };
	uint32_t id;
	uint8_t *rgba = eco_alloc(1, ECO_GROUND_IMAGE_BYTES);
	enum eco_code code = read_tile(image, &root, &id, rgba);
	free(rgba);
	return code;
}

void make_image(struct make *m)
{
	struct image image = { .m = m };
	struct eco_ground_image_options options = options_of(m);
	const struct eco_tile *root = &m->scene.tiles[m->scene.root];
	if (!options.source->file_count || !m->has_ground)
		return;
	main_progress("reading the ground's image", NULL, 0);
	memcpy(options.low, root->low, sizeof options.low);
	memcpy(options.high, root->high, sizeof options.high);
	options.warn = main_note_text;
	struct eco_error missed = { .code = ECO_OK }, *error = m->error;
	eco_check(eco_ground_image_open(&image.reader, &options, m->error));
	m->error = &missed;              /* what the child says comes first */
	enum eco_code code = read_all(&image);
	m->error = error;
	enum eco_code verdict = eco_ground_image_close(image.reader, m->error);
	if (!verdict && code)
		eco_fail(m->error, code, "%s", missed.text);
	eco_check(verdict ? verdict : code);
	eco_check(encode_waiting(&image));
	pack_tiles(&image);
	for (uint32_t i = 0; i < image.count; i++)
		drop(image.tiles[i].levels);
	free(image.tiles);
}
