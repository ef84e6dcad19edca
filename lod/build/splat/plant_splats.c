#include "lod/build/splat/plant_splats.h"

#include <stdlib.h>
#include <string.h>

#include "lod/build/splat/splat_fit.h"

#define FIRST_CHUNK 16u          /* splats: the levels up to here are one chunk */

static uint32_t nearest_color(const struct lod_plant *plant, const uint8_t rgb[3])
{
	uint32_t best = 0, least = UINT32_MAX;
	for (uint32_t i = 0; i < plant->palette_count; i++) {
		uint32_t square = 0;
		for (int k = 0; k < 3; k++) {
			int32_t d = plant->palette[i][k] - rgb[k];
			square += (uint32_t)(d * d);
		}
		if (square < least) {
			least = square;
			best = i;
		}
	}
	return best;
}

static struct eco_list list_of(const struct lod_plant *plant, const struct lod_splats *splats, uint32_t count)
{
	struct eco_list list = { .kind = ECO_LIST_POINTS, .coder = ECO_CODER_ROWS,
		.attributes = ECO_ATTR_COLOR | ECO_ATTR_SPLAT, .plant = ECO_NONE, .image = ECO_NONE,
		.partner = ECO_NONE, .palette_count = plant->palette_count,
		.unit_area = splats->unit * splats->unit,
		.element_count = count, .primitive_count = count };
	for (int k = 0; k < 3; k++) {
		list.grid_origin[k] = splats->origin[k];
		list.grid_step[k] = splats->step;
	}
	return list;
}

static void put_elements(struct lod_list_draft *draft, const struct lod_plant *plant,
	const struct lod_splats *splats)
{
	struct eco_elements *e = &draft->elements;
	uint32_t count = draft->list.element_count;
	e->element_count = e->corner_count = e->primitive_count = count;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_splat *splat = &splats->items[i];
		int32_t *extra = e->extra + (size_t)e->extra_count * i;
		e->corners[i] = 1;
		memcpy(e->position + 3 * (size_t)i, splat->at, sizeof splat->at);
		extra[0] = (int32_t)nearest_color(plant, splat->rgb);
		memcpy(extra + 1, splat->code, sizeof splat->code);
	}
	for (uint32_t level = 0; level < splats->level_count; level++)
		if (splats->level_end[level] > FIRST_CHUNK || level + 1 == splats->level_count
				|| splats->level_end[level + 1] > FIRST_CHUNK)
			draft->ends[draft->end_count++] = splats->level_end[level];
}

/* Appends an empty list with room for its elements; NULL without memory. What was allocated is the plant's.
 */
static struct lod_list_draft *add_list(struct lod_plant *plant, const struct eco_list *list, uint32_t ends)
{
	struct lod_list_draft *lists = realloc(plant->lists, (plant->list_count + 1u) * sizeof *lists);
	if (!lists)
		return NULL;
	plant->lists = lists;
	struct lod_list_draft *draft = &lists[plant->list_count++];
	*draft = (struct lod_list_draft){ .list = *list, .ends = calloc(ends, sizeof *draft->ends) };
	struct eco_elements *e = &draft->elements;
	size_t count = list->element_count;
	e->extra_count = eco_list_extra_count(list);
	e->corners = calloc(count, 1);
	e->position = calloc(3 * count, sizeof *e->position);
	e->extra = calloc(e->extra_count * count, sizeof *e->extra);
	return draft->ends && e->corners && e->position && e->extra ? draft : NULL;
}

static bool add_ladder(struct lod_plant *plant, const struct lod_splats *splats)
{
	struct eco_ladder *ladders = realloc(plant->ladders, (plant->ladder_count + 1u) * sizeof *ladders);
	if (!ladders)
		return false;
	plant->ladders = ladders;
	struct eco_ladder *ladder = &ladders[plant->ladder_count++];
	*ladder = (struct eco_ladder){ .organ = ECO_ORGAN_FOLIAGE, .flags = ECO_LADDER_WHOLE,
		.level_count = (uint8_t)splats->level_count, .points = plant->list_count - 1,
		.lines = ECO_NONE, .simple = ECO_NONE, .triangles = ECO_NONE, .importance = 1 };
	memcpy(ladder->level_end, splats->level_end, splats->level_count * sizeof *ladder->level_end);
	plant->plant.ladder_count = plant->ladder_count;
	return true;
}

enum eco_code lod_plant_add_splats(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error)
{
	struct lod_splats splats;
	/* a build with small curves is a draft in its splats, too */
	bool small = options->pixels && options->pixels < 160;
	struct lod_splats_options fit = { .views = small ? 12 : 0, .pixels = small ? 48 : 0,
		.progress = options->progress, .each = options->each,
		.ctx = options->ctx };
	if (options->stage)
		options->stage(options->ctx, LOD_STAGE_SPLATS);
	enum eco_code code = lod_splats_fit(&splats, model, &fit, error);
	if (code)
		return code;
	if (splats.level_count) {
		struct eco_list list = list_of(plant, &splats, splats.level_end[splats.level_count - 1]);
		struct lod_list_draft *draft = add_list(plant, &list, splats.level_count);
		if (draft)
			put_elements(draft, plant, &splats);
		if (!draft || !add_ladder(plant, &splats))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u splats", list.element_count);
	}
	lod_splats_free(&splats);
	return code;
}
