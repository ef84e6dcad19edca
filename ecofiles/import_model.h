/* Inside the model importer: what its files share. Not for others. */
#ifndef ECO_IMPORT_MODEL_H
#define ECO_IMPORT_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/model.h"

#define ECO_MODEL_IMAGES_MAX 1024u

struct aiScene;

/* Sentences for the user that are not errors, one a line; what does not fit is left out. */
struct eco_notes {
	char text[4096];
	size_t used;
};
void eco_note(struct eco_notes *notes, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* KHR_texture_transform of a material's base colour: uv' = offset + turned(scale * uv), v pointing down. */
struct eco_uv_transform {
	bool used;
	double offset[2], scale[2], sine, cosine;
	int64_t channel;             /* -1: as the texture says */
};

/* A model file as assimp shall see it. */
struct eco_model_file {
	const char *path;
	bool gltf;                   /* glTF or GLB: colours are linear, alpha modes are stated */
	bool linear_colors;          /* material colours are linear */
	uint8_t *bytes;              /* instead of the file's own, malloc'ed; NULL: as on disk */
	size_t size_bytes;
	struct eco_uv_transform *transforms;     /* glTF: per material, malloc'ed; NULL: none has any */
	uint32_t transform_count;
};

/* glTF and GLB: refuses by name what cannot be read; where textures come as an extension (WebP) writes a document that says the
 * same without it; notes texture transforms, which assimp gets wrong. Other files: only looks who wrote them. The caller frees
 * bytes and transforms. */
enum eco_code eco_model_file_prepare(struct eco_model_file *file, struct eco_error *error);

/* Reads the scene: positions Z up, uv from the top left, materials and images; triangles_in and what assimp could not triangulate
 * are counted. Not cleaned. */
enum eco_code eco_assimp_read(struct eco_model *model, const struct eco_model_file *file, uint32_t triangles_max,
	struct eco_notes *notes, struct eco_error *error);

/* Fills model->materials and images from the scene's materials; one image per texture and alpha rule: with alpha 255 all over unless
 * some of it is cut out, else with 128 as the threshold. The material's colour is not in the image yet. `channel` receives the
 * uv set of each material's image, `invisible` whether alpha leaves nothing of it. */
enum eco_code eco_assimp_materials(struct eco_model *model, const struct aiScene *scene, const struct eco_model_file *file,
	uint32_t *channel, bool *invisible, struct eco_notes *notes, struct eco_error *error);

/* Multiplies images by the colours of their materials, which become white; equal images become one. Materials may name the images of
 * the model only, at most ECO_MODEL_IMAGES_MAX of them, or none. Fails only for lack of memory. */
enum eco_code eco_model_bake_tints(struct eco_model *model, const char *path, struct eco_notes *notes, struct eco_error *error);

uint8_t eco_srgb_from_linear(double linear);
double eco_linear_from_srgb(uint8_t srgb);

#endif
