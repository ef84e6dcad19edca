/* Subtitles that drones write beside their films, in all the dialects met: a record is an index, a time line and one or more lines of
 * NAME: VALUE or NAME(VALUE, VALUE, ...), with or without brackets and HTML.
 *
 *   [latitude : 31.45] [longtitude : 74.39] [altitude: 213.9]                     (the misspelling is theirs)
 *   [rel_alt: 1.5 abs_alt: 213.9] [gb_yaw: -67.6 gb_pitch: -30.0 gb_roll: 0.0]
 *   HOME(149.0251,-20.2532) 2017.08.05 14:11:51  GPS(149.0251,-20.2533,16) BAROMETER:1.9
 *   GPS (-58.8517, -34.2379, 15), HOME (-58.8475, -34.2327, -57.98m), D 698.70m, H 85.80m, G.PRY (-24.4°, 0.0°, 110.4°)
 *   GPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M                                      latitude first
 *   GPS(W: 121.1, N: 38.1, 100.2m)
 *
 * So names are found one by one and not line by line. The third number of GPS() is the number of satellites if it is whole, the height
 * if it has decimals or "m", a precision if it has "M". The file is walked twice: first to learn in which order coordinates stand. */
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define VALUES 4

struct srt {
	struct eco_track *track;     /* NULL: only looking */
	const struct track_input *in;
	bool latitude_first;
	bool big_first, big_second, metre_capital, has_timecodes;    /* what was seen */
	/* the record being read */
	struct eco_fix fix;
	double stamp_s, home_z, focal_mm, zoom;
	bool open, gimbal;
};

struct value {                           /* of one name */
	double number[VALUES];
	char side[VALUES];           /* N, S, E, W before the number; 0 */
	char unit[VALUES];           /* the letter behind it; 0 */
	bool whole[VALUES];
	int count;
};

/* ---- Values ---- */

static void read_one(const char **text, const char *end, struct value *v)
{
	int i = v->count < VALUES ? v->count : VALUES - 1;
	const char *at = *text;
	v->side[i] = v->unit[i] = 0;
	v->number[i] = NAN;
	while (at < end && *at == ' ')
		at++;
	if (at + 1 < end && strchr("NSEW", *at) && (at[1] == ':' || at[1] == ' ')) {
		v->side[i] = *at;
		at += 2;
	}
	const char *from = at;
	if (track_number(&at, end, &v->number[i])) {
		v->whole[i] = !memchr(from, '.', (size_t)(at - from));
		v->unit[i] = at < end && strchr("mMf", *at) && *at ? *at : 0;
	}
	v->count = i + 1;
	*text = at;
}

/* Behind a name: `: 1.5`, `(1, 2, 3)`, ` 1.5m`. *text is moved behind it. */
static void read_value(const char **text, const char *end, struct value *v)
{
	const char *at = *text;
	*v = (struct value){ .count = 0 };
	while (at < end && (*at == ' ' || *at == ':'))
		at++;
	if (at < end && *at == '(') {
		do {
			at++;
			read_one(&at, end, v);
			while (at < end && *at != ',' && *at != ')')
				at++;
		} while (at < end && *at == ',');
	} else
		read_one(&at, end, v);
	*text = at;
}

/* ---- Names ---- */

static void look_at_order(struct srt *s, const struct value *v)
{
	s->big_first |= fabs(v->number[0]) > 90;
	s->big_second |= fabs(v->number[1]) > 90;
	s->metre_capital |= v->count > 2 && v->unit[2] == 'M';
}

static void set_place(const struct srt *s, const struct value *v, double at[2])
{
	for (int i = 0; i < 2 && v->count >= 2; i++) {
		bool is_latitude = v->side[i] ? v->side[i] == 'N' || v->side[i] == 'S' : (i == 0) == s->latitude_first;
		at[is_latitude] = v->side[i] == 'S' || v->side[i] == 'W' ? -v->number[i] : v->number[i];
	}
}

static void set_gps(struct srt *s, const struct value *v)
{
	look_at_order(s, v);
	set_place(s, v, s->fix.at);
	if (v->count > 2 && v->unit[2] != 'M' && (v->unit[2] == 'm' || !v->whole[2]))
		s->fix.at[2] = v->number[2];
}

static void set_home(struct srt *s, const struct value *v)
{
	double home[3] = { NAN, NAN, v->count > 2 && (v->unit[2] || !v->whole[2]) ? v->number[2] : NAN };
	look_at_order(s, v);
	set_place(s, v, home);
	s->home_z = home[2];
	if (!s->track || isnan(home[0]) || isnan(home[1]) || (home[0] == 0 && home[1] == 0))
		return;
	s->track->has_home = true;
	memcpy(s->track->home, home, sizeof home);
}

/* pitch, roll, yaw */
static void set_attitude(struct srt *s, const struct value *v, bool gimbal)
{
	if (v->count < 3 || (!gimbal && s->gimbal))
		return;
	s->gimbal |= gimbal;
	s->fix.yaw_deg = v->number[2];
	/* the aircraft leans to fly; its camera does not */
	s->fix.pitch_deg = gimbal ? v->number[0] : NAN;
	s->fix.roll_deg = gimbal ? v->number[1] : NAN;
}

enum name { LATITUDE, LONGITUDE, ALTITUDE, ABOVE, GPS, HOME, GIMBAL, AIRCRAFT, YAW, PITCH, ROLL, AIRCRAFT_YAW, FOCAL, ZOOM };

static void set_value(struct srt *s, enum name name, const struct value *v)
{
	double x = v->number[0];
	switch (name) {
	case LATITUDE: s->fix.at[1] = x; break;
	case LONGITUDE: s->fix.at[0] = x; break;
	case ALTITUDE: s->fix.at[2] = x; break;
	case ABOVE: s->fix.above_m = x; break;
	case GPS: set_gps(s, v); break;
	case HOME: set_home(s, v); break;
	case GIMBAL: set_attitude(s, v, true); break;
	case AIRCRAFT: set_attitude(s, v, false); break;
	case YAW: s->fix.yaw_deg = x; s->gimbal = true; break;
	case PITCH: s->fix.pitch_deg = x; break;
	case ROLL: s->fix.roll_deg = x; break;
	case AIRCRAFT_YAW: s->fix.yaw_deg = s->gimbal ? s->fix.yaw_deg : x; break;
	/* 240 is 24.0 mm, 24.00 is too */
	case FOCAL: s->focal_mm = v->whole[0] ? x / 10 : x; break;
	case ZOOM: s->zoom = v->whole[0] && x >= 1000 ? x / 10000 : x; break;
	}
}

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

static bool find_name(const char *text, const char *end, enum name *name)
{
	static const struct { const char *word; enum name name; } names[] = { { "latitude", LATITUDE }, { "lat", LATITUDE },
		{ "longitude", LONGITUDE }, { "longtitude", LONGITUDE }, { "lon", LONGITUDE }, { "lng", LONGITUDE }, { "altitude", ALTITUDE },
		{ "abs_alt", ALTITUDE }, { "rel_alt", ABOVE }, { "barometer", ABOVE }, { "hb", ABOVE }, { "h", ABOVE }, { "gps", GPS }, { "rtk", GPS },
		{ "home", HOME }, { "g.pry", GIMBAL }, { "f.pry", AIRCRAFT }, { "gb_yaw", YAW }, { "gb_pitch", PITCH }, { "gb_roll", ROLL },
		{ "gimbal_yaw", YAW }, { "gimbal_pitch", PITCH }, { "gimbal_roll", ROLL }, { "drone_yaw", AIRCRAFT_YAW }, { "yaw", AIRCRAFT_YAW },
		{ "focal_len", FOCAL }, { "dzoom_ratio", ZOOM } };
	for (size_t i = 0; text < end && i < sizeof names / sizeof *names; i++)
		if (track_is(text, end, names[i].word)) {
			*name = names[i].name;
			return true;
		}
	return false;
}

static void read_names(struct srt *s, const char *text, const char *end)
{
	while (text < end) {
		const char *from = text;
		enum name name;
		struct value v;
		while (text < end && (is_letter(*text) || (text > from && *text == '.' && text + 1 < end && is_letter(text[1]))))
			text++;
		if (find_name(from, text, &name)) {
			read_value(&text, end, &v);
			s->open = true;
			if (v.count)
				set_value(s, name, &v);
		} else if (text == from)
			text++;
	}
}

/* ---- Records ---- */

static double field_of_view(const struct srt *s)
{
	double mm = s->focal_mm * (s->zoom > 0 ? s->zoom : 1);
	/* a 35 mm equivalent, of a film 16 : 9 of 36 mm width */
	return mm >= 8 && mm <= 3000 ? 2 * atan(36.0 * 9 / 16 / 2 / mm) * 57.29577951308232 : NAN;
}

static enum eco_code close_record(struct srt *s, struct eco_error *error)
{
	bool open = s->open && s->track;
	s->open = s->gimbal = false;
	if (!open)
		return ECO_OK;
	if (isnan(s->fix.time_s) && !s->has_timecodes)
		s->fix.time_s = s->stamp_s;
	if (isnan(s->fix.at[2]))
		s->fix.at[2] = s->home_z + s->fix.above_m;
	s->fix.fov_y_deg = field_of_view(s);
	return track_add(s->track, &s->fix, error);
}

static void open_record(struct srt *s, uint32_t line)
{
	s->fix = track_fix(line);
	s->stamp_s = s->home_z = s->focal_mm = s->zoom = NAN;
}

static bool is_index(const struct track_line *line)
{
	const char *at = line->text;
	while (at < line->end && *at >= '0' && *at <= '9')
		at++;
	return at > line->text && at == line->end;
}

/* 00:00:00,016 --> 00:00:00,033 */
static bool is_timecode(const struct track_line *line, double *time_s)
{
	const char *at = line->text;
	return track_clock(&at, line->end, time_s) && track_holds(at, line->end, "-->");
}

/* The first date and time within the line. */
static double find_stamp(const struct track_line *line)
{
	double time_s;
	for (const char *at = line->text, *behind; at + 8 < line->end; at++)
		if (*at >= '0' && *at <= '9' && (at == line->text || !(at[-1] >= '0' && at[-1] <= '9')) &&
			(behind = at, track_date_time(&behind, line->end, &time_s)))
			return time_s;
	return NAN;
}

static enum eco_code read_line(struct srt *s, struct track_line line, struct eco_error *error)
{
	double time_s = NAN;
	while (line.end > line.text && (line.end[-1] == ' ' || line.end[-1] == '\t'))
		line.end--;
	if (is_index(&line) || is_timecode(&line, &time_s)) {
		enum eco_code code = close_record(s, error);
		open_record(s, line.number);
		s->has_timecodes |= !isnan(time_s);
		s->fix.time_s = time_s;
		return code;
	}
	if (isnan(s->stamp_s))
		s->stamp_s = find_stamp(&line);
	read_names(s, line.text, line.end);
	return ECO_OK;
}

static enum eco_code walk(struct srt *s, struct eco_error *error)
{
	struct track_line line = { 0 };
	enum eco_code code = ECO_OK;
	open_record(s, 1);
	while (!code && track_next_line(s->in, &line))
		code = read_line(s, line, error);
	return code ? code : close_record(s, error);
}

enum eco_code track_read_srt(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct srt s = { .in = in };
	walk(&s, NULL);
	s.latitude_first = in->options->latitude_first || (s.big_second && !s.big_first) || (s.metre_capital && !s.big_first);
	if (s.latitude_first && !in->options->latitude_first)
		eco_track_note(track, "GPS(a, b) is taken for latitude, longitude, %s", s.big_second ? "as b is beyond 90" :
			"as drones that write heights with a capital M have it");
	track->degrees = true;
	s.track = track;
	return walk(&s, error);
}
