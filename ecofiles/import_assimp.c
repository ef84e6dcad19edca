/* From assimp's scene to a soup. Node transforms are applied here, in double, as the tree is walked: assimp's own pre-transformation
 * would copy meshes. Polygons are split by polygon.c into exactly n - 2 triangles: assimp's own clipper leaves some concave
 * ones, and loses others. assimp's world is Y-up, whatever the file's was: (x, y, z) becomes (x, -z, y). */
#include "ecofiles/import_model.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/polygon.h"

#define TINTS_MAX 4096u              /* materials made of vertex colours */
#define NODES_MAX (1u << 20)

/* ---- Files as assimp opens them: the model's own may be in memory ---- */

struct stream {
	struct aiFile file;
	FILE *disk;
	const uint8_t *bytes;
	size_t size, at;
};

static size_t stream_read(struct aiFile *file, char *to, size_t size, size_t count)
{
	struct stream *s = (struct stream *)file->UserData;
	size_t whole;

	if (s->disk != NULL)
		return fread(to, size, count, s->disk);
	whole = size == 0 ? 0 : (s->size - s->at) / size;
	if (whole > count)
		whole = count;
	memcpy(to, s->bytes + s->at, whole * size);
	s->at += whole * size;
	return whole;
}

static size_t stream_write(struct aiFile *file, const char *from, size_t size, size_t count)
{
	(void)file;
	(void)from;
	(void)size;
	(void)count;
	return 0;
}

static size_t stream_tell(struct aiFile *file)
{
	struct stream *s = (struct stream *)file->UserData;

	return s->disk != NULL ? (size_t)ftell(s->disk) : s->at;
}

static size_t stream_size(struct aiFile *file)
{
	struct stream *s = (struct stream *)file->UserData;
	long at, size;

	if (s->disk == NULL)
		return s->size;
	at = ftell(s->disk);
	fseek(s->disk, 0, SEEK_END);
	size = ftell(s->disk);
	fseek(s->disk, at, SEEK_SET);
	return size > 0 ? (size_t)size : 0;
}

static enum aiReturn stream_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
	struct stream *s = (struct stream *)file->UserData;
	size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? s->at : s->size;

	if (s->disk != NULL)
		return fseek(s->disk, (long)offset, origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END) == 0
			? aiReturn_SUCCESS : aiReturn_FAILURE;
	if (offset > s->size - base)
		return aiReturn_FAILURE;
	s->at = base + offset;
	return aiReturn_SUCCESS;
}

static void stream_flush(struct aiFile *file)
{
	(void)file;
}

static struct aiFile *stream_open(struct aiFileIO *io, const char *path, const char *mode)
{
	const struct eco_model_file *model = (const struct eco_model_file *)io->UserData;
	struct stream *s = strpbrk(mode, "wa+") == NULL ? calloc(1, sizeof *s) : NULL;

	if (s == NULL)
		return NULL;
	if (model->bytes != NULL && strcmp(path, model->path) == 0) {
		s->bytes = model->bytes;
		s->size = model->size_bytes;
	} else if ((s->disk = fopen(path, "rb")) == NULL) {
		free(s);
		return NULL;
	}
	s->file = (struct aiFile){ stream_read, stream_write, stream_tell, stream_size, stream_seek, stream_flush, (char *)s };
	return &s->file;
}

static void stream_close(struct aiFileIO *io, struct aiFile *file)
{
	struct stream *s = (struct stream *)file->UserData;

	(void)io;
	if (s->disk != NULL)
		fclose(s->disk);
	free(s);
}

/* ---- The walk ---- */

struct soup {
	struct eco_model *model;
	const struct aiScene *scene;
	const struct eco_model_file *file;
	const uint32_t *channel;
	const bool *invisible;
	uint32_t *tint_key, tint_count;      /* of the materials from base_materials on */
	uint32_t base_materials;
	uint64_t hidden;
	uint32_t averaged;                   /* textured meshes whose vertex colours differ */
	double *corners;                     /* scratch of one polygon: 3 each */
	uint32_t *split;                     /* its ring, then its triangles */
	struct eco_error *error;
};

static uint64_t mesh_triangles(const struct aiMesh *mesh)
{
	uint64_t count = 0;

	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		count += mesh->mFaces[i].mNumIndices > 2 ? mesh->mFaces[i].mNumIndices - 2 : 0;
	return count;
}

static void transform(const struct aiMatrix4x4 *m, const struct aiVector3D *p, float out[3])
{
	double x = (double)m->a1 * p->x + (double)m->a2 * p->y + (double)m->a3 * p->z + m->a4;
	double y = (double)m->b1 * p->x + (double)m->b2 * p->y + (double)m->b3 * p->z + m->b4;
	double z = (double)m->c1 * p->x + (double)m->c2 * p->y + (double)m->c3 * p->z + m->c4;

	out[0] = (float)x;
	out[1] = (float)-z;
	out[2] = (float)y;
}

static float bounded_uv(float value)
{
	return fabsf(value) <= 65536 ? value : 0;
}

/* uv from the image's top left, in glTF's and our sense; assimp's v points up. */
static void texture_coordinate(const struct eco_uv_transform *t, const struct aiVector3D *from, float to[2])
{
	double u = from->x, v = 1 - (double)from->y;

	if (t != NULL && t->used) {
		double x = u * t->scale[0], y = v * t->scale[1];

		u = t->offset[0] + t->cosine * x + t->sine * y;
		v = t->offset[1] - t->sine * x + t->cosine * y;
	}
	to[0] = bounded_uv((float)u);
	to[1] = bounded_uv((float)v);
}

static void add_vertices(struct soup *s, const struct aiMesh *mesh, const struct aiMatrix4x4 *world)
{
	struct eco_model *m = s->model;
	uint32_t channel = s->channel[mesh->mMaterialIndex];
	const struct eco_uv_transform *t = mesh->mMaterialIndex < s->file->transform_count ? &s->file->transforms[mesh->mMaterialIndex] : NULL;
	const struct aiVector3D *uv;

	if (t != NULL && t->channel >= 0 && t->channel < AI_MAX_NUMBER_OF_TEXTURECOORDS)
		channel = (uint32_t)t->channel;
	if (channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS || mesh->mTextureCoords[channel] == NULL)
		channel = 0;
	uv = mesh->mTextureCoords[channel];
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		float *to = &m->uv[((size_t)m->vertex_count + i) * 2];

		transform(world, &mesh->mVertices[i], &m->position[((size_t)m->vertex_count + i) * 3]);
		to[0] = to[1] = 0;
		if (uv != NULL)
			texture_coordinate(t, &uv[i], to);
	}
}

/* A material times a colour. White changes nothing. */
static uint32_t tinted(struct soup *s, uint32_t material, const uint8_t rgb[3])
{
	struct eco_model *m = s->model;
	uint32_t key = material << 24 ^ ((uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2]), i = 0;
	struct eco_material *to;

	if (rgb[0] == 255 && rgb[1] == 255 && rgb[2] == 255)
		return material;
	while (i < s->tint_count && (s->tint_key[i * 2] != key || s->tint_key[i * 2 + 1] != material))
		i++;
	if (i < s->tint_count)
		return s->base_materials + i;
	if (s->tint_count == TINTS_MAX)
		return material;
	s->tint_key[i * 2] = key;
	s->tint_key[i * 2 + 1] = material;
	s->tint_count++;
	to = &m->materials[m->material_count];
	*to = m->materials[material];
	for (int k = 0; k < 3; k++)
		to->rgb[k] = eco_srgb_from_linear(eco_linear_from_srgb(to->rgb[k]) * eco_linear_from_srgb(rgb[k]));
	return m->material_count++;
}

static uint8_t color_byte(const struct soup *s, float value)
{
	if (!isfinite(value))
		return 255;
	if (s->file->linear_colors)
		return eco_srgb_from_linear(value);
	return value > 0 ? value < 1 ? (uint8_t)(value * 255 + 0.5f) : 255 : 0;
}

static void mean_color(const struct soup *s, const struct aiColor4D *colors, const unsigned *v, uint8_t rgb[3])
{
	float sum[3] = { 0, 0, 0 };

	for (int c = 0; c < 3; c++) {
		sum[0] += colors[v[c]].r / 3;
		sum[1] += colors[v[c]].g / 3;
		sum[2] += colors[v[c]].b / 3;
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = color_byte(s, sum[k]);
}

static bool one_color(const struct aiMesh *mesh)
{
	const struct aiColor4D *c = mesh->mColors[0];

	for (unsigned i = 1; i < mesh->mNumVertices; i++)
		if (fabsf(c[i].r - c[0].r) > 0.02f || fabsf(c[i].g - c[0].g) > 0.02f || fabsf(c[i].b - c[0].b) > 0.02f)
			return false;
	return true;
}

/* The one material of all the mesh's triangles; ECO_NONE where their vertex colours make several. A textured mesh gets the mean of its
 * colours: every other colour would be another image, and would cut leaves and branches into pieces. */
static uint32_t mesh_material(struct soup *s, const struct aiMesh *mesh)
{
	const struct aiColor4D *colors = mesh->mColors[0];
	bool one = colors == NULL || one_color(mesh);
	double sum[3] = { 0, 0, 0 };
	uint8_t rgb[3];

	if (colors == NULL || mesh->mNumVertices == 0)
		return mesh->mMaterialIndex;
	if (!one && s->model->materials[mesh->mMaterialIndex].image == ECO_NONE)
		return ECO_NONE;
	s->averaged += !one;
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		sum[0] += colors[i].r;
		sum[1] += colors[i].g;
		sum[2] += colors[i].b;
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = color_byte(s, (float)(sum[k] / mesh->mNumVertices));
	return tinted(s, mesh->mMaterialIndex, rgb);
}

/* The material of a triangle: `whole`, or the mesh's with the mean of three vertex colours, in eight steps a channel. */
static uint32_t face_material(struct soup *s, const struct aiMesh *mesh, const unsigned *v, uint32_t whole)
{
	uint8_t rgb[3];

	if (whole != ECO_NONE)
		return whole;
	for (int c = 0; c < 3; c++)
		if (v[c] >= mesh->mNumVertices)
			return mesh->mMaterialIndex;
	mean_color(s, mesh->mColors[0], v, rgb);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)((rgb[k] * 7 + 127) / 255 * 255 / 7);
	return tinted(s, mesh->mMaterialIndex, rgb);
}

static void add_triangle(struct soup *s, const struct aiMesh *mesh, const unsigned v[3], uint32_t whole)
{
	struct eco_model *m = s->model;

	for (int k = 0; k < 3; k++)              /* an index beyond the mesh must not become one into the next */
		m->index[(size_t)m->triangle_count * 3 + k] = v[k] < mesh->mNumVertices ? m->vertex_count + v[k] : ECO_NONE;
	m->material[m->triangle_count++] = face_material(s, mesh, v, whole);
}

/* A polygon with a corner that is not there, or not finite, has no shape: a fan keeps its count, and the rest is dropped later. */
static void add_polygon(struct soup *s, const struct aiMesh *mesh, const struct aiFace *face, uint32_t whole)
{
	unsigned n = face->mNumIndices;
	uint32_t *triangles = s->split + n;
	bool sound = true;

	for (unsigned i = 0; i < n; i++) {
		const struct aiVector3D *p = face->mIndices[i] < mesh->mNumVertices ? &mesh->mVertices[face->mIndices[i]] : NULL;

		sound = sound && p != NULL && isfinite(p->x) && isfinite(p->y) && isfinite(p->z);
		s->corners[i * 3] = sound ? p->x : 0;
		s->corners[i * 3 + 1] = sound ? p->y : 0;
		s->corners[i * 3 + 2] = sound ? p->z : 0;
	}
	if (sound)
		eco_polygon_split(s->corners, n, s->split, triangles);
	for (unsigned i = 0; i + 2 < n; i++) {
		const uint32_t fan[3] = { 0, i + 1, i + 2 }, *t = sound ? &triangles[i * 3] : fan;
		const unsigned v[3] = { face->mIndices[t[0]], face->mIndices[t[1]], face->mIndices[t[2]] };

		add_triangle(s, mesh, v, whole);
	}
}

static void add_mesh(struct soup *s, unsigned index, const struct aiMatrix4x4 *world)
{
	const struct aiMesh *mesh = s->scene->mMeshes[index];
	struct eco_model *m = s->model;
	uint64_t triangles = mesh_triangles(mesh);
	uint32_t whole;

	m->triangles_in += (uint32_t)triangles;
	if (s->invisible[mesh->mMaterialIndex]) {
		m->dropped[ECO_DROP_TRANSPARENT] += (uint32_t)triangles;
		s->hidden += triangles;
		return;
	}
	whole = mesh_material(s, mesh);
	add_vertices(s, mesh, world);
	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		if (mesh->mFaces[i].mNumIndices == 3)
			add_triangle(s, mesh, mesh->mFaces[i].mIndices, whole);
		else if (mesh->mFaces[i].mNumIndices > 3)
			add_polygon(s, mesh, &mesh->mFaces[i], whole);
	m->vertex_count += mesh->mNumVertices;
}

/* Calls `visit` for every mesh of every node, parents first, without recursion: the depth of a file's tree is not ours to bound. */
static bool walk(const struct aiScene *scene, void (*visit)(void *ctx, unsigned mesh, const struct aiMatrix4x4 *world), void *ctx)
{
	struct entry { const struct aiNode *node; struct aiMatrix4x4 world; } *stack = malloc(sizeof *stack);
	size_t count = 1, capacity = 1, seen = 0;
	bool good = stack != NULL && scene->mRootNode != NULL;

	if (good)
		stack[0] = (struct entry){ scene->mRootNode, scene->mRootNode->mTransformation };
	while (good && count > 0) {
		struct entry top = stack[--count];

		for (unsigned i = 0; i < top.node->mNumMeshes; i++)
			if (top.node->mMeshes[i] < scene->mNumMeshes)
				visit(ctx, top.node->mMeshes[i], &top.world);
		seen += top.node->mNumChildren;
		if (seen > NODES_MAX) {
			good = false;
		} else if (count + top.node->mNumChildren > capacity) {
			struct entry *grown = realloc(stack, (capacity = 2 * (count + top.node->mNumChildren)) * sizeof *stack);

			good = grown != NULL;
			stack = good ? grown : stack;
		}
		for (unsigned i = top.node->mNumChildren; good && i-- > 0;) {
			stack[count] = (struct entry){ top.node->mChildren[i], top.world };
			aiMultiplyMatrix4(&stack[count++].world, &top.node->mChildren[i]->mTransformation);
		}
	}
	free(stack);
	return good;
}

struct totals { const struct soup *soup; uint64_t vertices, triangles; };

static void count_mesh(void *ctx, unsigned index, const struct aiMatrix4x4 *world)
{
	struct totals *t = ctx;
	const struct aiMesh *mesh = t->soup->scene->mMeshes[index];

	(void)world;
	t->vertices += mesh->mNumVertices;
	t->triangles += mesh_triangles(mesh);
}

static void visit_mesh(void *ctx, unsigned index, const struct aiMatrix4x4 *world)
{
	add_mesh(ctx, index, world);
}

static enum eco_code reserve(struct soup *s, uint32_t triangles_max)
{
	struct totals t = { .soup = s };
	struct eco_model *m = s->model;
	struct eco_material *grown;
	const char *path = s->file->path;

	if (!walk(s->scene, count_mesh, &t))
		return eco_fail(s->error, ECO_TOO_LARGE, "%.300s: no nodes, or more than %u", path, NODES_MAX);
	if (t.triangles > triangles_max || t.vertices > (uint64_t)triangles_max * 3)
		return eco_fail(s->error, ECO_TOO_LARGE, "%.300s: %llu triangles and %llu vertices, at most %u triangles are possible", path,
			(unsigned long long)t.triangles, (unsigned long long)t.vertices, triangles_max);
	if (t.triangles == 0)
		return eco_fail(s->error, ECO_BAD_INPUT, "%.300s: no triangles in it", path);
	m->position = malloc((t.vertices + 1) * 3 * sizeof *m->position);
	m->uv = malloc((t.vertices + 1) * 2 * sizeof *m->uv);
	m->index = malloc((t.triangles + 1) * 3 * sizeof *m->index);
	m->material = malloc((t.triangles + 1) * sizeof *m->material);
	s->tint_key = malloc(TINTS_MAX * 2 * sizeof *s->tint_key);
	s->corners = malloc(ECO_POLYGON_CORNERS_MAX * 3 * sizeof *s->corners);
	s->split = malloc(ECO_POLYGON_CORNERS_MAX * 4 * sizeof *s->split);
	s->base_materials = m->material_count;
	grown = realloc(m->materials, ((size_t)m->material_count + TINTS_MAX) * sizeof *m->materials);
	if (grown != NULL)
		m->materials = grown;
	if (m->position == NULL || m->uv == NULL || m->index == NULL || m->material == NULL || s->tint_key == NULL || s->corners == NULL
		|| s->split == NULL || grown == NULL)
		return eco_fail(s->error, ECO_NO_MEMORY, "%.300s: out of memory for %llu triangles", path, (unsigned long long)t.triangles);
	return ECO_OK;
}

/* ---- The file ---- */

/* What assimp may hand out all the same: material numbers that are not there, meshes without vertices, endless polygons. */
static bool meshes_hold_together(const struct aiScene *scene)
{
	for (unsigned i = 0; i < scene->mNumMeshes; i++) {
		const struct aiMesh *mesh = scene->mMeshes[i];

		if (mesh->mMaterialIndex >= scene->mNumMaterials || mesh->mVertices == NULL)
			return false;
		for (unsigned k = 0; k < mesh->mNumFaces; k++)
			if (mesh->mFaces[k].mNumIndices > ECO_POLYGON_CORNERS_MAX)
				return false;
	}
	return true;
}

static enum eco_code read_scene(struct eco_model *model, const struct aiScene *scene, const struct eco_model_file *file,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	uint32_t *channel = calloc((size_t)scene->mNumMaterials + 1, sizeof *channel);
	bool *invisible = calloc((size_t)scene->mNumMaterials + 1, sizeof *invisible);
	struct soup soup = { .model = model, .scene = scene, .file = file, .channel = channel, .invisible = invisible,
		.error = error };
	enum eco_code code;

	if (channel == NULL || invisible == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", file->path);
	else
		code = eco_assimp_materials(model, scene, file, channel, invisible, notes, error);
	if (code == ECO_OK)
		code = reserve(&soup, triangles_max);
	if (code == ECO_OK)
		walk(scene, visit_mesh, &soup);
	if (soup.hidden > 0)
		eco_note(notes, "%llu triangles have materials with alpha below 0.5 (d, Tr, opacity): they are left out",
			(unsigned long long)soup.hidden);
	if (soup.averaged > 0)
		eco_note(notes, "%u textured meshes have vertex colours that differ: each is drawn in their mean", soup.averaged);
	free(soup.tint_key);
	free(soup.corners);
	free(soup.split);
	free(channel);
	free(invisible);
	return code;
}

enum eco_code eco_assimp_read(struct eco_model *model, const struct eco_model_file *file, uint32_t triangles_max,
	struct eco_notes *notes, struct eco_error *error)
{
	struct aiFileIO io = { stream_open, stream_close, (char *)file };
	const struct aiScene *scene = aiImportFileEx(file->path, 0, &io);
	enum eco_code code;

	if (scene == NULL && strstr(aiGetErrorString(), "No suitable reader") != NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: not a model that can be read; use OBJ with MTL, glTF or GLB", file->path);
	if (scene == NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: %.280s", file->path, aiGetErrorString());
	if (!meshes_hold_together(scene))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: its meshes do not hold together", file->path);
	else
		code = read_scene(model, scene, file, triangles_max, notes, error);
	aiReleaseImport(scene);
	return code;
}
