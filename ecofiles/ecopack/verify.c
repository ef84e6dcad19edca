/* Reads everything in a pack as a client would, and reports faults. Opening has already checked the tables
 * against each other; here each payload is hashed and decoded, and data stored twice is compared. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/impostor.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/texture.h"
#include "ecofiles/import/ground/ground.h"

struct verify {
	const struct eco_pack *pack;
	FILE *out;
	struct inspect_counts *counts;
	uint32_t *group_of;          /* per list: its first group; ECO_NONE: it has none */
};

static void complain(struct verify *v, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void complain(struct verify *v, const char *format, ...)
{
	va_list args;
	main_progress_end();
	va_start(args, format);
	vfprintf(v->out, format, args);
	va_end(args);
	fputc('\n', v->out);
	v->counts->damaged++;
}

/* Compares an instance list with the places that the planner reads; `first`: primitives of the list before
 * this chunk. */
static void compare_places(struct verify *v, uint32_t list_id, uint32_t chunk, uint32_t first,
	const struct eco_elements *e)
{
	const struct eco_scene *s = &v->pack->scene;
	if (v->group_of[list_id] == ECO_NONE)
		return;
	uint64_t at = s->groups[v->group_of[list_id]].place_first + first;
	for (uint32_t i = 0; i < e->element_count; i++) {
		struct eco_place a = eco_place_read(s, at + i), b = eco_place_of(&s->lists[list_id], e, i);
		if (memcmp(a.position, b.position, sizeof a.position) || a.turn != b.turn
				|| a.width != b.width || a.tint != b.tint || a.scale != b.scale) {
			complain(v, "list %u, chunk %u: instance %u differs from place %" PRIu64, list_id,
				chunk, first + i, at + i);
			return;
		}
	}
}

/* NULL, or what is wrong: in `error` or constant. */
static const char *bad_impostor(const uint8_t *bytes, size_t size, uint32_t ordinal, struct eco_error *error)
{
	struct eco_impostor_body body;
	struct eco_impostor_level level;
	if (eco_impostor_level_read(&level, &body, bytes, size, error))
		return error->text;
	bool good = level.level == ordinal;
	eco_impostor_level_free(&level);
	return good ? NULL : "holds another level of an impostor than its number says";
}

/* A level is judged at its last chunk. */
static const char *bad_texture(const struct verify *v, const struct eco_list *list, uint32_t ordinal,
	struct eco_error *error)
{
	struct eco_texture_part part;
	uint32_t level = 0, side = ECO_GROUND_IMAGE_SIDE >> (ECO_GROUND_IMAGE_LEVELS - 1);
	for (uint32_t c = 0; c < ordinal; c++)
		level += v->pack->scene.chunks[list->chunk_first + c].primitive_count;
	if (!v->pack->scene.chunks[list->chunk_first + ordinal].primitive_count)
		return NULL;
	if (eco_texture_read_level(&part, v->pack, list, level, error))
		return error->text;
	bool good = list->kind != ECO_LIST_GROUND_IMAGE || (part.width == side << level && part.height == side << level);
	eco_texture_part_free(&part);
	return good ? NULL : "holds another number of texels than its level says";
}

static const char *bad_inventory(const struct eco_pack *pack, uint32_t ordinal, struct eco_error *error)
{
	struct eco_inventory_block block;
	bool bad = eco_inventory_read(&block, pack, (uint64_t)ordinal * ECO_INVENTORY_PLACES, error);
	eco_inventory_free(&block);
	return bad ? error->text : NULL;
}

static void verify_chunk(struct verify *v, uint32_t list_id, uint32_t ordinal, uint32_t first)
{
	const struct eco_scene *s = &v->pack->scene;
	const struct eco_list *list = &s->lists[list_id];
	uint32_t id = list->chunk_first + ordinal;
	const struct eco_chunk *chunk = &s->chunks[id];
	struct eco_error error = { 0 };
	struct eco_elements elements = { 0 };
	const uint8_t *bytes;
	size_t size;
	const char *bad = NULL;
	if (eco_pack_payload(v->pack, id, &bytes, &size, &error))
		bad = error.text;
	else if (list->kind == ECO_LIST_IMPOSTOR)
		bad = bad_impostor(bytes, size, ordinal, &error);
	else if (list->kind == ECO_LIST_INVENTORY)
		bad = bad_inventory(v->pack, ordinal, &error);
	else if (list->coder == ECO_CODER_BYTES)
		bad = bad_texture(v, list, ordinal, &error);
	else if (eco_chunk_decode(list, chunk, ordinal, bytes, size, &elements, &error))
		bad = error.text;
	else if (elements.element_count != chunk->element_count
			|| elements.primitive_count != chunk->primitive_count)
		bad = "decodes to other counts than its record says";
	else
		bad = eco_elements_fault(&elements, list, s->plant_count);
	if (bad)
		complain(v, "list %u, chunk %u, offset %" PRIu64 ": %s", list_id, ordinal, chunk->offset,
			bad);
	else if (list->kind == ECO_LIST_INSTANCES)
		compare_places(v, list_id, ordinal, first, &elements);
	v->counts->primitives += elements.primitive_count;
	eco_elements_free(&elements);
}

static void verify_lists(struct verify *v)
{
	const struct eco_scene *s = &v->pack->scene;
	for (uint32_t i = 0; i < s->list_count; i++) {
		uint32_t first = 0;
		for (uint32_t c = 0; c < s->lists[i].chunk_count; c++) {
			verify_chunk(v, i, c, first);
			first += s->chunks[s->lists[i].chunk_first + c].primitive_count;
			v->counts->chunks++;
		}
		v->counts->lists++;
		main_progress("verifying", NULL, (double)i / s->list_count);
	}
}

/* Levels of wood must end with a chunk, so that a prefix of chunks is a level. */
static void verify_ladder(struct verify *v, uint32_t id)
{
	const struct eco_scene *s = &v->pack->scene;
	const struct eco_ladder *l = &s->ladders[id];
	bool wood = l->triangles != ECO_NONE && !eco_ladder_has_splats(s, l);
	for (uint32_t k = 0; k < l->level_count && wood; k++) {
		const struct eco_list *list = &s->lists[l->triangles];
		uint32_t end = 0;
		for (uint32_t c = 0; c < list->chunk_count && end < l->level_end[k]; c++)
			end += s->chunks[list->chunk_first + c].primitive_count;
		if (end != l->level_end[k])
			complain(v, "ladder %u: level %u ends inside a chunk of list %u", id, k,
				l->triangles);
	}
}

/* ---- Ground ---- */

/* Compares the table of ground with its lists: places, and heights within bounds. */

struct decoded {
	const struct eco_ground_tile *tile;
	const struct eco_list *list;
	struct eco_ground_span x, y;
	struct eco_elements samples;
};

/* False: the chunk is damaged, which has been reported. */
static bool decode(struct decoded *d, const struct eco_pack *pack, uint32_t id)
{
	const struct eco_scene *s = &pack->scene;
	const uint8_t *bytes;
	size_t size;
	*d = (struct decoded){ .tile = &s->ground[id], .list = &s->lists[s->ground[id].list] };
	eco_ground_spans(&d->x, &d->y, d->tile, s->ground_columns, s->ground_rows);
	const struct eco_chunk *chunk = &s->chunks[d->list->chunk_first];
	return eco_pack_payload(pack, d->list->chunk_first, &bytes, &size, NULL) == ECO_OK
		&& eco_chunk_decode(d->list, chunk, 0, bytes, size, &d->samples, NULL) == ECO_OK
		&& d->samples.element_count == d->x.count * d->y.count;
}

static double height_m(const struct decoded *d, uint32_t column, uint32_t row)
{
	size_t i = (size_t)(row + d->y.before) * d->x.count + column + d->x.before;
	return d->list->grid_origin[2] + d->samples.position[3 * i + 2] * d->list->grid_step[2];
}

static const char *check_samples(const struct decoded *d, const struct eco_scene *s)
{
	struct eco_ground_tile found;
	double slack = (double)d->tile->error_m + d->list->grid_step[2];
	if (eco_ground_tile_of(&found, d->list, &d->samples, s->ground_columns, s->ground_rows,
		s->ground_margin, NULL)
			!= ECO_OK || found.column != d->tile->column
		|| found.row != d->tile->row)
		return "its samples are not those of its column and row";
	for (uint32_t r = 0; r < d->y.inner; r++)
		for (uint32_t c = 0; c < d->x.inner; c++) {
			double z = height_m(d, c, r);
			if (z < (double)d->tile->low_m - slack || z > (double)d->tile->high_m + slack)
				return "it has heights beyond its bounds";
		}
	return NULL;
}

static void verify_ground(struct verify *v)
{
	const struct eco_scene *s = &v->pack->scene;
	for (uint32_t i = 0; i < s->ground_count; i++) {
		struct decoded tile;
		const char *bad = decode(&tile, v->pack, i) ? check_samples(&tile, s) : NULL;
		eco_elements_free(&tile.samples);
		if (bad)
			complain(v, "ground tile %u (list %u): %s", i, s->ground[i].list, bad);
	}
}

/* ---- All ---- */

enum eco_code inspect_verify(const char *path, FILE *out, struct inspect_counts *counts,
	struct eco_error *error)
{
	struct eco_pack *pack = NULL;
	*counts = (struct inspect_counts){ 0 };
	enum eco_code code = eco_pack_open(&pack, path, error);
	if (code)
		return code;
	const struct eco_scene *s = &pack->scene;
	struct verify v = { .pack = pack, .out = out, .counts = counts,
		.group_of = eco_alloc(s->list_count + 1u, sizeof(uint32_t)) };
	memset(v.group_of, 0xFF, (s->list_count + 1u) * sizeof(uint32_t));
	for (uint32_t i = 0; i < s->group_count; i++)
		if (!s->groups[i].first)
			v.group_of[s->groups[i].list] = i;
	verify_lists(&v);
	for (uint32_t i = 0; i < s->ladder_count; i++)
		verify_ladder(&v, i);
	verify_ground(&v);
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_INSTANCES && v.group_of[i] == ECO_NONE)
			complain(&v, "list %u: instances that no tile plants", i);
	main_progress_end();
	free(v.group_of);
	eco_pack_close(pack);
	if (!code && counts->damaged)
		code = eco_fail(error, ECO_DAMAGED, "%s: %" PRIu64
			" things are damaged; build the pack again, or fetch it anew", path, counts->damaged);
	return code;
}
