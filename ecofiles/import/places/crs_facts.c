#include "ecofiles/import/places/crs_facts.h"

#include <math.h>
#include <stdio.h>

#include "build/words/grids.table"
#include "ecofiles/base/module.h"

enum eco_code eco_crs_look(const char *crs, const double xy[2], struct eco_crs_facts *facts,
	struct eco_error *error)
{
	const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
	return !proj ? ECO_NOT_FOUND : proj->crs_look(crs, xy, facts, error);
}

#define NULL_ISLAND_DEG \
	0.01 /* degrees taken for metres lie so near to the origin of a map of the whole Earth */

bool eco_crs_may_be_degrees(const double xy[2])
{
	return fmin(fabs(xy[0]), fabs(xy[1])) <= 90 && fmax(fabs(xy[0]), fabs(xy[1])) <= 180;
}

enum eco_crs_fit eco_crs_fit(const char *crs, const double xy[2], const struct eco_crs_facts *facts)
{
	const double turned[2] = { xy[1], xy[0] };
	struct eco_crs_facts other;
	bool nowhere = fabs(facts->degrees[0]) < NULL_ISLAND_DEG && fabs(facts->degrees[1]) < NULL_ISLAND_DEG;
	if (!facts->geographic && eco_crs_may_be_degrees(xy) && (!facts->inside || nowhere))
		return ECO_CRS_DEGREES;
	if (facts->inside)
		return ECO_CRS_FITS;
	return eco_crs_look(crs, turned, &other, NULL) == ECO_OK && other.inside ? ECO_CRS_SWAPPED
										 : ECO_CRS_OUTSIDE;
}

bool eco_crs_area_has(const double area[4], const double degrees[2])
{
	bool in_longitude = area[0] <= area[2]
		? degrees[0] >= area[0] && degrees[0] <= area[2]
		: degrees[0] >= area[0] || degrees[0] <= area[2]; /* across the date line */
	return !isnan(area[0]) && in_longitude && degrees[1] >= area[1] && degrees[1] <= area[3];
}

const char *eco_crs_area_text(const double area[4], char text[80])
{
	snprintf(text, 80, "longitude %.4g to %.4g, latitude %.4g to %.4g", area[0], area[2], area[1],
		area[3]);
	return text;
}

enum eco_code eco_crs_place(const char *crs, const double xy[2], struct eco_crs_place *place,
	struct eco_error *error)
{
	const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
	return !proj ? ECO_NOT_FOUND : proj->crs_place(crs, xy, place, error);
}

enum eco_code eco_crs_choices(const double xy[2], const char *words,
	struct eco_crs_choice *choices, uint32_t *found, struct eco_error *error)
{
	const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
	return !proj ? ECO_NOT_FOUND : proj->crs_choices(xy, words, choices, found, error);
}

uint32_t eco_crs_usual(uint32_t epsg)
{
	for (size_t i = 0; i < sizeof grids_rows / sizeof *grids_rows; i++)
		if (epsg >= grids_rows[i].first && epsg <= grids_rows[i].last)
			return (uint32_t)grids_rows[i].rank;
	return 0;
}

void eco_crs_utm(const double degrees[2], char code[32])
{
	int zone = (int)floor((degrees[0] + 180) / 6) + 1;
	zone = zone < 1 ? 1 : zone > 60 ? 60 : zone;
	snprintf(code, 32, "EPSG:%d", (degrees[1] < 0 ? 32700 : 32600) + zone);
}
