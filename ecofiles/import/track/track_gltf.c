/* Cameras of glTF 2.0: a node with a camera, still or moved by an animation of itself or of any node above it. All channels that matter
 * are sampled at the key times of each of them, and between where a rotation or a spline turns much; glTF is Y up, cameras look along -z. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/track/track_read.h"

#define DEG 57.29577951308232
#define DEPTH_MAX 256u
#define SAMPLES_PER_KEY 8u               /* between two keys: a spline or a turn is no straight line */
#define FRAMES_MAX 200000u

enum path { TRANSLATION, ROTATION, SCALE, PATHS };

struct channel {
	double *times, *values;
	uint64_t count;
	enum { LINEAR, STEP, CUBIC } kind;
};

struct link {                            /* a node on the way from the root to the camera */
	uint32_t node;
	struct channel channels[PATHS];
	double local[16], value[PATHS][4];   /* at rest */
};

struct chain {
	struct eco_gltf *doc;
	struct link *links; uint32_t count;  /* [0] is the camera's node */
	double fov_y_deg;
};

static const uint32_t components[PATHS] = { 3, 4, 3 };

static struct channel *channel_at(const struct chain *chain, size_t i) { return &chain->links[i / PATHS].channels[i % PATHS]; }

/* ---- Which camera ---- */

static uint32_t parent_of(const struct eco_gltf *doc, uint32_t node)
{
	const json_t *nodes = json_object_get(eco_gltf_json(doc), "nodes");
	for (size_t i = 0; i < json_array_size(nodes); i++) {
		const json_t *children = json_object_get(json_array_get(nodes, i), "children");
		for (size_t k = 0; k < json_array_size(children); k++)
			if (json_is_number(json_array_get(children, k)) && json_number_value(json_array_get(children, k)) == node)
				return (uint32_t)i;
	}
	return ECO_NONE;
}

static enum eco_code make_chain(struct chain *chain, uint32_t node, struct eco_error *error)
{
	while (node != ECO_NONE) {
		const json_t *json = eco_gltf_item(chain->doc, "nodes", node);
		if (chain->count == DEPTH_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "its camera lies below more than %u nodes, or below itself", DEPTH_MAX);
		struct link *link = &chain->links[chain->count++];
		*link = (struct link){ .node = node, .value = { { 0, 0, 0, 0 }, { 0, 0, 0, 1 }, { 1, 1, 1, 0 } } };
		enum eco_code code = eco_gltf_node_local(chain->doc, node, link->local, error);
		if (code)
			return code;
		eco_gltf_numbers(json, "translation", link->value[TRANSLATION], 3);
		eco_gltf_numbers(json, "rotation", link->value[ROTATION], 4);
		eco_gltf_numbers(json, "scale", link->value[SCALE], 3);
		node = parent_of(chain->doc, node);
	}
	return ECO_OK;
}

/* The node with the camera that was asked for; *cameras counts all. */
static uint32_t find_camera(const struct eco_gltf *doc, const char *wanted, uint32_t *cameras)
{
	const json_t *nodes = json_object_get(eco_gltf_json(doc), "nodes");
	uint32_t found = ECO_NONE;
	*cameras = 0;
	for (size_t i = 0; i < json_array_size(nodes); i++) {
		const json_t *node = json_array_get(nodes, i);
		uint32_t camera = eco_gltf_index(node, "camera");
		if (camera == ECO_NONE)
			continue;
		const char *own = eco_gltf_text(node, "name"), *its = eco_gltf_text(eco_gltf_item(doc, "cameras", camera), "name");
		++*cameras;
		if (found == ECO_NONE && (!wanted || strcmp(wanted, own) == 0 || strcmp(wanted, its) == 0))
			found = (uint32_t)i;
	}
	return found;
}

/* ---- Animations ---- */

static bool ascends(const double *times, uint64_t count)
{
	for (uint64_t i = 0; i < count; i++)
		if (!isfinite(times[i]) || (i && times[i] < times[i - 1]))
			return false;
	return true;
}

static enum eco_code read_channel(struct chain *chain, struct link *link, enum path path, const json_t *sampler, struct eco_error *error)
{
	struct channel *c = &link->channels[path];
	const char *kind = eco_gltf_text(sampler, "interpolation");
	uint64_t values;
	if (c->times)                        /* of an animation before it */
		return ECO_OK;
	c->kind = strcmp(kind, "STEP") == 0 ? STEP : strcmp(kind, "CUBICSPLINE") == 0 ? CUBIC : LINEAR;
	enum eco_code code = eco_gltf_read_floats(chain->doc, eco_gltf_index(sampler, "input"), 1, &c->times, &c->count, error);
	if (!code)
		code = eco_gltf_read_floats(chain->doc, eco_gltf_index(sampler, "output"), components[path], &c->values, &values, error);
	if (!code && (c->count == 0 || values != c->count * (c->kind == CUBIC ? 3 : 1) || !ascends(c->times, c->count)))
		code = eco_fail(error, ECO_DAMAGED, "an animation of node %u has %llu times for %llu values, or times that do not ascend", link->node,
			(unsigned long long)c->count, (unsigned long long)values);
	return code;
}

/* The channels of this animation that move the camera. */
static enum eco_code read_animation(struct chain *chain, const json_t *animation, bool *used, struct eco_error *error)
{
	static const char *const names[PATHS] = { "translation", "rotation", "scale" };
	const json_t *channels = json_object_get(animation, "channels"), *samplers = json_object_get(animation, "samplers");
	enum eco_code code = ECO_OK;
	for (size_t i = 0; !code && i < json_array_size(channels); i++) {
		const json_t *target = json_object_get(json_array_get(channels, i), "target");
		const char *path = eco_gltf_text(target, "path");
		uint32_t node = eco_gltf_index(target, "node"), sampler = eco_gltf_index(json_array_get(channels, i), "sampler");
		for (size_t k = 0; !code && sampler != ECO_NONE && k < PATHS * (size_t)chain->count; k++) {
			if (chain->links[k / PATHS].node != node || strcmp(path, names[k % PATHS]) != 0)
				continue;
			*used = true;
			code = read_channel(chain, &chain->links[k / PATHS], (enum path)(k % PATHS), json_array_get(samplers, sampler), error);
		}
	}
	return code;
}

/* Quaternions along the shorter great circle. */
static void blend(const double *a, const double *b, double s, bool rotation, uint32_t count, double *out)
{
	double dot = 0, sign = 1, wa = 1 - s, wb = s;
	for (uint32_t i = 0; rotation && i < 4; i++)
		dot += a[i] * b[i];
	if (dot < 0) {
		sign = -1;
		dot = -dot;
	}
	if (rotation && dot < 0.9999) {
		double angle = acos(dot > 1 ? 1 : dot), sine = sin(angle);
		wa = sin((1 - s) * angle) / sine;
		wb = sin(s * angle) / sine;
	}
	for (uint32_t i = 0; i < count; i++)
		out[i] = wa * a[i] + sign * wb * b[i];
}

static void sample(const struct channel *c, enum path path, double time_s, double *out)
{
	uint32_t n = components[path];
	uint64_t low = 0, high = c->count - 1, step = c->kind == CUBIC ? 3 : 1, middle_of = c->kind == CUBIC ? 1 : 0;
	if (!c->count)
		return;
	if (time_s <= c->times[0] || c->count == 1 || time_s >= c->times[high]) {
		uint64_t at = time_s <= c->times[0] ? 0 : high;
		memcpy(out, c->values + (at * step + middle_of) * n, n * sizeof *out);
		return;
	}
	while (high - low > 1) {
		uint64_t middle = low + (high - low) / 2;
		if (c->times[middle] <= time_s)
			low = middle;
		else
			high = middle;
	}
	double h = c->times[high] - c->times[low], s = h > 0 ? (time_s - c->times[low]) / h : 0;
	const double *a = c->values + (low * step + middle_of) * n, *b = c->values + (high * step + middle_of) * n;
	if (c->kind == STEP)
		memcpy(out, a, n * sizeof *out);
	else if (c->kind == LINEAR)
		blend(a, b, s, path == ROTATION, n, out);
	else
		for (uint32_t i = 0; i < n; i++) {           /* appendix C of the specification: in-tangent, value, out-tangent */
			double out_a = a[n + i] * h, in_b = b[(int)i - (int)n] * h, s2 = s * s, s3 = s2 * s;
			out[i] = (2 * s3 - 3 * s2 + 1) * a[i] + (s3 - 2 * s2 + s) * out_a + (3 * s2 - 2 * s3) * b[i] + (s3 - s2) * in_b;
		}
}

/* ---- Poses ---- */

static void world_at(const struct chain *chain, double time_s, double world[16])
{
	for (uint32_t k = 0; k < chain->count; k++) {
		const struct link *link = &chain->links[k];
		double value[PATHS][4], local[16];
		bool moved = false;
		memcpy(value, link->value, sizeof value);
		memcpy(local, link->local, sizeof local);
		for (int path = 0; path < PATHS; path++) {
			sample(&link->channels[path], (enum path)path, time_s, value[path]);
			moved |= link->channels[path].count > 0;
		}
		if (moved)
			eco_gltf_compose(local, value[TRANSLATION], value[ROTATION], value[SCALE]);
		if (k == 0)
			memcpy(world, local, sizeof local);
		else
			eco_gltf_multiply(world, local, world);
	}
}

static enum eco_code add_pose(struct eco_track *track, const struct chain *chain, const struct track_input *in, double time_s,
	struct eco_error *error)
{
	double m[16];
	struct eco_fix fix = track_fix(track->count + 1);
	world_at(chain, time_s, m);
	const double rotation[9] = { m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10] };
	track_pose(&fix, in, rotation, m + 12, ECO_AXES_OPENGL, ECO_WORLD_Y);
	fix.time_s = time_s;
	fix.fov_y_deg = chain->fov_y_deg;
	return track_add(track, &fix, error);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Key times of all channels, ascending; malloc'ed, NULL without memory. */
static double *key_times(const struct chain *chain, size_t *count)
{
	size_t channels = PATHS * (size_t)chain->count, room = 1;
	for (size_t i = 0; i < channels; i++)
		room += channel_at(chain, i)->count;
	double *times = malloc(room * sizeof *times);
	*count = 0;
	for (size_t i = 0; times && i < channels; i++) {
		const struct channel *c = channel_at(chain, i);
		if (c->count)
			memcpy(times + *count, c->times, c->count * sizeof *times);
		*count += c->count;
	}
	if (times)
		qsort(times, *count, sizeof *times, by_value);
	return times;
}

static enum eco_code add_poses(struct eco_track *track, const struct chain *chain, const struct track_input *in, struct eco_error *error)
{
	size_t count;
	double *times = key_times(chain, &count);
	enum eco_code code = times ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (times && !count)
		code = add_pose(track, chain, in, 0, error);
	uint32_t between = count > FRAMES_MAX / SAMPLES_PER_KEY ? 1 : SAMPLES_PER_KEY;
	for (size_t i = 0, end; !code && i < count; i = end) {
		for (end = i + 1; end < count && times[end] <= times[i]; )
			end++;
		double step_s = end < count ? (times[end] - times[i]) / between : 0;
		for (uint32_t k = 0; !code && k < (end < count ? between : 1); k++)
			code = add_pose(track, chain, in, times[i] + step_s * k, error);
	}
	free(times);
	return code;
}

static void free_chain(struct chain *chain)
{
	for (size_t i = 0; i < PATHS * (size_t)chain->count; i++) {
		free(channel_at(chain, i)->times);
		free(channel_at(chain, i)->values);
	}
	free(chain->links);
	eco_gltf_close(chain->doc);
}

static enum eco_code read_camera(struct eco_track *track, struct chain *chain, const struct track_input *in, struct eco_error *error)
{
	const json_t *animations = json_object_get(eco_gltf_json(chain->doc), "animations");
	uint32_t cameras, node = find_camera(chain->doc, in->options->node, &cameras), moving = 0;
	if (node == ECO_NONE)
		return eco_fail(error, ECO_NOT_FOUND, cameras ? "%.250s: no camera of its %u, nor its node, is called %.80s" : "%.250s: no node of it has a "
			"camera", in->path, cameras, in->options->node ? in->options->node : "");
	const json_t *json = eco_gltf_item(chain->doc, "nodes", node);
	const json_t *camera = eco_gltf_item(chain->doc, "cameras", eco_gltf_index(json, "camera"));
	chain->fov_y_deg = eco_gltf_number(json_object_get(camera, "perspective"), "yfov", NAN) * DEG;
	enum eco_code code = make_chain(chain, node, error);
	for (size_t i = 0; !code && i < json_array_size(animations); i++) {
		bool used = false;
		code = read_animation(chain, json_array_get(animations, i), &used, error);
		moving += used;
	}
	if (code)
		return code;
	if (cameras > 1 && !in->options->node)
		eco_track_note(track, "it has %u cameras; the one of node \"%.60s\" is taken (--node NAME for another)", cameras,
			eco_gltf_text(json, "name"));
	if (moving > 1)
		eco_track_note(track, "%u animations move this camera; the first of each kind is taken", moving);
	return add_poses(track, chain, in, error);
}

enum eco_code track_read_gltf(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct chain chain = { .links = malloc(DEPTH_MAX * sizeof *chain.links) };
	enum eco_code code = chain.links ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	track->posed = true;
	if (!code)
		code = eco_gltf_open_memory(&chain.doc, in->path, (const uint8_t *)in->text, in->size, error);
	if (!code)
		code = read_camera(track, &chain, in, error);
	free_chain(&chain);
	return code;
}
