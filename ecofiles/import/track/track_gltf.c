/* Cameras of glTF 2.0: a node with a camera, still or moved by an animation of itself or of any node above
 * it, sampled evenly: the nodes are placed anew for each sample. glTF is Y up, cameras look along -z with y
 * up. Curves (CUBICSPLINE) are refused: exporters can sample them, and most do. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/import/model/gltf.h"
#include "ecofiles/import/track/track_read.h"

#define SAMPLES_PER_S 60.0
#define SAMPLES_MAX 100000.0

struct channel {
	uint32_t node;
	const char *path;                    /* "translation", "rotation" or "scale" */
	uint32_t width;                      /* numbers of a value */
	bool stepped;                        /* a value holds until the next */
	double *times, *values;
	uint64_t count;
};

struct motion {
	struct eco_gltf *doc;
	uint32_t camera;                     /* its node */
	double fov_y_deg;
	struct channel *channels; uint32_t count, capacity;
};

static enum eco_code read_channel(struct eco_gltf *doc, struct channel *c, const json_t *sampler,
	struct eco_error *error)
{
	const char *kind = eco_gltf_text(sampler, "interpolation");
	uint64_t values = 0;
	if (strcmp(kind, "CUBICSPLINE") == 0)
		return eco_fail(error, ECO_UNSUPPORTED, "%.250s: an animation of its camera, of node %u, is "
			"curves (CUBICSPLINE): have the exporter sample animations", eco_gltf_path(doc),
			c->node);
	c->stepped = strcmp(kind, "STEP") == 0;
	enum eco_code code = eco_gltf_read_floats(doc, eco_gltf_index(sampler, "input"), 1, &c->times,
		&c->count, error);
	if (!code)
		code = eco_gltf_read_floats(doc, eco_gltf_index(sampler, "output"), c->width, &c->values,
			&values, error);
	bool good = c->count && values == c->count;
	for (uint64_t i = 0; good && i < c->count * c->width; i++)
		good = isfinite(c->values[i]) && (i >= c->count || (isfinite(c->times[i])
			&& (!i || c->times[i] >= c->times[i - 1])));
	return code || good ? code : eco_fail(error, ECO_DAMAGED, "%.250s: an animation of node %u has %llu "
		"times for %llu values, or times that do not ascend", eco_gltf_path(doc), c->node,
		(unsigned long long)c->count, (unsigned long long)values);
}

static bool moves_camera(const struct motion *m, uint32_t node)
{
	uint32_t above = m->camera;
	while (above != ECO_NONE && above != node)
		above = eco_gltf_parent(m->doc, above);
	return above != ECO_NONE;
}

/* Takes a channel that moves the camera, unless one before it does the same. */
static enum eco_code take_channel(struct motion *m, const json_t *animation, const json_t *json,
	struct eco_error *error)
{
	static const char *const paths[] = { "translation", "rotation", "scale" };
	const json_t *target = json_object_get(json, "target"), *sampler = json_array_get(
		json_object_get(animation, "samplers"), eco_gltf_index(json, "sampler"));
	struct channel c = { .node = eco_gltf_index(target, "node") };
	for (uint32_t i = 0; i < 3; i++)
		if (strcmp(eco_gltf_text(target, "path"), paths[i]) == 0) {
			c.path = paths[i];
			c.width = i == 1 ? 4 : 3;
		}
	if (!sampler || !c.path || !moves_camera(m, c.node))
		return ECO_OK;
	for (uint32_t i = 0; i < m->count; i++)
		if (m->channels[i].node == c.node && m->channels[i].path == c.path)
			return ECO_OK;
	if (!eco_array_grow(&m->channels, &m->capacity, m->count, sizeof c))
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", eco_gltf_path(m->doc));
	m->channels[m->count] = c;
	return read_channel(m->doc, &m->channels[m->count++], sampler, error);
}

/* The value at a time, quaternions along the shorter great circle; the node rests before and after. */
static void sample(const struct channel *c, double time_s, double out[4])
{
	uint64_t low = 0, high = c->count - 1;
	while (high - low > 1) {
		uint64_t middle = low + (high - low) / 2;
		*(c->times[middle] <= time_s ? &low : &high) = middle;
	}
	const uint32_t n = c->width;
	const double *a = c->values + low * n, *b = c->values + high * n;
	double h = c->times[high] - c->times[low], dot = 0;
	double s = h > 0 ? fmin(fmax((time_s - c->times[low]) / h, 0), 1) : 0;
	s = c->stepped ? floor(s) : s;
	for (uint32_t i = 0; i < n; i++)
		dot += a[i] * b[i];
	double sign = n == 4 && dot < 0 ? -1 : 1, angle = n == 4 ? acos(fmin(dot * sign, 1)) : 0;
	double sine = sin(angle), wa = sine > 0.01 ? sin((1 - s) * angle) / sine : 1 - s;
	double wb = sine > 0.01 ? sin(s * angle) / sine : s;
	for (uint32_t i = 0; i < n; i++)
		out[i] = wa * a[i] + sign * wb * b[i];
}

/* Position and angles of the camera, Z up; a matrix without directions leaves no position. Straight down or
 * up, yaw is where the picture's upper edge points. */
static void set_pose(struct eco_fix *fix, const double m[16])
{
	double back = sqrt(m[8] * m[8] + m[9] * m[9] + m[10] * m[10]);
	double top = sqrt(m[4] * m[4] + m[5] * m[5] + m[6] * m[6]);
	const double look[3] = { -m[8] / back, m[10] / back, -m[9] / back };
	const double up[3] = { m[4] / top, -m[6] / top, m[5] / top };
	double flat = hypot(look[0], look[1]), sign = look[2] < 0 ? 1 : -1;
	bool steep = flat < 1e-6;
	if (!(back > 3e-5 && back < 3e4 && top > 3e-5 && top < 3e4))
		return;
	fix->at[0] = m[12];
	fix->at[1] = -m[14];
	fix->at[2] = m[13];
	fix->yaw_deg = (steep ? atan2(sign * up[0], sign * up[1]) : atan2(look[0], look[1])) * TRACK_DEG;
	fix->pitch_deg = atan2(look[2], flat) * TRACK_DEG;
	fix->roll_deg = steep ? 0 : atan2(up[0] * look[1] - up[1] * look[0], up[2]) * TRACK_DEG;
}

static enum eco_code add_pose(struct eco_track *track, struct motion *m, double time_s,
	struct eco_error *error)
{
	double matrix[16], value[4];
	struct eco_fix fix = TRACK_FIX(track->count + 1);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; !code && i < m->count; i++) {
		const struct channel *c = &m->channels[i];
		sample(c, time_s, value);
		code = eco_gltf_place_node(m->doc, c->node, c->path, value, c->width, error);
	}
	if (code || (code = eco_gltf_node_matrix(m->doc, m->camera, matrix, error)))
		return code;
	set_pose(&fix, matrix);
	fix.time_s = time_s;
	fix.fov_y_deg = m->fov_y_deg;
	return track_add(track, &fix, error);
}

/* From the first key to the last. */
static enum eco_code add_poses(struct eco_track *track, struct motion *m, struct eco_error *error)
{
	double from_s = m->count ? INFINITY : 0, to_s = -from_s;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < m->count; i++) {
		from_s = fmin(from_s, m->channels[i].times[0]);
		to_s = fmax(to_s, m->channels[i].times[m->channels[i].count - 1]);
	}
	double samples = fmin(fmax(ceil((to_s - from_s) * SAMPLES_PER_S - 1e-6), 8), SAMPLES_MAX);
	double steps = from_s < to_s ? samples : 0;
	for (uint32_t i = 0; !code && i <= steps; i++)
		code = add_pose(track, m, i < steps ? from_s + (to_s - from_s) * (i / steps) : to_s, error);
	return code;
}

static enum eco_code read_camera(struct eco_track *track, struct motion *m, struct eco_error *error)
{
	const json_t *root = eco_gltf_json(m->doc), *node, *animation, *channel, *camera = NULL;
	uint32_t cameras = 0;
	double rest[16];
	size_t i, k;
	json_array_foreach(json_object_get(root, "nodes"), i, node)
		if (eco_gltf_index(node, "camera") != ECO_NONE && !cameras++) {
			camera = eco_gltf_item(m->doc, "cameras", eco_gltf_index(node, "camera"));
			m->camera = (uint32_t)i;
		}
	if (!cameras)
		return eco_fail(error, ECO_NOT_FOUND, "%.250s: no node of it has a camera", track->path);
	if (cameras > 1)
		eco_track_note(track, "it has %u cameras; the first, of node %u, is taken", cameras,
			m->camera);
	m->fov_y_deg = eco_gltf_number(json_object_get(camera, "perspective"), "yfov", NAN) * TRACK_DEG;
	/* refuses nodes that are below themselves */
	enum eco_code code = eco_gltf_node_matrix(m->doc, m->camera, rest, error);
	json_array_foreach(json_object_get(root, "animations"), i, animation)
		json_array_foreach(json_object_get(animation, "channels"), k, channel)
			code = code ? code : take_channel(m, animation, channel, error);
	return code ? code : add_poses(track, m, error);
}

enum eco_code track_read_gltf(struct eco_track *track, struct eco_error *error)
{
	struct motion m = { 0 };
	enum eco_code code = eco_gltf_open_memory(&m.doc, track->path, (const uint8_t *)track->text,
		track->size, error);
	track->posed = true;
	code = code ? code : read_camera(track, &m, error);
	for (uint32_t i = 0; i < m.count; i++) {
		free(m.channels[i].times);
		free(m.channels[i].values);
	}
	free(m.channels);
	eco_gltf_close(m.doc);
	return code;
}
