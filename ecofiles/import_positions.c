/* From rows of texts to plants in the scene: species to plant, coordinates through PROJ, heights, yaw. Formats are behind rows.h.
 *
 * Heights and converted coordinates are rounded to the millimetre, so that exp() and PROJ, which differ between machines in their
 * last bits, do not decide a bit of a pack.
 *
 * Levels: a plant's heights are divided between their least and greatest in equal ratios, and each takes the mean of its class: the
 * relative error is bounded, so that the few tall trees among many shrubs keep their height (classes of equal counts would
 * average them away). The file is read once before for that, into counts per centimetre. */
#include "ecofiles/positions.h"

#include <ctype.h>
#include <math.h>
#include <proj.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/mix.h"
#include "ecofiles/model.h"
#include "ecofiles/rows.h"

#define DISTANCE_MAX_M 1e7
#define HEIGHT_MIN_M 0.01
#define HEIGHT_MAX_M 300.0
#define BINS 30001u                  /* centimetres */
#define LEVEL_PLANTS_MAX 4096u

const char *const eco_skip_names[ECO_SKIP_COUNT] = {
	[ECO_SKIP_NO_COORDINATES] = "no coordinates",
	[ECO_SKIP_BAD_NUMBER] = "a coordinate that is not a number",
	[ECO_SKIP_OUTSIDE] = "outside the CRS or too far from the origin",
	[ECO_SKIP_UNKNOWN_SPECIES] = "a species that the map does not have",
	[ECO_SKIP_LEFT_OUT] = "left out by the map",
	[ECO_SKIP_SHORT_ROW] = "too few fields",
	[ECO_SKIP_NO_HEIGHT] = "no usable height",
};

enum column { X, Y, Z, SPECIES, HEIGHT, YAW, COLUMNS };

struct levels { uint32_t plant, *bin; };     /* bin[cm]: first a count, then the height taken instead, in cm */

struct eco_positions {
	const struct eco_positions_spec *spec;
	struct eco_frame frame;
	struct eco_rows *rows;
	uint32_t column[COLUMNS], fields_needed;
	PJ_CONTEXT *context;
	PJ *conversion;                      /* NULL: none */
	struct eco_skipped skipped[ECO_SKIP_COUNT];
	struct levels *levels;
	uint32_t levels_count;
};

/* ---- Columns ---- */

static enum eco_code missing_column(const struct eco_positions *p, const char *name, struct eco_error *error)
{
	char there[300] = "";
	size_t used = 0;

	for (uint32_t i = 0; i < p->rows->column_count && used < sizeof there; i++)
		used += (size_t)snprintf(there + used, sizeof there - used, "%s%s", i > 0 ? ", " : "", p->rows->columns[i]);
	return eco_fail(error, ECO_BAD_INPUT, "%.120s: no column \"%.60s\"; there are: %s%s", p->spec->path, name, there,
		p->rows->column_count == 1 ? " (is \"separator\" another?)" : "");
}

static enum eco_code find_column(struct eco_positions *p, enum column which, const char *name, struct eco_error *error)
{
	p->column[which] = ECO_NONE;
	if (name == NULL)
		return ECO_OK;
	for (uint32_t i = 0; i < p->rows->column_count; i++) {
		if (strcmp(p->rows->columns[i], name) != 0)
			continue;
		if (p->column[which] != ECO_NONE)
			return eco_fail(error, ECO_BAD_INPUT, "%.200s: two columns are named \"%.60s\"", p->spec->path, name);
		p->column[which] = i;
	}
	if (p->column[which] == ECO_NONE)
		return missing_column(p, name, error);
	if (p->column[which] >= p->fields_needed)
		p->fields_needed = p->column[which] + 1;
	return ECO_OK;
}

static enum eco_code open_rows(struct eco_positions *p, struct eco_error *error)
{
	const struct eco_positions_spec *s = p->spec;
	const char *names[COLUMNS] = { s->x, s->y, s->z, s->species, s->height_column, s->yaw_deg };
	enum eco_code code;

	eco_rows_close(p->rows);
	code = eco_rows_open(&p->rows, s, error);
	for (int i = 0; code == ECO_OK && i < COLUMNS; i++)
		code = find_column(p, (enum column)i, names[i], error);
	return code;
}

/* ---- CRS ---- */

static enum eco_code check_metric(struct eco_positions *p, struct eco_error *error)
{
	PJ *crs = proj_create(p->context, p->frame.crs), *flat, *axes = NULL;
	double unit = 0;
	enum eco_code code = ECO_OK;

	if (crs == NULL || !proj_is_crs(crs)) {
		proj_destroy(crs);
		return eco_fail(error, ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not known; write a code such as \"EPSG:26917\"", p->frame.crs);
	}
	flat = proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS ? proj_crs_get_sub_crs(p->context, crs, 0) : proj_clone(p->context, crs);
	if (flat != NULL && proj_get_type(flat) == PJ_TYPE_PROJECTED_CRS)
		axes = proj_crs_get_coordinate_system(p->context, flat);
	if (axes == NULL || !proj_cs_get_axis_info(p->context, axes, 0, NULL, NULL, NULL, &unit, NULL, NULL, NULL) || fabs(unit - 1) > 1e-9)
		code = eco_fail(error, ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not one in metres; take a projected one such as the UTM zone, "
			"\"EPSG:32617\"", p->frame.crs);
	proj_destroy(axes);
	proj_destroy(flat);
	proj_destroy(crs);
	return code;
}

static enum eco_code open_conversion(struct eco_positions *p, struct eco_error *error)
{
	const char *from = p->spec->crs;
	PJ *raw;

	if (p->frame.crs == NULL && from == NULL)
		return ECO_OK;
	if (p->frame.crs == NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s is in %.80s, but the scene has no CRS; add \"crs\": \"%.80s\" and \"origin\" to the scene",
			p->spec->path, from, from);
	if (from == NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: its CRS is not stated; add \"crs\": \"%.80s\" to its entry if it is the scene's",
			p->spec->path, p->frame.crs);
	p->context = proj_context_create();
	if (p->context == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	proj_log_level(p->context, PJ_LOG_NONE);
	if (check_metric(p, error) != ECO_OK)
		return ECO_BAD_INPUT;
	if (strcasecmp(from, p->frame.crs) == 0)
		return ECO_OK;
	raw = proj_create_crs_to_crs(p->context, from, p->frame.crs, NULL);
	p->conversion = raw != NULL ? proj_normalize_for_visualization(p->context, raw) : NULL;
	proj_destroy(raw);
	if (p->conversion == NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: no conversion from CRS \"%.80s\" to \"%.80s\": %.100s", p->spec->path, from, p->frame.crs,
			proj_context_errno_string(p->context, proj_context_errno(p->context)));
	return ECO_OK;
}

/* ---- Fields ---- */

static const char *field(const struct eco_positions *p, enum column which)
{
	const char *text = p->rows->fields[p->column[which]];

	while (isspace((unsigned char)*text))
		text++;
	return text;
}

static size_t trimmed_length(const char *text)
{
	size_t length = strlen(text);

	while (length > 0 && isspace((unsigned char)text[length - 1]))
		length--;
	return length;
}

static bool is_missing(const char *text)
{
	static const char *const words[] = { "", "NA", "N/A", "NaN", "null", "-" };
	size_t length = trimmed_length(text);

	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (strlen(words[i]) == length && strncasecmp(text, words[i], length) == 0)
			return true;
	return false;
}

/* Decimal numbers only: strtod alone would also take hexadecimal, "inf" and "nan". */
static bool parse_number(const char *text, double *number)
{
	size_t length = trimmed_length(text);
	char *end;

	if (length == 0 || length > 64 || strspn(text, "0123456789+-.eE") < length)
		return false;
	*number = strtod(text, &end);
	return end == text + length && isfinite(*number);
}

static double to_millimetres(double metres)
{
	return floor(metres * 1000 + 0.5) / 1000;
}

static void count(struct eco_positions *p, enum eco_skip why, const char *text)
{
	struct eco_skipped *s = &p->skipped[why];

	if (s->count++ > 0)
		return;
	s->first_line = p->rows->line;
	snprintf(s->first_text, sizeof s->first_text, "%.47s", text);
	for (char *c = s->first_text; *c != 0; c++)
		if (iscntrl((unsigned char)*c))
			*c = ' ';
}

/* ---- Parts of a record: each returns false when the row was counted as skipped ---- */

static const struct eco_species *find_species(const struct eco_positions *p, const char *text, size_t length)
{
	uint32_t low = 0, high = p->spec->map_count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		const char *name = p->spec->map[middle].name;
		int order = strncmp(name, text, length);

		if (order == 0 && name[length] == 0)
			return &p->spec->map[middle];
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return &p->spec->fallback;
}

static bool read_plant(struct eco_positions *p, struct eco_position *record, uint32_t *variants)
{
	const struct eco_species *species = &p->spec->fallback;
	const char *text = "";

	if (p->column[SPECIES] != ECO_NONE) {
		text = field(p, SPECIES);
		species = find_species(p, text, trimmed_length(text));
	}
	record->plant = species->plant;
	*variants = species->variant_count;
	if (species->plant == ECO_NONE)
		count(p, species->name != NULL ? ECO_SKIP_LEFT_OUT : ECO_SKIP_UNKNOWN_SPECIES, text);
	return species->plant != ECO_NONE;
}

static bool read_coordinate(struct eco_positions *p, enum column which, double *number)
{
	const char *text = field(p, which);

	if (is_missing(text)) {
		count(p, ECO_SKIP_NO_COORDINATES, text);
		return false;
	}
	if (!parse_number(text, number)) {
		count(p, ECO_SKIP_BAD_NUMBER, text);
		return false;
	}
	return true;
}

static bool read_place(struct eco_positions *p, struct eco_position *record)
{
	double xyz[3] = { 0, 0, 0 };

	record->absolute = p->column[Z] != ECO_NONE;
	if (!read_coordinate(p, X, &xyz[0]) || !read_coordinate(p, Y, &xyz[1]) || (record->absolute && !read_coordinate(p, Z, &xyz[2])))
		return false;
	if (p->conversion != NULL) {
		PJ_COORD to = proj_trans(p->conversion, PJ_FWD, proj_coord(xyz[0], xyz[1], 0, HUGE_VAL));

		xyz[0] = to_millimetres(to.xy.x);
		xyz[1] = to_millimetres(to.xy.y);
	}
	for (int k = 0; k < 3; k++) {
		record->at[k] = k < 2 || record->absolute ? xyz[k] - p->frame.origin[k] : 0;
		if (!(fabs(record->at[k]) <= DISTANCE_MAX_M)) {
			count(p, ECO_SKIP_OUTSIDE, field(p, (enum column)k));
			return false;
		}
	}
	return true;
}

static double read_height(struct eco_positions *p)
{
	const struct eco_positions_spec *s = p->spec;
	double number, height;

	if (s->height == ECO_HEIGHT_NONE)
		return NAN;
	if (s->height == ECO_HEIGHT_NUMBER)
		return s->height_value_m;
	if (!parse_number(field(p, HEIGHT), &number) || !(number > 0)) {
		count(p, ECO_SKIP_NO_HEIGHT, field(p, HEIGHT));
		return NAN;
	}
	height = number * s->unit_m;
	if (s->height == ECO_HEIGHT_DBH)
		height = 1.3 + (s->max_m - 1.3) * (1 - exp(-s->rate * height));
	height = to_millimetres(height);
	if (!(height >= HEIGHT_MIN_M && height <= HEIGHT_MAX_M)) {
		count(p, ECO_SKIP_NO_HEIGHT, field(p, HEIGHT));
		return NAN;
	}
	return height;
}

static double read_yaw(struct eco_positions *p)
{
	double yaw;

	if (p->column[YAW] != ECO_NONE && parse_number(field(p, YAW), &yaw) && fabs(yaw) <= 1e6)
		return yaw;
	return eco_mix_turn(p->spec->seed, p->rows->row) * (360.0 / 65536);
}

/* The next usable row; *variants: how many models its plant may take. */
static enum eco_code read_record(struct eco_positions *p, struct eco_position *record, uint32_t *variants, struct eco_error *error)
{
	for (;;) {
		bool more;
		enum eco_code code = p->rows->next(p->rows, &more, error);

		*record = (struct eco_position){ .plant = ECO_NONE, .height_m = NAN };
		if (code != ECO_OK || !more)
			return code;
		if (p->rows->field_count < p->fields_needed) {
			count(p, ECO_SKIP_SHORT_ROW, p->rows->fields[0]);
			continue;
		}
		if (!read_plant(p, record, variants) || !read_place(p, record))
			continue;
		record->height_m = read_height(p);
		record->yaw_deg = read_yaw(p);
		record->row = p->rows->row;
		record->line = p->rows->line;
		return ECO_OK;
	}
}

/* ---- Levels ---- */

static uint32_t centimetres(double height_m)
{
	return (uint32_t)(height_m * 100 + 0.5);
}

static struct levels *levels_of(const struct eco_positions *p, uint32_t plant)
{
	for (uint32_t i = 0; i < p->levels_count; i++)
		if (p->levels[i].plant == plant)
			return &p->levels[i];
	return NULL;
}

static enum eco_code count_height(struct eco_positions *p, const struct eco_position *record, struct eco_error *error)
{
	struct levels *l = levels_of(p, record->plant);

	if (l == NULL) {
		if (p->levels_count == LEVEL_PLANTS_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "%.200s: \"levels\" works for up to %u plants", p->spec->path, LEVEL_PLANTS_MAX);
		l = &p->levels[p->levels_count];
		*l = (struct levels){ record->plant, calloc(BINS, sizeof *l->bin) };
		if (l->bin == NULL)
			return eco_fail(error, ECO_NO_MEMORY, "%.200s: out of memory", p->spec->path);
		p->levels_count++;
	}
	l->bin[centimetres(record->height_m)]++;
	return ECO_OK;
}

/* Replaces the counts of [first, end) by the mean height there. */
static void average(uint32_t *bin, uint32_t first, uint32_t end)
{
	uint64_t sum = 0, members = 0, mean;

	for (uint32_t i = first; i < end; i++) {
		sum += (uint64_t)bin[i] * i;
		members += bin[i];
	}
	mean = members > 0 ? (sum + members / 2) / members : 0;
	for (uint32_t i = first; i < end; i++)
		bin[i] = (uint32_t)mean;
}

static void make_levels(uint32_t *bin, uint32_t levels)
{
	uint32_t low = 0, high = BINS - 1, first;

	while (low < BINS - 1 && bin[low] == 0)
		low++;
	while (high > low && bin[high] == 0)
		high--;
	first = low;
	for (uint32_t i = 1; i <= levels; i++) {
		uint32_t end = i == levels ? high + 1 : (uint32_t)(low * pow((double)high / low, (double)i / levels) + 0.5);

		if (end <= first)
			continue;
		average(bin, first, end);
		first = end;
	}
}

static enum eco_code find_levels(struct eco_positions *p, struct eco_error *error)
{
	struct eco_position record;
	uint32_t variants;
	enum eco_code code;

	p->levels = calloc(LEVEL_PLANTS_MAX, sizeof *p->levels);
	if (p->levels == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.200s: out of memory", p->spec->path);
	do {
		code = read_record(p, &record, &variants, error);
		if (code == ECO_OK && record.plant != ECO_NONE && !isnan(record.height_m))
			code = count_height(p, &record, error);
	} while (code == ECO_OK && record.plant != ECO_NONE);
	if (code != ECO_OK)
		return code;
	for (uint32_t i = 0; i < p->levels_count; i++)
		make_levels(p->levels[i].bin, p->spec->levels);
	memset(p->skipped, 0, sizeof p->skipped);
	return open_rows(p, error);
}

/* ---- The reader ---- */

enum eco_code eco_positions_open(struct eco_positions **reader, const struct eco_positions_spec *spec,
	const struct eco_frame *frame, struct eco_error *error)
{
	struct eco_positions *p = calloc(1, sizeof *p);
	enum eco_code code;

	*reader = NULL;
	if (p == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	p->spec = spec;
	p->frame = *frame;
	code = open_rows(p, error);
	if (code == ECO_OK)
		code = open_conversion(p, error);
	if (code == ECO_OK && spec->levels > 0 && (spec->height == ECO_HEIGHT_COLUMN || spec->height == ECO_HEIGHT_DBH))
		code = find_levels(p, error);
	if (code == ECO_OK)
		*reader = p;
	else
		eco_positions_close(p);
	return code;
}

enum eco_code eco_positions_next(struct eco_positions *reader, struct eco_position *record, struct eco_error *error)
{
	uint32_t variants = 1;
	enum eco_code code = read_record(reader, record, &variants, error);
	const struct levels *levels;

	if (code != ECO_OK || record->plant == ECO_NONE)
		return code;
	levels = isnan(record->height_m) ? NULL : levels_of(reader, record->plant);
	if (levels != NULL && levels->bin[centimetres(record->height_m)] > 0)
		record->height_m = levels->bin[centimetres(record->height_m)] / 100.0;
	record->plant += eco_mix_variant(reader->spec->seed, record->row, variants);
	return ECO_OK;
}

const struct eco_skipped *eco_positions_skipped(const struct eco_positions *reader, uint64_t *rows)
{
	if (rows != NULL)
		*rows = reader->rows->row;
	return reader->skipped;
}

void eco_positions_close(struct eco_positions *reader)
{
	if (reader == NULL)
		return;
	for (uint32_t i = 0; i < reader->levels_count; i++)
		free(reader->levels[i].bin);
	free(reader->levels);
	eco_rows_close(reader->rows);
	proj_destroy(reader->conversion);
	if (reader->context != NULL)
		proj_context_destroy(reader->context);
	free(reader);
}
