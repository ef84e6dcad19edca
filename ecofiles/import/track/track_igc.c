/* Logs of gliders (IGC, FAI technical specification for flight recorders, appendix A) and sentences of GPS receivers (NMEA 0183): both
 * give the time of day alone, or the date apart, so midnight is noticed by the clock. */
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define DAY_S 86400.0

/* Seconds since the day of the first fix (or its date, where it is known): a clock that falls by half a day has passed midnight. */
struct clock { double day_s, last_s; bool has_date; };

static double clock_time(struct clock *clock, double of_day_s)
{
	if (clock->last_s - of_day_s > DAY_S / 2)
		clock->day_s += DAY_S;
	clock->last_s = of_day_s;
	return clock->day_s + of_day_s;
}

/* ddmmyy */
static bool set_date(struct clock *clock, const char *text, const char *end)
{
	int day = track_digits(text, end, 2), month = track_digits(text + 2, end, 2), year = track_digits(text + 4, end, 2);
	if (day < 1 || day > 31 || month < 1 || month > 12 || year < 0)
		return false;
	clock->day_s = track_days(year < 80 ? 2000 + year : 1900 + year, month, day) * DAY_S;
	clock->has_date = true;
	return true;
}

/* ---- IGC ---- */

/* More digits, as the I record declares them: first column from 0, and how many. */
struct extension { int at, digits; };
struct igc { struct clock clock; struct extension latitude, longitude, fraction; bool no_satellite_height; };

/* I 03 3638FXA 3940SIU 4143TDS */
static void read_extensions(struct igc *igc, const struct track_line *line)
{
	int count = track_digits(line->text + 1, line->end, 2);
	for (int i = 0; i < count; i++) {
		const char *at = line->text + 3 + 7 * i;
		int first = at + 7 <= line->end ? track_digits(at, line->end, 2) : -1, last = first < 0 ? -1 : track_digits(at + 2, line->end, 2);
		struct extension e = { first - 1, last - first + 1 };
		if (first < 36 || e.digits < 1 || e.digits > 6)
			continue;
		if (memcmp(at + 4, "LAD", 3) == 0)
			igc->latitude = e;
		else if (memcmp(at + 4, "LOD", 3) == 0)
			igc->longitude = e;
		else if (memcmp(at + 4, "TDS", 3) == 0)
			igc->fraction = e;
	}
}

/* Digits beyond those of the fixed columns, in units of the last of these. */
static double more_digits(const struct track_line *line, struct extension e)
{
	int digits = e.digits ? track_digits(line->text + e.at, line->end, e.digits) : -1;
	return digits < 0 ? 0 : digits / (double[]){ 1, 10, 1e2, 1e3, 1e4, 1e5, 1e6 }[e.digits];
}

/* -0123 and 00123 */
static double height(const char *text, const char *end)
{
	int value = *text == '-' ? track_digits(text + 1, end, 4) : track_digits(text, end, 5);
	return value < 0 ? NAN : *text == '-' ? -value : value;
}

/* B HHMMSS DDMMmmmN DDDMMmmmE V PPPPP GGGGG */
static enum eco_code read_fix(struct eco_track *track, struct igc *igc, const struct track_line *line, bool pressure, struct eco_error *error)
{
	const char *t = line->text, *end = line->end;
	struct eco_fix fix = track_fix(line->number);
	int hours = track_digits(t + 1, end, 2), minutes = track_digits(t + 3, end, 2), seconds = track_digits(t + 5, end, 2);
	int south_deg = track_digits(t + 7, end, 2), south_min = track_digits(t + 9, end, 5), east_deg = track_digits(t + 15, end, 3),
		east_min = track_digits(t + 18, end, 5);
	if (end - t < 35 || hours < 0 || minutes < 0 || seconds < 0 || south_deg < 0 || south_min < 0 || east_deg < 0 || east_min < 0 ||
		!strchr("NS", t[14]) || !strchr("EW", t[23])) {
		track_skip(track, ECO_TRACK_BAD_NUMBER, line->number);
		return ECO_OK;
	}
	fix.time_s = clock_time(&igc->clock, hours * 3600 + minutes * 60 + seconds + more_digits(line, igc->fraction));
	fix.at[1] = (south_deg + (south_min + more_digits(line, igc->latitude)) / 60000) * (t[14] == 'S' ? -1 : 1);
	fix.at[0] = (east_deg + (east_min + more_digits(line, igc->longitude)) / 60000) * (t[23] == 'W' ? -1 : 1);
	double by_pressure = height(t + 25, end), by_satellite = height(t + 30, end);
	/* V: the receiver had no height; 0 in all fixes: the recorder has none */
	bool satellite = t[24] != 'V' && !igc->no_satellite_height;
	fix.at[2] = pressure || !satellite ? by_pressure : by_satellite;
	return track_add(track, &fix, error);
}

/* Of all fixes: has it any height by satellite, any by pressure? */
static void look_at_heights(const struct track_input *in, bool *satellite, bool *pressure)
{
	struct track_line line = { 0 };
	*satellite = *pressure = false;
	while (track_next_line(in, &line))
		if (*line.text == 'B' && line.end - line.text >= 35) {
			*pressure |= fabs(height(line.text + 25, line.end)) > 0;
			*satellite |= line.text[24] != 'V' && fabs(height(line.text + 30, line.end)) > 0;
		}
}

enum eco_code track_read_igc(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct igc igc = { .clock = { .last_s = 0 } };
	struct track_line line = { 0 };
	bool satellite, pressure, first = true;
	enum eco_code code = ECO_OK;
	look_at_heights(in, &satellite, &pressure);
	igc.no_satellite_height = !satellite;
	if (!satellite && pressure)
		eco_track_note(track, "heights are by air pressure (of the standard atmosphere): the log has none by satellite");
	track->degrees = true;
	while (!code && track_next_line(in, &line)) {
		if (*line.text == 'B')
			code = read_fix(track, &igc, &line, in->options->pressure, error);
		else if (*line.text == 'I' && line.end - line.text > 3)
			read_extensions(&igc, &line);
		else if (first && track_starts(line.text, line.end, "HFDTE")) {
			const char *at = line.text + 5;
			while (at < line.end && !(*at >= '0' && *at <= '9'))
				at++;
			first = !set_date(&igc.clock, at, line.end);
		}
	}
	return code;
}

/* ---- NMEA ---- */

#define FIELDS 24

struct sentence { const char *field[FIELDS], *end[FIELDS]; int count; const char *kind; };

struct nmea {
	struct clock clock;
	bool has_heights;            /* there are GGA sentences, so RMC gives dates alone */
};

static int hex(char c)
{
	return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* From '$' on; without a checksum it is taken as it is. */
static bool split(const struct track_line *line, struct sentence *s, bool *damaged)
{
	const char *at = memchr(line->text, '$', (size_t)(line->end - line->text));
	*damaged = false;
	if (!at || line->end - at < 7)
		return false;
	const char *body = ++at, *end = body;
	uint8_t sum = 0;
	while (end < line->end && *end != '*')
		sum ^= (uint8_t)*end++;
	if (end + 2 < line->end && hex(end[1]) >= 0 && hex(end[2]) >= 0)
		*damaged = hex(end[1]) * 16 + hex(end[2]) != sum;
	s->kind = body + 2;
	s->count = 0;
	for (at = body; at <= end && s->count < FIELDS; at++) {
		s->field[s->count] = at;
		while (at < end && *at != ',')
			at++;
		s->end[s->count++] = at;
	}
	return true;
}

/* ddmm.mmmm and N, S, E or W */
static double angle(const struct sentence *s, int i)
{
	double value;
	if (i + 1 >= s->count || !track_is_number(s->field[i], s->end[i], &value) || value < 0)
		return NAN;
	double degrees = floor(value / 100);
	value = degrees + (value - degrees * 100) / 60;
	return s->end[i + 1] > s->field[i + 1] && strchr("SW", *s->field[i + 1]) ? -value : value;
}

/* hhmmss.ss */
static double of_day(const struct sentence *s, int i)
{
	double value;
	if (i >= s->count || !track_is_number(s->field[i], s->end[i], &value) || value < 0 || value > 246060)
		return NAN;
	double hours = floor(value / 10000), minutes = floor((value - hours * 10000) / 100);
	return hours * 3600 + minutes * 60 + (value - hours * 10000 - minutes * 100);
}

static enum eco_code read_sentence(struct eco_track *track, struct nmea *n, const struct sentence *s, uint32_t line, struct eco_error *error)
{
	struct eco_fix fix = track_fix(line);
	bool is_gga = track_starts(s->kind, s->end[0], "GGA"), is_rmc = track_starts(s->kind, s->end[0], "RMC");
	double clock_s = of_day(s, 1);
	if (!is_gga && !is_rmc)
		return ECO_OK;
	/* a date is the day of its own sentence: midnight has not to be guessed then */
	if (is_rmc && s->count > 9 && set_date(&n->clock, s->field[9], s->end[9]))
		n->clock.last_s = isnan(clock_s) ? n->clock.last_s : clock_s;
	if (is_rmc && n->has_heights)
		return ECO_OK;
	fix.time_s = isnan(clock_s) ? NAN : clock_time(&n->clock, clock_s);
	int at = is_gga ? 2 : 3;
	bool valid = is_gga ? s->count > 6 && s->end[6] > s->field[6] && *s->field[6] != '0' : s->count > 2 && track_starts(s->field[2], s->end[2], "A");
	fix.at[1] = valid ? angle(s, at) : NAN;
	fix.at[0] = valid ? angle(s, at + 2) : NAN;
	if (is_gga && s->count > 9 && !track_is_number(s->field[9], s->end[9], &fix.at[2]))
		fix.at[2] = NAN;
	return track_add(track, &fix, error);
}

enum eco_code track_read_nmea(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct nmea n = { .clock = { .last_s = 0 } };
	struct sentence s;
	enum eco_code code = ECO_OK;
	track->degrees = true;
	/* once for whether there are heights and on which day it begins, then for the fixes */
	for (int pass = 0; pass < 2; pass++) {
		struct track_line line = { 0 };
		while (!code && track_next_line(in, &line)) {
			bool damaged;
			if (!split(&line, &s, &damaged))
				continue;
			if (pass && damaged)
				track_skip(track, ECO_TRACK_BAD_CHECKSUM, line.number);
			if (damaged)
				continue;
			if (pass)
				code = read_sentence(track, &n, &s, line.number, error);
			else {
				n.has_heights |= track_starts(s.kind, s.end[0], "GGA");
				if (!n.clock.has_date && track_starts(s.kind, s.end[0], "RMC") && s.count > 9)
					set_date(&n.clock, s.field[9], s.end[9]);
			}
		}
	}
	return code;
}
