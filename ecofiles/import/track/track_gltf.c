/* Cameras of glTF 2.0: a node with a camera, still or moved by an animation of itself or of any node above
 * it, sampled evenly. glTF is Y up, cameras look along -z with y up. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/track/track_read.h"

#define DEPTH_MAX 256u
#define SAMPLES_PER_S 60.0
#define SAMPLES_MAX 100000.0

enum path { TRANSLATION, ROTATION, SCALE, PATHS };

struct channel {
	double *times, *values;
	uint64_t count;
	enum { LINEAR, STEP, CUBIC } kind;
};

struct link {                            /* a node on the way from the camera to the root */
	uint32_t node;
	struct channel channels[PATHS];
	double local[16], value[PATHS][4];   /* at rest */
};

struct chain {
	struct eco_gltf *doc;
	struct link *links; uint32_t count;  /* [0] is the camera's node */
	double fov_y_deg;
};

static const char *const path_names[PATHS] = { "translation", "rotation", "scale" };
static const uint32_t components[PATHS] = { 3, 4, 3 };

static struct channel *channel_at(const struct chain *chain, size_t i)
{
	return &chain->links[i / PATHS].channels[i % PATHS];
}
static size_t channels_of(const struct chain *chain) { return PATHS * (size_t)chain->count; }

/* ---- Which camera ---- */

static uint32_t parent_of(const struct eco_gltf *doc, uint32_t node)
{
	const json_t *nodes = json_object_get(eco_gltf_json(doc), "nodes");
	for (size_t i = 0; i < json_array_size(nodes); i++) {
		const json_t *children = json_object_get(json_array_get(nodes, i), "children");
		for (size_t k = 0; k < json_array_size(children); k++)
			if (json_is_number(json_array_get(children, k))
					&& json_number_value(json_array_get(children, k)) == node)
				return (uint32_t)i;
	}
	return ECO_NONE;
}

static enum eco_code make_chain(struct chain *chain, uint32_t node, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (; !code && node != ECO_NONE; node = parent_of(chain->doc, node)) {
		const json_t *json = eco_gltf_item(chain->doc, "nodes", node);
		if (chain->count == DEPTH_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "its camera lies below more than %u nodes, or "
				"below itself", DEPTH_MAX);
		struct link *link = &chain->links[chain->count++];
		*link = (struct link){ .node = node,
			.value = { { 0, 0, 0, 0 }, { 0, 0, 0, 1 }, { 1, 1, 1, 0 } } };
		code = eco_gltf_node_local(chain->doc, node, link->local, error);
		for (int path = 0; path < PATHS; path++)
			eco_gltf_numbers(json, path_names[path], link->value[path], components[path]);
	}
	return code;
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
		const char *own = eco_gltf_text(node, "name"),
			*its = eco_gltf_text(eco_gltf_item(doc, "cameras", camera), "name");
		*cameras += camera != ECO_NONE;
		if (camera != ECO_NONE && found == ECO_NONE
				&& (!wanted || strcmp(wanted, own) == 0 || strcmp(wanted, its) == 0))
			found = (uint32_t)i;
	}
	return found;
}

/* ---- Animations ---- */

static enum eco_code read_channel(struct chain *chain, size_t at, const json_t *sampler,
	struct eco_error *error)
{
	struct channel *c = channel_at(chain, at);
	const char *kind = eco_gltf_text(sampler, "interpolation");
	uint64_t values;
	if (c->times)                        /* of an animation before it */
		return ECO_OK;
	c->kind = strcmp(kind, "STEP") == 0 ? STEP : strcmp(kind, "CUBICSPLINE") == 0 ? CUBIC : LINEAR;
	enum eco_code code = eco_gltf_read_floats(chain->doc, eco_gltf_index(sampler, "input"), 1, &c->times,
		&c->count, error);
	if (!code)
		code = eco_gltf_read_floats(chain->doc, eco_gltf_index(sampler, "output"),
			components[at % PATHS], &c->values, &values, error);
	bool good = !code && c->count && values == c->count * (c->kind == CUBIC ? 3 : 1);
	for (uint64_t i = 0; good && i < c->count; i++)
		good = isfinite(c->times[i]) && (!i || c->times[i] >= c->times[i - 1]);
	return code || good ? code : eco_fail(error, ECO_DAMAGED, "an animation of node %u has %llu times "
		"for %llu values, or times that do not ascend", chain->links[at / PATHS].node,
		(unsigned long long)c->count, (unsigned long long)values);
}

/* The channels of this animation that move the camera. */
static enum eco_code read_animation(struct chain *chain, const json_t *animation, struct eco_error *error)
{
	const json_t *channels = json_object_get(animation, "channels"),
		*samplers = json_object_get(animation, "samplers");
	enum eco_code code = ECO_OK;
	for (size_t i = 0; !code && i < json_array_size(channels); i++) {
		const json_t *target = json_object_get(json_array_get(channels, i), "target");
		uint32_t node = eco_gltf_index(target, "node"),
			sampler = eco_gltf_index(json_array_get(channels, i), "sampler");
		for (size_t k = 0; !code && sampler != ECO_NONE && k < channels_of(chain); k++) {
			if (chain->links[k / PATHS].node != node
					|| strcmp(eco_gltf_text(target, "path"), path_names[k % PATHS]) != 0)
				continue;
			code = read_channel(chain, k, json_array_get(samplers, sampler), error);
		}
	}
	return code;
}

/* Quaternions along the shorter great circle. */
static void blend(const double *a, const double *b, double s, bool rotation, double *out)
{
	double dot = rotation ? a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] : 1,
		sign = dot < 0 ? -1 : 1, wa = 1 - s, wb = s;
	if (dot * sign < 0.9999) {
		double angle = acos(dot * sign), sine = sin(angle);
		wa = sin((1 - s) * angle) / sine;
		wb = sin(s * angle) / sine;
	}
	for (uint32_t i = 0; i < (rotation ? 4 : 3); i++)
		out[i] = wa * a[i] + sign * wb * b[i];
}

static void sample(const struct channel *c, enum path path, double time_s, double *out)
{
	uint64_t n = components[path], low = 0, high = c->count ? c->count - 1 : 0,
		step = n * (c->kind == CUBIC ? 3 : 1), first = c->kind == CUBIC ? n : 0;
	if (!c->count)
		return;
	while (high - low > 1) {
		uint64_t middle = low + (high - low) / 2;
		*(c->times[middle] <= time_s ? &low : &high) = middle;
	}
	const double *a = c->values + low * step + first, *b = c->values + high * step + first;
	double h = c->times[high] - c->times[low], s = h > 0 ? fmin(fmax((time_s - c->times[low]) / h, 0), 1)
		: 0, r = 1 - s;
	if (c->kind == STEP || s == 0 || s == 1)
		memcpy(out, s == 1 ? b : a, n * sizeof *out);
	else if (c->kind == LINEAR)
		blend(a, b, s, path == ROTATION, out);
	/* appendix C of the specification: in-tangent, value, out-tangent */
	else
		for (uint64_t i = 0; i < n; i++)
			out[i] = r * r * (1 + 2 * s) * a[i] + s * r * r * a[n + i] * h
				+ s * s * (3 - 2 * s) * b[i] - s * s * r * (b - n)[i] * h;
}

/* ---- Poses ---- */

/* Where the camera is, to Z up, and its yaw, pitch and roll, from its matrix; a matrix without directions
 * leaves no position. */
static void set_pose(struct eco_fix *fix, const double m[16])
{
	double back = sqrt(m[8] * m[8] + m[9] * m[9] + m[10] * m[10]),
		top = sqrt(m[4] * m[4] + m[5] * m[5] + m[6] * m[6]);
	double look[3] = { -m[8] / back, m[10] / back, -m[9] / back },
		up[3] = { m[4] / top, -m[6] / top, m[5] / top };
	double flat = hypot(look[0], look[1]), sign = look[2] < 0 ? 1 : -1;
	if (!(back > 3e-5 && back < 3e4 && top > 3e-5 && top < 3e4))
		return;
	fix->at[0] = m[12];
	fix->at[1] = -m[14];
	fix->at[2] = m[13];
	fix->pitch_deg = atan2(look[2], flat) * TRACK_DEG;
	/* straight down or up, yaw is where the picture's upper edge points */
	fix->yaw_deg = (flat < 1e-6 ? atan2(sign * up[0], sign * up[1]) : atan2(look[0], look[1]))
		* TRACK_DEG;
	/* up along the horizontal right, and upright to it and the look */
	double sine = (up[0] * look[1] - up[1] * look[0]) / flat;
	fix->roll_deg = flat < 1e-6 ? 0
		: atan2(sine, up[2] * flat - look[2] * (up[0] * look[0] + up[1] * look[1]) / flat)
		* TRACK_DEG;
}

static enum eco_code add_pose(struct eco_track *track, const struct chain *chain, double time_s,
	struct eco_error *error)
{
	double m[16];
	struct eco_fix fix = track_fix(track->count + 1);
	for (uint32_t k = 0; k < chain->count; k++) {
		struct link link = chain->links[k];
		bool moved = false;
		for (int path = 0; path < PATHS; path++) {
			sample(&link.channels[path], (enum path)path, time_s, link.value[path]);
			moved |= link.channels[path].count > 0;
		}
		if (moved)
			eco_gltf_compose(link.local, link.value[TRANSLATION], link.value[ROTATION],
				link.value[SCALE]);
		if (k)
			eco_gltf_multiply(m, link.local, m);
		else
			memcpy(m, link.local, sizeof m);
	}
	set_pose(&fix, m);
	fix.time_s = time_s;
	fix.fov_y_deg = chain->fov_y_deg;
	return track_add(track, &fix, error);
}

/* From the first key to the last. */
static enum eco_code add_poses(struct eco_track *track, const struct chain *chain, struct eco_error *error)
{
	double from_s = INFINITY, to_s = -INFINITY;
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < channels_of(chain); i++) {
		const struct channel *c = channel_at(chain, i);
		from_s = c->count ? fmin(from_s, c->times[0]) : from_s;
		to_s = c->count ? fmax(to_s, c->times[c->count - 1]) : to_s;
	}
	if (!(from_s < to_s))
		return add_pose(track, chain, isfinite(from_s) ? from_s : 0, error);
	double steps = fmin(fmax(ceil((to_s - from_s) * SAMPLES_PER_S - 1e-6), 8), SAMPLES_MAX);
	for (uint32_t i = 0; !code && i <= steps; i++)
		code = add_pose(track, chain, i < steps ? from_s + (to_s - from_s) * (i / steps) : to_s,
			error);
	return code;
}

static enum eco_code read_camera(struct eco_track *track, struct chain *chain, const struct track_input *in,
	struct eco_error *error)
{
	const json_t *animations = json_object_get(eco_gltf_json(chain->doc), "animations");
	uint32_t cameras, node = find_camera(chain->doc, in->node, &cameras);
	if (node == ECO_NONE)
		return eco_fail(error, ECO_NOT_FOUND, cameras ? "%.250s: no camera of its %u, nor its node, "
			"is called %.80s" : "%.250s: no node of it has a "
			"camera", in->path, cameras, in->node ? in->node : "");
	const json_t *json = eco_gltf_item(chain->doc, "nodes", node),
		*camera = eco_gltf_item(chain->doc, "cameras", eco_gltf_index(json, "camera"));
	chain->fov_y_deg = eco_gltf_number(json_object_get(camera, "perspective"), "yfov", NAN) * TRACK_DEG;
	enum eco_code code = make_chain(chain, node, error);
	for (size_t i = 0; !code && i < json_array_size(animations); i++)
		code = read_animation(chain, json_array_get(animations, i), error);
	if (!code && cameras > 1 && !in->node)
		eco_track_note(track, "it has %u cameras; the one of node \"%.60s\" is taken (--node NAME "
			"for another)", cameras, eco_gltf_text(json, "name"));
	return code ? code : add_poses(track, chain, error);
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
	for (size_t i = 0; i < channels_of(&chain); i++) {
		free(channel_at(&chain, i)->times);
		free(channel_at(&chain, i)->values);
	}
	free(chain.links);
	eco_gltf_close(chain.doc);
	return code;
}
