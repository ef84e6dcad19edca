/* One conversion for an inventory. Everything that PROJ would guess is settled before it is asked: axis
 * order (normalized), datums of heights (both stated, or none), and operations whose grid is missing (an
 * error for heights, which would be wrong by tens of metres; a note for places, which are off by little).
 * Converted numbers are rounded to the millimetre, so that PROJ's last bits do not change a pack. */
#include "ecofiles/import/places/proj_module.h"

#include <math.h>
#include <proj_experimental.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/import/places/crs.h"

struct eco_crs_path {
	PJ_CONTEXT *context;
	PJ *from, *to, *conversion;          /* conversion NULL: the same CRS */
	bool use_z, convert_z, checked;
	struct eco_crs_request request;      /* path, note and ctx are used for the first place */
	char *path, *from_name, *to_name;
};

/* ---- Parts of a CRS ---- */

static PJ *parse(PJ_CONTEXT *context, const char *text)
{
	PJ *crs = proj_create(context, text);
	if (crs && !proj_is_crs(crs)) {
		proj_destroy(crs);
		return NULL;
	}
	/* has its own datum shift, which PROJ uses in converting */
	if (crs && proj_get_type(crs) == PJ_TYPE_BOUND_CRS) {
		PJ *base = proj_get_source_crs(context, crs);
		if (base && proj_get_type(base) == PJ_TYPE_COMPOUND_CRS) {
			proj_destroy(crs);
			return base;
		}
		proj_destroy(base);
	}
	return crs;
}

static PJ *horizontal_of(PJ_CONTEXT *context, const PJ *crs)
{
	if (proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS)
		return proj_crs_get_sub_crs(context, crs, 0);
	if (proj_get_type(crs) == PJ_TYPE_GEOGRAPHIC_3D_CRS)
		return proj_crs_demote_to_2D(context, NULL, crs);
	return proj_clone(context, crs);
}

/* The vertical part: from a stated name, else of the CRS. *ellipsoid: heights above the ellipsoid, which
 * have no CRS of their own. */
static enum eco_code vertical_of(PJ_CONTEXT *context, const PJ *crs, const char *stated, PJ **vertical,
	bool *ellipsoid, const char *whose, struct eco_error *error)
{
	*vertical = NULL;
	*ellipsoid = false;
	if (!stated) {
		if (proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS)
			*vertical = proj_crs_get_sub_crs(context, crs, 1);
		*ellipsoid = proj_get_type(crs) == PJ_TYPE_GEOGRAPHIC_3D_CRS;
		return ECO_OK;
	}
	if (strcasecmp(stated, "ellipsoid") == 0) {
		*ellipsoid = true;
		return ECO_OK;
	}
	*vertical = parse(context, stated);
	PJ_TYPE type = *vertical ? proj_get_type(*vertical) : PJ_TYPE_UNKNOWN;
	if (type == PJ_TYPE_VERTICAL_CRS)
		return ECO_OK;
	proj_destroy(*vertical);
	*vertical = NULL;
	return eco_fail(error, ECO_BAD_INPUT, "%.200s: \"vertical\": \"%.80s\" is not a vertical datum that "
		"PROJ knows; write a code such as "
		"\"EPSG:5703\" (NAVD88), \"EPSG:7837\" (DHHN2016), or \"ellipsoid\"", whose, stated);
}

static double axis_unit(PJ_CONTEXT *context, const PJ *crs)
{
	PJ *axes = proj_crs_get_coordinate_system(context, crs);
	double unit = 0;
	if (!axes || !proj_cs_get_axis_info(context, axes, 0, NULL, NULL, NULL, &unit, NULL, NULL, NULL))
		unit = 0;
	proj_destroy(axes);
	return unit;
}

bool proj_is_metric_map(PJ_CONTEXT *context, const PJ *crs)
{
	PJ *flat = horizontal_of(context, crs), *base = NULL;
	bool metric = false;
	if (flat && proj_get_type(flat) == PJ_TYPE_BOUND_CRS)
		base = proj_get_source_crs(context, flat);
	if (flat && proj_get_type(base ? base : flat) == PJ_TYPE_PROJECTED_CRS)
		metric = fabs(axis_unit(context, base ? base : flat) - 1) <= 1e-9;
	proj_destroy(base);
	proj_destroy(flat);
	return metric;
}

static bool is_local(const PJ *crs)
{
	PJ_TYPE type = proj_get_type(crs);
	return type == PJ_TYPE_ENGINEERING_CRS || type == PJ_TYPE_TEMPORAL_CRS
		|| type == PJ_TYPE_VERTICAL_CRS;
}

static bool same(const PJ *a, const PJ *b)
{
	return proj_is_equivalent_to(a, b, PJ_COMP_EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS);
}

/* ---- Stated CRSs ---- */

static enum eco_code parse_frame(struct eco_crs_path *c, const struct eco_crs_request *r,
	struct eco_error *error)
{
	c->to = parse(c->context, r->frame->crs);
	if (!c->to)
		return eco_fail(error, ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not known; write a "
			"code such as \"EPSG:26917\"", r->frame->crs);
	if (!proj_is_metric_map(c->context, c->to))
		return eco_fail(error, ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not one in metres; take "
			"a projected one such as the UTM zone, \"EPSG:32617\"", r->frame->crs);
	return ECO_OK;
}

static enum eco_code parse_source(struct eco_crs_path *c, const struct eco_crs_request *r,
	struct eco_error *error)
{
	const char *text = r->stated ? r->stated : r->of_file;
	PJ *of_file = NULL;
	c->from = parse(c->context, text);
	if (!c->from)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: no conversion from CRS \"%.80s\" to "
			"\"%.80s\": PROJ does not know it%s", r->path, c->from_name, c->to_name,
			r->stated ? "; write a code such as \"EPSG:4326\""
			: "; add \"crs\": \"EPSG:...\" to its entry");
	if (is_local(c->from))
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: its CRS \"%.80s\" is a local one that has no "
			"place on Earth; add \"crs\": \"EPSG:...\", "
			"the CRS that its coordinates are really in, to its entry", r->path, c->from_name);
	if (!r->stated || !r->of_file)
		return ECO_OK;
	of_file = parse(c->context, r->of_file);
	if (!of_file || !same(of_file, c->from)) {
		char *name = eco_crs_short_name(r->of_file);
		r->note(r->ctx, "the file says CRS \"%.80s\", its entry says \"%.80s\": the entry's is taken",
			name ? name : "?", c->from_name);
		free(name);
	}
	proj_destroy(of_file);
	return ECO_OK;
}

/* ---- Heights ---- */

struct heights { PJ *from, *to; bool from_ellipsoid, to_ellipsoid; };

static enum eco_code pair_heights(struct eco_crs_path *c, const struct eco_crs_request *r, struct heights *h,
	struct eco_error *error)
{
	ECO_PASS(vertical_of(c->context, c->from, r->vertical, &h->from, &h->from_ellipsoid,
		r->path, error));
	ECO_PASS(vertical_of(c->context, c->to, r->frame->vertical, &h->to, &h->to_ellipsoid,
		"the scene", error));
	if (h->to && fabs(axis_unit(c->context, h->to) - 1) > 1e-9)
		return eco_fail(error, ECO_BAD_INPUT, "the scene's vertical datum \"%.80s\" does not count "
			"in metres, as scenes do; take its twin in metres, such as \"EPSG:5703\" (NAVD88)",
			r->frame->vertical ? r->frame->vertical : proj_get_name(h->to));
	bool has_from = h->from || h->from_ellipsoid;
	bool has_to = h->to || h->to_ellipsoid;
	if (has_from && !has_to)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: its heights (z) have a vertical datum "
			"(\"%.80s\"), the scene's have none; add \"vertical\": "
			"\"EPSG:...\" to the scene, the same one if the heights are to stay as they are",
			r->path, r->vertical ? r->vertical : h->from ? proj_get_name(h->from)
			: "ellipsoid");
	if (has_to && !has_from)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: the scene's heights have a vertical datum "
			"(\"%.80s\"), these (z) have none; add \"vertical\": "
			"\"EPSG:...\" to its entry, the same one if the heights are to stay as they are",
			r->path, r->frame->vertical ? r->frame->vertical : h->to
			? proj_get_name(h->to) : "ellipsoid");
	if (!has_from)
		r->note(r->ctx, "its heights (z) are taken for metres above the zero of the scene's: "
			"neither says a vertical datum; if they differ, add "
			"\"vertical\": \"EPSG:...\" to the scene and to its entry");
	c->convert_z = has_from && !(h->from_ellipsoid && h->to_ellipsoid && same(c->from, c->to))
		&& !(h->from && h->to && same(h->from, h->to));
	return ECO_OK;
}

static PJ *with_height(PJ_CONTEXT *context, PJ *flat, PJ *vertical)
{
	PJ *whole = vertical ? proj_create_compound_crs(context, "compound", flat, vertical)
		: proj_crs_promote_to_3D(context, NULL, flat);
	proj_destroy(flat);
	return whole;
}

/* Reduces from and to to the parts that are converted: plain maps, or maps with heights. */
static enum eco_code settle_heights(struct eco_crs_path *c, const struct eco_crs_request *r,
	struct eco_error *error)
{
	struct heights h = { .from = NULL };
	enum eco_code code = c->use_z ? pair_heights(c, r, &h, error) : ECO_OK;
	PJ *from = NULL, *to = NULL;
	if (!code) {
		from = horizontal_of(c->context, c->from);
		to = horizontal_of(c->context, c->to);
	}
	if (code == ECO_OK && c->convert_z && from && to) {
		from = with_height(c->context, from, h.from);
		to = with_height(c->context, to, h.to);
	}
	proj_destroy(h.from);
	proj_destroy(h.to);
	proj_destroy(c->from);
	proj_destroy(c->to);
	c->from = from;
	c->to = to;
	if (code == ECO_OK && (!from || !to))
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: CRS \"%.80s\" has no horizontal part", r->path,
			c->from_name);
	return code;
}

/* ---- The operation ---- */

static void describe_missing(PJ_CONTEXT *context, const PJ *operation, char *names, size_t size)
{
	int grids = proj_coordoperation_get_grid_used_count(context, operation);
	for (int i = 0; i < grids; i++) {
		const char *name = NULL;
		int available = 1;
		size_t used = strlen(names);
		if (proj_coordoperation_get_grid_used(context, operation, i, &name, NULL, NULL, NULL, NULL,
				NULL, &available) && !available
			&& name && !strstr(names, name) && used < size)
			snprintf(names + used, size - used, "%s%s", used > 0 ? ", " : "", name);
	}
}

/* The grids that the best operation at a place (degrees) needs and that are not installed; "": none. */
static void missing_grids(const struct eco_crs_path *c, double longitude, double latitude, char *names,
	size_t size)
{
	PJ_OPERATION_FACTORY_CONTEXT *factory = proj_create_operation_factory_context(c->context, NULL);
	PJ_OBJ_LIST *list = NULL;
	*names = 0;
	if (!factory)
		return;
	proj_operation_factory_context_set_grid_availability_use(c->context, factory,
		PROJ_GRID_AVAILABILITY_IGNORED);
	proj_operation_factory_context_set_spatial_criterion(c->context, factory,
		PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
	if (isfinite(longitude) && isfinite(latitude))
		proj_operation_factory_context_set_area_of_interest(c->context, factory, longitude - 1e-3,
			latitude - 1e-3, longitude + 1e-3, latitude + 1e-3);
	list = proj_create_operations(c->context, c->from, c->to, factory);
	if (list && proj_list_get_count(list) > 0) {
		PJ *best = proj_list_get(c->context, list, 0);
		describe_missing(c->context, best, names, size);
		proj_destroy(best);
	}
	proj_list_destroy(list);
	proj_operation_factory_context_destroy(factory);
}

static void degrees_of(const struct eco_crs_path *c, const double xyz[3], double *longitude, double *latitude)
{
	PJ *flat = horizontal_of(c->context, c->from),
		*conversion = flat ? proj_to_degrees(c->context, flat, proj_create(c->context, "EPSG:4326")) : NULL;
	PJ_COORD at;
	*longitude = *latitude = NAN;
	if (conversion) {
		at = proj_trans(conversion, PJ_FWD, proj_coord(xyz[0], xyz[1], 0, HUGE_VAL));
		*longitude = at.xy.x;
		*latitude = at.xy.y;
	}
	proj_destroy(conversion);
	proj_destroy(flat);
}

static enum eco_code open_conversion(struct eco_crs_path *c, const struct eco_crs_request *r,
	struct eco_error *error)
{
	if (!c->convert_z && same(c->from, c->to))
		return ECO_OK;
	PJ *raw = proj_create_crs_to_crs_from_pj(c->context, c->from, c->to, NULL,
		c->convert_z ? (const char *const[]){ "ALLOW_BALLPARK=NO", NULL } : NULL);
	c->conversion = raw ? proj_normalize_for_visualization(c->context, raw) : NULL;
	proj_destroy(raw);
	if (!c->conversion) {
		char names[200];
		missing_grids(c, NAN, NAN, names, sizeof names);
		if (c->convert_z)
			return eco_fail(error, ECO_UNSUPPORTED, "%.200s: PROJ cannot convert its heights "
				"between the two vertical datums%s%s%s", r->path,
				names[0] != 0 ? ": it lacks " : "", names,
				names[0] != 0 ? " (projsync --file NAME, or the package proj-data, brings it)"
				: "");
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: no conversion from CRS \"%.80s\" to "
			"\"%.80s\": %.100s", r->path, c->from_name, c->to_name,
			proj_context_errno_string(c->context, proj_context_errno(c->context)));
	}
	return ECO_OK;
}

/* Checks, after the first place, which operation PROJ chose. */
static enum eco_code check_operation(struct eco_crs_path *c, const double xyz[3], bool converted,
	struct eco_error *error)
{
	const struct eco_crs_request *r = &c->request;
	double longitude, latitude;
	char names[200];
	PJ *used = converted ? proj_trans_get_last_used_operation(c->conversion) : NULL;
	bool ballpark = used && proj_coordoperation_has_ballpark_transformation(c->context, used);
	double accuracy = used ? proj_coordoperation_get_accuracy(c->context, used) : -1;
	proj_destroy(used);
	degrees_of(c, xyz, &longitude, &latitude);
	missing_grids(c, longitude, latitude, names, sizeof names);
	if (c->convert_z && names[0] != 0 && (!converted || ballpark))
		return eco_fail(error, ECO_UNSUPPORTED, "%.200s: PROJ cannot convert its heights between "
			"the two vertical datums: it lacks %s "
			"(projsync --file NAME, or the package proj-data, brings it)", c->path, names);
	if (ballpark)
		r->note(r->ctx, "no conversion between the datums of \"%.80s\" and \"%.80s\" is known%s%s: "
			"they are taken for one, places may be off by up to some hundred metres",
			c->from_name, c->to_name, names[0] != 0 ? " without " : "", names);
	else if (names[0] != 0 && converted && !c->convert_z)
		r->note(r->ctx, "PROJ lacks %s: places are converted to about %g m only", names,
			accuracy >= 0 ? accuracy : 0);
	return ECO_OK;
}

/* ---- The whole ---- */

static enum eco_code open_parts(struct eco_crs_path *c, const struct eco_crs_request *r,
	struct eco_error *error)
{
	c->request = *r;
	c->use_z = r->use_z;
	c->context = proj_quiet_context();
	c->path = strdup(r->path);
	c->from_name = eco_crs_short_name(r->stated ? r->stated : r->of_file);
	c->to_name = eco_crs_short_name(r->frame->crs);
	if (!c->context || !c->path || !c->from_name || !c->to_name)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	enum eco_code code = parse_frame(c, r, error);
	if (!code)
		code = parse_source(c, r, error);
	if (!code)
		code = settle_heights(c, r, error);
	return code == ECO_OK ? open_conversion(c, r, error) : code;
}

enum eco_code proj_crs_open(struct eco_crs_path **path, const struct eco_crs_request *request,
	struct eco_error *error)
{
	struct eco_crs_path *c = calloc(1, sizeof *c);
	enum eco_code code = c ? open_parts(c, request, error)
		: eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (code) {
		proj_crs_close(c);
		c = NULL;
	}
	*path = c;
	return code;
}

static double to_millimetres(double metres)
{
	return floor(metres * 1000 + 0.5) / 1000;
}

enum eco_code proj_crs_convert(struct eco_crs_path *c, double xyz[3], bool *converted, const char **why,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	*converted = true;
	*why = "";
	if (!c->conversion)
		return ECO_OK;
	proj_errno_reset(c->conversion);
	PJ_COORD to = proj_trans(c->conversion, PJ_FWD,
		proj_coord(xyz[0], xyz[1], c->convert_z ? xyz[2] : 0, HUGE_VAL));
	*converted = isfinite(to.xyz.x) && isfinite(to.xyz.y) && (!c->convert_z || isfinite(to.xyz.z));
	if (!*converted && proj_errno(c->conversion) != 0)
		*why = proj_context_errno_string(c->context, proj_errno(c->conversion));
	if (!c->checked)
		code = check_operation(c, xyz, *converted, error);
	c->checked = true;
	if (code != ECO_OK || !*converted)
		return code;
	xyz[0] = to_millimetres(to.xyz.x);
	xyz[1] = to_millimetres(to.xyz.y);
	if (c->convert_z)
		xyz[2] = to_millimetres(to.xyz.z);
	return ECO_OK;
}

void proj_crs_close(struct eco_crs_path *c)
{
	if (!c)
		return;
	proj_destroy(c->conversion);
	proj_destroy(c->from);
	proj_destroy(c->to);
	if (c->context)
		proj_context_destroy(c->context);
	eco_free(c->path, c->from_name, c->to_name, c);
}
