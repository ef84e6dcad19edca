/* Tables as text. The header is the first line in which a position is found, so preambles and comments may precede it. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define FIELDS_MAX 512u
#define HEADER_LINES 50u

static struct track_text trim(const char *text, const char *end)
{
	while (text < end && (*text == ' ' || *text == '\t'))
		text++;
	while (end > text && (end[-1] == ' ' || end[-1] == '\t'))
		end--;
	bool quoted = end - text >= 2 && *text == '"' && end[-1] == '"';
	return (struct track_text){ text + quoted, end - quoted };
}

/* A separator of ' ' is any number of spaces. */
static uint32_t split(const char *at, const char *end, char separator, struct track_text fields[FIELDS_MAX])
{
	uint32_t count = 0;
	while (separator == ' ' && at < end && (*at == ' ' || *at == '\t'))
		at++;
	while (count < FIELDS_MAX) {
		const char *from = at;
		bool quoted = false;
		while (at < end && (quoted || (*at != separator && !(separator == ' ' && *at == '\t'))))
			quoted ^= *at++ == '"';
		fields[count++] = trim(from, at);
		while (separator == ' ' && at + 1 < end && (at[1] == ' ' || at[1] == '\t'))
			at++;
		if (at++ >= end || (separator == ' ' && at >= end))
			break;
	}
	return count;
}

static char find_separator(const char *text, const char *end)
{
	for (const char *mark = ";\t,|"; *mark; mark++)
		if (memchr(text, *mark, (size_t)(end - text)))
			return *mark;
	return ' ';
}

static enum eco_code no_columns(const struct track_input *in, struct eco_error *error)
{
	struct track_line line = { 0 };
	while (track_next_line(in, &line) && line.text == line.end)
		;
	return eco_fail(error, ECO_BAD_INPUT, "%.200s: no format is known that looks like this, and as a table it has no columns for a "
		"position; it begins \"%.*s\". If it is a table, say --columns t=NAME,lon=NAME,lat=NAME,alt=NAME or east=, north=, up= (or "
		"numbers of columns)", in->path, (int)(line.end - line.text < 160 ? line.end - line.text : 160), line.text);
}

/* Finds the header, if there is one: *line is read then; else it is as before the first row. */
static enum eco_code find_header(struct track_table *t, struct track_line *line, char *separator, struct track_text *fields,
	struct eco_error *error)
{
	struct eco_error cause = { 0 };
	struct track_line at = { 0 }, before = { 0 };
	for (; at.number < HEADER_LINES && track_next_line(t->in, &at); before = at) {
		const char *text = at.text;
		double number;
		while (text < at.end && *text && strchr("#% \t", *text))
			text++;
		*separator = find_separator(text, at.end);
		t->commas = *separator != ',';
		uint32_t count = split(text, at.end, *separator, fields);
		if (text == at.end || count < 2 || track_find_columns(t, fields, count, &cause) || !track_has_place(t))
			continue;
		bool is_row = track_is_number(fields[0].text, fields[0].end, &number) && track_is_number(fields[1].text, fields[1].end, &number);
		*line = is_row ? before : at;
		return ECO_OK;
	}
	return cause.code ? eco_fail(error, cause.code, "%.200s: %s", t->in->path, cause.text) : no_columns(t->in, error);
}

enum eco_code track_read_csv(struct eco_track *track, const struct track_input *in, struct eco_error *error)
{
	struct track_table table = { .in = in };
	struct track_line line = { 0 };
	struct track_text *fields = malloc(FIELDS_MAX * sizeof *fields);
	char separator = 0;
	enum eco_code code = fields ? find_header(&table, &line, &separator, fields, error) : eco_fail(error, ECO_NO_MEMORY, "out of memory");
	track->degrees = !code && track_has_degrees(&table);
	while (!code && track_next_line(in, &line)) {
		struct track_text text = trim(line.text, line.end);
		bool posed = track->posed;
		if (text.text == text.end || *text.text == '#')
			continue;
		struct eco_fix fix = track_row(&table, fields, split(line.text, line.end, separator, fields), line.number, &posed);
		track->posed = posed;
		code = track_add(track, &fix, error);
	}
	if (!code)
		track_say_columns(track, &table);
	free(fields);
	return code;
}
