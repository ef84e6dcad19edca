/* Numbers show by their size whether they are degrees, metres of a plot, or eastings and northings of a grid.
 * They do not show which grid, as zones look alike: the columns' names decide, or the terrain, or else the
 * user. Longer than 600 lines: each way to decide stands beside the error that asks. */
#include "ecofiles/import/places/place_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/phrase.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/words.h"

#define PLOT_M 100000.0          /* beyond this from 0 numbers are a grid's, not a plot's */
#define FOOT_M 0.3               /* no grid is in smaller units */
#define DEGREES_SPAN 5.0         /* an inventory is not wider */
#define UTM_LEAST_M 100000.0
#define UTM_MOST_M 900000.0
#define BAND_S_LOW_M 3530000.0   /* northings of 32 to 40 degrees north */
#define BAND_S_HIGH_M 4440000.0
#define BARE_SOUTH -56.0         /* no tree stands beyond these latitudes */
#define BARE_NORTH 75.0
#define ZONES_LISTED 24u         /* UTM zones of a language that a question names */
#define LISTED 6u                /* zones where a language is written: if there are more, all zones are offered */
#define ONLY_SO_TERRAIN "only so does the terrain lie there"
#define WEB_MERCATOR "EPSG:3857"
#define NEAR_DEG 0.01            /* places that differ by datum alone lie nearer together */

/* ---- The numbers ---- */

static bool numbers_of(struct eco_place_look *l, int k, struct eco_spread *spread)
{
	const struct eco_table *t = l->asked->table;
	if (!l->guess->from_geometry)
		return eco_table_coordinates(t, l->asked->columns->of[k], l->asked->columns, spread);
	for (uint32_t row = 0; row < t->row_count; row++)
		if (!isnan(t->places[row][k]) && !eco_spread_add(spread, t->places[row][k]))
			return false;
	return true;
}

/* The middle of those that are not 0, which stands for no place. */
static enum eco_code measure(struct eco_place_look *l)
{
	for (int k = 0; k < 2; k++) {
		struct eco_spread spread = { 0 };
		bool good = numbers_of(l, k, &spread);
		l->xy[k] = (struct place_range){ eco_spread_quantile(&spread, 0.02),
			eco_spread_quantile(&spread, 0.5), eco_spread_quantile(&spread, 0.98) };
		eco_spread_free(&spread);
		if (!good)
			return eco_fail(l->error, ECO_NO_MEMORY, "out of memory");
		if (isnan(l->xy[k].middle))
			return l->names[k] ? eco_fail(l->error, ECO_BAD_INPUT, "%.200s: no row has a place: no "
				"number in \"%.60s\"", l->asked->table->path, l->names[k])
				: eco_fail(l->error, ECO_BAD_INPUT, "%.200s: no row is a point; a table of plants has "
				"a point for each (lines and areas are for \"scatter\" in a scene; coordinates "
				"in quotes are none)", l->asked->table->path);
		l->at[k] = l->turned[1 - k] = l->xy[k].middle;
	}
	l->as_named[0] = l->at[0] > 180 ? l->at[0] - 360 : l->at[0];
	l->as_named[1] = l->at[1];
	return ECO_OK;
}

/* Longitudes may count from 0 to 360 where names say what they are. */
static bool are_degrees(const struct eco_place_look *l, int longitude)
{
	const struct place_range *x = &l->xy[longitude], *y = &l->xy[1 - longitude];
	double most = l->asked->columns->names_say_degrees ? 360 : 180;
	return x->low >= -180 && x->high <= most && y->low >= -90 && y->high <= 90;
}

/* Degrees so near each other have decimals. */
static bool are_whole(const struct eco_place_look *l)
{
	for (int k = 0; k < 2; k++)
		if (floor(l->xy[k].low) != l->xy[k].low || floor(l->xy[k].high) != l->xy[k].high)
			return false;
	return true;
}

/* ---- Degrees ---- */

/* Columns change places; a file's points cannot. */
static enum eco_code say_swapped(struct eco_place_look *l, const char *why)
{
	if (l->guess->from_geometry)
		return eco_fail(l->error, ECO_BAD_INPUT,
			"%.150s: x and y of its points are swapped, as %.7g, %.7g: %s. x is "
			"easting or longitude, y is northing or latitude: export it anew, or with x and y as columns",
			l->asked->table->path, l->xy[0].middle, l->xy[1].middle, why);
	l->guess->swapped = true;
	snprintf(l->guess->crs_why, sizeof l->guess->crs_why, "%s\"%.40s\" and \"%.40s\" are swapped: %s",
		are_degrees(l, 0) || are_degrees(l, 1) ? "degrees; " : "", l->names[0] ? l->names[0] : "x",
		l->names[1] ? l->names[1] : "y", why);
	return ECO_OK;
}

static bool is_bare(const double degrees[2])
{
	return degrees[1] < BARE_SOUTH || degrees[1] > BARE_NORTH;
}

/* Whether such an inventory may lie where its numbers say it does, and lies where it should if swapped. */
static bool speaks_for_swapping(const struct eco_place_look *l, const double as_named[2], const double swapped[2])
{
	return l->speech && !eco_speech_reaches(l->speech, as_named, false)
		&& eco_speech_reaches(l->speech, swapped, true);
}

/* Whether a place in degrees is outside the area of use of a CRS, and inside once swapped; *facts are the CRS's. */
static bool area_speaks_for_swapping(const char *crs, const double as_named[2], const double swapped[2],
	struct eco_crs_facts *facts)
{
	return crs && eco_crs_look(crs, as_named, facts, NULL) == ECO_OK && !isnan(facts->area[0]) &&
		!eco_crs_area_has(facts->area, as_named) && eco_crs_area_has(facts->area, swapped);
}

/* Says why degrees in a CRS are what they should be only if longitude and latitude change places; "": they are not
 * known to be. */
static void look_for_swapping(const struct eco_place_look *l, const char *crs, char why[ECO_WHY_BYTES])
{
	const double *as_named = l->as_named, *swapped = l->turned;
	struct eco_crs_facts facts;
	char area[80];
	why[0] = 0;
	if (!are_degrees(l, 1))
		return;
	if (!are_degrees(l, 0))
		snprintf(why, ECO_WHY_BYTES, "a latitude lies between -90 and 90");
	else if (eco_place_dem_has(l, as_named))
		return;
	else if (eco_place_dem_has(l, swapped))
		snprintf(why, ECO_WHY_BYTES, ONLY_SO_TERRAIN);
	else if (is_bare(as_named) && !is_bare(swapped))
		snprintf(why, ECO_WHY_BYTES, "no tree stands at latitude %.1f", as_named[1]);
	else if (area_speaks_for_swapping(crs, as_named, swapped, &facts) ||
		area_speaks_for_swapping(l->asked->scene_crs, as_named, swapped, &facts))
		snprintf(why, ECO_WHY_BYTES, "only so do they lie in the area of use of %.60s, %s",
			facts.name, eco_crs_area_text(facts.area, area));
	else if (!l->guess->from_geometry && !l->asked->axes_said &&
		speaks_for_swapping(l, as_named, swapped))
		snprintf(why, ECO_WHY_BYTES,
			"its columns are %s, which is written at %.2f, %.2f, and not at %.2f, %.2f",
			eco_speech_name(l->speech), swapped[0], swapped[1], as_named[0], as_named[1]);
}

static enum eco_code guess_degrees(struct eco_place_look *l)
{
	char why[ECO_WHY_BYTES];
	snprintf(l->guess->crs, sizeof l->guess->crs, "EPSG:4326");
	look_for_swapping(l, NULL, why);
	if (why[0] != 0)
		return say_swapped(l, why);
	snprintf(l->guess->crs_why, sizeof l->guess->crs_why, "degrees, by %s: around %.4f, %.4f",
		l->asked->columns->names_say_degrees ? "the columns' names and numbers" : "the numbers",
		l->as_named[0], l->as_named[1]);
	return ECO_OK;
}

/* ---- A grid ---- */

static uint32_t listed(uint32_t found) { return found < ECO_CRS_CHOICES_MAX ? found : ECO_CRS_CHOICES_MAX; }

/* As many as fit, and how many more there are; `choices` has ECO_CRS_CHOICES_MAX of them at most. */
static void list_choices(const struct eco_crs_choice *choices, uint32_t found, char *text, size_t size)
{
	text[0] = 0;
	for (uint32_t i = 0; i < found; i++) {
		char choice[200] = "";
		if (i < ECO_CRS_CHOICES_MAX)
			snprintf(choice, sizeof choice, "%s (%s; at %.2f, %.2f)", choices[i].code, choices[i].name,
				choices[i].degrees[0], choices[i].degrees[1]);
		eco_phrase_add(text, size, choice);
	}
}

static bool may_be_utm(const struct eco_place_look *l)
{
	return l->xy[0].middle > UTM_LEAST_M && l->xy[0].middle < UTM_MOST_M && l->xy[1].middle > 0
		&& l->xy[1].middle < 1e7;
}

/* Those that fit come first, in their order; returns how many. */
static uint32_t put_first(const struct eco_place_look *l, struct eco_crs_choice *choices, uint32_t found,
	bool (*fits)(const struct eco_place_look *, const struct eco_crs_choice *))
{
	uint32_t first = 0;
	for (uint32_t i = 0; i < found; i++) {
		struct eco_crs_choice choice = choices[i];
		if (!fits(l, &choice))
			continue;
		memmove(&choices[first + 1], &choices[first], (i - first) * sizeof *choices);
		choices[first++] = choice;
	}
	return first;
}

/* Whether it has the plants where the columns' language is written. */
static bool is_spoken(const struct eco_place_look *l, const struct eco_crs_choice *choice)
{
	return l->speech && eco_speech_reaches(l->speech, choice->degrees, true);
}

static bool is_no_zone(const struct eco_place_look *l, const struct eco_crs_choice *choice)
{
	(void)l;
	return !strstr(choice->name, "UTM");
}

/* Whether they may be in the grid of maps on the web, which has the whole Earth: where the columns' language
 * is written. */
static bool look_at_web(const struct eco_place_look *l, struct eco_crs_choice *web)
{
	struct eco_crs_facts facts;
	if (!l->speech || eco_crs_look(WEB_MERCATOR, l->at, &facts, NULL) != ECO_OK || isnan(facts.degrees[0])
			|| !eco_speech_reaches(l->speech, facts.degrees, true))
		return false;
	*web = (struct eco_crs_choice){ .code = WEB_MERCATOR, .name = "maps on the web",
		.degrees = { facts.degrees[0], facts.degrees[1] } };
	return true;
}

/* "; Spanish is written in EPSG:32629, EPSG:32630": of the first `spoken`, those that are UTM zones; of a
 * language of many zones none, as no one is nearer then. */
static void list_zones(const struct eco_place_look *l, const struct eco_crs_choice *choices, uint32_t spoken,
	char *text, size_t size)
{
	char zones[120] = "";
	uint32_t count = 0;
	for (uint32_t i = 0; i < spoken; i++)
		if (strstr(choices[i].name, "UTM zone") && count++ < ZONES_LISTED)
			eco_phrase_add(zones, sizeof zones, choices[i].code);
	text[0] = 0;
	if (count > 0 && count <= ZONES_LISTED)
		snprintf(text, size, "; %s is written in %s", eco_speech_name(l->speech), zones);
}

/* Names the few where the columns' language is written; else all UTM zones may be meant. */
static enum eco_code ask_for_grid(struct eco_place_look *l, struct eco_crs_choice *choices, uint32_t found,
	uint32_t spoken)
{
	char list[400] = "such as EPSG:2154 in France", zones[160];
	struct eco_crs_facts facts;
	if (may_be_utm(l) && (spoken == 0 || spoken > LISTED)
			&& eco_crs_look("EPSG:32631", l->at, &facts, l->error) == ECO_OK) {
		list_zones(l, choices, spoken, zones, sizeof zones);
		uint32_t grids = put_first(l, choices, listed(found), is_no_zone);
		if (grids > 0)
			list_choices(choices, grids, list, sizeof list);
		return eco_fail(l->error, ECO_BAD_INPUT, "%.100s: which CRS are its coordinates in? %.0f, "
			"%.0f is a place in each UTM zone, at latitude %.1f: give the zone of your "
			"longitude, --crs EPSG:32601 (180 W) to EPSG:32660 (180 E), in the south "
			"EPSG:32701 to EPSG:32760%s; or the country's grid, %s",
			l->asked->table->path, l->at[0], l->at[1], facts.degrees[1], zones, list);
	}
	list_choices(choices, found, list, sizeof list);
	return eco_fail(l->error, ECO_BAD_INPUT, "%.100s: which CRS are its coordinates in? %.0f, %.0f "
		"%s%s; give it with --crs EPSG:...", l->asked->table->path, l->at[0], l->at[1],
		found > 0 ? "may be in " : "is in no CRS of PROJ's register as easting and northing", list);
}

static enum eco_code take_choice(struct eco_place_look *l, const struct eco_crs_choice *choice, const char *why)
{
	snprintf(l->guess->crs, sizeof l->guess->crs, "%s", choice->code);
	snprintf(l->guess->crs_why, sizeof l->guess->crs_why, "%.80s, %s; a place at %.3f, %.3f", choice->name, why,
		choice->degrees[0], choice->degrees[1]);
	return ECO_OK;
}

/* The only grid with the words of a hint, or else where the columns' language is written, that has the plants
 * if x and y change places. */
static enum eco_code take_turned(struct eco_place_look *l, const char *hint, bool *taken)
{
	struct eco_crs_choice choices[ECO_CRS_CHOICES_MAX];
	uint32_t found = 0;
	enum eco_code code = l->guess->from_geometry ? ECO_OK
		: eco_crs_choices(l->turned, hint, choices, &found, l->error);
	*taken = !code && (hint ? found == 1 : put_first(l, choices, listed(found), is_spoken) == 1);
	l->guess->swapped |= *taken;
	if (!*taken)
		return code;
	return take_choice(l, &choices[0], hint ? "by the columns' names; x counts to the north"
		: "where the columns' language is written; x counts to the north");
}

/* Surveyors' grids call the northing x, most tables the easting: plants may stand at either place. */
static enum eco_code settle_axes(struct eco_place_look *l)
{
	const struct eco_place_guess *g = l->guess;
	struct eco_crs_facts named, turned;
	if (g->from_geometry || g->swapped || l->asked->axes_said || g->crs[0] == 0 || !eco_words_any(l->names[0], "x")
			|| !eco_words_any(l->names[1], "y") || eco_crs_look(g->crs, l->at, &named, NULL) != ECO_OK
			|| !named.x_is_north || !named.inside || eco_crs_look(g->crs, l->turned, &turned, NULL) != ECO_OK
			|| !turned.inside || eco_place_dem_has(l, named.degrees))
		return ECO_OK;
	if (eco_place_dem_has(l, turned.degrees))
		return say_swapped(l, ONLY_SO_TERRAIN);
	return eco_fail(l->error, ECO_BAD_INPUT, "%.100s: does \"%.40s\" count to the north, as x does in %s "
		"(%.40s), or to the east, as in most tables? To the east the plants are at %.3f, %.3f: "
		"--x \"%.40s\" --y \"%.40s\"; to the north at %.3f, %.3f: --x \"%.40s\" --y \"%.40s\"",
		l->asked->table->path, l->names[0], l->guess->crs, named.name, named.degrees[0],
		named.degrees[1], l->names[0], l->names[1], turned.degrees[0], turned.degrees[1],
		l->names[1], l->names[0]);
}

/* The terrain's CRS, where its extent has the plants. */
static bool take_dem(struct eco_place_look *l)
{
	const struct eco_raster_extent *dem = l->asked->dem;
	struct eco_crs_facts facts;
	if (!dem || dem->crs[0] == 0 || eco_crs_look(dem->crs, l->at, &facts, NULL) != ECO_OK || facts.geographic
			|| facts.code[0] == 0)
		return false;
	if (!eco_raster_extent_has(dem, l->at))
		return false;
	snprintf(l->guess->crs, sizeof l->guess->crs, "%s", facts.code);
	snprintf(l->guess->crs_why, sizeof l->guess->crs_why, "%.80s, the terrain's: the plants lie on it",
		facts.name);
	return true;
}

/* The only grid that puts the plants where the terrain is. */
static bool take_over_dem(struct eco_place_look *l, const struct eco_crs_choice *choices, uint32_t count)
{
	uint32_t over = 0, last = 0;
	for (uint32_t i = 0; i < count; i++)
		if (eco_place_dem_has(l, choices[i].degrees)) {
			over++;
			last = i;
		}
	if (over == 1)
		take_choice(l, &choices[last], "the only one where the terrain is");
	return over == 1;
}

/* Plants and a terrain that say nothing are in one grid of metres where its extent has them. */
static bool take_bare_dem(struct eco_place_look *l)
{
	const struct eco_raster_extent *dem = l->asked->dem;
	bool on = dem && dem->crs[0] == 0 && eco_raster_extent_has(dem, l->at);
	if (on)
		snprintf(l->guess->crs_why, sizeof l->guess->crs_why, "metres of the terrain's grid, which says "
			"no CRS either: the plants lie on it");
	return on;
}

/* Degrees of some places, within a metre if they are taken for metres. */
static bool is_heap_of_degrees(const struct eco_place_look *l)
{
	return l->asked->table->row_count > 1 && (are_degrees(l, 0) || are_degrees(l, 1)) &&
		(l->asked->columns->names_say_degrees ||
			(l->xy[0].high - l->xy[0].low < ECO_HEAP_M &&
				l->xy[1].high - l->xy[1].low < ECO_HEAP_M));
}

static enum eco_code refuse_degrees(const struct eco_place_look *l, const char *crs, const struct eco_crs_facts *facts,
	const char *who)
{
	return eco_fail(l->error, ECO_BAD_INPUT,
		"%.150s: its coordinates, such as %.7g, %.7g, look like degrees, but %.40s "
		"(%.80s, as %.60s) counts in metres or feet: all plants would stand on one spot, at %.3f, %.3f. If they are "
		"longitude and latitude give --crs EPSG:4326 (and --scene-crs %.40s for a scene in that CRS); if they are "
		"metres of a plot give no --crs",
		l->asked->table->path, l->xy[0].middle, l->xy[1].middle, crs, facts->name, who,
		facts->degrees[0], facts->degrees[1], crs);
}

static enum eco_code take_stated(struct eco_place_look *l, const char *crs, const char *who)
{
	struct eco_crs_facts facts, other;
	char why[ECO_WHY_BYTES] = "", area[80];
	enum eco_code code = eco_crs_look(crs, l->at, &facts, l->error);
	if (code)
		return code;
	if (strlen(crs) < sizeof l->guess->crs)
		snprintf(l->guess->crs, sizeof l->guess->crs, "%s", crs);
	else
		snprintf(l->guess->crs, sizeof l->guess->crs, "%s", facts.code);
	int used = snprintf(l->guess->crs_why, sizeof l->guess->crs_why, "%.80s, as %s", facts.name, who);
	if (!isnan(facts.degrees[0]))
		used += snprintf(l->guess->crs_why + used, sizeof l->guess->crs_why - (size_t)used,
			"; a place at %.3f, %.3f", facts.degrees[0], facts.degrees[1]);
	enum eco_crs_fit fit = eco_crs_fit(crs, l->at, &facts);
	if (!are_whole(l) && (fit == ECO_CRS_DEGREES || (!facts.geographic && is_heap_of_degrees(l))))
		return refuse_degrees(l, crs, &facts, who);
	if (facts.geographic)
		look_for_swapping(l, crs, why);
	else if (fit == ECO_CRS_SWAPPED)
		snprintf(why, sizeof why, "only so do they lie in the CRS's area of use, %s",
			eco_crs_area_text(facts.area, area));
	else if (!eco_place_dem_has(l, facts.degrees) && eco_crs_look(crs, l->turned, &other, NULL) == ECO_OK &&
		eco_place_dem_has(l, other.degrees))
		snprintf(why, sizeof why, ONLY_SO_TERRAIN);
	if (why[0] != 0)
		return say_swapped(l, why);
	if (fit == ECO_CRS_OUTSIDE)
		snprintf(l->guess->crs_why + used, sizeof l->guess->crs_why - (size_t)used,
			"; but its area of use is %s", eco_crs_area_text(facts.area, area));
	return ECO_OK;
}

/* Whether plants may stand in this half of a zone, by its latitude, the terrain and the columns' language. */
static bool half_can_be(const struct eco_place_look *l, const char *crs)
{
	struct eco_crs_facts facts;
	return eco_crs_look(crs, l->at, &facts, NULL) == ECO_OK && !isnan(facts.degrees[0])
		&& !is_bare(facts.degrees) && (!l->asked->dem || l->asked->dem->crs[0] == 0
		|| eco_place_dem_has(l, facts.degrees))
		&& (!l->speech || eco_speech_reaches(l->speech, facts.degrees, false));
}

static enum eco_code zone_crs(struct eco_place_look *l, const struct eco_zones *z, char crs[32])
{
	const char *name = l->asked->table->columns[z->column];
	char south[32];
	snprintf(crs, 32, "EPSG:%u", z->zone.epsg ? z->zone.epsg : 32600 + z->zone.number);
	snprintf(south, sizeof south, "EPSG:%u", 32700 + z->zone.number);
	if (z->zone.epsg || z->zone.half == ECO_HALF_NORTH)
		return ECO_OK;
	bool north = half_can_be(l, crs) && !(z->zone.half == ECO_HALF_S
		&& (l->xy[1].middle < BAND_S_LOW_M || l->xy[1].middle > BAND_S_HIGH_M));
	if (north && z->zone.half != ECO_HALF_SOUTH && half_can_be(l, south))
		return eco_fail(l->error, ECO_BAD_INPUT, "%.100s: \"%.40s\" says \"%s\": is that zone %u in "
			"the north, --crs %s, or in the south, --crs %s?", l->asked->table->path, name, z->first,
			z->zone.number, crs, south);
	if (!north || z->zone.half == ECO_HALF_SOUTH)
		memcpy(crs, south, sizeof south);
	return ECO_OK;
}

/* The zone of a column, if all rows have one. */
static enum eco_code take_zone(struct eco_place_look *l, bool *taken)
{
	struct eco_zones zones;
	char crs[32], who[100];
	enum eco_code code = eco_zones_find(l->asked->table, l->asked->source,
		l->names[0] && eco_words_any(l->names[0], "utm"), &zones, l->error);
	if (code)
		return code;
	*taken = zones.column != ECO_NONE && (zones.zone.epsg || may_be_utm(l));
	if (!*taken)
		return ECO_OK;
	const char *name = l->asked->table->columns[zones.column];
	code = zone_crs(l, &zones, crs);
	if (!code && zones.other[0] != 0)
		return eco_fail(l->error, ECO_BAD_INPUT, "%.100s: its rows are in several zones: \"%.40s\" "
			"is \"%s\" and \"%s\", and an entry has one CRS. Put each zone into a table of its own; or "
			"start with --crs %s and give scene.json an entry for each zone, with \"only\": "
			"{\"%.40s\": \"%s\"} and its own \"crs\"", l->asked->table->path, name, zones.first, zones.other,
			crs, name, zones.first);
	snprintf(who, sizeof who, "\"%.40s\" says, \"%s\"", name, zones.first);
	return code ? code : take_stated(l, crs, who);
}

/* Without the grids in another unit than the names say. */
static void keep_unit(const struct eco_place_look *l, struct eco_crs_choice *choices, uint32_t *found)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; l->unit && i < listed(*found); i++)
		if (choices[i].metric == (l->unit_m == 1))
			choices[kept++] = choices[i];
	*found = l->unit ? kept : *found;
}

static enum eco_code guess_grid(struct eco_place_look *l)
{
	struct eco_crs_choice choices[ECO_CRS_CHOICES_MAX + 1];
	char hint[ECO_WORDS_BYTES];
	uint32_t found = 0;
	enum eco_code code = ECO_OK;
	bool taken = false;
	if (take_dem(l))
		return ECO_OK;
	if (eco_place_hint(l->names, hint)) {
		code = eco_crs_choices(l->at, hint, choices, &found, l->error);
		keep_unit(l, choices, &found);
		if (!code && found == 1)
			return take_choice(l, &choices[0], "by the columns' names");
		if (!code && found == 0)
			code = take_turned(l, hint, &taken);
		if (code || taken)
			return code;
	}
	code = take_zone(l, &taken);
	if (code || taken)
		return code;
	if (found == 0)
		code = eco_crs_choices(l->at, NULL, choices, &found, l->error);
	if (code)
		return code;
	keep_unit(l, choices, &found);
	uint32_t spoken = put_first(l, choices, listed(found), is_spoken);
	struct eco_crs_choice web;
	char why[100];
	if (take_over_dem(l, choices, listed(found)) || take_bare_dem(l))
		return ECO_OK;
	if (look_at_web(l, &web)) {
		memmove(&choices[spoken + 1], &choices[spoken],
			(ECO_CRS_CHOICES_MAX - spoken) * sizeof web);
		choices[spoken++] = web;
		found++;
	}
	if (found == 1 && spoken == 0)
		return take_choice(l, &choices[0], "the only one with this place in its area of use");
	if (spoken == 1) {
		snprintf(why, sizeof why, "the only one with this place where %s, the columns' language, is "
			"written", eco_speech_name(l->speech));
		return take_choice(l, &choices[0], why);
	}
	if (spoken == 0 && l->speech)
		code = take_turned(l, NULL, &taken);
	if (code || taken)
		return code;
	return ask_for_grid(l, choices, found, spoken);
}

/* Says so where the rows are in other zones than the CRS that the user names. */
static enum eco_code doubt_stated(struct eco_place_look *l)
{
	struct eco_place_look own = *l;
	struct eco_zones zones;
	struct eco_crs_facts named, other;
	char crs[32], *why = l->guess->crs_why;
	own.error = NULL;
	enum eco_code code = eco_crs_look(l->asked->crs, l->at, &named, l->error);
	if (!code)
		code = eco_zones_find(l->asked->table, l->asked->source, may_be_utm(l), &zones, l->error);
	if (code || named.geographic || zones.column == ECO_NONE)
		return code;
	bool elsewhere = zone_crs(&own, &zones, crs) == ECO_OK && eco_crs_look(crs, l->at, &other, NULL) == ECO_OK
		&& hypot(named.degrees[0] - other.degrees[0], named.degrees[1] - other.degrees[1]) > NEAR_DEG;
	size_t used = strlen(why);
	const char *name = l->asked->table->columns[zones.column];
	if (zones.other[0] != 0)
		snprintf(why + used, ECO_WHY_BYTES - used, "; but \"%.30s\" is \"%s\" and \"%s\": give the entry "
			"\"only\": {\"%.30s\": ...}, and each other zone an entry with its own \"crs\"", name,
			zones.first, zones.other, name);
	else if (elsewhere)
		snprintf(why + used, ECO_WHY_BYTES - used, "; but \"%.30s\" says \"%s\", %s, a place at %.3f, "
			"%.3f", name, zones.first, crs, other.degrees[0], other.degrees[1]);
	return ECO_OK;
}

static enum eco_code guess_crs(struct eco_place_look *l)
{
	const struct eco_place_asked *a = l->asked;
	struct eco_place_guess *g = l->guess;
	if (l->nowhere && a->crs)
		return eco_fail(l->error, ECO_BAD_INPUT, "--crs %.40s: %.150s has no coordinates, only an "
			"azimuth and a distance from a plot's centre; add columns with the centre's", a->crs,
			a->table->path);
	if (l->nowhere) {
		snprintf(g->crs_why, sizeof g->crs_why, "metres from the plot's centre");
		return ECO_OK;
	}
	if (a->crs) {
		enum eco_code code = take_stated(l, a->crs, "you say");
		return code ? code : doubt_stated(l);
	}
	if (g->from_geometry && a->table->crs && !a->table->degrees_doubted) {
		g->file_says = true;
		return take_stated(l, a->table->crs, "the file says");
	}
	bool narrow =
		l->xy[0].high - l->xy[0].low < DEGREES_SPAN && l->xy[1].high - l->xy[1].low < DEGREES_SPAN;
	bool can_be = are_degrees(l, 0) || are_degrees(l, 1);
	if (can_be && ((narrow && !are_whole(l) && !l->unit && !g->offsets.quadrat_m)
			|| a->columns->names_say_degrees)) {
		return guess_degrees(l);
	}
	double most = fmax(fmax(fabs(l->xy[0].low), fabs(l->xy[0].high)),
		fmax(fabs(l->xy[1].low), fabs(l->xy[1].high)));
	if (most * (l->unit_m < FOOT_M ? l->unit_m : 1) >= PLOT_M)
		return guess_grid(l);
	g->unit = l->unit;
	snprintf(g->crs_why, sizeof g->crs_why, "%s of a %s: from %.6g, %.6g to %.6g, %.6g",
		l->unit_m == 1 ? "metres" : l->unit, g->offsets.quadrat_m > 0 ? "quadrat" : "plot",
		l->xy[0].low, l->xy[1].low, l->xy[0].high, l->xy[1].high);
	return ECO_OK;
}

enum eco_code eco_place_guess(struct eco_place_guess *guess, const struct eco_place_asked *asked,
	struct eco_error *error)
{
	const struct eco_columns *columns = asked->columns;
	struct eco_place_look l = { .asked = asked, .guess = guess, .error = error, .unit_m = 1,
		.speech = eco_speech_of((const char *const *)asked->table->columns,
			asked->table->column_count) };
	*guess = (struct eco_place_guess){ .from_geometry = columns->of[ECO_ROLE_X] == ECO_NONE
		&& asked->table->has_geometry, .degrees = { NAN, NAN } };
	enum eco_code code = eco_offsets_find(&guess->offsets, asked->table, columns, asked->axes_said,
		error);
	if (code)
		return code;
	l.nowhere = guess->offsets.polar && !guess->from_geometry && columns->of[ECO_ROLE_X] == ECO_NONE;
	for (int k = 0; k < 2 && !guess->from_geometry && !l.nowhere; k++) {
		if (columns->of[k] == ECO_NONE)
			return eco_place_ask(asked->table, error);
		l.names[k] = asked->table->columns[columns->of[k]];
	}
	if (l.names[0])
		l.unit = eco_unit_of_place(l.names[0], l.names[1], &l.unit_m);
	if (!l.nowhere)
		code = measure(&l);
	if (!code)
		code = guess_crs(&l);
	if (!code)
		code = settle_axes(&l);
	return code ? code : eco_place_scene(&l);
}
