/* Places that count from others: the plants of a plot from its centre, those of a quadrat from its corner. */
#include "ecofiles/import/places/positions_parts.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"

bool eco_quadrat_corner(const struct eco_quadrat *quadrat, const char *text, double corner_m[2])
{
	size_t digits = strspn(text, "0123456789"), spaces = strspn(text + digits, " ");
	if (digits == 0 || digits > 4 || text[digits + spaces] != 0)
		return false;
	unsigned long number = strtoul(text, NULL, 10);
	corner_m[0] = (double)(number / 100) * quadrat->size_m;
	corner_m[1] = (double)(number % 100) * quadrat->size_m;
	return true;
}

void eco_polar_offset(const struct eco_polar *polar, double azimuth, double distance, double offset_m[2])
{
	double sine, cosine;
	eco_angle16_sincos(eco_angle16_from_deg(azimuth / polar->whole_turn * 360), &sine, &cosine);
	offset_m[0] = distance * polar->unit_m * sine;
	offset_m[1] = distance * polar->unit_m * cosine;
}
