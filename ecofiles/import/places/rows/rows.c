/* Chooses a file's reader: by its first bytes, else by the name's extension. */
#include "ecofiles/import/places/rows/rows.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <math.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/inventory_text.h"

#define HEAD_BYTES 65536u

struct head { unsigned char bytes[HEAD_BYTES + 1]; size_t size; };

void eco_rows_list_columns(const struct eco_rows *rows, char *text, size_t size)
{
	*text = 0;
	for (uint32_t i = 0; i < rows->column_count; i++)
		eco_phrase_add(text, size, rows->columns[i]);
}

enum eco_code eco_rows_find_column(const struct eco_rows *rows, const char *path, const char *name,
	uint32_t *column, struct eco_error *error)
{
	char there[300];
	*column = ECO_NONE;
	for (uint32_t i = 0; name && i < rows->column_count; i++) {
		if (strcmp(rows->columns[i], name) != 0)
			continue;
		if (*column != ECO_NONE)
			return eco_fail(error, ECO_BAD_INPUT, "%.200s: two columns are named \"%.60s\"", path,
				name);
		*column = i;
	}
	if (!name || *column != ECO_NONE)
		return ECO_OK;
	eco_rows_list_columns(rows, there, sizeof there);
	return eco_fail(error, ECO_BAD_INPUT, "%.120s: no column \"%.60s\"; there are: %s%s", path, name,
		there, rows->column_count == 1 ? " (is \"separator\" another?)" : "");
}

static bool has_extension(const char *path, const char *const *extensions)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
	for (; *extensions; extensions++)
		if (dot ? strcasecmp(dot + 1, *extensions) == 0 : **extensions == 0)
			return true;
	return false;
}

static bool holds(const struct head *head, const char *text)
{
	return memmem(head->bytes, head->size, text, strlen(text));
}

static enum eco_code read_head(const char *path, struct head *head, struct eco_error *error)
{
	static const char *const zips[] = { "xlsx", "ods", "kmz", NULL },
		*const shapes[] = { "shx", "prj", "cpg", "sbn", "sbx", "qix", NULL };
	struct stat file;
	if (stat(path, &file) != 0)
		return eco_fail_read(error, path, errno);
	if (S_ISDIR(file.st_mode)) {         /* a file geodatabase */
		head->size = 0;
		return has_extension(path, (const char *const[]){ "gdb", NULL }) ? ECO_OK
			: eco_fail(error, ECO_BAD_INPUT, "%.300s: it is a folder; name a file in it", path);
	}
	if (!S_ISREG(file.st_mode))
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: it is not a file", path);
	FILE *in = fopen(path, "rb");
	if (!in)
		return eco_fail_read(error, path, errno);
	head->size = fread(head->bytes, 1, HEAD_BYTES, in);
	head->bytes[head->size] = 0;
	fclose(in);
	if (head->size > 8 && memcmp(head->bytes, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", 8) == 0)
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: a workbook of an old Excel (.xls); save it "
			"as \"CSV UTF-8\" or .xlsx", path);
	if (!has_extension(path, zips) && head->size > 4 && memcmp(head->bytes, "PK\3\4", 4) == 0
			&& holds(head, "[Content_Types].xml"))
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: an Excel workbook; give it its name .xlsx, "
			"or save it as \"CSV UTF-8\"", path);
	if (has_extension(path, shapes))
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: a part of a Shapefile; name the one that "
			"ends in .shp", path);
	return eco_file_check_head(path, (const char *)head->bytes, head->size, has_extension(path, zips),
		"a table", error);
}

/* The first byte that is neither a space nor part of a byte order mark. */
static unsigned char first_sign(const struct head *head)
{
	size_t at = head->size >= 3 && memcmp(head->bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	while (at < head->size && strchr(" \t\r\n", head->bytes[at]) && head->bytes[at] != 0)
		at++;
	return at < head->size ? head->bytes[at] : 0;
}

static bool is_utf16(const struct head *head)
{
	if (head->size >= 2
		&& (memcmp(head->bytes, "\xff\xfe", 2) == 0 || memcmp(head->bytes, "\xfe\xff", 2) == 0))
		return true;
	return head->size >= 4
		&& ((head->bytes[1] == 0 && head->bytes[3] == 0 && head->bytes[0] >= ' '
		&& head->bytes[2] >= ' ' && head->bytes[0] < 127)
		|| (head->bytes[0] == 0 && head->bytes[2] == 0 && head->bytes[1] >= ' '
		&& head->bytes[1] < 127));
}

static bool is_text(const struct head *head)
{
	return head->size > 0 && !memchr(head->bytes, 0, head->size);
}

/* Without GDAL an unknown text is taken for a CSV. */
static bool ogr_knows(const char *path)
{
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, NULL);
	return gdal && gdal->rows_knows(path);
}

static enum eco_code open_ogr(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error)
{
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	return !gdal ? ECO_NOT_FOUND : gdal->rows_open(rows, source, error);
}

enum eco_code eco_rows_open_here(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error)
{
	static const char *const csv_names[] = { "csv", "tsv", "txt", "psv", "dat", "asc", "", NULL },
		*const tab[] = { "tab", NULL }, *const binary[] = { "xlsx", "ods", "kmz", "gpkg", "sqlite", "fgb",
		"shp", "parquet", NULL };
	static const char *const gltf_names[] = { "gltf", "glb", NULL };
	struct head *head = eco_alloc(1, sizeof *head);
	*rows = NULL;
	enum eco_code code = read_head(source->path, head, error);
	unsigned char sign = first_sign(head);
	if (code)
		;
	else if (head->size > 4 && memcmp(head->bytes, "PAR1", 4) == 0 && !ogr_knows(source->path))
		code = eco_fail(error, ECO_UNSUPPORTED,
			"%.300s: it cannot be read: the installed GDAL has no driver for "
			"Parquet; export GeoPackage, GeoJSON or CSV", source->path);
	else if (has_extension(source->path, gltf_names))
		code = eco_fail(error, ECO_UNSUPPORTED,
			"%.300s: glTF is a model, not a table: export the instances of its "
			"scene as CSV with x, y, yaw_deg and scale", source->path);
	else if (is_utf16(head))
		code = eco_fail(error, ECO_UNSUPPORTED, "%.300s: its text is UTF-16; save it as UTF-8 "
			"(\"CSV UTF-8\" in Excel)", source->path);
	else if (sign == '{' && (holds(head, "\"CityJSON\"") || holds(head, "\"CityJSONFeature\"")))
		code = eco_fail(error, ECO_UNSUPPORTED, "%.300s: CityJSON is not read; convert it to "
			"CityGML, or its trees to GeoJSON or CSV", source->path);
	else if ((sign == '{' || sign == '[') && !holds(head, "\"type\"") && !holds(head, "\"esri"))
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: JSON, but not GeoJSON, whose features say "
			"\"type\": \"Feature\"; export GeoJSON or CSV", source->path);
	else if (sign == '{' || sign == '[' || sign == '<' || !is_text(head))
		code = open_ogr(rows, source, error);
	else if (has_extension(source->path, binary) && !memchr(head->bytes, '\n', head->size))
		code = eco_fail(error, ECO_DAMAGED,
			"%.300s: it cannot be read: by its name it is binary, and it begins as "
			"text, \"%.20s\"; copy, download or export it again", source->path,
			(char *)head->bytes);
	else if (has_extension(source->path, csv_names)
			|| (has_extension(source->path, tab) && memcmp(head->bytes, "!table", 6) != 0)
		|| (!has_extension(source->path, tab) && !ogr_knows(source->path)))
		code = eco_rows_open_csv(rows, source->path, source->separator, error);
	else
		code = open_ogr(rows, source, error);
	free(head);
	if (code == ECO_OK && source->layer && strcmp((*rows)->where, "feature") != 0)
		eco_rows_note(*rows, "it is one table; \"layer\" says nothing");
	if (code == ECO_OK && source->areas
			&& (!(*rows)->has_geometry || strcmp((*rows)->where, "feature") != 0)) {
		eco_rows_close(*rows);
		*rows = NULL;
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: no polygons in it; take GeoJSON, a "
			"GeoPackage or a Shapefile", source->path);
	}
	return code;
}

void eco_rows_close(struct eco_rows *rows)
{
	if (rows)
		rows->close(rows);
}

void eco_text_of_z(const struct eco_rows *rows, char *text, size_t size)
{
	bool there = rows->place.kind == ECO_PLACE_POINT && !isnan(rows->place.at[2]);
	snprintf(text, size, there ? "%.10g" : "", rows->place.at[2]);
}

/* ---- For readers ---- */

void eco_rows_note(void *rows, const char *format, ...)
{
	struct eco_rows *r = rows;
	char text[400];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	for (uint32_t i = 0; i < r->note_count; i++)
		if (strcmp(r->notes[i], text) == 0)
			return;
	if (r->note_count < ECO_ROWS_NOTES_MAX)
		r->notes[r->note_count++] = eco_copy_text(text);
}

void eco_rows_free_texts(struct eco_rows *rows)
{
	for (uint32_t i = 0; i < rows->column_count; i++)
		free(rows->columns[i]);
	for (uint32_t i = 0; i < rows->note_count; i++)
		free(rows->notes[i]);
	eco_free(rows->columns, rows->fields, rows->crs);
}

/* ---- Points as text ---- */

#define DEGREE_DIGITS 6
#define PLANT_DEG 0.1                /* wider polygons of small numbers are in metres: they hold one plant */

/* The middle of the first ring, "((11 48, 12 48, ...", and the width of the disc of its area. */
static bool read_ring(const char *text, double at[3], double *width)
{
	double first[2], last[2], now[2], sum[2] = { 0, 0 }, area = 0;
	int count = 0;
	for (text += strspn(text, "( ZzMm"); sscanf(text, "%lf %lf", &now[0], &now[1]) == 2; count++) {
		if (count == 0)
			memcpy(first, now, sizeof first);
		else {                           /* from the first corner, as its coordinates may be large */
			double cross = (last[0] - first[0]) * (now[1] - first[1]) - (now[0] - first[0]) * (last[1] - first[1]);
			area += cross / 2;
			for (int k = 0; k < 2; k++)
				sum[k] += cross * (last[k] + now[k] - 2 * first[k]) / 6;
		}
		memcpy(last, now, sizeof last);
		text += strcspn(text, ",)");
		if (*text != ',')
			break;
		text++;
	}
	bool degrees = count > 0 && fabs(first[0]) <= 180 && fabs(first[1]) <= 90 && fabs(area) < PLANT_DEG * PLANT_DEG;
	for (int k = 0; k < 2 && area != 0; k++)
		at[k] = first[k] + sum[k] / area;
	at[2] = NAN;
	*width = 2 * sqrt(fabs(area) / M_PI * (degrees ? ECO_DEGREE_M * eco_degree_m(first[1]) : 1));
	return area != 0;
}

/* A point of PostGIS, "0101000020E6100000...": bytes in hexadecimal digits, small ones first. */
static bool read_wkb_point(const char *text, double at[3])
{
	uint8_t bytes[25] = { 0 };
	size_t digits = strspn(text, "0123456789abcdefABCDEF");
	if (strncmp(text, "01", 2) != 0 || (digits != 42 && digits != 50) || text[digits] != 0)
		return false;
	for (size_t i = 0; i < digits / 2; i++)
		sscanf(text + 2 * i, "%2hhx", &bytes[i]);
	if (bytes[1] != 1 || (bytes[4] & 0x20) != (digits == 50 ? 0x20 : 0))
		return false;
	struct eco_reader r = { .bytes = bytes, .size = digits / 2, .at = digits / 2 - 16 };
	at[0] = eco_read_f64(&r);
	at[1] = eco_read_f64(&r);
	at[2] = NAN;
	return true;
}

/* "POINT (11.5 48.1)", "SRID=4326;POINT Z (11.5 48.1 520)", "POLYGON ((...))". False if it is another geometry. */
static bool read_wkt(const char *text, double at[3], double *width)
{
	const char *semicolon = strncasecmp(text, "SRID=", 5) == 0 ? strchr(text, ';') : NULL;
	char number[3][40];
	text = semicolon ? semicolon + 1 : text;
	text += strspn(text, " ");
	bool multi = strncasecmp(text, "MULTI", 5) == 0;
	text += multi ? 5 : 0;
	if (strncasecmp(text, "POLYGON", 7) == 0)
		return read_ring(text + 7, at, width);
	if (strncasecmp(text, "POINT", 5) != 0)
		return !multi && read_wkb_point(text, at);
	text += 5 + strspn(text + 5, " ZzMm");
	text += strspn(text, "(");
	int count = sscanf(text, "%39[0-9.eE+-]%*[ ]%39[0-9.eE+-]%*[ ]%39[0-9.eE+-]", number[0], number[1],
		number[2]);
	for (int k = 0; k < 3; k++)
		if (k >= count || !eco_text_number(number[k], '.', &at[k]))
			at[k] = NAN;
	return count >= 2 && !isnan(at[0]) && !isnan(at[1]);
}

/* The digits behind the point; -1 if it is no number with a point. */
static int read_degrees(const char **text, double *degrees)
{
	char number[40];
	size_t length = strspn(*text, "0123456789.+-");
	const char *point = memchr(*text, '.', length);
	if (!point || length >= sizeof number)
		return -1;
	memcpy(number, *text, length);
	number[length] = 0;
	int digits = (int)(*text + length - point - 1);
	*text += length;
	return eco_text_number(number, '.', degrees) ? digits : -1;
}

/* "50\u00b006'36\"N 8\u00b039'00\"E" */
static bool sixtieths_pair(const char *text, double at[3])
{
	const char *degree = strstr(text, "\u00b0"), *end = degree ? strpbrk(degree, ",;NSns") : NULL;
	char first[64];
	if (!end || !strstr(end, "\u00b0"))
		return false;
	end += *end != ',' && *end != ';';
	snprintf(first, sizeof first, "%.*s", (int)(end - text), text);
	return eco_text_number(first, '.', &at[1]) && eco_text_number(end + strspn(end, " ,;/"), '.', &at[0]);
}

/* Latitude and longitude in one field, as portals of open data write them: "48.883980, 2.360000", in brackets
 * at the end of an address, in degrees and minutes; "[2.36, 48.88]" as in GeoJSON. Returns the digits behind
 * the two points, -1 if it is no such pair. */
static int degree_pair(const char *text, double at[3])
{
	size_t length = strlen(text);
	while (length > 0 && text[length - 1] == ' ')
		length--;
	bool closed = length > 0 && (text[length - 1] == ')' || text[length - 1] == ']');
	const char *open = strrchr(text, closed && text[length - 1] == ']' ? '[' : '(');
	if (closed != (open != NULL))
		return -1;
	int x = open && *open == '[' ? 1 : 0;
	text = open ? open + 1 : strncmp(text, "geo:", 4) == 0 ? text + 4 : text;
	text += strspn(text, " ");
	at[2] = NAN;
	if (sixtieths_pair(text, at))
		return fabs(at[1]) <= 90 && fabs(at[0]) <= 180 ? DEGREE_DIGITS : -1;
	int first = read_degrees(&text, &at[!x]);
	size_t gap = strspn(text, " "), sign = text[gap] != 0 && strchr(",;/", text[gap]) != NULL;
	if (first < 0 || gap + sign == 0)
		return -1;
	text += gap + sign + strspn(text + gap + sign, " ");
	int second = read_degrees(&text, &at[x]);
	text += strspn(text, " )]");
	return second >= 0 && *text == 0 && fabs(at[1]) <= 90 && fabs(at[0]) <= 180 ? first + second : -1;
}

/* The number behind a key of a text in JSON, or in Python's form of it; NaN: none. */
static double json_number(const char *text, const char *key)
{
	const char *at = strstr(text, key);
	if (!at)
		return NAN;
	at += strlen(key);
	at += strspn(at, "\"': [");
	char *end;
	double number = strtod(at, &end);
	return end > at ? number : NAN;
}

/* {"type": "Point", "coordinates": [11.5, 48.1]}, {"lon": 11.5, "lat": 48.1}. False if it is another geometry. */
static bool read_json_point(const char *text, double at[3])
{
	at[2] = NAN;
	text += strspn(text, " \"");
	if (*text != '{')
		return false;
	const char *list = strstr(text, "coordinates");
	if (list && strcasestr(text, "point")) {
		at[0] = json_number(list, "coordinates");
		const char *comma = strchr(list, '[') ? strchr(strchr(list, '['), ',') : NULL;
		at[1] = comma ? json_number(comma, ",") : NAN;
	} else {
		at[0] = json_number(text, strstr(text, "longitude") ? "longitude" : "lon");
		at[1] = json_number(text, strstr(text, "latitude") ? "latitude" : "lat");
	}
	return !isnan(at[0]) && !isnan(at[1]);
}

static bool read_point(const char *text, enum eco_point_form form, double at[3], double *width)
{
	*width = 0;
	return form == ECO_POINT_PAIR ? degree_pair(text, at) >= 0 : form == ECO_POINT_JSON
		? read_json_point(text, at) : read_wkt(text, at, width);
}

bool eco_rows_point_find(struct eco_rows *rows, struct eco_rows_point *point)
{
	double at[3], width;
	for (int form = ECO_POINT_WKT; form <= ECO_POINT_PAIR; form++)
		for (uint32_t i = 0; i < rows->field_count && i < rows->column_count; i++)
			/* DEGREE_DIGITS tell a place from other pairs of numbers */
			if (form == ECO_POINT_PAIR ? degree_pair(rows->fields[i], at) >= DEGREE_DIGITS
				: read_point(rows->fields[i], (enum eco_point_form)form, at, &width)) {
				*point = (struct eco_rows_point){ i, true, (enum eco_point_form)form };
				rows->has_geometry = true;
				rows->has_z = !isnan(at[2]);
				return true;
			}
	return false;
}

void eco_rows_point_state(struct eco_rows *rows, const struct eco_rows_point *point)
{
	if (point->form == ECO_POINT_WKT)
		return;
	rows->crs = eco_copy_text("EPSG:4326");
	eco_rows_note(rows, "\"%.60s\" has %s", rows->columns[point->column], point->form == ECO_POINT_JSON
		? "points as GeoJSON" : "latitude and longitude in one field");
}

void eco_rows_point_take(struct eco_rows *rows, const struct eco_rows_point *point)
{
	struct eco_rows_place *place = &rows->place;
	const char *text = point->column < rows->field_count ? rows->fields[point->column] : "";
	text += strspn(text, " ");
	if (eco_text_is_missing(text) || strcasestr(text, "EMPTY")) {
		place->kind = ECO_PLACE_EMPTY;
	} else if (read_point(text, point->form, place->at, &place->width)) {
		place->kind = ECO_PLACE_POINT;
		rows->has_z |= !isnan(place->at[2]);
	} else {
		place->kind = ECO_PLACE_OTHER;
		snprintf(place->what, sizeof place->what, "%.*s", (int)strcspn(text, " ("), text);
	}
}
