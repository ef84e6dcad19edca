/* Properties of lists that need no decoding. */
#include "ecofiles/base/random.h"
#include "ecofiles/format/list.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/splat.h"

const char *const eco_organ_names[ECO_ORGAN_COUNT] = {
	[ECO_ORGAN_WOOD] = "wood",
	[ECO_ORGAN_FOLIAGE] = "foliage",
	[ECO_ORGAN_FLOWER] = "flower",
};

void eco_elements_free(struct eco_elements *elements)
{
	if (!elements)
		return;
	eco_free(elements->corners, elements->position, elements->exact, elements->uv, elements->extra,
		elements->part);
	memset(elements, 0, sizeof *elements);
}

uint32_t eco_list_extra_count(const struct eco_list *list)
{
	return (list->attributes & ECO_ATTR_COLOR ? 1u : 0u) + (list->attributes & ECO_ATTR_WIDTH ? 1u : 0u)
		+ (list->attributes & ECO_ATTR_PLANT ? 2u : 0u)
		+ (list->attributes & ECO_ATTR_PLACE ? 2u : 0u)
		+ (list->attributes & ECO_ATTR_GROWTH ? 1u : 0u)
		+ (list->attributes & ECO_ATTR_SIZE ? 1u : 0u)
		+ (list->attributes & ECO_ATTR_SPLAT ? ECO_SPLAT_CODES : 0u);
}

/* Attributes come in the order of their bits. */
uint32_t eco_list_extra_at(const struct eco_list *list, enum eco_attr attribute)
{
	const struct eco_list before = { .attributes = list->attributes & (attribute - 1) };
	assert(list->attributes & attribute);
	return eco_list_extra_count(&before);
}

bool eco_list_level_known(const struct eco_list *list)
{
	switch (list->kind) {
	case ECO_LIST_POINTS:
	case ECO_LIST_IMPOSTOR:
	case ECO_LIST_OUTLINE: return true;
	case ECO_LIST_GROUND: return list->level < ECO_GROUND_LEVELS;
	default: return list->level == 0;
	}
}

uint32_t eco_list_vertices(const struct eco_list *list)
{
	switch (list->kind) {
	case ECO_LIST_TRIANGLES: return 3;
	case ECO_LIST_LINES: return 2;
	case ECO_LIST_POINTS:
	case ECO_LIST_IMPOSTOR: return 1;
	default: return 0;
	}
}

uint32_t eco_list_needs(const struct eco_list *list)
{
	static const uint32_t of_kind[] = { [ECO_LIST_TRIANGLES] = ECO_NEED_TRIANGLES,
		[ECO_LIST_LINES] = ECO_NEED_LINES, [ECO_LIST_POINTS] = ECO_NEED_POINTS,
		[ECO_LIST_GROUND] = ECO_NEED_GROUND, [ECO_LIST_IMAGE] = ECO_NEED_TEXTURES,
		[ECO_LIST_IMPOSTOR] = ECO_NEED_IMPOSTORS,
		[ECO_LIST_OUTLINE] = ECO_NEED_TEXTURES, [ECO_LIST_GROUND_IMAGE] = ECO_NEED_GROUND_IMAGE,
		[ECO_LIST_INVENTORY] = 0 };
	if (list->attributes & ECO_ATTR_SPLAT)
		return ECO_NEED_SPLATS | (list->attributes & ECO_ATTR_PLANT ? ECO_NEED_SUMMARIES : 0);
	if (list->kind == ECO_LIST_INSTANCES)
		return (list->attributes & ECO_ATTR_WIDTH ? ECO_NEED_WIDTHS : 0u)
			| (list->attributes & ECO_ATTR_COLOR ? ECO_NEED_TINTS : 0u);
	return list->attributes & ECO_ATTR_PLANT ? (uint32_t)ECO_NEED_SUMMARIES : of_kind[list->kind];
}

struct eco_id_text eco_id_text(const uint8_t bytes[16])
{
	struct eco_id_text text;
	for (size_t i = 0; i < 16; i++)
		snprintf(text.hex + 2 * i, 3, "%02x", bytes[i]);
	return text;
}

const char *eco_elements_fault(const struct eco_elements *e, const struct eco_list *list, uint32_t plant_count)
{
	const bool instances = list->kind == ECO_LIST_INSTANCES, splats = list->attributes & ECO_ATTR_SPLAT;
	const struct { enum eco_attr attribute; int64_t count; const char *fault; } values[] = {
		/* of an instance 0 is none of the palette */
		{ ECO_ATTR_COLOR, (int64_t)list->palette_count + instances, "names a colour outside its palette" },
		{ ECO_ATTR_PLANT, plant_count, "names a plant that is not there" },
		{ ECO_ATTR_GROWTH, ECO_GROWTHS, "has a growth code that does not exist" },
		{ ECO_ATTR_SIZE, ECO_SIZES, "has a size code that does not exist" },
		{ ECO_ATTR_WIDTH, instances ? ECO_WIDTH_MOST + 1 : INT64_MAX, "has an impossible width" },
		{ ECO_ATTR_PLACE, 65536, "has an impossible turn" } };
	if (e->extra_count != eco_list_extra_count(list) || !e->uv != !(list->attributes & ECO_ATTR_UV))
		return "has other attributes than its list says";
	for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
		if (!(list->attributes & values[k].attribute))
			continue;
		const uint32_t at = eco_list_extra_at(list, values[k].attribute);
		for (uint32_t i = 0; i < e->element_count; i++) {
			int32_t value = e->extra[(size_t)e->extra_count * i + at];
			if (value < 0 || value >= values[k].count)
				return values[k].fault;
		}
	}
	for (uint32_t i = 0; (instances || splats) && i < e->element_count; i++) {
		const int32_t *extra = e->extra + (size_t)e->extra_count * i;
		if (splats && !eco_splat_good(extra + eco_list_extra_at(list, ECO_ATTR_SPLAT)))
			return "has a splat code that does not exist";
		if (instances && extra[eco_list_extra_at(list, ECO_ATTR_PLACE) + 1] <= 0)
			return "has an impossible scale";
	}
	return NULL;
}

uint32_t eco_ladder_front(const struct eco_scene *scene, const struct eco_ladder *ladder,
	uint32_t lists[ECO_FRONT_MAX])
{
	const struct eco_plant *plant = &scene->plants[ladder->plant];
	const struct eco_ladder *all = scene->ladders + plant->ladder_first;
	uint32_t first = 0, count = 0;
	while (first < plant->ladder_count && all[first].triangles != ladder->triangles)
		first++;
	for (uint32_t i = first + 1; i < plant->ladder_count && count < ECO_FRONT_MAX; i++)
		if (all[i].flags & ECO_LADDER_NEAR && all[i].organ == all[first].organ
				&& all[i].triangles != ECO_NONE
				&& scene->lists[all[i].triangles].image == scene->lists[ladder->triangles].image)
			lists[count++] = all[i].triangles;
	return count;
}

const struct eco_group *eco_list_groups(const struct eco_scene *scene, uint32_t list)
{
	const struct eco_tile *tile = &scene->tiles[scene->lists[list].owner];
	const struct eco_group *group = scene->groups + tile->group_first, *end = group + tile->group_count;
	while (group < end && group->list != list)
		group++;
	assert(group < end);
	return group;
}

uint16_t eco_place_turn(const int32_t at[3])
{
	return (uint16_t)(eco_random_slot((uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]) >> 26 << 10);
}

struct eco_place eco_place_of(const struct eco_list *list, const struct eco_elements *instances, uint32_t index)
{
	const int32_t *position, *extra;
	assert(index < instances->element_count && instances->extra_count == eco_list_extra_count(list));
	position = instances->position + 3 * (size_t)index;
	extra = instances->extra + (size_t)instances->extra_count * index;
	uint8_t tint = list->attributes & ECO_ATTR_COLOR ? (uint8_t)*extra++ : 0,
		width = list->attributes & ECO_ATTR_WIDTH ? (uint8_t)*extra++ : 0;
	return (struct eco_place){
		.position = { position[0], position[1], position[2] },
		.turn = (uint16_t)extra[0],
		.width = width,
		.tint = tint,
		.scale = (uint32_t)extra[1],
	};
}

float eco_growth(uint32_t code, float scale)
{
	static const float factor[ECO_GROWTHS] = { 0, 0.06f, 0.16f, 0.35f, 0.6f, 1, 1.6f, 2.6f };
	return scale > 1 ? 1 + (scale - 1) * factor[code < ECO_GROWTHS ? code : ECO_GROWTH_PLAIN] : scale;
}

float eco_size(uint32_t code)
{
	static const float quarter[4] = { 1, 1.189207115f, 1.414213562f, 1.681792831f };
	uint32_t whole = (code < ECO_SIZES ? code : ECO_SIZES - 1) / 4;
	return ldexpf(quarter[code % 4], (int)whole - (int)(ECO_SIZE_ONE / 4));
}

float eco_few_bits(float v)
{
	int exponent;
	float fraction = frexpf(v, &exponent);
	return isfinite(v) ? ldexpf(floorf(fraction * 1024 + 0.5f), exponent - 10) : v;
}

/* The mean square is 1/3 for normals in all directions, 1 for level leaves. */
uint8_t eco_level_code(double mean_square)
{
	double share = (3 * mean_square - 1) / 2;
	return (uint8_t)(1.5 + 254 * (share > 0 ? share < 1 ? share : 1 : 0));
}

double eco_level_share(uint8_t code)
{
	return code ? (code - 1) / 254.0 : ECO_LEVEL_USUAL;
}
