/* From what gltfpack has written back to a pack, so that the client that draws ours draws it as well. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/import/model/gltf.h"
#include "tests/bench/pictures/bench_gltf.h"

#define CHUNKS_MAX 4096u
#define GRID 1048576.0                   /* steps across a plant's radius */

/* ---- Reading ---- */

struct reader {
	struct eco_gltf *doc;
	const struct bench_full *full;
	struct bench_full *to;
	struct eco_error *error;
};
/* What a primitive's corners come from. */
struct corners {
	struct eco_gltf_accessor position, uv, color, index;
	double offset[2], scale[2];      /* of texture coordinates */
};

static enum eco_code bad(const struct reader *r, const char *says)
{
	return eco_fail(r->error, ECO_DAMAGED, "%.300s: %s", eco_gltf_path(r->doc), says);
}

/* The plant that a node, or one above it, is named for. */
static uint32_t plant_of(const struct reader *r, uint32_t node)
{
	unsigned plant = ECO_NONE;
	for (; node != ECO_NONE; node = eco_gltf_parent(r->doc, node))
		if (sscanf(eco_gltf_text(eco_gltf_item(r->doc, "nodes", node), "name"), "%u", &plant) == 1)
			break;
	return plant;
}

static enum eco_code open_corners(const struct reader *r, const json_t *primitive, struct corners *c)
{
	const json_t *attributes = json_object_get(primitive, "attributes"),
		*material = eco_gltf_item(r->doc, "materials", eco_gltf_index(primitive, "material")),
		*transform = eco_gltf_extension(json_object_get(json_object_get(material,
		"pbrMetallicRoughness"), "baseColorTexture"), "KHR_texture_transform");
	enum eco_code code = eco_gltf_accessor_open(r->doc, eco_gltf_index(attributes, "POSITION"), 3,
		&c->position, r->error);
	if (!code)
		code = eco_gltf_accessor_open(r->doc, eco_gltf_index(primitive, "indices"), 1, &c->index,
			r->error);
	if (!code && !c->position.count)
		code = bad(r, "has a mesh without corners");
	if (!code && json_object_get(attributes, "TEXCOORD_0"))
		code = eco_gltf_accessor_open(r->doc, eco_gltf_index(attributes, "TEXCOORD_0"), 2, &c->uv,
			r->error);
	if (!code && json_object_get(attributes, "COLOR_0"))
		code = eco_gltf_accessor_open(r->doc, eco_gltf_index(attributes, "COLOR_0"), 4, &c->color,
			r->error);
	eco_gltf_numbers(transform, "offset", c->offset, 2);
	eco_gltf_numbers(transform, "scale", c->scale, 2);
	return code;
}

static void read_corner(const struct corners *c, uint64_t i, const double world[16],
	struct bench_full_mesh *to)
{
	uint32_t vertex = eco_gltf_element_index(&c->index, i);
	double p[3], q[3], uv[2];
	size_t at = to->corners++;
	vertex = vertex < c->position.count ? vertex : 0;
	eco_gltf_element(&c->position, vertex, p);
	eco_gltf_apply(world, p, q);
	memcpy(to->position + 3 * at, (const float[3]){ (float)q[0], (float)-q[2], (float)q[1] },
		3 * sizeof(float));                              /* Z up again */
	if (!to->uv)
		return;
	eco_gltf_element(&c->uv, vertex < c->uv.count ? vertex : 0, uv);
	for (int k = 0; k < 2; k++)
		to->uv[2 * at + (size_t)k] = (float)(c->offset[k] + c->scale[k] * uv[k]);
}

/* The palette's, as written: 8 bits are kept. */
static uint32_t color_of(const struct reader *r, const struct corners *c, uint64_t i)
{
	const struct eco_scene *s = &r->full->pack->scene;
	uint32_t vertex = eco_gltf_element_index(&c->index, i);
	double rgba[4];
	uint8_t rgb[3];
	eco_gltf_element(&c->color, vertex < c->color.count ? vertex : 0, rgba);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)lround(rgba[k] * 255);
	for (uint32_t color = 0; color < s->palette_count; color++)
		if (!memcmp(s->palette[color], rgb, 3))
			return color;
	return 0;
}

static enum eco_code read_corners(const struct reader *r, const struct corners *c, const double world[16],
	struct bench_full_mesh *mesh)
{
	uint64_t count = c->index.count / 3 * 3;
	if (count > UINT32_MAX / 2 || !bench_full_room(mesh, (uint32_t)count))
		return eco_fail(r->error, ECO_NO_MEMORY, "no memory for a plant of a glTF file");
	for (uint64_t i = 0; i < count; i++) {
		if (mesh->colored && i % 3 == 0)
			mesh->color[i / 3] = color_of(r, c, i);
		read_corner(c, i, world, mesh);
	}
	return ECO_OK;
}

static enum eco_code read_primitive(struct reader *r, const json_t *primitive, uint32_t plant,
	const double world[16])
{
	struct bench_full *to = r->to;
	struct bench_full_mesh *bigger = realloc(to->meshes, (to->mesh_count + 1u) * sizeof *bigger);
	struct corners corners = { .scale = { 1, 1 } };
	unsigned image;
	if (!bigger)
		return eco_fail(r->error, ECO_NO_MEMORY, "no memory for a plant of a glTF file");
	to->meshes = bigger;
	if (sscanf(eco_gltf_text(eco_gltf_item(r->doc, "materials", eco_gltf_index(primitive, "material")),
			"name"), "%u", &image) != 1 || plant == ECO_NONE)
		return bad(r, "has a mesh without the names of its plant and material");
	struct bench_full_mesh *mesh = &to->meshes[to->mesh_count++];
	enum eco_code code = open_corners(r, primitive, &corners);
	*mesh = (struct bench_full_mesh){ .plant = plant, .image = corners.uv.count ? image : ECO_NONE,
		.colored = corners.color.count };
	if (!code)
		code = read_corners(r, &corners, world, mesh);
	eco_gltf_accessor_close(&corners.position);
	eco_gltf_accessor_close(&corners.index);
	eco_gltf_accessor_close(&corners.uv);
	eco_gltf_accessor_close(&corners.color);
	return code;
}

static enum eco_code read_node(void *ctx, uint32_t node, const double world[16])
{
	struct reader *r = ctx;
	const json_t *mesh = eco_gltf_item(r->doc, "meshes", eco_gltf_index(eco_gltf_item(r->doc, "nodes",
		node), "mesh")), *primitives = json_object_get(mesh, "primitives");
	double same[16];
	enum eco_code code = eco_gltf_node_matrix(r->doc, node, same, r->error); /* finds its parents, too */
	for (size_t i = 0; i < json_array_size(primitives) && !code; i++)
		code = read_primitive(r, json_array_get(primitives, i), plant_of(r, node), world);
	return code;
}

enum eco_code bench_gltf_read(struct bench_full *read, const struct bench_full *full, const char *path,
	struct eco_error *error)
{
	struct reader r = { .full = full, .to = read, .error = error };
	*read = (struct bench_full){ 0 };
	enum eco_code code = eco_gltf_open(&r.doc, path, error);
	if (!code)
		code = eco_gltf_walk(r.doc, read_node, &r, error);
	eco_gltf_close(r.doc);
	if (code)
		bench_full_close(read);
	return code;
}

/* ---- Packing ---- */

struct packer {
	const struct bench_full *full;
	struct eco_pack_writer *writer;
	/* changed copies of the scene's tables */
	struct eco_plant *plants;
	struct eco_ladder *ladders; uint32_t ladder_count;
	struct eco_tile *tiles;
};

/* All lists, used or not, so that each has its number: a plant's tone follows from its list's. But not rows of
 * inventories, which would have to be the last. */
static enum eco_code copy_lists(struct packer *p, struct eco_error *error)
{
	const struct eco_scene *s = &p->full->pack->scene;
	uint32_t list, count = s->list_count - (eco_inventory_list(s) ? 1 : 0);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code; i++)
		code = eco_pack_add_copied(p->writer, &s->lists[i], p->full->pack, i, &list, error);
	return code;
}

static enum eco_code begin(struct packer *p, const struct bench_full *full, uint32_t mesh_count,
	struct eco_error *error)
{
	const struct eco_scene *s = &full->pack->scene;
	*p = (struct packer){ .full = full, .plants = malloc((s->plant_count + 1u) * sizeof *p->plants),
		.ladders = malloc((mesh_count + 1u) * sizeof *p->ladders),
		.tiles = malloc((s->tile_count + 1u) * sizeof *p->tiles) };
	if (!p->plants || !p->ladders || !p->tiles)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the tables of a pack");
	if (s->plant_count)
		memcpy(p->plants, s->plants, s->plant_count * sizeof *p->plants);
	memcpy(p->tiles, s->tiles, s->tile_count * sizeof *p->tiles);
	for (uint32_t i = 0; i < s->tile_count; i++)
		p->tiles[i].summary = ECO_NONE;
	return ECO_OK;
}

/* One element a triangle. */
static bool elements_of(const struct bench_full_mesh *mesh, const struct eco_list *list,
	struct eco_elements *e)
{
	uint32_t count = mesh->corners / 3, extra = eco_list_extra_count(list);
	*e = (struct eco_elements){ .element_count = count, .primitive_count = count,
		.corner_count = 3 * count, .extra_count = extra, .corners = malloc(count),
		.position = malloc(9 * (size_t)count * sizeof *e->position),
		.uv = mesh->uv ? malloc(6 * (size_t)count * sizeof *e->uv) : NULL,
		.extra = extra ? calloc(count, sizeof *e->extra) : NULL };
	if (!e->corners || !e->position || (mesh->uv && !e->uv) || (extra && !e->extra))
		return false;
	memset(e->corners, 3, count);
	for (size_t i = 0; i < 9 * (size_t)count; i++)
		e->position[i] = (int32_t)lround((double)mesh->position[i] / list->grid_step[0]);
	for (size_t i = 0; i < 6 * (size_t)count && mesh->uv; i++)
		e->uv[i] = (int32_t)lroundf(mesh->uv[i] * ECO_UV_ONE);
	for (size_t i = 0; i < count && mesh->colored; i++)
		e->extra[i] = (int32_t)(mesh->color[i] - list->palette_first);
	return true;
}

static enum eco_code add_mesh(struct packer *p, const struct bench_full_mesh *mesh, struct eco_error *error)
{
	const struct eco_scene *s = &p->full->pack->scene;
	const struct eco_plant *plant = &s->plants[mesh->plant];
	double step = fmax((double)s->anchors[plant->anchor_first].radius, 0.001) / GRID;
	struct eco_list list = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS,
		.attributes = (uint8_t)((mesh->colored ? ECO_ATTR_COLOR : 0) | (mesh->uv ? ECO_ATTR_UV : 0)),
		.owner = mesh->plant, .grid_step = { step, step, step },
		.palette_count = mesh->colored ? s->palette_count : 0,
		.image = mesh->uv ? mesh->image : ECO_NONE, .partner = ECO_NONE };
	struct eco_ladder ladder = { .plant = mesh->plant, .anchor = plant->anchor_first,
		.organ = ECO_ORGAN_FOLIAGE, .level_count = 1, .points = ECO_NONE, .lines = ECO_NONE,
		.simple = ECO_NONE, .impostor = ECO_NONE, .level_end = { mesh->corners / 3 },
		.total = mesh->corners / 3, .importance = 1, .area = plant->area, .curve_count = 1 };
	struct eco_elements e;
	uint32_t ends[CHUNKS_MAX];
	enum eco_code code = elements_of(mesh, &list, &e) ? ECO_OK : eco_fail(error, ECO_NO_MEMORY,
		"no memory for a plant of a glTF file");
	if (!code)
		code = eco_pack_add_list(p->writer, &list, &e, ends, eco_chunk_split(e.element_count, 1024,
			ends, CHUNKS_MAX), NULL, &ladder.triangles, error);
	eco_elements_free(&e);
	if (!code)
		p->ladders[p->ladder_count++] = ladder;
	return code;
}

/* A plant's ladders stand together. */
static enum eco_code add_meshes(struct packer *p, const struct bench_full *meshes, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t plant = 0; plant < p->full->pack->scene.plant_count; plant++) {
		p->plants[plant].anchor_count = 1;
		p->plants[plant].ladder_first = p->ladder_count;
		for (uint32_t i = 0; i < meshes->mesh_count && !code; i++)
			if (meshes->meshes[i].plant == plant && meshes->meshes[i].corners >= 3)
				code = add_mesh(p, &meshes->meshes[i], error);
		p->plants[plant].ladder_count = p->ladder_count - p->plants[plant].ladder_first;
	}
	return code;
}

static enum eco_code commit(struct packer *p, struct eco_error *error)
{
	static const struct eco_curve whole = { .share = 1, .scale = 1, .reach = 1 };
	struct eco_scene s = p->full->pack->scene;
	struct eco_pack_writer *writer = p->writer;
	s.plants = p->plants;
	s.ladders = p->ladders;
	s.ladder_count = p->ladder_count;
	s.curves = &whole;
	s.curve_count = 1;
	s.tiles = p->tiles;
	p->writer = NULL;
	return eco_pack_commit(writer, &s, "{}", error);
}

enum eco_code bench_gltf_pack(const struct bench_full *full, const struct bench_full *meshes,
	const char *path, struct eco_error *error)
{
	struct packer p;
	enum eco_code code = begin(&p, full, meshes->mesh_count, error);
	if (!code)
		code = eco_pack_create(&p.writer, path, error);
	if (!code)
		code = copy_lists(&p, error);
	if (!code)
		code = add_meshes(&p, meshes, error);
	if (!code)
		code = commit(&p, error);
	eco_pack_abort(p.writer);
	free(p.plants);
	free(p.ladders);
	free(p.tiles);
	return code;
}
