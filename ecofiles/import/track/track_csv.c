/* Tables: columns found by the names that loggers, planners and spreadsheets give them, in several languages, or as the options say.
 *
 * A name is compared in lower case without what is no letter or digit; a unit in brackets or behind the last underline is taken off
 * and used ("height_above_takeoff(feet)", "x_east_m", "OSD.height [m]"). Each meaning has a list of names, best first (a gimbal's
 * pitch before an aircraft's). The header is the first line in which a position is found, so preambles and comments may precede it. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define FIELDS_MAX 512u
#define NAME_MAX 64u
#define HEADER_LINES 50u
#define DAY_S 86400.0

enum role { TIME, DATE, LON, LAT, ALT, ABOVE, X, Y, Z, YAW, PITCH, ROLL, QX, QY, QZ, QW, FOV, ROLES };

static const char *const role_names[ROLES] = { "t", "date", "lon", "lat", "alt", "rel", "east", "north", "up", "yaw", "pitch", "roll",
	"qx", "qy", "qz", "qw", "fov" };

static const char *const names[ROLES][28] = {
	[TIME] = { "t", "time", "timestamp", "times", "seconds", "sec", "secs", "elapsed", "elapsedtime", "elapsedseconds", "timeelapsed", "unixtime",
		"unix", "epoch", "datetime", "datetimeutc", "dateandtime", "utc", "utctime", "gpstime", "gpsdatetime", "timeutc", "offsettime", "flytime",
		"millisecond", "zeit", "rostime" },
	[DATE] = { "date", "day", "datum", "fecha", "gpsdate", "dateutc" },
	[LON] = { "lon", "longitude", "lng", "long", "longtitude", "gpslongitude", "gpslon", "gpslong", "londeg", "longdd", "laenge", "lngengrad", "lnge",
		"laengengrad", "longitud", "positionlong", "wgs84longitude" },
	[LAT] = { "lat", "latitude", "gpslatitude", "gpslat", "latdeg", "latdd", "breite", "breitengrad", "latitud", "positionlat", "wgs84latitude" },
	[ALT] = { "altitude", "alt", "altitudeabovesealevel", "altmsl", "amsl", "absalt", "altitudemsl", "absolutealtitude", "gpsaltitude", "gpsalt",
		"gpsheightmsl", "elevation", "ele", "elev", "enhancedaltitude", "hoehe", "hhe", "altitud", "z", "height", "up", "zup", "h" },
	[ABOVE] = { "relalt", "relativealtitude", "heightabovetakeoff", "altituderelative", "relativeheight", "osdheight", "heightagl", "agl",
		"altitudeagl", "altagl", "barometer", "relheight" },
	[X] = { "east", "easting", "x", "xeast", "e", "eastm", "utmx", "utme", "utmeasting", "px", "posx", "positionx", "tx", "camerax", "locationx",
		"xutm", "rechtswert", "prsrx", "xm", "camx" },
	[Y] = { "north", "northing", "y", "ynorth", "n", "northm", "utmy", "utmn", "utmnorthing", "py", "posy", "positiony", "ty", "cameray", "locationy",
		"yutm", "hochwert", "prsry", "ym", "camy" },
	[Z] = { "up", "z", "zup", "pz", "posz", "positionz", "tz", "cameraz", "locationz", "height", "altitude", "alt", "elevation", "ele", "h", "hoehe",
		"hhe", "prsrz", "zm", "camz" },
	[YAW] = { "gimbalyaw", "gimbalheading", "gbyaw", "camerayaw", "cameraheading", "gimbalyawdegree", "yaw", "heading", "compassheading", "hdg",
		"azimuth", "headingdeg", "bearing", "direction", "course", "cog", "courseoverground", "track", "kurs", "psi" },
	[PITCH] = { "gimbalpitch", "gbpitch", "camerapitch", "gimbalpitchangle", "gimbalpitchdegree", "cameratilt", "pitch", "tilt", "theta" },
	[ROLL] = { "gimbalroll", "gbroll", "cameraroll", "gimbalrolldegree", "roll", "bank" },
	[QX] = { "qx", "quatx", "quaternionx", "orientationx", "rotationx", "qrsx" },
	[QY] = { "qy", "quaty", "quaterniony", "orientationy", "rotationy", "qrsy" },
	[QZ] = { "qz", "quatz", "quaternionz", "orientationz", "rotationz", "qrsz" },
	[QW] = { "qw", "quatw", "quaternionw", "orientationw", "rotationw", "qrsw" },
	[FOV] = { "fovy", "fov", "fieldofview", "verticalfov", "vfov" },
};

struct field { const char *text, *end; };

struct csv {
	const struct track_input *in;
	char separator;                      /* ' ': any number of spaces */
	int column[ROLES];                   /* -1: none */
	double unit[ROLES];                  /* NaN: not stated */
	char label[ROLES][NAME_MAX];
	double day_s, last_clock_s;
};

/* ---- Lines to fields ---- */

static struct field trim(struct field f)
{
	while (f.text < f.end && (*f.text == ' ' || *f.text == '\t'))
		f.text++;
	while (f.end > f.text && (f.end[-1] == ' ' || f.end[-1] == '\t'))
		f.end--;
	if (f.end - f.text >= 2 && *f.text == '"' && f.end[-1] == '"') {
		f.text++;
		f.end--;
	}
	return f;
}

static uint32_t split(const struct track_line *line, char separator, struct field fields[FIELDS_MAX])
{
	const char *at = line->text;
	uint32_t count = 0;
	while (separator == ' ' && at < line->end && (*at == ' ' || *at == '\t'))
		at++;
	while (count < FIELDS_MAX) {
		const char *from = at;
		bool quoted = false;
		while (at < line->end && (quoted || (*at != separator && !(separator == ' ' && *at == '\t'))))
			quoted ^= *at++ == '"';
		fields[count++] = trim((struct field){ from, at });
		while (separator == ' ' && at + 1 < line->end && (at[1] == ' ' || at[1] == '\t'))
			at++;
		if (at++ >= line->end || (separator == ' ' && at >= line->end))
			break;
	}
	return count;
}

static char find_separator(const struct track_line *line)
{
	static const char marks[] = { ';', '\t', ',', '|' };
	for (size_t i = 0; i < sizeof marks; i++)
		if (memchr(line->text, marks[i], (size_t)(line->end - line->text)))
			return marks[i];
	return ' ';
}

/* ---- Names ---- */

static double unit_factor(const char *text, const char *end, bool *known)
{
	static const struct { const char *name; double factor; } units[] = { { "s", 1 }, { "sec", 1 }, { "seconds", 1 }, { "second", 1 }, { "ms", 1e-3 },
		{ "msec", 1e-3 }, { "millisecond", 1e-3 }, { "milliseconds", 1e-3 }, { "us", 1e-6 }, { "ns", 1e-9 }, { "m", 1 }, { "meters", 1 },
		{ "meter", 1 }, { "metres", 1 }, { "ft", 0.3048 }, { "feet", 0.3048 }, { "foot", 0.3048 }, { "km", 1000 }, { "cm", 0.01 }, { "mm", 0.001 },
		{ "deg", 1 }, { "degrees", 1 }, { "degree", 1 }, { "rad", 57.29577951308232 }, { "radians", 57.29577951308232 }, { "360", 1 }, { "", 1 } };
	*known = true;
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strlen(units[i].name) == (size_t)(end - text) && track_starts(text, end, units[i].name))
			return units[i].factor;
	*known = false;
	return NAN;
}

/* Letters and digits in lower case, without the unit. */
static void plain_name(struct field f, char name[NAME_MAX], double *unit)
{
	size_t length = 0;
	bool known;
	const char *end = f.end, *open = f.text;
	*unit = NAN;
	while (open < f.end && *open != '(' && *open != '[')
		open++;
	if (open < f.end && open > f.text) {
		const char *close = open + 1;
		while (close < f.end && *close != ')' && *close != ']')
			close++;
		double factor = unit_factor(open + 1, close, &known);
		*unit = known && close > open + 1 ? factor : NAN;
		end = open;
	} else {
		const char *mark = f.end;
		while (mark > f.text && mark[-1] != '_' && mark[-1] != ' ')
			mark--;
		double factor = unit_factor(mark, f.end, &known);
		if (mark > f.text && mark < f.end && known) {
			*unit = factor;
			end = mark;
		}
	}
	for (const char *c = f.text; c < end && length < NAME_MAX - 1; c++)
		if (isalnum((unsigned char)*c))
			name[length++] = (char)tolower((unsigned char)*c);
	name[length] = 0;
}

/* What follows the last dot or slash: "OSD.latitude", "/pose/position/x" gives "positionx" by its last two. */
static struct field last_part(struct field f)
{
	for (const char *c = f.end; c > f.text; c--)
		if (c[-1] == '.' || c[-1] == '/' || c[-1] == ':')
			return (struct field){ c, f.end };
	return f;
}

/* A column means one thing; only a height serves degrees and metres alike. */
static bool is_taken(const struct csv *csv, uint32_t column, enum role by)
{
	for (int role = 0; role < ROLES; role++)
		if (csv->column[role] == (int)column && !((by == Z && role == ALT) || (by == ALT && role == Z)))
			return true;
	return false;
}

static int find_column(const struct csv *csv, const struct field *fields, uint32_t count, enum role role, double *unit, bool parts)
{
	char name[NAME_MAX];
	for (int i = 0; names[role][i]; i++)
		for (uint32_t c = 0; c < count; c++) {
			if (is_taken(csv, c, role))
				continue;
			plain_name(parts ? last_part(fields[c]) : fields[c], name, unit);
			if (strcmp(name, names[role][i]) == 0)
				return (int)c;
		}
	return -1;
}

static bool has_place(const struct csv *csv)
{
	return (csv->column[LON] >= 0 && csv->column[LAT] >= 0) || (csv->column[X] >= 0 && csv->column[Y] >= 0);
}

static void take_column(struct csv *csv, const struct field *fields, enum role role, int column, double unit)
{
	csv->column[role] = column;
	csv->unit[role] = unit;
	snprintf(csv->label[role], NAME_MAX, "%.*s", (int)(fields[column].end - fields[column].text), fields[column].text);
}

/* By name; columns that the options gave stay. */
static bool read_header(struct csv *csv, const struct field *fields, uint32_t count)
{
	for (int parts = 0; parts < 2; parts++)
		for (int role = 0; role < ROLES; role++) {
			double unit;
			int column = csv->column[role] >= 0 ? -1 : find_column(csv, fields, count, (enum role)role, &unit, parts != 0);
			if (column >= 0)
				take_column(csv, fields, (enum role)role, column, unit);
		}
	return has_place(csv);
}

/* ---- Columns by option: t=Time,lon=X,lat=Y,alt=Z:ft ---- */

static enum eco_code option_column(struct csv *csv, struct field item, const struct field *fields, uint32_t count, struct eco_error *error)
{
	const char *equals = memchr(item.text, '=', (size_t)(item.end - item.text));
	int role = 0;
	while (equals && role < ROLES && !((size_t)(equals - item.text) == strlen(role_names[role]) && track_starts(item.text, equals, role_names[role])))
		role++;
	if (!equals || role == ROLES)
		return eco_fail(error, ECO_BAD_USAGE, "--columns %.*s: must be ROLE=COLUMN with t, date, lon, lat, alt, rel, east, north, up, yaw, pitch, "
			"roll, qx, qy, qz, qw or fov", (int)(item.end - item.text < 100 ? item.end - item.text : 100), item.text);
	struct field name = { equals + 1, item.end };
	double unit = NAN, number;
	bool known = false;
	for (const char *c = item.end; c > name.text && !known; c--)
		if (c[-1] == ':') {
			unit = unit_factor(c, item.end, &known);
			name.end = known ? c - 1 : name.end;
		}
	for (uint32_t c = 0; c < count; c++)
		if (fields[c].end - fields[c].text == name.end - name.text && memcmp(fields[c].text, name.text, (size_t)(name.end - name.text)) == 0) {
			double stated;
			char plain[NAME_MAX];
			plain_name(fields[c], plain, &stated);
			take_column(csv, fields, (enum role)role, (int)c, known ? unit : stated);
			return ECO_OK;
		}
	if (track_is_number(name.text, name.end, &number) && number >= 1 && number <= count && number == floor(number)) {
		take_column(csv, fields, (enum role)role, (int)number - 1, unit);
		return ECO_OK;
	}
	return eco_fail(error, ECO_NOT_FOUND, "no column \"%.*s\"", (int)(name.end - name.text < 100 ? name.end - name.text : 100), name.text);
}

static enum eco_code option_columns(struct csv *csv, const struct field *fields, uint32_t count, struct eco_error *error)
{
	const char *at = csv->in->options->columns, *end = at + strlen(at);
	enum eco_code code = ECO_OK;
	while (!code && at < end) {
		const char *comma = memchr(at, ',', (size_t)(end - at));
		struct field item = { at, comma ? comma : end };
		code = option_column(csv, item, fields, count, error);
		at = item.end + 1;
	}
	return code;
}

static enum eco_code no_columns(const struct csv *csv, struct eco_error *error)
{
	struct track_line line = { 0 };
	char first[160] = "";
	while (!first[0] && track_next_line(csv->in, &line))
		for (size_t i = 0; i < sizeof first - 1 && line.text + i < line.end; i++)
			first[i] = line.text[i];
	return eco_fail(error, ECO_BAD_INPUT, "%.200s: no format is known that looks like this, and as a table it has no columns for a position; it "
		"begins \"%s\". If it is a table, say --columns t=NAME,lon=NAME,lat=NAME,alt=NAME or east=, north=, up= (or numbers of columns)",
		csv->in->path, first);
}

/* Finds the header, if there is one: the line is then read; else *line is as before the first row. */
static enum eco_code find_header(struct csv *csv, struct track_line *line, struct field *fields, struct eco_error *error)
{
	struct eco_error cause = { 0 };
	struct track_line at = { 0 }, before = { 0 };
	while (at.number < HEADER_LINES && track_next_line(csv->in, &at)) {
		struct track_line text = at;
		while (text.text < text.end && strchr("#% \t", *text.text))
			text.text++;
		csv->separator = find_separator(&text);
		uint32_t count = split(&text, csv->separator, fields);
		double number;
		for (int role = 0; role < ROLES; role++)
			csv->column[role] = -1;
		if (text.text == text.end || count < 2)
			continue;
		bool numbers = track_is_number(fields[0].text, fields[0].end, &number) && track_is_number(fields[1].text, fields[1].end, &number);
		if (csv->in->options->columns && option_columns(csv, fields, count, &cause))
			continue;
		if ((csv->in->options->columns && has_place(csv)) || read_header(csv, fields, count)) {
			*line = numbers ? before : at;
			return ECO_OK;
		}
		before = at;
	}
	return cause.code ? eco_fail(error, cause.code, "%.200s: %s", csv->in->path, cause.text) : no_columns(csv, error);
}

/* ---- Rows ---- */

static double value_of(const struct csv *csv, const struct field *fields, uint32_t count, enum role role)
{
	char copy[64];
	double value;
	if (csv->column[role] < 0 || (uint32_t)csv->column[role] >= count)
		return NAN;
	struct field f = fields[csv->column[role]];
	size_t length = (size_t)(f.end - f.text);
	if (length >= sizeof copy)
		return NAN;
	memcpy(copy, f.text, length);
	/* where it does not separate, a comma is a decimal point */
	char *comma = csv->separator != ',' ? memchr(copy, ',', length) : NULL;
	if (comma && !memchr(copy, '.', length))
		*comma = '.';
	if (!track_is_number(copy, copy + length, &value))
		return NAN;
	return value * (isnan(csv->unit[role]) ? 1 : csv->unit[role]);
}

static double time_of(struct csv *csv, const struct field *fields, uint32_t count)
{
	double time_s = value_of(csv, fields, count, TIME), date_s = 0;
	bool has_date = csv->column[DATE] >= 0 && (uint32_t)csv->column[DATE] < count;
	if (!isnan(time_s)) {
		double t = fabs(time_s);
		/* seconds since 1970, or their thousandths, millionths, billionths */
		return !isnan(csv->unit[TIME]) ? time_s : t > 1e17 ? time_s * 1e-9 : t > 1e14 ? time_s * 1e-6 : t > 1e11 ? time_s * 1e-3 : time_s;
	}
	if (has_date) {
		const struct field *f = &fields[csv->column[DATE]];
		const char *at = f->text;
		has_date = track_date_time(&at, f->end, &date_s);
	}
	if (csv->column[TIME] < 0 || (uint32_t)csv->column[TIME] >= count)
		return has_date ? date_s : NAN;
	const struct field *f = &fields[csv->column[TIME]];
	const char *at = f->text;
	if (track_date_time(&at, f->end, &time_s))
		return time_s;
	at = f->text;
	if (!track_clock(&at, f->end, &time_s))
		return NAN;
	if (at + 1 < f->end && (track_starts(at, f->end, " pm") || track_starts(at, f->end, "pm")) && time_s < DAY_S / 2)
		time_s += DAY_S / 2;
	if (!has_date && csv->last_clock_s - time_s > DAY_S / 2)
		csv->day_s += DAY_S;
	csv->last_clock_s = time_s;
	return time_s + (has_date ? date_s : csv->day_s);
}

static bool is_degrees(const struct csv *csv) { return csv->column[LON] >= 0 && csv->column[LAT] >= 0; }

static enum eco_code add_row(struct eco_track *track, struct csv *csv, const struct field *fields, uint32_t count, uint32_t line,
	struct eco_error *error)
{
	struct eco_fix fix = track_fix(line);
	bool degrees = is_degrees(csv);
	double q[4], rotation[9];
	fix.at[0] = value_of(csv, fields, count, degrees ? LON : X);
	fix.at[1] = value_of(csv, fields, count, degrees ? LAT : Y);
	fix.at[2] = value_of(csv, fields, count, degrees ? ALT : Z);
	/* ten-millionths of a degree, as autopilots log them */
	for (int i = 0; i < 2 && degrees; i++)
		fix.at[i] *= fabs(fix.at[i]) > 1000 ? 1e-7 : 1;
	fix.above_m = value_of(csv, fields, count, ABOVE);
	for (int i = 0; i < 4; i++)
		q[i] = value_of(csv, fields, count, (enum role)(QX + i));
	if (csv->column[QW] >= 0 && track_rotation(q, rotation)) {
		double at[3] = { fix.at[0], fix.at[1], fix.at[2] };
		track_pose(&fix, rotation, at, track_axes_of(csv->in, ECO_AXES_OPENCV, ECO_WORLD_Z));
		track->posed = true;
	} else {
		fix.yaw_deg = value_of(csv, fields, count, YAW);
		fix.pitch_deg = value_of(csv, fields, count, PITCH);
		fix.roll_deg = value_of(csv, fields, count, ROLL);
		if (csv->in->options->yaw_from_x)
			fix.yaw_deg = 90 - fix.yaw_deg;
	}
	fix.fov_y_deg = value_of(csv, fields, count, FOV);
	fix.time_s = time_of(csv, fields, count);
	return track_add(track, &fix, error);
}

static void say_columns(struct eco_track *track, const struct csv *csv)
{
	char text[240] = "";
	size_t used = 0;
	bool degrees = is_degrees(csv);
	for (int role = 0; role < ROLES && used < sizeof text - 1; role++) {
		if (csv->column[role] < 0 || (degrees ? role == X || role == Y || role == Z : role == ALT || role == LON || role == LAT))
			continue;
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%s=%.24s", used ? "," : "", role_names[role], csv->label[role]);
	}
	eco_track_note(track, "columns taken: --columns %s", text);
	if (csv->column[YAW] >= 0 && !degrees && !csv->in->options->yaw_from_x)
		eco_track_note(track, "its yaw is taken for a compass's, clockwise from north (--yaw-from-x if it turns counter-clockwise from +X)");
}

enum eco_code track_read_csv(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct csv csv = { .in = in };
	struct track_line line = { 0 };
	struct field *fields = malloc(FIELDS_MAX * sizeof *fields);
	enum eco_code code = fields ? find_header(&csv, &line, fields, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	track->degrees = !code && is_degrees(&csv);
	while (!code && track_next_line(in, &line)) {
		struct track_line text = line;
		while (text.text < text.end && (*text.text == ' ' || *text.text == '\t'))
			text.text++;
		if (text.text == text.end || *text.text == '#')
			continue;
		code = add_row(track, &csv, fields, split(&line, csv.separator, fields), line.number, error);
	}
	if (!code)
		say_columns(track, &csv);
	free(fields);
	return code;
}
