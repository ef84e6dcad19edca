/* Chunks that a plan needs: see lod/plan/planner.h. */
#include "lod/plan/planner.h"

#include <stdlib.h>

uint32_t lod_plan_chunks_for(const struct eco_scene *scene, uint32_t list, uint32_t end)
{
	const struct eco_list *l = &scene->lists[list];
	uint64_t have = 0;
	uint32_t chunks = 0;
	while (have < end && chunks < l->chunk_count)
		have += scene->chunks[l->chunk_first + chunks++].primitive_count;
	return chunks;
}

static int by_holding(const void *a, const void *b)
{
	const struct eco_holding *x = a, *y = b;
	if (x->list != y->list)
		return x->list < y->list ? -1 : 1;
	return x->chunks < y->chunks ? -1 : x->chunks > y->chunks;
}

enum eco_code lod_plan_needs(const struct eco_scene *scene, const struct eco_plan *plan,
	struct eco_holdings *needs, struct eco_error *error)
{
	size_t most = (size_t)plan->cut_count + 1;
	for (uint32_t i = 0; i < plan->run_count; i++)
		most += plan->runs[i].list_end - plan->runs[i].list_first;
	*needs = (struct eco_holdings){ .items = malloc(most * sizeof *needs->items) };
	if (!needs->items)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %zu lists", most);
	struct eco_holding *items = needs->items;
	uint32_t count = 0, kept = 0;
	for (uint32_t i = 0; i < plan->run_count; i++)
		for (uint32_t list = plan->runs[i].list_first; list < plan->runs[i].list_end; list++)
			items[count++] = (struct eco_holding){ list, scene->lists[list].chunk_count };
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		uint32_t list = plan->cuts[i].list;
		items[count++] = (struct eco_holding){ list,
			lod_plan_chunks_for(scene, list, plan->cuts[i].end) };
	}
	qsort(items, count, sizeof *items, by_holding);
	for (uint32_t i = 0; i < count; i++) /* of equal lists the last needs most */
		if (i + 1 == count || items[i + 1].list != items[i].list)
			items[kept++] = items[i];
	needs->count = kept;
	return ECO_OK;
}

uint64_t lod_plan_missing(const struct eco_scene *scene, const struct eco_holdings *holdings,
	const struct eco_holdings *needs, uint64_t *ground)
{
	uint64_t sum = 0, of_ground = 0;
	for (uint32_t i = 0; i < needs->count; i++) {
		const struct eco_list *list = &scene->lists[needs->items[i].list];
		uint64_t before = sum;
		for (uint32_t c = eco_holdings_chunks(holdings, needs->items[i].list); c < needs->items[i].chunks; c++)
			sum += scene->chunks[list->chunk_first + c].size_bytes;
		of_ground += list->kind == ECO_LIST_GROUND ? sum - before : 0;
	}
	if (ground)
		*ground = of_ground;
	return sum;
}
