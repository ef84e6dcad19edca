/* Shared by the parts of ecoassimp.so. */
#ifndef ECO_ASSIMP_MODULE_H
#define ECO_ASSIMP_MODULE_H

#include "ecofiles/import/model/import_model.h"
#include "ecofiles/base/module.h"

struct aiMaterial;
struct aiScene;

/* Fills model->materials and images from the scene's materials; images are not yet multiplied by the
 * materials' colours. `channel` receives the uv set of each material's image, `invisible` whether the
 * material is fully transparent. */
void assimp_materials(struct eco_model *model, const struct aiScene *scene, const char *path, uint32_t *channel,
	bool *invisible, struct eco_notes *notes);

/* Whether it names a picture as its colour, there or not. */
bool assimp_has_picture(const struct aiMaterial *material);

extern const struct eco_assimp_module eco_assimp_module;

#endif
