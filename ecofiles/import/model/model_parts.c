/* Components are found by joining triangles that share a place. For each material, part and component, the
 * first rule that fits is found once; a triangle takes the earliest of its three. */
#include "ecofiles/import/model/model_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/model/import_model.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/union.h"
#include "ecofiles/base/utf8.h"
#include "ecofiles/import/model/model_import.h"

#define COORDINATE_MAX 1e9f

/* ---- Places ---- */

/* Free slots are ECO_NONE. NULL when memory ran out. */
static uint32_t *table_new(uint64_t entries, uint32_t *mask)
{
	size_t size = 16;
	while (size < entries * 2)
		size *= 2;
	uint32_t *table = malloc(size * sizeof *table);
	if (table)
		memset(table, 0xff, size * sizeof *table);
	*mask = (uint32_t)(size - 1);
	return table;
}

static bool vertex_fits(const float *p)
{
	return fabsf(p[0]) <= COORDINATE_MAX && fabsf(p[1]) <= COORDINATE_MAX
		&& fabsf(p[2]) <= COORDINATE_MAX;
}

bool eco_model_places(struct eco_model *m, uint32_t *place)
{
	uint32_t mask, *table = table_new(m->vertex_count, &mask);
	if (!table)
		return false;
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		float *p = &m->position[(size_t)i * 3];
		uint32_t bits[3], slot;
		place[i] = ECO_NONE;
		if (!vertex_fits(p))
			continue;
		for (int k = 0; k < 3; k++)
			p[k] += 0.0f;                /* -0 is 0 */
		memcpy(bits, p, sizeof bits);
		slot = eco_random_slot(bits[0], bits[1], bits[2]) & mask;
		while (table[slot] != ECO_NONE
				&& memcmp(&m->position[(size_t)table[slot] * 3], p, sizeof bits) != 0)
			slot = (slot + 1) & mask;
		if (table[slot] == ECO_NONE)
			table[slot] = i;
		place[i] = table[slot];
	}
	free(table);
	return true;
}

/* ---- Components ---- */

double eco_triangle_area(const struct eco_model *m, uint32_t triangle)
{
	const uint32_t *v = &m->index[(size_t)triangle * 3];
	double a[3], b[3], x, y, z;
	for (int k = 0; k < 3; k++) {
		a[k] = (double)m->position[(size_t)v[1] * 3 + (size_t)k]
			- m->position[(size_t)v[0] * 3 + (size_t)k];
		b[k] = (double)m->position[(size_t)v[2] * 3 + (size_t)k]
			- m->position[(size_t)v[0] * 3 + (size_t)k];
	}
	x = a[1] * b[2] - a[2] * b[1];
	y = a[2] * b[0] - a[0] * b[2];
	z = a[0] * b[1] - a[1] * b[0];
	return sqrt(x * x + y * y + z * z) / 2;
}

double eco_component_diagonal(const struct eco_component *c)
{
	double square = 0;
	for (int k = 0; k < 3; k++)
		square += (c->high[k] - c->low[k]) * (c->high[k] - c->low[k]);
	return sqrt(square);
}

/* Joins triangles that share a place; a set's root is its first triangle. */
static bool join_triangles(const struct eco_model *m, const uint32_t *place, bool by_material,
	uint32_t *parent)
{
	uint32_t mask, *table = table_new((uint64_t)m->triangle_count * 3, &mask);
	if (!table)
		return false;
	for (uint32_t i = 0; i < m->triangle_count; i++)
		parent[i] = i;
	for (uint32_t corner = 0; corner < m->triangle_count * 3; corner++) {
		uint32_t at = place[m->index[corner]], material = by_material ? m->material[corner / 3] : 0,
			slot, a, b;
		slot = eco_random_slot(at, material, 0) & mask;
		while (table[slot] != ECO_NONE && (place[m->index[table[slot]]] != at
			|| (by_material && m->material[table[slot] / 3] != material)))
			slot = (slot + 1) & mask;
		if (table[slot] == ECO_NONE) {
			table[slot] = corner;
			continue;
		}
		a = eco_union_root(parent, table[slot] / 3);
		b = eco_union_root(parent, corner / 3);
		parent[a > b ? a : b] = a > b ? b : a;
	}
	free(table);
	return true;
}

static void add_to(struct eco_component *c, const struct eco_model *m, uint32_t triangle)
{
	for (int i = 0; i < 9; i++) {
		double p = m->position[(size_t)m->index[(size_t)triangle * 3 + (size_t)(i / 3)] * 3
			+ (size_t)(i % 3)];
		bool first = c->triangle_count == 0 && i < 3;
		c->low[i % 3] = first ? p : fmin(c->low[i % 3], p);
		c->high[i % 3] = first ? p : fmax(c->high[i % 3], p);
	}
	if (c->triangle_count++ == 0)
		c->first = triangle;
	c->area += eco_triangle_area(m, triangle);
}

static int by_falling_area(const void *a, const void *b)
{
	const struct eco_component *p = a, *q = b;
	if (p->area != q->area)
		return p->area > q->area ? -1 : 1;
	return p->first < q->first ? -1 : p->first > q->first;
}

static bool list_components(struct eco_components *c, const struct eco_model *m, uint32_t *parent)
{
	uint32_t *number = malloc(((size_t)m->triangle_count + 1) * sizeof *number);
	c->count = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++)
		c->count += parent[i] == i;
	c->items = calloc((size_t)c->count + 1, sizeof *c->items);
	if (!number || !c->items) {
		free(number);
		return false;
	}
	c->count = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		uint32_t root = eco_union_root(parent, i);
		if (root == i)
			number[i] = c->count++;
		add_to(&c->items[number[root]], m, i);
	}
	qsort(c->items, c->count, sizeof *c->items, by_falling_area);
	for (uint32_t i = 0; i < c->count; i++)
		number[c->items[i].first] = i;
	for (uint32_t i = 0; i < m->triangle_count; i++)
		c->of[i] = number[eco_union_root(parent, i)];
	free(number);
	return true;
}

bool eco_components_find(struct eco_components *c, const struct eco_model *m, const uint32_t *place,
	bool by_material)
{
	uint32_t *parent = malloc(((size_t)m->triangle_count + 1) * sizeof *parent);
	*c = (struct eco_components){ .of = malloc(((size_t)m->triangle_count + 1) * sizeof *c->of) };
	bool good = parent && c->of && join_triangles(m, place, by_material, parent)
		&& list_components(c, m, parent);
	free(parent);
	if (!good)
		eco_components_free(c);
	return good;
}

void eco_components_free(struct eco_components *c)
{
	free(c->of);
	free(c->items);
	*c = (struct eco_components){ .count = 0 };
}

/* ---- Names ---- */

/* The next character in lower case (Latin, Greek, Cyrillic), 0 at `end`; bytes that are not UTF-8 are
 * returned as they are. */
static uint32_t next_letter(const char **at, const char *end)
{
	const unsigned char *p = (const unsigned char *)*at;
	size_t bytes = eco_utf8_bytes(*at, (size_t)(end - *at));
	if (*at >= end)
		return 0;
	uint32_t c = bytes > 1 ? *p & (0x7fu >> bytes) : *p;
	for (size_t i = 1; i < bytes; i++)
		c = c << 6 | (p[i] & 0x3fu);
	*at += bytes > 0 ? bytes : 1;
	if ((c >= 'A' && c <= 'Z') || (c >= 0xc0 && c <= 0xde && c != 0xd7) || (c >= 0x391 && c <= 0x3a9)
			|| (c >= 0x410 && c <= 0x42f))
		return c + 32;
	return c >= 0x400 && c <= 0x40f ? c + 80 : c >= 0x100 && c < 0x180 ? c | 1 : c;
}

static bool fits(const char *pattern, const char *pattern_end, const char *name, const char *name_end)
{
	const char *star = NULL, *retry = NULL;
	for (;;) {
		const char *p = pattern, *n = name;
		uint32_t wanted = next_letter(&p, pattern_end), have = next_letter(&n, name_end);
		if (wanted == '*') {
			star = pattern = p;
			retry = name;
		} else if (wanted == have || (wanted == '?' && have != 0)) {
			if (have == 0)
				return true;
			pattern = p;
			name = n;
		} else if (star && retry < name_end) {
			next_letter(&retry, name_end);
			pattern = star;
			name = retry;
		} else {
			return false;
		}
	}
}

bool eco_part_name_fits(const char *pattern, const char *name)
{
	const char *pattern_end = pattern + strlen(pattern), *end = name + strlen(name);
	if (fits(pattern, pattern_end, name, end))
		return true;
	for (const char *from = name, *to; strchr(name, '/') && from <= end; from = to + 1) {
		to = strchrnul(from, '/');
		if (fits(pattern, pattern_end, from, to))
			return true;
	}
	return false;
}

/* ---- Rules ---- */

struct rules {
	struct eco_model *model;
	const struct eco_part_rule *rules;
	uint32_t count;
	bool *fitted;                /* per rule: whether it fits anything */
	uint32_t *of_material, *of_part, *of_component;      /* the first rule that fits, or ECO_NONE */
	struct eco_components components;
	double diagonal;             /* of the whole model */
	uint8_t *importance;         /* per rule: its number in model->importances */
};

static uint32_t rule_of_name(struct rules *r, const char *name)
{
	uint32_t first = ECO_NONE;
	for (uint32_t i = 0; i < r->count; i++) {
		if (r->rules[i].kind != ECO_PART_NAME || !eco_part_name_fits(r->rules[i].name, name))
			continue;
		r->fitted[i] = true;
		first = first == ECO_NONE ? i : first;
	}
	return first;
}

static uint32_t rule_of_component(struct rules *r, uint32_t component)
{
	double size = r->diagonal > 0 ? eco_component_diagonal(&r->components.items[component]) / r->diagonal
		: 0;
	uint32_t first = ECO_NONE;
	for (uint32_t i = 0; i < r->count; i++) {
		const struct eco_part_rule *rule = &r->rules[i];
		if ((rule->kind == ECO_PART_COMPONENT && rule->component == component + 1)
			|| (rule->kind == ECO_PART_SIZE && size >= rule->size[0] && size <= rule->size[1])) {
			r->fitted[i] = true;
			first = first == ECO_NONE ? i : first;
		}
	}
	return first;
}

static void measure_all(struct rules *r)
{
	struct eco_component all = { .area = 0 };
	for (uint32_t i = 0; i < r->components.count; i++)
		for (int k = 0; k < 3; k++) {
			all.low[k] = i == 0 ? r->components.items[i].low[k]
				: fmin(all.low[k], r->components.items[i].low[k]);
			all.high[k] = i == 0 ? r->components.items[i].high[k]
				: fmax(all.high[k], r->components.items[i].high[k]);
		}
	r->diagonal = eco_component_diagonal(&all);
}

/* Finds the first rule of each material, part and component; names count only if a triangle has them. */
static bool match_all(struct rules *r, const uint32_t *place)
{
	const struct eco_model *m = r->model;
	r->fitted = calloc((size_t)r->count + 1, sizeof *r->fitted);
	r->of_material = malloc(((size_t)m->material_count + 1) * sizeof *r->of_material);
	r->of_part = malloc(((size_t)m->part_count + 1) * sizeof *r->of_part);
	if (!r->fitted || !r->of_material || !r->of_part
			|| !eco_components_find(&r->components, m, place, true))
		return false;
	r->of_component = malloc(((size_t)r->components.count + 1) * sizeof *r->of_component);
	if (!r->of_component)
		return false;
	measure_all(r);
	memset(r->of_material, 0, ((size_t)m->material_count + 1) * sizeof *r->of_material);
	memset(r->of_part, 0, ((size_t)m->part_count + 1) * sizeof *r->of_part);
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		r->of_material[m->material[i]] = 1;
		if (m->part)
			r->of_part[m->part[i]] = 1;
	}
	for (uint32_t i = 0; i < m->material_count; i++)
		r->of_material[i] = r->of_material[i] != 0 ? rule_of_name(r, m->materials[i].name) : ECO_NONE;
	for (uint32_t i = 0; i < m->part_count; i++)
		r->of_part[i] = r->of_part[i] != 0 ? rule_of_name(r, m->parts[i].name) : ECO_NONE;
	for (uint32_t i = 0; i < r->components.count; i++)
		r->of_component[i] = rule_of_component(r, i);
	return true;
}

static uint32_t earlier(uint32_t a, uint32_t b)
{
	return a < b ? a : b;                /* ECO_NONE is the largest */
}

/* Numbers the distinct importances of the rules; false: too many. */
static bool number_importances(struct rules *r)
{
	struct eco_model *m = r->model;
	m->importance_count = 1;
	m->importances[0] = 0;
	for (uint32_t i = 0; i < r->count; i++) {
		uint32_t k = 0;
		while (k < m->importance_count && m->importances[k] != r->rules[i].importance)
			k++;
		if (k > ECO_IMPORTANCES_MAX)
			return false;
		if (k == m->importance_count)
			m->importances[m->importance_count++] = r->rules[i].importance;
		r->importance[i] = (uint8_t)k;
	}
	return true;
}

static bool apply(struct rules *r)
{
	struct eco_model *m = r->model;
	uint32_t kept = 0;
	m->organ = malloc((size_t)m->triangle_count + 1);
	m->importance = m->importance_count > 1 ? malloc((size_t)m->triangle_count + 1) : NULL;
	if (!m->organ || (m->importance_count > 1 && !m->importance))
		return false;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		uint32_t rule = earlier(r->of_material[m->material[i]], r->of_component[r->components.of[i]]);
		uint8_t is;
		if (m->part)
			rule = earlier(rule, r->of_part[m->part[i]]);
		is = rule == ECO_NONE ? ECO_ORGAN_FOUND : r->rules[rule].is;
		if (is == ECO_PART_LEFT_OUT) {
			m->dropped[ECO_DROP_LEFT_OUT]++;
			continue;
		}
		memmove(&m->index[(size_t)kept * 3], &m->index[(size_t)i * 3], 3 * sizeof *m->index);
		m->material[kept] = m->material[i];
		if (m->part)
			m->part[kept] = m->part[i];
		if (m->importance)
			m->importance[kept] = rule == ECO_NONE ? 0 : r->importance[rule];
		m->organ[kept++] = is;
	}
	m->triangle_count = kept;
	return true;
}

/* ---- Reports of rules that fit nothing ---- */

/* The first few distinct names, as a list in quotes. */
static void list_names(char *to, size_t size, const char *first, size_t stride, uint32_t count)
{
	size_t used = 0;
	uint32_t shown = 0, left = 0;
	to[0] = 0;
	for (uint32_t i = 0; i < count; i++) {
		const char *name = first + i * stride;
		bool seen = *name == 0;
		for (uint32_t k = 0; k < i && k < 1000 && !seen; k++)
			seen = strcmp(first + k * stride, name) == 0;
		if (seen)
			continue;
		if (shown == 12 || used + strlen(name) + 5 > size)
			left++;
		else
			used += (size_t)snprintf(to + used, size - used, "%s\"%s\"", shown++ > 0 ? ", " : "",
				name);
	}
	if (shown == 0)
		snprintf(to, size, "none with a name");
	else if (left > 0)
		snprintf(to + used, size - used, " and more");
}

static void note_unfitted(const struct rules *r, uint32_t i, struct eco_notes *notes)
{
	const struct eco_part_rule *rule = &r->rules[i];
	const struct eco_model *m = r->model;
	char materials[400], parts[400];
	if (rule->kind == ECO_PART_COMPONENT) {
		eco_note(notes, "the rule {\"component\": %u} fits nothing: there are %u components",
			rule->component, r->components.count);
	} else if (rule->kind == ECO_PART_SIZE) {
		eco_note(notes, "the rule {\"size\": [%g, %g]} fits nothing: no component's diagonal is "
			"that share of the whole's; ecopack model lists "
			"them", rule->size[0], rule->size[1]);
	} else {
		list_names(materials, sizeof materials, m->materials[0].name, sizeof *m->materials,
			m->material_count);
		list_names(parts, sizeof parts, m->part_count > 0 ? m->parts[0].name : "", sizeof *m->parts,
			m->part_count);
		eco_note(notes, "the rule {\"name\": \"%.100s\"} fits nothing: its materials are %s; its "
			"meshes, objects and groups are %s", rule->name, materials, parts);
	}
}

enum eco_code eco_model_apply_rules(struct eco_model *model, const uint32_t *place,
	const struct eco_part_rule *rules, uint32_t count, const char *what, struct eco_notes *notes,
	struct eco_error *error)
{
	struct rules r = { .model = model, .rules = rules, .count = count };
	enum eco_code code = ECO_OK;
	if (count == 0)
		return ECO_OK;
	r.importance = malloc((size_t)count + 1);
	if (r.importance && !number_importances(&r))
		code = eco_fail(error, ECO_TOO_LARGE, "%.300s: the rules in \"parts\" give more than %u "
			"different importances", what, ECO_IMPORTANCES_MAX);
	else if (!r.importance || !match_all(&r, place) || !apply(&r))
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory for the rules about its parts",
			what);
	for (uint32_t i = 0; code == ECO_OK && i < count; i++)
		if (!r.fitted[i])
			note_unfitted(&r, i, notes);
	if (code == ECO_OK && model->triangle_count == 0)
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: the rules in \"parts\" leave out all of it",
			what);
	eco_components_free(&r.components);
	free(r.importance);
	free(r.fitted);
	free(r.of_material);
	free(r.of_part);
	free(r.of_component);
	return code;
}
