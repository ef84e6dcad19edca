/* ecopack camera: turns a recorded track into a camera script, and reports what it changed. */
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

struct camera {                          /* what the options say (NaN, 0 or NULL where not given; see the help below), and the scene */
	const char *input, *output, *scene;
	struct eco_track_options read;
	struct eco_track_frame frame;
	struct eco_cleaning cleaning;
	struct eco_smoothing smoothing;
	struct eco_flight_move move;
	struct eco_fitting fitting;
	bool origin_given, moved;            /* moved: the user says where it goes */
	struct eco_ground ground;
	struct eco_sources sources;
};

/* ---- The scene ---- */

static enum eco_code open_scene(struct camera *c, struct eco_error *error)
{
	if (c->frame.crs && (c->scene || !c->origin_given))
		return eco_fail(error, ECO_BAD_USAGE, c->scene ? "--scene and --crs say the same thing; take one of them" :
			"--crs needs --origin X,Y,Z, the point that is 0, 0, 0 in the scene");
	if (!c->scene)
		return ECO_OK;
	enum eco_code code = eco_sources_load(&c->sources, c->scene, error);
	if (code)
		return code;
	const struct eco_source *scene = &c->sources.items[0];
	struct eco_ground_options ground = { .source = &scene->ground, .scene_crs = scene->crs, .scene_vertical = scene->vertical,
		.warn = main_note_text };
	c->move.has_ground = true;
	c->frame.crs = scene->crs;
	memcpy(c->frame.origin, scene->origin, sizeof ground.origin);
	memcpy(ground.origin, scene->origin, sizeof ground.origin);
	if (scene->ground.height_count && !(code = eco_ground_import(&c->ground, &ground, error)))
		c->move.ground = &c->ground;
	return code;
}

/* ---- Reports ---- */

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

/* Says which values stand in for what was not recorded. */
static void say_guesses(const struct camera *c, const struct eco_flight *f, const struct eco_track *track, const struct eco_track_report *r)
{
	if (f->smooth_s > 0 && isnan(c->smoothing.smooth_s))
		main_note("smoothed with %.2g s (--smooth S; 0: not at all), which moves no position by more than %.2f m", f->smooth_s, f->moved_m);
	if (!f->yaw_recorded && !c->move.look_at_given)
		main_note("no directions were recorded: the camera looks where it goes, %g degrees above level (--pitch DEG, or --look-at X,Y,Z)",
			f->pitch_deg);
	else if (!f->pitch_recorded && isnan(c->smoothing.pitch_deg) && !c->move.look_at_given)
		main_note("only its yaw was recorded: %g degrees of pitch are taken (--pitch DEG)", f->pitch_deg);
	if (r->untimed && track->count > 1)
		main_note("no times were recorded: %g m a second are taken (--pace)", c->cleaning.pace_m_s > 0 ? c->cleaning.pace_m_s : 10.0);
	if (!r->has_height)
		main_note("no heights were recorded: the camera is %g m above the ground (--clearance)", c->move.clearance_m);
	else if (r->height == ECO_HEIGHTS_ABSOLUTE && c->frame.crs && !c->moved)
		main_note("heights are taken as metres above the zero of the scene's heights; another datum is not converted (--height rel|ground)");
	else if (r->height == ECO_HEIGHTS_RELATIVE && !c->moved)
		main_note("heights are above take-off%s (--height abs|ground)", c->move.ground ? ", which is on the scene's ground" : ", which is z = 0");
}

static void print_summary(const struct camera *c, const struct eco_track *track, const struct eco_track_report *r,
	const struct eco_flight *f, const struct eco_script *s)
{
	double length_s = (f->count - 1) * f->step_s, low[3], high[3], fastest = 0;
	uint64_t skipped = track->skipped[ECO_TRACK_NO_POSITION] + track->skipped[ECO_TRACK_BAD_NUMBER];
	eco_flight_box(f, low, high);
	for (uint32_t i = 1; i < f->count; i++)
		fastest = fmax(fastest, eco_distance(f->samples[i].eye, f->samples[i - 1].eye) / f->step_s);
	printf("%s: %" PRIu64 " records, %" PRIu64 " positions kept", c->input, track->records, r->kept);
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
	printf("%s: %u keyframe%s, %u frame%s at %g a second, within %.3f m and %.2f degrees of the track\n", c->output, s->count,
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

static enum eco_code copy_script(const struct camera *c, struct eco_error *error)
{
	struct stat status;
	FILE *file = fopen(c->input, "rb");
	char *text = file && fstat(fileno(file), &status) == 0 ? malloc((size_t)status.st_size + 1) : NULL;
	size_t size = text ? fread(text, 1, (size_t)status.st_size, file) : 0;
	struct eco_camera *camera = NULL;
	enum eco_code code = text ? eco_camera_parse(&camera, text, size, c->input, error) : eco_fail(error, ECO_IO, "%.300s: %s", c->input,
		strerror(errno));
	if (!code)
		code = write_output(c->output, text, size, error);
	if (!code)
		main_note("%s is a camera script already: it was checked and copied; nothing else was done to it", c->input);
	if (!code && !main_is_quiet)
		printf("%s: %u frames\n", c->output, eco_camera_frame_count(camera));
	eco_camera_free(camera);
	free(text);
	if (file)
		fclose(file);
	return code;
}

/* ---- From the track to the script ---- */

static void lift(struct eco_flight *flight, double by_m)
{
	for (uint32_t i = 0; i < flight->count; i++)
		flight->samples[i].eye[2] += by_m;
}

static void say_moved(const struct camera *c, const struct eco_flight *flight, const struct eco_flight_moved *moved, bool degrees)
{
	double far_m = INFINITY;
	for (uint32_t i = 0; i < flight->count; i++)
		far_m = fmin(far_m, hypot(flight->samples[i].eye[0], flight->samples[i].eye[1]));
	if (moved->raised)
		main_note("%.1f %% of the way is less than %g m above the ground, up to %.1f m below that: raised (--clearance M)",
			100.0 * moved->raised / flight->count, c->move.clearance_m, moved->raised_m);
	if (moved->off_ground)
		main_note("%.0f %% of the way is beyond the border of the scene's ground", 100.0 * moved->off_ground / flight->count);
	if ((c->scene || c->frame.crs) && far_m > FAR_M)
		main_note("the track is %.0f km from the scene's origin, so its pictures show nothing of it: add --to X,Y,Z (or --centre-to) to bring its "
			"first fix there%s", far_m / 1000, !degrees && !c->frame.track_crs ? ", or --track-crs EPSG:... if its x and y are in a CRS" : "");
}

static enum eco_code move_flight(struct camera *c, struct eco_flight *flight, const struct eco_track *track, bool degrees,
	const struct eco_track_report *r, struct eco_error *error)
{
	bool local = degrees && !c->frame.crs && !c->moved;
	const double *from = track->has_home ? track->home : flight->samples[0].eye;
	double ground = 0, low[3], high[3];
	struct eco_flight_moved moved;
	c->move.from_ground = r->height == ECO_HEIGHTS_GROUND || (!r->has_height && c->scene);
	if (local) {
		c->move.to_given = true;
		c->move.to[2] = r->height == ECO_HEIGHTS_ABSOLUTE ? 0 : NAN;
		main_note("the first fix is the origin of the script's metres, x east, y north: nothing says where the scene is (--scene SCENE.json, or "
			"--crs and --origin, or --to X,Y,Z)");
	}
	/* heights above take-off count from the ground there */
	if (!c->moved && !local && r->height == ECO_HEIGHTS_RELATIVE && c->move.ground && eco_ground_height(&c->ground, from[0], from[1], &ground))
		lift(flight, ground);
	enum eco_code code = eco_flight_move(flight, &c->move, &moved, error);
	if (code)
		return code;
	eco_flight_box(flight, low, high);
	/* without a scene the ground is unknown: take it as z = 0, and keep the whole track above */
	if (!c->scene && local && c->move.clearance_m > low[2]) {
		lift(flight, c->move.clearance_m - low[2]);
		main_note("without --scene the ground is z = 0: the track is raised as a whole by %.1f m, so that its lowest eye is %g m above "
			"(--clearance)", c->move.clearance_m - low[2], c->move.clearance_m);
	}
	say_moved(c, flight, &moved, degrees);
	return ECO_OK;
}

static enum eco_code write_script(const struct camera *c, const struct eco_script *script, struct eco_error *error)
{
	size_t size;
	struct eco_camera *camera = NULL;
	char *text = eco_script_text(script, &size);
	/* read the written script as any reader would */
	enum eco_code code = text ? eco_camera_parse(&camera, text, size, c->output, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (!code)
		code = write_output(c->output, text, size, error);
	eco_camera_free(camera);
	free(text);
	return code;
}

static enum eco_code convert(struct camera *c, struct eco_track *track, struct eco_error *error)
{
	struct eco_track_report report;
	struct eco_flight flight = { 0 };
	struct eco_script script = { 0 };
	bool degrees = track->degrees;
	uint32_t notes = track->note_count;
	say_read(track, c->input);
	enum eco_code code = eco_track_place(track, &c->frame, error);
	if (!code)
		code = eco_track_clean(track, &c->cleaning, &report, error);
	for (uint32_t i = notes; i < track->note_count; i++)
		main_note("%s", track->notes[i]);
	c->smoothing.flies = track->format == ECO_TRACK_SRT;
	if (!code)
		code = eco_flight_make(&flight, track, &c->smoothing, error);
	if (!code) {
		say_repairs(&report);
		say_guesses(c, &flight, track, &report);
		code = move_flight(c, &flight, track, degrees, &report, error);
	}
	if (!code)
		code = eco_script_fit(&script, &flight, &c->fitting, error);
	if (!code && script.fps < 30 && !(c->fitting.fps > 0))
		main_note("%g frames a second, as the track is long (--fps N, --speed X, --from S --to-time S)", script.fps);
	if (!code)
		code = write_script(c, &script, error);
	if (!code && !main_is_quiet)
		print_summary(c, track, &report, &flight, &script);
	eco_script_free(&script);
	eco_flight_free(&flight);
	return code;
}

static enum eco_code camera_make(struct camera *c, struct eco_error *error)
{
	struct eco_track track = { 0 };
	enum eco_code code = may_write(c->output, error);
	if (!code)
		code = eco_track_read(&track, c->input, &c->read, error);
	if (!code && track.format == ECO_TRACK_SCRIPT)
		return copy_script(c, error);
	if (!code)
		code = open_scene(c, error);
	if (!code)
		code = convert(c, &track, error);
	if (c->move.ground)
		eco_ground_free(&c->ground);
	if (c->move.has_ground)
		eco_sources_free(&c->sources);
	eco_track_free(&track);
	return code;
}

/* ---- Options ---- */

static struct camera given;
static struct { int axes, up, height, order; uint64_t part, keys; } chosen;

static void read_choices(void)
{
	given.read.axes = (enum eco_axes)chosen.axes;
	given.read.world = (enum eco_world)chosen.up;
	given.read.latitude_first = chosen.order == 1;
	given.cleaning.height = (enum eco_track_height)chosen.height;
	given.cleaning.part = (uint32_t)chosen.part;
	given.fitting.keys_max = (uint32_t)chosen.keys;
	given.moved = given.frame.local = given.move.to_given |= given.move.centre;
}

static enum eco_code run_camera(int argc, char **argv, struct eco_error *error)
{
	given = (struct camera){ .smoothing = { .smooth_s = NAN, .pitch_deg = NAN, .fov_y_deg = NAN },
		.move = { .from_s = NAN, .to_s = NAN, .clearance_m = CLEARANCE_M } };
	memset(&chosen, 0, sizeof chosen);
	enum eco_code code = main_read(&main_command_camera, argc, argv, error);
	if (!code && given.move.to_given && given.move.centre)
		code = eco_fail(error, ECO_BAD_USAGE, "--to and --centre-to cannot both be kept");
	read_choices();
	return code ? code : camera_make(&given, error);
}

static const char *const axes[] = { "default", "opengl", "opencv", "ros", NULL }, *const ups[] = { "default", "z", "y", "-y", NULL },
	*const heights[] = { "default", "abs", "rel", "ground", NULL },
	*const orders[] = { "lonlat", "latlon", NULL };

static const struct eco_option options[] = {
	{ "the recorded track", 0, ECO_OPTION_INPUT, "TRACK", &given.input, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "CAMERA.json", &given.output, .is_required = true,
		.help = "the camera script, which appears complete or not at all and replaces nothing but another" },
	{ .help = "Reading" },
	{ "format", 0, ECO_OPTION_TEXT, "NAME", &given.read.format,
		.help = "srt gpx kml geojson csv gltf; found by itself if not given" },
	{ "columns", 0, ECO_OPTION_TEXT, "LIST", &given.read.columns,
		.help = "of a table: t=NAME,lon=NAME,lat=NAME,alt=NAME:ft or east=,north=,up= and yaw=,pitch=,roll=,rel=,fov=,qx=..qw=" },
	{ "yaw-from-x", 0, ECO_OPTION_FLAG, NULL, &given.read.yaw_from_x,
		.help = "a table's yaw turns counter-clockwise from +X; else clockwise from north" },
	{ "order", 0, ECO_OPTION_CHOICE, "NAME", &chosen.order, .choices = orders, .help = "latlon: latitudes stand first in GPS(a, b)" },
	{ "axes", 0, ECO_OPTION_CHOICE, "NAME", &chosen.axes, .choices = axes, .help = "of cameras in poses (glTF; quaternions of a table): opengl opencv ros" },
	{ "up", 0, ECO_OPTION_CHOICE, "NAME", &chosen.up, .choices = ups, .help = "axis of poses that points up: z y -y" },
	{ "node", 0, ECO_OPTION_TEXT, "NAME", &given.read.node, .help = "the glTF camera, or its node" },
	{ "pace", 0, ECO_OPTION_NUMBER, "M", &given.cleaning.pace_m_s, 0.001, 10000,
		.help = "metres a second where no position has a time; 10 if not given" },
	{ .help = "Placing" },
	{ "scene", 0, ECO_OPTION_TEXT, "SCENE.json", &given.scene, .help = "its CRS, origin and ground" },
	{ "crs", 0, ECO_OPTION_TEXT, "CRS", &given.frame.crs, .help = "with --origin, the same without a scene" },
	{ "origin", 0, ECO_OPTION_NUMBERS, "X,Y,Z", given.frame.origin, -1e9, 1e9, .count = 3, .given = &given.origin_given,
		.help = "the point of --crs that is 0, 0, 0 in the scene" },
	{ "track-crs", 0, ECO_OPTION_TEXT, "CRS", &given.frame.track_crs, .help = "of a track in metres" },
	{ "to", 0, ECO_OPTION_NUMBERS, "X,Y,Z", given.move.to, -1e7, 1e7, .count = 3, .given = &given.move.to_given,
		.help = "where the first fix goes in the scene, for a track recorded elsewhere" },
	{ "centre-to", 0, ECO_OPTION_NUMBERS, "X,Y,Z", given.move.to, -1e7, 1e7, .count = 3, .given = &given.move.centre,
		.help = "where its centre goes, instead" },
	{ "turn", 0, ECO_OPTION_NUMBER, "DEG", &given.move.turn_deg, -3600, 3600, .help = "counter-clockwise" },
	{ "scale", 0, ECO_OPTION_NUMBER, "S", &given.move.scale, 1e-6, 1e6, .help = "times its size" },
	{ "height", 0, ECO_OPTION_CHOICE, "NAME", &chosen.height, .choices = heights,
		.help = "abs: above the scene's zero; rel: above take-off; ground: above the ground below" },
	{ "clearance", 0, ECO_OPTION_NUMBER, "M", &given.move.clearance_m, -1e6, 1e6,
		.help = "eyes stay so far above the ground; 1.7 if not given" },
	{ .help = "Motion" },
	{ "part", 0, ECO_OPTION_COUNT, "N", &chosen.part, 1, 1e6, .help = "of a track that jumps; the longest if not given" },
	{ "from", 0, ECO_OPTION_NUMBER, "S", &given.move.from_s, 0, 1e9, .help = "second of the track to begin with" },
	{ "to-time", 0, ECO_OPTION_NUMBER, "S", &given.move.to_s, 0, 1e9, .help = "second of the track to end with" },
	{ "pause", 0, ECO_OPTION_NUMBER, "S", &given.cleaning.pause_s, 0.001, 1e9, .help = "longer stands are shortened to this; 60 if not given" },
	{ "smooth", 0, ECO_OPTION_NUMBER, "S", &given.smoothing.smooth_s, 0, 1000,
		.help = "seconds; by the recording's rounding and speed if not given" },
	{ "pitch", 0, ECO_OPTION_NUMBER, "DEG", &given.smoothing.pitch_deg, -90, 90, .given = &given.smoothing.pitch_given_wins,
		.help = "up from the horizon, instead of what was recorded" },
	{ "look-at", 0, ECO_OPTION_NUMBERS, "X,Y,Z", given.move.look_at, -1e9, 1e9, .count = 3, .given = &given.move.look_at_given,
		.help = "always there" },
	{ "fov", 0, ECO_OPTION_NUMBER, "DEG", &given.smoothing.fov_y_deg, 1, 170, .help = "height of the view; what was recorded, else 60" },
	{ "fps", 0, ECO_OPTION_NUMBER, "N", &given.fitting.fps, 0.001, 1000, .help = "frames a second; 30, or fewer if the track is long" },
	{ "speed", 0, ECO_OPTION_NUMBER, "X", &given.move.speed, 1e-4, 1e5, .help = "times as fast" },
	{ "max-keyframes", 0, ECO_OPTION_COUNT, "N", &chosen.keys, 2, 200000, .help = "at most; 8000 if not given" }, { 0 } };

const struct main_command main_command_camera = { { "ecopack camera", "TRACK -o CAMERA.json [--scene SCENE.json] [--to X,Y,Z] ...",
	"Makes a camera script of a recorded track: a drone's SRT, GPX, KML, GeoJSON, CSV, a glTF camera", options, main_common,
	NULL, NULL }, run_camera };
