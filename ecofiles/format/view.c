/* Checks a view before anything is computed from it: after this there is no division by zero and no NaN. */
#include "ecofiles/format/view.h"

#include <math.h>
#include <string.h>

#define COORDINATE_MAX 1e12

static enum eco_code check_vector(const double v[3], const char *name, struct eco_error *error)
{
	for (int i = 0; i < 3; i++)
		if (!(fabs(v[i]) <= COORDINATE_MAX))     /* also NaN */
			return eco_fail(error, ECO_BAD_INPUT, "%s: its %c is %g; give a number of metres "
				"within %g", name, "xyz"[i], v[i], COORDINATE_MAX);
	return ECO_OK;
}

struct eco_view eco_view_next(const struct eco_request *request)
{
	struct eco_view view = request->view;
	memcpy(view.eye, request->next.eye, sizeof view.eye);
	memcpy(view.target, request->next.target, sizeof view.target);
	return view;
}

static double distance(const double a[3], const double b[3])
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return sqrt(x * x + y * y + z * z);
}

/* Degrees between two directions. */
static double angle_deg(const struct eco_view *a, const struct eco_view *b)
{
	double dot = 0, lengths = distance(a->eye, a->target) * distance(b->eye, b->target);
	for (int i = 0; i < 3; i++)
		dot += (a->target[i] - a->eye[i]) * (b->target[i] - b->eye[i]);
	return acos(fmax(-1, fmin(1, dot / lengths))) * 57.295779513082321;
}

bool eco_view_turned(const struct eco_request *request, const struct eco_view *now)
{
	const struct eco_view *then = &request->view, next = eco_view_next(request);
	return angle_deg(now, &next) > angle_deg(then, &next) + then->fov_y_deg / 4
		|| distance(now->eye, next.eye) > 1.25 * distance(then->eye, next.eye);
}

/* + 0.0: no zero is negative, which would be written otherwise. */
static double snap(double value, double step)
{
	return floor(value / step + 0.5) * step + 0.0;
}

void eco_view_snap(struct eco_view *view, double step_m)
{
	double eye[3], target[3];
	bool meet = true;
	for (int i = 0; i < 3 && step_m > 0; i++) {
		eye[i] = snap(view->eye[i], step_m);
		target[i] = snap(view->target[i], step_m);
		meet &= eye[i] == target[i];
	}
	if (meet)
		return;
	memcpy(view->eye, eye, sizeof eye);
	memcpy(view->target, target, sizeof target);
}

void eco_request_snap(struct eco_request *request, double step_m)
{
	struct eco_view next = eco_view_next(request);
	eco_view_snap(&request->view, step_m);
	eco_view_snap(&next, step_m);
	memcpy(request->next.eye, next.eye, sizeof next.eye);
	memcpy(request->next.target, next.target, sizeof next.target);
}

enum eco_code eco_view_check(const struct eco_view *view, struct eco_error *error)
{
	ECO_PASS(check_vector(view->eye, "eye", error));
	ECO_PASS(check_vector(view->target, "target", error));
	ECO_PASS(check_vector(view->up, "up", error));
	if (view->eye[0] == view->target[0] && view->eye[1] == view->target[1]
			&& view->eye[2] == view->target[2])
		return eco_fail(error, ECO_BAD_INPUT, "target: it is the same point as eye (%g, %g, %g); "
			"move one of them", view->eye[0], view->eye[1], view->eye[2]);
	if (!(view->fov_y_deg >= ECO_FOV_LEAST_DEG && view->fov_y_deg <= 180 - ECO_FOV_LEAST_DEG))
		return eco_fail(error, ECO_BAD_INPUT, "fov_y_deg: %g; give an angle between 0 and 180 degrees, %g "
			"off both at least", view->fov_y_deg, ECO_FOV_LEAST_DEG);
	if (view->width < 1 || view->width > ECO_IMAGE_MAX)
		return eco_fail(error, ECO_BAD_INPUT, "width: %u; give 1 to %u pixels", view->width,
			ECO_IMAGE_MAX);
	if (view->height < 1 || view->height > ECO_IMAGE_MAX)
		return eco_fail(error, ECO_BAD_INPUT, "height: %u; give 1 to %u pixels", view->height,
			ECO_IMAGE_MAX);
	return ECO_OK;
}
