/* Subtitles that drones write beside their films, in all the dialects met: a record is an index, a time line
 * and one or more lines of NAME: VALUE or NAME(VALUE, VALUE, ...), with or without brackets and HTML.
 *
 *   [latitude : 31.45] [longtitude : 74.39] [altitude: 213.9]                     (the misspelling is theirs)
 *   [rel_alt: 1.5 abs_alt: 213.9] [gb_yaw: -67.6 gb_pitch: -30.0 gb_roll: 0.0]
 *   HOME(149.0251,-20.2532) 2017.08.05 14:11:51  GPS(149.0251,-20.2533,16) BAROMETER:1.9
 *   GPS (-58.8517, -34.2379, 15), HOME (-58.8475, -34.2327, -57.98m), D 698.70m, H 85.80m, G.PRY (-24.4°,
 *   0.0°, 110.4°)
 *   GPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M                                      latitude first
 *
 * So names are found one by one and not line by line. The third number of GPS() is the number of satellites
 * if it is whole, the height if it has decimals or "m", a precision if it has "M". The file is walked twice:
 * first to learn in which order coordinates stand. */
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define VALUES 4

struct value { double number; char unit; bool whole; };      /* the letter behind it; 0: none */

struct srt {
	struct eco_track *track;     /* NULL: only looking */
	const struct track_input *in;
	bool latitude_first, big_first, big_second, metre_capital;   /* what was seen */
	struct eco_fix fix;          /* the record being read, and what it says besides */
	double home_z, focal_mm, zoom;
	bool open;
};

static void read_one(const char **text, const char *end, struct value *v)
{
	const char *from = *text, *at = from;
	*v = (struct value){ .number = NAN };
	if (track_number(&at, end, &v->number)) {
		v->whole = !memchr(from, '.', (size_t)(at - from));
		v->unit = at < end && *at && strchr("mMf", *at) ? *at : 0;
	}
	*text = at;
}

/* Behind a name: `: 1.5`, `(1, 2, 3)`, ` 1.5m`. Returns how many there are; *text is moved behind them. */
static int read_values(const char **text, const char *end, struct value v[VALUES])
{
	const char *at = *text;
	int count = 0;
	while (at < end && (*at == ' ' || *at == ':'))
		at++;
	if (at == end || *at != '(')
		read_one(&at, end, &v[count++]);
	else
		do {
			at++;
			read_one(&at, end, &v[count < VALUES ? count++ : VALUES - 1]);
			while (at < end && *at != ',' && *at != ')')
				at++;
		} while (at < end && *at == ',');
	*text = at;
	return count;
}

/* Of GPS() and HOME(): also looks in which order they stand. */
static void set_place(struct srt *s, const struct value *v, int count, double at[2])
{
	if (count < 2)
		return;
	s->big_first |= fabs(v[0].number) > 90;
	s->big_second |= fabs(v[1].number) > 90;
	s->metre_capital |= count > 2 && v[2].unit == 'M';
	for (int i = 0; i < 2; i++)
		at[(i == 0) == s->latitude_first] = v[i].number;
}

static void set_home(struct srt *s, const struct value *v, int count)
{
	double home[3] = { NAN, NAN, count > 2 && (v[2].unit || !v[2].whole) ? v[2].number : NAN };
	set_place(s, v, count, home);
	s->home_z = home[2];
	if (!s->track || isnan(home[0]) || isnan(home[1]) || (home[0] == 0 && home[1] == 0))
		return;
	s->track->has_home = true;
	memcpy(s->track->home, home, sizeof home);
}

enum name { LATITUDE, LONGITUDE, ALTITUDE, ABOVE, GPS, HOME, GIMBAL, YAW, PITCH, ROLL, FOCAL, ZOOM };

static void set_values(struct srt *s, enum name name, const struct value *v, int count)
{
	double x = v->number;
	switch (name) {
	case LATITUDE: s->fix.at[1] = x; break;
	case LONGITUDE: s->fix.at[0] = x; break;
	case ALTITUDE: s->fix.at[2] = x; break;
	case ABOVE: s->fix.above_m = x; break;
	case GPS:
		set_place(s, v, count, s->fix.at);
		if (count > 2 && v[2].unit != 'M' && (v[2].unit == 'm' || !v[2].whole))
			s->fix.at[2] = v[2].number;
		break;
	case HOME: set_home(s, v, count); break;
	case GIMBAL:
		s->fix.pitch_deg = x;
		s->fix.roll_deg = count > 2 ? v[1].number : NAN;
		s->fix.yaw_deg = count > 2 ? v[2].number : NAN;
		break;
	case YAW: s->fix.yaw_deg = x; break;
	case PITCH: s->fix.pitch_deg = x; break;
	case ROLL: s->fix.roll_deg = x; break;
	/* 240 is 24.0 mm, 24.00 is too */
	case FOCAL: s->focal_mm = v->whole ? x / 10 : x; break;
	case ZOOM: s->zoom = v->whole && x >= 1000 ? x / 10000 : x; break;
	}
}

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

static void read_names(struct srt *s, const char *text, const char *end)
{
	static const struct { const char *word; enum name name; } names[] =
		{ { "latitude", LATITUDE }, { "lat", LATITUDE },
		{ "longitude", LONGITUDE }, { "longtitude", LONGITUDE }, { "lon", LONGITUDE },
		{ "lng", LONGITUDE }, { "altitude", ALTITUDE },
		{ "abs_alt", ALTITUDE }, { "rel_alt", ABOVE }, { "barometer", ABOVE }, { "hb", ABOVE },
		{ "h", ABOVE }, { "gps", GPS }, { "rtk", GPS },
		{ "home", HOME }, { "g.pry", GIMBAL }, { "gb_yaw", YAW }, { "gb_pitch", PITCH },
		{ "gb_roll", ROLL },
		{ "gimbal_yaw", YAW }, { "gimbal_pitch", PITCH }, { "gimbal_roll", ROLL },
		{ "focal_len", FOCAL }, { "dzoom_ratio", ZOOM } };
	while (text < end) {
		const char *from = text;
		size_t i = 0;
		while (text < end
				&& (is_letter(*text)
				|| (text > from && *text == '.' && text + 1 < end && is_letter(text[1]))))
			text++;
		while (i < sizeof names / sizeof *names && !track_is(from, text, names[i].word))
			i++;
		if (i < sizeof names / sizeof *names) {
			struct value v[VALUES];
			int count = read_values(&text, end, v);
			s->open = true;
			set_values(s, names[i].name, v, count);
		} else
			text += text == from;
	}
}

/* ---- Records ---- */

static enum eco_code close_record(struct srt *s, uint32_t next_line, struct eco_error *error)
{
	/* a 35 mm equivalent, of a film 16 : 9 of 36 mm width */
	double mm = s->focal_mm * (s->zoom > 0 ? s->zoom : 1);
	struct eco_fix fix = s->fix;
	bool open = s->open && s->track;
	fix.at[2] = isnan(fix.at[2]) ? s->home_z + fix.above_m : fix.at[2];
	fix.fov_y_deg = mm >= 8 && mm <= 3000 ? 2 * atan(36.0 * 9 / 16 / 2 / mm) * TRACK_DEG : NAN;
	s->fix = track_fix(next_line);
	s->home_z = s->focal_mm = s->zoom = NAN;
	s->open = false;
	return open ? track_add(s->track, &fix, error) : ECO_OK;
}

static enum eco_code walk(struct srt *s, struct eco_error *error)
{
	struct track_line line = { 0 };
	enum eco_code code = close_record(s, 1, error);
	while (!code && track_next_line(s->in, &line)) {
		const char *at = line.text, *end = line.end;
		double time_s = NAN;
		while (end > at && (end[-1] == ' ' || end[-1] == '\t'))
			end--;
		bool index = at < end && strspn(at, "0123456789") == (size_t)(end - at);
		/* 00:00:00,016 --> 00:00:00,033 */
		if (index || (track_clock(&at, end, &time_s) && track_holds(at, end, "-->"))) {
			code = close_record(s, line.number, error);
			s->fix.time_s = time_s;
			continue;
		}
		read_names(s, line.text, end);
	}
	return code ? code : close_record(s, 0, error);
}

enum eco_code track_read_srt(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct srt s = { .in = in };
	walk(&s, NULL);
	s.latitude_first = !s.big_first && (s.big_second || s.metre_capital);
	if (s.latitude_first)
		eco_track_note(track, "GPS(a, b) is taken for latitude, longitude, %s",
			s.big_second ? "as b is beyond 90" :
			"as drones that write heights with a capital M have it");
	track->degrees = true;
	s.track = track;
	return walk(&s, error);
}
