/* The inside of fitting splats, shared by splat_fit.c (levels), splat_views.c (the plant's pictures),
 * splat_gradient.c (one picture of splats and its gradient), splat_descent.c and splat_blades.c.
 *
 * Everything is in units of the plant's bounding sphere: its centre is 0, its radius 1. */
#pragma once

#include "lod/arena.h"
#include "lod/build/splat/splat_fit.h"
#include "lod/light.h"
#include "lod/sort.h"

/* The fitted numbers of a splat: 0..2 centre, 3 + 3 k + i half axis k, 12 opacity. Half axes need not be
 * orthogonal while they are fitted: the ellipsoid is the image of the unit ball. */
#define SPLAT_PARAMS 13u
#define SPLAT_AXES 3u
#define SPLAT_OPACITY 12u
struct splat_params { float v[SPLAT_PARAMS]; };

struct splat_view {
	double right[3], down[3], forward[3];
	/* share of each pixel that the plant covers; rows of `stride`. Coarse pixels have four shares, those
	 * of the pixels in each: one plane after another */
	float *cover;
	/* mean light of that share, in 1/65535, how much of it is wood, and the mean square of its lod_light_gray; `pixels`
	 * a row */
	float (*light)[5];
	double covered;              /* sum of cover */
	float (*sample)[3];          /* points of the visible surface */
	uint32_t *triangle;          /* of the model, that each shows */
	uint32_t sample_count;
	/* samples that show leaves (lod_splats_options.leaf), and in how many runs of one leaf along rows */
	uint32_t leaf_samples, leaf_runs;
};

struct splat_views {
	uint32_t count, pixels, stride, planes;      /* planes: 1, or 4 of coarse views */
	uint32_t samples;            /* of the surface, at most, in each */
	float scale;                 /* pixels a radius */
	struct splat_view *items;
	double center[3], radius;    /* of the model, metres */
};

/* Draws the model in all views. `views->covered` is 0 everywhere if it shows nothing. */
void splat_views_make(struct splat_views *views, const struct eco_model *model,
	const struct lod_splats_options *options, struct lod_arena *arena);

/* The width of leaves, radii; see lod_splats.leaf. 0: there are none. */
double splat_views_leaf(const struct splat_views *views);

/* The same views in pixels twice as wide and high, without light and samples: what large splats cover hardly
 * changes within one, so that they are fitted in a quarter of the work (lod/EXPERIMENTS.md, Coarse views). */
void splat_views_coarsen(struct splat_views *coarse, const struct splat_views *views,
	struct lod_arena *arena);

/* Those of all views. */
struct splat_points { float (*at)[3]; uint32_t *triangle, count; };
struct splat_part { uint32_t first, end; };      /* some of them */

/* Softness of edges while splats are fitted. */
struct splat_softness {
	float edge_px;               /* half the width of the ramp across an edge */
	float least;                 /* least half width of the ramp, of x^T C^-1 x around 1; at most 1 */
	float blur_px2;              /* added to the square of half axes on the screen; the area stays */
	float chance;                /* in [0, 1]: how much of the objective is the Q that is expected of
	                              * one sample a pixel; the rest is soft Q */
	float area;                  /* weight of the square of what is drawn too much or too little, over what is covered */
};

/* One splat in one view: a soft-edged ellipse. */
struct splat_ellipse {
	float x, y, b[2][3];         /* centre; half axes on the screen, pixels */
	float c[3], m[3], det, soft_det;     /* C without blur; inverse with blur: xx, xy, yy */
	float amp, alpha, high, slope;       /* alpha: opacity * amp * MOST; t = high - slope q */
	int32_t x0, x1, y0, y1;      /* pixels, half open; empty if it is outside */
};

/* A picture of splats, scratch: share that is left free, rows of stride; and each splat as it is drawn. */
struct splat_picture { float *free; float *weight; struct splat_ellipse *ellipses; };

/* 1 - Q of the picture of the splats in one view, times 1 + soft->area's part; adds its gradient to `gradient`, one for
 * each of the first `moving` splats. */
double splat_view_loss(const struct splat_views *views, uint32_t view, const struct splat_params *splats,
	uint32_t count, uint32_t moving, const struct splat_softness *soft,
	const struct splat_picture *picture, struct splat_params *gradient);

/* gain[i]: how much 1 - Q falls where splat i of a level gives way to its children in the next. */
void splat_gains(const struct splat_views *views, const struct splat_params *parents, uint32_t count,
	const struct splat_params *level, uint32_t children, struct lod_arena *arena, double *gain);

/* The colours of a level: means of the light that the plant shows where a splat is in front; and which splats are wood:
 * more than half of that. A splat that is nowhere in front is as its parent, in `parents` (NULL in the first level), or
 * grey foliage. Returns the deviation of what foliage splats stand for (lod_splats.tone). */
double splat_color_level(const struct splat_views *views, const struct splat_params *splats, uint32_t count,
	const struct lod_splat *parents, uint32_t children, struct lod_arena *arena, struct lod_splat *out);

/* ---- Descent (splat_descent.c) ---- */

/* Gradient descent of one level of splats: Adam (Kingma and Ba 2015) on batches of views, with falling steps
 * and edges that grow sharper. */

struct splat_descent {
	const struct splat_views *views, *coarse;
	float coarse_share;              /* so much of the descent looks at `coarse`, the rest at `views` */
	struct splat_params *splats;     /* a level; in: where it begins, out: where it ends */
	uint32_t count;
	/* The level before, as it ended, or NULL: then some steps draw some of it with the children of the
	 * others, so that pictures between two levels are good, too. */
	const struct splat_params *parents;
	uint32_t children;               /* of each parent */
	bool blades;                     /* of a plant of blades, which takes more views a step */
	float chance;                    /* struct splat_softness */
	bool settle;                     /* shapes stay, as they have been rounded; a few steps of the rest */
	uint32_t level, levels;          /* for progress */
	const struct lod_splats_options *options;
	double loss;                     /* out: mean 1 - soft Q of all views */
};

/* False if progress says stop. */
bool splat_descend(struct splat_descent *descent, struct lod_arena *arena);

/* ---- Shapes (splat_shape.c) ---- */

/* Eigenvectors of a symmetric matrix (rows) and its eigenvalues, falling. */
void splat_eigen(const double matrix[3][3], double value[3], double vector[3][3]);
/* Mean of points and eigenvectors of their second moments, the longest first. */
void splat_moments(const float (*point)[3], uint32_t count, double mean[3], double value[3],
	double vector[3][3]);
/* Sorts points along their longest axis. */
void splat_sort_along(float (*point)[3], uint32_t count, struct lod_arena *arena);
/* Half axes made orthogonal. */
void splat_orthogonal(struct splat_params *splat);

/* Inverse of the sum of its half axes' squares, which are no shorter than `least`; and x^T of that x around
 * its centre: 1 on the ellipsoid. */
void splat_inverse(const struct splat_params *splat, double least, double inverse[3][3]);
static inline double splat_distance2(const struct splat_params *splat, const double inverse[3][3],
	const float point[3])
{
	double d[3] = { point[0] - splat->v[0], point[1] - splat->v[1], point[2] - splat->v[2] }, sum = 0;
	for (int i = 0; i < 3; i++)
		sum += d[i] * (inverse[i][0] * d[0] + inverse[i][1] * d[1] + inverse[i][2] * d[2]);
	return sum;
}

/* Codes and what they say. */
void splat_store(struct lod_splat *out, const struct splat_params *splat, const struct lod_splats *splats);
void splat_restore(struct splat_params *out, const struct lod_splat *splat, const struct lod_splats *splats);

/* ---- Plants of blades (splat_blades.c) ---- */

struct splat_blades {
	uint32_t levels, level;      /* all; the one with a splat for each blade */
	uint32_t size[LOD_SPLAT_LEVELS];
	struct splat_part *parts;    /* points of each splat of that level */
};

/* Whether nearly all of the plant are blades, each a component of its own. Then it sorts the points, but not
 * their triangles, by the parts. */
bool splat_blades_find(struct splat_blades *blades, const struct splat_points *points,
	const struct eco_model *model, struct lod_arena *arena);
/* The points of splat i of a level up to that of the blades. */
struct splat_part splat_blades_part(const struct splat_blades *blades, uint32_t level, uint32_t i);
