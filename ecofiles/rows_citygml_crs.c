/* srsName comes in half a dozen spellings, and the order of the axes that follows from them is as often ignored as kept. The places
 * themselves tell better: a CRS has an area of use, and in the wrong order they nearly always fall out of it. */
#include "ecofiles/rows_citygml.h"

#include <math.h>
#include <proj.h>
#include <proj_experimental.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH": those of the German surveys. */
static bool german(const char *name, char *code, size_t size)
{
	static const struct { const char *name; int code; } heights[] = { { "DHHN92", 5783 }, { "DHHN2016", 7837 }, { "DHHN85", 5784 } };
	const char *utm = strstr(name, "ETRS89_UTM"), *star;
	int zone = utm != NULL ? atoi(utm + 10) : 0;

	if (strncasecmp(name, "urn:adv:crs:", 12) != 0 || zone < 28 || zone > 38)
		return false;
	snprintf(code, size, "EPSG:%d", 25800 + zone);
	star = strchr(utm, '*');
	for (size_t i = 0; star != NULL && i < sizeof heights / sizeof *heights; i++)
		if (strstr(star, heights[i].name) != NULL)
			snprintf(code, size, "EPSG:%d+%d", 25800 + zone, heights[i].code);
	return true;
}

static void code_of(const char *name, char *code, size_t size, bool *as_authority)
{
	const char *hash = strchr(name, '#');

	*as_authority = strncasecmp(name, "urn:ogc:", 8) == 0 || (strncasecmp(name, "http", 4) == 0 && hash == NULL);
	if (german(name, code, size))
		return;
	if (strncasecmp(name, "http", 4) == 0 && hash != NULL)       /* http://www.opengis.net/gml/srs/epsg.xml#25832 */
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

static PJ *flat_of(PJ_CONTEXT *context, const char *code)
{
	PJ *crs = proj_create(context, code), *flat = NULL;

	if (crs != NULL && proj_is_crs(crs) && proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS)
		flat = proj_crs_get_sub_crs(context, crs, 0);
	else if (crs != NULL && proj_is_crs(crs))
		flat = proj_get_type(crs) == PJ_TYPE_GEOGRAPHIC_3D_CRS ? proj_crs_demote_to_2D(context, NULL, crs) : proj_clone(context, crs);
	proj_destroy(crs);
	return flat;
}

static bool north_first(PJ_CONTEXT *context, const PJ *flat)
{
	PJ *axes = proj_crs_get_coordinate_system(context, flat);
	const char *direction = NULL;
	bool north = axes != NULL && proj_cs_get_axis_info(context, axes, 0, NULL, NULL, &direction, NULL, NULL, NULL, NULL) && direction != NULL
		&& strcasecmp(direction, "north") == 0;

	proj_destroy(axes);
	return north;
}

/* How many places lie in the area of use, with their axes in this order? */
static uint32_t count_inside(const struct eco_citygml_crs *crs, PJ *to_degrees, const double area[4], bool swapped)
{
	uint32_t inside = 0;

	for (uint32_t i = 0; i < crs->seen_count; i++) {
		PJ_COORD at = proj_coord(crs->seen[i][swapped], crs->seen[i][!swapped], 0, HUGE_VAL);

		at = proj_trans(to_degrees, PJ_FWD, at);
		inside += at.xy.x >= area[0] && at.xy.y >= area[1] && at.xy.x <= area[2] && at.xy.y <= area[3];
	}
	return inside;
}

/* Places inside in the order of the name, and in the other; false where the CRS has no area of use. */
static bool try_orders(const struct eco_citygml_crs *crs, PJ_CONTEXT *context, PJ *flat, uint32_t inside[2])
{
	PJ *world = proj_create(context, "EPSG:4326"), *raw = NULL, *to_degrees = NULL;
	double area[4];
	bool known = proj_get_area_of_use(context, flat, &area[0], &area[1], &area[2], &area[3], NULL) && area[0] > -1000 && area[0] < area[2];

	if (known && world != NULL)
		raw = proj_create_crs_to_crs_from_pj(context, flat, world, NULL, NULL);
	if (raw != NULL)
		to_degrees = proj_normalize_for_visualization(context, raw);
	for (int swapped = 0; to_degrees != NULL && swapped < 2; swapped++)
		inside[swapped] = count_inside(crs, to_degrees, area, swapped);
	known = to_degrees != NULL;
	proj_destroy(to_degrees);
	proj_destroy(raw);
	proj_destroy(world);
	return known;
}

static void decide(struct eco_citygml_crs *crs, PJ_CONTEXT *context, char *note, size_t size)
{
	PJ *flat = flat_of(context, crs->code);
	uint32_t inside[2] = { 0, 0 };
	bool said;

	if (flat == NULL)
		return;
	said = crs->swapped = crs->as_authority && north_first(context, flat);
	if (try_orders(crs, context, flat, inside) && inside[said] == 0 && inside[!said] > 0) {
		crs->swapped = !said;
		snprintf(note, size, "its CRS \"%.100s\" has %s first, its places have it the other way round, and are taken so", crs->name,
			said ? "northing or latitude" : "easting or longitude");
	} else if (!crs->as_authority && proj_get_type(flat) == PJ_TYPE_GEOGRAPHIC_2D_CRS && inside[0] > 0 && inside[1] > 0) {
		snprintf(note, size, "its places are taken for longitude, latitude; if it is latitude first, write its srsName as "
			"urn:ogc:def:crs:EPSG::4326");
	}
	proj_destroy(flat);
}

void eco_citygml_crs_settle(struct eco_citygml_crs *crs, char *note, size_t size)
{
	PJ_CONTEXT *context;

	*note = 0;
	if (crs->code[0] == 0 || (context = proj_context_create()) == NULL)
		return;
	proj_log_level(context, PJ_LOG_NONE);
	proj_context_set_enable_network(context, 0);
	decide(crs, context, note, size);
	proj_context_destroy(context);
}
