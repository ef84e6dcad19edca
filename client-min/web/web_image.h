/* The image on the ground on the GPU, looked up by the text of ecoview (view_image.glsl).
 *
 *   code = web_image_upload(&image, &gpu, &selection->image, &error);       once a selection
 *   web_image_set(&image, program, unit, &selection->image, eye);           a program with web_image_text
 *   web_image_free(&image);
 *
 * Levels of tiles are uploaded once, one after the other, and stay until there is no more room: then those
 * that the selection shows are uploaded anew. */
#ifndef WEB_IMAGE_H
#define WEB_IMAGE_H

#include "client-min/draw/view_gpu.h"
#include "client-min/view_image.h"
#include "lod/eye.h"

struct web_image_slot { uint32_t levels, block[ECO_GROUND_IMAGE_LEVELS]; };
struct web_image {                       /* zero is empty */
	struct view_gpu_texels nodes;    /* of the selection's tree, then four words a tile: blocks of its levels */
	uint32_t node_count;
	struct view_gpu_texels texels;   /* red, green, blue, alpha */
	uint64_t blocks;                 /* in use */
	struct view_table table;         /* lists to slots */
	struct web_image_slot *slots; uint32_t count, room;
};

enum eco_code web_image_upload(struct web_image *image, struct view_gpu *gpu, const struct view_image *of,
	struct eco_error *error);
void web_image_free(struct web_image *image);

/* For fragment shaders, behind the text of light: vec3 ground_own(vec3 n, vec3 to), the ground's own colour.
 * */
extern const char web_image_text[];
/* Sets its uniforms in the program that is in use; takes texture units `unit` and the next. */
void web_image_set(const struct web_image *image, unsigned program, int unit, const struct view_image *of,
	const struct lod_eye *eye);

#endif
