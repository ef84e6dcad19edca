/* Billboard clouds of plants (Kratt, Coconu, Dapper, Schliep, Paar, Deussen 2014: Adaptive Billboard Clouds
 * for Botanical Tree Models). A baseline of ecobench.
 *
 *   lod_billboard_plant_open(&plant, &model, &error)                once a plant: its skeleton and density
 *   lod_billboard_cloud_make(&cloud, plant, cap, &error)            once a cap: an alternative, no prefix of
 *                                                                   the cloud of another cap
 *   lod_billboard_cloud_draw(&cloud, &raster)
 *   lod_billboard_cloud_free(&cloud); lod_billboard_plant_close(plant);
 *
 * The plant becomes a tree of nodes, found from the mesh alone (3.1; billboard_skeleton.c). A part is a piece
 * of that tree, and stands as the billboards of one generator (3.3; billboard_fit.c). Parts are kept, split
 * and merged by their error (3.2, 3.4; billboard_parts.c) and their billboards get textures
 * (billboard_cloud.c).
 *
 *   valid      a face is valid if each corner lies within epsilon of its nearest billboard
 *   coverage   C = max(0, sum of valid faces' projected areas - sum of invalid ones'), projected on the
 *              billboard that is nearest to the face
 *   sigma      1 where nothing is dense, 0 at the greatest density: mean over the part. The print has d_min,
 *              which is 0 and would make sigma 0 everywhere
 *   error      sigma (1 - C / area of the faces). The print has quality = sigma C, which would replace
 *              hidden parts last and not, as the text says, first
 *
 * The print gives no sizes: BILLBOARD_ constants in billboard_state.h and the files' own say ours, in shares
 * of the plant's height. Both planes of a cross show the whole part; of planes and strips the one nearest to
 * a face shows it. Only + - * / sqrt and comparisons decide: every machine makes the same cloud. */
#ifndef TESTS_BENCH_BASELINE_BILLBOARD_CLOUD_H
#define TESTS_BENCH_BASELINE_BILLBOARD_CLOUD_H

#include "ecofiles/format/model.h"
#include "lod/vector.h"

struct lod_raster;

enum lod_billboard_form { LOD_BILLBOARD_CROSS, LOD_BILLBOARD_PLANE, LOD_BILLBOARD_STRIP,
	LOD_BILLBOARD_FORMS };

struct lod_billboard {
	struct lod_v3 center, u, v;  /* metres; u, v: half edges, at right angles */
	struct eco_image image;      /* row 0 at center - v, column 0 at center - u; alpha is 0 or 255 */
};

struct lod_billboard_cloud {
	struct lod_billboard *items; uint32_t count;
	uint32_t parts, forms[LOD_BILLBOARD_FORMS];      /* parts of each form */
	double error;                /* mean over the area of all faces */
	double invalid;              /* share of the faces' area that no billboard holds within epsilon */
	double epsilon;              /* share of the height */
	uint64_t texels;             /* of the textures */
};

struct lod_billboard_plant;
/* ECO_NO_MEMORY, or ECO_OK for any model, also one without triangles. The model must outlive the plant. */
enum eco_code lod_billboard_plant_open(struct lod_billboard_plant **plant, const struct eco_model *model,
	struct eco_error *error);
void lod_billboard_plant_close(struct lod_billboard_plant *plant);   /* NULL is fine */
/* At most `cap` billboards, within the least epsilon of a ladder that leaves a mean error of at most .5. Faces
 * that no billboard holds within epsilon are drawn like the others: the paper does not say what becomes of
 * them. */
enum eco_code lod_billboard_cloud_make(struct lod_billboard_cloud *cloud,
	const struct lod_billboard_plant *plant, uint32_t cap, struct eco_error *error);
void lod_billboard_cloud_free(struct lod_billboard_cloud *cloud);

/* Two triangles a billboard; items are numbered as in the cloud, their owner is 1. */
void lod_billboard_cloud_draw(const struct lod_billboard_cloud *cloud, struct lod_raster *raster);

#endif
