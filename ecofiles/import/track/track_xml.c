/* Tracks in XML: GPX, KML (with gx:Track and gx:Tour) and TCX, in one walk, as their elements have no name in common that means two
 * things. Names count without their namespace, as few files declare them right. A file may hold several kinds of points; the best kind
 * that is there is taken: a tour's cameras, else tracks, else routes and lines, else single points. */
#include <expat.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define METRES_PER_DEGREE 111195.0
#define RAD 0.017453292519943295
#define KIND_SHIFT 28                    /* in a fix's segment, until the best kind is known */

enum kind { POINT, LINE, TRACK, TOUR, KINDS };

struct list { double *values; uint32_t count; };

struct xml {
	struct eco_track *track;
	struct eco_error *error;
	enum eco_code code;
	XML_Parser parser;
	char *text; size_t length, capacity;
	struct eco_fix fix;                  /* the point being read */
	uint32_t segment, kinds[KINDS];
	/* KML */
	struct list whens, angles;           /* of this gx:Track; angles: three a point */
	uint32_t track_first, coords;
	bool in_track, in_line, in_fly, in_look, above_ground;
	double range_m, tilt_deg, stamp_s, tour_s;
};

static void stop(struct xml *x, enum eco_code code)
{
	x->code = code;
	XML_StopParser(x->parser, XML_FALSE);
}

static const char *local(const char *name)
{
	const char *colon = strrchr(name, ':');
	return colon ? colon + 1 : name;
}

static bool is(const char *name, const char *wanted) { return strcmp(name, wanted) == 0; }

static void add(struct xml *x, const struct eco_fix *fix, enum kind kind)
{
	struct eco_fix f = *fix;
	f.segment = (x->segment & ((1u << KIND_SHIFT) - 1)) | (uint32_t)kind << KIND_SHIFT;
	uint32_t before = x->track->count;
	enum eco_code code = track_add(x->track, &f, x->error);
	x->kinds[kind] += x->track->count - before;
	if (code)
		stop(x, code);
}

static void append(struct xml *x, struct list *list, double value)
{
	if ((list->count & (list->count - 1)) == 0) {
		size_t room = list->count ? 2 * (size_t)list->count : 1;
		double *grown = list->count < 3 * ECO_TRACK_FIXES_MAX ? realloc(list->values, room * sizeof *grown) : NULL;
		if (!grown) {
			stop(x, eco_fail(x->error, ECO_NO_MEMORY, "no memory for %u values", list->count));
			return;
		}
		list->values = grown;
	}
	list->values[list->count++] = value;
}

/* ---- Texts of elements ---- */

static double text_number(const struct xml *x)
{
	const char *at = x->text;
	double value;
	while (*at == '\n' || *at == '\r' || *at == ' ' || *at == '\t')
		at++;
	return track_number(&at, x->text + x->length, &value) ? value : NAN;
}

static double text_time(const struct xml *x)
{
	const char *at = x->text;
	double value;
	while (*at == '\n' || *at == '\r' || *at == ' ' || *at == '\t')
		at++;
	return track_date_time(&at, x->text + x->length, &value) ? value : NAN;
}

static void set_height(const struct xml *x, struct eco_fix *fix, double z)
{
	fix->at[2] = x->above_ground ? NAN : z;
	fix->above_m = x->above_ground ? z : NAN;
}

/* One "lon,lat,alt" or "lon lat alt"; commas may have spaces after them in files written by hand, so a comma always continues. */
static bool read_coordinate(const char **text, const char *end, double v[3])
{
	const char *at = *text;
	int count = 0;
	while (at < end && strchr(" \t\r\n", *at))
		at++;
	v[2] = NAN;
	while (count < 3 && track_number(&at, end, &v[count])) {
		count++;
		if (at >= end || *at != ',')
			break;
		at++;
	}
	*text = at;
	return count >= 2;
}

static void read_coordinates(struct xml *x, enum kind kind)
{
	const char *at = x->text, *end = x->text + x->length;
	double v[3];
	uint32_t line = (uint32_t)XML_GetCurrentLineNumber(x->parser);
	x->segment += kind == LINE;
	while (!x->code && read_coordinate(&at, end, v)) {
		struct eco_fix fix = track_fix(line);
		fix.at[0] = v[0];
		fix.at[1] = v[1];
		set_height(x, &fix, v[2]);
		fix.time_s = kind == POINT ? x->stamp_s : NAN;
		add(x, &fix, kind);
	}
	x->segment += kind == LINE;
	if (kind == POINT)
		x->stamp_s = NAN;
}

/* ---- KML ---- */

static void read_gx_numbers(struct xml *x, double v[3])
{
	const char *at = x->text, *end = x->text + x->length;
	v[0] = v[1] = v[2] = NAN;
	for (int i = 0; i < 3; i++) {
		while (at < end && strchr("\r\n", *at))
			at++;
		if (!track_number(&at, end, &v[i]))
			return;
	}
}

static void end_gx_track(struct xml *x)
{
	for (uint32_t i = x->track_first; i < x->track->count; i++) {
		struct eco_fix *fix = &x->track->fixes[i];
		uint32_t at = fix->line - 1;
		fix->time_s = at < x->whens.count ? x->whens.values[at] : NAN;
		x->track->timed |= !isnan(fix->time_s);
		if (at < x->angles.count / 3)
			fix->yaw_deg = x->angles.values[3 * at];
	}
	x->whens.count = x->angles.count = 0;
	x->in_track = false;
}

/* A LookAt says what is looked at, and from which side; the eye is `range` away. */
static void end_fly(struct xml *x)
{
	struct eco_fix fix = x->fix;
	double tilt = (isnan(x->tilt_deg) ? 0 : x->tilt_deg) * RAD, yaw = (isnan(fix.yaw_deg) ? 0 : fix.yaw_deg) * RAD;
	if (x->in_look) {
		double back_m = x->range_m * sin(tilt), up_m = x->range_m * cos(tilt);
		fix.at[0] -= back_m * sin(yaw) / (METRES_PER_DEGREE * cos(fix.at[1] * RAD));
		fix.at[1] -= back_m * cos(yaw) / METRES_PER_DEGREE;
		fix.at[2] += up_m;
		fix.above_m += up_m;
	}
	fix.yaw_deg = isnan(fix.yaw_deg) ? 0 : fix.yaw_deg;
	fix.pitch_deg = tilt / RAD - 90;
	fix.time_s = x->tour_s;
	x->in_look = false;
	add(x, &fix, TOUR);
}

static bool end_kml(struct xml *x, const char *name)
{
	double v[3];
	if (is(name, "coord") && x->in_track) {
		struct eco_fix fix = track_fix(++x->coords);
		read_gx_numbers(x, v);
		fix.at[0] = v[0];
		fix.at[1] = v[1];
		set_height(x, &fix, v[2]);
		add(x, &fix, TRACK);
	} else if (is(name, "when")) {
		x->stamp_s = text_time(x);
		if (x->in_track)
			append(x, &x->whens, x->stamp_s);
	} else if (is(name, "angles") && x->in_track) {
		read_gx_numbers(x, v);
		for (int i = 0; i < 3; i++)
			append(x, &x->angles, v[i]);
	} else if (is(name, "altitudeMode"))
		x->above_ground = strstr(x->text, "relativeTo") != NULL;
	else if (is(name, "Track"))
		end_gx_track(x);
	else if (is(name, "duration"))
		x->tour_s += fmax(0, text_number(x));
	else if (x->in_fly && (is(name, "Camera") || is(name, "LookAt")))
		end_fly(x);
	else if (is(name, "FlyTo"))
		x->in_fly = false;
	else
		return false;
	return true;
}

static void end_fly_field(struct xml *x, const char *name)
{
	if (is(name, "longitude"))
		x->fix.at[0] = text_number(x);
	else if (is(name, "latitude"))
		x->fix.at[1] = text_number(x);
	else if (is(name, "heading"))
		x->fix.yaw_deg = text_number(x);
	else if (is(name, "tilt"))
		x->tilt_deg = text_number(x);
	else if (is(name, "roll"))
		x->fix.roll_deg = -text_number(x);
	else if (is(name, "range"))
		x->range_m = text_number(x);
	else if (is(name, "horizFov"))
		x->fix.fov_y_deg = 2 * atan(tan(text_number(x) * RAD / 2) * 9 / 16) / RAD;
	else if (is(name, "altitude"))
		set_height(x, &x->fix, text_number(x));
}

/* ---- GPX and TCX ---- */

static void end_point_field(struct xml *x, const char *name)
{
	if (is(name, "ele") || is(name, "AltitudeMeters"))
		x->fix.at[2] = text_number(x);
	else if (is(name, "time") || is(name, "Time"))
		x->fix.time_s = text_time(x);
	else if (is(name, "LatitudeDegrees"))
		x->fix.at[1] = text_number(x);
	else if (is(name, "LongitudeDegrees"))
		x->fix.at[0] = text_number(x);
	else if (is(name, "heading") || is(name, "yaw") || is(name, "gimbal_yaw"))
		x->fix.yaw_deg = text_number(x);
	else if (is(name, "pitch") || is(name, "gimbal_pitch"))
		x->fix.pitch_deg = text_number(x);
	else if (is(name, "roll") || is(name, "gimbal_roll"))
		x->fix.roll_deg = text_number(x);
}

/* ---- expat ---- */

static void open_point(struct xml *x, const XML_Char **attributes)
{
	x->fix = track_fix((uint32_t)XML_GetCurrentLineNumber(x->parser));
	x->tilt_deg = x->range_m = NAN;
	for (int i = 0; attributes[i]; i += 2) {
		const char *at = attributes[i + 1];
		double value;
		if (!track_number(&at, at + strlen(at), &value))
			continue;
		if (is(attributes[i], "lat"))
			x->fix.at[1] = value;
		else if (is(attributes[i], "lon"))
			x->fix.at[0] = value;
	}
}

static void XMLCALL on_start(void *ctx, const XML_Char *full, const XML_Char **attributes)
{
	struct xml *x = ctx;
	const char *name = local(full);
	x->length = 0;
	if (is(name, "kml"))
		x->track->format = ECO_TRACK_KML;
	else if (is(name, "TrainingCenterDatabase"))
		x->track->format = ECO_TRACK_TCX;
	else if (is(name, "trkpt") || is(name, "rtept") || is(name, "wpt") || is(name, "Trackpoint"))
		open_point(x, attributes);
	else if (is(name, "trkseg") || is(name, "rte") || is(name, "Track")) {
		x->segment++;
		x->in_track = x->track->format == ECO_TRACK_KML && is(name, "Track");
		x->track_first = x->track->count;
		x->coords = 0;
		x->above_ground = false;
	} else if (is(name, "FlyTo"))
		x->in_fly = true;
	else if (x->in_fly && (is(name, "Camera") || is(name, "LookAt"))) {
		open_point(x, attributes);
		x->in_look = is(name, "LookAt");
		x->above_ground = false;
	} else if (is(name, "LineString") || is(name, "Point") || is(name, "LinearRing")) {
		x->in_line = !is(name, "Point");
		x->above_ground = false;
	}
}

static void XMLCALL on_text(void *ctx, const XML_Char *text, int length)
{
	struct xml *x = ctx;
	size_t needed = x->length + (size_t)length + 1;
	if (needed > x->capacity) {
		size_t capacity = needed * 2 + 256;
		char *grown = realloc(x->text, capacity);
		if (!grown) {
			stop(x, eco_fail(x->error, ECO_NO_MEMORY, "no memory for a text"));
			return;
		}
		x->text = grown;
		x->capacity = capacity;
	}
	memcpy(x->text + x->length, text, (size_t)length);
	x->length += (size_t)length;
	x->text[x->length] = 0;
}

static void XMLCALL on_end(void *ctx, const XML_Char *full)
{
	struct xml *x = ctx;
	const char *name = local(full);
	on_text(x, "", 0);
	if (x->code)
		return;
	if (is(name, "trkpt") || is(name, "Trackpoint"))
		add(x, &x->fix, TRACK);
	else if (is(name, "rtept"))
		add(x, &x->fix, LINE);
	else if (is(name, "wpt"))
		add(x, &x->fix, POINT);
	else if (is(name, "coordinates"))
		read_coordinates(x, x->in_line ? LINE : POINT);
	else if (x->track->format == ECO_TRACK_KML ? !end_kml(x, name) && x->in_fly : true) {
		if (x->in_fly)
			end_fly_field(x, name);
		else
			end_point_field(x, name);
	}
	x->length = 0;
}

static void keep_best(struct xml *x)
{
	struct eco_track *track = x->track;
	int best = KINDS - 1;
	uint32_t kept = 0;
	while (best > 0 && x->kinds[best] == 0)
		best--;
	for (uint32_t i = 0; i < track->count; i++)
		if ((int)(track->fixes[i].segment >> KIND_SHIFT) == best) {
			track->fixes[kept] = track->fixes[i];
			track->fixes[kept++].segment &= (1u << KIND_SHIFT) - 1;
		}
	if (kept < track->count)
		eco_track_note(track, "%u %s are taken; the file has %u other points (way points, lines) beside them", kept,
			best == TOUR ? "cameras of a tour" : best == TRACK ? "track points" : "points of routes or lines", track->count - kept);
	track->posed = best == TOUR;
	track->records -= track->count - kept;
	track->count = kept;
}

enum eco_code track_read_xml(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct xml x = { .track = track, .error = error, .stamp_s = NAN, .fix = track_fix(0) };
	enum XML_Status status = XML_STATUS_OK;
	x.parser = XML_ParserCreate(NULL);
	if (!x.parser)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for an XML parser");
	track->format = ECO_TRACK_GPX;
	track->degrees = true;
	XML_SetUserData(x.parser, &x);
	XML_SetElementHandler(x.parser, on_start, on_end);
	XML_SetCharacterDataHandler(x.parser, on_text);
	for (size_t at = 0; status == XML_STATUS_OK && at < in->size; at += 1u << 20) {
		size_t size = in->size - at < 1u << 20 ? in->size - at : 1u << 20;
		status = XML_Parse(x.parser, in->text + at, (int)size, at + size == in->size);
	}
	if (status != XML_STATUS_OK && !x.code) {
		/* a recorder whose battery died leaves a file without an end: what is there is good */
		if (XML_GetErrorCode(x.parser) == XML_ERROR_NO_ELEMENTS || XML_GetErrorCode(x.parser) == XML_ERROR_UNCLOSED_TOKEN) {
			if (track->count)
				eco_track_note(track, "the file ends before its end, in line %lu: what was read until there is taken",
					(unsigned long)XML_GetCurrentLineNumber(x.parser));
			else
				x.code = eco_fail(error, ECO_BAD_INPUT, "%.300s:%lu: the file ends before there was a point", in->path,
					(unsigned long)XML_GetCurrentLineNumber(x.parser));
		} else
			x.code = eco_fail(error, ECO_BAD_INPUT, "%.300s:%lu:%lu: %s", in->path, (unsigned long)XML_GetCurrentLineNumber(x.parser),
				(unsigned long)XML_GetCurrentColumnNumber(x.parser) + 1, XML_ErrorString(XML_GetErrorCode(x.parser)));
	}
	XML_ParserFree(x.parser);
	if (!x.code)
		keep_best(&x);
	free(x.text);
	free(x.whens.values);
	free(x.angles.values);
	return x.code;
}
