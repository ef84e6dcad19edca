/* A table is read in a child process (guard.h) and handed over row by row through a pipe, so that reading
 * and placing overlap and nobody holds the whole file. Messages are checked like a stranger's, because
 * after a bug in a library they are.
 *
 *   message  u32 bytes of the rest, u8 kind, then by kind
 *   'H'      head: u8 geometry | z << 1 | local << 2 | doubted << 3, u32 columns, texts: where, crs ("" none), no_crs,
 *            names of columns
 *   'N'      note: text
 *   'R'      row: u64 row, u64 line, u8 place, f64 at[3] yaw scale, text what, u32 area bytes, the area, u32 fields,
 *            texts (unneeded ones are empty)
 *   'E'      end: u64 rows
 *
 * Numbers have the machine's byte order, as both ends are one program. A text ends with 0. */
#include "ecofiles/import/places/rows.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/import/places/rows_formats.h"

#define MESSAGE_MAX (4u * ECO_ROW_BYTES_MAX)
#define AREA_MESSAGE_MAX (1u << 29)
#define WRITE_BUFFER (1u << 16)

/* ---- The child ---- */

struct message { char *bytes; size_t used, capacity; bool failed, areas; };

static void put(struct message *m, const void *bytes, size_t size)
{
	if (m->used + size > m->capacity) {
		size_t capacity = 2 * (m->used + size) + 4096;
		char *grown = realloc(m->bytes, capacity);

		m->failed |= grown == NULL;
		if (grown == NULL)
			return;
		m->bytes = grown;
		m->capacity = capacity;
	}
	memcpy(m->bytes + m->used, bytes, size);
	m->used += size;
}

static void put_text(struct message *m, const char *text)
{
	put(m, text, strlen(text) + 1);
}

static void begin(struct message *m, char kind)
{
	m->used = 0;
	put(m, &(uint32_t){ 0 }, 4);
	put(m, &kind, 1);
}

static enum eco_code send_message(struct message *m, FILE *out, struct eco_error *error)
{
	uint32_t size = (uint32_t)(m->used - 4);

	if (m->failed)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (size > (m->areas ? AREA_MESSAGE_MAX : MESSAGE_MAX))
		return eco_fail(error, ECO_TOO_LARGE, "a row of more than %u bytes", ECO_ROW_BYTES_MAX);
	memcpy(m->bytes, &size, 4);
	return fwrite(m->bytes, 1, m->used, out) == m->used ? ECO_OK : eco_fail(error, ECO_IO, "nobody reads on");
}

static enum eco_code send_head(const struct eco_rows *rows, struct message *m, FILE *out, struct eco_error *error)
{
	uint8_t flags = (uint8_t)(rows->has_geometry | rows->has_z << 1 | rows->local << 2 | rows->degrees_doubted << 3);

	begin(m, 'H');
	put(m, &flags, 1);
	put(m, &rows->column_count, 4);
	put_text(m, rows->where);
	put_text(m, rows->crs != NULL ? rows->crs : "");
	put_text(m, rows->no_crs);
	for (uint32_t i = 0; i < rows->column_count; i++)
		put_text(m, rows->columns[i]);
	return send_message(m, out, error);
}

static enum eco_code send_notes(const struct eco_rows *rows, uint32_t *sent, struct message *m, FILE *out, struct eco_error *error)
{
	for (; *sent < rows->note_count; ++*sent) {
		enum eco_code code;

		begin(m, 'N');
		put_text(m, rows->notes[*sent]);
		code = send_message(m, out, error);
		if (code != ECO_OK)
			return code;
	}
	return ECO_OK;
}

static enum eco_code send_row(const struct eco_rows *rows, const bool *wanted, struct message *m, FILE *out, struct eco_error *error)
{
	const struct eco_rows_place *place = &rows->place;
	uint8_t kind = (uint8_t)place->kind;
	uint32_t area_bytes = place->kind == ECO_PLACE_AREA ? place->wkb_bytes : 0;

	begin(m, 'R');
	put(m, &rows->row, 8);
	put(m, &rows->line, 8);
	put(m, &kind, 1);
	put(m, place->at, sizeof place->at);
	put(m, &place->yaw_deg, 8);
	put(m, &place->scale, 8);
	put_text(m, place->what);
	put(m, &area_bytes, 4);
	if (area_bytes > 0)
		put(m, place->wkb, area_bytes);
	put(m, &rows->field_count, 4);
	for (uint32_t i = 0; i < rows->field_count; i++)
		put_text(m, i < rows->column_count && wanted[i] ? rows->fields[i] : "");
	return send_message(m, out, error);
}

static void find_wanted(const struct eco_rows *rows, const struct eco_rows_source *source, bool *wanted)
{
	for (uint32_t i = 0; i < rows->column_count; i++) {
		wanted[i] = source->wanted == NULL;
		for (uint32_t k = 0; source->wanted != NULL && k < source->wanted_count; k++)
			wanted[i] |= strcmp(rows->columns[i], source->wanted[k]) == 0;
	}
}

static enum eco_code send_rows(struct eco_rows *rows, const struct eco_rows_source *source, struct message *m, FILE *out,
	struct eco_error *error)
{
	bool *wanted = calloc(rows->column_count + 1u, sizeof *wanted), more = true;
	uint32_t notes = 0;
	enum eco_code code = wanted != NULL ? send_head(rows, m, out, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");

	if (wanted != NULL)
		find_wanted(rows, source, wanted);
	while (code == ECO_OK && more) {
		code = send_notes(rows, &notes, m, out, error);
		if (code == ECO_OK)
			code = rows->next(rows, &more, error);
		if (code == ECO_OK && more)
			code = send_row(rows, wanted, m, out, error);
	}
	if (code == ECO_OK)
		code = send_notes(rows, &notes, m, out, error);
	if (code == ECO_OK) {
		begin(m, 'E');
		put(m, &rows->row, 8);
		code = send_message(m, out, error);
	}
	free(wanted);
	return code;
}

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct eco_rows_source *source = ctx;
	struct eco_rows *rows = NULL;
	struct message m = { .bytes = NULL, .areas = source->areas };
	enum eco_code code;

	setvbuf(out, NULL, _IOFBF, WRITE_BUFFER);
	code = eco_rows_open_here(&rows, source, error);
	if (code == ECO_OK)
		code = send_rows(rows, source, &m, out, error);
	eco_rows_close(rows);
	free(m.bytes);
	return code;
}

/* ---- The parent ---- */

struct child {
	struct eco_rows rows;
	struct eco_guard *guard;
	FILE *stream;
	char *path, *message, where[32];
	size_t capacity, size, at;
	bool areas;
};

static enum eco_code damaged(const struct child *c, struct eco_error *error)
{
	return eco_fail(error, ECO_DAMAGED, "%.300s: the data from its reader make no sense: the file is damaged, or meets a bug in the library that "
		"reads it", c->path);
}

/* The stream ended early: reports how the child ended. */
static enum eco_code ended(struct child *c, struct eco_error *error)
{
	enum eco_code code = eco_guard_finish(c->guard, error);

	c->guard = NULL;
	c->stream = NULL;
	return code != ECO_OK ? code : damaged(c, error);
}

static enum eco_code receive(struct child *c, char *kind, struct eco_error *error)
{
	uint32_t size;

	if (c->stream == NULL)
		return damaged(c, error);
	if (fread(&size, 4, 1, c->stream) != 1)
		return ended(c, error);
	if (size < 1 || size > (c->areas ? AREA_MESSAGE_MAX : MESSAGE_MAX))
		return damaged(c, error);
	if (size > c->capacity) {
		char *grown = realloc(c->message, 2 * (size_t)size);

		if (grown == NULL)
			return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
		c->message = grown;
		c->capacity = 2 * (size_t)size;
	}
	if (fread(c->message, 1, size, c->stream) != size)
		return ended(c, error);
	c->size = size;
	c->at = 1;
	*kind = c->message[0];
	return ECO_OK;
}

static bool get(struct child *c, void *to, size_t size)
{
	if (c->size - c->at < size)
		return false;
	memcpy(to, c->message + c->at, size);
	c->at += size;
	return true;
}

static const char *get_text(struct child *c)
{
	const char *text = c->message + c->at, *end = memchr(text, 0, c->size - c->at);

	if (end == NULL)
		return NULL;
	c->at += (size_t)(end - text) + 1;
	return text;
}

static enum eco_code get_head(struct child *c, struct eco_error *error)
{
	struct eco_rows *rows = &c->rows;
	uint8_t flags;
	uint32_t columns;
	const char *text;

	if (!get(c, &flags, 1) || !get(c, &columns, 4) || columns > ECO_COLUMNS_MAX || (text = get_text(c)) == NULL)
		return damaged(c, error);
	snprintf(c->where, sizeof c->where, "%.31s", text);
	rows->where = c->where;
	rows->has_geometry = flags & 1;
	rows->has_z = flags >> 1 & 1;
	rows->local = flags >> 2 & 1;
	rows->degrees_doubted = flags >> 3 & 1;
	text = get_text(c);
	if (text == NULL || strlen(text) > ECO_ROWS_CRS_BYTES)
		return damaged(c, error);
	rows->columns = calloc(columns + 1u, sizeof *rows->columns);
	rows->crs = *text != 0 ? strdup(text) : NULL;
	if (rows->columns == NULL || (*text != 0 && rows->crs == NULL))
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
	text = get_text(c);
	if (text == NULL)
		return damaged(c, error);
	snprintf(rows->no_crs, sizeof rows->no_crs, "%.111s", text);
	for (; rows->column_count < columns; rows->column_count++) {
		text = get_text(c);
		if (text == NULL)
			return damaged(c, error);
		rows->columns[rows->column_count] = strdup(text);
		if (rows->columns[rows->column_count] == NULL)
			return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
	}
	return c->at == c->size ? ECO_OK : damaged(c, error);
}

static bool get_place(struct child *c, struct eco_rows_place *place)
{
	uint8_t kind;
	const char *what;

	if (!get(c, &kind, 1) || kind >= ECO_PLACE_COUNT || !get(c, place->at, sizeof place->at) || !get(c, &place->yaw_deg, 8)
		|| !get(c, &place->scale, 8) || (what = get_text(c)) == NULL || !get(c, &place->wkb_bytes, 4) || place->wkb_bytes > c->size - c->at)
		return false;
	place->wkb = (const uint8_t *)c->message + c->at;
	c->at += place->wkb_bytes;
	place->kind = (enum eco_place_kind)kind;
	snprintf(place->what, sizeof place->what, "%.15s", what);
	return true;
}

static enum eco_code get_row(struct child *c, struct eco_error *error)
{
	struct eco_rows *rows = &c->rows;
	uint64_t row, line;
	uint32_t fields;

	if (!get(c, &row, 8) || row <= rows->row || !get(c, &line, 8) || !get_place(c, &rows->place) || !get(c, &fields, 4)
		|| fields > ECO_COLUMNS_MAX)
		return damaged(c, error);
	for (uint32_t i = 0; i < fields; i++)
		if ((rows->fields[i] = get_text(c)) == NULL)
			return damaged(c, error);
	rows->field_count = fields;
	rows->row = row;
	rows->line = line;
	return c->at == c->size ? ECO_OK : damaged(c, error);
}

static enum eco_code get_note(struct child *c, struct eco_error *error)
{
	const char *text = get_text(c);

	if (text == NULL)
		return damaged(c, error);
	eco_rows_note(&c->rows, "%s", text);
	return ECO_OK;
}

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct child *c = (struct child *)rows;
	enum eco_code code;
	char kind = 0;

	do {
		code = receive(c, &kind, error);
		if (code == ECO_OK && kind == 'N')
			code = get_note(c, error);
	} while (code == ECO_OK && kind == 'N');
	if (code != ECO_OK)
		return code;
	if (kind == 'R') {
		*more = true;
		return get_row(c, error);
	}
	if (kind != 'E')
		return damaged(c, error);
	*more = false;
	/* nothing may follow, and the child must have ended well */
	if (fgetc(c->stream) != EOF)
		return damaged(c, error);
	code = eco_guard_finish(c->guard, error);
	c->guard = NULL;
	c->stream = NULL;
	return code;
}

static void close_child(struct eco_rows *rows)
{
	struct child *c = (struct child *)rows;

	eco_guard_finish(c->guard, NULL);
	eco_rows_free_texts(rows);
	free(c->message);
	free(c->path);
	free(c);
}

enum eco_code eco_rows_open(struct eco_rows **rows, const struct eco_rows_source *source, struct eco_error *error)
{
	struct child *c = calloc(1, sizeof *c);
	enum eco_code code;
	char kind = 0;

	_Static_assert(offsetof(struct child, rows) == 0, "struct eco_rows is the start of struct child");
	*rows = NULL;
	if (c == NULL)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", source->path);
	c->rows.next = next;
	c->rows.close = close_child;
	c->areas = source->areas;
	c->rows.fields = calloc(ECO_COLUMNS_MAX, sizeof *c->rows.fields);
	c->path = strdup(source->path);
	if (c->path == NULL || c->rows.fields == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", source->path);
	else
		code = eco_guard_start(&c->guard, work, (void *)source, source->path, NULL, &c->stream, error);
	if (code == ECO_OK)
		code = receive(c, &kind, error);
	if (code == ECO_OK)
		code = kind == 'H' ? get_head(c, error) : damaged(c, error);
	if (code == ECO_OK)
		*rows = &c->rows;
	else
		close_child(&c->rows);
	return code;
}
