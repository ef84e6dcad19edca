#include "client-min/view_list.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define SHOWN_BYTES 4u           /* of a texel of the image that a part may be shown in */

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

/* ---- Life ---- */

static size_t palette_bytes(const struct eco_list *list)
{
	return (size_t)list->palette_count * 3;
}

static size_t group_bytes(const struct eco_list *list)
{
	return list->group_count * sizeof(struct eco_group);
}

uint64_t view_list_bytes(const struct eco_list *list)
{
	return sizeof(struct view_list) + palette_bytes(list) + group_bytes(list)
		+ (uint64_t)list->chunk_count * sizeof(struct view_mark);
}

struct view_list *view_list_new(uint32_t id, const struct eco_list *record, const uint8_t (*palette)[3],
	const struct eco_group *groups)
{
	struct view_list *list = calloc(1, sizeof *list);
	if (!list)
		return NULL;
	list->id = id;
	list->list = *record;
	list->bytes = view_list_bytes(record);
	list->palette = malloc(palette_bytes(record) + 1);
	list->groups = malloc(group_bytes(record) + 1);
	list->marks = calloc((size_t)record->chunk_count + 1, sizeof *list->marks);
	if (!list->palette || !list->groups || !list->marks) {
		view_list_free(list);
		return NULL;
	}
	if (palette_bytes(record))
		memcpy(list->palette, palette, palette_bytes(record));
	if (record->group_count)
		memcpy(list->groups, groups, group_bytes(record));
	return list;
}

void view_list_free(struct view_list *list)
{
	if (!list)
		return;
	eco_elements_free(&list->elements);
	eco_image_free(&list->image);
	for (uint32_t i = 0; list->parts && i < list->list.primitive_count; i++)
		eco_texture_part_free(&list->parts[i]);
	free(list->parts);
	for (uint32_t i = 0; list->impostors && i < list->chunk_count; i++)
		lod_impostor_close(&list->impostors[i]);
	eco_free(list->impostors, list->marks, list->palette, list->groups, list);
}

static bool is_texture(const struct view_list *list)
{
	return eco_list_has_texels(&list->list);
}

/* ---- Decoding ---- */

static size_t element_bytes(const struct eco_elements *e) { return 1 + (size_t)e->extra_count * 4; }
static size_t corner_bytes(const struct eco_elements *e) { return 12 + (e->uv ? 8 : 0); }

static enum eco_code decode_image(struct view_piece *piece, const struct view_piece_input *in,
	struct eco_error *error)
{
	struct eco_error cause = { 0 };
	piece->bytes = sizeof piece->part;
	if (!in->images)
		return ECO_OK;
	enum eco_code code = eco_texture_read(&piece->part, in->list->list.kind, in->payload,
		in->chunk->size_bytes, &cause);
	if (code)
		return eco_fail(error, code, "list %u, chunk %u: %s", in->list->id, in->ordinal, cause.text);
	piece->bytes += (uint64_t)piece->part.width * piece->part.height
		* (piece->part.channels + SHOWN_BYTES);
	return ECO_OK;
}

/* A payload is the level with its chunk's ordinal. */
static enum eco_code decode_impostor(struct view_piece *piece, const struct view_piece_input *in,
	struct eco_error *error)
{
	struct eco_error cause = { 0 };
	struct eco_impostor_body body;
	struct eco_impostor_level level;
	enum eco_code code = eco_impostor_level_read(&level, &body, in->payload, in->chunk->size_bytes,
		&cause);
	if (!code && level.level != in->ordinal)
		code = eco_fail(&cause, ECO_DAMAGED, "level %u of an impostor", level.level);
	if (!code)
		code = lod_impostor_open(&piece->impostor, &body, &level, &cause);
	eco_impostor_level_free(&level);
	if (code)
		return eco_fail(error, code, "list %u, chunk %u: %s", in->list->id, in->ordinal, cause.text);
	piece->bytes = sizeof piece->impostor + lod_impostor_bytes(&piece->impostor);
	return ECO_OK;
}

/* Ground is one chunk, every sample in its place: drawing needs no checks of its own. */
static enum eco_code check_ground(struct view_piece *piece, const struct view_piece_input *in,
	struct eco_error *error)
{
	struct eco_error cause = { 0 };
	enum eco_code code = eco_ground_tile_of(&piece->tile, &in->list->list, &piece->elements,
		in->scene->ground_columns, in->scene->ground_rows, in->scene->ground_margin, &cause);
	return code ? eco_fail(error, code, "list %u: %s", in->list->id, cause.text) : ECO_OK;
}

static enum eco_code decode_elements(struct view_piece *piece, const struct view_piece_input *in,
	struct eco_error *error)
{
	struct eco_elements *e = &piece->elements;
	enum eco_code code = eco_chunk_decode(&in->list->list, in->chunk, in->ordinal, in->payload,
		in->chunk->size_bytes, e, error);
	const char *fault = code ? NULL : eco_elements_fault(e, &in->list->list, in->scene->plant_count);
	if (fault)
		code = BAD("list %u, chunk %u: it %s", in->list->id, in->ordinal, fault);
	if (!code && in->list->list.kind == ECO_LIST_GROUND)
		code = check_ground(piece, in, error);
	if (code)
		return code;
	piece->bytes = (uint64_t)e->element_count * element_bytes(e) + (uint64_t)e->corner_count
		* corner_bytes(e);
	return ECO_OK;
}

enum eco_code view_piece_decode(struct view_piece *piece, const struct view_piece_input *in,
	struct eco_error *error)
{
	*piece = (struct view_piece){ 0 };
	enum eco_code code = is_texture(in->list) ? decode_image(piece, in, error)
		: in->list->list.kind == ECO_LIST_IMPOSTOR ? decode_impostor(piece, in, error)
		: decode_elements(piece, in, error);
	if (!code && piece->bytes > UINT32_MAX)
		code = eco_fail(error, ECO_TOO_LARGE, "list %u, chunk %u: %llu bytes decoded", in->list->id,
			in->ordinal, (unsigned long long)piece->bytes);
	if (code)
		view_piece_free(piece);
	return code;
}

void view_piece_free(struct view_piece *piece)
{
	eco_elements_free(&piece->elements);
	eco_texture_part_free(&piece->part);
	lod_impostor_close(&piece->impostor);
	*piece = (struct view_piece){ 0 };
}

/* ---- Growing ---- */

static bool resize(void *array, size_t room, size_t item)
{
	void **slot = array;
	void *moved = realloc(*slot, room * item + 1);
	if (moved)
		*slot = moved;
	return moved;
}

static bool is_element_list(const struct view_list *list)
{
	return !is_texture(list) && list->list.kind != ECO_LIST_IMPOSTOR;
}

/* `like` has uv if the list's elements have. */
static bool resize_elements(struct eco_elements *e, const struct eco_elements *like, size_t elements,
	size_t corners)
{
	return resize(&e->corners, elements, 1) && resize(&e->position, corners, 12)
		&& (!like->uv || resize(&e->uv, corners, 8))
		&& (!like->extra_count || resize(&e->extra, elements, (size_t)like->extra_count * 4));
}

static enum eco_code push_elements(struct view_list *list, const struct eco_elements *more,
	struct eco_error *error)
{
	struct eco_elements *e = &list->elements;
	size_t elements = (size_t)e->element_count + more->element_count,
		corners = (size_t)e->corner_count + more->corner_count;
	if (corners > UINT32_MAX / 2)
		return eco_fail(error, ECO_TOO_LARGE, "list %u has more than %u corners", list->id,
			UINT32_MAX / 2);
	e->extra_count = more->extra_count;
	if (!resize_elements(e, more, elements, corners))
		return eco_no_memory(error, "decoded elements");
	memcpy(e->corners + e->element_count, more->corners, more->element_count);
	memcpy(e->position + 3 * (size_t)e->corner_count, more->position, 12 * (size_t)more->corner_count);
	if (more->uv)
		memcpy(e->uv + 2 * (size_t)e->corner_count, more->uv, 8 * (size_t)more->corner_count);
	if (more->extra_count)
		memcpy(e->extra + (size_t)e->element_count * more->extra_count, more->extra,
			(size_t)more->element_count * more->extra_count * 4);
	e->element_count = (uint32_t)elements;
	e->corner_count = (uint32_t)corners;
	e->primitive_count += more->primitive_count;
	return ECO_OK;
}

/* A level of an impostor, which the list takes over. */
static enum eco_code push_impostor(struct view_list *list, struct view_piece *piece, struct eco_error *error)
{
	if (!resize(&list->impostors, list->chunk_count + (size_t)1, sizeof *list->impostors))
		return eco_no_memory(error, "an impostor");
	list->impostors[list->chunk_count] = piece->impostor;
	piece->impostor = (struct lod_impostor){ 0 };
	return ECO_OK;
}

/* Levels of a texture that are whole; the strip of a chunk behind them is of that level. */
static uint32_t levels_of(const struct view_list *list, uint32_t chunks)
{
	return view_list_before(list, chunks).primitives;
}

static enum eco_code push_strip(struct view_list *list, const struct view_piece *piece, struct eco_error *error)
{
	uint32_t level = levels_of(list, list->chunk_count);
	if (!list->parts)
		list->parts = calloc(list->list.primitive_count, sizeof *list->parts);
	if (!list->parts)
		return eco_no_memory(error, "a texture");
	return level < list->list.primitive_count ? eco_texture_part_add(&list->parts[level], &piece->part, error)
		: BAD("list %u: a strip follows its last level", list->id);
}

static void hide_image(struct view_list *list)
{
	eco_image_free(&list->image);
	memset(list->shown, 0, sizeof list->shown);
	list->cutout = false;
}

enum eco_code view_list_show(struct view_list *list, uint32_t levels, const struct view_list *outline,
	uint32_t outline_levels, struct eco_error *error)
{
	if (list->image.rgba && list->shown[0] == levels && list->shown[1] == outline_levels)
		return ECO_OK;
	hide_image(list);
	if (!levels || levels > levels_of(list, list->chunk_count) || !list->parts[levels - 1].height
			|| (outline && (!outline_levels || outline_levels > levels_of(outline, outline->chunk_count))))
		return ECO_OK;
	ECO_PASS(eco_texture_show(&list->image, &list->parts[levels - 1],
		outline ? &outline->parts[outline_levels - 1] : NULL, error));
	list->shown[0] = levels;
	list->shown[1] = outline_levels;
	for (size_t i = 0; i < (size_t)list->image.width * list->image.height && !list->cutout; i++)
		list->cutout = list->image.rgba[4 * i + 3] < 128;
	return ECO_OK;
}

struct view_mark view_list_before(const struct view_list *list, uint32_t ordinal)
{
	return ordinal ? list->marks[ordinal - 1] : (struct view_mark){ 0 };
}

void view_list_mark(struct view_list *list, uint32_t ordinal, const struct eco_chunk *chunk, uint64_t bytes)
{
	struct view_mark before = view_list_before(list, ordinal);
	list->marks[ordinal] = (struct view_mark){ before.primitives + chunk->primitive_count,
		before.elements + chunk->element_count, list->elements.corner_count, 0, (uint32_t)bytes, 0 };
}

enum eco_code view_list_push(struct view_list *list, struct view_piece *piece, const struct eco_chunk *chunk,
	struct eco_error *error)
{
	ECO_PASS(is_element_list(list) ? push_elements(list, &piece->elements, error)
		: is_texture(list) ? push_strip(list, piece, error) : push_impostor(list, piece, error));
	if (list->list.kind == ECO_LIST_GROUND)
		list->tile = piece->tile;
	list->bytes += piece->bytes;
	view_list_mark(list, list->chunk_count++, chunk, piece->bytes);
	list->marks[list->chunk_count - 1].rows = piece->part.height;
	return ECO_OK;
}

/* ---- Shrinking ---- */

/* An array that the system will not make smaller stays as large as it is, which does no harm. */
static void pop_elements(struct view_list *list, struct view_mark before)
{
	struct eco_elements *e = &list->elements;
	e->element_count = before.elements;
	e->corner_count = before.corners;
	e->primitive_count = before.primitives;
	if (e->element_count)
		resize_elements(e, e, e->element_count, e->corner_count);
	else
		eco_elements_free(e);
}

void view_list_pop(struct view_list *list)
{
	assert(list->chunk_count > 0);
	uint32_t last = --list->chunk_count;
	list->bytes -= list->marks[last].bytes;
	if (is_element_list(list)) {
		pop_elements(list, view_list_before(list, last));
	} else if (is_texture(list)) {
		struct eco_texture_part *part = &list->parts[levels_of(list, last)];
		part->height -= list->marks[last].rows;
		if (part->height)
			resize(&part->texels, part->height, (size_t)part->width * part->channels);
		else
			eco_texture_part_free(part);
		if (list->shown[0] > levels_of(list, last))
			hide_image(list);
	} else {
		lod_impostor_close(&list->impostors[last]);
		resize(&list->impostors, last, sizeof *list->impostors);
	}
}

struct eco_elements view_list_chunks(const struct view_list *list, uint32_t first, uint32_t end)
{
	assert(first <= end && end <= list->chunk_count);
	struct view_mark a = view_list_before(list, first), b = view_list_before(list, end);
	const struct eco_elements *e = &list->elements;
	return (struct eco_elements){
		.element_count = b.elements - a.elements, .corner_count = b.corners - a.corners,
		.primitive_count = b.primitives - a.primitives, .extra_count = e->extra_count,
		.corners = e->corners + a.elements, .position = e->position + 3 * (size_t)a.corners,
		.uv = e->uv ? e->uv + 2 * (size_t)a.corners : NULL,
		.extra = e->extra ? e->extra + (size_t)a.elements * e->extra_count : NULL,
	};
}
