/* A plant model as it came from a file: an indexed triangle soup with materials and images.
 *
 *   eco_model_import(&model, &options, &error);     file(s) -> soup (ecofiles/import/model/model_import.h)
 *   lod_plant_build(&plant, &model, ...);           soup -> lists in priority order (lod/build/plant.h)
 *   eco_model_free(&model); */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* why a triangle of the source is not stored; every triangle is stored or counted here */
enum eco_drop {
	ECO_DROP_BAD_INDEX,      /* names a vertex that is not there */
	ECO_DROP_NOT_FINITE,     /* a NaN or infinite coordinate */
	ECO_DROP_DEGENERATE,     /* two corners coincide or the area is zero: it covers no pixel */
	ECO_DROP_DUPLICATE,      /* the same three corners as another triangle of the same material */
	ECO_DROP_TRANSPARENT,    /* no texel under it reaches alpha 0.5 */
	ECO_DROP_QUANTIZED,      /* collapses on the list's grid */
	ECO_DROP_LEFT_OUT,       /* a rule of the scene file, or its part's name, leaves it out */
	ECO_DROP_COUNT
};
extern const char *const eco_drop_names[ECO_DROP_COUNT];

struct eco_image {           /* 8-bit RGBA, straight alpha, sRGB, first row at the top; owns `rgba` */
	uint32_t width, height;
	uint8_t *rgba;
};
void eco_image_free(struct eco_image *image);
/* Whether the image cuts anything out: alpha is below 0.5 somewhere. */
bool eco_image_has_holes(const struct eco_image *image);

struct eco_material {
	char name[64];
	/* sRGB base colour; multiplies the image where there is one: white after an import */
	uint8_t rgb[3];
	bool cutout;             /* alpha of the image matters: a sample is opaque where alpha >= 0.5 */
	/* the file says no colour: wood is drawn brown, all else green (lod/build/organ/organ.h) */
	bool colourless;
	uint32_t image;          /* index into images or ECO_NONE */
};

struct eco_part {            /* a mesh, object or group of the file, as it names them */
	char name[64];
};

#define ECO_ORGAN_FOUND 255u     /* no rule says: lod/build/organ/organ.h finds it */
#define ECO_IMPORTANCES_MAX 255u /* distinct numbers that rules give */

/* The meaning taken for the file's numbers. Up: the file's axis that points up; FOUND: from the format, else
 * by shape, Y or Z. */
enum eco_up { ECO_UP_FOUND, ECO_UP_Y, ECO_UP_Z, ECO_UP_X };
static inline const char *eco_up_name(enum eco_up up)
{
	return up == ECO_UP_Z ? "z" : up == ECO_UP_X ? "x" : "y";
}
enum eco_how { ECO_HOW_UNKNOWN, ECO_HOW_GIVEN, ECO_HOW_FORMAT, ECO_HOW_SHAPE, ECO_HOW_CONVENTION,
	ECO_HOW_GUESSED, ECO_HOW_HEIGHT };
struct eco_model_source {
	char format[64];         /* of the first file, for messages */
	enum eco_up up;          /* not FOUND */
	enum eco_how up_how;     /* given, format, shape, or the format's convention */
	enum eco_up up_by_shape; /* where the format says one and the shape is clearly another's; else FOUND */
	double unit_m;           /* metres per unit */
	enum eco_how unit_how;   /* given, format, guessed from the height, or set by height_m */
	double size[3];          /* of the triangles kept, Z up, in the file's units */
	double below;            /* depth below the ground, in these units */
};

struct eco_model {           /* owns all its arrays; zero-initialised is empty */
	uint32_t vertex_count, triangle_count, material_count, image_count;
	float *position;         /* 3 per vertex, metres, Z up, foot of the plant at the origin */
	float *uv;               /* 2 per vertex or NULL; (0,0) is the image's top left, wraps */
	uint32_t *index;         /* 3 per triangle */
	uint32_t *material;      /* 1 per triangle */
	uint32_t *part;          /* 1 per triangle, index into parts; NULL without parts */
	uint8_t *organ;          /* 1 per triangle: enum eco_organ (pack.h) or ECO_ORGAN_FOUND; or NULL */
	/* 1 per triangle: index into importances, [0]: no rule says; or NULL */
	uint8_t *importance;
	float importances[ECO_IMPORTANCES_MAX + 1]; uint32_t importance_count;
	struct eco_material *materials;
	struct eco_image *images;
	struct eco_part *parts;  uint32_t part_count;
	double foot[3], scale;   /* position = (source's, Z up - foot) * scale */
	/* no plant, such as a building: all of it is treated as wood, and simplified as a whole (lod/build/plant.h) */
	bool object;
	struct eco_model_source source;
	uint32_t triangles_in;   /* triangles of the source; = triangle_count + sum of dropped */
	uint32_t dropped[ECO_DROP_COUNT];
};

void eco_model_free(struct eco_model *model);

/* Greatest z of the model: its height above the ground. */
double eco_model_height(const struct eco_model *model);
