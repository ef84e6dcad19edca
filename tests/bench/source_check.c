/* Compares streamed pictures with the file that the plant came from: rasterises the source model from assimp's
 * arrays, without import, lists or packs (the filling of triangles alone is shared), and compares with the masks
 * that ecoview wrote.
 *
 *   source_check MODEL SCALE FOOT_X,FOOT_Y,FOOT_Z CAMERA.json FRAMES_DIR
 *
 * SCALE and FOOT are what the import did after turning Z up, (p - FOOT) * SCALE, as `ecopack info --json`
 * says them. Prints one line a frame and the least Q; exit 0; 3 where it cannot compare. */
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"
#include "lod/raster/raster.h"

struct soup {
	uint32_t count, capacity;
	float *position, *uv;
	uint32_t *material;
};

struct skin { struct eco_image image; bool cutout; };

static void fail(const char *what, const char *text)
{
	fprintf(stderr, "source_check: %s: %s\n", what, text);
	exit(1);
}

static void add_triangle(struct soup *soup, const double p[3][3], const float uv[3][2], uint32_t material)
{
	if (soup->count == soup->capacity) {
		soup->capacity = soup->capacity ? 2 * soup->capacity : 4096;
		soup->position = realloc(soup->position, soup->capacity * 9 * sizeof(float));
		soup->uv = realloc(soup->uv, soup->capacity * 6 * sizeof(float));
		soup->material = realloc(soup->material, soup->capacity * sizeof(uint32_t));
		if (!soup->position || !soup->uv || !soup->material)
			fail("memory", "none left");
	}
	for (int c = 0; c < 3; c++) {
		for (int i = 0; i < 3; i++)
			soup->position[9 * soup->count + 3 * c + i] = (float)p[c][i];
		soup->uv[6 * soup->count + 2 * c] = uv[c][0];
		soup->uv[6 * soup->count + 2 * c + 1] = uv[c][1];
	}
	soup->material[soup->count++] = material;
}

static void add_mesh(struct soup *soup, const struct aiMesh *mesh, const struct aiMatrix4x4 *m)
{
	for (unsigned f = 0; f < mesh->mNumFaces; f++) {
		const struct aiFace *face = &mesh->mFaces[f];
		if (face->mNumIndices != 3)
			continue;
		double p[3][3];
		float uv[3][2] = { { 0 } };
		for (int c = 0; c < 3; c++) {
			const struct aiVector3D *v = &mesh->mVertices[face->mIndices[c]];
			double x = m->a1 * v->x + m->a2 * v->y + m->a3 * v->z + m->a4;
			double y = m->b1 * v->x + m->b2 * v->y + m->b3 * v->z + m->b4;
			double z = m->c1 * v->x + m->c2 * v->y + m->c3 * v->z + m->c4;
			p[c][0] = x;
			p[c][1] = -z;
			p[c][2] = y;
			if (mesh->mTextureCoords[0]) {
				uv[c][0] = mesh->mTextureCoords[0][face->mIndices[c]].x;
				uv[c][1] = 1 - mesh->mTextureCoords[0][face->mIndices[c]].y;
			}
		}
		add_triangle(soup, p, uv, mesh->mMaterialIndex);
	}
}

static void add_node(struct soup *soup, const struct aiScene *scene, const struct aiNode *node,
	struct aiMatrix4x4 parent)
{
	struct aiMatrix4x4 m = parent;
	aiMultiplyMatrix4(&m, &node->mTransformation);
	for (unsigned i = 0; i < node->mNumMeshes; i++)
		add_mesh(soup, scene->mMeshes[node->mMeshes[i]], &m);
	for (unsigned i = 0; i < node->mNumChildren; i++)
		add_node(soup, scene, node->mChildren[i], m);
}

static void settle(struct soup *soup, double scale, const double foot[3])
{
	for (uint32_t i = 0; i < 3 * soup->count; i++)
		for (int k = 0; k < 3; k++)
			soup->position[3 * i + k] = (float)((soup->position[3 * i + k] - foot[k]) * scale);
}

static void load_skin(struct skin *skin, const struct aiScene *scene, unsigned material, const char *model)
{
	struct aiString path;
	struct eco_error error = { 0 };
	if (aiGetMaterialTexture(scene->mMaterials[material], aiTextureType_DIFFUSE, 0, &path, NULL, NULL,
			NULL, NULL, NULL, NULL))
		return;
	if (path.data[0] == '*') {
		const struct aiTexture *t = scene->mTextures[atoi(path.data + 1)];
		if (t->mHeight == 0 && eco_image_read_memory(&skin->image, t->pcData, t->mWidth, path.data,
				&error))
			fail(model, error.text);
	} else {
		char file[4096];
		const char *slash = strrchr(model, '/');
		snprintf(file, sizeof file, "%.*s%s", slash ? (int)(slash - model + 1) : 0, model, path.data);
		if (eco_image_read(&skin->image, file, &error))
			fprintf(stderr, "source_check: %s (drawn opaque)\n", error.text);
	}
	for (size_t i = 0; skin->image.rgba && i < (size_t)skin->image.width * skin->image.height; i++)
		skin->cutout = skin->cutout || skin->image.rgba[4 * i + 3] < 128;
}

/* assimp drops WebP textures (EXT_texture_webp) without a word, and an opaque card proves nothing about a
 * cut-out one. */
static void refuse_webp(const char *path)
{
	char *bytes = NULL;
	size_t size = 0;
	FILE *f = fopen(path, "rb"), *copy = open_memstream(&bytes, &size);
	for (int c; f && copy && (c = fgetc(f)) != EOF;)
		fputc(c, copy);
	if (!f || !copy || fclose(copy))
		fail(path, "cannot be read");
	fclose(f);
	if (memmem(bytes, size, "EXT_texture_webp", 16)) {
		printf("%s cannot be compared: its textures are WebP, which this check does not read\n",
			path);
		exit(3);
	}
	free(bytes);
}

static double check_frame(struct lod_raster *raster, const struct soup *soup, const struct skin *skins,
	const struct eco_view *view, double near_m, const char *dir, uint32_t frame)
{
	char file[4096];
	struct lod_eye eye;
	struct eco_image mask;
	struct eco_error error = { 0 };
	struct lod_place here = { .cosine = 1, .scale = 1 };
	lod_eye_make(&eye, view);
	lod_raster_clear(raster);
	lod_raster_camera(raster, &eye, near_m);
	lod_raster_object(raster, &here);
	for (uint32_t i = 0; i < soup->count;) {
		uint32_t end = i;
		while (end < soup->count && soup->material[end] == soup->material[i])
			end++;
		const struct skin *skin = &skins[soup->material[i]];
		lod_raster_triangles(raster,
			&(struct lod_raster_batch){ .count = end - i,
			.position = soup->position + 9 * (size_t)i,
			.uv = soup->uv + 6 * (size_t)i, .cutout = skin->cutout ? &skin->image : NULL,
			.owner = 1 });
		i = end;
	}
	snprintf(file, sizeof file, "%s/frame-%04u.mask.png", dir, frame);
	if (eco_image_read(&mask, file, &error))
		fail(file, error.text);
	if (mask.width != raster->width || mask.height != raster->height)
		fail(file, "not the size of the first mask");
	uint8_t *cover = malloc((size_t)mask.width * mask.height);
	for (size_t i = 0; i < (size_t)mask.width * mask.height; i++)
		cover[i] = mask.rgba[4 * i];
	struct lod_score score;
	lod_score(&score, &(struct lod_score_input){ .width = mask.width, .height = mask.height,
		.cover = cover, .reference = raster->cover });
	printf("%s frame %u: %u triangles, %llu pixels, P %.5f R %.5f Q %.5f\n",
		strrchr(dir, '/') ? strrchr(dir, '/') + 1 : dir, frame, soup->count,
		(unsigned long long)(score.tp + score.fn), score.precision, score.recall, score.q);
	free(cover);
	eco_image_free(&mask);
	return score.q;
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	struct eco_camera *camera;
	struct soup soup = { 0 };
	struct eco_image first;
	struct lod_raster raster;
	double foot[3], least = 1;
	char file[4096];
	if (argc != 6 || sscanf(argv[3], "%lf,%lf,%lf", &foot[0], &foot[1], &foot[2]) != 3) {
		fprintf(stderr, "usage: source_check MODEL SCALE FOOT_X,FOOT_Y,FOOT_Z CAMERA.json "
			"FRAMES_DIR\n");
		return 2;
	}
	refuse_webp(argv[1]);
	const struct aiScene *scene = aiImportFile(argv[1], aiProcess_Triangulate);
	if (!scene)
		fail(argv[1], aiGetErrorString());
	struct aiMatrix4x4 identity;
	aiIdentityMatrix4(&identity);
	add_node(&soup, scene, scene->mRootNode, identity);
	settle(&soup, atof(argv[2]), foot);
	struct skin *skins = calloc(scene->mNumMaterials, sizeof *skins);
	for (unsigned i = 0; i < scene->mNumMaterials; i++)
		load_skin(&skins[i], scene, i, argv[1]);
	if (eco_camera_load(&camera, argv[4], &error))
		fail(argv[4], error.text);
	snprintf(file, sizeof file, "%s/frame-0000.mask.png", argv[5]);
	if (eco_image_read(&first, file, &error))
		fail(file, error.text);
	if (lod_raster_init(&raster,
			&(struct lod_raster_options){ .width = first.width, .height = first.height }, &error))
		fail(argv[1], error.text);
	for (uint32_t i = 0; i < eco_camera_frame_count(camera); i++) {
		struct eco_view view;
		eco_camera_frame(camera, i, &view);
		view.width = first.width;
		view.height = first.height;
		double q = check_frame(&raster, &soup, skins, &view, 1e-4, argv[5], i);
		least = q < least ? q : least;
	}
	printf("%s least Q %.5f\n", argv[1], least);
	return 0;
}
