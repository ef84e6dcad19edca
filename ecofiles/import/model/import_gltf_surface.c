/* Primitives of glTF meshes, from accessors or a Draco stream, as triangles with the vertices in use:
 * exporters let all primitives of a file share one large buffer. */
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/draco_shim.h"

enum mode { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN };

static enum eco_code fail(const struct gltf_reader *r, enum eco_code code, const char *says)
{
	return eco_fail(r->error, code, "%.300s: meshes[%u].primitives[%u]: %s", r->doc->path, r->mesh,
		r->number,
		says);
}

enum eco_code gltf_too_many(const struct gltf_reader *r, uint64_t triangles)
{
	return triangles <= r->triangles_max ? ECO_OK : eco_fail(r->error, ECO_TOO_LARGE,
		"%.300s: %llu triangles or more, at most %u are possible",
		r->doc->path, (unsigned long long)triangles, r->triangles_max);
}

/* ---- Attributes ---- */

static void name_of(enum gltf_attribute which, const struct gltf_look *look, char name[32])
{
	if (which >= GLTF_JOINTS)
		snprintf(name, 32, "%s_%d", which < GLTF_WEIGHTS ? "JOINTS" : "WEIGHTS",
			(which - GLTF_JOINTS) % GLTF_JOINT_SETS);
	else if (which == GLTF_TEXCOORD)
		snprintf(name, 32, "TEXCOORD_%u", look->uv_set);
	else
		snprintf(name, 32, "%s", which == GLTF_POSITION ? "POSITION" : "COLOR_0");
}

/* Unneeded attributes are not read, and may be broken. */
static bool is_wanted(const struct gltf_reader *r, enum gltf_attribute which, const struct gltf_look *look)
{
	return which == GLTF_TEXCOORD ? look->textured && !look->invisible : which < GLTF_JOINTS
		|| r->skin_count > 0;
}

static enum eco_code open_attribute(struct gltf_reader *r, enum gltf_attribute which, const char *name)
{
	const json_t *attributes = json_object_get(r->primitive, "attributes");
	struct eco_gltf_accessor *a = &r->to->values[which].a;
	if (!json_object_get(attributes, name))
		return ECO_OK;
	ECO_PASS(eco_gltf_accessor_open(r->doc, eco_gltf_index(attributes, name), 0, a, r->error));
	r->to->values[which].there = a->components == (which == GLTF_POSITION ? 3u : which == GLTF_TEXCOORD
		? 2u : 4u)
		|| (which == GLTF_COLOR && a->components == 3);
	return r->to->values[which].there ? ECO_OK
		: fail(r, ECO_DAMAGED, "an attribute with a wrong number of components");
}

static enum eco_code open_attributes(struct gltf_reader *r, const struct gltf_look *look)
{
	enum eco_code code = ECO_OK;
	for (int i = 0; i < GLTF_ATTRIBUTES && code == ECO_OK; i++) {
		char name[32];
		if (!is_wanted(r, (enum gltf_attribute)i, look))
			continue;
		name_of((enum gltf_attribute)i, look, name);
		code = open_attribute(r, (enum gltf_attribute)i, name);
		if (code == ECO_OK && i == GLTF_TEXCOORD && !r->to->values[i].there)
			code = open_attribute(r, GLTF_TEXCOORD, "TEXCOORD_0");
	}
	return code;
}

bool gltf_values(const struct gltf_piece *p, enum gltf_attribute which, uint32_t vertex, double *values)
{
	bool there = p->values[which].there && vertex < p->values[which].a.count;
	if (there)
		eco_gltf_element(&p->values[which].a, vertex, values);
	return there;
}

/* ---- Draco ---- */

static uint32_t faces_declared(const struct gltf_reader *r)
{
	const json_t *accessor = eco_gltf_item(r->doc, "accessors",
		eco_gltf_whole(r->primitive, "indices", UINT64_MAX));
	uint64_t count = eco_gltf_whole(accessor, "count", UINT64_MAX);
	return accessor && count / 3 < r->triangles_max ? (uint32_t)(count / 3) : r->triangles_max;
}

/* Finds Draco's attributes among those needed. The others keep their accessors, if these have data. */
static uint32_t match_attributes(const struct gltf_reader *r, const json_t *ids, const struct gltf_look *look,
	struct eco_draco_attribute *wanted, enum gltf_attribute *which)
{
	uint32_t count = 0;
	for (int i = 0; i < GLTF_ATTRIBUTES; i++) {
		char name[32];
		name_of((enum gltf_attribute)i, look, name);
		uint32_t id = eco_gltf_index(ids, name);
		if (id == ECO_NONE && i == GLTF_TEXCOORD)
			id = eco_gltf_index(ids, "TEXCOORD_0");
		if (id == ECO_NONE || !r->to->values[i].there)
			continue;
		wanted[count] = (struct eco_draco_attribute){ .id = id,
			.components = (uint8_t)r->to->values[i].a.components };
		which[count++] = (enum gltf_attribute)i;
	}
	return count;
}

/* Unpacked numbers stand in for the accessors; Draco gives integers as floats. */
static enum eco_code open_draco(struct gltf_reader *r, const json_t *extension, const struct gltf_look *look)
{
	struct eco_draco_attribute wanted[GLTF_ATTRIBUTES];
	enum gltf_attribute which[GLTF_ATTRIBUTES];
	struct eco_draco_mesh mesh;
	struct eco_error inner = { .code = ECO_OK };
	uint32_t count = match_attributes(r, json_object_get(extension, "attributes"), look, wanted, which),
		faces = faces_declared(r);
	const uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_gltf_view(r->doc, eco_gltf_index(extension, "bufferView"), &bytes, &size,
		r->error);
	if (code)
		return code;
	if (count == 0 || which[0] != GLTF_POSITION)
		return fail(r, ECO_DAMAGED, "its Draco stream has no positions");
	if (eco_draco_decode_gltf(bytes, size, faces, faces > UINT32_MAX / 3 ? UINT32_MAX : 3 * faces, wanted,
		count, &mesh, &inner) != ECO_OK)
		return fail(r, inner.code, inner.text);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_gltf_accessor *a = &r->to->values[which[i]].a;
		uint8_t *values = (uint8_t *)wanted[i].values;
		free(a->owned);
		*a = (struct eco_gltf_accessor){ .bytes = values, .owned = values, .count = mesh.points,
			.stride = a->components * sizeof(float), .components = a->components, .type = 5126,
			.divisor = a->divisor };
	}
	r->vertex_count = mesh.points;
	r->index_count = (uint64_t)mesh.faces * 3;
	r->indices = (struct eco_gltf_accessor){ .bytes = (uint8_t *)mesh.index,
		.owned = (uint8_t *)mesh.index,
		.count = r->index_count, .stride = sizeof *mesh.index, .components = 1, .type = 5125 };
	r->indexed = r->draco = true;
	return ECO_OK;
}

/* ---- Triangles ---- */

static enum eco_code open_indices(struct gltf_reader *r)
{
	r->index_count = r->vertex_count;
	if (!json_object_get(r->primitive, "indices"))
		return ECO_OK;
	enum eco_code code = eco_gltf_accessor_open(r->doc, eco_gltf_index(r->primitive, "indices"), 1,
		&r->indices,
		r->error);
	r->index_count = r->indices.count;
	r->indexed = true;
	return code;
}

static uint32_t index_at(const struct gltf_reader *r, uint64_t i)
{
	return r->indexed ? eco_gltf_element_index(&r->indices, i) : (uint32_t)i;
}

/* The greatest index of a type is no index: it begins the next strip. */
static bool is_restart(const struct gltf_reader *r, uint32_t index)
{
	return r->indexed && index == (r->indices.type == 5121 ? 0xff : r->indices.type == 5123 ? 0xffff
		: UINT32_MAX);
}

static void add_triangle(struct gltf_reader *r, uint32_t a, uint32_t b, uint32_t c)
{
	const uint32_t v[3] = { a, b, c };
	uint32_t *to = &r->to->index[(size_t)r->to->triangle_count++ * 3];
	for (int k = 0; k < 3; k++)
		to[k] = v[k] < r->vertex_count ? v[k] : ECO_NONE;
}

static void add_strip(struct gltf_reader *r, bool fan)
{
	uint32_t first = 0, last = 0;
	uint64_t length = 0;
	for (uint64_t i = 0; i < r->index_count; i++, length++) {
		uint32_t index = index_at(r, i);
		if (is_restart(r, index)) {
			length = UINT64_MAX;         /* 0 after this turn */
			continue;
		}
		if (length >= 2 && (fan || length % 2 == 0))
			add_triangle(r, first, last, index);
		else if (length >= 2)
			add_triangle(r, last, first, index);
		if (length == 0)
			first = index;
		else if (!fan && length >= 2)
			first = last;
		last = index;
	}
}

static enum eco_code read_triangles(struct gltf_reader *r, uint64_t mode)
{
	uint64_t most = mode == TRIANGLES ? r->index_count / 3 : r->index_count > 2 ? r->index_count - 2 : 0;
	ECO_PASS(gltf_too_many(r, most));
	r->to->index = eco_alloc((size_t)most, 3 * sizeof *r->to->index);
	if (mode != TRIANGLES) {
		add_strip(r, mode == TRIANGLE_FAN);
		return ECO_OK;
	}
	for (uint64_t i = 0; i + 2 < r->index_count; i += 3)
		add_triangle(r, index_at(r, i), index_at(r, i + 1), index_at(r, i + 2));
	r->partial += r->index_count % 3;
	return ECO_OK;
}

/* Renumbers the vertices in use, in the file's order. */
static void compact(struct gltf_reader *r)
{
	struct gltf_piece *p = r->to;
	uint32_t *number = eco_alloc((size_t)r->vertex_count, sizeof *number);
	size_t corners = (size_t)p->triangle_count * 3;
	for (size_t i = 0; i < corners; i++)
		if (p->index[i] != ECO_NONE)
			number[p->index[i]] = 1;
	for (uint64_t v = 0; v < r->vertex_count; v++)
		p->vertex_count += number[v];
	p->source = eco_alloc(p->vertex_count, sizeof *p->source);
	p->vertex_count = 0;
	for (uint64_t v = 0; v < r->vertex_count; v++)
		if (number[v] != 0) {
			p->source[p->vertex_count] = (uint32_t)v;
			number[v] = p->vertex_count++;
		}
	for (size_t i = 0; i < corners; i++)
		if (p->index[i] != ECO_NONE)
			p->index[i] = number[p->index[i]];
	free(number);
}

static void look_at_vertices(struct gltf_reader *r)
{
	const struct gltf_piece *p = r->to;
	bool single = p->values[GLTF_POSITION].a.type == 5126 && !r->draco,
	     alpha = p->values[GLTF_COLOR].there && p->values[GLTF_COLOR].a.components == 4;
	for (uint32_t v = 0; v < p->vertex_count; v++) {
		double values[4] = { 0, 0, 0, 1 };
		if (alpha && gltf_values(p, GLTF_COLOR, p->source[v], values))
			r->faint += values[3] < 0.5;
		if (single && gltf_values(p, GLTF_POSITION, p->source[v], values))
			r->to->far = fmax(r->to->far, fmax(fmax(fabs(values[0]), fabs(values[1])),
				fabs(values[2])));
	}
}

/* ---- Primitives and meshes ---- */

/* Counts points and lines, which are not drawn. */
static enum eco_code count_others(struct gltf_reader *r, uint64_t mode)
{
	ECO_PASS(open_attribute(r, GLTF_POSITION, "POSITION"));
	r->vertex_count = r->to->values[GLTF_POSITION].a.count;
	ECO_PASS(open_indices(r));
	uint64_t n = r->index_count;
	if (mode == POINTS)
		r->points += n;
	else
		r->lines += mode == LINES ? n / 2 : mode == LINE_LOOP || n == 0 ? n : n - 1;
	return ECO_OK;
}

static enum eco_code read_primitive(struct gltf_reader *r)
{
	const json_t *draco = eco_gltf_extension(r->primitive, "KHR_draco_mesh_compression");
	uint64_t mode = eco_gltf_whole(r->primitive, "mode", TRIANGLES);
	uint64_t material = eco_gltf_whole(r->primitive, "material", UINT64_MAX);
	r->to->material = material < r->look_count ? (uint32_t)material : r->look_count;
	struct gltf_look *look = &r->looks[r->to->material];
	look->used = true;
	if (mode > TRIANGLE_FAN)
		return fail(r, ECO_DAMAGED, "its mode is none that glTF knows");
	if (mode < TRIANGLES)
		return count_others(r, mode);
	ECO_PASS(open_attributes(r, look));
	if (!r->to->values[GLTF_POSITION].there) {
		r->shapeless++;
		return ECO_OK;
	}
	r->vertex_count = r->to->values[GLTF_POSITION].a.count;
	ECO_PASS(draco ? open_draco(r, draco, look) : open_indices(r));
	ECO_PASS(read_triangles(r, draco ? TRIANGLES : mode));
	compact(r);
	look_at_vertices(r);
	return ECO_OK;
}

static bool has_weights(const json_t *mesh)
{
	const json_t *weights = json_object_get(mesh, "weights");
	for (size_t i = 0; i < json_array_size(weights); i++)
		if (json_number_value(json_array_get(weights, i)) != 0)
			return true;
	return false;
}

enum eco_code gltf_mesh_read(struct gltf_reader *r, uint32_t number)
{
	const json_t *json = eco_gltf_item(r->doc, "meshes", number), *primitives = json_object_get(json,
		"primitives");
	enum eco_code code = ECO_OK;
	if (!json)
		return eco_fail(r->error, ECO_DAMAGED, "%.300s: names mesh %u, which is not there",
			r->doc->path,
			number);
	struct gltf_mesh *mesh = &r->meshes[number];
	if (mesh->read)
		return ECO_OK;
	*mesh = (struct gltf_mesh){ .read = true, .first = r->piece_count };
	r->mesh = number;
	for (size_t i = 0; i < json_array_size(primitives) && code == ECO_OK; i++) {
		eco_grow(&r->pieces, &r->piece_room, r->piece_count, sizeof *r->pieces);
		r->to = &r->pieces[r->piece_count++];
		*r->to = (struct gltf_piece){ .index = NULL };
		r->primitive = json_array_get(primitives, i);
		r->number = (uint32_t)i;
		r->indexed = r->draco = false;
		code = read_primitive(r);
		eco_gltf_accessor_close(&r->indices);
		mesh->count++;
		mesh->triangles += r->to->triangle_count;
		r->morphed += has_weights(json);
		r->read += r->to->triangle_count;
	}
	return code ? code : gltf_too_many(r, r->read);
}

void gltf_piece_free(struct gltf_piece *p)
{
	for (int i = 0; i < GLTF_ATTRIBUTES; i++)
		eco_gltf_accessor_close(&p->values[i].a);
	free(p->index);
	free(p->source);
}
