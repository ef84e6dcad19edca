/* The steps after every reader of models: drops and counts triangles that cover nothing, applies rules
 * about parts (model_parts.c), puts the plant on its foot and to its height (model_stand.c), and removes
 * unused data. */
#include "ecofiles/import/model/model_clean.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/model/import_model.h"
#include "ecofiles/base/random.h"
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/import/model/model_parts.h"
#include "ecofiles/import/model/model_spare.h"

/* ---- Triangles ---- */

struct clean {
	struct eco_model *model;
	/* per vertex: the first vertex at its position; ECO_NONE: not finite */
	uint32_t *place;
	uint32_t *table, mask;               /* open addressing, ECO_NONE is free */
};

static bool table_new(struct clean *c, uint32_t entries)
{
	size_t size = 16;
	while (size < (size_t)entries * 2)
		size *= 2;
	c->table = malloc(size * sizeof *c->table);
	c->mask = (uint32_t)(size - 1);
	if (c->table)
		memset(c->table, 0xff, size * sizeof *c->table);
	return c->table;
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

static void corner_places(const struct clean *c, uint32_t triangle, uint32_t places[3])
{
	for (int k = 0; k < 3; k++)
		places[k] = c->place[c->model->index[(size_t)triangle * 3 + k]];
}

/* Whether a triangle at the places of `triangle` was seen before in its material; if not, remembers it as
 * number `kept`. */
static bool is_duplicate(struct clean *c, const uint32_t corners[3], uint32_t material, uint32_t kept)
{
	uint32_t sorted[3] = { corners[0], corners[1], corners[2] }, slot;
	sort3(sorted);
	slot = eco_random_slot(sorted[0], sorted[1], sorted[2] ^ (material * 0x85ebca6bu)) & c->mask;
	for (; c->table[slot] != ECO_NONE; slot = (slot + 1) & c->mask) {
		uint32_t other[3];
		corner_places(c, c->table[slot], other);
		sort3(other);
		if (memcmp(other, sorted, sizeof sorted) == 0 && c->model->material[c->table[slot]]
				== material)
			return true;
	}
	c->table[slot] = kept;
	return false;
}

static enum eco_drop judge(struct clean *c, uint32_t triangle, uint32_t kept)
{
	const uint32_t *v = &c->model->index[(size_t)triangle * 3];
	uint32_t places[3];
	if (v[0] >= c->model->vertex_count || v[1] >= c->model->vertex_count
			|| v[2] >= c->model->vertex_count)
		return ECO_DROP_BAD_INDEX;
	for (int k = 0; k < 3; k++) {
		places[k] = c->place[v[k]];
		if (places[k] == ECO_NONE)
			return ECO_DROP_NOT_FINITE;
	}
	if (places[0] == places[1] || places[1] == places[2] || places[2] == places[0]
			|| !(eco_triangle_area(c->model, triangle) > 0))
		return ECO_DROP_DEGENERATE;
	return is_duplicate(c, places, c->model->material[triangle], kept) ? ECO_DROP_DUPLICATE
		: ECO_DROP_COUNT;
}

static bool drop_triangles(struct clean *c)
{
	struct eco_model *m = c->model;
	uint32_t kept = 0;
	if (!table_new(c, m->triangle_count))
		return false;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		enum eco_drop why = judge(c, i, kept);
		if (why != ECO_DROP_COUNT) {
			m->dropped[why]++;
			continue;
		}
		memmove(&m->index[(size_t)kept * 3], &m->index[(size_t)i * 3], 3 * sizeof *m->index);
		if (m->part)
			m->part[kept] = m->part[i];
		m->material[kept++] = m->material[i];
	}
	m->triangle_count = kept;
	free(c->table);
	c->table = NULL;
	return true;
}

/* ---- Removing unused data ---- */

/* Keeps materials and images in use. `used` has room for all of either. */
static void compact_materials(struct eco_model *m, uint32_t *used)
{
	uint32_t kept = 0;
	memset(used, 0xff, ((size_t)m->material_count + 1) * sizeof *used);
	for (uint32_t i = 0; i < m->triangle_count; i++)
		used[m->material[i]] = 0;
	for (uint32_t i = 0; i < m->material_count; i++)
		if (used[i] != ECO_NONE) {
			m->materials[kept] = m->materials[i];
			used[i] = kept++;
		}
	for (uint32_t i = 0; i < m->triangle_count; i++)
		m->material[i] = used[m->material[i]];
	m->material_count = kept;
	memset(used, 0xff, ((size_t)m->image_count + 1) * sizeof *used);
	for (uint32_t i = 0; i < m->material_count; i++)
		if (m->materials[i].image != ECO_NONE)
			used[m->materials[i].image] = 0;
	kept = 0;
	for (uint32_t i = 0; i < m->image_count; i++) {
		if (used[i] == ECO_NONE) {
			free(m->images[i].rgba);
			continue;
		}
		m->images[kept] = m->images[i];
		used[i] = kept++;
	}
	for (uint32_t i = 0; i < m->material_count; i++)
		if (m->materials[i].image != ECO_NONE)
			m->materials[i].image = used[m->materials[i].image];
	m->image_count = kept;
}

/* Keeps parts in use. */
static void compact_parts(struct eco_model *m, uint32_t *used)
{
	uint32_t kept = 0;
	if (!m->part)
		return;
	memset(used, 0xff, ((size_t)m->part_count + 1) * sizeof *used);
	for (uint32_t i = 0; i < m->triangle_count; i++)
		used[m->part[i]] = 0;
	for (uint32_t i = 0; i < m->part_count; i++)
		if (used[i] != ECO_NONE) {
			m->parts[kept] = m->parts[i];
			used[i] = kept++;
		}
	for (uint32_t i = 0; i < m->triangle_count; i++)
		m->part[i] = used[m->part[i]];
	m->part_count = kept;
}

/* Keeps vertices in use. */
static void compact(struct clean *c)
{
	struct eco_model *m = c->model;
	uint32_t kept = 0, *new_index = c->place;    /* places are not needed any more */
	memset(new_index, 0xff, (size_t)m->vertex_count * sizeof *new_index);
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++)
		new_index[m->index[i]] = 0;
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		if (new_index[i] == ECO_NONE)
			continue;
		memmove(&m->position[(size_t)kept * 3], &m->position[(size_t)i * 3], 3 * sizeof *m->position);
		if (m->uv)
			memmove(&m->uv[(size_t)kept * 2], &m->uv[(size_t)i * 2], 2 * sizeof *m->uv);
		new_index[i] = kept++;
	}
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++)
		m->index[i] = new_index[m->index[i]];
	m->vertex_count = kept;
}

static void note_dropped(const struct eco_model *m, struct eco_notes *notes)
{
	if (m->dropped[ECO_DROP_BAD_INDEX] > 0)
		eco_note(notes, "%u triangles name vertices that the file does not have: left out",
			m->dropped[ECO_DROP_BAD_INDEX]);
	if (m->dropped[ECO_DROP_NOT_FINITE] > 0)
		eco_note(notes, "%u triangles have coordinates that are no numbers (NaN, infinite): left out",
			m->dropped[ECO_DROP_NOT_FINITE]);
}

/* Says why most of them went. */
static enum eco_code none_left(const struct eco_model *m, const char *what, struct eco_error *error)
{
	int most = 0;
	for (int i = 1; i < ECO_DROP_COUNT; i++)
		if (m->dropped[i] > m->dropped[most])
			most = i;
	return eco_fail(error, ECO_BAD_INPUT, "%.300s: none of its %u triangles can be drawn (%s); is the file "
		"whole?", what, m->triangles_in, eco_drop_names[most]);
}

static uint32_t largest(uint32_t a, uint32_t b, uint32_t c)
{
	a = a > b ? a : b;
	return a > c ? a : c;
}

enum eco_code eco_model_clean(struct eco_model *model, const struct eco_model_frame *frame,
	const struct eco_model_options *options, const char *what, struct eco_notes *notes,
	struct eco_error *error)
{
	struct clean c = { .model = model };
	enum eco_code code = ECO_OK;
	uint32_t *used =
		malloc(((size_t)largest(model->material_count, model->image_count, model->part_count) + 1)
		* sizeof *used);
	uint64_t accounted = 0;
	c.place = malloc(((size_t)model->vertex_count + 1) * sizeof *c.place);
	if (!used || !c.place || !eco_model_places(model, c.place) || !drop_triangles(&c))
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", what);
	else if (model->triangle_count == 0)
		code = none_left(model, what, error);
	if (!code) {
		note_dropped(model, notes);
		eco_model_drop_spare(model, options->rules, options->rule_count, notes);
		if (!eco_model_drop_sheet(model, c.place, options->rules, options->rule_count, notes))
			code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", what);
	}
	if (!code)
		code = eco_model_apply_rules(model, c.place, options->rules, options->rule_count, what, notes,
			error);
	if (!code)
		code = eco_model_stand(model, c.place, frame, options, what, notes, error);
	if (!code) {
		compact(&c);
		compact_materials(model, used);
		compact_parts(model, used);
	}
	free(used);
	free(c.table);
	free(c.place);
	if (code)
		return code;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += model->dropped[i];
	assert(accounted + model->triangle_count == model->triangles_in);
	return ECO_OK;
}
