/* CSV, one byte at a time through stdio's buffer: a row is collected in one growing block, and fields are
 * offsets into it. A row that is not UTF-8 is taken as a whole for another encoding, by the words that the
 * file has then: many files mix the two. */
#include "ecofiles/import/places/rows/rows.h"

#include <errno.h>
#include <iconv.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/table_columns.h"

#define SNIFF_BYTES 65536u
#define TITLES_MAX 20            /* records before the names */
#define NAMES_LEAST 3            /* in the record of names below them */

struct csv {
	struct eco_rows rows;
	FILE *file;
	char *path, separator;
	char line_end;               /* '\n', also after a '\r'; or '\r' if the file has no other */
	char *text;
	size_t used, capacity;
	size_t *start;               /* of each field in text */
	char *converted;             /* the row converted to UTF-8, if it was not */
	size_t encoding;             /* of such rows */
	iconv_t converter;           /* of it, from the first such row on */
	uint64_t first_converted;    /* line; 0: none */
	uint64_t line;               /* of the next byte */
	struct eco_rows_point point; /* if has_geometry */
};

static enum eco_code put(struct csv *csv, char c, struct eco_error *error)
{
	if (csv->used == csv->capacity) {
		if (csv->used >= ECO_ROW_BYTES_MAX)
			return eco_fail(error, ECO_TOO_LARGE, "%.300s:%llu: a row of more than %u bytes; is "
				"a quote not closed?", csv->path, (unsigned long long)csv->rows.line,
				ECO_ROW_BYTES_MAX);
		csv->capacity = csv->capacity == 0 ? 4096 : csv->capacity * 2;
		csv->text = eco_realloc(csv->text, csv->capacity, 1);
	}
	csv->text[csv->used++] = c;
	return ECO_OK;
}

static int get(struct csv *csv)
{
	int c = getc_unlocked(csv->file);
	if (c == csv->line_end)
		c = '\n';
	csv->line += c == '\n';
	return c;
}

static int peek(struct csv *csv)
{
	int c = getc_unlocked(csv->file);
	ungetc(c, csv->file);
	return c;
}

static enum eco_code begin_field(struct csv *csv, struct eco_error *error)
{
	if (csv->rows.field_count == ECO_COLUMNS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s:%llu: a row of more than %u fields", csv->path,
			(unsigned long long)csv->rows.line, ECO_COLUMNS_MAX);
	csv->start[csv->rows.field_count++] = csv->used;
	return ECO_OK;
}

/* Reads one field; *c is the byte after it: separator, '\n' or EOF. */
static enum eco_code read_field(struct csv *csv, int *c, struct eco_error *error)
{
	bool quoted = false;
	enum eco_code code = begin_field(csv, error);
	*c = get(csv);
	if (*c == '"') {
		quoted = true;
		*c = get(csv);
	}
	for (; code == ECO_OK && *c != EOF; *c = get(csv)) {
		if (*c == 0)
			return eco_fail(error, ECO_BAD_INPUT, "%.300s:%llu: a zero byte; the file is not "
				"plain text (a spreadsheet, UTF-16?), save it as CSV in UTF-8", csv->path,
				(unsigned long long)csv->line);
		if (quoted && *c == '"') {
			if (peek(csv) == '"')
				code = put(csv, (char)get(csv), error);
			else
				quoted = false;
			continue;
		}
		if (!quoted && (*c == csv->separator || *c == '\n'))
			break;
		if (!quoted && *c == '\r' && peek(csv) == '\n')
			continue;
		code = put(csv, (char)*c, error);
	}
	if (code == ECO_OK && quoted)
		return eco_fail(error, ECO_DAMAGED, "%.300s:%llu: a quoted field of the row that begins "
			"here does not end", csv->path, (unsigned long long)csv->rows.line);
	return code == ECO_OK ? put(csv, 0, error) : code;
}

/* ---- Text that is not UTF-8 ---- */

static const char *const encodings[] = { "CP1252", "CP932", "GB18030", "CP949", "BIG5", "CP1250", "CP1251", "CP1253", "CP1254",
	"CP1255" };
#define ENCODINGS (sizeof encodings / sizeof *encodings)

/* Bytes of UTF-8 that a text takes in `to`, which has room for four times its size. Bytes that the encoding
 * lacks become question marks. */
static size_t convert(iconv_t state, const char *text, size_t size, char *to)
{
	char *in = (char *)(uintptr_t)text, *out = to;
	size_t left = size, room = 4 * size;
	if (state == (iconv_t)-1)                /* a system without that encoding */
		return memset(to, '?', size), size;
	while (left > 0 && iconv(state, &in, &left, &out, &room) == (size_t)-1 && left > 0) {
		*out++ = '?';
		in++;
		left--;
		room--;
	}
	iconv(state, NULL, NULL, &out, &room);   /* a last letter that waits for its marks, as in CP1255 */
	return (size_t)(out - to);
}

#define JUDGED 16384u            /* bytes at the beginning that tell the encoding */
#define HEADER_WORTH 20          /* a known name of a column against a known plant */
#define HEADER_LEAST 75          /* points of such a name: more than a lone letter has */

/* How many names of columns and plants a text has; what is no text of the encoding counts against it. */
static int words_known(char *text)
{
	int points = 0;
	bool header = true;
	for (char *line; (line = strsep(&text, "\r\n"));) {
		bool empty = *line == 0;
		for (char *field; (field = strsep(&line, ",;\t|\""));) {
			bool plain = true;
			for (const char *c = field; *c != 0; c++)
				plain &= (unsigned char)*c < 0x80;
			for (int role = 0; header && !plain && role < ECO_ROLE_COUNT; role++)
				points += eco_column_points((enum eco_role)role, field) >= HEADER_LEAST ? HEADER_WORTH : 0;
			points += !header && !plain && eco_flora_of(field, NULL).genus ? 1 : 0;
			points -= strchr(field, '?') ? 1 : 0;
		}
		header = header && empty;
	}
	return points;
}

/* Ties: the earlier one. */
static size_t find_encoding(const char *head, size_t size)
{
	size = size < JUDGED ? size : JUDGED;
	char *text = eco_alloc(4 * size + 1, 1);
	size_t best = 0;
	int most = -INT_MAX;
	for (size_t i = 0; i < ENCODINGS; i++) {
		iconv_t state = iconv_open("UTF-8", encodings[i]);
		text[convert(state, head, size, text)] = 0;
		if (state != (iconv_t)-1)
			iconv_close(state);
		int own = words_known(text);
		best = own > most ? i : best;
		most = own > most ? own : most;
	}
	free(text);
	return best;
}

static void convert_fields(struct csv *csv)
{
	char *grown = csv->converted = eco_realloc(csv->converted, 4 * csv->used + 1, 1);
	size_t used = 0;
	if (csv->first_converted == 0)
		csv->converter = iconv_open("UTF-8", encodings[csv->encoding]);
	for (uint32_t i = 0; i < csv->rows.field_count; i++) {
		const char *text = csv->text + csv->start[i];
		csv->rows.fields[i] = grown + used;
		used += convert(csv->converter, text, strlen(text), grown + used);
		grown[used++] = 0;
	}
	if (csv->first_converted == 0) {
		csv->first_converted = csv->rows.line;
		eco_rows_note(&csv->rows, "its text is not UTF-8 (first in line %llu): it is read as %s", (unsigned long long)
			csv->rows.line, csv->encoding == 0 ? "Windows-1252, which contains Latin-1" : encodings[csv->encoding]);
	}
}

static void set_fields(struct csv *csv)
{
	for (uint32_t i = 0; i < csv->rows.field_count; i++) {
		csv->rows.fields[i] = csv->text + csv->start[i];
		if (!eco_utf8_valid(csv->rows.fields[i], strlen(csv->rows.fields[i]))) {
			convert_fields(csv);
			return;
		}
	}
}

/* ---- Rows ---- */

static enum eco_code read_row(struct csv *csv, bool *more, struct eco_error *error)
{
	int c = '\n';
	csv->used = 0;
	csv->rows.field_count = 0;
	while ((c = peek(csv)) == '\n' || c == '\r')
		get(csv);
	*more = c != EOF;
	csv->rows.line = csv->line;
	while (*more) {
		ECO_PASS(read_field(csv, &c, error));
		if (c != csv->separator)
			break;
	}
	if (ferror(csv->file))
		return eco_fail_read(error, csv->path, errno);
	if (*more)
		set_fields(csv);
	return ECO_OK;
}

/* ---- Points as text ---- */

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct csv *csv = (struct csv *)rows;
	enum eco_code code = read_row(csv, more, error);
	rows->row += code == ECO_OK && *more;
	if (code == ECO_OK && *more && rows->has_geometry)
		eco_rows_point_take(rows, &csv->point);
	return code;
}

/* Looks for a column with points in the first rows, and goes back. Errors of a row are reported when it is
 * read. */
static enum eco_code find_points(struct csv *csv, struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	long from = ftell(csv->file);
	uint64_t line = csv->line;
	bool more = from >= 0, found = false;
	for (int row = 0; row < (int)ECO_ROWS_POINT_LOOK && more && !found; row++)
		found = read_row(csv, &more, &own) == ECO_OK && more
			&& eco_rows_point_find(&csv->rows, &csv->point);
	csv->line = line;
	if (from < 0 || fseek(csv->file, from, SEEK_SET) != 0)
		return eco_fail_read(error, csv->path, errno);
	if (found)
		eco_rows_point_state(&csv->rows, &csv->point);
	return ECO_OK;
}

static void close_csv(struct eco_rows *rows)
{
	struct csv *csv = (struct csv *)rows;
	eco_rows_free_texts(rows);
	eco_free(csv->start, csv->text, csv->converted);
	if (csv->first_converted && csv->converter != (iconv_t)-1)
		iconv_close(csv->converter);
	free(csv->path);
	if (csv->file)
		fclose(csv->file);
	free(csv);
}

/* A copy without surrounding spaces, malloc'ed. */
static char *trimmed(const char *name)
{
	name += strspn(name, " \t\r");
	size_t size = strlen(name);
	while (size > 0 && strchr(" \t\r", name[size - 1]))
		size--;
	return eco_copy_part(name, size);
}

/* ---- The beginning of the file ---- */

/* Excel's "sep=;" line. */
static bool excel_separator(const char *text, char *separator)
{
	if (strncmp(text, "sep=", 4) != 0 || text[4] == 0
			|| (text[5] != '\n' && text[5] != '\r' && text[5] != 0))
		return false;
	*separator = text[4];
	return true;
}

/* The separator that is most frequent outside quotes in the first line; ',' if equal. */
static char count_separators(const char *text)
{
	static const char signs[] = { ',', ';', '\t', '|' };
	uint32_t counts[sizeof signs] = { 0 };
	size_t best = 0;
	bool quoted = false;
	for (; *text != 0 && (quoted || (*text != '\n' && *text != '\r')); text++) {
		quoted ^= *text == '"';
		for (size_t i = 0; !quoted && i < sizeof signs; i++)
			counts[i] += *text == signs[i];
	}
	for (size_t i = 1; i < sizeof signs; i++)
		if (counts[i] > counts[best])
			best = i;
	return signs[best];
}

/* Fields of the record at `*text` that are not empty, and goes behind it; *lines are its line ends. */
static unsigned filled_fields(const char **text, char separator, unsigned *lines)
{
	bool quoted = false, filled = false;
	unsigned count = 0;
	const char *at = *text;
	for (; *at != 0 && (quoted || (*at != '\n' && *at != '\r')); at++) {
		quoted ^= *at == '"';
		*lines += *at == '\n';
		bool ends = !quoted && *at == separator;
		count += ends && filled;
		filled = !ends && (filled || (*at != ' ' && *at != '"'));
	}
	*lines += *at != 0;
	at += at[0] == '\r' && at[1] == '\n';
	*text = at + (*at != 0);
	return count + filled;
}

/* Titles, dates and empty lines before the table, as reports have them: records of one field at most, before
 * one of several. */
static const char *skip_titles(struct csv *csv, const char *text)
{
	const char *at = text;
	unsigned lines = 0, titles = 0;
	for (int record = 0; *at != 0 && record < TITLES_MAX; record++) {
		const char *names = at;
		unsigned before = lines, filled = filled_fields(&at, csv->separator ? csv->separator
			: count_separators(at), &lines);
		if (filled >= NAMES_LEAST && titles > 0) {
			csv->line += before;
			eco_rows_note(&csv->rows,
				"lines before line %llu are no table: that line names the "
				"columns", (unsigned long long)csv->line);
			return names;
		}
		if (filled > 1)
			break;
		titles += filled;
	}
	return text;
}

/* Skips the byte order mark, a "sep=" line and titles, and determines the separator. */
static enum eco_code begin_file(struct csv *csv, struct eco_error *error)
{
	char *head = eco_alloc(SNIFF_BYTES + 1, 1);
	const char *text = head;
	size_t size = fread(head, 1, SNIFF_BYTES, csv->file);
	if (size >= 3 && memcmp(head, "\xef\xbb\xbf", 3) == 0)
		text += 3;
	if (excel_separator(text, &csv->separator)) {
		text += strcspn(text, "\r\n");
		text += *text == '\r';
		text += *text == '\n';
		csv->line = 2;
	}
	text = skip_titles(csv, text);
	if (!eco_utf8_valid(head, size < SNIFF_BYTES ? size : SNIFF_BYTES - 3))
		csv->encoding = find_encoding(text, size - (size_t)(text - head));
	if (csv->separator == 0) {
		csv->separator = count_separators(text + strspn(text, "\r\n"));
		if (csv->separator != ',')
			eco_rows_note(&csv->rows, csv->separator == '\t' ? "its columns are separated by tabs"
				: "its columns are separated by \"%c\"", csv->separator);
	}
	if (!memchr(head, '\n', size) && memchr(head, '\r', size))
		csv->line_end = '\r';
	bool good = !ferror(csv->file) && fseek(csv->file, (long)(text - head), SEEK_SET) == 0;
	free(head);
	return good ? ECO_OK : eco_fail_read(error, csv->path, errno);
}

static enum eco_code read_header(struct csv *csv, struct eco_error *error)
{
	bool more;
	enum eco_code code = begin_file(csv, error);
	if (!code)
		code = read_row(csv, &more, error);
	if (code == ECO_OK && !more)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: an empty file; its first row must name the "
			"columns", csv->path);
	for (uint32_t i = 0; code == ECO_OK && i < csv->rows.field_count; i++)
		csv->rows.columns[csv->rows.column_count++] = trimmed(csv->rows.fields[i]);
	return code == ECO_OK ? find_points(csv, error) : code;
}

enum eco_code eco_rows_open_csv(struct eco_rows **rows, const char *path, char separator,
	struct eco_error *error)
{
	struct csv *csv = eco_alloc(1, sizeof *csv);
	enum eco_code code;
	_Static_assert(offsetof(struct csv, rows) == 0, "struct eco_rows is the start of struct csv");
	*rows = NULL;
	csv->rows.next = next;
	csv->rows.close = close_csv;
	csv->separator = separator;
	csv->rows.where = "line";
	csv->line = 1;
	csv->line_end = '\n';
	csv->path = eco_copy_text(path);
	csv->rows.columns = eco_alloc(ECO_COLUMNS_MAX, sizeof *csv->rows.columns);
	csv->rows.fields = eco_alloc(ECO_COLUMNS_MAX, sizeof *csv->rows.fields);
	csv->start = eco_alloc(ECO_COLUMNS_MAX, sizeof *csv->start);
	if (!(csv->file = fopen(path, "rb")))
		code = eco_fail_read(error, path, errno);
	else
		code = read_header(csv, error);
	if (!code)
		*rows = &csv->rows;
	else
		close_csv(&csv->rows);
	return code;
}
