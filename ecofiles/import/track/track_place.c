/* Fixes in metres of the frame, with the heights that are asked for. Degrees go to the scene's CRS, or to a
 * plane of the track's own (azimuthal equidistant about its middle), where it will be moved. */
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/places/positions_crs.h"
#include "ecofiles/import/track/track_read.h"

#define METRES_PER_DEGREE 111195.0
#define NORTH_STEP_DEG 1e-3              /* to see where north is in a grid */

/* The least difference of neighbours is the step of rounding; a degree of longitude is shorter. */
static void find_step(struct eco_track *track)
{
	const struct eco_fix *f = track->fixes;
	double least = track->degrees ? 1e-9 : 1e-6, step[2] = { INFINITY, INFINITY };
	for (uint32_t i = 1; i < track->count; i++)
		for (int k = 0; k < 2; k++) {
			double d = fabs(f[i].at[k] - f[i - 1].at[k]);
			step[k] = d > least ? fmin(d, step[k]) : step[k];
		}
	double finer = fmin(step[0] * (track->degrees ? cos(f[0].at[1] / TRACK_DEG) : 1), step[1]);
	track->still_m = isfinite(finer) ? finer * (track->degrees ? METRES_PER_DEGREE : 1) : 0;
}

static bool convert(struct eco_crs *crs, double at[2])
{
	double xyz[3] = { at[0], at[1], 0 };
	const char *why;
	bool known;
	if (eco_crs_convert(crs, xyz, &known, &why, NULL) || !known)
		return false;
	memcpy(at, xyz, 2 * sizeof *at);
	return fabs(at[0]) < 1e9 && fabs(at[1]) < 1e9;
}

/* The bearing of true north in the grid is added to bearings. */
static bool convert_fix(struct eco_crs *crs, struct eco_fix *fix, bool degrees)
{
	double north[2] = { fix->at[0], fix->at[1] + NORTH_STEP_DEG };
	if (!convert(crs, fix->at))
		return false;
	if (degrees && !isnan(fix->yaw_deg) && convert(crs, north))
		fix->yaw_deg += TRACK_DEG * atan2(north[0] - fix->at[0], north[1] - fix->at[1]);
	return true;
}

static enum eco_code convert_all(struct eco_crs *crs, struct eco_track *track, const char *name,
	struct eco_error *error)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		track->fixes[kept] = track->fixes[i];
		kept += convert_fix(crs, &track->fixes[kept], track->degrees);
	}
	if (kept < track->count)
		eco_track_note(track, "%u fixes lie where the scene's CRS is not good and are left out",
			track->count - kept);
	track->count = kept;
	return kept ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "no fix lies where the CRS \"%.100s\" is good; "
		"--to 0,0,50 moves the track to the scene", name);
}

/* at[2] becomes the height that is asked for. */
static enum eco_code choose_heights(struct eco_track *track, int wanted, struct eco_error *error)
{
	struct eco_fix *f = track->fixes;
	uint32_t absolute = 0, relative = 0;
	double first = 0;
	for (uint32_t i = track->count; i-- > 0; ) {
		absolute += !isnan(f[i].at[2]);
		relative += !isnan(f[i].above_m);
		first = isnan(f[i].at[2]) ? first : f[i].at[2];
	}
	bool above = wanted != ECO_HEIGHTS_ABSOLUTE && relative
		&& (relative >= track->count / 2 || !absolute);
	if (wanted && !above && !absolute)
		return eco_fail(error, ECO_BAD_INPUT, "--height: the track has no heights of this kind%s",
			relative ? ", only above take-off" : "");
	track->has_height = above || absolute;
	track->height = above || wanted == ECO_HEIGHTS_RELATIVE ? ECO_HEIGHTS_RELATIVE : ECO_HEIGHTS_ABSOLUTE;
	/* take-off is where it begins */
	double zero = wanted == ECO_HEIGHTS_RELATIVE ? first : 0;
	for (uint32_t i = 0; i < track->count; i++)
		f[i].at[2] = above ? f[i].above_m : f[i].at[2] - zero;
	uint32_t known = above ? relative : absolute;
	if (track->has_height && known < track->count)
		eco_track_note(track, "%u fixes have no height: interpolated", track->count - known);
	return ECO_OK;
}

enum eco_code eco_track_place(struct eco_track *track, const struct eco_track_options *options,
	struct eco_error *error)
{
	char plane[200];
	bool own = track->degrees && (options->to_given || !options->crs);
	track->local = own && !options->to_given;
	struct eco_frame to = { .crs = own ? plane : options->crs };
	struct eco_crs_request request = { .path = "the track", .frame = &to, .note = eco_track_note,
		.ctx = track, .stated = track->degrees ? "EPSG:4326" : options->track_crs };
	struct eco_crs *crs = NULL;
	if (!track->degrees && options->track_crs && !options->crs)
		return eco_fail(error, ECO_BAD_INPUT, "--track-crs says that the track is in %.80s, but no "
			"CRS of the scene is known: add --scene SCENE.json, or --crs and --origin",
			options->track_crs);
	find_step(track);
	if (options->crs && !own)
		memcpy(to.origin, options->origin, sizeof to.origin);
	const double *middle = track->fixes[track->count / 2].at;
	snprintf(plane, sizeof plane, "+proj=aeqd +lat_0=%.9f +lon_0=%.9f +datum=WGS84 +units=m +type=crs",
		middle[1], middle[0]);
	enum eco_code code = request.stated ? eco_crs_open(&crs, &request, error) : ECO_OK;
	if (crs)
		code = convert_all(crs, track, to.crs, error);
	eco_crs_close(crs);
	for (uint32_t i = 0; !code && i < track->count; i++)
		track->fixes[i].at[2] -= to.origin[2];
	track->degrees &= code != ECO_OK;
	return code ? code : choose_heights(track, options->height, error);
}
