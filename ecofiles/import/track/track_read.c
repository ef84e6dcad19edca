/* Which reader a file is for, by what it holds; and the fixes that readers add, which are checked here, so
 * that no reader can let an impossible one through. Subtitles of drones are read here, too: a record is an
 * index, a time line and lines of NAME: VALUE or NAME(VALUE, VALUE, ...), with or without brackets and HTML,
 * in many dialects (all are in test_track.c).
 *
 *   [latitude : 31.45] [longtitude : 74.39] [altitude: 213.9]                     (the misspelling is theirs)
 *   GPS (-58.8517, -34.2379, 15), D 698.70m, H 85.80m, G.PRY (-24.4°, 0.0°, 110.4°)
 *
 * Names are found one by one and not line by line; those of one value are the names of columns, too. The
 * third number of GPS() is the number of satellites if it is whole, the height if it has decimals or "m";
 * drones that write it with "M" mean a precision, and have the latitude first. */
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <ctype.h>
#include <time.h>

#include "build/words/track_columns.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/track/track_read.h"
#include "ecofiles/import/places/rows/rows.h"

#define METRES_MAX 1e9
#define HEIGHT_MAX_M 1e5
#define SECONDS_MAX 1e11
#define HEAD_BYTES 4096u
#define SRT_NAME_BYTES 32
/* Nothing is known of it yet. */
#define TRACK_FIX(at_line) \
	(struct eco_fix){ .n = { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN }, .line = at_line }
#define LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_."      /* of names */

/* The end of messages about files of another kind. */
#define FORMATS \
	"Read are SRT (a drone writes it beside its film), GPX, CSV in UTF-8 and camera scripts; GPSBabel " \
	"converts KML and logs of GPS to GPX"

static const char *const format_names[] = { "a drone's subtitles (SRT)", "GPX", "CSV" };

/* ---- Fixes ---- */

/* Checks and takes: what has no position, or an impossible one, is counted instead. Each call is one record.
 * Longitudes up to 360 are brought below 180. A receiver without a fix writes 0, 0. */
static enum eco_code add_fix(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error)
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
	eco_grow(&track->fixes, &track->capacity, track->count, sizeof f);
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

/* ---- Tables ---- */

#define NAME_BYTES 64u
#define HEADER_ROWS 50u

struct table {
	uint32_t column[TRACK_ROLES];        /* ECO_NONE: none */
	double unit[TRACK_ROLES];            /* NaN: not stated */
	bool degrees;                        /* it has longitudes and latitudes */
};

/* The factor to seconds, metres and degrees; NaN: no unit. */
static double unit_of(const char *text, size_t length)
{
	static const struct { const char *names; double factor; } units[] = {
		{ " s sec seconds m meters metres deg degrees 360 ", 1 }, { " ft feet ", 0.3048 },
		{ " ms msec millisecond milliseconds ", 1e-3 }, { " us ", 1e-6 }, { " ns ", 1e-9 },
		{ " rad radians ", TRACK_DEG } };
	char word[NAME_BYTES];
	snprintf(word, sizeof word, " %.*s ", (int)length, text);
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcasestr(units[i].names, word))
			return units[i].factor;
	return NAN;
}

/* The meaning of one name, as drones' logs and spreadsheets have it; TRACK_ROLES: none. rank: how good a name
 * for it, 0 the best; unit: the factor of what the name states, or NaN. */
static enum track_role role_of(const char *text, uint32_t *rank, double *unit)
{
	_Static_assert(sizeof track_columns_rows / sizeof *track_columns_rows == TRACK_ROLES, "track_columns.tsv has a row for each role");
	char word[NAME_BYTES] = "|";
	const char *end = text + strcspn(text, "(["), *last = end, *at = NULL;
	*unit = *end ? unit_of(end + 1, strcspn(end + 1, ")]")) : NAN;
	while (!*end && last > text && last[-1] != '_' && last[-1] != ' ')
		last--;
	if (!*end && last > text && !isnan(*unit = unit_of(last, (size_t)(end - last))))
		end = last;
	size_t length = 1;
	for (; text < end && length < NAME_BYTES - 2; text++)
		if (isalnum((unsigned char)*text))
			word[length++] = (char)tolower((unsigned char)*text);
	word[length] = '|';
	enum track_role role = 0;
	while (role < TRACK_ROLES && !(at = strstr(track_columns_rows[role].spellings, word)))
		role++;
	*rank = at ? (uint32_t)(at - track_columns_rows[role].spellings) : 0;
	return role;
}

/* False if there is no position among them. */
static bool find_columns(struct table *t, const char *const *columns, uint32_t count)
{
	uint32_t rank, best[TRACK_ROLES];
	double unit;
	for (int role = 0; role < TRACK_ROLES; role++) {
		t->column[role] = best[role] = ECO_NONE;
		t->unit[role] = NAN;
	}
	for (uint32_t c = 0; c < count; c++) {
		enum track_role role = role_of(columns[c], &rank, &unit);
		if (role == TRACK_ROLES || rank >= best[role])
			continue;
		t->column[role] = c;
		t->unit[role] = unit;
		best[role] = rank;
	}
	t->degrees = t->column[TRACK_LON] != ECO_NONE && t->column[TRACK_LAT] != ECO_NONE;
	return t->degrees || (t->column[TRACK_X] != ECO_NONE && t->column[TRACK_Y] != ECO_NONE);
}

/* ---- Numbers, clocks and dates ---- */

/* Each of these moves *text behind what it reads (after spaces), or returns false and leaves it. No "nan". */
static bool take_number(const char **text, double *value)
{
	const char *at = *text + strspn(*text, " \t");
	char *stop = NULL;
	double number = *at && strchr("+-.0123456789", *at) ? strtod(at, &stop) : NAN;
	if (!isfinite(number) || stop == at)
		return false;
	*value = number;
	*text = stop;
	return true;
}

/* 15:19:58.72 or 15:19:58,720,764 or 9:05; seconds since midnight. */
static bool take_clock(const char **text, double *time_s)
{
	unsigned hour, minute, second = 0;
	int used = 0;
	double place = 1;
	if (sscanf(*text, " %4u:%2u%n:%2u%n", &hour, &minute, &used, &second, &used) < 2 || hour > 9999
			|| minute > 59 || second > 60)
		return false;
	*time_s = hour * 3600.0 + minute * 60 + second;
	/* .72 or ,720, or thousandths and millionths: ,720,764 */
	const char *at = *text + used;
	while ((*at == '.' || *at == ',') && isdigit((unsigned char)at[1]))
		for (at++; isdigit((unsigned char)*at); at++)
			*time_s += (place /= 10) * (*at - '0');
	*text = at;
	return true;
}

/* 2020-04-02T15:19:58.720Z, with +02:00, 2020/04/02 15:19:58, 2017.8.5 14:11:51,393,525; without a zone taken
 * for UTC. Seconds since 1970; NaN: none of these. */
static double date_time(const char *text)
{
	static const char *const forms[] = { " %Y-%m-%d", " %Y/%m/%d", " %Y.%m.%d" };
	struct tm day = { 0 }, zone = { 0 };
	double clock_s = 0;
	const char *at = NULL;
	for (int i = 0; i < 3 && !at; i++)
		at = strptime(text, forms[i], &day);
	if (!at || day.tm_year < 1000 - 1900)
		return NAN;
	at += *at && strchr("Tt_", *at);
	take_clock(&at, &clock_s);
	strptime(at, "%z", &zone);
	return (double)(timegm(&day) - zone.tm_gmtoff) + clock_s;
}

/* The whole of the field, or NaN. */
static double number_of(const char *field)
{
	double value;
	return take_number(&field, &value) && !field[strspn(field, " \t")] ? value : NAN;
}

/* Seconds since 1970, or their thousandths, millionths, billionths; a date; a clock, perhaps of a date. */
static double time_of(const char *time, const char *date, double unit)
{
	double time_s = number_of(time), size = fabs(time_s), date_s = date_time(date);
	if (!isnan(time_s))
		return time_s * (!isnan(unit) ? unit : size > 1e17 ? 1e-9 : size > 1e14 ? 1e-6
			: size > 1e11 ? 1e-3 : 1);
	time_s = date_time(time);
	if (!isnan(time_s))
		return time_s;
	return take_clock(&time, &time_s) ? time_s + (isnan(date_s) ? 0 : date_s) : date_s;
}

static struct eco_fix fix_of(const struct table *t, const char *const *fields, uint32_t count, uint32_t line)
{
	struct eco_fix fix = TRACK_FIX(line);
	const char *text[TRACK_ROLES];
	double value[TRACK_ROLES];
	for (int role = 0; role < TRACK_ROLES; role++) {
		text[role] = t->column[role] < count ? fields[t->column[role]] : "";
		value[role] = number_of(text[role]) * (isnan(t->unit[role]) ? 1 : t->unit[role]);
	}
	memcpy(fix.n, value, sizeof fix.n);
	/* ten-millionths of a degree, as autopilots log them */
	for (int i = 0; t->degrees && i < 2; i++)
		fix.at[i] = value[TRACK_LON + i] * (fabs(value[TRACK_LON + i]) > 1000 ? 1e-7 : 1);
	fix.time_s = time_of(text[TRACK_TIME], text[TRACK_DATE], t->unit[TRACK_TIME]);
	return fix;
}

/* ---- Rows ---- */

static enum eco_code read_rows(struct eco_track *track, const struct table *table, struct eco_rows *rows,
	struct eco_error *error)
{
	const struct eco_rows_place *place = &rows->place;
	bool more = true;
	enum eco_code code;
	while (!(code = rows->next(rows, &more, error)) && more) {
		struct eco_fix fix = fix_of(table, rows->fields, rows->field_count, (uint32_t)rows->line);
		if (!rows->has_geometry && *rows->fields[0] == '#')
			continue;
		/* a geometry says more than columns do */
		for (int k = 0; k < 3 && rows->has_geometry; k++)
			fix.at[k] = place->kind == ECO_PLACE_POINT && !isnan(place->at[k]) ? place->at[k]
				: k < 2 ? NAN : fix.at[k];
		if ((code = add_fix(track, &fix, error)))
			return code;
	}
	return code;
}

/* The header is the first row in which a position is found, so that preambles may precede it. */
static enum eco_code find_header(struct table *table, struct eco_rows *rows, const char *path,
	struct eco_error *error)
{
	bool more = true, found = find_columns(table, (const char *const *)rows->columns, rows->column_count);
	enum eco_code code = ECO_OK;
	char list[200];
	eco_rows_list_columns(rows, list, sizeof list);
	while (!code && !found && !rows->has_geometry && more && rows->row < HEADER_ROWS)
		if (!(code = rows->next(rows, &more, error)) && more)
			found = find_columns(table, rows->fields, rows->field_count);
	return code || found || rows->has_geometry ? code : eco_fail(error, ECO_BAD_INPUT, "%.100s: no "
		"format is known that looks like this, and as a table it has no columns for a position; it "
		"begins \"%.60s\". If it is one, name its columns in the first line: t,lon,lat,alt or "
		"t,x,y,z, and yaw,pitch. " FORMATS, path, list);
}

static enum eco_code read_layer(struct eco_track *track, const char *layer, struct eco_error *error)
{
	struct eco_rows_source source = { .path = track->path, .layer = layer, .partial = true };
	struct eco_rows *rows;
	struct table table;
	ECO_PASS(layer ? eco_rows_open_here(&rows, &source, error)
		: eco_rows_open_csv(&rows, track->path, 0, error));
	enum eco_code code = find_header(&table, rows, track->path, error);
	track->degrees = rows->has_geometry ? !rows->degrees_doubted : table.degrees;
	code = code ? code : read_rows(track, &table, rows, error);
	for (uint32_t i = 0; i < rows->note_count; i++)
		eco_track_note(track, "%s", rows->notes[i]);
	eco_rows_close(rows);
	return code;
}

static enum eco_code read_table(struct eco_track *track, struct eco_error *error)
{
	static const char *const layers[] = { "track_points", "route_points", "waypoints" };
	enum eco_code code = ECO_OK;
	if (track->format == ECO_TRACK_CSV)
		return read_layer(track, NULL, error);
	for (int i = 0; !code && !track->count && i < 3; i++)
		code = read_layer(track, layers[i], error);
	if (!strstr(track->text, "</gpx>"))       /* GDAL is silent where a recorder's battery died */
		eco_track_note(track, "the file breaks off: %u points are read", track->records);
	return code;
}

/* ---- Subtitles ---- */

struct values {
	double number[3]; int count; /* NaN: "n/a" */
	char unit;                   /* of the last: what follows it, or '.' for decimals */
};

struct srt {
	struct eco_track *track;
	struct eco_fix fix;          /* the record being read */
	double focal_mm, zoom;       /* of it; as on film of 36 mm width */
	bool open;                   /* it says something */
};

/* Behind a name: `: 1.5`, `(1, 2, 3)`, ` 1.5m`. */
static struct values read_values(const char *text)
{
	struct values v = { .number = { NAN, NAN, NAN } };
	text += strspn(text, " :(");
	for (const char *from = text; v.count < 3 && take_number(&text, &v.number[v.count]); from = ++text) {
		bool decimals = memchr(from, '.', (size_t)(text - from));
		v.unit = *text == 'm' || *text == 'M' ? *text : decimals ? '.' : 0;
		v.count++;
		text += strcspn(text, ",) ]");
		if (*text != ',')
			break;
	}
	return v;
}

/* Takes into the record what a name and its values say. */
static void set_values(struct srt *s, const char *name, const struct values *v)
{
	double *n = s->fix.n, unit;
	uint32_t rank;
	enum track_role role = role_of(name, &rank, &unit);
	if (strcasecmp(name, "gps") == 0 || strcasecmp(name, "rtk") == 0) {
		bool latitude_first = (v->count == 3 && v->unit == 'M') || fabs(v->number[1]) > 90;
		n[TRACK_X] = v->number[latitude_first];
		n[TRACK_Y] = v->number[!latitude_first];
		if (v->count == 3 && (v->unit == 'm' || v->unit == '.'))
			n[TRACK_Z] = v->number[2];
	} else if (strcasecmp(name, "g.pry") == 0) {
		memcpy(n + TRACK_PITCH, v->number, 2 * sizeof *n);
		n[TRACK_YAW] = v->number[2];
	} else if (strcasecmp(name, "focal_len") == 0)       /* 240 is 24.0 mm, 24.00 is too */
		s->focal_mm = v->number[0] / (v->unit == '.' ? 1 : 10);
	else if (strcasecmp(name, "dzoom_ratio") == 0)       /* so are 10000 and 1.00 */
		s->zoom = v->number[0] / (v->number[0] >= 1000 ? 10000 : 1);
	else if (role >= TRACK_Z && role <= TRACK_LAT)
		n[role < TRACK_LON ? role : TRACK_X + (role - TRACK_LON)] = v->number[0];
	else
		return;
	s->open = true;
}

static void read_names(struct srt *s, const char *text)
{
	for (size_t length; *text; text += length + !length) {
		char name[SRT_NAME_BYTES];
		length = strspn(text, LETTERS);
		if (!length || length >= SRT_NAME_BYTES)
			continue;
		snprintf(name, sizeof name, "%.*s", (int)length, text);
		struct values v = read_values(text + length);
		set_values(s, name, &v);
	}
}

static enum eco_code close_record(struct srt *s, uint32_t next_line, struct eco_error *error)
{
	double mm = s->focal_mm * (s->zoom > 0 ? s->zoom : 1);
	if (mm >= 8 && mm <= 3000)           /* films are 16 : 9 */
		s->fix.fov_y_deg = 2 * atan(36.0 * 9 / 16 / 2 / mm) * TRACK_DEG;
	enum eco_code code = s->open ? add_fix(s->track, &s->fix, error) : ECO_OK;
	*s = (struct srt){ .track = s->track, .fix = TRACK_FIX(next_line) };
	return code;
}

static enum eco_code read_srt(struct eco_track *track, struct eco_error *error)
{
	struct srt s = { .track = track, .fix = TRACK_FIX(1) };
	enum eco_code code = ECO_OK;
	uint32_t line = 1;
	char *rest = track->text;
	track->degrees = true;
	for (const char *text; !code && (text = strsep(&rest, "\n")); line++) {
		const char *at = text;
		double time_s = NAN;
		size_t digits = strspn(at, "0123456789");
		bool index = digits && !at[digits + strspn(at + digits, " \t\r")];
		/* 00:00:00,016 --> 00:00:00,033 */
		if (index || (take_clock(&at, &time_s) && strstr(at, "-->"))) {
			code = close_record(&s, line, error);
			s.fix.time_s = time_s;
		} else
			read_names(&s, text);
	}
	return code ? code : close_record(&s, 0, error);
}

/* ---- What a file is: by content, then by the name's end ---- */

static enum eco_code refuse(const struct eco_track *track, const char *is, struct eco_error *error)
{
	return eco_fail(error, ECO_UNSUPPORTED, "%.300s: %s. " FORMATS, track->path, is);
}

static enum eco_code find_json(struct eco_track *track, struct eco_error *error)
{
	json_error_t problem;
	json_t *root = json_loadb(track->text, track->size, JSON_DECODE_INT_AS_REAL, &problem);
	bool is_script = json_object_get(root, "keyframes");
	track->format = ECO_TRACK_SCRIPT;
	json_decref(root);
	if (!root)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s:%d:%d: %s", track->path, problem.line,
			problem.column, problem.text);
	return is_script ? ECO_OK
			 : refuse(track, "JSON, but no camera script: it has no \"keyframes\"", error);
}

static enum eco_code find_text(struct eco_track *track, struct eco_error *error)
{
	char head[HEAD_BYTES + 1];
	/* a recorder that lost power leaves blocks of zeros */
	for (size_t i = 0; (i += strlen(track->text + i)) < track->size; )
		track->text[i] = ' ';
	snprintf(head, sizeof head, "%.*s", (int)HEAD_BYTES, track->text);
	bool subtitles = strstr(head, " --> ") || strcasestr(head, "[latitude") || strcasestr(head, "HOME(")
		|| eco_path_ends_with(track->path, ".srt"), xml = head[strspn(head, " \t\r\n")] == '<';
	track->format = xml ? ECO_TRACK_GPX : subtitles ? ECO_TRACK_SRT : ECO_TRACK_CSV;
	return !xml || strcasestr(head, "<gpx") ? ECO_OK : refuse(track, "XML, but no GPX", error);
}

static enum eco_code find_format(struct eco_track *track, struct eco_error *error)
{
	size_t blank = strspn(track->text, " \t\r\n"), length = strlen(track->text);
	ECO_PASS(eco_file_check_head(track->path, track->text, blank < track->size ? track->size
		: 0, false, "a track", error));
	if (length < track->size && length < HEAD_BYTES)
		return refuse(track, "this is binary, or text in UTF-16", error);
	return track->text[blank] == '{' ? find_json(track, error) : find_text(track, error);
}

static enum eco_code read_text(struct eco_track *track, struct eco_error *error)
{
	enum eco_code code = find_format(track, error);
	if (code || track->format == ECO_TRACK_SCRIPT)
		return code;
	const char *name = format_names[track->format];
	eco_track_note(track, "%s: read as %s", track->path, name);
	code = track->format == ECO_TRACK_SRT ? read_srt(track, error)
					      : read_table(track, error);
	if (code || track->count)
		return code;
	return !track->skipped ? eco_fail(error, ECO_BAD_INPUT, "%.250s: no fix found; it was read as %s. "
		FORMATS, track->path, name) : eco_fail(error, ECO_BAD_INPUT, "%.250s:%u: read as %s, it has "
		"%u record%s and no usable fix: no position, or one that cannot be; positions are longitude "
		"and latitude, or metres (--track-crs)", track->path, track->skipped_line, name,
		track->records, track->records == 1 ? "" : "s");
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
