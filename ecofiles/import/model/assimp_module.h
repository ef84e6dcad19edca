/* Shared by the parts of ecoassimp.so. */
#ifndef ECO_ASSIMP_MODULE_H
#define ECO_ASSIMP_MODULE_H

#include "ecofiles/import/model/import_model.h"
#include "ecofiles/base/module.h"

struct aiMaterial;
struct aiScene;

/* Fills format, unit, up and convention of the frame. axes: from assimp's world to ours, rows of a matrix,
 * unit included; Z up if the format states its axes, else as in the file. */
void assimp_frame(const struct aiScene *scene, const char *path, struct eco_model_frame *frame,
	double axes[3][3]);

/* Fills model->materials and images from the scene's materials; images are not yet multiplied by the
 * materials' colours. `channel` receives the uv set of each material's image, `invisible` whether the
 * material is fully transparent. */
enum eco_code assimp_materials(struct eco_model *model, const struct aiScene *scene,
	const char *path, uint32_t *channel, bool *invisible, struct eco_notes *notes,
	struct eco_error *error);

/* Whether it names a picture as its colour, there or not. */
bool assimp_has_picture(const struct aiMaterial *material);

extern const struct eco_assimp_module eco_assimp_module;

#endif
