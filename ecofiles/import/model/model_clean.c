/* The steps after every reader of models: drops and counts triangles that cover nothing, and what a file
 * of a game holds beside the plant that it shows (coarser levels of detail, shapes to collide with, the
 * ground that it was made on), applies rules about parts (model_parts.c), puts the plant on its foot and
 * to its height (model_stand.c), and removes unused data. */
#include "ecofiles/import/model/model_clean.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/base/random.h"

#define SHEET_THICK 0.002        /* of its width */
#define SHEET_FULL 0.7           /* of its box: a disc has 0.79 */
#define SHEET_AT 0.1             /* of the height, from the lower end: stems reach into the ground */
#define LIES_BESIDE 1e-3         /* of its width: so far may the rest reach beyond it */

/* ---- Triangles ---- */

void model_drop(struct eco_model *m, const uint8_t *why)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		if (why[i] != ECO_DROP_COUNT) {
			m->dropped[why[i]]++;
			continue;
		}
		memmove(&m->index[(size_t)kept * 3], &m->index[(size_t)i * 3], 3 * sizeof *m->index);
		if (m->part)
			m->part[kept] = m->part[i];
		if (m->organ)
			m->organ[kept] = m->organ[i];
		if (m->importance)
			m->importance[kept] = m->importance[i];
		m->material[kept++] = m->material[i];
	}
	m->triangle_count = kept;
}

static void sort3(uint32_t v[3])
{
	for (int i = 0; i < 3; i++) {
		int a = i == 1 ? 1 : 0;
		if (v[a] > v[a + 1]) {
			uint32_t t = v[a];
			v[a] = v[a + 1];
			v[a + 1] = t;
		}
	}
}

/* The places of a triangle's corners, ascending; false: one is none. */
static bool corner_places(const struct model_clean *c, uint32_t triangle, uint32_t places[3])
{
	for (int k = 0; k < 3; k++)
		places[k] = c->place[c->model->index[(size_t)triangle * 3 + k]];
	sort3(places);
	return places[2] != ECO_NONE;
}

/* Whether a triangle at these places was seen before in its material; if not, remembers it. */
static bool is_duplicate(const struct model_clean *c, const uint32_t places[3], uint32_t triangle,
	uint32_t *table, uint32_t mask)
{
	const uint32_t *material = c->model->material;
	uint32_t slot =
		eco_random_slot(places[0], places[1], places[2] ^ (material[triangle] * 0x85ebca6bu)) & mask;
	for (; table[slot] != ECO_NONE; slot = (slot + 1) & mask) {
		uint32_t other[3];
		corner_places(c, table[slot], other);
		if (memcmp(other, places, sizeof other) == 0 && material[table[slot]] == material[triangle])
			return true;
	}
	table[slot] = triangle;
	return false;
}

static enum eco_drop judge(const struct model_clean *c, uint32_t triangle, uint32_t *table, uint32_t mask)
{
	const uint32_t *v = &c->model->index[(size_t)triangle * 3];
	uint32_t places[3], vertices = c->model->vertex_count;
	if (v[0] >= vertices || v[1] >= vertices || v[2] >= vertices)
		return ECO_DROP_BAD_INDEX;
	if (!corner_places(c, triangle, places))
		return ECO_DROP_NOT_FINITE;
	if (places[0] == places[1] || places[1] == places[2] || !(eco_triangle_area(c->model, triangle) > 0))
		return ECO_DROP_DEGENERATE;
	return is_duplicate(c, places, triangle, table, mask) ? ECO_DROP_DUPLICATE : ECO_DROP_COUNT;
}

static enum eco_code drop_triangles(struct model_clean *c)
{
	struct eco_model *m = c->model;
	uint32_t mask, *table = model_table_new(m->triangle_count, &mask);
	int most = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++)
		c->why[i] = (uint8_t)judge(c, i, table, mask);
	free(table);
	model_drop(m, c->why);
	for (int i = 1; i < ECO_DROP_COUNT; i++)
		most = m->dropped[i] > m->dropped[most] ? i : most;
	if (m->triangle_count == 0)
		return eco_fail(c->error, ECO_BAD_INPUT,
			"%.300s: none of its %u triangles can be drawn (%s); is the file whole?",
			c->what, m->triangles_in, eco_drop_names[most]);
	if (m->dropped[ECO_DROP_BAD_INDEX] > 0)
		eco_note(c->notes, "%u triangles name vertices that the file does not have: left out",
			m->dropped[ECO_DROP_BAD_INDEX]);
	if (m->dropped[ECO_DROP_NOT_FINITE] > 0)
		eco_note(c->notes,
			"%u triangles have coordinates that are no numbers (NaN, infinite): left out",
			m->dropped[ECO_DROP_NOT_FINITE]);
	return ECO_OK;
}

/* ---- Levels of detail, shapes for collisions, ground ---- */

static bool is_ruled(const char *name, const struct eco_model_options *o)
{
	for (uint32_t i = 0; i < o->rule_count; i++)
		if (o->rules[i].kind == ECO_PART_NAME && eco_part_name_fits(o->rules[i].name, name))
			return true;
	return false;
}

/* The level of each part that a triangle has, ECO_SPARE_NONE where it is to stay. */
static void find_levels(const struct eco_model *m, const struct eco_model_options *options, int *level)
{
	int finest = ECO_SPARE_CARD;
	for (uint32_t i = 0; i < m->part_count; i++) {
		level[i] = is_ruled(m->parts[i].name, options) ? ECO_SPARE_NONE
			: eco_model_spare_level(m->parts[i].name);
		finest = level[i] >= 0 && level[i] < finest ? level[i] : finest;
	}
	/* without levels a billboard is the plant */
	for (uint32_t i = 0; i < m->part_count; i++)
		level[i] = level[i] == finest ? ECO_SPARE_NONE : level[i];
}

/* Drops all parts but those of the finest level, unless a rule names them or nothing would be left. */
static void drop_spare(struct model_clean *c)
{
	struct eco_model *m = c->model;
	char names[200] = "";
	uint32_t spare = 0;
	int *level = eco_alloc(m->part_count + 1u, sizeof *level);
	find_levels(m, c->options, level);
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		bool goes = m->part && level[m->part[i]] != ECO_SPARE_NONE;
		c->why[i] = goes ? ECO_DROP_LEFT_OUT : ECO_DROP_COUNT;
		spare += goes;
	}
	if (spare > 0 && spare < m->triangle_count) {
		for (uint32_t i = 0; i < m->part_count; i++)
			if (level[i] != ECO_SPARE_NONE)
				eco_phrase_add(names, sizeof names, m->parts[i].name);
		eco_note(c->notes,
			"%u triangles of coarser levels of detail or shapes for collisions are left "
			"out: %s; name them in \"parts\" if they are the plant's",
			spare, names);
		model_drop(m, c->why);
	}
	free(level);
}

static double spread_of(const struct eco_component *c)
{
	return (c->high[0] - c->low[0]) * (c->high[1] - c->low[1]);
}

/* The widest component, if it is level and all else stands on it; all->count: it is not. */
static uint32_t find_sheet(const struct eco_components *all)
{
	struct eco_bounds rest = ECO_NO_BOUNDS;
	uint32_t at = 0;
	for (uint32_t i = 1; i < all->count; i++)
		at = spread_of(&all->items[i]) > spread_of(&all->items[at]) ? i : at;
	for (uint32_t i = 0; i < all->count; i++)
		if (i != at) {
			eco_bounds_add(&rest, all->items[i].low);
			eco_bounds_add(&rest, all->items[i].high);
		}
	const struct eco_component *c = &all->items[at];
	double wide = c->high[0] - c->low[0], deep = c->high[1] - c->low[1],
		height = rest.high[2] - c->low[2];
	bool stand = height > 0 && c->high[2] - c->low[2] <= SHEET_THICK * fmin(wide, deep)
		&& c->area >= SHEET_FULL * wide * deep && c->high[2] <= rest.low[2] + SHEET_AT * height;
	for (int k = 0; k < 2; k++) {
		double beside = LIES_BESIDE * (k ? deep : wide);
		stand = stand && rest.low[k] >= c->low[k] - beside && rest.high[k] <= c->high[k] + beside;
	}
	return all->count > 1 && stand ? at : all->count;
}

/* Drops the level sheet at the foot that all else stands on, unless a rule names its part. */
static void drop_sheet(struct model_clean *c)
{
	struct eco_model *m = c->model;
	struct eco_components all;
	eco_components_find(&all, m, c->place, true);
	uint32_t at = find_sheet(&all);
	const char *name = at < all.count && m->part ? m->parts[m->part[all.items[at].first]].name : "";
	if (at < all.count && !is_ruled(name, c->options)) {
		eco_note(c->notes,
			"its level sheet of ground (%u triangles of part \"%s\") is left out, as "
			"the scene has a ground; name it in \"parts\" if it is the plant's",
			all.items[at].triangle_count, name);
		for (uint32_t i = 0; i < m->triangle_count; i++)
			c->why[i] = all.of[i] == at ? ECO_DROP_LEFT_OUT : ECO_DROP_COUNT;
		model_drop(m, c->why);
	}
	eco_components_free(&all);
}

/* ---- Unused data ---- */

/* Marks the items that a list of numbers names, at `stride` from each other. */
static void mark_used(uint32_t *used, uint32_t items, const uint32_t *of, size_t count, size_t stride)
{
	memset(used, 0xff, ((size_t)items + 1) * sizeof *used);
	for (size_t i = 0; of && i < count; i++) {
		uint32_t item = *(const uint32_t *)((const char *)of + i * stride);
		if (item != ECO_NONE)
			used[item] = 0;
	}
}

/* Moves the items in use up, and renumbers them in the list. Returns how many there are. */
static uint32_t compact(uint32_t *used, void *items, uint32_t item_count, size_t size, uint32_t *of,
	size_t count)
{
	uint32_t kept = 0;
	mark_used(used, item_count, of, count, sizeof *of);
	for (uint32_t i = 0; i < item_count; i++)
		if (used[i] != ECO_NONE) {
			memmove((char *)items + kept * size, (char *)items + i * size, size);
			used[i] = kept++;
		}
	for (size_t i = 0; i < count; i++)
		of[i] = used[of[i]];
	return kept;
}

/* Keeps vertices, materials, images and parts in use. `used` has room for all of any. */
static void remove_unused(struct eco_model *m, uint32_t *used)
{
	const size_t triangles = m->triangle_count;
	uint32_t kept = 0;
	m->material_count =
		compact(used, m->materials, m->material_count, sizeof *m->materials, m->material, triangles);
	if (m->part)
		m->part_count = compact(used, m->parts, m->part_count, sizeof *m->parts, m->part, triangles);
	mark_used(used, m->image_count, m->material_count ? &m->materials->image : NULL, m->material_count,
		sizeof *m->materials);
	for (uint32_t i = 0; i < m->image_count; i++)
		used[i] = used[i] == ECO_NONE ? ECO_NONE : i;
	eco_images_keep(m, used);
	mark_used(used, m->vertex_count, m->index, 3 * triangles, sizeof *m->index);
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		if (used[i] == ECO_NONE)
			continue;
		memmove(&m->position[(size_t)kept * 3], &m->position[(size_t)i * 3], 3 * sizeof *m->position);
		if (m->uv)
			memmove(&m->uv[(size_t)kept * 2], &m->uv[(size_t)i * 2], 2 * sizeof *m->uv);
		used[i] = kept++;
	}
	for (size_t i = 0; i < 3 * triangles; i++)
		m->index[i] = used[m->index[i]];
	m->vertex_count = kept;
}

enum eco_code eco_model_clean(struct eco_model *model, const struct eco_model_frame *frame,
	const struct eco_model_options *options, const char *what, struct eco_notes *notes,
	struct eco_error *error)
{
	size_t numbers =
		(size_t)model->vertex_count + model->material_count + model->image_count + model->part_count;
	struct model_clean c = { .model = model,
		.frame = frame,
		.options = options,
		.what = what,
		.notes = notes,
		.error = error,
		.place = eco_alloc(numbers + 1, sizeof *c.place),
		.why = eco_alloc((size_t)model->triangle_count + 1, 1) };
	uint64_t accounted = 0;
	eco_model_places(model, c.place);
	enum eco_code code = drop_triangles(&c);
	if (!code) {
		if (!options->object) {
			drop_spare(&c);
			drop_sheet(&c);
		}
		code = model_apply_rules(&c);
	}
	if (!code)
		code = model_stand(&c);
	if (!code)
		remove_unused(model, c.place);
	free(c.place);
	free(c.why);
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += model->dropped[i];
	assert(code || accounted + model->triangle_count == model->triangles_in);
	return code;
}
