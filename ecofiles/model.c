/* What every reader of models needs afterwards: triangles that cover nothing are dropped and counted, the plant is stood on its
 * foot and brought to its height. */
#include "ecofiles/model_clean.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COORDINATE_MAX 1e9f
#define FOOT_SHARE 0.02
#define WOOD_SHARE 0.1               /* of the largest component's area */
#define GIRTH_SHARE 0.5              /* of the thickest long component's circumference */
#define LONG 4.0

void eco_model_free(struct eco_model *model)
{
	for (uint32_t i = 0; i < model->image_count; i++)
		free(model->images[i].rgba);
	free(model->images);
	free(model->materials);
	free(model->position);
	free(model->uv);
	free(model->index);
	free(model->material);
	*model = (struct eco_model){ .position = NULL };
}

double eco_model_height(const struct eco_model *model)
{
	double top = 0;

	for (uint32_t i = 0; i < model->vertex_count; i++)
		if (model->position[i * 3 + 2] > top)
			top = model->position[i * 3 + 2];
	return top;
}

/* ---- Places: vertices at one position share a number ---- */

struct clean {
	struct eco_model *model;
	uint32_t *place;                     /* per vertex: the first vertex at its position; ECO_NONE: not finite */
	uint32_t *table, mask;               /* open addressing, ECO_NONE is free */
};

static uint32_t hash3(uint32_t a, uint32_t b, uint32_t c)
{
	uint64_t h = (a * 0x9e3779b97f4a7c15u) ^ (b * 0xc2b2ae3d27d4eb4fu) ^ (c * 0x165667b19e3779f9u);

	h ^= h >> 29;
	h *= 0xbf58476d1ce4e5b9u;
	return (uint32_t)(h >> 32);
}

static bool table_new(struct clean *c, uint32_t entries)
{
	size_t size = 16;

	while (size < (size_t)entries * 2)
		size *= 2;
	c->table = malloc(size * sizeof *c->table);
	c->mask = (uint32_t)(size - 1);
	if (c->table != NULL)
		memset(c->table, 0xff, size * sizeof *c->table);
	return c->table != NULL;
}

static bool vertex_fits(const float *p)
{
	return fabsf(p[0]) <= COORDINATE_MAX && fabsf(p[1]) <= COORDINATE_MAX && fabsf(p[2]) <= COORDINATE_MAX;
}

static bool find_places(struct clean *c)
{
	struct eco_model *m = c->model;

	if (!table_new(c, m->vertex_count))
		return false;
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		float *p = &m->position[(size_t)i * 3];
		uint32_t bits[3], slot;

		c->place[i] = ECO_NONE;
		if (!vertex_fits(p))
			continue;
		for (int k = 0; k < 3; k++)
			p[k] += 0.0f;                /* -0 is 0 */
		memcpy(bits, p, sizeof bits);
		slot = hash3(bits[0], bits[1], bits[2]) & c->mask;
		while (c->table[slot] != ECO_NONE && memcmp(&m->position[(size_t)c->table[slot] * 3], p, sizeof bits) != 0)
			slot = (slot + 1) & c->mask;
		if (c->table[slot] == ECO_NONE)
			c->table[slot] = i;
		c->place[i] = c->table[slot];
	}
	free(c->table);
	c->table = NULL;
	return true;
}

/* ---- Triangles ---- */

static double area_of(const struct eco_model *m, const uint32_t v[3])
{
	double a[3], b[3], x, y, z;

	for (int k = 0; k < 3; k++) {
		a[k] = (double)m->position[(size_t)v[1] * 3 + k] - m->position[(size_t)v[0] * 3 + k];
		b[k] = (double)m->position[(size_t)v[2] * 3 + k] - m->position[(size_t)v[0] * 3 + k];
	}
	x = a[1] * b[2] - a[2] * b[1];
	y = a[2] * b[0] - a[0] * b[2];
	z = a[0] * b[1] - a[1] * b[0];
	return sqrt(x * x + y * y + z * z) / 2;
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

/* Whether the places of `triangle` (kept as number `kept`) were seen before in its material; remembers them if not. */
static bool is_duplicate(struct clean *c, const uint32_t corners[3], uint32_t material, uint32_t kept)
{
	uint32_t sorted[3] = { corners[0], corners[1], corners[2] }, slot;

	sort3(sorted);
	slot = hash3(sorted[0], sorted[1], sorted[2] ^ (material * 0x85ebca6bu)) & c->mask;
	for (; c->table[slot] != ECO_NONE; slot = (slot + 1) & c->mask) {
		uint32_t other[3];

		corner_places(c, c->table[slot], other);
		sort3(other);
		if (memcmp(other, sorted, sizeof sorted) == 0 && c->model->material[c->table[slot]] == material)
			return true;
	}
	c->table[slot] = kept;
	return false;
}

static enum eco_drop judge(struct clean *c, const uint32_t v[3], uint32_t material, uint32_t kept)
{
	uint32_t places[3];

	if (v[0] >= c->model->vertex_count || v[1] >= c->model->vertex_count || v[2] >= c->model->vertex_count)
		return ECO_DROP_BAD_INDEX;
	for (int k = 0; k < 3; k++) {
		places[k] = c->place[v[k]];
		if (places[k] == ECO_NONE)
			return ECO_DROP_NOT_FINITE;
	}
	if (places[0] == places[1] || places[1] == places[2] || places[2] == places[0] || !(area_of(c->model, v) > 0))
		return ECO_DROP_DEGENERATE;
	return is_duplicate(c, places, material, kept) ? ECO_DROP_DUPLICATE : ECO_DROP_COUNT;
}

static bool drop_triangles(struct clean *c)
{
	struct eco_model *m = c->model;
	uint32_t kept = 0;

	if (!table_new(c, m->triangle_count))
		return false;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		uint32_t v[3], material = m->material[i];
		enum eco_drop why;

		memcpy(v, &m->index[(size_t)i * 3], sizeof v);
		why = judge(c, v, material, kept);
		if (why != ECO_DROP_COUNT) {
			m->dropped[why]++;
			continue;
		}
		memcpy(&m->index[(size_t)kept * 3], v, sizeof v);
		m->material[kept++] = material;
	}
	m->triangle_count = kept;
	free(c->table);
	c->table = NULL;
	return true;
}

/* ---- Standing upright on the ground ---- */

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

struct part { double area, low[3], high[3]; };   /* a connected component */

static void part_add(struct part *part, const struct eco_model *m, const uint32_t v[3])
{
	for (int i = 0; i < 9; i++) {
		double p = m->position[(size_t)v[i / 3] * 3 + i % 3];
		int k = i % 3;

		bool first = part->area == 0 && i < 3;

		part->low[k] = first ? p : fmin(part->low[k], p);
		part->high[k] = first ? p : fmax(part->high[k], p);
	}
	part->area += area_of(m, v);
}

static double length_of(const struct part *part)
{
	double square = 0;

	for (int k = 0; k < 3; k++)
		square += (part->high[k] - part->low[k]) * (part->high[k] - part->low[k]);
	return sqrt(square);
}

/* Circumference of a tube of that area and length. */
static double girth(const struct part *part)
{
	double length = length_of(part);

	return length > 0 ? part->area / length : 0;
}

static bool is_long(const struct part *part)
{
	return 3.14159265 * length_of(part) >= LONG * girth(part);
}

/* Whether a component is wood-like beside the others, `thickest` the girth of the thickest long one. A trunk is large, long and thick;
 * leaves and twigs are small, branches that hang below the trunk's foot are thin; pots are thick. Where all are alike (grass),
 * or nothing is long (bushes), all large ones are taken. */
static bool is_wood(const struct part *part, double largest, double thickest)
{
	return part->area >= WOOD_SHARE * largest && girth(part) >= GIRTH_SHARE * thickest;
}

static void find_wood(const struct clean *c, uint32_t *parent, struct part *parts, bool *wood)
{
	const struct eco_model *m = c->model;
	double largest = 0, thickest = 0;

	for (uint32_t i = 0; i < m->vertex_count; i++)
		parent[i] = i;
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++) {
		uint32_t a = root_of(parent, c->place[m->index[i]]), b = root_of(parent, c->place[m->index[i - i % 3]]);

		parent[a > b ? a : b] = a > b ? b : a;
	}
	for (uint32_t i = 0; i < m->triangle_count; i++)
		part_add(&parts[root_of(parent, c->place[m->index[(size_t)i * 3]])], m, &m->index[(size_t)i * 3]);
	for (uint32_t i = 0; i < m->vertex_count; i++)
		largest = fmax(largest, parts[i].area);
	for (uint32_t i = 0; i < m->vertex_count; i++)
		if (parts[i].area >= WOOD_SHARE * largest && is_long(&parts[i]))
			thickest = fmax(thickest, girth(&parts[i]));
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++)
		wood[m->index[i]] = is_wood(&parts[root_of(parent, c->place[m->index[i]])], largest, thickest);
}

static bool mark_wood(const struct clean *c, bool *wood)
{
	uint32_t *parent = malloc(((size_t)c->model->vertex_count + 1) * sizeof *parent);
	struct part *parts = calloc((size_t)c->model->vertex_count + 1, sizeof *parts);
	bool good = parent != NULL && parts != NULL;

	if (good)
		find_wood(c, parent, parts, wood);
	free(parent);
	free(parts);
	return good;
}

/* Centre of the box around the lowest FOOT_SHARE of the height of what is marked. */
static void find_foot(const struct eco_model *m, const bool *wood, double foot[3])
{
	double low = INFINITY, high = -INFINITY, wood_low = INFINITY, box[2][2] = { { INFINITY, -INFINITY }, { INFINITY, -INFINITY } };

	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++) {
		double z = m->position[(size_t)m->index[i] * 3 + 2];

		low = fmin(low, z);
		high = fmax(high, z);
		if (wood[m->index[i]])
			wood_low = fmin(wood_low, z);
	}
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++) {
		const float *p = &m->position[(size_t)m->index[i] * 3];

		if (!wood[m->index[i]] || p[2] > wood_low + FOOT_SHARE * (high - low))
			continue;
		for (int k = 0; k < 2; k++) {
			box[k][0] = fmin(box[k][0], p[k]);
			box[k][1] = fmax(box[k][1], p[k]);
		}
	}
	foot[0] = (box[0][0] + box[0][1]) / 2;
	foot[1] = (box[1][0] + box[1][1]) / 2;
	foot[2] = low;
}

static enum eco_code stand(struct clean *c, double height_m, const char *path, struct eco_error *error)
{
	struct eco_model *m = c->model;
	bool *wood = calloc((size_t)m->vertex_count + 1, sizeof *wood);
	double foot[3], scale = 1, top = 0;

	if (wood == NULL || !mark_wood(c, wood)) {
		free(wood);
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", path);
	}
	find_foot(m, wood, foot);
	free(wood);
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++)
		top = fmax(top, m->position[(size_t)m->index[i] * 3 + 2] - foot[2]);
	if (height_m > 0) {
		if (!(top > 0))
			return eco_fail(error, ECO_BAD_INPUT, "%s: the model is flat, so it cannot be made %g m high", path, height_m);
		scale = height_m / top;
	}
	memcpy(m->foot, foot, sizeof m->foot);
	m->scale = scale;
	for (uint32_t i = 0; i < m->vertex_count; i++)
		for (int k = 0; k < 3; k++)
			m->position[(size_t)i * 3 + k] = (float)((m->position[(size_t)i * 3 + k] - foot[k]) * scale);
	memcpy(m->foot, foot, sizeof m->foot);
	m->scale = scale;
	return ECO_OK;
}

/* Only materials and images in use stay. `used` has room for all of either. */
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

/* Only vertices that a triangle uses stay. */
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
		if (m->uv != NULL)
			memmove(&m->uv[(size_t)kept * 2], &m->uv[(size_t)i * 2], 2 * sizeof *m->uv);
		new_index[i] = kept++;
	}
	for (size_t i = 0; i < (size_t)m->triangle_count * 3; i++)
		m->index[i] = new_index[m->index[i]];
	m->vertex_count = kept;
}

enum eco_code eco_model_clean(struct eco_model *model, double height_m, const char *path, struct eco_error *error)
{
	struct clean c = { .model = model };
	enum eco_code code = ECO_OK;
	size_t tables = (size_t)(model->material_count > model->image_count ? model->material_count : model->image_count) + 1;
	uint32_t *used = malloc(tables * sizeof *used);
	uint64_t accounted = 0;

	c.place = malloc(((size_t)model->vertex_count + 1) * sizeof *c.place);
	if (used == NULL || c.place == NULL || !find_places(&c) || !drop_triangles(&c))
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", path);
	else if (model->triangle_count == 0)
		code = eco_fail(error, ECO_BAD_INPUT, "%s: none of its %u triangles can be drawn", path, model->triangles_in);
	else
		code = stand(&c, height_m, path, error);
	if (code == ECO_OK) {
		compact(&c);
		compact_materials(model, used);
	}
	free(used);
	free(c.table);
	free(c.place);
	if (code != ECO_OK)
		return code;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += model->dropped[i];
	assert(accounted + model->triangle_count == model->triangles_in);
	return ECO_OK;
}
