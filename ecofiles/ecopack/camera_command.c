/* ecopack camera: turns a recorded track into a camera script, and reports what it changed. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/scene/scene.h"
#include "ecofiles/import/track/track.h"
#include "ecofiles/format/view.h"

#define FAR_M 1e5
#define SCRIPT_BYTES_MAX (64u << 20)

struct camera {                          /* what the command line says, and the scene */
	const char *input, *output, *scene;
	struct eco_track_options o;
	bool origin_given;
	struct eco_ground ground;
	struct eco_sources sources;
	FILE *out;                           /* of the child: notes, script, summary */
};

static enum eco_code open_scene(struct camera *c, struct eco_error *error)
{
	if (c->o.crs && (c->scene || !c->origin_given))
		return eco_fail(error, ECO_BAD_USAGE, c->scene ? "--scene and --crs say the same thing; take "
			"one of them" : "--crs needs --origin X,Y,Z, the point that is 0, 0, 0 in the scene");
	if (!c->scene)
		return ECO_OK;
	ECO_PASS(eco_sources_load(&c->sources, c->scene, error));
	const struct eco_source *scene = &c->sources.items[0];
	struct eco_ground_options ground = { .source = &scene->ground, .scene_crs = scene->crs,
		.scene_vertical = scene->vertical, .side_max = ECO_GROUND_INSIDE_MAX,
		.warn = main_note_text };
	c->o.has_ground = true;
	c->o.crs = scene->crs;
	memcpy(c->o.origin, scene->origin, sizeof ground.origin);
	memcpy(ground.origin, scene->origin, sizeof ground.origin);
	if (!scene->ground.height_count)
		return ECO_OK;
	ECO_PASS(eco_ground_import(&c->ground, &ground, error));
	c->o.ground = &c->ground;            /* freed from now on */
	eco_ground_extend(&c->ground);
	return ECO_OK;
}

/* ---- Reports ---- */

static void say_repairs(const struct camera *c, const struct eco_track *track)
{
	const struct eco_track_report *r = &track->report;
	const struct { uint32_t count; const char *says; } lines[] = {
		{ r->stamps_wrong, "times are years from the others, or run back: interpolated" },
		{ r->sorted, "file is not in the order of its times: sorted" },
		{ r->stamps_equal, "fixes have the time of the one before: interpolated by distance" },
		{ r->untimed ? 0 : r->stamps_missing, "fixes have no time: interpolated by distance" },
		{ r->jumped, "positions are left out: jumps, and all parts but the longest" },
		{ r->retimed, "steps take another time than recorded: short leaps, minutes without motion" },
	};
	if (track->skipped)
		fprintf(c->out, "%u records have no position, or none that can be: left out (the first: "
			"number or line %u)\n", track->skipped, track->skipped_line);
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		if (lines[i].count)
			fprintf(c->out, "%u %s\n", lines[i].count, lines[i].says);
}

/* Says which values stand in for what was not recorded. */
static void say_guesses(const struct camera *c, const struct eco_track *track, const struct eco_flight *f)
{
	if (f->smooth_s > 0 && isnan(c->o.smooth_s))
		fprintf(c->out, "smoothed with %.2g s (--smooth S; 0: not at all), which moves no position "
			"by more than %.2f m\n", f->smooth_s, f->moved_m);
	if (!f->yaw_recorded && !c->o.look_at_given)
		fprintf(c->out, "no directions were recorded: the camera looks where it goes, %g degrees "
			"above level (--pitch DEG, or --look-at X,Y,Z)\n", f->pitch_deg);
	else if (!f->pitch_recorded && isnan(c->o.pitch_deg) && !c->o.look_at_given)
		fprintf(c->out, "only its yaw was recorded: %g degrees of pitch are taken (--pitch DEG)\n",
			f->pitch_deg);
	if (track->report.untimed && f->count > 1)
		fprintf(c->out, "no times were recorded: %g m a second are taken (--speed X)\n",
			ECO_TRACK_PACE_M_S);
	if (!track->has_height)
		fprintf(c->out, "no heights were recorded: the camera is %g m above the ground "
			"(--clearance)\n", c->o.clearance_m);
	else if (track->height == ECO_HEIGHTS_ABSOLUTE && c->o.crs && !c->o.to_given)
		fprintf(c->out, "heights are read as metres above the zero of the scene's heights; datums "
			"are not converted (--height rel)\n");
	else if (track->height == ECO_HEIGHTS_RELATIVE && !c->o.to_given)
		fprintf(c->out, "heights are above take-off, which is %s (--height abs)\n",
			c->o.ground ? "on the scene's ground" : "z = 0");
}

static void say_moved(const struct camera *c, const struct eco_track *track, const struct eco_flight *f)
{
	double far_m = INFINITY, percent = 100.0 / f->count;
	for (uint32_t i = 0; i < f->count; i++)
		far_m = fmin(far_m, hypot(f->samples[i].eye[0], f->samples[i].eye[1]));
	if (track->local)
		fprintf(c->out, "the scene's place is not given (--scene SCENE.json, or --crs and --origin, "
			"or --to X,Y,Z): the first fix is the origin of the script's metres, x east, y "
			"north, and the lowest eye is at least %g m above z = 0 (--clearance)\n",
			c->o.clearance_m);
	if (f->raised)
		fprintf(c->out, "%.1f %% of the way is less than %g m above the ground, up to %.1f m below "
			"that: raised (--clearance M)\n", f->raised * percent, c->o.clearance_m,
			f->raised_m);
	if (f->off_ground)
		fprintf(c->out, "%.0f %% of the way is beyond the border of the scene's heights: there it is "
			"above the ground by which make continues them\n", f->off_ground * percent);
	if ((c->scene || c->o.crs) && far_m > FAR_M)
		fprintf(c->out, "the track is %.0f km from the scene's origin, so its pictures show nothing "
			"of it: add --to X,Y,Z to bring its first fix there, or --track-crs EPSG:... if its "
			"x and y are in a CRS\n", far_m / 1000);
}

static void write_summary(const struct camera *c, const struct eco_track *track,
	const struct eco_flight *f, const struct eco_script *s)
{
	double low[3], high[3];
	eco_flight_box(f, low, high);
	fprintf(c->out, "%s: %u records, %u positions kept, %u repeated, %u jumps, %u without a usable one\n",
		c->input, track->records, track->report.kept, track->report.repeated, track->report.jumped,
		track->skipped);
	fprintf(c->out, "  %.1f s, %.1f m long\n  x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f\n",
		s->length_s, f->length_m, low[0], high[0], low[1], high[1], low[2], high[2]);
	fprintf(c->out, "%s: %u keyframe%s, %u frame%s at %g a second, within %.3f m and %.2f degrees of the "
		"track\n", c->output, s->keys, s->keys == 1 ? "" : "s", s->frames, s->frames == 1 ? "" : "s",
		s->fps, s->error_m, s->error_deg);
}

static enum eco_code convert(struct camera *c, struct eco_track *track, struct eco_error *error)
{
	struct eco_flight flight = { 0 };
	struct eco_script script = { 0 };
	enum eco_code code = eco_track_place(track, &c->o, error);
	if (!code)
		eco_track_clean(track);
	say_repairs(c, track);
	if (!code) {
		eco_flight_make(&flight, track, &c->o);
		say_guesses(c, track, &flight);
		eco_flight_move(&flight, track, &c->o);
		say_moved(c, track, &flight);
		code = eco_script_fit(&script, &flight, &c->o, error);
	}
	if (!code) {
		fprintf(c->out, "%c%s%c", 0, script.text, 0);
		write_summary(c, track, &flight, &script);
	}
	free(script.text);
	eco_flight_free(&flight);
	return code;
}

/* All that has to do with a stranger's file, in a child (guard.h). Hands back notes, a line each, behind a 0
 * the script, and behind another the summary. */
static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	struct camera *c = ctx;
	struct eco_track track = { .notes = c->out = out };
	enum eco_code code = eco_track_read(&track, c->input, error);
	if (!code && track.format == ECO_TRACK_SCRIPT)
		fprintf(out, "%s is a camera script already: it is checked and copied; nothing else is done "
			"to it\n%c%s", c->input, 0, track.text);
	else if (!code)
		code = convert(c, &track, error);
	eco_track_free(&track);
	return code;
}

/* The script is read as any reader would, before it is written. */
static enum eco_code take(const struct camera *c, struct eco_guard *guard, FILE *from,
	struct eco_error *error)
{
	char *notes = eco_alloc(1, SCRIPT_BYTES_MAX + 3);   /* three texts, whatever the child says */
	struct eco_camera *camera = NULL;
	size_t size = fread(notes, 1, SCRIPT_BYTES_MAX, from);
	enum eco_code code = eco_guard_finish(guard, error);
	char *script = notes + strlen(notes) + 1;
	for (char *note = strtok(notes, "\n"); note; note = strtok(NULL, "\n"))
		main_note("%s", note);
	if (!code && size == SCRIPT_BYTES_MAX)
		code = eco_fail(error, ECO_TOO_LARGE, "%.300s: its script is too large", c->input);
	code = code ? code : eco_camera_parse(&camera, script, strlen(script), c->input, error);
	eco_camera_free(camera);
	code = code ? code : eco_file_write(c->output, script, strlen(script), error);
	if (!code && !main_is_quiet)
		fputs(script + strlen(script) + 1, stdout);
	free(notes);
	return code;
}

/* The output replaces nothing but a camera script. */
static enum eco_code may_write(const char *path, struct eco_error *error)
{
	struct stat status;
	struct eco_camera *camera = NULL;
	bool may = stat(path, &status) != 0 || (S_ISREG(status.st_mode)
		&& (!status.st_size || eco_camera_load(&camera, path, NULL) == ECO_OK));
	eco_camera_free(camera);
	return may ? ECO_OK : eco_fail(error, ECO_BAD_USAGE, "%.300s exists and is not a camera script; it "
		"is kept. Take another name", path);
}

static struct camera given;

static enum eco_code run_camera(int argc, char **argv, struct eco_error *error)
{
	struct camera *c = &given;
	struct eco_guard_limits limits = { 0 };
	struct eco_guard *guard;
	FILE *from;
	given = (struct camera){ .o = ECO_TRACK_DEFAULTS };
	enum eco_code code = main_read(&main_command_camera, argc, argv, error);
	code = code ? code : may_write(c->output, error);
	code = code ? code : open_scene(c, error);
	if (!code)
		limits.memory_bytes = eco_guard_small_memory(&c->input, 1);
	code = code ? code : eco_guard_start(&guard, work, c, c->input, &limits, &from, error);
	code = code ? code : take(c, guard, from, error);
	if (c->o.ground)
		eco_ground_free(&c->ground);
	eco_sources_free(&c->sources);
	return code;
}

static const char *const heights[] = { "default", "abs", "rel", NULL };

static const struct eco_option options[] = {
	{ "the recorded track", 0, ECO_OPTION_INPUT, "TRACK", .value = &given.input, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "CAMERA.json", .value = &given.output, .is_required = true },
	{ .help = "Placing" },
	{ "scene", 0, ECO_OPTION_TEXT, "SCENE.json", .value = &given.scene },
	{ "crs", 0, ECO_OPTION_TEXT, "CRS", .value = &given.o.crs },
	{ "origin", 0, ECO_OPTION_NUMBERS, "X,Y,Z", .value = given.o.origin, -1e9, 1e9, .count = 3,
		.given = &given.origin_given },
	{ "track-crs", 0, ECO_OPTION_TEXT, "CRS", .value = &given.o.track_crs },
	{ "to", 0, ECO_OPTION_NUMBERS, "X,Y,Z", .value = given.o.to, -1e7, 1e7, .count = 3,
		.given = &given.o.to_given },
	{ "turn", 0, ECO_OPTION_NUMBER, "DEG", .value = &given.o.turn_deg, -3600, 3600 },
	{ "height", 0, ECO_OPTION_CHOICE, "NAME", .value = &given.o.height, .choices = heights },
	{ "clearance", 0, ECO_OPTION_NUMBER, "M", .value = &given.o.clearance_m, -1e6, 1e6 },
	{ .help = "Motion" },
	{ "smooth", 0, ECO_OPTION_NUMBER, "S", .value = &given.o.smooth_s, 0, 1000 },
	{ "pitch", 0, ECO_OPTION_NUMBER, "DEG", .value = &given.o.pitch_deg, -90, 90 },
	{ "look-at", 0, ECO_OPTION_NUMBERS, "X,Y,Z", .value = given.o.look_at, -1e9, 1e9, .count = 3,
		.given = &given.o.look_at_given },
	{ "fov", 0, ECO_OPTION_NUMBER, "DEG", .value = &given.o.fov_y_deg, 1, 170 },
	{ "fps", 0, ECO_OPTION_NUMBER, "N", .value = &given.o.fps, 0.001, 1000 },
	{ "speed", 0, ECO_OPTION_NUMBER, "X", .value = &given.o.speed, 1e-4, 1e5 }, { 0 }
};

const struct main_command main_command_camera = { { "ecopack camera",
	"TRACK -o CAMERA.json [--scene SCENE.json] [--to X,Y,Z] ...",
	"Makes a camera script from a recorded track: SRT of a drone, GPX or CSV.",
	options, main_common, NULL, NULL }, run_camera };
