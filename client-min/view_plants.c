#include "client-min/view_plants.h"

#include <stdlib.h>

#define TOGETHER 1024u /* plants that a server says at a time */

static int by_list(const void *a, const void *b)
{
	const struct view_plant_asked *x = a, *y = b;
	if (x->list != y->list)
		return x->list < y->list ? -1 : 1;
	return x->index < y->index ? -1 : x->index > y->index;
}

/* Of one list, all within TOGETHER of the first. */
static enum eco_code ask_together(struct view_fetch *fetch, const struct eco_chunk_id *pack,
	const struct view_plant_asked *plants, uint32_t count, struct eco_error *error)
{
	uint32_t first = plants[0].index;
	char *text;
	enum eco_code code = view_fetch_plants(fetch, pack, plants[0].list, first,
		plants[count - 1].index - first + 1, &text, error);
	if (code)
		return code;
	json_t *answer = json_loads(text, 0, NULL), *all = json_object_get(answer, "plants");
	free(text);
	for (uint32_t i = 0; i < count && !code; i++) {
		*plants[i].said = json_incref(json_array_get(all, plants[i].index - first));
		if (!json_is_object(*plants[i].said))
			code = eco_fail(error, ECO_BAD_INPUT,
				"the server says nothing of plant %u of list %u, which it sent", plants[i].index,
				plants[i].list);
	}
	json_decref(answer);
	return code;
}

enum eco_code view_plants_ask(struct view_fetch *fetch, const struct eco_chunk_id *pack,
	struct view_plant_asked *plants, uint32_t count, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	qsort(plants, count, sizeof *plants, by_list);
	for (uint32_t i = 0, end; i < count && !code; i = end) {
		for (end = i + 1; end < count && plants[end].list == plants[i].list
				&& plants[end].index - plants[i].index < TOGETHER;)
			end++;
		code = ask_together(fetch, pack, plants + i, end - i, error);
	}
	return code;
}
