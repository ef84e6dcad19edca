/* From rows of texts to plants in the scene: the plant of a row (filters, species), its place (columns or
 * geometry, through crs.c), and its size (positions_species.c). Each step counts the rows it leaves out, with
 * the first line of each reason. Formats are behind rows.h. Longer than 600 lines: all steps share a row. */
#include "ecofiles/import/places/positions.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/growth.h"
#include "ecofiles/import/places/positions_parts.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/table_columns.h"

#define SIZE_MIN_M 0.01
#define HEIGHT_MAX_M 300.0
#define HEIGHT_PLAUSIBLE_M 116.0     /* the highest tree */
#define CROWN_MAX_M 100.0
#define CROWN_PLAUSIBLE_M 60.0
#define SCALE_MIN 0.001
#define SCALE_MAX 1000.0

/* ---- Counts ---- */

/* Counts a row into one of `skipped` or `filtered`, with the first line and text. */
static void count_in(const struct eco_positions *p, struct eco_skipped *counter, const char *text)
{
	if (counter->count++ > 0)
		return;
	counter->first_line = p->rows->line;
	snprintf(counter->first_text, sizeof counter->first_text, "%.47s", text);
	eco_utf8_tame(counter->first_text, "", ' ');
}

enum verdict eco_row_skip(struct eco_positions *p, enum eco_skip why, const char *text)
{
	count_in(p, &p->skipped[why], text);
	return SKIPPED;
}

/* ---- Fields ---- */

const char *eco_row_field(const struct eco_positions *p, uint32_t column)
{
	const char *text = p->column[column] == ECO_COLUMN_OF_Z ? p->z : p->column[column] != ECO_NONE
		? p->rows->fields[p->column[column]] : "";
	while (isspace((unsigned char)*text))
		text++;
	return text;
}

const char *eco_row_shown(const char *text, char *buffer, size_t size)
{
	return eco_text_trim(text, buffer, size);
}

char eco_row_decimal(const struct eco_positions *p)
{
	return p->spec->decimal != 0 ? p->spec->decimal : '.';
}

/* ---- Filters ---- */

static bool passes_filters(struct eco_positions *p)
{
	char text[64];
	for (uint32_t i = 0; i < p->spec->filter_count; i++) {
		const char *value = eco_row_field(p, ECO_COLUMN_FILTERS + i);
		if (p->spec->filters[i].variant_count > 0 || eco_filter_passes(&p->spec->filters[i], value, eco_row_decimal(p)))
			continue;
		count_in(p, &p->filtered[i], eco_row_shown(value, text, sizeof text));
		eco_row_skip(p, ECO_SKIP_FILTERED, text);
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

/* The species' columns as one text. */
static void read_species(struct eco_positions *p)
{
	char part[ECO_SPECIES_BYTES + 1];
	p->said[0] = 0;
	for (uint32_t i = 0; i < ECO_SPECIES_COLUMNS; i++) {
		eco_row_shown(eco_row_field(p, ECO_COLUMN_SPECIES + i), part, sizeof part);
		eco_text_join(p->said, sizeof p->said, part);
	}
}

static bool read_plant(struct eco_positions *p, struct eco_position *record)
{
	const struct eco_species *species = &p->spec->fallback;
	char *text = p->said;
	*text = 0;
	if (p->column[ECO_COLUMN_SPECIES] != ECO_NONE) {
		read_species(p);
		uint32_t key = eco_species_find(p->species, text, p->rows->line);
		if (key < p->spec->map_count)
			species = &p->spec->map[key];
		tidy(text, strlen(text) == ECO_SPECIES_BYTES);
		record->species = eco_text_is_missing(text) ? "" : text;
	}
	record->plant = record->variant_first = species->plant;
	record->variant_count = species->variant_count;
	if (species->plant == ECO_NONE)
		eco_row_skip(p, species->name ? ECO_SKIP_LEFT_OUT : ECO_SKIP_UNKNOWN_SPECIES, text);
	return species->plant != ECO_NONE;
}

/* The plant that "instead" of the scene says, the last one that fits. */
static void take_instead(struct eco_positions *p, struct eco_position *record)
{
	char text[64];
	for (uint32_t i = 0; i < p->spec->filter_count; i++) {
		const struct eco_filter *filter = &p->spec->filters[i];
		const char *value = eco_row_field(p, ECO_COLUMN_FILTERS + i);
		if (filter->variant_count == 0 || eco_filter_passes(filter, value, eco_row_decimal(p)))
			continue;
		record->plant = record->variant_first = filter->plant;
		record->variant_count = filter->variant_count;
		count_in(p, &p->filtered[i], eco_row_shown(value, text, sizeof text));
	}
}

/* ---- Rows for errors ---- */

const char *eco_row_name(const struct eco_positions *p, char *text, size_t size)
{
	unsigned long long number = p->rows->line;
	if (strcmp(p->rows->where, "line") == 0)
		snprintf(text, size, "%.200s:%llu", p->spec->path, number);
	else
		snprintf(text, size, "%.200s, %s %llu", p->spec->path, p->rows->where, number);
	return text;
}

/* ---- Sizes ---- */

static void count_remarks(struct eco_positions *p, uint32_t kinds, const char *text)
{
	char buffer[48];
	eco_row_shown(text, buffer, sizeof buffer);
	for (int kind = ECO_KEPT_RANGE; kind <= ECO_KEPT_IMPLAUSIBLE; kind++)
		if (kinds >> kind & 1)
			eco_row_skip(p, (enum eco_skip)kind, buffer);
}

/* Refuses a size with a decimal comma before any size was understood: all of them would be lost. */
static bool refuse_size(const struct eco_positions *p, const char *text, struct eco_error *error)
{
	double number, unit_m;
	char buffer[48], row[ECO_ROW_NAME];
	if (p->sized || p->spec->decimal != 0 || !strchr(text, ',')
			|| eco_text_size(text, '.', &number, &unit_m) != ECO_FORM_NONE
		|| eco_text_size(text, ',', &number, &unit_m) == ECO_FORM_NONE)
		return false;
	eco_fail(error, ECO_BAD_INPUT, "%s: \"%.40s\" has a comma; add \"decimal\": \",\" to its entry, or "
		"\".\" if this one is no decimal comma", eco_row_name(p, row, sizeof row),
		eco_row_shown(text, buffer, sizeof buffer));
	return true;
}

static enum verdict check_sizes(struct eco_positions *p, struct eco_error *error)
{
	bool refused = false;
	for (uint32_t i = 0; i < ECO_CROWN_COLUMNS && !refused; i++)
		refused = refuse_size(p, eco_row_field(p, ECO_COLUMN_CROWN + i), error);
	for (uint32_t i = 0; i < p->spec->height_count && !refused; i++)
		refused = refuse_size(p, eco_row_field(p, ECO_COLUMN_HEIGHTS + i), error);
	return refused ? FAILED : GOOD;
}

static double read_size(struct eco_positions *p, const struct eco_size *size, uint32_t column,
	const struct eco_size_row *row, double most_m, double plausible_m)
{
	uint32_t remarks = 0;
	const char *text = eco_row_field(p, column);
	double metres = eco_size_read(size, text, eco_row_decimal(p), row, SIZE_MIN_M, most_m, &remarks);
	count_remarks(p, remarks | (uint32_t)(metres > plausible_m) << ECO_KEPT_IMPLAUSIBLE, text);
	p->sized |= !isnan(metres);
	return metres;
}

/* The mean of the columns that say a crown's radius, else half the width of the row's polygon. */
static double read_crown(struct eco_positions *p, const struct eco_size_row *row)
{
	const struct eco_crown *crown = &p->spec->crown;
	const struct eco_size size = { .kind = ECO_SIZE_COLUMN, .unit_m = crown->unit_m, .factor = crown->factor,
		.is_area = crown->is_area };
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t i = 0; i < ECO_CROWN_COLUMNS && crown->columns[i]; i++) {
		double radius = read_size(p, &size, ECO_COLUMN_CROWN + i, row, CROWN_MAX_M, CROWN_PLAUSIBLE_M);
		sum += isnan(radius) ? 0 : radius;
		count += !isnan(radius);
	}
	if (count > 0)
		return sum / count;
	return crown->of_geometry && p->rows->place.width > 0 ? p->rows->place.width / 2 : NAN;
}

/* A guess of a radius from the trunk and the height, by species. */
static double guess_crown(struct eco_positions *p, const struct eco_size_row *row, double height_m, bool measured)
{
	double dbh_m = NAN;
	for (uint32_t i = 0; i < p->spec->height_count && isnan(dbh_m); i++)
		dbh_m = eco_size_trunk(&p->spec->heights[i], eco_row_field(p, ECO_COLUMN_HEIGHTS + i),
			eco_row_decimal(p));
	struct eco_size_row other = { .seed = row->seed + 1, .row = row->row };
	double width = eco_growth_crown(row->plant_of, measured || isnan(dbh_m) ? height_m : NAN, dbh_m) * eco_size_spread(&other, p->spec->crown.spread);
	return round(500 * width) / 1000;
}

/* The crown base, as a share of a measured height. */
static double read_base(const struct eco_positions *p, double height_m)
{
	const struct eco_crown *crown = &p->spec->crown;
	double number, unit_m, share;
	if (!crown->base || eco_text_size(eco_row_field(p, ECO_COLUMN_CROWN_BASE), eco_row_decimal(p), &number, &unit_m)
			== ECO_FORM_NONE)
		return NAN;
	share = crown->base_is_ratio ? 1 - (number > 1 ? number / 100 : number)
		: number * (unit_m != 0 ? unit_m : crown->base_unit_m) / height_m;
	return share >= 0 && share < 1 ? share : NAN;
}

static double read_height(struct eco_positions *p, const struct eco_size_row *row, struct eco_position *record)
{
	static const struct { enum eco_sized sized; const char *from; } kinds[] = {
		[ECO_SIZE_NUMBER] = { ECO_SIZED_NUMBER, "the scene file" }, [ECO_SIZE_COLUMN] = { ECO_SIZED_MEASURED, NULL },
		[ECO_SIZE_DBH] = { ECO_SIZED_TRUNK, "trunk diameter" }, [ECO_SIZE_AGE] = { ECO_SIZED_AGE, "age" },
		[ECO_SIZE_YEAR] = { ECO_SIZED_AGE, "age" } };
	const struct eco_positions_spec *s = p->spec;
	char buffer[48];
	for (uint32_t i = 0; i < s->height_count; i++) {
		double height = read_size(p, &s->heights[i], ECO_COLUMN_HEIGHTS + i, row, HEIGHT_MAX_M,
			HEIGHT_PLAUSIBLE_M);
		if (isnan(height))
			continue;
		p->sizes[kinds[s->heights[i].kind].sized]++;
		record->height_from = kinds[s->heights[i].kind].from;
		return height;
	}
	p->sizes[ECO_SIZED_NOT]++;
	record->height_from = isnan(record->crown_radius_m) ? "the model" : "crown width";
	if (s->height_count > 0)
		eco_row_skip(p, isnan(record->crown_radius_m) ? ECO_KEPT_NO_HEIGHT : ECO_KEPT_BY_CROWN,
			eco_row_shown(eco_row_field(p, ECO_COLUMN_HEIGHTS), buffer, sizeof buffer));
	return NAN;
}

static bool needs_flora(const struct eco_positions_spec *s)
{
	bool needs = s->crown.by_species;
	for (uint32_t i = 0; i < s->height_count; i++)
		needs |= s->heights[i].by_species;
	return needs;
}

static void read_sizes(struct eco_positions *p, struct eco_position *record)
{
	struct eco_size_row row = { .plant = record->plant, .seed = p->spec->seed, .row = p->rows->row,
		.plant_of = { needs_flora(p->spec) ? eco_species_flora(p->species, p->said) : NULL, p->spec->stand } };
	uint64_t guessed = p->sizes[ECO_SIZED_TRUNK] + p->sizes[ECO_SIZED_AGE], measured = p->sizes[ECO_SIZED_MEASURED];
	record->crown_radius_m = read_crown(p, &row);
	record->height_m = read_height(p, &row, record);
	if (p->sizes[ECO_SIZED_MEASURED] > measured || p->spec->crown.base_is_ratio)
		record->base = read_base(p, record->height_m);
	if (!isnan(record->crown_radius_m)) {
		p->sizes[ECO_SIZED_CROWN]++;
	} else if (p->spec->crown.by_species && row.plant_of.flora && !isnan(record->height_m)) {
		record->crown_radius_m = guess_crown(p, &row, record->height_m, p->sizes[ECO_SIZED_MEASURED] > measured);
		record->crown_is_guess = true;
		record->crown_from = record->height_from ? record->height_from : "height";
		p->sizes[ECO_SIZED_CROWN_GUESS]++;
	} else {
		record->crown_from = "the model";
	}
	if (needs_flora(p->spec) && (record->crown_is_guess || p->sizes[ECO_SIZED_TRUNK] + p->sizes[ECO_SIZED_AGE] > guessed))
		p->sizes[ECO_SIZED_BY_SPECIES + eco_growth_rank(row.plant_of)]++;
}

static double read_yaw(struct eco_positions *p)
{
	double yaw;
	if (eco_text_number(eco_row_field(p, ECO_COLUMN_YAW), eco_row_decimal(p), &yaw) && fabs(yaw) <= 1e6)
		return yaw;
	return NAN;
}

static double read_scale(struct eco_positions *p)
{
	double scale;
	bool there = eco_text_number(eco_row_field(p, ECO_COLUMN_SCALE), eco_row_decimal(p), &scale);
	return there && scale >= SCALE_MIN && scale <= SCALE_MAX ? scale : 1;
}

/* A field as the row has it, fit for a pack. */
static const char *read_text(struct eco_positions *p, uint32_t column, char text[ECO_SPECIES_BYTES + 1])
{
	eco_row_shown(eco_row_field(p, column), text, ECO_SPECIES_BYTES + 1);
	tidy(text, strlen(text) == ECO_SPECIES_BYTES);
	return text;
}

/* Empty, too, where a row is short. */
static const char *read_cell(struct eco_positions *p, uint32_t i)
{
	uint32_t column = p->column[ECO_COLUMN_CELLS + i];
	return column < p->rows->field_count && *read_text(p, ECO_COLUMN_CELLS + i, p->cells[i]) ? p->cells[i] : NULL;
}

/* ---- Records ---- */

static enum verdict read_row(struct eco_positions *p, struct eco_position *record, struct eco_error *error)
{
	if (p->rows->field_count < p->fields_needed)
		return eco_row_skip(p, ECO_SKIP_SHORT_ROW, p->rows->field_count > 0 ? p->rows->fields[0] :
		"");
	eco_text_of_z(p->rows, p->z, sizeof p->z);
	uint64_t unknown = p->skipped[ECO_SKIP_UNKNOWN_SPECIES].count;
	bool stays = passes_filters(p) && read_plant(p, record);
	if (stays == p->spec->left_out || (p->spec->left_out && p->skipped[ECO_SKIP_UNKNOWN_SPECIES].count > unknown))
		return SKIPPED;
	enum verdict verdict = eco_positions_place(p, record, error);
	if (verdict == GOOD)
		verdict = check_sizes(p, error);
	if (verdict != GOOD)
		return verdict;
	if (p->spec->left_out) {
		record->plant = 0;
		return GOOD;
	}
	take_instead(p, record);
	read_sizes(p, record);
	record->yaw_deg = read_yaw(p);
	record->scale = read_scale(p);
	if (p->spec->tint.column)
		record->tint = read_text(p, ECO_COLUMN_TINT, p->tint);
	for (uint32_t i = 0; i < p->spec->cell_count; i++)
		record->cells[i] = read_cell(p, i);
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
			.base = NAN, .scale = 1 };
		if (code != ECO_OK || p->ended)
			return code;
		if (more) {
			verdict = read_row(p, record, error);
		} else {
			p->ended = true;
			return p->spec->left_out ? ECO_OK : eco_positions_check_places(p, error);
		}
	}
	return verdict == GOOD ? ECO_OK : error ? error->code : ECO_BAD_INPUT;
}

/* ---- Columns ---- */

/* A guess at the column that holds a coordinate, for a message only; "...": none. */
static const char *likely_column(const struct eco_rows *rows, enum eco_role role)
{
	const char *likely = "...";
	int best = ECO_COLUMN_ENOUGH - 1;
	for (uint32_t i = 0; i < rows->column_count; i++) {
		int points = eco_column_points(role, rows->columns[i]);
		likely = points > best ? rows->columns[i] : likely;
		best = points > best ? points : best;
	}
	return likely;
}

static enum eco_code no_coordinates(const struct eco_positions *p, struct eco_error *error)
{
	char there[200];

	eco_rows_list_columns(p->rows, there, sizeof there);
	return eco_fail(error, ECO_BAD_INPUT, "%.120s: it has no geometry, so its entry must name the "
		"columns with easting or longitude and northing "
		"or latitude: add \"x\": \"%.40s\", \"y\": \"%.40s\"; there are: %s", p->spec->path,
		likely_column(p->rows, ECO_ROLE_X), likely_column(p->rows, ECO_ROLE_Y), there);
}

/* Names that say another unit than the metres which are meant without a CRS of the entry. */
static enum eco_code check_unit(const struct eco_positions_spec *s, struct eco_error *error)
{
	double metres = 1;
	const char *unit = s->unit_m == 0 && !s->crs && s->x ? eco_unit_of_place(s->x, s->y, &metres) : NULL;
	if (metres == 1)
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT, "%.200s: \"%.40s\" and \"%.40s\" say %s, and coordinates "
		"without a CRS are in metres; add \"unit\": \"%s\" to its entry (\"m\" if they are), or its "
		"\"crs\"", s->path, s->x, s->y, unit, unit);
}

/* The names of columns by their use; NULL: not needed. */
static void name_columns(const struct eco_positions_spec *s, const char *names[ECO_COLUMN_COUNT])
{
	const char *const fixed[ECO_COLUMN_HEIGHTS] = { s->x, s->y, s->z, s->species[0], s->species[1],
		s->species[2], s->yaw_deg, s->scale, s->crown.columns[0], s->crown.columns[1], s->crown.columns[2],
		s->crown.columns[3], s->crown.base, s->quadrat.column, s->polar.azimuth, s->polar.distance, s->tint.column };
	memset(names, 0, ECO_COLUMN_COUNT * sizeof *names);
	memcpy(names, fixed, sizeof fixed);
	for (uint32_t i = 0; i < s->height_count; i++)
		names[ECO_COLUMN_HEIGHTS + i] = s->heights[i].column;
	for (uint32_t i = 0; i < s->filter_count; i++)
		names[ECO_COLUMN_FILTERS + i] = s->filters[i].column;
	for (uint32_t i = 0; i < s->cell_count; i++)
		names[ECO_COLUMN_CELLS + i] = s->cells[i];
}

static enum eco_code find_columns(struct eco_positions *p, const char *names[ECO_COLUMN_COUNT],
	struct eco_error *error)
{
	const struct eco_positions_spec *s = p->spec;
	struct eco_error absent = { 0 };         /* a column of cells: they are empty */
	bool geometry_z = s->z && strcmp(s->z, "geometry") == 0 && p->rows->has_geometry;
	enum eco_code code = check_unit(s, error);
	p->from_geometry = p->rows->has_geometry && !s->x;
	p->at_origin = !s->x && !p->rows->has_geometry && s->polar.azimuth;
	if (!s->x && !p->rows->has_geometry && !p->at_origin)
		return no_coordinates(p, error);
	if (geometry_z && (!p->from_geometry || !p->rows->has_z))
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: \"z\": \"geometry\", but %s; leave \"z\" out, "
			"and the plants stand on the ground", p->spec->path, p->from_geometry
			? "its points have no heights" : "its coordinates come from columns");
	p->use_z = s->z != NULL;
	p->fields_needed = 0;
	names[ECO_COLUMN_Z] = geometry_z ? NULL : s->z;
	for (int i = ECO_COLUMN_CELLS; i < ECO_COLUMN_COUNT; i++)
		if (eco_rows_find_column(p->rows, s->path, names[i], &p->column[i], &absent))
			p->column[i] = ECO_NONE;
	for (int i = 0; code == ECO_OK && i < ECO_COLUMN_CELLS; i++) {
		bool of_z = i >= ECO_COLUMN_HEIGHTS && i < ECO_COLUMN_FILTERS && names[i] && p->rows->has_z
			&& strcmp(names[i], ECO_COLUMN_GEOMETRY) == 0;
		if (of_z) {
			p->column[i] = ECO_COLUMN_OF_Z;
			continue;
		}
		code = eco_rows_find_column(p->rows, s->path, names[i], &p->column[i], error);
		if (p->column[i] != ECO_NONE && p->column[i] >= p->fields_needed)
			p->fields_needed = p->column[i] + 1;
	}
	return code;
}

static enum eco_code open_crs(struct eco_positions *p, struct eco_error *error)
{
	const struct eco_rows *rows = p->rows;
	struct eco_crs_request request = { .path = p->spec->path, .stated = p->spec->crs,
		.vertical = p->spec->vertical, .of_file = p->from_geometry ? rows->crs : NULL,
		.no_crs_says = p->from_geometry ? rows->no_crs : NULL, .use_z = p->use_z, .frame = &p->frame,
		.note = eco_rows_note, .ctx = p->rows };
	if (p->from_geometry && rows->degrees_doubted && !p->spec->crs)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: its numbers cannot be degrees, which this "
			"format means unless it says otherwise; add \"crs\": \"%.80s\" to its entry, or the "
			"CRS that they are in", p->spec->path, p->frame.crs ? p->frame.crs : "EPSG:...");
	return eco_crs_open(&p->crs, &request, error);
}

static void close_parts(struct eco_positions *p)
{
	eco_rows_close(p->rows);
	eco_crs_close(p->crs);
	eco_species_close(p->species);
	free(p->places.slots);
}

/* Begins at the first row, without anything counted. */
static enum eco_code start(struct eco_positions *p, struct eco_error *error)
{
	const char *names[ECO_COLUMN_COUNT], *wanted[ECO_COLUMN_COUNT];
	struct eco_rows_source source = { .path = p->spec->path, .layer = p->spec->layer,
		.separator = p->spec->separator, .wanted = wanted, .crowns = p->spec->crown.of_geometry };
	close_parts(p);
	*p = (struct eco_positions){ .spec = p->spec, .frame = p->frame, .levels = p->levels,
		.levelled = p->levelled, .low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY },
		.nearest_m = INFINITY, .species = eco_species_open(p->spec) };
	name_columns(p->spec, names);
	for (int i = 0; i < ECO_COLUMN_COUNT; i++)
		if (names[i])
			wanted[source.wanted_count++] = names[i];
	ECO_PASS(eco_rows_open(&p->rows, &source, error));
	ECO_PASS(find_columns(p, names, error));
	return open_crs(p, error);
}

static enum eco_code find_levels(struct eco_positions *p, struct eco_error *error)
{
	struct eco_position record;
	enum eco_code code;
	do {
		code = read_record(p, &record, error);
		if (code == ECO_OK && record.plant != ECO_NONE && !isnan(record.height_m))
			eco_levels_count(&p->levels, record.plant, record.height_m);
	} while (code == ECO_OK && record.plant != ECO_NONE);
	if (code)
		return code;
	eco_levels_make(&p->levels, p->spec->levels);
	p->levelled = true;
	return start(p, error);
}

/* ---- The reader ---- */

enum eco_code eco_positions_open(struct eco_positions **reader, const struct eco_positions_spec *spec,
	const struct eco_frame *frame, struct eco_error *error)
{
	struct eco_positions *p = eco_alloc(1, sizeof *p);
	p->spec = spec;
	p->frame = *frame;
	enum eco_code code = spec->height_count > ECO_HEIGHT_SOURCES_MAX
		|| spec->filter_count > ECO_FILTERS_MAX
		? eco_fail(error, ECO_TOO_LARGE, "%.200s: too many columns of heights or filters", spec->path)
		: start(p, error);
	*reader = code ? NULL : p;
	if (code)
		eco_positions_close(p);
	return code;
}

enum eco_code eco_positions_next(struct eco_positions *reader, struct eco_position *record,
	struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	if (!error)
		error = &own;
	enum eco_code code = reader->spec->levels > 0 && !reader->levelled ? find_levels(reader, error)
		: ECO_OK;
	if (!code)
		code = read_record(reader, record, error);
	if (code != ECO_OK || record->plant == ECO_NONE)
		return code;
	if (reader->levelled && !isnan(record->height_m))
		record->height_m = eco_levels_height(&reader->levels, record->plant, record->height_m);
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

bool eco_positions_has_cell(const struct eco_positions *reader, uint32_t cell)
{
	return reader->column[ECO_COLUMN_CELLS + cell] != ECO_NONE;
}

bool eco_positions_has_lines(const struct eco_positions *reader)
{
	return strcmp(reader->rows->where, "line") == 0;
}

void eco_positions_close(struct eco_positions *reader)
{
	if (!reader)
		return;
	close_parts(reader);
	eco_levels_free(&reader->levels);
	free(reader);
}
