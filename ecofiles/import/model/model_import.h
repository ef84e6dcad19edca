/* From files to one plant.
 *
 *   eco_model_import(&model, &options, &error);     file(s) -> soup, Z-up, metres, foot at the origin, non-finite and
 *                                                   out-of-range triangles dropped and counted
 *   eco_model_free(&model); */
#ifndef ECO_MODEL_IMPORT_H
#define ECO_MODEL_IMPORT_H

#include "ecofiles/format/model.h"

/* One rule about parts of a plant, the first that fits a triangle counts: {"name": "pot*", "is": "left out"}. */
enum eco_part_kind { ECO_PART_NAME, ECO_PART_COMPONENT, ECO_PART_SIZE };
#define ECO_PART_LEFT_OUT 254u
struct eco_part_rule {
	enum eco_part_kind kind;
	char *name;              /* * and ? are wildcards, case does not count: of the material, or of the mesh, object or group */
	uint32_t component;      /* from 1, connected components by falling area, as `ecopack model` numbers them */
	double size[2];          /* of a component: its diagonal from size[0] to size[1] times that of the whole file */
	uint8_t is;              /* enum eco_organ (pack.h) or ECO_PART_LEFT_OUT */
};

struct eco_model_options {
	const char *const *paths; uint32_t path_count;   /* files of one plant, in one coordinate system */
	double height_m;         /* scale so that the model is this high; 0: by its unit */
	double unit_m;           /* metres per unit of the files; 0: as the format says, else guessed, and said */
	enum eco_up up;
	const struct eco_part_rule *rules; uint32_t rule_count;
	uint32_t triangles_max;  /* of all files; 0: 20,000,000 */
	void (*warn)(void *ctx, const char *text);   /* may be NULL; one sentence per call: a missing texture, a guess, ... */
	void *ctx;
};

/* Imports glTF, GLB, OBJ, FBX, PLY, Collada and what else assimp reads (textures through the image module, multiplied by their
 * materials' colours), several files into one soup, whose parts then are named FILE/OBJECT. Turned to Z up; the foot (where the wood-like,
 * else all, that no rule leaves out is lowest) goes to x = y = 0. The lowest vertex goes to z = 0; twigs that hang lower than the stem's
 * foot, and roots below the file's own zero, stay below (model_stand.c). Errors name file and reason. On failure *model is empty. */
enum eco_code eco_model_import(struct eco_model *model, const struct eco_model_options *options, struct eco_error *error);
/* Beyond these a unit is doubted: the highest tree measures 116 m. */
#define ECO_PLANT_HEIGHT_MOST_M 120.0
#define ECO_PLANT_HEIGHT_LEAST_M 0.01

/* "centimetres"; NULL for what has no name. */
const char *eco_unit_name(double metres);

#endif
