/* Which reader a file is for, by what it holds, and the readers' common ground: fixes are checked where they
 * are taken, so that no reader can let an impossible one through. */
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/track/track_read.h"

#define METRES_MAX 1e9
#define HEIGHT_MAX_M 1e5
#define SECONDS_MAX 1e11
#define HEAD_BYTES 4096u

static const struct { const char *name; track_reader *read; } formats[ECO_TRACK_FORMATS] = {
	{ "a drone's subtitles (SRT)", track_read_srt }, { "GPX", track_read_rows },
	{ "KML", track_read_rows }, { "GeoJSON", track_read_rows }, { "CSV", track_read_rows },
	{ "a glTF camera", track_read_gltf }, { "a camera script", NULL } };

/* ---- Fixes ---- */

/* Longitudes up to 360 are brought below 180. A receiver without a fix writes 0, 0. */
enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error)
{
	const bool degrees = track->degrees;
	const double most[ECO_FIX_NUMBERS] = { SECONDS_MAX, degrees ? 180 : METRES_MAX,
		degrees ? 90 : METRES_MAX, degrees ? HEIGHT_MAX_M : METRES_MAX, HEIGHT_MAX_M, 1e6, 180, 360,
		179 };
	struct eco_fix f = *fix;
	track->records++;
	f.at[0] -= degrees && f.at[0] > 180 && f.at[0] <= 360 ? 360 : 0;
	for (int i = 0; i < ECO_FIX_NUMBERS; i++)
		f.n[i] = fabs(f.n[i]) <= most[i] ? f.n[i] : NAN;
	f.fov_y_deg = f.fov_y_deg > 0.01 ? f.fov_y_deg : NAN;
	if (isnan(f.at[0] + f.at[1]) || (degrees && f.at[0] == 0 && f.at[1] == 0)) {
		track->skipped_line = track->skipped++ ? track->skipped_line : f.line;
		return ECO_OK;
	}
	if (track->count == ECO_TRACK_FIXES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: more than %u fixes", track->path,
			ECO_TRACK_FIXES_MAX);
	if (!eco_array_grow(&track->fixes, &track->capacity, track->count, sizeof f))
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: no memory for %u fixes", track->path,
			track->count);
	track->timed |= !isnan(f.time_s);
	track->fixes[track->count++] = f;
	return ECO_OK;
}

void eco_track_note(void *of, const char *format, ...)
{
	const struct eco_track *track = of;
	va_list args;
	va_start(args, format);
	if (track->notes && vfprintf(track->notes, format, args) >= 0)
		putc('\n', track->notes);
	va_end(args);
}

void eco_track_free(struct eco_track *track)
{
	free(track->fixes);
	free(track->text);
	*track = (struct eco_track){ 0 };
}

/* ---- What a file is: by content, then by the name's end ---- */

static enum eco_code find_json(struct eco_track *track, struct eco_error *error)
{
	json_error_t problem;
	json_t *root = json_loadb(track->text, track->size, JSON_DECODE_INT_AS_REAL, &problem);
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s:%d:%d: %s", track->path, problem.line,
			problem.column, problem.text);
	track->format = json_object_get(root, "keyframes") ? ECO_TRACK_SCRIPT
		: json_is_object(json_object_get(root, "asset")) ? ECO_TRACK_GLTF
		: json_is_string(json_object_get(root, "type")) ? ECO_TRACK_GEOJSON : ECO_TRACK_FORMATS;
	json_decref(root);
	return track->format < ECO_TRACK_FORMATS ? ECO_OK : eco_fail(error, ECO_UNSUPPORTED,
		"%.300s: JSON, but no track that is known: no GeoJSON (\"type\"), no glTF (\"asset\"), no "
		"camera script (\"keyframes\")", track->path);
}

static enum eco_code find_text(struct eco_track *track, struct eco_error *error)
{
	char head[HEAD_BYTES + 1];
	/* a recorder that lost power leaves blocks of zeros */
	for (size_t i = 0; (i += strlen(track->text + i)) < track->size; )
		track->text[i] = ' ';
	snprintf(head, sizeof head, "%.*s", (int)HEAD_BYTES, track->text);
	bool subtitles = strstr(head, " --> ") || strcasestr(head, "[latitude") || strcasestr(head, "HOME(")
		|| eco_path_ends_with(track->path, ".srt");
	track->format = head[strspn(head, " \t\r\n")] != '<' ? subtitles ? ECO_TRACK_SRT : ECO_TRACK_CSV
		: strcasestr(head, "<gpx") ? ECO_TRACK_GPX : strcasestr(head, "<kml") ? ECO_TRACK_KML
		: ECO_TRACK_FORMATS;
	return track->format < ECO_TRACK_FORMATS ? ECO_OK : eco_fail(error, ECO_UNSUPPORTED,
		"%.300s: XML, but neither GPX nor KML. " TRACK_FORMATS, track->path);
}

static enum eco_code find_format(struct eco_track *track, struct eco_error *error)
{
	size_t blank = strspn(track->text, " \t\r\n"), length = strlen(track->text);
	enum eco_code code = eco_file_check_head(track->path, track->text, blank < track->size ? track->size
		: 0, false, "a track", error);
	track->format = ECO_TRACK_GLTF;
	if (code || strncmp(track->text, "glTF", 4) == 0)
		return code;
	if (length < track->size && length < HEAD_BYTES)
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is binary, or text in UTF-16. "
			TRACK_FORMATS, track->path);
	return track->text[blank] == '{' ? find_json(track, error) : find_text(track, error);
}

static enum eco_code read_text(struct eco_track *track, struct eco_error *error)
{
	enum eco_code code = find_format(track, error);
	if (code || track->format == ECO_TRACK_SCRIPT)
		return code;
	const char *name = formats[track->format].name;
	eco_track_note(track, "%s: read as %s", track->path, name);
	code = formats[track->format].read(track, error);
	if (code || track->count)
		return code;
	return !track->skipped ? eco_fail(error, ECO_BAD_INPUT, "%.250s: no fix found; it was read as %s. "
		TRACK_FORMATS, track->path, name) : eco_fail(error, ECO_BAD_INPUT, "%.250s:%u: read as %s, "
		"it has %u record%s and no usable fix: no position, or one that cannot be; a track is made of "
		"points, or of lines that are single, in longitude and latitude (--track-crs: in metres)",
		track->path, track->skipped_line, name, track->records, track->records == 1 ? "" : "s");
}

enum eco_code eco_track_read(struct eco_track *track, const char *path, struct eco_error *error)
{
	uint8_t *bytes;
	*track = (struct eco_track){ .notes = track->notes, .path = path };
	enum eco_code code = eco_file_read(path, ECO_TRACK_BYTES_MAX, &bytes, &track->size, error);
	track->text = (char *)bytes;
	if (!code && strncmp(track->text, "\xef\xbb\xbf", 3) == 0) {
		memmove(track->text, track->text + 3, track->size - 2);
		track->size -= 3;
	}
	code = code ? code : read_text(track, error);
	if (code)
		eco_track_free(track);
	return code;
}
