/* srsName comes in half a dozen spellings; which of the axes it means comes first is found by PROJ
 * (proj_citygml.c). */
#include "ecofiles/import/places/rows/rows_citygml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH": those of the German surveys. */
static bool german(const char *name, char *code, size_t size)
{
	static const struct { const char *name; int code; } heights[] =
		{ { "DHHN92", 5783 }, { "DHHN2016", 7837 }, { "DHHN85", 5784 } };
	const char *utm = strstr(name, "ETRS89_UTM"), *star;
	int zone = utm ? atoi(utm + 10) : 0;
	if (strncasecmp(name, "urn:adv:crs:", 12) != 0 || zone < 28 || zone > 38)
		return false;
	snprintf(code, size, "EPSG:%d", 25800 + zone);
	star = strchr(utm, '*');
	for (size_t i = 0; star && i < sizeof heights / sizeof *heights; i++)
		if (strstr(star, heights[i].name))
			snprintf(code, size, "EPSG:%d+%d", 25800 + zone, heights[i].code);
	return true;
}

static void code_of(const char *name, char *code, size_t size, bool *as_authority)
{
	const char *hash = strchr(name, '#');
	*as_authority = strncasecmp(name, "urn:ogc:", 8) == 0 || (strncasecmp(name, "http", 4) == 0 && !hash);
	if (german(name, code, size))
		return;
	if (strncasecmp(name, "http", 4) == 0
			&& hash)       /* http://www.opengis.net/gml/srs/epsg.xml#25832 */
		snprintf(code, size, "EPSG:%.20s", hash + 1);
	else
		snprintf(code, size, "%.255s", name);
}

bool eco_citygml_crs_name(struct eco_citygml_crs *crs, const char *name, bool of_plant)
{
	char code[sizeof crs->code];
	bool as_authority;
	name += strspn(name, " \t\r\n");
	if (*name == 0 || (crs->of_plants && !of_plant))
		return true;
	code_of(name, code, sizeof code, &as_authority);
	if (crs->name[0] != 0 && crs->of_plants == of_plant)
		return strcasecmp(code, crs->code) == 0 || !of_plant;
	snprintf(crs->name, sizeof crs->name, "%.255s", name);
	memcpy(crs->code, code, sizeof code);
	crs->of_plants = of_plant;
	crs->as_authority = as_authority;
	return true;
}

void eco_citygml_crs_see(struct eco_citygml_crs *crs, const double at[3])
{
	if (crs->seen_count < ECO_CITYGML_SAMPLES)
		memcpy(crs->seen[crs->seen_count++], at, sizeof *crs->seen);
}
