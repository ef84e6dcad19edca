/* Subtitles that drones write beside their films: a record is an index, a time line and lines of NAME: VALUE
 * or NAME(VALUE, VALUE, ...), with or without brackets and HTML, in many dialects (all are in test_track.c).
 *
 *   [latitude : 31.45] [longtitude : 74.39] [altitude: 213.9]                     (the misspelling is theirs)
 *   GPS (-58.8517, -34.2379, 15), D 698.70m, H 85.80m, G.PRY (-24.4°, 0.0°, 110.4°)
 *
 * So names are found one by one and not line by line; those of one value are the names of columns, too. The
 * third number of GPS() is the number of satellites if it is whole, the height if it has decimals or "m";
 * drones that write it with "M" mean a precision, and have the latitude first. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/import/track/track_read.h"

#define NAME_BYTES 32
#define LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_."      /* of names */

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
	for (const char *from = text; v.count < 3 && track_number(&text, &v.number[v.count]); from = ++text) {
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
	enum track_role role = track_role_of(name, &rank, &unit);
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
		char name[NAME_BYTES];
		length = strspn(text, LETTERS);
		if (!length || length >= NAME_BYTES)
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
	enum eco_code code = s->open ? track_add(s->track, &s->fix, error) : ECO_OK;
	*s = (struct srt){ .track = s->track, .fix = TRACK_FIX(next_line) };
	return code;
}

enum eco_code track_read_srt(struct eco_track *track, struct eco_error *error)
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
		if (index || (track_clock(&at, &time_s) && strstr(at, "-->"))) {
			code = close_record(&s, line, error);
			s.fix.time_s = time_s;
		} else
			read_names(&s, text);
	}
	return code ? code : close_record(&s, 0, error);
}
