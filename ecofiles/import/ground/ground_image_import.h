/* The picture on the ground: rasters of colours, or of classes, cut into a quadtree of squares of texels.
 *
 *   eco_ground_image_look(&options, &error);            whether they can be read, and where they lie
 *   eco_ground_image_open(&reader, &options, &error);
 *   eco_ground_image_next(reader, &tile, &error);       the root, then depth first: split, or texels
 *   eco_ground_image_close(reader, &error);             the verdict of the child that read them
 *
 * A raster in another CRS is warped into the scene's. Each square is read at its own resolution, so only the
 * overview that it needs is read. A square is split while its texels are wider than the rasters', and wider
 * than a pixel of a picture 1080 pixels high, of 45 degrees, taken 1 m from the ground among the plants;
 * squares far from all plants have wider texels.
 *
 * Colours are red, green, blue, or grey, with alpha or not. Bytes are taken as they are. For other numbers
 * the scene says which are black and white, or they are guessed from three bands and noted. A raster with a
 * table of colours (palette), or with classes in the scene, holds numbers of classes: their colours are
 * mixed, never the numbers. Texels outside the rasters, NODATA, masks and classes without colour are clear;
 * towards them the image fades within a thirty-second of the root's side. */
#pragma once

#include "ecofiles/format/ground_tile.h"
#include "ecofiles/import/ground/ground.h"

#define ECO_GROUND_CLASSES_MAX 4096u

struct eco_ground_class { int32_t number; uint8_t rgb[3]; bool clear; };

/* "image" of the ground of a scene file. */
struct eco_ground_image_source {
	char **files;
	uint32_t file_count; /* where several have a colour, the first counts */
	char *crs;                               /* NULL: from the files */
	struct eco_ground_class *classes; uint32_t class_count;  /* beside those of the files; ascending */
	bool has_nodata, has_place, has_range;
	double range[2];                         /* black and white of bands that are no bytes */
	double nodata;                           /* a value that is no colour and no class */
	double corner[2], pixel[2];              /* as in struct eco_ground_source */
	double texel_m;                          /* the least width of a texel; 0: the rasters' */
};

/* A drawing on top of the rasters (import/land/drawing.h). A square where no line and no border passes is not
 * split for it. Called in the child that reads the rasters. */
struct eco_ground_drawing {
	double low[2], high[2], texel_m;         /* around it; width of the texels that it is worth, scene */
	bool (*touches)(const void *ctx, const double low[2], const double high[2]);
	/* on what is in rgba, rows from the north */
	enum eco_code (*paint)(const void *ctx, const double low[2], double texel_m, uint8_t *rgba, struct eco_error *error);
	const void *ctx;
};

struct eco_ground_image_options {
	const struct eco_ground_image_source *source;
	const struct eco_ground_drawing *drawing; /* NULL: none; then the source has a file */
	const char *scene_crs;                   /* as in struct eco_ground_options */
	double origin[3];
	double low[2], high[2];                  /* around all plants, scene; low above high: not known */
	uint32_t tiles_max;                      /* that are not split; 0: 4096 */
	void (*warn)(void *ctx, const char *text);       /* may be NULL; one sentence per call */
	void *ctx;
};

/* Whether the rasters can be read, and what is doubtful about them. */
enum eco_code eco_ground_image_look(const struct eco_ground_image_options *options, struct eco_error *error);

#define ECO_GROUND_IMAGE_BYTES (4 * ECO_GROUND_IMAGE_SIDE * ECO_GROUND_IMAGE_SIDE)
struct eco_ground_image_tile {
	double low[2], texel_m;          /* of the root, in the scene; set by the first call */
	bool split;                      /* its four quarters come next (eco_ground_image_quarter) */
	uint8_t *rgba;                   /* else ECO_GROUND_IMAGE_BYTES of the caller, rows from the north */
};
struct eco_ground_image_reader;
enum eco_code eco_ground_image_open(struct eco_ground_image_reader **reader,
	const struct eco_ground_image_options *options, struct eco_error *error);
/* The first call warns. ECO_DAMAGED: nothing came; the verdict says why. */
enum eco_code eco_ground_image_next(struct eco_ground_image_reader *reader,
	struct eco_ground_image_tile *tile, struct eco_error *error);
enum eco_code eco_ground_image_close(struct eco_ground_image_reader *reader, struct eco_error *error);
