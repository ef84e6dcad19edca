/* Fixes in metres of the frame, converted where they are not (proj_track.c), and the steps in which their numbers were written. */
#include <string.h>

#include "ecofiles/base/module.h"
#include "ecofiles/import/track/track_read.h"

#define DEG 57.29577951308232
#define METRES_PER_DEGREE 111195.0
#define NORTH_STEP_DEG 1e-4              /* to see where north is in a grid */

struct placing {
	const struct eco_track_frame *frame;
	const struct eco_proj_module *proj;
	struct eco_track_path *path;         /* NULL: fixes are in the frame's metres already */
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

static enum eco_code open_path(struct placing *p, const struct eco_track *track, struct eco_error *error)
{
	const struct eco_track_frame *f = p->frame;
	if (f->crs && !(track->degrees && f->local))
		memcpy(p->shift, f->origin, sizeof p->shift);
	if (!track->degrees && !f->crs && !f->track_crs)
		return ECO_OK;
	p->proj = eco_module(ECO_MODULE_PROJ, error);
	return p->proj ? p->proj->track_open(&p->path, track, f, error) : ECO_NOT_FOUND;
}

/* ---- Fixes ---- */

static bool convert(const struct placing *p, const double from[2], double to[2])
{
	bool known = p->proj->track_convert(p->path, from, to);
	for (int axis = 0; axis < 2; axis++)
		to[axis] -= p->shift[axis];
	return known && fabs(to[0]) < 1e9 && fabs(to[1]) < 1e9;
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
	enum eco_code code = open_path(&p, track, error);
	if (!code && p.path)
		code = convert_all(&p, track, error);
	for (uint32_t i = 0; !code && i < track->count; i++)
		track->fixes[i].at[2] -= p.shift[2];
	track->home[2] -= code ? 0 : p.shift[2];
	track->degrees &= code != ECO_OK;
	if (p.path)
		p.proj->track_close(p.path);
	return code;
}
