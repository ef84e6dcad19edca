/* One primitive of a glTF mesh, from accessors or a Draco stream, as triangles with the vertices in use.
 * Other vertices are dropped here: exporters let all primitives of a file share one large buffer. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/draco_shim.h"

enum mode { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN };

enum attribute { POSITION, TEXCOORD, COLOR, JOINTS, WEIGHTS = JOINTS + GLTF_INFLUENCES_MAX / 4,
	ATTRIBUTES = WEIGHTS + GLTF_INFLUENCES_MAX / 4 };

struct attribute_values {        /* of all vertices of the file */
	bool there;
	struct eco_gltf_accessor accessor;
	float *draco;                /* replaces the accessor: its components per vertex */
};

struct reader {
	const struct gltf_surface_source *from;
	struct gltf_surface *to;
	struct attribute_values values[ATTRIBUTES];
	uint64_t vertex_count;       /* in the file */
	struct eco_gltf_accessor indices;
	uint32_t *draco_index;       /* replaces the accessor */
	bool indexed;
	uint64_t index_count;
	struct eco_error *error;
};

static enum eco_code fail(const struct reader *r, enum eco_code code, const char *says)
{
	return eco_fail(r->error, code, "%.300s: meshes[%u].primitives[%u]: %s", eco_gltf_path(r->from->doc),
		r->from->mesh, r->from->number, says);
}

/* ---- Attributes ---- */

static void name_of(enum attribute which, const struct gltf_look *look, char name[32])
{
	if (which == POSITION)
		snprintf(name, 32, "POSITION");
	else if (which == TEXCOORD)
		snprintf(name, 32, "TEXCOORD_%u", look->uv_set);
	else if (which == COLOR)
		snprintf(name, 32, "COLOR_0");
	else if (which < WEIGHTS)
		snprintf(name, 32, "JOINTS_%u", (unsigned)(which - JOINTS));
	else
		snprintf(name, 32, "WEIGHTS_%u", (unsigned)(which - WEIGHTS));
}

/* Unneeded attributes are not read, and may be broken. */
static bool is_wanted(const struct reader *r, enum attribute which, const struct gltf_look *look)
{
	if (which == TEXCOORD)
		return look->textured && !look->invisible;
	return which < JOINTS || json_array_size(json_object_get(eco_gltf_json(r->from->doc), "skins")) > 0;
}

static bool components_fit(enum attribute which, uint32_t components)
{
	return components == (which == POSITION ? 3u : which == TEXCOORD ? 2u : 4u)
		|| (which == COLOR && components == 3);
}

static enum eco_code open_attribute(struct reader *r, enum attribute which, const char *name)
{
	const json_t *attributes = json_object_get(r->from->primitive, "attributes");
	struct attribute_values *v = &r->values[which];
	if (!json_object_get(attributes, name))
		return ECO_OK;
	enum eco_code code = eco_gltf_accessor_open(r->from->doc, eco_gltf_index(attributes, name), 0,
		&v->accessor, r->error);
	if (code)
		return code;
	if (!components_fit(which, v->accessor.components))
		return fail(r, ECO_DAMAGED, "an attribute with a wrong number of components");
	v->there = true;
	return ECO_OK;
}

static enum eco_code open_attributes(struct reader *r, const struct gltf_look *look)
{
	enum eco_code code = ECO_OK;
	for (int i = 0; i < ATTRIBUTES && code == ECO_OK; i++) {
		char name[32];
		name_of((enum attribute)i, look, name);
		if (is_wanted(r, (enum attribute)i, look))
			code = open_attribute(r, (enum attribute)i, name);
		if (code == ECO_OK && i == TEXCOORD && !r->values[i].there && look->uv_set != 0
				&& is_wanted(r, TEXCOORD, look))
			code = open_attribute(r, TEXCOORD, "TEXCOORD_0");
	}
	return code;
}

static void vertex_values(const struct reader *r, enum attribute which, uint32_t vertex, double *values)
{
	static const double most[] = { 127, 255, 32767, 65535 };
	const struct attribute_values *v = &r->values[which];
	if (!v->draco) {
		eco_gltf_element(&v->accessor, vertex, values);
		return;
	}
	for (uint32_t c = 0; c < v->accessor.components; c++) {
		values[c] = (double)v->draco[(size_t)vertex * v->accessor.components + c];
		if (v->accessor.normalized && v->accessor.type <= 5123)
			values[c] = fmax(values[c] / most[v->accessor.type - 5120], -1);
	}
}

/* ---- Draco ---- */

static uint32_t faces_declared(const struct reader *r)
{
	const json_t *accessor = eco_gltf_item(r->from->doc, "accessors",
		eco_gltf_whole(r->from->primitive, "indices", UINT64_MAX));
	uint64_t count = eco_gltf_whole(accessor, "count", UINT64_MAX);
	return accessor && count / 3 < r->from->triangles_max ? (uint32_t)(count / 3)
		: r->from->triangles_max;
}

/* Finds Draco's attributes among those needed. The others keep their accessors, if these have data. */
static uint32_t match_attributes(struct reader *r, const json_t *ids, const struct gltf_look *look,
	struct eco_draco_attribute *wanted, enum attribute *which)
{
	uint32_t count = 0;
	for (int i = 0; i < ATTRIBUTES; i++) {
		char name[32];
		name_of((enum attribute)i, look, name);
		uint32_t id = eco_gltf_index(ids, name);
		if (id == ECO_NONE && i == TEXCOORD)
			id = eco_gltf_index(ids, "TEXCOORD_0");
		if (id == ECO_NONE || !r->values[i].there)
			continue;
		wanted[count] = (struct eco_draco_attribute){ .id = id,
			.components = (uint8_t)r->values[i].accessor.components };
		which[count++] = (enum attribute)i;
	}
	return count;
}

static enum eco_code open_draco(struct reader *r, const json_t *extension, const struct gltf_look *look)
{
	struct eco_draco_attribute wanted[ATTRIBUTES];
	enum attribute which[ATTRIBUTES];
	struct eco_draco_mesh mesh;
	struct eco_error inner = { .code = ECO_OK };
	uint32_t count = match_attributes(r, json_object_get(extension, "attributes"), look, wanted, which),
		faces = faces_declared(r);
	const uint8_t *bytes;
	size_t size;
	enum eco_code code = eco_gltf_view(r->from->doc, eco_gltf_index(extension, "bufferView"), &bytes,
		&size, r->error);
	if (code)
		return code;
	if (count == 0 || which[0] != POSITION)
		return fail(r, ECO_DAMAGED, "its Draco stream has no positions");
	if (eco_draco_decode_gltf(bytes, size, faces, faces > UINT32_MAX / 3 ? UINT32_MAX : 3 * faces, wanted,
		count, &mesh, &inner) != ECO_OK)
		return fail(r, inner.code, inner.text);
	for (uint32_t i = 0; i < count; i++)
		r->values[which[i]].draco = wanted[i].values;
	r->vertex_count = mesh.points;
	r->draco_index = mesh.index;
	r->index_count = (uint64_t)mesh.faces * 3;
	r->indexed = true;
	return ECO_OK;
}

/* ---- Triangles ---- */

static uint32_t index_at(const struct reader *r, uint64_t i)
{
	return r->draco_index ? r->draco_index[i] : r->indexed ? eco_gltf_element_index(&r->indices, i)
		: (uint32_t)i;
}

/* The greatest index of a type is no index: it begins the next strip. */
static bool is_restart(const struct reader *r, uint32_t index)
{
	return r->indexed && !r->draco_index
		&& index == (r->indices.type == 5121 ? 0xff : r->indices.type == 5123 ? 0xffff : UINT32_MAX);
}

static void add_triangle(struct reader *r, uint32_t a, uint32_t b, uint32_t c)
{
	const uint32_t v[3] = { a, b, c };
	for (int k = 0; k < 3; k++)
		r->to->index[(size_t)r->to->triangle_count * 3 + (size_t)k] = v[k] < r->vertex_count ? v[k]
			: ECO_NONE;
	r->to->triangle_count++;
}

static void add_strip(struct reader *r, bool fan)
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

static enum eco_code read_triangles(struct reader *r, uint64_t mode)
{
	uint64_t most = mode == TRIANGLES ? r->index_count / 3 : r->index_count > 2 ? r->index_count - 2 : 0;
	if (most > r->from->triangles_max)
		return eco_fail(r->error, ECO_TOO_LARGE, "%.300s: %llu triangles, at most %u are possible",
			eco_gltf_path(r->from->doc), (unsigned long long)most, r->from->triangles_max);
	r->to->index = eco_alloc((size_t)most + 1, 3 * sizeof *r->to->index);
	if (mode != TRIANGLES) {
		add_strip(r, mode == TRIANGLE_FAN);
		return ECO_OK;
	}
	for (uint64_t i = 0; i + 2 < r->index_count; i += 3)
		add_triangle(r, index_at(r, i), index_at(r, i + 1), index_at(r, i + 2));
	r->from->counts->partial += r->index_count % 3;
	return ECO_OK;
}

static enum eco_code open_indices(struct reader *r)
{
	r->index_count = r->vertex_count;
	if (!json_object_get(r->from->primitive, "indices"))
		return ECO_OK;
	enum eco_code code = eco_gltf_accessor_open(r->from->doc,
		eco_gltf_index(r->from->primitive, "indices"), 1, &r->indices, r->error);
	r->index_count = r->indices.count;
	r->indexed = true;
	return code;
}

/* ---- Vertices ---- */

/* Renumbers the vertices in use, in the file's order; returns the old numbers. */
static uint32_t *compact(struct reader *r)
{
	struct gltf_surface *s = r->to;
	uint32_t *number = eco_alloc((size_t)r->vertex_count + 1, sizeof *number);
	size_t corners = (size_t)s->triangle_count * 3;
	for (size_t i = 0; i < corners; i++)
		if (s->index[i] != ECO_NONE)
			number[s->index[i]] = 1;
	for (uint64_t v = 0; v < r->vertex_count; v++)
		if (number[v] != 0)
			number[v] = ++s->vertex_count;
	uint32_t *source = eco_alloc((size_t)s->vertex_count + 1, sizeof *source);
	for (uint64_t v = 0; v < r->vertex_count; v++)
		if (number[v] != 0)
			source[number[v] - 1] = (uint32_t)v;
	for (size_t i = 0; i < corners; i++)
		if (s->index[i] != ECO_NONE)
			s->index[i] = number[s->index[i]] - 1;
	free(number);
	return source;
}

/* A vertex beyond an attribute's end stays 0: the exporter made one accessor too short. */
static bool has_value(const struct reader *r, enum attribute which, uint32_t vertex)
{
	const struct attribute_values *v = &r->values[which];
	return v->there && (v->draco || vertex < v->accessor.count);
}

static void take_vertex(struct reader *r, const struct gltf_look *look, uint32_t from, uint32_t to)
{
	struct gltf_surface *s = r->to;
	double values[4] = { 0, 0, 0, 0 };
	vertex_values(r, POSITION, from, values);
	for (int k = 0; k < 3; k++) {
		s->position[(size_t)to * 3 + (size_t)k] = (float)values[k];
		if (r->values[POSITION].accessor.type == 5126 && !r->values[POSITION].draco)
			s->far = fmax(s->far, fabs(values[k]));
	}
	if (s->uv && has_value(r, TEXCOORD, from)) {
		vertex_values(r, TEXCOORD, from, values);
		gltf_look_apply(look, values, &s->uv[(size_t)to * 2]);
	}
	if (s->color) {
		values[0] = values[1] = values[2] = values[3] = 1;
		if (has_value(r, COLOR, from))
			vertex_values(r, COLOR, from, values);
		for (int k = 0; k < 3; k++)
			s->color[(size_t)to * 3 + (size_t)k] = isfinite(values[k]) ? (float)values[k] : 1;
		r->from->counts->faint += r->values[COLOR].accessor.components == 4 && values[3] < 0.5;
	}
}

static void take_joints(struct reader *r, uint32_t from, uint32_t to)
{
	struct gltf_surface *s = r->to;
	for (uint32_t set = 0; set < s->influences / 4; set++) {
		double joints[4] = { 0, 0, 0, 0 }, weights[4] = { 0, 0, 0, 0 };
		if (has_value(r, (enum attribute)(JOINTS + set), from)
				&& has_value(r, (enum attribute)(WEIGHTS + set), from)) {
			vertex_values(r, (enum attribute)(JOINTS + set), from, joints);
			vertex_values(r, (enum attribute)(WEIGHTS + set), from, weights);
		}
		for (uint32_t i = 0; i < 4; i++) {
			s->joint[(size_t)to * s->influences + set * 4 + i] = joints[i] >= 0
				&& joints[i] < ECO_NONE ? (uint32_t)joints[i] : ECO_NONE;
			s->weight[(size_t)to * s->influences + set * 4 + i] = isfinite(weights[i])
				? (float)weights[i] : 0;
		}
	}
}

static void take_memory(struct reader *r)
{
	struct gltf_surface *s = r->to;
	size_t n = (size_t)s->vertex_count + 1;
	while (s->influences < GLTF_INFLUENCES_MAX && r->values[JOINTS + s->influences / 4].there
		&& r->values[WEIGHTS + s->influences / 4].there)
		s->influences += 4;
	s->position = eco_alloc(n * 3, sizeof *s->position);
	s->uv = r->values[TEXCOORD].there ? eco_alloc(n * 2, sizeof *s->uv) : NULL;
	s->color = r->values[COLOR].there ? eco_alloc(n * 3, sizeof *s->color) : NULL;
	s->joint = s->influences > 0 ? eco_alloc(n * s->influences, sizeof *s->joint) : NULL;
	s->weight = s->influences > 0 ? eco_alloc(n * s->influences, sizeof *s->weight) : NULL;
}

/* ---- The primitive ---- */

static void read_vertices(struct reader *r, const struct gltf_look *look)
{
	uint32_t *source = compact(r);
	take_memory(r);
	for (uint32_t v = 0; v < r->to->vertex_count; v++) {
		take_vertex(r, look, source[v], v);
		take_joints(r, source[v], v);
	}
	free(source);
}

/* Counts points and lines, which are not drawn. */
static enum eco_code count_others(struct reader *r, uint64_t mode)
{
	enum eco_code code = open_attribute(r, POSITION, "POSITION");
	r->vertex_count = r->values[POSITION].accessor.count;
	if (!code)
		code = open_indices(r);
	uint64_t n = r->index_count;
	if (mode == POINTS)
		r->from->counts->points += n;
	else
		r->from->counts->lines += mode == LINES ? n / 2 : mode == LINE_LOOP || n == 0 ? n : n - 1;
	return code;
}

static enum eco_code read_primitive(struct reader *r)
{
	const json_t *draco = eco_gltf_extension(r->from->primitive, "KHR_draco_mesh_compression");
	uint64_t mode = eco_gltf_whole(r->from->primitive, "mode", TRIANGLES);
	uint64_t material = eco_gltf_whole(r->from->primitive, "material", UINT64_MAX);
	r->from->counts->morphed += r->from->morphed;
	r->to->material = material < r->from->look_count ? (uint32_t)material : r->from->look_count;
	const struct gltf_look *look = &r->from->looks[r->to->material];
	if (mode > TRIANGLE_FAN)
		return fail(r, ECO_DAMAGED, "its mode is none that glTF knows");
	if (mode < TRIANGLES)
		return count_others(r, mode);
	enum eco_code code = open_attributes(r, look);
	if (code == ECO_OK && !r->values[POSITION].there) {
		r->from->counts->shapeless++;
		return ECO_OK;
	}
	r->vertex_count = r->values[POSITION].accessor.count;
	if (!code)
		code = draco ? open_draco(r, draco, look) : open_indices(r);
	if (!code)
		code = read_triangles(r, draco ? TRIANGLES : mode);
	if (!code)
		read_vertices(r, look);
	return code;
}

enum eco_code gltf_surface_read(struct gltf_surface *surface, const struct gltf_surface_source *source,
	struct eco_error *error)
{
	struct reader r = { .from = source, .to = surface, .error = error };
	*surface = (struct gltf_surface){ .position = NULL };
	enum eco_code code = read_primitive(&r);
	for (int i = 0; i < ATTRIBUTES; i++) {
		eco_gltf_accessor_close(&r.values[i].accessor);
		free(r.values[i].draco);
	}
	eco_gltf_accessor_close(&r.indices);
	free(r.draco_index);
	if (code)
		gltf_surface_free(surface);
	return code;
}

void gltf_surface_free(struct gltf_surface *s)
{
	free(s->position);
	free(s->uv);
	free(s->color);
	free(s->index);
	free(s->joint);
	free(s->weight);
	*s = (struct gltf_surface){ .position = NULL };
}

/* ---- Skins at rest: joints place a skinned mesh. The specification says to ignore its node's own place,
 * which is wrong by a factor of a hundred in files whose skeletons carry the scale or the axis ---- */

static enum eco_code read_inverse(struct eco_gltf *doc, const json_t *json, struct eco_gltf_accessor *inverse,
	struct eco_error *error)
{
	*inverse = (struct eco_gltf_accessor){ .bytes = NULL };
	if (!json_object_get(json, "inverseBindMatrices"))
		return ECO_OK;
	return eco_gltf_accessor_open(doc, eco_gltf_index(json, "inverseBindMatrices"), 16, inverse, error);
}

enum eco_code gltf_skin_read(struct gltf_skin *skin, struct eco_gltf *doc, uint32_t index,
	struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "skins", index), *joints = json_object_get(json, "joints");
	size_t count = json_array_size(joints);
	struct eco_gltf_accessor inverse;
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names skin %u, which is not there",
			eco_gltf_path(doc), index);
	enum eco_code code = read_inverse(doc, json, &inverse, error);
	if (code)
		return code;
	skin->matrix = eco_alloc(count + 1, 16 * sizeof *skin->matrix);
	skin->count = (uint32_t)count;
	for (size_t i = 0; i < count && code == ECO_OK; i++) {
		json_int_t node = json_is_integer(json_array_get(joints, i))
			? json_integer_value(json_array_get(joints, i)) : -1;
		double *matrix = &skin->matrix[i * 16], bind[16];
		code = eco_gltf_node_matrix(doc, node >= 0 && node < ECO_NONE ? (uint32_t)node : ECO_NONE,
			matrix, error);
		if (code == ECO_OK && i < inverse.count) {
			eco_gltf_element(&inverse, i, bind);
			eco_gltf_multiply(matrix, matrix, bind);
		}
	}
	eco_gltf_accessor_close(&inverse);
	return code;
}

bool gltf_skin_place(const struct gltf_skin *skin, const struct gltf_surface *s, uint32_t v, double out[3])
{
	const double from[3] = { (double)s->position[(size_t)v * 3], (double)s->position[(size_t)v * 3 + 1],
		(double)s->position[(size_t)v * 3 + 2] };
	double sum = 0, to[3] = { 0, 0, 0 };
	for (uint32_t i = 0; i < s->influences; i++) {
		uint32_t joint = s->joint[(size_t)v * s->influences + i];
		double weight = (double)s->weight[(size_t)v * s->influences + i], place[3];
		if (!(weight > 0) || joint >= skin->count)
			continue;
		eco_gltf_apply(&skin->matrix[(size_t)joint * 16], from, place);
		for (int k = 0; k < 3; k++)
			to[k] += weight * place[k];
		sum += weight;
	}
	for (int k = 0; k < 3; k++)
		out[k] = sum > 0 ? to[k] / sum : 0;
	return sum > 0;
}
