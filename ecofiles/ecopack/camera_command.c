/* ecopack camera: a recorded track becomes a camera script, and what was done to it is said. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/scene/scene.h"
#include "ecofiles/import/track/track.h"
#include "ecofiles/format/view.h"

#define CLEARANCE_M 1.7
#define FAR_M 1e5

struct camera_options {          /* NaN, 0 or NULL where not given; see the help below */
	const char *input, *output, *scene, *crs, *track_crs;
	struct eco_track_options read;
	double origin[3], to[3], centre[3], look_at[3];
	bool origin_given, to_given, centre_given, look_at_given;
	double turn_deg, scale, clearance_m, pace, pause, from_s, to_s, smooth_s, pitch_deg, fov_y_deg, fps, speed;
	uint64_t part, keys;
	enum eco_track_height height;
};

/* ---- The scene ---- */

struct place {                           /* what is known of where the track goes */
	const char *crs;
	double origin[3];
	bool has_scene;
	struct eco_ground ground; bool has_raster;
	struct eco_sources sources;
};

static enum eco_code open_scene(struct place *place, const struct camera_options *o, struct eco_error *error)
{
	place->crs = o->crs;
	memcpy(place->origin, o->origin, sizeof place->origin);
	if (o->crs && !o->origin_given)
		return eco_fail(error, ECO_BAD_USAGE, "--crs needs --origin X,Y,Z, the point that is 0, 0, 0 in the scene");
	if (!o->scene)
		return ECO_OK;
	if (o->crs)
		return eco_fail(error, ECO_BAD_USAGE, "--scene and --crs say the same thing; take one of them");
	enum eco_code code = eco_sources_load(&place->sources, o->scene, error);
	if (code)
		return code;
	const struct eco_source *scene = &place->sources.items[0];
	place->has_scene = true;
	place->crs = scene->crs;
	memcpy(place->origin, scene->origin, sizeof place->origin);
	if (!scene->ground.height_count)
		return ECO_OK;
	struct eco_ground_options ground = { .source = &scene->ground, .scene_crs = scene->crs, .scene_vertical = scene->vertical,
		.warn = main_note_text };
	memcpy(ground.origin, scene->origin, sizeof ground.origin);
	code = eco_ground_import(&place->ground, &ground, error);
	place->has_raster = !code;
	return code;
}

static double ground_height(const struct place *place, double x, double y)
{
	double z = 0;
	if (place->has_raster)
		eco_ground_height(&place->ground, x, y, &z);
	return z;
}

/* ---- What is said ---- */

static void say_repairs(const struct eco_track_report *r)
{
	const struct { uint64_t count; const char *says; } lines[] = {
		{ r->stamps_bogus, "times are years from the others and are interpolated" },
		{ r->stamps_backward, "times run back and are interpolated" },
		{ r->sorted, "times run back: the file is not sorted by time, now it is" },
		{ r->clock_resets, "times the clock was set back: it goes on from there" },
		{ r->stamps_equal, "fixes have the time of the one before: spread evenly" },
		{ r->untimed ? 0 : r->stamps_missing, "fixes have no time: interpolated by distance" },
		{ r->heights_missing, "fixes have no height: interpolated" },
		{ r->jumped, "positions are jumps, farther than the track can have moved: left out" },
		{ r->glides, "leaps, short ones, are glided over at the track's own speed, which takes longer than recorded" },
		{ r->pauses, "stands are shortened (--pause S)" },
	};
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		if (lines[i].count)
			main_note("%" PRIu64 " %s", lines[i].count, lines[i].says);
	if (r->reversed)
		main_note("the file runs backward in time: it was turned");
	if (r->jumped || r->parts > 1 || r->glides)
		main_note("the farthest jump is %.0f m; steps of more than %.3g m/s were looked at", r->jump_m, r->jump_m_s);
	if (r->repeated > r->fixes / 5 && r->update_s > 0)
		main_note("positions are repeated: they change every %.3g s; motion is even between them", r->update_s);
}

static void say_read(const struct eco_track *track, const char *path)
{
	main_note("%s: read as %s", path, eco_track_kinds[track->format].says);
	for (uint32_t i = 0; i < track->note_count; i++)
		main_note("%s", track->notes[i]);
	for (int i = 0; i < ECO_TRACK_SKIPS; i++)
		if (track->skipped[i])
			main_note("%" PRIu64 " records left out: %s (first: number or line %u)", track->skipped[i], eco_track_skip_names[i],
				track->skipped_line[i]);
}

/* What the flight took for what was not recorded. `moved`: the user says where it goes. */
static void say_guesses(const struct camera_options *o, const struct eco_flight *f, const struct eco_track *track, const struct eco_track_report *r,
	const struct place *place, bool moved)
{
	if (f->smooth_s > 0 && isnan(o->smooth_s))
		main_note("smoothed with %.2g s (--smooth S; 0: not at all), which moves no position by more than %.2f m", f->smooth_s, f->moved_m);
	if (!f->yaw_recorded && !o->look_at_given)
		main_note("no directions were recorded: the camera looks where it goes, %g degrees above level (--pitch DEG, or --look-at X,Y,Z)",
			f->pitch_deg);
	else if (!f->pitch_recorded && isnan(o->pitch_deg) && !o->look_at_given)
		main_note("only its yaw was recorded: %g degrees of pitch are taken (--pitch DEG)", f->pitch_deg);
	if (r->untimed && track->count > 1)
		main_note("no times were recorded: %g m a second are taken (--pace)", o->pace > 0 ? o->pace : 10.0);
	if (!r->has_height)
		main_note("no heights were recorded: the camera is %g m above the ground (--clearance)", o->clearance_m);
	else if (r->height == ECO_HEIGHTS_ABSOLUTE && place->crs && !moved)
		main_note("heights are taken as metres above the zero of the scene's heights; another datum is not converted (--height rel|ground)");
	else if (r->height == ECO_HEIGHTS_RELATIVE && !moved)
		main_note("heights are above take-off%s (--height abs|ground)", place->has_raster ? ", which is on the scene's ground" : ", which is z = 0");
}

static void print_summary(const struct camera_options *o, const struct eco_track *track, const struct eco_track_report *r,
	const struct eco_flight *f, const struct eco_script *s)
{
	double length_s = (f->count - 1) * f->step_s, low[3], high[3], fastest = 0;
	uint64_t skipped = track->skipped[ECO_TRACK_NO_POSITION] + track->skipped[ECO_TRACK_BAD_NUMBER];
	eco_flight_box(f, low, high);
	for (uint32_t i = 1; i < f->count; i++)
		fastest = fmax(fastest, eco_distance(f->samples[i].eye, f->samples[i - 1].eye) / f->step_s);
	printf("%s: %" PRIu64 " records, %" PRIu64 " positions kept", o->input, track->records, r->kept);
	if (r->repeated)
		printf(", %" PRIu64 " repeated", r->repeated);
	if (r->jumped)
		printf(", %" PRIu64 " jumps", r->jumped);
	if (r->other_parts)
		printf(", %" PRIu64 " in other parts", r->other_parts);
	if (skipped)
		printf(", %" PRIu64 " without a usable one", skipped);
	printf("\n  %.1f s, %.1f m long, %.2f m/s on average, at most %.2f\n  x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f\n", length_s,
		f->length_m, length_s > 0 ? f->length_m / length_s : 0, fastest, low[0], high[0], low[1], high[1], low[2], high[2]);
	printf("%s: %u keyframe%s, %u frame%s at %g a second, within %.3f m and %.2f degrees of the track\n", o->output, s->count,
		s->count == 1 ? "" : "s", s->frames, s->frames == 1 ? "" : "s", s->fps, s->error_m, s->error_deg);
}

/* ---- Output: appears complete or not at all, and replaces nothing but a camera script ---- */

static enum eco_code may_write(const char *path, struct eco_error *error)
{
	struct stat status;
	struct eco_camera *camera;
	if (stat(path, &status) != 0)
		return errno == ENOENT ? ECO_OK : eco_fail(error, ECO_IO, "%.300s: %s", path, strerror(errno));
	if (S_ISREG(status.st_mode) && (status.st_size == 0 || eco_camera_load(&camera, path, NULL) == ECO_OK)) {
		if (status.st_size)
			eco_camera_free(camera);
		return ECO_OK;
	}
	return eco_fail(error, ECO_BAD_USAGE, "%.300s is there and is no camera script; it is kept. Take another name", path);
}

static enum eco_code write_output(const char *path, const char *text, size_t size, struct eco_error *error)
{
	char beside[4096];
	if (snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof beside)
		return eco_fail(error, ECO_BAD_USAGE, "%.300s: the path is too long", path);
	FILE *file = fopen(beside, "wb");
	if (!file)
		return eco_fail(error, ECO_IO, "%.300s: %s", path, strerror(errno));
	bool good = fwrite(text, 1, size, file) == size;
	good = fclose(file) == 0 && good;
	if (good && rename(beside, path) == 0)
		return ECO_OK;
	eco_fail(error, ECO_IO, "%.300s: %s", path, strerror(errno));
	unlink(beside);
	return ECO_IO;
}

static enum eco_code copy_script(const struct camera_options *o, struct eco_error *error)
{
	struct stat status;
	FILE *file = fopen(o->input, "rb");
	char *text = file && fstat(fileno(file), &status) == 0 ? malloc((size_t)status.st_size + 1) : NULL;
	size_t size = text ? fread(text, 1, (size_t)status.st_size, file) : 0;
	struct eco_camera *camera = NULL;
	enum eco_code code = text ? eco_camera_parse(&camera, text, size, o->input, error) : eco_fail(error, ECO_IO, "%.300s: %s", o->input,
		strerror(errno));
	if (!code)
		code = write_output(o->output, text, size, error);
	if (!code)
		main_note("%s is a camera script already: it was checked and copied; nothing else was done to it", o->input);
	if (!code && !main_is_quiet)
		printf("%s: %u frames\n", o->output, eco_camera_frame_count(camera));
	eco_camera_free(camera);
	free(text);
	if (file)
		fclose(file);
	return code;
}

/* ---- From the track to the script ---- */

static enum eco_code make_flight(struct eco_flight *flight, struct eco_track *track, const struct camera_options *o, struct place *place,
	struct eco_track_report *report, struct eco_error *error)
{
	struct eco_track_frame frame = { .crs = place->crs, .track_crs = o->track_crs, .local = o->to_given || o->centre_given };
	struct eco_cleaning cleaning = { .height = o->height, .part = (uint32_t)o->part, .pace_m_s = o->pace, .pause_s = o->pause };
	struct eco_smoothing smoothing = { .smooth_s = o->smooth_s, .pitch_deg = o->pitch_deg, .pitch_given_wins = !isnan(o->pitch_deg),
		.fov_y_deg = o->fov_y_deg, .flies = track->format == ECO_TRACK_SRT };
	memcpy(frame.origin, place->origin, sizeof frame.origin);
	enum eco_code code = eco_track_place(track, &frame, error);
	uint32_t notes = track->note_count;
	if (!code)
		code = eco_track_clean(track, &cleaning, report, error);
	for (uint32_t i = notes; i < track->note_count; i++)
		main_note("%s", track->notes[i]);
	return code ? code : eco_flight_make(flight, track, &smoothing, error);
}

static void lift(struct eco_flight *flight, double by_m)
{
	for (uint32_t i = 0; i < flight->count; i++)
		flight->samples[i].eye[2] += by_m;
}

static enum eco_code move_flight(struct eco_flight *flight, const struct eco_track *track, bool degrees, const struct camera_options *o,
	const struct place *place, const struct eco_track_report *r, struct eco_error *error)
{
	bool user = o->to_given || o->centre_given, local = degrees && !place->crs && !user;
	struct eco_flight_move move = { .from_s = o->from_s, .to_s = o->to_s, .speed = o->speed, .scale = o->scale, .turn_deg = o->turn_deg,
		.to_given = user || local, .centre = o->centre_given, .clearance_m = o->clearance_m, .has_ground = place->has_scene,
		.ground = place->has_raster ? &place->ground : NULL, .look_at_given = o->look_at_given,
		.from_ground = r->height == ECO_HEIGHTS_GROUND || (!r->has_height && place->has_scene) };
	struct eco_flight_moved moved;
	memcpy(move.look_at, o->look_at, sizeof move.look_at);
	memcpy(move.to, o->centre_given ? o->centre : o->to, sizeof move.to);
	if (local) {
		move.to[0] = move.to[1] = 0;
		move.to[2] = r->height == ECO_HEIGHTS_ABSOLUTE ? 0 : NAN;
		main_note("the first fix is the origin of the script's metres, x east, y north: nothing says where the scene is (--scene SCENE.json, or "
			"--crs and --origin, or --to X,Y,Z)");
	}
	/* heights above take-off start from the ground there */
	const double *from = track->has_home ? track->home : flight->samples[0].eye;
	if (!user && !local && r->height == ECO_HEIGHTS_RELATIVE)
		lift(flight, ground_height(place, from[0], from[1]));
	enum eco_code code = eco_flight_move(flight, &move, &moved, error);
	if (code)
		return code;
	double low[3], high[3], far_m = INFINITY;
	eco_flight_box(flight, low, high);
	/* without a scene nothing says where the ground is: z = 0, and the whole track stays above */
	if (!place->has_scene && local && o->clearance_m > low[2]) {
		lift(flight, o->clearance_m - low[2]);
		main_note("without --scene the ground is z = 0: the track is raised as a whole by %.1f m, so that its lowest eye is %g m above "
			"(--clearance)", o->clearance_m - low[2], o->clearance_m);
	}
	if (moved.raised)
		main_note("%.1f %% of the way is less than %g m above the ground, up to %.1f m below that: raised (--clearance M)",
			100.0 * moved.raised / flight->count, o->clearance_m, moved.raised_m);
	if (moved.off_ground)
		main_note("%.0f %% of the way is beyond the border of the scene's ground", 100.0 * moved.off_ground / flight->count);
	for (uint32_t i = 0; i < flight->count; i++)
		far_m = fmin(far_m, hypot(flight->samples[i].eye[0], flight->samples[i].eye[1]));
	if ((place->has_scene || place->crs) && far_m > FAR_M)
		main_note("the track is %.0f km from the scene's origin, so its pictures show nothing of it: add --to X,Y,Z (or --centre-to) to bring its "
			"first fix there%s", far_m / 1000, !degrees && !o->track_crs ? ", or --track-crs EPSG:... if its x and y are in a CRS" : "");
	return ECO_OK;
}

static enum eco_code write_script(const struct camera_options *o, const struct eco_script *script, struct eco_error *error)
{
	size_t size;
	struct eco_camera *camera;
	char *text = eco_script_text(script, &size);
	/* what was written is read as any reader would */
	enum eco_code code = text ? eco_camera_parse(&camera, text, size, o->output, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (!code) {
		eco_camera_free(camera);
		code = write_output(o->output, text, size, error);
	}
	free(text);
	return code;
}

static enum eco_code convert(const struct camera_options *o, struct eco_track *track, struct place *place, struct eco_error *error)
{
	struct eco_track_report report;
	struct eco_flight flight = { 0 };
	struct eco_script script = { 0 };
	struct eco_fitting fitting = { .fps = o->fps, .keys_max = (uint32_t)o->keys, .still_m = track->still_m };
	bool degrees = track->degrees;
	enum eco_code code = make_flight(&flight, track, o, place, &report, error);
	if (!code) {
		say_repairs(&report);
		say_guesses(o, &flight, track, &report, place, o->to_given || o->centre_given);
		code = move_flight(&flight, track, degrees, o, place, &report, error);
	}
	if (!code)
		code = eco_script_fit(&script, &flight, &fitting, error);
	if (!code && script.fps < 30 && !(o->fps > 0))
		main_note("%g frames a second, as the track is long (--fps N, --speed X, --from S --to-time S)", script.fps);
	if (!code)
		code = write_script(o, &script, error);
	if (!code && !main_is_quiet)
		print_summary(o, track, &report, &flight, &script);
	eco_script_free(&script);
	eco_flight_free(&flight);
	return code;
}

static enum eco_code camera_make(const struct camera_options *o, struct eco_error *error)
{
	struct eco_track track = { 0 };
	struct place place = { .crs = NULL };
	enum eco_code code = may_write(o->output, error);
	if (!code)
		code = eco_track_read(&track, o->input, &o->read, error);
	if (!code && track.format == ECO_TRACK_SCRIPT)
		return copy_script(o, error);
	if (!code)
		code = open_scene(&place, o, error);
	if (!code) {
		say_read(&track, o->input);
		code = convert(o, &track, &place, error);
	}
	if (place.has_raster)
		eco_ground_free(&place.ground);
	if (place.has_scene)
		eco_sources_free(&place.sources);
	eco_track_free(&track);
	return code;
}

/* ---- Options ---- */

/* Words in the order of the enum that they stand for. */
static enum eco_code choose(const char *option, const char *given, const char *words, int *value, struct eco_error *error)
{
	size_t length = given ? strlen(given) : 0;
	*value = 0;
	for (const char *at = words; given && at; at = strchr(at, ' ')) {
		at += *at == ' ';
		if (strncmp(at, given, length) == 0 && (at[length] == ' ' || at[length] == 0))
			return ECO_OK;
		++*value;
	}
	*value = given ? *value : 0;
	return given ? eco_fail(error, ECO_BAD_USAGE, "--%s %.60s: must be one of %s", option, given, words) : ECO_OK;
}

static enum eco_code run_camera(int argc, char **argv, struct eco_error *error)
{
	struct camera_options o = { .smooth_s = NAN, .pitch_deg = NAN, .fov_y_deg = NAN, .from_s = NAN, .to_s = NAN, .clearance_m = CLEARANCE_M };
	const char *format = NULL, *axes = NULL, *up = NULL, *height = NULL, *order = NULL;
	int axis, world, heights, latitudes;
	const struct main_option options[] = { { "output", 'o', MAIN_TEXT, &o.output, 0, 0, 0, NULL },
		{ "format", 0, MAIN_TEXT, &format, 0, 0, 0, NULL }, { "columns", 0, MAIN_TEXT, &o.read.columns, 0, 0, 0, NULL },
		{ "yaw-from-x", 0, MAIN_FLAG, &o.read.yaw_from_x, 0, 0, 0, NULL }, { "order", 0, MAIN_TEXT, &order, 0, 0, 0, NULL },
		{ "axes", 0, MAIN_TEXT, &axes, 0, 0, 0, NULL },
		{ "up", 0, MAIN_TEXT, &up, 0, 0, 0, NULL }, { "node", 0, MAIN_TEXT, &o.read.node, 0, 0, 0, NULL },
		{ "pace", 0, MAIN_NUMBER, &o.pace, 0.001, 10000, 0, NULL },
		{ "scene", 0, MAIN_TEXT, &o.scene, 0, 0, 0, NULL }, { "crs", 0, MAIN_TEXT, &o.crs, 0, 0, 0, NULL },
		{ "origin", 0, MAIN_NUMBERS, o.origin, -1e9, 1e9, 3, &o.origin_given }, { "track-crs", 0, MAIN_TEXT, &o.track_crs, 0, 0, 0, NULL },
		{ "to", 0, MAIN_NUMBERS, o.to, -1e7, 1e7, 3, &o.to_given }, { "centre-to", 0, MAIN_NUMBERS, o.centre, -1e7, 1e7, 3, &o.centre_given },
		{ "turn", 0, MAIN_NUMBER, &o.turn_deg, -3600, 3600, 0, NULL }, { "scale", 0, MAIN_NUMBER, &o.scale, 1e-6, 1e6, 0, NULL },
		{ "height", 0, MAIN_TEXT, &height, 0, 0, 0, NULL }, { "clearance", 0, MAIN_NUMBER, &o.clearance_m, -1e6, 1e6, 0, NULL },
		{ "part", 0, MAIN_COUNT, &o.part, 1, 1e6, 0, NULL }, { "from", 0, MAIN_NUMBER, &o.from_s, 0, 1e9, 0, NULL },
		{ "to-time", 0, MAIN_NUMBER, &o.to_s, 0, 1e9, 0, NULL }, { "pause", 0, MAIN_NUMBER, &o.pause, 0.001, 1e9, 0, NULL },
		{ "smooth", 0, MAIN_NUMBER, &o.smooth_s, 0, 1000, 0, NULL }, { "pitch", 0, MAIN_NUMBER, &o.pitch_deg, -90, 90, 0, NULL },
		{ "look-at", 0, MAIN_NUMBERS, o.look_at, -1e9, 1e9, 3, &o.look_at_given }, { "fov", 0, MAIN_NUMBER, &o.fov_y_deg, 1, 170, 0, NULL },
		{ "fps", 0, MAIN_NUMBER, &o.fps, 0.001, 1000, 0, NULL }, { "speed", 0, MAIN_NUMBER, &o.speed, 1e-4, 1e5, 0, NULL },
		{ "max-keyframes", 0, MAIN_COUNT, &o.keys, 2, 200000, 0, NULL }, { 0 } };
	enum eco_code code = main_arguments(argc, argv, "camera", options, "the recorded track", &o.input, 1, NULL, error);
	if (!code && !o.output)
		code = eco_fail(error, ECO_BAD_USAGE, "ecopack camera: -o CAMERA.json is missing");
	if (!code && o.to_given && o.centre_given)
		code = eco_fail(error, ECO_BAD_USAGE, "--to and --centre-to cannot both be kept");
	if (!code && !(code = choose("axes", axes, "default opengl opencv ros", &axis, error)) &&
		!(code = choose("up", up, "default z y -y", &world, error)) && !(code = choose("order", order, "lonlat latlon", &latitudes, error)) &&
		!(code = choose("height", height, "default abs rel ground", &heights, error))) {
		o.height = (enum eco_track_height)heights;
		o.read.format = format;
		o.read.axes = (enum eco_axes)axis;
		o.read.world = (enum eco_world)world;
		o.read.latitude_first = latitudes == 1;
	}
	return code ? code : camera_make(&o, error);
}

const struct main_command main_command_camera = { "camera", "TRACK -o CAMERA.json [--scene SCENE.json] [--to X,Y,Z] ...",
	"makes a camera script of a recorded track: a drone's SRT, GPX, KML, GeoJSON, CSV, a glTF camera",
	"  -o, --output PATH     the camera script, which appears complete or not at all and replaces nothing but another\n"
	"Reading\n"
	"      --format NAME     srt gpx kml geojson csv gltf; found by itself if not given\n"
	"      --columns LIST    of a table: t=NAME,lon=NAME,lat=NAME,alt=NAME:ft or east=,north=,up= and yaw=,pitch=,roll=,rel=,fov=,qx=..qw=\n"
	"      --yaw-from-x      a table's yaw turns counter-clockwise from +X; else clockwise from north\n"
	"      --order latlon    latitudes stand first in GPS(a, b)\n"
	"      --axes NAME       of cameras in poses (glTF; quaternions of a table): opengl opencv ros\n"
	"      --up NAME         axis of poses that points up: z y -y\n"
	"      --node NAME       the glTF camera, or its node\n"
	"      --pace M          metres a second where no position has a time; 10 if not given\n"
	"Placing\n"
	"      --scene PATH      SCENE.json: its CRS, origin and ground\n"
	"      --crs CRS --origin X,Y,Z     the same without a scene\n"
	"      --track-crs CRS   of a track in metres\n"
	"      --to X,Y,Z        where the first fix goes in the scene, for a track recorded elsewhere; --centre-to X,Y,Z: its centre\n"
	"      --turn DEG        counter-clockwise; --scale S: times its size\n"
	"      --height NAME     abs: above the scene's zero; rel: above take-off; ground: above the ground below\n"
	"      --clearance M     eyes stay so far above the ground; 1.7 if not given\n"
	"Motion\n"
	"      --part N          of a track that jumps; the longest if not given\n"
	"      --from S --to-time S         seconds of the track\n"
	"      --pause S         longer stands are shortened to this; 60 if not given\n"
	"      --smooth S        seconds; by the recording's rounding and speed if not given\n"
	"      --pitch DEG       up from the horizon, instead of what was recorded; --look-at X,Y,Z: always there\n"
	"      --fov DEG         height of the view; what was recorded, else 60\n"
	"      --fps N           frames a second; 30, or fewer if the track is long\n"
	"      --speed X         times as fast\n"
	"      --max-keyframes N at most; 8000 if not given\n", run_camera };
