/* From rows of texts to plants in the scene: the plant of a row (filters, species), its place (columns or
 * geometry, through crs.c), and its size (positions_size.c). Each step counts the rows it leaves
 * out, with the first line of each reason. Formats are behind rows.h. The file is longer than
 * most, as whole files are refused beside the rows that show why. */
#include "ecofiles/import/places/positions.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/utf8.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/positions_parts.h"
#include "ecofiles/import/places/table_columns.h"

#define DISTANCE_MAX_M 1e7
#define HEIGHT_MIN_M 0.01
#define HEIGHT_MAX_M 300.0
#define HEIGHT_PLAUSIBLE_M 116.0     /* the highest tree */
#define CROWN_MAX_M 100.0
#define CROWN_PLAUSIBLE_M 60.0
#define SCALE_MIN 0.001
#define SCALE_MAX 1000.0
#define FAR_M 100000.0
#define ROW_NAME 280
#define HEAP_PLANTS 10u /* so many within a metre are degrees, where they could be */

/* ---- Notes and counts ---- */

/* Keeps a note of the reader's own, once. */
__attribute__((format(printf, 2, 3))) static void add_note(void *reader, const char *format, ...)
{
	struct eco_positions *p = reader;
	va_list arguments;
	va_start(arguments, format);
	eco_rows_add_note(p->notes, &p->note_count, format, arguments);
	va_end(arguments);
}

/* Counts a row into one of `skipped` or `filtered`, with the first line and text. */
static void count_in(const struct eco_positions *p, struct eco_skipped *counter, const char *text)
{
	if (counter->count++ > 0)
		return;
	counter->first_line = p->rows->line;
	snprintf(counter->first_text, sizeof counter->first_text, "%.47s", text);
	eco_utf8_tame(counter->first_text, "", ' ');
}

static void count(struct eco_positions *p, enum eco_skip why, const char *text)
{
	count_in(p, &p->skipped[why], text);
}

/* ---- Fields ---- */

/* A field's text without leading spaces. */
static const char *field(const struct eco_positions *p, uint32_t column)
{
	const char *text = p->rows->fields[column];
	while (isspace((unsigned char)*text))
		text++;
	return text;
}

/* A text for a message: trimmed and shortened. */
static const char *shown(const char *text, char *buffer, size_t size)
{
	size_t length = strlen(text);
	while (length > 0 && isspace((unsigned char)text[length - 1]))
		length--;
	snprintf(buffer, size, "%.*s", (int)(length < size ? length : size - 1), text);
	return buffer;
}

static char decimal_of(const struct eco_positions *p)
{
	return p->spec->decimal != 0 ? p->spec->decimal : '.';
}

/* ---- Filters ---- */

static bool passes_filters(struct eco_positions *p)
{
	char text[64];
	for (uint32_t i = 0; i < p->spec->filter_count; i++) {
		const char *value = field(p, p->filter_column[i]);
		if (eco_filter_passes(&p->spec->filters[i], value, decimal_of(p)))
			continue;
		count_in(p, &p->filtered[i], shown(value, text, sizeof text));
		count(p, ECO_SKIP_FILTERED, text);
		return false;
	}
	return true;
}

/* ---- Species ---- */

/* Makes a text fit for people and their tools: no control character, UTF-8, and what ends within a character
 * is cut before it. */
static void tidy(char *text, bool is_cut)
{
	size_t left = strlen(text);
	for (size_t bytes; left > 0; text += bytes, left -= bytes) {
		bytes = eco_utf8_bytes(text, left);
		if (eco_utf8_control(text, left))
			memset(text, ' ', bytes);
		else if (!bytes && is_cut && left < 4)
			*text = 0;
		else if (!bytes)
			*text = '?';
		bytes += !bytes;
	}
}

static bool read_plant(struct eco_positions *p, struct eco_position *record)
{
	const struct eco_species *species = &p->spec->fallback;
	char *text = p->said;
	*text = 0;
	if (p->column[ECO_COLUMN_SPECIES] != ECO_NONE) {
		shown(field(p, p->column[ECO_COLUMN_SPECIES]), text, sizeof p->said);
		uint32_t key = eco_species_find(p->species, text, p->rows->line);
		if (key < p->spec->map_count)
			species = &p->spec->map[key];
		tidy(text, strlen(text) == ECO_SPECIES_BYTES);
		record->species = eco_text_is_missing(text) ? "" : text;
	}
	record->plant = record->variant_first = species->plant;
	record->variant_count = species->variant_count;
	if (species->plant == ECO_NONE)
		count(p, species->name ? ECO_SKIP_LEFT_OUT : ECO_SKIP_UNKNOWN_SPECIES, text);
	return species->plant != ECO_NONE;
}

/* ---- Places ---- */

enum verdict { GOOD, SKIPPED, FAILED };

static enum verdict skip(struct eco_positions *p, enum eco_skip why, const char *text)
{
	count(p, why, text);
	return SKIPPED;
}

/* The row being read, for errors: FILE:LINE, or FILE, feature NUMBER in a file without meaningful lines. */
static const char *row_name(const struct eco_positions *p, char *text, size_t size)
{
	unsigned long long number = p->rows->line;
	if (strcmp(p->rows->where, "line") == 0)
		snprintf(text, size, "%.200s:%llu", p->spec->path, number);
	else
		snprintf(text, size, "%.200s, %s %llu", p->spec->path, p->rows->where, number);
	return text;
}

/* A bad coordinate before any good row shows the notation of the whole file: the other decimal sign, or
 * degrees that are none. Then the file is refused. */
static enum verdict refuse_notation(const struct eco_positions *p, const char *text, struct eco_error *error)
{
	double number;
	char row[ROW_NAME];
	if (p->spec->decimal == 0 && eco_text_number(text, ',', &number)) {
		eco_fail(error, ECO_BAD_INPUT, "%s: \"%.40s\" has a decimal comma; add \"decimal\": \",\" "
			"to its entry%s", row_name(p, row, sizeof row), text,
			eco_text_grouped(text, ',', &number) ? ", or \"thousands\": \",\" if it "
			"parts thousands" : "");
		return FAILED;
	}
	if (strstr(text, "\u00b0") && text[strspn(text, "+-")] >= '0' && text[strspn(text, "+-")] <= '9') {
		eco_fail(error, ECO_BAD_INPUT, "%s: \"%.40s\": degrees with minutes and seconds are read "
			"as 48\u00b0 8' 15\" N, with N, S, E or W; or export decimals, such as 48.1375",
			row_name(p, row, sizeof row), text);
		return FAILED;
	}
	return GOOD;
}

static enum verdict read_coordinate(struct eco_positions *p, uint32_t column, double *number,
	struct eco_error *error)
{
	const char *text = field(p, column);
	char buffer[48];
	if ((p->spec->thousands && eco_text_grouped(text, p->spec->thousands, number))
			|| eco_text_number(text, decimal_of(p), number))
		return GOOD;
	shown(text, buffer, sizeof buffer);
	if (eco_text_is_missing(text))
		return skip(p, ECO_SKIP_NO_COORDINATES, buffer);
	if (p->good_places == 0 && refuse_notation(p, buffer, error) == FAILED)
		return FAILED;
	return skip(p, ECO_SKIP_BAD_NUMBER, buffer);
}

static enum verdict read_columns(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	double corner_m[2] = { 0, 0 }, unit_m = p->spec->unit_m > 0 ? p->spec->unit_m : 1;
	enum verdict verdict = GOOD;
	for (int k = 0; k < 3 && verdict == GOOD; k++)
		if (p->column[k] != ECO_NONE)
			verdict = read_coordinate(p, p->column[k], &xyz[k], error);
	if (verdict == GOOD && p->column[ECO_COLUMN_QUADRAT] != ECO_NONE) {
		const char *text = field(p, p->column[ECO_COLUMN_QUADRAT]);
		if (!eco_quadrat_corner(&p->spec->quadrat, text, corner_m))
			return skip(p, eco_text_is_missing(text) ? ECO_SKIP_NO_COORDINATES
				: ECO_SKIP_BAD_NUMBER, text);
	}
	for (int k = 0; k < 2; k++)
		xyz[k] = corner_m[k] + xyz[k] * unit_m;
	return verdict;
}

/* From a plot's centre, which is in the scene's metres already: grid north is taken for north. */
static enum verdict add_polar(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	double azimuth, distance, offset_m[2];
	if (p->column[ECO_COLUMN_AZIMUTH] == ECO_NONE)
		return GOOD;
	enum verdict verdict = read_coordinate(p, p->column[ECO_COLUMN_AZIMUTH], &azimuth, error);
	if (verdict == GOOD)
		verdict = read_coordinate(p, p->column[ECO_COLUMN_DISTANCE], &distance, error);
	if (verdict != GOOD)
		return verdict;
	eco_polar_offset(&p->spec->polar, azimuth, distance, offset_m);
	for (int k = 0; k < 2; k++)
		xyz[k] += offset_m[k];
	return GOOD;
}

static enum verdict read_geometry(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	const struct eco_rows_place *place = &p->rows->place;
	if (place->kind == ECO_PLACE_EMPTY || place->kind == ECO_PLACE_NONE)
		count(p, ECO_SKIP_NO_GEOMETRY, place->what);
	else if (place->kind == ECO_PLACE_OTHER)
		count(p, ECO_SKIP_NOT_A_POINT, place->what);
	if (place->kind != ECO_PLACE_POINT)
		return SKIPPED;
	memcpy(xyz, place->at, sizeof place->at);
	if (!isfinite(xyz[0]) || !isfinite(xyz[1])
			|| (p->use_z && p->column[ECO_COLUMN_Z] == ECO_NONE && !isfinite(xyz[2])))
		return skip(p, ECO_SKIP_BAD_NUMBER, "not finite");
	return p->column[ECO_COLUMN_Z] != ECO_NONE ? read_coordinate(p, p->column[ECO_COLUMN_Z], &xyz[2],
		error) : GOOD;
}

/* Refuses degrees that would be taken for the scene's metres: a heap some metres wide, far away. */
static enum verdict refuse_inherited(const struct eco_positions *p, const double xyz[3],
	struct eco_error *error)
{
	if (!p->frame.crs || p->spec->crs || (p->from_geometry && p->rows->crs)
			|| fabs(xyz[0]) > 180 || fabs(xyz[1]) > 180)
		return GOOD;
	eco_fail(error, ECO_BAD_INPUT, "%.150s: no CRS is stated for its coordinates, so they would be in "
		"the scene's, %.80s; but %.10g, %.10g looks like degrees: add \"crs\": \"EPSG:4326\" to "
		"its entry, or \"crs\": \"%.80s\" if they are not", p->spec->path, p->frame.crs, xyz[0],
		xyz[1], p->frame.crs);
	return FAILED;
}

/* Refuses degrees in a scene of plain metres: they would become a heap a few millimetres wide. */
static enum verdict refuse_degrees(const struct eco_positions *p, const double xyz[3],
	struct eco_error *error)
{
	int zone = (int)floor((xyz[0] + 180) / 6) + 1;
	if (p->frame.crs || p->spec->crs || p->from_geometry || !eco_column_says_degrees(p->spec->x)
		|| !eco_column_says_degrees(p->spec->y)
		|| fabs(xyz[0]) > 180 || fabs(xyz[1]) > 90)
		return GOOD;
	zone = zone < 1 ? 1 : zone > 60 ? 60 : zone;
	eco_fail(error, ECO_BAD_INPUT, "%.150s: \"%.40s\" and \"%.40s\" are degrees, and the scene is in "
		"plain metres; add \"crs\": \"EPSG:4326\" to its entry, and \"crs\": \"EPSG:%d\" (the UTM "
		"zone of %.2f, %.2f) and an \"origin\" in it to the scene", p->spec->path, p->spec->x,
		p->spec->y, (xyz[1] < 0 ? 32700 : 32600) + zone, xyz[0], xyz[1]);
	return FAILED;
}

static enum verdict convert(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	const double was[3] = { xyz[0], xyz[1], xyz[2] };
	const char *why;
	bool converted;
	char text[80];
	if (p->frame.crs && xyz[0] == 0 && xyz[1] == 0)
		return skip(p, ECO_SKIP_NO_COORDINATES, "0, 0");
	if (p->good_places == 0 && (refuse_degrees(p, xyz, error) == FAILED
			|| refuse_inherited(p, xyz, error) == FAILED))
		return FAILED;
	if (eco_crs_convert(p->crs, xyz, &converted, &why, error) != ECO_OK)
		return FAILED;
	snprintf(text, sizeof text, "%.10g, %.10g%s%.30s", was[0], was[1], *why != 0 ? ": " : "", why);
	if (!converted && p->bad_places++ == 0)
		memcpy(p->first_bad, was, sizeof was);
	if (!converted)
		return skip(p, ECO_SKIP_NO_CONVERSION, text);
	for (int k = 0; k < 3; k++)
		if (!(fabs(xyz[k]) <= DISTANCE_MAX_M))
			return skip(p, ECO_SKIP_OUTSIDE, text);
	p->nearest_m = fmin(p->nearest_m, hypot(xyz[0], xyz[1]));
	if (p->good_places == 0)
		memcpy(p->first, was, sizeof was);
	eco_crs_span_add(&p->span, was);
	return GOOD;
}

/* Notes places far from everything: swapped columns, degrees taken for metres, and a wrong zone give valid
 * coordinates. */
static void note_far(struct eco_positions *p)
{
	double swapped[3] = { p->first[1], p->first[0], p->first[2] };
	struct eco_error error = { .code = ECO_OK };
	const char *why;
	bool converted;
	if (p->good_places == 0 || p->at_origin || p->nearest_m <= FAR_M)
		return;
	if (eco_crs_convert(p->crs, swapped, &converted, &why, &error) == ECO_OK && converted
			&& hypot(swapped[0], swapped[1]) <= FAR_M)
		add_note(p, "its plants stand %.0f km and more from the scene's origin, and would be near it "
			"with their coordinates swapped: x is easting or longitude, y is northing or "
			"latitude", p->nearest_m / 1000);
	else
		add_note(p, "its plants stand %.0f km and more from the scene's origin; are x, y, crs and "
			"the origin what they should be?", p->nearest_m / 1000);
}

/* The CRS that the entry or the file states for the places; NULL: the scene's, or none. */
static const char *stated_crs(const struct eco_positions *p)
{
	return p->spec->crs ? p->spec->crs : p->from_geometry ? p->rows->crs : NULL;
}

/* Refuses degrees in a CRS of metres; notes places that lie in the CRS's area of use only if x and y change places. */
static enum eco_code check_area(struct eco_positions *p, struct eco_error *error)
{
	const char *crs = stated_crs(p);
	enum eco_crs_fit fit;
	char area[80];
	bool heap = p->good_places >= HEAP_PLANTS && p->high[0] - p->low[0] < ECO_HEAP_M &&
		p->high[1] - p->low[1] < ECO_HEAP_M;
	enum eco_code code = eco_crs_refuse_degrees(&p->span, crs, heap, p->spec->path, &fit, area, error);
	if (code || fit != ECO_CRS_SWAPPED)
		return code;
	char *name = eco_crs_short_name(crs);
	add_note(p,
		"its places, such as %.10g, %.10g, lie outside the area of use of its CRS, %.80s (%s), and inside with "
		"their coordinates swapped: x is easting or longitude, y is northing or latitude",
		p->first[0], p->first[1], name ? name : "?", area);
	free(name);
	return ECO_OK;
}

/* Refuses a file without any place, if it had some with x and y swapped. */
static enum eco_code refuse_swapped(const struct eco_positions *p, struct eco_error *error)
{
	double swapped[3] = { p->first_bad[1], p->first_bad[0], p->first_bad[2] };
	const char *why;
	bool converted = false;
	if (p->good_places > 0 || p->bad_places == 0
			|| eco_crs_convert(p->crs, swapped, &converted, &why, NULL) != ECO_OK || !converted
			|| !(fmax(fabs(swapped[0]), fabs(swapped[1])) <= DISTANCE_MAX_M))
		return ECO_OK;
	char columns[120] = "";
	if (p->spec->x)
		snprintf(columns, sizeof columns, "; add \"x\": \"%.40s\", \"y\": \"%.40s\" to its entry",
			p->spec->y, p->spec->x);
	return eco_fail(error, ECO_BAD_INPUT, "%.150s: none of its %llu places can be converted, such as "
		"%.10g, %.10g; swapped they stand %.0f km from the scene's origin: x is easting or "
		"longitude, y is northing or latitude%s", p->spec->path,
		(unsigned long long)p->bad_places, p->first_bad[0], p->first_bad[1], hypot(swapped[0], swapped[1]) / 1000, columns);
}

/* Whether an earlier plant stands at this place. */
static enum verdict find_duplicate(struct eco_positions *p, const double at[3], struct eco_error *error)
{
	char text[80];
	bool known;
	if (!eco_place_set_add(p->places, at, &known)) {
		eco_fail(error, ECO_NO_MEMORY, "%.200s: no memory to find duplicates among %llu plants",
			p->spec->path, (unsigned long long)p->plants);
		return FAILED;
	}
	if (!known)
		return GOOD;
	snprintf(text, sizeof text, "%.3f, %.3f", at[0], at[1]);
	count(p, p->spec->skip_duplicates ? ECO_SKIP_DUPLICATE : ECO_KEPT_DUPLICATE, text);
	return p->spec->skip_duplicates ? SKIPPED : GOOD;
}

static enum verdict read_place(struct eco_positions *p, struct eco_position *record, struct eco_error *error)
{
	double xyz[3] = { 0, 0, 0 };
	enum verdict verdict = p->from_geometry ? read_geometry(p, xyz, error) : read_columns(p, xyz, error);
	record->absolute = p->use_z;
	if (!p->use_z)
		xyz[2] = 0;
	if (verdict == GOOD && !p->at_origin)
		verdict = convert(p, xyz, error);
	if (verdict == GOOD)
		verdict = add_polar(p, xyz, error);
	if (verdict == GOOD)
		verdict = find_duplicate(p, xyz, error);
	if (verdict != GOOD)
		return verdict;
	p->good_places++;
	memcpy(record->at, xyz, sizeof xyz);
	for (int k = 0; k < 2; k++) {
		p->low[k] = fmin(p->low[k], xyz[k]);
		p->high[k] = fmax(p->high[k], xyz[k]);
	}
	return GOOD;
}

/* ---- Sizes ---- */

static void count_remarks(struct eco_positions *p, uint32_t kinds, const char *text)
{
	char buffer[48];
	shown(text, buffer, sizeof buffer);
	for (int kind = ECO_KEPT_RANGE; kind <= ECO_KEPT_IMPLAUSIBLE; kind++)
		if (kinds >> kind & 1)
			count(p, (enum eco_skip)kind, buffer);
}

/* Refuses a size with a decimal comma before any size was understood: all of them would be lost. */
static bool refuse_size(const struct eco_positions *p, const char *text, struct eco_error *error)
{
	double number, unit_m;
	char buffer[48], row[ROW_NAME];
	if (p->sized || p->spec->decimal != 0 || !strchr(text, ',')
			|| eco_text_size(text, '.', &number, &unit_m) != ECO_FORM_NONE
		|| eco_text_size(text, ',', &number, &unit_m) == ECO_FORM_NONE)
		return false;
	eco_fail(error, ECO_BAD_INPUT, "%s: \"%.40s\" has a comma; add \"decimal\": \",\" to its entry, or "
		"\".\" if this one is no decimal comma", row_name(p, row, sizeof row),
		shown(text, buffer, sizeof buffer));
	return true;
}

static enum verdict check_sizes(struct eco_positions *p, struct eco_error *error)
{
	if (p->column[ECO_COLUMN_CROWN] != ECO_NONE && refuse_size(p, field(p, p->column[ECO_COLUMN_CROWN]),
			error))
		return FAILED;
	for (uint32_t i = 0; i < p->spec->height_count; i++)
		if (p->height_column[i] != ECO_NONE && refuse_size(p, field(p, p->height_column[i]), error))
			return FAILED;
	return GOOD;
}

static double read_crown(struct eco_positions *p)
{
	struct eco_size_remarks remarks = { .kinds = 0 };
	const char *text = p->column[ECO_COLUMN_CROWN] != ECO_NONE ? field(p, p->column[ECO_COLUMN_CROWN])
		: "";
	double radius = p->spec->crown.kind == ECO_SIZE_NONE ? NAN
		: eco_size_read(&p->spec->crown, text, decimal_of(p), ECO_NONE, HEIGHT_MIN_M, CROWN_MAX_M,
		&remarks);
	count_remarks(p, remarks.kinds | (uint32_t)(radius > CROWN_PLAUSIBLE_M) << ECO_KEPT_IMPLAUSIBLE, text);
	p->sized |= !isnan(radius);
	return radius;
}

static double read_height(struct eco_positions *p, uint32_t plant, double crown_radius_m)
{
	const struct eco_positions_spec *s = p->spec;
	char buffer[48];
	p->height_source = ECO_NONE;
	for (uint32_t i = 0; i < s->height_count; i++) {
		struct eco_size_remarks remarks = { .kinds = 0 };
		const char *text = p->height_column[i] != ECO_NONE ? field(p, p->height_column[i]) : "";
		double height = eco_size_read(&s->heights[i], text, decimal_of(p), plant, HEIGHT_MIN_M,
			HEIGHT_MAX_M, &remarks);
		count_remarks(p, remarks.kinds | (uint32_t)(height > HEIGHT_PLAUSIBLE_M) << ECO_KEPT_IMPLAUSIBLE, text);
		/* without memory there is no doubt */
		if (remarks.measured_m > 0)
			eco_spread_add(&p->measured[i], remarks.measured_m);
		if (isnan(height))
			continue;
		p->sized = true;
		p->height_source = i;
		return height;
	}
	if (s->height_count > 0)
		count(p, isnan(crown_radius_m) ? ECO_KEPT_NO_HEIGHT : ECO_KEPT_BY_CROWN,
			p->height_column[0] != ECO_NONE ? shown(field(p, p->height_column[0]), buffer,
			sizeof buffer) : "");
	return NAN;
}

/* Rows whose size does not count or can hardly be meant: the plant of the first shows what they become. */
static void note_became(struct eco_positions *p, const struct eco_position *record)
{
	static const enum eco_skip odd[] = { ECO_KEPT_UNREAD, ECO_KEPT_UNUSED, ECO_KEPT_IMPLAUSIBLE };
	for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
		struct eco_skipped *s = &p->skipped[odd[i]];
		const struct eco_size *size =
			p->height_source != ECO_NONE ? &p->spec->heights[p->height_source] : NULL;
		if (s->count == 0 || s->became[0] != 0)
			continue;
		if (size && size->column)
			snprintf(s->became, sizeof s->became, "%.3g m by \"%.50s\"", record->height_m,
				size->column);
		else if (size)
			snprintf(s->became, sizeof s->became, "%.3g m, as for rows without a size",
				record->height_m);
		else
			snprintf(s->became, sizeof s->became, "its plant's own height%s",
				isnan(record->crown_radius_m) ? "" : ", scaled to its crown");
	}
}

static double read_yaw(struct eco_positions *p)
{
	double yaw;
	if (p->column[ECO_COLUMN_YAW] != ECO_NONE && eco_text_number(field(p, p->column[ECO_COLUMN_YAW]),
			decimal_of(p), &yaw) && fabs(yaw) <= 1e6)
		return yaw;
	/* any of 64: nobody sees more, and it takes 10 bits less */
	return (eco_random_angle16(p->spec->seed, p->rows->row) >> 10) * (360.0 / 64);
}

static double read_scale(struct eco_positions *p)
{
	double scale;
	bool there = p->column[ECO_COLUMN_SCALE] != ECO_NONE
		&& eco_text_number(field(p, p->column[ECO_COLUMN_SCALE]), decimal_of(p), &scale);
	return there && scale >= SCALE_MIN && scale <= SCALE_MAX ? scale : 1;
}

/* ---- Records ---- */

static enum verdict read_row(struct eco_positions *p, struct eco_position *record, struct eco_error *error)
{
	if (p->rows->field_count < p->fields_needed)
		return skip(p, ECO_SKIP_SHORT_ROW, p->rows->field_count > 0 ? p->rows->fields[0] : "");
	if (!passes_filters(p) || !read_plant(p, record))
		return SKIPPED;
	enum verdict verdict = read_place(p, record, error);
	if (verdict == GOOD)
		verdict = check_sizes(p, error);
	if (verdict != GOOD)
		return verdict;
	record->crown_radius_m = read_crown(p);
	record->height_m = read_height(p, record->plant, record->crown_radius_m);
	note_became(p, record);
	record->yaw_deg = read_yaw(p);
	record->scale = read_scale(p);
	record->row = p->rows->row;
	record->line = p->rows->line;
	p->plants++;
	return GOOD;
}

/* The next usable row, with the first variant as its plant. */
static enum eco_code read_record(struct eco_positions *p, struct eco_position *record,
	struct eco_error *error)
{
	enum verdict verdict = SKIPPED;
	while (verdict == SKIPPED) {
		bool more = false;
		enum eco_code code = p->ended ? ECO_OK : p->rows->next(p->rows, &more, error);
		*record = (struct eco_position){ .plant = ECO_NONE, .height_m = NAN, .crown_radius_m = NAN,
			.scale = 1 };
		if (code != ECO_OK || p->ended)
			return code;
		if (more) {
			verdict = read_row(p, record, error);
		} else {
			p->ended = true;
			note_far(p);
			code = check_area(p, error);
			return code ? code : refuse_swapped(p, error);
		}
	}
	return verdict == GOOD ? ECO_OK : error ? error->code : ECO_BAD_INPUT;
}

static enum eco_code start_places(struct eco_positions *p, struct eco_error *error)
{
	eco_place_set_close(p->places);
	p->places = eco_place_set_open();
	for (int k = 0; k < 2; k++) {
		p->low[k] = INFINITY;
		p->high[k] = -INFINITY;
	}
	p->span = (struct eco_crs_span){ .any = false };
	p->plants = p->good_places = p->bad_places = 0;
	for (uint32_t i = 0; i < ECO_HEIGHT_SOURCES_MAX; i++)
		eco_spread_free(&p->measured[i]);
	p->nearest_m = INFINITY;
	p->ended = false;
	return p->places ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "out of memory");
}

/* ---- Levels ---- */

static bool wants_levels(const struct eco_positions *p)
{
	return p->spec->levels > 0 && !p->levels;
}

static enum eco_code find_levels(struct eco_positions *p, struct eco_error *error)
{
	struct eco_position record;
	enum eco_code code;
	p->levels = eco_levels_open();
	if (!p->levels)
		return eco_fail(error, ECO_NO_MEMORY, "%.200s: out of memory", p->spec->path);
	do {
		code = read_record(p, &record, error);
		if (code == ECO_OK && record.plant != ECO_NONE && !isnan(record.height_m))
			code = eco_levels_count(p->levels, record.plant, record.height_m, p->spec->path,
				error);
	} while (code == ECO_OK && record.plant != ECO_NONE);
	if (code)
		return code;
	eco_levels_make(p->levels, p->spec->levels);
	memset(p->skipped, 0, sizeof p->skipped);
	memset(p->filtered, 0, sizeof p->filtered);
	eco_species_reset(p->species);
	code = start_places(p, error);
	return code == ECO_OK ? eco_positions_open_rows(p, error) : code;
}

/* ---- The reader ---- */

static enum eco_code open_crs(struct eco_positions *p, struct eco_error *error)
{
	const struct eco_rows *rows = p->rows;
	struct eco_crs_request request = { .path = p->spec->path, .stated = p->spec->crs,
		.vertical = p->spec->vertical,
		.of_file = p->from_geometry ? rows->crs : NULL, .no_crs_says = p->from_geometry ? rows->no_crs
		: NULL,
		.use_z = p->use_z, .frame = &p->frame,
		.note = add_note, .ctx = p };

	if (p->from_geometry && rows->degrees_doubted && !p->spec->crs)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: its numbers cannot be degrees, which this "
			"format means unless it says otherwise; add \"crs\": \"%.80s\" to its entry, or the "
			"CRS that they are in", p->spec->path, p->frame.crs ? p->frame.crs : "EPSG:...");
	return eco_crs_open(&p->crs, &request, error);
}

enum eco_code eco_positions_open(struct eco_positions **reader, const struct eco_positions_spec *spec,
	const struct eco_frame *frame, struct eco_error *error)
{
	struct eco_positions *p = calloc(1, sizeof *p);
	*reader = NULL;
	if (!p)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	p->spec = spec;
	p->frame = *frame;
	p->species = eco_species_open(spec);
	enum eco_code code = start_places(p, error);
	if (code == ECO_OK && (!p->species || spec->height_count > ECO_HEIGHT_SOURCES_MAX
			|| spec->filter_count > ECO_FILTERS_MAX))
		code = eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (!code)
		code = eco_positions_open_rows(p, error);
	if (!code)
		code = open_crs(p, error);
	if (!code)
		*reader = p;
	else
		eco_positions_close(p);
	return code;
}

enum eco_code eco_positions_next(struct eco_positions *reader, struct eco_position *record,
	struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	if (!error)
		error = &own;
	enum eco_code code = wants_levels(reader) ? find_levels(reader, error) : ECO_OK;
	if (!code)
		code = read_record(reader, record, error);
	if (code != ECO_OK || record->plant == ECO_NONE)
		return code;
	if (reader->levels && !isnan(record->height_m))
		record->height_m = eco_levels_height(reader->levels, record->plant, record->height_m);
	record->plant += eco_random_variant(reader->spec->seed, record->row, record->variant_count);
	return ECO_OK;
}

const struct eco_skipped *eco_positions_skipped(const struct eco_positions *reader, uint64_t *rows)
{
	if (rows)
		*rows = reader->rows ? reader->rows->row : 0;
	return reader->skipped;
}

void eco_positions_counted(const struct eco_positions *reader, struct eco_positions_counts *counts)
{
	*counts = (struct eco_positions_counts){ .plants = reader->plants, .skipped = reader->skipped,
		.filters = reader->filtered,
		.low = { reader->low[0], reader->low[1] }, .high = { reader->high[0], reader->high[1] },
		.where = reader->rows ? reader->rows->where : "line", .rows = reader->rows
		? reader->rows->row : 0 };
	eco_species_counted(reader->species, counts);
}

bool eco_positions_has_lines(const struct eco_positions *reader)
{
	return strcmp(reader->rows->where, "line") == 0;
}

void eco_positions_close(struct eco_positions *reader)
{
	if (!reader)
		return;
	eco_rows_close(reader->rows);
	eco_crs_close(reader->crs);
	eco_species_close(reader->species);
	eco_place_set_close(reader->places);
	eco_levels_close(reader->levels);
	for (uint32_t i = 0; i < ECO_HEIGHT_SOURCES_MAX; i++)
		eco_spread_free(&reader->measured[i]);
	for (uint32_t i = 0; i < reader->note_count; i++)
		free(reader->notes[i]);
	free(reader);
}
