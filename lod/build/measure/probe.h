/* A plant seen from all around, or from above: the cover of its lists, measured with the rasteriser.
 *
 *   lod_probe_init(&probe, plant, model, &options);
 *   lod_probe_clear(&probe); lod_probe_add(&probe, &cut);              ranges of the plant's lists
 *   lod_probe_keep(&probe);                                            ... become the reference
 *   lod_probe_compare(&probe, 1, &result);                             others against the reference
 *   lod_probe_free(&probe);
 *
 * The views lie on a Fibonacci spiral over the sphere, from slightly below the horizon to steeply above, 16 radii
 * away (lod/EXPERIMENTS.md, Curves from above). */
#pragma once

#include <stdbool.h>

#include "ecofiles/format/plan.h"
#include "lod/build/plant.h"
#include "lod/geometry.h"
#include "lod/impostor.h"
#include "lod/raster/raster.h"

struct lod_probe_options {
	uint32_t views, pixels;      /* pictures of pixels x pixels around the plant's bounding sphere */
	lod_each *each; void *ctx;   /* draws several views at a time; may be NULL */
};

struct lod_drawing {                 /* one cut; `floats`: where its geometry begins in the probe's floats */
	const struct eco_list *list;
	uint32_t count, item;        /* item: number of its first primitive among all */
	size_t floats;
	bool uv;
	const struct eco_image *cutout;
	const struct lod_mask *mask;
	float area;
};

struct lod_probe {
	const struct lod_plant *plant;
	const struct eco_model *model;
	struct eco_scene scene;          /* the plant's lists, ladders and curves as a scene */
	struct eco_list *lists;
	struct eco_chunk *chunks;
	bool *cut;                       /* per image of the plant: some of it is transparent */
	struct lod_arena arena;          /* of the arrays but drawings and floats */
	const struct lod_mask *masks;    /* per image of the model (model_draw.h) */
	uint32_t views;
	double center[3], radius;
	struct lod_eye *eyes;
	double near_m;
	struct lod_probe_options options;
	struct lod_raster *rasters;  uint32_t raster_count;      /* all of one size; view i is drawn by raster
	                                                          * i modulo their number */
	uint8_t *reference;              /* a mask per view */
	uint64_t *reference_pixels;
	struct lod_drawing *drawings;    uint32_t drawing_count, drawing_capacity;
	float *floats;                   size_t float_count, float_capacity;
	uint64_t primitive_count;        /* of the drawings, an impostor among them; ... */
	uint32_t item_count;             /* ... or not */
	bool colored;                    /* drawings have colours and textures */
	bool smooth;                     /* no leaves on splats and points: quicker, and covers as much in the mean */
	const struct lod_impostor *impostor;     /* drawn with them; NULL: none */
	struct lod_score *scores;        /* per view, of the last comparison */
};

void lod_probe_init(struct lod_probe *probe, const struct lod_plant *plant, const struct eco_model *model,
	const struct lod_probe_options *options);
void lod_probe_free(struct lod_probe *probe);

void lod_probe_clear(struct lod_probe *probe);
/* Moves the views: heights on the unit sphere from `low` to `high`, at first LOD_PROBE_AROUND. A kept
 * reference belongs to the views before. */
#define LOD_PROBE_AROUND -0.2, 0.95
#define LOD_PROBE_ABOVE 0.6, 0.95
void lod_probe_look(struct lod_probe *probe, double low, double high);
/* Other eyes, likewise, for pictures of pixels x pixels. */
void lod_probe_eyes(const struct lod_probe *probe, struct lod_eye *eyes, uint32_t count, uint32_t pixels, double low,
	double high);

/* Adds a cut (list, first, end, scale) of the plant's lists. */
void lod_probe_add(struct lod_probe *probe, const struct eco_cut *cut);
/* Its primitives; valid until the next one is added. */
struct lod_geometry lod_probe_geometry(const struct lod_probe *probe, const struct lod_drawing *drawing);
void lod_probe_draw(const struct lod_probe *probe, struct lod_raster *raster);
/* Adds an impostor, which must stay until lod_probe_clear. */
void lod_probe_add_impostor(struct lod_probe *probe, const struct lod_impostor *impostor);
/* The ranges added so far become the reference. False if it covers nothing in any view. */
bool lod_probe_keep(struct lod_probe *probe);
/* The same with the source model's triangles, as imported. */
bool lod_probe_keep_model(struct lod_probe *probe);

/* Means over every stride-th view, of those that show the reference. */
/* 1 - Q, mean and worst; wrong pixels over pixels of the reference. */
struct lod_probe_result { double loss, worst, fp, fn; };
void lod_probe_compare(struct lod_probe *probe, uint32_t stride, struct lod_probe_result *result);
