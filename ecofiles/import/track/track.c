/* Which reader a file is for, by what it holds, and the readers' common ground: fixes are checked where they are taken, so that no
 * reader can let an impossible one through. Reading happens in a child process; what it hands back is checked once more. */
#include "ecofiles/import/track/track.h"

#include <errno.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/format/view.h"
#include "ecofiles/import/track/track_read.h"

#define METRES_MAX 1e9
#define HEIGHT_MAX_M 1e5
#define SECONDS_MAX 1e11
#define FORMATS "srt, gpx, kml, geojson, csv, gltf and script"
#define HEAD_BYTES 4096u

const struct eco_track_kind eco_track_kinds[ECO_TRACK_FORMATS] = {
	[ECO_TRACK_SRT] = { "srt", "a drone's subtitles (SRT)" }, [ECO_TRACK_GPX] = { "gpx", "GPX" }, [ECO_TRACK_KML] = { "kml", "KML" },
	[ECO_TRACK_GEOJSON] = { "geojson", "GeoJSON" }, [ECO_TRACK_CSV] = { "csv", "CSV" }, [ECO_TRACK_GLTF] = { "gltf", "a glTF camera" },
	[ECO_TRACK_SCRIPT] = { "script", "a camera script" },
};

static track_reader *const readers[ECO_TRACK_FORMATS] = {
	[ECO_TRACK_SRT] = track_read_srt, [ECO_TRACK_GPX] = track_read_rows, [ECO_TRACK_KML] = track_read_rows,
	[ECO_TRACK_GEOJSON] = track_read_rows, [ECO_TRACK_CSV] = track_read_csv, [ECO_TRACK_GLTF] = track_read_gltf,
};

const char *const eco_track_skip_names[ECO_TRACK_SKIPS] = { "no position", "a position that cannot be" };

/* ---- Fixes ---- */

struct eco_fix track_fix(uint32_t line)
{
	return (struct eco_fix){ .time_s = NAN, .at = { NAN, NAN, NAN }, .above_m = NAN, .yaw_deg = NAN, .pitch_deg = NAN, .roll_deg = NAN,
		.fov_y_deg = NAN, .line = line };
}

static double within(double value, double most) { return fabs(value) <= most ? value : NAN; }

/* Whether it has a place on Earth, or in its metres; longitudes up to 360 are brought below 180. */
static bool check_position(const struct eco_track *track, double at[3])
{
	at[0] -= track->degrees && at[0] > 180 && at[0] <= 360 ? 360 : 0;
	return fabs(at[0]) <= (track->degrees ? 180 : METRES_MAX) && fabs(at[1]) <= (track->degrees ? 90 : METRES_MAX);
}

enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error)
{
	struct eco_fix f = *fix;
	bool none = isnan(f.at[0]) || isnan(f.at[1]) || (track->degrees && f.at[0] == 0 && f.at[1] == 0);
	track->records++;
	if (none || !check_position(track, f.at)) {
		int why = none ? ECO_TRACK_NO_POSITION : ECO_TRACK_BAD_NUMBER;
		if (track->skipped[why]++ == 0)
			track->skipped_line[why] = f.line;
		return ECO_OK;
	}
	if (track->count == ECO_TRACK_FIXES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u fixes", ECO_TRACK_FIXES_MAX);
	/* room doubles: at powers of two */
	if ((track->count & (track->count - 1)) == 0) {
		struct eco_fix *grown = realloc(track->fixes, (track->count ? 2 * (size_t)track->count : 1) * sizeof *grown);
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

void eco_track_note(struct eco_track *track, const char *format, ...)
{
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
		{ 0, "\x89PNG", "a picture" }, { 0, "\xff\xd8\xff", "a picture" }, { 0, "ECOPACK", "a pack, not a track" },
		{ 0, "\x1f\x8b", "compressed; unpack it with gunzip" }, { 0, "\xfd" "7zXZ", "compressed; unpack it with unxz" },
		{ 0, "SQLite", "a database; save its track as CSV or GPX" },
	};
	static const struct { const char *word, *says; } words[] = {
		{ "HFDTE", "a glider's log (IGC)" }, { "<TrainingCenterDatabase", "TCX" },
		{ "$GPRMC,", "NMEA 0183" }, { "$GPGGA,", "NMEA 0183" }, { "$GNRMC,", "NMEA 0183" }, { "$GNGGA,", "NMEA 0183" },
		{ "QW, QX, QY, QZ, TX, TY, TZ", "COLMAP's images.txt" }, { "\"transform_matrix\"", "poses of pictures (transforms.json)" },
		{ "\"camera_path\"", "a camera path (nerfstudio)" },
	};
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		size_t length = strlen(kinds[i].magic);
		if (in->size >= kinds[i].at + length && memcmp(in->text + kinds[i].at, kinds[i].magic, length) == 0)
			return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is %s", in->path, kinds[i].says);
	}
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (has(in, words[i].word))
			return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is %s, which is not read; convert it to GPX or CSV (GPSBabel does for "
				"GPS logs). Read are " FORMATS, in->path, words[i].says);
	if (strspn(in->text, " \t\r\n") >= in->size)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: the file is empty", in->path);
	if (memchr(in->text, 0, in->size < HEAD_BYTES ? in->size : HEAD_BYTES) && strncmp(in->text, "glTF", 4) != 0)
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is binary and of no kind that is known; save the track as CSV or GPX",
			in->path);
	return ECO_OK;
}

static enum eco_code json_format(const struct track_input *in, enum eco_track_format *format, struct eco_error *error)
{
	json_error_t problem;
	json_t *root = json_loadb(in->text, in->size, JSON_DECODE_INT_AS_REAL, &problem);
	enum eco_code code = ECO_OK;
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s:%d:%d: %s", in->path, problem.line, problem.column, problem.text);
	if (json_object_get(root, "keyframes"))
		*format = ECO_TRACK_SCRIPT;
	else if (json_is_object(json_object_get(root, "asset")))
		*format = ECO_TRACK_GLTF;
	else if (json_is_string(json_object_get(root, "type")))
		*format = ECO_TRACK_GEOJSON;
	else
		code = eco_fail(error, ECO_UNSUPPORTED, "%.300s: JSON, but no track that is known: no GeoJSON (\"type\"), no glTF (\"asset\"), no "
			"camera script (\"keyframes\")", in->path);
	json_decref(root);
	return code;
}

static enum eco_code by_content(const struct track_input *in, enum eco_track_format *format, struct eco_error *error)
{
	static const struct { const char *end; enum eco_track_format format; } ends[] = { { ".srt", ECO_TRACK_SRT }, { ".vtt", ECO_TRACK_SRT },
		{ ".glb", ECO_TRACK_GLTF }, { ".gltf", ECO_TRACK_GLTF } };
	size_t start = strspn(in->text, " \t\r\n"), length = strlen(in->path);
	char first = in->text[start];
	*format = ECO_TRACK_CSV;
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
		if (length >= strlen(ends[i].end) && track_is(in->path + length - strlen(ends[i].end), in->path + length, ends[i].end))
			*format = ends[i].format;
	if (strncmp(in->text, "glTF", 4) == 0)
		*format = ECO_TRACK_GLTF;
	else if (first == '<' && (has(in, "<gpx") || has(in, "<kml")))
		*format = has(in, "<gpx") ? ECO_TRACK_GPX : ECO_TRACK_KML;
	else if (first == '<')
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: XML, but neither GPX nor KML; convert it to GPX or CSV", in->path);
	else if (first == '{' || (first == '[' && strchr(" \t\r\n{[", in->text[start + 1])))
		return json_format(in, format, error);
	else if (has(in, " --> ") || has(in, "[latitude") || has(in, "HOME("))
		*format = ECO_TRACK_SRT;
	return ECO_OK;
}

static enum eco_code find_format(const struct track_input *in, enum eco_track_format *format, struct eco_error *error)
{
	const char *stated = in->options->format;
	for (int i = 0; stated && i < ECO_TRACK_FORMATS; i++)
		if (strcmp(stated, eco_track_kinds[i].name) == 0) {
			*format = (enum eco_track_format)i;
			return ECO_OK;
		}
	if (stated)
		return eco_fail(error, ECO_BAD_USAGE, "no format is called %.40s; there are " FORMATS, stated);
	enum eco_code code = refuse_others(in, error);
	*format = ECO_TRACK_CSV;
	/* columns can be told from anything */
	return code || in->options->columns ? code : by_content(in, format, error);
}

/* ---- Reading ---- */

/* The text with a 0 behind it and without a byte order mark. UTF-16, as spreadsheets write "Unicode text": what is no ASCII becomes '?',
 * no name or number that matters has it. */
static char *text_of(const uint8_t *bytes, size_t size, size_t *length)
{
	bool big = size >= 2 && bytes[0] == 0xfe && bytes[1] == 0xff, wide = big || (size >= 2 && bytes[0] == 0xff && bytes[1] == 0xfe);
	size_t start = wide ? 2 : size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0, step = wide ? 2 : 1;
	char *text = malloc(size + 1);
	*length = 0;
	for (size_t i = start; text && i + step <= size; i += step) {
		uint8_t low = bytes[i + (big ? 1 : 0)], high = wide ? bytes[i + (big ? 0 : 1)] : 0;
		text[(*length)++] = (char)(wide && (high || low == 0 || low > 127) ? '?' : low);
	}
	if (text)
		text[*length] = 0;
	return text;
}

static enum eco_code check_script(const struct track_input *in, struct eco_error *error)
{
	struct eco_camera *camera;
	enum eco_code code = eco_camera_parse(&camera, in->text, in->size, in->path, error);
	eco_camera_free(camera);
	return code;
}

static enum eco_code say_nothing_found(const struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	int why = track->skipped[ECO_TRACK_BAD_NUMBER] ? ECO_TRACK_BAD_NUMBER : ECO_TRACK_NO_POSITION;
	if (!track->skipped[why])
		return eco_fail(error, ECO_BAD_INPUT, "%.250s: no fix found; it was read as %s (another: --format NAME)", in->path,
			eco_track_kinds[track->format].says);
	return eco_fail(error, ECO_BAD_INPUT, "%.250s: read as %s, it has %llu records and no usable fix; %llu of them with %s, the first in "
		"line %u", in->path, eco_track_kinds[track->format].says, (unsigned long long)track->records,
		(unsigned long long)track->skipped[why], eco_track_skip_names[why], track->skipped_line[why]);
}

static enum eco_code read_text(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	enum eco_code code = find_format(in, &track->format, error);
	if (code || track->format == ECO_TRACK_SCRIPT)
		return code ? code : check_script(in, error);
	code = readers[track->format](track, in, error);
	return code || track->count ? code : say_nothing_found(track, in, error);
}

enum eco_code eco_track_parse(struct eco_track *track, const uint8_t *bytes, size_t size, const char *path,
	const struct eco_track_options *options, struct eco_error *error)
{
	static const struct eco_track_options none;
	struct track_input in = { .path = path, .options = options ? options : &none };
	struct eco_error cause = { 0 };
	*track = (struct eco_track){ 0 };
	char *text = text_of(bytes, size, &in.size);
	in.text = text;
	enum eco_code code = text ? read_text(track, &in, &cause) : eco_fail(&cause, ECO_NO_MEMORY, "no memory for it");
	free(text);
	if (!code)
		return ECO_OK;
	eco_track_free(track);
	return strstr(cause.text, path) || strlen(path) > 200 ? eco_fail(error, cause.code, "%s", cause.text) :
		eco_fail(error, cause.code, "%s: %.300s", path, cause.text);
}

/* ---- In a child ---- */

struct job { const char *path; const struct eco_track_options *options; uint64_t size; };

static enum eco_code read_in_child(void *ctx, FILE *out, struct eco_error *error)
{
	const struct job *job = ctx;
	struct eco_track *track = calloc(1, sizeof *track);
	uint8_t *bytes = malloc(job->size + 1);
	FILE *file = fopen(job->path, "rb");
	size_t size = file && bytes ? fread(bytes, 1, job->size, file) : 0;
	enum eco_code code = !bytes || !track ? eco_fail(error, ECO_NO_MEMORY, "%.300s: no memory for it", job->path) :
		!file || ferror(file) ? eco_fail(error, ECO_IO, "%.300s: %s", job->path, strerror(errno)) :
		eco_track_parse(track, bytes, size, job->path, job->options, error);
	if (!code && (fwrite(track, sizeof *track, 1, out) != 1 || fwrite(track->fixes, sizeof *track->fixes, track->count, out) != track->count))
		code = eco_fail(error, ECO_IO, "%.300s: %s", job->path, strerror(errno));
	if (file)
		fclose(file);
	if (track)
		eco_track_free(track);
	free(track);
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

enum eco_code eco_track_read(struct eco_track *track, const char *path, const struct eco_track_options *options, struct eco_error *error)
{
	struct job job = { .path = path, .options = options };
	struct stat status;
	struct eco_error cause = { 0 };
	FILE *from;
	*track = (struct eco_track){ 0 };
	if (stat(path, &status) != 0)
		return eco_fail(error, ECO_IO, "%.300s: %s", path, strerror(errno));
	if (!S_ISREG(status.st_mode))
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: this is no file%s", path, S_ISDIR(status.st_mode) ? " but a folder" : "");
	if (status.st_size > (off_t)ECO_TRACK_BYTES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: a track has at most %u bytes", path, ECO_TRACK_BYTES_MAX);
	job.size = (uint64_t)status.st_size;
	struct eco_guard_limits limits = eco_guard_limits_for(job.size);
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
