/* Tables: CSV, and GPX as GDAL hands it over. Columns are found by the names that drones' logs and
 * spreadsheets give them; subtitles have the same names. A name is compared in lower case, by its letters
 * and digits; a unit in brackets or behind the last underline is taken off and used
 * ("height_above_takeoff(feet)", "x_east_m"). */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/track/track_read.h"

#define NAME_BYTES 64u
#define HEADER_ROWS 50u

struct table {
	uint32_t column[TRACK_ROLES];        /* ECO_NONE: none */
	double unit[TRACK_ROLES];            /* NaN: not stated */
	bool degrees;                        /* it has longitudes and latitudes */
};

/* each between spaces, the best first (a gimbal's pitch before an aircraft's) */
static const char *const names[TRACK_ROLES] = {
	[TRACK_TIME] = " t time timestamp times seconds elapsed elapsedtime unixtime epoch datetime "
		"datetimeutc utc gpstime offsettime flytime millisecond ",
	[TRACK_X] = " east easting x xeast e utmx px posx positionx camerax ",
	[TRACK_Y] = " north northing y ynorth n utmy py posy positiony cameray ",
	[TRACK_Z] = " up z zup pz posz positionz cameraz altitude alt altitudeabovesealevel altmsl absalt "
		"gpsaltitude gpsalt elevation ele elev height ",
	[TRACK_ABOVE] = " relalt relativealtitude heightabovetakeoff relativeheight heightagl agl barometer "
		"h hb ",
	[TRACK_YAW] = " gimbalyaw gimbalheading gbyaw camerayaw cameraheading yaw heading compassheading "
		"bearing direction course track ",
	[TRACK_PITCH] = " gimbalpitch gbpitch camerapitch gimbalpitchangle pitch tilt ",
	[TRACK_ROLL] = " gimbalroll gbroll cameraroll roll ",
	[TRACK_FOV] = " fovy fov fieldofview verticalfov ",
	[TRACK_LON] = " lon longitude lng long longtitude gpslongitude gpslon positionlong ",
	[TRACK_LAT] = " lat latitude gpslatitude gpslat positionlat ",
	[TRACK_DATE] = " date day gpsdate dateutc ",
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

enum track_role track_role_of(const char *text, uint32_t *rank, double *unit)
{
	char word[NAME_BYTES] = " ";
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
	word[length] = ' ';
	enum track_role role = 0;
	while (role < TRACK_ROLES && !(at = strstr(names[role], word)))
		role++;
	*rank = at ? (uint32_t)(at - names[role]) : 0;
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
		enum track_role role = track_role_of(columns[c], &rank, &unit);
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

bool track_number(const char **text, double *value)
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

bool track_clock(const char **text, double *time_s)
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
	track_clock(&at, &clock_s);
	strptime(at, "%z", &zone);
	return (double)(timegm(&day) - zone.tm_gmtoff) + clock_s;
}

/* The whole of the field, or NaN. */
static double number_of(const char *field)
{
	double value;
	return track_number(&field, &value) && !field[strspn(field, " \t")] ? value : NAN;
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
	return track_clock(&time, &time_s) ? time_s + (isnan(date_s) ? 0 : date_s) : date_s;
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
		if ((code = track_add(track, &fix, error)))
			return code;
	}
	return code;
}

/* The header is the first row in which a position is found, so that preambles may precede it. */
static enum eco_code find_header(struct table *table, struct eco_rows *rows, const char *path,
	const char *formats, struct eco_error *error)
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
		"t,x,y,z, and yaw,pitch. %s", path, list, formats);
}

static enum eco_code read_layer(struct eco_track *track, const char *layer, const char *formats,
	struct eco_error *error)
{
	struct eco_rows_source source = { .path = track->path, .layer = layer, .partial = true };
	struct eco_rows *rows;
	struct table table;
	enum eco_code code = layer ? eco_rows_open_here(&rows, &source, error)
		: eco_rows_open_csv(&rows, track->path, 0, error);
	if (code)
		return code;
	code = find_header(&table, rows, track->path, formats, error);
	track->degrees = rows->has_geometry ? !rows->degrees_doubted : table.degrees;
	code = code ? code : read_rows(track, &table, rows, error);
	for (uint32_t i = 0; i < rows->note_count; i++)
		eco_track_note(track, "%s", rows->notes[i]);
	eco_rows_close(rows);
	return code;
}

enum eco_code track_read_rows(struct eco_track *track, const char *formats, struct eco_error *error)
{
	static const char *const layers[] = { "track_points", "route_points", "waypoints" };
	enum eco_code code = ECO_OK;
	if (track->format == ECO_TRACK_CSV)
		return read_layer(track, NULL, formats, error);
	for (int i = 0; !code && !track->count && i < 3; i++)
		code = read_layer(track, layers[i], formats, error);
	if (!strstr(track->text, "</gpx>"))       /* GDAL is silent where a recorder's battery died */
		eco_track_note(track, "the file breaks off: %u points are read", track->records);
	return code;
}
