/* A table is read in a child process (guard.h) and handed over row by row through a pipe, so that reading
 * and placing overlap and nobody holds the whole file. Messages are checked like a stranger's, because
 * after a bug in a library they are.
 *
 *   message  u32 bytes of the rest, u8 kind, then by kind
 *   'H'      head: u8 geometry | z << 1 | doubted << 2, u32 columns, texts: where, crs (""
 *            none), no_crs, names of columns
 *   'N'      note: text
 *   'R'      row: u64 row, u64 line, u8 place, f64 at[3], text what, u32 area bytes, the area, u32
 *            fields, texts (unneeded ones are empty)
 *   'E'      end: u64 rows
 *
 * Numbers are little-endian. A text ends with 0. */
#include "ecofiles/import/places/rows/rows.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/import/places/rows/rows_formats.h"

#define MESSAGE_MAX (4u * ECO_ROW_BYTES_MAX)
#define AREA_MESSAGE_MAX (1u << 29)
#define WRITE_BUFFER (1u << 16)

static uint32_t message_most(bool areas) { return areas ? AREA_MESSAGE_MAX : MESSAGE_MAX; }

/* ---- The child ---- */

static void put_text(struct eco_writer *m, const char *text)
{
	eco_write_bytes(m, text, strlen(text) + 1);
}

static void begin(struct eco_writer *m, char kind)
{
	m->size = 0;
	eco_write_u8(m, (uint8_t)kind);
}

static enum eco_code send_message(const struct eco_writer *m, uint32_t most, FILE *out,
	struct eco_error *error)
{
	uint32_t size = (uint32_t)m->size;
	if (m->failed)
		return eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (m->size > most)
		return eco_fail(error, ECO_TOO_LARGE, "a row of more than %u bytes", ECO_ROW_BYTES_MAX);
	return fwrite(&size, 4, 1, out) == 1 && fwrite(m->bytes, 1, size, out) == size ? ECO_OK
		: eco_fail(error, ECO_IO, "nobody reads on");
}

static void put_head(const struct eco_rows *rows, struct eco_writer *m)
{
	begin(m, 'H');
	eco_write_u8(m, (uint8_t)(rows->has_geometry | rows->has_z << 1 | rows->degrees_doubted << 2));
	eco_write_u32(m, rows->column_count);
	put_text(m, rows->where);
	put_text(m, rows->crs ? rows->crs : "");
	put_text(m, rows->no_crs);
	for (uint32_t i = 0; i < rows->column_count; i++)
		put_text(m, rows->columns[i]);
}

static enum eco_code send_notes(const struct eco_rows *rows, uint32_t *sent, struct eco_writer *m, FILE *out,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (; *sent < rows->note_count && code == ECO_OK; ++*sent) {
		begin(m, 'N');
		put_text(m, rows->notes[*sent]);
		code = send_message(m, MESSAGE_MAX, out, error);
	}
	return code;
}

static void put_row(const struct eco_rows *rows, const bool *wanted, struct eco_writer *m)
{
	const struct eco_rows_place *place = &rows->place;
	uint32_t area_bytes = place->kind == ECO_PLACE_AREA ? place->wkb_bytes : 0;
	begin(m, 'R');
	eco_write_u64(m, rows->row);
	eco_write_u64(m, rows->line);
	eco_write_u8(m, (uint8_t)place->kind);
	for (int k = 0; k < 3; k++)
		eco_write_f64(m, place->at[k]);
	put_text(m, place->what);
	eco_write_u32(m, area_bytes);
	eco_write_bytes(m, place->wkb, area_bytes);
	eco_write_u32(m, rows->field_count);
	for (uint32_t i = 0; i < rows->field_count; i++)
		put_text(m, i < rows->column_count && wanted[i] ? rows->fields[i] : "");
}

static void find_wanted(const struct eco_rows *rows, const struct eco_rows_source *source, bool *wanted)
{
	for (uint32_t i = 0; i < rows->column_count; i++) {
		wanted[i] = !source->wanted;
		for (uint32_t k = 0; source->wanted && k < source->wanted_count; k++)
			wanted[i] |= strcmp(rows->columns[i], source->wanted[k]) == 0;
	}
}

static enum eco_code send_rows(struct eco_rows *rows, const struct eco_rows_source *source,
	struct eco_writer *m, FILE *out, struct eco_error *error)
{
	bool *wanted = calloc(rows->column_count + 1u, sizeof *wanted), more = true;
	uint32_t notes = 0, most = message_most(source->areas);
	enum eco_code code = wanted ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	if (!code) {
		find_wanted(rows, source, wanted);
		put_head(rows, m);
		code = send_message(m, most, out, error);
	}
	while (code == ECO_OK && more) {
		code = send_notes(rows, &notes, m, out, error);
		if (!code)
			code = rows->next(rows, &more, error);
		if (code != ECO_OK || !more)
			break;
		put_row(rows, wanted, m);
		code = send_message(m, most, out, error);
	}
	if (!code)
		code = send_notes(rows, &notes, m, out, error);
	if (!code) {
		begin(m, 'E');
		eco_write_u64(m, rows->row);
		code = send_message(m, most, out, error);
	}
	free(wanted);
	return code;
}

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct eco_rows_source *source = ctx;
	struct eco_rows *rows = NULL;
	struct eco_writer m = { .bytes = NULL };
	setvbuf(out, NULL, _IOFBF, WRITE_BUFFER);
	enum eco_code code = eco_rows_open_here(&rows, source, error);
	if (!code)
		code = send_rows(rows, source, &m, out, error);
	eco_rows_close(rows);
	eco_writer_free(&m);
	return code;
}

/* ---- The parent ---- */

struct child {
	struct eco_rows rows;
	struct eco_guard *guard;
	FILE *stream;
	char *path, where[32];
	uint8_t *message; size_t capacity;
	struct eco_reader reader;            /* of the message, behind its kind */
	uint32_t most;                       /* size of the largest message */
};

static enum eco_code damaged(const struct child *c, struct eco_error *error)
{
	return eco_fail(error, ECO_DAMAGED, "%.300s: the data from its reader make no sense: the file is "
		"damaged, or meets a bug in the library that reads it", c->path);
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
	if (!c->stream)
		return damaged(c, error);
	if (fread(&size, 4, 1, c->stream) != 1)
		return ended(c, error);
	if (size < 1 || size > c->most)
		return damaged(c, error);
	if (size > c->capacity) {
		uint8_t *grown = realloc(c->message, 2 * (size_t)size);
		if (!grown)
			return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
		c->message = grown;
		c->capacity = 2 * (size_t)size;
	}
	if (fread(c->message, 1, size, c->stream) != size)
		return ended(c, error);
	c->reader = (struct eco_reader){ .bytes = c->message, .size = size };
	*kind = (char)eco_read_u8(&c->reader);
	return ECO_OK;
}

/* A text of the message; "" if there is none, and the reader has failed. */
static const char *get_text(struct eco_reader *r)
{
	const char *text = (const char *)r->bytes + r->at;
	const char *end = r->failed ? NULL : memchr(text, 0, r->size - r->at);
	r->failed = !end;
	if (!end)
		return "";
	r->at += (size_t)(end - text) + 1;
	return text;
}

static enum eco_code whole(const struct child *c, struct eco_error *error)
{
	return !c->reader.failed && c->reader.at == c->reader.size ? ECO_OK : damaged(c, error);
}

static enum eco_code get_head(struct child *c, struct eco_error *error)
{
	struct eco_rows *rows = &c->rows;
	struct eco_reader *r = &c->reader;
	uint8_t flags = eco_read_u8(r);
	uint32_t columns = eco_read_u32(r);
	snprintf(c->where, sizeof c->where, "%.31s", get_text(r));
	rows->where = c->where;
	rows->has_geometry = flags & 1;
	rows->has_z = flags >> 1 & 1;
	rows->degrees_doubted = flags >> 2 & 1;
	const char *crs = get_text(r);
	snprintf(rows->no_crs, sizeof rows->no_crs, "%.111s", get_text(r));
	if (r->failed || columns > ECO_COLUMNS_MAX || strlen(crs) > ECO_ROWS_CRS_BYTES)
		return damaged(c, error);
	rows->columns = calloc(columns + 1u, sizeof *rows->columns);
	rows->crs = *crs != 0 ? strdup(crs) : NULL;
	if (!rows->columns || (*crs != 0 && !rows->crs))
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
	for (; rows->column_count < columns; rows->column_count++)
		if (!(rows->columns[rows->column_count] = strdup(get_text(r))))
			return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", c->path);
	return whole(c, error);
}

static bool get_place(struct eco_reader *r, struct eco_rows_place *place)
{
	uint8_t kind = eco_read_u8(r);
	for (int k = 0; k < 3; k++)
		place->at[k] = eco_read_f64(r);
	snprintf(place->what, sizeof place->what, "%.15s", get_text(r));
	place->wkb_bytes = eco_read_u32(r);
	place->wkb = eco_read_bytes(r, place->wkb_bytes);
	place->kind = (enum eco_place_kind)kind;
	return !r->failed && kind < ECO_PLACE_COUNT;
}

static enum eco_code get_row(struct child *c, struct eco_error *error)
{
	struct eco_rows *rows = &c->rows;
	struct eco_reader *r = &c->reader;
	uint64_t before = rows->row;
	rows->row = eco_read_u64(r);
	rows->line = eco_read_u64(r);
	if (!get_place(r, &rows->place) || rows->row <= before)
		return damaged(c, error);
	rows->field_count = eco_read_u32(r);
	if (rows->field_count > ECO_COLUMNS_MAX)
		return damaged(c, error);
	for (uint32_t i = 0; i < rows->field_count; i++)
		rows->fields[i] = get_text(r);
	return whole(c, error);
}

static enum eco_code get_note(struct child *c, struct eco_error *error)
{
	eco_rows_note(&c->rows, "%s", get_text(&c->reader));
	return whole(c, error);
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
	if (code)
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

enum eco_code eco_rows_open(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error)
{
	struct child *c = calloc(1, sizeof *c);
	struct eco_guard_limits limits = { .memory_bytes = eco_guard_small_memory(&source->path, 1) };
	enum eco_code code;
	char kind = 0;
	_Static_assert(offsetof(struct child, rows) == 0, "struct eco_rows is the start of struct child");
	*rows = NULL;
	if (!c)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", source->path);
	c->rows.next = next;
	c->rows.close = close_child;
	c->most = message_most(source->areas);
	c->rows.fields = calloc(ECO_COLUMNS_MAX, sizeof *c->rows.fields);
	c->path = strdup(source->path);
	if (!c->path || !c->rows.fields)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", source->path);
	else
		code = eco_guard_start(&c->guard, work, (void *)source, source->path, &limits, &c->stream,
			error);
	if (!code)
		code = receive(c, &kind, error);
	if (!code)
		code = kind == 'H' ? get_head(c, error) : damaged(c, error);
	if (!code)
		*rows = &c->rows;
	else
		close_child(&c->rows);
	return code;
}
