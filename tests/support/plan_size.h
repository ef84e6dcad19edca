/* Bytes of the chunks that a plan needs, with frames: for a planner input's size. */
#ifndef TESTS_PLAN_SIZE_H
#define TESTS_PLAN_SIZE_H

#include <stdlib.h>

#include "lod/plan/planner.h"

#define PLAN_SIZE_FRAME 60u      /* beside each payload */

struct plan_sizer { const struct eco_scene *scene; const struct eco_holdings *holdings; };

static inline enum eco_code plan_size(void *ctx, struct eco_plan *plan, uint64_t *bytes, struct eco_error *error)
{
	const struct plan_sizer *sizer = ctx;
	struct eco_holdings needs;
	enum eco_code code = lod_plan_needs(sizer->scene, plan, &needs, error);
	*bytes = 100;
	for (uint32_t i = 0; !code && i < needs.count; i++) {
		const struct eco_list *list = &sizer->scene->lists[needs.items[i].list];
		for (uint32_t c = eco_holdings_chunks(sizer->holdings, needs.items[i].list);
				c < needs.items[i].chunks; c++)
			*bytes += sizer->scene->chunks[list->chunk_first + c].size_bytes + PLAN_SIZE_FRAME;
	}
	if (!code)
		free(needs.items);
	return code;
}

#endif
