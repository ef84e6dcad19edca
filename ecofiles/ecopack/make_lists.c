/* Used by every step of a build: tables that grow, lists stored and kept in them, the number of threads. */
#include "ecofiles/ecopack/make.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void *make_append(struct make *m, struct make_array *array, size_t size)
{
	if (array->count == array->capacity) {
		uint64_t wanted = array->capacity ? 2 * array->capacity : 64;
		void *bigger = wanted < ECO_NONE ? realloc(array->items, wanted * size) : NULL;
		if (!bigger) {
			eco_fail(m->error, ECO_NO_MEMORY, "no memory for %llu records",
				(unsigned long long)wanted);
			return NULL;
		}
		array->items = bigger;
		array->capacity = wanted;
	}
	return (uint8_t *)array->items + size * array->count++;
}

enum eco_code make_add(struct make *m, struct make_array *array, const void *records, uint32_t count,
	size_t size)
{
	for (uint32_t i = 0; i < count; i++) {
		void *added = make_append(m, array, size);
		if (!added)
			return ECO_NO_MEMORY;
		memcpy(added, (const uint8_t *)records + i * size, size);
	}
	return ECO_OK;
}

enum eco_code make_add_colors(struct make *m, const uint8_t (*rgb)[3], uint32_t count, uint32_t *first)
{
	const uint8_t (*palette)[3] = m->palette.items;
	size_t size = count * sizeof *rgb;
	*first = 0;
	while (*first + (uint64_t)count <= m->palette.count && memcmp(palette[*first], rgb, size) != 0)
		++*first;
	if (*first + (uint64_t)count <= m->palette.count)
		return ECO_OK;
	*first = (uint32_t)m->palette.count;
	return make_add(m, &m->palette, rgb, count, sizeof *rgb);
}

static uint32_t moved(const uint32_t *to, uint32_t index) { return index == ECO_NONE ? ECO_NONE : to[index]; }

enum eco_code make_add_plant(struct make *m, uint32_t id, const struct make_tables *from,
	const uint32_t *lists)
{
	struct eco_plant *plant = &m->table[id];
	uint32_t curve_first = (uint32_t)m->curves.count;
	plant->anchor_first = (uint32_t)m->anchors.count;
	plant->ladder_first = (uint32_t)m->ladders.count;
	plant->ladder_count = from->ladder_count;
	enum eco_code code = make_add(m, &m->anchors, from->anchors, plant->anchor_count,
		sizeof *from->anchors);
	if (!code)
		code = make_add(m, &m->curves, from->curves, from->curve_count, sizeof *from->curves);
	for (uint32_t i = 0; i < from->ladder_count && !code; i++) {
		struct eco_ladder ladder = from->ladders[i];
		ladder.plant = id;
		ladder.anchor += plant->anchor_first - from->anchor_first;
		ladder.curve_first += curve_first - from->curve_first;
		ladder.points = moved(lists, ladder.points);
		ladder.lines = moved(lists, ladder.lines);
		ladder.simple = moved(lists, ladder.simple);
		ladder.triangles = moved(lists, ladder.triangles);
		ladder.impostor = moved(lists, ladder.impostor);
		code = make_add(m, &m->ladders, &ladder, 1, sizeof ladder);
	}
	return code;
}

enum eco_code make_keep_list(struct make *m, uint32_t list_id)
{
	const struct eco_list *stored = eco_pack_list(m->writer, list_id);
	m->scene.needs |= eco_list_needs(stored);
	return make_add(m, &m->lists, stored, 1, sizeof *stored);
}

enum eco_code make_add_list(struct make *m, const struct eco_list *list, const struct eco_elements *elements,
	const uint32_t *ends, uint32_t end_count, const struct eco_elements *partner, uint32_t *list_id)
{
	enum eco_code code = eco_pack_add_list(m->writer, list, elements, ends, end_count, partner, list_id,
		m->error);
	return code ? code : make_keep_list(m, *list_id);
}

enum eco_code make_add_encoded(struct make *m, const struct eco_list *list, const struct eco_encoded *encoded,
	uint32_t *list_id)
{
	enum eco_code code = eco_pack_add_encoded(m->writer, list, encoded, list_id, m->error);
	return code ? code : make_keep_list(m, *list_id);
}

uint32_t make_threads(const struct make *m)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	return m->options->jobs ? m->options->jobs : processors > 64 ? 64 : processors > 0
		? (uint32_t)processors : 1;
}
