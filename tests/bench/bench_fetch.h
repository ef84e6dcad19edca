/* One answer from a server's half to a viewer's half, in this process, byte by byte as it would travel: plan,
 * stream, decode. */
#pragma once

#include "client-min/view_reference.h"
#include "client-min/view_store.h"
#include "server/stream.h"

struct bench_fetch {
	lod_rule *rule;          /* asked: zero is the default */
	bool ignore_occlusion;
	/* answered: until the body stands; until the last byte is decoded */
	double plan_ms, decode_ms;
	uint64_t bytes;          /* of the body */
	/* that it took: more than one where the store's memory is short */
	uint32_t requests;
};

/* `store` is told what it lacks; it may be empty. `fetch` may be NULL. ECO_TOO_LARGE where no answer is so
 * small, and where bounds of the walk or of memory do not hold a view. */
enum eco_code bench_fetch(struct bench_fetch *fetch, const struct srv_scene *scene,
	const struct eco_request *request, struct view_store *store, struct eco_error *error);

/* Nearest plane of pictures of the store's plan. */
double bench_near_m(const struct view_store *store);
/* Draws the store's plan by the rasteriser, in the light of a sky (NULL: without shadows). The caller frees the picture and the selection, also after an
 * error; `drawing` must stay where it is while its job is used. */
struct bench_drawing { struct view_selection selection; struct lod_eye eye; struct view_draw_job job; };
enum eco_code bench_draw(struct bench_drawing *drawing, const struct view_store *store, const struct eco_view
	*view, const struct view_sky *sky, struct view_picture *picture, struct eco_error *error);
