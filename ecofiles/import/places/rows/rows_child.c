/* A table is read in a child process (guard.h) and handed over row by row through a pipe, so that reading
 * and placing overlap and nobody holds the whole file. A message is a struct as it lies in memory, as both
 * ends are one program, then its texts, each with its ending 0, and the area. The parent checks each
 * message: after a bug in a library it may be anything. */
#include "ecofiles/import/places/rows/rows.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"

#define TEXT_MAX (4u * ECO_ROW_BYTES_MAX)
#define AREA_MAX (1u << 29)
#define WRITE_BUFFER (1u << 16)
#define HEAD_TEXTS 3u            /* before the columns' names: where, crs ("": none), no_crs */

struct message {
	char kind;               /* H: head; N: a note; R: a row; E: the end */
	uint8_t has_geometry, has_z, degrees_doubted;    /* of a head */
	uint32_t texts, text_bytes;
	uint64_t row, line;
	struct eco_rows_place place;     /* its pointer means nothing */
};

/* ---- The child ---- */

/* Sends the texts that `wanted` marks (NULL: all), and empty ones in place of the others. */
static enum eco_code send_message(FILE *out, struct message *m, const char *const *texts, const bool *wanted,
	struct eco_error *error)
{
	const uint32_t area_bytes = m->place.kind == ECO_PLACE_AREA ? m->place.wkb_bytes : 0;
	size_t size = 0;
	for (uint32_t i = 0; i < m->texts; i++)
		size += (!wanted || wanted[i] ? strlen(texts[i]) : 0) + 1;
	if (size > TEXT_MAX || area_bytes > AREA_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "a row of more than %u bytes", ECO_ROW_BYTES_MAX);
	m->text_bytes = (uint32_t)size;
	bool good = fwrite(m, sizeof *m, 1, out) == 1;
	for (uint32_t i = 0; good && i < m->texts; i++)
		good = fputs(!wanted || wanted[i] ? texts[i] : "", out) >= 0 && putc(0, out) == 0;
	good = good && (!area_bytes || fwrite(m->place.wkb, 1, area_bytes, out) == area_bytes);
	return good ? ECO_OK : eco_fail(error, ECO_IO, "nobody reads on");
}

static enum eco_code send_head(FILE *out, const struct eco_rows *rows, struct eco_error *error)
{
	struct message m = { .kind = 'H', .has_geometry = rows->has_geometry, .has_z = rows->has_z,
		.degrees_doubted = rows->degrees_doubted, .texts = HEAD_TEXTS + rows->column_count };
	const char **texts = eco_alloc(m.texts, sizeof *texts);
	texts[0] = rows->where;
	texts[1] = rows->crs ? rows->crs : "";
	texts[2] = rows->no_crs;
	for (uint32_t i = 0; i < rows->column_count; i++)
		texts[HEAD_TEXTS + i] = rows->columns[i];
	enum eco_code code = send_message(out, &m, texts, NULL, error);
	free(texts);
	return code;
}

static enum eco_code send_notes(FILE *out, const struct eco_rows *rows, uint32_t *sent,
	struct eco_error *error)
{
	for (; *sent < rows->note_count; ++*sent)
		ECO_PASS(send_message(out, &(struct message){ .kind = 'N', .texts = 1 },
			(const char *const *)&rows->notes[*sent], NULL, error));
	return ECO_OK;
}

static void find_wanted(const struct eco_rows *rows, const struct eco_rows_source *source, bool *wanted)
{
	for (uint32_t i = 0; i < rows->column_count; i++) {
		wanted[i] = !source->wanted;
		for (uint32_t k = 0; source->wanted && k < source->wanted_count; k++)
			wanted[i] |= strcmp(rows->columns[i], source->wanted[k]) == 0;
	}
}

static enum eco_code send_rows(FILE *out, struct eco_rows *rows, const struct eco_rows_source *source,
	struct eco_error *error)
{
	static bool wanted[ECO_COLUMNS_MAX];     /* fields beyond the columns are not */
	uint32_t notes = 0;
	bool more = true;
	find_wanted(rows, source, wanted);
	enum eco_code code = send_head(out, rows, error);
	while (!code && more) {
		code = send_notes(out, rows, &notes, error);
		if (!code)
			code = rows->next(rows, &more, error);
		if (!code && more)
			code = send_message(out, &(struct message){ .kind = 'R', .texts = rows->field_count,
				.row = rows->row, .line = rows->line, .place = rows->place }, rows->fields,
				wanted,
				error);
	}
	if (!code)
		code = send_notes(out, rows, &notes, error);
	return code ? code : send_message(out, &(struct message){ .kind = 'E' }, NULL, NULL, error);
}

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	const struct eco_rows_source *source = ctx;
	struct eco_rows *rows = NULL;
	setvbuf(out, NULL, _IOFBF, WRITE_BUFFER);
	enum eco_code code = eco_rows_open_here(&rows, source, error);
	if (!code)
		code = send_rows(out, rows, source, error);
	eco_rows_close(rows);
	return code;
}

/* ---- The parent ---- */

struct child {
	struct eco_rows rows;
	struct eco_guard *guard;
	FILE *stream;
	char *path, where[32];
	struct message message;
	char *body; size_t capacity;
	const char *texts[HEAD_TEXTS + ECO_COLUMNS_MAX];
};

static enum eco_code damaged(const struct child *c, struct eco_error *error)
{
	return eco_fail(error, ECO_DAMAGED, "%.300s: the data from its reader are impossible: the file is "
		"damaged, or meets a bug in the library that reads it", c->path);
}

static enum eco_code finish(struct child *c, struct eco_error *error)
{
	enum eco_code code = eco_guard_finish(c->guard, error);
	c->guard = NULL;
	c->stream = NULL;
	return code;
}

/* The stream ended early: reports how the child ended. */
static enum eco_code ended(struct child *c, struct eco_error *error)
{
	enum eco_code code = finish(c, error);
	return code ? code : damaged(c, error);
}

/* False: there are not as many texts as the message says, or something is behind them. */
static bool find_texts(struct child *c)
{
	const char *at = c->body, *end = at + c->message.text_bytes;
	for (uint32_t i = 0; i < c->message.texts; i++) {
		c->texts[i] = at;
		at = at < end ? memchr(at, 0, (size_t)(end - at)) : NULL;
		if (!at++)
			return false;
	}
	return at == end;
}

static enum eco_code receive(struct child *c, struct eco_error *error)
{
	struct message *m = &c->message;
	if (!c->stream)
		return damaged(c, error);
	if (fread(m, sizeof *m, 1, c->stream) != 1)
		return ended(c, error);
	const uint32_t area_bytes = m->place.kind == ECO_PLACE_AREA ? m->place.wkb_bytes : 0;
	const size_t size = (size_t)m->text_bytes + area_bytes;
	if (m->texts > HEAD_TEXTS + ECO_COLUMNS_MAX || m->text_bytes > TEXT_MAX || area_bytes > AREA_MAX
			|| (unsigned)m->place.kind >= ECO_PLACE_COUNT)
		return damaged(c, error);
	if (size > c->capacity) {
		c->capacity = 2 * size;
		c->body = eco_realloc(c->body, c->capacity, 1);
	}
	if (fread(c->body, 1, size, c->stream) != size)
		return ended(c, error);
	m->place.what[sizeof m->place.what - 1] = 0;
	m->place.wkb = (const uint8_t *)c->body + m->text_bytes;
	return find_texts(c) ? ECO_OK : damaged(c, error);
}

static enum eco_code get_head(struct child *c, struct eco_error *error)
{
	struct eco_rows *rows = &c->rows;
	const struct message *m = &c->message;
	const char *crs = c->texts[1];
	if (m->kind != 'H' || m->texts < HEAD_TEXTS || strlen(crs) > ECO_ROWS_CRS_BYTES)
		return damaged(c, error);
	snprintf(c->where, sizeof c->where, "%.31s", c->texts[0]);
	snprintf(rows->no_crs, sizeof rows->no_crs, "%.111s", c->texts[2]);
	rows->where = c->where;
	rows->has_geometry = m->has_geometry;
	rows->has_z = m->has_z;
	rows->degrees_doubted = m->degrees_doubted;
	rows->columns = eco_alloc(m->texts, sizeof *rows->columns);
	rows->crs = *crs ? eco_copy_text(crs) : NULL;
	for (uint32_t i = HEAD_TEXTS; i < m->texts; i++)
		rows->columns[rows->column_count++] = eco_copy_text(c->texts[i]);
	return ECO_OK;
}

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct child *c = (struct child *)rows;
	const struct message *m = &c->message;
	enum eco_code code;
	while (!(code = receive(c, error)) && m->kind == 'N' && m->texts == 1)
		eco_rows_note(rows, "%s", c->texts[0]);
	if (code)
		return code;
	*more = m->kind == 'R';
	if (*more && m->row > rows->row && m->texts <= ECO_COLUMNS_MAX) {
		rows->row = m->row;
		rows->line = m->line;
		rows->place = m->place;
		rows->field_count = m->texts;
		return ECO_OK;
	}
	/* nothing may follow, and the child must have ended well */
	return m->kind == 'E' && fgetc(c->stream) == EOF ? finish(c, error) : damaged(c, error);
}

static void close_child(struct eco_rows *rows)
{
	struct child *c = (struct child *)rows;
	eco_guard_finish(c->guard, NULL);
	rows->fields = NULL;
	eco_rows_free_texts(rows);
	eco_free(c->body, c->path, c);
}

enum eco_code eco_rows_open(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error)
{
	struct child *c = eco_alloc(1, sizeof *c);
	struct eco_guard_limits limits = { .memory_bytes = eco_guard_small_memory(&source->path, 1) };
	_Static_assert(offsetof(struct child, rows) == 0, "struct eco_rows is the start of struct child");
	*rows = NULL;
	c->path = eco_copy_text(source->path);
	c->rows.next = next;
	c->rows.close = close_child;
	c->rows.fields = c->texts;
	enum eco_code code = eco_guard_start(&c->guard, work, (void *)source, source->path, &limits,
		&c->stream,
		error);
	if (!code)
		code = receive(c, error);
	if (!code)
		code = get_head(c, error);
	if (!code)
		*rows = &c->rows;
	else
		close_child(&c->rows);
	return code;
}
