/* glTF as an inventory. Programs that place plants (game engines, tools for 3D Tiles) write one node with
 * thousands of instances (EXT_mesh_gpu_instancing); others write a node for each plant. Rows are made one
 * at a time from the file's own bytes: a million instances need no memory beyond the file.
 *
 * A plant stands at its mesh's origin. In a quantized mesh (KHR_mesh_quantization) packing has changed
 * that origin and the node's scale: there the middle of the lower side of its box replaces the origin, and
 * scale has no value. The height of the box is right in any case.
 *
 * Scalar attributes of the instances (_ID, _SPECIES) and a node's "extras" become columns: programs
 * describe plants there. */
#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/places/rows/rows_formats.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/import/model/gltf.h"

enum fixed { X, Y, Z, NAME, MESH, YAW, SCALE, HEIGHT, FIXED };
static const char *const fixed_names[FIXED] = { "x", "y", "z", "name", "mesh", "yaw_deg", "scale",
	"height_m" };

#define FURTHER_MAX 64u
#define TEXT_BYTES 1024u             /* longest field; longer ones are cut */
#define DEGREES (180 / 3.14159265358979323846)

struct holder { uint32_t node; double world[16]; };

struct box {                     /* of a mesh, in its coordinates */
	bool known, quantized;
	double low[3], high[3];
};

struct gltf_rows {
	struct eco_rows rows;
	struct eco_gltf *doc;
	struct holder *holders;
	uint32_t holder_count, holder_capacity;
	bool instanced;              /* a node holds instances: nodes without make no rows */
	uint32_t at;                 /* holder */
	uint64_t instance;
	bool open;
	struct box box;
	struct eco_gltf_instances instances;
	struct eco_gltf_accessor further[FURTHER_MAX];
	char (*text)[TEXT_BYTES];    /* per column */
};

/* ---- Finding instances and nodes ---- */

static bool holds_instances(const struct eco_gltf *doc, uint32_t node)
{
	return eco_gltf_extension(eco_gltf_item(doc, "nodes", node), "EXT_mesh_gpu_instancing");
}

static enum eco_code visit(void *ctx, uint32_t node, const double world[16])
{
	struct gltf_rows *g = ctx;
	if (g->instanced ? !holds_instances(g->doc, node)
			: json_object_get(eco_gltf_item(g->doc, "nodes", node), "mesh") == NULL)
		return ECO_OK;
	if (!eco_array_grow(&g->holders, &g->holder_capacity, g->holder_count, sizeof *g->holders))
		return ECO_NO_MEMORY;
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
	if (!g->rows.columns[g->rows.column_count])
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", eco_gltf_path(g->doc));
	g->rows.column_count++;
	return ECO_OK;
}

static const json_t *instance_attributes(const struct gltf_rows *g, uint32_t node)
{
	return json_object_get(eco_gltf_extension(eco_gltf_item(g->doc, "nodes", node),
		"EXT_mesh_gpu_instancing"), "attributes");
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
		if (code == ECO_OK
				&& (json_is_string(value) || json_is_number(value) || json_is_boolean(value)))
			code = add_column(g, name, error);
	return code;
}

static enum eco_code make_columns(struct gltf_rows *g, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	g->rows.columns = calloc(FIXED + FURTHER_MAX, sizeof *g->rows.columns);
	g->rows.fields = calloc(FIXED + FURTHER_MAX, sizeof *g->rows.fields);
	g->text = calloc(FIXED + FURTHER_MAX, sizeof *g->text);
	if (!g->rows.columns || !g->rows.fields || !g->text)
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

/* Extends the box by the bounds stated in the file, without reading vertices. */
static void add_to_box(const struct eco_gltf *doc, const json_t *primitive, struct box *box)
{
	const json_t *accessor = eco_gltf_item(doc, "accessors",
		eco_gltf_whole(json_object_get(primitive, "attributes"), "POSITION", UINT64_MAX));
	static const double most[] = { 127, 255, 32767, 65535 };
	uint64_t type = eco_gltf_whole(accessor, "componentType", 0);
	double low[3], high[3];
	if (json_array_size(json_object_get(accessor, "min")) != 3
			|| json_array_size(json_object_get(accessor, "max")) != 3
		|| !eco_gltf_numbers(accessor, "min", low, 3) || !eco_gltf_numbers(accessor, "max", high, 3))
		return;
	box->quantized |= type >= 5120 && type <= 5123;
	for (int k = 0; k < 3; k++) {
		double unit = type >= 5120 && type <= 5123
			&& json_is_true(json_object_get(accessor, "normalized")) ? 1 / most[type - 5120] : 1;
		box->low[k] = box->known ? fmin(box->low[k], low[k] * unit) : low[k] * unit;
		box->high[k] = box->known ? fmax(box->high[k], high[k] * unit) : high[k] * unit;
	}
	box->known = true;
}

static void find_box(struct gltf_rows *g, const json_t *node)
{
	const json_t *mesh = eco_gltf_item(g->doc, "meshes", eco_gltf_whole(node, "mesh", UINT64_MAX)),
		*primitives = json_object_get(mesh, "primitives");
	g->box = (struct box){ .known = false };
	for (size_t i = 0; i < json_array_size(primitives); i++)
		add_to_box(g->doc, json_array_get(primitives, i), &g->box);
}

/* Prepares everything that all rows of a node share. */
static enum eco_code open_holder(struct gltf_rows *g, struct eco_error *error)
{
	uint32_t node = g->holders[g->at].node;
	const json_t *json = eco_gltf_item(g->doc, "nodes", node), *attributes = instance_attributes(g, node);
	const char *mesh =
		eco_gltf_text(eco_gltf_item(g->doc, "meshes", eco_gltf_whole(json, "mesh", UINT64_MAX)),
		"name");
	const char *name = eco_gltf_text(json, "name");
	bool there;
	enum eco_code code = g->instanced ? eco_gltf_instances_open(g->doc, node, &there, &g->instances,
		error) : ECO_OK;
	if (code)
		return code;
	g->open = true;
	g->instance = 0;
	find_box(g, json);
	if (g->box.quantized)
		eco_rows_note(&g->rows, "meshes are quantized: each plant stands on the middle of its "
			"mesh's lower side, and \"scale\" has no value; "
			"\"height_m\": {\"column\": \"height_m\"} takes their heights");
	set_text(g, NAME, *name != 0 ? name : mesh);
	set_text(g, MESH, mesh);
	for (uint32_t i = FIXED; i < g->rows.column_count && code == ECO_OK; i++) {
		const json_t *accessor = json_object_get(attributes, g->rows.columns[i]);
		set_json(g, i, json_object_get(json_object_get(json, "extras"), g->rows.columns[i]));
		if (accessor && is_scalar_attribute(g, g->rows.columns[i], accessor))
			code = eco_gltf_accessor_open(g->doc, eco_gltf_index(attributes, g->rows.columns[i]),
				1, &g->further[i - FIXED], error);
	}
	return code;
}

/* Lowest and highest z of the box in the scene. */
static void extent(const struct box *box, const double m[16], double *low, double *high)
{
	*low = *high = m[13];
	for (int k = 0; k < 3; k++) {
		double a = m[k * 4 + 1] * box->low[k], b = m[k * 4 + 1] * box->high[k];
		*low += fmin(a, b);
		*high += fmax(a, b);
	}
}

/* The turn about the vertical nearest to the matrix, and the cube root of its volume ratio. */
static void set_place(struct gltf_rows *g, const double m[16])
{
	double yaw = round(atan2(m[8] - m[2], m[0] + m[10]) * DEGREES * 1e4) / 1e4,
		at[3] = { m[12], m[13], m[14] };
	double volume = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9])
		+ m[8] * (m[1] * m[6] - m[2] * m[5]);
	double low, high;
	g->text[SCALE][0] = g->text[HEIGHT][0] = 0;
	if (g->box.known) {
		extent(&g->box, m, &low, &high);
		snprintf(g->text[HEIGHT], TEXT_BYTES, "%.9g", high - low);
	}
	if (g->box.quantized)
		eco_gltf_apply(m, (const double[]){ (g->box.low[0] + g->box.high[0]) / 2, g->box.low[1],
			(g->box.low[2] + g->box.high[2]) / 2 }, at);
	else
		snprintf(g->text[SCALE], TEXT_BYTES, "%.9g", cbrt(fabs(volume)));
	snprintf(g->text[X], TEXT_BYTES, "%.15g", at[0]);
	snprintf(g->text[Y], TEXT_BYTES, "%.15g", 0 - at[2]);
	snprintf(g->text[Z], TEXT_BYTES, "%.15g", at[1]);
	snprintf(g->text[YAW], TEXT_BYTES, "%.4f", yaw < 0 ? yaw + 360 : yaw + 0.0);
	g->rows.place = (struct eco_rows_place){ .kind = ECO_PLACE_POINT, .at = { at[0], 0 - at[2], at[1] },
		.yaw_deg = yaw, .scale = g->box.quantized ? NAN : cbrt(fabs(volume)) };
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
		if (code)
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
	for (size_t i = 0; i < nodes && !g->instanced; i++)
		g->instanced = holds_instances(g->doc, (uint32_t)i);
	enum eco_code code = eco_gltf_walk(g->doc, visit, g, error);
	if (code == ECO_NO_MEMORY)
		return eco_fail(error, code, "%.300s: out of memory", eco_gltf_path(g->doc));
	if (code == ECO_OK && g->holder_count == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: no node of its scene has a mesh or instances",
			eco_gltf_path(g->doc));
	return code;
}

enum eco_code eco_rows_open_gltf(struct eco_rows **rows, const char *path, struct eco_error *error)
{
	struct gltf_rows *g = calloc(1, sizeof *g);
	_Static_assert(offsetof(struct gltf_rows, rows) == 0, "struct eco_rows is the start of struct "
		"gltf_rows");
	*rows = NULL;
	if (!g)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	g->rows.next = next;
	g->rows.close = close_gltf;
	g->rows.where = "instance";
	g->rows.has_geometry = g->rows.has_z = g->rows.local = true;
	enum eco_code code = eco_gltf_open(&g->doc, path, error);
	if (!code)
		code = find_holders(g, error);
	if (!code)
		code = make_columns(g, error);
	if (!code)
		*rows = &g->rows;
	else
		close_gltf(&g->rows);
	return code;
}
