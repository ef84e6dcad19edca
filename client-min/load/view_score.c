#include "client-min/load/view_score.h"

#include <math.h>
#include <stdlib.h>

#include "client-min/view_reference.h"
#include "lod/raster/raster.h"

/* Asks a client that holds nothing, and draws what it gets. */
static enum eco_code draw(struct view_fetch *fetch, const struct eco_request *request,
	const volatile sig_atomic_t *stop, struct view_picture *picture, double *predicted_q,
	struct eco_error *error)
{
	struct view_store_options options = { .images = true };
	struct view_fetch_result result;
	struct view_selection selection = { 0 };
	struct view_store *store;
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	enum eco_code code = view_store_new(&store, &options, error);
	if (!code)
		code = view_fetch_stream(fetch, store, request, &result, error);
	if (!code)
		code = view_select_make(&selection, store, &eye, error);
	if (!code) {
		double near_m = view_store_near_m(store) > 0 ? view_store_near_m(store) : 0.1;
		const struct eco_plan *plan = view_store_plan(store);
		*predicted_q = plan ? eco_predicted_q(&plan->prediction) : NAN;
		code = view_reference_draw(&(struct view_reference_job){ .store = store,
			.selection = &selection, .eye = &eye, .near_m = near_m, .stop = stop }, picture,
			error);
	}
	view_select_free(&selection);
	view_store_free(store);
	return code;
}

static enum eco_code score_one(const struct view_load_options *o, struct view_fetch *fetch,
	struct view_picture pictures[2], struct view_scored *scored, struct eco_error *error)
{
	const struct eco_view *view = &o->views[scored->frame];
	struct eco_request request = { .view = *view, .vertices = o->vertices, .bytes = o->bytes };
	struct eco_request everything = { .view = *view, .vertices = ECO_VERTICES_MAX,
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
	struct lod_score score;
	double all_q;
	enum eco_code code = draw(fetch, &request, o->stop, &pictures[0], &scored->predicted_q, error);
	if (!code)
		code = draw(fetch, &everything, o->stop, &pictures[1], &all_q, error);
	if (code)
		return code;
	lod_score(&score, &(struct lod_score_input){ view->width, view->height, pictures[0].cover,
		pictures[1].cover, pictures[0].owner, pictures[1].owner });
	scored->q = score.q;
	scored->precision = score.precision;
	scored->recall = score.recall;
	return ECO_OK;
}

enum eco_code view_score_sample(const struct view_load_options *o, const struct view_answers *answers,
	struct view_fetch *fetch, uint32_t count, struct view_scored *scored, uint32_t *done,
	struct eco_error *error)
{
	struct view_picture pictures[2] = { { 0 } };
	enum eco_code code = ECO_OK;
	*done = 0;
	if (count > answers->count)
		count = answers->count;
	for (int i = 0; i < 2 && !code && count; i++)
		code = view_picture_init(&pictures[i], o->views[0].width, o->views[0].height, error);
	for (uint32_t i = 0; i < count && !code; i++) {
		uint32_t at = (uint32_t)((uint64_t)answers->count * i / count);
		scored[i] = (struct view_scored){ .frame = answers->items[at].frame };
		code = score_one(o, fetch, pictures, &scored[i], error);
		*done += !code;
	}
	for (int i = 0; i < 2; i++)
		view_picture_free(&pictures[i]);
	return code;
}
