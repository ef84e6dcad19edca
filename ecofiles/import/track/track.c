/* Which reader a file is for, by what it holds, and the readers' common ground: fixes are checked where they
 * are taken, so that no reader can let an impossible one through. */
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/room.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/track/track_read.h"

#define METRES_MAX 1e9
#define HEIGHT_MAX_M 1e5
#define SECONDS_MAX 1e11
#define HEAD_BYTES 4096u

static const char *const format_names[ECO_TRACK_FORMATS] = { "a drone's subtitles (SRT)", "GPX", "KML",
	"GeoJSON", "CSV", "a glTF camera", "a camera script" };

static track_reader *const readers[ECO_TRACK_FORMATS] = { track_read_srt, track_read_rows, track_read_rows,
	track_read_rows, track_read_rows, track_read_gltf, NULL };

/* ---- Fixes ---- */

struct eco_fix track_fix(uint32_t line)
{
	struct eco_fix fix = { .line = line };
	for (int i = 0; i < ECO_FIX_NUMBERS; i++)
		fix.n[i] = NAN;
	return fix;
}

/* Whether it has a place on Earth, or in its metres; longitudes up to 360 are brought below 180. A receiver
 * without a fix writes 0, 0. */
static bool check_position(bool degrees, double at[3])
{
	at[0] -= degrees && at[0] > 180 && at[0] <= 360 ? 360 : 0;
	return fabs(at[0]) <= (degrees ? 180 : METRES_MAX) && fabs(at[1]) <= (degrees ? 90 : METRES_MAX)
		&& !(degrees && at[0] == 0 && at[1] == 0);
}

enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error)
{
	const double most[ECO_FIX_NUMBERS] = { SECONDS_MAX, METRES_MAX, METRES_MAX,
		track->degrees ? HEIGHT_MAX_M : METRES_MAX, HEIGHT_MAX_M, 1e6, 180, 360, 179 };
	struct eco_fix f = *fix;
	track->records++;
	if (!check_position(track->degrees, f.at)) {
		track->skipped_line = track->skipped++ ? track->skipped_line : f.line;
		return ECO_OK;
	}
	if (track->count == ECO_TRACK_FIXES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u fixes", ECO_TRACK_FIXES_MAX);
	if (!eco_room(&track->fixes, &track->capacity, track->count, sizeof f))
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u fixes", track->count);
	for (int i = 0; i < ECO_FIX_NUMBERS; i++)
		f.n[i] = fabs(f.n[i]) <= most[i] ? f.n[i] : NAN;
	f.fov_y_deg = f.fov_y_deg > 0.01 ? f.fov_y_deg : NAN;
	track->timed |= !isnan(f.time_s);
	track->fixes[track->count++] = f;
	return ECO_OK;
}

void eco_track_note(void *of, const char *format, ...)
{
	struct eco_track *track = of;
	va_list args;
	va_start(args, format);
	if (track->notes && vfprintf(track->notes, format, args) >= 0)
		putc('\n', track->notes);
	va_end(args);
}

void eco_track_free(struct eco_track *track)
{
	free(track->fixes);
	*track = (struct eco_track){ 0 };
}

/* ---- What a file is ---- */

static enum eco_code json_format(const struct track_input *in, enum eco_track_format *format,
	struct eco_error *error)
{
	json_error_t problem;
	json_t *root = json_loadb(in->text, in->size, JSON_DECODE_INT_AS_REAL, &problem);
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s:%d:%d: %s", in->path, problem.line,
			problem.column, problem.text);
	*format = json_object_get(root, "keyframes") ? ECO_TRACK_SCRIPT
		: json_is_object(json_object_get(root, "asset")) ? ECO_TRACK_GLTF
		: json_is_string(json_object_get(root, "type")) ? ECO_TRACK_GEOJSON : ECO_TRACK_FORMATS;
	json_decref(root);
	return *format < ECO_TRACK_FORMATS ? ECO_OK : eco_fail(error, ECO_UNSUPPORTED,
		"%.300s: JSON, but no track that is known: no GeoJSON (\"type\"), no glTF (\"asset\"), no "
		"camera script (\"keyframes\")", in->path);
}

/* ECO_TRACK_FORMATS: XML that is none of them. */
static enum eco_track_format text_format(const struct track_input *in)
{
	char head[HEAD_BYTES + 1];
	snprintf(head, sizeof head, "%.*s", (int)HEAD_BYTES, in->text);
	if (head[strspn(head, " \t\r\n")] == '<')
		return strcasestr(head, "<gpx") ? ECO_TRACK_GPX : strcasestr(head, "<kml") ? ECO_TRACK_KML
			: ECO_TRACK_FORMATS;
	bool subtitles = strstr(head, " --> ") || strcasestr(head, "[latitude") || strcasestr(head, "HOME(")
		|| eco_path_ends_with(in->path, ".srt");
	return subtitles ? ECO_TRACK_SRT : ECO_TRACK_CSV;
}

/* By content, then by the name's end. */
static enum eco_code find_format(struct track_input *in, enum eco_track_format *format,
	struct eco_error *error)
{
	size_t blank = strspn(in->text, " \t\r\n"), head = in->size < HEAD_BYTES ? in->size : HEAD_BYTES;
	enum eco_code code = eco_file_check_head(in->path, in->text, blank < in->size ? in->size : 0, false,
		"a track", error);
	*format = ECO_TRACK_GLTF;
	if (code || strncmp(in->text, "glTF", 4) == 0)
		return code;
	if (memchr(in->text, 0, head))
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: this is binary, or text in UTF-16. "
			TRACK_FORMATS, in->path);
	if (in->text[blank] == '{')
		return json_format(in, format, error);
	/* a recorder that lost power leaves blocks of zeros */
	for (char *zero = in->text; (zero = memchr(zero, 0, in->size - (size_t)(zero - in->text))) != NULL; )
		*zero = ' ';
	*format = text_format(in);
	return *format < ECO_TRACK_FORMATS ? ECO_OK : eco_fail(error, ECO_UNSUPPORTED,
		"%.300s: XML, but neither GPX nor KML. " TRACK_FORMATS, in->path);
}

/* ---- Reading ---- */

static enum eco_code read_text(struct eco_track *track, struct track_input *in, struct eco_error *error)
{
	enum eco_code code = find_format(in, &track->format, error);
	if (code || track->format == ECO_TRACK_SCRIPT)
		return code;
	const char *name = format_names[track->format];
	eco_track_note(track, "%s: read as %s", in->path, name);
	code = readers[track->format](track, in, error);
	if (code || track->count)
		return code;
	return !track->skipped ? eco_fail(error, ECO_BAD_INPUT, "%.250s: no fix found; it was read as %s. "
		TRACK_FORMATS, in->path, name) : eco_fail(error, ECO_BAD_INPUT, "%.250s:%u: read as %s, it "
		"has %llu records and no usable fix: no position, or one that cannot be", in->path,
		track->skipped_line, name, (unsigned long long)track->records);
}

enum eco_code eco_track_read(struct eco_track *track, const char *path, struct eco_error *error)
{
	struct eco_error cause = { 0 };
	uint8_t *bytes;
	struct track_input in = { .path = path };
	*track = (struct eco_track){ .notes = track->notes };
	enum eco_code code = eco_file_read(path, ECO_TRACK_BYTES_MAX, &bytes, &in.size, &cause);
	if (!code) {
		size_t mark = in.size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
		in.text = (char *)bytes + mark;
		in.size -= mark;
		code = read_text(track, &in, &cause);
	}
	free(bytes);
	if (!code)
		return ECO_OK;
	eco_track_free(track);
	bool named = strstr(cause.text, path) || strlen(path) > 200;
	return eco_fail(error, cause.code, "%.300s%s%s", named ? "" : path, named ? "" : ": ", cause.text);
}
