#include "ecofiles/import/places/crs_facts.h"

#include <math.h>
#include <stdio.h>

#include "ecofiles/base/module.h"

enum eco_code eco_crs_look(const char *crs, const double xy[2], struct eco_crs_facts *facts,
	struct eco_error *error)
{
	const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
	return !proj ? ECO_NOT_FOUND : proj->crs_look(crs, xy, facts, error);
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

void eco_crs_utm(const double degrees[2], char code[32])
{
	int zone = (int)floor((degrees[0] + 180) / 6) + 1;
	zone = zone < 1 ? 1 : zone > 60 ? 60 : zone;
	snprintf(code, 32, "EPSG:%d", (degrees[1] < 0 ? 32700 : 32600) + zone);
}
