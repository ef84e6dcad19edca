/* A plant seen from all around, or from above: what its lists cover, measured with the rasteriser.
 *
 *   lod_probe_init(&probe, plant, model, &options, &error);
 *   lod_probe_clear(&probe); lod_probe_add(&probe, &cut, &error);      what to draw: ranges of the plant's lists
 *   lod_probe_keep(&probe);                                            ... is the reference
 *   lod_probe_clear(&probe); lod_probe_add(...);                       something simpler
 *   lod_probe_compare(&probe, 1, &result);                             ... against it
 *   lod_probe_free(&probe);
 *
 * The views lie on a Fibonacci spiral over the sphere, from a little below the horizon to steep from above: where plants are seen
 * from. The camera is 16 radii away, so that the perspective is weak and the measure holds for other distances (Neubert 2011, 2.4:
 * Precision and Recall hardly depend on size and direction). On direction they do: a spruce of level branches loses .2 less of Q
 * from 45 degrees above than in the mean. */
#ifndef LOD_PROBE_H
#define LOD_PROBE_H

#include <stdbool.h>

#include "ecofiles/format/plan.h"
#include "lod/build/plant.h"
#include "lod/raster/raster.h"

struct lod_probe_options {
	uint32_t views, pixels;      /* pictures of pixels x pixels around the plant's bounding sphere */
	lod_each *each; void *ctx;   /* draws views at a time; may be NULL */
};

struct lod_probe {
	const struct lod_plant *plant;
	const struct eco_model *model;
	struct eco_scene scene;          /* the plant's lists, ladders and curves as a scene */
	struct eco_list *lists;
	struct eco_chunk *chunks;
	bool *cut;                       /* per image of the plant: some of it is transparent */
	uint32_t views;
	double center[3], radius;
	struct lod_eye *eyes;
	double near_m;
	struct lod_probe_options options;
	struct lod_raster *rasters;  uint32_t raster_count;      /* all of one size; view i is drawn by i modulo their number */
	uint8_t *reference;              /* a mask per view */
	uint64_t *reference_pixels;
	struct lod_drawing *drawings;    uint32_t drawing_count, drawing_capacity;
	float *floats;                   size_t float_count, float_capacity;
	uint64_t primitive_count;        /* of the drawings */
	struct lod_score *scores;        /* per view, of the last comparison */
};

enum eco_code lod_probe_init(struct lod_probe *probe, const struct lod_plant *plant, const struct eco_model *model,
	const struct lod_probe_options *options, struct eco_error *error);
void lod_probe_free(struct lod_probe *probe);

void lod_probe_clear(struct lod_probe *probe);
/* From where views look: heights on the unit sphere, from `low` to `high`. At first LOD_PROBE_AROUND. What was kept is of the views before. */
#define LOD_PROBE_AROUND -0.2, 0.95
#define LOD_PROBE_ABOVE 0.6, 0.95
void lod_probe_look(struct lod_probe *probe, double low, double high);

/* Adds a cut (list, first, end, scale) of the plant's lists. */
enum eco_code lod_probe_add(struct lod_probe *probe, const struct eco_cut *cut, struct eco_error *error);
/* What has been added becomes the reference. False if it covers nothing in any view. */
bool lod_probe_keep(struct lod_probe *probe);
/* The same with the source model's triangles, as imported. */
bool lod_probe_keep_model(struct lod_probe *probe);

/* Means over the views that show the reference, of every stride-th view. */
struct lod_probe_result { double loss, worst, fp, fn; };     /* 1 - Q: mean and worst; wrong pixels over pixels of the reference */
void lod_probe_compare(struct lod_probe *probe, uint32_t stride, struct lod_probe_result *result);

#endif
