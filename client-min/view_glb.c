#include "client-min/view_glb.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_bake.h"
#include "ecofiles/base/file_write.h"
#include "ecofiles/base/version.h"
#include "ecofiles/format/image.h"

/* materials: the plants', the ground's if there is ground, and one an image */
enum material { MATERIAL_PLANTS, MATERIAL_GROUND };
enum target { TARGET_NONE = 0, TARGET_VERTICES = 34962, TARGET_INDICES = 34963 };

struct primitive { uint32_t accessor, material; bool uv; };      /* its first accessor: see add_bake */

struct glb {
	const struct view_glb_job *job;
	struct eco_error *error;
	struct eco_writer bin, views, accessors, meshes, nodes, children, images;
	uint32_t view_count, accessor_count, mesh_count, node_count, image_count;
	struct primitive *cuts;                  /* of the plan; those that somebody draws */
	uint32_t *order, drawn;                  /* instances by the cuts that they draw */
	json_t **said;                           /* of each instance, as view_plants.h has it, or NULL */
	const struct view_list **drawn_images;
};

/* ---- JSON ---- */

static void put_comma(struct eco_writer *w)
{
	if (w->size)
		eco_write_u8(w, ',');
}

static void put_name(struct eco_writer *w, const char *name)
{
	eco_write_u8(w, '"');
	for (; *name; name++)
		if (*name == '"' || *name == '\\' || (unsigned char)*name < ' ')
			eco_write_format(w, "\\u%04x", (unsigned char)*name);
		else
			eco_write_u8(w, (uint8_t)*name);
	eco_write_u8(w, '"');
}

/* ---- Numbers ---- */

static uint32_t add_view(struct glb *g, const void *bytes, size_t size, enum target target)
{
	put_comma(&g->views);
	eco_write_format(&g->views, "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu", g->bin.size, size);
	if (target)
		eco_write_format(&g->views, ",\"target\":%d", (int)target);
	eco_write_format(&g->views, "}");
	eco_write_bytes(&g->bin, bytes, size);
	while (g->bin.size % 4)
		eco_write_u8(&g->bin, 0);
	return g->view_count++;
}

static void add_accessor(struct glb *g, uint32_t view, int type, const char *shape, uint32_t count)
{
	put_comma(&g->accessors);
	eco_write_format(&g->accessors,
		"{\"bufferView\":%u,\"componentType\":%d,\"type\":\"%s\",\"count\":%u%s", view, type, shape,
		count, type == 5123 ? ",\"normalized\":true" : "");
	g->accessor_count++;
}

/* glTF wants the bounds of positions, as the floats that they are. */
static void add_bounds(struct glb *g, const struct lod_bake *bake)
{
	float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (size_t i = 0; i < (size_t)bake->vertex_count * 3; i++) {
		low[i % 3] = fminf(low[i % 3], bake->position[i]);
		high[i % 3] = fmaxf(high[i % 3], bake->position[i]);
	}
	eco_write_format(&g->accessors, ",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]", (double)low[0],
		(double)low[1], (double)low[2], (double)high[0], (double)high[1], (double)high[2]);
}

static enum eco_code find_image(struct glb *g, const struct view_list *image, uint32_t *index)
{
	for (*index = 0; *index < g->image_count; ++*index)
		if (g->drawn_images[*index] == image)
			return ECO_OK;
	struct eco_pixels pixels = { image->image.width, image->image.height, 4, image->image.rgba };
	uint8_t *png;
	size_t size;
	enum eco_code code = eco_png_encode(&pixels, &png, &size, g->error);
	if (code)
		return code;
	put_comma(&g->images);
	eco_write_format(&g->images, "{\"bufferView\":%u,\"mimeType\":\"image/png\"}", add_view(g, png, size,
		TARGET_NONE));
	free(png);
	g->drawn_images[g->image_count++] = image;
	return ECO_OK;
}

/* Positions, colours, indices, and where there is a texture uv: accessors one after the other. */
static enum eco_code add_bake(struct glb *g, const struct lod_bake *bake, const struct view_list *texture,
	enum material material, struct primitive *out)
{
	size_t vertices = bake->vertex_count;
	uint32_t image = 0;
	*out = (struct primitive){ g->accessor_count, material, bake->uv };
	add_accessor(g, add_view(g, bake->position, vertices * 12, TARGET_VERTICES), 5126, "VEC3",
		bake->vertex_count);
	add_bounds(g, bake);
	eco_write_format(&g->accessors, "}");
	add_accessor(g, add_view(g, bake->color, vertices * 8, TARGET_VERTICES), 5123, "VEC4",
		bake->vertex_count);
	eco_write_format(&g->accessors, "}");
	add_accessor(g, add_view(g, bake->index, (size_t)bake->index_count * 4, TARGET_INDICES), 5125,
		"SCALAR", bake->index_count);
	eco_write_format(&g->accessors, "}");
	if (!bake->uv)
		return ECO_OK;
	add_accessor(g, add_view(g, bake->uv, vertices * 8, TARGET_VERTICES), 5126, "VEC2",
		bake->vertex_count);
	eco_write_format(&g->accessors, "}");
	enum eco_code code = find_image(g, texture, &image);
	out->material = 1 + (g->job->selection->ground.count > 0) + image;
	return code;
}

static void put_primitive(struct eco_writer *w, const struct primitive *p)
{
	eco_write_format(w, "{\"attributes\":{\"POSITION\":%u,\"COLOR_0\":%u", p->accessor, p->accessor + 1);
	if (p->uv)
		eco_write_format(w, ",\"TEXCOORD_0\":%u", p->accessor + 3);
	eco_write_format(w, "},\"indices\":%u,\"material\":%u}", p->accessor + 2, p->material);
}

/* ---- Plants ---- */

static enum eco_code bake_cuts(struct glb *g)
{
	const struct view_selection *s = g->job->selection;
	enum eco_code code = ECO_OK;
	for (uint32_t c = 0; c < s->cut_count && !code; c++) {
		struct lod_bake bake = { .position = NULL };
		const struct view_list *texture;
		if (s->member_first[c] == s->member_first[c + 1])
			continue;
		code = view_bake_cut(&bake, &texture, g->job->store, &s->plan_cuts[c], g->error);
		if (!code)
			code = add_bake(g, &bake, texture, MATERIAL_PLANTS, &g->cuts[c]);
		lod_bake_free(&bake);
	}
	return code;
}

static int by_cuts(const void *a, const void *b, void *ctx)
{
	const struct view_selection *s = ctx;
	uint32_t i = *(const uint32_t *)a, k = *(const uint32_t *)b;
	uint32_t own = s->cut_first[i + 1] - s->cut_first[i], other = s->cut_first[k + 1] - s->cut_first[k];
	if (own != other)
		return own < other ? -1 : 1;
	for (uint32_t c = 0; c < own; c++) {
		uint32_t x = s->cuts[s->cut_first[i] + c], y = s->cuts[s->cut_first[k] + c];
		if (x != y)
			return x < y ? -1 : 1;
	}
	return 0;
}

static void begin_node(struct glb *g, const char *name)
{
	put_comma(&g->nodes);
	put_comma(&g->children);
	eco_write_format(&g->children, "%u", ++g->node_count);       /* the root is node 0 */
	eco_write_format(&g->nodes, "{\"name\":");
	put_name(&g->nodes, name);
}

/* What the server says of a plant: texts, whole numbers and null. */
static void put_said(struct glb *g, json_t *said)
{
	const char *key;
	json_t *value;
	json_object_foreach(said, key, value) {
		eco_write_format(&g->nodes, ",");
		put_name(&g->nodes, key);
		eco_write_format(&g->nodes, ":");
		if (json_is_string(value))
			put_name(&g->nodes, json_string_value(value));
		else if (json_is_integer(value))
			eco_write_format(&g->nodes, "%lld", (long long)json_integer_value(value));
		else
			eco_write_format(&g->nodes, "null");
	}
}

static void put_instance(struct glb *g, const struct view_instance *instance)
{
	json_t *said = g->said[instance - g->job->selection->instances];
	const char *species = json_string_value(json_object_get(said, "species"));
	const struct view_plant *plant = instance->plant == ECO_NONE ? NULL
		: view_store_plant(g->job->store, instance->plant);
	const struct lod_place *place = &instance->place;
	double w = sqrt(fmax(0.5 + 0.5 * place->cosine, 0)), z = w > 1e-6 ? place->sine / (2 * w) : 1;
	double length = sqrt(w * w + z * z);
	begin_node(g, species ? species : plant ? plant->plant.name : "summary");
	eco_write_format(&g->nodes, ",\"mesh\":%u,\"translation\":[%.6f,%.6f,%.6f]", g->mesh_count - 1,
		place->at[0], place->at[1], place->at[2]);
	if (place->sine != 0 || place->cosine != 1)
		eco_write_format(&g->nodes, ",\"rotation\":[0,0,%.9g,%.9g]", z / length, w / length);
	if (place->scale != 1)
		eco_write_format(&g->nodes, ",\"scale\":[%.9g,%.9g,%.9g]", place->scale, place->scale,
			place->scale);
	if (plant) {
		eco_write_format(&g->nodes, ",\"extras\":{\"height_m\":%.3f",
			(double)plant->plant.height_m * place->scale);
		put_said(g, said);
		eco_write_format(&g->nodes, "}");
	}
	eco_write_format(&g->nodes, "}");
}

static void put_mesh(struct glb *g, uint32_t instance)
{
	const struct view_selection *s = g->job->selection;
	put_comma(&g->meshes);
	eco_write_format(&g->meshes, "{\"primitives\":[");
	for (uint32_t c = s->cut_first[instance]; c < s->cut_first[instance + 1]; c++) {
		if (c > s->cut_first[instance])
			eco_write_format(&g->meshes, ",");
		put_primitive(&g->meshes, &g->cuts[s->cuts[c]]);
	}
	eco_write_format(&g->meshes, "]}");
	g->mesh_count++;
}

static void find_drawn(struct glb *g)
{
	const struct view_selection *s = g->job->selection;
	for (uint32_t i = 0; i < s->instance_count; i++)
		if (s->cut_first[i] < s->cut_first[i + 1])
			g->order[g->drawn++] = i;
	qsort_r(g->order, g->drawn, sizeof *g->order, by_cuts, (void *)s);
}

/* Asks what the drawn plants are. */
static enum eco_code ask(struct glb *g)
{
	const struct view_glb_job *job = g->job;
	struct view_plant_asked *asked = calloc(g->drawn + 1u, sizeof *asked);
	uint32_t count = 0;
	enum eco_code code = asked ? ECO_OK
		: eco_fail(g->error, ECO_NO_MEMORY, "no memory for rows of plants");
	for (uint32_t i = 0; i < g->drawn && !code; i++) {
		const struct view_instance *one = &job->selection->instances[g->order[i]];
		if (one->plant != ECO_NONE)
			asked[count++] = (struct view_plant_asked){ one->list, one->index,
				&g->said[g->order[i]] };
	}
	if (!code && job->fetch)
		code = view_plants_ask(job->fetch, view_store_pack(job->store), asked, count, g->error);
	free(asked);
	return code;
}

/* A mesh for all that draw the same cuts. */
static void put_plants(struct glb *g)
{
	const struct view_selection *s = g->job->selection;
	for (uint32_t i = 0; i < g->drawn; i++) {
		if (i == 0 || by_cuts(&g->order[i - 1], &g->order[i], (void *)s))
			put_mesh(g, g->order[i]);
		put_instance(g, &s->instances[g->order[i]]);
	}
}

/* ---- The rest ---- */

static enum eco_code put_ground(struct glb *g)
{
	const struct view_ground *ground = &g->job->selection->ground;
	enum eco_code code = ECO_OK;
	struct eco_writer primitives = { 0 };
	for (uint32_t i = 0; i < ground->count && !code; i++) {
		struct lod_bake bake = { .position = NULL };
		struct primitive primitive;
		code = view_bake_ground(&bake, ground, &g->job->selection->image, &ground->tiles[i], g->error);
		if (!code)
			code = add_bake(g, &bake, NULL, MATERIAL_GROUND, &primitive);
		lod_bake_free(&bake);
		if (code)
			break;
		put_comma(&primitives);
		put_primitive(&primitives, &primitive);
	}
	if (!code && ground->count) {
		put_comma(&g->meshes);
		eco_write_format(&g->meshes, "{\"primitives\":[");
		eco_write_bytes(&g->meshes, primitives.bytes, primitives.size);
		eco_write_format(&g->meshes, "]}");
		begin_node(g, "ground");
		eco_write_format(&g->nodes, ",\"mesh\":%u,\"translation\":[%.6f,%.6f,%.6f]}", g->mesh_count++,
			ground->at[0], ground->at[1], ground->at[2]);
	}
	g->meshes.failed |= primitives.failed;
	eco_writer_free(&primitives);
	return code;
}

/* A camera looks along its -Z. */
static void put_camera(struct glb *g)
{
	struct lod_eye eye;
	lod_eye_make(&eye, g->job->view);
	const double *r = eye.right, *u = eye.up, *f = eye.forward;
	begin_node(g, "camera");
	eco_write_format(&g->nodes,
		",\"camera\":0,\"matrix\":[%.9g,%.9g,%.9g,0,%.9g,%.9g,%.9g,0,%.9g,%.9g,%.9g,0,"
		"%.6f,%.6f,%.6f,1]}",
		r[0], r[1], r[2], u[0], u[1], u[2], -f[0], -f[1], -f[2], eye.at[0], eye.at[1], eye.at[2]);
}

static void put_materials(struct eco_writer *w, uint32_t images, const struct view_selection *s)
{
	static const float white[3] = { 1, 1, 1 };
	const float *color = s->image.count ? white : view_bake_plain;
	static const char rough[] = "\"metallicFactor\":0,\"roughnessFactor\":1";
	eco_write_format(w, "[{\"name\":\"plants\",\"doubleSided\":true,\"pbrMetallicRoughness\":{%s}}",
		rough);
	if (s->ground.count)
		eco_write_format(w, ",{\"name\":\"ground\",\"pbrMetallicRoughness\":{%s,"
			"\"baseColorFactor\":[%.3g,%.3g,%.3g,1]}}", rough, (double)color[0], (double)color[1],
			(double)color[2]);
	for (uint32_t i = 0; i < images; i++)
		eco_write_format(w, ",{\"doubleSided\":true,\"alphaMode\":\"MASK\",\"alphaCutoff\":0.5,"
			"\"pbrMetallicRoughness\":{%s,\"baseColorTexture\":{\"index\":%u}}}", rough, i);
	eco_write_format(w, "]");
}

/* An array, unless it is empty, which glTF does not allow. */
static void put_array(struct eco_writer *w, const char *name, const struct eco_writer *items)
{
	if (!items->size)
		return;
	eco_write_format(w, ",\"%s\":[", name);
	eco_write_bytes(w, items->bytes, items->size);
	eco_write_format(w, "]");
}

static void put_document(const struct glb *g, struct eco_writer *w)
{
	const struct view_selection *s = g->job->selection;
	const struct eco_view *view = g->job->view;
	double near_m = view_store_near_m(g->job->store);
	const char *name = view_store_scene_name(g->job->store);
	eco_write_format(w,
		"{\"asset\":{\"version\":\"2.0\",\"generator\":\"ecoview " ECO_VERSION "\"},\"scene\":0,"
		"\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":");
	put_name(w, name ? name : "scene");
	eco_write_format(w,
		",\"rotation\":[-0.70710678,0,0,0.70710678],\"extras\":{\"vertices\":%llu,\"plants\":%llu}",
		(unsigned long long)s->vertices, (unsigned long long)s->visible_plants);
	put_array(w, "children", &g->children);
	eco_write_format(w, "},");
	eco_write_bytes(w, g->nodes.bytes, g->nodes.size);
	eco_write_format(w,
		"],\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":%.9g,"
		"\"aspectRatio\":%.9g,\"znear\":%.9g}}]",
		view->fov_y_deg * (3.14159265358979323846 / 180), (double)view->width / view->height,
		near_m > 0 ? near_m : 0.1);
	put_array(w, "meshes", &g->meshes);
	if (g->accessor_count) {
		eco_write_format(w, ",\"materials\":");
		put_materials(w, g->image_count, s);
		eco_write_format(w, ",\"buffers\":[{\"byteLength\":%zu}]", g->bin.size);
	}
	put_array(w, "bufferViews", &g->views);
	put_array(w, "accessors", &g->accessors);
	put_array(w, "images", &g->images);
	if (g->image_count)
		eco_write_format(w, ",\"samplers\":[{\"wrapS\":10497,\"wrapT\":10497}],\"textures\":[");
	for (uint32_t i = 0; i < g->image_count; i++)
		eco_write_format(w, "%s{\"sampler\":0,\"source\":%u}", i ? "," : "", i);
	eco_write_format(w, "%s}", g->image_count ? "]" : "");
	while (w->size % 4)
		eco_write_u8(w, ' ');
}

/* A head of 12 bytes, then chunks with heads of 8: the document, and what it refers to. */
static enum eco_code put_file(const struct glb *g, struct eco_writer *out)
{
	struct eco_writer document = { 0 };
	put_document(g, &document);
	bool bin = g->bin.size > 0, failed = document.failed;
	uint64_t size = 12 + 8 + (uint64_t)document.size + (bin ? 8 + (uint64_t)g->bin.size : 0);
	if (size <= UINT32_MAX && !failed) {
		eco_write_bytes(out, "glTF", 4);
		eco_write_u32(out, 2);
		eco_write_u32(out, (uint32_t)size);
		eco_write_u32(out, (uint32_t)document.size);
		eco_write_bytes(out, "JSON", 4);
		eco_write_bytes(out, document.bytes, document.size);
	}
	if (size <= UINT32_MAX && bin) {
		eco_write_u32(out, (uint32_t)g->bin.size);
		eco_write_bytes(out, "BIN", 4);
		eco_write_bytes(out, g->bin.bytes, g->bin.size);
	}
	eco_writer_free(&document);
	if (size > UINT32_MAX)
		return eco_fail(g->error, ECO_TOO_LARGE,
			"the view has %llu bytes as glTF, which has at most 4 GiB: "
			"ask for fewer --vertices", (unsigned long long)size);
	return out->failed || failed ? eco_fail(g->error, ECO_NO_MEMORY, "no memory for a view as glTF")
		: ECO_OK;
}

static void free_all(struct glb *g)
{
	struct eco_writer *writers[] = { &g->bin, &g->views, &g->accessors, &g->meshes, &g->nodes,
		&g->children, &g->images };
	for (size_t i = 0; i < sizeof writers / sizeof *writers; i++)
		eco_writer_free(writers[i]);
	for (uint32_t i = 0; i < g->job->selection->instance_count && g->said; i++)
		json_decref(g->said[i]);
	free(g->said);
	free(g->cuts);
	free(g->order);
	free(g->drawn_images);
}

enum eco_code view_glb_write(const struct view_glb_job *job, struct eco_writer *out, struct eco_error *error)
{
	const struct view_selection *s = job->selection;
	struct glb g = { .job = job, .error = error,
		.cuts = calloc(s->cut_count + 1u, sizeof *g.cuts),
		.order = calloc(s->instance_count + 1u, sizeof *g.order),
		.said = calloc(s->instance_count + 1u, sizeof(json_t *)),
		.drawn_images = calloc(view_store_list_count(job->store) + 1u, sizeof *g.drawn_images) };
	enum eco_code code = g.cuts && g.order && g.said && g.drawn_images ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for a view as glTF");
	if (!code) {
		put_camera(&g);
		code = put_ground(&g);
	}
	if (!code)
		code = bake_cuts(&g);
	if (!code) {
		find_drawn(&g);
		code = ask(&g);
	}
	if (!code) {
		put_plants(&g);
		if (g.bin.failed || g.views.failed || g.accessors.failed || g.meshes.failed || g.nodes.failed
				|| g.children.failed || g.images.failed)
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for a view as glTF");
	}
	if (!code)
		code = put_file(&g, out);
	free_all(&g);
	return code;
}

enum eco_code view_glb_save(const struct view_glb_job *job, const char *dir, uint32_t frame,
	struct eco_error *error)
{
	struct eco_writer file = { 0 };
	char path[4096];
	int size = snprintf(path, sizeof path, "%s/frame-%04u.glb", dir, frame);
	enum eco_code code = (size_t)size < sizeof path ? view_glb_write(job, &file, error)
		: eco_fail(error, ECO_BAD_USAGE, "%.100s...: the folder's name is too long", dir);
	if (!code)
		code = eco_file_write(path, file.bytes, file.size, error);
	eco_writer_free(&file);
	return code;
}
