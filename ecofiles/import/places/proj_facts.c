/* ecoproj.so, the part of this system that calls PROJ: CRSs of its register, looked at one by one. */
#include "ecofiles/import/places/proj_module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/words.h"

PJ_CONTEXT *proj_quiet_context(void)
{
	PJ_CONTEXT *context = proj_context_create();
	if (context) {
		proj_log_level(context, PJ_LOG_NONE);
		proj_context_set_enable_network(context, 0);
	}
	return context;
}

#define WIDE_DEG 60.0            /* areas beyond this are for maps of continents */
#define SAME_DEG 0.02            /* places that differ by datum alone lie nearer together */

PJ *proj_to_degrees(PJ_CONTEXT *context, const PJ *crs, PJ *geodetic)
{
	PJ *raw = NULL, *good = NULL;
	if (geodetic)
		raw = proj_create_crs_to_crs_from_pj(context, crs, geodetic, NULL, NULL);
	if (raw)
		good = proj_normalize_for_visualization(context, raw);
	proj_destroy(raw);
	proj_destroy(geodetic);
	return good;
}

static bool degrees_of(PJ_CONTEXT *context, const PJ *crs, const double xy[2], double degrees[2])
{
	PJ *conversion = proj_to_degrees(context, crs, proj_crs_get_geodetic_crs(context, crs));
	degrees[0] = degrees[1] = NAN;
	if (!conversion)
		return false;
	PJ_COORD at = proj_trans(conversion, PJ_FWD, proj_coord(xy[0], xy[1], 0, HUGE_VAL));
	if (isfinite(at.xy.x) && isfinite(at.xy.y)) {
		degrees[0] = at.xy.x > 180 ? at.xy.x - 360 : at.xy.x;
		degrees[1] = at.xy.y;
	}
	proj_destroy(conversion);
	return !isnan(degrees[0]);
}

/* ---- One ---- */

/* The register's code of a CRS, written as WKT perhaps. */
static void find_code(PJ_CONTEXT *context, const PJ *crs, char code[32])
{
	const char *id = proj_get_id_code(crs, 0), *authority = proj_get_id_auth_name(crs, 0);
	int *confidence = NULL;
	code[0] = 0;
	if (id && authority) {
		snprintf(code, 32, "%.15s:%.15s", authority, id);
		return;
	}
	PJ_OBJ_LIST *list = proj_identify(context, crs, "EPSG", NULL, &confidence);
	PJ *found = list && proj_list_get_count(list) > 0 && confidence[0] >= 90
		? proj_list_get(context, list, 0) : NULL;
	if (found && proj_get_id_code(found, 0))
		snprintf(code, 32, "EPSG:%.20s", proj_get_id_code(found, 0));
	proj_destroy(found);
	proj_int_list_destroy(confidence);
	proj_list_destroy(list);
}

static bool x_is_north(PJ_CONTEXT *context, const PJ *crs)
{
	PJ *system = proj_crs_get_coordinate_system(context, crs);
	bool found = false;
	for (int i = 0; system && !found && i < proj_cs_get_axis_count(context, system); i++) {
		const char *letter = NULL, *direction = NULL;
		found = proj_cs_get_axis_info(context, system, i, NULL, &letter, &direction, NULL, NULL, NULL,
			NULL) && letter && direction && strcasecmp(letter, "x") == 0
			&& strcmp(direction, "north") == 0;
	}
	proj_destroy(system);
	return found;
}

static bool find_area(PJ_CONTEXT *context, const PJ *crs, double area[4])
{
	bool stated = proj_get_area_of_use(context, crs, &area[0], &area[1], &area[2], &area[3], NULL) &&
		area[0] >= -1000;
	for (int i = 0; i < 4 && !stated; i++)
		area[i] = NAN;
	return stated;
}

static void look(PJ_CONTEXT *context, PJ *crs, const double xy[2], struct eco_crs_facts *facts)
{
	double *area = facts->area;
	PJ_TYPE type = proj_get_type(crs);
	facts->geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
	facts->metric_map = proj_is_metric_map(context, crs);
	facts->x_is_north = !facts->geographic && x_is_north(context, crs);
	snprintf(facts->name, sizeof facts->name, "%s", proj_get_name(crs) ? proj_get_name(crs) : "");
	find_code(context, crs, facts->code);
	degrees_of(context, crs, xy, facts->degrees);
	if (!find_area(context, crs, area) && facts->code[0] != 0) { /* WKT of files often leaves it out */
		PJ *registered = proj_create(context, facts->code);
		if (registered)
			find_area(context, registered, area);
		proj_destroy(registered);
	}
	facts->inside =
		isnan(area[0]) || (!isnan(facts->degrees[0]) && eco_crs_area_has(area, facts->degrees));
}

/* A CRS by its text, and the context that ends with it. */
struct opened { PJ_CONTEXT *context; PJ *crs; };

static void close_crs(struct opened *o)
{
	proj_destroy(o->crs);
	if (o->context)
		proj_context_destroy(o->context);
}

static enum eco_code open_crs(struct opened *o, const char *text, struct eco_error *error)
{
	*o = (struct opened){ .context = proj_quiet_context() };
	if (!o->context)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	o->crs = proj_create(o->context, text);
	if (o->crs && proj_is_crs(o->crs))
		return ECO_OK;
	close_crs(o);
	return eco_fail(error, ECO_BAD_INPUT,
		"the CRS \"%.100s\" is not known; write a code such as \"EPSG:4326\" "
		"(degrees) or \"EPSG:32632\" (a UTM zone)", text);
}

static enum eco_code crs_look(const char *text, const double xy[2], struct eco_crs_facts *facts,
	struct eco_error *error)
{
	struct opened o;
	enum eco_code code = open_crs(&o, text, error);
	*facts = (struct eco_crs_facts){ .inside = false };
	if (code)
		return code;
	look(o.context, o.crs, xy, facts);
	close_crs(&o);
	return ECO_OK;
}

/* ---- Where on Earth ---- */

static enum eco_code crs_degrees(const char *text, double (*places)[2], size_t count, struct eco_error *error)
{
	struct opened o;
	enum eco_code code = open_crs(&o, text, error);
	if (code)
		return code;
	PJ *conversion = proj_to_degrees(o.context, o.crs, proj_create(o.context, "EPSG:4326"));
	bool good = conversion;
	for (size_t i = 0; i < count && good; i++) {
		PJ_COORD at = proj_trans(conversion, PJ_FWD, proj_coord(places[i][0], places[i][1], 0,
			HUGE_VAL));
		good = isfinite(at.xy.x) && isfinite(at.xy.y);
		places[i][0] = at.xy.x;
		places[i][1] = at.xy.y;
	}
	if (!good)
		code = eco_fail(error, ECO_BAD_INPUT,
			"longitude and latitude of places of the CRS \"%.100s\" are not known",
			text);
	proj_destroy(conversion);
	close_crs(&o);
	return code;
}

static double rounded(double degrees) { return round(degrees * 1e7) / 1e7; }

/* The convergence is the bearing, clockwise from north, of a place a little further up the map. */
static enum eco_code crs_place(const char *text, const double xy[2], struct eco_crs_place *place,
	struct eco_error *error)
{
	double at[2][2] = { { xy[0], xy[1] }, { xy[0], xy[1] + 10 } };
	struct opened earth;
	enum eco_code code = crs_degrees(text, at, 2, error);
	if (!code)
		code = open_crs(&earth, "EPSG:4326", error);
	if (code)
		return code;
	double bearing = proj_geod(earth.crs, proj_coord(proj_torad(at[0][0]), proj_torad(at[0][1]), 0, 0),
		proj_coord(proj_torad(at[1][0]), proj_torad(at[1][1]), 0, 0)).lpzt.z;
	close_crs(&earth);
	*place = (struct eco_crs_place){ rounded(at[0][0]), rounded(at[0][1]), rounded(bearing) };
	return isfinite(bearing) ? ECO_OK : eco_fail(error, ECO_BAD_INPUT,
		"north at %.3f, %.3f of the CRS \"%.100s\" is not known", xy[0], xy[1], text);
}

/* ---- All ---- */

struct choices { struct eco_crs_choice *items; uint32_t count, capacity; };

/* Letters and digits of a name without spaces, and without "zone", which few write into a column. */
static void squeeze(const char *name, char *text, size_t size)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	size_t used = 0;
	text[0] = 0;
	eco_words_of(name, words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word);)
		if (strcmp(word, "zone") != 0 && used + strlen(word) < size)
			used += (size_t)snprintf(text + used, size - used, "%s", word);
}

static bool name_fits(const char *name, const char *code, const char *words)
{
	char text[ECO_WORDS_BYTES], wanted[ECO_WORDS_BYTES];
	if (!words)
		return true;
	squeeze(words, wanted, sizeof wanted);
	squeeze(name, text, sizeof text);
	return strcmp(wanted, code) == 0 || strstr(text, wanted);
}

static bool is_better(const struct eco_crs_choice *choice, const struct eco_crs_choice *own)
{
	if (choice->usual != own->usual)
		return choice->usual > own->usual;
	return !own->usual && strncmp(choice->name, "WGS 84", 6) == 0 && strncmp(own->name, "WGS 84", 6) != 0;
}

/* One of several CRSs that mean one place stays. */
static enum eco_code add_choice(struct choices *all, const struct eco_crs_choice *choice)
{
	for (uint32_t i = 0; i < all->count; i++) {
		struct eco_crs_choice *own = &all->items[i];
		if (fabs(own->degrees[0] - choice->degrees[0]) > SAME_DEG
				|| fabs(own->degrees[1] - choice->degrees[1]) > SAME_DEG)
			continue;
		double extent = fmin(own->extent_deg, choice->extent_deg);
		if (is_better(choice, own))
			*own = *choice;
		own->extent_deg = extent;
		return ECO_OK;
	}
	if (all->count == all->capacity) {
		uint32_t capacity = all->capacity * 2 + 16;
		struct eco_crs_choice *grown = realloc(all->items, capacity * sizeof *grown);
		if (!grown)
			return ECO_NO_MEMORY;
		all->items = grown;
		all->capacity = capacity;
	}
	all->items[all->count++] = *choice;
	return ECO_OK;
}

static enum eco_code try_crs(PJ_CONTEXT *context, const PROJ_CRS_INFO *info, const double xy[2],
	struct choices *all)
{
	struct eco_crs_choice choice;
	const double area[4] = { info->west_lon_degree, info->south_lat_degree, info->east_lon_degree,
		info->north_lat_degree };
	double wide = info->east_lon_degree - info->west_lon_degree,
		tall = info->north_lat_degree - info->south_lat_degree;
	wide += wide < 0 ? 360 : 0;
	choice.extent_deg = fmax(wide, tall > 80 ? 10 : tall);       /* zones reach from the equator up */
	if (!info->bbox_valid || wide > WIDE_DEG)
		return ECO_OK;
	snprintf(choice.code, sizeof choice.code, "EPSG:%.20s", info->code);
	PJ *crs = proj_create(context, choice.code);
	bool good =
		crs && degrees_of(context, crs, xy, choice.degrees) && eco_crs_area_has(area, choice.degrees);
	choice.usual = eco_crs_usual((uint32_t)strtoul(info->code, NULL, 10));
	choice.metric = good && proj_is_metric_map(context, crs);
	proj_destroy(crs);
	snprintf(choice.name, sizeof choice.name, "%s", info->name);
	snprintf(choice.area, sizeof choice.area, "%s", info->area_name ? info->area_name : "");
	return good ? add_choice(all, &choice) : ECO_OK;
}

static int by_use(const void *a, const void *b)
{
	const struct eco_crs_choice *p = a, *q = b;
	if (p->usual != q->usual)
		return p->usual > q->usual ? -1 : 1;
	if (p->extent_deg != q->extent_deg)
		return p->extent_deg < q->extent_deg ? -1 : 1;
	return strcmp(p->code, q->code);
}

static enum eco_code try_all(PJ_CONTEXT *context, const double xy[2], const char *words, struct choices *all)
{
	PJ_TYPE projected = PJ_TYPE_PROJECTED_CRS;
	PROJ_CRS_LIST_PARAMETERS *wanted = proj_get_crs_list_parameters_create();
	int count = 0;
	enum eco_code code = ECO_OK;
	wanted->types = &projected;
	wanted->typesCount = 1;
	wanted->allow_deprecated = 0;
	PROJ_CRS_INFO **list = proj_get_crs_info_list_from_database(context, "EPSG", wanted, &count);
	for (int i = 0; list && i < count && !code; i++)
		if (name_fits(list[i]->name, list[i]->code, words))
			code = try_crs(context, list[i], xy, all);
	proj_crs_info_list_destroy(list);
	proj_get_crs_list_parameters_destroy(wanted);
	return code;
}

static enum eco_code crs_choices(const double xy[2], const char *words,
	struct eco_crs_choice *choices, uint32_t *found, struct eco_error *error)
{
	PJ_CONTEXT *context = proj_quiet_context();
	struct choices all = { .items = NULL };
	enum eco_code code = ECO_NO_MEMORY;
	*found = 0;
	if (context)
		code = try_all(context, xy, words, &all);
	if (!code && all.count > 0) {
		qsort(all.items, all.count, sizeof *all.items, by_use);
		*found = all.count;
		memcpy(choices, all.items, (all.count < ECO_CRS_CHOICES_MAX ? all.count : ECO_CRS_CHOICES_MAX)
			* sizeof *choices);
	}
	free(all.items);
	if (context)
		proj_context_destroy(context);
	return code ? eco_fail(error, code, "no memory for the CRSs of PROJ") : ECO_OK;
}

ECO_MODULE_EXPORT const struct eco_proj_module eco_proj_module = {
	.version = ECO_MODULE_VERSION, .crs_open = proj_crs_open, .crs_convert = proj_crs_convert,
		.crs_close = proj_crs_close,
	.crs_look = crs_look, .crs_choices = crs_choices,
	.crs_place = crs_place, .crs_degrees = crs_degrees,
};
