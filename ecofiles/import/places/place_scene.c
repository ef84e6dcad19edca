/* The scene's CRS and origin that suit a table's places, and the terrain's CRS where it does not say one. */
#include "ecofiles/import/places/place_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/import/places/crs.h"

#define ROUND_M 10.0             /* origins are round */

bool eco_place_dem_has(const struct eco_place_look *l, const double degrees[2])
{
	const struct eco_raster_extent *dem = l->asked->dem;
	double middle[2];
	struct eco_crs_facts facts;
	if (!dem || dem->crs[0] == 0)
		return false;
	for (int k = 0; k < 2; k++)
		middle[k] = (dem->low[k] + dem->high[k]) / 2;
	/* within three of its lengths: a raster may leave some plants outside */
	double reach = fmax(dem->high[0] - dem->low[0], dem->high[1] - dem->low[1]);
	if (eco_crs_look(dem->crs, middle, &facts, NULL) != ECO_OK || isnan(facts.degrees[0]))
		return false;
	double reach_deg = 3 * (facts.geographic ? reach : reach / 60000);
	return fabs(facts.degrees[0] - degrees[0]) < reach_deg &&
		fabs(facts.degrees[1] - degrees[1]) < reach_deg;
}

static enum eco_code metric(const char *crs, const double at[2], struct eco_crs_facts *facts,
	struct eco_error *error)
{
	enum eco_code code = eco_crs_look(crs, at, facts, error);
	if (!code && !facts->metric_map)
		code = eco_fail(error, ECO_BAD_INPUT, "--scene-crs %.60s: a scene is in a projected CRS in "
			"metres, such as a UTM zone", crs);
	return code;
}

static enum eco_code guess_scene(struct eco_place_look *l)
{
	struct eco_place_guess *g = l->guess;
	struct eco_crs_facts own = { .metric_map = false }, other;
	const struct eco_raster_extent *dem = l->asked->dem;
	const int x = g->swapped;
	const double at[2] = { l->xy[x].middle, l->xy[1 - x].middle };
	const char *crs = g->crs[0] != 0 ? g->crs : l->asked->table->crs;
	if (!crs) {
		snprintf(g->scene_why, sizeof g->scene_why, "none: plain metres");
		return ECO_OK;
	}
	enum eco_code code = eco_crs_look(crs, at, &own, l->error);
	memcpy(g->degrees, own.degrees, sizeof g->degrees);
	if (!code && l->asked->scene_crs) {
		code = metric(l->asked->scene_crs, at, &other, l->error);
		snprintf(g->scene_crs, sizeof g->scene_crs, "%.31s", l->asked->scene_crs);
		snprintf(g->scene_why, sizeof g->scene_why, "as you say");
	} else if (!code && own.metric_map && own.code[0] != 0) {
		snprintf(g->scene_crs, sizeof g->scene_crs, "%s", own.code);
		snprintf(g->scene_why, sizeof g->scene_why, "the table's: projected, in metres");
	} else if (!code && dem && dem->crs[0] != 0 && eco_place_dem_has(l, own.degrees)
			&& eco_crs_look(dem->crs, dem->low, &other, NULL) == ECO_OK && other.metric_map
			&& other.code[0] != 0) {
		snprintf(g->scene_crs, sizeof g->scene_crs, "%s", other.code);
		snprintf(g->scene_why, sizeof g->scene_why, "%.80s, the terrain's, which so stays as it is",
			other.name);
	} else if (!code && !isnan(own.degrees[0])) {
		eco_crs_utm(own.degrees, g->scene_crs);
		snprintf(g->scene_why, sizeof g->scene_why, "the UTM zone of %.4f, %.4f, the middle of the "
			"plants",
			own.degrees[0], own.degrees[1]);
	} else if (!code) {
		code = eco_fail(l->error, ECO_BAD_INPUT, "%.150s: %.10g, %.10g is no place in %.40s; give "
			"the CRS of the coordinates with --crs", l->asked->table->path, at[0], at[1], crs);
	}
	return code;
}

static void note_nothing(void *ctx, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void note_nothing(void *ctx, const char *format, ...)
{
	(void)ctx;
	(void)format;
}

/* The middle in the scene's CRS, rounded. */
static enum eco_code guess_origin(struct eco_place_look *l)
{
	struct eco_place_guess *g = l->guess;
	const int x = g->swapped;
	double at[3] = { l->xy[x].middle, l->xy[1 - x].middle, 0 };
	if (l->nowhere || g->offsets.quadrat_m > 0) {
		snprintf(g->origin_why, sizeof g->origin_why, "%s", l->nowhere ? "the plot's centre"
			: "where the quadrats count from");
		return ECO_OK;
	}
	struct eco_frame frame = { .crs = g->scene_crs };
	struct eco_crs_request request = { .path = l->asked->table->path, .stated = g->crs[0] != 0 ? g->crs
		: l->asked->table->crs, .frame = &frame, .note = note_nothing };
	struct eco_crs *crs = NULL;
	const char *why = "";
	bool converted = true;
	enum eco_code code = ECO_OK;
	if (g->scene_crs[0] != 0) {
		code = eco_crs_open(&crs, &request, l->error);
		if (!code)
			code = eco_crs_convert(crs, at, &converted, &why, l->error);
		eco_crs_close(crs);
	}
	if (!code && !converted)
		code = eco_fail(l->error, ECO_BAD_INPUT, "%.150s: %.10g, %.10g is no place in %.40s (%.60s); "
			"give the CRS of the coordinates with --crs", l->asked->table->path, l->xy[x].middle,
			l->xy[1 - x].middle, g->crs, why);
	for (int k = 0; k < 2; k++)
		g->origin[k] = round(at[k] * (g->unit ? l->unit_m : 1) / ROUND_M) * ROUND_M;
	snprintf(g->origin_why, sizeof g->origin_why, "the middle of the plants, rounded to %g m", ROUND_M);
	return code;
}

/* A raster that does not say its CRS is in the table's or the scene's, where its numbers fit. */
static void guess_dem(struct eco_place_look *l)
{
	const struct eco_raster_extent *dem = l->asked->dem;
	const double *o = l->guess->origin;
	if (!dem || dem->crs[0] != 0 || l->guess->scene_crs[0] == 0)
		return;
	if (eco_raster_extent_has(dem, o))
		snprintf(l->guess->dem_crs, sizeof l->guess->dem_crs, "%s", l->guess->scene_crs);
	else if (dem->low[0] >= -180 && dem->high[0] <= 180 && dem->low[1] >= -90 && dem->high[1] <= 90)
		snprintf(l->guess->dem_crs, sizeof l->guess->dem_crs, "EPSG:4326");
	else
		snprintf(l->guess->dem_crs, sizeof l->guess->dem_crs, "%s", l->guess->crs);
}

enum eco_code eco_place_scene(struct eco_place_look *l)
{
	enum eco_code code = guess_scene(l);
	if (!code)
		code = guess_origin(l);
	if (!code)
		guess_dem(l);
	return code;
}
