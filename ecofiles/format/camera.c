/* Camera scripts: a few keyframes -> many views.
 *
 * Every number of a view (eye, target, up, field of view) is a cubic Hermite spline through the keyframes,
 * on the actual times. Its slope at an inner keyframe is that of the chord between the two neighbours
 * (Catmull-Rom), at either end that of the outermost chord. So velocity is continuous, and a number that
 * is equal at three keyframes stands still between them. Between keyframes a and b the overshoot beyond
 * their smooth blend is at most 4/27 (t_b - t_a) (|slope_a| + |slope_b|). The field of view overshoots
 * nothing, as an angle beyond those of keyframes may be none: its slopes are limited (Fritsch and Carlson
 * 1980).
 *
 * Reading a script checks every frame, so that a fault in frame 900 is not found after 899 pictures. */
#include "ecofiles/format/view.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/json_read.h"

#define FRAMES_MAX 1000000u
#define FPS_LEAST 0.001
#define FPS_MOST 1000.0
#define TIME_MAX_S 1e9
#define COORDINATE_MAX 1e12
#define FILE_MAX_BYTES (64u << 20)

enum { EYE = 0, TARGET = 3, UP = 6, FOV = 9, NUMBERS = 10 };

struct key { double time_s, number[NUMBERS], slope[NUMBERS]; };

struct eco_camera {
	double fps;
	bool above_ground;
	uint32_t frame_count, key_count;
	struct key *keys;
};

/* ---- Keyframes; an error has the line and column of the value, see json_read.h ---- */

static bool read_key(const struct eco_json *node, uint32_t index, struct key *key)
{
	static const char *const fields[] = { "time_s", "eye", "target", "up", "fov_y_deg", NULL };
	if (!eco_json_object(node, fields))
		return false;
	for (int i = 0; fields[i]; i++)
		if (strcmp(fields[i], "up") != 0 && !eco_json_required(node, fields[i]))
			return false;
	key->number[UP + 2] = 1;
	if (!eco_json_number(node, "time_s", -TIME_MAX_S, TIME_MAX_S, &key->time_s) ||
		!eco_json_numbers(node, "eye", 3, 3, -COORDINATE_MAX, COORDINATE_MAX, key->number + EYE) ||
		!eco_json_numbers(node, "target", 3, 3, -COORDINATE_MAX, COORDINATE_MAX,
		key->number + TARGET) || !eco_json_numbers(node, "up", 3, 3, -COORDINATE_MAX, COORDINATE_MAX,
		key->number + UP) || !eco_json_number(node, "fov_y_deg", ECO_FOV_LEAST_DEG,
		180 - ECO_FOV_LEAST_DEG, &key->number[FOV]))
		return false;
	if (index && !(key->time_s > key[-1].time_s)) {
		struct eco_json time = eco_json_member(node, "time_s");
		return eco_json_fail(&time, ECO_BAD_INPUT, "time_s is %g, but the keyframe before it is at "
			"%g: times must ascend", key->time_s, key[-1].time_s);
	}
	return true;
}

static bool read_keys(const struct eco_json *array, struct eco_camera *camera)
{
	/* more keyframes than frames is no script; it also keeps the sizes below in range */
	if (!eco_json_array(array, FRAMES_MAX))
		return false;
	size_t count = json_array_size(array->value);
	if (count == 0)
		return eco_json_fail(array, ECO_BAD_INPUT, "there are no keyframes: a script needs one or "
			"more");
	camera->keys = calloc(count, sizeof *camera->keys);
	if (!camera->keys)
		return eco_json_fail(array, ECO_NO_MEMORY, "no memory for %zu keyframes", count);
	camera->key_count = (uint32_t)count;
	for (uint32_t i = 0; i < count; i++) {
		struct eco_json node = eco_json_item(array, i);
		if (!read_key(&node, i, &camera->keys[i]))
			return false;
	}
	return true;
}

/* ---- Interpolation ---- */

static double chord(const struct key *a, const struct key *b, int n)
{
	return (b->number[n] - a->number[n]) / (b->time_s - a->time_s);
}

/* The slope at b with which the spline stays between a and b, and between b and c. */
static double limited(double slope, const struct key *a, const struct key *b, const struct key *c, int n)
{
	double before = chord(a, b, n), after = chord(b, c, n), most = 3 * fmin(fabs(before), fabs(after));
	return before * after > 0 ? fmax(-most, fmin(most, slope)) : 0;
}

static void set_slopes(struct eco_camera *camera)
{
	uint32_t last = camera->key_count - 1;
	for (uint32_t i = 0; i <= last && last; i++) {
		const struct key *a = &camera->keys[i ? i - 1 : 0],
			*b = &camera->keys[i < last ? i + 1 : last];
		struct key *key = &camera->keys[i];
		for (int n = 0; n < NUMBERS; n++)
			key->slope[n] = chord(a, b, n);
		if (a != key && b != key)
			key->slope[FOV] = limited(key->slope[FOV], a, key, b, FOV);
	}
}

/* The last keyframe not after `time_s`; never the very last one, unless there is only one. */
static uint32_t segment(const struct eco_camera *camera, double time_s)
{
	uint32_t low = 0, high = camera->key_count - 1;
	while (high - low > 1) {
		uint32_t middle = low + (high - low) / 2;
		if (camera->keys[middle].time_s <= time_s)
			low = middle;
		else
			high = middle;
	}
	return low;
}

static void interpolate(const struct eco_camera *camera, double time_s, double out[NUMBERS])
{
	const struct key *a = &camera->keys[segment(camera, time_s)], *b = a + 1;
	if (camera->key_count == 1 || time_s <= a->time_s) {
		memcpy(out, a->number, sizeof a->number);
		return;
	}
	if (time_s >= b->time_s) {
		memcpy(out, b->number, sizeof b->number);
		return;
	}
	double h = b->time_s - a->time_s, s = (time_s - a->time_s) / h, r = 1 - s;
	/* as a difference from a: a number that does not change keeps its exact value */
	for (int n = 0; n < NUMBERS; n++)
		out[n] = a->number[n] + s * s * (3 - 2 * s) * (b->number[n] - a->number[n]) +
			h * s * r * (r * a->slope[n] - s * b->slope[n]);
}

bool eco_camera_above_ground(const struct eco_camera *camera)
{
	return camera->above_ground;
}

uint32_t eco_camera_frame_count(const struct eco_camera *camera)
{
	return camera->frame_count;
}

uint32_t eco_camera_key_count(const struct eco_camera *camera)
{
	return camera->key_count;
}

static double view_at(const struct eco_camera *camera, double time_s, struct eco_view *view)
{
	double number[NUMBERS];
	interpolate(camera, time_s, number);
	memcpy(view->eye, number + EYE, sizeof view->eye);
	memcpy(view->target, number + TARGET, sizeof view->target);
	memcpy(view->up, number + UP, sizeof view->up);
	view->fov_y_deg = number[FOV];
	return time_s;
}

double eco_camera_frame(const struct eco_camera *camera, uint32_t frame, struct eco_view *view)
{
	double last = camera->keys[camera->key_count - 1].time_s;
	double time_s = camera->keys[0].time_s + frame / camera->fps;
	assert(frame < camera->frame_count);
	return view_at(camera, time_s < last ? time_s : last, view);
}

double eco_camera_key(const struct eco_camera *camera, uint32_t key, struct eco_view *view)
{
	return view_at(camera, camera->keys[key].time_s, view);
}

/* ---- The whole script ---- */

static bool count_frames(const struct eco_json *root, struct eco_camera *camera)
{
	double length_s = camera->keys[camera->key_count - 1].time_s - camera->keys[0].time_s;
	/* 0.1 s * 30 is not quite 3: a last frame within a millionth of a frame of the end counts */
	double frames = floor(length_s * camera->fps + 1e-6) + 1;
	if (frames > FRAMES_MAX)
		return eco_json_fail(root, ECO_TOO_LARGE, "%g s at %g frames a second are %.0f frames, at "
			"most %u are possible", length_s, camera->fps, frames, FRAMES_MAX);
	camera->frame_count = (uint32_t)frames;
	return true;
}

static bool check_frames(const struct eco_json *keyframes, const struct eco_camera *camera)
{
	for (uint32_t i = 0; i < camera->frame_count; i++) {
		struct eco_view view = { .width = 1, .height = 1 };
		struct eco_error cause = { 0 };
		double time_s = eco_camera_frame(camera, i, &view);
		if (eco_view_check(&view, &cause)) {
			struct eco_json node = eco_json_item(keyframes, segment(camera, time_s));
			return eco_json_fail(&node, ECO_BAD_INPUT, "frame %u at %g s, from this keyframe on, "
				"cannot be drawn: %s", i, time_s, cause.text);
		}
	}
	return true;
}

static bool read_script(const struct eco_json *root, struct eco_camera *camera)
{
	static const char *const fields[] = { "fps", "above_ground", "keyframes", NULL };
	if (!eco_json_object(root, fields) || !eco_json_required(root, "fps")
			|| !eco_json_required(root, "keyframes"))
		return false;
	struct eco_json keyframes = eco_json_member(root, "keyframes");
	if (!eco_json_number(root, "fps", FPS_LEAST, FPS_MOST, &camera->fps) ||
		!eco_json_flag(root, "above_ground", &camera->above_ground) ||
		!read_keys(&keyframes, camera) || !count_frames(root, camera))
		return false;
	set_slopes(camera);
	return check_frames(&keyframes, camera);
}

enum eco_code eco_camera_parse(struct eco_camera **camera, const char *json, size_t size, const char *name,
	struct eco_error *error)
{
	struct eco_error cause = { 0 };
	struct eco_json_file file = { .name = name, .text = json, .size = size, .error = &cause };
	*camera = NULL;
	json_t *document = eco_json_open(&file);
	if (!document)
		return eco_fail(error, cause.code, "%s", cause.text);
	struct eco_json root = eco_json_root(&file, document);
	struct eco_camera *made = calloc(1, sizeof *made);
	if (!made)
		eco_fail(&cause, ECO_NO_MEMORY, "%s: no memory for a camera", name);
	else if (read_script(&root, made))
		*camera = made;
	json_decref(document);
	if (*camera)
		return ECO_OK;
	eco_camera_free(made);
	return eco_fail(error, cause.code, "%s", cause.text);
}

enum eco_code eco_camera_load(struct eco_camera **camera, const char *path, struct eco_error *error)
{
	uint8_t *text;
	size_t size;
	*camera = NULL;
	enum eco_code code = eco_file_read(path, FILE_MAX_BYTES, &text, &size, error);
	code = code ? code : eco_camera_parse(camera, (const char *)text, size, path, error);
	free(text);
	return code;
}

void eco_camera_ahead(const struct eco_camera *camera, uint32_t frame, double seconds,
	struct eco_request *request)
{
	struct eco_view view = request->view;
	uint32_t last = eco_camera_frame_count(camera) - 1, at = frame;
	double until_s = eco_camera_frame(camera, frame, &view) + seconds;
	while (at < last && eco_camera_frame(camera, at, &view) < until_s)
		at++;
	request->next.given = at > frame;
	eco_camera_frame(camera, at, &view);
	memcpy(request->next.eye, view.eye, sizeof view.eye);
	memcpy(request->next.target, view.target, sizeof view.target);
}

void eco_camera_free(struct eco_camera *camera)
{
	if (!camera)
		return;
	free(camera->keys);
	free(camera);
}
