#include "client-min/view_stand.h"

#include "client-min/view_ground.h"

/* From so high, above every mountain, a pixel is as wide as the ground may be off. */
#define FROM_M 1e5
#define OFF_M 0.005
#define DEG 57.295779513082321

static enum eco_code ground_at(struct view_fetch *fetch, struct view_store *store, const double at[3],
	double *ground_m, struct view_fetch_result *sum, struct eco_error *error)
{
	struct eco_view view = { .eye = { at[0], at[1], FROM_M }, .target = { at[0], at[1], 0 },
		.up = { 0, 1, 0 }, .fov_y_deg = OFF_M / FROM_M * DEG, .width = 1, .height = 1 };
	struct eco_request request = { .view = view, .bytes = ECO_BYTES_UNBOUNDED };
	struct view_fetch_result result;
	struct view_ground ground = { .count = 0 };
	struct lod_eye eye;
	enum eco_code code = view_fetch_stream(fetch, store, &request, &result, error);
	sum->status = result.status;
	sum->retry_ms = result.retry_ms;
	sum->requests += result.requests;
	sum->bytes += result.bytes;
	lod_eye_make(&eye, &view);
	if (!code)
		code = view_ground_make(&ground, store, &eye, error);
	if (code || !view_ground_height(&ground, at[0], at[1], ground_m))
		*ground_m = 0;
	view_ground_free(&ground);
	return code;
}

enum eco_code view_stand(struct view_fetch *fetch, struct view_store *store, struct eco_request *request,
	struct view_fetch_result *result, struct eco_error *error)
{
	double eye_m, target_m;
	*result = (struct view_fetch_result){ .requests = 0 };
	enum eco_code code = ground_at(fetch, store, request->view.eye, &eye_m, result, error);
	if (!code)
		code = ground_at(fetch, store, request->view.target, &target_m, result, error);
	if (code)
		return code;
	request->view.eye[2] += eye_m;
	request->view.target[2] += target_m;
	request->next.eye[2] += eye_m;
	request->next.target[2] += target_m;
	return ECO_OK;
}
