/* Scenes made by hand, for tests, fuzz targets and benches: tables that grow row by row, lists with or
 * without elements, and the same as a pack or as encoded chunks in memory.
 *
 *   struct scene_builder b = { .like = { .grid_step = { 1e-3, 1e-3, 1e-3 } } };
 *   scene_add_plant(&b, (struct eco_plant){ .name = "oak" });      a row of a table; returns its index
 *   scene_add_rows(&b, rows, count);                               lists, with room for their elements
 *   scene_write(&b, path, meta, NULL, &error);                     b.scene and all lists as a pack, or
 *                                                                  scene_encode(&b)
 *   scene_free(&b);
 *
 * b.scene is whole at any time. Rows count themselves in the rows that they belong to: callers leave those
 * counts out. Without memory the program ends. */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/heights.h"
#include "ecofiles/format/pack.h"

struct scene_builder {
	struct eco_scene scene;              /* its tables are the ones below */
	struct eco_plant *plants;
	struct eco_anchor *anchors;
	struct eco_ladder *ladders;
	struct eco_curve *curves;
	struct eco_tile *tiles;
	struct eco_group *groups;
	struct eco_child *children;
	struct eco_list *lists;
	struct eco_chunk *chunks;
	struct eco_ground_tile *ground;
	struct eco_ground_image *ground_images;
	uint8_t (*palette)[3];
	struct eco_writer places;
	struct eco_elements *elements;       /* of each list; empty where only tables are asked for */
	/* of each list: where its chunks end; NULL: see split. Of impostors, images of the ground and
	 * inventories, their files: one a chunk */
	struct scene_ends { const uint32_t *ends; uint32_t count; const struct eco_bytes *files; } *ends;
	uint8_t **payloads;                  /* of each chunk; NULL unless scene_encode made it */
	/* levels of all lists of kind IMAGE, and of kind OUTLINE; NULL: they have no chunk */
	const struct eco_bytes *texture[2];
	uint32_t texture_levels;
	struct eco_list like;                /* grid, area and colours of lists */
	/* where the chunks of a list end; NULL: one chunk; at most SCENE_CHUNKS_MAX */
	uint32_t (*split)(uint32_t count, uint32_t *ends);
	uint64_t state;                      /* of random numbers */
};
#define SCENE_CHUNKS_MAX 4096u

/* A plant's anchors and ladders follow it; anchors are those of the last plant. */
uint32_t scene_add_plant(struct scene_builder *b, struct eco_plant row);
uint32_t scene_add_anchor(struct scene_builder *b, struct eco_anchor row);
uint32_t scene_add_ladder(struct scene_builder *b, struct eco_ladder row);
/* A curve whose errors fall the less, the more is drawn. */
#define SCENE_CURVE(share_, scale_, reach_, fp_, fn_) \
	{ .share = (share_), .scale = (scale_), .reach = (reach_), .fp = (fp_), .fn = (fn_) }
extern const struct eco_curve scene_falling[5];
/* Errors of colour as of wrong pixels (LOD_SEEN_COLOR): before like plants of those that are missed, before
 * ground and sky of all. Rows get them from fp and fn; where nothing of a ladder is drawn it counts twice. */
struct eco_seen scene_seen(double fp, double fn);
uint32_t scene_add_curve(struct scene_builder *b, struct eco_curve row);
uint32_t scene_add_tile(struct scene_builder *b, struct eco_tile row);
/* Without a count: all of its list. */
uint32_t scene_add_group(struct scene_builder *b, struct eco_group row);
uint32_t scene_add_child(struct scene_builder *b, uint32_t parent, struct eco_child row);
uint32_t scene_add_list(struct scene_builder *b, struct eco_list row);
uint32_t scene_add_chunk(struct scene_builder *b, struct eco_chunk row);
uint32_t scene_add_ground(struct scene_builder *b, struct eco_ground_tile row);
uint32_t scene_add_ground_image(struct scene_builder *b, struct eco_ground_image row);
void scene_add_colors(struct scene_builder *b, const uint8_t (*colors)[3], uint32_t count);
void scene_add_place(struct scene_builder *b, struct eco_place place);

/* A ladder without lists, of neutral importance. */
struct eco_ladder scene_ladder(uint32_t plant, uint32_t anchor, enum eco_organ organ);

/* Kind and attributes of a list, and so many elements of so many corners, if any. `other`: forms: what they
 * are forms of; otherwise the texture. */
struct scene_row { uint8_t kind, coder, attributes; uint32_t owner, other, count; uint8_t corners; };
struct eco_list scene_list(const struct scene_builder *b, const struct scene_row *row);
/* A list with these elements, which are the builder's from then on. */
uint32_t scene_add_made(struct scene_builder *b, struct eco_list list, struct eco_elements e);
/* Lists with elements that are all zero; returns the first. */
uint32_t scene_add_rows(struct scene_builder *b, const struct scene_row *rows, uint32_t count);
/* Elements of a list, all zero: positions, and what its attributes ask for. */
struct eco_elements elements_make(const struct eco_list *list, uint32_t count, uint8_t corners);
void scene_elements(struct scene_builder *b, uint32_t list, uint32_t count, uint8_t corners);
/* A list of tables alone: one chunk, eight bytes an element. */
uint32_t scene_add_bare(struct scene_builder *b, const struct scene_row *row, uint32_t primitives,
	uint32_t elements);
/* The group and the places of a list of instances that has its elements. */
void scene_add_instances(struct scene_builder *b, uint32_t list, uint32_t plant);
/* All tiles of a ground, with their lists. */
enum eco_code scene_add_heights(struct scene_builder *b, const struct eco_ground *ground,
	struct eco_error *error);

/* Chunks and payloads of all lists, in memory; those of impostors have none. */
void scene_encode(struct scene_builder *b);
/* After that: chunks of a list of files, one each, of copies of their bytes. The list has none so far. */
void scene_add_files(struct scene_builder *b, uint32_t list, const struct eco_bytes *files, uint32_t count);
/* Writes the pack; with `keep` not NULL leaves the writer there, with all lists added, instead of committing.
 */
enum eco_code scene_write(struct scene_builder *b, const char *path, const char *meta,
	struct eco_pack_writer **keep, struct eco_error *error);
/* The tables of a scene, to be written to; without elements and payloads. */
void scene_copy(struct scene_builder *b, const struct eco_scene *scene);
void scene_free(struct scene_builder *b);

/* Random numbers of 31 bits, by a linear congruence. */
uint32_t lcg_bits(uint64_t *state);
