/* Which reader a file is for, by what it holds, and the readers' common ground: fixes are checked where they
 * are taken, so that no reader can let an impossible one through. Reading happens in a child process; what it
 * hands back is checked once more. */
#include <errno.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/track/track_read.h"

#define METRES_MAX 1e9
#define HEIGHT_MAX_M 1e5
#define SECONDS_MAX 1e11
#define FORMATS "SRT, GPX, KML, GeoJSON, CSV, glTF and camera scripts"
#define HEAD_BYTES 4096u

const char *const eco_track_format_names[ECO_TRACK_FORMATS] = { "a drone's subtitles (SRT)", "GPX", "KML",
	"GeoJSON", "CSV", "a glTF camera",
	"a camera script" };

static track_reader *const readers[ECO_TRACK_FORMATS] = { track_read_srt, track_read_rows, track_read_rows,
	track_read_rows, track_read_csv, track_read_gltf, NULL };

/* ---- Fixes ---- */

struct eco_fix track_fix(uint32_t line)
{
	return (struct eco_fix){ .time_s = NAN, .at = { NAN, NAN, NAN }, .above_m = NAN, .yaw_deg = NAN,
		.pitch_deg = NAN, .roll_deg = NAN,
		.fov_y_deg = NAN, .line = line };
}

static double within(double value, double most) { return fabs(value) <= most ? value : NAN; }

/* Whether it has a place on Earth, or in its metres; longitudes up to 360 are brought below 180. */
static bool check_position(const struct eco_track *track, double at[3])
{
	at[0] -= track->degrees && at[0] > 180 && at[0] <= 360 ? 360 : 0;
	return fabs(at[0]) <= (track->degrees ? 180 : METRES_MAX)
		&& fabs(at[1]) <= (track->degrees ? 90 : METRES_MAX);
}

enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error)
{
	struct eco_fix f = *fix;
	track->records++;
	if ((track->degrees && f.at[0] == 0 && f.at[1] == 0) || !check_position(track, f.at)) {
		track->skipped_line = track->skipped++ ? track->skipped_line : f.line;
		return ECO_OK;
	}
	if (track->count == ECO_TRACK_FIXES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u fixes", ECO_TRACK_FIXES_MAX);
	/* room doubles: at powers of two */
	if ((track->count & (track->count - 1)) == 0) {
		struct eco_fix *grown =
			realloc(track->fixes, (track->count ? 2 * (size_t)track->count : 1) * sizeof *grown);
		if (!grown)
			return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
		track->fixes = grown;
	}
	f.at[2] = within(f.at[2], track->degrees ? HEIGHT_MAX_M : METRES_MAX);
	f.above_m = within(f.above_m, HEIGHT_MAX_M);
	f.time_s = within(f.time_s, SECONDS_MAX);
	f.yaw_deg = within(f.yaw_deg, 1e6);
	f.pitch_deg = within(f.pitch_deg, 180);
	f.roll_deg = within(f.roll_deg, 360);
	f.fov_y_deg = f.fov_y_deg > 0.01 && f.fov_y_deg < 179 ? f.fov_y_deg : NAN;
	track->timed |= !isnan(f.time_s);
	track->fixes[track->count++] = f;
	return ECO_OK;
}

void eco_track_note(void *of, const char *format, ...)
{
	struct eco_track *track = of;
	va_list args;
	va_start(args, format);
	if (track->note_count < ECO_TRACK_NOTES_MAX)
		vsnprintf(track->notes[track->note_count++], ECO_TRACK_NOTE_BYTES, format, args);
	else
		strcpy(track->notes[ECO_TRACK_NOTES_MAX - 1], "there is more to say of this file");
	va_end(args);
}

void eco_track_free(struct eco_track *track)
{
	free(track->fixes);
	*track = (struct eco_track){ 0 };
}

/* ---- What a file is ---- */

static bool has(const struct track_input *in, const char *word)
{
	return track_holds(in->text, in->text + (in->size < HEAD_BYTES ? in->size : HEAD_BYTES), word);
}

/* Files that people try, and what to do instead. */
static enum eco_code refuse_others(const struct track_input *in, struct eco_error *error)
{
	static const struct { size_t at; const char *magic, *says; } kinds[] = {
		{ 0, "PK\3\4", "a zip archive; unzip it (a KMZ holds doc.kml) and name the file inside" },
		{ 8, ".FIT", "a FIT file; convert it to GPX or CSV" },
		{ 4, "ftyp", "a film; name the .SRT file that the drone wrote beside it" },
		{ 0, "\x1f\x8b", "compressed; unpack it with gunzip" },
		{ 0, "\xfd" "7zXZ", "compressed; unpack it with unxz" },
	};
	static const struct { const char *word, *says; } words[] = { { "HFDTE", "a glider's log (IGC)" },
		{ "<TrainingCenterDatabase", "TCX" },
		{ "$GPRMC,", "NMEA 0183" }, { "$GPGGA,", "NMEA 0183" }, { "$GNRMC,", "NMEA 0183" },
		{ "$GNGGA,", "NMEA 0183" },
		{ "QW, QX, QY, QZ, TX, TY, TZ", "COLMAP's images.txt" },
		{ "\"transform_matrix\"", "poses of pictures (transforms.json)" },
		{ "\"camera_path\"", "a camera path (nerfstudio)" } };
	size_t head = in->size < HEAD_BYTES ? in->size : HEAD_BYTES;
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		size_t length = strlen(kinds[i].magic);
		if (in->size >= kinds[i].at + length && memcmp(in->text + kinds[i].at, kinds[i].magic, length)
				== 0)
			return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is %s", in->path,
				kinds[i].says);
	}
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (has(in, words[i].word))
			return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is %s, which is not read; "
				"convert it to GPX or CSV (GPSBabel does for "
				"GPS logs). Read are " FORMATS, in->path, words[i].says);
	if (strspn(in->text, " \t\r\n") >= in->size)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: the file is empty", in->path);
	if (memchr(in->text, 0, head) && strncmp(in->text, "glTF", 4) != 0)
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is binary, or text in UTF-16, of no "
			"kind that is known; save the track as GPX or "
			"as CSV in UTF-8", in->path);
	return ECO_OK;
}

static enum eco_code json_format(const struct track_input *in, enum eco_track_format *format,
	struct eco_error *error)
{
	json_error_t problem;
	json_t *root = json_loadb(in->text, in->size, JSON_DECODE_INT_AS_REAL, &problem);
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s:%d:%d: %s", in->path, problem.line,
			problem.column, problem.text);
	*format = json_object_get(root, "keyframes") ? ECO_TRACK_SCRIPT
		: json_is_object(json_object_get(root, "asset")) ? ECO_TRACK_GLTF :
		json_is_string(json_object_get(root, "type")) ? ECO_TRACK_GEOJSON : ECO_TRACK_FORMATS;
	json_decref(root);
	return *format < ECO_TRACK_FORMATS ? ECO_OK
		: eco_fail(error, ECO_UNSUPPORTED, "%.300s: JSON, but no track that is known: no GeoJSON "
		"(\"type\"), no glTF (\"asset\"), no camera script (\"keyframes\")", in->path);
}

static bool ends_with(const char *path, const char *end)
{
	size_t length = strlen(path), wanted = strlen(end);
	return length >= wanted && track_is(path + length - wanted, path + length, end);
}

/* By content, then by the name's end. */
static enum eco_code find_format(const struct track_input *in, enum eco_track_format *format,
	struct eco_error *error)
{
	enum eco_code code = refuse_others(in, error);
	if (code)
		return code;
	char first = in->text[strspn(in->text, " \t\r\n")];
	if (strncmp(in->text, "glTF", 4) == 0)
		*format = ECO_TRACK_GLTF;
	else if (first == '<' && (has(in, "<gpx") || has(in, "<kml")))
		*format = has(in, "<gpx") ? ECO_TRACK_GPX : ECO_TRACK_KML;
	else if (first == '<')
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: XML, but neither GPX nor KML; convert it "
			"to GPX or CSV", in->path);
	else if (first == '{')
		return json_format(in, format, error);
	else if (has(in, " --> ") || has(in, "[latitude") || has(in, "HOME(") || ends_with(in->path, ".srt"))
		*format = ECO_TRACK_SRT;
	else
		*format = ECO_TRACK_CSV;
	return ECO_OK;
}

/* ---- Reading ---- */

static enum eco_code say_nothing_found(const struct eco_track *track, const struct track_input *in,
	struct eco_error *error)
{
	const char *name = eco_track_format_names[track->format];
	return !track->skipped ? eco_fail(error, ECO_BAD_INPUT, "%.250s: no fix found; it was read as %s",
		in->path, name) :
		eco_fail(error, ECO_BAD_INPUT, "%.250s:%u: read as %s, it has %llu records and no usable "
			"fix: no position, or one that cannot be", in->path, track->skipped_line, name,
			(unsigned long long)track->records);
}

static enum eco_code read_text(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	enum eco_code code = find_format(in, &track->format, error);
	if (code || track->format == ECO_TRACK_SCRIPT)
		return code;
	code = readers[track->format](track, in, error);
	return code || track->count ? code : say_nothing_found(track, in, error);
}

enum eco_code eco_track_parse(struct eco_track *track, const uint8_t *bytes, size_t size, const char *path,
	const struct eco_track_options *options, struct eco_error *error)
{
	struct eco_error cause = { 0 };
	size_t mark = size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	char *text = malloc(size - mark + 1);
	struct track_input in = { .text = text, .size = size - mark, .path = path,
		.node = options ? options->node : NULL };
	*track = (struct eco_track){ 0 };
	if (text) {
		memcpy(text, bytes + mark, in.size);
		text[in.size] = 0;
	}
	enum eco_code code = text ? read_text(track, &in, &cause)
		: eco_fail(&cause, ECO_NO_MEMORY, "no memory for it");
	free(text);
	if (!code)
		return ECO_OK;
	eco_track_free(track);
	return strstr(cause.text, path) || strlen(path) > 200
		? eco_fail(error, cause.code, "%s", cause.text) :
		eco_fail(error, cause.code, "%s: %.300s", path, cause.text);
}

/* ---- In a child ---- */

struct job { const char *path; const struct eco_track_options *options; };

static enum eco_code read_in_child(void *ctx, FILE *out, struct eco_error *error)
{
	const struct job *job = ctx;
	struct eco_track track = { 0 };
	uint8_t *bytes = NULL;
	size_t size;
	enum eco_code code = eco_file_read(job->path, ECO_TRACK_BYTES_MAX, &bytes, &size, error);
	if (!code)
		code = eco_track_parse(&track, bytes, size, job->path, job->options, error);
	if (!code
			&& (fwrite(&track, sizeof track, 1, out) != 1
			|| fwrite(track.fixes, sizeof *track.fixes, track.count, out) != track.count))
		code = eco_fail(error, ECO_IO, "%.300s: %s", job->path, strerror(errno));
	eco_track_free(&track);
	free(bytes);
	return code;
}

/* The child has read a stranger's file: nothing that it says is believed. */
static enum eco_code take(struct eco_track *track, FILE *from, struct eco_error *error)
{
	uint32_t count = 0;
	struct eco_fix fix;
	enum eco_code code = ECO_OK;
	if (fread(track, sizeof *track, 1, from) == 1)
		count = track->count;
	uint64_t records = track->records;
	track->fixes = NULL;
	track->count = 0;
	track->timed = false;
	track->has_home = track->has_home && check_position(track, track->home);
	if ((uint32_t)track->format >= ECO_TRACK_FORMATS || track->note_count > ECO_TRACK_NOTES_MAX)
		return eco_fail(error, ECO_DAMAGED, "its reader handed back nonsense");
	for (uint32_t i = 0; i < track->note_count; i++)
		track->notes[i][ECO_TRACK_NOTE_BYTES - 1] = 0;
	while (!code && track->count < count && fread(&fix, sizeof fix, 1, from) == 1)
		code = track_add(track, &fix, error);
	track->records = records;
	if (!code && (track->count != count || (!count && track->format != ECO_TRACK_SCRIPT)))
		code = eco_fail(error, ECO_DAMAGED, "its reader gave up in the middle");
	return code;
}

enum eco_code eco_track_read(struct eco_track *track, const char *path,
	const struct eco_track_options *options, struct eco_error *error)
{
	struct job job = { .path = path, .options = options };
	struct stat status;
	struct eco_error cause = { 0 };
	FILE *from;
	*track = (struct eco_track){ 0 };
	if (stat(path, &status) != 0)
		return eco_fail(error, ECO_IO, "%.300s: %s", path, strerror(errno));
	if (!S_ISREG(status.st_mode))
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: this is no file%s", path,
			S_ISDIR(status.st_mode) ? " but a folder" : "");
	struct eco_guard_limits limits = eco_guard_limits_for((uint64_t)status.st_size);
	enum eco_code code = eco_guard_run(read_in_child, &job, path, &limits, &from, error);
	if (code)
		return code;
	code = take(track, from, &cause);
	fclose(from);
	if (!code)
		return ECO_OK;
	eco_track_free(track);
	return eco_fail(error, cause.code, "%.300s: %s", path, cause.text);
}
