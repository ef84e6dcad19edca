/* Sections and records of a pack: sizes, reading and writing. The file's frame is in pack.h. */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/pack.h"

#define ECO_PACK_MAGIC "ECOPACK1"
#define ECO_PACK_HEADER_BYTES 32u
#define ECO_PACK_SECTION_BYTES 40u
#define ECO_PACK_ALIGN 64u

enum eco_section_kind {
	ECO_SECTION_NONE,                    /* records of the section table itself */
	ECO_SECTION_META, ECO_SECTION_SCENE, ECO_SECTION_PLANTS, ECO_SECTION_ANCHORS, ECO_SECTION_LADDERS,
	ECO_SECTION_CURVES, ECO_SECTION_TILES, ECO_SECTION_GROUPS, ECO_SECTION_CHILDREN, ECO_SECTION_LISTS,
	ECO_SECTION_CHUNKS, ECO_SECTION_PALETTE, ECO_SECTION_PLACES, ECO_SECTION_GROUND,
	ECO_SECTION_GROUND_IMAGES, ECO_SECTION_CHUNK_DATA,
	ECO_SECTION_KIND_END
};

struct eco_section {
	uint32_t kind, count;
	uint64_t offset, size, hash;
	uint32_t record_bytes;
};

/* Tables of struct eco_scene that are sections: X(SECTION, table, record, count). */
#define ECO_PACK_TABLES(X) \
	X(PLANTS, plants, plant, plant_count) X(ANCHORS, anchors, anchor, anchor_count) \
	X(LADDERS, ladders, ladder, ladder_count) X(CURVES, curves, curve, curve_count) \
	X(TILES, tiles, tile, tile_count) X(GROUPS, groups, group, group_count) \
	X(CHILDREN, children, child, child_count) X(LISTS, lists, list, list_count) \
	X(CHUNKS, chunks, chunk, chunk_count) X(GROUND, ground, ground_tile, ground_count) \
	X(GROUND_IMAGES, ground_images, ground_image, ground_image_count)

/* For messages. */
const char *eco_section_name(enum eco_section_kind kind);
/* In the file; 0: META and CHUNK_DATA, which have no records. */
uint32_t eco_record_bytes(enum eco_section_kind kind);
/* Widths of the values of a record, in their order: 1, 2 or 4 bytes; wider ones are several. Returns how many. */
#define ECO_RECORD_VALUES_MAX 64u
uint32_t eco_record_widths(enum eco_section_kind kind, uint8_t widths[ECO_RECORD_VALUES_MAX]);
/* A record's struct to and from bytes; of SCENE: the scalars of struct eco_scene. Fields of the struct that
 * the pack lacks are read as 0. Reading fails `r` where unused bytes are not zero. */
void eco_record_write(struct eco_writer *w, enum eco_section_kind kind, const void *record);
void eco_record_read(struct eco_reader *r, enum eco_section_kind kind, void *record);

bool eco_records_are_table(enum eco_section_kind kind);
uint32_t eco_records_count(const struct eco_scene *scene, enum eco_section_kind kind);
void eco_records_write(struct eco_writer *w, enum eco_section_kind kind, const struct eco_scene *scene);
/* Puts a table of `count` records into the scene; returns it, malloc'ed, or NULL: no memory. */
void *eco_records_read(struct eco_reader *r, enum eco_section_kind kind, uint32_t count, struct eco_scene *scene);
