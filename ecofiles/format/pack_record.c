/* Each record as a table of its fields, in their order in the file: this file defines the bytes. Values are
 * as wide as in the structs of pack.h and list.h. */
#include "ecofiles/format/pack_record.h"

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- Fields ---- */

/* `count` values of `width` bytes, which lie at `at` in the record's struct. FLAG: a bool. NAME: text that is
 * filled up with zeros, so that equal scenes are equal bytes. ZEROS: `count` bytes that are in no struct. */
struct field { enum { VALUES, FLAG, NAME, ZEROS } kind; uint8_t width, count; uint16_t at; };

#define MEMBER(record, member) ((struct eco_##record *)0)->member
#define FIELD(kind, record, member) \
	{ kind, sizeof MEMBER(record, member), 1, offsetof(struct eco_##record, member) }
#define ONE(record, member) FIELD(VALUES, record, member)
#define ARRAY(record, member) { VALUES, sizeof MEMBER(record, member)[0], \
	sizeof MEMBER(record, member) / sizeof MEMBER(record, member)[0], \
	offsetof(struct eco_##record, member) }
#define SEEN(record, member) { VALUES, 2, sizeof MEMBER(record, member) / 2, offsetof(struct eco_##record, member) }
#define ZERO_BYTES(count) { ZEROS, 1, count, 0 }

static void write_value(struct eco_writer *w, const uint8_t *from, unsigned width)
{
	uint16_t u16;
	uint32_t u32;
	uint64_t u64;
	switch (width) {
	case 1: eco_write_u8(w, *from); break;
	case 2: memcpy(&u16, from, 2); eco_write_u16(w, u16); break;
	case 4: memcpy(&u32, from, 4); eco_write_u32(w, u32); break;
	default: memcpy(&u64, from, 8); eco_write_u64(w, u64);
	}
}

static void read_value(struct eco_reader *r, uint8_t *to, unsigned width)
{
	uint16_t u16;
	uint32_t u32;
	uint64_t u64;
	switch (width) {
	case 1: *to = eco_read_u8(r); break;
	case 2: u16 = eco_read_u16(r); memcpy(to, &u16, 2); break;
	case 4: u32 = eco_read_u32(r); memcpy(to, &u32, 4); break;
	default: u64 = eco_read_u64(r); memcpy(to, &u64, 8);
	}
}

static void write_field(struct eco_writer *w, const struct field *f, const uint8_t *from)
{
	size_t length = f->kind == NAME ? strnlen((const char *)from, f->width - 1u) : 0;
	for (unsigned i = 0; f->kind < NAME && i < f->count; i++)
		write_value(w, from + i * f->width, f->width);
	if (f->kind < NAME)
		return;
	eco_write_bytes(w, from, length);
	for (; length < f->width * (size_t)f->count; length++)
		eco_write_u8(w, 0);
}

/* A name, which has a zero behind it, and the zeros that fill it up, or zeros alone. */
static void read_filled(struct eco_reader *r, const struct field *f, uint8_t *to)
{
	size_t size = f->width * (size_t)f->count;
	const uint8_t *bytes = eco_read_bytes(r, size);
	size_t length = bytes && f->kind == NAME ? strnlen((const char *)bytes, size) : 0;
	for (size_t i = length; bytes && i < size; i++)
		r->failed |= bytes[i] != 0;
	r->failed |= length == size;
	if (length < size && length > 0)
		memcpy(to, bytes, length);
}

static void read_field(struct eco_reader *r, const struct field *f, uint8_t *to)
{
	if (f->kind >= NAME)
		read_filled(r, f, to);
	for (unsigned i = 0; f->kind < NAME && i < f->count; i++)
		read_value(r, to + i * f->width, f->width);
	if (f->kind == FLAG && *to > 1) {
		r->failed = true;
		*to = 1;
	}
}

/* ---- Records ---- */

static const struct field section_fields[] = {
	ONE(section, kind), ONE(section, count), ONE(section, offset), ONE(section, size), ONE(section, hash),
	ONE(section, record_bytes), ZERO_BYTES(4),
};

static const struct field scene_fields[] = {
	FIELD(NAME, scene, name), ONE(scene, needs), ONE(scene, root), ONE(scene, ground_columns),
	ONE(scene, ground_rows), ONE(scene, ground_margin), ONE(scene, near_m),
};

static const struct field plant_fields[] = {
	FIELD(NAME, plant, name), ONE(plant, height_m), ONE(plant, anchor_first), ONE(plant, anchor_count),
	ONE(plant, ladder_first), ONE(plant, ladder_count), ONE(plant, area), ONE(plant, triangles),
	ONE(plant, leaf_width), ONE(plant, leaf_tone),
};

static const struct field anchor_fields[] = { ARRAY(anchor, center), ONE(anchor, radius) };

static const struct field ladder_fields[] = {
	ONE(ladder, plant), ONE(ladder, anchor), ONE(ladder, organ), ONE(ladder, flags),
	ONE(ladder, level_count), ZERO_BYTES(1), ONE(ladder, points), ONE(ladder, lines), ONE(ladder, simple),
	ONE(ladder, triangles), ONE(ladder, impostor), ARRAY(ladder, level_end), ONE(ladder, total),
	ONE(ladder, before), ONE(ladder, importance), ONE(ladder, area), ONE(ladder, length),
	ONE(ladder, epsilon),
	ONE(ladder, curve_first), ONE(ladder, curve_count), SEEN(ladder, nothing),
};

static const struct field curve_fields[] = {
	ONE(curve, share), ONE(curve, scale), ONE(curve, reach), ONE(curve, fp), ONE(curve, fn),
	SEEN(curve, seen),
};

static const struct field tile_fields[] = {
	ARRAY(tile, low), ARRAY(tile, high), ONE(tile, area), ONE(tile, instance_count), ONE(tile, summary),
	ONE(tile, group_first), ONE(tile, group_count), ONE(tile, child_first), ONE(tile, child_count),
};

static const struct field ground_tile_fields[] = {
	ONE(ground_tile, list), ONE(ground_tile, column), ONE(ground_tile, row), ONE(ground_tile, level),
	ONE(ground_tile, child_count), ZERO_BYTES(2), ONE(ground_tile, child_first),
	ONE(ground_tile, error_m), ONE(ground_tile, low_m), ONE(ground_tile, high_m),
};

static const struct field ground_image_fields[] = { ONE(ground_image, list), ONE(ground_image, child_first) };

static const struct field group_fields[] = {
	ONE(group, tile), ONE(group, plant), ONE(group, list), ONE(group, place_first), ONE(group, first),
	ONE(group, count),
};

static const struct field child_fields[] = {
	ONE(child, tile), FIELD(FLAG, child, placed), ZERO_BYTES(3), ARRAY(child, at), ONE(child, turn),
	ZERO_BYTES(2), ONE(child, scale),
};

static const struct field list_fields[] = {
	ONE(list, kind), ONE(list, coder), ONE(list, attributes), ONE(list, level), ONE(list, owner),
	ONE(list, group_count), ARRAY(list, grid_origin), ARRAY(list, grid_step), ONE(list, unit_area),
	ONE(list, palette_first), ONE(list, palette_count), ONE(list, image), ONE(list, partner),
	ONE(list, columns), ONE(list, primitive_count), ONE(list, element_count), ONE(list, chunk_first),
	ONE(list, chunk_count),
};

static const struct field chunk_fields[] = {
	ARRAY(chunk, id.bytes), ONE(chunk, offset), ONE(chunk, size_bytes), ONE(chunk, primitive_count),
	ONE(chunk, element_count),
};

static const struct field place_fields[] = {
	ARRAY(place, position), ONE(place, turn), ONE(place, width), ONE(place, tint),
	ONE(place, scale),
};

static const struct field palette_fields[] = { { VALUES, 1, 3, 0 } };

/* A section's name, its records, and where in struct eco_scene their table and its count are, if they are. */
#define RECORDS(name, record, fields) name, sizeof fields / sizeof *fields, fields, sizeof(struct eco_##record)
#define TABLE(section, table, record, count) [ECO_SECTION_##section] = { RECORDS(#section, record, \
	record##_fields), offsetof(struct eco_scene, table), offsetof(struct eco_scene, count) },
static const struct records {
	const char *name;
	size_t field_count;
	const struct field *fields;
	size_t struct_bytes, table_at, count_at;
} records[ECO_SECTION_KIND_END] = {
	[ECO_SECTION_NONE] = { RECORDS("none", section, section_fields), 0, 0 },
	[ECO_SECTION_META] = { .name = "META" },
	[ECO_SECTION_SCENE] = { RECORDS("SCENE", scene, scene_fields), 0, 0 },
	ECO_PACK_TABLES(TABLE)
	[ECO_SECTION_PALETTE] = { .name = "PALETTE", .fields = palette_fields, .field_count = 1 },
	[ECO_SECTION_PLACES] = { RECORDS("PLACES", place, place_fields), 0, 0 },
	[ECO_SECTION_CHUNK_DATA] = { .name = "CHUNK_DATA" },
};

const char *eco_section_name(enum eco_section_kind kind) { return records[kind].name; }

uint32_t eco_record_bytes(enum eco_section_kind kind)
{
	uint32_t bytes = 0;
	for (size_t i = 0; i < records[kind].field_count; i++)
		bytes += records[kind].fields[i].width * (uint32_t)records[kind].fields[i].count;
	return bytes;
}

uint32_t eco_record_widths(enum eco_section_kind kind, uint8_t widths[ECO_RECORD_VALUES_MAX])
{
	uint32_t count = 0;
	for (size_t i = 0; i < records[kind].field_count; i++) {
		const struct field *f = &records[kind].fields[i];
		uint8_t width = f->kind == NAME || f->width > 4 ? 4 : f->width;
		for (size_t at = 0; at < f->width * (size_t)f->count && count < ECO_RECORD_VALUES_MAX; at += width)
			widths[count++] = width;
	}
	return count;
}

void eco_record_write(struct eco_writer *w, enum eco_section_kind kind, const void *record)
{
	const struct records *k = &records[kind];
	for (const struct field *f = k->fields; f < k->fields + k->field_count; f++)
		write_field(w, f, (const uint8_t *)record + f->at);
}

void eco_record_read(struct eco_reader *r, enum eco_section_kind kind, void *record)
{
	const struct records *k = &records[kind];
	memset(record, 0, k->struct_bytes);
	for (const struct field *f = k->fields; f < k->fields + k->field_count; f++)
		read_field(r, f, (uint8_t *)record + f->at);
}

bool eco_records_are_table(enum eco_section_kind kind) { return records[kind].table_at; }

uint32_t eco_records_count(const struct eco_scene *scene, enum eco_section_kind kind)
{
	return *(const uint32_t *)((const char *)scene + records[kind].count_at);
}

void eco_records_write(struct eco_writer *w, enum eco_section_kind kind, const struct eco_scene *scene)
{
	const uint8_t *table = *(const uint8_t *const *)((const char *)scene + records[kind].table_at);
	for (uint32_t i = 0; i < eco_records_count(scene, kind); i++)
		eco_record_write(w, kind, table + i * records[kind].struct_bytes);
}

void *eco_records_read(struct eco_reader *r, enum eco_section_kind kind, uint32_t count, struct eco_scene *scene)
{
	uint8_t *table = calloc(count ? count : 1, records[kind].struct_bytes);
	for (uint32_t i = 0; table && i < count && !r->failed; i++)
		eco_record_read(r, kind, table + i * records[kind].struct_bytes);
	*(const void **)((char *)scene + records[kind].table_at) = table;
	*(uint32_t *)((char *)scene + records[kind].count_at) = count;
	return table;
}

struct eco_place eco_place_read(const struct eco_scene *scene, uint64_t index)
{
	assert(index < scene->place_count);
	const uint8_t *p = scene->places + index * ECO_PLACE_BYTES;
	uint32_t word[5];
	for (unsigned i = 0; i < 5; i++, p += 4)
		word[i] = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
	return (struct eco_place){
		.position = { (int32_t)word[0], (int32_t)word[1], (int32_t)word[2] },
		.turn = (uint16_t)word[3],
		.width = (uint8_t)(word[3] >> 16),
		.tint = (uint8_t)(word[3] >> 24),
		.scale = word[4],
	};
}
