/* Still pictures in this process, by way of a stream as a viewer gets it, drawn by the rasteriser, with the
 * plants that were in view and what each of them drew. For sections that compare colours and frames.
 *
 *   bench_still_open(&still, pack, &error);
 *   bench_still_draw(still, &request, &picture, &plants, &error);
 *         as often as wanted; chunks that came once are kept
 *   bench_still_close(still);
 *
 * Full detail is a request of ECO_VERTICES_MAX vertices, the finest ground, ECO_GROUND_PX_MIN, and whole
 * textures, ECO_TEXEL_PX_MIN. */
#ifndef TESTS_BENCH_STILL_H
#define TESTS_BENCH_STILL_H

#include "client-min/draw/view_picture.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/view.h"

struct bench_still;
enum eco_code bench_still_open(struct bench_still **still, const char *pack, struct eco_error *error);
void bench_still_close(struct bench_still *still);                   /* NULL is fine */
const struct eco_scene *bench_still_scene(const struct bench_still *still);

/* A plant in view and what it was drawn with. */
struct bench_plant {
	uint64_t owner;              /* names it in all pictures of a pack */
	uint32_t plant;
	uint8_t band;                /* of the whole plant */
	uint32_t cut_first, cut_count;       /* in bench_plants.cuts */
	uint64_t vertices;
};
struct bench_cut { uint32_t list, first, end; float scale; uint64_t vertices; };
/* sorted by owner; owns its arrays */
struct bench_plants { struct bench_plant *items; uint32_t count; struct bench_cut *cuts; };
void bench_plants_free(struct bench_plants *plants);

/* Both results are replaced (zero them first); plants may be NULL. */
enum eco_code bench_still_draw(struct bench_still *still, const struct eco_request *request,
	struct view_picture *picture, struct bench_plants *plants, struct eco_error *error);

/* A view along a path of views, t in [0, 1]: eye, target and field of view on the straight line between
 * neighbours. */
struct eco_view bench_still_between(const struct eco_view *a, const struct eco_view *b, double t);

#endif
