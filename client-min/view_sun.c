#include "client-min/view_sun.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

#define DEGREE (3.14159265358979323846 / 180)
#define J2000_S 946728000.0              /* noon of 2000-01-01, in unix seconds */

void view_sun_at(const struct view_sun_place *place, double unix_s, float sun[3])
{
	double n = (unix_s - J2000_S) / 86400;
	double anomaly = (357.528 + 0.9856003 * n) * DEGREE;
	double along = (280.460 + 0.9856474 * n + 1.915 * sin(anomaly) + 0.020 * sin(2 * anomaly)) * DEGREE,
		tilt = (23.439 - 0.0000004 * n) * DEGREE;
	double ascension = atan2(cos(tilt) * sin(along), cos(along)),
		declination = asin(sin(tilt) * sin(along));
	double sidereal = fmod(18.697374558 + 24.06570982441908 * n, 24) * 15 + place->longitude_deg;
	double hour = sidereal * DEGREE - ascension, latitude = place->latitude_deg * DEGREE;
	double up = sin(latitude) * sin(declination) + cos(latitude) * cos(declination) * cos(hour);
	double east = -cos(declination) * sin(hour),
		north = cos(latitude) * sin(declination) - sin(latitude) * cos(declination) * cos(hour);
	/* the map's north is turned clockwise */
	double turn = place->convergence_deg * DEGREE;
	sun[0] = (float)(east * cos(turn) - north * sin(turn));
	sun[1] = (float)(north * cos(turn) + east * sin(turn));
	sun[2] = (float)up;
}

static bool read_zone(const char *text, int *minutes)
{
	int hours, rest, used = 0;
	char sign;
	*minutes = 0;
	if (text[0] == 'Z' && !text[1])
		return true;
	if (sscanf(text, "%c%2d:%2d%n", &sign, &hours, &rest, &used) != 3 || text[used]
			|| (sign != '+' && sign != '-') || hours < 0 || hours > 14 || rest < 0 || rest > 59)
		return false;
	*minutes = (sign == '-' ? -1 : 1) * (hours * 60 + rest);
	return true;
}

enum eco_code view_sun_read_time(const char *text, void *unix_s, struct eco_error *error)
{
	struct tm t = { 0 };
	int used = 0, more = 0, zone;
	bool good = sscanf(text, "%4d-%2d-%2dT%2d:%2d%n", &t.tm_year, &t.tm_mon, &t.tm_mday, &t.tm_hour,
		&t.tm_min, &used) == 5;
	if (good && text[used] == ':')
		good = sscanf(text + used, ":%2d%n", &t.tm_sec, &more) == 1;
	good = good && read_zone(text + used + more, &zone) && t.tm_year >= 1900 && t.tm_mon >= 1
		&& t.tm_mon <= 12 && t.tm_mday >= 1 && t.tm_mday <= 31 && t.tm_hour >= 0 && t.tm_hour < 24
		&& t.tm_min >= 0 && t.tm_min < 60 && t.tm_sec >= 0 && t.tm_sec < 60;
	if (!good)
		return eco_fail(error, ECO_BAD_USAGE,
			"--sun %.60s: must be a time such as 2026-06-21T10:00Z or "
			"2026-06-21T12:00+02:00", text);
	t.tm_year -= 1900;
	t.tm_mon -= 1;
	*(double *)unix_s = (double)timegm(&t) - 60.0 * zone;
	return ECO_OK;
}
