/* Poses of cameras: a rotation becomes yaw, pitch and roll in a world with Z up. OpenGL's cameras look along -z with y up (glTF), OpenCV's
 * along z with y down, ROS bodies along x with z up. Worlds have Z up, Y up (glTF), or y down as the first camera of a sequence had it. */
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define DEG 57.29577951308232

/* Sets yaw, pitch and roll of a fix from the camera's axes in the world (Z up): units, `look` ahead and `up`. */
static void look_along(struct eco_fix *fix, const double look[3], const double up[3])
{
	double flat = hypot(look[0], look[1]);
	fix->pitch_deg = atan2(look[2], flat) * DEG;
	if (flat < 1e-6) {
		/* straight down or up: yaw is where the picture's upper edge points */
		double sign = look[2] < 0 ? 1 : -1;
		fix->yaw_deg = atan2(sign * up[0], sign * up[1]) * DEG;
		fix->roll_deg = 0;
		return;
	}
	double right[2] = { look[1] / flat, -look[0] / flat };
	double upright = (right[1] * up[0] - right[0] * up[1]) * look[2] + (right[0] * look[1] - right[1] * look[0]) * up[2];
	fix->yaw_deg = atan2(look[0], look[1]) * DEG;
	fix->roll_deg = atan2(up[0] * right[0] + up[1] * right[1], upright) * DEG;
}

static void to_z_up(double v[3], enum eco_world world)
{
	double y = v[1], z = v[2], sign = world == ECO_WORLD_Y ? 1 : -1;
	if (world == ECO_WORLD_DEFAULT || world == ECO_WORLD_Z)
		return;
	v[1] = -sign * z;
	v[2] = sign * y;
}

/* Column `column` of the rotation as a unit in the world; false if it is none. */
static bool axis_of(const double rotation[9], int column, double sign, enum eco_world world, double axis[3])
{
	const double *r = rotation + column;
	double length = sqrt(r[0] * r[0] + r[3] * r[3] + r[6] * r[6]);
	for (int i = 0; i < 3; i++)
		axis[i] = sign * r[3 * i] / length;
	to_z_up(axis, world);
	return length > 3e-5 && length < 3e4;
}

void track_pose(struct eco_fix *fix, const struct track_input *in, const double rotation[9], const double position[3], enum eco_axes axes,
	enum eco_world world)
{
	/* columns of the rotation, and their signs */
	static const struct { int look, up; double look_sign, up_sign; } columns[] = {
		[ECO_AXES_OPENGL] = { 2, 1, -1, 1 }, [ECO_AXES_OPENCV] = { 2, 1, 1, -1 }, [ECO_AXES_ROS] = { 0, 2, 1, 1 } };
	double look[3], up[3];
	axes = in->options->axes != ECO_AXES_DEFAULT ? in->options->axes : axes;
	world = in->options->world != ECO_WORLD_DEFAULT ? in->options->world : world;
	memcpy(fix->at, position, sizeof fix->at);
	to_z_up(fix->at, world);
	if (axis_of(rotation, columns[axes].look, columns[axes].look_sign, world, look) &&
		axis_of(rotation, columns[axes].up, columns[axes].up_sign, world, up))
		look_along(fix, look, up);
	else
		fix->at[0] = NAN;
}
