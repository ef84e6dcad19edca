/* The report on an inventory: guesses first, then one table, in which a forester sees at a glance which
 * rows are in the scene and why the others are not. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "build/words/reasons.table"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/positions_parts.h"

#define LINE_BYTES 480u

const char *eco_skip_name(enum eco_skip reason)
{
	_Static_assert(sizeof reasons_rows / sizeof *reasons_rows == ECO_SKIP_COUNT, "reasons.tsv has a row for each reason");
	return reasons_rows[reason].name;
}

struct report {
	const struct eco_positions *reader;
	void (*say)(void *ctx, const char *text);
	void *ctx;
};

static void line(const struct report *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void line(const struct report *r, const char *format, ...)
{
	char text[LINE_BYTES];
	va_list arguments;
	va_start(arguments, format);
	eco_phrase_cut(text, sizeof text, vsnprintf(text, sizeof text, format, arguments));
	va_end(arguments);
	r->say(r->ctx, text);
}

static void count_line(const struct report *r, const struct eco_skipped *s, const char *where,
	const char *format, ...) __attribute__((format(printf, 4, 5)));
static void count_line(const struct report *r, const struct eco_skipped *s, const char *where,
	const char *format, ...)
{
	char reason[300], number[32];
	va_list arguments;
	if (s->count == 0)
		return;
	va_start(arguments, format);
	vsnprintf(reason, sizeof reason, format, arguments);
	va_end(arguments);
	line(r, "%12s  %s (first in %s %llu%s%s%s)", eco_phrase_count(s->count, number), reason, where,
		(unsigned long long)s->first_line, s->first_text[0] != 0 ? ": \"" : "", s->first_text,
		s->first_text[0] != 0 ? "\"" : "");
}

static void head_line(const struct report *r, const struct eco_positions_counts *c)
{
	const char *path = r->reader->spec->path;
	char rows[32], plants[32], extent[80] = "";
	double wide = c->high[0] - c->low[0], deep = c->high[1] - c->low[1];
	if (c->plants > 1 && (wide >= 1000 || deep >= 1000))
		snprintf(extent, sizeof extent, " within %.3g x %.3g km", wide / 1000, deep / 1000);
	else if (c->plants > 1)
		snprintf(extent, sizeof extent, " within %.3g x %.3g m", wide, deep);
	line(r, "%s: %s row%s, %s plant%s%s", path, eco_phrase_count(c->rows, rows), c->rows == 1 ? "" : "s",
		eco_phrase_count(c->plants, plants), c->plants == 1 ? "" : "s", extent);
	if (c->plants > 1 && wide == 0 && deep == 0)
		line(r, "%s: all of them stand at one point; are x, y the right columns?", path);
	else if (c->plants > 9 && wide < ECO_HEAP_M && deep < ECO_HEAP_M)
		line(r, "%s: all of them stand within a metre; are x, y in degrees? Then add \"crs\": "
			"\"EPSG:4326\"", path);
}

static void filter_lines(const struct report *r, const struct eco_positions_counts *c)
{
	for (uint32_t i = 0; i < r->reader->spec->filter_count; i++) {
		const struct eco_filter *f = &r->reader->spec->filters[i];
		count_line(r, &c->filters[i], c->where, f->variant_count > 0 ? "another plant: \"instead\" by \"%.60s\"" : f->only ? "left out: \"%.60s\" is none of \"only\""
			: "left out: \"skip\" of \"%.60s\"", f->column);
	}
}

static void key_lines(const struct report *r, const struct eco_positions_counts *c)
{
	const struct eco_positions_spec *s = r->reader->spec;
	char names[300] = "", key[ECO_SPECIES_BYTES + 3];
	uint32_t unused = 0;
	if (!s->species[0])
		return;
	for (uint32_t i = 0; i < s->map_count; i++) {
		if (s->map[i].plant == ECO_NONE)
			count_line(r, &c->keys[i], c->where, "left out by the map: %.80s", s->map[i].name);
		if (c->keys[i].count > 0)
			continue;
		snprintf(key, sizeof key, "\"%s\"", s->map[i].name);
		eco_phrase_add(names, sizeof names, key);
		unused++;
	}
	if (s->fallback.name && s->fallback.plant == ECO_NONE)
		count_line(r, &c->keys[s->map_count], c->where, "left out by the map: *");
	if (unused > 0 && c->rows > 0)
		line(r, "%12s  %u key%s of the map fit no row: %s", "", unused, unused == 1 ? "" : "s",
			names);
}

static void unknown_lines(const struct report *r, const struct eco_positions_counts *c)
{
	const struct eco_skipped *all = &c->skipped[ECO_SKIP_UNKNOWN_SPECIES];
	char number[32];
	count_line(r, all, c->where, "left out: %u species that the map does not have; add them, or \"*\"",
		c->unknown_species);
	for (uint32_t i = 0; i < ECO_UNKNOWN_MOST && all->count > 0; i++)
		if (c->unknown[i].count > 0)
			line(r, "%12s    of these %s: \"%s\"", "",
				eco_phrase_count(c->unknown[i].count, number), c->unknown[i].first_text);
}

/* How many heights and crowns were measured, and how many guessed. */
static void size_lines(const struct report *r)
{
	static const char *const names[ECO_SIZED_COUNT] = { "measured", "by the trunk", "by age", "as the scene says",
		"as the model", "measured", "guessed", "by the species", "by the genus", "by the form" };
	char texts[3][200] = { "", "", "" }, one[64], number[32];
	for (int i = 0; i < ECO_SIZED_COUNT; i++) {
		int kind = (i >= ECO_SIZED_CROWN) + (i >= ECO_SIZED_BY_SPECIES);
		snprintf(one, sizeof one, "%s %s", eco_phrase_count(r->reader->sizes[i], number), names[i]);
		if (r->reader->sizes[i] > 0)
			eco_phrase_add(texts[kind], sizeof texts[kind], one);
	}
	if (r->reader->spec->height_count > 0)
		line(r, "%12s  heights: %s%s%s", "", texts[0], texts[1][0] ? "; crowns: " : "", texts[1]);
	else if (texts[1][0] != 0)
		line(r, "%12s  crowns: %s", "", texts[1]);
	if (texts[2][0] != 0)
		line(r, "%12s  curves of guesses: %s", "", texts[2]);
}

void eco_positions_report(const struct eco_positions *reader, void (*say)(void *ctx, const char *text),
	void *ctx)
{
	const struct report r = { reader, say, ctx };
	struct eco_positions_counts c;
	eco_positions_counted(reader, &c);
	for (uint32_t i = 0; reader->rows && i < reader->rows->note_count; i++)
		line(&r, "%s: %s", reader->spec->path, reader->rows->notes[i]);
	if (c.rows == 0) {
		line(&r, "%s: it has no rows", reader->spec->path);
		return;
	}
	head_line(&r, &c);
	size_lines(&r);
	for (int i = 0; i < ECO_SKIP_COUNT; i++) {
		if (strcmp(reasons_rows[i].line, "-") != 0)
			count_line(&r, &c.skipped[i], c.where, "%s", reasons_rows[i].line);
		else if (i == ECO_SKIP_UNKNOWN_SPECIES)
			unknown_lines(&r, &c);
		else if (i == ECO_SKIP_LEFT_OUT)
			key_lines(&r, &c);
		else if (i == ECO_SKIP_FILTERED)
			filter_lines(&r, &c);
	}
}
