#include "client-min/view_digest.h"

#include <stdio.h>
#include <stdlib.h>

#include <xxhash.h>

#include "client-min/view_record.h"

static uint64_t hash(uint64_t before, const void *bytes, size_t size)
{
	return size ? XXH3_64bits_withSeed(bytes, size, before) : before;
}

static uint64_t hash_word(uint64_t before, uint64_t word)
{
	return hash(before, &word, sizeof word);
}

/* ---- What is held ---- */

static uint64_t hash_elements(uint64_t h, const struct eco_elements *e)
{
	h = hash_word(hash_word(h, e->element_count), e->primitive_count);
	h = hash(h, e->corners, e->element_count);
	h = hash(h, e->position, (size_t)e->corner_count * 3 * sizeof *e->position);
	if (e->uv)
		h = hash(h, e->uv, (size_t)e->corner_count * 2 * sizeof *e->uv);
	return hash(h, e->extra, (size_t)e->element_count * e->extra_count * sizeof *e->extra);
}

static uint64_t hash_part(uint64_t h, const struct eco_texture_part *part)
{
	h = hash_word(hash_word(h, part->width), part->height);
	return part->texels ? hash(h, part->texels, (size_t)part->width * part->height * part->channels) : h;
}

static enum eco_code hash_impostor(uint64_t *h, const struct lod_impostor *impostor, struct eco_error *error)
{
	uint32_t texels = view_impostor_texels(impostor), *words = malloc((size_t)texels * 16 + 1);
	if (!words)
		return eco_no_memory(error, "a digest");
	view_impostor_write(impostor, words);
	*h = hash(*h, words, (size_t)texels * 16);
	free(words);
	return ECO_OK;
}

static enum eco_code hash_list(uint64_t *h, const struct view_list *list, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	*h = hash_word(hash_word(*h, list->id), list->chunk_count);
	*h = hash(*h, list->palette, (size_t)list->list.palette_count * 3);
	*h = hash_elements(*h, &list->elements);
	for (uint32_t i = 0; i < list->chunk_count && !code; i++) {
		if (list->parts)
			*h = hash_part(*h, &list->parts[i]);
		if (list->impostors)
			code = hash_impostor(h, &list->impostors[i], error);
	}
	return code;
}

/* ---- What is drawn ---- */

static uint64_t hash_instance(uint64_t h, const struct view_instance *p)
{
	const double place[6] = { p->place.at[0], p->place.at[1], p->place.at[2], p->place.sine,
		p->place.cosine, p->place.scale };
	h = hash(h, place, sizeof place);
	return hash_word(hash_word(h, p->owner), (uint64_t)p->hash << 32 | p->plant);
}

static uint64_t hash_cut(uint64_t h, const struct eco_cut *cut)
{
	h = hash_word(h, (uint64_t)cut->list << 32 | cut->anchor);
	h = hash_word(h, (uint64_t)cut->first << 32 | cut->end);
	h = hash_word(h, cut->halvings);
	return hash(h, &cut->scale, sizeof cut->scale);
}

static uint64_t hash_drawn(const struct view_selection *s)
{
	uint64_t h = hash_word(0, s->vertices);
	for (uint32_t i = 0; i < s->instance_count; i++)
		h = hash_instance(h, &s->instances[i]);
	for (uint32_t c = 0; c < s->cut_count; c++) {
		h = hash_cut(h, &s->plan_cuts[c]);
		h = hash(h, s->members + s->member_first[c],
			(size_t)(s->member_first[c + 1] - s->member_first[c]) * sizeof *s->members);
	}
	return h;
}

enum eco_code view_digest_write(char out[VIEW_DIGEST_BYTES], const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error)
{
	uint64_t held = 0;               /* a sum: lists may have come in any order */
	for (uint32_t i = 0; i < view_store_list_count(store); i++) {
		uint64_t one = 0;
		enum eco_code code = hash_list(&one, view_store_list_at(store, i), error);
		if (code)
			return code;
		held += one;
	}
	snprintf(out, VIEW_DIGEST_BYTES, "%016llx-%016llx", (unsigned long long)held,
		(unsigned long long)hash_drawn(selection));
	return ECO_OK;
}
