/* Columns of tables, found by the names that loggers, planners and spreadsheets give them, in several languages, or as the options say;
 * and what a row says. CSV and what GDAL hands over are both tables.
 *
 * A name is compared in lower case without what is no letter or digit; a unit in brackets or behind the last underline is taken off
 * and used ("height_above_takeoff(feet)", "x_east_m", "OSD.height [m]"). Each meaning has a list of names, best first (a gimbal's
 * pitch before an aircraft's). */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define DAY_S 86400.0

static const char *const role_names[TRACK_ROLES] = { "t", "date", "lon", "lat", "alt", "rel", "east", "north", "up", "yaw", "pitch",
	"roll", "qx", "qy", "qz", "qw", "fov" };

static const char *const names[TRACK_ROLES][32] = {
	[TRACK_TIME] = { "t", "time", "timestamp", "times", "seconds", "sec", "secs", "elapsed", "elapsedtime", "elapsedseconds", "timeelapsed", "unixtime",
		"unix", "epoch", "datetime", "datetimeutc", "dateandtime", "utc", "utctime", "gpstime", "gpsdatetime", "timeutc", "offsettime", "flytime",
		"millisecond", "zeit", "rostime", "coordtimes", "coordinatetimes" },
	[TRACK_DATE] = { "date", "day", "datum", "fecha", "gpsdate", "dateutc" },
	[TRACK_LON] = { "lon", "longitude", "lng", "long", "longtitude", "gpslongitude", "gpslon", "gpslong", "londeg", "longdd", "laenge", "lngengrad", "lnge",
		"laengengrad", "longitud", "positionlong", "wgs84longitude" },
	[TRACK_LAT] = { "lat", "latitude", "gpslatitude", "gpslat", "latdeg", "latdd", "breite", "breitengrad", "latitud", "positionlat", "wgs84latitude" },
	[TRACK_ALT] = { "altitude", "alt", "altitudeabovesealevel", "altmsl", "amsl", "absalt", "altitudemsl", "absolutealtitude", "gpsaltitude", "gpsalt",
		"gpsheightmsl", "elevation", "ele", "elev", "enhancedaltitude", "hoehe", "hhe", "altitud", "z", "height", "up", "zup", "h" },
	[TRACK_ABOVE] = { "relalt", "relativealtitude", "heightabovetakeoff", "altituderelative", "relativeheight", "osdheight", "heightagl", "agl",
		"altitudeagl", "altagl", "barometer", "relheight" },
	[TRACK_X] = { "east", "easting", "x", "xeast", "e", "eastm", "utmx", "utme", "utmeasting", "px", "posx", "positionx", "tx", "camerax", "locationx",
		"xutm", "rechtswert", "prsrx", "xm", "camx" },
	[TRACK_Y] = { "north", "northing", "y", "ynorth", "n", "northm", "utmy", "utmn", "utmnorthing", "py", "posy", "positiony", "ty", "cameray", "locationy",
		"yutm", "hochwert", "prsry", "ym", "camy" },
	[TRACK_Z] = { "up", "z", "zup", "pz", "posz", "positionz", "tz", "cameraz", "locationz", "height", "altitude", "alt", "elevation", "ele", "h", "hoehe",
		"hhe", "prsrz", "zm", "camz" },
	[TRACK_YAW] = { "gimbalyaw", "gimbalheading", "gbyaw", "camerayaw", "cameraheading", "gimbalyawdegree", "yaw", "heading", "compassheading", "hdg",
		"azimuth", "headingdeg", "bearing", "direction", "course", "cog", "courseoverground", "track", "kurs", "psi" },
	[TRACK_PITCH] = { "gimbalpitch", "gbpitch", "camerapitch", "gimbalpitchangle", "gimbalpitchdegree", "cameratilt", "pitch", "tilt", "theta" },
	[TRACK_ROLL] = { "gimbalroll", "gbroll", "cameraroll", "gimbalrolldegree", "roll", "bank" },
	[TRACK_QX] = { "qx", "quatx", "quaternionx", "orientationx", "rotationx", "qrsx" },
	[TRACK_QY] = { "qy", "quaty", "quaterniony", "orientationy", "rotationy", "qrsy" },
	[TRACK_QZ] = { "qz", "quatz", "quaternionz", "orientationz", "rotationz", "qrsz" },
	[TRACK_QW] = { "qw", "quatw", "quaternionw", "orientationw", "rotationw", "qrsw" },
	[TRACK_FOV] = { "fovy", "fov", "fieldofview", "verticalfov", "vfov" },
};

/* ---- Names ---- */

static bool unit_factor(const char *text, const char *end, double *factor)
{
	static const struct { const char *name; double factor; } units[] = { { "s", 1 }, { "sec", 1 }, { "seconds", 1 }, { "second", 1 },
		{ "ms", 1e-3 }, { "msec", 1e-3 }, { "millisecond", 1e-3 }, { "milliseconds", 1e-3 }, { "us", 1e-6 }, { "ns", 1e-9 },
		{ "m", 1 }, { "meters", 1 }, { "meter", 1 }, { "metres", 1 }, { "ft", 0.3048 }, { "feet", 0.3048 }, { "foot", 0.3048 },
		{ "km", 1000 }, { "cm", 0.01 }, { "mm", 0.001 }, { "deg", 1 }, { "degrees", 1 }, { "degree", 1 },
		{ "rad", 57.29577951308232 }, { "radians", 57.29577951308232 }, { "360", 1 } };
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (track_is(text, end, units[i].name)) {
			*factor = units[i].factor;
			return true;
		}
	return false;
}

/* Letters and digits in lower case, without the unit. `parts`: only what follows the last dot, slash or colon ("OSD.latitude"). */
static void plain_name(struct track_text f, bool parts, char name[TRACK_NAME_BYTES], double *unit)
{
	size_t length = 0;
	for (const char *c = f.end; parts && c > f.text; c--)
		if (strchr("./:", c[-1]))
			f.text = c;
	const char *end = f.end, *mark = f.text;
	*unit = NAN;
	while (mark < end && *mark != '(' && *mark != '[')
		mark++;
	if (mark > f.text && mark < end) {
		const char *close = mark + 1;
		while (close < end && *close != ')' && *close != ']')
			close++;
		unit_factor(mark + 1, close, unit);
		end = mark;
	} else {
		for (mark = end; mark > f.text && mark[-1] != '_' && mark[-1] != ' '; )
			mark--;
		if (mark > f.text && unit_factor(mark, end, unit))
			end = mark;
	}
	for (const char *c = f.text; c < end && length < TRACK_NAME_BYTES - 1; c++)
		if (isalnum((unsigned char)*c))
			name[length++] = (char)tolower((unsigned char)*c);
	name[length] = 0;
}

/* A column means one thing; only a height serves degrees and metres alike. */
static bool is_taken(const struct track_table *t, uint32_t column, enum track_role by)
{
	for (int role = 0; role < TRACK_ROLES; role++)
		if (t->column[role] == (int)column && !((by == TRACK_Z && role == TRACK_ALT) || (by == TRACK_ALT && role == TRACK_Z)))
			return true;
	return false;
}

static void take_column(struct track_table *t, const struct track_text *fields, enum track_role role, uint32_t column, double unit)
{
	t->column[role] = (int)column;
	t->unit[role] = unit;
	snprintf(t->label[role], TRACK_NAME_BYTES, "%.*s", (int)(fields[column].end - fields[column].text), fields[column].text);
}

static void find_role(struct track_table *t, const struct track_text *fields, uint32_t count, enum track_role role, bool parts)
{
	for (int i = 0; names[role][i]; i++)
		for (uint32_t c = 0; c < count; c++) {
			char name[TRACK_NAME_BYTES];
			double unit;
			plain_name(fields[c], parts, name, &unit);
			if (strcmp(name, names[role][i]) == 0 && !is_taken(t, c, role)) {
				take_column(t, fields, role, c, unit);
				return;
			}
		}
}

bool track_has_degrees(const struct track_table *t) { return t->column[TRACK_LON] >= 0 && t->column[TRACK_LAT] >= 0; }

bool track_has_place(const struct track_table *t)
{
	return track_has_degrees(t) || (t->column[TRACK_X] >= 0 && t->column[TRACK_Y] >= 0);
}

/* ---- Columns by option: t=Time,lon=X,lat=Y,alt=Z:ft ---- */

static enum eco_code take_option(struct track_table *t, struct track_text item, const struct track_text *fields, uint32_t count,
	struct eco_error *error)
{
	const char *equals = memchr(item.text, '=', (size_t)(item.end - item.text)), *unit_at = item.end;
	int role = 0, shown = (int)(item.end - item.text < 100 ? item.end - item.text : 100);
	while (equals && role < TRACK_ROLES && !track_is(item.text, equals, role_names[role]))
		role++;
	if (!equals || role == TRACK_ROLES)
		return eco_fail(error, ECO_BAD_USAGE, "--columns %.*s: must be ROLE=COLUMN with t, date, lon, lat, alt, rel, east, north, up, yaw, "
			"pitch, roll, qx, qy, qz, qw or fov", shown, item.text);
	struct track_text name = { equals + 1, item.end };
	double unit = NAN, stated = NAN, number;
	char plain[TRACK_NAME_BYTES];
	while (unit_at > name.text && unit_at[-1] != ':')
		unit_at--;
	if (unit_at > name.text && unit_factor(unit_at, item.end, &unit))
		name.end = unit_at - 1;
	size_t length = (size_t)(name.end - name.text);
	for (uint32_t c = 0; c < count; c++)
		if ((size_t)(fields[c].end - fields[c].text) == length && memcmp(fields[c].text, name.text, length) == 0) {
			plain_name(fields[c], false, plain, &stated);
			take_column(t, fields, (enum track_role)role, c, isnan(unit) ? stated : unit);
			return ECO_OK;
		}
	if (!track_is_number(name.text, name.end, &number) || !(number >= 1 && number <= count && number == floor(number)))
		return eco_fail(error, ECO_NOT_FOUND, "no column \"%.*s\"", (int)(length < 100 ? length : 100), name.text);
	take_column(t, fields, (enum track_role)role, (uint32_t)number - 1, unit);
	return ECO_OK;
}

enum eco_code track_find_columns(struct track_table *t, const struct track_text *fields, uint32_t count, struct eco_error *error)
{
	const char *options = t->in->options->columns;
	enum eco_code code = ECO_OK;
	for (int role = 0; role < TRACK_ROLES; role++)
		t->column[role] = -1;
	for (const char *at = options, *end = options ? options + strlen(options) : NULL; !code && at < end; ) {
		const char *comma = memchr(at, ',', (size_t)(end - at));
		struct track_text item = { at, comma ? comma : end };
		code = take_option(t, item, fields, count, error);
		at = item.end + 1;
	}
	bool by_name = !code && !(options && track_has_place(t));
	for (int i = 0; by_name && i < 2 * TRACK_ROLES; i++)
		if (t->column[i % TRACK_ROLES] < 0)
			find_role(t, fields, count, (enum track_role)(i % TRACK_ROLES), i >= TRACK_ROLES);
	return code;
}

/* ---- Rows ---- */

static bool field_of(const struct track_table *t, const struct track_text *fields, uint32_t count, enum track_role role,
	struct track_text *field)
{
	if (t->column[role] < 0 || (uint32_t)t->column[role] >= count)
		return false;
	*field = fields[t->column[role]];
	return true;
}

static double value_of(const struct track_table *t, const struct track_text *fields, uint32_t count, enum track_role role)
{
	char copy[TRACK_NAME_BYTES];
	double value;
	struct track_text f;
	size_t length = field_of(t, fields, count, role, &f) ? (size_t)(f.end - f.text) : sizeof copy;
	if (length >= sizeof copy)
		return NAN;
	memcpy(copy, f.text, length);
	/* where it does not separate, a comma is a decimal point */
	char *comma = t->commas ? memchr(copy, ',', length) : NULL;
	if (comma && !memchr(copy, '.', length))
		*comma = '.';
	return track_is_number(copy, copy + length, &value) ? value * (isnan(t->unit[role]) ? 1 : t->unit[role]) : NAN;
}

static double time_of(struct track_table *t, const struct track_text *fields, uint32_t count)
{
	struct track_text f;
	const char *at;
	double time_s = value_of(t, fields, count, TRACK_TIME), date_s = 0, size = fabs(time_s);
	/* seconds since 1970, or their thousandths, millionths, billionths */
	if (!isnan(time_s))
		return !isnan(t->unit[TRACK_TIME]) ? time_s : time_s * (size > 1e17 ? 1e-9 : size > 1e14 ? 1e-6 : size > 1e11 ? 1e-3 : 1);
	bool has_date = field_of(t, fields, count, TRACK_DATE, &f) && (at = f.text, track_date_time(&at, f.end, &date_s));
	if (!field_of(t, fields, count, TRACK_TIME, &f))
		return has_date ? date_s : NAN;
	at = f.text;
	if (track_date_time(&at, f.end, &time_s))
		return time_s;
	at = f.text;
	if (!track_clock(&at, f.end, &time_s))
		return NAN;
	if ((track_starts(at, f.end, " pm") || track_starts(at, f.end, "pm")) && time_s < DAY_S / 2)
		time_s += DAY_S / 2;
	if (!has_date && t->last_clock_s - time_s > DAY_S / 2)
		t->day_s += DAY_S;
	t->last_clock_s = time_s;
	return time_s + (has_date ? date_s : t->day_s);
}

/* Quaternion x, y, z, w to a rotation, row by row; false if it is zero or not finite. */
static bool rotation_of(double q[4], double r[9])
{
	double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(length > 1e-9 && length < 1e9))
		return false;
	double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
	const double rows[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w),
		1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y) };
	memcpy(r, rows, sizeof rows);
	return true;
}

struct eco_fix track_row(struct track_table *t, const struct track_text *fields, uint32_t count, uint32_t line, bool *posed)
{
	struct eco_fix fix = track_fix(line);
	double value[TRACK_ROLES], rotation[9];
	for (int role = TRACK_LON; role < TRACK_ROLES; role++)
		value[role] = value_of(t, fields, count, (enum track_role)role);
	const double *place = value + (track_has_degrees(t) ? TRACK_LON : TRACK_X);
	memcpy(fix.at, place, sizeof fix.at);
	/* ten-millionths of a degree, as autopilots log them */
	for (int i = 0; i < 2 && track_has_degrees(t); i++)
		fix.at[i] *= fabs(fix.at[i]) > 1000 ? 1e-7 : 1;
	fix.above_m = value[TRACK_ABOVE];
	if (t->column[TRACK_QW] >= 0 && rotation_of(value + TRACK_QX, rotation)) {
		double at[3] = { fix.at[0], fix.at[1], fix.at[2] };
		track_pose(&fix, t->in, rotation, at, ECO_AXES_OPENCV, ECO_WORLD_Z);
		*posed = true;
	} else {
		fix.yaw_deg = t->in->options->yaw_from_x ? 90 - value[TRACK_YAW] : value[TRACK_YAW];
		fix.pitch_deg = value[TRACK_PITCH];
		fix.roll_deg = value[TRACK_ROLL];
	}
	fix.fov_y_deg = value[TRACK_FOV];
	fix.time_s = time_of(t, fields, count);
	return fix;
}

void track_say_columns(struct eco_track *track, const struct track_table *t)
{
	char text[240] = "";
	size_t used = 0;
	bool degrees = track_has_degrees(t);
	for (int role = 0; role < TRACK_ROLES && used < sizeof text - 1; role++) {
		bool other = degrees ? role >= TRACK_X && role <= TRACK_Z : role >= TRACK_LON && role <= TRACK_ALT;
		if (t->column[role] >= 0 && !other)
			used += (size_t)snprintf(text + used, sizeof text - used, "%s%s=%.24s", used ? "," : "", role_names[role], t->label[role]);
	}
	if (used)
		eco_track_note(track, "columns taken: --columns %s", text);
	if (t->column[TRACK_YAW] >= 0 && !track->degrees && !t->in->options->yaw_from_x)
		eco_track_note(track, "its yaw is taken for a compass's, clockwise from north (--yaw-from-x if it turns counter-clockwise from +X)");
}
