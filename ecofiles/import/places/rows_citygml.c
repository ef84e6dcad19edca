/* CityGML 1 to 3 as a table: a row for each SolitaryVegetationObject, in one walk with expat that stops after each object, so that a city's
 * model is never held. OGR would hand over surfaces and forget the CRS, which stands at the model, not at the trees. Names count without
 * their namespace, which is all that differs between the versions.
 *
 * The file is walked once before, for its columns (generic attributes have any names), its CRS, and the order of its axes. A file
 * with a document type is refused: CityGML has none, and entities are how XML attacks its reader. */
#include "ecofiles/import/places/rows.h"

#include <errno.h>
#include <expat.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/import/places/rows_citygml.h"
#include "ecofiles/import/places/rows_formats.h"

#define CHUNK_BYTES (1 << 16)
#define DEPTH_MAX 256
#define TEXT_MAX (1u << 24)              /* of one element: the corners of a large surface */
#define NAME_BYTES 256

struct field { char *text; bool generic; };

struct citygml {
	struct eco_rows rows;
	FILE *file;
	char *path;
	XML_Parser parser;
	bool surveys, suspended, found;      /* surveys: the walk before */
	enum eco_code code;
	struct eco_error *error;
	char *text; size_t length, capacity;
	bool leaf;
	/* depths at which what is being read began, 0: nothing */
	int depth, object, reference, relative, apart, generic;
	int dimension, dimension_depth;      /* srsDimension of the innermost element that says */
	char generic_name[NAME_BYTES], uom[16];
	struct eco_citygml_shape shape;
	struct field *values;                /* ECO_COLUMNS_MAX */
	size_t row_bytes;
	uint64_t objects, covers;
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

static unsigned long line_of(const struct citygml *c) { return (unsigned long)XML_GetCurrentLineNumber(c->parser); }

static const char *local(const char *name)
{
	const char *colon = strrchr(name, ':');

	return colon != NULL ? colon + 1 : name;
}

static bool is(const char *name, const char *wanted) { return strcmp(name, wanted) == 0; }

static bool ends_with(const char *name, const char *end)
{
	size_t length = strlen(name), wanted = strlen(end);

	return length >= wanted && strcmp(name + length - wanted, end) == 0;
}

static const char *attribute(const XML_Char **attributes, const char *wanted)
{
	for (; *attributes != NULL; attributes += 2)
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
	if (i < c->rows.column_count || !c->surveys)
		return i;
	if (i == ECO_COLUMNS_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s: more than %u different attributes", c->path, ECO_COLUMNS_MAX));
	} else if ((c->rows.columns[i] = strdup(name)) == NULL) {
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

	if (c->surveys || column >= c->rows.column_count || (field->text != NULL && (generic || !field->generic)))
		return;
	c->row_bytes += strlen(text);
	if (c->row_bytes > ECO_ROW_BYTES_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: attributes of more than %u bytes", c->path, line_of(c), ECO_ROW_BYTES_MAX));
		return;
	}
	free(field->text);
	*field = (struct field){ strdup(text), generic };
	if (field->text == NULL)
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
	static const char *const units[][2] = { { "m", "m" }, { "metre", "m" }, { "meter", "m" }, { "cm", "cm" }, { "mm", "mm" }, { "dm", "dm" },
		{ "ft", "ft" }, { "[ft_i]", "ft" }, { "[ft_us]", "ft" }, { "foot", "ft" }, { "in", "in" }, { "[in_i]", "in" }, { "inch", "in" } };
	const char *last = uom;

	c->uom[0] = 0;
	for (const char *at = uom; at != NULL && *at != 0; at++)
		if (strchr(":#/", *at) != NULL)
			last = at + 1;
	for (size_t i = 0; uom != NULL && i < sizeof units / sizeof *units; i++)
		if (is(last, units[i][0]))
			snprintf(c->uom, sizeof c->uom, " %s", units[i][1]);
}

/* ---- Geometry ---- */

static void read_coordinates(struct citygml *c)
{
	if (!eco_citygml_shape_read(&c->shape, c->text, c->dimension, c->reference != 0))
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: a plant with more than %u corners", c->path, line_of(c), ECO_CITYGML_POINTS_MAX));
}

static void place_object(struct citygml *c)
{
	struct eco_rows_place *place = &c->rows.place;

	*place = (struct eco_rows_place){ .kind = ECO_PLACE_EMPTY, .yaw_deg = NAN, .scale = NAN };
	if (!eco_citygml_shape_place(&c->shape, place->at, &place->yaw_deg))
		return;
	place->kind = ECO_PLACE_POINT;
	if (c->surveys) {
		eco_citygml_crs_see(&c->crs, place->at);
		c->rows.has_z |= isfinite(place->at[2]);
	} else if (c->crs.swapped) {
		double first = place->at[0];

		place->at[0] = place->at[1];
		place->at[1] = first;
	}
}

/* ---- expat ---- */

static void begin_object(struct citygml *c, const XML_Char **attributes)
{
	const char *id = attribute(attributes, "id");

	c->object = c->depth;
	eco_citygml_shape_begin(&c->shape);
	c->row_bytes = 0;
	c->objects++;
	clear_fields(c);
	if (!c->surveys)
		c->rows.line = line_of(c);
	if (id != NULL)
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
	else if (c->apart == 0 && (ends_with(name, "TerrainIntersection") || ends_with(name, "TerrainIntersectionCurve")))
		c->apart = c->depth;
	else if (ends_with(name, "Attribute") && !is(name, "genericAttribute")) {
		c->generic = c->depth;
		snprintf(c->generic_name, sizeof c->generic_name, "%.255s", label != NULL ? label : "");
	}
}

static void XMLCALL on_start(void *ctx, const XML_Char *full, const XML_Char **attributes)
{
	struct citygml *c = ctx;
	const char *name = local(full), *srs = attribute(attributes, "srsName"), *dimension = attribute(attributes, "srsDimension");

	c->length = 0;
	c->leaf = true;
	if (++c->depth > DEPTH_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: elements within %u others", c->path, line_of(c), DEPTH_MAX));
		return;
	}
	if (dimension != NULL && c->object != 0 && c->dimension == 0) {
		c->dimension = atoi(dimension);
		c->dimension_depth = c->depth;
	}
	if (srs != NULL && c->surveys && (c->object != 0 || is(name, "Envelope")) && c->relative == 0
		&& !eco_citygml_crs_name(&c->crs, srs, c->object != 0))
		stop(c, eco_fail(c->error, ECO_UNSUPPORTED, "%.200s:%lu: its plants are in two CRS, \"%.80s\" and \"%.80s\"; split it", c->path,
			line_of(c), c->crs.name, srs));
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
	size_t needed = c->length + (size_t)length + 1;

	if (c->object == 0 || !c->leaf)
		return;
	if (needed > TEXT_MAX) {
		stop(c, eco_fail(c->error, ECO_TOO_LARGE, "%.300s:%lu: a text of more than %u bytes", c->path, line_of(c), TEXT_MAX));
		return;
	}
	if (needed > c->capacity) {
		char *grown = realloc(c->text, 2 * needed + 256);

		if (grown == NULL) {
			out_of_memory(c);
			return;
		}
		c->text = grown;
		c->capacity = 2 * needed + 256;
	}
	memcpy(c->text + c->length, text, (size_t)length);
	c->length += (size_t)length;
	c->text[c->length] = 0;
}

static void trim(struct citygml *c)
{
	size_t from = strspn(c->text, " \t\r\n");

	while (c->length > from && strchr(" \t\r\n", c->text[c->length - 1]) != NULL)
		c->length--;
	c->text[c->length] = 0;
	c->length -= from;
	memmove(c->text, c->text + from, c->length + 1);
}

static void end_value(struct citygml *c, const char *name, bool generic)
{
	char with_unit[80];

	if (c->length == 0)
		return;
	if (c->uom[0] == 0 || c->length + strlen(c->uom) >= sizeof with_unit) {
		set_field(c, name, c->text, generic);
		return;
	}
	snprintf(with_unit, sizeof with_unit, "%s%s", c->text, c->uom);
	set_field(c, name, with_unit, generic);
}

static void end_leaf(struct citygml *c, const char *name)
{
	trim(c);
	if (is(name, "pos") || is(name, "posList") || is(name, "coordinates")) {
		if (c->relative == 0 && c->apart == 0)
			read_coordinates(c);
	} else if (is(name, "transformationMatrix")) {
		eco_citygml_shape_matrix(&c->shape, c->text);
	} else if (c->generic != 0 && is(name, "name")) {
		snprintf(c->generic_name, sizeof c->generic_name, "%.255s", c->text);
	} else if (c->generic != 0 && is(name, "value")) {
		if (c->generic_name[0] != 0)
			end_value(c, c->generic_name, true);
	} else if (c->depth == c->object + 1) {
		end_value(c, name, false);
	}
}

static void end_object(struct citygml *c)
{
	c->object = 0;
	place_object(c);
	if (c->surveys)
		return;
	c->rows.row++;
	c->found = true;
	for (uint32_t i = 0; i < c->rows.column_count; i++)
		c->rows.fields[i] = c->values[i].text != NULL ? c->values[i].text : "";
	c->rows.field_count = c->rows.column_count;
	XML_StopParser(c->parser, XML_TRUE);
}

static void XMLCALL on_end(void *ctx, const XML_Char *full)
{
	struct citygml *c = ctx;
	int *depths[] = { &c->reference, &c->relative, &c->apart, &c->generic };

	if (c->code != ECO_OK)
		return;
	if (c->object != 0 && c->leaf) {
		on_text(c, "", 0);
		if (c->code == ECO_OK)
			end_leaf(c, local(full));
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

static void XMLCALL on_doctype(void *ctx, const XML_Char *name, const XML_Char *system, const XML_Char *public, int internal)
{
	struct citygml *c = ctx;

	(void)name, (void)system, (void)public, (void)internal;
	stop(c, eco_fail(c->error, ECO_UNSUPPORTED, "%.300s:%lu: it has a document type (<!DOCTYPE ...>), which CityGML has not; remove it", c->path,
		line_of(c)));
}

/* Besides what expat knows (UTF-8, UTF-16, Latin-1): Windows-1252, near enough as Latin-1. */
static int XMLCALL on_encoding(void *ctx, const XML_Char *name, XML_Encoding *info)
{
	(void)ctx;
	if (strncasecmp(name, "windows-1252", 13) != 0 && strncasecmp(name, "cp1252", 7) != 0 && strncasecmp(name, "iso-8859-15", 12) != 0)
		return XML_STATUS_ERROR;
	for (int i = 0; i < 256; i++)
		info->map[i] = i;
	info->data = NULL;
	info->convert = NULL;
	info->release = NULL;
	return XML_STATUS_OK;
}

/* ---- The walk ---- */

static enum eco_code begin_walk(struct citygml *c, bool surveys, struct eco_error *error)
{
	if (c->parser != NULL)
		XML_ParserFree(c->parser);
	c->parser = XML_ParserCreate(NULL);
	if (c->parser == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
	XML_SetUserData(c->parser, c);
	XML_SetElementHandler(c->parser, on_start, on_end);
	XML_SetCharacterDataHandler(c->parser, on_text);
	XML_SetStartDoctypeDeclHandler(c->parser, on_doctype);
	XML_SetUnknownEncodingHandler(c->parser, on_encoding, NULL);
	c->surveys = surveys;
	c->suspended = false;
	rewind(c->file);
	return ECO_OK;
}

static enum eco_code syntax_error(struct citygml *c, struct eco_error *error)
{
	enum XML_Error what = XML_GetErrorCode(c->parser);

	if (c->code != ECO_OK)
		return c->code;
	if (what == XML_ERROR_NO_ELEMENTS || what == XML_ERROR_UNCLOSED_TOKEN || what == XML_ERROR_UNCLOSED_CDATA_SECTION)
		return eco_fail(error, ECO_DAMAGED, "%.300s:%lu: it breaks off: it was not copied or downloaded whole", c->path, line_of(c));
	return eco_fail(error, what == XML_ERROR_NO_MEMORY ? ECO_NO_MEMORY : ECO_DAMAGED, "%.300s:%lu:%lu: not XML: %s", c->path, line_of(c),
		(unsigned long)XML_GetCurrentColumnNumber(c->parser) + 1, XML_ErrorString(what));
}

/* Up to the next object, or the end. */
static enum eco_code walk(struct citygml *c, bool *more, struct eco_error *error)
{
	enum XML_Status status = XML_STATUS_OK;

	c->error = error;
	c->found = false;
	while (!c->found) {
		if (c->suspended) {
			c->suspended = false;
			status = XML_ResumeParser(c->parser);
		} else {
			void *buffer = XML_GetBuffer(c->parser, CHUNK_BYTES);
			size_t size = buffer != NULL ? fread(buffer, 1, CHUNK_BYTES, c->file) : 0;

			if (ferror(c->file))
				return eco_fail(error, ECO_IO, "%.300s: %s", c->path, strerror(errno));
			status = buffer != NULL ? XML_ParseBuffer(c->parser, (int)size, size < CHUNK_BYTES) : XML_STATUS_ERROR;
		}
		if (status == XML_STATUS_ERROR || c->code != ECO_OK)
			return syntax_error(c, error);
		if (status == XML_STATUS_SUSPENDED) {
			c->suspended = true;
		} else {
			XML_ParsingStatus state;

			XML_GetParsingStatus(c->parser, &state);
			if (state.parsing == XML_FINISHED)
				break;
		}
	}
	*more = c->found;
	return ECO_OK;
}

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct citygml *c = (struct citygml *)rows;
	XML_ParsingStatus state;

	XML_GetParsingStatus(c->parser, &state);
	*more = false;
	return state.parsing == XML_FINISHED && c->code == ECO_OK ? ECO_OK : walk(c, more, error);
}

static void close_citygml(struct eco_rows *rows)
{
	struct citygml *c = (struct citygml *)rows;

	if (c->values != NULL)
		clear_fields(c);
	eco_rows_free_texts(rows);
	if (c->parser != NULL)
		XML_ParserFree(c->parser);
	if (c->file != NULL)
		fclose(c->file);
	free(c->values);
	free(c->shape.points);
	free(c->text);
	free(c->path);
	free(c);
}

static enum eco_code settle_crs(struct citygml *c, struct eco_error *error)
{
	char note[300];

	if (eco_citygml_crs_settle(&c->crs, note, sizeof note, error) != ECO_OK)
		return ECO_NOT_FOUND;
	if (note[0] != 0)
		eco_rows_note(&c->rows, "%s", note);
	if (c->crs.code[0] == 0)
		return ECO_OK;
	c->rows.crs = strdup(c->crs.code);
	return c->rows.crs != NULL ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
}

static enum eco_code survey(struct citygml *c, struct eco_error *error)
{
	bool more;
	enum eco_code code = begin_walk(c, true, error);

	if (code == ECO_OK)
		code = walk(c, &more, error);
	if (code == ECO_OK && c->objects == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: no SolitaryVegetationObject in it, so no plants%s", c->path,
			c->covers > 0 ? "; its PlantCover are areas: convert them to GeoJSON polygons and use \"scatter\"" : "");
	if (code == ECO_OK && c->covers > 0)
		eco_rows_note(&c->rows, "its %llu PlantCover are passed over: they are areas; as GeoJSON polygons, \"scatter\" fills them with plants",
			(unsigned long long)c->covers);
	if (code == ECO_OK)
		code = settle_crs(c, error);
	c->rows.fields = calloc(c->rows.column_count + 1u, sizeof *c->rows.fields);
	if (code == ECO_OK && c->rows.fields == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
	return code == ECO_OK ? begin_walk(c, false, error) : code;
}

enum eco_code eco_rows_open_citygml(struct eco_rows **rows, const char *path, struct eco_error *error)
{
	struct citygml *c = calloc(1, sizeof *c);
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code;

	_Static_assert(offsetof(struct citygml, rows) == 0, "struct eco_rows is the start of struct citygml");
	*rows = NULL;
	if (c == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	c->rows.next = next;
	c->rows.close = close_citygml;
	c->rows.where = "line";
	c->rows.has_geometry = true;
	c->path = strdup(path);
	c->rows.columns = calloc(ECO_COLUMNS_MAX, sizeof *c->rows.columns);
	c->values = calloc(ECO_COLUMNS_MAX + 1, sizeof *c->values);
	if (c->path == NULL || c->rows.columns == NULL || c->values == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	else if ((c->file = fopen(path, "rb")) == NULL)
		code = eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.300s: %s", path, strerror(errno));
	else
		code = survey(c, error != NULL ? error : &own);
	if (code == ECO_OK)
		*rows = &c->rows;
	else
		close_citygml(&c->rows);
	return code;
}
