/* Components are found by joining triangles that share a place. For each material, part and component, the
 * first rule that fits is found once; a triangle takes the earliest of its three. */
#include "ecofiles/import/model/model_clean.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/text.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/union.h"

#define COORDINATE_MAX 1e9f
#define NAME_BYTES 512u              /* of patterns and names, folded; longer ones are cut */

/* ---- Places ---- */

uint32_t *model_table_new(uint64_t entries, uint32_t *mask)
{
	size_t size = 16;
	while (size < entries * 2)
		size *= 2;
	uint32_t *table = eco_alloc(size, sizeof *table);
	memset(table, 0xff, size * sizeof *table);
	*mask = (uint32_t)(size - 1);
	return table;
}

static bool vertex_fits(const float *p)
{
	return fabsf(p[0]) <= COORDINATE_MAX && fabsf(p[1]) <= COORDINATE_MAX
		&& fabsf(p[2]) <= COORDINATE_MAX;
}

bool eco_triangle_usable(const struct eco_model *m, uint32_t triangle)
{
	const uint32_t *v = &m->index[(size_t)triangle * 3];
	for (int k = 0; k < 3; k++)
		if (v[k] >= m->vertex_count || !vertex_fits(m->position + 3 * (size_t)v[k]))
			return false;
	return true;
}

void eco_model_places(struct eco_model *m, uint32_t *place)
{
	uint32_t mask, *table = model_table_new(m->vertex_count, &mask);
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
static void join_triangles(const struct eco_model *m, const uint32_t *place, bool by_material,
	uint32_t *parent)
{
	uint32_t mask, *table = model_table_new((uint64_t)m->triangle_count * 3, &mask);
	for (uint32_t i = 0; i < m->triangle_count; i++)
		parent[i] = i;
	for (uint32_t corner = 0; corner < m->triangle_count * 3; corner++) {
		if (!eco_triangle_usable(m, corner / 3))
			continue;
		uint32_t at = place[m->index[corner]], material = by_material ? m->material[corner / 3] : 0;
		uint32_t slot = eco_random_slot(at, material, 0) & mask;
		while (table[slot] != ECO_NONE && (place[m->index[table[slot]]] != at
			|| (by_material && m->material[table[slot] / 3] != material)))
			slot = (slot + 1) & mask;
		if (table[slot] == ECO_NONE)
			table[slot] = corner;
		else
			eco_union_join(parent, table[slot] / 3, corner / 3);
	}
	free(table);
}

static void add_to(struct eco_component *c, const struct eco_model *m, uint32_t triangle)
{
	bool first = c->triangle_count++ == 0;
	if (first)
		c->first = triangle;
	if (!eco_triangle_usable(m, triangle))
		return;
	for (int i = 0; i < 9; i++) {
		double p = m->position[(size_t)m->index[(size_t)triangle * 3 + (size_t)(i / 3)] * 3
			+ (size_t)(i % 3)];
		c->low[i % 3] = first && i < 3 ? p : fmin(c->low[i % 3], p);
		c->high[i % 3] = first && i < 3 ? p : fmax(c->high[i % 3], p);
	}
	c->area += eco_triangle_area(m, triangle);
}

ECO_ORDER_FALLING_TWO(by_falling_area, struct eco_component, ->area, ->first)

static void list_components(struct eco_components *c, const struct eco_model *m, uint32_t *parent)
{
	uint32_t *number = eco_alloc((size_t)m->triangle_count + 1, sizeof *number);
	c->count = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++)
		c->count += parent[i] == i;
	c->items = eco_alloc((size_t)c->count + 1, sizeof *c->items);
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
}

void eco_components_find(struct eco_components *c, const struct eco_model *m, const uint32_t *place,
	bool by_material)
{
	uint32_t *parent = eco_alloc((size_t)m->triangle_count + 1, sizeof *parent);
	*c = (struct eco_components){ .of = eco_alloc((size_t)m->triangle_count + 1, sizeof *c->of) };
	join_triangles(m, place, by_material, parent);
	list_components(c, m, parent);
	free(parent);
}

void eco_components_bound(const struct eco_components *c, double low[3], double high[3])
{
	for (int k = 0; k < 3; k++) {
		low[k] = INFINITY;
		high[k] = -INFINITY;
		for (uint32_t i = 0; i < c->count; i++) {
			low[k] = fmin(low[k], c->items[i].low[k]);
			high[k] = fmax(high[k], c->items[i].high[k]);
		}
	}
}

void eco_components_free(struct eco_components *c)
{
	free(c->of);
	free(c->items);
	*c = (struct eco_components){ .count = 0 };
}

/* ---- Names ---- */

bool eco_part_name_fits(const char *pattern, const char *name)
{
	char wanted[NAME_BYTES], whole[NAME_BYTES], *rest = whole;
	eco_text_fold(pattern, wanted, sizeof wanted);
	eco_text_fold(name, whole, sizeof whole);
	bool fits = eco_text_fits(whole, wanted, '?');
	for (const char *part; !fits && (part = strsep(&rest, "/"));)
		fits = eco_text_fits(part, wanted, '?');
	return fits;
}

static bool begins_word(const char *name, const char *at)
{
	return at == name || !isalnum((unsigned char)at[-1])
		|| (islower((unsigned char)at[-1]) && isupper((unsigned char)*at));
}

static bool ends_word(const char *at) { return !isalpha((unsigned char)*at); }

/* Whether a name has a word, as a word of its own. */
static bool has_word(const char *name, const char *word)
{
	for (const char *at = name; (at = strcasestr(at, word)); at++)
		if (begins_word(name, at) && ends_word(at + strlen(word)))
			return true;
	return false;
}

/* Names of Decentraland and Unity, of Unreal, and of Godot. */
static bool is_collider(const char *name)
{
	static const char *const words[] = { "collider", "collision", "ucx", "ubx", "usp", "ucp", "colonly",
		"convcolonly" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (has_word(name, words[i]))
			return true;
	return false;
}

int eco_model_spare_level(const char *name)
{
	if (is_collider(name))
		return ECO_SPARE_COLLIDER;
	for (const char *at = name; (at = strcasestr(at, "lod")); at++) {
		const char *digits = at + 3 + (at[3] == '_' || at[3] == '-' || at[3] == ' ');
		if (begins_word(name, at) && isdigit((unsigned char)*digits) &&
			!isdigit((unsigned char)digits[1]))
			return *digits - '0';
	}
	return has_word(name, "billboard") || has_word(name, "impostor") || has_word(name, "imposter")
		? ECO_SPARE_CARD : ECO_SPARE_NONE;
}

/* ---- Rules ---- */

struct rules {
	struct eco_model *model;
	const struct eco_part_rule *rules;
	uint32_t count;
	bool *fitted;                /* per rule: whether it fits anything */
	uint8_t *importance;         /* per rule: its number in model->importances */
	uint32_t *of_material, *of_part, *of_component;      /* the first rule that fits, or ECO_NONE */
	struct eco_components components;
	double diagonal;             /* of the whole model */
};

/* The first rule that fits a name, or a component if `name` is NULL. */
static uint32_t first_rule(struct rules *r, const char *name, uint32_t component)
{
	double size = !name && r->diagonal > 0
		? eco_component_diagonal(&r->components.items[component]) / r->diagonal : 0;
	uint32_t first = ECO_NONE;
	for (uint32_t i = r->count; i-- > 0;) {
		const struct eco_part_rule *rule = &r->rules[i];
		bool fits = rule->kind == ECO_PART_NAME ? name && eco_part_name_fits(rule->name, name)
			: rule->kind == ECO_PART_COMPONENT ? !name && rule->component == component + 1
			: !name && size >= rule->size[0] && size <= rule->size[1];
		r->fitted[i] |= fits;
		first = fits ? i : first;
	}
	return first;
}

/* Finds the first rule of each material, part and component; names count only if a triangle has them. */
static void match_all(struct rules *r, const uint32_t *place)
{
	const struct eco_model *m = r->model;
	struct eco_component all;
	size_t names = (size_t)m->material_count + m->part_count;
	eco_components_find(&r->components, m, place, true);
	r->of_material = eco_alloc(names + r->components.count + 1, sizeof *r->of_material);
	r->of_part = r->of_material + m->material_count;
	r->of_component = r->of_part + m->part_count;
	eco_components_bound(&r->components, all.low, all.high);
	r->diagonal = eco_component_diagonal(&all);
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		r->of_material[m->material[i]] = 1;
		if (m->part)
			r->of_part[m->part[i]] = 1;
	}
	for (uint32_t i = 0; i < names; i++)
		r->of_material[i] = !r->of_material[i] ? ECO_NONE : first_rule(r, i < m->material_count
			? m->materials[i].name : m->parts[i - m->material_count].name, 0);
	for (uint32_t i = 0; i < r->components.count; i++)
		r->of_component[i] = first_rule(r, NULL, i);
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

static uint32_t earlier(uint32_t a, uint32_t b)
{
	return a < b ? a : b;                /* ECO_NONE is the largest */
}

static void apply(struct rules *r, uint8_t *why)
{
	struct eco_model *m = r->model;
	m->organ = eco_alloc((size_t)m->triangle_count + 1, 1);
	m->importance = m->importance_count > 1 ? eco_alloc((size_t)m->triangle_count + 1, 1) : NULL;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		uint32_t rule = earlier(earlier(r->of_material[m->material[i]],
			r->of_component[r->components.of[i]]), m->part ? r->of_part[m->part[i]] : ECO_NONE);
		m->organ[i] = rule == ECO_NONE ? ECO_ORGAN_FOUND : r->rules[rule].is;
		if (m->importance && rule != ECO_NONE)
			m->importance[i] = r->importance[rule];
		why[i] = m->organ[i] == ECO_PART_LEFT_OUT ? ECO_DROP_LEFT_OUT : ECO_DROP_COUNT;
	}
	model_drop(m, why);
}

enum eco_code model_apply_rules(struct model_clean *c)
{
	const uint32_t count = c->options->rule_count;
	struct rules r = { .model = c->model, .rules = c->options->rules, .count = count,
		.importance = eco_alloc((size_t)count + 1, 1), .fitted = eco_alloc((size_t)count + 1,
		sizeof(bool)) };
	enum eco_code code = ECO_OK;
	if (count > 0 && !number_importances(&r)) {
		code = eco_fail(c->error, ECO_TOO_LARGE, "%.300s: the rules in \"parts\" give more than %u "
			"different importances", c->what, ECO_IMPORTANCES_MAX);
	} else if (count > 0) {
		match_all(&r, c->place);
		apply(&r, c->why);
	}
	for (uint32_t i = 0; !code && i < count; i++) {
		const struct eco_part_rule *rule = &r.rules[i];
		if (r.fitted[i])
			continue;
		if (rule->kind == ECO_PART_COMPONENT)
			eco_note(c->notes,
				"the rule {\"component\": %u} fits nothing: there are %u components",
				rule->component, r.components.count);
		else if (rule->kind == ECO_PART_SIZE)
			eco_note(c->notes,
				"the rule {\"size\": [%g, %g]} fits nothing: ecopack model lists sizes",
				rule->size[0], rule->size[1]);
		else
			eco_note(c->notes,
				"the rule {\"name\": \"%.100s\"} fits nothing: ecopack model lists the "
				"names of materials and parts", rule->name);
	}
	if (!code && c->model->triangle_count == 0)
		code = eco_fail(c->error, ECO_BAD_INPUT, "%.300s: the rules in \"parts\" leave out all of it",
			c->what);
	eco_components_free(&r.components);
	eco_free(r.importance, r.fitted, r.of_material);
	return code;
}
