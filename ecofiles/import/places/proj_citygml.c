/* The order of the axes that follows from a srsName is as often ignored as kept. The places themselves tell
 * better: a CRS has an area of use, and in the wrong order they nearly always fall out of it. */
#include "ecofiles/import/places/proj_module.h"

#include <math.h>
#include <proj_experimental.h>
#include <strings.h>

#include "ecofiles/import/places/rows/rows_citygml.h"

static PJ *flat_of(PJ_CONTEXT *context, const char *code)
{
	PJ *crs = proj_create(context, code), *flat = NULL;
	if (crs && proj_is_crs(crs) && proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS)
		flat = proj_crs_get_sub_crs(context, crs, 0);
	else if (crs && proj_is_crs(crs))
		flat = proj_get_type(crs) == PJ_TYPE_GEOGRAPHIC_3D_CRS
			? proj_crs_demote_to_2D(context, NULL, crs) : proj_clone(context, crs);
	proj_destroy(crs);
	return flat;
}

static bool north_first(PJ_CONTEXT *context, const PJ *flat)
{
	PJ *axes = proj_crs_get_coordinate_system(context, flat);
	const char *direction = NULL;
	bool north = axes && proj_cs_get_axis_info(context, axes, 0, NULL, NULL, &direction, NULL,
		NULL, NULL, NULL) && direction && strcasecmp(direction, "north") == 0;

	proj_destroy(axes);
	return north;
}

/* How many places lie in the area of use, with their axes in this order? */
static uint32_t count_inside(const struct eco_citygml_crs *crs, PJ *to_degrees, const double area[4],
	bool swapped)
{
	uint32_t inside = 0;
	for (uint32_t i = 0; i < crs->seen_count; i++) {
		PJ_COORD at = proj_coord(crs->seen[i][swapped], crs->seen[i][!swapped], 0, HUGE_VAL);
		at = proj_trans(to_degrees, PJ_FWD, at);
		inside += at.xy.x >= area[0] && at.xy.y >= area[1] && at.xy.x <= area[2]
			&& at.xy.y <= area[3];
	}
	return inside;
}

/* Places inside in the order of the name, and in the other; false where the CRS has no area of use. */
static bool try_orders(const struct eco_citygml_crs *crs, PJ_CONTEXT *context, PJ *flat, uint32_t inside[2])
{
	PJ *world = proj_create(context, "EPSG:4326"), *raw = NULL, *to_degrees = NULL;
	double area[4];
	bool known = proj_get_area_of_use(context, flat, &area[0], &area[1], &area[2], &area[3], NULL)
		&& area[0] > -1000 && area[0] < area[2];
	if (known && world)
		raw = proj_create_crs_to_crs_from_pj(context, flat, world, NULL, NULL);
	if (raw)
		to_degrees = proj_normalize_for_visualization(context, raw);
	for (int swapped = 0; to_degrees && swapped < 2; swapped++)
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
	if (!flat)
		return;
	said = crs->swapped = crs->as_authority && north_first(context, flat);
	if (try_orders(crs, context, flat, inside) && inside[said] == 0 && inside[!said] > 0) {
		crs->swapped = !said;
		snprintf(note, size, "its CRS \"%.100s\" has %s first, its places have it the other way "
			"round, and are taken so", crs->name, said ? "northing or latitude"
			: "easting or longitude");
	} else if (!crs->as_authority && proj_get_type(flat) == PJ_TYPE_GEOGRAPHIC_2D_CRS && inside[0] > 0
			&& inside[1] > 0) {
		snprintf(note, size, "its places are taken for longitude, latitude; if it is latitude "
			"first, write its srsName as "
			"urn:ogc:def:crs:EPSG::4326");
	}
	proj_destroy(flat);
}

void proj_citygml_settle(struct eco_citygml_crs *crs, char *note, size_t size)
{
	PJ_CONTEXT *context = proj_quiet_context();
	if (!context)
		return;
	decide(crs, context, note, size);
	proj_context_destroy(context);
}
