/* Poses of cameras as vision has them: matrices and quaternions become yaw, pitch and roll in a world with Z up.
 *
 * Camera axes: OpenGL looks along -z with y up (NeRF, glTF); OpenCV along z with y down (TUM, KITTI, COLMAP); ROS bodies along x with z up.
 * Worlds: Z up, Y up (glTF), or y down as the first camera of a sequence had it (KITTI, COLMAP). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define DEG 57.29577951308232
#define KITTI_RATE 10.0          /* its cameras' */
#define PICTURE_RATE 2.0         /* what photogrammetry's users take out of a film */

/* ---- Axes ---- */

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
	double right[3] = { look[1] / flat, -look[0] / flat, 0 };
	double level[3] = { right[1] * look[2] - right[2] * look[1], right[2] * look[0] - right[0] * look[2], right[0] * look[1] - right[1] * look[0] };
	double sideways = 0, upright = 0;
	for (int i = 0; i < 3; i++) {
		sideways += up[i] * right[i];
		upright += up[i] * level[i];
	}
	fix->yaw_deg = atan2(look[0], look[1]) * DEG;
	fix->roll_deg = atan2(sideways, upright) * DEG;
}

static void to_z_up(double v[3], enum eco_world world)
{
	double y = v[1], z = v[2];
	if (world == ECO_WORLD_Y) {
		v[1] = -z;
		v[2] = y;
	} else if (world == ECO_WORLD_MINUS_Y) {
		v[1] = z;
		v[2] = -y;
	}
}

void track_pose(struct eco_fix *fix, const double rotation[9], const double position[3], struct track_axes axes)
{
	/* column of the rotation, and its sign */
	static const struct { int look, up; double look_sign, up_sign; } columns[] = {
		[ECO_AXES_OPENGL] = { 2, 1, -1, 1 }, [ECO_AXES_OPENCV] = { 2, 1, 1, -1 }, [ECO_AXES_ROS] = { 0, 2, 1, 1 } };
	double look[3], up[3], look_length = 0, up_length = 0;
	for (int i = 0; i < 3; i++) {
		look[i] = columns[axes.axes].look_sign * rotation[3 * i + columns[axes.axes].look];
		up[i] = columns[axes.axes].up_sign * rotation[3 * i + columns[axes.axes].up];
		fix->at[i] = position[i];
		look_length += look[i] * look[i];
		up_length += up[i] * up[i];
	}
	to_z_up(fix->at, axes.world);
	look_length = sqrt(look_length);
	up_length = sqrt(up_length);
	if (!(look_length > 1e-9 && up_length > 1e-9 && look_length < 1e9 && up_length < 1e9)) {
		fix->at[0] = NAN;
		return;
	}
	for (int i = 0; i < 3; i++) {
		look[i] /= look_length;
		up[i] /= up_length;
	}
	to_z_up(look, axes.world);
	to_z_up(up, axes.world);
	look_along(fix, look, up);
}

struct track_axes track_axes_of(const struct track_input *in, enum eco_axes axes, enum eco_world world)
{
	const struct eco_track_options *o = in->options;
	return (struct track_axes){ o->axes != ECO_AXES_DEFAULT ? o->axes : axes, o->world != ECO_WORLD_DEFAULT ? o->world : world };
}

bool track_rotation(const double q[4], double r[9])
{
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(length > 1e-9 && length < 1e9))
		return false;
	double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
	const double rows[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
		2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y) };
	memcpy(r, rows, sizeof rows);
	return true;
}

void track_set_rate(struct eco_track *track, const struct track_input *in, double rate)
{
	if (in->options->rate > 0)
		rate = in->options->rate;
	for (uint32_t i = 0; i < track->count; i++)
		track->fixes[i].time_s = i / rate;
	track->timed = track->count > 0;
	if (in->options->rate <= 0 && track->count > 1)
		eco_track_note(track, "the poses have no times: %g of them a second are taken (--rate N for another number)", rate);
}

/* ---- Pictures ---- */

enum eco_code track_names_add(struct track_names *names, const char *name, size_t length, const struct eco_fix *fix, struct eco_error *error)
{
	if (names->count == ECO_TRACK_FIXES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u poses", ECO_TRACK_FIXES_MAX);
	if ((names->count & (names->count - 1)) == 0) {
		struct track_named *grown = realloc(names->items, (names->count ? 2 * (size_t)names->count : 1) * sizeof *grown);
		if (!grown)
			return eco_fail(error, ECO_NO_MEMORY, "no memory for %u poses", names->count);
		names->items = grown;
	}
	char *copy = strndup(name, length);
	if (!copy)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a name");
	names->items[names->count] = (struct track_named){ copy, *fix, names->count };
	names->count++;
	return ECO_OK;
}

static int by_name(const void *a, const void *b)
{
	const struct track_named *x = a, *y = b;
	int order = track_compare_names(x->name, y->name);
	return order ? order : (x->place > y->place) - (x->place < y->place);
}

static int by_place(const void *a, const void *b)
{
	const struct track_named *x = a, *y = b;
	return (x->place > y->place) - (x->place < y->place);
}

enum eco_code track_names_end(struct track_names *names, struct eco_track *track, struct eco_error *error)
{
	bool different = true, moved = false;
	enum eco_code code = ECO_OK;
	if (names->count)
		qsort(names->items, names->count, sizeof *names->items, by_name);
	for (uint32_t i = 0; i < names->count; i++) {
		different &= names->items[i].name[0] && (!i || track_compare_names(names->items[i - 1].name, names->items[i].name) != 0);
		moved |= names->items[i].place != i;
	}
	if (!different && names->count)
		qsort(names->items, names->count, sizeof *names->items, by_place);
	else if (moved)
		eco_track_note(track, "the poses are put in the order of their pictures' names");
	for (uint32_t i = 0; i < names->count; i++) {
		if (!code)
			code = track_add(track, &names->items[i].fix, error);
		free(names->items[i].name);
	}
	free(names->items);
	*names = (struct track_names){ 0 };
	return code;
}

/* ---- Lines of numbers ---- */

static int read_numbers(const struct track_line *line, double *values, int most)
{
	const char *at = line->text;
	int count = 0;
	while (count < most && track_number(&at, line->end, &values[count])) {
		count++;
		while (at < line->end && strchr(" \t,;", *at))
			at++;
	}
	return count;
}

static bool is_comment(const struct track_line *line)
{
	const char *at = line->text;
	while (at < line->end && (*at == ' ' || *at == '\t'))
		at++;
	return at == line->end || *at == '#' || *at == '%';
}

/* Seconds, or thousandths, millionths, billionths of them since 1970. */
static double stamp(double t)
{
	return t > 1e17 ? t * 1e-9 : t > 1e14 ? t * 1e-6 : t > 1e11 ? t * 1e-3 : t;
}

/* t tx ty tz qx qy qz qw */
enum eco_code track_read_tum(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct track_axes axes = track_axes_of(in, ECO_AXES_OPENCV, ECO_WORLD_Z);
	struct track_line line = { 0 };
	enum eco_code code = ECO_OK;
	track->posed = true;
	while (!code && track_next_line(in, &line)) {
		struct eco_fix fix = track_fix(line.number);
		double v[8], rotation[9];
		if (is_comment(&line))
			continue;
		if (read_numbers(&line, v, 8) < 8 || !track_rotation(v + 4, rotation)) {
			track_skip(track, ECO_TRACK_BAD_NUMBER, line.number);
			continue;
		}
		track_pose(&fix, rotation, v + 1, axes);
		fix.time_s = stamp(v[0]);
		code = track_add(track, &fix, error);
	}
	if (in->options->axes == ECO_AXES_DEFAULT)
		eco_track_note(track, "cameras are taken to look along their z axis, as TUM has it; poses of a robot's body: --axes ros");
	return code;
}

/* Rows of [R|t], 12 numbers, or 16 with the last row; a number before them is the frame or the time. */
enum eco_code track_read_kitti(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct track_axes axes = track_axes_of(in, ECO_AXES_OPENCV, ECO_WORLD_MINUS_Y);
	struct track_line line = { 0 };
	bool fractions = false, numbered = false;
	enum eco_code code = ECO_OK;
	track->posed = true;
	while (!code && track_next_line(in, &line)) {
		struct eco_fix fix = track_fix(line.number);
		double v[18];
		if (is_comment(&line))
			continue;
		int count = read_numbers(&line, v, 18), first = count == 13 || count == 17;
		if (count != 12 && count != 16 && !first) {
			track_skip(track, ECO_TRACK_BAD_NUMBER, line.number);
			continue;
		}
		const double *m = v + first, rotation[9] = { m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10] }, position[3] = { m[3], m[7], m[11] };
		track_pose(&fix, rotation, position, axes);
		numbered |= first;
		fractions |= first && v[0] != floor(v[0]);
		fix.time_s = first ? stamp(v[0]) : NAN;
		code = track_add(track, &fix, error);
	}
	if (!numbered)
		track_set_rate(track, in, KITTI_RATE);
	double rate = in->options->rate > 0 ? in->options->rate : KITTI_RATE;
	for (uint32_t i = 0; numbered && !fractions && i < track->count; i++)
		track->fixes[i].time_s /= rate;
	if (numbered && !fractions)
		eco_track_note(track, "the number before each pose is taken for a frame's, %g a second (--rate)", rate);
	return code;
}

/* IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, world to camera; after each a line of points. */
enum eco_code track_read_colmap(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct track_axes axes = track_axes_of(in, ECO_AXES_OPENCV, ECO_WORLD_MINUS_Y);
	struct track_names names = { 0 };
	struct track_line line = { 0 };
	enum eco_code code = ECO_OK;
	bool points = false;
	track->posed = true;
	while (!code && track_next_line(in, &line)) {
		struct eco_fix fix = track_fix(line.number);
		double v[9], r[9], center[3];
		if (points || is_comment(&line)) {
			points = false;
			continue;
		}
		points = true;
		const char *name = line.end;
		while (name > line.text && name[-1] != ' ')
			name--;
		if (read_numbers(&line, v, 9) < 9 || !track_rotation((double[4]){ v[2], v[3], v[4], v[1] }, r)) {
			track_skip(track, ECO_TRACK_BAD_NUMBER, line.number);
			continue;
		}
		const double back[9] = { r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8] };
		for (int i = 0; i < 3; i++)
			center[i] = -(back[3 * i] * v[5] + back[3 * i + 1] * v[6] + back[3 * i + 2] * v[7]);
		track_pose(&fix, back, center, axes);
		code = track_names_add(&names, name, (size_t)(line.end - name), &fix, error);
	}
	enum eco_code ended = track_names_end(&names, track, error);
	track_set_rate(track, in, PICTURE_RATE);
	if (in->options->world == ECO_WORLD_DEFAULT)
		eco_track_note(track, "COLMAP's world has no up of its own: its -y is taken, as in the first camera (--up z if it was aligned)");
	return code ? code : ended;
}
