/* The columns of a table that tell places: words of a CRS, a zone for each row, offsets from another
 * place. */
#include "ecofiles/import/places/place_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/crs_names.table"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/table_columns.h"
#include "ecofiles/import/places/words.h"
#include "ecofiles/import/places/crs.h"

/* Words of a column's name that a CRS's name may have, too: without the axis and the unit. A letter behind a
 * number is a zone's half, "32 n". */
static void hint_of(const char *name, char *hint, size_t size)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	bool after_number = false;
	size_t used = 0;
	eco_words_of(name, words, sizeof words);
	hint[0] = 0;
	for (const char *at = words; eco_words_next(&at, word);) {
		bool half = after_number && (strcmp(word, "n") == 0 || strcmp(word, "s") == 0);
		after_number = word[0] >= '0' && word[0] <= '9';
		if ((half || !eco_words_have(eco_words_set("axis"), word)) && used + strlen(word) + 2 < size)
			used += (size_t)snprintf(hint + used, size - used, "%s%s", used > 0 ? " " : "", word);
	}
}

bool eco_place_hint(const char *const names[2], char hint[ECO_WORDS_BYTES])
{
	char other[ECO_WORDS_BYTES];
	if (!names[0] || !names[1])
		return false;
	hint_of(names[0], hint, ECO_WORDS_BYTES);
	hint_of(names[1], other, sizeof other);
	if (strcmp(hint, other) != 0 || hint[0] == 0)
		return false;
	for (size_t i = 0; i < sizeof crs_names_rows / sizeof *crs_names_rows; i++)
		if (strcmp(hint, crs_names_rows[i].brief) == 0)
			snprintf(hint, ECO_WORDS_BYTES, "%s", crs_names_rows[i].name);
	return true;
}

/* ---- A column of zones ---- */

enum kind { NO_ZONES, ZONES, UTM_ZONES, CODES };

static enum kind kind_of(const char *name)
{
	static const char *const sets[] = { "utm", "zone", "crs", "number" };
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	bool other = false, utm = eco_words_any(name, eco_words_set("utm")),
		zone = eco_words_any(name, eco_words_set("zone")), code = eco_words_any(name,
		eco_words_set("crs"));
	eco_words_of(name, words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word);) {
		size_t set = 0;
		while (set < 4 && !eco_words_have(eco_words_set(sets[set]), word))
			set++;
		other |= set == 4;
	}
	if (other || (!zone && !code))
		return NO_ZONES;
	return code ? CODES : utm ? UTM_ZONES : ZONES;
}

/* A letter behind the number is a half, or a band of 8 degrees from C at 80 south to X; "s" may be either. */
static bool read_half(const char *text, enum eco_zone_half *half)
{
	text += strspn(text, " ");
	bool letter = *text && text[1] == 0;
	*half = strcmp(text, "south") == 0 || (letter && strchr("cdefghjklm", *text)) ? ECO_HALF_SOUTH
		: strcmp(text, "north") == 0 || (letter && strchr("npqrtuvwx", *text)) ? ECO_HALF_NORTH
		: ECO_HALF_OPEN;
	return *half || *text == 0 || strcmp(text, "s") == 0;
}

static bool read_zone(const char *text, enum kind kind, struct eco_zone *zone)
{
	char folded[24], *end;
	const char *at = folded;
	*zone = (struct eco_zone){ .number = 0 };
	if (eco_text_fold(text, folded, sizeof folded) + 1 >= sizeof folded)
		return false;
	bool code = strncmp(at, "epsg:", 5) == 0;
	at += code ? 5 : 0;
	for (size_t i = 0; i < 2; i++)
		if (strncmp(at, i ? "zone" : "utm", i ? 4 : 3) == 0)
			at += i ? 4 : 3, at += strspn(at, " ");
	if (strspn(at, "0123456789") == 0 || strlen(at) > 9)
		return false;
	uint32_t number = (uint32_t)strtoul(at, &end, 10);
	if ((code || kind == CODES) && *end == 0)
		zone->epsg = number;
	else
		zone->number = number;
	return zone->epsg > 1000 || (zone->number >= 1 && zone->number <= 60 && read_half(end, &zone->half));
}

static bool are_same(const struct eco_zone *a, const struct eco_zone *b)
{
	return a->epsg == b->epsg && a->number == b->number && a->half == b->half;
}

/* Whether each filled text of a column is a zone. */
static bool are_zones(const struct eco_table_values *values, enum kind kind, bool utm,
	struct eco_zones *zones)
{
	bool any = false;
	for (uint32_t i = 0; i < values->count; i++) {
		const char *text = values->items[i].text;
		struct eco_zone zone;
		if (eco_text_is_missing(text))
			continue;
		if (!read_zone(text, kind, &zone) || (kind == ZONES && !utm && !zone.epsg && !zone.half))
			return false;
		if (!any)
			zones->zone = zone;
		if (!any || (zones->other[0] == 0 && !are_same(&zone, &zones->zone)))
			snprintf(any ? zones->other : zones->first, sizeof zones->first, "%.23s", text);
		any = true;
	}
	return any;
}

enum eco_code eco_zones_find(const struct eco_table *table, const struct eco_rows_source *source, bool utm,
	struct eco_zones *zones, struct eco_error *error)
{
	bool found = false;
	for (uint32_t i = 0; i < table->column_count && !found; i++) {
		enum kind kind = kind_of(table->columns[i]);
		struct eco_table_values values = { .items = NULL };
		ECO_PASS(kind == NO_ZONES ? ECO_OK
			: eco_table_values_read(&values, source, (const char *const *)&table->columns[i], 1, error));
		*zones = (struct eco_zones){ .column = i };
		found = are_zones(&values, kind, utm, zones);
		eco_table_values_free(&values);
	}
	if (!found)
		*zones = (struct eco_zones){ .column = ECO_NONE };
	return ECO_OK;
}

#define PLANTS_LEAST 2u          /* of a plot, in the mean */
#define HEAP_LEAST 8u            /* rows of a place, in the mean: more than stems of a tree or an address */
#define HEAP_ROWS 64u            /* of fewer rows nothing is said */

static const char *field(const struct eco_table *t, uint32_t row, uint32_t column)
{
	return eco_table_field(t, row, column);
}

static double quantile_of(const struct eco_table *t, uint32_t column, const struct eco_columns *columns,
	double share)
{
	struct eco_spread spread = { 0 };
	eco_table_coordinates(t, column, columns, &spread);
	double value = eco_spread_quantile(&spread, share);
	eco_spread_free(&spread);
	return value;
}

/* ---- From centres ---- */

static bool same_place(const struct eco_table *t, const struct eco_columns *c, uint32_t a, uint32_t b)
{
	const uint32_t x = c->of[ECO_ROLE_X], y = c->of[ECO_ROLE_Y];
	if (x == ECO_NONE || y == ECO_NONE)
		return memcmp(t->places[a], t->places[b], sizeof *t->places) == 0;
	return strcmp(field(t, a, x), field(t, b, x)) == 0 && strcmp(field(t, a, y), field(t, b, y)) == 0;
}

/* Whether so many rows, in the mean, share each place. */
static bool are_shared(const struct eco_table *t, const struct eco_columns *c, uint32_t least)
{
	uint32_t different = 0;
	for (uint32_t row = 0; row < t->row_count; row++) {
		uint32_t other = 0;
		while (other < row && !same_place(t, c, row, other))
			other++;
		different += other == row;
	}
	return different * least <= t->row_count;
}

/* Two rows of different plots, in *other the second's. */
static bool are_several(const struct eco_table *t, uint32_t plot, uint32_t *other)
{
	for (uint32_t row = 1; plot != ECO_NONE && row < t->row_count; row++)
		if (strcmp(field(t, 0, plot), field(t, row, plot)) != 0) {
			*other = row;
			return true;
		}
	return false;
}

static enum eco_code find_polar(struct eco_offsets *o, const struct eco_table *t, const struct eco_columns *c,
	struct eco_error *error)
{
	const uint32_t azimuth = c->of[ECO_ROLE_AZIMUTH], distance = c->of[ECO_ROLE_DISTANCE],
		plot = c->of[ECO_ROLE_PLOT];
	bool placed = c->of[ECO_ROLE_X] != ECO_NONE || t->has_geometry;
	uint32_t other = 0;
	if (azimuth == ECO_NONE || distance == ECO_NONE || (placed && !are_shared(t, c, PLANTS_LEAST)))
		return ECO_OK;
	if (!placed && are_several(t, plot, &other))
		return eco_fail(error, ECO_BAD_INPUT, "%.150s: its plants stand at \"%.40s\" and \"%.40s\" "
			"from the centres of several plots (\"%.40s\" is \"%.20s\" and \"%.20s\"), and no "
			"column says where these are: add columns with easting and northing, or longitude and "
			"latitude, of its plot's centre to each row (--x, --y), or start with one plot",
			t->path,
			t->columns[azimuth], t->columns[distance], t->columns[plot], field(t, 0, plot),
			field(t, other, plot));
	const char *unit = eco_unit_of_name(t->columns[distance]);
	o->polar = true;
	o->whole_turn = eco_words_any(t->columns[azimuth], eco_words_set("gon")) || quantile_of(t, azimuth, c,
		1) > 360 ? 400 : 360;
	o->distance_unit = unit ? unit : "m";
	return ECO_OK;
}

/* ---- Within quadrats ---- */

#define MOST 0.98                /* of the plants: some stand just outside */

static bool are_quadrats(const struct eco_table *t, uint32_t column)
{
	uint32_t good = 0, filled = 0;
	for (uint32_t row = 0; column != ECO_NONE && row < t->row_count; row++) {
		const char *text = field(t, row, column);
		size_t digits = strspn(text, "0123456789");
		filled += !eco_text_is_missing(text);
		good += digits >= 1 && digits <= 4 && text[digits] == 0;
	}
	return filled > 0 && good == filled;
}

/* The usual side that the plants fill; 0: none. */
static double side_of(double middle, double high)
{
	static const double sides[] = { 5, 10, 20, 25, 50, 100 };
	for (size_t i = 0; i < sizeof sides / sizeof *sides; i++)
		if (high <= sides[i])
			return high > 0.8 * sides[i] && middle > 0.3 * sides[i] && middle < 0.7 * sides[i]
				? sides[i] : 0;
	return 0;
}

static enum eco_code find_quadrats(struct eco_offsets *o, const struct eco_table *t,
	const struct eco_columns *c, struct eco_error *error)
{
	const uint32_t quadrat = c->of[ECO_ROLE_QUADRAT], x = c->of[ECO_ROLE_X], y = c->of[ECO_ROLE_Y];
	if (!eco_columns_are_local(t, c))
		return ECO_OK;
	double high = fmax(quantile_of(t, x, c, MOST), quantile_of(t, y, c, MOST));
	o->quadrat_m = side_of(quantile_of(t, x, c, 0.5), high);
	if (o->quadrat_m > 0 && are_quadrats(t, quadrat))
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT, "%.150s: \"%.40s\" and \"%.40s\" count from the corner of a "
		"quadrat, and %s%.40s%s: add columns with x and y of the plot, such as 20 m times the "
		"quadrat's column and row plus these, and give them with --x and --y", t->path, t->columns[x],
		t->columns[y],
		quadrat == ECO_NONE ? "no column says which" : o->quadrat_m > 0 ? "\"" : "how wide one of \"",
		quadrat == ECO_NONE ? "" : t->columns[quadrat],
		quadrat == ECO_NONE ? "" : o->quadrat_m > 0 ? "\" is not always four digits, two of the "
		"column and two of the row" : "\" is does not show");
}

static enum eco_code refuse_heaps(const struct eco_table *t, const struct eco_columns *c,
	struct eco_error *error)
{
	const uint32_t x = c->of[ECO_ROLE_X], y = c->of[ECO_ROLE_Y];
	if (x == ECO_NONE || y == ECO_NONE || t->row_count < HEAP_ROWS || !are_shared(t, c, HEAP_LEAST))
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT,
		"%.150s: \"%.40s\" and \"%.40s\" are places of plots, or numbers "
		"of quadrats, not of plants: %u rows or more share each. Give columns with the plants' own places "
		"with --x and --y; or these two, to heap all plants of a place on it", t->path, t->columns[x],
		t->columns[y], HEAP_LEAST);
}

enum eco_code eco_offsets_find(struct eco_offsets *offsets, const struct eco_table *table,
	const struct eco_columns *columns, bool said, struct eco_error *error)
{
	*offsets = (struct eco_offsets){ .quadrat_m = 0 };
	ECO_PASS(find_quadrats(offsets, table, columns, error));
	ECO_PASS(find_polar(offsets, table, columns, error));
	return !offsets->polar && offsets->quadrat_m == 0 && !said ? refuse_heaps(table, columns, error) : ECO_OK;
}

/* ---- Columns of x and y that no name tells ---- */

/* Whether a name of a column is a number: then the first line is a plant's. */
static bool lacks_header(const struct eco_table *table)
{
	double number;
	for (uint32_t i = 0; i < table->column_count; i++)
		if (eco_text_number(table->columns[i], '.', &number) || eco_text_number(table->columns[i],
			',', &number))
			return true;
	return false;
}

enum eco_code eco_place_ask(const struct eco_place_look *l)
{
	const struct eco_table *table = l->asked->table;
	char there[250] = "";
	for (uint32_t i = 0; i < table->column_count; i++)
		eco_phrase_add(there, sizeof there, table->columns[i]);
	return eco_place_fail(l, "which columns say where a plant stands? Give --x (easting or "
		"longitude) and --y (northing or latitude); there are: %s%s", there, lacks_header(table)
		? "; if that is the first plant, put a line of names before it, such as species,longitude,latitude" : "");
}

/* ---- The scene ---- */

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
	ECO_PASS(eco_crs_look(crs, at, facts, error));
	return !facts->metric_map ? eco_fail(error, ECO_BAD_INPUT, "--scene-crs %.60s: a scene is in a projected CRS in "
		"metres, such as a UTM zone", crs) : ECO_OK;
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
		eco_place_why(g->scene_why, "none: plain metres");
		return ECO_OK;
	}
	enum eco_code code = eco_crs_look(crs, at, &own, l->error);
	memcpy(g->degrees, own.degrees, sizeof g->degrees);
	if (!code && l->asked->scene_crs) {
		code = metric(l->asked->scene_crs, at, &other, l->error);
		snprintf(g->scene_crs, sizeof g->scene_crs, "%.31s", l->asked->scene_crs);
		eco_place_why(g->scene_why, "as you say");
	} else if (!code && own.metric_map && own.code[0] != 0) {
		snprintf(g->scene_crs, sizeof g->scene_crs, "%s", own.code);
		eco_place_why(g->scene_why, "the table's: projected, in metres");
	} else if (!code && dem && dem->crs[0] != 0 && eco_place_dem_has(l, own.degrees)
			&& eco_crs_look(dem->crs, dem->low, &other, NULL) == ECO_OK && other.metric_map
			&& other.code[0] != 0) {
		snprintf(g->scene_crs, sizeof g->scene_crs, "%s", other.code);
		eco_place_why(g->scene_why, "%.80s, the terrain's, which so stays as it is",
			other.name);
	} else if (!code && !isnan(own.degrees[0])) {
		eco_crs_utm(own.degrees, g->scene_crs);
		eco_place_why(g->scene_why, "the UTM zone of %.4f, %.4f, the middle of the "
			"plants",
			own.degrees[0], own.degrees[1]);
	} else if (!code) {
		code = eco_place_fail(l,
			"%.10g, %.10g is no place in %.40s; give the CRS of the coordinates with --crs",
			at[0], at[1], crs);
	}
	return code;
}

static void note_nothing(void *ctx, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void note_nothing(void *ctx, const char *format, ...) { (void)ctx, (void)format; }

/* The middle in the scene's CRS, rounded. */
static enum eco_code guess_origin(struct eco_place_look *l)
{
	struct eco_place_guess *g = l->guess;
	const int x = g->swapped;
	double at[3] = { l->xy[x].middle, l->xy[1 - x].middle, 0 };
	const char *own = g->crs[0] != 0 ? g->crs : l->asked->table->crs, *why;
	struct eco_frame frame = { .crs = g->scene_crs };
	struct eco_crs_request request = { .path = l->asked->table->path, .stated = own, .frame = &frame,
		.note = note_nothing };
	struct eco_crs *crs = NULL;
	bool converted = true;
	if (l->nowhere || g->offsets.quadrat_m > 0) {
		eco_place_why(g->origin_why, "%s", l->nowhere ? "the plot's centre"
			: "where the quadrats count from");
		return ECO_OK;
	}
	enum eco_code code = g->scene_crs[0] != 0 ? eco_crs_open(&crs, &request, l->error) : ECO_OK;
	if (crs)
		code = eco_crs_convert(crs, at, &converted, &why, l->error);
	if (!code && !converted)
		code = eco_place_fail(l,
			"%.10g, %.10g is no place in %.40s (%.60s); give the CRS of the coordinates "
			"with --crs", l->xy[x].middle, l->xy[1 - x].middle, own, why);
	eco_crs_close(crs);
	for (int k = 0; k < 2; k++)
		g->origin[k] = round(at[k] * (g->unit ? l->unit_m : 1) / ROUND_M) * ROUND_M;
	eco_place_why(g->origin_why, "the middle of the plants, rounded to %g m", ROUND_M);
	return code;
}

/* A raster that does not say its CRS is in the table's or the scene's, where its numbers fit. */
static void guess_dem(struct eco_place_look *l)
{
	const struct eco_raster_extent *dem = l->asked->dem;
	if (!dem || dem->crs[0] != 0 || l->guess->scene_crs[0] == 0)
		return;
	bool degrees = dem->low[0] >= -180 && dem->high[0] <= 180 && dem->low[1] >= -90 && dem->high[1] <= 90;
	snprintf(l->guess->dem_crs, sizeof l->guess->dem_crs, "%s", eco_raster_extent_has(dem,
		l->guess->origin)
		? l->guess->scene_crs : degrees ? "EPSG:4326" : l->guess->crs);
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
