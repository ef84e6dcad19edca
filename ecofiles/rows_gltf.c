/* glTF as an inventory: programs that place plants (game engines, tools for 3D Tiles) write one node with thousands of instances
 * (EXT_mesh_gpu_instancing), others a node for each plant. Rows are made one at a time from the file's own bytes: a million instances cost
 * no memory beyond the file.
 *
 * What a program wanted to say of a plant stands in scalar attributes of the instances (_ID, _SPECIES) or in a node's "extras"; both
 * become columns. */
#include "ecofiles/rows.h"
#include "ecofiles/rows_formats.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/gltf.h"

enum fixed { X, Y, Z, NAME, MESH, YAW, SCALE, FIXED };
static const char *const fixed_names[FIXED] = { "x", "y", "z", "name", "mesh", "yaw_deg", "scale" };

#define FURTHER_MAX 64u
#define TEXT_BYTES 1024u             /* of a field; names are cut there */
#define DEGREES (180 / 3.14159265358979323846)

struct holder { uint32_t node; double world[16]; };

struct gltf_rows {
	struct eco_rows rows;
	struct eco_gltf *doc;
	struct holder *holders;
	uint32_t holder_count, room;
	bool instanced;              /* some node holds instances: other nodes make no rows */
	uint32_t at;                 /* holder */
	uint64_t instance;
	bool open;
	struct eco_gltf_instances instances;
	struct eco_gltf_accessor further[FURTHER_MAX];
	char (*text)[TEXT_BYTES];    /* per column */
};

/* ---- Finding them ---- */

static bool holds_instances(const struct eco_gltf *doc, uint32_t node)
{
	return eco_gltf_extension(eco_gltf_item(doc, "nodes", node), "EXT_mesh_gpu_instancing") != NULL;
}

static enum eco_code visit(void *ctx, uint32_t node, const double world[16])
{
	struct gltf_rows *g = ctx;

	if (g->instanced ? !holds_instances(g->doc, node) : json_object_get(eco_gltf_item(g->doc, "nodes", node), "mesh") == NULL)
		return ECO_OK;
	if (g->holder_count == g->room) {
		uint32_t room = g->room < 64 ? 64 : g->room * 2;
		struct holder *grown = realloc(g->holders, room * sizeof *grown);

		if (grown == NULL)
			return ECO_NO_MEMORY;
		g->holders = grown;
		g->room = room;
	}
	g->holders[g->holder_count].node = node;
	memcpy(g->holders[g->holder_count++].world, world, 16 * sizeof *world);
	return ECO_OK;
}

/* ---- Columns ---- */

static enum eco_code add_column(struct gltf_rows *g, const char *name, struct eco_error *error)
{
	for (uint32_t i = 0; i < g->rows.column_count; i++)
		if (strcmp(g->rows.columns[i], name) == 0)
			return ECO_OK;
	if (g->rows.column_count == FIXED + FURTHER_MAX)
		return ECO_OK;
	g->rows.columns[g->rows.column_count] = strdup(name);
	if (g->rows.columns[g->rows.column_count] == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", eco_gltf_path(g->doc));
	g->rows.column_count++;
	return ECO_OK;
}

static const json_t *instance_attributes(const struct gltf_rows *g, uint32_t node)
{
	return json_object_get(eco_gltf_extension(eco_gltf_item(g->doc, "nodes", node), "EXT_mesh_gpu_instancing"), "attributes");
}

static bool is_scalar_attribute(const struct gltf_rows *g, const char *name, const json_t *accessor)
{
	const json_t *json = json_is_integer(accessor) && json_integer_value(accessor) >= 0
		? eco_gltf_item(g->doc, "accessors", (uint64_t)json_integer_value(accessor)) : NULL;

	return strcmp(name, "TRANSLATION") != 0 && strcmp(name, "ROTATION") != 0 && strcmp(name, "SCALE") != 0
		&& strcmp(eco_gltf_text(json, "type"), "SCALAR") == 0;
}

static enum eco_code add_further_columns(struct gltf_rows *g, uint32_t node, struct eco_error *error)
{
	const json_t *extras = json_object_get(eco_gltf_item(g->doc, "nodes", node), "extras");
	enum eco_code code = ECO_OK;
	const char *name;
	json_t *value;

	json_object_foreach((json_t *)instance_attributes(g, node), name, value)
		if (code == ECO_OK && is_scalar_attribute(g, name, value))
			code = add_column(g, name, error);
	json_object_foreach((json_t *)extras, name, value)
		if (code == ECO_OK && (json_is_string(value) || json_is_number(value) || json_is_boolean(value)))
			code = add_column(g, name, error);
	return code;
}

static enum eco_code make_columns(struct gltf_rows *g, struct eco_error *error)
{
	enum eco_code code = ECO_OK;

	g->rows.columns = calloc(FIXED + FURTHER_MAX, sizeof *g->rows.columns);
	g->rows.fields = calloc(FIXED + FURTHER_MAX, sizeof *g->rows.fields);
	g->text = calloc(FIXED + FURTHER_MAX, sizeof *g->text);
	if (g->rows.columns == NULL || g->rows.fields == NULL || g->text == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", eco_gltf_path(g->doc));
	for (uint32_t i = 0; i < FIXED && code == ECO_OK; i++)
		code = add_column(g, fixed_names[i], error);
	for (uint32_t i = 0; i < g->holder_count && code == ECO_OK; i++)
		code = add_further_columns(g, g->holders[i].node, error);
	for (uint32_t i = 0; i < g->rows.column_count; i++)
		g->rows.fields[i] = g->text[i];
	g->rows.field_count = g->rows.column_count;
	return code;
}

/* ---- Rows ---- */

static void close_holder(struct gltf_rows *g)
{
	if (g->open && g->instanced)
		eco_gltf_instances_close(&g->instances);
	for (uint32_t i = 0; i < FURTHER_MAX; i++)
		eco_gltf_accessor_close(&g->further[i]);
	g->open = false;
}

static void set_text(struct gltf_rows *g, uint32_t column, const char *text)
{
	snprintf(g->text[column], TEXT_BYTES, "%s", text);
}

static void set_json(struct gltf_rows *g, uint32_t column, const json_t *value)
{
	if (json_is_string(value))
		set_text(g, column, json_string_value(value));
	else if (json_is_integer(value))
		snprintf(g->text[column], TEXT_BYTES, "%lld", (long long)json_integer_value(value));
	else if (json_is_real(value))
		snprintf(g->text[column], TEXT_BYTES, "%.15g", json_real_value(value));
	else
		set_text(g, column, json_is_true(value) ? "true" : json_is_false(value) ? "false" : "");
}

/* What is the same for all rows of a node. */
static enum eco_code open_holder(struct gltf_rows *g, struct eco_error *error)
{
	uint32_t node = g->holders[g->at].node;
	const json_t *json = eco_gltf_item(g->doc, "nodes", node), *attributes = instance_attributes(g, node);
	const char *mesh = eco_gltf_text(eco_gltf_item(g->doc, "meshes", eco_gltf_whole(json, "mesh", UINT64_MAX)), "name");
	const char *name = eco_gltf_text(json, "name");
	bool there;
	enum eco_code code = g->instanced ? eco_gltf_instances_open(g->doc, node, &there, &g->instances, error) : ECO_OK;

	if (code != ECO_OK)
		return code;
	g->open = true;
	g->instance = 0;
	set_text(g, NAME, *name != 0 ? name : mesh);
	set_text(g, MESH, mesh);
	for (uint32_t i = FIXED; i < g->rows.column_count && code == ECO_OK; i++) {
		const json_t *accessor = json_object_get(attributes, g->rows.columns[i]);

		set_json(g, i, json_object_get(json_object_get(json, "extras"), g->rows.columns[i]));
		if (accessor != NULL && is_scalar_attribute(g, g->rows.columns[i], accessor))
			code = eco_gltf_accessor_open(g->doc, eco_gltf_index(attributes, g->rows.columns[i]), 1, &g->further[i - FIXED], error);
	}
	return code;
}

/* The turn about the vertical that is nearest to what the matrix does, and the cube root of how much larger it makes things. */
static void set_place(struct gltf_rows *g, const double m[16])
{
	double yaw = atan2(m[8] - m[2], m[0] + m[10]) * DEGREES;
	double volume = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) + m[8] * (m[1] * m[6] - m[2] * m[5]);

	snprintf(g->text[X], TEXT_BYTES, "%.15g", m[12]);
	snprintf(g->text[Y], TEXT_BYTES, "%.15g", 0 - m[14]);
	snprintf(g->text[Z], TEXT_BYTES, "%.15g", m[13]);
	yaw = round(yaw * 1e4) / 1e4;
	snprintf(g->text[YAW], TEXT_BYTES, "%.4f", yaw < 0 ? yaw + 360 : yaw + 0.0);
	snprintf(g->text[SCALE], TEXT_BYTES, "%.9g", cbrt(fabs(volume)));
	g->rows.place = (struct eco_rows_place){ .kind = ECO_PLACE_POINT, .at = { m[12], 0 - m[14], m[13] }, .yaw_deg = yaw,
		.scale = cbrt(fabs(volume)) };
}

static void set_further(struct gltf_rows *g)
{
	for (uint32_t i = FIXED; i < g->rows.column_count; i++) {
		const struct eco_gltf_accessor *a = &g->further[i - FIXED];
		double value;

		if (a->components == 0)
			continue;
		g->text[i][0] = 0;
		if (g->instance >= a->count)
			continue;
		eco_gltf_element(a, g->instance, &value);
		snprintf(g->text[i], TEXT_BYTES, a->type == 5126 ? "%.9g" : "%.15g", value);
	}
}

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct gltf_rows *g = (struct gltf_rows *)rows;
	double matrix[16];
	enum eco_code code;

	*more = false;
	while (g->open && g->instance == (g->instanced ? g->instances.count : 1)) {
		close_holder(g);
		g->at++;
	}
	while (!g->open) {
		if (g->at == g->holder_count)
			return ECO_OK;
		code = open_holder(g, error);
		if (code != ECO_OK)
			return code;
		if (g->instanced && g->instances.count == 0) {
			close_holder(g);
			g->at++;
		}
	}
	memcpy(matrix, g->holders[g->at].world, sizeof matrix);
	if (g->instanced)
		eco_gltf_instance_matrix(&g->instances, g->instance, g->holders[g->at].world, matrix);
	set_place(g, matrix);
	set_further(g);
	g->instance++;
	rows->line = ++rows->row;
	*more = true;
	return ECO_OK;
}

static void close_gltf(struct eco_rows *rows)
{
	struct gltf_rows *g = (struct gltf_rows *)rows;

	close_holder(g);
	eco_rows_free_texts(rows);
	free(g->text);
	free(g->holders);
	eco_gltf_close(g->doc);
	free(g);
}

static enum eco_code find_holders(struct gltf_rows *g, struct eco_error *error)
{
	size_t nodes = json_array_size(json_object_get(eco_gltf_json(g->doc), "nodes"));
	enum eco_code code;

	for (size_t i = 0; i < nodes && !g->instanced; i++)
		g->instanced = holds_instances(g->doc, (uint32_t)i);
	code = eco_gltf_walk(g->doc, visit, g, error);
	if (code == ECO_NO_MEMORY)
		return eco_fail(error, code, "%.300s: out of memory", eco_gltf_path(g->doc));
	if (code == ECO_OK && g->holder_count == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: no node of its scene has a mesh or instances", eco_gltf_path(g->doc));
	return code;
}

enum eco_code eco_rows_open_gltf(struct eco_rows **rows, const char *path, struct eco_error *error)
{
	struct gltf_rows *g = calloc(1, sizeof *g);
	enum eco_code code;

	_Static_assert(offsetof(struct gltf_rows, rows) == 0, "struct eco_rows is the start of struct gltf_rows");
	*rows = NULL;
	if (g == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	g->rows.next = next;
	g->rows.close = close_gltf;
	g->rows.where = "instance";
	g->rows.has_geometry = g->rows.has_z = g->rows.local = true;
	code = eco_gltf_open(&g->doc, path, error);
	if (code == ECO_OK)
		code = find_holders(g, error);
	if (code == ECO_OK)
		code = make_columns(g, error);
	if (code == ECO_OK)
		*rows = &g->rows;
	else
		close_gltf(&g->rows);
	return code;
}
