/* CityGML 1 to 3 as a table: a row for each SolitaryVegetationObject, in one walk with expat. The trees are
 * kept until they are asked for, as the last one may add a column (generic attributes have any names) and
 * tell the order of the axes; the rest of the city's model is never held. Names count without their
 * namespace, which is all that differs between the versions. A file with a document type is refused: CityGML
 * has none, and entities are how XML attacks its reader.
 *
 * OGR's driver (GDAL 3.6.2) was tried instead. It loses the names of measure attributes and of all generic
 * ones of CityGML 3, and the srsName of the German surveys; it takes a tree's terrain intersection for the
 * tree, as the last geometry counts; it does not see trees within groups, nor that trees are in two CRS. */
#include "ecofiles/import/places/rows/rows.h"

#include <errno.h>
#include <expat.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/import/places/rows/rows_citygml.h"
#include "ecofiles/import/places/rows/rows_formats.h"

#define CHUNK_BYTES (1 << 16)
#define DEPTH_MAX 256
#define TEXT_MAX (1u << 24)              /* of one element: the corners of a large surface */
#define NAME_BYTES 256
#define SPACE " \t\r\n"

struct field { char *text; bool generic; };

struct tree { struct eco_rows_place place; uint64_t line; size_t values_end; };

struct citygml {
	struct eco_rows rows;
	char *path;
	XML_Parser parser;
	enum eco_code code;
	struct eco_error *error;
	struct eco_writer text;              /* of the element being read */
	bool leaf;
	/* depths at which what is being read began, 0: nothing */
	int depth, object, reference, relative, apart, generic;
	int dimension, dimension_depth;      /* srsDimension of the innermost element that says */
	char generic_name[NAME_BYTES], uom[16];
	struct eco_citygml_shape shape;
	struct field *values;                /* ECO_COLUMNS_MAX, of the object being read */
	size_t row_bytes;
	uint64_t covers, line;               /* line: where the object began */
	struct tree *trees; uint32_t tree_count, tree_capacity;
	/* of all trees, one behind the other: u16 column, its text with its 0 */
	struct eco_writer kept;
	struct eco_citygml_crs crs;
};

static void stop(struct citygml *c, enum eco_code code)
{
	if (c->code == ECO_OK)
		c->code = code;
	XML_StopParser(c->parser, XML_FALSE);
}

static void out_of_memory(struct citygml *c)
{
	stop(c, eco_fail(c->error, ECO_NO_MEMORY, "%.300s: out of memory", c->path));
}

static unsigned long line_of(const struct citygml *c)
{
	return (unsigned long)XML_GetCurrentLineNumber(c->parser);
}

static const char *local(const char *name)
{
	const char *colon = strrchr(name, ':');
	return colon ? colon + 1 : name;
}

static bool is(const char *name, const char *wanted) { return strcmp(name, wanted) == 0; }

static bool ends_with(const char *name, const char *end)
{
	size_t length = strlen(name), wanted = strlen(end);
	return length >= wanted && strcmp(name + length - wanted, end) == 0;
}

static const char *attribute(const XML_Char **attributes, const char *wanted)
{
	for (; *attributes; attributes += 2)
		if (is(local(attributes[0]), wanted))
			return attributes[1];
	return NULL;
}

/* ---- Columns and fields ---- */

static uint32_t column_of(struct citygml *c, const char *name)
{
	uint32_t i = 0;
	while (i < c->rows.column_count && !is(c->rows.columns[i], name))
		i++;
	if (i < c->rows.column_count)
		return i;
	if (i == ECO_COLUMNS_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s: more than %u different attributes",
			c->path, ECO_COLUMNS_MAX));
	} else if (!(c->rows.columns[i] = strdup(name))) {
		out_of_memory(c);
	} else {
		c->rows.column_count++;
	}
	return i;
}

/* The first value counts, and one of the standard more than a generic one of that name. */
static void set_field(struct citygml *c, const char *name, const char *text, bool generic)
{
	uint32_t column = column_of(c, name);
	struct field *field = &c->values[column];
	if (column >= c->rows.column_count || (field->text && (generic || !field->generic)))
		return;
	c->row_bytes += strlen(text);
	if (c->row_bytes > ECO_ROW_BYTES_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: attributes of more than %u bytes",
			c->path, line_of(c), ECO_ROW_BYTES_MAX));
		return;
	}
	free(field->text);
	*field = (struct field){ strdup(text), generic };
	if (!field->text)
		out_of_memory(c);
}

static void clear_fields(struct citygml *c)
{
	for (uint32_t i = 0; i < c->rows.column_count; i++) {
		free(c->values[i].text);
		c->values[i] = (struct field){ NULL, false };
	}
}

/* "urn:ogc:def:uom:UCUM::m", "#m", "[ft_i]": as sizes in texts have it. */
static void take_uom(struct citygml *c, const char *uom)
{
	static const char *const units[][2] = { { "m", "m" }, { "metre", "m" }, { "meter", "m" },
		{ "cm", "cm" }, { "mm", "mm" }, { "dm", "dm" },
		{ "ft", "ft" }, { "[ft_i]", "ft" }, { "[ft_us]", "ft" }, { "foot", "ft" }, { "in", "in" },
		{ "[in_i]", "in" }, { "inch", "in" } };
	const char *last = uom;
	c->uom[0] = 0;
	for (const char *at = uom; at && *at != 0; at++)
		if (strchr(":#/", *at))
			last = at + 1;
	for (size_t i = 0; uom && i < sizeof units / sizeof *units; i++)
		if (is(last, units[i][0]))
			snprintf(c->uom, sizeof c->uom, " %s", units[i][1]);
}

/* ---- Geometry ---- */

static void read_coordinates(struct citygml *c, const char *text)
{
	if (!eco_citygml_shape_read(&c->shape, text, c->dimension, c->reference != 0))
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: a plant with more than %u corners",
			c->path, line_of(c), ECO_CITYGML_POINTS_MAX));
}

static struct eco_rows_place place_object(struct citygml *c)
{
	struct eco_rows_place place = { .kind = ECO_PLACE_EMPTY, .yaw_deg = NAN, .scale = NAN };
	if (!eco_citygml_shape_place(&c->shape, place.at, &place.yaw_deg))
		return place;
	place.kind = ECO_PLACE_POINT;
	eco_citygml_crs_see(&c->crs, place.at);
	c->rows.has_z |= isfinite(place.at[2]);
	return place;
}

/* ---- expat ---- */

static void begin_object(struct citygml *c, const XML_Char **attributes)
{
	const char *id = attribute(attributes, "id");
	c->object = c->depth;
	eco_citygml_shape_begin(&c->shape);
	c->row_bytes = 0;
	c->line = line_of(c);
	clear_fields(c);
	if (id)
		set_field(c, "id", id, false);
}

static void begin_part(struct citygml *c, const char *name, const XML_Char **attributes)
{
	const char *label = attribute(attributes, "name");
	take_uom(c, attribute(attributes, "uom"));
	if (c->reference == 0 && is(name, "referencePoint"))
		c->reference = c->depth;
	else if (c->relative == 0 && (is(name, "relativeGMLGeometry") || is(name, "relativeGeometry")))
		c->relative = c->depth;
	else if (c->apart == 0
		&& (ends_with(name, "TerrainIntersection") || ends_with(name, "TerrainIntersectionCurve")))
		c->apart = c->depth;
	else if (ends_with(name, "Attribute") && !is(name, "genericAttribute")) {
		c->generic = c->depth;
		snprintf(c->generic_name, sizeof c->generic_name, "%.255s", label ? label : "");
	}
}

static void XMLCALL on_start(void *ctx, const XML_Char *full, const XML_Char **attributes)
{
	struct citygml *c = ctx;
	const char *name = local(full), *srs = attribute(attributes, "srsName"),
		*dimension = attribute(attributes, "srsDimension");
	c->text.size = 0;
	c->leaf = true;
	if (++c->depth > DEPTH_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: elements within %u others", c->path,
			line_of(c), DEPTH_MAX));
		return;
	}
	if (dimension && c->object != 0 && c->dimension == 0) {
		c->dimension = atoi(dimension);
		c->dimension_depth = c->depth;
	}
	if (srs && (c->object != 0 || is(name, "Envelope")) && c->relative == 0
		&& !eco_citygml_crs_name(&c->crs, srs, c->object != 0))
		stop(c, eco_fail(c->error, ECO_UNSUPPORTED, "%.200s:%lu: its plants are in two CRS, "
			"\"%.80s\" and \"%.80s\"; split it", c->path, line_of(c), c->crs.name, srs));
	if (is(name, "SolitaryVegetationObject") && c->object == 0)
		begin_object(c, attributes);
	else if (c->object != 0)
		begin_part(c, name, attributes);
	else if (is(name, "PlantCover"))
		c->covers++;
}

static void XMLCALL on_text(void *ctx, const XML_Char *text, int length)
{
	struct citygml *c = ctx;
	if (c->object == 0 || !c->leaf)
		return;
	eco_write_bytes(&c->text, text, (size_t)length);
	if (c->text.failed)
		out_of_memory(c);
	else if (c->text.size > TEXT_MAX)
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: a text of more than %u bytes", c->path,
			line_of(c), TEXT_MAX));
}

static char *trimmed(char *text)
{
	size_t length = strlen(text);
	while (length > 0 && strchr(SPACE, text[length - 1]))
		length--;
	text[length] = 0;
	return text + strspn(text, SPACE);
}

static void end_value(struct citygml *c, const char *name, const char *text, bool generic)
{
	char with_unit[80];
	if (*text == 0)
		return;
	if (c->uom[0] != 0 && snprintf(with_unit, sizeof with_unit, "%s%s", text, c->uom)
			< (int)sizeof with_unit)
		text = with_unit;
	set_field(c, name, text, generic);
}

static void end_leaf(struct citygml *c, const char *name, const char *text)
{
	if (is(name, "pos") || is(name, "posList") || is(name, "coordinates")) {
		if (c->relative == 0 && c->apart == 0)
			read_coordinates(c, text);
	} else if (is(name, "transformationMatrix")) {
		eco_citygml_shape_matrix(&c->shape, text);
	} else if (c->generic != 0 && is(name, "name")) {
		snprintf(c->generic_name, sizeof c->generic_name, "%.255s", text);
	} else if (c->generic != 0 && is(name, "value")) {
		if (c->generic_name[0] != 0)
			end_value(c, c->generic_name, text, true);
	} else if (c->depth == c->object + 1) {
		end_value(c, name, text, false);
	}
}

static void end_object(struct citygml *c)
{
	c->object = 0;
	for (uint32_t i = 0; i < c->rows.column_count; i++)
		if (c->values[i].text) {
			eco_write_u16(&c->kept, (uint16_t)i);
			eco_write_bytes(&c->kept, c->values[i].text, strlen(c->values[i].text) + 1);
		}
	if (c->kept.failed || !eco_array_grow(&c->trees, &c->tree_capacity, c->tree_count, sizeof *c->trees))
		out_of_memory(c);
	else
		c->trees[c->tree_count++] = (struct tree){ place_object(c), c->line, c->kept.size };
}

static void XMLCALL on_end(void *ctx, const XML_Char *full)
{
	struct citygml *c = ctx;
	int *depths[] = { &c->reference, &c->relative, &c->apart, &c->generic };
	if (c->code != ECO_OK)
		return;
	if (c->object != 0 && c->leaf) {
		eco_write_u8(&c->text, 0);
		if (c->text.failed)
			out_of_memory(c);
		else
			end_leaf(c, local(full), trimmed((char *)c->text.bytes));
	}
	c->leaf = false;
	for (size_t i = 0; i < sizeof depths / sizeof *depths; i++)
		if (*depths[i] == c->depth)
			*depths[i] = 0;
	if (c->dimension_depth == c->depth)
		c->dimension = c->dimension_depth = 0;
	if (c->object != 0 && c->object == c->depth)
		end_object(c);
	c->depth--;
}

static void XMLCALL on_doctype(void *ctx, const XML_Char *name, const XML_Char *system,
	const XML_Char *public, int internal)
{
	struct citygml *c = ctx;
	(void)name, (void)system, (void)public, (void)internal;
	stop(c, eco_fail(c->error, ECO_UNSUPPORTED, "%.300s:%lu: it has a document type (<!DOCTYPE ...>), "
		"which CityGML has not; remove it", c->path, line_of(c)));
}

/* Besides what expat knows (UTF-8, UTF-16, Latin-1): Windows-1252, near enough as Latin-1. */
static int XMLCALL on_encoding(void *ctx, const XML_Char *name, XML_Encoding *info)
{
	(void)ctx;
	if (strncasecmp(name, "windows-1252", 13) != 0 && strncasecmp(name, "cp1252", 7) != 0
			&& strncasecmp(name, "iso-8859-15", 12) != 0)
		return XML_STATUS_ERROR;
	for (int i = 0; i < 256; i++)
		info->map[i] = i;
	info->data = NULL;
	info->convert = NULL;
	info->release = NULL;
	return XML_STATUS_OK;
}

/* ---- The walk ---- */

static enum eco_code syntax_error(struct citygml *c, struct eco_error *error)
{
	enum XML_Error what = XML_GetErrorCode(c->parser);
	if (c->code != ECO_OK)
		return c->code;
	if (what == XML_ERROR_NO_ELEMENTS || what == XML_ERROR_UNCLOSED_TOKEN
			|| what == XML_ERROR_UNCLOSED_CDATA_SECTION)
		return eco_fail(error, ECO_DAMAGED, "%.300s:%lu: it breaks off: it was not copied or "
			"downloaded whole", c->path, line_of(c));
	return eco_fail(error, what == XML_ERROR_NO_MEMORY ? ECO_NO_MEMORY : ECO_DAMAGED,
		"%.300s:%lu:%lu: not XML: %s", c->path, line_of(c),
		(unsigned long)XML_GetCurrentColumnNumber(c->parser) + 1, XML_ErrorString(what));
}

static enum eco_code walk(struct citygml *c, FILE *file, struct eco_error *error)
{
	size_t size = CHUNK_BYTES;
	c->error = error;
	while (size == CHUNK_BYTES) {
		void *buffer = XML_GetBuffer(c->parser, CHUNK_BYTES);
		size = buffer ? fread(buffer, 1, CHUNK_BYTES, file) : 0;
		if (ferror(file))
			return eco_fail_read(error, c->path, errno);
		if (!buffer || XML_ParseBuffer(c->parser, (int)size, size < CHUNK_BYTES) == XML_STATUS_ERROR)
			return syntax_error(c, error);
	}
	return ECO_OK;
}

/* ---- Rows ---- */

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct citygml *c = (struct citygml *)rows;
	const struct tree *tree = c->trees + rows->row;
	struct eco_reader values = { c->kept.bytes, c->kept.size, rows->row > 0 ? tree[-1].values_end : 0,
		false };
	(void)error;
	*more = rows->row < c->tree_count;
	if (!*more)
		return ECO_OK;
	for (uint32_t i = 0; i < rows->column_count; i++)
		rows->fields[i] = "";
	while (values.at < tree->values_end) {
		uint16_t column = eco_read_u16(&values);
		rows->fields[column] = (const char *)values.bytes + values.at;
		values.at += strlen(rows->fields[column]) + 1;
	}
	rows->field_count = rows->column_count;
	rows->place = tree->place;
	if (c->crs.swapped) {
		rows->place.at[0] = tree->place.at[1];
		rows->place.at[1] = tree->place.at[0];
	}
	rows->line = tree->line;
	rows->row++;
	return ECO_OK;
}

static void close_citygml(struct eco_rows *rows)
{
	struct citygml *c = (struct citygml *)rows;
	if (c->values)
		clear_fields(c);
	eco_rows_free_texts(rows);
	if (c->parser)
		XML_ParserFree(c->parser);
	eco_writer_free(&c->text);
	eco_writer_free(&c->kept);
	free(c->trees);
	free(c->values);
	free(c->shape.points);
	free(c->path);
	free(c);
}

/* Settles what only the end of the file tells: the CRS and the order of its axes. */
static enum eco_code settle(struct citygml *c, struct eco_error *error)
{
	char note[300] = "";
	if (c->tree_count == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: no SolitaryVegetationObject in it, so no "
			"plants%s", c->path, c->covers > 0 ? "; its PlantCover are areas: convert them to "
			"GeoJSON polygons and use \"scatter\"" : "");
	if (c->covers > 0)
		eco_rows_note(&c->rows, "its %llu PlantCover are passed over: they are areas; as GeoJSON "
			"polygons, \"scatter\" fills them with plants", (unsigned long long)c->covers);
	if (c->crs.code[0] == 0)
		return ECO_OK;
	const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
	if (!proj)
		return ECO_NOT_FOUND;
	proj->citygml_settle(&c->crs, note, sizeof note);
	if (note[0] != 0)
		eco_rows_note(&c->rows, "%s", note);
	c->rows.crs = strdup(c->crs.code);
	return c->rows.crs ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
}

static enum eco_code read_citygml(struct citygml *c, struct eco_error *error)
{
	FILE *file = fopen(c->path, "rb");
	if (!file)
		return eco_fail_read(error, c->path, errno);
	XML_SetUserData(c->parser, c);
	XML_SetElementHandler(c->parser, on_start, on_end);
	XML_SetCharacterDataHandler(c->parser, on_text);
	XML_SetStartDoctypeDeclHandler(c->parser, on_doctype);
	XML_SetUnknownEncodingHandler(c->parser, on_encoding, NULL);
	enum eco_code code = walk(c, file, error);
	fclose(file);
	return code == ECO_OK ? settle(c, error) : code;
}

enum eco_code eco_rows_open_citygml(struct eco_rows **rows, const char *path, struct eco_error *error)
{
	struct citygml *c = calloc(1, sizeof *c);
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code;
	_Static_assert(offsetof(struct citygml, rows) == 0, "struct eco_rows is the start of struct citygml");
	*rows = NULL;
	if (!c)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	c->rows.next = next;
	c->rows.close = close_citygml;
	c->rows.where = "line";
	c->rows.has_geometry = true;
	c->path = strdup(path);
	c->rows.columns = calloc(ECO_COLUMNS_MAX, sizeof *c->rows.columns);
	c->rows.fields = calloc(ECO_COLUMNS_MAX, sizeof *c->rows.fields);
	c->values = calloc(ECO_COLUMNS_MAX + 1, sizeof *c->values);
	c->parser = XML_ParserCreate(NULL);
	if (!c->path || !c->rows.columns || !c->rows.fields || !c->values || !c->parser)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	else
		code = read_citygml(c, error ? error : &own);
	if (!code)
		*rows = &c->rows;
	else
		close_citygml(&c->rows);
	return code;
}
