/* Light on the GPU, as view_light_picture makes it in memory and by the same text (draw/view_light.glsl):
 * from what view_gl_record has left in textures to the colours of a picture, without reading a pixel.
 *
 *   web_light_draw(&light, gl, &job, &error);       `light.lit` is the picture
 *   web_light_present(&light, gl, &place);          puts it into the page
 *   web_light_forget(&light);                       another selection comes */
#pragma once

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_gpu.h"
#include "client-min/draw/view_light.h"
#include "client-min/view_ground.h"
#include "client-min/web/web_mean.h"
#include "client-min/web/web_program.h"

/* The image on the ground on the GPU: levels of tiles are uploaded once, one after the other, and stay until
 * there is no more room. */
struct web_image_slot { uint32_t levels, block[ECO_GROUND_IMAGE_LEVELS]; };
struct web_image {                       /* zero is empty */
	/* of the selection's tree, then four words a tile: blocks of its levels */
	struct view_gpu_texels nodes;
	uint32_t node_count;
	struct view_gpu_texels texels;   /* red, green, blue, alpha */
	uint64_t blocks;                 /* in use */
	struct view_table table;         /* lists to slots */
	struct web_image_slot *slots; uint32_t count, room;
};

struct web_light {                       /* zero is empty */
	struct web_lit lit;
	struct web_mean mean;            /* of its samples, once there are some */
	unsigned programs[3][2];         /* of an image on the ground, or none, or one with water; of shadows, or none */
	unsigned program, present;       /* of them, the one in use; of web_light_present */
	unsigned shade;
	struct view_gpu gpu;
	/* of the selection, if `held`: three texels an instance, their feet from `origin` */
	struct view_gpu_texels plants;
	double origin[3];
	struct web_image image;          /* of the selection, if `held` */
	struct web_shadow shadow;        /* of the picture, if there is any */
	bool held;
	bool shaded;                     /* `shade` is of this selection and that sun */
	float sun[3];
	double low[2], side_m;           /* where `shade` lies: view_light.h; side_m 0: nowhere */
};

/* Compiles what light needs, without an image on the ground, with one, or with one that has water (2); with shadows or without,
 * which drawing else does itself. */
enum eco_code web_light_prepare(struct web_light *light, unsigned image, bool shadows, struct eco_error *error);
/* All of the picture that gl has recorded, of the job's selection. Another sample of it than the first
 * (lod_eye_sample; in turn from 1 on, after web_mean_prepare) takes the shadow map of the first, and the
 * picture becomes the mean of all. */
enum eco_code web_light_draw(struct web_light *light, struct view_gl *gl, const struct view_draw_job *job,
	uint32_t width, uint32_t height, struct eco_error *error);
/* Puts the picture into what the page's context draws to: colours, and depths that hide what the page draws
 * itself, and are hidden by it. The page's depth of a pixel is depth[0] + depth[1] / distance, in [0, 1]; where
 * nothing is, the sky, it is 1, and without `sky` nothing is drawn there, nor without `ground` where no plant
 * is. marked: 1 + the number of an instance that has a rim; 0: none. Into the framebuffer that is bound, all of `viewport`: x, y, width, height. */
struct web_place {
	float depth[2];
	int viewport[4];
	bool sky, ground;
	uint32_t marked;
};
void web_light_present(const struct web_light *light, const struct view_gl *gl, const struct web_place *place);
/* Reads the colours, 3 bytes a pixel. */
enum eco_code web_light_read(const struct web_light *light, uint8_t *rgb, struct eco_error *error);
void web_light_forget(struct web_light *light);
void web_light_free(struct web_light *light);
