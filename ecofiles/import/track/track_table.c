/* Tables: columns found by the names that drones' logs and spreadsheets give them, and what a row says. CSV
 * and what GDAL hands over are both tables. In a CSV the header is the first line in which a position is
 * found, so preambles and comments may precede it.
 *
 * A name is compared in lower case without what is no letter or digit; a unit in brackets or behind the last
 * underline is taken off and used ("height_above_takeoff(feet)", "x_east_m", "OSD.height [m]"). Each meaning
 * has a list of names, best first (a gimbal's pitch before an aircraft's). */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define NAME_BYTES 64u
#define FIELDS_MAX 512u
#define HEADER_LINES 50u

static const char *const names[TRACK_ROLES][20] = {
	[TRACK_TIME] = { "t", "time", "timestamp", "times", "seconds", "elapsed", "elapsedtime", "unixtime",
		"epoch", "datetime",
		"datetimeutc", "utc", "gpstime", "offsettime", "flytime", "millisecond", "coordtimes",
		"coordinatetimes" },
	[TRACK_DATE] = { "date", "day", "gpsdate", "dateutc" },
	[TRACK_LON] = { "lon", "longitude", "lng", "long", "gpslongitude", "gpslon", "positionlong" },
	[TRACK_LAT] = { "lat", "latitude", "gpslatitude", "gpslat", "positionlat" },
	[TRACK_X] = { "east", "easting", "x", "xeast", "e", "utmx", "px", "posx", "positionx", "camerax" },
	[TRACK_Y] = { "north", "northing", "y", "ynorth", "n", "utmy", "py", "posy", "positiony", "cameray" },
	[TRACK_UP] = { "up", "z", "zup", "pz", "posz", "positionz", "cameraz", "altitude", "alt",
	"altitudeabovesealevel", "altmsl",
		"absalt", "gpsaltitude", "gpsalt", "elevation", "ele", "elev", "height" },
	[TRACK_ABOVE] = { "relalt", "relativealtitude", "heightabovetakeoff", "relativeheight", "osdheight",
	"heightagl", "agl",
		"barometer" },
	[TRACK_YAW] = { "gimbalyaw", "gimbalheading", "gbyaw", "camerayaw", "cameraheading", "yaw", "heading",
	"compassheading",
		"bearing", "direction", "course", "track" },
	[TRACK_PITCH] = { "gimbalpitch", "gbpitch", "camerapitch", "gimbalpitchangle", "pitch", "tilt" },
	[TRACK_ROLL] = { "gimbalroll", "gbroll", "cameraroll", "roll" },
	[TRACK_FOV] = { "fovy", "fov", "fieldofview", "verticalfov" },
};

/* ---- Names ---- */

static bool unit_factor(const char *text, const char *end, double *factor)
{
	static const struct { const char *name; double factor; } units[] =
		{ { "s", 1 }, { "sec", 1 }, { "seconds", 1 }, { "ms", 1e-3 },
		{ "msec", 1e-3 }, { "millisecond", 1e-3 }, { "milliseconds", 1e-3 }, { "us", 1e-6 },
		{ "ns", 1e-9 }, { "m", 1 },
		{ "meters", 1 }, { "metres", 1 }, { "ft", 0.3048 }, { "feet", 0.3048 }, { "deg", 1 },
		{ "degrees", 1 }, { "360", 1 },
		{ "rad", TRACK_DEG }, { "radians", TRACK_DEG } };
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (track_is(text, end, units[i].name)) {
			*factor = units[i].factor;
			return true;
		}
	return false;
}

/* Letters and digits in lower case, without the unit. `part`: only what follows the last dot
 * ("OSD.latitude"). */
static void plain_name(struct track_text f, bool part, char name[NAME_BYTES], double *unit)
{
	size_t length = 0;
	for (const char *c = f.end; part && c > f.text; c--)
		if (strchr("./:", c[-1]))
			f.text = c;
	const char *end = f.end, *mark = f.text;
	*unit = NAN;
	while (mark < end && *mark != '(' && *mark != '[')
		mark++;
	if (mark < end) {
		unit_factor(mark + 1, end - (end > mark + 1), unit);
		end = mark;
	} else {
		while (mark > f.text && mark[-1] != '_' && mark[-1] != ' ')
			mark--;
		end = mark > f.text && unit_factor(mark, end, unit) ? mark : end;
	}
	for (const char *c = f.text; c < end && length < NAME_BYTES - 1; c++)
		if (isalnum((unsigned char)*c))
			name[length++] = (char)tolower((unsigned char)*c);
	name[length] = 0;
}

static void find_role(struct track_table *t, const struct track_text *fields, uint32_t count, int role,
	bool part)
{
	char name[NAME_BYTES];
	double unit;
	int best = 20;
	for (uint32_t c = 0; c < count; c++) {
		bool taken = false;
		for (int other = 0; other < TRACK_ROLES; other++)
			taken |= other != role && t->column[other] == (int)c;
		plain_name(fields[c], part, name, &unit);
		for (int i = 0; !taken && i < best && names[role][i]; i++)
			if (strcmp(name, names[role][i]) == 0) {
				best = i;
				t->column[role] = (int)c;
				t->unit[role] = unit;
			}
	}
}

bool track_find_columns(struct track_table *t, const struct track_text *fields, uint32_t count)
{
	for (int role = 0; role < TRACK_ROLES; role++)
		t->column[role] = -1;
	for (int i = 0; i < 2 * TRACK_ROLES; i++)
		if (t->column[i % TRACK_ROLES] < 0)
			find_role(t, fields, count, i % TRACK_ROLES, i >= TRACK_ROLES);
	t->degrees = t->column[TRACK_LON] >= 0 && t->column[TRACK_LAT] >= 0;
	return t->degrees || (t->column[TRACK_X] >= 0 && t->column[TRACK_Y] >= 0);
}

/* ---- Rows ---- */

static struct track_text field_of(const struct track_table *t, const struct track_text *fields,
	uint32_t count, int role)
{
	static const struct track_text none = { "", NULL };
	int column = t->column[role];
	return column >= 0 && (uint32_t)column < count ? fields[column]
		: (struct track_text){ none.text, none.text };
}

static bool is_number(struct track_text f, double *value)
{
	return track_number(&f.text, f.end, value) && f.text == f.end;
}

static double time_of(const struct track_table *t, const struct track_text *fields, uint32_t count)
{
	struct track_text f = field_of(t, fields, count, TRACK_TIME),
		date = field_of(t, fields, count, TRACK_DATE);
	double time_s, date_s = 0, unit = t->unit[TRACK_TIME];
	/* seconds since 1970, or their thousandths, millionths, billionths */
	if (is_number(f, &time_s)) {
		double size = fabs(time_s);
		return time_s * (!isnan(unit) ? unit : size > 1e17 ? 1e-9 : size > 1e14 ? 1e-6 : size > 1e11
			? 1e-3 : 1);
	}
	bool has_date = track_date_time(&date.text, date.end, &date_s);
	if (track_date_time(&f.text, f.end, &time_s))
		return time_s;
	return track_clock(&f.text, f.end, &time_s) ? date_s + time_s : has_date ? date_s : NAN;
}

struct eco_fix track_row(const struct track_table *t, const struct track_text *fields, uint32_t count,
	uint32_t line)
{
	struct eco_fix fix = track_fix(line);
	double value[TRACK_ROLES];
	for (int role = TRACK_LON; role < TRACK_ROLES; role++)
		if (is_number(field_of(t, fields, count, role), &value[role]))
			value[role] *= isnan(t->unit[role]) ? 1 : t->unit[role];
		else
			value[role] = NAN;
	/* ten-millionths of a degree, as autopilots log them */
	for (int i = 0; i < 2; i++)
		fix.at[i] = t->degrees ? value[TRACK_LON + i] * (fabs(value[TRACK_LON + i]) > 1000 ? 1e-7 : 1)
			: value[TRACK_X + i];
	fix.at[2] = value[TRACK_UP];
	fix.above_m = value[TRACK_ABOVE];
	fix.yaw_deg = value[TRACK_YAW];
	fix.pitch_deg = value[TRACK_PITCH];
	fix.roll_deg = value[TRACK_ROLL];
	fix.fov_y_deg = value[TRACK_FOV];
	fix.time_s = time_of(t, fields, count);
	return fix;
}

/* ---- CSV ---- */

static bool is_space(char c) { return c == ' ' || c == '\t'; }

static struct track_text trim(const char *text, const char *end)
{
	while (text < end && is_space(*text))
		text++;
	while (end > text && is_space(end[-1]))
		end--;
	bool quoted = end - text >= 2 && *text == '"' && end[-1] == '"';
	return (struct track_text){ text + quoted, end - quoted };
}

/* A separator of ' ' is any number of spaces. */
static uint32_t split(struct track_line line, char separator, struct track_text fields[FIELDS_MAX])
{
	struct track_text all = trim(line.text, line.end);
	const char *at = separator == ' ' ? all.text : line.text, *end = separator == ' ' ? all.end
		: line.end;
	uint32_t count = 0;
	for (; count < FIELDS_MAX; at++) {
		const char *from = at;
		bool quoted = false;
		for (; at < end && (quoted || !(*at == separator || (separator == ' ' && *at == '\t'))); at++)
			quoted ^= *at == '"';
		if (separator != ' ' || at > from)
			fields[count++] = trim(from, at);
		if (at >= end)
			break;
	}
	return count;
}

static enum eco_code no_columns(const struct track_input *in, struct eco_error *error)
{
	struct track_line line = { 0 };
	while (track_next_line(in, &line) && line.text == line.end)
		;
	return eco_fail(error, ECO_BAD_INPUT, "%.200s:%u: no format is known that looks like this, and as a "
		"table it has no columns for a "
		"position; it begins \"%.*s\". If it is a table, name its columns in the first line: "
		"t,lon,lat,alt or t,x,y,z, and yaw,pitch", in->path, line.number,
		(int)(line.end - line.text < 160 ? line.end - line.text : 160), line.text);
}

/* Finds the header: *line is read then. */
static bool find_header(struct track_table *t, const struct track_input *in, struct track_line *line,
	char *separator, struct track_text *fields)
{
	while (line->number < HEADER_LINES && track_next_line(in, line)) {
		struct track_line header = *line;
		*separator = ' ';
		while (header.text < header.end && strchr("#% \t", *header.text))
			header.text++;
		for (const char *mark = ";\t,|"; *mark && *separator == ' '; mark++)
			*separator = memchr(header.text, *mark, (size_t)(header.end - header.text)) ? *mark
				: ' ';
		if (track_find_columns(t, fields, split(header, *separator, fields)))
			return true;
	}
	return false;
}

enum eco_code track_read_csv(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct track_table table;
	struct track_line line = { 0 };
	struct track_text *fields = malloc(FIELDS_MAX * sizeof *fields);
	char separator = 0;
	enum eco_code code = !fields ? eco_fail(error, ECO_NO_MEMORY, "out of memory") :
		find_header(&table, in, &line, &separator, fields) ? ECO_OK : no_columns(in, error);
	track->degrees = !code && table.degrees;
	while (!code && track_next_line(in, &line)) {
		struct track_text text = trim(line.text, line.end);
		if (text.text == text.end || *text.text == '#')
			continue;
		struct eco_fix fix = track_row(&table, fields, split(line, separator, fields), line.number);
		code = track_add(track, &fix, error);
	}
	free(fields);
	return code;
}
