/* From assimp's scene to a soup. Node transforms are applied here, in double, during the walk: assimp's own
 * pre-transformation would copy meshes, and round places far from the origin to floats. geometry.c splits
 * polygons into exactly n - 2 triangles: assimp's own clipper leaves some concave ones, and loses others. */
#include "ecofiles/import/model/assimp_module.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"

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

struct totals { uint64_t vertices, triangles, meshes; bool colored; };

struct soup {
	struct eco_soup soup;
	struct totals totals;
	const struct aiScene *scene;
	const char *path;
	/* from assimp's world to ours: rows of a matrix, unit included */
	double axes[3][3];
	const uint32_t *channel;
	const bool *invisible;
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

/* Vertex colours beside a picture are no colours: games keep there how far wind moves a leaf. */
static void add_vertices(struct soup *s, const struct aiMesh *mesh, const struct aiMatrix4x4 *world)
{
	uint32_t channel = s->channel[mesh->mMaterialIndex];
	bool weights = mesh->mColors[0] && mesh->mNumVertices > 0
		&& assimp_has_picture(s->scene->mMaterials[mesh->mMaterialIndex]);
	if (channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh->mTextureCoords[channel])
		channel = 0;
	const struct aiVector3D *uvs = mesh->mTextureCoords[channel];
	s->weighted += weights && !s->invisible[mesh->mMaterialIndex];
	eco_soup_mesh(&s->soup, mesh->mMaterialIndex, mesh->mColors[0] && !weights);
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		const struct aiColor4D *c = mesh->mColors[0] ? &mesh->mColors[0][i] : NULL;
		float uv[2] = { 0, 0 };
		double place[3];
		transform(s, world, &mesh->mVertices[i], place);
		if (uvs)
			texture_coordinate(&uvs[i], uv);
		eco_soup_vertex(&s->soup, place, uv, c ? (const float[3]){ c->r, c->g, c->b } : NULL);
	}
}

static void add_polygon(struct soup *s, const struct aiMesh *mesh, const struct aiFace *face, uint32_t first)
{
	unsigned n = face->mNumIndices;
	uint32_t v[3];
	for (unsigned i = 0; i < n; i++) {
		bool there = face->mIndices[i] < mesh->mNumVertices;
		const struct aiVector3D *p = &mesh->mVertices[there ? face->mIndices[i] : 0];
		const double place[3] = { p->x, p->y, there ? p->z : NAN };
		memcpy(&s->corners[3 * i], place, sizeof place);
	}
	eco_model_split(s->corners, n, s->split);
	for (unsigned i = 0; i + 2 < n; i++) {
		/* an index beyond the mesh must not point into the next one */
		for (int k = 0; k < 3; k++) {
			uint32_t own = face->mIndices[s->split[n + 3 * i + (unsigned)k]];
			v[k] = own < mesh->mNumVertices ? first + own : ECO_NONE;
		}
		eco_soup_triangle(&s->soup, v[0], v[1], v[2]);
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

static void add_mesh(void *ctx, const struct aiNode *node, unsigned index, const struct aiMatrix4x4 *world)
{
	struct soup *s = ctx;
	const struct aiMesh *mesh = s->scene->mMeshes[index];
	const uint32_t first = s->soup.model->vertex_count;
	if (!s->invisible[mesh->mMaterialIndex])
		eco_soup_part(&s->soup, node->mName.data, plain_name(node->mName.data), mesh->mName.data,
			plain_name(mesh->mName.data));
	add_vertices(s, mesh, world);
	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		if (mesh->mFaces[i].mNumIndices >= 3)
			add_polygon(s, mesh, &mesh->mFaces[i], first);
}

/* Calls `visit` for every mesh of every node, parents first. Without recursion, as a file's tree may be of
 * any depth. */
typedef void visit_mesh(void *ctx, const struct aiNode *node, unsigned mesh, const struct aiMatrix4x4 *world);

static bool walk(const struct aiScene *scene, visit_mesh *visit, void *ctx)
{
	struct entry { const struct aiNode *node; struct aiMatrix4x4 world; } *stack = NULL;
	uint32_t count = 0, capacity = 0, seen = 0;
	bool good = scene->mRootNode;
	eco_grow(&stack, &capacity, count, sizeof *stack);
	if (good)
		stack[count++] = (struct entry){ scene->mRootNode, scene->mRootNode->mTransformation };
	while (good && count > 0) {
		const struct entry top = stack[--count];
		for (unsigned i = 0; i < top.node->mNumMeshes; i++)
			if (top.node->mMeshes[i] < scene->mNumMeshes)
				visit(ctx, top.node, top.node->mMeshes[i], &top.world);
		for (unsigned i = top.node->mNumChildren; good && i-- > 0;) {
			good = ++seen <= NODES_MAX;
			if (!good)
				break;
			eco_grow(&stack, &capacity, count, sizeof *stack);
			stack[count] = (struct entry){ top.node->mChildren[i], top.world };
			aiMultiplyMatrix4(&stack[count++].world, &top.node->mChildren[i]->mTransformation);
		}
	}
	free(stack);
	return good;
}

static void count_mesh(void *ctx, const struct aiNode *node, unsigned index, const struct aiMatrix4x4 *world)
{
	struct soup *s = ctx;
	struct totals *t = &s->totals;
	const struct aiMesh *mesh = s->scene->mMeshes[index];
	(void)node;
	(void)world;
	t->vertices += mesh->mNumVertices;
	t->triangles += mesh_triangles(mesh);
	t->meshes++;
	t->colored |= mesh->mColors[0] != NULL;
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		const struct aiVector3D *p = &mesh->mVertices[i];
		if (isfinite(p->x + p->y + p->z))
			s->soup.far = fmax(s->soup.far, fmax(fabs((double)p->x), fmax(fabs((double)p->y), fabs((double)p->z))));
	}
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

static enum eco_code reserve(struct soup *s, uint32_t triangles_max)
{
	const struct totals *t = &s->totals;
	if (!walk(s->scene, count_mesh, s))
		return eco_fail(s->error, ECO_TOO_LARGE, "%.300s: no nodes, or more than %u", s->path,
			NODES_MAX);
	enum eco_code code = check_totals(t, s->path, triangles_max, s->error);
	if (code)
		return code;
	s->corners = eco_alloc(ECO_POLYGON_CORNERS_MAX * 3, sizeof *s->corners);
	s->split = eco_alloc(ECO_POLYGON_CORNERS_MAX * 4, sizeof *s->split);
	eco_soup_reserve(&s->soup, t->vertices, t->triangles, t->meshes, t->colored);
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

static enum eco_code read_scene(struct soup *s, uint32_t triangles_max)
{
	struct eco_model *model = s->soup.model;
	uint32_t *channel = eco_alloc((size_t)s->scene->mNumMaterials + 1, sizeof *channel);
	bool *invisible = eco_alloc((size_t)s->scene->mNumMaterials + 1, sizeof *invisible);
	assimp_materials(model, s->scene, s->path, channel, invisible, s->soup.notes);
	s->channel = channel;
	s->invisible = s->soup.invisible = invisible;
	color_nameless(model, s->scene);
	assimp_frame(s->scene, s->path, s->soup.frame, s->axes);
	enum eco_code code = reserve(s, triangles_max);
	if (!code && !walk(s->scene, add_mesh, s))
		code = eco_fail(s->error, ECO_NO_MEMORY, "%.300s: out of memory", s->path);
	if (!code)
		eco_soup_end(&s->soup, "d, Tr, opacity");
	if (s->weighted > 0)
		eco_note(s->soup.notes,
			"%u meshes have vertex colours beside a picture: they are taken for weights of "
			"wind and shade, not for colours",
			s->weighted);
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
	struct soup soup = { .soup = { .model = model, .frame = frame, .notes = notes }, .scene = scene,
		.path = path, .error = error };
	if (code)
		return code;
	if (!meshes_hold_together(scene))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: faces of its meshes name vertices that are not "
			"there; if another program opens it, save it there as GLB", path);
	else
		code = read_scene(&soup, triangles_max);
	eco_soup_free(&soup.soup);
	aiReleaseImport(scene);
	return code;
}

ECO_MODULE_EXPORT const struct eco_assimp_module eco_assimp_module =
	{ .version = ECO_MODULE_VERSION, .read = read_model };
