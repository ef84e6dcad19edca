/* Tables: columns found by the names that drones' logs and spreadsheets give them, and what a row says. CSV
 * and what GDAL hands over are both tables, and subtitles have the same names.
 *
 * A name is compared in lower case without what is no letter or digit; a unit in brackets or behind the last
 * underline is taken off and used ("height_above_takeoff(feet)", "x_east_m", "OSD.height [m]"). Each meaning
 * has a list of names, best first (a gimbal's pitch before an aircraft's). */
#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/import/track/track_read.h"

#define NAME_BYTES 64u
#define NAMES_MAX 20

static const char *const names[TRACK_ROLES][NAMES_MAX] = {
	[TRACK_TIME] = { "t", "time", "timestamp", "times", "seconds", "elapsed", "elapsedtime", "unixtime",
		"epoch", "datetime", "datetimeutc", "utc", "gpstime", "offsettime", "flytime", "millisecond",
		"coordtimes", "coordinatetimes" },
	[TRACK_X] = { "east", "easting", "x", "xeast", "e", "utmx", "px", "posx", "positionx", "camerax" },
	[TRACK_Y] = { "north", "northing", "y", "ynorth", "n", "utmy", "py", "posy", "positiony", "cameray" },
	[TRACK_Z] = { "up", "z", "zup", "pz", "posz", "positionz", "cameraz", "altitude", "alt",
		"altitudeabovesealevel", "altmsl", "absalt", "gpsaltitude", "gpsalt", "elevation", "ele",
		"elev", "height" },
	[TRACK_ABOVE] = { "relalt", "relativealtitude", "heightabovetakeoff", "relativeheight", "osdheight",
		"heightagl", "agl", "barometer" },
	[TRACK_YAW] = { "gimbalyaw", "gimbalheading", "gbyaw", "camerayaw", "cameraheading", "yaw", "heading",
		"compassheading", "bearing", "direction", "course", "track" },
	[TRACK_PITCH] = { "gimbalpitch", "gbpitch", "camerapitch", "gimbalpitchangle", "pitch", "tilt" },
	[TRACK_ROLL] = { "gimbalroll", "gbroll", "cameraroll", "roll" },
	[TRACK_FOV] = { "fovy", "fov", "fieldofview", "verticalfov" },
	[TRACK_LON] = { "lon", "longitude", "lng", "long", "longtitude", "gpslongitude", "gpslon",
		"positionlong" },
	[TRACK_LAT] = { "lat", "latitude", "gpslatitude", "gpslat", "positionlat" },
	[TRACK_DATE] = { "date", "day", "gpsdate", "dateutc" },
};

/* ---- Names ---- */

/* The factor to seconds, metres and degrees; NaN: no unit. */
static double unit_of(const char *text, size_t length)
{
	static const struct { const char *name; double factor; } units[] = {
		{ "s", 1 }, { "sec", 1 }, { "seconds", 1 }, { "ms", 1e-3 }, { "msec", 1e-3 },
		{ "millisecond", 1e-3 }, { "milliseconds", 1e-3 }, { "us", 1e-6 }, { "ns", 1e-9 }, { "m", 1 },
		{ "meters", 1 }, { "metres", 1 }, { "ft", 0.3048 }, { "feet", 0.3048 }, { "deg", 1 },
		{ "degrees", 1 }, { "360", 1 }, { "rad", TRACK_DEG }, { "radians", TRACK_DEG } };
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strlen(units[i].name) == length && strncasecmp(text, units[i].name, length) == 0)
			return units[i].factor;
	return NAN;
}

/* Letters and digits in lower case, without the unit. `part`: only what follows the last dot
 * ("OSD.latitude"). Returns the unit's factor. */
static double plain_name(const char *text, bool part, char name[NAME_BYTES])
{
	for (const char *dot = text; part && (dot = strpbrk(dot, "./:")) != NULL; )
		text = ++dot;
	const char *end = text + strcspn(text, "([");
	double unit = *end ? unit_of(end + 1, strcspn(end + 1, ")]")) : NAN;
	if (!*end) {
		const char *last = end;
		while (last > text && last[-1] != '_' && last[-1] != ' ')
			last--;
		unit = last > text ? unit_of(last, (size_t)(end - last)) : NAN;
		end = isnan(unit) ? end : last;
	}
	size_t length = 0;
	for (; text < end && length < NAME_BYTES - 1; text++)
		if (isalnum((unsigned char)*text))
			name[length++] = (char)tolower((unsigned char)*text);
	name[length] = 0;
	return unit;
}

/* How good a name is for a role: 0 the best, NAMES_MAX none. */
static int rank(enum track_role role, const char *plain)
{
	int i = 0;
	while (i < NAMES_MAX && names[role][i] && strcmp(names[role][i], plain) != 0)
		i++;
	return i < NAMES_MAX && names[role][i] ? i : NAMES_MAX;
}

enum track_role track_role_of(const char *name)
{
	char plain[NAME_BYTES];
	enum track_role role = 0;
	plain_name(name, false, plain);
	while (role < TRACK_ROLES && rank(role, plain) == NAMES_MAX)
		role++;
	return role;
}

static void find_role(struct track_table *t, const char *const *columns, uint32_t count, enum track_role role,
	bool part)
{
	char name[NAME_BYTES];
	int best = NAMES_MAX;
	for (uint32_t c = 0; c < count; c++) {
		bool taken = false;
		for (int other = 0; other < TRACK_ROLES; other++)
			taken |= other != (int)role && t->column[other] == c;
		double unit = plain_name(columns[c], part, name);
		if (taken || rank(role, name) >= best)
			continue;
		best = rank(role, name);
		t->column[role] = c;
		t->unit[role] = unit;
	}
}

bool track_find_columns(struct track_table *t, const char *const *columns, uint32_t count)
{
	for (int role = 0; role < TRACK_ROLES; role++) {
		t->column[role] = ECO_NONE;
		t->unit[role] = NAN;
	}
	for (int i = 0; i < 2 * TRACK_ROLES; i++)
		if (t->column[i % TRACK_ROLES] == ECO_NONE)
			find_role(t, columns, count, i % TRACK_ROLES, i >= TRACK_ROLES);
	t->degrees = t->column[TRACK_LON] != ECO_NONE && t->column[TRACK_LAT] != ECO_NONE;
	return t->degrees || (t->column[TRACK_X] != ECO_NONE && t->column[TRACK_Y] != ECO_NONE);
}

/* ---- Rows ---- */

/* The whole of the field, or NaN. */
static double number_of(const char *field)
{
	double value;
	return track_number(&field, &value) && !field[strspn(field, " \t")] ? value : NAN;
}

/* Seconds since 1970, or their thousandths, millionths, billionths; a date; a clock, perhaps of a date. */
static double time_of(const char *time, const char *date, double unit)
{
	double time_s = number_of(time), size = fabs(time_s), date_s = track_date_time(date);
	if (!isnan(time_s))
		return time_s * (!isnan(unit) ? unit : size > 1e17 ? 1e-9 : size > 1e14 ? 1e-6
			: size > 1e11 ? 1e-3 : 1);
	time_s = track_date_time(time);
	if (!isnan(time_s))
		return time_s;
	return track_clock(&time, &time_s) ? time_s + (isnan(date_s) ? 0 : date_s) : date_s;
}

struct eco_fix track_row(const struct track_table *t, const char *const *fields, uint32_t count,
	uint32_t line)
{
	struct eco_fix fix = track_fix(line);
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
