/* Parts of the pack at the target that need not be built again. Instance lists and summaries follow from
 * the tables' records of a tile and of those below it. So a hash of these records is compared between the
 * old pack and the new one, and where it is equal the old payload is taken. If one plant moves, only its
 * own tile's list and the summaries up to the root are made anew.
 *
 * The old pack itself says what it was made of. The cache only notes that this very program made it,
 * because another program might have made something else from the same input. So the result equals a full
 * build byte for byte, even if the old pack is damaged. */
#include "ecofiles/ecopack/make.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/format/pack_record.h"

static const uint8_t note[4] = "made";

struct known { XXH128_hash_t hash; uint32_t list; };
struct known_table { struct known *items; uint32_t count; };

struct make_kept {
	struct eco_pack *pack;
	struct known_table stands, summaries;
	/* per new tile: list of the old pack, or ECO_NONE; NULL: none is known */
	uint32_t *summary_of;
	uint64_t taken;
};

static int by_hash(const void *a, const void *b)
{
	const struct known *x = a, *y = b;
	int order = XXH128_cmp(&x->hash, &y->hash);
	return order ? order : x->list < y->list ? -1 : x->list > y->list;
}

static uint32_t find(const struct known_table *table, XXH128_hash_t hash)
{
	uint32_t low = 0, high = table->count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (XXH128_cmp(&table->items[middle].hash, &hash) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low < table->count && XXH128_isEqual(table->items[low].hash, hash) ? table->items[low].list
		: ECO_NONE;
}

/* ---- Hashes ---- */

static bool of_plant(const struct eco_list *list)
{
	return list->kind != ECO_LIST_INSTANCES && list->kind != ECO_LIST_GROUND
		&& list->kind != ECO_LIST_GROUND_IMAGE && list->kind != ECO_LIST_INVENTORY
		&& !(list->attributes & ECO_ATTR_PLANT);
}

/* Hashes everything that summaries take from plants: records, colours and chunks. Without memory sets
 * `failed`. */
static XXH128_hash_t hash_plants(const struct eco_scene *s, const struct eco_chunk *chunks, bool *failed)
{
	struct eco_writer w = { 0 };
	uint32_t colors_end = 0;
	for (uint32_t i = 0; i < s->plant_count; i++)
		eco_plant_write(&w, &s->plants[i]);
	for (uint32_t i = 0; i < s->anchor_count; i++)
		eco_anchor_write(&w, &s->anchors[i]);
	for (uint32_t i = 0; i < s->ladder_count; i++)
		eco_ladder_write(&w, &s->ladders[i]);
	for (uint32_t i = 0; i < s->list_count; i++) {
		struct eco_list list = s->lists[i];
		if (!of_plant(&list))
			continue;
		if (list.palette_count && list.palette_first + list.palette_count > colors_end)
			colors_end = list.palette_first + list.palette_count;
		list.chunk_first = 0;
		eco_list_write(&w, &list);
		for (uint32_t c = 0; c < list.chunk_count; c++)
			eco_write_bytes(&w, chunks[s->lists[i].chunk_first + c].id.bytes,
				sizeof chunks->id.bytes);
	}
	eco_write_bytes(&w, s->palette, 3 * (size_t)colors_end);     /* those of summaries follow */
	XXH128_hash_t hash = w.failed ? (XXH128_hash_t){ 0 } : XXH3_128bits(w.bytes, w.size);
	*failed = *failed || w.failed;
	eco_writer_free(&w);
	return hash;
}

static void add_group(XXH3_state_t *state, const struct eco_scene *s, const struct eco_group *group)
{
	const struct eco_list *list = &s->lists[group->list];
	const uint32_t numbers[] = { group->plant, group->first, group->count };
	XXH3_128bits_update(state, numbers, sizeof numbers);
	XXH3_128bits_update(state, list->grid_origin, sizeof list->grid_origin);
	XXH3_128bits_update(state, list->grid_step, sizeof list->grid_step);
	XXH3_128bits_update(state, s->places + group->place_first * ECO_PLACE_BYTES,
		(size_t)group->count * ECO_PLACE_BYTES);
}

/* Hashes each tile's content and its children. Tiles are named by their distance in the table, as in
 * summaries. */
static bool hash_tiles(const struct eco_scene *s, XXH128_hash_t *out)
{
	XXH3_state_t *state = XXH3_createState();
	if (!state)
		return false;
	for (uint32_t id = s->tile_count; id-- > 0;) {
		const struct eco_tile *t = &s->tiles[id];
		const uint64_t numbers[] = { t->instance_count, id == s->root, t->group_count,
			t->child_count };
		XXH3_128bits_reset(state);
		XXH3_128bits_update(state, numbers, sizeof numbers);
		XXH3_128bits_update(state, &t->area, sizeof t->area);
		for (uint32_t g = t->group_first; g < t->group_first + t->group_count; g++)
			add_group(state, s, &s->groups[g]);
		for (uint32_t c = t->child_first; c < t->child_first + t->child_count; c++) {
			const struct eco_child *child = &s->children[c];
			const uint32_t turn[] = { child->tile - id, child->placed, child->turn };
			XXH3_128bits_update(state, turn, sizeof turn);
			XXH3_128bits_update(state, child->at, sizeof child->at);
			XXH3_128bits_update(state, &child->scale, sizeof child->scale);
			XXH3_128bits_update(state, &out[child->tile], sizeof out[child->tile]);
		}
		out[id] = XXH3_128bits_digest(state);
	}
	XXH3_freeState(state);
	return true;
}

/* ---- The old pack ---- */

static bool index_old(struct make_kept *kept)
{
	const struct eco_scene *s = &kept->pack->scene;
	XXH128_hash_t *tiles = malloc((s->tile_count + 1u) * sizeof *tiles);
	kept->stands.items = malloc((s->group_count + 1u) * sizeof *kept->stands.items);
	kept->summaries.items = malloc((s->tile_count + 1u) * sizeof *kept->summaries.items);
	bool good = tiles && kept->stands.items && kept->summaries.items && hash_tiles(s, tiles);
	for (uint32_t i = 0; i < s->group_count && good; i++) {
		const struct eco_group *g = &s->groups[i];
		if (g->first)
			continue;
		kept->stands.items[kept->stands.count++] =
			(struct known){ XXH3_128bits(s->places + g->place_first * ECO_PLACE_BYTES,
			(size_t)s->lists[g->list].primitive_count * ECO_PLACE_BYTES), g->list };
	}
	for (uint32_t i = 0; i < s->tile_count && good; i++)
		if (s->tiles[i].summary != ECO_NONE)
			kept->summaries.items[kept->summaries.count++] =
				(struct known){ tiles[i], s->tiles[i].summary };
	if (good && kept->stands.count)
		qsort(kept->stands.items, kept->stands.count, sizeof *kept->stands.items, by_hash);
	if (good && kept->summaries.count)
		qsort(kept->summaries.items, kept->summaries.count, sizeof *kept->summaries.items, by_hash);
	free(tiles);
	return good;
}

void make_kept_open(struct make *m)
{
	struct main_cache_key key;
	struct eco_error unread = { 0 };
	uint8_t *bytes = NULL;
	size_t size;
	if (!m->cache.folder[0] || !(m->kept = calloc(1, sizeof *m->kept)))
		return;
	bool ours = eco_pack_open(&m->kept->pack, m->options->pack, &unread) == ECO_OK
		&& make_cache_pack_key(&key, &m->kept->pack->id)
		&& main_cache_get(&m->cache, &key, &bytes, &size) && size == sizeof note
		&& memcmp(bytes, note, sizeof note) == 0;
	free(bytes);
	m->cache.hits = m->cache.misses = 0;         /* reports count plants only */
	if (!ours || !index_old(m->kept))
		make_kept_close(m);
}

void make_kept_close(struct make *m)
{
	if (!m->kept)
		return;
	eco_pack_close(m->kept->pack);
	free(m->kept->stands.items);
	free(m->kept->summaries.items);
	free(m->kept->summary_of);
	free(m->kept);
	m->kept = NULL;
}

/* Tables have been checked, payloads have not: a damaged one is built again. */
static uint32_t sound(const struct make_kept *kept, uint32_t list)
{
	const uint8_t *bytes;
	size_t size;
	if (list == ECO_NONE)
		return ECO_NONE;
	const struct eco_list *old = &kept->pack->scene.lists[list];
	for (uint32_t i = old->chunk_first; i < old->chunk_first + old->chunk_count; i++)
		if (eco_pack_payload(kept->pack, i, &bytes, &size, NULL))
			return ECO_NONE;
	return list;
}

uint32_t make_kept_stand(const struct make *m, const uint8_t *places, size_t size)
{
	return m->kept ? sound(m->kept, find(&m->kept->stands, XXH3_128bits(places, size))) : ECO_NONE;
}

void make_kept_tiles(struct make *m)
{
	struct make_kept *kept = m->kept;
	bool failed = false;
	if (!kept)
		return;
	XXH128_hash_t old = hash_plants(&kept->pack->scene, kept->pack->scene.chunks, &failed);
	XXH128_hash_t now = hash_plants(&m->scene, eco_pack_chunks(m->writer), &failed);
	if (failed || !XXH128_isEqual(old, now))
		return;
	XXH128_hash_t *tiles = malloc((m->scene.tile_count + 1u) * sizeof *tiles);
	kept->summary_of = malloc((m->scene.tile_count + 1u) * sizeof *kept->summary_of);
	bool good = tiles && kept->summary_of && hash_tiles(&m->scene, tiles);
	for (uint32_t i = 0; i < m->scene.tile_count && good; i++)
		kept->summary_of[i] = find(&kept->summaries, tiles[i]);
	free(tiles);
	if (!good) {
		free(kept->summary_of);
		kept->summary_of = NULL;
	}
}

uint32_t make_kept_summary(const struct make *m, uint32_t tile, const uint8_t (*rgb)[3], uint32_t count)
{
	uint32_t old = m->kept && m->kept->summary_of ? m->kept->summary_of[tile] : ECO_NONE;
	if (old == ECO_NONE)
		return ECO_NONE;
	const struct eco_scene *s = &m->kept->pack->scene;
	const struct eco_list *list = &s->lists[old];
	bool same = list->palette_count == count
		&& memcmp(s->palette + list->palette_first, rgb, count * sizeof *rgb) == 0;
	return same ? sound(m->kept, old) : ECO_NONE;
}

enum eco_code make_kept_take(struct make *m, uint32_t old, struct eco_list *record, uint32_t *list_id)
{
	m->kept->taken++;
	return make_add_copied(m, record, m->kept->pack, old, list_id);
}

const struct eco_list *make_kept_list(const struct make *m, uint32_t old)
{
	return &m->kept->pack->scene.lists[old];
}

void make_kept_note(struct make *m)
{
	struct main_cache_key key;
	struct eco_error unread = { 0 };
	struct eco_pack *pack = NULL;
	if (!m->cache.folder[0] || eco_pack_open(&pack, m->options->pack, &unread))
		return;
	if (make_cache_pack_key(&key, &pack->id))
		main_cache_put(&m->cache, &key, note, sizeof note);
	eco_pack_close(pack);
}

uint64_t make_kept_count(const struct make *m) { return m->kept ? m->kept->taken : 0; }
