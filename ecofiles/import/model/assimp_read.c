/* From assimp's scene to a soup. Node transforms are applied here, in double, during the walk: assimp's own
 * pre-transformation would copy meshes, and round places far from the origin to floats. polygon.c splits
 * polygons into exactly n - 2 triangles: assimp's own clipper leaves some concave ones, and loses others. */
#include "ecofiles/import/model/assimp_module.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/polygon.h"

#define PLY_HEAD_BYTES 65536u
#define NODES_MAX (1u << 20)

/* ---- Axes and units ----
 * Axes and units of formats, and how assimp changes them. As measured with assimp 5.2: Collada arrives
 * Y-up and in metres, whatever the file says. FBX arrives as in the file, with its axes and unit beside
 * it. 3DS is turned from Z-up to Y-up. The others arrive without a hint, most of them Y-up. */

static const struct aiMetadataEntry *metadata(const struct aiScene *scene, const char *key)
{
	for (unsigned i = 0; scene->mMetaData && i < scene->mMetaData->mNumProperties; i++)
		if (strcmp(scene->mMetaData->mKeys[i].data, key) == 0)
			return &scene->mMetaData->mValues[i];
	return NULL;
}

static double metadata_number(const struct aiScene *scene, const char *key, double otherwise)
{
	const struct aiMetadataEntry *entry = metadata(scene, key);
	switch (entry ? entry->mType : AI_META_MAX) {
	case AI_INT32: return *(const int32_t *)entry->mData;
	case AI_DOUBLE: return *(const double *)entry->mData;
	case AI_FLOAT: return (double)*(const float *)entry->mData;
	default: return otherwise;
	}
}

static const char *metadata_text(const struct aiScene *scene, const char *key)
{
	const struct aiMetadataEntry *entry = metadata(scene, key);
	return entry && entry->mType == AI_AISTRING ? ((const struct aiString *)entry->mData)->data : "";
}

static void set_axes(double axes[3][3], const double to[3][3], double scale)
{
	for (int k = 0; k < 3; k++)
		for (int j = 0; j < 3; j++)
			axes[k][j] = to[k][j] * scale;
}

static const double as_it_is[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
static const double up_from_y[3][3] = { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } };

/* The file names the axes that point right, up and to the viewer, each with a sign; unless they form a
 * right-handed system, only up counts. Its unit is a number of centimetres. */
static void fbx_frame(const struct aiScene *scene, struct eco_model_frame *frame, double axes[3][3])
{
	static const char *const names[3][2] = { { "CoordAxis", "CoordAxisSign" },
		{ "FrontAxis", "FrontAxisSign" }, { "UpAxis", "UpAxisSign" } };
	double unit = metadata_number(scene, "UnitScaleFactor", 0), to[3][3] = { { 0 } }, determinant;
	int axis[3], sign[3];
	frame->unit_m = isfinite(unit) && unit >= 1e-6 && unit <= 1e9 ? unit / 100 : 0;
	for (int k = 0; k < 3; k++) {
		axis[k] = (int)metadata_number(scene, names[k][0], k == 0 ? 0 : k == 1 ? 2 : 1);
		sign[k] = metadata_number(scene, names[k][1], 1) < 0 ? -1 : 1;
		if (axis[k] >= 0 && axis[k] < 3)
			to[k][axis[k]] = k == 1 ? -sign[k] : sign[k];
	}
	determinant = to[0][0] * (to[1][1] * to[2][2] - to[1][2] * to[2][1])
		- to[0][1] * (to[1][0] * to[2][2] - to[1][2] * to[2][0])
		+ to[0][2] * (to[1][0] * to[2][1] - to[1][1] * to[2][0]);
	frame->up = axis[2] == 2 ? ECO_UP_Z : ECO_UP_Y;
	if (determinant > 0.5)
		set_axes(axes, (const double (*)[3])to, 1);
	else
		set_axes(axes, frame->up == ECO_UP_Z ? as_it_is : up_from_y, 1);
}

/* assimp has applied axes and unit; the head of the file says which. */
static void collada_frame(const char *path, struct eco_model_frame *frame, double axes[3][3])
{
	size_t size;
	char *head = eco_path_ends_with(path, ".dae") ? eco_file_read_head(path, &size) : NULL;
	const char *unit = head ? strstr(head, "<unit") : NULL,
		*up = head ? strstr(head, "<up_axis>") : NULL;
	const char *end = unit ? strchr(unit, '>') : NULL, *meter = unit
		? strstr(unit, "meter=") : NULL;
	frame->unit_m = 1;
	if (meter && end && meter < end && strtod(meter + 7, NULL) >= 1e-6 && strtod(meter + 7, NULL) <= 1e6)
		frame->unit_m = strtod(meter + 7, NULL);
	frame->up = up && strncmp(up + 9 + strspn(up + 9, " \t\r\n"), "Z_UP", 4) == 0 ? ECO_UP_Z : ECO_UP_Y;
	free(head);
	set_axes(axes, up_from_y, 1 / frame->unit_m);
}

/* Fills format, unit, up and convention of the frame. axes: from assimp's world to ours, rows of a
 * matrix, unit included; Z up if the format states its axes, else as in the file. */
static void assimp_frame(const struct aiScene *scene, const char *path, struct eco_model_frame *frame,
	double axes[3][3])
{
	const char *format = metadata_text(scene, "SourceAsset_Format"), *dot = strrchr(path, '.');
	bool z = eco_path_ends_with(path, ".ply") || eco_path_ends_with(path, ".stl")
		|| eco_path_ends_with(path, ".3ds");
	snprintf(frame->format, sizeof frame->format, "%.60s", *format != 0 ? format : dot ? dot + 1
		: "unknown");
	if (strstr(frame->format, " Importer"))
		*strstr(frame->format, " Importer") = 0;
	frame->convention = z ? ECO_UP_Z : ECO_UP_Y;
	if (eco_path_ends_with(path, ".fbx")) {
		fbx_frame(scene, frame, axes);
	} else if (strstr(format, "Collada")) {
		collada_frame(path, frame, axes);
	} else if (eco_path_ends_with(path, ".3ds")) {
		set_axes(axes, up_from_y, 1);     /* assimp turned it: back to the file's axes */
	} else {
		set_axes(axes, as_it_is, 1);
	}
}

/* ---- The walk ---- */

struct soup {
	struct eco_model *model;
	const struct aiScene *scene;
	const char *path;
	const struct eco_model_frame *frame;
	/* from assimp's world to ours: rows of a matrix, unit included */
	double axes[3][3];
	const uint32_t *channel;
	const bool *invisible;
	struct eco_tints tints;
	uint64_t hidden;
	uint32_t weighted;                   /* meshes with a picture and vertex colours */
	double *corners;                     /* corners of one polygon, 3 values each */
	uint32_t *split;                     /* the polygon's ring, then its triangles */
	struct eco_error *error;
};

static uint64_t mesh_triangles(const struct aiMesh *mesh)
{
	uint64_t count = 0;
	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		count += mesh->mFaces[i].mNumIndices > 2 ? mesh->mFaces[i].mNumIndices - 2 : 0;
	return count;
}

static void transform(const struct soup *s, const struct aiMatrix4x4 *m, const struct aiVector3D *p,
	double out[3])
{
	const double world[3] = { (double)m->a1 * p->x + (double)m->a2 * p->y + (double)m->a3 * p->z + m->a4,
		(double)m->b1 * p->x + (double)m->b2 * p->y + (double)m->b3 * p->z + m->b4,
		(double)m->c1 * p->x + (double)m->c2 * p->y + (double)m->c3 * p->z + m->c4 };

	for (int k = 0; k < 3; k++)
		out[k] = s->axes[k][0] * world[0] + s->axes[k][1] * world[1] + s->axes[k][2] * world[2];
}

static float bounded_uv(float value)
{
	return fabsf(value) <= 65536 ? value : 0;
}

/* uv from the image's top left; assimp counts v upwards. */
static void texture_coordinate(const struct aiVector3D *from, float to[2])
{
	to[0] = bounded_uv(from->x);
	to[1] = bounded_uv((float)(1 - (double)from->y));
}

static void add_vertices(struct soup *s, const struct aiMesh *mesh, const struct aiMatrix4x4 *world)
{
	struct eco_model *m = s->model;
	uint32_t channel = s->channel[mesh->mMaterialIndex];
	if (channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh->mTextureCoords[channel])
		channel = 0;
	const struct aiVector3D *uv = mesh->mTextureCoords[channel];
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		float *to = &m->uv[((size_t)m->vertex_count + i) * 2];
		double place[3];
		transform(s, world, &mesh->mVertices[i], place);
		for (int k = 0; k < 3; k++)
			m->position[((size_t)m->vertex_count + i) * 3 + (size_t)k] =
				(float)(place[k] - s->frame->base[k]);
		to[0] = to[1] = 0;
		if (uv)
			texture_coordinate(&uv[i], to);
	}
}

static void add_color(const struct aiMesh *mesh, unsigned v, struct eco_vertex_colors *colors)
{
	const struct aiColor4D *c = &mesh->mColors[0][v];
	eco_vertex_colors_add(colors, (const float[3]){ c->r, c->g, c->b });
}

/* The one material of all the mesh's triangles; ECO_NONE: vertex colours make several. Beside a picture they
 * are no colours: games keep there how far wind moves a leaf. */
static uint32_t mesh_material(struct soup *s, const struct aiMesh *mesh)
{
	struct eco_vertex_colors colors = { .count = 0 };
	uint32_t averaged = 0;
	bool weights = mesh->mColors[0] && mesh->mNumVertices > 0
		&& assimp_has_picture(s->scene->mMaterials[mesh->mMaterialIndex]);
	s->weighted += weights;
	for (unsigned i = 0; i < mesh->mNumVertices && mesh->mColors[0] && !weights; i++)
		add_color(mesh, i, &colors);
	return eco_tints_get_whole(&s->tints, mesh->mMaterialIndex, &colors, false, &averaged);
}

/* The material of a triangle: `whole`, or the mesh's with the mean of three vertex colours. */
static uint32_t face_material(struct soup *s, const struct aiMesh *mesh, const unsigned *v, uint32_t whole)
{
	struct eco_vertex_colors colors = { .count = 0 };
	if (whole != ECO_NONE)
		return whole;
	for (int c = 0; c < 3; c++) {
		if (v[c] >= mesh->mNumVertices)
			return mesh->mMaterialIndex;
		add_color(mesh, v[c], &colors);
	}
	return eco_tints_get_step(&s->tints, mesh->mMaterialIndex, &colors, false);
}

static void add_triangle(struct soup *s, const struct aiMesh *mesh, const unsigned v[3], uint32_t whole)
{
	struct eco_model *m = s->model;
	/* an index beyond the mesh must not point into the next one */
	for (int k = 0; k < 3; k++)
		m->index[(size_t)m->triangle_count * 3 + k] = v[k] < mesh->mNumVertices
			? m->vertex_count + v[k] : ECO_NONE;
	m->part[m->triangle_count] = m->part_count - 1;
	m->material[m->triangle_count++] = face_material(s, mesh, v, whole);
}

static void add_polygon(struct soup *s, const struct aiMesh *mesh, const struct aiFace *face, uint32_t whole)
{
	unsigned n = face->mNumIndices;
	for (unsigned i = 0; i < n; i++) {
		bool there = face->mIndices[i] < mesh->mNumVertices;
		const struct aiVector3D *p = &mesh->mVertices[there ? face->mIndices[i] : 0];
		const double place[3] = { p->x, p->y, there ? p->z : NAN };
		memcpy(&s->corners[3 * i], place, sizeof place);
	}
	eco_model_split(s->corners, n, s->split);
	for (unsigned i = 0; i + 2 < n; i++) {
		const uint32_t *t = s->split + n + 3 * i;
		const unsigned v[3] = { face->mIndices[t[0]], face->mIndices[t[1]], face->mIndices[t[2]] };
		add_triangle(s, mesh, v, whole);
	}
}

/* Length of a name as its author wrote it, without assimp's additions. */
static size_t plain_name(const char *name)
{
	const char *helper = strstr(name, "_$AssimpFbx$");
	if (*name == '<' || *name == '$' || strcmp(name, "RootNode") == 0 || strcmp(name, "defaultobject")
			== 0)
		return 0;
	return helper ? (size_t)(helper - name) : strlen(name);
}

static void add_mesh(struct soup *s, const struct aiNode *node, unsigned index,
	const struct aiMatrix4x4 *world)
{
	const struct aiMesh *mesh = s->scene->mMeshes[index];
	struct eco_model *m = s->model;
	uint64_t triangles = mesh_triangles(mesh);
	m->triangles_in += (uint32_t)triangles;
	if (s->invisible[mesh->mMaterialIndex]) {
		m->dropped[ECO_DROP_TRANSPARENT] += (uint32_t)triangles;
		s->hidden += triangles;
		return;
	}
	eco_model_add_part(m, node->mName.data, plain_name(node->mName.data), mesh->mName.data,
		plain_name(mesh->mName.data));
	uint32_t whole = mesh_material(s, mesh);
	add_vertices(s, mesh, world);
	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		if (mesh->mFaces[i].mNumIndices >= 3)
			add_polygon(s, mesh, &mesh->mFaces[i], whole);
	m->vertex_count += mesh->mNumVertices;
}

/* Calls `visit` for every mesh of every node, parents first. Without recursion, as a file's tree may be of
 * any depth. */
typedef void visit_mesh(void *ctx, const struct aiNode *node, unsigned mesh, const struct aiMatrix4x4 *world);

static bool walk(const struct aiScene *scene, visit_mesh *visit, void *ctx)
{
	struct entry { const struct aiNode *node; struct aiMatrix4x4 world; } *stack = NULL;
	uint32_t count = 0, capacity = 0, seen = 0;
	bool good = scene->mRootNode && eco_array_grow(&stack, &capacity, count, sizeof *stack);
	if (good)
		stack[count++] = (struct entry){ scene->mRootNode, scene->mRootNode->mTransformation };
	while (good && count > 0) {
		const struct entry top = stack[--count];
		for (unsigned i = 0; i < top.node->mNumMeshes; i++)
			if (top.node->mMeshes[i] < scene->mNumMeshes)
				visit(ctx, top.node, top.node->mMeshes[i], &top.world);
		for (unsigned i = top.node->mNumChildren; good && i-- > 0;) {
			good = ++seen <= NODES_MAX && eco_array_grow(&stack, &capacity, count, sizeof *stack);
			if (!good)
				break;
			stack[count] = (struct entry){ top.node->mChildren[i], top.world };
			aiMultiplyMatrix4(&stack[count++].world, &top.node->mChildren[i]->mTransformation);
		}
	}
	free(stack);
	return good;
}

struct totals {
	const struct soup *soup;
	uint64_t vertices, triangles, meshes;
	struct eco_bounds bounds;
	/* largest coordinate of a vertex, which assimp holds in single precision */
	double far;
};

static void count_mesh(void *ctx, const struct aiNode *node, unsigned index, const struct aiMatrix4x4 *world)
{
	struct totals *t = ctx;
	const struct aiMesh *mesh = t->soup->scene->mMeshes[index];
	(void)node;
	t->vertices += mesh->mNumVertices;
	t->triangles += mesh_triangles(mesh);
	t->meshes++;
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		double place[3];
		transform(t->soup, world, &mesh->mVertices[i], place);
		if (!isfinite(place[0] + place[1] + place[2]))
			continue;
		eco_bounds_add(&t->bounds, place);
		t->far = fmax(t->far, fmax(fabs((double)mesh->mVertices[i].x),
			fmax(fabs((double)mesh->mVertices[i].y), fabs((double)mesh->mVertices[i].z))));
	}
}

static void add_mesh_of(void *ctx, const struct aiNode *node, unsigned index, const struct aiMatrix4x4 *world)
{
	add_mesh(ctx, node, index, world);
}

static enum eco_code check_totals(const struct totals *t, const char *path, uint32_t triangles_max,
	struct eco_error *error)
{
	if (t->triangles > triangles_max || t->vertices > (uint64_t)triangles_max * 3)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %llu triangles and %llu vertices, at most %u "
			"triangles are possible", path, (unsigned long long)t->triangles,
			(unsigned long long)t->vertices, triangles_max);
	if (t->triangles == 0 && t->vertices > 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: no triangles in it, only %llu points or "
			"lines; a point cloud has no surfaces: make a "
			"mesh of it first", path, (unsigned long long)t->vertices);
	if (t->triangles == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: no triangles in it", path);
	return ECO_OK;
}

static bool take_memory(struct soup *s, const struct totals *t)
{
	s->corners = malloc(ECO_POLYGON_CORNERS_MAX * 3 * sizeof *s->corners);
	s->split = malloc(ECO_POLYGON_CORNERS_MAX * 4 * sizeof *s->split);
	return eco_model_reserve(s->model, t->vertices, t->triangles, t->meshes) && s->corners && s->split
		&& eco_tints_start(&s->tints, s->model);
}

static enum eco_code reserve(struct soup *s, struct eco_model_frame *frame, uint32_t triangles_max,
	struct eco_notes *notes)
{
	struct totals t = { .soup = s, .bounds = ECO_NO_BOUNDS };
	const char *path = s->path;
	if (!walk(s->scene, count_mesh, &t))
		return eco_fail(s->error, ECO_TOO_LARGE, "%.300s: no nodes, or more than %u", path,
			NODES_MAX);
	enum eco_code code = check_totals(&t, path, triangles_max, s->error);
	if (code)
		return code;
	if (t.bounds.low[0] <= t.bounds.high[0])
		eco_model_choose_base(&t.bounds, frame->base);
	eco_note_coarse(notes, t.far, eco_bounds_extent(&t.bounds));
	if (!take_memory(s, &t))
		return eco_fail(s->error, ECO_NO_MEMORY, "%.300s: out of memory for %llu triangles", path,
			(unsigned long long)t.triangles);
	return ECO_OK;
}

/* ---- The file ---- */

/* Checks against faults that assimp lets pass: material numbers out of range, faces without vertices,
 * endless polygons. Empty meshes do no harm. */
static bool meshes_hold_together(const struct aiScene *scene)
{
	for (unsigned i = 0; i < scene->mNumMeshes; i++) {
		const struct aiMesh *mesh = scene->mMeshes[i];
		if (mesh->mMaterialIndex >= scene->mNumMaterials
				|| (!mesh->mVertices && mesh->mNumVertices + mesh->mNumFaces > 0))
			return false;
		for (unsigned k = 0; k < mesh->mNumFaces; k++)
			if (mesh->mFaces[k].mNumIndices > ECO_POLYGON_CORNERS_MAX)
				return false;
	}
	return true;
}

/* A triangle without a material is grey; white if vertices have colours. */
static void color_nameless(struct eco_model *model, const struct aiScene *scene)
{
	for (uint32_t i = 0; i < scene->mNumMaterials; i++) {
		struct eco_material *m = &model->materials[i];
		bool colored = false;
		if ((m->name[0] != 0 && strcmp(m->name, "DefaultMaterial") != 0) || m->image != ECO_NONE)
			continue;
		for (unsigned k = 0; k < scene->mNumMeshes; k++)
			colored |= scene->mMeshes[k]->mMaterialIndex == i && scene->mMeshes[k]->mColors[0];
		memset(m->rgb, colored ? 255 : 153, 3);
		m->colourless = !colored;
	}
}

static enum eco_code read_scene(struct soup *s, struct eco_model_frame *frame, uint32_t triangles_max,
	struct eco_notes *notes)
{
	uint32_t *channel = calloc((size_t)s->scene->mNumMaterials + 1, sizeof *channel);
	bool *invisible = calloc((size_t)s->scene->mNumMaterials + 1, sizeof *invisible);
	enum eco_code code;
	s->channel = channel;
	s->invisible = invisible;
	if (!channel || !invisible)
		code = eco_fail(s->error, ECO_NO_MEMORY, "%.300s: out of memory", s->path);
	else
		code = assimp_materials(s->model, s->scene, s->path, channel, invisible, notes, s->error);
	if (!code) {
		color_nameless(s->model, s->scene);
		assimp_frame(s->scene, s->path, frame, s->axes);
		code = reserve(s, frame, triangles_max, notes);
	}
	if (!code)
		walk(s->scene, add_mesh_of, s);
	eco_note_colors(notes, s->hidden, "d, Tr, opacity", 0);
	if (s->weighted > 0)
		eco_note(notes,
			"%u meshes have vertex colours beside a picture: they are taken for weights of "
			"wind and shade, not for colours",
			s->weighted);
	eco_tints_end(&s->tints);
	free(s->corners);
	free(s->split);
	free(channel);
	free(invisible);
	return code;
}

/* assimp 5.2 takes a line feed at the start of binary PLY data for the header's end and loses a byte.
 * Such a byte is raised by one: it is the lowest byte of the first vertex's first number, or (big-endian)
 * the highest byte of a number near 10^-32. *bytes: NULL if the file is read as it is. */
static enum eco_code mend_ply(const char *path, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	static const char last[] = "end_header\n";
	*bytes = NULL;
	if (!eco_path_ends_with(path, ".ply") || !eco_file_head_has(path, PLY_HEAD_BYTES, "end_header\n\n")
			|| eco_file_head_has(path, PLY_HEAD_BYTES, "format ascii"))
		return ECO_OK;
	enum eco_code code = eco_file_read(path, UINT32_MAX, bytes, size, error);
	uint8_t *at = !code ? memmem(*bytes, *size, last, sizeof last - 1) : NULL;
	if (at)
		at[sizeof last - 1]++;
	return code;
}

/* Asks for Collada's names, which people see, instead of its ids. */
static enum eco_code import_scene(const struct aiScene **scene, const char *path, struct eco_error *error)
{
	struct aiPropertyStore *settings = aiCreatePropertyStore();
	uint8_t *bytes;
	size_t size;
	enum eco_code code = mend_ply(path, &bytes, &size, error);
	if (code)
		return code;
	aiSetImportPropertyInteger(settings, AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, 1);
	*scene = bytes
		? aiImportFileFromMemoryWithProperties((char *)bytes, (unsigned)size, 0, "ply", settings)
		: aiImportFileExWithProperties(path, 0, NULL, settings);
	aiReleasePropertyStore(settings);
	free(bytes);
	return *scene ? ECO_OK
		      : eco_fail(error, ECO_BAD_INPUT,
				"%.180s: %.200s; if another program opens it, save it there as GLB",
				path, aiGetErrorString());
}

static enum eco_code read_model(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error)
{
	const struct aiScene *scene = NULL;
	enum eco_code code = import_scene(&scene, path, error);
	struct soup soup = { .model = model, .scene = scene, .path = path, .frame = frame, .error = error };
	if (code)
		return code;
	if (!meshes_hold_together(scene))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: faces of its meshes name vertices that are not "
			"there; if another program opens it, save it there as GLB", path);
	else
		code = read_scene(&soup, frame, triangles_max, notes);
	aiReleaseImport(scene);
	return code;
}

ECO_MODULE_EXPORT const struct eco_assimp_module eco_assimp_module =
	{ .version = ECO_MODULE_VERSION, .read = read_model };
