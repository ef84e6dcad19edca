/* Degrees to metres through PROJ: to the scene's CRS, or to a plane of the track's own (azimuthal equidistant about its median, so that a
 * stray fix does not bend it), which serves where a track was recorded elsewhere and will be moved. */
#include <proj.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/track_read.h"

#define DEG 57.29577951308232
#define METRES_PER_DEGREE 111195.0
#define NORTH_STEP_DEG 1e-4              /* to see where north is in a grid */

struct placing {
	const struct eco_track_frame *frame;
	PJ_CONTEXT *context;
	PJ *conversion;
	double shift[3];
};

/* ---- The steps in which numbers were written ---- */

static double least_step(const struct eco_track *track, int axis, double least)
{
	double step = INFINITY;
	for (uint32_t i = 1; i < track->count; i++) {
		double d = fabs(track->fixes[i].at[axis] - track->fixes[i - 1].at[axis]);
		if (d > least && d < step)
			step = d;
	}
	return isfinite(step) ? step : 0;
}

static double least_height_step(const struct eco_track *track)
{
	double step = INFINITY;
	for (uint32_t i = 1; i < track->count; i++) {
		const struct eco_fix *a = &track->fixes[i - 1], *b = &track->fixes[i];
		double d = isnan(a->above_m) || isnan(b->above_m) ? fabs(b->at[2] - a->at[2]) : fabs(b->above_m - a->above_m);
		if (d > 1e-6 && d < step)
			step = d;
	}
	return isfinite(step) ? step : 0;
}

static void find_steps(struct eco_track *track)
{
	double least = track->degrees ? 1e-9 : 1e-6, x = least_step(track, 0, least), y = least_step(track, 1, least);
	double scale = track->degrees ? METRES_PER_DEGREE : 1;
	/* a degree of longitude is shorter; the larger of two steps says how rough the recording is, unless it does not move that way */
	double narrow = track->degrees ? cos(track->fixes[0].at[1] / DEG) : 1;
	track->still_m = x > 0 && y > 0 ? fmin(x * narrow, y) * scale : fmax(x * narrow, y) * scale;
	track->still_z_m = least_height_step(track);
}

/* ---- CRS ---- */

static bool is_metric(PJ_CONTEXT *context, const PJ *crs)
{
	double unit = 0;
	PJ *flat = proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS ? proj_crs_get_sub_crs(context, crs, 0) : proj_clone(context, crs), *axes = NULL;
	if (flat && proj_get_type(flat) == PJ_TYPE_BOUND_CRS) {
		PJ *source = proj_get_source_crs(context, flat);
		proj_destroy(flat);
		flat = source;
	}
	if (flat && proj_get_type(flat) == PJ_TYPE_PROJECTED_CRS)
		axes = proj_crs_get_coordinate_system(context, flat);
	bool metric = axes && proj_cs_get_axis_info(context, axes, 0, NULL, NULL, NULL, &unit, NULL, NULL, NULL) && fabs(unit - 1) < 1e-9;
	proj_destroy(axes);
	proj_destroy(flat);
	return metric;
}

static enum eco_code check_crs(struct placing *p, const char *text, const char *whose, bool metric, struct eco_error *error)
{
	PJ *crs = proj_create(p->context, text);
	bool known = crs && proj_is_crs(crs), good = known && (!metric || is_metric(p->context, crs));
	proj_destroy(crs);
	if (!known)
		return eco_fail(error, ECO_BAD_INPUT, "%s CRS \"%.100s\" is not known; write a code such as \"EPSG:26917\"", whose, text);
	return good ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "%s CRS \"%.100s\" is not one in metres; take a projected one such as the UTM zone, "
		"\"EPSG:32617\"", whose, text);
}

static enum eco_code convert_between(struct placing *p, const char *from, const char *to, struct eco_error *error)
{
	PJ *raw = proj_create_crs_to_crs(p->context, from, to, NULL);
	p->conversion = raw ? proj_normalize_for_visualization(p->context, raw) : NULL;
	proj_destroy(raw);
	return p->conversion ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "no conversion from \"%.80s\" to \"%.80s\": %.100s", from, to,
		proj_context_errno_string(p->context, proj_context_errno(p->context)));
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static enum eco_code own_plane(struct placing *p, const struct eco_track *track, struct eco_error *error)
{
	double center[2], *sorted = malloc(track->count * sizeof *sorted);
	char plane[200];
	if (!sorted)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	for (int axis = 0; axis < 2; axis++) {
		for (uint32_t i = 0; i < track->count; i++)
			sorted[i] = track->fixes[i].at[axis];
		qsort(sorted, track->count, sizeof *sorted, by_value);
		center[axis] = sorted[track->count / 2];
	}
	free(sorted);
	snprintf(plane, sizeof plane, "+proj=aeqd +lat_0=%.9f +lon_0=%.9f +datum=WGS84 +units=m +type=crs", center[1], center[0]);
	return convert_between(p, "EPSG:4326", plane, error);
}

static enum eco_code open_conversion(struct placing *p, const struct eco_track *track, struct eco_error *error)
{
	const struct eco_track_frame *f = p->frame;
	bool local = track->degrees && (f->local || !f->crs);
	enum eco_code code = ECO_OK;
	p->context = proj_context_create();
	if (!p->context)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	proj_log_level(p->context, PJ_LOG_NONE);
	if (!local && f->crs) {
		code = check_crs(p, f->crs, "the scene's", true, error);
		memcpy(p->shift, f->origin, sizeof p->shift);
	}
	if (!code && !track->degrees && f->track_crs) {
		code = check_crs(p, f->track_crs, "the track's", false, error);
		if (!code && !f->crs)
			code = eco_fail(error, ECO_BAD_INPUT, "--track-crs says that the track is in %.80s, but no CRS of the scene is known: add --scene "
				"SCENE.json, or --crs and --origin", f->track_crs);
		return code ? code : convert_between(p, f->track_crs, f->crs, error);
	}
	if (code || !track->degrees)
		return code;
	return local ? own_plane(p, track, error) : convert_between(p, "EPSG:4326", f->crs, error);
}

/* ---- Fixes ---- */

static bool convert(const struct placing *p, const double from[2], double to[2])
{
	PJ_COORD out = proj_trans(p->conversion, PJ_FWD, proj_coord(from[0], from[1], 0, 0));
	to[0] = out.xy.x - p->shift[0];
	to[1] = out.xy.y - p->shift[1];
	return isfinite(to[0]) && isfinite(to[1]) && fabs(to[0]) < 1e9 && fabs(to[1]) < 1e9;
}

/* The bearing of true north in the grid, added to bearings. */
static void turn_to_grid(const struct placing *p, const double degrees[2], struct eco_fix *fix)
{
	double side = degrees[1] > 89 ? -1 : 1, north[2];
	if (isnan(fix->yaw_deg) || !convert(p, (double[2]){ degrees[0], degrees[1] + side * NORTH_STEP_DEG }, north))
		return;
	fix->yaw_deg += atan2(side * (north[0] - fix->at[0]), side * (north[1] - fix->at[1])) * DEG;
}

static enum eco_code convert_all(const struct placing *p, struct eco_track *track, struct eco_error *error)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		struct eco_fix fix = track->fixes[i];
		const double from[2] = { fix.at[0], fix.at[1] };
		if (!convert(p, from, fix.at))
			continue;
		if (track->degrees)
			turn_to_grid(p, from, &fix);
		track->fixes[kept++] = fix;
	}
	if (!kept)
		return eco_fail(error, ECO_BAD_INPUT, "no fix lies where the CRS \"%.100s\" is good; --to 0,0,50 moves the track to the scene",
			p->frame->crs ? p->frame->crs : "");
	if (kept < track->count)
		eco_track_note(track, "%u fixes lie where the scene's CRS is not good and are left out", track->count - kept);
	track->count = kept;
	double home[2];
	track->has_home = track->has_home && convert(p, track->home, home);
	if (track->has_home)
		memcpy(track->home, home, sizeof home);
	return ECO_OK;
}

enum eco_code eco_track_place(struct eco_track *track, const struct eco_track_frame *frame, struct eco_error *error)
{
	struct placing p = { .frame = frame };
	if (!track->count)
		return eco_fail(error, ECO_BAD_INPUT, "the track has no fixes");
	find_steps(track);
	enum eco_code code = open_conversion(&p, track, error);
	if (!code && p.conversion)
		code = convert_all(&p, track, error);
	for (uint32_t i = 0; !code && i < track->count; i++)
		track->fixes[i].at[2] -= p.shift[2];
	track->home[2] -= code ? 0 : p.shift[2];
	track->degrees &= code != ECO_OK;
	proj_destroy(p.conversion);
	proj_context_destroy(p.context);
	return code;
}
