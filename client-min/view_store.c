/* Decoded lists grow by whole chunks at their end and never move their meaning: primitive i stays primitive
 * i. So a plan of any later frame is a set of ranges over what is here, GPU copies are extended and never
 * rewritten, and what the client holds is one number per list. Longer than 600 lines, as all of it keeps
 * the invariants of one object. */
#include "client-min/view_store.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "client-min/view_table.h"
#include "ecofiles/format/chunk.h"
#include "ecofiles/format/image.h"
#include "ecofiles/base/room.h"

#define FORMS_MAX 8u                     /* of one list: each of its chunks is compared with each */
#define MEMORY_MAX_DEFAULT ((uint64_t)8 << 30)

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

struct view_store {
	struct view_store_options options;
	struct view_store_stats stats;
	char name[64];
	struct eco_chunk_id pack;
	bool has_scene, has_plan, complete;
	double near_m;
	uint32_t ground_columns, ground_rows;
	struct view_list **lists;        uint32_t list_count, list_room;
	struct view_plant **plants;      uint32_t plant_count, plant_room;
	struct view_table list_table, plant_table;
	/* list with other forms -> index of one of them; the others by view_list.next_form */
	struct view_table form_table;
	struct eco_plan plan;
};

double view_clock_ms(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

enum eco_code view_store_new(struct view_store **out, const struct view_store_options *options,
	struct eco_error *error)
{
	struct view_store *store = calloc(1, sizeof *store);
	*out = store;
	if (!store)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the client's store");
	store->options = *options;
	if (!store->options.memory_max)
		store->options.memory_max = MEMORY_MAX_DEFAULT;
	return ECO_OK;
}

static void list_free(struct view_list *list)
{
	eco_elements_free(&list->elements);
	eco_image_free(&list->image);
	for (uint32_t i = 0; list->impostors && i < list->chunk_count; i++)
		lod_impostor_close(&list->impostors[i]);
	free(list->impostors);
	free(list->marks);
	free(list->palette);
	free(list);
}

void view_store_free(struct view_store *store)
{
	if (!store)
		return;
	for (uint32_t i = 0; i < store->list_count; i++)
		list_free(store->lists[i]);
	for (uint32_t i = 0; i < store->plant_count; i++) {
		free(store->plants[i]->anchors);
		free(store->plants[i]);
	}
	view_table_free(&store->list_table);
	view_table_free(&store->plant_table);
	view_table_free(&store->form_table);
	eco_plan_free(&store->plan);
	free(store->lists);
	free(store->plants);
	free(store);
}

void view_store_begin(struct view_store *store)
{
	eco_plan_free(&store->plan);
	store->plan = (struct eco_plan){ 0 };
	store->has_plan = store->complete = false;
	store->stats.decode_ms = 0;
}

static enum eco_code no_memory(struct eco_error *error, const char *what)
{
	return eco_fail(error, ECO_NO_MEMORY, "no memory for %s", what);
}

/* Reserves `bytes` of the store's allowance. */
static enum eco_code account(struct view_store *store, uint64_t bytes, struct eco_error *error)
{
	if (bytes > store->options.memory_max - store->stats.memory_bytes)
		return eco_fail(error, ECO_TOO_LARGE, "what the scene's view needs exceeds %.1f GiB of "
			"decoded data: ask for fewer vertices",
			(double)store->options.memory_max / (1 << 30));
	store->stats.memory_bytes += bytes;
	return ECO_OK;
}

/* ---- Events ---- */

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *pack,
	struct eco_error *error)
{
	struct view_store *store = ctx;
	if (store->has_scene && memcmp(&store->pack, pack, sizeof *pack) != 0)
		return BAD("the scene changed on the server since the first frame: start again");
	if (!(scene->near_m > 0))
		return BAD("the scene's near plane is not positive");
	store->has_scene = true;
	store->pack = *pack;
	store->near_m = scene->near_m;
	store->ground_columns = scene->ground_columns;
	store->ground_rows = scene->ground_rows;
	memcpy(store->name, scene->name, sizeof store->name);
	store->name[sizeof store->name - 1] = '\0';
	return ECO_OK;
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, struct eco_error *error)
{
	struct view_store *store = ctx;
	const struct view_plant *held = view_store_plant(store, id);
	if (held) {
		if (held->plant.anchor_first != plant->anchor_first || held->plant.anchor_count
				!= plant->anchor_count ||
			memcmp(held->anchors, anchors, plant->anchor_count * sizeof *anchors) != 0)
			return BAD("plant %u was described twice, and differently", id);
		return ECO_OK;
	}
	if (plant->anchor_count == 0 || plant->anchor_first > UINT32_MAX - plant->anchor_count)
		return BAD("plant %u has no anchors, or too many", id);
	size_t anchor_bytes = (size_t)plant->anchor_count * sizeof *anchors;
	enum eco_code code = account(store, sizeof *held + anchor_bytes, error);
	if (code)
		return code;
	struct view_plant *copy = calloc(1, sizeof *copy);
	if (!copy)
		return no_memory(error, "a plant");
	copy->plant = *plant;
	copy->anchors = malloc(anchor_bytes);
	if (!copy->anchors || !eco_room(&store->plants, &store->plant_room, store->plant_count,
			sizeof *store->plants) ||
		!view_table_put(&store->plant_table, id, store->plant_count)) {
		free(copy->anchors);
		free(copy);
		return no_memory(error, "a plant");
	}
	memcpy(copy->anchors, anchors, anchor_bytes);
	store->plants[store->plant_count++] = copy;
	return ECO_OK;
}

static bool same_record(const struct eco_list *a, const struct eco_list *b)
{
	struct eco_writer wa = { 0 }, wb = { 0 };
	eco_list_write(&wa, a);
	eco_list_write(&wb, b);
	bool same = !wa.failed && !wb.failed && wa.size == wb.size && memcmp(wa.bytes, wb.bytes, wa.size)
		== 0;
	eco_writer_free(&wa);
	eco_writer_free(&wb);
	return same;
}

/* ---- Forms: element i of one list is element i of the other, whichever comes first ---- */

/* As both are described. */
static enum eco_code check_form(const struct view_list *form, const struct view_list *of,
	struct eco_error *error)
{
	if (of->list.kind != ECO_LIST_TRIANGLES || of->list.coder != ECO_CODER_ELEMENTS)
		return BAD("list %u is a form of list %u, which is not one of fans", form->id, of->id);
	if (form->list.chunk_count != of->list.chunk_count || form->list.element_count
			!= of->list.element_count)
		return BAD("list %u is a form of list %u: %u elements in %u chunks "
			"for %u in %u", form->id, of->id, form->list.element_count, form->list.chunk_count,
			of->list.element_count, of->list.chunk_count);
	return ECO_OK;
}

/* Up to the end of a chunk, of which one is held and one (`list`) is about to be. */
static enum eco_code check_form_chunk(const struct view_list *list, uint32_t ordinal, uint32_t elements,
	const struct view_list *other, struct eco_error *error)
{
	if (ordinal < other->chunk_count && elements != other->marks[ordinal].elements)
		return BAD("chunk %u of list %u ends at element %u, that of list %u at %u: they are forms of "
			"the same", ordinal, list->id, elements, other->id, other->marks[ordinal].elements);
	return ECO_OK;
}

static const struct view_list *form_of(const struct view_store *store, const struct view_list *list)
{
	return list->list.coder == ECO_CODER_FORM ? view_store_list(store, list->list.partner) : NULL;
}

static enum eco_code check_form_chunks(const struct view_store *store, const struct view_list *list,
	uint32_t ordinal, uint32_t elements, struct eco_error *error)
{
	const struct view_list *of = form_of(store, list);
	enum eco_code code = of ? check_form_chunk(list, ordinal, elements, of, error) : ECO_OK;
	for (uint32_t i = view_table_get(&store->form_table, list->id); i < store->list_count && !code;
			i = store->lists[i]->next_form)
		code = check_form_chunk(list, ordinal, elements, store->lists[i], error);
	return code;
}

/* Checks a list that is about to be the `index`-th against those that it is a form of, or that are forms of
 * it. */
static enum eco_code bind_forms(struct view_store *store, struct view_list *list, uint32_t index,
	struct eco_error *error)
{
	const struct view_list *of = form_of(store, list);
	enum eco_code code = of ? check_form(list, of, error) : ECO_OK;
	uint32_t first = view_table_get(&store->form_table, list->list.partner), count = 0;
	for (uint32_t i = view_table_get(&store->form_table, list->id); i < store->list_count && !code;
			i = store->lists[i]->next_form)
		code = check_form(store->lists[i], list, error);
	list->next_form = UINT32_MAX;
	if (code || list->list.coder != ECO_CODER_FORM)
		return code;
	for (uint32_t i = first; i < store->list_count; i = store->lists[i]->next_form)
		count++;
	if (count == FORMS_MAX)
		return BAD("list %u has more than %u forms", list->list.partner, FORMS_MAX);
	list->next_form = first;
	return view_table_put(&store->form_table, list->list.partner, index) ? ECO_OK
		: no_memory(error, "a list");
}

static enum eco_code on_list(void *ctx, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	struct eco_error *error)
{
	struct view_store *store = ctx;
	const struct view_list *held = view_store_list(store, id);
	size_t palette_bytes = (size_t)list->palette_count * sizeof *palette;
	if (held) {
		if (!same_record(&held->list, list)
				|| (palette_bytes && memcmp(held->palette, palette, palette_bytes) != 0))
			return BAD("list %u was described twice, and differently", id);
		return ECO_OK;
	}
	enum eco_code code = account(store,
		sizeof *held + palette_bytes + (uint64_t)list->chunk_count * sizeof *held->marks, error);
	if (code)
		return code;
	struct view_list *copy = calloc(1, sizeof *copy);
	if (!copy)
		return no_memory(error, "a list");
	copy->id = id;
	copy->list = *list;
	copy->palette = malloc(palette_bytes ? palette_bytes : 1);
	copy->marks = calloc(list->chunk_count ? list->chunk_count : 1, sizeof *copy->marks);
	if (!copy->palette || !copy->marks || !eco_room(&store->lists, &store->list_room, store->list_count,
			sizeof *store->lists))
		code = no_memory(error, "a list");
	if (!code)
		code = bind_forms(store, copy, store->list_count, error);
	if (!code && !view_table_put(&store->list_table, id, store->list_count))
		code = no_memory(error, "a list");
	if (code) {
		list_free(copy);
		return code;
	}
	if (palette_bytes)
		memcpy(copy->palette, palette, palette_bytes);
	store->lists[store->list_count++] = copy;
	return ECO_OK;
}

static bool grow_array(void *array, size_t room, size_t item)
{
	void **slot = array;
	void *moved = realloc(*slot, room * item + 1);
	if (moved)
		*slot = moved;
	return moved;
}

/* Room for `elements` and `corners` in all: doubled, but never beyond what the list's record declares (three
 * to six corners). */
static enum eco_code list_reserve(struct view_store *store, struct view_list *list,
	const struct eco_elements *more, struct eco_error *error)
{
	struct eco_elements *e = &list->elements;
	uint64_t elements = (uint64_t)e->element_count + more->element_count,
		corners = (uint64_t)e->corner_count + more->corner_count;
	if (corners > UINT32_MAX / 2)
		return eco_fail(error, ECO_TOO_LARGE, "list %u has more than %u corners", list->id,
			UINT32_MAX / 2);
	uint64_t element_room = list->element_room, corner_room = list->corner_room;
	if (elements > element_room)
		element_room = elements + elements / 2 < list->list.element_count ? elements + elements / 2
			: list->list.element_count;
	if (corners > corner_room) {
		uint64_t most = (uint64_t)list->list.element_count * ECO_CORNERS_MAX;
		corner_room = corners + corners / 2 < most ? corners + corners / 2 : most;
	}
	size_t element_bytes = 1 + (size_t)e->extra_count * 4, corner_bytes = 12 + (more->uv ? 8 : 0);
	enum eco_code code = account(store, (element_room - list->element_room) * element_bytes +
		(corner_room - list->corner_room) * corner_bytes, error);
	if (code)
		return code;
	if (!grow_array(&e->corners, element_room, 1) || !grow_array(&e->position, corner_room, 12) ||
		(more->uv && !grow_array(&e->uv, corner_room, 8)) ||
		(e->extra_count && !grow_array(&e->extra, element_room, (size_t)e->extra_count * 4)))
		return no_memory(error, "decoded elements");
	list->element_room = (uint32_t)element_room;
	list->corner_room = (uint32_t)corner_room;
	return ECO_OK;
}

static enum eco_code check_codes(const struct view_list *list, const struct eco_elements *more,
	enum eco_attr attribute, uint32_t codes, struct eco_error *error)
{
	const int32_t *extra = more->extra;
	if (!(list->list.attributes & attribute))
		return ECO_OK;
	for (uint32_t i = 0, at = eco_list_extra_at(&list->list, attribute); i < more->element_count;
			i++, extra += more->extra_count)
		if (extra[at] < 0 || (uint32_t)extra[at] >= codes)
			return BAD("list %u, chunk %u: %s code %d is not below %u",
				list->id, list->chunk_count, attribute == ECO_ATTR_SIZE ? "size" : "growth",
				extra[at], codes);
	return ECO_OK;
}

/* What every user of decoded elements relies on: colours lie in the palette, codes exist, widths are not
 * negative. */
static enum eco_code check_values(const struct view_list *list, const struct eco_elements *more,
	struct eco_error *error)
{
	enum eco_code code = check_codes(list, more, ECO_ATTR_GROWTH, ECO_GROWTHS, error);
	if (!code)
		code = check_codes(list, more, ECO_ATTR_SIZE, ECO_SIZES, error);
	if (code)
		return code;
	bool color = list->list.attributes & ECO_ATTR_COLOR, width = list->list.attributes & ECO_ATTR_WIDTH;
	for (uint32_t i = 0; (color || width) && i < more->element_count; i++) {
		const int32_t *extra = more->extra + (size_t)i * more->extra_count;
		if (color && (extra[0] < 0 || (uint32_t)extra[0] >= list->list.palette_count))
			return BAD("list %u, chunk %u: colour %d is outside the palette of %u", list->id,
				list->chunk_count, extra[0], list->list.palette_count);
		if (width && extra[color] < 0)
			return BAD("list %u, chunk %u: negative line width", list->id, list->chunk_count);
	}
	return ECO_OK;
}

static enum eco_code append(struct view_store *store, struct view_list *list, const struct eco_elements *more,
	struct eco_error *error)
{
	struct eco_elements *e = &list->elements;
	bool uv = list->list.attributes & ECO_ATTR_UV;
	uint32_t extra_count = eco_list_extra_count(&list->list);
	if (more->extra_count != extra_count || (more->uv != NULL) != uv)
		return BAD("list %u, chunk %u: attributes differ from the list's",
			list->id, list->chunk_count);
	enum eco_code code = check_values(list, more, error);
	e->extra_count = extra_count;
	if (!code)
		code = list_reserve(store, list, more, error);
	if (code)
		return code;
	memcpy(e->corners + e->element_count, more->corners, more->element_count);
	memcpy(e->position + 3 * (size_t)e->corner_count, more->position, 12 * (size_t)more->corner_count);
	if (uv)
		memcpy(e->uv + 2 * (size_t)e->corner_count, more->uv, 8 * (size_t)more->corner_count);
	if (extra_count)
		memcpy(e->extra + (size_t)e->element_count * extra_count, more->extra,
			(size_t)more->element_count * extra_count * 4);
	e->element_count += more->element_count;
	e->corner_count += more->corner_count;
	e->primitive_count += more->primitive_count;
	return ECO_OK;
}

static enum eco_code decode_image(struct view_store *store, struct view_list *list,
	const struct eco_chunk *chunk, const uint8_t *payload, struct eco_error *error)
{
	if (!store->options.images)
		return ECO_OK;
	char name[32];
	snprintf(name, sizeof name, "list-%u.png", list->id);
	enum eco_code code = eco_image_read_memory(&list->image, payload, chunk->size_bytes, name, error);
	if (code)
		return code;
	uint64_t texels = (uint64_t)list->image.width * list->image.height;
	for (uint64_t i = 0; i < texels && !list->cutout; i++)
		list->cutout = list->image.rgba[4 * i + 3] < 128;
	return account(store, texels * 4, error);
}

/* Opens a payload as the level after those that the list holds, in list->impostors, which has room for it. */
static enum eco_code open_level(const struct view_list *list, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *error)
{
	struct eco_impostor_body body;
	struct eco_impostor_level level;
	enum eco_code code = eco_impostor_level_read(&level, &body, payload, chunk->size_bytes, error);
	if (!code && level.level != list->chunk_count)
		code = BAD("level %u of an impostor", level.level);
	if (!code)
		code = lod_impostor_open(&list->impostors[list->chunk_count], &body, &level, error);
	eco_impostor_level_free(&level);
	return code;
}

static enum eco_code decode_impostor(struct view_store *store, struct view_list *list,
	const struct eco_chunk *chunk, const uint8_t *payload, struct eco_error *error)
{
	struct eco_error cause = { 0 };
	uint32_t count = list->chunk_count;
	struct lod_impostor *more = realloc(list->impostors, (count + (size_t)1) * sizeof *more);
	if (!more)
		return no_memory(error, "an impostor");
	list->impostors = more;
	enum eco_code code = open_level(list, chunk, payload, &cause);
	if (!code) {
		code = account(store, sizeof *more + lod_impostor_bytes(&more[count]), &cause);
		if (code)
			lod_impostor_close(&more[count]);
	}
	return code ? eco_fail(error, code, "list %u, chunk %u: %s", list->id, count, cause.text) : ECO_OK;
}

/* Ground is one chunk, every sample in its place: then whoever draws it needs no checks of its own. */
static enum eco_code check_ground(const struct view_store *store, struct view_list *list,
	struct eco_error *error)
{
	struct eco_error cause = { 0 };
	enum eco_code code = eco_ground_tile_of(&list->tile, &list->list, &list->elements,
		store->ground_columns, store->ground_rows, &cause);
	return code ? eco_fail(error, code, "list %u: %s", list->id, cause.text) : ECO_OK;
}

static enum eco_code decode_elements(struct view_store *store, struct view_list *list,
	const struct eco_chunk *chunk, const uint8_t *payload, struct eco_error *error)
{
	struct eco_elements more = { 0 };
	enum eco_code code = eco_chunk_decode(&list->list, chunk, list->chunk_count, payload,
		chunk->size_bytes, &more, error);
	if (!code)
		code = append(store, list, &more, error);
	if (!code && list->list.kind == ECO_LIST_GROUND)
		code = check_ground(store, list, error);
	eco_elements_free(&more);
	return code;
}

static enum eco_code on_chunk(void *ctx, uint32_t id, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *error)
{
	struct view_store *store = ctx;
	uint32_t index = view_table_get(&store->list_table, id);
	if (index == UINT32_MAX)
		return BAD("chunk %u of list %u came before the list's description", ordinal, id);
	struct view_list *list = store->lists[index];
	if (ordinal < list->chunk_count) {
		store->stats.chunks_twice++;
		return BAD("chunk %u of list %u was sent again, though the client holds it", ordinal, id);
	}
	if (ordinal != list->chunk_count || ordinal >= list->list.chunk_count)
		return BAD("chunk %u of list %u came where chunk %u of %u was due",
			ordinal, id, list->chunk_count, list->list.chunk_count);
	struct view_mark before = ordinal ? list->marks[ordinal - 1] : (struct view_mark){ 0 };
	if (chunk->primitive_count > list->list.primitive_count - before.primitives ||
		chunk->element_count > list->list.element_count - before.elements)
		return BAD("chunk %u of list %u holds more than the list declares", ordinal, id);
	struct eco_error cause = { 0 };
	enum eco_code code = eco_chunk_check(&list->list, chunk, &cause);
	if (code)
		return eco_fail(error, code, "list %u, chunk %u: %s", id, ordinal, cause.text);
	code = check_form_chunks(store, list, ordinal, before.elements + chunk->element_count, error);
	if (code)
		return code;
	double start = view_clock_ms();
	code = list->list.kind == ECO_LIST_IMAGE ? decode_image(store, list, chunk, payload, error)
		: list->list.kind == ECO_LIST_IMPOSTOR ? decode_impostor(store, list, chunk, payload, error)
		: decode_elements(store, list, chunk, payload, error);
	store->stats.decode_ms += view_clock_ms() - start;
	if (code)
		return code;
	list->marks[ordinal] = (struct view_mark){ before.primitives + chunk->primitive_count,
		before.elements + chunk->element_count, list->elements.corner_count };
	list->chunk_count++;
	store->stats.chunks++;
	store->stats.chunk_bytes += chunk->size_bytes;
	return ECO_OK;
}

/* A plan may only name what is held: then whoever draws it needs no checks of its own. */
static enum eco_code check_plan(const struct view_store *store, const struct eco_plan *plan,
	struct eco_error *error)
{
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		const struct eco_cut *cut = &plan->cuts[i];
		const struct view_list *list = view_store_list(store, cut->list);
		bool ground = list && list->list.kind == ECO_LIST_GROUND;
		if (!list || (!eco_list_vertices(&list->list) && !ground))
			return BAD("cut %u of the plan draws list %u, which %s", i,
				cut->list, list ? "is not drawable" : "was not sent");
		uint32_t held = list->chunk_count ? list->marks[list->chunk_count - 1].primitives : 0;
		if (cut->first > cut->end || cut->end > held)
			return BAD("cut %u of the plan draws [%u,%u) of list %u, "
				"of which %u are held", i, cut->first, cut->end, cut->list, held);
		if (list->list.kind == ECO_LIST_IMPOSTOR && cut->end != cut->first + 1)
			return BAD("cut %u of the plan draws %u levels of list %u, an impostor, not one", i,
				cut->end - cut->first, cut->list);
		if (ground
			&& (cut->anchor != ECO_NONE || cut->first || cut->end != list->list.primitive_count))
			return BAD("cut %u of the plan draws a part of list %u, a "
				"tile of ground", i, cut->list);
		if (cut->anchor == ECO_NONE && cut->placement >= plan->placement_count)
			return BAD("cut %u of the plan lies in placement %u of %u",
				i, cut->placement, plan->placement_count);
		const struct view_list *image = list->list.image == ECO_NONE ? NULL
			: view_store_list(store, list->list.image);
		if (list->list.image != ECO_NONE
				&& (!image || image->list.kind != ECO_LIST_IMAGE || !image->chunk_count))
			return BAD("list %u needs image %u, which was not sent", cut->list, list->list.image);
	}
	for (uint32_t i = 0; i < plan->run_count; i++)
		if (plan->runs[i].placement >= plan->placement_count || plan->runs[i].list_first
				> plan->runs[i].list_end)
			return BAD("run %u of the plan makes no sense", i);
	return ECO_OK;
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *error)
{
	struct view_store *store = ctx;
	enum eco_code code = check_plan(store, plan, error);
	if (code) {
		eco_plan_free(plan);
		return code;
	}
	eco_plan_free(&store->plan);
	store->plan = *plan;
	*plan = (struct eco_plan){ 0 };
	store->has_plan = true;
	return ECO_OK;
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *error)
{
	struct view_store *store = ctx;
	uint64_t planned = store->has_plan ? store->plan.vertices : 0;
	if (vertices != planned)
		return BAD("the stream ends with %llu vertices, its last plan has "
			"%llu", (unsigned long long)vertices, (unsigned long long)planned);
	store->complete = true;
	return ECO_OK;
}

const struct eco_wire_events view_store_events = { on_scene, on_plant, on_list, on_chunk, on_plan, on_end };

/* ---- Looking ---- */

const struct eco_plan *view_store_plan(const struct view_store *store)
{
	return store->has_plan ? &store->plan : NULL;
}

uint32_t view_store_summaries(const struct view_store *store)
{
	const struct eco_plan *plan = view_store_plan(store);
	uint32_t count = 0;
	for (uint32_t i = 0; plan && i < plan->cut_count; i++) {
		const struct view_list *list = view_store_list(store, plan->cuts[i].list);
		count += list && (list->list.attributes & ECO_ATTR_PLANT);
	}
	return count;
}

bool view_store_complete(const struct view_store *store)
{
	return store->complete;
}

double view_store_near_m(const struct view_store *store)
{
	return store->near_m;
}

const char *view_store_scene_name(const struct view_store *store)
{
	return store->name;
}

const struct view_list *view_store_list(const struct view_store *store, uint32_t id)
{
	uint32_t index = view_table_get(&store->list_table, id);
	return index == UINT32_MAX ? NULL : store->lists[index];
}

const struct view_plant *view_store_plant(const struct view_store *store, uint32_t id)
{
	uint32_t index = view_table_get(&store->plant_table, id);
	return index == UINT32_MAX ? NULL : store->plants[index];
}

void view_store_ground(const struct view_store *store, uint32_t *columns, uint32_t *rows)
{
	*columns = store->ground_columns;
	*rows = store->ground_rows;
}

uint32_t view_store_list_count(const struct view_store *store)
{
	return store->list_count;
}

const struct view_list *view_store_list_at(const struct view_store *store, uint32_t index)
{
	assert(index < store->list_count);
	return store->lists[index];
}

static int by_list(const void *a, const void *b)
{
	const struct eco_holding *x = a, *y = b;
	return x->list < y->list ? -1 : x->list > y->list;
}

enum eco_code view_store_holdings(const struct view_store *store, struct eco_holdings *holdings,
	struct eco_error *error)
{
	*holdings = (struct eco_holdings){ malloc((store->list_count + 1) * sizeof *holdings->items), 0 };
	if (!holdings->items)
		return no_memory(error, "the list of what is held");
	for (uint32_t i = 0; i < store->list_count; i++)
		if (store->lists[i]->chunk_count)
			holdings->items[holdings->count++] = (struct eco_holding){ store->lists[i]->id,
				store->lists[i]->chunk_count };
	if (holdings->count > ECO_HOLDINGS_MAX) {
		free(holdings->items);
		*holdings = (struct eco_holdings){ 0 };
		return eco_fail(error, ECO_TOO_LARGE, "more than %u lists are held", ECO_HOLDINGS_MAX);
	}
	qsort(holdings->items, holdings->count, sizeof *holdings->items, by_list);
	return ECO_OK;
}

const struct view_store_stats *view_store_stats(const struct view_store *store)
{
	return &store->stats;
}

struct eco_elements view_list_chunks(const struct view_list *list, uint32_t first, uint32_t end)
{
	assert(first <= end && end <= list->chunk_count);
	struct view_mark a = first ? list->marks[first - 1] : (struct view_mark){ 0 };
	struct view_mark b = end ? list->marks[end - 1] : (struct view_mark){ 0 };
	const struct eco_elements *e = &list->elements;
	return (struct eco_elements){
		.element_count = b.elements - a.elements, .corner_count = b.corners - a.corners,
		.primitive_count = b.primitives - a.primitives, .extra_count = e->extra_count,
		.corners = e->corners + a.elements, .position = e->position + 3 * (size_t)a.corners,
		.uv = e->uv ? e->uv + 2 * (size_t)a.corners : NULL,
		.extra = e->extra ? e->extra + (size_t)a.elements * e->extra_count : NULL,
	};
}
