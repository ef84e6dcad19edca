/* Degrees to metres: to the scene's CRS, or to a plane of the track's own (azimuthal equidistant about its median, so that a stray fix does
 * not bend it), which serves where a track was recorded elsewhere and will be moved. */
#include "ecofiles/import/places/proj_module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/import/track/track_read.h"

struct eco_track_path {
	PJ_CONTEXT *context;
	PJ *conversion;
};

static enum eco_code check_crs(struct eco_track_path *p, const char *text, const char *whose, bool metric, struct eco_error *error)
{
	PJ *crs = proj_create(p->context, text);
	bool known = crs && proj_is_crs(crs), good = known && (!metric || proj_is_metric_map(p->context, crs));
	proj_destroy(crs);
	if (!known)
		return eco_fail(error, ECO_BAD_INPUT, "%s CRS \"%.100s\" is not known; write a code such as \"EPSG:26917\"", whose, text);
	return good ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "%s CRS \"%.100s\" is not one in metres; take a projected one such as the UTM zone, "
		"\"EPSG:32617\"", whose, text);
}

static enum eco_code convert_between(struct eco_track_path *p, const char *from, const char *to, struct eco_error *error)
{
	PJ *raw = proj_create_crs_to_crs(p->context, from, to, NULL);
	p->conversion = raw ? proj_normalize_for_visualization(p->context, raw) : NULL;
	proj_destroy(raw);
	return p->conversion ? ECO_OK : eco_fail(error, ECO_BAD_INPUT, "no conversion from \"%.80s\" to \"%.80s\": %.100s", from, to,
		proj_context_errno_string(p->context, proj_context_errno(p->context)));
}

static enum eco_code own_plane(struct eco_track_path *p, const struct eco_track *track, struct eco_error *error)
{
	double center[2], *sorted = malloc(track->count * sizeof *sorted);
	char plane[200];
	if (!sorted)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	for (int axis = 0; axis < 2; axis++) {
		for (uint32_t i = 0; i < track->count; i++)
			sorted[i] = track->fixes[i].at[axis];
		qsort(sorted, track->count, sizeof *sorted, track_by_value);
		center[axis] = sorted[track->count / 2];
	}
	free(sorted);
	snprintf(plane, sizeof plane, "+proj=aeqd +lat_0=%.9f +lon_0=%.9f +datum=WGS84 +units=m +type=crs", center[1], center[0]);
	return convert_between(p, "EPSG:4326", plane, error);
}

static enum eco_code open_conversion(struct eco_track_path *p, const struct eco_track *track, const struct eco_track_frame *f,
	struct eco_error *error)
{
	bool local = track->degrees && (f->local || !f->crs);
	enum eco_code code = ECO_OK;
	p->context = proj_context_create();
	if (!p->context)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	proj_log_level(p->context, PJ_LOG_NONE);
	if (!local && f->crs)
		code = check_crs(p, f->crs, "the scene's", true, error);
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

enum eco_code proj_track_open(struct eco_track_path **path, const struct eco_track *track, const struct eco_track_frame *frame,
	struct eco_error *error)
{
	struct eco_track_path *p = calloc(1, sizeof *p);
	enum eco_code code = p ? open_conversion(p, track, frame, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (p && !p->conversion) {
		proj_track_close(p);
		p = NULL;
	}
	*path = p;
	return code;
}

bool proj_track_convert(struct eco_track_path *path, const double from[2], double to[2])
{
	PJ_COORD out = proj_trans(path->conversion, PJ_FWD, proj_coord(from[0], from[1], 0, 0));
	to[0] = out.xy.x;
	to[1] = out.xy.y;
	return isfinite(to[0]) && isfinite(to[1]);
}

void proj_track_close(struct eco_track_path *path)
{
	if (!path)
		return;
	proj_destroy(path->conversion);
	proj_context_destroy(path->context);
	free(path);
}
