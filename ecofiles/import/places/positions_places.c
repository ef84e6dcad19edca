/* The place of a row's plant: from columns or a geometry, through crs.h. Files that show another
 * notation, or
 * degrees where the CRS has metres, are refused beside the rows that show it. */
#include "ecofiles/import/places/positions_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/table_columns.h"

#define DISTANCE_MAX_M 1e7
#define FAR_M 100000.0
#define HEAP_PLANTS 10u /* so many within a metre are degrees, where they could be */
#define FIRST 1024u

/* ---- Places taken ---- */

/* The slot of a hash, or the free slot where it belongs: open addressing over 64-bit hashes of millimetres.
 * Two places with one hash (in one of 10^5 inventories of 10^7 rows) count as one. */
static uint64_t *slot_of(uint64_t *slots, size_t size, uint64_t hash)
{
	size_t at = hash & (size - 1);
	while (slots[at] != 0 && slots[at] != hash)
		at = (at + 1) & (size - 1);
	return &slots[at];
}

static void grow(struct eco_positions *p)
{
	size_t size = p->places.size ? 2 * p->places.size : FIRST;
	uint64_t *slots = eco_alloc(size, sizeof *slots);
	for (size_t i = 0; i < p->places.size; i++)
		if (p->places.slots[i] != 0)
			*slot_of(slots, size, p->places.slots[i]) = p->places.slots[i];
	free(p->places.slots);
	p->places.slots = slots;
	p->places.size = size;
}

/* Whether it was there before. */
static bool add_place(struct eco_positions *p, const double at[3])
{
	uint64_t hash = 0;
	for (int k = 0; k < 3; k++)
		hash = eco_random(hash, (uint64_t)(int64_t)floor(at[k] * 1000 + 0.5));
	hash += hash == 0;
	if (p->places.count * 4 >= p->places.size * 3)
		grow(p);
	uint64_t *slot = slot_of(p->places.slots, p->places.size, hash);
	bool known = *slot != 0;
	p->places.count += !known;
	*slot = hash;
	return known;
}

/* ---- From others ---- */

/* The south-western corner of a quadrat by its four digits (fewer: zeros were lost before them). False: they
 * are
 * none. */
static bool quadrat_corner(const struct eco_quadrat *quadrat, const char *text, double corner_m[2])
{
	size_t digits = strspn(text, "0123456789"), spaces = strspn(text + digits, " ");
	if (digits == 0 || digits > 4 || text[digits + spaces] != 0)
		return false;
	unsigned long number = strtoul(text, NULL, 10);
	corner_m[0] = (double)(number / 100) * quadrat->size_m;
	corner_m[1] = (double)(number % 100) * quadrat->size_m;
	return true;
}

/* East and north of an azimuth and a distance. */
static void polar_offset(const struct eco_polar *polar, double azimuth, double distance, double offset_m[2])
{
	double sine, cosine;
	eco_angle16_sincos(eco_angle16_from_deg(azimuth / polar->whole_turn * 360), &sine, &cosine);
	offset_m[0] = distance * polar->unit_m * sine;
	offset_m[1] = distance * polar->unit_m * cosine;
}

/* ---- Coordinates ---- */

/* A bad coordinate before any good row shows the notation of the whole file: the other decimal sign, or
 * degrees that are none. Then the file is refused. */
static enum verdict refuse_notation(const struct eco_positions *p, const char *text, struct eco_error *error)
{
	double number;
	char row[ECO_ROW_NAME];
	if (p->spec->decimal == 0 && eco_text_number(text, ',', &number)) {
		eco_fail(error, ECO_BAD_INPUT, "%s: \"%.40s\" has a decimal comma; add \"decimal\": \",\" "
			"to its entry%s", eco_row_name(p, row, sizeof row), text,
			eco_text_grouped(text, ',', &number) ? ", or \"thousands\": \",\" if it "
			"parts thousands" : "");
		return FAILED;
	}
	if (strstr(text, "\u00b0") && text[strspn(text, "+-")] >= '0' && text[strspn(text, "+-")] <= '9') {
		eco_fail(error, ECO_BAD_INPUT, "%s: \"%.40s\": degrees with minutes and seconds are read "
			"as 48\u00b0 8' 15\" N, with N, S, E or W; or export decimals, such as 48.1375",
			eco_row_name(p, row, sizeof row), text);
		return FAILED;
	}
	return GOOD;
}

static enum verdict read_coordinate(struct eco_positions *p, uint32_t column, double *number,
	struct eco_error *error)
{
	const char *text = eco_row_field(p, column);
	char buffer[48];
	if ((p->spec->thousands && eco_text_grouped(text, p->spec->thousands, number))
			|| eco_text_number(text, eco_row_decimal(p), number))
		return GOOD;
	eco_row_shown(text, buffer, sizeof buffer);
	if (eco_text_is_missing(text))
		return eco_row_skip(p, ECO_SKIP_NO_COORDINATES, buffer);
	if (p->good_places == 0 && refuse_notation(p, buffer, error) == FAILED)
		return FAILED;
	return eco_row_skip(p, ECO_SKIP_BAD_NUMBER, buffer);
}

static enum verdict read_columns(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	double corner_m[2] = { 0, 0 }, unit_m = p->spec->unit_m > 0 ? p->spec->unit_m : 1;
	enum verdict verdict = GOOD;
	for (int k = 0; k < 3 && verdict == GOOD; k++)
		if (p->column[k] != ECO_NONE)
			verdict = read_coordinate(p, (uint32_t)k, &xyz[k], error);
	if (verdict == GOOD && p->column[ECO_COLUMN_QUADRAT] != ECO_NONE) {
		const char *text = eco_row_field(p, ECO_COLUMN_QUADRAT);
		if (!quadrat_corner(&p->spec->quadrat, text, corner_m))
			return eco_row_skip(p, eco_text_is_missing(text) ? ECO_SKIP_NO_COORDINATES
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
	enum verdict verdict = read_coordinate(p, ECO_COLUMN_AZIMUTH, &azimuth, error);
	if (verdict == GOOD)
		verdict = read_coordinate(p, ECO_COLUMN_DISTANCE, &distance, error);
	if (verdict != GOOD)
		return verdict;
	polar_offset(&p->spec->polar, azimuth, distance, offset_m);
	for (int k = 0; k < 2; k++)
		xyz[k] += offset_m[k];
	return GOOD;
}

static enum verdict read_geometry(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	const struct eco_rows_place *place = &p->rows->place;
	if (place->kind == ECO_PLACE_EMPTY || place->kind == ECO_PLACE_NONE)
		return eco_row_skip(p, ECO_SKIP_NO_GEOMETRY, place->what);
	if (place->kind == ECO_PLACE_OTHER)
		return eco_row_skip(p, ECO_SKIP_NOT_A_POINT, place->what);
	if (place->kind != ECO_PLACE_POINT)
		return SKIPPED;
	memcpy(xyz, place->at, sizeof place->at);
	if (!isfinite(xyz[0]) || !isfinite(xyz[1])
			|| (p->use_z && p->column[ECO_COLUMN_Z] == ECO_NONE && !isfinite(xyz[2])))
		return eco_row_skip(p, ECO_SKIP_BAD_NUMBER, "not finite");
	return p->column[ECO_COLUMN_Z] != ECO_NONE ? read_coordinate(p, ECO_COLUMN_Z, &xyz[2],
		error) : GOOD;
}

static enum verdict convert(struct eco_positions *p, double xyz[3], struct eco_error *error)
{
	const double was[3] = { xyz[0], xyz[1], xyz[2] };
	const char *why;
	bool converted;
	char text[80];
	if (p->frame.crs && xyz[0] == 0 && xyz[1] == 0)
		return eco_row_skip(p, ECO_SKIP_NO_COORDINATES, "0, 0");
	if (eco_crs_convert(p->crs, xyz, &converted, &why, error) != ECO_OK)
		return FAILED;
	snprintf(text, sizeof text, "%.10g, %.10g%s%.30s", was[0], was[1], *why != 0 ? ": " : "", why);
	if (!converted && p->bad_places++ == 0)
		memcpy(p->first_bad, was, sizeof was);
	if (!converted)
		return eco_row_skip(p, ECO_SKIP_NO_CONVERSION, text);
	for (int k = 0; k < 3; k++)
		if (!(fabs(xyz[k]) <= DISTANCE_MAX_M))
			return eco_row_skip(p, ECO_SKIP_OUTSIDE, text);
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
		eco_rows_note(p->rows,
		"its plants stand %.0f km and more from the scene's origin, and would be "
		"near it with their coordinates swapped: x is easting or longitude, y is northing or "
		"latitude", p->nearest_m / 1000);
	else
		eco_rows_note(p->rows,
			"its plants stand %.0f km and more from the scene's origin; are x, y, crs "
		"and the origin what they should be?", p->nearest_m / 1000);
}

/* Refuses degrees where metres are meant; notes places that lie in the CRS's area of use only if x and y
 * change places. */
static enum eco_code check_area(struct eco_positions *p, struct eco_error *error)
{
	const char *own = p->spec->crs ? p->spec->crs : p->from_geometry ? p->rows->crs : NULL,
		*crs = own ? own : p->frame.crs;
	enum eco_crs_fit fit;
	char area[80];
	bool named = p->spec->x && eco_column_says_degrees(p->spec->x) && eco_column_says_degrees(p->spec->y);
	bool heap = crs ? p->good_places >= HEAP_PLANTS && p->high[0] - p->low[0] < ECO_HEAP_M
		&& p->high[1] - p->low[1] < ECO_HEAP_M : named;
	/* whole numbers are degrees, too, where nothing states that they are metres */
	p->span.has_decimals |= !own;
	enum eco_code code = eco_crs_refuse_degrees(&p->span, crs, heap, p->spec->path, &fit, area, error);
	if (code || fit != ECO_CRS_SWAPPED)
		return code;
	char *name = eco_crs_short_name(crs);
	eco_rows_note(p->rows,
		"its places, such as %.10g, %.10g, lie outside the area of use of its CRS, %.80s (%s), and "
		"inside with their coordinates swapped: x is easting or longitude, y is northing or latitude",
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
		(unsigned long long)p->bad_places, p->first_bad[0], p->first_bad[1], hypot(swapped[0],
		swapped[1]) / 1000, columns);
}

/* Whether an earlier plant stands at this place. */
static enum verdict find_duplicate(struct eco_positions *p, const double at[3])
{
	char text[80];
	if (!add_place(p, at))
		return GOOD;
	snprintf(text, sizeof text, "%.3f, %.3f", at[0], at[1]);
	enum verdict skipped = eco_row_skip(p, p->spec->skip_duplicates ? ECO_SKIP_DUPLICATE
		: ECO_KEPT_DUPLICATE,
		text);
	return p->spec->skip_duplicates ? skipped : GOOD;
}

enum verdict eco_positions_place(struct eco_positions *p, struct eco_position *record,
	struct eco_error *error)
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
		verdict = find_duplicate(p, xyz);
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

enum eco_code eco_positions_check_places(struct eco_positions *p, struct eco_error *error)
{
	note_far(p);
	enum eco_code code = check_area(p, error);
	return code ? code : refuse_swapped(p, error);
}
