/* Contents of tiles: glTF 2.0 whose plants are instances of shared files (EXT_mesh_gpu_instancing), each with
 * its species and height (EXT_instance_features, EXT_structural_metadata). Z is up, and turned; places count
 * from the tile's middle.
 * Longer than 600 lines: all parts of a content fill one document and its buffer. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/version.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/legend.h"
#include "lod/eye.h"
#include "lod/light.h"
#include "lod/tint.h"

#define MESHOPT "EXT_meshopt_compression"
#define SUMMARY_POINTS 2000u
#define SUMMARY_WIDTHS 4.0
#define SUMMARY_STEPS 128        /* in a summary's error: it is rounded to an eighth of a pixel, or less */

/* ---- Documents ---- */

/* fallback: the buffer where compressed views would lie if they were not; NULL: none is compressed */
struct document { json_t *root, *fallback; json_int_t fallback_at; };

static const char *const arrays[] = { "buffers", "bufferViews", "accessors", "meshes", "materials",
	"textures", "images" };
#define ARRAYS (sizeof arrays / sizeof *arrays)

/* Nodes 0 and 1 turn Z up to Y up and move to the tile's middle; those added lie below. */
static void document_begin(struct document *d, const double middle[3])
{
	double r = sqrt(0.5);
	*d = (struct document){ .root = json_pack("{s:{s:s, s:s}, s:i, s:[{s:[i]}], s:[{s:[f,i,i,f], s:[i]}, "
						  "{s:[f,f,f]}]}",
					"asset", "version", "2.0", "generator", "ecopack " ECO_VERSION,
					"scene", 0, "scenes", "nodes", 0, "nodes", "rotation", -r, 0, 0, r,
					"children", 1, "translation", middle[0], middle[1], middle[2]) };
	for (size_t i = 0; i < ARRAYS; i++)
		json_object_set_new(d->root, arrays[i], json_array());
}

/* Returns the item's number. */
static json_int_t add(struct document *d, const char *array, json_t *item)
{
	json_t *items = json_object_get(d->root, array);
	json_array_append_new(items, item);
	return (json_int_t)json_array_size(items) - 1;
}

static void add_node(struct document *d, json_t *node)
{
	json_t *above = json_array_get(json_object_get(d->root, "nodes"), 1);
	if (!json_object_get(above, "children"))
		json_object_set_new(above, "children", json_array());
	json_array_append_new(json_object_get(above, "children"), json_integer(add(d, "nodes", node)));
}

static json_int_t add_buffer(struct document *d, const char *uri, size_t size)
{
	return add(d, "buffers", json_pack("{s:s, s:I}", "uri", uri, "byteLength", (json_int_t)size));
}

static json_int_t add_view(struct document *d, json_int_t buffer, size_t from, size_t size, int target)
{
	json_t *view = json_pack("{s:I, s:I, s:I}", "buffer", buffer, "byteOffset", (json_int_t)from,
		"byteLength",
		(json_int_t)size);
	if (target)
		json_object_set_new(view, "target", json_integer(target));
	return add(d, "bufferViews", view);
}

/* Takes room in the fallback buffer, which no file holds. */
static json_int_t add_fallback(struct document *d, size_t size)
{
	if (!d->fallback) {
		d->fallback = json_pack("{s:i, s:{s:{s:b}}}", "byteLength", 0, "extensions", MESHOPT,
			"fallback", 1);
		d->fallback_at = add(d, "buffers", d->fallback);
	}
	json_int_t from = json_integer_value(json_object_get(d->fallback, "byteLength"));
	json_object_set_new(d->fallback, "byteLength", json_integer(from + (json_int_t)size));
	return from;
}

static json_int_t add_packed_view(struct document *d, json_int_t buffer, const struct export_part *part,
	enum export_array array, int target)
{
	size_t size = export_array_bytes(part, array),
		count = array == EXPORT_INDEX ? part->indices : part->vertices;
	size_t from = (size_t)add_fallback(d, size);
	json_int_t view = add_view(d, d->fallback_at, from, size, target);
	json_t *packed = json_pack("{s:I, s:I, s:I, s:I, s:I, s:s}", "buffer", buffer, "byteOffset",
		(json_int_t)part->at[array], "byteLength", (json_int_t)part->packed[array], "byteStride",
		(json_int_t)(size / count), "count", (json_int_t)count, "mode",
		array == EXPORT_INDEX ? "TRIANGLES" : "ATTRIBUTES");
	if (array == EXPORT_POSITION || array == EXPORT_UV)
		json_object_set_new(packed, "filter", json_string("EXPONENTIAL"));
	json_object_set_new(json_array_get(json_object_get(d->root, "bufferViews"), (size_t)view),
		"extensions", json_pack("{s:o}", MESHOPT, packed));
	return view;
}

/* An accessor of all that a view holds. */
static json_int_t add_accessor(struct document *d, json_int_t view, uint32_t count, int type,
	const char *shape)
{
	json_t *accessor = json_pack("{s:I, s:i, s:s, s:I}", "bufferView", view, "componentType", type,
		"type", shape, "count", (json_int_t)count);
	if (type == 5123)
		json_object_set_new(accessor, "normalized", json_true());
	return add(d, "accessors", accessor);
}

static json_int_t add_array(struct document *d, json_int_t buffer, const struct export_part *part,
	enum export_array array)
{
	static const struct { int type, target; const char *shape; } kinds[EXPORT_ARRAYS] = {
		{ 5126, 34962, "VEC3" }, { 5123, 34962, "VEC4" }, { 5126, 34962, "VEC2" },
		{ 5125, 34963, "SCALAR" } };
	int target = kinds[array].target;
	uint32_t count = array == EXPORT_INDEX ? part->indices : part->vertices;
	json_int_t view = part->packed[array] ? add_packed_view(d, buffer, part, array, target)
		: add_view(d, buffer, part->at[array], export_array_bytes(part, array), target);
	return add_accessor(d, view, count, kinds[array].type, kinds[array].shape);
}

/* uri: of its texture; NULL: none */
static json_int_t add_material(struct document *d, const char *uri, bool cutout, bool unlit)
{
	json_t *rough = json_pack("{s:i, s:i}", "metallicFactor", 0, "roughnessFactor", 1);
	json_t *material = json_pack("{s:b, s:o}", "doubleSided", 1, "pbrMetallicRoughness", rough);
	if (unlit)
		json_object_set_new(material, "extensions", json_pack("{s:{}}", "KHR_materials_unlit"));
	if (uri) {
		json_int_t source = add(d, "images", json_pack("{s:s}", "uri", uri)),
			texture = add(d, "textures", json_pack("{s:I}", "source", source));
		json_object_set_new(rough, "baseColorTexture", json_pack("{s:I}", "index", texture));
	}
	if (uri && cutout)
		json_object_set_new(material, "alphaMode", json_string("MASK"));
	return add(d, "materials", material);
}

/* texture: the URI of all parts' textures; NULL: those of plants */
static json_int_t add_mesh(struct document *d, const struct export_mesh *mesh, json_int_t buffer,
	const char *texture, bool unlit)
{
	json_t *primitives = json_array();
	for (uint32_t i = 0; i < mesh->part_count; i++) {
		const struct export_part *p = &mesh->parts[i];
		json_int_t position = add_array(d, buffer, p, EXPORT_POSITION),
			color = add_array(d, buffer, p, EXPORT_COLOR),
			index = add_array(d, buffer, p, EXPORT_INDEX);
		json_t *at = json_array_get(json_object_get(d->root, "accessors"), (size_t)position);
		json_object_set_new(at, "min", json_pack("[f,f,f]", (double)p->low[0], (double)p->low[1],
			(double)p->low[2]));
		json_object_set_new(at, "max", json_pack("[f,f,f]", (double)p->high[0], (double)p->high[1],
			(double)p->high[2]));
		json_t *attributes = json_pack("{s:I, s:I}", "POSITION", position, "COLOR_0", color);
		if (p->image != ECO_NONE)
			json_object_set_new(attributes, "TEXCOORD_0", json_integer(add_array(d, buffer, p,
				EXPORT_UV)));
		char uri[EXPORT_NAME];
		snprintf(uri, sizeof uri, "../plants/image-%u.png", p->image);
		json_int_t material = add_material(d,
			p->image == ECO_NONE ? NULL
				: texture    ? texture
					     : uri,
			!texture, unlit);
		json_array_append_new(primitives, json_pack("{s:o, s:I, s:I}", "attributes", attributes,
			"indices", index, "material", material));
	}
	return add(d, "meshes", json_pack("{s:o}", "primitives", primitives));
}

static void document_end(struct export *x, struct document *d, json_t *extensions, json_t *used,
	const char *name)
{
	json_t *required = json_array();
	for (size_t i = 0; i < ARRAYS; i++)
		if (!json_array_size(json_object_get(d->root, arrays[i])))
			json_object_del(d->root, arrays[i]);
	if (extensions) {
		json_object_set_new(d->root, "extensions", extensions);
		json_array_append_new(required, json_string("EXT_mesh_gpu_instancing"));
	}
	if (d->fallback) {
		json_array_append_new(required, json_string(MESHOPT));
		json_array_append_new(used, json_string(MESHOPT));
	}
	if (json_array_size(used))
		json_object_set(d->root, "extensionsUsed", used);
	if (json_array_size(required))
		json_object_set(d->root, "extensionsRequired", required);
	json_decref(used);
	json_decref(required);
	export_json(x, name, d->root);
}

static void middle_of(const struct eco_tile *tile, double middle[3])
{
	for (int k = 0; k < 3; k++)
		middle[k] = (tile->low[k] + tile->high[k]) / 2;
}

/* ---- Instances ---- */

/* Offsets in a tile's file: translations, turns, scales, numbers and, with tints, colours by group, then
 * heights and texts: species and, with tints, classes. */
struct layout { size_t *group, height, name[2], offset[2], end; char **texts[2]; uint32_t count, kinds; };

static size_t aligned(size_t at) { return (at + 7) & ~(size_t)7; }

static void layout_free(struct layout *l)
{
	for (uint32_t k = 0; k < l->kinds; k++) {
		for (uint32_t i = 0; i < l->count && l->texts[k]; i++)
			free(l->texts[k][i]);
		free(l->texts[k]);
	}
	free(l->group);
}

/* A plant of the pack may stand for several species: each place says its own, and its class. */
static void find_texts(struct export *x, const struct eco_tile *t, struct layout *l)
{
	const struct eco_scene *s = &x->pack->scene;
	const struct eco_inventory_row *row;
	for (uint32_t k = 0, at = 0; k < l->kinds; k++, at = 0) {
		l->texts[k] = eco_alloc(l->count, sizeof *l->texts[k]);
		for (uint32_t g = t->group_first; g < t->group_first + t->group_count; g++) {
			const struct eco_group *group = &s->groups[g];
			for (uint32_t i = 0; i < group->count; i++) {
				uint64_t place = group->place_first + i;
				if (k == 0)
					eco_check(eco_inventory_at(&x->rows, x->pack, place, &row, x->error));
				const char *own = k ? eco_legend_class(x->meta, s, group->list, place)
					: eco_inventory_species(row, s->plants[group->plant].name);
				l->texts[k][at++] = eco_copy_text(own ? own : "");
			}
		}
	}
}

static void lay_out(struct export *x, uint32_t tile, struct layout *l)
{
	const struct eco_scene *s = &x->pack->scene;
	const struct eco_tile *t = &s->tiles[tile];
	bool tints = s->needs & ECO_NEED_TINTS;
	*l = (struct layout){ .group = eco_alloc(t->group_count, sizeof *l->group), .kinds = tints ? 2 : 1 };
	size_t at = 0;
	for (uint32_t g = 0; g < t->group_count; g++) {
		const struct eco_group *group = &s->groups[t->group_first + g];
		l->group[g] = at;
		at += (size_t)group->count * (tints ? 56 : 44);
		l->count += group->count;
	}
	find_texts(x, t, l);
	l->height = aligned(at);
	l->end = l->height + (size_t)l->count * 4;
	for (uint32_t k = 0; k < l->kinds; k++) {
		size_t names = 0;
		for (uint32_t i = 0; i < l->count; i++)
			names += strlen(l->texts[k][i]);
		l->name[k] = aligned(l->end);
		l->offset[k] = aligned(l->name[k] + names);
		l->end = l->offset[k] + ((size_t)l->count + 1) * 4;
	}
}

/* A factor of the light of all that a plant shows, wood too, as glTF knows no more: the one of usual leaves. */
static void write_color(struct eco_writer *w, const struct eco_scene *s, uint32_t list, uint64_t place)
{
	const uint8_t *rgb = eco_legend_color(s, list, place);
	uint8_t leaf[3] = { 95, 127, 79 }, usual[3] = { 95, 127, 79 };
	lod_tint_apply(rgb ? lod_tint_word(rgb) : 0, NULL, leaf, leaf);
	for (int k = 0; k < 3; k++)
		eco_write_f32(w, (float)lod_light_of[leaf[k]] / (float)lod_light_of[usual[k]]);
}

static void write_group(struct eco_writer *w, const struct eco_scene *s, const struct eco_group *group,
	const double middle[3], uint32_t number)
{
	const struct eco_placement here = { .scale = 1 };
	for (int what = 0; what < (s->needs & ECO_NEED_TINTS ? 5 : 4); what++)
		for (uint32_t i = 0; i < group->count; i++) {
			struct eco_place p = eco_place_read(s, group->place_first + i);
			struct lod_place place;
			lod_place_instance(&place, &here, &s->lists[group->list], &p);
			double half = sqrt(fmax(0.5 + 0.5 * place.cosine, 0)),
				z = half > 1e-6 ? place.sine / (2 * half) : 1,
				length = sqrt(half * half + z * z);
			for (int k = 0; k < 3 && what == 0; k++)
				eco_write_f32(w, (float)(place.at[k] - middle[k]));
			for (int k = 0; k < 4 && what == 1; k++)
				eco_write_f32(w, k < 2 ? 0 : (float)((k == 2 ? z : half) / length));
			for (int k = 0; k < 3 && what == 2; k++)
				eco_write_f32(w, (float)(place.scale * (k < 2 ? lod_place_width(&place) : 1)));
			if (what == 3)
				eco_write_f32(w, (float)(number + i));
			if (what == 4)
				write_color(w, s, group->list, group->place_first + i);
		}
}

static void pad_to(struct eco_writer *w, size_t at)
{
	while (w->size < at && !w->failed)
		eco_write_u8(w, 0);
}

static void write_texts(struct eco_writer *w, const struct layout *l, uint32_t kind)
{
	uint32_t chars = 0;
	pad_to(w, l->name[kind]);
	for (uint32_t i = 0; i < l->count; i++)
		eco_write_bytes(w, l->texts[kind][i], strlen(l->texts[kind][i]));
	pad_to(w, l->offset[kind]);
	eco_write_u32(w, 0);
	for (uint32_t i = 0; i < l->count; i++)
		eco_write_u32(w, chars += (uint32_t)strlen(l->texts[kind][i]));
}

static void write_table(struct eco_writer *w, const struct eco_scene *s, const struct eco_tile *t,
	const struct layout *l)
{
	pad_to(w, l->height);
	for (uint32_t g = 0; g < t->group_count; g++) {
		const struct eco_group *group = &s->groups[t->group_first + g];
		for (uint32_t i = 0; i < group->count; i++)
			eco_write_f32(w, s->plants[group->plant].height_m
				* (float)eco_place_read(s, group->place_first + i).scale / 65536);
	}
	for (uint32_t kind = 0; kind < l->kinds; kind++)
		write_texts(w, l, kind);
}

void export_instances(struct export *x, uint32_t tile)
{
	const struct eco_scene *s = &x->pack->scene;
	const struct eco_tile *t = &s->tiles[tile];
	struct eco_writer w = { 0 };
	struct layout l;
	double middle[3];
	char name[EXPORT_NAME];
	uint32_t number = 0;
	lay_out(x, tile, &l);
	middle_of(t, middle);
	for (uint32_t g = 0; g < t->group_count; g++) {
		write_group(&w, s, &s->groups[t->group_first + g], middle, number);
		number += s->groups[t->group_first + g].count;
	}
	write_table(&w, s, t, &l);
	if (w.failed)
		eco_end("no memory");
	snprintf(name, sizeof name, "tiles/%u.bin", tile);
	export_file(x, name, w.bytes, w.size);
	x->instances += l.count;
	layout_free(&l);
	eco_writer_free(&w);
}

static json_t *metadata_of(struct document *d, json_int_t buffer, const struct layout *l)
{
	static const char *const names[] = { "species", "class" };
	json_t *properties = json_object(), *values = json_object();
	json_int_t heights = add_view(d, buffer, l->height, (size_t)l->count * 4, 0);
	for (uint32_t k = 0; k < l->kinds; k++) {
		json_int_t texts = add_view(d, buffer, l->name[k], l->offset[k] - l->name[k], 0),
			offsets = add_view(d, buffer, l->offset[k], ((size_t)l->count + 1) * 4, 0);
		json_object_set_new(properties, names[k], json_pack("{s:s}", "type", "STRING"));
		json_object_set_new(values, names[k], json_pack("{s:I, s:I, s:s}", "values", texts, "stringOffsets", offsets,
			"stringOffsetType", "UINT32"));
	}
	json_object_set_new(properties, "height_m", json_pack("{s:s, s:s}", "type", "SCALAR", "componentType", "FLOAT32"));
	json_object_set_new(values, "height_m", json_pack("{s:I}", "values", heights));
	json_t *schema = json_pack("{s:s, s:{s:{s:o}}}", "id", "ecostream", "classes", "plant", "properties", properties);
	json_t *table = json_pack("{s:s, s:I, s:o}", "class", "plant", "count", (json_int_t)l->count, "properties", values);
	return json_pack("{s:{s:o, s:[o]}}", "EXT_structural_metadata", "schema", schema, "propertyTables",
		table);
}

static json_int_t add_column(struct document *d, json_int_t buffer, size_t from, uint32_t count,
	const char *shape)
{
	size_t values = shape[0] == 'S' ? 1 : (size_t)(shape[3] - '0');
	return add_accessor(d, add_view(d, buffer, from, count * values * 4, 0), count, 5126, shape);
}

/* Not compressed: few plants of a kind stand in a tile, and the JSON of a compressed view outweighs what it
 * saves. */
static json_t *instances_of(struct document *d, json_int_t buffer, size_t from, uint32_t count, bool tints)
{
	size_t n = count;
	json_int_t at = add_column(d, buffer, from, count, "VEC3"),
		turn = add_column(d, buffer, from + 12 * n, count, "VEC4"),
		scale = add_column(d, buffer, from + 28 * n, count, "VEC3"),
		id = add_column(d, buffer, from + 40 * n, count, "SCALAR");
	json_t *attributes = json_pack("{s:I, s:I, s:I, s:I}", "TRANSLATION", at, "ROTATION", turn, "SCALE", scale,
		"_FEATURE_ID_0", id);
	if (tints)
		json_object_set_new(attributes, "_COLOR_0", json_integer(add_column(d, buffer, from + 44 * n, count, "VEC3")));
	return json_pack("{s:{s:o}, s:{s:[{s:I, s:i, s:i}]}}", "EXT_mesh_gpu_instancing",
		"attributes", attributes, "EXT_instance_features", "featureIds", "featureCount", (json_int_t)count, "attribute", 0,
		"propertyTable", 0);
}

static double largest_scale(const struct eco_scene *s, const struct eco_group *group)
{
	double largest = 0;
	for (uint32_t i = 0; i < group->count; i++) {
		struct eco_place place = eco_place_read(s, group->place_first + i);
		largest = fmax(largest, place.scale / 65536.0 * fmax(eco_place_width(place.width), 1));
	}
	return largest;
}

void export_level(struct export *x, uint32_t tile, uint32_t level, char name[EXPORT_NAME], double *error_m)
{
	const struct eco_scene *s = &x->pack->scene;
	const struct eco_tile *t = &s->tiles[tile];
	struct document d;
	struct layout l;
	double middle[3];
	char uri[EXPORT_NAME];
	lay_out(x, tile, &l);
	*error_m = 0;
	middle_of(t, middle);
	document_begin(&d, middle);
	snprintf(uri, sizeof uri, "%u.bin", tile);
	json_int_t instances = add_buffer(&d, uri, l.end);
	for (uint32_t g = 0; g < t->group_count; g++) {
		const struct eco_group *group = &s->groups[t->group_first + g];
		const struct export_plant *plant = &x->plants[group->plant];
		uint32_t own = level < plant->levels ? level : plant->levels - 1;
		if (!group->count || !plant->level[own].part_count)
			continue;
		snprintf(uri, sizeof uri, "../plants/%u-%u.bin", group->plant, own);
		json_int_t mesh = add_mesh(&d, &plant->level[own], add_buffer(&d, uri,
			plant->level[own].bytes), NULL, false);
		add_node(&d, json_pack("{s:s, s:I, s:o*, s:o}", "name", s->plants[group->plant].name, "mesh", mesh,
			"extras", export_is_object(x, group->plant) ? json_pack("{s:b}", "object", 1) : NULL, "extensions", instances_of(&d, instances, l.group[g], group->count, s->needs & ECO_NEED_TINTS)));
		*error_m = fmax(*error_m, plant->error_m[own] * largest_scale(s, group));
	}
	json_t *extensions = metadata_of(&d, instances, &l);
	snprintf(name, EXPORT_NAME, "tiles/%u-%u.gltf", tile, level);
	layout_free(&l);
	document_end(x, &d, extensions, json_pack("[s,s,s]", "EXT_mesh_gpu_instancing", "EXT_instance_features",
		"EXT_structural_metadata"), name);
}

/* ---- Summaries and ground ---- */

struct content {
	const double *middle;
	const char *texture, *stem;      /* a file in tiles/ for vertices with uv, or NULL; tiles/STEM.gltf */
	double precision_m;              /* of positions; 0: export_mesh's */
	bool unlit;
};

static void write_baked(struct export *x, const struct lod_bake *bake, const struct content *c)
{
	struct export_mesh mesh = { .precision_m = c->precision_m };
	struct eco_writer file = { 0 };
	char name[EXPORT_NAME], uri[EXPORT_NAME];
	const uint32_t image = c->texture ? 0 : ECO_NONE;
	struct document d;
	export_mesh_make(x, &mesh, &file, bake, &image, 1);
	snprintf(uri, sizeof uri, "%s.bin", c->stem);
	snprintf(name, sizeof name, "tiles/%.50s.bin", c->stem);
	export_file(x, name, file.bytes, file.size);
	document_begin(&d, c->middle);
	if (mesh.part_count) {
		json_int_t number = add_mesh(&d, &mesh, add_buffer(&d, uri, mesh.bytes), c->texture, c->unlit);
		add_node(&d, json_pack("{s:I}", "mesh", number));
	}
	snprintf(name, sizeof name, "tiles/%.50s.gltf", c->stem);
	document_end(x, &d, NULL, c->unlit ? json_pack("[s]", "KHR_materials_unlit") : json_array(), name);
	export_mesh_free(&mesh);
	eco_writer_free(&file);
}

/* The first points stand for all. */
void export_summary(struct export *x, uint32_t tile, char name[EXPORT_NAME], double *error_m)
{
	const struct eco_scene *s = &x->pack->scene;
	const struct eco_list *list = &s->lists[s->tiles[tile].summary];
	struct eco_elements points = { 0 };
	struct lod_geometry geometry = { 0 };
	struct lod_bake bake = { .position = NULL };
	double middle[3];
	char stem[EXPORT_NAME];
	eco_check(eco_pack_points(x->pack, s->tiles[tile].summary, &points, x->error));
	uint32_t count = points.primitive_count < SUMMARY_POINTS ? points.primitive_count : SUMMARY_POINTS;
	float scale = count ? (float)points.primitive_count / (float)count : 1;
	if (!lod_geometry_make(&geometry, list, count, false))
		eco_end("no memory");
	middle_of(&s->tiles[tile], middle);
	lod_list_geometry(list, &points, 0, count, scale, &geometry);
	for (size_t i = 0; i < (size_t)count * 3; i++)
		geometry.position[i] = (float)((double)geometry.position[i] - middle[i % 3]);
	eco_check(lod_bake_make(&bake, &(struct lod_bake_input){ list, s->palette + list->palette_first, &geometry, NULL,
		count, list->unit_area * scale }, x->error));
	*error_m = SUMMARY_WIDTHS * 2 * sqrt((double)list->unit_area * (double)scale / M_PI);
	snprintf(stem, sizeof stem, "%u-s", tile);
	write_baked(x, &bake, &(struct content){ .middle = middle, .stem = stem, .unlit = true,
		.precision_m = *error_m / SUMMARY_STEPS });
	snprintf(name, EXPORT_NAME, "tiles/%.50s.gltf", stem);
	lod_bake_free(&bake);
	lod_geometry_free(&geometry);
	eco_elements_free(&points);
}

const uint8_t export_grass[3] = { 94, 97, 58 };

static void fill_ground(struct lod_bake *bake, uint32_t columns, uint32_t rows, bool has_image)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	uint32_t *index = bake->index;
	lod_bake_color(has_image ? white : export_grass, bake->vertex_count, bake->color);
	for (uint32_t y = 0; y + 1 < rows; y++)
		for (uint32_t c = 0; c + 1 < columns; c++, index += 6) {
			uint32_t at = y * columns + c;
			memcpy(index, (const uint32_t[6]){ at, at + 1, at + columns + 1, at, at + columns + 1,
				at + columns }, 6 * sizeof *index);
		}
}

/* Along an axis of the scene's grid, which goes on to the horizon: what lies beyond the rasters is moved to
 * their border, as other viewers' globes have a ground of their own there. */
static double inside(int32_t place, uint32_t samples, uint32_t margin)
{
	return fmin(fmax(place, 0), samples - 2.0 * margin - 1);
}

/* The image and where it lies on the tile, whose positions count from its middle. */
static bool lay_image(struct export *x, struct lod_bake *bake, const double low[3], const double high[3],
	bool is_leaf, const char *texture)
{
	char name[2 * EXPORT_NAME];
	snprintf(name, sizeof name, "tiles/%s", texture);
	bool is_there = export_ground_image(x, low, high, is_leaf, name);
	for (uint32_t i = 0; i < bake->vertex_count && is_there; i++) {
		bake->uv[2 * i] = 0.5f + bake->position[3 * i] / (float)(high[0] - low[0]);
		bake->uv[2 * i + 1] = 0.5f - bake->position[3 * i + 1] / (float)(high[1] - low[1]);
	}
	return is_there;
}

void export_ground(struct export *x, uint32_t ground, char name[EXPORT_NAME], double low[3], double high[3])
{
	const struct eco_scene *s = &x->pack->scene;
	const struct eco_list *list = &s->lists[s->ground[ground].list];
	struct eco_ground_span spans[2];
	struct eco_elements samples = { 0 };
	struct lod_bake bake = { .position = NULL };
	char stem[EXPORT_NAME];
	eco_ground_spans(&spans[0], &spans[1], &s->ground[ground], s->ground_columns, s->ground_rows);
	uint32_t columns = spans[0].inner, rows = spans[1].inner;
	const uint8_t *bytes;
	size_t size;
	eco_check(eco_pack_payload(x->pack, list->chunk_first, &bytes, &size, x->error));
	eco_check(eco_chunk_decode(list, &s->chunks[list->chunk_first], 0, bytes, size, &samples, x->error));
	if (samples.element_count != spans[0].count * spans[1].count)
		eco_stop(ECO_DAMAGED, "ground tile %u has not as many samples as it should", ground);
	eco_check(lod_bake_room(&bake, (size_t)columns * rows, (size_t)(columns - 1) * (rows - 1) * 6,
		s->ground_image_count > 0, x->error));
	for (int k = 0; k < 3; k++)
		low[k] = INFINITY, high[k] = -INFINITY;
	/* the first pass finds the middle */
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t i = 0; i < columns * rows; i++) {
			size_t at = (size_t)(i / columns + spans[1].before) * spans[0].count + i % columns
				+ spans[0].before;
			for (int k = 0; k < 3; k++) {
				int32_t place = samples.position[3 * at + (size_t)k];
				double p = list->grid_origin[k] + list->grid_step[k] * (k == 2 ? place
					: inside(place, k ? s->ground_rows : s->ground_columns,
						s->ground_margin));
				low[k] = fmin(low[k], p), high[k] = fmax(high[k], p);
				bake.position[3 * i + (uint32_t)k] = (float)(p - (low[k] + high[k]) / 2);
			}
		}
	bool is_outside = low[0] == high[0] || low[1] == high[1];
	snprintf(stem, sizeof stem, "ground-%u", ground);
	name[0] = 0;
	if (!is_outside) {
		snprintf(name, EXPORT_NAME, "tiles/%.50s.gltf", stem);
		const double middle[3] = { (low[0] + high[0]) / 2, (low[1] + high[1]) / 2,
			(low[2] + high[2]) / 2 };
		char texture[EXPORT_NAME];
		snprintf(texture, sizeof texture, "%.50s.png", stem);
		bool has_image = lay_image(x, &bake, low, high, !s->ground[ground].child_count, texture);
		fill_ground(&bake, columns, rows, has_image);
		write_baked(x, &bake, &(struct content){ .middle = middle, .stem = stem,
			.texture = has_image ? texture : NULL });
	}
	lod_bake_free(&bake);
	eco_elements_free(&samples);
}
