/* A plant model as it came from a file: an indexed triangle soup with materials and images.
 *
 *   eco_model_import(&model, &options, &error);     file(s) -> soup, Z-up, metres, foot at the origin, non-finite and
 *                                                   out-of-range triangles dropped and counted
 *   lod_plant_build(&plant, &model, ...);           soup -> lists in priority order (lod/plant.h)
 *   eco_model_free(&model);
 */
#ifndef ECO_MODEL_H
#define ECO_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/status.h"

#define ECO_NONE UINT32_MAX

enum eco_drop {              /* why a triangle of the source is not stored; every triangle is stored or counted here */
	ECO_DROP_BAD_INDEX,      /* names a vertex that is not there */
	ECO_DROP_NOT_FINITE,     /* a NaN or infinite coordinate */
	ECO_DROP_DEGENERATE,     /* two corners coincide or the area is zero: it covers no pixel */
	ECO_DROP_DUPLICATE,      /* the same three corners as another triangle of the same material */
	ECO_DROP_TRANSPARENT,    /* no texel under it reaches alpha 0.5 */
	ECO_DROP_QUANTIZED,      /* collapses on the list's grid */
	ECO_DROP_COUNT
};
extern const char *const eco_drop_names[ECO_DROP_COUNT];

struct eco_image {           /* 8-bit RGBA, straight alpha, sRGB, first row at the top; owns `rgba` */
	uint32_t width, height;
	uint8_t *rgba;
};

struct eco_material {
	char name[64];
	uint8_t rgb[3];          /* sRGB base colour; multiplies the image where there is one: white after an import */
	bool cutout;             /* alpha of the image matters: a sample is opaque where alpha >= 0.5 */
	uint32_t image;          /* index into images or ECO_NONE */
};

struct eco_model {           /* owns all its arrays; zero-initialised is empty */
	uint32_t vertex_count, triangle_count, material_count, image_count;
	float *position;         /* 3 per vertex, metres, Z up, foot of the plant at the origin */
	float *uv;               /* 2 per vertex or NULL; (0,0) is the image's top left, wraps */
	uint32_t *index;         /* 3 per triangle */
	uint32_t *material;      /* 1 per triangle */
	struct eco_material *materials;
	struct eco_image *images;
	double foot[3], scale;   /* position = (source's, Z up - foot) * scale */
	uint32_t triangles_in;   /* triangles of the source; = triangle_count + sum of dropped */
	uint32_t dropped[ECO_DROP_COUNT];
};

struct eco_model_options {
	const char *path;
	double height_m;         /* scale so that the model is this high; 0: the file's own unit is metres */
	uint32_t triangles_max;  /* 0: 20,000,000 */
	void (*warn)(void *ctx, const char *text);   /* may be NULL; one sentence per call: a missing texture, ... */
	void *ctx;
};

/* Imports OBJ, glTF or GLB through assimp (textures through the image module, multiplied by
 * their materials' colours). Y-up formats are turned to Z-up. The foot (the
 * centre of the lowest 2 % of the wood-like, else of all, vertices) goes to x = y = 0, the lowest vertex to z = 0. Errors name
 * file and reason. On failure *model is empty. */
enum eco_code eco_model_import(struct eco_model *model, const struct eco_model_options *options, struct eco_error *error);
void eco_model_free(struct eco_model *model);

/* Greatest z of the model: its height, as its lowest vertex is at 0. */
double eco_model_height(const struct eco_model *model);

#endif
