/* Neighbouring corners are near each other: as differences in varints they take a third of their memory,
 * which a bounded cache is short of; decoding costs little beside the search in the cache. */
#include "lod/build/plant_bytes.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/impostor.h"
#include "ecofiles/format/pack_record.h"

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)
#define COUNTS 7

/* ---- Writing ---- */

/* Writes `stride` values a row, each as its difference to the row before. */
static void write_deltas(struct eco_writer *w, const int32_t *values, uint64_t rows, uint32_t stride)
{
	for (uint64_t i = 0; i < rows * stride; i++)
		eco_write_zigzag(w, (int64_t)values[i] - (i < stride ? 0 : values[i - stride]));
}

/* Exact positions are near those on the grid. */
static void write_exact(struct eco_writer *w, const struct eco_elements *e)
{
	for (uint64_t i = 0; i < 3ull * e->corner_count; i++)
		eco_write_zigzag(w, (int64_t)e->exact[i] - (int64_t)e->position[i] * (1 << ECO_EXACT_SHIFT));
}

static void write_list(struct eco_writer *w, const struct lod_list_draft *draft)
{
	const struct eco_elements *e = &draft->elements;
	const uint32_t counts[] = { draft->end_count, e->element_count, e->corner_count, e->primitive_count,
		e->extra_count };
	eco_list_write(w, &draft->list);
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		eco_write_u32(w, counts[i]);
	eco_write_u8(w, (uint8_t)((e->uv != NULL) | (e->exact != NULL) << 1));
	for (uint32_t i = 0; i < draft->end_count; i++)
		eco_write_varint(w, draft->ends[i] - (i ? draft->ends[i - 1] : 0));
	eco_write_bytes(w, e->corners, e->element_count);
	write_deltas(w, e->position, e->corner_count, 3);
	if (e->exact)
		write_exact(w, e);
	if (e->uv)
		write_deltas(w, e->uv, e->corner_count, 2);
	write_deltas(w, e->extra, e->element_count, e->extra_count);
}

void lod_plant_write(struct eco_writer *w, const struct lod_plant *plant)
{
	struct eco_plant nameless = plant->plant;
	const uint32_t counts[COUNTS] = { plant->plant.anchor_count, plant->ladder_count, plant->curve_count,
		plant->list_count, plant->palette_count, plant->image_count, plant->impostor_count };
	memset(nameless.name, 0, sizeof nameless.name);
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		eco_write_u32(w, counts[i]);
	eco_plant_write(w, &nameless);
	for (uint32_t i = 0; i < plant->plant.anchor_count; i++)
		eco_anchor_write(w, &plant->anchors[i]);
	for (uint32_t i = 0; i < plant->ladder_count; i++)
		eco_ladder_write(w, &plant->ladders[i]);
	for (uint32_t i = 0; i < plant->curve_count; i++)
		eco_curve_write(w, &plant->curves[i]);
	eco_write_bytes(w, plant->palette, 3 * (size_t)plant->palette_count);
	for (uint32_t i = 0; i < plant->image_count; i++)
		eco_write_u32(w, plant->images[i]);
	for (int i = 0; i < ECO_ORGAN_COUNT; i++) {
		eco_write_u32(w, plant->organ[i].components);
		eco_write_u32(w, plant->organ[i].elements);
		eco_write_u32(w, plant->organ[i].triangles);
		eco_write_f64(w, plant->organ[i].area);
	}
	eco_write_u32(w, plant->triangles_in);
	eco_write_u32(w, plant->triangles_stored);
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		eco_write_u32(w, plant->dropped[i]);
	for (int i = 0; i < LOD_SOLVER_COUNT; i++) {
		eco_write_u32(w, plant->solved[i].runs);
		eco_write_u32(w, plant->solved[i].converged);
	}
	for (uint32_t i = 0; i < plant->list_count; i++)
		write_list(w, &plant->lists[i]);
	for (uint32_t i = 0; i < plant->impostor_count; i++) {
		eco_write_varint(w, plant->impostor[i].size);
		eco_write_bytes(w, plant->impostor[i].at, plant->impostor[i].size);
	}
	if (plant->impostor_count)
		eco_write_u8(w, plant->impostor_level);
}

/* ---- Reading ---- */

/* Zeroed memory for records of at least `least` bytes each: no more records than the remaining bytes hold.
 * NULL with r->failed set, or without memory. */
static void *room(struct eco_reader *r, uint64_t count, size_t least, size_t size)
{
	if (r->failed || count > (r->size - r->at) / least) {
		r->failed = true;
		return NULL;
	}
	return calloc(count ? count : 1, size);
}

static bool read_deltas(struct eco_reader *r, int32_t *values, uint64_t rows, uint32_t stride)
{
	for (uint64_t i = 0; i < rows * stride; i++) {
		int64_t value = eco_read_zigzag(r), before = i < stride ? 0 : values[i - stride];
		if (r->failed || value < (int64_t)INT32_MIN - before || value > (int64_t)INT32_MAX - before)
			return false;
		values[i] = (int32_t)(before + value);
	}
	return true;
}

static bool read_exact(struct eco_reader *r, struct eco_elements *e)
{
	e->exact = room(r, 3ull * e->corner_count, 1, sizeof *e->exact);
	for (uint64_t i = 0; e->exact && i < 3ull * e->corner_count; i++) {
		int64_t value = eco_read_zigzag(r), most = 1 << ECO_EXACT_SHIFT;
		if (r->failed || value < -most || value > most || e->position[i] > ECO_ROWS_VALUE_MAX
				>> ECO_EXACT_SHIFT
		    || e->position[i] < -(ECO_ROWS_VALUE_MAX >> ECO_EXACT_SHIFT))
			return false;
		e->exact[i] = e->position[i] * (1 << ECO_EXACT_SHIFT) + (int32_t)value;
	}
	return e->exact;
}

static enum eco_code read_ends(struct lod_list_draft *draft, struct eco_reader *r, struct eco_error *error)
{
	uint64_t last = 0;
	draft->ends = room(r, draft->end_count, 1, sizeof *draft->ends);
	if (!draft->ends)
		return BAD("%u ends of chunks are not there", draft->end_count);
	for (uint32_t i = 0; i < draft->end_count; i++) {
		uint64_t step = eco_read_varint(r);
		if (r->failed || step == 0 || step > draft->elements.element_count - last)
			return BAD("end %u of %u does not ascend to %u", i, draft->end_count,
				draft->elements.element_count);
		draft->ends[i] = (uint32_t)(last += step);
	}
	/* paired lists end with their partners, and have no ends themselves */
	if (draft->end_count > 0 ? last != draft->elements.element_count : draft->list.partner == ECO_NONE
			&& draft->elements.element_count > 0)
		return BAD("chunks end at %llu of %u elements", (unsigned long long)last,
			draft->elements.element_count);
	return ECO_OK;
}

static enum eco_code read_corners(struct lod_list_draft *draft, struct eco_reader *r, struct eco_error *error)
{
	struct eco_elements *e = &draft->elements;
	uint64_t corners = 0, primitives = 0;
	e->corners = room(r, e->element_count, 1, 1);
	const uint8_t *from = e->corners ? eco_read_bytes(r, e->element_count) : NULL;
	for (uint32_t i = 0; i < e->element_count; i++) {
		if (!from || !eco_list_allows_corners(&draft->list, from[i]))
			return BAD("element %u has an impossible number of corners", i);
		corners += e->corners[i] = from[i];
		primitives += eco_corners_primitives(from[i]);
	}
	if (!e->corners || corners != e->corner_count || primitives != e->primitive_count)
		return BAD("elements have %llu corners and %llu primitives, not %u and %u",
			(unsigned long long)corners, (unsigned long long)primitives, e->corner_count,
			e->primitive_count);
	return ECO_OK;
}

static enum eco_code read_values(struct lod_list_draft *draft, bool has_uv, bool has_exact,
	struct eco_reader *r, struct eco_error *error)
{
	struct eco_elements *e = &draft->elements;
	uint64_t extras = (uint64_t)e->element_count * e->extra_count;
	e->position = room(r, 3ull * e->corner_count, 1, sizeof *e->position);
	if (!e->position || !read_deltas(r, e->position, e->corner_count, 3))
		return BAD("positions are not there or too large");
	if (has_exact && !read_exact(r, e))
		return BAD("exact positions are not there or not near");
	e->uv = has_uv ? room(r, 2ull * e->corner_count, 1, sizeof *e->uv) : NULL;
	if (has_uv && (!e->uv || !read_deltas(r, e->uv, e->corner_count, 2)))
		return BAD("texture coordinates are not there or too large");
	e->extra = e->extra_count ? room(r, extras, 1, sizeof *e->extra) : NULL;
	if (e->extra_count && (!e->extra || !read_deltas(r, e->extra, e->element_count, e->extra_count)))
		return BAD("attributes are not there or too large");
	return ECO_OK;
}

static enum eco_code check_colors(const struct lod_plant *plant, const struct lod_list_draft *draft,
	struct eco_error *error)
{
	const struct eco_list *list = &draft->list;
	const struct eco_elements *e = &draft->elements;
	if (list->palette_first > plant->palette_count || list->palette_count > plant->palette_count
			- list->palette_first)
		return BAD("colours [%u, +%u) of %u", list->palette_first, list->palette_count,
			plant->palette_count);
	if (list->attributes & ECO_ATTR_COLOR)
		for (uint32_t i = 0; i < e->element_count; i++)
			if ((uint32_t)e->extra[(size_t)i * e->extra_count] >= list->palette_count)
				return BAD("element %u has colour %d of %u", i,
					e->extra[(size_t)i * e->extra_count], list->palette_count);
	return ECO_OK;
}

static enum eco_code read_list(struct lod_plant *plant, struct lod_list_draft *draft, struct eco_reader *r,
	struct eco_error *error)
{
	struct eco_elements *e = &draft->elements;
	eco_list_read(r, &draft->list);
	uint32_t *const counts[] = { &draft->end_count, &e->element_count, &e->corner_count,
		&e->primitive_count, &e->extra_count };
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		*counts[i] = eco_read_u32(r);
	uint8_t has = eco_read_u8(r), has_uv = has & 1, has_exact = has >> 1;
	if (r->failed || has_exact > 1 || (has_exact && draft->list.kind != ECO_LIST_TRIANGLES)
			|| e->extra_count != eco_list_extra_count(&draft->list)
	    || has_uv != ((draft->list.attributes & ECO_ATTR_UV) != 0))
		return BAD("attributes do not fit the list");
	if (draft->list.kind > ECO_LIST_POINTS || (draft->list.attributes & ECO_ATTR_PLANT)
			|| eco_list_check_coding(&draft->list, error) != ECO_OK)
		return BAD("a list of kind %u", draft->list.kind);
	if (draft->list.image != ECO_NONE && draft->list.image >= plant->image_count)
		return BAD("image %u of %u", draft->list.image, plant->image_count);
	enum eco_code code = read_ends(draft, r, error);
	if (!code)
		code = read_corners(draft, r, error);
	if (!code)
		code = read_values(draft, has_uv, has_exact, r, error);
	return code ? code : check_colors(plant, draft, error);
}

/* Partners have no partners themselves, so that packing them first is enough. */
static enum eco_code check_partners(const struct lod_plant *plant, struct eco_error *error)
{
	for (uint32_t i = 0; i < plant->list_count; i++) {
		uint32_t partner = plant->lists[i].list.partner;
		if (partner != ECO_NONE
				&& (partner >= plant->list_count || plant->lists[partner].list.partner
				!= ECO_NONE))
			return BAD("list %u: its partner %u of %u has a partner itself, or is not there", i,
				partner, plant->list_count);
	}
	return ECO_OK;
}

static bool names_list(const struct lod_plant *plant, uint32_t list, uint8_t kind)
{
	return list == ECO_NONE || (list < plant->list_count && plant->lists[list].list.kind == kind);
}

static enum eco_code check_ladder(const struct lod_plant *plant, const struct eco_ladder *l,
	struct eco_error *error)
{
	if (l->plant != 0 || l->anchor >= plant->plant.anchor_count || l->organ >= ECO_ORGAN_COUNT
			|| l->level_count > ECO_LEVELS_MAX)
		return BAD("a ladder of plant %u, anchor %u, organ %u with %u levels", l->plant, l->anchor,
			l->organ, l->level_count);
	if (!names_list(plant, l->points, ECO_LIST_POINTS) || !names_list(plant, l->lines, ECO_LIST_LINES)
	    || !names_list(plant, l->simple, ECO_LIST_TRIANGLES)
	|| !names_list(plant, l->triangles, ECO_LIST_TRIANGLES))
		return BAD("a ladder of lists that are not there or of another kind");
	if (l->impostor != ECO_NONE && (l->impostor != plant->list_count || !plant->impostor_count
			|| l->curve_count < plant->impostor_count))
		return BAD("a ladder of an impostor that is not there, or without its samples");
	bool splats = l->points != ECO_NONE && (plant->lists[l->points].list.attributes & ECO_ATTR_SPLAT);
	uint32_t levels = splats ? l->points : l->triangles;
	if (l->level_count > 0
			&& (levels == ECO_NONE || l->level_end[l->level_count - 1]
			> plant->lists[levels].elements.primitive_count))
		return BAD("a ladder's levels end beyond their list");
	if (l->curve_first > plant->curve_count || l->curve_count > plant->curve_count
	    || eco_ladder_samples(l) > plant->curve_count - l->curve_first)
		return BAD("curve [%u, +%u) of %u", l->curve_first, l->curve_count, plant->curve_count);
	return ECO_OK;
}

static enum eco_code check_tables(const struct lod_plant *plant, const uint32_t counts[COUNTS],
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	if (plant->plant.anchor_count != counts[0] || counts[0] == 0 || plant->plant.ladder_count
			!= plant->ladder_count
	    || plant->plant.name[0] != 0)
		return BAD("%u anchors and %u ladders are not those of its record", counts[0],
			plant->ladder_count);
	for (uint32_t i = 0; i < counts[0] && !code; i++)
		code = eco_anchor_check(&plant->anchors[i], error);
	for (uint32_t i = 0; i < plant->ladder_count && !code; i++)
		code = check_ladder(plant, &plant->ladders[i], error);
	return code ? code : check_partners(plant, error);
}

/* Reads the tables before the lists; false if memory or bytes do not suffice. */
static bool read_tables(struct lod_plant *plant, struct eco_reader *r, const uint32_t counts[COUNTS])
{
	eco_plant_read(r, &plant->plant);
	plant->anchors = room(r, counts[0], eco_section_info[ECO_SECTION_ANCHORS].record_bytes,
		sizeof *plant->anchors);
	for (uint32_t i = 0; plant->anchors && i < counts[0]; i++)
		eco_anchor_read(r, &plant->anchors[i]);
	plant->ladders = room(r, counts[1], eco_section_info[ECO_SECTION_LADDERS].record_bytes,
		sizeof *plant->ladders);
	for (uint32_t i = 0; plant->ladders && i < counts[1]; i++)
		eco_ladder_read(r, &plant->ladders[i]);
	plant->ladder_count = plant->ladders ? counts[1] : 0;
	plant->curves = room(r, counts[2], eco_section_info[ECO_SECTION_CURVES].record_bytes,
		sizeof *plant->curves);
	for (uint32_t i = 0; plant->curves && i < counts[2]; i++)
		eco_curve_read(r, &plant->curves[i]);
	plant->curve_count = plant->curves ? counts[2] : 0;
	plant->palette = room(r, counts[4], 3, 3);
	const uint8_t *colors = plant->palette ? eco_read_bytes(r, 3 * (size_t)counts[4]) : NULL;
	if (colors)
		memcpy(plant->palette, colors, 3 * (size_t)counts[4]);
	plant->palette_count = colors ? counts[4] : 0;
	plant->images = room(r, counts[5], sizeof(uint32_t), sizeof(uint32_t));
	for (uint32_t i = 0; plant->images && i < counts[5]; i++)
		plant->images[i] = eco_read_u32(r);
	plant->image_count = plant->images ? counts[5] : 0;
	for (int i = 0; i < ECO_ORGAN_COUNT; i++) {
		plant->organ[i].components = eco_read_u32(r);
		plant->organ[i].elements = eco_read_u32(r);
		plant->organ[i].triangles = eco_read_u32(r);
		plant->organ[i].area = eco_read_f64(r);
	}
	plant->triangles_in = eco_read_u32(r);
	plant->triangles_stored = eco_read_u32(r);
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		plant->dropped[i] = eco_read_u32(r);
	for (int i = 0; i < LOD_SOLVER_COUNT; i++) {
		plant->solved[i].runs = eco_read_u32(r);
		plant->solved[i].converged = eco_read_u32(r);
	}
	plant->lists = room(r, counts[3], eco_section_info[ECO_SECTION_LISTS].record_bytes,
		sizeof *plant->lists);
	plant->list_count = plant->lists ? counts[3] : 0;
	return plant->anchors && plant->ladders && plant->curves && plant->palette && plant->images
		&& plant->lists && !r->failed;
}

static enum eco_code read_impostor(struct lod_plant *plant, uint32_t count, struct eco_reader *r,
	struct eco_error *error)
{
	plant->impostor = count <= ECO_IMPOSTOR_LEVELS ? calloc(count + 1u, sizeof *plant->impostor) : NULL;
	if (!plant->impostor)
		return BAD("%u levels of an impostor", count);
	for (uint32_t i = 0; i < count; i++) {
		uint64_t size = eco_read_varint(r);
		const uint8_t *bytes = size <= r->size - r->at ? eco_read_bytes(r, (size_t)size) : NULL;
		struct eco_bytes *to = &plant->impostor[i];
		if (r->failed || !bytes || !(to->at = malloc((size_t)size + 1)))
			return BAD("level %u of an impostor is cut off", i);
		plant->impostor_count++;
		to->size = (size_t)size;
		memcpy(to->at, bytes, to->size);
	}
	plant->impostor_level = count ? eco_read_u8(r) : 0;
	return ECO_OK;
}

/* Decodes the levels, which takes longer than all else: after it. */
static enum eco_code check_impostor(const struct lod_plant *plant, struct eco_error *error)
{
	struct eco_impostor_body body;
	struct eco_impostor_level level;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < plant->impostor_count && !code; i++) {
		code = eco_impostor_level_read(&level, &body, plant->impostor[i].at, plant->impostor[i].size,
			error);
		if (!code && level.level != i)
			code = BAD("level %u of an impostor is level %u", i, level.level);
		eco_impostor_level_free(&level);
	}
	return code;
}

enum eco_code lod_plant_read(struct lod_plant *plant, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_reader r = { bytes, size, 0, false };
	uint32_t counts[COUNTS];
	enum eco_code code = ECO_OK;
	*plant = (struct lod_plant){ 0 };
	for (int i = 0; i < COUNTS; i++)
		counts[i] = eco_read_u32(&r);
	if (!read_tables(plant, &r, counts))
		code = BAD("a plant's tables are cut off");
	for (uint32_t i = 0; i < plant->list_count && !code; i++)
		code = read_list(plant, &plant->lists[i], &r, error);
	if (!code)
		code = read_impostor(plant, counts[6], &r, error);
	if (!code && (r.failed || r.at != r.size))
		code = BAD("%zu bytes after a plant's end", r.size - r.at);
	if (!code)
		code = check_tables(plant, counts, error);
	if (!code)
		code = check_impostor(plant, error);
	if (code)
		lod_plant_free(plant);
	return code ? ECO_DAMAGED : ECO_OK;
}
