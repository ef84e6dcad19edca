/* Which reader a file is for, by what it holds, and the readers' common ground: fixes are checked where they are taken, so that no
 * reader can let an impossible one through. Reading happens in a child process; what it hands back is checked once more. */
#include "ecofiles/import/track/track.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/import/track/track_read.h"

#define METRES_MAX 1e9
#define HEIGHT_MAX_M 1e5
#define SECONDS_MAX 1e11

const struct eco_track_kind eco_track_kinds[ECO_TRACK_FORMATS] = {
	[ECO_TRACK_SRT] = { "srt", "a drone's subtitles (SRT)" },
	[ECO_TRACK_IGC] = { "igc", "a glider's log (IGC)" },
	[ECO_TRACK_NMEA] = { "nmea", "a GPS receiver's sentences (NMEA 0183)" },
	[ECO_TRACK_GPX] = { "gpx", "GPX" },
	[ECO_TRACK_KML] = { "kml", "KML" },
	[ECO_TRACK_TCX] = { "tcx", "TCX" },
	[ECO_TRACK_GEOJSON] = { "geojson", "GeoJSON" },
	[ECO_TRACK_CSV] = { "csv", "CSV" },
	[ECO_TRACK_TRANSFORMS] = { "transforms", "camera poses (transforms.json)" },
	[ECO_TRACK_CAMERA_PATH] = { "camera_path", "a camera path (nerfstudio)" },
	[ECO_TRACK_COLMAP] = { "colmap", "camera poses (COLMAP images.txt)" },
	[ECO_TRACK_TUM] = { "tum", "poses with times and quaternions (TUM)" },
	[ECO_TRACK_KITTI] = { "kitti", "poses as matrices (KITTI)" },
	[ECO_TRACK_GLTF] = { "gltf", "a glTF camera" },
	[ECO_TRACK_SCRIPT] = { "script", "a camera script" },
};

static track_reader *const readers[ECO_TRACK_FORMATS] = {
	[ECO_TRACK_SRT] = track_read_srt, [ECO_TRACK_IGC] = track_read_igc, [ECO_TRACK_NMEA] = track_read_nmea, [ECO_TRACK_GPX] = track_read_xml,
	[ECO_TRACK_KML] = track_read_xml, [ECO_TRACK_TCX] = track_read_xml, [ECO_TRACK_GEOJSON] = track_read_json, [ECO_TRACK_CSV] = track_read_csv,
	[ECO_TRACK_TRANSFORMS] = track_read_json, [ECO_TRACK_CAMERA_PATH] = track_read_json, [ECO_TRACK_COLMAP] = track_read_colmap,
	[ECO_TRACK_TUM] = track_read_tum, [ECO_TRACK_KITTI] = track_read_kitti, [ECO_TRACK_GLTF] = track_read_gltf,
	[ECO_TRACK_SCRIPT] = track_read_json,
};

const char *const eco_track_skip_names[ECO_TRACK_SKIPS] = {
	[ECO_TRACK_NO_POSITION] = "no position",
	[ECO_TRACK_BAD_NUMBER] = "a position that cannot be",
	[ECO_TRACK_BAD_CHECKSUM] = "a wrong checksum",
};

/* ---- Fixes ---- */

struct eco_fix track_fix(uint32_t line)
{
	return (struct eco_fix){ .time_s = NAN, .at = { NAN, NAN, NAN }, .above_m = NAN, .yaw_deg = NAN, .pitch_deg = NAN, .roll_deg = NAN,
		.fov_y_deg = NAN, .line = line };
}

void track_skip(struct eco_track *track, enum eco_track_skip why, uint32_t line)
{
	track->records++;
	if (track->skipped[why]++ == 0)
		track->skipped_line[why] = line;
}

static double within(double value, double most)
{
	return value >= -most && value <= most ? value : NAN;
}

/* Whether it has a place on Earth, or in its metres; longitudes up to 360 are brought below 180. */
static bool check_position(const struct eco_track *track, double at[3])
{
	if (!track->degrees)
		return fabs(at[0]) <= METRES_MAX && fabs(at[1]) <= METRES_MAX;
	if (at[0] > 180 && at[0] <= 360)
		at[0] -= 360;
	return fabs(at[0]) <= 180 && fabs(at[1]) <= 90;
}

enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error)
{
	struct eco_fix f = *fix;
	if (isnan(f.at[0]) || isnan(f.at[1]) || (track->degrees && f.at[0] == 0 && f.at[1] == 0)) {
		track_skip(track, ECO_TRACK_NO_POSITION, f.line);
		return ECO_OK;
	}
	if (!check_position(track, f.at)) {
		track_skip(track, ECO_TRACK_BAD_NUMBER, f.line);
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
	track->records++;
	track->fixes[track->count++] = f;
	return ECO_OK;
}

void eco_track_note(struct eco_track *track, const char *format, ...)
{
	va_list args;
	if (track->note_count == ECO_TRACK_NOTES_MAX) {
		snprintf(track->notes[ECO_TRACK_NOTES_MAX - 1], ECO_TRACK_NOTE_BYTES, "there is more to say of this file");
		return;
	}
	va_start(args, format);
	vsnprintf(track->notes[track->note_count++], ECO_TRACK_NOTE_BYTES, format, args);
	va_end(args);
}

void eco_track_free(struct eco_track *track)
{
	free(track->fixes);
	*track = (struct eco_track){ 0 };
}

/* ---- What a file is ---- */

static bool has(const struct track_input *in, size_t within_bytes, const char *word)
{
	return track_find(in->text, in->text + (in->size < within_bytes ? in->size : within_bytes), word) != NULL;
}

/* Files that people try, and what to do instead; NULL: it may be a track. */
static const char *no_track(const struct track_input *in)
{
	static const struct { size_t at; const char *magic, *says; } kinds[] = {
		{ 0, "PK\3\4", "a zip archive; unzip it (a KMZ holds doc.kml) and name the file inside" },
		{ 8, ".FIT", "a FIT file, which is binary; save it as GPX or TCX" },
		{ 4, "ftyp", "a film; name the .SRT file that the drone wrote beside it" },
		{ 0, "\x89PNG", "a picture" }, { 0, "\xff\xd8\xff", "a picture" },
		{ 0, "ECOPACK", "a pack, not a track" },
		{ 0, "\x1f\x8b", "compressed; unpack it with gunzip" }, { 0, "\xfd" "7zXZ", "compressed; unpack it with unxz" },
		{ 0, "SQLite", "a database; save its track as CSV or GPX" },
	};
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (in->size >= kinds[i].at + strlen(kinds[i].magic) && memcmp(in->text + kinds[i].at, kinds[i].magic, strlen(kinds[i].magic)) == 0)
			return kinds[i].says;
	return NULL;
}

/* Numbers in the first line that is no comment, if it holds nothing else; a comment with commas before it names columns. */
static int count_numbers(const struct track_input *in)
{
	struct track_line line = { 0 };
	while (track_next_line(in, &line)) {
		const char *at = line.text;
		double value;
		int count = 0;
		if (*line.text == '#' && memchr(line.text, ',', (size_t)(line.end - line.text)))
			return 0;
		if (line.text == line.end || *line.text == '#')
			continue;
		while (count < 100 && track_number(&at, line.end, &value)) {
			count++;
			while (at < line.end && strchr(" \t,", *at))
				at++;
		}
		return at == line.end ? count : 0;
	}
	return 0;
}

static bool has_igc_fix(const struct track_input *in)
{
	struct track_line line = { 0 };
	while (track_next_line(in, &line) && line.number < 2000)
		if (*line.text == 'B' && line.end - line.text >= 24 && track_digits(line.text + 1, line.end, 6) >= 0 &&
			strchr("NS", line.text[14]) && strchr("EW", line.text[23]))
			return true;
	return false;
}

static bool has_nmea_sentence(const struct track_input *in)
{
	struct track_line line = { 0 };
	while (track_next_line(in, &line) && line.number < 200) {
		const char *at = memchr(line.text, '$', (size_t)(line.end - line.text));
		if (at && line.end - at > 7 && at[6] == ',' && (track_starts(at + 3, line.end, "GGA") || track_starts(at + 3, line.end, "RMC")))
			return true;
	}
	return false;
}

static bool by_content(const struct track_input *in, enum eco_track_format *format)
{
	size_t start = strspn(in->text, " \t\r\n");
	char first = in->text[start];
	int numbers = count_numbers(in);
	if (in->size >= 4 && memcmp(in->text, "glTF", 4) == 0)
		*format = ECO_TRACK_GLTF;
	else if (first == '<' && (has(in, 4096, "<gpx") || has(in, 4096, "<kml") || has(in, 4096, "<TrainingCenterDatabase") || has(in, 64, "<?xml")))
		*format = ECO_TRACK_GPX;
	else if (first == '{' || (first == '[' && strchr(" \t\r\n{[", in->text[start + 1])))
		*format = ECO_TRACK_GEOJSON;
	else if (has_igc_fix(in))
		*format = ECO_TRACK_IGC;
	else if (has_nmea_sentence(in))
		*format = ECO_TRACK_NMEA;
	else if (has(in, 4096, " --> ") || has(in, 4096, "[latitude") || has(in, 4096, "HOME("))
		*format = ECO_TRACK_SRT;
	else if (has(in, 4096, "QW, QX, QY, QZ, TX, TY, TZ"))
		*format = ECO_TRACK_COLMAP;
	else if (numbers == 8)
		*format = ECO_TRACK_TUM;
	else if (numbers == 12 || numbers == 13 || numbers == 16 || numbers == 17)
		*format = ECO_TRACK_KITTI;
	else
		return false;
	return true;
}

static bool by_extension(const char *path, enum eco_track_format *format)
{
	static const struct { const char *end; enum eco_track_format format; } ends[] = {
		{ ".srt", ECO_TRACK_SRT }, { ".vtt", ECO_TRACK_SRT }, { ".igc", ECO_TRACK_IGC }, { ".nmea", ECO_TRACK_NMEA }, { ".gpx", ECO_TRACK_GPX },
		{ ".kml", ECO_TRACK_KML }, { ".tcx", ECO_TRACK_TCX }, { ".geojson", ECO_TRACK_GEOJSON }, { ".json", ECO_TRACK_GEOJSON },
		{ ".csv", ECO_TRACK_CSV }, { ".tsv", ECO_TRACK_CSV }, { ".glb", ECO_TRACK_GLTF }, { ".gltf", ECO_TRACK_GLTF },
		{ "images.txt", ECO_TRACK_COLMAP }, { ".tum", ECO_TRACK_TUM },
	};
	size_t length = strlen(path);
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		size_t n = strlen(ends[i].end);
		if (length >= n && track_starts(path + length - n, path + length, ends[i].end)) {
			*format = ends[i].format;
			return true;
		}
	}
	return false;
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
		return eco_fail(error, ECO_BAD_USAGE, "no format is called %.40s; there are srt, igc, nmea, gpx, kml, tcx, geojson, csv, transforms, "
			"camera_path, colmap, tum, kitti and gltf", stated);
	if (no_track(in))
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is %s", in->path, no_track(in));
	if (strspn(in->text, " \t\r\n") >= in->size)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: the file is empty", in->path);
	if (memchr(in->text, 0, in->size < 4096 ? in->size : 4096) && strncmp(in->text, "glTF", 4) != 0)
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is binary and of no kind that is known; save the track as CSV or GPX", in->path);
	/* columns can be told from anything; a format cannot be told from CSV by more than its content */
	if (in->options->columns)
		*format = ECO_TRACK_CSV;
	else if (!by_content(in, format) && !by_extension(in->path, format))
		*format = ECO_TRACK_CSV;
	return ECO_OK;
}

/* ---- Reading ---- */

/* UTF-16, as spreadsheets write "Unicode text": what is no ASCII becomes '?', no name or number that matters has it. */
static char *from_utf16(const uint8_t *bytes, size_t size, bool big, size_t *length)
{
	char *text = malloc(size / 2 + 1);
	*length = 0;
	for (size_t i = 2; text && i + 1 < size; i += 2) {
		uint32_t c = big ? (uint32_t)bytes[i] << 8 | bytes[i + 1] : (uint32_t)bytes[i + 1] << 8 | bytes[i];
		text[(*length)++] = c > 0 && c < 128 ? (char)c : '?';
	}
	if (text)
		text[*length] = 0;
	return text;
}

/* With a 0 behind it and without a byte order mark. */
static char *text_of(const uint8_t *bytes, size_t size, size_t *length)
{
	if (size >= 2 && ((bytes[0] == 0xff && bytes[1] == 0xfe) || (bytes[0] == 0xfe && bytes[1] == 0xff)))
		return from_utf16(bytes, size, bytes[0] == 0xfe, length);
	size_t start = size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	char *text = malloc(size - start + 1);
	if (!text)
		return NULL;
	*length = size - start;
	if (*length)
		memcpy(text, bytes + start, *length);
	text[*length] = 0;
	return text;
}

static enum eco_code say_nothing_found(const struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	uint64_t left = 0;
	for (int i = 0; i < ECO_TRACK_SKIPS; i++)
		left += track->skipped[i];
	if (!left)
		return eco_fail(error, ECO_BAD_INPUT, "%.250s: no fix found; it was read as %s (another: --format NAME)", in->path,
			eco_track_kinds[track->format].says);
	int why = track->skipped[ECO_TRACK_BAD_NUMBER] ? ECO_TRACK_BAD_NUMBER : track->skipped[ECO_TRACK_NO_POSITION] ? ECO_TRACK_NO_POSITION :
		ECO_TRACK_BAD_CHECKSUM;
	return eco_fail(error, ECO_BAD_INPUT, "%.250s: read as %s, it has %llu records and no usable fix; %llu of them with %s, the first in line %u",
		in->path, eco_track_kinds[track->format].says, (unsigned long long)track->records, (unsigned long long)track->skipped[why],
		eco_track_skip_names[why], track->skipped_line[why]);
}

enum eco_code eco_track_parse(struct eco_track *track, const uint8_t *bytes, size_t size, const char *path,
	const struct eco_track_options *options, struct eco_error *error)
{
	static const struct eco_track_options none;
	struct track_input in = { .path = path, .options = options ? options : &none };
	struct eco_error cause = { 0 };
	*track = (struct eco_track){ 0 };
	char *text = text_of(bytes, size, &in.size);
	if (!text)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: no memory for it", path);
	in.text = text;
	enum eco_code code = find_format(&in, &track->format, &cause);
	if (!code)
		code = readers[track->format](track, &in, &cause);
	if (!code && track->count == 0 && track->format != ECO_TRACK_SCRIPT)
		code = say_nothing_found(track, &in, &cause);
	free(text);
	if (!code)
		return ECO_OK;
	eco_track_free(track);
	return strstr(cause.text, path) || strlen(path) > 200 ? eco_fail(error, cause.code, "%s", cause.text) :
		eco_fail(error, cause.code, "%s: %.300s", path, cause.text);
}

/* ---- In a child ---- */

struct handed {                          /* a track without its fixes, as plain numbers */
	uint32_t format, degrees, timed, posed, has_home, count, note_count, skipped_line[ECO_TRACK_SKIPS];
	double home[3];
	uint64_t records, skipped[ECO_TRACK_SKIPS];
	char notes[ECO_TRACK_NOTES_MAX][ECO_TRACK_NOTE_BYTES];
};

struct job { const char *path; const struct eco_track_options *options; uint64_t size; };

static enum eco_code read_bytes(const struct job *job, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	FILE *file = fopen(job->path, "rb");
	if (!file)
		return eco_fail(error, ECO_IO, "%.300s: %s", job->path, strerror(errno));
	*bytes = malloc(job->size + 1);
	*size = *bytes ? fread(*bytes, 1, job->size, file) : 0;
	enum eco_code code = !*bytes ? eco_fail(error, ECO_NO_MEMORY, "%.300s: no memory for it", job->path) :
		ferror(file) ? eco_fail(error, ECO_IO, "%.300s: %s", job->path, strerror(errno)) : ECO_OK;
	fclose(file);
	return code;
}

static enum eco_code read_in_child(void *ctx, FILE *out, struct eco_error *error)
{
	const struct job *job = ctx;
	struct eco_track track = { 0 };
	struct handed *h = calloc(1, sizeof *h);
	uint8_t *bytes = NULL;
	size_t size = 0;
	enum eco_code code = h ? read_bytes(job, &bytes, &size, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (!code)
		code = eco_track_parse(&track, bytes, size, job->path, job->options, error);
	if (!code) {
		*h = (struct handed){ .format = track.format, .degrees = track.degrees, .timed = track.timed, .posed = track.posed,
			.has_home = track.has_home, .count = track.count, .note_count = track.note_count, .records = track.records };
		memcpy(h->home, track.home, sizeof h->home);
		memcpy(h->skipped, track.skipped, sizeof h->skipped);
		memcpy(h->skipped_line, track.skipped_line, sizeof h->skipped_line);
		memcpy(h->notes, track.notes, sizeof h->notes);
		if (fwrite(h, sizeof *h, 1, out) != 1 || (track.count && fwrite(track.fixes, sizeof *track.fixes, track.count, out) != track.count))
			code = eco_fail(error, ECO_IO, "%.300s: %s", job->path, strerror(errno));
	}
	eco_track_free(&track);
	free(bytes);
	free(h);
	return code;
}

/* The child has read a stranger's file: nothing that it says is believed. */
static bool check_handed(const struct handed *h)
{
	if (h->format >= ECO_TRACK_FORMATS || h->note_count > ECO_TRACK_NOTES_MAX || h->count > ECO_TRACK_FIXES_MAX)
		return false;
	for (uint32_t i = 0; i < h->note_count; i++)
		if (!memchr(h->notes[i], 0, ECO_TRACK_NOTE_BYTES))
			return false;
	return true;
}

static enum eco_code take(struct eco_track *track, const struct handed *h, FILE *from, struct eco_error *error)
{
	*track = (struct eco_track){ .format = (enum eco_track_format)h->format, .degrees = h->degrees != 0, .posed = h->posed != 0,
		.note_count = h->note_count };
	memcpy(track->notes, h->notes, sizeof h->notes);
	track->has_home = h->has_home && isfinite(h->home[0]) && isfinite(h->home[1]) && check_position(track, (double[3]){ h->home[0], h->home[1], 0 });
	memcpy(track->home, h->home, sizeof h->home);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; !code && i < h->count; i++) {
		struct eco_fix fix;
		if (fread(&fix, sizeof fix, 1, from) != 1)
			code = eco_fail(error, ECO_DAMAGED, "its reader gave up in the middle");
		else
			code = track_add(track, &fix, error);
	}
	memcpy(track->skipped, h->skipped, sizeof h->skipped);
	memcpy(track->skipped_line, h->skipped_line, sizeof h->skipped_line);
	track->records = h->records;
	if (!code && track->count == 0 && track->format != ECO_TRACK_SCRIPT)
		code = eco_fail(error, ECO_DAMAGED, "its reader found nothing");
	return code;
}

enum eco_code eco_track_read(struct eco_track *track, const char *path, const struct eco_track_options *options, struct eco_error *error)
{
	static const struct eco_track_options none;
	struct job job = { .path = path, .options = options ? options : &none };
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
	struct handed *h = malloc(sizeof *h);
	if (!h || fread(h, sizeof *h, 1, from) != 1 || !check_handed(h))
		code = eco_fail(&cause, h ? ECO_DAMAGED : ECO_NO_MEMORY, h ? "its reader handed back nonsense" : "out of memory");
	else
		code = take(track, h, from, &cause);
	free(h);
	fclose(from);
	if (!code)
		return ECO_OK;
	eco_track_free(track);
	return eco_fail(error, cause.code, "%.300s: %s", path, cause.text);
}
