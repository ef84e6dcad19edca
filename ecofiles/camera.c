/* Camera scripts: a few keyframes -> many views.
 *
 * Every number of a view (eye, target, up, field of view) is a cubic Hermite spline through the keyframes, on the actual times. Its
 * slope at an inner keyframe is that of the chord between the two neighbours (Catmull-Rom), at the ends that of the first and last
 * chord: velocity is continuous, and a number that does not change between three keyframes stands still. Between keyframes a and
 * b the spline leaves their smooth blend by at most 4/27 (t_b - t_a) (|slope_a| + |slope_b|); that is all the overshoot there is.
 *
 * A script is checked whole when it is read, every frame of it, so that a fault in frame 900 is not found after 899 pictures. */
#include "ecofiles/view.h"

#include <assert.h>
#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES_MAX 1000000u
#define FPS_LEAST 0.001
#define FPS_MOST 1000.0
#define TIME_MAX_S 1e9
#define FILE_MAX_BYTES (64u << 20)

enum { EYE = 0, TARGET = 3, UP = 6, FOV = 9, NUMBERS = 10 };

struct key { double time_s, number[NUMBERS], slope[NUMBERS]; };

struct eco_camera {
	double fps;
	uint32_t frame_count, key_count;
	struct key *keys;
};

/* ---- Fields. An error names the script and the field, as in `tour.json: keyframes[3].eye[1]: ...` ---- */

struct script { const char *name; struct eco_error *error; };

static enum eco_code bad(const struct script *s, const char *path, const char *format, ...) __attribute__((format(printf, 3, 4)));
static enum eco_code bad(const struct script *s, const char *path, const char *format, ...)
{
	char text[256];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	return eco_fail(s->error, ECO_BAD_INPUT, "%s: %s%s%s", s->name, path, *path ? ": " : "", text);
}

static enum eco_code read_number(const struct script *s, const json_t *value, const char *path, double low, double high, double *out)
{
	if (!value)
		return bad(s, path, "is missing");
	if (!json_is_number(value))
		return bad(s, path, "must be a number");
	*out = json_number_value(value);
	if (!(*out >= low && *out <= high))
		return bad(s, path, "is %g, must lie in [%g, %g]", *out, low, high);
	return ECO_OK;
}

static enum eco_code read_vector(const struct script *s, const json_t *value, const char *path, double out[3])
{
	if (!value)
		return bad(s, path, "is missing");
	if (!json_is_array(value) || json_array_size(value) != 3)
		return bad(s, path, "must be [x, y, z]");
	for (size_t i = 0; i < 3; i++) {
		char element[80];
		snprintf(element, sizeof element, "%s[%zu]", path, i);
		enum eco_code code = read_number(s, json_array_get(value, i), element, -1e12, 1e12, &out[i]);
		if (code)
			return code;
	}
	return ECO_OK;
}

/* Refuses what is not an object, and fields that are not in the NULL-terminated list. */
static enum eco_code check_fields(const struct script *s, json_t *object, const char *path, const char *const *known)
{
	const char *field;
	json_t *value;
	if (!json_is_object(object))
		return bad(s, path, "must be an object in {}");
	json_object_foreach(object, field, value) {
		const char *const *k = known;
		while (*k && strcmp(*k, field) != 0)
			k++;
		if (!*k)
			return bad(s, path, "unknown field \"%.64s\"", field);
	}
	return ECO_OK;
}

static enum eco_code read_key(const struct script *s, json_t *object, size_t index, struct key *key)
{
	static const char *const known[] = { "time_s", "eye", "target", "up", "fov_y_deg", NULL };
	char path[5][64];
	snprintf(path[0], sizeof path[0], "keyframes[%zu]", index);
	enum eco_code code = check_fields(s, object, path[0], known);
	if (code)
		return code;
	for (int i = 0; i < 5; i++)
		snprintf(path[i], sizeof path[i], "keyframes[%zu].%s", index, known[i]);
	json_t *up = json_object_get(object, "up");
	code = read_number(s, json_object_get(object, "time_s"), path[0], -TIME_MAX_S, TIME_MAX_S, &key->time_s);
	if (!code)
		code = read_vector(s, json_object_get(object, "eye"), path[1], key->number + EYE);
	if (!code)
		code = read_vector(s, json_object_get(object, "target"), path[2], key->number + TARGET);
	key->number[UP + 2] = 1;
	if (!code && up)
		code = read_vector(s, up, path[3], key->number + UP);
	if (!code)
		code = read_number(s, json_object_get(object, "fov_y_deg"), path[4], 0, 180, &key->number[FOV]);
	if (!code && (key->number[FOV] == 0 || key->number[FOV] == 180))
		code = bad(s, path[4], "is %g, must lie between 0 and 180", key->number[FOV]);
	if (!code && index && !(key->time_s > key[-1].time_s))
		code = bad(s, path[0], "is %g, but the keyframe before it is at %g: times must ascend", key->time_s, key[-1].time_s);
	return code;
}

static enum eco_code read_keys(const struct script *s, const json_t *array, struct eco_camera *camera)
{
	if (!json_is_array(array) || json_array_size(array) == 0)
		return bad(s, "keyframes", array ? "must be an array of at least one keyframe" : "is missing");
	size_t count = json_array_size(array);
	/* more keyframes than frames is no script; it also keeps the sizes below in range */
	if (count > FRAMES_MAX)
		return bad(s, "keyframes", "there are %zu, at most %u are possible", count, FRAMES_MAX);
	camera->keys = calloc(count, sizeof *camera->keys);
	if (!camera->keys)
		return eco_fail(s->error, ECO_NO_MEMORY, "%s: no memory for %zu keyframes", s->name, count);
	camera->key_count = (uint32_t)count;
	for (size_t i = 0; i < count; i++) {
		enum eco_code code = read_key(s, json_array_get(array, i), i, &camera->keys[i]);
		if (code)
			return code;
	}
	return ECO_OK;
}

/* ---- Interpolation ---- */

static void set_slopes(struct eco_camera *camera)
{
	uint32_t last = camera->key_count - 1;
	for (uint32_t i = 0; i <= last && last; i++) {
		const struct key *a = &camera->keys[i ? i - 1 : 0], *b = &camera->keys[i < last ? i + 1 : last];
		for (int n = 0; n < NUMBERS; n++)
			camera->keys[i].slope[n] = (b->number[n] - a->number[n]) / (b->time_s - a->time_s);
	}
}

/* The last keyframe that is not after `time_s`, but never the last of all unless it is the only one. */
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
	/* as a difference from a: what does not change is exactly what was written */
	for (int n = 0; n < NUMBERS; n++)
		out[n] = a->number[n] + s * s * (3 - 2 * s) * (b->number[n] - a->number[n]) +
			h * s * r * (r * a->slope[n] - s * b->slope[n]);
}

uint32_t eco_camera_frame_count(const struct eco_camera *camera)
{
	return camera->frame_count;
}

double eco_camera_frame(const struct eco_camera *camera, uint32_t frame, struct eco_view *view)
{
	double number[NUMBERS], last = camera->keys[camera->key_count - 1].time_s;
	double time_s = camera->keys[0].time_s + frame / camera->fps;
	assert(frame < camera->frame_count);
	time_s = time_s < last ? time_s : last;
	interpolate(camera, time_s, number);
	memcpy(view->eye, number + EYE, sizeof view->eye);
	memcpy(view->target, number + TARGET, sizeof view->target);
	memcpy(view->up, number + UP, sizeof view->up);
	view->fov_y_deg = number[FOV];
	return time_s;
}

/* ---- The whole script ---- */

static enum eco_code count_frames(const struct script *s, struct eco_camera *camera)
{
	double length_s = camera->keys[camera->key_count - 1].time_s - camera->keys[0].time_s;
	/* 0.1 s * 30 is not quite 3: the last frame counts if it misses the end by a millionth of a frame */
	double frames = floor(length_s * camera->fps + 1e-6) + 1;
	if (frames > FRAMES_MAX)
		return bad(s, "", "%g s at %g frames a second are %.0f frames, at most %u are possible", length_s, camera->fps, frames,
			FRAMES_MAX);
	camera->frame_count = (uint32_t)frames;
	return ECO_OK;
}

static enum eco_code check_frames(const struct script *s, const struct eco_camera *camera)
{
	for (uint32_t i = 0; i < camera->frame_count; i++) {
		struct eco_view view = { .width = 1, .height = 1 };
		struct eco_error cause = { 0 };
		double time_s = eco_camera_frame(camera, i, &view);
		if (eco_view_check(&view, &cause))
			return bad(s, "", "frame %u at %g s cannot be drawn: %s", i, time_s, cause.text);
	}
	return ECO_OK;
}

static enum eco_code read_script(const struct script *s, json_t *root, struct eco_camera *camera)
{
	static const char *const known[] = { "fps", "keyframes", NULL };
	enum eco_code code = check_fields(s, root, "", known);
	if (!code)
		code = read_number(s, json_object_get(root, "fps"), "fps", FPS_LEAST, FPS_MOST, &camera->fps);
	if (!code)
		code = read_keys(s, json_object_get(root, "keyframes"), camera);
	if (!code)
		code = count_frames(s, camera);
	if (code)
		return code;
	set_slopes(camera);
	return check_frames(s, camera);
}

enum eco_code eco_camera_parse(struct eco_camera **camera, const char *json, size_t size, const char *name, struct eco_error *error)
{
	struct script script = { name, error };
	json_error_t where;
	*camera = NULL;
	json_t *root = json_loadb(json, size, JSON_REJECT_DUPLICATES, &where);
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%s: line %d, column %d: %s", name, where.line, where.column, where.text);
	struct eco_camera *made = calloc(1, sizeof *made);
	enum eco_code code = made ? read_script(&script, root, made) : eco_fail(error, ECO_NO_MEMORY, "%s: no memory", name);
	json_decref(root);
	if (code) {
		eco_camera_free(made);
		return code;
	}
	*camera = made;
	return ECO_OK;
}

static enum eco_code read_file(FILE *file, const char *path, char **text, size_t *size, struct eco_error *error)
{
	size_t room = 0;
	*size = 0;
	do {
		room = room ? 2 * room : 4096;
		char *moved = room > 2 * (size_t)FILE_MAX_BYTES ? NULL : realloc(*text, room);
		if (!moved)
			return eco_fail(error, ECO_NO_MEMORY, "%s: no memory for a camera script", path);
		*text = moved;
		*size += fread(*text + *size, 1, room - *size, file);
		if (*size > FILE_MAX_BYTES)
			return eco_fail(error, ECO_TOO_LARGE, "%s: a camera script has at most %u bytes", path, FILE_MAX_BYTES);
	} while (*size == room);
	if (ferror(file))
		return eco_fail(error, ECO_IO, "%s: %s", path, strerror(errno));
	return ECO_OK;
}

enum eco_code eco_camera_load(struct eco_camera **camera, const char *path, struct eco_error *error)
{
	char *text = NULL;
	size_t size;
	*camera = NULL;
	FILE *file = fopen(path, "rb");
	if (!file)
		return eco_fail(error, ECO_IO, "%s: %s", path, strerror(errno));
	enum eco_code code = read_file(file, path, &text, &size, error);
	fclose(file);
	if (!code)
		code = eco_camera_parse(camera, text, size, path, error);
	free(text);
	return code;
}

void eco_camera_free(struct eco_camera *camera)
{
	if (!camera)
		return;
	free(camera->keys);
	free(camera);
}
