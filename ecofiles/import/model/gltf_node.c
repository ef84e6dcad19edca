/* Nodes: their places in the world, in double, and their instances. No recursion: a stranger's file may
 * have a tree of any depth, or none. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/model.h"

/* ---- Matrices ---- */

void eco_gltf_multiply(double out[16], const double a[16], const double b[16])
{
	double product[16];
	for (int c = 0; c < 4; c++)
		for (int r = 0; r < 4; r++)
			product[c * 4 + r] = a[r] * b[c * 4] + a[4 + r] * b[c * 4 + 1]
				+ a[8 + r] * b[c * 4 + 2] + a[12 + r] * b[c * 4 + 3];
	memcpy(out, product, sizeof product);
}

void eco_gltf_apply(const double m[16], const double p[3], double out[3])
{
	double x = p[0], y = p[1], z = p[2];
	for (int r = 0; r < 3; r++)
		out[r] = m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r];
}

void eco_gltf_compose(double out[16], const double t[3], const double q[4], const double s[3])
{
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]),
		unit = length > 0 ? 1 / length : 0;
	double x = q[0] * unit, y = q[1] * unit, z = q[2] * unit, w = length > 0 ? q[3] * unit : 1;
	const double turn[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w),
		2 * (x * y - z * w), 1 - 2 * (x * x + z * z),
		2 * (y * z + x * w), 2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y) };

	for (int c = 0; c < 3; c++) {
		for (int r = 0; r < 3; r++)
			out[c * 4 + r] = turn[c * 3 + r] * s[c];
		out[c * 4 + 3] = 0;
		out[12 + c] = t[c];
	}
	out[15] = 1;
}

enum eco_code eco_gltf_node_local(const struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "nodes", node);
	double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names node %u, which is not there", doc->path,
			node);
	bool good = eco_gltf_numbers(json, "translation", t, 3) && eco_gltf_numbers(json, "rotation", q, 4)
		&& eco_gltf_numbers(json, "scale", s, 3);
	eco_gltf_compose(matrix, t, q, s);
	if (json_array_size(json_object_get(json, "matrix")) == 16)
		good = eco_gltf_numbers(json, "matrix", matrix, 16);
	return good ? ECO_OK : eco_fail(error, ECO_DAMAGED, "%.300s: node %u is not placed by numbers",
		doc->path, node);
}

static void find_parents(struct eco_gltf *doc)
{
	if (doc->parent)
		return;
	doc->parent = eco_alloc(doc->node_count + 1, sizeof *doc->parent);
	for (size_t i = 0; i < doc->node_count; i++)
		doc->parent[i] = ECO_NONE;
	for (size_t i = 0; i < doc->node_count; i++) {
		const json_t *children = json_object_get(eco_gltf_item(doc, "nodes", i), "children");
		for (size_t k = 0; k < json_array_size(children); k++) {
			json_int_t child = json_integer_value(json_array_get(children, k));
			if (child >= 0 && (uint64_t)child < doc->node_count && doc->parent[child] == ECO_NONE
					&& i < ECO_NONE)
				doc->parent[child] = (uint32_t)i;
		}
	}
}

enum eco_code eco_gltf_node_matrix(struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error)
{
	enum eco_code code = eco_gltf_node_local(doc, node, matrix, error);
	size_t steps = 0;
	find_parents(doc);
	while (code == ECO_OK && doc->parent[node] != ECO_NONE) {
		double local[16];
		node = doc->parent[node];
		if (++steps > doc->node_count)
			return eco_fail(error, ECO_DAMAGED, "%.300s: node %u is below itself", doc->path,
				node);
		code = eco_gltf_node_local(doc, node, local, error);
		if (!code)
			eco_gltf_multiply(matrix, local, matrix);
	}
	return code;
}

/* ---- The scene ---- */

struct entry { uint32_t node, depth; double world[16]; };

struct walk {
	struct eco_gltf *doc;
	struct entry *stack;
	uint32_t count, capacity;
	uint64_t seen;
};

/* depth: nodes above it */
static enum eco_code push(struct walk *w, uint32_t node, uint32_t depth, const double world[16],
	struct eco_error *error)
{
	if (depth >= w->doc->node_count)
		return eco_fail(error, ECO_DAMAGED,
			"%.300s: node %u or one above it lies below itself: nodes must be a tree",
			w->doc->path, node);
	if (++w->seen > ECO_GLTF_NODES_MAX)
		return eco_fail(error, ECO_TOO_LARGE,
			"%.300s: more than %u nodes, as some have several parents", w->doc->path,
			ECO_GLTF_NODES_MAX);
	eco_grow(&w->stack, &w->capacity, w->count, sizeof *w->stack);
	w->stack[w->count].node = node;
	w->stack[w->count].depth = depth;
	memcpy(w->stack[w->count++].world, world, 16 * sizeof *world);
	return ECO_OK;
}

/* Pushes in reverse, so that the first is popped first. */
static enum eco_code push_all(struct walk *w, const json_t *nodes, uint32_t depth, const double world[16],
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (size_t i = json_array_size(nodes); i-- > 0 && code == ECO_OK;) {
		json_int_t node = json_is_integer(json_array_get(nodes, i))
			? json_integer_value(json_array_get(nodes, i)) : -1;
		if (node < 0 || (uint64_t)node >= w->doc->node_count || node >= ECO_NONE)
			return eco_fail(error, ECO_DAMAGED, "%.300s: names node %lld, which is not there",
				w->doc->path, (long long)node);
		code = push(w, (uint32_t)node, depth, world, error);
	}
	return code;
}

static const json_t *find_scene(const struct eco_gltf *doc)
{
	return eco_gltf_item(doc, "scenes", json_object_get(doc->root, "scene") != NULL
		? eco_gltf_whole(doc->root, "scene", ECO_NONE) : 0);
}

bool eco_gltf_has_scene(const struct eco_gltf *doc)
{
	return find_scene(doc);
}

static enum eco_code push_roots(struct walk *w, struct eco_error *error)
{
	static const double identity[16] = { [0] = 1, [5] = 1, [10] = 1, [15] = 1 };
	const json_t *scene = find_scene(w->doc);
	enum eco_code code = ECO_OK;
	if (scene)
		return push_all(w, json_object_get(scene, "nodes"), 0, identity, error);
	find_parents(w->doc);
	for (size_t i = w->doc->node_count; i-- > 0 && code == ECO_OK;)
		if (w->doc->parent[i] == ECO_NONE)
			code = push(w, (uint32_t)i, 0, identity, error);
	return code;
}

enum eco_code eco_gltf_walk(struct eco_gltf *doc, eco_gltf_visit *visit, void *ctx, struct eco_error *error)
{
	struct walk w = { .doc = doc };
	enum eco_code code = push_roots(&w, error);
	while (code == ECO_OK && w.count > 0) {
		struct entry top = w.stack[--w.count];
		const json_t *node = eco_gltf_item(doc, "nodes", top.node);
		double local[16];
		if (json_is_false(json_object_get(eco_gltf_extension(node, "KHR_node_visibility"),
				"visible")))
			continue;
		code = eco_gltf_node_local(doc, top.node, local, error);
		if (code)
			break;
		eco_gltf_multiply(top.world, top.world, local);
		code = visit(ctx, top.node, top.world);
		if (!code)
			code = push_all(&w, json_object_get(node, "children"), top.depth + 1, top.world,
				error);
	}
	free(w.stack);
	return code;
}

/* ---- Instances ---- */

static enum eco_code open_one(struct eco_gltf *doc, uint32_t node, const json_t *attributes, const char *name,
	uint32_t components, struct eco_gltf_instances *all, struct eco_gltf_accessor *a,
	struct eco_error *error)
{
	if (!json_object_get(attributes, name))
		return ECO_OK;
	enum eco_code code = eco_gltf_accessor_open(doc, eco_gltf_index(attributes, name), components, a,
		error);
	if (code)
		return code;
	if (all->count != UINT64_MAX && all->count != a->count)
		return eco_fail(error, ECO_DAMAGED, "%.300s: node %u: its instances have %llu and %llu "
			"places, turns or sizes", doc->path, node, (unsigned long long)all->count,
			(unsigned long long)a->count);
	all->count = a->count;
	return ECO_OK;
}

enum eco_code eco_gltf_instances_open(struct eco_gltf *doc, uint32_t node, bool *there,
	struct eco_gltf_instances *all, struct eco_error *error)
{
	const json_t *extension = eco_gltf_extension(eco_gltf_item(doc, "nodes", node),
		"EXT_mesh_gpu_instancing");
	const json_t *attributes = json_object_get(extension, "attributes");
	*there = extension != NULL;
	if (!extension)
		return ECO_OK;
	*all = (struct eco_gltf_instances){ .count = UINT64_MAX };
	enum eco_code code = open_one(doc, node, attributes, "TRANSLATION", 3, all, &all->translation, error);
	if (!code)
		code = open_one(doc, node, attributes, "ROTATION", 4, all, &all->rotation, error);
	if (!code)
		code = open_one(doc, node, attributes, "SCALE", 3, all, &all->scale, error);
	if (code == ECO_OK && all->count == UINT64_MAX)
		code = eco_fail(error, ECO_DAMAGED, "%.300s: node %u: instances without places, turns or "
			"sizes", doc->path, node);
	if (code)
		eco_gltf_instances_close(all);
	return code;
}

void eco_gltf_instances_close(struct eco_gltf_instances *all)
{
	eco_gltf_accessor_close(&all->translation);
	eco_gltf_accessor_close(&all->rotation);
	eco_gltf_accessor_close(&all->scale);
	all->count = 0;
}

void eco_gltf_instance_matrix(const struct eco_gltf_instances *all, uint64_t i, const double world[16],
	double out[16])
{
	double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 }, local[16];
	if (all->translation.count > 0)
		eco_gltf_element(&all->translation, i, t);
	if (all->rotation.count > 0)
		eco_gltf_element(&all->rotation, i, q);
	if (all->scale.count > 0)
		eco_gltf_element(&all->scale, i, s);
	eco_gltf_compose(local, t, q, s);
	eco_gltf_multiply(out, world, local);
}
