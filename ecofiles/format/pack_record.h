/* Sections and records of a pack: sizes, and one reader and one writer per table. The file's frame is in
 * pack.h. */
#ifndef ECO_PACK_RECORD_H
#define ECO_PACK_RECORD_H

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/pack.h"

#define ECO_PACK_MAGIC "ECOPACK1"
#define ECO_PACK_HEADER_BYTES 32u
#define ECO_PACK_SECTION_BYTES 40u
#define ECO_PACK_ALIGN 64u

enum eco_section_kind {
	ECO_SECTION_META = 1, ECO_SECTION_SCENE, ECO_SECTION_PLANTS, ECO_SECTION_ANCHORS, ECO_SECTION_LADDERS,
		ECO_SECTION_CURVES,
	ECO_SECTION_TILES, ECO_SECTION_GROUPS, ECO_SECTION_CHILDREN, ECO_SECTION_LISTS, ECO_SECTION_CHUNKS,
	ECO_SECTION_PALETTE, ECO_SECTION_PLACES, ECO_SECTION_GROUND, ECO_SECTION_GROUND_IMAGES,
	ECO_SECTION_CHUNK_DATA,
	ECO_SECTION_KIND_END
};

/* By section kind: name for messages, and bytes of a record (0: META and CHUNK_DATA, which have none). */
struct eco_section_info { const char *name; uint32_t record_bytes; };
extern const struct eco_section_info eco_section_info[ECO_SECTION_KIND_END];

struct eco_section {
	uint32_t kind, count;
	uint64_t offset, size, hash;
	uint32_t record_bytes;
};
void eco_section_write(struct eco_writer *w, const struct eco_section *section);
void eco_section_read(struct eco_reader *r, struct eco_section *section);

/* Tables of a scene whose sections hold their records unchanged, in the order of the sections: X(SECTION,
 * table, record). Not among them: chunks, whose offsets are known last, and the ground and its image,
 * whose tables and records have different names. */
#define ECO_PACK_TABLES(X) \
	X(PLANTS, plants, plant) X(ANCHORS, anchors, anchor) X(LADDERS, ladders, ladder) X(CURVES, curves, \
	curve) \
	X(TILES, tiles, tile) X(GROUPS, groups, group) X(CHILDREN, children, child) X(LISTS, lists, list)

/* The SCENE record holds the scalars of struct eco_scene. Readers fail `r` where unused bytes are not
 * zero. */
void eco_scene_write(struct eco_writer *w, const struct eco_scene *scene);
void eco_scene_read(struct eco_reader *r, struct eco_scene *scene);
void eco_plant_write(struct eco_writer *w, const struct eco_plant *plant);
void eco_plant_read(struct eco_reader *r, struct eco_plant *plant);
void eco_ladder_write(struct eco_writer *w, const struct eco_ladder *ladder);
void eco_ladder_read(struct eco_reader *r, struct eco_ladder *ladder);
void eco_curve_write(struct eco_writer *w, const struct eco_curve *curve);
void eco_curve_read(struct eco_reader *r, struct eco_curve *curve);
void eco_ground_tile_write(struct eco_writer *w, const struct eco_ground_tile *tile);
void eco_ground_tile_read(struct eco_reader *r, struct eco_ground_tile *tile);
void eco_ground_image_write(struct eco_writer *w, const struct eco_ground_image *tile);
void eco_ground_image_read(struct eco_reader *r, struct eco_ground_image *tile);
void eco_tile_write(struct eco_writer *w, const struct eco_tile *tile);
void eco_tile_read(struct eco_reader *r, struct eco_tile *tile);
void eco_group_write(struct eco_writer *w, const struct eco_group *group);
void eco_group_read(struct eco_reader *r, struct eco_group *group);
void eco_child_write(struct eco_writer *w, const struct eco_child *child);
void eco_child_read(struct eco_reader *r, struct eco_child *child);
void eco_chunk_write(struct eco_writer *w, const struct eco_chunk *chunk);
void eco_chunk_read(struct eco_reader *r, struct eco_chunk *chunk);

#endif
