/* Facts of CRSs, coordinates that are already in the scene's metres, and errors that need no PROJ.
 * proj_crs.c and proj_facts.c do the rest; they are loaded only to convert a place or to look at a CRS. */
#include "ecofiles/import/places/crs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "build/words/grids.table"
#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"

enum eco_code eco_crs_look(const char *crs, const double xy[2], struct eco_crs_facts *facts,
	struct eco_error *error)
{
	const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
	return !proj ? ECO_NOT_FOUND : proj->crs_look(crs, xy, facts, error);
}

#define NULL_ISLAND_DEG 0.01     /* degrees taken for metres lie so near to the origin of a map of the whole Earth */

/* Whether numbers are small enough for longitude and latitude, in either order. */
static bool may_be_degrees(const double xy[2])
{
	return fmin(fabs(xy[0]), fabs(xy[1])) <= 90 && fmax(fabs(xy[0]), fabs(xy[1])) <= 180;
}

/* Whether a place can be meant in a CRS; `xy` and `facts` as in eco_crs_look, which went well. */
static enum eco_crs_fit fit_of(const char *crs, const double xy[2], const struct eco_crs_facts *facts)
{
	const double turned[2] = { xy[1], xy[0] };
	struct eco_crs_facts other;
	bool nowhere = fabs(facts->degrees[0]) < NULL_ISLAND_DEG && fabs(facts->degrees[1]) < NULL_ISLAND_DEG;
	if (!facts->geographic && may_be_degrees(xy) && (!facts->inside || nowhere))
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

static size_t grid_row(uint32_t epsg)
{
	size_t i = 0;
	while (i < sizeof grids_rows / sizeof *grids_rows && (epsg < grids_rows[i].first || epsg > grids_rows[i].last))
		i++;
	return i;
}

uint32_t eco_crs_usual(uint32_t epsg)
{
	size_t row = grid_row(epsg);
	return row < sizeof grids_rows / sizeof *grids_rows ? (uint32_t)grids_rows[row].rank : 0;
}

const char *eco_crs_words(const char *code)
{
	size_t row = grid_row((uint32_t)strtoul(code + strcspn(code, "0123456789"), NULL, 10));
	return row < sizeof grids_rows / sizeof *grids_rows ? grids_rows[row].words : "";
}

double eco_degree_m(double latitude_deg)
{
	double sine, cosine;
	eco_angle16_sincos(eco_angle16_from_deg(fmin(fmax(latitude_deg, -90), 90)), &sine, &cosine);
	return ECO_DEGREE_M * cosine;
}

void eco_crs_utm(const double degrees[2], char code[32])
{
	int zone = (int)floor((degrees[0] + 180) / 6) + 1;
	zone = zone < 1 ? 1 : zone > 60 ? 60 : zone;
	snprintf(code, 32, "EPSG:%d", (degrees[1] < 0 ? 32700 : 32600) + zone);
}

struct eco_crs {
	const struct eco_proj_module *proj;
	struct eco_crs_path *path;           /* NULL: already in the scene's metres */
	double origin[3];
	bool use_z;
};

char *eco_crs_short_name(const char *crs)
{
	const char *quote = strlen(crs) > 80 ? strchr(crs, '"') : NULL, *end = quote
		? strchr(quote + 1, '"') : NULL;
	return end ? eco_copy_part(quote + 1, (size_t)(end - quote - 1)) : eco_copy_text(crs);
}

static enum eco_code plain_metres(const struct eco_crs_request *r, struct eco_error *error)
{
	const char *crs = r->stated ? r->stated : r->of_file, *vertical = r->vertical,
		*other = r->frame->vertical;
	char *name;
	if (crs) {
		name = eco_crs_short_name(crs);
		eco_fail(error, ECO_BAD_INPUT, "%.200s is in %.80s, but the scene has no CRS; add \"crs\": "
			"\"%.80s\" (if it is one in metres) and \"origin\" to the scene", r->path, name,
			strlen(crs) <= 80 ? crs
			: "EPSG:...");
		free(name);
		return ECO_BAD_INPUT;
	}
	if (!r->use_z || (!vertical && !other) || (vertical && other && strcasecmp(vertical, other) == 0))
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT, "%.200s: heights are converted between vertical datums only "
		"in a scene with a CRS; add \"crs\" and "
		"\"origin\" to the scene, or give scene and entry the same \"vertical\"", r->path);
}

static enum eco_code open_path(struct eco_crs *c, const struct eco_crs_request *request,
	struct eco_error *error)
{
	c->proj = eco_module(ECO_MODULE_PROJ, error);
	return !c->proj ? ECO_NOT_FOUND : c->proj->crs_open(&c->path, request, error);
}

enum eco_code eco_crs_open(struct eco_crs **crs, const struct eco_crs_request *request,
	struct eco_error *error)
{
	struct eco_crs *c = eco_alloc(1, sizeof *c);
	const struct eco_frame *frame = request->frame;
	enum eco_code code = ECO_OK;
	*crs = NULL;
	c->use_z = request->use_z;
	memcpy(c->origin, frame->origin, sizeof c->origin);
	if (!frame->crs)
		code = plain_metres(request, error);
	else if (!request->stated && !request->of_file && request->no_crs_says && *request->no_crs_says)
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: its CRS is not stated%s; add \"crs\": "
			"\"%.80s\" to its entry if it is the scene's", request->path, request->no_crs_says,
			frame->crs);
	else if (request->stated || request->of_file)
		code = open_path(c, request, error);
	/* else places are in the scene's CRS already */
	if (!code)
		*crs = c;
	else
		eco_crs_close(c);
	return code;
}

enum eco_code eco_crs_convert(struct eco_crs *crs, double xyz[3], bool *converted, const char **why,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	*converted = true;
	*why = "";
	if (crs->path)
		code = crs->proj->crs_convert(crs->path, xyz, converted, why, error);
	for (int k = 0; code == ECO_OK && *converted && k < 3; k++)
		xyz[k] -= k < 2 || crs->use_z ? crs->origin[k] : 0;
	return code;
}

void eco_crs_span_add(struct eco_crs_span *span, const double xy[2])
{
	for (int k = 0; k < 2; k++) {
		span->first[k] = span->any ? span->first[k] : xy[k];
		span->low[k] = span->any ? fmin(span->low[k], xy[k]) : xy[k];
		span->high[k] = span->any ? fmax(span->high[k], xy[k]) : xy[k];
		span->has_decimals |= floor(xy[k]) != xy[k];
	}
	span->any = true;
}

enum eco_code eco_crs_refuse_degrees(const struct eco_crs_span *span, const char *crs, bool heap,
	const char *path, enum eco_crs_fit *fit, char area[80], struct eco_error *error)
{
	struct eco_crs_facts facts = { .geographic = false };
	char zone[32], scene[120] = "";
	*fit = ECO_CRS_FITS;
	area[0] = 0;
	if (!span->any || (crs && eco_crs_look(crs, span->first, &facts, NULL) != ECO_OK))
		return ECO_OK;
	if (crs) {
		*fit = fit_of(crs, span->first, &facts);
		if (!isnan(facts.area[0]))
			eco_crs_area_text(facts.area, area);
	}
	if (facts.geographic || !span->has_decimals || !may_be_degrees(span->low) ||
		!may_be_degrees(span->high) || !(*fit == ECO_CRS_DEGREES || heap))
		return ECO_OK;
	char *name = crs ? eco_crs_short_name(crs) : NULL;
	eco_crs_utm(span->first, zone);
	if (!crs)
		snprintf(scene, sizeof scene,
			", and \"crs\": \"%s\" (their UTM zone) and an \"origin\" in it to the "
			"scene", zone);
	enum eco_code code = eco_fail(error, ECO_BAD_INPUT,
		"%.150s: its coordinates, such as %.10g, %.10g, look like degrees, but %.80s counts in metres or feet: all "
		"plants would stand on one spot; if they are longitude and latitude, say \"crs\": \"EPSG:4326\" in its "
		"entry (ecopack start: --crs EPSG:4326)%s", path, span->first[0], span->first[1], name ? name
		: crs ? "its CRS" : "the scene", scene);
	free(name);
	return code;
}

void eco_crs_close(struct eco_crs *crs)
{
	if (crs && crs->path)
		crs->proj->crs_close(crs->path);
	free(crs);
}
