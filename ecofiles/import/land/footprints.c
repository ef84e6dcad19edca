#include "ecofiles/import/land/footprints.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/roofs.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/words.h"

const char *const eco_roof_names[ECO_ROOF_COUNT] = { "flat", "hipped", "gabled", "pyramidal", "shed" };

enum eco_roof eco_roof_of(const char *text)
{
	for (size_t i = 0; i < sizeof roofs_rows / sizeof *roofs_rows; i++)
		if (eco_words_any(text, roofs_rows[i].words))
			for (int form = 0; form < ECO_ROOF_COUNT; form++)
				if (strcmp(eco_roof_names[form], roofs_rows[i].roof) == 0)
					return (enum eco_roof)form;
	return ECO_ROOF_COUNT;
}

struct reading {
	struct eco_footprints *to;
	const struct eco_footprints_spec *spec;
	uint32_t capacity;
};

#define NOTE(what, line, text) \
	do { \
		if ((what)->count++ == 0) { \
			(what)->first_line = line; \
			eco_phrase_cut((what)->example, sizeof(what)->example, \
				snprintf((what)->example, sizeof(what)->example, "%s", text)); \
		} \
	} while (0)

/* The height that a column's text tells; 0: none. */
static double height_of(struct eco_footprints *f, const struct eco_footprint_height *source, const char *text,
	uint64_t line)
{
	double number = 0, unit_m = 0;
	if (!source->column)
		return source->value_m;
	if (!text || eco_text_is_missing(text))
		return 0;
	enum eco_size_form form = eco_text_size(text, '.', &number, &unit_m);
	double height = number * (unit_m > 0 && !source->storeys ? unit_m : source->unit_m);
	if (form != ECO_FORM_NONE && form != ECO_FORM_STEMS && height > 0 && height <= ECO_BUILDING_MOST_M)
		return height;
	NOTE(&f->unusable, line, text);
	return 0;
}

static enum eco_roof roof_of(struct eco_footprints *f, const char *text, uint64_t line)
{
	if (!text || eco_text_is_missing(text))
		return ECO_ROOF_FLAT;
	enum eco_roof roof = eco_roof_of(text);
	if (roof != ECO_ROOF_COUNT)
		return roof;
	NOTE(&f->unknown, line, text);
	return ECO_ROOF_FLAT;
}

static bool take(void *ctx, uint32_t area, const struct eco_rows *rows, const char *const *texts)
{
	struct reading *r = ctx;
	const uint64_t line = rows->line;
	struct eco_footprints *f = r->to;
	struct eco_footprint item = { .roof = roof_of(f, texts[ECO_FOOTPRINT_HEIGHTS], line) };
	for (uint32_t i = 0; i < r->spec->height_count && !(item.height_m > 0); i++) {
		item.height_m = height_of(f, &r->spec->heights[i], texts[i], line);
		item.to_eaves = r->spec->heights[i].storeys;
		if (i > 0 && !r->spec->heights[i].column)
			NOTE(&f->by_number, line, "");
	}
	if (!(item.height_m > 0)) {
		NOTE(&f->untold, line, "");
		item = (struct eco_footprint){ ECO_BUILDING_M, false, item.roof };
	}
	eco_grow(&f->items, &r->capacity, area, sizeof *f->items);
	f->items[area] = item;
	return true;
}

enum eco_code eco_footprints_read(struct eco_footprints *footprints, const struct eco_footprints_spec *spec,
	const struct eco_frame *frame, struct eco_error *error)
{
	const char *columns[ECO_FOOTPRINT_HEIGHTS + 1] = { NULL };
	struct reading r = { footprints, spec, 0 };
	for (uint32_t i = 0; i < spec->height_count; i++)
		columns[i] = spec->heights[i].column;
	columns[ECO_FOOTPRINT_HEIGHTS] = spec->roof;
	const struct eco_areas_request request = { .path = spec->path, .layer = spec->layer, .crs = spec->crs,
		.filters = spec->filters, .filter_count = spec->filter_count, .columns = columns,
		.column_count = ECO_FOOTPRINT_HEIGHTS + 1, .take = take, .ctx = &r, .surfaces = true };
	ECO_PASS(eco_areas_read(&footprints->areas, &request, frame, &footprints->report, error));
	return footprints->areas.count ? ECO_OK : eco_fail(error, ECO_BAD_INPUT,
		"%.200s: no footprint is left of its %llu features: buildings are polygons", spec->path,
		(unsigned long long)footprints->report.features);
}

void eco_footprints_report(const struct eco_footprints *f, void (*say)(void *ctx, const char *text), void *ctx)
{
	const struct { const struct eco_footprint_note *note; const char *what; } kinds[] = {
		{ &f->unusable, "texts are no height of a building, as they are 0, below it, above 1000 m or no number: the next source counts" },
		{ &f->untold, "of them are told no height: taken for 6 m; a number at the end of \"height_m\" says another" },
		{ &f->by_number, "of them have no height in a column: the number in \"height_m\" is taken" },
		{ &f->unknown, "have a roof of a form that is not known: flat" } };
	_Static_assert(ECO_BUILDING_MOST_M == 1000 && ECO_BUILDING_M == 6, "as the texts say");
	char line[256], counts[2][32];
	for (uint32_t i = 0; i < f->report.note_count; i++)
		say(ctx, f->report.notes[i]);
	snprintf(line, sizeof line, "%s footprint%s of %s features", eco_phrase_count(f->areas.count, counts[0]),
		f->areas.count == 1 ? "" : "s", eco_phrase_count(f->report.features, counts[1]));
	say(ctx, line);
	eco_areas_report_say(&f->report, say, ctx);
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		const struct eco_footprint_note *n = kinds[i].note;
		const char *quote = *n->example ? "\"" : "";
		snprintf(line, sizeof line, "  %s %s (first: %s%s%s%sfeature %llu)", eco_phrase_count(n->count, counts[0]), kinds[i].what,
			quote, n->example, quote, *quote ? ", " : "", (unsigned long long)n->first_line);
		if (n->count)
			say(ctx, line);
	}
}

void eco_footprints_free(struct eco_footprints *footprints)
{
	eco_areas_free(&footprints->areas);
	eco_areas_report_free(&footprints->report);
	free(footprints->items);
	*footprints = (struct eco_footprints){ .items = NULL };
}
