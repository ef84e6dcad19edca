/* From assimp's scene to a soup. Node transforms are applied here, in double, during the walk: assimp's own
 * pre-transformation would copy meshes, and round places far from the origin to floats. geometry.c splits
 * polygons into exactly n - 2 triangles: assimp's own clipper leaves some concave ones, and loses others.
 *
 * A material is one colour and one base colour image, cut out or not; other shading is ignored. None of
 * these formats says whether alpha counts, so it does wherever there is some. */
#include "ecofiles/import/model/import_model.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/format/image.h"
#include "ecofiles/import/model/ply_plain.h"

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

/* ---- Textures within the file ---- */

static enum eco_code decode_raw(struct eco_image *image, const struct aiTexture *texture,
	struct eco_error *error)
{
	uint64_t pixels = (uint64_t)texture->mWidth * texture->mHeight;
	if (pixels == 0 || pixels > ECO_PIXELS_MAX || !texture->pcData)
		return eco_fail(error, ECO_TOO_LARGE, "%llu pixels", (unsigned long long)pixels);
	image->rgba = eco_alloc(pixels, 4);
	for (uint64_t i = 0; i < pixels; i++) {
		const struct aiTexel *t = &texture->pcData[i];
		uint8_t rgba[4] = { t->r, t->g, t->b, t->a };
		memcpy(&image->rgba[i * 4], rgba, 4);
	}
	image->width = texture->mWidth;
	image->height = texture->mHeight;
	return ECO_OK;
}

/* "*3" is texture 3 of the scene; some readers give embedded textures file names instead. */
static const struct aiTexture *embedded_texture(const struct aiScene *scene, const char *name)
{
	char *end;
	unsigned long index;
	if (*name == '*') {
		index = strtoul(name + 1, &end, 10);
		return end != name + 1 && *end == 0 && index < scene->mNumTextures ? scene->mTextures[index]
			: NULL;
	}
	for (unsigned i = 0; i < scene->mNumTextures; i++)
		if (scene->mTextures[i]->mFilename.length > 0
				&& strcmp(scene->mTextures[i]->mFilename.data, name) == 0)
			return scene->mTextures[i];
	return NULL;
}

static bool embedded(void *ctx, const char *name, struct eco_image *image, enum eco_code *code,
	struct eco_error *error)
{
	const struct aiTexture *texture = embedded_texture(ctx, name);
	if (!texture)
		return false;
	*code = texture->mHeight != 0 ? decode_raw(image, texture, error)
		: eco_image_read_memory(image, texture->pcData, texture->mWidth, name, error);
	return true;
}

/* ---- Materials ---- */

struct reader {
	struct eco_soup soup;
	const struct aiScene *scene;
	const char *path;
	double axes[3][3];                   /* from assimp's world to ours: rows of a matrix, unit included */
	uint32_t *channel;                   /* per material: uv set of its image */
	bool *invisible;
	uint32_t triangles_max, weighted;    /* weighted: meshes with a picture and vertex colours */
	struct eco_error *error;
};

/* The name of a texture and its uv set; NULL: none. */
static char *texture_name(const struct aiMaterial *from, enum aiTextureType type, uint32_t *channel)
{
	struct aiString path;
	unsigned uv = 0;
	if (aiGetMaterialTexture(from, type, 0, &path, NULL, &uv, NULL, NULL, NULL, NULL) != AI_SUCCESS
			|| path.length == 0)
		return NULL;
	if (channel)
		*channel = uv;
	return eco_copy_text(path.data);
}

static bool has_picture(const struct aiMaterial *material)
{
	return aiGetMaterialTextureCount(material, aiTextureType_BASE_COLOR) > 0
		|| aiGetMaterialTextureCount(material, aiTextureType_DIFFUSE) > 0;
}


#define BLACK 0.02f
#define CLEAR 0.02f              /* alpha below is full transparency */

/* A black surface without a picture under a colour that it emits: shadeless models have it so. */
static bool is_emissive(const struct aiMaterial *from)
{
	struct aiColor4D diffuse = { 1, 1, 1, 1 }, emitted = { 0, 0, 0, 1 };
	aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, &diffuse);
	aiGetMaterialColor(from, AI_MATKEY_COLOR_EMISSIVE, &emitted);
	return !has_picture(from) && diffuse.r < BLACK && diffuse.g < BLACK && diffuse.b < BLACK
		&& (emitted.r + emitted.g + emitted.b > 3 * BLACK
		|| aiGetMaterialTextureCount(from, aiTextureType_EMISSIVE) > 0);
}

/* Whether the colour is linear light: so physically based materials have it. */
static bool color_of(const struct aiMaterial *from, struct aiColor4D *color)
{
	ai_real opacity = 1;
	*color = (struct aiColor4D){ 0.6f, 0.6f, 0.6f, 1 };
	bool base = aiGetMaterialColor(from, "$clr.base", 0, 0, color) == AI_SUCCESS;
	if (!base)
		aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, color);
	bool told = aiGetMaterialFloatArray(from, "$mat.opacity", 0, 0, &opacity, NULL) == AI_SUCCESS;
	color->a = told && isfinite(opacity) ? opacity : 1;
	/* exporters write a factor of full transparency beside a picture that says where: it switches that on */
	if (!eco_alpha_shows((double)color->a) && (aiGetMaterialTextureCount(from, aiTextureType_OPACITY) > 0
			|| (color->a < CLEAR && has_picture(from))))
		color->a = 1;
	if (is_emissive(from))
		aiGetMaterialColor(from, AI_MATKEY_COLOR_EMISSIVE, color);
	return base;
}

static void read_image(struct eco_images *images, const struct aiMaterial *from, struct eco_material *to,
	float opacity, uint32_t *channel)
{
	char *texture = texture_name(from, aiTextureType_BASE_COLOR, channel);
	if (!texture)
		texture = texture_name(from, aiTextureType_DIFFUSE, channel);
	if (!texture && is_emissive(from))
		texture = texture_name(from, aiTextureType_EMISSIVE, channel);
	if (!texture)
		return;
	char *mask = texture_name(from, aiTextureType_OPACITY, NULL);
	const struct eco_image_wanted wanted = { .texture = texture, .gain = eco_alpha_shows(opacity)
		? opacity : 1,
		.opacity = mask && strcmp(mask, texture) != 0 ? mask : NULL };
	eco_material_take_picture(to, images, &wanted, true);
	free(texture);
	free(mask);
}

static void read_material(struct reader *r, struct eco_images *images, uint32_t index, bool all_linear)
{
	const struct aiMaterial *from = r->scene->mMaterials[index];
	struct eco_material *to = &r->soup.model->materials[index];
	struct aiString name;
	struct aiColor4D color;
	bool linear = color_of(from, &color) || all_linear;
	const float rgb[3] = { color.r, color.g, color.b };
	if (aiGetMaterialString(from, AI_MATKEY_NAME, &name) == AI_SUCCESS)
		snprintf(to->name, sizeof to->name, "%.63s", name.data);
	for (int k = 0; k < 3; k++)
		to->rgb[k] = !linear ? eco_byte_from_share(rgb[k]) : eco_srgb_from_linear(isfinite(rgb[k])
			? rgb[k] : 0.6);
	if (!r->invisible[index])
		read_image(images, from, to, color.a, &r->channel[index]);
}

static void read_materials(struct reader *r)
{
	const uint32_t count = r->scene->mNumMaterials;
	struct eco_model *model = r->soup.model;
	struct eco_images images = { .model = model, .path = r->path, .notes = r->soup.notes,
		.embedded = embedded,
		.ctx = (void *)r->scene };
	/* Blender's materials are linear, except in PLY, which has none */
	bool linear = !eco_path_ends_with(r->path, ".ply") && eco_file_head_has(r->path, 4096, "Blender");
	model->materials = eco_alloc(count, sizeof *model->materials);
	model->material_count = count;
	r->channel = eco_alloc(count, sizeof *r->channel);
	r->soup.invisible = r->invisible = eco_alloc(count, sizeof *r->invisible);
	eco_images_start(&images);
	for (uint32_t i = 0; i < count; i++) {
		struct aiColor4D color;
		color_of(r->scene->mMaterials[i], &color);
		model->materials[i].image = ECO_NONE;
		r->invisible[i] = !eco_alpha_shows(color.a);
	}
	eco_model_see_invisible(r->invisible, count, r->soup.notes);
	for (uint32_t i = 0; i < count; i++)
		read_material(r, &images, i, linear);
	eco_images_end(&images);
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

/* ---- The walk ---- */

static float bounded_uv(double value) { return fabs(value) <= 65536 ? (float)value : 0; }

/* Offset and tiling of a material's picture (FBX: Translation and Scaling); its turn is not read. */
static struct aiUVTransform moved(const struct aiMaterial *material)
{
	static const enum aiTextureType types[] = { aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE };
	struct aiUVTransform move = { { 0, 0 }, { 1, 1 }, 0 };
	for (size_t i = 0; i < 2; i++)
		if (aiGetMaterialTextureCount(material, types[i]) > 0) {
			struct aiUVTransform own = move;
			bool there = aiGetMaterialUVTransform(material, AI_MATKEY_UVTRANSFORM(types[i], 0), &own) == AI_SUCCESS;
			bool good = isfinite(own.mScaling.x + own.mScaling.y + own.mTranslation.x + own.mTranslation.y)
				&& own.mScaling.x != 0 && own.mScaling.y != 0;
			return there && good ? own : move;
		}
	return move;
}

/* Vertex colours beside a picture are no colours: games keep there how far wind moves a leaf. */
static void add_vertices(struct reader *r, const struct aiMesh *mesh, const struct aiMatrix4x4 *m)
{
	uint32_t channel = r->channel[mesh->mMaterialIndex];
	bool weights = mesh->mColors[0] && mesh->mNumVertices > 0
		&& has_picture(r->scene->mMaterials[mesh->mMaterialIndex]);
	const struct aiUVTransform move = moved(r->scene->mMaterials[mesh->mMaterialIndex]);
	if (channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh->mTextureCoords[channel])
		channel = 0;
	const struct aiVector3D *uvs = mesh->mTextureCoords[channel];
	r->weighted += weights && !r->invisible[mesh->mMaterialIndex];
	eco_soup_mesh(&r->soup, mesh->mMaterialIndex, mesh->mColors[0] && !weights);
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		const struct aiVector3D p = mesh->mVertices[i];
		const struct aiColor4D *c = mesh->mColors[0] ? &mesh->mColors[0][i] : NULL;
		const double world[3] = { (double)m->a1 * p.x + (double)m->a2 * p.y + (double)m->a3 * p.z + m->a4,
			(double)m->b1 * p.x + (double)m->b2 * p.y + (double)m->b3 * p.z + m->b4,
			(double)m->c1 * p.x + (double)m->c2 * p.y + (double)m->c3 * p.z + m->c4 };
		double place[3];
		for (int k = 0; k < 3; k++)
			place[k] = r->axes[k][0] * world[0] + r->axes[k][1] * world[1] + r->axes[k][2] * world[2];
		if (isfinite(p.x + p.y + p.z))
			r->soup.far = fmax(r->soup.far, fmax(fabs((double)p.x), fmax(fabs((double)p.y),
				fabs((double)p.z))));
		/* assimp counts v upwards */
		eco_soup_vertex(&r->soup, place, uvs ? (const float[2]){
			bounded_uv(uvs[i].x * move.mScaling.x + move.mTranslation.x),
			bounded_uv(1 - (double)(uvs[i].y * move.mScaling.y + move.mTranslation.y)) }
			: NULL, c ? (const float[3]){ c->r, c->g, c->b } : NULL);
	}
}

static void add_polygon(struct reader *r, const struct aiMesh *mesh, const struct aiFace *face,
	uint32_t first)
{
	unsigned n = face->mNumIndices;
	double *corners = eco_soup_corners(&r->soup);
	uint32_t v[3];
	for (unsigned i = 0; i < n; i++) {
		bool there = face->mIndices[i] < mesh->mNumVertices;
		const struct aiVector3D *p = &mesh->mVertices[there ? face->mIndices[i] : 0];
		const double place[3] = { p->x, p->y, there ? p->z : NAN };
		memcpy(&corners[3 * i], place, sizeof place);
	}
	const uint32_t *split = eco_soup_split(&r->soup, n);
	for (unsigned i = 0; i + 2 < n; i++) {
		/* an index beyond the mesh must not point into the next one */
		for (unsigned k = 0; k < 3; k++) {
			uint32_t own = face->mIndices[split[3 * i + k]];
			v[k] = own < mesh->mNumVertices ? first + own : ECO_NONE;
		}
		eco_soup_triangle(&r->soup, v[0], v[1], v[2]);
	}
}

/* Length of a name as its author wrote it, without assimp's additions. */
static size_t plain_name(const char *name)
{
	const char *helper = strstr(name, "_$AssimpFbx$");
	if (*name == '<' || *name == '$' || strcmp(name, "RootNode") == 0 || strcmp(name,
		"defaultobject") == 0)
		return 0;
	return helper ? (size_t)(helper - name) : strlen(name);
}

static enum eco_code add_mesh(struct reader *r, const char *node, const struct aiMesh *mesh,
	const struct aiMatrix4x4 *world)
{
	const uint32_t first = r->soup.vertex_count;
	uint64_t triangles = r->soup.triangle_count, vertices = (uint64_t)first + mesh->mNumVertices;
	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		triangles += mesh->mFaces[i].mNumIndices > 2 ? mesh->mFaces[i].mNumIndices - 2 : 0;
	if (triangles > r->triangles_max || vertices > (uint64_t)r->triangles_max * 3)
		return eco_fail(r->error, ECO_TOO_LARGE,
			"%.300s: %llu triangles and %llu vertices or more, at most %u "
			"triangles are possible", r->path, (unsigned long long)triangles,
			(unsigned long long)vertices,
			r->triangles_max);
	if (!r->invisible[mesh->mMaterialIndex])
		eco_soup_part(&r->soup, node, plain_name(node), mesh->mName.data,
			plain_name(mesh->mName.data));
	add_vertices(r, mesh, world);
	for (unsigned i = 0; i < mesh->mNumFaces; i++)
		if (mesh->mFaces[i].mNumIndices >= 3)
			add_polygon(r, mesh, &mesh->mFaces[i], first);
	return ECO_OK;
}

/* Adds every mesh of every node, parents first. Without recursion, as a file's tree may be of any depth. */
static enum eco_code walk(struct reader *r)
{
	struct entry { const struct aiNode *node; struct aiMatrix4x4 world; } *stack = NULL;
	const struct aiScene *scene = r->scene;
	uint32_t count = 0, capacity = 0, seen = 0;
	enum eco_code code = ECO_OK;
	eco_grow(&stack, &capacity, count, sizeof *stack);
	if (scene->mRootNode)
		stack[count++] = (struct entry){ scene->mRootNode, scene->mRootNode->mTransformation };
	while (!code && count > 0) {
		const struct entry top = stack[--count];
		for (unsigned i = 0; i < top.node->mNumMeshes && !code; i++)
			if (top.node->mMeshes[i] < scene->mNumMeshes)
				code = add_mesh(r, top.node->mName.data, scene->mMeshes[top.node->mMeshes[i]],
					&top.world);
		seen += top.node->mNumChildren;
		if (!code && seen > NODES_MAX)
			code = eco_fail(r->error, ECO_TOO_LARGE, "%.300s: more than %u nodes", r->path,
				NODES_MAX);
		for (unsigned i = top.node->mNumChildren; !code && i-- > 0;) {
			eco_grow(&stack, &capacity, count, sizeof *stack);
			stack[count] = (struct entry){ top.node->mChildren[i], top.world };
			aiMultiplyMatrix4(&stack[count++].world, &top.node->mChildren[i]->mTransformation);
		}
	}
	free(stack);
	return code;
}

static enum eco_code read_scene(struct reader *r)
{
	read_materials(r);
	color_nameless(r->soup.model, r->scene);
	assimp_frame(r->scene, r->path, r->soup.frame, r->axes);
	ECO_PASS(walk(r));
	if (r->soup.triangle_count == 0)
		return r->soup.vertex_count > 0 ? eco_fail(r->error, ECO_BAD_INPUT,
			"%.300s: no triangles in it, only "
			"%u points or lines; a point cloud has no surfaces: make a mesh of it first", r->path,
			r->soup.vertex_count)
			: eco_fail(r->error, ECO_BAD_INPUT, "%.300s: no triangles in it", r->path);
	eco_soup_end(&r->soup, "d, Tr, opacity");
	if (r->weighted > 0)
		eco_note(r->soup.notes,
			"%u meshes have vertex colours beside a picture: they are taken for weights of "
			"wind and shade, not for colours",
			r->weighted);
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
	if (!code && !bytes && eco_path_ends_with(path, ".ply"))
		code = eco_ply_plain(path, &bytes, &size, error);
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
	struct reader r = { .soup = { .model = model, .frame = frame, .notes = notes }, .path = path,
		.triangles_max = triangles_max, .error = error };
	enum eco_code code = import_scene(&r.scene, path, error);
	if (code)
		return code;
	if (!meshes_hold_together(r.scene))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: faces of its meshes name vertices that are not "
			"there; if another program opens it, save it there as GLB", path);
	else
		code = read_scene(&r);
	eco_soup_free(&r.soup);
	free(r.channel);
	free(r.invisible);
	aiReleaseImport(r.scene);
	return code;
}

ECO_MODULE_EXPORT extern const struct eco_assimp_module eco_assimp_module;
const struct eco_assimp_module eco_assimp_module = { .version = ECO_MODULE_VERSION, .read = read_model };
