#include "client-min/view_sky.h"

#include <math.h>

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
