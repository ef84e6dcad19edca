/* From files to one plant.
 *
 *   eco_model_import(&model, &options, &error);     file(s) -> soup, Z-up, metres, foot at the origin,
 *                                                   non-finite and out-of-range triangles dropped and counted
 *   eco_model_free(&model); */
#pragma once

#include "ecofiles/format/model.h"

/* One rule about parts of a plant: {"name": "pot*", "is": "left out"}, {"name": "petal*", "importance": 3}.
 * The first rule that fits a triangle counts. */
enum eco_part_kind { ECO_PART_NAME, ECO_PART_COMPONENT, ECO_PART_SIZE };
#define ECO_PART_LEFT_OUT 254u
struct eco_part_rule {
	enum eco_part_kind kind;
	/* of the material, or of the mesh, object or group; wildcards * and ?, any case */
	char *name;
	uint32_t component;      /* connected component, from 1 by falling area, as in `ecopack model` */
	double size[2];          /* range of a component's diagonal, in the whole file's */
	uint8_t is;              /* enum eco_organ (pack.h), ECO_ORGAN_FOUND or ECO_PART_LEFT_OUT */
	float importance;        /* 0: as the organ's */
};

struct eco_model_options {
	const char *const *paths; uint32_t path_count;   /* files of one plant, in one coordinate system */
	double height_m;         /* height to scale to; 0: by the unit */
	double unit_m;           /* metres per unit of the files; 0: the format's, else guessed */
	enum eco_up up;
	bool keep_origin;        /* no foot is looked for: this point stands on the ground, of the file, in its units, Z up */
	double origin[3];
	/* No plant (model.h): its file's axes and units, or the format's usual ones, are believed, its zero
	 * stays, and all parts that no rule leaves out */
	bool object;
	const struct eco_part_rule *rules; uint32_t rule_count;
	uint32_t triangles_max;  /* of all files; 0: 20,000,000 */
	/* may be NULL; one sentence: a missing texture, a guess, ... */
	void (*warn)(void *ctx, const char *text);
	void *ctx;
};

/* Imports glTF, GLB, OBJ, FBX, PLY, Collada and the other formats of assimp. Textures go through the image
 * module and are multiplied by their materials' colours. Several files become one soup, with parts named
 * FILE/OBJECT. The model is turned to Z up. The foot goes to x = y = 0: the lower end of the wood, or
 * without wood of everything that no rule leaves out. The lowest vertex goes to z = 0, except that twigs
 * below the stem's foot, and roots below the file's own zero, stay below (model_stand.c). Errors name file
 * and reason. On failure *model is empty. */
enum eco_code eco_model_import(struct eco_model *model, const struct eco_model_options *options,
	struct eco_error *error);
/* Beyond these heights the unit is doubted: the highest tree measures 116 m. */
#define ECO_PLANT_HEIGHT_MOST_M 120.0
#define ECO_PLANT_HEIGHT_LEAST_M 0.01
