/* Numbers show by their size whether they are degrees, metres of a plot, or eastings and northings of a grid.
 * They do not show which grid, as zones look alike: the columns' names decide, or the terrain, or else the
 * user. */
#include "ecofiles/import/places/place_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/words.h"

#define PLOT_M 100000.0          /* beyond this from 0 numbers are a grid's, not a plot's */
#define FOOT_M 0.3               /* no grid is in smaller units */
#define DEGREES_SPAN 5.0         /* an inventory is not wider */
#define UTM_LEAST_M 100000.0
#define UTM_MOST_M 900000.0
#define BARE_SOUTH -56.0         /* no tree stands beyond these latitudes */
#define BARE_NORTH 75.0
#define NEAR_DEG 0.01            /* places that differ by datum alone lie nearer together */
#define STAND_PER_HA 150.0         /* plants; towns and parks have 5 to 100 */
#define STAND_LEAST 50u              /* fewer plants are a group */
#define ONLY_SO_TERRAIN "only so does the terrain lie there"

void eco_place_why(char why[ECO_WHY_BYTES], const char *format, ...)
{
	size_t used = strlen(why);
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(why + used, ECO_WHY_BYTES - used, format, arguments);
	va_end(arguments);
}

enum eco_code eco_place_fail(const struct eco_place_look *l, const char *format, ...)
{
	char text[900];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	return eco_fail(l->error, ECO_BAD_INPUT, "%.150s: %s", l->asked->table->path, text);
}

/* ---- The numbers ---- */

static void numbers_of(struct eco_place_look *l, int k, struct eco_spread *spread)
{
	const struct eco_table *t = l->asked->table;
	if (!l->guess->from_geometry)
		eco_table_coordinates(t, l->asked->columns->of[k], l->asked->columns, spread);
	for (uint32_t row = 0; l->guess->from_geometry && row < t->row_count; row++)
		if (!isnan(t->places[row][k]))
			eco_spread_add(spread, t->places[row][k]);
}

/* The middle of those that are not 0, which stands for no place. */
static enum eco_code measure(struct eco_place_look *l)
{
	for (int k = 0; k < 2; k++) {
		struct eco_spread spread = { 0 };
		numbers_of(l, k, &spread);
		l->xy[k] = (struct place_range){ eco_spread_quantile(&spread, 0.02),
			eco_spread_quantile(&spread, 0.5), eco_spread_quantile(&spread, 0.98) };
		eco_spread_free(&spread);
		if (isnan(l->xy[k].middle))
			return l->names[k] ? eco_place_fail(l, "no row has a place: no number in \"%.60s\"",
				l->names[k])
				: eco_place_fail(l,
				"no row is a point; a table of plants has a point for each (lines and "
				"areas are for \"scatter\" in a scene; coordinates in quotes are none)");
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
		return eco_place_fail(l, "x and y of its points are swapped, as %.7g, %.7g: %s. x is "
			"easting or longitude, y is northing or latitude: export it again, or with x and y "
			"as columns",
			l->xy[0].middle, l->xy[1].middle, why);
	l->guess->swapped = true;
	l->guess->crs_why[0] = 0;
	eco_place_why(l->guess->crs_why, "%s\"%.40s\" and \"%.40s\" are swapped: %s",
		are_degrees(l, 0) || are_degrees(l, 1) ? "degrees; " : "", l->names[0] ? l->names[0] : "x",
		l->names[1] ? l->names[1] : "y", why);
	return ECO_OK;
}

static bool is_bare(const double degrees[2])
{
	return degrees[1] < BARE_SOUTH || degrees[1] > BARE_NORTH;
}

/* Whether degrees are outside the area of use of a CRS, and inside once swapped; *facts are the CRS's. */
static bool area_speaks_for_swapping(const struct eco_place_look *l, const char *crs,
	struct eco_crs_facts *facts)
{
	return crs && eco_crs_look(crs, l->as_named, facts, NULL) == ECO_OK && !isnan(facts->area[0]) &&
		!eco_crs_area_has(facts->area, l->as_named) && eco_crs_area_has(facts->area, l->turned);
}

/* Says why degrees in a CRS are what they should be only if longitude and latitude change places; "": they
 * are not known to be. */
static void look_for_swapping(const struct eco_place_look *l, const char *crs, char why[ECO_WHY_BYTES])
{
	struct eco_crs_facts facts;
	char area[80];
	if (!are_degrees(l, 1))
		return;
	if (!are_degrees(l, 0))
		eco_place_why(why, "a latitude lies between -90 and 90");
	else if (eco_place_dem_has(l, l->as_named))
		return;
	else if (eco_place_dem_has(l, l->turned))
		eco_place_why(why, ONLY_SO_TERRAIN);
	else if (is_bare(l->as_named) && !is_bare(l->turned))
		eco_place_why(why, "no tree stands at latitude %.1f", l->as_named[1]);
	else if (area_speaks_for_swapping(l, crs, &facts) || area_speaks_for_swapping(l, l->asked->scene_crs,
		&facts))
		eco_place_why(why, "with this choice alone they lie in the area of use of %.60s, "
			"%s", facts.name,
			eco_crs_area_text(facts.area, area));
}

static enum eco_code guess_degrees(struct eco_place_look *l)
{
	char why[ECO_WHY_BYTES] = "";
	snprintf(l->guess->crs, sizeof l->guess->crs, "EPSG:4326");
	look_for_swapping(l, NULL, why);
	if (why[0] != 0)
		return say_swapped(l, why);
	eco_place_why(l->guess->crs_why, "degrees, by %s: around %.4f, %.4f",
		l->asked->columns->names_say_degrees ? "the columns' names and numbers" : "the numbers",
		l->as_named[0], l->as_named[1]);
	return ECO_OK;
}

/* ---- A grid ---- */

static uint32_t listed(uint32_t found) { return found < ECO_CRS_CHOICES_MAX ? found : ECO_CRS_CHOICES_MAX; }

/* Lists the grids that fit, without UTM's if `others`, and says how many more there are. */
static bool list_choices(const struct eco_crs_choice *choices, uint32_t found, bool others, char *text,
	size_t size)
{
	char choice[200];
	bool any = false;
	for (uint32_t i = 0; i < found; i++) {
		bool kept = i < ECO_CRS_CHOICES_MAX;
		if (others && (!kept || strstr(choices[i].name, "UTM")))
			continue;
		snprintf(choice, sizeof choice, kept ? "%s (%s; at %.2f, %.2f)" : "", choices[i].code,
			choices[i].name,
			choices[i].degrees[0], choices[i].degrees[1]);
		eco_phrase_add(text, size, choice);
		any = true;
	}
	return any;
}

static bool may_be_utm(const struct eco_place_look *l)
{
	return l->xy[0].middle > UTM_LEAST_M && l->xy[0].middle < UTM_MOST_M && l->xy[1].middle > 0
		&& l->xy[1].middle < 1e7;
}

/* Words of the table's columns that tables of the country of a CRS have, too. */
static unsigned words_of(const struct eco_place_look *l, const struct eco_crs_choice *choice)
{
	const struct eco_table *table = l->asked->table;
	const char *words = eco_crs_words(choice->code);
	unsigned count = 0;
	for (uint32_t i = 0; i < table->column_count; i++)
		count += eco_words_any(table->columns[i], words);
	return count;
}

/* Puts the grids of countries whose words the columns have first. */
static void sort_choices(const struct eco_place_look *l, struct eco_crs_choice *choices, uint32_t count)
{
	for (uint32_t i = 1; i < count; i++)
		for (uint32_t k = i; k > 0 && words_of(l, &choices[k]) > words_of(l, &choices[k - 1]); k--) {
			struct eco_crs_choice other = choices[k];
			choices[k] = choices[k - 1];
			choices[k - 1] = other;
		}
}

/* Names the few grids that have the place; else all UTM zones may be meant. */
static enum eco_code ask_for_grid(struct eco_place_look *l, struct eco_crs_choice *choices, uint32_t found)
{
	sort_choices(l, choices, listed(found));
	char list[400] = "";
	struct eco_crs_facts facts;
	if (may_be_utm(l) && eco_crs_look("EPSG:32631", l->at, &facts, l->error) == ECO_OK) {
		bool any = list_choices(choices, found, true, list, sizeof list);
		return eco_place_fail(l, "which CRS are its coordinates in? %.0f, "
			"%.0f is a place in each UTM zone, at latitude %.1f: give the zone of your "
			"longitude, --crs EPSG:32601 (180 W) to EPSG:32660 (180 E), in the south "
			"EPSG:32701 to EPSG:32760; or the country's grid, %s", l->at[0], l->at[1],
			facts.degrees[1],
			any ? list : "such as EPSG:2154 in France");
	}
	list_choices(choices, found, false, list, sizeof list);
	return eco_place_fail(l,
		"which CRS are its coordinates in? %.0f, %.0f %s%s; give it with --crs EPSG:...",
		l->at[0], l->at[1],
		found > 0 ? "may be in " : "is in no CRS of PROJ's register as easting and northing", list);
}

static enum eco_code take_choice(struct eco_place_look *l, const struct eco_crs_choice *choice,
	const char *why)
{
	snprintf(l->guess->crs, sizeof l->guess->crs, "%s", choice->code);
	eco_place_why(l->guess->crs_why, "%.80s, %s; a place at %.3f, %.3f", choice->name, why,
		choice->degrees[0], choice->degrees[1]);
	return ECO_OK;
}

/* The only grid with the words of a hint that has the plants if x and y change places. */
static enum eco_code take_turned(struct eco_place_look *l, const char *hint, bool *taken)
{
	struct eco_crs_choice choices[ECO_CRS_CHOICES_MAX];
	uint32_t found = 0;
	enum eco_code code = l->guess->from_geometry ? ECO_OK
		: eco_crs_choices(l->turned, hint, choices, &found, l->error);
	*taken = !code && found == 1;
	l->guess->swapped |= *taken;
	return *taken ? take_choice(l, &choices[0], "by the columns' names; x counts to the north") : code;
}

/* Surveyors' grids call the northing x, most tables the easting: plants may stand at either place. */
static enum eco_code settle_axes(struct eco_place_look *l)
{
	const struct eco_place_guess *g = l->guess;
	struct eco_crs_facts named, turned;
	if (g->from_geometry || g->swapped || l->asked->axes_said || g->crs[0] == 0
		|| !eco_words_any(l->names[0], "x")
			|| !eco_words_any(l->names[1], "y") || eco_crs_look(g->crs, l->at, &named,
			NULL) != ECO_OK
			|| !named.x_is_north || !named.inside || eco_crs_look(g->crs, l->turned, &turned,
			NULL) != ECO_OK
			|| !turned.inside || eco_place_dem_has(l, named.degrees))
		return ECO_OK;
	if (eco_place_dem_has(l, turned.degrees))
		return say_swapped(l, ONLY_SO_TERRAIN);
	return eco_place_fail(l, "does \"%.40s\" count to the north, as x does in %s "
		"(%.40s), or to the east, as in most tables? To the east the plants are at %.3f, %.3f: "
		"--x \"%.40s\" --y \"%.40s\"; to the north at %.3f, %.3f: --x \"%.40s\" --y \"%.40s\"",
		l->names[0], l->guess->crs, named.name, named.degrees[0], named.degrees[1], l->names[0],
		l->names[1],
		turned.degrees[0], turned.degrees[1], l->names[1], l->names[0]);
}

/* The terrain's CRS, where its extent has the plants. */
static bool take_dem(struct eco_place_look *l)
{
	const struct eco_raster_extent *dem = l->asked->dem;
	struct eco_crs_facts facts;
	if (!dem || dem->crs[0] == 0 || eco_crs_look(dem->crs, l->at, &facts, NULL) != ECO_OK
		|| facts.geographic
			|| facts.code[0] == 0 || !eco_raster_extent_has(dem, l->at))
		return false;
	snprintf(l->guess->crs, sizeof l->guess->crs, "%s", facts.code);
	eco_place_why(l->guess->crs_why, "%.80s, the terrain's: the plants lie on it",
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
		eco_place_why(l->guess->crs_why, "metres of the terrain's grid, which says "
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

/* Whether the terrain lies at a place of a CRS. */
static bool dem_has_in(const struct eco_place_look *l, const char *crs, const double at[2])
{
	struct eco_crs_facts facts;
	return eco_crs_look(crs, at, &facts, NULL) == ECO_OK && eco_place_dem_has(l, facts.degrees);
}

static enum eco_code take_stated(struct eco_place_look *l, const char *crs, const char *who)
{
	struct eco_crs_facts facts;
	char why[ECO_WHY_BYTES] = "", area[80];
	enum eco_code code = eco_crs_look(crs, l->at, &facts, l->error);
	if (code)
		return code;
	snprintf(l->guess->crs, sizeof l->guess->crs, "%s", strlen(crs) < sizeof l->guess->crs ? crs
		: facts.code);
	eco_place_why(l->guess->crs_why, "%.80s, as %s", facts.name, who);
	if (!isnan(facts.degrees[0]))
		eco_place_why(l->guess->crs_why, "; a place at %.3f, %.3f", facts.degrees[0],
			facts.degrees[1]);
	enum eco_crs_fit fit;
	struct eco_crs_span span = { .any = true, .has_decimals = !are_whole(l) };
	for (int k = 0; k < 2; k++) {
		span.first[k] = l->at[k];
		span.low[k] = l->xy[k].low;
		span.high[k] = l->xy[k].high;
	}
	ECO_PASS(eco_crs_refuse_degrees(&span, crs, is_heap_of_degrees(l), l->asked->table->path, &fit, area,
		l->error));
	if (facts.geographic)
		look_for_swapping(l, crs, why);
	else if (fit == ECO_CRS_SWAPPED)
		eco_place_why(why, "with this choice alone they lie in the CRS's area of use, %s", area);
	else if (!eco_place_dem_has(l, facts.degrees) && dem_has_in(l, crs, l->turned))
		eco_place_why(why, ONLY_SO_TERRAIN);
	if (why[0] != 0)
		return say_swapped(l, why);
	if (fit == ECO_CRS_OUTSIDE)
		eco_place_why(l->guess->crs_why, "; but its area of use is %s", area);
	return ECO_OK;
}

/* A letter S is the south, or the band from 32 to 40 degrees north: then the terrain tells the half, or the
 * user. */
static enum eco_code zone_crs(struct eco_place_look *l, const struct eco_zones *z, char crs[32])
{
	enum eco_zone_half half = z->zone.half;
	char south[32];
	snprintf(crs, 32, "EPSG:%u", z->zone.epsg ? z->zone.epsg : 32600 + z->zone.number);
	snprintf(south, sizeof south, "EPSG:%u", 32700 + z->zone.number);
	if (z->zone.epsg || half == ECO_HALF_NORTH || (half == ECO_HALF_OPEN && dem_has_in(l, crs, l->at)))
		return ECO_OK;
	if (half == ECO_HALF_OPEN && !dem_has_in(l, south, l->at))
		return eco_place_fail(l,
			"\"%.40s\" says \"%s\": is that zone %u in the north, --crs %s, or in the "
			"south, --crs %s?", l->asked->table->columns[z->column], z->first, z->zone.number,
			crs, south);
	memcpy(crs, south, sizeof south);
	return ECO_OK;
}

/* The zone of a column, if all rows have one. */
static enum eco_code take_zone(struct eco_place_look *l, bool *taken)
{
	struct eco_zones zones;
	char crs[32], who[100];
	ECO_PASS(eco_zones_find(l->asked->table, l->asked->source,
		l->names[0] && eco_words_any(l->names[0], "utm"), &zones, l->error));
	*taken = zones.column != ECO_NONE && (zones.zone.epsg || may_be_utm(l));
	if (!*taken)
		return ECO_OK;
	const char *name = l->asked->table->columns[zones.column];
	enum eco_code code = zone_crs(l, &zones, crs);
	if (!code && zones.other[0] != 0)
		return eco_place_fail(l, "its rows are in several zones: \"%.40s\" "
			"is \"%s\" and \"%s\", and an entry has one CRS. Put each zone into a table of its own; or "
			"start with --crs %s and give scene.json an entry for each zone, with \"only\": "
			"{\"%.40s\": \"%s\"} and its own \"crs\"", name, zones.first, zones.other, crs, name,
			zones.first);
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
	struct eco_crs_choice choices[ECO_CRS_CHOICES_MAX];
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
	if (take_over_dem(l, choices, listed(found)) || take_bare_dem(l))
		return ECO_OK;
	if (found == 1)
		return take_choice(l, &choices[0], "the only one with this place in its area of use");
	return ask_for_grid(l, choices, found);
}

/* Says so where the rows are in other zones than the CRS that the user names. */
static enum eco_code doubt_stated(struct eco_place_look *l)
{
	struct eco_place_look own = *l;
	struct eco_zones zones;
	struct eco_crs_facts named, other;
	char crs[32];
	own.error = NULL;
	enum eco_code code = eco_crs_look(l->asked->crs, l->at, &named, l->error);
	if (!code)
		code = eco_zones_find(l->asked->table, l->asked->source, may_be_utm(l), &zones, l->error);
	if (code || named.geographic || zones.column == ECO_NONE)
		return code;
	bool elsewhere = zone_crs(&own, &zones, crs) == ECO_OK && eco_crs_look(crs, l->at, &other,
		NULL) == ECO_OK
		&& hypot(named.degrees[0] - other.degrees[0], named.degrees[1] - other.degrees[1]) > NEAR_DEG;
	const char *name = l->asked->table->columns[zones.column];
	if (zones.other[0] != 0)
		eco_place_why(l->guess->crs_why, "; but \"%.30s\" is \"%s\" and \"%s\": give the entry "
			"\"only\": {\"%.30s\": ...}, and each other zone an entry with its own \"crs\"", name,
			zones.first, zones.other, name);
	else if (elsewhere)
		eco_place_why(l->guess->crs_why, "; but \"%.30s\" says \"%s\", %s, a place at %.3f, "
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
		eco_place_why(g->crs_why, "metres from the plot's centre");
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
	eco_place_why(g->crs_why, "%s of a %s: from %.6g, %.6g to %.6g, %.6g",
		l->unit_m == 1 ? "metres" : l->unit, g->offsets.quadrat_m > 0 ? "quadrat" : "plot",
		l->xy[0].low, l->xy[1].low, l->xy[0].high, l->xy[1].high);
	return ECO_OK;
}

/* Woods have more plants in an area than parks. A row of trees is as wide as a quarter of its length.
 * Surveyors' plots and quadrats are in woods. */
static void guess_stand(const struct eco_place_look *l)
{
	struct eco_place_guess *g = l->guess;
	const char *crs = g->crs[0] ? g->crs : g->file_says ? l->asked->table->crs : NULL;
	const double low[2] = { l->xy[g->swapped].low, l->xy[!g->swapped].low };
	const double high[2] = { l->xy[g->swapped].high, l->xy[!g->swapped].high };
	struct eco_crs_facts a, b;
	double side[2] = { l->unit_m * (high[0] - low[0]), l->unit_m * (high[1] - low[1]) };
	g->stand = g->offsets.polar || g->offsets.quadrat_m > 0;
	if (g->stand)
		return;
	if (crs && eco_crs_look(crs, low, &a, NULL) == ECO_OK && eco_crs_look(crs, high, &b, NULL) == ECO_OK) {
		side[0] = eco_degree_m(a.degrees[1]) * fabs(b.degrees[0] - a.degrees[0]);
		side[1] = ECO_DEGREE_M * fabs(b.degrees[1] - a.degrees[1]);
	}
	double length = fmax(side[0], side[1]), width = fmax(fmin(side[0], side[1]), length / 4);
	g->per_ha = length > 0 ? 1e4 * (double)l->asked->table->rows / (length * width) : 0;
	g->stand = g->per_ha > STAND_PER_HA && l->asked->table->rows >= STAND_LEAST;
}

enum eco_code eco_place_guess(struct eco_place_guess *guess, const struct eco_place_asked *asked,
	struct eco_error *error)
{
	const struct eco_columns *columns = asked->columns;
	struct eco_place_look l = { .asked = asked, .guess = guess, .error = error, .unit_m = 1 };
	*guess = (struct eco_place_guess){ .from_geometry = columns->of[ECO_ROLE_X] == ECO_NONE
		&& asked->table->has_geometry, .degrees = { NAN, NAN } };
	enum eco_code code = eco_offsets_find(&guess->offsets, asked->table, columns, asked->axes_said,
		error);
	if (code)
		return code;
	l.nowhere = guess->offsets.polar && !guess->from_geometry && columns->of[ECO_ROLE_X] == ECO_NONE;
	for (int k = 0; k < 2 && !guess->from_geometry && !l.nowhere; k++) {
		if (columns->of[k] == ECO_NONE)
			return eco_place_ask(&l);
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
	if (!code)
		guess_stand(&l);
	return code ? code : eco_place_scene(&l);
}
