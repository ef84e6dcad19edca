/* Tracks in JSON, told apart by their members: our own camera scripts, GeoJSON (RFC 7946, with the times that converters add), glTF,
 * and the cameras of neural scenes (transforms.json, camera_path.json). */
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"
#include "ecofiles/format/view.h"

#define DEG 57.29577951308232
#define PICTURE_RATE 2.0
#define DEPTH_MAX 64

static double number(const json_t *object, const char *key)
{
	const json_t *value = json_object_get(object, key);
	return json_is_number(value) ? json_number_value(value) : NAN;
}

/* ---- Times and angles ---- */

/* ISO 8601, or seconds or their thousandths since 1970 (or since anything). */
static double time_of(const json_t *value)
{
	double time_s = NAN;
	if (json_is_number(value)) {
		time_s = json_number_value(value);
		return fabs(time_s) > 1e11 ? time_s * 1e-3 : time_s;
	}
	const char *text = json_string_value(value), *at = text;
	if (!text)
		return NAN;
	const char *end = text + strlen(text);
	return track_date_time(&at, end, &time_s) || (track_is_number(text, end, &time_s)) ? time_s : NAN;
}

static double first_number(const json_t *object, const char *const *keys)
{
	double value = NAN;
	for (int i = 0; keys[i] && isnan(value); i++)
		value = number(object, keys[i]);
	return value;
}

static void read_properties(const json_t *properties, struct eco_fix *fix)
{
	static const char *const times[] = { "time", "timestamp", "datetime", "date", "when", "t", NULL };
	static const char *const yaws[] = { "gimbal_yaw", "gimbal_heading", "yaw", "heading", "bearing", "course", NULL };
	static const char *const pitches[] = { "gimbal_pitch", "pitch", NULL };
	static const char *const rolls[] = { "gimbal_roll", "roll", NULL };
	static const char *const heights[] = { "altitude", "alt", "elevation", "ele", "height", NULL };
	for (int i = 0; times[i] && isnan(fix->time_s); i++)
		fix->time_s = time_of(json_object_get(properties, times[i]));
	fix->yaw_deg = first_number(properties, yaws);
	fix->pitch_deg = first_number(properties, pitches);
	fix->roll_deg = first_number(properties, rolls);
	if (isnan(fix->at[2]))
		fix->at[2] = first_number(properties, heights);
}

/* ---- GeoJSON ---- */

struct geo { struct eco_track *track; uint32_t record, segment, points, lines; struct eco_error *error; bool first; };

static enum eco_code add_position(struct geo *g, const json_t *position, const json_t *properties, double time_s)
{
	struct eco_fix fix = track_fix(++g->record);
	fix.segment = g->segment;
	for (size_t i = 0; i < 3; i++)
		if (json_is_number(json_array_get(position, i)))
			fix.at[i] = json_number_value(json_array_get(position, i));
	fix.time_s = time_s;
	if (properties)
		read_properties(properties, &fix);
	if (g->first && (fabs(fix.at[0]) > 360 || fabs(fix.at[1]) > 90)) {
		g->track->degrees = false;
		eco_track_note(g->track, "its coordinates are no degrees, as GeoJSON's must be: they are taken for metres; if they are in a CRS, add "
			"--track-crs EPSG:...");
	}
	g->first = false;
	return track_add(g->track, &fix, g->error);
}

static enum eco_code add_line(struct geo *g, const json_t *line, const json_t *times)
{
	enum eco_code code = ECO_OK;
	g->segment++;
	g->lines++;
	for (size_t i = 0; !code && i < json_array_size(line); i++)
		code = add_position(g, json_array_get(line, i), NULL, time_of(json_array_get(times, i)));
	g->segment++;
	return code;
}

/* The times of a line's coordinates, as togeojson ("coordTimes", "times") and others write them; NULL: none. */
static const json_t *times_of(const json_t *properties)
{
	static const char *const keys[] = { "coordTimes", "times", "coordinateProperties", "timestamps", NULL };
	for (int i = 0; keys[i]; i++) {
		const json_t *value = json_object_get(properties, keys[i]);
		if (json_is_object(value))
			value = json_object_get(value, "times");
		if (json_is_array(value))
			return value;
	}
	return NULL;
}

static enum eco_code read_geometry(struct geo *g, const json_t *geometry, const json_t *properties, int depth)
{
	const char *type = json_string_value(json_object_get(geometry, "type"));
	const json_t *coordinates = json_object_get(geometry, "coordinates"), *times = times_of(properties), *item;
	enum eco_code code = ECO_OK;
	size_t i;
	if (!type || depth > DEPTH_MAX)
		return ECO_OK;
	if (strcmp(type, "Point") == 0) {
		g->points++;
		return add_position(g, coordinates, properties, NAN);
	}
	if (strcmp(type, "LineString") == 0)
		return add_line(g, coordinates, times);
	if (strcmp(type, "MultiPoint") == 0)
		return add_line(g, coordinates, times);
	if (strcmp(type, "MultiLineString") == 0)
		for (i = 0; !code && i < json_array_size(coordinates); i++) {
			item = json_array_get(times, i);
			code = add_line(g, json_array_get(coordinates, i), json_is_array(item) ? item : times);
		}
	const json_t *parts = json_object_get(geometry, "geometries");
	for (i = 0; !code && i < json_array_size(parts); i++)
		code = read_geometry(g, json_array_get(parts, i), properties, depth + 1);
	return code;
}

static enum eco_code read_geo(struct geo *g, const json_t *node, int depth)
{
	const json_t *features = json_object_get(node, "features"), *geometry = json_object_get(node, "geometry");
	enum eco_code code = ECO_OK;
	if (depth > DEPTH_MAX)
		return ECO_OK;
	if (json_is_array(features)) {
		for (size_t i = 0; !code && i < json_array_size(features); i++)
			code = read_geo(g, json_array_get(features, i), depth + 1);
		return code;
	}
	return read_geometry(g, geometry ? geometry : node, json_object_get(node, "properties"), 0);
}

static enum eco_code read_geojson(struct eco_track *track, const json_t *root, struct eco_error *error)
{
	struct geo g = { .track = track, .error = error, .first = true };
	track->format = ECO_TRACK_GEOJSON;
	track->degrees = true;
	enum eco_code code = read_geo(&g, root, 0);
	if (!code && g.points && g.lines)
		eco_track_note(track, "besides %u line%s it has %u points, which are taken too", g.lines, g.lines == 1 ? "" : "s", g.points);
	return code;
}

/* ---- Neural scenes ---- */

/* Vertical field of view from what a frame, or the whole file, says. */
static double fov_of(const json_t *node, bool *square)
{
	double fl_y = number(node, "fl_y"), fl_x = number(node, "fl_x"), w = number(node, "w"), h = number(node, "h");
	double x = number(node, "camera_angle_x"), y = number(node, "camera_angle_y");
	*square = false;
	if (h > 0 && fl_y > 0)
		return 2 * atan(h / 2 / fl_y) * DEG;
	if (y > 0)
		return y * DEG;
	if (h > 0 && fl_x > 0)
		return 2 * atan(h / 2 / fl_x) * DEG;
	*square = x > 0 && !(w > 0 && h > 0);
	return x > 0 ? 2 * atan(tan(x / 2) * (*square ? 1 : h / w)) * DEG : NAN;
}

/* 16 numbers, flat or in rows; row by row. */
static bool read_matrix(const json_t *matrix, double m[16])
{
	for (size_t i = 0; i < 12; i++) {
		const json_t *row = json_array_get(matrix, i / 4), *value = json_is_array(row) ? json_array_get(row, i % 4) : json_array_get(matrix, i);
		if (!json_is_number(value))
			return false;
		m[i] = json_number_value(value);
	}
	return true;
}

static bool set_matrix(struct eco_fix *fix, const json_t *matrix, struct track_axes axes)
{
	double m[16];
	if (!read_matrix(matrix, m))
		return false;
	const double rotation[9] = { m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10] }, position[3] = { m[3], m[7], m[11] };
	track_pose(fix, rotation, position, axes);
	return true;
}

static enum eco_code read_transforms(struct eco_track *track, const json_t *root, const struct track_input *in, struct eco_error *error)
{
	const json_t *frames = json_object_get(root, "frames");
	struct track_axes axes = track_axes_of(in, ECO_AXES_OPENGL, ECO_WORLD_Z);
	struct track_names names = { 0 };
	enum eco_code code = ECO_OK;
	bool square;
	double fov = fov_of(root, &square);
	track->format = ECO_TRACK_TRANSFORMS;
	track->posed = true;
	for (size_t i = 0; !code && i < json_array_size(frames); i++) {
		const json_t *frame = json_array_get(frames, i);
		const char *name = json_string_value(json_object_get(frame, "file_path"));
		struct eco_fix fix = track_fix((uint32_t)i + 1);
		bool own_square;
		double own = fov_of(frame, &own_square);
		if (!set_matrix(&fix, json_object_get(frame, "transform_matrix"), axes)) {
			track_skip(track, ECO_TRACK_BAD_NUMBER, fix.line);
			continue;
		}
		fix.fov_y_deg = isnan(own) ? fov : own;
		code = track_names_add(&names, name ? name : "", name ? strlen(name) : 0, &fix, error);
	}
	enum eco_code ended = track_names_end(&names, track, error);
	track_set_rate(track, in, PICTURE_RATE);
	if (square)
		eco_track_note(track, "only the width of its pictures' view is stated (camera_angle_x): they are taken for square (--fov for another)");
	return code ? code : ended;
}

static enum eco_code read_camera_path(struct eco_track *track, const json_t *root, const struct track_input *in, struct eco_error *error)
{
	const json_t *path = json_object_get(root, "camera_path");
	struct track_axes axes = track_axes_of(in, ECO_AXES_OPENGL, ECO_WORLD_Z);
	double fps = number(root, "fps"), seconds = number(root, "seconds");
	enum eco_code code = ECO_OK;
	track->format = ECO_TRACK_CAMERA_PATH;
	track->posed = true;
	if (!(fps > 0))
		fps = seconds > 0 ? (double)json_array_size(path) / seconds : 24;
	for (size_t i = 0; !code && i < json_array_size(path); i++) {
		const json_t *pose = json_array_get(path, i);
		struct eco_fix fix = track_fix((uint32_t)i + 1);
		if (!set_matrix(&fix, json_object_get(pose, "camera_to_world"), axes)) {
			track_skip(track, ECO_TRACK_BAD_NUMBER, fix.line);
			continue;
		}
		fix.time_s = (double)i / fps;
		fix.fov_y_deg = number(pose, "fov");
		code = track_add(track, &fix, error);
	}
	return code;
}

/* ---- Which of them ---- */

static enum eco_code check_script(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct eco_camera *camera;
	enum eco_code code = eco_camera_parse(&camera, in->text, in->size, in->path, error);
	track->format = ECO_TRACK_SCRIPT;
	eco_camera_free(camera);
	return code;
}

static enum eco_code read_root(struct eco_track *track, const json_t *root, const struct track_input *in, struct eco_error *error)
{
	const char *type = json_string_value(json_object_get(root, "type"));
	if (json_is_array(json_object_get(root, "camera_path")))
		return read_camera_path(track, root, in, error);
	if (json_is_array(json_object_get(root, "frames")))
		return read_transforms(track, root, in, error);
	if (json_object_get(root, "keyframes"))
		return check_script(track, in, error);
	if (json_is_object(json_object_get(root, "asset")))
		return track_read_gltf(track, in, error);
	if (type)
		return read_geojson(track, root, error);
	return eco_fail(error, ECO_UNSUPPORTED, "%.300s: JSON, but no track that is known: no GeoJSON (\"type\"), no transforms.json (\"frames\"), no "
		"camera path (\"camera_path\"), no glTF (\"asset\"), no camera script (\"keyframes\")", in->path);
}

enum eco_code track_read_json(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	json_error_t problem;
	json_t *root = json_loadb(in->text, in->size, JSON_DECODE_INT_AS_REAL, &problem);
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s:%d:%d: %s", in->path, problem.line, problem.column, problem.text);
	enum eco_code code = read_root(track, root, in, error);
	json_decref(root);
	return code;
}
